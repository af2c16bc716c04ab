//! Growth in the background, by the painted layers or a scene, step by step; every step is shown.

use std::sync::Arc;

use plisse::growth::expansion::GrowthTensor;
use plisse::growth::{
    Expansion, GrowingSurface, GrownSurface, GrowthAt, GrowthMaps, GrowthOptions, GrowthReport,
    LoadSteps, StepReport, follow_adapting, follow_each,
};
use plisse::mesh::{Mat2, Topology, Vec3};
use plisse::progress::Observer;
use plisse::rest::RestMetric;
use plisse::scene::growth::Mode;
use plisse::scene::{BuiltGrowth, build_growth};
use plisse::strain::strain;
use plisse::{At, Error, Result};
use plisse_live::Vec3 as Seen;
use plisse_live::field::Waves;

use super::job::Reporter;
use super::solve::{seen, solid};
use crate::document::subject::unshown;
use crate::document::{Document, Layer, Layers};
use crate::view::Solid;

/// Least painted share at which a vertex is frozen.
const FROZEN: f32 = 0.5;

/// A surface that is ready to grow, in a scene's axes (z up).
#[derive(Clone, Debug)]
pub enum Plan {
    /// It grows as its scene says.
    Scene(Box<BuiltGrowth>),
    /// It grows by the painted layers.
    Painted(Box<Painted>),
}

/// A surface with its painted growth maps.
#[derive(Clone, Debug)]
pub struct Painted {
    pub(super) surface: GrowingSurface,
    /// `[V]` true for vertices that are held whatever is painted.
    pub(super) held: Vec<bool>,
    pub(super) options: GrowthOptions,
}

/// The painted numbers of a vertex that growth uses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Numbers {
    /// As in [`Layer::Expansion`].
    expansion: [f32; 4],
    wavelength: f32,
    coherence: f32,
    freeze: f32,
}

impl Numbers {
    pub(super) fn of(layers: &Layers, v: usize) -> Self {
        let first = |layer| layers.of(layer)[v][0];
        Self {
            expansion: layers.of(Layer::Expansion)[v],
            wavelength: first(Layer::Wavelength),
            coherence: first(Layer::Coherence),
            freeze: first(Layer::Freeze),
        }
    }

    /// Growth along the painted direction, times growth in all directions; `frame` has growth 1.
    pub(super) fn growth(&self, frame: &GrowthTensor) -> GrowthTensor {
        let [x, y, z, all] = self.expansion;
        let (direction, normal) = (unshown(&Seen::new(x, y, z)), frame.along.cross(&frame.across));
        let (longer, all) = ((1.0 + direction.norm()).powi(2), (1.0 + f64::from(all)).powi(2));
        let flat = direction - normal * normal.dot(&direction);
        match flat.try_normalize(1e-6 * direction.norm()) {
            Some(along) if longer != 1.0 => GrowthTensor {
                along,
                across: normal.cross(&along),
                form: Mat2::new(longer * all, 0.0, 0.0, all),
            },
            _ => GrowthTensor { form: Mat2::identity() * all, ..*frame },
        }
    }

    pub(super) fn wavelength_m(&self, spacing_m: f64) -> f64 {
        f64::from(self.wavelength) * spacing_m
    }

    pub(super) fn coherence_m(&self, where_none_is_painted_m: f64) -> f64 {
        if self.coherence > 0.0 { f64::from(self.coherence) } else { where_none_is_painted_m }
    }

    pub(super) fn frozen(&self) -> bool {
        self.freeze >= FROZEN
    }

    /// Largest factor, up or down, by which a length changes from this to `to`.
    pub(super) fn growth_to(&self, to: &Self) -> f64 {
        let direction = |n: &Self| {
            Vec3::new(
                f64::from(n.expansion[0]),
                f64::from(n.expansion[1]),
                f64::from(n.expansion[2]),
            )
        };
        let along = |n: &Self| 1.0 + direction(n).norm();
        let all = |n: &Self| 1.0 + f64::from(n.expansion[3]);
        let parallel = direction(self).cross(&direction(to)).norm()
            <= 1e-3 * direction(self).norm() * direction(to).norm();
        let lengths = if parallel {
            along(self).max(along(to)) / along(self).min(along(to))
        } else {
            along(self).max(along(to))
        };
        lengths * all(self).max(all(to)) / all(self).min(all(to))
    }

    /// The numbers at this share of the way to `to`.
    pub(super) fn towards(&self, to: &Self, share: f64) -> Self {
        let mix = |a: f32, b: f32| if share >= 1.0 { b } else { a + (b - a) * share as f32 };
        Self {
            expansion: std::array::from_fn(|k| mix(self.expansion[k], to.expansion[k])),
            wavelength: mix(self.wavelength, to.wavelength),
            coherence: if share >= 1.0 { to.coherence } else { self.coherence },
            freeze: if share >= 1.0 { to.freeze } else { self.freeze },
        }
    }
}

impl Plan {
    fn surface(&self) -> GrowingSurface {
        match self {
            Self::Scene(built) => built.surface(),
            Self::Painted(sheet) => sheet.surface.clone(),
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
    /// `[V]` positions (m), z up.
    pub pose: Vec<Vec3>,
    /// Report of the growth.
    pub report: Arc<GrowthReport>,
}

/// A part of the result of growth.
#[derive(Clone)]
pub enum Part {
    /// A step, to show.
    Step(Arc<Solid>),
    /// The complete result.
    Whole(Arc<Solid>, Arc<Grown>),
}

/// The surface of `document`, to grow by its painted layers, or else as its scene says.
///
/// # Errors
/// [`Error::Value`] if there is neither; [`Error::Mesh`] for a mesh that cannot grow; as
/// [`build_growth`].
pub fn plan(document: &Document) -> Result<Plan> {
    let subject = &document.subject;
    let painted = document.layers.is_painted(Layer::Expansion);
    if let (Some(scene), false) = (&subject.scene, painted) {
        let built = build_growth(&scene.scene)?;
        if built.mode == Mode::Reference {
            let message = "the window folds by energy only; remove growth.mode, or run plisse grow \
                on the scene";
            return Err(Error::value("growth.mode", message));
        }
        return Ok(Plan::Scene(Box::new(built)));
    }
    if !painted {
        return Err(Error::value("grow", "there is nothing to grow; paint Expansion first"));
    }
    Ok(Plan::Painted(Box::new(self::painted(document)?)))
}

/// The surface of `document` with its painted growth maps.
///
/// # Errors
/// [`Error::Mesh`] for a mesh that cannot grow.
pub(super) fn painted(document: &Document) -> Result<Painted> {
    let subject = &document.subject;
    let (topology, rest, start, held) = match &subject.scene {
        Some(scene) => {
            let built = &scene.built;
            (
                built.sheet.topology.clone(),
                built.sheet.rest.clone(),
                built.start.clone(),
                built.clamps.held(),
            )
        }
        None => {
            let topology = plisse_live::field::topology(&subject.model.name, &subject.welded)?;
            let start: Vec<Vec3> = subject.welded.vertices.positions.iter().map(unshown).collect();
            let rest = RestMetric::from_shape(&start, &topology.faces).at(&subject.model.name)?;
            let count = start.len();
            (topology, rest, start, vec![false; count])
        }
    };
    let numbers: Vec<Numbers> =
        (0..start.len()).map(|v| Numbers::of(&document.layers, v)).collect();
    let frames = Expansion::none(&topology, &start)?;
    let settings = &document.settings;
    let (young_pa, poisson) = subject
        .scene
        .as_ref()
        .map_or((1e5, 0.0), |s| (s.scene.material.young_pa, s.scene.material.poisson));
    let at = |((n, frame), held): ((&Numbers, &GrowthTensor), &bool)| GrowthAt {
        coherence_m: n.coherence_m(settings.coherence_m),
        frozen: [n.frozen() || *held; 3],
        ..GrowthAt::new(n.growth(frame), n.wavelength_m(settings.fold_spacing_m))
    };
    let vertices = numbers.iter().zip(&frames.vertices).zip(&held).map(at).collect();
    let maps = GrowthMaps { vertices, bands: Vec::new() };
    Ok(Painted {
        surface: GrowingSurface::new(topology, rest, start, maps),
        held,
        options: GrowthOptions { young_pa, poisson, ..GrowthOptions::default() },
    })
}

/// Grows a surface, on a mesh that follows the folds if its scene asks for that.
///
/// # Errors
/// As [`follow_each`] and [`follow_adapting`].
pub fn run(plan: &Plan, reporter: &Reporter<Part>) -> Result<Part> {
    let surface = plan.surface();
    let (parts, adapt) = match plan {
        Plan::Scene(built) => (built.parts(None), built.adapt.as_ref()),
        Plan::Painted(sheet) => (sheet.options.parts(surface.maps.most_growth()), None),
    };
    let steps = LoadSteps { parts: &parts, options: plan.options() };
    reporter.stage("growth", Some(0.0));
    let mut done = 0;
    let mut show = |step: &StepReport, surface: &GrowingSurface, pose: &[Vec3]| {
        done += 1;
        let share = (done as f32 / parts.len().max(1) as f32).min(1.0);
        reporter.stage(&format!("growth, {:.0} % of it", 100.0 * step.part), Some(share));
        reporter.part(Part::Step(Arc::new(look(&surface.topology, &surface.rest, pose))));
        Ok(())
    };
    let (topology, pose, report) = match (plan, adapt) {
        (Plan::Scene(built), Some(adapt)) => {
            let start = GrownSurface::new(surface, built.chart());
            let mut each = |step: &StepReport, on: &GrownSurface| show(step, &on.surface, &on.pose);
            let (grown, report) = follow_adapting(start, &steps, adapt, reporter, &mut each)?;
            (grown.surface.topology, grown.pose, report.growth)
        }
        _ => {
            let mut each = |step: &StepReport, pose: &[Vec3]| show(step, &surface, pose);
            let observer: &dyn Observer = reporter;
            let (pose, report) =
                follow_each(&surface, &surface.start, &steps, observer, &mut each)?;
            (surface.topology, pose, report)
        }
    };
    let solid = look(&topology, &report.asked, &pose);
    let grown = Grown { topology, pose, report: Arc::new(report) };
    Ok(Part::Whole(Arc::new(solid), Arc::new(grown)))
}

/// The surface to show for a pose; strain is against the metric `asked`.
pub(super) fn look(topology: &Topology, asked: &RestMetric, pose: &[Vec3]) -> Solid {
    let posed = seen(pose, topology);
    let count = pose.len();
    let waves = Waves {
        amplitude_m: vec![0.0; count],
        wave: vec![Seen::zeros(); count],
        phase: vec![0.0; count],
    };
    let length = |e: f64| ((1.0 + e).max(0.0).sqrt() - 1.0) as f32;
    let ordered = |[a, b]: [f32; 2]| [a.min(b), a.max(b)];
    let strain =
        strain(topology, asked, pose).iter().map(|s| ordered(s.principal.map(length))).collect();
    Solid { strain, ..solid(topology, posed, &waves) }
}
