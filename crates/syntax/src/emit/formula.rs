//! Writes formulas: a line for each value that several others use, or that is long or nested.

use super::notation::{Notation, notation};
use super::number::described;
use super::{EmitError, Format, function, parameter_error};
use crate::document::reading::{
    Document, Options, Parameter, ParameterKind, Surface, SurfaceKind, read,
};
use crate::lower::builders::Moves;
use crate::lower::condition::extend_total;
use std::fmt::Write as _;
use zeroset_ir::{Constant, Graph, Node, NodeId, Precedence};
use zeroset_ops::Op;

/// A value gets a line of its own if its text is longer than this, in bytes, or nested deeper.
const LONGEST: usize = 72;
const DEEPEST: u32 = 8;
/// Largest whole exponent that GLSL gets as a product.
const LARGEST_PRODUCT: i64 = 64;

/// The text of a value.
#[derive(Clone)]
struct Piece {
    text: String,
    precedence: Precedence,
    nesting: u32,
}

impl Piece {
    fn new(text: impl Into<String>, precedence: Precedence, nesting: u32) -> Self {
        Self { text: text.into(), precedence, nesting }
    }

    fn atom(text: impl Into<String>) -> Self {
        Self::new(text, Precedence::Atom, 0)
    }
}

struct Writer<'a> {
    document: &'a Document,
    graph: &'a Graph,
    format: Format,
    /// Letters before the numbers of lines. No parameter's name begins with them.
    prefix: String,
    /// Values that are written on lines of their own, as name and text.
    lines: Vec<(String, String)>,
    pieces: Vec<Option<Piece>>,
    /// How often each value is used by others.
    uses: Vec<u32>,
    /// For each node: whether it is defined everywhere.
    total: Vec<bool>,
}

/// Writes all surfaces of `document`.
pub(super) fn emit(document: &Document, text: &str, format: Format) -> Result<String, EmitError> {
    let graph = &document.graph;
    let roots: Vec<NodeId> = document.surfaces.iter().map(|one| function(document, one)).collect();
    let needed = graph.reachable(&roots);
    let mut uses = vec![0_u32; graph.len()];
    for (_, node) in graph.iter().filter(|(id, _)| needed[id.index()]) {
        if let Node::Apply(op, operands) = node {
            // GLSL repeats the base of a power, so it has to be a name.
            let repeats = format == Format::Glsl && matches!(op, Op::Sqr | Op::Pow);
            for (index, operand) in operands.iter().enumerate() {
                uses[operand.index()] += if repeats && index == 0 { 2 } else { 1 };
            }
        }
    }
    let mut total = Vec::new();
    extend_total(graph, &mut total, &Moves::default());
    let is_free = |prefix: &String| {
        document.parameters.iter().all(|parameter| !parameter.name.starts_with(prefix.as_str()))
    };
    let prefixes = (0..).map(|count| "v".repeat(count + 1) + "_");
    let mut writer = Writer {
        document,
        graph,
        format,
        prefix: prefixes.into_iter().find(is_free).unwrap_or_default(),
        lines: Vec::new(),
        pieces: vec![None; graph.len()],
        uses,
        total,
    };
    for (id, _) in graph.iter().filter(|(id, _)| needed[id.index()]) {
        writer.write(id)?;
    }
    let drawn: Vec<Piece> = roots.iter().map(|root| writer.piece(*root).clone()).collect();
    Ok(match format {
        Format::Glsl => writer.glsl(&drawn[0]),
        Format::Tex | Format::Zset | Format::Vm => writer.document(text, &drawn)?,
    })
}

impl Writer<'_> {
    fn missing(&self, what: impl Into<String>) -> EmitError {
        EmitError::missing(self.format, what)
    }

    fn piece(&self, id: NodeId) -> &Piece {
        self.pieces[id.index()].as_ref().expect("operands come first")
    }

    /// The text of a node, in brackets if it binds less tightly than `needed`.
    fn text(&self, id: NodeId, needed: Precedence) -> String {
        let piece = self.piece(id);
        if piece.precedence >= needed { piece.text.clone() } else { self.bracketed(&piece.text) }
    }

    fn bracketed(&self, text: &str) -> String {
        match self.format {
            Format::Tex => format!("\\left({text}\\right)"),
            Format::Glsl | Format::Zset | Format::Vm => format!("({text})"),
        }
    }

    /// Writes a node to its piece, and perhaps to a line of its own.
    fn write(&mut self, id: NodeId) -> Result<(), EmitError> {
        let node = self.graph.node(id);
        let piece = match node {
            Node::Variable(axis) if self.format == Format::Glsl => {
                Piece::atom(format!("p.{}", axis.name()))
            }
            Node::Variable(axis) => Piece::atom(axis.name()),
            Node::Parameter(number) => self.parameter(*number)?,
            Node::Constant(constant) => self.constant(constant)?,
            Node::Apply(op, operands) => self.apply(*op, operands)?,
        };
        let is_apart = matches!(node, Node::Apply(..))
            && (self.uses[id.index()] > 1 || piece.text.len() > LONGEST || piece.nesting > DEEPEST);
        self.pieces[id.index()] = Some(if is_apart {
            let number = self.lines.len() + 1;
            let name = match self.format {
                Format::Tex => format!("{}{{{number}}}", self.prefix),
                Format::Glsl | Format::Zset | Format::Vm => format!("{}{number}", self.prefix),
            };
            self.lines.push((name.clone(), piece.text));
            Piece::atom(name)
        } else {
            piece
        });
        Ok(())
    }

    fn parameter(&self, number: u32) -> Result<Piece, EmitError> {
        let found = self.document.parameters.iter().find(|one| one.number == number);
        match found {
            Some(parameter) if self.format == Format::Zset => Ok(Piece::atom(&parameter.name)),
            _ => Err(parameter_error(self.document, self.format, number)),
        }
    }

    fn constant(&self, constant: &Constant) -> Result<Piece, EmitError> {
        let missing = || self.missing(described(constant));
        if let Constant::Named(name) = constant {
            let taken = self.document.parameters.iter().any(|one| one.name == name.name());
            return match self.format {
                Format::Zset if !taken => Ok(Piece::atom(name.name())),
                Format::Tex if name.name().len() > 1 => {
                    Ok(Piece::atom(format!("\\{}", name.name())))
                }
                Format::Tex => Ok(Piece::atom(name.name())),
                Format::Zset | Format::Glsl | Format::Vm => Err(missing()),
            };
        }
        let mut digits = constant.digits().ok_or_else(missing)?;
        if self.format == Format::Glsl && !digits.contains('.') {
            digits.push_str(".0");
        }
        let sign = if digits.starts_with('-') { Precedence::Sign } else { Precedence::Atom };
        Ok(Piece::new(digits, sign, 0))
    }

    fn apply(&self, op: Op, operands: &[NodeId]) -> Result<Piece, EmitError> {
        use Precedence::{Atom, Product, Sign, Sum};
        let nesting = 1 + operands.iter().map(|id| self.piece(*id).nesting).max().unwrap_or(0);
        let text = |index: usize, needed| self.text(operands[index], needed);
        let described = || format!("`{}`: {}", op.row().name, op.row().doc);
        let (text, precedence) = match notation(self.format, op) {
            Notation::Call(name) => {
                let arguments: Vec<String> = (0..operands.len()).map(|i| text(i, Sum)).collect();
                let arguments = self.bracketed(&arguments.join(", "));
                (format!("{name}{arguments}"), Atom)
            }
            Notation::Around(before, after) => (format!("{before}{}{after}", text(0, Sum)), Atom),
            Notation::Sign(sign) if op == Op::Neg => (format!("{sign}{}", text(0, Product)), Sign),
            Notation::Sign(sign) if matches!(op, Op::Add | Op::Sub) => {
                (format!("{} {sign} {}", text(0, Sum), text(1, Product)), Sum)
            }
            Notation::Sign(sign) => {
                let space = if self.format == Format::Tex { " " } else { "" };
                let right = text(1, Precedence::Power);
                (format!("{}{space}{sign}{space}{right}", text(0, Product)), Product)
            }
            Notation::Special => return self.special(op, operands, nesting),
            Notation::Missing => return Err(self.missing(described())),
        };
        Ok(Piece::new(text, precedence, nesting))
    }

    /// Writes operations that need a notation of their own in some format.
    fn special(&self, op: Op, operands: &[NodeId], nesting: u32) -> Result<Piece, EmitError> {
        use Precedence::{Atom, Power, Product, Sum};
        let text = |index: usize, needed| self.text(operands[index], needed);
        let tex = self.format == Format::Tex;
        let (text, precedence) = match op {
            Op::Div => (format!("\\frac{{{}}}{{{}}}", text(0, Sum), text(1, Sum)), Atom),
            Op::Pow | Op::Sqr if self.format == Format::Glsl => {
                return self.glsl_power(op, operands, nesting);
            }
            Op::Sqr if tex => {
                (format!("\\operatorname{{sqr}}\\left({}\\right)", text(0, Sum)), Atom)
            }
            Op::Sqr => (format!("sqr({})", text(0, Sum)), Atom),
            Op::Pow if tex => (format!("{}^{{{}}}", text(0, Atom), text(1, Sum)), Power),
            Op::Pow => (format!("{}^{}", text(0, Atom), text(1, Power)), Power),
            Op::SelectNegative => {
                let is = |node: NodeId, value: i64| {
                    self.graph.number(node).and_then(Constant::as_integer) == Some(value)
                };
                if !tex && self.format == Format::Zset && is(operands[1], 0) && is(operands[2], 1) {
                    (format!("heaviside({})", text(0, Sum)), Atom)
                } else if self.total[operands[0].index()] {
                    let [q, below, above] = [0, 1, 2].map(|index| text(index, Sum));
                    match self.format {
                        Format::Tex => (
                            format!(
                                "\\begin{{cases}} {above} & {q} \\ge 0 \\\\ {below} & \
                                 \\text{{otherwise}} \\end{{cases}}"
                            ),
                            Atom,
                        ),
                        Format::Glsl => (format!("({q} >= 0.0 ? {above} : {below})"), Atom),
                        Format::Zset | Format::Vm => {
                            (format!("{{{q} >= 0: {above}, {below}}}"), Atom)
                        }
                    }
                } else {
                    let what = "a choice by the sign of a value that is not defined everywhere";
                    return Err(self.missing(what));
                }
            }
            Op::WhereNonneg | Op::WherePositive | Op::WhereNonzero => {
                let sign = match (op, tex) {
                    (Op::WhereNonneg, false) => ">=",
                    (Op::WhereNonneg, true) => "\\ge",
                    (Op::WherePositive, _) => ">",
                    (_, false) => "!=",
                    (_, true) => "\\ne",
                };
                let [value, by] = [0, 1].map(|index| text(index, Sum));
                if tex {
                    (format!("\\begin{{cases}} {value} & {by} {sign} 0 \\end{{cases}}"), Atom)
                } else {
                    (format!("{{{by} {sign} 0: {value}}}"), Atom)
                }
            }
            _ => (format!("{}({})", op.row().name, text(0, Product)), Atom),
        };
        Ok(Piece::new(text, precedence, nesting))
    }

    /// A power in GLSL, whose `pow` has no value for negative bases. Whole exponents give products.
    fn glsl_power(&self, op: Op, operands: &[NodeId], nesting: u32) -> Result<Piece, EmitError> {
        use Precedence::{Atom, Power, Product, Sum};
        let exponent = match operands.get(1) {
            None => Some(2),
            Some(exponent) => self.graph.number(*exponent).and_then(Constant::as_integer),
        };
        let base = self.text(operands[0], Power);
        let Some(exponent) = exponent else {
            let [base, exponent] = [0, 1].map(|index| self.text(operands[index], Sum));
            return Ok(Piece::new(format!("pow({base}, {exponent})"), Atom, nesting));
        };
        if !(1..=LARGEST_PRODUCT).contains(&exponent.abs()) {
            return Err(self.missing(format!("`{}` with exponent {exponent}", op.row().name)));
        }
        let product = vec![base; exponent.unsigned_abs() as usize].join("*");
        Ok(match exponent {
            1 => Piece::new(product, self.piece(operands[0]).precedence.max(Power), nesting),
            2.. => Piece::new(product, Product, nesting),
            _ => Piece::new(format!("1.0/({product})"), Product, nesting),
        })
    }

    /// A function of GLSL.
    fn glsl(&self, drawn: &Piece) -> String {
        let mut text = String::from("float map(vec3 p) {\n");
        for (name, value) in &self.lines {
            let _ = writeln!(text, "    float {name} = {value};");
        }
        let _ = writeln!(text, "    return {};\n}}", drawn.text);
        text
    }

    /// A document of lines: sliders, values, surfaces.
    fn document(&self, source: &str, drawn: &[Piece]) -> Result<String, EmitError> {
        let mut head = String::new();
        if self.format == Format::Zset {
            for line in
                self.document.title.iter().flat_map(|t| t.lines()).chain(self.document.doc.lines())
            {
                let _ = writeln!(head, "# {line}");
            }
            for parameter in &self.document.parameters {
                head.push_str(&self.slider(parameter)?);
            }
        }
        let separator = if self.format == Format::Tex { " \\\\\n" } else { "\n" };
        for (name, value) in &self.lines {
            let _ = write!(head, "{name} = {value}{separator}");
        }
        let surfaces: Vec<(usize, String)> = self
            .document
            .surfaces
            .iter()
            .zip(drawn)
            .map(|(surface, piece)| (surface.span.start, self.surface(surface, piece)))
            .collect();
        let settings: Vec<(usize, String)> = match self.format {
            Format::Zset => self
                .document
                .lines
                .iter()
                .map(|line| (line.span.start, source[line.span.range()].to_owned()))
                .collect(),
            Format::Vm | Format::Glsl | Format::Tex => Vec::new(),
        };
        let joined = |settings: &[(usize, String)]| {
            let mut lines: Vec<&(usize, String)> = surfaces.iter().chain(settings).collect();
            lines.sort_by_key(|(at, _)| *at);
            let lines: Vec<&str> = lines.into_iter().map(|(_, line)| line.as_str()).collect();
            format!("{head}{}\n", lines.join(separator))
        };
        // A line about the picture may use a name that only the source defines.
        let whole = joined(&settings);
        if settings.is_empty() || read(&whole, &Options::default()).is_ok() {
            return Ok(whole);
        }
        Err(self.missing("a line about the picture that uses a name of the text"))
    }

    fn surface(&self, surface: &Surface, piece: &Piece) -> String {
        let Surface { kind, holds_zeros, .. } = *surface;
        let tex = self.format == Format::Tex;
        match kind {
            SurfaceKind::Solid if holds_zeros == Some(false) => format!("{} < 0", piece.text),
            SurfaceKind::Solid => format!("{} {} 0", piece.text, if tex { "\\le" } else { "<=" }),
            // A name or a call before a single `=` could be read as a definition.
            SurfaceKind::Equation if piece.precedence == Precedence::Atom && tex => {
                piece.text.clone()
            }
            SurfaceKind::Equation if piece.precedence == Precedence::Atom => {
                format!("{} == 0", piece.text)
            }
            SurfaceKind::Equation => format!("{} = 0", piece.text),
        }
    }

    /// The line of a slider or of the time.
    fn slider(&self, parameter: &Parameter) -> Result<String, EmitError> {
        let Parameter { name, value, range, kind, span, .. } = parameter;
        if *kind == ParameterKind::Time && span.is_none() {
            return Ok(String::new());
        }
        let digits = |constant: &Constant| {
            let missing = || self.missing(format!("in `{name}`, {}", described(constant)));
            constant.digits().ok_or_else(missing)
        };
        let value = digits(value)?;
        Ok(match range {
            None => format!("{name} = {value}\n"),
            Some((low, high)) => {
                format!("{name} = {value} in [{}, {}]\n", digits(low)?, digits(high)?)
            }
        })
    }
}
