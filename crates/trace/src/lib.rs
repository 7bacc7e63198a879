//! Tracing: pictures' rays, methods and the G-buffer that their results go to.
//!
//! A method evaluates kernels to find where each ray first meets the zero set. The driver writes
//! the results into a [`GBuffer`]. [`cap_rows`] adds the faces where a region cuts a solid. This
//! crate knows nothing of code generation, light or color. It works with the reference evaluator as
//! well as with native code. It reads no files and prints nothing.

mod band;
pub mod buffer_pool;
mod driver;
mod gbuffer;
mod grid;
mod kernel_stats;
mod method;
mod methods;
mod options;
mod packet;
pub mod painted;
mod ray_result;
mod region_caps;
mod rows;
mod scalar;
mod simd_chunks;
mod squares;
mod surface_ids;

pub use band::Band;
pub use driver::Driver;
pub use gbuffer::{GBuffer, Kept, PixelCounts};
pub use grid::{BAND_ROWS, Patch, RayDirections, RayGrid, SIDE, Window};
pub use kernel_stats::{Count, KernelStats};
pub use method::{Fallback, Method, Proves, Segment, Start, Tracer};
pub use methods::{METHODS, MOST_STEPS, PATCH, patch_tracer};
pub use options::{
    DEPTH, MethodOption, NO_CONTRACT, NO_INTERVALS, NO_TILES, OPTIONS, PRECISION, Precision, STEPS,
    TOLERANCE, TOLERANCES, TraceOptions, check_depth, is_tolerance,
};
pub use ray_result::{RayResult, Status, UndecidedReason};
pub use region_caps::{cap, cap_rows, may_cut};
pub use rows::{Columns, Rows};
pub use scalar::Scalar;
pub use surface_ids::{SurfaceIdSlice, SurfaceIds};
