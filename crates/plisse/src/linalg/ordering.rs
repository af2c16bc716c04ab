//! Which unknown is eliminated when, so that the factor stays sparse.
//!
//! Minimum degree and nested dissection are both tried, and the one with less work is taken. Where it is known which unknowns belong
//! together (the coordinates of a vertex), they go together: then the graph of the groups, with a third of the nodes and a tenth of the
//! couplings, is ordered instead.

use faer::Side;
use faer::perm::PermRef;
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering, factorize_symbolic_cholesky,
};

use super::dissection::{dissect, in_pieces};
use super::sparse::SymmetricPattern;
use crate::{Error, Result};

/// Unknowns, and groups of them, from which on a dissection is worth its time.
pub(super) const LARGE: usize = 6000;
const LARGE_GROUPS: usize = 2000;
/// Groups that are coupled with this many times more others than most go last.
const HUB: usize = 8;

/// The symbolic factorisation of `pattern` in the better of two orders; in that of minimum degree if it has less than `large` unknowns.
///
/// # Errors
/// [`Error::Numeric`] when memory runs out.
pub(super) fn best(pattern: &SymmetricPattern, large: usize) -> Result<SymbolicCholesky<usize>> {
    let by_degree = || analyse(pattern, SymmetricOrdering::Amd);
    if pattern.size() < large {
        return by_degree();
    }
    let (by_degree, dissected) = rayon::join(by_degree, || ordered(pattern, &dissect(pattern)));
    let (by_degree, dissected) = (by_degree?, dissected?);
    Ok(if operations(&dissected) < operations(&by_degree) { dissected } else { by_degree })
}

/// An order of elimination (the unknown that goes first, the one after it, …) of `pattern` in which unknowns of the same group (`[n]`, any
/// numbers) go together.
///
/// # Errors
/// [`Error::Numeric`] when memory runs out.
pub(super) fn together(pattern: &SymmetricPattern, groups: &[usize]) -> Result<Vec<usize>> {
    let (graph, members) = grouped(pattern, groups);
    let (few, hubs) = without_hubs(&graph);
    let symbolic = best(&few.graph, LARGE_GROUPS)?;
    let order = symbolic.perm().map_or_else(|| (0..few.names.len()).collect(), |perm| perm.arrays().0.to_vec());
    let order: Vec<usize> = order.into_iter().map(|group| few.names[group]).chain(hubs).collect();
    Ok(in_pieces(&graph, &order).into_iter().flat_map(|group| members[group].iter().copied()).collect())
}

/// A part of a graph, and the numbers of its nodes in the whole.
struct Part {
    graph: SymmetricPattern,
    names: Vec<usize>,
}

/// What is left without nodes of very many couplings, by which all would be near to all; and these nodes.
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

/// The couplings of groups, and the unknowns of each.
fn grouped(pattern: &SymmetricPattern, groups: &[usize]) -> (SymmetricPattern, Vec<Vec<usize>>) {
    let mut number = vec![usize::MAX; groups.iter().max().map_or(0, |most| most + 1)];
    let mut members: Vec<Vec<usize>> = Vec::new();
    for (unknown, &group) in groups.iter().enumerate() {
        if number[group] == usize::MAX {
            number[group] = members.len();
            members.push(Vec::new());
        }
        members[number[group]].push(unknown);
    }
    let of = |unknown: usize| number[groups[unknown]];
    let mut lists: Vec<Vec<usize>> = (0..members.len()).map(|group| vec![group]).collect();
    let mut seen_by = vec![usize::MAX; members.len()];
    for (group, unknowns) in members.iter().enumerate() {
        seen_by[group] = group;
        for &unknown in unknowns {
            for &row in &pattern.rows[pattern.columns[unknown]..pattern.columns[unknown + 1]] {
                let other = of(row);
                if seen_by[other] != group {
                    seen_by[other] = group;
                    lists[group.min(other)].push(group.max(other));
                }
            }
        }
    }
    (SymmetricPattern::from_columns(lists), members)
}

/// The symbolic factorisation of `pattern` in this order of elimination.
///
/// # Errors
/// [`Error::Numeric`] when memory runs out.
pub(super) fn ordered(pattern: &SymmetricPattern, order: &[usize]) -> Result<SymbolicCholesky<usize>> {
    let mut place = vec![0; order.len()];
    for (k, &unknown) in order.iter().enumerate() {
        place[unknown] = k;
    }
    analyse(pattern, SymmetricOrdering::Custom(PermRef::new_checked(order, &place, order.len())))
}

/// The symbolic factorisation of `pattern`.
///
/// # Errors
/// [`Error::Numeric`] when memory runs out.
pub(super) fn analyse(pattern: &SymmetricPattern, ordering: SymmetricOrdering<'_, usize>) -> Result<SymbolicCholesky<usize>> {
    factorize_symbolic_cholesky(view(pattern), Side::Lower, ordering, CholeskySymbolicParams::default())
        .map_err(|e| Error::numeric("factorisation", format!("the matrix could not be analysed ({e:?}); use a smaller mesh")))
}

/// Floating-point operations of one factorisation: the sum of squares of the entries in each column.
pub(super) fn operations(symbolic: &SymbolicCholesky<usize>) -> f64 {
    match symbolic.raw() {
        SymbolicCholeskyRaw::Simplicial(factor) => factor.col_ptr().windows(2).map(|ends| ((ends[1] - ends[0]) as f64).powi(2)).sum(),
        SymbolicCholeskyRaw::Supernodal(factor) => {
            let columns = factor.supernode_begin().iter().zip(factor.supernode_end()).map(|(begin, end)| end - begin);
            let squares = |(s, width): (usize, usize)| {
                let below = factor.supernode(s).pattern().len();
                (below + 1..=below + width).map(|rows| (rows * rows) as f64).sum::<f64>()
            };
            columns.enumerate().map(squares).sum()
        }
    }
}

/// `pattern` as faer takes it.
pub(super) fn view(pattern: &SymmetricPattern) -> SymbolicSparseColMatRef<'_, usize> {
    let n = pattern.size();
    SymbolicSparseColMatRef::new_checked(n, n, &pattern.columns, None, &pattern.rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_are_coupled_as_their_unknowns_are_and_stay_together() {
        // Unknowns 0 and 3, 1 and 4, 2 and 5, and 6 alone.
        let groups = [7, 2, 9, 7, 2, 9, 4];
        let elements = [vec![0, 1], vec![5, 4], vec![3, 6]];
        let pattern = SymmetricPattern::from_elements(7, elements.iter().map(Vec::as_slice));
        let (graph, members) = grouped(&pattern, &groups);
        assert_eq!(members, [vec![0, 3], vec![1, 4], vec![2, 5], vec![6]]);
        assert_eq!((graph.columns, graph.rows), (vec![0, 3, 5, 6, 7], vec![0, 1, 3, 1, 2, 2, 3]));
        let order = together(&pattern, &groups).unwrap();
        for [a, b] in [[0, 3], [1, 4], [2, 5]] {
            let at = |unknown: usize| order.iter().position(|&u| u == unknown).unwrap();
            assert_eq!(at(a) + 1, at(b));
        }
        assert_eq!(order.len(), 7);
    }
}
