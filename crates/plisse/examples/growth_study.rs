//! The slow study of growth: `cargo run --release -p plisse --example growth_study -- WHAT
//! [PICTURE.png]`, where WHAT is `counts`, `coherence`, `modes` or `picture`. What it prints stands
//! in `docs/growth.md`.

#![allow(clippy::print_stdout)]

use std::error::Error;

use plisse::growth::reference::{ReferenceOptions, grow_by_forces};
use plisse::growth::{Expansion, Growing, GrowthOptions, grow};
use plisse::mesh::grid::{Diagonal, grid};
use plisse::mesh::{Topology, Up, Vec2, Vec3};
use plisse::picture::{Camera, Paint, PanelView, Subject, draw, write_png};
use plisse::progress::Silent;
use plisse::relief::{Relief, Window, offsets_m, realised_growth};
use plisse::rest::RestMetric;

type Outcome<T> = Result<T, Box<dyn Error>>;

/// A clamped square of side 1 m.
struct Square {
    topology: Topology,
    rest: RestMetric,
    start: Vec<Vec3>,
}

impl Square {
    fn new(columns: usize, rows: usize) -> Outcome<Self> {
        let panel = grid("square", [1.0, 1.0], 1.0, [Some(columns), Some(rows)], Diagonal::Rising)?;
        let start: Vec<Vec3> = panel.positions.iter().map(|p| Vec3::new(p.x, p.y, 0.0)).collect();
        let topology = Topology::new(start.len(), panel.faces)?;
        let rest = RestMetric::from_shape(&start, &topology.faces)?;
        Ok(Self { topology, rest, start })
    }

    /// The square grown along x, with λ = 1/`folds` and Λ = `coherence`·λ.
    fn growing(&self, growth: f64, folds: f64, coherence: f64) -> Outcome<Growing<'_>> {
        let n = self.start.len();
        let expansion = Expansion::from_directions(
            &self.topology,
            &self.start,
            &vec![Vec3::x(); n],
            &vec![growth; n],
        )?;
        let mut growing = Growing::new(
            &self.topology,
            &self.rest,
            &self.start,
            expansion,
            1.0 / folds,
            coherence / folds,
        );
        let boundary = self.topology.boundary_vertices();
        growing.freeze(|v, _| boundary[v]);
        Ok(growing)
    }

    /// Count, width of the peak, share of straight crests, correlation length over λ, length
    /// reached.
    fn measure(&self, asked: &RestMetric, folds: f64, pose: &[Vec3]) -> Outcome<String> {
        let inset = 0.1;
        let window =
            Window { low: Vec2::new(inset, inset), high: Vec2::new(1.0 - inset, 1.0 - inset) };
        let chart: Vec<Vec2> = self.start.iter().map(|p| Vec2::new(p.x, p.y)).collect();
        let offset = offsets_m(&self.topology, &self.start, pose)?;
        let relief =
            Relief::new(&self.topology, &chart, &offset, &window, [(40.0 * folds) as usize, 81])?;
        let inner = |f: usize| {
            self.topology.faces[f]
                .iter()
                .all(|&v| (self.start[v] - Vec3::new(0.5, 0.5, 0.0)).amax() < 0.5 - inset)
        };
        let got =
            realised_growth(&self.topology, &self.start, asked, pose, |f| inner(f).then(Vec3::x));
        let crests = relief.crests_within(10_f64.to_radians(), 0.5 / folds);
        let (count, width) = relief.folds().map_or((0.0, 0.0), |f| (1.0 / f.wavelength_m, f.width));
        let run = relief.correlation_m().unwrap_or(0.0) * folds;
        Ok(format!(
            "{count:5.2} | {width:4.2} | {:3.0} % | {run:5.1} | {:.3}",
            100.0 * crests,
            got.length
        ))
    }
}

fn fold(
    square: &Square,
    growth: f64,
    folds: f64,
    coherence: f64,
    options: &GrowthOptions,
) -> Outcome<(String, Vec<Vec3>)> {
    let (pose, report) = grow(&square.growing(growth, folds, coherence)?, options, &Silent)?;
    let (last, iterations) = (
        report.steps.last().ok_or("no step")?,
        report.steps.iter().map(|s| s.iterations).sum::<usize>(),
    );
    let told = square.measure(&report.asked, folds, &pose)?;
    let n = square.start.len();
    Ok((
        format!("{n} | {told} | {:.0e} | {iterations} | {:.1}", last.residual, report.seconds),
        pose,
    ))
}

fn main() -> Outcome<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let options = GrowthOptions::default();
    let heading = "vertices | count | width | crests | run/λ | length | residual | iterations | s";
    match arguments.first().map(String::as_str) {
        Some("counts") => {
            println!("folds asked | growth | {heading}");
            for folds in [5.0, 10.0, 20.0] {
                let square = Square::new(8 * folds as usize, (2.0 * folds) as usize)?;
                for growth in [1.2, 1.5, 2.0] {
                    println!(
                        "{folds} | {growth} | {}",
                        fold(&square, growth, folds, 4.0, &options)?.0
                    );
                }
            }
        }
        Some("coherence") => {
            println!("growth | imperfection | Λ/λ | {heading}");
            for (growth, square) in [(1.1, Square::new(40, 30)?), (1.2, Square::new(48, 36)?)] {
                for imperfection in [0.05, 0.2] {
                    for coherence in [0.0, 1.0, 2.0, 4.0] {
                        let options = GrowthOptions { imperfection, ..options.clone() };
                        println!(
                            "{growth} | {imperfection} | {coherence} | {}",
                            fold(&square, growth, 8.0, coherence, &options)?.0
                        );
                    }
                }
            }
        }
        Some("modes") => {
            println!("mode | growth | {heading}");
            let square = Square::new(40, 20)?;
            for growth in [1.2, 1.5, 2.0] {
                println!(
                    "variational | {growth} | {}",
                    fold(&square, growth, 5.0, 4.0, &options)?.0
                );
                let (pose, report) = match grow_by_forces(
                    &square.growing(growth, 5.0, 4.0)?,
                    &ReferenceOptions::default(),
                    &Silent,
                ) {
                    Ok(grown) => grown,
                    Err(error) => {
                        println!("reference | {growth} | {error}");
                        continue;
                    }
                };
                let told = square.measure(&report.asked, 5.0, &pose)?;
                println!(
                    "reference | {growth} | {} | {told} | {:.0e} | {} | {:.1}",
                    pose.len(),
                    report.residual,
                    report.iterations,
                    report.seconds
                );
            }
        }
        Some("picture") => {
            let square = Square::new(70, 40)?;
            let settings = [(1.3, 10.0, 0.0), (1.3, 10.0, 4.0), (1.3, 5.0, 4.0), (2.0, 5.0, 4.0)];
            let titles = settings.map(|(growth, folds, coherence)| {
                format!("growth {growth}, {folds} folds, Λ = {coherence} λ")
            });
            let mut poses = Vec::new();
            for (growth, folds, coherence) in settings {
                let (told, pose) = fold(
                    &square,
                    growth,
                    folds,
                    coherence,
                    &GrowthOptions { imperfection: 0.05, ..options.clone() },
                )?;
                println!("{told}");
                poses.push(pose);
            }
            let panel = |n: usize| PanelView {
                title: &titles[n],
                subject: Subject { positions: &poses[n], faces: &square.topology.faces },
                paint: Paint::Plain { colour: [190, 150, 120], wireframe: false },
            };
            let image = draw(
                &[panel(0), panel(1), panel(2), panel(3)],
                &Camera::fit(&poses[3], Up::Z, 25.0, 40.0),
                (1600, 1200),
            );
            write_png(
                &image,
                &mut std::fs::File::create(arguments.get(1).ok_or("give a path for the picture")?)?,
            )?;
        }
        _ => return Err("say what to study: counts, coherence, modes or picture".into()),
    }
    Ok(())
}
