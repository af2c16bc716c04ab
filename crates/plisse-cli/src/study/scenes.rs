//! The scenes of `examples/`, built in so that studies run anywhere.

use plisse::Result;
use plisse::scene::{Scene, parse};

/// File name and text of every scene, in the order of their numbers.
const SCENES: [(&str, &str); 3] = [
    ("01-twisted-cylinder.toml", include_str!("../../../../examples/01-twisted-cylinder.toml")),
    ("02-stretched-sheet.toml", include_str!("../../../../examples/02-stretched-sheet.toml")),
    ("03-sheared-rectangle.toml", include_str!("../../../../examples/03-sheared-rectangle.toml")),
];

/// The scene whose file begins with this number, if there is one.
pub(crate) fn numbered(number: usize) -> Result<Option<Scene>> {
    let prefix = format!("{number:02}-");
    SCENES.iter().find(|(name, _)| name.starts_with(&prefix)).map(|(name, text)| parse(name, text)).transpose()
}

/// The scene whose file begins with this number, which is one of the first three.
pub(crate) fn first_three(number: usize) -> Result<Scene> {
    Ok(numbered(number)?.expect("scenes 01 to 03 are built in"))
}
