//! Intervals as other crates see them.

mod branches;
mod containment;
