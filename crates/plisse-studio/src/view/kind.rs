//! The views of the menu, and the legend of their colours.

use super::colours::Scale;
use crate::document::Layer;

/// The quantity that a picture shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum View {
    /// The wrinkled surface in its light.
    Wrinkled,
    /// The mesh that is simulated.
    Wireframe,
    /// Strain of the pose against the rest shape.
    Strain,
    /// Height of the wrinkles.
    Amplitude,
    /// Crests and troughs.
    Phase,
    /// Direction of the crests.
    Direction,
    /// Painted growth of the surface: amount and direction.
    Expansion,
    /// Amount painted on a layer.
    Painted(Layer),
}

impl View {
    /// The views of the menu, in its order.
    pub const MAIN: [Self; 7] = [
        Self::Wrinkled,
        Self::Wireframe,
        Self::Strain,
        Self::Amplitude,
        Self::Phase,
        Self::Direction,
        Self::Expansion,
    ];

    /// Name in the window.
    pub fn name(self) -> &'static str {
        match self {
            Self::Wrinkled => "Wrinkled surface",
            Self::Wireframe => "Wireframe",
            Self::Strain => "Strain",
            Self::Amplitude => "Amplitude",
            Self::Phase => "Phase",
            Self::Direction => "Wave direction",
            Self::Expansion => "Expansion",
            Self::Painted(layer) => layer.name(),
        }
    }

    /// Name in scripts.
    pub fn word(self) -> &'static str {
        match self {
            Self::Wrinkled => "wrinkled",
            Self::Wireframe => "wireframe",
            Self::Strain => "strain",
            Self::Amplitude => "amplitude",
            Self::Phase => "phase",
            Self::Direction => "direction",
            Self::Expansion => "expansion",
            Self::Painted(_) => "painted",
        }
    }
}

/// The meaning of a picture's colours.
#[derive(Clone, Debug, PartialEq)]
pub struct Legend {
    /// Name of the quantity.
    pub title: String,
    /// Texts at the low end, the middle and the high end.
    pub ticks: [String; 3],
    /// The scale of colours.
    pub colours: Scale,
}
