//! Models made here: figure 15's square, a curtain, a zeppelin, a shirt, and a sleeve on a bending
//! arm. Each has a clip.

mod shirt;

use std::f32::consts::{PI, TAU};

use plisse::mesh::panel::{Outline, Panel};
use plisse::{At, Result};

use crate::model::{Channel, Clip, Interpolation, Model, Node, Target};
use crate::{Mat4, Vec2, Vec3};

pub use shirt::shirt;

/// Names of the models that [`by_name`] makes.
pub const NAMES: [&str; 5] = ["square", "curtain", "zeppelin", "shirt", "sleeve"];

/// The model called `name`, one of [`NAMES`]; `None` for any other name.
///
/// # Errors
/// None in practice (of the panels).
pub fn by_name(name: &str) -> Result<Option<Model>> {
    Ok(match name {
        "square" => Some(square()?),
        "curtain" => Some(curtain()?),
        "zeppelin" => Some(zeppelin()),
        "shirt" => Some(shirt()),
        "sleeve" => Some(sleeve()),
        _ => None,
    })
}

/// The irregular square of figure 15, side 1 m, about 148 faces. Clip "contract": its width goes to
/// 98, 75 and 50 %, one second each.
///
/// # Errors
/// None in practice (of the panel).
pub fn square() -> Result<Model> {
    let panel =
        Panel::new(&Outline::Rectangle { width_m: 1.0, height_m: 1.0 }, 0.128, 3).at("square")?;
    let mut model = from_panel("square", &panel);
    let values = [1.0, 0.98, 0.75, 0.5].into_iter().flat_map(|x| [x, 1.0, 1.0]).collect();
    model.clips = vec![clip("contract", Target::Scale(0), vec![0.0, 1.0, 2.0, 3.0], values)];
    Ok(model)
}

/// A curtain of about 92 vertices, 2 m wide and 2.2 m high, held at its top. Clip "draw": its rail
/// is drawn together to half.
///
/// # Errors
/// None in practice (of the panel).
pub fn curtain() -> Result<Model> {
    let panel =
        Panel::new(&Outline::Rectangle { width_m: 2.0, height_m: 2.2 }, 0.267, 5).at("curtain")?;
    let mut model = from_panel("curtain", &panel);
    model.nodes = vec![Node::default(), Node::default()];
    model.node_order = vec![0, 1];
    model.palette_nodes = vec![0, 1];
    model.inverse_binds = vec![Mat4::identity(); 2];
    for v in 0..model.draw.positions.len() {
        let share = 0.5 + 0.5 * model.draw.positions[v].y / 2.2;
        blend(&mut model, v, share);
    }
    model.clips = vec![clip(
        "draw",
        Target::Scale(1),
        vec![0.0, 2.0, 4.0],
        vec![1.0, 1.0, 1.0, 0.5, 1.0, 1.0, 1.0, 1.0, 1.0],
    )];
    Ok(model)
}

/// A zeppelin of 508 vertices, 10 m long and 3 m thick, with a texture seam. Clip "crumple": its
/// nose is pushed in by 3 m.
pub fn zeppelin() -> Model {
    let (rings, around) = (22, 23);
    let ring = |i: usize, s: f32| {
        let along = PI * (i + 1) as f32 / (rings + 1) as f32;
        Vec3::new(
            -5.0 * along.cos(),
            1.5 * along.sin() * (TAU * s).cos(),
            1.5 * along.sin() * (TAU * s).sin(),
        )
    };
    let (mut positions, mut uvs, mut faces) = tube(rings, around, ring);
    for (end, x) in [(0, -5.0), (rings - 1, 5.0)] {
        let row = (end * (around + 1)) as u32;
        for s in 0..around as u32 {
            let tip = positions.len() as u32;
            positions.push(Vec3::new(x, 0.0, 0.0));
            uvs.push(Vec2::new((s as f32 + 0.5) / around as f32, if end == 0 { 0.0 } else { 1.0 }));
            faces.push(if end == 0 {
                [tip, row + s + 1, row + s]
            } else {
                [tip, row + s, row + s + 1]
            });
        }
    }
    let mut model = Model::rigid("zeppelin", positions, uvs, faces);
    model.nodes = vec![Node::default(), Node { parent: Some(0), ..Node::default() }];
    model.node_order = vec![0, 1];
    model.palette_nodes = vec![0, 1];
    model.inverse_binds = vec![Mat4::identity(); 2];
    for v in 0..model.draw.positions.len() {
        let share = ((model.draw.positions[v].x + 2.0) / 6.0).clamp(0.0, 1.0);
        blend(&mut model, v, share);
    }
    model.clips = vec![clip(
        "crumple",
        Target::Translation(1),
        vec![0.0, 1.5, 3.0],
        vec![0.0, 0.0, 0.0, -3.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    )];
    model
}

/// A sleeve, 0.6 m long with a radius of 6 cm, around an arm that bends at the middle; its texture
/// seam runs along it. Clip "bend": to 100 degrees and back in two seconds.
pub fn sleeve() -> Model {
    let (rings, around) = (25, 20);
    let ring = |i: usize, s: f32| {
        Vec3::new(
            0.6 * i as f32 / (rings - 1) as f32,
            0.06 * (TAU * s).cos(),
            0.06 * (TAU * s).sin(),
        )
    };
    let (positions, uvs, faces) = tube(rings, around, ring);
    let mut model = Model::rigid("sleeve", positions, uvs, faces);
    let elbow = Vec3::new(0.3, 0.0, 0.0);
    model.nodes =
        vec![Node::default(), Node { parent: Some(0), translation: elbow, ..Node::default() }];
    model.node_order = vec![0, 1];
    model.palette_nodes = vec![0, 1];
    model.inverse_binds = vec![Mat4::identity(), Mat4::new_translation(&-elbow)];
    for v in 0..model.draw.positions.len() {
        let share = smooth((model.draw.positions[v].x - 0.18) / 0.24);
        blend(&mut model, v, share);
    }
    let times: Vec<f32> = (0..=8).map(|k| 0.25 * k as f32).collect();
    let turn = |t: &f32| 0.5 * 100f32.to_radians() * 0.5 * (1.0 - (PI * t).cos());
    let values = times.iter().flat_map(|t| [0.0, 0.0, turn(t).sin(), turn(t).cos()]).collect();
    model.clips = vec![clip("bend", Target::Rotation(1), times, values)];
    model
}

/// A sheet of `columns` × `rows` vertices (two each at least), 1 m high, for measuring: hangs on
/// two nodes. Clip "press": its free half goes to 60 % of its width in one second.
pub fn sheet(columns: usize, rows: usize) -> Model {
    let (columns, rows) = (columns.max(2), rows.max(2));
    let step = 1.0 / (rows - 1) as f32;
    let place = |i: usize| Vec3::new((i % columns) as f32 * step, (i / columns) as f32 * step, 0.0);
    let positions: Vec<Vec3> = (0..columns * rows).map(place).collect();
    let uvs = positions.iter().map(|p| Vec2::new(p.x, 1.0 - p.y)).collect();
    let quad = |i: usize| {
        let [a, b, c, d] = [i, i + 1, i + columns + 1, i + columns].map(|v| v as u32);
        if (i % columns + i / columns).is_multiple_of(2) {
            [[a, b, c], [a, c, d]]
        } else {
            [[a, b, d], [b, c, d]]
        }
    };
    let corners = (0..(rows - 1) * columns).filter(|i| i % columns + 1 < columns);
    let mut model = Model::rigid("sheet", positions, uvs, corners.flat_map(quad).collect());
    model.nodes = vec![Node::default(), Node::default()];
    model.node_order = vec![0, 1];
    model.palette_nodes = vec![0, 1];
    model.inverse_binds = vec![Mat4::identity(); 2];
    for v in 0..columns * rows {
        let share = model.draw.positions[v].y;
        blend(&mut model, v, share);
    }
    model.clips =
        vec![clip("press", Target::Scale(1), vec![0.0, 1.0], vec![1.0, 1.0, 1.0, 0.6, 1.0, 1.0])];
    model
}

/// `rings` × (`around` + 1) vertices of a tube with a seam where its texture begins; faces look
/// outwards if `ring(i, s)` runs along x with i and around x with s in [0, 1].
fn tube(
    rings: usize,
    around: usize,
    ring: impl Fn(usize, f32) -> Vec3,
) -> (Vec<Vec3>, Vec<Vec2>, Vec<[u32; 3]>) {
    let (mut positions, mut uvs, mut faces) = (Vec::new(), Vec::new(), Vec::new());
    for i in 0..rings {
        for s in 0..=around {
            positions.push(ring(i, (s % around) as f32 / around as f32));
            uvs.push(Vec2::new(s as f32 / around as f32, i as f32 / (rings - 1) as f32));
        }
    }
    let row = around + 1;
    for i in 0..rings - 1 {
        for s in 0..around {
            let corners = [i * row + s, (i + 1) * row + s, (i + 1) * row + s + 1, i * row + s + 1]
                .map(|v| v as u32);
            // Diagonals alternate, so that the mesh prefers no turn.
            faces.extend(halves(corners, (i + s) % 2 == 0));
        }
    }
    (positions, uvs, faces)
}

/// Two faces of a quad whose corners run clockwise seen from outside; `even` chooses the diagonal.
fn halves([a, b, c, d]: [u32; 4], even: bool) -> [[u32; 3]; 2] {
    if even { [[a, d, c], [a, c, b]] } else { [[a, d, b], [b, d, c]] }
}

/// 0 below 0, 1 above 1, smooth between.
fn smooth(x: f32) -> f32 {
    let s = x.clamp(0.0, 1.0);
    s * s * (3.0 - 2.0 * s)
}

fn from_panel(name: &str, panel: &Panel) -> Model {
    let positions: Vec<Vec3> =
        panel.positions.iter().map(|p| Vec3::new(p.x as f32, p.y as f32, 0.0)).collect();
    let low = positions.iter().fold(Vec3::repeat(f32::INFINITY), |a, p| a.inf(p));
    let size = positions.iter().fold(0f32, |a, p| a.max((p - low).max()));
    let uvs =
        positions.iter().map(|p| Vec2::new((p.x - low.x) / size, (p.y - low.y) / size)).collect();
    let faces = panel.faces.iter().map(|f| f.map(|v| v as u32)).collect();
    Model::rigid(name, positions, uvs, faces)
}

/// Hangs vertex `v` on palette entry 1 with weight `share` and on entry 0 with the rest.
fn blend(model: &mut Model, v: usize, share: f32) {
    model.draw.joints[v][..2].copy_from_slice(&[0, 1]);
    model.draw.weights[v][..2].copy_from_slice(&[1.0 - share, share]);
}

fn clip(name: &str, target: Target, times: Vec<f32>, values: Vec<f32>) -> Clip {
    Clip {
        name: name.to_owned(),
        channels: vec![Channel { target, interpolation: Interpolation::Linear, times, values }],
    }
}
