//! Loads on a shell: its weight, the pressure inside it, and forces on some of its vertices.

use crate::mesh::Vec3;

/// Loads on a shell. The default is none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Loads {
    /// Density of the material (kg/m³); weight is density · thickness · rest area · gravity.
    pub density_kg_m3: f64,
    /// Acceleration of gravity (m/s²), usually (0, 0, −9.81).
    pub gravity_m_s2: Vec3,
    /// Pressure inside a closed surface, above that outside (Pa).
    pub pressure_pa: f64,
    /// Vertices and the dead forces on them (N).
    pub forces_newton: Vec<(usize, Vec3)>,
}
