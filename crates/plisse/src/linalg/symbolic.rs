//! Symbolic Cholesky factorisation: the elimination tree in postorder, the supernodes of the factor
//! and their rows (Liu 1990; Davis, *Direct Methods for Sparse Linear Systems*, 2006). It is done
//! for index blocks (the coordinates of a vertex), a third of the nodes and a tenth of the
//! couplings.

use std::ops::Range;

use super::graph::{adjacency_with_loops, inverse_permutation};
use super::sparse::SymmetricPattern;
use crate::adjacency::{Csr, NONE};

/// Relaxed amalgamation: a supernode is joined with its last child while the union satisfies one of
/// these limits, as faster dense operations then outweigh the explicit zeros.
const RELAXATION: [Relaxation; 4] = [
    Relaxation { max_columns: 4, max_zero_fraction: 1.0 },
    Relaxation { max_columns: 16, max_zero_fraction: 0.8 },
    Relaxation { max_columns: 48, max_zero_fraction: 0.1 },
    Relaxation { max_columns: 96, max_zero_fraction: 0.05 },
];

/// One limit of relaxed amalgamation.
struct Relaxation {
    /// Largest number of columns of the union.
    max_columns: usize,
    /// Largest fraction of explicit zeros among its entries.
    max_zero_fraction: f64,
}

/// Index blocks (supervariables): sets of unknowns that are better eliminated together, such as the
/// coordinates of a vertex, and their couplings.
pub struct IndexBlocks {
    /// Couplings of the blocks: at least of those of which some unknowns are coupled.
    pub graph: SymmetricPattern,
    /// Unknowns of each block, at least one; every unknown is in one block.
    pub members: Vec<Vec<usize>>,
}

impl IndexBlocks {
    /// Each unknown of `pattern` as a block of its own.
    pub(super) fn scalar(pattern: &SymmetricPattern) -> Self {
        Self {
            graph: pattern.clone(),
            members: (0..pattern.size()).map(|unknown| vec![unknown]).collect(),
        }
    }
}

/// An elimination order and the supernodes to which it leads. Columns and rows are positions in the
/// order.
pub(super) struct SymbolicFactorisation {
    /// The blocks in the order of their elimination, a postorder.
    pub(super) block_order: Vec<usize>,
    /// `[n]` the unknowns in the order of their elimination.
    pub(super) order: Vec<usize>,
    /// The supernodes by ascending columns; those of every subtree are contiguous.
    pub(super) supernodes: Vec<Supernode>,
    /// Operation count of one numeric factorisation: the sum of squares of the columns' entry
    /// counts.
    pub(super) operations: f64,
}

/// Contiguous columns of the factor with the same rows below them.
pub(super) struct Supernode {
    /// The columns.
    pub(super) columns: Range<usize>,
    /// The rows below them, ascending.
    pub(super) rows: Vec<usize>,
    /// The supernode of the first of these rows; [`NONE`] for a root.
    pub(super) parent: usize,
}

impl Supernode {
    /// Number of columns.
    pub(super) fn width(&self) -> usize {
        self.columns.len()
    }

    /// Operation count of its columns' elimination.
    pub(super) fn operations(&self) -> f64 {
        let below = self.rows.len();
        (below + 1..=below + self.width()).map(|rows| (rows * rows) as f64).sum()
    }
}

impl SymbolicFactorisation {
    /// Symbolic analysis of the elimination of `blocks` in `order`, or in an equivalent postorder.
    pub(super) fn analyse(blocks: &IndexBlocks, order: &[usize]) -> Self {
        let IndexBlocks { graph, members } = blocks;
        let graph = adjacency_with_loops(graph);
        let tree = elimination_tree(&graph, order);
        let (block_order, tree) = in_postorder(order, &tree);
        let mut begin = vec![0];
        for &block in &block_order {
            begin.push(begin[begin.len() - 1] + members[block].len());
        }
        let of_blocks = amalgamate(maximal_supernodes(&graph, &block_order, &tree), &begin);
        let mut owner = vec![0; block_order.len()];
        for (s, supernode) in of_blocks.iter().enumerate() {
            owner[supernode.nodes.clone()].fill(s);
        }
        let supernodes: Vec<Supernode> = of_blocks
            .into_iter()
            .map(|BlockSupernode { nodes, rows }| Supernode {
                columns: begin[nodes.start]..begin[nodes.end],
                parent: rows.first().map_or(NONE, |&row| owner[row as usize]),
                rows: rows
                    .iter()
                    .flat_map(|&row| begin[row as usize]..begin[row as usize + 1])
                    .collect(),
            })
            .collect();
        Self {
            operations: supernodes.iter().map(Supernode::operations).sum(),
            order: block_order.iter().flat_map(|&block| members[block].iter().copied()).collect(),
            block_order,
            supernodes,
        }
    }
}

/// `[n]` parent of each position of `order` in the elimination tree; [`NONE`] for a root. By path
/// compression (Liu 1986).
fn elimination_tree(graph: &Csr, order: &[usize]) -> Vec<usize> {
    let n = order.len();
    let position = inverse_permutation(order);
    let (mut parent, mut ancestor) = (vec![NONE; n], vec![NONE; n]);
    for k in 0..n {
        for &other in &graph[order[k]] {
            let mut at = position[other];
            while at < k && ancestor[at] != k {
                let next = ancestor[at];
                ancestor[at] = k;
                if next == NONE {
                    parent[at] = k;
                    break;
                }
                at = next;
            }
        }
    }
    parent
}

/// `[n]` children of each node of the tree `parent`, ascending.
fn children(parent: &[usize]) -> Vec<Vec<usize>> {
    let mut children = vec![Vec::new(); parent.len()];
    (0..parent.len()).filter(|&k| parent[k] != NONE).for_each(|k| children[parent[k]].push(k));
    children
}

/// A postorder of the elimination tree `parent` of `order`: the same fill, but every subtree is
/// contiguous. Returns the nodes in this order, and the parent of each position.
fn in_postorder(order: &[usize], parent: &[usize]) -> (Vec<usize>, Vec<usize>) {
    let positions = postorder(parent);
    let new = inverse_permutation(&positions);
    let up = |old: usize| if parent[old] == NONE { NONE } else { new[parent[old]] };
    (
        positions.iter().map(|&old| order[old]).collect(),
        positions.iter().map(|&old| up(old)).collect(),
    )
}

/// The nodes of the tree `parent` in postorder; siblings and roots keep their order.
fn postorder(parent: &[usize]) -> Vec<usize> {
    let children = children(parent);
    let mut todo: Vec<usize> = (0..parent.len()).filter(|&k| parent[k] == NONE).collect();
    // A preorder with the last siblings first, reversed.
    let mut nodes = Vec::with_capacity(parent.len());
    while let Some(k) = todo.pop() {
        nodes.push(k);
        todo.extend(&children[k]);
    }
    nodes.reverse();
    nodes
}

/// A supernode of index blocks.
struct BlockSupernode {
    /// Positions of its blocks in the order.
    nodes: Range<usize>,
    /// Positions of the blocks below, ascending.
    rows: Vec<u32>,
}

/// The maximal supernodes of the postorder `order` with the elimination tree `parent`. (Fundamental
/// ones, Liu, Ng & Peyton 1993, would end at every node with more than one child.)
fn maximal_supernodes(graph: &Csr, order: &[usize], parent: &[usize]) -> Vec<BlockSupernode> {
    let n = order.len();
    let position = inverse_permutation(order);
    let children = children(parent);
    let (mut supernodes, mut seen) = (Vec::<BlockSupernode>::new(), vec![NONE; n]);
    // `[n]` the supernode that ended with each node when that was added.
    let mut ends = vec![NONE; n];
    for k in 0..n {
        let mut rows: Vec<u32> = Vec::new();
        let mut add = |row: usize| {
            if row > k && seen[row] != k {
                seen[row] = k;
                rows.push(row as u32);
            }
        };
        graph[order[k]].iter().for_each(|&other| add(position[other]));
        for &child in &children[k] {
            supernodes[ends[child]].rows.iter().for_each(|&row| add(row as usize));
        }
        match supernodes.last_mut() {
            Some(last)
                if children[k].last() == Some(&(last.nodes.end - 1))
                    && last.rows.len() == rows.len() + 1 =>
            {
                last.nodes.end = k + 1;
                last.rows = rows;
            }
            _ => supernodes.push(BlockSupernode { nodes: k..k + 1, rows }),
        }
        ends[k] = supernodes.len() - 1;
    }
    supernodes.iter_mut().for_each(|supernode| supernode.rows.sort_unstable());
    supernodes
}

/// Relaxed amalgamation ([`RELAXATION`]); `begin` is the first unknown of each position.
fn amalgamate(supernodes: Vec<BlockSupernode>, begin: &[usize]) -> Vec<BlockSupernode> {
    let width = |nodes: &Range<usize>| begin[nodes.end] - begin[nodes.start];
    let unknowns_below = |rows: &[u32]| {
        rows.iter().map(|&row| begin[row as usize + 1] - begin[row as usize]).sum::<usize>()
    };
    // With the number of unknowns below, and of explicit zeros.
    let mut out: Vec<(BlockSupernode, usize, usize)> = Vec::new();
    for supernode in supernodes {
        let below_it = unknowns_below(&supernode.rows);
        let mut union = (supernode, below_it, 0);
        while let Some((before, below, zeros)) = out.last() {
            let is_child = before.nodes.end == union.0.nodes.start
                && before.rows.first().is_some_and(|&row| union.0.nodes.contains(&(row as usize)));
            if !is_child {
                break;
            }
            let (w, own) = (width(&before.nodes), width(&union.0.nodes));
            let zeros = zeros + union.2 + w * (own + union.1 - below);
            let all = (w + own) * (w + own + 1) / 2 + (w + own) * union.1;
            let allows = |limit: &Relaxation| {
                w + own <= limit.max_columns && zeros as f64 <= limit.max_zero_fraction * all as f64
            };
            if !RELAXATION.iter().any(allows) {
                break;
            }
            union.0.nodes.start = before.nodes.start;
            union.2 = zeros;
            out.pop();
        }
        out.push(union);
    }
    out.into_iter().map(|(supernode, ..)| supernode).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grid with a few long couplings, in blocks of one to three unknowns.
    fn grid() -> IndexBlocks {
        let at = |x: usize, y: usize| y * 13 + x;
        let mut elements: Vec<Vec<usize>> = (0..12 * 12)
            .map(|c| (c % 12, c / 12))
            .map(|(x, y)| vec![at(x, y), at(x + 1, y), at(x, y + 1), at(x + 1, y + 1)])
            .collect();
        elements.extend([vec![3, 150], vec![20, 90]]);
        let graph = SymmetricPattern::from_elements(13 * 13, elements.iter().map(Vec::as_slice));
        let mut next = 0;
        let members = (0..13 * 13)
            .map(|node| {
                let begin = next;
                next += 1 + node % 3;
                (begin..next).collect()
            })
            .collect();
        IndexBlocks { graph, members }
    }

    /// `[n][n]` the entries of the factor, by elimination entry by entry.
    fn dense_fill(blocks: &IndexBlocks, order: &[usize]) -> Vec<Vec<bool>> {
        let size = order.len();
        let mut block_of = vec![NONE; size];
        for (b, members) in blocks.members.iter().enumerate() {
            members.iter().for_each(|&i| block_of[i] = b);
        }
        let coupled = |i: usize, j: usize| {
            blocks.graph.find(block_of[order[i]], block_of[order[j]]).is_some()
        };
        let mut filled: Vec<Vec<bool>> =
            (0..size).map(|i| (0..size).map(|j| coupled(i, j)).collect()).collect();
        for k in 0..size {
            let after: Vec<usize> = (k + 1..size).filter(|&i| filled[i][k]).collect();
            after.iter().for_each(|&i| after.iter().for_each(|&j| filled[i][j] = true));
        }
        filled
    }

    /// Asserts that the rows of supernode `s` ascend and are in its parent's front.
    fn check_rows(supernodes: &[Supernode], s: usize) {
        let node = &supernodes[s];
        assert!(node.rows.windows(2).all(|two| two[0] < two[1]));
        assert!(node.rows.iter().all(|&row| row >= node.columns.end));
        match node.rows.first() {
            None => assert_eq!(node.parent, NONE),
            Some(row) => {
                let parent = &supernodes[node.parent];
                assert!(node.parent > s && parent.columns.contains(row));
                let has = |row: &usize| parent.columns.contains(row) || parent.rows.contains(row);
                assert!(node.rows.iter().all(has));
            }
        }
    }

    #[test]
    fn supernodes_hold_the_fill_of_elimination() {
        let blocks = grid();
        let n = blocks.graph.size();
        // An order without much sense.
        let order: Vec<usize> = (0..n).map(|k| (k * 60 + 7) % n).collect();
        let symbolic = SymbolicFactorisation::analyse(&blocks, &order);
        let size = symbolic.order.len();
        let mut sorted = symbolic.order.clone();
        sorted.sort_unstable();
        assert!(sorted.into_iter().eq(0..size));
        let filled = dense_fill(&blocks, &symbolic.order);
        let mut stored = vec![vec![false; size]; size];
        let (mut next, mut operations) = (0, 0.0);
        for (s, node) in symbolic.supernodes.iter().enumerate() {
            assert_eq!(node.columns.start, next);
            next = node.columns.end;
            check_rows(&symbolic.supernodes, s);
            for column in node.columns.clone() {
                let rows: Vec<usize> = (column..next).chain(node.rows.iter().copied()).collect();
                operations += (rows.len() as f64).powi(2);
                rows.into_iter().for_each(|row| stored[row][column] = true);
            }
        }
        assert_eq!((next, symbolic.operations), (size, operations));
        let count = |all: &[Vec<bool>]| {
            (0..size).map(|j| (j..size).filter(|&i| all[i][j]).count()).sum::<usize>()
        };
        assert!((0..size).all(|j| (j..size).all(|i| stored[i][j] || !filled[i][j])));
        let (stored, filled) = (count(&stored), count(&filled));
        assert!(
            stored >= filled && (stored as f64) < 1.25 * filled as f64,
            "{stored} for {filled}"
        );
    }
}
