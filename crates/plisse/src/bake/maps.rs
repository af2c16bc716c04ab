//! A surface to bake, and the maps that come of it.

use crate::mesh::{Vec2, Vec3};

/// A posed surface with texture coordinates. V vertices, F faces, T texture coordinates.
#[derive(Clone, Copy, Debug)]
pub struct Surface<'a> {
    /// `[V]` positions (m).
    pub positions: &'a [Vec3],
    /// `[V]` unit normals, those that a renderer will interpolate.
    pub normals: &'a [Vec3],
    /// `[F][3]` vertices of each face, counter-clockwise from outside.
    pub faces: &'a [[usize; 3]],
    /// `[T]` texture coordinates, v up, within [0, 1].
    pub uvs: &'a [Vec2],
    /// `[F][3]` texture coordinate of each corner.
    pub uv_faces: &'a [[usize; 3]],
}

/// Wrinkles at a point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// Height over the base surface (m).
    pub height_m: f64,
    /// Gradient of the height by position (no unit); only its part along the surface counts.
    pub gradient: Vec3,
}

/// Size and padding of maps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// Texels across and down, N.
    pub size: usize,
    /// Texels by which islands are grown, so that filtering meets no background.
    pub padding: usize,
}

/// Source of a texel's value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum Coverage {
    /// Nothing: height 0, normal straight up.
    #[default]
    None,
    /// Neighbours: it lies just beside an island.
    Padded,
    /// Its centre lies on a face.
    Covered,
}

/// Height and normal of every texel, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Baked {
    /// Texels across and down, N.
    pub size: usize,
    /// `[N²]` height (m).
    pub height_m: Vec<f32>,
    /// `[N²]` unit normal in tangent space: along u, along v (up), outwards.
    pub normal: Vec<[f32; 3]>,
    /// `[N²]` source of each value.
    pub coverage: Vec<Coverage>,
    /// Texels whose centre lies inside more than one face; the first has it.
    pub overlapping: usize,
    /// Faces that no texel's centre lies on: without an area in texture space, or too small for
    /// this size.
    pub missed_faces: usize,
}
