//! Every stage on the GPU against its CPU reference, on each model made here and on a real one.

mod adapter;
mod subject;

use std::path::{Path, PathBuf};

use adapter::GpuTest;
use plisse_gpu::{Character, Faces, Gpu, Live, Painter};
use plisse_live::camera::Camera;
use plisse_live::crush::{CrushInput, PlaneWaves, crush};
use plisse_live::draw::{Look, Picture, SAMPLES, draw};
use plisse_live::gather::gather;
use plisse_live::live::{Frame, LiveOptions, LiveState};
use plisse_live::model::Morph;
use plisse_live::profile::Profile;
use plisse_live::relax::{PhaseCoupling, phase_error, propagate_phases, relax};
use plisse_live::render::Corner;
use plisse_live::shade::from_srgb;
use plisse_live::skin::{Pose, PosedVertices, skin};
use plisse_live::texture::Texture;
use plisse_live::{Vec3, bias, field, gltf_in, models, wrap};
use subject::{Subject, options};

// The largest differences that are allowed between a stage and its CPU reference, given the same
// input.

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

fn main() {
    let is_fox_missing = !fox().is_file() && std::env::var_os("PLISSE_NEED_DATA").is_none();
    let on_the_fox = |name, run| GpuTest { is_ignored: is_fox_missing, ..GpuTest::new(name, run) };
    adapter::main(vec![
        GpuTest::new("every_stage_matches_its_cpu_reference", |gpu| stages(gpu, &own_subjects())),
        on_the_fox("every_stage_matches_its_cpu_reference_on_the_fox", |gpu| {
            stages(gpu, &[fox_subject()])
        }),
        GpuTest::new("render_matches_its_cpu_reference", |gpu| render(gpu, &own_subjects())),
        on_the_fox("render_matches_its_cpu_reference_on_the_fox", |gpu| {
            render(gpu, &[fox_subject()])
        }),
        GpuTest::new(
            "morphs_eight_influences_and_biases_match_the_cpu_reference_too",
            morphs_eight_influences_and_biases,
        ),
        GpuTest::new("a_solved_field_is_shown_by_the_same_stage", solved_field),
        GpuTest::new("characters_in_one_pass_are_what_each_is_alone", |gpu| {
            characters_in_one_pass(gpu, &own_subjects())
        }),
        on_the_fox("characters_in_one_pass_with_the_fox_are_what_each_is_alone", |gpu| {
            let subjects: Vec<Subject> =
                own_subjects().into_iter().chain([fox_subject()]).collect();
            characters_in_one_pass(gpu, &subjects)
        }),
    ])
}

/// Path of a real model, which is not part of the sources.
fn fox() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/Fox.glb")
}

fn fox_subject() -> Subject {
    Subject::new(gltf_in::read(&fox()).unwrap())
}

fn own_subjects() -> Vec<Subject> {
    let own = [
        models::square().unwrap(),
        models::curtain().unwrap(),
        models::zeppelin(),
        models::shirt(),
        models::sleeve(),
    ];
    own.into_iter().map(Subject::new).collect()
}

/// Five times over the subject's clip (s).
fn times(subject: &Subject) -> Vec<f32> {
    let end = subject.model.clip(None).map_or(0.0, |c| c.duration_s());
    (0..5).map(|i| end * i as f32 / 5.0 + 0.01).collect()
}

fn check_skin(found: &PosedVertices, reference: &PosedVertices, size: f32) -> Result<(), String> {
    for v in 0..reference.positions.len() {
        let off = (found.positions[v] - reference.positions[v]).norm();
        let turned = (found.normals[v] - reference.normals[v]).norm();
        if off.is_nan() || off > POSITION * size || turned > NORMAL {
            return Err(format!("vertex {v} is off by {off} m, its normal by {turned}"));
        }
    }
    Ok(())
}

/// Also tells how many wave vectors were compared.
fn check_crush(
    found: &PlaneWaves,
    reference: &PlaneWaves,
    distinct: impl Fn(usize) -> bool,
) -> Result<usize, String> {
    let mut compared = 0;
    for v in 0..reference.strength.len() {
        let strength = (found.strength[v] - reference.strength[v]).abs();
        if strength.is_nan() || strength > STRENGTH {
            return Err(format!(
                "strength at {v} is {} instead of {}",
                found.strength[v], reference.strength[v]
            ));
        }
        if reference.strength[v] > 0.05 && distinct(v) {
            compared += 1;
            let (a, b) = (found.wave[v], reference.wave[v]);
            let off = (a - b).norm().min((a + b).norm()) / b.norm();
            if off.is_nan() || off > WAVE {
                return Err(format!("wave at {v} is {a} instead of {b}"));
            }
        }
    }
    Ok(compared)
}

fn check_relax(
    found: &[f32],
    reference: &[f32],
    torn: impl Fn(usize) -> bool,
) -> Result<(), String> {
    for v in 0..reference.len() {
        let off = wrap(found[v] - reference[v]).abs();
        if !torn(v) && (off.is_nan() || off > PHASE) {
            return Err(format!("phase at {v} is {} instead of {}", found[v], reference[v]));
        }
    }
    Ok(())
}

fn check_gather(found: &[[f32; 40]], reference: &[[Corner; 3]], size: f32) -> Result<(), String> {
    for (f, (face, corners)) in found.iter().zip(reference).enumerate() {
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

fn check_picture(found: &Picture, reference: &Picture) -> Result<f32, String> {
    let off =
        |(a, b): &(&[u8], &[u8])| (0..3).any(|c| (from_srgb(a[c]) - from_srgb(b[c])).abs() > LIGHT);
    let share =
        found.image.pixels.chunks(3).zip(reference.image.pixels.chunks(3)).filter(off).count()
            as f32
            / reference.covered.max(1) as f32;
    let covered = (found.covered as f32 / reference.covered.max(1) as f32 - 1.0).abs();
    if share > EDGES || covered > EDGES {
        return Err(format!("{share} of the model's pixels differ, {covered} in number"));
    }
    Ok(share)
}

fn stages(gpu: &Gpu, subjects: &[Subject]) {
    for subject in subjects {
        let (name, welded) = (&subject.model.name, &subject.welded);
        let characters = [subject.character()];
        let options = options(subject);
        let mut live = Live::new(gpu, &characters).unwrap();
        let times = times(subject);
        live.begin(gpu, &characters, &[&subject.pose(times[0])], &options).unwrap();
        let mut before = live.read(gpu).unwrap();
        let mut compared = 0;
        for &time_s in &times[1..] {
            let now = subject.pose(time_s);
            live.step(gpu, &[&now], &options).unwrap();
            let found = live.read(gpu).unwrap();
            // Skin.
            let skinned = skin(&welded.vertices, &now);
            check_skin(&found.posed, &skinned, subject.size())
                .unwrap_or_else(|e| panic!("{name}: skin: {e}"));
            let later = skin(&welded.vertices, &subject.pose(time_s + 0.1));
            // Crush, of the vertices as the GPU placed them.
            let input = |w| CrushInput {
                wavelength_m: w,
                bias: &[],
                last_direction: &before.waves.direction,
            };
            let waves = crush(welded, &found.posed, &input(&options.wavelength_m));
            // A direction is distinct if a small squeeze along it changes the strength's direction
            // little: compare with a biased reference.
            let along: Vec<Vec3> = waves.direction.iter().map(slanted).collect();
            let tilted = crush(
                welded,
                &found.posed,
                &CrushInput { bias: &along, ..input(&options.wavelength_m) },
            );
            let distinct = |v: usize| tilted.direction[v].dot(&waves.direction[v]).abs() > 0.999;
            compared += check_crush(&found.waves, &waves, distinct)
                .unwrap_or_else(|e| panic!("{name}: crush: {e}"));
            // Relax, one round.
            let mut phase = vec![0.0; found.phase.len()];
            let coupling = found.coupling(welded);
            relax(&coupling, options.rate, &before.phase, &mut phase);
            let torn = |v: usize| {
                let error = |&n: &u32| phase_error(&coupling, &before.phase, v, n as usize);
                welded.around(v).iter().map(error).any(|e| e.abs() > 0.499)
            };
            check_relax(&found.phase, &phase, torn)
                .unwrap_or_else(|e| panic!("{name}: relax: {e}"));
            // Gather: a copy, so the same numbers.
            let drawn = skin(&subject.model.draw, &now);
            let frame = Frame { state: &found, drawn: &drawn };
            let corners = gather(&subject.model, welded, &frame);
            let faces = live.read_faces(gpu).unwrap();
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
            let wider = crush(welded, &found.posed, &input(&[1.01 * subject.wavelength_m]));
            if waves.strength.iter().any(|&s| s > 0.1) {
                assert!(check_crush(&found.waves, &wider, distinct).is_err(), "{name}");
                let mut other = vec![0.0; phase.len()];
                relax(&coupling, 0.5 * options.rate, &before.phase, &mut other);
                let moved = (0..phase.len())
                    .any(|v| !torn(v) && wrap(other[v] - phase[v]).abs() > 2.0 * PHASE);
                assert_eq!(check_relax(&found.phase, &other, torn).is_err(), moved, "{name}");
            }
            before = found;
        }
        assert!(
            compared > welded.count() / 20,
            "{name}: only {compared} wave vectors were compared"
        );
    }
}

/// A bias that squeezes along `k` by a tenth of a percent across a slanted direction.
fn slanted(k: &Vec3) -> Vec3 {
    let aside = k.cross(&Vec3::new(0.31, 0.77, 0.56)).try_normalize(1e-6).unwrap_or_else(Vec3::x);
    (k + aside).normalize() * 0.03
}

fn render(gpu: &Gpu, subjects: &[Subject]) {
    let size = [240, 200];
    for subject in subjects {
        let name = &subject.model.name;
        let characters = [subject.character()];
        let mut live = Live::new(gpu, &characters).unwrap();
        let now = subject.pose(times(subject)[3]);
        live.begin(gpu, &characters, &[&now], &options(subject)).unwrap();
        let found = live.read(gpu).unwrap();
        let texture = match &subject.model.base_colour {
            Some(bytes) => Texture::decode(name, bytes).unwrap(),
            None => Texture::checked(),
        };
        let drawn = skin(&subject.model.draw, &now);
        let frame = Frame { state: &found, drawn: &drawn };
        let faces = gather(&subject.model, &subject.welded, &frame);
        let camera =
            Camera::fit(found.posed.positions.iter(), 0.6, 0.3, size[0] as f32 / size[1] as f32);
        let painter = Painter::new(gpu, size, SAMPLES, &[&texture]).unwrap();
        for (profile, parallax) in [(Profile::sine(), true), (Profile::accordion(), false)] {
            let look =
                Look { profile: &profile, texture: &texture, colour: Vec3::repeat(1.0), parallax };
            painter.draw(gpu, &mut live, &camera, &look).unwrap();
            let picture = painter.read(gpu).unwrap();
            let reference = draw(&faces, &look, &camera, size);
            if let Some(folder) = std::env::var_os("PLISSE_KEEP_PICTURES") {
                for (kind, picture) in [("gpu", &picture), ("cpu", &reference)] {
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
            let share = check_picture(&picture, &reference)
                .unwrap_or_else(|e| panic!("{name}: render: {e}"));
            eprintln!(
                "{name}: {:.3} % of {} pixels differ by more than {LIGHT}",
                100.0 * share,
                reference.covered
            );
            // Faces that the processor laid out are the same picture, also in place of others.
            let mut laid_out = Faces::new(gpu, &faces[..faces.len() / 2]).unwrap();
            for _ in 0..2 {
                laid_out.set(gpu, &faces).unwrap();
                painter.draw_faces(gpu, &laid_out, 0, &camera, &look).unwrap();
                check_picture(&painter.read(gpu).unwrap(), &reference)
                    .unwrap_or_else(|e| panic!("{name}: faces: {e}"));
            }
            assert!(painter.draw_faces(gpu, &laid_out, 1, &camera, &look).is_err());
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

fn morphs_eight_influences_and_biases(gpu: &Gpu) {
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
    let welded = &subject.welded;
    let painted = bias::random(welded, 0.7, 3);
    let characters = [Character { bias: &painted, ..subject.character() }];
    let options = LiveOptions { bias: painted.clone(), ..options(&subject) };
    let mut now = subject.pose(0.6);
    now.morph_weights = vec![0.7];
    let mut live = Live::new(gpu, &characters).unwrap();
    live.begin(gpu, &characters, &[&now], &options).unwrap();
    let found = live.read(gpu).unwrap();
    check_skin(&found.posed, &skin(&welded.vertices, &now), subject.size()).unwrap();
    let without = Pose { morph_weights: vec![0.0], ..now.clone() };
    assert!(check_skin(&found.posed, &skin(&welded.vertices, &without), subject.size()).is_err());
    let reference = |bias| {
        crush(
            welded,
            &found.posed,
            &CrushInput { wavelength_m: &options.wavelength_m, bias, last_direction: &[] },
        )
    };
    let biased = reference(&painted);
    let compared = check_crush(&found.waves, &biased, |v| biased.strength[v] > 0.3).unwrap();
    assert!(compared > 50, "{compared}");
    assert!(check_crush(&found.waves, &reference(&[]), |_| true).is_err());
}

fn solved_field(gpu: &Gpu) {
    let size = [200, 160];
    // The square, pressed to three quarters, and the field of its own waves: as a solve would hand
    // it over.
    let subject = Subject::new(models::square().unwrap());
    let (welded, now) = (&subject.welded, subject.pose(2.0));
    let posed = skin(&welded.vertices, &now);
    let input =
        CrushInput { wavelength_m: &[subject.wavelength_m], bias: &[], last_direction: &[] };
    let crushed = crush(welded, &posed, &input);
    let coupling = PhaseCoupling { mesh: welded, positions: &posed.positions, waves: &crushed };
    let phase = propagate_phases(&coupling, &vec![0.3; welded.count()], &[]);
    let topology = field::topology("square", welded).unwrap();
    let solved = field::to_field(&topology, &coupling, &phase);
    let waves = field::from_field(&topology, &posed, &solved);
    let characters = [subject.character()];
    let mut live = Live::new(gpu, &characters).unwrap();
    let drawn = skin(&subject.model.draw, &now);
    live.show(gpu, &posed, &drawn.normals, &waves).unwrap();
    let (profile, texture) = (Profile::sine(), Texture::checked());
    let look =
        Look { profile: &profile, texture: &texture, colour: Vec3::repeat(1.0), parallax: true };
    let camera = Camera::fit(posed.positions.iter(), 0.4, 0.2, size[0] as f32 / size[1] as f32);
    let painter = Painter::new(gpu, size, SAMPLES, &[&texture]).unwrap();
    painter.draw(gpu, &mut live, &camera, &look).unwrap();
    let picture = painter.read(gpu).unwrap();
    let shown = |waves: &field::Waves| {
        let state = LiveState {
            posed: posed.clone(),
            waves: PlaneWaves {
                amplitude_m: waves.amplitude_m.clone(),
                wave: waves.wave.clone(),
                ..PlaneWaves::default()
            },
            phase: waves.phase.clone(),
            ..LiveState::default()
        };
        let faces = gather(&subject.model, welded, &Frame { state: &state, drawn: &drawn });
        draw(&faces, &look, &camera, size)
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

fn characters_in_one_pass(gpu: &Gpu, subjects: &[Subject]) {
    let characters: Vec<Character<'_>> = subjects.iter().map(Subject::character).collect();
    let mut together = Live::new(gpu, &characters).unwrap();
    let at = |i: usize| -> Vec<Pose> { subjects.iter().map(|s| s.pose(times(s)[i])).collect() };
    let options = LiveOptions { propagate_new: true, ..options(&subjects[0]) };
    let first = at(0);
    together.begin(gpu, &characters, &first.iter().collect::<Vec<_>>(), &options).unwrap();
    let second = at(2);
    together.step(gpu, &second.iter().collect::<Vec<_>>(), &options).unwrap();
    let all = together.read(gpu).unwrap();
    let mut from = 0;
    for (s, subject) in subjects.iter().enumerate() {
        let own = [subject.character()];
        let mut alone = Live::new(gpu, &own).unwrap();
        alone.begin(gpu, &own, &[&first[s]], &options).unwrap();
        alone.step(gpu, &[&second[s]], &options).unwrap();
        let one = alone.read(gpu).unwrap();
        let to = from + subject.welded.count();
        assert_eq!(
            all.posed.positions[from..to],
            one.posed.positions[..],
            "{}",
            subject.model.name
        );
        assert_eq!(all.waves.wave[from..to], one.waves.wave[..], "{}", subject.model.name);
        assert_eq!(all.phase[from..to], one.phase[..], "{}", subject.model.name);
        from = to;
    }
    assert_eq!(from, all.phase.len());
}
