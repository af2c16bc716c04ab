//! When a solve came so near its end that nobody sees it move any more.

use std::sync::Mutex;
use std::time::Instant;

use plisse::progress::{Observer, Step};

/// A solve is stable from where its energy stays within this share of the last one.
const STABLE: f64 = 1e-3;

/// Passes on what a solve tells, and remembers its energies.
pub(crate) struct StableWatch<'a> {
    inner: &'a dyn Observer,
    begun: Instant,
    /// Seconds and energy (J) after each iteration.
    energies: Mutex<Vec<(f64, f64)>>,
}

impl<'a> StableWatch<'a> {
    pub(crate) fn new(inner: &'a dyn Observer) -> Self {
        Self { inner, begun: Instant::now(), energies: Mutex::new(Vec::new()) }
    }

    /// Seconds from the start until the solve was stable; 0 if it made no step.
    pub(crate) fn stable_seconds(&self) -> f64 {
        stable_seconds(&self.energies.lock().expect("nobody panics with it"))
    }
}

impl Observer for StableWatch<'_> {
    fn step(&self, step: &Step) {
        self.energies
            .lock()
            .expect("nobody panics with it")
            .push((self.begun.elapsed().as_secs_f64(), step.energy_joule));
        self.inner.step(step);
    }

    fn cancelled(&self) -> bool {
        self.inner.cancelled()
    }
}

fn stable_seconds(energies: &[(f64, f64)]) -> f64 {
    let Some(&(_, last)) = energies.last() else { return 0.0 };
    let near = energies
        .iter()
        .rev()
        .take_while(|(_, energy)| (energy - last).abs() <= STABLE * last.abs());
    near.last().map_or(0.0, |&(seconds, _)| seconds)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stable_is_what_stays_near_the_last_energy() {
        assert_eq!(stable_seconds(&[]), 0.0);
        assert_eq!(stable_seconds(&[(1.0, 2.0)]), 1.0);
        // Near it once, away again, then near for good.
        assert_eq!(stable_seconds(&[(1.0, -2.0), (2.0, -1.9), (3.0, -1.9995), (4.0, -2.0)]), 3.0);
    }
}
