//! Contact with obstacles: a smooth barrier that grows without bound towards their surface, so that
//! no vertex ever gets in.
//!
//! With d the distance of a vertex from an obstacle, t the contact thickness and s = d/t, the
//! energy is p·A·t·B(s) with B = −(1 − s)²·ln s below s = 1 and 0 above (the barrier of Li et al.
//! 2020, "Incremental potential contact"); A is the vertex's rest area and p a pressure of the size
//! of the loads, so that what rests on an obstacle stays well within the thickness (cloth on a
//! floor at about 0.8 of it). Several obstacles add up. There is no friction.

use rayon::prelude::*;

use crate::mesh::{Mat3, Vec3};
use crate::obstacle::Obstacle;

use super::setup::Setup;

/// Part of its distance that a vertex may lose in one step.
const APPROACH: f64 = 0.8;
/// Steps of conservative advancement at most.
const MOST_ADVANCES: usize = 64;

/// Vertices that one thread takes at least.
const CHUNK: usize = 128;

/// The contact energy of all vertices.
#[derive(Clone, Debug)]
pub(crate) struct Barrier<'a> {
    obstacles: &'a [Obstacle],
    thickness_m: f64,
    /// `[V]` pressure times rest area (N).
    strength: Vec<f64>,
}

/// Energy (J), gradient (N) and Hessian (N/m) of one vertex.
pub(crate) struct Push {
    pub(crate) energy: f64,
    pub(crate) gradient: Vec3,
    pub(crate) hessian: Mat3,
}

impl<'a> Barrier<'a> {
    /// The contact of a sheet; `None` if there are no obstacles.
    pub(crate) fn new(setup: &Setup<'a>) -> Option<Self> {
        if setup.obstacles.is_empty() {
            return None;
        }
        let material = &setup.sheet.material;
        let weight: f64 = setup.dead_forces_newton().iter().map(Vec3::norm).sum::<f64>()
            / setup.sheet.rest.area_m2();
        let stiffness = material.young_pa * material.thickness_m / setup.length_m();
        let pressure_pa = 10.0 * weight
            + setup.loads.pressure_pa.abs()
            + setup.contact_pressure_pa
            + 1e-3 * stiffness;
        let strength = setup.vertex_area_m2().into_iter().map(|area| area * pressure_pa).collect();
        Some(Self { obstacles: setup.obstacles, thickness_m: setup.contact_thickness_m, strength })
    }

    /// Energy (J) of vertex `v` at `p` (m); infinite inside an obstacle.
    pub(crate) fn energy(&self, v: usize, p: &Vec3) -> f64 {
        let near =
            self.obstacles.iter().filter_map(|obstacle| obstacle.nearby(p, self.thickness_m));
        near.map(|near| {
            self.strength[v] * self.thickness_m * barrier(near.distance_m / self.thickness_m)[0]
        })
        .sum()
    }

    /// Barrier of the obstacles on vertex `v` at `p` (m); `None` if none is near. The Hessian is
    /// the true one if `exact`, else a positive semidefinite part of it.
    pub(crate) fn push(&self, v: usize, p: &Vec3, exact: bool) -> Option<Push> {
        let mut push = Push { energy: 0.0, gradient: Vec3::zeros(), hessian: Mat3::zeros() };
        let mut touched = false;
        for near in
            self.obstacles.iter().filter_map(|obstacle| obstacle.nearby(p, self.thickness_m))
        {
            let [value, slope, bend] =
                barrier(near.distance_m / self.thickness_m).map(|b| b * self.strength[v]);
            push.energy += value * self.thickness_m;
            push.gradient += near.gradient * slope;
            push.hessian += near.gradient * near.gradient.transpose() * (bend / self.thickness_m);
            if exact {
                push.hessian += near.hessian * slope;
            }
            touched = true;
        }
        touched.then_some(push)
    }

    /// The longest part (0 to 1) of a step on which all of `positions` (`[V]`, m), each moved by
    /// `by(v)` (m), keep clear.
    pub(crate) fn max_step_size(
        &self,
        positions: &[Vec3],
        by: impl Fn(usize) -> Vec3 + Sync,
    ) -> f64 {
        let parts = positions.par_iter().enumerate().with_min_len(CHUNK);
        parts.map(|(v, p)| self.longest_move(p, &by(v))).reduce(|| 1.0, f64::min)
    }

    /// The longest part (0 to 1) of the move from `p` by `by` (m) on which the point keeps clear of
    /// every obstacle: conservative advancement, which never passes through anything, however thin.
    pub(crate) fn longest_move(&self, p: &Vec3, by: &Vec3) -> f64 {
        let length = by.norm();
        let mut part = 1.0_f64;
        for obstacle in self.obstacles {
            if obstacle.is_beyond(p, length) {
                continue;
            }
            let start = obstacle.distance_m(p);
            if start > length {
                continue;
            }
            let keep = (1.0 - APPROACH) * start;
            let (mut t, mut clear) = (0.0, start - keep);
            for _ in 0..MOST_ADVANCES {
                t += clear / length;
                if t >= part || clear < 1e-3 * start {
                    break;
                }
                clear = obstacle.distance_m(&(p + by * t)) - keep;
            }
            part = part.min(t);
        }
        part
    }
}

/// B(s) and its first two derivatives; infinite where s is 0 or less.
pub(crate) fn barrier(s: f64) -> [f64; 3] {
    if s >= 1.0 {
        return [0.0; 3];
    }
    if s <= 0.0 {
        return [f64::INFINITY; 3];
    }
    let (gap, log) = (1.0 - s, s.ln());
    [
        -gap * gap * log,
        2.0 * gap * log - gap * gap / s,
        -2.0 * log + 4.0 * gap / s + gap * gap / (s * s),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::derivative_check::{gradient_error, hessian_error};

    fn ball() -> Obstacle {
        Obstacle::sphere("ball", Vec3::zeros(), 1.0).unwrap()
    }

    #[test]
    fn derivatives_agree_with_differences() {
        let obstacles =
            [ball(), Obstacle::plane("floor", Vec3::new(0.0, 0.0, -0.2), Vec3::z()).unwrap()];
        let contact = Barrier { obstacles: &obstacles, thickness_m: 0.4, strength: vec![2.0] };
        for x in [[0.8, 0.6, 0.4], [1.05, 0.1, 0.02], [0.9, -0.8, 0.15]] {
            let at = |y: &[f64]| Vec3::new(y[0], y[1], y[2]);
            let push = contact.push(0, &at(&x), true).unwrap();
            assert!((push.energy - contact.energy(0, &at(&x))).abs() < 1e-15);
            assert!(
                gradient_error(&x, 0.05, push.gradient.as_slice(), |y| contact.energy(0, &at(y)))
                    < 1e-7
            );
            let slope =
                |y: &[f64]| contact.push(0, &at(y), true).unwrap().gradient.as_slice().to_vec();
            assert!(hessian_error(&x, 0.05, push.hessian.as_slice(), slope) < 1e-6);
        }
        assert!(contact.push(0, &Vec3::new(0.0, 3.0, 1.0), true).is_none());
        assert_eq!(contact.energy(0, &Vec3::new(0.5, 0.0, 0.5)), f64::INFINITY);
    }

    #[test]
    fn no_move_gets_in_or_through() {
        let obstacles = [ball()];
        let contact = Barrier { obstacles: &obstacles, thickness_m: 0.01, strength: vec![1.0] };
        let p = Vec3::new(-3.0, 0.2, 0.0);
        // Straight through and out on the other side; past it; away from it.
        let through = contact.longest_move(&p, &(Vec3::x() * 6.0));
        let met = (p + Vec3::x() * 6.0 * through).norm() - 1.0;
        assert!(met > 0.0 && met < 0.5, "{met}");
        assert_eq!(contact.longest_move(&p, &Vec3::new(0.0, 9.0, 0.0)), 1.0);
        assert_eq!(contact.longest_move(&p, &Vec3::new(-9.0, 0.0, 0.0)), 1.0);
    }
}
