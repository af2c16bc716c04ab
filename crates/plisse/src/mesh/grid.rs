//! Structured panels: rectangles cut into equal rows and columns, every cell into two right
//! triangles.
//!
//! Their edges prefer three directions, and wrinkles may follow them: they are for comparing with
//! published meshes and for seeing that very effect. For all else [`Panel::new`] is better.

use super::Vec2;
use super::panel::{MAX_VERTICES, Outline, Panel};
use crate::{Error, Result};

/// The diagonal along which the cells of a structured panel are cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Diagonal {
    /// From the lower left corner to the upper right one.
    Rising,
    /// From the upper left corner to the lower right one.
    Falling,
}

/// A rectangle (see [`Outline::Rectangle`] for its place and sides) of `columns` × `rows` cells;
/// `None`: the extent (m) divided by `edge_length_m` (m), rounded, but at least 1. Its boundary
/// vertices come first, in the order of the sides, then the inner ones row by row.
///
/// # Errors
/// [`Error::Value`] naming the field for: a size that is not a positive number, no column or row,
/// more than 2 million vertices.
pub fn grid(
    [width_m, height_m]: [f64; 2],
    edge_length_m: f64,
    [columns, rows]: [Option<usize>; 2],
    diagonal: Diagonal,
) -> Result<Panel> {
    let [m, n] = cell_counts([width_m, height_m], edge_length_m, [columns, rows])?;

    // The cells' corners in the order that Panel promises.
    let bottom = (0..m).map(|i| (i, 0));
    let right = (0..n).map(|j| (m, j));
    let top = (0..m).map(|i| (m - i, n));
    let left = (0..n).map(|j| (0, n - j));
    let inner = (1..n).flat_map(|j| (1..m).map(move |i| (i, j)));
    let corners: Vec<(usize, usize)> =
        bottom.chain(right).chain(top).chain(left).chain(inner).collect();
    let mut index = vec![0; corners.len()];
    for (v, &(i, j)) in corners.iter().enumerate() {
        index[j * (m + 1) + i] = v;
    }
    let positions = corners
        .iter()
        .map(|&(i, j)| Vec2::new(width_m * i as f64 / m as f64, height_m * j as f64 / n as f64))
        .collect();
    let mut faces = Vec::with_capacity(2 * m * n);
    for j in 0..n {
        for i in 0..m {
            let [a, b, c, d] = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
                .map(|(i, j)| index[j * (m + 1) + i]);
            faces.extend(match diagonal {
                Diagonal::Rising => [[a, b, c], [a, c, d]],
                Diagonal::Falling => [[a, b, d], [b, c, d]],
            });
        }
    }
    for face in &mut faces {
        let lowest = (0..3).min_by_key(|&k| face[k]).unwrap_or(0);
        face.rotate_left(lowest);
    }
    faces.sort_unstable();
    let starts = [0, m, m + n, 2 * m + n, 2 * (m + n)];
    let sides =
        starts.windows(2).map(|s| (s[0]..s[1]).chain([s[1] % starts[4]]).collect()).collect();
    Ok(Panel {
        positions,
        faces,
        sides,
        side_names: Outline::RECTANGLE_SIDES.map(String::from).to_vec(),
    })
}

/// Checked numbers of columns and rows.
fn cell_counts(
    [width_m, height_m]: [f64; 2],
    edge_length_m: f64,
    [columns, rows]: [Option<usize>; 2],
) -> Result<[usize; 2]> {
    for (field, value) in
        [("width_m", width_m), ("height_m", height_m), ("edge_length_m", edge_length_m)]
    {
        if !(value.is_finite() && value > 0.0) {
            return Err(Error::value(
                field,
                format!("{value} is no length; give a positive number of metres"),
            ));
        }
    }
    let count = |extent_m: f64, given: Option<usize>| {
        given.unwrap_or_else(|| ((extent_m / edge_length_m).round() as usize).max(1))
    };
    let (m, n) = (count(width_m, columns), count(height_m, rows));
    for (field, given, cells) in [("columns", columns, m), ("rows", rows, n)] {
        if cells == 0 {
            return Err(Error::value(
                field,
                "a panel cannot have 0 of them; give a whole number of 1 or more",
            ));
        }
        let field = if given.is_some() { field } else { "edge_length_m" };
        // Written so that no count overflows.
        if (m as f64 + 1.0) * (n as f64 + 1.0) > MAX_VERTICES
            && (given.is_some() || (columns, rows) == (None, None))
        {
            let message = format!(
                "{m} columns and {n} rows have more than 2 million vertices; ask for fewer or a \
                 longer edge length"
            );
            return Err(Error::value(field, message));
        }
    }
    Ok([m, n])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::At;
    use crate::mesh::Topology;

    const SIZE: [f64; 2] = [1.2, 0.5];

    #[test]
    fn cells_are_equal_and_fill_the_rectangle() {
        for diagonal in [Diagonal::Rising, Diagonal::Falling] {
            let panel = grid(SIZE, 0.11, [None, None], diagonal).unwrap();
            assert_eq!((panel.positions.len(), panel.faces.len()), (12 * 6, 2 * 11 * 5));
            let t = Topology::new(panel.positions.len(), panel.faces.clone()).unwrap();
            assert_eq!(t.vertex_count + t.face_count(), t.edge_count() + 1);
            for face in &panel.faces {
                let [a, b, c] = face.map(|v| panel.positions[v]);
                assert!(
                    ((b - a).perp(&(c - a)) / (1.2 * 0.5 / 55.0) - 1.0).abs() < 1e-12,
                    "counter-clockwise, half a cell"
                );
                assert!(face[0] < face[1] && face[0] < face[2]);
            }
            assert!(panel.faces.is_sorted());
            let slanted = t
                .edges
                .iter()
                .map(|e| panel.positions[e[1]] - panel.positions[e[0]])
                .filter(|d| d.x.abs() > 1e-9 && d.y.abs() > 1e-9);
            let slopes: Vec<f64> = slanted.map(|d| d.y / d.x).collect();
            assert_eq!(slopes.len(), 55);
            assert!(slopes.iter().all(|s| (*s > 0.0) == (diagonal == Diagonal::Rising)));
        }
    }

    #[test]
    fn sides_are_those_of_an_irregular_rectangle() {
        let irregular =
            Panel::new(&Outline::Rectangle { width_m: SIZE[0], height_m: SIZE[1] }, 0.1, 1)
                .unwrap();
        let panel = grid(SIZE, 0.1, [None, None], Diagonal::Rising).unwrap();
        assert_eq!((&panel.sides, &panel.side_names), (&irregular.sides, &irregular.side_names));
        for &v in panel.sides.iter().flatten() {
            assert!((panel.positions[v] - irregular.positions[v]).norm() < 1e-15);
        }
        let boundary =
            Topology::new(panel.positions.len(), panel.faces.clone()).unwrap().boundary_vertices();
        assert_eq!((0..boundary.len()).filter(|&v| boundary[v]).count(), 34);
        assert!(boundary[..34].iter().all(|&b| b));
    }

    #[test]
    fn counts_may_be_given_and_too_many_are_told() {
        let panel = grid(SIZE, 0.1, [Some(3), None], Diagonal::Falling).unwrap();
        assert_eq!(panel.faces.len(), 2 * 3 * 5);
        assert_eq!(grid(SIZE, 0.1, [Some(1), Some(1)], Diagonal::Falling).unwrap().faces.len(), 2);
        let says = |length, cells| {
            grid(SIZE, length, cells, Diagonal::Rising).at("p").unwrap_err().to_string()
        };
        assert!(says(0.1, [Some(0), None]).starts_with("p.columns: a panel cannot have 0"));
        assert!(says(0.1, [None, Some(usize::MAX)]).starts_with("p.rows: 12 columns and"));
        assert!(
            says(1e-5, [None, None]).starts_with("p.edge_length_m: ")
                && says(1e-300, [None, None]).contains("2 million")
        );
        assert!(says(f64::NAN, [None, None]).starts_with("p.edge_length_m: NaN"));
    }
}
