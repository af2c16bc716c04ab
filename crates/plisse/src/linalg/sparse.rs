//! Sparsity patterns of symmetric matrices, assembled from elements before any value is known.

use crate::adjacency::{Csr, NONE};

/// Pattern of the lower triangle (with the whole diagonal) of a symmetric `n × n` matrix, column by
/// column.
#[derive(Clone, Debug)]
pub struct SymmetricPattern {
    /// `[n+1]` start of each column in [`SymmetricPattern::rows`].
    pub columns: Vec<usize>,
    /// `[nnz]` row of each entry, ascending inside a column; the diagonal is first.
    pub rows: Vec<usize>,
}

impl SymmetricPattern {
    /// The pattern of no unknowns.
    pub(crate) fn empty() -> Self {
        Self { columns: vec![0], rows: Vec::new() }
    }

    /// A pattern from the rows of each column (`[n]`, none above the diagonal; in any order,
    /// duplicates allowed).
    pub(crate) fn from_columns(mut lists: Vec<Vec<usize>>) -> Self {
        let (mut columns, mut rows) = (vec![0], Vec::new());
        for list in &mut lists {
            list.sort_unstable();
            list.dedup();
            rows.extend_from_slice(list);
            columns.push(rows.len());
        }
        Self { columns, rows }
    }

    /// The union of the full blocks that `elements` couple. An unknown may appear in no element;
    /// its diagonal is kept.
    pub fn from_elements<'a>(n: usize, elements: impl Iterator<Item = &'a [usize]>) -> Self {
        let (mut unknowns, mut begins) = (Vec::new(), vec![0]);
        for element in elements {
            unknowns.extend_from_slice(element);
            begins.push(unknowns.len());
        }
        let elements_of = Csr::from_pairs(
            n,
            begins
                .windows(2)
                .enumerate()
                .flat_map(|(e, range)| unknowns[range[0]..range[1]].iter().map(move |&i| (i, e))),
        );
        let (mut columns, mut rows) = (vec![0], Vec::new());
        let mut seen_by = vec![NONE; n];
        for column in 0..n {
            let begin = rows.len();
            rows.push(column);
            for &e in &elements_of[column] {
                for &row in &unknowns[begins[e]..begins[e + 1]] {
                    if row > column && seen_by[row] != column {
                        seen_by[row] = column;
                        rows.push(row);
                    }
                }
            }
            rows[begin..].sort_unstable();
            columns.push(rows.len());
        }
        Self { columns, rows }
    }

    /// Number of unknowns.
    pub fn size(&self) -> usize {
        self.columns.len() - 1
    }

    /// Number of stored entries.
    pub fn entry_count(&self) -> usize {
        self.rows.len()
    }

    /// Slot (index into the values) of entry (`i`, `j`) of the symmetric matrix.
    ///
    /// # Panics
    /// If the pattern does not hold the entry.
    pub fn slot(&self, i: usize, j: usize) -> usize {
        self.find(i, j).expect("the pattern holds the entry")
    }

    /// Slot of entry (`i`, `j`) of the symmetric matrix, if the pattern holds it.
    pub fn find(&self, i: usize, j: usize) -> Option<usize> {
        let (column, row) = (i.min(j), i.max(j));
        let start = self.columns[column];
        self.rows[start..self.columns[column + 1]].binary_search(&row).ok().map(|at| start + at)
    }

    /// This pattern with the couplings of more elements, and the new slot of each of its own
    /// entries.
    pub fn extended<'a>(&self, elements: impl Iterator<Item = &'a [usize]>) -> (Self, Vec<usize>) {
        let mut more = Vec::new();
        for element in elements {
            for (p, &i) in element.iter().enumerate() {
                more.extend(
                    element[..p].iter().filter(|&&j| i != j).map(|&j| (i.min(j), i.max(j))),
                );
            }
        }
        more.sort_unstable();
        more.dedup();
        let (mut columns, mut rows, mut places) = (
            vec![0],
            Vec::with_capacity(self.rows.len() + more.len()),
            Vec::with_capacity(self.rows.len()),
        );
        let mut more = more.into_iter().peekable();
        for column in 0..self.size() {
            for &row in &self.rows[self.columns[column]..self.columns[column + 1]] {
                while let Some((_, new)) = more.next_if(|&(c, r)| c == column && r < row) {
                    rows.push(new);
                }
                more.next_if_eq(&(column, row));
                places.push(rows.len());
                rows.push(row);
            }
            while let Some((_, new)) = more.next_if(|&(c, _)| c == column) {
                rows.push(new);
            }
            columns.push(rows.len());
        }
        (Self { columns, rows }, places)
    }

    /// Slots of an element's lower triangle, row by row: (0,0), (1,0), (1,1), (2,0), …
    pub fn element_slots(&self, element: &[usize]) -> impl Iterator<Item = usize> {
        element
            .iter()
            .enumerate()
            .flat_map(move |(p, &i)| element[..=p].iter().map(move |&j| self.slot(i, j)))
    }

    /// `out = A x` for the symmetric matrix with these lower-triangle `values`.
    pub fn multiply(&self, values: &[f64], x: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        self.add_multiple(1.0, values, x, out);
    }

    /// `out += factor · A x` for the symmetric matrix with these lower-triangle `values`.
    pub fn add_multiple(&self, factor: f64, values: &[f64], x: &[f64], out: &mut [f64]) {
        for column in 0..self.size() {
            for slot in self.columns[column]..self.columns[column + 1] {
                let row = self.rows[slot];
                out[row] += factor * values[slot] * x[column];
                if row != column {
                    out[column] += factor * values[slot] * x[row];
                }
            }
        }
    }

    /// Uncouples the unknowns marked in `fixed`: clears their rows and columns but for the absolute
    /// value of the diagonal.
    pub fn isolate(&self, values: &mut [f64], fixed: &[bool]) {
        for column in 0..self.size() {
            for slot in self.columns[column]..self.columns[column + 1] {
                let row = self.rows[slot];
                if fixed[column] || fixed[row] {
                    values[slot] = if row == column { values[slot].abs() } else { 0.0 };
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_scatter_to_the_matrix_they_describe() {
        let elements = [vec![2, 0], vec![1, 2, 3]];
        let pattern = SymmetricPattern::from_elements(5, elements.iter().map(Vec::as_slice));
        assert_eq!(pattern.entry_count(), 5 + 1 + 3);
        let mut values = vec![0.0; pattern.entry_count()];
        for element in &elements {
            for slot in pattern.element_slots(element) {
                values[slot] += 1.0;
            }
        }
        let mut out = [0.0; 5];
        pattern.multiply(&values, &[1.0, 10.0, 100.0, 1000.0, 7.0], &mut out);
        assert_eq!(out, [101.0, 1110.0, 1.0 + 10.0 + 200.0 + 1000.0, 1110.0, 0.0]);
        pattern.isolate(&mut values, &[false, false, true, false, false]);
        pattern.multiply(&values, &[1.0, 10.0, 100.0, 1000.0, 7.0], &mut out);
        assert_eq!(out, [1.0, 1010.0, 200.0, 1010.0, 0.0]);
    }

    #[test]
    fn an_extended_pattern_is_that_of_all_elements() {
        let (old, new) = ([vec![2, 0], vec![1, 2, 3]], [vec![0, 4, 2], vec![3, 1]]);
        let pattern = SymmetricPattern::from_elements(5, old.iter().map(Vec::as_slice));
        let (longer, places) = pattern.extended(new.iter().map(Vec::as_slice));
        let whole = SymmetricPattern::from_elements(5, old.iter().chain(&new).map(Vec::as_slice));
        assert_eq!((&longer.columns, &longer.rows), (&whole.columns, &whole.rows));
        for column in 0..5 {
            for slot in pattern.columns[column]..pattern.columns[column + 1] {
                assert_eq!(places[slot], longer.slot(pattern.rows[slot], column));
            }
        }
    }
}
