//! Random splits, swaps and collapses, one after the other.

use super::super::SurfaceMesh;
use super::super::collapse::Tolerances;
use super::super::patch::Patch;
use super::checks::{kept, linear_still, same_kind, same_measure, upright};
use super::meshes::{Random, annulus, sphere, square, torus, with_seam};
use crate::mesh::Vec3;

/// An index in 0..n.
fn below(random: &mut Random, n: usize) -> usize {
    (random.next_u64() % n as u64) as usize
}

/// `count` random operations, checked after every 40; how many of each were done.
fn shake(
    sheet: SurfaceMesh,
    outward: impl Fn(&Vec3) -> Vec3,
    tolerances: Tolerances,
    count: usize,
    random: &mut Random,
) -> [usize; 3] {
    let before = kept(&sheet);
    let (vertices, faces) = (sheet.positions.len(), sheet.faces.len());
    let mut patch = Patch::new(sheet, &vec![true; faces]);
    let mut done = [0; 3];
    let curved = tolerances.flatness > TIGHT.flatness;
    let mut change = 0.0;
    for step in 1..=count {
        let kind = below(random, 5);
        let mut pick = || {
            let (f, k) = (below(random, patch.mesh.faces.len()), below(random, 3));
            (!patch.dead[f]).then(|| (patch.mesh.faces[f][k], patch.mesh.faces[f][(k + 1) % 3]))
        };
        // Swaps at random would wind a curved surface up; there, one that is wanted is looked for.
        let wanted =
            |&(a, b): &(usize, usize)| !curved || !matches!(kind, 1 | 2) || patch.wants_swap(a, b);
        let Some((a, b)) = (0..40).filter_map(|_| pick()).find(wanted) else { continue };
        match kind {
            0 => done[0] += usize::from(patch.split(a, b).is_some()),
            1 | 2 => done[1] += usize::from(patch.swap(a, b).is_some()),
            _ => {
                if let Some(area) = patch.collapse(a, b, tolerances, |_, _, _| true) {
                    assert!(area.abs() <= tolerances.area_m2);
                    change += area;
                    done[2] += 1;
                }
            }
        }
        if step % 40 == 0 || step == count {
            let copy = Patch {
                mesh: patch.mesh.clone(),
                around: patch.around.clone(),
                active: patch.active.clone(),
                dead: patch.dead.clone(),
                changed: patch.changed.clone(),
                midpoints: patch.midpoints,
                living: patch.living,
            };
            let living = copy.living;
            let (now, maps) = copy.finish(vertices, faces);
            assert_eq!(now.positions.len(), living);
            same_kind(&now, &before).unwrap();
            upright(&now, &outward).unwrap();
            same_measure(&now, &before, change).unwrap();
            linear_still(&now).unwrap();
            assert_eq!(maps.changed.len(), now.faces.len());
        }
    }
    done
}

const LOOSE: Tolerances = Tolerances { flatness: 0.4, area_m2: 0.02 };
const TIGHT: Tolerances = Tolerances { flatness: 1e-9, area_m2: 1e-12 };

#[test]
fn remesh_operations_keep_random_closed_surfaces() {
    let mut sums = [0; 3];
    for seed in 1..=6 {
        let mut random = Random(seed);
        let ball = sphere(6, 0.15, &mut random);
        let done = shake(ball, |p| *p, LOOSE, 1200, &mut random);
        let ring = torus(18, 12, 0.2, &mut random);
        let out = |p: &Vec3| p - Vec3::new(p.x, p.y, 0.0).normalize();
        let also = shake(ring, out, LOOSE, 1200, &mut random);
        (0..3).for_each(|k| sums[k] += done[k] + also[k]);
    }
    assert!(sums.iter().all(|&n| n > 300), "{sums:?}");
}

#[test]
fn remesh_operations_keep_random_open_surfaces_and_seams() {
    let mut sums = [0; 3];
    for seed in 1..=6 {
        let mut random = Random(seed + 100);
        let mut flat = with_seam(square(0.12, seed));
        for v in 0..flat.start.len() {
            let p = flat.start[v];
            let rim = seed % 2 == 0 && (p.y == 0.0 || p.y == 1.0 || p.x == 1.0);
            flat.frozen[v] = if p.x < 0.25 { [true; 3] } else { [rim, rim, false] };
        }
        let done = shake(flat, |_| Vec3::z(), TIGHT, 1500, &mut random);
        let also = shake(annulus(0.2, seed), |_| Vec3::z(), TIGHT, 1500, &mut random);
        (0..3).for_each(|k| sums[k] += done[k] + also[k]);
    }
    assert!(sums.iter().all(|&n| n > 300), "{sums:?}");
}

#[test]
fn remesh_refuses_what_would_spoil() {
    let free = |_: &Patch, _: usize, _: f64| true;
    // A tetrahedron cannot lose an edge by either.
    let corners = vec![Vec3::zeros(), Vec3::x(), Vec3::y(), Vec3::z()];
    let solid = super::meshes::sheet(corners, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]);
    let mut patch = Patch::new(solid.clone(), &[true; 4]);
    let any = Tolerances { flatness: 9.0, area_m2: 9.0 };
    assert!(patch.swap(0, 1).is_none() && patch.collapse(0, 1, any, free).is_none());
    assert_eq!(patch.mesh, solid);
    // A quad that is not convex, and one that is.
    let quad = |d: Vec3| {
        super::meshes::sheet(
            vec![Vec3::zeros(), Vec3::x(), Vec3::new(0.2, 1.0, 0.0), d],
            vec![[0, 1, 2], [1, 0, 3]],
        )
    };
    let mut dart = Patch::new(quad(Vec3::new(-1.0, -0.1, 0.0)), &[true; 2]);
    assert!(dart.swap(0, 1).is_none());
    let mut kite = Patch::new(quad(Vec3::new(0.6, -1.0, 0.0)), &[true; 2]);
    assert_eq!(kite.swap(0, 1), Some([2, 3]));
    assert!(kite.swap(0, 1).is_none(), "the edge is gone");
    // A corner of the boundary stays; beside inactive faces nothing happens.
    let flat = square(0.2, 3);
    let n = flat.faces.len();
    let mut patch = Patch::new(flat.clone(), &vec![false; n]);
    let [a, b] = [flat.faces[0][0], flat.faces[0][1]];
    assert!(
        patch.split(a, b).is_none()
            && patch.swap(a, b).is_none()
            && patch.collapse(a, b, any, free).is_none()
    );
    let mut patch = Patch::new(flat.clone(), &vec![true; n]);
    let corner = flat.start.iter().position(|p| *p == Vec3::zeros()).unwrap();
    for f in patch.around[corner].clone() {
        for v in patch.mesh.faces[f] {
            assert!(v == corner || patch.collapse(corner, v, any, free).is_none());
        }
    }
    // The top of a pyramid is not flat at rest, whatever its pose.
    let mut tent = super::meshes::sheet(
        vec![Vec3::x(), Vec3::y(), -Vec3::x(), -Vec3::y(), Vec3::z() * 0.3],
        vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
    );
    tent.positions[4].z = 0.0;
    let mut patch = Patch::new(tent, &[true; 4]);
    assert!(patch.collapse(4, 0, Tolerances { flatness: 0.1, area_m2: 9.0 }, free).is_none());
    assert!(patch.collapse(4, 0, Tolerances { flatness: 9.0, area_m2: 0.01 }, free).is_none());
    assert!(patch.collapse(4, 0, any, free).unwrap() < -0.01);
}
