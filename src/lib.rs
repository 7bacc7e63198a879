//! From a typed equation to a picture of its zero set, with a proof for every pixel.
//!
//! ```
//! use zeroset::model::render;
//! use zeroset::picture::Settings;
//! use zeroset::scene::{self, CameraChoice, DomainChoice};
//!
//! let document = zeroset_syntax::read("x^2+y^2+z^2 = 1", &Default::default())?;
//! let (region, _) = scene::region(&document, DomainChoice::Auto, None)?;
//! let camera = scene::camera(&document, &region, &CameraChoice::default())?;
//! let settings = Settings { width: 64, height: 64, ..Settings::default() };
//! let picture = render(&document, &region, &camera, &settings, &|_done, _of| {})?;
//! assert_eq!(picture.rgb.len(), 3 * 64 * 64);
//! assert!(picture.buffer.counts().miss > 64 * 64 / 3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The command line and any live view share this library. It knows no arguments, terminals or
//! files.

pub mod blank;
pub mod coordinate;
pub mod domain;
pub mod enclosure;
pub mod framing;
pub mod gallery;
pub mod kernels;
pub mod legend;
pub mod live;
pub mod model;
pub mod names;
pub mod picture;
pub mod program;
pub mod scene;
pub mod sequence;
pub mod simplified;
pub mod uniforms;
