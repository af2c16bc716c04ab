//! ARCHITECTURE.md against the code: the crates it names, what they must not know, and the order of
//! the modules.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

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
    section
        .lines()
        .filter(|line| line.starts_with("| `"))
        .map(|line| {
            line.split('|')
                .nth(1)
                .unwrap()
                .split('`')
                .skip(1)
                .step_by(2)
                .map(str::to_owned)
                .collect()
        })
        .collect()
}

#[test]
fn the_crate_table_lists_the_crates_there_are() {
    let listed: BTreeSet<String> = first_cells(&read(root().join("ARCHITECTURE.md")), "## Crates")
        .concat()
        .into_iter()
        .collect();
    let there: BTreeSet<String> = std::fs::read_dir(root().join("crates"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    assert_eq!(listed, there);
}

#[test]
fn the_library_knows_no_terminal_window_or_gpu() {
    let manifest = read(root().join("crates/plisse/Cargo.toml"));
    for forbidden in ["clap", "indicatif", "ctrlc", "wgpu", "egui", "eframe", "pyo3"] {
        let named = manifest.lines().any(|line| {
            line.starts_with(&format!("{forbidden}.")) || line.starts_with(&format!("{forbidden} "))
        });
        assert!(!named, "crates/plisse depends on {forbidden}");
    }
    // The shown invariant names them too.
    let text = read(root().join("ARCHITECTURE.md"));
    assert!(
        ["clap", "indicatif", "wgpu", "egui", "pyo3"]
            .iter()
            .all(|name| text.contains(&format!("`{name}`")))
    );
}

#[test]
fn modules_use_only_what_lies_before_them() {
    let order = first_cells(&read(root().join("ARCHITECTURE.md")), "## Inside `crates/plisse/src`");
    let rank = |module: &str| order.iter().position(|row| row.iter().any(|name| name == module));
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut checked = 0;
    for (module, file) in sources(&source) {
        if module == "lib" {
            continue;
        }
        let own = rank(&module)
            .unwrap_or_else(|| panic!("ARCHITECTURE.md does not place the module {module}"));
        // Tests at the end of a file may use what they like.
        let text = read(&file);
        let code = text.split("#[cfg(test)]").next().unwrap();
        for part in code.split("crate::").skip(1) {
            let used: String =
                part.chars().take_while(|c| c.is_ascii_lowercase() || *c == '_').collect();
            if let Some(other) = rank(&used) {
                assert!(
                    other <= own,
                    "{} uses crate::{used}, which comes after {module}",
                    file.display()
                );
                checked += 1;
            }
        }
    }
    assert!(checked > 50, "only {checked} uses were found");
}

/// Every source file with the top-level module it belongs to.
fn sources(folder: &Path) -> Vec<(String, PathBuf)> {
    let mut list = Vec::new();
    let mut todo = vec![(None::<String>, folder.to_path_buf())];
    while let Some((module, folder)) = todo.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let stem = path.file_stem().unwrap().to_str().unwrap().to_owned();
            let module = module.clone().unwrap_or_else(|| stem.clone());
            if path.is_dir() {
                todo.push((Some(module), path));
            } else if path.extension().is_some_and(|e| e == "rs") {
                list.push((module, path));
            }
        }
    }
    list
}
