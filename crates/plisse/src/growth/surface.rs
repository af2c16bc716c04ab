//! Growing surface: mesh, rest metric, growth maps and everything that acts on it.

use std::sync::Arc;

use super::expansion::Expansion;
use super::maps::GrowthMaps;
use crate::mesh::crossing::crossing_pairs;
use crate::mesh::{Topology, Vec3};
use crate::obstacle::Obstacle;
use crate::rest::RestMetric;
use crate::shell::Loads;
use crate::{Error, Result};

/// Fewest edges that must fit into a wavelength.
const LEAST_EDGES: f64 = 3.5;

/// Growth factor (length) up to which a vertex counts as one that does not grow.
const NO_GROWTH: f64 = 1.0 + 1e-9;

/// A surface that is to grow.
#[derive(Clone, Debug)]
pub struct GrowingSurface {
    /// Connectivity.
    pub topology: Topology,
    /// `[F]` rest metric before growth.
    pub rest: RestMetric,
    /// `[V]` the starting surface (m), smooth, over which the folds lie.
    pub start: Vec<Vec3>,
    /// `[V]` places (m) from which imperfections are drawn: the starting surface, or its rest
    /// shape, so that they move with it.
    pub places: Vec<Vec3>,
    /// Growth, and the properties of folds, at each vertex.
    pub maps: GrowthMaps,
    /// Loads.
    pub loads: Loads,
    /// Bodies that no vertex enters.
    pub obstacles: Arc<[Obstacle]>,
    /// Distance (m) from an obstacle within which it pushes back.
    pub contact_thickness_m: f64,
    /// True if folds are kept from passing through each other, about the film's thickness apart.
    pub self_contact: bool,
}

impl GrowingSurface {
    /// A surface that starts at `start` (`[V]`, m), without loads or obstacles, kept from passing
    /// through itself.
    pub fn new(topology: Topology, rest: RestMetric, start: Vec<Vec3>, maps: GrowthMaps) -> Self {
        Self {
            topology,
            rest,
            places: start.clone(),
            start,
            maps,
            loads: Loads::default(),
            obstacles: Arc::new([]),
            contact_thickness_m: 1e-3,
            self_contact: true,
        }
    }

    /// Freezes all axes of the vertices that `choose` (vertex, place in m) selects.
    pub fn freeze(&mut self, choose: impl Fn(usize, &Vec3) -> bool) {
        for (v, at) in self.maps.vertices.iter_mut().enumerate() {
            if choose(v, &self.start[v]) {
                at.frozen = [true; 3];
            }
        }
    }

    /// `[F]` the rest metric grown by `expansion`.
    ///
    /// # Errors
    /// As [`Expansion::act_on`].
    pub fn grown_by(&self, expansion: &Expansion) -> Result<RestMetric> {
        expansion.act_on(&self.topology, &self.start, &self.rest)
    }

    /// `[F]` the rest metric that is asked for: all of the growth.
    ///
    /// # Errors
    /// As [`Expansion::act_on`].
    pub fn asked(&self) -> Result<RestMetric> {
        self.grown_by(&self.maps.expansion())
    }

    /// Wavelength λ (m) of a face: the mean over its corners.
    pub(super) fn face_wavelength_m(&self, face: &[usize; 3]) -> f64 {
        face.iter().map(|&v| self.maps.vertices[v].wavelength_m).sum::<f64>() / 3.0
    }

    /// Mean length (m) of the edges of the starting surface.
    pub(super) fn mean_edge_m(&self) -> f64 {
        let lengths: f64 =
            self.topology.edges.iter().map(|&[i, j]| (self.start[j] - self.start[i]).norm()).sum();
        lengths / self.topology.edge_count() as f64
    }

    /// Longest extent (m) of a side of face `f` across the folds that it will have; 0 where nothing
    /// grows.
    fn side_across_folds_m(&self, f: usize) -> f64 {
        let face = self.topology.faces[f];
        let across = |v: usize, side: &Vec3| {
            let ([most, least], [along, _]) = self.maps.vertices[v].growth.principal();
            if most <= NO_GROWTH {
                return 0.0;
            }
            // Where it grows all ways alike, folds may run any way.
            let even = (least.ln() / most.ln()).clamp(0.0, 1.0);
            let part = side.dot(&along).powi(2);
            (part + even * (side.norm_squared() - part)).sqrt()
        };
        let side = |k: usize| self.start[face[(k + 1) % 3]] - self.start[face[k]];
        (0..9).map(|n| across(face[n / 3], &side(n % 3))).fold(0.0, f64::max)
    }

    /// Checks that the surface can grow; [`super::grow`] asks this first.
    ///
    /// # Errors
    /// [`Error::Value`] naming the map and the vertex whose value cannot be used, or a face too
    /// large for its folds, or if everything is frozen; [`Error::Mesh`] naming a vertex that starts
    /// in an obstacle, or two faces that cross.
    pub fn check(&self) -> Result<()> {
        self.check_start()?;
        self.check_resolution()
    }

    /// As [`GrowingSurface::check_maps`]; also checks that faces are small enough for their folds.
    pub(super) fn check_resolution(&self) -> Result<()> {
        self.check_maps()?;
        for (f, face) in self.topology.faces.iter().enumerate() {
            let side_m = self.side_across_folds_m(f);
            let wavelength = self.face_wavelength_m(face);
            if wavelength < LEAST_EDGES * side_m {
                let message = format!(
                    "folds {wavelength:.3e} m apart need edges of {:.3e} m or less across them, \
                     but face {f} has one of {side_m:.3e} m; refine the mesh or ask for wider \
                     folds",
                    wavelength / LEAST_EDGES
                );
                return Err(Error::value("growth.wavelength_m", message));
            }
        }
        Ok(())
    }

    /// Checks that the starting surface does not cross itself where it must not.
    pub(super) fn check_start(&self) -> Result<()> {
        if !self.self_contact {
            return Ok(());
        }
        if let Some(&[f, g]) = crossing_pairs(&self.topology.faces, &self.start).first() {
            let message = format!(
                "faces {f} and {g} of the starting surface cross; part them, or set \
                 growth.self_contact = false"
            );
            return Err(Error::mesh("growth", message));
        }
        Ok(())
    }

    /// Checks the maps, and that no vertex starts in an obstacle.
    pub(super) fn check_maps(&self) -> Result<()> {
        let n = self.topology.vertex_count;
        self.maps.check(n)?;
        if let Some(v) =
            (0..n).find(|&v| self.obstacles.iter().any(|o| o.distance_m(&self.start[v]) <= 0.0))
        {
            return Err(Error::mesh(
                "growth",
                format!("vertex {v} of the starting surface is inside an obstacle; move it out"),
            ));
        }
        Ok(())
    }
}
