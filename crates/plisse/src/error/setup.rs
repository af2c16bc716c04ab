//! Faults of a sheet with what holds it, pushes it and is in its way.

/// A fault of a sheet's setup, for which there is no equilibrium.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SetupError {
    /// Nothing holds the surface along an axis, along which it could drift away.
    #[error(
        "nothing holds the surface along {}; clamp at least one vertex in that direction",
        ["x", "y", "z"][*axis]
    )]
    Unheld {
        /// The axis: 0 for x, 1 for y, 2 for z.
        axis: usize,
    },
    /// Pressure acts on a surface that encloses nothing.
    #[error(
        "the surface is open between vertices {} and {}; close it, or remove the pressure",
        edge[0],
        edge[1]
    )]
    OpenUnderPressure {
        /// The two vertices of a boundary edge.
        edge: [usize; 2],
    },
    /// The sheet is thicker than it is wide.
    #[error(
        "a sheet {thickness_m} m thick is thicker than the surface is wide ({width_m:.3e} m); are \
         all lengths in metres?"
    )]
    NotThin {
        /// Thickness (m).
        thickness_m: f64,
        /// Side of a square of the surface's area (m).
        width_m: f64,
    },
}

impl SetupError {
    /// The part of the setup that is at fault: the place of its [`Error`](crate::Error).
    pub fn part(&self) -> &'static str {
        match self {
            Self::Unheld { .. } => "clamps",
            Self::OpenUnderPressure { .. } => "pressure",
            Self::NotThin { .. } => "thickness",
        }
    }
}
