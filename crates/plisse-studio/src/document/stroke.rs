//! A stroke as data: its brush and its dabs.

use serde::{Deserialize, Serialize};

use super::layers::Layer;

/// The action of a brush.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Action {
    /// Moves numbers towards the brush's value.
    Paint,
    /// Moves numbers towards those of an unpainted vertex.
    Erase,
}

/// The source of the direction, for layers that have one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Heading {
    /// Crests run along the stroke.
    AlongStroke,
    /// Crests run across the stroke.
    AcrossStroke,
    /// Crests run at an angle on the screen.
    Screen,
    /// In all directions alike (expansion only).
    Isotropic,
}

/// A plane through the middle of the rest pose in which strokes are mirrored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Mirror {
    /// No mirror.
    Off,
    /// x ↦ −x.
    X,
    /// y ↦ −y.
    Y,
    /// z ↦ −z.
    Z,
}

/// The falloff of strength from the middle of a dab, over s = distance / radius.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Falloff {
    /// 1 − s²(3 − 2s).
    Smooth,
    /// 1 − s.
    Linear,
    /// 1 up to the rim.
    Hard,
}

impl Falloff {
    /// Weight at the share `s` of the radius; 0 from 1 on.
    pub fn weight(self, s: f32) -> f32 {
        if !(0.0..1.0).contains(&s) {
            return 0.0;
        }
        match self {
            Self::Smooth => 1.0 - s * s * (3.0 - 2.0 * s),
            Self::Linear => 1.0 - s,
            Self::Hard => 1.0,
        }
    }
}

/// A brush.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Brush {
    /// The layer that it paints on.
    pub layer: Layer,
    /// Its action.
    pub action: Action,
    /// Radius along the surface (m).
    pub radius_m: f32,
    /// Share (0 to 1) of the way to the value that one stroke goes at its middle.
    pub strength: f32,
    /// The value it paints, in the layer's unit.
    pub value: f32,
    /// Its falloff.
    pub falloff: Falloff,
    /// Direction of layers that have one.
    pub heading: Heading,
    /// Angle of crests on the screen (rad), from its right upwards, for [`Heading::Screen`].
    pub screen_angle_rad: f32,
    /// The plane in which strokes are mirrored.
    pub mirror: Mirror,
}

impl Brush {
    /// A brush for rest-pose wrinkles of this radius (m).
    pub fn new(radius_m: f32) -> Self {
        Self {
            layer: Layer::Wrinkles,
            action: Action::Paint,
            radius_m,
            strength: 1.0,
            value: 0.7,
            falloff: Falloff::Smooth,
            heading: Heading::AlongStroke,
            screen_angle_rad: 0.0,
            mirror: Mirror::Off,
        }
    }
}

/// A stroke that was painted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stroke {
    /// The brush.
    pub brush: Brush,
    /// Its dabs.
    pub dabs: Vec<Dab>,
}

/// The position of a dab; `[face, [s, t]]` in files.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "(u32, [f32; 2])", into = "(u32, [f32; 2])")]
pub struct Dab {
    /// The face.
    pub face: u32,
    /// Barycentric coordinates of the face's second and third corner.
    pub weights: [f32; 2],
}

impl From<(u32, [f32; 2])> for Dab {
    fn from((face, weights): (u32, [f32; 2])) -> Self {
        Self { face, weights }
    }
}

impl From<Dab> for (u32, [f32; 2]) {
    fn from(Dab { face, weights }: Dab) -> Self {
        (face, weights)
    }
}
