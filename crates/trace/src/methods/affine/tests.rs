//! Tests of the method's proofs against exact arithmetic.

mod edges;
mod exact;
