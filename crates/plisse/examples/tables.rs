//! Writes docs/results.md: what the library finds on the scenes and on published data, next to what was published.
//!
//! `cargo run --release -p plisse --example tables -- [DATA_FOLDER] > docs/results.md`
//!
//! The data folder holds `tfw-disk` and `cylinder-688` (published meshes and solutions); without it their tables are left out.
#![allow(clippy::print_stdout)]

use std::path::{Path, PathBuf};
use std::time::Instant;

use plisse::field::{FieldOptions, Solved, WrinkleFreeRule, solve};
use plisse::io::{clamp_file, obj};
use plisse::linalg::small::Convexity;
use plisse::material::Material;
use plisse::mesh::{Topology, Vec3};
use plisse::progress::Silent;
use plisse::rest::RestMetric;
use plisse::scene::{self, Scene};
use plisse::shell::{BaseReport, solve_base};
use plisse::surface::{Displacement, displace, upsample};

/// Runs of which the median time counts.
const RUNS: usize = 5;

fn main() -> Result<(), plisse::Error> {
    println!("# Results\n");
    println!("Written by `cargo run --release -p plisse --example tables -- DATA_FOLDER`; times are medians of {RUNS} runs with");
    println!(
        "{} threads. Published figures are those of Chen et al. 2021 and of its code, measured on a 2-core machine.\n",
        rayon::current_num_threads()
    );
    if let Some(data) = std::env::args().nth(1) {
        published_data(&PathBuf::from(data))?;
    }
    twisted_cylinder()?;
    stretched_sheet()?;
    sheared_rectangle()?;
    treatments()?;
    ablation()
}

fn published_data(data: &Path) -> Result<(), plisse::Error> {
    println!("## On published data\n");
    println!("The same rest shape, pose and material as the published code; nothing but the field is solved.\n");
    println!(
        "| | energy (J) | published | largest amplitude (m) | published | waves before rounding | after | published | iterations | seconds | published code | ratio |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|");
    let material = Material::new(1e7, 0.44, 1e-4)?;
    let mut notes = Vec::new();
    for (name, clamp, energy, amplitude, waves, seconds) in [
        ("tfw-disk", None, "1.973936e-2", "1.0544e-3", "85", 1.13),
        ("tfw-disk", Some("clamped.dat"), "–", "–", "–", 4.37),
        ("cylinder-688", Some("clamp.dat"), "8.035660e-1", "1.4623e-2", "47", 73.7),
    ] {
        let folder = data.join(name);
        let rest_shape = obj::read(&folder.join("rest.obj"))?;
        let pose = obj::read_pose(&folder.join("pose.obj"), &rest_shape)?;
        let rest = RestMetric::from_shape(name, &rest_shape.positions, &rest_shape.faces)?;
        let topology = Topology::new(name, pose.positions.len(), pose.faces)?;
        let mut held = vec![false; topology.vertex_count];
        if let Some(file) = clamp {
            for v in clamp_file::read_clamped_vertices(&folder.join(file), topology.vertex_count)? {
                held[v] = true;
            }
        }
        let options = FieldOptions { rule: WrinkleFreeRule::Published, ..FieldOptions::default() };
        let (solved, field_seconds) = timed(|| solve(&topology, &rest, &pose.positions, &held, &material, &options, &Silent))?;
        let period = solved.report.periods[0];
        println!(
            "| {name}{} | {:.6e} | {energy} | {:.4e} | {amplitude} | {:.2} | {} | {waves} | {} | {field_seconds:.4} | {seconds} | {:.0} |",
            if clamp.is_some() { ", rim held" } else { "" },
            solved.report.energy_joule,
            largest(&solved.field.amplitude_m),
            period.before_rounding,
            period.turns,
            solved.report.iterations,
            seconds / field_seconds
        );
        if clamp.is_some() {
            continue;
        }
        if let Ok(text) = std::fs::read_to_string(folder.join("amplitude.txt")) {
            let published: Vec<f64> = text.split_whitespace().filter_map(|word| word.parse().ok()).collect();
            let difference: f64 = published.iter().zip(&solved.field.amplitude_m).map(|(a, b)| (a - b).powi(2)).sum();
            let square: f64 = published.iter().map(|a| a * a).sum();
            notes.push(format!(
                "{name}: amplitudes differ from the published ones by {:.3} % (root mean square).",
                100.0 * (difference / square).sqrt()
            ));
        }
        let flat = &rest_shape.positions;
        let surface_seconds = median(
            (0..RUNS)
                .map(|_| {
                    let begun = Instant::now();
                    let fine = upsample(&topology, &pose.positions, &solved.field, flat, &rest_shape.faces, 3);
                    std::hint::black_box(displace(&fine, &Displacement { v2: true, v1: None }));
                    begun.elapsed().as_secs_f64()
                })
                .collect(),
        );
        notes.push(format!(
            "{name}: fine surface, 3 levels ({} faces): {surface_seconds:.4} s; published code 0.63 s, ratio {:.0}.",
            64 * topology.face_count(),
            0.63 / surface_seconds
        ));
    }
    println!("\n{}\n", notes.join("\n\n"));
    Ok(())
}

fn twisted_cylinder() -> Result<(), plisse::Error> {
    println!("## Twisted cylinder (scene 01)\n");
    println!("Whole pipeline on irregular meshes, three seeds each. Published: Chen et al. 2021, figure 21.\n");
    println!(
        "| vertices | waves before rounding | waves | published waves | base: iterations, seconds | published code | field: iterations, seconds | published code | ratio |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    let scene = scene::read("examples/01-twisted-cylinder.toml")?;
    for (edge, waves, base_seconds, field_seconds) in [
        (0.48, "46 (180 vertices)", "0.06", Some(36.6)),
        (0.345, "46 (344)", "0.13", Some(51.9)),
        (0.241, "47 (688)", "1.0", Some(73.7)),
        (0.175, "46 (1309)", "1.7", Some(121.0)),
        (0.125, "45 (2543)", "–", None),
    ] {
        for seed in 1..=3 {
            let mut scene = scene.clone();
            scene.panel[0].edge_length_m = edge;
            scene.panel[0].seed = seed;
            let run = run(&scene)?;
            let period = run.solved.report.periods[0];
            println!(
                "| {} | {:.2} | {} | {waves} | {}, {:.3} | {base_seconds} | {}, {:.3} | {} | {} |",
                run.pose.len(),
                period.before_rounding,
                period.turns,
                run.base.iterations,
                run.base.seconds,
                run.solved.report.iterations,
                run.field_seconds,
                field_seconds.map_or("–".to_owned(), |seconds: f64| seconds.to_string()),
                field_seconds.map_or("–".to_owned(), |seconds| format!("{:.0}", seconds / run.field_seconds))
            );
        }
    }
    println!();
    Ok(())
}

fn stretched_sheet() -> Result<(), plisse::Error> {
    println!("## Stretched sheet (scene 02)\n");
    println!("Published at 5 %: 5 waves, 0.42 mm (Chen et al. 2021); theory 0.35 mm (Wang et al. 2018).\n");
    println!("| strain | waves across the middle | peak amplitude (mm) | field energy (J) | iterations | base seconds | field seconds |");
    println!("|---|---|---|---|---|---|---|");
    let scene = scene::read("examples/02-stretched-sheet.toml")?;
    for percent in [2.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0] {
        let mut scene = scene.clone();
        let pull = 0.125 * percent / 100.0;
        scene.clamp[0].move_m = [-pull, 0.0, 0.0];
        scene.clamp[1].move_m = [pull, 0.0, 0.0];
        let run = run(&scene)?;
        println!(
            "| {percent} % | {:.2} | {:.4} | {:.6e} | {} | {:.3} | {:.3} |",
            run.measures[0],
            1e3 * largest(&run.solved.field.amplitude_m),
            run.solved.report.energy_joule,
            run.solved.report.iterations,
            run.base.seconds,
            run.field_seconds
        );
    }
    println!();
    Ok(())
}

fn sheared_rectangle() -> Result<(), plisse::Error> {
    println!("## Sheared rectangle (scene 03)\n");
    println!("Published: 25 wrinkles (Chen et al. 2021, 1k vertices); experiment: 19 (Wong & Pellegrino 2006).\n");
    println!(
        "| seed | vertices | wrinkles along the middle line | field energy (J) | base: iterations, seconds | field: iterations, seconds |"
    );
    println!("|---|---|---|---|---|---|");
    let scene = scene::read("examples/03-sheared-rectangle.toml")?;
    for seed in 1..=6 {
        let mut scene = scene.clone();
        scene.panel[0].seed = seed;
        let run = run(&scene)?;
        println!(
            "| {seed} | {} | {:.2} | {:.5e} | {}, {:.2} | {}, {:.3} |",
            run.pose.len(),
            run.measures[0],
            run.solved.report.energy_joule,
            run.base.iterations,
            run.base.seconds,
            run.solved.report.iterations,
            run.field_seconds
        );
    }
    println!();
    Ok(())
}

fn treatments() -> Result<(), plisse::Error> {
    println!("## Which minimum is found\n");
    println!("The energy has many minima. While the Hessian is indefinite, negative eigenvalues of element Hessians are mirrored");
    println!("(the default) or clamped to zero; energies are of the field (J), lower is better.\n");
    println!("| scene | mirrored: energy, iterations | clamped: energy, iterations |");
    println!("|---|---|---|");
    for name in ["01-twisted-cylinder", "02-stretched-sheet", "03-sheared-rectangle"] {
        let mut built = scene::build(&scene::read(format!("examples/{name}.toml"))?)?;
        let mut cells = Vec::new();
        for convexity in [Convexity::Mirrored, Convexity::Clamped] {
            built.field.convexity = convexity;
            let report = run_built(&built)?.solved.report;
            cells.push(format!("{:.7e}, {}", report.energy_joule, report.iterations));
        }
        println!("| {name} | {} |", cells.join(" | "));
    }
    println!();
    Ok(())
}

fn ablation() -> Result<(), plisse::Error> {
    println!("## What each term is for\n");
    println!("Scene 01 with one term or correction left out. Published without v₁: more than 180 waves (figure 4).\n");
    println!("| left out | waves before rounding | largest amplitude (mm) | iterations |");
    println!("|---|---|---|---|");
    let scene = scene::read("examples/01-twisted-cylinder.toml")?;
    for name in ["nothing", "v1", "v2", "curvature", "mixed", "amplitude-gradient", "bending"] {
        let mut built = scene::build(&scene)?;
        if let Some(terms) = built.field.terms.without(name) {
            built.field.terms = terms;
        }
        let run = run_built(&built)?;
        println!(
            "| {name} | {:.1} | {:.2} | {} |",
            run.solved.report.periods[0].before_rounding,
            1e3 * largest(&run.solved.field.amplitude_m),
            run.solved.report.iterations
        );
    }
    Ok(())
}

struct Run {
    pose: Vec<Vec3>,
    base: BaseReport,
    solved: Solved,
    field_seconds: f64,
    measures: Vec<f64>,
}

fn run(scene: &Scene) -> Result<Run, plisse::Error> {
    run_built(&scene::build(scene)?)
}

fn run_built(built: &scene::Built) -> Result<Run, plisse::Error> {
    let base = || solve_base(&built.setup(), &built.start, &built.base, &Silent);
    let (pose, mut report) = base()?;
    let mut seconds = vec![report.seconds];
    for _ in 1..RUNS {
        seconds.push(base()?.1.seconds);
    }
    report.seconds = median(seconds);
    let held = built.clamps.held();
    let (solved, field_seconds) = timed(|| solve(&built.topology, &built.rest, &pose, &held, &built.material, &built.field, &Silent))?;
    let measures = scene::measure(built, &solved.field, &solved.report).iter().map(|m| m.value).collect();
    Ok(Run { pose, base: report, solved, field_seconds, measures })
}

fn timed(work: impl Fn() -> Result<Solved, plisse::Error>) -> Result<(Solved, f64), plisse::Error> {
    let solved = work()?;
    let mut seconds = Vec::new();
    for _ in 0..RUNS {
        seconds.push(work()?.report.field_seconds);
    }
    Ok((solved, median(seconds)))
}

fn median(mut list: Vec<f64>) -> f64 {
    list.sort_by(f64::total_cmp);
    list[list.len() / 2]
}

fn largest(list: &[f64]) -> f64 {
    list.iter().copied().fold(0.0, f64::max)
}
