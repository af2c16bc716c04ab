//! Wrinkles over bodies: the field does not know obstacles, so troughs may dip into them. Vertices
//! that do are moved to their surface.

use rayon::prelude::*;

use crate::mesh::Vec3;
use crate::obstacle::Obstacle;

/// Rounds over several obstacles: out of one may be into another.
const ROUNDS: usize = 8;

/// Moves each of `positions` (`[V]`, m) that is nearer than `clearance_m` to an obstacle, or inside
/// it, straight out to that distance. Returns how many were moved.
pub fn keep_out(positions: &mut [Vec3], obstacles: &[Obstacle], clearance_m: f64) -> usize {
    let settle = |p: &mut Vec3| {
        let mut moved = 0;
        for _ in 0..ROUNDS {
            let near = obstacles
                .iter()
                .filter_map(|o| o.nearby(p, clearance_m))
                .min_by(|a, b| a.distance_m.total_cmp(&b.distance_m));
            let Some(near) = near.filter(|near| near.distance_m < clearance_m * (1.0 - 1e-9))
            else {
                break;
            };
            *p += near.gradient * (clearance_m - near.distance_m);
            moved = 1;
        }
        moved
    };
    positions.par_iter_mut().map(settle).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_inside_comes_out_and_the_rest_stays() {
        let bodies = [
            Obstacle::sphere("a", Vec3::zeros(), 1.0).unwrap(),
            Obstacle::sphere("b", Vec3::x() * 1.5, 1.0).unwrap(),
        ];
        let far = Vec3::new(0.0, 0.0, 2.0);
        let mut positions = [Vec3::new(0.0, 0.0, 0.9), Vec3::new(0.72, 0.0, 0.5), far];
        assert_eq!(keep_out(&mut positions, &bodies, 0.01), 2);
        for p in &positions {
            assert!(bodies.iter().all(|body| body.distance_m(p) > 0.0099), "{p}");
        }
        assert!((positions[0] - Vec3::z() * 1.01).norm() < 1e-12 && positions[2] == far);
    }
}
