//! A vertex separator of a graph, and its refinement (Fiduccia & Mattheyses 1982).

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::graph::Graph;

/// Mark of a node in the separator, beside the halves 0 and 1.
pub(super) const SEPARATOR: usize = 2;

/// Largest share of all weight that one half may have.
pub(super) const MAX_HALF_SHARE: f64 = 0.6;
/// Number of moves without gain after which a pass of refinement ends.
const MAX_IDLE_MOVES: usize = 40;
/// Largest number of passes of refinement.
const MAX_PASSES: usize = 6;

/// A separator and the halves that it separates.
pub(super) struct Separator<'a> {
    graph: &'a Graph,
    /// `[n]` 0, 1 or [`SEPARATOR`].
    half: Vec<usize>,
    /// Weights of the halves and the separator.
    weights: [usize; 3],
}

/// A candidate move of a node out of the separator; the heap yields the one with the largest gain,
/// of the lowest node, to the higher half.
type Candidate = (i64, Reverse<usize>, usize);

/// A move that was made.
struct Move {
    node: usize,
    /// The half to which the node went.
    half: usize,
    /// The nodes that came into the separator for it.
    pulled: Vec<usize>,
}

impl<'a> Separator<'a> {
    /// The cut at the median of `level`: the nodes of the lowest levels, with half of the weight,
    /// are one half; those of the other half that touch it separate.
    pub(super) fn at_median(graph: &'a Graph, level: impl Fn(usize) -> i64) -> Self {
        let n = graph.size();
        let total: usize = graph.weights.iter().sum();
        let mut sorted: Vec<(i64, usize)> = (0..n).map(|node| (level(node), node)).collect();
        sorted.sort_unstable();
        let (mut half, mut weight) = (vec![1; n], 0);
        for (_, node) in sorted {
            if 2 * weight >= total {
                break;
            }
            weight += graph.weights[node];
            half[node] = 0;
        }
        let touches = |node: usize| graph.neighbours(node).iter().any(|&other| half[other] == 0);
        let rim: Vec<usize> = (0..n).filter(|&node| half[node] == 1 && touches(node)).collect();
        for node in rim {
            half[node] = SEPARATOR;
        }
        let mut weights = [0; 3];
        for node in 0..n {
            weights[half[node]] += graph.weights[node];
        }
        Self { graph, half, weights }
    }

    /// `[n]` half of each node, or [`SEPARATOR`].
    pub(super) fn into_halves(self) -> Vec<usize> {
        self.half
    }

    /// Cost of the separator: low if it is light and the halves have the same weight.
    pub(super) fn cost(&self) -> f64 {
        let [a, b, separator] = self.weights.map(|weight| weight as f64);
        separator * (1.0 + (a - b).abs() / (a + b + separator))
    }

    /// Lowers the cost by moves of single nodes.
    pub(super) fn refine(&mut self) {
        for _ in 0..MAX_PASSES {
            if !self.refine_once() {
                break;
            }
        }
    }

    /// Moves every node at most once out of the separator, the best move first, and returns to the
    /// best state met. Returns true if that is better than the first.
    fn refine_once(&mut self) -> bool {
        let mut moved = vec![false; self.graph.size()];
        let mut best = self.cost();
        let mut better = false;
        let mut since_best: Vec<Move> = Vec::new();
        let mut candidates = BinaryHeap::new();
        for node in 0..self.graph.size() {
            if self.half[node] == SEPARATOR {
                candidates.extend(self.candidates(node));
            }
        }
        while let Some((node, half)) = self.next_move(&mut candidates, &moved) {
            moved[node] = true;
            let made = self.make_move(node, half);
            // Gains that rose: of the nodes that came in, and of their neighbours.
            for &other in &made.pulled {
                for &near in self.graph.neighbours(other).iter().chain([&other]) {
                    if self.half[near] == SEPARATOR && !moved[near] {
                        candidates.extend(self.candidates(near));
                    }
                }
            }
            since_best.push(made);
            let cost = self.cost();
            if cost < best {
                (best, better) = (cost, true);
                since_best.clear();
            } else if since_best.len() >= MAX_IDLE_MOVES {
                break;
            }
        }
        since_best.into_iter().rev().for_each(|made| self.undo(made));
        better
    }

    /// The moves of a node of the separator to either half.
    fn candidates(&self, node: usize) -> [Candidate; 2] {
        [0, 1].map(|half| (self.gain(node, half), Reverse(node), half))
    }

    /// The best of the candidates that is still possible: a node and the half to which it goes.
    fn next_move(
        &self,
        candidates: &mut BinaryHeap<Candidate>,
        moved: &[bool],
    ) -> Option<(usize, usize)> {
        let max_weight = (MAX_HALF_SHARE * self.weights.iter().sum::<usize>() as f64) as usize;
        while let Some((gain, Reverse(node), half)) = candidates.pop() {
            if moved[node]
                || self.half[node] != SEPARATOR
                || self.weights[half] + self.graph.weights[node] > max_weight
            {
                continue;
            }
            // Neighbours may have moved since the gain was computed.
            let now = self.gain(node, half);
            if now == gain {
                return Some((node, half));
            }
            if now < gain {
                candidates.push((now, Reverse(node), half));
            }
        }
        None
    }

    /// Weight by which the separator becomes lighter if `node` goes from it to `half`, and its
    /// neighbours in the other half come in.
    fn gain(&self, node: usize, half: usize) -> i64 {
        let neighbours = self.graph.neighbours(node).iter();
        let pulled = neighbours.filter(|&&other| self.half[other] == 1 - half);
        self.graph.weights[node] as i64
            - pulled.map(|&other| self.graph.weights[other] as i64).sum::<i64>()
    }

    fn make_move(&mut self, node: usize, half: usize) -> Move {
        let neighbours = self.graph.neighbours(node).iter().copied();
        let pulled: Vec<usize> = neighbours.filter(|&other| self.half[other] == 1 - half).collect();
        self.assign(node, half);
        for &other in &pulled {
            self.assign(other, SEPARATOR);
        }
        Move { node, half, pulled }
    }

    fn undo(&mut self, made: Move) {
        self.assign(made.node, SEPARATOR);
        for other in made.pulled {
            self.assign(other, 1 - made.half);
        }
    }

    fn assign(&mut self, node: usize, half: usize) {
        self.weights[self.half[node]] -= self.graph.weights[node];
        self.weights[half] += self.graph.weights[node];
        self.half[node] = half;
    }
}
