//! The numeric part of a sparse Cholesky factorisation by dense fronts (Duff & Reid 1983; Liu
//! 1992), in parallel over the subtrees of the elimination tree and inside large fronts.
//!
//! Each supernode (columns with the same rows below them) gathers its entries of the matrix and
//! what its children leave it, factorises its columns, and leaves the rest of its front to its
//! parent. Whatever the number of threads, the same sums are made in the same order: children add
//! up as they are numbered, and large fronts are divided into blocks of a fixed width.

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

use super::elimination::{self, Elimination};
use super::sparse::SymmetricPattern;

/// Width of the blocks of columns into which large fronts are divided, and rows that are solved for
/// at once.
const BLOCK: usize = 192;
/// Floating-point operations from which on subtrees are worth a thread, and their least share of
/// all of them: no more than so many can wait for each other.
const WORTH_A_THREAD: f64 = 4e6;
const LEAST_SHARE: f64 = 1.0 / 256.0;
/// Entries up to which what a front leaves is written where another left something before.
const SMALL: usize = 1 << 18;

/// The elimination tree of supernodes, where the matrix's entries go, and the factor.
pub(super) struct Fronts {
    supernodes: Vec<Supernode>,
    /// Supernodes without a parent.
    roots: Vec<usize>,
    /// `[n]` the unknown that goes first, the one after it, …
    order: Vec<usize>,
    /// Where the entries of the matrix are in its values and go in the panel of their supernode,
    /// supernode after supernode.
    entries: Vec<(u32, u32)>,
    factor: Vec<f64>,
    /// Memory for what small fronts leave.
    spare: Mutex<Vec<Vec<f64>>>,
    /// Room for a right-hand side, and for what one supernode does to it.
    right: Vec<f64>,
    part: Vec<f64>,
}

struct Supernode {
    columns: Range<usize>,
    /// Rows below them.
    rows: Vec<usize>,
    /// Where its panel, `width + below` rows by `width` columns, is in the factor; and where that
    /// of the first in its subtree begins.
    panel: Range<usize>,
    subtree_start: usize,
    /// The first in its subtree; the others follow, itself the last.
    first: usize,
    children: Vec<usize>,
    /// Rows below that are rows of the parent's front, as they follow each other in both.
    in_parent: Vec<Piece>,
    entries: Range<usize>,
    /// Floating-point operations in its subtree.
    work: f64,
}

/// Rows that follow each other in a front and in its parent's.
struct Piece {
    /// The first among the rows below.
    from: usize,
    /// The first in the parent's front.
    to: usize,
    length: usize,
}

impl Fronts {
    /// The fronts of `pattern` under `elimination`.
    pub(super) fn new(pattern: &SymmetricPattern, elimination: &Elimination) -> Self {
        let all = &elimination.supernodes;
        let mut children = vec![Vec::new(); all.len()];
        let mut roots = Vec::new();
        let mut supernodes: Vec<Supernode> = Vec::with_capacity(all.len());
        let mut end = 0;
        for (s, node) in all.iter().enumerate() {
            let in_parent = match all.get(node.parent) {
                Some(parent) => {
                    children[node.parent].push(s);
                    pieces(&node.rows, parent)
                }
                None => {
                    roots.push(s);
                    Vec::new()
                }
            };
            let children = std::mem::take(&mut children[s]);
            let (width, below) = (node.columns.len(), node.rows.len());
            let own: f64 = (below + 1..=below + width).map(|rows| (rows * rows) as f64).sum();
            let panel = end..end + width * (width + below);
            end = panel.end;
            supernodes.push(Supernode {
                columns: node.columns.clone(),
                rows: node.rows.clone(),
                subtree_start: children
                    .first()
                    .map_or(panel.start, |&child| supernodes[child].subtree_start),
                first: children.first().map_or(s, |&child| supernodes[child].first),
                panel,
                work: own + children.iter().map(|&child| supernodes[child].work).sum::<f64>(),
                children,
                in_parent,
                entries: 0..0,
            });
        }
        let entries = place_entries(pattern, &elimination.order, &mut supernodes);
        let longest = supernodes.iter().map(|node| node.rows.len()).max().unwrap_or(0);
        Self {
            entries,
            roots,
            order: elimination.order.clone(),
            factor: vec![0.0; end],
            spare: Mutex::default(),
            right: vec![0.0; pattern.size()],
            part: vec![0.0; longest],
            supernodes,
        }
    }

    /// Factorises the matrix with these `values`. Returns whether it is positive definite.
    pub(super) fn factorise(&mut self, values: &[f64]) -> bool {
        let mut factor = std::mem::take(&mut self.factor);
        let work: f64 = self.roots.iter().map(|&root| self.supernodes[root].work).sum();
        let run = Run {
            fronts: self,
            values,
            worth: WORTH_A_THREAD.max(work * LEAST_SHARE),
            failed: AtomicBool::new(false),
        };
        run.subtrees(&self.roots, &mut factor, 0);
        let failed = run.failed.into_inner();
        self.factor = factor;
        !failed
    }

    /// Replaces `x` by A⁻¹x for the matrix A that was factorised last.
    pub(super) fn solve(&mut self, x: &mut [f64]) {
        let Self { supernodes, order, factor, right, part, .. } = self;
        order.iter().zip(right.iter_mut()).for_each(|(&unknown, at)| *at = x[unknown]);
        for node in supernodes.iter() {
            let (top, bottom) = node.factor(factor);
            let (width, below) = node.size();
            let mut here =
                MatMut::from_column_major_slice_mut(&mut right[node.columns.clone()], width, 1);
            solve_lower_triangular_in_place(top, here.rb_mut(), Par::Seq);
            let part = &mut part[..below];
            matmul(
                MatMut::from_column_major_slice_mut(part, below, 1),
                Accum::Replace,
                bottom,
                here.rb(),
                1.0,
                Par::Seq,
            );
            node.rows.iter().zip(part).for_each(|(&row, value)| right[row] -= *value);
        }
        for node in supernodes.iter().rev() {
            let (top, bottom) = node.factor(factor);
            let (width, below) = node.size();
            let part = &mut part[..below];
            node.rows.iter().zip(part.iter_mut()).for_each(|(&row, value)| *value = right[row]);
            let mut here =
                MatMut::from_column_major_slice_mut(&mut right[node.columns.clone()], width, 1);
            let part = MatRef::from_column_major_slice(part, below, 1);
            matmul(here.rb_mut(), Accum::Add, bottom.transpose(), part, -1.0, Par::Seq);
            solve_upper_triangular_in_place(top.transpose(), here, Par::Seq);
        }
        order.iter().zip(right.iter()).for_each(|(&unknown, at)| x[unknown] = *at);
    }
}

impl Supernode {
    /// Columns, and rows below them.
    fn size(&self) -> (usize, usize) {
        (self.columns.len(), self.rows.len())
    }

    /// Adds what it left to `columns` of its parent's front, of which `out` holds the last `height`
    /// rows.
    fn add_to_parent(&self, left: &[f64], columns: Range<usize>, out: &mut [f64], height: usize) {
        let below = self.rows.len();
        // Rows of the front above those in `out`: all that is stored begins with the first column's
        // diagonal.
        let above = columns.start;
        for (p, piece) in self.in_parent.iter().enumerate() {
            for k in 0..piece.length {
                if !columns.contains(&(piece.to + k)) {
                    continue;
                }
                let out = &mut out[(piece.to + k - above) * height..][..height];
                let left = &left[(piece.from + k) * below..][..below];
                let mut add = |from: usize, to: usize, length: usize| {
                    out[to - above..][..length]
                        .iter_mut()
                        .zip(&left[from..][..length])
                        .for_each(|(out, left)| *out += left);
                };
                add(piece.from + k, piece.to + k, piece.length - k);
                self.in_parent[p + 1..]
                    .iter()
                    .for_each(|piece| add(piece.from, piece.to, piece.length));
            }
        }
    }

    /// Its part of the factor: its columns' triangle, and the rows below it.
    fn factor<'a>(&self, factor: &'a [f64]) -> (MatRef<'a, f64>, MatRef<'a, f64>) {
        let (width, below) = self.size();
        MatRef::from_column_major_slice(&factor[self.panel.clone()], width + below, width)
            .split_at_row(width)
    }
}

/// Where these `rows` are in the front of `parent`.
fn pieces(rows: &[usize], parent: &elimination::Supernode) -> Vec<Piece> {
    let (mut pieces, mut below) = (Vec::<Piece>::new(), 0);
    for (from, &row) in rows.iter().enumerate() {
        let to = if row < parent.columns.end {
            row - parent.columns.start
        } else {
            below += parent.rows[below..].iter().take_while(|&&other| other < row).count();
            parent.columns.len() + below
        };
        match pieces.last_mut() {
            Some(last) if last.to + last.length == to => last.length += 1,
            _ => pieces.push(Piece { from, to, length: 1 }),
        }
    }
    pieces
}

/// Sorts the entries of the matrix by supernode and finds their places in the panels.
fn place_entries(
    pattern: &SymmetricPattern,
    order: &[usize],
    supernodes: &mut [Supernode],
) -> Vec<(u32, u32)> {
    let n = order.len();
    let mut place = vec![0; n];
    order.iter().enumerate().for_each(|(k, &unknown)| place[unknown] = k);
    let all = || {
        (0..n).flat_map(|column| {
            (pattern.columns[column]..pattern.columns[column + 1]).map(move |slot| (column, slot))
        })
    };
    let at = |column: usize, slot: usize| {
        let (p, q) = (place[column], place[pattern.rows[slot]]);
        (p.min(q), p.max(q))
    };
    // Entries by column: first the slot and the row, then, supernode after supernode, the place in
    // the panel for the row.
    let mut end = vec![0; n + 1];
    all().for_each(|(column, slot)| end[at(column, slot).0 + 1] += 1);
    (0..n).for_each(|k| end[k + 1] += end[k]);
    let begin = end.clone();
    let mut entries = vec![(0, 0); pattern.entry_count()];
    for (column, slot) in all() {
        let (column, row) = at(column, slot);
        entries[end[column]] = (slot as u32, row as u32);
        end[column] += 1;
    }
    let mut in_front = vec![0; n];
    for node in supernodes {
        let (width, below) = node.size();
        let rows = node.columns.clone().chain(node.rows.iter().copied());
        rows.enumerate().for_each(|(k, row)| in_front[row] = k);
        for (k, column) in node.columns.clone().enumerate() {
            for entry in &mut entries[begin[column]..begin[column + 1]] {
                entry.1 = (in_front[entry.1 as usize] + k * (width + below)) as u32;
            }
        }
        node.entries = begin[node.columns.start]..begin[node.columns.end];
    }
    entries
}

/// One factorisation.
struct Run<'a> {
    fronts: &'a Fronts,
    values: &'a [f64],
    /// Floating-point operations from which on subtrees are worth a thread.
    worth: f64,
    failed: AtomicBool,
}

impl Run<'_> {
    /// Factorises the subtrees of some siblings, whose part of the factor is `factor`, from
    /// `offset` on. Returns what each leaves to the parent: a lower triangle, `below` by `below`,
    /// column by column.
    fn subtrees(&self, siblings: &[usize], factor: &mut [f64], offset: usize) -> Vec<Vec<f64>> {
        let supernodes = &self.fronts.supernodes;
        let work: f64 = siblings.iter().map(|&s| supernodes[s].work).sum();
        if siblings.len() < 2 || work < self.worth {
            let part = |&s: &usize| {
                self.subtree(
                    s,
                    &mut factor
                        [supernodes[s].subtree_start - offset..supernodes[s].panel.end - offset],
                )
            };
            return siblings.iter().map(part).collect();
        }
        let (left, right) = siblings.split_at(siblings.len() / 2);
        let middle = supernodes[right[0]].subtree_start;
        let (first, second) = factor.split_at_mut(middle - offset);
        let (mut left, right) = rayon::join(
            || self.subtrees(left, first, offset),
            || self.subtrees(right, second, middle),
        );
        left.extend(right);
        left
    }

    /// The same for one subtree.
    fn subtree(&self, s: usize, factor: &mut [f64]) -> Vec<f64> {
        let supernodes = &self.fronts.supernodes;
        let offset = supernodes[s].subtree_start;
        if supernodes[s].work < self.worth {
            return self.one_by_one(s, factor, offset);
        }
        // Down along the child with most work while nothing beside it is worth a thread. For a
        // ribbon that way is as long as the ribbon.
        let (mut way, mut bottom) = (Vec::new(), s);
        while let Some(child) = self.only_worth(bottom) {
            way.push(bottom);
            bottom = child;
        }
        let node = &supernodes[bottom];
        let inside = &mut factor[node.subtree_start - offset..node.panel.start - offset];
        let left = self.subtrees(&node.children, inside, node.subtree_start);
        let mut last = self.front(bottom, left, factor, offset);
        for &s in way.iter().rev() {
            let mut of = |&child: &usize| {
                if child == bottom {
                    std::mem::take(&mut last)
                } else {
                    self.one_by_one(child, factor, offset)
                }
            };
            let left = supernodes[s].children.iter().map(&mut of).collect();
            last = self.front(s, left, factor, offset);
            bottom = s;
        }
        last
    }

    /// The child of `s` that is worth a thread, if its siblings together are not.
    fn only_worth(&self, s: usize) -> Option<usize> {
        let work = |child: usize| self.fronts.supernodes[child].work;
        let children = &self.fronts.supernodes[s].children;
        let most = children.iter().copied().max_by(|&a, &b| work(a).total_cmp(&work(b)))?;
        let others: f64 =
            children.iter().filter(|&&child| child != most).map(|&child| work(child)).sum();
        (work(most) >= self.worth && others < self.worth).then_some(most)
    }

    /// Factorises the subtree of `s` on this thread; `factor` begins at `offset`. Returns what it
    /// leaves to its parent.
    fn one_by_one(&self, s: usize, factor: &mut [f64], offset: usize) -> Vec<f64> {
        let mut left = Vec::new();
        for node in self.fronts.supernodes[s].first..=s {
            let children = left.split_off(left.len() - self.fronts.supernodes[node].children.len());
            left.push(self.front(node, children, factor, offset));
        }
        left.pop().unwrap_or_default()
    }

    /// Factorises one front, to which its children leave `left`; `factor` begins at `offset`.
    /// Returns what it leaves to its parent.
    fn front(&self, s: usize, left: Vec<Vec<f64>>, factor: &mut [f64], offset: usize) -> Vec<f64> {
        if self.failed.load(Ordering::Relaxed) {
            return Vec::new();
        }
        let node = &self.fronts.supernodes[s];
        let (width, below) = node.size();
        let height = width + below;
        let panel = &mut factor[node.panel.start - offset..node.panel.end - offset];
        panel.fill(0.0);
        for &(slot, place) in &self.fronts.entries[node.entries.clone()] {
            panel[place as usize] += self.values[slot as usize];
        }
        for (&child, left) in node.children.iter().zip(&left) {
            self.fronts.supernodes[child].add_to_parent(left, 0..width, panel, height);
        }
        let mut panel = MatMut::from_column_major_slice_mut(panel, height, width);
        if !factorise_panel(panel.rb_mut()) {
            self.failed.store(true, Ordering::Relaxed);
            return Vec::new();
        }
        let mut rest = self.room(below * below);
        let square = MatMut::from_column_major_slice_mut(&mut rest, below, below);
        subtract_square(square, Accum::Replace, panel.rb().split_at_row(width).1);
        for (&child, left) in node.children.iter().zip(&left) {
            self.fronts.supernodes[child].add_to_parent(left, width..height, &mut rest, below);
        }
        left.into_iter().for_each(|left| self.give_back(left));
        rest
    }

    /// Memory with any values.
    fn room(&self, length: usize) -> Vec<f64> {
        let spare = if length <= SMALL {
            self.fronts.spare.lock().ok().and_then(|mut spare| spare.pop())
        } else {
            None
        };
        let mut room = spare.unwrap_or_default();
        room.resize(length, 0.0);
        room
    }

    fn give_back(&self, room: Vec<f64>) {
        if (1..=SMALL).contains(&room.len())
            && let Ok(mut spare) = self.fronts.spare.lock()
        {
            spare.push(room);
        }
    }
}

/// Replaces the columns of a front by those of its factor, block after block. Returns whether they
/// are positive definite.
fn factorise_panel(panel: MatMut<'_, f64>) -> bool {
    let width = panel.ncols();
    let block = width.min(BLOCK);
    let (columns, mut after) = panel.split_at_col_mut(block);
    let (mut top, mut bottom) = columns.split_at_row_mut(block);
    let mut memory =
        MemBuffer::new(cholesky_in_place_scratch::<f64>(block, Par::Seq, Spec::default()));
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
    if bottom.nrows() <= BLOCK {
        solve(bottom.rb_mut());
    } else {
        row_blocks(bottom.rb_mut()).into_par_iter().for_each(solve);
    }
    if width == block {
        return true;
    }
    let mut after = after.rb_mut().split_at_row_mut(block).1;
    subtract_square(after.rb_mut(), Accum::Add, bottom.rb());
    factorise_panel(after)
}

/// `out −= l·lᵀ`, or `out = −l·lᵀ`, on the lower triangle of as many columns as `out` has; what is
/// above it is not touched or meaningless.
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
