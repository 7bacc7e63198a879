//! The command `zeroset`.

use std::process::ExitCode;

fn main() -> ExitCode {
    zeroset_cli::run()
}
