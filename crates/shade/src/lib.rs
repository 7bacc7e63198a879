//! From a G-buffer to colors: normals, light, ambient occlusion, edges, and shading.
//!
//! [`normals`] evaluates gradients at painted points; everything else reads only the G-buffer.
//! Nothing here changes a status, distance or bracket: shading affects appearance, not proofs. This
//! crate depends neither on documents nor on files.

mod coarse;
mod color;
mod colors;
mod displayed;
mod edges;
mod light;
mod normal;
mod occlusion;
mod pattern;
mod shade;

pub use coarse::{borrow_occlusion, neighbors};
pub use color::LinearRgb;
pub use colors::{ColorDepth, Colors, ColorsMut, hand_back_colors};
pub use displayed::Displayed;
pub use edges::{edges, is_creased, is_smooth, slope};
pub use light::Light;
pub use normal::{NormalSource, normals};
pub use occlusion::{AmbientOcclusion, TURNS, turn};
pub use pattern::Pattern;
pub use shade::{
    Appearance, ColoredRows, Haze, Paint, Shader, SurfaceColors, UndecidedStyle, shade,
};
