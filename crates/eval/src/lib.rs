//! What may be asked of a function, the layouts of its data, and the reference evaluator.
//!
//! A [`Tape`] is a graph laid out for evaluation; it writes itself on any
//! [`Machine`](zeroset_interval::Machine), in any [domain of values](ValueDomain). A [`Query`]
//! says what code reads and what its answer means, a [`Kernel`] answers it: [`Reference`] in
//! software, native code elsewhere. All of them exist in `f32` and in `f64`, by a type parameter
//! [`Real`] that is `f32` where it is left out. [`SurfaceKernels`] are one function and the kernels
//! that it has. This crate knows neither code generation nor rays.

mod batch;
mod binding;
mod branches;
mod differentiable;
mod forms;
mod lanes;
mod query;
mod real;
mod reference;
mod surface;
mod tape;
mod value_domain;

pub use batch::{
    Batch, Boxes, Contractions, Enclosures, GradientEnclosures, Gradients, Input, Output,
    PATH_UNITS, Planes, Points, Segments, Tiles, Values, Zeros,
};
pub use binding::Binding;
pub use lanes::{LANES, Lanes};
pub use query::{
    ContractSegments, ContractTiles, Enclose, EncloseGradient, FindZeros, Kernel, Query,
    QueryResult, Sample, SampleGradient,
};
pub use real::Real;
pub use reference::Reference;
pub use surface::{KernelError, KernelFloat, KernelResult, Kernels, SurfaceKernels, ZeroTest};
pub use tape::{Assumptions, Step, Tape};
pub use value_domain::{Loader, ValueDomain};
