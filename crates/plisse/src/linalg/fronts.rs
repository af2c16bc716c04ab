//! The numeric part of a sparse Cholesky factorisation by dense fronts (Duff & Reid 1983; Liu 1992), in parallel over the subtrees
//! of the elimination tree and inside large fronts.
//!
//! Each supernode (columns with the same rows below them) gathers its entries of the matrix and what its children leave it,
//! factorises its columns, and leaves the rest of its front to its parent. Whatever the number of threads, the same sums are made
//! in the same order: children add up as they are numbered, and large fronts are divided into blocks of a fixed width.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{LltRegularization, cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::perm::PermRef;
use faer::prelude::{Reborrow, ReborrowMut};
use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;
use faer::{Accum, MatMut, MatRef, Par, Spec};
use rayon::prelude::*;

use super::sparse::SymmetricPattern;

/// Width of the blocks of columns into which large fronts are divided, and rows that are solved for at once.
const BLOCK: usize = 192;
/// Floating-point operations from which on subtrees are worth a thread.
const WORTH_A_THREAD: f64 = 4e6;

/// The elimination tree of supernodes, and where the matrix's entries go.
pub(super) struct Fronts {
    supernodes: Vec<Supernode>,
    /// Supernodes without a parent.
    roots: Vec<usize>,
    /// Where the entries of the matrix are in its values and go in the panel of their supernode, supernode after supernode.
    entries: Vec<(u32, u32)>,
}

struct Supernode {
    /// Columns, and rows below them.
    width: usize,
    below: usize,
    /// Where its panel, `width + below` rows by `width` columns, is in the factor; and where that of the first in its subtree begins.
    panel: Range<usize>,
    subtree_start: usize,
    children: Vec<usize>,
    /// `[below]` row of the parent's front for each row below.
    in_parent: Vec<u32>,
    entries: Range<usize>,
    /// Floating-point operations in its subtree.
    work: f64,
}

impl Fronts {
    /// The fronts of `pattern`, permuted by `order`, with these supernodes; none if a subtree is not in one piece.
    pub(super) fn new(pattern: &SymmetricPattern, order: PermRef<'_, usize>, symbolic: &SymbolicSupernodalCholesky<usize>) -> Option<Self> {
        let n = symbolic.n_supernodes();
        let (begin, end, start) = (symbolic.supernode_begin(), symbolic.supernode_end(), symbolic.col_ptr_for_val());
        let mut owner = vec![0; pattern.size()];
        for s in 0..n {
            owner[begin[s]..end[s]].fill(s);
        }
        let mut supernodes: Vec<Supernode> = Vec::with_capacity(n);
        let mut children = vec![Vec::new(); n];
        let mut roots = Vec::new();
        // First supernode of each subtree.
        let mut first: Vec<usize> = (0..n).collect();
        for s in 0..n {
            let rows = symbolic.supernode(s).pattern();
            let (width, below) = (end[s] - begin[s], rows.len());
            let mut in_parent = Vec::with_capacity(below);
            match rows.first() {
                None => roots.push(s),
                Some(&row) => {
                    let parent = owner[row];
                    let parent_rows = symbolic.supernode(parent).pattern();
                    for &row in rows {
                        in_parent.push(match row.checked_sub(end[parent]) {
                            None => (row - begin[parent]) as u32,
                            Some(_) => (end[parent] - begin[parent] + parent_rows.binary_search(&row).ok()?) as u32,
                        });
                    }
                    children[parent].push(s);
                }
            }
            let children = std::mem::take(&mut children[s]);
            let mut next = s;
            for &child in children.iter().rev() {
                if child + 1 != next {
                    return None;
                }
                next = first[child];
            }
            first[s] = next;
            let own: f64 = (below + 1..=below + width).map(|rows| (rows * rows) as f64).sum();
            let work = own + children.iter().map(|&child| supernodes[child].work).sum::<f64>();
            let subtree_start = start[next];
            supernodes.push(Supernode {
                width,
                below,
                panel: start[s]..start[s + 1],
                subtree_start,
                children,
                in_parent,
                entries: 0..0,
                work,
            });
        }
        let entries = place_entries(pattern, order, symbolic, &owner, &mut supernodes);
        Some(Self { supernodes, roots, entries })
    }

    /// Writes the factor of the matrix with these `values` into the panels. Returns whether it is positive definite.
    pub(super) fn factorise(&self, values: &[f64], factor: &mut [f64]) -> bool {
        let run = Run { fronts: self, values, failed: AtomicBool::new(false) };
        run.subtrees(&self.roots, factor, 0);
        !run.failed.into_inner()
    }
}

/// Sorts the entries of the matrix by supernode and finds their places in the panels.
fn place_entries(
    pattern: &SymmetricPattern,
    order: PermRef<'_, usize>,
    symbolic: &SymbolicSupernodalCholesky<usize>,
    owner: &[usize],
    supernodes: &mut [Supernode],
) -> Vec<(u32, u32)> {
    let place = order.arrays().1;
    let begin = symbolic.supernode_begin();
    let mut count = vec![0; supernodes.len() + 1];
    let at = |column: usize, slot: usize| {
        let (p, q) = (place[column], place[pattern.rows[slot]]);
        (p.min(q), p.max(q))
    };
    let all =
        || (0..pattern.size()).flat_map(|column| (pattern.columns[column]..pattern.columns[column + 1]).map(move |slot| (column, slot)));
    for (column, slot) in all() {
        count[owner[at(column, slot).0] + 1] += 1;
    }
    for s in 0..supernodes.len() {
        count[s + 1] += count[s];
        supernodes[s].entries = count[s]..count[s + 1];
    }
    let mut entries = vec![(0, 0); pattern.entry_count()];
    for (column, slot) in all() {
        let (column, row) = at(column, slot);
        let s = owner[column];
        let (width, height) = (supernodes[s].width, supernodes[s].width + supernodes[s].below);
        let row = match row.checked_sub(begin[s] + width) {
            None => row - begin[s],
            Some(_) => width + symbolic.supernode(s).pattern().binary_search(&row).expect("the factor has the matrix's entries"),
        };
        entries[count[s]] = (slot as u32, (row + (column - begin[s]) * height) as u32);
        count[s] += 1;
    }
    entries
}

/// One factorisation.
struct Run<'a> {
    fronts: &'a Fronts,
    values: &'a [f64],
    failed: AtomicBool,
}

impl Run<'_> {
    /// Factorises the subtrees of some siblings, whose part of the factor is `factor`, from `offset` on. Returns what each leaves
    /// to the parent: a lower triangle, `below` by `below`, column by column.
    fn subtrees(&self, siblings: &[usize], factor: &mut [f64], offset: usize) -> Vec<Vec<f64>> {
        let supernodes = &self.fronts.supernodes;
        let work: f64 = siblings.iter().map(|&s| supernodes[s].work).sum();
        if siblings.len() < 2 || work < WORTH_A_THREAD {
            let part = |&s: &usize| self.subtree(s, &mut factor[supernodes[s].subtree_start - offset..supernodes[s].panel.end - offset]);
            return siblings.iter().map(part).collect();
        }
        let (left, right) = siblings.split_at(siblings.len() / 2);
        let middle = supernodes[right[0]].subtree_start;
        let (first, second) = factor.split_at_mut(middle - offset);
        let (mut left, right) = rayon::join(|| self.subtrees(left, first, offset), || self.subtrees(right, second, middle));
        left.extend(right);
        left
    }

    fn subtree(&self, s: usize, factor: &mut [f64]) -> Vec<f64> {
        let node = &self.fronts.supernodes[s];
        let (inside, panel) = factor.split_at_mut(node.panel.start - node.subtree_start);
        let left = self.subtrees(&node.children, inside, node.subtree_start);
        if self.failed.load(Ordering::Relaxed) {
            return Vec::new();
        }
        let (width, below, height) = (node.width, node.below, node.width + node.below);
        panel.fill(0.0);
        for &(slot, place) in &self.fronts.entries[node.entries.clone()] {
            panel[place as usize] += self.values[slot as usize];
        }
        for (&child, left) in node.children.iter().zip(&left) {
            let rows = &self.fronts.supernodes[child].in_parent;
            for (j, &column) in rows.iter().enumerate().take_while(|(_, column)| (**column as usize) < width) {
                let out = &mut panel[column as usize * height..][..height];
                add_to(out, &rows[j..], &left[j * rows.len() + j..][..rows.len() - j], 0);
            }
        }
        let mut panel = MatMut::from_column_major_slice_mut(panel, height, width);
        if !factorise_panel(panel.rb_mut()) {
            self.failed.store(true, Ordering::Relaxed);
            return Vec::new();
        }
        let mut rest = vec![0.0; below * below];
        subtract_square(MatMut::from_column_major_slice_mut(&mut rest, below, below), panel.rb().split_at_row(width).1);
        for (&child, left) in node.children.iter().zip(&left) {
            let rows = &self.fronts.supernodes[child].in_parent;
            let inside = rows.partition_point(|&row| (row as usize) < width);
            for (j, &column) in rows.iter().enumerate().skip(inside) {
                let out = &mut rest[(column as usize - width) * below..][..below];
                add_to(out, &rows[j..], &left[j * rows.len() + j..][..rows.len() - j], width);
            }
        }
        rest
    }
}

/// `out[row − shift] += value` for all `rows` and their `values`.
fn add_to(out: &mut [f64], rows: &[u32], values: &[f64], shift: usize) {
    for (&row, value) in rows.iter().zip(values) {
        out[row as usize - shift] += value;
    }
}

/// Replaces the columns of a front by those of its factor, block after block. Returns whether they are positive definite.
fn factorise_panel(panel: MatMut<'_, f64>) -> bool {
    let width = panel.ncols();
    let block = width.min(BLOCK);
    let (columns, mut after) = panel.split_at_col_mut(block);
    let (mut top, mut bottom) = columns.split_at_row_mut(block);
    let mut memory = MemBuffer::new(cholesky_in_place_scratch::<f64>(block, Par::Seq, Spec::default()));
    let stack = MemStack::new(&mut memory);
    if cholesky_in_place(top.rb_mut(), LltRegularization::default(), Par::Seq, stack, Spec::default()).is_err() {
        return false;
    }
    let top = top.rb();
    let solve = |rows: MatMut<'_, f64>| solve_lower_triangular_in_place(top, rows.transpose_mut(), Par::Seq);
    if bottom.nrows() <= BLOCK {
        solve(bottom.rb_mut());
    } else {
        row_blocks(bottom.rb_mut()).into_par_iter().for_each(solve);
    }
    if width == block {
        return true;
    }
    let mut after = after.rb_mut().split_at_row_mut(block).1;
    subtract_square(after.rb_mut(), bottom.rb());
    factorise_panel(after)
}

/// `out −= l·lᵀ` on the lower triangle of as many columns as `out` has; what is above it is not touched or meaningless.
fn subtract_square(out: MatMut<'_, f64>, l: MatRef<'_, f64>) {
    let one = |(first, out): (usize, MatMut<'_, f64>)| {
        let l = l.split_at_row(first).1;
        let (across, low) = l.split_at_row(out.ncols());
        let (top, rest) = out.split_at_row_mut(across.nrows());
        let (lower, full) = (BlockStructure::TriangularLower, BlockStructure::Rectangular);
        triangular::matmul(top, lower, Accum::Add, across, full, across.transpose(), full, -1.0, Par::Seq);
        if low.nrows() > 0 {
            matmul(rest, Accum::Add, low, across.transpose(), -1.0, Par::Seq);
        }
    };
    if out.ncols() <= BLOCK {
        one((0, out));
    } else {
        column_blocks(out).into_par_iter().for_each(one);
    }
}

fn row_blocks(mut rows: MatMut<'_, f64>) -> Vec<MatMut<'_, f64>> {
    let mut blocks = Vec::new();
    while rows.nrows() > BLOCK {
        let (block, rest) = rows.split_at_row_mut(BLOCK);
        blocks.push(block);
        rows = rest;
    }
    blocks.push(rows);
    blocks
}

/// Blocks of columns, from the row of their diagonal on, and the number of their first column.
fn column_blocks(mut columns: MatMut<'_, f64>) -> Vec<(usize, MatMut<'_, f64>)> {
    let (mut blocks, mut first) = (Vec::new(), 0);
    while columns.ncols() > BLOCK {
        let (block, rest) = columns.split_at_col_mut(BLOCK);
        blocks.push((first, block));
        columns = rest.split_at_row_mut(BLOCK).1;
        first += BLOCK;
    }
    blocks.push((first, columns));
    blocks
}
