//! Live waves to and from the library's [`WrinkleField`].
//!
//! A field has one orientation over its surface, and its phases differ along edges by its one-form.
//! Live waves have a sign each and agree only roughly. [`to_field`] makes signs consistent,
//! outwards from the strongest wrinkle, and rounds each edge's number of whole waves to that of the
//! waves at its ends. A face where signs or whole waves do not close (a bifurcation) becomes
//! wrinkle-free.

use std::collections::VecDeque;
use std::f64::consts::TAU;

use plisse::field::WrinkleField;
use plisse::mesh::Topology;
use plisse::{At, Result};

use crate::Vec3;
use crate::crush::PlaneWaves;
use crate::relax::PhaseCoupling;
use crate::skin::PosedVertices;
use crate::weld::WeldedMesh;

/// The plane wave of each vertex with its phase, as Render reads them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Waves {
    /// `[U]` amplitude (m).
    pub amplitude_m: Vec<f32>,
    /// `[U]` wave vector (rad/m, posed).
    pub wave: Vec<Vec3>,
    /// `[U]` phase (rad).
    pub phase: Vec<f32>,
}

/// The connectivity of the welded mesh as the library has it.
///
/// # Errors
/// [`plisse::Error::Mesh`] at `place`, as [`Topology::new`]: live meshes may have slivers, isolated
/// vertices and edges on three faces, fields may not.
pub fn topology(place: &str, welded: &WeldedMesh) -> Result<Topology> {
    let faces = welded.faces.iter().map(|f| f.map(|v| v as usize)).collect();
    Topology::new(welded.count(), faces).at(place)
}

/// The field of the waves of `coupling` with `phase` (`[U]`, rad).
pub fn to_field(topology: &Topology, coupling: &PhaseCoupling<'_>, phase: &[f32]) -> WrinkleField {
    let PhaseCoupling { mesh, positions, waves } = *coupling;
    let sign = orient(mesh, waves);
    let wave = |v: usize| waves.wave[v] * sign[v];
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
        amplitude_m: waves.amplitude_m.iter().map(|&a| f64::from(a)).collect(),
        omega: vec![0.0; topology.edge_count()],
        phase: vec![[0.0; 3]; topology.face_count()],
        wrinkle_free: vec![true; topology.face_count()],
    };
    for (f, face) in topology.faces.iter().enumerate() {
        let edges = topology.face_edges[f];
        let along = [0, 1, 2].map(|k| topology.side_sign(f, k) * omega[edges[k]]);
        let wrinkled = face.iter().any(|&v| waves.amplitude_m[v] > 0.0);
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
pub fn from_field(topology: &Topology, posed: &PosedVertices, field: &WrinkleField) -> Waves {
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

/// `[U]` sign that turns each wave like its predecessor's. The walk goes from the strongest vertex
/// of each piece over wrinkled ones first.
fn orient(welded: &WeldedMesh, waves: &PlaneWaves) -> Vec<f32> {
    let mut by_strength: Vec<usize> = (0..welded.count()).collect();
    by_strength.sort_by(|&a, &b| waves.strength[b].total_cmp(&waves.strength[a]).then(a.cmp(&b)));
    let mut sign = vec![0f32; welded.count()];
    for seed in by_strength {
        if sign[seed] != 0.0 {
            continue;
        }
        sign[seed] = 1.0;
        let mut queue = VecDeque::from([seed]);
        while let Some(v) = queue.pop_front() {
            for n in welded.around(v).iter().map(|&n| n as usize) {
                // Invisible waves take a sign, but hand none on.
                if sign[n] == 0.0 && (waves.strength[v] > 0.0 || waves.strength[n] == 0.0) {
                    sign[n] =
                        if waves.wave[n].dot(&waves.wave[v]) < 0.0 { -sign[v] } else { sign[v] };
                    queue.push_back(n);
                }
            }
        }
    }
    sign
}
