//! The command `zeroset`: everything that knows arguments, files and a terminal.

mod cli;

use std::process::ExitCode;

fn main() -> ExitCode {
    cli::run()
}
