//! Tests the language through the crate's public interface.

mod corpus;
mod gallery;
mod hostile;
mod render;
mod round_trip;
mod words;
