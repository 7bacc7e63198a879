//! Native kernels. Cranelift compiles a tape to code that runs with the rounding mode set to +∞.
//! The code is freed when its last handle is dropped. A formula that is too large to compile is run
//! by stencils: code for single steps, which is never freed.
//!
//! This is the only crate with unsafe code, in four files: `rounding` (the call), `code` (the
//! memory), `kernel` and `threaded` (the safe handles). The crate knows nothing of rays or text.

mod clause_code;
mod code;
mod compiler;
mod count;
mod error;
mod kernel;
mod lanes;
mod rounding;
mod stencil;
mod stencil_code;
mod threaded;
#[cfg(target_arch = "x86_64")]
mod wide;

pub use compiler::{intermediate_code, vector_widths};
pub use error::Error;
pub use kernel::{Compiled, Native};
pub use threaded::{StencilTape, Threaded};
