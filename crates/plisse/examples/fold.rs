#![allow(clippy::print_stdout, missing_docs)]
use plisse::growth::measure::{Relief, Window, offsets_m, reached};
use plisse::growth::*;
use plisse::mesh::panel::{Outline, Panel};
use plisse::mesh::{Topology, Vec2, Vec3};
use plisse::progress::Silent;
use plisse::rest::RestMetric;

fn main() {
    let arg: Vec<String> = std::env::args().skip(1).collect();
    let get =
        |name: &str, default: f64| arg.iter().find_map(|a| a.strip_prefix(&format!("{name}="))).map_or(default, |v| v.parse().unwrap());
    let (g, folds, coherence) = (get("g", 1.5), get("n", 5.0), get("coh", 4.0));
    let (per, stretch) = (get("per", 12.0), get("stretch", 0.0));
    let lambda = 1.0 / folds;
    let (positions, faces) = if stretch == 0.0 {
        let panel = Panel::new("sheet", &Outline::Rectangle { width_m: 1.0, height_m: 1.0 }, lambda / per, 3).unwrap();
        (panel.positions.iter().map(|p| Vec3::new(p.x, p.y, 0.0)).collect::<Vec<_>>(), panel.faces)
    } else {
        let (m, n) = ((folds * per) as usize, (folds * per / stretch) as usize);
        let p = plisse::mesh::grid::grid("g", [1.0, 1.0], 1.0, [Some(m), Some(n)], plisse::mesh::grid::Diagonal::Rising).unwrap();
        (p.positions.iter().map(|p| Vec3::new(p.x, p.y, 0.0)).collect::<Vec<_>>(), p.faces)
    };
    let topology = Topology::new("sheet", positions.len(), faces).unwrap();
    let rest = RestMetric::from_shape("sheet", &positions, &topology.faces).unwrap();
    let n = positions.len();
    let expansion = Expansion::from_directions(&topology, &positions, &vec![Vec3::x(); n], &vec![g; n]).unwrap();
    let mut growing = Growing::new(&topology, &rest, &positions, expansion, lambda, coherence * lambda);
    let boundary = topology.boundary_vertices();
    growing.freeze(|v, _| boundary[v]);
    let d = GrowthOptions::default();
    let options = GrowthOptions {
        thickness_share: get("h", d.thickness_share),
        grip: get("grip", d.grip),
        imperfection: get("imp", d.imperfection),
        largest_step: get("step", d.largest_step),
        seed: get("seed", 1.0) as u64,
        tolerance: get("tol", d.tolerance),
        poisson: get("nu", d.poisson),
        ..d
    };
    let mut pose = positions.clone();
    let total = std::time::Instant::now();
    let chart: Vec<Vec2> = positions.iter().map(|p| Vec2::new(p.x, p.y)).collect();
    for part in options.parts(growing.most_growth()) {
        let (next, report) = equilibrium::grow_through(&growing, &[part], &pose, &options, &Silent).unwrap();
        pose = next;
        let step = &report.steps[0];
        let inset = 0.5 * lambda.min(0.2) + 0.05;
        let window = Window { low: Vec2::new(inset, inset), high: Vec2::new(1.0 - inset, 1.0 - inset) };
        let w = offsets_m(&topology, &positions, &pose).unwrap();
        let relief = Relief::new(&topology, &chart, &w, &window, [(folds * 40.0) as usize, 101]).unwrap();
        let asked = growing.expansion.part(part).act_on(&topology, &positions, &rest).unwrap();
        let inner = |f: usize| {
            topology.faces[f]
                .iter()
                .all(|&v| chart[v].x > inset && chart[v].x < 1.0 - inset && chart[v].y > inset && chart[v].y < 1.0 - inset)
        };
        let r = reached(&topology, &positions, &asked, &pose, &vec![Vec3::x(); topology.face_count()], inner);
        let count = relief.folds().map(|f| (1.0 / f.wavelength_m, f.width));
        println!(
            "g {:.3} it {:3} {:?} res {:.1e} count {:.2?} rms/λ {:.4} expect {:.4} crests {:.3} corr/λ {:.2?} length {:.4} {:.2}s",
            g.powf(part),
            step.iterations,
            step.ending,
            step.residual,
            count.unwrap_or_default(),
            relief.roughness_m() / lambda,
            fold_angle::amplitude(g.powf(part)) / 2f64.sqrt(),
            relief.crests_within(10f64.to_radians(), 0.5 * lambda),
            relief.correlation_m().map(|c| c / lambda),
            r.length,
            report.seconds
        );
    }
    println!("vertices {n}, total {:.1}s", total.elapsed().as_secs_f64());
    if let Some(path) = arg.iter().find_map(|a| a.strip_prefix("png=")) {
        use plisse::picture::*;
        let subject = Subject { positions: &pose, faces: &topology.faces };
        let _ = (path, subject);
    }
}
