//! The `plisse` command: reads scenes and meshes, runs the library, writes files. Everything it
//! says goes through here; the library never prints. Nothing here uses `println` and its kin, which
//! panic where nobody reads any more.

mod animated;
mod arguments;
mod bake;
mod grow;
mod interrupt;
mod live;
mod outputs;
mod progress;
mod report;
mod road;
mod shell;
mod solve;
mod study;
mod wrinkle;

use std::io::Write as _;
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
        Command::Bake(arguments) => bake::run(&arguments, &interrupted),
        Command::Grow(arguments) => grow::run(&arguments, &interrupted),
        Command::Live(arguments) => live::run(&arguments, &interrupted),
        Command::Solve(arguments) => solve::run(&arguments, &interrupted),
        Command::Shell(arguments) => shell::run(&arguments, &interrupted),
        Command::Study(arguments) => study::run(&arguments, &interrupted),
        Command::Wrinkle(arguments) => wrinkle::run(&arguments, &interrupted),
    };
    match result {
        Ok(Done::Whole) => ExitCode::SUCCESS,
        Ok(Done::Interrupted) => {
            tell("interrupted: the files hold the best state so far");
            ExitCode::from(130)
        }
        Err(error) => {
            tell(&format!("error: {error}"));
            ExitCode::from(2)
        }
    }
}

/// A line on standard error, if anybody reads it.
pub(crate) fn tell(line: &str) {
    let _ = writeln!(std::io::stderr(), "{line}");
}
