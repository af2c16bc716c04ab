//! Sparse Cholesky factorisation (by `faer`) of matrices that share one pattern: ordering and symbolic part once, numeric
//! part as often as wanted without allocating.
//!
//! The numeric part runs on one thread on purpose, so that its rounding does not depend on the number of threads.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::sparse::linalg::cholesky::{CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side, Spec};

use super::sparse::SymmetricPattern;
use crate::{Error, Result};

/// A factorisation whose symbolic part is done.
pub struct Cholesky {
    pattern: SymmetricPattern,
    symbolic: SymbolicCholesky<usize>,
    factor: Vec<f64>,
    memory: MemBuffer,
}

impl Cholesky {
    /// Orders and analyses `pattern`.
    ///
    /// # Errors
    /// [`Error::Numeric`] when memory runs out.
    pub fn new(pattern: SymmetricPattern) -> Result<Self> {
        let symbolic = factorize_symbolic_cholesky(view(&pattern), Side::Lower, SymmetricOrdering::Amd, CholeskySymbolicParams::default())
            .map_err(|e| Error::numeric("factorisation", format!("the matrix could not be analysed ({e:?}); use a smaller mesh")))?;
        let need = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Spec::default());
        let memory = MemBuffer::new(need.or(symbolic.solve_in_place_scratch::<f64>(8, Par::Seq)));
        let factor = vec![0.0; symbolic.len_val()];
        Ok(Self { pattern, symbolic, factor, memory })
    }

    /// The pattern given to [`Cholesky::new`].
    pub fn pattern(&self) -> &SymmetricPattern {
        &self.pattern
    }

    /// Factorises the matrix with these lower-triangle `values`. Returns whether it is positive definite; only then may
    /// [`Cholesky::solve`] follow.
    pub fn factorise(&mut self, values: &[f64]) -> bool {
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

fn view(pattern: &SymmetricPattern) -> SymbolicSparseColMatRef<'_, usize> {
    let n = pattern.size();
    SymbolicSparseColMatRef::new_checked(n, n, &pattern.columns, None, &pattern.rows)
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
