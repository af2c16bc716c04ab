//! Scripts that drive the program: for tests, and for pictures in the documentation.
//!
//! One command a line; `#` begins a comment. `open FILE`, `tab NAME`, `view NAME`, `time S`,
//! `play`, `hold`, `orbit DEG DEG`, `zoom F`, `fit`, `brush NAME VALUE` (layer, radius, strength,
//! value, heading, mirror, falloff, action), `stroke X Y X Y …` (shares of the picture), `undo`,
//! `redo`, `solve`, `grow`, `fold on` (or `off`), `export KIND PATH`, `wait S`, `settle` (until
//! nothing is on its way), `screenshot PATH`, `show NAME`, `spacing M`, `clip NAME`, `wavelength
//! M`, `lose-gpu`, `save PATH`, `quit`.

use plisse::{Error, Result};

/// One step of a script.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// Line in the script, from 1.
    pub line: usize,
    /// The command.
    pub word: String,
    /// The words after the command.
    pub rest: Vec<String>,
}

impl Step {
    /// Word `k` after the command, as a number.
    ///
    /// # Errors
    /// [`Error::Value`] naming the line if it is missing or no number.
    pub fn number(&self, k: usize) -> Result<f32> {
        let found = self.rest.get(k).and_then(|w| w.parse::<f32>().ok()).filter(|x| x.is_finite());
        found.ok_or_else(|| {
            Error::value(
                format!("script, line {}", self.line),
                format!("{} needs a number as word {}; add it", self.word, k + 1),
            )
        })
    }

    /// Word `k` after the command.
    ///
    /// # Errors
    /// [`Error::Value`] naming the line if it is missing.
    pub fn text(&self, k: usize) -> Result<&str> {
        let found = self.rest.get(k).map(String::as_str);
        found.ok_or_else(|| {
            Error::value(
                format!("script, line {}", self.line),
                format!("{} needs a word {}; add it", self.word, k + 1),
            )
        })
    }
}

/// The steps of a script.
pub fn parse(text: &str) -> Vec<Step> {
    let lines = text
        .lines()
        .enumerate()
        .map(|(n, line)| (n + 1, line.split('#').next().unwrap_or_default()));
    lines
        .filter_map(|(line, text)| {
            let mut words = text.split_whitespace().map(str::to_owned);
            let word = words.next()?;
            Some(Step { line, word, rest: words.collect() })
        })
        .collect()
}
