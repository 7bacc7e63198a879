//! From a typed equation to a picture of its zero set, with a proof for every pixel.

pub mod domain;
pub mod enclosure;
pub mod gallery;
pub mod picture;
pub mod program;
pub mod scene;
pub mod work;
pub mod zeros;
