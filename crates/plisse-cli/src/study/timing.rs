//! Vertices, iterations and seconds of base, field and reference shell (tables 1 and 2 of [Chen
//! 2021]).

use std::path::Path;

use plisse::At;
use plisse::field::{FieldOptions, Solved, WrinkleFreeRule, solve};
use plisse::io::{clamp_file, obj};
use plisse::scene::{self, Scene, SolvedScene};
use plisse::{Material, RestShape, Sheet};

use super::solved::{Figures, Look, peak_mm, with_waves_at_half_height};
use super::table::{count, fixed, maybe, none, scientific, text};
use super::{Stop, Study, scenes};
use crate::report::shell_ending;

/// Iterations and seconds of a published solve.
struct PublishedSolve {
    iterations: u32,
    seconds: f64,
}

/// Seconds until the picture of a published solve stands still.
struct PublishedStable {
    field_seconds: f64,
    shell_seconds: f64,
}

/// Published figures of a scene's solves.
struct Published {
    scene: usize,
    /// Vertices of the field (table 2).
    vertices: &'static str,
    /// Base and field solve on 8 cores (table 2).
    base: Option<PublishedSolve>,
    field: Option<PublishedSolve>,
    /// Seconds of the published code's field solve on a 2-core machine.
    field_here_seconds: Option<f64>,
    /// Vertices of the reference shell that shows the same wrinkles (table 1).
    shell_vertices: Option<usize>,
    /// Stable times (table 1).
    stable: Option<PublishedStable>,
}

/// A published solve.
const fn solve_of(iterations: u32, seconds: f64) -> Option<PublishedSolve> {
    Some(PublishedSolve { iterations, seconds })
}

/// Published stable times.
const fn stable(field_seconds: f64, shell_seconds: f64) -> Option<PublishedStable> {
    Some(PublishedStable { field_seconds, shell_seconds })
}

impl Published {
    /// A scene of which nothing is known but the vertices of its field.
    const fn new(scene: usize, vertices: &'static str) -> Self {
        Self {
            scene,
            vertices,
            base: None,
            field: None,
            field_here_seconds: None,
            shell_vertices: None,
            stable: None,
        }
    }
}

/// Published figures of scenes 01 to 11.
const PUBLISHED: [Published; 11] = [
    Published {
        base: solve_of(12, 0.69),
        field: solve_of(813, 104.92),
        field_here_seconds: Some(73.7),
        shell_vertices: Some(96_000),
        stable: stable(50.94, 1528.68),
        ..Published::new(1, "688")
    },
    Published {
        base: solve_of(10, 0.45),
        field: solve_of(23, 3.93),
        shell_vertices: Some(260_000),
        stable: stable(2.57, 886.80),
        ..Published::new(2, "522")
    },
    Published {
        base: solve_of(21, 2.27),
        field: solve_of(147, 27.52),
        shell_vertices: Some(20_000),
        stable: stable(9.63, 673.11),
        ..Published::new(3, "1k")
    },
    Published { field: solve_of(46, 15.06), ..Published::new(4, "1.6k") },
    Published {
        field: solve_of(72, 29.74),
        field_here_seconds: Some(19.9),
        shell_vertices: Some(40_000),
        ..Published::new(5, "1.4k")
    },
    Published {
        field: solve_of(74, 141.74),
        shell_vertices: Some(60_000),
        ..Published::new(6, "4k")
    },
    Published {
        base: solve_of(11, 2.27),
        field: solve_of(125, 74.82),
        shell_vertices: Some(40_000),
        stable: stable(44.81, 57.29),
        ..Published::new(7, "2k")
    },
    Published {
        base: solve_of(33, 16.04),
        field: solve_of(91, 125.33),
        shell_vertices: Some(40_000),
        stable: stable(52.33, 76.52),
        ..Published::new(8, "5k")
    },
    Published {
        base: solve_of(8, 0.78),
        field: solve_of(46, 7.32),
        shell_vertices: Some(30_000),
        stable: stable(1.98, 148.37),
        ..Published::new(9, "936")
    },
    Published {
        base: solve_of(3, 0.93),
        field: solve_of(1001, 322.25),
        shell_vertices: Some(98_000),
        stable: stable(26.29, 251.91),
        ..Published::new(10, "2k")
    },
    Published::new(11, "–"),
];

/// Duration (s) below which a step is run again, so that other programs disturb its time less.
const SHORT: f64 = 2.0;
/// Runs of a short step, of which the median counts.
const RUNS: usize = 3;

pub(crate) fn run(study: &mut Study<'_>) -> Result<(), Stop> {
    base_and_field(study)?;
    shells(study)?;
    match study.data.clone() {
        Some(data) => published_data(study, &data),
        None => Ok(()),
    }
}

/// The scenes of this study.
fn each(study: &Study<'_>) -> Result<Vec<(&'static Published, Scene)>, Stop> {
    let mut list = Vec::new();
    for published in PUBLISHED.iter().filter(|published| {
        study.has_scene(published.scene) && (!study.quick || published.scene <= 3)
    }) {
        if let Some(scene) = scenes::numbered(published.scene)? {
            list.push((
                published,
                if published.scene == 1 { with_waves_at_half_height(scene) } else { scene },
            ));
        }
    }
    Ok(list)
}

fn base_and_field(study: &mut Study<'_>) -> Result<(), Stop> {
    study.document.table(
        "Base surface and field",
        "Seconds, medians where they are short. Published: Chen et al. 2021, table 2, 8 cores at \
         3.6 GHz, 1000 iterations at most; their code on a 2-core machine where that was measured \
         (on its own base surface of about the same size). Ratio: their field seconds, on 2 cores \
         where known, divided by ours.",
        &[
            "scene",
            "vertices",
            "published vertices",
            "base: iterations",
            "base: seconds",
            "published base: iterations",
            "published base: seconds",
            "field: iterations",
            "field: seconds",
            "published field: iterations",
            "published field: seconds (8 cores)",
            "their code (2 cores), field: seconds",
            "ratio",
        ],
    );
    for (published, scene) in each(study)? {
        let outcome =
            scene::build(&scene).map_err(Stop::from).and_then(|built| timed(study, built));
        let Some((solution, base_seconds, field_seconds)) = study.or_note(&scene.title, outcome)?
        else {
            continue;
        };
        let (base, field) = (published.base.as_ref(), published.field.as_ref());
        let theirs = published.field_here_seconds.or(field.map(|field| field.seconds));
        study.document.row([
            text(&scene.title),
            count(solution.vertices()),
            text(published.vertices),
            count(solution.base_report.iterations),
            fixed(base_seconds, 3),
            maybe(base, |base| count(base.iterations)),
            maybe(base, |base| fixed(base.seconds, 2)),
            count(solution.field_report.iterations),
            fixed(field_seconds, 3),
            maybe(field, |field| count(field.iterations)),
            maybe(field, |field| fixed(field.seconds, 2)),
            maybe(published.field_here_seconds, |seconds| fixed(seconds, 1)),
            maybe(theirs, |seconds| fixed(seconds / field_seconds, 0)),
        ]);
    }
    Ok(())
}

/// A scene solved, and the seconds of its base and field.
fn timed(study: &Study<'_>, built: scene::BuiltScene) -> Result<(SolvedScene, f64, f64), Stop> {
    let solution = study.solve(built)?;
    let (mut base, mut field) =
        (vec![solution.base_report.seconds], vec![solution.field_report.field_seconds]);
    while base[0] < SHORT && base.len() < RUNS {
        base.push(study.base(&solution.built)?.1.seconds);
    }
    while field[0] < SHORT && field.len() < RUNS {
        let again = study.solve_on(
            solution.built.clone(),
            solution.pose.clone(),
            solution.base_report.clone(),
        )?;
        field.push(again.field_report.field_seconds);
    }
    Ok((solution, median(base), median(field)))
}

fn shells(study: &mut Study<'_>) -> Result<(), Stop> {
    study.document.table(
        "Field against reference shell",
        "Equal quality means the vertices of table 1 of Chen et al. 2021, at which their shell \
         shows its wrinkles. Where that is beyond the limit of vertices, the shell is run at the \
         limit: its seconds, and the ratio, are lower bounds (>). Stable: from where the energy \
         stays within 0.1 % of the last one (that of loads included, so early under pressure). \
         Ratios: these, or all, seconds of the shell divided by all seconds of the field, both \
         from the base surface on; published ratio: stable times of table 1. Waves by the scene's \
         first measure in waves.",
        &[
            "scene",
            "field: vertices",
            "field: seconds",
            "field: waves",
            "shell: vertices",
            "published shell: vertices",
            "shell: iterations",
            "shell: ending",
            "shell: seconds",
            "shell: seconds until stable",
            "shell: waves",
            "ratio until stable",
            "ratio of all seconds",
            "published ratio",
        ],
    );
    for (published, scene) in each(study)? {
        let Some(equal) = published.shell_vertices else { continue };
        let limit = if study.quick { study.shell_limit.min(500) } else { study.shell_limit };
        let what = format!("{}, reference shell", scene.title);
        let outcome = one_shell(study, published, &scene, equal, limit);
        study.or_note(&what, outcome)?;
    }
    Ok(())
}

fn one_shell(
    study: &mut Study<'_>,
    published: &Published,
    scene: &Scene,
    equal: usize,
    limit: usize,
) -> Result<(), Stop> {
    let (solution, _, field_seconds) = timed(study, scene::build(scene)?)?;
    let (finer, built) = scene::with_vertices(scene, equal.min(limit))?;
    let (base, _) = study.base_of(&finer, &built)?;
    let (pose, report, stable_seconds) = study.shell(&built, &base)?;
    let in_waves = |measured: &[scene::Measured]| {
        measured.iter().find(|m| m.unit == "waves" && m.name != "waves around").map(|m| m.value)
    };
    let ratio = |seconds: f64| {
        let ratio = fixed(seconds / field_seconds, 0);
        if equal > limit { ratio.above() } else { ratio }
    };
    study.document.row([
        text(&scene.title),
        count(solution.vertices()),
        fixed(field_seconds, 3),
        maybe(in_waves(&solution.measures), |n| fixed(n, 1)),
        count(pose.len()),
        count(equal),
        count(report.iterations),
        text(shell_ending(&report)),
        fixed(report.seconds, 1),
        fixed(stable_seconds, 1),
        maybe(in_waves(&scene::measure_shell(&built, &base, &pose)), |n| fixed(n, 1)),
        ratio(stable_seconds),
        ratio(report.seconds),
        maybe(published.stable.as_ref(), |s| fixed(s.shell_seconds / s.field_seconds, 1)),
    ]);
    let looks = [
        Look::mesh("Base surface", &solution.built, &solution.pose),
        Look::wrinkled(
            &format!("Field, {} vertices", solution.vertices()),
            &solution.built,
            &solution.pose,
            &solution.field,
            true,
        ),
        Look::mesh("Mesh of the shell", &built, &base),
        Look::cloth(&format!("Shell, {} vertices", pose.len()), &built, &pose),
    ];
    let (name, caption) = (
        format!("timing-{:02}", published.scene),
        format!("{}: field and reference shell", scene.title),
    );
    study.picture(&name, &caption, &solution.built, &looks)
}

/// A published mesh and the figures that the published code finds on it.
struct PublishedMesh {
    folder: &'static str,
    clamp_file: Option<&'static str>,
    energy_joule: &'static str,
    amplitude_mm: &'static str,
    waves: &'static str,
    seconds: f64,
}

/// Published meshes; a dash where nothing was published.
const MESHES: [PublishedMesh; 3] = [
    PublishedMesh {
        folder: "tfw-disk",
        clamp_file: None,
        energy_joule: "1.973936e-2",
        amplitude_mm: "1.0544",
        waves: "85",
        seconds: 1.13,
    },
    PublishedMesh {
        folder: "tfw-disk",
        clamp_file: Some("clamped.dat"),
        energy_joule: "–",
        amplitude_mm: "–",
        waves: "–",
        seconds: 4.37,
    },
    PublishedMesh {
        folder: "cylinder-688",
        clamp_file: Some("clamp.dat"),
        energy_joule: "8.035660e-1",
        amplitude_mm: "14.623",
        waves: "47",
        seconds: 73.7,
    },
];

fn published_data(study: &mut Study<'_>, data: &Path) -> Result<(), Stop> {
    study.document.table(
        "On published data",
        "The same rest shape, pose and material as the published code, whose wrinkle-free faces \
         are found as it does; nothing but the field is solved. Published figures: what that code \
         finds, and its seconds, on a 2-core machine.",
        &[
            "mesh",
            "energy (J)",
            "published energy (J)",
            "largest amplitude (mm)",
            "published amplitude (mm)",
            "amplitudes differ by (%, root mean square)",
            "waves before rounding",
            "waves",
            "published waves",
            "iterations",
            "seconds",
            "published code (s)",
            "ratio",
        ],
    );
    let material = Material::new(1e7, 0.44, 1e-4)?;
    for mesh in MESHES {
        let (name, clamp) = (mesh.folder, mesh.clamp_file);
        let folder = data.join(name);
        let rest = obj::read(&folder.join("rest.obj"))?;
        let pose = obj::read_pose(&folder.join("pose.obj"), &rest)?;
        let rest_shape = RestShape { positions: rest.positions, faces: rest.faces };
        let sheet = Sheet::sewn(pose.faces, rest_shape, material).at(name)?;
        let mut held = vec![false; pose.positions.len()];
        if let Some(file) = clamp {
            for v in clamp_file::read_clamped_vertices(&folder.join(file), held.len())? {
                held[v] = true;
            }
        }
        let options = FieldOptions { rule: WrinkleFreeRule::Published, ..FieldOptions::default() };
        let mut runs: Vec<Solved> = Vec::new();
        for _ in 0..RUNS {
            runs.push(solve(&sheet, &pose.positions, &held, &options, study.bars)?);
            study.bars.finish();
            study.check_interrupted()?;
        }
        let ours = median(runs.iter().map(|run| run.report.field_seconds).collect());
        let (report, found) = (&runs[0].report, &runs[0].field);
        let around = report.periods.first().copied();
        let difference =
            if clamp.is_none() { amplitudes_differ(&folder, &found.amplitude_m) } else { None };
        study.document.row([
            text(format!("{name}{}", if clamp.is_some() { ", rim held" } else { "" })),
            scientific(report.energy_joule),
            text(mesh.energy_joule),
            fixed(peak_mm(found), 4),
            text(mesh.amplitude_mm),
            difference.map_or_else(none, |percent| fixed(percent, 3)),
            maybe(around, |p| fixed(p.before_rounding, 2)),
            maybe(around, |p| count(p.turns)),
            text(mesh.waves),
            count(report.iterations),
            fixed(ours, 4),
            fixed(mesh.seconds, 2),
            fixed(mesh.seconds / ours, 0),
        ]);
    }
    Ok(())
}

/// Root mean square difference (%) from the amplitudes in `amplitude.txt`, if there is one.
fn amplitudes_differ(folder: &Path, ours_m: &[f64]) -> Option<f64> {
    let text = std::fs::read_to_string(folder.join("amplitude.txt")).ok()?;
    let published: Vec<f64> =
        text.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    let difference: f64 = published.iter().zip(ours_m).map(|(a, b)| (a - b).powi(2)).sum();
    Some(100.0 * (difference / published.iter().map(|a| a * a).sum::<f64>()).sqrt())
}

fn median(mut list: Vec<f64>) -> f64 {
    list.sort_by(f64::total_cmp);
    list[list.len() / 2]
}
