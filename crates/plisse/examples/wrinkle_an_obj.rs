//! A pose in an OBJ file and its rest shape in another (the same faces in the same order): saves
//! the wrinkled surface and a normal map to `out/wrinkle_an_obj`.
//!
//! `cargo run --release --example wrinkle_an_obj -- REST.obj POSE.obj`

#![allow(clippy::print_stdout)]

use std::error::Error;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

use plisse::bake::png16;
use plisse::io::garment::RestSource;
use plisse::prelude::*;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(rest), Some(pose)) = (arguments.next(), arguments.next()) else {
        return Err("give two files: REST.obj POSE.obj".into());
    };
    let cloth = Material::new(1e5, 0.3, 5e-4)?;
    let (sheet, pose) =
        Sheet::read_posed(Path::new(&pose), RestSource::File(Path::new(&rest)), cloth)?;
    let wrinkles = sheet.wrinkle(&pose)?;

    let folder = Path::new("out/wrinkle_an_obj");
    for file in wrinkles.save(folder)? {
        println!("{}", file.display());
    }
    // A flat rest shape is its own texture.
    if wrinkles.texture.is_some() {
        let path = folder.join("normal.png");
        png16::write_normal(&mut BufWriter::new(File::create(&path)?), &wrinkles.bake(1024)?)?;
        println!("{}", path.display());
    }
    Ok(())
}
