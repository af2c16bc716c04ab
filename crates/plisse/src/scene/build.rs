//! From a scene to what the solvers take: panels are cut and sewn (or a mesh is read), placed into
//! space, held and pushed.

use super::placed::{PlacedPanel, PlacedSurface};
use super::probe::{self, Probe};
use super::schema::Scene;
use super::{bodies, garment, hold, maps, options, panels};
use crate::field::{FieldOptions, WrinkleField};
use crate::mesh::islands::panel_texture;
use crate::mesh::{Chart, Vec3};
use crate::obstacle::Obstacle;
use crate::rest::RestMetric;
use crate::sheet::Sheet;
use crate::shell::{BaseOptions, Clamps, Loads, Setup};
use crate::wrinkles::{PosedField, SurfaceOptions};
use crate::{At, Result};

/// Thickness of contact if the scene gives none, relative to the size of the start pose.
const CONTACT_THICKNESS: f64 = 1e-3;

/// Distance that wrinkles keep from a scene's bodies, in contact thicknesses.
const CLEARANCE: f64 = 0.25;

/// A scene made ready for the solvers. V vertices, F faces, R ≥ V rest vertices.
#[derive(Clone, Debug)]
pub struct BuiltScene {
    /// Name of the scene.
    pub title: String,
    /// Published results, in words; may be empty.
    pub paper: String,
    /// The sewn sheet. Its rest shape has the panels one after the other, each in its own plane z =
    /// 0 (or around its own origin, if it is closed), or is that of a mesh; its rest metric is
    /// grown, if the scene grows.
    pub sheet: Sheet,
    /// `[V]` start pose (m), before the clamps move.
    pub start: Vec<Vec3>,
    /// Targets of the held coordinates.
    pub clamps: Clamps,
    /// Loads. Faces of a closed part under pressure whose start has a volume are oriented outwards.
    pub loads: Loads,
    /// Bodies that the surface may not enter, in the scene's order.
    pub obstacles: Vec<Obstacle>,
    /// Distance to obstacles (m) below which contact pushes back.
    pub contact_thickness_m: f64,
    /// Options of the base solve.
    pub base_options: BaseOptions,
    /// Options of the field's solve.
    pub field_options: FieldOptions,
    /// Options of the wrinkled surface.
    pub surface_options: SurfaceOptions,
    /// Measures, for [`super::measure`](fn@super::measure).
    pub probes: Vec<Probe>,
    /// The panels, in the scene's order; none if the scene has a mesh.
    pub panels: Vec<PlacedPanel>,
    /// Texture coordinates (v up), if the mesh's files gave them or some panel is closed.
    pub texture: Option<Chart>,
    /// Notes of the readers of files on what they skipped or fixed, a sentence each.
    pub notes: Vec<String>,
}

impl BuiltScene {
    /// The input of the base solve and the reference shell.
    pub fn setup(&self) -> Setup<'_> {
        Setup {
            sheet: &self.sheet,
            clamps: &self.clamps,
            loads: self.loads.clone(),
            obstacles: &self.obstacles,
            contact_thickness_m: self.contact_thickness_m,
            contact_pressure_pa: 0.0,
        }
    }

    /// The wrinkle field `field` on the scene's sheet in `pose` (`[V]`, m), to be displaced and
    /// written.
    pub fn posed_field<'a>(&'a self, pose: &'a [Vec3], field: &'a WrinkleField) -> PosedField<'a> {
        PosedField {
            sheet: &self.sheet,
            pose,
            field,
            options: self.surface_options,
            obstacles: &self.obstacles,
            clearance_m: CLEARANCE * self.contact_thickness_m,
            texture: self.texture(),
        }
    }

    /// Texture coordinates (v up): of the mesh's files, else flat panels side by side.
    pub fn texture(&self) -> Option<Chart> {
        self.texture.clone().or_else(|| panel_texture(&self.sheet.rest_shape))
    }
}

/// The scene ready for the solvers. The same scene gives the same result.
///
/// # Errors
/// [`Error::Value`] whose field is "file, dotted.field" for: a panel that cannot be cut (see
/// [`Panel::new`]), sewn sides that do not start at the same place, a file that cannot be opened, a
/// box without vertices, pressure in an open surface, clamps that contradict each other, a surface
/// or a part of it that nothing holds in some direction, a measure whose line misses its panel.
/// [`Error::Mesh`] with the file for what [`sew`], [`garment::read`] or [`Obstacle::mesh`] refuses,
/// [`Error::Parse`] for a file that is no OBJ file.
///
/// [`Error::Value`]: crate::Error::Value
/// [`Error::Mesh`]: crate::Error::Mesh
/// [`Error::Parse`]: crate::Error::Parse
/// [`Panel::new`]: crate::mesh::panel::Panel::new
/// [`sew`]: crate::mesh::sew::sew
/// [`garment::read`]: crate::io::garment::read
pub fn build(scene: &Scene) -> Result<BuiltScene> {
    build_unplaced(scene).at(&scene.file)
}

fn build_unplaced(scene: &Scene) -> Result<BuiltScene> {
    let placed = place_surface(scene)?;
    let mut rest = RestMetric::from_shape(&placed.rest_shape.positions, &placed.rest_shape.faces)
        .at(&scene.file)?;
    if let Some(table) = &scene.growth {
        rest = maps::expansion(scene, table, &placed)?.act_on(
            &placed.topology,
            &placed.start,
            &rest,
        )?;
    }
    let clamps = hold::clamps(scene, &placed)?;
    let loads = hold::loads(scene, &placed)?;
    hold::check_held(scene, &placed, &rest, &clamps, &loads)?;
    assemble(scene, placed, rest, clamps, loads)
}

/// The surface in space.
pub(super) fn place_surface(scene: &Scene) -> Result<PlacedSurface> {
    let mut placed = match &scene.mesh {
        Some(table) => garment::place_surface(scene, table)?,
        None => panels::place_surface(scene)?,
    };
    if scene.load.pressure_pa != 0.0 {
        placed.check_closed()?;
        placed.turn_outside_out(&scene.file.display().to_string())?;
    }
    Ok(placed)
}

/// All that is left to make of the scene.
pub(super) fn assemble(
    scene: &Scene,
    placed: PlacedSurface,
    rest: RestMetric,
    clamps: Clamps,
    loads: Loads,
) -> Result<BuiltScene> {
    let field_options = options::field_options(scene)?;
    Ok(BuiltScene {
        title: scene.title.clone(),
        paper: scene.paper.clone(),
        clamps,
        loads,
        obstacles: bodies::obstacles(scene)?,
        contact_thickness_m: scene
            .contact
            .thickness_m
            .unwrap_or_else(|| CONTACT_THICKNESS * placed.size()),
        base_options: options::base_options(scene),
        surface_options: options::surface_options(scene, &field_options),
        field_options,
        probes: probe::probes(scene, &placed)?,
        sheet: Sheet {
            topology: placed.topology,
            rest_shape: placed.rest_shape,
            rest,
            material: options::material(scene)?,
        },
        start: placed.start,
        panels: placed.panels,
        texture: placed.texture,
        notes: placed.notes,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::WrinkleFreeRule;
    use crate::material::Material;
    use crate::scene::{parse, read};

    const SHEET: &str = concat!(
        r#"
        title = "sheet"
        material = { young_pa = 1e7, poisson = 0.3, thickness_m = 1e-4 }
        panel = [{ name = "p", shape = "rectangle", width_m = 1.0, height_m = 0.5, "#,
        r#"edge_length_m = 0.1 }]
    "#
    );

    fn built(more: &str) -> Result<BuiltScene> {
        build(&parse("s.toml", &format!("{SHEET}\n{more}")).unwrap())
    }

    fn message(more: &str) -> String {
        built(more).unwrap_err().to_string()
    }

    fn example(name: &str) -> BuiltScene {
        build(&read(format!("{}/../../examples/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap())
            .unwrap()
    }

    #[test]
    fn the_cylinder_is_rolled_without_strain_and_its_top_turned() {
        let b = example("01-twisted-cylinder.toml");
        assert!(
            (670..=700).contains(&b.sheet.topology.vertex_count),
            "{} vertices",
            b.sheet.topology.vertex_count
        );
        assert_eq!(
            b.sheet.topology.vertex_count + b.sheet.topology.face_count(),
            b.sheet.topology.edge_count()
        );
        for s in crate::strain::strain(&b.sheet.topology, &b.sheet.rest, &b.start) {
            // A chord of length l on radius 1 is shorter by l²/24, twice of which is strain; edges
            // are at most 0.45 m long.
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
            let turned = Vec3::new(
                cosine * start.x - sine * start.y,
                sine * start.x + cosine * start.y,
                5.0,
            );
            let expected = if start.z == 0.0 { *start } else { turned };
            held[usize::from(start.z > 0.0)] += 1;
            assert!((Vec3::new(x, y, z) - expected).norm() < 1e-12);
        }
        assert_eq!(held, [26, 26]);
        assert_eq!((b.surface_options, b.panels.len()), (SurfaceOptions::default(), 1));
        assert_eq!(b.panels[0].faces, 0..b.sheet.topology.face_count());
        assert_eq!(b.panels[0].rest_vertices, 0..b.sheet.rest_shape.positions.len());
    }

    #[test]
    fn the_sheets_of_the_examples_are_as_large_as_published() {
        for (name, range, end, distance) in [
            ("02-stretched-sheet.toml", 500..540, 0.0, 0.00625),
            ("03-sheared-rectangle.toml", 970..1030, 0.128, 0.003),
        ] {
            let b = example(name);
            assert!(
                range.contains(&b.sheet.topology.vertex_count),
                "{name}: {} vertices",
                b.sheet.topology.vertex_count
            );
            let moved: Vec<f64> = (0..b.start.len())
                .filter_map(|v| b.clamps.targets[v][0].map(|x| x - b.start[v].x))
                .collect();
            assert!(moved.iter().any(|d| (d - distance).abs() < 1e-15), "{name}");
            assert!(
                b.clamps
                    .targets
                    .iter()
                    .all(|t| t[0].is_some() == t[1].is_some() && t[0].is_some() == t[2].is_some())
            );
            assert!(b.start.iter().any(|p| p.y == end) && b.probes.len() >= 2);
        }
    }

    #[test]
    fn turns_come_before_moves_and_about_their_centre() {
        let clamp = "[[clamp]]\nside = \"p.left\"\nmove_m = [0.0, 0.0, 1.0]\nturn = \
            { axis = [0, 0, 3], angle_deg = 90, centre_m = [0.0, 0.5, 0.0] }";
        let b = built(clamp).unwrap();
        for (start, target) in b.start.iter().zip(&b.clamps.targets).filter(|(_, t)| t[0].is_some())
        {
            let expected = [0.5 - start.y, 0.5, 1.0];
            assert!(
                (0..3).all(|axis| (target[axis].unwrap() - expected[axis]).abs() < 1e-12),
                "{start:?} {target:?}"
            );
        }
        assert_eq!(b.clamps.held().iter().filter(|h| **h).count(), 6);
    }

    #[test]
    fn clamps_that_contradict_each_other_are_both_named() {
        let (left, bottom) = ("[[clamp]]\nside = \"p.left\"", "[[clamp]]\nside = \"p.bottom\"");
        let text = message(&format!("{left}\n{bottom}\nmove_m = [0.0, 0.1, 0.0]"));
        assert!(
            text.starts_with("s.toml, clamp[1]: \"p.bottom\" takes a vertex to y = 0.1 m"),
            "{text}"
        );
        assert!(text.contains("clamp[0] \"p.left\""), "{text}");
        assert!(built(&format!("{left}\n{bottom}")).is_ok());
        assert!(
            built(&format!(
                "{left}\naxes = \"xz\"\n{bottom}\naxes = \"y\"\nmove_m = [0.0, 0.1, 0.0]"
            ))
            .is_ok()
        );
        // Round-off is no contradiction.
        assert!(built(&format!("{left}\n{bottom}\nmove_m = [0.0, 1e-14, 0.0]")).is_ok());
    }

    #[test]
    fn what_nothing_holds_is_told() {
        let text = message("");
        assert!(text.contains("s.toml, clamp: nothing holds the surface"), "{text}");
        let text = message("[[clamp]]\nside = \"p.left\"\naxes = \"xy\"");
        assert!(text.contains("nothing holds panel \"p\"") && text.contains("along z"), "{text}");
        let other =
            "[[panel]]\nname = \"q\"\nshape = \"disk\"\nradius_m = 1.0\nedge_length_m = 0.3";
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
                "{}\nplace = {{ kind = \"flat\", origin_m = [{x}, 0, 0] }}\n[[seam]]\na = \
                 \"p.right\"\nb = \"q.left\"\nreversed = true\n[[clamp]]\nside = \"p.left\"",
                table_panel()
                    + &table_panel()[table_panel().find("[[panel]]").unwrap()..]
                        .replace("\"p\"", "\"q\"")
            )
        };
        let build_at = |x| build(&parse("s.toml", &second(x)).unwrap());
        let b = build_at(1.0).unwrap();
        assert_eq!(
            (b.sheet.topology.vertex_count, b.panels[1].name.as_str()),
            (b.sheet.rest_shape.positions.len() - 6, "q")
        );
        assert_eq!(b.start.iter().map(|p| p.x).fold(0.0, f64::max), 2.0);
        assert!(build_at(1.0 + 1e-8).is_ok());
        let text = build_at(1.1).unwrap_err().to_string();
        assert!(
            text.contains("s.toml, seam[0]: \"p.right\" and \"q.left\" start 1.000e-1 m apart"),
            "{text}"
        );
    }

    #[test]
    fn a_reversed_closed_side_keeps_its_first_vertex() {
        let text = concat!(
            r#"
            title = "mirrored"
            material = { young_pa = 1e7, poisson = 0.3, thickness_m = 1e-4 }
            panel = [
                { name = "a", shape = "annulus", inner_radius_m = 0.5, outer_radius_m = 1.0, "#,
            r#"edge_length_m = 0.2 },
                { name = "b", shape = "disk", radius_m = 0.5, edge_length_m = 0.2, "#,
            r#"place = { kind = "flat", y_axis = [0, -1, 0] } },
            ]
            seam = [{ a = "a.inner", b = "b.rim", reversed = true }]
            clamp = [{ side = "a.outer" }]"#
        );
        let b = build(&parse("s.toml", text).unwrap()).unwrap();
        assert_eq!(
            b.sheet.topology.vertex_count + b.sheet.topology.face_count(),
            b.sheet.topology.edge_count() + 1
        );
        let apart = build(&parse("s.toml", &text.replace("true", "false")).unwrap())
            .unwrap_err()
            .to_string();
        assert!(apart.contains("seam[0]"), "{apart}");
    }

    #[test]
    fn options_arrive() {
        let clamp = "[[clamp]]\nside = \"p.left\"\n";
        let b = built(clamp).unwrap();
        assert_eq!(
            (b.base_options.iteration_limit, b.field_options.rule),
            (BaseOptions::default().iteration_limit, FieldOptions::default().rule)
        );
        let more = "[base]\ncompressive_stiffness = 0.25\niteration_limit = \
            7\n[field]\nwrinkle_free = \"published\"\n\
            without = [\"v1\", \"mixed\", \"relaxed-integrability\"]\ncurvature_rings = \
            2\niteration_limit = 9\n\
            [surface]\nlevels = 3\nv1 = true\nv2 = false\n";
        let b = built(&format!("{clamp}{more}")).unwrap();
        assert_eq!(
            (b.base_options.compressive_stiffness, b.base_options.iteration_limit),
            (0.25, 7)
        );
        assert_eq!(
            (
                b.field_options.rule,
                b.field_options.curvature_rings,
                b.field_options.iteration_limit
            ),
            (WrinkleFreeRule::Published, 2, 9)
        );
        assert!(
            !b.field_options.terms.v1
                && !b.field_options.terms.mixed
                && b.field_options.terms.v2
                && !b.field_options.relaxed_integrability
        );
        let expected = SurfaceOptions { levels: Some(3), v1: true, v2: false, curvature_rings: 2 };
        assert_eq!(b.surface_options, expected);
        assert_eq!(b.sheet.material, Material::new(1e7, 0.3, 1e-4).unwrap());
    }

    #[test]
    fn lines_beside_their_panel_and_panels_too_fine_are_told() {
        let line = |y: f64| {
            format!(
                "[[clamp]]\nside = \"p.left\"\n[[measure]]\nname = \"m\"\nkind = \
                 \"waves_along\"\npanel = \"p\"\nfrom_m = [0, {y}]\nto_m = [1, {y}]"
            )
        };
        assert!(built(&line(0.5)).is_ok() && built(&line(0.0)).is_ok());
        let text = message(&line(0.6));
        assert!(
            text.contains("s.toml, measure[0].from_m: the line to to_m misses the panel"),
            "{text}"
        );
        let fine = SHEET.replace("edge_length_m = 0.1", "edge_length_m = 1e-5");
        let text = build(&parse("s.toml", &fine).unwrap()).unwrap_err().to_string();
        assert!(text.starts_with("s.toml, panel[0].edge_length_m"), "{text}");
    }
}
