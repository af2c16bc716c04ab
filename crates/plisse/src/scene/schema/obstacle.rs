//! Obstacles, and how close the surface may come to them.

use std::path::PathBuf;

use serde::Deserialize;

/// `[contact]`: how the surface keeps off obstacles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ContactTable {
    /// Distance below which contact pushes back (m); none: a thousandth of the diagonal of the
    /// start pose.
    pub thickness_m: Option<f64>,
}

/// `[[obstacle]]`: a body that the surface may not enter.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObstacleTable {
    /// Its name, for messages.
    pub name: String,
    /// The kind; it decides which of the fields below must be given.
    pub kind: ObstacleKind,
    /// A point on a plane (m).
    pub point_m: Option<[f64; 3]>,
    /// Direction of a plane's free side (any length but 0).
    pub normal: Option<[f64; 3]>,
    /// Centre of a sphere, an ellipsoid or a torus (m).
    pub centre_m: Option<[f64; 3]>,
    /// Radius of a sphere, of a capsule at its start, or of the circle along a torus (m).
    pub radius_m: Option<f64>,
    /// Start of a capsule's axis (m).
    pub from_m: Option<[f64; 3]>,
    /// End of a capsule's axis (m).
    pub to_m: Option<[f64; 3]>,
    /// Radius of a capsule at its end (m); none: that at its start.
    pub end_radius_m: Option<f64>,
    /// Radii of an ellipsoid along x, y and z before its turn (m).
    pub radii_m: Option<[f64; 3]>,
    /// Rotation of an ellipsoid about its centre.
    pub turn: Option<TiltTable>,
    /// Axis of a torus (any length but 0).
    pub axis: Option<[f64; 3]>,
    /// Radius of its tube (m).
    pub tube_radius_m: Option<f64>,
    /// OBJ file of a closed mesh, relative to the scene file.
    pub file: Option<PathBuf>,
    /// Length of one unit of the file's coordinates (m); none: 1.
    pub metres_per_unit: Option<f64>,
}

/// The kind of an obstacle; see [`crate::obstacle::Obstacle`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ObstacleKind {
    /// Needs `point_m` and `normal`.
    Plane,
    /// Needs `centre_m` and `radius_m`.
    Sphere,
    /// Needs `from_m`, `to_m` and `radius_m`.
    Capsule,
    /// Needs `centre_m` and `radii_m`.
    Ellipsoid,
    /// Needs `centre_m`, `axis`, `radius_m` and `tube_radius_m`.
    Torus,
    /// Needs `file`.
    Mesh,
}

/// `turn` of an obstacle: a rotation about its centre, counter-clockwise seen against the axis.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TiltTable {
    /// Direction of the axis (any length but 0).
    pub axis: [f64; 3],
    /// Angle (degrees).
    pub angle_deg: f64,
}
