//! Effect of each term and correction (figures 4 and 5 of [Chen 2021]), and of the projection of
//! element Hessians on the minimum that is found.

use plisse::field::FieldOptions;
use plisse::linalg::PsdProjection;
use plisse::scene::{self, BuiltScene, SolvedScene};

use super::solved::{Figures, Look};
use super::table::{Cell, count, fixed, maybe, none, scientific, text};
use super::{Stop, Study, scenes};

/// Terms and corrections left out of scene 01, each with the published number of waves.
const LEFT_OUT: [(&str, Option<&str>); 8] = [
    ("nothing", Some("46")),
    ("v1", Some("> 180")),
    ("v2", None),
    ("curvature", None),
    ("mixed", None),
    ("amplitude-gradient", None),
    ("bending", None),
    (FieldOptions::RELAXED_INTEGRABILITY, None),
];

pub(crate) fn run(study: &mut Study<'_>) -> Result<(), Stop> {
    cylinder(study)?;
    drape(study)?;
    treatments(study)
}

/// `built` without the term or correction of this name.
fn without(built: &BuiltScene, name: &str) -> plisse::Result<BuiltScene> {
    let field_options = match name {
        "nothing" => built.field_options.clone(),
        _ => built.field_options.clone().without(name)?,
    };
    Ok(BuiltScene { field_options, ..built.clone() })
}

fn cylinder(study: &mut Study<'_>) -> Result<(), Stop> {
    study.document.table(
        "Twisted cylinder (scene 01)",
        "One term or correction left out of the field's energy. Published: Chen et al. 2021, \
         figure 4, with 1.3k vertices; without v₁ \"over 180 wrinkles\".",
        &[
            "left out",
            "vertices",
            "waves before rounding",
            "waves",
            "published waves",
            "largest amplitude (mm)",
            "iterations",
            "energy (J)",
        ],
    );
    let (_, built) =
        scene::with_vertices(&scenes::first_three(1)?, if study.quick { 180 } else { 1309 })?;
    let (pose, base) = study.base(&built)?;
    let mut looks = Vec::new();
    for (name, published) in LEFT_OUT {
        let solution = study.solve_on(without(&built, name)?, pose.clone(), base.clone())?;
        let around = solution.around();
        study.document.row([
            text(name),
            count(solution.vertices()),
            maybe(around, |p| fixed(p.before_rounding, 1)),
            maybe(around, |p| count(p.turns)),
            maybe(published, text),
            fixed(solution.peak_mm(), 2),
            count(solution.field_report.iterations),
            scientific(solution.field_report.energy_joule),
        ]);
        if looks.len() < 4 {
            let title =
                if name == "nothing" { "Everything".to_owned() } else { format!("Without {name}") };
            looks.push(Look::wrinkled(&title, &built, &pose, &solution.field, true));
        }
    }
    if let Ok(looks) = <[Look; 4]>::try_from(looks) {
        study.picture(
            "ablation-cylinder",
            "Scene 01 with everything, without v₁, without v₂, without the curvature term (figure \
             4)",
            &built,
            &looks,
        )?;
    }
    Ok(())
}

fn drape(study: &mut Study<'_>) -> Result<(), Stop> {
    let Some(scene) = scenes::numbered(4)? else { return Ok(()) };
    study.document.table(
        "Sphere drape (scene 04)",
        "Without relaxed integrability no wrinkles can run around the ball's pole. Published (Chen \
         et al. 2021, figure 5, 1.6k vertices) as pictures only.",
        &[
            "left out",
            "vertices",
            "waves around",
            "largest amplitude (mm)",
            "wrinkle-free faces",
            "iterations",
            "energy (J)",
            "published",
        ],
    );
    let (_, built) = scene::with_vertices(&scene, if study.quick { 300 } else { 1600 })?;
    let (pose, base) = study.base(&built)?;
    let whole = study.solve_on(built.clone(), pose.clone(), base.clone())?;
    study.document.row(drape_row("nothing", &whole));
    let unrelaxed = study.solve_on(
        without(&built, FieldOptions::RELAXED_INTEGRABILITY)?,
        pose.clone(),
        base,
    )?;
    study.document.row(drape_row(FieldOptions::RELAXED_INTEGRABILITY, &unrelaxed));
    let looks = [
        Look::wrinkled("Everything", &built, &pose, &whole.field, true),
        Look::wrinkled("Drawn without v2", &built, &pose, &whole.field, false),
        Look::wrinkled("Without relaxed integrability", &built, &pose, &unrelaxed.field, true),
        Look::phase("Its phase", &built, &pose, &unrelaxed.field),
    ];
    study.picture(
        "ablation-drape",
        "Scene 04: everything, drawn without v₂, without relaxed integrability (figure 5)",
        &built,
        &looks,
    )
}

fn drape_row(name: &str, solution: &SolvedScene) -> [Cell; 8] {
    [
        text(name),
        count(solution.vertices()),
        maybe(solution.around(), |p| count(p.turns)),
        fixed(solution.peak_mm(), 2),
        count(solution.field.wrinkle_free.iter().filter(|free| **free).count()),
        count(solution.field_report.iterations),
        scientific(solution.field_report.energy_joule),
        none(),
    ]
}

fn treatments(study: &mut Study<'_>) -> Result<(), Stop> {
    study.document.table(
        "Which minimum is found",
        "The energy has many minima. While the Hessian is indefinite, negative eigenvalues of \
         element Hessians are replaced by their absolute values (the default) or clamped to zero. \
         Energies are of the field, lower is better. Nothing was published.",
        &[
            "scene",
            "absolute: energy (J)",
            "iterations",
            "clamped: energy (J)",
            "clamped: iterations",
        ],
    );
    for number in 1..=3 {
        let scene = scenes::first_three(number)?;
        let mut built = match study.quick {
            true => scene::with_vertices(&scene, 200)?.1,
            false => scene::build(&scene)?,
        };
        let (pose, base) = study.base(&built)?;
        let mut row = vec![text(&scene.title)];
        for projection in [PsdProjection::Abs, PsdProjection::Clamp] {
            built.field_options.psd_projection = projection;
            let report = study.solve_on(built.clone(), pose.clone(), base.clone())?.field_report;
            row.extend([scientific(report.energy_joule), count(report.iterations)]);
        }
        study.document.row(row);
    }
    Ok(())
}
