//! EXT_mesh_gpu_instancing: one mesh on a node, drawn at many places.

use nalgebra::UnitQuaternion;
use plisse::Result;
use serde_json::Value;

use super::Reader;
use super::trim::{each, index};
use crate::Vec3;
use crate::model::{Node, quaternion};

/// Name of the extension.
const EXTENSION: &str = "EXT_mesh_gpu_instancing";

/// The places at which the mesh of one node is drawn.
pub(super) struct Copies {
    node: usize,
    /// Accessors of translations, rotations and scales.
    accessors: [Option<usize>; 3],
}

/// The copies that `root`, the JSON of a file, asks for.
pub(super) fn copies(root: &Value) -> Vec<Copies> {
    let of = |(node, value): (usize, &Value)| {
        let attributes = value["extensions"][EXTENSION]["attributes"].as_object()?;
        let accessors =
            ["TRANSLATION", "ROTATION", "SCALE"].map(|name| attributes.get(name).and_then(index));
        accessors.iter().any(Option::is_some).then_some(Copies { node, accessors })
    };
    each(&root["nodes"]).enumerate().filter_map(of).collect()
}

impl Reader<'_> {
    /// Adds a node for each copy, below the node of its mesh.
    pub(super) fn copies(&mut self, file: &gltf::Document, copies: &[Copies]) -> Result<()> {
        for Copies { node, accessors } in copies {
            let what = format!("node {node}, {EXTENSION}");
            if file.nodes().nth(*node).is_some_and(|n| n.skin().is_some()) {
                let note = format!("{what}: a mesh with a skin is drawn once, at its joints");
                self.model.notes.push(note);
                continue;
            }
            let mut lists: [Option<Vec<f32>>; 3] = Default::default();
            for (k, width) in [3, 4, 3].into_iter().enumerate() {
                let Some(number) = accessors[k] else { continue };
                let Some(accessor) = file.accessors().nth(number) else {
                    return self.bad(format!(
                        "{what} names accessor {number}, which is not there; export the file again"
                    ));
                };
                lists[k] = Some(self.accessors.numbers(&accessor, width, &what)?);
            }
            let counts =
                [(0, 3), (1, 4), (2, 3)].map(|(k, w)| lists[k].as_ref().map(|l| l.len() / w));
            let count = counts.iter().flatten().max().copied().unwrap_or(0);
            if counts.iter().flatten().any(|&c| c != count) {
                return self.bad(format!(
                    "{what} gives each copy not one value of each kind; export the file again"
                ));
            }
            let [translations, rotations, scales] = &lists;
            let vector = |list: &Option<Vec<f32>>, c: usize, or: f32| {
                list.as_ref()
                    .map_or(Vec3::repeat(or), |l| Vec3::from_column_slice(&l[3 * c..][..3]))
            };
            let first = self.model.nodes.len();
            self.model.nodes.extend((0..count).map(|c| {
                Node {
                    parent: Some(*node),
                    translation: vector(translations, c, 0.0),
                    rotation: rotations
                        .as_ref()
                        .map_or_else(UnitQuaternion::identity, |l| quaternion(&l[4 * c..][..4])),
                    scale: vector(scales, c, 1.0),
                }
            }));
            self.model.node_order.extend(first..first + count);
            self.copies_of_node[*node] = (first..first + count).collect();
        }
        Ok(())
    }
}
