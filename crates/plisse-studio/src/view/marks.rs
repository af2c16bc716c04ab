//! Lines over the picture: crests, and expansion as ellipses. Hidden ones are left out.

use std::f32::consts::TAU;

use plisse_live::camera::Camera;
use plisse_live::skin::PosedVertices;
use plisse_live::weld::WeldedMesh;
use plisse_live::{Vec2, Vec3};

/// Most marks in one picture.
const MOST: usize = 3000;
/// Number of segments of an ellipse.
const PARTS: usize = 14;
/// Height (pixels) of the depth picture that decides what is hidden.
const COARSE: usize = 200;

/// A line in the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mark {
    /// Its ends, from (0, 0) at the upper left to (1, 1).
    pub ends: [Vec2; 2],
    /// Its strength, 0 to 1.
    pub strength: f32,
}

/// Depths of a coarse picture, which decide what is hidden.
pub struct Depths {
    size: [usize; 2],
    nearest: Vec<f32>,
    camera: Camera,
}

impl Depths {
    /// The depths of `faces` over `positions`.
    pub fn new(camera: &Camera, positions: &[Vec3], faces: &[[u32; 3]]) -> Self {
        let size = [((COARSE as f32 * camera.aspect) as usize).clamp(8, 4 * COARSE), COARSE];
        let mut depths =
            Self { size, nearest: vec![f32::INFINITY; size[0] * size[1]], camera: *camera };
        let map = camera.clip_from_world();
        let seen: Vec<Option<Vec3>> = positions.iter().map(|p| seen(&map, p)).collect();
        for face in faces {
            if let [Some(a), Some(b), Some(c)] = face.map(|v| seen[v as usize]) {
                depths.cover([a, b, c]);
            }
        }
        depths
    }

    fn cover(&mut self, corners: [Vec3; 3]) {
        let at =
            corners.map(|p| Vec3::new(p.x * self.size[0] as f32, p.y * self.size[1] as f32, p.z));
        let span = |k: usize| {
            let low = at.iter().fold(f32::INFINITY, |m, p| m.min(p[k]));
            let high = at.iter().fold(f32::NEG_INFINITY, |m, p| m.max(p[k]));
            (low - 0.5).ceil().clamp(0.0, self.size[k] as f32) as usize
                ..((high - 0.5).floor() + 1.0).clamp(0.0, self.size[k] as f32) as usize
        };
        let cross =
            |a: &Vec3, b: &Vec3, x: f32, y: f32| (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
        let area = cross(&at[0], &at[1], at[2].x, at[2].y);
        if area == 0.0 || !area.is_finite() {
            return;
        }
        for y in span(1) {
            for x in span(0) {
                let p = (x as f32 + 0.5, y as f32 + 0.5);
                let w =
                    [0, 1, 2].map(|k| cross(&at[(k + 1) % 3], &at[(k + 2) % 3], p.0, p.1) / area);
                if w.iter().all(|&w| w >= 0.0) {
                    let depth: f32 = (0..3).map(|k| w[k] * at[k].z).sum();
                    let there = &mut self.nearest[y * self.size[0] + x];
                    *there = there.min(depth);
                }
            }
        }
    }

    /// Position of `p` in the picture; `None` if it is outside or clearly hidden.
    pub fn visible(&self, p: &Vec3) -> Option<Vec2> {
        let at = seen(&self.camera.clip_from_world(), p)?;
        if !(0.0..1.0).contains(&at.x) || !(0.0..1.0).contains(&at.y) {
            return None;
        }
        let (x, y) = ((at.x * self.size[0] as f32) as usize, (at.y * self.size[1] as f32) as usize);
        // The farthest of the pixels around decides, with some slack, so that nothing hides itself.
        let mut farthest = f32::NEG_INFINITY;
        for j in y.saturating_sub(1)..=(y + 1).min(self.size[1] - 1) {
            for i in x.saturating_sub(1)..=(x + 1).min(self.size[0] - 1) {
                farthest = farthest.max(self.nearest[j * self.size[0] + i]);
            }
        }
        let [near, far] = self.camera.depth;
        let metres = |z: f32| near * far / (far - z * (far - near));
        (metres(at.z) <= metres(farthest.min(1.0)) + 0.01 * (far - near))
            .then_some(Vec2::new(at.x, at.y))
    }
}

/// Position in the picture (0 to 1) and depth of `p`; `None` behind the viewer.
fn seen(map: &plisse_live::Mat4, p: &Vec3) -> Option<Vec3> {
    let clip = map * p.push(1.0);
    (clip.w > 1e-6).then(|| {
        Vec3::new(0.5 + 0.5 * clip.x / clip.w, 0.5 - 0.5 * clip.y / clip.w, clip.z / clip.w)
    })
}

/// The vertices that get a mark: all, or an even choice of [`MOST`].
fn chosen(count: usize) -> impl Iterator<Item = usize> {
    (0..count).step_by(count.div_ceil(MOST).max(1))
}

/// Half the typical length of an edge (m), from a sample.
fn half_edge_m(welded: &WeldedMesh, positions: &[Vec3]) -> f32 {
    let mut lengths: Vec<f32> = chosen(welded.count())
        .flat_map(|v| welded.around(v).iter().map(move |&n| (v, n as usize)))
        .map(|(v, n)| (positions[n] - positions[v]).norm())
        .collect();
    lengths.sort_by(f32::total_cmp);
    let thinned = welded.count().div_ceil(MOST).max(1) as f32;
    0.42 * lengths.get(lengths.len() / 2).copied().unwrap_or(0.0) * thinned.sqrt()
}

/// The direction of crests at each vertex: lines across the wave vectors.
pub fn crests(
    welded: &WeldedMesh,
    posed: &PosedVertices,
    wave: &[Vec3],
    strength: &[f32],
    camera: &Camera,
) -> Vec<Mark> {
    let depths = Depths::new(camera, &posed.positions, &welded.faces);
    let half_m = half_edge_m(welded, &posed.positions);
    let mark = |v: usize| {
        let along = posed.normals[v].cross(&wave[v]).try_normalize(1e-12)?;
        let (p, d) = (posed.positions[v], along * half_m);
        depths.visible(&p)?;
        Some(Mark {
            ends: [depths.place(&(p - d))?, depths.place(&(p + d))?],
            strength: strength[v].clamp(0.0, 1.0),
        })
    };
    chosen(welded.count()).filter(|&v| strength[v] > 0.0).filter_map(mark).collect()
}

/// Expansion as ellipses: a small circle, grown by the expansion of its vertex; none where the
/// expansion is zero.
pub fn ellipses(
    welded: &WeldedMesh,
    posed: &PosedVertices,
    expansion: &[[f32; 4]],
    camera: &Camera,
) -> Vec<Mark> {
    let depths = Depths::new(camera, &posed.positions, &welded.faces);
    let radius_m = 0.5 * half_edge_m(welded, &posed.positions);
    let mut marks = Vec::new();
    for v in chosen(welded.count()) {
        let [x, y, z, all] = expansion[v];
        let grows = Vec3::new(x, y, z);
        if (grows.norm() + all) <= 1e-4 || depths.visible(&posed.positions[v]).is_none() {
            continue;
        }
        let n = posed.normals[v];
        let other = if n.x.abs() < 0.7 { Vec3::x() } else { Vec3::y() };
        let along = (grows - n * n.dot(&grows))
            .try_normalize(1e-9)
            .or_else(|| n.cross(&other).try_normalize(1e-9));
        let Some(along) = along else { continue };
        let across = n.cross(&along);
        let (a, b) = (radius_m * (1.0 + grows.norm() + all), radius_m * (1.0 + all));
        let point = |k: usize| {
            let (sin, cos) = (TAU * k as f32 / PARTS as f32).sin_cos();
            depths.place(&(posed.positions[v] + along * (a * cos) + across * (b * sin)))
        };
        for k in 0..PARTS {
            if let (Some(from), Some(to)) = (point(k), point(k + 1)) {
                marks.push(Mark { ends: [from, to], strength: 1.0 });
            }
        }
    }
    marks
}

impl Depths {
    /// Position of `p` in the picture, hidden or not.
    fn place(&self, p: &Vec3) -> Option<Vec2> {
        seen(&self.camera.clip_from_world(), p).map(|at| Vec2::new(at.x, at.y))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use plisse_live::models;

    #[test]
    fn the_far_side_is_hidden() {
        let welded = WeldedMesh::new(&models::sleeve(), 1e-5);
        let x = &welded.vertices.positions;
        let camera = Camera::fit(x.iter(), 0.0, 0.0, 1.5);
        let depths = Depths::new(&camera, x, &welded.faces);
        let visible = |front: bool| {
            x.iter()
                .filter(|p| {
                    (0.04 < p.z) == front && p.z.abs() > 0.04 && depths.visible(p).is_some()
                })
                .count()
        };
        assert!(visible(true) > 100, "{}", visible(true));
        assert!(visible(false) < 20, "{}", visible(false));
    }
}
