//! Dependence of field and shell on the number of vertices (figures 7, 20 and 21 of [Chen 2021]).

use plisse::scene::{self, Scene};

use super::solved::{Figures, Look, with_waves_at_half_height};
use super::table::{Cell, count, fixed, maybe, none, scientific, text};
use super::{Stop, Study, scenes};
use crate::report::shell_ending;

/// Edge lengths (m) of the cylinder; published vertices and waves; seconds of the published code:
/// base and field.
const CYLINDERS: [(f64, &str, &str, Option<f64>); 5] = [
    (0.48, "46 (180 vertices)", "0.06", Some(36.6)),
    (0.345, "46 (344)", "0.13", Some(51.9)),
    (0.241, "47 (688)", "1.0", Some(73.7)),
    (0.175, "46 (1309)", "1.7", Some(121.0)),
    (0.125, "45 (2543)", "–", None),
];

pub(crate) fn run(study: &mut Study<'_>) -> Result<(), Stop> {
    cylinder(study)?;
    stretched_sheet(study)?;
    sheared_rectangle(study)?;
    for (number, vertices, about) in [
        (
            5,
            &[382, 700, 1400, 2800][..],
            "Chen et al. 2021, figure 20 (a symmetric dress): consistent from about 1.4k vertices",
        ),
        (7, &[1000, 2000, 4000], "Chen et al. 2021, figure 11: 2k vertices"),
        (8, &[2500, 5000, 10_000], "Chen et al. 2021, figures 11 and 12: 5k vertices"),
    ] {
        if let Some(scene) = scenes::numbered(number)? {
            garment(study, number, &scene, vertices, about)?;
        }
    }
    shell_of_the_cylinder(study)?;
    shell_of_the_sheet(study)
}

fn cylinder(study: &mut Study<'_>) -> Result<(), Stop> {
    study.document.table(
        "Field on the twisted cylinder (scene 01)",
        "Irregular meshes, three seeds each. Published: Chen et al. 2021, figure 21; seconds of \
         their code on a 2-core machine.",
        &[
            "vertices",
            "waves before rounding",
            "waves",
            "published waves",
            "energy (J)",
            "base: iterations",
            "seconds",
            "published code, base (s)",
            "field: iterations",
            "field: seconds",
            "published code, field (s)",
            "ratio",
        ],
    );
    let scene = scenes::first_three(1)?;
    let (sizes, seeds) =
        if study.quick { (&CYLINDERS[..2], 1..=1) } else { (&CYLINDERS[..], 1..=3) };
    let mut looks = Vec::new();
    for &(edge, waves, base_seconds, field_seconds) in sizes {
        for seed in seeds.clone() {
            let mut scene = scene.clone();
            scene.panel[0].edge_length_m = edge;
            scene.panel[0].seed = seed;
            let solution = study.solve(scene::build(&scene)?)?;
            let (around, report) = (solution.around(), &solution.field_report);
            study.document.row([
                count(solution.vertices()),
                maybe(around, |p| fixed(p.before_rounding, 2)),
                maybe(around, |p| count(p.turns)),
                text(waves),
                scientific(report.energy_joule),
                count(solution.base_report.iterations),
                fixed(solution.base_report.seconds, 3),
                text(base_seconds),
                count(report.iterations),
                fixed(report.field_seconds, 3),
                maybe(field_seconds, |seconds| fixed(seconds, 1)),
                maybe(field_seconds, |seconds| fixed(seconds / report.field_seconds, 0)),
            ]);
            if seed == 1 && looks.len() < 4 {
                let title = format!("{} vertices", solution.vertices());
                looks.push(Look::wrinkled(
                    &title,
                    &solution.built,
                    &solution.pose,
                    &solution.field,
                    true,
                ));
            }
        }
    }
    match <[Look; 4]>::try_from(looks) {
        Ok(looks) => study.picture(
            "resolution-cylinder",
            "Scene 01 by the field at four resolutions (figure 21)",
            &scene::build(&scene)?,
            &looks,
        ),
        Err(_) => Ok(()),
    }
}

fn stretched_sheet(study: &mut Study<'_>) -> Result<(), Stop> {
    study.document.table(
        "Stretched sheet (scene 02) by how far it is stretched",
        "Published at 5 %: 5 waves, 0.42 mm (Chen et al. 2021, section 6.4); theory 0.35 mm (Wang \
         et al. 2018), who also say that wrinkles vanish under large strain.",
        &[
            "strain (%)",
            "vertices",
            "waves across the middle",
            "published waves",
            "largest amplitude (mm)",
            "published (mm)",
            "energy (J)",
            "iterations",
        ],
    );
    let scene = scenes::first_three(2)?;
    let percents = if study.quick { &[5.0][..] } else { &[2.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0] };
    for &percent in percents {
        let mut scene = scene.clone();
        let pull = 0.125 * percent / 100.0;
        scene.clamp[0].move_m = [-pull, 0.0, 0.0];
        scene.clamp[1].move_m = [pull, 0.0, 0.0];
        let solution = study.solve(scene::build(&scene)?)?;
        let published = percent == 5.0;
        study.document.row([
            fixed(percent, 0),
            count(solution.vertices()),
            maybe(solution.measure(), |waves| fixed(waves, 2)),
            if published { count(5) } else { none() },
            fixed(solution.peak_mm(), 4),
            if published { text("0.42 (theory 0.35)") } else { none() },
            scientific(solution.field_report.energy_joule),
            count(solution.field_report.iterations),
        ]);
    }
    Ok(())
}

fn sheared_rectangle(study: &mut Study<'_>) -> Result<(), Stop> {
    study.document.table(
        "Sheared rectangle (scene 03) by seed of the mesh",
        "Published: 25 wrinkles (Chen et al. 2021, 1k vertices); experiment: 19 (Wong and \
         Pellegrino 2006).",
        &[
            "seed",
            "vertices",
            "wrinkles along the middle line",
            "published",
            "energy (J)",
            "base: iterations",
            "field: iterations",
        ],
    );
    let scene = scenes::first_three(3)?;
    for seed in if study.quick { 1..=1 } else { 1..=6 } {
        let mut scene = scene.clone();
        scene.panel[0].seed = seed;
        let solution = study.solve(scene::build(&scene)?)?;
        study.document.row([
            count(seed),
            count(solution.vertices()),
            maybe(solution.measure(), |waves| fixed(waves, 2)),
            count(25),
            scientific(solution.field_report.energy_joule),
            count(solution.base_report.iterations),
            count(solution.field_report.iterations),
        ]);
    }
    Ok(())
}

fn garment(
    study: &mut Study<'_>,
    number: usize,
    scene: &Scene,
    vertices: &[usize],
    about: &str,
) -> Result<(), Stop> {
    study.document.table(
        &format!("{} (scene {number:02})", scene.title),
        &format!("Published: {about}; no numbers of waves."),
        &[
            "vertices",
            "waves around",
            "wavelength (mm)",
            "largest amplitude (mm)",
            "energy (J)",
            "base: iterations",
            "field: iterations",
            "published waves",
        ],
    );
    let mut looks = Vec::new();
    let vertices = if study.quick { &vertices[..1] } else { vertices };
    for &wanted in vertices {
        let outcome =
            scene::with_vertices(scene, wanted).map_err(Stop::from).and_then(|(finer, built)| {
                let (pose, base) = study.base_of(&finer, &built)?;
                study.solve_on(built, pose, base)
            });
        let Some(solution) =
            study.or_note(&format!("{}, {wanted} vertices", scene.title), outcome)?
        else {
            continue;
        };
        study.document.row([
            count(solution.vertices()),
            maybe(solution.waves_around(), |n| fixed(n, 1)),
            solution.wavelength_mm(),
            fixed(solution.peak_mm(), 3),
            scientific(solution.field_report.energy_joule),
            count(solution.base_report.iterations),
            count(solution.field_report.iterations),
            none(),
        ]);
        let title = format!("{} vertices", solution.vertices());
        if looks.is_empty() && vertices.len() == 3 {
            looks.push(Look::mesh("Coarsest base", &solution.built, &solution.pose));
        }
        looks.push(Look::wrinkled(&title, &solution.built, &solution.pose, &solution.field, true));
    }
    match <[Look; 4]>::try_from(looks) {
        Ok(looks) => {
            let built = scene::build(scene)?;
            study.picture(
                &format!("resolution-{number:02}"),
                &format!("{} at several resolutions", scene.title),
                &built,
                &looks,
            )
        }
        Err(_) => Ok(()),
    }
}

/// Columns of the tables of reference shells.
const SHELL: [&str; 9] = [
    "wanted vertices",
    "vertices",
    "waves",
    "published waves",
    "largest amplitude (mm)",
    "published (mm)",
    "iterations",
    "ending",
    "seconds",
];

fn shell_of_the_cylinder(study: &mut Study<'_>) -> Result<(), Stop> {
    study.document.table(
        "Reference shell on the twisted cylinder (scene 01)",
        "Waves counted around the middle, as one counts by eye. Started from the base surface on \
         the same mesh, 0.1 thicknesses rough. Published: Chen et al. 2021, figure 21, irregular \
         meshes; the field has 46 from 180 vertices on.",
        &SHELL,
    );
    let scene = with_waves_at_half_height(scenes::first_three(1)?);
    let published = [(6000, 10), (12_000, 12), (24_000, 14), (48_000, 15), (96_000, 19)];
    let sizes: Vec<_> = if study.quick {
        vec![(500, None, None)]
    } else {
        published.map(|(n, waves)| (n, Some(count(waves)), None)).into()
    };
    shells(
        study,
        &scene,
        sizes,
        "resolution-shell-01",
        "Scene 01: base, field, and the two finest reference shells",
    )
}

fn shell_of_the_sheet(study: &mut Study<'_>) -> Result<(), Stop> {
    study.document.table(
        "Reference shell on the stretched sheet (scene 02)",
        "Waves across the middle. Published: Chen et al. 2021, figure 7; the field has 5 waves \
         from 522 vertices on.",
        &SHELL,
    );
    let scene = scenes::first_three(2)?;
    let full = vec![
        (4000, None, None),
        (8000, None, None),
        (16_000, Some(count(0)), None),
        (32_000, Some(count(3)), Some(fixed(0.17, 2))),
        (65_000, Some(count(3)), Some(fixed(0.27, 2))),
        (130_000, Some(count(3)), Some(fixed(0.31, 2))),
    ];
    let sizes = if study.quick { vec![(500, None, None)] } else { full };
    shells(
        study,
        &scene,
        sizes,
        "resolution-shell-02",
        "Scene 02: base, field, and the two finest reference shells",
    )
}

/// A row for each number of vertices (with published waves and amplitude), and a picture of the
/// last two shells.
fn shells(
    study: &mut Study<'_>,
    scene: &Scene,
    sizes: Vec<(usize, Option<Cell>, Option<Cell>)>,
    picture: &str,
    caption: &str,
) -> Result<(), Stop> {
    let mut looks = Vec::new();
    for (wanted, waves, amplitude) in sizes {
        let (waves, amplitude) = (waves.unwrap_or_else(none), amplitude.unwrap_or_else(none));
        if wanted > study.shell_limit {
            study.document.row([
                count(wanted),
                text("beyond the limit"),
                none(),
                waves,
                none(),
                amplitude,
                none(),
                none(),
                none(),
            ]);
            continue;
        }
        let (finer, built) = scene::with_vertices(scene, wanted)?;
        let (base, _) = study.base_of(&finer, &built)?;
        let outcome = study.shell(&built, &base);
        let Some((pose, report, _)) =
            study.or_note(&format!("reference shell, {wanted} vertices"), outcome)?
        else {
            continue;
        };
        let measured = scene::measure_shell(&built, &base, &pose);
        let found = |unit: &str| measured.iter().find(|m| m.unit == unit).map(|m| m.value);
        study.document.row([
            count(wanted),
            count(pose.len()),
            maybe(found("waves"), |n| fixed(n, 1)),
            waves,
            maybe(found("m"), |a| fixed(1e3 * a, 3)),
            amplitude,
            count(report.iterations),
            text(shell_ending(&report)),
            fixed(report.seconds, 1),
        ]);
        looks.push(Look::cloth(&format!("Shell, {} vertices", pose.len()), &built, &pose));
    }
    let last: Vec<Look> = looks.into_iter().rev().take(2).collect();
    if let Ok([finest, finer]) = <[Look; 2]>::try_from(last) {
        let solution = study.solve(scene::build(scene)?)?;
        let (built, base) = (&solution.built, &solution.pose);
        let field = Look::wrinkled(
            &format!("Field, {} vertices", solution.vertices()),
            built,
            base,
            &solution.field,
            true,
        );
        study.picture(
            picture,
            caption,
            built,
            &[Look::mesh("Base surface", built, base), field, finer, finest],
        )?;
    }
    Ok(())
}
