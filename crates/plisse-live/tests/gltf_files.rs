//! glTF files: broken ones end in one sentence, sound ones in a model.

use std::path::Path;

use base64::prelude::{BASE64_STANDARD, Engine};
use plisse_live::gltf_in::{from_bytes, read};
use plisse_live::live::{LiveOptions, LiveState};
use plisse_live::skin::{pose, skin};
use plisse_live::weld::WeldedMesh;
use serde_json::{Value, json};

/// A GLB of `json` and `bin`.
fn glb(json: &Value, bin: &[u8]) -> Vec<u8> {
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut file = b"glTF\x02\0\0\0".to_vec();
    file.extend(((28 + text.len() + bin.len()) as u32).to_le_bytes());
    file.extend((text.len() as u32).to_le_bytes());
    file.extend(b"JSON");
    file.extend(text);
    file.extend((bin.len() as u32).to_le_bytes());
    file.extend(b"BIN\0");
    file.extend(bin);
    file
}

/// Two triangles on a skin with two joints, and a clip that turns the second.
fn sound() -> (Value, Vec<u8>) {
    let mut bin = Vec::new();
    let mut views = Vec::new();
    let mut add = |bytes: Vec<u8>| {
        views.push(json!({"buffer": 0, "byteOffset": bin.len(), "byteLength": bytes.len()}));
        bin.extend(bytes);
    };
    let floats = |list: &[f32]| list.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    add(floats(&[0., 0., 0., 1., 0., 0., 1., 1., 0., 0., 1., 0.]));
    add([0u16, 1, 2, 0, 2, 3].iter().flat_map(|i| i.to_le_bytes()).collect());
    add([[0u8, 0, 0, 0], [1, 0, 0, 0], [1, 0, 0, 0], [0, 0, 0, 0]].concat());
    add(floats(&[1., 0., 0., 0.].repeat(4)));
    add(floats(&[0., 1.]));
    add(floats(&[0., 0., 0., 1., 0., 0., 1., 0.]));
    let json = json!({
        "asset": {"version": "2.0"}, "buffers": [{"byteLength": bin.len()}], "bufferViews": views,
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3",
                "min": [0, 0, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"},
            {"bufferView": 2, "componentType": 5121, "count": 4, "type": "VEC4"},
            {"bufferView": 3, "componentType": 5126, "count": 4, "type": "VEC4"},
            {"bufferView": 4, "componentType": 5126, "count": 2, "type": "SCALAR",
                "min": [0], "max": [1]},
            {"bufferView": 5, "componentType": 5126, "count": 2, "type": "VEC4"}],
        "meshes": [{"primitives": [
            {"attributes": {"POSITION": 0, "JOINTS_0": 2, "WEIGHTS_0": 3}, "indices": 1}]}],
        "nodes": [{"mesh": 0, "skin": 0}, {"children": [2]}, {}],
        "skins": [{"joints": [1, 2]}],
        "animations": [{
            "name": "turn",
            "channels": [{"sampler": 0, "target": {"node": 2, "path": "rotation"}}],
            "samplers": [{"input": 4, "output": 5}]}],
        "scenes": [{"nodes": [0, 1]}], "scene": 0});
    (json, bin)
}

fn sentence(name: &str, file: &[u8]) -> String {
    let message = from_bytes("model.glb", file, None).expect_err(name).to_string();
    assert!(
        message.starts_with("model.glb: ") && message.contains(';') && !message.contains('\n'),
        "{name}: {message}"
    );
    message
}

/// Runs a few frames of whatever clip there is; everything stays a number.
fn runs(file: &[u8]) {
    let model = from_bytes("model.glb", file, None).unwrap();
    let welded = WeldedMesh::new(&model, 1e-5);
    let mut live = LiveState::default();
    for frame in 0..5 {
        live.step(
            &welded,
            &pose(&model, model.clip(None), 0.2 * frame as f32),
            &LiveOptions::new(0.3),
        );
        assert!(live.phase.iter().chain(&live.waves.amplitude_m).all(|x| x.is_finite()));
        assert!(
            live.posed
                .positions
                .iter()
                .chain(&live.waves.wave)
                .all(|x| x.iter().all(|x| x.is_finite()))
        );
    }
}

#[test]
fn a_sound_file_is_posed_as_its_clip_says() {
    let (json, bin) = sound();
    let model = from_bytes("model.glb", &glb(&json, &bin), None).unwrap();
    assert_eq!((model.draw.positions.len(), model.faces.len(), model.clips.len()), (4, 2, 1));
    let posed = skin(&model.draw, &pose(&model, model.clip(Some("turn")), 0.5));
    // Half of a half turn: joint 1's vertices go from (1, 0) to (0, 1).
    assert!(
        (posed.positions[1] - plisse_live::Vec3::y()).norm() < 1e-5
            && posed.positions[0].norm() < 1e-6
    );
    runs(&glb(&json, &bin));
}

/// The sound file with one more buffer view for each of `more`.
fn with_views(more: &[Vec<u8>]) -> (Value, Vec<u8>) {
    let (mut json, mut bin) = sound();
    for bytes in more {
        json["bufferViews"]
            .as_array_mut()
            .unwrap()
            .push(json!({"buffer": 0, "byteOffset": bin.len(), "byteLength": bytes.len()}));
        bin.extend(bytes);
        bin.resize(bin.len().next_multiple_of(4), 0);
    }
    json["buffers"][0]["byteLength"] = json!(bin.len());
    (json, bin)
}

#[test]
fn red_vertex_colours_are_shares_of_the_wavelength() {
    let colours: Vec<u8> =
        [[255u8, 0, 0, 255], [51, 9, 9, 255], [0, 9, 9, 255], [102, 0, 0, 255]].concat();
    let (mut json, bin) = with_views(&[colours]);
    let accessor = json!({
        "bufferView": 6,
        "componentType": 5121,
        "normalized": true,
        "count": 4,
        "type": "VEC4",
    });
    json["accessors"].as_array_mut().unwrap().push(accessor);
    json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(6);
    let model = from_bytes("model.glb", &glb(&json, &bin), None).unwrap();
    let shares = model.wavelength_share.as_deref().unwrap();
    assert!(
        shares.iter().zip([1.0, 0.2, 0.0, 0.4]).all(|(a, b): (&f32, f32)| (a - b).abs() < 1e-6),
        "{shares:?}"
    );
    let welded = WeldedMesh::new(&model, 1e-5);
    let list = plisse_live::wavelength::per_vertex(&welded, 0.3, Some(shares));
    assert!((list[3] - 0.12).abs() < 1e-6 && list[2] > 0.0);
    let mut live = LiveState::default();
    let options = LiveOptions { wavelength_m: list, ..LiveOptions::new(0.3) };
    live.step(&welded, &pose(&model, model.clip(None), 0.5), &options);
    assert!(live.phase.iter().all(|x| x.is_finite()));
    let (json, bin) = sound();
    assert_eq!(from_bytes("model.glb", &glb(&json, &bin), None).unwrap().wavelength_share, None);
}

#[test]
fn sparse_accessors_put_numbers_in_place() {
    let floats = |list: &[f32]| list.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    let (mut json, bin) = with_views(&[vec![1, 3], floats(&[5., 0., 0., 0., 7., 0.])]);
    json["accessors"][0]["sparse"] = json!({
        "count": 2,
        "indices": {"bufferView": 6, "componentType": 5121},
        "values": {"bufferView": 7},
    });
    // Without a skin, nothing scales the positions.
    json.as_object_mut().unwrap().remove("skins");
    json["nodes"][0].as_object_mut().unwrap().remove("skin");
    let positions =
        |json: &Value| from_bytes("model.glb", &glb(json, &bin), None).unwrap().draw.positions;
    let x = |x, y| plisse_live::Vec3::new(x, y, 0.0);
    assert_eq!(positions(&json), [x(0., 0.), x(5., 0.), x(1., 1.), x(0., 7.)]);
    // Without a view of its own it starts from zeros.
    let mut zeros = json.clone();
    zeros["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    assert_eq!(positions(&zeros), [x(0., 0.), x(5., 0.), x(0., 0.), x(0., 7.)]);
    let broken = |key: &str, value: Value| {
        let mut json = json.clone();
        *json.pointer_mut(&format!("/accessors/0/sparse/{key}")).unwrap() = value;
        sentence(key, &glb(&json, &bin));
    };
    broken("count", json!(9));
    broken("indices/bufferView", json!(99));
    broken("indices/componentType", json!(5125));
    broken("values/bufferView", json!(6));
    let mut far = bin.clone();
    far[json["bufferViews"][6]["byteOffset"].as_u64().unwrap() as usize + 1] = 9;
    assert!(sentence("index out of range", &glb(&json, &far)).contains("names 9 of 4"));
}

#[test]
fn buffers_lie_beside_the_file_or_in_it() {
    let (json, bin) = sound();
    let folder = std::env::temp_dir().join(format!("plisse-gltf-uris-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let faces = |uri: &str| {
        let mut json = json.clone();
        json["buffers"][0]["uri"] = uri.into();
        from_bytes("model.gltf", json.to_string().as_bytes(), Some(&folder))
            .map(|model| model.faces.len())
    };
    for (name, uri) in [
        ("plain.bin", "plain.bin"),
        ("two words.bin", "two%20words.bin"),
        ("café (1).bin", "caf%C3%A9%20%281%29.bin"),
        ("50%20off.bin", "50%20off.bin"),
    ] {
        std::fs::write(folder.join(name), &bin).unwrap();
        assert_eq!(faces(uri).unwrap(), 2, "{uri}");
    }
    let base64 = BASE64_STANDARD.encode(&bin);
    for text in [&base64[..], base64.trim_end_matches('=')] {
        assert_eq!(
            faces(&format!("data:application/octet-stream;base64,{text}")).unwrap(),
            2,
            "{text}"
        );
    }
    for uri in [
        "nowhere.bin",
        "data:application/octet-stream;base64,a*b",
        "data:application/octet-stream,abc",
        "%FF.bin",
    ] {
        let message = faces(uri).unwrap_err().to_string();
        assert!(message.contains("buffer 0") && message.contains("cannot be read"), "{message}");
    }
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn broken_files_end_in_one_sentence() {
    let (json, bin) = sound();
    let whole = glb(&json, &bin);
    for length in 0..whole.len() {
        sentence("truncated", &whole[..length]);
    }
    let with = |change: &dyn Fn(&mut Value)| {
        let mut json = json.clone();
        change(&mut json);
        glb(&json, &bin)
    };
    sentence("missing buffer", &with(&|j| j["buffers"][0]["uri"] = json!("nowhere.bin")));
    sentence("short buffer", &with(&|j| j["buffers"][0]["byteLength"] = json!(100_000)));
    sentence("accessor too long", &with(&|j| j["accessors"][0]["count"] = json!(4_000_000)));
    sentence("accessor huge", &with(&|j| j["accessors"][0]["count"] = json!(u64::MAX / 2)));
    assert!(sentence("ring", &with(&|j| j["nodes"][2]["children"] = json!([1]))).contains("ring"));
    sentence("two parents", &with(&|j| j["nodes"][0]["children"] = json!([2])));
    for odd in [json!(null), json!(3), json!("text"), json!([3]), json!({"a": 1})] {
        let file = glb(&odd, &bin);
        sentence("no file at all", &file);
        for key in json.as_object().unwrap().keys() {
            // Whatever stands there, it must not end in a panic.
            let _ = from_bytes("model.glb", &with(&|j| j[key] = odd.clone()), None);
        }
        for path in [
            "/meshes/0",
            "/meshes/0/primitives",
            "/meshes/0/primitives/0",
            "/meshes/0/primitives/0/attributes",
            "/nodes/0",
            "/animations/0",
            "/animations/0/channels",
            "/animations/0/channels/0",
            "/animations/0/channels/0/target",
            "/accessors/0",
        ] {
            let _ = from_bytes(
                "model.glb",
                &with(&|j| *j.pointer_mut(path).unwrap() = odd.clone()),
                None,
            );
        }
    }
    assert!(
        sentence(
            "compressed",
            &with(&|j| j["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]))
        )
        .contains("compressed")
    );
    sentence("wrong mesh index", &with(&|j| j["nodes"][0]["mesh"] = json!(7)));
    sentence(
        "no positions",
        &with(&|j| j["meshes"][0]["primitives"][0]["attributes"] = json!({"TEXCOORD_0": 0})),
    );
    sentence("no faces", &with(&|j| j["meshes"][0]["primitives"][0]["mode"] = json!(0)));
    let patched = |at: usize, bytes: &[u8]| {
        let mut bin = bin.clone();
        bin[at..at + bytes.len()].copy_from_slice(bytes);
        glb(&json, &bin)
    };
    assert!(sentence("joint out of range", &patched(60, &[9])).contains("joint 9"));
    sentence("NaN weight", &patched(76, &f32::NAN.to_le_bytes()));
    sentence("NaN position", &patched(0, &f32::INFINITY.to_le_bytes()));
    sentence("vertex out of range", &patched(48, &[200]));
}

/// A file with one fault, its notes, and the number of channels that are left.
fn repaired(json: &Value, bin: &[u8]) -> (plisse_live::model::Model, String, usize) {
    let model = from_bytes("model.glb", &glb(json, bin), None).unwrap();
    let channels = model.clips.iter().map(|clip| clip.channels.len()).sum();
    let notes = model.notes.join("\n");
    (model, notes, channels)
}

#[test]
fn channels_that_cannot_be_read_are_left_out_with_a_note() {
    let (json, bin) = sound();
    assert_eq!(repaired(&json, &bin).1, "");
    let accessor = "/animations/0/samplers/0/input";
    for (path, value, note) in [
        ("/animations/0/channels/0/target/node", json!(42), "moves node 42"),
        ("/animations/0/channels/0/sampler", json!(7), "has no keys"),
        (accessor, json!(99), "has no keys"),
        (accessor, json!(0), "3 numbers where 1 belong"),
        ("/accessors/5/count", json!(1), "not one value per key"),
    ] {
        let mut json = json.clone();
        *json.pointer_mut(path).unwrap() = value;
        let (model, notes, channels) = repaired(&json, &bin);
        assert!(channels == 0 && notes.contains(note) && notes.ends_with("left out"), "{notes}");
        assert_eq!((model.clips[0].name.as_str(), model.faces.len()), ("turn", 2));
    }
    let mut broken = bin;
    broken[140..144].copy_from_slice(&f32::NAN.to_le_bytes());
    let (_, notes, channels) = repaired(&json, &broken);
    assert_eq!(channels, 0);
    assert_eq!(
        notes,
        "clip \"turn\", channel 0: entry 0 is no finite number; the channel was left out"
    );
}

#[test]
fn doubled_keys_jump_and_disordered_ones_are_sorted() {
    let floats = |list: &[f32]| list.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    let shifts = [0f32, 1., 5., 6.].map(|x| [x, 0., 0.]).concat();
    for (times, note) in [
        ([0f32, 1., 1., 2.], "1 key(s) have the time of the key before"),
        ([1., 0., 2., 3.], "1 key(s) were earlier"),
    ] {
        let (mut json, bin) = with_views(&[floats(&times), floats(&shifts)]);
        for (view, kind) in [(6, "SCALAR"), (7, "VEC3")] {
            json["accessors"].as_array_mut().unwrap().push(json!({
                "bufferView": view, "componentType": 5126, "count": 4, "type": kind,
            }));
        }
        json["animations"][0]["samplers"][0] = json!({"input": 6, "output": 7});
        json["animations"][0]["channels"][0]["target"]["path"] = json!("translation");
        let (model, notes, _) = repaired(&json, &bin);
        assert!(notes.starts_with("clip \"turn\", channel 0: ") && notes.contains(note), "{notes}");
        let at = |time_s| plisse_live::model::sample(&model.clips[0].channels[0], time_s)[0];
        let expected = if times[0] == 0.0 { [0.5, 5.0, 5.5] } else { [0.5, 0.0, 2.5] };
        assert_eq!([at(0.5), at(1.0), at(1.5)], expected);
    }
}

#[test]
fn an_accessor_without_a_view_is_all_zeros() {
    let (mut json, bin) = sound();
    json["accessors"]
        .as_array_mut()
        .unwrap()
        .push(json!({"componentType": 5126, "count": 4, "type": "VEC3"}));
    json["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": 6, "NORMAL": 6}]);
    let (model, notes, _) = repaired(&json, &bin);
    assert_eq!(notes, "");
    assert_eq!(model.draw.morphs[0].positions, [plisse_live::Vec3::zeros(); 4]);
    assert_eq!(model.faces.len(), 2);
}

#[test]
fn names_in_latin_1_change_nothing() {
    let (mut json, bin) = sound();
    json["animations"][0]["name"] = json!("turn\u{e9}?");
    let plain = from_bytes("model.glb", &glb(&json, &bin), None).unwrap();
    // The two bytes of é in UTF-8 become the one of Latin-1; another sign keeps the length.
    let mut file = glb(&json, &bin);
    let at = file.windows(2).position(|b| b == "\u{e9}".as_bytes()).unwrap();
    file[at..at + 3].copy_from_slice(b"\xE9?!");
    let odd = from_bytes("model.glb", &file, None).unwrap();
    assert_eq!(odd.clips[0].name, "turn\u{e9}?!");
    assert!(odd.notes[0].contains("Latin-1"), "{:?}", odd.notes);
    assert_eq!((odd.draw, odd.faces), (plain.draw, plain.faces));
}

#[test]
fn other_formats_are_named_with_the_way_to_go() {
    let named = |bytes: &[u8], name: &str| {
        let message = from_bytes(name, bytes, None).unwrap_err().to_string();
        assert!(message.starts_with(name) && !message.contains('\n'), "{message}");
        assert_eq!(message.matches(';').count(), 1, "{message}");
        message
    };
    for (bytes, name, format) in [
        (&b"{\"asset\": {\"version\": \"1.0\"}, \"meshes\": {}}"[..], "old.gltf", "glTF 1.0"),
        (b"glTF\x01\0\0\0\x14\0\0\0\0\0\0\0\0\0\0\0", "old.glb", "glTF 1.0"),
        (b"Kaydara FBX Binary  \0\x1a\0", "a.fbx", "FBX"),
        (b"; FBX 7.4.0 project file", "a.glb", "FBX"),
        (b"Ogawa\xff\0\x01", "a.abc", "Alembic"),
        (b"#usda 1.0", "a.usd", "USD"),
        (b"PK\x03\x04", "a.usdz", "USD"),
        (b"PK\x03\x04", "a.zip", "zip"),
        (b"v 0 0 0\nf 1 1 1\n", "a.obj", "OBJ"),
        (b"solid a", "a.stl", "STL"),
        (b"version https://git-lfs.github.com/spec/v1", "a.glb", "Git LFS"),
    ] {
        let message = named(bytes, name);
        assert!(message.contains(format), "{message}");
    }
    // A plain text that says nothing stays no valid glTF.
    assert!(named(b"what is this", "a.txt").contains("no valid glTF"));
}

#[test]
fn compression_is_refused_by_name_where_nothing_else_holds_the_geometry() {
    let (json, bin) = sound();
    for name in ["KHR_draco_mesh_compression", "EXT_meshopt_compression"] {
        for list in ["extensionsUsed", "extensionsRequired"] {
            let mut json = json.clone();
            json[list] = json!([name]);
            if name.starts_with("KHR") {
                json["meshes"][0]["primitives"][0]["extensions"] = json!({name: {"bufferView": 0}});
                for accessor in 0..4 {
                    json["accessors"][accessor].as_object_mut().unwrap().remove("bufferView");
                }
            } else {
                json["bufferViews"][0]["extensions"] = json!({name: {"buffer": 0}});
                json["buffers"].as_array_mut().unwrap().push(json!({
                    "byteLength": 48, "extensions": {name: {"fallback": true}},
                }));
                json["bufferViews"][0]["buffer"] = json!(1);
            }
            let message = sentence(name, &glb(&json, &bin));
            assert!(message.contains("compressed") && message.contains(name), "{message}");
        }
    }
    // Used, but the same numbers are there uncompressed.
    let mut json = json;
    json["extensionsUsed"] = json!(["KHR_draco_mesh_compression"]);
    json["meshes"][0]["primitives"][0]["extensions"] =
        json!({"KHR_draco_mesh_compression": {"bufferView": 0}});
    assert_eq!(from_bytes("model.glb", &glb(&json, &bin), None).unwrap().faces.len(), 2);
}

#[test]
fn the_default_scene_is_read_or_the_one_asked_for() {
    let (mut json, bin) = sound();
    json["nodes"] = json!([{"mesh": 0}, {"children": [2]}, {"mesh": 0, "translation": [5, 0, 0]}]);
    json.as_object_mut().unwrap().remove("skins");
    json["scenes"] = json!([{"nodes": [0]}, {"nodes": [1], "name": "spare"}, {"nodes": []}]);
    let read = |json: &Value, scene: Option<&str>| {
        plisse_live::gltf_in::scene_from_bytes("model.glb", &glb(json, &bin), None, scene)
    };
    let starts = |json: &Value, scene: Option<&str>| {
        let model = read(json, scene).unwrap();
        let starts: Vec<f32> = model.draw.positions.chunks(4).map(|c| c[0].x).collect();
        (starts, model.notes.join("\n"))
    };
    let (found, notes) = starts(&json, None);
    assert_eq!(found, [0.0]);
    assert!(notes.contains("only scene 0 of 3"), "{notes}");
    assert_eq!(starts(&json, Some("spare")).0, [5.0]);
    assert_eq!(starts(&json, Some("1")).0, [5.0]);
    let message = read(&json, Some("other")).unwrap_err().to_string();
    assert!(message.ends_with("; ask for one of 0, 1 (\"spare\"), 2"), "{message}");
    json["scene"] = json!(1);
    assert_eq!(starts(&json, None).0, [5.0]);
    // A default without meshes: all of them, and that is said.
    json["scene"] = json!(2);
    let (found, notes) = starts(&json, None);
    assert!(found == [0.0, 5.0] && notes.contains("shows no mesh"), "{notes}");
    json.as_object_mut().unwrap().remove("scenes");
    assert_eq!(starts(&json, None), (vec![0.0, 5.0], String::new()));
    assert!(read(&json, Some("spare")).is_err());
}

/// Parts of a file that this reader has no use for never make it unusable, even if they are broken.
#[test]
fn what_is_not_read_may_be_anything() {
    let (json, bin) = sound();
    let plain = from_bytes("model.glb", &glb(&json, &bin), None).unwrap();
    let with = |path: &str, value: Value| {
        let mut json = json.clone();
        let (parent, key) = path.rsplit_once('/').unwrap();
        json.pointer_mut(parent).unwrap()[key] = value;
        let model = from_bytes("model.glb", &glb(&json, &bin), None)
            .unwrap_or_else(|e| panic!("{path}: {e}"));
        assert_eq!(
            (&model.draw, &model.faces, &model.base_colour),
            (&plain.draw, &plain.faces, &None),
            "{path}"
        );
        model.clips.iter().map(|clip| clip.channels.len()).sum::<usize>()
    };
    let attribute = |name: &str| format!("/meshes/0/primitives/0/attributes/{name}");
    for (path, value) in [
        (&attribute("_WIND")[..], json!(1)),
        (&attribute("FOO"), json!(99)),
        ("/meshes/0/primitives/0/material", json!(7)),
        ("/nodes/2/camera", json!(3)),
        ("/nodes/2/extensions", json!({"KHR_lights_punctual": {"light": 3}})),
        ("/scene", json!(9)),
        ("/cameras", json!([{"type": "perspective"}])),
        ("/accessors/0/min", json!(null)),
        (
            "/materials",
            json!([{
                "alphaMode": "GLASS",
                "pbrMetallicRoughness": {"baseColorTexture": {"index": 5}},
            }]),
        ),
        ("/textures", json!([{"sampler": 9, "extensions": {"EXT_texture_webp": {"source": 0}}}])),
        ("/samplers", json!([{"wrapS": 3}])),
        ("/images", json!([{}])),
        (
            "/extensionsRequired",
            json!([
                "KHR_mesh_quantization",
                "KHR_texture_transform",
                "KHR_materials_unlit",
                "EXT_texture_webp"
            ]),
        ),
    ] {
        assert_eq!(with(path, value), 1, "{path}");
    }
    // Clips that move what is no node's property lose those channels only.
    let target = "/animations/0/channels/0/target";
    assert_eq!(
        with(
            target,
            json!({
                "path": "pointer",
                "extensions": {"KHR_animation_pointer": {"pointer": "/nodes/2/scale"}},
            })
        ),
        0
    );
    assert_eq!(with(target, json!({"path": "colour", "node": 2})), 0);
}

#[test]
fn the_base_colour_is_found_in_either_kind_of_material() {
    let (mut json, bin) = with_views(&[b"\x89PNG and so on".to_vec()]);
    json["textures"] = json!([{}, {"source": 1}]);
    // A view without a MIME type is a mistake that many files make.
    json["images"] = json!([{"uri": "nowhere.png"}, {"bufferView": 6}]);
    let texture = json!({"diffuseTexture": {"index": 1}});
    let glossy = json!({"extensions": {"KHR_materials_pbrSpecularGlossiness": texture}});
    for material in [json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 1}}}), glossy] {
        json["materials"] = json!([{"name": "plain"}, material]);
        let model = from_bytes("model.glb", &glb(&json, &bin), None).unwrap();
        assert_eq!(model.base_colour.as_deref(), Some(&b"\x89PNG and so on"[..]), "{material}");
    }
    for (view, source) in [(99, 1), (6, 0), (6, 7)] {
        (json["images"][1]["bufferView"], json["textures"][1]["source"]) =
            (json!(view), json!(source));
        assert_eq!(
            from_bytes("model.glb", &glb(&json, &bin), None).unwrap().base_colour,
            None,
            "{view} {source}"
        );
    }
}

#[test]
fn odd_files_give_a_still() {
    let (json, bin) = sound();
    for key in ["animations", "skins"] {
        let mut json = json.clone();
        json.as_object_mut().unwrap().remove(key);
        if key == "skins" {
            json["nodes"][0].as_object_mut().unwrap().remove("skin");
        }
        runs(&glb(&json, &bin));
    }
    // Weights of sum zero, and faces without an area.
    let mut zero = bin.clone();
    zero[76..80].fill(0);
    runs(&glb(&json, &zero));
    zero[12..48].fill(0);
    runs(&glb(&json, &zero));
    let model = from_bytes("flat", &glb(&json, &zero), None).unwrap();
    let welded = WeldedMesh::new(&model, 1e-5);
    let mut live = LiveState::default();
    live.step(&welded, &pose(&model, None, 0.0), &LiveOptions::new(0.1));
    assert_eq!(
        (live.waves.singular, live.waves.amplitude_m.iter().sum::<f32>()),
        (welded.count(), 0.0)
    );
}

#[test]
#[cfg_attr(not(published_data), ignore = "needs ../shared/data")]
fn the_fox_wrinkles_without_jumps() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/Fox.glb");
    let model = read(&path).unwrap();
    assert_eq!(
        (model.draw.positions.len(), model.faces.len(), model.nodes.len(), model.clips.len()),
        (1728, 576, 26, 3)
    );
    assert!(model.base_colour.as_ref().is_some_and(|b| b.starts_with(b"\x89PNG")));
    let welded = WeldedMesh::new(&model, 1e-5);
    assert!(welded.count() < 400, "{}", welded.count());
    for clip in &model.clips {
        let mut live = LiveState::default();
        let options = LiveOptions::new(6.0);
        let (mut worst, mut error, mut wrinkled) = (0f32, 0.0, 0.0);
        let frames = 180;
        for frame in 0..frames {
            let last = (live.waves.strength.clone(), live.phase.clone());
            live.step(
                &welded,
                &pose(&model, Some(clip), frame as f32 / 60.0 % clip.duration_s()),
                &options,
            );
            if frame > 0 {
                worst = worst.max(plisse_live::crush::phase_jump_share(
                    [&last.0, &live.waves.strength],
                    [&last.1, &live.phase],
                    0.05,
                ));
            }
            error += live.mean_phase_error(&welded) / frames as f32;
            wrinkled += live.waves.strength.iter().filter(|&&s| s >= 0.05).count() as f32
                / (frames * welded.count()) as f32;
        }
        eprintln!(
            "fox {}: {} vertices, {} singular, {:.0} % wrinkled, worst jump share {worst}, mean \
             phase error {error:.4}",
            clip.name,
            welded.count(),
            live.waves.singular,
            100.0 * wrinkled
        );
        assert!(worst <= 0.005 && wrinkled > 0.05 && error < 0.2);
    }
}
