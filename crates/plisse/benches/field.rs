//! Time of the field solve on twisted cylinders (2π × 5 m, top turned by 10°), whose base pose is
//! solved beforehand.
//!
//! The numbers are vertices, about. From one size to the next the time should grow by little more
//! than the size.

#[path = "../tests/sheets/mod.rs"]
mod sheets;

use plisse::field::FieldOptions;

fn main() {
    divan::main();
}

#[divan::bench(args = [300, 1000, 3000, 10000], sample_count = 5, sample_size = 1)]
fn field(bencher: divan::Bencher, vertices: usize) {
    let (sheet, _) = sheets::twisted_cylinder_at_rest(sheets::edge_length_for(vertices));
    let solved = sheet.solve(&sheet.material, &FieldOptions::default());
    eprintln!(
        "\nfield: {} vertices, {} iterations, {:?}, {:.3} turns",
        sheet.pose.len(),
        solved.report.iterations,
        solved.report.ending,
        solved.report.periods.first().map_or(0.0, |p| p.before_rounding)
    );
    bencher.bench_local(|| sheet.solve(&sheet.material, &FieldOptions::default()));
}
