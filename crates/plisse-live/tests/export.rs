//! Wrinkled geometry in files: what is read back is what was written.

use std::collections::HashMap;

use plisse_live::export::{FrameInterpolation, check_size, write_sequence, write_still};
use plisse_live::fine_mesh::{FineMesh, refine, suggest_parts};
use plisse_live::gltf_in::from_bytes;
use plisse_live::live::{Frame, LiveOptions};
use plisse_live::model::Model;
use plisse_live::play::Player;
use plisse_live::profile::Profile;
use plisse_live::skin::{pose, skin};
use plisse_live::weld::{WeldedMesh, fill_normals};
use plisse_live::{Vec3, models};

fn made(mut model: Model) -> (Model, WeldedMesh) {
    let welded = WeldedMesh::new(&model, 1e-5);
    fill_normals(&mut model, &welded);
    (model, welded)
}

fn fine_at(
    model: &Model,
    welded: &WeldedMesh,
    wavelength_m: f32,
    times: &[f32],
    parts: usize,
) -> Vec<FineMesh> {
    let options = LiveOptions::new(wavelength_m);
    let mut player = Player::new(model, welded, &options, None).unwrap();
    times
        .iter()
        .map(|&t| {
            let drawn = player.play_to(t);
            let frame = Frame { state: &player.state, drawn: &drawn };
            refine(model, welded, &frame, &Profile::sine(), parts)
        })
        .collect()
}

/// The numbers of an accessor by the `gltf` crate's own idea of the file, checked for alignment and
/// bounds.
fn numbers(file: &gltf::Gltf, accessor: &gltf::Accessor<'_>) -> Vec<f32> {
    let view = accessor.view().unwrap();
    let (start, width) = (view.offset() + accessor.offset(), accessor.dimensions().multiplicity());
    assert_eq!((start % 4, accessor.data_type()), (0, gltf::accessor::DataType::F32));
    let bytes = &file.blob.as_ref().unwrap()[start..start + 4 * width * accessor.count()];
    let list: Vec<f32> =
        bytes.chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect();
    for (bound, pick) in
        [(accessor.min(), f32::min as fn(f32, f32) -> f32), (accessor.max(), f32::max)]
    {
        if let Some(bound) = bound {
            for (k, x) in bound.as_array().unwrap().iter().enumerate() {
                assert_eq!(
                    x.as_f64().unwrap() as f32,
                    list.iter().skip(k).step_by(width).copied().reduce(pick).unwrap()
                );
            }
        }
    }
    list
}

fn flat(list: &[Vec3]) -> Vec<f32> {
    list.iter().flat_map(|x| [x.x, x.y, x.z]).collect()
}

#[test]
fn divided_faces_meet_and_lie_on_the_waves() {
    let (model, welded) = made(models::sleeve());
    let parts = 5;
    let fine = &fine_at(&model, &welded, 0.04, &[1.0], parts)[0];
    assert_eq!(fine.faces.len(), model.faces.len() * parts * parts);
    // Euler's number is that of the coarse mesh as it is drawn (a strip, cut open at the seam), so
    // nothing is doubled or torn.
    let euler = |faces: &[[u32; 3]], vertices: usize| {
        let mut edges: HashMap<[u32; 2], usize> = HashMap::new();
        for f in faces {
            (0..3).for_each(|k| {
                *edges.entry([f[k].min(f[(k + 1) % 3]), f[k].max(f[(k + 1) % 3])]).or_default() += 1
            });
        }
        assert!(edges.values().all(|&n| n <= 2));
        vertices as i64 - edges.len() as i64 + faces.len() as i64
    };
    assert_eq!(
        euler(&fine.faces, fine.positions.len()),
        euler(&model.faces, model.draw.positions.len())
    );
    // Faces keep their side (but where waves are steep), and the seam's two sides stay together.
    let kept = fine.faces.iter().filter(|f| {
        let [a, b, c] = f.map(|v| fine.positions[v as usize]);
        (b - a).cross(&(c - a)).dot(&f.iter().map(|&v| fine.normals[v as usize]).sum::<Vec3>())
            > 0.0
    });
    let share = kept.count() as f32 / fine.faces.len() as f32;
    assert!(share > 0.98, "{share}");
    for i in 0..25 {
        assert!((fine.positions[i * 21] - fine.positions[i * 21 + 20]).norm() < 1e-6);
    }
    // Not flat: some vertices are as high as the waves.
    let draw = &fine_at(&model, &welded, 0.04, &[1.0], 1)[0];
    let flat_model = LiveOptions { wavelength_m: vec![1e-6], ..LiveOptions::new(1e-6) };
    let mut player = Player::new(&model, &welded, &flat_model, None).unwrap();
    let base = player.play_to(1.0);
    let off =
        draw.positions.iter().zip(&base.positions).map(|(a, b)| (a - b).norm()).fold(0.0, f32::max);
    assert!(off > 0.004 && off <= 0.0101, "{off}");
    assert!((5..=6).contains(&suggest_parts(&welded, 0.04, 8.0)));
}

#[test]
fn a_still_comes_back_as_it_was_written() {
    let (mut model, welded) = made(models::shirt());
    model.base_colour = Some(b"\x89PNG\r\n\x1a\nnot really one".to_vec());
    let fine = &fine_at(&model, &welded, 0.06, &[0.8], 4)[0];
    let mut bytes = Vec::new();
    write_still(&mut bytes, &model, fine).unwrap();
    let file = gltf::Gltf::from_slice(&bytes).unwrap();
    let primitive = file.meshes().next().unwrap().primitives().next().unwrap();
    let get = |semantic: gltf::Semantic| numbers(&file, &primitive.get(&semantic).unwrap());
    assert_eq!(get(gltf::Semantic::Positions), flat(&fine.positions));
    assert_eq!(get(gltf::Semantic::Normals), flat(&fine.normals));
    assert_eq!(
        get(gltf::Semantic::TexCoords(0)),
        fine.uvs.iter().flat_map(|uv| [uv.x, uv.y]).collect::<Vec<f32>>()
    );
    let back = from_bytes("out.glb", &bytes, None).unwrap();
    assert_eq!(
        (&back.draw.positions, &back.uvs, &back.faces),
        (&fine.positions, &fine.uvs, &fine.faces)
    );
    assert_eq!(back.base_colour, model.base_colour);
    assert!(fine.normals.iter().all(|n| (n.norm() - 1.0).abs() < 1e-5));
}

#[test]
fn an_animation_shows_each_frame_at_its_time() {
    let (model, welded) = made(models::sleeve());
    let times: Vec<f32> = (0..7).map(|k| k as f32 / 10.0).collect();
    let frames = fine_at(&model, &welded, 0.04, &times, 3);
    let error =
        |a: &[Vec3], b: &[Vec3]| a.iter().zip(b).map(|(a, b)| (a - b).norm()).fold(0.0, f32::max);
    assert!(error(&frames[0].positions, &frames[6].positions) > 0.05, "it moves");
    for between in [FrameInterpolation::Step, FrameInterpolation::Linear] {
        let mut bytes = Vec::new();
        write_sequence(&mut bytes, &model, &frames, 10.0, between).unwrap();
        let file = gltf::Gltf::from_slice(&bytes).unwrap();
        let primitive = file.meshes().next().unwrap().primitives().next().unwrap();
        assert_eq!(primitive.morph_targets().count(), 6);
        for (k, target) in primitive.morph_targets().enumerate() {
            let position = target.positions().unwrap();
            assert!(position.min().is_some() && position.max().is_some());
            let shift: Vec<Vec3> = frames[k + 1]
                .positions
                .iter()
                .zip(&frames[0].positions)
                .map(|(a, b)| a - b)
                .collect();
            assert_eq!(numbers(&file, &position), flat(&shift));
        }
        let back = from_bytes("out.glb", &bytes, None).unwrap();
        let clip = back.clip(Some("wrinkles")).unwrap();
        assert!((clip.duration_s() - 0.6).abs() < 1e-6);
        for (k, frame) in frames.iter().enumerate() {
            let posed = skin(&back.draw, &pose(&back, Some(clip), k as f32 / 10.0));
            assert!(error(&posed.positions, &frame.positions) < 1e-6, "frame {k}");
        }
        let half = skin(&back.draw, &pose(&back, Some(clip), 0.25)).positions;
        let middle: Vec<Vec3> = frames[2]
            .positions
            .iter()
            .zip(&frames[3].positions)
            .map(|(a, b)| 0.5 * (a + b))
            .collect();
        match between {
            FrameInterpolation::Step => assert!(error(&half, &frames[2].positions) < 1e-6),
            FrameInterpolation::Linear => assert!(error(&half, &middle) < 1e-6),
        }
    }
}

#[test]
fn what_cannot_be_written_is_told() {
    let (model, welded) = made(models::sleeve());
    let frames = fine_at(&model, &welded, 0.04, &[0.0, 0.1], 1);
    let mut broken = frames[0].clone();
    broken.positions[3].x = f32::NAN;
    assert!(
        write_still(&mut Vec::new(), &model, &broken)
            .unwrap_err()
            .to_string()
            .contains("position (3)")
    );
    assert!(
        write_sequence(&mut Vec::new(), &model, &frames, 0.0, FrameInterpolation::Step).is_err()
    );
    assert!(write_sequence(&mut Vec::new(), &model, &[], 10.0, FrameInterpolation::Step).is_err());
    let other = fine_at(&model, &welded, 0.04, &[0.0], 2).remove(0);
    assert!(
        write_sequence(
            &mut Vec::new(),
            &model,
            &[frames[0].clone(), other],
            10.0,
            FrameInterpolation::Step
        )
        .is_err()
    );
    check_size(&model, 8, 100).unwrap();
    let message = check_size(&model, 8, 5000).unwrap_err().to_string();
    assert!(message.contains("512 MB; give") && message.contains("or fewer"), "{message}");
    let most: usize =
        message.split("give ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!(check_size(&model, 8, most).is_ok() && check_size(&model, 8, most + 1).is_err());
    assert!(check_size(&model, 1000, 1).unwrap_err().to_string().contains("fewer parts"));
}
