//! Tests of the public interface of intervals.

mod branches;
mod containment;
mod quotient;
