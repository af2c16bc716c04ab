//! What a dab changed, small enough to keep for every stroke.

use super::Painted;
use crate::mesh::Vec3;

/// Values that were overwritten, in ascending order of the vertices: with them
/// [`super::Sculpture::restore`] goes back to the bit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Change {
    /// Vertices whose pose was another, and that pose (m).
    pub(super) poses: Vec<(usize, Vec3)>,
    /// Vertices on which other values were painted, and these values.
    pub(super) painted: Vec<(usize, Painted)>,
    /// Vertices that were at rest, as far as had been asked, and are not now.
    pub(super) woken: Vec<usize>,
    /// Vertices that were not, and are now.
    pub(super) calmed: Vec<usize>,
}

impl Change {
    /// Whether nothing was changed.
    pub fn is_empty(&self) -> bool {
        self.poses.is_empty()
            && self.painted.is_empty()
            && self.woken.is_empty()
            && self.calmed.is_empty()
    }

    /// The vertices whose pose was another: what a picture must be brought up to date with.
    pub fn moved(&self) -> impl Iterator<Item = usize> {
        self.poses.iter().map(|&(v, _)| v)
    }

    /// This change and the `later` one, as one.
    pub fn then(self, later: Self) -> Self {
        let only = |list: &[usize], other: &[usize]| -> Vec<usize> {
            list.iter().copied().filter(|v| other.binary_search(v).is_err()).collect()
        };
        let both = |first: Vec<usize>, second: Vec<usize>| {
            let mut all = [first, second].concat();
            all.sort_unstable();
            all.dedup();
            all
        };
        Self {
            woken: both(only(&self.woken, &later.calmed), only(&later.woken, &self.calmed)),
            calmed: both(only(&self.calmed, &later.woken), only(&later.calmed, &self.woken)),
            poses: earliest(self.poses, later.poses),
            painted: earliest(self.painted, later.painted),
        }
    }
}

/// Both lists in one, with the value of the first where both have one.
fn earliest<T: Copy>(first: Vec<(usize, T)>, second: Vec<(usize, T)>) -> Vec<(usize, T)> {
    let mut all = [first, second].concat();
    // A stable sort: of equal vertices, the first list's come first.
    all.sort_by_key(|entry| entry.0);
    all.dedup_by_key(|entry| entry.0);
    all
}
