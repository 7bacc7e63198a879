//! Errors and notes: what they are, as data, and how people see them, as text with carets.
//!
//! Nothing here knows how a text is read; every other folder uses this one.

pub(crate) mod error;
pub(crate) mod explain;
pub(crate) mod note;
pub(crate) mod render;
