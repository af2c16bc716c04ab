//! From pointer positions to dabs: points are filled in between, so that a quick stroke is as whole as a slow one.

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
    /// The last point of the surface, and whether it still waits for a direction.
    last: Option<(Hit, bool)>,
    /// The way the stroke went last (posed, m).
    course: Option<Vec3>,
    /// Way since the last dab (m).
    since_m: f32,
}

impl Trail {
    /// Begins a stroke at `pointer`.
    pub fn begin(brush: Brush, canvas: &Canvas<'_>, camera: &Camera, pointer: Vec2) -> Self {
        let painting = Painting::new(brush, canvas.unified.count());
        let hit = meet(canvas, camera, pointer);
        Self { painting, pointer, last: hit.map(|h| (h, true)), course: None, since_m: 0.0 }
    }

    /// Goes on to `pointer`.
    pub fn go(&mut self, canvas: &Canvas<'_>, layers: &mut Layers, camera: &Camera, pointer: Vec2) {
        let from = self.pointer;
        self.pointer = pointer;
        let target = meet(canvas, camera, pointer);
        let spacing_m = SPACING * self.painting.brush().radius_m;
        // Off the surface, steps are as long as on the screen they would have to be.
        let way_m = match (&self.last, &target) {
            (Some((a, _)), Some(b)) => (b.position - a.position).norm(),
            _ => MOST as f32 * spacing_m,
        };
        let parts = ((way_m / spacing_m).ceil() as usize).clamp(1, MOST);
        // Large meshes are looked through once, not for every part.
        let rays = [from, pointer].map(|p| Ray::through(camera, p));
        let some = match (rays, parts) {
            ([Some(a), Some(b)], 2..) => between(canvas.posed, &canvas.unified.faces, &a, &b),
            _ => Vec::new(),
        };
        for part in 1..=parts {
            let at = from + (pointer - from) * (part as f32 / parts as f32);
            let hit = if part == parts {
                target
            } else {
                Ray::through(camera, at).and_then(|ray| pick_among(canvas.posed, &canvas.unified.faces, some.iter().copied(), &ray))
            };
            self.reach(canvas, layers, camera, hit, spacing_m);
        }
        self.painting.write(canvas, layers);
    }

    fn reach(&mut self, canvas: &Canvas<'_>, layers: &Layers, camera: &Camera, hit: Option<Hit>, spacing_m: f32) {
        let Some(hit) = hit else {
            // The stroke left the surface; where it comes back, it begins anew.
            self.flush(canvas, layers, camera);
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
            self.dab(canvas, layers, camera, &before);
            self.since_m = 0.0;
        }
        self.since_m += way.norm();
        if self.since_m >= 0.999 * spacing_m {
            self.dab(canvas, layers, camera, &hit);
            self.since_m = 0.0;
        }
        self.last = Some((hit, false));
    }

    /// A point that still waits for a direction is painted with the last one, or the screen's right.
    fn flush(&mut self, canvas: &Canvas<'_>, layers: &Layers, camera: &Camera) {
        if let Some((hit, true)) = self.last {
            self.dab(canvas, layers, camera, &hit);
            self.last = Some((hit, false));
        }
    }

    fn dab(&mut self, canvas: &Canvas<'_>, layers: &Layers, camera: &Camera, hit: &Hit) {
        let (right, up) = screen_axes(camera);
        let angle = self.painting.brush().screen_angle_rad;
        let course = match (self.painting.brush().heading, self.course) {
            (Heading::Screen, _) => right * angle.cos() + up * angle.sin(),
            (_, Some(course)) => course,
            (_, None) => right,
        };
        self.painting.dab(canvas, layers, hit, &course);
    }

    /// Ends the stroke.
    pub fn end(mut self, canvas: &Canvas<'_>, layers: &mut Layers, camera: &Camera) -> Change {
        self.flush(canvas, layers, camera);
        self.painting.write(canvas, layers);
        self.painting.end(layers)
    }
}

/// Where the surface is under `pointer`.
pub fn meet(canvas: &Canvas<'_>, camera: &Camera, pointer: Vec2) -> Option<Hit> {
    pick(canvas.posed, &canvas.unified.faces, &Ray::through(camera, pointer)?)
}

/// Right and up of the screen, in the world.
fn screen_axes(camera: &Camera) -> (Vec3, Vec3) {
    let back = (camera.eye - camera.target).try_normalize(1e-20).unwrap_or_else(Vec3::z);
    let right = Vec3::y().cross(&back).try_normalize(1e-6).unwrap_or_else(Vec3::x);
    (right, back.cross(&right))
}
