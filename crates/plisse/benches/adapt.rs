//! Time of a scrunchy of about 50,000 vertices: a ring of radius 0.5 m and tube 0.1 m that grows by 1.5 along its large circle, on a mesh of
//! five edges to a wavelength while it grows, refined twice at the end. Prints what each mesh took.

#[path = "../tests/sheets/mod.rs"]
mod sheets;

use plisse::growth::remesh::Curving;
use plisse::growth::{AdaptOptions, Expansion, Growing, GrowthOptions, grow_adapting};
use plisse::mesh::Vec3;
use plisse::progress::Silent;

/// λ (m).
const WAVELENGTH_M: f64 = 0.134;
/// Edges to a wavelength: while it grows, and at the end.
const EDGES: [f64; 2] = [5.0, 20.0];

fn main() {
    divan::main();
}

#[divan::bench(sample_count = 1, sample_size = 1)]
fn scrunchy(bencher: divan::Bencher) {
    let sheet = sheets::Sheet::torus(0.5, 0.1, WAVELENGTH_M / EDGES[0]);
    let along: Vec<Vec3> = sheet.pose.iter().map(|p| Vec3::new(-p.y, p.x, 0.0)).collect();
    let expansion = Expansion::from_directions(&sheet.topology, &sheet.pose, &along, &vec![1.5; along.len()]).unwrap();
    let growing = Growing::new(&sheet.topology, &sheet.rest, &sheet.pose, expansion, WAVELENGTH_M, 2.0 * WAVELENGTH_M);
    let options = GrowthOptions::default();
    let mut adapt = AdaptOptions::new(WAVELENGTH_M);
    (adapt.edges_per_wave, adapt.finish_edges_per_wave, adapt.curving) = (EDGES[0], EDGES[1], Curving::Start);
    bencher.bench_local(|| {
        let parts = options.parts(growing.most_growth());
        let (surface, report) = grow_adapting(&growing, None, &parts, &options, &adapt, &Silent, &mut |_, _| Ok(())).unwrap();
        eprintln!("\nscrunchy: {} vertices at first, {:.1} s", sheet.pose.len(), report.growth.seconds);
        for mesh in &report.meshes {
            eprintln!(
                "{} edges to λ: {} vertices, {} iterations, residual {:.1e}; s: remesh {:.2}, solve {:.2}",
                mesh.edges_per_wave, mesh.vertices, mesh.iterations, mesh.residual, mesh.remesh_seconds, mesh.solve_seconds
            );
        }
        surface
    });
}
