//! The `plisse` command: reads scenes and meshes, calls the library, writes files and reports.
//! Everything it prints goes through `terminal`; the library never prints.

mod animated;
mod arguments;
mod bake;
mod grow;
mod interrupt;
mod live;
mod outputs;
mod pipeline;
mod progress;
mod report;
mod shell;
mod solve;
mod study;
mod terminal;
mod wrinkle;

use std::process::ExitCode;

use arguments::{Arguments, Command};
use clap::Parser;
use terminal::{RunEnd, eprint_line};

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
        Ok(RunEnd::Complete) => ExitCode::SUCCESS,
        Ok(RunEnd::Interrupted) => {
            eprint_line("interrupted: the files hold the best state so far");
            ExitCode::from(130)
        }
        Err(error) => {
            eprint_line(&format!("error: {error}{}", terminal::hint(&error)));
            ExitCode::from(2)
        }
    }
}
