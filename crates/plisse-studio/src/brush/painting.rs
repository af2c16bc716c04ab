//! Painting of dabs on a layer. A stroke goes no farther than its brush's strength, however often
//! it passes over a vertex: each vertex keeps the largest weight of all dabs, and their mean
//! direction, which has no sign.

use nalgebra::{Matrix3, Rotation3};
use plisse::mesh::reach::Reach;
use plisse_live::Vec3;
use plisse_live::weld::WeldedMesh;

use super::pick::{Hit, nearest_among};
use super::reach::VertexFaces;
use crate::document::history::VertexChange;
use crate::document::layers::LONGEST_BIAS;
use crate::document::stroke::Dab;
use crate::document::subject::bounds;
use crate::document::{Action, Brush, Change, Heading, Layer, Layers, Mirror, Stroke};

/// Largest distance of a mirrored point from the surface at which it gets a dab, as a share of the
/// model's size.
const MIRROR_TOLERANCE: f32 = 0.02;

/// The mesh and the pose that are painted on.
#[derive(Clone, Copy)]
pub struct Canvas<'a> {
    /// The mesh.
    pub welded: &'a WeldedMesh,
    /// The faces around its vertices.
    pub vertex_faces: &'a VertexFaces,
    /// `[U]` posed positions (m).
    pub posed: &'a [Vec3],
}

impl Canvas<'_> {
    /// `direction` (posed, along face `f`) in the rest pose, of any length; zero where the face has
    /// no area.
    pub fn to_rest(&self, f: usize, direction: &Vec3) -> Vec3 {
        let [a, b, c] = self.welded.faces[f].map(|v| v as usize);
        let (u, v) = (self.posed[b] - self.posed[a], self.posed[c] - self.posed[a]);
        let (uu, uv, vv) = (u.dot(&u), u.dot(&v), v.dot(&v));
        let determinant = uu * vv - uv * uv;
        if determinant.is_nan() || determinant <= 0.0 {
            return Vec3::zeros();
        }
        let (du, dv) = (direction.dot(&u), direction.dot(&v));
        let x = &self.welded.vertices.positions;
        ((x[b] - x[a]) * (vv * du - uv * dv) + (x[c] - x[a]) * (uu * dv - uv * du)) / determinant
    }

    /// Unit normal of face `f` at rest.
    fn rest_normal(&self, f: usize) -> Vec3 {
        let [a, b, c] = self.welded.faces[f].map(|v| self.welded.vertices.positions[v as usize]);
        (b - a).cross(&(c - a)).try_normalize(1e-30).unwrap_or_else(Vec3::z)
    }
}

/// The effect of a stroke on one vertex so far.
#[derive(Clone, Copy)]
struct Touch {
    before: [f32; 4],
    /// Largest weight.
    weight: f32,
    /// Σ w d⊗d over the dabs.
    directions: Matrix3<f32>,
    /// True if it changed since the layer was written last.
    is_new: bool,
}

/// A stroke that is being painted.
pub struct Painting {
    brush: Brush,
    dabs: Vec<Dab>,
    /// `[U]` index into `touches`, or [`NONE`].
    slots: Vec<u32>,
    reach: Reach,
    /// Lowest and highest corner of the rest pose (m), once needed.
    rest_box: Option<[Vec3; 2]>,
    touches: Vec<(u32, Touch)>,
}

const NONE: u32 = u32::MAX;

impl Painting {
    /// A stroke with `brush` on a model of `count` welded vertices, before its first dab.
    pub fn new(brush: Brush, count: usize) -> Self {
        Self {
            brush,
            dabs: Vec::new(),
            slots: vec![NONE; count],
            reach: Reach::new(count),
            rest_box: None,
            touches: Vec::new(),
        }
    }

    /// The brush.
    pub fn brush(&self) -> &Brush {
        &self.brush
    }

    /// Puts a dab at `hit` of the posed mesh; [`Painting::write`] paints it. `course` (posed, any
    /// length) is the direction of the stroke there, or that of the crests for [`Heading::Screen`].
    pub fn dab(&mut self, canvas: &Canvas<'_>, layers: &Layers, hit: &Hit, course: &Vec3) {
        self.dabs.push(Dab { face: hit.face as u32, weights: hit.weights });
        let course = canvas.to_rest(hit.face, course);
        self.spread(canvas, layers, hit, course);
        let axis = match self.brush.mirror {
            Mirror::Off => return,
            Mirror::X => 0,
            Mirror::Y => 1,
            Mirror::Z => 2,
        };
        let (x, faces) = (&canvas.welded.vertices.positions, &canvas.welded.faces);
        let [low, high] = *self.rest_box.get_or_insert_with(|| bounds(x));
        let mut place = Hit::on(hit.face, hit.weights, x, faces).position;
        place[axis] = low[axis] + high[axis] - place[axis];
        let mut course = course;
        course[axis] = -course[axis];
        // Around the nearest vertex and its neighbours.
        let far = |v: &u32| (x[*v as usize] - place).norm_squared();
        let Some(middle) = (0..x.len() as u32).min_by(|a, b| far(a).total_cmp(&far(b))) else {
            return;
        };
        let ring = canvas.welded.around(middle as usize).iter().chain([&middle]);
        let some = ring.flat_map(|&v| canvas.vertex_faces.around(v).iter().copied());
        if let Some(other) = nearest_among(x, faces, some, &place)
            .filter(|h| h.distance_m <= MIRROR_TOLERANCE * (high - low).norm())
        {
            let posed = Hit::on(other.face, other.weights, canvas.posed, faces);
            self.spread(canvas, layers, &posed, course);
        }
    }

    /// Gives every vertex within reach its weight. `course` is in the rest pose.
    fn spread(&mut self, canvas: &Canvas<'_>, layers: &Layers, hit: &Hit, course: Vec3) {
        let welded = canvas.welded;
        let normal = canvas.rest_normal(hit.face);
        let flat = course - normal * normal.dot(&course);
        let unit = flat.try_normalize(1e-20).unwrap_or_else(Vec3::zeros);
        // A bias points across the crests; growth points along the heading.
        let across = (self.brush.layer == Layer::Wrinkles)
            == matches!(self.brush.heading, Heading::AlongStroke | Heading::Screen);
        let direction = if across { normal.cross(&unit) } else { unit };
        let layer = self.brush.layer;
        let values = layers.of(layer);
        let radius_m = self.brush.radius_m;
        let reached = canvas.vertex_faces.reach(canvas.posed, hit, radius_m, &mut self.reach);
        for (v, distance_m) in reached {
            let weight = self.brush.falloff.weight(distance_m / self.brush.radius_m);
            if weight <= 0.0 {
                continue;
            }
            let slot = &mut self.slots[v as usize];
            if *slot == NONE {
                *slot = self.touches.len() as u32;
                let before = values[v as usize];
                self.touches.push((
                    v,
                    Touch { before, weight: 0.0, directions: Matrix3::zeros(), is_new: true },
                ));
            }
            let touch = &mut self.touches[*slot as usize].1;
            let up = welded.vertices.normals[v as usize];
            let there = Rotation3::rotation_between(&normal, &up)
                .map_or(direction, |turn| turn * direction);
            let there =
                (there - up * up.dot(&there)).try_normalize(1e-6).unwrap_or_else(Vec3::zeros);
            touch.weight = touch.weight.max(weight);
            touch.directions += there * there.transpose() * weight;
            touch.is_new = true;
        }
    }

    /// Writes the dabs since the last call to the layer.
    pub fn write(&mut self, canvas: &Canvas<'_>, layers: &mut Layers) {
        let values = layers.of_mut(self.brush.layer);
        for (v, touch) in self.touches.iter_mut().filter(|(_, touch)| touch.is_new) {
            touch.is_new = false;
            values[*v as usize] =
                painted(&self.brush, touch, &canvas.welded.vertices.normals[*v as usize]);
        }
    }

    /// Ends the stroke, after it was written; its change, for the history.
    pub fn end(self, layers: &Layers) -> Change {
        let values = layers.of(self.brush.layer);
        let bits = |x: &[f32; 4]| x.map(f32::to_bits);
        let changed = self.touches.iter().map(|(v, touch)| VertexChange {
            vertex: *v,
            before: touch.before,
            after: values[*v as usize],
        });
        let mut vertices: Vec<_> = changed.filter(|c| bits(&c.before) != bits(&c.after)).collect();
        vertices.sort_unstable_by_key(|c| c.vertex);
        Change {
            layer: self.brush.layer,
            stroke: Stroke { brush: self.brush, dabs: self.dabs },
            vertices,
        }
    }
}

/// The numbers of a vertex with this unit normal after `touch`.
fn painted(brush: &Brush, touch: &Touch, normal: &Vec3) -> [f32; 4] {
    let share = (touch.weight * brush.strength).clamp(0.0, 1.0);
    let before = touch.before;
    let neutral = brush.layer.neutral();
    let blend = |to: f32, k: usize| before[k] + (to - before[k]) * share;
    let erase = brush.action == Action::Erase;
    match brush.layer {
        Layer::Wrinkles | Layer::Expansion => {
            let isotropic = brush.heading == Heading::Isotropic;
            let old = Vec3::new(before[0], before[1], before[2]);
            if isotropic && !erase {
                return [old.x, old.y, old.z, blend(brush.value, 3)];
            }
            // Lengths of wrinkles count squared: p shortens by |p|².
            let squared = brush.layer == Layer::Wrinkles;
            let weigh = |length: f32| if squared { length * length } else { length };
            let of = |p: &Vec3| {
                p.try_normalize(1e-20)
                    .map_or_else(Matrix3::zeros, |d| d * d.transpose() * weigh(p.norm()))
            };
            let wanted = match principal(&touch.directions, normal) {
                Some((_, d)) if !erase => d * d.transpose() * weigh(brush.value),
                _ => Matrix3::zeros(),
            };
            let vector = principal(&(of(&old) * (1.0 - share) + wanted * share), normal)
                .map_or_else(Vec3::zeros, |(most, d)| {
                    let length = if squared {
                        most.max(0.0).sqrt().min(LONGEST_BIAS)
                    } else {
                        most.max(0.0)
                    };
                    // Its sign has no meaning; the old one is kept for the eye.
                    let d = if d.dot(&old) < 0.0 { -d } else { d };
                    d * length
                });
            [vector.x, vector.y, vector.z, if erase { blend(0.0, 3) } else { before[3] }]
        }
        _ => [blend(if erase { neutral[0] } else { brush.value }, 0), 0.0, 0.0, 0.0],
    }
}

/// Largest eigenvalue of a symmetric matrix that is zero along `normal`, and its unit eigenvector;
/// `None` for zero.
fn principal(m: &Matrix3<f32>, normal: &Vec3) -> Option<(f32, Vec3)> {
    let axis = if normal.x.abs() < 0.7 { Vec3::x() } else { Vec3::y() };
    let t = normal.cross(&axis).try_normalize(1e-6)?;
    let b = normal.cross(&t);
    let (tt, bb, tb) = (t.dot(&(m * t)), b.dot(&(m * b)), t.dot(&(m * b)));
    let (mean, half) = (0.5 * (tt + bb), 0.5 * (tt - bb));
    if mean.is_nan() || mean <= 1e-20 {
        return None;
    }
    let (sin, cos) = (0.5 * tb.atan2(half)).sin_cos();
    Some((mean + half.hypot(tb), t * cos + b * sin))
}
