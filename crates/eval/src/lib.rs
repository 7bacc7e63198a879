//! Queries about functions, the layouts of their data, and the reference evaluator.
//!
//! A [`Tape`] is a graph laid out for evaluation, on any [`Machine`](zeroset_interval::Machine) and
//! with any [kind of values](ValueKind). A [`Query`] defines what a kernel reads and what its
//! result means. A [`Kernel`] answers a query: [`Reference`] in software, and other crates with
//! native code. [`SurfaceKernels`] are the kernels of one function. All exist in `f32` and in
//! `f64`: the type parameter [`Real`] defaults to `f32`. This crate knows neither code generation
//! nor rays.

mod batch;
mod binding;
mod branches;
mod differentiable;
mod dispatch;
mod duals;
mod enclosure;
mod forms;
mod lanes;
mod query;
mod real;
mod reference;
mod shorten;
mod surface;
mod tape;
mod value_kind;

pub use batch::{
    Batch, Boxes, BranchSigns, Contractions, Enclosures, GradientEnclosures, Gradients, Input,
    Output, Patches, Planes, Points, Segments, Tiles, Values, Zeros,
};
pub use binding::Binding;
pub use branches::{BranchTest, branch_bindings};
pub use enclosure::{enclose, enclose_all};
pub use lanes::{LANES, Lanes};
pub use query::{
    BoundPatches, ContractSegments, ContractTiles, Enclose, EncloseGradient, FindZeros,
    FindZerosInBranch, Kernel, Query, QueryContext, QueryNumber, QueryResult, QueryTask,
    QueryValue, Sample, SampleForward, SampleGradient,
};
pub use real::Real;
pub use reference::Reference;
pub use shorten::{
    Clause, ClauseOperand, Clauses, DecidingSteps, LaneSet, SelectedOperand, SelectedStep,
    Selection, Shortener, StepBounds,
};
pub use surface::{
    KernelError, KernelFloat, KernelResult, Kernels, PartSurface, SideTest, SurfaceKernels,
    TileTest, ZeroTest,
};
pub use tape::{Assumptions, Step, StepOperands, Tape};
pub use value_kind::{Loader, ValueKind, Vector};
