//! Pictures of a document: whole, in strips, or in sequences.
//!
//! A [`model::Model`] compiles the surfaces of a document once and draws pictures from any camera.
//! [`framing`] chooses a camera where none is given. Only [`atomic_file`] knows files, and nothing
//! here knows terminals.

pub mod atomic_file;
pub mod framing;
pub mod model;
pub mod names;
pub mod overlay;
pub mod picture;
pub mod png_file;
pub mod sequence;
