//! The whole of it.

use super::super::{RemeshOptions, RemeshOutcome, SurfaceMesh, edge_ratios, remesh};
use super::checks::{kept, linear_still, same_kind, same_measure, upright};
use super::meshes::{Random, sphere, square, torus, with_seam};
use crate::growth::Expansion;
use crate::mesh::{Topology, Vec3};
use crate::rest::RestMetric;

/// `sheet` grown by up to `most` in a smooth spot about `centre`, of `radius` (m); λ (m)
/// everywhere.
fn grown(
    mut sheet: SurfaceMesh,
    centre: Vec3,
    radius: f64,
    most: f64,
    wavelength: f64,
) -> SurfaceMesh {
    let topology = Topology::new(sheet.start.len(), sheet.faces.clone()).unwrap();
    let factor = |p: &Vec3| {
        let t = (1.0 - (p - centre).norm_squared() / (radius * radius)).max(0.0);
        1.0 + (most - 1.0) * t * t
    };
    let factors: Vec<f64> = sheet.start.iter().map(factor).collect();
    let expansion = Expansion::from_factors(&topology, &sheet.start, &factors).unwrap();
    let rest = RestMetric { faces: sheet.rest };
    sheet.rest = expansion.act_on(&topology, &sheet.start, &rest).unwrap().faces;
    sheet.channels[0] = vec![wavelength; factors.len()];
    sheet.channels[1] = factors;
    sheet
}

fn all(sheet: &SurfaceMesh) -> Vec<bool> {
    vec![true; sheet.faces.len()]
}

/// Everything that must hold after a call; says how it went.
fn verify(
    before: &SurfaceMesh,
    options: &RemeshOptions,
    outward: impl Fn(&Vec3) -> Vec3,
) -> RemeshOutcome {
    let first = remesh(before.clone(), &all(before), options).unwrap();
    let report = &first.report;
    assert!(report.converged, "{report:?}");
    let was = kept(before);
    same_kind(&first.mesh, &was).unwrap();
    upright(&first.mesh, outward).unwrap();
    same_measure(&first.mesh, &was, report.area_change_m2).unwrap();
    let area: f64 = before.rest.iter().map(|f| f.area_m2).sum();
    assert!(
        report.area_spent_m2 <= options.area_tolerance * area
            && report.area_change_m2.abs() <= report.area_spent_m2
    );
    linear_still(&first.mesh).unwrap();
    // Again gives the same; a second pass does nothing.
    assert_eq!(remesh(before.clone(), &all(before), options).unwrap(), first);
    let second = remesh(first.mesh.clone(), &all(&first.mesh), options).unwrap();
    assert_eq!((second.report.splits, second.report.swaps, second.report.collapses), (0, 0, 0));
    assert_eq!(second.mesh, first.mesh);
    // Old vertices that are left carry what they did.
    for (v, to) in first.maps.vertices.iter().enumerate() {
        if let Some(w) = *to {
            assert!(
                first.mesh.positions[w] == before.positions[v]
                    && first.mesh.channels[1][w] == before.channels[1][v]
            );
        }
    }
    for (f, to) in first.maps.faces.iter().enumerate() {
        if let Some(g) = to.filter(|&g| !first.maps.changed[g]) {
            assert_eq!(first.mesh.rest[g], before.rest[f]);
        }
    }
    first
}

/// Share of edges between 2/5 and 4/3 of what is asked for.
fn in_band(sheet: &SurfaceMesh, options: &RemeshOptions) -> f64 {
    let ratios = edge_ratios(sheet, options).unwrap();
    ratios.iter().filter(|r| (0.4..=4.0 / 3.0).contains(*r)).count() as f64 / ratios.len() as f64
}

/// Mean length (m) at rest of the sides of faces all of whose corners have `channel 1` as chosen.
fn mean_side(sheet: &SurfaceMesh, choose: impl Fn(f64) -> bool) -> f64 {
    let chosen = (0..sheet.faces.len())
        .filter(|&f| sheet.faces[f].iter().all(|&v| choose(sheet.channels[1][v])));
    let sides: Vec<f64> = chosen
        .flat_map(|f| (0..3).map(move |k| (f, k)))
        .map(|(f, k)| super::super::unfold::side(&sheet.rest[f], k))
        .collect();
    assert!(!sides.is_empty());
    sides.iter().sum::<f64>() / sides.len() as f64
}

#[test]
fn remesh_makes_an_open_sheet_fine_where_it_grows() {
    let options = RemeshOptions::new(0.12);
    for seed in 1..=4 {
        let mut sheet =
            grown(with_seam(square(0.1, seed)), Vec3::new(0.5, 0.5, 0.0), 0.25, 1.5, 0.2);
        for v in 0..sheet.start.len() {
            let p = sheet.start[v];
            sheet.frozen[v] = [p.x == 0.0 || p.x == 1.0 || p.y == 0.0 || p.y == 1.0; 3];
            // Whole faces in corners should not count as frozen regions.
            sheet.frozen[v][2] = false;
        }
        let done = verify(&sheet, &options, |_| Vec3::z());
        let (inside, outside) =
            (mean_side(&done.mesh, |g| g > 1.0), mean_side(&done.mesh, |g| g == 1.0));
        let share = in_band(&done.mesh, &options);
        assert!(share >= 0.95 && inside < 0.03 && outside > 0.06);
        assert!(in_band(&sheet, &options) < 0.95, "nothing had to be done");
    }
}

#[test]
fn remesh_makes_a_closed_surface_fine_where_it_grows() {
    let options = RemeshOptions { normal_angle: 0.8, ..RemeshOptions::new(0.2) };
    for seed in 1..=3 {
        let mut random = Random(seed);
        let sheet = grown(sphere(10, 0.1, &mut random), Vec3::z(), 0.5, 1.6, 0.4);
        let done = verify(&sheet, &options, |p| *p);
        let (inside, outside) =
            (mean_side(&done.mesh, |g| g > 1.0), mean_side(&done.mesh, |g| g == 1.0));
        let share = in_band(&done.mesh, &options);
        assert!(share >= 0.95 && inside < 0.06 && outside > 0.13);
    }
    let ring = grown(torus(24, 12, 0.2, &mut Random(9)), Vec3::new(1.4, 0.0, 0.0), 0.5, 1.5, 0.6);
    let out = |p: &Vec3| p - Vec3::new(p.x, p.y, 0.0).normalize();
    verify(&ring, &RemeshOptions { normal_angle: 1.2, ..options }, out);
}

#[test]
fn remesh_coarsens_what_is_too_fine() {
    let options = RemeshOptions::new(0.2);
    let fine = with_seam(square(0.04, 2));
    let done = verify(&fine, &options, |_| Vec3::z());
    // Vertices on the seam stay.
    let plain = verify(&square(0.04, 2), &options, |_| Vec3::z());
    let share = in_band(&plain.mesh, &options);
    assert!(share >= 0.95);
    assert!(done.mesh.start.len() < fine.start.len() / 3 && done.report.area_spent_m2 < 1e-12);
}

#[test]
fn remesh_leaves_all_outside_the_active_faces_to_the_bit() {
    let options = RemeshOptions::new(0.12);
    let sheet = grown(with_seam(square(0.05, 5)), Vec3::new(0.4, 0.5, 0.0), 0.3, 1.5, 0.1);
    let middle = |face: &[usize; 3], sheet: &SurfaceMesh| {
        face.iter().map(|&v| sheet.start[v]).sum::<Vec3>() / 3.0
    };
    let active: Vec<bool> = sheet
        .faces
        .iter()
        .map(|f| (middle(f, &sheet) - Vec3::new(0.4, 0.5, 0.0)).norm() < 0.2)
        .collect();
    let done = remesh(sheet.clone(), &active, &options).unwrap();
    assert!(done.report.converged && done.report.splits > 50, "{:?}", done.report);
    // It grew, so all keep their numbers.
    for f in (0..active.len()).filter(|&f| !active[f]) {
        assert!(done.maps.faces[f] == Some(f) && !done.maps.changed[f]);
        assert_eq!((done.mesh.faces[f], done.mesh.rest[f]), (sheet.faces[f], sheet.rest[f]));
        assert_eq!(done.mesh.uvs.as_ref().unwrap()[f], sheet.uvs.as_ref().unwrap()[f]);
        for v in sheet.faces[f] {
            assert!(
                done.maps.vertices[v] == Some(v) && done.mesh.positions[v] == sheet.positions[v]
            );
        }
    }
    // Coarsening leaves holes, which the last ones fill.
    let sheet = with_seam(square(0.05, 5));
    let active: Vec<bool> = sheet
        .faces
        .iter()
        .map(|f| (middle(f, &sheet) - Vec3::new(0.4, 0.5, 0.0)).norm() < 0.35)
        .collect();
    let coarse =
        RemeshOptions { growth_channel: None, edges_per_wave: 0.5, ..RemeshOptions::new(0.3) };
    let done = remesh(sheet.clone(), &active, &coarse).unwrap();
    assert!(done.report.converged && done.report.collapses > 20, "{:?}", done.report);
    let count = done.mesh.faces.len();
    for f in (0..active.len()).filter(|&f| !active[f]) {
        let g = done.maps.faces[f].unwrap();
        assert!(g == f || f >= count);
        assert_eq!((done.mesh.rest[g], done.maps.changed[g]), (sheet.rest[f], false));
        assert_eq!(done.mesh.faces[g], sheet.faces[f].map(|v| done.maps.vertices[v].unwrap()));
    }
    same_kind(&done.mesh, &kept(&sheet)).unwrap();
    // None active: nothing happens.
    let idle = remesh(sheet.clone(), &vec![false; sheet.faces.len()], &options).unwrap();
    assert_eq!(idle.mesh, sheet);
}

#[test]
fn remesh_stops_at_the_limit_of_vertices() {
    let sheet = grown(square(0.1, 1), Vec3::new(0.5, 0.5, 0.0), 0.4, 1.5, 0.1);
    let options = RemeshOptions { most_vertices: 300, ..RemeshOptions::new(0.12) };
    let done = verify(&sheet, &options, |_| Vec3::z());
    assert!(done.report.limited && done.mesh.positions.len() == 300);
}

#[test]
fn remesh_refines_where_normals_turn_and_growth_changes() {
    let base = RemeshOptions {
        growth_channel: None,
        edges_per_wave: 1.0,
        normal_angle: 9.0,
        finest_share: 0.1,
        ..RemeshOptions::new(0.3)
    };
    let count = |sheet: &SurfaceMesh, options: &RemeshOptions| {
        remesh(sheet.clone(), &all(sheet), options).unwrap().mesh.positions.len()
    };
    let ball = sphere(8, 0.0, &mut Random(1));
    assert!(
        count(&ball, &RemeshOptions { normal_angle: 0.1, ..base.clone() })
            > 2 * count(&ball, &base)
    );
    let mut flat = square(0.2, 1);
    flat.channels[1] = flat.start.iter().map(|p| 1.0 + p.x).collect();
    let calm = RemeshOptions { growth_channel: Some(1), growth_step: 9.0, ..base };
    assert!(
        count(&flat, &RemeshOptions { growth_step: 0.05, ..calm.clone() })
            > 2 * count(&flat, &calm)
    );
}

#[test]
fn remesh_names_what_it_cannot_use() {
    let sheet = square(0.3, 1);
    let options = RemeshOptions::new(0.2);
    let told = |spoil: &dyn Fn(&mut SurfaceMesh, &mut RemeshOptions)| {
        let (mut s, mut o) = (sheet.clone(), options.clone());
        spoil(&mut s, &mut o);
        let active = all(&s);
        remesh(s, &active, &o).unwrap_err().to_string()
    };
    assert!(told(&|s, _| s.channels[0][2] = 0.0).contains("vertex 2"));
    assert!(told(&|_, o| o.growth_channel = Some(7)).contains("channel 7"));
    assert!(told(&|_, o| o.longest_m = f64::INFINITY).contains("longest_m"));
    assert!(told(&|_, o| o.finest_share = 2.0).contains("finest_share"));
    assert!(told(&|_, o| o.flatness = -1.0).contains("flatness"));
    assert!(told(&|s, _| s.positions[1].x = f64::NAN).contains("vertex 1"));
    assert!(told(&|s, _| s.rest[1].area_m2 = 0.0).contains("face 1"));
    assert!(told(&|s, _| s.start.truncate(1)).contains("differ in length"));
    assert!(told(&|s, _| s.faces[0].swap(0, 1)).contains("disagree"));
    assert!(told(&|s, _| s.faces[0][1] = 9999).contains("face 0"));
    assert!(told(&|s, _| s.faces[1][1] = s.faces[1][0]).contains("twice"));
}

#[test]
fn remesh_settles_on_random_folded_sheets() {
    for seed in 0..12 {
        let mut random = Random(500 + seed);
        let size = 0.07 + 0.05 * random.signed().abs();
        let flat = square(size, seed);
        let centre = Vec3::new(0.5 + 0.4 * random.signed(), 0.5 + 0.4 * random.signed(), 0.0);
        let mut sheet =
            grown(flat, centre, 0.4, 1.0 + random.signed().abs(), 0.2 + 0.1 * random.signed());
        // A pose of folds, one of them steep, over which the rest metric knows nothing.
        let (height, waves) = (0.05 * random.signed(), 3.0 + 2.0 * random.signed());
        for (v, p) in sheet.positions.iter_mut().enumerate() {
            let q = sheet.start[v];
            p.z = height
                * (waves * std::f64::consts::TAU * q.x).sin()
                * (1.0 - (2.0 * q.y - 1.0).powi(2)).max(0.2);
        }
        let options =
            RemeshOptions { normal_angle: 0.3 + 0.2 * random.signed(), ..RemeshOptions::new(0.15) };
        let done = verify(&sheet, &options, |_| Vec3::z());
        let share = in_band(&done.mesh, &options);
        assert!(share >= 0.95);
    }
}
