//! What menus and keys do: one list, so that every shortcut stands beside its entry.

use egui::{Key, KeyboardShortcut, Modifiers};

use crate::view::View;

/// A command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Command {
    /// Asks for a file and opens it.
    Open,
    /// Saves the document.
    Save,
    /// Asks for a name and saves the document.
    SaveAs,
    /// Ends the program.
    Quit,
    /// Takes the last stroke back.
    Undo,
    /// Does it again.
    Redo,
    /// Plays or holds the clip.
    Play,
    /// Fits the model into the picture.
    Frame,
    /// Makes the brush smaller.
    SmallerBrush,
    /// Makes the brush larger.
    LargerBrush,
    /// Paints or erases.
    Erase,
    /// Solves the scene, or stops.
    Solve,
    /// Shows one of [`View::MAIN`].
    View(u8),
}

impl Command {
    /// All that have keys.
    pub const ALL: [Self; 19] = [
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

    /// Its name in menus.
    pub fn name(self) -> &'static str {
        match self {
            Self::Open => "Open…",
            Self::Save => "Save",
            Self::SaveAs => "Save as…",
            Self::Quit => "Quit",
            Self::Undo => "Undo stroke",
            Self::Redo => "Redo stroke",
            Self::Play => "Play or hold",
            Self::Frame => "Fit to picture",
            Self::SmallerBrush => "Smaller brush",
            Self::LargerBrush => "Larger brush",
            Self::Erase => "Paint or erase",
            Self::Solve => "Solve or stop",
            Self::View(n) => View::MAIN[usize::from(n) % View::MAIN.len()].name(),
        }
    }

    /// Its keys.
    pub fn shortcut(self) -> KeyboardShortcut {
        let plain = |key| KeyboardShortcut::new(Modifiers::NONE, key);
        let command = |key| KeyboardShortcut::new(Modifiers::COMMAND, key);
        let both = |key| KeyboardShortcut::new(Modifiers::COMMAND | Modifiers::SHIFT, key);
        match self {
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
                    [usize::from(n) % 7],
            ),
        }
    }

    /// The commands whose keys were pressed, where no field has the keyboard.
    pub fn pressed(ctx: &egui::Context) -> Vec<Self> {
        let typing = ctx.egui_wants_keyboard_input();
        let free = |c: &&Self| !typing || c.shortcut().modifiers.any();
        Self::ALL
            .iter()
            .filter(free)
            .filter(|c| ctx.input_mut(|i| i.consume_shortcut(&c.shortcut())))
            .copied()
            .collect()
    }
}
