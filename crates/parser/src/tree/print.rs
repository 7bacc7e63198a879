//! Prints trees as canonical text. Every `*` is explicit. Brackets stand only where the text would
//! otherwise have another meaning.
//!
//! Parsing the printed text gives an equal tree; a property test checks this.

use crate::lex::spelling::{is_name_char, token_kind};
use crate::lex::token_kind::TokenKind;
use crate::tree::application::is_swapped_root;
use crate::tree::ast::{
    Chain, ChainSign, CurveForm, Definition, Expr, ExprKind, Function, NamedValue, Relation,
    Series, Statement,
};
use std::fmt;

/// Binding strength of an expression. An expression that binds too weakly gets brackets.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
enum Tightness {
    Or,
    And,
    Not,
    Compare,
    Sum,
    Product,
    Power,
    Atom,
}

/// The tightness of an expression's outermost operation.
fn tightness(expr: &Expr) -> Tightness {
    match &expr.kind {
        ExprKind::Or(_) => Tightness::Or,
        ExprKind::And(_) => Tightness::And,
        ExprKind::Not(_) => Tightness::Not,
        ExprKind::Compare(..) => Tightness::Compare,
        ExprKind::Negate(_) | ExprKind::Chain(Chain::Sum, ..) => Tightness::Sum,
        ExprKind::Chain(Chain::Product, ..) => Tightness::Product,
        ExprKind::Power(..) => Tightness::Power,
        ExprKind::Number(_)
        | ExprKind::Name(_)
        | ExprKind::Call(..)
        | ExprKind::Choice(..)
        | ExprKind::Component(..)
        | ExprKind::Series(_) => Tightness::Atom,
    }
}

/// Writes `expr`, in brackets unless `expr` binds at least as tightly as `needed`.
fn write(f: &mut fmt::Formatter<'_>, expr: &Expr, needed: Tightness) -> fmt::Result {
    if tightness(expr) >= needed { write!(f, "{expr}") } else { write!(f, "({expr})") }
}

/// Writes expressions with `joint` between them. Those that bind less tightly than `needed` get
/// brackets.
fn list(f: &mut fmt::Formatter<'_>, items: &[Expr], joint: &str, needed: Tightness) -> fmt::Result {
    for (index, item) in items.iter().enumerate() {
        if index > 0 {
            f.write_str(joint)?;
        }
        write(f, item, needed)?;
    }
    Ok(())
}

/// The text of an expression as a factor: in brackets if it binds less tightly than a power.
pub(crate) fn factor_text(expr: &Expr) -> String {
    if tightness(expr) >= Tightness::Power { expr.to_string() } else { format!("({expr})") }
}

impl fmt::Display for Expr {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.kind {
            ExprKind::Number(text) => f.write_str(text),
            ExprKind::Name(value) => f.write_str(value.name()),
            ExprKind::Negate(inner) => {
                f.write_str("-")?;
                write(f, inner, Tightness::Product)
            }
            ExprKind::Chain(kind, first, rest) => {
                let (needed, signs) = match kind {
                    Chain::Sum => (Tightness::Product, [" + ", " - "]),
                    Chain::Product => (Tightness::Power, ["*", "/"]),
                };
                // A sign before the first term needs no brackets: -a + b is (-a) + b.
                match (kind, &first.kind) {
                    (Chain::Sum, ExprKind::Negate(_)) => write(f, first, Tightness::Sum)?,
                    _ => write(f, first, needed)?,
                }
                for (sign, operand) in rest {
                    f.write_str(signs[usize::from(*sign == ChainSign::Inverse)])?;
                    write(f, operand, needed)?;
                }
                Ok(())
            }
            ExprKind::Power(base, exponent) => {
                write(f, base, Tightness::Atom)?;
                f.write_str("^")?;
                write(f, exponent, Tightness::Power)
            }
            ExprKind::Choice(pieces, otherwise) => write_choice(f, pieces, otherwise.as_deref()),
            ExprKind::Component(vector, letters) => {
                // A component cannot directly follow a number or a coordinate, hence the brackets.
                match vector.kind {
                    ExprKind::Number(_) | ExprKind::Name(NamedValue::Coordinate(_)) => {
                        write!(f, "({vector})")?;
                    }
                    _ => write(f, vector, Tightness::Atom)?,
                }
                write!(f, ".{letters}")
            }
            ExprKind::Series(series) => series.fmt(f),
            ExprKind::Call(function, arguments) => {
                let is_surd = matches!((function, arguments.as_slice()),
                    (Function::Root, [first, second]) if is_swapped_root(first, second));
                f.write_str(if is_surd { "surd" } else { function.name() })?;
                if let Function::Derived(_, order) = function {
                    f.write_str(&"'".repeat(usize::from(*order)))?;
                }
                f.write_str("(")?;
                if let Function::Iterate(repeated) = function {
                    write!(f, "{}, ", repeated.name())?;
                }
                list(f, arguments, ", ", Tightness::Or)?;
                if let Function::Derivative(by) = function {
                    by.iter().try_for_each(|variable| write!(f, ", {}", variable.name()))?;
                }
                f.write_str(")")
            }
            ExprKind::Compare(first, rest) => {
                write(f, first, Tightness::Sum)?;
                for (relation, other) in rest {
                    write!(f, " {} ", relation.symbol())?;
                    write(f, other, Tightness::Sum)?;
                }
                Ok(())
            }
            ExprKind::And(items) => list(f, items, " and ", Tightness::Not),
            ExprKind::Or(items) => list(f, items, " or ", Tightness::And),
            ExprKind::Not(inner) => {
                f.write_str("not ")?;
                write(f, inner, Tightness::Atom)
            }
        }
    }
}

fn write_choice(
    f: &mut fmt::Formatter<'_>,
    pieces: &[(Expr, Expr)],
    otherwise: Option<&Expr>,
) -> fmt::Result {
    for (index, (condition, value)) in pieces.iter().enumerate() {
        let joint = if index == 0 { "{" } else { ", " };
        write!(f, "{joint}{condition}: {value}")?;
    }
    match otherwise {
        Some(value) => write!(f, ", {value}}}"),
        None => f.write_str("}"),
    }
}

impl fmt::Display for Series {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { is_product, index, low, high, step, body } = self;
        let name = if *is_product { "product" } else { "sum" };
        write!(f, "{name}({} = {low}..{high}", index.text)?;
        if let Some(step) = step {
            write!(f, "..{step}")?;
        }
        write!(f, ", {body})")
    }
}

impl fmt::Display for Definition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name.text)?;
        if let Some(parameters) = &self.parameters {
            let names: Vec<&str> = parameters.iter().map(|name| name.text.as_str()).collect();
            write!(f, "({})", names.join(", "))?;
        }
        write!(f, " = {}", self.body)?;
        match &self.range {
            Some((low, high)) => write!(f, " in [{low}, {high}]"),
            None => Ok(()),
        }
    }
}

impl fmt::Display for Statement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Define(definition) => definition.fmt(f),
            Self::Draw { expr, restrictions } => {
                // With a single `=`, this equation would be read as a definition.
                if let ExprKind::Compare(left, rest) = &expr.kind
                    && let [(Relation::Equal, right)] = rest.as_slice()
                    && may_be_defined(left)
                {
                    write!(f, "{left} == {right}")?;
                } else {
                    write_drawn(f, expr)?;
                }
                write_restrictions(f, restrictions)
            }
            Self::Curve(curve) => curve.form.fmt(f),
        }
    }
}

impl fmt::Display for CurveForm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let point = |f: &mut fmt::Formatter<'_>, at: &[Expr]| {
            f.write_str("(")?;
            list(f, at, ", ", Tightness::Or)?;
            f.write_str(")")
        };
        let moving = |f: &mut fmt::Formatter<'_>, at: &[Expr]| match at {
            [vector] => write!(f, "curve {vector}"),
            at => point(f, at),
        };
        match self {
            Self::Equations { equations, restrictions } => {
                f.write_str("curve ")?;
                list(f, equations, ", ", Tightness::Compare)?;
                write_restrictions(f, restrictions)
            }
            Self::Path { at, parameter, range } => {
                moving(f, at)?;
                write!(f, " for {} in [{}, {}]", parameter.text, range.0, range.1)
            }
            Self::Patch { at, parameters: [u, v], ranges } => {
                moving(f, at)?;
                let [(u_low, u_high), (v_low, v_high)] = ranges.as_ref();
                write!(f, " for {} in [{u_low}, {u_high}]", u.text)?;
                write!(f, ", {} in [{v_low}, {v_high}]", v.text)
            }
            Self::Point { at, label } => {
                point(f, at)?;
                label.iter().try_for_each(|label| write!(f, " \"{label}\""))
            }
        }
    }
}

/// Returns whether `left` before a `=` would be read as the left side of a definition.
fn may_be_defined(left: &Expr) -> bool {
    match &left.kind {
        ExprKind::Name(value) => !matches!(value, NamedValue::Coordinate(_)),
        // Programs assign to a component, as in `p.x = 1`.
        ExprKind::Component(vector, _) => matches!(vector.kind, ExprKind::Name(_)),
        ExprKind::Call(Function::Defined(_), arguments) => {
            arguments.iter().all(|argument| matches!(argument.kind, ExprKind::Name(_)))
        }
        _ => false,
    }
}

/// Writes a drawn expression. Puts a first name that begins a line about the picture in brackets.
fn write_drawn(f: &mut fmt::Formatter<'_>, expr: &Expr) -> fmt::Result {
    let text = expr.to_string();
    let (word, rest) = text.split_at(text.find(|c| !is_name_char(c)).unwrap_or(text.len()));
    let is_keyword = token_kind(word).is_some_and(TokenKind::is_setting);
    if is_keyword && (rest.is_empty() || rest.starts_with(" + ") || rest.starts_with(" - ")) {
        write!(f, "({word}){rest}")
    } else {
        f.write_str(&text)
    }
}

fn write_restrictions(f: &mut fmt::Formatter<'_>, restrictions: &[Expr]) -> fmt::Result {
    if restrictions.is_empty() {
        return Ok(());
    }
    f.write_str(" {")?;
    list(f, restrictions, ", ", Tightness::Or)?;
    f.write_str("}")
}

/// A drawing as it is shown to users. Every equation has a single `=`.
pub struct Drawing<'a> {
    /// The equation, inequality or other condition.
    pub expr: &'a Expr,
    /// Conditions that restrict the drawing.
    pub restrictions: &'a [Expr],
}

impl fmt::Display for Drawing<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write_drawn(f, self.expr)?;
        write_restrictions(f, self.restrictions)
    }
}
