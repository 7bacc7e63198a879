//! Software intervals with outward rounding, and the rule of every operation on them.
mod bounds;
mod facts;

pub use bounds::Interval;
pub use facts::Facts;
