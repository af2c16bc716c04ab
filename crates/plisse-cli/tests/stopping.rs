//! Runs that do not come to their end: Ctrl-C keeps the best state so far, a killed run harms
//! nothing, and neither leaves anything half-written under a file's name.
#![cfg(unix)]

mod harness;

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use harness::{FILES, Folder, changed, example, json, names, plisse, sheet, solve, whole_report};
use serde_json::Value;

const CYLINDER: &str = "01-twisted-cylinder.toml";
const FOIL: &str = "03-sheared-rectangle.toml";

/// Longest wait for anything; only a test that fails waits so long.
const PATIENCE: Duration = Duration::from_secs(60);
/// A run ends within this after Ctrl-C. Three seconds alone, but these tests share a busy machine.
const STOPS_WITHIN: Duration = Duration::from_secs(15);

/// A running `plisse`, killed if the test fails.
struct Run(Child);

impl Run {
    fn start(command: &mut Command) -> Self {
        Self(command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap())
    }

    fn solve(scene: &Path, out: &Path, more: &[&str]) -> Self {
        Self::start(plisse().arg("solve").arg(scene).arg("-o").arg(out).args(more))
    }

    /// Waits until `ready`; the run must not end before.
    fn wait_until(&mut self, what: &str, ready: impl Fn() -> bool) {
        let begun = Instant::now();
        while !ready() {
            assert!(self.0.try_wait().unwrap().is_none(), "the run ended before {what}");
            assert!(begun.elapsed() < PATIENCE, "no {what}");
            std::thread::sleep(Duration::from_millis(2));
        }
    }

    /// Sends the signal to a run that still goes on.
    fn signal(&mut self, signal: &str) {
        assert!(
            self.0.try_wait().unwrap().is_none(),
            "the run ended before SIG{signal}; make it longer"
        );
        assert!(
            Command::new("kill")
                .arg(format!("-{signal}"))
                .arg(self.0.id().to_string())
                .status()
                .unwrap()
                .success()
        );
    }

    /// Exit code (none if a signal ended it) and what stood on standard error.
    fn end(mut self, within: Duration) -> (Option<i32>, String) {
        let begun = Instant::now();
        let status = loop {
            if let Some(status) = self.0.try_wait().unwrap() {
                break status;
            }
            assert!(begun.elapsed() < within, "the run goes on after {within:?}");
            std::thread::sleep(Duration::from_millis(5));
        };
        let mut text = String::new();
        std::io::Read::read_to_string(&mut self.0.stderr.take().unwrap(), &mut text).unwrap();
        (status.code(), text)
    }
}

impl Drop for Run {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A scene whose base solve takes far longer than these tests wait.
fn long_scene(folder: &Folder) -> PathBuf {
    folder.write("long.toml", changed(FOIL, &[("edge_length_m", "0.002")]))
}

/// A scene that is solved at once.
fn short_scene(folder: &Folder) -> PathBuf {
    folder.write("short.toml", changed(CYLINDER, &[("edge_length_m", "0.48")]))
}

fn contents(out: &Path) -> Vec<(String, Vec<u8>)> {
    names(out)
        .into_iter()
        .map(|name| (name.clone(), std::fs::read(out.join(name)).unwrap()))
        .collect()
}

fn notes(report: &Value) -> String {
    report["notes"].to_string()
}

/// The lists of field.json are as long as the report says.
fn assert_field_is_whole(out: &Path, report: &Value) {
    let field = json(&out.join("field.json"));
    for (list, count) in [("amplitude", "vertices"), ("phase", "faces")] {
        assert_eq!(
            field[list].as_array().unwrap().len() as u64,
            report[count].as_u64().unwrap(),
            "{list}"
        );
    }
}

#[test]
fn ctrl_c_in_the_base_solve_keeps_the_best_state() {
    let folder = Folder::new("int-base");
    let scene = long_scene(&folder);
    for (n, wait) in [0, 1500].into_iter().enumerate() {
        let out = folder.0.join(format!("out-{n}"));
        let mut run = Run::solve(&scene, &out, &["--levels", "0"]);
        run.wait_until("output folder", || out.exists());
        std::thread::sleep(Duration::from_millis(wait));
        run.signal("INT");
        let (code, text) = run.end(STOPS_WITHIN);
        assert_eq!(code, Some(130), "{text}");
        assert!(text.contains("stopping") && text.contains("best state so far"), "{text}");
        let report = whole_report(&out);
        assert_eq!(report["base"]["ending"], "interrupted");
        assert!(
            notes(&report).contains("interrupted: this is the best state so far"),
            "{}",
            notes(&report)
        );
        assert_field_is_whole(&out, &report);
        let fine = plisse::io::obj::read(&out.join("wrinkled.obj")).unwrap();
        assert_eq!(fine.faces.len() as u64, report["surface"]["faces"].as_u64().unwrap());
    }
}

#[test]
fn ctrl_c_in_the_field_solve_keeps_the_best_state() {
    let folder = Folder::new("int-field");
    let rest = folder.write("rest.obj", sheet(80, 1.0, false));
    let pose = folder.write("pose.obj", sheet(80, 0.95, false));
    let clamp = folder.write("clamp.txt", (0..=80).map(|v| format!("{v}\n")).collect::<String>());
    let out = folder.0.join("out");
    let mut command = plisse();
    command
        .arg("wrinkle")
        .arg("--rest")
        .arg(rest)
        .arg("--pose")
        .arg(pose)
        .arg("--clamp")
        .arg(clamp)
        .arg("-o")
        .arg(&out);
    command.args(["--young", "1e6", "--poisson", "0.3", "--thickness", "1e-3", "--levels", "0"]);
    let mut run = Run::start(&mut command);
    run.wait_until("output folder", || out.exists());
    std::thread::sleep(Duration::from_millis(1500));
    run.signal("INT");
    let (code, text) = run.end(STOPS_WITHIN);
    assert_eq!(code, Some(130), "{text}");
    let report = whole_report(&out);
    assert_eq!((&report["ending"], &report["base"]), (&Value::from("interrupted"), &Value::Null));
    assert!(report["iterations"].as_u64().unwrap() > 0, "it stopped before it began");
    assert!(
        notes(&report).contains("interrupted: this is the best state so far"),
        "{}",
        notes(&report)
    );
    assert_field_is_whole(&out, &report);
}

#[test]
fn ctrl_c_while_files_are_written_still_writes_all_of_them() {
    let folder = Folder::new("int-files");
    let out = folder.0.join("out");
    let mut run = Run::solve(&example(CYLINDER), &out, &["--levels", "4"]);
    let is_written = |name: &str| {
        out.exists() && names(&out).iter().any(|n| n.starts_with(&format!(".{name}.")))
    };
    run.wait_until("part of wrinkled.obj", || is_written("wrinkled.obj"));
    assert!(!out.join("picture.png").exists(), "no file appears before all are ready");
    run.signal("INT");
    let (code, text) = run.end(STOPS_WITHIN);
    assert_eq!(code, Some(130), "{text}");
    let report = whole_report(&out);
    assert_eq!(report["ending"], "converged");
    assert!(
        notes(&report).contains("nothing is missing"),
        "a converged field is no mere state so far: {}",
        notes(&report)
    );
    assert_eq!(report["periods"][0], 46);
}

#[test]
fn a_second_ctrl_c_ends_at_once() {
    let folder = Folder::new("int-twice");
    let scene = long_scene(&folder);
    let out = folder.0.join("out");
    // Drawing and writing four levels takes long after the first.
    let mut run = Run::solve(&scene, &out, &["--levels", "4"]);
    run.wait_until("output folder", || out.exists());
    run.signal("INT");
    std::thread::sleep(Duration::from_millis(200));
    run.signal("INT");
    let (code, text) = run.end(Duration::from_secs(3));
    assert_eq!(code, Some(130), "{text}");
    assert!(!text.contains("best state"), "{text}");
    assert!(names(&out).iter().all(|name| name.starts_with('.')), "{:?}", names(&out));
}

#[test]
fn a_killed_solve_leaves_the_earlier_files_as_they_were() {
    let folder = Folder::new("kill-solve");
    let (long, short) = (long_scene(&folder), short_scene(&folder));
    // Into a fresh folder: nothing.
    let fresh = folder.0.join("fresh");
    let mut run = Run::solve(&long, &fresh, &[]);
    run.wait_until("output folder", || fresh.exists());
    std::thread::sleep(Duration::from_millis(300));
    run.signal("KILL");
    assert_eq!(run.end(PATIENCE).0, None);
    assert!(names(&fresh).is_empty(), "{:?}", names(&fresh));
    solve(&short, &fresh, &["--levels", "0"]);
    whole_report(&fresh);
    // Into the same folder: what is there, to the byte.
    let before = contents(&fresh);
    let begun = Instant::now();
    let mut run = Run::solve(&long, &fresh, &[]);
    run.wait_until("time", || begun.elapsed() > Duration::from_millis(800));
    run.signal("KILL");
    assert_eq!(run.end(PATIENCE).0, None);
    assert!(contents(&fresh) == before, "{:?}", names(&fresh));
}

#[test]
fn a_run_killed_while_it_writes_leaves_parts_that_the_next_run_removes() {
    let folder = Folder::new("kill-files");
    let short = short_scene(&folder);
    let out = folder.0.join("out");
    solve(&short, &out, &["--levels", "0"]);
    let before = contents(&out);
    let mut run = Run::solve(&example(CYLINDER), &out, &["--levels", "4", "--no-picture"]);
    run.wait_until("part of wrinkled.obj", || {
        names(&out).iter().any(|n| n.starts_with(".wrinkled.obj."))
    });
    run.signal("KILL");
    assert_eq!(run.end(PATIENCE).0, None);
    let (parts, whole): (Vec<_>, Vec<_>) =
        contents(&out).into_iter().partition(|(name, _)| name.starts_with('.'));
    assert!(whole == before, "{:?}", names(&out));
    assert!(
        parts.iter().any(|(name, _)| name.starts_with(".wrinkled.obj.") && name.ends_with(".part")),
        "{:?}",
        names(&out)
    );
    solve(&example(CYLINDER), &out, &["--levels", "0"]);
    assert_eq!(names(&out), FILES, "the parts are gone");
    assert_eq!(whole_report(&out)["vertices"], 683);
}
