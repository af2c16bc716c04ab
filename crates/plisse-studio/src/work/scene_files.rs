//! Export of a scene: the exact files that `plisse solve` makes of it, and the scene file itself
//! with the files it names, so that `plisse solve` can make them again.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use plisse::io::staged::OutputFolder;
use plisse::progress::Observer;
use plisse::scene::{solve_base, solve_field};
use plisse::{Error, Result};
use toml_edit::{DocumentMut, Item, TableLike, Value};

use super::job::Reporter;
use crate::document::SceneText;

/// Writes `scene.toml`, the files it names, and what `plisse solve scene.toml` makes of it (without
/// picture and report) into `folder`.
///
/// # Errors
/// [`Error::File`] if something cannot be read or written; [`Error::Value`] if it was stopped; as
/// the solves.
pub fn write<T: Send>(
    scene: &SceneText,
    folder: &Path,
    reporter: &Reporter<T>,
) -> Result<Vec<PathBuf>> {
    let (text, named) = portable(&scene.text, scene.scene.file.parent().unwrap_or(Path::new(".")))?;
    let mut out = OutputFolder::create(folder)?;
    for (name, from) in &named {
        let bytes = plisse::io::disk::read(from).map_err(|e| Error::reading(from, e))?;
        out.write(name, |file| file.write_all(&bytes))?;
    }
    out.write("scene.toml", |file| file.write_all(text.as_bytes()))?;
    reporter.stage("base surface", Some(0.1));
    // From the scene's own start: the window's solve may have started elsewhere.
    let (pose, report) = solve_base(&scene.scene, &scene.built, reporter)?;
    reporter.stage("wrinkle field", Some(0.5));
    let solved = solve_field(Arc::clone(&scene.built), pose, report, reporter)?;
    if reporter.cancelled() {
        return Err(Error::value(
            "export",
            "it was stopped, and nothing was written; start it again",
        ));
    }
    reporter.stage("files", Some(0.8));
    solved.write(&mut out)?;
    out.commit()
}

/// The scene's text with the files it names as plain names, and the paths of these files by their
/// plain names. Comments stay.
///
/// # Errors
/// [`Error::Value`] for a text that is no TOML.
pub fn portable(text: &str, folder: &Path) -> Result<(String, BTreeMap<String, PathBuf>)> {
    let bad = |e: &dyn std::fmt::Display| {
        Error::value("scene", format!("its text is no TOML ({e}); correct it"))
    };
    let mut document: DocumentMut = text.parse().map_err(|e| bad(&e))?;
    let mut named = BTreeMap::new();
    rename(document.as_table_mut(), folder, &mut named);
    Ok((if named.is_empty() { text.to_owned() } else { document.to_string() }, named))
}

fn rename(table: &mut dyn TableLike, folder: &Path, named: &mut BTreeMap<String, PathBuf>) {
    for (key, item) in table.iter_mut() {
        let is_path = ["worn", "rest", "file"].contains(&key.get());
        match item {
            Item::Table(inner) => rename(inner, folder, named),
            Item::ArrayOfTables(list) => list.iter_mut().for_each(|t| rename(t, folder, named)),
            Item::Value(value) => rename_value(value, is_path, folder, named),
            Item::None => {}
        }
    }
}

fn rename_value(
    value: &mut Value,
    is_path: bool,
    folder: &Path,
    named: &mut BTreeMap<String, PathBuf>,
) {
    match value {
        Value::String(text) if is_path => {
            let from = folder.join(text.value());
            let mut name = from
                .file_name()
                .map_or_else(|| "file".into(), |n| n.to_string_lossy().into_owned());
            while named.get(&name).is_some_and(|there| *there != from) {
                name = format!("_{name}");
            }
            named.insert(name.clone(), from);
            let around = value.decor().clone();
            *value = Value::from(name);
            *value.decor_mut() = around;
        }
        Value::InlineTable(inner) => rename(inner, folder, named),
        Value::Array(list) => list.iter_mut().for_each(|v| rename_value(v, false, folder, named)),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_get_plain_names_and_comments_stay() {
        let text = "# mine\ntitle = \"t\"\n[mesh]\nworn = \"a/w.obj\" # worn\n[[obstacle]]\nname = \
            \"o\"\nkind = \"mesh\"\nfile = \"b/w.obj\"\n\
                    [growth]\nwavelength_m = { kind = \"image\", low = 0.0, high = 1, file = \
                    \"m.png\" }\n";
        let (found, named) = portable(text, Path::new("/x")).unwrap();
        assert!(found.starts_with("# mine\n") && found.contains("# worn"), "{found}");
        let names: Vec<(&str, &str)> =
            named.iter().map(|(n, p)| (n.as_str(), p.to_str().unwrap())).collect();
        assert_eq!(
            names,
            [("_w.obj", "/x/b/w.obj"), ("m.png", "/x/m.png"), ("w.obj", "/x/a/w.obj")]
        );
        assert!(
            found.contains("worn = \"w.obj\"")
                && found.contains("file = \"_w.obj\"")
                && found.contains("file = \"m.png\""),
            "{found}"
        );
        assert_eq!(
            portable("title = 1.50 # as it is", Path::new(".")).unwrap().0,
            "title = 1.50 # as it is"
        );
    }
}
