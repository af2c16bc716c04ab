//! Physics: a scene's material and clamps, solved in the background.

use std::sync::Arc;

use egui::{Button, ComboBox, DragValue, ProgressBar, RichText, Ui};
use plisse::mesh::Vec3;

use super::plots;
use crate::document::scene_edit::{Draft, Edit};
use crate::document::{SceneText, Subject};
use crate::fabrics::FABRICS;
use crate::studio::{Looking, Studio};
use crate::view::Solid;
use crate::work::job::{Job, News, Progress};
use crate::work::solve::{Part, SolvedScene, run};

/// A scene's solve, and what came of it.
#[derive(Default)]
pub struct Physics {
    job: Option<Job<Part>>,
    /// What is to be seen.
    solid: Option<Arc<Solid>>,
    /// `[V]` places (m) that the next solve goes on from.
    pose: Option<Arc<Vec<Vec3>>>,
    /// The last whole solution.
    pub solved: Option<Arc<SolvedScene>>,
    /// How the last solve went.
    progress: Progress,
    /// A changed scene on its way to a surface.
    draft: Option<(Draft, Job<SceneText>)>,
    /// Whether it is solved then.
    solves: bool,
    /// Solve again when something is changed.
    pub follow: bool,
}

impl Physics {
    /// What is to be seen, if anything was solved.
    pub fn solid(&self) -> Option<Arc<Solid>> {
        self.solid.clone()
    }

    /// Whether a solve, or a changed scene, is on its way.
    pub fn is_busy(&self) -> bool {
        self.job.is_some() || self.draft.is_some()
    }

    /// Forgets everything.
    pub fn stop(&mut self) {
        *self = Self { follow: self.follow, ..Self::default() };
    }
}

impl Studio {
    /// Solves the scene, from where it was, or stops.
    pub fn solve_or_stop(&mut self) {
        if let Some(job) = &self.physics.job {
            job.cancel();
        } else {
            self.solve();
        }
    }

    fn solve(&mut self) {
        let Some(scene) = &self.document.subject.scene else {
            self.messages.problem(
                "solve: this model came from no scene; open a scene file (.toml) for that",
            );
            return;
        };
        if self.physics.draft.is_some() {
            self.physics.solves = true;
            return;
        }
        let (built, start) = (Arc::clone(&scene.built), self.physics.pose.clone());
        let wake = Arc::clone(&self.wake);
        let work = move |reporter: &crate::work::job::Reporter<Part>| {
            run(&built, start.as_ref().map(|p| &p[..]), reporter)
        };
        self.physics.progress = Progress::default();
        self.physics.job = Some(Job::start("solve", move || wake(), work));
    }

    /// Takes what the jobs have made.
    pub(crate) fn take_jobs(&mut self) {
        self.take_draft();
        self.take_solve();
        self.take_growth();
        self.take_taken();
        self.take_read();
    }

    fn take_solve(&mut self) {
        let Some(job) = &self.physics.job else { return };
        let (news, cancelled) = (job.take(), job.is_cancelled());
        self.physics.progress = job.progress();
        for news in news {
            match news {
                News::Part(Part::Pose(solid, pose)) => {
                    (self.physics.solid, self.physics.pose) = (Some(solid), Some(pose));
                    self.looking = Looking::Solved;
                }
                News::Part(Part::Whole(..)) => {}
                News::Done(done) => {
                    self.physics.job = None;
                    match done {
                        Ok(Part::Whole(solid, solved)) => {
                            self.physics.pose = Some(Arc::new(solved.pose.clone()));
                            self.physics.solid = Some(solid);
                            self.looking = Looking::Solved;
                            let text = format!(
                                "solved: {} iterations of the field, energy {:.4e} J",
                                solved.report.iterations, solved.report.energy_joule
                            );
                            self.messages.note(if cancelled {
                                "stopped: this is the best state so far, not a solution".into()
                            } else {
                                text
                            });
                            self.physics.solved = Some(solved);
                        }
                        Ok(Part::Pose(..)) => {}
                        Err(error) => self.messages.problem(error),
                    }
                }
            }
        }
    }

    /// Changes the scene, whose surface is then made anew in the background; what cannot be becomes
    /// a message, and the scene stays.
    pub fn edit_scene(&mut self, edit: &Edit) {
        let Some(scene) = &self.document.subject.scene else { return };
        let draft = self
            .physics
            .draft
            .as_ref()
            .map_or_else(|| Draft::of(scene), |(draft, _)| draft.clone());
        match draft.with(edit) {
            Ok(draft) => {
                let (wake, built) = (Arc::clone(&self.wake), draft.clone());
                let job = Job::start("scene", move || wake(), move |_| built.build());
                self.physics.draft = Some((draft, job));
            }
            Err(error) => self.messages.problem(error),
        }
    }

    fn take_draft(&mut self) {
        let Some((_, job)) = &self.physics.draft else { return };
        for news in job.take() {
            let News::Done(done) = news else { continue };
            self.physics.draft = None;
            match done {
                Ok(scene) => {
                    let subject =
                        Subject { scene: Some(scene), ..(*self.document.subject).clone() };
                    self.document.subject = Arc::new(subject);
                    self.document.revision += 1;
                    self.physics.solved = None;
                    if let Some(job) = &self.physics.job {
                        job.cancel();
                        self.physics.job = None;
                    }
                    if std::mem::take(&mut self.physics.solves) || self.physics.follow {
                        self.solve();
                    }
                }
                Err(error) => {
                    self.physics.solves = false;
                    self.messages.problem(error);
                }
            }
            return;
        }
    }

    pub(crate) fn physics_panel(&mut self, ui: &mut Ui) {
        let draft = self.physics.draft.as_ref().map(|(draft, _)| draft.scene.clone());
        let Some(scene) =
            draft.or_else(|| self.document.subject.scene.as_ref().map(|s| s.scene.clone()))
        else {
            ui.label(
                "The solver takes scenes: panels or garments that are sewn, held and pushed. \
                Open a scene file (.toml); those of Plissé lie in the folder examples.",
            );
            return;
        };
        ui.label(RichText::new(&scene.title).strong());
        ui.heading("Material");
        let material = &scene.material;
        let named = FABRICS.iter().find(|f| {
            (f.young_pa, f.poisson, f.thickness_m)
                == (material.young_pa, material.poisson, material.thickness_m)
        });
        let mut edit = None;
        ComboBox::from_label("sheet")
            .selected_text(named.map_or("own constants", |f| f.name))
            .width(230.0)
            .show_ui(ui, |ui| {
                for fabric in &FABRICS {
                    if ui
                        .selectable_label(Some(fabric) == named, fabric.name)
                        .on_hover_text(fabric.source)
                        .clicked()
                    {
                        edit = Some(Edit::fabric(fabric));
                    }
                }
            });
        if let Some(fabric) = named {
            ui.label(RichText::new(format!("Source: {}", fabric.source)).small());
        }
        // Only what is changed goes to the scene: nothing else takes the way through other units
        // and back.
        let (mut young_mpa, mut poisson, mut thickness_mm) =
            (material.young_pa * 1e-6, material.poisson, material.thickness_m * 1e3);
        let (mut next, mut changed) = (*material, false);
        if number(
            ui,
            "Young's modulus",
            " MPa",
            &mut young_mpa,
            0.02e-6 * material.young_pa,
            "resistance against being stretched (MPa)",
        ) {
            (next.young_pa, changed) = (young_mpa * 1e6, true);
        }
        let tip = "how much it narrows when it is stretched, above −1 and up to 0.5";
        if number(ui, "Poisson's ratio", "", &mut poisson, 0.005, tip) {
            (next.poisson, changed) = (poisson, true);
        }
        if number(
            ui,
            "thickness",
            " mm",
            &mut thickness_mm,
            20.0 * material.thickness_m,
            "thickness of the sheet (mm)",
        ) {
            (next.thickness_m, changed) = (thickness_mm * 1e-3, true);
        }
        if let Some(density) = &mut next.density_kg_m3 {
            changed |=
                number(ui, "density", " kg/m³", density, 2.0, "needed where gravity pulls (kg/m³)");
        }
        if changed {
            let (young_pa, poisson, thickness_m) = (next.young_pa, next.poisson, next.thickness_m);
            edit = Some(Edit::Material {
                young_pa,
                poisson,
                thickness_m,
                density_kg_m3: next.density_kg_m3,
            });
        }
        ui.add_space(4.0);
        ui.heading("Clamps");
        for (n, clamp) in scene.clamp.iter().enumerate() {
            let name = clamp
                .side
                .clone()
                .or_else(|| {
                    clamp.near_m.map(|p| format!("near {:.2} {:.2} {:.2}", p[0], p[1], p[2]))
                })
                .unwrap_or_else(|| "in a box".into());
            ui.push_id(n, |ui| {
                ui.label(format!("{n}: {name}"));
                let mut by = clamp.move_m;
                ui.horizontal(|ui| {
                    let mut any = false;
                    for (axis, x) in ["x ", "y ", "z "].into_iter().zip(&mut by) {
                        let field = DragValue::new(x)
                            .speed(0.002)
                            .prefix(axis)
                            .suffix(" m")
                            .max_decimals(4);
                        any |= ui
                            .add(field)
                            .on_hover_text("how far it is moved from the start (m)")
                            .changed();
                    }
                    if any {
                        edit = Some(Edit::ClampMove(n, by));
                    }
                });
                if let Some(turn) = clamp.turn {
                    let mut angle = turn.angle_deg;
                    if number(
                        ui,
                        "turned by",
                        "°",
                        &mut angle,
                        0.2,
                        "angle about the scene's axis (degrees)",
                    ) {
                        edit = Some(Edit::ClampTurn(n, angle));
                    }
                }
            });
        }
        if scene.load.pressure_pa != 0.0 {
            let (mut pressure, speed) =
                (scene.load.pressure_pa, 0.02 * scene.load.pressure_pa.abs());
            if number(
                ui,
                "pressure",
                " Pa",
                &mut pressure,
                speed,
                "inside, above that outside (Pa)",
            ) {
                edit = Some(Edit::Pressure(pressure));
            }
        }
        if let Some(edit) = edit {
            self.edit_scene(&edit);
        }
        ui.add_space(4.0);
        ui.heading("Solve");
        ui.checkbox(&mut self.physics.follow, "solve again when something changes")
            .on_hover_text("from where it was");
        let busy = self.physics.job.is_some();
        ui.horizontal(|ui| {
            let warm = if self.physics.pose.is_some() { "Go on" } else { "Solve" };
            if ui
                .add(Button::new(if busy { "Stop" } else { warm }))
                .on_hover_text("Ctrl+Enter")
                .clicked()
            {
                self.solve_or_stop();
            }
            if ui
                .add_enabled(!busy && self.physics.pose.is_some(), Button::new("From the start"))
                .on_hover_text("forgets where it was")
                .clicked()
            {
                self.physics.pose = None;
                self.solve();
            }
        });
        progress(ui, &self.physics.progress, busy);
        if let Some(solved) = &self.physics.solved {
            let field = &solved.report;
            ui.label(format!(
                "base: {} iterations in {:.2} s",
                solved.base.iterations, solved.base.seconds
            ));
            ui.label(format!(
                "field: {} iterations in {:.2} s",
                field.iterations,
                field.field_seconds + field.phase_seconds
            ));
            let most = solved.field.amplitude_m.iter().copied().fold(0.0, f64::max);
            ui.label(format!(
                "energy {:.5e} J, largest amplitude {:.3} mm",
                field.energy_joule,
                1e3 * most
            ));
            for m in &solved.measures {
                let published =
                    m.published.map_or_else(String::new, |p| format!(" (published: {p})"));
                let value = if m.unit == "m" {
                    format!("{:.3} mm", 1e3 * m.value)
                } else {
                    format!("{:.2} {}", m.value, m.unit)
                };
                ui.label(format!("{}: {value}{published}", m.name));
            }
        }
    }
}

/// How a job goes, and its plot.
pub(crate) fn progress(ui: &mut Ui, progress: &Progress, busy: bool) {
    if busy {
        let residual = progress.steps.last().map_or(0.0, |s| s.2.max(1.0).log10() as f32);
        let first = progress.steps.iter().map(|s| s.2).fold(1.0, f64::max).log10() as f32;
        let share = progress.share.unwrap_or(0.0).max(0.02)
            + if first > 0.0 {
                0.4 * (1.0 - residual / first) * (1.0 - progress.share.unwrap_or(0.0))
            } else {
                0.0
            };
        ui.add(ProgressBar::new(share.clamp(0.0, 1.0)).text(progress.stage.clone()));
    }
    plots::convergence(ui, progress);
}

fn number(ui: &mut Ui, name: &str, unit: &str, value: &mut f64, speed: f64, tip: &str) -> bool {
    ui.horizontal(|ui| {
        let field = DragValue::new(value).speed(speed.max(1e-6)).suffix(unit).max_decimals(6);
        let changed = ui.add(field).on_hover_text(tip).changed();
        ui.label(name).on_hover_text(tip);
        changed
    })
    .inner
}
