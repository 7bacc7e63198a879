//! Reads the language of zeroset: turns a text into a document, whose functions are expression
//! graphs.
//!
//! The parser's crate makes tokens and syntax trees, and the dialects' crate translates programs of
//! other systems before trees are built. The rest are stages. Each is a folder that depends only on
//! the folders before it:
//!
//! - `lower`: syntax trees to the expression graph, with definitions expanded.
//! - `picture`: lines about the picture, such as `view`.
//! - `list`: expression lists, the format of fidget. They skip all stages but the settings of the
//!   picture.
//! - `document`: runs all stages in turn.
//! - `hints`: for a text with errors, lines to write instead. [`read`] is the entry point.
//! - `emit`: documents to texts in several formats.
//!
//! Nothing here computes a picture, prints or reads files.
//!
//! ```
//! use zeroset_syntax::{Options, read};
//! let document = read("2x sin y = z^2", &Options::default())?;
//! assert_eq!(document.surfaces[0].echo, "2*x*sin(y) = z^2");
//! # Ok::<(), zeroset_parser::Errors>(())
//! ```

mod document;
mod emit;
mod hints;
mod list;
mod lower;
mod picture;
mod words;

pub use document::curves::{Curve, CurveShape, Curves};
pub use document::expression::{names_in, read_expression};
pub use document::listed::is_expression_list;
pub use document::patches::{Patch, Patches};
pub use document::reading::{
    Document, DrawnSurface, Options, Parameter, ParameterKind, Surface, SurfaceKind, parse,
};
pub use emit::{EmitError, Format, emit};
pub use hints::{read, read_bytes, statement};
pub use lower::constant::constant;
pub use picture::lines::{PictureLines, SettingLine};
pub use picture::paint::{Contours, MappedColor, POINT_NAMES, PointValue, SurfaceColor};
pub use picture::scene::{Background, ConstantRange, DomainLine, SrgbColor, ViewLine};
pub use words::{WordKind, language_names, word_help, words};
