//! Assembly of fronts: the tree of supernodes with their panels in the factor, the relative indices
//! by which update blocks are added to the parent's front, and the places of the matrix's entries.

use std::ops::Range;

use faer::MatRef;

use super::graph::inverse_permutation;
use super::sparse::SymmetricPattern;
use super::symbolic;
use crate::adjacency::Csr;

/// The assembly of one entry of the matrix.
#[derive(Clone, Copy)]
pub(super) struct Entry {
    /// Slot in the matrix's values.
    pub(super) slot: u32,
    /// Position in the panel of its supernode.
    pub(super) target: u32,
}

/// One supernode of the assembly tree: its front, and its part of the factor.
pub(super) struct Supernode {
    pub(super) columns: Range<usize>,
    /// Rows below the columns.
    pub(super) rows: Vec<usize>,
    /// Range in the factor of its panel: `width + below` rows by `width` columns.
    pub(super) panel: Range<usize>,
    /// Start in the factor of the panels of its subtree.
    pub(super) subtree_start: usize,
    /// First supernode of its subtree; the others follow, itself the last.
    pub(super) first: usize,
    pub(super) children: Vec<usize>,
    /// Relative indices: the rows below as rows of the parent's front, by contiguous runs.
    relative: Vec<RelativeRun>,
    /// Its entries of the matrix, in the list of [`assembly_map`].
    pub(super) entries: Range<usize>,
    /// Operation count of its subtree.
    pub(super) subtree_operations: f64,
}

/// Rows that are contiguous both in a front and in its parent's.
struct RelativeRun {
    /// The first, among the rows below the front's columns.
    from: usize,
    /// The first, among the rows of the parent's front.
    to: usize,
    length: usize,
}

impl Supernode {
    /// Number of columns, and of rows below them.
    pub(super) fn size(&self) -> (usize, usize) {
        (self.columns.len(), self.rows.len())
    }

    /// Extend-add: adds its `update` block to `columns` of its parent's front, of which `out` holds
    /// the last `height` rows.
    pub(super) fn extend_add(
        &self,
        update: &[f64],
        columns: Range<usize>,
        out: &mut [f64],
        height: usize,
    ) {
        let below = self.rows.len();
        // Rows of the front above those in `out`: all that is stored begins with the first column's
        // diagonal.
        let above = columns.start;
        for (p, run) in self.relative.iter().enumerate() {
            for k in 0..run.length {
                if !columns.contains(&(run.to + k)) {
                    continue;
                }
                let out = &mut out[(run.to + k - above) * height..][..height];
                let update = &update[(run.from + k) * below..][..below];
                let mut add = |from: usize, to: usize, length: usize| {
                    out[to - above..][..length]
                        .iter_mut()
                        .zip(&update[from..][..length])
                        .for_each(|(out, update)| *out += update);
                };
                add(run.from + k, run.to + k, run.length - k);
                self.relative[p + 1..].iter().for_each(|run| add(run.from, run.to, run.length));
            }
        }
    }

    /// Its part of the factor: the triangle of its columns, and the rows below.
    pub(super) fn factor<'a>(&self, factor: &'a [f64]) -> (MatRef<'a, f64>, MatRef<'a, f64>) {
        let (width, below) = self.size();
        MatRef::from_column_major_slice(&factor[self.panel.clone()], width + below, width)
            .split_at_row(width)
    }
}

/// The tree of supernodes with their panels and relative indices; the entries of the matrix are
/// still to be given out ([`assembly_map`]).
pub(super) fn assembly_tree(all: &[symbolic::Supernode]) -> Vec<Supernode> {
    let mut children = vec![Vec::new(); all.len()];
    let mut supernodes: Vec<Supernode> = Vec::with_capacity(all.len());
    let mut end = 0;
    for (s, node) in all.iter().enumerate() {
        let parent = all.get(node.parent);
        if parent.is_some() {
            children[node.parent].push(s);
        }
        let children = std::mem::take(&mut children[s]);
        let first_child = children.first().map(|&child| &supernodes[child]);
        let (width, below) = (node.width(), node.rows.len());
        let panel = end..end + width * (width + below);
        end = panel.end;
        supernodes.push(Supernode {
            columns: node.columns.clone(),
            rows: node.rows.clone(),
            subtree_start: first_child.map_or(panel.start, |child| child.subtree_start),
            first: first_child.map_or(s, |child| child.first),
            panel,
            subtree_operations: node.operations()
                + children.iter().map(|&child| supernodes[child].subtree_operations).sum::<f64>(),
            children,
            relative: parent.map_or_else(Vec::new, |parent| relative_runs(&node.rows, parent)),
            entries: 0..0,
        });
    }
    supernodes
}

/// Relative indices of `rows` in the front of `parent`.
fn relative_runs(rows: &[usize], parent: &symbolic::Supernode) -> Vec<RelativeRun> {
    let (mut runs, mut below) = (Vec::<RelativeRun>::new(), 0);
    for (from, &row) in rows.iter().enumerate() {
        let to = if row < parent.columns.end {
            row - parent.columns.start
        } else {
            below += parent.rows[below..].iter().take_while(|&&other| other < row).count();
            parent.columns.len() + below
        };
        match runs.last_mut() {
            Some(last) if last.to + last.length == to => last.length += 1,
            _ => runs.push(RelativeRun { from, to, length: 1 }),
        }
    }
    runs
}

/// Sorts the entries of the matrix by columns of the factor and finds their positions in the
/// panels.
pub(super) fn assembly_map(
    pattern: &SymmetricPattern,
    order: &[usize],
    supernodes: &mut [Supernode],
) -> Csr<Entry> {
    let n = order.len();
    let position = inverse_permutation(order);
    let slots = (0..n).flat_map(|column| {
        (pattern.columns[column]..pattern.columns[column + 1]).map(move |slot| (column, slot))
    });
    // The target is the row at first, and then its position in the panel.
    let mut entries = Csr::from_pairs(
        n,
        slots.map(|(column, slot)| {
            let (p, q) = (position[column], position[pattern.rows[slot]]);
            (p.min(q), Entry { slot: slot as u32, target: p.max(q) as u32 })
        }),
    );
    let mut row_in_front = vec![0; n];
    let mut columns = entries.rows_mut();
    for node in supernodes.iter() {
        let (width, below) = node.size();
        let rows = node.columns.clone().chain(node.rows.iter().copied());
        rows.enumerate().for_each(|(k, row)| row_in_front[row] = k);
        for (k, column) in columns.by_ref().take(width).enumerate() {
            for entry in column {
                let row = row_in_front[entry.target as usize];
                entry.target = (row + k * (width + below)) as u32;
            }
        }
    }
    drop(columns);
    for node in supernodes {
        node.entries = entries.start(node.columns.start)..entries.start(node.columns.end);
    }
    entries
}
