//! The CPU references of the stages: `cargo bench -p plisse-live`. `plisse live --bench` measures
//! the GPU beside them.

use divan::Bencher;
use plisse_live::crush::{CrushInput, crush};
use plisse_live::gather::gather;
use plisse_live::live::{Frame, LiveOptions, LiveState};
use plisse_live::model::Model;
use plisse_live::models;
use plisse_live::relax::relax;
use plisse_live::skin::{Pose, pose, skin};
use plisse_live::weld::{WeldedMesh, fill_normals};

fn main() {
    divan::main();
}

/// Columns and rows: the paper's case B, then 10k and 100k vertices.
const SIZES: [(usize, usize); 3] = [(43, 139), (100, 100), (400, 250)];

fn sheet((columns, rows): (usize, usize)) -> (Model, WeldedMesh, Pose, LiveState) {
    let mut model = models::sheet(columns, rows);
    let welded = WeldedMesh::new(&model, 1e-7);
    fill_normals(&mut model, &welded);
    let pose = pose(&model, model.clip(None), 0.7);
    let mut state = LiveState::default();
    state.step(&welded, &pose, &LiveOptions { first_rounds: 1, ..LiveOptions::new(0.05) });
    (model, welded, pose, state)
}

#[divan::bench(args = SIZES)]
fn stage_skin(bencher: Bencher<'_, '_>, size: (usize, usize)) {
    let (_, welded, pose, _) = sheet(size);
    bencher.bench(|| skin(&welded.vertices, &pose));
}

#[divan::bench(args = SIZES)]
fn stage_crush(bencher: Bencher<'_, '_>, size: (usize, usize)) {
    let (_, welded, _, state) = sheet(size);
    let input =
        CrushInput { wavelength_m: &[0.05], bias: &[], last_direction: &state.waves.direction };
    bencher.bench(|| crush(&welded, &state.posed, &input));
}

#[divan::bench(args = SIZES)]
fn stage_relax(bencher: Bencher<'_, '_>, size: (usize, usize)) {
    let (_, welded, _, state) = sheet(size);
    let mut next = vec![0.0; welded.count()];
    bencher.bench_local(|| relax(&state.coupling(&welded), 0.25, &state.phase, &mut next));
}

#[divan::bench(args = SIZES)]
fn stage_gather(bencher: Bencher<'_, '_>, size: (usize, usize)) {
    let (model, welded, pose, state) = sheet(size);
    let drawn = skin(&model.draw, &pose);
    let frame = Frame { state: &state, drawn: &drawn };
    bencher.bench(|| gather(&model, &welded, &frame));
}
