//! The closed form nearest to given frequencies on faces, in the L² norm of the rest metric: with
//! free periods (for the initial guess) or with periods that are whole multiples of 2π (for the
//! phase).

use super::closed_forms::ClosedForms;
use super::phase_unknowns::PhaseUnknowns;
use crate::Result;
use crate::linalg::cholesky::Cholesky;
use crate::linalg::lattice::closest_integers;
use crate::linalg::sparse::SymmetricPattern;
use crate::mesh::{Mat2, Topology, Vec2};
use crate::rest::RestMetric;

/// Nodes that the search for the best integers may visit before it settles for the best found.
const NODE_BUDGET: usize = 2_000_000;

/// The normal equations of min Σ_f weight_f·area_f·|dφ + Hc − target_f|², factorised on demand.
pub struct ClosestClosedForm {
    unknowns: PhaseUnknowns,
    elements: Vec<Element>,
    values: Vec<f64>,
    cholesky: Cholesky,
}

struct Element {
    face: usize,
    /// weight·area·L⁻¹, so that target enters as its transpose.
    scaled_root: Mat2,
    terms: Vec<(usize, [f64; 2])>,
}

/// Periods rounded to whole numbers, and the phases that go with them.
pub struct Rounded {
    /// `[V]` phase (rad).
    pub phases: Vec<f64>,
    /// `[b₁]` whole turns around each generator's loop.
    pub turns: Vec<i64>,
    /// True if the integers are proven to be the best.
    pub exact: bool,
}

impl ClosestClosedForm {
    /// The equations on the faces with `weight` (`[F]`, no unit) above zero; `forms` must belong to
    /// the same faces or more.
    ///
    /// # Errors
    /// Only if the factorisation's memory cannot be had.
    pub fn new(
        topology: &Topology,
        rest: &RestMetric,
        forms: &ClosedForms,
        weight: &[f64],
    ) -> Result<Self> {
        let unknowns = PhaseUnknowns::new(forms);
        let elements: Vec<Element> = (0..topology.face_count())
            .filter(|&f| weight[f] > 0.0)
            .map(|f| Element {
                face: f,
                scaled_root: rest.faces[f].inverse_root * (weight[f] * rest.faces[f].area_m2),
                terms: unknowns.of_face(topology, forms, f),
            })
            .collect();
        let lists: Vec<Vec<usize>> =
            elements.iter().map(|e| e.terms.iter().map(|t| t.0).collect()).collect();
        let pattern =
            SymmetricPattern::from_elements(unknowns.count, lists.iter().map(Vec::as_slice));
        let mut values = vec![0.0; pattern.entry_count()];
        for (element, list) in elements.iter().zip(&lists) {
            let metric = element.scaled_root.transpose() * rest.faces[element.face].inverse_root;
            let mut slots = pattern.element_slots(list);
            for (n, (_, p)) in element.terms.iter().enumerate() {
                let row = metric * Vec2::new(p[0], p[1]);
                for (_, q) in &element.terms[..=n] {
                    values[slots.next().expect("one slot a pair")] += row[0] * q[0] + row[1] * q[1];
                }
            }
        }
        // Vertices that no weighted face holds must not make the matrix singular.
        let diagonal: Vec<usize> = (0..unknowns.count).map(|i| pattern.slot(i, i)).collect();
        let largest = diagonal.iter().map(|&s| values[s]).fold(0.0, f64::max);
        for s in diagonal {
            values[s] += if largest > 0.0 { 1e-14 * largest } else { 1.0 };
        }
        Ok(Self { unknowns, elements, values, cholesky: Cholesky::new(pattern)? })
    }

    /// Phases (`[V]`, rad) and coefficients (`[b₁]`, rad) nearest to the frequencies `target`
    /// (`[F]`, rad/m, in the faces' orthonormal rest frames).
    pub fn with_free_periods(&mut self, target: &[Vec2]) -> (Vec<f64>, Vec<f64>) {
        let mut x = vec![0.0; self.unknowns.count];
        for element in &self.elements {
            let along = element.scaled_root.transpose() * target[element.face];
            for (unknown, w) in &element.terms {
                x[*unknown] += w[0] * along[0] + w[1] * along[1];
            }
        }
        if !self.cholesky.factorise(&self.values) {
            x.fill(0.0);
            return (self.unknowns.phases(&x), x[self.unknowns.phase_count..].to_vec());
        }
        self.cholesky.solve(&mut x);
        (self.unknowns.phases(&x), x[self.unknowns.phase_count..].to_vec())
    }

    /// The closed form with periods in 2πℤ that is nearest to the closed form of `phases` and
    /// `coefficients`.
    ///
    /// With δφ eliminated, the distance is (2πz − c)ᵀM(2πz − c) in the integers z: a closest-vector
    /// problem.
    pub fn with_whole_periods(&mut self, phases: &[f64], coefficients: &[f64]) -> Rounded {
        let n = self.unknowns.count;
        let first = self.unknowns.phase_count;
        let count = coefficients.len();
        // Columns of the matrix at the coefficients.
        let columns: Vec<Vec<f64>> = (0..count)
            .map(|k| {
                let (mut unit, mut column) = (vec![0.0; n], vec![0.0; n]);
                unit[first + k] = 1.0;
                self.cholesky.pattern().multiply(&self.values, &unit, &mut column);
                column
            })
            .collect();
        let mut fixed = vec![false; n];
        fixed[first..].fill(true);
        let mut phase_values = self.values.clone();
        self.cholesky.pattern().isolate(&mut phase_values, &fixed);
        let factorised = self.cholesky.factorise(&phase_values);
        let answers: Vec<Vec<f64>> = columns
            .iter()
            .map(|column| {
                let mut x = column.clone();
                x[first..].fill(0.0);
                if factorised {
                    self.cholesky.solve(&mut x);
                }
                x
            })
            .collect();
        let mut metric = vec![0.0; count * count];
        for k in 0..count {
            for l in 0..count {
                metric[k * count + l] = columns[k][first + l]
                    - columns[k][..first]
                        .iter()
                        .zip(&answers[l][..first])
                        .map(|(a, b)| a * b)
                        .sum::<f64>();
            }
        }
        let turn = std::f64::consts::TAU;
        let turns_before: Vec<f64> = coefficients.iter().map(|c| c / turn).collect();
        let closest = closest_integers(&metric, &turns_before, NODE_BUDGET);
        let mut moved = phases.to_vec();
        for k in 0..count {
            let change = turn * closest.integers[k] as f64 - coefficients[k];
            for (v, &i) in self.unknowns.of_vertex.iter().enumerate() {
                if i < first {
                    moved[v] -= change * answers[k][i];
                }
            }
        }
        Rounded { phases: moved, turns: closest.integers, exact: closest.exact }
    }
}
