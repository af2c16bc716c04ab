//! `plisse live --bench`: milliseconds per stage, on the GPU and by the CPU references, for the
//! paper's two cases and larger meshes.

use std::fmt::Write as _;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use plisse::Result;
use plisse::io::staged::OutputFolder;
use plisse_gpu::{Character, Gpu, Live, Painter, memory_speed};
use plisse_live::camera::Camera;
use plisse_live::crush::{CrushInput, crush};
use plisse_live::draw::Look;
use plisse_live::gather::gather;
use plisse_live::live::{Frame, LiveOptions, LiveState};
use plisse_live::measures::Measures;
use plisse_live::model::Model;
use plisse_live::profile::Profile;
use plisse_live::relax::{PhaseCoupling, relax};
use plisse_live::skin::{Pose, pose, skin};
use plisse_live::stage::{PerStage, Stage, StageTimes};
use plisse_live::texture::Texture;
use plisse_live::weld::{WeldedMesh, fill_normals};
use plisse_live::{Vec3, models};
use serde_json::json;

use crate::arguments::LiveArguments;
use crate::outputs::write_json;
use crate::progress::Bars;
use crate::terminal::{RunEnd, print};

/// Size of the pictures, that of the paper's benchmark (pixels).
const SIZE: [usize; 2] = [1280, 1024];

/// Vertices closer than this share of the sheet's size are welded: none are.
const TOLERANCE: f32 = 1e-7;

/// One row of the table.
struct Case {
    name: &'static str,
    columns: usize,
    rows: usize,
    /// Number of pixels that the model covers.
    pixels: f32,
    /// Milliseconds of skin, crush, relax and render in the paper's table 2.
    published_ms: Option<[f64; 4]>,
}

const CASES: [Case; 5] = [
    Case {
        name: "A",
        columns: 10,
        rows: 10,
        pixels: 940_000.0,
        published_ms: Some([0.06, 0.08, 0.11, 3.11]),
    },
    Case {
        name: "B",
        columns: 43,
        rows: 139,
        pixels: 55_000.0,
        published_ms: Some([0.25, 1.83, 1.75, 5.01]),
    },
    Case { name: "10k", columns: 100, rows: 100, pixels: 500_000.0, published_ms: None },
    Case { name: "100k", columns: 400, rows: 250, pixels: 500_000.0, published_ms: None },
    Case { name: "1M", columns: 1000, rows: 1000, pixels: 500_000.0, published_ms: None },
];

/// Measured milliseconds of a case: the median of each stage; `None` where it was not run or cannot
/// be timed.
#[derive(Default)]
struct Row {
    vertices: usize,
    pixels: usize,
    gpu_ms: StageTimes,
    /// Of the CPU references, without the picture.
    cpu_ms: StageTimes,
    /// Least number of bytes that skin, crush and one relax must move.
    bytes: usize,
}

pub(super) fn run(arguments: &LiveArguments, interrupted: &AtomicBool) -> Result<RunEnd> {
    let gpu = if arguments.cpu { None } else { Some(Gpu::new()?) };
    let adapter = gpu.as_ref().map_or("none".to_owned(), |gpu| gpu.adapter.clone());
    let path = arguments.output.clone().unwrap_or_else(|| PathBuf::from("out/live-bench"));
    let mut folder = OutputFolder::create(&path)?;
    let bars = Bars::new(interrupted);
    let bar = bars.counter("bench", CASES.len());
    let speed = gpu.as_ref().map(memory_speed).transpose()?.flatten();
    let mut rows = Vec::new();
    for case in &CASES {
        if interrupted.load(Ordering::SeqCst) {
            break;
        }
        rows.push(measure(case, gpu.as_ref())?);
        bar.inc(1);
    }
    bar.finish_and_clear();
    let mut table = table(&rows, &adapter);
    if let (Some(speed), Some(row)) = (speed, rows.get(CASES.len() - 1)) {
        table += &against_memory(row, speed);
    }
    let list: Vec<serde_json::Value> = rows
        .iter()
        .zip(&CASES)
        .map(|(row, case)| {
            json!({
                "case": case.name,
                "vertices": row.vertices,
                "pixels": row.pixels,
                "stages": Stage::ALL.map(Stage::name),
                "gpu_ms": row.gpu_ms.values(),
                "cpu_ms": row.cpu_ms.values(),
                "bytes_of_skin_crush_relax": row.bytes,
                "published_ms_of_skin_crush_relax_render": case.published_ms,
            })
        })
        .collect();
    folder.write("bench.md", |out| out.write_all(table.as_bytes()))?;
    let whole = json!({
        "adapter": adapter,
        "memory_bytes_per_second": speed,
        "threads": rayon::current_num_threads(),
        "cases": list,
    });
    write_json(&mut folder, "bench.json", &whole)?;
    folder.commit()?;
    print(&table);
    Ok(if rows.len() < CASES.len() { RunEnd::Interrupted } else { RunEnd::Complete })
}

fn table(rows: &[Row], adapter: &str) -> String {
    let mut table = format!(
        "Milliseconds per stage (median). Adapter: {adapter}; CPU references on {} threads; \
         pictures of {} x {} pixels.\n\n\
         | case | vertices | pixels | by | skin | crush | relax | gather | render \
         |\n|---|---|---|---|---|---|---|---|---|\n",
        rayon::current_num_threads(),
        SIZE[0],
        SIZE[1]
    );
    let cell = |ms: &Option<f64>| ms.map_or("".to_owned(), |ms| format!("{ms:.3}"));
    for (row, case) in rows.iter().zip(&CASES) {
        let mut line = |by: &str, ms: &[Option<f64>]| {
            let cells: Vec<String> = ms.iter().map(cell).collect();
            let _ = writeln!(
                table,
                "| {} | {} | {} | {by} | {} |",
                case.name,
                row.vertices,
                row.pixels,
                cells.join(" | ")
            );
        };
        if let Some([skin, crush, relax, render]) = case.published_ms {
            line(
                "paper (GeForce 6800 GT)",
                &[Some(skin), Some(crush), Some(relax), None, Some(render)],
            );
        }
        if row.gpu_ms.values().iter().any(Option::is_some) {
            line("adapter", row.gpu_ms.values());
        }
        line("CPU", row.cpu_ms.values());
    }
    table
}

/// The time of the largest case beside that of moving its bytes at the adapter's memory speed
/// (bytes per second).
fn against_memory(row: &Row, speed: f64) -> String {
    let stages = [Stage::Skin, Stage::Crush, Stage::Relax];
    let Some(took_ms) = stages.map(|stage| row.gpu_ms[stage]).into_iter().sum::<Option<f64>>()
    else {
        return String::new();
    };
    let cost_ms = 1e3 * row.bytes as f64 / speed;
    format!(
        "\nThe adapter's memory moves {:.1} GB/s (a copy). Skin, Crush and one Relax of {} \
         vertices move at least {:.0} MB, which costs {cost_ms:.3} ms at \
         that speed; they take {took_ms:.3} ms, {:.1} times that.\n",
        speed * 1e-9,
        row.vertices,
        row.bytes as f64 * 1e-6,
        took_ms / cost_ms
    )
}

fn measure(case: &Case, gpu: Option<&Gpu>) -> Result<Row> {
    let mut model: Model = models::sheet(case.columns, case.rows);
    let welded = WeldedMesh::new(&model, TOLERANCE);
    fill_normals(&mut model, &welded);
    let options = LiveOptions { first_rounds: 1, propagate_new: false, ..LiveOptions::new(0.05) };
    let frames = (2_000_000 / welded.count()).clamp(5, 60);
    let poses: Vec<Pose> =
        (0..frames).map(|k| pose(&model, model.clip(None), k as f32 / frames as f32)).collect();
    let neighbours = welded.neighbours.len();
    // Rest and posed vertices, joints and weights in and out of Skin; each array of Crush and Relax
    // once.
    let skin_bytes = 32 + 32 + 24;
    let bytes = 2 * welded.count() * skin_bytes
        + welded.count() * (64 + 8 + 48 + 32 + 16 + 8 + 8)
        + 8 * neighbours;
    let mut row = Row { vertices: welded.count(), bytes, ..Row::default() };
    if let Some(gpu) = gpu {
        let character = Character {
            model: &model,
            welded: &welded,
            wavelength_m: &options.wavelength_m,
            bias: &[],
        };
        (row.gpu_ms, row.pixels) = measure_gpu(gpu, character, &poses, &options, case.pixels)?;
    }
    let few = &poses[..frames.min(20)];
    row.cpu_ms = measure_cpu(&model, &welded, few, &options);
    Ok(row)
}

/// Medians on the GPU, and the number of pixels that the model covers: about `pixels`.
fn measure_gpu(
    gpu: &Gpu,
    character: Character<'_>,
    poses: &[Pose],
    options: &LiveOptions,
    pixels: f32,
) -> Result<(StageTimes, usize)> {
    let mut live = Live::new(gpu, &[character])?;
    live.begin(gpu, &[character], &[&poses[0]], options)?;
    let texture = Texture::checked();
    let painter = Painter::new(gpu, SIZE, 1, &[&texture])?;
    let profile = Profile::sine();
    let look =
        Look { profile: &profile, texture: &texture, colour: Vec3::repeat(1.0), parallax: true };
    let places = &character.welded.vertices.positions;
    let mut camera = Camera::fit(places.iter(), 0.0, 0.0, SIZE[0] as f32 / SIZE[1] as f32);
    live.step(gpu, &[&poses[poses.len() / 2]], options)?;
    let mut covered = 0;
    for _ in 0..4 {
        painter.draw(gpu, &mut live, &camera, &look)?;
        covered = painter.read(gpu)?.covered;
        camera = camera.nearer((pixels / covered.max(1) as f32).sqrt());
    }
    let mut measures = Measures::default();
    for now in poses {
        live.step(gpu, &[now], options)?;
        painter.draw(gpu, &mut live, &camera, &look)?;
        measures.push_times(&live.times_ms(gpu, true)?);
    }
    Ok((PerStage::from_fn(|stage| measures.stage_ms_median(stage)), covered))
}

/// Medians of the CPU references.
fn measure_cpu(
    model: &Model,
    welded: &WeldedMesh,
    poses: &[Pose],
    options: &LiveOptions,
) -> StageTimes {
    let mut measures = Measures::default();
    let mut phase = vec![0.0; welded.count()];
    let mut next = phase.clone();
    for now in poses {
        let mut begun = Instant::now();
        let mut take = |stage: Stage| {
            measures.stage_ms[stage].push(begun.elapsed().as_secs_f64() * 1e3);
            begun = Instant::now();
        };
        // Welded and draw vertices, as on the GPU.
        let posed = skin(&welded.vertices, now);
        let drawn = skin(&model.draw, now);
        take(Stage::Skin);
        let input =
            CrushInput { wavelength_m: &options.wavelength_m, bias: &[], last_direction: &[] };
        let waves = crush(welded, &posed, &input);
        take(Stage::Crush);
        let coupling = PhaseCoupling { mesh: welded, positions: &posed.positions, waves: &waves };
        relax(&coupling, options.rate, &phase, &mut next);
        take(Stage::Relax);
        let state = LiveState { frame: 0, posed, waves, phase: next };
        let faces = gather(model, welded, &Frame { state: &state, drawn: &drawn });
        take(Stage::Gather);
        drop(faces);
        next = std::mem::replace(&mut phase, state.phase);
    }
    PerStage::from_fn(|stage| measures.stage_ms_median(stage))
}
