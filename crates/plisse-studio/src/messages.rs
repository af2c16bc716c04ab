//! What the program has to say: a list that stays in the window until it is read.

/// How bad it is.
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
    /// How bad it is.
    pub weight: Weight,
    /// One sentence: place, what is wrong, mend; or what was done.
    pub text: String,
    /// How often it came in a row.
    pub times: usize,
}

/// Messages that are kept.
const MOST: usize = 200;

/// All messages, the newest last.
#[derive(Clone, Debug, Default)]
pub struct Messages {
    list: Vec<Message>,
    /// Whether problems came that nobody has closed yet.
    pub open: bool,
}

impl Messages {
    /// Something was done.
    pub fn note(&mut self, text: impl Into<String>) {
        self.push(Weight::Note, text.into());
    }

    /// Something could not be done.
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

    /// All, the newest last.
    pub fn list(&self) -> &[Message] {
        &self.list
    }

    /// The newest.
    pub fn last(&self) -> Option<&Message> {
        self.list.last()
    }
}
