//! The surface as a scene describes it, placed into space, before anything holds it: from panels or
//! from a mesh.

use std::ops::Range;

use super::schema::Scene;
use crate::mesh::{Chart, RestShape, Topology, Vec2, Vec3};
use crate::{At, Error, Result};

/// A part whose volume is less than this, relative to the cube of its size, has no inside.
const LEAST_VOLUME: f64 = 1e-9;

/// The part of the surface that is one panel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlacedPanel {
    /// Its name.
    pub name: String,
    /// Its faces.
    pub faces: Range<usize>,
    /// Its rest vertices.
    pub rest_vertices: Range<usize>,
}

/// A surface at its start. V vertices, F faces, R rest vertices.
pub(super) struct PlacedSurface {
    /// Connectivity.
    pub(super) topology: Topology,
    /// The rest shape.
    pub(super) rest_shape: RestShape,
    /// `[V]` start pose (m).
    pub(super) start: Vec<Vec3>,
    /// `[R]` vertex for each rest vertex of panels; empty for a mesh.
    pub(super) vertex_of_rest: Vec<usize>,
    /// The panels; none for a mesh.
    pub(super) panels: Vec<PlacedPanel>,
    /// `[panels]` the sides of each.
    pub(super) sides: Vec<Vec<Side>>,
    /// Panel coordinates (m), where they are not those of the rest vertices: if some panel is
    /// closed.
    pub(super) chart: Option<Chart>,
    /// Texture coordinates, if a file gave them or some panel is closed.
    pub(super) texture: Option<Chart>,
    /// Names and values (`[V]`) of what a file says about each vertex.
    pub(super) attributes: Vec<(String, Vec<f64>)>,
    /// Notes of the readers of files on what they skipped or fixed.
    pub(super) notes: Vec<String>,
}

/// A side of a panel.
pub(super) struct Side {
    pub(super) name: String,
    /// Rest vertices in order; each once if it is closed.
    pub(super) rest_vertices: Vec<usize>,
    pub(super) closed: bool,
}

impl PlacedSurface {
    /// `[3]` panel coordinates (m) of the corners of face `f`.
    pub(super) fn panel_corners(&self, f: usize) -> [Vec2; 3] {
        match &self.chart {
            Some(chart) => chart.corners(f),
            None => self.rest_shape.corners(f).map(|p| p.xy()),
        }
    }

    /// The side that `reference`, "panel.side", names.
    pub(super) fn side(&self, scene: &Scene, field: &str, reference: &str) -> Result<&Side> {
        let (p, name) = scene.side(field, reference)?;
        let found = self.sides.get(p).and_then(|sides| sides.iter().find(|side| side.name == name));
        found.ok_or_else(|| {
            Error::value(field, format!("panel {p} has no side \"{name}\"; name another one"))
        })
    }

    /// Lowest and highest coordinates of the start pose (m).
    pub(super) fn extent(&self) -> [Vec3; 2] {
        extent(&self.start)
    }

    /// Diagonal of the start pose's bounding box (m).
    pub(super) fn size(&self) -> f64 {
        let [low, high] = self.extent();
        (high - low).norm()
    }

    /// `[V]` lowest vertex of the connected part that each vertex belongs to.
    pub(super) fn parts(&self) -> Vec<usize> {
        let neighbours = self.topology.vertex_neighbours();
        let mut part = vec![usize::MAX; self.topology.vertex_count];
        for lowest in 0..part.len() {
            if part[lowest] != usize::MAX {
                continue;
            }
            part[lowest] = lowest;
            let mut stack = vec![lowest];
            while let Some(v) = stack.pop() {
                for &u in neighbours[v].iter().filter(|&&u| u > lowest) {
                    if part[u] == usize::MAX {
                        part[u] = lowest;
                        stack.push(u);
                    }
                }
            }
        }
        part
    }

    /// Name of the part whose lowest vertex is `lowest`, and the vertices to clamp in it.
    pub(super) fn name_of_part(&self, lowest: usize) -> (String, &'static str) {
        let rest = self.vertex_of_rest.iter().position(|&v| v == lowest);
        let panel =
            rest.and_then(|r| self.panels.iter().find(|panel| panel.rest_vertices.contains(&r)));
        match panel {
            Some(panel)
                if self
                    .panels
                    .iter()
                    .zip(&self.sides)
                    .any(|(p, sides)| p.name == panel.name && sides.is_empty()) =>
            {
                (format!("panel \"{}\"", panel.name), "some of its vertices")
            }
            Some(panel) => {
                (format!("panel \"{}\" (or what it is sewn to)", panel.name), "one of its sides")
            }
            None if lowest == 0 => {
                ("the mesh (or its first part)".to_owned(), "some of its vertices")
            }
            None => (
                format!("the part of the mesh around {}", shown(self.start[lowest])),
                "some of its vertices",
            ),
        }
    }

    /// Refuses a surface with a border, which holds no pressure.
    pub(super) fn check_closed(&self) -> Result<()> {
        let Some(e) = (0..self.topology.edge_count()).find(|&e| self.topology.is_boundary_edge(e))
        else {
            return Ok(());
        };
        let f = self.topology.edge_faces[e][0];
        let k = (0..3).find(|&k| self.topology.face_edges[f][k] == e).unwrap_or(0);
        let ends = [self.rest_shape.faces[f][k], self.rest_shape.faces[f][(k + 1) % 3]];
        let runs_there = |side: &Side| {
            let next = side.rest_vertices.iter().cycle().skip(1);
            side.rest_vertices.iter().zip(next).any(|(&r, &s)| ends == [r, s] || ends == [s, r])
        };
        for (panel, sides) in self.panels.iter().zip(&self.sides) {
            if let Some(side) = sides.iter().find(|side| runs_there(side)) {
                let message = format!(
                    "the surface is open at side \"{}.{}\"; sew every side or remove the pressure",
                    panel.name, side.name
                );
                return Err(Error::value("load.pressure_pa", message));
            }
        }
        let [i, j] = self.topology.edges[e];
        let middle = 0.5 * (self.start[i] + self.start[j]);
        Err(Error::value(
            "load.pressure_pa",
            format!(
                "the surface is open near {}; close the mesh or remove the pressure",
                shown(middle)
            ),
        ))
    }

    /// Turns the faces of every closed part that would be inside out, so that pressure is on its
    /// inside. A part that starts flat, such as a pillow before it is inflated, stays as it is.
    pub(super) fn turn_outside_out(&mut self, place: &str) -> Result<()> {
        let part = self.parts();
        let mut volume_m3 = vec![0.0; self.topology.vertex_count];
        for face in &self.topology.faces {
            let lowest = part[face[0]];
            let [a, b, c] = face.map(|v| self.start[v] - self.start[lowest]);
            volume_m3[lowest] += a.dot(&b.cross(&c)) / 6.0;
        }
        let least = -LEAST_VOLUME * self.size().powi(3);
        let turned: Vec<usize> = (0..self.topology.face_count())
            .filter(|&f| volume_m3[part[self.topology.faces[f][0]]] < least)
            .collect();
        if turned.is_empty() {
            return Ok(());
        }
        let mut faces = self.topology.faces.clone();
        for f in turned {
            faces[f].swap(1, 2);
            self.rest_shape.faces[f].swap(1, 2);
            for chart in self.texture.iter_mut().chain(&mut self.chart) {
                chart.faces[f].swap(1, 2);
            }
        }
        self.topology = Topology::new(self.topology.vertex_count, faces).at(place)?;
        Ok(())
    }
}

/// Lowest and highest coordinates (m) of at least one position.
pub(super) fn extent(positions: &[Vec3]) -> [Vec3; 2] {
    positions.iter().fold([positions[0]; 2], |[low, high], p| [low.inf(p), high.sup(p)])
}

/// A point as a scene file writes it.
pub(super) fn shown(p: Vec3) -> String {
    format!("[{:.6}, {:.6}, {:.6}]", p.x, p.y, p.z)
}
