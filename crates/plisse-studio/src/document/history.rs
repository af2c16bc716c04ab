//! Undo and redo without limit: each change holds the exact bits before and after it.

use super::layers::{Layer, Layers};
use super::stroke::Stroke;

/// One change of one layer.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// The layer that changed.
    pub layer: Layer,
    /// The stroke that changed it, for people and for files.
    pub stroke: Stroke,
    /// The vertices that changed, ascending.
    pub vertices: Vec<VertexChange>,
}

/// The change of one vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VertexChange {
    /// The welded vertex.
    pub vertex: u32,
    /// Its numbers before.
    pub before: [f32; 4],
    /// Its numbers after.
    pub after: [f32; 4],
}

impl Change {
    fn write(&self, layers: &mut Layers, after: bool) {
        let values = layers.of_mut(self.layer);
        for change in &self.vertices {
            values[change.vertex as usize] = if after { change.after } else { change.before };
        }
    }
}

/// All changes of a document, done and undone.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct History {
    changes: Vec<Change>,
    /// Number of changes that are done; the others can be redone.
    done: usize,
}

impl History {
    /// Adds a change that is already in the layers; undone changes are forgotten.
    pub fn push(&mut self, change: Change) {
        self.changes.truncate(self.done);
        self.changes.push(change);
        self.done += 1;
    }

    /// Undoes the last change, to the bit; the layer that changed, or `None` if there is nothing to
    /// undo.
    pub fn undo(&mut self, layers: &mut Layers) -> Option<Layer> {
        let change = self.changes.get(self.done.checked_sub(1)?)?;
        change.write(layers, false);
        self.done -= 1;
        Some(change.layer)
    }

    /// Redoes the last change that was undone; as [`History::undo`].
    pub fn redo(&mut self, layers: &mut Layers) -> Option<Layer> {
        let change = self.changes.get(self.done)?;
        change.write(layers, true);
        self.done += 1;
        Some(change.layer)
    }

    /// The changes that are done, the oldest first.
    pub fn done(&self) -> &[Change] {
        &self.changes[..self.done]
    }

    /// Number of changes that can be redone.
    pub fn undone(&self) -> usize {
        self.changes.len() - self.done
    }
}
