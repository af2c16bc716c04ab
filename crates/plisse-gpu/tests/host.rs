//! The host itself: batches of faces, times, pictures that stay on the adapter, limits.

mod adapter;
mod subject;

use adapter::GpuTest;
use plisse_gpu::{Average, Faces, Gpu, Live, Painter, memory_speed, wgpu};
use plisse_live::camera::Camera;
use plisse_live::draw::{Look, SAMPLES};
use plisse_live::live::LiveOptions;
use plisse_live::model::Model;
use plisse_live::profile::Profile;
use plisse_live::render::Corner;
use plisse_live::skin::skin;
use plisse_live::stage::Stage;
use plisse_live::texture::Texture;
use plisse_live::{Vec3, models};
use subject::{Subject, options};

/// Largest difference between a position and its CPU reference, as a share of the model's size.
const POSITION: f32 = 1e-5;

fn main() {
    adapter::main(vec![
        GpuTest::new("faces_beyond_one_buffer_are_gathered_in_batches", face_batches),
        GpuTest::new("stages_are_timed", stage_times),
        GpuTest::new("memory_has_a_speed", memory_has_a_speed),
        GpuTest::new("the_picture_that_stays_is_the_one_that_is_read", picture_that_stays),
        GpuTest::new("what_cannot_be_done_is_told", limits),
    ])
}

fn face_batches(gpu: &Gpu) {
    // 842,202 faces of 160 bytes: more than the 128 MB that software drivers take at once.
    let subject = Subject::new(models::sheet(660, 640));
    let characters = [subject.character()];
    let mut live = Live::new(gpu, &characters).unwrap();
    let now = subject.pose(0.5);
    live.begin(gpu, &characters, &[&now], &LiveOptions { first_rounds: 1, ..options(&subject) })
        .unwrap();
    let faces = live.read_faces(gpu).unwrap();
    assert_eq!(faces.len(), subject.model.faces.len());
    let posed = skin(&subject.welded.vertices, &now);
    for f in (0..faces.len()).step_by(997).chain([838_859, 838_860, 838_861, faces.len() - 1]) {
        for c in 0..3 {
            let position = Vec3::from_column_slice(&faces[f][4 * c..4 * c + 3]);
            let reference = posed.positions[subject.welded.faces[f][c] as usize];
            assert!(
                (position - reference).norm() < POSITION * subject.size(),
                "face {f}: {position} instead of {reference}"
            );
        }
    }
}

fn stage_times(gpu: &Gpu) {
    let subject = Subject::new(models::sleeve());
    let characters = [subject.character()];
    let mut live = Live::new(gpu, &characters).unwrap();
    live.begin(gpu, &characters, &[&subject.pose(0.0)], &options(&subject)).unwrap();
    let every_other = LiveOptions { every: 2, ..options(&subject) };
    live.step(gpu, &[&subject.pose(0.5)], &every_other).unwrap();
    let times = live.times_ms(gpu, false).unwrap();
    // The second frame of two: Crush and Relax rest.
    assert!(
        times[Stage::Crush].is_none()
            && times[Stage::Relax].is_none()
            && times[Stage::Render].is_none()
    );
    assert_eq!(times[Stage::Skin].is_some(), times[Stage::Gather].is_some());
    assert!(times.values().iter().flatten().all(|&ms| (0.0..10_000.0).contains(&ms)), "{times:?}");
}

fn limits(gpu: &Gpu) {
    let empty = Subject::new(Model::rigid("empty", vec![], vec![], vec![]));
    assert!(Live::new(gpu, &[empty.character()]).is_err());
    assert!(Live::new(gpu, &[]).is_err());
    let texture = Texture::plain([255; 3]);
    for size in [[0, 10], [1 << 20, 10]] {
        let text = Painter::new(gpu, size, 2, &[&texture]).err().unwrap().to_string();
        assert!(text.contains("give 1 to"), "{text}");
    }
}

fn memory_has_a_speed(gpu: &Gpu) {
    let speed = memory_speed(gpu).unwrap();
    assert!(speed.is_none_or(|speed| (1e8..1e14).contains(&speed)), "{speed:?}");
}

/// A device as a window has it, with what it is shared by.
fn window() -> (wgpu::Device, wgpu::Queue, Gpu) {
    let (device, queue) = pollster::block_on(async {
        let descriptor = wgpu::InstanceDescriptor::new_without_display_handle().with_env();
        let instance = wgpu::Instance::new(descriptor);
        let adapter = match wgpu::util::initialize_adapter_from_env(&instance, None).await {
            Ok(adapter) => adapter,
            Err(_) => instance.request_adapter(&Default::default()).await.unwrap(),
        };
        let required_limits = adapter.limits();
        let descriptor = wgpu::DeviceDescriptor { required_limits, ..Default::default() };
        adapter.request_device(&descriptor).await.unwrap()
    });
    let gpu = Gpu::shared(device.clone(), queue.clone(), "window".to_owned());
    (device, queue, gpu)
}

fn picture_that_stays(_: &Gpu) {
    let (device, queue, gpu) = window();
    let places = [Vec3::zeros(), Vec3::x(), Vec3::new(0.3, 0.9, 0.2)];
    let corner = |position| Corner {
        position,
        normal: Vec3::z(),
        uv: plisse_live::Vec2::zeros(),
        amplitude_m: 0.01,
        wave: Vec3::x() * 40.0,
        phase: 40.0 * position.x,
    };
    let (texture, profile) = (Texture::plain([214, 176, 158]), Profile::sine());
    // Rows of 64 pixels can be read as they are.
    let size = [64, 48];
    let painter = Painter::new(&gpu, size, SAMPLES, &[&texture]).unwrap();
    let faces = Faces::new(&gpu, &[places.map(corner)]).unwrap();
    let camera = Camera::fit(places.iter(), 0.2, 0.1, size[0] as f32 / size[1] as f32);
    let look =
        Look { profile: &profile, texture: &texture, colour: Vec3::repeat(1.0), parallax: false };
    painter.draw_faces(&gpu, &faces, 0, &camera, &look).unwrap();
    let read = painter.read(&gpu).unwrap();
    let average = Average::new(&gpu, &painter);
    let picture = average.picture(&gpu).texture();
    // Read back through the window's own handles.
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("read"),
        size: 4 * (size[0] * size[1]) as u64,
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let layout = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(4 * size[0] as u32),
        rows_per_image: None,
    };
    let mut encoder = device.create_command_encoder(&Default::default());
    let into = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
    encoder.copy_texture_to_buffer(picture.as_image_copy(), into, picture.size());
    queue.submit([encoder.finish()]);
    buffer.map_async(wgpu::MapMode::Read, .., |done| done.unwrap());
    device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
    let stays = buffer.get_mapped_range(..).unwrap();
    assert!(read.covered > 200, "{} pixels are covered", read.covered);
    for (i, (a, b)) in stays.chunks(4).zip(read.image.pixels.chunks(3)).enumerate() {
        assert!((0..3).all(|c| a[c].abs_diff(b[c]) <= 1) && a[3] == 255, "pixel {i}: {a:?} {b:?}");
    }
}
