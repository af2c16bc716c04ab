//! Maps of one frame by the library's baker, in the model's own texture space.

use plisse::bake::{Baked, Options, Sample, Surface};
use plisse::{Error, Result};

use crate::gather::gather;
use crate::live::Frame;
use crate::model::Model;
use crate::profile::Profile;
use crate::render::FaceWaves;
use crate::weld::WeldedMesh;

/// `[F]` the faces of `model` as they are drawn in `frame`: draw vertices with the waves of their
/// welded vertices.
pub fn faces(model: &Model, welded: &WeldedMesh, frame: &Frame<'_>) -> Vec<FaceWaves> {
    gather(model, welded, frame).into_iter().map(FaceWaves::new).collect()
}

/// Height and normal maps of `model` in `frame`, eqs. 5, 7 and 8.
///
/// # Errors
/// [`Error::Value`] for a model without texture coordinates; as [`plisse::bake::bake`].
pub fn bake(
    model: &Model,
    welded: &WeldedMesh,
    frame: &Frame<'_>,
    profile: &Profile,
    options: &Options,
) -> Result<Baked> {
    check(model)?;
    let wave_faces = faces(model, welded, frame);
    let draw = frame.drawn;
    let wide =
        |x: &crate::Vec3| plisse::mesh::Vec3::new(f64::from(x.x), f64::from(x.y), f64::from(x.z));
    let positions: Vec<_> = draw.positions.iter().map(wide).collect();
    let normals: Vec<_> = draw.normals.iter().map(wide).collect();
    let corners: Vec<[usize; 3]> = model.faces.iter().map(|f| f.map(|v| v as usize)).collect();
    // glTF's v points down.
    let uvs: Vec<_> = model
        .uvs
        .iter()
        .map(|uv| plisse::mesh::Vec2::new(f64::from(uv.x), 1.0 - f64::from(uv.y)))
        .collect();
    let surface = Surface {
        positions: &positions,
        normals: &normals,
        faces: &corners,
        uvs: &uvs,
        uv_faces: &corners,
    };
    let sample = |f: usize, weights: [f64; 3]| {
        let point = wave_faces[f].at(weights.map(|w| w as f32), profile);
        Sample { height_m: f64::from(point.height_m), gradient: wide(&point.gradient) }
    };
    plisse::bake::bake(&surface, sample, options)
}

/// Checks that `model` has texture coordinates; models from files without any have zeros.
///
/// # Errors
/// [`Error::Value`] if it has none.
pub fn check(model: &Model) -> Result<()> {
    if !model.has_uvs() {
        let message =
            "there are none to bake into; unwrap the model (\"UV unwrap\") and export it again";
        return Err(Error::value(format!("{}, texture coordinates", model.name), message));
    }
    Ok(())
}

/// The largest height (m) that waves of these wavelengths (m) can have: W/4 times the profile's
/// largest value.
pub fn largest_height_m(wavelength_m: &[f32], profile: &Profile) -> f32 {
    let most = |list: &[f32]| list.iter().fold(0f32, |a, x| a.max(x.abs()));
    0.25 * most(wavelength_m) * most(&profile.f)
}
