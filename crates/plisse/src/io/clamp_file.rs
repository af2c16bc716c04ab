//! Lists of clamped vertices: plain ones, and those published with the code of [Chen 2021].
//!
//! A plain list has one vertex (from 0) per line; blank lines and what follows a `#` are comments.
//! A published list has a line `vertex x y z` per clamped vertex, where a coordinate may be `#` for
//! an axis that is left free; before these the number of such lines, then a `#` line. Read are the
//! vertices only: positions and free axes are those of the published base solve.

use std::path::Path;

use crate::{Error, Result};

/// The vertices listed in the file at `path` (either kind), ascending, each once; all are below
/// `vertex_count`.
///
/// The file is taken as a published list if any line looks like `vertex x y z`. Its vertices count
/// as listed even if all their axes are free.
///
/// # Errors
/// [`Error::File`] if the file cannot be read; [`Error::Parse`] with the line for: no vertex at
/// all, something that is not a vertex index, an index that is not below `vertex_count`, a wrong
/// number of columns, a coordinate that is neither a finite number nor `#`, and a published list
/// whose first line does not say how many follow.
pub fn read_clamped_vertices(path: &Path, vertex_count: usize) -> Result<Vec<usize>> {
    let text = super::disk::read_text(path).map_err(|source| Error::reading(path, source))?;
    parse(path, &text, vertex_count)
}

/// A line that is not blank or a comment: its number (from 1) and words.
type Line<'a> = (usize, Vec<&'a str>);

fn parse(path: &Path, text: &str, vertex_count: usize) -> Result<Vec<usize>> {
    let words = |line| str::split_ascii_whitespace(line).collect();
    let lines: Vec<Line<'_>> = text
        .trim_start_matches('\u{feff}')
        .lines()
        .map(words)
        .zip(1..)
        .map(|(w, n)| (n, w))
        .collect();
    let lines: Vec<Line<'_>> = lines
        .into_iter()
        .filter(|(_, w): &Line<'_>| w.first().is_some_and(|w| !w.starts_with('#')))
        .collect();
    if lines.is_empty() {
        let message = "the file names no vertex; give one vertex index (from 0) per line";
        return Err(Error::parse(path, 1, message));
    }
    let published = lines.iter().any(|(_, words)| {
        words.len() == 4
            && words[0].parse::<usize>().is_ok()
            && words[1..].iter().all(is_coordinate)
    });
    let mut vertices = if published {
        published_list(path, &lines, vertex_count)?
    } else {
        plain_list(path, &lines, vertex_count)?
    };
    vertices.sort_unstable();
    vertices.dedup();
    Ok(vertices)
}

/// The vertex that `word` in `line` names.
fn vertex(path: &Path, line: usize, word: &str, vertex_count: usize) -> Result<usize> {
    let v: usize = word.parse().map_err(|_| {
        Error::parse(path, line, format!("'{word}' is not a vertex index; count vertices from 0"))
    })?;
    if v >= vertex_count {
        let message = format!(
            "vertex {v} is clamped, but the mesh has only {vertex_count} vertices (from 0); \
             correct the index"
        );
        return Err(Error::parse(path, line, message));
    }
    Ok(v)
}

/// Vertices of lines `vertex x y z`, of which the first may say how many follow.
fn published_list(path: &Path, lines: &[Line<'_>], vertex_count: usize) -> Result<Vec<usize>> {
    let mut vertices = Vec::with_capacity(lines.len());
    let counted = lines[0].1.len() == 1;
    for (line, words) in &lines[usize::from(counted)..] {
        if words.len() != 4 {
            let message = format!(
                "this line has {} column(s); give four (vertex x y z, with # for a free axis)",
                words.len()
            );
            return Err(Error::parse(path, *line, message));
        }
        if let Some(word) = words[1..].iter().find(|w| !is_coordinate(w)) {
            let message = format!("'{word}' is no coordinate; give a number, or # for a free axis");
            return Err(Error::parse(path, *line, message));
        }
        vertices.push(vertex(path, *line, words[0], vertex_count)?);
    }
    if counted && lines[0].1[0].parse() != Ok(vertices.len()) {
        let (line, said, found) = (lines[0].0, lines[0].1[0], vertices.len());
        let message = format!(
            "the first line says '{said}', but {found} clamped vertices follow up to line {}; \
             correct it",
            lines[lines.len() - 1].0
        );
        return Err(Error::parse(path, line, message));
    }
    Ok(vertices)
}

/// Vertices of lines with one index each.
fn plain_list(path: &Path, lines: &[Line<'_>], vertex_count: usize) -> Result<Vec<usize>> {
    let mut vertices = Vec::with_capacity(lines.len());
    for (line, words) in lines {
        let columns = words.iter().take_while(|w| !w.starts_with('#')).count();
        if columns != 1 {
            let message = format!(
                "this line has {columns} column(s); give one vertex index per line, or four \
                 columns (vertex x y z)"
            );
            return Err(Error::parse(path, *line, message));
        }
        let word = words[0].split('#').next().unwrap_or_default();
        vertices.push(vertex(path, *line, word, vertex_count)?);
    }
    Ok(vertices)
}

fn is_coordinate(word: &&str) -> bool {
    *word == "#" || word.parse::<f64>().is_ok_and(f64::is_finite)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn listed(text: &str) -> Vec<usize> {
        parse(Path::new("clamp.dat"), text, 50).unwrap()
    }

    fn message(text: &str) -> String {
        parse(Path::new("clamp.dat"), text, 50).unwrap_err().to_string()
    }

    #[test]
    fn plain_lists_are_sorted_and_merged() {
        assert_eq!(listed("7\n 3 # left corner\n\n# rim\r\n49\n3\n0#first\n"), [0, 3, 7, 49]);
        assert_eq!(listed("5"), [5]);
        // Two lines in which the first would be a count, were the list a published one.
        assert_eq!(listed("1\n2"), [1, 2]);
    }

    #[test]
    fn published_lists_give_their_vertices() {
        assert_eq!(listed("4\n#\n9 0.08 0 0\n1 # 1e-2 #\n\n2 -1 # 3\n9 0 0 0\n\n"), [1, 2, 9]);
        assert_eq!(listed("9 0.08 0 0\n1 # # #\n"), [1, 9]);
    }

    #[test]
    fn errors_name_the_line_and_what_is_wrong() {
        assert!(message("").contains("clamp.dat, line 1: the file names no vertex"));
        assert!(message("# only\n\n#this\n").contains("names no vertex"));
        assert!(message("1\n\nx\n").contains("line 3: 'x' is not a vertex index"));
        assert!(message("1\n-2\n").contains("line 2: '-2' is not a vertex index"));
        assert!(
            message("1\n50\n")
                .contains("line 2: vertex 50 is clamped, but the mesh has only 50 vertices")
        );
        assert!(message("1\n2 3\n").contains("line 2: this line has 2 column(s)"));
        assert!(
            message("2\n#\n1 0 0 0\n2 0 0\n")
                .contains("line 4: this line has 3 column(s); give four")
        );
        assert!(message("1 0 0 0\n2\n").contains("line 2: this line has 1 column(s); give four"));
        assert!(message("2\n#\n1 0 0 0\n2 0 nan 0\n").contains("line 4: 'nan' is no coordinate"));
        assert!(message("2\n#\n1 0 0 0\nx 0 0 0\n").contains("line 4: 'x' is not a vertex index"));
        assert!(message("2\n#\n1 0 0 0\n50 0 0 0\n").contains("line 4: vertex 50 is clamped"));
        assert!(
            message("# counted\n3\n#\n1 0 0 0\n2 0 0 0\n")
                .contains("line 2: the first line says '3', but 2 clamped vertices follow")
        );
    }

    #[test]
    fn a_missing_file_is_told() {
        let error = read_clamped_vertices(Path::new("/nowhere/clamp.dat"), 3).unwrap_err();
        assert!(error.to_string().contains("/nowhere/clamp.dat"));
    }
}
