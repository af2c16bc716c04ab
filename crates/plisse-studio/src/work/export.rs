//! Export: wrinkled geometry, maps, the field, painted layers, scenes. Every file is written under
//! another name first and then renamed, so that a full disk or a crash leaves earlier files as they
//! were.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use plisse::bake::{Options, png16};
use plisse::io::staged::OutputFolder;
use plisse::io::{glb, obj, ply};
use plisse::mesh::{Chart, Topology, Up, Vec2, Vec3};
use plisse::picture::CLOTH;
use plisse::scene::SolvedScene;
use plisse::{Error, Result};
use plisse_live::export::{check_size, write_still};
use plisse_live::fine_mesh::{FineMesh, PARTS_PER_WAVE, refine, suggest_parts};
use plisse_live::live::{Frame, LiveOptions, LiveState};
use plisse_live::play::Player;
use plisse_live::skin::PosedVertices;
use plisse_live::{bake, bias};

use super::grow::Grown;
use super::job::Reporter;
use crate::document::maps::{paint_map, write_png};
use crate::document::settings::ProfileChoice;
use crate::document::subject::shown;
use crate::document::{Document, Layer};

/// Width of the rim around islands of maps (texels), as in `plisse bake`.
const PADDING: usize = 8;

/// A kind of exported file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The surface as OBJ, PLY or GLB, by the file's extension.
    Surface,
    /// Height and normal maps (16-bit PNG), with the bias and the command that bakes them again.
    Maps,
    /// The wrinkle field (JSON).
    Field,
    /// Painted layers as images, and the bias as JSON.
    Paint,
    /// The scene file, and the files that `plisse solve` makes of it.
    SceneFiles,
}

/// The exported surface, with its document.
#[derive(Clone)]
pub enum Source {
    /// The model with its live wrinkles.
    Live(Box<Document>),
    /// A solved scene.
    Solved(Arc<SolvedScene>, Box<Document>),
    /// A grown surface.
    Grown(Arc<Grown>, Box<Document>),
}

impl Source {
    fn document(&self) -> &Document {
        match self {
            Self::Live(document) | Self::Solved(_, document) | Self::Grown(_, document) => document,
        }
    }
}

/// Writes `kind` of `source` to `path`: a file, or a folder for [`Kind::Maps`], [`Kind::Paint`] and
/// [`Kind::SceneFiles`]; the paths of the written files.
///
/// # Errors
/// [`Error::File`] if something cannot be written; [`Error::Value`] if the source has no such
/// files.
pub fn write<T: Send>(
    kind: Kind,
    source: &Source,
    path: &Path,
    size: usize,
    reporter: &Reporter<T>,
) -> Result<Vec<PathBuf>> {
    reporter.stage("files", None);
    match kind {
        Kind::Surface => surface(source, path),
        Kind::Maps => maps(source, path, size),
        Kind::Field => field(source, path),
        Kind::Paint => paint(source.document(), path, size),
        Kind::SceneFiles => match &source.document().subject.scene {
            Some(scene) => super::scene_files::write(scene, path, reporter),
            None => Err(Error::value(
                "export",
                "this model came from no scene; open a scene file (.toml) first",
            )),
        },
    }
}

/// Plays the document's clip from the beginning to its time, as the command line does: the result
/// does not depend on what the window showed before.
fn played(document: &Document) -> Result<(LiveState, PosedVertices, LiveOptions)> {
    let (subject, options) = (&document.subject, document.live_options());
    let mut player =
        Player::new(&subject.model, &subject.welded, &options, document.settings.clip.as_deref())?;
    let drawn = player.play_to(if document.settings.clip.is_some() {
        document.settings.time_s
    } else {
        0.0
    });
    let state = player.state.clone();
    Ok((state, drawn, options))
}

fn one_file(
    path: &Path,
    write: impl FnOnce(&mut dyn std::io::Write) -> std::io::Result<()>,
) -> Result<Vec<PathBuf>> {
    let name = path.file_name().and_then(|n| n.to_str());
    let name = name.ok_or_else(|| {
        Error::value(path.display().to_string(), "it names no file; give a file name")
    })?;
    let mut folder = OutputFolder::create(path.parent().unwrap_or(Path::new(".")))?;
    folder.write(name, write)?;
    folder.commit()
}

/// A surface for the library's writers.
struct Plain {
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    faces: Vec<[usize; 3]>,
    texture: Option<Chart>,
}

fn surface(source: &Source, path: &Path) -> Result<Vec<PathBuf>> {
    let extension =
        path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    if !["obj", "ply", "glb"].contains(&extension.as_str()) {
        return Err(Error::value(
            path.display().to_string(),
            "its name has no known format; let it end in .obj, .ply or .glb",
        ));
    }
    let plain = match source {
        Source::Live(document) => {
            let fine = live(document)?;
            if extension == "glb" {
                return one_file(path, |out| write_still(out, &document.subject.model, &fine));
            }
            plain_of(&fine)
        }
        Source::Solved(solved, _) => {
            let surface = solved.surface(None);
            plain(&surface.fine.topology, &surface.positions)
        }
        Source::Grown(grown, document) if document.subject.scene.is_some() => {
            plain(&grown.topology, &grown.pose)
        }
        Source::Grown(grown, _) => {
            // The model's own axes.
            let back = |p: &Vec3| {
                let q = shown(p);
                Vec3::new(f64::from(q.x), f64::from(q.y), f64::from(q.z))
            };
            plain(&grown.topology, &grown.pose.iter().map(back).collect::<Vec<_>>())
        }
    };
    let z_up = !matches!(source, Source::Live(_)) && source.document().subject.scene.is_some();
    let texture = plain.texture.as_ref();
    match extension.as_str() {
        "obj" => one_file(path, |out| obj::write(out, &plain.positions, &plain.faces, texture)),
        "ply" => one_file(path, |out| ply::write(out, &plain.positions, &plain.faces, &[])),
        _ => {
            let up = if z_up { Up::Z } else { Up::Y };
            let mesh = glb::Mesh {
                positions: &plain.positions,
                normals: &plain.normals,
                faces: &plain.faces,
                texture,
            };
            one_file(path, |out| glb::write(out, &mesh, CLOTH, up))
        }
    }
}

/// The live wrinkles of a document as geometry.
fn live(document: &Document) -> Result<FineMesh> {
    let subject = &document.subject;
    let (state, drawn, _) = played(document)?;
    let profile = document.settings.profile.profile();
    let parts = suggest_parts(&subject.welded, document.settings.wavelength_m, PARTS_PER_WAVE);
    check_size(&subject.model, parts, 1)?;
    let frame = Frame { state: &state, drawn: &drawn };
    Ok(refine(&subject.model, &subject.welded, &frame, &profile, parts))
}

fn plain_of(fine: &FineMesh) -> Plain {
    let wide = |x: &plisse_live::Vec3| Vec3::new(f64::from(x.x), f64::from(x.y), f64::from(x.z));
    let faces: Vec<[usize; 3]> = fine.faces.iter().map(|f| f.map(|v| v as usize)).collect();
    // OBJ's v points up.
    let uvs = fine.uvs.iter().map(|uv| Vec2::new(f64::from(uv.x), 1.0 - f64::from(uv.y))).collect();
    Plain {
        positions: fine.positions.iter().map(wide).collect(),
        normals: fine.normals.iter().map(wide).collect(),
        texture: Some(Chart { points: uvs, faces: faces.clone() }),
        faces,
    }
}

fn plain(topology: &Topology, positions: &[Vec3]) -> Plain {
    let normals = plisse::mesh::normals::vertex_normals(topology, positions);
    Plain { positions: positions.to_vec(), normals, faces: topology.faces.clone(), texture: None }
}

fn maps(source: &Source, path: &Path, size: usize) -> Result<Vec<PathBuf>> {
    let Source::Live(document) = source else {
        return Err(Error::value(
            "maps",
            "the window bakes live wrinkles only; export the scene and its files, and run plisse \
             bake on their folder",
        ));
    };
    let subject = &document.subject;
    let (state, drawn, options) = played(document)?;
    let profile = document.settings.profile.profile();
    let baked = bake::bake(
        &subject.model,
        &subject.welded,
        &Frame { state: &state, drawn: &drawn },
        &profile,
        &Options { size, padding: PADDING },
    )?;
    let scale_m =
        f64::from(bake::largest_height_m(&options.wavelength_m, &profile)).max(f64::MIN_POSITIVE);
    let mut folder = OutputFolder::create(path)?;
    folder.write("normal.png", |out| png16::write_normal(out, &baked))?;
    folder.write("height.png", |out| png16::write_height(out, &baked, scale_m))?;
    if !options.bias.is_empty() {
        folder.write("bias.json", |out| bias::write(out, &options.bias))?;
    }
    folder
        .write("command.txt", |out| out.write_all(command(document, &options, size).as_bytes()))?;
    folder.commit()
}

/// The command that bakes the same maps, with a comment on what it cannot contain.
fn command(document: &Document, options: &LiveOptions, size: usize) -> String {
    let settings = &document.settings;
    let model = match &document.subject.source {
        crate::document::Source::Own(name) => name.clone(),
        crate::document::Source::File(path) => path.display().to_string(),
    };
    let mut words = vec![format!(
        "plisse bake \"{model}\" --wavelength {} --size {size}",
        settings.wavelength_m
    )];
    if let Some(clip) = &settings.clip {
        words.push(format!("--clip \"{clip}\" --time {}", settings.time_s));
    }
    match &settings.profile {
        ProfileChoice::Sine => {}
        ProfileChoice::Accordion => words.push("--profile accordion".into()),
        ProfileChoice::Pencil => words.push("--profile pencil".into()),
        ProfileChoice::Heights(list) => {
            let list: Vec<String> = list.iter().map(f32::to_string).collect();
            words.push(format!("--profile \"{}\"", list.join(",")));
        }
    }
    words.push(format!("--rounds {}", options.rounds));
    if !options.bias.is_empty() {
        words.push("--bias bias.json".into());
    }
    let mut text = words.join(" ") + "\n";
    if document.layers.is_painted(Layer::Wavelength) {
        text += "# The painted wavelength is not in this command: export the paint maps and add \
            --wavelength-map wavelength.png\n";
    }
    text
}

fn field(source: &Source, path: &Path) -> Result<Vec<PathBuf>> {
    match source {
        Source::Solved(solved, _) => one_file(path, |out| {
            plisse::field::json::write(out, &solved.built.sheet.topology, &solved.field)
        }),
        Source::Live(document) => {
            let subject = &document.subject;
            let topology = plisse_live::field::topology(&subject.model.name, &subject.welded)?;
            let (state, ..) = played(document)?;
            let coupling = state.coupling(&subject.welded);
            let field = plisse_live::field::to_field(&topology, &coupling, &state.phase);
            one_file(path, |out| plisse::field::json::write(out, &topology, &field))
        }
        Source::Grown(..) => Err(Error::value(
            "field",
            "a grown surface is geometry and has no field; export the surface",
        )),
    }
}

fn paint(document: &Document, path: &Path, size: usize) -> Result<Vec<PathBuf>> {
    let painted: Vec<Layer> =
        Layer::ALL.into_iter().filter(|&l| document.layers.is_painted(l)).collect();
    if painted.is_empty() {
        return Err(Error::value("paint maps", "nothing is painted; paint something first"));
    }
    let mut folder = OutputFolder::create(path)?;
    for layer in painted {
        let map = paint_map(document, layer, size)?;
        let name = layer.name().to_lowercase().replace(' ', "-");
        folder.write(&format!("{name}.png"), |out| write_png(out, layer, &map))?;
    }
    let bias_list = document.layers.bias();
    if !bias_list.is_empty() {
        folder.write("bias.json", |out| bias::write(out, &bias_list))?;
    }
    folder.commit()
}
