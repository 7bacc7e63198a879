//! Pictures of a document: whole, in strips, or in sequences.
//!
//! A [`model::Model`] compiles a document's surfaces once and draws pictures of them from any
//! camera. The module [`framing`] chooses a camera if none is given. Only [`atomic_file`] knows
//! files, and nothing here knows terminals.

pub mod atomic_file;
pub mod drawing;
pub mod framing;
pub mod legend;
pub mod limit;
pub mod model;
pub mod names;
pub mod overlay;
pub mod picture;
pub mod pixels;
pub mod png_file;
pub mod progress;
pub mod sequence;
