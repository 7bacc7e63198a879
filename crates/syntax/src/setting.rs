//! Lines that set something about the picture: the table of them, and those that are a word with numbers behind it.
//!
//! What they mean for a picture is not decided here.

use crate::ast::Expr;
use crate::build::Builder;
use crate::constant::evaluate;
use crate::error::{Error, ErrorKind, Fallible};
use crate::grammar::{Pair, Rule};
use crate::limits::Limits;
use crate::paint::{Contours, TypedColor, with_point_names};
use crate::scene::{DomainLine, SrgbColor, ViewLine};
use crate::scope::{Scope, nearest};
use crate::span::Span;
use crate::statement::Line;
use rustc_hash::FxHashSet;
use zeroset_ir::Constant;

/// A word that begins a line about the picture.
pub(crate) struct Setting {
    pub word: &'static str,
    /// What the grammar knows it by.
    pub symbol: char,
    /// What such a line is.
    pub rule: Rule,
    /// Whether a value at each point of a surface may stand in it.
    is_of_points: bool,
    /// What to write.
    pub hint: &'static str,
    read: for<'b> fn(&mut Builder<'b>, Pair<'_>, Span) -> Fallible<SceneSetting>,
}

/// Every such word.
pub(crate) const SETTINGS: [Setting; 14] = {
    const PLAIN: Setting = Setting {
        word: "",
        symbol: 's',
        rule: Rule::setting_line,
        is_of_points: false,
        hint: "",
        read: |_, _, span| Err(Error::new(span, ErrorKind::Empty)),
    };
    const COLOR: Setting = Setting {
        word: "color",
        symbol: 'c',
        rule: Rule::color_line,
        is_of_points: true,
        hint: "write a name of CSS such as `orange`, `#ff8800`, or a color map such as `viridis(z)`; \
               perhaps how opaque it is behind that, as `50%`",
        read: |builder, line, span| builder.color_line(line, span),
    };
    [
        Setting {
            word: "domain",
            symbol: 'd',
            rule: Rule::domain_line,
            hint: "write `domain 3`, `domain ball 3`, `domain auto`, `domain [-2, 2]`, \
                   `domain x in [-2, 2], y in [-1, 1]` or six numbers",
            read: |builder, line, _| builder.domain(line).map(SceneSetting::Domain),
            ..PLAIN
        },
        Setting {
            word: "view",
            symbol: 'v',
            rule: Rule::view_line,
            hint: "write a side such as `view front`, or `view eye (4, 3, 6) target (0, 0, 0) fov 40`",
            read: |builder, line, _| builder.view(line).map(SceneSetting::View),
            ..PLAIN
        },
        COLOR,
        Setting { word: "colour", ..COLOR },
        Setting {
            word: "look",
            symbol: 'l',
            rule: Rule::look_line,
            hint: "there are `studio`, `flat`, `paper` and `night`",
            read: |builder, line, _| builder.look(line).map(SceneSetting::Look),
            ..PLAIN
        },
        Setting {
            word: "background",
            symbol: 'b',
            rule: Rule::background_line,
            hint: "write a name of CSS such as `orange`, or `#ff8800`",
            read: |builder, line, _| builder.color(line).map(SceneSetting::Background),
            ..PLAIN
        },
        Setting {
            word: "clip",
            hint: "write a, b, c and d: `clip 1, 0, 0, 0.5` keeps x <= 0.5",
            read: |builder, line, span| builder.numbers(line, span).map(SceneSetting::Clip),
            ..PLAIN
        },
        Setting {
            word: "light",
            hint: "write where it is: `light 4, -3, 6`",
            read: |builder, line, span| builder.numbers(line, span).map(SceneSetting::Light),
            ..PLAIN
        },
        Setting {
            word: "opacity",
            hint: "write a share from 0 to 1, or from `0%` to `100%`",
            read: |builder, line, span| {
                let share = line.into_inner().find(|part| part.as_rule() == Rule::opacity);
                let share = share.ok_or_else(|| bad("opacity", span))?;
                Ok(SceneSetting::Opacity(span.start, builder.opacity(share)?))
            },
            ..PLAIN
        },
        Setting {
            word: "hidden",
            hint: "write `hidden` above what is not to be seen, and `hidden off` above what is",
            read: |builder, line, span| {
                Ok(SceneSetting::Hidden(span.start, builder.switch(line, span)?))
            },
            ..PLAIN
        },
        Setting {
            word: "shadows",
            hint: "write `shadows on` or `shadows off`",
            read: |builder, line, span| builder.switch(line, span).map(SceneSetting::Shadows),
            ..PLAIN
        },
        Setting {
            word: "axes",
            hint: "write `axes on` or `axes off`",
            read: |builder, line, span| builder.switch(line, span).map(SceneSetting::Axes),
            ..PLAIN
        },
        Setting {
            word: "legend",
            hint: "write `legend on` or `legend off`",
            read: |builder, line, span| builder.switch(line, span).map(SceneSetting::Legend),
            ..PLAIN
        },
        Setting {
            word: "contours",
            is_of_points: true,
            hint: "write what is the same along a line, how far the lines are apart, or both: \
                   `contours z`, `contours 0.5`, `contours z, 0.5`",
            read: |builder, line, span| builder.contours(line, span).map(SceneSetting::Contours),
            ..PLAIN
        },
    ]
};

/// The setting that `word` begins.
pub(crate) fn setting(word: &str) -> Option<&'static Setting> {
    const { &SETTINGS }.iter().find(|setting| setting.word == word)
}

/// What a line about the picture sets that begins with `word`: the word itself, or its first spelling; `None` if there is no
/// such line.
pub fn setting_word(word: &str) -> Option<&'static str> {
    let found = setting(word)?;
    let is_spelling =
        |other: &&Setting| other.rule == found.rule && other.rule != Rule::setting_line;
    Some(const { &SETTINGS }.iter().find(is_spelling).unwrap_or(found).word)
}

/// What one line says.
#[allow(clippy::large_enum_variant)] // taken apart at once
pub(crate) enum SceneSetting {
    Domain(DomainLine),
    View(ViewLine),
    /// A color, and where its line stands; so also below. Perhaps with an opacity, and where that stands.
    Color(usize, TypedColor, Option<(f64, Span)>),
    Opacity(usize, f64),
    Hidden(usize, bool),
    Look(&'static str),
    Background(SrgbColor),
    Clip([Constant; 4]),
    Light([Constant; 3]),
    Shadows(bool),
    Axes(bool),
    Legend(bool),
    Contours((Option<Expr>, Option<Constant>)),
}

/// What a document says of the picture beside where and from where to look. What is `None` is not said.
#[derive(Clone, Debug, Default)]
pub struct PictureLines {
    /// a, b, c and d of the half-space a·x + b·y + c·z ≤ d that is kept.
    pub clip: Option<[Constant; 4]>,
    /// Where the light is, in world units.
    pub light: Option<[Constant; 3]>,
    /// Whether there are shadows.
    pub shadows: Option<bool>,
    /// Whether the domain's box and axes are drawn.
    pub axes: Option<bool>,
    /// Whether it is told which value has which color.
    pub legend: Option<bool>,
    /// Lines along which a value stays the same.
    pub contours: Option<Contours>,
}

/// Where a line stands that sets something about the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SettingLine {
    /// Its first word, in its first spelling.
    pub word: &'static str,
    /// All of it, without its end and without a comment.
    pub span: Span,
    /// The opacity behind a color.
    pub share: Option<Span>,
}

/// What the lines of a text say, before names have values.
#[derive(Default)]
pub(crate) struct Collected {
    pub domain: Option<DomainLine>,
    pub view: Option<ViewLine>,
    pub look: Option<&'static str>,
    pub background: Option<SrgbColor>,
    pub picture: PictureLines,
    /// Each perhaps with an opacity of its own.
    pub colors: Vec<(usize, (TypedColor, Option<f64>))>,
    pub opacities: Vec<(usize, f64)>,
    pub hidden: Vec<(usize, bool)>,
    /// Where they stand.
    pub lines: Vec<SettingLine>,
    pub contours: Option<(Option<Expr>, Option<Constant>)>,
    /// With the names of a point's own, once it was needed.
    scope: Option<Scope>,
    /// Names of the document that values of points depend on.
    pub used: FxHashSet<String>,
}

impl Collected {
    /// Reads one line.
    pub fn read(
        &mut self,
        text: &str,
        line: Line<'_>,
        scope: &Scope,
        limits: &Limits,
    ) -> Fallible<()> {
        let span = line.piece.span;
        let first = line.piece.tokens[0];
        // The ranges of a plot have no word; a `domain` line counts more.
        let is_made = first.span.start == first.span.end;
        let setting = match setting(&text[first.span.range()]) {
            None => const { &SETTINGS }.iter().find(|setting| setting.symbol == first.symbol),
            found => found,
        };
        let setting = setting.ok_or_else(|| Error::new(span, ErrorKind::Empty))?;
        let scope = if setting.is_of_points {
            self.scope.get_or_insert_with(|| with_point_names(scope))
        } else {
            scope
        };
        let mut builder = Builder::new(text, line.piece, scope, &[], limits);
        let said = (setting.read)(&mut builder, line.pair, span)?;
        self.used.extend(builder.used);
        let mut share = None;
        match said {
            SceneSetting::Domain(_) if is_made && self.domain.is_some() => {}
            SceneSetting::Domain(domain) => self.domain = Some(domain),
            SceneSetting::View(view) => self.view = Some(view),
            SceneSetting::Color(at, color, opacity) => {
                share = opacity.map(|(_, span)| span);
                self.colors.push((at, (color, opacity.map(|(opacity, _)| opacity))));
            }
            SceneSetting::Opacity(at, opacity) => self.opacities.push((at, opacity)),
            SceneSetting::Hidden(at, hidden) => self.hidden.push((at, hidden)),
            SceneSetting::Look(look) => self.look = Some(look),
            SceneSetting::Background(color) => self.background = Some(color),
            SceneSetting::Clip(plane) => self.picture.clip = Some(plane),
            SceneSetting::Light(place) => self.picture.light = Some(place),
            SceneSetting::Shadows(on) => self.picture.shadows = Some(on),
            SceneSetting::Axes(on) => self.picture.axes = Some(on),
            SceneSetting::Legend(on) => self.picture.legend = Some(on),
            SceneSetting::Contours(contours) => self.contours = Some(contours),
        }
        let word = setting_word(setting.word).unwrap_or(setting.word);
        self.lines.push(SettingLine { word, span, share });
        Ok(())
    }
}

/// What holds for a drawing at `place`: what the last line above it says; but where no drawing is below the last line (that
/// at `last` is the last drawing), the first line below it.
pub(crate) fn placed<T>(lines: &[(usize, T)], place: usize, last: usize) -> Option<&T> {
    let follow = lines.last().is_some_and(|(at, _)| *at > last);
    let found = if follow {
        lines.iter().find(|(at, _)| *at > place)
    } else {
        lines.iter().rfind(|(at, _)| *at < place)
    };
    found.map(|(_, said)| said)
}

/// What stands behind the word of a line.
pub(crate) fn parts(line: Pair<'_>) -> Vec<Pair<'_>> {
    line.into_inner().filter(|part| part.as_rule() != Rule::EOI).collect()
}

pub(crate) fn bad(word: &'static str, span: Span) -> Box<Error> {
    let hint = setting(word).map_or("", |setting| setting.hint);
    Error::new(span, ErrorKind::BadSetting { word, hint })
}

impl Builder<'_> {
    /// The word that begins the line.
    fn word(&self) -> &'static str {
        let first = self.piece.tokens.first();
        let setting = first.and_then(|token| setting(&self.text[token.span.range()]));
        setting.map_or("", |setting| setting.word)
    }

    /// As many numbers.
    fn numbers<const COUNT: usize>(
        &mut self,
        line: Pair<'_>,
        span: Span,
    ) -> Fallible<[Constant; COUNT]> {
        let word = self.word();
        let mut parts = parts(line);
        if let [point] = &parts[..]
            && point.as_rule() == Rule::point
        {
            parts = point.clone().into_inner().collect();
        }
        let mut numbers = Vec::new();
        for part in parts {
            if !matches!(part.as_rule(), Rule::expression) {
                return Err(bad(word, self.span(&part)));
            }
            let number = self.value(part)?;
            numbers.push(evaluate(&number, self.limits)?);
        }
        <[Constant; COUNT]>::try_from(numbers).map_err(|_| bad(word, span))
    }

    /// Whether something is on: the word alone means that it is.
    fn switch(&mut self, line: Pair<'_>, span: Span) -> Fallible<bool> {
        let (word, parts) = (self.word(), parts(line));
        match &parts[..] {
            [] => Ok(true),
            [part] => {
                let place = self.span(part);
                match &self.text[place.range()] {
                    "on" => Ok(true),
                    "off" => Ok(false),
                    typed => {
                        let meant = nearest(typed, ["on", "off"].into_iter());
                        Err(bad(word, place).suggest_any(place, meant))
                    }
                }
            }
            _ => Err(bad(word, span)),
        }
    }

    /// A share from 0 to 1.
    pub(crate) fn opacity(&mut self, pair: Pair<'_>) -> Fallible<f64> {
        let span = self.span(&pair);
        let mut parts = pair.into_inner();
        let number = self.term(&mut parts.next().expect("an opacity has a number").into_inner());
        let value = evaluate(&number?, self.limits)?.bounds();
        let whole = match parts.next() {
            Some(_) => 100.0,
            None => 1.0,
        };
        let share = value.lo.midpoint(value.hi) / whole;
        if (0.0..=1.0).contains(&share) { Ok(share) } else { Err(bad("opacity", span)) }
    }
}
