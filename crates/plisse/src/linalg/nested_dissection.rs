//! Nested dissection (George 1973): an elimination order that keeps the factor of a mesh's matrix
//! sparse.
//!
//! Indistinguishable unknowns (the coordinates of a vertex) are compressed to one node of a graph.
//! A vertex separator, a few nodes without which the graph falls into two halves, is eliminated
//! last; each half is dissected in the same way. To find a separator, nodes far from each other are
//! taken as poles, and the nodes nearer to one pole than to the other are one half. The rim between
//! the halves is then refined by single moves, also through worse states (Fiduccia & Mattheyses
//! 1982). The best of several cuts counts: a tube is cut across or along, whichever is shorter.

use std::cmp::Reverse;
use std::collections::VecDeque;

use rayon::prelude::*;

use super::graph::{Graph, adjacency_with_loops};
use super::separator::{SEPARATOR, Separator};
use super::sparse::SymmetricPattern;
use crate::adjacency::NONE;

/// Largest number of nodes of a part that is not dissected any further.
const MAX_LEAF: usize = 16;
/// Number of cuts, of those along several pairs of poles, that are refined.
const REFINED_CUTS: usize = 2;
/// Number of nodes from which on the two halves of a part are ordered in parallel.
const PARALLEL_NODES: usize = 2000;

/// An elimination order of the unknowns of `pattern`.
pub(super) fn dissect(pattern: &SymmetricPattern) -> Vec<usize> {
    let (graph, members) = compress(pattern);
    dissect_part(&graph, &(0..graph.size()).collect::<Vec<_>>())
        .into_iter()
        .flat_map(|node| members[node].iter().copied())
        .collect()
}

/// The graph of `pattern` with indistinguishable unknowns (those with the same couplings)
/// compressed to one node, and the unknowns of each node.
fn compress(pattern: &SymmetricPattern) -> (Graph, Vec<Vec<usize>>) {
    let n = pattern.size();
    let couplings = adjacency_with_loops(pattern);
    let list = |i: usize| &couplings[i];
    let (mut node_of, mut members) = (vec![NONE; n], Vec::<Vec<usize>>::new());
    for i in 0..n {
        let same = list(i)
            .iter()
            .take_while(|&&j| j < i)
            .map(|&j| node_of[j])
            .find(|&node| list(members[node][0]) == list(i));
        node_of[i] = same.unwrap_or(members.len());
        match same {
            Some(node) => members[node].push(i),
            None => members.push(vec![i]),
        }
    }
    let (mut pairs, mut seen) = (Vec::new(), vec![NONE; members.len()]);
    for (node, unknowns) in members.iter().enumerate() {
        seen[node] = node;
        for &j in list(unknowns[0]) {
            let other = node_of[j];
            if seen[other] != node {
                seen[other] = node;
                pairs.push((node, other));
            }
        }
    }
    let weights = members.iter().map(Vec::len).collect();
    (Graph::new(weights, pairs.into_iter()), members)
}

/// An order of the nodes of `graph`, a part whose nodes are called `names` in the whole.
fn dissect_part(graph: &Graph, names: &[usize]) -> Vec<usize> {
    let halves = if graph.size() > MAX_LEAF { bisect(graph) } else { Vec::new() };
    if !halves.contains(&0) || !halves.contains(&1) {
        return names.to_vec();
    }
    let order_half = |half: usize| {
        let nodes: Vec<usize> = (0..graph.size()).filter(|&node| halves[node] == half).collect();
        let names: Vec<usize> = nodes.iter().map(|&node| names[node]).collect();
        dissect_part(&graph.induced(&nodes), &names)
    };
    let (mut order, second) = if graph.size() < PARALLEL_NODES {
        (order_half(0), order_half(1))
    } else {
        rayon::join(|| order_half(0), || order_half(1))
    };
    order.extend(second);
    order.extend(
        (0..graph.size()).filter(|&node| halves[node] == SEPARATOR).map(|node| names[node]),
    );
    order
}

/// `[n]` half of each node, or [`SEPARATOR`]; no node of one half is a neighbour of one of the
/// other.
fn bisect(graph: &Graph) -> Vec<usize> {
    let n = graph.size();
    let (_, reached) = graph.bfs_levels(0);
    if reached.len() < n {
        return bisect_components(graph);
    }
    let a = reached[n - 1];
    let (from_a, reached) = graph.bfs_levels(a);
    let b = reached[n - 1];
    let (from_b, _) = graph.bfs_levels(b);
    // Two more poles, far from both and from each other: with a and b the corners of a sheet.
    let c = (0..n).max_by_key(|&node| (from_a[node].min(from_b[node]), Reverse(node))).unwrap_or(a);
    let (from_c, reached) = graph.bfs_levels(c);
    let d = reached[n - 1];
    let (from_d, _) = graph.bfs_levels(d);
    let cut = |signs: [i64; 4]| {
        let level = |node: usize| {
            [&from_a, &from_b, &from_c, &from_d]
                .iter()
                .zip(signs)
                .map(|(from, sign)| sign * from[node] as i64)
                .sum::<i64>()
        };
        Separator::at_median(graph, level)
    };
    let signs = vec![[1, -1, 0, 0], [0, 0, 1, -1], [1, -1, 1, -1], [1, -1, -1, 1]];
    let mut cuts = map_maybe_parallel(n, signs, cut);
    // Those that are poor before refinement are poor after it.
    cuts.sort_by(|a, b| a.cost().total_cmp(&b.cost()));
    cuts.truncate(REFINED_CUTS);
    let cuts = map_maybe_parallel(n, cuts, |mut cut| {
        cut.refine();
        cut
    });
    cuts.into_iter()
        .min_by(|a, b| a.cost().total_cmp(&b.cost()))
        .map_or_else(Vec::new, Separator::into_halves)
}

/// The images of `all` under `map`, in parallel if there are many `nodes`.
fn map_maybe_parallel<S: Send, T: Send>(
    nodes: usize,
    all: Vec<S>,
    map: impl Fn(S) -> T + Sync + Send,
) -> Vec<T> {
    if nodes < PARALLEL_NODES {
        all.into_iter().map(map).collect()
    } else {
        all.into_par_iter().map(map).collect()
    }
}

/// `[n]` half of each node: the connected components of `graph`, divided into two halves of about
/// the same weight.
fn bisect_components(graph: &Graph) -> Vec<usize> {
    let (mut half, mut weights, mut queue) = (vec![NONE; graph.size()], [0; 2], VecDeque::new());
    for start in 0..graph.size() {
        if half[start] != NONE {
            continue;
        }
        let lighter = usize::from(weights[1] < weights[0]);
        half[start] = lighter;
        queue.push_back(start);
        while let Some(node) = queue.pop_front() {
            weights[lighter] += graph.weights[node];
            for &other in graph.neighbours(node) {
                if half[other] == NONE {
                    half[other] = lighter;
                    queue.push_back(other);
                }
            }
        }
    }
    half
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::separator::MAX_HALF_SHARE;

    /// The triangles of a sheet of `wide` × `high` cells, rolled to a tube if `tube`; with two
    /// unknowns for each vertex.
    fn sheet(wide: usize, high: usize, tube: bool) -> SymmetricPattern {
        let columns = wide + usize::from(!tube);
        let at = |x: usize, y: usize| y * columns + x % columns;
        let cells = (0..wide * high).map(|cell| (cell % wide, cell / wide));
        let triangles = cells.flat_map(|(x, y)| {
            [[at(x, y), at(x + 1, y), at(x, y + 1)], [at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)]]
        });
        let elements: Vec<Vec<usize>> =
            triangles.map(|t| t.iter().flat_map(|&v| [2 * v, 2 * v + 1]).collect()).collect();
        SymmetricPattern::from_elements(
            2 * columns * (high + 1),
            elements.iter().map(Vec::as_slice),
        )
    }

    #[test]
    fn every_unknown_comes_once_and_always_at_the_same_place() {
        // Also unknowns without couplings, and none at all.
        let alone = SymmetricPattern::from_elements(500, std::iter::empty());
        let none = SymmetricPattern::from_elements(0, std::iter::empty());
        for pattern in [sheet(30, 20, false), sheet(40, 70, true), alone, none] {
            let order = dissect(&pattern);
            assert_eq!(
                order,
                rayon::ThreadPoolBuilder::new()
                    .num_threads(1)
                    .build()
                    .unwrap()
                    .install(|| dissect(&pattern))
            );
            let mut sorted = order;
            sorted.sort_unstable();
            assert!(sorted.into_iter().eq(0..pattern.size()));
        }
    }

    #[test]
    fn the_unknowns_of_a_vertex_are_one_node() {
        let (graph, members) = compress(&sheet(10, 10, false));
        assert_eq!(graph.size(), 121);
        assert!(members.iter().enumerate().all(|(v, unknowns)| unknowns[..] == [2 * v, 2 * v + 1]));
    }

    #[test]
    fn cuts_are_clean_light_and_even() {
        // A long tube is cut around, a short one along (twice), a square once through the middle.
        for (wide, high, tube, lightest) in
            [(20, 80, true, 20), (100, 15, true, 2 * 16), (40, 40, false, 41)]
        {
            let (graph, _) = compress(&sheet(wide, high, tube));
            let half = bisect(&graph);
            for node in 0..graph.size() {
                assert!(
                    half[node] == SEPARATOR
                        || graph
                            .neighbours(node)
                            .iter()
                            .all(|&other| half[other] != 1 - half[node])
                );
            }
            let count = |which| half.iter().filter(|&&half| half == which).count();
            assert!(
                count(SEPARATOR) <= lightest + lightest / 4,
                "{} of {lightest}",
                count(SEPARATOR)
            );
            assert!(count(0).max(count(1)) as f64 <= MAX_HALF_SHARE * graph.size() as f64 + 1.0);
        }
    }
}
