//! Programs as people paste them, brought to statements of this language: functions with bodies,
//! typed declarations, names that are set again, `return`.
//!
//! A name that a function sets becomes a function of the same parameters, so that nothing is left
//! that runs in steps: `vec2 q = p.xz;` in `f(p)` is `f_q(p) = p.xz`, and `q` below it `f_q(p)`.
//! Each time that a name is set again it is another one. What a formula means is not known here.

use crate::lex::scanner::Piece;
use crate::messages::note::Note;
use crate::tree::aliases::Aliases;
use crate::tree::ast::{ExprKind, Name};
use crate::tree::built_statement::Built;
use rustc_hash::FxHashSet;

/// A statement, and what the program around it says of it.
pub(crate) struct Unit {
    pub piece: Piece,
    /// What it defines, where its symbols are the right side only.
    pub head: Option<Head>,
    /// What names stand for here, the last of a name counting.
    pub aliases: Aliases,
    /// What is made of its value.
    pub wrap: Option<Wrap>,
    /// Whether a height over x and y is drawn.
    pub is_height: bool,
}

/// `name` or `name(parameters)` before a `=`.
#[derive(Clone, Debug)]
pub(crate) struct Head {
    pub name: Name,
    pub parameters: Option<Vec<Name>>,
}

/// What a program makes of a value before it has a name.
pub(crate) enum Wrap {
    /// Some components of a vector are set, which had this value before.
    Write { letters: String, before: ExprKind, size: usize },
    /// 1 where a condition holds, else 0.
    Flag,
    /// One component of it.
    Pick(char),
}

/// A text as statements.
#[derive(Default)]
pub(crate) struct Program {
    pub units: Vec<Unit>,
    /// Whether names are typed or set in steps, as programs do.
    pub in_steps: bool,
    /// The last function of one vector of three components.
    pub last_function: Option<Name>,
    /// The last number that was set outside functions.
    pub last_value: Option<Name>,
    /// What the text does not spell out.
    pub made: Vec<Built>,
    /// Names that were made in branches and loops, which may be used nowhere.
    pub generated: FxHashSet<String>,
    pub notes: Vec<Note>,
}
