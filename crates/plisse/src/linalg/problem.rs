//! The interface between an energy and [`super::newton`], which minimises it.

use super::psd_projection::PsdProjection;
use super::sparse::SymmetricPattern;
use super::symbolic::IndexBlocks;

/// A smooth energy of `n` unknowns with lower bounds, a gradient and a sparse Hessian.
///
/// Energy and unknowns are expected to be without unit and of order one, so that no tolerance mixes
/// units.
pub trait Problem: Send {
    /// Sparsity pattern of the Hessian.
    fn pattern(&self) -> SymmetricPattern;
    /// `[n]` lower bound of each unknown; −∞ for none.
    fn lower_bounds(&self) -> Vec<f64>;
    /// The energy at `x`.
    fn energy(&mut self, x: &[f64]) -> f64;
    /// The energy at `x` and its gradient; remembers `x` for [`Problem::hessian`].
    fn value_and_gradient(&mut self, x: &[f64], gradient: &mut [f64]) -> f64;
    /// Values on [`Problem::pattern`] of the Hessian at the `x` that was last given to
    /// [`Problem::value_and_gradient`], with every element's Hessian projected as `projection`
    /// says.
    fn hessian(&mut self, projection: PsdProjection, values: &mut [f64]);
    /// Adds to `out` (`[n]`) the product with `x` (`[n]`) of the Hessian's remainder: small, far
    /// couplings that [`Problem::pattern`] leaves out. The values on the pattern must then bound
    /// the whole Hessian from above. Returns true if there is a remainder.
    fn apply_hessian_remainder(&self, x: &[f64], out: &mut [f64]) -> bool {
        let _ = (x, out);
        false
    }
    /// The largest step size (0 to 1) along `direction` from `x`, the point of the last evaluation,
    /// that an energy with walls (contact) allows.
    fn max_step_size(&mut self, x: &[f64], direction: &[f64]) -> f64 {
        let _ = (x, direction);
        1.0
    }
    /// The new pattern, if unknowns became coupled (by contact) that were not before. Asked for
    /// after [`Problem::value_and_gradient`].
    fn new_sparsity(&mut self) -> Option<SymmetricPattern> {
        None
    }
    /// Index blocks of the present pattern (the coordinates of each vertex); `None` if the unknowns
    /// have no known blocks.
    fn index_blocks(&self) -> Option<IndexBlocks> {
        None
    }
}
