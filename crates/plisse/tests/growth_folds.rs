//! Expansion textures folded up by the variational mode: what the surface shows against what was
//! asked.
//!
//! The clamped square has all four sides frozen; what is measured lies half a wavelength and more
//! inside. More folds, more growth and finer meshes take minutes: `plisse study growth` shows them.

mod sheets;

use plisse::growth::{
    Expansion, GrowingSurface, GrowthOptions, GrowthReport, LoadSteps, ProceduralMap, follow, grow,
};
use plisse::linalg::Ending;
use plisse::mesh::crossing::crossing_pairs;
use plisse::mesh::{Vec2, Vec3};
use plisse::obstacle::Obstacle;
use plisse::progress::Silent;
use plisse::relief::{RealisedGrowth, Relief, Window, offsets_m, realised_growth};
use plisse::shell::Loads;

use sheets::PosedSheet;

const CREST: f64 = 10.0 * std::f64::consts::PI / 180.0;

/// A square of side 1 m, grown along x.
struct Square {
    sheet: PosedSheet,
    growth: f64,
    wavelength_m: f64,
    /// Λ in units of λ.
    coherence: f64,
}

/// What folded.
struct Folded {
    pose: Vec<Vec3>,
    report: GrowthReport,
    relief: Relief,
    reached: RealisedGrowth,
}

impl Folded {
    fn count(&self) -> f64 {
        1.0 / self.relief.folds().expect("there are folds").wavelength_m
    }
}

impl Square {
    fn new(sheet: PosedSheet, growth: f64, folds: f64, coherence: f64) -> Self {
        Self { sheet, growth, wavelength_m: 1.0 / folds, coherence }
    }

    fn growing(&self) -> GrowingSurface {
        let (sheet, n) = (&self.sheet, self.sheet.pose.len());
        let expansion = Expansion::from_directions(
            &sheet.topology,
            &sheet.pose,
            &vec![Vec3::x(); n],
            &vec![self.growth; n],
        )
        .unwrap();
        let coherence_m = self.coherence * self.wavelength_m;
        let mut growing = sheet.growing_surface(&expansion, self.wavelength_m, coherence_m);
        let boundary = sheet.topology.boundary_vertices();
        growing.freeze(|v, _| boundary[v]);
        growing
    }

    fn fold(&self, options: &GrowthOptions) -> Folded {
        let (pose, report) = grow(&self.growing(), options, &Silent).unwrap();
        self.measure(pose, report)
    }

    fn measure(&self, pose: Vec<Vec3>, report: GrowthReport) -> Folded {
        let (topology, start) = (&self.sheet.topology, &self.sheet.pose);
        let inset = 0.1;
        let window =
            Window { low: Vec2::new(inset, inset), high: Vec2::new(1.0 - inset, 1.0 - inset) };
        let chart: Vec<Vec2> = start.iter().map(|p| Vec2::new(p.x, p.y)).collect();
        let offset = offsets_m(topology, start, &pose).unwrap();
        let relief = Relief::new(
            topology,
            &chart,
            &offset,
            &window,
            [(40.0 / self.wavelength_m) as usize, 81],
        )
        .unwrap();
        let inner = |f: usize| {
            topology.faces[f]
                .iter()
                .all(|&v| (start[v] - Vec3::new(0.5, 0.5, 0.0)).amax() < 0.5 - inset)
        };
        let reached =
            realised_growth(topology, start, &report.asked, &pose, |f| inner(f).then(Vec3::x));
        Folded { pose, report, relief, reached }
    }

    /// Folds, and holds the result against all that must be shown of it.
    fn check(&self) -> Folded {
        let options = GrowthOptions::default();
        let folded = self.fold(&options);
        let last = folded.report.steps.last().unwrap();
        assert!(last.ending == Ending::Converged && last.residual <= options.tolerance, "{last:?}");
        let asked = 1.0 / self.wavelength_m;
        assert!(
            (folded.count() / asked - 1.0).abs() < 0.15,
            "{} folds, {asked} asked",
            folded.count()
        );
        let crests = folded.relief.crests_within(CREST, 0.5 * self.wavelength_m);
        assert!(crests > 0.9, "{crests} of the area");
        assert!((0.97..1.001).contains(&folded.reached.length), "{:?}", folded.reached);
        assert!((0.97..1.02).contains(&folded.reached.area), "{:?}", folded.reached);
        folded
    }
}

fn lattice(columns: usize, rows: usize) -> PosedSheet {
    PosedSheet::lattice(1.0, 1.0, columns, rows)
}

#[test]
fn five_folds_at_a_growth_of_1_2() {
    Square::new(lattice(35, 14), 1.2, 5.0, 4.0).check();
}

#[test]
fn five_folds_at_a_growth_of_1_5() {
    Square::new(lattice(35, 14), 1.5, 5.0, 4.0).check();
}

#[test]
fn five_folds_at_a_growth_of_2() {
    Square::new(lattice(35, 14), 2.0, 5.0, 4.0).check();
}

#[test]
fn five_folds_on_an_irregular_mesh() {
    Square::new(PosedSheet::rectangle(1.0, 1.0, 0.2 / 6.0, 3), 1.2, 5.0, 4.0).check();
}

#[test]
fn ten_folds_at_a_growth_of_1_5() {
    Square::new(lattice(70, 14), 1.5, 10.0, 4.0).check();
}

#[test]
fn twenty_folds_at_a_growth_of_1_2() {
    Square::new(lattice(140, 12), 1.2, 20.0, 4.0).check();
}

#[test]
fn a_mesh_twice_as_fine_has_as_many_folds() {
    let count =
        |cells: usize| Square::new(lattice(5 * cells, 2 * cells), 1.3, 5.0, 4.0).check().count();
    let (coarse, fine) = (count(6), count(12));
    assert!((fine / coarse - 1.0).abs() < 0.1, "{coarse} {fine}");
}

#[test]
fn crests_run_straight_as_far_as_asked() {
    let length = |coherence: f64| {
        let square = Square::new(lattice(36, 24), 1.05, 6.0, coherence);
        let folded = square.fold(&GrowthOptions { imperfection: 0.05, ..GrowthOptions::default() });
        folded.relief.correlation_m().unwrap()
    };
    let lengths = [0.0, 1.0, 2.0, 4.0].map(length);
    assert!(lengths.windows(2).all(|l| l[0] < l[1]), "{lengths:?}");
}

#[test]
fn growing_by_one_changes_nothing_to_the_bit() {
    let square = Square::new(
        PosedSheet::rectangle(1.0, 1.0, 0.05, 3)
            .posed(|p| Vec3::new(p.x, p.y, 0.1 * (p.x * 3.0).sin())),
        1.0,
        5.0,
        4.0,
    );
    let mut growing = square.growing();
    // The rest shape is the starting surface.
    let rest =
        plisse::rest::RestMetric::from_shape(&square.sheet.pose, &square.sheet.topology.faces)
            .unwrap();
    growing.rest = rest.clone();
    growing.maps.vertices.iter_mut().for_each(|at| at.bias = 0.1);
    let (pose, report) = grow(&growing, &GrowthOptions::default(), &Silent).unwrap();
    assert_eq!(pose, square.sheet.pose);
    assert_eq!(report.asked, rest);
}

#[test]
fn growing_and_shrinking_back_flattens() {
    let square = Square::new(lattice(21, 10), 1.4, 3.0, 2.0);
    let (growing, options) = (square.growing(), GrowthOptions::default());
    let (folded, _) = grow(&growing, &options, &Silent).unwrap();
    let high = |pose: &[Vec3]| {
        pose.iter().zip(&square.sheet.pose).map(|(p, q)| (p - q).norm()).fold(0.0, f64::max)
    };
    assert!(high(&folded) > 0.1 * square.wavelength_m);
    let parts = [0.8, 0.6, 0.4, 0.2, 0.1, 0.05, 0.0];
    let steps = LoadSteps { parts: &parts, options: &options };
    let (flat, _) = follow(&growing, &folded, &steps, &Silent).unwrap();
    assert!(high(&flat) < 1e-3 * square.wavelength_m, "{:e}", high(&flat));
}

#[test]
fn rigid_motion_and_renumbering_do_not_matter() {
    let square = Square::new(PosedSheet::rectangle(1.0, 1.0, 0.06, 5), 1.3, 3.0, 1.0);
    let options = GrowthOptions { tolerance: 1e-6, ..GrowthOptions::default() };
    let pose = square.fold(&options).pose;
    // Another place, and vertices and faces in another order; imperfections stay where they are on
    // the sheet.
    let turn = slanted_turn();
    let shift = Vec3::new(3.0, -2.0, 1.0);
    let n = pose.len();
    let to = |v: usize| (7 * v + 3) % n;
    assert!(!n.is_multiple_of(7));
    let mut start = vec![Vec3::zeros(); n];
    let mut places = start.clone();
    for v in 0..n {
        start[to(v)] = turn(square.sheet.pose[v]) + shift;
        places[to(v)] = square.sheet.pose[v];
    }
    let faces: Vec<[usize; 3]> =
        square.sheet.topology.faces.iter().rev().map(|f| [to(f[1]), to(f[2]), to(f[0])]).collect();
    let moved = PosedSheet::at_rest(start, faces);
    let expansion = Expansion::from_directions(
        &moved.topology,
        &moved.pose,
        &vec![turn(Vec3::x()); n],
        &vec![square.growth; n],
    )
    .unwrap();
    let mut growing = moved.growing_surface(&expansion, square.wavelength_m, square.wavelength_m);
    growing.places = places;
    let boundary = moved.topology.boundary_vertices();
    growing.freeze(|v, _| boundary[v]);
    let (other, _) = grow(&growing, &options, &Silent).unwrap();
    let worst = (0..n).map(|v| (turn(pose[v]) + shift - other[to(v)]).norm()).fold(0.0, f64::max);
    assert!(worst < 1e-4 * square.wavelength_m, "{worst:e}");
}

/// A turn about a slanted axis.
fn slanted_turn() -> impl Fn(Vec3) -> Vec3 {
    let axis = Vec3::new(1.0, 2.0, 2.0) / 3.0;
    let (s, c) = 0.9_f64.sin_cos();
    move |p| p * c + axis.cross(&p) * s + axis * (axis.dot(&p) * (1.0 - c))
}

#[test]
fn what_cannot_be_folded_is_named() {
    let square = Square::new(lattice(10, 10), 1.5, 5.0, 1.0);
    let told = |change: &dyn Fn(&mut GrowingSurface)| {
        let mut growing = square.growing();
        change(&mut growing);
        grow(&growing, &GrowthOptions::default(), &Silent).unwrap_err().to_string()
    };
    assert!(told(&|_| ()).contains("refine the mesh or ask for wider folds"));
    assert!(
        told(&|g| g.maps.vertices.iter_mut().for_each(|at| at.frozen = [true; 3]))
            .contains("every vertex is frozen")
    );
    assert!(
        told(&|g| g.maps.vertices[7].wavelength_m = 0.0)
            .contains("growth.wavelength_m: it is 0 at vertex 7")
    );
    assert!(told(&|g| g.maps.vertices[7].coherence_m = f64::NAN).contains("growth.coherence_m"));
    assert!(told(&|g| g.maps.vertices[2].stickiness = -1.0).contains("vertex 2"));
    assert!(told(&|g| g.maps.vertices.truncate(3)).contains("give one for each"));
}

#[test]
fn what_sticks_folds_out_only() {
    let square = Square::new(lattice(21, 10), 1.2, 3.0, 2.0);
    let mut growing = square.growing();
    growing.maps.vertices.iter_mut().for_each(|at| at.stickiness = 100.0);
    let (pose, _) = grow(&growing, &GrowthOptions::default(), &Silent).unwrap();
    let (low, high) = pose.iter().fold((0.0_f64, 0.0_f64), |(l, h), p| (l.min(p.z), h.max(p.z)));
    assert!(high > 0.1 * square.wavelength_m && -low < 0.1 * high, "{low} {high}");
}

/// A square with three folds asked, small enough to be folded in a second.
fn small() -> Square {
    Square::new(lattice(21, 10), 1.2, 3.0, 2.0)
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let square = small();
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| square.fold(&GrowthOptions::default()).pose)
    };
    assert_eq!(with(1), with(3));
}

#[test]
fn the_seed_chooses_the_folds_and_the_bias_their_side() {
    let square = Square::new(lattice(21, 10), 1.1, 3.0, 2.0);
    let of = |seed: u64| square.fold(&GrowthOptions { seed, ..GrowthOptions::default() }).pose;
    assert_eq!(of(1), of(1));
    assert_ne!(of(1), of(2));
    let middle = |bias: f64| {
        let mut growing = square.growing();
        growing.maps.vertices.iter_mut().for_each(|at| at.bias = bias);
        let (pose, _) = grow(&growing, &GrowthOptions::default(), &Silent).unwrap();
        pose.iter().map(|p| p.z).sum::<f64>() / pose.len() as f64
    };
    assert!(middle(0.1) > 0.01 * square.wavelength_m && middle(-0.1) < -0.01 * square.wavelength_m);
}

#[test]
fn obstacles_and_frozen_axes_are_kept_and_weight_pulls() {
    let square = small();
    let free = square.fold(&GrowthOptions::default()).pose;
    let top = |pose: &[Vec3]| pose.iter().map(|p| p.z).fold(f64::NEG_INFINITY, f64::max);
    let middle = |pose: &[Vec3]| pose.iter().map(|p| p.z).sum::<f64>() / pose.len() as f64;
    let ceiling =
        [Obstacle::plane("ceiling", Vec3::new(0.0, 0.0, 0.5 * top(&free)), -Vec3::z()).unwrap()];
    let mut growing = square.growing();
    growing.obstacles = ceiling.into();
    growing.contact_thickness_m = 0.2 * top(&free);
    let level: Vec<usize> =
        (0..free.len()).filter(|&v| (square.sheet.pose[v].x - 0.5).abs() < 0.03).collect();
    assert!(level.iter().any(|&v| free[v].z.abs() > 1e-3));
    for &v in &level {
        growing.maps.vertices[v].frozen[2] = true;
    }
    let (pose, _) = grow(&growing, &GrowthOptions::default(), &Silent).unwrap();
    assert!(
        top(&pose) < 0.5 * top(&free) && top(&pose) > 0.1 * top(&free),
        "{} {}",
        top(&pose),
        top(&free)
    );
    assert!(level.iter().all(|&v| pose[v].z == 0.0));
    // Young's modulus is 1e5 Pa: a few pascals weigh.
    let mut growing = square.growing();
    growing.loads = Loads {
        density_kg_m3: 500.0,
        gravity_m_s2: Vec3::new(0.0, 0.0, -9.81),
        ..Loads::default()
    };
    let (heavy, _) = grow(&growing, &GrowthOptions::default(), &Silent).unwrap();
    assert!(
        middle(&heavy) < middle(&free) - 0.01 * square.wavelength_m,
        "{} {}",
        middle(&heavy),
        middle(&free)
    );
}

#[test]
fn plasticity_forgets_stress() {
    let square = small();
    let energy = |plasticity: f64| {
        let folded = square.fold(&GrowthOptions { plasticity, ..GrowthOptions::default() });
        folded.report.steps.last().unwrap().energy_joule
    };
    assert!(energy(0.5) < 0.9 * energy(0.0), "{} {}", energy(0.5), energy(0.0));
}

#[test]
fn folds_stay_where_a_narrow_band_grows() {
    let square = small();
    let n = square.sheet.pose.len();
    let band = ProceduralMap::Band {
        centre: Vec3::new(0.5, 0.5, 0.0),
        normal: Vec3::x(),
        width_m: 0.5,
        soft_m: 0.05,
    };
    let factors = band.map(&square.sheet.pose, 1.0, 1.3);
    let expansion = Expansion::from_directions(
        &square.sheet.topology,
        &square.sheet.pose,
        &vec![Vec3::x(); n],
        &factors,
    )
    .unwrap();
    let mut growing = square.growing();
    growing.maps.set_expansion(&expansion);
    let (pose, _) = grow(&growing, &GrowthOptions::default(), &Silent).unwrap();
    let off = |v: usize| (square.sheet.pose[v].x - 0.5).abs();
    let high = |chosen: &dyn Fn(f64) -> bool| {
        (0..n).filter(|&v| chosen(off(v))).map(|v| pose[v].z.abs()).fold(0.0, f64::max)
    };
    let (inside, outside) = (high(&|off| off < 0.2), high(&|off| off > 0.42));
    assert!(inside > 3.0 * outside, "{inside} {outside}");
}

/// Tripled between its sides, folds lean into each other: they cross unless they are kept apart.
#[test]
fn folds_cross_only_where_they_may() {
    let sheet = lattice(32, 10);
    let square = Square::new(sheet, 3.0, 4.0, 2.0);
    let crossing = |self_contact: bool| {
        let growing = GrowingSurface { self_contact, ..square.growing() };
        let (pose, report) = grow(&growing, &GrowthOptions::default(), &Silent).unwrap();
        let last = report.steps.last().unwrap();
        assert!(last.residual < 0.1, "{last:?}");
        crossing_pairs(&square.sheet.topology.faces, &pose).len()
    };
    assert_eq!(crossing(true), 0);
    assert!(crossing(false) > 10);
}

#[test]
fn what_nothing_holds_finds_one_dome() {
    // A free square whose middle grows: held, it would fold; free, it domes to nearly its length
    // without any stress left.
    let sheet = lattice(18, 18);
    let spots =
        ProceduralMap::Radial { centre: Vec3::new(0.5, 0.5, 0.0), axis: Vec3::z(), radius_m: 0.5 };
    let factors = spots.map(&sheet.pose, 1.0, 1.2);
    let expansion = Expansion::from_factors(&sheet.topology, &sheet.pose, &factors).unwrap();
    let mut growing = sheet.growing_surface(&expansion, 0.3, 0.0);
    growing.freeze(|_, p| p.norm() < 1e-9);
    let options = GrowthOptions { iteration_limit: 400, ..GrowthOptions::default() };
    let height = |pose: &[Vec3]| {
        let (low, high) = pose
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), p| (l.min(p.z), h.max(p.z)));
        high - low
    };
    let (held, _) = grow(&growing, &options, &Silent).unwrap();
    growing.maps.vertices.iter_mut().for_each(|at| at.hold = 0.0);
    let (free, report) = grow(&growing, &options, &Silent).unwrap();
    let last = report.steps.last().unwrap();
    assert!(last.ending == Ending::Converged && last.residual <= options.tolerance, "{last:?}");
    let all =
        realised_growth(&sheet.topology, &sheet.pose, &report.asked, &free, |_| Some(Vec3::x()));
    assert!((all.area - 1.0).abs() < 0.01, "{all:?}");
    assert!(height(&free) > 1.5 * height(&held), "{} {}", height(&free), height(&held));
}
