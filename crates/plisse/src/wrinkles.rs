//! A wrinkle field on a pose of a sheet: its fine surface, its maps and its files. Every program
//! that writes `base.obj`, `wrinkled.obj`, `wrinkled.glb` and `field.json` does it here.

use std::path::{Path, PathBuf};

use crate::bake::{self, Baked, Surface, field_sampler};
use crate::field::curvature::second_forms;
use crate::field::{self, FieldOptions, FieldReport, Solved, WrinkleField, json};
use crate::io::staged::OutputFolder;
use crate::io::{glb, obj};
use crate::mesh::islands::panel_texture;
use crate::mesh::normals::vertex_normals;
use crate::mesh::{Chart, Topology, Up, Vec3};
use crate::obstacle::Obstacle;
use crate::picture::CLOTH;
use crate::progress::{Observer, Silent};
use crate::sheet::Sheet;
use crate::surface::{
    Displacement, FirstCorrection, MOST_FACES, Upsampled, displace, keep_out, levels_within,
    suggest_levels, upsample,
};
use crate::{Error, Result};

/// Texels by which the islands of a map are grown, so that filtering meets no background.
const PADDING: usize = 8;

/// Options of the fine surface.
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

/// A wrinkle field on a pose of a sheet, with the options of its surface.
#[derive(Clone, Debug)]
pub struct PosedField<'a> {
    /// The sheet.
    pub sheet: &'a Sheet,
    /// `[V]` positions (m).
    pub pose: &'a [Vec3],
    /// The field.
    pub field: &'a WrinkleField,
    /// Options of its surface.
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

impl WrinkledSurface {
    /// `[F][3]` vertices of each face.
    pub fn faces(&self) -> &[[usize; 3]] {
        &self.fine.topology.faces
    }

    /// `[V]` unit normals of the wrinkled surface.
    pub fn normals(&self) -> Vec<Vec3> {
        vertex_normals(&self.fine.topology, &self.positions)
    }
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

    /// Writes `base.obj`, `wrinkled.obj`, `wrinkled.glb` and `field.json` into `folder`. `up` is
    /// the axis of the pose that points up.
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

/// Wrinkles of a sheet in a pose, as [`Sheet::wrinkle`] makes them.
#[derive(Clone, Debug)]
pub struct Wrinkles<'a> {
    /// The sheet.
    pub sheet: &'a Sheet,
    /// `[V]` positions (m).
    pub pose: &'a [Vec3],
    /// The field.
    pub field: WrinkleField,
    /// Report of its solve.
    pub report: FieldReport,
    /// Options of its surface.
    pub options: SurfaceOptions,
    /// Texture coordinates (v up): at first those of a flat rest shape, its panels side by side.
    pub texture: Option<Chart>,
    /// Axis of the pose that points up, for GLB files.
    pub up: Up,
}

impl Sheet {
    /// The wrinkles of the sheet in `pose` (`[V]`, m), with nothing held and default options.
    ///
    /// ```
    /// use plisse::prelude::*;
    ///
    /// // A strip of 20 × 4 squares of 1 cm, pressed together by 2 % along x.
    /// let at = |v: usize| Vec3::new(0.01 * (v % 21) as f64, 0.01 * (v / 21) as f64, 0.0);
    /// let rest: Vec<Vec3> = (0..105).map(at).collect();
    /// let squares = (0..84).filter(|v| v % 21 != 20);
    /// let faces = squares.flat_map(|v| [[v, v + 1, v + 22], [v, v + 22, v + 21]]).collect();
    /// let pose: Vec<Vec3> = rest.iter().map(|p| Vec3::new(0.98 * p.x, p.y, 0.0)).collect();
    ///
    /// let sheet = Sheet::from_rest(rest, faces, Material::new(1e6, 0.3, 1e-4)?)?;
    /// let wrinkles = sheet.wrinkle(&pose)?;
    /// assert!(wrinkles.field.largest_amplitude_m() > 1e-4);
    /// let surface = wrinkles.surface(None);
    /// assert_eq!(surface.positions.len(), surface.normals().len());
    /// # Ok::<(), plisse::Error>(())
    /// ```
    ///
    /// # Errors
    /// Those of [`field::solve`].
    pub fn wrinkle<'a>(&'a self, pose: &'a [Vec3]) -> Result<Wrinkles<'a>> {
        self.wrinkle_with(pose, &vec![false; pose.len()], &FieldOptions::default(), &Silent)
    }

    /// As [`Sheet::wrinkle`], with zero amplitude at the `held` vertices (`[V]`).
    ///
    /// # Errors
    /// Those of [`field::solve`].
    pub fn wrinkle_with<'a>(
        &'a self,
        pose: &'a [Vec3],
        held: &[bool],
        options: &FieldOptions,
        observer: &dyn Observer,
    ) -> Result<Wrinkles<'a>> {
        let Solved { field, report } = field::solve(self, pose, held, options, observer)?;
        let curvature_rings = options.curvature_rings;
        Ok(Wrinkles {
            sheet: self,
            pose,
            field,
            report,
            options: SurfaceOptions { curvature_rings, ..SurfaceOptions::default() },
            texture: panel_texture(&self.rest_shape),
            up: Up::default(),
        })
    }
}

impl Wrinkles<'_> {
    /// The field on its pose, to be displaced and written; no bodies are in its way.
    pub fn posed_field(&self) -> PosedField<'_> {
        PosedField {
            sheet: self.sheet,
            pose: self.pose,
            field: &self.field,
            options: self.options,
            obstacles: &[],
            clearance_m: 0.0,
            texture: self.texture.clone(),
        }
    }

    /// The wrinkled surface, divided `levels` times; `None`: as often as the options say, or else
    /// as the wavelength asks for.
    pub fn surface(&self, levels: impl Into<Option<usize>>) -> WrinkledSurface {
        let posed = self.posed_field();
        posed.surface(levels.into().unwrap_or_else(|| posed.levels()))
    }

    /// Height and normal maps of `size` × `size` texels.
    ///
    /// # Errors
    /// [`Error::Value`] without texture coordinates; those of [`bake::bake`].
    pub fn bake(&self, size: usize) -> Result<Baked> {
        let Some(texture) = &self.texture else {
            let message = "the sheet has no texture coordinates to bake into; set them";
            return Err(Error::value("texture", message));
        };
        let options = bake::Options { size, padding: PADDING };
        bake_field(&self.sheet.topology, self.pose, texture, &self.field, &options)
    }

    /// Writes `base.obj`, `wrinkled.obj`, `wrinkled.glb` and `field.json` into `folder`; returns
    /// their paths.
    ///
    /// # Errors
    /// [`Error::File`] if something cannot be written.
    pub fn save(&self, folder: &Path) -> Result<Vec<PathBuf>> {
        let mut output = OutputFolder::create(folder)?;
        self.posed_field().write(&mut output, &self.surface(None), self.up)?;
        output.commit()
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
