//! The files that a run leaves.

use plisse::Result;
use plisse::io::staged::OutputFolder;
use plisse::mesh::{Up, Vec3};
use plisse::obstacle::Obstacle;
use plisse::picture::{Camera, Image, Paint, PanelView, Subject, draw_among};
use plisse::wrinkles::{PosedField, WrinkledSurface};
use serde::Serialize;

use crate::terminal;

/// Colours of the wrinkled surface and of what lies under it in pictures (sRGB).
pub(crate) const CLOTH_SRGB: [u8; 3] = [222, 166, 148];
pub(crate) const BASE_SRGB: [u8; 3] = [206, 212, 220];

/// Size of picture.png (pixels).
const PICTURE_SIZE: (usize, usize) = (1600, 1200);
/// Size of the pictures of frames (pixels).
const FRAME_SIZE: (usize, usize) = (800, 600);

/// Writes `value` as `name`, a JSON file.
pub(crate) fn write_json(
    folder: &mut OutputFolder,
    name: &str,
    value: &impl Serialize,
) -> Result<()> {
    folder.write(name, |out| {
        serde_json::to_writer_pretty(&mut *out, value)?;
        out.write_all(b"\n")
    })
}

/// Writes report.json, lets all files appear, and prints `table` with their folder below.
pub(crate) fn finish(
    mut folder: OutputFolder,
    report: &impl Serialize,
    mut table: String,
) -> Result<()> {
    write_json(&mut folder, "report.json", report)?;
    let paths = folder.commit()?;
    if let Some(parent) = paths.first().and_then(|p| p.parent()) {
        table += &format!("  written to               {}\n", parent.display());
    }
    terminal::print(&table);
    Ok(())
}

/// The bodies of a scene as one mesh, as far as they are around `pose`.
fn bodies_around(pose: &[Vec3], obstacles: &[Obstacle]) -> (Vec<Vec3>, Vec<[usize; 3]>) {
    let (low, high) =
        pose.iter().fold((pose[0], pose[0]), |(low, high), p| (low.inf(p), high.sup(p)));
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    for obstacle in obstacles {
        let (more, corners) = obstacle.surface(&low, &high);
        let first = positions.len();
        positions.extend(more);
        faces.extend(corners.into_iter().map(|face| face.map(|v| first + v)));
    }
    (positions, faces)
}

/// Four panels among the scene's bodies, seen from where the pose shows best.
pub(crate) fn draw_panels(
    panels: &[PanelView; 4],
    pose: &[Vec3],
    up: Up,
    obstacles: &[Obstacle],
) -> Image {
    draw_panels_at(panels, pose, up, obstacles, PICTURE_SIZE)
}

/// As [`draw_panels`], `size` pixels large.
pub(crate) fn draw_panels_at(
    panels: &[PanelView; 4],
    pose: &[Vec3],
    up: Up,
    obstacles: &[Obstacle],
    size: (usize, usize),
) -> Image {
    let bodies = bodies_around(pose, obstacles);
    draw_among(
        panels,
        Subject { positions: &bodies.0, faces: &bodies.1 },
        &Camera::automatic(pose, up),
        size,
    )
}

/// A pose (`[V]`, m) and its faces.
pub(crate) type Frame = (Vec<Vec3>, Vec<[usize; 3]>);

/// Pictures of one surface in several poses among the scene's bodies, 800 × 600 pixels each.
pub(crate) fn draw_frames(frames: &[Frame], camera: &Camera, obstacles: &[Obstacle]) -> Vec<Image> {
    let Some((last, _)) = frames.last() else { return Vec::new() };
    let bodies = bodies_around(last, obstacles);
    let poses: Vec<Subject<'_>> =
        frames.iter().map(|(positions, faces)| Subject { positions, faces }).collect();
    let paint = Paint::Plain { colour: CLOTH_SRGB, wireframe: false };
    plisse::picture::draw_frames(
        &poses,
        paint,
        Subject { positions: &bodies.0, faces: &bodies.1 },
        camera,
        FRAME_SIZE,
    )
}

/// As [`draw_panels`], seen by this camera.
pub(crate) fn draw_panels_by(
    panels: &[PanelView; 4],
    pose: &[Vec3],
    camera: &Camera,
    obstacles: &[Obstacle],
) -> Image {
    let bodies = bodies_around(pose, obstacles);
    draw_among(panels, Subject { positions: &bodies.0, faces: &bodies.1 }, camera, PICTURE_SIZE)
}

/// The four panels of figure 5 of [Chen 2021]: base surface, amplitude, phase, wrinkled surface.
pub(crate) fn picture(posed: &PosedField<'_>, surface: &WrinkledSurface, up: Up) -> Image {
    let fine = &surface.fine;
    let base = Subject { positions: &fine.base, faces: &fine.topology.faces };
    let millimetres: Vec<f64> = fine.amplitude_m.iter().map(|a| a * 1e3).collect();
    let phase = fine.visible_phase();
    let panels = [
        PanelView {
            title: "Base surface",
            subject: Subject { positions: posed.pose, faces: &posed.sheet.topology.faces },
            paint: Paint::Plain { colour: BASE_SRGB, wireframe: true },
        },
        PanelView {
            title: "Amplitude",
            subject: base,
            paint: Paint::Scalar {
                values: &millimetres,
                maximum: posed.field.largest_amplitude_m() * 1e3,
                unit: "mm",
            },
        },
        PanelView { title: "Phase", subject: base, paint: Paint::Phase { corners: &phase } },
        PanelView {
            title: "Wrinkled surface",
            subject: Subject { positions: &surface.positions, faces: &fine.topology.faces },
            paint: Paint::Plain { colour: CLOTH_SRGB, wireframe: false },
        },
    ];
    draw_panels(&panels, posed.pose, up, posed.obstacles)
}
