//! Stage "Crush" (4.2, 5.1): the strength and direction of the compression around each vertex.
//!
//! It departs from the paper in three points. Amplitude comes with its share of the largest
//! possible one (W/4); Relax weighs by this share, so that nothing depends on the model's size. The
//! wave vector is 2π/W·k′ (rad/m), so that the wavelength may differ from vertex to vertex. An
//! eigenvector has no sign, so each frame's is turned to agree with the last one's; then the phase
//! needs no flipping (the profile is even: turning k′ and φ together changes nothing).

use std::f32::consts::TAU;

use nalgebra::{Matrix2, Vector2};
use rayon::prelude::*;

use crate::skin::PosedVertices;
use crate::weld::WeldedMesh;
use crate::{CHUNK, Vec3, wrap};

/// Smallest singular value r that wave vectors follow (no unit). Below it k′, which grows like 1/r,
/// keeps this one's length: waves four times finer than asked for are of no use.
pub const LEAST_R: f32 = 0.25;
/// Round-off of 1 − r² in f32 (no unit). Less than this counts as no compression, because the root
/// of eq. 2 would magnify it.
pub(crate) const ROUND_OFF: f32 = 2e-6;
/// Ratio of the eigenvalues of Σ v⊗v (no unit) below which the neighbours lie in one line and tell
/// nothing across it.
pub(crate) const SINGULAR: f32 = 1e-5;

/// Data of each vertex that Crush reads besides the mesh.
#[derive(Clone, Copy, Debug)]
pub struct CrushInput<'a> {
    /// `[U]` wavelength W (m, rest), or one for all.
    pub wavelength_m: &'a [f32],
    /// `[U]` painted bias p (section 7): a rest-space vector of length < 1 along which wrinkles run
    /// in, or empty (none).
    pub bias: &'a [Vec3],
    /// `[U]` the last frame's `direction`, or empty (first frame).
    pub last_direction: &'a [Vec3],
}

/// The plane wave of each vertex, but for its phase.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlaneWaves {
    /// `[U]` amplitude h (m), eq. 2, in [0, W/4].
    pub amplitude_m: Vec<f32>,
    /// `[U]` share of the largest amplitude, √max(1 − r², 0), in [0, 1].
    pub strength: Vec<f32>,
    /// `[U]` wave vector 2π/W·k′ (rad/m, posed space, tangential), eq. 4.
    pub wave: Vec<Vec3>,
    /// `[U]` unit direction k of strongest compression (rest space, tangential); zero at singular
    /// vertices.
    pub direction: Vec<Vec3>,
    /// Number of singular vertices: they have fewer than two neighbours, or all in one line, so no
    /// direction can be told and h = 0.
    pub singular: usize,
}

/// Measures the compression from the rest pose of `welded` to `posed`.
pub fn crush(welded: &WeldedMesh, posed: &PosedVertices, input: &CrushInput<'_>) -> PlaneWaves {
    let at = |v: usize| {
        let wavelength_m = *input.wavelength_m.get(v).unwrap_or(&input.wavelength_m[0]);
        let bias = input.bias.get(v).copied().unwrap_or_else(Vec3::zeros);
        let found = crush_vertex(welded, posed, v, &bias);
        let (r, mut k, mut k_posed) = found.unwrap_or((1.0, Vec3::zeros(), Vec3::zeros()));
        if input.last_direction.get(v).is_some_and(|last| last.dot(&k) < 0.0) {
            (k, k_posed) = (-k, -k_posed);
        }
        let squared = 1.0 - r * r;
        let strength = if squared < ROUND_OFF { 0.0 } else { squared.sqrt() };
        (
            ((0.25 * wavelength_m * strength, strength), (k_posed * (TAU / wavelength_m), k)),
            found.is_none(),
        )
    };
    let vertices = (0..welded.count()).into_par_iter().with_min_len(CHUNK);
    let (((amplitude_m, strength), (wave, direction)), singular): (((_, _), (_, _)), Vec<bool>) =
        vertices.map(at).unzip();
    PlaneWaves {
        amplitude_m,
        strength,
        wave,
        direction,
        singular: singular.iter().filter(|&&s| s).count(),
    }
}

/// r, k (rest) and k′ (posed) at vertex `v`; `None` where the neighbours do not span the tangent
/// plane.
fn crush_vertex(
    welded: &WeldedMesh,
    posed: &PosedVertices,
    v: usize,
    bias: &Vec3,
) -> Option<(f32, Vec3, Vec3)> {
    let rest = &welded.vertices;
    let around = welded.around(v);
    let (t, b) = frame(&rest.positions, &rest.normals, v, around)?;
    let (t_posed, b_posed) = frame(&posed.positions, &posed.normals, v, around)?;
    let (mut moved, mut gram) = (Matrix2::<f32>::zeros(), Matrix2::<f32>::zeros());
    for &n in around {
        let x = rest.positions[n as usize] - rest.positions[v];
        let x_posed = posed.positions[n as usize] - posed.positions[v];
        let flat = Vector2::new(t.dot(&x), b.dot(&x));
        let flat_posed = Vector2::new(t_posed.dot(&x_posed), b_posed.dot(&x_posed));
        moved += flat_posed * flat.transpose();
        gram += flat * flat.transpose();
    }
    // λ_min / λ_max ≈ det / trace² where it is small.
    let (determinant, trace) = (gram.determinant(), gram.trace());
    if !(trace > f32::MIN_POSITIVE && determinant > SINGULAR * trace * trace) {
        return None;
    }
    let q = Vector2::new(t.dot(bias), b.dot(bias));
    let m = moved * gram.try_inverse()? * (Matrix2::identity() - q * q.transpose());
    let (r, weak) = weakest(&m)?;
    // k′ = M⁻ᵀk = u/r with u = Mk, of unit length; taken across the other direction's image, since
    // r may be tiny.
    let strong = Vector2::new(-weak.y, weak.x);
    let across = m * strong;
    let mut u = Vector2::new(across.y, -across.x).try_normalize(1e-20)?;
    if u.dot(&(m * weak)) < 0.0 {
        u = -u;
    }
    let scaled = u / r.max(LEAST_R);
    Some((r, t * weak.x + b * weak.y, t_posed * scaled.x + b_posed * scaled.y))
}

/// An orthonormal frame of the tangent plane at `v`: t along the first neighbour that is not above
/// the vertex. Any neighbour will do, in each pose another: a turn of the frame cancels in r, k and
/// k′.
fn frame(positions: &[Vec3], normals: &[Vec3], v: usize, around: &[u32]) -> Option<(Vec3, Vec3)> {
    let n = normals[v];
    if n.norm_squared() < 0.25 {
        return None;
    }
    around.iter().find_map(|&i| {
        let x = positions[i as usize] - positions[v];
        let flat = x - n * x.dot(&n);
        let t = (flat.norm_squared() > 1e-4 * x.norm_squared())
            .then(|| flat.try_normalize(1e-30))??;
        Some((t, n.cross(&t)))
    })
}

/// The smaller singular value of `m` and its unit right vector: the eigenvector of MᵀM, by the
/// closed form of a 2×2 matrix.
fn weakest(m: &Matrix2<f32>) -> Option<(f32, Vector2<f32>)> {
    let s = m.transpose() * m;
    let (mean, half) = (0.5 * (s[(0, 0)] + s[(1, 1)]), 0.5 * (s[(0, 0)] - s[(1, 1)]));
    if !(mean.is_finite() && mean > 1e-12) {
        return None;
    }
    // The strong axis (cos θ, sin θ) has cos 2θ ∝ half and sin 2θ ∝ s₀₁. Half angles by the root
    // that does not cancel, and without trigonometry, which GPUs round coarsely.
    let off = s[(0, 1)];
    let radius = half.hypot(off);
    let (cos, sin) = if radius <= 1e-12 * mean {
        (1.0, 0.0)
    } else if half >= 0.0 {
        let cos = (0.5 * (1.0 + half / radius)).sqrt();
        (cos, 0.5 * off / (radius * cos))
    } else {
        let sin = (0.5 * (1.0 - half / radius)).sqrt();
        (0.5 * off.abs() / (radius * sin), if off < 0.0 { -sin } else { sin })
    };
    let weak = Vector2::new(-sin, cos);
    Some(((m * weak).norm(), weak))
}

/// Share of vertices, among those with a strength of at least `least` in both frames, whose phase
/// moved more than π/4 between two frames. Directions must have been aligned, as [`crush`] does.
pub fn phase_jump_share(strength: [&[f32]; 2], phase: [&[f32]; 2], least: f32) -> f32 {
    let wrinkled = |v: &usize| strength[0][*v] >= least && strength[1][*v] >= least;
    let jumps = |v: &usize| wrap(phase[1][*v] - phase[0][*v]).abs() > std::f32::consts::FRAC_PI_4;
    let both: Vec<usize> = (0..phase[0].len()).filter(wrinkled).collect();
    both.iter().filter(|v| jumps(v)).count() as f32 / both.len().max(1) as f32
}
