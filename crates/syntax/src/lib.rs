//! Reads the language of zeroset: turns a text into an expression graph, with diagnostics that
//! point at places in the text.
//!
//! A text passes through stages. Each stage is a folder that depends only on the folders before it:
//!
//! - `messages`: errors and notes, for all stages.
//! - `lex`: characters to tokens. It bounds the text's size, maps every spelling to one token and
//!   splits the text into statements.
//! - `tree`: tokens to syntax trees in which every name is resolved.
//! - `lower`: syntax trees to the expression graph, with definitions expanded.
//! - `picture`: lines about the picture, such as `view`.
//! - `dialect`: programs and commands of other systems to statements of this language, before trees
//!   are built.
//! - `list`: expression lists, the format of fidget. They skip all stages but the settings of the
//!   picture.
//! - `document`: runs all stages in turn. [`read`] is its entry point.
//!
//! - `emit`: documents to texts in several formats.
//!
//! Nothing here computes a picture, prints or reads files.
//! ```
//! use zeroset_syntax::{Options, read};
//! let document = read("2x sin y = z^2", &Options::default())?;
//! assert_eq!(document.surfaces[0].echo, "2*x*sin(y) = z^2");
//! # Ok::<(), zeroset_syntax::Errors>(())
//! ```

mod dialect;
mod document;
mod emit;
mod lex;
mod limits;
mod list;
mod lower;
mod messages;
mod picture;
mod settings;
mod span;
mod tree;
mod words;

pub use dialect::program_words::is_scene_function;
pub use document::curves::{Curve, CurveShape, Curves};
pub use document::listed::is_expression_list;
pub use document::reading::{
    Document, Options, Parameter, ParameterKind, Surface, SurfaceKind, parse, read, read_bytes,
};
pub use emit::{EmitError, Format, emit};
pub use limits::Limits;
pub use lower::constant::constant;
pub use messages::error::{Error, ErrorKind, Errors, Origin, Suggestion};
pub use messages::note::{Note, NoteKind};
pub use picture::lines::{PictureLines, SettingLine};
pub use picture::paint::{Contours, MappedColor, POINT_NAMES, PointValue, SurfaceColor};
pub use picture::scene::{Background, ConstantRange, DomainLine, SrgbColor, ViewLine};
pub use settings::setting_word;
pub use span::Span;
pub use tree::ast;
pub use words::{WordKind, language_names, word_help, words};
