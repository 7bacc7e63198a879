//! Programs as people paste them, brought to statements of this language: functions with bodies,
//! typed declarations, names that are set again, `return`.
//!
//! A name that a function sets becomes a function of the same parameters, so that nothing is left
//! that runs in steps: `vec2 q = p.xz;` in `f(p)` is `f_q(p) = p.xz`, and `q` below it `f_q(p)`.
//! Each time that a name is set again it is another one. What a formula means is not known here.

use crate::messages::note::Note;
use crate::tree::ast::Name;
use crate::tree::built_statement::BuiltStatement;
use crate::tree::raw_statement::RawStatement;
use rustc_hash::FxHashSet;

/// A text as statements.
#[derive(Default)]
pub(crate) struct PastedProgram {
    pub statements: Vec<RawStatement>,
    /// Whether names are typed or set in steps, as programs do.
    pub in_steps: bool,
    /// The last function of one vector of three components.
    pub last_function: Option<Name>,
    /// The last number that was set outside functions.
    pub last_value: Option<Name>,
    /// What the text does not spell out.
    pub synthesized: Vec<BuiltStatement>,
    /// Names that were made in branches and loops, which may be used nowhere.
    pub generated: FxHashSet<String>,
    pub notes: Vec<Note>,
}
