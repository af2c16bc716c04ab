//! What the paper only wished for: folds that do not pass through each other.
//!
//! Every vertex against every face and every edge against every edge that have no vertex in common.
//! With d their distance, t the contact thickness and s = d/t, the energy is p·A·t·B(s) with B =
//! −(1 − s)²·ln s below s = 1 (the barrier of Li et al. 2020, *Incremental Potential Contact*), and
//! for two edges times a factor that vanishes as they become parallel, where their distance has a
//! kink. A is the starting area of the four vertices' share, p about the pressure of the foundation
//! under a fold. No step is longer than the way is clear (`advance`), so what does not cross at the
//! start never does.
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
use additive_ccd::advance;
use distance::{Near, Pair};

/// Faces or pairs a thread takes at once.
const CHUNK: usize = 256;
/// Edges count as parallel below this sine, squared.
const PARALLEL: f64 = 1e-3;
/// How far ahead, in thicknesses, couplings are foreseen.
const AHEAD: f64 = 1.5;
/// How much farther, as a share of the longest move, pairs are listed, so that small moves need no
/// new list.
const SKIN: f64 = 0.1;
/// A new list is made where more than one in so many faces moves farther than the list foresaw.
const FEW: usize = 8;

/// Gradient (N) and a positive semidefinite part of the Hessian (N/m) of one pair:
/// `bend`·slope·slopeᵀ.
#[derive(Clone, Debug)]
pub(crate) struct Touch {
    /// Vertices.
    pub(crate) vertices: [usize; 4],
    /// ∂energy/∂x of each vertex.
    pub(crate) gradient: [Vec3; 4],
    /// ∂d/∂x of each vertex.
    pub(crate) slope: [Vec3; 4],
    pub(crate) bend: f64,
    /// Whether the matrix has no room for its couplings yet: a bound of the Hessian that couples
    /// nothing stands for it.
    pub(crate) loose: bool,
}

/// The contact of a surface with itself.
#[derive(Clone, Debug)]
pub(crate) struct SelfContact<'a> {
    topology: &'a Topology,
    start: &'a [Vec3],
    /// `[V]` pressure times a quarter of the starting area (N).
    strength: Vec<f64>,
    thickness_m: f64,
    /// Longest move (m) of a vertex in one step.
    longest_m: f64,
    /// `[V]` first face of each vertex, which speaks for it; [`usize::MAX`] for a loose one.
    speaker: Vec<usize>,
    /// All pairs that can be within the thickness where the surface is now and may step to.
    candidates: Vec<Pair>,
    /// All pairs that can be while no vertex is farther than half of [`SKIN`] from where it was
    /// when they were listed, and how far (m) the two were apart then.
    listed: Vec<(Pair, f64)>,
    listed_at: Vec<Vec3>,
}

impl<'a> SelfContact<'a> {
    /// Contact within `thickness_m` of the surface that starts at `start` (`[V]`, m).
    /// `strength_newton` (`[V]`) is the pressure times area with which each vertex is pushed away;
    /// no vertex moves more than `longest_m` in a step.
    pub(crate) fn new(
        topology: &'a Topology,
        start: &'a [Vec3],
        thickness_m: f64,
        longest_m: f64,
        strength_newton: &[f64],
    ) -> Self {
        let mut speaker = vec![usize::MAX; start.len()];
        for (f, face) in topology.faces.iter().enumerate().rev() {
            face.iter().for_each(|&v| speaker[v] = f);
        }
        let strength = strength_newton.iter().map(|s| 0.25 * s).collect();
        Self {
            topology,
            start,
            strength,
            thickness_m,
            longest_m,
            speaker,
            candidates: Vec::new(),
            listed: Vec::new(),
            listed_at: Vec::new(),
        }
    }

    /// Looks for what is within the thickness at `pose` (`[V]`, m), and a little more.
    pub(crate) fn look(&mut self, pose: &[Vec3]) {
        self.list(pose);
        let near =
            |(pair, distance): &(Pair, f64)| self.ahead(pair, *distance, 0.0).then_some(*pair);
        self.candidates = self.listed.par_iter().with_min_len(CHUNK).filter_map(near).collect();
    }

    /// The longest part (0 to 1) of the move of `pose` (`[V]`, m) by `moves` (`[V]`, m) that may be
    /// made; from then on, energies anywhere on that way are true.
    ///
    /// Where no vertex goes farther than the list foresaw, pairs are those listed; around the
    /// others they are looked for.
    pub(crate) fn look_ahead(&mut self, pose: &[Vec3], moves: &[Vec3]) -> f64 {
        let most = moves.iter().map(|m| m.norm_squared()).fold(0.0, f64::max).sqrt();
        let part = if most > self.longest_m { self.longest_m / most } else { 1.0 };
        let end: Vec<Vec3> = pose.iter().zip(moves).map(|(p, m)| p + m * part).collect();
        let mut gone = self.gone(pose, &end);
        if FEW * self.fast(&gone) > self.topology.face_count() {
            let still: Vec<f64> = pose.iter().zip(&end).map(|(p, q)| (p - q).norm()).collect();
            if FEW * self.fast(&still) <= self.topology.face_count() {
                self.list(pose);
                gone = still;
            }
        }
        let room = self.room();
        let way = |pair: &Pair| {
            let vertices = pair.vertices();
            let way = advance(pair, vertices.map(|v| pose[v]), vertices.map(|v| moves[v] * part));
            let soon = way.part < 1.0 || self.ahead(pair, way.least_distance, 0.0);
            soon.then_some((*pair, way.part))
        };
        let of_listed = |(pair, distance): &(Pair, f64)| {
            let foreseen = pair.vertices().iter().all(|&v| gone[v] <= room);
            let stays_off = || distance - pair.most_nearer(&gone) >= AHEAD * self.thickness_m;
            if foreseen && !stays_off() { way(pair) } else { None }
        };
        let mut ways: Vec<(Pair, f64)> =
            self.listed.par_iter().with_min_len(CHUNK).filter_map(of_listed).collect();
        if gone.iter().any(|&gone| gone > room) {
            let fast = |pair: &Pair| pair.vertices().iter().any(|&v| gone[v] > room);
            ways.extend(self.pairs_in_boxes(
                |part| self.bounds(part, pose).merged(&self.bounds(part, &end)),
                |f| self.topology.faces[f].iter().any(|&v| gone[v] > room),
                |pair| if fast(&pair) { way(&pair) } else { None },
            ));
        }
        self.candidates.clear();
        self.candidates.extend(ways.iter().map(|(pair, _)| *pair));
        part * ways.iter().map(|(_, part)| *part).fold(1.0, f64::min)
    }

    /// How far (m) a vertex may go from where it was when pairs were listed.
    fn room(&self) -> f64 {
        0.5 * SKIN * self.longest_m
    }

    /// `[V]` how far (m) each vertex is from where it was when pairs were listed, at most on a
    /// straight way.
    fn gone(&self, pose: &[Vec3], end: &[Vec3]) -> Vec<f64> {
        if self.listed_at.len() != pose.len() {
            return vec![f64::INFINITY; pose.len()];
        }
        let from = |v: usize| {
            (pose[v] - self.listed_at[v]).norm().max((end[v] - self.listed_at[v]).norm())
        };
        (0..pose.len()).map(from).collect()
    }

    /// How many faces have a vertex that goes farther than was foreseen.
    fn fast(&self, gone: &[f64]) -> usize {
        let room = self.room();
        self.topology.faces.iter().filter(|face| face.iter().any(|&v| gone[v] > room)).count()
    }

    /// Lists what can be near while nothing moves far from `pose` (`[V]`, m).
    fn list(&mut self, pose: &[Vec3]) {
        let room = self.room();
        let near = |pair: Pair| {
            let distance = pair.near(pair.vertices().map(|v| pose[v])).distance;
            self.ahead(&pair, distance, 2.0 * room).then_some((pair, distance))
        };
        self.listed =
            self.pairs_in_boxes(|part| self.bounds(part, pose).loosened(room), |_| true, near);
        self.listed_at = pose.to_vec();
    }

    /// Whether a pair touches at `pose` (`[V]`, m) or soon may, or both within `skin` (m) of that.
    fn near(&self, pair: &Pair, pose: &[Vec3], skin: f64) -> bool {
        self.ahead(pair, pair.near(pair.vertices().map(|v| pose[v])).distance, skin)
    }

    fn ahead(&self, pair: &Pair, distance: f64, skin: f64) -> bool {
        distance < AHEAD * self.thickness_m + skin
            && distance < AHEAD * self.thickness_m(pair) + skin
    }

    /// The box of the vertices `part` at `pose` (`[V]`, m), and half the reach on each of two
    /// parts.
    fn bounds(&self, part: &[usize], pose: &[Vec3]) -> Aabb {
        let half = Vector::splat(0.5 * AHEAD * self.thickness_m);
        let place = |v: usize| Vector::new(pose[v].x, pose[v].y, pose[v].z);
        let first = place(part[0]);
        let ends = part[1..]
            .iter()
            .fold([first, first], |[low, high], &v| [low.min(place(v)), high.max(place(v))]);
        Aabb::new(ends[0] - half, ends[1] + half)
    }

    /// What `keep` makes of all pairs whose boxes meet and of which one is on an `asked` face, each
    /// once, in a fixed order.
    fn pairs_in_boxes<T: Send>(
        &self,
        bounds: impl Fn(&[usize]) -> Aabb + Sync + Send,
        asked: impl Fn(usize) -> bool + Sync + Send,
        keep: impl Fn(Pair) -> Option<T> + Sync + Send,
    ) -> Vec<T> {
        let topology = self.topology;
        let faces: Vec<Aabb> =
            topology.faces.par_iter().with_min_len(CHUNK).map(|face| bounds(face)).collect();
        let is_asked: Vec<bool> = (0..faces.len()).map(asked).collect();
        // What is far from all that is asked needs no looking at.
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
                            if self.speaker[v] == from
                                && v != a
                                && v != b
                                && v != c
                                && vertices[v].intersects(&faces[to])
                            {
                                kept.extend(keep(Pair::VertexFace([v, a, b, c])));
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
                                kept.extend(keep(Pair::Edges([a, b, c, d])));
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
    fn thickness_m(&self, pair: &Pair) -> f64 {
        self.thickness_m.min(0.5 * pair.near(pair.vertices().map(|v| self.start[v])).distance)
    }

    /// Where a pair is near, with its thickness (m) and strength (N), if it is in touch.
    fn in_touch(&self, pair: &Pair, x: [Vec3; 4]) -> Option<(Near, f64, f64)> {
        let near = pair.near(x);
        if near.distance >= self.thickness_m {
            return None;
        }
        let thickness_m = self.thickness_m(pair);
        (near.distance < thickness_m)
            .then(|| (near, thickness_m, pair.vertices().iter().map(|&v| self.strength[v]).sum()))
    }

    /// Energy (J) at `pose` (`[V]`, m).
    pub(crate) fn energy(&self, pose: &[Vec3]) -> f64 {
        let of_pair = |pair: &Pair| {
            let x = pair.vertices().map(|v| pose[v]);
            self.in_touch(pair, x).map_or(0.0, |(near, thickness_m, strength)| {
                strength
                    * thickness_m
                    * barrier(near.distance / thickness_m)[0]
                    * self.slant(pair, x).0
            })
        };
        let sums: Vec<f64> = self
            .candidates
            .par_chunks(CHUNK)
            .map(|pairs| pairs.iter().map(of_pair).sum())
            .collect();
        sums.iter().sum()
    }

    /// What touches at `pose` (`[V]`, m).
    pub(crate) fn touches(&self, pose: &[Vec3]) -> Vec<Touch> {
        let of_pair = |pair: &Pair| {
            let vertices = pair.vertices();
            let x = vertices.map(|v| pose[v]);
            self.in_touch(pair, x).map(|(near, thickness_m, strength)| {
                let [value, down, bend] =
                    barrier(near.distance / thickness_m).map(|b| strength * b);
                let (factor, slant) = self.slant(pair, x);
                let slope = near.weights.map(|w| near.normal * w);
                let gradient = std::array::from_fn(|k| {
                    slope[k] * (down * factor) + slant[k] * (value * thickness_m)
                });
                Touch { vertices, gradient, slope, bend: factor * bend / thickness_m, loose: false }
            })
        };
        self.candidates.par_iter().with_min_len(CHUNK).filter_map(of_pair).collect()
    }

    /// The vertices of all pairs that touch at `pose` (`[V]`, m) or soon may.
    pub(crate) fn soon(&self, pose: &[Vec3]) -> Vec<[usize; 4]> {
        let near = |pair: &Pair| self.near(pair, pose, 0.0).then(|| pair.vertices());
        self.candidates.par_iter().with_min_len(CHUNK).filter_map(near).collect()
    }

    /// The factor for edges that are nearly parallel, and its slope (1/m) by each vertex; 1 for all
    /// others.
    fn slant(&self, pair: &Pair, x: [Vec3; 4]) -> (f64, [Vec3; 4]) {
        const FULL: (f64, [Vec3; 4]) = (1.0, [Vec3::new(0.0, 0.0, 0.0); 4]);
        let Pair::Edges([a, b, c, d]) = *pair else { return FULL };
        let (u, v) = (x[1] - x[0], x[3] - x[2]);
        let most = PARALLEL
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
            contact.look(&pose);
            let x: Vec<f64> = pose.iter().flat_map(|p| p.iter().copied()).collect();
            let at = |y: &[f64]| {
                contact
                    .energy(&y.chunks(3).map(|p| Vec3::new(p[0], p[1], p[2])).collect::<Vec<_>>())
            };
            let (touches, mut gradient) = (contact.touches(&pose), vec![0.0; 18]);
            assert!(touches.len() > 3);
            for touch in &touches {
                for (v, force) in touch.vertices.iter().zip(&touch.gradient) {
                    (0..3).for_each(|axis| gradient[3 * v + axis] += force[axis]);
                }
            }
            let soft = |pair: &Pair| contact.slant(pair, pair.vertices().map(|v| pose[v])).0 < 1.0;
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
        contact.look(&start);
        assert_eq!(contact.energy(&start), 0.0);
        let down: Vec<Vec3> =
            (0..6).map(|v| Vec3::new(0.01, 0.02, if v < 3 { 0.0 } else { -5.0 })).collect();
        let part = contact.look_ahead(&start, &down);
        assert!(part > 0.01 && part < 0.02, "{part}");
        let near: Vec<Vec3> = start.iter().zip(&down).map(|(p, m)| p + m * part).collect();
        assert!(contact.energy(&near) > 0.0);
    }
}
