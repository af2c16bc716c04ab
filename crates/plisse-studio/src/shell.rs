//! The shell around the document: tabs, messages, questions, the file chooser, and autosaves.

use std::path::PathBuf;
use std::sync::Arc;

use crate::file_chooser::FileChooser;
use crate::guard::{Guard, Leftover};
use crate::messages::Messages;

/// Requests another frame of the window, from any thread.
pub type RequestRepaint = Arc<dyn Fn() + Send + Sync>;

/// A tab of the panel on the left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tab {
    /// Clips, and the real-time wrinkles.
    Live,
    /// The brush.
    Paint,
    /// Material, clamps, and the solve.
    Physics,
    /// Growth.
    Grow,
    /// Files for other programs.
    Export,
}

impl Tab {
    /// All tabs, in their order.
    pub const ALL: [Self; 5] = [Self::Live, Self::Paint, Self::Physics, Self::Grow, Self::Export];

    /// Name in the window.
    pub fn name(self) -> &'static str {
        match self {
            Self::Live => "Live",
            Self::Paint => "Paint",
            Self::Physics => "Physics",
            Self::Grow => "Grow",
            Self::Export => "Export",
        }
    }
}

/// A question that the window asks before something is lost.
#[derive(Clone, Debug, PartialEq)]
pub enum Question {
    /// The document is not saved; open this file anyway?
    Open(PathBuf),
    /// The document is not saved; open this built-in model anyway?
    OpenModel(String),
    /// The document is not saved; quit anyway?
    Quit,
    /// The file changed on the disk; read it again?
    Reload(PathBuf),
    /// An earlier run left this autosave; recover it?
    Recover(Leftover),
}

/// The state of the window itself.
pub struct Shell {
    /// The open tab.
    pub tab: Tab,
    /// Messages to the user.
    pub messages: Messages,
    /// The question that waits for an answer.
    pub(crate) question: Option<Question>,
    pub(crate) file_chooser: Option<FileChooser>,
    pub(crate) guard: Guard,
    /// Autosaves that earlier runs left behind.
    pub(crate) leftovers: Vec<Leftover>,
    /// True once the user chose to recover them later.
    pub(crate) recovers_later: bool,
    /// True if the program is to end.
    pub quits: bool,
    pub(crate) request_repaint: RequestRepaint,
    /// Running mean of the window's own time per frame (ms).
    pub frame_ms: f32,
}

impl Shell {
    /// A shell whose autosaves go to `autosave_folder`.
    pub fn new(autosave_folder: Option<PathBuf>, request_repaint: RequestRepaint) -> Self {
        let guard = Guard::new(autosave_folder);
        Self {
            tab: Tab::Live,
            messages: Messages::default(),
            question: None,
            file_chooser: None,
            leftovers: guard.leftovers(),
            guard,
            recovers_later: false,
            quits: false,
            request_repaint,
            frame_ms: 0.0,
        }
    }

    /// The question to show: the one that waits, else that for the first autosave left behind.
    pub(crate) fn open_question(&self) -> Option<Question> {
        let leftover = self.leftovers.first().filter(|_| !self.recovers_later);
        self.question.clone().or_else(|| leftover.cloned().map(Question::Recover))
    }
}
