//! Jobs of the program: files that are read, solves, growth, and exports. Each keeps its result;
//! what a job computes stands in [`crate::work`].

pub mod export;
pub mod growth;
pub mod physics;
pub mod reading;

use std::sync::Arc;

use crate::document::Document;
use crate::view::Solid;
use crate::viewport::ShownSurface;
use crate::work::export::Source;

/// The jobs in the background and their results.
#[derive(Default)]
pub struct Jobs {
    /// The solve of a scene.
    pub physics: physics::Physics,
    /// Growth.
    pub growth: growth::Growth,
    /// Files for other programs.
    pub export: export::Export,
    pub(crate) reading: reading::Reading,
}

impl Jobs {
    /// True while any job is running.
    pub fn is_busy(&self) -> bool {
        self.physics.is_busy()
            || self.growth.is_busy()
            || self.export.is_busy()
            || self.reading.is_busy()
    }

    /// Stops the jobs on the document, and forgets their results.
    pub(crate) fn stop(&mut self) {
        self.physics.stop();
        self.growth.stop();
    }

    /// The surface that `shown` names, if there is one that stands still.
    pub(crate) fn solid(&self, shown: ShownSurface) -> Option<Arc<Solid>> {
        match shown {
            ShownSurface::Live => None,
            ShownSurface::Solved => self.physics.solid(),
            ShownSurface::Grown => self.growth.solid(),
        }
    }

    /// The surface that is exported while `shown` is seen: the live one unless a solve or growth is
    /// complete.
    pub(crate) fn exported(&self, shown: ShownSurface) -> ShownSurface {
        match shown {
            ShownSurface::Solved if self.physics.solved.is_some() => ShownSurface::Solved,
            ShownSurface::Grown if self.growth.grown.is_some() => ShownSurface::Grown,
            _ => ShownSurface::Live,
        }
    }

    /// The source of exported files while `shown` is seen.
    pub(crate) fn source(&self, shown: ShownSurface, document: &Document) -> Source {
        let document = Box::new(document.clone());
        match (shown, &self.physics.solved, &self.growth.grown) {
            (ShownSurface::Solved, Some(solved), _) => Source::Solved(Arc::clone(solved), document),
            (ShownSurface::Grown, _, Some(grown)) => Source::Grown(Arc::clone(grown), document),
            _ => Source::Live(document),
        }
    }
}
