//! Lists of indices for each row, stored one after the other (compressed sparse rows): faces around
//! vertices, neighbours in a graph, buckets of a sort.

use std::ops::Index;

/// The index of nothing: a missing face, a vertex without an unknown.
pub const NONE: usize = usize::MAX;

/// A list of items for each row, all in one array.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Csr<T = usize> {
    /// `[rows + 1]` position in `items` at which each row begins; the last is the end of all.
    starts: Vec<usize>,
    /// The items of row 0, of row 1, ...
    items: Vec<T>,
}

impl<T: Copy> Csr<T> {
    /// Rows from pairs (row, item), by counting: each row keeps the order in which its items come.
    /// `pairs` is walked twice.
    ///
    /// # Panics
    /// If a pair names a row that is not below `rows`.
    pub fn from_pairs(rows: usize, pairs: impl Iterator<Item = (usize, T)> + Clone) -> Self {
        let mut starts = vec![0; rows + 1];
        for (row, _) in pairs.clone() {
            starts[row + 1] += 1;
        }
        for row in 0..rows {
            starts[row + 1] += starts[row];
        }
        let Some((_, first)) = pairs.clone().next() else {
            return Self { starts, items: Vec::new() };
        };
        let mut next = starts.clone();
        let mut items = vec![first; starts[rows]];
        for (row, item) in pairs {
            items[next[row]] = item;
            next[row] += 1;
        }
        Self { starts, items }
    }
}

impl<T> Csr<T> {
    /// Number of rows.
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// True if there is no row.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Position of the first item of `row` among the items of all rows.
    pub fn start(&self, row: usize) -> usize {
        self.starts[row]
    }

    /// The items of all rows, one row after the other.
    pub fn items(&self) -> &[T] {
        &self.items
    }

    /// The items of each row.
    pub fn rows(&self) -> impl Iterator<Item = &[T]> {
        self.starts.windows(2).map(|ends| &self.items[ends[0]..ends[1]])
    }

    /// The items of each row, to be changed.
    pub fn rows_mut(&mut self) -> impl Iterator<Item = &mut [T]> {
        let mut rest = &mut self.items[..];
        self.starts.windows(2).map(move |ends| {
            let (row, after) = std::mem::take(&mut rest).split_at_mut(ends[1] - ends[0]);
            rest = after;
            row
        })
    }
}

/// The items of a row.
impl<T> Index<usize> for Csr<T> {
    type Output = [T];

    fn index(&self, row: usize) -> &[T] {
        &self.items[self.starts[row]..self.starts[row + 1]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_keep_the_order_of_their_pairs() {
        let pairs = [(2, 'c'), (0, 'b'), (2, 'a'), (3, 'd'), (0, 'b')];
        let mut csr = Csr::from_pairs(5, pairs.into_iter());
        let rows: [&[char]; 5] = [&['b', 'b'], &[], &['c', 'a'], &['d'], &[]];
        assert!(csr.rows().eq(rows));
        assert_eq!((csr.len(), csr.start(3), &csr[2]), (5, 4, &['c', 'a'][..]));
        csr.rows_mut().for_each(<[char]>::sort_unstable);
        assert_eq!(csr.items(), ['b', 'b', 'a', 'c', 'd']);
    }

    #[test]
    fn there_may_be_no_rows_or_no_items() {
        let none = Csr::<usize>::from_pairs(0, std::iter::empty());
        assert!(none.is_empty() && none.rows().next().is_none());
        let empty = Csr::<usize>::from_pairs(2, std::iter::empty());
        assert!(empty.rows().eq([&[0usize; 0], &[]]));
    }
}
