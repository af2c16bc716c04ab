//! Sparse Cholesky factorisation of matrices that share one pattern: ordering and symbolic analysis
//! once, numeric factorisation as often as wanted.
//!
//! For a few factorisations `faer` does everything. Its numeric part runs on one thread on purpose,
//! so that its rounding does not depend on the number of threads. A large matrix that is factorised
//! many times, or one with known index blocks, is ordered by the best of several methods
//! (`ordering`) and factorised by `multifrontal`, whose rounding does not depend on the threads
//! either.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::sparse::SparseColMatRef;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::{Conj, MatMut, Par, Side, Spec};

use super::multifrontal::Multifrontal;
use super::ordering::{MIN_DISSECTED_BLOCKS, MIN_DISSECTED_UNKNOWNS, best_ordering, view};
use super::sparse::SymmetricPattern;
use super::symbolic::{IndexBlocks, SymbolicFactorisation};
use crate::{Error, Result};

/// Slack of a kept ordering: reorder when added couplings raise the operation count above this
/// multiple of the original one.
const ORDERING_SLACK: f64 = 1.3;

/// A factorisation whose symbolic part is done.
pub struct Cholesky {
    pattern: SymmetricPattern,
    method: Method,
}

enum Method {
    /// By faer, for a few factorisations.
    Faer { symbolic: SymbolicCholesky<usize>, factor: Vec<f64>, memory: MemBuffer },
    /// By the multifrontal method, for many.
    Multifrontal {
        symbolic: SymbolicFactorisation,
        /// Operation count when the ordering was made.
        ordering_cost: f64,
        numeric: Multifrontal,
    },
}

impl Cholesky {
    /// Orders and analyses `pattern` for a few factorisations.
    ///
    /// # Errors
    /// [`crate::Error::Numeric`] when memory runs out.
    pub fn new(pattern: SymmetricPattern) -> Result<Self> {
        let params = CholeskySymbolicParams::default();
        let symbolic = factorize_symbolic_cholesky(
            view(&pattern),
            Side::Lower,
            SymmetricOrdering::Amd,
            params,
        )
        .map_err(|e| {
            Error::numeric(
                "factorisation",
                format!("the matrix could not be analysed ({e:?}); use a smaller mesh"),
            )
        })?;
        let factorise = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Spec::default());
        let memory =
            MemBuffer::new(symbolic.solve_in_place_scratch::<f64>(8, Par::Seq).or(factorise));
        let factor = vec![0.0; symbolic.len_val()];
        Ok(Self { pattern, method: Method::Faer { symbolic, factor, memory } })
    }

    /// Orders and analyses `pattern` for many factorisations: takes longer if the matrix is large,
    /// so that they take less. Unknowns of the same one of the `blocks` are eliminated together.
    ///
    /// # Errors
    /// [`crate::Error::Numeric`] when memory runs out.
    pub fn for_many(pattern: SymmetricPattern, blocks: Option<IndexBlocks>) -> Result<Self> {
        let symbolic = match blocks {
            Some(blocks) => best_ordering(&blocks, MIN_DISSECTED_BLOCKS)?,
            None if pattern.size() < MIN_DISSECTED_UNKNOWNS => return Self::new(pattern),
            None => best_ordering(&IndexBlocks::scalar(&pattern), MIN_DISSECTED_UNKNOWNS)?,
        };
        let ordering_cost = symbolic.operations;
        Ok(Self::multifrontal(pattern, symbolic, ordering_cost))
    }

    fn multifrontal(
        pattern: SymmetricPattern,
        symbolic: SymbolicFactorisation,
        ordering_cost: f64,
    ) -> Self {
        let numeric = Multifrontal::new(&pattern, &symbolic);
        Self { pattern, method: Method::Multifrontal { symbolic, ordering_cost, numeric } }
    }

    /// Exchanges the pattern, e.g. for one with more couplings, and analyses it as
    /// [`Cholesky::for_many`] does. The ordering is kept as long as it is good.
    ///
    /// # Errors
    /// As [`Cholesky::for_many`].
    pub fn reanalyse(
        &mut self,
        pattern: SymmetricPattern,
        blocks: Option<IndexBlocks>,
    ) -> Result<()> {
        if let Method::Multifrontal { symbolic, ordering_cost, .. } = &self.method
            && let Some(blocks) = &blocks
        {
            let ordering_cost = *ordering_cost;
            let symbolic = SymbolicFactorisation::analyse(blocks, &symbolic.block_order);
            if symbolic.operations <= ORDERING_SLACK * ordering_cost {
                *self = Self::multifrontal(pattern, symbolic, ordering_cost);
                return Ok(());
            }
        }
        *self = Self::for_many(pattern, blocks)?;
        Ok(())
    }

    /// The pattern that is factorised.
    pub fn pattern(&self) -> &SymmetricPattern {
        &self.pattern
    }

    /// Factorises the matrix with these lower-triangle `values`. Returns false if it is not
    /// positive definite; then [`Cholesky::solve`] must not follow.
    pub fn factorise(&mut self, values: &[f64]) -> bool {
        match &mut self.method {
            Method::Multifrontal { numeric, .. } => numeric.factorise(values),
            Method::Faer { symbolic, factor, memory } => {
                let matrix = SparseColMatRef::new(view(&self.pattern), values);
                let (side, regularisation) = (Side::Lower, LltRegularization::default());
                let stack = MemStack::new(memory);
                symbolic
                    .factorize_numeric_llt(
                        factor,
                        matrix,
                        side,
                        regularisation,
                        Par::Seq,
                        stack,
                        Spec::default(),
                    )
                    .is_ok()
            }
        }
    }

    /// Replaces `x` by A⁻¹x.
    pub fn solve(&mut self, x: &mut [f64]) {
        match &mut self.method {
            Method::Multifrontal { numeric, .. } => numeric.solve(x),
            Method::Faer { symbolic, factor, memory } => {
                let n = x.len();
                let x = MatMut::from_column_major_slice_mut(x, n, 1);
                LltRef::new(symbolic, factor).solve_in_place_with_conj(
                    Conj::No,
                    x,
                    Par::Seq,
                    MemStack::new(memory),
                );
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::nested_dissection::dissect;
    use crate::linalg::ordering::minimum_degree;

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

    /// The couplings of a reference shell on `side` × `side` vertices, flat or rolled to a tube:
    /// three unknowns for each vertex, and elements of a triangle with the far corners of its
    /// neighbours.
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
            .map(|((x, y), corners)| {
                corners
                    .into_iter()
                    .filter_map(|[right, up]| vertex(x + right, y + up))
                    .collect::<Vec<_>>()
            })
            .map(|corners| {
                corners.into_iter().flat_map(|v| [3 * v, 3 * v + 1, 3 * v + 2]).collect()
            })
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
            let unknowns = IndexBlocks::scalar(&pattern);
            let dissected = SymbolicFactorisation::analyse(&unknowns, &dissect(&pattern));
            let by_degree =
                SymbolicFactorisation::analyse(&unknowns, &minimum_degree(&pattern).unwrap());
            let stored = |symbolic: &SymbolicFactorisation| {
                symbolic
                    .supernodes
                    .iter()
                    .map(|node| node.columns.len() * (node.columns.len() + node.rows.len()))
                    .sum::<usize>() as f64
            };
            assert!(stored(&dissected) < entries * stored(&by_degree), "tube {tube}");
            assert!(dissected.operations < work * by_degree.operations, "tube {tube}");
            // The one with less work is taken; the coordinates of a vertex together cost no more.
            let least = dissected.operations.min(by_degree.operations);
            let vertices = pattern.size() / 3;
            let below = |v: usize| {
                pattern.rows[pattern.columns[3 * v]..pattern.columns[3 * v + 1]]
                    .iter()
                    .map(|row| row / 3)
                    .collect()
            };
            let graph = SymmetricPattern::from_columns((0..vertices).map(below).collect());
            let blocks = IndexBlocks {
                graph,
                members: (0..vertices).map(|v| vec![3 * v, 3 * v + 1, 3 * v + 2]).collect(),
            };
            assert!(
                best_ordering(&blocks, MIN_DISSECTED_BLOCKS).unwrap().operations < 1.03 * least
            );
            assert_eq!(best_ordering(&unknowns, MIN_DISSECTED_UNKNOWNS).unwrap().operations, least);
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
                assert!(
                    matches!(cholesky.method, Method::Multifrontal { .. })
                        && cholesky.factorise(&values)
                );
                let mut x = right.clone();
                cholesky.solve(&mut x);
                // Once more, in memory that was used before.
                assert!(cholesky.factorise(&values));
                let mut second = right.clone();
                cholesky.solve(&mut second);
                (x, second)
            })
        };
        let (x, second) = solved(1);
        assert!(x.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-10));
        for other in [second, solved(2).0, solved(4).0, solved(4).1] {
            assert!(x.iter().zip(&other).all(|(a, b)| a.to_bits() == b.to_bits()));
        }
        values[pattern.slot(n / 2, n / 2)] = 1.0;
        assert!(!Cholesky::for_many(pattern, None).unwrap().factorise(&values));
    }

    /// A ribbon that is eliminated from one end to the other: every front waits for the one before
    /// it.
    #[test]
    fn ribbons_may_be_as_long_as_they_like() {
        let n = 60_000;
        let elements: Vec<Vec<usize>> = (0..n - 6).map(|i| (i..i + 7).collect()).collect();
        let pattern = SymmetricPattern::from_elements(n, elements.iter().map(Vec::as_slice));
        let values = dominant(&pattern);
        let unknowns = IndexBlocks::scalar(&pattern);
        let expected: Vec<f64> = (0..n).map(|i| (i as f64 * 0.7).sin()).collect();
        let mut right = vec![0.0; n];
        pattern.multiply(&values, &expected, &mut right);
        let solved = |order: &[usize]| {
            let symbolic = SymbolicFactorisation::analyse(&unknowns, order);
            let cost = symbolic.operations;
            let mut cholesky = Cholesky::multifrontal(pattern.clone(), symbolic, cost);
            assert!(cholesky.factorise(&values));
            let mut x = right.clone();
            cholesky.solve(&mut x);
            x.iter().zip(&expected).fold(0.0_f64, |most, (x, e)| most.max((x - e).abs()))
        };
        let pool =
            rayon::ThreadPoolBuilder::new().num_threads(2).stack_size(1 << 19).build().unwrap();
        let along: Vec<usize> = (0..n).collect();
        // From both ends to the middle: two such ways at once.
        let inwards: Vec<usize> = (0..n / 2).flat_map(|i| [i, n - 1 - i]).collect();
        for order in [along, inwards, dissect(&pattern)] {
            let worst = pool.install(|| solved(&order));
            assert!(worst < 1e-10, "{worst:e}");
        }
    }
}
