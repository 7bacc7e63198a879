//! Meshes of scenes, with colors, and mesh files.
//!
//! [`meshes`] makes the mesh of each visible surface of a document. A row of [`FORMATS`] writes
//! them. Nothing here knows terminals or paths, or how triangles are made.

mod color;
mod format;
mod glb;
mod normals;
mod obj;
mod ply;
mod scene;
mod stl;
mod three_mf;

pub use color::{Color, PointColors};
pub use format::{FORMATS, Format, UNITS, Unit};
pub use scene::{Meshes, Object, Quality, meshes};
