//! Time of one dab of a brush of one wavelength's radius on square sheets, in the middle of a
//! stroke: it must not depend on the mesh.
//!
//! The numbers are vertices, about. What is printed before is where the time of the best of 20 dabs
//! went.

#[path = "../tests/sheets/mod.rs"]
mod sheets;

use plisse::growth::sculpt::{Dab, Paint, SculptOptions, Sculpture, SurfacePoint};
use plisse::growth::{Expansion, GrowingSurface, GrowthMaps, GrowthOptions};
use plisse::mesh::Vec3;

/// Edges to a wavelength.
const EDGES: f64 = 8.0;

fn main() {
    divan::main();
}

/// A flat sheet with a stroke of ten dabs, and the next one.
fn begun(vertices: usize, brush: SculptOptions) -> (Sculpture, Dab) {
    let cells = (vertices as f64).sqrt() as usize;
    let sheet = sheets::PosedSheet::lattice(1.0, 1.0, cells, cells);
    let expansion = Expansion::none(&sheet.topology, &sheet.pose).unwrap();
    let wavelength_m = EDGES / cells as f64;
    let maps = GrowthMaps::even(&expansion, wavelength_m, wavelength_m);
    let surface =
        GrowingSurface::new(sheet.topology.clone(), sheet.rest.clone(), sheet.pose.clone(), maps);
    let mut sculpture =
        Sculpture::new(surface, sheet.pose.clone(), GrowthOptions::default(), brush).unwrap();
    let touch = |k: usize| {
        let place = Vec3::new(0.5 + 0.3 * wavelength_m * (k as f64 - 5.0), 0.5, 0.0);
        let distance = |v: usize| (sheet.pose[v] - place).norm();
        let nearest =
            (0..sheet.pose.len()).min_by(|&a, &b| distance(a).total_cmp(&distance(b))).unwrap();
        let paint = Paint::Growth { factor: 1.05, direction: Some(Vec3::x()) };
        Dab {
            spot: SurfacePoint::vertex(&sheet.topology, nearest).unwrap(),
            radius_m: wavelength_m,
            core: 0.3,
            paint,
        }
    };
    for k in 0..10 {
        sculpture.dab(&touch(k)).unwrap();
    }
    (sculpture, touch(10))
}

#[divan::bench(args = [5000, 20000, 80000], sample_count = 20, sample_size = 1)]
fn dab(bencher: divan::Bencher, vertices: usize) {
    let (mut sculpture, dab) = begun(vertices, SculptOptions::default());
    let mut best: Option<plisse::growth::sculpt::SculptReport> = None;
    for _ in 0..20 {
        let (change, report) = sculpture.dab(&dab).unwrap();
        sculpture.restore(change);
        if best.as_ref().is_none_or(|best| report.seconds.total < best.seconds.total) {
            best = Some(report);
        }
    }
    let best = best.unwrap();
    let seconds = best.seconds;
    let [search, cut, solve, all] =
        [seconds.search, seconds.cut, seconds.solve, seconds.total].map(|s| 1e3 * s);
    eprintln!(
        "\ndab: {} vertices in all, {} touched, {} active, {} solved, {} iterations; ms: search \
         {search:.2}, cut {cut:.2}, solve {solve:.2}, all {all:.2}",
        sculpture.pose().len(),
        best.touched,
        best.active,
        best.solved,
        best.step.as_ref().map_or(0, |step| step.iterations),
    );
    bencher.bench_local(|| {
        let (change, _) = sculpture.dab(&dab).unwrap();
        sculpture.restore(change);
    });
}
