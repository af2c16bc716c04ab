//! The scaling law of Vandeparre et al. 2011 instead of the solve (figures 8 and 10 of [Chen
//! 2021]).

use plisse::field::{self, ScalingLaw, WrinkleField};
use plisse::scene::{self, BuiltScene, SolvedScene};

use super::solved::{Figures, Look, peak_mm};
use super::table::{Cell, fixed, none, scientific, text};
use super::{Stop, Study, scenes};

/// Parts of the way from the clamps to the point farthest from them.
const BANDS: [(&str, f64, f64); 3] =
    [("near the clamps", 0.0, 0.2), ("between", 0.4, 0.6), ("farthest from them", 0.8, 1.0)];

pub(crate) fn run(study: &mut Study<'_>) -> Result<(), Stop> {
    let mut energies = Vec::new();
    study.document.table(
        "Wavelength by the distance from the clamps",
        "The law: from a clamped edge the wavelength grows with the distance x as (B/T)^¼ x^½ \
         under a tension T, as h^⅓ δ^(−1/6) x^⅔ without (Vandeparre et al. 2011). It has no \
         prefactors; ours under tension, 2√(2π), gives in the middle between two clamps the \
         wavelength of Cerda and Mahadevan 2003. Medians over faces that wrinkle visibly. \
         Published (Chen et al. 2021, figures 8 and 10) as pictures only: too fine, unnatural \
         wrinkles near the clamps.",
        &["scene", "where", "solve: wavelength (mm)", "law (mm)", "law, as a closed form (mm)"],
    );
    for number in [2, 3, 1] {
        let scene = scenes::first_three(number)?;
        let built = match study.quick {
            true => scene::with_vertices(&scene, 200)?.1,
            false => scene::build(&scene)?,
        };
        let solution = study.solve(built)?;
        let law = law(&solution)?;
        let farthest = law.distance_m.iter().copied().fold(0.0, f64::max);
        for (place, from, to) in BANDS {
            let inside = |f: usize| (from * farthest..=to * farthest).contains(&law.distance_m[f]);
            let built = &solution.built;
            study.document.row([
                text(&scene.title),
                text(place),
                median_mm(
                    visible(built, &solution.field)
                        .filter(|&f| inside(f))
                        .map(|f| wavelength(built, &solution.field, f)),
                ),
                median_mm(
                    visible(built, &law.field).filter(|&f| inside(f)).map(|f| law.wavelength_m[f]),
                ),
                median_mm(
                    visible(built, &law.field)
                        .filter(|&f| inside(f))
                        .map(|f| wavelength(built, &law.field, f)),
                ),
            ]);
        }
        energies.push(energy_row(&scene, &solution, &law));
        let (built, pose) = (&solution.built, &solution.pose);
        let looks = [
            Look::wrinkled("Solve", built, pose, &solution.field, true),
            Look::wrinkled("Scaling law", built, pose, &law.field, true),
            Look::phase("Phase of the solve", built, pose, &solution.field),
            Look::phase("Phase of the law", built, pose, &law.field),
        ];
        study.picture(
            &format!("scaling-law-{number:02}"),
            &format!("{}: solve and scaling law", scene.title),
            built,
            &looks,
        )?;
    }
    study.document.table(
        "Waves and energy",
        "Energy of the field in the same functional (eqs. 20–26 of Chen et al. 2021); the law does \
         not minimise it.",
        &[
            "scene",
            "solve: waves",
            "law: waves",
            "published waves (solve)",
            "solve: largest amplitude (mm)",
            "law: largest amplitude (mm)",
            "solve: energy (J)",
            "law: energy (J)",
            "law / solve",
        ],
    );
    energies.into_iter().for_each(|row| study.document.row(row));
    Ok(())
}

/// The law's wrinkles on the same base surface.
fn law(solution: &SolvedScene) -> Result<ScalingLaw, Stop> {
    let built = &solution.built;
    let held = built.clamps.held();
    Ok(field::scaling_law(&built.sheet, &solution.pose, &held, &built.field_options)?)
}

fn energy_row(scene: &scene::Scene, solution: &SolvedScene, law: &ScalingLaw) -> [Cell; 9] {
    let built = &solution.built;
    let energy = |field: &WrinkleField| {
        let terms = field::energy(&built.sheet, &solution.pose, &built.field_options, field);
        terms.stretching_joule
            + terms.curvature_joule
            + terms.mixed_joule
            + terms.amplitude_gradient_joule
            + terms.bending_joule
    };
    let mut report = solution.field_report.clone();
    report.periods.clone_from(&law.periods);
    let waves = |measured: Vec<scene::Measured>| {
        measured.first().map_or_else(none, |measured| fixed(measured.value, 1))
    };
    let published = solution.measures.first().and_then(|measured| measured.published);
    let (ours, laws) = (energy(&solution.field), energy(&law.field));
    [
        text(&scene.title),
        waves(solution.measures.clone()),
        waves(scene::measure(built, &law.field, &report)),
        published.map_or_else(none, |n| fixed(n, 0)),
        fixed(solution.peak_mm(), 3),
        fixed(peak_mm(&law.field), 3),
        scientific(ours),
        scientific(laws),
        fixed(laws / ours, 2),
    ]
}

/// Faces that wrinkle visibly: mean amplitude at least 1 % of the largest.
fn visible<'a>(built: &'a BuiltScene, field: &'a WrinkleField) -> impl Iterator<Item = usize> + 'a {
    let least = 3.0 * 0.01 * 1e-3 * peak_mm(field);
    let sum = move |f: usize| {
        built.sheet.topology.faces[f].iter().map(|&v| field.amplitude_m[v]).sum::<f64>()
    };
    (0..built.sheet.topology.face_count())
        .filter(move |&f| !field.wrinkle_free[f] && least > 0.0 && sum(f) >= least)
}

/// Wavelength (m) of a field on a face.
fn wavelength(built: &BuiltScene, field: &WrinkleField, f: usize) -> f64 {
    std::f64::consts::TAU / field.frequency(&built.sheet, f).norm()
}

fn median_mm(wavelengths_m: impl Iterator<Item = f64>) -> Cell {
    let mut list: Vec<f64> = wavelengths_m.filter(|w| w.is_finite()).collect();
    list.sort_by(f64::total_cmp);
    list.get(list.len() / 2).map_or_else(|| text("no wrinkles"), |median| fixed(1e3 * median, 2))
}
