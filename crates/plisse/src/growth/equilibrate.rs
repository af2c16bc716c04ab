//! One load step of growth: the film of a surface, or of a part of one, brought to equilibrium.

use super::expansion::Expansion;
use super::film::{CrestTension, Film, Foundation};
use super::fold_angle::softening;
use super::imperfection::band_limited;
use super::load_stepping::{GrowthOptions, StepReport};
use super::loose;
use super::maps::GrowthAt;
use super::rigid_bands::{RigidBands, affine_bodies};
use super::surface::GrowingSurface;
use crate::linalg::newton::{Options, Outcome, minimise};
use crate::material::Material;
use crate::mesh::normals::try_vertex_normals;
use crate::mesh::{Mat2, RestShape, Vec2, Vec3};
use crate::progress::Observer;
use crate::rest::RestMetric;
use crate::self_contact::SelfContact;
use crate::sheet::Sheet;
use crate::shell::{Clamps, Setup};
use crate::strain::principal_pair;
use crate::{At, Error, Result};

/// Growth (logarithm) at which imperfections have their full size.
const FULL_IMPERFECTION: f64 = 0.02;
/// Longest move of a vertex in one iteration, in edges, where folds may meet.
const LONGEST_MOVE: f64 = 2.0;

/// Stopping criteria of a load step.
#[derive(Clone, Copy, Debug)]
pub(super) struct StopCriteria {
    /// Newton iterations at most.
    pub(super) iteration_limit: usize,
    /// Largest force left on a vertex, in units of the force that starts folds on an edge.
    pub(super) tolerance: f64,
}

impl StopCriteria {
    /// The criteria of `options`: equilibrium.
    pub(super) fn full(options: &GrowthOptions) -> Self {
        Self { iteration_limit: options.iteration_limit, tolerance: options.tolerance }
    }

    /// Criteria of a step that others follow: `factor` times the tolerance, and at most so many
    /// iterations.
    pub(super) fn loosened(options: &GrowthOptions, factor: f64, iteration_limit: usize) -> Self {
        Self {
            iteration_limit: options.iteration_limit.min(iteration_limit),
            tolerance: factor * options.tolerance,
        }
    }
}

/// `[V]` starting area (m²) and `[V]` imperfections of size 1 (no unit) of a surface with the
/// starting metric `metric`.
pub(super) fn areas_and_imperfections(
    surface: &GrowingSurface,
    metric: &RestMetric,
    seed: u64,
) -> Result<(Vec<f64>, Vec<f64>)> {
    let mut area_m2 = vec![0.0; surface.start.len()];
    for (face, rest) in surface.topology.faces.iter().zip(&metric.faces) {
        face.iter().for_each(|&v| area_m2[v] += rest.area_m2 / 3.0);
    }
    let rough = band_limited(surface, metric, &area_m2, seed)?;
    Ok((area_m2, rough))
}

/// Data of a part of a larger surface that is solved alone.
pub(super) struct Subdomain<'a> {
    /// `[V]` true for vertices that stay at their pose.
    pub(super) fixed: &'a [bool],
    /// `[V]` the pose (m); frozen axes stay there, too.
    pub(super) pose: &'a [Vec3],
    /// `[V]` normals of the starting surface.
    pub(super) normals: &'a [Vec3],
    /// `[V]` starting area (m²), also of faces that are not in the part.
    pub(super) area_m2: &'a [f64],
    /// `[V]` imperfections, of size 1 (no unit).
    pub(super) rough: &'a [f64],
    /// Length scales of the whole surface.
    pub(super) scale: LengthScales,
}

/// Lengths of a whole surface by which its parts are measured.
#[derive(Clone, Copy, Debug)]
pub(super) struct LengthScales {
    /// Mean of λ (m) over vertices.
    pub(super) wavelength_m: f64,
    /// Mean length (m) of the edges of the starting surface.
    pub(super) edge_m: f64,
}

impl LengthScales {
    pub(super) fn new(surface: &GrowingSurface) -> Self {
        let sum = surface.maps.vertices.iter().map(|at| at.wavelength_m).sum::<f64>();
        Self { wavelength_m: sum / surface.start.len() as f64, edge_m: surface.mean_edge_m() }
    }
}

/// One load step.
pub(super) struct LoadStep<'a> {
    /// Part of the growth (0 to 1).
    pub(super) part: f64,
    /// Stopping criteria.
    pub(super) criteria: StopCriteria,
    /// That part of the expansion.
    pub(super) expansion: &'a Expansion,
    /// `[F]` the rest metric grown by it.
    pub(super) grown: &'a RestMetric,
}

/// The film of a surface, with everything that stays the same from load step to load step.
pub(super) struct FilmModel<'a> {
    surface: &'a GrowingSurface,
    options: &'a GrowthOptions,
    normals: Vec<Vec3>,
    clamps: Clamps,
    /// Material of a film of mean λ's thickness.
    material: Material,
    /// `[F]` thickness in units of the material's.
    thickness: Vec<f64>,
    /// `[V]` starting area (m²).
    area_m2: Vec<f64>,
    /// `[F]` slope of the offset along the crests by the offsets of its corners (1/m), times
    /// √(2·area/q²)·Λ/λ; 0 where nothing grows one way more than the other.
    crests: Vec<CrestTension>,
    /// `[V]` imperfections of size 1 and mean about 0 (no unit).
    rough: Vec<f64>,
    scale: LengthScales,
}

impl<'a> FilmModel<'a> {
    pub(super) fn new(
        surface: &'a GrowingSurface,
        options: &'a GrowthOptions,
        within: Option<&Subdomain<'_>>,
    ) -> Result<Self> {
        let (topology, start) = (&surface.topology, &surface.start);
        let scale = within.map_or_else(|| LengthScales::new(surface), |within| within.scale);
        let (at, mean) = (&surface.maps.vertices, scale.wavelength_m);
        let material =
            Material::new(options.young_pa, options.poisson, options.thickness_share * mean)?;
        let thickness_of = |face: &[usize; 3]| {
            face.iter().map(|&v| at[v].wavelength_m).sum::<f64>() / (3.0 * mean)
        };
        let mut clamps = Clamps::none(start.len());
        for (v, at) in at.iter().enumerate() {
            let (fixed, place) =
                within.map_or((false, &start[v]), |within| (within.fixed[v], &within.pose[v]));
            clamps.targets[v] =
                std::array::from_fn(|axis| (fixed || at.frozen[axis]).then_some(place[axis]));
        }
        let metric = RestMetric::from_shape(start, &topology.faces).at("growth")?;
        let (area_m2, rough) = match within {
            Some(within) => (within.area_m2.to_vec(), within.rough.to_vec()),
            None => areas_and_imperfections(surface, &metric, options.seed)?,
        };
        let normals = match within {
            Some(within) => within.normals.to_vec(),
            None => try_vertex_normals(topology, start).at("growth")?,
        };
        Ok(Self {
            surface,
            options,
            normals,
            clamps,
            material,
            thickness: topology.faces.iter().map(thickness_of).collect(),
            area_m2,
            crests: (0..topology.face_count())
                .map(|f| crest_tension(surface, &metric, f))
                .collect(),
            rough,
            scale,
        })
    }

    /// Equilibrium under one part (0 to 1) of the growth, from `pose` (`[V]`, m) on.
    ///
    /// # Errors
    /// As [`super::grow`], but nothing is checked beforehand.
    pub(super) fn equilibrate_part(
        &self,
        part: f64,
        criteria: StopCriteria,
        pose: &mut [Vec3],
        observer: &dyn Observer,
    ) -> Result<StepReport> {
        let expansion = self.surface.maps.expansion().part(part);
        let grown = self.surface.grown_by(&expansion)?;
        let step = LoadStep { part, criteria, expansion: &expansion, grown: &grown };
        self.equilibrate(&step, pose, observer)
    }

    /// Equilibrium of one load step, from `pose` (`[V]`, m) on.
    pub(super) fn equilibrate(
        &self,
        step: &LoadStep<'_>,
        pose: &mut [Vec3],
        observer: &dyn Observer,
    ) -> Result<StepReport> {
        let most: Vec<f64> =
            step.expansion.vertices.iter().map(|growth| growth.principal().0[0]).collect();
        let stiffness: Vec<f64> = (0..most.len()).map(|v| self.stiffness(v, most[v])).collect();
        let foundation: Vec<Foundation> =
            (0..most.len()).map(|v| self.foundation(v, most[v], stiffness[v])).collect();
        let sheet = self.sheet(step.grown);
        let setup = self.setup(&sheet, &foundation, &most);
        let crests = self.crests(&stiffness);
        let film = Film::new(&setup, &self.surface.start, &self.thickness, &foundation, &crests)?
            .with_self_contact(self.self_contact(&foundation));
        let force = self.options.onset() * self.scale.edge_m / film.length_m();
        let (unit_joule, length_m) = (film.unit_joule(), film.length_m());
        let newton = Options {
            iteration_limit: step.criteria.iteration_limit,
            tolerance: step.criteria.tolerance * force,
            stay_in_basin: true,
            ..Options::new("grow", unit_joule)
        };
        let outcome = self.minimise(film, &newton, pose, observer)?;
        if !outcome.energy.is_finite() {
            return Err(Error::numeric(
                "grow",
                "the energy is not a finite number; check the expansion and the loads",
            ));
        }
        Ok(StepReport {
            part: step.part,
            iterations: outcome.iterations,
            ending: outcome.ending,
            residual: outcome.projected_gradient / force,
            residual_newton: outcome.projected_gradient * unit_joule / length_m,
            energy_joule: outcome.energy * unit_joule,
        })
    }

    /// Minimises the energy of `film` from `pose` (`[V]`, m) on; bands move as rigid bodies.
    fn minimise(
        &self,
        mut film: Film<'_>,
        newton: &Options,
        pose: &mut [Vec3],
        observer: &dyn Observer,
    ) -> Result<Outcome> {
        let (start, bands) = (&self.surface.start, &self.surface.maps.bands);
        let begin = film.pack(pose);
        if bands.is_empty() {
            let outcome = minimise(&mut film, &begin, newton, observer)?;
            film.unpack(&outcome.x, pose);
            return Ok(outcome);
        }
        let (unknown, length_m) = (film.unknowns().to_vec(), film.length_m());
        let bodies = affine_bodies(bands, start, &self.area_m2, length_m);
        let mut banded = RigidBands::new(film, bodies, &unknown, start, length_m);
        let begin = banded.pack(&begin, start, pose);
        let outcome = minimise(&mut banded, &begin, newton, observer)?;
        banded.inner().unpack(&banded.unpack(&outcome.x), pose);
        banded.straighten(start, pose);
        Ok(outcome)
    }

    /// Values of the maps at vertex `v`.
    fn at(&self, v: usize) -> &GrowthAt {
        &self.surface.maps.vertices[v]
    }

    /// k (N/m³) at vertex `v`, grown by the factor `growth`.
    fn stiffness(&self, v: usize, growth: f64) -> f64 {
        let (wavelength, poisson) = (self.at(v).wavelength_m, self.options.poisson);
        let thickness = self.options.thickness_share * wavelength;
        let bending =
            self.options.young_pa * thickness.powi(3) / (12.0 * (1.0 - poisson * poisson));
        loose::share(self.at(v).hold) * bending * (std::f64::consts::TAU / wavelength).powi(4)
            / softening(growth)
    }

    /// Share (0 to 1) of the imperfection at a vertex grown by the factor `growth`: one that does
    /// not grow is pushed nowhere.
    fn imperfection_share(growth: f64) -> f64 {
        (growth.ln().max(0.0) / FULL_IMPERFECTION).min(1.0)
    }

    /// Foundation at vertex `v`, grown by the factor `growth`, of the stiffness k (N/m³).
    fn foundation(&self, v: usize, growth: f64, stiffness: f64) -> Foundation {
        let (at, stiffness) = (self.at(v), stiffness * self.area_m2[v]);
        Foundation {
            normal: self.normals[v],
            stiffness,
            grip: self.options.grip * stiffness,
            offset_m: Self::imperfection_share(growth)
                * at.wavelength_m
                * (at.bias + self.options.imperfection * self.rough[v]),
            stickiness: at.stickiness,
        }
    }

    /// `[F]` crest tension on a foundation of the stiffness k (`[V]`, N/m³).
    fn crests(&self, stiffness: &[f64]) -> Vec<CrestTension> {
        let of_face = |(face, crest): (&[usize; 3], &CrestTension)| {
            let mean = face.iter().map(|&v| stiffness[v]).sum::<f64>() / 3.0;
            crest.map(|c| c * mean.sqrt())
        };
        self.surface.topology.faces.iter().zip(&self.crests).map(of_face).collect()
    }

    /// The film with the rest metric `grown`.
    fn sheet(&self, grown: &RestMetric) -> Sheet {
        let (topology, start) = (self.surface.topology.clone(), self.surface.start.clone());
        let rest_shape = RestShape { positions: start, faces: topology.faces.clone() };
        Sheet { topology, rest_shape, rest: grown.clone(), material: self.material }
    }

    /// The grown film and what acts on it; `growth` (`[V]`) are the largest factors of length.
    fn setup<'s>(
        &'s self,
        sheet: &'s Sheet,
        foundation: &[Foundation],
        growth: &[f64],
    ) -> Setup<'s> {
        let pressure = |(held, at): (&Foundation, &GrowthAt)| held.stiffness * at.wavelength_m;
        let at = &self.surface.maps.vertices;
        let mut setup = Setup {
            loads: self.surface.loads.clone(),
            obstacles: &self.surface.obstacles,
            contact_thickness_m: self.surface.contact_thickness_m,
            contact_pressure_pa: foundation.iter().zip(at).map(pressure).sum::<f64>()
                / self.area_m2.iter().sum::<f64>(),
            ..Setup::new(sheet, &self.clamps)
        };
        let rest_offset_m: Vec<Vec3> = (0..growth.len())
            .map(|v| {
                let offset_m = Self::imperfection_share(growth[v])
                    * at[v].wavelength_m
                    * self.options.imperfection
                    * self.rough[v];
                self.normals[v] * (loose::missing(at[v].hold) * offset_m)
            })
            .collect();
        let forces = loose::forces_newton(&setup, &self.thickness, &rest_offset_m);
        setup.loads.forces_newton.extend(forces);
        setup
    }

    /// The contact of the surface with itself, about as stiff as the foundation under a fold.
    fn self_contact(&self, foundation: &[Foundation]) -> Option<SelfContact<'a>> {
        let surface = self.surface;
        let strength: Vec<f64> = foundation
            .iter()
            .zip(&surface.maps.vertices)
            .map(|(held, at)| held.stiffness * at.wavelength_m)
            .collect();
        // Not much more than an edge can tell apart.
        let reach = self.material.thickness_m.min(0.5 * self.scale.edge_m);
        let longest_m = LONGEST_MOVE * self.scale.edge_m;
        surface.self_contact.then(|| {
            SelfContact::new(&surface.topology, &surface.start, reach, longest_m, &strength)
        })
    }
}

/// The crest tension of face `f` over √k: T = 2k/q²·(Λ/λ)² against slopes along the direction that
/// grows least.
fn crest_tension(surface: &GrowingSurface, metric: &RestMetric, f: usize) -> CrestTension {
    let face = surface.topology.faces[f];
    let [a, b, c] = face.map(|v| surface.start[v]);
    // A face's frame: the first vector along side 0→1, as in its metric.
    let first = (b - a).normalize();
    let second = (b - a).cross(&(c - a)).normalize().cross(&first);
    // The directions are lines: their dyads are averaged, weighted by how much more grows one way
    // than the other.
    let (mut dyads, mut ratio) = (Mat2::zeros(), 0.0);
    for v in face {
        let at = &surface.maps.vertices[v];
        let ([most, least], [_, along]) = at.growth.principal();
        let uneven = if most > 1.0 { 1.0 - least.ln().max(0.0) / most.ln() } else { 0.0 };
        let along = Vec2::new(first.dot(&along), second.dot(&along));
        dyads += along * along.transpose() * uneven;
        ratio += uneven / 3.0 * at.coherence_m / at.wavelength_m;
    }
    if ratio == 0.0 {
        return [0.0; 3];
    }
    let (_, low) = principal_pair(&dyads);
    let crest = Vec2::new(-low.y, low.x);
    let wavelength = surface.face_wavelength_m(&face);
    let scale = (2.0 * metric.faces[f].area_m2).sqrt() * wavelength / std::f64::consts::TAU * ratio;
    metric.faces[f].barycentric_gradients().map(|g| scale * g.dot(&crest))
}
