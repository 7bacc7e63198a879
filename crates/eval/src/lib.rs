//! What a traverser may ask of a function, the layouts of its data, and the reference evaluator.
//!
//! A [`Tape`] is a graph laid out for evaluation; it writes itself on any
//! [`Machine`](zeroset_interval::Machine). [`Reference`] runs it in software; native code comes from elsewhere and
//! implements the same traits. All of them exist in `f32` and in
//! `f64`, by a type parameter [`Real`] that is `f32` where it is left out. This crate knows neither code generation nor
//! rays.

mod binding;
mod branches;
mod kernel;
mod packet;
mod real;
mod reference;
mod tape;

pub use binding::Binding;
pub use kernel::{GradientKernel, IntervalKernel, PointKernel};
pub use packet::{
    BoxPacket, EnclosurePacket, GradientPacket, LANES, Lanes, PointPacket, ValuePacket,
};
pub use real::Real;
pub use reference::Reference;
pub use tape::{Assumptions, Step, Tape};
