//! A scene file solved, from its panels and clamps to its wrinkles: prints every tenth step of the
//! solves and the scene's measures, and saves the surface to `out/solve_scene`.
//!
//! `cargo run --release --example solve_scene -- [SCENE.toml]`

#![allow(clippy::print_stdout)]

use std::path::Path;

use plisse::prelude::*;
use plisse::progress::{Observer, Step};

struct Printed;

impl Observer for Printed {
    fn step(&self, step: &Step) {
        if step.iteration.is_multiple_of(10) {
            println!("{} {}: {:.6e} J", step.stage, step.iteration, step.energy_joule);
        }
    }
}

fn main() -> plisse::Result<()> {
    let file = std::env::args().nth(1);
    let scene = scene::read(file.as_deref().unwrap_or("examples/02-stretched-sheet.toml"))?;
    let solved = scene::solve(&scene, &SolveOptions::default(), &Printed)?;
    for measure in &solved.measures {
        println!("{}: {:.5}, published {:?}", measure.name, measure.value, measure.published);
    }
    for file in solved.save(Path::new("out/solve_scene"))? {
        println!("{}", file.display());
    }
    Ok(())
}
