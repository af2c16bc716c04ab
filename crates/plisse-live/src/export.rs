//! Export of wrinkled geometry to files that ordinary viewers open: one frame as a still, or many
//! as morph targets of the first, which an animation shows one after the other.

use std::io::{self, Write};

use plisse::{Error, Result};
use serde_json::json;

use crate::Vec3;
use crate::fine_mesh::{FineMesh, Lattice};
use crate::glb_out::{Document, Glb, invalid, mesh_attributes};
use crate::model::Model;

/// Largest size of a file (bytes), for viewers that read it whole.
pub const MOST_BYTES: u64 = 512 << 20;

/// The way from frame to frame of the animation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameInterpolation {
    /// Each frame stands until the next.
    Step,
    /// Each frame moves into the next.
    Linear,
}

/// Number of frames a second below which steps between frames would be seen.
const SMOOTH_FPS: f64 = 24.0;

impl FrameInterpolation {
    /// Linear for animations with few frames a second, steps for others.
    pub fn for_fps(fps: f64) -> Self {
        if fps < SMOOTH_FPS { Self::Linear } else { Self::Step }
    }
}

/// Refuses frames that would make a file beyond [`MOST_BYTES`], before anything long begins.
///
/// # Errors
/// [`Error::Value`] about the frames (or the parts, for one frame alone) with as many as would do.
pub fn check_size(model: &Model, parts: usize, frames: usize) -> Result<()> {
    let vertices = Lattice::new(&model.faces, model.draw.positions.len(), 1)
        .count_at(parts, model.faces.len()) as u64;
    let fixed = vertices * 32 + (model.faces.len() * parts * parts) as u64 * 12;
    let frame = vertices * 24;
    let count = frames as u64;
    if fixed + frame * (count - count.min(1)) + 4 * count * count <= MOST_BYTES {
        return Ok(());
    }
    let most = (1..=count).rev().find(|n| fixed + frame * (n - 1) + 4 * n * n <= MOST_BYTES);
    Err(match most {
        Some(most) => Error::value(
            "frames",
            format!(
                "{frames} frames of {vertices} vertices make more than 512 MB; give {most} or \
                 fewer, or divide faces less"
            ),
        ),
        None => Error::value(
            "parts",
            format!(
                "faces divided into {parts}² parts make {vertices} vertices, more than 512 MB; \
                 give fewer parts"
            ),
        ),
    })
}

/// Writes one frame as binary glTF, with the base colour image of `model`.
///
/// # Errors
/// Any error of `out`; [`io::ErrorKind::InvalidData`] for a number that is not finite.
pub fn write_still<W: Write + ?Sized>(
    out: &mut W,
    model: &Model,
    fine: &FineMesh,
) -> io::Result<()> {
    let mut glb = Glb::default();
    let attributes = mesh_attributes(&mut glb, fine)?;
    let material = glb.material(model.base_colour.as_deref());
    glb.write(out, Document { primitive: attributes, material, ..Document::default() })
}

/// Writes `frames` as binary glTF: the first as the mesh, each further one as a morph target, and
/// an animation "wrinkles" that shows one after the other, `fps` a second.
///
/// # Errors
/// As [`write_still`]; also [`io::ErrorKind::InvalidData`] without frames, for frames of different
/// models, and for an `fps` that is not above 0.
pub fn write_sequence<W: Write + ?Sized>(
    out: &mut W,
    model: &Model,
    frames: &[FineMesh],
    fps: f32,
    between: FrameInterpolation,
) -> io::Result<()> {
    let Some((first, others)) = frames.split_first() else {
        return Err(invalid("there are no frames to write".into()));
    };
    if others.is_empty() {
        return write_still(out, model, first);
    }
    if !(fps > 0.0 && fps.is_finite()) {
        return Err(invalid(format!(
            "{fps} frames a second cannot be played; give a number above 0"
        )));
    }
    if let Some(k) = others
        .iter()
        .position(|f| f.faces != first.faces || f.positions.len() != first.positions.len())
    {
        return Err(invalid(format!("frame {} has other vertices than the first", k + 1)));
    }
    let mut glb = Glb::default();
    let mut attributes = mesh_attributes(&mut glb, first)?;
    let mut targets = Vec::new();
    for frame in others {
        let shift =
            |a: &[Vec3], b: &[Vec3]| -> Vec<Vec3> { a.iter().zip(b).map(|(a, b)| a - b).collect() };
        let position =
            glb.vectors(&shift(&frame.positions, &first.positions), true, "a morph target")?;
        let normal =
            glb.vectors(&shift(&frame.normals, &first.normals), false, "a morph target")?;
        targets.push(json!({"POSITION": position, "NORMAL": normal}));
    }
    let times: Vec<f32> = (0..frames.len()).map(|k| k as f32 / fps).collect();
    let weights: Vec<f32> = (0..frames.len())
        .flat_map(|k| (1..frames.len()).map(move |target| if target == k { 1.0 } else { 0.0 }))
        .collect();
    let (input, output) = (glb.numbers(&times, true)?, glb.numbers(&weights, false)?);
    let interpolation = match between {
        FrameInterpolation::Step => "STEP",
        FrameInterpolation::Linear => "LINEAR",
    };
    attributes["targets"] = json!(targets);
    let material = glb.material(model.base_colour.as_deref());
    let animation = json!({"animations": [{
        "name": "wrinkles",
        "samplers": [{"input": input, "output": output, "interpolation": interpolation}],
        "channels": [{"sampler": 0, "target": {"node": 0, "path": "weights"}}],
    }]});
    let mesh = json!({"weights": vec![0.0; others.len()]});
    glb.write(out, Document { primitive: attributes, material, mesh, document: animation })
}
