//! Looks, named views and color maps: the tables of what a picture's appearance can be chosen from.
//!
//! A row has the name, which the language and the command line read, beside the numbers, which
//! cameras and shading use. Nothing here knows texts, rays or pixels.

mod color_map;
mod look;
mod view;

pub use color_map::{COLOR_MAPS, ColorMap};
pub use look::{LOOKS, Look};
pub use view::{FOV, StandardView, VIEWS};
