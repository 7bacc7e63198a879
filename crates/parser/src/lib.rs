//! Reads texts in the language of zeroset as syntax trees, with diagnostics that point at places in
//! the text.
//!
//! Each stage is a folder that depends only on the folders before it:
//!
//! - `messages`: errors and notes, for all stages and all crates that read texts.
//! - [`lex`]: characters to tokens. It bounds the text's size, maps every spelling to one token and
//!   splits the text into statements.
//! - [`tree`]: tokens to syntax trees in which every name is resolved.
//!
//! Nothing here knows values, graphs or pictures, prints or reads files.

pub mod lex;
mod limits;
mod messages;
pub mod settings;
mod span;
pub mod tree;

pub use limits::Limits;
pub use messages::error::{
    Error, ErrorKind, Errors, Fallible, MAX_ERRORS, Origin, Suggestion, plural,
};
pub use messages::note::{MAX_NOTES, Note, NoteKind};
pub use span::Span;
