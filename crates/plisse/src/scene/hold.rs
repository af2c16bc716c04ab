//! Clamps, loads and forces of a scene on its vertices, and the check that they hold the surface.

use super::placed::{PlacedSurface, shown};
use super::schema::{BoxTable, ClampTable, ForceTable, Scene};
use super::value::{angle, direction, in_reach};
use crate::mesh::Vec3;
use crate::rest::RestMetric;
use crate::shell::{Clamps, Loads};
use crate::{Error, Result};

/// Targets that differ by less than this, relative to the size of the start pose, do not contradict
/// each other.
const CLAMP_TOLERANCE: f64 = 1e-9;
/// A vertex this far outside of a box, relative to the size of the start pose, is in it.
const BOX_TOLERANCE: f64 = 1e-9;
/// Loads whose sum is less than this part of them hold each other.
const BALANCE: f64 = 1e-9;

pub(super) const AXES: [&str; 3] = ["x", "y", "z"];

/// The vertices that a clamp or a force acts on.
#[derive(Clone, Copy)]
pub(super) enum Grip<'a> {
    Side(&'a str),
    Near([f64; 3]),
    Within(BoxTable),
}

impl<'a> Grip<'a> {
    pub(super) fn new(
        place: &str,
        side: Option<&'a str>,
        near_m: Option<[f64; 3]>,
        within_m: Option<BoxTable>,
    ) -> Result<Self> {
        let given: Vec<Self> =
            [side.map(Self::Side), near_m.map(Self::Near), within_m.map(Self::Within)]
                .into_iter()
                .flatten()
                .collect();
        match given[..] {
            [grip] => Ok(grip),
            [] => Err(Error::value(
                place,
                "this does not say where; give one of side, near_m and within_m",
            )),
            _ => Err(Error::value(
                place,
                "this says where in several ways; keep one of side, near_m and within_m",
            )),
        }
    }

    fn of_clamp(i: usize, clamp: &'a ClampTable) -> Result<Self> {
        Self::new(&format!("clamp[{i}]"), clamp.side.as_deref(), clamp.near_m, clamp.within_m)
    }

    fn of_force(i: usize, force: &'a ForceTable) -> Result<Self> {
        Self::new(&format!("force[{i}]"), force.side.as_deref(), force.near_m, force.within_m)
    }

    pub(super) fn check(&self, scene: &Scene, place: &str) -> Result<()> {
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
                        let message = format!(
                            "the box ends at {letter} = {high} before it begins at {low}; exchange \
                             the two"
                        );
                        Err(Error::value(format!("{place}.within_m"), message))
                    }
                }
            }
        }
    }

    /// The selection in the words of the scene.
    fn words(&self) -> String {
        match self {
            Self::Side(side) => format!("\"{side}\""),
            Self::Near(point) => format!("near_m = {point:?}"),
            Self::Within(_) => "within_m".to_owned(),
        }
    }

    /// The vertices, each with its share of a force; the shares add up to 1. A vertex that a side
    /// passes twice is there twice.
    pub(super) fn vertices(
        &self,
        scene: &Scene,
        placed: &PlacedSurface,
        place: &str,
    ) -> Result<Vec<(usize, f64)>> {
        match self {
            Self::Side(reference) => {
                let side = placed.side(scene, &format!("{place}.side"), reference)?;
                let rest = &side.rest_vertices;
                let edges = if side.closed { rest.len() } else { rest.len() - 1 };
                let mut shares = vec![0.0; rest.len()];
                for k in 0..edges {
                    let next = (k + 1) % rest.len();
                    let half = 0.5
                        * (placed.rest_shape.positions[rest[next]]
                            - placed.rest_shape.positions[rest[k]])
                            .norm();
                    shares[k] += half;
                    shares[next] += half;
                }
                let length: f64 = shares.iter().sum();
                Ok(rest
                    .iter()
                    .zip(shares)
                    .map(|(&r, share)| (placed.vertex_of_rest[r], share / length))
                    .collect())
            }
            Self::Near(point) => {
                let point = Vec3::from(*point);
                let distance = |v: &usize| (placed.start[*v] - point).norm_squared();
                let nearest =
                    (0..placed.start.len()).min_by(|u, v| distance(u).total_cmp(&distance(v)));
                Ok(nearest.into_iter().map(|v| (v, 1.0)).collect())
            }
            Self::Within(BoxTable { low, high }) => {
                let tolerance = Vec3::repeat(BOX_TOLERANCE * placed.size());
                let (low, high) = (Vec3::from(*low) - tolerance, Vec3::from(*high) + tolerance);
                let inside = |v: &usize| {
                    (0..3).all(|axis| (low[axis]..=high[axis]).contains(&placed.start[*v][axis]))
                };
                let vertices: Vec<usize> = (0..placed.start.len()).filter(inside).collect();
                if vertices.is_empty() {
                    let [from, to] = placed.extent().map(shown);
                    let message = format!(
                        "no vertex starts in this box; the start pose extends from {from} to {to} \
                         m, so choose a box there"
                    );
                    return Err(Error::value(format!("{place}.within_m"), message));
                }
                let share = 1.0 / vertices.len() as f64;
                Ok(vertices.into_iter().map(|v| (v, share)).collect())
            }
        }
    }
}

/// Checks of clamps and forces that need no mesh.
pub(super) fn check(scene: &Scene) -> Result<()> {
    for (i, clamp) in scene.clamp.iter().enumerate() {
        let place = format!("clamp[{i}]");
        Grip::of_clamp(i, clamp)?.check(scene, &place)?;
        check_axes(&place, &clamp.axes)?;
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

/// Refuses what is no list of axes.
pub(super) fn check_axes(place: &str, axes: &str) -> Result<()> {
    let letters: Vec<char> = axes.chars().collect();
    let twice = letters.iter().enumerate().any(|(k, c)| letters[..k].contains(c));
    if letters.is_empty() || twice || letters.iter().any(|c| !"xyz".contains(*c)) {
        let message =
            format!("\"{axes}\" names no axes; give some of the letters x, y and z, each once");
        return Err(Error::value(format!("{place}.axes"), message));
    }
    Ok(())
}

/// The targets of the scene's clamps.
pub(super) fn clamps(scene: &Scene, placed: &PlacedSurface) -> Result<Clamps> {
    let vertex_count = placed.topology.vertex_count;
    let tolerance_m = CLAMP_TOLERANCE * placed.size();
    let mut clamps = Clamps::none(vertex_count);
    // Clamp of the scene that holds each coordinate.
    let mut by = vec![[0; 3]; vertex_count];
    for (i, clamp) in scene.clamp.iter().enumerate() {
        let grip = Grip::of_clamp(i, clamp)?;
        for (v, _) in grip.vertices(scene, placed, &format!("clamp[{i}]"))? {
            let target = target(clamp, placed.start[v]);
            for (axis, letter) in
                AXES.into_iter().enumerate().filter(|(_, letter)| clamp.axes.contains(letter))
            {
                match clamps.targets[v][axis] {
                    None => {
                        clamps.targets[v][axis] = Some(target[axis]);
                        by[v][axis] = i;
                    }
                    Some(held) if (held - target[axis]).abs() > tolerance_m => {
                        let j = by[v][axis];
                        let message = format!(
                            "{} takes a vertex to {letter} = {} m, but clamp[{j}] {} takes the \
                             same one to {held} m; \
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

/// Position (m) to which `clamp` takes a point that starts at `start` (m): turned, then moved.
fn target(clamp: &ClampTable, start: Vec3) -> Vec3 {
    let turned = clamp.turn.map_or(start, |turn| {
        let axis = nalgebra::Unit::new_normalize(Vec3::from(turn.axis));
        let centre = Vec3::from(turn.centre_m);
        centre
            + nalgebra::Rotation3::from_axis_angle(&axis, turn.angle_deg.to_radians())
                * (start - centre)
    });
    turned + Vec3::from(clamp.move_m)
}

/// The loads of the scene, with forces spread over their vertices.
pub(super) fn loads(scene: &Scene, placed: &PlacedSurface) -> Result<Loads> {
    let mut forces_newton = Vec::new();
    for (i, force) in scene.force.iter().enumerate() {
        let vertices = Grip::of_force(i, force)?.vertices(scene, placed, &format!("force[{i}]"))?;
        forces_newton
            .extend(vertices.into_iter().map(|(v, share)| (v, Vec3::from(force.newton) * share)));
    }
    Ok(Loads {
        density_kg_m3: scene.material.density_kg_m3.unwrap_or(0.0),
        gravity_m_s2: Vec3::from(scene.load.gravity_m_s2),
        pressure_pa: scene.load.pressure_pa,
        forces_newton,
    })
}

/// Every part of the surface must be held along every axis along which it could drift away:
/// everywhere if nothing pushes at all, else where its weight and the forces on it do not balance
/// and no obstacle could stop it.
pub(super) fn check_held(
    scene: &Scene,
    placed: &PlacedSurface,
    rest: &RestMetric,
    clamps: &Clamps,
    loads: &Loads,
) -> Result<()> {
    let idle = loads.gravity_m_s2 == Vec3::zeros()
        && loads.pressure_pa == 0.0
        && loads.forces_newton.iter().all(|(_, f)| *f == Vec3::zeros());
    if idle && scene.clamp.is_empty() {
        return Err(Error::value(
            "clamp",
            "nothing holds the surface; add at least one [[clamp]] with a side",
        ));
    }
    let part = placed.parts();
    let count = part.len();
    let (mut held, mut area_m2) = (vec![[false; 3]; count], vec![0.0; count]);
    for (v, targets) in clamps.targets.iter().enumerate() {
        for axis in 0..3 {
            held[part[v]][axis] |= targets[axis].is_some();
        }
    }
    for (face, metric) in placed.topology.faces.iter().zip(&rest.faces) {
        area_m2[part[face[0]]] += metric.area_m2;
    }
    // Sum of the forces on each part, and of their sizes.
    let (mut push, mut sizes) = (vec![Vec3::zeros(); count], vec![Vec3::zeros(); count]);
    for &(v, force) in &loads.forces_newton {
        push[part[v]] += force;
        sizes[part[v]] += force.abs();
    }
    for lowest in (0..count).filter(|&v| part[v] == v) {
        let weight = loads.gravity_m_s2
            * (loads.density_kg_m3 * scene.material.thickness_m * area_m2[lowest]);
        for (axis, letter) in AXES.into_iter().enumerate().filter(|(axis, _)| !held[lowest][*axis])
        {
            let net = (weight[axis] + push[lowest][axis]).abs();
            let drifts = net > BALANCE * (weight[axis].abs() + sizes[lowest][axis])
                && scene.obstacle.is_empty();
            if !idle && !drifts {
                continue;
            }
            let (name, what) = placed.name_of_part(lowest);
            let message = if idle {
                format!("nothing holds {name} along {letter}; clamp {what} with {letter} in axes")
            } else {
                let against = match (weight[axis] != 0.0, sizes[lowest][axis] != 0.0) {
                    (true, true) => "its weight and the forces on it",
                    (true, false) => "its weight",
                    _ => "the forces on it",
                };
                format!(
                    "nothing holds {name} along {letter} against {against}; clamp {what} with \
                     {letter} in axes, or put an obstacle under it"
                )
            };
            return Err(Error::value("clamp", message));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{BuiltScene, build, parse};

    const SHEET: &str = r#"
        title = "sheet"
        [material]
        young_pa = 1e7
        poisson = 0.3
        thickness_m = 1e-3
        density_kg_m3 = 400
        [[panel]]
        name = "p"
        shape = "rectangle"
        width_m = 1.0
        height_m = 0.5
        edge_length_m = 0.1
    "#;
    const BALLOON: &str = r#"
        title = "balloon"
        [material]
        young_pa = 1e7
        poisson = 0.3
        thickness_m = 1e-3
        [[panel]]
        name = "front"
        shape = "disk"
        radius_m = 1.0
        edge_length_m = 0.3
        [[panel]]
        name = "back"
        shape = "disk"
        radius_m = 1.0
        edge_length_m = 0.3
        [[seam]]
        a = "front.rim"
        b = "back.rim"
    "#;
    const LEFT: &str = "[[clamp]]\nside = \"p.left\"\n";
    const GRAVITY: &str = "[load]\ngravity_m_s2 = [0.0, 0.0, -9.81]\n";

    fn built(more: &str) -> Result<BuiltScene> {
        build(&parse("s.toml", &format!("{SHEET}\n{more}"))?)
    }

    fn message(more: &str) -> String {
        built(more).unwrap_err().to_string()
    }

    fn total(built: &BuiltScene) -> Vec3 {
        built.loads.forces_newton.iter().map(|(_, force)| force).sum()
    }

    #[test]
    fn forces_are_spread_and_keep_their_sum() {
        let newton = Vec3::new(1.0, -2.0, 30.0);
        let force = |place: &str| {
            built(&format!("{LEFT}[[force]]\n{place}\nnewton = [1.0, -2.0, 30.0]")).unwrap()
        };
        for (place, count) in [
            ("side = \"p.right\"", 6),
            ("near_m = [0.52, 0.0, 0.3]", 1),
            ("within_m = { low = [0.0, 0.5, 0.0], high = [1.0, 0.5, 0.0] }", 11),
        ] {
            let b = force(place);
            assert_eq!(b.loads.forces_newton.len(), count, "{place}");
            assert!((total(&b) - newton).norm() < 1e-12 * newton.norm(), "{place}");
        }
        // Along a side the ends get half as much: each edge gives half its share to each end.
        let right = force("side = \"p.right\"");
        for (k, (v, share)) in right.loads.forces_newton.iter().enumerate() {
            assert_eq!(right.start[*v].x, 1.0);
            let expected = newton / 5.0 * if k == 0 || k == 5 { 0.5 } else { 1.0 };
            assert!((share - expected).norm() < 1e-13 * newton.norm(), "{k}");
        }
        // Its moment about the origin is that of the same force at the middle of the side.
        let moment: Vec3 =
            right.loads.forces_newton.iter().map(|(v, f)| right.start[*v].cross(f)).sum();
        assert!((moment - Vec3::new(1.0, 0.25, 0.0).cross(&newton)).norm() < 1e-12);
        let near = force("near_m = [0.52, 0.0, 0.3]").loads.forces_newton[0].0;
        assert_eq!(right.start[near], Vec3::new(0.5, 0.0, 0.0));
        // Every vertex of a closed side gets the same.
        let rim =
            "[[clamp]]\nside = \"front.rim\"\n[[force]]\nside = \"front.rim\"\nnewton = [0, 0, 21]";
        let rim = build(&parse("s.toml", &format!("{BALLOON}{rim}")).unwrap()).unwrap();
        assert_eq!(rim.loads.forces_newton.len(), 21);
        assert!(rim.loads.forces_newton.iter().all(|(_, f)| (f.z - 1.0).abs() < 1e-12));
    }

    #[test]
    fn clamps_hold_a_vertex_or_a_box() {
        let b = built("[[clamp]]\nnear_m = [0.0, 0.0, 9.0]\nmove_m = [0, 0, 1]").unwrap();
        let held: Vec<usize> = (0..b.start.len()).filter(|&v| b.clamps.held()[v]).collect();
        assert_eq!(
            (held.len(), b.start[held[0]], b.clamps.targets[held[0]]),
            (1, Vec3::zeros(), [Some(0.0), Some(0.0), Some(1.0)])
        );
        let b = built("[[clamp]]\nwithin_m = { low = [-1, -1, -1], high = [0.25, 1, 1] }").unwrap();
        for (held, start) in b.clamps.held().iter().zip(&b.start) {
            assert_eq!(*held, start.x <= 0.25);
        }
    }

    #[test]
    fn where_is_said_once_and_meets_vertices() {
        let text = message("[[clamp]]\naxes = \"x\"");
        assert!(
            text.starts_with(
                "s.toml, clamp[0]: this does not say where; give one of side, near_m and within_m"
            ),
            "{text}"
        );
        let text = message("[[force]]\nside = \"p.left\"\nnear_m = [0, 0, 0]\nnewton = [0, 0, 0]");
        assert!(text.starts_with("s.toml, force[0]: this says where in several ways"), "{text}");
        let text = message("[[clamp]]\nwithin_m = { low = [0, 0, 1], high = [1, 1, 2] }");
        assert!(
            text.starts_with(
                "s.toml, clamp[0].within_m: no vertex starts in this box; the \
            start pose extends from [0.0"
            ),
            "{text}"
        );
        assert!(text.contains("to [1.000000, 0.500000, 0.000000] m"), "{text}");
        let text = message(
            "[[force]]\nnewton = [0, 0, 1]\nwithin_m = { low = [0, 2, 0], high = [1, 1, 2] }",
        );
        assert!(
            text.contains("force[0].within_m: the box ends at y = 1 before it begins at 2"),
            "{text}"
        );
        assert!(message("[[clamp]]\nnear_m = [0, inf, 0]").contains("clamp[0].near_m: inf"));
        assert!(
            message("[[force]]\nside = \"p.up\"\nnewton = [0, 0, 1]")
                .contains("force[0].side: panel \"p\" has no side")
        );
        assert!(
            message("[[force]]\nside = \"p.left\"\nnewton = [0, nan, 1]")
                .contains("force[0].newton: NaN")
        );
        let text = message(&format!("{LEFT}[[clamp]]\nnear_m = [0, 0, 0]\nmove_m = [0, 1, 0]"));
        assert!(
            text.contains(
                "clamp[1]: near_m = [0.0, 0.0, 0.0] takes a vertex to y = 1 m, but \
            clamp[0] \"p.left\""
            ),
            "{text}"
        );
    }

    #[test]
    fn loads_arrive_and_weight_needs_a_density() {
        let b = built(&format!("{LEFT}{GRAVITY}")).unwrap();
        assert_eq!(
            (b.loads.density_kg_m3, b.loads.gravity_m_s2, b.loads.pressure_pa),
            (400.0, Vec3::new(0.0, 0.0, -9.81), 0.0)
        );
        let text = |density: &str| {
            let scene = SHEET.replace("density_kg_m3 = 400", density) + LEFT + GRAVITY;
            parse("s.toml", &scene).unwrap_err().to_string()
        };
        for density in ["", "density_kg_m3 = 0"] {
            assert!(
                text(density)
                    .contains("s.toml, material.density_kg_m3: gravity needs a density above 0"),
                "{}",
                text(density)
            );
        }
        assert!(
            text("density_kg_m3 = -1").contains("-1 is no density; give a number from 0 to 1e6")
        );
        assert!(text("density_kg_m3 = nan").contains("NaN is no density"));
        assert!(message("[load]\ngravity_m_s2 = [0, 0, inf]").contains("load.gravity_m_s2: inf"));
        assert!(message("[load]\npressure_pa = nan").contains("load.pressure_pa: NaN"));
    }

    #[test]
    fn pressure_needs_a_closed_surface_and_no_clamp() {
        let text = message(&format!("{LEFT}[load]\npressure_pa = 600.0"));
        assert!(
            text.starts_with(
                "s.toml, load.pressure_pa: the surface is open at side \
            \"p.bottom\"; sew every side or remove"
            ),
            "{text}"
        );
        let b = build(&parse("s.toml", &format!("{BALLOON}[load]\npressure_pa = 600.0")).unwrap())
            .unwrap();
        assert_eq!(b.loads.pressure_pa, 600.0);
        assert!(b.clamps.held().iter().all(|held| !held));
        let open = BALLOON.split("[[seam]]").next().unwrap();
        let text = build(&parse("s.toml", &format!("{open}[load]\npressure_pa = 600.0")).unwrap())
            .unwrap_err()
            .to_string();
        assert!(text.contains("open at side \"front.rim\""), "{text}");
    }

    #[test]
    fn what_weight_or_forces_would_carry_away_is_told() {
        let text = message(GRAVITY);
        assert!(
            text.starts_with(
                "s.toml, clamp: nothing holds panel \"p\" (or what it is sewn to) \
                along z against its weight; clamp"
            ),
            "{text}"
        );
        assert!(text.contains("with z in axes, or put an obstacle under it"), "{text}");
        // Held where the weight pulls, it needs nothing else.
        assert!(built(&format!("{GRAVITY}{LEFT}axes = \"z\"")).is_ok());
        let pull =
            |side: &str, x: f64| format!("[[force]]\nside = \"p.{side}\"\nnewton = [{x}, 0, 0]\n");
        assert!(message(&pull("left", -1.0)).contains("along x against the forces on it"));
        assert!(built(&format!("{}{}", pull("left", -0.3), pull("right", 0.3))).is_ok());
        let both = message(&format!("{GRAVITY}[[force]]\nside = \"p.left\"\nnewton = [0, 0, 1e3]"));
        assert!(both.contains("against its weight and the forces on it"), "{both}");
        let floor = "[[obstacle]]\nname = \"floor\"\nkind = \"plane\"\npoint_m = [0, 0, \
            -1]\nnormal = [0, 0, 1]\n";
        assert!(built(&format!("{GRAVITY}{floor}")).is_ok());
        // An obstacle is no reason to solve what nothing pushes.
        assert!(
            message(floor).contains("clamp: nothing holds the surface; add at least one [[clamp]]")
        );
    }

    #[test]
    fn every_part_is_judged_by_its_own_loads() {
        let other =
            "[[panel]]\nname = \"q\"\nshape = \"disk\"\nradius_m = 1.0\nedge_length_m = 0.3\n";
        // The force acts on p, which is held; nothing moves q.
        assert!(
            built(&format!("{other}{LEFT}[[force]]\nside = \"p.right\"\nnewton = [1, 0, 0]"))
                .is_ok()
        );
        assert!(
            message(&format!("{other}{LEFT}{GRAVITY}"))
                .contains("nothing holds panel \"q\" (or what it is sewn to) along z")
        );
        let apart = format!(
            "{other}[[force]]\nside = \"p.right\"\nnewton = [1, 0, 0]\n[[force]]\nside = \
             \"q.rim\"\nnewton = [-1, 0, 0]"
        );
        assert!(message(&apart).contains("nothing holds panel \"p\""));
    }
}
