//! A surface that is to grow: all that is asked of it, and whether that can be.

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

/// A surface that is to grow, and what it has to put up with.
#[derive(Clone, Debug)]
pub struct Growing<'a> {
    /// Connectivity.
    pub topology: &'a Topology,
    /// `[F]` rest metric before growth.
    pub rest: &'a RestMetric,
    /// `[V]` the starting surface (m), smooth, over which the folds lie.
    pub start: &'a [Vec3],
    /// `[V]` places (m) from which imperfections are drawn: the starting surface, or its rest
    /// shape, so that they move with it.
    pub places: Vec<Vec3>,
    /// How each vertex grows, and folds while it does.
    pub maps: GrowthMaps,
    /// What pushes.
    pub loads: Loads,
    /// Bodies that no vertex enters.
    pub obstacles: &'a [Obstacle],
    /// Distance (m) from an obstacle within which it pushes back.
    pub contact_thickness_m: f64,
    /// Whether folds keep from passing through each other, about the film's thickness apart.
    pub self_contact: bool,
}

impl<'a> Growing<'a> {
    /// A free surface with the same λ and Λ (m) everywhere, without bias, sticking, loads or
    /// obstacles.
    pub fn new(
        topology: &'a Topology,
        rest: &'a RestMetric,
        start: &'a [Vec3],
        expansion: Expansion,
        wavelength_m: f64,
        coherence_m: f64,
    ) -> Self {
        Self::with(topology, rest, start, GrowthMaps::even(expansion, wavelength_m, coherence_m))
    }

    /// A surface with these maps, without loads or obstacles, kept from passing through itself.
    pub fn with(
        topology: &'a Topology,
        rest: &'a RestMetric,
        start: &'a [Vec3],
        maps: GrowthMaps,
    ) -> Self {
        Self {
            topology,
            rest,
            start,
            places: start.to_vec(),
            maps,
            loads: Loads::default(),
            obstacles: &[],
            contact_thickness_m: 1e-3,
            self_contact: true,
        }
    }

    /// Freezes all axes of the vertices for which `choose` (vertex, place in m) says so.
    pub fn freeze(&mut self, choose: impl Fn(usize, &Vec3) -> bool) {
        for (v, frozen) in self.maps.frozen.iter_mut().enumerate() {
            if choose(v, &self.start[v]) {
                *frozen = [true; 3];
            }
        }
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
            let ([most, least], [along, _]) = self.maps.expansion.vertices[v].principal();
            if most <= 1.0 + 1e-9 {
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

    /// Whether it can grow at all; [`super::grow`] asks this first.
    ///
    /// # Errors
    /// [`Error::Value`] naming the map and the vertex whose value cannot be used, or a face too large for its folds, or if all is frozen;
    /// [`Error::Mesh`] naming a vertex that starts in an obstacle, or two faces that cross.
    pub fn check(&self) -> Result<()> {
        self.check_start()?;
        self.check_painted()
    }

    /// Whether what is painted on the surface can be.
    pub(super) fn check_painted(&self) -> Result<()> {
        self.check_maps()?;
        for (f, face) in self.topology.faces.iter().enumerate() {
            let side_m = self.side_across_folds_m(f);
            let wavelength = face.iter().map(|&v| self.maps.wavelength_m[v]).sum::<f64>() / 3.0;
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

    /// Whether the starting surface crosses itself where it must not.
    pub(super) fn check_start(&self) -> Result<()> {
        if !self.self_contact {
            return Ok(());
        }
        if let Some(&[f, g]) = crossing_pairs(&self.topology.faces, self.start).first() {
            let message = format!(
                "faces {f} and {g} of the starting surface cross; part them, or set \
                 growth.self_contact = false"
            );
            return Err(Error::mesh("growth", message));
        }
        Ok(())
    }

    /// As [`Growing::check_painted`], but faces may be of any size.
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
