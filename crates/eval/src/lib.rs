//! What a traverser may ask of a function, the layouts of its data, and the reference evaluator.

mod kernel;
mod packet;

pub use kernel::{GradientKernel, IntervalKernel, PointKernel};
pub use packet::{
    BoxPacket, EnclosurePacket, GradientPacket, LANES, Lanes, PointPacket, ValuePacket,
};
