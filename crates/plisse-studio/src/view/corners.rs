//! The corners of faces in each view. Numbers become texture coordinates of a [`Scale`]; only the
//! wrinkled view has waves.

use std::f32::consts::TAU;
use std::sync::Arc;

use nalgebra::Matrix2;
use plisse_live::render::Corner;
use plisse_live::skin::PosedVertices;
use plisse_live::weld::WeldedMesh;
use plisse_live::{Vec2, Vec3};

use super::colours::{Scale, wire_uvs};
use super::kind::{Legend, View};
use crate::document::Layer;
use crate::document::layers::{Range, amount};

/// Least strain (no unit) at the ends of the colour scale.
const LEAST_STRAIN: f32 = 0.02;

/// Waves and pose of a surface, as views need them. `U` welded vertices, `F` faces.
#[derive(Clone, Copy)]
pub struct ViewedSurface<'a> {
    /// `[F]` faces as they are drawn wrinkled.
    pub wrinkled: &'a [[Corner; 3]],
    /// The mesh at rest.
    pub welded: &'a WeldedMesh,
    /// `[F]` principal strain, the lesser first; `None`: it is computed from the mesh at rest.
    pub strain: Option<&'a [[f32; 2]]>,
    /// The posed vertices.
    pub posed: &'a Arc<PosedVertices>,
    /// `[U]` amplitude (m).
    pub amplitude_m: &'a [f32],
    /// `[U]` numbers of the layer that the view shows, or empty.
    pub layer: &'a [[f32; 4]],
    /// Position of the viewer (m).
    pub eye: Vec3,
}

/// Share of the light that depends on a face's normal where colours are numbers; the rest is even,
/// so that colours can be read.
const RELIEF: f32 = 0.3;

/// Faces for `view`, the scale they are drawn with, and the meaning of its colours.
pub fn faces(surface: &ViewedSurface<'_>, view: View) -> (Vec<[Corner; 3]>, Scale, Option<Legend>) {
    match view {
        View::Wrinkled => (surface.wrinkled.to_vec(), Scale::Base, None),
        View::Wireframe => (each(surface, |_| wire_uvs()), Scale::Wire, None),
        View::Strain => strained(surface),
        View::Amplitude => {
            let most = surface.amplitude_m.iter().copied().fold(0.0, f32::max);
            let scale = if most > 0.0 { 1.0 / most } else { 0.0 };
            let unit = |x: f32| format!("{:.3} mm", 1e3 * x);
            let of = |f: usize| {
                surface.welded.faces[f]
                    .map(|v| Scale::Heat.uv(surface.amplitude_m[v as usize] * scale))
            };
            let legend = legend("Amplitude", [0.0, 0.5 * most, most].map(unit), Scale::Heat);
            (each(surface, of), Scale::Heat, Some(legend))
        }
        View::Phase => {
            let ticks = ["crest", "trough", "crest"].map(str::to_owned);
            (
                each(surface, |f| phases(&surface.wrinkled[f])),
                Scale::Phase,
                Some(legend("Phase", ticks, Scale::Phase)),
            )
        }
        View::Direction => (each(surface, |_| [Scale::Heat.uv(0.0); 3]), Scale::Heat, None),
        View::Expansion => painted(surface, Layer::Expansion),
        View::Painted(layer) => painted(surface, layer),
    }
}

fn legend(title: &str, ticks: [String; 3], colours: Scale) -> Legend {
    Legend { title: title.to_owned(), ticks, colours }
}

/// Smooth faces with these texture coordinates.
fn each(surface: &ViewedSurface<'_>, uvs: impl Fn(usize) -> [Vec2; 3]) -> Vec<[Corner; 3]> {
    let of = |(f, face): (usize, &[Corner; 3])| {
        let uvs = uvs(f);
        let up =
            (face[1].position - face[0].position).cross(&(face[2].position - face[0].position));
        // Renderers turn the normals of faces seen from behind.
        let sign = if up.dot(&(surface.eye - face[0].position)) < 0.0 { -1.0 } else { 1.0 };
        [0, 1, 2].map(|k| {
            let to_viewer =
                (surface.eye - face[k].position).try_normalize(1e-20).unwrap_or_else(Vec3::z);
            let normal = face[k].normal * RELIEF + to_viewer * (sign * (1.0 - RELIEF));
            Corner {
                uv: uvs[k],
                amplitude_m: 0.0,
                normal: normal.try_normalize(1e-6).unwrap_or(face[k].normal),
                ..face[k]
            }
        })
    };
    surface.wrinkled.iter().enumerate().map(of).collect()
}

fn strained(surface: &ViewedSurface<'_>) -> (Vec<[Corner; 3]>, Scale, Option<Legend>) {
    let own: Vec<[f32; 2]>;
    let strain = match surface.strain {
        Some(strain) => strain,
        None => {
            own = surface
                .welded
                .faces
                .iter()
                .map(|face| {
                    principal_strain(
                        &surface.welded.vertices.positions,
                        &surface.posed.positions,
                        face,
                    )
                })
                .collect();
            &own
        }
    };
    let larger = |[low, high]: &[f32; 2]| if low.abs() > high.abs() { *low } else { *high };
    let mut sizes: Vec<f32> = strain.iter().map(|s| larger(s).abs()).collect();
    sizes.sort_by(f32::total_cmp);
    // One bad face shall not take the colours of all others.
    let most = sizes.get(sizes.len() * 98 / 100).copied().unwrap_or(0.0).max(LEAST_STRAIN);
    let of = |f: usize| [Scale::Diverging.uv(0.5 + 0.5 * larger(&strain[f]) / most); 3];
    let percent = |x: f32| format!("{:+.1} %", 100.0 * x);
    let legend = legend("Strain", [percent(-most), "0 %".into(), percent(most)], Scale::Diverging);
    (each(surface, of), Scale::Diverging, Some(legend))
}

fn painted(surface: &ViewedSurface<'_>, layer: Layer) -> (Vec<[Corner; 3]>, Scale, Option<Legend>) {
    let Range { low, high, unit } = layer.range();
    let values: Vec<f32> = surface.layer.iter().map(|x| amount(layer, x)).collect();
    // What one wants to see is what differs from bare cloth.
    let bare = amount(layer, &layer.neutral());
    let most = match layer {
        Layer::Expansion => values.iter().copied().fold(0.1, f32::max),
        _ => high,
    };
    let reversed = bare > low;
    let share = |x: f32| {
        let t = (x - low) / (most - low);
        if reversed { 1.0 - t } else { t }
    };
    let of = |f: usize| {
        surface.welded.faces[f]
            .map(|v| Scale::Heat.uv(values.get(v as usize).map_or(0.0, |&x| share(x))))
    };
    let text = |x: f32| match layer {
        Layer::Expansion => format!("+{:.0} %", 100.0 * x),
        _ => format!("{x:.2}{unit}"),
    };
    let (first, last) = if reversed { (most, low) } else { (low, most) };
    let ticks = [first, 0.5 * (first + last), last].map(text);
    (each(surface, of), Scale::Heat, Some(legend(layer.name(), ticks, Scale::Heat)))
}

/// Turns of the wave of a face's strongest corner at its three corners.
fn phases(face: &[Corner; 3]) -> [Vec2; 3] {
    let strongest =
        face.iter().fold(&face[0], |a, b| if b.amplitude_m > a.amplitude_m { b } else { a });
    face.map(|c| {
        Scale::Phase
            .uv((strongest.phase + strongest.wave.dot(&(c.position - strongest.position))) / TAU)
    })
}

/// Strain (ratio of lengths − 1) of `face` along its principal directions, the lesser first; zeros
/// for faces without an area at rest.
pub fn principal_strain(rest: &[Vec3], posed: &[Vec3], face: &[u32; 3]) -> [f32; 2] {
    let flat = |x: &[Vec3]| {
        let [a, b, c] = face.map(|v| x[v as usize]);
        let (u, v) = (b - a, c - a);
        let length = u.norm();
        let along = if length > 0.0 { u.dot(&v) / length } else { 0.0 };
        Matrix2::new(length, along, 0.0, (v.norm_squared() - along * along).max(0.0).sqrt())
    };
    let Some(inverse) = flat(rest).try_inverse() else { return [0.0; 2] };
    let sizes = (flat(posed) * inverse).singular_values();
    let (a, b) = (sizes[0] - 1.0, sizes[1] - 1.0);
    if a.is_finite() && b.is_finite() { [a.min(b), a.max(b)] } else { [0.0; 2] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strain_is_what_lengths_say() {
        let rest = [Vec3::zeros(), Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.3, 1.0, 0.0)];
        let posed = rest.map(|p| Vec3::new(0.5 * p.x, 0.0, 1.2 * p.y));
        let [low, high] = principal_strain(&rest, &posed, &[0, 1, 2]);
        assert!((low + 0.5).abs() < 1e-5 && (high - 0.2).abs() < 1e-5);
        assert_eq!(principal_strain(&[Vec3::zeros(); 3], &posed, &[0, 1, 2]), [0.0; 2]);
    }
}
