//! `plisse wrinkle` from outside: what it writes, and that bad input gives one sentence, exit code
//! 2 and no output.

mod harness;

use std::path::Path;
use std::process::Output;

use harness::{Folder, assert_refused, plisse, sheet, whole_report};

fn wrinkle(rest: &Path, pose: &Path, out: &Path, more: &[&str]) -> Output {
    let material = ["--young", "1e6", "--poisson", "0.3", "--thickness", "1e-3"];
    let mut command = plisse();
    command.arg("wrinkle").arg("--rest").arg(rest).arg("--pose").arg(pose).arg("-o").arg(out);
    for pair in material.chunks(2) {
        if !more.contains(&pair[0]) {
            command.args(pair);
        }
    }
    command.args(more).output().unwrap()
}

#[test]
fn every_file_is_written_and_the_report_is_whole() {
    let folder = Folder::new("files");
    for quads in [false, true] {
        let rest = folder.write("rest.obj", sheet(10, 1.0, quads));
        let pose = folder.write("pose.obj", sheet(10, 0.97, quads));
        let out = folder.0.join(format!("out-{quads}"));
        let output = wrinkle(&rest, &pose, &out, &["--levels", "1"]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let report = whole_report(&out);
        assert_eq!(report["vertices"], 121);
        assert_eq!(report["faces"], 200);
        for key in
            ["wrinkle_free_faces", "generators", "iterations", "energy_joule", "projected_gradient"]
        {
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
        let field: serde_json::Value =
            serde_json::from_slice(&std::fs::read(out.join("field.json")).unwrap()).unwrap();
        assert_eq!(field["amplitude"].as_array().unwrap().len(), 121);
        assert_eq!(field["phase"].as_array().unwrap().len(), 200);
        assert_eq!(
            field["edges"].as_array().unwrap().len(),
            field["omega"].as_array().unwrap().len()
        );
        let shown = String::from_utf8_lossy(&output.stdout);
        assert!(shown.contains("amplitude") && shown.contains("wavelength"), "{shown}");
    }
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let folder = Folder::new("threads");
    let rest = folder.write("rest.obj", sheet(12, 1.0, false));
    let pose = folder.write("pose.obj", sheet(12, 0.95, false));
    let files: Vec<Vec<Vec<u8>>> = ["1", "2"]
        .iter()
        .map(|threads| {
            let out = folder.0.join(format!("out-{threads}"));
            assert!(
                wrinkle(&rest, &pose, &out, &["--threads", threads, "--levels", "2"])
                    .status
                    .success()
            );
            ["base.obj", "wrinkled.obj", "wrinkled.glb", "field.json", "picture.png"]
                .iter()
                .map(|name| std::fs::read(out.join(name)).unwrap())
                .collect()
        })
        .collect();
    assert_eq!(files[0], files[1]);
}

#[test]
fn errors_about_bad_files_name_the_place_and_the_fix() {
    let folder = Folder::new("bad");
    let rest = folder.write("rest.obj", sheet(3, 1.0, false));
    let pose = folder.write("pose.obj", sheet(3, 0.9, false));
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

    assert_refused(
        &wrinkle(&folder.0.join("none.obj"), &pose, &out, &[]),
        &out,
        &["none.obj", "check the path"],
    );
    bad_rest("empty.obj", "", &["empty"]);
    bad_pose("nan.obj", &line("v 0 0 0", "v 0 NaN 0"), &["line 1"]);
    bad_pose("infinite.obj", &line("v 0 0 0", "v 0 1e999 0"), &["line 1"]);
    bad_pose("index.obj", &line("f 1 2 6", "f 1 2 77"), &["line 17", "77"]);
    bad_pose("count.obj", &line("f 1 2 6\n", ""), &["17", "triangles"]);
    bad_pose("twice.obj", &line("f 1 2 6", "f 1 2 2"), &["face 0", "twice"]);
    bad_pose("flipped.obj", &line("f 1 2 6", "f 2 1 6"), &["disagree"]);
    bad_pose(
        "three.obj",
        &line("f 1 6 5", "f 1 6 11").replace("f 6 7 11", "f 6 1 7"),
        &["shared by 3 faces", "split"],
    );
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
                let shifted: Vec<String> = face
                    .split(' ')
                    .map(|i| (i.parse::<usize>().unwrap() + 1).to_string())
                    .collect();
                format!("f {}\n", shifted.join(" "))
            }
            None => format!("{line}\n"),
        })
        .collect()
}

#[test]
fn bad_flags_are_told() {
    let folder = Folder::new("flags");
    let rest = folder.write("rest.obj", sheet(3, 1.0, false));
    let pose = folder.write("pose.obj", sheet(3, 0.9, false));
    let out = folder.0.join("out");
    for (flags, needles) in [
        (&["--poisson", "0.6"][..], &["poisson", "0.6", "0.5"][..]),
        (&["--poisson", "-1"], &["poisson", "above -1"]),
        (&["--thickness", "0"], &["thickness", "above 0"]),
        (&["--thickness", "-1e-3"], &["thickness"]),
        (&["--young", "nan"], &["Young"]),
        (&["--without", "gravity"], &["gravity", "curvature"]),
    ] {
        let output = wrinkle(&rest, &pose, &out, flags);
        assert_refused(&output, &out, needles);
    }
    // Two faces stay under the limit even after all levels that can be asked for.
    let (rest, pose) = (
        folder.write("rest-2.obj", sheet(1, 1.0, false)),
        folder.write("pose-2.obj", sheet(1, 0.9, false)),
    );
    assert!(wrinkle(&rest, &pose, &out, &["--levels", "8", "--no-picture"]).status.success());
    std::fs::remove_dir_all(&out).unwrap();
    let clamp = folder.write("clamp.txt", "0\n1\n99\n");
    assert_refused(
        &wrinkle(&rest, &pose, &out, &["--clamp", clamp.to_str().unwrap()]),
        &out,
        &["clamp.txt", "line 3", "99"],
    );
    assert_refused(
        &wrinkle(&rest, &pose, &out, &["--clamp", "nowhere.txt"]),
        &out,
        &["nowhere.txt"],
    );
}

#[test]
fn an_output_folder_that_cannot_be_written_is_told_before_any_work() {
    let folder = Folder::new("unwritable");
    let rest = folder.write("rest.obj", sheet(3, 1.0, false));
    let pose = folder.write("pose.obj", sheet(3, 0.9, false));
    let file = folder.write("file", "keep me");
    let output = wrinkle(&rest, &pose, &file.join("out"), &[]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("choose a folder"));
    assert_eq!(std::fs::read_to_string(file).unwrap(), "keep me");
}
