//! Clamps, loads and forces.

use serde::Deserialize;

/// `[[clamp]]`: vertices that are held; exactly one of `side`, `near_m` and `within_m` says which.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ClampTable {
    /// A side, as "panel.side".
    pub side: Option<String>,
    /// The vertex that starts nearest to this point (m).
    pub near_m: Option<[f64; 3]>,
    /// All vertices that start in this box.
    pub within_m: Option<BoxTable>,
    /// The coordinates that are held: letters of "xyz".
    #[serde(default = "xyz")]
    pub axes: String,
    /// By how much it is moved from its start pose (m), after the turn.
    #[serde(default)]
    pub move_m: [f64; 3],
    /// Rotation from the start pose.
    pub turn: Option<TurnTable>,
}

fn xyz() -> String {
    "xyz".to_owned()
}

/// `turn` of a clamp: a rotation, counter-clockwise seen against the axis.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TurnTable {
    /// Direction of the axis (any length but 0).
    pub axis: [f64; 3],
    /// Angle (degrees).
    pub angle_deg: f64,
    /// A point on the axis (m).
    #[serde(default)]
    pub centre_m: [f64; 3],
}

/// `within_m` of a clamp or a force: a box along the axes.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BoxTable {
    /// Its lowest x, y and z (m).
    pub low: [f64; 3],
    /// Its highest (m).
    pub high: [f64; 3],
}

/// `[load]`: see [`crate::shell::Loads`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LoadTable {
    /// Acceleration of gravity (m/s²).
    pub gravity_m_s2: [f64; 3],
    /// Pressure inside a closed surface, above that outside (Pa).
    pub pressure_pa: f64,
}

/// `[[force]]`: a force spread over vertices; exactly one of `side`, `near_m` and `within_m` says
/// over which.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ForceTable {
    /// A side, as "panel.side"; the force is spread by rest length.
    pub side: Option<String>,
    /// The vertex that starts nearest to this point (m).
    pub near_m: Option<[f64; 3]>,
    /// All vertices that start in this box, evenly.
    pub within_m: Option<BoxTable>,
    /// The force on all of them together (N).
    pub newton: [f64; 3],
}
