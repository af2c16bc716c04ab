//! The change that a dab made, small enough to keep for every stroke.

use crate::growth::maps::GrowthAt;
use crate::mesh::Vec3;

/// Values that were overwritten, in ascending order of the vertices: with them
/// [`super::Sculpture::restore`] goes back to the bit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Change {
    /// Vertices whose pose was another, and that pose (m).
    pub(super) poses: Vec<(usize, Vec3)>,
    /// Vertices whose values were others, and these values.
    pub(super) values: Vec<(usize, GrowthAt)>,
    /// Vertices that were in equilibrium, as far as had been asked, and are not now.
    pub(super) disturbed: Vec<usize>,
    /// Vertices that were not in equilibrium, and are now.
    pub(super) equilibrated: Vec<usize>,
}

impl Change {
    /// True if nothing was changed.
    pub fn is_empty(&self) -> bool {
        self.poses.is_empty()
            && self.values.is_empty()
            && self.disturbed.is_empty()
            && self.equilibrated.is_empty()
    }

    /// The vertices whose pose was another: the ones that a picture has to update.
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
            disturbed: both(
                only(&self.disturbed, &later.equilibrated),
                only(&later.disturbed, &self.equilibrated),
            ),
            equilibrated: both(
                only(&self.equilibrated, &later.disturbed),
                only(&later.equilibrated, &self.disturbed),
            ),
            poses: earliest(self.poses, later.poses),
            values: earliest(self.values, later.values),
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
