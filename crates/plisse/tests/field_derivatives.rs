//! Gradient and Hessian of the whole field problem against differences, at random states and
//! several step sizes, on meshes with loops (b₁ = 0, 1, 2), held vertices and wrinkle-free faces.
//!
//! That single elements are right is tested beside them; here it is how they are put together.

/// The library's own comparison with differences, which it has for its tests only.
#[path = "../src/linalg/derivative_check/differences.rs"]
mod derivative_check;
mod sheets;

use plisse::RestShape;
use plisse::field::closed_forms::ClosedForms;
use plisse::field::curvature::second_forms;
use plisse::field::density::Density;
use plisse::field::domain::Domain;
use plisse::field::problem::FieldProblem;
use plisse::field::wrinkle_free::{WrinkleFreeRule, wrinkle_free_faces, wrinkle_free_vertices};
use plisse::linalg::{Problem, PsdProjection};
use plisse::mesh::Vec3;

use derivative_check::{gradient_error, hessian_error};
use sheets::{PosedSheet, Random, mylar, twisted_ring};

/// A torus of `n × m` squares, each cut in two, over a rest metric of flat squares of 1 × 1 m that
/// the pose shortens one way.
fn torus(n: usize, m: usize) -> PosedSheet {
    let at = |i: usize, j: usize| (j % m) * n + i % n;
    let (mut faces, mut rest) = (Vec::new(), RestShape::default());
    let corner = |i: usize, j: usize| Vec3::new(i as f64, j as f64 + 0.1 * i as f64, 0.0);
    for j in 0..m {
        for i in 0..n {
            for k in [[(i, j), (i + 1, j), (i + 1, j + 1)], [(i, j), (i + 1, j + 1), (i, j + 1)]] {
                faces.push(k.map(|(i, j)| at(i, j)));
                let first = rest.positions.len();
                rest.positions.extend(k.map(|(i, j)| corner(i, j)));
                rest.faces.push([first, first + 1, first + 2]);
            }
        }
    }
    let mut random = Random(77);
    let positions = (0..n * m)
        .map(|v| {
            let [a, b] = [(v % n) as f64 / n as f64, (v / n) as f64 / m as f64]
                .map(|t| t * std::f64::consts::TAU);
            let radius = 3.0 + 0.8 * b.cos();
            let noise = Vec3::new(random.signed(), random.signed(), random.signed());
            Vec3::new(radius * a.cos(), radius * a.sin(), 0.8 * b.sin()) * 0.4 + noise * 0.05
        })
        .collect();
    PosedSheet::new(rest, faces, positions)
}

/// Largest relative errors of gradient and Hessian over a few random states.
fn worst_errors(sheet: &PosedSheet, wrinkle_free: &[bool], loops: usize) -> (f64, f64) {
    let (topology, rest) = (&sheet.topology, &sheet.rest);
    let strain = sheet.strain(&sheet.pose);
    let curvature = second_forms(topology, &sheet.pose, 2);
    let densities: Vec<Density> = (0..topology.face_count())
        .map(|f| {
            Density::new(&rest.faces[f], &strain[f], &curvature[f], &mylar(), &Default::default())
        })
        .collect();
    let forms = ClosedForms::new(topology, wrinkle_free);
    assert_eq!(forms.generators.len(), loops);
    let mut still = wrinkle_free_vertices(topology, wrinkle_free);
    for v in 0..still.len() {
        still[v] |= sheet.held[v];
    }
    // Units that are no powers of ten nor one, so that a lost one shows.
    let domain = Domain { wrinkle_free: wrinkle_free.to_vec(), still, forms };
    let mut problem = FieldProblem::new(topology, &domain, &densities, 0.037, 0.61);
    let n = problem.size();
    let mut random = Random(3);
    let mut worst = (0.0_f64, 0.0_f64);
    for _ in 0..3 {
        let x: Vec<f64> = (0..n).map(|_| 2.0 * random.signed()).collect();
        let (mut gradient, hessian) = derivatives(&mut problem, &x);
        worst.0 = worst.0.max(gradient_error(&x, 1.0, &gradient, |y| problem.energy(y)));
        let at = |problem: &mut FieldProblem<'_>, y: &[f64]| {
            let mut g = vec![0.0; n];
            problem.value_and_gradient(y, &mut g);
            g
        };
        worst.1 = worst.1.max(hessian_error(&x, 1.0, &hessian, |y| at(&mut problem, y)));
        // The comparison sees an error of 1e-4 in one component.
        let largest =
            (0..n).max_by(|&i, &j| gradient[i].abs().total_cmp(&gradient[j].abs())).unwrap();
        gradient[largest] *= 1.0001;
        assert!(gradient_error(&x, 1.0, &gradient, |y| problem.energy(y)) > 5e-5);
    }
    worst
}

/// Gradient, and Hessian row by row (from its products with unit vectors).
fn derivatives(problem: &mut FieldProblem<'_>, x: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let n = x.len();
    let mut gradient = vec![0.0; n];
    let energy = problem.value_and_gradient(x, &mut gradient);
    assert!((energy / problem.energy(x) - 1.0).abs() < 1e-13);
    let pattern = problem.pattern();
    let mut values = vec![0.0; pattern.entry_count()];
    problem.hessian(PsdProjection::None, &mut values);
    let mut hessian = vec![0.0; n * n];
    let mut unit = vec![0.0; n];
    for i in 0..n {
        unit[i] = 1.0;
        pattern.multiply(&values, &unit, &mut hessian[i * n..(i + 1) * n]);
        unit[i] = 0.0;
    }
    (gradient, hessian)
}

fn assert_right(name: &str, (gradient, hessian): (f64, f64)) {
    eprintln!("{name}: gradient {gradient:.1e}, Hessian {hessian:.1e}");
    assert!(gradient < 1e-8, "{name}: gradient is off by {gradient:e}");
    assert!(hessian < 1e-7, "{name}: Hessian is off by {hessian:e}");
}

#[test]
fn without_loops() {
    let mut sheet = PosedSheet::rectangle(1.0, 0.6, 0.2, 6)
        .posed(|p| Vec3::new(0.95 * p.x, 1.02 * p.y, 0.2 * p.y * p.y));
    sheet.held[3] = true;
    sheet.held[9] = true;
    let none = vec![false; sheet.topology.face_count()];
    assert_right("sheet", worst_errors(&sheet, &none, 0));
}

#[test]
fn around_one_loop() {
    let ring = twisted_ring(0.3, 4);
    let strain = ring.strain(&ring.pose);
    let free = wrinkle_free_faces(&ring.topology, &strain, WrinkleFreeRule::Paper);
    assert!(free.iter().any(|f| *f));
    assert_right("ring", worst_errors(&ring, &free, 1));
}

#[test]
fn around_the_loops_of_a_torus() {
    let torus = torus(6, 5);
    let mut free = vec![false; torus.topology.face_count()];
    assert_right("torus", worst_errors(&torus, &free, 2));
    // Two holes, of one square each: the second adds a loop.
    for f in [12, 13, 40, 41] {
        free[f] = true;
    }
    assert_right("torus with holes", worst_errors(&torus, &free, 3));
}
