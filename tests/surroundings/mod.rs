//! The surroundings of the program in tests. They do not depend on those of the tests.
//!
//! Tests may run in the background, where shells have Ctrl-C ignored, under `nohup`, without a home
//! that can be written, in any language, and in any terminal or none.

use std::path::Path;
use std::process::Command;

/// Variables that change what the program does or how it looks.
const READ: [&str; 21] = [
    "CLICOLOR",
    "CLICOLOR_FORCE",
    "COLORTERM",
    "COLUMNS",
    "DISPLAY",
    "GDK_SCALE",
    "HOME",
    "KITTY_WINDOW_ID",
    "LANG",
    "LC_ALL",
    "LC_CTYPE",
    "LINES",
    "NO_COLOR",
    "RAYON_NUM_THREADS",
    "RUST_BACKTRACE",
    "STY",
    "TERM",
    "TERM_PROGRAM",
    "TMUX",
    "WAYLAND_DISPLAY",
    "XDG_DATA_HOME",
];

/// A command that starts `zeroset` with the signals of a program in the foreground, by the command
/// `by`, such as `setsid --ctty`, if there is one. The program keeps its data in `data`.
pub fn zeroset(by: &[&str], data: &Path) -> Command {
    // Without unsafe code, only the program `env` can undo that a signal is ignored.
    let env: &[&str] = if cfg!(target_os = "linux") { &["env", "--default-signal"] } else { &[] };
    // A program with other features may take the place of the usual one.
    let program = std::env::var("ZEROSET_PROGRAM");
    let program = program.as_deref().unwrap_or(env!("CARGO_BIN_EXE_zeroset"));
    let words = [env, by, &[program]].concat();
    let mut command = Command::new(words[0]);
    command.args(&words[1..]);
    for name in READ {
        command.env_remove(name);
    }
    command.env("XDG_DATA_HOME", data);
    command
}
