//! The pose in which a solve starts: the given one, brought to the clamps, blown up a little if
//! pressure acts on a flat one, and freed from obstacles.

use super::pressure::volume_m3;
use super::setup::{Clamps, Setup};
use crate::error::MeshError;
use crate::linalg::cholesky::Cholesky;
use crate::linalg::sparse::SymmetricPattern;
use crate::mesh::{Topology, Vec3};
use crate::obstacle::Obstacle;
use crate::{Error, Result};

/// A surface that encloses less than this part of (area)^1.5 counts as flat.
const FLAT: f64 = 2e-3;
/// Roundness that a flat surface is given (no unit): part of a half ball's height.
const ROUNDNESS: f64 = 0.6;
/// Distance from an obstacle, in contact thicknesses, that vertices are brought to.
const CLEAR: f64 = 0.5;
/// Rounds of pushing vertices out of several obstacles.
const ROUNDS: usize = 100;

/// The pose to start from, and the faces that were inside an obstacle.
///
/// # Errors
/// [`Error::Mesh`] naming obstacle and faces if a held vertex is inside one, its clamp takes it
/// through one, or free ones are so deep inside (deeper than the mean edge is long) that nobody
/// knows on which side they belong.
pub(super) fn prepare(setup: &Setup<'_>, start: &[Vec3]) -> Result<(Vec<Vec3>, Vec<usize>)> {
    let mut pose = meet_clamps(&setup.sheet.topology, start, setup.clamps)?;
    stay_outside(setup, start, &mut pose)?;
    if setup.loads.pressure_pa != 0.0 {
        let least = FLAT * setup.sheet.rest.area_m2().powf(1.5);
        if volume_m3(&setup.sheet.topology, &pose).abs() < least {
            bulge(&setup.sheet.topology, &mut pose)?;
        }
    }
    let resolved = push_out(setup, &mut pose)?;
    Ok((pose, resolved))
}

/// `start` plus the smoothest (graph-harmonic) displacement that brings it to the clamps.
fn meet_clamps(topology: &Topology, start: &[Vec3], clamps: &Clamps) -> Result<Vec<Vec3>> {
    let n = topology.vertex_count;
    let (mut cholesky, laplacian) = graph_laplacian(topology)?;
    let mut pose = start.to_vec();
    for axis in 0..3 {
        let fixed: Vec<bool> = clamps.targets.iter().map(|t| t[axis].is_some()).collect();
        let mut moved: Vec<f64> =
            (0..n).map(|v| clamps.targets[v][axis].map_or(0.0, |t| t - start[v][axis])).collect();
        if moved.iter().all(|&d| d == 0.0) {
            continue;
        }
        let mut right = vec![0.0; n];
        cholesky.pattern().multiply(&laplacian, &moved, &mut right);
        let mut values = laplacian.clone();
        cholesky.pattern().isolate(&mut values, &fixed);
        for v in 0..n {
            right[v] = if fixed[v] { 0.0 } else { -right[v] };
        }
        // A part that no clamp touches makes the matrix singular; it stays where it is.
        if cholesky.factorise(&values) {
            cholesky.solve(&mut right);
            for v in 0..n {
                moved[v] += right[v];
            }
        }
        for v in 0..n {
            pose[v][axis] += moved[v];
            if let Some(target) = clamps.targets[v][axis] {
                pose[v][axis] = target;
            }
        }
    }
    Ok(pose)
}

fn graph_laplacian(topology: &Topology) -> Result<(Cholesky, Vec<f64>)> {
    let pattern = SymmetricPattern::from_elements(
        topology.vertex_count,
        topology.edges.iter().map(|e| &e[..]),
    );
    let mut laplacian = vec![0.0; pattern.entry_count()];
    for &[i, j] in &topology.edges {
        laplacian[pattern.slot(i, i)] += 1.0;
        laplacian[pattern.slot(j, j)] += 1.0;
        laplacian[pattern.slot(i, j)] -= 1.0;
    }
    Ok((Cholesky::new(pattern)?, laplacian))
}

/// Blows up a surface of flat layers: every vertex moves along its normal by about the height of a
/// flat dome over its panel. Where layers meet (seams), normals cancel; nothing moves there.
fn bulge(topology: &Topology, pose: &mut [Vec3]) -> Result<()> {
    let (mut normals, mut areas) = (vec![Vec3::zeros(); pose.len()], vec![0.0; pose.len()]);
    for face in &topology.faces {
        let [a, b, c] = face.map(|v| pose[v]);
        let area = (b - a).cross(&(c - a));
        for &v in face {
            normals[v] += area;
            areas[v] += area.norm();
        }
    }
    let fixed: Vec<bool> = normals.iter().zip(&areas).map(|(n, a)| n.norm() < 0.5 * a).collect();
    let (mut cholesky, mut values) = graph_laplacian(topology)?;
    cholesky.pattern().isolate(&mut values, &fixed);
    if !cholesky.factorise(&values) {
        return Ok(());
    }
    // On a regular mesh with edges e, the solution of (graph Laplacian) u = 1 is u = (R² −
    // r²)/(6e²) over a disk.
    let mut height: Vec<f64> = fixed.iter().map(|&f| if f { 0.0 } else { 1.0 }).collect();
    cholesky.solve(&mut height);
    let edge = topology.edges.iter().map(|&[i, j]| (pose[i] - pose[j]).norm()).sum::<f64>()
        / topology.edge_count() as f64;
    for v in 0..pose.len() {
        if !fixed[v] {
            pose[v] +=
                normals[v].normalize() * (ROUNDNESS * edge * (6.0 * height[v].max(0.0)).sqrt());
        }
    }
    Ok(())
}

/// Brings free vertices out of obstacles, to half the contact thickness; tells which faces that
/// were.
fn push_out(setup: &Setup<'_>, pose: &mut [Vec3]) -> Result<Vec<usize>> {
    let topology = &setup.sheet.topology;
    let clear = CLEAR * setup.contact_thickness_m;
    let edge = (2.0 * setup.sheet.rest.area_m2() / topology.edge_count() as f64).sqrt();
    let faces_of = |v: usize| -> Vec<usize> {
        (0..topology.face_count()).filter(|&f| topology.faces[f].contains(&v)).collect()
    };
    let mut inside = vec![false; pose.len()];
    for v in 0..pose.len() {
        let free = setup.clamps.targets[v].map(|t| t.is_none());
        for round in 0..=ROUNDS {
            let nearest =
                setup.obstacles.iter().filter_map(|o| Some((o, o.nearby(&pose[v], 0.2 * clear)?)));
            let Some((obstacle, near)) =
                nearest.min_by(|a, b| a.1.distance_m.total_cmp(&b.1.distance_m))
            else {
                break;
            };
            inside[v] |= near.distance_m <= 0.0;
            // Only free coordinates can give way.
            let way = Vec3::from_fn(|axis, _| if free[axis] { near.gradient[axis] } else { 0.0 });
            if round == 0 && near.distance_m > 0.0 && way.norm_squared() < 0.25 {
                break;
            }
            if way.norm_squared() < 0.25
                || round == ROUNDS
                || near.distance_m < -edge.max(2.0 * clear)
            {
                let problem = MeshError::InsideObstacle {
                    faces: faces_of(v),
                    vertex: v,
                    obstacle: obstacle.name.clone(),
                    depth_m: -near.distance_m,
                    held: way.norm_squared() < 0.25,
                };
                return Err(Error::from(problem).at("start pose"));
            }
            pose[v] += way * ((clear - near.distance_m) / way.norm_squared());
        }
    }
    Ok((0..topology.face_count())
        .filter(|&f| topology.faces[f].iter().any(|&v| inside[v]))
        .collect())
}

/// Keeps vertices from passing through obstacles on their straight way from `start` to `pose`: free
/// ones stop before them.
fn stay_outside(setup: &Setup<'_>, start: &[Vec3], pose: &mut [Vec3]) -> Result<()> {
    let clear = CLEAR * setup.contact_thickness_m;
    for v in 0..pose.len() {
        let targets = setup.clamps.targets[v];
        for obstacle in setup.obstacles {
            let Some(part) = part_before(obstacle, &start[v], &(pose[v] - start[v]), clear) else {
                continue;
            };
            pose[v] = start[v] + (pose[v] - start[v]) * part;
            for axis in 0..3 {
                pose[v][axis] = targets[axis].unwrap_or(pose[v][axis]);
            }
            let held = targets.iter().any(Option::is_some);
            // Those that end inside are refused, or pushed out, afterwards.
            if held
                && obstacle.distance_m(&pose[v]) > 0.0
                && part_before(obstacle, &start[v], &(pose[v] - start[v]), clear).is_some()
            {
                let faces: Vec<usize> = (0..setup.sheet.topology.face_count())
                    .filter(|&f| setup.sheet.topology.faces[f].contains(&v))
                    .collect();
                let obstacle = obstacle.name.clone();
                let problem = MeshError::ClampThroughObstacle { faces, vertex: v, obstacle };
                return Err(Error::from(problem).at("start pose"));
            }
        }
    }
    Ok(())
}

/// Part of the way `by` (m) on which a point that moves from `p`, outside `obstacle`, keeps `clear`
/// (m) of it, or as much as it has, before it enters. `None` if it does not enter, or starts
/// inside.
fn part_before(obstacle: &Obstacle, p: &Vec3, by: &Vec3, clear: f64) -> Option<f64> {
    let (length, least) = (by.norm(), 1e-2 * clear);
    let mut last = obstacle.distance_m(p);
    if length == 0.0 || last <= 0.0 {
        return None;
    }
    let keep = clear.min(last);
    let (mut t, mut part) = (0.0, 0.0);
    // A step as long as the distance never enters.
    while t < 1.0 {
        t = (t + last.max(least) / length).min(1.0);
        let distance = obstacle.distance_m(&(p + by * t));
        if distance <= 0.0 || (distance < least && distance < last) {
            return Some(part);
        }
        if distance >= keep {
            part = t;
        }
        last = distance;
    }
    None
}

/// The part of a start pose that rigid motions leave free, held so that only the shape is solved
/// for: one vertex whole, one in two coordinates, one in one.
pub(super) fn pin_rigid_motions(topology: &Topology, pose: &[Vec3], clamps: &mut Clamps) {
    let mut part: Vec<usize> = (0..pose.len()).collect();
    // Lowest vertex of each connected part, by relaxation over the edges.
    loop {
        let mut changed = false;
        for &[i, j] in &topology.edges {
            let low = part[i].min(part[j]);
            changed |= part[i] != low || part[j] != low;
            (part[i], part[j]) = (low, low);
        }
        if !changed {
            break;
        }
    }
    let farthest = |a: usize, score: &dyn Fn(usize) -> f64| {
        (0..pose.len())
            .filter(|&v| part[v] == a)
            .max_by(|&u, &v| score(u).total_cmp(&score(v)))
            .unwrap_or(a)
    };
    for a in (0..pose.len()).filter(|&v| part[v] == v) {
        clamps.hold(a, pose[a]);
        let b = farthest(a, &|v| (pose[v] - pose[a]).norm_squared());
        let along = pose[b] - pose[a];
        let free = along.iamax();
        for axis in (0..3).filter(|&axis| axis != free) {
            clamps.targets[b][axis] = Some(pose[b][axis]);
        }
        let c = farthest(a, &|v| (pose[v] - pose[a]).cross(&along).norm_squared());
        let turn = along.cross(&(pose[c] - pose[a]));
        let axis = turn.iamax();
        clamps.targets[c][axis] = Some(pose[c][axis]);
    }
}
