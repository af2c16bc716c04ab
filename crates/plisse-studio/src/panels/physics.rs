//! The Physics tab: material and clamps of a scene, and its solve.

use egui::{Button, ComboBox, DragValue, RichText, Ui};
use plisse::scene::Scene;
use plisse::scene::SolvedScene;

use super::widgets::{Labels, number, progress};
use crate::commands::Command;
use crate::document::Document;
use crate::document::scene_edit::Edit;
use crate::fabrics::FABRICS;
use crate::jobs::physics::Physics;

/// Shows the tab; the commands that were chosen.
pub(crate) fn panel(ui: &mut Ui, document: &Document, physics: &mut Physics) -> Vec<Command> {
    let draft = physics.draft().map(|draft| draft.scene.clone());
    let Some(scene) = draft.or_else(|| document.subject.scene.as_ref().map(|s| s.scene.clone()))
    else {
        ui.label(
            "The solver needs a scene: panels or garments that are sewn, clamped and loaded. \
             Open a scene file (.toml); Plissé's own are in the folder examples.",
        );
        return Vec::new();
    };
    ui.label(RichText::new(&scene.title).strong());
    ui.heading("Material");
    let mut edit = fabric(ui, &scene);
    edit = material(ui, &scene).or(edit);
    ui.add_space(4.0);
    ui.heading("Clamps");
    edit = clamps(ui, &scene).or(edit);
    edit = pressure(ui, &scene).or(edit);
    ui.add_space(4.0);
    ui.heading("Solve");
    let solve = solve(ui, physics);
    if let Some(solved) = &physics.solved {
        result(ui, solved);
    }
    edit.map(Command::EditScene).into_iter().chain(solve).collect()
}

/// The choice of a named fabric, and the source of its constants.
fn fabric(ui: &mut Ui, scene: &Scene) -> Option<Edit> {
    let material = &scene.material;
    let named = FABRICS.iter().find(|f| {
        (f.young_pa, f.poisson, f.thickness_m)
            == (material.young_pa, material.poisson, material.thickness_m)
    });
    let mut edit = None;
    ComboBox::from_label("sheet")
        .selected_text(named.map_or("own constants", |f| f.name))
        .width(230.0)
        .show_ui(ui, |ui| {
            for fabric in &FABRICS {
                let row = ui.selectable_label(Some(fabric) == named, fabric.name);
                if row.on_hover_text(fabric.source).clicked() {
                    edit = Some(Edit::fabric(fabric));
                }
            }
        });
    if let Some(fabric) = named {
        ui.label(RichText::new(format!("Source: {}", fabric.source)).small());
    }
    edit
}

/// The constants of the material. Only a changed number is written to the scene: the others would
/// lose digits on the way through other units.
fn material(ui: &mut Ui, scene: &Scene) -> Option<Edit> {
    let material = &scene.material;
    let (mut young_mpa, mut poisson, mut thickness_mm) =
        (material.young_pa * 1e-6, material.poisson, material.thickness_m * 1e3);
    let (mut next, mut changed) = (*material, false);
    let labels =
        Labels { name: "Young's modulus", unit: " MPa", tip: "resistance to stretching (MPa)" };
    if number(ui, &mut young_mpa, 0.02e-6 * material.young_pa, labels) {
        (next.young_pa, changed) = (young_mpa * 1e6, true);
    }
    let labels = Labels {
        name: "Poisson's ratio",
        unit: "",
        tip: "how much the sheet narrows when it is stretched, above −1 and up to 0.5",
    };
    if number(ui, &mut poisson, 0.005, labels) {
        (next.poisson, changed) = (poisson, true);
    }
    let labels = Labels { name: "thickness", unit: " mm", tip: "thickness of the sheet (mm)" };
    if number(ui, &mut thickness_mm, 20.0 * material.thickness_m, labels) {
        (next.thickness_m, changed) = (thickness_mm * 1e-3, true);
    }
    if let Some(density) = &mut next.density_kg_m3 {
        let labels = Labels { name: "density", unit: " kg/m³", tip: "used by gravity (kg/m³)" };
        changed |= number(ui, density, 2.0, labels);
    }
    let (young_pa, poisson, thickness_m) = (next.young_pa, next.poisson, next.thickness_m);
    let density_kg_m3 = next.density_kg_m3;
    changed.then_some(Edit::Material { young_pa, poisson, thickness_m, density_kg_m3 })
}

fn clamps(ui: &mut Ui, scene: &Scene) -> Option<Edit> {
    let mut edit = None;
    for (n, clamp) in scene.clamp.iter().enumerate() {
        let near = clamp.near_m.map(|p| format!("near {:.2} {:.2} {:.2}", p[0], p[1], p[2]));
        let name = clamp.side.clone().or(near).unwrap_or_else(|| "in a box".into());
        ui.push_id(n, |ui| {
            ui.label(format!("{n}: {name}"));
            let mut move_m = clamp.move_m;
            if vector(ui, &mut move_m) {
                edit = Some(Edit::ClampMove { clamp: n, move_m });
            }
            if let Some(turn) = clamp.turn {
                let mut angle_deg = turn.angle_deg;
                let labels = Labels {
                    name: "turned by",
                    unit: "°",
                    tip: "angle about the scene's axis (degrees)",
                };
                if number(ui, &mut angle_deg, 0.2, labels) {
                    edit = Some(Edit::ClampTurn { clamp: n, angle_deg });
                }
            }
        });
    }
    edit
}

/// The fields of a displacement (m); true if it changed.
fn vector(ui: &mut Ui, move_m: &mut [f64; 3]) -> bool {
    ui.horizontal(|ui| {
        let mut changed = false;
        for (axis, x) in ["x ", "y ", "z "].into_iter().zip(move_m) {
            let field = DragValue::new(x).speed(0.002).prefix(axis).suffix(" m").max_decimals(4);
            let tip = "displacement of the clamp from the start (m)";
            changed |= ui.add(field).on_hover_text(tip).changed();
        }
        changed
    })
    .inner
}

fn pressure(ui: &mut Ui, scene: &Scene) -> Option<Edit> {
    let mut pressure_pa = scene.load.pressure_pa;
    if pressure_pa == 0.0 {
        return None;
    }
    let speed = 0.02 * pressure_pa.abs();
    let labels =
        Labels { name: "pressure", unit: " Pa", tip: "pressure inside, above that outside (Pa)" };
    number(ui, &mut pressure_pa, speed, labels).then_some(Edit::Pressure { pressure_pa })
}

/// The buttons and the progress of the solve.
fn solve(ui: &mut Ui, physics: &mut Physics) -> Option<Command> {
    ui.checkbox(&mut physics.follow, "solve again after each change")
        .on_hover_text("starts from the last pose");
    let (busy, has_pose) = (physics.is_solving(), physics.has_pose());
    let mut command = None;
    ui.horizontal(|ui| {
        let name = match (busy, has_pose) {
            (true, _) => "Stop",
            (false, true) => "Continue",
            (false, false) => "Solve",
        };
        if ui.add(Button::new(name)).on_hover_text("Ctrl+Enter").clicked() {
            command = Some(Command::Solve);
        }
        let restart = ui.add_enabled(!busy && has_pose, Button::new("From the start"));
        if restart.on_hover_text("forgets the last pose").clicked() {
            command = Some(Command::SolveFromStart);
        }
    });
    progress(ui, physics.progress(), busy);
    command
}

fn result(ui: &mut Ui, solved: &SolvedScene) {
    let field = &solved.field_report;
    ui.label(format!(
        "base: {} iterations in {:.2} s",
        solved.base_report.iterations, solved.base_report.seconds
    ));
    ui.label(format!(
        "field: {} iterations in {:.2} s",
        field.iterations,
        field.field_seconds + field.phase_seconds
    ));
    let most = solved.field.amplitude_m.iter().copied().fold(0.0, f64::max);
    ui.label(format!(
        "energy {:.5e} J, largest amplitude {:.3} mm",
        field.energy_joule,
        1e3 * most
    ));
    for m in &solved.measures {
        let published = m.published.map_or_else(String::new, |p| format!(" (published: {p})"));
        let value = if m.unit == "m" {
            format!("{:.3} mm", 1e3 * m.value)
        } else {
            format!("{:.2} {}", m.value, m.unit)
        };
        ui.label(format!("{}: {value}{published}", m.name));
    }
}
