//! A document over a domain: what it takes to draw it, and where to look at it.
//!
//! A [`program::Program`] is a document simplified over a domain, with its parameters bound; its
//! surfaces compile kernels when a method first wants them. [`domain`] finds a domain where none is
//! given, and [`view`] makes region and camera of what the document and the caller say. Nothing here
//! knows pixels, files or terminals.

pub mod blank;
pub mod coordinate;
pub mod domain;
pub mod enclosure;
pub mod gallery;
pub mod kernels;
pub mod program;
pub mod simplified;
pub mod uniforms;
pub mod view;
