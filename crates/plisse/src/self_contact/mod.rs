//! Contact of a surface with itself: an incremental potential (Li et al. 2020, *Incremental
//! Potential Contact*) that keeps folds from passing through each other.
//!
//! The primitive pairs are every vertex with every face and every edge with every edge that have no
//! vertex in common. With d their distance, t the contact thickness and s = d/t, the energy is
//! p·A·t·B(s) with the barrier B = −(1 − s)²·ln s below s = 1. For two edges it has a mollifier
//! that vanishes as they become parallel, where their distance has a kink. A is the starting area
//! of the four vertices' share, p about the pressure of the foundation under a fold. Steps are
//! collision-free (additive continuous collision detection, `additive_ccd`), so a surface that does
//! not cross itself at the start never does.
//!
//! The thickness of a pair is at most half its distance on the starting surface: nothing is in
//! contact before it grows.

mod additive_ccd;
mod distance;

use std::ops::Range;

use parry3d_f64::bounding_volume::{Aabb, BoundingVolume};
use parry3d_f64::math::Vector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy};
use rayon::prelude::*;

use crate::mesh::{Topology, Vec3};
use crate::shell::contact::barrier;
use additive_ccd::collision_free_part;
use distance::{ClosestPoints, PrimitivePair};

/// Faces or pairs in one block of a parallel loop.
const CHUNK: usize = 256;
/// Squared sine of the angle between two edges below which their energy is mollified.
const MOLLIFIER_THRESHOLD: f64 = 1e-3;
/// Distance, in thicknesses, up to which a pair is a candidate of contact.
const CANDIDATE_DISTANCE: f64 = 1.5;
/// Skin of the Verlet list, as a share of the longest move: moves up to half of it need no new
/// list.
const VERLET_SKIN: f64 = 0.1;
/// Faces for each one that leaves its skin, below which the list is made anew.
const FACES_PER_FAST_FACE: usize = 8;

/// Active contact of one pair: gradient (N) and a positive semidefinite part of the Hessian (N/m),
/// stiffness·slope·slopeᵀ.
#[derive(Clone, Debug)]
pub struct Contact {
    /// Vertices.
    pub vertices: [usize; 4],
    /// ∂energy/∂x (N) of each vertex.
    pub gradient: [Vec3; 4],
    /// ∂d/∂x (no unit) of each vertex.
    pub slope: [Vec3; 4],
    /// ∂²energy/∂d² (N/m).
    pub stiffness: f64,
    /// True if the matrix pattern lacks its couplings: a block-diagonal bound replaces its Hessian.
    pub uncoupled: bool,
}

/// Contact of a surface with itself.
#[derive(Clone, Debug)]
pub struct SelfContact<'a> {
    topology: &'a Topology,
    start: &'a [Vec3],
    /// `[V]` pressure times a quarter of the starting area (N).
    strength: Vec<f64>,
    thickness_m: f64,
    /// Longest move (m) of a vertex in one step.
    longest_m: f64,
    /// `[V]` representative face of each vertex, its first one; [`usize::MAX`] without a face.
    representative_face: Vec<usize>,
    /// Pairs that can be within the thickness at the present pose and along the present step.
    candidates: Vec<PrimitivePair>,
    /// Verlet list: all pairs that can be candidates while no vertex has moved farther than half of
    /// the skin, with their distances (m) when they were listed.
    verlet_list: Vec<(PrimitivePair, f64)>,
    /// `[V]` pose (m) for which the list was made.
    listed_pose: Vec<Vec3>,
}

impl<'a> SelfContact<'a> {
    /// Contact within `thickness_m` of the surface that starts at `start` (`[V]`, m).
    /// `strength_newton` (`[V]`) is the pressure times area with which each vertex is pushed away;
    /// no vertex moves more than `longest_m` in a step.
    pub fn new(
        topology: &'a Topology,
        start: &'a [Vec3],
        thickness_m: f64,
        longest_m: f64,
        strength_newton: &[f64],
    ) -> Self {
        let mut representative_face = vec![usize::MAX; start.len()];
        for (f, face) in topology.faces.iter().enumerate().rev() {
            face.iter().for_each(|&v| representative_face[v] = f);
        }
        let strength = strength_newton.iter().map(|s| 0.25 * s).collect();
        Self {
            topology,
            start,
            strength,
            thickness_m,
            longest_m,
            representative_face,
            candidates: Vec::new(),
            verlet_list: Vec::new(),
            listed_pose: Vec::new(),
        }
    }

    /// Detects the candidates of contact at `pose` (`[V]`, m).
    pub fn detect(&mut self, pose: &[Vec3]) {
        self.build_list(pose);
        let near = |(pair, distance): &(PrimitivePair, f64)| {
            self.is_candidate(pair, *distance, 0.0).then_some(*pair)
        };
        self.candidates =
            self.verlet_list.par_iter().with_min_len(CHUNK).filter_map(near).collect();
    }

    /// Collision-free step: the longest part (0 to 1) of the move of `pose` (`[V]`, m) by `moves`
    /// (`[V]`, m) along which nothing collides. Afterwards energies anywhere on that step are
    /// exact.
    ///
    /// Pairs come from the Verlet list where no vertex leaves its skin; around the other vertices
    /// they are searched for.
    pub fn collision_free_step(&mut self, pose: &[Vec3], moves: &[Vec3]) -> f64 {
        let most = moves.iter().map(|m| m.norm_squared()).fold(0.0, f64::max).sqrt();
        let part = if most > self.longest_m { self.longest_m / most } else { 1.0 };
        let end: Vec<Vec3> = pose.iter().zip(moves).map(|(p, m)| p + m * part).collect();
        let mut displacement = self.displacement_m(pose, &end);
        if FACES_PER_FAST_FACE * self.fast_face_count(&displacement) > self.topology.face_count() {
            let still: Vec<f64> = pose.iter().zip(&end).map(|(p, q)| (p - q).norm()).collect();
            if FACES_PER_FAST_FACE * self.fast_face_count(&still) <= self.topology.face_count() {
                self.build_list(pose);
                displacement = still;
            }
        }
        let half_skin = self.half_skin_m();
        let way = |pair: &PrimitivePair| {
            let vertices = pair.vertices();
            let (x, moves) = (vertices.map(|v| pose[v]), vertices.map(|v| moves[v] * part));
            let way = collision_free_part(pair, x, moves);
            let candidate = way.part < 1.0 || self.is_candidate(pair, way.least_distance, 0.0);
            candidate.then_some((*pair, way.part))
        };
        let of_listed = |(pair, distance): &(PrimitivePair, f64)| {
            let in_skin = pair.vertices().iter().all(|&v| displacement[v] <= half_skin);
            let reach = CANDIDATE_DISTANCE * self.thickness_m;
            let stays_off = || distance - pair.approach_bound(&displacement) >= reach;
            if in_skin && !stays_off() { way(pair) } else { None }
        };
        let mut ways: Vec<(PrimitivePair, f64)> =
            self.verlet_list.par_iter().with_min_len(CHUNK).filter_map(of_listed).collect();
        if displacement.iter().any(|&displacement| displacement > half_skin) {
            let fast =
                |pair: &PrimitivePair| pair.vertices().iter().any(|&v| displacement[v] > half_skin);
            ways.extend(self.pairs_in_boxes(
                |part| self.bounds(part, pose).merged(&self.bounds(part, &end)),
                |f| self.topology.faces[f].iter().any(|&v| displacement[v] > half_skin),
                |pair| if fast(&pair) { way(&pair) } else { None },
            ));
        }
        self.candidates.clear();
        self.candidates.extend(ways.iter().map(|(pair, _)| *pair));
        part * ways.iter().map(|(_, part)| *part).fold(1.0, f64::min)
    }

    /// Distance (m) that a vertex may move from the pose of the list.
    fn half_skin_m(&self) -> f64 {
        0.5 * VERLET_SKIN * self.longest_m
    }

    /// `[V]` largest distance (m) of each vertex from the pose of the list, on the straight way
    /// from `pose` to `end`.
    fn displacement_m(&self, pose: &[Vec3], end: &[Vec3]) -> Vec<f64> {
        if self.listed_pose.len() != pose.len() {
            return vec![f64::INFINITY; pose.len()];
        }
        let from = |v: usize| {
            (pose[v] - self.listed_pose[v]).norm().max((end[v] - self.listed_pose[v]).norm())
        };
        (0..pose.len()).map(from).collect()
    }

    /// Number of faces with a vertex that leaves its skin.
    fn fast_face_count(&self, displacement: &[f64]) -> usize {
        let half_skin = self.half_skin_m();
        let leaves = |face: &&[usize; 3]| face.iter().any(|&v| displacement[v] > half_skin);
        self.topology.faces.iter().filter(leaves).count()
    }

    /// Builds the Verlet list around `pose` (`[V]`, m).
    fn build_list(&mut self, pose: &[Vec3]) {
        let half_skin = self.half_skin_m();
        let near = |pair: PrimitivePair| {
            let distance = pair.closest_points(pair.vertices().map(|v| pose[v])).distance;
            self.is_candidate(&pair, distance, 2.0 * half_skin).then_some((pair, distance))
        };
        self.verlet_list =
            self.pairs_in_boxes(|part| self.bounds(part, pose).loosened(half_skin), |_| true, near);
        self.listed_pose = pose.to_vec();
    }

    /// True if a pair at this `distance` (m) is a candidate of contact, or within `skin` (m) of it.
    fn is_candidate(&self, pair: &PrimitivePair, distance: f64, skin: f64) -> bool {
        distance < CANDIDATE_DISTANCE * self.thickness_m + skin
            && distance < CANDIDATE_DISTANCE * self.thickness_m(pair) + skin
    }

    /// Bounding box of the vertices `part` at `pose` (`[V]`, m), loosened by half the distance of
    /// candidates.
    fn bounds(&self, part: &[usize], pose: &[Vec3]) -> Aabb {
        let half = Vector::splat(0.5 * CANDIDATE_DISTANCE * self.thickness_m);
        let place = |v: usize| Vector::new(pose[v].x, pose[v].y, pose[v].z);
        let first = place(part[0]);
        let ends = part[1..]
            .iter()
            .fold([first, first], |[low, high], &v| [low.min(place(v)), high.max(place(v))]);
        Aabb::new(ends[0] - half, ends[1] + half)
    }

    /// Broad phase: all pairs whose boxes meet and of which one is on an `asked` face, each once,
    /// in a fixed order, mapped by `keep`.
    fn pairs_in_boxes<T: Send>(
        &self,
        bounds: impl Fn(&[usize]) -> Aabb + Sync + Send,
        asked: impl Fn(usize) -> bool + Sync + Send,
        keep: impl Fn(PrimitivePair) -> Option<T> + Sync + Send,
    ) -> Vec<T> {
        let topology = self.topology;
        let faces: Vec<Aabb> =
            topology.faces.par_iter().with_min_len(CHUNK).map(|face| bounds(face)).collect();
        let is_asked: Vec<bool> = (0..faces.len()).map(asked).collect();
        // Faces far from all asked ones are left out.
        let Some(around) = (0..faces.len())
            .filter(|&f| is_asked[f])
            .map(|f| faces[f])
            .reduce(|all, one| all.merged(&one))
        else {
            return Vec::new();
        };
        let here: Vec<usize> = (0..faces.len()).filter(|&f| faces[f].intersects(&around)).collect();
        let edges: Vec<Aabb> =
            topology.edges.par_iter().with_min_len(CHUNK).map(|edge| bounds(edge)).collect();
        let vertices: Vec<Aabb> = (0..self.start.len())
            .into_par_iter()
            .with_min_len(CHUNK)
            .map(|v| bounds(&[v]))
            .collect();
        let tree = Bvh::from_leaves(
            BvhBuildStrategy::Binned,
            &here.iter().map(|&f| faces[f]).collect::<Vec<_>>(),
        );
        let of_faces = |range: Range<usize>| -> Vec<T> {
            let (mut others, mut kept) = (Vec::new(), Vec::new());
            for f in range.map(|n| here[n]).filter(|&f| is_asked[f]) {
                others.clear();
                others.extend(
                    tree.intersect_aabb(&faces[f])
                        .map(|n| here[n as usize])
                        .filter(|&g| g > f || !is_asked[g]),
                );
                others.sort_unstable();
                for &g in &others {
                    for (from, to) in [(f, g), (g, f)] {
                        let [a, b, c] = topology.faces[to];
                        for v in topology.faces[from] {
                            if self.representative_face[v] == from
                                && v != a
                                && v != b
                                && v != c
                                && vertices[v].intersects(&faces[to])
                            {
                                kept.extend(keep(PrimitivePair::VertexFace([v, a, b, c])));
                            }
                        }
                    }
                    let own = |f: usize| {
                        topology.face_edges[f]
                            .into_iter()
                            .filter(move |&e| topology.edge_faces[e][0] == f)
                    };
                    for first in own(f).filter(|&e| edges[e].intersects(&faces[g])) {
                        let [a, b] = topology.edges[first];
                        for second in own(g).filter(|&e| edges[e].intersects(&edges[first])) {
                            let [c, d] = topology.edges[second];
                            if a != c && a != d && b != c && b != d {
                                kept.extend(keep(PrimitivePair::Edges([a, b, c, d])));
                            }
                        }
                    }
                }
            }
            kept
        };
        let count = here.len();
        let parts: Vec<Vec<T>> = (0..count.div_ceil(CHUNK))
            .into_par_iter()
            .map(|c| of_faces(c * CHUNK..count.min((c + 1) * CHUNK)))
            .collect();
        parts.into_iter().flatten().collect()
    }

    /// Thickness (m) of a pair; none if the starting surface leaves none.
    fn thickness_m(&self, pair: &PrimitivePair) -> f64 {
        self.thickness_m
            .min(0.5 * pair.closest_points(pair.vertices().map(|v| self.start[v])).distance)
    }

    /// Closest points, thickness (m) and strength (N) of a pair, if it is an active contact.
    fn active(&self, pair: &PrimitivePair, x: [Vec3; 4]) -> Option<(ClosestPoints, f64, f64)> {
        let near = pair.closest_points(x);
        if near.distance >= self.thickness_m {
            return None;
        }
        let thickness_m = self.thickness_m(pair);
        (near.distance < thickness_m)
            .then(|| (near, thickness_m, pair.vertices().iter().map(|&v| self.strength[v]).sum()))
    }

    /// Energy (J) at `pose` (`[V]`, m).
    pub fn energy(&self, pose: &[Vec3]) -> f64 {
        let of_pair = |pair: &PrimitivePair| {
            let x = pair.vertices().map(|v| pose[v]);
            self.active(pair, x).map_or(0.0, |(near, thickness_m, strength)| {
                strength
                    * thickness_m
                    * barrier(near.distance / thickness_m)[0]
                    * self.mollifier(pair, x).0
            })
        };
        let sums: Vec<f64> = self
            .candidates
            .par_chunks(CHUNK)
            .map(|pairs| pairs.iter().map(of_pair).sum())
            .collect();
        sums.iter().sum()
    }

    /// Active contacts at `pose` (`[V]`, m).
    pub fn contacts(&self, pose: &[Vec3]) -> Vec<Contact> {
        let of_pair = |pair: &PrimitivePair| {
            let vertices = pair.vertices();
            let x = vertices.map(|v| pose[v]);
            self.active(pair, x).map(|(near, thickness_m, strength)| {
                let [value, first, second] =
                    barrier(near.distance / thickness_m).map(|b| strength * b);
                let (factor, factor_slope) = self.mollifier(pair, x);
                let slope = near.weights.map(|w| near.normal * w);
                let gradient = std::array::from_fn(|k| {
                    slope[k] * (first * factor) + factor_slope[k] * (value * thickness_m)
                });
                let stiffness = factor * second / thickness_m;
                Contact { vertices, gradient, slope, stiffness, uncoupled: false }
            })
        };
        self.candidates.par_iter().with_min_len(CHUNK).filter_map(of_pair).collect()
    }

    /// The vertices of all candidates at `pose` (`[V]`, m).
    pub fn nearby(&self, pose: &[Vec3]) -> Vec<[usize; 4]> {
        let near = |pair: &PrimitivePair| {
            let distance = pair.closest_points(pair.vertices().map(|v| pose[v])).distance;
            self.is_candidate(pair, distance, 0.0).then(|| pair.vertices())
        };
        self.candidates.par_iter().with_min_len(CHUNK).filter_map(near).collect()
    }

    /// Mollifier of edges that are nearly parallel, and its gradient (1/m) by each vertex; 1 for
    /// all other pairs.
    fn mollifier(&self, pair: &PrimitivePair, x: [Vec3; 4]) -> (f64, [Vec3; 4]) {
        const FULL: (f64, [Vec3; 4]) = (1.0, [Vec3::new(0.0, 0.0, 0.0); 4]);
        let PrimitivePair::Edges([a, b, c, d]) = *pair else { return FULL };
        let (u, v) = (x[1] - x[0], x[3] - x[2]);
        let most = MOLLIFIER_THRESHOLD
            * (self.start[b] - self.start[a]).norm_squared()
            * (self.start[d] - self.start[c]).norm_squared();
        let cross = u.cross(&v);
        let z = cross.norm_squared() / most;
        if z >= 1.0 {
            return FULL;
        }
        // z(2 − z), and ∂|u×v|²/∂u = 2 v×(u×v).
        let by = (2.0 - 2.0 * z) * 2.0 / most;
        let (along_u, along_v) = (v.cross(&cross) * by, cross.cross(&u) * by);
        (z * (2.0 - z), [-along_u, along_u, -along_v, along_v])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::derivative_check::gradient_error;
    use crate::random::Random;

    /// Two triangles far apart at the start, of which one floats over the other.
    fn two() -> (Topology, Vec<Vec3>) {
        let topology = Topology::new(6, vec![[0, 1, 2], [3, 4, 5]]).unwrap();
        let flat = [Vec3::zeros(), Vec3::x(), Vec3::y()];
        (topology, flat.into_iter().chain(flat.map(|p| p + Vec3::new(0.0, 0.0, 3.0))).collect())
    }

    #[test]
    fn forces_agree_with_differences() {
        let (topology, start) = two();
        let mut contact =
            SelfContact::new(&topology, &start, 0.5, 1.0, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        let mut random = Random(9);
        let mut slanted = 0;
        for n in 0..30 {
            // The later ones with nearly parallel edges.
            let noise = if n < 15 { 0.2 } else { 0.004 };
            let pose: Vec<Vec3> = start
                .iter()
                .enumerate()
                .map(|(v, p)| {
                    let by =
                        Vec3::new(random.unit() - 0.5, random.unit() - 0.5, random.unit() - 0.5)
                            * noise;
                    p + by - if v < 3 { Vec3::zeros() } else { Vec3::new(0.3, 0.1, 2.75) }
                })
                .collect();
            contact.detect(&pose);
            let x: Vec<f64> = pose.iter().flat_map(|p| p.iter().copied()).collect();
            let at = |y: &[f64]| {
                contact
                    .energy(&y.chunks(3).map(|p| Vec3::new(p[0], p[1], p[2])).collect::<Vec<_>>())
            };
            let (touches, mut gradient) = (contact.contacts(&pose), vec![0.0; 18]);
            assert!(touches.len() > 3);
            for touch in &touches {
                for (v, force) in touch.vertices.iter().zip(&touch.gradient) {
                    (0..3).for_each(|axis| gradient[3 * v + axis] += force[axis]);
                }
            }
            let soft = |pair: &PrimitivePair| {
                contact.mollifier(pair, pair.vertices().map(|v| pose[v])).0 < 1.0
            };
            slanted += contact.candidates.iter().filter(|pair| soft(pair)).count();
            let e = gradient_error(&x, 0.01, &gradient, at);
            assert!(e < 2e-5, "{n}: {e:e}");
        }
        assert!(slanted > 20, "{slanted}");
    }

    #[test]
    fn nothing_touches_at_the_start_and_nothing_goes_through() {
        let (topology, _) = two();
        let start: Vec<Vec3> = (0..6)
            .map(|v| {
                Vec3::new(
                    f64::from(v % 3 == 1),
                    f64::from(v % 3 == 2),
                    if v < 3 { 0.0 } else { 0.1 },
                )
            })
            .collect();
        let mut contact = SelfContact::new(&topology, &start, 0.5, 10.0, &[1.0; 6]);
        contact.detect(&start);
        assert_eq!(contact.energy(&start), 0.0);
        let down: Vec<Vec3> =
            (0..6).map(|v| Vec3::new(0.01, 0.02, if v < 3 { 0.0 } else { -5.0 })).collect();
        let part = contact.collision_free_step(&start, &down);
        assert!(part > 0.01 && part < 0.02, "{part}");
        let near: Vec<Vec3> = start.iter().zip(&down).map(|(p, m)| p + m * part).collect();
        assert!(contact.energy(&near) > 0.0);
    }
}
