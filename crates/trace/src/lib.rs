//! From kernels to a picture: cameras, the part of space that is seen, traversers, G-buffer and
//! shading.
//!
//! A picture is made in three steps that share only data. A traverser asks kernels where each ray
//! first meets the zero set and fills a [`GBuffer`]; [`normals`] asks for gradients at the points
//! found; [`shade`] turns the buffer into colors without asking anything of the function. This
//! crate never names a code generator, never reads a file and never prints: the reference evaluator
//! drives it as well as native code does.

mod band;
mod buffer_pool;
mod camera;
mod coarse;
mod color;
mod color_map;
mod driver;
mod edges;
mod gbuffer;
mod grid;
mod kernel_stats;
mod light;
mod look;
mod method;
mod methods;
mod normal;
mod occlusion;
mod packet;
mod painted;
mod pattern;
mod ray_result;
mod region;
mod region_caps;
mod rows;
mod scalar;
mod shade;
mod simd_chunks;
mod squares;
mod surface_ids;
mod view;

pub use band::Band;
pub use camera::{Camera, CameraError, Projection, Ray};
pub use coarse::borrow_occlusion;
pub use color::LinearRgb;
pub use color_map::{COLOR_MAPS, ColorMap};
pub use driver::{BAND_ROWS, Driver};
pub use edges::{edges, is_creased, is_smooth, slope};
pub use gbuffer::{GBuffer, Kept, PixelCounts};
pub use grid::{Patch, RayGrid};
pub use kernel_stats::{Count, KernelStats};
pub use light::Light;
pub use look::{LOOKS, Look};
pub use method::{
    Ideas, Method, MethodOption, Precision, Proves, Segment, Start, TraceOptions, Tracer,
};
pub use methods::{METHODS, STEPS};
pub use normal::{NormalSource, normals};
pub use occlusion::{AmbientOcclusion, TURNS};
pub use pattern::Pattern;
pub use ray_result::{RayResult, Status, UndecidedReason};
pub use region::{Ball, HalfSpace, Region, RegionError};
pub use region_caps::{cap, cap_rows};
pub use rows::Rows;
pub use scalar::Scalar;
pub use shade::{
    Appearance, Canvas, Paint, Shader, SurfaceColors, UndecidedStyle, hand_back_colors, shade,
    unset_colors,
};
pub use surface_ids::SurfaceIds;
pub use view::StandardView;
