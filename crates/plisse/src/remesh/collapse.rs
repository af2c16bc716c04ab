//! Edge collapse: a vertex is taken out by drawing it onto a neighbour.

use super::patch::{Fan, Patch, flat_angle};
use super::unfold;
use crate::mesh::Vec2;
use crate::rest::RestFace;

/// Largest angle (rad) from straight of the boundary, at rest, where a vertex is taken out of it.
const STRAIGHT: f64 = 1e-6;
/// Largest relative loss of length of the boundary in space where a vertex is taken out of it.
const BOUNDARY_LOSS: f64 = 1e-12;
/// Least ratio of height to base of a new face at rest.
const FLATTEST: f64 = 0.02;

/// Limits of a collapse.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tolerances {
    /// Most (rad) by which angles around the vertex may differ from a flat vertex's, at rest.
    pub(super) flatness: f64,
    /// Most (m²) by which the rest area around it may change.
    pub(super) area_m2: f64,
}

/// A collapse that may be done.
struct Plan {
    /// Faces that go.
    gone: Vec<usize>,
    /// Faces that stay: number, corner of the vertex, new metric.
    kept: Vec<(usize, usize, RestFace)>,
    /// Change (m²) of the rest area.
    area_change_m2: f64,
    /// Ends (other than the vertex kept) and lengths (m) of the new edges.
    spokes: Vec<(usize, f64)>,
}

impl Patch {
    /// Draws `v` onto its neighbour `u`, which stays where it is, so that what vertices carry is
    /// not blended. Returns the change of the rest area (m²). `fits` (end, length in m) says
    /// whether a new edge from `u` may be.
    ///
    /// The faces around `v` are unfolded together at rest. Where they do not quite close, their
    /// angles are scaled alike, the least stretch that keeps the spokes; outer sides keep their
    /// lengths exactly, so faces outside do not change.
    ///
    /// None, and nothing happens: if `v` is frozen, on a seam or beside inactive faces; if it is on
    /// the boundary, but not within a straight stretch to `u`; if it is not flat at rest within
    /// `tolerances`; if the result were no manifold, or a face froze or turned over, in space, at
    /// the start, at rest or in texture space.
    pub(super) fn collapse(
        &mut self,
        v: usize,
        u: usize,
        tolerances: Tolerances,
        fits: impl Fn(&Self, usize, f64) -> bool,
    ) -> Option<f64> {
        let plan = self.plan(v, u, tolerances)?;
        if !plan.spokes.iter().all(|&(w, length)| fits(self, w, length)) || !self.move_uvs(u, &plan)
        {
            return None;
        }
        for &(f, k, metric) in &plan.kept {
            self.mesh.faces[f][k] = u;
            self.mesh.rest[f] = metric;
            self.changed[f] = true;
            self.around[u].push(f);
        }
        for &f in &plan.gone {
            self.dead[f] = true;
            for w in self.mesh.faces[f] {
                self.detach(f, w);
            }
        }
        self.around[v].clear();
        self.living -= 1;
        Some(plan.area_change_m2)
    }

    fn plan(&self, v: usize, u: usize, tolerances: Tolerances) -> Option<Plan> {
        if self.mesh.frozen[v] != [false; 3] || self.around[v].iter().any(|&f| !self.active[f]) {
            return None;
        }
        let fan = self.fan(v)?;
        let rim = self.rim(&fan);
        if !self.may_join(v, u, &fan, &rim) {
            return None;
        }
        let places = self.lay_out(&fan, tolerances.flatness)?;
        let n = fan.faces.len();
        // Where u is on the rim; a closed rim repeats its first vertex at the end.
        let at_u = rim.iter().position(|&w| w == u)?;
        let beside = |i: usize| rim[i] == u || rim[i + 1] == u;
        let mut plan =
            Plan { gone: Vec::new(), kept: Vec::new(), area_change_m2: 0.0, spokes: Vec::new() };
        // Length from u to the rim's vertex i.
        let spoke = |i: usize| {
            let next = (0..n).find(|&s| beside(s) && (rim[s] == rim[i] || rim[s + 1] == rim[i]));
            match next {
                Some(s) => unfold::side(&self.mesh.rest[fan.faces[s].0], (fan.faces[s].1 + 1) % 3),
                None => (places[i] - places[at_u]).norm(),
            }
        };
        let (mut old, mut new) = (Vec::new(), Vec::new());
        for (i, &(f, k)) in fan.faces.iter().enumerate() {
            let face = &self.mesh.rest[f];
            plan.area_change_m2 -= face.area_m2;
            if beside(i) {
                plan.gone.push(f);
                continue;
            }
            let (a, b) = (places[i] - places[at_u], places[i + 1] - places[at_u]);
            let outer = unfold::side(face, (k + 1) % 3);
            if a.perp(&b) < FLATTEST * outer.max(a.norm()).max(b.norm()).powi(2) {
                return None;
            }
            let turned = unfold::metric_of_sides(spoke(i), spoke(i + 1), outer)?;
            plan.area_change_m2 += turned.area_m2;
            let metric = turn(&turned, k);
            plan.kept.push((f, k, metric));
            let corners = self.mesh.faces[f];
            let mut moved = corners;
            moved[k] = u;
            if self.would_freeze(&moved) {
                return None;
            }
            old.push(corners);
            new.push(moved);
            for w in [i, i + 1] {
                if !self.joined(rim[w], u) && plan.spokes.iter().all(|s| s.0 != rim[w]) {
                    plan.spokes.push((rim[w], spoke(w)));
                }
            }
        }
        let small = plan.area_change_m2.abs() <= tolerances.area_m2;
        (small && self.keeps_sides(&old, &new, false)).then_some(plan)
    }

    /// Vertices around the fan in order: one more than faces; a closed rim ends with its first
    /// vertex.
    fn rim(&self, fan: &Fan) -> Vec<usize> {
        let next = |&(f, k): &(usize, usize)| self.mesh.faces[f][(k + 1) % 3];
        let mut rim: Vec<usize> = fan.faces.iter().map(next).collect();
        rim.extend(fan.faces.last().map(|&(f, k)| self.mesh.faces[f][(k + 2) % 3]));
        rim
    }

    /// True if drawing `v` onto `u` is allowed but for flatness: it keeps seams and boundary, and
    /// the result is a manifold (link condition).
    fn may_join(&self, v: usize, u: usize, fan: &Fan, rim: &[usize]) -> bool {
        let n = fan.faces.len();
        if fan.faces.iter().any(|&(f, k)| {
            self.is_seam(&self.edge_faces(v, self.mesh.faces[f][(k + 1) % 3])) || !self.active[f]
        }) {
            return false;
        }
        // Fewer faces would leave one, or none.
        if fan.closed && n < 4 || !fan.closed && n < 2 {
            return false;
        }
        if !fan.closed {
            let (begin, end) = (rim[0], rim[n]);
            if u != begin && u != end {
                return false;
            }
            let straight = [&self.mesh.positions, &self.mesh.start].into_iter().all(|places| {
                let (a, b, c) = (places[begin], places[v], places[end]);
                let through = (b - a).norm() + (c - b).norm();
                through - (c - a).norm() <= BOUNDARY_LOSS * through
            });
            if !straight {
                return false;
            }
        }
        // Link condition: u and v have no common neighbours but the corners opposite their edge.
        let shared = rim[..n + usize::from(!fan.closed)]
            .iter()
            .filter(|&&w| w != u && self.joined(w, u))
            .count();
        let opposite = if fan.closed { 2 } else { 1 };
        // The corners opposite the edge keep faces enough.
        let corners = self.edge_faces(v, u);
        let enough = corners.iter().all(|(f, k)| {
            let w = self.mesh.faces[f][(k + 2) % 3];
            self.around[w].len() > if self.on_boundary(w) { 1 } else { 3 }
        });
        shared == opposite && enough
    }

    /// Places (m) of the rim's vertices around the vertex of `fan` at the origin, at rest; none if
    /// it is not flat within `flatness` (rad).
    fn lay_out(&self, fan: &Fan, flatness: f64) -> Option<Vec<Vec2>> {
        let rest = |i: usize| &self.mesh.rest[fan.faces[i].0];
        let angles: Vec<f64> =
            fan.faces.iter().map(|&(f, k)| unfold::angle(&self.mesh.rest[f], k)).collect();
        let (sum, flat) = (angles.iter().sum::<f64>(), flat_angle(fan.closed));
        if (sum - flat).abs() > if fan.closed { flatness } else { flatness.min(STRAIGHT) } {
            return None;
        }
        let mut turned = 0.0;
        let mut places = Vec::with_capacity(angles.len() + 1);
        for (i, angle) in angles.iter().enumerate() {
            places.push(
                Vec2::new(f64::cos(turned), f64::sin(turned))
                    * unfold::side(rest(i), fan.faces[i].1),
            );
            turned += angle * (flat / sum);
        }
        let last = fan.faces.len() - 1;
        let end = if fan.closed {
            places[0]
        } else {
            Vec2::new(-unfold::side(rest(last), (fan.faces[last].1 + 2) % 3), 0.0)
        };
        places.push(end);
        Some(places)
    }

    /// Gives the moved corners of `plan` the texture place of `u`; false, and nothing happens, if a
    /// face turned over.
    fn move_uvs(&mut self, u: usize, plan: &Plan) -> bool {
        let Some(&place) = plan.gone.first() else { return false };
        let corner = self.corner(place, u).expect("faces that go are beside the edge");
        let Some(uvs) = &mut self.mesh.uvs else { return true };
        let to = uvs[place][corner];
        let area = |[a, b, c]: [Vec2; 3]| (b - a).perp(&(c - a));
        let moved = |uv: [Vec2; 3], k: usize| {
            let mut uv = uv;
            uv[k] = to;
            uv
        };
        if plan.kept.iter().any(|&(f, k, _)| area(uvs[f]) * area(moved(uvs[f], k)) < 0.0) {
            return false;
        }
        for &(f, k, _) in &plan.kept {
            uvs[f] = moved(uvs[f], k);
        }
        true
    }
}

/// `face`, whose first corner is to be the corner `k`.
fn turn(face: &RestFace, k: usize) -> RestFace {
    if k == 0 {
        return *face;
    }
    let p = unfold::corners(face);
    unfold::metric([0, 1, 2].map(|n| p[(n + 3 - k) % 3]))
}
