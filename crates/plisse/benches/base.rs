//! Time of the base solve of twisted cylinders (2π × 5 m, top turned by 10°), from the evenly
//! turned pose on.
//!
//! The numbers are vertices, about.

#[path = "../tests/sheets/mod.rs"]
mod sheets;

use plisse::progress::Silent;
use plisse::shell::{BaseOptions, Setup, solve_base};

fn main() {
    divan::main();
}

#[divan::bench(args = [300, 1000, 3000, 10000], sample_count = 3, sample_size = 1)]
fn base(bencher: divan::Bencher, vertices: usize) {
    let (sheet, clamps) = sheets::twisted_cylinder(sheets::edge_length_for(vertices));
    let solve = || {
        solve_base(&Setup::new(&sheet, &clamps), &sheet.pose, &BaseOptions::default(), &Silent)
            .unwrap()
            .1
    };
    let report = solve();
    eprintln!(
        "\nbase: {} vertices, {} iterations, {:?}, {:.6e} J",
        sheet.pose.len(),
        report.iterations,
        report.ending,
        report.energy_joule
    );
    bencher.bench_local(solve);
}
