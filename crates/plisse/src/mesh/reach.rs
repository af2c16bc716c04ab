//! Distances along a surface from one point of it, as far as they are asked for and no farther.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::{Vec2, Vec3};

/// Room to measure distances in. Only vertices that are reached are ever touched, so that a search
/// costs what it finds.
#[derive(Clone, Debug)]
pub struct Reach {
    /// `[V]` distance; infinite where nothing was reached.
    distance_m: Vec<f64>,
    /// `[V]` true if the distance is final.
    settled: Vec<bool>,
    /// Vertices with a distance.
    met: Vec<usize>,
    /// The settled ones, nearest first.
    reached: Vec<usize>,
    /// Bits of a distance, which sort as distances do, and the vertex.
    waiting: BinaryHeap<Reverse<(u64, usize)>>,
}

impl Reach {
    /// For meshes of `vertex_count` vertices.
    pub fn new(vertex_count: usize) -> Self {
        Self {
            distance_m: vec![f64::INFINITY; vertex_count],
            settled: vec![false; vertex_count],
            met: Vec::new(),
            reached: Vec::new(),
            waiting: BinaryHeap::new(),
        }
    }

    /// Vertices up to `radius_m` from the point `origin` (m) of a face with these `corners`,
    /// nearest first, with their distances (m). Each face that a front crosses is laid flat onto
    /// the one before, so distances are exact on flat surfaces as far as faces see the point
    /// straight, and a little long elsewhere. `around` gives the corners of the faces around a
    /// vertex, `place` its position (m).
    pub fn from<I: Iterator<Item = [usize; 3]>>(
        &mut self,
        corners: [usize; 3],
        origin: &Vec3,
        around: impl Fn(usize) -> I,
        place: impl Fn(usize) -> Vec3,
        radius_m: f64,
    ) -> Vec<(usize, f64)> {
        for v in corners {
            self.offer(v, (place(v) - origin).norm());
        }
        self.search(around, place, radius_m)
    }

    /// Vertices up to `radius_m` from any of the vertices `from`, nearest first, with their
    /// distances (m); else as [`Reach::from`].
    pub fn around_all<I: Iterator<Item = [usize; 3]>>(
        &mut self,
        from: impl Iterator<Item = usize>,
        around: impl Fn(usize) -> I,
        place: impl Fn(usize) -> Vec3,
        radius_m: f64,
    ) -> Vec<(usize, f64)> {
        from.for_each(|v| self.offer(v, 0.0));
        self.search(around, place, radius_m)
    }

    fn search<I: Iterator<Item = [usize; 3]>>(
        &mut self,
        around: impl Fn(usize) -> I,
        place: impl Fn(usize) -> Vec3,
        radius_m: f64,
    ) -> Vec<(usize, f64)> {
        while let Some(Reverse((bits, v))) = self.waiting.pop() {
            let distance = f64::from_bits(bits);
            if self.settled[v] || distance > radius_m {
                continue;
            }
            self.settled[v] = true;
            self.reached.push(v);
            for face in around(v) {
                let k = usize::from(face[1] == v) + 2 * usize::from(face[2] == v);
                for (a, b) in
                    [(face[(k + 1) % 3], face[(k + 2) % 3]), (face[(k + 2) % 3], face[(k + 1) % 3])]
                {
                    self.offer(a, distance + (place(a) - place(v)).norm());
                    if self.settled[b]
                        && let Some(through) =
                            across(place(v), place(b), place(a), distance, self.distance_m[b])
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

/// Distance (m) of `c` from a point that is `at_a` and `at_b` (m) from `a` and `b`, straight
/// through the side from `a` to `b`; none if it is not seen through that side.
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
        let panel =
            Panel::new(&Outline::Rectangle { width_m: 1.0, height_m: 1.0 }, 0.05, 3).unwrap();
        let places: Vec<Vec3> = panel.positions.iter().map(|p| Vec3::new(p.x, p.y, 0.0)).collect();
        let topology = Topology::new(places.len(), panel.faces).unwrap();
        let (faces, around) = (&topology.faces, topology.vertex_faces());
        let mut reach = Reach::new(places.len());
        let corners = faces[31];
        let origin: Vec3 =
            places[corners[0]] * 0.2 + places[corners[1]] * 0.5 + places[corners[2]] * 0.3;
        let mut search = || {
            reach.from(
                corners,
                &origin,
                |v| around[v].iter().map(|&f| faces[f]),
                |v| places[v],
                0.3,
            )
        };
        let found = search();
        for &(v, distance) in &found {
            let straight = (places[v] - origin).norm();
            assert!(
                distance >= straight - 1e-12 && distance < 1.05 * straight + 1e-12,
                "{v}: {distance} {straight}"
            );
        }
        let within = places.iter().filter(|p| (*p - origin).norm() <= 0.3 / 1.05).count();
        assert!(found.len() >= within && found.windows(2).all(|pair| pair[0].1 <= pair[1].1));
        assert_eq!(search(), found);
        assert!(reach.distance_m.iter().all(|d| d.is_infinite()) && !reach.settled.contains(&true));
    }
}
