//! Translates notations and programs of other systems to statements of this language: functions
//! with bodies, loops, assignments, plot commands.
//!
//! A translated statement is a list of tokens, perhaps with a separate left side. A synthesized
//! statement, which is not in the text, is a syntax tree. Formulas are not interpreted here.
//! Nothing here knows documents or graphs.
//!
//! The files that extend `ProgramReader` call one another, because a block may hold any statement.

mod arrays;
mod assignment;
mod blocks;
mod branch_merge;
mod calls;
mod control_flow;
mod curve_commands;
mod drawing_calls;
mod effects;
mod formats;
mod functions;
mod grids;
mod inlining;
mod known_numbers;
mod language;
mod lists;
mod mathematica;
mod mathmod;
mod matrices;
mod needed;
mod notebook;
mod notebook_drawings;
mod numpy;
mod parametric;
mod plot_arguments;
mod plot_blocks;
mod plot_commands;
mod program;
mod program_reader;
mod program_words;
mod python;
mod saved;
mod scheme;
mod scopes;
mod styling;
mod terms;
mod wrappers;

pub use program::PastedProgram;
pub use program_reader::program;
pub use program_words::is_scene_function;
