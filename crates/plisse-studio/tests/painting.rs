//! Painting without a window: what a stroke changes, undo to the bit, files, and live wrinkles that
//! follow the painted direction.

use plisse_live::camera::Camera;
use plisse_live::live::LiveState;
use plisse_live::skin::{pose, skin};
use plisse_live::{Vec2, Vec3};
use plisse_studio::brush::{Canvas, Hit, Trail, VertexFaces};
use plisse_studio::document::history::VertexChange;
use plisse_studio::document::stroke::Dab;
use plisse_studio::document::{
    Action, Brush, Document, Falloff, Heading, Layer, Mirror, Subject, maps,
};
use plisse_studio::open;

fn document(name: &str) -> Document {
    Document::new(Subject::own(name).unwrap())
}

/// Paints a straight stroke from one point of the picture to another in a few pointer positions.
fn stroke(
    document: &mut Document,
    brush: &Brush,
    posed: &[Vec3],
    camera: &Camera,
    from: [f32; 2],
    to: [f32; 2],
) {
    let subject = document.subject.clone();
    let surface = VertexFaces::new(&subject.welded.faces, subject.welded.count());
    let canvas = Canvas { welded: &subject.welded, vertex_faces: &surface, posed };
    let at = |k: usize| Vec2::from(from) + (Vec2::from(to) - Vec2::from(from)) * (k as f32 / 4.0);
    let mut trail = Trail::begin(brush.clone(), &canvas, camera, at(0));
    (1..=4).for_each(|k| trail.extend(&canvas, camera, at(k)));
    let change = trail.end(&canvas, &mut document.layers, camera);
    document.push(change);
}

fn bits(document: &Document) -> Vec<[u32; 4]> {
    Layer::ALL
        .into_iter()
        .flat_map(|l| document.layers.of(l).iter().map(|x| x.map(f32::to_bits)).collect::<Vec<_>>())
        .collect()
}

#[test]
fn a_stroke_changes_exactly_the_vertices_under_it() {
    let mut document = document("square");
    let welded = document.subject.welded.clone();
    let x = welded.vertices.positions.clone();
    let camera = Camera::fit(x.iter(), 0.0, 0.0, 1.0);
    for (layer, value) in [
        (Layer::Wrinkles, 0.6),
        (Layer::Wavelength, 0.3),
        (Layer::Expansion, 0.5),
        (Layer::Coherence, 0.2),
        (Layer::Freeze, 1.0),
    ] {
        let before = document.layers.clone();
        let brush = Brush { layer, value, strength: 0.8, ..Brush::new(0.17) };
        stroke(&mut document, &brush, &x, &camera, [0.3, 0.4], [0.65, 0.6]);
        let change = document.history.done().last().unwrap();
        let dabs: Vec<Vec3> = change
            .stroke
            .dabs
            .iter()
            .map(|dab| Hit::on(dab.face as usize, dab.weights, &x, &welded.faces).position)
            .collect();
        assert!(
            dabs.len() > 5 && dabs.windows(2).all(|d| (d[1] - d[0]).norm() < 0.17 * 0.5),
            "{layer:?}: {} dabs",
            dabs.len()
        );
        let mut under = 0;
        for v in 0..x.len() {
            // The square is flat: along it is straight.
            let far = dabs.iter().map(|d| (d - x[v]).norm()).fold(f32::INFINITY, f32::min);
            if (far - 0.17).abs() < 2e-3 {
                continue;
            }
            let changed = before.of(layer)[v].map(f32::to_bits)
                != document.layers.of(layer)[v].map(f32::to_bits);
            assert_eq!(changed, far < 0.17, "{layer:?}: vertex {v} is {far} m from the stroke");
            under += usize::from(changed);
            for other in Layer::ALL.into_iter().filter(|&l| l != layer) {
                assert_eq!(before.of(other)[v], document.layers.of(other)[v]);
            }
        }
        assert!(under > 10, "{layer:?}: {under}");
    }
}

#[test]
fn undo_and_redo_restore_every_bit() {
    let mut document = document("sleeve");
    let x = document.subject.welded.vertices.positions.clone();
    let camera = Camera::fit(x.iter(), 0.3, 0.2, 1.4);
    let mut states = vec![bits(&document)];
    let brushes = [
        Brush { heading: Heading::AcrossStroke, mirror: Mirror::Z, ..Brush::new(0.04) },
        Brush {
            layer: Layer::Expansion,
            value: 0.7,
            heading: Heading::Isotropic,
            falloff: Falloff::Hard,
            ..Brush::new(0.05)
        },
        Brush { strength: 0.35, value: 0.9, ..Brush::new(0.06) },
        Brush { action: Action::Erase, strength: 0.5, ..Brush::new(0.08) },
        Brush {
            layer: Layer::Wavelength,
            value: 0.3,
            falloff: Falloff::Linear,
            ..Brush::new(0.05)
        },
    ];
    for (k, brush) in brushes.iter().enumerate() {
        let y = 0.42 + 0.03 * k as f32;
        stroke(&mut document, brush, &x, &camera, [0.3, y], [0.7, 1.0 - y]);
        states.push(bits(&document));
        assert_ne!(states[k], states[k + 1], "stroke {k} changed nothing");
    }
    for k in (0..brushes.len()).rev() {
        assert!(document.undo());
        assert_eq!(bits(&document), states[k]);
    }
    assert!(!document.undo());
    for state in &states[1..] {
        assert!(document.redo());
        assert_eq!(&bits(&document), state);
    }
    assert!(!document.redo());
    // A new stroke after an undo forgets what was undone.
    document.undo();
    stroke(&mut document, &brushes[0], &x, &camera, [0.4, 0.5], [0.6, 0.5]);
    assert!(!document.redo());
}

#[test]
fn one_stroke_goes_no_farther_than_its_strength() {
    let mut document = document("square");
    let x = document.subject.welded.vertices.positions.clone();
    let camera = Camera::fit(x.iter(), 0.0, 0.0, 1.0);
    let brush = Brush {
        layer: Layer::Freeze,
        value: 1.0,
        strength: 0.5,
        falloff: Falloff::Hard,
        ..Brush::new(0.2)
    };
    let subject = document.subject.clone();
    let surface = VertexFaces::new(&subject.welded.faces, subject.welded.count());
    let canvas = Canvas { welded: &subject.welded, vertex_faces: &surface, posed: &x };
    // To and fro, five times.
    let mut trail = Trail::begin(brush, &canvas, &camera, Vec2::new(0.4, 0.5));
    for k in 0..10 {
        trail.extend(&canvas, &camera, Vec2::new(if k % 2 == 0 { 0.6 } else { 0.4 }, 0.5));
    }
    let change = trail.end(&canvas, &mut document.layers, &camera);
    document.push(change);
    let most = document.layers.of(Layer::Freeze).iter().map(|v| v[0]).fold(0.0, f32::max);
    assert_eq!(most, 0.5);
}

/// Angles (degrees) between crests and the stroke's way at the vertices where the stroke is strong,
/// in the pose that was painted on.
fn angles(
    name: &str,
    time_s: Option<f32>,
    (from, to, share): ([f32; 2], [f32; 2], f32),
    wavelength_m: f32,
) -> Vec<f32> {
    let mut document = document(name);
    let subject = document.subject.clone();
    let clip = time_s.and_then(|_| subject.model.clips.first());
    let standing = pose(&subject.model, clip, time_s.unwrap_or(0.0));
    let posed = skin(&subject.welded.vertices, &standing);
    let camera = Camera::fit(posed.positions.iter(), 0.1, 0.1, 1.2);
    let radius_m = share * subject.size_m();
    let brush = Brush { value: 0.95, ..Brush::new(radius_m) };
    document.settings.wavelength_m = wavelength_m;
    stroke(&mut document, &brush, &posed.positions, &camera, from, to);
    let mut state = LiveState::default();
    for _ in 0..10 {
        state.step(&subject.welded, &standing, &document.live_options());
    }
    let change = document.history.done().last().unwrap();
    let place = |dab: &Dab| {
        Hit::on(dab.face as usize, dab.weights, &posed.positions, &subject.welded.faces).position
    };
    let dabs: Vec<Vec3> = change.stroke.dabs.iter().map(place).collect();
    let mut found = Vec::new();
    for VertexChange { vertex: v, after, .. } in &change.vertices {
        let v = *v as usize;
        // Where the stroke is strong, and away from its ends.
        let near = (0..dabs.len())
            .min_by(|&a, &b| {
                (dabs[a] - posed.positions[v])
                    .norm()
                    .total_cmp(&(dabs[b] - posed.positions[v]).norm())
            })
            .unwrap();
        if Vec3::new(after[0], after[1], after[2]).norm() < 0.6
            || near == 0
            || near + 1 == dabs.len()
        {
            continue;
        }
        let way = (dabs[near + 1] - dabs[near - 1]).normalize();
        let n = posed.normals[v];
        let way = (way - n * n.dot(&way)).normalize();
        let crest = n.cross(&state.waves.wave[v]).normalize();
        found.push(crest.dot(&way).abs().min(1.0).acos().to_degrees());
    }
    found
}

/// Painted as strongly as can be. Where a pose compresses by itself, wrinkles turn towards that.
#[test]
fn live_wrinkles_follow_painted_folds_on_a_curtain_and_a_sleeve() {
    let curtain = [
        ([0.3, 0.25], [0.32, 0.75], 0.14),
        ([0.35, 0.3], [0.65, 0.7], 0.14),
        ([0.3, 0.5], [0.7, 0.48], 0.14),
        ([0.62, 0.3], [0.4, 0.68], 0.14),
    ];
    let sleeve = [
        ([0.25, 0.5], [0.75, 0.5], 0.06),
        ([0.3, 0.47], [0.7, 0.53], 0.06),
        ([0.5, 0.44], [0.5, 0.56], 0.06),
        ([0.6, 0.45], [0.45, 0.55], 0.06),
    ];
    let cases: [(&str, f32, &[_], &[Option<f32>]); 3] = [
        ("curtain", 0.12, &curtain, &[None, Some(0.5), Some(1.0)]),
        ("sleeve", 0.025, &sleeve, &[None, Some(0.15), Some(0.3)]),
        // Bent by 50 degrees, where the others miss it.
        ("sleeve", 0.025, &sleeve[..2], &[Some(0.5)]),
    ];
    for (name, wavelength_m, strokes, times) in cases {
        for &time_s in times {
            for (k, &stroke) in strokes.iter().enumerate() {
                let found = angles(name, time_s, stroke, wavelength_m);
                let most = found.iter().copied().fold(0.0, f32::max);
                eprintln!(
                    "{name}, {time_s:?} s, stroke {k}: {} vertices, largest angle {most:.2} \
                     degrees",
                    found.len()
                );
                assert!(found.len() >= 3, "{name}, {time_s:?}, stroke {k}: {}", found.len());
                assert!(most < 10.0, "{name}, {time_s:?}, stroke {k}: {most} degrees");
            }
        }
    }
    // Shown to fail: across the stroke is not along it.
    let mut crossed = document("curtain");
    let x = crossed.subject.welded.vertices.positions.clone();
    let camera = Camera::fit(x.iter(), 0.0, 0.0, 1.0);
    stroke(
        &mut crossed,
        &Brush { heading: Heading::AcrossStroke, ..Brush::new(0.4) },
        &x,
        &camera,
        [0.4, 0.3],
        [0.4, 0.7],
    );
    let along = crossed
        .layers
        .of(Layer::Wrinkles)
        .iter()
        .filter(|p| p[1].abs() > 10.0 * p[0].abs())
        .count();
    assert!(along > 5, "{along}");
}

#[test]
fn strokes_cross_texture_seams() {
    let mut document = document("sleeve");
    let subject = document.subject.clone();
    let x = subject.welded.vertices.positions.clone();
    // The seam runs along +y.
    let camera = Camera::fit(x.iter(), 0.0, 1.4, 1.4);
    stroke(&mut document, &Brush::new(0.05), &x, &camera, [0.5, 0.46], [0.5, 0.54]);
    let touched: Vec<u32> = document.history.done()[0].vertices.iter().map(|c| c.vertex).collect();
    let side = |sign: f32| touched.iter().filter(|&&v| sign * x[v as usize].z > 0.01).count();
    assert!(side(1.0) >= 3 && side(-1.0) >= 3, "{} and {}", side(1.0), side(-1.0));
    // Both of the seam's draw vertices have what their place has.
    let split = (0..subject.welded.count() as u32)
        .filter(|v| subject.welded.vertex_of_draw.iter().filter(|u| *u == v).count() > 1);
    assert!(split.filter(|v| touched.contains(v)).count() >= 2);
}

#[test]
fn documents_come_back_to_the_bit_and_bad_ones_are_told() {
    let folder = std::env::temp_dir().join(format!("plisse-studio-save-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let mut document = document("curtain");
    let x = document.subject.welded.vertices.positions.clone();
    let camera = Camera::fit(x.iter(), 0.1, 0.2, 1.0);
    for (layer, value) in
        [(Layer::Wrinkles, 0.71), (Layer::Expansion, 0.333), (Layer::Wavelength, 0.123)]
    {
        let brush = Brush { layer, value, strength: 0.77, ..Brush::new(0.3) };
        stroke(&mut document, &brush, &x, &camera, [0.31, 0.4], [0.67, 0.63]);
    }
    document.settings.wavelength_m = 0.1 + 0.2 / 3.0;
    let path = folder.join("mine.plisse.json");
    open::save(&document, &path).unwrap();
    let back = open::open(&path).unwrap();
    assert_eq!(bits(&back), bits(&document));
    assert_eq!(back.settings, document.settings);
    // The strokes are there for people, too.
    let text = std::fs::read_to_string(&path).unwrap();
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(json["strokes"].as_array().unwrap().len(), 3);
    for (from, to, part) in [
        ("\"plisse_studio\":1", "\"plisse_studio\":9", "later version"),
        ("\"vertices\":89", "\"vertices\":7", "old model file"),
        ("\"own\":\"curtain\"", "\"own\":\"couch\"", "couch"),
        ("{", "", "no JSON"),
        ("\"settings\"", "\"settinks\"", "a field is invalid"),
    ] {
        assert!(text.contains(from), "{from} in {}", &text[..200]);
        std::fs::write(&path, text.replacen(from, to, 1)).unwrap();
        let message = open::open(&path).unwrap_err().to_string();
        assert!(message.contains(part) && !message.contains('\n'), "{message}");
    }
    for (name, bytes) in [
        ("a.glb", &b"glTF"[..]),
        ("a.obj", b"f 1 2 3"),
        ("a.ply", b"nothing"),
        ("a.toml", b"= 3"),
        ("a.xyz", b""),
    ] {
        let path = folder.join(name);
        std::fs::write(&path, bytes).unwrap();
        let message = open::open(&path).unwrap_err().to_string();
        assert!(message.contains(name) && !message.contains('\n'), "{message}");
    }
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn paint_maps_hold_what_is_painted_at_its_place() {
    let mut document = document("square");
    let x = document.subject.welded.vertices.positions.clone();
    let camera = Camera::fit(x.iter(), 0.0, 0.0, 1.0);
    let brush =
        Brush { layer: Layer::Freeze, value: 1.0, falloff: Falloff::Hard, ..Brush::new(0.25) };
    stroke(&mut document, &brush, &x, &camera, [0.5, 0.5], [0.55, 0.5]);
    let map = maps::paint_map(&document, Layer::Freeze, 64).unwrap();
    let subject = &document.subject;
    for (draw, uv) in subject.model.uvs.iter().enumerate() {
        // Inside, so that a texel's middle lies near.
        let (u, v) = ((uv.x * 64.0) as usize, (uv.y * 64.0) as usize);
        if u < 2 || v < 2 || u > 61 || v > 61 {
            continue;
        }
        let painted =
            document.layers.of(Layer::Freeze)[subject.welded.vertex_of_draw[draw] as usize][0];
        let found = map.texels[v * 64 + u].unwrap()[0];
        assert!((found - painted).abs() < 0.3, "{draw}: {found} for {painted}");
    }
    let mut png = Vec::new();
    maps::write_png(&mut png, Layer::Freeze, &map).unwrap();
    assert!(png.starts_with(b"\x89PNG"));
    let zeppelin = Document::new(Subject::new(
        plisse_studio::document::Source::Own("bare".into()),
        plisse_live::model::Model::rigid(
            "bare",
            x.clone(),
            vec![Vec2::zeros(); x.len()],
            document.subject.welded.faces.clone(),
        ),
    ));
    assert!(
        maps::paint_map(&zeppelin, Layer::Freeze, 64).unwrap_err().to_string().contains("unwrap")
    );
}
