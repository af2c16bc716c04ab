//! From pointer positions to dabs. Points are filled in between positions, so that a quick stroke
//! has no gaps. Dabs wait until a frame has time for them, so that wide brushes on large meshes do
//! not hold up the window.

use std::collections::VecDeque;

use plisse_live::camera::Camera;
use plisse_live::{Vec2, Vec3};

use super::painting::{Canvas, Painting};
use super::pick::{Hit, Ray, between, pick, pick_among};
use crate::document::{Brush, Change, Heading, Layers};

/// Distance of dabs, as a share of the brush's radius.
const SPACING: f32 = 0.25;
/// Most dabs between two pointer positions.
const MOST: usize = 64;

/// A stroke that follows the pointer.
pub struct Trail {
    painting: Painting,
    /// The last pointer position (0 to 1 across and down the picture).
    pointer: Vec2,
    /// The last point of the surface; `true` if it still waits for a direction.
    last: Option<(Hit, bool)>,
    /// The last step of the stroke (posed, m).
    course: Option<Vec3>,
    /// Length of the stroke since the last dab (m).
    since_m: f32,
    /// Dabs that are not painted yet, with the direction of the stroke.
    waiting: VecDeque<(Hit, Vec3)>,
}

impl Trail {
    /// Begins a stroke at `pointer`.
    pub fn begin(brush: Brush, canvas: &Canvas<'_>, camera: &Camera, pointer: Vec2) -> Self {
        let painting = Painting::new(brush, canvas.welded.count());
        let hit = hit(canvas, camera, pointer);
        Self {
            painting,
            pointer,
            last: hit.map(|h| (h, true)),
            course: None,
            since_m: 0.0,
            waiting: VecDeque::new(),
        }
    }

    /// Continues to `pointer`; [`Trail::paint`] paints the dabs on the way.
    pub fn extend(&mut self, canvas: &Canvas<'_>, camera: &Camera, pointer: Vec2) {
        let from = self.pointer;
        self.pointer = pointer;
        let target = hit(canvas, camera, pointer);
        let spacing_m = SPACING * self.painting.brush().radius_m;
        // Off the surface the length is unknown: the step is divided as finely as possible.
        let way_m = match (&self.last, &target) {
            (Some((a, _)), Some(b)) => (b.position - a.position).norm(),
            _ => MOST as f32 * spacing_m,
        };
        let parts = ((way_m / spacing_m).ceil() as usize).clamp(1, MOST);
        // A large mesh is searched once, not for every part.
        let rays = [from, pointer].map(|p| Ray::through(camera, p));
        let some = match (rays, parts) {
            ([Some(a), Some(b)], 2..) => between(canvas.posed, &canvas.welded.faces, &a, &b),
            _ => Vec::new(),
        };
        for part in 1..=parts {
            let at = from + (pointer - from) * (part as f32 / parts as f32);
            let hit = if part == parts {
                target
            } else {
                Ray::through(camera, at).and_then(|ray| {
                    pick_among(canvas.posed, &canvas.welded.faces, some.iter().copied(), &ray)
                })
            };
            self.reach(camera, hit, spacing_m);
        }
    }

    /// True if dabs wait to be painted.
    pub fn is_behind(&self) -> bool {
        !self.waiting.is_empty()
    }

    /// Paints waiting dabs: the first, and others while there is `more` time.
    pub fn paint(
        &mut self,
        canvas: &Canvas<'_>,
        layers: &mut Layers,
        more: &mut dyn FnMut() -> bool,
    ) {
        while let Some((hit, course)) = self.waiting.pop_front() {
            self.painting.dab(canvas, layers, &hit, &course);
            if !more() {
                break;
            }
        }
        self.painting.write(canvas, layers);
    }

    fn reach(&mut self, camera: &Camera, hit: Option<Hit>, spacing_m: f32) {
        let Some(hit) = hit else {
            // The stroke left the surface; it begins anew when it comes back.
            self.flush(camera);
            self.last = None;
            return;
        };
        let Some((before, waits)) = self.last else {
            self.last = Some((hit, true));
            return;
        };
        let way = hit.position - before.position;
        if way.norm() <= 1e-6 * spacing_m {
            return;
        }
        self.course = Some(way);
        if waits {
            self.dab(camera, &before);
            self.since_m = 0.0;
        }
        self.since_m += way.norm();
        if self.since_m >= 0.999 * spacing_m {
            self.dab(camera, &hit);
            self.since_m = 0.0;
        }
        self.last = Some((hit, false));
    }

    /// Paints a point that still waits for a direction, with the last one or the screen's right.
    fn flush(&mut self, camera: &Camera) {
        if let Some((hit, true)) = self.last {
            self.dab(camera, &hit);
            self.last = Some((hit, false));
        }
    }

    fn dab(&mut self, camera: &Camera, hit: &Hit) {
        let (right, up) = screen_axes(camera);
        let angle = self.painting.brush().screen_angle_rad;
        let course = match (self.painting.brush().heading, self.course) {
            (Heading::Screen, _) => right * angle.cos() + up * angle.sin(),
            (_, Some(course)) => course,
            (_, None) => right,
        };
        self.waiting.push_back((*hit, course));
    }

    /// Ends the stroke and paints all waiting dabs.
    pub fn end(mut self, canvas: &Canvas<'_>, layers: &mut Layers, camera: &Camera) -> Change {
        self.flush(camera);
        self.paint(canvas, layers, &mut || true);
        self.painting.end(layers)
    }
}

/// The point of the surface under `pointer`.
pub fn hit(canvas: &Canvas<'_>, camera: &Camera, pointer: Vec2) -> Option<Hit> {
    pick(canvas.posed, &canvas.welded.faces, &Ray::through(camera, pointer)?)
}

/// Right and up of the screen, in the world.
fn screen_axes(camera: &Camera) -> (Vec3, Vec3) {
    let back = (camera.eye - camera.target).try_normalize(1e-20).unwrap_or_else(Vec3::z);
    let right = Vec3::y().cross(&back).try_normalize(1e-6).unwrap_or_else(Vec3::x);
    (right, back.cross(&right))
}
