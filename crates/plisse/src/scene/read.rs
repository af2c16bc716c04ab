//! From text to a checked [`Scene`], with messages for people: line, field, what is wrong, and what is allowed.

use std::path::Path;

use super::schema::Scene;
use crate::{Error, Result};

/// Fields that each table must have, by the table's header. A test holds this list against the schema.
const REQUIRED: [(&str, &[&str]); 9] = [
    ("", &["title", "material", "panel"]),
    ("material", &["young_pa", "poisson", "thickness_m"]),
    ("panel", &["name", "shape", "edge_length_m"]),
    ("panel.place", &["kind"]),
    ("panel.place, if rolled", &["radius_m"]),
    ("seam", &["a", "b"]),
    ("clamp", &["side"]),
    ("clamp.turn", &["axis", "angle_deg"]),
    ("measure", &["name", "kind"]),
];

/// The scene in the file at `path`.
///
/// # Errors
/// [`Error::File`] if the file cannot be read; the errors of [`parse`].
pub fn read(path: impl AsRef<Path>) -> Result<Scene> {
    let path = path.as_ref();
    let text = std::fs::read_to_string(path).map_err(|source| Error::reading(path, source))?;
    parse(path, &text)
}

/// The scene in `text`, which came from `path` (for messages only).
///
/// # Errors
/// [`Error::Parse`] with the line for: wrong TOML, an unknown or missing field, a value of the wrong type. [`Error::Value`]
/// whose field is "path, dotted.field" for: a number that is not finite or out of its range, a name that is used twice or
/// that nothing has, a size that the panel's shape asks for or does not have.
pub fn parse(path: impl AsRef<Path>, text: &str) -> Result<Scene> {
    let path = path.as_ref();
    // The byte order mark is replaced by a blank, so that offsets stay on their lines.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut scene: Scene = toml::from_str(text).map_err(|error| explain(path, text, &error))?;
    scene.file = path.to_path_buf();
    scene.check().map_err(|error| in_file(path, error))?;
    Ok(scene)
}

/// `error` with the scene's file before the field's name.
pub(super) fn in_file(path: &Path, error: Error) -> Error {
    match error {
        Error::Value { field, message } => Error::Value { field: format!("{}, {field}", path.display()), message },
        other => other,
    }
}

/// What the TOML reader says, as one sentence with the line.
fn explain(path: &Path, text: &str, error: &toml::de::Error) -> Error {
    let offset = error.span().map_or(0, |span| span.start.min(text.len()));
    let line = 1 + text.as_bytes()[..offset].iter().filter(|&&b| b == b'\n').count();
    let here = text.lines().nth(line - 1).unwrap_or_default().trim();
    let table = table_of(text, line);
    let key = if here.starts_with('[') { "" } else { here.split_once('=').map_or("", |(key, _)| key.trim()) };
    let dotted = [table, key].iter().filter(|part| !part.is_empty()).copied().collect::<Vec<_>>().join(".");
    Error::parse(path, line, sentence(error.message(), table, &dotted))
}

/// Name in the last table header at or above `line` (from 1), "" above the first.
fn table_of(text: &str, line: usize) -> &str {
    let headers = text.lines().take(line).map(str::trim).filter(|l| l.starts_with('['));
    headers.last().map_or("", |h| h.split(']').next().unwrap_or_default().trim_matches(['[', ' ']))
}

/// `message` in plain words; it happened in `table`, at the field `dotted`.
fn sentence(message: &str, table: &str, dotted: &str) -> String {
    if let Some(missing) = quoted_after(message, "missing field ") {
        let lists = |name: &str| REQUIRED.iter().find(|(t, fields)| *t == name && fields.contains(&missing));
        // An inline table is found by its dotted name, one of its own by its header.
        let rolled = (missing == "radius_m").then_some("panel.place, if rolled");
        let found = rolled.and_then(lists).or_else(|| lists(dotted)).or_else(|| lists(table)).or_else(|| lists(""));
        return found.map_or_else(
            || format!("the field {missing} is missing; add it"),
            |(name, fields)| {
                let place = if name.is_empty() { "the scene".to_owned() } else { format!("the table {name}") };
                format!("{place} has no {missing}; it must have {}", fields.join(", "))
            },
        );
    }
    if let Some(unknown) = quoted_after(message, "unknown field ") {
        return format!("there is no field {unknown} here; correct its spelling or remove it (allowed are {})", allowed(message));
    }
    if let Some(unknown) = quoted_after(message, "unknown variant ") {
        return format!("{dotted} cannot be \"{unknown}\"; give one of {}", allowed(message));
    }
    for start in ["invalid type: ", "invalid value: ", "invalid length "] {
        if let Some((found, expected)) = message.strip_prefix(start).and_then(|rest| rest.split_once(", expected ")) {
            let found = if start == "invalid length " { format!("of length {found}") } else { found.replace('`', "") };
            return format!("{dotted} is {found}; give {}", in_words(expected));
        }
    }
    let one_line = message.lines().map(str::trim).collect::<Vec<_>>().join(", ");
    format!("this is not TOML ({one_line}); correct the line")
}

/// The name in backquotes after `start`.
fn quoted_after<'a>(message: &'a str, start: &str) -> Option<&'a str> {
    message.strip_prefix(start)?.strip_prefix('`')?.split('`').next()
}

/// The names that serde lists after "expected".
fn allowed(message: &str) -> String {
    let list = message.split_once(", expected ").map_or("none", |(_, list)| list);
    list.trim_start_matches("one of ").replace('`', "").replace(" or ", ", ")
}

/// A type of serde's in plain words.
fn in_words(expected: &str) -> &str {
    match expected {
        "f64" => "a number",
        "u64" | "usize" => "a whole number, 0 or more",
        "a boolean" => "true or false",
        "a string" => "text in quotes",
        "a sequence" => "a list in [ ]",
        "an array of length 2" => "two numbers in [ ]",
        "an array of length 3" => "three numbers in [ ]",
        other if other.starts_with("struct ") || other.contains("enum") => "a table",
        other => other,
    }
}
