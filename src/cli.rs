//! The command line: one module per subcommand, and what they share.
//!
//! Pictures, arrays and JSON are the only things written to standard output or files; every note and error goes to
//! standard error. The exit code is 0, 1 for undecided pixels under `--strict`, 2 for an error of the user's, and 3 for
//! one of the program's own.

mod arguments;
mod array;
mod eval;
mod explain;
mod gallery;
mod notes;
mod number;
mod output;
mod progress;
mod render;
mod report;
mod sheet;
mod source;
mod subject;
mod vector;

use arguments::{Arguments, Command};
use clap::{CommandFactory, Parser};
use std::ffi::OsString;
use std::process::ExitCode;

/// The exit code of a user's error: what was asked for cannot be done as asked.
const USER_ERROR: u8 = 2;
/// The exit code of an error of the program's own.
const INTERNAL_ERROR: u8 = 3;

/// Runs the command line and returns the process's exit code.
pub fn run() -> ExitCode {
    std::panic::set_hook(Box::new(|panic| {
        eprintln!("internal error: {panic}\nThis is a bug in zeroset, not in your formula.");
    }));
    match std::panic::catch_unwind(dispatch) {
        Ok(Ok(code)) => code,
        Ok(Err(error)) => {
            notes::error(&error);
            ExitCode::from(USER_ERROR)
        }
        Err(_) => ExitCode::from(INTERNAL_ERROR),
    }
}

fn dispatch() -> anyhow::Result<ExitCode> {
    let arguments = Arguments::parse_from(std::env::args_os().map(formula_not_flag));
    match arguments.command {
        Command::Render(arguments) => render::run(&arguments),
        Command::Eval(arguments) => eval::run(&arguments),
        Command::Explain(arguments) => explain::run(&arguments),
        Command::Gallery(arguments) => gallery::run(&arguments),
        Command::Completions { shell } => {
            let mut command = Arguments::command();
            clap_complete::generate(shell, &mut command, "zeroset", &mut std::io::stdout());
            Ok(ExitCode::SUCCESS)
        }
    }
}

/// Values may begin with `-`, but a formula such as `-hypot(x, y)` would still be read as the flag `-h`. A leading space,
/// which the language ignores, keeps it a formula.
fn formula_not_flag(argument: OsString) -> OsString {
    match argument.to_str() {
        Some(text) if text.starts_with("-h") && text.len() > 2 => format!(" {text}").into(),
        _ => argument,
    }
}
