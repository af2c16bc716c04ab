//! The solve of a scene, and edits of its text.

use std::sync::Arc;

use plisse::mesh::Vec3;
use plisse::scene::SolvedScene;

use crate::document::scene_edit::{Draft, Edit};
use crate::document::{Document, SceneText, Subject};
use crate::messages::Messages;
use crate::shell::Shell;
use crate::view::Solid;
use crate::viewport::{ShownSurface, Viewport};
use crate::work::job::{Job, News, Progress, Reporter};
use crate::work::solve::{Part, run};

/// A scene's solve and its result.
#[derive(Default)]
pub struct Physics {
    job: Option<Job<Part>>,
    solid: Option<Arc<Solid>>,
    /// `[V]` positions (m) that the next solve starts from.
    pose: Option<Arc<Vec<Vec3>>>,
    /// The last complete solution.
    pub solved: Option<Arc<SolvedScene>>,
    progress: Progress,
    /// An edited scene that is being built.
    draft: Option<BuildingDraft>,
    /// True if the edited scene is to be solved once it is built.
    solves_draft: bool,
    /// True if the scene is solved again whenever it is edited.
    pub follow: bool,
}

/// An edited scene, and the job that builds it.
struct BuildingDraft {
    draft: Draft,
    job: Job<SceneText>,
}

impl Physics {
    /// The surface to show, if anything was solved.
    pub fn solid(&self) -> Option<Arc<Solid>> {
        self.solid.clone()
    }

    /// The edited scene that is being built.
    pub(crate) fn draft(&self) -> Option<&Draft> {
        self.draft.as_ref().map(|building| &building.draft)
    }

    /// Progress of the last solve.
    pub(crate) fn progress(&self) -> &Progress {
        &self.progress
    }

    /// True while a scene is being built or solved.
    pub fn is_busy(&self) -> bool {
        self.job.is_some() || self.draft.is_some()
    }

    /// True while a scene is being solved.
    pub(crate) fn is_solving(&self) -> bool {
        self.job.is_some()
    }

    /// True if a solve would start from an earlier pose.
    pub(crate) fn has_pose(&self) -> bool {
        self.pose.is_some()
    }

    /// Stops, and forgets everything but [`Physics::follow`].
    pub fn stop(&mut self) {
        *self = Self { follow: self.follow, ..Self::default() };
    }

    /// Solves the scene from its last pose, or stops the solve.
    pub fn solve_or_stop(&mut self, document: &Document, shell: &mut Shell) {
        match &self.job {
            Some(job) => job.cancel(),
            None => self.solve(document, shell),
        }
    }

    /// Solves the scene from its own start.
    pub(crate) fn solve_from_start(&mut self, document: &Document, shell: &mut Shell) {
        self.pose = None;
        self.solve(document, shell);
    }

    fn solve(&mut self, document: &Document, shell: &mut Shell) {
        let Some(scene) = &document.subject.scene else {
            shell
                .messages
                .problem("solve: this model came from no scene; open a scene file (.toml) first");
            return;
        };
        if self.draft.is_some() {
            self.solves_draft = true;
            return;
        }
        let (built, start) = (Arc::clone(&scene.built), self.pose.clone());
        let request_repaint = Arc::clone(&shell.request_repaint);
        let work =
            move |reporter: &Reporter<Part>| run(&built, start.as_ref().map(|p| &p[..]), reporter);
        self.progress = Progress::default();
        self.job = Some(Job::start("solve", move || request_repaint(), work));
    }

    /// Takes the news of the solve.
    pub(crate) fn take_solve(&mut self, viewport: &mut Viewport, messages: &mut Messages) {
        let Some(job) = &self.job else { return };
        let (news, cancelled) = (job.take(), job.is_cancelled());
        self.progress = job.progress();
        for news in news {
            match news {
                News::Part(Part::Pose(solid, pose)) => {
                    (self.solid, self.pose) = (Some(solid), Some(pose));
                    viewport.shown = ShownSurface::Solved;
                }
                News::Part(Part::Whole(..)) => {}
                News::Done(done) => {
                    self.job = None;
                    match done {
                        Ok(Part::Whole(solid, solved)) => {
                            self.pose = Some(Arc::new(solved.pose.clone()));
                            self.solid = Some(solid);
                            viewport.shown = ShownSurface::Solved;
                            messages.note(solve_note(&solved, cancelled));
                            self.solved = Some(solved);
                        }
                        Ok(Part::Pose(..)) => {}
                        Err(error) => messages.problem(error),
                    }
                }
            }
        }
    }

    /// Edits the scene, which is then built in the background. An invalid edit becomes a message,
    /// and the scene stays.
    pub fn edit_scene(&mut self, document: &Document, edit: &Edit, shell: &mut Shell) {
        let Some(scene) = &document.subject.scene else { return };
        let draft = self.draft().cloned().unwrap_or_else(|| Draft::of(scene));
        match draft.with(edit) {
            Ok(draft) => {
                let request_repaint = Arc::clone(&shell.request_repaint);
                let to_build = draft.clone();
                let job = Job::start("scene", move || request_repaint(), move |_| to_build.build());
                self.draft = Some(BuildingDraft { draft, job });
            }
            Err(error) => shell.messages.problem(error),
        }
    }

    /// Takes the edited scene once it is built, and solves it if that was asked for.
    pub(crate) fn take_draft(&mut self, document: &mut Document, shell: &mut Shell) {
        let Some(BuildingDraft { job, .. }) = &self.draft else { return };
        for news in job.take() {
            let News::Done(done) = news else { continue };
            self.draft = None;
            match done {
                Ok(scene) => {
                    let subject = Subject { scene: Some(scene), ..(*document.subject).clone() };
                    document.subject = Arc::new(subject);
                    document.revision += 1;
                    self.solved = None;
                    if let Some(job) = &self.job {
                        job.cancel();
                        self.job = None;
                    }
                    if std::mem::take(&mut self.solves_draft) || self.follow {
                        self.solve(document, shell);
                    }
                }
                Err(error) => {
                    self.solves_draft = false;
                    shell.messages.problem(error);
                }
            }
            return;
        }
    }
}

/// The message about a solve that ended.
fn solve_note(solved: &SolvedScene, cancelled: bool) -> String {
    if cancelled {
        return "stopped: this is the best state so far, not a solution".into();
    }
    format!(
        "solved: {} iterations of the field, energy {:.4e} J",
        solved.field_report.iterations, solved.field_report.energy_joule
    )
}
