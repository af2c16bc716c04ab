//! Shells in contact: nothing gets in or through, what rests is borne, starts that intersect are
//! fixed or refused, and the solve does not depend on threads, axes or units.

mod sheets;

use std::sync::Mutex;

use nalgebra::Rotation3;
use plisse::Sheet;
use plisse::material::Material;
use plisse::mesh::Vec3;
use plisse::obstacle::Obstacle;
use plisse::progress::{Observer, Step};
use plisse::shell::{Clamps, Loads, Setup};

use sheets::{Equilibrium, PosedSheet, Solver, icosphere};

const GRAVITY: Vec3 = Vec3::new(0.0, 0.0, -9.81);
const THICKNESS_M: f64 = 0.01;

fn cloth() -> Material {
    Material::new(1e5, 0.3, 1e-3).unwrap()
}

fn weight() -> Loads {
    Loads { density_kg_m3: 200.0, gravity_m_s2: GRAVITY, ..Loads::default() }
}

/// Newtons that 1 m² of cloth weighs.
const WEIGHT_NEWTON: f64 = 200.0 * 1e-3 * 9.81;

/// A square of 1 m at this height, its middle over the origin; the vertex nearest to it is held in
/// x and y.
fn square(edge_length_m: f64, height_m: f64) -> (PosedSheet, Clamps) {
    let sheet = PosedSheet::rectangle(1.0, 1.0, edge_length_m, 5)
        .posed(|p| p + Vec3::new(-0.5, -0.5, height_m));
    let mut clamps = Clamps::none(sheet.pose.len());
    let apart = |v: usize| sheet.pose[v].xy().norm();
    let middle = (0..sheet.pose.len()).min_by(|&u, &v| apart(u).total_cmp(&apart(v))).unwrap();
    clamps.targets[middle] = [Some(sheet.pose[middle].x), Some(sheet.pose[middle].y), None];
    (sheet, clamps)
}

fn ball(radius_m: f64) -> Obstacle {
    Obstacle::sphere("ball", Vec3::zeros(), radius_m).unwrap()
}

/// A plate around the origin, from −`reach_m` to `reach_m` in x and 4 m wide in y, this thick, with
/// its upper side at z = 0.
fn plate(reach_m: f64, thickness_m: f64) -> Obstacle {
    let corner = |k: usize| {
        Vec3::new([-reach_m, reach_m][k & 1], [-2.0, 2.0][k >> 1 & 1], [-thickness_m, 0.0][k >> 2])
    };
    let corners: Vec<Vec3> = (0..8).map(corner).collect();
    let quads =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let faces: Vec<[usize; 3]> =
        quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Obstacle::mesh("plate", &corners, &faces).unwrap()
}

fn contact<'a>(sheet: &'a Sheet, clamps: &'a Clamps, obstacles: &'a [Obstacle]) -> Setup<'a> {
    Setup {
        loads: weight(),
        obstacles,
        contact_thickness_m: THICKNESS_M,
        ..Setup::new(sheet, clamps)
    }
}

/// Least distance (m) of a vertex from an obstacle.
fn clearance(pose: &[Vec3], obstacles: &[Obstacle]) -> f64 {
    pose.iter()
        .flat_map(|p| obstacles.iter().map(|o| o.distance_m(p)))
        .fold(f64::INFINITY, f64::min)
}

// ── Rest ─────────────────────────────────────────────────────────────────────────────────────────

#[test]
fn a_cloth_drapes_over_balls_and_floors() {
    let (positions, faces) = icosphere(2);
    let positions: Vec<Vec3> = positions.iter().map(|p| p * 0.2).collect();
    let floor = Obstacle::plane("floor", Vec3::new(0.0, 0.0, 0.1), Vec3::z()).unwrap();
    for obstacle in [ball(0.2), Obstacle::mesh("mesh ball", &positions, &faces).unwrap(), floor] {
        let obstacles = [obstacle];
        let (sheet, clamps) = square(0.1, 0.25);
        let material = cloth();
        let mut start = sheet.pose.clone();
        for solver in Solver::BOTH {
            let solved =
                solver.solve(&contact(&sheet.of(&material), &clamps, &obstacles), &start).unwrap();
            let clear = clearance(&solved.pose, &obstacles);
            let height = |pose: &[Vec3]| pose.iter().map(|p| p.z).sum::<f64>() / pose.len() as f64;
            eprintln!(
                "{solver:?} {}: {:?} after {}, {clear:.2e} m clear, {:.1e} N left",
                obstacles[0].name, solved.ending, solved.iterations, solved.gradient_newton
            );
            assert!(solved.settled(), "{:?}", solved.ending);
            assert!(clear > 0.0 && clear < THICKNESS_M, "{clear} m");
            // The forces on every vertex add up to nearly nothing, so the obstacle bears the
            // weight.
            assert!(
                solved.gradient_newton * (sheet.pose.len() as f64) < 1e-3 * WEIGHT_NEWTON,
                "{} N",
                solved.gradient_newton
            );
            assert!(height(&solved.pose) < 0.15 && solved.resolved_faces.is_empty());
            start = solved.pose;
        }
    }
}

/// On a floor that rises by 1 mm all energy gained is the weight's.
#[test]
fn a_floor_bears_the_weight() {
    let (sheet, clamps) = square(0.2, 0.03);
    let material = cloth();
    for solver in Solver::BOTH {
        let [low, high] = [0.0, 1e-3].map(|z| {
            let obstacles = [Obstacle::plane("floor", Vec3::new(0.0, 0.0, z), Vec3::z()).unwrap()];
            solver.solve(&contact(&sheet.of(&material), &clamps, &obstacles), &sheet.pose).unwrap()
        });
        let force = (high.energy_joule - low.energy_joule) / 1e-3;
        let (least, most) =
            low.pose.iter().fold((f64::INFINITY, 0.0_f64), |(l, m), p| (l.min(p.z), m.max(p.z)));
        eprintln!(
            "{solver:?}: {:.1e} of the weight off, {least:.3e} to {most:.3e} m high",
            force / WEIGHT_NEWTON - 1.0
        );
        assert!((force / WEIGHT_NEWTON - 1.0).abs() < 1e-6, "{force} N");
        assert!(
            most - least < 1e-6 && least > 0.3 * THICKNESS_M && most < THICKNESS_M,
            "{least} {most}"
        );
    }
}

// ── Starts ───────────────────────────────────────────────────────────────────────────────────────

#[test]
fn a_start_that_intersects_is_fixed_or_refused() {
    let material = cloth();
    let obstacles = [ball(0.3)];
    for solver in Solver::BOTH {
        // 1 cm inside.
        let (sheet, clamps) = square(0.1, 0.29);
        let solved =
            solver.solve(&contact(&sheet.of(&material), &clamps, &obstacles), &sheet.pose).unwrap();
        let inside: Vec<bool> = sheet.pose.iter().map(|p| p.norm() < 0.3).collect();
        let faces: Vec<usize> = (0..sheet.topology.face_count())
            .filter(|&f| sheet.topology.faces[f].iter().any(|&v| inside[v]))
            .collect();
        assert!(faces.len() > 2);
        assert_eq!(solved.resolved_faces, faces);
        assert!(solved.settled() && clearance(&solved.pose, &obstacles) > 0.0);
        // Through the middle.
        let (sheet, clamps) = square(0.1, 0.0);
        let error = solver
            .solve(&contact(&sheet.of(&material), &clamps, &obstacles), &sheet.pose)
            .unwrap_err()
            .to_string();
        assert!(
            error.contains("inside obstacle \"ball\"")
                && error.contains("faces ")
                && error.contains("too deep"),
            "{error}"
        );
        // A held vertex inside.
        let (sheet, mut clamps) = square(0.1, 0.31);
        let middle = clamps.held().iter().position(|&held| held).unwrap();
        clamps.hold(middle, Vec3::new(0.0, 0.0, 0.28));
        let error = solver
            .solve(&contact(&sheet.of(&material), &clamps, &obstacles), &sheet.pose)
            .unwrap_err()
            .to_string();
        let named = sheet.topology.faces.iter().position(|f| f.contains(&middle)).unwrap();
        assert!(error.contains("\"ball\"") && error.contains("held there by a clamp"), "{error}");
        assert!(
            error.contains(&format!("faces {named}, "))
                && error.contains(&format!("vertex {middle},")),
            "{error}"
        );
    }
}

#[test]
fn obstacles_larger_than_the_sheet_are_no_trouble() {
    let material = cloth();
    let obstacles = [Obstacle::sphere("globe", Vec3::new(0.0, 0.0, -100.0), 100.0).unwrap()];
    for solver in Solver::BOTH {
        let (sheet, clamps) = square(0.2, 0.05);
        let solved =
            solver.solve(&contact(&sheet.of(&material), &clamps, &obstacles), &sheet.pose).unwrap();
        eprintln!("{solver:?}: {:?} after {}", solved.ending, solved.iterations);
        assert!(solved.settled() && clearance(&solved.pose, &obstacles) > 0.0);
        let (sheet, clamps) = square(0.2, -50.0);
        let error = solver
            .solve(&contact(&sheet.of(&material), &clamps, &obstacles), &sheet.pose)
            .unwrap_err()
            .to_string();
        assert!(error.contains("globe") && error.contains("too deep"), "{error}");
    }
}

/// A film falls on a plate that is far thinner than a step is long.
#[test]
fn a_film_stays_on_its_side_of_a_thin_plate() {
    let film = Material::new(1e6, 0.3, 1e-5).unwrap();
    let obstacles = [plate(2.0, 1e-4)];
    for solver in Solver::BOTH {
        let (sheet, clamps) = square(0.2, 0.4);
        let thin = sheet.of(&film);
        let setup = Setup { contact_thickness_m: 1e-3, ..contact(&thin, &clamps, &obstacles) };
        let solved = solver.solve(&setup, &sheet.pose).unwrap();
        eprintln!("{solver:?}: {:?} after {}", solved.ending, solved.iterations);
        assert!(solved.settled() && solved.pose.iter().all(|p| p.z > 0.0 && p.z < 1e-3));
    }
}

/// A clamp that takes one side of a cloth through a plate is refused. Where both sides go down past
/// a narrower plate, what is over the plate stays there, though the straight way of the whole cloth
/// leads through.
#[test]
fn no_clamp_drags_a_cloth_through_a_plate() {
    let material = cloth();
    for solver in Solver::BOTH {
        let (sheet, mut clamps) = square(0.1, 0.1);
        for (v, p) in sheet.pose.iter().enumerate().filter(|(_, p)| p.x.abs() > 0.49) {
            clamps.hold(v, p - Vec3::z() * 0.3);
        }
        let obstacles = [plate(2.0, 1e-3)];
        let error = solver
            .solve(&contact(&sheet.of(&material), &clamps, &obstacles), &sheet.pose)
            .unwrap_err()
            .to_string();
        assert!(error.contains("\"plate\"") && error.contains("clamp takes vertex 0 "), "{error}");
        let obstacles = [plate(0.25, 1e-3)];
        let solved =
            solver.solve(&contact(&sheet.of(&material), &clamps, &obstacles), &sheet.pose).unwrap();
        let clear = clearance(&solved.pose, &obstacles);
        eprintln!(
            "{solver:?}: {:?} after {}, {clear:.1e} m clear",
            solved.ending, solved.iterations
        );
        assert!(solved.settled() && clear > 0.0 && clear < THICKNESS_M);
        // Vertices near the plate's rim may go around it; those in the middle can only have got
        // below through it.
        assert!(sheet.pose.iter().zip(&solved.pose).all(|(p, q)| p.x.abs() > 0.15 || q.z > 0.0));
    }
}

#[test]
fn a_cloth_beside_every_obstacle_falls_and_is_refused() {
    let material = cloth();
    let obstacles = [Obstacle::sphere("aside", Vec3::new(5.0, 0.0, 0.0), 1.0).unwrap()];
    for solver in Solver::BOTH {
        let (sheet, clamps) = square(0.3, 0.0);
        let error = solver
            .solve(&contact(&sheet.of(&material), &clamps, &obstacles), &sheet.pose)
            .unwrap_err()
            .to_string();
        assert!(error.contains("falls for ever"), "{error}");
    }
}

// ── Invariance ───────────────────────────────────────────────────────────────────────────────────

/// A strip held at both ends that sinks onto a ball, or a closed ball under pressure between two
/// walls.
fn cases(
    scale: f64,
    motion: impl Fn(Vec3) -> Vec3,
) -> [(PosedSheet, Clamps, Loads, Vec<Obstacle>); 2] {
    let turned = |direction: Vec3| motion(direction) - motion(Vec3::zeros());
    let place = |p: Vec3| motion(p * scale);
    let mut strip = PosedSheet::lattice(scale, 0.25 * scale, 16, 4);
    let mut held = Clamps::none(strip.pose.len());
    for v in 0..strip.pose.len() {
        strip.pose[v] = motion(strip.pose[v]);
        if v % 17 < 2 || v % 17 > 14 {
            held.hold(v, strip.pose[v]);
        }
    }
    let below =
        Obstacle::sphere("below", place(Vec3::new(0.6, 0.125, -0.25)), 0.2 * scale).unwrap();
    // Gravity falls as lengths grow, so that strains stay.
    let loads =
        Loads { density_kg_m3: 200.0, gravity_m_s2: turned(GRAVITY) / scale, ..Loads::default() };
    let closed = PosedSheet::ball(0.5 * scale, 2).posed(&motion);
    let wall = |name: &str, x: f64| {
        Obstacle::plane(name, place(Vec3::new(x, 0.0, 0.0)), turned(Vec3::x()) * -x).unwrap()
    };
    let walls = vec![wall("left", -0.52), wall("right", 0.52)];
    let free = Clamps::none(closed.pose.len());
    let pressure = Loads { pressure_pa: 80.0, ..Loads::default() };
    [(strip, held, loads, vec![below]), (closed, free, pressure, walls)]
}

fn solve_case(
    solver: Solver,
    scale: f64,
    case: &(PosedSheet, Clamps, Loads, Vec<Obstacle>),
    observer: &dyn Observer,
) -> Equilibrium {
    let (sheet, clamps, loads, obstacles) = case;
    let material = Material::new(1e5, 0.3, 1e-3 * scale).unwrap();
    let stiff = sheet.of(&material);
    let setup = Setup {
        loads: loads.clone(),
        obstacles,
        contact_thickness_m: THICKNESS_M * scale,
        ..Setup::new(&stiff, clamps)
    };
    solver.observed(&setup, &sheet.pose, observer).unwrap()
}

/// Remembers energies.
#[derive(Default)]
struct Energies(Mutex<Vec<f64>>);

impl Observer for Energies {
    fn step(&self, step: &Step) {
        self.0.lock().unwrap().push(step.energy_joule);
    }
}

#[test]
fn energy_never_rises_and_threads_change_no_bit() {
    for case in cases(1.0, |p| p) {
        for solver in Solver::BOTH {
            let with = |threads: usize| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let energies = Energies::default();
                let solved = pool.install(|| solve_case(solver, 1.0, &case, &energies));
                (solved, energies.0.into_inner().unwrap())
            };
            let ((one, energies), (two, _)) = (with(1), with(2));
            eprintln!(
                "{solver:?} {}: {:?} after {}, {:e} J",
                case.3[0].name, one.ending, one.iterations, one.energy_joule
            );
            assert!(
                one.settled()
                    && clearance(&one.pose, &case.3) > 0.0
                    && clearance(&one.pose, &case.3) < THICKNESS_M
            );
            assert!(
                energies.len() > 2
                    && energies.windows(2).all(|e| e[1] <= e[0] + 1e-12 * e[0].abs()),
                "{energies:?}"
            );
            assert_eq!(energies[energies.len() - 1].to_bits(), one.energy_joule.to_bits());
            assert_eq!(one.bits(), two.bits());
            assert_eq!(one.energy_joule.to_bits(), two.energy_joule.to_bits());
        }
    }
}

#[test]
fn rigid_motions_move_the_result_along() {
    let turn = Rotation3::from_euler_angles(0.3, 1.1, -0.6);
    let motion = |p: Vec3| turn * p + Vec3::new(4.0, -3.0, 2.0);
    let strips = [cases(1.0, |p| p), cases(1.0, motion)].map(|[strip, _]| strip);
    for solver in Solver::BOTH {
        let [here, there] =
            [0, 1].map(|k| solve_case(solver, 1.0, &strips[k], &Energies::default()));
        let worst = here
            .pose
            .iter()
            .zip(&there.pose)
            .map(|(p, q)| (motion(*p) - q).norm())
            .fold(0.0, f64::max);
        eprintln!(
            "{solver:?}: {worst:.1e} m off, energy {:.1e} off",
            there.energy_joule / here.energy_joule - 1.0
        );
        assert!(worst < 1e-6, "{worst:e} m");
        assert!((there.energy_joule / here.energy_joule - 1.0).abs() < 1e-9);
    }
}

/// Powers of two, and their roots of powers of four, only move the exponents of numbers, so that a
/// sheet four times as large comes out four times as large bit for bit: no constant of the solve
/// has a unit.
#[test]
fn a_sheet_four_times_as_large_comes_out_four_times_as_large() {
    let (here, there) = (cases(1.0, |p| p), cases(4.0, |p| p));
    for (small, large) in here.iter().zip(&there) {
        for solver in Solver::BOTH {
            let [small, mut large] = [(1.0, small), (4.0, large)]
                .map(|(scale, case)| solve_case(solver, scale, case, &Energies::default()));
            large.pose.iter_mut().for_each(|p| *p /= 4.0);
            assert_eq!((small.iterations, small.bits()), (large.iterations, large.bits()));
        }
    }
}
