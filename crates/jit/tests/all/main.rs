//! Native kernels as other crates use them. `memory.rs` is apart, since it needs its own process.

mod agreement;
mod limits;
