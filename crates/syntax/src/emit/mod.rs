//! Writes a document's functions in other formats: the opposite of reading.
//!
//! Each function is written as typed, not simplified. What is written reads back as the same
//! function. An operation that a format cannot hold is an error that names the operation. Nothing
//! here recurses, and a value with several users is written once, so a text is as long as its
//! graph.

mod formula;
mod list;
mod notation;
mod number;

use crate::document::reading::{Document, ParameterKind, Surface, SurfaceKind};
use zeroset_ir::{Constant, Node, NodeId};
use zeroset_ops::Op;

/// A format in which functions are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// An expression list, as fidget reads it.
    Vm,
    /// A function of GLSL.
    Glsl,
    /// Formulas of LaTeX.
    Tex,
    /// The language of this program.
    Zset,
}

impl Format {
    /// All formats.
    pub const ALL: [Self; 4] = [Self::Vm, Self::Glsl, Self::Tex, Self::Zset];

    /// The format's name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Vm => "vm",
            Self::Glsl => "glsl",
            Self::Tex => "tex",
            Self::Zset => "zset",
        }
    }

    /// Returns whether a text of this format distinguishes solids from equations.
    pub fn holds_kinds(self) -> bool {
        matches!(self, Self::Tex | Self::Zset)
    }
}

/// The reason why a document cannot be written.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EmitError {
    /// The format has no notation for an operation, a number or a curve.
    #[error("`{}` cannot hold {what}", .format.name())]
    Missing {
        /// The format.
        format: Format,
        /// The operation or number.
        what: String,
    },
    /// The format holds one function.
    #[error("`{}` holds one function, but the document draws {count} surfaces", .format.name())]
    SeveralSurfaces {
        /// The format.
        format: Format,
        /// The number of surfaces.
        count: usize,
    },
}

impl EmitError {
    fn missing(format: Format, what: impl Into<String>) -> Self {
        Self::Missing { format, what: what.into() }
    }
}

/// Writes the functions of `document` in a format.
///
/// `zset` keeps sliders, the title and the lines about the picture, which are copied from `text`,
/// the document's own text. The other formats keep none of these.
///
/// # Errors
/// If the format cannot hold an operation, a number or several surfaces, or if there is a curve.
///
/// ```
/// use zeroset_syntax::{Format, Options, emit, read};
/// let text = "x^2 + y^2 + z^2 <= 1";
/// let document = read(text, &Options::default())?;
/// let list = emit(&document, text, Format::Vm).unwrap();
/// assert!(list.starts_with("_0 var-x\n"));
/// # Ok::<(), zeroset_parser::Errors>(())
/// ```
pub fn emit(document: &Document, text: &str, format: Format) -> Result<String, EmitError> {
    if !document.curves.is_empty() {
        return Err(EmitError::missing(format, "a curve or a point"));
    }
    let count = document.surfaces.len();
    if count != 1 && !format.holds_kinds() {
        return Err(EmitError::SeveralSurfaces { format, count });
    }
    match format {
        Format::Vm => list::emit(document),
        Format::Glsl | Format::Tex | Format::Zset => formula::emit(document, text, format),
    }
}

/// The function of a surface, without the value that makes a solid's function defined everywhere.
/// Reading adds that value again.
fn function(document: &Document, surface: &Surface) -> NodeId {
    if surface.kind == SurfaceKind::Solid
        && let Node::Apply(Op::Otherwise, operands) = document.graph.node(surface.root)
        && document.graph.number(operands[1]).is_some_and(Constant::is_one)
    {
        return operands[0];
    }
    surface.root
}

/// The error for a document with sliders or time.
fn parameter_error(document: &Document, format: Format, number: u32) -> EmitError {
    let parameter = document.parameters.iter().find(|parameter| parameter.number == number);
    let what = match parameter {
        Some(parameter) if parameter.kind == ParameterKind::Time => "the time `t`".to_owned(),
        Some(parameter) => format!("the slider `{}`", parameter.name),
        None => "a parameter".to_owned(),
    };
    EmitError::missing(format, what)
}
