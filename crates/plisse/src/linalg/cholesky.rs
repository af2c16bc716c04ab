//! Sparse Cholesky factorisation of matrices that share one pattern: ordering and symbolic part once, numeric part as often as
//! wanted.
//!
//! Ordering by approximate minimum degree, symbolic part and solves are those of `faer`. Its numeric part runs on one thread on
//! purpose, so that its rounding does not depend on the number of threads. Where a large matrix is factorised many times, a nested
//! dissection ([`super::dissection`]) is tried, too, and the numeric part is that of `fronts`, whose rounding does not either.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::sparse::SparseColMatRef;
use faer::sparse::linalg::cholesky::{LltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering};
use faer::{Conj, MatMut, Par, Side, Spec};

use super::fronts::Fronts;
use super::ordering::{LARGE, analyse, best, operations, ordered, together, view};
use super::sparse::SymmetricPattern;
use crate::Result;

/// How much more work than when it was made an order may come to, as couplings are added, before another one is looked for.
const WORSE: f64 = 1.3;

/// A factorisation whose symbolic part is done.
pub struct Cholesky {
    pattern: SymmetricPattern,
    symbolic: SymbolicCholesky<usize>,
    fronts: Option<Fronts>,
    factor: Vec<f64>,
    memory: MemBuffer,
    /// The order of elimination, if one was made for groups of unknowns, and the operations that it came to then.
    order: Vec<usize>,
    asked: f64,
}

impl Cholesky {
    /// Orders and analyses `pattern`, for a few factorisations.
    ///
    /// # Errors
    /// [`crate::Error::Numeric`] when memory runs out.
    pub fn new(pattern: SymmetricPattern) -> Result<Self> {
        let symbolic = analyse(&pattern, SymmetricOrdering::Amd)?;
        Ok(Self::prepare(pattern, symbolic, None))
    }

    /// Orders and analyses `pattern`, for many factorisations: takes longer if the matrix is large, so that they do not. With `groups`
    /// (`[n]`, any numbers), unknowns of the same group go together.
    ///
    /// # Errors
    /// [`crate::Error::Numeric`] when memory runs out.
    pub fn for_many(pattern: SymmetricPattern, groups: Option<&[usize]>) -> Result<Self> {
        let (order, symbolic) = match groups {
            None => (Vec::new(), best(&pattern, LARGE)?),
            Some(groups) => {
                let order = together(&pattern, groups)?;
                let symbolic = ordered(&pattern, &order)?;
                (order, symbolic)
            }
        };
        let fronts = if groups.is_some() || pattern.size() >= LARGE { fronts(&pattern, &symbolic) } else { None };
        Ok(Self { asked: operations(&symbolic), order, ..Self::prepare(pattern, symbolic, fronts) })
    }

    /// As [`Cholesky::for_many`], for a `pattern` that has become another, e.g. by more couplings; the order is kept as long as it is good.
    ///
    /// # Errors
    /// As [`Cholesky::for_many`].
    pub fn again(self, pattern: SymmetricPattern, groups: Option<&[usize]>) -> Result<Self> {
        if self.order.is_empty() || pattern.size() != self.order.len() {
            return Self::for_many(pattern, groups);
        }
        let symbolic = ordered(&pattern, &self.order)?;
        if operations(&symbolic) > WORSE * self.asked {
            return Self::for_many(pattern, groups);
        }
        let fronts = fronts(&pattern, &symbolic);
        Ok(Self { asked: self.asked, order: self.order, ..Self::prepare(pattern, symbolic, fronts) })
    }

    fn prepare(pattern: SymmetricPattern, symbolic: SymbolicCholesky<usize>, fronts: Option<Fronts>) -> Self {
        let solve = symbolic.solve_in_place_scratch::<f64>(8, Par::Seq);
        let need = match fronts {
            Some(_) => solve,
            None => solve.or(symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Spec::default())),
        };
        let factor = vec![0.0; symbolic.len_val()];
        Self { pattern, symbolic, fronts, factor, memory: MemBuffer::new(need), order: Vec::new(), asked: 0.0 }
    }

    /// The pattern given to [`Cholesky::new`].
    pub fn pattern(&self) -> &SymmetricPattern {
        &self.pattern
    }

    /// Factorises the matrix with these lower-triangle `values`. Returns whether it is positive definite; only then may
    /// [`Cholesky::solve`] follow.
    pub fn factorise(&mut self, values: &[f64]) -> bool {
        if let Some(fronts) = &self.fronts {
            return fronts.factorise(values, &mut self.factor);
        }
        let matrix = SparseColMatRef::new(view(&self.pattern), values);
        self.symbolic
            .factorize_numeric_llt(
                &mut self.factor,
                matrix,
                Side::Lower,
                LltRegularization::default(),
                Par::Seq,
                MemStack::new(&mut self.memory),
                Spec::default(),
            )
            .is_ok()
    }

    /// Replaces `x` by A⁻¹x.
    pub fn solve(&mut self, x: &mut [f64]) {
        let n = x.len();
        let factor = LltRef::new(&self.symbolic, &self.factor);
        factor.solve_in_place_with_conj(Conj::No, MatMut::from_column_major_slice_mut(x, n, 1), Par::Seq, MemStack::new(&mut self.memory));
    }
}

fn fronts(pattern: &SymmetricPattern, symbolic: &SymbolicCholesky<usize>) -> Option<Fronts> {
    match (symbolic.raw(), symbolic.perm()) {
        (SymbolicCholeskyRaw::Supernodal(supernodes), Some(order)) => Fronts::new(pattern, order, supernodes),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::dissection::dissect;

    #[test]
    fn solves_a_chain_and_tells_an_indefinite_one() {
        let n = 50;
        let elements: Vec<[usize; 2]> = (0..n - 1).map(|i| [i, i + 1]).collect();
        let pattern = SymmetricPattern::from_elements(n, elements.iter().map(|e| &e[..]));
        let mut values = vec![-1.0; pattern.entry_count()];
        for i in 0..n {
            values[pattern.slot(i, i)] = 2.0;
        }
        let expected: Vec<f64> = (0..n).map(|i| (i as f64 * 0.7).sin()).collect();
        let mut x = vec![0.0; n];
        pattern.multiply(&values, &expected, &mut x);
        let mut cholesky = Cholesky::new(pattern.clone()).unwrap();
        assert!(cholesky.factorise(&values));
        cholesky.solve(&mut x);
        assert!(x.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-12));
        values[pattern.slot(10, 10)] = 0.1;
        assert!(!cholesky.factorise(&values));
    }

    /// The couplings of a reference shell on `side` × `side` vertices, flat or rolled to a tube: three unknowns for each vertex, and
    /// elements of a triangle with the far corners of its neighbours.
    fn shell(side: usize, tube: bool) -> SymmetricPattern {
        let lower = [[0, 0], [1, 0], [0, 1], [1, 1], [1, -1], [-1, 1]];
        let upper = [[1, 0], [1, 1], [0, 1], [0, 0], [2, 0], [0, 2]];
        let vertex = |x: i64, y: i64| {
            let n = side as i64;
            let x = if tube { x.rem_euclid(n) } else { x };
            ((0..n).contains(&x) && (0..n).contains(&y)).then_some((y * n + x) as usize)
        };
        let wide = side - usize::from(!tube);
        let cells = (0..wide * (side - 1)).map(|cell| ((cell % wide) as i64, (cell / wide) as i64));
        let elements: Vec<Vec<usize>> = cells
            .flat_map(|cell| [(cell, lower), (cell, upper)])
            .map(|((x, y), corners)| corners.into_iter().filter_map(|[right, up]| vertex(x + right, y + up)).collect::<Vec<_>>())
            .map(|corners| corners.into_iter().flat_map(|v| [3 * v, 3 * v + 1, 3 * v + 2]).collect())
            .collect();
        SymmetricPattern::from_elements(3 * side * side, elements.iter().map(Vec::as_slice))
    }

    /// Diagonally dominant values with negative, uneven couplings.
    fn dominant(pattern: &SymmetricPattern) -> Vec<f64> {
        let (mut values, mut sums) = (vec![0.0; pattern.entry_count()], vec![0.1; pattern.size()]);
        for column in 0..pattern.size() {
            for slot in pattern.columns[column] + 1..pattern.columns[column + 1] {
                values[slot] = -1.0 - 0.5 * (slot as f64).sin();
                sums[column] -= values[slot];
                sums[pattern.rows[slot]] -= values[slot];
            }
        }
        for column in 0..pattern.size() {
            values[pattern.columns[column]] = sums[column];
        }
        values
    }

    #[test]
    fn dissection_beats_minimum_degree_on_a_tube_and_is_as_good_on_a_sheet() {
        for (tube, entries, work) in [(true, 0.9, 0.8), (false, 1.03, 1.03)] {
            let pattern = shell(100, tube);
            let dissected = ordered(&pattern, &dissect(&pattern)).unwrap();
            let by_degree = analyse(&pattern, SymmetricOrdering::Amd).unwrap();
            assert!((dissected.len_val() as f64) < entries * by_degree.len_val() as f64, "tube {tube}");
            assert!(operations(&dissected) < work * operations(&by_degree), "tube {tube}");
            // The one with less work is taken, in fronts.
            // The coordinates of a vertex together cost no more.
            let groups: Vec<usize> = (0..pattern.size()).map(|unknown| unknown / 3).collect();
            let grouped = Cholesky::for_many(pattern.clone(), Some(&groups)).unwrap();
            assert!(grouped.fronts.is_some());
            assert!(grouped.asked < 1.03 * operations(&dissected).min(operations(&by_degree)));
            let many = Cholesky::for_many(pattern, None).unwrap();
            assert!(many.fronts.is_some());
            assert_eq!(operations(&many.symbolic), operations(&dissected).min(operations(&by_degree)));
        }
    }

    #[test]
    fn many_solves_are_right_and_the_same_for_any_number_of_threads() {
        let pattern = shell(60, true);
        let n = pattern.size();
        let mut values = dominant(&pattern);
        let expected: Vec<f64> = (0..n).map(|i| (i as f64 * 0.7).sin()).collect();
        let mut right = vec![0.0; n];
        pattern.multiply(&values, &expected, &mut right);
        let solved = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let mut cholesky = Cholesky::for_many(pattern.clone(), None).unwrap();
                assert!(cholesky.fronts.is_some() && cholesky.factorise(&values));
                let mut x = right.clone();
                cholesky.solve(&mut x);
                (x, cholesky.factor)
            })
        };
        let (x, factor) = solved(1);
        assert!(x.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-10));
        for threads in [2, 4] {
            assert!(solved(threads).1.iter().zip(&factor).all(|(a, b)| a.to_bits() == b.to_bits()));
        }
        values[pattern.slot(n / 2, n / 2)] = 1.0;
        assert!(!Cholesky::for_many(pattern, None).unwrap().factorise(&values));
    }
}
