//! From a scene to what the solvers take: panels are cut and sewn, laid into space, and held.

use std::ops::Range;

use super::check::{RELAXED_INTEGRABILITY, outline, plane};
use super::measure::{Probe, Quantity, cut};
use super::read::in_file;
use super::schema::{ClampTable, MeasureKind, Place, Rule, Scene, Shape};
use crate::field::{FieldOptions, WrinkleFreeRule};
use crate::material::Material;
use crate::mesh::panel::Panel;
use crate::mesh::sew::{Seam, Sewn, reversed, sew};
use crate::mesh::{Topology, Vec2, Vec3};
use crate::rest::RestMetric;
use crate::shell::{BaseOptions, Clamps, Setup};
use crate::{Error, Result};

/// How far apart the two start positions of a sewn vertex may be, relative to the size of the start pose.
const SEAM_TOLERANCE: f64 = 1e-6;
/// Targets that differ by less than this, relative to the size of the start pose, do not contradict each other.
const CLAMP_TOLERANCE: f64 = 1e-9;

/// A scene made ready for the solvers. V vertices, F faces, R ≥ V rest vertices.
#[derive(Clone, Debug)]
pub struct Built {
    /// Name of the scene.
    pub title: String,
    /// What was published about it, in words; may be empty.
    pub paper: String,
    /// Connectivity of the sewn surface.
    pub topology: Topology,
    /// `[F]` rest metric.
    pub rest: RestMetric,
    /// `[R]` vertices of all panels, one panel after the other (m, each panel in its own plane).
    pub rest_positions: Vec<Vec2>,
    /// `[F][3]` rest vertices of each face, corner by corner.
    pub rest_faces: Vec<[usize; 3]>,
    /// `[V]` start pose (m), before the clamps move.
    pub start: Vec<Vec3>,
    /// What is held, and where.
    pub clamps: Clamps,
    /// The sheet's material.
    pub material: Material,
    /// How to solve the base surface.
    pub base: BaseOptions,
    /// How to solve the field.
    pub field: FieldOptions,
    /// Subdivisions of the displaced surface; `None`: choose by the wavelength.
    pub levels: Option<usize>,
    /// Whether to displace by v₁.
    pub v1: bool,
    /// Whether to displace by v₂.
    pub v2: bool,
    /// What to measure, for [`super::measure`](fn@super::measure).
    pub probes: Vec<Probe>,
    /// The panels, in the scene's order.
    pub panels: Vec<BuiltPanel>,
}

impl Built {
    /// What the base solve and the reference shell take.
    pub fn setup(&self) -> Setup<'_> {
        Setup::new(&self.topology, &self.rest, &self.material, &self.clamps)
    }
}

/// Where a panel is in the surface.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BuiltPanel {
    /// Its name.
    pub name: String,
    /// Its faces.
    pub faces: Range<usize>,
    /// Its rest vertices.
    pub rest_vertices: Range<usize>,
}

/// The scene ready for the solvers. The same scene gives the same result.
///
/// # Errors
/// [`Error::Value`] whose field is "file, dotted.field" for: a panel that cannot be cut (see [`Panel::new`]), sewn sides that
/// do not start at the same place, clamps that contradict each other, a surface or a part of it that nothing holds in some
/// direction, a measure whose line misses its panel. [`Error::Mesh`] with the file for what [`sew`] refuses.
pub fn build(scene: &Scene) -> Result<Built> {
    build_unplaced(scene).map_err(|error| in_file(&scene.file, error))
}

fn build_unplaced(scene: &Scene) -> Result<Built> {
    let place = scene.file.display().to_string();
    let cut_panel = |(i, table)| {
        let place = format!("panel[{i}]");
        Panel::new(&place, &outline(&place, table)?, table.edge_length_m, table.seed)
    };
    let panels: Vec<Panel> = scene.panel.iter().enumerate().map(cut_panel).collect::<Result<_>>()?;
    let (mut built_panels, mut face, mut rest) = (Vec::new(), 0, 0);
    for (panel, table) in panels.iter().zip(&scene.panel) {
        let (faces, rest_vertices) = (face..face + panel.faces.len(), rest..rest + panel.positions.len());
        (face, rest) = (faces.end, rest_vertices.end);
        built_panels.push(BuiltPanel { name: table.name.clone(), faces, rest_vertices });
    }
    let side = |field: String, reference: &str| -> Result<(usize, &[usize])> {
        let (p, name) = scene.side(&field, reference)?;
        let missing = || Error::value(field, format!("panel {p} has no side \"{name}\"; name another one"));
        Ok((p, panels[p].side(&name).ok_or_else(missing)?))
    };

    let mut chains = Vec::new();
    for (i, seam) in scene.seam.iter().enumerate() {
        let (a, b) = (side(format!("seam[{i}].a"), &seam.a)?, side(format!("seam[{i}].b"), &seam.b)?);
        let closed = matches!(scene.panel[b.0].shape, Shape::Disk | Shape::Annulus);
        let b_chain = match (seam.reversed, closed) {
            (false, _) => b.1.to_vec(),
            (true, false) => reversed(b.1),
            (true, true) => b.1[..1].iter().copied().chain(b.1[1..].iter().rev().copied()).collect(),
        };
        chains.push((a, (b.0, b_chain)));
    }
    let seams: Vec<Seam<'_>> = chains.iter().map(|(a, b)| Seam { a: *a, b: (b.0, &b.1) }).collect();
    let sewn = sew(&place, &panels, &seams)?;

    let laid = lay(scene, &built_panels, &sewn.rest_positions)?;
    let size = size(&laid);
    for (i, seam) in seams.iter().enumerate() {
        let at = |(p, v): (usize, usize)| laid[built_panels[p].rest_vertices.start + v];
        for (&u, &v) in seam.a.1.iter().zip(seam.b.1) {
            let apart = (at((seam.a.0, u)) - at((seam.b.0, v))).norm();
            if apart > SEAM_TOLERANCE * size {
                let message = format!(
                    "\"{}\" and \"{}\" start {apart:.3e} m apart; place the panels so that sewn sides meet, or change reversed",
                    scene.seam[i].a, scene.seam[i].b
                );
                return Err(Error::value(format!("seam[{i}]"), message));
            }
        }
    }
    let mut start = Vec::with_capacity(sewn.topology.vertex_count);
    for (r, &v) in sewn.vertex_of_rest.iter().enumerate() {
        // Vertices are numbered by their lowest rest vertex, so it comes first.
        if v == start.len() {
            start.push(laid[r]);
        }
    }

    let mut holders = Holders::new(sewn.topology.vertex_count, CLAMP_TOLERANCE * size);
    for (i, clamp) in scene.clamp.iter().enumerate() {
        let (p, chain) = side(format!("clamp[{i}].side"), &clamp.side)?;
        for &v in chain {
            let vertex = sewn.vertex_of_rest[built_panels[p].rest_vertices.start + v];
            holders.hold(scene, i, vertex, target(clamp, start[vertex]))?;
        }
    }
    check_held(scene, &sewn, &built_panels, &holders.clamps)?;

    let flat: Vec<Vec3> = sewn.rest_positions.iter().map(|p| Vec3::new(p.x, p.y, 0.0)).collect();
    let rest = RestMetric::from_shape(&place, &flat, &sewn.rest_faces)?;
    let probes = probes(scene, &built_panels, &sewn)?;
    Ok(Built {
        title: scene.title.clone(),
        paper: scene.paper.clone(),
        rest,
        start,
        clamps: holders.clamps,
        material: scene.checked_material()?,
        base: base_options(scene),
        field: field_options(scene),
        levels: scene.surface.levels,
        v1: scene.surface.v1,
        v2: scene.surface.v2,
        probes,
        panels: built_panels,
        topology: sewn.topology,
        rest_positions: sewn.rest_positions,
        rest_faces: sewn.rest_faces,
    })
}

/// `[R]` start position (m) of each rest vertex.
fn lay(scene: &Scene, panels: &[BuiltPanel], rest_positions: &[Vec2]) -> Result<Vec<Vec3>> {
    let mut laid = Vec::with_capacity(rest_positions.len());
    for (i, (panel, table)) in panels.iter().zip(&scene.panel).enumerate() {
        let flat = &rest_positions[panel.rest_vertices.clone()];
        match table.place {
            Place::Flat { origin_m, x_axis, y_axis } => {
                let [x, y] = plane(&format!("panel[{i}]"), x_axis, y_axis)?;
                laid.extend(flat.iter().map(|p| Vec3::from(origin_m) + x * p.x + y * p.y));
            }
            Place::Rolled { radius_m } => laid.extend(flat.iter().map(|p| {
                let (sine, cosine) = (p.x / radius_m).sin_cos();
                Vec3::new(radius_m * cosine, radius_m * sine, p.y)
            })),
        }
    }
    Ok(laid)
}

/// Diagonal of the bounding box (m).
fn size(positions: &[Vec3]) -> f64 {
    let (low, high) = positions.iter().fold((positions[0], positions[0]), |(l, h), p| (l.inf(p), h.sup(p)));
    (high - low).norm()
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

/// Clamps, and who set each of them.
struct Holders {
    clamps: Clamps,
    /// `[V][3]` clamp of the scene that holds the coordinate.
    by: Vec<[usize; 3]>,
    tolerance_m: f64,
}

impl Holders {
    fn new(vertex_count: usize, tolerance_m: f64) -> Self {
        Self { clamps: Clamps::none(vertex_count), by: vec![[0; 3]; vertex_count], tolerance_m }
    }

    fn hold(&mut self, scene: &Scene, i: usize, vertex: usize, target: Vec3) -> Result<()> {
        for (axis, letter) in ["x", "y", "z"].into_iter().enumerate().filter(|(_, letter)| scene.clamp[i].axes.contains(letter)) {
            match self.clamps.targets[vertex][axis] {
                None => {
                    self.clamps.targets[vertex][axis] = Some(target[axis]);
                    self.by[vertex][axis] = i;
                }
                Some(held) if (held - target[axis]).abs() > self.tolerance_m => {
                    let j = self.by[vertex][axis];
                    let message = format!(
                        "\"{}\" takes a vertex to {letter} = {} m, but clamp[{j}] \"{}\" takes the same one to {held} m; \
                         let only one of them hold {letter}, or move both alike",
                        scene.clamp[i].side, target[axis], scene.clamp[j].side
                    );
                    return Err(Error::value(format!("clamp[{i}]"), message));
                }
                Some(_) => {}
            }
        }
        Ok(())
    }
}

/// Every part of the surface must be held along every axis, or it could drift away.
fn check_held(scene: &Scene, sewn: &Sewn, panels: &[BuiltPanel], clamps: &Clamps) -> Result<()> {
    if scene.clamp.is_empty() {
        return Err(Error::value("clamp", "nothing holds the surface; add at least one [[clamp]] with a side"));
    }
    // Panels that hang together have the same number.
    let mut part: Vec<usize> = (0..panels.len()).collect();
    let mut panels_of_vertex = vec![usize::MAX; sewn.topology.vertex_count];
    for (p, panel) in panels.iter().enumerate() {
        for &v in &sewn.vertex_of_rest[panel.rest_vertices.clone()] {
            let first = panels_of_vertex[v];
            if first == usize::MAX {
                panels_of_vertex[v] = p;
            } else if part[first] != part[p] {
                let (low, high) = (part[first].min(part[p]), part[first].max(part[p]));
                part.iter_mut().filter(|n| **n == high).for_each(|n| *n = low);
            }
        }
    }
    for (p, panel) in panels.iter().enumerate().filter(|(p, _)| part[*p] == *p) {
        for (axis, letter) in ["x", "y", "z"].into_iter().enumerate() {
            if !(0..sewn.topology.vertex_count).any(|v| part[panels_of_vertex[v]] == p && clamps.targets[v][axis].is_some()) {
                let message = format!(
                    "nothing holds panel \"{}\" (or what it is sewn to) along {letter}; clamp one of its sides with {letter} in axes",
                    panel.name
                );
                return Err(Error::value("clamp", message));
            }
        }
    }
    Ok(())
}

fn base_options(scene: &Scene) -> BaseOptions {
    let mut options = BaseOptions::default();
    if let Some(share) = scene.base.compressive_stiffness {
        options.compressive_stiffness = share;
    }
    if let Some(limit) = scene.base.iteration_limit {
        options.iteration_limit = limit;
    }
    options
}

fn field_options(scene: &Scene) -> FieldOptions {
    let mut options = FieldOptions::default();
    match scene.field.wrinkle_free {
        Some(Rule::Paper) => options.rule = WrinkleFreeRule::Paper,
        Some(Rule::Published) => options.rule = WrinkleFreeRule::Published,
        None => {}
    }
    for name in &scene.field.without {
        if name == RELAXED_INTEGRABILITY {
            options.relaxed_integrability = false;
        } else if let Some(terms) = options.terms.without(name) {
            options.terms = terms;
        }
    }
    if let Some(rings) = scene.field.curvature_rings {
        options.curvature_rings = rings;
    }
    if let Some(limit) = scene.field.iteration_limit {
        options.iteration_limit = limit;
    }
    options
}

fn probes(scene: &Scene, panels: &[BuiltPanel], sewn: &Sewn) -> Result<Vec<Probe>> {
    let mut probes = Vec::new();
    for (i, table) in scene.measure.iter().enumerate() {
        let quantity = match table.kind {
            MeasureKind::LargestPeriod => Quantity::LargestPeriod,
            MeasureKind::PeakAmplitude => Quantity::PeakAmplitude,
            MeasureKind::WavesAlong => {
                let (Some(from), Some(to)) = (table.from_m, table.to_m) else {
                    return Err(Error::value(format!("measure[{i}]"), "waves_along needs panel, from_m and to_m; give them"));
                };
                let panel = panels.iter().find(|panel| table.panel.as_ref() == Some(&panel.name));
                let faces = panel.map_or(0..0, |panel| panel.faces.clone());
                let pieces = cut(from.into(), to.into(), faces, |f| sewn.rest_faces[f].map(|r| sewn.rest_positions[r]));
                if pieces.is_empty() {
                    let message = "the line to to_m misses the panel; give points in panel coordinates (m)";
                    return Err(Error::value(format!("measure[{i}].from_m"), message));
                }
                Quantity::WavesAlong { pieces }
            }
        };
        probes.push(Probe { name: table.name.clone(), quantity, published: table.published, source: table.source.clone() });
    }
    Ok(probes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{parse, read};

    const SHEET: &str = r#"
        title = "sheet"
        material = { young_pa = 1e7, poisson = 0.3, thickness_m = 1e-4 }
        panel = [{ name = "p", shape = "rectangle", width_m = 1.0, height_m = 0.5, edge_length_m = 0.1 }]
    "#;

    fn built(more: &str) -> Result<Built> {
        build(&parse("s.toml", &format!("{SHEET}\n{more}")).unwrap())
    }

    fn message(more: &str) -> String {
        built(more).unwrap_err().to_string()
    }

    fn example(name: &str) -> Built {
        build(&read(format!("{}/../../examples/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap()).unwrap()
    }

    #[test]
    fn the_cylinder_is_rolled_without_strain_and_its_top_turned() {
        let b = example("01-twisted-cylinder.toml");
        assert!((670..=700).contains(&b.topology.vertex_count), "{} vertices", b.topology.vertex_count);
        assert_eq!(b.topology.vertex_count + b.topology.face_count(), b.topology.edge_count());
        for s in crate::strain::strain(&b.topology, &b.rest, &b.start) {
            // A chord of length l on radius 1 is shorter by l²/24, twice of which is strain; edges are at most 0.45 m long.
            assert!(s.principal.iter().all(|p| p.abs() < 0.45 * 0.45 / 12.0), "{:?}", s.principal);
        }
        let (sine, cosine) = 10_f64.to_radians().sin_cos();
        let mut held = [0, 0];
        for (start, target) in b.start.iter().zip(&b.clamps.targets) {
            assert!((start.xy().norm() - 1.0).abs() < 1e-12);
            let &[Some(x), Some(y), Some(z)] = target else {
                assert!(*target == [None; 3] && start.z > 0.0 && start.z < 5.0);
                continue;
            };
            let turned = Vec3::new(cosine * start.x - sine * start.y, sine * start.x + cosine * start.y, 5.0);
            let expected = if start.z == 0.0 { *start } else { turned };
            held[usize::from(start.z > 0.0)] += 1;
            assert!((Vec3::new(x, y, z) - expected).norm() < 1e-12);
        }
        assert_eq!(held, [26, 26]);
        assert_eq!((b.levels, b.v1, b.v2, b.panels.len()), (None, false, true, 1));
        assert_eq!(b.panels[0].faces, 0..b.topology.face_count());
        assert_eq!(b.panels[0].rest_vertices, 0..b.rest_positions.len());
    }

    #[test]
    fn the_sheets_of_the_examples_are_as_large_as_published() {
        for (name, range, end, distance) in
            [("02-stretched-sheet.toml", 500..540, 0.0, 0.00625), ("03-sheared-rectangle.toml", 970..1030, 0.128, 0.003)]
        {
            let b = example(name);
            assert!(range.contains(&b.topology.vertex_count), "{name}: {} vertices", b.topology.vertex_count);
            let moved: Vec<f64> = (0..b.start.len()).filter_map(|v| b.clamps.targets[v][0].map(|x| x - b.start[v].x)).collect();
            assert!(moved.iter().any(|d| (d - distance).abs() < 1e-15), "{name}");
            assert!(b.clamps.targets.iter().all(|t| t[0].is_some() == t[1].is_some() && t[0].is_some() == t[2].is_some()));
            assert!(b.start.iter().any(|p| p.y == end) && b.probes.len() >= 2);
        }
    }

    #[test]
    fn turns_come_before_moves_and_about_their_centre() {
        let clamp = "[[clamp]]\nside = \"p.left\"\nmove_m = [0.0, 0.0, 1.0]\nturn = { axis = [0, 0, 3], angle_deg = 90, centre_m = [0.0, 0.5, 0.0] }";
        let b = built(clamp).unwrap();
        for (start, target) in b.start.iter().zip(&b.clamps.targets).filter(|(_, t)| t[0].is_some()) {
            let expected = [0.5 - start.y, 0.5, 1.0];
            assert!((0..3).all(|axis| (target[axis].unwrap() - expected[axis]).abs() < 1e-12), "{start:?} {target:?}");
        }
        assert_eq!(b.clamps.held().iter().filter(|h| **h).count(), 6);
    }

    #[test]
    fn clamps_that_contradict_each_other_are_both_named() {
        let (left, bottom) = ("[[clamp]]\nside = \"p.left\"", "[[clamp]]\nside = \"p.bottom\"");
        let text = message(&format!("{left}\n{bottom}\nmove_m = [0.0, 0.1, 0.0]"));
        assert!(text.starts_with("s.toml, clamp[1]: \"p.bottom\" takes a vertex to y = 0.1 m"), "{text}");
        assert!(text.contains("clamp[0] \"p.left\""), "{text}");
        assert!(built(&format!("{left}\n{bottom}")).is_ok());
        assert!(built(&format!("{left}\naxes = \"xz\"\n{bottom}\naxes = \"y\"\nmove_m = [0.0, 0.1, 0.0]")).is_ok());
        // Round-off is no contradiction.
        assert!(built(&format!("{left}\n{bottom}\nmove_m = [0.0, 1e-14, 0.0]")).is_ok());
    }

    #[test]
    fn what_nothing_holds_is_told() {
        let text = message("");
        assert!(text.contains("s.toml, clamp: nothing holds the surface"), "{text}");
        let text = message("[[clamp]]\nside = \"p.left\"\naxes = \"xy\"");
        assert!(text.contains("nothing holds panel \"p\"") && text.contains("along z"), "{text}");
        let other = "[[panel]]\nname = \"q\"\nshape = \"disk\"\nradius_m = 1.0\nedge_length_m = 0.3";
        let scene = format!("{}\n{other}\n[[clamp]]\nside = \"p.left\"", table_panel());
        let text = build(&parse("s.toml", &scene).unwrap()).unwrap_err().to_string();
        assert!(text.contains("nothing holds panel \"q\"") && text.contains("along x"), "{text}");
    }

    /// The sheet with its panel as a table of its own, so that others can follow.
    fn table_panel() -> String {
        SHEET
            .replace("panel = [{", "[[panel]]\n")
            .replace("}]", "")
            .replace(", shape", "\nshape")
            .replace(", width_m", "\nwidth_m")
            .replace(", height_m", "\nheight_m")
            .replace(", edge_length_m", "\nedge_length_m")
    }

    #[test]
    fn sewn_sides_must_start_at_one_place() {
        let second = |x: f64| {
            format!(
                "{}\nplace = {{ kind = \"flat\", origin_m = [{x}, 0, 0] }}\n[[seam]]\na = \"p.right\"\nb = \"q.left\"\nreversed = true\n[[clamp]]\nside = \"p.left\"",
                table_panel() + &table_panel()[table_panel().find("[[panel]]").unwrap()..].replace("\"p\"", "\"q\"")
            )
        };
        let build_at = |x| build(&parse("s.toml", &second(x)).unwrap());
        let b = build_at(1.0).unwrap();
        assert_eq!((b.topology.vertex_count, b.panels[1].name.as_str()), (b.rest_positions.len() - 6, "q"));
        assert_eq!(b.start.iter().map(|p| p.x).fold(0.0, f64::max), 2.0);
        assert!(build_at(1.0 + 1e-8).is_ok());
        let text = build_at(1.1).unwrap_err().to_string();
        assert!(text.contains("s.toml, seam[0]: \"p.right\" and \"q.left\" start 1.000e-1 m apart"), "{text}");
    }

    #[test]
    fn a_reversed_closed_side_keeps_its_first_vertex() {
        let text = r#"
            title = "mirrored"
            material = { young_pa = 1e7, poisson = 0.3, thickness_m = 1e-4 }
            panel = [
                { name = "a", shape = "annulus", inner_radius_m = 0.5, outer_radius_m = 1.0, edge_length_m = 0.2 },
                { name = "b", shape = "disk", radius_m = 0.5, edge_length_m = 0.2, place = { kind = "flat", y_axis = [0, -1, 0] } },
            ]
            seam = [{ a = "a.inner", b = "b.rim", reversed = true }]
            clamp = [{ side = "a.outer" }]"#;
        let b = build(&parse("s.toml", text).unwrap()).unwrap();
        assert_eq!(b.topology.vertex_count + b.topology.face_count(), b.topology.edge_count() + 1);
        let apart = build(&parse("s.toml", &text.replace("true", "false")).unwrap()).unwrap_err().to_string();
        assert!(apart.contains("seam[0]"), "{apart}");
    }

    #[test]
    fn options_arrive() {
        let clamp = "[[clamp]]\nside = \"p.left\"\n";
        let b = built(clamp).unwrap();
        assert_eq!((b.base.iteration_limit, b.field.rule), (BaseOptions::default().iteration_limit, FieldOptions::default().rule));
        let more = "[base]\ncompressive_stiffness = 0.25\niteration_limit = 7\n[field]\nwrinkle_free = \"published\"\n\
            without = [\"v1\", \"mixed\", \"relaxed-integrability\"]\ncurvature_rings = 2\niteration_limit = 9\n\
            [surface]\nlevels = 3\nv1 = true\nv2 = false\n";
        let b = built(&format!("{clamp}{more}")).unwrap();
        assert_eq!((b.base.compressive_stiffness, b.base.iteration_limit), (0.25, 7));
        assert_eq!((b.field.rule, b.field.curvature_rings, b.field.iteration_limit), (WrinkleFreeRule::Published, 2, 9));
        assert!(!b.field.terms.v1 && !b.field.terms.mixed && b.field.terms.v2 && !b.field.relaxed_integrability);
        assert_eq!((b.levels, b.v1, b.v2), (Some(3), true, false));
        assert_eq!(b.material, Material::new(1e7, 0.3, 1e-4).unwrap());
    }

    #[test]
    fn lines_beside_their_panel_and_panels_too_fine_are_told() {
        let line = |y: f64| {
            format!(
                "[[clamp]]\nside = \"p.left\"\n[[measure]]\nname = \"m\"\nkind = \"waves_along\"\npanel = \"p\"\nfrom_m = [0, {y}]\nto_m = [1, {y}]"
            )
        };
        assert!(built(&line(0.5)).is_ok() && built(&line(0.0)).is_ok());
        let text = message(&line(0.6));
        assert!(text.contains("s.toml, measure[0].from_m: the line to to_m misses the panel"), "{text}");
        let fine = SHEET.replace("edge_length_m = 0.1", "edge_length_m = 1e-5");
        let text = build(&parse("s.toml", &fine).unwrap()).unwrap_err().to_string();
        assert!(text.starts_with("s.toml, panel[0].edge_length_m"), "{text}");
    }
}
