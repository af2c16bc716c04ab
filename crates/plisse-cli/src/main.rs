//! The `plisse` command: reads scenes and meshes, runs the library, writes files. Everything it says goes through here; the
//! library never prints.
#![allow(clippy::print_stdout)]

mod arguments;
mod interrupt;
mod outputs;
mod progress;
mod report;
mod road;
mod solve;
mod wrinkle;

use std::process::ExitCode;

use arguments::{Arguments, Command};
use clap::Parser;

/// What a run came to.
pub(crate) enum Done {
    /// Everything was done.
    Whole,
    /// The user interrupted it; what there was is written.
    Interrupted,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let interrupted = interrupt::watch();
    let result = match arguments.command {
        Command::Solve(arguments) => solve::run(&arguments, &interrupted),
        Command::Wrinkle(arguments) => wrinkle::run(&arguments, &interrupted),
    };
    match result {
        Ok(Done::Whole) => ExitCode::SUCCESS,
        Ok(Done::Interrupted) => {
            eprintln!("interrupted: the files hold the best state so far");
            ExitCode::from(130)
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}
