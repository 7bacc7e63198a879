//! From a typed equation to a picture of its zero set, with a proof for every pixel.

pub use zeroset_render as render;
pub use zeroset_scene as scene;
