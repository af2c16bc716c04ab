//! Growth on a mesh that follows the folds, against growth on a mesh that was fine from the
//! beginning.

mod sheets;

use plisse::growth::{
    AdaptOptions, Expansion, GrowingSurface, GrownSurface, GrowthOptions, LoadSteps,
    follow_adapting, grow,
};
use plisse::mesh::{Topology, Vec2, Vec3};
use plisse::progress::Silent;
use plisse::relief::{Relief, Window, offsets_m, realised_growth};
use plisse::rest::RestMetric;
use sheets::PosedSheet;

const WAVELENGTH_M: f64 = 0.1;

/// Growth along x at the height `y` (m) of a sheet of 1 m × 0.5 m: the lower half grows.
fn growth(y: f64) -> f64 {
    1.0 + 0.3 * ((0.375 - y) / 0.125).clamp(0.0, 1.0)
}

fn growing(sheet: &PosedSheet) -> GrowingSurface {
    let n = sheet.pose.len();
    let factors: Vec<f64> = sheet.pose.iter().map(|p| growth(p.y)).collect();
    let expansion =
        Expansion::from_directions(&sheet.topology, &sheet.pose, &vec![Vec3::x(); n], &factors)
            .unwrap();
    let mut growing = sheet.growing_surface(&expansion, WAVELENGTH_M, 4.0 * WAVELENGTH_M);
    let boundary = sheet.topology.boundary_vertices();
    growing.freeze(|v, _| boundary[v]);
    growing
}

/// Folds between the heights 0.06 m and 0.2 m, and the share of the asked length that was reached
/// there.
fn folds(topology: &Topology, start: &[Vec3], pose: &[Vec3], asked: &RestMetric) -> (f64, f64) {
    let window = Window { low: Vec2::new(0.1, 0.06), high: Vec2::new(0.9, 0.2) };
    let chart: Vec<Vec2> = start.iter().map(|p| p.xy()).collect();
    let relief = Relief::new(
        topology,
        &chart,
        &offsets_m(topology, start, pose).unwrap(),
        &window,
        [400, 21],
    )
    .unwrap();
    let inner = |f: usize| {
        topology.faces[f]
            .iter()
            .all(|&v| (0.1..0.9).contains(&start[v].x) && (0.06..0.2).contains(&start[v].y))
    };
    let got = realised_growth(topology, start, asked, pose, |f| inner(f).then(Vec3::x));
    (1.0 / relief.folds().unwrap().wavelength_m, got.length)
}

fn adapted(growing: &GrowingSurface, adapt: &AdaptOptions) -> (GrownSurface, RestMetric) {
    let options = GrowthOptions::default();
    let parts = options.parts(growing.maps.most_growth());
    let steps = LoadSteps { parts: &parts, options: &options };
    let start = GrownSurface::new(growing.clone(), None);
    let (surface, report) =
        follow_adapting(start, &steps, adapt, &Silent, &mut |_, _| Ok(())).unwrap();
    let last = report.meshes.last().unwrap();
    assert!(
        last.vertices == surface.pose.len() && last.residual <= options.tolerance,
        "{:?}",
        report.meshes
    );
    (surface, report.growth.asked)
}

#[test]
fn a_coarse_mesh_becomes_fine_where_it_grows_and_folds_as_a_fine_one() {
    let coarse = PosedSheet::lattice(1.0, 0.5, 8, 4);
    let (surface, asked) = adapted(
        &growing(&coarse),
        &AdaptOptions { finish_iterations: 300, ..AdaptOptions::new(0.125) },
    );
    let mesh = &surface.surface;
    let fine = PosedSheet::lattice(1.0, 0.5, 70, 36);
    let (pose, report) = grow(&growing(&fine), &GrowthOptions::default(), &Silent).unwrap();
    let (expected, _) = folds(&fine.topology, &fine.pose, &pose, &report.asked);
    let (found, length) = folds(&mesh.topology, &mesh.start, &surface.pose, &asked);
    assert!(
        (found / expected - 1.0).abs() < 0.1,
        "{found} folds per metre, {expected} on the fine mesh"
    );
    assert!(length >= 0.97, "{length}");

    // Fine below, coarse above; no face turned over, none without area; the manifold was checked
    // when the topology was made.
    let (mut below, mut above) = (0.0_f64, f64::INFINITY);
    for &[i, j] in &mesh.topology.edges {
        let (p, q) = (mesh.start[i], mesh.start[j]);
        let length = (q - p).norm();
        if p.y.max(q.y) < 0.3 {
            below = below.max(length);
        } else if p.y.min(q.y) > 0.45 {
            above = above.min(length);
        }
    }
    assert!(below < WAVELENGTH_M / 5.0 && above > WAVELENGTH_M / 4.0, "{below} {above}");
    for face in &mesh.topology.faces {
        let normal = |places: &[Vec3]| {
            let [a, b, c] = face.map(|v| places[v]);
            (b - a).cross(&(c - a))
        };
        assert!(normal(&mesh.start).z > 0.0 && normal(&surface.pose).norm() > 1e-8);
    }
    let euler = surface.pose.len() as isize + mesh.topology.face_count() as isize
        - mesh.topology.edge_count() as isize;
    assert_eq!(euler, 1);
    // What it carries went with it: the form is what the map says, the boundary stays to the bit.
    let boundary = mesh.topology.boundary_vertices();
    for (v, p) in mesh.start.iter().enumerate() {
        let ([most, least], [along, _]) = mesh.maps.vertices[v].growth.principal();
        if p.y <= 0.25 {
            assert!(
                (most - 1.3).abs() < 1e-9
                    && (least - 1.0).abs() < 1e-9
                    && along.cross(&Vec3::x()).norm() < 1e-6,
                "{v}"
            );
        }
        assert_eq!(boundary[v], mesh.maps.vertices[v].frozen == [true; 3]);
        assert!(!boundary[v] || surface.pose[v] == *p);
        assert!(
            (mesh.places[v] - p).norm() < 1e-12
                && (mesh.maps.vertices[v].wavelength_m - WAVELENGTH_M).abs() < 1e-15
        );
    }
    assert!((mesh.rest.area_m2() - 0.5).abs() < 1e-9);
}

#[test]
fn growing_by_one_changes_nothing() {
    let sheet = PosedSheet::rectangle(1.0, 1.0, 0.2, 3);
    let expansion = Expansion::none(&sheet.topology, &sheet.pose).unwrap();
    let growing = sheet.growing_surface(&expansion, 0.01, 0.0);
    let (surface, asked) = adapted(&growing, &AdaptOptions::new(0.05));
    assert_eq!(
        (&surface.surface.topology, &surface.surface.rest, &asked),
        (&sheet.topology, &sheet.rest, &sheet.rest)
    );
    assert_eq!((surface.pose, surface.surface.start), (sheet.pose.clone(), sheet.pose.clone()));
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let sheet = PosedSheet::lattice(1.0, 0.5, 8, 4);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let growing = growing(&sheet);
            let options = GrowthOptions::default();
            let parts = [0.05, 0.1, 0.2];
            let adapt = AdaptOptions::new(0.125);
            let start = GrownSurface::new(growing, None);
            let steps = LoadSteps { parts: &parts, options: &options };
            let (surface, _) =
                follow_adapting(start, &steps, &adapt, &Silent, &mut |_, _| Ok(())).unwrap();
            (surface.surface.topology, surface.pose)
        })
    };
    assert_eq!(with(1), with(4));
}

#[test]
fn new_vertices_lie_on_the_curves_that_the_normals_tell() {
    use plisse::remesh::{MidpointPlacement, RemeshOptions, SurfaceMesh, remesh};
    // Waves over a flat sheet, and a ring that is round at the start; how far new vertices are
    // beside them.
    let wave = |p: &Vec3| 0.02 * (std::f64::consts::TAU * p.x / 0.2).sin();
    let flat = PosedSheet::lattice(1.0, 0.3, 40, 10);
    let ring = PosedSheet::torus(0.5, 0.1, 0.04);
    let beside = |sheet: &PosedSheet,
                  pose: Vec<Vec3>,
                  midpoints: MidpointPlacement,
                  away: &dyn Fn(&Vec3, &Vec3) -> f64| {
        let n = pose.len();
        let carried = SurfaceMesh {
            faces: sheet.topology.faces.clone(),
            rest: sheet.rest.faces.clone(),
            positions: pose,
            start: sheet.pose.clone(),
            channels: vec![vec![0.1; n]],
            frozen: vec![[false; 3]; n],
            uvs: None,
        };
        let options = RemeshOptions { growth_channel: None, midpoints, ..RemeshOptions::new(1.0) };
        let all = vec![true; carried.faces.len()];
        let fine = remesh(carried, &all, &options).unwrap().mesh;
        assert!(fine.positions.len() > 2 * n);
        let inner = |p: &Vec3| {
            (0.05..0.95).contains(&p.x) && (0.05..0.25).contains(&p.y)
                || sheet.held.len() == ring.held.len()
        };
        let each = (n..fine.positions.len())
            .filter(|&v| inner(&fine.start[v]))
            .map(|v| away(&fine.positions[v], &fine.start[v]).abs());
        each.fold(0.0, f64::max)
    };
    let waves = |midpoints| {
        let pose = flat.pose.iter().map(|p| Vec3::new(p.x, p.y, wave(p))).collect();
        beside(&flat, pose, midpoints, &|p, start| {
            if start.z == 0.0 { p.z - wave(p) } else { f64::INFINITY }
        })
    };
    assert!(
        waves(MidpointPlacement::Folds) < 0.5 * waves(MidpointPlacement::Flat),
        "{} {}",
        waves(MidpointPlacement::Folds),
        waves(MidpointPlacement::Flat)
    );
    let tube = |p: &Vec3| (p.xy().norm() - 0.5).hypot(p.z) - 0.1;
    let rings = |midpoints| {
        beside(&ring, ring.pose.clone(), midpoints, &|p, start| {
            if p == start { tube(p) } else { f64::INFINITY }
        })
    };
    assert!(
        rings(MidpointPlacement::Start) < 0.5 * rings(MidpointPlacement::Folds),
        "{} {}",
        rings(MidpointPlacement::Start),
        rings(MidpointPlacement::Folds)
    );
    assert_eq!(rings(MidpointPlacement::Folds), rings(MidpointPlacement::Flat));
}
