//! Undirected graphs: their adjacency, breadth-first levels, and permutations of the nodes.

use super::sparse::SymmetricPattern;
use crate::adjacency::{Csr, NONE};

/// Neighbours of each unknown in `pattern`, ascending; each is its own neighbour, too.
pub(super) fn adjacency_with_loops(pattern: &SymmetricPattern) -> Csr {
    let entries = (0..pattern.size()).flat_map(|column| {
        let rows = &pattern.rows[pattern.columns[column]..pattern.columns[column + 1]];
        rows.iter().map(move |&row| (row, column))
    });
    let both = entries.flat_map(|(row, column)| {
        let transposed = (row != column).then_some((column, row));
        [Some((row, column)), transposed].into_iter().flatten()
    });
    Csr::from_pairs(pattern.size(), both)
}

/// An undirected graph without loops whose nodes have weights.
pub(super) struct Graph {
    adjacency: Csr,
    /// `[n]` number of unknowns of each node.
    pub(super) weights: Vec<usize>,
}

impl Graph {
    /// A graph of nodes with these `weights`, from all pairs (node, neighbour).
    pub(super) fn new(
        weights: Vec<usize>,
        pairs: impl Iterator<Item = (usize, usize)> + Clone,
    ) -> Self {
        Self { adjacency: Csr::from_pairs(weights.len(), pairs), weights }
    }

    /// Number of nodes.
    pub(super) fn size(&self) -> usize {
        self.weights.len()
    }

    /// Neighbours of `node`.
    pub(super) fn neighbours(&self, node: usize) -> &[usize] {
        &self.adjacency[node]
    }

    /// The subgraph induced by `nodes`, which are numbered as they come.
    pub(super) fn induced(&self, nodes: &[usize]) -> Self {
        let mut number = vec![NONE; self.size()];
        for (new, &old) in nodes.iter().enumerate() {
            number[old] = new;
        }
        let number = &number;
        let pairs = nodes.iter().enumerate().flat_map(|(new, &old)| {
            let neighbours = self.neighbours(old).iter().map(|&other| number[other]);
            neighbours.filter(|&other| other != NONE).map(move |other| (new, other))
        });
        Self::new(nodes.iter().map(|&node| self.weights[node]).collect(), pairs)
    }

    /// `[n]` breadth-first level of each node from `start` ([`NONE`] where there is no path),
    /// and the nodes in the order in which they are reached.
    pub(super) fn bfs_levels(&self, start: usize) -> (Vec<usize>, Vec<usize>) {
        let mut levels = vec![NONE; self.size()];
        let (mut reached, mut next) = (vec![start], 0);
        levels[start] = 0;
        while next < reached.len() {
            let node = reached[next];
            next += 1;
            for &other in self.neighbours(node) {
                if levels[other] == NONE {
                    levels[other] = levels[node] + 1;
                    reached.push(other);
                }
            }
        }
        (levels, reached)
    }
}

/// `[n]` position of each node in `order`, a permutation of 0 to n − 1.
pub(super) fn inverse_permutation(order: &[usize]) -> Vec<usize> {
    let mut position = vec![0; order.len()];
    for (k, &node) in order.iter().enumerate() {
        position[node] = k;
    }
    position
}
