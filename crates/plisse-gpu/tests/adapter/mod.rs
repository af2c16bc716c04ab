//! A harness for tests that need an adapter. Without one they are reported as ignored; with
//! `PLISSE_NEED_GPU` set (scripts/test.sh sets it once it has installed a software driver) they
//! fail instead.

use libtest_mimic::{Arguments, Failed, Trial};
use plisse_gpu::Gpu;

/// A test that runs on an adapter.
pub(crate) struct GpuTest {
    /// Its name.
    pub(crate) name: &'static str,
    /// The test, which panics if it fails.
    pub(crate) run: fn(&Gpu),
    /// True if the test has nothing to run on, because its data are not there.
    pub(crate) is_ignored: bool,
}

impl GpuTest {
    /// A test that needs no more than an adapter.
    pub(crate) const fn new(name: &'static str, run: fn(&Gpu)) -> Self {
        Self { name, run, is_ignored: false }
    }
}

/// Runs the tests that the command line asks for; ends the process.
pub(crate) fn main(tests: Vec<GpuTest>) -> ! {
    let arguments = Arguments::from_args();
    let has_adapter = Gpu::new().is_ok();
    let is_needed = std::env::var_os("PLISSE_NEED_GPU").is_some();
    let trial = |test: GpuTest| {
        let run = test.run;
        let is_ignored = test.is_ignored || !(has_adapter || is_needed);
        Trial::test(test.name, move || {
            run(&Gpu::new().map_err(|e| Failed::from(e.to_string()))?);
            Ok(())
        })
        .with_ignored_flag(is_ignored)
    };
    libtest_mimic::run(&arguments, tests.into_iter().map(trial).collect()).exit()
}
