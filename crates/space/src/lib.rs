//! Rays, cameras, the region in which a surface is looked for, and boxes that are halved to find
//! it.
//!
//! Every bound is rounded outward, so that no point of a region is lost. Nothing here knows texts
//! or pixels, or how kernels are compiled.

mod camera;
mod cells;
mod patch_tree;
mod ray;
mod region;

pub use camera::{Basis, Camera, CameraError, Projection};
pub use cells::{Cell, CellSearch, places_about, tiles_of};
pub use patch_tree::{PatchCell, PatchNode, PatchTree, columns};
pub use ray::Ray;
pub use region::{Ball, Chord, Entry, HalfSpace, LARGEST_COORDINATE, Region, RegionError};
