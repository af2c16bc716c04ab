//! Fill-reducing orderings.
//!
//! Minimum degree and, for large graphs, nested dissection are tried, and the one with fewer
//! operations is taken. Index blocks (the coordinates of a vertex) stay together: the graph of the
//! blocks is ordered.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::amd;

use super::nested_dissection::dissect;
use super::sparse::SymmetricPattern;
use super::symbolic::{IndexBlocks, SymbolicFactorisation};
use crate::adjacency::NONE;
use crate::{Error, Result};

/// Number of unknowns, each a block of its own, from which on nested dissection is worth its time.
pub(super) const MIN_DISSECTED_UNKNOWNS: usize = 6000;
/// Number of blocks of several unknowns from which on nested dissection is worth its time.
pub(super) const MIN_DISSECTED_BLOCKS: usize = 2000;
/// Dense rows have more couplings than this multiple of the average; they are ordered last.
const DENSE_FACTOR: usize = 8;

/// Symbolic factorisation in the best ordering of `blocks`; nested dissection is tried if there are
/// at least `min_dissected`.
///
/// # Errors
/// [`Error::Numeric`] when memory runs out.
pub(super) fn best_ordering(
    blocks: &IndexBlocks,
    min_dissected: usize,
) -> Result<SymbolicFactorisation> {
    let (sparse, dense) = strip_dense_rows(&blocks.graph);
    let analyse = |order: Vec<usize>| {
        let order: Vec<usize> =
            order.into_iter().map(|node| sparse.nodes[node]).chain(dense.iter().copied()).collect();
        SymbolicFactorisation::analyse(blocks, &order)
    };
    let (by_degree, dissected) = rayon::join(
        || minimum_degree(&sparse.graph).map(analyse),
        || (sparse.nodes.len() >= min_dissected).then(|| analyse(dissect(&sparse.graph))),
    );
    let by_degree = by_degree?;
    Ok(dissected
        .filter(|dissected| dissected.operations < by_degree.operations)
        .unwrap_or(by_degree))
}

/// An approximate minimum degree ordering.
pub(super) fn minimum_degree(graph: &SymmetricPattern) -> Result<Vec<usize>> {
    let (n, entries) = (graph.size(), graph.entry_count());
    let (mut order, mut inverse) = (vec![0; n], vec![0; n]);
    let mut memory = MemBuffer::new(amd::order_maybe_unsorted_scratch::<usize>(n, entries));
    amd::order_maybe_unsorted(
        &mut order,
        &mut inverse,
        view(graph),
        amd::Control::default(),
        MemStack::new(&mut memory),
    )
    .map_err(|e| {
        Error::numeric(
            "factorisation",
            format!("the matrix could not be ordered ({e:?}); use a smaller mesh"),
        )
    })?;
    Ok(order)
}

/// A subgraph, and the numbers of its nodes in the whole.
struct Subgraph {
    graph: SymmetricPattern,
    nodes: Vec<usize>,
}

/// The subgraph without dense rows, which would make all nodes neighbours of neighbours; and the
/// dense rows.
fn strip_dense_rows(graph: &SymmetricPattern) -> (Subgraph, Vec<usize>) {
    let n = graph.size();
    let mut degree = vec![0; n];
    for column in 0..n {
        for &row in &graph.rows[graph.columns[column]..graph.columns[column + 1]] {
            degree[row] += 1;
            degree[column] += 1;
        }
    }
    let max_degree = DENSE_FACTOR * degree.iter().sum::<usize>() / n.max(1);
    let (nodes, dense): (Vec<usize>, Vec<usize>) =
        (0..n).partition(|&node| degree[node] <= max_degree);
    let mut number = vec![NONE; n];
    nodes.iter().enumerate().for_each(|(new, &old)| number[old] = new);
    let (mut columns, mut rows) = (vec![0], Vec::new());
    for &old in &nodes {
        let all = graph.rows[graph.columns[old]..graph.columns[old + 1]].iter();
        rows.extend(all.map(|&row| number[row]).filter(|&new| new != NONE));
        columns.push(rows.len());
    }
    (Subgraph { graph: SymmetricPattern { columns, rows }, nodes }, dense)
}

/// `pattern` as faer takes it.
pub(super) fn view(pattern: &SymmetricPattern) -> SymbolicSparseColMatRef<'_, usize> {
    let n = pattern.size();
    SymbolicSparseColMatRef::new_checked(n, n, &pattern.columns, None, &pattern.rows)
}
