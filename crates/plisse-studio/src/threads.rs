//! Threads. A web page has none: there, work is done in the page, which stands still meanwhile.

/// Runs `work` on a thread called `name`; in the caller's thread if none can be started.
#[cfg(not(target_arch = "wasm32"))]
pub fn spawn(name: &str, work: impl FnOnce() + Send + 'static) {
    let work = std::sync::Arc::new(std::sync::Mutex::new(Some(work)));
    let theirs = std::sync::Arc::clone(&work);
    let run = move || {
        let taken = theirs.lock().ok().and_then(|mut w| w.take());
        if let Some(work) = taken {
            work();
        }
    };
    // A system without room for a thread still gets its answer.
    if std::thread::Builder::new().name(name.to_owned()).spawn(run).is_err() {
        let taken = work.lock().ok().and_then(|mut w| w.take());
        if let Some(work) = taken {
            work();
        }
    }
}

/// Runs `work` on a thread pool of the jobs: in the shared pool, which draws pictures, every small
/// step of a solver would wait.
#[cfg(not(target_arch = "wasm32"))]
pub fn apart<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    static POOL: std::sync::OnceLock<Option<rayon::ThreadPool>> = std::sync::OnceLock::new();
    match POOL.get_or_init(|| {
        rayon::ThreadPoolBuilder::new().thread_name(|n| format!("job {n}")).build().ok()
    }) {
        Some(pool) => pool.install(work),
        None => work(),
    }
}

/// Runs `work`.
#[cfg(target_arch = "wasm32")]
pub fn apart<T>(work: impl FnOnce() -> T) -> T {
    work()
}

/// Runs `work` in the page, after the next frames.
#[cfg(target_arch = "wasm32")]
pub fn spawn(_name: &str, work: impl FnOnce() + 'static) {
    crate::page::bindings::later(work);
}
