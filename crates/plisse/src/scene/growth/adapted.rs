//! `[growth.remesh]`: the scene on the mesh that followed its folds.

use std::collections::BTreeMap;

use super::build::BuiltGrowth;
use super::windows;
use crate::growth::GrownSurface;
use crate::mesh::islands::side_by_side;
use crate::mesh::{Chart, RestShape};
use crate::mesh::{Topology, Vec2, Vec3};
use crate::rest::RestMetric;
use crate::scene::build::BuiltScene;
use crate::scene::placed::{PlacedPanel, PlacedSurface};
use crate::sheet::Sheet;
use crate::shell::Clamps;
use crate::{At, Result};

impl BuiltGrowth {
    /// `[F][3]` what faces carry through remeshing, for [`crate::growth::follow_adapting`]: places
    /// (m) in the panels, each panel apart from the others, or else texture places; none for a mesh
    /// that has neither.
    pub fn chart(&self) -> Option<Vec<[Vec2; 3]>> {
        let built = &self.built;
        let Some((_, apart)) = self.plane() else {
            let texture = built.texture.as_ref()?;
            return Some((0..texture.faces.len()).map(|f| texture.corners(f)).collect());
        };
        let mut chart: Vec<[Vec2; 3]> = self.panel_places().collect();
        for (p, panel) in built.panels.iter().enumerate() {
            chart[panel.faces.clone()]
                .iter_mut()
                .flatten()
                .for_each(|place| place.x += p as f64 * apart);
        }
        Some(chart)
    }

    /// Panel coordinates (m) of the corners of every face.
    fn panel_places(&self) -> impl Iterator<Item = [Vec2; 3]> {
        let built = &self.built;
        (0..built.sheet.rest_shape.faces.len()).map(|f| match &self.chart {
            Some(chart) => chart.corners(f),
            None => built.sheet.rest_shape.corners(f).map(|p| p.xy()),
        })
    }

    /// Middle (m) along x of all panels, each from its own origin, and how far apart (m) the chart
    /// lays them; none for a mesh that came with a texture or is not flat.
    fn plane(&self) -> Option<(f64, f64)> {
        if self.chart.is_none() {
            let places = &self.built.sheet.rest_shape.positions;
            let first = *places.first()?;
            let (low, high) =
                places.iter().fold((first, first), |(low, high), p| (low.inf(p), high.sup(p)));
            let size = high - low;
            if self.built.texture.is_some() || size.z > 1e-9 * size.x.max(size.y) {
                return None;
            }
        }
        let along = self.panel_places().flatten().map(|p| p.x);
        let (low, high) = along
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        // A power of two, so that little is lost by adding it.
        (high > low).then(|| (0.5 * (low + high), (4.0 * (high - low)).log2().ceil().exp2()))
    }

    /// This scene on the mesh of `surface`, which has grown from it with [`BuiltGrowth::chart`];
    /// the pose (`[V]`, m) and the rest metric that was asked. Faces are in the order of the panels
    /// again.
    ///
    /// # Errors
    /// [`crate::Error::Mesh`] if the surface is none; [`crate::Error::Value`] if a window in which
    /// folds are counted reaches beyond it.
    pub fn on(&self, grown: GrownSurface) -> Result<(Self, Vec<Vec3>, RestMetric)> {
        let GrownSurface { surface, pose, uvs } = grown;
        let corner_places = uvs.as_deref();
        let by_panel = self.plane().filter(|_| !self.built.panels.is_empty());
        let panel_of = |f: usize| match (by_panel, corner_places) {
            (Some((middle, apart)), Some(places)) => {
                let x = places[f].iter().map(|p| p.x).sum::<f64>() / 3.0;
                ((x - middle) / apart).round().max(0.0) as usize
            }
            _ => 0,
        };
        let mut order: Vec<usize> = (0..surface.topology.face_count()).collect();
        order.sort_by_key(|&f| panel_of(f));
        let faces = order.iter().map(|&f| surface.topology.faces[f]).collect();
        let topology = Topology::new(surface.topology.vertex_count, faces).at("remeshing")?;
        let rest = RestMetric { faces: order.iter().map(|&f| surface.rest.faces[f]).collect() };
        let asked = surface.maps.expansion().act_on(&topology, &surface.start, &rest)?;

        let mut panels: Vec<PlacedPanel> = self
            .built
            .panels
            .iter()
            .map(|panel| PlacedPanel { name: panel.name.clone(), faces: 0..0, rest_vertices: 0..0 })
            .collect();
        let (mut places, mut corners) = (Vec::new(), Vec::new());
        if let Some(corner_places) = corner_places {
            let mut known = BTreeMap::new();
            for (n, &f) in order.iter().enumerate() {
                let panel = panel_of(f);
                let shift = by_panel.map_or(0.0, |(_, apart)| panel as f64 * apart);
                corners.push([0, 1, 2].map(|k| {
                    let place = corner_places[f][k];
                    *known
                        .entry((
                            panel,
                            surface.topology.faces[f][k],
                            place.x.to_bits(),
                            place.y.to_bits(),
                        ))
                        .or_insert_with(|| {
                            places.push(Vec2::new(place.x - shift, place.y));
                            places.len() - 1
                        })
                }));
                if let Some(panel) = panels.get_mut(panel) {
                    panel.faces =
                        (if panel.faces.is_empty() { n } else { panel.faces.start })..n + 1;
                    let first = if panel.rest_vertices.is_empty() {
                        corners[n].into_iter().min().unwrap_or(0)
                    } else {
                        panel.rest_vertices.start
                    };
                    panel.rest_vertices = first..places.len();
                }
            }
        }
        let mut chart = None;
        let (rest_positions, rest_faces, texture) = if corners.is_empty() || by_panel.is_none() {
            let texture = (self.built.texture.is_some() && !corners.is_empty())
                .then_some(Chart { points: places, faces: corners });
            (surface.start.clone(), topology.faces.clone(), texture)
        } else if self.chart.is_some() {
            let points = side_by_side(&places, &corners);
            let texture = Chart { points, faces: corners.clone() };
            chart = Some(Chart { points: places, faces: corners });
            (surface.start.clone(), topology.faces.clone(), Some(texture))
        } else {
            (places.iter().map(|p| Vec3::new(p.x, p.y, 0.0)).collect(), corners, None)
        };
        let placed = PlacedSurface {
            topology,
            rest_shape: RestShape { positions: rest_positions, faces: rest_faces },
            start: surface.start,
            vertex_of_rest: Vec::new(),
            panels,
            sides: Vec::new(),
            texture,
            chart,
            attributes: Vec::new(),
            notes: Vec::new(),
        };
        let windows = windows::windows(&self.counts, &self.extents, &placed)?;
        let built = BuiltScene {
            clamps: Clamps::none(placed.topology.vertex_count),
            sheet: Sheet {
                topology: placed.topology,
                rest_shape: placed.rest_shape,
                rest,
                material: self.built.sheet.material,
            },
            start: placed.start,
            loads: surface.loads,
            panels: placed.panels,
            texture: placed.texture,
            ..self.built.clone()
        };
        let grown =
            Self { built, maps: surface.maps, chart: placed.chart, windows, ..self.clone() };
        Ok((grown, pose, asked))
    }
}
