//! A wrinkle field on a pose of a sheet: its fine surface, its maps and its files. Every program
//! that writes `base.obj`, `wrinkled.obj`, `wrinkled.glb` and `field.json` does it here.

use crate::bake::{self, Baked, Surface, field_sampler};
use crate::field::curvature::second_forms;
use crate::field::{FieldOptions, WrinkleField, json};
use crate::io::staged::OutputFolder;
use crate::io::{glb, obj};
use crate::mesh::normals::vertex_normals;
use crate::mesh::{Chart, Topology, Up, Vec3};
use crate::obstacle::Obstacle;
use crate::picture::CLOTH;
use crate::sheet::Sheet;
use crate::surface::{
    Displacement, FirstCorrection, MOST_FACES, Upsampled, displace, keep_out, levels_within,
    suggest_levels, upsample,
};
use crate::{Error, Result};

/// How the fine surface is made from a field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceOptions {
    /// Number of subdivisions; `None`: as many as the wavelength asks for.
    pub levels: Option<usize>,
    /// True if the surface is displaced by the in-plane correction v₁, too.
    pub v1: bool,
    /// True if the surface is displaced by the in-plane correction v₂, too.
    pub v2: bool,
    /// Rings of neighbours that curvature is fitted to, for v₁.
    pub curvature_rings: usize,
}

impl Default for SurfaceOptions {
    fn default() -> Self {
        let curvature_rings = FieldOptions::default().curvature_rings;
        Self { levels: None, v1: false, v2: true, curvature_rings }
    }
}

impl SurfaceOptions {
    /// Refuses more levels than a surface of [`MOST_FACES`] faces has.
    ///
    /// # Errors
    /// [`Error::Value`] about "levels".
    pub fn check(&self, topology: &Topology) -> Result<()> {
        let most = levels_within(topology, MOST_FACES);
        match self.levels {
            Some(levels) if levels > most => {
                let message = format!(
                    "{levels} levels would make more than {MOST_FACES} faces of {}; ask for {most} \
                     or fewer",
                    topology.face_count()
                );
                Err(Error::value("levels", message))
            }
            _ => Ok(()),
        }
    }
}

/// A wrinkle field on a pose of a sheet, and how its surface is made.
#[derive(Clone, Debug)]
pub struct PosedField<'a> {
    /// The sheet.
    pub sheet: &'a Sheet,
    /// `[V]` positions (m).
    pub pose: &'a [Vec3],
    /// The field.
    pub field: &'a WrinkleField,
    /// How its surface is made.
    pub options: SurfaceOptions,
    /// Bodies that the wrinkles stay out of.
    pub obstacles: &'a [Obstacle],
    /// Distance (m) that they keep.
    pub clearance_m: f64,
    /// Texture coordinates (v up).
    pub texture: Option<Chart>,
}

/// A wrinkled surface.
#[derive(Clone, Debug)]
pub struct WrinkledSurface {
    /// The divided base surface, kept out of bodies like its wrinkles.
    pub fine: Upsampled,
    /// `[V]` positions (m) with the wrinkles.
    pub positions: Vec<Vec3>,
}

impl PosedField<'_> {
    /// Subdivisions asked for, else those that the wavelength asks for.
    pub fn levels(&self) -> usize {
        let median_m = || self.field.wavelengths(self.sheet).map(|summary| summary.median);
        self.options.levels.unwrap_or_else(|| suggest_levels(self.sheet, median_m()))
    }

    /// The surface with its wrinkles, divided `levels` times.
    pub fn surface(&self, levels: usize) -> WrinkledSurface {
        let Sheet { topology, material, .. } = self.sheet;
        let SurfaceOptions { v1, v2, curvature_rings, .. } = self.options;
        let mut fine = upsample(self.sheet, self.pose, self.field, levels);
        let forms = v1.then(|| second_forms(topology, self.pose, curvature_rings));
        let v1 = forms.as_deref().map(|second_forms| FirstCorrection { second_forms, material });
        let mut positions = displace(&fine, &Displacement { v2, v1 });
        for places in [&mut positions, &mut fine.base] {
            keep_out(places, self.obstacles, self.clearance_m);
        }
        WrinkledSurface { fine, positions }
    }

    /// Writes `base.obj`, `wrinkled.obj`, `wrinkled.glb` and `field.json` into `folder`. `up` is the
    /// axis of the pose that points up.
    ///
    /// # Errors
    /// [`Error::File`] if something cannot be written.
    pub fn write(
        &self,
        folder: &mut OutputFolder,
        surface: &WrinkledSurface,
        up: Up,
    ) -> Result<()> {
        let topology = &self.sheet.topology;
        let coarse = self.texture.as_ref();
        let refined = coarse.map(|chart| chart.refined(surface.fine.levels));
        let texture = refined.as_ref();
        let (positions, faces) = (&surface.positions, &surface.fine.topology.faces);
        folder.write("base.obj", |out| obj::write(out, self.pose, &topology.faces, coarse))?;
        folder.write("wrinkled.obj", |out| obj::write(out, positions, faces, texture))?;
        let normals = vertex_normals(&surface.fine.topology, positions);
        let mesh = glb::Mesh { positions, normals: &normals, faces, texture };
        folder.write("wrinkled.glb", |out| glb::write(out, &mesh, CLOTH, up))?;
        folder.write("field.json", |out| json::write(out, topology, self.field))
    }
}

/// Height and normal maps of `field` on a pose (`[V]`, m) of a surface with texture coordinates.
///
/// # Errors
/// Those of [`bake::bake`].
pub fn bake_field(
    topology: &Topology,
    pose: &[Vec3],
    texture: &Chart,
    field: &WrinkleField,
    options: &bake::Options,
) -> Result<Baked> {
    let normals = vertex_normals(topology, pose);
    let surface = Surface {
        positions: pose,
        normals: &normals,
        faces: &topology.faces,
        uvs: &texture.points,
        uv_faces: &texture.faces,
    };
    bake::bake(&surface, field_sampler(topology, pose, field), options)
}
