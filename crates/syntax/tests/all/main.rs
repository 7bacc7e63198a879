//! Tests the language through the crate's public interface.

mod builders;
mod commas;
mod corpus;
mod emit;
mod gallery;
mod hints;
mod hostile;
mod left_over;
mod lists;
mod parametric_gallery;
mod parametric_texts;
mod patches;
mod render;
mod round_trip;
mod signs;
mod values;
mod words;
