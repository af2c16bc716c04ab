//! Commands of menus, keys and panels. A panel changes what it shows; what reaches further is a
//! command, which the studio runs. Every shortcut stands in one list, beside its entry in the
//! menus.

use std::path::PathBuf;

use egui::{Key, KeyboardShortcut, Modifiers};

use crate::document::Layer;
use crate::document::scene_edit::Edit;
use crate::guard::Leftover;
use crate::view::View;
use crate::work::export::Kind;

/// A command.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// Asks for a file and opens it.
    Open,
    /// Saves the document.
    Save,
    /// Asks for a name and saves the document.
    SaveAs,
    /// Ends the program.
    Quit,
    /// Undoes the last stroke.
    Undo,
    /// Redoes the last stroke that was undone.
    Redo,
    /// Plays or pauses the clip.
    Play,
    /// Fits the model into the picture.
    Frame,
    /// Makes the brush smaller.
    SmallerBrush,
    /// Makes the brush larger.
    LargerBrush,
    /// Switches between painting and erasing.
    Erase,
    /// Solves the scene, or stops the solve.
    Solve,
    /// Shows one of [`View::MAIN`].
    View(u8),
    /// Opens a built-in model.
    OpenModel(String),
    /// Recovers an autosave.
    Recover(Leftover),
    /// Chooses the layer that the brush paints on.
    ChooseLayer(Layer),
    /// Edits the scene's text.
    EditScene(Edit),
    /// Solves the scene from its own start.
    SolveFromStart,
    /// Grows the whole surface, or stops its growth.
    Grow,
    /// Switches folding under the brush on or off.
    FoldUnderBrush(bool),
    /// Asks for the path of an export, at first the given one.
    Export(Kind, PathBuf),
    /// Writes the picture to a file.
    ExportPicture(PathBuf),
    /// Stops the export.
    StopExport,
}

impl Command {
    /// The commands that have keys. Where one shortcut contains another, it comes first.
    pub const WITH_KEYS: [Self; 19] = [
        Self::Open,
        Self::SaveAs,
        Self::Save,
        Self::Quit,
        Self::Redo,
        Self::Undo,
        Self::Play,
        Self::Frame,
        Self::SmallerBrush,
        Self::LargerBrush,
        Self::Erase,
        Self::Solve,
        Self::View(0),
        Self::View(1),
        Self::View(2),
        Self::View(3),
        Self::View(4),
        Self::View(5),
        Self::View(6),
    ];

    /// Name in menus; empty for commands that are in none.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Open => "Open…",
            Self::Save => "Save",
            Self::SaveAs => "Save as…",
            Self::Quit => "Quit",
            Self::Undo => "Undo stroke",
            Self::Redo => "Redo stroke",
            Self::Play => "Play or pause",
            Self::Frame => "Fit to picture",
            Self::SmallerBrush => "Smaller brush",
            Self::LargerBrush => "Larger brush",
            Self::Erase => "Paint or erase",
            Self::Solve => "Solve or stop",
            Self::View(n) => View::MAIN[usize::from(*n) % View::MAIN.len()].name(),
            _ => "",
        }
    }

    /// Keys, if it has any.
    pub fn shortcut(&self) -> Option<KeyboardShortcut> {
        let plain = |key| KeyboardShortcut::new(Modifiers::NONE, key);
        let command = |key| KeyboardShortcut::new(Modifiers::COMMAND, key);
        let both = |key| KeyboardShortcut::new(Modifiers::COMMAND | Modifiers::SHIFT, key);
        Some(match self {
            Self::Open => command(Key::O),
            Self::Save => command(Key::S),
            Self::SaveAs => both(Key::S),
            Self::Quit => command(Key::Q),
            Self::Undo => command(Key::Z),
            Self::Redo => both(Key::Z),
            Self::Play => plain(Key::Space),
            Self::Frame => plain(Key::F),
            Self::SmallerBrush => plain(Key::OpenBracket),
            Self::LargerBrush => plain(Key::CloseBracket),
            Self::Erase => plain(Key::E),
            Self::Solve => command(Key::Enter),
            Self::View(n) => plain(
                [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5, Key::Num6, Key::Num7]
                    [usize::from(*n) % 7],
            ),
            _ => return None,
        })
    }

    /// The commands whose keys were pressed. While a field has the keyboard, plain keys are its
    /// own.
    pub fn pressed(ctx: &egui::Context) -> Vec<Self> {
        let typing = ctx.egui_wants_keyboard_input();
        let is_pressed = |command: &Self| {
            command.shortcut().is_some_and(|keys| {
                (!typing || keys.modifiers.any()) && ctx.input_mut(|i| i.consume_shortcut(&keys))
            })
        };
        Self::WITH_KEYS.into_iter().filter(is_pressed).collect()
    }
}
