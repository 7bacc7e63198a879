//! Looks, materials, views and color maps: the named choices for a picture's appearance. Also the
//! table of a picture's settings.
//!
//! Each row of a table has a name, which the language and the command line read, and numbers, which
//! cameras and shading use. Nothing here knows texts, rays or pixels.

mod color_map;
mod look;
mod material;
mod setting;
mod settings;
mod view;

pub use color_map::{COLOR_MAPS, ColorMap};
pub use look::{LOOKS, Look};
pub use material::{MATERIALS, Material};
pub use setting::{SHARE, Setting, Values};
pub use settings::{ANTIALIAS, BITS, CHOICES, Choices, OPACITY, RAY_COUNTS, RAYS, WIDTH, settings};
pub use view::{FOV, StandardView, VIEWS};
