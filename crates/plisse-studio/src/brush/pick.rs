//! The point where a ray meets a mesh, and the nearest point of a mesh.

use plisse_live::camera::Camera;
use plisse_live::{Vec2, Vec3};

/// A half line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Its origin (m).
    pub origin: Vec3,
    /// Unit direction.
    pub direction: Vec3,
}

impl Ray {
    /// The ray through the point `at` of a picture, from (0, 0) at its upper left to (1, 1) at its
    /// lower right; `None` for a camera that sees nothing.
    pub fn through(camera: &Camera, at: Vec2) -> Option<Self> {
        let world_from_clip = camera.clip_from_world().try_inverse()?;
        let place = |depth: f32| {
            let h = world_from_clip
                * nalgebra::Vector4::new(2.0 * at.x - 1.0, 1.0 - 2.0 * at.y, depth, 1.0);
            h.xyz() / h.w
        };
        let far = place(1.0);
        let direction = (far - camera.eye).try_normalize(1e-20)?;
        Some(Self { origin: camera.eye, direction })
    }
}

/// A point of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Its face.
    pub face: usize,
    /// Barycentric coordinates of the face's second and third corner.
    pub weights: [f32; 2],
    /// Its position (m).
    pub position: Vec3,
    /// Distance from the ray's origin, or from the place that it is nearest to (m).
    pub distance_m: f32,
}

impl Hit {
    /// The same point of the mesh in another pose.
    pub fn on(face: usize, weights: [f32; 2], positions: &[Vec3], faces: &[[u32; 3]]) -> Self {
        let [a, b, c] = faces[face].map(|v| positions[v as usize]);
        let position = a + (b - a) * weights[0] + (c - a) * weights[1];
        Self { face, weights, position, distance_m: 0.0 }
    }
}

/// The nearest point of `faces` over `positions` on `ray`; both sides of a face count.
pub fn pick(positions: &[Vec3], faces: &[[u32; 3]], ray: &Ray) -> Option<Hit> {
    pick_among(positions, faces, 0..faces.len() as u32, ray)
}

/// As [`pick`], among `some` of the faces.
pub fn pick_among(
    positions: &[Vec3],
    faces: &[[u32; 3]],
    some: impl Iterator<Item = u32>,
    ray: &Ray,
) -> Option<Hit> {
    let mut best: Option<Hit> = None;
    for f in some.map(|f| f as usize) {
        let [a, b, c] = faces[f].map(|v| positions[v as usize]);
        let (side_b, side_c) = (b - a, c - a);
        let across = ray.direction.cross(&side_c);
        let determinant = side_b.dot(&across);
        if determinant == 0.0 || !determinant.is_finite() {
            continue;
        }
        let from = ray.origin - a;
        let s = from.dot(&across) / determinant;
        let turned = from.cross(&side_b);
        let t = ray.direction.dot(&turned) / determinant;
        let distance_m = side_c.dot(&turned) / determinant;
        let inside = s >= 0.0 && t >= 0.0 && s + t <= 1.0 && distance_m > 0.0;
        if inside && best.is_none_or(|h| distance_m < h.distance_m) {
            best = Some(Hit {
                face: f,
                weights: [s, t],
                position: ray.origin + ray.direction * distance_m,
                distance_m,
            });
        }
    }
    best
}

/// The faces that a ray between two others from the same origin can meet: those that the plane of
/// both cuts. All faces where the two are the same.
pub fn between(positions: &[Vec3], faces: &[[u32; 3]], a: &Ray, b: &Ray) -> Vec<u32> {
    let all = 0..faces.len() as u32;
    let Some(normal) = a.direction.cross(&b.direction).try_normalize(1e-7) else {
        return all.collect();
    };
    let side: Vec<i8> = positions
        .iter()
        .map(|p| {
            let from = p - a.origin;
            let (height, slack) = (normal.dot(&from), 1e-5 * from.norm());
            i8::from(height > -slack) - i8::from(height < slack)
        })
        .collect();
    let cut = |f: &u32| {
        faces[*f as usize].map(|v| i32::from(side[v as usize])).iter().sum::<i32>().abs() < 3
    };
    all.filter(cut).collect()
}

/// The point of `faces` over `positions` that is nearest to `place`; `None` for a mesh without
/// faces.
pub fn nearest(positions: &[Vec3], faces: &[[u32; 3]], place: &Vec3) -> Option<Hit> {
    nearest_among(positions, faces, 0..faces.len() as u32, place)
}

/// As [`nearest`], among `some` of the faces.
pub fn nearest_among(
    positions: &[Vec3],
    faces: &[[u32; 3]],
    some: impl Iterator<Item = u32>,
    place: &Vec3,
) -> Option<Hit> {
    let mut best: Option<Hit> = None;
    for f in some.map(|f| f as usize) {
        let weights = nearest_in(faces[f].map(|v| positions[v as usize]), place);
        let mut hit = Hit::on(f, weights, positions, faces);
        hit.distance_m = (hit.position - place).norm();
        if hit.distance_m.is_finite() && best.is_none_or(|h| hit.distance_m < h.distance_m) {
            best = Some(hit);
        }
    }
    best
}

/// Barycentric coordinates (of the second and third corner) of the point of a triangle that is
/// nearest to `p`.
fn nearest_in([a, b, c]: [Vec3; 3], p: &Vec3) -> [f32; 2] {
    let (u, v, w) = (b - a, c - a, p - a);
    let (uu, uv, vv, wu, wv) = (u.dot(&u), u.dot(&v), v.dot(&v), w.dot(&u), w.dot(&v));
    let determinant = uu * vv - uv * uv;
    if determinant > 0.0 {
        let (s, t) = ((vv * wu - uv * wv) / determinant, (uu * wv - uv * wu) / determinant);
        if s >= 0.0 && t >= 0.0 && s + t <= 1.0 {
            return [s, t];
        }
    }
    // On the border then: the best of its three sides.
    let on_side = |from: Vec3, to: Vec3| {
        let side = to - from;
        ((p - from).dot(&side) / side.norm_squared().max(f32::MIN_POSITIVE)).clamp(0.0, 1.0)
    };
    let (ab, ac, bc) = (on_side(a, b), on_side(a, c), on_side(b, c));
    let candidates = [[ab, 0.0], [0.0, ac], [1.0 - bc, bc]];
    let far = |[s, t]: &[f32; 2]| (a + u * *s + v * *t - p).norm_squared();
    candidates.into_iter().min_by(|x, y| far(x).total_cmp(&far(y))).unwrap_or([0.0; 2])
}

#[cfg(test)]
mod tests {
    use super::*;
    use plisse_live::models;
    use plisse_live::weld::WeldedMesh;

    #[test]
    fn a_ray_through_a_point_meets_it() {
        let model = models::sleeve();
        let welded = WeldedMesh::new(&model, 1e-5);
        let (x, faces) = (&welded.vertices.positions, &welded.faces);
        let camera = Camera::fit(x.iter(), 0.4, 0.2, 1.3);
        let mut met = 0;
        for f in (0..faces.len()).step_by(7) {
            let place = Hit::on(f, [0.3, 0.2], x, faces).position;
            let clip = camera.clip_from_world() * place.push(1.0);
            let at = Vec2::new(0.5 + 0.5 * clip.x / clip.w, 0.5 - 0.5 * clip.y / clip.w);
            let hit = pick(x, faces, &Ray::through(&camera, at).unwrap()).unwrap();
            // Something nearer may be in the way; what is met is never farther.
            let far = (place - camera.eye).norm();
            assert!(hit.distance_m < far + 1e-4);
            met += usize::from(hit.face == f && (hit.position - place).norm() < 1e-4);
        }
        assert!(met > 50, "{met}");
        assert!(pick(x, faces, &Ray::through(&camera, Vec2::new(-3.0, 0.5)).unwrap()).is_none());
    }

    #[test]
    fn faces_between_two_rays_are_all_that_rays_between_them_meet() {
        let welded = WeldedMesh::new(&models::sleeve(), 1e-5);
        let (x, faces) = (&welded.vertices.positions, &welded.faces);
        let camera = Camera::fit(x.iter(), 0.4, 0.2, 1.3);
        let ray = |t: f32| Ray::through(&camera, Vec2::new(0.2 + 0.6 * t, 0.4 + 0.25 * t)).unwrap();
        let some = between(x, faces, &ray(0.0), &ray(1.0));
        assert!(some.len() * 3 < faces.len(), "{} of {}", some.len(), faces.len());
        let mut met = 0;
        for k in 0..=60 {
            let ray = ray(k as f32 / 60.0);
            let found = pick(x, faces, &ray);
            assert_eq!(found, pick_among(x, faces, some.iter().copied(), &ray));
            met += usize::from(found.is_some());
        }
        assert!(met > 20, "{met}");
        assert_eq!(between(x, faces, &ray(0.5), &ray(0.5)).len(), faces.len());
    }

    #[test]
    fn the_nearest_point_is_found_on_faces_sides_and_corners() {
        let x = [Vec3::zeros(), Vec3::x(), Vec3::y()];
        for (p, at) in [
            (Vec3::new(0.2, 0.3, 1.0), Vec3::new(0.2, 0.3, 0.0)),
            (Vec3::new(0.5, -2.0, 0.0), Vec3::new(0.5, 0.0, 0.0)),
            (Vec3::new(1.0, 1.0, 0.5), Vec3::new(0.5, 0.5, 0.0)),
            (Vec3::new(-1.0, -1.0, 0.0), Vec3::zeros()),
            (Vec3::new(-1.0, 5.0, 0.0), Vec3::y()),
        ] {
            assert!((nearest(&x, &[[0, 1, 2]], &p).unwrap().position - at).norm() < 1e-6, "{p}");
        }
    }
}
