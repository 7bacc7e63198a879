//! Native kernels: a tape becomes Cranelift code, runs with the rounding mode set to +∞, and is
//! freed when dropped.
//!
//! The only crate with unsafe code, in three files: `rounding` (the call), `code` (the memory),
//! `kernel` (the safe handles); and, only to be measured, `comparison`. It knows nothing of rays or
//! text.

mod code;
#[cfg(feature = "comparison")]
pub mod comparison;
mod compiler;
mod count;
mod error;
mod kernel;
mod lanes;
mod rounding;
#[cfg(target_arch = "x86_64")]
mod wide;

pub use compiler::{intermediate_code, vector_widths};
pub use error::Error;
pub use kernel::{Compiled, Native};
