//! One step of growth: the film of a surface, or of a part of one, brought to rest.

use super::expansion::Expansion;
use super::film::{CrestTension, Film, Foundation};
use super::fold_angle::softening;
use super::imperfection::band_limited;
use super::load_stepping::{GrowthOptions, StepReport};
use super::loose;
use super::rigid_bands::Banded;
use super::surface::Growing;
use crate::linalg::newton::{Options, minimise};
use crate::material::Material;
use crate::mesh::Vec3;
use crate::mesh::normals::try_vertex_normals;
use crate::progress::Observer;
use crate::rest::RestMetric;
use crate::self_contact::SelfContact;
use crate::shell::{Clamps, Setup};
use crate::{At, Error, Result};

/// Growth (logarithm) at which imperfections have their full size.
const FULL_IMPERFECTION: f64 = 0.02;
/// Longest move of a vertex in one iteration, in edges, where folds may meet.
const LONGEST_MOVE: f64 = 2.0;

/// Solves one part (0 to 1) of the growth of `growing`, from `pose` (`[V]`, m) on; with `within`,
/// only what is not still there.
///
/// # Errors
/// As [`super::grow`], but nothing is checked beforehand.
pub(super) fn settle_part(
    growing: &Growing<'_>,
    part: f64,
    effort: Effort,
    options: &GrowthOptions,
    within: Option<&Within<'_>>,
    pose: &mut [Vec3],
    observer: &dyn Observer,
) -> Result<StepReport> {
    let expansion = growing.maps.expansion.part(part);
    let grown = expansion.act_on(growing.topology, growing.start, growing.rest)?;
    Prepared::new(growing, options, within)?
        .settle(part, effort, &expansion, &grown, pose, observer)
}

/// How long a step goes on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Effort {
    /// Newton iterations at most.
    pub(super) iteration_limit: usize,
    /// Largest force left on a vertex, in units of the force that starts folds on an edge.
    pub(super) tolerance: f64,
}

impl Effort {
    /// Until all is at rest.
    pub(super) fn exact(options: &GrowthOptions) -> Self {
        Self { iteration_limit: options.iteration_limit, tolerance: options.tolerance }
    }

    /// Until what is left is `loose` times what may be at the end, or this many iterations were
    /// made.
    pub(super) fn of(options: &GrowthOptions, (loose, most_iterations): (f64, usize)) -> Self {
        Self {
            iteration_limit: options.iteration_limit.min(most_iterations),
            tolerance: loose * options.tolerance,
        }
    }
}

/// `[V]` starting area (m²) and `[V]` imperfections of size 1 (no unit) of a surface with the
/// starting metric `surface`.
pub(super) fn areas_and_imperfections(
    growing: &Growing<'_>,
    surface: &RestMetric,
    seed: u64,
) -> Result<(Vec<f64>, Vec<f64>)> {
    let mut area_m2 = vec![0.0; growing.start.len()];
    for (face, rest) in growing.topology.faces.iter().zip(&surface.faces) {
        face.iter().for_each(|&v| area_m2[v] += rest.area_m2 / 3.0);
    }
    let rough = band_limited(growing, surface, &area_m2, seed)?;
    Ok((area_m2, rough))
}

/// A part of a larger surface, which is solved alone.
pub(super) struct Within<'a> {
    /// `[V]` whether each vertex stays at its pose.
    pub(super) still: &'a [bool],
    /// `[V]` the pose (m); frozen axes stay there, too.
    pub(super) pose: &'a [Vec3],
    /// `[V]` normals of the starting surface.
    pub(super) normals: &'a [Vec3],
    /// `[V]` starting area (m²), also of faces that are not in the part.
    pub(super) area_m2: &'a [f64],
    /// `[V]` imperfections, of size 1 (no unit).
    pub(super) rough: &'a [f64],
    /// Scale of the whole surface.
    pub(super) scale: Scale,
}

/// Lengths of a whole surface by which its parts are measured.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    /// Mean of λ (m) over vertices.
    pub(super) wavelength_m: f64,
    /// Mean length (m) of the edges of the starting surface.
    pub(super) edge_m: f64,
}

impl Scale {
    pub(super) fn of(growing: &Growing<'_>) -> Self {
        Self {
            wavelength_m: growing.maps.wavelength_m.iter().sum::<f64>()
                / growing.start.len() as f64,
            edge_m: growing.mean_edge_m(),
        }
    }
}

/// What does not change from step to step.
pub(super) struct Prepared<'a, 'b> {
    growing: &'b Growing<'a>,
    options: &'b GrowthOptions,
    normals: Vec<Vec3>,
    clamps: Clamps,
    /// A film of mean λ's thickness.
    material: Material,
    /// `[F]` thickness in units of the material's.
    thickness: Vec<f64>,
    /// `[V]` starting area (m²).
    area_m2: Vec<f64>,
    /// `[F]` slope of the offset along the crests by the offsets of its corners (1/m), times
    /// √(2·area/q²)·Λ/λ; 0 where nothing grows one way more than the other.
    crests: Vec<CrestTension>,
    /// `[V]` size 1, mean about 0 (no unit).
    rough: Vec<f64>,
    scale: Scale,
}

impl<'a, 'b> Prepared<'a, 'b> {
    pub(super) fn new(
        growing: &'b Growing<'a>,
        options: &'b GrowthOptions,
        within: Option<&Within<'_>>,
    ) -> Result<Self> {
        let (topology, start) = (growing.topology, growing.start);
        let scale = within.map_or_else(|| Scale::of(growing), |within| within.scale);
        let mean = scale.wavelength_m;
        let material =
            Material::new(options.young_pa, options.poisson, options.thickness_share * mean)?;
        let thickness: Vec<f64> = topology
            .faces
            .iter()
            .map(|face| {
                face.iter().map(|&v| growing.maps.wavelength_m[v]).sum::<f64>() / (3.0 * mean)
            })
            .collect();
        let mut clamps = Clamps::none(start.len());
        for (v, frozen) in growing.maps.frozen.iter().enumerate() {
            let (still, place) =
                within.map_or((false, &start[v]), |within| (within.still[v], &within.pose[v]));
            clamps.targets[v] =
                std::array::from_fn(|axis| (still || frozen[axis]).then_some(place[axis]));
        }
        let surface = RestMetric::from_shape(start, &topology.faces).at("growth")?;
        let (area_m2, rough) = match within {
            Some(within) => (within.area_m2.to_vec(), within.rough.to_vec()),
            None => areas_and_imperfections(growing, &surface, options.seed)?,
        };
        Ok(Self {
            growing,
            options,
            normals: within.map_or_else(
                || try_vertex_normals(topology, start).at("growth"),
                |within| Ok(within.normals.to_vec()),
            )?,
            clamps,
            material,
            thickness,
            area_m2,
            crests: (0..topology.face_count())
                .map(|f| crest_tension(growing, &surface, f))
                .collect(),
            rough,
            scale,
        })
    }

    /// k (N/m³) at vertex `v`, grown by the factor `growth`.
    fn stiffness(&self, v: usize, growth: f64) -> f64 {
        let (wavelength, poisson) = (self.growing.maps.wavelength_m[v], self.options.poisson);
        let thickness = self.options.thickness_share * wavelength;
        let bending =
            self.options.young_pa * thickness.powi(3) / (12.0 * (1.0 - poisson * poisson));
        loose::share(self.growing.maps.hold[v])
            * bending
            * (std::f64::consts::TAU / wavelength).powi(4)
            / softening(growth)
    }

    /// What keeps the surface from passing through itself, pushing about as hard as the foundation
    /// does under a fold.
    fn contact(&self, foundation: &[Foundation]) -> Option<SelfContact<'b>> {
        let growing = self.growing;
        let strength: Vec<f64> = foundation
            .iter()
            .zip(&growing.maps.wavelength_m)
            .map(|(held, wavelength)| held.stiffness * wavelength)
            .collect();
        // Not much more than an edge can tell apart.
        let reach = self.material.thickness_m.min(0.5 * self.scale.edge_m);
        growing.self_contact.then(|| {
            SelfContact::new(
                growing.topology,
                growing.start,
                reach,
                LONGEST_MOVE * self.scale.edge_m,
                &strength,
            )
        })
    }

    pub(super) fn settle(
        &self,
        part: f64,
        effort: Effort,
        expansion: &Expansion,
        grown: &RestMetric,
        pose: &mut [Vec3],
        observer: &dyn Observer,
    ) -> Result<StepReport> {
        let (growing, options) = (self.growing, self.options);
        let most: Vec<f64> =
            expansion.vertices.iter().map(|growth| growth.principal().0[0]).collect();
        let stiff: Vec<f64> = (0..most.len()).map(|v| self.stiffness(v, most[v])).collect();
        // What does not grow is pushed nowhere.
        let begun = |v: usize| (most[v].ln().max(0.0) / FULL_IMPERFECTION).min(1.0);
        let offset_of = |v: usize, rough: f64| {
            begun(v) * growing.maps.wavelength_m[v] * options.imperfection * rough
        };
        let foundation: Vec<Foundation> = (0..most.len())
            .map(|v| {
                let stiffness = stiff[v] * self.area_m2[v];
                Foundation {
                    normal: self.normals[v],
                    stiffness,
                    grip: options.grip * stiffness,
                    offset_m: begun(v)
                        * growing.maps.wavelength_m[v]
                        * (growing.maps.bias[v] + options.imperfection * self.rough[v]),
                    stickiness: growing.maps.stickiness[v],
                }
            })
            .collect();
        let crests: Vec<CrestTension> = growing
            .topology
            .faces
            .iter()
            .zip(&self.crests)
            .map(|(face, crest)| {
                let stiffness = face.iter().map(|&v| stiff[v]).sum::<f64>() / 3.0;
                crest.map(|c| c * stiffness.sqrt())
            })
            .collect();
        let mut setup = Setup {
            loads: growing.loads.clone(),
            obstacles: growing.obstacles,
            contact_thickness_m: growing.contact_thickness_m,
            contact_pressure_pa: foundation
                .iter()
                .zip(&growing.maps.wavelength_m)
                .map(|(held, wavelength)| held.stiffness * wavelength)
                .sum::<f64>()
                / self.area_m2.iter().sum::<f64>(),
            ..Setup::new(growing.topology, grown, &self.material, &self.clamps)
        };
        let rest_offset_m: Vec<Vec3> = (0..most.len())
            .map(|v| {
                self.normals[v]
                    * (loose::missing(growing.maps.hold[v]) * offset_of(v, self.rough[v]))
            })
            .collect();
        setup.loads.forces_newton.extend(loose::forces_newton(
            &setup,
            &self.thickness,
            &rest_offset_m,
        ));
        let mut film = Film::new(&setup, growing.start, &self.thickness, &foundation, &crests)?
            .apart(self.contact(&foundation));
        let force = options.onset() * self.scale.edge_m / film.length_m();
        let newton = Options {
            iteration_limit: effort.iteration_limit,
            tolerance: effort.tolerance * force,
            stay_in_basin: true,
            ..Options::new("grow", film.unit_joule())
        };
        let (unit_joule, length_m, begin) = (film.unit_joule(), film.length_m(), film.pack(pose));
        let outcome = if growing.maps.bands.is_empty() {
            let outcome = minimise(&mut film, &begin, &newton, observer)?;
            film.unpack(&outcome.x, pose);
            outcome
        } else {
            let unknown = film.unknowns().to_vec();
            let mut banded = Banded::new(
                film,
                &growing.maps.bands,
                &unknown,
                growing.start,
                &self.area_m2,
                length_m,
            );
            let begin = banded.pack(&begin, growing.start, pose);
            let outcome = minimise(&mut banded, &begin, &newton, observer)?;
            banded.inner().unpack(&banded.unpack(&outcome.x), pose);
            banded.straighten(growing.start, pose);
            outcome
        };
        if !outcome.energy.is_finite() {
            return Err(Error::numeric(
                "grow",
                "the energy is not a finite number; check the expansion and the loads",
            ));
        }
        Ok(StepReport {
            part,
            iterations: outcome.iterations,
            ending: outcome.ending,
            residual: outcome.projected_gradient / force,
            residual_newton: outcome.projected_gradient * unit_joule / length_m,
            energy_joule: outcome.energy * unit_joule,
        })
    }
}

/// The crest tension of face `f` over √k: T = 2k/q²·(Λ/λ)² against slopes along the direction that
/// grows least.
fn crest_tension(growing: &Growing<'_>, surface: &RestMetric, f: usize) -> CrestTension {
    let face = growing.topology.faces[f];
    let [a, b, c] = face.map(|v| growing.start[v]);
    // A face's frame: the first vector along side 0→1, as in its metric.
    let first = (b - a).normalize();
    let second = (b - a).cross(&(c - a)).normalize().cross(&first);
    // The directions are lines: their dyads are averaged, weighted by how much more grows one way
    // than the other.
    let (mut dyads, mut ratio) = (crate::mesh::Mat2::zeros(), 0.0);
    for v in face {
        let ([most, least], [_, along]) = growing.maps.expansion.vertices[v].principal();
        let uneven = if most > 1.0 { 1.0 - least.ln().max(0.0) / most.ln() } else { 0.0 };
        let along = crate::mesh::Vec2::new(first.dot(&along), second.dot(&along));
        dyads += along * along.transpose() * uneven;
        ratio += uneven / 3.0 * growing.maps.coherence_m[v] / growing.maps.wavelength_m[v];
    }
    if ratio == 0.0 {
        return [0.0; 3];
    }
    let (_, low) = crate::strain::principal_pair(&dyads);
    let crest = crate::mesh::Vec2::new(-low.y, low.x);
    let wavelength = face.iter().map(|&v| growing.maps.wavelength_m[v]).sum::<f64>() / 3.0;
    let scale =
        (2.0 * surface.faces[f].area_m2).sqrt() * wavelength / std::f64::consts::TAU * ratio;
    surface.faces[f].barycentric_gradients().map(|g| scale * g.dot(&crest))
}
