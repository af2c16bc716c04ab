//! Edge split: a new vertex in the middle of an edge.

use super::patch::Patch;
use super::{MidpointPlacement, unfold};
use crate::mesh::Vec3;

/// Most that a new vertex may lie beside the middle of its edge, as a share of the edge's length.
const MOST_SAGITTA: f64 = 0.3;

impl Patch {
    /// Splits the edge `a`–`b` in the middle; the new vertex is the last. The parts of a face keep
    /// its metric, and half of its area each; channels are the mean of both ends, so linear ones
    /// stay linear. None, and nothing happens, if the edge is not there or not all of its faces are
    /// active.
    ///
    /// The middle is frozen along the axes along which the edge is frozen as a whole.
    pub(super) fn split(&mut self, a: usize, b: usize) -> Option<usize> {
        let faces = self.edge_faces(a, b);
        if faces.iter().count() == 0 || faces.iter().any(|(f, _)| !self.active[f]) {
            return None;
        }
        let frozen = self.frozen_line(a, b, &faces);
        let m = self.around.len();
        let (position, start) = self.middle(a, b, &frozen);
        let mesh = &mut self.mesh;
        mesh.positions.push(position);
        mesh.start.push(start);
        mesh.channels.iter_mut().for_each(|channel| channel.push((channel[a] + channel[b]) * 0.5));
        mesh.frozen.push(frozen);
        self.around.push(Vec::new());
        self.living += 1;
        for (f, k) in faces.iter() {
            let (l, new) = ((k + 1) % 3, self.mesh.faces.len());
            let mesh = &mut self.mesh;
            let (face, flat) = (mesh.faces[f], unfold::corners(&mesh.rest[f]));
            let (mut first, mut second) = ((face, flat), (face, flat));
            (first.0[l], first.1[l]) = (m, (flat[k] + flat[l]) * 0.5);
            (second.0[k], second.1[k]) = (m, first.1[l]);
            mesh.faces[f] = first.0;
            mesh.rest[f] = unfold::metric(first.1);
            mesh.faces.push(second.0);
            mesh.rest.push(unfold::metric(second.1));
            if let Some(uvs) = &mut mesh.uvs {
                let uv = uvs[f];
                let middle = (uv[k] + uv[l]) * 0.5;
                let mut other = uv;
                (uvs[f][l], other[k]) = (middle, middle);
                uvs.push(other);
            }
            self.active.push(true);
            self.dead.push(false);
            self.changed.push(true);
            self.changed[f] = true;
            self.detach(f, face[l]);
            self.around[face[l]].push(new);
            self.around[face[(k + 2) % 3]].push(new);
            self.around[m].extend([f, new]);
        }
        Some(m)
    }

    /// Place of the middle of the edge `a`–`b` in the pose and at the start (m).
    fn middle(&self, a: usize, b: usize, frozen: &[bool; 3]) -> (Vec3, Vec3) {
        let mesh = &self.mesh;
        let mean = |places: &[Vec3]| (places[a] + places[b]) * 0.5;
        let (mut position, mut start) = (mean(&mesh.positions), mean(&mesh.start));
        if self.midpoints == MidpointPlacement::Flat {
            return (position, start);
        }
        let (folded, smooth) =
            (self.sagitta(a, b, &mesh.positions), self.sagitta(a, b, &mesh.start));
        // An edge that is not folded stays on the start, to the bit.
        let (round, beside) = if self.midpoints == MidpointPlacement::Start {
            (smooth, Vec3::zeros())
        } else {
            (Vec3::zeros(), smooth)
        };
        let by = start - position;
        start += round;
        position = if mesh.positions[a] == mesh.start[a] && mesh.positions[b] == mesh.start[b] {
            start
        } else {
            position + (folded - beside)
        };
        for axis in (0..3).filter(|&axis| frozen[axis]) {
            position[axis] = start[axis] - by[axis];
        }
        (position, start)
    }

    /// From the middle of the edge `a`–`b` to that of the cubic that leaves its ends perpendicular
    /// to their normals, as sides of curved point-normal triangles do ([Vlachos et al. 2001]). None
    /// where they look apart.
    fn sagitta(&self, a: usize, b: usize, places: &[Vec3]) -> Vec3 {
        let normal =
            |v: usize| self.normal_sum(v, places).try_normalize(0.0).unwrap_or_else(Vec3::zeros);
        let (n, m, edge) = (normal(a), normal(b), places[b] - places[a]);
        if n.dot(&m) <= 0.0 {
            return Vec3::zeros();
        }
        let beside = (m * edge.dot(&m) - n * edge.dot(&n)) / 8.0;
        let most = MOST_SAGITTA * edge.norm();
        beside * (most / beside.norm().max(most))
    }
}
