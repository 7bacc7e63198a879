//! Reads colors of surfaces, and contour lines. Both may depend on a value at each point.
//!
//! Nothing here computes these values.

use zeroset_parser::tree::grammar::{Pair, Rule, parts};
use zeroset_style::{COLOR_MAPS, ColorMap, OPACITY};

use crate::lower::constant::{evaluate, evaluate_range};
use crate::lower::lowering::{Lowering, NameBinding};
use crate::lower::value::Tensor;
use crate::picture::line_reader::{LineReader, bad_setting};
use crate::picture::scene::SrgbColor;
use rustc_hash::FxHashMap;
use zeroset_ir::{Constant, Graph, NodeId};
use zeroset_parser::tree::ast::{Expr, NamedValue};
use zeroset_parser::tree::scope::{NameMeaning, Scope};
use zeroset_parser::{ErrorKind, Fallible, Limits, Span};

/// Names for values at a point of a surface, besides x, y and z: the unit normal and the distance
/// from the eye. In a [`PointValue`] they are parameters, numbered after the document's parameters.
/// Then come the two parameters of a parametric surface, whose names are free.
pub const POINT_NAMES: [&str; 4] = ["nx", "ny", "nz", "depth"];

/// Contour lines on a surface. A value is constant along each line.
#[derive(Clone, Debug)]
pub struct Contours<V = PointValue> {
    /// The value that is constant along a line. With `None`, it is the value that selects the
    /// surface's color or, without such a value, z.
    pub value: Option<V>,
    /// Difference in value between neighboring lines; `None` for a round number chosen by the
    /// program.
    pub step: Option<Constant>,
}

/// The color of a surface.
#[derive(Clone, Debug)]
#[allow(clippy::large_enum_variant)] // a document has few
pub enum SurfaceColor<V = PointValue> {
    /// One color everywhere.
    Plain(SrgbColor),
    /// A color that depends on a value at each point.
    Mapped(MappedColor<V>),
}

/// A color map, and the value that selects a color from the map.
#[derive(Clone, Debug)]
pub struct MappedColor<V = PointValue> {
    /// The color map, a row of the table of color maps.
    pub map: &'static ColorMap,
    /// The value that selects the color at a point.
    pub value: V,
    /// Values for the first and the last color of the map; `None` for the least and the greatest
    /// visible value.
    pub range: Option<[Constant; 2]>,
}

/// A number at each point of a surface.
#[derive(Clone, Debug)]
pub struct PointValue {
    /// Graph of the value. Its parameters are the document's parameters, then [`POINT_NAMES`], then
    /// the two of a parametric surface.
    pub graph: Graph,
    /// Node of the value in `graph`.
    pub root: NodeId,
    /// The value's expression as it was read.
    pub echo: String,
}

/// A color before its expressions are lowered; `None` for the surface's default color.
pub(crate) type ParsedColor = Option<SurfaceColor<Expr>>;

/// A copy of `scope`, to which [`POINT_NAMES`] are added unless they have a meaning already.
pub(crate) fn with_point_names(scope: &Scope) -> Scope {
    let mut scope = scope.clone();
    for name in POINT_NAMES {
        if matches!(scope.meaning(name, &[]), NameMeaning::Unknown | NameMeaning::Product) {
            scope.define(name, None);
        }
    }
    scope
}

/// Lowers values at points of a surface to graphs.
pub(crate) struct PointValues<'a> {
    names: FxHashMap<&'a str, NameBinding<'a>>,
    /// Number of the first of [`POINT_NAMES`].
    first: u32,
    time: Option<u32>,
    limits: &'a Limits,
    /// The names of the parameters of each parametric surface.
    pub patches: Vec<[&'a str; 2]>,
}

impl<'a> PointValues<'a> {
    /// Creates the lowering. [`POINT_NAMES`] become parameters, numbered from `first`.
    pub fn new(
        mut names: FxHashMap<&'a str, NameBinding<'a>>,
        first: u32,
        time: Option<u32>,
        limits: &'a Limits,
    ) -> Self {
        for (number, name) in (first..).zip(POINT_NAMES) {
            names.entry(name).or_insert(NameBinding::Parameter(number));
        }
        Self { names, first, time, limits, patches: Vec::new() }
    }

    /// Lowers the expression of a value to a separate graph. Names of parameters mean those of the
    /// parametric surface with the number `patch`.
    pub fn value(&self, expr: &'a Expr, patch: Option<usize>) -> Fallible<PointValue> {
        let mut lowering = Lowering::new(self.names.clone(), self.time, self.limits);
        let root = lowering.complete(|all| {
            let locals = self.parameters(all, patch, expr.span)?;
            all.number(expr, &locals)
        })?;
        let root = lowering.in_place(root, expr.span)?;
        Ok(PointValue { graph: lowering.graph, root, echo: expr.to_string() })
    }

    /// The meanings of names of parameters. Where a surface has no such parameter, the name means
    /// what it means in the text, or else the parameter of the first surface that has it.
    fn parameters(
        &self,
        lowering: &mut Lowering<'a>,
        patch: Option<usize>,
        span: Span,
    ) -> Fallible<Vec<(&'a str, Tensor)>> {
        let own = patch.map(|patch| &self.patches[patch]);
        let mut all = Vec::new();
        // The last of equal names counts.
        for names in self.patches.iter().rev().chain(own) {
            for (number, name) in (self.first + POINT_NAMES.len() as u32..).zip(names) {
                let is_own = own.is_some_and(|own| own.contains(name));
                let typed = match *name {
                    "t" => Some(NamedValue::Time),
                    name if self.names.contains_key(name) => Some(NamedValue::Defined(name.into())),
                    _ => None,
                };
                let value = match typed.filter(|_| !is_own) {
                    Some(typed) => lowering.named(&typed, span, &[])?,
                    None => Tensor::Number(lowering.graph.parameter(number)),
                };
                all.push((*name, value));
            }
        }
        Ok(all)
    }

    /// Lowers a surface's color, which may hold an expression: see [`PointValues::value`].
    pub fn color(
        &self,
        typed: &'a SurfaceColor<Expr>,
        patch: Option<usize>,
    ) -> Fallible<SurfaceColor> {
        Ok(match typed {
            SurfaceColor::Plain(color) => SurfaceColor::Plain(*color),
            SurfaceColor::Mapped(MappedColor { map, value, range }) => {
                let (value, range) = (self.value(value, patch)?, range.clone());
                SurfaceColor::Mapped(MappedColor { map, value, range })
            }
        })
    }
}

impl LineReader<'_> {
    /// Reads a `color` line. Returns the color, and the opacity with its place if there is one.
    pub(crate) fn color_line(
        &mut self,
        line: Pair<'_>,
    ) -> Fallible<(ParsedColor, Option<(f64, Span)>)> {
        let (mut color, mut opacity) = (None, None);
        for part in line.into_inner() {
            match part.as_rule() {
                Rule::opacity => {
                    let place = self.builder.span(&part);
                    opacity = Some((self.number(&part, &OPACITY)?, place));
                }
                Rule::automatic => color = Some(None),
                Rule::mapped => color = Some(Some(SurfaceColor::Mapped(self.mapped(part)?))),
                Rule::hex | Rule::name => {
                    color = Some(Some(SurfaceColor::Plain(self.plain(&part)?)));
                }
                _ => {}
            }
        }
        let color = color.ok_or_else(|| bad_setting("color", self.builder.lexed.span))?;
        Ok((color, opacity))
    }

    /// Reads a color by a value, such as `viridis(z)` or `viridis(z, -1, 1)`.
    fn mapped(&mut self, pair: Pair<'_>) -> Fallible<MappedColor<Expr>> {
        let span = self.builder.span(&pair);
        let mut parts = pair.into_inner();
        let name = parts.next().expect("a color map has a name");
        let map = self.row_named(&name, &COLOR_MAPS, |map| map.name, ErrorKind::BadColorMap)?;
        let mut arguments = self.values("color", parts)?;
        let range = match &arguments[..] {
            [_] => None,
            [_, low, high] => {
                let span = low.span.to(high.span);
                Some(evaluate_range(low, high, span, self.builder.limits)?.into())
            }
            _ => return Err(bad_setting("color", span)),
        };
        Ok(MappedColor { map, value: arguments.swap_remove(0), range })
    }

    pub(crate) fn contours(&mut self, line: Pair<'_>) -> Fallible<Contours<Expr>> {
        let all = parts(line);
        if let [amount] = &all[..]
            && amount.as_rule() == Rule::opacity
        {
            let span = self.builder.span(amount);
            let [number] = &parts(amount.clone())[..] else {
                return Err(bad_setting("contours", span));
            };
            let number = self.builder.term(&mut number.clone().into_inner())?;
            return Ok(Contours { value: None, step: Some(step(self.builder.limits, &number)?) });
        }
        let values = self.values("contours", all)?;
        let step = match &values[..] {
            [one] if evaluate(one, self.builder.limits).is_ok() => {
                return Ok(Contours { value: None, step: Some(step(self.builder.limits, one)?) });
            }
            [] | [_] => None,
            [_, other] => Some(step(self.builder.limits, other)?),
            _ => return Err(bad_setting("contours", self.builder.lexed.span)),
        };
        Ok(Contours { value: values.into_iter().next(), step })
    }
}

/// Evaluates the step between contour lines. Fails unless the step is positive.
fn step(limits: &Limits, expr: &Expr) -> Fallible<Constant> {
    let step = evaluate(expr, limits)?;
    if step.bounds().lo > 0.0 { Ok(step) } else { Err(bad_setting("contours", expr.span)) }
}
