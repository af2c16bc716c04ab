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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::phase_unknowns::one_form;
    use crate::mesh::Vec3;

    /// A flat ring of `n` quads, each cut in two, whose outer rim is not round.
    fn ring(n: usize) -> (Topology, RestMetric) {
        let place = |v: usize| {
            let angle = std::f64::consts::TAU * (v / 2) as f64 / n as f64;
            let radius = if v.is_multiple_of(2) { 1.0 } else { 2.0 + 0.3 * angle.sin() };
            Vec3::new(radius * angle.cos(), radius * angle.sin(), 0.0)
        };
        let positions: Vec<Vec3> = (0..2 * n).map(place).collect();
        let quad = |k: usize| [2 * k, 2 * k + 1, (2 * k + 3) % (2 * n), (2 * k + 2) % (2 * n)];
        let faces: Vec<[usize; 3]> =
            (0..n).map(quad).flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        let topology = Topology::new(positions.len(), faces.clone()).unwrap();
        (topology, RestMetric::from_shape(&positions, &faces).unwrap())
    }

    #[test]
    fn phases_move_so_that_whole_periods_change_the_form_least() {
        let (topology, rest) = ring(12);
        let forms = ClosedForms::new(&topology, &vec![false; topology.face_count()]);
        let weight = vec![1.0; topology.face_count()];
        let mut equations = ClosestClosedForm::new(&topology, &rest, &forms, &weight).unwrap();
        let mut phases: Vec<f64> = (0..topology.vertex_count).map(|v| (v as f64).sin()).collect();
        phases[forms.roots[0]] = 0.0;
        let turn = std::f64::consts::TAU;
        let coefficients = [3.3 * turn];
        let before = one_form(&topology, &forms, &phases, &coefficients);
        let distance = |phases: &[f64], turns: i64| {
            let after = one_form(&topology, &forms, phases, &[turn * turns as f64]);
            let change = |e: usize| after[e] - before[e];
            (0..topology.face_count())
                .map(|f| {
                    let [first, _, last] = topology.face_edges[f];
                    let along_01 = topology.side_sign(f, 0) * change(first);
                    let along_02 = -topology.side_sign(f, 2) * change(last);
                    let face = &rest.faces[f];
                    face.area_m2 * face.one_form(along_01, along_02).norm_squared()
                })
                .sum::<f64>()
        };

        let rounded = equations.with_whole_periods(&phases, &coefficients);
        assert_eq!((rounded.turns[0].abs(), rounded.exact), (3, true));
        let least = distance(&rounded.phases, rounded.turns[0]);
        assert!(least < 0.9 * distance(&phases, rounded.turns[0]), "{least}");
        for v in (0..topology.vertex_count).filter(|&v| v != forms.roots[0]) {
            for step in [-1e-3, 1e-3] {
                let mut trial = rounded.phases.clone();
                trial[v] += step;
                assert!(distance(&trial, rounded.turns[0]) > least, "vertex {v}, step {step}");
            }
        }
    }
}
