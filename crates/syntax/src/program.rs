//! Programs as people paste them, brought to statements of this language: functions with bodies,
//! typed declarations, names that are set again, `return`.
//!
//! A name that a function sets becomes a function of the same parameters, so that nothing is left
//! that runs in steps: `vec2 q = p.xz;` in `f(p)` is `f_q(p) = p.xz`, and `q` below it `f_q(p)`. Each
//! time that a name is set again it is another one. What a formula means is not known here.

use crate::aliases::Aliases;
use crate::ast::{ExprKind, Name};
use crate::error::Fallible;
use crate::limits::Limits;
use crate::note::Note;
use crate::program_words::Words;
use crate::reader::{Frame, Reader};
use crate::scan::{Piece, scan};
use crate::span::Span;
use crate::statement::{Built, Head};
use rustc_hash::{FxHashMap, FxHashSet};
use std::cell::Cell;

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
    /// Names that were made for branches and loops, which may be used nowhere.
    pub generated: FxHashSet<String>,
    pub notes: Vec<Note>,
}

/// Reads `text` as statements.
pub(crate) fn program(text: &str, limits: &Limits) -> Fallible<Program> {
    let mut statements = scan(text, limits)?;
    let words = Words { text };
    words.join_bodies(&mut statements);
    let taken = statements
        .iter()
        .flatten()
        .map(|token| &text[token.span.range()])
        .collect::<FxHashSet<_>>();
    let in_steps = statements.iter().any(|tokens| words.is_step(tokens));
    let mut reader = Reader {
        words,
        limits,
        taken: taken.into_iter().map(str::to_owned).collect(),
        heads: FxHashSet::default(),
        whole: FxHashSet::default(),
        macros: FxHashMap::default(),
        procedures: FxHashMap::default(),
        constants: FxHashMap::default(),
        generated: FxHashSet::default(),
        steps: 0,
        written: Cell::new(0),
        program: Program { in_steps, ..Program::default() },
    };
    let mut top = Frame::default();
    let mut statements = statements.into_iter();
    while let Some(tokens) = statements.next() {
        reader.statement(tokens, &mut top, &mut statements)?;
    }
    reader.end(&top, Span::at(text.len()));
    reader.program.generated = reader.generated;
    Ok(reader.program)
}
