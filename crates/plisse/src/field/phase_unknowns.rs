//! Unknowns that make closed forms only, a phase per vertex and a coefficient per generator, and
//! the derivative of ω on a face by them.

use super::closed_forms::ClosedForms;
use crate::mesh::{NONE, Topology};

/// Numbers the unknowns: a phase for every wrinkled vertex but the root of its component, then a
/// coefficient for each generator.
#[derive(Clone, Debug)]
pub struct PhaseUnknowns {
    /// `[V]` number of each vertex's phase, [`NONE`] for roots and vertices without wrinkles.
    pub of_vertex: Vec<usize>,
    /// Number of phases: the coefficient of generator k is unknown `phase_count + k`.
    pub phase_count: usize,
    /// Number of unknowns.
    pub count: usize,
}

impl PhaseUnknowns {
    /// The unknowns for a basis of closed forms.
    pub fn new(forms: &ClosedForms) -> Self {
        let mut of_vertex = vec![NONE; forms.component.len()];
        let mut phase_count = 0;
        for (v, &component) in forms.component.iter().enumerate() {
            if component != NONE && forms.roots[component] != v {
                of_vertex[v] = phase_count;
                phase_count += 1;
            }
        }
        Self { of_vertex, phase_count, count: phase_count + forms.generators.len() }
    }

    /// The unknowns on which ω of face `f` depends, each with the change of (ω₀₁, ω₀₂) with it.
    pub fn of_face(
        &self,
        topology: &Topology,
        forms: &ClosedForms,
        f: usize,
    ) -> Vec<(usize, [f64; 2])> {
        let mut list: Vec<(usize, [f64; 2])> = topology.faces[f]
            .iter()
            .zip([[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]])
            .filter(|(v, _)| self.of_vertex[**v] != NONE)
            .map(|(&v, weight)| (self.of_vertex[v], weight))
            .collect();
        // Side 0 runs 0→1; side 2 runs 2→0, against 0→2.
        for (which, (side, sign)) in
            [(0, topology.side_sign(f, 0)), (2, -topology.side_sign(f, 2))].into_iter().enumerate()
        {
            for &(k, value) in &forms.on_edge[topology.face_edges[f][side]] {
                let unknown = self.phase_count + k;
                let at = list.iter().position(|(u, _)| *u == unknown).unwrap_or_else(|| {
                    list.push((unknown, [0.0; 2]));
                    list.len() - 1
                });
                list[at].1[which] += sign * f64::from(value);
            }
        }
        list.sort_unstable_by_key(|&(unknown, _)| unknown);
        list
    }

    /// `[V]` phases (rad) in unknowns `x`; zero at roots and where there is none.
    pub fn phases(&self, x: &[f64]) -> Vec<f64> {
        self.of_vertex.iter().map(|&i| if i == NONE { 0.0 } else { x[i] }).collect()
    }
}

/// `[E]` ω = dφ + Σ cₖHₖ (rad, from lower to higher vertex); zero on edges of no wrinkled face.
pub fn one_form(
    topology: &Topology,
    forms: &ClosedForms,
    phases: &[f64],
    coefficients: &[f64],
) -> Vec<f64> {
    topology
        .edges
        .iter()
        .enumerate()
        .map(|(e, &[i, j])| {
            if forms.wrinkled_edge[e] {
                phases[j] - phases[i] + forms.on(e, coefficients)
            } else {
                0.0
            }
        })
        .collect()
}
