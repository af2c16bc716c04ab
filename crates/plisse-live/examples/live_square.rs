//! The square of [Loviscach 2006], drawn together to half its width in real time: prints the
//! amplitude of its waves and writes the last frame to `out/live_square.glb`.
//!
//! `cargo run --release -p plisse-live --example live_square`
//!
//! [Loviscach 2006]: https://doi.org/10.1111/j.1467-8659.2006.00966.x

#![allow(clippy::print_stdout)]

use std::error::Error;
use std::fs::{File, create_dir_all};
use std::io::BufWriter;

use plisse_live::export::write_still;
use plisse_live::fine_mesh::{PARTS_PER_WAVE, refine, suggest_parts};
use plisse_live::live::Frame;
use plisse_live::live_model::LiveModel;
use plisse_live::models;
use plisse_live::play::Player;
use plisse_live::profile::Profile;

/// Wavelength (m).
const WAVELENGTH_M: f32 = 0.1;

fn main() -> Result<(), Box<dyn Error>> {
    let live = LiveModel::new(models::square()?, f64::from(WAVELENGTH_M), Profile::sine());
    let mut player = Player::new(&live.model, &live.welded, &live.options, Some("contract"))?;
    let mut drawn = player.play_to(0.0);
    for second in 1_u8..=3 {
        drawn = player.play_to(second.into());
        let highest = player.state.waves.amplitude_m.iter().copied().fold(0.0, f32::max);
        println!("{second} s: {:.1} mm", 1e3 * highest);
    }
    let frame = Frame { state: &player.state, drawn: &drawn };
    let parts = suggest_parts(&live.welded, WAVELENGTH_M, PARTS_PER_WAVE);
    let fine = refine(&live.model, &live.welded, &frame, &live.profile, parts);

    create_dir_all("out")?;
    write_still(&mut BufWriter::new(File::create("out/live_square.glb")?), &live.model, &fine)?;
    println!("out/live_square.glb: {} faces", fine.faces.len());
    Ok(())
}
