//! Shared helpers of the tests of the `plisse` command: temporary folders, and the checks that
//! every successful and every refused run must pass.

// Each test file takes what it needs.
#![allow(dead_code)]

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Every file of a run, in alphabetical order.
pub(crate) const FILES: [&str; 6] =
    ["base.obj", "field.json", "picture.png", "report.json", "wrinkled.glb", "wrinkled.obj"];

/// A folder of its own for one test, removed at the end.
pub(crate) struct Folder(pub(crate) PathBuf);

impl Folder {
    pub(crate) fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("plisse-cli-{name}-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    pub(crate) fn write(&self, name: &str, text: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.join(name);
        std::fs::write(&path, text).unwrap();
        path
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// The command, ready for arguments.
pub(crate) fn plisse() -> Command {
    Command::new(env!("CARGO_BIN_EXE_plisse"))
}

/// Names of all files in `folder`, hidden ones too, in alphabetical order.
pub(crate) fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .unwrap()
        .map(|e| e.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

/// report.json of a run that left exactly the six files, none of them short.
pub(crate) fn whole_report(out: &Path) -> serde_json::Value {
    assert_eq!(names(out), FILES, "{}", out.display());
    for name in FILES {
        assert!(std::fs::metadata(out.join(name)).unwrap().len() > 100, "{name}");
    }
    json(&out.join("report.json"))
}

/// One sentence that holds all of `needles`, exit code 2, no output folder.
pub(crate) fn assert_refused(output: &Output, out: &Path, needles: &[&str]) {
    let text = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{text}");
    assert_eq!(text.trim().lines().count(), 1, "{text}");
    assert!(text.starts_with("error: ") && output.stdout.is_empty(), "{text}");
    for needle in needles {
        assert!(text.contains(needle), "'{needle}' is not in: {text}");
    }
    assert!(!out.exists(), "{} was left behind", out.display());
}

/// An example scene's file.
pub(crate) fn example(name: &str) -> PathBuf {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples")).join(name)
}

/// The text of an example scene in which each field named has another value.
pub(crate) fn changed(name: &str, changes: &[(&str, &str)]) -> String {
    let mut text = std::fs::read_to_string(example(name)).unwrap();
    for (field, value) in changes {
        let line =
            text.lines().find(|line| line.starts_with(&format!("{field} = "))).unwrap().to_owned();
        text = text.replacen(&line, &format!("{field} = {value}"), 1);
    }
    text
}

/// `plisse solve SCENE -o OUT` with more arguments; it must succeed.
pub(crate) fn solve(scene: &Path, out: &Path, more: &[&str]) -> Output {
    let output = plisse().arg("solve").arg(scene).arg("-o").arg(out).args(more).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    output
}

/// The JSON in a file.
pub(crate) fn json(path: &Path) -> serde_json::Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

/// An `n × n` sheet of side 1 m as OBJ text, squeezed in x; an irregular grid of triangles, or of
/// quads.
pub(crate) fn sheet(n: usize, squeeze: f64, quads: bool) -> String {
    let mut text = String::new();
    let inner = |i: usize| i > 0 && i < n;
    for j in 0..=n {
        for i in 0..=n {
            let jitter = |k: usize| {
                if inner(i) && inner(j) {
                    0.3 / n as f64 * (((i * 7 + j * 13 + k) as f64 * 0.618).fract() - 0.5)
                } else {
                    0.0
                }
            };
            writeln!(
                text,
                "v {} {} 0",
                (i as f64 / n as f64 + jitter(0)) * squeeze,
                j as f64 / n as f64 + jitter(5)
            )
            .unwrap();
        }
    }
    for j in 0..n {
        for i in 0..n {
            let at = |i: usize, j: usize| j * (n + 1) + i + 1;
            let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
            if quads {
                writeln!(text, "f {a} {b} {c} {d}").unwrap();
            } else {
                writeln!(text, "f {a} {b} {c}\nf {a} {c} {d}").unwrap();
            }
        }
    }
    text
}
