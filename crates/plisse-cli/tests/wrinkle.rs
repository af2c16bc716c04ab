//! `plisse wrinkle` from outside: what it writes, and that bad input gives one sentence, exit code 2 and no output.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A folder of its own for one test, removed at the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("plisse-wrinkle-{name}-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn write(&self, name: &str, text: &str) -> PathBuf {
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

/// An `n × n` sheet of side 1 m as OBJ text, squeezed in x; an irregular grid of triangles, or of quads.
fn sheet(n: usize, squeeze: f64, quads: bool) -> String {
    let mut text = String::new();
    let inner = |i: usize| i > 0 && i < n;
    for j in 0..=n {
        for i in 0..=n {
            let jitter =
                |k: usize| if inner(i) && inner(j) { 0.3 / n as f64 * (((i * 7 + j * 13 + k) as f64 * 0.618).fract() - 0.5) } else { 0.0 };
            writeln!(text, "v {} {} 0", (i as f64 / n as f64 + jitter(0)) * squeeze, j as f64 / n as f64 + jitter(5)).unwrap();
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

fn wrinkle(rest: &Path, pose: &Path, out: &Path, more: &[&str]) -> Output {
    let material = ["--young", "1e6", "--poisson", "0.3", "--thickness", "1e-3"];
    let mut command = Command::new(env!("CARGO_BIN_EXE_plisse"));
    command.arg("wrinkle").arg("--rest").arg(rest).arg("--pose").arg(pose).arg("-o").arg(out);
    for pair in material.chunks(2) {
        if !more.contains(&pair[0]) {
            command.args(pair);
        }
    }
    command.args(more).output().unwrap()
}

/// One sentence that holds all of `needles`, exit code 2, no output folder.
fn assert_refused(output: &Output, out: &Path, needles: &[&str]) {
    let text = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{text}");
    assert_eq!(text.trim().lines().count(), 1, "{text}");
    for needle in needles {
        assert!(text.contains(needle), "'{needle}' is not in: {text}");
    }
    assert!(!out.exists(), "{} was left behind", out.display());
}

#[test]
fn every_file_is_written_and_the_report_is_whole() {
    let folder = Folder::new("files");
    for quads in [false, true] {
        let rest = folder.write("rest.obj", &sheet(10, 1.0, quads));
        let pose = folder.write("pose.obj", &sheet(10, 0.97, quads));
        let out = folder.0.join(format!("out-{quads}"));
        let output = wrinkle(&rest, &pose, &out, &["--levels", "1"]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        for name in ["base.obj", "wrinkled.obj", "wrinkled.glb", "field.json", "report.json", "picture.png"] {
            assert!(std::fs::metadata(out.join(name)).unwrap().len() > 100, "{name}");
        }
        assert_eq!(std::fs::read_dir(&out).unwrap().count(), 6, "nothing else is left");
        let report: serde_json::Value = serde_json::from_slice(&std::fs::read(out.join("report.json")).unwrap()).unwrap();
        assert_eq!(report["vertices"], 121);
        assert_eq!(report["faces"], 200);
        for key in ["wrinkle_free_faces", "generators", "iterations", "energy_joule", "projected_gradient"] {
            assert!(report[key].is_number(), "{key}");
        }
        for (key, parts) in [
            ("amplitude_m", &["max", "mean"][..]),
            ("wavelength_m", &["min", "median", "max"]),
            ("seconds", &["base", "field", "phase", "surface", "total"]),
        ] {
            for part in parts {
                assert!(report[key][part].is_number(), "{key}.{part}");
            }
        }
        assert!(report["amplitude_m"]["max"].as_f64().unwrap() > 1e-4);
        let field: serde_json::Value = serde_json::from_slice(&std::fs::read(out.join("field.json")).unwrap()).unwrap();
        assert_eq!(field["amplitude"].as_array().unwrap().len(), 121);
        assert_eq!(field["phase"].as_array().unwrap().len(), 200);
        assert_eq!(field["edges"].as_array().unwrap().len(), field["omega"].as_array().unwrap().len());
        let shown = String::from_utf8_lossy(&output.stdout);
        assert!(shown.contains("amplitude") && shown.contains("wavelength"), "{shown}");
    }
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let folder = Folder::new("threads");
    let rest = folder.write("rest.obj", &sheet(12, 1.0, false));
    let pose = folder.write("pose.obj", &sheet(12, 0.95, false));
    let files: Vec<Vec<Vec<u8>>> = ["1", "2"]
        .iter()
        .map(|threads| {
            let out = folder.0.join(format!("out-{threads}"));
            assert!(wrinkle(&rest, &pose, &out, &["--threads", threads, "--levels", "2"]).status.success());
            ["base.obj", "wrinkled.obj", "wrinkled.glb", "field.json", "picture.png"]
                .iter()
                .map(|name| std::fs::read(out.join(name)).unwrap())
                .collect()
        })
        .collect();
    assert_eq!(files[0], files[1]);
}

#[test]
fn bad_files_are_told_with_the_place_and_the_mend() {
    let folder = Folder::new("bad");
    let rest = folder.write("rest.obj", &sheet(3, 1.0, false));
    let pose = folder.write("pose.obj", &sheet(3, 0.9, false));
    let out = folder.0.join("out");
    let bad_rest = |name: &str, text: &str, needles: &[&str]| {
        let bad = folder.write(name, text);
        assert_refused(&wrinkle(&bad, &pose, &out, &[]), &out, &[&[name][..], needles].concat());
    };
    let bad_pose = |name: &str, text: &str, needles: &[&str]| {
        let bad = folder.write(name, text);
        assert_refused(&wrinkle(&rest, &bad, &out, &[]), &out, &[&[name][..], needles].concat());
    };
    let good = sheet(3, 1.0, false);
    let line = |from: &str, to: &str| good.replacen(from, to, 1);

    assert_refused(&wrinkle(&folder.0.join("none.obj"), &pose, &out, &[]), &out, &["none.obj", "check the path"]);
    bad_rest("empty.obj", "", &["empty"]);
    bad_pose("nan.obj", &line("v 0 0 0", "v 0 NaN 0"), &["line 1"]);
    bad_pose("infinite.obj", &line("v 0 0 0", "v 0 1e999 0"), &["line 1"]);
    bad_pose("index.obj", &line("f 1 2 6", "f 1 2 77"), &["line 17", "77"]);
    bad_pose("count.obj", &line("f 1 2 6\n", ""), &["17", "triangles"]);
    bad_pose("twice.obj", &line("f 1 2 6", "f 1 2 2"), &["face 0", "twice"]);
    bad_pose("flipped.obj", &line("f 1 2 6", "f 2 1 6"), &["disagree"]);
    bad_pose("three.obj", &line("f 1 6 5", "f 1 6 11").replace("f 6 7 11", "f 6 1 7"), &["shared by 3 faces", "split"]);
    bad_pose("isolated.obj", &format!("v 5 5 5\n{}", sheet_shifted(3)), &["vertex 0", "isolated"]);
    // Zero area: a face whose three corners lie on the lower edge.
    bad_rest("area.obj", &line("f 1 2 6", "f 1 2 3"), &["face 0"]);
    bad_rest("turned.obj", &line("f 1 2 6", "f 2 1 6"), &["face 0"]);
}

/// The 3 × 3 sheet with all indices one higher.
fn sheet_shifted(n: usize) -> String {
    sheet(n, 0.9, false)
        .lines()
        .map(|line| match line.strip_prefix("f ") {
            Some(face) => {
                let shifted: Vec<String> = face.split(' ').map(|i| (i.parse::<usize>().unwrap() + 1).to_string()).collect();
                format!("f {}\n", shifted.join(" "))
            }
            None => format!("{line}\n"),
        })
        .collect()
}

#[test]
fn bad_flags_are_told() {
    let folder = Folder::new("flags");
    let rest = folder.write("rest.obj", &sheet(3, 1.0, false));
    let pose = folder.write("pose.obj", &sheet(3, 0.9, false));
    let out = folder.0.join("out");
    for (flags, needles) in [
        (&["--poisson", "0.6"][..], &["poisson", "0.6", "0.5"][..]),
        (&["--poisson", "-1"], &["poisson", "above -1"]),
        (&["--thickness", "0"], &["thickness", "above 0"]),
        (&["--thickness", "-1e-3"], &["thickness"]),
        (&["--young", "nan"], &["Young"]),
        (&["--without", "gravity"], &["gravity", "curvature"]),
        (&["--levels", "8", "--no-picture"], &[]),
    ] {
        let output = wrinkle(&rest, &pose, &out, flags);
        if needles.is_empty() {
            assert!(output.status.success(), "18 faces stay under the limit even after 8 levels");
            std::fs::remove_dir_all(&out).unwrap();
        } else {
            assert_refused(&output, &out, needles);
        }
    }
    let clamp = folder.write("clamp.txt", "0\n1\n99\n");
    assert_refused(&wrinkle(&rest, &pose, &out, &["--clamp", clamp.to_str().unwrap()]), &out, &["clamp.txt", "line 3", "99"]);
    assert_refused(&wrinkle(&rest, &pose, &out, &["--clamp", "nowhere.txt"]), &out, &["nowhere.txt"]);
}

#[test]
fn an_output_folder_that_cannot_be_written_is_told_before_any_work() {
    let folder = Folder::new("unwritable");
    let rest = folder.write("rest.obj", &sheet(3, 1.0, false));
    let pose = folder.write("pose.obj", &sheet(3, 0.9, false));
    let file = folder.write("file", "keep me");
    let output = wrinkle(&rest, &pose, &file.join("out"), &[]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("choose a folder"));
    assert_eq!(std::fs::read_to_string(file).unwrap(), "keep me");
}
