//! Time of a scrunchy with rigid bands of about 50,000 vertices (half an hour on the 700 MHz
//! machine of Combaz & Neyret 2002): scene 27 on a mesh of 6.75 edges to a wavelength while it
//! grows, refined twice at the end. Prints what each mesh took, and how many pairs of faces cross
//! in the end.

use std::path::Path;

use plisse::growth::{AdaptOptions, GrownSurface, LoadSteps, follow_adapting};
use plisse::mesh::crossing::crossing_pairs;
use plisse::progress::Silent;
use plisse::remesh::MidpointPlacement;
use plisse::scene;

/// Edges to a wavelength: while it grows, and at the end.
const EDGES: [f64; 2] = [6.75, 25.3];
/// Newton iterations at most on each of the finer meshes.
const FINISH: usize = 8;

fn main() {
    divan::main();
}

#[divan::bench(sample_count = 1, sample_size = 1)]
fn scrunchy_with_rigid_bands(bencher: divan::Bencher) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/27-banded-scrunchy.toml");
    let grown = scene::build_growth(&scene::read(&file).unwrap()).unwrap();
    let (surface, parts) = (grown.surface(), grown.parts(None));
    let mut adapt = AdaptOptions::new(surface.maps.vertices[0].wavelength_m / EDGES[0]);
    (adapt.edges_per_wave, adapt.finish_edges_per_wave, adapt.midpoints) =
        (EDGES[0], EDGES[1], MidpointPlacement::Start);
    adapt.finish_iterations = FINISH;
    bencher.bench_local(|| {
        let start = GrownSurface::new(surface.clone(), grown.chart());
        let steps = LoadSteps { parts: &parts, options: &grown.options };
        let (folded, report) =
            follow_adapting(start, &steps, &adapt, &Silent, &mut |_, _| Ok(())).unwrap();
        let crossing = crossing_pairs(&folded.surface.topology.faces, &folded.pose).len();
        eprintln!("\n{:.1} s, {crossing} pairs of faces that cross", report.growth.seconds);
        for mesh in &report.meshes {
            eprintln!(
                "{} edges to λ: {} vertices, {} iterations, residual {:.1e}; s: remesh {:.2}, \
                 solve {:.2}",
                mesh.edges_per_wave,
                mesh.vertices,
                mesh.iterations,
                mesh.residual,
                mesh.remesh_seconds,
                mesh.solve_seconds
            );
        }
        folded
    });
}
