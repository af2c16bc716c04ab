//! glTF files of several parts: which vertices are welded, and where copies and mirrored parts are.

use plisse_live::Vec3;
use plisse_live::gltf_in::from_bytes;
use plisse_live::model::Model;
use plisse_live::skin::{pose, skin};
use plisse_live::weld::{WeldedMesh, vertex_normals};
use serde_json::{Value, json};

/// A .gltf file of one square strip, from (0, 0) over (1, 0) to (0, 1), in the making.
struct File {
    json: Value,
    bytes: Vec<u8>,
}

const SQUARE: [f32; 12] = [0., 0., 0., 1., 0., 0., 0., 1., 0., 1., 1., 0.];

impl File {
    /// The square on one node.
    fn new() -> Self {
        let json = json!({
            "asset": {"version": "2.0"}, "bufferViews": [], "accessors": [],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
            "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}],
        });
        let mut file = Self { json, bytes: Vec::new() };
        file.floats(&SQUARE, 3);
        file.add([0u8, 1, 2, 1, 3, 2].to_vec(), [5121, 6], "SCALAR");
        file
    }

    /// Adds an accessor; its number.
    fn add(&mut self, bytes: Vec<u8>, [kind, count]: [usize; 2], shape: &str) -> usize {
        let views = self.json["bufferViews"].as_array_mut().unwrap();
        let view = views.len();
        views.push(json!({
            "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len(),
        }));
        self.bytes.extend(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.json["accessors"].as_array_mut().unwrap().push(json!({
            "bufferView": view, "componentType": kind, "count": count, "type": shape,
        }));
        view
    }

    fn floats(&mut self, list: &[f32], width: usize) -> usize {
        let shape = ["SCALAR", "", "VEC3", "VEC4"][width - 1];
        let bytes = list.iter().flat_map(|x| x.to_le_bytes()).collect();
        self.add(bytes, [5126, list.len() / width], shape)
    }

    /// A clip that moves node `node` aside within a second.
    fn slide(&mut self, node: usize) {
        let (input, output) =
            (self.floats(&[0., 1.], 1), self.floats(&[0., 0., 0., 0., 2., 0.], 3));
        self.json["animations"] = json!([{
            "channels": [{"sampler": 0, "target": {"node": node, "path": "translation"}}],
            "samplers": [{"input": input, "output": output}],
        }]);
    }

    fn read(&self) -> Model {
        let mut json = self.json.clone();
        json["buffers"] = json!([{"byteLength": self.bytes.len()}]);
        let mut text = json.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let mut file = b"glTF\x02\0\0\0".to_vec();
        let length = 28 + text.len() + self.bytes.len();
        file.extend((length as u32).to_le_bytes());
        for (kind, chunk) in [(b"JSON", &text), (b"BIN\0", &self.bytes)] {
            file.extend((chunk.len() as u32).to_le_bytes());
            file.extend(kind);
            file.extend(chunk);
        }
        from_bytes("parts.glb", &file, None).unwrap()
    }

    fn welded(&self) -> usize {
        WeldedMesh::new(&self.read(), 1e-5).count()
    }
}

/// Two squares side by side, that touch along (1, 0)–(1, 1).
fn neighbours() -> File {
    let mut file = File::new();
    file.json["nodes"] = json!([{"mesh": 0}, {"mesh": 0, "translation": [1, 0, 0]}]);
    file.json["scenes"] = json!([{"nodes": [0, 1]}]);
    file
}

#[test]
fn parts_that_move_apart_only_touch() {
    let mut file = neighbours();
    assert_eq!(file.welded(), 6, "without a clip they are one rigid part");
    file.slide(1);
    assert_eq!(file.welded(), 8);
    // Both hang on the node that moves: one rigid part again.
    file.json["nodes"] = json!([
        {"mesh": 0}, {"mesh": 0, "translation": [1, 0, 0]}, {"children": [0, 1]},
    ]);
    file.json["scenes"] = json!([{"nodes": [2]}]);
    file.json["animations"][0]["channels"][0]["target"]["node"] = json!(2);
    assert_eq!(file.welded(), 6);
}

#[test]
fn lips_that_a_morph_target_parts_are_not_welded() {
    let mut file = File::new();
    // The same square twice, one above the other, in one primitive.
    let above: Vec<f32> = SQUARE.chunks(3).flat_map(|x| [x[0], x[1] + 1.0, 0.0]).collect();
    let both = [&SQUARE[..], &above].concat();
    let positions = file.floats(&both, 3);
    let indices = [0u8, 1, 2, 1, 3, 2, 4, 5, 6, 5, 7, 6];
    let indices = file.add(indices.to_vec(), [5121, 12], "SCALAR");
    file.json["meshes"][0]["primitives"][0] =
        json!({"attributes": {"POSITION": positions}, "indices": indices});
    assert_eq!(file.welded(), 6);
    // The upper one opens on its right: the left corner of the mouth stays closed.
    let mut shifts = [0f32; 24];
    (shifts[3 * 5 + 1], shifts[3 * 7 + 1]) = (0.3, 0.3);
    let target = file.floats(&shifts, 3);
    file.json["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": target}]);
    assert_eq!(file.welded(), 7);
}

#[test]
fn weights_that_differ_are_not_welded_but_those_of_eight_bits_are() {
    let mut file = neighbours();
    file.json["skins"] = json!([{"joints": [2, 3]}]);
    let joints = file.add([0u8, 1, 0, 0].repeat(4), [5121, 4], "VEC4");
    // Inverse bind matrices are identities; the second square is a mesh of its own.
    let shifted: Vec<f32> = SQUARE.chunks(3).flat_map(|x| [x[0] + 1.0, x[1], 0.0]).collect();
    let shifted = file.floats(&shifted, 3);
    let mut count = |share: f32| {
        let weights = [[0.5, 0.5, 0., 0.].repeat(4), [share, 1.0 - share, 0., 0.].repeat(4)]
            .map(|list| file.floats(&list, 4));
        let mesh = |positions: usize, weights: usize| {
            let attributes = json!({
                "POSITION": positions, "JOINTS_0": joints, "WEIGHTS_0": weights,
            });
            json!({"primitives": [{"attributes": attributes, "indices": 1}]})
        };
        file.json["meshes"] = json!([mesh(0, weights[0]), mesh(shifted, weights[1])]);
        file.json["nodes"] =
            json!([{"mesh": 0, "skin": 0}, {"mesh": 1, "skin": 0}, {"children": [3]}, {}]);
        file.json["scenes"] = json!([{"nodes": [0, 1, 2]}]);
        file.slide(3);
        file.welded()
    };
    // Two meshes on one skin: the same joints, though each brings its own.
    assert_eq!(count(0.5), 6);
    assert_eq!(count(0.502), 6);
    assert_eq!(count(0.3), 8);
}

/// The smallest cosine between a vertex's normal and the mean of its posed faces'.
fn outward(model: &Model) -> f32 {
    let posed = skin(&model.draw, &pose(model, None, 0.0));
    let turned = vertex_normals(&posed.positions, &model.faces);
    posed.normals.iter().zip(&turned).map(|(a, b)| a.dot(b)).fold(1.0, f32::min)
}

#[test]
fn faces_of_mirrored_nodes_show_their_outside() {
    let mut file = File::new();
    let up = file.floats(&[0., 0., 1.].repeat(4), 3);
    for normals in [false, true] {
        if normals {
            file.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = json!(up);
        }
        for scale in [[1., 1., 1.], [-1., 1., 1.], [1., -2., 1.], [-1., -1., 1.]] {
            file.json["nodes"] = json!([{"mesh": 0, "scale": scale}]);
            let model = file.read();
            let posed = skin(&model.draw, &pose(&model, None, 0.0));
            assert!(outward(&model) > 0.999, "{scale:?}");
            assert!(posed.normals.iter().all(|n| n.z > 0.999), "{scale:?}");
            assert!((posed.positions[3] - Vec3::new(scale[0], scale[1], 0.0)).norm() < 1e-6);
        }
    }
}

#[test]
fn faces_of_mirrored_skeletons_show_their_outside() {
    let mut file = File::new();
    let joints = file.add([0u8; 16].to_vec(), [5121, 4], "VEC4");
    let weights = file.floats(&[1., 0., 0., 0.].repeat(4), 4);
    let attributes = json!({"POSITION": 0, "JOINTS_0": joints, "WEIGHTS_0": weights});
    file.json["meshes"][0]["primitives"][0]["attributes"] = attributes;
    file.json["skins"] = json!([{"joints": [1]}]);
    for side in [1.0, -1.0] {
        file.json["nodes"] = json!([{"mesh": 0, "skin": 0}, {"scale": [1, side, 1]}]);
        let model = file.read();
        let posed = skin(&model.draw, &pose(&model, None, 0.0));
        assert!(outward(&model) > 0.999, "{side}");
        assert!((posed.positions[3] - Vec3::new(1.0, side, 0.0)).norm() < 1e-6);
        let normal = vertex_normals(&posed.positions, &model.faces)[0];
        assert!(normal.z > 0.999, "{side}: the front of the square is up");
    }
}

#[test]
fn instances_are_drawn_at_their_places() {
    let mut file = File::new();
    let places = file.floats(&[0., 0., 0., 4., 0., 0., 8., 0., 0.], 3);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let turns = file.floats(&[0., 0., 0., 1., 0., 0., half, half, 0., 0., 0., 1.], 4);
    let scales = file.floats(&[1., 1., 1., 1., 1., 1., 2., 2., 2.], 3);
    let target = file.floats(&[0., 0., 1.].repeat(4), 3);
    file.json["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": target}]);
    file.json["nodes"] = json!([{"mesh": 0, "weights": [0.5], "translation": [0, 9, 0],
        "extensions": {"EXT_mesh_gpu_instancing": {"attributes":
            {"TRANSLATION": places, "ROTATION": turns, "SCALE": scales}}}}]);
    file.json["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]);
    file.slide(0);
    let model = file.read();
    assert_eq!((model.draw.positions.len(), model.faces.len()), (12, 6));
    assert_eq!((model.draw.morphs.len(), model.clips[0].channels.len()), (1, 1));
    // The clip puts the node at (0, 1, 0); vertex 1 is (1, 0, 0), lifted by half the target.
    let posed = skin(&model.draw, &pose(&model, Some(&model.clips[0]), 0.5)).positions;
    for (v, place) in [(1, [1., 1., 0.5]), (5, [4., 2., 0.5]), (9, [10., 1., 1.0])] {
        assert!((posed[v] - Vec3::from(place)).norm() < 1e-5, "{v}: {}", posed[v]);
    }
}

#[test]
fn a_node_that_grows_from_nothing_has_its_full_size_at_rest() {
    let mut file = File::new();
    let zero = [0., 0., 0., 0., 0., 0., 0., 0., 0., 0., 0., 0., 0., 0., 0., 1.];
    for node in [json!({"scale": [0, 0, 0]}), json!({"matrix": zero})] {
        file.json["nodes"] = json!([node, {"children": [0], "scale": [3, 3, 3]}]);
        file.json["nodes"][0]["mesh"] = json!(0);
        file.json["scenes"] = json!([{"nodes": [1]}]);
        let model = file.read();
        assert!((model.draw.positions[3] - Vec3::new(3.0, 3.0, 0.0)).norm() < 1e-6);
        let posed = skin(&model.draw, &pose(&model, None, 0.0)).positions;
        assert!(posed.iter().all(|x| x.norm() < 1e-6));
    }
}
