//! What is seen: the camera ([`turntable`]), what faces carry in each view ([`corners`],
//! [`colours`]), lines over them ([`marks`]), and the thread that draws ([`easel`]).

#[cfg(target_arch = "wasm32")]
mod at_once;
pub mod colours;
pub mod corners;
pub mod easel;
pub mod marks;
#[cfg(not(target_arch = "wasm32"))]
mod on_a_thread;
pub mod pencil;
pub mod turntable;

pub use easel::{Easel, Order, Sheet, Shown, Solid};
pub use pencil::Graphics;
pub use turntable::Turntable;

use crate::document::Layer;

/// What a picture shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum View {
    /// The wrinkled surface in its light.
    Wrinkled,
    /// The mesh that is simulated.
    Wireframe,
    /// How much the pose is longer or shorter than the rest shape.
    Strain,
    /// How high wrinkles are.
    Amplitude,
    /// Where crests and troughs are.
    Phase,
    /// Along which way crests run.
    Direction,
    /// How much, and along what, the surface is told to grow.
    Expansion,
    /// How much of a layer is painted.
    Painted(Layer),
}

impl View {
    /// Those of the menu, in its order.
    pub const MAIN: [Self; 7] = [
        Self::Wrinkled,
        Self::Wireframe,
        Self::Strain,
        Self::Amplitude,
        Self::Phase,
        Self::Direction,
        Self::Expansion,
    ];

    /// Its name for people.
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

    /// Its name in scripts.
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

/// What colours mean.
#[derive(Clone, Debug, PartialEq)]
pub struct Legend {
    /// What is shown.
    pub title: String,
    /// Texts at the low end, the middle and the high end.
    pub ticks: [String; 3],
    /// Which colours, one of the easel's textures.
    pub colours: colours::Scale,
}
