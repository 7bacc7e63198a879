//! Errors and notes, as data and as text with carets.
//!
//! Nothing here knows how a text is read. Every other folder uses this one.

pub(crate) mod error;
pub(crate) mod explain;
pub(crate) mod note;
pub(crate) mod render;
