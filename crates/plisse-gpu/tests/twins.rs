//! Every stage on the GPU against its twin, on each model and on a real one; and characters in one
//! pass against each alone.
//!
//! Without an adapter these tests have nothing to run on and say so; with `PLISSE_NEED_GPU` set
//! (scripts/test.sh sets it once it has installed a software driver) they fail instead.

use std::path::Path;

use plisse_gpu::{Character, Faces, Gpu, Live, Painter};
use plisse_live::camera::Camera;
use plisse_live::crush::{CrushInput, Crushed, crush};
use plisse_live::draw::{Look, Picture, SAMPLES, draw};
use plisse_live::gather::gather;
use plisse_live::live::LiveOptions;
use plisse_live::model::{Model, Morph};
use plisse_live::profile::Profile;
use plisse_live::relax::{mismatch, relax, spread};
use plisse_live::render::Corner;
use plisse_live::shade::from_srgb;
use plisse_live::skin::{Pose, Skinned, pose, skin};
use plisse_live::texture::Texture;
use plisse_live::unify::{Unified, fill_normals};
use plisse_live::{Vec3, bias, field, gltf_in, models, wrap};

/// Largest differences between a stage and its twin, given the same input.
/// Positions, as a share of the model's size.
const POSITION: f32 = 1e-5;
/// Normals (no unit).
const NORMAL: f32 = 1e-4;
/// Strength, as a share of the largest: the root in eq. 2 magnifies round-off where it is small.
const STRENGTH: f32 = 2e-3;
/// Wave vectors, as a share of their length, where wrinkles are visible and have one direction.
const WAVE: f32 = 2e-3;
/// Phases (rad), where no neighbour is exactly half a wave away.
const PHASE: f32 = 1e-3;
/// Light (linear, of 1), on all but a few pixels: drivers decode sRGB and blend texels with few
/// bits.
const LIGHT: f32 = 0.02;
/// Share of pixels that may differ by more: edges, where a rasteriser may decide either way, and
/// steep parallax.
const EDGES: f32 = 0.01;

fn gpu() -> Option<Gpu> {
    match Gpu::new() {
        Ok(gpu) => Some(gpu),
        Err(e) if std::env::var_os("PLISSE_NEED_GPU").is_some() => panic!("{e}"),
        Err(e) => {
            eprintln!("not run: {e}");
            None
        }
    }
}

fn fox() -> Option<Model> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/Fox.glb");
    let model = gltf_in::read(&path);
    assert!(model.is_ok() || std::env::var_os("PLISSE_NEED_DATA").is_none(), "{model:?}");
    model.ok()
}

/// A model with its unified vertices and a wavelength that suits it.
struct Subject {
    model: Model,
    unified: Unified,
    wavelength_m: f32,
}

impl Subject {
    fn new(mut model: Model) -> Self {
        let unified = Unified::new(&model, 1e-5);
        fill_normals(&mut model, &unified);
        let low =
            unified.vertices.positions.iter().fold(Vec3::repeat(f32::INFINITY), |a, p| a.inf(p));
        let high = unified
            .vertices
            .positions
            .iter()
            .fold(Vec3::repeat(f32::NEG_INFINITY), |a, p| a.sup(p));
        Self { wavelength_m: 0.06 * (high - low).norm(), model, unified }
    }

    fn character(&self) -> Character<'_> {
        Character {
            model: &self.model,
            unified: &self.unified,
            wavelength_m: std::slice::from_ref(&self.wavelength_m),
            bias: &[],
        }
    }

    fn pose(&self, time_s: f32) -> Pose {
        pose(&self.model, self.model.clip(None), time_s)
    }

    fn size(&self) -> f32 {
        self.wavelength_m / 0.06
    }

    fn times(&self) -> Vec<f32> {
        let end = self.model.clip(None).map_or(0.0, |c| c.duration_s());
        (0..5).map(|i| end * i as f32 / 5.0 + 0.01).collect()
    }
}

fn subjects() -> Vec<Subject> {
    let own = [
        models::square().unwrap(),
        models::curtain().unwrap(),
        models::zeppelin(),
        models::shirt(),
        models::sleeve(),
    ];
    own.into_iter().chain(fox()).map(Subject::new).collect()
}

fn options(subject: &Subject) -> LiveOptions {
    LiveOptions {
        rounds: 1,
        first_rounds: 20,
        spread_new: false,
        ..LiveOptions::new(subject.wavelength_m)
    }
}

fn check_skin(found: &Skinned, twin: &Skinned, size: f32) -> Result<(), String> {
    for v in 0..twin.positions.len() {
        let off = (found.positions[v] - twin.positions[v]).norm();
        let turned = (found.normals[v] - twin.normals[v]).norm();
        if off.is_nan() || off > POSITION * size || turned > NORMAL {
            return Err(format!("vertex {v} is off by {off} m, its normal by {turned}"));
        }
    }
    Ok(())
}

/// Also tells how many wave vectors were compared.
fn check_crush(
    found: &Crushed,
    twin: &Crushed,
    distinct: impl Fn(usize) -> bool,
) -> Result<usize, String> {
    let mut compared = 0;
    for v in 0..twin.strength.len() {
        let strength = (found.strength[v] - twin.strength[v]).abs();
        if strength.is_nan() || strength > STRENGTH {
            return Err(format!(
                "strength at {v} is {} instead of {}",
                found.strength[v], twin.strength[v]
            ));
        }
        if twin.strength[v] > 0.05 && distinct(v) {
            compared += 1;
            let (a, b) = (found.wave[v], twin.wave[v]);
            let off = (a - b).norm().min((a + b).norm()) / b.norm();
            if off.is_nan() || off > WAVE {
                return Err(format!("wave at {v} is {a} instead of {b}"));
            }
        }
    }
    Ok(compared)
}

fn check_relax(found: &[f32], twin: &[f32], torn: impl Fn(usize) -> bool) -> Result<(), String> {
    for v in 0..twin.len() {
        let off = wrap(found[v] - twin[v]).abs();
        if !torn(v) && (off.is_nan() || off > PHASE) {
            return Err(format!("phase at {v} is {} instead of {}", found[v], twin[v]));
        }
    }
    Ok(())
}

fn check_gather(found: &[[f32; 40]], twin: &[[Corner; 3]], size: f32) -> Result<(), String> {
    for (f, (face, corners)) in found.iter().zip(twin).enumerate() {
        for (c, corner) in corners.iter().enumerate() {
            let vector = |at: usize| Vec3::from_column_slice(&face[at + 4 * c..at + 4 * c + 3]);
            let same = vector(0) == corner.position
                && vector(24) == corner.wave
                && (vector(12) - corner.normal).norm() < NORMAL;
            let amplitude = (face[4 * c + 3] - corner.amplitude_m).abs() < 1e-6 * size;
            if !(same
                && amplitude
                && face[12 + 4 * c + 3] == corner.phase
                && [face[24 + 4 * c + 3], face[36 + c]] == [corner.uv.x, corner.uv.y])
            {
                return Err(format!("corner {c} of face {f} is not {corner:?}"));
            }
        }
    }
    Ok(())
}

fn check_picture(found: &Picture, twin: &Picture) -> Result<f32, String> {
    let off =
        |(a, b): &(&[u8], &[u8])| (0..3).any(|c| (from_srgb(a[c]) - from_srgb(b[c])).abs() > LIGHT);
    let share = found.image.pixels.chunks(3).zip(twin.image.pixels.chunks(3)).filter(off).count()
        as f32
        / twin.covered.max(1) as f32;
    let covered = (found.covered as f32 / twin.covered.max(1) as f32 - 1.0).abs();
    if share > EDGES || covered > EDGES {
        return Err(format!("{share} of the model's pixels differ, {covered} in number"));
    }
    Ok(share)
}

#[test]
fn every_stage_is_its_twin() {
    let Some(gpu) = gpu() else { return };
    for subject in subjects() {
        let (name, unified) = (&subject.model.name, &subject.unified);
        let characters = [subject.character()];
        let options = options(&subject);
        let mut live = Live::new(&gpu, &characters).unwrap();
        let times = subject.times();
        live.begin(&gpu, &characters, &[&subject.pose(times[0])], &options).unwrap();
        let mut before = live.read(&gpu).unwrap();
        let mut compared = 0;
        for &time_s in &times[1..] {
            let now = subject.pose(time_s);
            live.step(&gpu, &[&now], &options).unwrap();
            let found = live.read(&gpu).unwrap();
            // Skin.
            let skinned = skin(&unified.vertices, &now);
            check_skin(&found.posed, &skinned, subject.size())
                .unwrap_or_else(|e| panic!("{name}: skin: {e}"));
            let later = skin(&unified.vertices, &subject.pose(time_s + 0.1));
            // Crush, of the vertices as the GPU placed them.
            let input = |w| CrushInput {
                wavelength_m: w,
                bias: &[],
                last_direction: &before.crushed.direction,
            };
            let crushed = crush(unified, &found.posed, &input(&options.wavelength_m));
            // A direction is distinct if a small squeeze along it changes the strength's direction
            // little: compare with a biased twin.
            let along: Vec<Vec3> = crushed.direction.iter().map(slanted).collect();
            let tilted = crush(
                unified,
                &found.posed,
                &CrushInput { bias: &along, ..input(&options.wavelength_m) },
            );
            let distinct = |v: usize| tilted.direction[v].dot(&crushed.direction[v]).abs() > 0.999;
            compared += check_crush(&found.crushed, &crushed, distinct)
                .unwrap_or_else(|e| panic!("{name}: crush: {e}"));
            // Relax, one round.
            let mut phase = vec![0.0; found.phase.len()];
            relax(
                unified,
                &found.posed.positions,
                &found.crushed,
                options.rate,
                &before.phase,
                &mut phase,
            );
            let torn = |v: usize| {
                let waves = |&n: &u32| {
                    mismatch(&found.crushed, &found.posed.positions, &before.phase, v, n as usize)
                };
                unified.around(v).iter().map(waves).any(|e| e.abs() > 0.499)
            };
            check_relax(&found.phase, &phase, torn)
                .unwrap_or_else(|e| panic!("{name}: relax: {e}"));
            // Gather: a copy, so the same numbers.
            let drawn = skin(&subject.model.draw, &now);
            let corners =
                gather(&subject.model, unified, &found.posed, &drawn, &found.crushed, &found.phase);
            let faces = live.read_faces(&gpu).unwrap();
            check_gather(&faces, &corners, subject.size())
                .unwrap_or_else(|e| panic!("{name}: gather: {e}"));
            let mut elsewhere = corners.clone();
            elsewhere[0][2].phase += 1e-3;
            assert!(check_gather(&faces, &elsewhere, subject.size()).is_err(), "{name}");
            // Each comparison is shown to fail, on models that move.
            if (0..skinned.positions.len())
                .any(|v| (later.positions[v] - skinned.positions[v]).norm() > 1e-3 * subject.size())
            {
                assert!(check_skin(&found.posed, &later, subject.size()).is_err(), "{name}");
            }
            let wider = crush(unified, &found.posed, &input(&[1.01 * subject.wavelength_m]));
            if crushed.strength.iter().any(|&s| s > 0.1) {
                assert!(check_crush(&found.crushed, &wider, distinct).is_err(), "{name}");
                let mut other = vec![0.0; phase.len()];
                relax(
                    unified,
                    &found.posed.positions,
                    &found.crushed,
                    0.5 * options.rate,
                    &before.phase,
                    &mut other,
                );
                let moved = (0..phase.len())
                    .any(|v| !torn(v) && wrap(other[v] - phase[v]).abs() > 2.0 * PHASE);
                assert_eq!(check_relax(&found.phase, &other, torn).is_err(), moved, "{name}");
            }
            before = found;
        }
        assert!(
            compared > unified.count() / 20,
            "{name}: only {compared} wave vectors were compared"
        );
    }
}

/// A bias that squeezes along `k` by a tenth of a percent across a slanted direction.
fn slanted(k: &Vec3) -> Vec3 {
    let aside = k.cross(&Vec3::new(0.31, 0.77, 0.56)).try_normalize(1e-6).unwrap_or_else(Vec3::x);
    (k + aside).normalize() * 0.03
}

#[test]
fn render_is_its_twin() {
    let Some(gpu) = gpu() else { return };
    let size = [240, 200];
    for subject in subjects() {
        let name = &subject.model.name;
        let characters = [subject.character()];
        let mut live = Live::new(&gpu, &characters).unwrap();
        let now = subject.pose(subject.times()[3]);
        live.begin(&gpu, &characters, &[&now], &options(&subject)).unwrap();
        let found = live.read(&gpu).unwrap();
        let texture = match &subject.model.base_colour {
            Some(bytes) => Texture::decode(name, bytes).unwrap(),
            None => Texture::checked(),
        };
        let drawn = skin(&subject.model.draw, &now);
        let faces = gather(
            &subject.model,
            &subject.unified,
            &found.posed,
            &drawn,
            &found.crushed,
            &found.phase,
        );
        let camera =
            Camera::fit(found.posed.positions.iter(), 0.6, 0.3, size[0] as f32 / size[1] as f32);
        let painter = Painter::new(&gpu, size, SAMPLES, &[&texture]).unwrap();
        for (profile, parallax) in [(Profile::sine(), true), (Profile::accordion(), false)] {
            let look =
                Look { profile: &profile, texture: &texture, colour: Vec3::repeat(1.0), parallax };
            painter.draw(&gpu, &mut live, &camera, &look).unwrap();
            let picture = painter.read(&gpu).unwrap();
            let twin = draw(&faces, &look, &camera, size);
            if let Some(folder) = std::env::var_os("PLISSE_KEEP_PICTURES") {
                for (kind, picture) in [("gpu", &picture), ("twin", &twin)] {
                    let file = Path::new(&folder).join(format!(
                        "{}-{parallax}-{kind}.png",
                        name.rsplit('/').next().unwrap()
                    ));
                    plisse::picture::write_png(
                        &picture.image,
                        &mut std::fs::File::create(file).unwrap(),
                    )
                    .unwrap();
                }
            }
            let share =
                check_picture(&picture, &twin).unwrap_or_else(|e| panic!("{name}: render: {e}"));
            eprintln!(
                "{name}: {:.3} % of {} pixels differ by more than {LIGHT}",
                100.0 * share,
                twin.covered
            );
            // Faces that the twin laid out are the same picture, also in place of others.
            let mut laid_out = Faces::new(&gpu, &faces[..faces.len() / 2]).unwrap();
            for _ in 0..2 {
                laid_out.set(&gpu, &faces).unwrap();
                painter.draw_faces(&gpu, &laid_out, 0, &camera, &look).unwrap();
                check_picture(&painter.read(&gpu).unwrap(), &twin)
                    .unwrap_or_else(|e| panic!("{name}: faces: {e}"));
            }
            assert!(painter.draw_faces(&gpu, &laid_out, 1, &camera, &look).is_err());
            // Shown to fail: another profile is another picture, and so is one without parallax.
            let pencil = Profile::pencil();
            assert!(
                check_picture(
                    &picture,
                    &draw(&faces, &Look { profile: &pencil, ..look }, &camera, size)
                )
                .is_err(),
                "{name}"
            );
        }
    }
}

#[test]
fn morphs_eight_influences_and_biases_are_the_twins_too() {
    let Some(gpu) = gpu() else { return };
    let mut model = models::sleeve();
    let shifts =
        model.draw.positions.iter().map(|x| Vec3::new(0.0, 0.3 * x.x * x.x, -0.1 * x.x)).collect();
    model.draw.morphs.push(Morph {
        positions: shifts,
        normals: vec![Vec3::new(0.1, 0.0, 0.2); model.draw.positions.len()],
    });
    model.morph_weights.push(0.0);
    for v in 0..model.draw.weights.len() {
        model.draw.joints[v][5] = model.draw.joints[v][0];
        model.draw.weights[v][0] *= 0.5;
        model.draw.weights[v][5] = model.draw.weights[v][0];
    }
    let subject = Subject::new(model);
    let unified = &subject.unified;
    let painted = bias::random(unified, 0.7, 3);
    let characters = [Character { bias: &painted, ..subject.character() }];
    let options = LiveOptions { bias: painted.clone(), ..options(&subject) };
    let mut now = subject.pose(0.6);
    now.morph_weights = vec![0.7];
    let mut live = Live::new(&gpu, &characters).unwrap();
    live.begin(&gpu, &characters, &[&now], &options).unwrap();
    let found = live.read(&gpu).unwrap();
    check_skin(&found.posed, &skin(&unified.vertices, &now), subject.size()).unwrap();
    let without = Pose { morph_weights: vec![0.0], ..now.clone() };
    assert!(check_skin(&found.posed, &skin(&unified.vertices, &without), subject.size()).is_err());
    let twin = |bias| {
        crush(
            unified,
            &found.posed,
            &CrushInput { wavelength_m: &options.wavelength_m, bias, last_direction: &[] },
        )
    };
    let biased = twin(&painted);
    let compared = check_crush(&found.crushed, &biased, |v| biased.strength[v] > 0.3).unwrap();
    assert!(compared > 50, "{compared}");
    assert!(check_crush(&found.crushed, &twin(&[]), |_| true).is_err());
}

#[test]
fn a_solved_field_is_shown_by_the_same_stage() {
    let Some(gpu) = gpu() else { return };
    let size = [200, 160];
    // The square, pressed to three quarters, and the field of its own waves: as a solve would hand
    // it over.
    let subject = Subject::new(models::square().unwrap());
    let (unified, now) = (&subject.unified, subject.pose(2.0));
    let posed = skin(&unified.vertices, &now);
    let input =
        CrushInput { wavelength_m: &[subject.wavelength_m], bias: &[], last_direction: &[] };
    let crushed = crush(unified, &posed, &input);
    let phase = spread(unified, &posed.positions, &crushed, &vec![0.3; unified.count()], &[]);
    let topology = field::topology("square", unified).unwrap();
    let solved = field::to_field(&topology, unified, &posed.positions, &crushed, &phase);
    let waves = field::from_field(&topology, &posed, &solved);
    let characters = [subject.character()];
    let mut live = Live::new(&gpu, &characters).unwrap();
    let drawn = skin(&subject.model.draw, &now);
    live.show(&gpu, &posed, &drawn.normals, &waves).unwrap();
    let (profile, texture) = (Profile::sine(), Texture::checked());
    let look =
        Look { profile: &profile, texture: &texture, colour: Vec3::repeat(1.0), parallax: true };
    let camera = Camera::fit(posed.positions.iter(), 0.4, 0.2, size[0] as f32 / size[1] as f32);
    let painter = Painter::new(&gpu, size, SAMPLES, &[&texture]).unwrap();
    painter.draw(&gpu, &mut live, &camera, &look).unwrap();
    let picture = painter.read(&gpu).unwrap();
    let shown = |waves: &field::Waves| {
        let crushed = Crushed {
            amplitude_m: waves.amplitude_m.clone(),
            wave: waves.wave.clone(),
            ..Crushed::default()
        };
        draw(
            &gather(&subject.model, unified, &posed, &drawn, &crushed, &waves.phase),
            &look,
            &camera,
            size,
        )
    };
    check_picture(&picture, &shown(&waves)).unwrap();
    // Shown to fail: half the amplitude is another picture. And the field's waves are those it was
    // made of.
    let halved = field::Waves {
        amplitude_m: waves.amplitude_m.iter().map(|a| 0.5 * a).collect(),
        ..waves.clone()
    };
    assert!(check_picture(&picture, &shown(&halved)).is_err());
    let original = field::Waves {
        amplitude_m: crushed.amplitude_m.clone(),
        wave: crushed.wave.clone(),
        phase,
    };
    check_picture(&picture, &shown(&original)).unwrap();
}

#[test]
fn characters_in_one_pass_are_what_each_is_alone() {
    let Some(gpu) = gpu() else { return };
    let subjects = subjects();
    let characters: Vec<Character<'_>> = subjects.iter().map(Subject::character).collect();
    let mut together = Live::new(&gpu, &characters).unwrap();
    let at = |i: usize| -> Vec<Pose> { subjects.iter().map(|s| s.pose(s.times()[i])).collect() };
    let options = LiveOptions { spread_new: true, ..options(&subjects[0]) };
    let first = at(0);
    together.begin(&gpu, &characters, &first.iter().collect::<Vec<_>>(), &options).unwrap();
    let second = at(2);
    together.step(&gpu, &second.iter().collect::<Vec<_>>(), &options).unwrap();
    let all = together.read(&gpu).unwrap();
    let mut from = 0;
    for (s, subject) in subjects.iter().enumerate() {
        let own = [subject.character()];
        let mut alone = Live::new(&gpu, &own).unwrap();
        alone.begin(&gpu, &own, &[&first[s]], &options).unwrap();
        alone.step(&gpu, &[&second[s]], &options).unwrap();
        let one = alone.read(&gpu).unwrap();
        let to = from + subject.unified.count();
        assert_eq!(
            all.posed.positions[from..to],
            one.posed.positions[..],
            "{}",
            subject.model.name
        );
        assert_eq!(all.crushed.wave[from..to], one.crushed.wave[..], "{}", subject.model.name);
        assert_eq!(all.phase[from..to], one.phase[..], "{}", subject.model.name);
        from = to;
    }
    assert_eq!(from, all.phase.len());
}

#[test]
fn faces_beyond_one_buffer_are_gathered_in_batches() {
    let Some(gpu) = gpu() else { return };
    // 842,202 faces of 160 bytes: more than the 128 MB that software drivers take at once.
    let subject = Subject::new(models::sheet(660, 640));
    let characters = [subject.character()];
    let mut live = Live::new(&gpu, &characters).unwrap();
    let now = subject.pose(0.5);
    live.begin(&gpu, &characters, &[&now], &LiveOptions { first_rounds: 1, ..options(&subject) })
        .unwrap();
    let faces = live.read_faces(&gpu).unwrap();
    assert_eq!(faces.len(), subject.model.faces.len());
    let posed = skin(&subject.unified.vertices, &now);
    for f in (0..faces.len()).step_by(997).chain([838_859, 838_860, 838_861, faces.len() - 1]) {
        for c in 0..3 {
            let position = Vec3::from_column_slice(&faces[f][4 * c..4 * c + 3]);
            let twin = posed.positions[subject.unified.faces[f][c] as usize];
            assert!(
                (position - twin).norm() < POSITION * subject.size(),
                "face {f}: {position} instead of {twin}"
            );
        }
    }
}

#[test]
fn stages_are_timed() {
    let Some(gpu) = gpu() else { return };
    let subject = Subject::new(models::sleeve());
    let characters = [subject.character()];
    let mut live = Live::new(&gpu, &characters).unwrap();
    live.begin(&gpu, &characters, &[&subject.pose(0.0)], &options(&subject)).unwrap();
    let every_other = LiveOptions { every: 2, ..options(&subject) };
    live.step(&gpu, &[&subject.pose(0.5)], &every_other).unwrap();
    let times = live.times_ms(&gpu, false).unwrap();
    // The second frame of two: Crush and Relax rest.
    assert!(times[1].is_none() && times[2].is_none() && times[4].is_none());
    assert_eq!(times[0].is_some(), times[3].is_some());
    assert!(times.iter().flatten().all(|&ms| (0.0..10_000.0).contains(&ms)), "{times:?}");
}

#[test]
fn what_cannot_be_done_is_told() {
    let Some(gpu) = gpu() else { return };
    let empty = Subject::new(Model::rigid("empty", vec![], vec![], vec![]));
    assert!(Live::new(&gpu, &[empty.character()]).is_err());
    assert!(Live::new(&gpu, &[]).is_err());
    let texture = Texture::plain([255; 3]);
    for size in [[0, 10], [1 << 20, 10]] {
        let text = Painter::new(&gpu, size, 2, &[&texture]).err().unwrap().to_string();
        assert!(text.contains("give 1 to"), "{text}");
    }
}
