//! Shapes that have vertices of their own, matched to a surface face by face and corner by corner:
//! flat charts (texture coordinates, panel coordinates) and rest shapes. Along a seam of the
//! surface such a shape has two vertices where the surface has one.

use super::subdivide::refine_rest;
use super::{Vec2, Vec3};

/// A flat chart of a surface: texture coordinates (v up) or panel coordinates.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chart {
    /// `[T]` points in the plane (no unit, or m).
    pub points: Vec<Vec2>,
    /// `[F][3]` points of each face, corner by corner.
    pub faces: Vec<[usize; 3]>,
}

impl Chart {
    /// The chart of the surface divided `levels` times.
    pub fn refined(&self, levels: usize) -> Self {
        (0..levels).fold(self.clone(), |coarse, _| {
            let (points, faces) = refine_rest(&coarse.points, &coarse.faces);
            Self { points, faces }
        })
    }

    /// `[3]` points at the corners of face `f`.
    pub fn corners(&self, f: usize) -> [Vec2; 3] {
        self.faces[f].map(|p| self.points[p])
    }
}

/// The shape of a surface without strain: flat panels, or any mesh with the same faces.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RestShape {
    /// `[R]` rest vertices (m), R ≥ V.
    pub positions: Vec<Vec3>,
    /// `[F][3]` rest vertices of each face, corner by corner.
    pub faces: Vec<[usize; 3]>,
}

impl RestShape {
    /// The rest shape of the surface divided once, linearly, so that flat panels stay flat.
    pub fn refined(&self) -> Self {
        let (positions, faces) = refine_rest(&self.positions, &self.faces);
        Self { positions, faces }
    }

    /// `[3]` positions (m) of the corners of face `f`.
    pub fn corners(&self, f: usize) -> [Vec3; 3] {
        self.faces[f].map(|r| self.positions[r])
    }
}
