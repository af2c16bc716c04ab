//! A thin sheet and everything that acts on it from outside.

use super::loads::Loads;
use crate::Result;
use crate::error::SetupError;
use crate::mesh::{NONE, Vec3};
use crate::obstacle::Obstacle;
use crate::sheet::Sheet;

/// Clamps of a surface: for each vertex and axis a target position (m), or none.
#[derive(Clone, Debug, PartialEq)]
pub struct Clamps {
    /// `[V][3]` target of each coordinate (m), `None` where it is free.
    pub targets: Vec<[Option<f64>; 3]>,
}

impl Clamps {
    /// No clamps on `vertex_count` vertices.
    pub fn none(vertex_count: usize) -> Self {
        Self { targets: vec![[None; 3]; vertex_count] }
    }

    /// Holds all coordinates of vertex `v` at `position` (m).
    pub fn hold(&mut self, v: usize, position: Vec3) {
        self.targets[v] = [Some(position.x), Some(position.y), Some(position.z)];
    }

    /// `[V][3]` numbers of the free coordinates, vertex by vertex, [`NONE`] for held ones; and
    /// their count.
    pub(crate) fn free_coordinates(&self) -> (Vec<[usize; 3]>, usize) {
        let mut count = 0;
        let mut number = |target: Option<f64>| {
            if target.is_some() {
                return NONE;
            }
            count += 1;
            count - 1
        };
        let numbers = self.targets.iter().map(|target| target.map(&mut number)).collect();
        (numbers, count)
    }

    /// `[V]` true for vertices of which any coordinate is held.
    pub fn held(&self) -> Vec<bool> {
        self.targets.iter().map(|t| t.iter().any(Option::is_some)).collect()
    }
}

/// A thin sheet with its clamps, its loads, and the obstacles that it may not enter.
#[derive(Clone, Debug)]
pub struct Setup<'a> {
    /// The sheet.
    pub sheet: &'a Sheet,
    /// Targets of the held coordinates.
    pub clamps: &'a Clamps,
    /// Loads.
    pub loads: Loads,
    /// Bodies that no vertex enters.
    pub obstacles: &'a [Obstacle],
    /// Distance (m) from an obstacle within which it pushes back; > 0.
    pub contact_thickness_m: f64,
    /// Pressure (Pa), beyond that of the loads, with which the sheet may be driven against
    /// obstacles.
    pub contact_pressure_pa: f64,
}

impl<'a> Setup<'a> {
    /// A sheet that is only held: no loads, no obstacles.
    pub fn new(sheet: &'a Sheet, clamps: &'a Clamps) -> Self {
        Self {
            sheet,
            clamps,
            loads: Loads::default(),
            obstacles: &[],
            contact_thickness_m: 1e-3,
            contact_pressure_pa: 0.0,
        }
    }

    /// Size of the sheet (m): side of a square of its rest area.
    pub fn length_m(&self) -> f64 {
        self.sheet.rest.area_m2().sqrt()
    }

    /// `[V]` rest area (m²) that belongs to each vertex: a third of its faces'.
    pub fn vertex_area_m2(&self) -> Vec<f64> {
        let mut area = vec![0.0; self.sheet.topology.vertex_count];
        for (face, rest) in self.sheet.topology.faces.iter().zip(&self.sheet.rest.faces) {
            for &v in face {
                area[v] += rest.area_m2 / 3.0;
            }
        }
        area
    }

    /// `[V]` forces (N) that do not depend on the pose: weight and point forces.
    pub fn dead_forces_newton(&self) -> Vec<Vec3> {
        let weight =
            self.loads.gravity_m_s2 * (self.loads.density_kg_m3 * self.sheet.material.thickness_m);
        let mut forces: Vec<Vec3> =
            self.vertex_area_m2().into_iter().map(|area| weight * area).collect();
        for &(v, force) in &self.loads.forces_newton {
            forces[v] += force;
        }
        forces
    }

    /// True if nothing but pressure and stiffness acts, so that rigid motions cost nothing.
    pub(super) fn floats(&self) -> bool {
        self.obstacles.is_empty()
            && self.clamps.targets.iter().flatten().all(Option::is_none)
            && self.dead_forces_newton().iter().all(|f| *f == Vec3::zeros())
    }

    /// All checks that the solvers need.
    ///
    /// # Errors
    /// [`SetupError`] if the sheet is not thin, pressure acts on an open surface, or nothing holds
    /// it against drifting away.
    pub(super) fn check(&self) -> Result<()> {
        self.sheet.material.check_thin(self.sheet.rest.area_m2())?;
        if self.loads.pressure_pa != 0.0
            && let Some(edge) = self
                .sheet
                .topology
                .edge_faces
                .iter()
                .position(|faces| faces[1] == crate::adjacency::NONE)
        {
            let edge = self.sheet.topology.edges[edge];
            return Err(SetupError::OpenUnderPressure { edge }.into());
        }
        let net: Vec3 = self.dead_forces_newton().iter().sum();
        let idle = self.loads.pressure_pa == 0.0
            && self.dead_forces_newton().iter().all(|f| *f == Vec3::zeros());
        for axis in 0..3 {
            let pushed = net[axis] != 0.0 && self.obstacles.is_empty();
            if self.clamps.targets.iter().all(|t| t[axis].is_none()) && (idle || pushed) {
                return Err(SetupError::Unheld { axis }.into());
            }
        }
        Ok(())
    }
}
