//! Solid bodies that a shell may not enter: signed distances with first and second derivatives, for
//! contact.
//!
//! An [`Obstacle`] is a half-space, a sphere, a capsule or round cone, an ellipsoid, a torus or a
//! closed mesh. Distances are exact, negative inside. Queries take no heap and give the same on any
//! thread. Where distance has no derivative (on the medial axis, deep inside), one of the possible
//! gradients is given, and curvatures are held finite.

mod ellipsoid;
mod plane;
mod round_cone;
mod sphere;
mod tessellate;
mod torus;
mod triangles;

use std::sync::Arc;

use nalgebra::Rotation3;

use crate::mesh::{Mat3, Vec3};
use crate::{Error, Result};

use ellipsoid::Ellipsoid;
use plane::Plane;
use round_cone::RoundCone;
use sphere::Sphere;
use torus::Torus;
use triangles::Triangles;

/// Smallest radius (m).
const LEAST_RADIUS_M: f64 = 1e-9;
/// Largest radius and farthest coordinate (m).
const FARTHEST_M: f64 = 1e6;
/// Greatest ratio of two radii of an ellipsoid.
const MOST_OBLONG: f64 = 1e4;
/// Curvatures are at most the inverse of this part of a body's radius, however close to its centre
/// or axis.
const LEAST_RELATIVE_RADIUS: f64 = 1e-6;

/// A solid body; immutable.
#[derive(Clone, Debug)]
pub struct Obstacle {
    /// The user's name for it.
    pub name: String,
    shape: Shape,
}

#[derive(Clone, Debug)]
enum Shape {
    Plane(Plane),
    Sphere(Sphere),
    RoundCone(RoundCone),
    Ellipsoid(Ellipsoid),
    Torus(Torus),
    Triangles(Arc<Triangles>),
}

/// Signed distance of a point to an obstacle, and its derivatives by the point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearby {
    /// Signed distance to the surface (m), negative inside.
    pub distance_m: f64,
    /// First derivative of the distance: a unit vector, outward.
    pub gradient: Vec3,
    /// Second derivative of the distance (1/m), symmetric. For a mesh that of the closest feature:
    /// zero on a face, and that of the distance to a line or a point on an edge or vertex.
    pub hessian: Mat3,
}

impl Obstacle {
    /// The half-space below the plane through `point_m` (m): solid where `normal` (any length but
    /// 0) points away from.
    ///
    /// # Errors
    /// [`Error::Value`] if the point is not finite or beyond 1e6 m, or the normal is not finite or
    /// zero.
    pub fn plane(name: &str, point_m: Vec3, normal: Vec3) -> Result<Self> {
        check_point(name, "point_m", &point_m)?;
        let scale = normal.amax();
        if !(normal.iter().all(|x| x.is_finite()) && scale > 0.0) {
            let message = format!(
                "the normal is ({}, {}, {}), which is no direction; give a vector that is not zero",
                normal.x, normal.y, normal.z
            );
            return Err(Error::value(format!("{name}.normal"), message));
        }
        Ok(Self::with_shape(name, Shape::Plane(Plane::new(point_m, (normal / scale).normalize()))))
    }

    /// The ball around `centre_m` (m).
    ///
    /// # Errors
    /// [`Error::Value`] if the radius is not from 1e-9 to 1e6 m, or the centre not finite or beyond
    /// 1e6 m.
    pub fn sphere(name: &str, centre_m: Vec3, radius_m: f64) -> Result<Self> {
        check_point(name, "centre_m", &centre_m)?;
        check_radius(name, "radius_m", radius_m)?;
        Ok(Self::with_shape(name, Shape::Sphere(Sphere::new(centre_m, radius_m))))
    }

    /// The convex hull of two balls, a round cone: one around `from_m` with `radius_m`, one around
    /// `to_m` with `end_radius_m` (all m). With equal radii it is a capsule; where one ball
    /// contains the other it is that ball.
    ///
    /// # Errors
    /// [`Error::Value`] if a radius is not from 1e-9 to 1e6 m, or an end not finite or beyond 1e6
    /// m.
    pub fn capsule(
        name: &str,
        from_m: Vec3,
        to_m: Vec3,
        radius_m: f64,
        end_radius_m: f64,
    ) -> Result<Self> {
        check_point(name, "from_m", &from_m)?;
        check_point(name, "to_m", &to_m)?;
        check_radius(name, "radius_m", radius_m)?;
        check_radius(name, "end_radius_m", end_radius_m)?;
        let shape = match RoundCone::new(from_m, to_m, radius_m, end_radius_m) {
            Some(cone) => Shape::RoundCone(cone),
            None if radius_m >= end_radius_m => Shape::Sphere(Sphere::new(from_m, radius_m)),
            None => Shape::Sphere(Sphere::new(to_m, end_radius_m)),
        };
        Ok(Self::with_shape(name, shape))
    }

    /// The ellipsoid around `centre_m` (m) with `radii_m` (m) along its own x, y and z, which
    /// `turn` takes to those of space.
    ///
    /// # Errors
    /// [`Error::Value`] if a radius is not from 1e-9 to 1e6 m, one is over 1e4 times another, the
    /// centre is not finite or beyond 1e6 m, or `turn` is not finite.
    pub fn ellipsoid(
        name: &str,
        centre_m: Vec3,
        radii_m: [f64; 3],
        turn: Rotation3<f64>,
    ) -> Result<Self> {
        check_point(name, "centre_m", &centre_m)?;
        for radius in radii_m {
            check_radius(name, "radii_m", radius)?;
        }
        let [least, most] = [f64::min, f64::max]
            .map(|pick| radii_m.into_iter().reduce(pick).expect("there are three"));
        if most > MOST_OBLONG * least {
            let message = format!(
                "the radii {least} m and {most} m are too unlike; keep them within a factor of \
                 {MOST_OBLONG:e}"
            );
            return Err(Error::value(format!("{name}.radii_m"), message));
        }
        if !turn.matrix().iter().all(|x| x.is_finite()) {
            return Err(Error::value(
                format!("{name}.turn"),
                "the rotation is not finite; give finite angles",
            ));
        }
        Ok(Self::with_shape(name, Shape::Ellipsoid(Ellipsoid::new(centre_m, radii_m, turn))))
    }

    /// The solid torus around `axis` (any length but 0) through `centre_m` (m), whose tube of
    /// `tube_radius_m` (m) has its middle on the circle of `radius_m` (m).
    ///
    /// # Errors
    /// [`Error::Value`] if a radius is not from 1e-9 to 1e6 m, the tube is as thick as the circle
    /// is wide, the centre not finite or beyond 1e6 m, or the axis not finite or zero.
    pub fn torus(
        name: &str,
        centre_m: Vec3,
        axis: Vec3,
        radius_m: f64,
        tube_radius_m: f64,
    ) -> Result<Self> {
        check_point(name, "centre_m", &centre_m)?;
        check_radius(name, "radius_m", radius_m)?;
        check_radius(name, "tube_radius_m", tube_radius_m)?;
        if tube_radius_m >= radius_m {
            let message = format!(
                "a tube of {tube_radius_m} m closes the hole of a torus of {radius_m} m; give less \
                 than radius_m"
            );
            return Err(Error::value(format!("{name}.tube_radius_m"), message));
        }
        let scale = axis.amax();
        if !(axis.iter().all(|x| x.is_finite()) && scale > 0.0) {
            let message = format!(
                "the axis is ({}, {}, {}), which is no direction; give a vector that is not zero",
                axis.x, axis.y, axis.z
            );
            return Err(Error::value(format!("{name}.axis"), message));
        }
        Ok(Self::with_shape(
            name,
            Shape::Torus(Torus::new(centre_m, (axis / scale).normalize(), radius_m, tube_radius_m)),
        ))
    }

    /// The body inside a closed mesh: `positions` (`[V]`, m) and `faces` (`[F][3]`),
    /// counter-clockwise seen from outside. If the mesh is inside out as a whole, all its faces are
    /// flipped. Vertices split along texture seams are welded; faces without area count for
    /// nothing; vertices without faces are left out.
    ///
    /// # Errors
    /// [`ObstacleError`](crate::error::ObstacleError), or another [`Error::Mesh`], for: no faces, a
    /// vertex that is not finite or beyond 1e6 m, an index out of range, an edge on three or more
    /// faces, open edges, neighbouring faces that disagree about outside, no volume.
    pub fn mesh(name: &str, positions: &[Vec3], faces: &[[usize; 3]]) -> Result<Self> {
        Ok(Self::with_shape(name, Shape::Triangles(Arc::new(Triangles::new(positions, faces)?))))
    }

    fn with_shape(name: &str, shape: Shape) -> Self {
        Self { name: name.to_owned(), shape }
    }

    /// Signed distance (m) of `p` (m) to the surface, negative inside; changes by at most the way
    /// that `p` moves. Not a number if `p` is not finite.
    pub fn distance_m(&self, p: &Vec3) -> f64 {
        match &self.shape {
            Shape::Plane(plane) => plane.distance_m(p),
            Shape::Sphere(sphere) => sphere.distance_m(p),
            Shape::RoundCone(cone) => cone.distance_m(p),
            Shape::Ellipsoid(ellipsoid) => ellipsoid.distance_m(p),
            Shape::Torus(torus) => torus.distance_m(p),
            Shape::Triangles(mesh) => mesh.distance_m(p),
        }
    }

    /// True if `p` is surely farther outside than `reach_m` (m): a quick answer, where the distance
    /// takes long.
    pub fn is_beyond(&self, p: &Vec3, reach_m: f64) -> bool {
        match &self.shape {
            Shape::Ellipsoid(ellipsoid) => ellipsoid.at_least_m(p) > reach_m,
            _ => false,
        }
    }

    /// Signed distance of `p` (m) with its derivatives; nothing if `p` is farther outside than
    /// `reach_m` (m). However deep inside, there is an answer.
    pub fn nearby(&self, p: &Vec3, reach_m: f64) -> Option<Nearby> {
        match &self.shape {
            Shape::Plane(plane) => plane.nearby(p, reach_m),
            Shape::Sphere(sphere) => sphere.nearby(p, reach_m),
            Shape::RoundCone(cone) => cone.nearby(p, reach_m),
            Shape::Ellipsoid(ellipsoid) => ellipsoid.nearby(p, reach_m),
            Shape::Torus(torus) => torus.nearby(p, reach_m),
            Shape::Triangles(mesh) => mesh.nearby(p, reach_m),
        }
    }

    /// The surface as triangles for pictures: vertices (m) and faces, counter-clockwise seen from
    /// outside. Round shapes have some thousand faces, with their vertices on the surface; a mesh
    /// is itself. A plane covers the shadow along its normal of the box from `low` to `high` (m)
    /// with a quarter of its width more on each side; other shapes do not look at the box.
    pub fn surface(&self, low: &Vec3, high: &Vec3) -> (Vec<Vec3>, Vec<[usize; 3]>) {
        match &self.shape {
            Shape::Plane(plane) => plane.surface(low, high),
            Shape::Sphere(sphere) => sphere.surface(),
            Shape::RoundCone(cone) => cone.surface(),
            Shape::Ellipsoid(ellipsoid) => ellipsoid.surface(),
            Shape::Torus(torus) => torus.surface(),
            Shape::Triangles(mesh) => mesh.surface(),
        }
    }
}

fn check_point(name: &str, field: &str, p: &Vec3) -> Result<()> {
    if p.iter().all(|x| x.abs() <= FARTHEST_M) {
        return Ok(());
    }
    let message = format!(
        "the point is at ({}, {}, {}) m; give three numbers from -1e6 to 1e6",
        p.x, p.y, p.z
    );
    Err(Error::value(format!("{name}.{field}"), message))
}

fn check_radius(name: &str, field: &str, radius_m: f64) -> Result<()> {
    if (LEAST_RADIUS_M..=FARTHEST_M).contains(&radius_m) {
        return Ok(());
    }
    Err(Error::value(
        format!("{name}.{field}"),
        format!("the radius is {radius_m} m; give a number above 0, from 1e-9 to 1e6"),
    ))
}

/// A unit vector perpendicular to the unit vector `direction`: always the same one.
fn perpendicular(direction: &Vec3) -> Vec3 {
    let axis = direction.iamin();
    let mut other = Vec3::zeros();
    other[axis] = 1.0;
    direction.cross(&other).normalize()
}

/// Projection onto the plane perpendicular to the unit vector `normal`.
fn tangent_projection(normal: &Vec3) -> Mat3 {
    Mat3::identity() - normal * normal.transpose()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Uniform numbers from −1 to 1, always the same.
    pub(super) fn numbers(seed: u64) -> impl FnMut() -> f64 {
        let mut state = seed;
        move || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        }
    }

    pub(super) fn points(seed: u64, count: usize, scale: f64) -> Vec<Vec3> {
        let mut next = numbers(seed);
        (0..count).map(|_| Vec3::new(next(), next(), next()) * scale).collect()
    }

    fn turn() -> Rotation3<f64> {
        Rotation3::from_euler_angles(0.3, -0.8, 1.9)
    }

    /// Each analytic shape about 1 m large near the origin, with the depth to which its distance is
    /// smooth.
    fn shapes() -> Vec<(Obstacle, f64)> {
        let (a, b) = (Vec3::new(-0.4, 0.1, 0.2), Vec3::new(0.5, 0.3, -0.3));
        let ellipsoid =
            |radii| Obstacle::ellipsoid("e", Vec3::new(0.1, -0.2, 0.05), radii, turn()).unwrap();
        vec![
            (
                Obstacle::plane("p", Vec3::new(0.1, 0.2, 0.3), Vec3::new(3.0, -4.0, 1.0)).unwrap(),
                1.0,
            ),
            (Obstacle::sphere("s", Vec3::new(0.1, -0.2, 0.3), 0.7).unwrap(), 0.5),
            (Obstacle::capsule("c", a, b, 0.3, 0.3).unwrap(), 0.2),
            (Obstacle::capsule("k", a, b, 0.5, 0.2).unwrap(), 0.1),
            (Obstacle::capsule("k", a, b, 0.1, 0.8).unwrap(), 0.05),
            (Obstacle::capsule("in", a, b, 0.1, 3.0).unwrap(), 1.0),
            (ellipsoid([0.8, 0.5, 0.3]), 0.05),
            (ellipsoid([0.3, 0.9, 0.3]), 0.05),
            (ellipsoid([0.9, 0.9, 0.2]), 0.02),
            (ellipsoid([0.6, 0.6, 0.6]), 0.3),
            (
                Obstacle::torus(
                    "t",
                    Vec3::new(0.1, -0.1, 0.2),
                    Vec3::new(1.0, 2.0, -2.0),
                    0.7,
                    0.25,
                )
                .unwrap(),
                0.15,
            ),
        ]
    }

    #[test]
    fn derivatives_are_those_of_differences() {
        let step = 1e-5;
        for (k, (obstacle, depth)) in shapes().into_iter().enumerate() {
            let (mut checked, mut inside) = (0, 0);
            for p in points(k as u64, 2000, 2.0).into_iter().chain(points(99, 2000, 0.9)) {
                let near = obstacle.nearby(&p, f64::INFINITY).unwrap();
                assert_eq!(near.distance_m, obstacle.distance_m(&p));
                assert!((near.gradient.norm() - 1.0).abs() < 1e-12);
                assert!(near.hessian.iter().all(|h| h.is_finite()));
                if near.distance_m < -depth {
                    continue;
                }
                let sides = [0, 1, 2].map(|axis| {
                    let mut move_m = Vec3::zeros();
                    move_m[axis] = step;
                    [p - move_m, p + move_m].map(|q| obstacle.nearby(&q, f64::INFINITY).unwrap())
                });
                let gradient =
                    Vec3::from(sides.map(|[l, r]| (r.distance_m - l.distance_m) / (2.0 * step)));
                let hessian = Mat3::from_columns(
                    &sides.map(|[l, r]| (r.gradient - l.gradient) / (2.0 * step)),
                );
                assert!(
                    (gradient - near.gradient).norm() < 1e-7,
                    "{obstacle:?} {p}: {gradient} {}",
                    near.gradient
                );
                assert!(
                    (near.hessian - near.hessian.transpose()).norm()
                        < 1e-12 * (1.0 + near.hessian.norm())
                );
                assert!((near.hessian * near.gradient).norm() < 1e-9 * (1.0 + near.hessian.norm()));
                // Between the regions of a round cone the Hessian jumps.
                let other = sides.iter().flatten().any(|s| {
                    (s.hessian - near.hessian).norm() > 1e-2 * (1.0 + near.hessian.norm())
                });
                if !other {
                    let error = (hessian - near.hessian).norm();
                    assert!(
                        error < 1e-5 * (1.0 + near.hessian.norm().powi(3)),
                        "{obstacle:?} {p}: {error:e}"
                    );
                    checked += 1;
                    inside += usize::from(near.distance_m < 0.0);
                }
            }
            assert!(checked > 800 && inside > 20, "{obstacle:?}: {checked} {inside}");
        }
    }

    #[test]
    fn a_wrong_derivative_would_be_seen() {
        let (obstacle, _) = &shapes()[6];
        let p = Vec3::new(0.7, 0.6, -0.9);
        let near = obstacle.nearby(&p, 9.0).unwrap();
        let step = near.gradient * 1e-3;
        let ahead = obstacle.nearby(&(p + step), 9.0).unwrap();
        // Along the gradient: the distance grows by the step, the foot stays, the gradient stays,
        // the Hessian falls.
        assert!((ahead.distance_m - near.distance_m - 1e-3).abs() < 1e-14);
        assert!((ahead.gradient - near.gradient).norm() < 1e-13);
        assert!((ahead.hessian - near.hessian).norm() > 1e-6);
        assert!(
            (ahead.hessian - (near.hessian - near.hessian * near.hessian * 1e-3)).norm() < 1e-4
        );
    }

    #[test]
    fn distance_changes_by_at_most_the_way() {
        for (obstacle, _) in shapes() {
            let pairs: Vec<(Vec3, f64)> =
                points(7, 400, 1.5).into_iter().map(|p| (p, obstacle.distance_m(&p))).collect();
            for (p, d) in &pairs {
                for (q, e) in &pairs {
                    assert!((d - e).abs() <= (p - q).norm() + 1e-14, "{obstacle:?}");
                }
            }
        }
    }

    #[test]
    fn the_foot_lies_on_the_surface_and_is_the_closest_point() {
        for (obstacle, _) in shapes() {
            let (surface, _) = obstacle.surface(&Vec3::repeat(-3.0), &Vec3::repeat(3.0));
            for p in points(3, 300, 1.5) {
                let near = obstacle.nearby(&p, f64::INFINITY).unwrap();
                let foot = p - near.gradient * near.distance_m;
                assert!(
                    obstacle.distance_m(&foot).abs() < 1e-14,
                    "{obstacle:?} {:e}",
                    obstacle.distance_m(&foot)
                );
                let closest = surface.iter().map(|v| (v - p).norm()).fold(f64::INFINITY, f64::min);
                assert!(
                    closest >= near.distance_m.abs() - 1e-14
                        && closest < near.distance_m.abs() + 0.3,
                    "{obstacle:?}"
                );
            }
        }
    }

    #[test]
    fn known_distances() {
        let e = |x, y, z| Vec3::new(x, y, z);
        let far = 1e9;
        let floor = Obstacle::plane("floor", e(0.0, 0.0, 1.0), e(0.0, 0.0, 1e-200)).unwrap();
        assert_eq!(floor.distance_m(&e(5.0, -3.0, 3.5)), 2.5);
        assert_eq!(floor.nearby(&e(0.0, 0.0, 0.5), 0.0).unwrap().gradient, Vec3::z());
        assert!(
            floor.nearby(&e(0.0, 0.0, 3.0), 1.9).is_none()
                && floor.nearby(&e(0.0, 0.0, 3.0), 2.0).is_some()
        );
        let ball = Obstacle::sphere("ball", Vec3::zeros(), 2.0).unwrap();
        assert_eq!(
            [ball.distance_m(&e(0.0, 3.0, 4.0)), ball.distance_m(&Vec3::zeros())],
            [3.0, -2.0]
        );
        let egg = Obstacle::ellipsoid("egg", Vec3::zeros(), [3.0, 2.0, 1.0], Rotation3::identity())
            .unwrap();
        for (p, d) in [
            (e(5.0, 0.0, 0.0), 2.0),
            (e(0.0, -5.0, 0.0), 3.0),
            (e(0.0, 0.0, 5.0), 4.0),
            (Vec3::zeros(), -1.0),
            (e(0.0, 0.0, 0.5), -0.5),
            (e(3.0, 0.0, 0.0), 0.0),
            (e(2.9, 0.0, 0.0), -0.1),
            // Within the focal conic: the foot is off the axis, at x = 9/8, where z = √(1 −
            // (3/8)²).
            (e(1.0, 0.0, 0.0), -((0.125f64).powi(2) + 1.0 - 0.375f64.powi(2)).sqrt()),
        ] {
            assert!((egg.distance_m(&p) - d).abs() < 1e-15, "{p} {d} {}", egg.distance_m(&p));
            let near = egg.nearby(&p, far).unwrap();
            assert!(
                (near.gradient.norm() - 1.0).abs() < 1e-14
                    && near.hessian.iter().all(|h| h.is_finite())
            );
        }
        let turned = Obstacle::ellipsoid(
            "egg",
            Vec3::zeros(),
            [3.0, 2.0, 1.0],
            Rotation3::from_euler_angles(0.0, 0.0, 1.0),
        )
        .unwrap();
        let p = e(1.0f64.cos(), 1.0f64.sin(), 0.0) * 5.0;
        assert!((turned.distance_m(&p) - 2.0).abs() < 1e-14);
        // A cone whose slant leans by 30°: sin = (2 − 1) / 2.
        let cone = Obstacle::capsule("cone", Vec3::zeros(), e(2.0, 0.0, 0.0), 2.0, 1.0).unwrap();
        let slant = e(0.5, 0.75f64.sqrt(), 0.0);
        let foot = slant * 2.0 + e(slant.y, -slant.x, 0.0) * 0.7;
        assert!(
            cone.distance_m(&foot).abs() < 1e-15
                && (cone.distance_m(&(foot + slant * 0.3)) - 0.3).abs() < 1e-15
        );
        assert_eq!(
            [cone.distance_m(&e(-3.0, 0.0, 0.0)), cone.distance_m(&e(7.0, 0.0, 0.0))],
            [1.0, 4.0]
        );
    }

    #[test]
    fn what_is_surely_beyond_is_beyond() {
        let egg = Obstacle::ellipsoid("egg", Vec3::new(0.1, -0.2, 0.05), [0.3, 0.2, 0.1], turn())
            .unwrap();
        let mut sure = 0;
        for k in 0..1000 {
            let direction = Vec3::new(
                (f64::from(k) * 0.7).sin(),
                (f64::from(k) * 1.3).cos(),
                (f64::from(k) * 2.9).sin(),
            );
            let p = direction * 0.002 * f64::from(k);
            let distance = egg.distance_m(&p);
            assert!(!egg.is_beyond(&p, distance.max(0.0)), "{p}");
            sure += usize::from(egg.is_beyond(&p, 0.3 * distance.max(0.0)));
        }
        // It would be of no use if it were never sure.
        assert!(sure > 600, "{sure}");
    }

    #[test]
    fn special_cases_are_the_simpler_shapes() {
        let (a, b) = (Vec3::new(0.3, 0.2, -0.1), Vec3::new(-0.5, 0.9, 0.4));
        let ball = Obstacle::sphere("s", a, 0.4).unwrap();
        let egg = Obstacle::ellipsoid("e", a, [0.4; 3], turn()).unwrap();
        let point = Obstacle::capsule("c", a, a, 0.4, 0.4).unwrap();
        let inside = Obstacle::capsule("c", a, a + Vec3::x() * 0.1, 0.4, 0.2).unwrap();
        let inside_back = Obstacle::capsule("c", a + Vec3::x() * 0.1, a, 0.2, 0.4).unwrap();
        let capsule = Obstacle::capsule("c", a, b, 0.3, 0.3).unwrap();
        let back = Obstacle::capsule("c", b, a, 0.2, 0.5).unwrap();
        let forth = Obstacle::capsule("c", a, b, 0.5, 0.2).unwrap();
        for p in points(1, 2000, 1.5) {
            let of = |o: &Obstacle| o.nearby(&p, 9.0).unwrap();
            let same = |x: &Nearby, y: &Nearby| {
                assert!((x.distance_m - y.distance_m).abs() < 1e-14);
                assert!((x.gradient - y.gradient).norm() < 1e-13);
                assert!((x.hessian - y.hessian).norm() < 1e-11 * (1.0 + x.hessian.norm().powi(2)));
            };
            for other in [&egg, &point, &inside, &inside_back] {
                same(&of(&ball), &of(other));
            }
            same(&of(&forth), &of(&back));
            let along = ((p - a).dot(&(b - a)) / (b - a).norm_squared()).clamp(0.0, 1.0);
            assert!(
                (capsule.distance_m(&p) - ((p - a - (b - a) * along).norm() - 0.3)).abs() < 1e-14
            );
        }
    }

    #[test]
    fn centres_axes_and_far_points_give_finite_answers() {
        let mut all: Vec<Obstacle> = shapes().into_iter().map(|s| s.0).collect();
        for radii in [
            [1.0, 1.0, 1e-4],
            [1e-4, 1.0, 1.0],
            [1e-4, 1.0, 1e-4],
            [1e-2, 1.0, 1e2],
            [1e-9; 3],
            [1e6; 3],
        ] {
            all.push(
                Obstacle::ellipsoid("e", Vec3::zeros(), radii, Rotation3::identity()).unwrap(),
            );
        }
        let mut probes = points(2, 300, 1e-3);
        probes.extend(points(3, 300, 1e5));
        for exponent in [-300, -100, -30, -16, -8, -3] {
            for p in points(4, 40, 10f64.powi(exponent)) {
                // With some coordinates zero.
                probes.extend(
                    (0..8).map(|mask| {
                        Vec3::from_fn(|k, _| if mask >> k & 1 == 1 { p[k] } else { 0.0 })
                    }),
                );
                probes.extend((0..8).map(|mask| {
                    Vec3::from_fn(|k, _| if mask >> k & 1 == 1 { p[k] } else { 0.37 })
                }));
            }
        }
        for obstacle in &all {
            for p in &probes {
                let near = obstacle.nearby(p, f64::INFINITY).unwrap();
                assert!(
                    near.distance_m.is_finite() && (near.gradient.norm() - 1.0).abs() < 1e-9,
                    "{obstacle:?} {p} {near:?}"
                );
                assert!(near.hessian.iter().all(|h| h.is_finite()), "{obstacle:?} {p} {near:?}");
                let back = obstacle.distance_m(&(p - near.gradient * near.distance_m));
                assert!(
                    back.abs() < 1e-12 * (1.0 + near.distance_m.abs()),
                    "{obstacle:?} {p:?} {near:?} {back:e}"
                );
            }
        }
    }

    #[test]
    fn surfaces_are_closed_lie_on_the_body_and_face_outward() {
        for (obstacle, _) in shapes() {
            let (positions, faces) = obstacle.surface(&Vec3::repeat(-1.0), &Vec3::repeat(1.0));
            let topology = crate::mesh::Topology::new(positions.len(), faces.clone()).unwrap();
            let is_plane = matches!(obstacle.shape, Shape::Plane(_));
            assert_eq!((0..topology.edge_count()).any(|e| topology.is_boundary_edge(e)), is_plane);
            assert!((1000..=5200).contains(&faces.len()), "{}", faces.len());
            assert!(positions.iter().all(|p| obstacle.distance_m(p).abs() < 1e-14));
            for face in &faces {
                let [a, b, c] = face.map(|v| positions[v]);
                let near = obstacle.nearby(&((a + b + c) / 3.0), 1.0).unwrap();
                let normal = (b - a).cross(&(c - a)).normalize();
                assert!(
                    near.gradient.dot(&normal) > 0.9 && near.distance_m.abs() < 0.03,
                    "{} {}",
                    obstacle.name,
                    near.distance_m
                );
            }
        }
    }

    #[test]
    fn a_planes_surface_covers_the_shadow() {
        let plane =
            Obstacle::plane("p", Vec3::new(0.0, 0.0, -1.0), Vec3::new(0.2, 0.1, 1.0)).unwrap();
        let (positions, _) = plane.surface(&Vec3::new(-1.0, -2.0, 0.0), &Vec3::new(3.0, 4.0, 0.0));
        let reach = |pick: fn(f64, f64) -> f64, axis: usize| {
            positions.iter().map(|p| p[axis]).reduce(pick).unwrap()
        };
        assert!(
            reach(f64::min, 0) < -1.0
                && reach(f64::max, 0) > 3.0
                && reach(f64::min, 1) < -2.0
                && reach(f64::max, 1) > 4.0
        );
        assert!(reach(f64::max, 0) < 8.0);
        // Even of a box that is a point.
        let (positions, _) = plane.surface(&Vec3::zeros(), &Vec3::zeros());
        assert!((positions[0] - positions[positions.len() - 1]).norm() > 0.1);
    }

    #[test]
    fn absurd_sizes_are_refused() {
        let zero = Vec3::zeros();
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e300, 1e-300] {
            let message = |made: Result<Obstacle>| {
                let error = made.unwrap_err();
                assert!(matches!(error, Error::Value { .. }));
                error.to_string()
            };
            assert!(
                message(Obstacle::sphere("b", zero, bad)).starts_with("b.radius_m: the radius is ")
            );
            assert!(
                message(Obstacle::capsule("b", zero, Vec3::x(), bad, 1.0))
                    .starts_with("b.radius_m: ")
            );
            assert!(
                message(Obstacle::capsule("b", zero, Vec3::x(), 1.0, bad))
                    .starts_with("b.end_radius_m: ")
            );
            assert!(
                message(Obstacle::ellipsoid("b", zero, [1.0, bad, 1.0], turn()))
                    .starts_with("b.radii_m: ")
            );
        }
        for bad in [f64::NAN, f64::INFINITY, -1e300] {
            let p = Vec3::new(0.0, bad, 0.0);
            assert!(
                Obstacle::sphere("b", p, 1.0).is_err()
                    && Obstacle::capsule("b", zero, p, 1.0, 1.0).is_err()
            );
            assert!(
                Obstacle::plane("b", p, Vec3::x()).is_err()
                    && Obstacle::ellipsoid("b", p, [1.0; 3], turn()).is_err()
            );
        }
        for normal in [zero, Vec3::repeat(f64::NAN), Vec3::new(0.0, f64::INFINITY, 0.0)] {
            assert!(
                Obstacle::plane("b", zero, normal)
                    .unwrap_err()
                    .to_string()
                    .starts_with("b.normal: ")
            );
        }
        assert!(Obstacle::plane("b", zero, Vec3::repeat(1e300)).is_ok());
        assert!(
            Obstacle::ellipsoid("b", zero, [1e-3, 1.0, 100.0], turn())
                .unwrap_err()
                .to_string()
                .contains("too unlike")
        );
    }

    #[test]
    fn obstacles_can_be_shared_among_threads() {
        fn check<T: Send + Sync>() {}
        check::<Obstacle>();
    }
}
