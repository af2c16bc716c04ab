//! Maps baked from live waves.

use plisse::bake::{Coverage, Options};
use plisse_live::live::{Frame, LiveOptions};
use plisse_live::play::Player;
use plisse_live::profile::Profile;
use plisse_live::weld::{WeldedMesh, fill_normals};
use plisse_live::{Vec2, bake, models};

const W: f32 = 0.08;

#[test]
fn the_contracted_square_bakes_to_the_waves_it_draws() {
    let mut model = models::square().unwrap();
    let welded = WeldedMesh::new(&model, 1e-5);
    fill_normals(&mut model, &welded);
    let options = LiveOptions::new(W);
    let mut player = Player::new(&model, &welded, &options, Some("contract")).unwrap();
    let drawn = player.play_to(2.0);
    let frame = Frame { state: &player.state, drawn: &drawn };
    let n = 256;
    let baked =
        bake::bake(&model, &welded, &frame, &Profile::sine(), &Options { size: n, padding: 4 })
            .unwrap();
    assert_eq!((baked.overlapping, baked.missed_faces), (0, 0));
    // Every texel against the face that is drawn there.
    let faces = bake::faces(&model, &welded, &frame);
    let (mut met, mut slopes) = (0, 0.0f32);
    for face in &faces {
        for weights in [[0.4, 0.35, 0.25], [0.2, 0.2, 0.6]] {
            let point = face.at(weights, &Profile::sine());
            let (x, y) = ((point.uv.x * n as f32) as usize, (point.uv.y * n as f32) as usize);
            let at = y.min(n - 1) * n + x.min(n - 1);
            assert_eq!(baked.coverage[at], Coverage::Covered);
            // The texel's centre is up to 0.7 texels off, 2 % of a wave.
            let off = (baked.height_m[at] - point.height_m).abs();
            assert!(off < 0.7 / n as f32 * 1.5 * std::f32::consts::TAU / W * 0.25 * W, "{off}");
            met += 1;
            slopes = slopes.max(-baked.normal[at][0] / baked.normal[at][2]);
        }
    }
    let h = 0.25 * W * (1.0f32 - 0.75 * 0.75).sqrt();
    let highest = baked.height_m.iter().fold(0f32, |a, x| a.max(*x));
    assert!(met > 250 && (highest / h - 1.0).abs() < 0.02, "{highest} {h}");
    let steepest = h * std::f32::consts::TAU / (0.75 * W);
    assert!((slopes / steepest - 1.0).abs() < 0.05, "{slopes} {steepest}");
    assert!(highest <= bake::largest_height_m(&[W], &Profile::sine()));
}

#[test]
fn what_cannot_be_baked_is_told() {
    let mut model = models::sleeve();
    let welded = WeldedMesh::new(&model, 1e-5);
    let options = LiveOptions::new(0.03);
    assert!(
        Player::new(&model, &welded, &options, Some("jump"))
            .unwrap_err()
            .to_string()
            .contains("give one of bend")
    );
    let mut player = Player::new(&model, &welded, &options, None).unwrap();
    assert_eq!(player.clip().unwrap().name, "bend");
    let drawn = player.play_to(0.5);
    assert_eq!(player.state.frame, 31);
    let with = |uv: fn(Vec2) -> Vec2, model: &mut plisse_live::model::Model| {
        model.uvs.iter_mut().for_each(|x| *x = uv(*x));
        let frame = Frame { state: &player.state, drawn: &drawn };
        bake::bake(model, &welded, &frame, &Profile::sine(), &Options { size: 32, padding: 1 })
    };
    assert!(with(|uv| uv, &mut model).is_ok());
    let message = with(|uv| uv * 2.0, &mut model).unwrap_err().to_string();
    assert!(message.contains("outside the unit square; pack"), "{message}");
    let message = with(|_| Vec2::zeros(), &mut model).unwrap_err().to_string();
    assert!(message.contains("; unwrap"), "{message}");
}
