//! The base solve and the reference shell against closed forms: elastica, catenary, inflated ball,
//! Euler's strip; and honest errors.

mod sheets;

use std::f64::consts::PI;

use plisse::linalg::Ending;
use plisse::material::Material;
use plisse::mesh::Vec3;
use plisse::progress::Silent;
use plisse::shell::pressure::volume_m3;
use plisse::shell::{Clamps, Loads, ReferenceOptions, Setup, solve_reference};

use sheets::{PosedSheet, Solver};

const GRAVITY: f64 = 9.81;

fn weight(density_kg_m3: f64) -> Loads {
    Loads { density_kg_m3, gravity_m_s2: Vec3::new(0.0, 0.0, -GRAVITY), ..Loads::default() }
}

/// Root of a rising function between `low` and `high`.
fn root(mut low: f64, mut high: f64, rising: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if rising(middle) < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

// ── A cantilever under its weight ────────────────────────────────────────────────────────────────

/// Reach, drop and angle (rad) of the tip of the elastica θ″ = −load·(1 − s)·cos θ, θ(0) = 0, θ′(1)
/// = 0, by shooting with Runge and Kutta's rule; lengths in units of its own, load = q·L³/D for the
/// weight q and the stiffness D (per width).
fn elastica(load: f64) -> (f64, f64, f64) {
    let shoot = |curvature: f64| {
        const STEPS: usize = 400;
        let step = 1.0 / STEPS as f64;
        // θ, θ′, x, z.
        let slope =
            |s: f64, y: [f64; 4]| [y[1], -load * (1.0 - s) * y[0].cos(), y[0].cos(), y[0].sin()];
        let along = |y: [f64; 4], k: [f64; 4], t: f64| std::array::from_fn(|i| y[i] + t * k[i]);
        let mut y = [0.0, curvature, 0.0, 0.0];
        for n in 0..STEPS {
            let s = n as f64 * step;
            let a = slope(s, y);
            let b = slope(s + 0.5 * step, along(y, a, 0.5 * step));
            let c = slope(s + 0.5 * step, along(y, b, 0.5 * step));
            let d = slope(s + step, along(y, c, step));
            y = std::array::from_fn(|i| {
                y[i] + step / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i])
            });
        }
        y
    };
    let [angle, _, reach, drop] = shoot(root(0.0, 0.5 * load, |curvature| shoot(curvature)[1]));
    (reach, drop, angle)
}

#[test]
fn the_elastica_of_a_small_load_is_the_beam() {
    let (reach, drop, angle) = elastica(1e-3);
    assert!(
        (drop / (1e-3 / 8.0) - 1.0).abs() < 1e-6
            && (angle / (1e-3 / 6.0) - 1.0).abs() < 1e-6
            && (reach - 1.0).abs() < 1e-6
    );
}

/// By how much (in drops of the elastica) the tip of a strip 1 m long, two squares wide, hangs too
/// deep and is off its place.
fn cantilever(solver: Solver, load: f64, columns: usize) -> (f64, f64) {
    let material = Material::new(1e6, 0.0, 5e-3).unwrap();
    // q·L³/D = ρghL³·12/(Yh³).
    let density = load * material.young_pa * material.thickness_m.powi(2) / (12.0 * GRAVITY);
    // The mesh bends between its first two columns of faces by the angle between them, so the slope
    // is zero in the middle of the first, which the two held columns of vertices keep level: there
    // the elastica begins, and errors are of second order.
    let edge = 1.0 / (columns as f64 - 0.5);
    let sheet = PosedSheet::lattice(columns as f64 * edge, 2.0 * edge, columns, 2);
    let mut clamps = Clamps::none(sheet.pose.len());
    for v in (0..sheet.pose.len()).filter(|v| v % (columns + 1) < 2) {
        clamps.hold(v, sheet.pose[v]);
    }
    let solved = solver
        .solve(
            &Setup { loads: weight(density), ..Setup::new(&sheet.of(&material), &clamps) },
            &sheet.pose,
        )
        .unwrap();
    let tip = solved.pose[columns + columns + 1] - Vec3::new(0.5 * edge, edge, 0.0);
    let (reach, drop, _) = elastica(load);
    let (deeper, off) = (-tip.z / drop - 1.0, (tip - Vec3::new(reach, 0.0, -drop)).norm() / drop);
    eprintln!(
        "{solver:?} load {load}, {columns} columns: {deeper:.1e} too deep, {off:.1e} off, {:?} \
         after {}",
        solved.ending, solved.iterations
    );
    assert!(solved.settled(), "{:?}", solved.ending);
    (deeper, off)
}

#[test]
fn a_cantilever_is_the_elastica() {
    for (load, least_angle) in [(0.1, 0.0), (10.0, PI / 4.0)] {
        assert!(elastica(load).2 > least_angle);
        let errors = [10, 20, 40].map(|columns| cantilever(Solver::Reference, load, columns).1);
        assert!(
            errors[0] < 0.01 && errors[1] < 0.3 * errors[0] && errors[2] < 0.3 * errors[1],
            "load {load}: {errors:?}"
        );
    }
}

/// Quadratic bending is blind to saddles: a strip with free edges that also may shrink hangs lower
/// than any that resists them.
#[test]
fn the_base_surface_of_a_cantilever_hangs_too_low() {
    for load in [0.1, 10.0] {
        for columns in [10, 20] {
            let (deeper, _) = cantilever(Solver::Base, load, columns);
            assert!(deeper > 0.05, "load {load}: {deeper}");
        }
    }
}

// ── A hanging chain ──────────────────────────────────────────────────────────────────────────────

/// Horizontal tension (N/m) and sag (m) of an elastic catenary of two halves of this length (at
/// rest) over this half span. In a strip of ν = 0 the tension is Yh/2·(λ² − 1)·λ at stretch λ.
fn catenary(stiffness: f64, weight: f64, half_length: f64, half_span: f64) -> (f64, f64) {
    const STEPS: usize = 2000;
    let stretch = |tension: f64| {
        let mut l = 1.0;
        for _ in 0..30 {
            l -= (stiffness / 2.0 * (l * l - 1.0) * l - tension)
                / (stiffness / 2.0 * (3.0 * l * l - 1.0));
        }
        l
    };
    let shape = |level: f64| {
        let step = half_length / STEPS as f64;
        (0..STEPS).fold([0.0, 0.0], |[x, z], n| {
            let upright = weight * (n as f64 + 0.5) * step;
            let tension = level.hypot(upright);
            let part = stretch(tension) / tension * step;
            [x + level * part, z + upright * part]
        })
    };
    let level = root(0.0, 100.0 * weight * half_length, |level| shape(level)[0] - half_span);
    (level, shape(level)[1])
}

#[test]
fn a_stiff_catenary_is_a_cosh() {
    // Over a span of 2 m with parameter c = H/w = 1 m: half length sinh 1, sag cosh 1 − 1.
    let (level, sag) = catenary(1e9, 1.0, 1.0_f64.sinh(), 1.0);
    assert!(
        (level - 1.0).abs() < 1e-5 && (sag - (1.0_f64.cosh() - 1.0)).abs() < 1e-5,
        "{level} {sag}"
    );
}

/// Strips of 1.2 m whose ends are brought to 1 m from each other, hardly and clearly stretched.
#[test]
fn a_hung_strip_is_a_catenary() {
    let (width, columns) = (0.1, 48);
    let sheet = PosedSheet::lattice(1.2, width, columns, 4);
    for (young, density) in [(1e7, 1000.0), (1e5, 1000.0)] {
        let material = Material::new(young, 0.0, 1e-4).unwrap();
        let (level, sag) = catenary(
            young * material.thickness_m,
            density * GRAVITY * material.thickness_m,
            0.6,
            0.5,
        );
        let hang = |solver: Solver, span: f64, start: &[Vec3]| {
            let mut clamps = Clamps::none(sheet.pose.len());
            for (v, p) in
                sheet.pose.iter().enumerate().filter(|(v, _)| v % (columns + 1) % columns == 0)
            {
                clamps.hold(v, Vec3::new(0.6 + span / 2.0 * (p.x / 0.6 - 1.0), p.y, 0.0));
            }
            let solved = solver
                .solve(
                    &Setup { loads: weight(density), ..Setup::new(&sheet.of(&material), &clamps) },
                    start,
                )
                .unwrap();
            assert!(solved.settled(), "{:?}", solved.ending);
            solved
        };
        let mut start = sheet.pose.clone();
        for solver in Solver::BOTH {
            let solved = hang(solver, 1.0, &start);
            start = solved.pose;
            let found = -start[2 * (columns + 1) + columns / 2].z;
            // What the ends' pull does when they part.
            let [near, far] =
                [1.0 - 1e-3, 1.0 + 1e-3].map(|span| hang(solver, span, &start).energy_joule);
            let pull = (far - near) / 2e-3 / width;
            eprintln!(
                "{solver:?} Y = {young:e}: sag {:.1e} of {sag:.4} m off, tension {:.1e} of \
                 {level:.4} N/m off, {} iterations",
                found / sag - 1.0,
                pull / level - 1.0,
                solved.iterations
            );
            assert!(
                (found / sag - 1.0).abs() < 0.01 && (pull / level - 1.0).abs() < 0.01,
                "{solver:?}: {found} {sag}, {pull} {level}"
            );
        }
    }
}

// ── An inflated ball ─────────────────────────────────────────────────────────────────────────────

/// Stretched by s everywhere, a ball of radius R has the energy 4πR²·h/4·2(α + β)(s² − 1)² −
/// p·4/3·πR³s³, which is least where p = 2(α + β)·h/R·(s² − 1)/s. Nothing holds it.
#[test]
fn an_inflated_ball_has_the_radius_of_a_thin_shell() {
    let radius = 0.7;
    let material = Material::new(1e6, 0.3, 1e-4).unwrap();
    for (solver, stretch) in [
        (Solver::Base, 1.1),
        (Solver::Reference, 1.1),
        (Solver::Base, 1.4),
        (Solver::Reference, 1.4),
    ] {
        let pressure_pa = 2.0 * (material.alpha() + material.beta()) * material.thickness_m
            / radius
            * (stretch * stretch - 1.0)
            / stretch;
        let errors = [2, 3].map(|cuts| {
            let sheet = PosedSheet::ball(radius, cuts);
            let clamps = Clamps::none(sheet.pose.len());
            let made = sheet.of(&material);
            let setup = Setup {
                loads: Loads { pressure_pa, ..Loads::default() },
                ..Setup::new(&made, &clamps)
            };
            let solved = solver.solve(&setup, &sheet.pose).unwrap();
            assert!(solved.settled(), "{:?}", solved.ending);
            let middle = solved.pose.iter().sum::<Vec3>() / solved.pose.len() as f64;
            let radii: Vec<f64> = solved.pose.iter().map(|p| (p - middle).norm()).collect();
            let mean = radii.iter().sum::<f64>() / radii.len() as f64;
            let round = radii.iter().map(|r| (r / mean - 1.0).abs()).fold(0.0, f64::max);
            let volume =
                volume_m3(&sheet.topology, &solved.pose) / volume_m3(&sheet.topology, &sheet.pose);
            eprintln!(
                "{solver:?} s = {stretch}, {cuts} cuts: radius {:.1e} off, {round:.1e} out of \
                 round, volume {:.1e} off, {} iterations",
                mean / (stretch * radius) - 1.0,
                volume / stretch.powi(3) - 1.0,
                solved.iterations
            );
            assert!(
                round < 0.01 && (volume / stretch.powi(3) - 1.0).abs() < 0.015,
                "{round} \
                {volume}"
            );
            mean / (stretch * radius) - 1.0
        });
        assert!(
            errors[1].abs() < 2e-3 && errors[1].abs() < 0.3 * errors[0].abs(),
            "{solver:?}, stretch {stretch}: {errors:?}"
        );
    }
}

// ── Euler's strip ────────────────────────────────────────────────────────────────────────────────

/// A strip of 1 m on knife edges (ν = 0): pressed together by 1 − λ² = −2ε it bears Yh·ε, and bends
/// where that is above π²D/L², that is ε > π²h²/(12L²). Little beyond, it bulges by 2L/π·√(ε − ε₀).
#[test]
fn a_strip_buckles_at_eulers_load() {
    let columns = 24;
    let sheet = PosedSheet::lattice(1.0, 0.1, columns, 2);
    let material = Material::new(1e6, 0.0, 0.02).unwrap();
    let critical = (PI * material.thickness_m).powi(2) / 12.0;
    let press = |strain: f64, imperfection_m: f64| {
        let mut clamps = Clamps::none(sheet.pose.len());
        let stretch = (1.0 - 2.0 * strain).sqrt();
        for (v, p) in
            sheet.pose.iter().enumerate().filter(|(v, _)| v % (columns + 1) % columns == 0)
        {
            clamps.targets[v] = [Some(stretch * p.x), (p.y == 0.0).then_some(0.0), Some(0.0)];
        }
        let options =
            ReferenceOptions { imperfection_m, tolerance: 1e-13, ..ReferenceOptions::default() };
        let (pose, report) = solve_reference(
            &Setup::new(&sheet.of(&material), &clamps),
            &sheet.pose,
            &options,
            &Silent,
        )
        .unwrap();
        let bulge = pose.iter().map(|p| p.z.abs()).fold(0.0, f64::max);
        eprintln!(
            "{strain:.3e} of {critical:.3e}: bulge {bulge:.3e} m, {:.6e} J, {} iterations",
            report.energy_joule, report.iterations
        );
        assert!(
            matches!(report.ending, Ending::Converged | Ending::RoundOff),
            "{:?}",
            report.ending
        );
        (bulge, report.energy_joule)
    };
    assert!(press(0.98 * critical, 1e-3).0 < 1e-5);
    for load in [1.02, 1.2, 2.0] {
        // From a flat start, where nothing pushes it out, it leaves the saddle by itself.
        let (left, left_joule) = press(load * critical, 0.0);
        let (bulge, joule) = press(load * critical, 1e-3);
        assert!(
            (left / bulge - 1.0).abs() < 1e-3 && (left_joule / joule - 1.0).abs() < 1e-9,
            "{left} {bulge}, {left_joule} {joule}"
        );
        let flat_joule =
            0.5 * material.young_pa * material.thickness_m * 0.1 * (load * critical).powi(2);
        assert!(joule < flat_joule, "{joule} J is not below {flat_joule} J");
        // The discrete strip is softer by (π/columns)²/12, 0.14 %.
        let wanted = 2.0 / PI * ((load - 1.0) * critical).sqrt();
        let slack = if load < 1.1 { 0.05 } else { 0.02 };
        assert!((bulge / wanted - 1.0).abs() < slack, "load {load}: {bulge} m, not {wanted}");
    }
}

// ── Honest errors ────────────────────────────────────────────────────────────────────────────────

#[test]
fn what_has_no_equilibrium_is_refused() {
    let sheet = PosedSheet::lattice(1.0, 1.0, 4, 4);
    let material = Material::new(1e5, 0.3, 1e-3).unwrap();
    let free = Clamps::none(sheet.pose.len());
    let mut one_side = free.clone();
    for v in 0..5 {
        one_side.hold(v, sheet.pose[v]);
    }
    for solver in Solver::BOTH {
        let message = |loads: Loads, clamps: &Clamps| {
            let made = sheet.of(&material);
            let setup = Setup { loads, ..Setup::new(&made, clamps) };
            solver.solve(&setup, &sheet.pose).unwrap_err().to_string()
        };
        let falls = message(weight(200.0), &free);
        assert!(falls.starts_with("clamps: ") && falls.contains("along z"), "{falls}");
        let idle = message(Loads::default(), &free);
        assert!(idle.starts_with("clamps: ") && idle.contains("along x"), "{idle}");
        let open = message(Loads { pressure_pa: 10.0, ..Loads::default() }, &one_side);
        assert!(
            open.starts_with("pressure: ") && open.contains("between vertices 0 and 1"),
            "{open}"
        );
    }
}
