//! Folds of a square that grows along one side: their number, their coherence, and the two modes
//! side by side. The tables of docs/growth.md.

use plisse::growth::reference::{ReferenceOptions, grow_by_forces};
use plisse::growth::{Expansion, GrowingSurface, GrowthMaps, GrowthOptions, grow};
use plisse::mesh::grid::{Diagonal, grid};
use plisse::mesh::{Topology, Up, Vec2, Vec3};
use plisse::picture::{Camera, Paint, PanelView, Subject, draw, write_png};
use plisse::progress::Silent;
use plisse::relief::{Relief, Window, offsets_m, realised_growth};
use plisse::rest::RestMetric;
use plisse::{Error, Result};

use super::table::{Cell, Illustration, count, fixed, none, text};
use super::{Stop, Study};

/// Distance (m) from the sides within which nothing is measured.
const INSET_M: f64 = 0.1;
/// Angle (degrees) up to which crests count as straight.
const STRAIGHT_DEG: f64 = 10.0;
/// Points of the relief for each fold, and across the folds.
const POINTS: [usize; 2] = [40, 81];
/// Size of the picture (pixels).
const SIZE: (usize, usize) = (1600, 1200);
/// Colour of the surfaces in the picture (sRGB).
const COLOUR: [u8; 3] = [190, 150, 120];

/// Columns of every table, after those that name its rows.
const MEASURES: [&str; 9] = [
    "vertices",
    "folds",
    "width of the peak",
    "straight crests (%)",
    "coherence over λ",
    "length reached",
    "residual",
    "iterations",
    "seconds",
];

/// A square of side 1 m, clamped on all sides.
struct Square {
    topology: Topology,
    rest: RestMetric,
    start: Vec<Vec3>,
}

/// Growth of the square along x, with λ = 1 m/`folds` and Λ = `coherence`·λ.
#[derive(Clone, Copy)]
struct Setting {
    growth: f64,
    folds: f64,
    coherence: f64,
}

/// A folded square.
struct Folded {
    pose: Vec<Vec3>,
    asked: RestMetric,
    residual: f64,
    iterations: usize,
    seconds: f64,
}

impl Square {
    fn new(columns: usize, rows: usize) -> Result<Self> {
        let panel = grid([1.0, 1.0], 1.0, [Some(columns), Some(rows)], Diagonal::Rising)?;
        let start: Vec<Vec3> = panel.positions.iter().map(|p| Vec3::new(p.x, p.y, 0.0)).collect();
        let topology = Topology::new(start.len(), panel.faces)?;
        let rest = RestMetric::from_shape(&start, &topology.faces)?;
        Ok(Self { topology, rest, start })
    }

    fn surface(&self, setting: Setting) -> Result<GrowingSurface> {
        let n = self.start.len();
        let expansion = Expansion::from_directions(
            &self.topology,
            &self.start,
            &vec![Vec3::x(); n],
            &vec![setting.growth; n],
        )?;
        let maps =
            GrowthMaps::even(&expansion, 1.0 / setting.folds, setting.coherence / setting.folds);
        let mut surface =
            GrowingSurface::new(self.topology.clone(), self.rest.clone(), self.start.clone(), maps);
        let boundary = self.topology.boundary_vertices();
        surface.freeze(|v, _| boundary[v]);
        Ok(surface)
    }

    fn fold(&self, setting: Setting, options: &GrowthOptions) -> Result<Folded> {
        let (pose, report) = grow(&self.surface(setting)?, options, &Silent)?;
        Ok(Folded {
            pose,
            residual: report.steps.last().map_or(0.0, |step| step.residual),
            iterations: report.steps.iter().map(|step| step.iterations).sum(),
            seconds: report.seconds,
            asked: report.asked,
        })
    }

    fn fold_by_forces(&self, setting: Setting) -> Result<Folded> {
        let options = ReferenceOptions::default();
        let (pose, report) = grow_by_forces(&self.surface(setting)?, &options, &Silent)?;
        Ok(Folded {
            pose,
            residual: report.residual,
            iterations: report.iterations,
            seconds: report.seconds,
            asked: report.asked,
        })
    }

    /// A cell for each of [`MEASURES`].
    fn measures(&self, folds: f64, folded: &Folded) -> Result<Vec<Cell>> {
        let window = Window {
            low: Vec2::new(INSET_M, INSET_M),
            high: Vec2::new(1.0 - INSET_M, 1.0 - INSET_M),
        };
        let chart: Vec<Vec2> = self.start.iter().map(|p| Vec2::new(p.x, p.y)).collect();
        let offset = offsets_m(&self.topology, &self.start, &folded.pose)?;
        let points = [(POINTS[0] as f64 * folds) as usize, POINTS[1]];
        let relief = Relief::new(&self.topology, &chart, &offset, &window, points)?;
        let centre = Vec3::new(0.5, 0.5, 0.0);
        let inner = |f: usize| {
            let face = self.topology.faces[f];
            face.iter().all(|&v| (self.start[v] - centre).amax() < 0.5 - INSET_M)
        };
        let realised =
            realised_growth(&self.topology, &self.start, &folded.asked, &folded.pose, |f| {
                inner(f).then(Vec3::x)
            });
        let crests = relief.crests_within(STRAIGHT_DEG.to_radians(), 0.5 / folds);
        let (number, width) =
            relief.folds().map_or((0.0, 0.0), |found| (1.0 / found.wavelength_m, found.width));
        let coherence = relief.correlation_m().unwrap_or(0.0) * folds;
        Ok(vec![
            count(self.start.len()),
            fixed(number, 2),
            fixed(width, 2),
            fixed(100.0 * crests, 0),
            fixed(coherence, 1),
            fixed(realised.length, 3),
            text(format!("{:.0e}", folded.residual)),
            count(folded.iterations),
            fixed(folded.seconds, 1),
        ])
    }
}

/// Column names of a table whose rows are named by `first`.
fn columns(first: &[&'static str]) -> Vec<&'static str> {
    [first, &MEASURES[..]].concat()
}

pub(crate) fn run(study: &mut Study<'_>) -> std::result::Result<(), Stop> {
    numbers(study)?;
    coherence(study)?;
    modes(study)?;
    if study.quick { Ok(()) } else { picture(study) }
}

fn numbers(study: &mut Study<'_>) -> std::result::Result<(), Stop> {
    study.document.table(
        "Number of folds",
        "A square of side 1 m, all sides frozen, grown along x; measured 0.1 m and more inside. Λ \
         = 4λ, 8 cells to a wavelength.",
        &columns(&["folds asked", "growth"]),
    );
    for folds in if study.quick { vec![5.0] } else { vec![5.0, 10.0, 20.0] } {
        let square = Square::new(8 * folds as usize, (2.0 * folds) as usize)?;
        for growth in if study.quick { vec![1.2] } else { vec![1.2, 1.5, 2.0] } {
            study.check_interrupted()?;
            let setting = Setting { growth, folds, coherence: 4.0 };
            let folded = square.fold(setting, &GrowthOptions::default())?;
            let mut row = vec![fixed(folds, 0), fixed(growth, 1)];
            row.extend(square.measures(folds, &folded)?);
            study.document.row(row);
        }
    }
    Ok(())
}

fn coherence(study: &mut Study<'_>) -> std::result::Result<(), Stop> {
    study.document.table(
        "Coherence of crests",
        "The distance along crests within which half of their correlation is left, over λ, by Λ \
         and by the size of imperfections (in λ). Eight folds asked.",
        &columns(&["growth", "imperfection", "Λ/λ"]),
    );
    let folds = 8.0;
    let squares: &[(f64, [usize; 2])] =
        if study.quick { &[(1.1, [40, 30])] } else { &[(1.1, [40, 30]), (1.2, [48, 36])] };
    for &(growth, [columns, rows]) in squares {
        let square = Square::new(columns, rows)?;
        for imperfection in [0.05, 0.2] {
            for coherence in [0.0, 1.0, 2.0, 4.0] {
                study.check_interrupted()?;
                let options = GrowthOptions { imperfection, ..GrowthOptions::default() };
                let folded = square.fold(Setting { growth, folds, coherence }, &options)?;
                let mut row = vec![fixed(growth, 1), fixed(imperfection, 2), fixed(coherence, 0)];
                row.extend(square.measures(folds, &folded)?);
                study.document.row(row);
            }
        }
    }
    Ok(())
}

fn modes(study: &mut Study<'_>) -> std::result::Result<(), Stop> {
    study.document.table(
        "The two modes",
        "Five folds asked, Λ = 4λ. The variational mode minimises an energy; the reference mode \
         integrates the forces of Combaz & Neyret 2002, whose residuals have another unit.",
        &columns(&["mode", "growth"]),
    );
    let (square, folds) = (Square::new(40, 20)?, 5.0);
    for growth in if study.quick { vec![1.2] } else { vec![1.2, 1.5, 2.0] } {
        let setting = Setting { growth, folds, coherence: 4.0 };
        study.check_interrupted()?;
        let folded = square.fold(setting, &GrowthOptions::default())?;
        mode_row(study, "variational", growth, square.measures(folds, &folded)?);
        study.check_interrupted()?;
        let forces = square.fold_by_forces(setting);
        let cells = match forces {
            Ok(folded) => square.measures(folds, &folded)?,
            Err(error @ Error::Numeric { .. }) => {
                study.document.notes.push(format!("reference mode, growth {growth}: {error}"));
                MEASURES.map(|_| none()).into()
            }
            Err(error) => return Err(error.into()),
        };
        mode_row(study, "reference", growth, cells);
    }
    Ok(())
}

fn mode_row(study: &mut Study<'_>, mode: &str, growth: f64, measures: Vec<Cell>) {
    let mut row = vec![text(mode), fixed(growth, 1)];
    row.extend(measures);
    study.document.row(row);
}

fn picture(study: &mut Study<'_>) -> std::result::Result<(), Stop> {
    let square = Square::new(70, 40)?;
    let settings = [(1.3, 10.0, 0.0), (1.3, 10.0, 4.0), (1.3, 5.0, 4.0), (2.0, 5.0, 4.0)]
        .map(|(growth, folds, coherence)| Setting { growth, folds, coherence });
    let titles = settings.map(|Setting { growth, folds, coherence }| {
        format!("growth {growth}, {folds} folds, Λ = {coherence} λ")
    });
    let options = GrowthOptions { imperfection: 0.05, ..GrowthOptions::default() };
    let mut poses = Vec::new();
    for setting in settings {
        study.check_interrupted()?;
        poses.push(square.fold(setting, &options)?.pose);
    }
    let spinner = study.bars.spinner("picture");
    let panel = |n: usize| PanelView {
        title: &titles[n],
        subject: Subject { positions: &poses[n], faces: &square.topology.faces },
        paint: Paint::Plain { colour: COLOUR, wireframe: false },
    };
    let panels = [panel(0), panel(1), panel(2), panel(3)];
    let image = draw(&panels, &Camera::fit(&poses[3], Up::Z, 25.0, 40.0), SIZE);
    let file = "growth.png".to_owned();
    study.folder.write(&file, |out| write_png(&image, out))?;
    drop(spinner);
    let caption = "Folds of a square that grows along x".to_owned();
    study.document.pictures.push(Illustration { file, caption });
    Ok(())
}
