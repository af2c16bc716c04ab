//! Output of the command on the terminal, and how a run ended. Nothing here uses `println` and its
//! kin, which panic when nobody reads any more.

use std::io::Write as _;

/// How a run ended that did not fail.
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
