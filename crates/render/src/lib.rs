//! Pictures of a document: whole, in strips, or in sequences.
//!
//! A [`model::Model`] compiles a document's surfaces once and draws pictures of them from any
//! camera. The module [`framing`] chooses a camera if none is given. The crate knows no files or
//! terminals.

pub mod framing;
pub mod model;
pub mod names;
pub mod overlay;
pub mod picture;
pub mod sequence;
