//! `plisse shell`: a scene file to a shell whose mesh itself bears the wrinkles, for comparison
//! with `plisse solve`.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use plisse::io::staged::OutputFolder;
use plisse::io::{glb, obj};
use plisse::linalg::Ending;
use plisse::mesh::normals::vertex_normals;
use plisse::mesh::{Up, Vec3};
use plisse::picture::CLOTH;
use plisse::picture::{Paint, PanelView, Subject};
use plisse::scene::{BuiltScene, Measured, Scene};
use plisse::shell::{ReferenceOptions, ReferenceReport, solve_reference};
use plisse::{Error, Result, scene};
use serde::Serialize;

use crate::arguments::{ShellArguments, Start};
use crate::outputs::{self, BASE_SRGB, CLOTH_SRGB, draw_panels};
use crate::pipeline::{open_output_at, with_threads};
use crate::progress::Bars;
use crate::report::{BaseSummary, measured_row, shell_ending};
use crate::terminal::RunEnd;

/// Results of a run. Field names carry the units.
#[derive(Serialize)]
struct Report {
    plisse: &'static str,
    title: String,
    vertices: usize,
    faces: usize,
    iterations: usize,
    ending: &'static str,
    energy_joule: f64,
    gradient_newton: f64,
    /// Largest distance from the base surface along its normal.
    displacement_max_m: f64,
    base: Option<BaseSummary>,
    measures: Vec<Measured>,
    notes: Vec<String>,
    seconds: Seconds,
}

#[derive(Serialize)]
struct Seconds {
    base: f64,
    shell: f64,
    total: f64,
}

pub(crate) fn run(arguments: &ShellArguments, interrupted: &AtomicBool) -> Result<RunEnd> {
    let begun = Instant::now();
    let mut scene = scene::read(&arguments.scene)?;
    refine(&mut scene, arguments.finer)?;
    let built = scene::build(&scene)?;
    let folder = open_output_at(arguments.output.as_deref(), &arguments.scene)?;
    let bars = Bars::new(interrupted);
    with_threads(arguments.threads, || {
        let mut notes = built.notes.clone();
        let (start, base) = match arguments.start {
            Start::Base => {
                let (pose, base) = scene::solve_base(&scene, &built, &bars)?;
                notes.extend(scene::base_notes(&base));
                (pose, Some(base))
            }
            Start::Flat => (built.start.clone(), None),
        };
        bars.finish();
        let options = ReferenceOptions {
            iteration_limit: arguments.iterations as usize,
            imperfection_m: arguments.imperfection * built.sheet.material.thickness_m,
            ..ReferenceOptions::default()
        };
        let (pose, found) = solve_reference(&built.setup(), &start, &options, &bars)?;
        bars.finish();
        if interrupted.load(Ordering::SeqCst) {
            notes.push("interrupted: this is the best state so far, not a solution".to_owned());
        } else if found.ending == Ending::IterationLimit {
            notes.push(
                "the iteration limit came first; this is no equilibrium, give --iterations more"
                    .to_owned(),
            );
        } else if found.is_stuck() {
            notes.push(format!(
                "no step lowers the energy any more, but a gradient of {:.1e} N is left: a face \
                 may have lost its area, and this is no equilibrium; take another mesh, by --finer \
                 or the panel's seed",
                found.gradient_newton
            ));
        }
        let base_seconds = base.as_ref().map_or(0.0, |base| base.seconds);
        let report = Report {
            plisse: env!("CARGO_PKG_VERSION"),
            title: built.title.clone(),
            vertices: built.sheet.topology.vertex_count,
            faces: built.sheet.topology.face_count(),
            iterations: found.iterations,
            ending: shell_ending(&found),
            energy_joule: found.energy_joule,
            gradient_newton: found.gradient_newton,
            displacement_max_m: scene::heights_m(&built, &start, &pose)
                .into_iter()
                .fold(0.0, |most, d| d.abs().max(most)),
            base: base.as_ref().map(BaseSummary::from),
            measures: scene::measure_shell(&built, &start, &pose),
            notes,
            seconds: Seconds {
                base: base_seconds,
                shell: found.seconds,
                total: begun.elapsed().as_secs_f64(),
            },
        };
        let shell = Shell { built: &built, start: &start, pose: &pose, found: &found };
        write(&shell, report, arguments, folder, &bars)?;
        Ok(if interrupted.load(Ordering::SeqCst) { RunEnd::Interrupted } else { RunEnd::Complete })
    })
}

/// Divides the edge length of every panel.
fn refine(scene: &mut Scene, finer: f64) -> Result<()> {
    if !(finer > 0.0 && finer.is_finite()) {
        return Err(Error::value(
            "--finer",
            format!(
                "{finer} is no factor; give a number above 0, such as 2 for edges half as long"
            ),
        ));
    }
    if scene.mesh.is_some() && finer != 1.0 {
        return Err(Error::value(
            "--finer",
            "the scene has a mesh, not panels; refine the mesh itself and leave --finer out",
        ));
    }
    for panel in &mut scene.panel {
        panel.edge_length_m /= finer;
        panel.columns = panel.columns.map(|n| (n as f64 * finer).round() as usize);
        panel.rows = panel.rows.map(|n| (n as f64 * finer).round() as usize);
    }
    Ok(())
}

/// A solved shell.
struct Shell<'a> {
    built: &'a BuiltScene,
    start: &'a [Vec3],
    pose: &'a [Vec3],
    found: &'a ReferenceReport,
}

fn write(
    shell: &Shell<'_>,
    report: Report,
    arguments: &ShellArguments,
    mut folder: OutputFolder,
    bars: &Bars<'_>,
) -> Result<()> {
    let &Shell { built, start, pose, found } = shell;
    let spinner = bars.spinner("files");
    let faces = &built.sheet.topology.faces;
    let texture = built.texture();
    let texture = texture.as_ref();
    folder.write("base.obj", |out| obj::write(out, start, faces, texture))?;
    folder.write("shell.obj", |out| obj::write(out, pose, faces, texture))?;
    let normals = vertex_normals(&built.sheet.topology, pose);
    let mesh = glb::Mesh { positions: pose, normals: &normals, faces, texture };
    folder.write("shell.glb", |out| glb::write(out, &mesh, CLOTH, Up::Z))?;
    if arguments.no_picture {
        folder.remove_stale("picture.png");
    } else {
        let picture = picture(shell);
        folder.write("picture.png", |out| plisse::picture::write_png(&picture, out))?;
    }
    let mut table = format!("{}\n", report.title);
    let mut row = |name: &str, value: String| table += &format!("  {name:<24} {value}\n");
    row("mesh", format!("{} vertices, {} faces", report.vertices, report.faces));
    if let Some(base) = &report.base {
        row(
            "base",
            format!("{} iterations, {}, {:.6e} J", base.iterations, base.ending, base.energy_joule),
        );
    }
    row(
        "shell",
        format!(
            "{} iterations, {}, {:.6e} J",
            report.iterations, report.ending, report.energy_joule
        ),
    );
    row("gradient", format!("{:.1e} N", found.gradient_newton));
    row("displacement", format!("max {:.4e} m", report.displacement_max_m));
    for measured in &report.measures {
        row(&measured.name, measured_row(measured));
    }
    let s = &report.seconds;
    row("seconds", format!("base {:.3}, shell {:.3}, total {:.3}", s.base, s.shell, s.total));
    for note in &report.notes {
        table += &format!("  note: {note}\n");
    }
    outputs::finish(folder, &report, table)?;
    drop(spinner);
    Ok(())
}

/// Start, displacement, what compression is left, and the shell.
fn picture(shell: &Shell<'_>) -> plisse::picture::Image {
    let &Shell { built, start, pose, .. } = shell;
    let faces = &built.sheet.topology.faces;
    let heights = scene::heights_m(built, start, pose);
    let height: Vec<f64> = heights.iter().map(|d| 1e3 * d.abs()).collect();
    let pressed = built.sheet.compression_percent(pose);
    let most = |list: &[f64]| list.iter().copied().fold(0.0, f64::max);
    let subject = Subject { positions: pose, faces };
    let panels = [
        PanelView {
            title: "Start",
            subject: Subject { positions: start, faces },
            paint: Paint::Plain { colour: BASE_SRGB, wireframe: true },
        },
        PanelView {
            title: "Displacement from the start",
            subject,
            paint: Paint::Scalar { values: &height, maximum: most(&height), unit: "mm" },
        },
        PanelView {
            title: "Compression left",
            subject,
            paint: Paint::Scalar { values: &pressed, maximum: most(&pressed), unit: "%" },
        },
        PanelView {
            title: "Shell",
            subject,
            paint: Paint::Plain { colour: CLOTH_SRGB, wireframe: false },
        },
    ];
    draw_panels(&panels, pose, Up::Z, &built.obstacles)
}
