//! `[growth]`: the tables of a scene file about growth. Types and defaults; `check` holds the rules
//! that types cannot.

use std::fmt;
use std::path::PathBuf;

use serde::Deserialize;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Deserializer, MapAccess, SeqAccess, Visitor};

use super::hold::BoxTable;

/// `[growth]`: how the surface grows and folds, see [`crate::growth`].
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GrowthTable {
    /// The method for folds; none: by energy.
    pub mode: Option<Mode>,
    /// Amounts and directions of growth, applied one after the other.
    pub expansion: Vec<ExpansionTable>,
    /// λ: spacing of folds on the starting surface (m).
    pub wavelength_m: MapTable,
    /// Λ: coherence length, over which crests run straight (m); none: 0.
    pub coherence_m: Option<MapTable>,
    /// Offset that the surface prefers, in wavelengths; none: 0.
    pub bias: Option<MapTable>,
    /// Resistance of the surface to going in, above that to going out; none: 0.
    pub stickiness: Option<MapTable>,
    /// Share of the foundation's stiffness; none: 1.
    pub hold: Option<MapTable>,
    /// Vertices that do not move.
    #[serde(default)]
    pub freeze: Vec<FreezeTable>,
    /// Sets of vertices that move as one.
    #[serde(default)]
    pub band: Vec<BandTable>,
    /// Windows in which folds are counted.
    #[serde(default)]
    pub count: Vec<CountTable>,
    /// Steps of growth at least.
    pub steps: Option<usize>,
    /// Share of the stress that is forgotten after each step (0 to 1).
    pub plasticity: Option<f64>,
    /// Size of the random imperfections from which folds begin, in wavelengths.
    pub imperfection: Option<f64>,
    /// Chooses the imperfections.
    pub seed: Option<u64>,
    /// True if folds cannot pass through each other; none: true.
    pub self_contact: Option<bool>,
    /// Newton iterations at most in each step.
    pub iteration_limit: Option<usize>,
    /// Remeshing while the surface grows; none: the mesh stays as it is.
    pub remesh: Option<RemeshTable>,
}

impl GrowthTable {
    /// The table of the scalar map called `name` (one of [`crate::growth::maps::SCALAR_MAPS`]), if
    /// the scene gives it.
    pub(in crate::scene) fn scalar_map(&self, name: &str) -> Option<&MapTable> {
        match name {
            "wavelength_m" => Some(&self.wavelength_m),
            "coherence_m" => self.coherence_m.as_ref(),
            "bias" => self.bias.as_ref(),
            "stickiness" => self.stickiness.as_ref(),
            "hold" => self.hold.as_ref(),
            _ => None,
        }
    }
}

/// `[growth.remesh]`: see [`crate::growth::adapt`].
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RemeshTable {
    /// Edges to a wavelength while it grows; none: 6.
    pub edges_per_wave: Option<f64>,
    /// Edges to a wavelength at the end; none: 8, or as many as while it grows if these are more.
    pub finish_edges_per_wave: Option<f64>,
    /// Length of edges where nothing grows (m); none: the mean of the mesh's.
    pub longest_m: Option<f64>,
    /// No vertex is added beyond this many; none: 200,000.
    pub most_vertices: Option<usize>,
    /// Newton iterations at most on each of the finer meshes at the end; none: 20.
    pub finish_iterations: Option<usize>,
    /// True if new vertices of a curved starting surface lie on its curve; none: they lie on the
    /// given faces.
    pub round_start: Option<bool>,
}

/// `mode` of growth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Mode {
    /// The least energy: [`crate::growth::load_stepping`].
    #[default]
    Variational,
    /// The forces of the paper: [`mod@crate::growth::reference`].
    Reference,
}

/// `[[growth.expansion]]`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ExpansionTable {
    /// The panel that grows; none: the whole surface.
    pub panel: Option<String>,
    /// Factor of lengths along `direction`, or in all directions if there is none.
    pub factor: Option<MapTable>,
    /// Factor of lengths across `direction`; none: 1.
    pub across: Option<MapTable>,
    /// Instead of factors: τ = [a, b; b, c] in the frame of `direction`, as [a, b, c].
    pub tensor: Option<[MapTable; 3]>,
    /// Along what it grows most.
    pub direction: Option<DirectionTable>,
}

/// `[[growth.freeze]]`; exactly one of `side`, `near_m`, `within_m` and `map` says what.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FreezeTable {
    /// A side, as "panel.side".
    pub side: Option<String>,
    /// The vertex that starts nearest to this point (m).
    pub near_m: Option<[f64; 3]>,
    /// All vertices that start in this box.
    pub within_m: Option<BoxTable>,
    /// All vertices where this map is above one half.
    pub map: Option<MapTable>,
    /// Along which axes: letters of "xyz".
    #[serde(default = "xyz")]
    pub axes: String,
}

fn xyz() -> String {
    "xyz".to_owned()
}

/// `[[growth.band]]`: vertices that move as one; exactly one of the fields says which.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BandTable {
    /// A side, as "panel.side".
    pub side: Option<String>,
    /// All vertices that start in this box.
    pub within_m: Option<BoxTable>,
    /// All vertices where this map is above one half.
    pub map: Option<MapTable>,
}

/// `[[growth.count]]`: a rectangle of a panel, or a ring of one; of a closed panel that gives
/// neither, all around it.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CountTable {
    /// Its name.
    pub name: String,
    /// The panel.
    pub panel: String,
    /// Lower left corner in panel coordinates (m).
    pub low_m: Option<[f64; 2]>,
    /// Upper right corner (m).
    pub high_m: Option<[f64; 2]>,
    /// Axis of the panel along which folds are counted: "x" or "y"; none: "x".
    pub along: Option<PanelAxis>,
    /// Of a ring: its centre in panel coordinates (m).
    pub centre_m: Option<[f64; 2]>,
    /// Of a ring: its radius (m).
    pub radius_m: Option<f64>,
    /// Of a ring: its width (m).
    pub width_m: Option<f64>,
}

/// An axis of a panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PanelAxis {
    /// Its x.
    X,
    /// Its y.
    Y,
}

/// A number that may vary over the surface: a number, or a table with a `kind`.
#[derive(Clone, Debug, PartialEq)]
pub enum MapTable {
    /// The same everywhere.
    Number(f64),
    /// By place.
    ProceduralMap(Box<ProcedureTable>),
}

/// A map by place: `low` where the procedure is 0, `high` where it is 1.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProcedureTable {
    /// The procedure; it decides which of the fields below must be given.
    pub kind: MapKind,
    /// Value where the map is 0.
    pub low: f64,
    /// Value where it is 1.
    pub high: f64,
    /// A ramp's beginning, where it is 0 (m).
    pub from_m: Option<[f64; 3]>,
    /// Its end, where it is 1 (m).
    pub to_m: Option<[f64; 3]>,
    /// A point of the band's middle plane, or of the axis of a ring or a radial map (m).
    pub centre_m: Option<[f64; 3]>,
    /// The middles of spots (m).
    pub centres_m: Option<Vec<[f64; 3]>>,
    /// Normal of a band's middle plane.
    pub normal: Option<[f64; 3]>,
    /// Axis of a ring or a radial map.
    pub axis: Option<[f64; 3]>,
    /// Radius of a ring, a radial map or spots (m).
    pub radius_m: Option<f64>,
    /// Width of a band or a ring (m).
    pub width_m: Option<f64>,
    /// Over how much a band or a ring falls off (m); none: 0.
    pub soft_m: Option<f64>,
    /// Size of the lumps of noise (m).
    pub size_m: Option<f64>,
    /// Scales of fractal noise.
    pub octaves: Option<usize>,
    /// Chooses the noise; none: 1.
    pub seed: Option<u64>,
    /// PNG file of an image, relative to the scene file.
    pub file: Option<PathBuf>,
    /// Value for each panel, in the scene's order, from 0 (`low`) to 1 (`high`).
    pub shares: Option<Vec<f64>>,
    /// Name of an attribute of the mesh's vertices: `low` where it is 0, `high` where it is 1.
    pub name: Option<String>,
}

/// The procedure of a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum MapKind {
    /// Needs `from_m` and `to_m`.
    Ramp,
    /// Needs `centre_m`, `normal` and `width_m`.
    Band,
    /// Needs `centre_m`, `axis`, `radius_m` and `width_m`.
    Ring,
    /// Needs `centre_m`, `axis` and `radius_m`.
    Radial,
    /// Needs `centres_m` and `radius_m`.
    Spots,
    /// Needs `size_m`.
    Noise,
    /// Needs `size_m` and `octaves`.
    Fractal,
    /// Needs `file`.
    Image,
    /// Needs `shares`.
    Panels,
    /// Needs `name`.
    Attribute,
}

/// A direction: `[x, y, z]`, or a table.
#[derive(Clone, Debug, PartialEq)]
pub enum DirectionTable {
    /// The same everywhere.
    Fixed([f64; 3]),
    /// About an axis, or from the mesh.
    Axis(AxisTable),
}

/// A direction about an axis, or from the mesh.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AxisTable {
    /// Around the axis, away from it, or by three attributes.
    pub kind: AxisKind,
    /// A point of the axis (m).
    #[serde(default)]
    pub centre_m: [f64; 3],
    /// Direction of the axis (any length but 0).
    pub axis: Option<[f64; 3]>,
    /// Attributes of the mesh's vertices that are the direction's x, y and z.
    pub names: Option<[String; 3]>,
}

/// Source of a direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum AxisKind {
    /// Around it.
    Around,
    /// Away from it.
    Outward,
    /// From the mesh.
    Attribute,
}

// Not derived: an untagged enum would not say what is wrong inside the table.
impl<'de> Deserialize<'de> for MapTable {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct NumberOrTable;
        impl<'de> Visitor<'de> for NumberOrTable {
            type Value = MapTable;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number, or a table with a kind")
            }

            fn visit_f64<E>(self, value: f64) -> Result<MapTable, E> {
                Ok(MapTable::Number(value))
            }

            fn visit_i64<E>(self, value: i64) -> Result<MapTable, E> {
                Ok(MapTable::Number(value as f64))
            }

            fn visit_u64<E>(self, value: u64) -> Result<MapTable, E> {
                Ok(MapTable::Number(value as f64))
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<MapTable, A::Error> {
                ProcedureTable::deserialize(MapAccessDeserializer::new(map))
                    .map(|table| MapTable::ProceduralMap(Box::new(table)))
            }
        }
        deserializer.deserialize_any(NumberOrTable)
    }
}

impl<'de> Deserialize<'de> for DirectionTable {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct VectorOrTable;
        impl<'de> Visitor<'de> for VectorOrTable {
            type Value = DirectionTable;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("three numbers in [ ], or a table with a kind")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<DirectionTable, A::Error> {
                <[f64; 3]>::deserialize(SeqAccessDeserializer::new(list)).map(DirectionTable::Fixed)
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<DirectionTable, A::Error> {
                AxisTable::deserialize(MapAccessDeserializer::new(map)).map(DirectionTable::Axis)
            }
        }
        deserializer.deserialize_any(VectorOrTable)
    }
}
