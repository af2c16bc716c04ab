//! ARCHITECTURE.md against the code: the crates it names, the walls between them, and the order of
//! the library's modules.

mod code;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;

use code::{Source, blanked, sources};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn read(path: impl AsRef<Path>) -> String {
    std::fs::read_to_string(path.as_ref())
        .unwrap_or_else(|e| panic!("{}: {e}", path.as_ref().display()))
}

/// Names in backquotes in the first cells of a Markdown table's rows, below `heading`.
fn first_cells(text: &str, heading: &str) -> Vec<Vec<String>> {
    let section = text.split(heading).nth(1).unwrap_or_else(|| panic!("no heading {heading}"));
    let section = section.split("\n## ").next().unwrap();
    let cell = |line: &str| -> Vec<String> {
        line.split('|').nth(1).unwrap().split('`').skip(1).step_by(2).map(str::to_owned).collect()
    };
    section.lines().filter(|line| line.starts_with("| `")).map(cell).collect()
}

/// Names of the packages that each package is built with.
type Dependencies = BTreeMap<String, BTreeSet<String>>;

/// Packages in the manifests of the workspace's packages, tests aside: by their own names, whatever
/// a manifest calls them and on whatever platform they are needed.
fn dependencies() -> Dependencies {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--no-deps", "--format-version", "1", "--offline"])
        .current_dir(root())
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let metadata: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let name = |value: &serde_json::Value| value["name"].as_str().unwrap().to_owned();
    let built_with = |package: &serde_json::Value| -> BTreeSet<String> {
        let all = package["dependencies"].as_array().unwrap();
        all.iter().filter(|dependency| dependency["kind"] != "dev").map(name).collect()
    };
    let packages = metadata["packages"].as_array().unwrap();
    packages.iter().map(|package| (name(package), built_with(package))).collect()
}

/// The same, with the packages that the workspace's own ones bring along.
fn with_those_of_the_workspace(direct: &Dependencies) -> Dependencies {
    let mut all = direct.clone();
    // As many rounds as the longest chain may have.
    for _ in 0..direct.len() {
        for own in all.values_mut() {
            let brought: Vec<String> =
                own.iter().filter_map(|other| direct.get(other)).flatten().cloned().collect();
            own.extend(brought);
        }
    }
    all
}

/// Packages by which a program is more than a library.
const TERMINAL: [&str; 3] = ["clap", "ctrlc", "indicatif"];
const WINDOW: [&str; 4] = ["eframe", "egui", "egui-winit", "winit"];
const GPU: [&str; 2] = ["wgpu", "naga"];
const PYTHON: [&str; 1] = ["pyo3"];

/// Packages that a crate must not be built with, directly or by way of the workspace's crates.
const WALLS: [(&str, &[&[&str]]); 5] = [
    (
        "plisse",
        &[
            &TERMINAL,
            &WINDOW,
            &GPU,
            &PYTHON,
            &["plisse-live", "plisse-gpu", "plisse-studio", "plisse-cli"],
        ],
    ),
    (
        "plisse-live",
        &[&TERMINAL, &WINDOW, &GPU, &PYTHON, &["plisse-gpu", "plisse-studio", "plisse-cli"]],
    ),
    ("plisse-gpu", &[&TERMINAL, &WINDOW, &PYTHON, &["plisse-studio", "plisse-cli"]]),
    ("plisse-studio", &[&["ctrlc", "indicatif"], &PYTHON, &["plisse-cli"]]),
    ("plisse-cli", &[&WINDOW, &PYTHON, &["plisse-studio"]]),
];

/// Packages that a crate must not name in its own manifest: it reaches them through the crate whose
/// part they are.
const NOT_DIRECTLY: [(&str, &[&str]); 2] = [
    ("plisse-cli", &["faer", "nalgebra", "parry3d-f64", "robust", "spade", "wgpu"]),
    ("plisse-studio", &["faer", "parry3d-f64", "robust", "spade"]),
];

#[test]
fn the_crate_table_lists_the_crates_there_are() {
    let table = first_cells(&read(root().join("ARCHITECTURE.md")), "## Crates").concat();
    let listed: BTreeSet<String> = table.into_iter().collect();
    let there: BTreeSet<String> = std::fs::read_dir(root().join("crates"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    assert_eq!(listed, there);
    assert_eq!(listed, dependencies().into_keys().collect());
    assert_eq!(listed, WALLS.map(|(name, _)| name.to_owned()).into());
}

#[test]
fn no_crate_is_built_with_what_it_must_not_know() {
    let direct = dependencies();
    let all = with_those_of_the_workspace(&direct);
    for (name, walls) in WALLS {
        for forbidden in walls.concat() {
            assert!(!all[name].contains(forbidden), "{name} is built with {forbidden}");
        }
    }
    for (name, walls) in NOT_DIRECTLY {
        for &forbidden in walls {
            assert!(!direct[name].contains(forbidden), "{name} names {forbidden}");
        }
    }
    // The invariants that people read name them too.
    let text = read(root().join("ARCHITECTURE.md"));
    for name in ["clap", "indicatif", "wgpu", "egui", "pyo3"] {
        assert!(text.contains(&format!("`{name}`")), "ARCHITECTURE.md does not name {name}");
    }
}

#[test]
fn the_studios_document_and_brush_know_no_window_gpu_or_file_system() {
    let inner = |source: &Source| {
        source.modules.first().is_some_and(|m| m == "document" || m.starts_with("brush"))
    };
    let all = sources(&root().join("crates/plisse-studio/src"));
    let files: Vec<&Source> = all.iter().filter(|source| inner(source)).collect();
    assert!(files.len() > 5, "only {} files were found", files.len());
    for file in files {
        for forbidden in ["egui", "eframe", "wgpu", "plisse_gpu", "std::fs"] {
            assert!(!file.code.contains(forbidden), "{}: {forbidden}", file.path.display());
        }
    }
}

#[test]
fn modules_use_only_what_lies_before_them() {
    let order = first_cells(&read(root().join("ARCHITECTURE.md")), "## Inside `crates/plisse/src`");
    let rank = |module: &str| order.iter().position(|row| row.iter().any(|name| name == module));
    let mut checked = 0;
    for file in sources(&root().join("crates/plisse/src")) {
        let Some(module) = file.modules.first() else { continue };
        let own = rank(module)
            .unwrap_or_else(|| panic!("ARCHITECTURE.md does not place the module {module}"));
        for used in file.used() {
            let Some(other) = rank(&used) else { continue };
            let path = file.path.display();
            assert!(other <= own, "{path} uses crate::{used}, which comes after {module}");
            checked += 1;
        }
    }
    assert!(checked > 250, "only {checked} uses were found");
}

#[test]
fn comments_strings_and_test_items_are_not_read() {
    let source = Source {
        path: PathBuf::new(),
        modules: vec!["a".to_owned(), "b".to_owned()],
        code: blanked(
            "use crate::{one, two::{x, y}, three}; // crate::four\n'\\'' \"crate::five\" 'a",
        ),
    };
    assert_eq!(source.used(), ["one", "two", "three"]);
    let source = Source { code: "super::x super::super::six::y".to_owned(), ..source };
    assert_eq!(source.used(), ["six"]);
    let text = "r#\"crate::a \"quoted\" \"# b\"\\\"crate::b\" /* crate::c */ crate::d";
    let text = format!("{text} #[cfg(test)] mod tests {{ use crate::e; }} use crate::f;");
    assert_eq!(
        Source { code: code::without_tests(&blanked(&text)).0, ..source }.used(),
        ["d", "f"]
    );
}

/// Files of the crates with one of these extensions, and their text.
fn files(extensions: &[&str]) -> Vec<(PathBuf, String)> {
    let (mut list, mut folders) = (Vec::new(), vec![root().join("crates")]);
    while let Some(folder) = folders.pop() {
        for path in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| extensions.iter().any(|x| e == *x)) {
                list.push((path.clone(), read(path)));
            }
        }
    }
    list
}

#[test]
fn no_line_has_more_than_100_columns() {
    let mut wide = Vec::new();
    for (path, text) in files(&["rs", "wgsl"]) {
        let lines = text.lines().enumerate().filter(|(_, line)| line.chars().count() > 100);
        wide.extend(lines.map(|(at, _)| format!("{}:{}", path.display(), at + 1)));
    }
    assert!(wide.is_empty(), "{} lines are too wide:\n{}", wide.len(), wide.join("\n"));
}

/// Comments that begin with a question word instead of the noun they are about; there were 639.
#[test]
fn doc_comments_begin_with_the_noun() {
    const MOST: usize = 150;
    let words = ["What", "Whether", "How", "Where", "Which", "Who", "Why"];
    let doc = |line: &str| line.starts_with("///") || line.starts_with("//!");
    let mut found = Vec::new();
    for (path, text) in files(&["rs"]) {
        let mut before = "";
        for (at, line) in text.lines().map(str::trim_start).enumerate() {
            if doc(line) && !doc(before) {
                let text = line[3..].trim_start();
                // After the shape of an array.
                let text = match text.strip_prefix("`[").and_then(|rest| rest.split_once("` ")) {
                    Some((_, rest)) => rest,
                    None => text,
                };
                if words.contains(&text.split(' ').next().unwrap_or_default()) {
                    found.push(format!("{}:{}", path.display(), at + 1));
                }
            }
            before = line;
        }
    }
    assert!(found.len() <= MOST, "{} of them, {MOST} allowed:\n{}", found.len(), found.join("\n"));
}
