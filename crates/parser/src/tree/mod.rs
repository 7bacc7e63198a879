//! From tokens to syntax trees. The grammar parses each statement, and every name in it is
//! resolved.
//!
//! Nothing here knows values, graphs or pictures, or how programs become statements.
//!
//! The files that extend `Builder` call one another in a circle, because brackets may hold any
//! expression. A sum holds juxtaposed factors, which hold calls, whose arguments are sums.

pub mod aliases;
pub mod application;
pub mod ast;
pub mod builder;
pub mod built_statement;
pub mod curve_statement;
pub mod delimited;
pub mod derivatives;
pub mod diagnose;
pub mod foreign_functions;
pub mod grammar;
pub mod juxtaposition;
pub mod print;
pub mod raw_statement;
pub mod scope;
pub mod scope_hints;
pub mod series;
pub mod special_forms;
pub mod statement;
pub mod unknown_names;
pub mod whole_numbers;
