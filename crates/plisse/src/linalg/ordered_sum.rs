//! Parallel sums in a fixed order: the same bits for any number of threads.

use rayon::prelude::*;

/// Terms in one block of a sum, and elements in one block of a parallel loop: enough work to be
/// worth a thread.
pub(crate) const CHUNK: usize = 128;

/// Sum of `term` over 0..n in a fixed order.
pub(crate) fn ordered_sum(n: usize, term: impl Fn(usize) -> f64 + Sync) -> f64 {
    let block = |c: usize| -> f64 { (c * CHUNK..n.min((c + 1) * CHUNK)).map(&term).sum() };
    let sums: Vec<f64> = (0..n.div_ceil(CHUNK)).into_par_iter().map(block).collect();
    sums.iter().sum()
}
