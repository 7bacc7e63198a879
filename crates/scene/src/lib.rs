//! A document over a domain: its kernels, and where to look at it.
//!
//! A [`program::Program`] is a document simplified over a domain, with values bound to its
//! parameters. Its kernels are compiled when a method first requests them. [`domain`] finds a
//! domain if none is given. [`view`] derives the region from the document and the caller's choice.
//! [`curves`] traces curves and points in it, and [`camera`] is where it is seen from. Nothing here
//! knows pixels, files or terminals.

pub mod blank;
mod box_tree;
pub mod camera;
pub mod choices;
pub mod coordinate;
pub mod curves;
pub mod domain;
pub mod gallery;
pub mod kernels;
mod line_zeros;
pub mod number;
pub mod patches;
pub mod point_value;
pub mod program;
pub mod proportions;
pub mod shortened;
mod simplified;
pub mod uniforms;
pub mod view;
