//! A flat square that grows along x and folds: prints the height of its folds and writes
//! `out/grow_a_square/folded.obj`.
//!
//! `cargo run --release --example grow_a_square`

#![allow(clippy::print_stdout)]

use std::path::Path;

use plisse::growth::grow;
use plisse::io::obj;
use plisse::io::staged::OutputFolder;
use plisse::mesh::grid::{Diagonal, grid};
use plisse::prelude::*;

fn main() -> plisse::Result<()> {
    let panel = grid([1.0, 1.0], 0.04, [None, None], Diagonal::Rising)?;
    let start: Vec<Vec3> = panel.positions.iter().map(|p| Vec3::new(p.x, p.y, 0.0)).collect();
    let sheet = Sheet::from_rest(start.clone(), panel.faces, Material::new(1e5, 0.3, 1e-3)?)?;

    // Every vertex grows by 30 % along x; folds lie 0.25 m apart. The boundary stays where it is.
    let (along, factors) = (vec![Vec3::x(); start.len()], vec![1.3; start.len()]);
    let expansion = Expansion::from_directions(&sheet.topology, &start, &along, &factors)?;
    let maps = GrowthMaps::even(&expansion, 0.25, 0.0);
    let boundary = sheet.topology.boundary_vertices();
    let mut surface = GrowingSurface::new(sheet.topology, sheet.rest, start, maps);
    surface.freeze(|v, _| boundary[v]);
    let (folded, report) = grow(&surface, &GrowthOptions::default(), &Silent)?;

    let highest = folded.iter().map(|p| p.z.abs()).fold(0.0, f64::max);
    println!("{} load steps, {:.1} s: {highest:.3} m high", report.steps.len(), report.seconds);
    let mut folder = OutputFolder::create(Path::new("out/grow_a_square"))?;
    folder.write("folded.obj", |out| obj::write(out, &folded, &surface.topology.faces, None))?;
    for file in folder.commit()? {
        println!("{}", file.display());
    }
    Ok(())
}
