//! Ctrl-C: the first asks the running step to stop and keep what it has, the second ends the
//! program at once.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Watches for interrupts; the flag turns true at the first.
pub(crate) fn watch() -> Arc<AtomicBool> {
    let flag = Arc::new(AtomicBool::new(false));
    let seen = Arc::clone(&flag);
    // Where no handler can be set, Ctrl-C ends the program as it always does; outputs are written
    // aside, so nothing is harmed.
    let _ = ctrlc::set_handler(move || {
        if seen.swap(true, Ordering::SeqCst) {
            std::process::exit(130);
        }
        crate::terminal::eprint_line("\nstopping; press Ctrl-C again to end at once");
    });
    flag
}
