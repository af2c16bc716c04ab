//! Distances along a surface from one point of it, as far as they are asked for and no farther.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::Spot;
use crate::mesh::{Vec2, Vec3};

/// Distances (m) from a spot to the vertices around it. Only those that were reached are ever touched.
#[derive(Clone, Debug)]
pub(super) struct Reach {
    /// `[V]` distance; infinite where nothing was reached.
    distance_m: Vec<f64>,
    /// `[V]` whether the distance is final.
    settled: Vec<bool>,
    /// Vertices with a distance.
    met: Vec<usize>,
    /// The settled ones, nearest first.
    reached: Vec<usize>,
    /// Bits of a distance, which sort as distances do, and the vertex.
    waiting: BinaryHeap<Reverse<(u64, usize)>>,
}

impl Reach {
    pub(super) fn new(vertex_count: usize) -> Self {
        Self {
            distance_m: vec![f64::INFINITY; vertex_count],
            settled: vec![false; vertex_count],
            met: Vec::new(),
            reached: Vec::new(),
            waiting: BinaryHeap::new(),
        }
    }

    /// Vertices up to `radius_m` from `spot`, nearest first, with their distances (m). Each face that a front crosses is laid flat onto the
    /// one before, so distances are exact on flat surfaces as far as faces see the spot straight, and a little long elsewhere.
    pub(super) fn from(
        &mut self,
        faces: &[[usize; 3]],
        around: &[Vec<usize>],
        places: &[Vec3],
        spot: &Spot,
        radius_m: f64,
    ) -> Vec<(usize, f64)> {
        let corners = faces[spot.face];
        let origin: Vec3 = (0..3).map(|k| places[corners[k]] * spot.weights[k]).sum();
        for v in corners {
            self.offer(v, (places[v] - origin).norm());
        }
        while let Some(Reverse((bits, v))) = self.waiting.pop() {
            let distance = f64::from_bits(bits);
            if self.settled[v] || distance > radius_m {
                continue;
            }
            self.settled[v] = true;
            self.reached.push(v);
            for &f in &around[v] {
                let face = faces[f];
                let k = usize::from(face[1] == v) + 2 * usize::from(face[2] == v);
                for (a, b) in [(face[(k + 1) % 3], face[(k + 2) % 3]), (face[(k + 2) % 3], face[(k + 1) % 3])] {
                    self.offer(a, distance + (places[a] - places[v]).norm());
                    if self.settled[b]
                        && let Some(through) = across(places[v], places[b], places[a], distance, self.distance_m[b])
                    {
                        self.offer(a, through);
                    }
                }
            }
        }
        let found = self.reached.iter().map(|&v| (v, self.distance_m[v])).collect();
        for v in self.met.drain(..) {
            (self.distance_m[v], self.settled[v]) = (f64::INFINITY, false);
        }
        self.reached.clear();
        found
    }

    fn offer(&mut self, v: usize, distance_m: f64) {
        if !self.settled[v] && distance_m < self.distance_m[v] {
            if self.distance_m[v].is_infinite() {
                self.met.push(v);
            }
            self.distance_m[v] = distance_m;
            self.waiting.push(Reverse((distance_m.to_bits(), v)));
        }
    }
}

/// Distance (m) of `c` from a point that is `at_a` and `at_b` (m) from `a` and `b`, straight through the side from `a` to `b`; none if it
/// is not seen through that side.
fn across(a: Vec3, b: Vec3, c: Vec3, at_a: f64, at_b: f64) -> Option<f64> {
    let side = b - a;
    let length = side.norm();
    let apex = Vec2::new(side.dot(&(c - a)) / length, side.cross(&(c - a)).norm() / length);
    let x = (at_a * at_a - at_b * at_b + length * length) / (2.0 * length);
    let below = at_a * at_a - x * x;
    if below < 0.0 {
        return None;
    }
    let source = Vec2::new(x, -below.sqrt());
    // Where the straight line crosses the side.
    let crossing = source.x + (apex.x - source.x) * (-source.y) / (apex.y - source.y);
    (0.0..=length).contains(&crossing).then(|| (apex - source).norm())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Topology;
    use crate::mesh::panel::{Outline, Panel};

    #[test]
    fn distances_on_a_flat_sheet_are_straight_and_end_where_asked() {
        let panel = Panel::new("sheet", &Outline::Rectangle { width_m: 1.0, height_m: 1.0 }, 0.05, 3).unwrap();
        let places: Vec<Vec3> = panel.positions.iter().map(|p| Vec3::new(p.x, p.y, 0.0)).collect();
        let topology = Topology::new("sheet", places.len(), panel.faces).unwrap();
        let around = topology.vertex_faces();
        let mut reach = Reach::new(places.len());
        let spot = Spot { face: 31, weights: [0.2, 0.5, 0.3] };
        let origin: Vec3 = (0..3).map(|k| places[topology.faces[31][k]] * spot.weights[k]).sum();
        let found = reach.from(&topology.faces, &around, &places, &spot, 0.3);
        for &(v, distance) in &found {
            let straight = (places[v] - origin).norm();
            assert!(distance >= straight - 1e-12 && distance < 1.05 * straight + 1e-12, "{v}: {distance} {straight}");
        }
        let within = places.iter().filter(|p| (*p - origin).norm() <= 0.3 / 1.05).count();
        assert!(found.len() >= within && found.windows(2).all(|pair| pair[0].1 <= pair[1].1));
        assert!(reach.distance_m.iter().all(|d| d.is_infinite()) && !reach.settled.contains(&true));
        assert_eq!(reach.from(&topology.faces, &around, &places, &spot, 0.3), found);
    }
}
