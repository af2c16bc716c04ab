//! Nested dissection: an order for the elimination of unknowns that keeps the factor of a mesh's
//! matrix sparse.
//!
//! Unknowns with the same couplings (the coordinates of a vertex) are one node of a graph. A few
//! nodes, the separator, whose loss leaves two halves without a coupling are eliminated last; each
//! half is cut in the same way (George 1973). To find them, nodes far from each other are taken as
//! poles, and the nodes nearer to one pole than to the other are one half; the rim between the
//! halves is then improved by single moves, as Fiduccia & Mattheyses (1982) do it, also through
//! worse states. Of several pairs of poles the best cut counts: a tube is cut across or along,
//! whichever is shorter.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, VecDeque};

use rayon::prelude::*;

use super::elimination::couplings;
use super::sparse::SymmetricPattern;

/// Parts of at most this many nodes are not cut any further.
const LEAF: usize = 16;
/// Share of all weight that one half may have at most.
const LARGEST_HALF: f64 = 0.6;
/// Moves without gain after which a pass of improvement ends, and passes at most.
const IDLE_MOVES: usize = 40;
const PASSES: usize = 6;
/// Of the cuts along several pairs of poles, how many are improved.
const IMPROVED: usize = 2;
/// Nodes from which on the two halves of a part are ordered at the same time.
const PARALLEL: usize = 2000;

/// Half of a cut that a node belongs to: 0, 1 or the separator.
const SEPARATOR: usize = 2;

/// An order of elimination: the unknown that goes first, the one after it, ….
pub fn dissect(pattern: &SymmetricPattern) -> Vec<usize> {
    let (graph, members) = compress(pattern);
    order_part(&graph, &(0..graph.size()).collect::<Vec<_>>())
        .into_iter()
        .flat_map(|node| members[node].iter().copied())
        .collect()
}

/// An undirected graph without loops whose nodes have weights.
struct Graph {
    /// `[n+1]` where each node's list starts in `neighbours`.
    first: Vec<usize>,
    neighbours: Vec<usize>,
    /// `[n]` unknowns in each node.
    weights: Vec<usize>,
}

impl Graph {
    fn size(&self) -> usize {
        self.weights.len()
    }

    fn of(&self, node: usize) -> &[usize] {
        &self.neighbours[self.first[node]..self.first[node + 1]]
    }

    /// The graph among some `nodes`, which are numbered as they come.
    fn among(&self, nodes: &[usize]) -> Self {
        let mut place = vec![usize::MAX; self.size()];
        for (new, &old) in nodes.iter().enumerate() {
            place[old] = new;
        }
        let (mut first, mut neighbours) = (vec![0], Vec::new());
        for &old in nodes {
            neighbours.extend(
                self.of(old).iter().map(|&other| place[other]).filter(|&new| new != usize::MAX),
            );
            first.push(neighbours.len());
        }
        Self { first, neighbours, weights: nodes.iter().map(|&node| self.weights[node]).collect() }
    }

    /// `[n]` steps from `start` to each node ([`usize::MAX`] where there is no way), and the nodes
    /// in the order in which they are reached.
    fn steps_from(&self, start: usize) -> (Vec<usize>, Vec<usize>) {
        let mut steps = vec![usize::MAX; self.size()];
        let (mut reached, mut next) = (vec![start], 0);
        steps[start] = 0;
        while next < reached.len() {
            let node = reached[next];
            next += 1;
            for &other in self.of(node) {
                if steps[other] == usize::MAX {
                    steps[other] = steps[node] + 1;
                    reached.push(other);
                }
            }
        }
        (steps, reached)
    }
}

/// The graph of `pattern` with unknowns that have the same couplings in one node, and the unknowns
/// of each node.
fn compress(pattern: &SymmetricPattern) -> (Graph, Vec<Vec<usize>>) {
    let n = pattern.size();
    let (first, lists) = couplings(pattern);
    let list = |i: usize| &lists[first[i]..first[i + 1]];
    let (mut node_of, mut members) = (vec![usize::MAX; n], Vec::<Vec<usize>>::new());
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
    let (mut graph, mut seen) = (
        Graph { first: vec![0], neighbours: Vec::new(), weights: Vec::new() },
        vec![usize::MAX; members.len()],
    );
    for (node, unknowns) in members.iter().enumerate() {
        seen[node] = node;
        for &j in list(unknowns[0]) {
            let other = node_of[j];
            if seen[other] != node {
                seen[other] = node;
                graph.neighbours.push(other);
            }
        }
        graph.first.push(graph.neighbours.len());
        graph.weights.push(unknowns.len());
    }
    (graph, members)
}

/// The order of the nodes of `graph`, whose names are `names`.
fn order_part(graph: &Graph, names: &[usize]) -> Vec<usize> {
    let halves = if graph.size() > LEAF { halve(graph) } else { Vec::new() };
    if !halves.contains(&0) || !halves.contains(&1) {
        return names.to_vec();
    }
    let order_half = |half: usize| {
        let nodes: Vec<usize> = (0..graph.size()).filter(|&node| halves[node] == half).collect();
        order_part(&graph.among(&nodes), &nodes.iter().map(|&node| names[node]).collect::<Vec<_>>())
    };
    let (mut order, second) = if graph.size() < PARALLEL {
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

/// `[n]` the half of each node; no node of one half is a neighbour of one of the other.
fn halve(graph: &Graph) -> Vec<usize> {
    let n = graph.size();
    let (_, reached) = graph.steps_from(0);
    if reached.len() < n {
        return halve_pieces(graph);
    }
    let a = reached[n - 1];
    let (from_a, reached) = graph.steps_from(a);
    let b = reached[n - 1];
    let (from_b, _) = graph.steps_from(b);
    // Two more poles, far from both and from each other: with a and b the corners of a sheet.
    let c = (0..n).max_by_key(|&node| (from_a[node].min(from_b[node]), Reverse(node))).unwrap_or(a);
    let (from_c, reached) = graph.steps_from(c);
    let d = reached[n - 1];
    let (from_d, _) = graph.steps_from(d);
    let cut = |signs: [i64; 4]| {
        let side = |node: usize| {
            [&from_a, &from_b, &from_c, &from_d]
                .iter()
                .zip(signs)
                .map(|(from, sign)| sign * from[node] as i64)
                .sum::<i64>()
        };
        Cut::along(graph, side)
    };
    let mut cuts = each(n, vec![[1, -1, 0, 0], [0, 0, 1, -1], [1, -1, 1, -1], [1, -1, -1, 1]], cut);
    // Those that are poor as they are stay so.
    cuts.sort_by(|a, b| a.cost().total_cmp(&b.cost()));
    cuts.truncate(IMPROVED);
    let cuts = each(n, cuts, |mut cut| {
        cut.improve();
        cut
    });
    cuts.into_iter()
        .min_by(|a, b| a.cost().total_cmp(&b.cost()))
        .map_or_else(Vec::new, |cut| cut.half)
}

/// What `of` makes of each, at the same time where there are many nodes.
fn each<S: Send, T: Send>(nodes: usize, all: Vec<S>, of: impl Fn(S) -> T + Sync + Send) -> Vec<T> {
    if nodes < PARALLEL {
        all.into_iter().map(of).collect()
    } else {
        all.into_par_iter().map(of).collect()
    }
}

/// The connected pieces of `graph`, shared out to two halves of about the same weight.
fn halve_pieces(graph: &Graph) -> Vec<usize> {
    let (mut half, mut weights, mut queue) =
        (vec![usize::MAX; graph.size()], [0; 2], VecDeque::new());
    for start in 0..graph.size() {
        if half[start] != usize::MAX {
            continue;
        }
        let lighter = usize::from(weights[1] < weights[0]);
        half[start] = lighter;
        queue.push_back(start);
        while let Some(node) = queue.pop_front() {
            weights[lighter] += graph.weights[node];
            for &other in graph.of(node) {
                if half[other] == usize::MAX {
                    half[other] = lighter;
                    queue.push_back(other);
                }
            }
        }
    }
    half
}

/// A separator and what it separates.
struct Cut<'a> {
    graph: &'a Graph,
    /// `[n]` 0, 1 or [`SEPARATOR`].
    half: Vec<usize>,
    /// Weights of the halves and the separator.
    weights: [usize; 3],
}

impl<'a> Cut<'a> {
    /// The nodes where `side` is least are one half, of half the weight; those of the other half
    /// that touch it separate.
    fn along(graph: &'a Graph, side: impl Fn(usize) -> i64) -> Self {
        let n = graph.size();
        let total: usize = graph.weights.iter().sum();
        let mut sorted: Vec<(i64, usize)> = (0..n).map(|node| (side(node), node)).collect();
        sorted.sort_unstable();
        let (mut half, mut weight) = (vec![1; n], 0);
        for (_, node) in sorted {
            if 2 * weight >= total {
                break;
            }
            weight += graph.weights[node];
            half[node] = 0;
        }
        let rim: Vec<usize> = (0..n)
            .filter(|&node| half[node] == 1 && graph.of(node).iter().any(|&other| half[other] == 0))
            .collect();
        for node in rim {
            half[node] = SEPARATOR;
        }
        let mut weights = [0; 3];
        for node in 0..n {
            weights[half[node]] += graph.weights[node];
        }
        Self { graph, half, weights }
    }

    /// Less is better: a light separator between halves of the same weight.
    fn cost(&self) -> f64 {
        let [a, b, separator] = self.weights.map(|weight| weight as f64);
        separator * (1.0 + (a - b).abs() / (a + b + separator))
    }

    /// Weight that leaves the separator when `node` goes from it to `half`; what it touches in the
    /// other half comes in.
    fn gain(&self, node: usize, half: usize) -> i64 {
        let touched = self.graph.of(node).iter().filter(|&&other| self.half[other] == 1 - half);
        self.graph.weights[node] as i64
            - touched.map(|&other| self.graph.weights[other] as i64).sum::<i64>()
    }

    fn put(&mut self, node: usize, half: usize) {
        self.weights[self.half[node]] -= self.graph.weights[node];
        self.weights[half] += self.graph.weights[node];
        self.half[node] = half;
    }

    fn improve(&mut self) {
        for _ in 0..PASSES {
            if !self.improve_once() {
                break;
            }
        }
    }

    /// Moves every node at most once out of the separator, the best move first, and goes back to
    /// the best state met. Returns whether it is better than the first.
    fn improve_once(&mut self) -> bool {
        let n = self.graph.size();
        let largest = (LARGEST_HALF * self.weights.iter().sum::<usize>() as f64) as usize;
        let mut moved = vec![false; n];
        let mut best = self.cost();
        // Moves since the best state: a node, the half it went to, and the nodes that came into the
        // separator for it.
        let mut since: Vec<(usize, usize, Vec<usize>)> = Vec::new();
        let mut better = false;
        let mut moves = BinaryHeap::new();
        for node in 0..n {
            if self.half[node] == SEPARATOR {
                moves.extend([0, 1].map(|half| (self.gain(node, half), Reverse(node), half)));
            }
        }
        while let Some((gain, Reverse(node), half)) = moves.pop() {
            if moved[node]
                || self.half[node] != SEPARATOR
                || self.weights[half] + self.graph.weights[node] > largest
            {
                continue;
            }
            // The surroundings may have changed since the gain was written down.
            let now = self.gain(node, half);
            if now != gain {
                if now < gain {
                    moves.push((now, Reverse(node), half));
                }
                continue;
            }
            let came: Vec<usize> = self
                .graph
                .of(node)
                .iter()
                .copied()
                .filter(|&other| self.half[other] == 1 - half)
                .collect();
            moved[node] = true;
            self.put(node, half);
            for &other in &came {
                self.put(other, SEPARATOR);
            }
            // Gains that rose: of what came in, and of its neighbours.
            for &other in &came {
                for &near in self.graph.of(other).iter().chain([&other]) {
                    if self.half[near] == SEPARATOR && !moved[near] {
                        moves.extend(
                            [0, 1].map(|half| (self.gain(near, half), Reverse(near), half)),
                        );
                    }
                }
            }
            since.push((node, half, came));
            let cost = self.cost();
            if cost < best {
                (best, better) = (cost, true);
                since.clear();
            } else if since.len() >= IDLE_MOVES {
                break;
            }
        }
        for (node, half, came) in since.into_iter().rev() {
            self.put(node, SEPARATOR);
            for other in came {
                self.put(other, 1 - half);
            }
        }
        better
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
            let half = halve(&graph);
            for node in 0..graph.size() {
                assert!(
                    half[node] == SEPARATOR
                        || graph.of(node).iter().all(|&other| half[other] != 1 - half[node])
                );
            }
            let count = |which| half.iter().filter(|&&half| half == which).count();
            assert!(
                count(SEPARATOR) <= lightest + lightest / 4,
                "{} of {lightest}",
                count(SEPARATOR)
            );
            assert!(count(0).max(count(1)) as f64 <= LARGEST_HALF * graph.size() as f64 + 1.0);
        }
    }
}
