//! Distances along the surface from a point of it, as far as a brush reaches.
//!
//! Dijkstra's order with an update across faces: where the distances of two corners are known, the source is unfolded into the
//! third one's plane, which is exact on surfaces that unfold flat; where the straight line would miss the side between them, it runs along an edge.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use plisse_live::{Vec2, Vec3};

use super::pick::Hit;

/// Which faces lie around each vertex of a mesh. Never changes after it is built.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Surface {
    /// `[U + 1]` where each vertex's faces begin in `list`.
    starts: Vec<u32>,
    /// Faces around vertices.
    list: Vec<u32>,
}

struct Step {
    distance_m: f32,
    v: u32,
}

impl PartialEq for Step {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for Step {}
impl PartialOrd for Step {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Step {
    fn cmp(&self, other: &Self) -> Ordering {
        other.distance_m.total_cmp(&self.distance_m).then(other.v.cmp(&self.v))
    }
}

impl Surface {
    /// Of `faces` over `count` vertices.
    pub fn new(faces: &[[u32; 3]], count: usize) -> Self {
        let mut starts = vec![0u32; count + 1];
        faces.iter().flatten().for_each(|&v| starts[v as usize + 1] += 1);
        (0..count).for_each(|v| starts[v + 1] += starts[v]);
        let mut next = starts.clone();
        let mut list = vec![0u32; 3 * faces.len()];
        for (f, face) in faces.iter().enumerate() {
            for &v in face {
                list[next[v as usize] as usize] = f as u32;
                next[v as usize] += 1;
            }
        }
        Self { starts, list }
    }

    /// Faces around vertex `v`.
    pub fn around(&self, v: u32) -> &[u32] {
        &self.list[self.starts[v as usize] as usize..self.starts[v as usize + 1] as usize]
    }

    /// Vertices closer to `from` than `radius_m` along `faces` over `positions`, with their distances (m), ascending by vertex.
    pub fn reach(&self, faces: &[[u32; 3]], positions: &[Vec3], from: &Hit, radius_m: f32) -> Vec<(u32, f32)> {
        // Infinite where nothing is known yet; settled once the queue has handed a vertex out.
        let mut distance = vec![f32::INFINITY; self.starts.len() - 1];
        let mut settled = vec![false; distance.len()];
        let mut list = Vec::new();
        let mut queue = BinaryHeap::new();
        for &v in &faces[from.face] {
            let distance_m = (positions[v as usize] - from.position).norm();
            if distance_m < radius_m {
                distance[v as usize] = distance_m;
                queue.push(Step { distance_m, v });
            }
        }
        // Around the face itself everything is seen straight, even if no corner is within reach.
        while let Some(Step { distance_m, v }) = queue.pop() {
            if std::mem::replace(&mut settled[v as usize], true) {
                continue;
            }
            list.push((v, distance_m));
            for &f in self.around(v) {
                for &to in faces[f as usize].iter().filter(|&&to| !settled[to as usize]) {
                    let found = across(faces[f as usize], positions, &distance, v, to);
                    if found < radius_m && found < distance[to as usize] {
                        distance[to as usize] = found;
                        queue.push(Step { distance_m: found, v: to });
                    }
                }
            }
        }
        list.sort_unstable_by_key(|&(v, _)| v);
        list
    }
}

/// Distance of `to` over `face`, that of `from` being known; the third corner helps if it has a distance, too.
fn across(face: [u32; 3], x: &[Vec3], distance: &[f32], from: u32, to: u32) -> f32 {
    let at = |v: u32| x[v as usize];
    let along = distance[from as usize] + (at(to) - at(from)).norm();
    let Some(&third) = face.iter().find(|&&v| v != from && v != to) else { return along };
    let d_third = distance[third as usize];
    if d_third == f32::INFINITY {
        return along;
    }
    let side = at(third) - at(from);
    let length = side.norm();
    if length.is_nan() || length <= 0.0 {
        return along;
    }
    // In the plane: `from` at the origin, `third` on the x axis, `to` above it, the source below.
    let side = side / length;
    let d_from = distance[from as usize];
    let source_x = (d_from * d_from - d_third * d_third + length * length) / (2.0 * length);
    let below = d_from * d_from - source_x * source_x;
    if below < 0.0 {
        return along.min(d_third + (at(to) - at(third)).norm());
    }
    let up = at(to) - at(from);
    let to_x = up.dot(&side);
    let target = Vec2::new(to_x, (up.norm_squared() - to_x * to_x).max(0.0).sqrt());
    let source = Vec2::new(source_x, -below.sqrt());
    let crossing = source.x + (target.x - source.x) * (-source.y / (target.y - source.y).max(f32::MIN_POSITIVE));
    if (0.0..=length).contains(&crossing) { (target - source).norm() } else { along.min(d_third + (at(to) - at(third)).norm()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brush::pick::nearest;
    use plisse_live::models;
    use plisse_live::unify::Unified;

    #[test]
    fn on_a_flat_square_distances_are_straight() {
        let unified = Unified::new(&models::square().unwrap(), 1e-5);
        let (x, faces) = (&unified.vertices.positions, &unified.faces);
        let surface = Surface::new(faces, unified.count());
        for place in [Vec3::new(0.31, 0.42, 0.0), Vec3::new(0.02, 0.97, 0.0), x[5]] {
            let from = nearest(x, faces, &place).unwrap();
            let found = surface.reach(faces, x, &from, 0.4);
            let within = (0..x.len()).filter(|&v| (x[v] - from.position).norm() < 0.4 - 1e-3).count();
            assert!(found.len() >= within && within > 10, "{} of {within}", found.len());
            for (v, d) in found {
                let straight = (x[v as usize] - from.position).norm();
                assert!((d - straight).abs() < 1e-3, "{v}: {d} for {straight}");
            }
        }
    }

    #[test]
    fn around_a_sleeve_distances_follow_the_cloth_and_not_the_air() {
        let unified = Unified::new(&models::sleeve(), 1e-5);
        let (x, faces) = (&unified.vertices.positions, &unified.faces);
        let surface = Surface::new(faces, unified.count());
        let from = nearest(x, faces, &Vec3::new(0.3, 0.06, 0.0)).unwrap();
        let found = surface.reach(faces, x, &from, 0.3);
        // The far side lies π·6 cm away, 12 cm through the air; the mesh has 20 sides, which shortens by 0.4 %.
        let far = found.iter().filter(|(v, _)| (x[*v as usize] - Vec3::new(0.3, -0.06, 0.0)).norm() < 1e-3).map(|f| f.1).next().unwrap();
        assert!((far - std::f32::consts::PI * 0.06).abs() < 0.03 * far, "{far}");
        // The texture seam at +y lies beside the start: both of its sides are found alike.
        let beside = |z: f32| found.iter().filter(|(v, _)| (x[*v as usize].x - 0.3).abs() < 1e-4 && x[*v as usize].z * z > 1e-3).count();
        assert_eq!(beside(1.0), beside(-1.0));
    }
}
