//! Native kernels as other crates see them. What has to be alone in its process is apart, in
//! `memory.rs`.

mod agreement;
mod limits;
