//! What elimination in a given order leaves: the elimination tree, columns of the factor with the
//! same rows below them, and these rows (Liu 1990). It is found for groups of unknowns (the
//! coordinates of a vertex), a third of the nodes and a tenth of the couplings.

use std::ops::Range;

use super::sparse::SymmetricPattern;
use crate::mesh::NONE;

/// Columns that are this few are joined with those after them if at most such a share of the
/// entries is zero for it.
const JOINED: [(usize, f64); 4] = [(4, 1.0), (16, 0.8), (48, 0.1), (96, 0.05)];

/// Groups of unknowns that are better eliminated together, and their couplings.
pub struct Groups {
    /// Which groups are coupled; at least those of which some unknowns are.
    pub graph: SymmetricPattern,
    /// The unknowns of each group, at least one; every unknown is in one group.
    pub members: Vec<Vec<usize>>,
}

/// An order of elimination and the supernodes to which it leads. Unknowns are meant by their place
/// in the order.
pub(super) struct Elimination {
    /// The group that goes first, the one after it, …
    pub(super) groups: Vec<usize>,
    /// The unknown that goes first, the one after it, …
    pub(super) order: Vec<usize>,
    /// By their columns, ascending; every subtree is in one piece.
    pub(super) supernodes: Vec<Supernode>,
    /// Floating-point operations of one factorisation: the sum of squares of the entries in each
    /// column.
    pub(super) operations: f64,
}

/// Columns of the factor with the same rows below them.
pub(super) struct Supernode {
    /// The columns.
    pub(super) columns: Range<usize>,
    /// The rows below them, ascending.
    pub(super) rows: Vec<usize>,
    /// The supernode of the first of these rows; [`NONE`] if there is none.
    pub(super) parent: usize,
}

impl Elimination {
    /// Elimination of the groups in `order`, or one with the same fill.
    pub(super) fn of(groups: &Groups, order: &[usize]) -> Self {
        let Groups { graph, members } = groups;
        let (first, lists) = couplings(graph);
        let of = |node: usize| &lists[first[node]..first[node + 1]];
        let (groups, parent) = in_pieces(of, order);
        let mut begin = vec![0];
        for &group in &groups {
            begin.push(begin[begin.len() - 1] + members[group].len());
        }
        let blocks = joined(blocks(of, &groups, &parent), &begin);
        let mut owner = vec![0; groups.len()];
        for (s, block) in blocks.iter().enumerate() {
            owner[block.nodes.clone()].fill(s);
        }
        let supernodes: Vec<Supernode> = blocks
            .into_iter()
            .map(|block| Supernode {
                columns: begin[block.nodes.start]..begin[block.nodes.end],
                parent: block.rows.first().map_or(NONE, |&row| owner[row as usize]),
                rows: block
                    .rows
                    .iter()
                    .flat_map(|&row| begin[row as usize]..begin[row as usize + 1])
                    .collect(),
            })
            .collect();
        let squares = |node: &Supernode| -> f64 {
            let below = node.rows.len();
            (below + 1..=below + node.columns.len()).map(|rows| (rows * rows) as f64).sum()
        };
        Self {
            operations: supernodes.iter().map(squares).sum(),
            order: groups.iter().flat_map(|&group| members[group].iter().copied()).collect(),
            groups,
            supernodes,
        }
    }
}

/// All nodes that each one is coupled with, itself too, ascending; and where its list begins.
pub(super) fn couplings(pattern: &SymmetricPattern) -> (Vec<usize>, Vec<usize>) {
    let n = pattern.size();
    let mut first = vec![0; n + 1];
    let entries = || {
        (0..n).flat_map(|column| {
            pattern.rows[pattern.columns[column]..pattern.columns[column + 1]]
                .iter()
                .map(move |&row| (row, column))
        })
    };
    for (row, column) in entries() {
        first[row + 1] += 1;
        first[column + 1] += usize::from(row != column);
    }
    for i in 0..n {
        first[i + 1] += first[i];
    }
    let (mut lists, mut end) = (vec![0; first[n]], first.clone());
    for (row, column) in entries() {
        lists[end[row]] = column;
        end[row] += 1;
        if row != column {
            lists[end[column]] = row;
            end[column] += 1;
        }
    }
    (first, lists)
}

/// The same fill as in `order`, but every subtree of the elimination tree in one piece; and the
/// parent of each place in the tree ([`NONE`] for a root).
fn in_pieces<'a>(of: impl Fn(usize) -> &'a [usize], order: &[usize]) -> (Vec<usize>, Vec<usize>) {
    let n = order.len();
    let mut place = vec![0; n];
    for (k, &node) in order.iter().enumerate() {
        place[node] = k;
    }
    // Parents in the elimination tree, by shortened ways to the root (Liu 1986).
    let (mut parent, mut above) = (vec![NONE; n], vec![NONE; n]);
    for k in 0..n {
        for &other in of(order[k]) {
            let mut at = place[other];
            while at < k && above[at] != k {
                let next = above[at];
                above[at] = k;
                if next == NONE {
                    parent[at] = k;
                    break;
                }
                at = next;
            }
        }
    }
    let mut children = vec![Vec::new(); n];
    let mut todo = Vec::new();
    for k in (0..n).rev() {
        match parent[k] {
            NONE => todo.push(k),
            up => children[up].push(k),
        }
    }
    // From the roots down, the last first; then turned round.
    todo.reverse();
    let mut places = Vec::with_capacity(n);
    while let Some(k) = todo.pop() {
        places.push(k);
        todo.extend(children[k].iter().rev());
    }
    places.reverse();
    let mut new = vec![NONE; n];
    places.iter().enumerate().for_each(|(k, &old)| new[old] = k);
    let up = |old: usize| if parent[old] == NONE { NONE } else { new[parent[old]] };
    (places.iter().map(|&old| order[old]).collect(), places.iter().map(|&old| up(old)).collect())
}

/// Nodes with the same rows below them.
struct Block {
    nodes: Range<usize>,
    rows: Vec<u32>,
}

/// The largest blocks of nodes in a row, in an order with the elimination tree `parent`.
fn blocks<'a>(of: impl Fn(usize) -> &'a [usize], order: &[usize], parent: &[usize]) -> Vec<Block> {
    let n = order.len();
    let mut place = vec![0; n];
    order.iter().enumerate().for_each(|(k, &node)| place[node] = k);
    let mut children = vec![Vec::new(); n];
    (0..n).filter(|&k| parent[k] != NONE).for_each(|k| children[parent[k]].push(k));
    let (mut blocks, mut seen) = (Vec::<Block>::new(), vec![NONE; n]);
    // The block that ends with each node that has been met.
    let mut ends = vec![NONE; n];
    for k in 0..n {
        let mut rows: Vec<u32> = Vec::new();
        let mut meet = |row: usize| {
            if row > k && seen[row] != k {
                seen[row] = k;
                rows.push(row as u32);
            }
        };
        of(order[k]).iter().for_each(|&other| meet(place[other]));
        children[k]
            .iter()
            .for_each(|&child| blocks[ends[child]].rows.iter().for_each(|&row| meet(row as usize)));
        match blocks.last_mut() {
            Some(last)
                if children[k].last() == Some(&(last.nodes.end - 1))
                    && last.rows.len() == rows.len() + 1 =>
            {
                last.nodes.end = k + 1;
                last.rows = rows;
            }
            _ => blocks.push(Block { nodes: k..k + 1, rows }),
        }
        ends[k] = blocks.len() - 1;
    }
    blocks.iter_mut().for_each(|block| block.rows.sort_unstable());
    blocks
}

/// Blocks made larger at the price of a few zeros; `begin` is the first unknown of each node.
fn joined(blocks: Vec<Block>, begin: &[usize]) -> Vec<Block> {
    let width = |nodes: &Range<usize>| begin[nodes.end] - begin[nodes.start];
    let below = |rows: &[u32]| {
        rows.iter().map(|&row| begin[row as usize + 1] - begin[row as usize]).sum::<usize>()
    };
    // With the rows below in unknowns, and the zeros stored.
    let mut out: Vec<(Block, usize, usize)> = Vec::new();
    for block in blocks {
        let below_it = below(&block.rows);
        let mut block = (block, below_it, 0);
        while let Some((before, below, zeros)) = out.last() {
            let child = before.nodes.end == block.0.nodes.start
                && before.rows.first().is_some_and(|&row| block.0.nodes.contains(&(row as usize)));
            if !child {
                break;
            }
            let (w, own) = (width(&before.nodes), width(&block.0.nodes));
            let zeros = zeros + block.2 + w * (own + block.1 - below);
            let all = (w + own) * (w + own + 1) / 2 + (w + own) * block.1;
            let few = |&(most, share): &(usize, f64)| {
                w + own <= most && zeros as f64 <= share * all as f64
            };
            if !JOINED.iter().any(few) {
                break;
            }
            block.0.nodes.start = before.nodes.start;
            block.2 = zeros;
            out.pop();
        }
        out.push(block);
    }
    out.into_iter().map(|(block, ..)| block).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grid with a few long couplings, in groups of one to three unknowns.
    fn grid() -> Groups {
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
        Groups { graph, members }
    }

    #[test]
    fn supernodes_hold_what_elimination_fills_in() {
        let groups = grid();
        let n = groups.graph.size();
        // An order without much sense.
        let order: Vec<usize> = (0..n).map(|k| (k * 60 + 7) % n).collect();
        let found = Elimination::of(&groups, &order);
        let size = found.order.len();
        let (mut group_of, mut sorted) = (vec![NONE; size], found.order.clone());
        groups
            .members
            .iter()
            .enumerate()
            .for_each(|(g, members)| members.iter().for_each(|&i| group_of[i] = g));
        sorted.sort_unstable();
        assert!(sorted.into_iter().eq(0..size));
        // Elimination, entry by entry.
        let coupled = |i: usize, j: usize| {
            groups.graph.find(group_of[found.order[i]], group_of[found.order[j]]).is_some()
        };
        let mut filled: Vec<Vec<bool>> =
            (0..size).map(|i| (0..size).map(|j| coupled(i, j)).collect()).collect();
        for k in 0..size {
            let after: Vec<usize> = (k + 1..size).filter(|&i| filled[i][k]).collect();
            after.iter().for_each(|&i| after.iter().for_each(|&j| filled[i][j] = true));
        }
        let mut stored = vec![vec![false; size]; size];
        let (mut next, mut operations) = (0, 0.0);
        for (s, node) in found.supernodes.iter().enumerate() {
            assert_eq!(node.columns.start, next);
            next = node.columns.end;
            assert!(
                node.rows.windows(2).all(|two| two[0] < two[1])
                    && node.rows.iter().all(|&row| row >= next)
            );
            match node.rows.first() {
                None => assert_eq!(node.parent, NONE),
                Some(row) => {
                    let parent = &found.supernodes[node.parent];
                    assert!(node.parent > s && parent.columns.contains(row));
                    assert!(
                        node.rows
                            .iter()
                            .all(|row| parent.columns.contains(row) || parent.rows.contains(row))
                    );
                }
            }
            for column in node.columns.clone() {
                let rows: Vec<usize> = (column..next).chain(node.rows.iter().copied()).collect();
                operations += (rows.len() as f64).powi(2);
                rows.into_iter().for_each(|row| stored[row][column] = true);
            }
        }
        assert_eq!((next, found.operations), (size, operations));
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
