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
/// material that has one, unchecked. Channels that cannot be read go too, with a sentence of
/// `notes` each.
///
/// # Errors
/// A sentence without its place, if the geometry is compressed.
pub(super) fn trim(root: &mut Value, notes: &mut Vec<String>) -> Result<Option<Image>, String> {
    if let Some(name) = compression(root) {
        return Err(format!(
            "its geometry is compressed ({name}), which is not read; export it without compression"
        ));
    }
    let image = image(root);
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
    // An accessor without a view is all zeros; the parser knows such accessors as sparse ones only.
    for accessor in entries(root, "accessors").filter_map(Value::as_object_mut) {
        if !accessor.contains_key("bufferView") && !accessor.contains_key("sparse") {
            let none = json!({
                "count": 0,
                "indices": {"bufferView": 0, "componentType": 5121},
                "values": {"bufferView": 0},
            });
            accessor.insert("sparse".to_owned(), none);
        }
    }
    trim_animations(root, notes);
    for view in entries(root, "bufferViews") {
        keep(view, &["buffer", "byteOffset", "byteLength", "byteStride"]);
    }
    keep(
        root,
        &["asset", "accessors", "animations", "buffers", "bufferViews", "meshes", "nodes", "skins"],
    );
    Ok(image)
}

/// The compression that geometry cannot be read without. Where it is only *used*, the same numbers
/// may stand in the file uncompressed too.
fn compression(root: &Value) -> Option<&'static str> {
    let accessors = &root["accessors"];
    let is_missing = |name: &str| {
        let is_required = each(&root["extensionsRequired"]).any(|e| e == name);
        let has_no_view = |accessor: &Value| {
            let accessor = index(accessor).and_then(|a| accessors.get(a));
            accessor.is_some_and(|a| a["bufferView"].is_null() && a["sparse"].is_null())
        };
        let mut primitives = each(&root["meshes"]).flat_map(|mesh| each(&mesh["primitives"]));
        let is_in_primitive = primitives.any(|p| {
            let attributes = p["attributes"].as_object();
            !p["extensions"][name].is_null()
                && attributes
                    .into_iter()
                    .flatten()
                    .map(|a| a.1)
                    .chain([&p["indices"]])
                    .any(has_no_view)
        });
        let is_in_view = each(&root["bufferViews"]).any(|view| {
            let buffer = index(&view["buffer"]).map_or(&Value::Null, |b| &root["buffers"][b]);
            !view["extensions"][name].is_null()
                && buffer["uri"].is_null()
                && buffer["extensions"][name]["fallback"] == true
        });
        is_required || is_in_primitive || is_in_view
    };
    COMPRESSIONS.into_iter().find(|name| is_missing(name))
}

/// Removes the channels that move anything but a property of a node, and, with a note, those whose
/// node, sampler or numbers are not there.
fn trim_animations(root: &mut Value, notes: &mut Vec<String>) {
    let count = |name: &str| each(&root[name]).count();
    let (nodes, accessors) = (count("nodes"), count("accessors"));
    for (a, animation) in entries(root, "animations").enumerate() {
        let samplers: Vec<Value> = each(&animation["samplers"]).cloned().collect();
        let (mut kept, mut kept_samplers) = (Vec::new(), Vec::new());
        for (c, channel) in each(&animation["channels"]).enumerate() {
            // Extensions let a clip move other things, which have no node or another path.
            let target = &channel["target"];
            let is_known = target["path"].as_str().is_some_and(|p| PROPERTIES.contains(&p));
            let Some(node) = index(&target["node"]).filter(|_| is_known) else { continue };
            let sampler = index(&channel["sampler"]).and_then(|s| samplers.get(s));
            let is_there = |value: &Value| index(value).is_some_and(|i| i < accessors);
            let fault = match sampler {
                _ if node >= nodes => format!("moves node {node}, but there are only {nodes}"),
                Some(s) if is_there(&s["input"]) && is_there(&s["output"]) => {
                    kept.push(json!({
                        "sampler": kept_samplers.len(),
                        "target": {"node": node, "path": target["path"]},
                    }));
                    kept_samplers.push(plain_sampler(s));
                    continue;
                }
                _ => "has no keys".to_owned(),
            };
            notes.push(format!("clip {a}, channel {c} {fault}; the channel was left out"));
        }
        let name = animation["name"].as_str().map(str::to_owned);
        *animation = json!({"channels": kept, "samplers": kept_samplers});
        if let Some(name) = name {
            animation["name"] = json!(name);
        }
    }
}

/// A sampler with the interpolation that it names, or else the linear one.
fn plain_sampler(sampler: &Value) -> Value {
    let named = sampler["interpolation"].as_str();
    let interpolation = named.filter(|i| ["STEP", "CUBICSPLINE"].contains(i)).unwrap_or("LINEAR");
    json!({
        "input": sampler["input"],
        "output": sampler["output"],
        "interpolation": interpolation,
    })
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

/// The index that `value` is.
pub(super) fn index(value: &Value) -> Option<usize> {
    value.as_u64().and_then(|i| usize::try_from(i).ok())
}

/// The entries of an array; none of anything else.
pub(super) fn each(list: &Value) -> impl Iterator<Item = &Value> {
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
