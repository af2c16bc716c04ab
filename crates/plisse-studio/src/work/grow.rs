//! Growth in the background: what was painted, or what a scene says, step by step, with every step shown.

use std::sync::Arc;

use plisse::growth::{Expansion, Growing, GrowthOptions, GrowthReport, StepReport, Surface, grow_adapting, grow_each};
use plisse::mesh::{Topology, Vec3};
use plisse::progress::Observer;
use plisse::rest::RestMetric;
use plisse::scene::growth::Mode;
use plisse::scene::{BuiltGrowth, build_growth};
use plisse::strain::strain;
use plisse::{Error, Result};
use plisse_live::Vec3 as Seen;
use plisse_live::field::Waves;

use super::job::Reporter;
use super::solve::{seen, solid};
use crate::document::subject::unshown;
use crate::document::{Document, Layer};
use crate::view::Solid;

/// From this share on a vertex counts as frozen.
const FROZEN: f32 = 0.5;

/// A surface made ready to grow; places are as in scenes, z up.
#[derive(Clone, Debug)]
pub enum Plan {
    /// By what its scene says.
    Scene(Box<BuiltGrowth>),
    /// By what is painted.
    Painted(Box<Painted>),
}

/// What is painted, as growth takes it.
#[derive(Clone, Debug)]
pub struct Painted {
    topology: Topology,
    rest: RestMetric,
    start: Vec<Vec3>,
    expansion: Expansion,
    wavelength_m: Vec<f64>,
    coherence_m: Vec<f64>,
    frozen: Vec<[bool; 3]>,
    options: GrowthOptions,
}

impl Plan {
    fn growing(&self) -> Growing<'_> {
        match self {
            Self::Scene(built) => built.growing(),
            Self::Painted(sheet) => Growing {
                wavelength_m: sheet.wavelength_m.clone(),
                coherence_m: sheet.coherence_m.clone(),
                frozen: sheet.frozen.clone(),
                ..Growing::new(&sheet.topology, &sheet.rest, &sheet.start, sheet.expansion.clone(), 1.0, 0.0)
            },
        }
    }

    fn options(&self) -> &GrowthOptions {
        match self {
            Self::Scene(built) => &built.options,
            Self::Painted(sheet) => &sheet.options,
        }
    }
}

/// A surface that has grown.
#[derive(Clone, Debug)]
pub struct Grown {
    /// Connectivity.
    pub topology: Topology,
    /// `[V]` places (m), z up.
    pub pose: Vec<Vec3>,
    /// How it grew.
    pub report: Arc<GrowthReport>,
}

/// What growth hands over.
#[derive(Clone)]
pub enum Part {
    /// A step, to look at.
    Step(Arc<Solid>),
    /// The end.
    Whole(Arc<Solid>, Arc<Grown>),
}

/// What `document` says shall grow: what is painted, else what its scene says.
///
/// # Errors
/// [`Error::Value`] if neither says anything; [`Error::Mesh`] for a mesh that cannot grow; as [`build_growth`].
pub fn plan(document: &Document) -> Result<Plan> {
    let subject = &document.subject;
    let painted = document.layers.is_painted(Layer::Expansion);
    if let (Some(scene), false) = (&subject.scene, painted) {
        let built = build_growth(&scene.scene)?;
        if built.mode == Mode::Reference {
            let message = "the window folds by energy only; remove growth.mode, or run plisse grow on the scene";
            return Err(Error::value("growth.mode", message));
        }
        return Ok(Plan::Scene(Box::new(built)));
    }
    if !painted {
        return Err(Error::value("grow", "nothing says what shall grow; paint Expansion first"));
    }
    let (topology, rest, start, held) = match &subject.scene {
        Some(scene) => {
            let built = &scene.built;
            (built.topology.clone(), built.rest.clone(), built.start.clone(), built.clamps.held())
        }
        None => {
            let topology = plisse_live::field::topology(&subject.model.name, &subject.unified)?;
            let start: Vec<Vec3> = subject.unified.vertices.positions.iter().map(unshown).collect();
            let rest = RestMetric::from_shape(&subject.model.name, &start, &topology.faces)?;
            let count = start.len();
            (topology, rest, start, vec![false; count])
        }
    };
    let layer = |l: Layer| document.layers.of(l);
    let vector = |x: &[f32; 4]| unshown(&Seen::new(x[0], x[1], x[2]));
    let directions: Vec<Vec3> = layer(Layer::Expansion).iter().map(vector).collect();
    let factors: Vec<f64> = directions.iter().map(|d| 1.0 + d.norm()).collect();
    let all: Vec<f64> = layer(Layer::Expansion).iter().map(|x| 1.0 + f64::from(x[3])).collect();
    let along = Expansion::from_directions(&topology, &start, &directions, &factors)?;
    let expansion = along.then(&Expansion::from_factors(&topology, &start, &all)?);
    let settings = &document.settings;
    let shares = layer(Layer::Wavelength).iter().map(|x| f64::from(x[0]));
    let coherence = |x: &[f32; 4]| if x[0] > 0.0 { f64::from(x[0]) } else { settings.coherence_m };
    let frozen = layer(Layer::Freeze).iter().zip(held).map(|(x, held)| [x[0] >= FROZEN || held; 3]).collect();
    let (young_pa, poisson) = subject.scene.as_ref().map_or((1e5, 0.0), |s| (s.scene.material.young_pa, s.scene.material.poisson));
    Ok(Plan::Painted(Box::new(Painted {
        expansion,
        wavelength_m: shares.map(|s| s * settings.fold_spacing_m).collect(),
        coherence_m: layer(Layer::Coherence).iter().map(coherence).collect(),
        frozen,
        options: GrowthOptions { young_pa, poisson, ..GrowthOptions::default() },
        topology,
        rest,
        start,
    })))
}

/// Grows it; on a mesh that follows the folds, if its scene says so.
///
/// # Errors
/// As [`grow_each`] and [`grow_adapting`].
pub fn run(plan: &Plan, reporter: &Reporter<Part>) -> Result<Part> {
    let growing = plan.growing();
    let (parts, adapt) = match plan {
        Plan::Scene(built) => (built.parts(None), built.adapt.as_ref()),
        Plan::Painted(sheet) => (sheet.options.parts(growing.most_growth()), None),
    };
    reporter.stage("growth", Some(0.0));
    let mut done = 0;
    let mut show = |step: &StepReport, topology: &Topology, rest: &RestMetric, pose: &[Vec3]| {
        done += 1;
        let share = (done as f32 / parts.len().max(1) as f32).min(1.0);
        reporter.stage(&format!("growth, {:.0} % of it", 100.0 * step.part), Some(share));
        reporter.part(Part::Step(Arc::new(look(topology, rest, pose))));
        Ok(())
    };
    let (topology, pose, report) = match (plan, adapt) {
        (Plan::Scene(built), Some(adapt)) => {
            let mut each = |step: &StepReport, on: &Surface<'_>| show(step, &on.topology, &on.rest, &on.pose);
            let (surface, report) = grow_adapting(&growing, built.chart(), &parts, &built.options, adapt, reporter, &mut each)?;
            (surface.topology, surface.pose, report.growth)
        }
        _ => {
            let mut each = |step: &StepReport, pose: &[Vec3]| show(step, growing.topology, growing.rest, pose);
            let (pose, report) = grow_each(&growing, &parts, growing.start, plan.options(), reporter as &dyn Observer, &mut each)?;
            (growing.topology.clone(), pose, report)
        }
    };
    let solid = look(&topology, &report.asked, &pose);
    let grown = Grown { topology, pose, report: Arc::new(report) };
    Ok(Part::Whole(Arc::new(solid), Arc::new(grown)))
}

/// What is seen of a pose; `asked` is the metric that strain is against.
fn look(topology: &Topology, asked: &RestMetric, pose: &[Vec3]) -> Solid {
    let posed = seen(pose, topology);
    let count = pose.len();
    let waves = Waves { amplitude_m: vec![0.0; count], wave: vec![Seen::zeros(); count], phase: vec![0.0; count] };
    let length = |e: f64| ((1.0 + e).max(0.0).sqrt() - 1.0) as f32;
    let ordered = |[a, b]: [f32; 2]| [a.min(b), a.max(b)];
    let strain = strain(topology, asked, pose).iter().map(|s| ordered(s.principal.map(length))).collect();
    Solid { strain, ..solid(topology, posed, &waves) }
}
