//! Panels, the mesh instead of them, and seams.

use std::path::PathBuf;

use serde::Deserialize;

/// `[[panel]]`: a flat piece, see [`crate::mesh::panel`], or a closed surface, see
/// [`crate::mesh::closed`].
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PanelTable {
    /// Name by which seams, clamps and measures call it; without a dot.
    pub name: String,
    /// The outline; it decides which of the sizes below must be given.
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
    /// The pattern of its triangles.
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
    /// Position of the panel at the start.
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

/// The pattern of a panel's triangles.
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
/// [`crate::io::garment`].
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
        /// Position of the panel's origin (m).
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
    /// True if `b` runs against `a`. A closed side keeps its first vertex.
    #[serde(default)]
    pub reversed: bool,
    /// True if the sides may start at different places; their vertices then start at the mean.
    #[serde(default)]
    pub start_apart: bool,
}
