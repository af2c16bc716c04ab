//! `[mesh]`: a surface from files. A garment as pattern programs export it, worn in space with flat
//! pieces as its rest shape; or any mesh that rests where it starts, with what was painted on its
//! vertices.

use std::path::Path;

use super::placed::PlacedSurface;
use super::schema::{MeshTable, Scene};
use super::value::{not_blank_path, positive};
use crate::io::garment::{self, RestSource};
use crate::io::{obj, ply_mesh};
use crate::mesh::check::{check_rest_faces, weld};
use crate::mesh::{Chart, RestShape, Topology, Vec3};
use crate::{At, Error, Result};

/// Checks that need no file.
pub(super) fn check(table: &MeshTable) -> Result<()> {
    positive("mesh.metres_per_unit", table.metres_per_unit)?;
    match (&table.start, &table.worn) {
        (Some(start), None) => {
            for (name, given) in
                [("rest", table.rest.is_some()), ("metres_per_uv", table.metres_per_uv.is_some())]
            {
                if given {
                    return Err(Error::value(
                        format!("mesh.{name}"),
                        "start is at rest where it starts; remove this, or give worn instead",
                    ));
                }
            }
            return not_blank_path("mesh.start", start);
        }
        (None, Some(worn)) => not_blank_path("mesh.worn", worn)?,
        (None, None) => {
            return Err(Error::value(
                "mesh",
                "this names no file; give start (a mesh at rest), or worn (a garment) with its \
                 rest shape",
            ));
        }
        (Some(_), Some(_)) => {
            return Err(Error::value(
                "mesh.worn",
                "start is the start pose already; remove one of them",
            ));
        }
    }
    match (&table.rest, table.metres_per_uv) {
        (Some(rest), None) => not_blank_path("mesh.rest", rest),
        (None, Some(length)) => positive("mesh.metres_per_uv", length).map(|_| ()),
        (None, None) => {
            let message = "this is missing; give the rest shape as an OBJ file (rest), or the \
                length of one unit of texture (metres_per_uv)";
            Err(Error::value("mesh.metres_per_uv", message))
        }
        (Some(_), Some(_)) => Err(Error::value(
            "mesh.metres_per_uv",
            "the rest shape comes from rest, not from texture; remove one of them",
        )),
    }
}

/// The surface, read from its files.
pub(super) fn place_surface(scene: &Scene, table: &MeshTable) -> Result<PlacedSurface> {
    let Some(worn_path) = &table.worn else {
        let path = scene.beside(table.start.as_deref().unwrap_or(&scene.file));
        return place_start(&path, table.metres_per_unit).at("mesh.start");
    };
    let rest_path = table.rest.as_deref().map(|rest| scene.beside(rest));
    let rest = match &rest_path {
        Some(path) => RestSource::File(path),
        None => RestSource::Texture { metres_per_uv: table.metres_per_uv.unwrap_or(1.0) },
    };
    let worn_path = scene.beside(worn_path);
    let garment = garment::read(&worn_path, rest, table.metres_per_unit).map_err(|error| {
        let is_rest =
            matches!(&error, Error::File { path, .. } if Some(path) == rest_path.as_ref());
        error.at(if is_rest { "mesh.rest" } else { "mesh.worn" })
    })?;
    Ok(PlacedSurface {
        topology: garment.topology,
        rest_shape: garment.rest_shape,
        start: garment.positions,
        vertex_of_rest: Vec::new(),
        panels: Vec::new(),
        sides: Vec::new(),
        chart: None,
        texture: garment.texture,
        attributes: garment.colours.map_or_else(Vec::new, |colours| attributes_of(&colours)),
        notes: garment.notes,
    })
}

/// Vertex colours (`[V]`) as attributes.
fn attributes_of(colours: &[[f64; 3]]) -> Vec<(String, Vec<f64>)> {
    let channel = |(c, name): (usize, &str)| {
        (name.to_owned(), colours.iter().map(|colour| colour[c]).collect())
    };
    ["red", "green", "blue"].into_iter().enumerate().map(channel).collect()
}

/// The content of a file of either format.
struct Start {
    positions: Vec<Vec3>,
    faces: Vec<[usize; 3]>,
    texture: Option<Chart>,
    attributes: Vec<(String, Vec<f64>)>,
    warnings: Vec<String>,
    cut: usize,
}

fn read_start(path: &Path) -> Result<Start> {
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("ply")) {
        let mesh = ply_mesh::read(path)?;
        let texture = mesh.texture.map(|points| Chart { points, faces: mesh.faces.clone() });
        let (positions, faces, attributes) = (mesh.positions, mesh.faces, mesh.attributes);
        return Ok(Start {
            positions,
            faces,
            texture,
            attributes,
            warnings: Vec::new(),
            cut: mesh.cut,
        });
    }
    let mesh = obj::read(path)?;
    Ok(Start {
        positions: mesh.positions,
        faces: mesh.faces,
        texture: mesh.texture_faces.map(|faces| Chart { points: mesh.texture_coordinates, faces }),
        attributes: mesh.colours.map_or_else(Vec::new, |colours| attributes_of(&colours)),
        warnings: mesh.warnings,
        cut: mesh.cuts.len(),
    })
}

/// The mesh at `path`, at rest where it is.
fn place_start(path: &Path, metres_per_unit: f64) -> Result<PlacedSurface> {
    let name = path.display().to_string();
    let start = read_start(path)?;
    check_rest_faces(&start.positions, &start.faces).at(&name)?;
    let welded = weld(&start.positions, &start.faces);
    let topology = Topology::new(welded.positions.len(), welded.faces).at(&name)?;
    let positions: Vec<Vec3> = welded.positions.iter().map(|p| p * metres_per_unit).collect();
    let attributes = start.attributes.into_iter().map(|(name, own)| {
        // Where several became one, the last one's.
        let mut values = vec![0.0; positions.len()];
        own.iter().zip(&welded.vertex_of_input).for_each(|(value, &v)| values[v] = *value);
        (name, values)
    });
    let mut notes: Vec<String> = start.warnings.iter().map(|w| format!("{name}: {w}")).collect();
    let merged = start.positions.len() - positions.len();
    if merged > 0 {
        notes.push(format!("{merged} vertices of {name} at the same place as others were welded"));
    }
    if start.cut > 0 {
        notes.push(format!("{} polygons of {name} were cut into triangles", start.cut));
    }
    Ok(PlacedSurface {
        attributes: attributes.collect(),
        rest_shape: RestShape { positions: positions.clone(), faces: topology.faces.clone() },
        start: positions,
        topology,
        vertex_of_rest: Vec::new(),
        panels: Vec::new(),
        sides: Vec::new(),
        chart: None,
        texture: start.texture,
        notes,
    })
}

#[cfg(test)]
mod tests {
    use std::fmt::Write as _;
    use std::path::PathBuf;

    use super::*;
    use crate::mesh::Vec3;
    use crate::scene::{BuiltScene, build, parse};

    /// A tube as a pattern program exports it: a flat strip, worn around the z axis with a slit of
    /// double vertices. Centimetres.
    struct Tube {
        folder: PathBuf,
    }

    impl Tube {
        /// `inwards`: with all faces turned.
        fn new(test: &str, inwards: bool) -> Self {
            let folder =
                std::env::temp_dir().join(format!("plisse-garment-{test}-{}", std::process::id()));
            std::fs::create_dir_all(&folder).unwrap();
            let (mut worn, mut flat, mut faces) = (String::new(), String::new(), String::new());
            for j in 0..=4 {
                for i in 0..=12 {
                    let (sine, cosine) = if i == 12 {
                        (0.0, 1.0)
                    } else {
                        (f64::from(i) * std::f64::consts::TAU / 12.0).sin_cos()
                    };
                    writeln!(
                        worn,
                        "v {} {} {}\nvt {} {}",
                        10.0 * cosine,
                        10.0 * sine,
                        5 * j,
                        0.05 * f64::from(i),
                        0.05 * f64::from(j)
                    )
                    .unwrap();
                    writeln!(flat, "v {} {} 0", 5 * i, 5 * j).unwrap();
                }
            }
            for j in 0..4 {
                for i in 0..12 {
                    let a = 1 + i + 13 * j;
                    let (b, c, d) = (a + 1, a + 14, a + 13);
                    for [x, y, z] in [[a, b, c], [a, c, d]] {
                        let [y, z] = if inwards { [z, y] } else { [y, z] };
                        writeln!(faces, "f {x}/{x} {y}/{y} {z}/{z}").unwrap();
                    }
                }
            }
            std::fs::write(folder.join("worn.obj"), format!("{worn}{faces}")).unwrap();
            let plain: String = faces
                .lines()
                .map(|f| {
                    f.split(' ').map(|c| c.split('/').next().unwrap()).collect::<Vec<_>>().join(" ")
                        + "\n"
                })
                .collect();
            std::fs::write(folder.join("flat.obj"), format!("{flat}{plain}")).unwrap();
            Self { folder }
        }

        fn built(&self, mesh: &str, more: &str) -> Result<BuiltScene> {
            let text = format!(
                "title = \"t\"\n[material]\nyoung_pa = 1e6\npoisson = 0.3\nthickness_m = \
                 1e-3\ndensity_kg_m3 = 400\n\
                 [mesh]\nworn = \"worn.obj\"\n{mesh}\n{more}"
            );
            build(&parse(self.folder.join("s.toml"), &text)?)
        }

        fn message(&self, mesh: &str, more: &str) -> String {
            self.built(mesh, more).unwrap_err().to_string()
        }
    }

    impl Drop for Tube {
        fn drop(&mut self) {
            let _ = std::fs::remove_dir_all(&self.folder);
        }
    }

    const CLAMP: &str = "[[clamp]]\nwithin_m = { low = [-1, -1, 0], high = [1, 1, 0] }";
    const FLAT: &str = "rest = \"flat.obj\"\nmetres_per_unit = 0.01";

    #[test]
    fn a_garment_is_welded_and_has_the_rest_metric_of_its_pieces() {
        let tube = Tube::new("welded", false);
        let flat = tube.built(FLAT, CLAMP).unwrap();
        assert_eq!(
            (
                flat.sheet.topology.vertex_count,
                flat.sheet.rest_shape.positions.len(),
                flat.panels.len()
            ),
            (60, 65, 0)
        );
        assert_eq!(
            flat.sheet.topology.vertex_count + flat.sheet.topology.face_count(),
            flat.sheet.topology.edge_count()
        );
        assert!(
            (flat.sheet.rest.area_m2() - 0.6 * 0.2).abs() < 1e-12,
            "{}",
            flat.sheet.rest.area_m2()
        );
        assert!(
            flat.sheet.rest.faces.iter().all(|f| (f.area_m2 - 0.5 * 0.05 * 0.05).abs() < 1e-12)
        );
        assert!((flat.start[0] - Vec3::new(0.1, 0.0, 0.0)).norm() < 1e-15);
        assert_eq!(flat.clamps.held().iter().filter(|h| **h).count(), 12);
        assert!(
            flat.texture.is_some() && flat.notes[0].contains("5 vertices of"),
            "{:?}",
            flat.notes
        );
        // One unit of texture is a metre: the same strip.
        let textured = tube.built("metres_per_uv = 1.0\nmetres_per_unit = 0.01", CLAMP).unwrap();
        for (a, b) in flat.sheet.rest.faces.iter().zip(&textured.sheet.rest.faces) {
            assert!(
                (a.inverse_root - b.inverse_root).norm() < 1e-9
                    && (a.area_m2 - b.area_m2).abs() < 1e-12
            );
        }
        assert_eq!(flat.start, textured.start);
    }

    #[test]
    fn what_a_mesh_does_not_have_is_told() {
        let tube = Tube::new("told", false);
        let text = tube.message("", CLAMP);
        assert!(text.contains("s.toml, mesh.metres_per_uv: this is missing"), "{text}");
        assert!(
            tube.message("rest = \"flat.obj\"\nmetres_per_uv = 1.0", CLAMP)
                .contains("remove one of them")
        );
        assert!(tube.message("rest = \"\"", CLAMP).contains("mesh.rest: this is empty"));
        assert!(
            tube.message("metres_per_uv = 0.0", CLAMP)
                .contains("mesh.metres_per_uv: 0 is no usable length")
        );
        assert!(
            tube.message("rest = \"flat.obj\"\nmetres_per_unit = -1", CLAMP)
                .contains("mesh.metres_per_unit: -1")
        );
        let text = tube.message("rest = \"none.obj\"", CLAMP);
        assert!(
            text.contains("s.toml, mesh.rest: ")
                && text.contains("none.obj")
                && text.contains("spelling"),
            "{text}"
        );
        let text = tube.message(FLAT, "[[clamp]]\nside = \"a.left\"");
        assert!(
            text.contains("clamp[0].side: a mesh has no sides; use near_m or within_m"),
            "{text}"
        );
        let text = tube.message(FLAT, "[[seam]]\na = \"a.b\"\nb = \"c.d\"");
        assert!(text.contains("seam: a mesh is sewn already"), "{text}");
        let text = tube.message(
            FLAT,
            &format!(
                "{CLAMP}\n[[measure]]\nname = \"m\"\nkind = \"waves_along\"\npanel = \
                \"p\"\nfrom_m = [0, 0]\nto_m = [1, 1]"
            ),
        );
        assert!(text.contains("measure[0].panel: a mesh has no panels"), "{text}");
        let panel =
            "[[panel]]\nname = \"p\"\nshape = \"disk\"\nradius_m = 1.0\nedge_length_m = 0.3";
        assert!(
            tube.message(FLAT, panel)
                .contains("s.toml, mesh: the scene has panels and a mesh; keep one of them")
        );
        let text = tube.message(FLAT, &format!("{CLAMP}\n[load]\npressure_pa = 1"));
        assert!(text.contains("load.pressure_pa: the surface is open near [0.0"), "{text}");
        let text = tube.message(FLAT, "[load]\ngravity_m_s2 = [0, 0, -9.81]");
        assert!(
            text.contains(
                "clamp: nothing holds the mesh (or its first part) along z against its weight"
            ),
            "{text}"
        );
        std::fs::write(tube.folder.join("flat.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
            .unwrap();
        assert!(tube.message(FLAT, CLAMP).contains("flat.obj: it has 1 triangles, but"));
    }

    #[test]
    fn a_start_is_at_rest_and_keeps_what_is_painted_on_it() {
        let tube = Tube::new("start", false);
        let built = |mesh: &str| {
            let text = format!(
                "title = \"t\"\nmaterial = {{ young_pa = 1e6, poisson = 0.3, thickness_m = 1e-3 \
                 }}\n[mesh]\n{mesh}\n{CLAMP}"
            );
            build(&parse(tube.folder.join("s.toml"), &text)?)
        };
        let b = built("start = \"worn.obj\"\nmetres_per_unit = 0.01").unwrap();
        assert_eq!((b.sheet.topology.vertex_count, &b.start), (60, &b.sheet.rest_shape.positions));
        assert!(b.texture.is_some() && b.notes[0].contains("5 vertices of"));
        for strain in crate::strain::strain(&b.sheet.topology, &b.sheet.rest, &b.start) {
            assert!(strain.principal.iter().all(|p| p.abs() < 1e-12));
        }
        let colours = "v 0 0 0 0.5 1 0\nv 1 0 0 0.25 0 0\nv 0 1 0 1 0.125 0\nf 1 2 3\n";
        std::fs::write(tube.folder.join("a.obj"), colours).unwrap();
        let placed = place_start(&tube.folder.join("a.obj"), 2.0).unwrap();
        assert_eq!(
            (placed.attributes.len(), &placed.attributes[0].1, placed.start[1].x),
            (3, &vec![0.5, 0.25, 1.0], 2.0)
        );
        std::fs::write(tube.folder.join("a.obj"), colours.replace("0 1 0 1 0.125 0", "0 1 0 1"))
            .unwrap();
        assert!(place_start(&tube.folder.join("a.obj"), 2.0).unwrap().attributes.is_empty());
        let refused = |mesh: &str| built(mesh).unwrap_err().to_string();
        assert!(refused("metres_per_unit = 1").contains("s.toml, mesh: this names no file"));
        assert!(
            refused("start = \"a.obj\"\nworn = \"a.obj\"")
                .contains("mesh.worn: start is the start pose already")
        );
        assert!(
            refused("start = \"a.obj\"\nrest = \"a.obj\"")
                .contains("mesh.rest: start is at rest where it starts")
        );
        assert!(
            refused("start = \"none.ply\"").contains("s.toml, mesh.start: ")
                && refused("start = \" \"").contains("mesh.start: this is empty")
        );
    }

    #[test]
    fn a_closed_mesh_under_pressure_has_its_outside_outside() {
        let tetrahedron = |test: &str, faces: &str| {
            let tube = Tube::new(test, true);
            std::fs::write(
                tube.folder.join("worn.obj"),
                format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n{faces}"),
            )
            .unwrap();
            tube.built("rest = \"worn.obj\"", "[load]\npressure_pa = 5").unwrap()
        };
        let outside = tetrahedron("outside", "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
        let inside = tetrahedron("inside", "f 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n");
        for built in [outside, inside] {
            let volume: f64 = built
                .sheet
                .topology
                .faces
                .iter()
                .map(|f| built.start[f[0]].dot(&built.start[f[1]].cross(&built.start[f[2]])) / 6.0)
                .sum();
            assert!((volume - 1.0 / 6.0).abs() < 1e-15, "{volume}");
            assert_eq!(built.sheet.topology.faces, built.sheet.rest_shape.faces);
            assert_eq!(
                (built.loads.pressure_pa, built.clamps.held().contains(&true)),
                (5.0, false)
            );
        }
    }
}
