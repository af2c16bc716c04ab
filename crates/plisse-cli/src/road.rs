//! The road that both commands share: from a pose to files.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use plisse::field::{FieldOptions, FieldReport, Terms, WrinkleField, curvature, solve};
use plisse::io::aside::OutputFolder;
use plisse::linalg::newton::Ending;
use plisse::material::Material;
use plisse::mesh::{Topology, Vec2, Vec3};
use plisse::obstacle::Obstacle;
use plisse::rest::RestMetric;
use plisse::scene::{MOST_LEVELS, Measured};
use plisse::shell::BaseReport;
use plisse::surface::{Displacement, displace, keep_out, suggest_levels, upsample};
use plisse::{Error, Result};

use crate::Done;
use crate::arguments::{OutputArguments, Up};
use crate::outputs::{self, Texture};
use crate::progress::Bars;
use crate::report::{BaseSummary, Report, SurfaceSummary, ending_name};

/// Most faces of a wrinkled surface.
const FACE_LIMIT: usize = 20_000_000;

/// A pose that is to be wrinkled.
pub(crate) struct Posed<'a> {
    pub(crate) title: &'a str,
    /// What was published about it.
    pub(crate) paper: Option<&'a str>,
    pub(crate) topology: &'a Topology,
    pub(crate) rest: &'a RestMetric,
    /// Rest positions and corners.
    pub(crate) rest_shape: (&'a [Vec3], &'a [[usize; 3]]),
    /// Texture coordinates and corners, if there are any.
    pub(crate) texture: Option<(Vec<Vec2>, Vec<[usize; 3]>)>,
    pub(crate) pose: &'a [Vec3],
    pub(crate) held: &'a [bool],
    pub(crate) material: &'a Material,
    /// Bodies that the wrinkles stay out of, and how far (m).
    pub(crate) obstacles: (&'a [Obstacle], f64),
    pub(crate) field: FieldOptions,
    pub(crate) levels: Option<usize>,
    pub(crate) v1: bool,
    pub(crate) v2: bool,
    pub(crate) up: Up,
    pub(crate) base: Option<&'a BaseReport>,
    pub(crate) notes: Vec<String>,
}

/// The folder that results go to, proven writable before anything long begins.
pub(crate) fn open_output(arguments: &OutputArguments, input: &Path) -> Result<OutputFolder> {
    open_output_at(arguments.output.as_deref(), input)
}

/// As [`open_output`], for the folder asked for or one named after `input`.
pub(crate) fn open_output_at(output: Option<&Path>, input: &Path) -> Result<OutputFolder> {
    let stem = input.file_stem().map_or_else(|| "plisse".into(), |s| s.to_os_string());
    OutputFolder::create(&output.map_or_else(|| PathBuf::from("out").join(stem), Path::to_path_buf))
}

/// Runs `work` with as many threads as the user asked for.
pub(crate) fn with_threads<T: Send>(threads: Option<u32>, work: impl FnOnce() -> Result<T> + Send) -> Result<T> {
    let builder = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0) as usize);
    let pool = builder.build().map_err(|e| Error::value("threads", format!("the threads could not be started ({e}); ask for fewer")))?;
    pool.install(work)
}

/// Takes the terms named on the command line out of `field`.
pub(crate) fn leave_out(field: &mut FieldOptions, names: &[String]) -> Result<()> {
    for name in names {
        if name == "relaxed-integrability" {
            field.relaxed_integrability = false;
        } else {
            field.terms = field.terms.without(name).ok_or_else(|| {
                let known = Terms::NAMES.join(", ");
                Error::value("--without", format!("there is no term '{name}'; known are {known}, relaxed-integrability"))
            })?;
        }
    }
    Ok(())
}

/// How many times `topology` can be subdivided before it has too many faces.
fn most_levels(topology: &Topology) -> usize {
    let faces = |levels: usize| topology.face_count().saturating_mul(4_usize.pow(levels as u32));
    (1..=MOST_LEVELS).take_while(|&levels| faces(levels) <= FACE_LIMIT).last().unwrap_or(0)
}

/// Refuses `levels`, which `field` asked for, if they would make too many faces; before anything long begins.
pub(crate) fn check_levels(field: &str, levels: Option<usize>, topology: &Topology) -> Result<()> {
    let most = most_levels(topology);
    match levels {
        Some(levels) if levels > most => {
            let message =
                format!("{levels} levels would make more than {FACE_LIMIT} faces of {}; ask for {most} or fewer", topology.face_count());
            Err(Error::value(field, message))
        }
        _ => Ok(()),
    }
}

/// Field, phase, surface, picture, files, table.
pub(crate) fn finish(
    posed: Posed<'_>,
    arguments: &OutputArguments,
    mut folder: OutputFolder,
    bars: &Bars<'_>,
    interrupted: &AtomicBool,
    begun: Instant,
    measure: impl FnOnce(&WrinkleField, &FieldReport) -> Vec<Measured>,
) -> Result<Done> {
    let topology = posed.topology;
    let solved = solve(topology, posed.rest, posed.pose, posed.held, posed.material, &posed.field, bars)?;
    bars.finish();
    let (field, found) = (&solved.field, &solved.report);
    let mut report = Report::new(posed.title, topology, posed.rest, field, found);
    report.paper = posed.paper.map(str::to_owned);
    report.measures = measure(field, found);
    report.notes = posed.notes;
    if let Some(base) = posed.base {
        report.base = Some(BaseSummary::from(base));
        report.seconds.base = base.seconds;
    }

    let surface_begun = Instant::now();
    let spinner = bars.spinner("surface");
    let levels = match arguments.levels.map(|l| l as usize).or(posed.levels) {
        Some(levels) => levels,
        // Who interrupts does not want to wait for a fine surface.
        None if interrupted.load(Ordering::SeqCst) => 0,
        // A mesh may be so fine already that what the wavelength asks for would be too much.
        None => suggest_levels(topology, posed.rest, report.wavelength_m.as_ref().map(|w| w.median)).min(most_levels(topology)),
    };
    let mut fine = upsample(topology, posed.pose, field, posed.rest_shape.0, posed.rest_shape.1, levels);
    let forms = posed.v1.then(|| curvature::second_forms(topology, posed.pose, posed.field.curvature_rings));
    let how = Displacement { v2: posed.v2, v1: forms.as_deref().map(|forms| (forms, posed.material)) };
    let mut wrinkled = displace(&fine, &how);
    for positions in [&mut wrinkled, &mut fine.base] {
        keep_out(positions, posed.obstacles.0, posed.obstacles.1);
    }
    report.surface = SurfaceSummary { levels, vertices: fine.topology.vertex_count, faces: fine.topology.face_count() };
    let texture = posed.texture.map(|coarse| Texture::refined(coarse, levels));
    drop(spinner);

    if !arguments.no_picture {
        let spinner = bars.spinner("picture");
        let picture = outputs::picture(topology, posed.pose, &fine, &wrinkled, report.amplitude_m.max, posed.up, posed.obstacles.0);
        folder.write("picture.png", |out| plisse::picture::write_png(&picture, out))?;
        drop(spinner);
    } else {
        folder.leave_out("picture.png");
    }
    let spinner = bars.spinner("files");
    outputs::write_meshes(&mut folder, topology, posed.pose, &fine, &wrinkled, texture.as_ref(), posed.up)?;
    folder.write("field.json", |out| plisse::field::json::write(out, topology, field))?;
    let was_interrupted = interrupted.load(Ordering::SeqCst);
    if was_interrupted {
        let interrupted = ending_name(Ending::Cancelled);
        let cut_short = report.ending == interrupted || report.base.as_ref().is_some_and(|base| base.ending == interrupted);
        report.notes.push(match cut_short {
            true => "interrupted: this is the best state so far, not a solution".to_owned(),
            false => "interrupted after the solve had ended by itself; nothing is missing".to_owned(),
        });
    }
    report.seconds.surface = surface_begun.elapsed().as_secs_f64();
    report.seconds.total = begun.elapsed().as_secs_f64();
    let table = report.table();
    outputs::leave(folder, &report, table)?;
    drop(spinner);
    Ok(if was_interrupted { Done::Interrupted } else { Done::Whole })
}
