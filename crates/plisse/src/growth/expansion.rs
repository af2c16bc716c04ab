//! Expansion textures: growth tensors on the starting surface (4.1 of [Combaz & Neyret 2002]).
//!
//! At every vertex the expansion is a symmetric positive definite form τ on the tangent plane of
//! the *starting* surface: an edge that runs along the unit vector l becomes longer by the factor
//! √(lᵗτl), so growing by g in all directions is τ = g²·I. Along an edge lᵗτl runs linearly between
//! the values at its ends, and its root is integrated in closed form.

use crate::mesh::normals::try_vertex_normals;
use crate::mesh::{Mat2, Topology, Vec2, Vec3};
use crate::rest::{RestFace, RestMetric};
use crate::strain::principal_pair;
use crate::{At, Error, Result};

/// Smallest and largest factor by which a length may be asked to grow in one expansion.
const FACTORS: [f64; 2] = [1e-3, 1e3];

/// Growth tensor τ at one vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GrowthTensor {
    /// First unit vector of the tangent frame; the second is the third of a right-handed frame:
    /// normal × first.
    pub along: Vec3,
    /// Second unit vector of the tangent frame.
    pub across: Vec3,
    /// τ (no unit) in that frame: symmetric, positive definite.
    pub form: Mat2,
}

impl GrowthTensor {
    /// dᵗτd (no unit) for the direction of `d` (m, any length) within the tangent plane; 1 where
    /// `d` is normal to it.
    fn square(&self, d: &Vec3) -> f64 {
        let d = Vec2::new(self.along.dot(d), self.across.dot(d));
        let length_squared = d.norm_squared();
        // Exactly 1 where nothing grows.
        if self.form == Mat2::identity() || length_squared == 0.0 {
            return 1.0;
        }
        d.dot(&(self.form * d)) / length_squared
    }

    /// Factors by which lengths grow most and least, and the unit directions in space in which they
    /// do.
    pub fn principal(&self) -> ([f64; 2], [Vec3; 2]) {
        let ([low, high], d) = principal_pair(&self.form);
        let least = self.along * d.x + self.across * d.y;
        let most = self.along * d.y - self.across * d.x;
        ([high.sqrt(), low.sqrt()], [most, least])
    }

    /// ln τ as a form in space, (xx, yy, zz, xy, yz, zx), no unit: it may be blended between
    /// vertices whose frames differ. All 0 where nothing grows.
    pub(super) fn logarithm(&self) -> [f64; 6] {
        if self.form == Mat2::identity() {
            return [0.0; 6];
        }
        let (factors, [most, least]) = self.principal();
        let m = most * most.transpose() * (2.0 * factors[0].ln())
            + least * least.transpose() * (2.0 * factors[1].ln());
        [m[(0, 0)], m[(1, 1)], m[(2, 2)], m[(0, 1)], m[(1, 2)], m[(2, 0)]]
    }

    /// The expansion whose logarithm is the part of this one ([`GrowthTensor::logarithm`]) that
    /// lies in the plane with the unit `normal`.
    pub(super) fn from_logarithm(normal: &Vec3, [xx, yy, zz, xy, yz, zx]: [f64; 6]) -> Self {
        let along = any_tangent(normal);
        let across = normal.cross(&along);
        if [xx, yy, zz, xy, yz, zx] == [0.0; 6] {
            return Self { along, across, form: Mat2::identity() };
        }
        let space = crate::mesh::Mat3::new(xx, xy, zx, xy, yy, yz, zx, yz, zz);
        let entry = |a: &Vec3, b: &Vec3| a.dot(&(space * b));
        let mixed = entry(&along, &across);
        let ([low, high], d) = principal_pair(&Mat2::new(
            entry(&along, &along),
            mixed,
            mixed,
            entry(&across, &across),
        ));
        let e = Vec2::new(-d.y, d.x);
        Self { along, across, form: d * d.transpose() * low.exp() + e * e.transpose() * high.exp() }
    }

    /// τ^`exponent`: part of the growth (0: none, 1: all), so that equal parts lengthen by equal
    /// factors.
    fn power(&self, exponent: f64) -> Self {
        if self.form == Mat2::identity() || exponent == 1.0 {
            return *self;
        }
        let ([low, high], d) = principal_pair(&self.form);
        let e = Vec2::new(-d.y, d.x);
        let form = if exponent == 0.0 {
            Mat2::identity()
        } else {
            d * d.transpose() * low.powf(exponent) + e * e.transpose() * high.powf(exponent)
        };
        Self { form, ..*self }
    }
}

/// `[V]` growth tensors of a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Expansion {
    /// Expansion of each vertex.
    pub vertices: Vec<GrowthTensor>,
}

impl Expansion {
    /// Growth by 1: nothing changes. `positions` (`[V]`, m) is the starting surface.
    ///
    /// # Errors
    /// [`Error::Mesh`] naming a vertex without a normal, whose faces have no area or fold shut.
    pub fn none(topology: &Topology, positions: &[Vec3]) -> Result<Self> {
        let normals = try_vertex_normals(topology, positions).at("growth")?;
        let frame = |normal: &Vec3| {
            let along = any_tangent(normal);
            GrowthTensor { along, across: normal.cross(&along), form: Mat2::identity() }
        };
        Ok(Self { vertices: normals.iter().map(frame).collect() })
    }

    /// Growth by `factors` (`[V]`, no unit, of lengths) in all directions.
    ///
    /// # Errors
    /// As [`Expansion::none`]; [`Error::Value`] naming a vertex whose factor is no positive number,
    /// or out of range.
    pub fn from_factors(topology: &Topology, positions: &[Vec3], factors: &[f64]) -> Result<Self> {
        let mut expansion = Self::none(topology, positions)?;
        for (v, (growth, &factor)) in expansion.vertices.iter_mut().zip(factors).enumerate() {
            growth.form = Mat2::identity() * (check_factor(v, factor)? * factor);
        }
        Ok(expansion)
    }

    /// Growth by `factors` (`[V]`, no unit, of lengths) along `directions` (`[V]`, any length, in
    /// space; their parts normal to the surface are dropped) and by none across.
    ///
    /// # Errors
    /// As [`Expansion::from_factors`], or if a direction is normal to the surface where it grows.
    pub fn from_directions(
        topology: &Topology,
        positions: &[Vec3],
        directions: &[Vec3],
        factors: &[f64],
    ) -> Result<Self> {
        let tensors: Vec<Mat2> = (0..factors.len())
            .map(|v| Ok(Mat2::new(check_factor(v, factors[v])?.powi(2), 0.0, 0.0, 1.0)))
            .collect::<Result<_>>()?;
        Self::from_tensors(topology, positions, directions, &tensors)
    }

    /// Growth by the full forms `tensors` (`[V]`, no unit) in frames whose first vector points
    /// along `directions` (`[V]`, as in
    /// [`Expansion::from_directions`]), the second 90° to its left seen from outside.
    ///
    /// # Errors
    /// [`Error::Value`] naming a vertex whose form is not symmetric and positive definite, or whose
    /// direction is normal to the surface though something grows there; as [`Expansion::none`].
    pub fn from_tensors(
        topology: &Topology,
        positions: &[Vec3],
        directions: &[Vec3],
        tensors: &[Mat2],
    ) -> Result<Self> {
        let normals = try_vertex_normals(topology, positions).at("growth")?;
        let vertex = |v: usize| {
            let (normal, form) = (normals[v], tensors[v]);
            check_form(v, &form)?;
            let flat = directions[v] - normal * normal.dot(&directions[v]);
            let along = match flat.try_normalize(1e-6 * directions[v].norm()) {
                Some(along) if along.iter().all(|x| x.is_finite()) => along,
                _ if form == Mat2::identity() * form[(0, 0)] => any_tangent(&normal),
                _ => {
                    let message = format!(
                        "the direction at vertex {v} does not lie in the surface; give one that is \
                         not along its normal"
                    );
                    return Err(Error::value("growth.direction", message));
                }
            };
            Ok(GrowthTensor { along, across: normal.cross(&along), form })
        };
        Ok(Self { vertices: (0..tensors.len()).map(vertex).collect::<Result<_>>()? })
    }

    /// This growth followed by `later`: √τ·τ'·√τ at each vertex.
    pub fn then(&self, later: &Self) -> Self {
        let vertex = |(first, second): (&GrowthTensor, &GrowthTensor)| {
            if second.form == Mat2::identity() {
                return *first;
            }
            if first.form == Mat2::identity() {
                return *second;
            }
            let turn = |a: &Vec3, b: &Vec3| Vec2::new(first.along.dot(a), first.across.dot(b));
            let (along, across) = (second.along, second.across);
            let turn = Mat2::from_columns(&[turn(&along, &along), turn(&across, &across)]);
            let root = first.power(0.5).form;
            let form = root * turn * second.form * turn.transpose() * root;
            GrowthTensor { form: (form + form.transpose()) * 0.5, ..*first }
        };
        Self { vertices: self.vertices.iter().zip(&later.vertices).map(vertex).collect() }
    }

    /// True if nothing grows.
    pub fn is_none(&self) -> bool {
        self.vertices.iter().all(|growth| growth.form == Mat2::identity())
    }

    /// Part of this expansion: τ^`exponent` at each vertex, 0 for none of it and 1 for all.
    pub fn part(&self, exponent: f64) -> Self {
        Self { vertices: self.vertices.iter().map(|growth| growth.power(exponent)).collect() }
    }

    /// `[E]` factors (no unit) by which the edges of the starting surface `positions` (`[V]`, m)
    /// grow: the mean of √(lᵗτl).
    pub fn edge_factors(&self, topology: &Topology, positions: &[Vec3]) -> Vec<f64> {
        let factor = |&[i, j]: &[usize; 2]| {
            let edge = positions[j] - positions[i];
            mean_root(self.vertices[i].square(&edge), self.vertices[j].square(&edge))
        };
        topology.edges.iter().map(factor).collect()
    }

    /// `rest`, grown. Where all three sides of a face grow by exactly 1, its metric is the same to
    /// the bit.
    ///
    /// # Errors
    /// [`Error::Mesh`] naming a face whose grown sides make no triangle.
    pub fn act_on(
        &self,
        topology: &Topology,
        positions: &[Vec3],
        rest: &RestMetric,
    ) -> Result<RestMetric> {
        scale_edges(topology, rest, &self.edge_factors(topology, positions))
    }
}

/// `rest` with the length of every edge multiplied by its factor (`[E]`, no unit).
///
/// # Errors
/// [`Error::Mesh`] naming a face whose new sides make no triangle.
pub fn scale_edges(topology: &Topology, rest: &RestMetric, factors: &[f64]) -> Result<RestMetric> {
    let face = |f: usize| {
        let old = &rest.faces[f];
        let k = topology.face_edges[f].map(|e| factors[e]);
        if k == [1.0; 3] {
            return Ok(*old);
        }
        let [u, v] = old.edges();
        // Squared lengths of the sides 0→1, 1→2, 2→0.
        let [a, c, b] = [
            u.norm_squared() * k[0] * k[0],
            (v - u).norm_squared() * k[1] * k[1],
            v.norm_squared() * k[2] * k[2],
        ];
        let form = Mat2::new(a, 0.5 * (a + b - c), 0.5 * (a + b - c), b);
        // Below this a face is all but a line.
        if form.determinant().is_nan() || form.determinant() <= 1e-6 * a * b {
            let message = format!(
                "the sides of face {f} make no triangle once they are grown; let the expansion \
                 change more slowly there"
            );
            return Err(Error::mesh("growth.expansion", message));
        }
        Ok(RestFace::from_form(form))
    };
    Ok(RestMetric { faces: (0..rest.faces.len()).map(face).collect::<Result<_>>()? })
}

/// ∫√((1−t)a + t·b)dt over 0..1: 2/3·(a + √(ab) + b)/(√a + √b). Exactly 1 for a = b = 1.
fn mean_root(a: f64, b: f64) -> f64 {
    let (p, q) = (a.sqrt(), b.sqrt());
    2.0 * (a + p * q + b) / (3.0 * (p + q))
}

fn check_factor(v: usize, factor: f64) -> Result<f64> {
    if (FACTORS[0]..=FACTORS[1]).contains(&factor) {
        return Ok(factor);
    }
    let message = format!(
        "the growth at vertex {v} is {factor}; give a factor of length above 0, from {} to {}",
        FACTORS[0], FACTORS[1]
    );
    Err(Error::value("growth.amount", message))
}

fn check_form(v: usize, form: &Mat2) -> Result<()> {
    let [low, high] = principal_pair(form).0;
    let symmetric = (form[(0, 1)] - form[(1, 0)]).abs() <= 1e-12 * high.abs();
    if symmetric && low >= FACTORS[0].powi(2) && high <= FACTORS[1].powi(2) {
        return Ok(());
    }
    let [[a, b], [c, d]] = [[form[(0, 0)], form[(0, 1)]], [form[(1, 0)], form[(1, 1)]]];
    let message = format!(
        "the expansion ({a}, {b}; {c}, {d}) at vertex {v} is not symmetric and positive definite; \
         give one whose eigenvalues, the squares of factors of length, are above 0"
    );
    Err(Error::value("growth.tensor", message))
}

/// A unit vector perpendicular to `normal`: along x where that is possible.
fn any_tangent(normal: &Vec3) -> Vec3 {
    let axis = if normal.x.abs() < 0.9 { Vec3::x() } else { Vec3::y() };
    (axis - normal * normal.dot(&axis)).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::panel::{Outline, Panel};

    fn sheet() -> (Topology, Vec<Vec3>, RestMetric) {
        let panel =
            Panel::new(&Outline::Rectangle { width_m: 1.0, height_m: 1.0 }, 0.13, 3).unwrap();
        let positions: Vec<Vec3> =
            panel.positions.iter().map(|p| Vec3::new(p.x, p.y, 0.0)).collect();
        let topology = Topology::new(positions.len(), panel.faces).unwrap();
        let rest = RestMetric::from_shape(&positions, &topology.faces).unwrap();
        (topology, positions, rest)
    }

    #[test]
    fn growing_by_one_changes_nothing_to_the_bit() {
        let (topology, positions, rest) = sheet();
        let n = positions.len();
        let skew: Vec<Vec3> =
            (0..n).map(|v| Vec3::new((v as f64).sin(), (v as f64).cos(), 0.3)).collect();
        for expansion in [
            Expansion::none(&topology, &positions).unwrap(),
            Expansion::from_factors(&topology, &positions, &vec![1.0; n]).unwrap(),
            Expansion::from_directions(&topology, &positions, &skew, &vec![1.0; n]).unwrap(),
            Expansion::from_factors(&topology, &positions, &vec![1.7; n]).unwrap().part(0.0),
        ] {
            assert!(expansion.is_none());
            assert_eq!(expansion.act_on(&topology, &positions, &rest).unwrap(), rest);
        }
    }

    #[test]
    fn uniform_growth_gives_the_metric_of_the_mapped_shape() {
        let (topology, positions, rest) = sheet();
        let n = positions.len();
        // Growing by 2 along a slanted direction, and not across.
        let d = Vec3::new(0.6, 0.8, 0.0);
        let expansion =
            Expansion::from_directions(&topology, &positions, &vec![d * 3.0; n], &vec![2.0; n])
                .unwrap();
        let mapped: Vec<Vec3> = positions.iter().map(|p| p + d * d.dot(p)).collect();
        let expected = RestMetric::from_shape(&mapped, &topology.faces).unwrap();
        let grown = expansion.act_on(&topology, &positions, &rest).unwrap();
        for (a, b) in grown.faces.iter().zip(&expected.faces) {
            assert!((a.inverse_root - b.inverse_root).norm() < 1e-11 * b.inverse_root.norm());
        }
        assert!((grown.area_m2() / rest.area_m2() - 2.0).abs() < 1e-12);
        let ([most, least], [along, _]) = expansion.vertices[7].principal();
        assert!(
            (most - 2.0).abs() < 1e-12
                && (least - 1.0).abs() < 1e-12
                && along.cross(&d).norm() < 1e-12
        );
        // Two halves make the whole.
        let half = expansion.part(0.5);
        let twice = half.act_on(&topology, &positions, &rest).unwrap();
        assert!((twice.area_m2().powi(2) / rest.area_m2() / grown.area_m2() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn logarithms_carry_a_growth_into_other_frames() {
        let normal = Vec3::new(0.3, -0.5, 0.8).normalize();
        let along = normal.cross(&Vec3::new(0.2, 0.9, 0.1)).normalize();
        let growth = GrowthTensor {
            along,
            across: normal.cross(&along),
            form: Mat2::new(2.0, 0.3, 0.3, 0.7),
        };
        let again = GrowthTensor::from_logarithm(&normal, growth.logarithm());
        for angle in [0.0_f64, 0.7, 1.9, 2.6] {
            let d = growth.along * angle.cos() + growth.across * angle.sin();
            assert!((again.square(&d) - growth.square(&d)).abs() < 1e-12);
        }
        // Half of each of two equal ones is the same again; none stays none to the bit.
        let half = growth.logarithm().map(|x| 0.5 * x + 0.5 * x);
        assert!((GrowthTensor::from_logarithm(&normal, half).form - again.form).norm() < 1e-12);
        assert_eq!(GrowthTensor::from_logarithm(&normal, [0.0; 6]).form, Mat2::identity());
    }

    #[test]
    fn the_root_of_the_form_is_integrated_along_edges() {
        let numeric = |a: f64, b: f64| {
            (0..10_000).map(|k| (a + (b - a) * (k as f64 + 0.5) / 10_000.0).sqrt()).sum::<f64>()
                / 10_000.0
        };
        for (a, b) in [(1.0, 4.0), (9.0, 0.25), (2.0, 2.0), (1.0, 1.0 + 1e-9)] {
            assert!((mean_root(a, b) - numeric(a, b)).abs() < 1e-8);
        }
        assert_eq!(mean_root(1.0, 1.0), 1.0);
    }

    #[test]
    fn growths_follow_each_other() {
        let (topology, positions, rest) = sheet();
        let n = positions.len();
        let along = |d: Vec3, factor: f64| {
            Expansion::from_directions(&topology, &positions, &vec![d; n], &vec![factor; n])
                .unwrap()
        };
        // Along x, then along y: the area grows by both, whatever frames they came in.
        let both = along(Vec3::x(), 1.5).then(&along(Vec3::y(), 2.0));
        let grown = both.act_on(&topology, &positions, &rest).unwrap();
        assert!((grown.area_m2() / rest.area_m2() - 3.0).abs() < 1e-12);
        let ([most, least], [direction, _]) = both.vertices[3].principal();
        assert!(
            (most - 2.0).abs() < 1e-12
                && (least - 1.5).abs() < 1e-12
                && direction.cross(&Vec3::y()).norm() < 1e-12
        );
        let none = Expansion::none(&topology, &positions).unwrap();
        assert_eq!((both.then(&none), none.then(&both)), (both.clone(), both));
    }

    #[test]
    fn what_cannot_grow_is_named() {
        let (topology, positions, rest) = sheet();
        let n = positions.len();
        let mut forms = vec![Mat2::identity(); n];
        let told = |forms: &[Mat2], direction: Vec3| {
            Expansion::from_tensors(&topology, &positions, &vec![direction; n], forms)
                .unwrap_err()
                .to_string()
        };
        for bad in [
            Mat2::new(1.0, 2.0, 2.0, 1.0),
            Mat2::new(1.0, 0.5, 0.0, 1.0),
            Mat2::zeros(),
            Mat2::new(f64::NAN, 0.0, 0.0, 1.0),
        ] {
            forms[5] = bad;
            let told = told(&forms, Vec3::x());
            assert!(told.contains("vertex 5") && told.contains("positive definite"), "{told}");
        }
        forms[5] = Mat2::new(2.0, 0.0, 0.0, 1.0);
        assert!(told(&forms, Vec3::z()).contains("vertex 5"));
        let mut factors = vec![1.0; n];
        for bad in [0.0, -1.0, f64::NAN, 1e9] {
            factors[3] = bad;
            assert!(
                Expansion::from_factors(&topology, &positions, &factors)
                    .unwrap_err()
                    .to_string()
                    .contains("vertex 3")
            );
        }
        factors = (0..n).map(|v| if v % 2 == 0 { 1.0 } else { 500.0 }).collect();
        let wild = Expansion::from_factors(&topology, &positions, &factors).unwrap();
        // Steep growth is a triangle still or is named; sides that break the triangle's inequality
        // always are.
        let _ = wild.act_on(&topology, &positions, &rest);
        let mut broken = vec![1.0; topology.edge_count()];
        broken[4] = 50.0;
        assert!(
            scale_edges(&topology, &rest, &broken)
                .unwrap_err()
                .to_string()
                .contains("make no triangle")
        );
    }
}
