//! `domain`, `view` and `color` lines, as plain data: what they mean for a picture is not decided here.

use crate::build::Builder;
use crate::constant;
use crate::error::{Error, ErrorKind, Fallible};
use crate::grammar::{Pair, Rule};
use crate::limits::Limits;
use crate::scope::{Scope, nearest};
use crate::span::Span;
use crate::statement::{Line, LineKind};
use zeroset_ir::{Axis, Constant};

/// Where to look for the surface.
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::large_enum_variant)] // a document has one
pub enum Domain {
    /// To be found by search.
    Auto,
    /// A range for each coordinate, in world units; `None` where the line leaves one out.
    Box([Option<(Constant, Constant)>; 3]),
}

/// Where to look from.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct View {
    /// The name of a direction, one of those that the grammar lists.
    pub preset: Option<String>,
    /// The eye, in world units.
    pub eye: Option<[Constant; 3]>,
    /// The point looked at, in world units.
    pub target: Option<[Constant; 3]>,
    /// What points up in the picture.
    pub up: Option<[Constant; 3]>,
    /// The vertical field of view, in degrees.
    pub fov: Option<Constant>,
    /// The height of an orthographic picture, in world units.
    pub ortho: Option<Constant>,
}

/// A color, as sRGB.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Color {
    /// Red, green, blue.
    pub rgb: [u8; 3],
}

impl Color {
    /// The color with this name, in any case: one of those that a `color` line takes.
    pub fn named(name: &str) -> Option<Self> {
        let found = COLORS.iter().find(|(known, _)| known.eq_ignore_ascii_case(name))?;
        Some(Self { rgb: found.1 })
    }
}

/// The colors that have names; values as in CSS Color Module Level 4, section 6.1.
const COLORS: &[(&str, [u8; 3])] = &[
    ("black", [0, 0, 0]),
    ("blue", [0, 0, 255]),
    ("brown", [165, 42, 42]),
    ("coral", [255, 127, 80]),
    ("cyan", [0, 255, 255]),
    ("gold", [255, 215, 0]),
    ("gray", [128, 128, 128]),
    ("green", [0, 128, 0]),
    ("grey", [128, 128, 128]),
    ("indigo", [75, 0, 130]),
    ("ivory", [255, 255, 240]),
    ("lime", [0, 255, 0]),
    ("magenta", [255, 0, 255]),
    ("maroon", [128, 0, 0]),
    ("navy", [0, 0, 128]),
    ("olive", [128, 128, 0]),
    ("orange", [255, 165, 0]),
    ("orchid", [218, 112, 214]),
    ("pink", [255, 192, 203]),
    ("plum", [221, 160, 221]),
    ("purple", [128, 0, 128]),
    ("red", [255, 0, 0]),
    ("salmon", [250, 128, 114]),
    ("silver", [192, 192, 192]),
    ("skyblue", [135, 206, 235]),
    ("tan", [210, 180, 140]),
    ("teal", [0, 128, 128]),
    ("turquoise", [64, 224, 208]),
    ("violet", [238, 130, 238]),
    ("white", [255, 255, 255]),
    ("yellow", [255, 255, 0]),
];

/// What one line says.
#[allow(clippy::large_enum_variant)] // taken apart at once
pub(crate) enum Scene {
    Domain(Domain),
    View(View),
    /// A color, and where its line stands.
    Color(usize, Color),
}

/// Reads a `domain`, `view` or `color` line.
pub(crate) fn scene_line(
    text: &str,
    line: Line<'_>,
    scope: &Scope,
    limits: &Limits,
) -> Fallible<Scene> {
    let start = line.span.start;
    let mut reader = Reader { builder: Builder::new(text, start, scope, &[], limits), limits };
    match line.kind {
        LineKind::Domain => reader.domain(line.pair, line.span).map(Scene::Domain),
        LineKind::View => reader.view(line.pair).map(Scene::View),
        LineKind::Color | LineKind::Formula => {
            reader.color(line.pair).map(|color| Scene::Color(start, color))
        }
    }
}

struct Reader<'a> {
    builder: Builder<'a>,
    limits: &'a Limits,
}

impl Reader<'_> {
    fn number(&mut self, pair: Pair<'_>) -> Fallible<Constant> {
        let expr = self.builder.value(pair)?;
        constant::evaluate(&expr, self.limits)
    }

    fn bounds(&mut self, pair: Pair<'_>) -> Fallible<(Constant, Constant)> {
        let span = self.builder.span(&pair);
        let mut ends = Vec::new();
        for end in pair.into_inner() {
            ends.push(self.number(end)?);
        }
        let [low, high] = <[Constant; 2]>::try_from(ends).expect("bounds hold two expressions");
        ordered(low, high, span)
    }

    fn domain(&mut self, pair: Pair<'_>, span: Span) -> Fallible<Domain> {
        let mut axes: [Option<(Constant, Constant)>; 3] = [None, None, None];
        for child in pair.into_inner() {
            let place = self.builder.span(&child);
            match child.as_rule() {
                Rule::automatic => return Ok(Domain::Auto),
                Rule::axis_range => {
                    let mut inner = child.into_inner();
                    let name = inner.next().map_or("x", |axis| axis.as_str());
                    let axis = match name {
                        "x" => Axis::X,
                        "y" => Axis::Y,
                        _ => Axis::Z,
                    };
                    let bounds =
                        inner.find(|p| p.as_rule() == Rule::bounds).expect("an axis has bounds");
                    let bounds = self.bounds(bounds)?;
                    if axes[axis as usize].replace(bounds).is_some() {
                        let axis = name.chars().next().unwrap_or('x');
                        return Err(Error::new(place, ErrorKind::RepeatedAxis { axis }));
                    }
                }
                Rule::bounds => {
                    let bounds = self.bounds(child)?;
                    return Ok(Domain::Box([0; 3].map(|_| Some(bounds.clone()))));
                }
                Rule::arguments => return self.plain_domain(child, place),
                _ => {}
            }
        }
        if axes.iter().all(Option::is_none) {
            return Err(Error::new(span, ErrorKind::BadDomain));
        }
        Ok(Domain::Box(axes))
    }

    /// `domain 3` or six numbers.
    fn plain_domain(&mut self, pair: Pair<'_>, span: Span) -> Fallible<Domain> {
        let mut numbers = Vec::new();
        for argument in pair.into_inner() {
            numbers.push(self.number(argument)?);
        }
        match numbers.as_slice() {
            [half] => {
                let low = half.exact().map_or_else(
                    || {
                        let bounds = half.bounds();
                        let low = zeroset_interval::Interval::new(-bounds.hi, -bounds.lo);
                        low.map_or_else(|| half.clone(), Constant::enclosed)
                    },
                    |value| Constant::rational(-value),
                );
                if half.bounds().lo <= 0.0 {
                    return Err(Error::new(span, ErrorKind::EmptyDomain));
                }
                let bounds = ordered(low, half.clone(), span)?;
                Ok(Domain::Box([0; 3].map(|_| Some(bounds.clone()))))
            }
            [x0, x1, y0, y1, z0, z1] => {
                let axis = |low: &Constant, high: &Constant| {
                    ordered(low.clone(), high.clone(), span).map(Some)
                };
                Ok(Domain::Box([axis(x0, x1)?, axis(y0, y1)?, axis(z0, z1)?]))
            }
            _ => Err(Error::new(span, ErrorKind::BadDomain)),
        }
    }

    fn view(&mut self, pair: Pair<'_>) -> Fallible<View> {
        let mut view = View::default();
        for child in pair.into_inner() {
            match child.as_rule() {
                Rule::preset => view.preset = Some(child.as_str().to_owned()),
                Rule::setting => self.setting(child, &mut view)?,
                _ => {}
            }
        }
        Ok(view)
    }

    fn setting(&mut self, pair: Pair<'_>, view: &mut View) -> Fallible<()> {
        let span = self.builder.span(&pair);
        let mut inner = pair.into_inner();
        let key = inner.next().map_or("", |key| key.as_str());
        let given = inner.next().expect("a setting has a value");
        if given.as_rule() == Rule::signed_number {
            let text = given.as_str().replace('−', "-");
            let value = constant::evaluate_text(&text, self.limits)
                .map_err(|error| Error::new(span, error.kind))?;
            match key {
                "fov" => view.fov = Some(value),
                _ => view.ortho = Some(value),
            }
            return Ok(());
        }
        let mut numbers = Vec::new();
        for argument in given.into_inner() {
            numbers.push(self.number(argument)?);
        }
        let Ok(vector) = <[Constant; 3]>::try_from(numbers) else {
            let key = key.to_owned();
            return Err(Error::new(span, ErrorKind::BadVector { key }));
        };
        match key {
            "eye" => view.eye = Some(vector),
            "target" => view.target = Some(vector),
            _ => view.up = Some(vector),
        }
        Ok(())
    }

    fn color(&mut self, pair: Pair<'_>) -> Fallible<Color> {
        let given = pair.into_inner().next().expect("a color line has a color");
        let span = self.builder.span(&given);
        let text = given.as_str();
        if let Some(digits) = text.strip_prefix('#') {
            return hexadecimal(digits).ok_or_else(|| Error::new(span, ErrorKind::BadColor));
        }
        let name = text.to_ascii_lowercase();
        if let Some((_, rgb)) = COLORS.iter().find(|(known, _)| *known == name) {
            return Ok(Color { rgb: *rgb });
        }
        let error = Error::new(span, ErrorKind::BadColor);
        Err(match nearest(&name, COLORS.iter().map(|(known, _)| *known)) {
            Some(meant) => error.suggest(span, meant),
            None => error,
        })
    }
}

/// `rgb` or `rrggbb`.
fn hexadecimal(digits: &str) -> Option<Color> {
    let value = u32::from_str_radix(digits, 16).ok()?;
    let rgb = match digits.len() {
        3 => [value >> 8, value >> 4, value].map(|digit| (digit & 15) as u8 * 17),
        6 => [value >> 16, value >> 8, value].map(|byte| (byte & 255) as u8),
        _ => return None,
    };
    Some(Color { rgb })
}

fn ordered(low: Constant, high: Constant, span: Span) -> Fallible<(Constant, Constant)> {
    if low.bounds().lo >= high.bounds().hi {
        return Err(Error::new(span, ErrorKind::EmptyRange));
    }
    Ok((low, high))
}
