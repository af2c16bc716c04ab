//! The wrinkle energy as a function of amplitudes, phases and periods, which the field solve
//! minimises.
//!
//! Unknowns, in this order: amplitude of every vertex that may wrinkle, phase of every wrinkled
//! vertex but one a component, one coefficient c for each generator. Closedness of ω needs no
//! constraint, since every unknown makes closed forms only; what is left are the bounds a ≥ 0.
//! Amplitudes are in units of [`FieldProblem::amplitude_unit_m`] and energies in units of
//! [`FieldProblem::energy_unit_joule`], so that neither the solve nor its tolerances depend on the
//! user's units.

use rayon::prelude::*;

use super::closed_forms::ClosedForms;
use super::density::{Density, Local, LocalHessian};
use super::domain::Domain;
use super::initialise::Unrounded;
use super::phase_unknowns::PhaseUnknowns;
use crate::linalg::Problem;
use crate::linalg::ordered_sum::{CHUNK, ordered_sum};
use crate::linalg::psd_projection::{PsdProjection, project_to_psd};
use crate::linalg::sparse::SymmetricPattern;
use crate::mesh::{NONE, Topology};

/// The reduced problem on a mesh. Made once; only its work space changes.
pub struct FieldProblem<'a> {
    topology: &'a Topology,
    forms: &'a ClosedForms,
    /// Metres in one unit of amplitude.
    pub amplitude_unit_m: f64,
    /// Joules in one unit of energy.
    pub energy_unit_joule: f64,
    amplitude_count: usize,
    size: usize,
    amplitude_unknown: Vec<usize>,
    closed: PhaseUnknowns,
    elements: Vec<Element>,
    /// Unknowns of all elements, one after the other, and how ω₀₁ and ω₀₂ change with them.
    unknowns: Vec<usize>,
    weights: Vec<[f64; 2]>,
    pattern: SymmetricPattern,
    slots: Vec<u32>,
    states: Vec<State>,
    convex: Vec<LocalHessian>,
}

struct Element {
    density: Density,
    /// Range in `unknowns` and `weights`; the first `amplitudes` of them are amplitudes, at corners
    /// `corner`.
    first: usize,
    last: usize,
    amplitudes: usize,
    corner: [usize; 3],
    first_slot: usize,
}

#[derive(Clone)]
struct State {
    energy: f64,
    gradient: Local,
    hessian: LocalHessian,
}

impl<'a> FieldProblem<'a> {
    /// The problem on `domain` with these `densities` (`[F]`).
    pub fn new(
        topology: &'a Topology,
        domain: &'a Domain,
        densities: &[Density],
        amplitude_unit_m: f64,
        energy_unit_joule: f64,
    ) -> Self {
        let Domain { wrinkle_free, still, forms } = domain;
        let mut amplitude_unknown = vec![NONE; topology.vertex_count];
        let mut amplitude_count = 0;
        for v in 0..topology.vertex_count {
            if forms.component[v] != NONE && !still[v] {
                amplitude_unknown[v] = amplitude_count;
                amplitude_count += 1;
            }
        }
        let closed = PhaseUnknowns::new(forms);
        let size = amplitude_count + closed.count;

        let (mut elements, mut unknowns, mut weights) = (Vec::new(), Vec::new(), Vec::new());
        for f in (0..topology.face_count()).filter(|&f| !wrinkle_free[f]) {
            let first = unknowns.len();
            let face = topology.faces[f];
            let mut corner = [0; 3];
            for (k, &v) in face.iter().enumerate() {
                if amplitude_unknown[v] != NONE {
                    corner[unknowns.len() - first] = k;
                    unknowns.push(amplitude_unknown[v]);
                    weights.push([0.0; 2]);
                }
            }
            let amplitudes = unknowns.len() - first;
            for (unknown, weight) in closed.of_face(topology, forms, f) {
                unknowns.push(amplitude_count + unknown);
                weights.push(weight);
            }
            elements.push(Element {
                density: densities[f],
                first,
                last: unknowns.len(),
                amplitudes,
                corner,
                first_slot: 0,
            });
        }
        let pattern = SymmetricPattern::from_elements(
            size,
            elements.iter().map(|e| &unknowns[e.first..e.last]),
        );
        let mut slots = Vec::new();
        for element in &mut elements {
            element.first_slot = slots.len();
            slots.extend(
                pattern.element_slots(&unknowns[element.first..element.last]).map(|s| s as u32),
            );
        }
        let states =
            vec![
                State { energy: 0.0, gradient: Local::zeros(), hessian: LocalHessian::zeros() };
                elements.len()
            ];
        let convex = vec![LocalHessian::zeros(); elements.len()];
        Self {
            topology,
            forms,
            amplitude_unit_m,
            energy_unit_joule,
            amplitude_count,
            size,
            amplitude_unknown,
            closed,
            elements,
            unknowns,
            weights,
            pattern,
            slots,
            states,
            convex,
        }
    }

    /// Number of unknowns.
    pub fn size(&self) -> usize {
        self.size
    }

    /// The unknowns of a field.
    pub fn pack(&self, field: &Unrounded) -> Vec<f64> {
        let Unrounded { amplitude_m, phases, coefficients } = field;
        let mut x = vec![0.0; self.size];
        for v in 0..self.topology.vertex_count {
            if self.amplitude_unknown[v] != NONE {
                x[self.amplitude_unknown[v]] = amplitude_m[v] / self.amplitude_unit_m;
            }
            if self.closed.of_vertex[v] != NONE {
                x[self.amplitude_count + self.closed.of_vertex[v]] =
                    phases[v] - phases[self.forms.roots[self.forms.component[v]]];
            }
        }
        x[self.size - coefficients.len()..].copy_from_slice(coefficients);
        x
    }

    /// Trades amplitude for frequency all over, a → ka and ω → ω/k, so that the energy is least:
    /// the compression that is taken up stays the same (eq. 8), while bending and curvature find
    /// their balance. A field starts in the right valley then.
    pub fn rescale(&mut self, x: &mut [f64]) {
        let mut trial = x.to_vec();
        let mut energy = |log_k: f64| {
            let k = log_k.exp2();
            for i in 0..x.len() {
                trial[i] = if i < self.amplitude_count { x[i] * k } else { x[i] / k };
            }
            self.energy(&trial)
        };
        let coarse = (-16..=16).map(|n| f64::from(n) * 0.5).map(|log_k| (log_k, energy(log_k)));
        let (mut best, mut least) = coarse
            .fold((0.0, f64::INFINITY), |best, next| if next.1 < best.1 { next } else { best });
        let mut step = 0.25;
        while step > 0.01 {
            for candidate in [best - step, best + step] {
                let value = energy(candidate);
                if value < least {
                    (best, least) = (candidate, value);
                }
            }
            step *= 0.5;
        }
        let k = best.exp2();
        for (i, x) in x.iter_mut().enumerate() {
            *x *= if i < self.amplitude_count { k } else { 1.0 / k };
        }
    }

    /// The field of the unknowns `x`: amplitudes are zero where there is no unknown, phases at the
    /// root of each component and outside.
    pub fn unpack(&self, x: &[f64]) -> Unrounded {
        Unrounded {
            amplitude_m: self.amplitudes_m(x),
            phases: self.closed.phases(&x[self.amplitude_count..]),
            coefficients: x[self.size - self.forms.generators.len()..].to_vec(),
        }
    }

    fn amplitudes_m(&self, x: &[f64]) -> Vec<f64> {
        self.amplitude_unknown
            .iter()
            .map(|&i| if i == NONE { 0.0 } else { x[i] * self.amplitude_unit_m })
            .collect()
    }

    /// Largest component of a projected gradient in SI units: J/m for amplitudes, J/rad for phases
    /// and coefficients.
    pub fn projected_gradient_si(&self, x: &[f64], gradient: &[f64]) -> f64 {
        let mut largest = 0.0_f64;
        for i in 0..self.size {
            let (lower, unit) = if i < self.amplitude_count {
                (0.0, self.amplitude_unit_m)
            } else {
                (f64::NEG_INFINITY, 1.0)
            };
            largest = largest.max(
                crate::linalg::newton::projected_gradient(x[i], lower, gradient[i]).abs()
                    * self.energy_unit_joule
                    / unit,
            );
        }
        largest
    }

    fn local(&self, element: &Element, x: &[f64]) -> Local {
        let mut local = Local::zeros();
        let range = element.first..element.last;
        for (n, (&i, w)) in
            self.unknowns[range.clone()].iter().zip(&self.weights[range]).enumerate()
        {
            if n < element.amplitudes {
                local[element.corner[n]] = x[i] * self.amplitude_unit_m;
            } else {
                local[3] += w[0] * x[i];
                local[4] += w[1] * x[i];
            }
        }
        local
    }
}

impl Problem for FieldProblem<'_> {
    fn pattern(&self) -> SymmetricPattern {
        self.pattern.clone()
    }

    fn lower_bounds(&self) -> Vec<f64> {
        (0..self.size)
            .map(|i| if i < self.amplitude_count { 0.0 } else { f64::NEG_INFINITY })
            .collect()
    }

    fn energy(&mut self, x: &[f64]) -> f64 {
        // Sums of fixed chunks, added in order: the same for any number of threads.
        let energy = |e: usize| {
            let element = &self.elements[e];
            element.density.energy(&self.local(element, x))
        };
        ordered_sum(self.elements.len(), energy) / self.energy_unit_joule
    }

    fn value_and_gradient(&mut self, x: &[f64], gradient: &mut [f64]) -> f64 {
        let mut states = std::mem::take(&mut self.states);
        states.par_chunks_mut(CHUNK).zip(self.elements.par_chunks(CHUNK)).for_each(
            |(states, elements)| {
                for (state, element) in states.iter_mut().zip(elements) {
                    (state.energy, state.gradient, state.hessian) =
                        element.density.derivatives(&self.local(element, x));
                    // From here on in the units of the unknowns.
                    for i in 0..3 {
                        state.gradient[i] *= self.amplitude_unit_m;
                        for j in 0..5 {
                            state.hessian[(i, j)] *= self.amplitude_unit_m;
                            state.hessian[(j, i)] *= self.amplitude_unit_m;
                        }
                    }
                    state.gradient /= self.energy_unit_joule;
                    state.hessian /= self.energy_unit_joule;
                }
            },
        );
        self.states = states;
        gradient.fill(0.0);
        for (state, element) in self.states.iter().zip(&self.elements) {
            for n in element.first..element.last {
                let w = self.weights[n];
                gradient[self.unknowns[n]] += if n - element.first < element.amplitudes {
                    state.gradient[element.corner[n - element.first]]
                } else {
                    w[0] * state.gradient[3] + w[1] * state.gradient[4]
                };
            }
        }
        let sums =
            self.states.chunks(CHUNK).map(|chunk| chunk.iter().map(|s| s.energy).sum::<f64>());
        sums.sum::<f64>() / self.energy_unit_joule
    }

    fn hessian(&mut self, projection: PsdProjection, values: &mut [f64]) {
        self.convex.par_chunks_mut(CHUNK).zip(self.states.par_chunks(CHUNK)).for_each(
            |(convex, states)| {
                for (convex, state) in convex.iter_mut().zip(states) {
                    *convex = project_to_psd(&state.hessian, projection);
                }
            },
        );
        values.fill(0.0);
        for (h, element) in self.convex.iter().zip(&self.elements) {
            let mut slot = element.first_slot;
            for n in element.first..element.last {
                // Row n of JᵀH, as a vector of the five local unknowns.
                let row: Local = if n - element.first < element.amplitudes {
                    h.column(element.corner[n - element.first]).into_owned()
                } else {
                    h.column(3) * self.weights[n][0] + h.column(4) * self.weights[n][1]
                };
                for m in element.first..=n {
                    values[self.slots[slot] as usize] += if m - element.first < element.amplitudes {
                        row[element.corner[m - element.first]]
                    } else {
                        row[3] * self.weights[m][0] + row[4] * self.weights[m][1]
                    };
                    slot += 1;
                }
            }
        }
    }
}
