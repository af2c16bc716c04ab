//! The painted layers: five sets of numbers for each welded vertex.

use plisse_live::Vec3;
use plisse_live::wavelength::LEAST_SHARE;

/// Largest length of a painted bias (no unit); at 1 the surface would have no length along it.
pub const LONGEST_BIAS: f32 = 0.95;

/// A layer, with the meaning of its four numbers for a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Layer {
    /// Wrinkles of the rest pose: the bias p of section 7 of [Loviscach 2006], a tangential vector
    /// (x, y, z, no unit) of the rest pose, shorter than 1; the surface counts as shortened by |p|²
    /// along it. The fourth number is 0.
    Wrinkles,
    /// Share (0.05 to 1) of the model's wavelength. The others are 0.
    Wavelength,
    /// Expansion: a tangential vector of the rest pose whose length is the growth along it (factor
    /// − 1); the fourth number is the growth in all directions (factor − 1).
    Expansion,
    /// Coherence length Λ (m), over which crests run straight. The others are 0.
    Coherence,
    /// Share (0 to 1) to which the vertex is frozen: from 0.5 on it does not move. The others are
    /// 0.
    Freeze,
}

impl Layer {
    /// All layers, in the order in which they are kept.
    pub const ALL: [Self; 5] =
        [Self::Wrinkles, Self::Wavelength, Self::Expansion, Self::Coherence, Self::Freeze];

    /// Name in the window.
    pub fn name(self) -> &'static str {
        match self {
            Self::Wrinkles => "Rest-pose wrinkles",
            Self::Wavelength => "Wavelength",
            Self::Expansion => "Expansion",
            Self::Coherence => "Coherence",
            Self::Freeze => "Freeze",
        }
    }

    /// The numbers of an unpainted vertex.
    pub fn neutral(self) -> [f32; 4] {
        if self == Self::Wavelength { [1.0, 0.0, 0.0, 0.0] } else { [0.0; 4] }
    }

    /// True if it has a direction.
    pub fn is_directed(self) -> bool {
        matches!(self, Self::Wrinkles | Self::Expansion)
    }

    /// The range of its values.
    pub fn range(self) -> Range {
        let (low, high, unit) = match self {
            Self::Wrinkles => (0.0, LONGEST_BIAS, ""),
            Self::Wavelength => (LEAST_SHARE, 1.0, ""),
            Self::Expansion => (0.0, 3.0, ""),
            Self::Coherence => (0.0, 1.0, " m"),
            Self::Freeze => (0.0, 1.0, ""),
        };
        Range { low, high, unit }
    }
}

/// The range of a layer's values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Least value.
    pub low: f32,
    /// Largest value.
    pub high: f32,
    /// Unit, with the space before it.
    pub unit: &'static str,
}

/// The layers of a model with `U` welded vertices.
#[derive(Clone, Debug, PartialEq)]
pub struct Layers {
    /// `[layer][U]` numbers, layers in the order of [`Layer::ALL`].
    values: [Vec<[f32; 4]>; 5],
}

impl Layers {
    /// Unpainted layers of `count` welded vertices.
    pub fn neutral(count: usize) -> Self {
        Self { values: Layer::ALL.map(|layer| vec![layer.neutral(); count]) }
    }

    /// `[U]` numbers of `layer`.
    pub fn of(&self, layer: Layer) -> &[[f32; 4]] {
        &self.values[layer as usize]
    }

    /// `[U]` numbers of `layer`, mutable.
    pub(crate) fn of_mut(&mut self, layer: Layer) -> &mut [[f32; 4]] {
        &mut self.values[layer as usize]
    }

    /// True if any vertex of `layer` is painted.
    pub fn is_painted(&self, layer: Layer) -> bool {
        self.of(layer).iter().any(|v| *v != layer.neutral())
    }

    /// `[U]` bias for the stages; empty if nothing is painted.
    pub fn bias(&self) -> Vec<Vec3> {
        if !self.is_painted(Layer::Wrinkles) {
            return Vec::new();
        }
        self.of(Layer::Wrinkles).iter().map(|v| Vec3::new(v[0], v[1], v[2])).collect()
    }

    /// Wavelengths (m, rest) for the stages: one for all if nothing is painted, else `[U]`. `own_m`
    /// (`[U]`, or fewer than two) are the model's own.
    pub fn wavelength_m(&self, wavelength_m: f32, own_m: &[f32]) -> Vec<f32> {
        let painted = self.is_painted(Layer::Wavelength);
        if !painted && own_m.len() <= 1 {
            return vec![wavelength_m];
        }
        let own = |v: usize| own_m.get(v).copied().unwrap_or(wavelength_m);
        self.of(Layer::Wavelength)
            .iter()
            .enumerate()
            .map(|(v, x)| own(v) * x[0].clamp(LEAST_SHARE, 1.0))
            .collect()
    }
}

/// The numbers of a vertex as one: a length, a share, or an amount.
pub fn amount(layer: Layer, numbers: &[f32; 4]) -> f32 {
    match layer {
        Layer::Wrinkles => Vec3::new(numbers[0], numbers[1], numbers[2]).norm(),
        Layer::Expansion => Vec3::new(numbers[0], numbers[1], numbers[2]).norm() + numbers[3],
        _ => numbers[0],
    }
}
