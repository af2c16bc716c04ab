/// The coordinate axis that points up, against gravity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Up {
    /// +Y, as in glTF and in most OBJ files; the front of a surface is then +Z.
    Y,
    /// +Z, as in scene files; the front of a surface is then −Y.
    #[default]
    Z,
}
