//! End-to-end tests of the program on the command line and in a terminal, and tests of the
//! documents for contributors. Tests in a window have a binary of their own.

mod cli_axes;
mod cli_curves;
mod cli_errors;
mod cli_eval;
mod cli_large;
mod cli_looks;
mod cli_measure;
mod cli_mesh;
mod cli_render;
mod cli_sequence;
mod cli_support;
mod contributing;
mod documents;
#[cfg(unix)]
#[path = "../edit_support/mod.rs"]
mod edit_support;
#[cfg(unix)]
mod interrupt;
mod parts;
#[cfg(unix)]
mod prompt;
#[cfg(unix)]
mod prompt_soak;
mod settings;
#[path = "../surroundings/mod.rs"]
mod surroundings;
#[cfg(unix)]
#[path = "../terminal_support/mod.rs"]
#[allow(dead_code, reason = "the window's tests use the rest")]
mod terminal_support;
