//! The language of zeroset: from text to an expression graph, with diagnostics that point at the
//! place.
//!
//! A text passes through these stages, each a module: `scan` bounds its size, brings every spelling
//! to one symbol (`spelling` has the table) and splits it into statements; `grammar` recognises
//! each; `build` and `run` make trees in which every name is resolved; `lower` expands definitions
//! and writes the graph. [`read`] runs them all. Nothing here evaluates a picture, prints or reads
//! files.
//!
//! ```
//! use zeroset_syntax::{Options, read};
//! let document = read("2x sin y = z^2", &Options::default())?;
//! assert_eq!(document.surfaces[0].echo, "2*x*sin(y) = z^2");
//! # Ok::<(), zeroset_syntax::Errors>(())
//! ```

mod aliases;
mod application;
mod arithmetic;
mod arrange;
mod assignment;
pub mod ast;
mod bars;
mod build;
mod calls;
mod choice;
mod closed;
mod condition;
mod constant;
mod control;
mod coordinates;
mod counting;
mod cycle;
mod diagnose;
mod document;
mod environment;
mod error;
mod explain;
mod foreign;
mod functions;
mod grammar;
mod heading;
mod implied;
mod lexer;
mod limits;
mod lower;
mod made;
mod matrix;
mod merge;
mod note;
mod paint;
mod parameters;
mod picture;
mod plots;
mod prelude;
mod print;
mod program;
mod program_words;
mod reach;
mod reader;
mod render;
mod run;
mod scan;
mod scene;
mod scope;
mod series;
mod setting;
mod span;
mod special;
mod spelling;
mod statement;
mod steps;
mod token;
mod unknown;
mod value;
mod whole;
mod words;
mod wrappers;

pub use constant::constant;
pub use document::{
    Document, Options, Parameter, ParameterKind, Surface, SurfaceKind, parse, read, read_bytes,
};
pub use error::{Error, ErrorKind, Errors, Origin, Suggestion};
pub use limits::Limits;
pub use note::{Note, NoteKind};
pub use paint::{Contours, MappedColor, POINT_NAMES, PointValue, SurfaceColor};
pub use picture::{PictureLines, SettingLine};
pub use scene::{ConstantRange, DomainLine, SrgbColor, ViewLine};
pub use setting::setting_word;
pub use span::Span;
pub use spelling::{COLOR_MAPS, LOOKS, PRESETS};
pub use words::{WordKind, language_names, word_help, words};
