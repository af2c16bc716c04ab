//! An edge split in its middle.

use super::laid;
use super::patch::Patch;

impl Patch {
    /// Splits the edge `a`–`b` in the middle; the new vertex is the last. The parts of a face keep its metric, and half of its area each;
    /// what vertices carry is the mean of both ends, so what is linear stays linear. None, and nothing happens, if the edge
    /// is not there or not all of its faces are active.
    ///
    /// The middle is frozen along the axes along which the edge is frozen as a whole.
    pub(super) fn split(&mut self, a: usize, b: usize) -> Option<usize> {
        let faces = self.edge_faces(a, b);
        if faces.iter().count() == 0 || faces.iter().any(|(f, _)| !self.active[f]) {
            return None;
        }
        let frozen = self.frozen_line(a, b, &faces);
        let m = self.around.len();
        let sheet = &mut self.sheet;
        sheet.positions.push((sheet.positions[a] + sheet.positions[b]) * 0.5);
        sheet.start.push((sheet.start[a] + sheet.start[b]) * 0.5);
        sheet.channels.iter_mut().for_each(|channel| channel.push((channel[a] + channel[b]) * 0.5));
        sheet.frozen.push(frozen);
        self.around.push(Vec::new());
        self.living += 1;
        for (f, k) in faces.iter() {
            let (l, new) = ((k + 1) % 3, self.sheet.faces.len());
            let sheet = &mut self.sheet;
            let (face, flat) = (sheet.faces[f], laid::corners(&sheet.rest[f]));
            let (mut first, mut second) = ((face, flat), (face, flat));
            (first.0[l], first.1[l]) = (m, (flat[k] + flat[l]) * 0.5);
            (second.0[k], second.1[k]) = (m, first.1[l]);
            sheet.faces[f] = first.0;
            sheet.rest[f] = laid::metric(first.1);
            sheet.faces.push(second.0);
            sheet.rest.push(laid::metric(second.1));
            if let Some(uvs) = &mut sheet.uvs {
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
}
