//! Programs as people paste them, translated to statements of this language: functions with bodies,
//! typed declarations, repeated assignments, `return`.
//!
//! A variable of a function becomes a function with the same parameters, so the order of statements
//! has no effect: `vec2 q = p.xz;` in `f(p)` becomes `f_q(p) = p.xz`, and a later `q` becomes
//! `f_q(p)`. Each assignment to a variable defines another name.

use crate::messages::note::Note;
use crate::tree::ast::Name;
use crate::tree::built_statement::BuiltStatement;
use crate::tree::raw_statement::RawStatement;
use rustc_hash::FxHashSet;

/// A text, translated to statements of this language.
#[derive(Default)]
pub(crate) struct PastedProgram {
    pub statements: Vec<RawStatement>,
    /// True if the text has declarations or assignments that only programs have.
    pub in_steps: bool,
    /// Name of the function to draw: the last one that takes a point of space.
    pub last_function: Option<Name>,
    /// Name of the last number that is assigned outside functions and is not a known constant.
    pub last_value: Option<Name>,
    /// Statements that the text does not spell out.
    pub synthesized: Vec<BuiltStatement>,
    /// Names generated in branches and loops; they may remain unused.
    pub generated: FxHashSet<String>,
    pub notes: Vec<Note>,
}
