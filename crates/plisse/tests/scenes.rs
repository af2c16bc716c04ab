//! Every scene in `examples/` builds: as many vertices as it says, in one piece, closed where
//! pressure acts, thin, and free of obstacles.

use std::path::{Path, PathBuf};

use plisse::mesh::NONE;
use plisse::scene::{BuiltScene, build, build_growth, read};

/// Vertices of each scene, as its comment or the paper says, and panels.
const SCENES: [(&str, usize, usize); 11] = [
    ("01-twisted-cylinder.toml", 688, 1),
    ("02-stretched-sheet.toml", 522, 1),
    ("03-sheared-rectangle.toml", 1000, 1),
    ("04-sphere-drape.toml", 1600, 1),
    ("05-dress.toml", 1400, 2),
    ("06-trousers.toml", 2300, 4),
    ("07-torus.toml", 2000, 2),
    ("08-balloon.toml", 5000, 2),
    ("09-teabag.toml", 936, 2),
    ("10-bear.toml", 2000, 17),
    ("11-curtain.toml", 1350, 1),
];

/// Scenes that grow, and their vertices.
const GROWING: [(&str, usize); 11] = [
    ("20-small-folds.toml", 2481),
    ("21-large-folds.toml", 1525),
    ("22-gathers.toml", 2201),
    ("23-rings.toml", 5708),
    ("24-drape.toml", 2100),
    ("25-bolt.toml", 2584),
    ("26-scrunchy.toml", 4488),
    ("27-banded-scrunchy.toml", 2550),
    ("28-brain.toml", 2562),
    ("29-blisters.toml", 2323),
    ("30-growing-squares.toml", 2664),
];

fn examples() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples")
}

fn built(name: &str) -> BuiltScene {
    let scene = read(examples().join(name)).unwrap_or_else(|e| panic!("{e}"));
    build(&scene).unwrap_or_else(|e| panic!("{e}"))
}

/// Vertices that hang together with the first.
fn reached(built: &BuiltScene) -> usize {
    let mut part: Vec<usize> = (0..built.sheet.topology.vertex_count).collect();
    loop {
        let mut changed = false;
        for &[i, j] in &built.sheet.topology.edges {
            let low = part[i].min(part[j]);
            changed |= part[i] != low || part[j] != low;
            (part[i], part[j]) = (low, low);
        }
        if !changed {
            return part.iter().filter(|&&p| p == 0).count();
        }
    }
}

#[test]
fn all_examples_are_listed_here() {
    let entries = std::fs::read_dir(examples())
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut there: Vec<String> = entries.filter(|name| name.ends_with(".toml")).collect();
    there.sort();
    let listed = SCENES.iter().map(|(name, ..)| *name).chain(GROWING.iter().map(|(name, _)| *name));
    assert_eq!(there, listed.collect::<Vec<_>>());
}

#[test]
fn every_example_opens_with_what_it_is() {
    for name in SCENES.iter().map(|(name, ..)| *name).chain(GROWING.iter().map(|(name, _)| *name)) {
        assert!(
            std::fs::read_to_string(examples().join(name)).unwrap().starts_with("# "),
            "{name}"
        );
    }
}

#[test]
fn every_example_is_one_surface_of_the_stated_size() {
    for (name, vertices, panels) in SCENES {
        let built = built(name);
        let count = built.sheet.topology.vertex_count;
        assert!(
            count.abs_diff(vertices) * 10 <= vertices,
            "{name}: {count} vertices, not about {vertices}"
        );
        assert_eq!(built.panels.len(), panels, "{name}");
        assert_eq!(reached(&built), count, "{name} is in several parts");
        assert!(
            built.sheet.rest.area_m2() > 0.0
                && built.sheet.rest.faces.iter().all(|f| f.area_m2 > 0.0),
            "{name}"
        );
        assert!(built.sheet.material.check_thin(built.sheet.rest.area_m2()).is_ok(), "{name}");
        assert!(built.start.iter().flatten().all(|x| x.is_finite()), "{name}");
    }
}

#[test]
fn every_growing_example_can_grow_and_counts_its_folds() {
    for (name, vertices) in GROWING {
        let grown =
            build_growth(&read(examples().join(name)).unwrap()).unwrap_or_else(|e| panic!("{e}"));
        let count = grown.built.sheet.topology.vertex_count;
        assert!(
            count.abs_diff(vertices) * 10 <= vertices,
            "{name}: {count} vertices, not about {vertices}"
        );
        assert!(grown.maps.most_growth() > 0.1, "{name}");
        // Ungrown, the surface is flat, and the windows lie on it.
        let flat = grown.count(&grown.built.start, &grown.built.sheet.rest).unwrap();
        // Domes (29, 30) are no folds to count.
        assert_eq!(flat.is_empty(), name > "29", "{name}");
        assert!(
            flat.iter().all(|c| c.folds.is_none() && (c.length_reached - 1.0).abs() < 0.01),
            "{name}: {flat:?}"
        );
    }
}

#[test]
fn surfaces_under_pressure_are_spheres_or_tori() {
    for (name, ..) in SCENES {
        let built = built(name);
        if built.loads.pressure_pa == 0.0 {
            continue;
        }
        assert!(
            built.sheet.topology.edge_faces.iter().all(|faces| faces[1] != NONE),
            "{name} is open"
        );
        let euler = built.sheet.topology.vertex_count as isize
            - built.sheet.topology.edge_count() as isize
            + built.sheet.topology.face_count() as isize;
        assert_eq!(euler, if name.contains("torus") { 0 } else { 2 }, "{name}");
    }
}

#[test]
fn garments_have_their_openings_and_start_outside_the_body() {
    // Hem, neck and two arms; waist and two legs.
    for (name, openings) in [("05-dress.toml", 4), ("06-trousers.toml", 3)] {
        let built = built(name);
        let euler = built.sheet.topology.vertex_count as isize
            - built.sheet.topology.edge_count() as isize
            + built.sheet.topology.face_count() as isize;
        assert_eq!(euler, 2 - openings, "{name}");
        for obstacle in &built.obstacles {
            let nearest =
                built.start.iter().map(|p| obstacle.distance_m(p)).fold(f64::INFINITY, f64::min);
            assert!(nearest > 0.0, "{name} starts {nearest} m from {}", obstacle.name);
        }
    }
}
