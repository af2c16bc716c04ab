//! The direction of a Newton step: which matrix is factorised, and what is solved with it.
//!
//! Close to the minimum that is the true Hessian H, which gives quadratic convergence. Farther away
//! H has directions of negative curvature; the bound C that a problem can give, with element
//! Hessians made convex, has none, but may be stiffer by far than the energy is. So H + s(C − H) is
//! factorised with a share s that is as small as experience tells, from 0 to 1. But for loads like
//! pressure, C − H is positive semidefinite: what can be factorised with a share can be with any
//! larger one.

use super::cholesky::Cholesky;
use super::elimination::Groups;
use super::newton::Problem;
use super::small::Convexity;
use super::sparse::SymmetricPattern;
use crate::Result;

/// By what the share changes from one attempt to the next, and the least one that is not 0.
const SHARE_FACTOR: f64 = 4.0;
const LEAST_SHARE: f64 = 1.0 / 256.0;
/// Steps that go by, at most, before a share that was too small is tried again; and where it is 0
/// or 1.
const LONGEST_WAIT: u32 = 4;
const LONGEST_WAIT_OF_ALL: u32 = 5;

/// Relative residual at which [`Descent::conjugate_gradients`] is content: far from the minimum,
/// where a Newton step is rough anyway, and close to it; and the steps it takes at most.
const CONTENT: [f64; 2] = [1e-2, 1e-6];
const MOST_STEPS: usize = 60;

/// Finds directions of descent; kept from step to step.
pub(super) struct Descent {
    pub(super) cholesky: Cholesky,
    /// `[n]` where the diagonal's entries are.
    pub(super) diagonal: Vec<usize>,
    /// What is factorised.
    pub(super) values: Vec<f64>,
    /// H and C, while both are needed.
    exact: Vec<f64>,
    convex: Vec<f64>,
    share: Share,
}

/// What a direction is wanted for.
pub(super) struct Wanted<'a> {
    /// How C is made.
    pub(super) convexity: Convexity,
    /// Whether steps have become small, so that H may be tried.
    pub(super) settled: bool,
    /// Share of the largest diagonal entry that is added to each.
    pub(super) damping: f64,
    /// `[n]` unknowns that go down their own gradient only.
    pub(super) held: &'a [bool],
    pub(super) gradient: &'a [f64],
}

impl Descent {
    /// With `all_or_none` the share is 0 or 1.
    pub(super) fn new(
        pattern: SymmetricPattern,
        groups: Option<Groups>,
        all_or_none: bool,
    ) -> Result<Self> {
        Ok(Self::with(Cholesky::for_many(pattern, groups)?, Share::new(all_or_none)))
    }

    /// The same for another pattern.
    pub(super) fn again(self, pattern: SymmetricPattern, groups: Option<Groups>) -> Result<Self> {
        Ok(Self::with(self.cholesky.again(pattern, groups)?, self.share))
    }

    fn with(cholesky: Cholesky, share: Share) -> Self {
        let pattern = cholesky.pattern();
        let diagonal = (0..pattern.size()).map(|i| pattern.slot(i, i)).collect();
        let values = vec![0.0; pattern.entry_count()];
        Self { cholesky, diagonal, exact: Vec::new(), convex: Vec::new(), values, share }
    }

    /// Whether the last direction was that of the true Hessian.
    pub(super) fn exact(&self) -> bool {
        self.share.now == 0.0
    }

    /// A direction along which the energy of `problem` falls from where it was last linearised, in
    /// `direction` (`[n]`); tells whether there is one.
    pub(super) fn find(
        &mut self,
        problem: &mut dyn Problem,
        wanted: &Wanted<'_>,
        direction: &mut [f64],
    ) -> bool {
        if wanted.convexity == Convexity::Exact || !wanted.settled {
            self.share.pass();
        } else if self.find_by_share(problem, wanted, direction) {
            return true;
        }
        let mut damping = wanted.damping;
        loop {
            problem.hessian(wanted.convexity, &mut self.values);
            if self.solve(problem, wanted, damping, direction) {
                return true;
            }
            damping *= 100.0;
            if damping.is_nan() || damping > 1e8 {
                return false;
            }
        }
    }

    /// The same with a share of C that is less than 1.
    fn find_by_share(
        &mut self,
        problem: &mut dyn Problem,
        wanted: &Wanted<'_>,
        direction: &mut [f64],
    ) -> bool {
        let mut share = self.share.first();
        if share >= 1.0 {
            return false;
        }
        self.exact.resize(self.values.len(), 0.0);
        problem.hessian(Convexity::Exact, &mut self.exact);
        let mut both = false;
        while share < 1.0 {
            self.values.copy_from_slice(&self.exact);
            if share > 0.0 {
                if !both {
                    self.convex.resize(self.values.len(), 0.0);
                    problem.hessian(wanted.convexity, &mut self.convex);
                    both = true;
                }
                for (value, convex) in self.values.iter_mut().zip(&self.convex) {
                    *value += share * (convex - *value);
                }
            }
            if self.solve(problem, wanted, wanted.damping, direction) {
                self.share.found(share);
                return true;
            }
            share = self.share.failed(share);
        }
        self.share.now = 1.0;
        false
    }

    /// `direction` = −A⁻¹·gradient for the matrix A in `values`; tells whether A is positive
    /// definite.
    fn solve(
        &mut self,
        problem: &dyn Problem,
        wanted: &Wanted<'_>,
        damping: f64,
        direction: &mut [f64],
    ) -> bool {
        let values = &mut self.values;
        let largest = self.diagonal.iter().map(|&slot| values[slot].abs()).fold(0.0, f64::max);
        let shift = if largest > 0.0 { damping * largest } else { 1.0 };
        for &slot in &self.diagonal {
            values[slot] += shift;
        }
        self.cholesky.pattern().isolate(values, wanted.held);
        if !self.cholesky.factorise(values) {
            return false;
        }
        // Held unknowns go down their own gradient, to the bound; the line search projects them.
        for (direction, gradient) in direction.iter_mut().zip(wanted.gradient) {
            *direction = -gradient;
        }
        self.cholesky.solve(direction);
        // Rough while the gradient (of order one at most) is large, so that the steps still shrink
        // it faster and faster (Eisenstat & Walker).
        let free = wanted.gradient.iter().zip(wanted.held).filter(|(_, held)| !**held);
        let largest = free.fold(0.0_f64, |most, (g, _)| most.max(g.abs()));
        self.conjugate_gradients(
            problem,
            wanted.gradient,
            largest.sqrt().clamp(CONTENT[1], CONTENT[0]),
            direction,
        );
        dot(direction, wanted.gradient) < 0.0
    }

    /// Where the factorised matrix P leaves a part of the Hessian out, solves H·direction =
    /// −gradient by conjugate gradients with P as preconditioner; `direction` comes in as
    /// −P⁻¹·gradient. Every iterate is a direction of descent.
    fn conjugate_gradients(
        &mut self,
        problem: &dyn Problem,
        gradient: &[f64],
        content: f64,
        direction: &mut [f64],
    ) {
        let n = direction.len();
        let mut image = vec![0.0; n];
        if !problem.add_rest_of_hessian(direction, &mut image) {
            return;
        }
        let mut residual: Vec<f64> = gradient.iter().map(|g| -g).collect();
        let mut search = direction.to_vec();
        direction.fill(0.0);
        let mut square = dot(&residual, &search);
        let enough = content * content * square;
        let mut solved = vec![0.0; n];
        for _ in 0..MOST_STEPS {
            self.cholesky.pattern().multiply(&self.values, &search, &mut image);
            problem.add_rest_of_hessian(&search, &mut image);
            let bend = dot(&search, &image);
            if bend.is_nan() || bend <= 0.0 {
                break;
            }
            let step = square / bend;
            for i in 0..n {
                direction[i] += step * search[i];
                residual[i] -= step * image[i];
            }
            solved.copy_from_slice(&residual);
            self.cholesky.solve(&mut solved);
            let next = dot(&residual, &solved);
            if next.is_nan() || next <= enough {
                break;
            }
            for i in 0..n {
                search[i] = solved[i] + next / square * search[i];
            }
            square = next;
        }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The share of C that was last needed.
#[derive(Clone, Copy)]
struct Share {
    now: f64,
    /// Steps to go by before a smaller one is tried.
    wait: u32,
    /// Times in a row that a smaller one was too small.
    failures: u32,
    /// Whether it is 0 or 1 only.
    all_or_none: bool,
}

impl Share {
    fn new(all_or_none: bool) -> Self {
        Self { now: 1.0, wait: 0, failures: 0, all_or_none }
    }

    /// This step goes without.
    fn pass(&mut self) {
        if self.all_or_none {
            self.wait = self.wait.saturating_sub(1);
        } else {
            *self = Self::new(false);
        }
    }

    /// What to try first in this step.
    fn first(&mut self) -> f64 {
        if self.wait > 0 {
            self.wait -= 1;
            return self.now;
        }
        if self.all_or_none || self.now <= LEAST_SHARE { 0.0 } else { self.now / SHARE_FACTOR }
    }

    /// `tried` was too small: what to try next.
    fn failed(&mut self, tried: f64) -> f64 {
        self.failures = (self.failures + 1).min(if self.all_or_none {
            LONGEST_WAIT_OF_ALL
        } else {
            LONGEST_WAIT
        });
        self.wait = self.failures;
        match tried {
            _ if self.all_or_none => 1.0,
            0.0 => LEAST_SHARE,
            _ => tried * SHARE_FACTOR,
        }
    }

    /// `tried` was enough.
    fn found(&mut self, tried: f64) {
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
    fn the_share_falls_while_it_can_and_waits_where_it_cannot() {
        let mut share = Share::new(false);
        let step = |share: &mut Share, needed: f64| {
            let mut tried = vec![share.first()];
            while tried[tried.len() - 1] < needed {
                tried.push(share.failed(tried[tried.len() - 1]));
            }
            share.found(tried[tried.len() - 1]);
            tried
        };
        let fall: Vec<f64> = (0..6).flat_map(|_| step(&mut share, 0.0)).collect();
        assert_eq!(fall, [0.25, 0.0625, 0.015625, 0.00390625, 0.0, 0.0]);
        assert_eq!(step(&mut share, 0.01), [0.0, 0.00390625, 0.015625]);
        // Twice failed, so two steps go by.
        assert_eq!([(); 3].map(|()| step(&mut share, 0.01)[0]), [0.015625, 0.015625, 0.00390625]);
        let mut all = Share::new(true);
        assert_eq!(
            [step(&mut all, 0.01), step(&mut all, 0.01), step(&mut all, 0.0)],
            [vec![0.0, 1.0], vec![1.0], vec![0.0]]
        );
    }

    /// One unknown, with H = −1 and C = 50.
    struct Saddle;

    impl Problem for Saddle {
        fn pattern(&self) -> SymmetricPattern {
            SymmetricPattern::from_elements(1, [&[0][..]].into_iter())
        }
        fn lower_bounds(&self) -> Vec<f64> {
            vec![f64::NEG_INFINITY]
        }
        fn energy(&mut self, _: &[f64]) -> f64 {
            0.0
        }
        fn linearise(&mut self, _: &[f64], _: &mut [f64]) -> f64 {
            0.0
        }
        fn hessian(&mut self, convexity: Convexity, values: &mut [f64]) {
            values[0] = if convexity == Convexity::Exact { -1.0 } else { 50.0 };
        }
    }

    #[test]
    fn as_little_of_the_bound_is_added_as_makes_it_convex() {
        let mut descent = Descent::new(Saddle.pattern(), None, false).unwrap();
        let bend = |descent: &mut Descent, settled: bool| {
            let wanted = Wanted {
                convexity: Convexity::Clamped,
                settled,
                damping: 0.0,
                held: &[false],
                gradient: &[1.0],
            };
            let mut direction = [0.0];
            assert!(descent.find(&mut Saddle, &wanted, &mut direction));
            -1.0 / direction[0]
        };
        assert_eq!(bend(&mut descent, false), 50.0);
        for expected in [0.25 * 51.0 - 1.0, 0.0625 * 51.0 - 1.0, 0.0625 * 51.0 - 1.0] {
            assert!((bend(&mut descent, true) - expected).abs() < 1e-12);
            assert!(!descent.exact());
        }
    }
}
