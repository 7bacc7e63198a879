//! Reads scripts of `MathMod`: the implicit surfaces of an object `Iso3D` and the parametric ones
//! of `Param3D`, with their constants and functions. Formulas are scanned in a copy of the text in
//! which all else is blank.

use crate::curve_commands::path_of;
use crate::formats::{part, unread_keys};
use crate::plot_arguments::PlotRange;
use crate::program::{ForeignStatement, ForeignText};
use std::ops::Range;
use zeroset_ir::Axis;
use zeroset_parser::lex::token::Token;
use zeroset_parser::lex::token_kind::TokenKind::{self, *};
use zeroset_parser::tree::aliases::Aliases;
use zeroset_parser::tree::ast::{Expr, ExprKind, Function, Name, NamedValue};
use zeroset_parser::tree::raw_statement::Head;
use zeroset_parser::{Error, ErrorKind, Fallible, Limits, Span};

/// Keys whose values are read.
#[rustfmt::skip] // several words a line
const READ: &[&str] = &[
    "const", "funct", "varu", "fxyz", "xmin", "xmax", "ymin", "ymax", "zmin", "zmax", "iso3d",
    "mathmodels", "param3d", "fx", "fy", "fz", "umin", "umax", "vmin", "vmax",
];

/// Functions of `MathMod` that have no counterpart.
const WITHOUT_COUNTERPART: ErrorKind = ErrorKind::Format {
    format: "MathMod",
    read: "noise and stored values are not read (`NoiseW`, `NoiseP`, `NoiseT`, `psh`, `csd`)",
    help: "leave out the term with the noise, or write a sum of sines in its place",
};

/// A key, and the place of each string in its value.
type Member<'a> = (&'a str, Vec<Range<usize>>);

struct MathModReader<'a> {
    text: &'a str,
    limits: &'a Limits,
    members: Vec<Member<'a>>,
    statements: Vec<ForeignStatement>,
    /// Names of the functions of one coordinate. The value of `A` at x is called `Ax`.
    of_axes: Vec<String>,
}

/// Reads a script. If it has several objects, the first is drawn.
///
/// # Errors
/// If the script has no surface, or uses a function that has no counterpart here.
pub(crate) fn mathmod(text: &str, limits: &Limits) -> Fallible<ForeignText> {
    let key = |key: &'static str| text.find(key).map(|at| (at, key));
    let implicit = key("\"Iso3D\"");
    let is_later = |(at, _): &(usize, &str)| implicit.is_some_and(|(other, _)| other < *at);
    let parametric = key("\"Param3D\"").filter(|found| !is_later(found));
    let (at, start) = match parametric.or(implicit) {
        Some((at, key)) => (at, at + key.len()),
        None => (0, 0),
    };
    let members = members(text, start);
    let (statements, of_axes) = (Vec::new(), Vec::new());
    let mut reader = MathModReader { text, limits, members, statements, of_axes };
    reader.definitions(parametric.is_some())?;
    let drawn = reader.values(if parametric.is_some() { "Fx" } else { "Fxyz" });
    let span = drawn.first().map_or(Span::at(at), |first| Span::new(first.start, first.end));
    if parametric.is_some() {
        reader.parametric(span)?;
    } else {
        reader.implicit(drawn)?;
    }
    if reader.statements.last().is_none_or(|last| last.head.is_some()) {
        return Err(Error::new(span, ErrorKind::NoFormula));
    }
    let boxes = reader.boxes()?;
    let notes = unread_keys(text, READ, span).into_iter().collect();
    Ok(ForeignText { statements: reader.statements, boxes, notes, span })
}

impl MathModReader<'_> {
    /// The places of the strings of a key.
    fn values(&self, key: &str) -> Vec<Range<usize>> {
        let found = self.members.iter().find(|(name, _)| name.eq_ignore_ascii_case(key));
        found.map_or(Vec::new(), |(_, values)| values.clone())
    }

    /// Reads the functions that are drawn where they are 0.
    fn implicit(&mut self, formulas: Vec<Range<usize>>) -> Fallible<()> {
        for range in formulas {
            let tokens = self.formula(range)?;
            let aliases = self
                .aliases(&|axis| ExprKind::Name(NamedValue::Coordinate(axis)), &NamedValue::Time);
            self.statements.push(ForeignStatement { tokens, head: None, aliases });
        }
        Ok(())
    }

    /// Reads the coordinates of parametric surfaces, with the ranges of u and v.
    fn parametric(&mut self, place: Span) -> Fallible<()> {
        for index in 0..self.values("Fx").len() {
            let value = |key: &str| {
                let range = self.values(key).get(index).cloned();
                range.map_or(Err(Error::new(place, ErrorKind::Parametric)), |r| self.formula(r))
            };
            let parts = [value("Fx")?, value("Fy")?, value("Fz")?];
            let [low_u, high_u] = [value("Umin")?, value("Umax")?];
            let [low_v, high_v] = [value("Vmin")?, value("Vmax")?];
            let of_u = PlotRange { name: None, low: low_u, high: high_u };
            let of_v = PlotRange { name: None, low: low_v, high: high_v };
            // A token's name is that of its place in the text.
            let named = |name: &str| {
                let mut tokens = parts.iter().flatten();
                let is_own = |token: &&Token| &self.text[token.span.range()] == name;
                let used = tokens.find(is_own).map(|token| token.span);
                let found = used.or_else(|| {
                    let at = self.text.find(name)?;
                    Some(Span::new(at, at + name.len()))
                });
                found.map(|span| Token::new(TokenKind::Name, span))
            };
            let names = named("u").zip(named("v"));
            let (u, v) = names.ok_or_else(|| Error::new(place, ErrorKind::Parametric))?;
            let tokens = path_of(place, &parts, &[(u, &of_u), (v, &of_v)]);
            self.statements.push(ForeignStatement::plain(tokens));
        }
        Ok(())
    }

    /// Reads the constants, the functions of one coordinate, and the functions of all of them, or
    /// of both parameters.
    fn definitions(&mut self, is_parametric: bool) -> Fallible<()> {
        let parameters = |names: &[&str], span: Span| {
            let name = |text: &&str| Name { text: (*text).to_owned(), span };
            names.iter().map(name).collect::<Vec<Name>>()
        };
        let of_coordinates =
            [("Const", &[][..]), ("Varu", &["u", "tm"]), ("Funct", &["x", "y", "z", "t"])];
        let of_parameters = [("Const", &[][..]), ("Funct", &["u", "v", "t"])];
        let keys = if is_parametric { &of_parameters[..] } else { &of_coordinates };
        for (key, names) in keys.iter().copied() {
            for range in self.values(key) {
                let Some(sign) = self.text[range.clone()].find('=') else { continue };
                let typed = &self.text[range.start..range.start + sign];
                let name = typed.trim();
                if !name.starts_with(char::is_alphabetic) {
                    continue;
                }
                let start = range.start + typed.len() - typed.trim_start().len();
                let span = Span::new(start, start + name.len());
                let tokens = self.formula(range.start + sign + 1..range.end)?;
                let local = |name: &str| NamedValue::Local(name.to_owned());
                let aliases = if key == "Funct" {
                    self.aliases(&|axis| ExprKind::Name(local(axis.name())), &local("t"))
                } else {
                    Aliases::default()
                };
                if key == "Varu" {
                    self.of_axes.push(name.to_owned());
                }
                let parameters = Some(parameters(names, span)).filter(|names| !names.is_empty());
                let head = Head { name: Name { text: name.to_owned(), span }, parameters };
                self.statements.push(ForeignStatement { tokens, head: Some(head), aliases });
            }
        }
        Ok(())
    }

    /// Aliases such as `Ax` for the call of `A` at a coordinate.
    fn aliases(&self, coordinate: &dyn Fn(Axis) -> ExprKind, time: &NamedValue) -> Aliases {
        let mut aliases = Aliases::default();
        let span = Span::default();
        for name in &self.of_axes {
            for axis in Axis::ALL {
                let arguments = [coordinate(axis), ExprKind::Name(time.clone())];
                let arguments = arguments.map(|kind| Expr::new(kind, span)).to_vec();
                let call = ExprKind::Call(Function::Defined(name.clone()), arguments);
                aliases.push(format!("{name}{}", axis.name()), call);
            }
        }
        aliases
    }

    /// The tokens of a formula, in which `&` and `|` join conditions.
    fn formula(&self, range: Range<usize>) -> Fallible<Vec<Token>> {
        let mut tokens = part(self.text, range, self.limits)?;
        for token in &mut tokens {
            let word = if token.kind.is_name() { &self.text[token.span.range()] } else { "" };
            if word.starts_with("Noise") || matches!(word, "psh" | "csd") {
                return Err(Error::new(token.span, WITHOUT_COUNTERPART));
            }
            token.kind = match token.kind {
                Percent => Remainder,
                Ampersand => And,
                Bar => Or,
                kind => kind,
            };
        }
        Ok(tokens)
    }

    /// The box of each surface, as ranges of x, y and z.
    fn boxes(&self) -> Fallible<Vec<Vec<PlotRange>>> {
        let mut boxes = Vec::new();
        for index in 0..self.values("Fxyz").len() {
            let mut ranges = Vec::new();
            for axis in ['X', 'Y', 'Z'] {
                let end = |end: &str| self.values(&format!("{axis}{end}")).get(index).cloned();
                if let (Some(low), Some(high)) = (end("min"), end("max")) {
                    let (low, high) = (self.formula(low)?, self.formula(high)?);
                    ranges.push(PlotRange { name: None, low, high });
                }
            }
            if ranges.len() == 3 {
                boxes.push(ranges);
            }
        }
        Ok(boxes)
    }
}

/// The keys of the first object behind `start`, each with the places of its strings. Strings of
/// inner objects count, too.
fn members(text: &str, start: usize) -> Vec<Member<'_>> {
    let mut all: Vec<Member<'_>> = Vec::new();
    let mut depth = 0_usize;
    let mut rest = start;
    while let Some(found) = text[rest..].find(['{', '}', '[', ']', '"']) {
        let place = rest + found;
        rest = place + 1;
        match text.as_bytes()[place] {
            b'{' | b'[' => depth += 1,
            b'"' => {
                let Some(length) = string_length(&text[rest..]) else { break };
                let string = rest..rest + length;
                rest = string.end + 1;
                let is_key = depth == 1 && text[rest..].trim_start().starts_with(':');
                if is_key {
                    all.push((&text[string], Vec::new()));
                } else if let Some((_, values)) = all.last_mut() {
                    values.push(string);
                }
            }
            _ => {
                depth = depth.saturating_sub(1);
                if depth == 0 {
                    break;
                }
            }
        }
    }
    all
}

/// Length of the string at the start of `text`, behind its quotation mark.
fn string_length(text: &str) -> Option<usize> {
    let mut is_escaped = false;
    text.bytes().position(|byte| {
        let ends = byte == b'"' && !is_escaped;
        is_escaped = byte == b'\\' && !is_escaped;
        ends
    })
}

/// Returns whether the ends of two boxes have the same text.
pub(crate) fn are_alike(text: &str, one: &[PlotRange], other: &[PlotRange]) -> bool {
    let typed = |tokens: &[Token]| -> String {
        tokens.iter().map(|token| &text[token.span.range()]).collect()
    };
    let ends = |range: &PlotRange| (typed(&range.low), typed(&range.high));
    one.iter().map(ends).eq(other.iter().map(ends))
}
