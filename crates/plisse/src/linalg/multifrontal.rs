//! Numeric Cholesky factorisation by the multifrontal method (Duff & Reid 1983; Liu 1992), in
//! parallel over the subtrees of the elimination tree and inside large fronts.
//!
//! The front of each supernode gathers its entries of the matrix and the update blocks of its
//! children (extend-add), is factorised in the supernode's columns, and passes its Schur complement
//! on as the update block for its parent. Sums are made in the same order for any number of
//! threads: children are added as they are numbered, and large fronts are divided into tiles of a
//! fixed width.

use std::ops::Range;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{
    LltRegularization, cholesky_in_place, cholesky_in_place_scratch,
};
use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_upper_triangular_in_place,
};
use faer::prelude::{Reborrow, ReborrowMut};
use faer::{Accum, MatMut, MatRef, Par, Spec};
use rayon::prelude::*;

use super::graph::inverse_permutation;
use super::sparse::SymmetricPattern;
use super::symbolic::{self, SymbolicFactorisation};

/// Width of the tiles of large fronts: columns that are eliminated at once, and rows that are
/// solved for at once.
const TILE: usize = 192;
/// Operation count from which on a subtree is worth a thread.
const PARALLEL_OPERATIONS: f64 = 4e6;
/// Least share of all operations of a subtree that is worth a thread: bounds the number of tasks
/// that wait for each other.
const PARALLEL_SHARE: f64 = 1.0 / 256.0;
/// Largest update block, in entries, whose memory is taken from the pool.
const MAX_POOLED: usize = 1 << 18;

/// Numeric factorisation on the tree of supernodes, and the factor.
pub(super) struct Multifrontal {
    supernodes: Vec<Supernode>,
    /// Supernodes without a parent.
    roots: Vec<usize>,
    /// `[n]` the unknowns in the order of their elimination.
    order: Vec<usize>,
    /// `[nnz]` the entries of the matrix, supernode after supernode.
    entries: Vec<Entry>,
    /// The panels of all supernodes, one after the other.
    factor: Vec<f64>,
    pool: BufferPool,
    /// `[n]` memory for a right-hand side, in the order of elimination.
    rhs: Vec<f64>,
    /// Memory for the rows of `rhs` below one supernode.
    below: Vec<f64>,
}

/// The assembly of one entry of the matrix.
#[derive(Clone, Copy)]
struct Entry {
    /// Slot in the matrix's values.
    slot: u32,
    /// Position in the panel of its supernode.
    target: u32,
}

struct Supernode {
    columns: Range<usize>,
    /// Rows below the columns.
    rows: Vec<usize>,
    /// Range in the factor of its panel: `width + below` rows by `width` columns.
    panel: Range<usize>,
    /// Start in the factor of the panels of its subtree.
    subtree_start: usize,
    /// First supernode of its subtree; the others follow, itself the last.
    first: usize,
    children: Vec<usize>,
    /// Relative indices: the rows below as rows of the parent's front, by contiguous runs.
    relative: Vec<RelativeRun>,
    /// Its entries of the matrix, in [`Multifrontal::entries`].
    entries: Range<usize>,
    /// Operation count of its subtree.
    subtree_operations: f64,
}

/// Rows that are contiguous both in a front and in its parent's.
struct RelativeRun {
    /// The first, among the rows below the front's columns.
    from: usize,
    /// The first, among the rows of the parent's front.
    to: usize,
    length: usize,
}

impl Multifrontal {
    /// A factorisation of matrices on `pattern`, analysed as `symbolic`.
    pub(super) fn new(pattern: &SymmetricPattern, symbolic: &SymbolicFactorisation) -> Self {
        let mut supernodes = assembly_tree(&symbolic.supernodes);
        let entries = assembly_map(pattern, &symbolic.order, &mut supernodes);
        let has_no_parent = |&s: &usize| symbolic.supernodes[s].parent == symbolic::NONE;
        let max_below = supernodes.iter().map(|node| node.rows.len()).max().unwrap_or(0);
        Self {
            entries,
            roots: (0..supernodes.len()).filter(has_no_parent).collect(),
            order: symbolic.order.clone(),
            factor: vec![0.0; supernodes.last().map_or(0, |last| last.panel.end)],
            pool: BufferPool::default(),
            rhs: vec![0.0; pattern.size()],
            below: vec![0.0; max_below],
            supernodes,
        }
    }

    /// Factorises the matrix with these `values`. Returns false if it is not positive definite.
    pub(super) fn factorise(&mut self, values: &[f64]) -> bool {
        let mut factor = std::mem::take(&mut self.factor);
        let operations: f64 =
            self.roots.iter().map(|&root| self.supernodes[root].subtree_operations).sum();
        let run = Factorisation {
            fronts: self,
            values,
            parallel_operations: PARALLEL_OPERATIONS.max(operations * PARALLEL_SHARE),
            failed: AtomicBool::new(false),
        };
        run.subtrees(&self.roots, &mut factor, 0);
        let failed = run.failed.into_inner();
        self.factor = factor;
        !failed
    }

    /// Replaces `x` by A⁻¹x for the matrix A that was factorised last.
    pub(super) fn solve(&mut self, x: &mut [f64]) {
        let Self { supernodes, order, factor, rhs, below: memory, .. } = self;
        order.iter().zip(rhs.iter_mut()).for_each(|(&unknown, at)| *at = x[unknown]);
        for node in supernodes.iter() {
            let (top, bottom) = node.factor(factor);
            let (width, below) = node.size();
            let mut own =
                MatMut::from_column_major_slice_mut(&mut rhs[node.columns.clone()], width, 1);
            solve_lower_triangular_in_place(top, own.rb_mut(), Par::Seq);
            let product = &mut memory[..below];
            matmul(
                MatMut::from_column_major_slice_mut(product, below, 1),
                Accum::Replace,
                bottom,
                own.rb(),
                1.0,
                Par::Seq,
            );
            node.rows.iter().zip(product).for_each(|(&row, value)| rhs[row] -= *value);
        }
        for node in supernodes.iter().rev() {
            let (top, bottom) = node.factor(factor);
            let (width, below) = node.size();
            let solved = &mut memory[..below];
            node.rows.iter().zip(solved.iter_mut()).for_each(|(&row, value)| *value = rhs[row]);
            let mut own =
                MatMut::from_column_major_slice_mut(&mut rhs[node.columns.clone()], width, 1);
            let solved = MatRef::from_column_major_slice(solved, below, 1);
            matmul(own.rb_mut(), Accum::Add, bottom.transpose(), solved, -1.0, Par::Seq);
            solve_upper_triangular_in_place(top.transpose(), own, Par::Seq);
        }
        order.iter().zip(rhs.iter()).for_each(|(&unknown, at)| x[unknown] = *at);
    }
}

impl Supernode {
    /// Number of columns, and of rows below them.
    fn size(&self) -> (usize, usize) {
        (self.columns.len(), self.rows.len())
    }

    /// Extend-add: adds its `update` block to `columns` of its parent's front, of which `out` holds
    /// the last `height` rows.
    fn extend_add(&self, update: &[f64], columns: Range<usize>, out: &mut [f64], height: usize) {
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
    fn factor<'a>(&self, factor: &'a [f64]) -> (MatRef<'a, f64>, MatRef<'a, f64>) {
        let (width, below) = self.size();
        MatRef::from_column_major_slice(&factor[self.panel.clone()], width + below, width)
            .split_at_row(width)
    }
}

/// The tree of supernodes with their panels and relative indices; the entries of the matrix are
/// still to be given out ([`assembly_map`]).
fn assembly_tree(all: &[symbolic::Supernode]) -> Vec<Supernode> {
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

/// Sorts the entries of the matrix by supernode and finds their positions in the panels.
fn assembly_map(
    pattern: &SymmetricPattern,
    order: &[usize],
    supernodes: &mut [Supernode],
) -> Vec<Entry> {
    let n = order.len();
    let position = inverse_permutation(order);
    let all = || {
        (0..n).flat_map(|column| {
            (pattern.columns[column]..pattern.columns[column + 1]).map(move |slot| (column, slot))
        })
    };
    let column_and_row = |column: usize, slot: usize| {
        let (p, q) = (position[column], position[pattern.rows[slot]]);
        (p.min(q), p.max(q))
    };
    // Entries by column: first the slot and, as the target, the row; then, supernode after
    // supernode, the position in the panel for the row.
    let mut end = vec![0; n + 1];
    all().for_each(|(column, slot)| end[column_and_row(column, slot).0 + 1] += 1);
    (0..n).for_each(|k| end[k + 1] += end[k]);
    let begin = end.clone();
    let mut entries = vec![Entry { slot: 0, target: 0 }; pattern.entry_count()];
    for (column, slot) in all() {
        let (column, row) = column_and_row(column, slot);
        entries[end[column]] = Entry { slot: slot as u32, target: row as u32 };
        end[column] += 1;
    }
    let mut row_in_front = vec![0; n];
    for node in supernodes {
        let (width, below) = node.size();
        let rows = node.columns.clone().chain(node.rows.iter().copied());
        rows.enumerate().for_each(|(k, row)| row_in_front[row] = k);
        for (k, column) in node.columns.clone().enumerate() {
            for entry in &mut entries[begin[column]..begin[column + 1]] {
                let row = row_in_front[entry.target as usize];
                entry.target = (row + k * (width + below)) as u32;
            }
        }
        node.entries = begin[node.columns.start]..begin[node.columns.end];
    }
    entries
}

/// Memory of small update blocks that were used up.
#[derive(Default)]
struct BufferPool(Mutex<Vec<Vec<f64>>>);

impl BufferPool {
    /// A buffer with any values.
    fn take(&self, length: usize) -> Vec<f64> {
        let pooled = if length <= MAX_POOLED {
            self.0.lock().ok().and_then(|mut buffers| buffers.pop())
        } else {
            None
        };
        let mut buffer = pooled.unwrap_or_default();
        buffer.resize(length, 0.0);
        buffer
    }

    /// Takes a buffer back that is not needed any more.
    fn put_back(&self, buffer: Vec<f64>) {
        if (1..=MAX_POOLED).contains(&buffer.len())
            && let Ok(mut buffers) = self.0.lock()
        {
            buffers.push(buffer);
        }
    }
}

/// One numeric factorisation.
///
/// Its methods return update blocks: lower triangles, `below` by `below`, column by column. They
/// are given the factor from an `offset` on.
struct Factorisation<'a> {
    fronts: &'a Multifrontal,
    values: &'a [f64],
    /// Operation count from which on a subtree is worth a thread.
    parallel_operations: f64,
    failed: AtomicBool,
}

impl Factorisation<'_> {
    /// Factorises the subtrees of some siblings. Returns their update blocks.
    fn subtrees(&self, siblings: &[usize], factor: &mut [f64], offset: usize) -> Vec<Vec<f64>> {
        let supernodes = &self.fronts.supernodes;
        let operations: f64 = siblings.iter().map(|&s| supernodes[s].subtree_operations).sum();
        if siblings.len() < 2 || operations < self.parallel_operations {
            let subtree = |&s: &usize| {
                let Supernode { subtree_start, panel, .. } = &supernodes[s];
                self.subtree(s, &mut factor[subtree_start - offset..panel.end - offset])
            };
            return siblings.iter().map(subtree).collect();
        }
        let (left, right) = siblings.split_at(siblings.len() / 2);
        let middle = supernodes[right[0]].subtree_start;
        let (first, second) = factor.split_at_mut(middle - offset);
        let (mut updates, more) = rayon::join(
            || self.subtrees(left, first, offset),
            || self.subtrees(right, second, middle),
        );
        updates.extend(more);
        updates
    }

    /// Factorises one subtree, whose part of the factor is `factor`. Returns its update block.
    fn subtree(&self, s: usize, factor: &mut [f64]) -> Vec<f64> {
        let supernodes = &self.fronts.supernodes;
        let offset = supernodes[s].subtree_start;
        if supernodes[s].subtree_operations < self.parallel_operations {
            return self.sequential_subtree(s, factor, offset);
        }
        // The critical path is walked in a loop, as it is as long as the mesh if that is a ribbon.
        let (mut path, mut bottom) = (Vec::new(), s);
        while let Some(child) = self.critical_child(bottom) {
            path.push(bottom);
            bottom = child;
        }
        let node = &supernodes[bottom];
        let inside = &mut factor[node.subtree_start - offset..node.panel.start - offset];
        let updates = self.subtrees(&node.children, inside, node.subtree_start);
        let mut last = self.front(bottom, updates, factor, offset);
        for &s in path.iter().rev() {
            let mut update = |&child: &usize| {
                if child == bottom {
                    std::mem::take(&mut last)
                } else {
                    self.sequential_subtree(child, factor, offset)
                }
            };
            let updates = supernodes[s].children.iter().map(&mut update).collect();
            last = self.front(s, updates, factor, offset);
            bottom = s;
        }
        last
    }

    /// The child of `s` that is worth a thread, if its siblings together are not.
    fn critical_child(&self, s: usize) -> Option<usize> {
        let operations = |child: usize| self.fronts.supernodes[child].subtree_operations;
        let children = &self.fronts.supernodes[s].children;
        let most =
            children.iter().copied().max_by(|&a, &b| operations(a).total_cmp(&operations(b)))?;
        let others: f64 =
            children.iter().filter(|&&child| child != most).map(|&child| operations(child)).sum();
        let threshold = self.parallel_operations;
        (operations(most) >= threshold && others < threshold).then_some(most)
    }

    /// Factorises the subtree of `s` in this thread, front by front. Returns its update block.
    fn sequential_subtree(&self, s: usize, factor: &mut [f64], offset: usize) -> Vec<f64> {
        let mut stack = Vec::new();
        for node in self.fronts.supernodes[s].first..=s {
            let child_count = self.fronts.supernodes[node].children.len();
            let updates = stack.split_off(stack.len() - child_count);
            stack.push(self.front(node, updates, factor, offset));
        }
        stack.pop().unwrap_or_default()
    }

    /// Factorises the front of `s`, given the update blocks of its children. Returns its update
    /// block.
    fn front(
        &self,
        s: usize,
        updates: Vec<Vec<f64>>,
        factor: &mut [f64],
        offset: usize,
    ) -> Vec<f64> {
        if self.failed.load(Ordering::Relaxed) {
            return Vec::new();
        }
        let node = &self.fronts.supernodes[s];
        let (width, below) = node.size();
        let height = width + below;
        let panel = &mut factor[node.panel.start - offset..node.panel.end - offset];
        panel.fill(0.0);
        for entry in &self.fronts.entries[node.entries.clone()] {
            panel[entry.target as usize] += self.values[entry.slot as usize];
        }
        for (&child, update) in node.children.iter().zip(&updates) {
            self.fronts.supernodes[child].extend_add(update, 0..width, panel, height);
        }
        let mut panel = MatMut::from_column_major_slice_mut(panel, height, width);
        if !factorise_panel(panel.rb_mut()) {
            self.failed.store(true, Ordering::Relaxed);
            return Vec::new();
        }
        let mut schur = self.fronts.pool.take(below * below);
        let square = MatMut::from_column_major_slice_mut(&mut schur, below, below);
        subtract_square(square, Accum::Replace, panel.rb().split_at_row(width).1);
        for (&child, update) in node.children.iter().zip(&updates) {
            self.fronts.supernodes[child].extend_add(update, width..height, &mut schur, below);
        }
        updates.into_iter().for_each(|update| self.fronts.pool.put_back(update));
        schur
    }
}

/// Replaces the columns of a front by those of its factor, tile after tile. Returns false if they
/// are not positive definite.
fn factorise_panel(panel: MatMut<'_, f64>) -> bool {
    let width = panel.ncols();
    let tile = width.min(TILE);
    let (columns, mut after) = panel.split_at_col_mut(tile);
    let (mut top, mut bottom) = columns.split_at_row_mut(tile);
    let mut memory =
        MemBuffer::new(cholesky_in_place_scratch::<f64>(tile, Par::Seq, Spec::default()));
    let stack = MemStack::new(&mut memory);
    if cholesky_in_place(
        top.rb_mut(),
        LltRegularization::default(),
        Par::Seq,
        stack,
        Spec::default(),
    )
    .is_err()
    {
        return false;
    }
    let top = top.rb();
    let solve = |rows: MatMut<'_, f64>| {
        solve_lower_triangular_in_place(top, rows.transpose_mut(), Par::Seq)
    };
    if bottom.nrows() <= TILE {
        solve(bottom.rb_mut());
    } else {
        row_tiles(bottom.rb_mut()).into_par_iter().for_each(solve);
    }
    if width == tile {
        return true;
    }
    let mut after = after.rb_mut().split_at_row_mut(tile).1;
    subtract_square(after.rb_mut(), Accum::Add, bottom.rb());
    factorise_panel(after)
}

/// `out −= l·lᵀ`, or `out = −l·lᵀ`, on the lower triangle of as many columns as `out` has; above it
/// `out` is untouched or meaningless.
fn subtract_square(out: MatMut<'_, f64>, accum: Accum, l: MatRef<'_, f64>) {
    let one = |(first, out): (usize, MatMut<'_, f64>)| {
        let l = l.split_at_row(first).1;
        let (across, low) = l.split_at_row(out.ncols());
        let (top, rest) = out.split_at_row_mut(across.nrows());
        let (lower, full) = (BlockStructure::TriangularLower, BlockStructure::Rectangular);
        triangular::matmul(
            top,
            lower,
            accum,
            across,
            full,
            across.transpose(),
            full,
            -1.0,
            Par::Seq,
        );
        if low.nrows() > 0 {
            matmul(rest, accum, low, across.transpose(), -1.0, Par::Seq);
        }
    };
    if out.ncols() <= TILE {
        one((0, out));
    } else {
        column_tiles(out).into_par_iter().for_each(one);
    }
}

fn row_tiles(mut rows: MatMut<'_, f64>) -> Vec<MatMut<'_, f64>> {
    let mut tiles = Vec::new();
    while rows.nrows() > TILE {
        let (tile, rest) = rows.split_at_row_mut(TILE);
        tiles.push(tile);
        rows = rest;
    }
    tiles.push(rows);
    tiles
}

/// Tiles of columns, from the row of their diagonal on, and the number of their first column.
fn column_tiles(mut columns: MatMut<'_, f64>) -> Vec<(usize, MatMut<'_, f64>)> {
    let (mut tiles, mut first) = (Vec::new(), 0);
    while columns.ncols() > TILE {
        let (tile, rest) = columns.split_at_col_mut(TILE);
        tiles.push((first, tile));
        columns = rest.split_at_row_mut(TILE).1;
        first += TILE;
    }
    tiles.push((first, columns));
    tiles
}
