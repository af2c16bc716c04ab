//! Edge swap: an edge is replaced by the other diagonal of its two faces.

use super::patch::Patch;
use super::unfold;
use crate::mesh::Vec2;

/// Sum of the cotangents opposite an edge below which it is not Delaunay (0 but for rounding).
const DELAUNAY: f64 = -1e-9;
/// Least height of a new triangle over the old edge's square of length.
const FLATTEST: f64 = 1e-4;

impl Patch {
    /// True if the edge `a`–`b` is not Delaunay in the rest metric: a swap would make the least
    /// angle larger.
    pub(super) fn wants_swap(&self, a: usize, b: usize) -> bool {
        let faces = self.edge_faces(a, b);
        let (Some((f, k)), Some((g, l))) = (faces.forth, faces.back) else { return false };
        unfold::cotangent_over(&self.mesh.rest[f], k)
            + unfold::cotangent_over(&self.mesh.rest[g], l)
            < DELAUNAY
    }

    /// Swaps the edge `a`–`b` for the other diagonal and returns that one's ends. Both faces are
    /// unfolded in their own metric first, so lengths and the sum of areas stay. None, and nothing
    /// happens: on the boundary, beside inactive faces, on seams and frozen lines; where the flat
    /// quad is not convex, the other diagonal is there already, or a face would turn over or be
    /// frozen.
    pub(super) fn swap(&mut self, a: usize, b: usize) -> Option<[usize; 2]> {
        let faces = self.edge_faces(a, b);
        let ((f, k), (g, l)) = (faces.forth?, faces.back?);
        if !(self.active[f] && self.active[g])
            || self.is_seam(&faces)
            || self.frozen_line(a, b, &faces) != [false; 3]
        {
            return None;
        }
        let (c, d) = (self.mesh.faces[f][(k + 2) % 3], self.mesh.faces[g][(l + 2) % 3]);
        if c == d || self.joined(c, d) {
            return None;
        }
        let ((length, above), (same, below)) =
            (unfold::over_side(&self.mesh.rest[f], k), unfold::over_side(&self.mesh.rest[g], l));
        // a at the origin, b on the x axis; the other face is turned by half a turn.
        let length = 0.5 * (length + same);
        let (pa, pb, pc, pd) =
            (Vec2::zeros(), Vec2::new(length, 0.0), above, Vec2::new(length - below.x, -below.y));
        let least = FLATTEST * length * length;
        if (pd - pa).perp(&(pc - pa)) < least || (pb - pd).perp(&(pc - pd)) < least {
            return None;
        }
        let (old, new) = ([self.mesh.faces[f], self.mesh.faces[g]], [[a, d, c], [d, b, c]]);
        if new.iter().any(|face| self.would_freeze(face)) || !self.keeps_sides(&old, &new, true) {
            return None;
        }
        if let Some(uvs) = &mut self.mesh.uvs {
            let [ta, tb, tc, td] =
                [uvs[f][k], uvs[f][(k + 1) % 3], uvs[f][(k + 2) % 3], uvs[g][(l + 2) % 3]];
            let area = |p: Vec2, q: Vec2, r: Vec2| (q - p).perp(&(r - p));
            let old = [area(ta, tb, tc), area(tb, ta, td)];
            let new = [area(ta, td, tc), area(td, tb, tc)];
            if old.iter().any(|o| new.iter().any(|n| o * n < 0.0)) {
                return None;
            }
            (uvs[f], uvs[g]) = ([ta, td, tc], [td, tb, tc]);
        }
        self.mesh.rest[f] = unfold::metric([pa, pd, pc]);
        self.mesh.rest[g] = unfold::metric([pd, pb, pc]);
        [self.mesh.faces[f], self.mesh.faces[g]] = new;
        (self.changed[f], self.changed[g]) = (true, true);
        self.detach(f, b);
        self.detach(g, a);
        self.around[d].push(f);
        self.around[c].push(g);
        Some([c.min(d), c.max(d)])
    }
}
