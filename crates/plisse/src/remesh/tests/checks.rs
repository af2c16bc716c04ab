//! What remeshing must keep, as checks that say what is wrong.

use super::super::SurfaceMesh;
use super::super::patch::{Patch, normal};
use super::super::unfold;
use super::meshes::{Random, annulus, linear, sphere, square, with_seam};
use crate::mesh::{Topology, Vec2, Vec3};

/// What a surface is, for comparison.
pub(super) struct Kept {
    euler: isize,
    area: f64,
    /// Lengths (m) of the boundary at rest, in space, and at the start.
    boundary: [f64; 3],
    seams: f64,
    frozen_area: f64,
}

pub(super) fn kept(sheet: &SurfaceMesh) -> Kept {
    let topology = Topology::new(sheet.positions.len(), sheet.faces.clone()).unwrap();
    let mut boundary = [0.0; 3];
    let mut seams = 0.0;
    for e in 0..topology.edge_count() {
        let [a, b] = topology.edges[e];
        let side = |f: usize| (f, topology.face_edges[f].iter().position(|&x| x == e).unwrap());
        let (f, k) = side(topology.edge_faces[e][0]);
        let length = unfold::side(&sheet.rest[f], k);
        if topology.is_boundary_edge(e) {
            boundary[0] += length;
            boundary[1] += (sheet.positions[a] - sheet.positions[b]).norm();
            boundary[2] += (sheet.start[a] - sheet.start[b]).norm();
        } else if let Some(uvs) = &sheet.uvs {
            let (g, l) = side(topology.edge_faces[e][1]);
            seams += if uvs[f][k] == uvs[g][(l + 1) % 3] { 0.0 } else { length };
        }
    }
    let frozen = |f: &usize| sheet.faces[*f].iter().all(|&v| sheet.frozen[v] == [true; 3]);
    Kept {
        euler: topology.vertex_count as isize - topology.edge_count() as isize
            + topology.face_count() as isize,
        area: sheet.rest.iter().map(|f| f.area_m2).sum(),
        boundary,
        seams,
        frozen_area: (0..sheet.faces.len()).filter(frozen).map(|f| sheet.rest[f].area_m2).sum(),
    }
}

/// Manifold; as many handles and holes as before.
pub(super) fn same_kind(sheet: &SurfaceMesh, before: &Kept) -> Result<(), String> {
    Topology::new(sheet.positions.len(), sheet.faces.clone()).map_err(|e| e.to_string())?;
    let patch = Patch::new(sheet.clone(), &vec![true; sheet.faces.len()]);
    if let Some(v) = (0..sheet.positions.len()).find(|&v| patch.fan(v).is_none()) {
        return Err(format!("vertex {v} has two fans"));
    }
    let now = kept(sheet);
    (now.euler == before.euler)
        .then_some(())
        .ok_or_else(|| format!("Euler characteristic {} was {}", now.euler, before.euler))
}

/// No face is turned over: all are on the side that `outward` (of the middle of a face) points to,
/// and have area at rest.
pub(super) fn upright(sheet: &SurfaceMesh, outward: impl Fn(&Vec3) -> Vec3) -> Result<(), String> {
    for (f, face) in sheet.faces.iter().enumerate() {
        for places in [&sheet.positions, &sheet.start] {
            let corners = face.map(|v| places[v]);
            if normal(corners).dot(&outward(&(corners.iter().sum::<Vec3>() / 3.0))) <= 0.0 {
                return Err(format!("face {f} is turned over"));
            }
        }
        if sheet.rest[f].area_m2.is_nan() || sheet.rest[f].area_m2 <= 0.0 {
            return Err(format!("face {f} has no area at rest"));
        }
    }
    Ok(())
}

/// Rest area but for `change` (m²), boundary, seams and frozen regions to 1e-12; both sides of each
/// edge equally long.
pub(super) fn same_measure(sheet: &SurfaceMesh, before: &Kept, change: f64) -> Result<(), String> {
    let now = kept(sheet);
    let mut pairs =
        vec![("area", now.area, before.area + change), ("seams", now.seams, before.seams)];
    pairs.push(("frozen area", now.frozen_area, before.frozen_area));
    pairs.extend((0..3).map(|k| ("boundary", now.boundary[k], before.boundary[k])));
    if let Some((what, a, b)) =
        pairs.into_iter().find(|(_, a, b)| (a - b).abs() > 1e-12 * b.max(1.0))
    {
        return Err(format!("{what} is {a}, was {b}"));
    }
    let topology = Topology::new(sheet.positions.len(), sheet.faces.clone()).unwrap();
    let side = |f: usize, e: usize| {
        unfold::side(&sheet.rest[f], topology.face_edges[f].iter().position(|&x| x == e).unwrap())
    };
    for e in (0..topology.edge_count()).filter(|&e| !topology.is_boundary_edge(e)) {
        let [a, b] = topology.edge_faces[e].map(|f| side(f, e));
        if (a - b).abs() > 1e-10 * a {
            return Err(format!("edge {e} is {a} long on one side and {b} on the other"));
        }
    }
    Ok(())
}

/// Channel 2, and texture places but for the island, are linear functions of the place at the
/// start, to the bit.
pub(super) fn linear_still(sheet: &SurfaceMesh) -> Result<(), String> {
    if let Some(v) =
        (0..sheet.start.len()).find(|&v| sheet.channels[2][v] != linear(&sheet.start[v]))
    {
        return Err(format!("channel 2 at vertex {v} is off its linear function"));
    }
    for (f, uvs) in sheet.uvs.iter().flatten().enumerate() {
        let shift = |k: usize| {
            let p = sheet.start[sheet.faces[f][k]];
            uvs[k] - Vec2::new(p.x, 2.0 * p.y)
        };
        let island = shift(0);
        if !(island == Vec2::zeros() || island == Vec2::new(4.0, 0.0))
            || shift(1) != island
            || shift(2) != island
        {
            return Err(format!("texture places of face {f} are off their linear function"));
        }
    }
    Ok(())
}

#[test]
fn remesh_checks_fail_on_spoilt_surfaces() {
    let up = |_: &Vec3| Vec3::z();
    let mut good = with_seam(square(0.2, 1));
    (0..good.start.len())
        .filter(|&v| good.start[v].x < 0.3)
        .collect::<Vec<_>>()
        .into_iter()
        .for_each(|v| good.frozen[v] = [true; 3]);
    let before = kept(&good);
    let all = |s: &SurfaceMesh| {
        [same_kind(s, &before), upright(s, up), same_measure(s, &before, 0.0), linear_still(s)]
            .map(|r| r.is_ok())
    };
    assert_eq!(all(&good), [true; 4]);
    assert!(before.seams > 0.5 && before.frozen_area > 0.05);

    // A face missing in the middle, and a face twice.
    let mut holed = good.clone();
    let inner = (0..holed.faces.len())
        .find(|&f| {
            holed.faces[f].iter().all(|&v| (good.start[v].xy() - Vec2::new(0.5, 0.5)).norm() < 0.4)
        })
        .unwrap();
    holed.faces.remove(inner);
    holed.rest.remove(inner);
    holed.uvs.as_mut().unwrap().remove(inner);
    assert!(same_kind(&holed, &before).is_err() && same_measure(&holed, &before, 0.0).is_err());
    let mut doubled = good.clone();
    doubled.faces.push(doubled.faces[0]);
    assert!(same_kind(&doubled, &before).is_err());
    // Another surface; two fans on one vertex.
    assert!(same_kind(&annulus(0.3, 1), &before).unwrap_err().contains("Euler"));
    let bow = super::meshes::sheet(
        vec![Vec3::zeros(), Vec3::x(), Vec3::y(), -Vec3::x(), -Vec3::y()],
        vec![[0, 1, 2], [0, 3, 4]],
    );
    assert!(same_kind(&bow, &before).unwrap_err().contains("two fans"));

    let spoilt = |spoil: &dyn Fn(&mut SurfaceMesh)| {
        let mut sheet = good.clone();
        spoil(&mut sheet);
        all(&sheet)
    };
    let far = Vec3::new(3.0, 3.0, 0.0);
    let n = good.positions.len() - 1;
    assert!(!spoilt(&|s| s.positions[n] += far)[1] && !spoilt(&|s| s.start[n] += far)[1]);
    assert!(
        !spoilt(&|s| s.positions[0] += far * 1e-6)[2] && !spoilt(&|s| s.start[0] += far * 1e-6)[2]
    );
    assert!(
        !spoilt(&|s| s.rest[3].inverse_root *= 1.0 + 1e-9)[2]
            && !spoilt(&|s| s.rest[3].area_m2 *= 1.0 + 1e-6)[2]
    );
    assert!(!spoilt(&|s| s.frozen[0] = [false; 3])[2]);
    let seamless = |s: &mut SurfaceMesh| {
        s.uvs.as_mut().unwrap().iter_mut().flatten().for_each(|uv| uv.x %= 4.0)
    };
    assert!(!spoilt(&seamless)[2]);
    assert!(
        !spoilt(&|s| s.channels[2][5] = s.channels[2][5].next_up())[3]
            && !spoilt(&|s| s.uvs.as_mut().unwrap()[2][1].y += 1e-15)[3]
    );
    let ball = sphere(4, 0.1, &mut Random(1));
    assert!(upright(&ball, |p| *p).is_ok() && upright(&ball, |p| -p).is_err());
}
