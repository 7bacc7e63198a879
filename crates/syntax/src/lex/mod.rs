//! Turns characters into the statements that the grammar reads. Each statement is a list of tokens
//! in one standard form, whichever spelling was typed.
//!
//! Nothing here knows the grammar or the meanings of names.

pub(crate) mod arrangement;
pub(crate) mod bars;
pub(crate) mod curve_form;
pub(crate) mod decimal_comma;
pub(crate) mod environment;
pub(crate) mod foreign_signs;
pub(crate) mod lexer;
pub(crate) mod scanner;
pub(crate) mod spelling;
pub(crate) mod token;
pub(crate) mod token_kind;
