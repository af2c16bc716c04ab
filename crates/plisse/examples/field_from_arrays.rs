//! A mesh given as arrays, pressed together, and its wrinkles: prints their wavelength and saves
//! the surface to `out/field_from_arrays`.
//!
//! `cargo run --release --example field_from_arrays`

#![allow(clippy::print_stdout)]

use std::path::Path;

use plisse::prelude::*;

/// Squares along a side of the sheet.
const N: usize = 30;

fn main() -> plisse::Result<()> {
    // A square metre of cloth as N × N squares, each cut into two triangles.
    let corner = |v: usize| [v % (N + 1), v / (N + 1)].map(|k| k as f64 / N as f64);
    let rest: Vec<Vec3> =
        (0..(N + 1) * (N + 1)).map(corner).map(|[x, y]| Vec3::new(x, y, 0.0)).collect();
    let squares = (0..N * (N + 1)).filter(|v| v % (N + 1) != N);
    let faces = squares.flat_map(|v| [[v, v + 1, v + N + 2], [v, v + N + 2, v + N + 1]]).collect();
    // Its pose: 3 % shorter along x, and sagging in the middle.
    let pose: Vec<Vec3> =
        rest.iter().map(|p| Vec3::new(0.97 * p.x, p.y, 0.1 * p.y * (p.y - 1.0))).collect();

    let cloth = Material::new(1e5, 0.3, 5e-4)?;
    let sheet = Sheet::from_rest(rest, faces, cloth)?;
    let wrinkles = sheet.wrinkle(&pose)?;

    if let Some(wavelengths) = wrinkles.field.wavelengths(&sheet) {
        println!("wavelength {:.1} mm", 1e3 * wavelengths.median);
    }
    println!("amplitude {:.1} mm", 1e3 * wrinkles.field.largest_amplitude_m());
    for file in wrinkles.save(Path::new("out/field_from_arrays"))? {
        println!("{}", file.display());
    }
    Ok(())
}
