//! Tests of the language through its public interface.

mod corpus;
mod gallery;
mod hostile;
mod render;
mod round_trip;
mod words;
