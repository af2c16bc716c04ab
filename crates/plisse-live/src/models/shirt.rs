//! A long-sleeved shirt on two arms: a torso tube with two armholes, a sleeve sewn to each, all one
//! surface.

use std::f32::consts::{PI, TAU};

use super::{halves, smooth};
use crate::model::{Channel, Clip, Interpolation, Model, Node, Target};
use crate::{Mat4, Vec2, Vec3};

/// Vertices around the torso.
const AROUND: usize = 20;
/// Height, half width and half depth (m) of the torso's rings, hem first; the last is the neck.
const RINGS: [[f32; 3]; 8] = [
    [0.0, 0.2, 0.125],
    [0.12, 0.195, 0.12],
    [0.24, 0.195, 0.12],
    [0.34, 0.2, 0.125],
    [0.4, 0.205, 0.125],
    [0.46, 0.2, 0.12],
    [0.515, 0.175, 0.1],
    [0.565, 0.08, 0.075],
];
/// An armhole is as many columns wide and rows high.
const HOLE: [usize; 2] = [4, 3];
/// The row at which armholes begin, and the first column of each: at +x, at −x.
const HOLE_ROW: usize = 3;
const HOLE_COLUMNS: [usize; 2] = [13, 3];
/// Vertices around a sleeve, as many as around an armhole.
const SLEEVE_AROUND: usize = 2 * (HOLE[0] + HOLE[1]);
/// Rings of a sleeve beyond the armhole, 5 cm apart; the first 9 cm from its middle, clear of the
/// bulge of the torso.
const SLEEVE_RINGS: usize = 11;
/// The elbow is so far from the shoulder (m).
const UPPER_ARM_M: f32 = 0.3;

/// A long-sleeved shirt of 456 vertices, 0.57 m high, with texture seams at the back, around the
/// armholes and under the arms. Clip "bend": both arms are lifted by 40 degrees, bend to 100
/// degrees at the elbows (after one second), and sink by 40 degrees, which crushes the armpits; two
/// seconds.
pub fn shirt() -> Model {
    let (mut positions, mut uvs, mut faces) = (Vec::new(), Vec::new(), Vec::new());
    let inside = |row: usize, column: usize| {
        (HOLE_ROW + 1..HOLE_ROW + HOLE[1]).contains(&row)
            && HOLE_COLUMNS.iter().any(|&c| (c + 1..c + HOLE[0]).contains(&column))
    };
    let cut = |row: usize, column: usize| {
        (HOLE_ROW..HOLE_ROW + HOLE[1]).contains(&row)
            && HOLE_COLUMNS.iter().any(|&c| (c..c + HOLE[0]).contains(&column))
    };
    let torso = |row: usize, column: usize| {
        let ([y, width, depth], angle) =
            (RINGS[row], 0.5 * PI + TAU * (column % AROUND) as f32 / AROUND as f32);
        Vec3::new(width * angle.cos(), y, -depth * angle.sin())
    };
    let mut number = vec![[0u32; AROUND + 1]; RINGS.len()];
    for row in 0..RINGS.len() {
        for column in 0..=AROUND {
            if !inside(row, column) {
                number[row][column] = positions.len() as u32;
                positions.push(torso(row, column));
                let height = RINGS[row][0] / RINGS[RINGS.len() - 1][0];
                uvs.push(Vec2::new(
                    0.02 + 0.56 * column as f32 / AROUND as f32,
                    0.98 - 0.96 * height,
                ));
            }
        }
    }
    for row in 0..RINGS.len() - 1 {
        for column in (0..AROUND).filter(|&column| !cut(row, column)) {
            let (low, high) = (&number[row], &number[row + 1]);
            faces.extend(halves(
                [low[column], high[column], high[column + 1], low[column + 1]],
                (row + column).is_multiple_of(2),
            ));
        }
    }
    let arms = [1.0, -1.0].map(Arm::new);
    for (k, arm) in arms.iter().enumerate() {
        let first = positions.len() as u32;
        let hole: Vec<Vec3> =
            armhole(HOLE_COLUMNS[k]).iter().map(|&[row, column]| torso(row, column)).collect();
        for ring in 0..=SLEEVE_RINGS {
            for s in 0..=SLEEVE_AROUND {
                positions.push(arm.sleeve(ring, s % SLEEVE_AROUND, &hole));
                let along = ring as f32 / SLEEVE_RINGS as f32;
                uvs.push(Vec2::new(
                    0.62 + 0.19 * k as f32 + 0.17 * s as f32 / SLEEVE_AROUND as f32,
                    0.02 + 0.66 * along,
                ));
            }
        }
        let at = |ring: usize, s: usize| first + (ring * (SLEEVE_AROUND + 1) + s) as u32;
        for ring in 0..SLEEVE_RINGS {
            for s in 0..SLEEVE_AROUND {
                let corners = [at(ring, s), at(ring + 1, s), at(ring + 1, s + 1), at(ring, s + 1)];
                faces.extend(halves(corners, (ring + s).is_multiple_of(2)));
            }
        }
    }
    let mut model = Model::rigid("shirt", positions, uvs, faces);
    rig(&mut model, &arms);
    model
}

/// Row and column of the vertices around the armhole that begins at `first` column, from the armpit
/// on, clockwise from outside.
fn armhole(first: usize) -> Vec<[usize; 2]> {
    let ([width, height], middle) = (HOLE, HOLE[0] / 2);
    let lower = (middle..width).map(|c| [0, c]);
    let back = (0..height).map(|r| [r, width]);
    let upper = (1..=width).rev().map(|c| [height, c]);
    let front = (1..=height).rev().map(|r| [r, 0]);
    let last = (0..middle).map(|c| [0, c]);
    lower
        .chain(back)
        .chain(upper)
        .chain(front)
        .chain(last)
        .map(|[r, c]| [HOLE_ROW + r, first + c])
        .collect()
}

/// An arm in the rest pose, 5 degrees below the horizontal.
struct Arm {
    /// +1 at +x, −1 at −x.
    side: f32,
    shoulder: Vec3,
    /// Unit vector from the shoulder to the hand.
    along: Vec3,
}

impl Arm {
    fn new(side: f32) -> Self {
        let (sin, cos) = 5f32.to_radians().sin_cos();
        Self {
            side,
            shoulder: Vec3::new(side * 0.17, 0.43, 0.0),
            along: Vec3::new(side * cos, -sin, 0.0),
        }
    }

    /// Vertex `s` of sleeve ring `ring`; ring 0 is the armhole `hole`, ring 1 lies half way to the
    /// round cross-section.
    fn sleeve(&self, ring: usize, s: usize, hole: &[Vec3]) -> Vec3 {
        if ring == 0 {
            return hole[s];
        }
        let centre = hole.iter().sum::<Vec3>() / hole.len() as f32
            + self.along * (0.04 + 0.05 * ring as f32);
        let radius = 0.078 - 0.028 * ring as f32 / SLEEVE_RINGS as f32;
        let (up, back) =
            (Vec3::z().cross(&self.along) * self.side, Vec3::new(0.0, 0.0, -self.side));
        let (sin, cos) = (TAU * s as f32 / SLEEVE_AROUND as f32).sin_cos();
        let round = centre + (back * sin - up * cos) * radius;
        if ring > 1 {
            return round;
        }
        let from_hole = hole[s] - hole.iter().sum::<Vec3>() / hole.len() as f32;
        0.5 * (round + centre + from_hole - self.along * from_hole.dot(&self.along))
    }

    /// Shares of upper arm and forearm in the motion of a vertex at `x`.
    fn shares(&self, x: &Vec3) -> [f32; 2] {
        let from = x - self.shoulder;
        let t = from.dot(&self.along);
        let distance = (from - self.along * t).norm();
        let arm = smooth((t + 0.06) / 0.16) * (1.0 - smooth((distance - 0.08) / 0.1));
        let fore = arm * smooth((t - UPPER_ARM_M + 0.13) / 0.26);
        [arm - fore, fore]
    }
}

/// Nodes (chest, then upper arm and forearm at +x, at −x), weights and the clip.
fn rig(model: &mut Model, arms: &[Arm; 2]) {
    model.nodes = vec![Node::default()];
    model.inverse_binds = vec![Mat4::identity()];
    let times: Vec<f32> = (0..=16).map(|k| 0.125 * k as f32).collect();
    let mut channels = Vec::new();
    for arm in arms {
        let upper = model.nodes.len();
        let elbow = arm.along * UPPER_ARM_M;
        model.nodes.push(Node { parent: Some(0), translation: arm.shoulder, ..Node::default() });
        model.nodes.push(Node { parent: Some(upper), translation: elbow, ..Node::default() });
        model.inverse_binds.push(Mat4::new_translation(&-arm.shoulder));
        model.inverse_binds.push(Mat4::new_translation(&-(arm.shoulder + elbow)));
        let mut turn = |node: usize, axis: Vec3, angle: fn(f32) -> f32| {
            let key = |&t: &f32| {
                let (sin, cos) = (0.5 * angle(t).to_radians()).sin_cos();
                [axis.x * sin, axis.y * sin, axis.z * sin, cos]
            };
            let (target, values) = (Target::Rotation(node), times.iter().flat_map(key).collect());
            channels.push(Channel {
                target,
                interpolation: Interpolation::Linear,
                times: times.clone(),
                values,
            });
        };
        turn(upper, Vec3::z() * arm.side, |t| 40.0 * (PI * t).sin());
        turn(upper + 1, arm.along.cross(&Vec3::z()), |t| 50.0 * (1.0 - (PI * t).cos()));
    }
    model.node_order = (0..model.nodes.len()).collect();
    model.palette_nodes = model.node_order.clone();
    for v in 0..model.draw.positions.len() {
        let shares = [&arms[0], &arms[1]].map(|arm| arm.shares(&model.draw.positions[v]));
        let moved: f32 = shares.iter().flatten().sum();
        let list = [1.0 - moved, shares[0][0], shares[0][1], shares[1][0], shares[1][1]];
        for (k, &share) in list.iter().enumerate() {
            model.draw.joints[v][k] = if share > 0.0 { k as u16 } else { 0 };
            model.draw.weights[v][k] = share.max(0.0);
        }
    }
    model.clips = vec![Clip { name: "bend".to_owned(), channels }];
}
