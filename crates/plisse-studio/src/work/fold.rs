//! Folding under the brush: a local solve of growth follows the painted layers, in the background,
//! a piece of work at a time.
//!
//! Only the layers count: their difference from the layers followed so far grows in small steps,
//! and then comes to rest. An undone stroke is restored to the bit.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

use plisse::Result;
use plisse::growth::sculpt::{Change, SculptOptions, Sculpture};
use plisse::growth::{Expansion, GrowthAt, GrowthOptions, GrowthReport, StepReport};
use plisse::mesh::Vec3;
use plisse::progress::{Observer, Step};
use web_time::Instant;

use super::grow::{self, Grown, Numbers};
use crate::document::{Document, Layer, Layers};
use crate::threads::{apart, spawn};
use crate::view::Solid;

/// Largest growth of length (a factor) in one step, after which the surroundings follow.
const STEP: f64 = 1.1;
/// Newton iterations of a bout of coming to rest, after which the surface is shown.
const BOUT: usize = 8;
/// Most bouts after a stroke.
const MOST_BOUTS: usize = 25;

/// A request to follow the layers.
pub struct FoldRequest {
    /// The painted layers.
    pub layers: Layers,
    /// Number of strokes that led to them, the current one included.
    pub strokes: usize,
}

/// The surface after a piece of work.
#[derive(Clone)]
pub struct Folded {
    /// The surface, to show.
    pub solid: Arc<Solid>,
    /// The surface.
    pub grown: Arc<Grown>,
    /// Time of the work (ms).
    pub ms: f32,
    /// True if it is at rest with the painted layers.
    pub at_rest: bool,
}

/// The data that the window and the thread share.
struct Shared {
    /// The start, until the follower is made.
    start: Mutex<Option<FoldStart>>,
    follower: Mutex<Option<Follower>>,
    wanted: Mutex<Option<FoldRequest>>,
    is_over: AtomicBool,
    out: Mutex<Option<Result<Folded>>>,
}

/// The start of folding: a document, and its grown surface, if any.
struct FoldStart {
    document: Document,
    grown: Option<Arc<Grown>>,
}

impl Shared {
    /// Follows the newest layers, or comes nearer to rest if there are none.
    fn work(&self) -> Result<Folded> {
        let lost = || {
            plisse::Error::value(
                "fold under the brush",
                "it stopped after an internal error; switch it off and on again",
            )
        };
        let mut follower = self.follower.lock().map_err(|_| lost())?;
        if let Some(FoldStart { document, grown }) = self.start.lock().map_err(|_| lost())?.take() {
            *follower = Some(Follower::new(&document, grown.as_deref())?);
        }
        let wanted = self.wanted.lock().map_err(|_| lost())?.take();
        follower.as_mut().ok_or_else(lost)?.follow(wanted, self)
    }

    fn waits(&self) -> bool {
        self.wanted.lock().is_ok_and(|wanted| wanted.is_some())
    }
}

/// Cancels a bout of coming to rest as soon as there is new paint.
impl Observer for Shared {
    fn step(&self, _: &Step) {}

    fn cancelled(&self) -> bool {
        self.is_over.load(Ordering::SeqCst) || self.waits()
    }
}

/// The window's end.
pub struct Fold {
    shared: Arc<Shared>,
    works: bool,
    request_repaint: Arc<dyn Fn() + Send + Sync>,
}

impl Fold {
    /// Starts from `document`, or from its `grown` surface if there is one. `request_repaint` is
    /// called when there is news, the first of which may be an error.
    pub fn start(
        document: Document,
        grown: Option<Arc<Grown>>,
        request_repaint: Arc<dyn Fn() + Send + Sync>,
    ) -> Self {
        let shared = Shared {
            start: Mutex::new(Some(FoldStart { document, grown })),
            follower: Mutex::default(),
            wanted: Mutex::default(),
            is_over: AtomicBool::new(false),
            out: Mutex::default(),
        };
        let mut fold = Self { shared: Arc::new(shared), works: false, request_repaint };
        fold.work();
        fold
    }

    /// Asks to follow these layers, in place of a request that is not begun.
    pub fn request(&mut self, wanted: FoldRequest) {
        if let Ok(mut there) = self.shared.wanted.lock() {
            *there = Some(wanted);
        }
        self.work();
    }

    /// The new result, if there is one; the work continues.
    pub fn take(&mut self) -> Option<Result<Folded>> {
        let folded = self.shared.out.lock().ok()?.take()?;
        self.works = false;
        if self.shared.waits() || folded.as_ref().is_ok_and(|folded| !folded.at_rest) {
            self.work();
        }
        Some(folded)
    }

    /// True while it is not at rest with the requested layers.
    pub fn is_busy(&self) -> bool {
        self.works
    }

    fn work(&mut self) {
        if std::mem::replace(&mut self.works, true) {
            return;
        }
        let (shared, request_repaint) =
            (Arc::clone(&self.shared), Arc::clone(&self.request_repaint));
        spawn("fold", move || {
            let folded = catch_unwind(AssertUnwindSafe(|| apart(|| shared.work())));
            let broken = |_| {
                Err(plisse::Error::value(
                    "fold under the brush",
                    "internal error; save your work and report what you did",
                ))
            };
            if let Ok(mut out) = shared.out.lock() {
                *out = Some(folded.unwrap_or_else(broken));
            }
            request_repaint();
        });
    }
}

impl Drop for Fold {
    fn drop(&mut self) {
        self.shared.is_over.store(true, Ordering::SeqCst);
    }
}

/// A change that was followed, and the state before it.
struct Done {
    /// Number of strokes that led to it.
    strokes: usize,
    change: Change,
    /// Vertices, with the numbers that were followed before.
    numbers: Vec<(usize, Numbers)>,
}

/// The thread's end: a surface, and the painted numbers that it follows.
pub struct Follower {
    sculpture: Sculpture,
    /// `[V]` growth 1, whose frames painted directions refer to.
    frames: Expansion,
    /// `[V]` painted numbers that were followed so far.
    numbers: Vec<Numbers>,
    /// `[V]` true for vertices that are held whatever is painted.
    held: Vec<bool>,
    spacing_m: f64,
    coherence_m: f64,
    done: Vec<Done>,
    /// Bouts of coming to rest that are left since the last paint; 0 after an undo.
    bouts: usize,
}

impl Follower {
    /// Starts from `document`, or from its `grown` surface if there is one.
    ///
    /// # Errors
    /// As [`Sculpture::new`]; [`plisse::Error::Value`] if some paint has not grown yet, or has
    /// grown on another mesh.
    pub fn new(document: &Document, grown: Option<&Grown>) -> Result<Self> {
        if grown.is_none() && document.layers.is_painted(Layer::Expansion) {
            let message = "some paint has not grown yet; press Grow the whole, then the brush \
                continues from there";
            return Err(plisse::Error::value("fold under the brush", message));
        }
        let sheet = grow::painted(document)?;
        let surface = sheet.surface;
        let pose = match grown {
            Some(grown) if grown.topology.faces != surface.topology.faces => {
                let message = "the grown surface has another mesh than the model; remove \
                    growth.remesh from its scene, or paint before it grows";
                return Err(plisse::Error::value("fold under the brush", message));
            }
            Some(grown) => grown.pose.clone(),
            None => surface.start.clone(),
        };
        let brush = SculptOptions { growth_limit: f64::INFINITY, ..SculptOptions::default() };
        Ok(Self {
            frames: Expansion::none(&surface.topology, &surface.start)?,
            numbers: (0..pose.len()).map(|v| Numbers::of(&document.layers, v)).collect(),
            held: sheet.held,
            spacing_m: document.settings.fold_spacing_m,
            coherence_m: document.settings.coherence_m,
            sculpture: Sculpture::new(
                surface,
                pose,
                GrowthOptions { iteration_limit: BOUT, ..sheet.options },
                brush,
            )?,
            done: Vec::new(),
            bouts: 0,
        })
    }

    /// Follows these layers, or continues to come to rest.
    ///
    /// # Errors
    /// As [`Sculpture::paint`] and [`Sculpture::equilibrate`]; the surface then is as it was.
    pub fn follow(
        &mut self,
        wanted: Option<FoldRequest>,
        observer: &dyn Observer,
    ) -> Result<Folded> {
        let begun = Instant::now();
        let mut step = None;
        if let Some(wanted) = wanted {
            self.undo_beyond(wanted.strokes);
            step = self.paint(&wanted)?.or(step);
        } else if self.bouts > 0 {
            self.bouts -= 1;
            let (change, report) = self.sculpture.equilibrate(observer)?;
            let strokes = self.done.last().map_or(0, |done| done.strokes);
            self.keep(strokes, change, Vec::new());
            step = report.step;
        }
        let surface = self.sculpture.surface();
        let asked = surface.asked()?;
        let pose = self.sculpture.pose().to_vec();
        let solid = Arc::new(grow::look(&surface.topology, &asked, &pose));
        let seconds = begun.elapsed().as_secs_f64();
        let report = Arc::new(GrowthReport { steps: step.into_iter().collect(), asked, seconds });
        let grown = Arc::new(Grown { topology: surface.topology.clone(), pose, report });
        let at_rest = self.bouts == 0 || self.sculpture.is_at_rest();
        Ok(Folded { solid, grown, ms: 1e3 * seconds as f32, at_rest })
    }

    /// `[V]` the surface (m).
    pub fn pose(&self) -> &[Vec3] {
        self.sculpture.pose()
    }

    /// Restores the state after the first `strokes`.
    fn undo_beyond(&mut self, strokes: usize) {
        while let Some(done) = self.done.pop_if(|done| done.strokes > strokes) {
            self.sculpture.restore(done.change);
            done.numbers.into_iter().for_each(|(v, numbers)| self.numbers[v] = numbers);
            self.bouts = 0;
        }
    }

    /// Grows the vertices whose numbers differ, in steps.
    fn paint(&mut self, wanted: &FoldRequest) -> Result<Option<StepReport>> {
        let to = |v: usize| Numbers::of(&wanted.layers, v);
        let differing: Vec<usize> =
            (0..self.numbers.len()).filter(|&v| self.numbers[v] != to(v)).collect();
        let factor =
            differing.iter().map(|&v| self.numbers[v].growth_to(&to(v))).fold(1.0, f64::max);
        let steps = (factor.ln() / STEP.ln()).ceil().clamp(1.0, 64.0) as usize;
        let (mut all, mut last) = (Change::default(), None);
        for k in 1..=steps {
            let share = k as f64 / steps as f64;
            let values: Vec<(usize, GrowthAt)> = differing
                .iter()
                .map(|&v| (v, self.painted(v, &self.numbers[v].towards(&to(v), share))))
                .collect();
            match self.sculpture.paint(&values) {
                Ok((change, report)) => {
                    all = all.then(change);
                    last = report.step.or(last);
                }
                Err(error) => {
                    self.sculpture.restore(all);
                    return Err(error);
                }
            }
        }
        if !differing.is_empty() {
            self.keep(
                wanted.strokes,
                all,
                differing.iter().map(|&v| (v, self.numbers[v])).collect(),
            );
            differing.iter().for_each(|&v| self.numbers[v] = to(v));
            self.bouts = MOST_BOUTS;
        }
        Ok(last)
    }

    /// The growth at vertex `v` with these numbers.
    fn painted(&self, v: usize, numbers: &Numbers) -> GrowthAt {
        GrowthAt {
            growth: numbers.growth(&self.frames.vertices[v]),
            wavelength_m: numbers.wavelength_m(self.spacing_m),
            coherence_m: numbers.coherence_m(self.coherence_m),
            frozen: [self.held[v] || numbers.frozen(); 3],
            ..self.sculpture.values()[v]
        }
    }

    fn keep(&mut self, strokes: usize, change: Change, numbers: Vec<(usize, Numbers)>) {
        match self.done.last_mut().filter(|last| last.strokes == strokes) {
            Some(last) => {
                last.change = std::mem::take(&mut last.change).then(change);
                // If numbers changed twice, the first are kept.
                last.numbers.extend(numbers);
                last.numbers.sort_by_key(|entry| entry.0);
                last.numbers.dedup_by_key(|entry| entry.0);
            }
            None => self.done.push(Done { strokes, change, numbers }),
        }
    }
}
