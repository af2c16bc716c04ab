//! Tables of a study, with a published number beside each of ours, as Markdown and as JSON.

use serde::Serialize;
use serde_json::{Map, Value};

/// A cell: the number, and as it is shown.
pub(crate) struct Cell {
    shown: String,
    value: Value,
}

impl Cell {
    /// Shown as a lower bound.
    pub(crate) fn above(mut self) -> Self {
        self.shown.insert_str(0, "> ");
        self
    }
}

/// A whole number.
pub(crate) fn count(n: impl TryInto<i64>) -> Cell {
    let n = n.try_into().unwrap_or(i64::MAX);
    Cell { shown: n.to_string(), value: n.into() }
}

/// A number with so many digits after the point.
pub(crate) fn fixed(value: f64, digits: usize) -> Cell {
    Cell { shown: format!("{value:.digits$}"), value: value.into() }
}

/// A number with an exponent.
pub(crate) fn scientific(value: f64) -> Cell {
    Cell { shown: format!("{value:.4e}"), value: value.into() }
}

/// Words.
pub(crate) fn text(words: impl Into<String>) -> Cell {
    let words = words.into();
    Cell { shown: words.clone(), value: words.into() }
}

/// Nothing is known.
pub(crate) fn none() -> Cell {
    Cell { shown: "–".to_owned(), value: Value::Null }
}

/// A cell of what may be missing.
pub(crate) fn maybe<T>(value: Option<T>, cell: impl Fn(T) -> Cell) -> Cell {
    value.map_or_else(none, cell)
}

/// A table.
#[derive(Serialize)]
pub(crate) struct Table {
    title: String,
    /// Explanation, with the source of the published numbers.
    text: String,
    #[serde(skip)]
    columns: Vec<&'static str>,
    /// Each row by its columns' names.
    rows: Vec<Map<String, Value>>,
    #[serde(skip)]
    shown: Vec<Vec<String>>,
}

/// A picture beside the tables.
#[derive(Serialize)]
pub(crate) struct Illustration {
    pub(crate) file: String,
    pub(crate) caption: String,
}

/// Tables, pictures and notes of a study.
#[derive(Serialize)]
pub(crate) struct Document {
    pub(crate) name: &'static str,
    pub(crate) title: &'static str,
    pub(crate) plisse: &'static str,
    /// The command that writes it again.
    pub(crate) command: String,
    /// Logical cores of the machine, and threads used.
    pub(crate) cores: usize,
    pub(crate) threads: usize,
    /// True if no row is missing.
    pub(crate) complete: bool,
    pub(crate) tables: Vec<Table>,
    pub(crate) pictures: Vec<Illustration>,
    pub(crate) notes: Vec<String>,
}

impl Document {
    /// Begins a table; rows that follow go into it.
    pub(crate) fn table(&mut self, title: &str, text: &str, columns: &[&'static str]) {
        self.tables.push(Table {
            title: title.to_owned(),
            text: text.to_owned(),
            columns: columns.to_vec(),
            rows: Vec::new(),
            shown: Vec::new(),
        });
    }

    /// A row of the last table, a cell for each column.
    pub(crate) fn row(&mut self, cells: impl IntoIterator<Item = Cell>) {
        let table = self.tables.last_mut().expect("a table was begun");
        let cells: Vec<Cell> = cells.into_iter().collect();
        assert_eq!(cells.len(), table.columns.len(), "a cell for each column of '{}'", table.title);
        table.shown.push(cells.iter().map(|cell| cell.shown.replace('|', "/")).collect());
        table.rows.push(
            table
                .columns
                .iter()
                .map(|&name| name.to_owned())
                .zip(cells.into_iter().map(|cell| cell.value))
                .collect(),
        );
    }

    /// The study as Markdown; its heading has `level` hashes.
    pub(crate) fn markdown(&self, level: usize) -> String {
        let mut out = format!("{} {}\n\n", "#".repeat(level), self.title);
        if !self.complete {
            out += "**Interrupted: the rows so far.**\n\n";
        }
        for table in &self.tables {
            out += &format!("{} {}\n\n{}\n\n", "#".repeat(level + 1), table.title, table.text);
            out += &format!(
                "| {} |\n|{}\n",
                table.columns.join(" | "),
                "---|".repeat(table.columns.len())
            );
            for row in &table.shown {
                out += &format!("| {} |\n", row.join(" | "));
            }
            out.push('\n');
        }
        for note in &self.notes {
            out += &format!("- {note}\n");
        }
        if !self.notes.is_empty() {
            out.push('\n');
        }
        for picture in &self.pictures {
            out += &format!("![{0}]({1})\n\n{0}\n\n", picture.caption, picture.file);
        }
        out
    }

    /// Machine and command, a line of Markdown.
    pub(crate) fn origin(&self) -> String {
        format!(
            "Written by `{}` (plisse {}) on {} cores with {} threads.\n\n",
            self.command, self.plisse, self.cores, self.threads
        )
    }
}
