//! Loop subdivision of a base surface together with the wrinkle field on it.
//!
//! Positions are smoothed over the whole mesh. Amplitude and phase live on the wrinkled faces only,
//! whose border counts as a crease: the amplitude stays zero on it, wrinkle-free faces stay flat,
//! and no phase is ever needed where there is none. The phase is carried as a number a vertex plus
//! a whole number of turns an edge, so that neighbours are compared in one chart and jumps stay
//! exact multiples of 2π at every level.

use std::f64::consts::TAU;

use rayon::prelude::*;

use crate::field::WrinkleField;
use crate::mesh::masks::Masks;
use crate::mesh::subdivide::{Subdivision, halve_creases};
use crate::mesh::{NONE, RestShape, Topology, Vec3};
use crate::sheet::Sheet;

/// A subdivided base surface with its wrinkle field.
#[derive(Clone, Debug)]
pub struct Upsampled {
    /// Fine connectivity; fine face f is part of coarse face f / 4^levels.
    pub topology: Topology,
    /// Subdivision steps made.
    pub levels: usize,
    /// `[V]` base surface (m).
    pub base: Vec<Vec3>,
    /// `[V]` amplitude (m), ≥ 0.
    pub amplitude_m: Vec<f64>,
    /// `[F][3]` phase (rad) at each corner; 0 on wrinkle-free faces.
    pub phase: Vec<[f64; 3]>,
    /// `[F]` true for parts of wrinkle-free faces.
    pub wrinkle_free: Vec<bool>,
    /// The rest shape, subdivided linearly, so that flat panels stay flat.
    pub rest_shape: RestShape,
}

/// Boundary vertices whose rest angle differs from a straight line by more than this (rad) are
/// corners and stay in place.
const CORNER_ANGLE: f64 = std::f64::consts::FRAC_PI_4;

impl Upsampled {
    /// `[F][3]` phase (rad) at the corners of each face; NaN on wrinkle-free faces, which have
    /// none.
    pub fn visible_phase(&self) -> Vec<[f64; 3]> {
        let corners = self.phase.iter().zip(&self.wrinkle_free);
        corners.map(|(&phase, &free)| if free { [f64::NAN; 3] } else { phase }).collect()
    }
}

/// Subdivides a pose of `sheet` (`[V]`, m) `levels` times, with the `field` on it.
pub fn upsample(sheet: &Sheet, pose: &[Vec3], field: &WrinkleField, levels: usize) -> Upsampled {
    let topology = &sheet.topology;
    let corners = boundary_corners(topology, &sheet.rest_shape);
    let mut fine = topology.clone();
    let mut base = pose.to_vec();
    let mut amplitude_m = field.amplitude_m.clone();
    let mut turning = TurningPhase::new(topology, field);
    let mut rest_shape = sheet.rest_shape.clone();
    let mut border: Vec<bool> = (0..topology.edge_count())
        .map(|e| {
            let [f, g] = topology.edge_faces[e];
            g != NONE && field.wrinkle_free[f] != field.wrinkle_free[g]
        })
        .collect();
    for _ in 0..levels {
        let step = Subdivision::new(&fine);
        let creased = border.iter().any(|&b| b);
        let ((next, rest_next), (smooth, wrinkled)) = rayon::join(
            || (step.fine(), rest_shape.refined()),
            || (step.masks(&[], &corners), creased.then(|| step.masks(&border, &corners))),
        );
        let wrinkled = wrinkled.as_ref().unwrap_or(&smooth);
        base = smooth.apply(&base);
        amplitude_m = wrinkled.apply(&amplitude_m);
        turning = turning.refined(&fine, wrinkled, &next);
        if creased {
            border = halve_creases(&next, fine.vertex_count, &border);
        }
        rest_shape = rest_next;
        fine = next;
    }
    let share = 4_usize.pow(levels as u32);
    let wrinkle_free: Vec<bool> =
        (0..fine.face_count()).map(|f| field.wrinkle_free[f / share]).collect();
    let phase = turning.corners(&fine, &wrinkle_free);
    Upsampled { topology: fine, levels, base, amplitude_m, phase, wrinkle_free, rest_shape }
}

/// `[V]` boundary vertices at which the rest boundary turns sharply.
fn boundary_corners(topology: &Topology, rest: &RestShape) -> Vec<bool> {
    let mut angle = vec![0.0; topology.vertex_count];
    for (f, face) in topology.faces.iter().enumerate() {
        let corners = rest.corners(f);
        for k in 0..3 {
            let [p, q, r] = [0, 1, 2].map(|n| corners[(k + n) % 3]);
            angle[face[k]] += (q - p).angle(&(r - p));
        }
    }
    let boundary = topology.boundary_vertices();
    (0..topology.vertex_count)
        .map(|v| boundary[v] && (angle[v] - std::f64::consts::PI).abs() > CORNER_ANGLE)
        .collect()
}

/// A phase known up to whole turns.
struct TurningPhase {
    /// `[V]` phase (rad).
    phase: Vec<f64>,
    /// `[E]` turns to add to the higher vertex's phase so that the difference to the lower one's is
    /// that along the edge.
    turns: Vec<i64>,
}

impl TurningPhase {
    fn new(topology: &Topology, field: &WrinkleField) -> Self {
        let mut phase = vec![0.0; topology.vertex_count];
        let mut seen = vec![false; topology.vertex_count];
        let mut turns = vec![0; topology.edge_count()];
        for (f, face) in topology.faces.iter().enumerate() {
            if field.wrinkle_free[f] {
                continue;
            }
            for k in 0..3 {
                if !seen[face[k]] {
                    seen[face[k]] = true;
                    phase[face[k]] = field.phase[f][k];
                }
            }
            let offset = |k: usize| ((field.phase[f][k] - phase[face[k]]) / TAU).round() as i64;
            for k in 0..3 {
                let l = (k + 1) % 3;
                turns[topology.face_edges[f][k]] =
                    if face[k] < face[l] { offset(l) - offset(k) } else { offset(k) - offset(l) };
            }
        }
        Self { phase, turns }
    }

    /// Turns of vertex `to` in the chart of `from`, along their edge `e`.
    fn turns_towards(&self, topology: &Topology, e: usize, from: usize) -> i64 {
        if topology.edges[e][0] == from { self.turns[e] } else { -self.turns[e] }
    }

    fn refined(&self, coarse: &Topology, masks: &Masks, fine: &Topology) -> Self {
        // A new vertex takes the chart of the vertex it comes from; on an edge that is the lower
        // one.
        let in_chart_of_home = |v: usize| {
            let row = masks.row(v);
            let home = row.vertices[0];
            let mut value = self.phase[home];
            for k in 1..row.vertices.len() {
                let turns = self.turns_towards(coarse, row.edges[k], home);
                value += row.weights[k]
                    * (self.phase[row.vertices[k]] - self.phase[home] + TAU * turns as f64);
            }
            value
        };
        let home = |v: usize| {
            if v < coarse.vertex_count { v } else { coarse.edges[v - coarse.vertex_count][0] }
        };
        // Both ends of a fine edge expressed in the chart of the first one's home.
        let turns_along = |e: usize| {
            let [from, to] = fine.edges[e].map(home);
            if from == to {
                return 0;
            }
            // The homes are corners of the coarse face that the edge lies in.
            let sides = coarse.face_edges[fine.edge_faces[e][0] / 4];
            let between = sides.into_iter().find(|&side| {
                coarse.edges[side].contains(&from) && coarse.edges[side].contains(&to)
            });
            self.turns_towards(coarse, between.expect("two corners of a face share a side"), from)
        };
        Self {
            phase: (0..fine.vertex_count).into_par_iter().map(in_chart_of_home).collect(),
            turns: (0..fine.edge_count()).into_par_iter().map(turns_along).collect(),
        }
    }

    fn corners(&self, topology: &Topology, wrinkle_free: &[bool]) -> Vec<[f64; 3]> {
        topology
            .faces
            .par_iter()
            .enumerate()
            .map(|(f, face)| {
                if wrinkle_free[f] {
                    return [0.0; 3];
                }
                let turns = |e: usize| TAU * self.turns_towards(topology, e, face[0]) as f64;
                let [first, _, last] = topology.face_edges[f];
                [
                    self.phase[face[0]],
                    self.phase[face[1]] + turns(first),
                    self.phase[face[2]] + turns(last),
                ]
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::Material;

    /// A ring of `n` squares around a cylinder, `m` high, with a phase of `waves` turns around it
    /// and jumps put at odd places.
    fn ring(n: usize, m: usize, waves: f64) -> (Sheet, Vec<Vec3>, WrinkleField) {
        let at = |i: usize, j: usize| j * n + i % n;
        let rest_at = |i: usize, j: usize| j * (n + 1) + i;
        let (mut faces, mut rest_faces, mut phase) = (Vec::new(), Vec::new(), Vec::new());
        for j in 0..m {
            for i in 0..n {
                for square in
                    [[(i, j), (i + 1, j), (i + 1, j + 1)], [(i, j), (i + 1, j + 1), (i, j + 1)]]
                {
                    faces.push(square.map(|(i, j)| at(i, j)));
                    rest_faces.push(square.map(|(i, j)| rest_at(i, j)));
                    let jump = ((i * 5 + j * 3) % 4) as f64;
                    phase.push(square.map(|(i, _)| TAU * (waves * i as f64 / n as f64 + jump)));
                }
            }
        }
        let angle = |i: usize| TAU * i as f64 / n as f64;
        let positions = (0..(m + 1) * n)
            .map(|v| Vec3::new(angle(v % n).cos(), angle(v % n).sin(), (v / n) as f64 * 0.3))
            .collect();
        let rest_positions = (0..(m + 1) * (n + 1))
            .map(|v| Vec3::new(angle(v % (n + 1)), (v / (n + 1)) as f64 * 0.3, 0.0))
            .collect();
        let rest_shape = RestShape { positions: rest_positions, faces: rest_faces };
        let sheet = Sheet::sewn(faces, rest_shape, Material::new(1e6, 0.3, 1e-4).unwrap()).unwrap();
        let topology = &sheet.topology;
        let field = WrinkleField {
            amplitude_m: vec![0.1; topology.vertex_count],
            omega: vec![0.0; topology.edge_count()],
            phase,
            wrinkle_free: vec![false; topology.face_count()],
        };
        (sheet, positions, field)
    }

    #[test]
    fn a_phase_that_winds_evenly_keeps_winding_evenly() {
        let n = 10;
        let (sheet, positions, field) = ring(n, 4, 7.0);
        let fine = upsample(&sheet, &positions, &field, 3);
        // Along the ring the phase is linear in the rest coordinate, at every corner, up to whole
        // turns.
        for f in 0..fine.topology.face_count() {
            let corners = fine.rest_shape.corners(f);
            for k in 0..3 {
                let expected = 7.0 * corners[k].x;
                let turns = (fine.phase[f][k] - expected) / TAU;
                assert!((turns - turns.round()).abs() < 1e-9, "face {f}: {turns}");
                // Inside a face there is no jump.
                let l = (k + 1) % 3;
                let step = 7.0 * (corners[l].x - corners[k].x);
                assert!((fine.phase[f][l] - fine.phase[f][k] - step).abs() < 1e-9);
            }
        }
        assert_eq!(fine.topology.face_count(), 64 * sheet.topology.face_count());
        assert!(fine.amplitude_m.iter().all(|a| (a - 0.1).abs() < 1e-12));
    }

    #[test]
    fn wrinkle_free_faces_stay_flat() {
        let (sheet, positions, mut field) = ring(12, 6, 3.0);
        for f in 40..72 {
            field.wrinkle_free[f] = true;
            field.phase[f] = [0.0; 3];
            for v in sheet.topology.faces[f] {
                field.amplitude_m[v] = 0.0;
            }
        }
        let fine = upsample(&sheet, &positions, &field, 2);
        for (f, face) in fine.topology.faces.iter().enumerate() {
            if fine.wrinkle_free[f] {
                assert!(face.iter().all(|&v| fine.amplitude_m[v] == 0.0));
            }
        }
        assert!(
            fine.amplitude_m.iter().all(|a| *a >= 0.0)
                && fine.amplitude_m.iter().any(|a| *a > 0.09)
        );
    }

    #[test]
    fn sharp_boundary_corners_stay() {
        let rest: Vec<Vec3> = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0], [1.1, 0.4]]
            .iter()
            .map(|p| Vec3::new(p[0], p[1], 0.0))
            .collect();
        let faces = vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
        let material = Material::new(1e6, 0.3, 1e-4).unwrap();
        let sheet = Sheet::from_rest(rest.clone(), faces, material).unwrap();
        let field = WrinkleField {
            amplitude_m: vec![0.0; 5],
            omega: vec![0.0; 8],
            phase: vec![[0.0; 3]; 4],
            wrinkle_free: vec![true; 4],
        };
        let fine = upsample(&sheet, &rest, &field, 3);
        for v in 0..4 {
            assert_eq!(fine.base[v], rest[v]);
        }
    }
}
