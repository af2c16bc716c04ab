//! The scene of a glTF file that is read: the one asked for, or else the default one.

use serde_json::Value;

use super::trim::{each, index};

/// Nodes of one scene.
pub(super) struct Shown {
    /// `[N]` true for nodes of the scene.
    pub(super) nodes: Vec<bool>,
    /// Sentence on what is left out.
    pub(super) note: Option<String>,
}

/// The nodes of `root`, the JSON of a file, that belong to the scene `name` (or with this number),
/// or else to the default scene; the first one stands in for a default that is not there. All
/// nodes belong to it where a file has no scenes, or none of its meshes is in the default one.
///
/// # Errors
/// A sentence without its place, for a scene that is not there.
pub(super) fn shown(root: &Value, name: Option<&str>) -> Result<Shown, String> {
    let nodes: Vec<&Value> = each(&root["nodes"]).collect();
    let scenes: Vec<&Value> = each(&root["scenes"]).collect();
    let whole = |note| Shown { nodes: vec![true; nodes.len()], note };
    let number = match name {
        Some(name) => match find(&scenes, name) {
            Some(number) => number,
            None => return Err(unknown(&scenes, name)),
        },
        None => index(&root["scene"]).filter(|&s| s < scenes.len()).unwrap_or(0),
    };
    let Some(scene) = scenes.get(number) else { return Ok(whole(None)) };
    let mut is_shown = vec![false; nodes.len()];
    let mut open: Vec<usize> = each(&scene["nodes"]).filter_map(index).collect();
    while let Some(n) = open.pop() {
        if n < nodes.len() && !std::mem::replace(&mut is_shown[n], true) {
            open.extend(each(&nodes[n]["children"]).filter_map(index));
        }
    }
    let meshes = |with: bool| {
        (0..nodes.len()).filter(|&n| is_shown[n] == with && !nodes[n]["mesh"].is_null()).count()
    };
    let left_out = meshes(false);
    let title = title(&scenes, number);
    if meshes(true) == 0 && name.is_none() {
        let note = (left_out > 0)
            .then(|| format!("scene {title} shows no mesh; all {left_out} of the file were read"));
        return Ok(whole(note));
    }
    let note = (left_out > 0).then(|| {
        format!(
            "only scene {title} of {} was read; {left_out} node(s) with a mesh belong to no or \
             another scene",
            scenes.len()
        )
    });
    Ok(Shown { nodes: is_shown, note })
}

/// The scene called `name`, or else the one with that number.
fn find(scenes: &[&Value], name: &str) -> Option<usize> {
    let named = scenes.iter().position(|scene| scene["name"].as_str() == Some(name));
    named.or_else(|| name.parse().ok().filter(|&number: &usize| number < scenes.len()))
}

/// Number of a scene, with its name if it has one.
fn title(scenes: &[&Value], number: usize) -> String {
    let name = scenes[number]["name"].as_str();
    name.map_or_else(|| number.to_string(), |name| format!("{number} (\"{name}\")"))
}

/// The sentence about a scene that is not there.
fn unknown(scenes: &[&Value], name: &str) -> String {
    let known: Vec<String> = (0..scenes.len()).map(|number| title(scenes, number)).collect();
    if known.is_empty() {
        return format!("there is no scene \"{name}\", for the file has none; ask for none");
    }
    format!("there is no scene \"{name}\"; ask for one of {}", known.join(", "))
}
