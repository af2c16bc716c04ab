//! A scene solved for a study, and how it is drawn.

use std::sync::Arc;

use plisse::field::{Period, WrinkleField};
use plisse::linalg::Ending;
use plisse::mesh::{Up, Vec3};
use plisse::picture::{Paint, PanelView, Subject, write_png};
use plisse::scene::schema::{MeasureKind, MeasureTable};
use plisse::scene::{self, BuiltScene, Scene, SolvedScene};
use plisse::shell::{BaseReport, ReferenceOptions, ReferenceReport, solve_base, solve_reference};
use plisse::surface::{levels_within, upsample};
use plisse::wrinkles::{PosedField, SurfaceOptions};

use super::stable::StableWatch;
use super::table::{Cell, Illustration, fixed, none};
use super::{Stop, Study};
use crate::outputs::{BASE_SRGB, CLOTH_SRGB, draw_panels_at};

/// Size of a study's pictures (pixels).
const SIZE: (usize, usize) = (960, 720);
/// Most faces of a surface in them: more do not show.
const FACES: usize = 300_000;
/// Roughness of the reference shell's start, in thicknesses.
const IMPERFECTION: f64 = 0.1;

/// Figures of a solved scene for the tables.
pub(crate) trait Figures {
    fn vertices(&self) -> usize;

    /// Most turns around a loop.
    fn around(&self) -> Option<Period>;

    /// Largest amplitude (mm).
    fn peak_mm(&self) -> f64;

    /// Median wavelength (mm) of what wrinkles visibly.
    fn wavelength_mm(&self) -> Cell;

    /// Waves around, as the scene counts them; else most turns around a loop.
    fn waves_around(&self) -> Option<f64>;

    /// The first number that the scene asks for.
    fn measure(&self) -> Option<f64>;
}

impl Figures for SolvedScene {
    fn vertices(&self) -> usize {
        self.pose.len()
    }

    fn around(&self) -> Option<Period> {
        self.field_report.periods.first().copied()
    }

    fn peak_mm(&self) -> f64 {
        peak_mm(&self.field)
    }

    fn wavelength_mm(&self) -> Cell {
        let summary = self.field.wavelengths(&self.built.sheet);
        summary.map_or_else(none, |summary| fixed(1e3 * summary.median, 2))
    }

    fn waves_around(&self) -> Option<f64> {
        let asked = self
            .measures
            .iter()
            .find(|measured| measured.unit == "waves")
            .map(|measured| measured.value);
        asked.or(self.around().map(|period| period.turns as f64))
    }

    fn measure(&self) -> Option<f64> {
        self.measures.first().map(|measured| measured.value)
    }
}

/// Scene 01 with waves counted around half its height, for shells: they have no phase whose turns
/// could be counted.
pub(crate) fn with_waves_at_half_height(mut scene: Scene) -> Scene {
    let panel = &scene.panel[0];
    let (width, height) = (panel.width_m.unwrap_or(1.0), panel.height_m.unwrap_or(1.0));
    scene.measure.push(MeasureTable {
        name: "waves at half height".to_owned(),
        kind: MeasureKind::WavesAlong,
        panel: Some(panel.name.clone()),
        side: None,
        from_m: Some([0.0, 0.5 * height]),
        to_m: Some([width, 0.5 * height]),
        published: None,
        source: None,
    });
    scene
}

/// Largest amplitude (mm).
pub(crate) fn peak_mm(field: &WrinkleField) -> f64 {
    1e3 * field.amplitude_m.iter().copied().fold(0.0, f64::max)
}

impl Study<'_> {
    /// The base surface and the field of a scene.
    pub(crate) fn solve(&self, built: BuiltScene) -> Result<SolvedScene, Stop> {
        let (pose, base) = self.base(&built)?;
        self.solve_on(built, pose, base)
    }

    /// The base surface of a scene.
    pub(crate) fn base(&self, built: &BuiltScene) -> Result<(Vec<Vec3>, BaseReport), Stop> {
        self.one_step(|| solve_base(&built.setup(), &built.start, &built.base_options, self.bars))
    }

    /// The base surface of a scene whose mesh may be fine.
    pub(crate) fn base_of(
        &self,
        scene: &Scene,
        built: &BuiltScene,
    ) -> Result<(Vec<Vec3>, BaseReport), Stop> {
        self.one_step(|| scene::solve_base(scene, built, self.bars))
    }

    /// Runs `solve` and removes its bar. Its result is dropped if the user interrupted it.
    fn one_step<T>(&self, solve: impl FnOnce() -> plisse::Result<T>) -> Result<T, Stop> {
        self.check_interrupted()?;
        let found = solve()?;
        self.bars.finish();
        self.check_interrupted()?;
        Ok(found)
    }

    /// The field of a scene on a base surface.
    pub(crate) fn solve_on(
        &self,
        built: impl Into<Arc<BuiltScene>>,
        pose: Vec<Vec3>,
        base_report: BaseReport,
    ) -> Result<SolvedScene, Stop> {
        self.one_step(|| scene::solve_field(built, pose, base_report, self.bars))
    }

    /// The reference shell of a scene from its base surface, and after how many seconds it was
    /// stable; also if it was interrupted.
    pub(crate) fn shell(
        &mut self,
        built: &BuiltScene,
        base: &[Vec3],
    ) -> Result<(Vec<Vec3>, ReferenceReport, f64), Stop> {
        self.check_interrupted()?;
        let limit = if self.quick { 30 } else { ReferenceOptions::default().iteration_limit };
        let imperfection_m = IMPERFECTION * built.sheet.material.thickness_m;
        let options = ReferenceOptions {
            imperfection_m,
            iteration_limit: limit,
            ..ReferenceOptions::default()
        };
        let watch = StableWatch::new(self.bars);
        let (pose, report) = solve_reference(&built.setup(), base, &options, &watch)?;
        self.bars.finish();
        if matches!(report.ending, Ending::IterationLimit | Ending::Cancelled) {
            let (title, vertices, iterations) = (&built.title, base.len(), report.iterations);
            self.document.notes.push(format!(
                "{title}, reference shell of {vertices} vertices: stopped after {iterations} \
                 iterations"
            ));
        }
        Ok((pose, report, watch.stable_seconds()))
    }

    /// Draws four surfaces of the scene `built` into `name`.png.
    pub(crate) fn picture(
        &mut self,
        name: &str,
        caption: &str,
        built: &BuiltScene,
        looks: &[Look; 4],
    ) -> Result<(), Stop> {
        let spinner = self.bars.spinner("picture");
        let panels = looks.each_ref().map(Look::panel);
        let image = draw_panels_at(&panels, &looks[0].positions, Up::Z, &built.obstacles, SIZE);
        let file = format!("{name}.png");
        self.folder.write(&file, |out| write_png(&image, out))?;
        drop(spinner);
        self.document.pictures.push(Illustration { file, caption: caption.to_owned() });
        Ok(())
    }
}

/// A surface to draw.
pub(crate) struct Look {
    title: String,
    positions: Vec<Vec3>,
    faces: Vec<[usize; 3]>,
    paint: LookPaint,
}

enum LookPaint {
    Mesh,
    Cloth,
    Phase(Vec<[f64; 3]>),
}

impl Look {
    /// A coarse mesh with its edges.
    pub(crate) fn mesh(title: &str, built: &BuiltScene, positions: &[Vec3]) -> Self {
        Self {
            title: title.to_owned(),
            positions: positions.to_vec(),
            faces: built.sheet.topology.faces.clone(),
            paint: LookPaint::Mesh,
        }
    }

    /// A fine mesh.
    pub(crate) fn cloth(title: &str, built: &BuiltScene, positions: &[Vec3]) -> Self {
        Self { paint: LookPaint::Cloth, ..Self::mesh(title, built, positions) }
    }

    /// The surface that `field` wrinkles; `v2`: with the in-plane correction.
    pub(crate) fn wrinkled(
        title: &str,
        built: &BuiltScene,
        pose: &[Vec3],
        field: &WrinkleField,
        v2: bool,
    ) -> Self {
        let clearance_m = 0.5 * built.sheet.material.thickness_m;
        let posed = built.posed_field(pose, field);
        let options = SurfaceOptions { v1: false, v2, ..posed.options };
        let wrinkled = PosedField { options, clearance_m, ..posed }.surface(levels(built, field));
        Self {
            title: title.to_owned(),
            positions: wrinkled.positions,
            faces: wrinkled.fine.topology.faces,
            paint: LookPaint::Cloth,
        }
    }

    /// The phase on the base surface.
    pub(crate) fn phase(
        title: &str,
        built: &BuiltScene,
        pose: &[Vec3],
        field: &WrinkleField,
    ) -> Self {
        let fine = upsample(&built.sheet, pose, field, levels(built, field));
        let corners = fine.visible_phase();
        Self {
            title: title.to_owned(),
            positions: fine.base,
            faces: fine.topology.faces,
            paint: LookPaint::Phase(corners),
        }
    }

    fn panel(&self) -> PanelView<'_> {
        let paint = match &self.paint {
            LookPaint::Mesh => Paint::Plain { colour: BASE_SRGB, wireframe: true },
            LookPaint::Cloth => Paint::Plain { colour: CLOTH_SRGB, wireframe: false },
            LookPaint::Phase(corners) => Paint::Phase { corners },
        };
        PanelView {
            title: &self.title,
            subject: Subject { positions: &self.positions, faces: &self.faces },
            paint,
        }
    }
}

/// Subdivisions that show the wrinkles.
fn levels(built: &BuiltScene, field: &WrinkleField) -> usize {
    built.posed_field(&[], field).levels().min(levels_within(&built.sheet.topology, FACES))
}
