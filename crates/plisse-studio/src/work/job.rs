//! A job in the background: it reports its progress, can be stopped, and hands over parts of its
//! result on the way.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};

use plisse::progress::{Observer, Step};

use crate::threads::{apart, spawn};

/// Progress of a job.
#[derive(Clone, Debug, Default)]
pub struct Progress {
    /// Name of the current stage.
    pub stage: String,
    /// Share that is done, 0 to 1, if it is known.
    pub share: Option<f32>,
    /// The steps so far.
    pub steps: Vec<SolverStep>,
}

/// One step of a solver.
#[derive(Clone, Copy, Debug)]
pub struct SolverStep {
    /// Name of the stage.
    pub stage: &'static str,
    /// Energy (J).
    pub energy_joule: f64,
    /// Residual over its tolerance; 1 or less is converged.
    pub residual: f64,
}

/// A message from a job.
pub enum News<T> {
    /// A part of the result, to show on the way.
    Part(T),
    /// The end: the result, or an error.
    Done(Result<T, String>),
}

/// The window's end of a job.
pub struct Job<T> {
    progress: Arc<Mutex<Progress>>,
    stop: Arc<AtomicBool>,
    news: Receiver<News<T>>,
}

/// The job's own end.
pub struct Reporter<T> {
    progress: Arc<Mutex<Progress>>,
    stop: Arc<AtomicBool>,
    send: Mutex<Sender<News<T>>>,
    request_repaint: Box<dyn Fn() + Send + Sync>,
}

impl<T: Send + 'static> Job<T> {
    /// Starts `work` in the background. `request_repaint` is called when there is news.
    pub fn start(
        name: &'static str,
        request_repaint: impl Fn() + Send + Sync + 'static,
        work: impl FnOnce(&Reporter<T>) -> plisse::Result<T> + Send + 'static,
    ) -> Self {
        let (send, news) = channel();
        let (progress, stop) =
            (Arc::new(Mutex::new(Progress::default())), Arc::new(AtomicBool::new(false)));
        let reporter = Reporter {
            progress: Arc::clone(&progress),
            stop: Arc::clone(&stop),
            send: Mutex::new(send),
            request_repaint: Box::new(request_repaint),
        };
        spawn(name, move || {
            let done = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
                apart(|| work(&reporter))
            }));
            let done = match done {
                Ok(done) => done.map_err(|e| e.to_string()),
                Err(_) => {
                    Err("internal error in this step; your work is kept, save it and report \
                    what you did"
                        .into())
                }
            };
            reporter.send(News::Done(done));
        });
        Self { progress, stop, news }
    }

    /// The messages that came since the last call.
    pub fn take(&self) -> Vec<News<T>> {
        self.news.try_iter().collect()
    }

    /// Asks it to stop; it ends with the best it has.
    pub fn cancel(&self) {
        self.stop.store(true, Ordering::SeqCst);
    }

    /// True if it was asked to stop.
    pub fn is_cancelled(&self) -> bool {
        self.stop.load(Ordering::SeqCst)
    }

    /// Its progress.
    pub fn progress(&self) -> Progress {
        self.progress.lock().map(|p| p.clone()).unwrap_or_default()
    }
}

impl<T> Drop for Job<T> {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::SeqCst);
    }
}

impl<T> Reporter<T> {
    /// Hands over a part of the result, to show on the way.
    pub fn part(&self, part: T) {
        self.send(News::Part(part));
    }

    /// Reports the current stage, and the share of the whole that it begins at.
    pub fn stage(&self, stage: &str, share: Option<f32>) {
        if let Ok(mut progress) = self.progress.lock() {
            progress.stage = stage.to_owned();
            progress.share = share;
        }
        (self.request_repaint)();
    }

    fn send(&self, news: News<T>) {
        if let Ok(send) = self.send.lock() {
            // Nobody may be there to hear it: the window was closed.
            let _ = send.send(news);
        }
        (self.request_repaint)();
    }
}

impl<T: Send> Observer for Reporter<T> {
    fn step(&self, step: &Step) {
        if let Ok(mut progress) = self.progress.lock() {
            progress.steps.push(SolverStep {
                stage: step.stage,
                energy_joule: step.energy_joule,
                residual: step.residual / step.tolerance.max(f64::MIN_POSITIVE),
            });
        }
        (self.request_repaint)();
    }

    fn cancelled(&self) -> bool {
        self.stop.load(Ordering::SeqCst)
    }
}
