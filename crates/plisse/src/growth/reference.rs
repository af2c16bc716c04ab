//! The reference mode: the forces (1)–(6) of [Combaz & Neyret 2002] with its smoothing kernel and
//! sigmoid (4.4), integrated semi-implicitly. It is kept because the paper's figures were made with
//! it; [`super::load_stepping`] is the default.
//!
//! All forces are per unit of starting area and in units of the membrane's stiffness. With the
//! curvature κ = −N·Δx (1/m, positive where the surface bulges out; κ₀ is that of the starting
//! surface) and the share C_a by which the cell of a vertex is smaller than it wants:
//!
//! - membrane (1)–(3): St. Venant–Kirchhoff on ā, its force projected on the tangent plane;
//! - curvature (4): −k_κ(κ − κ₀)·N;
//! - folding (5): (k_p·σ(κ* − κ₀*) + k_pi)·C_a·N with κ* = κ + ν_u·∂²κ/∂u² + ν_c·∂²κ/∂c², ν =
//!   (wavelength/2π)² along the growth u with λ and along the crests c with Λ; σ = tanh of its
//!   argument times λ/2π and a sharpness.
//!
//! The kernel's derivatives are taken on the starting surface, so that λ is the spacing seen there,
//! as in the other mode. Sliding and offset each have a constant matrix, factorised once for each
//! level of growth: mass/dt plus the stiffness of the membrane, and plus those of curvature and
//! kernel. The forces are no gradient of an energy: there is nothing to search a line on, and the
//! end is told by the largest force.
//!
//! Linear analysis of the forces: a small wave of wave number q grows by q²·(k_p·C_a·(1 −
//! νq²) − k_κ), most at q² = (1 − k_κ/k_pC_a)/2ν. So folds begin √2·λ apart or more, not λ, and the
//! shape is at rest where κ* = 0 only if nothing else acts.

use std::f64::consts::TAU;
use web_time::Instant;

use super::maps::GrowthAt;
use super::procedural_map::roughness;
use super::surface::GrowingSurface;
use crate::linalg::cholesky::Cholesky;
use crate::linalg::sparse::SymmetricPattern;
use crate::material::Material;
use crate::mesh::normals::try_vertex_normals;
use crate::mesh::{Mat2, Topology, Vec2, Vec3};
use crate::progress::{Observer, Step};
use crate::rest::RestMetric;
use crate::shell::quadratic_bending::QuadraticBending;
use crate::shell::tension_field::Membrane;
use crate::{At, Error, Result};

/// Options of the reference mode.
#[derive(Clone, Debug)]
pub struct ReferenceOptions {
    /// k_p (no unit, times the membrane's stiffness over λ): how strongly folds are driven.
    pub folding: f64,
    /// k_κ over k_p·λ/2π (no unit): it keeps folds smooth, at the cost of length.
    pub smoothness: f64,
    /// Sharpness of the sigmoid.
    pub sharpness: f64,
    /// Size of the random part of k_pi, over k_p.
    pub imperfection: f64,
    /// Seed of the random part.
    pub seed: u64,
    /// Length of a step of time, in units of λ/k_p.
    pub time_step: f64,
    /// Levels of growth, and steps of time at each.
    pub levels: usize,
    /// Steps of time at each level at most.
    pub iteration_limit: usize,
    /// Largest force at which a level ends, over k_p.
    pub tolerance: f64,
}

impl Default for ReferenceOptions {
    fn default() -> Self {
        Self {
            folding: 0.1,
            smoothness: 0.02,
            sharpness: 3.0,
            imperfection: 0.05,
            seed: 1,
            time_step: 0.02,
            levels: 6,
            iteration_limit: 1000,
            tolerance: 1e-3,
        }
    }
}

/// Report on one level of growth.
#[derive(Clone, Copy, Debug)]
pub struct LevelReport {
    /// Part of the growth (0 to 1) that was applied.
    pub part: f64,
    /// Steps of time.
    pub iterations: usize,
    /// Largest force left, over k_p.
    pub residual: f64,
    /// True if the residual is below the tolerance.
    pub converged: bool,
}

/// Report of the reference mode.
#[derive(Clone, Debug)]
pub struct ReferenceReport {
    /// Every level of growth that was begun.
    pub levels: Vec<LevelReport>,
    /// True if the observer cancelled it.
    pub cancelled: bool,
    /// Steps of time.
    pub iterations: usize,
    /// Largest force left, over k_p.
    pub residual: f64,
    /// True if the residual is below the tolerance.
    pub converged: bool,
    /// The rest metric that was asked for.
    pub asked: RestMetric,
    /// Seconds.
    pub seconds: f64,
}

/// The folded surface (`[V]`, m) by the paper's forces. Frozen axes are kept; sticking, loads and
/// obstacles are not in this mode.
///
/// # Errors
/// [`Error::Value`] if λ varies (its matrices take one), or loads or obstacles are given;
/// [`Error::Numeric`] if it diverges.
pub fn grow_by_forces(
    surface: &GrowingSurface,
    options: &ReferenceOptions,
    observer: &dyn Observer,
) -> Result<(Vec<Vec3>, ReferenceReport)> {
    grow_by_forces_each(surface, options, observer, &mut |_, _| Ok(()))
}

/// As [`grow_by_forces`]; `each` is called with every level and the pose (`[V]`, m) that it led to.
///
/// # Errors
/// As [`grow_by_forces`]; those of `each`.
pub fn grow_by_forces_each(
    surface: &GrowingSurface,
    options: &ReferenceOptions,
    observer: &dyn Observer,
    each: &mut dyn FnMut(&LevelReport, &[Vec3]) -> Result<()>,
) -> Result<(Vec<Vec3>, ReferenceReport)> {
    let begun = Instant::now();
    let wavelength_m = check(surface)?;
    let (whole, mut pose) = (surface.maps.expansion(), surface.start.clone());
    let (mut iterations, mut residual, mut cancelled) = (0, 0.0, false);
    let mut levels = Vec::with_capacity(options.levels);
    for level in 1..=options.levels {
        let part = level as f64 / options.levels as f64;
        let grown = surface.grown_by(&whole.part(part))?;
        let mut forces = Forces::new(surface, options, &grown, wavelength_m)?;
        let before = iterations;
        for _ in 0..options.iteration_limit {
            cancelled = observer.cancelled();
            if cancelled {
                break;
            }
            residual = forces.step(&mut pose)?;
            iterations += 1;
            observer.step(&Step {
                stage: "grow",
                iteration: iterations,
                limit: options.levels * options.iteration_limit,
                energy_joule: 0.0,
                residual,
                tolerance: options.tolerance,
            });
            if residual <= options.tolerance {
                break;
            }
        }
        let converged = !cancelled && residual <= options.tolerance;
        levels.push(LevelReport { part, iterations: iterations - before, residual, converged });
        each(&levels[levels.len() - 1], &pose)?;
        if cancelled {
            break;
        }
    }
    let asked = surface.grown_by(&whole)?;
    let seconds = begun.elapsed().as_secs_f64();
    let converged = levels.last().is_none_or(|level| level.converged);
    Ok((
        pose,
        ReferenceReport { levels, cancelled, iterations, residual, converged, asked, seconds },
    ))
}

/// Checks that this mode knows all that the surface asks for; returns λ (m).
fn check(surface: &GrowingSurface) -> Result<f64> {
    let at = &surface.maps.vertices;
    let wavelength_m = at[0].wavelength_m;
    if at.iter().any(|at| at.wavelength_m != wavelength_m) {
        return Err(Error::value(
            "growth.wavelength_m",
            "the reference mode takes one for the whole surface; give a number, or use the other \
             mode",
        ));
    }
    if !surface.obstacles.is_empty()
        || surface.loads != crate::shell::Loads::default()
        || !at.iter().all(GrowthAt::is_symmetric)
    {
        return Err(Error::value(
            "growth.mode",
            "the reference mode knows no loads, sticking or obstacles; remove them, or use the \
             other mode",
        ));
    }
    if at.iter().any(|at| at.hold != 1.0) {
        return Err(Error::value(
            "growth.hold",
            "the reference mode has no foundation; remove this, or use the other mode",
        ));
    }
    Ok(wavelength_m)
}

/// The paper's forces at one level of growth.
struct Forces<'a> {
    surface: &'a GrowingSurface,
    options: &'a ReferenceOptions,
    wavelength_m: f64,
    membranes: Vec<Membrane>,
    grown: RestMetric,
    /// `[V][…]` (−Δx)_v as coefficients (1/m²) of positions.
    laplacian: Vec<Vec<(usize, f64)>>,
    /// `[F]` smoothing kernel as a form on the corners, times area: the sum over faces is −area·L.
    kernel: Vec<[[f64; 3]; 3]>,
    /// `[V]` starting area (m²).
    area_m2: Vec<f64>,
    /// `[V]` κ₀ and κ₀* (1/m).
    start_curvature: Vec<[f64; 2]>,
    /// `[V]` k_pi over k_p.
    push: Vec<f64>,
    sliding: Cholesky,
    offset: Cholesky,
}

impl<'a> Forces<'a> {
    fn new(
        surface: &'a GrowingSurface,
        options: &'a ReferenceOptions,
        grown: &RestMetric,
        wavelength_m: f64,
    ) -> Result<Self> {
        let (topology, start) = (&surface.topology, &surface.start);
        // Membrane stiffness 1 N/m: the thickness is a formality.
        let material = Material::new(1.0, 0.0, 1.0)?;
        let metric = RestMetric::from_shape(start, &topology.faces).at("growth")?;
        let mut area_m2 = vec![0.0; start.len()];
        let mut cell_m2 = vec![0.0; start.len()];
        for (f, face) in topology.faces.iter().enumerate() {
            for &v in face {
                area_m2[v] += metric.faces[f].area_m2 / 3.0;
                cell_m2[v] += grown.faces[f].area_m2 / 3.0;
            }
        }
        let laplacian = laplacian_rows(topology, grown, &material, &cell_m2);
        let kernel: Vec<[[f64; 3]; 3]> =
            (0..topology.face_count()).map(|f| kernel(surface, &metric, f)).collect();
        let push_k = options.folding / wavelength_m;
        let dt = options.time_step * wavelength_m / push_k;

        // Sliding: mass/dt + stiffness of the membrane (at most twice a scalar Laplacian's).
        let pattern = SymmetricPattern::from_elements(
            start.len(),
            topology.faces.iter().map(|face| &face[..]),
        );
        let mut values = vec![0.0; pattern.entry_count()];
        let weight = |f: usize| 2.0 * grown.faces[f].area_m2;
        add_laplacian(topology, grown, weight, &pattern, &mut values);
        add_mass(&area_m2, dt, &pattern, &mut values);
        let frozen: Vec<bool> =
            surface.maps.vertices.iter().map(|at| at.frozen == [true; 3]).collect();
        let sliding = factorised(pattern, &values, &frozen)?;

        // Offset: mass/dt + Δᵀ(k_κ)… as squares of the Laplacian for the kernel and itself for the
        // curvature's force.
        let lists: Vec<Vec<usize>> =
            laplacian.iter().map(|row| row.iter().map(|&(v, _)| v).collect()).collect();
        let pattern = SymmetricPattern::from_elements(start.len(), lists.iter().map(Vec::as_slice));
        let mut values = vec![0.0; pattern.entry_count()];
        let smooth = options.smoothness * push_k * wavelength_m / TAU;
        // The steepest that the sigmoid can answer to κ*, at a compression of a third.
        let reach =
            surface.maps.vertices.iter().fold(wavelength_m, |most, at| most.max(at.coherence_m))
                / TAU;
        let answer = push_k / 3.0 * options.sharpness * wavelength_m / TAU * reach * reach;
        for (v, row) in laplacian.iter().enumerate() {
            for (n, &(i, a)) in row.iter().enumerate() {
                for &(j, b) in &row[..=n] {
                    values[pattern.slot(i, j)] += answer * area_m2[v] * a * b;
                }
            }
        }
        let weight = |f: usize| smooth * metric.faces[f].area_m2;
        add_laplacian(topology, grown, weight, &pattern, &mut values);
        add_mass(&area_m2, dt, &pattern, &mut values);
        let offset = factorised(pattern, &values, &frozen)?;
        let push = (0..start.len())
            .map(|v| {
                surface.maps.vertices[v].bias
                    + options.imperfection
                        * roughness(&surface.places[v], 0.5 * wavelength_m, options.seed)
            })
            .collect();
        let mut forces = Self {
            surface,
            options,
            wavelength_m,
            membranes: grown.faces.iter().map(|rest| Membrane::new(rest, &material, 1.0)).collect(),
            grown: grown.clone(),
            laplacian,
            kernel,
            area_m2,
            start_curvature: vec![[0.0; 2]; start.len()],
            push,
            sliding,
            offset,
        };
        let curvature = forces.curvature(start, &try_vertex_normals(topology, start).at("growth")?);
        let smoothed = forces.smoothed(&curvature);
        forces.start_curvature = curvature.into_iter().zip(smoothed).map(|(a, b)| [a, b]).collect();
        Ok(forces)
    }

    /// `[V]` κ = −N·Δx (1/m).
    fn curvature(&self, pose: &[Vec3], normals: &[Vec3]) -> Vec<f64> {
        self.laplacian
            .iter()
            .zip(normals)
            .map(|(row, n)| n.dot(&row.iter().map(|&(v, c)| pose[v] * c).sum::<Vec3>()))
            .collect()
    }

    /// `[V]` κ* = κ + L(κ) (1/m).
    fn smoothed(&self, curvature: &[f64]) -> Vec<f64> {
        let mut sum = vec![0.0; curvature.len()];
        for (face, kernel) in self.surface.topology.faces.iter().zip(&self.kernel) {
            for k in 0..3 {
                sum[face[k]] -= (0..3).map(|l| kernel[k][l] * curvature[face[l]]).sum::<f64>();
            }
        }
        (0..sum.len()).map(|v| curvature[v] + sum[v] / self.area_m2[v]).collect()
    }

    /// One step of time; returns the largest force per area, over k_p.
    fn step(&mut self, pose: &mut [Vec3]) -> Result<f64> {
        let topology = &self.surface.topology;
        let normals = try_vertex_normals(topology, pose).map_err(|_| {
            Error::numeric(
                "grow",
                "the reference mode diverged; take smaller time \
                steps, more levels, or the other mode",
            )
        })?;
        let n = pose.len();
        let (mut stretch, mut asked, mut there) =
            (vec![Vec3::zeros(); n], vec![0.0; n], vec![0.0; n]);
        for (f, face) in topology.faces.iter().enumerate() {
            let corners = face.map(|v| pose[v]);
            let slope = self.membranes[f].gradient(&corners);
            let area = 0.5 * (corners[1] - corners[0]).cross(&(corners[2] - corners[0])).norm();
            for k in 0..3 {
                stretch[face[k]] -= Vec3::new(slope[3 * k], slope[3 * k + 1], slope[3 * k + 2]);
                asked[face[k]] += self.grown.faces[f].area_m2;
                there[face[k]] += area;
            }
        }
        let curvature = self.curvature(pose, &normals);
        let smoothed = self.smoothed(&curvature);
        let push_k = self.options.folding / self.wavelength_m;
        let smooth = self.options.smoothness * push_k * self.wavelength_m / TAU;
        let (mut worst, mut offset) = (0.0_f64, vec![0.0; n]);
        for v in 0..n {
            // Where it is pulled nothing folds; the paper's sign would make short waves grow there.
            let compression = ((asked[v] - there[v]) / asked[v]).max(0.0);
            let steep = self.options.sharpness * self.wavelength_m / TAU
                * (smoothed[v] - self.start_curvature[v][1]);
            let folding = push_k * (steep.tanh() + self.push[v]) * compression;
            let bending = -smooth * (curvature[v] - self.start_curvature[v][0]);
            let lift = normals[v].dot(&stretch[v]);
            stretch[v] -= normals[v] * lift;
            let frozen = self.surface.maps.vertices[v].frozen;
            offset[v] =
                if frozen == [true; 3] { 0.0 } else { (folding + bending) * self.area_m2[v] };
            for axis in 0..3 {
                if frozen[axis] {
                    stretch[v][axis] = 0.0;
                } else {
                    let force = stretch[v][axis] + normals[v][axis] * offset[v];
                    worst = worst.max(force.abs() / (self.area_m2[v] * push_k));
                }
            }
        }
        self.offset.solve(&mut offset);
        let mut slid = vec![Vec3::zeros(); n];
        for axis in 0..3 {
            let mut column: Vec<f64> = stretch.iter().map(|s| s[axis]).collect();
            self.sliding.solve(&mut column);
            slid.iter_mut().zip(column).for_each(|(s, c)| s[axis] = c);
        }
        for v in 0..n {
            let move_by = slid[v] - normals[v] * normals[v].dot(&slid[v]) + normals[v] * offset[v];
            for axis in (0..3).filter(|&axis| !self.surface.maps.vertices[v].frozen[axis]) {
                pose[v][axis] += move_by[axis];
            }
        }
        if pose.iter().any(|p| !p.iter().all(|x| x.is_finite())) {
            return Err(Error::numeric(
                "grow",
                "the reference mode diverged; take smaller time steps, more levels, or the other \
                 mode",
            ));
        }
        Ok(worst)
    }
}

/// `[V][…]` (−Δx)_v as coefficients (1/m²) of positions, on cells of `cell_m2` (`[V]`, m²).
fn laplacian_rows(
    topology: &Topology,
    grown: &RestMetric,
    material: &Material,
    cell_m2: &[f64],
) -> Vec<Vec<(usize, f64)>> {
    // The rows of quadratic bending are −√(D/2/cell) times the integral of the Laplacian.
    let stiffness =
        material.thickness_m.powi(3) / 12.0 * (material.alpha() / 2.0 + material.beta());
    let mut laplacian = QuadraticBending::new(topology, grown, material).rows;
    for (row, cell) in laplacian.iter_mut().zip(cell_m2) {
        row.iter_mut().for_each(|(_, c)| *c /= (stiffness * cell).sqrt());
    }
    laplacian
}

/// Adds the stiffness of a scalar Laplacian in the metric `grown`, with a `weight` (m²) of each
/// face.
fn add_laplacian(
    topology: &Topology,
    grown: &RestMetric,
    weight: impl Fn(usize) -> f64,
    pattern: &SymmetricPattern,
    values: &mut [f64],
) {
    for (f, face) in topology.faces.iter().enumerate() {
        let g = grown.faces[f].barycentric_gradients();
        for k in 0..3 {
            for l in 0..=k {
                values[pattern.slot(face[k], face[l])] += weight(f) * g[k].dot(&g[l]);
            }
        }
    }
}

/// Adds mass over the time step `dt`.
fn add_mass(area_m2: &[f64], dt: f64, pattern: &SymmetricPattern, values: &mut [f64]) {
    for (v, area) in area_m2.iter().enumerate() {
        values[pattern.slot(v, v)] += area / dt;
    }
}

fn factorised(pattern: SymmetricPattern, values: &[f64], fixed: &[bool]) -> Result<Cholesky> {
    let mut values = values.to_vec();
    pattern.isolate(&mut values, fixed);
    let mut cholesky = Cholesky::new(pattern)?;
    if cholesky.factorise(&values) {
        return Ok(cholesky);
    }
    Err(Error::numeric(
        "grow",
        "a matrix of the reference mode is not positive definite; give the mesh better triangles",
    ))
}

/// Area times ∇φₖ·(ν_u·uuᵗ + ν_c·ccᵗ)·∇φₗ on face `f` of the starting metric, u along the growth.
fn kernel(surface: &GrowingSurface, metric: &RestMetric, f: usize) -> [[f64; 3]; 3] {
    let face = surface.topology.faces[f];
    let [a, b, c] = face.map(|v| surface.start[v]);
    let first = (b - a).normalize();
    let second = (b - a).cross(&(c - a)).normalize().cross(&first);
    let mut form = Mat2::zeros();
    for v in face {
        let ([most, least], [along, across]) = surface.maps.vertices[v].growth.principal();
        let flat = |d: Vec3| Vec2::new(first.dot(&d), second.dot(&d));
        let (u, c) = (flat(along), flat(across));
        // Where all ways grow alike, no way is along the crests.
        let uneven = if most > 1.0 { 1.0 - (least.ln() / most.ln()).clamp(0.0, 1.0) } else { 0.0 };
        let wave = surface.maps.vertices[v].wavelength_m / TAU;
        let coherence = wave + uneven * (surface.maps.vertices[v].coherence_m / TAU - wave);
        form += (u * u.transpose() * wave.powi(2) + c * c.transpose() * coherence.powi(2)) / 3.0;
    }
    let g = metric.faces[f].barycentric_gradients();
    std::array::from_fn(|k| {
        std::array::from_fn(|l| metric.faces[f].area_m2 * g[k].dot(&(form * g[l])))
    })
}

#[cfg(test)]
mod tests {
    use super::super::expansion::Expansion;
    use super::super::maps::GrowthMaps;
    use super::*;
    use crate::mesh::grid::{Diagonal, grid};
    use crate::progress::Silent;

    fn square(columns: usize, rows: usize) -> (Topology, RestMetric, Vec<Vec3>) {
        let panel = grid([1.0, 1.0], 1.0, [Some(columns), Some(rows)], Diagonal::Rising).unwrap();
        let start: Vec<Vec3> = panel.positions.iter().map(|p| Vec3::new(p.x, p.y, 0.0)).collect();
        let topology = Topology::new(start.len(), panel.faces).unwrap();
        let rest = RestMetric::from_shape(&start, &topology.faces).unwrap();
        (topology, rest, start)
    }

    fn growing(
        (topology, rest, start): &(Topology, RestMetric, Vec<Vec3>),
        growth: f64,
    ) -> GrowingSurface {
        let n = start.len();
        let expansion =
            Expansion::from_directions(topology, start, &vec![Vec3::x(); n], &vec![growth; n])
                .unwrap();
        let maps = GrowthMaps::even(&expansion, 0.25, 0.25);
        let mut surface = GrowingSurface::new(topology.clone(), rest.clone(), start.clone(), maps);
        let boundary = topology.boundary_vertices();
        surface.freeze(|v, _| boundary[v]);
        surface
    }

    #[test]
    fn curvature_is_positive_on_bumps_and_waves_of_the_asked_length_are_at_rest() {
        let square = square(80, 8);
        let growing = growing(&square, 1.0);
        let options = ReferenceOptions::default();
        let forces = Forces::new(&growing, &options, &square.1, 0.25).unwrap();
        let wave = |waves: f64, p: &Vec3| 1e-4 * (TAU * waves * p.x).sin();
        let middle = square
            .2
            .iter()
            .enumerate()
            .filter(|(_, p)| (*p - Vec3::new(0.5, 0.5, 0.0)).amax() < 0.3);
        let middle: Vec<usize> = middle.map(|(v, _)| v).collect();
        for (waves, sign) in [(2.0, 1.0), (4.0, 0.0), (8.0, -1.0)] {
            let pose: Vec<Vec3> = square.2.iter().map(|p| p + Vec3::z() * wave(waves, p)).collect();
            let curvature = forces.curvature(&pose, &vec![Vec3::z(); pose.len()]);
            let smoothed = forces.smoothed(&curvature);
            for &v in &middle {
                let (exact, share) = (
                    (TAU * waves).powi(2) * wave(waves, &square.2[v]),
                    1.0 - (waves / 4.0_f64).powi(2),
                );
                let size = 1e-4 * (TAU * waves).powi(2);
                assert!(
                    (curvature[v] - exact).abs() < 0.05 * size,
                    "{waves}: {} {exact}",
                    curvature[v]
                );
                assert!(
                    (smoothed[v] - share * exact).abs() < 0.1 * size * share.abs().max(1.0),
                    "{waves} {sign}"
                );
            }
        }
    }

    #[test]
    fn it_folds_and_growing_by_one_moves_nothing() {
        let square = square(32, 8);
        let options = ReferenceOptions { levels: 2, ..ReferenceOptions::default() };
        let (flat, report) = grow_by_forces(&growing(&square, 1.0), &options, &Silent).unwrap();
        assert!(
            report.converged && flat.iter().zip(&square.2).all(|(p, q)| (p - q).norm() < 1e-12)
        );
        let (folded, _) = grow_by_forces(&growing(&square, 1.1), &options, &Silent).unwrap();
        assert!(folded.iter().any(|p| p.z.abs() > 0.01));
    }
}
