//! The language as other crates see it.

mod corpus;
mod gallery;
mod hostile;
mod render;
mod round_trip;
mod words;
