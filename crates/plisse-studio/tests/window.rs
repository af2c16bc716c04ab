//! The whole program without a window: open, paint, undo, solve, export, and what happens when
//! something goes wrong.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use egui::{Key, Modifiers, PointerButton, Pos2, pos2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use plisse_studio::automation::measure::{Report, measure};
use plisse_studio::commands::Command;
use plisse_studio::document::Layer;
use plisse_studio::view::{Graphics, View};
use plisse_studio::work::export::Kind;
use plisse_studio::{ShownSurface, Start, Studio, Tab};

/// Middle of the picture, in the window of these tests.
const MIDDLE: Pos2 = pos2(700.0, 400.0);

fn studio(gpu: bool, keep: Option<PathBuf>) -> Studio {
    Studio::new(Start {
        graphics: Graphics::own(gpu),
        autosave_folder: keep,
        request_repaint: Arc::new(|| {}),
    })
    .unwrap()
}

fn window(studio: Studio) -> Harness<'static, Studio> {
    let builder = Harness::builder()
        .with_size(egui::vec2(1100.0, 760.0))
        .with_step_dt(1.0 / 60.0)
        .with_max_steps(4);
    builder.build_ui_state(|ui, studio: &mut Studio| studio.ui(ui), studio)
}

/// Frames until nothing is on its way and a picture is there.
fn settle(harness: &mut Harness<'static, Studio>) {
    let begun = Instant::now();
    let mut calm = 0;
    while calm < 3 {
        harness.step();
        calm = if harness.state().is_idle() && harness.state().viewport.frame.is_some() {
            calm + 1
        } else {
            0
        };
        assert!(
            begun.elapsed() < Duration::from_secs(240),
            "it does not settle: {:?}",
            harness.state().shell.messages.last()
        );
        std::thread::sleep(Duration::from_millis(4));
    }
}

fn drag(harness: &mut Harness<'static, Studio>, points: &[Pos2]) {
    let button = |pressed, pos| egui::Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    harness.event(egui::Event::PointerMoved(points[0]));
    harness.step();
    harness.event(button(true, points[0]));
    harness.step();
    for &point in &points[1..] {
        harness.event(egui::Event::PointerMoved(point));
        harness.step();
    }
    harness.event(button(false, points[points.len() - 1]));
    harness.step();
    harness.step();
}

/// Presses the button with this text.
fn press(harness: &mut Harness<'static, Studio>, label: &str) {
    harness.get_by_role_and_label(egui::accesskit::Role::Button, label).click();
    harness.step();
}

/// Checks that a text of the window contains `part`.
#[track_caller]
fn says(harness: &Harness<'static, Studio>, part: &str) {
    assert!(
        harness.query_all_by_label_contains(part).next().is_some(),
        "the window does not say {part:?}"
    );
}

fn numbers(studio: &Studio) -> Vec<[u32; 4]> {
    Layer::ALL
        .into_iter()
        .flat_map(|l| {
            studio
                .session
                .document
                .layers
                .of(l)
                .iter()
                .map(|x| x.map(f32::to_bits))
                .collect::<Vec<_>>()
        })
        .collect()
}

fn folder(name: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("plisse-studio-{name}-{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&path);
    std::fs::create_dir_all(&path).unwrap();
    path
}

const SCENE: &str = r#"# A small sheet that is sheared.
title = "Small sheet"

[material]
young_pa = 1e6 # soft
poisson = 0.3
thickness_m = 1e-4

[[panel]]
name = "sheet"
shape = "rectangle"
width_m = 0.3
height_m = 0.1
edge_length_m = 0.02

[[clamp]]
side = "sheet.bottom"

[[clamp]]
side = "sheet.top"
move_m = [0.006, 0.0, 0.0]
"#;

#[test]
fn it_begins_with_a_model_that_wrinkles() {
    let mut harness = window(studio(false, None));
    let begun = Instant::now();
    while harness.state().viewport.frame.is_none() {
        harness.step();
        std::thread::sleep(Duration::from_millis(2));
    }
    eprintln!("first picture after {:.0} ms", begun.elapsed().as_secs_f64() * 1e3);
    let frame = harness.state().viewport.frame.clone().unwrap();
    let state = frame.state.unwrap();
    assert!(state.waves.strength.iter().filter(|&&s| s > 0.3).count() > 40, "the curtain wrinkles");
    // The picture shows it: many colours, and the model fills it.
    let background = plisse_live::draw::BACKGROUND;
    let covered = frame.image.pixels.chunks(3).filter(|p| *p != background).count();
    let share = covered as f64 / (frame.image.pixels.len() / 3) as f64;
    assert!((0.2..0.95).contains(&share), "{share}");
    press(&mut harness, "Export");
    harness.step();
    assert_eq!(harness.state().shell.tab, Tab::Export);
}

#[test]
fn a_stroke_is_painted_with_the_pointer_and_undone_with_the_keys() {
    let mut harness = window(studio(false, None));
    harness.state_mut().viewport.playing = false;
    harness.state_mut().session.document.settings.time_s = 0.3;
    press(&mut harness, "Paint");
    settle(&mut harness);
    assert_eq!(harness.state().shell.tab, Tab::Paint);
    harness.state_mut().tools.brush.radius_m = 0.35;
    let before = numbers(harness.state());
    let camera = harness.state().viewport.orbit;
    drag(&mut harness, &[MIDDLE, pos2(720.0, 430.0), pos2(745.0, 470.0), pos2(760.0, 500.0)]);
    let after = numbers(harness.state());
    assert_ne!(before, after, "{:?}", harness.state().shell.messages.last());
    assert_eq!(harness.state().session.document.history.done().len(), 1);
    assert_eq!(harness.state().viewport.orbit, camera, "painting turns nothing");
    let changed = harness.state().session.document.history.done()[0].vertices.len();
    assert!((4..60).contains(&changed), "{changed}");
    assert!(harness.state().session.is_unsaved());
    settle(&mut harness);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    harness.step();
    harness.step();
    assert_eq!(numbers(harness.state()), before);
    harness.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    harness.step();
    harness.step();
    assert_eq!(numbers(harness.state()), after);
    // A drag beside the model turns it instead.
    drag(&mut harness, &[pos2(345.0, 720.0), pos2(365.0, 700.0), pos2(385.0, 690.0)]);
    assert_ne!(harness.state().viewport.orbit, camera);
    assert_eq!(numbers(harness.state()), after);
}

#[test]
fn every_view_has_a_key_and_another_picture() {
    let mut harness = window(studio(false, None));
    harness.state_mut().viewport.playing = false;
    let mut seen: Vec<Vec<u8>> = Vec::new();
    for (n, key) in
        [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5, Key::Num6].into_iter().enumerate()
    {
        harness.key_press(key);
        harness.step();
        assert_eq!(harness.state().viewport.view, View::MAIN[n]);
        harness.state_mut().viewport.frame = None;
        settle(&mut harness);
        let frame = harness.state().viewport.frame.clone().unwrap();
        assert!(
            !seen.contains(&frame.image.pixels),
            "{:?} shows what another view shows",
            View::MAIN[n]
        );
        assert_eq!(
            frame.legend.is_some(),
            matches!(View::MAIN[n], View::Strain | View::Amplitude | View::Phase)
        );
        assert_eq!(!frame.marks.is_empty(), View::MAIN[n] == View::Direction);
        seen.push(frame.image.pixels);
    }
}

#[test]
fn a_scene_is_solved_and_exported_as_the_command_line_makes_it() {
    let folder = folder("solve");
    let path = folder.join("small.toml");
    std::fs::write(&path, SCENE).unwrap();
    let mut harness = window(studio(false, None));
    harness.state_mut().open(&path);
    settle(&mut harness);
    assert_eq!(harness.state().shell.tab, Tab::Physics);
    press(&mut harness, "Solve");
    settle(&mut harness);
    let solved = harness.state().jobs.physics.solved.clone().expect("solved");
    assert_eq!(harness.state().viewport.shown, ShownSurface::Solved);
    assert!(solved.field.amplitude_m.iter().any(|&a| a > 1e-5));
    // Another constant: it goes on from where it was, and needs fewer iterations than from the
    // start.
    let fabric = plisse_studio::document::scene_edit::Edit::Material {
        young_pa: 1.1e6,
        poisson: 0.3,
        thickness_m: 1e-4,
        density_kg_m3: None,
    };
    harness.state_mut().run(Command::EditScene(fabric));
    harness.state_mut().run(Command::Solve);
    settle(&mut harness);
    let again = harness.state().jobs.physics.solved.clone().expect("solved again");
    let (first, next) = (solved.base_report.iterations, again.base_report.iterations);
    assert!(2 * next <= first, "{next} iterations after {first}");
    // Exported.
    let out = folder.join("out");
    harness.state_mut().export_files(Kind::SceneFiles, &out);
    settle(&mut harness);
    assert_eq!(
        harness.state().jobs.export.written.len(),
        5,
        "{:?}",
        harness.state().shell.messages.last()
    );
    let text = std::fs::read_to_string(out.join("scene.toml")).unwrap();
    assert!(text.starts_with("# A small sheet") && text.contains("1100000.0 # soft"), "{text}");
    same_as_the_library(&out);
    same_as_the_command(&out);
    for name in ["s.obj", "s.ply", "s.glb"] {
        harness.state_mut().export_files(Kind::Surface, &folder.join(name));
        settle(&mut harness);
        assert!(std::fs::metadata(folder.join(name)).unwrap().len() > 1000, "{name}");
    }
    harness.state_mut().export_files(Kind::Field, &folder.join("field.json"));
    settle(&mut harness);
    assert!(folder.join("field.json").exists());
    std::fs::remove_dir_all(&folder).unwrap();
}

/// The exported scene file, solved by the library's calls, gives the bytes beside it.
fn same_as_the_library(out: &Path) {
    let built =
        plisse::scene::build(&plisse::scene::read(out.join("scene.toml")).unwrap()).unwrap();
    let silent = plisse::progress::Silent;
    let (pose, _) =
        plisse::shell::solve_base(&built.setup(), &built.start, &built.base_options, &silent)
            .unwrap();
    let held = built.clamps.held();
    let solved =
        plisse::field::solve(&built.sheet, &pose, &held, &built.field_options, &silent).unwrap();
    let mut bytes = Vec::new();
    plisse::field::json::write(&mut bytes, &built.sheet.topology, &solved.field).unwrap();
    assert!(bytes == std::fs::read(out.join("field.json")).unwrap(), "field.json differs");
}

/// The same by the command itself, where it was built beside this test.
fn same_as_the_command(out: &Path) {
    let test = std::env::current_exe().unwrap();
    let Some(command) =
        test.ancestors().skip(1).take(3).map(|f| f.join("plisse")).find(|p| p.is_file())
    else {
        eprintln!("plisse is not built beside this test; only the library was compared");
        return;
    };
    let again = out.join("again");
    let run = std::process::Command::new(command)
        .arg("solve")
        .arg(out.join("scene.toml"))
        .arg("-o")
        .arg(&again)
        .output()
        .unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    for name in ["base.obj", "wrinkled.obj", "wrinkled.glb", "field.json"] {
        assert!(
            std::fs::read(out.join(name)).unwrap() == std::fs::read(again.join(name)).unwrap(),
            "{name} differs"
        );
    }
    eprintln!("four files are the same as those of plisse solve");
}

#[test]
fn live_waves_are_exported_and_a_full_disk_loses_nothing() {
    let folder = folder("take");
    let mut harness = window(studio(false, None));
    harness.state_mut().viewport.playing = false;
    harness.state_mut().jobs.export.map_size = 256;
    settle(&mut harness);
    harness.state_mut().shell.tab = Tab::Paint;
    harness.state_mut().tools.brush.radius_m = 0.4;
    drag(&mut harness, &[MIDDLE, pos2(740.0, 420.0), pos2(780.0, 450.0)]);
    for (kind, name) in [
        (Kind::Surface, "c.glb"),
        (Kind::Surface, "c.obj"),
        (Kind::Maps, "maps"),
        (Kind::Paint, "paint"),
        (Kind::Field, "f.json"),
    ] {
        harness.state_mut().export_files(kind, &folder.join(name));
        settle(&mut harness);
        assert!(
            folder.join(name).exists(),
            "{kind:?}: {:?}",
            harness.state().shell.messages.last()
        );
    }
    assert!(
        folder.join("maps/height.png").exists()
            && folder.join("maps/bias.json").exists()
            && folder.join("paint/bias.json").exists()
    );
    assert!(!harness.state().shell.messages.open, "{:?}", harness.state().shell.messages.last());
    // No scene, no scene files; an unknown format; and a disk without room.
    let before = numbers(harness.state());
    for (kind, path, part) in [
        (Kind::SceneFiles, folder.join("x"), "came from no scene"),
        (Kind::Surface, folder.join("x.fbx"), "let it end in .obj"),
        (Kind::Surface, full_disk(&folder).join("x.obj"), "writing failed"),
    ] {
        harness.state_mut().export_files(kind, &path);
        settle(&mut harness);
        let message = harness.state().shell.messages.last().unwrap().text.clone();
        assert!(harness.state().shell.messages.open && message.contains(part), "{message}");
        assert!(message.contains("your work is still here"), "{message}");
        harness.step();
        says(&harness, part);
        harness.state_mut().shell.messages.open = false;
    }
    assert_eq!(numbers(harness.state()), before);
    let _ = std::process::Command::new("umount").arg(folder.join("full")).output();
    std::fs::remove_dir_all(&folder).unwrap();
}

/// A folder on a disk of 64 kB, where one can be had; else one in which nothing can be written.
fn full_disk(folder: &Path) -> PathBuf {
    let full = folder.join("full");
    std::fs::create_dir_all(&full).unwrap();
    let mount = std::process::Command::new("mount")
        .args(["-t", "tmpfs", "-o", "size=64k", "tmpfs"])
        .arg(&full)
        .output();
    if mount.is_ok_and(|m| m.status.success()) {
        return full;
    }
    eprintln!("no small disk can be mounted here; a file stands where the folder should be");
    let file = folder.join("no-folder");
    std::fs::write(&file, "").unwrap();
    file
}

#[test]
fn bad_files_and_files_that_change_are_told_in_the_window() {
    let folder = folder("watch");
    let mut harness = window(studio(false, None));
    settle(&mut harness);
    let bad = folder.join("bad.glb");
    std::fs::write(&bad, "glTF and then nothing").unwrap();
    harness.state_mut().open(&bad);
    settle(&mut harness);
    says(&harness, "bad.glb");
    assert_eq!(
        harness.state().session.document.subject.source.stem(),
        "curtain",
        "what was open stays"
    );
    press(&mut harness, "Close");
    harness.step();
    assert!(!harness.state().shell.messages.open);
    let path = folder.join("small.toml");
    std::fs::write(&path, SCENE).unwrap();
    harness.state_mut().open(&path);
    settle(&mut harness);
    std::thread::sleep(Duration::from_millis(20));
    std::fs::write(&path, SCENE.replace("0.006", "0.007")).unwrap();
    for _ in 0..200 {
        harness.step();
    }
    says(&harness, "has changed since it was read");
    assert_eq!(
        harness.state().session.document.subject.scene.as_ref().unwrap().scene.clamp[1].move_m[0],
        0.006
    );
    press(&mut harness, "Read again");
    settle(&mut harness);
    assert_eq!(
        harness.state().session.document.subject.scene.as_ref().unwrap().scene.clamp[1].move_m[0],
        0.007
    );
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn files_are_chosen_in_the_window_and_saved_work_comes_back() {
    let folder = folder("choose");
    let mut harness = window(studio(false, None));
    harness.state_mut().viewport.playing = false;
    harness.state_mut().shell.tab = Tab::Paint;
    settle(&mut harness);
    harness.state_mut().tools.brush.radius_m = 0.4;
    drag(&mut harness, &[MIDDLE, pos2(740.0, 420.0), pos2(780.0, 450.0)]);
    let painted = numbers(harness.state());
    assert!(harness.state().session.is_unsaved());
    harness.key_press_modifiers(Modifiers::COMMAND, Key::S);
    harness.step();
    harness.step();
    let path = folder.join("mine.plisse.json");
    write_name(&mut harness, &path);
    press(&mut harness, "Save");
    harness.step();
    assert!(
        path.is_file() && !harness.state().session.is_unsaved(),
        "{:?}",
        harness.state().shell.messages.last()
    );
    harness.state_mut().show_own("sleeve");
    harness.state_mut().viewport.playing = false;
    settle(&mut harness);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::O);
    harness.step();
    harness.step();
    write_name(&mut harness, &path);
    press(&mut harness, "Open");
    let begun = Instant::now();
    while harness.state().session.path.as_deref() != Some(path.as_path()) {
        harness.step();
        assert!(
            begun.elapsed() < Duration::from_secs(60),
            "{:?}",
            harness.state().shell.messages.last()
        );
    }
    assert_eq!(numbers(harness.state()), painted);
    std::fs::remove_dir_all(&folder).unwrap();
}

/// Replaces what stands in the field of the window in which files are chosen.
fn write_name(harness: &mut Harness<'static, Studio>, path: &Path) {
    harness.get_by_role_and_label(egui::accesskit::Role::TextInput, "File:").focus();
    harness.step();
    harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    harness.step();
    harness.event(egui::Event::Text(path.display().to_string()));
    harness.step();
}

#[test]
fn what_a_killed_program_left_is_recovered() {
    let folder = folder("recover");
    let mut harness = window(studio(false, Some(folder.clone())));
    harness.state_mut().viewport.playing = false;
    harness.state_mut().shell.tab = Tab::Paint;
    settle(&mut harness);
    harness.state_mut().tools.brush.radius_m = 0.4;
    drag(&mut harness, &[MIDDLE, pos2(740.0, 420.0), pos2(780.0, 450.0)]);
    let painted = numbers(harness.state());
    // Twenty seconds of frames.
    for _ in 0..1300 {
        harness.step();
    }
    let own = folder.join(format!("autosave-{}.plisse.json", std::process::id()));
    assert!(own.exists());
    // As a process that is gone left it. 4194304 is above every process number of Linux.
    std::fs::rename(&own, folder.join("autosave-4194304.plisse.json")).unwrap();
    let mut next = window(studio(false, Some(folder.clone())));
    next.step();
    next.step();
    says(&next, "ended before curtain was saved");
    press(&mut next, "Recover");
    settle(&mut next);
    assert_eq!(numbers(next.state()), painted);
    assert!(next.state().session.is_unsaved());
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn losing_the_gpu_leaves_a_picture_and_the_work() {
    let mut harness = window(studio(true, None));
    harness.state_mut().viewport.playing = false;
    settle(&mut harness);
    let device = harness.state().viewport.frame.as_ref().unwrap().device.clone();
    if device == plisse_studio::view::renderer::CPU_NAME {
        eprintln!("no GPU and no software adapter");
        return;
    }
    let (with, before) =
        (harness.state().viewport.frame.clone().unwrap(), numbers(harness.state()));
    harness.state_mut().viewport.lose_device();
    settle(&mut harness);
    let frame = harness.state().viewport.frame.clone().unwrap();
    assert_eq!(frame.device, plisse_studio::view::renderer::CPU_NAME);
    let message = harness.state().shell.messages.last().unwrap().text.clone();
    assert!(message.contains("drawn by the processor from now on"), "{message}");
    assert_eq!(numbers(harness.state()), before);
    // The CPU reference draws the same picture, but for rounding.
    let off = with
        .image
        .pixels
        .iter()
        .zip(&frame.image.pixels)
        .filter(|(a, b)| a.abs_diff(**b) > 12)
        .count();
    assert!(off * 50 < with.image.pixels.len(), "{off} of {}", with.image.pixels.len());
}

#[test]
fn what_is_painted_grows() {
    let folder = folder("grow");
    let path = folder.join("sheet.toml");
    let scene = SCENE
        .replace("edge_length_m = 0.02", "edge_length_m = 0.008")
        .replace("move_m = [0.006, 0.0, 0.0]\n", "");
    std::fs::write(&path, scene).unwrap();
    let mut harness = window(studio(false, None));
    harness.state_mut().open(&path);
    settle(&mut harness);
    harness.state_mut().shell.tab = Tab::Paint;
    harness.state_mut().choose_layer(Layer::Expansion);
    harness.state_mut().tools.brush.radius_m = 0.03;
    harness.state_mut().tools.brush.value = 0.2;
    settle(&mut harness);
    drag(
        &mut harness,
        &[pos2(600.0, 400.0), pos2(660.0, 400.0), pos2(740.0, 400.0), pos2(800.0, 400.0)],
    );
    assert!(
        harness.state().session.document.layers.is_painted(Layer::Expansion),
        "{:?}",
        harness.state().shell.messages.last()
    );
    harness.state_mut().session.document.settings.fold_spacing_m = 0.05;
    press(&mut harness, "Grow");
    harness.step();
    press(&mut harness, "Grow the whole");
    settle(&mut harness);
    let grown = harness
        .state()
        .jobs
        .growth
        .grown
        .clone()
        .unwrap_or_else(|| panic!("{:?}", harness.state().shell.messages.last()));
    let raised = grown.pose.iter().map(|p| p.z.abs()).fold(0.0, f64::max);
    assert!(raised > 5e-4, "{raised} m");
    assert_eq!(harness.state().viewport.shown, ShownSurface::Grown);
    harness.state_mut().export_files(Kind::Surface, &folder.join("grown.obj"));
    settle(&mut harness);
    assert!(folder.join("grown.obj").exists());
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn the_surface_folds_under_the_brush_and_what_is_taken_back_comes_back_to_the_bit() {
    let mut harness = window(studio(false, None));
    let sheet = plisse_studio::document::Subject::new(
        plisse_studio::document::Source::Own("sheet".into()),
        plisse_live::models::sheet(41, 41),
    );
    let studio = harness.state_mut();
    studio.show(plisse_studio::document::Document::new(sheet), None);
    (
        studio.session.document.settings.fold_spacing_m,
        studio.session.document.settings.coherence_m,
    ) = (0.2, 0.2);
    (studio.viewport.playing, studio.shell.tab) = (false, Tab::Grow);
    studio.tools.brush.radius_m = 0.12;
    settle(&mut harness);
    harness.get_by_label("fold under the brush").click();
    harness.step();
    assert!(
        harness.state().jobs.growth.follows()
            && harness.state().tools.brush.layer == Layer::Expansion
    );
    let stroke = |y: f32| [-60.0, -30.0, 0.0, 30.0, 60.0].map(|x| MIDDLE + egui::vec2(x, y));
    let pose = |harness: &Harness<'static, Studio>| {
        harness.state().jobs.growth.grown.as_ref().unwrap().pose.clone()
    };
    drag(&mut harness, &stroke(-40.0));
    settle(&mut harness);
    let first = pose(&harness);
    let depth = |pose: &[plisse::mesh::Vec3]| pose.iter().map(|p| p.y.abs()).fold(0.0, f64::max);
    assert!(depth(&first) > 0.01, "{}", depth(&first));
    assert_eq!(harness.state().viewport.shown, ShownSurface::Grown);
    // Far from the stroke nothing moves at all.
    let flat = first.iter().filter(|p| p.y == 0.0).count();
    assert!(flat > 200 && flat < 1500, "{flat}");
    drag(&mut harness, &stroke(60.0));
    settle(&mut harness);
    assert_ne!(pose(&harness), first);
    harness.state_mut().run(Command::Undo);
    settle(&mut harness);
    assert_eq!(pose(&harness), first);
    // Done again, it folds again; what cannot be followed is told.
    harness.state_mut().run(Command::Redo);
    settle(&mut harness);
    assert_ne!(pose(&harness), first);
    harness.state_mut().fold_under_brush(false);
    harness.state_mut().jobs.growth.grown = None;
    harness.state_mut().fold_under_brush(true);
    let begun = Instant::now();
    while harness.state().jobs.growth.follows() && begun.elapsed() < Duration::from_secs(20) {
        harness.step();
    }
    harness.step();
    says(&harness, "press Grow the whole");
}

#[test]
fn frames_of_a_hundred_thousand_vertices_are_measured() {
    let Report { rows, strokes, device } = measure(false, &[View::Wrinkled], 1).unwrap();
    for row in &rows {
        eprintln!(
            "{:<18} idle {:.2} ms, longest {:.1} ms, stages {:.1} ms, drawing {:.1} ms ({device})",
            row.view.name(),
            row.idle_ms,
            row.longest_ms,
            row.stages_ms,
            row.render_ms
        );
    }
    eprintln!("{strokes:?}");
    // How long they take is for `--measure` (docs/studio.md); these limits are far above it, for
    // machines that are busy with something else.
    assert!(strokes.vertices > 5000 && strokes.longest_ms > 0.0, "{strokes:?}");
    assert!(
        rows.iter().all(|r| r.idle_ms > 0.0 && r.idle_ms < 15.0 && r.stages_ms > 0.0),
        "many times what it takes on a quiet machine"
    );
    assert!(strokes.longest_ms < 1000.0, "{strokes:?}");
}
