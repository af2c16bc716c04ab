//! Dense kernels of a front, in parallel over tiles of a fixed width, so that the rounding does not
//! depend on the number of threads.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{
    LltRegularization, cholesky_in_place, cholesky_in_place_scratch,
};
use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::prelude::{Reborrow, ReborrowMut};
use faer::{Accum, MatMut, MatRef, Par, Spec};
use rayon::prelude::*;

/// Width of the tiles of large fronts: columns that are eliminated at once, and rows that are
/// solved for at once.
const TILE: usize = 192;
/// Replaces the columns of a front by those of its factor, tile after tile. Returns false if they
/// are not positive definite.
pub(super) fn factorise_panel(panel: MatMut<'_, f64>) -> bool {
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
pub(super) fn subtract_square(out: MatMut<'_, f64>, accum: Accum, l: MatRef<'_, f64>) {
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
