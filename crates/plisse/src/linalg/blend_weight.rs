//! The weight s of the blended Hessian H + s(C − H): as small as the last steps allow, from 0 (the
//! true Hessian H) to 1 (the projected Hessian C).

/// Factor of the weight from one attempt to the next.
const FACTOR: f64 = 4.0;
/// The least weight that is not 0.
const MIN_POSITIVE: f64 = 1.0 / 256.0;
/// Largest number of steps that go by before a smaller weight, after it failed, is tried again.
const MAX_WAIT: u32 = 4;
/// The same where the weight is either 0 or 1.
const MAX_WAIT_WITHOUT_BLENDS: u32 = 5;

/// The blend weight that was last needed, and when a smaller one is tried.
#[derive(Clone, Copy)]
pub(super) struct BlendWeight {
    /// Weight of C in the last step.
    now: f64,
    /// Number of steps that go by before a smaller weight is tried.
    wait: u32,
    /// Number of times in a row that a smaller weight failed.
    failures: u32,
    /// True if weights between 0 and 1 are used, too.
    blends: bool,
}

impl BlendWeight {
    /// The weight 1. Without `blends` it becomes 0 or 1 only.
    pub(super) fn new(blends: bool) -> Self {
        Self { now: 1.0, wait: 0, failures: 0, blends }
    }

    /// True if the last step was that of the true Hessian.
    pub(super) fn is_zero(&self) -> bool {
        self.now == 0.0
    }

    /// Takes note that no weight below 1 sufficed.
    pub(super) fn set_one(&mut self) {
        self.now = 1.0;
    }

    /// Takes note of a step that does not use the weight.
    pub(super) fn skip_step(&mut self) {
        if self.blends {
            *self = Self::new(true);
        } else {
            self.wait = self.wait.saturating_sub(1);
        }
    }

    /// The weight to try first in a step.
    pub(super) fn first(&mut self) -> f64 {
        if self.wait > 0 {
            self.wait -= 1;
            return self.now;
        }
        if !self.blends || self.now <= MIN_POSITIVE { 0.0 } else { self.now / FACTOR }
    }

    /// Takes note that the weight `tried` was too small; returns the one to try next.
    pub(super) fn failed(&mut self, tried: f64) -> f64 {
        let max_wait = if self.blends { MAX_WAIT } else { MAX_WAIT_WITHOUT_BLENDS };
        self.failures = (self.failures + 1).min(max_wait);
        self.wait = self.failures;
        match tried {
            _ if !self.blends => 1.0,
            0.0 => MIN_POSITIVE,
            _ => tried * FACTOR,
        }
    }

    /// Takes note that the weight `tried` made the blend positive definite.
    pub(super) fn succeeded(&mut self, tried: f64) {
        if tried < self.now {
            (self.wait, self.failures) = (0, 0);
        }
        self.now = tried;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_weight_falls_while_it_can_and_waits_where_it_cannot() {
        let mut weight = BlendWeight::new(true);
        let step = |weight: &mut BlendWeight, needed: f64| {
            let mut tried = vec![weight.first()];
            while tried[tried.len() - 1] < needed {
                tried.push(weight.failed(tried[tried.len() - 1]));
            }
            weight.succeeded(tried[tried.len() - 1]);
            tried
        };
        let fall: Vec<f64> = (0..6).flat_map(|_| step(&mut weight, 0.0)).collect();
        assert_eq!(fall, [0.25, 0.0625, 0.015625, 0.00390625, 0.0, 0.0]);
        assert_eq!(step(&mut weight, 0.01), [0.0, 0.00390625, 0.015625]);
        // Twice failed, so two steps go by.
        assert_eq!([(); 3].map(|()| step(&mut weight, 0.01)[0]), [0.015625, 0.015625, 0.00390625]);
        let mut either = BlendWeight::new(false);
        assert_eq!(
            [step(&mut either, 0.01), step(&mut either, 0.01), step(&mut either, 0.0)],
            [vec![0.0, 1.0], vec![1.0], vec![0.0]]
        );
    }
}
