//! End-to-end tests of the program on the command line, in a terminal and in a window, and of the
//! documents for contributors.

mod cli_axes;
mod cli_errors;
mod cli_eval;
mod cli_large;
mod cli_render;
mod cli_sequence;
mod cli_support;
mod contributing;
#[cfg(unix)]
#[path = "../edit_support/mod.rs"]
mod edit_support;
mod readme;
#[cfg(unix)]
mod window_frame;
#[cfg(unix)]
mod window_gallery;
#[cfg(unix)]
mod window_prompt;
#[cfg(unix)]
mod window_session;
#[cfg(unix)]
mod window_sliders;
#[cfg(unix)]
mod window_soak;
#[cfg(unix)]
mod window_support;
#[cfg(unix)]
mod window_surfaces;
