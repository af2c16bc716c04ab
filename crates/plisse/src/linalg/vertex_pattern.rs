//! The sparsity pattern of a matrix with up to three unknowns per vertex, the coordinates that are
//! not held, and the slots of its 3 × 3 blocks.

use super::sparse::SymmetricPattern;
use super::symbolic::IndexBlocks;
use crate::adjacency::NONE;

/// No slot: a coordinate is held, or the two are not coupled.
pub(crate) const NO_SLOT: u32 = u32::MAX;

/// The couplings of vertices and the pattern of their unknowns.
pub(crate) struct VertexPattern {
    /// `[V][3]` unknown of each coordinate, in the order of the vertices; [`NONE`] where it is
    /// held.
    unknown: Vec<[usize; 3]>,
    /// Couplings of vertices.
    graph: SymmetricPattern,
    /// For each coupling: true if all coordinates are coupled, false if only like ones are.
    full: Vec<bool>,
    /// For each coupling and each coordinate of the first vertex: the first slot of the second
    /// vertex in that coordinate's column.
    first_slot: Vec<[u32; 3]>,
    /// Pattern of the unknowns.
    pattern: SymmetricPattern,
}

impl VertexPattern {
    /// A pattern from sets of vertices: all coordinates of those in a set of `full` are coupled,
    /// and like coordinates of those in a set of `alike`.
    pub(crate) fn new<'a>(
        unknown: Vec<[usize; 3]>,
        full: impl Iterator<Item = &'a [usize]> + Clone,
        alike: impl Iterator<Item = &'a [usize]>,
    ) -> Self {
        let graph = SymmetricPattern::from_elements(unknown.len(), full.clone().chain(alike));
        let is_full = vec![false; graph.entry_count()];
        let mut all = Self {
            unknown,
            graph,
            full: is_full,
            first_slot: Vec::new(),
            pattern: SymmetricPattern::empty(),
        };
        all.mark_full(full);
        all.number_slots();
        all
    }

    /// Marks the couplings of all coordinates of these sets of vertices.
    fn mark_full<'a>(&mut self, lists: impl Iterator<Item = &'a [usize]>) {
        for list in lists {
            for slot in self.graph.element_slots(list) {
                self.full[slot] = true;
            }
        }
    }

    /// Builds the pattern of the unknowns from the couplings of vertices.
    fn number_slots(&mut self) {
        let (mut columns, mut rows) = (vec![0], Vec::with_capacity(3 * self.graph.entry_count()));
        self.first_slot.clear();
        self.first_slot.resize(self.graph.entry_count(), [NO_SLOT; 3]);
        for u in 0..self.graph.size() {
            for (axis, &column) in
                self.unknown[u].iter().enumerate().filter(|(_, column)| **column != NONE)
            {
                rows.extend(self.unknown[u][axis..].iter().copied().filter(|&row| row != NONE));
                for entry in self.graph.columns[u] + 1..self.graph.columns[u + 1] {
                    let other = &self.unknown[self.graph.rows[entry]];
                    self.first_slot[entry][axis] = rows.len() as u32;
                    match self.full[entry] {
                        true => rows.extend(other.iter().copied().filter(|&row| row != NONE)),
                        false => rows.extend([other[axis]].into_iter().filter(|&row| row != NONE)),
                    }
                }
                debug_assert_eq!(columns.len(), column + 1);
                columns.push(rows.len());
            }
        }
        self.pattern = SymmetricPattern { columns, rows };
    }

    /// The pattern of the unknowns.
    pub(crate) fn pattern(&self) -> &SymmetricPattern {
        &self.pattern
    }

    /// `[V][3]` unknown of each coordinate; [`NONE`] where it is held.
    pub(crate) fn unknown(&self) -> &[[usize; 3]] {
        &self.unknown
    }

    /// The vertices that are not wholly held, as blocks of unknowns.
    pub(crate) fn index_blocks(&self) -> IndexBlocks {
        let free = |v: usize| self.unknown[v].iter().copied().filter(|&unknown| unknown != NONE);
        let mut number = vec![NONE; self.unknown.len()];
        let mut members: Vec<Vec<usize>> = Vec::new();
        for v in (0..self.unknown.len()).filter(|&v| self.unknown[v] != [NONE; 3]) {
            number[v] = members.len();
            members.push(free(v).collect());
        }
        let (mut columns, mut rows) = (vec![0], Vec::with_capacity(self.graph.entry_count()));
        for u in (0..number.len()).filter(|&u| number[u] != NONE) {
            let others = self.graph.rows[self.graph.columns[u]..self.graph.columns[u + 1]].iter();
            rows.extend(others.map(|&v| number[v]).filter(|&v| v != NONE));
            columns.push(rows.len());
        }
        IndexBlocks { graph: SymmetricPattern { columns, rows }, members }
    }

    /// Slots of the block of `u` (first index) and `v`; [`NO_SLOT`] where there is no entry.
    pub(crate) fn block(&self, u: usize, v: usize) -> [[u32; 3]; 3] {
        let mut slots = [[NO_SLOT; 3]; 3];
        let (low, high) = (u.min(v), u.max(v));
        let rows = self.unknown[high];
        let own =
            |i: usize, j: usize| (self.pattern.columns[i.min(j)] + i.max(j) - i.min(j)) as u32;
        if u == v {
            for a in (0..3).filter(|&a| rows[a] != NONE) {
                (0..3)
                    .filter(|&b| rows[b] != NONE)
                    .for_each(|b| slots[a][b] = own(rows[a], rows[b]));
            }
            return slots;
        }
        let Some(entry) = self.graph.find(low, high) else { return slots };
        let begin = rows.iter().copied().find(|&row| row != NONE).unwrap_or(0);
        for (a, &first) in
            self.first_slot[entry].iter().enumerate().filter(|(_, first)| **first != NO_SLOT)
        {
            for b in (0..3).filter(|&b| rows[b] != NONE && (self.full[entry] || a == b)) {
                let slot = first + if self.full[entry] { (rows[b] - begin) as u32 } else { 0 };
                *(if low == u { &mut slots[a][b] } else { &mut slots[b][a] }) = slot;
            }
        }
        slots
    }

    /// True if all coordinates of `u` and `v` that are not held are coupled.
    pub(crate) fn couples(&self, u: usize, v: usize) -> bool {
        let held = |v: usize| self.unknown[v] == [NONE; 3];
        u == v || held(u) || held(v) || self.graph.find(u, v).is_some_and(|entry| self.full[entry])
    }

    /// Couples all coordinates of more sets of vertices. Returns the new slot of each old one.
    pub(crate) fn extend<'a>(
        &mut self,
        more: impl Iterator<Item = &'a [usize]> + Clone,
    ) -> Vec<u32> {
        let (graph, places) = self.graph.extended(more.clone());
        let mut full = vec![false; graph.entry_count()];
        places.iter().zip(&self.full).for_each(|(&place, &was)| full[place] = was);
        let old = Self {
            unknown: self.unknown.clone(),
            graph: std::mem::replace(&mut self.graph, graph),
            full: std::mem::replace(&mut self.full, full),
            first_slot: std::mem::take(&mut self.first_slot),
            pattern: std::mem::replace(&mut self.pattern, SymmetricPattern::empty()),
        };
        self.mark_full(more);
        self.number_slots();
        // Rows of a column are ascending in both.
        let mut slots = Vec::with_capacity(old.pattern.entry_count());
        for column in 0..old.pattern.size() {
            let mut now = self.pattern.columns[column];
            for row in
                &old.pattern.rows[old.pattern.columns[column]..old.pattern.columns[column + 1]]
            {
                while self.pattern.rows[now] != *row {
                    now += 1;
                }
                slots.push(now as u32);
            }
        }
        slots
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Asserts that every slot is that of its unknowns in the pattern.
    fn check(all: &VertexPattern) {
        let mut found = 0;
        for u in 0..all.unknown.len() {
            for v in 0..all.unknown.len() {
                for (a, slots) in all.block(u, v).iter().enumerate() {
                    for (b, &slot) in slots.iter().enumerate() {
                        let (i, j) = (all.unknown[u][a], all.unknown[v][b]);
                        let expected =
                            if i == NONE || j == NONE { None } else { all.pattern.find(i, j) };
                        assert_eq!(
                            (slot != NO_SLOT).then_some(slot as usize),
                            expected,
                            "{u}.{a} {v}.{b}"
                        );
                        found += usize::from(slot != NO_SLOT);
                    }
                }
            }
        }
        assert_eq!(found, 2 * all.pattern.entry_count() - all.pattern.size());
    }

    #[test]
    fn blocks_are_where_the_pattern_has_them() {
        // All free, one axis held, two held, all held, all free.
        let unknown =
            vec![[0, 1, 2], [3, NONE, 4], [NONE, 5, NONE], [NONE; 3], [6, 7, 8], [9, 10, 11]];
        let (full, alike): ([&[usize]; 2], [&[usize]; 1]) =
            ([&[2, 0, 1], &[4, 3, 1]], [&[5, 4, 0, 3, 2]]);
        let mut all = VertexPattern::new(unknown, full.into_iter(), alike.into_iter());
        check(&all);
        assert!(all.couples(0, 1) && all.couples(3, 5) && !all.couples(4, 0) && !all.couples(1, 5));
        let before = all.pattern.clone();
        let more: [&[usize]; 2] = [&[5, 1], &[4, 0, 3]];
        let slots = all.extend(more.into_iter());
        check(&all);
        assert!(all.couples(4, 0) && all.couples(1, 5));
        for column in 0..before.size() {
            for slot in before.columns[column]..before.columns[column + 1] {
                assert_eq!(slots[slot] as usize, all.pattern.slot(before.rows[slot], column));
            }
        }
        let blocks = all.index_blocks();
        assert_eq!(
            blocks.members,
            [vec![0, 1, 2], vec![3, 4], vec![5], vec![6, 7, 8], vec![9, 10, 11]]
        );
        assert!(
            blocks.graph.find(1, 4).is_some()
                && blocks.graph.find(1, 3).is_some()
                && blocks.graph.find(0, 4).is_some()
        );
    }
}
