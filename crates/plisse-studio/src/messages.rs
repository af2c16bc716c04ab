//! Messages to the user: a list that stays in the window until it is read.

/// The weight of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weight {
    /// Something was done.
    Note,
    /// Something could not be done; the work is kept.
    Problem,
}

/// One message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    /// Its weight.
    pub weight: Weight,
    /// One sentence: place, problem and fix, or what was done.
    pub text: String,
    /// Number of times that it came in a row.
    pub times: usize,
}

/// Most messages that are kept.
const MOST: usize = 200;

/// The messages, the newest last.
#[derive(Clone, Debug, Default)]
pub struct Messages {
    list: Vec<Message>,
    /// True if there are problems that the user has not closed yet.
    pub open: bool,
}

impl Messages {
    /// Adds a note: something was done.
    pub fn note(&mut self, text: impl Into<String>) {
        self.push(Weight::Note, text.into());
    }

    /// Adds a problem: something could not be done.
    pub fn problem(&mut self, text: impl std::fmt::Display) {
        self.push(Weight::Problem, text.to_string());
        self.open = true;
    }

    fn push(&mut self, weight: Weight, text: String) {
        if let Some(last) = self.list.last_mut().filter(|m| m.text == text) {
            last.times += 1;
            return;
        }
        self.list.push(Message { weight, text, times: 1 });
        if self.list.len() > MOST {
            self.list.remove(0);
        }
    }

    /// All messages, the newest last.
    pub fn list(&self) -> &[Message] {
        &self.list
    }

    /// The newest message.
    pub fn last(&self) -> Option<&Message> {
        self.list.last()
    }
}
