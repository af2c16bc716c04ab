//! A pose with its wrinkles as the files that are taken away: the one road from a solved field to
//! `base.obj`, `wrinkled.obj`, `wrinkled.glb` and `field.json`, for everyone who writes them.

use crate::Result;
use crate::field::curvature::second_forms;
use crate::field::{WrinkleField, json};
use crate::io::staged::OutputFolder;
use crate::io::{glb, obj};
use crate::mesh::normals::vertex_normals;
use crate::mesh::{Chart, Up, Vec3};
use crate::obstacle::Obstacle;
use crate::picture::CLOTH;
use crate::sheet::Sheet;
use crate::surface::{
    Displacement, FirstCorrection, Upsampled, displace, keep_out, suggest_levels, upsample,
};

/// A base surface in the pose in which it wrinkles.
#[derive(Clone, Debug)]
pub struct Posed<'a> {
    /// The sheet.
    pub sheet: &'a Sheet,
    /// `[V]` positions (m).
    pub pose: &'a [Vec3],
    /// Rings of neighbours that curvature is fitted to, for v₁.
    pub curvature_rings: usize,
    /// Subdivisions asked for; `None`: as many as the wavelength asks for.
    pub levels: Option<usize>,
    /// Whether to displace by v₁.
    pub v1: bool,
    /// Whether to displace by v₂.
    pub v2: bool,
    /// Bodies that the wrinkles stay out of.
    pub obstacles: &'a [Obstacle],
    /// Distance (m) that they keep.
    pub clearance_m: f64,
    /// Texture coordinates (v up).
    pub texture: Option<Chart>,
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
        let median_m = || field.wavelengths(self.sheet).map(|summary| summary.median);
        self.levels.unwrap_or_else(|| suggest_levels(self.sheet, median_m()))
    }

    /// The surface with the wrinkles of `field`, divided `levels` times.
    pub fn wrinkle(&self, field: &WrinkleField, levels: usize) -> Wrinkled {
        let Sheet { topology, material, .. } = self.sheet;
        let mut fine = upsample(self.sheet, self.pose, field, levels);
        let forms = self.v1.then(|| second_forms(topology, self.pose, self.curvature_rings));
        let v1 = forms.as_deref().map(|second_forms| FirstCorrection { second_forms, material });
        let how = Displacement { v2: self.v2, v1 };
        let mut positions = displace(&fine, &how);
        for places in [&mut positions, &mut fine.base] {
            keep_out(places, self.obstacles, self.clearance_m);
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
        let topology = &self.sheet.topology;
        let coarse = self.texture.as_ref();
        let refined = coarse.map(|chart| chart.refined(wrinkled.fine.levels));
        let texture = refined.as_ref();
        let (positions, faces) = (&wrinkled.positions, &wrinkled.fine.topology.faces);
        folder.write("base.obj", |out| obj::write(out, self.pose, &topology.faces, coarse))?;
        folder.write("wrinkled.obj", |out| obj::write(out, positions, faces, texture))?;
        let normals = vertex_normals(&wrinkled.fine.topology, positions);
        let mesh = glb::Mesh { positions, normals: &normals, faces, texture };
        folder.write("wrinkled.glb", |out| glb::write(out, &mesh, CLOTH, up))?;
        folder.write("field.json", |out| json::write(out, topology, field))
    }
}
