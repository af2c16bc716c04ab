//! Properties of any right base solve: known states of a pulled and of a slack sheet, invariance,
//! and honest reports.

mod sheets;

use std::sync::Mutex;

use nalgebra::Rotation3;
use plisse::linalg::Ending;
use plisse::material::Material;
use plisse::mesh::Vec3;
use plisse::progress::{Observer, Silent, Step};
use plisse::shell::base::defects;
use plisse::shell::{BaseOptions, BaseReport, Clamps, Setup, solve_base};

use sheets::{PosedSheet, Random, mylar, twisted_cylinder};

fn material() -> Material {
    Material::new(1e6, 0.3, 1e-3).unwrap()
}

fn base(sheet: &PosedSheet, clamps: &Clamps, options: &BaseOptions) -> (Vec<Vec3>, BaseReport) {
    solve_base(&Setup::new(&sheet.of(&material()), clamps), &sheet.pose, options, &Silent).unwrap()
}

/// Areas of the pose's faces relative to rest.
fn area_ratios(sheet: &PosedSheet, pose: &[Vec3]) -> Vec<f64> {
    let area = |f: &[usize; 3]| {
        let [a, b, c] = f.map(|v| pose[v]);
        0.5 * (b - a).cross(&(c - a)).norm()
    };
    sheet
        .topology
        .faces
        .iter()
        .zip(&sheet.rest.faces)
        .map(|(f, rest)| area(f) / rest.area_m2)
        .collect()
}

// ── Pulled ───────────────────────────────────────────────────────────────────────────────────────

/// A strip of 1 × 0.4 m that is pulled along x to `1 + pull`, its ends free to narrow.
fn pulled_strip(pull: f64) -> (PosedSheet, Clamps) {
    let sheet = PosedSheet::rectangle(1.0, 0.4, 0.08, 2);
    let mut clamps = Clamps::none(sheet.pose.len());
    for (target, p) in clamps.targets.iter_mut().zip(&sheet.pose) {
        if p.x < 1e-9 || p.x > 1.0 - 1e-9 {
            target[0] = Some(p.x * (1.0 + pull));
            target[2] = Some(0.0);
        }
        if p.x < 1e-9 && p.y < 1e-9 {
            target[1] = Some(0.0);
        }
    }
    (sheet, clamps)
}

/// Uniaxial stress: λ₂ = −νλ₁, and Y/2·λ₁² per area, times h/4. Of St. Venant–Kirchhoff's energy
/// α/2·(λ₁+λ₂)² + β(λ₁²+λ₂²), the λ₂ of least energy is −α/(α+2β)·λ₁ = −νλ₁.
#[test]
fn a_pulled_strip_narrows_by_poissons_ratio() {
    for pull in [0.01, 0.1, 0.3] {
        let (sheet, clamps) = pulled_strip(pull);
        let (pose, report) = base(&sheet, &clamps, &BaseOptions::default());
        assert!(
            matches!(report.ending, Ending::Converged | Ending::RoundOff),
            "{:?}",
            report.ending
        );
        let m = material();
        let lambda = (1.0 + pull) * (1.0 + pull) - 1.0;
        let narrow = (1.0 - m.poisson * lambda).sqrt();
        let mut worst = 0.0_f64;
        for (p, q) in sheet.pose.iter().zip(&pose) {
            worst = worst.max((q - Vec3::new(p.x * (1.0 + pull), p.y * narrow, 0.0)).norm());
        }
        let energy =
            m.young_pa / 2.0 * m.thickness_m / 4.0 * lambda * lambda * sheet.rest.area_m2();
        eprintln!(
            "pull {pull}: {worst:.1e} m off, energy {:.1e} off, {} iterations",
            report.energy_joule / energy - 1.0,
            report.iterations
        );
        assert!(worst < 1e-6, "pulled by {pull}: a vertex is {worst:e} m off");
        assert!(
            (report.energy_joule / energy - 1.0).abs() < 1e-8,
            "pulled by {pull}: {} J, not {energy}",
            report.energy_joule
        );
        assert_eq!(report.states[0], 0, "no face is slack");
        assert!(report.collapsed_faces.is_empty() && report.inverted_faces.is_empty());
    }
}

/// Both ways pulled, the pose is affine and the energy St. Venant–Kirchhoff's.
#[test]
fn a_sheet_pulled_both_ways_is_taut() {
    let mut sheet = PosedSheet::rectangle(1.0, 0.7, 0.1, 4);
    let mut clamps = Clamps::none(sheet.pose.len());
    let target = |p: &Vec3| Vec3::new(1.04 * p.x, 1.07 * p.y, 0.0);
    for (v, on_rim) in sheet.topology.boundary_vertices().into_iter().enumerate() {
        if on_rim {
            clamps.hold(v, target(&sheet.pose[v]));
        }
    }
    let wanted: Vec<Vec3> = sheet.pose.iter().map(target).collect();
    // Even from a start that is out of shape, out of the plane too.
    let mut random = Random(2);
    sheet = sheet.posed(|p| p);
    for p in &mut sheet.pose {
        *p += Vec3::new(random.signed(), random.signed(), random.signed()) * 0.03;
    }
    let (pose, report) = base(&sheet, &clamps, &BaseOptions::default());
    assert_eq!(report.states, [0, 0, sheet.topology.face_count()]);
    for (p, q) in pose.iter().zip(&wanted) {
        assert!((p - q).norm() < 1e-8, "{p:?} {q:?}");
    }
    let strain = plisse::mesh::Mat2::new(1.04 * 1.04 - 1.0, 0.0, 0.0, 1.07 * 1.07 - 1.0);
    let energy =
        material().thickness_m / 4.0 * material().norm_squared(&strain) * sheet.rest.area_m2();
    assert!((report.energy_joule / energy - 1.0).abs() < 1e-9);
}

// ── Slack ────────────────────────────────────────────────────────────────────────────────────────

/// A strip of 1 × 0.4 m whose ends, held in x and z, come 5 % nearer to each other.
fn slack_strip() -> (PosedSheet, Clamps) {
    pulled_strip(-0.05)
}

/// Tension field theory has no energy for a slack sheet.
///
/// With a share s of compressive stiffness, the sheet gets broader, by λ₂ = u, until (1−s)·Y/2·u² +
/// s·(α/2·(λ+u)² + β(λ²+u²)) is least: at u = −sαλ/((1−s)Y + s(α+2β)). For s = 1, the full shell,
/// that is u = −νλ (it would buckle, but nothing pushes it from the plane).
#[test]
fn a_slack_sheet_has_no_energy_unless_it_resists_compression() {
    let (sheet, clamps) = slack_strip();
    let lambda: f64 = 0.95 * 0.95 - 1.0;
    let (m, volume) = (material(), material().thickness_m / 4.0 * sheet.rest.area_m2());
    let full = |u: f64| volume * m.norm_squared(&plisse::mesh::Mat2::new(lambda, 0.0, 0.0, u));
    let (_, slack) = base(&sheet, &clamps, &BaseOptions::default());
    assert!(
        slack.energy_joule.abs() < 1e-6 * full(0.0),
        "{:e} of {:e} J",
        slack.energy_joule,
        full(0.0)
    );
    for s in [0.01, 0.3, 1.0] {
        let u =
            -s * m.alpha() * lambda / ((1.0 - s) * m.young_pa + s * (m.alpha() + 2.0 * m.beta()));
        let energy = (1.0 - s) * volume * m.young_pa / 2.0 * u * u + s * full(u);
        let (pose, report) = base(
            &sheet,
            &clamps,
            &BaseOptions { compressive_stiffness: s, ..BaseOptions::default() },
        );
        eprintln!(
            "share {s}: energy {:.1e} off, {} iterations",
            report.energy_joule / energy - 1.0,
            report.iterations
        );
        assert!(
            (report.energy_joule / energy - 1.0).abs() < 1e-8,
            "share {s}: {} J, not {energy}",
            report.energy_joule
        );
        let wanted = |p: &Vec3| Vec3::new(0.95 * p.x, (1.0 + u).sqrt() * p.y, 0.0);
        assert!(
            sheet.pose.iter().zip(&pose).all(|(p, q)| (q - wanted(p)).norm() < 1e-6),
            "share {s}"
        );
    }
}

/// From a crumpled start, tension field theory leaves a slack sheet crumpled where the sheet is so
/// thin that bending is lost in the tolerance (bending smooths in-plane too, since it is quadratic
/// in all coordinates); a little compressive stiffness evens it out.
#[test]
fn compressive_stiffness_evens_out_a_slack_sheet() {
    let (mut sheet, clamps) = slack_strip();
    let mut random = Random(12);
    for p in &mut sheet.pose {
        *p += Vec3::new(random.signed(), random.signed(), 0.0) * 0.035;
    }
    let uneven = |share: f64| {
        let options = BaseOptions { compressive_stiffness: share, ..BaseOptions::default() };
        let thin = Material { thickness_m: 1e-7, ..material() };
        let (pose, report) =
            solve_base(&Setup::new(&sheet.of(&thin), &clamps), &sheet.pose, &options, &Silent)
                .unwrap();
        let ratios = area_ratios(&sheet, &pose);
        let (low, high) =
            ratios.iter().fold((f64::INFINITY, 0.0_f64), |(l, h), &r| (l.min(r), h.max(r)));
        eprintln!(
            "share {share}: areas {low:.3} to {high:.3}, {} collapsed, {} inverted, {:?} after {}",
            report.collapsed_faces.len(),
            report.inverted_faces.len(),
            report.ending,
            report.iterations
        );
        (high - low, report.collapsed_faces.len() + report.inverted_faces.len())
    };
    let (none, little) = (uneven(0.0), uneven(1e-2));
    assert!(
        little.0 < 0.5 * none.0,
        "areas vary by {} without and {} with stiffness",
        none.0,
        little.0
    );
    assert_eq!(little.1, 0, "no face is collapsed or inverted");
}

// ── Invariance and honesty ───────────────────────────────────────────────────────────────────────

#[test]
fn rigid_motions_move_the_result_along() {
    let (sheet, clamps) = twisted_cylinder(0.45);
    let solve = |sheet: &PosedSheet, clamps: &Clamps| {
        solve_base(
            &Setup::new(&sheet.of(&mylar()), clamps),
            &sheet.pose,
            &BaseOptions::default(),
            &Silent,
        )
        .unwrap()
    };
    let (pose, report) = solve(&sheet, &clamps);
    let turn = Rotation3::from_euler_angles(0.3, 1.1, -0.6);
    let motion = |p: Vec3| turn * p + Vec3::new(4.0, -3.0, 2.0);
    let mut moved_clamps = Clamps::none(pose.len());
    for v in 0..pose.len() {
        if let [Some(x), Some(y), Some(z)] = clamps.targets[v] {
            moved_clamps.hold(v, motion(Vec3::new(x, y, z)));
        }
    }
    let (moved, moved_report) = solve(&sheet.clone().posed(motion), &moved_clamps);
    let worst = pose.iter().zip(&moved).map(|(p, q)| (motion(*p) - q).norm()).fold(0.0, f64::max);
    eprintln!(
        "{worst:.1e} m off, energy {:.1e} off",
        moved_report.energy_joule / report.energy_joule - 1.0
    );
    assert!(worst < 1e-6, "{worst:e} m");
    assert!((moved_report.energy_joule / report.energy_joule - 1.0).abs() < 1e-9);
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let (sheet, clamps) = twisted_cylinder(0.3);
    assert!(sheet.topology.face_count() > 256);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let options = BaseOptions::default();
        pool.install(|| {
            solve_base(&Setup::new(&sheet.of(&mylar()), &clamps), &sheet.pose, &options, &Silent)
                .unwrap()
        })
    };
    let bits = |pose: &[Vec3]| -> Vec<u64> {
        pose.iter().flat_map(|p| p.iter().map(|x| x.to_bits())).collect()
    };
    let (one, two) = (with(1), with(2));
    assert_eq!(bits(&one.0), bits(&two.0));
    assert_eq!(one.1.energy_joule.to_bits(), two.1.energy_joule.to_bits());
}

/// Remembers energies.
struct Energies(Mutex<Vec<f64>>);

impl Observer for Energies {
    fn step(&self, step: &Step) {
        assert_eq!(step.stage, "base");
        self.0.lock().unwrap().push(step.energy_joule);
    }
}

#[test]
fn energy_never_rises() {
    let (sheet, clamps) = twisted_cylinder(0.45);
    let energies = Energies(Mutex::new(Vec::new()));
    let options = BaseOptions::default();
    let (_, report) =
        solve_base(&Setup::new(&sheet.of(&mylar()), &clamps), &sheet.pose, &options, &energies)
            .unwrap();
    let energies = energies.0.into_inner().unwrap();
    assert!(
        energies.len() > 2 && energies.windows(2).all(|p| p[1] <= p[0] * (1.0 + 1e-12)),
        "{energies:?}"
    );
    assert_eq!(energies[energies.len() - 1].to_bits(), report.energy_joule.to_bits());
}

#[test]
fn clamped_coordinates_are_met_exactly() {
    let (sheet, clamps) = pulled_strip(0.1);
    let (pose, _) = base(&sheet, &clamps, &BaseOptions::default());
    for (target, p) in clamps.targets.iter().zip(&pose) {
        for axis in 0..3 {
            assert!(target[axis].is_none_or(|t| t == p[axis]));
        }
    }
}

/// 4 × 4 squares of 1 m, cut in two; vertex (2, 2) is number 12.
fn squares() -> PosedSheet {
    let at = |i: usize, j: usize| 5 * j + i;
    let mut faces = Vec::new();
    for j in 0..4 {
        for i in 0..4 {
            faces.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
            faces.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
    let positions: Vec<Vec3> =
        (0..25).map(|v| Vec3::new((v % 5) as f64, (v / 5) as f64, 0.0)).collect();
    PosedSheet::at_rest(positions, faces)
}

#[test]
fn defects_are_found_where_they_were_made() {
    let mut sheet = squares();
    assert_eq!(defects(&sheet.topology, &sheet.rest, &sheet.pose), (vec![], vec![]));
    // Vertex 12 on the edge from 6 to 7 (between (1, 1) and (2, 1)): the face of these three has no
    // area.
    sheet.pose[12] = Vec3::new(1.5, 1.0, 0.0);
    let (collapsed, inverted) = defects(&sheet.topology, &sheet.rest, &sheet.pose);
    let of = |corners: [usize; 3]| {
        let all = |f: &[usize; 3]| corners.iter().all(|v| f.contains(v));
        sheet.topology.faces.iter().position(all).unwrap()
    };
    assert_eq!((collapsed, inverted), (vec![of([6, 7, 12])], vec![]));
    // Beyond it, that face alone turns over.
    let target = of([6, 7, 12]);
    sheet.pose[12] = Vec3::new(1.6, 0.8, 0.0);
    let (collapsed, inverted) = defects(&sheet.topology, &sheet.rest, &sheet.pose);
    assert!(
        collapsed.is_empty() && inverted.contains(&target),
        "{collapsed:?} {inverted:?}, not {target}"
    );
    eprintln!("inverted {inverted:?}");
}

#[test]
fn what_nothing_holds_is_named() {
    let sheet = squares();
    let message = |clamps: &Clamps| {
        let options = BaseOptions::default();
        let result =
            solve_base(&Setup::new(&sheet.of(&material()), clamps), &sheet.pose, &options, &Silent);
        result.unwrap_err().to_string()
    };
    let mut clamps = Clamps::none(25);
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        let text = message(&clamps);
        assert!(text.starts_with("clamps: ") && text.contains(&format!("along {name};")), "{text}");
        clamps.targets[0][axis] = Some(0.0);
    }
    let options = BaseOptions::default();
    assert!(
        solve_base(&Setup::new(&sheet.of(&material()), &clamps), &sheet.pose, &options, &Silent)
            .is_ok()
    );
}
