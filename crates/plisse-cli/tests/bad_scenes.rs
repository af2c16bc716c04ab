//! Bad input for `plisse solve` from outside: each gives one sentence that names the place and the
//! fix, exit code 2, and no files; soon, whatever it asks for.

mod harness;

use std::path::Path;
use std::time::{Duration, Instant};

use harness::{Folder, assert_refused, names, plisse, whole_report};

/// A small scene that solves in no time; the cases below spoil it.
const SCENE: &str = r#"title = "Two sheets"

[material]
young_pa = 1e7
poisson = 0.3
thickness_m = 1e-3

[[panel]]
name = "p"
shape = "rectangle"
width_m = 1.0
height_m = 0.5
edge_length_m = 0.1

[[panel]]
name = "q"
shape = "rectangle"
width_m = 1.0
height_m = 0.4
edge_length_m = 0.1
place = { kind = "flat", origin_m = [1.0, 0.0, 0.0] }

[[panel]]
name = "r"
shape = "rectangle"
width_m = 1.0
height_m = 0.5
edge_length_m = 0.1
place = { kind = "flat", origin_m = [0.0, 0.5, 0.0] }

[[seam]]
a = "p.top"
b = "r.bottom"
reversed = true

[[clamp]]
side = "p.left"

[[clamp]]
side = "p.right"
move_m = [-0.01, 0.0, 0.0]

[[clamp]]
side = "q.left"
axes = "xyz"

[surface]
levels = 1
"#;

/// Refusing takes no longer than this (a case takes milliseconds; only eating memory or solving
/// takes longer).
const SOON: Duration = Duration::from_secs(5);

/// The scene with the first `from` replaced.
fn spoilt(from: &str, to: &str) -> String {
    assert!(SCENE.contains(from), "the scene has no {from}");
    SCENE.replacen(from, to, 1)
}

/// Runs `plisse solve` on a file `name` with `content`, sees it refused and nothing left.
fn refuse(name: &str, content: impl AsRef<[u8]>, needles: &[&str]) {
    let folder = Folder::new(&format!("bad-{name}"));
    let scene = folder.write(name, content);
    let out = folder.0.join("out");
    let begun = Instant::now();
    let output = plisse().arg("solve").arg(&scene).arg("-o").arg(&out).output().unwrap();
    assert!(begun.elapsed() < SOON, "{name} took {:?}", begun.elapsed());
    assert_refused(&output, &out, &[&[name][..], needles].concat());
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(text.contains("; "), "the fix is missing: {text}");
    assert_eq!(names(&folder.0), [name], "nothing else is left");
}

#[test]
fn the_unspoilt_scene_is_solved() {
    let folder = Folder::new("unspoilt");
    let scene = folder.write("good.toml", SCENE);
    let out = folder.0.join("out");
    let output = plisse().arg("solve").arg(&scene).arg("-o").arg(&out).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(whole_report(&out)["surface"]["levels"], 1);
}

#[test]
fn wrong_text_names_file_and_line() {
    refuse("empty.toml", "", &["title, material, panel"]);
    refuse("blank.toml", "\n \n# nothing\n", &["title, material, panel"]);
    refuse("syntax.toml", spoilt("poisson = 0.3", "poisson = = 0.3"), &["line 5", "not TOML"]);
    refuse("unclosed.toml", spoilt("[material]", "[material"), &["line 3", "not TOML"]);
    refuse("twice.toml", spoilt("poisson = 0.3", "young_pa = 0.3"), &["line 5", "duplicate"]);
    refuse(
        "unknown.toml",
        spoilt("poisson = 0.3", "poison = 0.3"),
        &["line 5", "poison", "poisson"],
    );
    refuse("table.toml", format!("{SCENE}\n[gravity]\nx = 1\n"), &["line 50", "gravity"]);
    refuse("missing.toml", spoilt("thickness_m = 1e-3\n", ""), &["line 3", "thickness_m"]);
    refuse(
        "nopanel.toml",
        "title = \"t\"\n[material]\nyoung_pa = 1\npoisson = 0\nthickness_m = 1\n",
        &["panel"],
    );
    refuse(
        "type.toml",
        spoilt("young_pa = 1e7", "young_pa = \"soft\""),
        &["line 4", "young_pa", "number"],
    );
    refuse("list.toml", spoilt("[-0.01, 0.0, 0.0]", "[-0.01, 0.0]"), &["move_m", "three numbers"]);
    refuse("negative.toml", spoilt("levels = 1", "levels = -1"), &["levels", "whole number"]);
    refuse("garbage.toml", (0..=255_u8).cycle().take(5000).collect::<Vec<u8>>(), &["text file"]);
    refuse("zeros.toml", [0; 4096], &["line 1"]);
    refuse("model.glb", b"glTF\x02\0\0\0\xff\xff", &["text file"]);
}

#[test]
fn wrong_values_name_file_and_field() {
    for (n, (from, to, needles)) in [
        ("poisson = 0.3", "poisson = 0.6", &["material.poisson", "0.6", "0.5"][..]),
        ("poisson = 0.3", "poisson = -1", &["material.poisson", "above -1"]),
        ("poisson = 0.3", "poisson = nan", &["material.poisson", "NaN"]),
        ("thickness_m = 1e-3", "thickness_m = 0", &["material.thickness_m", "above 0"]),
        ("thickness_m = 1e-3", "thickness_m = inf", &["material.thickness_m"]),
        ("young_pa = 1e7", "young_pa = -1e7", &["material.young_pa", "-1"]),
        ("young_pa = 1e7", "young_pa = nan", &["material.young_pa"]),
        ("width_m = 1.0", "width_m = nan", &["panel[0].width_m", "NaN"]),
        ("width_m = 1.0", "width_m = inf", &["panel[0].width_m", "inf"]),
        ("width_m = 1.0", "width_m = -1.0", &["panel[0].width_m", "-1"]),
        ("height_m = 0.5", "height_m = 0.0", &["panel[0].height_m", "above 0"]),
        ("edge_length_m = 0.1", "edge_length_m = nan", &["panel[0].edge_length_m", "NaN"]),
        ("edge_length_m = 0.1", "edge_length_m = 0", &["panel[0].edge_length_m"]),
        ("edge_length_m = 0.1", "edge_length_m = 0.6", &["panel[0].edge_length_m", "0.5"]),
        ("edge_length_m = 0.1", "edge_length_m = 1e-7", &["panel[0].edge_length_m", "vertices"]),
        ("edge_length_m = 0.1", "edge_length_m = 1e-300", &["panel[0].edge_length_m"]),
        ("shape = \"rectangle\"", "shape = \"circle\"", &["line 10", "circle", "disk"]),
        ("shape = \"rectangle\"", "shape = \"disk\"", &["panel[0]", "radius_m"]),
        ("name = \"q\"", "name = \"p\"", &["panel[1].name", "panel[0]"]),
        ("origin_m = [1.0", "origin_m = [inf", &["panel[1].place.origin_m", "inf"]),
        ("a = \"p.top\"", "a = \"p.upper\"", &["seam[0].a", "upper", "top"]),
        ("a = \"p.top\"", "a = \"top\"", &["seam[0].a", "p.bottom"]),
        ("a = \"p.top\"", "a = \"r.bottom\"", &["seam[0].b", "itself"]),
        ("a = \"p.top\"\nb = \"r.bottom\"", "a = \"p.right\"\nb = \"q.left\"", &["seam", "length"]),
        ("b = \"r.bottom\"", "b = \"r.top\"", &["seam[0]", "apart"]),
        (
            "b = \"r.bottom\"\nreversed = true",
            "b = \"r.bottom\"\nreversed = false",
            &["seam[0]", "apart", "reversed"],
        ),
        (
            "side = \"q.left\"",
            "side = \"q.leftmost\"",
            &["clamp[2].side", "leftmost", "bottom, right, top, left"],
        ),
        ("side = \"q.left\"", "side = \"z.left\"", &["clamp[2].side", "\"z\"", "p, q, r"]),
        ("side = \"q.left\"", "side = \"\"", &["clamp[2].side", "panel.side"]),
        ("axes = \"xyz\"", "axes = \"xw\"", &["clamp[2].axes", "xw"]),
        ("axes = \"xyz\"", "axes = \"yz\"", &["clamp", "\"q\"", "along x"]),
        ("side = \"p.right\"", "side = \"p.bottom\"", &["clamp[1]", "clamp[0]", "x"]),
        ("side = \"p.right\"", "side = \"p.left\"", &["clamp[1]", "clamp[0]", "x"]),
        ("[-0.01, 0.0, 0.0]", "[nan, 0.0, 0.0]", &["clamp[1].move_m", "NaN"]),
        ("levels = 1", "levels = 9", &["surface.levels", "9", "8"]),
        ("levels = 1", "levels = 18446744073709551615", &["levels"]),
        ("title = \"Two sheets\"", "title = \"\"", &["title"]),
    ]
    .into_iter()
    .enumerate()
    {
        refuse(&format!("value-{n}.toml"), spoilt(from, to), needles);
    }
    let no_clamp = SCENE.split("[[clamp]]").next().unwrap();
    refuse("no-clamp.toml", no_clamp, &["clamp", "[[clamp]]"]);
}

#[test]
fn seams_loads_and_meshes_that_do_not_fit_are_told() {
    for (n, (from, to, needles)) in [
        ("a = \"p.top\"", "a = \"z.top\"", &["seam[0].a", "\"z\"", "p, q, r"][..]),
        (
            "a = \"p.top\"\nb = \"r.bottom\"",
            "a = \"p.right\"\nb = \"q.right\"",
            &["seam 0", "equally long"],
        ),
        (
            "[surface]",
            "[load]\npressure_pa = 600.0\n\n[surface]",
            &["load.pressure_pa", "open at side \"p.bottom\"", "sew every side"],
        ),
        (
            "[surface]",
            "[load]\ngravity_m_s2 = [0.0, 0.0, -9.81]\n\n[surface]",
            &["material.density_kg_m3", "gravity needs a density"],
        ),
        (
            "[surface]",
            "[mesh]\nworn = \"worn.obj\"\nmetres_per_uv = 1.0\n\n[surface]",
            &["mesh", "panels and a mesh", "keep one"],
        ),
        (
            "[surface]",
            "[[force]]\nnewton = [0.0, 0.0, 1.0]\n\n[surface]",
            &["force[0]", "side, near_m and within_m"],
        ),
        (
            "[surface]",
            "[[obstacle]]\nname = \"block\"\nkind = \"mesh\"\nfile = \"none.obj\"\n\n[surface]",
            &["obstacle[0].file", "none.obj", "spelling"],
        ),
        (
            "side = \"q.left\"",
            "within_m = { low = [5.0, 5.0, 5.0], high = [6.0, 6.0, 6.0] }",
            &[
                "clamp[2].within_m",
                "no vertex starts in this box",
                "[2.000000, 1.000000, 0.000000]",
            ],
        ),
    ]
    .into_iter()
    .enumerate()
    {
        refuse(&format!("fit-{n}.toml"), spoilt(from, to), needles);
    }
}

#[test]
fn an_obstacle_with_holes_is_told() {
    let folder = Folder::new("holes");
    folder.write("block.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\n");
    let scene = folder.write(
        "holes.toml",
        spoilt(
            "[surface]",
            "[[obstacle]]\nname = \"block\"\nkind = \"mesh\"\nfile = \"block.obj\"\n\n[surface]",
        ),
    );
    let out = folder.0.join("out");
    let output = plisse().arg("solve").arg(&scene).arg("-o").arg(&out).output().unwrap();
    assert_refused(
        &output,
        &out,
        &["holes.toml", "obstacle[0]", "block.obj", "has holes", "close the mesh"],
    );
}

#[test]
fn levels_that_would_make_too_many_faces_are_refused_before_the_solve() {
    // More than 50,000 faces: six levels make more than 200 million.
    let fine = SCENE
        .replace("edge_length_m = 0.1", "edge_length_m = 0.008")
        .replace("levels = 1", "levels = 6");
    refuse("fine.toml", &fine, &["surface.levels", "6 levels", "ask for 4"]);
    let folder = Folder::new("levels-flag");
    let scene = folder.write("fine.toml", &fine);
    let out = folder.0.join("out");
    let output =
        plisse().arg("solve").arg(&scene).args(["--levels", "8", "-o"]).arg(&out).output().unwrap();
    assert_refused(&output, &out, &["--levels", "8 levels", "ask for 4"]);
}

#[test]
fn paths_that_are_no_files_are_told() {
    let folder = Folder::new("paths");
    let out = folder.0.join("out");
    let solve =
        |scene: &Path| plisse().arg("solve").arg(scene).arg("-o").arg(&out).output().unwrap();
    assert_refused(&solve(&folder.0.join("none.toml")), &out, &["none.toml", "spelling"]);
    assert_refused(&solve(&folder.0), &out, &[folder.0.to_str().unwrap(), "directory", "; "]);
    let scene = folder.write("scene.toml", SCENE);
    assert_refused(&solve(&scene.join("scene.toml")), &out, &["scene.toml", "; "]);
}

#[test]
fn an_output_path_that_is_no_folder_is_told_and_left_alone() {
    let folder = Folder::new("output");
    let scene = folder.write("scene.toml", SCENE);
    let file = folder.write("file", "keep me");
    for out in [file.clone(), file.join("out"), file.join("out/deeper")] {
        let output = plisse().arg("solve").arg(&scene).arg("-o").arg(&out).output().unwrap();
        let text = String::from_utf8_lossy(&output.stderr);
        assert_eq!((output.status.code(), text.trim().lines().count()), (Some(2), 1), "{text}");
        assert!(text.contains("file") && text.contains("choose a folder"), "{text}");
    }
    assert_eq!(std::fs::read_to_string(file).unwrap(), "keep me");
    assert_eq!(names(&folder.0), ["file", "scene.toml"]);
    // A folder in the place of an output file is found only at the end; the folder is left as it
    // was.
    let out = folder.0.join("out");
    std::fs::create_dir_all(out.join("report.json")).unwrap();
    let output = plisse().arg("solve").arg(&scene).arg("-o").arg(&out).output().unwrap();
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(2) && text.contains("report.json"), "{text}");
    assert_eq!(names(&out), ["report.json"]);
}

#[test]
fn bad_flags_are_told() {
    let folder = Folder::new("solve-flags");
    let scene = folder.write("scene.toml", SCENE);
    let scene = scene.to_str().unwrap();
    let out = folder.0.join("out");
    for (arguments, needles) in [
        (&["solve", scene, "--threads", "0"][..], &["--threads", "1..=1024"][..]),
        (&["solve", scene, "--threads", "many"], &["--threads", "many"]),
        (&["solve", scene, "--levels", "99"], &["--levels", "0..=8"]),
        (&["solve", scene, "--levels", "-1"], &["-1"]),
        (&["solve", scene, "--without", "nonsense"], &["--without", "nonsense", "curvature"]),
        (&["solve", scene, "--without", ""], &["--without", "curvature"]),
        (&["solve", scene, "--without", "v1,nonsense"], &["nonsense"]),
        (&["solve", scene, "--gravity"], &["--gravity"]),
        (&["solve", scene, scene], &["unexpected"]),
        (&["solve", ""], &["SCENE.toml", "required"]),
        (&["solve"], &["SCENE.toml", "required"]),
        (&["iron", scene], &["iron"]),
        (&[""], &["subcommand"]),
    ] {
        let mut command = plisse();
        command.args(arguments);
        if arguments[0] == "solve" {
            command.arg("-o").arg(&out);
        }
        let output = command.current_dir(&folder.0).output().unwrap();
        let text = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {text}");
        assert!(text.starts_with("error: ") && !text.contains("panicked"), "{text}");
        for needle in needles {
            assert!(text.contains(needle), "'{needle}' is not in: {text}");
        }
        assert_eq!(names(&folder.0), ["scene.toml"], "{arguments:?}");
    }
    let output = plisse().args(["solve", scene, "-o", ""]).current_dir(&folder.0).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(names(&folder.0), ["scene.toml"]);
}
