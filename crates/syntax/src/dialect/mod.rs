//! Translates notations and programs of other systems to statements of this language: functions
//! with bodies, loops, assignments, plot commands.
//!
//! A translated statement is a list of tokens, perhaps with a separate left side. A synthesized
//! statement, which is not in the text, is a syntax tree. Formulas are not interpreted here. Only
//! `document` calls this folder.
//!
//! The files that extend `ProgramReader` call one another, because a block may hold any statement.

pub(crate) mod assignment;
pub(crate) mod blocks;
pub(crate) mod branch_merge;
pub(crate) mod calls;
pub(crate) mod control_flow;
pub(crate) mod curve_commands;
pub(crate) mod effects;
pub(crate) mod formats;
pub(crate) mod functions;
pub(crate) mod grids;
pub(crate) mod inlining;
pub(crate) mod known_numbers;
pub(crate) mod language;
pub(crate) mod plot_arguments;
pub(crate) mod plot_blocks;
pub(crate) mod plot_commands;
pub(crate) mod program;
pub(crate) mod program_reader;
pub(crate) mod program_words;
pub(crate) mod python;
pub(crate) mod saved;
pub(crate) mod scheme;
pub(crate) mod scopes;
pub(crate) mod styling;
pub(crate) mod terms;
pub(crate) mod wrappers;
