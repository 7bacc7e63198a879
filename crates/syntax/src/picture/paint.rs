//! Colors of surfaces and lines on them: everywhere the same, or by a value at each point.
//!
//! What a value is at a point is not computed here.

use crate::tree::grammar::{Pair, Rule, parts};
use zeroset_style::{COLOR_MAPS, ColorMap};

use crate::limits::Limits;
use crate::lower::constant::{evaluate, evaluate_range};
use crate::lower::lowering::{Lowering, NameBinding};
use crate::messages::error::{ErrorKind, Fallible};
use crate::picture::scene::{SrgbColor, bad};
use crate::span::Span;
use crate::tree::ast::Expr;
use crate::tree::builder::Builder;
use crate::tree::scope::{NameMeaning, Scope};
use rustc_hash::FxHashMap;
use zeroset_ir::{Constant, Graph, NodeId};

/// Names that a value at each point of a surface may depend on beside x, y and z: the unit normal,
/// and the distance from the eye. Their numbers as parameters follow those of the document.
pub const POINT_NAMES: [&str; 4] = ["nx", "ny", "nz", "depth"];

/// Lines on a surface along which a value stays the same.
#[derive(Clone, Debug)]
pub struct Contours<V = PointValue> {
    /// The value; `None` for that of the surface's color, else z.
    pub value: Option<V>,
    /// How far the values of two lines are apart; `None` for a round number.
    pub step: Option<Constant>,
}

/// The color of a surface.
#[derive(Clone, Debug)]
#[allow(clippy::large_enum_variant)] // a document has few
pub enum SurfaceColor<V = PointValue> {
    /// Everywhere the same.
    Plain(SrgbColor),
    /// By a value.
    Mapped(MappedColor<V>),
}

/// Which value has which color.
#[derive(Clone, Debug)]
pub struct MappedColor<V = PointValue> {
    /// The row of the color map.
    pub map: &'static ColorMap,
    /// The value.
    pub value: V,
    /// The values that have the first and the last color; `None` for the least and the greatest
    /// that are seen.
    pub range: Option<[Constant; 2]>,
}

/// A number at each point of a surface.
#[derive(Clone, Debug)]
pub struct PointValue {
    /// A graph of its own. Its parameters are those of the document, and then [`POINT_NAMES`].
    pub graph: Graph,
    /// What is to be computed.
    pub root: NodeId,
    /// How it was read.
    pub echo: String,
}

/// A color before names have values; `None` is the one that a surface has of itself.
pub(crate) type TypedColor = Option<SurfaceColor<Expr>>;

/// The same names, and those of a point's own.
pub(crate) fn with_point_names(scope: &Scope) -> Scope {
    let mut scope = scope.clone();
    for name in POINT_NAMES {
        if matches!(scope.meaning(name, &[]), NameMeaning::Unknown | NameMeaning::Product) {
            scope.define(name, None);
        }
    }
    scope
}

/// Brings values of points to graphs.
pub(crate) struct PointValues<'a> {
    pub names: FxHashMap<&'a str, NameBinding<'a>>,
    pub time: Option<u32>,
    pub limits: &'a Limits,
}

impl<'a> PointValues<'a> {
    /// With the point's own names as parameters from `first` on.
    pub fn new(
        mut names: FxHashMap<&'a str, NameBinding<'a>>,
        first: u32,
        time: Option<u32>,
        limits: &'a Limits,
    ) -> Self {
        for (number, name) in (first..).zip(POINT_NAMES) {
            names.entry(name).or_insert(NameBinding::Parameter(number));
        }
        Self { names, time, limits }
    }

    /// The graph of one value.
    pub fn value(&self, expr: &'a Expr) -> Fallible<PointValue> {
        let mut lowering = Lowering::new(self.names.clone(), self.time, self.limits);
        let root = lowering.value(expr)?;
        Ok(PointValue { graph: lowering.graph, root, echo: expr.to_string() })
    }

    /// A surface's color.
    pub fn color(&self, typed: &'a SurfaceColor<Expr>) -> Fallible<SurfaceColor> {
        Ok(match typed {
            SurfaceColor::Plain(color) => SurfaceColor::Plain(*color),
            SurfaceColor::Mapped(MappedColor { map, value, range }) => {
                let (value, range) = (self.value(value)?, range.clone());
                SurfaceColor::Mapped(MappedColor { map, value, range })
            }
        })
    }
}

impl Builder<'_> {
    /// A color, perhaps with an opacity, and where that stands.
    pub(crate) fn color_line(
        &mut self,
        line: Pair<'_>,
    ) -> Fallible<(TypedColor, Option<(f64, Span)>)> {
        let (mut color, mut opacity) = (None, None);
        for part in line.into_inner() {
            match part.as_rule() {
                Rule::opacity => {
                    let place = self.span(&part);
                    opacity = Some((self.opacity(part)?, place));
                }
                Rule::automatic => color = Some(None),
                Rule::mapped => color = Some(Some(SurfaceColor::Mapped(self.mapped(part)?))),
                Rule::hex | Rule::name => {
                    color = Some(Some(SurfaceColor::Plain(self.plain(&part)?)));
                }
                _ => {}
            }
        }
        let color = color.ok_or_else(|| bad("color", self.lexed.span))?;
        Ok((color, opacity))
    }

    /// `viridis(z)` or `viridis(z, -1, 1)`.
    fn mapped(&mut self, pair: Pair<'_>) -> Fallible<MappedColor<Expr>> {
        let span = self.span(&pair);
        let mut parts = pair.into_inner();
        let name = parts.next().expect("a color map has a name");
        let map = self.one_of(&name, &COLOR_MAPS, |map| map.name, ErrorKind::BadColorMap)?;
        let mut arguments = self.values("color", parts)?;
        let range = match &arguments[..] {
            [_] => None,
            [_, low, high] => {
                let span = low.span.to(high.span);
                Some(evaluate_range(low, high, span, self.limits)?.into())
            }
            _ => return Err(bad("color", span)),
        };
        Ok(MappedColor { map, value: arguments.swap_remove(0), range })
    }

    pub(crate) fn contours(&mut self, line: Pair<'_>) -> Fallible<Contours<Expr>> {
        let all = parts(line);
        if let [amount] = &all[..]
            && amount.as_rule() == Rule::opacity
        {
            let span = self.span(amount);
            let [number] = &parts(amount.clone())[..] else { return Err(bad("contours", span)) };
            let number = self.term(&mut number.clone().into_inner())?;
            return Ok(Contours { value: None, step: Some(step(self.limits, &number)?) });
        }
        let values = self.values("contours", all)?;
        let step = match &values[..] {
            [one] if evaluate(one, self.limits).is_ok() => {
                return Ok(Contours { value: None, step: Some(step(self.limits, one)?) });
            }
            [] | [_] => None,
            [_, other] => Some(step(self.limits, other)?),
            _ => return Err(bad("contours", self.lexed.span)),
        };
        Ok(Contours { value: values.into_iter().next(), step })
    }
}

/// How far the values of two contour lines are apart.
fn step(limits: &Limits, expr: &Expr) -> Fallible<Constant> {
    let step = evaluate(expr, limits)?;
    if step.bounds().lo > 0.0 { Ok(step) } else { Err(bad("contours", expr.span)) }
}
