//! Progress bars on the terminal (standard error); where that is none, a line every half minute.

use std::io::{IsTerminal, Write, stderr};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use indicatif::{HumanDuration, ProgressBar, ProgressStyle};
use plisse::progress::{Observer, Step};

/// Progress bars, one per solve, with energy, residual and an estimate of the time left.
pub(crate) struct Bars<'a> {
    interrupted: &'a AtomicBool,
    current: Mutex<Option<Current>>,
    /// Time of the last line, if standard error is no terminal.
    lines: Option<Mutex<Instant>>,
}

/// Time between lines where there is no terminal.
const BETWEEN_LINES: Duration = Duration::from_secs(30);

struct Current {
    stage: &'static str,
    first_residual: f64,
    begun: Instant,
    /// Part that was done at best, 0 to 1: a residual may rise on its way down, the bar does not go
    /// back.
    done: f64,
    bar: ProgressBar,
}

/// Parts of a bar: residuals have no natural count.
const PARTS: u64 = 1000;

impl<'a> Bars<'a> {
    pub(crate) fn new(interrupted: &'a AtomicBool) -> Self {
        let lines = (!stderr().is_terminal()).then(|| Mutex::new(Instant::now()));
        Self { interrupted, current: Mutex::new(None), lines }
    }

    /// A spinner for a step that cannot tell how far it is; it lasts until dropped or finished.
    pub(crate) fn spinner(&self, what: &'static str) -> ProgressBar {
        self.finish();
        let style = ProgressStyle::with_template("{msg:>8} {spinner} {elapsed}")
            .expect("the template is right");
        let bar = ProgressBar::new_spinner().with_style(style).with_message(what);
        bar.enable_steady_tick(Duration::from_millis(100));
        bar
    }

    /// A bar for `total` things that are done one by one, with an estimate of the time left; until
    /// finished.
    pub(crate) fn counter(&self, what: &'static str, total: usize) -> ProgressBar {
        self.finish();
        let template = "{prefix:>8} {bar:30} {pos} of {len}, about {eta} left {msg}";
        let style = ProgressStyle::with_template(template).expect("the template is right");
        ProgressBar::new(total as u64).with_style(style).with_prefix(what)
    }

    /// Removes the current bar.
    pub(crate) fn finish(&self) {
        if let Some(current) =
            self.current.lock().expect("no thread panics while it holds a bar").take()
        {
            current.bar.finish_and_clear();
        }
    }
}

impl Observer for Bars<'_> {
    fn step(&self, step: &Step) {
        let mut current = self.current.lock().expect("no thread panics while it holds a bar");
        if current.as_ref().is_none_or(|c| c.stage != step.stage) {
            if let Some(old) = current.take() {
                old.bar.finish_and_clear();
            }
            let style = ProgressStyle::with_template("{prefix:>8} {bar:30} {msg}")
                .expect("the template is right");
            let bar = ProgressBar::new(PARTS).with_style(style).with_prefix(step.stage);
            *current = Some(Current {
                stage: step.stage,
                first_residual: step.residual.max(step.tolerance),
                begun: Instant::now(),
                done: 0.0,
                bar,
            });
        }
        if let Some(current) = current.as_mut() {
            // Residuals fall by orders of magnitude: the bar shows how many are done.
            let whole = (current.first_residual / step.tolerance).ln().max(1e-9);
            let done = (current.first_residual / step.residual.max(step.tolerance)).ln() / whole;
            let by_count = step.iteration as f64 / step.limit.max(1) as f64;
            current.done = current.done.max(done).max(by_count).clamp(1e-3, 1.0);
            let left = current.begun.elapsed().as_secs_f64() * (1.0 / current.done - 1.0);
            current.bar.set_position((current.done * PARTS as f64) as u64);
            let message = format!(
                "iteration {}, energy {:.6e} J, residual {:.1e} (until {:.0e}), about {} left",
                step.iteration,
                step.energy_joule,
                step.residual,
                step.tolerance,
                HumanDuration(Duration::from_secs_f64(left.ceil()))
            );
            if let Some(last) = &self.lines {
                let mut last = last.lock().expect("no thread panics while it writes a line");
                if is_due(&mut last, Instant::now()) {
                    // A closed standard error is no reason to stop.
                    let _ = writeln!(stderr(), "{:>8} {message}", step.stage);
                }
            }
            current.bar.set_message(message);
        }
    }

    fn cancelled(&self) -> bool {
        self.interrupted.load(Ordering::SeqCst)
    }
}

/// True if another line is due; `now` is then its time.
fn is_due(last: &mut Instant, now: Instant) -> bool {
    let due = now.duration_since(*last) >= BETWEEN_LINES;
    if due {
        *last = now;
    }
    due
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_come_every_half_minute() {
        let begun = Instant::now();
        let mut last = begun;
        let written: Vec<u64> =
            (0..100).filter(|&s| is_due(&mut last, begun + Duration::from_secs(s))).collect();
        assert_eq!(written, [30, 60, 90]);
    }
}
