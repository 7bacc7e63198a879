//! From a scene to pictures, strips of large pictures, and sequences.
//!
//! A [`model::Model`] compiles the surfaces of a document once; pictures are taken of it from
//! anywhere. [`framing`] chooses a camera where nobody did. Nothing here knows files or terminals.

pub mod framing;
pub mod model;
pub mod names;
pub mod overlay;
pub mod picture;
pub mod sequence;
