//! Output of the command on the terminal, and how a run ended. Nothing here uses `println` and its
//! kin, which panic when nobody reads any more.

use std::io::Write as _;

use plisse::Error;

/// End of a run that did not fail.
pub(crate) enum RunEnd {
    /// Everything was done.
    Complete,
    /// The user interrupted it; the files hold the best state so far.
    Interrupted,
}

/// Prints a line on standard error, if anybody reads it.
pub(crate) fn eprint_line(line: &str) {
    let _ = writeln!(std::io::stderr(), "{line}");
}

/// Prints `text` on standard output. If nobody reads it (`| head`), the run has not failed: its
/// files are written.
pub(crate) fn print(text: &str) {
    let _ = std::io::stdout().write_all(text.as_bytes());
}

/// The flag that helps after `error`, if there is one.
pub(crate) fn hint(error: &Error) -> &'static str {
    match error {
        Error::File { doing: "writing", .. } => " (-o DIR)",
        _ => "",
    }
}

/// `error` with `hint` behind its message.
pub(crate) fn with_hint(error: Error, hint: &str) -> Error {
    match error {
        Error::Value { field, message } => Error::Value { field, message: message + hint },
        other => other,
    }
}
