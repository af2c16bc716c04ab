//! Removes from a glTF file all that this reader has no use for, before the rest is checked: an
//! unknown attribute, a material's extension or a camera must not make a model unusable.

use serde_json::{Value, json};

/// Extensions without which there is no geometry.
const COMPRESSIONS: [&str; 3] =
    ["KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression"];
/// Attributes that are read.
const ATTRIBUTES: [&str; 8] = [
    "POSITION",
    "NORMAL",
    "TEXCOORD_0",
    "COLOR_0",
    "JOINTS_0",
    "JOINTS_1",
    "WEIGHTS_0",
    "WEIGHTS_1",
];
/// Properties of nodes that clips may move.
const PROPERTIES: [&str; 4] = ["translation", "rotation", "scale", "weights"];

/// Place of the base colour's image.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Image {
    /// In this buffer view.
    View(usize),
    /// In this file, or in the URI itself.
    Uri(String),
}

/// Removes from `root`, the JSON of a file, all that is not read; returns the image of the first
/// material that has one, unchecked.
///
/// # Errors
/// A sentence without its place, if the geometry is compressed or a clip moves a node that is not
/// there.
pub(super) fn trim(root: &mut Value) -> Result<Option<Image>, String> {
    if let Some(name) = each(&root["extensionsRequired"])
        .filter_map(Value::as_str)
        .find(|name| COMPRESSIONS.contains(name))
    {
        return Err(format!(
            "its geometry is compressed ({name}), which is not read; export it without compression"
        ));
    }
    let image = image(root);
    let nodes = each(&root["nodes"]).count();
    for node in entries(root, "nodes") {
        keep(
            node,
            &[
                "name",
                "children",
                "matrix",
                "translation",
                "rotation",
                "scale",
                "mesh",
                "skin",
                "weights",
            ],
        );
    }
    let mut position_accessors = Vec::new();
    for primitive in entries(root, "meshes").flat_map(|mesh| entries(mesh, "primitives")) {
        keep(primitive, &["attributes", "indices", "mode", "targets"]);
        if let Some(attributes) = primitive.get_mut("attributes") {
            keep(attributes, &ATTRIBUTES);
            position_accessors.extend(index(&attributes["POSITION"]));
        }
        entries(primitive, "targets").for_each(|target| keep(target, &ATTRIBUTES[..2]));
    }
    // Bounds are not used, so they may be missing.
    for a in position_accessors {
        if let Some(accessor) = root
            .get_mut("accessors")
            .and_then(|list| list.get_mut(a))
            .and_then(Value::as_object_mut)
        {
            accessor.insert("min".to_owned(), json!([0, 0, 0]));
            accessor.insert("max".to_owned(), json!([0, 0, 0]));
        }
    }
    trim_animations(root, nodes)?;
    for view in entries(root, "bufferViews") {
        keep(view, &["buffer", "byteOffset", "byteLength", "byteStride"]);
    }
    keep(
        root,
        &["asset", "accessors", "animations", "buffers", "bufferViews", "meshes", "nodes", "skins"],
    );
    Ok(image)
}

/// Removes the channels that move anything but a property of one of the `nodes` nodes.
fn trim_animations(root: &mut Value, nodes: usize) -> Result<(), String> {
    for (a, animation) in entries(root, "animations").enumerate() {
        let Some(channels) = animation.get_mut("channels").and_then(Value::as_array_mut) else {
            continue;
        };
        // Extensions let a clip move other things, which have no node or another path.
        let target = |channel: &Value| {
            let path = channel["target"]["path"].as_str()?;
            PROPERTIES.contains(&path).then_some(index(&channel["target"]["node"])?)
        };
        channels.retain(|channel| target(channel).is_some());
        if let Some(n) = channels.iter().filter_map(target).find(|&n| n >= nodes) {
            return Err(format!(
                "clip {a} moves node {n}, but there are only {nodes}; export it again"
            ));
        }
    }
    Ok(())
}

/// The image of the first material with a base colour image, of either kind of material.
fn image(root: &Value) -> Option<Image> {
    let texture = |material: &Value| {
        let glossy =
            &material["extensions"]["KHR_materials_pbrSpecularGlossiness"]["diffuseTexture"];
        [&material["pbrMetallicRoughness"]["baseColorTexture"], glossy]
            .into_iter()
            .find_map(|t| index(&t["index"]))
    };
    let source =
        index(&root["textures"].get(each(&root["materials"]).find_map(texture)?)?["source"])?;
    let image = root["images"].get(source)?;
    let uri = || image["uri"].as_str().map(|uri| Image::Uri(uri.to_owned()));
    index(&image["bufferView"]).map(Image::View).or_else(uri)
}

fn index(value: &Value) -> Option<usize> {
    value.as_u64().and_then(|i| usize::try_from(i).ok())
}

/// The entries of an array; none of anything else.
fn each(list: &Value) -> impl Iterator<Item = &Value> {
    list.as_array().into_iter().flatten()
}

/// The entries of the array `name` of an object; none of anything else.
fn entries<'a>(object: &'a mut Value, name: &str) -> impl Iterator<Item = &'a mut Value> + use<'a> {
    object.get_mut(name).and_then(Value::as_array_mut).into_iter().flatten()
}

/// Takes all but these out of an object.
fn keep(object: &mut Value, names: &[&str]) {
    if let Some(object) = object.as_object_mut() {
        object.retain(|name, _| names.contains(&name.as_str()));
    }
}
