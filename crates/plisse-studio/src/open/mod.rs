//! Reading and writing of files: models (GLB, glTF, OBJ, PLY), scenes (TOML), and documents
//! (`NAME.plisse.json`). A file gives a complete document or an error.

use std::path::{Path, PathBuf};

use plisse::io::{obj, ply_mesh};
use plisse::{Error, Result};
use plisse_live::model::Model;
use plisse_live::{Vec2, Vec3, gltf_in};

use crate::document::{Document, Source, Subject, saved};

/// Extensions of files that can be opened.
pub const EXTENSIONS: [&str; 6] = ["glb", "gltf", "obj", "ply", "toml", "json"];
/// End of the names of documents.
pub const DOCUMENT_END: &str = ".plisse.json";

/// The document in the file `path`, or a new one about the model in it.
///
/// # Errors
/// [`Error::File`] if it cannot be read; [`Error::Value`] for a file of another kind; as the
/// readers of each kind.
pub fn open(path: &Path) -> Result<Document> {
    if path.to_string_lossy().to_lowercase().ends_with(".json") {
        return document(path);
    }
    Ok(Document::new(subject(path)?))
}

/// The file to open of several that came together: a document, else a scene, else a model.
pub fn first(paths: &[PathBuf]) -> Option<&Path> {
    let is = |path: &PathBuf, end: &str| path.to_string_lossy().to_lowercase().ends_with(end);
    let ends = [DOCUMENT_END, ".toml", ".glb", ".gltf", ".obj", ".ply"];
    ends.iter().find_map(|end| paths.iter().find(|path| is(path, end))).map(PathBuf::as_path)
}

/// The model or scene in the file `path`.
///
/// # Errors
/// As [`open`].
pub fn subject(path: &Path) -> Result<Subject> {
    let extension =
        path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    let source = Source::File(path.to_path_buf());
    match extension.as_str() {
        "glb" | "gltf" => Ok(Subject::new(source, gltf_in::read(path)?)),
        "obj" => {
            let read = obj::read(path)?;
            let mut subject = Subject::new(source, from_obj(&name(path), &read));
            subject.notes = read.warnings;
            Ok(subject)
        }
        "ply" => {
            let read = ply_mesh::read(path)?;
            Ok(Subject::new(source, from_ply(&name(path), &read)))
        }
        "toml" => Subject::scene(
            path.to_path_buf(),
            plisse::io::disk::read_text(path).map_err(|e| Error::reading(path, e))?,
        ),
        _ => {
            let message = "this kind of file is not known; open .glb, .gltf, .obj, .ply, a scene \
                .toml or a .plisse.json";
            Err(Error::value(path.display().to_string(), message))
        }
    }
}

fn name(path: &Path) -> String {
    path.file_name().map_or_else(|| "model".into(), |n| n.to_string_lossy().into_owned())
}

/// The model of an OBJ file; vertices are split along its texture seams.
fn from_obj(name: &str, read: &obj::Obj) -> Model {
    let place = |v: usize| {
        Vec3::new(
            read.positions[v].x as f32,
            read.positions[v].y as f32,
            read.positions[v].z as f32,
        )
    };
    let mut numbers = std::collections::BTreeMap::new();
    let (mut positions, mut uvs, mut faces) = (Vec::new(), Vec::new(), Vec::new());
    for (f, face) in read.faces.iter().enumerate() {
        faces.push([0, 1, 2].map(|k| {
            let texture = read.texture_faces.as_ref().map(|t| t[f][k]);
            *numbers.entry((face[k], texture)).or_insert_with(|| {
                positions.push(place(face[k]));
                // OBJ's v points up.
                uvs.push(texture.map_or_else(Vec2::zeros, |t| {
                    let uv = &read.texture_coordinates[t];
                    Vec2::new(uv.x as f32, 1.0 - uv.y as f32)
                }));
                positions.len() as u32 - 1
            })
        }));
    }
    Model::rigid(name, positions, uvs, faces)
}

/// The model of a PLY file.
fn from_ply(name: &str, read: &ply_mesh::PlyMesh) -> Model {
    let positions = read.positions.iter().map(|p| p.map(|x| x as f32)).collect();
    // PLY's v points up.
    let uvs =
        read.texture.iter().flatten().map(|uv| Vec2::new(uv.x as f32, 1.0 - uv.y as f32)).collect();
    Model::rigid(
        name,
        positions,
        uvs,
        read.faces.iter().map(|face| face.map(|v| v as u32)).collect(),
    )
}

/// The document in the file `path`, with its model.
fn document(path: &Path) -> Result<Document> {
    let text = plisse::io::disk::read_text(path).map_err(|e| Error::reading(path, e))?;
    restore(&path.display().to_string(), &text, path.parent().unwrap_or(Path::new(".")))
}

/// The document in `text`, whose model lies relative to `folder`.
///
/// # Errors
/// [`Error::Value`] at `place` for a text that is no document or does not fit its model; as
/// [`subject`].
pub fn restore(place: &str, text: &str, folder: &Path) -> Result<Document> {
    let saved = saved::read(place, text)?;
    let subject = match (&saved.model.own, &saved.model.file) {
        (Some(own), _) => Subject::own(own)?,
        (None, Some(file)) => {
            let file = folder.join(file);
            match &saved.scene {
                Some(text) => Subject::scene(file, text.clone())?,
                None => subject(&file)?,
            }
        }
        (None, None) => {
            return Err(Error::value(place, "it names no model; give model.own or model.file"));
        }
    };
    let layers = saved.layers(place, subject.welded.count(), subject.model.faces.len())?;
    let mut document = Document::new(subject);
    document.layers = layers;
    document.settings = saved.settings;
    document.settings.clamp();
    Ok(document)
}

/// The text of `document` for a file in `folder`.
pub fn text(document: &Document, folder: &Path) -> String {
    let whole = plisse::io::disk::whole;
    let folder = whole(folder);
    saved::write(document, |file| {
        let file = whole(file);
        file.strip_prefix(&folder).unwrap_or(&file).to_string_lossy().into_owned()
    })
}

/// Writes `document` to `path`, under another name first and then renamed.
///
/// # Errors
/// [`Error::File`] if it cannot be written; an earlier file then stays.
pub fn save(document: &Document, path: &Path) -> Result<()> {
    let folder = path.parent().unwrap_or(Path::new("."));
    let text = text(document, folder);
    let name = path.file_name().and_then(|n| n.to_str()).unwrap_or_default();
    let mut out = plisse::io::staged::OutputFolder::create(folder)?;
    out.write(name, |file| file.write_all(text.as_bytes()))?;
    out.commit()?;
    Ok(())
}

/// The suggested path of a document about `source`.
pub fn usual_path(source: &Source) -> PathBuf {
    let name = format!("{}{DOCUMENT_END}", source.stem());
    match source {
        Source::Own(_) => PathBuf::from(name),
        Source::File(path) => path.with_file_name(name),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_files_that_come_together_the_one_that_names_the_others_is_opened() {
        let first_of = |names: &[&str]| {
            first(&names.iter().map(PathBuf::from).collect::<Vec<_>>())
                .map(|p| p.display().to_string())
        };
        assert_eq!(first_of(&["a.obj", "s.toml", "b.obj"]).as_deref(), Some("s.toml"));
        assert_eq!(
            first_of(&["s.toml", "a.obj", "X.PLISSE.JSON"]).as_deref(),
            Some("X.PLISSE.JSON")
        );
        assert_eq!(first_of(&["a.bin", "m.gltf"]).as_deref(), Some("m.gltf"));
        assert_eq!(first_of(&["a.bin", "t.png", "bias.json"]), None);
    }
}
