//! A pose with its wrinkles as the files that are taken away: the one road from a solved field to
//! `base.obj`, `wrinkled.obj`, `wrinkled.glb` and `field.json`, for everyone who writes them.

use crate::Result;
use crate::field::curvature::second_forms;
use crate::field::{WrinkleField, json};
use crate::io::staged::OutputFolder;
use crate::io::{glb, obj};
use crate::material::Material;
use crate::mesh::normals::vertex_normals;
use crate::mesh::subdivide::refine_rest;
use crate::mesh::{Topology, Up, Vec2, Vec3};
use crate::obstacle::Obstacle;
use crate::picture::CLOTH;
use crate::rest::RestMetric;
use crate::surface::{Displacement, Upsampled, displace, keep_out, suggest_levels, upsample};

/// A base surface in the pose in which it wrinkles.
#[derive(Clone, Debug)]
pub struct Posed<'a> {
    /// The base surface.
    pub topology: &'a Topology,
    /// Its rest metric.
    pub rest: &'a RestMetric,
    /// Rest positions (`[R]`, m) and those of each face's corners (`[F][3]`).
    pub rest_shape: (&'a [Vec3], &'a [[usize; 3]]),
    /// `[V]` positions (m).
    pub pose: &'a [Vec3],
    /// Its material.
    pub material: &'a Material,
    /// Rings of neighbours that curvature is fitted to, for v₁.
    pub curvature_rings: usize,
    /// Subdivisions asked for; `None`: as many as the wavelength asks for.
    pub levels: Option<usize>,
    /// Whether to displace by v₁.
    pub v1: bool,
    /// Whether to displace by v₂.
    pub v2: bool,
    /// Bodies that the wrinkles stay out of, and how far (m).
    pub obstacles: (&'a [Obstacle], f64),
    /// Texture coordinates (v up) and those of each face's corners (`[F][3]`).
    pub texture: Option<(Vec<Vec2>, Vec<[usize; 3]>)>,
}

/// A wrinkled surface.
#[derive(Clone, Debug)]
pub struct Wrinkled {
    /// The divided base surface, kept out of bodies as its wrinkles are.
    pub fine: Upsampled,
    /// Its wrinkled places (m).
    pub positions: Vec<Vec3>,
}

impl Posed<'_> {
    /// Subdivisions asked for, else those that the wavelength of `field` asks for.
    pub fn levels(&self, field: &WrinkleField) -> usize {
        let median_m = || field.wavelengths(self.topology, self.rest).map(|summary| summary.median);
        self.levels.unwrap_or_else(|| suggest_levels(self.topology, self.rest, median_m()))
    }

    /// The surface with the wrinkles of `field`, divided `levels` times.
    pub fn wrinkle(&self, field: &WrinkleField, levels: usize) -> Wrinkled {
        let mut fine =
            upsample(self.topology, self.pose, field, self.rest_shape.0, self.rest_shape.1, levels);
        let forms = self.v1.then(|| second_forms(self.topology, self.pose, self.curvature_rings));
        let how =
            Displacement { v2: self.v2, v1: forms.as_deref().map(|forms| (forms, self.material)) };
        let mut positions = displace(&fine, &how);
        for places in [&mut positions, &mut fine.base] {
            keep_out(places, self.obstacles.0, self.obstacles.1);
        }
        Wrinkled { fine, positions }
    }

    /// Writes `base.obj`, `wrinkled.obj`, `wrinkled.glb` and `field.json` into `folder`.
    ///
    /// # Errors
    /// [`Error::File`](crate::Error::File) if something cannot be written.
    pub fn write(
        &self,
        folder: &mut OutputFolder,
        field: &WrinkleField,
        wrinkled: &Wrinkled,
        up: Up,
    ) -> Result<()> {
        let refined = self
            .texture
            .clone()
            .map(|coarse| (0..wrinkled.fine.levels).fold(coarse, |t, _| refine_rest(&t.0, &t.1)));
        let coarse = self.texture.as_ref().map(|t| (&t.0[..], &t.1[..]));
        let texture = refined.as_ref().map(|t| (&t.0[..], &t.1[..]));
        let (positions, faces) = (&wrinkled.positions, &wrinkled.fine.topology.faces);
        folder.write("base.obj", |out| obj::write(out, self.pose, &self.topology.faces, coarse))?;
        folder.write("wrinkled.obj", |out| obj::write(out, positions, faces, texture))?;
        let normals = vertex_normals(&wrinkled.fine.topology, positions);
        let mesh = glb::Mesh { positions, normals: &normals, faces, texture };
        folder.write("wrinkled.glb", |out| glb::write(out, &mesh, CLOTH, up))?;
        folder.write("field.json", |out| json::write(out, self.topology, field))
    }
}
