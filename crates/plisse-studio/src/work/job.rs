//! A job in the background: it tells how far it is, can be stopped, and hands over what it makes as
//! it makes it.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};

use plisse::progress::{Observer, Step};

use super::thread::{apart, spawn};

/// What a job has told about itself.
#[derive(Clone, Debug, Default)]
pub struct Progress {
    /// What it does now.
    pub stage: String,
    /// Share that is done, 0 to 1, where it can be told.
    pub share: Option<f32>,
    /// Steps so far: stage, energy (J), residual over its tolerance.
    pub steps: Vec<(&'static str, f64, f64)>,
}

/// What a job sends.
pub enum News<T> {
    /// Something to show on the way.
    Part(T),
    /// It is done: the last thing, or why there is none.
    Done(Result<T, String>),
}

/// The window's end of a job.
pub struct Job<T> {
    /// What it is, for people.
    pub title: String,
    progress: Arc<Mutex<Progress>>,
    stop: Arc<AtomicBool>,
    news: Receiver<News<T>>,
}

/// The job's own end.
pub struct Reporter<T> {
    progress: Arc<Mutex<Progress>>,
    stop: Arc<AtomicBool>,
    send: Mutex<Sender<News<T>>>,
    wake: Box<dyn Fn() + Send + Sync>,
}

impl<T: Send + 'static> Job<T> {
    /// Starts `work` in the background. `wake` is called when there is news.
    pub fn start(
        title: &str,
        wake: impl Fn() + Send + Sync + 'static,
        work: impl FnOnce(&Reporter<T>) -> plisse::Result<T> + Send + 'static,
    ) -> Self {
        let (send, news) = channel();
        let (progress, stop) =
            (Arc::new(Mutex::new(Progress::default())), Arc::new(AtomicBool::new(false)));
        let reporter = Reporter {
            progress: Arc::clone(&progress),
            stop: Arc::clone(&stop),
            send: Mutex::new(send),
            wake: Box::new(wake),
        };
        spawn("job", move || {
            let done = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
                apart(|| work(&reporter))
            }));
            let done = match done {
                Ok(done) => done.map_err(|e| e.to_string()),
                Err(_) => {
                    Err("the program made a mistake in this step; your work is kept, save it \
                    and report what you did"
                        .into())
                }
            };
            reporter.send(News::Done(done));
        });
        Self { title: title.to_owned(), progress, stop, news }
    }

    /// Everything that came since the last call.
    pub fn take(&self) -> Vec<News<T>> {
        self.news.try_iter().collect()
    }

    /// Asks it to stop; it ends with the best it has.
    pub fn cancel(&self) {
        self.stop.store(true, Ordering::SeqCst);
    }

    /// Whether it was asked to stop.
    pub fn is_cancelled(&self) -> bool {
        self.stop.load(Ordering::SeqCst)
    }

    /// How far it is.
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
    /// Hands over something to show on the way.
    pub fn part(&self, part: T) {
        self.send(News::Part(part));
    }

    /// Says what is done now, and which share of the whole that begins at.
    pub fn stage(&self, stage: &str, share: Option<f32>) {
        if let Ok(mut progress) = self.progress.lock() {
            progress.stage = stage.to_owned();
            progress.share = share;
        }
        (self.wake)();
    }

    fn send(&self, news: News<T>) {
        if let Ok(send) = self.send.lock() {
            // Nobody may be there to hear it: the window was closed.
            let _ = send.send(news);
        }
        (self.wake)();
    }
}

impl<T: Send> Observer for Reporter<T> {
    fn step(&self, step: &Step) {
        if let Ok(mut progress) = self.progress.lock() {
            progress.steps.push((
                step.stage,
                step.energy_joule,
                step.residual / step.tolerance.max(f64::MIN_POSITIVE),
            ));
        }
        (self.wake)();
    }

    fn cancelled(&self) -> bool {
        self.stop.load(Ordering::SeqCst)
    }
}
