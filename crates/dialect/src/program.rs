//! The result of translating a pasted program. A program may have functions with bodies, typed
//! declarations, repeated assignments and `return`.
//!
//! A variable of a function becomes a function with the same parameters. For example, `vec2 q =
//! p.xz;` in `f(p)` becomes `f_q(p) = p.xz`, and a later `q` becomes `f_q(p)`. Each assignment to a
//! variable defines another name, so the order of the resulting statements has no effect.

use crate::plot_arguments::PlotRange;
use rustc_hash::FxHashSet;
use zeroset_parser::lex::token::Token;
use zeroset_parser::tree::aliases::Aliases;
use zeroset_parser::tree::ast::Name;
use zeroset_parser::tree::built_statement::BuiltStatement;
use zeroset_parser::tree::raw_statement::Head;
use zeroset_parser::tree::raw_statement::RawStatement;
use zeroset_parser::tree::scope::Conditions;
use zeroset_parser::{Note, Span};

/// A text, translated to statements of this language.
#[derive(Default)]
#[allow(clippy::struct_excessive_bools)] // independent observations
pub struct PastedProgram {
    /// The statements of the text, translated.
    pub statements: Vec<RawStatement>,
    /// True if the text has declarations or assignments that occur only in programs.
    pub in_steps: bool,
    /// True if the text is a program in the manner of shaders or of POV-Ray, in which y points up.
    pub is_y_up: bool,
    /// True if the trigonometry of the text is in degrees, as in `OpenSCAD`.
    pub in_degrees: bool,
    /// True if the function to draw returns a vector, whose first component is drawn.
    pub draws_first_component: bool,
    /// Name of the function to draw: the last one that takes a point of space.
    pub last_function: Option<Name>,
    /// The variable last assigned outside functions. Assignments of plain numbers do not count.
    pub last_value: Option<Name>,
    /// Rules for conditions that are used as numbers.
    pub conditions: Conditions,
    /// True if the last value is a height over x and y: no statement uses z.
    pub is_height: bool,
    /// Definitions and drawings that are not in the text.
    pub synthesized: Vec<BuiltStatement>,
    /// Names generated in branches and loops. A definition of such a name is dropped if nothing
    /// uses it.
    pub generated: FxHashSet<String>,
    /// The note on statements of a notebook that were left out.
    pub left_out: Option<Note>,
    /// Notes on what was left out or changed.
    pub notes: Vec<Note>,
}

/// A text in another format.
pub(crate) struct ForeignText {
    pub statements: Vec<ForeignStatement>,
    /// The box of each surface, as ranges of x, y and z.
    pub boxes: Vec<Vec<PlotRange>>,
    /// Notes on parts that are not read.
    pub notes: Vec<Note>,
    /// The place of a formula, for a note on the boxes.
    pub span: Span,
}

/// A statement of a text in another format.
pub(crate) struct ForeignStatement {
    pub tokens: Vec<Token>,
    /// The left side of a definition, if the tokens do not have it.
    pub head: Option<Head>,
    /// Names of the text, with the expressions for which they stand.
    pub aliases: Aliases,
}

impl ForeignStatement {
    /// A statement that needs nothing but its tokens.
    pub(crate) fn plain(tokens: Vec<Token>) -> Self {
        Self { tokens, head: None, aliases: Aliases::default() }
    }
}
