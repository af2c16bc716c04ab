//! A scene solved, from its start to its wrinkle field: build, base surface, field, measures.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::base::{base_notes, solve_base};
use super::build::{BuiltScene, build};
use super::measure::{Measured, measure};
use super::schema::Scene;
use crate::field::{self, FieldReport, WrinkleField};
use crate::io::staged::OutputFolder;
use crate::mesh::{Up, Vec3};
use crate::progress::Observer;
use crate::shell::BaseReport;
use crate::wrinkles::{PosedField, WrinkledSurface};
use crate::{At, Result};

/// Options of a solve beside those of the scene file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SolveOptions {
    /// Subdivisions of the wrinkled surface; `None`: those of the scene.
    pub levels: Option<usize>,
    /// Names of terms and corrections to leave out of the field's energy, beside those of the
    /// scene; see [`FieldOptions::without`](crate::field::FieldOptions::without).
    pub without: Vec<String>,
}

/// A scene with its base surface and its wrinkle field.
#[derive(Clone, Debug)]
pub struct SolvedScene {
    /// The scene as it was solved.
    pub built: Arc<BuiltScene>,
    /// `[V]` base surface (m).
    pub pose: Vec<Vec3>,
    /// Report of the base solve.
    pub base_report: BaseReport,
    /// The field.
    pub field: WrinkleField,
    /// Report of the field's solve.
    pub field_report: FieldReport,
    /// The measures of the scene, in its order.
    pub measures: Vec<Measured>,
    /// Notes for the user, a sentence each.
    pub notes: Vec<String>,
}

/// Builds and solves `scene`.
///
/// ```
/// use plisse::progress::Silent;
/// use plisse::scene::{SolveOptions, parse, solve};
///
/// let text = r#"
///     title = "a strip, pulled"
///     material = { young_pa = 1e6, poisson = 0.5, thickness_m = 1e-4 }
///     panel = [{ name = "p", shape = "rectangle", width_m = 0.3, height_m = 0.1,
///                edge_length_m = 0.03 }]
///     clamp = [{ side = "p.left" }, { side = "p.right", move_m = [0.02, 0.0, 0.0] }]
/// "#;
/// let scene = parse("strip.toml", text)?;
/// let solved = solve(&scene, &SolveOptions::default(), &Silent)?;
/// assert_eq!(solved.pose.len(), solved.field.amplitude_m.len());
/// # Ok::<(), plisse::Error>(())
/// ```
///
/// # Errors
/// Those of [`build_with`], [`solve_base`] and [`field::solve`].
pub fn solve(
    scene: &Scene,
    options: &SolveOptions,
    observer: &dyn Observer,
) -> Result<SolvedScene> {
    solve_built(scene, build_with(scene, options)?, observer)
}

/// The scene ready for the solvers, with `options`.
///
/// # Errors
/// Those of [`build`]; [`Error::Value`](crate::Error::Value) about "without" for an unknown name,
/// and about "levels", or the scene's `surface.levels`, for a surface of too many faces.
pub fn build_with(scene: &Scene, options: &SolveOptions) -> Result<BuiltScene> {
    let mut built = build(scene)?;
    for name in &options.without {
        built.field_options = built.field_options.without(name)?;
    }
    let topology = &built.sheet.topology;
    if options.levels.is_some() {
        built.surface_options.levels = options.levels;
        built.surface_options.check(topology)?;
    } else {
        let checked = built.surface_options.check(topology);
        checked.map_err(|error| error.about("surface.levels")).at(&scene.file)?;
    }
    Ok(built)
}

/// Solves `scene`, which was built to `built`.
///
/// # Errors
/// Those of [`solve_base`] and [`field::solve`].
pub fn solve_built(
    scene: &Scene,
    built: impl Into<Arc<BuiltScene>>,
    observer: &dyn Observer,
) -> Result<SolvedScene> {
    let built = built.into();
    let (pose, base_report) = solve_base(scene, &built, observer)?;
    solve_field(built, pose, base_report, observer)
}

/// Solves the field of `built` over its base surface `pose` (`[V]`, m).
///
/// # Errors
/// Those of [`field::solve`].
pub fn solve_field(
    built: impl Into<Arc<BuiltScene>>,
    pose: Vec<Vec3>,
    base_report: BaseReport,
    observer: &dyn Observer,
) -> Result<SolvedScene> {
    let built = built.into();
    let held = built.clamps.held();
    let solved = field::solve(&built.sheet, &pose, &held, &built.field_options, observer)?;
    let measures = measure(&built, &solved.field, &solved.report);
    let notes = built.notes.iter().cloned().chain(base_notes(&base_report)).collect();
    Ok(SolvedScene {
        built,
        pose,
        base_report,
        field: solved.field,
        field_report: solved.report,
        measures,
        notes,
    })
}

impl SolvedScene {
    /// The field on the base surface, to be displaced and written.
    pub fn posed_field(&self) -> PosedField<'_> {
        self.built.posed_field(&self.pose, &self.field)
    }

    /// The wrinkled surface, divided `levels` times; `None`: as often as the scene says, or else as
    /// the wavelength asks for.
    pub fn surface(&self, levels: Option<usize>) -> WrinkledSurface {
        let posed = self.posed_field();
        posed.surface(levels.unwrap_or_else(|| posed.levels()))
    }

    /// Writes `base.obj`, `wrinkled.obj`, `wrinkled.glb` and `field.json` into `folder`.
    ///
    /// # Errors
    /// [`Error::File`](crate::Error::File) if something cannot be written.
    pub fn write(&self, folder: &mut OutputFolder) -> Result<()> {
        self.posed_field().write(folder, &self.surface(None), Up::Z)
    }

    /// Writes the files of [`SolvedScene::write`] into the folder at `path`; returns their paths.
    ///
    /// # Errors
    /// [`Error::File`](crate::Error::File) if something cannot be written.
    pub fn save(&self, path: &Path) -> Result<Vec<PathBuf>> {
        let mut folder = OutputFolder::create(path)?;
        self.write(&mut folder)?;
        folder.commit()
    }
}
