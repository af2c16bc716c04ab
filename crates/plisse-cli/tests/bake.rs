//! `plisse bake` from outside: models, solved folders and scenes to maps; bad input is one
//! sentence.

mod harness;

use std::path::Path;
use std::process::Output;

use harness::{Folder, assert_refused, changed, json, names, plisse, solve};

const CYLINDER: &str = "01-twisted-cylinder.toml";

fn bake(input: impl AsRef<std::ffi::OsStr>, out: &Path, more: &[&str]) -> Output {
    plisse().arg("bake").arg(input).arg("-o").arg(out).args(more).output().unwrap()
}

fn baked(input: impl AsRef<std::ffi::OsStr>, out: &Path, more: &[&str]) -> serde_json::Value {
    let output = bake(input, out, more);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(String::from_utf8_lossy(&output.stdout).contains("written to"));
    json(&out.join("report.json"))
}

/// Width and values (0 to 65535) of a 16-bit PNG file.
fn values(path: &Path) -> (u32, Vec<u16>) {
    let file = std::fs::File::open(path).unwrap();
    let mut reader = png::Decoder::new(std::io::BufReader::new(file)).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    assert_eq!(info.bit_depth, png::BitDepth::Sixteen);
    (info.width, bytes.chunks_exact(2).map(|b| u16::from_be_bytes([b[0], b[1]])).collect())
}

#[test]
fn an_own_model_is_baked_frame_by_frame() {
    let folder = Folder::new("bake-frames");
    let out = folder.0.join("maps");
    let report = baked(
        "sleeve",
        &out,
        &["--wavelength", "0.03", "--frames", "3", "--size", "128", "--padding", "4"],
    );
    let files = [
        "height-0000.png",
        "height-0001.png",
        "height-0002.png",
        "normal-0000.png",
        "normal-0001.png",
        "normal-0002.png",
        "report.json",
    ];
    assert_eq!(names(&out), files);
    assert_eq!(
        (&report["kind"], &report["clip"], &report["vertices"]),
        (&"live".into(), &"bend".into(), &500.into())
    );
    let frames = report["frames"].as_array().unwrap();
    assert_eq!(
        frames.iter().map(|f| f["time_s"].as_f64().unwrap()).collect::<Vec<_>>(),
        [0.0, 1.0, 2.0]
    );
    // The sleeve is at rest in its first frame, and bent in its second.
    assert_eq!(frames[0]["height_max_m"], 0.0);
    let scale = report["height_scale_m"].as_f64().unwrap();
    assert!((scale - 0.0075).abs() < 1e-6);
    let (width, flat) = values(&out.join("height-0000.png"));
    assert!(width == 128 && flat.iter().all(|&h| h == 32768));
    let (_, bent) = values(&out.join("height-0001.png"));
    let highest =
        bent.iter().map(|&h| (f64::from(h) - 32768.0).abs() / 32767.0).fold(0.0, f64::max) * scale;
    assert!(
        (highest - frames[1]["height_max_m"].as_f64().unwrap()).abs() < 1e-6 && highest > 0.003
    );
    // Fewer frames into the same folder: the old third one goes.
    baked(
        "sleeve",
        &out,
        &["--wavelength", "0.03", "--frames", "2", "--size", "64", "--map", "normal"],
    );
    assert_eq!(names(&out), ["normal-0000.png", "normal-0001.png", "report.json"]);
    let first = std::fs::read(out.join("normal-0001.png")).unwrap();
    let again = folder.0.join("again");
    baked(
        "sleeve",
        &again,
        &[
            "--wavelength",
            "0.03",
            "--time",
            "2",
            "--size",
            "64",
            "--map",
            "normal",
            "--threads",
            "1",
        ],
    );
    assert_eq!(names(&again), ["normal.png", "report.json"]);
    assert!(
        first == std::fs::read(again.join("normal.png")).unwrap(),
        "the same time, the same bytes"
    );
}

#[test]
fn a_scene_and_its_solved_folder_give_the_same_maps() {
    let folder = Folder::new("bake-scene");
    let scene = folder.write("scene.toml", changed(CYLINDER, &[("edge_length_m", "0.48")]));
    let solved = folder.0.join("solved");
    solve(&scene, &solved, &["--levels", "0", "--no-picture"]);
    let (a, b) = (folder.0.join("a"), folder.0.join("b"));
    let report = baked(&solved, &a, &["--size", "256"]);
    assert_eq!((&report["kind"], report["frames"].as_array().unwrap().len()), (&"field".into(), 1));
    assert_eq!(report["frames"][0]["overlapping_texels"], 0);
    let (width, heights) = values(&a.join("height.png"));
    assert!(
        width == 256 && heights.iter().any(|&h| h > 40000) && heights.iter().any(|&h| h < 25000)
    );
    baked(&scene, &b, &["--size", "256"]);
    assert_eq!(names(&b), ["height.png", "normal.png", "report.json", "solve"]);
    for name in ["height.png", "normal.png"] {
        assert!(
            std::fs::read(a.join(name)).unwrap() == std::fs::read(b.join(name)).unwrap(),
            "{name}"
        );
    }
}

#[test]
fn bad_input_is_one_sentence() {
    let folder = Folder::new("bake-bad");
    let out = folder.0.join("out");
    let refused = |input: &str, more: &[&str], needles: &[&str]| {
        assert_refused(&bake(input, &out, more), &out, needles)
    };
    refused("hat", &["--wavelength", "0.1"], &["there is no such file", "sleeve"]);
    refused("nowhere.glb", &["--wavelength", "0.1"], &["nowhere.glb", "spelling"]);
    refused("sleeve", &[], &["--wavelength", "missing"]);
    for wavelength in ["0", "-1", "nan", "inf"] {
        refused("sleeve", &["--wavelength", wavelength], &["--wavelength", "above 0"]);
    }
    refused("sleeve", &["--wavelength", "0.1", "--clip", "jump"], &["jump", "bend"]);
    refused("sleeve", &["--wavelength", "0.1", "--time", "-1"], &["--time"]);
    refused("sleeve", &["--wavelength", "0.1", "--profile", "steep"], &["steep"]);
    let here = folder.0.display().to_string();
    refused(&here, &[], &["no base.obj", "solve"]);
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let mesh = folder.write("base.obj", obj);
    let field = |count: usize| {
        format!(
            r#"{{"amplitude":{:?},"edges":[[0,1],[0,2],[1,2]],"omega":[0,0,0],
            "phase":[[0,0,0]],"wrinkle_free":[]}}"#,
            vec![0.1; count]
        )
    };
    folder.write("field.json", field(2));
    refused(&here, &[], &["field.json", "another mesh"]);
    folder.write("field.json", field(3));
    refused(&here, &[], &["no texture coordinates", "unwrap"]);
    std::fs::write(&mesh, "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 3 0\nvt 0 1\nf 1/1 2/2 3/3\n")
        .unwrap();
    refused(&here, &[], &["(3.0000, 0.0000)", "unit square"]);
    refused(&here, &["--wavelength", "0.1"], &["--wavelength", "leave it out"]);
    std::fs::write(&mesh, "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n")
        .unwrap();
    let report = baked(&here, &out, &["--size", "32", "--map", "height"]);
    assert!((report["height_scale_m"].as_f64().unwrap() - 0.1).abs() < 1e-12);
}

#[cfg(unix)]
#[test]
fn ctrl_c_keeps_the_frames_that_are_done() {
    use std::process::{Command, Stdio};
    let folder = Folder::new("bake-int");
    let out = folder.0.join("out");
    let mut command = plisse();
    command
        .args(["bake", "sleeve", "--wavelength", "0.03", "--frames", "2000", "--size", "256", "-o"])
        .arg(&out);
    let mut run = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let begun = std::time::Instant::now();
    let is_ready =
        || out.exists() && names(&out).iter().any(|name| name.starts_with(".normal-0003"));
    while !is_ready() {
        assert!(run.try_wait().unwrap().is_none() && begun.elapsed().as_secs() < 60);
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    assert!(Command::new("kill").arg("-INT").arg(run.id().to_string()).status().unwrap().success());
    let output = run.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    let report = json(&out.join("report.json"));
    let done = report["frames"].as_array().unwrap().len();
    assert!((4..2000).contains(&done), "{done}");
    assert!(report["notes"].to_string().contains("interrupted"));
    assert_eq!(names(&out).len(), 2 * done + 1, "all of them and nothing else");
    values(&out.join(format!("height-{:04}.png", done - 1)));
}
