//! The content of a scene file: one struct for each of its tables, with the file's own field names.
//!
//! Only types and defaults are here; [`mod@super::read`] checks the rest. Lengths are in m, angles
//! in degrees (people write these files); the names of the fields carry the unit.

use std::path::PathBuf;

use serde::Deserialize;

mod growth;
mod hold;
mod obstacle;
mod panel;

pub use growth::*;
pub use hold::*;
pub use obstacle::*;
pub use panel::*;

/// A scene file.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// The file it came from, for messages; not a field of the file.
    #[serde(skip)]
    pub file: PathBuf,
    /// Name of the scene.
    pub title: String,
    /// Published results, in words.
    #[serde(default)]
    pub paper: String,
    /// The sheet's material.
    pub material: MaterialTable,
    /// Flat panels, at least one; or none, and a mesh.
    #[serde(default)]
    pub panel: Vec<PanelTable>,
    /// A garment as pattern programs export it, instead of panels.
    pub mesh: Option<MeshTable>,
    /// Pairs of sides that are sewn together.
    #[serde(default)]
    pub seam: Vec<SeamTable>,
    /// Vertices that are held, and their motion.
    #[serde(default)]
    pub clamp: Vec<ClampTable>,
    /// Loads on the whole surface.
    #[serde(default)]
    pub load: LoadTable,
    /// Forces on parts of the surface.
    #[serde(default)]
    pub force: Vec<ForceTable>,
    /// Contact with the obstacles.
    #[serde(default)]
    pub contact: ContactTable,
    /// Bodies that the surface may not enter.
    #[serde(default)]
    pub obstacle: Vec<ObstacleTable>,
    /// Options of the base solve.
    #[serde(default)]
    pub base: BaseTable,
    /// Options of the field solve.
    #[serde(default)]
    pub field: FieldTable,
    /// Options of the displaced surface.
    #[serde(default)]
    pub surface: SurfaceTable,
    /// Measures of the result.
    #[serde(default)]
    pub measure: Vec<MeasureTable>,
    /// Growth of the surface.
    pub growth: Option<GrowthTable>,
}

/// `[material]`: see [`crate::material::Material`].
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MaterialTable {
    /// Young's modulus (Pa), > 0.
    pub young_pa: f64,
    /// Poisson's ratio (no unit), > −1 and ≤ 0.5.
    pub poisson: f64,
    /// Thickness (m), > 0.
    pub thickness_m: f64,
    /// Density (kg/m³), ≥ 0; gravity needs it.
    pub density_kg_m3: Option<f64>,
}

/// `[base]`: see [`crate::shell::BaseOptions`], whose defaults hold for what is missing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BaseTable {
    /// Share of the resistance that is left against compression (0 to 1).
    pub compressive_stiffness: Option<f64>,
    /// Newton iterations at most.
    pub iteration_limit: Option<usize>,
}

/// `[field]`: see [`crate::field::FieldOptions`], whose defaults hold for what is missing.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FieldTable {
    /// The rule for wrinkle-free faces.
    pub wrinkle_free: Option<Rule>,
    /// Terms of the energy to leave out, for ablation.
    #[serde(default)]
    pub without: Vec<String>,
    /// Rings of vertices that curvature is fitted to.
    pub curvature_rings: Option<usize>,
    /// Newton iterations at most.
    pub iteration_limit: Option<usize>,
}

/// The rule for wrinkle-free faces: see [`crate::field::WrinkleFreeRule`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Rule {
    /// Section 5.1 of [Chen 2021].
    Paper,
    /// The rule of the published code.
    Published,
}

/// `[surface]`: how the wrinkled surface is made.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SurfaceTable {
    /// Subdivisions (0 to 6); none: as many as the wavelength asks for.
    pub levels: Option<usize>,
    /// True if the surface is displaced by the in-plane correction v₁, too.
    pub v1: bool,
    /// True if the surface is displaced by the in-plane correction v₂, too.
    pub v2: bool,
}

impl Default for SurfaceTable {
    fn default() -> Self {
        Self { levels: None, v1: false, v2: true }
    }
}

/// `[[measure]]`: a number to take from the result.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeasureTable {
    /// Name of the number.
    pub name: String,
    /// The kind; it decides which of the fields below must be given.
    pub kind: MeasureKind,
    /// `waves_around`: the side, as "panel.side".
    pub side: Option<String>,
    /// `waves_along`: the panel.
    pub panel: Option<String>,
    /// `waves_along`: start of a straight line in panel coordinates (m).
    pub from_m: Option<[f64; 2]>,
    /// `waves_along`: its end (m).
    pub to_m: Option<[f64; 2]>,
    /// The published number, in the measure's unit.
    pub published: Option<f64>,
    /// Source of the published number.
    pub source: Option<String>,
}

/// The kind of a measure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MeasureKind {
    /// Whole turns of the phase around the loop that has most of them (waves).
    LargestPeriod,
    /// Largest amplitude (m).
    PeakAmplitude,
    /// Waves that a straight line on a panel crosses; needs `panel`, `from_m` and `to_m`.
    WavesAlong,
    /// Turns of the phase along a side; needs `side`.
    WavesAround,
}
