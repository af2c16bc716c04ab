//! What a scene file may say: one struct for each of its tables, with the file's own field names.
//!
//! Only types and defaults are here; [`mod@super::read`] checks what the types cannot say. Lengths
//! are in m, angles in degrees (people write these files), as the names of the fields say.

use std::path::PathBuf;

use serde::Deserialize;

pub use super::growth::schema::GrowthTable;

/// A scene file.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// The file it came from, for messages; not a field of the file.
    #[serde(skip)]
    pub file: PathBuf,
    /// Name of the scene.
    pub title: String,
    /// What was published about it, in words.
    #[serde(default)]
    pub paper: String,
    /// The sheet's material.
    pub material: MaterialTable,
    /// Flat panels, at least one; or none, and a mesh.
    #[serde(default)]
    pub panel: Vec<PanelTable>,
    /// A garment as pattern programs export it, instead of panels.
    pub mesh: Option<MeshTable>,
    /// What is sewn to what.
    #[serde(default)]
    pub seam: Vec<SeamTable>,
    /// What is held, and where it is moved.
    #[serde(default)]
    pub clamp: Vec<ClampTable>,
    /// What pushes on the whole surface.
    #[serde(default)]
    pub load: LoadTable,
    /// What pushes on parts of it.
    #[serde(default)]
    pub force: Vec<ForceTable>,
    /// How close the surface may come to obstacles.
    #[serde(default)]
    pub contact: ContactTable,
    /// What the surface may not enter.
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
    /// What to measure on the result.
    #[serde(default)]
    pub measure: Vec<MeasureTable>,
    /// How it grows.
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

/// `[[panel]]`: a flat piece, see [`crate::mesh::panel`], or a closed surface, see
/// [`crate::mesh::closed`].
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PanelTable {
    /// Name by which seams, clamps and measures call it; without a dot.
    pub name: String,
    /// Which outline it has; decides which of the sizes below must be given.
    pub shape: Shape,
    /// Extent of a rectangle along x (m).
    pub width_m: Option<f64>,
    /// Extent of a rectangle along y (m).
    pub height_m: Option<f64>,
    /// Radius of a disk or a sphere, or of the circle along a torus (m).
    pub radius_m: Option<f64>,
    /// Radius of an annulus's hole (m).
    pub inner_radius_m: Option<f64>,
    /// Radius of an annulus's outer rim (m).
    pub outer_radius_m: Option<f64>,
    /// Radius of a torus's tube (m).
    pub tube_radius_m: Option<f64>,
    /// Corners of a polygon (m), in order.
    pub corners_m: Option<Vec<[f64; 2]>>,
    /// Sides of a polygon; none: one from each corner, called by its number.
    pub sides: Option<Vec<SideTable>>,
    /// How it is cut into triangles.
    #[serde(default)]
    pub mesh: Pattern,
    /// Columns of a structured panel; none: its width divided by the edge length.
    pub columns: Option<usize>,
    /// Rows of a structured panel; none: its height divided by the edge length.
    pub rows: Option<usize>,
    /// Mean edge length (m).
    pub edge_length_m: f64,
    /// Chooses one of many equally good triangulations.
    #[serde(default = "one")]
    pub seed: u64,
    /// Where the panel lies at the start.
    #[serde(default)]
    pub place: Place,
}

fn one() -> u64 {
    1
}

/// One of a polygon's `sides`.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SideTable {
    /// Its name.
    pub name: String,
    /// Corner at which it begins, from 0.
    pub corner: usize,
}

/// How a panel is cut into triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Pattern {
    /// At random, see [`crate::mesh::panel`].
    #[default]
    Irregular,
    /// Rectangles only: rows and columns, diagonals from lower left to upper right.
    Rising,
    /// Rectangles only: rows and columns, diagonals from upper left to lower right.
    Falling,
}

/// `[mesh]`: a surface from files; either its start, which is also its rest shape, or a garment as
/// pattern programs export it, see
/// [`crate::io::worn`].
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeshTable {
    /// OBJ or PLY file of a surface that starts at rest, relative to the scene file.
    pub start: Option<PathBuf>,
    /// OBJ file of a garment's start pose, relative to the scene file.
    pub worn: Option<PathBuf>,
    /// OBJ file of a garment's rest shape, relative to the scene file; none: the texture
    /// coordinates of `worn`.
    pub rest: Option<PathBuf>,
    /// Length of one unit of texture (m); needed if there is `worn` but no `rest`.
    pub metres_per_uv: Option<f64>,
    /// Length of one unit of the files' coordinates (m).
    #[serde(default = "one_metre")]
    pub metres_per_unit: f64,
}

fn one_metre() -> f64 {
    1.0
}

/// Outline of a panel, see [`crate::mesh::panel::Outline`] for the names of its sides; or a closed
/// surface, which has none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Shape {
    /// Needs `width_m` and `height_m`.
    Rectangle,
    /// Needs `radius_m`.
    Disk,
    /// Needs `inner_radius_m` and `outer_radius_m`.
    Annulus,
    /// Needs `corners_m`.
    Polygon,
    /// Needs `radius_m`; closed.
    Sphere,
    /// Needs `radius_m` and `tube_radius_m`; closed.
    Torus,
}

/// Start pose of a panel.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase", deny_unknown_fields)]
pub enum Place {
    /// In a plane: panel point (x, y) at origin + x·(x axis) + y·(y axis); a closed surface has its
    /// z along their cross product.
    Flat {
        /// Where the panel's origin lies (m).
        #[serde(default)]
        origin_m: [f64; 3],
        /// Direction of the panel's x (any length but 0).
        #[serde(default = "x_axis")]
        x_axis: [f64; 3],
        /// Direction of the panel's y (any length but 0), perpendicular to the x axis.
        #[serde(default = "y_axis")]
        y_axis: [f64; 3],
    },
    /// Around a vertical axis: panel point (x, y) at angle start + x/radius and height centre + y.
    Rolled {
        /// Radius (m).
        radius_m: f64,
        /// A point on the axis, level with the panel's y = 0 (m).
        #[serde(default)]
        centre_m: [f64; 3],
        /// Angle of the panel's x = 0 (degrees).
        #[serde(default)]
        start_deg: f64,
    },
}

fn x_axis() -> [f64; 3] {
    [1.0, 0.0, 0.0]
}

fn y_axis() -> [f64; 3] {
    [0.0, 1.0, 0.0]
}

impl Default for Place {
    fn default() -> Self {
        Self::Flat { origin_m: [0.0; 3], x_axis: x_axis(), y_axis: y_axis() }
    }
}

/// `[[seam]]`: two sides become one.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SeamTable {
    /// A side, as "panel.side".
    pub a: String,
    /// The other side.
    pub b: String,
    /// Whether `b` runs against `a`. A closed side keeps its first vertex.
    #[serde(default)]
    pub reversed: bool,
    /// Whether the sides may start at different places; their vertices then start at the mean.
    #[serde(default)]
    pub start_apart: bool,
}

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
    /// Which coordinates are held: letters of "xyz".
    #[serde(default = "xyz")]
    pub axes: String,
    /// By how much it is moved from its start pose (m), after the turn.
    #[serde(default)]
    pub move_m: [f64; 3],
    /// How it is turned from its start pose.
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
    /// What it is; decides which of the fields below must be given.
    pub kind: ObstacleKind,
    /// A point on a plane (m).
    pub point_m: Option<[f64; 3]>,
    /// Direction of a plane's free side (any length but 0).
    pub normal: Option<[f64; 3]>,
    /// Centre of a sphere, an ellipsoid or a torus (m).
    pub centre_m: Option<[f64; 3]>,
    /// Radius of a sphere, of a capsule where it begins, or of the circle along a torus (m).
    pub radius_m: Option<f64>,
    /// Where a capsule's axis begins (m).
    pub from_m: Option<[f64; 3]>,
    /// Where it ends (m).
    pub to_m: Option<[f64; 3]>,
    /// Radius where it ends (m); none: that where it begins.
    pub end_radius_m: Option<f64>,
    /// Radii of an ellipsoid along x, y and z before its turn (m).
    pub radii_m: Option<[f64; 3]>,
    /// How an ellipsoid is turned about its centre.
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

/// What an obstacle is; see [`crate::obstacle::Obstacle`].
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
    /// How wrinkle-free faces are found.
    pub wrinkle_free: Option<Rule>,
    /// Terms of the energy to leave out, for ablation.
    #[serde(default)]
    pub without: Vec<String>,
    /// Rings of vertices that curvature is fitted to.
    pub curvature_rings: Option<usize>,
    /// Newton iterations at most.
    pub iteration_limit: Option<usize>,
}

/// How wrinkle-free faces are found: see [`crate::field::WrinkleFreeRule`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Rule {
    /// Section 5.1 of [Chen 2021].
    Paper,
    /// What the published code does.
    Published,
}

/// `[surface]`: how the wrinkled surface is made.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SurfaceTable {
    /// Subdivisions (0 to 6); none: as many as the wavelength asks for.
    pub levels: Option<usize>,
    /// Whether to displace by the in-plane correction v₁, too.
    pub v1: bool,
    /// Whether to displace by the in-plane correction v₂, too.
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
    /// What it is; decides which of the fields below must be given.
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
    /// Where it was published.
    pub source: Option<String>,
}

/// What a measure is.
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
