//! Intervals as other crates see them.

mod containment;
mod parts;
