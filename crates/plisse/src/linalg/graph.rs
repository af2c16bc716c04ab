//! Undirected graphs: their adjacency, breadth-first levels, and permutations of the nodes.

use super::sparse::SymmetricPattern;

/// Neighbours of each node, in compressed rows.
pub(super) struct Adjacency {
    /// `[n+1]` start of each node's list in [`Adjacency::neighbours`].
    starts: Vec<usize>,
    /// The lists, one after the other.
    neighbours: Vec<usize>,
}

impl Adjacency {
    /// An adjacency of no nodes, for [`Adjacency::push`].
    pub(super) fn empty() -> Self {
        Self { starts: vec![0], neighbours: Vec::new() }
    }

    /// Adds one more node, with these neighbours.
    pub(super) fn push(&mut self, neighbours: impl Iterator<Item = usize>) {
        self.neighbours.extend(neighbours);
        self.starts.push(self.neighbours.len());
    }

    /// The adjacency of `pattern`. Each node is its own neighbour, too; lists ascend.
    pub(super) fn with_loops(pattern: &SymmetricPattern) -> Self {
        let n = pattern.size();
        let mut starts = vec![0; n + 1];
        let entries = || {
            (0..n).flat_map(|column| {
                pattern.rows[pattern.columns[column]..pattern.columns[column + 1]]
                    .iter()
                    .map(move |&row| (row, column))
            })
        };
        for (row, column) in entries() {
            starts[row + 1] += 1;
            starts[column + 1] += usize::from(row != column);
        }
        for i in 0..n {
            starts[i + 1] += starts[i];
        }
        let (mut neighbours, mut ends) = (vec![0; starts[n]], starts.clone());
        for (row, column) in entries() {
            neighbours[ends[row]] = column;
            ends[row] += 1;
            if row != column {
                neighbours[ends[column]] = row;
                ends[column] += 1;
            }
        }
        Self { starts, neighbours }
    }

    /// Neighbours of `node`.
    pub(super) fn neighbours(&self, node: usize) -> &[usize] {
        &self.neighbours[self.starts[node]..self.starts[node + 1]]
    }
}

/// An undirected graph without loops whose nodes have weights.
pub(super) struct Graph {
    adjacency: Adjacency,
    /// `[n]` number of unknowns of each node.
    pub(super) weights: Vec<usize>,
}

impl Graph {
    /// The graph of an `adjacency` without loops.
    pub(super) fn new(adjacency: Adjacency, weights: Vec<usize>) -> Self {
        Self { adjacency, weights }
    }

    /// Number of nodes.
    pub(super) fn size(&self) -> usize {
        self.weights.len()
    }

    /// Neighbours of `node`.
    pub(super) fn neighbours(&self, node: usize) -> &[usize] {
        self.adjacency.neighbours(node)
    }

    /// The subgraph induced by `nodes`, which are numbered as they come.
    pub(super) fn induced(&self, nodes: &[usize]) -> Self {
        let mut number = vec![usize::MAX; self.size()];
        for (new, &old) in nodes.iter().enumerate() {
            number[old] = new;
        }
        let mut adjacency = Adjacency::empty();
        for &old in nodes {
            let neighbours = self.neighbours(old).iter().map(|&other| number[other]);
            adjacency.push(neighbours.filter(|&new| new != usize::MAX));
        }
        Self { adjacency, weights: nodes.iter().map(|&node| self.weights[node]).collect() }
    }

    /// `[n]` breadth-first level of each node from `start` ([`usize::MAX`] where there is no path),
    /// and the nodes in the order in which they are reached.
    pub(super) fn bfs_levels(&self, start: usize) -> (Vec<usize>, Vec<usize>) {
        let mut levels = vec![usize::MAX; self.size()];
        let (mut reached, mut next) = (vec![start], 0);
        levels[start] = 0;
        while next < reached.len() {
            let node = reached[next];
            next += 1;
            for &other in self.neighbours(node) {
                if levels[other] == usize::MAX {
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
