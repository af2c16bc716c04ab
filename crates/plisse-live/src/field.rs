//! Live waves to and from the library's [`WrinkleField`].
//!
//! A field has one orientation over its surface and phases that differ along edges by its one-form;
//! live waves have a sign each and agree only more or less. [`to_field`] turns signs alike,
//! outwards from the strongest wrinkle, and rounds each edge's whole waves to what the waves at its
//! ends say. A face where signs or whole waves do not close (a bifurcation) becomes wrinkle-free.

use std::collections::VecDeque;
use std::f64::consts::TAU;

use plisse::field::WrinkleField;
use plisse::mesh::Topology;
use plisse::{At, Result};

use crate::Vec3;
use crate::crush::Crushed;
use crate::skin::Skinned;
use crate::unify::Unified;

/// Plane waves per vertex, as Render takes them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Waves {
    /// `[U]` amplitude (m).
    pub amplitude_m: Vec<f32>,
    /// `[U]` wave vector (rad/m, posed).
    pub wave: Vec<Vec3>,
    /// `[U]` phase (rad).
    pub phase: Vec<f32>,
}

/// The connectivity of the unified mesh as the library has it.
///
/// # Errors
/// [`plisse::Error::Mesh`] at `place`, as [`Topology::new`]: live meshes may have slivers, isolated
/// vertices and edges on three faces, fields may not.
pub fn topology(place: &str, unified: &Unified) -> Result<Topology> {
    let faces = unified.faces.iter().map(|f| f.map(|v| v as usize)).collect();
    Topology::new(unified.count(), faces).at(place)
}

/// The field of the waves in `crushed` with `phase` (`[U]`, rad) over the posed `positions` (`[U]`,
/// m).
pub fn to_field(
    topology: &Topology,
    unified: &Unified,
    positions: &[Vec3],
    crushed: &Crushed,
    phase: &[f32],
) -> WrinkleField {
    let sign = orient(unified, crushed);
    let wave = |v: usize| crushed.wave[v] * sign[v];
    let phase = |v: usize| f64::from(phase[v] * sign[v]);
    let mut agree = Vec::with_capacity(topology.edge_count());
    let mut omega = Vec::with_capacity(topology.edge_count());
    for &[i, j] in &topology.edges {
        let asked = f64::from((0.5 * (wave(i) + wave(j))).dot(&(positions[j] - positions[i])));
        let difference = phase(j) - phase(i);
        omega.push(difference + TAU * ((asked - difference) / TAU).round());
        agree.push(wave(i).dot(&wave(j)) >= 0.0);
    }
    let mut field = WrinkleField {
        amplitude_m: crushed.amplitude_m.iter().map(|&a| f64::from(a)).collect(),
        omega: vec![0.0; topology.edge_count()],
        phase: vec![[0.0; 3]; topology.face_count()],
        wrinkle_free: vec![true; topology.face_count()],
    };
    for (f, face) in topology.faces.iter().enumerate() {
        let edges = topology.face_edges[f];
        let along = [0, 1, 2].map(|k| topology.side_sign(f, k) * omega[edges[k]]);
        let wrinkled = face.iter().any(|&v| crushed.amplitude_m[v] > 0.0);
        if wrinkled
            && edges.iter().all(|&e| agree[e])
            && along.iter().sum::<f64>().abs() < 0.5 * TAU
        {
            field.wrinkle_free[f] = false;
            let first = phase(face[0]);
            field.phase[f] = [first, first + along[0], first - along[2]];
            edges.iter().for_each(|&e| field.omega[e] = omega[e]);
        }
    }
    field
}

/// The waves that show `field` over the surface `posed`: k′ from dφ, averaged over the faces around
/// each vertex by area.
pub fn from_field(topology: &Topology, posed: &Skinned, field: &WrinkleField) -> Waves {
    let count = topology.vertex_count;
    let mut sum = vec![Vec3::zeros(); count];
    let mut areas = vec![0f32; count];
    let mut phase = vec![None; count];
    for (f, face) in topology.faces.iter().enumerate().filter(|(f, _)| !field.wrinkle_free[*f]) {
        let [a, b, c] = face.map(|v| posed.positions[v]);
        let (side_b, side_c) = (b - a, c - a);
        let twice = side_b.cross(&side_c);
        let Some(n) = twice.try_normalize(1e-30) else { continue };
        let along_b = (topology.side_sign(f, 0) * field.omega[topology.face_edges[f][0]]) as f32;
        let along_c = (-topology.side_sign(f, 2) * field.omega[topology.face_edges[f][2]]) as f32;
        let gradient = (side_c.cross(&n) * along_b + n.cross(&side_b) * along_c) / twice.norm();
        for (k, &v) in face.iter().enumerate() {
            sum[v] += gradient * twice.norm();
            areas[v] += twice.norm();
            phase[v].get_or_insert(field.phase[f][k] as f32);
        }
    }
    let mut waves = Waves::default();
    for v in 0..count {
        let mean = if areas[v] > 0.0 { sum[v] / areas[v] } else { Vec3::zeros() };
        waves.wave.push(mean - posed.normals[v] * posed.normals[v].dot(&mean));
        waves.phase.push(phase[v].map_or(0.0, crate::wrap));
        waves.amplitude_m.push(if phase[v].is_some() { field.amplitude_m[v] as f32 } else { 0.0 });
    }
    waves
}

/// `[U]` sign that turns each wave like its predecessor's, walking from the strongest vertex of
/// each piece over wrinkled ones first.
fn orient(unified: &Unified, crushed: &Crushed) -> Vec<f32> {
    let mut by_strength: Vec<usize> = (0..unified.count()).collect();
    by_strength
        .sort_by(|&a, &b| crushed.strength[b].total_cmp(&crushed.strength[a]).then(a.cmp(&b)));
    let mut sign = vec![0f32; unified.count()];
    for seed in by_strength {
        if sign[seed] != 0.0 {
            continue;
        }
        sign[seed] = 1.0;
        let mut queue = VecDeque::from([seed]);
        while let Some(v) = queue.pop_front() {
            for n in unified.around(v).iter().map(|&n| n as usize) {
                // Waves that nobody sees lead nowhere, but are led.
                if sign[n] == 0.0 && (crushed.strength[v] > 0.0 || crushed.strength[n] == 0.0) {
                    sign[n] = if crushed.wave[n].dot(&crushed.wave[v]) < 0.0 {
                        -sign[v]
                    } else {
                        sign[v]
                    };
                    queue.push_back(n);
                }
            }
        }
    }
    sign
}
