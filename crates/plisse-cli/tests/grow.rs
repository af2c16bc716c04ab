//! `plisse grow` from outside: files and figures of a small scene, the same bytes for any number of
//! threads, what is refused, and Ctrl-C.

mod harness;

use std::path::Path;
use std::process::Output;

use harness::{Folder, assert_refused, json, names, plisse};
use plisse::io::obj;
use serde_json::Value;

const FILES: [&str; 4] = ["folded.glb", "folded.obj", "picture.png", "report.json"];

/// Three folds across a small sheet.
const SCENE: &str = r#"title = "Three folds"

[material]
young_pa = 1e5
poisson = 0.0
thickness_m = 1e-3

[[panel]]
name = "sheet"
shape = "rectangle"
width_m = 1.0
height_m = 0.5
mesh = "rising"
columns = 21
rows = 6
edge_length_m = 0.05

[growth]
wavelength_m = 0.3333
coherence_m = 0.6
freeze = [{ side = "sheet.left" }, { side = "sheet.right" }]

[[growth.expansion]]
factor = 1.2
direction = [1.0, 0.0, 0.0]

[[growth.count]]
name = "folds"
panel = "sheet"
low_m = [0.05, 0.05]
high_m = [0.95, 0.45]
"#;

fn grow(scene: &Path, out: &Path, more: &[&str]) -> Output {
    plisse().arg("grow").arg(scene).arg("-o").arg(out).args(more).output().unwrap()
}

fn grown(scene: &Path, out: &Path, more: &[&str]) -> Value {
    let output = grow(scene, out, more);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    json(&out.join("report.json"))
}

/// A surface that grows has many equilibria; the one next to the path that it grew along has the
/// folds that were asked for, on this mesh and on one with edges half as long (docs/growth.md).
#[test]
fn growth_is_followed_to_the_nearest_folds() {
    let folder = Folder::new("grow-nearest");
    let scene =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/27-banded-scrunchy.toml");
    let report = grown(&scene, &folder.0.join("out"), &["--no-picture"]);
    assert_eq!(report["folds"][0]["folds"].as_f64().unwrap().round(), 15.0, "{}", report["folds"]);
}

#[test]
fn a_small_scene_folds_and_its_files_are_sound() {
    let folder = Folder::new("grow");
    let (scene, out) = (folder.write("scene.toml", SCENE), folder.0.join("out"));
    let output = grow(&scene, &out, &[]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(names(&out), FILES);
    let report = json(&out.join("report.json"));
    let figure =
        |key: &str| report[key].as_f64().unwrap_or_else(|| panic!("{key}: {}", report[key]));
    let keys = [
        "vertices",
        "faces",
        "area_start_m2",
        "area_asked_m2",
        "area_m2",
        "length_reached",
        "residual",
        "residual_newton",
    ];
    assert!(keys.iter().all(|key| figure(key).is_finite()));
    assert_eq!(
        (figure("vertices"), figure("faces"), figure("frozen_vertices")),
        (22.0 * 7.0, 2.0 * 21.0 * 6.0, 14.0)
    );
    assert!(
        (figure("area_asked_m2") - 0.6).abs() < 1e-9 && figure("area_m2") / 0.6 > 0.97,
        "{}",
        figure("area_m2")
    );
    assert!(figure("length_reached") > 0.97 && figure("residual") <= figure("tolerance"));
    assert!(report["ending"].as_str().unwrap().starts_with("converged"));
    let folds = &report["folds"][0];
    assert!(
        (folds["folds"].as_f64().unwrap() / 2.7 - 1.0).abs() < 0.15
            && folds["crests_within_10_deg"].as_f64().unwrap() > 0.9,
        "{folds}"
    );
    assert!(folds["peak_width"].is_number());
    let seconds = |part: &str| report["seconds"][part].as_f64().unwrap();
    let parts: f64 = ["setup", "grow", "measure", "picture", "files"].map(seconds).iter().sum();
    assert!(parts > 0.0 && parts <= 1.01 * seconds("total"), "{parts} {}", seconds("total"));
    // The same figures stand on the terminal.
    let shown = String::from_utf8_lossy(&output.stdout);
    assert!(
        shown.starts_with("Three folds\n")
            && shown.contains("154 vertices")
            && shown.contains(" folds, "),
        "{shown}"
    );
    // The mesh is that of the start, folded, and has texture coordinates; what is frozen has not
    // moved.
    let folded = obj::read(&out.join("folded.obj")).unwrap();
    assert_eq!((folded.positions.len(), folded.faces.len()), (154, 252));
    assert!(std::fs::read_to_string(out.join("folded.obj")).unwrap().contains("\nvt "));
    let high = folded.positions.iter().map(|p| p.z.abs()).fold(0.0, f64::max);
    assert!(high > 0.02, "{high}");
    assert_eq!(
        folded.positions.iter().filter(|p| p.z == 0.0 && (p.x == 0.0 || p.x == 1.0)).count(),
        14
    );
    assert_eq!(&std::fs::read(out.join("folded.glb")).unwrap()[..4], b"glTF");
}

#[test]
fn threads_do_not_matter_and_frames_lead_to_the_result() {
    let folder = Folder::new("grow-same");
    let scene = folder.write("scene.toml", SCENE.replace("factor = 1.2", "factor = 1.1"));
    let [one, two] = ["one", "two"].map(|name| folder.0.join(name));
    let first = grown(&scene, &one, &["--threads", "1", "--frames", "--no-picture"]);
    let second =
        grown(&scene, &two, &["--threads", "2", "--no-picture", "--frames", "--steps", "1"]);
    let frames = first["frames"].as_u64().unwrap();
    assert_eq!(
        (frames, first["steps"].as_array().unwrap().len() as u64),
        (second["frames"].as_u64().unwrap(), frames - 1)
    );
    let files = names(&one);
    assert_eq!(files.len() as u64, frames + 3);
    for name in files.iter().filter(|name| *name != "report.json") {
        assert!(
            std::fs::read(one.join(name)).unwrap() == std::fs::read(two.join(name)).unwrap(),
            "{name}"
        );
    }
    let frame = |n: u64| std::fs::read(one.join(format!("frame-{n:04}.obj"))).unwrap();
    assert!(frame(frames - 1) == std::fs::read(one.join("folded.obj")).unwrap());
    assert!(obj::read(&one.join("frame-0000.obj")).unwrap().positions.iter().all(|p| p.z == 0.0));
    // More steps, if asked; a run without frames takes those of the last one away.
    let third = grown(&scene, &one, &["--steps", "12", "--no-picture"]);
    assert!(third["steps"].as_array().unwrap().len() >= 12);
    assert_eq!(names(&one), ["folded.glb", "folded.obj", "report.json"]);
}

#[test]
fn an_image_lies_on_the_texture_coordinates() {
    let folder = Folder::new("grow-image");
    // White on the left, black on the right: 2 × 1 pixels, grey.
    let mut image = Vec::new();
    let mut encoder = png::Encoder::new(&mut image, 2, 1);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.write_header().unwrap().write_image_data(&[255, 0]).unwrap();
    folder.write("map.png", image);
    let map = "factor = { kind = \"image\", file = \"map.png\", low = 1.0, high = 1.3 }";
    let scene = folder.write("scene.toml", SCENE.replace("factor = 1.2", map));
    let out = folder.0.join("out");
    grown(&scene, &out, &["--no-picture"]);
    let folded = obj::read(&out.join("folded.obj")).unwrap();
    let high = |left: bool| {
        folded
            .positions
            .iter()
            .filter(|p| (p.x < 0.4) == left && (p.x < 0.4 || p.x > 0.75))
            .map(|p| p.z.abs())
            .fold(0.0, f64::max)
    };
    assert!(high(true) > 3.0 * high(false), "{} {}", high(true), high(false));
}

#[test]
fn what_cannot_grow_is_refused_in_one_sentence() {
    let folder = Folder::new("grow-refused");
    let out = folder.0.join("out");
    for (from, to, needles) in [
        (
            "wavelength_m = 0.3333",
            "wavelength_m = 0.05",
            &["scene.toml, growth.wavelength_m", "edges of 1.429e-2 m or less", "; refine"][..],
        ),
        (
            "factor = 1.2",
            "tensor = [1.0, 2.0, 1.0]",
            &["growth.expansion[0]", "positive definite", "; give"],
        ),
        (
            "{ side = \"sheet.left\" }, { side = \"sheet.right\" }",
            "{ map = 1.0 }",
            &["every vertex is frozen", "; leave some free"],
        ),
        (
            "factor = 1.2",
            "factor = { kind = \"image\", file = \"gone.png\", low = 1, high = 2 }",
            &["factor.file", "gone.png", ";"],
        ),
        (
            "factor = 1.2",
            "factor = 1.2\nwind = 1",
            &["scene.toml, line", "no field wind", "; correct"],
        ),
        ("factor = 1.2", "factor = 0", &["growth.expansion[0]", "; give"]),
        (
            "wavelength_m = 0.3333",
            "wavelength_m = 0.3333\nhold = -1",
            &["growth.hold", "-1 at vertex 0", "; give"],
        ),
        (
            "wavelength_m = 0.3333",
            "wavelength_m = 0.3333\nmode = \"fast\"",
            &["growth.mode", "variational, reference"],
        ),
        (
            "wavelength_m = 0.3333",
            "wavelength_m = 0.3333\nmode = \"reference\"\nstickiness = 1",
            &["growth.mode", "no loads, sticking or obstacles", "; remove"],
        ),
        (
            "wavelength_m = 0.3333",
            "wavelength_m = 0.3333\nmode = \"reference\"\nhold = 0.5",
            &["growth.hold", "no foundation", "; remove"],
        ),
        (
            "factor = 1.2",
            "factor = { kind = \"attribute\", name = \"red\", low = 1, high = 2 }",
            &["growth.expansion[0].factor.name", "vertices have none", "; start from"],
        ),
        (
            "factor = 1.2",
            "factor = { kind = \"attribute\", low = 1, high = 2 }",
            &["factor.name", "this is missing; the kind"],
        ),
        (
            "direction = [1.0, 0.0, 0.0]",
            "direction = { kind = \"attribute\" }",
            &["growth.expansion[0].direction", "needs names", "; give the three"],
        ),
        (
            "direction = [1.0, 0.0, 0.0]",
            "direction = { kind = \"around\" }",
            &["growth.expansion[0].direction", "needs an axis", "; give"],
        ),
        (
            "shape = \"rectangle\"",
            "shape = \"torus\"",
            &["panel[0].width_m: a torus has no such field; remove it"],
        ),
    ] {
        assert_eq!(SCENE.matches(from).count(), 1, "{from}");
        let scene = folder.write("scene.toml", SCENE.replace(from, to));
        assert_refused(&grow(&scene, &out, &[]), &out, needles);
    }
    let scene = folder.write("scene.toml", SCENE.split("[growth]").next().unwrap());
    assert_refused(&grow(&scene, &out, &[]), &out, &["does not say how it grows", "plisse solve"]);
    let solve = folder.write("scene.toml", SCENE);
    let output = plisse().arg("solve").arg(&solve).arg("-o").arg(&out).output().unwrap();
    assert_refused(&output, &out, &["nothing holds the surface"]);
}

#[test]
fn meshes_without_texture_or_manifold_are_refused() {
    let folder = Folder::new("grow-mesh");
    let out = folder.0.join("out");
    let scene = |factor: &str| {
        format!(
            "title = \"mesh\"\nmaterial = {{ young_pa = 1e5, poisson = 0, thickness_m = 1e-3 \
             }}\nmesh = {{ worn = \"a.obj\", rest = \"a.obj\" }}\n\
             [growth]\nwavelength_m = 9\nexpansion = [{{ factor = {factor} }}]\n"
        )
    };
    folder.write("image.png", "no image");
    let file = folder.write(
        "scene.toml",
        scene("{ kind = \"image\", file = \"image.png\", low = 1, high = 2 }"),
    );
    folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 3 2 4\n");
    assert_refused(&grow(&file, &out, &[]), &out, &["image.png", "no readable PNG", "; save"]);
    let mut image = Vec::new();
    let mut encoder = png::Encoder::new(&mut image, 1, 1);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.write_header().unwrap().write_image_data(&[9]).unwrap();
    folder.write("image.png", image);
    assert_refused(
        &grow(&file, &out, &[]),
        &out,
        &["factor.file", "no texture coordinates", "; export"],
    );
    let file = folder.write("scene.toml", scene("1.5"));
    folder
        .write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 1\nf 1 2 3\nf 3 2 4\nf 2 3 5\n");
    assert_refused(&grow(&file, &out, &[]), &out, &["a.obj", ";"]);
}

/// A square of two by two cells with a painted value on each vertex, as PLY text.
const PAINTED: &str = "ply\nformat ascii 1.0\nelement vertex 9\nproperty float x\nproperty float \
    y\nproperty float z\nproperty uchar red\n\
    property float grow\nproperty float dx\nproperty float dy\nelement face 8\nproperty list uchar \
    int vertex_indices\nend_header\n\
    0 0 0 255 1.1 1 0\n1 0 0 255 1.1 1 0\n2 0 0 255 1.1 1 0\n0 1 0 0 1 1 0\n1 1 0 0 1 1 0\n2 1 0 0 \
    1 1 0\n0 2 0 0 1 1 0\n1 2 0 0 1 1 0\n\
    2 2 0 0 1 1 0\n3 0 1 4\n3 0 4 3\n3 1 2 5\n3 1 5 4\n3 3 4 7\n3 3 7 6\n3 4 5 8\n3 4 8 7\n";

#[test]
fn painted_meshes_grow_as_painted() {
    let folder = Folder::new("grow-painted");
    let out = folder.0.join("out");
    folder.write("a.ply", PAINTED);
    let scene = |factor: &str, direction: &str| {
        let text = format!(
            "title = \"painted\"\nmaterial = {{ young_pa = 1e5, poisson = 0, thickness_m = 1e-3 \
             }}\nmesh = {{ start = \"a.ply\" }}\n\
             [growth]\nwavelength_m = 9\n[[growth.expansion]]\nfactor = {factor}\ndirection = \
             {direction}\n"
        );
        folder.write("scene.toml", text)
    };
    let fixed = "[1, 0, 0]";
    let area = |report: &Value| report["area_asked_m2"].as_f64().unwrap();
    // The lowest row of vertices is grown by a tenth; the third between is linear.
    let red = grown(
        &scene("{ kind = \"attribute\", name = \"red\", low = 1, high = 1.1 }", fixed),
        &out,
        &["--no-picture"],
    );
    assert!((4.05..4.15).contains(&area(&red)), "{}", area(&red));
    // The same number under another name, along attributes; low and high are values at 0 and 1.
    let names = "{ kind = \"attribute\", names = [\"dx\", \"dy\", \"dy\"] }";
    let same = grown(
        &scene("{ kind = \"attribute\", name = \"grow\", low = 0, high = 1 }", names),
        &out,
        &["--no-picture"],
    );
    assert!((area(&same) - area(&red)).abs() < 1e-6, "{} {}", area(&same), area(&red));
    std::fs::remove_dir_all(&out).unwrap();
    let missing = scene("{ kind = \"attribute\", name = \"blue\", low = 1, high = 2 }", fixed);
    assert_refused(
        &grow(&missing, &out, &[]),
        &out,
        &["factor.name", "no attribute \"blue\"", "; it has red, grow, dx, dy"],
    );
    let missing = scene("1.1", "{ kind = \"attribute\", names = [\"dx\", \"dy\", \"dz\"] }");
    assert_refused(
        &grow(&missing, &out, &[]),
        &out,
        &["direction.names", "no attribute \"dz\"", "; it has"],
    );
    let image = scene("{ kind = \"image\", file = \"none.png\", low = 1, high = 2 }", fixed);
    assert_refused(&grow(&image, &out, &[]), &out, &["factor.file", "none.png", ";"]);
    folder.write("a.ply", PAINTED.replace("3 4 8 7", "3 1 4 8"));
    assert_refused(&grow(&scene("1.1", fixed), &out, &[]), &out, &["a.ply", ";"]);
    folder.write("a.ply", "plop");
    assert_refused(
        &grow(&scene("1.1", fixed), &out, &[]),
        &out,
        &["a.ply", "no PLY file", "; give"],
    );
    let panel = scene("1.1", fixed);
    let text = std::fs::read_to_string(&panel)
        .unwrap()
        .replace("mesh = { start = \"a.ply\" }", "mesh = { metres_per_unit = 1 }");
    assert_refused(
        &grow(&folder.write("scene.toml", text), &out, &[]),
        &out,
        &["mesh: this names no file", "; give start"],
    );
}

#[test]
fn a_torus_grows_and_keeps_its_texture() {
    let folder = Folder::new("grow-torus");
    let scene = folder.write(
        "scene.toml",
        "title = \"ring\"\nmaterial = \
         { young_pa = 1e5, poisson = 0, thickness_m = 1e-3 }\n[[panel]]\nname = \"t\"\nshape = \
         \"torus\"\nradius_m = 1\n\
         tube_radius_m = 0.3\nedge_length_m = 0.2\n[growth]\nwavelength_m = 1.0472\ncoherence_m = \
         2\n\
         expansion = [{ factor = 1.15, direction = { kind = \"around\", axis = [0, 0, 1] } \
         }]\ncount = [{ name = \"around\", panel = \"t\" }]\n",
    );
    let out = folder.0.join("out");
    let report = grown(&scene, &out, &["--frames"]);
    assert_eq!(
        (report["converged"].as_bool(), report["mode"].as_str()),
        (Some(true), Some("variational"))
    );
    let folds = report["folds"][0]["folds"].as_f64().unwrap();
    assert!(folds.fract() == 0.0 && folds >= 1.0, "{folds}");
    // The foundation holds back what grows as a whole: less is reached than on a sheet.
    assert!(report["length_reached"].as_f64().unwrap() > 0.96, "{}", report["length_reached"]);
    assert!(std::fs::read_to_string(out.join("folded.obj")).unwrap().contains("\nvt "));
    // Each frame has its picture, all as large; a later run takes those away that it does not make.
    let frames = report["frames"].as_u64().unwrap() as usize;
    assert!(frames > 2 && names(&out).len() == 2 * frames + 4, "{:?}", names(&out));
    assert_eq!(
        &std::fs::read(out.join(format!("frame-{:04}.png", frames - 1))).unwrap()[1..4],
        b"PNG"
    );
    grown(&scene, &out, &["--frames", "--no-picture"]);
    assert_eq!(names(&out).iter().filter(|name| name.ends_with(".png")).count(), 0);
}

#[test]
fn the_reference_mode_tells_what_it_reached() {
    let folder = Folder::new("grow-reference");
    let scene = folder.write(
        "scene.toml",
        SCENE.replace("wavelength_m = 0.3333", "wavelength_m = 0.3333\niteration_limit = 20"),
    );
    let out = folder.0.join("out");
    let report = grown(&scene, &out, &["--no-picture", "--mode", "reference", "--steps", "2"]);
    assert_eq!(
        (report["mode"].as_str(), report["converged"].as_bool()),
        (Some("reference"), Some(false))
    );
    assert_eq!(report["steps"].as_array().unwrap().len(), 2);
    assert!(report["residual"].as_f64().unwrap() > report["tolerance"].as_f64().unwrap());
    assert!(
        report["residual_unit"].as_str().unwrap().contains("k_p")
            && report["residual_newton"].is_null()
    );
    assert!(report["notes"].to_string().contains("this is no equilibrium"), "{}", report["notes"]);
}

#[cfg(unix)]
#[test]
fn ctrl_c_keeps_what_has_grown() {
    use std::process::{Command, Stdio};
    use std::time::{Duration, Instant};
    let folder = Folder::new("grow-int");
    let large = [
        ("columns = 21", "columns = 120"),
        ("rows = 6", "rows = 60"),
        ("wavelength_m = 0.3333", "wavelength_m = 0.1"),
    ];
    let scene = folder.write(
        "scene.toml",
        large.iter().fold(SCENE.to_owned(), |text, (from, to)| text.replace(from, to)),
    );
    let out = folder.0.join("out");
    let mut run = plisse();
    let mut run = run
        .arg("grow")
        .arg(&scene)
        .arg("-o")
        .arg(&out)
        .args(["--frames", "--no-picture"])
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let begun = Instant::now();
    while !out.exists() || !names(&out).iter().any(|name| name.starts_with(".frame-0000")) {
        assert!(begun.elapsed() < Duration::from_secs(60) && run.try_wait().unwrap().is_none());
        std::thread::sleep(Duration::from_millis(2));
    }
    std::thread::sleep(Duration::from_millis(300));
    assert!(Command::new("kill").arg("-INT").arg(run.id().to_string()).status().unwrap().success());
    let output = run.wait_with_output().unwrap();
    let text = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(130), "{text}");
    let report = json(&out.join("report.json"));
    assert_eq!(report["ending"], "interrupted");
    assert!(report["notes"].to_string().contains("interrupted in step"), "{}", report["notes"]);
    assert_eq!(names(&out).len() as u64, report["frames"].as_u64().unwrap() + 3);
}

#[test]
fn help_shows_an_example() {
    let output = plisse().args(["grow", "--help"]).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    for needle in [
        "Example:",
        "plisse grow examples/20-small-folds.toml",
        "(m)",
        "--steps",
        "--frames",
        "--mode",
        "Ctrl-C",
        "docs/scene-format.md",
    ] {
        assert!(text.contains(needle), "'{needle}' is not in: {text}");
    }
}
