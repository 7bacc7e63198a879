//! Reads `domain`, `view`, `look` and `background` lines and plain colors. Nothing here decides
//! what a line means for a picture.

use zeroset_parser::tree::grammar::{Pair, Rule};
use zeroset_style::{COLOR_MAPS, LOOKS, Look, StandardView};

use crate::lower::constant::{evaluate, evaluate_range};
use crate::picture::line_reader::{LineReader, bad_setting};
use csscolorparser::NAMED_COLORS;
use zeroset_interval::Interval;
use zeroset_ir::Constant;
use zeroset_parser::tree::ast::Expr;
use zeroset_parser::tree::scope::nearest;
use zeroset_parser::{Error, ErrorKind, Fallible, Limits, Span};

/// A range from a lower to a higher number, in world units.
pub type ConstantRange = (Constant, Constant);

/// Contents of a `domain` line: the region to look at.
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::large_enum_variant)] // a document has one
pub enum DomainLine {
    /// The region is found by search.
    Auto,
    /// A range for each coordinate, in world units; `None` for a coordinate that is left out.
    Box([Option<ConstantRange>; 3]),
    /// The ball about the origin with this radius, in world units.
    Ball(Constant),
}

/// Contents of a `view` line. A field is `None` if the line does not set it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ViewLine {
    /// The standard view whose name the line gives.
    pub preset: Option<&'static StandardView>,
    /// Position of the eye, in world units.
    pub eye: Option<[Constant; 3]>,
    /// The point at which the eye looks, in world units.
    pub target: Option<[Constant; 3]>,
    /// The direction that points up in the picture.
    pub up: Option<[Constant; 3]>,
    /// The vertical field of view, in degrees.
    pub fov: Option<Constant>,
    /// The height of the visible part in an orthographic picture, in world units.
    pub ortho: Option<Constant>,
}

/// A color in the sRGB color space.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SrgbColor {
    /// Red, green and blue, from 0 to 255.
    pub rgb: [u8; 3],
}

/// The background of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Background {
    /// One color everywhere.
    Color(SrgbColor),
    /// None: pixels in which nothing is painted are transparent.
    Transparent,
}

impl Background {
    /// The word for a transparent background.
    const TRANSPARENT: &'static str = "transparent";

    /// The background called `transparent`, or of a color written as for [`SrgbColor::typed`].
    pub fn typed(text: &str) -> Option<Self> {
        if text.eq_ignore_ascii_case(Self::TRANSPARENT) {
            return Some(Self::Transparent);
        }
        SrgbColor::typed(text).map(Self::Color)
    }
}

impl SrgbColor {
    /// The CSS color called `name`, in upper or lower case.
    pub fn named(name: &str) -> Option<Self> {
        let (_, rgb) =
            NAMED_COLORS.entries().find(|(known, _)| known.as_str().eq_ignore_ascii_case(name))?;
        Some(Self { rgb: *rgb })
    }

    /// The color written as `#rgb` or `#rrggbb`, or by its name.
    pub fn typed(text: &str) -> Option<Self> {
        if !text.starts_with('#') {
            return Self::named(text);
        }
        // Four or eight digits would include an opacity, which this color cannot have.
        let color = csscolorparser::parse(text).ok().filter(|_| matches!(text.len(), 4 | 7))?;
        let [r, g, b, _] = color.to_rgba8();
        Some(Self { rgb: [r, g, b] })
    }
}

impl LineReader<'_> {
    pub(crate) fn domain(&mut self, line: Pair<'_>) -> Fallible<DomainLine> {
        let mut axes = [const { None }; 3];
        let mut numbers = Vec::new();
        for part in line.into_inner() {
            let span = self.builder.span(&part);
            match part.as_rule() {
                Rule::automatic => return Ok(DomainLine::Auto),
                Rule::bounds => {
                    let (low, high) = self.builder.bounds(part)?;
                    let bounds = evaluate_range(&low, &high, span, self.builder.limits)?;
                    return Ok(DomainLine::Box([0; 3].map(|_| Some(bounds.clone()))));
                }
                Rule::axis_range => {
                    let axis = part.as_str().chars().next().unwrap_or('x');
                    let bounds = part.into_inner().last().expect("an axis has bounds");
                    let place = self.builder.span(&bounds);
                    let (low, high) = self.builder.bounds(bounds)?;
                    let bounds = evaluate_range(&low, &high, place, self.builder.limits)?;
                    if axes[axis as usize - 'x' as usize].replace(bounds).is_some() {
                        return Err(Error::new(span, ErrorKind::RepeatedAxis { axis }));
                    }
                }
                Rule::ball => return self.ball(part).map(DomainLine::Ball),
                Rule::expression => numbers.push(self.builder.value(part)?),
                _ => {}
            }
        }
        if let (Some(first), Some(last)) = (numbers.first(), numbers.last()) {
            axes = plain_domain(&numbers, first.span.to(last.span), self.builder.limits)?;
        }
        Ok(DomainLine::Box(axes))
    }

    fn ball(&mut self, pair: Pair<'_>) -> Fallible<Constant> {
        let span = self.builder.span(&pair);
        let mut parts = pair.into_inner();
        let word = parts.next().expect("a ball has a name");
        if self.builder.word(&word) != "ball" {
            return Err(Error::new(span, ErrorKind::BadDomain));
        }
        let radius = self.builder.sum(parts.next().expect("a ball has a radius"))?;
        let radius = evaluate(&radius, self.builder.limits)?;
        if radius.bounds().lo <= 0.0 {
            return Err(Error::new(span, ErrorKind::EmptyDomain));
        }
        Ok(radius)
    }

    pub(crate) fn view(&mut self, line: Pair<'_>) -> Fallible<ViewLine> {
        let mut view = ViewLine::default();
        for part in line.into_inner() {
            match part.as_rule() {
                Rule::preset => {
                    view.preset = StandardView::named(&self.builder.word(&part));
                }
                Rule::setting => self.setting(part, &mut view)?,
                _ => {}
            }
        }
        Ok(view)
    }

    fn setting(&mut self, pair: Pair<'_>, view: &mut ViewLine) -> Fallible<()> {
        let span = self.builder.span(&pair);
        let mut inner = pair.into_inner();
        let key = inner.next().expect("a setting has a key");
        let name = self.builder.word(&key);
        if key.as_rule() == Rule::number_key {
            let mut number = self.builder.term(&mut inner)?;
            number.span = span;
            let value = Some(evaluate(&number, self.builder.limits)?);
            match name.as_str() {
                "fov" => view.fov = value,
                _ => view.ortho = value,
            }
            return Ok(());
        }
        let numbers =
            inner.map(|number| evaluate(&self.builder.value(number)?, self.builder.limits));
        let Ok(vector) = <[Constant; 3]>::try_from(numbers.collect::<Fallible<Vec<_>>>()?) else {
            return Err(Error::new(span, ErrorKind::BadVector { key: name }));
        };
        match name.as_str() {
            "eye" => view.eye = Some(vector),
            "target" => view.target = Some(vector),
            _ => view.up = Some(vector),
        }
        Ok(())
    }

    pub(crate) fn look(&self, line: Pair<'_>) -> Fallible<&'static Look> {
        let given = line.into_inner().next().expect("a look line has a name");
        self.row_named(&given, &LOOKS, |look| look.name, ErrorKind::BadLook)
    }

    /// The row called `given`, in upper or lower case. Fails with `kind` if there is no such row.
    pub(crate) fn row_named<T>(
        &self,
        given: &Pair<'_>,
        rows: &'static [T],
        name: fn(&T) -> &'static str,
        kind: ErrorKind,
    ) -> Fallible<&'static T> {
        let (span, typed) = (self.builder.span(given), self.builder.word(given));
        let found = rows.iter().find(|row| name(row).eq_ignore_ascii_case(&typed));
        found.ok_or_else(|| {
            Error::new(span, kind).suggest_optional(span, nearest(&typed, rows.iter().map(name)))
        })
    }

    pub(crate) fn background(&self, line: Pair<'_>) -> Fallible<Background> {
        let given = line.into_inner().next().expect("a background line has a color");
        let (span, typed) = (self.builder.span(&given), self.builder.word(&given));
        Background::typed(&typed).ok_or_else(|| {
            let colors = NAMED_COLORS.keys().map(|known| known.as_str());
            let meant = nearest(&typed, colors.chain([Background::TRANSPARENT]));
            bad_setting("background", span).suggest_optional(span, meant)
        })
    }

    /// Reads a color that is the same everywhere.
    pub(crate) fn plain(&self, given: &Pair<'_>) -> Fallible<SrgbColor> {
        let (span, typed) = (self.builder.span(given), self.builder.word(given));
        SrgbColor::typed(&typed).ok_or_else(|| {
            if let Some(map) = COLOR_MAPS.iter().find(|map| map.name.eq_ignore_ascii_case(&typed)) {
                return bad_setting("color", span).suggest(span, format!("{}(z)", map.name));
            }
            let meant = nearest(&typed, NAMED_COLORS.keys().map(|known| known.as_str()));
            Error::new(span, ErrorKind::BadColor).suggest_optional(span, meant)
        })
    }
}

/// The ranges of a `domain` line with one number, as in `domain 3`, or with six numbers.
fn plain_domain(
    numbers: &[Expr],
    span: Span,
    limits: &Limits,
) -> Fallible<[Option<ConstantRange>; 3]> {
    let range = |low: &Expr, high: &Expr| evaluate_range(low, high, span, limits).map(Some);
    match numbers {
        [half] => {
            let half = evaluate(half, limits)?;
            if half.bounds().lo <= 0.0 {
                return Err(Error::new(span, ErrorKind::EmptyDomain));
            }
            let Interval { lo, hi } = half.bounds();
            let enclosed = || Constant::enclosed(Interval { lo: -hi, hi: -lo });
            let opposite = half.exact().map_or_else(enclosed, |value| Constant::rational(-value));
            Ok([0; 3].map(|_| Some((opposite.clone(), half.clone()))))
        }
        [x0, x1, y0, y1, z0, z1] => Ok([range(x0, x1)?, range(y0, y1)?, range(z0, z1)?]),
        _ => Err(Error::new(span, ErrorKind::BadDomain)),
    }
}
