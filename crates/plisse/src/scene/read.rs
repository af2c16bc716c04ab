//! From text to a checked [`Scene`], with messages for people: line, field, what is wrong, and what
//! is allowed.

use std::path::Path;

use super::schema::Scene;
use crate::{At, Error, Result};

/// Fields that each table must have, by the table's header. A test holds this list against the
/// schema.
const REQUIRED: [(&str, &[&str]); 18] = [
    ("", &["title", "material", "panel or mesh"]),
    ("material", &["young_pa", "poisson", "thickness_m"]),
    ("panel", &["name", "shape", "edge_length_m"]),
    ("panel.place", &["kind"]),
    ("panel.place, if rolled", &["radius_m"]),
    ("seam", &["a", "b"]),
    ("panel.sides", &["name", "corner"]),
    ("clamp.turn", &["axis", "angle_deg"]),
    ("clamp.within_m", &["low", "high"]),
    ("force", &["newton"]),
    ("force.within_m", &["low", "high"]),
    ("obstacle", &["name", "kind"]),
    ("obstacle.turn", &["axis", "angle_deg"]),
    ("measure", &["name", "kind"]),
    ("growth", &["expansion", "wavelength_m"]),
    ("growth.freeze.within_m", &["low", "high"]),
    ("growth.count", &["name", "panel"]),
    ("map of growth", &["kind", "low", "high"]),
];

/// The scene in the file at `path`.
///
/// # Errors
/// [`Error::File`] if the file cannot be read; the errors of [`parse`].
pub fn read(path: impl AsRef<Path>) -> Result<Scene> {
    let path = path.as_ref();
    let text = crate::io::disk::read_text(path).map_err(|source| Error::reading(path, source))?;
    parse(path, &text)
}

/// The scene in `text`, which came from `path` (for messages only).
///
/// # Errors
/// [`Error::Parse`] with the line for: wrong TOML, an unknown or missing field, a value of the
/// wrong type. [`Error::Value`] whose field is "path, dotted.field" for: a number that is not
/// finite or out of its range, a name that is used twice or that nothing has, a size that the
/// panel's shape asks for or does not have.
pub fn parse(path: impl AsRef<Path>, text: &str) -> Result<Scene> {
    let path = path.as_ref();
    // The byte order mark is replaced by a blank, so that offsets stay on their lines.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut scene: Scene = toml::from_str(text).map_err(|error| explain(path, text, &error))?;
    scene.file = path.to_path_buf();
    scene.check().at(path)?;
    Ok(scene)
}

/// The message of the TOML reader, as one sentence with the line.
fn explain(path: &Path, text: &str, error: &toml::de::Error) -> Error {
    let offset = error.span().map_or(0, |span| span.start.min(text.len()));
    let line = 1 + text.as_bytes()[..offset].iter().filter(|&&b| b == b'\n').count();
    // An inline table on a line of its own belongs to the key above.
    let lines = text.lines().take(line).map(str::trim);
    let here = lines.filter(|l| !l.starts_with('{')).last().unwrap_or_default();
    let table = table_of(text, line);
    let key = if here.starts_with('[') {
        ""
    } else {
        here.split_once('=').map_or("", |(key, _)| key.trim())
    };
    let dotted =
        [table, key].iter().filter(|part| !part.is_empty()).copied().collect::<Vec<_>>().join(".");
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
        let lists = |name: &str| {
            REQUIRED.iter().find(|(t, fields)| *t == name && fields.contains(&missing))
        };
        // An inline table is found by its dotted name, one of its own by its header.
        let rolled = (missing == "radius_m").then_some("panel.place, if rolled");
        let map = (table.starts_with("growth") && dotted != table).then_some("map of growth");
        let found = rolled
            .and_then(lists)
            .or_else(|| map.and_then(lists))
            .or_else(|| lists(dotted))
            .or_else(|| lists(table))
            .or_else(|| lists(""));
        return found.map_or_else(
            || format!("the field {missing} is missing; add it"),
            |(name, fields)| {
                let place = if name.is_empty() {
                    "the scene".to_owned()
                } else {
                    format!("the table {name}")
                };
                format!("{place} has no {missing}; it must have {}", fields.join(", "))
            },
        );
    }
    if let Some(unknown) = quoted_after(message, "unknown field ") {
        return format!(
            "there is no field {unknown} here; correct its spelling or remove it (allowed are {})",
            allowed(message)
        );
    }
    if let Some(unknown) = quoted_after(message, "unknown variant ") {
        return format!("{dotted} cannot be \"{unknown}\"; give one of {}", allowed(message));
    }
    for start in ["invalid type: ", "invalid value: ", "invalid length "] {
        if let Some((found, expected)) =
            message.strip_prefix(start).and_then(|rest| rest.split_once(", expected "))
        {
            let found = if start == "invalid length " {
                format!("of length {found}")
            } else {
                found.replace('`', "")
            };
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::build;
    use crate::scene::schema::Place;

    const FULL: &str = r#"title = "t"
[material]
young_pa = 1e7
poisson = 0.3
thickness_m = 1e-4
[[panel]]
name = "p"
shape = "rectangle"
width_m = 1.0
height_m = 0.5
edge_length_m = 0.1
place = { kind = "rolled", radius_m = 1.0 }
[[panel]]
name = "q"
shape = "disk"
radius_m = 1.0
edge_length_m = 0.3
[panel.place]
kind = "flat"
[[seam]]
a = "p.left"
b = "p.right"
[[clamp]]
side = "p.bottom"
turn = { axis = [0.0, 0.0, 1.0], angle_deg = 10.0 }
[[clamp]]
side = "q.rim"
[clamp.turn]
axis = [0.0, 0.0, 1.0]
angle_deg = 10.0
[base]
[field]
[surface]
[[measure]]
name = "m"
kind = "largest_period"
[[force]]
side = "p.top"
newton = [0.0, 0.0, 1.0]
[[obstacle]]
name = "floor"
kind = "plane"
point_m = [0.0, 0.0, -9.0]
normal = [0.0, 0.0, 1.0]
"#;

    fn message(text: &str) -> String {
        parse("s.toml", text).unwrap_err().to_string()
    }

    /// The message after replacing the first `from`.
    fn after(from: &str, to: &str) -> String {
        assert!(FULL.contains(from), "{from}");
        message(&FULL.replacen(from, to, 1))
    }

    #[test]
    fn defaults_are_filled_in() {
        let scene = parse("s.toml", &format!("\u{feff}{FULL}")).unwrap();
        assert_eq!(
            (scene.file.to_str(), scene.paper.as_str(), scene.panel[0].seed),
            (Some("s.toml"), "", 1)
        );
        assert_eq!(
            scene.panel[0].place,
            Place::Rolled { radius_m: 1.0, centre_m: [0.0; 3], start_deg: 0.0 }
        );
        assert_eq!(
            scene.panel[1].place,
            Place::Flat { origin_m: [0.0; 3], x_axis: [1.0, 0.0, 0.0], y_axis: [0.0, 1.0, 0.0] }
        );
        assert!(!scene.seam[0].reversed && scene.surface.v2 && !scene.surface.v1);
        assert_eq!((scene.clamp[0].axes.as_str(), scene.clamp[0].move_m), ("xyz", [0.0; 3]));
    }

    #[test]
    fn every_required_field_is_listed_when_it_is_missing() {
        let lines: Vec<&str> = FULL.lines().collect();
        let (mut table, mut found) = (String::new(), 0);
        for (n, line) in lines.iter().enumerate() {
            if line.starts_with('[') {
                table = line.trim_matches(['[', ']']).to_owned();
                continue;
            }
            let (key, rest) = line.split_once(" = ").unwrap();
            let required = REQUIRED.iter().find(|(t, fields)| *t == table && fields.contains(&key));
            if required.is_some() || rest.starts_with('{') {
                let mut fewer = lines.clone();
                let without_first = rest.replacen("kind = \"rolled\", ", "", 1).replacen(
                    "axis = [0.0, 0.0, 1.0], ",
                    "",
                    1,
                );
                let inline = format!("{key} = {without_first}");
                fewer[n] = if rest.starts_with('{') { &inline } else { "" };
                let text = message(&fewer.join("\n"));
                let list = match (table.as_str(), key) {
                    (_, "place") => "panel.place has no kind; it must have kind",
                    (_, "turn") => "clamp.turn has no axis; it must have axis, angle_deg",
                    _ => &format!(
                        "{table} has no {key}; it must have {}",
                        required.unwrap().1.join(", ")
                    )
                    .replace(" has no title", " the scene has no title"),
                };
                assert!(text.contains(list.trim_start()), "{text}\n{list}");
                found += 1;
            }
        }
        assert_eq!(found, 22);
        assert!(
            after("turn = {", "within_m = { low = [0, 0, 0] }\nturn = {")
                .contains("clamp.within_m has no high; it must have low, high")
        );
        let side = "place = { kind = \"rolled\"";
        assert!(
            after(side, &format!("sides = [{{ name = \"a\" }}]\n{side}"))
                .contains("panel.sides has no corner; it must have name, corner")
        );
        assert!(
            after("kind = \"rolled\", radius_m = 1.0", "kind = \"rolled\"")
                .contains("if rolled has no radius_m")
        );
        let text = message("title = \"t\"\n");
        assert!(
            text.contains("the scene has no material; it must have title, material, panel"),
            "{text}"
        );
    }

    #[test]
    fn unknown_names_come_with_the_allowed_ones_and_the_line() {
        let text = after("young_pa", "young");
        assert!(
            text.contains("s.toml, line 3: there is no field young here")
                && text.contains("young_pa, poisson, thickness_m"),
            "{text}"
        );
        let text = after("[base]", "[base]\ngravity = 9.81");
        assert!(text.contains("compressive_stiffness, iteration_limit"), "{text}");
        let text = after("[base]", "[wind]");
        assert!(text.contains("no field wind") && text.contains("measure"), "{text}");
        let text = after("\"disk\"", "\"circle\"");
        assert!(
            text.contains(
                "line 15: panel.shape cannot be \"circle\"; give one of rectangle, disk, \
                annulus, polygon, sphere, torus"
            ),
            "{text}"
        );
        let text = after("\"rolled\"", "\"draped\"");
        assert!(
            text.contains("line 12: panel.place cannot be \"draped\"; give one of flat, rolled"),
            "{text}"
        );
        let text = after("radius_m = 1.0 }", "radius_m = 1.0, pitch_m = 1.0 }");
        assert!(text.contains("line 12: there is no field pitch_m here"), "{text}");
    }

    #[test]
    fn wrong_types_and_wrong_toml_name_the_line() {
        let text = after("1e7", "\"stiff\"");
        assert!(
            text.contains("s.toml, line 3: material.young_pa is string \"stiff\"; give a number"),
            "{text}"
        );
        let text = after("[surface]", "[surface]\nlevels = -1");
        assert!(
            text.contains("surface.levels is integer -1; give a whole number, 0 or more"),
            "{text}"
        );
        let text = after("axis = [0.0, 0.0, 1.0]\n", "axis = [0.0, 1.0]\n");
        assert!(
            text.contains("clamp.turn.axis is of length 2; give three numbers in [ ]"),
            "{text}"
        );
        let text = after("poisson = 0.3", "poisson = = 0.3");
        assert!(text.contains("s.toml, line 4: this is not TOML"), "{text}");
        let text = after("poisson = 0.3", "young_pa = 0.3");
        assert!(text.contains("line 4") && text.contains("duplicate key"), "{text}");
        assert!(!text.contains('\n'));
        let text = read("/nowhere/s.toml").unwrap_err().to_string();
        assert!(text.contains("/nowhere/s.toml: reading failed"), "{text}");
    }

    #[test]
    fn the_documents_example_runs_and_its_tables_name_every_field() {
        let manual = include_str!("../../../../docs/scene-format.md");
        let examples: Vec<&str> = manual
            .split("```toml\n")
            .skip(1)
            .map(|rest| rest.split("```").next().unwrap())
            .collect();
        let scenes: Vec<_> =
            examples.iter().map(|text| parse("manual.toml", text).unwrap()).collect();
        let (growing, solved): (Vec<_>, Vec<_>) =
            scenes.iter().partition(|scene| scene.growth.is_some());
        assert_eq!(growing.len(), 1);
        crate::scene::build_growth(growing[0]).unwrap();
        let built: Vec<_> = solved.into_iter().map(|scene| build(scene).unwrap()).collect();
        assert_eq!(built.len(), 2);
        assert!(
            built[1].obstacles.len() == 1 && built[1].clamps.held().iter().all(|held| !held),
            "the second is hung at nothing"
        );
        for (table, more) in [
            ("", "zz = 1\n"),
            ("material", "[material]\nzz = 1\n"),
            ("panel", "[[panel]]\nzz = 1\n"),
            ("seam", "[[seam]]\nzz = 1\n"),
            ("clamp", "[[clamp]]\nzz = 1\n"),
            ("turn", "[[clamp]]\nturn = { zz = 1 }\n"),
            ("within_m", "[[clamp]]\nwithin_m = { zz = 1 }\n"),
            ("sides", "[[panel]]\nsides = [{ zz = 1 }]\n"),
            ("place", "[[panel]]\nplace = { kind = \"rolled\", radius_m = 1, zz = 1 }\n"),
            ("mesh", "[mesh]\nzz = 1\n"),
            ("load", "[load]\nzz = 1\n"),
            ("force", "[[force]]\nzz = 1\n"),
            ("contact", "[contact]\nzz = 1\n"),
            ("obstacle", "[[obstacle]]\nzz = 1\n"),
            ("turn of an obstacle", "[[obstacle]]\nturn = { zz = 1 }\n"),
            ("base", "[base]\nzz = 1\n"),
            ("field", "[field]\nzz = 1\n"),
            ("surface", "[surface]\nzz = 1\n"),
            ("measure", "[[measure]]\nzz = 1\n"),
            ("growth", "[growth]\nzz = 1\n"),
            ("growth.expansion", "[[growth.expansion]]\nzz = 1\n"),
            ("direction of growth", "[[growth.expansion]]\ndirection = { zz = 1 }\n"),
            ("a map", "[growth]\nbias = { zz = 1 }\n"),
            ("growth.freeze", "[[growth.freeze]]\nzz = 1\n"),
            ("growth.band", "[[growth.band]]\nzz = 1\n"),
            ("growth.remesh", "[growth.remesh]\nzz = 1\n"),
            ("growth.count", "[[growth.count]]\nzz = 1\n"),
        ] {
            let text = message(more);
            let names = text
                .split("(allowed are ")
                .nth(1)
                .unwrap_or_else(|| panic!("{text}"))
                .trim_end_matches(')');
            for name in names.split(", ") {
                assert!(
                    manual.contains(&format!("| `{name}` |")),
                    "docs/scene-format.md has no row for {name} of [{table}]"
                );
            }
        }
    }
}
