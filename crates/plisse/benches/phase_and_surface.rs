//! Time of what follows the field solve on twisted cylinders: rounding periods to whole turns, one
//! step of subdivision, and the whole fine surface.
//!
//! The numbers are vertices, about. The faces take a uniform frequency around the cylinder:
//! rounding's cost does not depend on it.

#[path = "../tests/sheets/mod.rs"]
mod sheets;

use plisse::field::closed_forms::ClosedForms;
use plisse::field::closest_closed_form::ClosestClosedForm;
use plisse::field::{FieldOptions, solve};
use plisse::mesh::Vec2;
use plisse::mesh::subdivide::Subdivision;
use plisse::progress::Silent;
use plisse::surface::{Displacement, displace, upsample};

fn main() {
    divan::main();
}

#[divan::bench(args = [300, 1000, 3000, 10000])]
fn whole_periods(bencher: divan::Bencher, vertices: usize) {
    let (sheet, _) = sheets::twisted_cylinder(sheets::edge_length_for(vertices));
    let none_free = vec![false; sheet.topology.face_count()];
    let weight = vec![1.0; none_free.len()];
    let forms = ClosedForms::new(&sheet.topology, &none_free);
    let target = vec![Vec2::new(20.3, 3.0); none_free.len()];
    let mut closest =
        ClosestClosedForm::new(&sheet.topology, &sheet.rest, &forms, &weight).unwrap();
    let (phases, coefficients) = closest.with_free_periods(&target);
    bencher.bench_local(|| {
        ClosestClosedForm::new(&sheet.topology, &sheet.rest, &forms, &weight)
            .unwrap()
            .with_whole_periods(&phases, &coefficients)
    });
}

#[divan::bench(args = [300, 1000, 3000, 10000])]
fn closed_forms(bencher: divan::Bencher, vertices: usize) {
    let (sheet, _) = sheets::twisted_cylinder(sheets::edge_length_for(vertices));
    let none_free = vec![false; sheet.topology.face_count()];
    bencher.bench_local(|| ClosedForms::new(&sheet.topology, &none_free));
}

#[divan::bench(args = [300, 1000, 3000, 10000])]
fn subdivide(bencher: divan::Bencher, vertices: usize) {
    let (sheet, _) = sheets::twisted_cylinder(sheets::edge_length_for(vertices));
    bencher.bench_local(|| {
        let step = Subdivision::new(&sheet.topology);
        (step.fine(), step.masks(&[], &[]).apply(&sheet.pose))
    });
}

/// Three levels of subdivision of base, amplitude and phase, and the displacement.
#[divan::bench(args = [300, 1000, 3000])]
fn surface(bencher: divan::Bencher, vertices: usize) {
    let (sheet, _) = sheets::twisted_cylinder(sheets::edge_length_for(vertices));
    let options = FieldOptions::default();
    let field = solve(&sheet, &sheet.pose, &sheet.held, &options, &Silent).unwrap().field;
    bencher.bench_local(|| {
        let fine = upsample(&sheet, &sheet.pose, &field, 3);
        displace(&fine, &Displacement { v2: true, v1: None })
    });
}
