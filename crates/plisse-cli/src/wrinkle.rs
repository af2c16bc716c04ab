//! `plisse wrinkle`: wrinkles on a pose made elsewhere.

use std::sync::atomic::AtomicBool;
use std::time::Instant;

use plisse::field::FieldOptions;
use plisse::io::clamp_file::read_clamped_vertices;
use plisse::io::obj;
use plisse::material::Material;
use plisse::mesh::Topology;
use plisse::mesh::check::{check_rest_faces, weld};
use plisse::rest::RestMetric;
use plisse::{Error, Result};

use crate::Done;
use crate::arguments::WrinkleArguments;
use crate::outputs::panel_texture;
use crate::progress::Bars;
use crate::road::{Posed, check_levels, finish, leave_out, open_output, with_threads};

pub(crate) fn run(arguments: &WrinkleArguments, interrupted: &AtomicBool) -> Result<Done> {
    let begun = Instant::now();
    let material = Material::new(arguments.young, arguments.poisson, arguments.thickness)?;
    let mut field = FieldOptions { rule: arguments.wrinkle_free.into(), ..FieldOptions::default() };
    leave_out(&mut field, &arguments.output.without)?;
    let rest = obj::read(&arguments.rest)?;
    let pose = obj::read_pose(&arguments.pose, &rest)?;
    let rest_name = arguments.rest.display().to_string();
    let pose_name = arguments.pose.display().to_string();
    if rest.faces.len() != pose.faces.len() {
        return Err(Error::mesh(
            &rest_name,
            format!(
                "it has {} triangles, but {pose_name} has {}; export both from the same mesh, with the same faces in the same order",
                rest.faces.len(),
                pose.faces.len()
            ),
        ));
    }
    check_rest_faces(&rest_name, &rest.positions, &rest.faces)?;
    let metric = RestMetric::from_shape(&rest_name, &rest.positions, &rest.faces)?;
    let welded = weld(&pose.positions, &pose.faces);
    let topology = Topology::new(&pose_name, welded.positions.len(), welded.faces.clone())?;
    let mut held = vec![false; topology.vertex_count];
    if let Some(path) = &arguments.clamp {
        for v in read_clamped_vertices(path, pose.positions.len())? {
            held[welded.vertex_of_input[v]] = true;
        }
    }
    let mut notes: Vec<String> = rest.warnings.iter().map(|w| format!("{rest_name}: {w}")).collect();
    notes.extend(pose.warnings.iter().map(|w| format!("{pose_name}: {w}")));
    let merged = pose.positions.len() - topology.vertex_count;
    if merged > 0 {
        notes.push(format!("{merged} vertices of {pose_name} at the same place as others were welded"));
    }
    if !pose.cuts.is_empty() {
        notes.push(format!("{} polygons of {pose_name} were cut into triangles", pose.cuts.len()));
    }
    let texture = match (&pose.texture_faces, &rest.texture_faces) {
        (Some(faces), _) => Some((pose.texture_coordinates.clone(), faces.clone())),
        (None, Some(faces)) => Some((rest.texture_coordinates.clone(), faces.clone())),
        (None, None) => panel_texture(&rest.positions, &rest.faces),
    };
    check_levels("--levels", arguments.output.levels.map(|levels| levels as usize), &topology)?;
    let folder = open_output(&arguments.output, &arguments.pose)?;
    let bars = Bars::new(interrupted);
    with_threads(arguments.output.threads, || {
        let posed = Posed {
            title: &pose_name,
            paper: None,
            topology: &topology,
            rest: &metric,
            rest_shape: (&rest.positions, &rest.faces),
            texture,
            pose: &welded.positions,
            held: &held,
            material: &material,
            field,
            levels: None,
            v1: false,
            v2: true,
            up: arguments.up,
            base: None,
            notes,
        };
        finish(posed, &arguments.output, folder, &bars, interrupted, begun, |_, _| Vec::new())
    })
}
