//! Numeric Cholesky factorisation by the multifrontal method (Duff & Reid 1983; Liu 1992), in
//! parallel over the subtrees of the elimination tree and inside large fronts.
//!
//! The front of each supernode gathers its entries of the matrix and the update blocks of its
//! children (extend-add), is factorised in the supernode's columns, and passes its Schur complement
//! on as the update block for its parent. Sums are made in the same order for any number of
//! threads: children are added as they are numbered, and large fronts are divided into tiles of a
//! fixed width.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_upper_triangular_in_place,
};
use faer::prelude::{Reborrow, ReborrowMut};
use faer::{Accum, MatMut, MatRef, Par};

use super::assembly::{Entry, Supernode, assembly_map, assembly_tree};
use super::dense_front::{factorise_panel, subtract_square};
use super::sparse::SymmetricPattern;
use super::symbolic::SymbolicFactorisation;
use crate::adjacency::{Csr, NONE};

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
    /// `[nnz]` the entries of the matrix, by columns of the factor.
    entries: Csr<Entry>,
    /// The panels of all supernodes, one after the other.
    factor: Vec<f64>,
    pool: BufferPool,
    /// `[n]` memory for a right-hand side, in the order of elimination.
    rhs: Vec<f64>,
    /// Memory for the rows of `rhs` below one supernode.
    below: Vec<f64>,
}

impl Multifrontal {
    /// A factorisation of matrices on `pattern`, analysed as `symbolic`.
    pub(super) fn new(pattern: &SymmetricPattern, symbolic: &SymbolicFactorisation) -> Self {
        let mut supernodes = assembly_tree(&symbolic.supernodes);
        let entries = assembly_map(pattern, &symbolic.order, &mut supernodes);
        let has_no_parent = |&s: &usize| symbolic.supernodes[s].parent == NONE;
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
        for entry in &self.fronts.entries.items()[node.entries.clone()] {
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
