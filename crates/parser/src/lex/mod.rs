//! Turns characters into the statements that the grammar reads. Each statement is a list of tokens
//! in one standard form, whichever spelling was typed.
//!
//! Nothing here knows the grammar or the meanings of names.

pub mod arrangement;
pub mod bars;
pub mod curve_form;
pub mod decimal_comma;
pub mod environment;
pub mod foreign_signs;
pub mod lexer;
pub mod open_brackets;
pub mod scanner;
pub mod spelling;
pub mod token;
pub mod token_kind;
