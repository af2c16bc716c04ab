//! Which unknown is eliminated when, so that the factor stays sparse.
//!
//! Minimum degree and, where there is much to eliminate, nested dissection are tried, and the one
//! with less work is taken. Where it is known which unknowns belong together (the coordinates of a
//! vertex), they go together: then the graph of the groups is ordered instead.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::amd;

use super::dissection::dissect;
use super::elimination::{Elimination, Groups};
use super::sparse::SymmetricPattern;
use crate::{Error, Result};

/// Unknowns, and groups of them, from which on a dissection is worth its time.
pub(super) const LARGE: usize = 6000;
pub(super) const LARGE_GROUPS: usize = 2000;
/// Groups that are coupled with this many times more others than most go last.
const HUB: usize = 8;

/// The elimination of `groups` in a good order; a dissection is tried from `large` groups on.
///
/// # Errors
/// [`Error::Numeric`] when memory runs out.
pub(super) fn best(groups: &Groups, large: usize) -> Result<Elimination> {
    let (few, hubs) = without_hubs(&groups.graph);
    let by = |order: Vec<usize>| {
        let order: Vec<usize> =
            order.into_iter().map(|group| few.names[group]).chain(hubs.iter().copied()).collect();
        Elimination::of(groups, &order)
    };
    let (by_degree, dissected) = rayon::join(
        || minimum_degree(&few.graph).map(by),
        || (few.names.len() >= large).then(|| by(dissect(&few.graph))),
    );
    let by_degree = by_degree?;
    Ok(dissected
        .filter(|dissected| dissected.operations < by_degree.operations)
        .unwrap_or(by_degree))
}

/// Each unknown of `pattern` as a group of its own.
pub(super) fn alone(pattern: &SymmetricPattern) -> Groups {
    Groups {
        graph: pattern.clone(),
        members: (0..pattern.size()).map(|unknown| vec![unknown]).collect(),
    }
}

/// An order by approximate minimum degree.
pub(super) fn minimum_degree(graph: &SymmetricPattern) -> Result<Vec<usize>> {
    let (n, entries) = (graph.size(), graph.entry_count());
    let (mut order, mut place) = (vec![0; n], vec![0; n]);
    let mut memory = MemBuffer::new(amd::order_maybe_unsorted_scratch::<usize>(n, entries));
    amd::order_maybe_unsorted(
        &mut order,
        &mut place,
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

/// A part of a graph, and the numbers of its nodes in the whole.
struct Part {
    graph: SymmetricPattern,
    names: Vec<usize>,
}

/// What is left without nodes of very many couplings, by which all would be near to all; and these
/// nodes.
fn without_hubs(graph: &SymmetricPattern) -> (Part, Vec<usize>) {
    let n = graph.size();
    let mut count = vec![0; n];
    for column in 0..n {
        for &row in &graph.rows[graph.columns[column]..graph.columns[column + 1]] {
            count[row] += 1;
            count[column] += 1;
        }
    }
    let most = HUB * count.iter().sum::<usize>() / n.max(1);
    let (names, hubs): (Vec<usize>, Vec<usize>) = (0..n).partition(|&node| count[node] <= most);
    let mut number = vec![usize::MAX; n];
    names.iter().enumerate().for_each(|(new, &old)| number[old] = new);
    let (mut columns, mut rows) = (vec![0], Vec::new());
    for &old in &names {
        let all = graph.rows[graph.columns[old]..graph.columns[old + 1]].iter();
        rows.extend(all.map(|&row| number[row]).filter(|&new| new != usize::MAX));
        columns.push(rows.len());
    }
    (Part { graph: SymmetricPattern { columns, rows }, names }, hubs)
}

/// `pattern` as faer takes it.
pub(super) fn view(pattern: &SymmetricPattern) -> SymbolicSparseColMatRef<'_, usize> {
    let n = pattern.size();
    SymbolicSparseColMatRef::new_checked(n, n, &pattern.columns, None, &pattern.rows)
}
