//! A stroke as data: with what brush it was painted, and where it ran.

use serde::{Deserialize, Serialize};

use super::layers::Layer;

/// What a brush does where it touches.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Action {
    /// Goes towards the brush's value.
    Paint,
    /// Goes towards what nobody painted.
    Erase,
}

/// Where the direction of a layer that has one comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Heading {
    /// Crests run along the stroke.
    AlongStroke,
    /// Crests run across the stroke.
    AcrossStroke,
    /// Crests run at an angle on the screen.
    Screen,
    /// None: all ways alike (expansion only).
    Isotropic,
}

/// A plane through the middle of the rest pose in which strokes are mirrored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Mirror {
    /// None.
    Off,
    /// x ↦ −x.
    X,
    /// y ↦ −y.
    Y,
    /// z ↦ −z.
    Z,
}

/// How strength falls off from the middle of a dab.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Falloff {
    /// 1 − s²(3 − 2s).
    Smooth,
    /// 1 − s.
    Linear,
    /// Full strength up to the rim.
    Hard,
}

impl Falloff {
    /// Weight at the share `s` of the radius; 0 from 1 on, and above 0 below.
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
    /// What it paints on.
    pub layer: Layer,
    /// What it does.
    pub action: Action,
    /// Radius along the surface (m).
    pub radius_m: f32,
    /// Share of the way to the value that one stroke goes at its middle, 0 to 1.
    pub strength: f32,
    /// The value it paints, in the layer's own unit.
    pub value: f32,
    /// How strength falls off.
    pub falloff: Falloff,
    /// Direction of layers that have one.
    pub heading: Heading,
    /// Angle of crests on the screen (rad), from its right upwards, for [`Heading::Screen`].
    pub screen_angle_rad: f32,
    /// Where strokes are repeated.
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
    /// With what.
    pub brush: Brush,
    /// Where its dabs lie: a face and the barycentric coordinates of its second and third corner.
    pub dabs: Vec<(u32, [f32; 2])>,
}
