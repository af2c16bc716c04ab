//! `plisse shell`, and `plisse solve` among obstacles, from outside.

mod harness;

use harness::{Folder, assert_refused, json, names, plisse, solve, whole_report};
use plisse::io::obj;
use plisse::mesh::Vec3;
use plisse::obstacle::Obstacle;

/// A strip that is shorter than it wants to be: it must buckle.
const STRIP: &str = r#"
title = "Pressed strip"
material = { young_pa = 1e7, poisson = 0.0, thickness_m = 1e-3 }
panel = [{ name = "strip", shape = "rectangle", width_m = 0.4, height_m = 0.1, edge_length_m = 0.02,
    mesh = "rising" }]
clamp = [{ side = "strip.left" }, { side = "strip.right", move_m = [-0.02, 0.0, 0.0] }]
measure = [
  { name = "waves", kind = "waves_along", panel = "strip", from_m = [0.0, 0.05], to_m = [0.4, 0.05],
    published = 0.5, source = "Euler 1744" },
  { name = "turns", kind = "largest_period" },
]
"#;

/// A small cloth over a ball.
const DRAPE: &str = r#"
title = "Small drape"
material = { young_pa = 1e5, poisson = 0.3, thickness_m = 1e-3, density_kg_m3 = 200.0 }
panel = [{ name = "cloth", shape = "rectangle", width_m = 0.6, height_m = 0.6, edge_length_m = 0.06,
           place = { kind = "flat", origin_m = [-0.3, -0.3, 0.2] } }]
clamp = [{ near_m = [0.0, 0.0, 0.2], axes = "xy" }]
load = { gravity_m_s2 = [0.0, 0.0, -9.81] }
obstacle = [{ name = "ball", kind = "sphere", centre_m = [0.0, 0.0, 0.0], radius_m = 0.2 }]
contact = { thickness_m = 4e-3 }
"#;

#[test]
fn a_pressed_strip_buckles_and_leaves_its_files() {
    let folder = Folder::new("shell");
    let (scene, out) = (folder.write("strip.toml", STRIP), folder.0.join("out"));
    let output = plisse().arg("shell").arg(&scene).arg("-o").arg(&out).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(names(&out), ["base.obj", "picture.png", "report.json", "shell.glb", "shell.obj"]);
    let report = json(&out.join("report.json"));
    assert_eq!(report["ending"], "converged");
    // A strip of length L pressed by ε bows by about 2L/π·√ε.
    let bow = report["displacement_max_m"].as_f64().unwrap();
    assert!((bow - 2.0 * 0.4 / std::f64::consts::PI * 0.05_f64.sqrt()).abs() < 0.1 * bow, "{bow}");
    let shown = String::from_utf8(output.stdout).unwrap();
    assert!(
        shown.contains("waves")
            && shown.contains("published 0.5 waves (Euler 1744)")
            && !shown.contains("turns"),
        "{shown}"
    );

    let finer = folder.0.join("finer");
    let output = plisse()
        .args(["shell", "--finer", "2", "--start", "flat", "--no-picture"])
        .arg(&scene)
        .arg("-o")
        .arg(&finer)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(names(&finer), ["base.obj", "report.json", "shell.glb", "shell.obj"]);
    let fine = json(&finer.join("report.json"));
    assert!(fine["base"].is_null() && fine["vertices"].as_u64() > report["vertices"].as_u64());
    let energy = |report: &serde_json::Value| report["energy_joule"].as_f64().unwrap();
    assert!(
        (energy(&fine) / energy(&report) - 1.0).abs() < 0.05,
        "{} {}",
        energy(&fine),
        energy(&report)
    );
}

#[test]
fn wrinkles_stay_out_of_the_ball() {
    let folder = Folder::new("drape");
    let out = folder.0.join("out");
    solve(&folder.write("drape.toml", DRAPE), &out, &["--levels", "2"]);
    let report = whole_report(&out);
    assert!(report["base"]["ending"].as_str().unwrap().starts_with("converged"));
    let ball = Obstacle::sphere("ball", Vec3::zeros(), 0.2).unwrap();
    for name in ["base.obj", "wrinkled.obj"] {
        let mesh = obj::read(&out.join(name)).unwrap();
        let nearest =
            mesh.positions.iter().map(|p| ball.distance_m(p)).fold(f64::INFINITY, f64::min);
        assert!(nearest > 0.0 && nearest < 4e-3, "{name}: {nearest}");
    }
}

#[test]
fn what_cannot_be_is_refused() {
    let folder = Folder::new("shell-bad");
    let out = folder.0.join("out");
    let refused = |scene: &str, arguments: &[&str], needles: &[&str]| {
        let scene = folder.write("scene.toml", scene);
        let output = plisse().args(arguments).arg(scene).arg("-o").arg(&out).output().unwrap();
        assert_refused(&output, &out, needles);
    };
    refused(STRIP, &["shell", "--finer", "0"], &["--finer", "above 0"]);
    refused(STRIP, &["shell", "--finer", "nan"], &["--finer", "above 0"]);
    // The cloth starts in the middle of the ball; a clamp holds it inside; nothing is below it.
    refused(
        &DRAPE.replace("0.2] } }]", "0.02] } }]"),
        &["solve"],
        &["faces", "inside obstacle \"ball\"", "move"],
    );
    let held = DRAPE.replace("axes = \"xy\"", "axes = \"xyz\", move_m = [0.0, 0.0, -0.1]");
    refused(&held, &["solve"], &["obstacle \"ball\"", "clamp"]);
    refused(
        &DRAPE.replace(
            "sphere\", centre_m = [0.0, 0.0, 0.0]",
            "sphere\", centre_m = [5.0, 0.0, 0.0]",
        ),
        &["shell"],
        &["falls"],
    );
}
