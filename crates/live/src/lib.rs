//! The live picture: a document that is typed, changed and reloaded while its picture follows.
//!
//! [`Live`] holds the document and the settings. A worker thread turns the latest request into a
//! coarse picture and then a fine one, and drops work that a newer request makes useless. The crate
//! knows no terminal, window or file: callers pass text and sizes, and receive pictures and
//! messages.
//!
//! ```
//! use std::time::Duration;
//! use zeroset_live::{Live, Request};
//!
//! let live = Live::new(Request::default());
//! live.resize(64, 64);
//! live.enter("x^2+y^2+z^2 = 1")?;
//! assert!(live.wait(Duration::from_mins(1)));
//! let seen = live.snapshot().rendering.expect("a picture");
//! assert_eq!(seen.picture.rgb.len(), 3 * 64 * 64);
//! # Ok::<(), zeroset_live::Refusal>(())
//! ```

mod command;
mod cut;
mod draft;
mod edit;
mod equivalents;
mod help;
mod hiding;
mod orbit;
mod pipeline;
mod reply;
mod session;
mod settings;
mod slider;
mod source;
mod status;
mod status_words;
mod surfaces;
mod undo;
mod values;

pub use command::{COMMANDS, CommandRow};
pub use draft::entered;
pub use equivalents::EQUIVALENTS;
pub use orbit::Orbit;
pub use pipeline::{Axes, Fault, Rendering, Request, Snapshot, Working};
pub use reply::{Refusal, Reply};
pub use session::Live;
pub use slider::Slider;
pub use source::DocumentSource;
pub use status::{FLAT, quote};
pub use status_words::status_words;
pub use surfaces::SurfaceEntry;
pub use values::defined;
