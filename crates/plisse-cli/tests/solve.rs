//! `plisse solve` from outside: the published scenes, their figures and files, and that the same
//! scene gives the same bytes.

mod harness;

use std::path::Path;

use harness::{FILES, Folder, changed, example, json, names, plisse, solve, whole_report};
use plisse::io::obj;
use serde_json::Value;

const CYLINDER: &str = "01-twisted-cylinder.toml";
const SHEET: &str = "02-stretched-sheet.toml";
const FOIL: &str = "03-sheared-rectangle.toml";

/// Every figure that report.json promises is there and finite.
fn assert_every_figure(report: &Value) {
    for key in [
        "vertices",
        "faces",
        "wrinkle_free_faces",
        "generators",
        "iterations",
        "energy_joule",
        "projected_gradient",
    ] {
        assert!(report[key].is_number(), "{key}: {}", report[key]);
    }
    assert!(report["periods"].is_array());
    assert_eq!(
        report["periods"].as_array().unwrap().len() as u64,
        report["generators"].as_u64().unwrap()
    );
    for (key, parts) in [
        ("amplitude_m", &["max", "mean"][..]),
        ("wavelength_m", &["min", "median", "max"]),
        ("seconds", &["base", "field", "phase", "surface", "total"]),
        ("surface", &["levels", "vertices", "faces"]),
    ] {
        for part in parts {
            assert!(report[key][part].is_number(), "{key}.{part}");
        }
    }
    let terms = report["energy_terms"].as_object().unwrap();
    let sum: f64 = terms.values().map(|v| v.as_f64().unwrap()).sum();
    let energy = report["energy_joule"].as_f64().unwrap();
    assert!(
        terms.len() == 5 && (sum - energy).abs() < 1e-9 * energy,
        "{terms:?} is not {energy} J"
    );
    let seconds = |part: &str| report["seconds"][part].as_f64().unwrap();
    let parts = ["base", "field", "phase", "surface"].map(seconds).iter().sum::<f64>();
    assert!(
        parts > 0.0 && parts <= seconds("total") * 1.01,
        "the parts last {parts} s of {} s",
        seconds("total")
    );
    for (small, large) in [("min", "median"), ("median", "max")] {
        assert!(report["wavelength_m"][small].as_f64() <= report["wavelength_m"][large].as_f64());
    }
    for ending in [&report["ending"], &report["base"]["ending"]] {
        assert!(ending.as_str().unwrap().starts_with("converged"), "{ending}");
    }
}

fn measured(report: &Value, n: usize) -> f64 {
    report["measures"][n]["value"].as_f64().unwrap()
}

/// Each measure stands on the terminal in a line with the published number and its source.
fn assert_published_is_shown(shown: &str, report: &Value) {
    let measures = report["measures"].as_array().unwrap();
    assert!(!measures.is_empty());
    for measure in measures {
        let name = measure["name"].as_str().unwrap();
        let is_its_line = |line: &&str| {
            line.trim_start().starts_with(&format!("{name} ")) && line.contains(", published ")
        };
        let line =
            shown.lines().find(is_its_line).unwrap_or_else(|| panic!("{name} is not in: {shown}"));
        assert!(line.contains(measure["source"].as_str().unwrap()), "{line}");
        let numbers: Vec<f64> = line[name.len() + 2..]
            .split_whitespace()
            .filter_map(|word| word.parse().ok())
            .collect();
        let near = |a: f64, b: &Value| (a - b.as_f64().unwrap()).abs() <= 2e-3 * a.abs();
        assert!(
            near(numbers[0], &measure["value"]) && near(numbers[1], &measure["published"]),
            "{line}"
        );
    }
}

#[test]
fn the_twisted_cylinder_has_46_waves_and_sound_files() {
    let folder = Folder::new("cylinder");
    let out = folder.0.join("out");
    let output = solve(&example(CYLINDER), &out, &[]);
    let report = whole_report(&out);
    assert_every_figure(&report);
    assert_eq!(report["generators"], 1);
    let waves = report["periods"][0].as_i64().unwrap();
    assert!((44..=48).contains(&waves), "{waves} waves");
    assert_eq!(measured(&report, 0), waves as f64);
    assert_published_is_shown(&String::from_utf8_lossy(&output.stdout), &report);

    assert_meshes_are_sound(&out, &report);
    assert_glb_is_sound(&out, &report);
    assert_png_is_sound(&out);
    assert_eq!(
        waves_around(&out),
        waves as usize,
        "the surface itself has other waves than the report"
    );
}

#[test]
fn the_stretched_sheet_has_5_waves() {
    let folder = Folder::new("sheet");
    let out = folder.0.join("out");
    let output = solve(&example(SHEET), &out, &[]);
    let report = whole_report(&out);
    assert_every_figure(&report);
    assert!((4.0..=6.0).contains(&measured(&report, 0)), "{} waves", measured(&report, 0));
    for peak in [measured(&report, 1), report["amplitude_m"]["max"].as_f64().unwrap()] {
        assert!((0.30e-3..=0.50e-3).contains(&peak), "{peak} m");
    }
    assert_published_is_shown(&String::from_utf8_lossy(&output.stdout), &report);
    assert_meshes_are_sound(&out, &report);
    assert_glb_is_sound(&out, &report);
}

#[test]
fn the_sheared_rectangle_has_22_to_28_wrinkles() {
    let folder = Folder::new("foil");
    let out = folder.0.join("out");
    let output = solve(&example(FOIL), &out, &[]);
    let report = whole_report(&out);
    assert_every_figure(&report);
    assert!((22.0..=28.0).contains(&measured(&report, 0)), "{} wrinkles", measured(&report, 0));
    assert_published_is_shown(&String::from_utf8_lossy(&output.stdout), &report);
    assert_meshes_are_sound(&out, &report);
}

#[test]
fn without_v1_the_cylinder_has_far_too_many_waves() {
    let folder = Folder::new("without-v1");
    let out = folder.0.join("out");
    solve(&example(CYLINDER), &out, &["--without", "v1", "--levels", "0", "--no-picture"]);
    let waves = json(&out.join("report.json"))["periods"][0].as_i64().unwrap();
    assert!(waves > 150, "{waves} waves");
    assert_eq!(
        names(&out),
        FILES.iter().copied().filter(|name| *name != "picture.png").collect::<Vec<_>>()
    );
}

#[test]
fn the_cylinders_waves_hardly_depend_on_the_mesh() {
    let folder = Folder::new("meshes");
    for (edge, vertices, off) in [
        ("0.48", 180, 3),
        ("0.345", 340, 2),
        ("0.241", 690, 2),
        ("0.175", 1300, 2),
        ("0.125", 2500, 2),
    ] {
        let scene = folder
            .write("scene.toml", changed(CYLINDER, &[("edge_length_m", edge), ("seed", "1")]));
        let out = folder.0.join(edge);
        solve(&scene, &out, &["--levels", "0", "--no-picture"]);
        let report = json(&out.join("report.json"));
        let (waves, count) =
            (report["periods"][0].as_i64().unwrap(), report["vertices"].as_f64().unwrap());
        assert!(
            (count / f64::from(vertices) - 1.0).abs() < 0.05,
            "{count} vertices, not about {vertices}"
        );
        assert!((waves - 46).abs() <= off, "{count} vertices: {waves} waves");
    }
}

/// base.obj and wrinkled.obj read back with as many vertices and faces as the report says, and
/// something between them.
fn assert_meshes_are_sound(out: &Path, report: &Value) {
    let base = obj::read(&out.join("base.obj")).unwrap();
    let fine = obj::read(&out.join("wrinkled.obj")).unwrap();
    let count = |n: usize| Value::from(n);
    assert_eq!(
        [count(base.positions.len()), count(base.faces.len())],
        [report["vertices"].clone(), report["faces"].clone()]
    );
    let surface = &report["surface"];
    assert_eq!(
        [count(fine.positions.len()), count(fine.faces.len())],
        [surface["vertices"].clone(), surface["faces"].clone()]
    );
    let share = 4_usize.pow(surface["levels"].as_u64().unwrap() as u32);
    assert_eq!(fine.faces.len(), base.faces.len() * share);
    for mesh in [&base, &fine] {
        assert!(mesh.warnings.is_empty() && mesh.cuts.is_empty(), "{:?}", mesh.warnings);
        assert_eq!(mesh.texture_faces.as_ref().unwrap().len(), mesh.faces.len());
        assert!(
            mesh.texture_coordinates.iter().flat_map(|t| t.iter()).all(|x| (0.0..=1.0).contains(x))
        );
    }
    // Wrinkles take little area away from the base surface's, and add more than none.
    let area = |mesh: &obj::Obj| -> f64 {
        let corner = |f: [usize; 3], k: usize| mesh.positions[f[k]] - mesh.positions[f[0]];
        mesh.faces.iter().map(|&f| corner(f, 1).cross(&corner(f, 2)).norm() / 2.0).sum()
    };
    let ratio = area(&fine) / area(&base);
    assert!(
        (1.0..1.2).contains(&ratio),
        "the wrinkled surface has {ratio} times the base surface's area"
    );
}

/// Waves of wrinkled.obj of the cylinder, counted at half its height: how often the radius rises
/// through its mean.
fn waves_around(out: &Path) -> usize {
    let fine = obj::read(&out.join("wrinkled.obj")).unwrap();
    let height = fine.positions.iter().map(|p| p.z).fold(0.0, f64::max);
    let mut ring: Vec<[f64; 2]> = fine
        .positions
        .iter()
        .filter(|p| (p.z - height / 2.0).abs() < 0.008)
        .map(|p| [p.y.atan2(p.x), p.xy().norm()])
        .collect();
    assert!(ring.len() > 300, "{} vertices are too few to count by", ring.len());
    ring.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mean = ring.iter().map(|r| r[1]).sum::<f64>() / ring.len() as f64;
    let swing = ring.iter().map(|r| (r[1] - mean).abs()).fold(0.0, f64::max);
    // Only what goes a third of the way out counts, so that no jitter on the mean is taken for a
    // wave.
    let sides: Vec<bool> =
        ring.iter().filter(|r| (r[1] - mean).abs() > swing / 3.0).map(|r| r[1] > mean).collect();
    (0..sides.len()).filter(|&k| sides[k] && !sides[(k + sides.len() - 1) % sides.len()]).count()
}

/// The file's lengths, its accessors and its indices fit together and hold the report's surface.
fn assert_glb_is_sound(out: &Path, report: &Value) {
    let bytes = std::fs::read(out.join("wrinkled.glb")).unwrap();
    let number = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!((&bytes[..4], number(4), number(8)), (&b"glTF"[..], 2, bytes.len()));
    let json_length = number(12);
    assert_eq!((&bytes[16..20], json_length % 4), (&b"JSON"[..], 0));
    let document: Value = serde_json::from_slice(&bytes[20..20 + json_length]).unwrap();
    let bin = 20 + json_length;
    assert_eq!((&bytes[bin + 4..bin + 8], bin + 8 + number(bin)), (&b"BIN\0"[..], bytes.len()));
    assert_eq!(document["buffers"][0]["byteLength"], number(bin));
    let views: Vec<[usize; 2]> = document["bufferViews"]
        .as_array()
        .unwrap()
        .iter()
        .map(|view| ["byteOffset", "byteLength"].map(|key| view[key].as_u64().unwrap() as usize))
        .collect();
    assert!(views.iter().all(|[offset, length]| offset + length <= number(bin)));

    let primitive = &document["meshes"][0]["primitives"][0];
    let accessor = |n: &Value| &document["accessors"][n.as_u64().unwrap() as usize];
    let start = |a: &Value| bin + 8 + views[a["bufferView"].as_u64().unwrap() as usize][0];
    let (positions, indices) =
        (accessor(&primitive["attributes"]["POSITION"]), accessor(&primitive["indices"]));
    assert_eq!(
        indices["count"].as_u64().unwrap(),
        3 * report["surface"]["faces"].as_u64().unwrap()
    );
    let count = positions["count"].as_u64().unwrap();
    assert!(count >= report["surface"]["vertices"].as_u64().unwrap());
    let largest = (0..indices["count"].as_u64().unwrap() as usize)
        .map(|i| number(start(indices) + 4 * i))
        .max()
        .unwrap();
    assert_eq!(largest as u64, count - 1);
    let float = |at: usize| f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
    for axis in 0..3 {
        let values =
            (0..count as usize).map(|v| f64::from(float(start(positions) + 12 * v + 4 * axis)));
        let (low, high) =
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        let near =
            |said: &Value, x: f64| (said[axis].as_f64().unwrap() - x).abs() <= 1e-6 * x.abs();
        assert!(
            near(&positions["min"], low) && near(&positions["max"], high),
            "axis {axis}: {low} to {high}"
        );
    }
}

/// The file is a chain of chunks to its last byte, 1600 × 1200 pixels, with more in it than one
/// colour.
fn assert_png_is_sound(out: &Path) {
    let bytes = std::fs::read(out.join("picture.png")).unwrap();
    let number = |at: usize| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!(&bytes[..8], b"\x89PNG\r\n\x1a\n");
    assert_eq!((&bytes[12..16], number(16), number(20)), (&b"IHDR"[..], 1600, 1200));
    let (mut at, mut last, mut data) = (8, &bytes[..0], 0);
    while at < bytes.len() {
        last = &bytes[at + 4..at + 8];
        data += if last == b"IDAT" { number(at) } else { 0 };
        at += 12 + number(at);
    }
    assert_eq!((at, last), (bytes.len(), &b"IEND"[..]));
    assert!(data > 50_000, "{data} bytes are too few for a picture of wrinkles");
}

#[test]
fn the_same_scene_gives_the_same_bytes_with_any_number_of_threads_and_in_a_used_folder() {
    let folder = Folder::new("same");
    let bytes = |out: &Path| -> Vec<Vec<u8>> {
        FILES
            .iter()
            .filter(|name| **name != "report.json")
            .map(|name| std::fs::read(out.join(name)).unwrap())
            .collect()
    };
    let figures = |out: &Path| -> Value {
        let mut report = whole_report(out);
        report["seconds"] = Value::Null;
        report
    };
    let [one, two] = ["one", "two"].map(|name| folder.0.join(name));
    let scene = folder.write("scene.toml", changed(CYLINDER, &[("edge_length_m", "0.3")]));
    // A run of another seed leaves other files; then the real one replaces all of them.
    let other =
        folder.write("other.toml", changed(CYLINDER, &[("edge_length_m", "0.3"), ("seed", "5")]));
    solve(&scene, &one, &["--threads", "1", "--levels", "1"]);
    solve(&other, &two, &["--threads", "2", "--levels", "1"]);
    for ((a, b), name) in
        bytes(&one).iter().zip(bytes(&two)).zip(FILES.iter().filter(|name| **name != "report.json"))
    {
        assert!(*a != b, "{name} does not depend on the scene");
    }
    solve(&scene, &two, &["--threads", "2", "--levels", "1"]);
    assert!(bytes(&one) == bytes(&two), "1 and 2 threads differ");
    assert_eq!(figures(&one), figures(&two));
    // Without a picture the last one goes, so that nobody takes it for one of these results.
    solve(&scene, &two, &["--threads", "2", "--levels", "1", "--no-picture"]);
    assert!(!two.join("picture.png").exists());
    std::fs::copy(one.join("picture.png"), two.join("picture.png")).unwrap();
    assert!(bytes(&one) == bytes(&two), "two runs differ");
}

#[test]
fn a_terminal_that_is_gone_does_no_harm() {
    let folder = Folder::new("gone");
    let out = folder.0.join("out");
    let run = |scene: &str| {
        let mut command = plisse();
        command.arg("solve").arg(scene).arg("-o").arg(&out).args(["--levels", "0"]);
        // A pipe that nobody reads: every write to it fails.
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        command.stdout(writer.try_clone().unwrap()).stderr(writer).status().unwrap().code()
    };
    let coarse = folder.write("coarse.toml", changed(CYLINDER, &[("edge_length_m", "0.48")]));
    assert_eq!(run(coarse.to_str().unwrap()), Some(0));
    whole_report(&out);
    assert_eq!(run("nowhere.toml"), Some(2));
}

#[test]
fn every_help_shows_an_example_and_units() {
    let help = |arguments: &[&str]| {
        let output = plisse().args(arguments).output().unwrap();
        assert!(output.status.success() && output.stderr.is_empty());
        String::from_utf8(output.stdout).unwrap()
    };
    for (arguments, needles) in [
        (&["--help"][..], &["plisse solve examples/", "(m)", "(Pa)", "wrinkle"][..]),
        (
            &["solve", "--help"],
            &[
                "plisse solve examples/",
                "(m)",
                "(Pa)",
                "degrees",
                "docs/scene-format.md",
                "--levels",
                "Ctrl-C",
            ],
        ),
        (
            &["wrinkle", "--help"],
            &["plisse wrinkle --rest", "(Pa)", "(m)", "metres", "no unit", "--young"],
        ),
    ] {
        let text = help(arguments);
        assert!(text.contains("Example:"), "{text}");
        for needle in needles {
            assert!(text.contains(needle), "'{needle}' is not in: {text}");
        }
        // The example's scene is there, and its command is one that this program takes.
        let line = text.lines().find(|line| line.starts_with("  plisse ")).unwrap();
        for word in line.split_whitespace().filter(|word| word.starts_with("examples/")) {
            assert!(example("..").join(word).exists(), "{word}");
        }
        for flag in line.split_whitespace().filter(|word| word.starts_with('-')) {
            let command = line.split_whitespace().nth(1).unwrap();
            assert!(help(&[command, "--help"]).contains(flag), "{flag}");
        }
    }
    assert_eq!(help(&["--version"]), format!("plisse {}\n", env!("CARGO_PKG_VERSION")));
}
