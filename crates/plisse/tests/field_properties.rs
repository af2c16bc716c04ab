//! Properties of any right field solve, whatever the mesh: closed forms of simple states,
//! invariances, a field that is whole, and a solve that goes downhill, is the same for any number
//! of threads and can be stopped.

mod sheets;

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use nalgebra::Rotation3;
use plisse::RestShape;
use plisse::field::{FieldOptions, Solved, WrinkleField, WrinkleFreeRule, solve};
use plisse::linalg::Ending;
use plisse::material::Material;
use plisse::mesh::panel::Outline;
use plisse::mesh::{Topology, Vec3};
use plisse::progress::{Observer, Silent, Step};
use plisse::strain::strain;

use sheets::{PosedSheet, Random, mylar, permutation, twisted_cylinder_at_rest, twisted_ring};

/// Mean and root-mean-square deviation of `values`.
fn mean_and_spread(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    (mean, (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n).sqrt())
}

/// Mean of a² on face `f` (m²), with the solve's quadrature.
fn mean_square_amplitude(topology: &Topology, field: &WrinkleField, f: usize) -> f64 {
    let [a, b, c] = topology.faces[f].map(|v| field.amplitude_m[v]);
    (a * a + b * b + c * c + a * b + b * c + c * a) / 6.0
}

/// Largest |a − b| relative to the largest |a|.
fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let size = a.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    a.iter().zip(b).fold(0.0_f64, |m, (x, y)| m.max((x - y).abs())) / size
}

fn turns(solved: &Solved) -> Vec<i64> {
    solved.report.periods.iter().map(|p| p.turns).collect()
}

// ── Closed forms ─────────────────────────────────────────────────────────────────────────────────

/// ω of face `f` as a vector (rad/m) in the plane of a flat rest shape: its face frame's first
/// vector runs along edge 0→1.
fn frequency_in_rest_plane(sheet: &PosedSheet, field: &WrinkleField, f: usize) -> Vec3 {
    let [a, b, _] = sheet.rest_shape.faces[f].map(|r| sheet.rest_shape.positions[r]);
    let x = (b - a).normalize();
    let y = Vec3::z().cross(&x);
    let w = field.frequency(sheet, f);
    x * w.x + y * w.y
}

/// Faces of a unit square whose middle is at least `margin_m` from the edges.
fn inner_faces(sheet: &PosedSheet, margin_m: f64) -> Vec<usize> {
    let inside = |x: f64| x > margin_m && x < 1.0 - margin_m;
    (0..sheet.topology.face_count())
        .filter(|&f| inside(sheet.middle(f).x) && inside(sheet.middle(f).y))
        .collect()
}

/// A flat square sheet of 1 m, 2 % short along x, with zero amplitude where crests end. (Were no
/// vertex held, energy would fall without end towards infinitely long waves: bending is the only
/// resistance then.)
fn shortened_sheet() -> (PosedSheet, f64) {
    let short = 0.02;
    let mut sheet = PosedSheet::rectangle(1.0, 1.0, 0.06, 3)
        .posed(|p| Vec3::new((1.0 - short) * p.x, p.y, 0.0));
    for v in 0..sheet.pose.len() {
        sheet.held[v] = sheet.pose[v].y < 1e-9 || sheet.pose[v].y > 1.0 - 1e-9;
    }
    // ε = −λ with λ = (1 − s)² − 1, eq. 8.
    (sheet, 1.0 - (1.0 - short) * (1.0 - short))
}

/// Eq. 8, face by face: ½a²|ω|² = ε in the middle of a thin sheet.
///
/// With bending it is a little less. For da = 0 and ω along the compression, only r = ½a²ω² − ε is
/// left of the strain: eqs. 21 and 26 give the density h/4·γ·r² + h³/24·γ·a²ω⁴, γ = α/2 + β. Its
/// derivative in a² is zero where h/4·γ·2r·½ω² + h³/24·γ·ω⁴ = 0, that is r = −h²ω²/6. So ½a²ω²/ε =
/// 1 − h²ω²/(6ε): 2 % off at h = 3 mm, 2e-4 at 0.1 mm. This fails if stretching or bending has a
/// wrong factor (a factor 2 in bending moves the first by 0.02, of which 0.002 are allowed).
#[test]
fn a_shortened_sheet_takes_up_its_strain() {
    let (sheet, epsilon) = shortened_sheet();
    let mut last_off = f64::INFINITY;
    for (thickness_m, allowed) in [(3e-3, 0.03), (6e-4, 0.02), (1e-4, 0.01)] {
        let solved =
            sheet.solve(&Material::new(1e7, 0.3, thickness_m).unwrap(), &FieldOptions::default());
        assert_eq!(solved.report.ending, Ending::Converged);
        let (mut ratios, mut from_bending) = (Vec::new(), Vec::new());
        for f in inner_faces(&sheet, 0.2) {
            let w = frequency_in_rest_plane(&sheet, &solved.field, f);
            assert!((w.y / w.x).abs() < 0.03, "face {f}: crests are not along y, {w:?}");
            let ratio =
                0.5 * mean_square_amplitude(&sheet.topology, &solved.field, f) * w.norm_squared()
                    / epsilon;
            assert!(
                (ratio - 1.0).abs() < allowed,
                "face {f}, h = {thickness_m}: ½a²|ω|² is {ratio} of ε"
            );
            from_bending.push(ratio - 1.0 + (thickness_m * w.norm()).powi(2) / (6.0 * epsilon));
            ratios.push(ratio);
        }
        assert!(ratios.len() > 100);
        let ((mean, spread), (off, _)) = (mean_and_spread(&ratios), mean_and_spread(&from_bending));
        eprintln!(
            "h = {thickness_m}: ½a²|ω|²/ε is {mean} ± {spread:.1e}, {off:.1e} from 1 − h²ω²/6ε"
        );
        assert!(off.abs() < 2e-3, "h = {thickness_m}: {off}");
        assert!(
            (mean - 1.0).abs() < 0.3 * last_off,
            "h = {thickness_m}: mean {mean}, no nearer than {last_off}"
        );
        last_off = (mean - 1.0).abs();
    }
    assert!(last_off < 5e-4, "{last_off}");
}

/// Mean of |ω| over the middle of a square sheet of 1 m, bent along y to radius `radius_m`, pulled
/// 0.2 % along y and 2 % short along x, relative to the closed form.
///
/// Crests run along y, over the curvature κ = 1/R. With constant a and ω, the density is k₀ +
/// a²(pω² + k₄ + k₅ω⁴) + k₇a⁴ω⁴ with k₄ = h/4·4β(α+β)/(α+2β)·κ²q² (eq. 22) and k₅ = h³/24·(α/2+β)
/// (eq. 26). Zero derivatives in a² and in ω are pω² + k₄ + k₅ω⁴ + 2k₇a²ω⁴ = 0 and p + 2k₅ω² +
/// 2k₇a²ω² = 0 (once divided by 2a²ω). ω² times the second from the first leaves k₄ = k₅ω⁴,
/// whatever the membrane does: curvature and bending hold equal energies. Since 4β(α+β)/(α+2β) = Y
/// and α + 2β = Y/(1−ν²), ω⁴ = 12(1−ν²)·(κq/h)². κ is that of the pose, and q = (1 + 0.002)² refers
/// it to rest lengths.
fn frequency_over_curvature(edge_length_m: f64, radius_m: f64, thickness_m: f64) -> f64 {
    let (short, pull, poisson) = (0.02, 0.002, 0.3);
    let sheet = PosedSheet::rectangle(1.0, 1.0, edge_length_m, 5).posed(|p| {
        let angle = (1.0 + pull) * (p.y - 0.5) / radius_m;
        Vec3::new((1.0 - short) * p.x, radius_m * angle.sin(), radius_m * angle.cos())
    });
    // Chords are shorter than arcs; the pull must make up for that, or eq. 22 takes no part.
    assert!(strain(&sheet.topology, &sheet.rest, &sheet.pose).iter().all(|s| s.is_mixed()));
    let material = Material::new(1e7, poisson, thickness_m).unwrap();
    let solved =
        sheet.solve(&material, &FieldOptions { curvature_rings: 2, ..FieldOptions::default() });
    assert_eq!(solved.report.ending, Ending::Converged);
    let q = (1.0_f64 + pull).powi(2);
    let wanted =
        (12.0 * (1.0 - poisson * poisson)).powf(0.25) * (q / (radius_m * thickness_m)).sqrt();
    let ratios: Vec<f64> = inner_faces(&sheet, 0.25)
        .into_iter()
        .map(|f| {
            let w = frequency_in_rest_plane(&sheet, &solved.field, f);
            assert!((w.y / w.x).abs() < 0.02, "face {f}: crests are not along y, {w:?}");
            w.norm() / wanted
        })
        .collect();
    let (mean, spread) = mean_and_spread(&ratios);
    eprintln!(
        "edge {edge_length_m}, R {radius_m}, h {thickness_m}: ω is {mean:.6} ± {spread:.1e} of the \
         closed form"
    );
    assert!(spread < 5e-3, "ω varies by {spread} over the middle");
    mean
}

/// The tolerance of 0.5 % notices a factor of 1.02 in eq. 22 or 26; that both thickness and radius
/// vary notices a wrong power.
#[test]
fn crests_over_curvature_have_the_frequency_that_balances_bending() {
    for (radius_m, thickness_m) in [(1.0, 1e-3), (1.0, 1e-4), (1.0, 1e-5), (2.0, 1e-4), (0.5, 1e-4)]
    {
        let ratio = frequency_over_curvature(0.05, radius_m, thickness_m);
        assert!((ratio - 1.0).abs() < 5e-3, "R = {radius_m}, h = {thickness_m}: {ratio}");
    }
    // What is left is the mesh's: it goes with the square of the edge length (1/2.8 here).
    let [coarse, fine] = [0.05, 0.03].map(|edge| frequency_over_curvature(edge, 1.0, 1e-4) - 1.0);
    assert!(fine.abs() < 0.5 * coarse.abs(), "{coarse} {fine}");
}

// ── Invariance ───────────────────────────────────────────────────────────────────────────────────

/// Material of [`twisted_ring`].
fn ring_material() -> Material {
    Material::new(1e7, 0.3, 1e-3).unwrap()
}

/// Cases on which the invariances are tested: b₁ = 1 for both, wrinkle-free faces in the first,
/// curvature and a solved pose in the second.
fn cases() -> Vec<(&'static str, PosedSheet, Material)> {
    vec![
        ("ring", twisted_ring(0.15, 4), ring_material()),
        ("cylinder", twisted_cylinder_at_rest(0.45).0, mylar()),
    ]
}

/// Asserts that `moved` is the field of `plain` with lengths `length` times and energies `energy`
/// times as large; amplitude `v` of `plain` is amplitude `vertex[v]` of `moved`.
fn assert_same(
    name: &str,
    plain: &Solved,
    moved: &Solved,
    length: f64,
    energy: f64,
    vertex: &[usize],
) {
    let ratio = moved.report.energy_joule / (plain.report.energy_joule * energy);
    let back: Vec<f64> = vertex.iter().map(|&v| moved.field.amplitude_m[v] / length).collect();
    let off = largest_difference(&plain.field.amplitude_m, &back);
    eprintln!(
        "{name}: energy {:.1e}, amplitudes {off:.1e} off; {} and {} iterations",
        ratio - 1.0,
        plain.report.iterations,
        moved.report.iterations
    );
    assert!((ratio - 1.0).abs() < 1e-6, "{name}: energy is {ratio} times what it should be");
    assert!(off < 1e-4, "{name}: amplitudes differ by {off:.1e}");
    assert_eq!(turns(plain), turns(moved), "{name}");
}

fn identity(n: usize) -> Vec<usize> {
    (0..n).collect()
}

#[test]
fn rigid_motions_change_nothing() {
    for (name, sheet, material) in cases() {
        let plain = sheet.solve(&material, &FieldOptions::default());
        let (in_space, at_rest) = (
            Rotation3::from_euler_angles(0.7, -0.4, 2.1),
            Rotation3::from_euler_angles(-1.0, 0.3, 0.8),
        );
        let mut moved = sheet.clone().posed(|p| in_space * p + Vec3::new(3.0, -20.0, 7.0));
        let positions = moved
            .rest_shape
            .positions
            .iter()
            .map(|p| at_rest * p + Vec3::new(-5.0, 2.0, 1.0))
            .collect();
        let rest_shape = RestShape { positions, faces: moved.rest_shape.faces.clone() };
        moved = PosedSheet::new(rest_shape, moved.topology.faces.clone(), moved.pose);
        moved.held = sheet.held.clone();
        assert_same(
            name,
            &plain,
            &moved.solve(&material, &FieldOptions::default()),
            1.0,
            1.0,
            &identity(sheet.pose.len()),
        );
    }
}

/// Nor do they change the start, and so the road to the minimum.
#[test]
fn turning_does_not_change_the_first_wavelength() {
    let sheet = PosedSheet::rectangle(1.0, 0.2, 0.1, 1);
    let turned = sheet.clone().posed(|p| Rotation3::from_euler_angles(0.0, 0.0, 0.7) * p);
    let [plain, turned] =
        [&sheet, &turned].map(|s| plisse::field::initialise::first_wavelength_m(&mylar(), &s.pose));
    assert!((turned / plain - 1.0).abs() < 1e-12, "{turned} m, not {plain}");
}

#[test]
fn numbering_changes_nothing() {
    for (name, sheet, material) in cases() {
        let plain = sheet.solve(&material, &FieldOptions::default());
        let mut random = Random(11);
        for _ in 0..3 {
            let (vertex, face) = (
                permutation(&mut random, sheet.pose.len()),
                permutation(&mut random, sheet.topology.face_count()),
            );
            let mut pose = sheet.pose.clone();
            let mut held = sheet.held.clone();
            for v in 0..pose.len() {
                pose[vertex[v]] = sheet.pose[v];
                held[vertex[v]] = sheet.held[v];
            }
            let faces = face.iter().map(|&f| sheet.topology.faces[f].map(|v| vertex[v])).collect();
            let rest_faces = face.iter().map(|&f| sheet.rest_shape.faces[f]).collect();
            let rest_shape =
                RestShape { positions: sheet.rest_shape.positions.clone(), faces: rest_faces };
            let mut moved = PosedSheet::new(rest_shape, faces, pose);
            moved.held = held;
            assert_same(
                name,
                &plain,
                &moved.solve(&material, &FieldOptions::default()),
                1.0,
                1.0,
                &vertex,
            );
        }
    }
}

/// The corner of a face that comes first does not matter either.
#[test]
fn first_corners_change_nothing() {
    for (name, sheet, material) in cases() {
        let plain = sheet.solve(&material, &FieldOptions::default());
        let mut random = Random(5);
        let shift: Vec<usize> =
            (0..sheet.topology.face_count()).map(|_| (random.next_u64() % 3) as usize).collect();
        let turned = |faces: &[[usize; 3]]| -> Vec<[usize; 3]> {
            faces.iter().zip(&shift).map(|(f, &s)| [f[s], f[(s + 1) % 3], f[(s + 2) % 3]]).collect()
        };
        let mut moved = PosedSheet::new(
            RestShape {
                positions: sheet.rest_shape.positions.clone(),
                faces: turned(&sheet.rest_shape.faces),
            },
            turned(&sheet.topology.faces),
            sheet.pose.clone(),
        );
        moved.held = sheet.held.clone();
        assert_same(
            name,
            &plain,
            &moved.solve(&material, &FieldOptions::default()),
            1.0,
            1.0,
            &identity(sheet.pose.len()),
        );
    }
}

/// `sheet` with all lengths `length` times as large, and the material in the units in which Young's
/// modulus is `stress` times as large.
fn in_units(
    sheet: &PosedSheet,
    material: &Material,
    length: f64,
    stress: f64,
) -> (PosedSheet, Material) {
    let positions = sheet.rest_shape.positions.iter().map(|p| p * length).collect();
    let rest_shape = RestShape { positions, faces: sheet.rest_shape.faces.clone() };
    let pose = sheet.pose.iter().map(|p| p * length).collect();
    let mut scaled = PosedSheet::new(rest_shape, sheet.topology.faces.clone(), pose);
    scaled.held = sheet.held.clone();
    (
        scaled,
        Material::new(material.young_pa * stress, material.poisson, material.thickness_m * length)
            .unwrap(),
    )
}

#[test]
fn millimetres_and_megapascals_give_the_same_field() {
    for (name, sheet, material) in cases() {
        let plain = sheet.solve(&material, &FieldOptions::default());
        let (scaled, scaled_material) = in_units(&sheet, &material, 1e3, 1e-6);
        // N·mm instead of J.
        assert_same(
            name,
            &plain,
            &scaled.solve(&scaled_material, &FieldOptions::default()),
            1e3,
            1e3,
            &identity(sheet.pose.len()),
        );
    }
}

/// Powers of two change no rounding, so that not a bit may differ unless some number has a unit
/// that it does not admit.
#[test]
fn units_that_are_powers_of_two_change_no_bit() {
    for (name, sheet, material) in cases() {
        let plain = sheet.solve(&material, &FieldOptions::default());
        for (length, stress) in [(1024.0, 1.0), (1024.0, 1.0 / 1_048_576.0), (1.0, 4096.0)] {
            let (scaled, scaled_material) = in_units(&sheet, &material, length, stress);
            let solved = scaled.solve(&scaled_material, &FieldOptions::default());
            assert_eq!(
                plain.report.iterations, solved.report.iterations,
                "{name}, lengths × {length}, stresses × {stress}"
            );
            let back: Vec<f64> = solved.field.amplitude_m.iter().map(|a| a / length).collect();
            assert_eq!(
                bits(&plain.field.amplitude_m),
                bits(&back),
                "{name}, lengths × {length}, stresses × {stress}"
            );
            assert_eq!(
                bits(&plain.field.omega),
                bits(&solved.field.omega),
                "{name}, lengths × {length}, stresses × {stress}"
            );
        }
    }
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|v| v.to_bits()).collect()
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    // More faces than a thread takes at once.
    let sheet = twisted_ring(0.08, 9);
    assert!(sheet.topology.face_count() > 500);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| sheet.solve(&ring_material(), &FieldOptions::default()))
    };
    let one = with(1);
    for other in [with(2), with(3)] {
        assert_eq!(one.report.iterations, other.report.iterations);
        assert_eq!(one.report.energy_joule.to_bits(), other.report.energy_joule.to_bits());
        assert_eq!(bits(&one.field.amplitude_m), bits(&other.field.amplitude_m));
        assert_eq!(bits(&one.field.omega), bits(&other.field.omega));
        assert_eq!(bits(one.field.phase.as_flattened()), bits(other.field.phase.as_flattened()));
        assert_eq!(one.field.wrinkle_free, other.field.wrinkle_free);
    }
}

// ── A whole field ────────────────────────────────────────────────────────────────────────────────

/// Asserts everything that the docs of [`WrinkleField`] promise.
fn assert_whole(name: &str, sheet: &PosedSheet, field: &WrinkleField) {
    let topology = &sheet.topology;
    assert!(field.amplitude_m.iter().all(|&a| a >= 0.0 && a.is_finite()), "{name}");
    assert!(
        (0..sheet.pose.len()).all(|v| !sheet.held[v] || field.amplitude_m[v] == 0.0),
        "{name}: a held vertex moves"
    );
    let size = field.omega.iter().fold(0.0_f64, |m, w| m.max(w.abs()));
    for f in 0..topology.face_count() {
        if field.wrinkle_free[f] {
            assert_eq!(field.phase[f], [0.0; 3], "{name}, face {f}");
            assert!(
                topology.faces[f].iter().all(|&v| field.amplitude_m[v] == 0.0),
                "{name}, face {f}"
            );
        } else {
            let sum: f64 = (0..3)
                .map(|k| topology.side_sign(f, k) * field.omega[topology.face_edges[f][k]])
                .sum();
            assert!(sum.abs() <= 1e-12 * size, "{name}, face {f}: ω is open by {sum:e}");
        }
    }
    for e in 0..topology.edge_count() {
        let [f, g] = topology.edge_faces[e];
        let wrinkled = |f: usize| f != plisse::mesh::NONE && !field.wrinkle_free[f];
        if wrinkled(f) && wrinkled(g) {
            let jump = topology.edges[e].map(|v| {
                let at = |f: usize| field.phase[f][topology.corner_of(f, v)];
                (at(f) - at(g)) / std::f64::consts::TAU
            });
            assert!(
                (jump[0] - jump[0].round()).abs() < 1e-9 && (jump[0] - jump[1]).abs() < 1e-9,
                "{name}, edge {e}: {jump:?} turns"
            );
        }
    }
}

#[test]
fn fields_are_closed_and_phases_meet() {
    let mut seams = 0;
    for (name, sheet, material) in cases() {
        for rule in [WrinkleFreeRule::Paper, WrinkleFreeRule::Published] {
            let solved = sheet.solve(&material, &FieldOptions { rule, ..FieldOptions::default() });
            assert_whole(name, &sheet, &solved.field);
            // Were no turn lost anywhere, phases would not test whole turns at all.
            seams += solved.report.periods.iter().filter(|p| p.turns > 10).count();
        }
    }
    assert_eq!(seams, 4);
    let (sheet, _) = shortened_sheet();
    let solved = sheet.solve(&ring_material(), &FieldOptions::default());
    assert_whole("sheet", &sheet, &solved.field);
    // Without holes, nothing is rounded: the phase is ω's own.
    let topology = &sheet.topology;
    for f in 0..topology.face_count() {
        for k in 0..3 {
            let rise = solved.field.phase[f][(k + 1) % 3] - solved.field.phase[f][k];
            let omega = topology.side_sign(f, k) * solved.field.omega[topology.face_edges[f][k]];
            assert!((rise - omega).abs() < 1e-9, "face {f}: {rise} {omega}");
        }
    }
}

/// An edge between two wrinkle-free faces has no frequency, even if both of its ends touch wrinkled
/// faces.
#[test]
fn edges_of_no_wrinkled_face_have_no_frequency() {
    let sheet = twisted_ring(0.15, 4);
    let field = sheet.solve(&ring_material(), &FieldOptions::default()).field;
    for (e, &[f, g]) in sheet.topology.edge_faces.iter().enumerate() {
        if field.wrinkle_free[f] && (g == plisse::mesh::NONE || field.wrinkle_free[g]) {
            assert_eq!(field.omega[e], 0.0, "edge {e}");
        }
    }
}

/// The ring has what it was made for: tense faces inside, wrinkles outside.
#[test]
fn the_ring_is_partly_wrinkle_free() {
    let field = twisted_ring(0.15, 4).solve(&ring_material(), &FieldOptions::default()).field;
    let free = field.wrinkle_free.iter().filter(|f| **f).count();
    assert!(
        free > 20 && free < field.wrinkle_free.len() / 2,
        "{free} of {}",
        field.wrinkle_free.len()
    );
}

// ── Going downhill ───────────────────────────────────────────────────────────────────────────────

/// Remembers what it is told, and asks to stop after some steps.
struct Watcher {
    steps: Mutex<Vec<Step>>,
    done: AtomicUsize,
    stop_after: usize,
}

impl Watcher {
    fn new(stop_after: usize) -> Self {
        Self { steps: Mutex::new(Vec::new()), done: AtomicUsize::new(0), stop_after }
    }
}

impl Observer for Watcher {
    fn step(&self, step: &Step) {
        self.steps.lock().unwrap().push(*step);
        self.done.fetch_add(1, Ordering::Relaxed);
    }
    fn cancelled(&self) -> bool {
        self.done.load(Ordering::Relaxed) >= self.stop_after
    }
}

fn watch(
    sheet: &PosedSheet,
    material: &Material,
    options: &FieldOptions,
    watcher: &Watcher,
) -> Solved {
    solve(&sheet.of(material), &sheet.pose, &sheet.held, options, watcher).unwrap()
}

#[test]
fn energy_never_rises() {
    for (name, sheet, material) in cases() {
        let watcher = Watcher::new(usize::MAX);
        let solved = watch(&sheet, &material, &FieldOptions::default(), &watcher);
        let steps = watcher.steps.lock().unwrap();
        assert!(
            steps.len() > 5
                && steps
                    .iter()
                    .enumerate()
                    .all(|(n, s)| s.iteration == n + 1 && s.stage == "field")
        );
        for pair in steps.windows(2) {
            // Below 1e-12 of the energy, the order of a sum decides.
            assert!(
                pair[1].energy_joule <= pair[0].energy_joule * (1.0 + 1e-12),
                "{name}: {pair:?}"
            );
        }
        assert!(steps[steps.len() - 1].energy_joule < 0.999 * steps[0].energy_joule);
        assert_eq!(
            steps[steps.len() - 1].energy_joule.to_bits(),
            solved.report.energy_joule.to_bits()
        );
    }
}

#[test]
fn a_cancelled_solve_keeps_what_it_has() {
    let sheet = twisted_ring(0.15, 4);
    let cancelled = watch(&sheet, &ring_material(), &FieldOptions::default(), &Watcher::new(3));
    assert_eq!((cancelled.report.ending, cancelled.report.iterations), (Ending::Cancelled, 3));
    let limited = sheet
        .solve(&ring_material(), &FieldOptions { iteration_limit: 3, ..FieldOptions::default() });
    assert_eq!(limited.report.ending, Ending::IterationLimit);
    assert_eq!(cancelled.field, limited.field);
    let never = watch(&sheet, &ring_material(), &FieldOptions::default(), &Watcher::new(0));
    assert_eq!((never.report.ending, never.report.iterations), (Ending::Cancelled, 0));
    assert!(cancelled.report.energy_joule < never.report.energy_joule);
    for solved in [&cancelled, &never] {
        assert_whole("cancelled", &sheet, &solved.field);
        assert!(solved.field.amplitude_m.iter().any(|&a| a > 0.0));
    }
}

// ── Little to do ─────────────────────────────────────────────────────────────────────────────────

/// Pulled both ways, a sheet has no wrinkles; all of its energy is that of its wrinkle-free faces.
#[test]
fn a_tense_sheet_does_not_wrinkle() {
    for rule in [WrinkleFreeRule::Paper, WrinkleFreeRule::Published] {
        let sheet = PosedSheet::rectangle(1.0, 0.6, 0.1, 1).posed(|p| p * 1.05);
        let solved = sheet.solve(&mylar(), &FieldOptions { rule, ..FieldOptions::default() });
        assert!(solved.field.wrinkle_free.iter().all(|f| *f));
        assert_whole("tense", &sheet, &solved.field);
        assert!(
            solved.field.amplitude_m.iter().all(|&a| a == 0.0) && solved.report.periods.is_empty()
        );
        assert_eq!((solved.report.energy_joule, solved.report.projected_gradient), (0.0, 0.0));
        let e = 1.05 * 1.05 - 1.0;
        let density = mylar().norm_squared(&plisse::mesh::Mat2::new(e, 0.0, 0.0, e));
        let wanted = mylar().thickness_m / 4.0 * 0.6 * density;
        assert!((solved.report.wrinkle_free_energy_joule / wanted - 1.0).abs() < 1e-10);
    }
}

#[test]
fn an_unstrained_sheet_does_not_wrinkle() {
    let sheet = PosedSheet::rectangle(1.0, 0.6, 0.1, 1);
    let solved = sheet.solve(&mylar(), &FieldOptions::default());
    assert_whole("rest", &sheet, &solved.field);
    assert!(
        solved.report.energy_joule.abs() < 1e-15
            && solved.field.amplitude_m.iter().all(|&a| a < 1e-6)
    );
}

#[test]
fn a_single_triangle_is_solved() {
    let corners = vec![Vec3::zeros(), Vec3::x(), Vec3::new(0.4, 0.9, 0.0)];
    for scale in [0.95, 1.05] {
        for rule in [WrinkleFreeRule::Paper, WrinkleFreeRule::Published] {
            let pose = corners.iter().map(|p| Vec3::new(scale * p.x, p.y, 0.0)).collect();
            let faces = vec![[0, 1, 2]];
            let rest_shape = RestShape { positions: corners.clone(), faces: faces.clone() };
            let sheet = PosedSheet::new(rest_shape, faces, pose);
            let solved = sheet.solve(
                &Material::new(1e7, 0.0, 1e-3).unwrap(),
                &FieldOptions { rule, ..FieldOptions::default() },
            );
            assert_whole("triangle", &sheet, &solved.field);
            assert!(solved.report.energy_joule.is_finite());
        }
    }
}

/// Two sheets in one mesh: each has the field that it has alone, the tense one none.
#[test]
fn separate_parts_do_not_disturb_each_other() {
    let (short, _) = shortened_sheet();
    let tense = PosedSheet::rectangle(0.5, 0.5, 0.1, 8).posed(|p| p * 1.03);
    let join = |first: &PosedSheet, second: &PosedSheet| {
        let shift = |faces: &[[usize; 3]], by: usize| {
            faces.iter().map(move |f| f.map(|v| v + by)).collect::<Vec<_>>()
        };
        let (rest, pose) = (first.rest_shape.positions.len(), first.pose.len());
        let mut both = PosedSheet::new(
            RestShape {
                positions: [&first.rest_shape.positions[..], &second.rest_shape.positions].concat(),
                faces: [&first.rest_shape.faces[..], &shift(&second.rest_shape.faces, rest)]
                    .concat(),
            },
            [&first.topology.faces[..], &shift(&second.topology.faces, pose)].concat(),
            [&first.pose[..], &second.pose].concat(),
        );
        both.held = [&first.held[..], &second.held].concat();
        both
    };
    let alone = short.solve(&ring_material(), &FieldOptions::default());
    let both = join(&short, &tense);
    let solved = both.solve(&ring_material(), &FieldOptions::default());
    assert_whole("two parts", &both, &solved.field);
    assert!(solved.field.amplitude_m[short.pose.len()..].iter().all(|&a| a == 0.0));
    assert!((solved.report.energy_joule / alone.report.energy_joule - 1.0).abs() < 1e-9);
    assert!(
        largest_difference(&alone.field.amplitude_m, &solved.field.amplitude_m[..short.pose.len()])
            < 1e-5
    );
    // Twice the same: each phase has its own root.
    let twice = join(&short, &short);
    let solved = twice.solve(&ring_material(), &FieldOptions::default());
    assert_whole("twice", &twice, &solved.field);
    assert!((solved.report.energy_joule / (2.0 * alone.report.energy_joule) - 1.0).abs() < 1e-9);
}

#[test]
fn held_everywhere_nothing_wrinkles() {
    let (mut sheet, _) = shortened_sheet();
    sheet.held.fill(true);
    let solved = sheet.solve(&ring_material(), &FieldOptions::default());
    assert_whole("held", &sheet, &solved.field);
    assert!(solved.field.amplitude_m.iter().all(|&a| a == 0.0));
    // What is left is the flat sheet's own energy.
    let strain = strain(&sheet.topology, &sheet.rest, &sheet.pose)[0].strain;
    let wanted = ring_material().thickness_m / 4.0 * ring_material().norm_squared(&strain);
    assert!((solved.report.energy_joule / wanted - 1.0).abs() < 1e-10);
}

#[test]
fn wrong_lengths_are_told() {
    let sheet = PosedSheet::rectangle(1.0, 1.0, 0.5, 1);
    let options = FieldOptions::default();
    let error = solve(&sheet, &sheet.pose[1..], &sheet.held, &options, &Silent);
    assert!(error.unwrap_err().to_string().contains(&sheet.pose.len().to_string()));
}

/// Pressed both ways at once, faces have no preferred direction; whatever comes out must be whole.
#[test]
fn a_flat_ring_has_one_period() {
    let sheet =
        PosedSheet::flat(&Outline::Annulus { inner_radius_m: 0.4, outer_radius_m: 1.0 }, 0.15, 2)
            .posed(|p| p * 0.97);
    let solved = sheet
        .solve(&ring_material(), &FieldOptions { iteration_limit: 30, ..FieldOptions::default() });
    assert_eq!(solved.report.periods.len(), 1);
    assert_whole("flat ring", &sheet, &solved.field);
}
