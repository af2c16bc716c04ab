//! Where clamps and forces act, and whether what they act on can stay.

use super::check::{angle, direction, in_reach};
use super::laid::{Laid, shown};
use super::schema::{BoxTable, ClampTable, ForceTable, Scene};
use crate::mesh::Vec3;
use crate::rest::RestMetric;
use crate::shell::{Clamps, Loads};
use crate::{Error, Result};

/// Targets that differ by less than this, relative to the size of the start pose, do not contradict each other.
const CLAMP_TOLERANCE: f64 = 1e-9;
/// A vertex this far outside of a box, relative to the size of the start pose, is in it.
const BOX_TOLERANCE: f64 = 1e-9;
/// Loads whose sum is less than this part of them hold each other.
const BALANCE: f64 = 1e-9;

const AXES: [&str; 3] = ["x", "y", "z"];

/// Which vertices a clamp or a force takes hold of.
#[derive(Clone, Copy)]
enum Grip<'a> {
    Side(&'a str),
    Near([f64; 3]),
    Within(BoxTable),
}

impl<'a> Grip<'a> {
    fn new(place: &str, side: Option<&'a str>, near_m: Option<[f64; 3]>, within_m: Option<BoxTable>) -> Result<Self> {
        let given: Vec<Self> = [side.map(Self::Side), near_m.map(Self::Near), within_m.map(Self::Within)].into_iter().flatten().collect();
        match given[..] {
            [grip] => Ok(grip),
            [] => Err(Error::value(place, "this does not say where; give one of side, near_m and within_m")),
            _ => Err(Error::value(place, "this says where in several ways; keep one of side, near_m and within_m")),
        }
    }

    fn of_clamp(i: usize, clamp: &'a ClampTable) -> Result<Self> {
        Self::new(&format!("clamp[{i}]"), clamp.side.as_deref(), clamp.near_m, clamp.within_m)
    }

    fn of_force(i: usize, force: &'a ForceTable) -> Result<Self> {
        Self::new(&format!("force[{i}]"), force.side.as_deref(), force.near_m, force.within_m)
    }

    fn check(&self, scene: &Scene, place: &str) -> Result<()> {
        match self {
            Self::Side(side) => scene.side(&format!("{place}.side"), side).map(|_| ()),
            Self::Near(point) => in_reach(&format!("{place}.near_m"), point),
            Self::Within(BoxTable { low, high }) => {
                in_reach(&format!("{place}.within_m.low"), low)?;
                in_reach(&format!("{place}.within_m.high"), high)?;
                match (0..3).find(|&axis| low[axis] > high[axis]) {
                    None => Ok(()),
                    Some(axis) => {
                        let (letter, low, high) = (AXES[axis], low[axis], high[axis]);
                        let message = format!("the box ends at {letter} = {high} before it begins at {low}; exchange the two");
                        Err(Error::value(format!("{place}.within_m"), message))
                    }
                }
            }
        }
    }

    /// How the scene says it.
    fn words(&self) -> String {
        match self {
            Self::Side(side) => format!("\"{side}\""),
            Self::Near(point) => format!("near_m = {point:?}"),
            Self::Within(_) => "within_m".to_owned(),
        }
    }

    /// The vertices, each with its share of a force; the shares add up to 1. A vertex that a side passes twice is there twice.
    fn vertices(&self, scene: &Scene, laid: &Laid, place: &str) -> Result<Vec<(usize, f64)>> {
        match self {
            Self::Side(reference) => {
                let side = laid.side(scene, &format!("{place}.side"), reference)?;
                let rest = &side.rest_vertices;
                let edges = if side.closed { rest.len() } else { rest.len() - 1 };
                let mut shares = vec![0.0; rest.len()];
                for k in 0..edges {
                    let next = (k + 1) % rest.len();
                    let half = 0.5 * (laid.rest_positions[rest[next]] - laid.rest_positions[rest[k]]).norm();
                    shares[k] += half;
                    shares[next] += half;
                }
                let length: f64 = shares.iter().sum();
                Ok(rest.iter().zip(shares).map(|(&r, share)| (laid.vertex_of_rest[r], share / length)).collect())
            }
            Self::Near(point) => {
                let point = Vec3::from(*point);
                let distance = |v: &usize| (laid.start[*v] - point).norm_squared();
                let nearest = (0..laid.start.len()).min_by(|u, v| distance(u).total_cmp(&distance(v)));
                Ok(nearest.into_iter().map(|v| (v, 1.0)).collect())
            }
            Self::Within(BoxTable { low, high }) => {
                let tolerance = Vec3::repeat(BOX_TOLERANCE * laid.size());
                let (low, high) = (Vec3::from(*low) - tolerance, Vec3::from(*high) + tolerance);
                let inside = |v: &usize| (0..3).all(|axis| (low[axis]..=high[axis]).contains(&laid.start[*v][axis]));
                let vertices: Vec<usize> = (0..laid.start.len()).filter(inside).collect();
                if vertices.is_empty() {
                    let [from, to] = laid.extent().map(shown);
                    let message =
                        format!("no vertex starts in this box; the start pose extends from {from} to {to} m, so choose a box there");
                    return Err(Error::value(format!("{place}.within_m"), message));
                }
                let share = 1.0 / vertices.len() as f64;
                Ok(vertices.into_iter().map(|v| (v, share)).collect())
            }
        }
    }
}

/// What needs no mesh to be checked.
pub(super) fn check(scene: &Scene) -> Result<()> {
    for (i, clamp) in scene.clamp.iter().enumerate() {
        let place = format!("clamp[{i}]");
        Grip::of_clamp(i, clamp)?.check(scene, &place)?;
        let letters: Vec<char> = clamp.axes.chars().collect();
        let twice = letters.iter().enumerate().any(|(k, c)| letters[..k].contains(c));
        if letters.is_empty() || twice || letters.iter().any(|c| !"xyz".contains(*c)) {
            let message = format!("\"{}\" names no axes; give some of the letters x, y and z, each once", clamp.axes);
            return Err(Error::value(format!("{place}.axes"), message));
        }
        in_reach(&format!("{place}.move_m"), &clamp.move_m)?;
        if let Some(turn) = &clamp.turn {
            direction(&format!("{place}.turn.axis"), turn.axis)?;
            in_reach(&format!("{place}.turn.centre_m"), &turn.centre_m)?;
            angle(&format!("{place}.turn.angle_deg"), turn.angle_deg)?;
        }
    }
    for (i, force) in scene.force.iter().enumerate() {
        let place = format!("force[{i}]");
        Grip::of_force(i, force)?.check(scene, &place)?;
        in_reach(&format!("{place}.newton"), &force.newton)?;
    }
    Ok(())
}

/// What the scene's clamps hold, and where.
pub(super) fn clamps(scene: &Scene, laid: &Laid) -> Result<Clamps> {
    let vertex_count = laid.topology.vertex_count;
    let tolerance_m = CLAMP_TOLERANCE * laid.size();
    let mut clamps = Clamps::none(vertex_count);
    // Clamp of the scene that holds each coordinate.
    let mut by = vec![[0; 3]; vertex_count];
    for (i, clamp) in scene.clamp.iter().enumerate() {
        let grip = Grip::of_clamp(i, clamp)?;
        for (v, _) in grip.vertices(scene, laid, &format!("clamp[{i}]"))? {
            let target = target(clamp, laid.start[v]);
            for (axis, letter) in AXES.into_iter().enumerate().filter(|(_, letter)| clamp.axes.contains(letter)) {
                match clamps.targets[v][axis] {
                    None => {
                        clamps.targets[v][axis] = Some(target[axis]);
                        by[v][axis] = i;
                    }
                    Some(held) if (held - target[axis]).abs() > tolerance_m => {
                        let j = by[v][axis];
                        let message = format!(
                            "{} takes a vertex to {letter} = {} m, but clamp[{j}] {} takes the same one to {held} m; \
                             let only one of them hold {letter}, or move both alike",
                            grip.words(),
                            target[axis],
                            Grip::of_clamp(j, &scene.clamp[j])?.words()
                        );
                        return Err(Error::value(format!("clamp[{i}]"), message));
                    }
                    Some(_) => {}
                }
            }
        }
    }
    Ok(clamps)
}

/// Where `clamp` takes a point that starts at `start` (m): turned, then moved.
fn target(clamp: &ClampTable, start: Vec3) -> Vec3 {
    let turned = clamp.turn.map_or(start, |turn| {
        let axis = nalgebra::Unit::new_normalize(Vec3::from(turn.axis));
        let centre = Vec3::from(turn.centre_m);
        centre + nalgebra::Rotation3::from_axis_angle(&axis, turn.angle_deg.to_radians()) * (start - centre)
    });
    turned + Vec3::from(clamp.move_m)
}

/// What pushes the surface, with forces spread over their vertices.
pub(super) fn loads(scene: &Scene, laid: &Laid) -> Result<Loads> {
    let mut forces_newton = Vec::new();
    for (i, force) in scene.force.iter().enumerate() {
        let vertices = Grip::of_force(i, force)?.vertices(scene, laid, &format!("force[{i}]"))?;
        forces_newton.extend(vertices.into_iter().map(|(v, share)| (v, Vec3::from(force.newton) * share)));
    }
    Ok(Loads {
        density_kg_m3: scene.material.density_kg_m3.unwrap_or(0.0),
        gravity_m_s2: Vec3::from(scene.load.gravity_m_s2),
        pressure_pa: scene.load.pressure_pa,
        forces_newton,
    })
}

/// Every part of the surface must be held along every axis along which it could drift away: everywhere if nothing pushes at all,
/// else where its weight and the forces on it do not balance and no obstacle could stop it.
pub(super) fn check_held(scene: &Scene, laid: &Laid, rest: &RestMetric, clamps: &Clamps, loads: &Loads) -> Result<()> {
    let idle =
        loads.gravity_m_s2 == Vec3::zeros() && loads.pressure_pa == 0.0 && loads.forces_newton.iter().all(|(_, f)| *f == Vec3::zeros());
    if idle && scene.clamp.is_empty() {
        return Err(Error::value("clamp", "nothing holds the surface; add at least one [[clamp]] with a side"));
    }
    let part = laid.parts();
    let count = part.len();
    let (mut held, mut area_m2) = (vec![[false; 3]; count], vec![0.0; count]);
    for (v, targets) in clamps.targets.iter().enumerate() {
        for axis in 0..3 {
            held[part[v]][axis] |= targets[axis].is_some();
        }
    }
    for (face, metric) in laid.topology.faces.iter().zip(&rest.faces) {
        area_m2[part[face[0]]] += metric.area_m2;
    }
    // Sum of the forces on each part, and of their sizes.
    let (mut push, mut sizes) = (vec![Vec3::zeros(); count], vec![Vec3::zeros(); count]);
    for &(v, force) in &loads.forces_newton {
        push[part[v]] += force;
        sizes[part[v]] += force.abs();
    }
    for lowest in (0..count).filter(|&v| part[v] == v) {
        let weight = loads.gravity_m_s2 * (loads.density_kg_m3 * scene.material.thickness_m * area_m2[lowest]);
        for (axis, letter) in AXES.into_iter().enumerate().filter(|(axis, _)| !held[lowest][*axis]) {
            let net = (weight[axis] + push[lowest][axis]).abs();
            let drifts = net > BALANCE * (weight[axis].abs() + sizes[lowest][axis]) && scene.obstacle.is_empty();
            if !idle && !drifts {
                continue;
            }
            let (name, what) = laid.name_of_part(lowest);
            let message = if idle {
                format!("nothing holds {name} along {letter}; clamp {what} with {letter} in axes")
            } else {
                let against = match (weight[axis] != 0.0, sizes[lowest][axis] != 0.0) {
                    (true, true) => "its weight and the forces on it",
                    (true, false) => "its weight",
                    _ => "the forces on it",
                };
                format!(
                    "nothing holds {name} along {letter} against {against}; clamp {what} with {letter} in axes, or put an obstacle under it"
                )
            };
            return Err(Error::value("clamp", message));
        }
    }
    Ok(())
}
