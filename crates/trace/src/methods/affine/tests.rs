//! Tests of the method's proofs against exact arithmetic.

mod boxes;
mod edges;
mod exact;
