//! From tokens to syntax trees. The grammar parses each statement, and every name in it is
//! resolved.
//!
//! Nothing here knows values, graphs or pictures, or how programs become statements.
//!
//! The files that extend `Builder` call one another in a circle, because brackets may hold any
//! expression. A sum holds juxtaposed factors, which hold calls, whose arguments are sums.

pub(crate) mod aliases;
pub(crate) mod application;
pub mod ast;
pub(crate) mod builder;
pub(crate) mod built_statement;
pub(crate) mod curve_statement;
pub(crate) mod delimited;
pub(crate) mod derivatives;
pub(crate) mod diagnose;
pub(crate) mod foreign_functions;
pub(crate) mod grammar;
pub(crate) mod juxtaposition;
pub(crate) mod print;
pub(crate) mod raw_statement;
pub(crate) mod scope;
pub(crate) mod scope_hints;
pub(crate) mod series;
pub(crate) mod special_forms;
pub(crate) mod statement;
pub(crate) mod unknown_names;
pub(crate) mod whole_numbers;
