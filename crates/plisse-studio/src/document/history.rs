//! Undo and redo without limit: each entry holds the exact bits of what it changed, before and
//! after.

use super::layers::{Layer, Layers};
use super::stroke::Stroke;

/// One change of one layer.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// What changed.
    pub layer: Layer,
    /// How it came about, for people and for files.
    pub stroke: Stroke,
    /// Unified vertices that changed, ascending, with their numbers before and after.
    pub vertices: Vec<(u32, [f32; 4], [f32; 4])>,
}

impl Change {
    fn write(&self, layers: &mut Layers, after: bool) {
        let values = layers.of_mut(self.layer);
        for (v, old, new) in &self.vertices {
            values[*v as usize] = if after { *new } else { *old };
        }
    }
}

/// All changes of a document, done and undone.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct History {
    changes: Vec<Change>,
    /// How many of them are done; the others can be done again.
    done: usize,
}

impl History {
    /// Takes a change that is already in the layers; what had been undone is forgotten.
    pub fn push(&mut self, change: Change) {
        self.changes.truncate(self.done);
        self.changes.push(change);
        self.done += 1;
    }

    /// Takes the last change back, to the bit; the layer that changed, or `None` if there is
    /// nothing to undo.
    pub fn undo(&mut self, layers: &mut Layers) -> Option<Layer> {
        let change = self.changes.get(self.done.checked_sub(1)?)?;
        change.write(layers, false);
        self.done -= 1;
        Some(change.layer)
    }

    /// Does the last change that was taken back again.
    pub fn redo(&mut self, layers: &mut Layers) -> Option<Layer> {
        let change = self.changes.get(self.done)?;
        change.write(layers, true);
        self.done += 1;
        Some(change.layer)
    }

    /// Changes that are done, the oldest first.
    pub fn done(&self) -> &[Change] {
        &self.changes[..self.done]
    }

    /// How many changes can be done again.
    pub fn undone(&self) -> usize {
        self.changes.len() - self.done
    }
}
