//! Reads lines about the picture. The first word of a line selects its row in the table of
//! settings. Names have no values yet, so expressions are stored unevaluated.
//!
//! Nothing here decides what a line means for a picture.

use crate::picture::line_reader::{LineReader, bad_setting};
use crate::picture::paint::{Contours, ParsedColor, with_point_names};
use crate::picture::scene::{Background, DomainLine, ViewLine};
use rustc_hash::FxHashSet;
use zeroset_ir::Constant;
use zeroset_parser::lex::spelling::typed_setting;
use zeroset_parser::lex::token_kind::TokenKind;
use zeroset_parser::settings::{SETTINGS, SettingKind, setting_word};
use zeroset_parser::tree::ast::{Expr, Name};
use zeroset_parser::tree::builder::Builder;
use zeroset_parser::tree::grammar::{Pair, Rule, parts};
use zeroset_parser::tree::scope::Scope;
use zeroset_parser::tree::statement::ParsedStatement;
use zeroset_parser::{Error, ErrorKind, Fallible, Limits, Span};
use zeroset_style::{Choices, MATERIALS, Material, OPACITY, WIDTH};

/// Settings without a field of their own in the document. A setting is `None` if no line sets it.
#[derive(Clone, Debug, Default)]
pub struct PictureLines {
    /// Settings that the command line, the window and Python also have.
    pub choices: Choices,
    /// Coefficients a, b, c and d of the half-space a·x + b·y + c·z ≤ d that is not cut off.
    pub clip: Option<[Constant; 4]>,
    /// Position of the light, in world units.
    pub light: Option<[Constant; 3]>,
    /// True if lengths along all axes are displayed at the same scale, whatever the extents of a
    /// graph.
    pub is_equal: bool,
    /// A line of text at the top of the picture.
    pub title: Option<String>,
    /// Whether to draw lines of equal x, y and z on the surfaces. On a graph z = f(x, y), only
    /// those of equal x and y; on a parametric surface, those of equal parameters.
    pub mesh: Option<bool>,
    /// Contour lines on the surfaces.
    pub contours: Option<Contours>,
}

/// Place of a line about the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SettingLine {
    /// First word of the line, in its main spelling, such as `color` for `colour`.
    pub word: &'static str,
    /// Place of the whole line, without its line break and without a comment.
    pub span: Span,
    /// Place of the opacity after a color, if the line has one.
    pub share: Option<Span>,
}

/// Settings from all lines about the picture, before names have values.
#[derive(Default)]
pub(crate) struct CollectedLines {
    pub domain: Option<DomainLine>,
    pub view: Option<ViewLine>,
    pub look: Option<&'static zeroset_style::Look>,
    pub background: Option<Background>,
    pub picture: PictureLines,
    /// All `color` lines: byte offset of the line, color, and opacity if the line has one.
    pub colors: Vec<(usize, (ParsedColor, Option<f64>))>,
    pub opacities: Vec<(usize, f64)>,
    pub hidden: Vec<(usize, bool)>,
    pub materials: Vec<(usize, &'static Material)>,
    /// All `width` lines: byte offset of the line, and width in pixels.
    pub widths: Vec<(usize, f64)>,
    /// Places of all lines about the picture, in order.
    pub lines: Vec<SettingLine>,
    pub contours: Option<Contours<Expr>>,
    /// Parameters of all parametric surfaces, which values at their points may use.
    pub parameters: Vec<Name>,
    /// The scope for values at points of a surface, built when a line first needs the scope.
    scope: Option<Scope>,
    /// Names of the document that the settings depend on.
    pub used: FxHashSet<String>,
}

impl CollectedLines {
    pub fn read(
        &mut self,
        text: &str,
        line: ParsedStatement<'_>,
        scope: &Scope,
        limits: &Limits,
    ) -> Fallible<()> {
        let span = line.raw.lexed.span;
        let first = line.raw.lexed.tokens[0];
        // A plot command's `domain` line has no typed word. A typed `domain` line takes precedence.
        let is_from_plot = first.span.start == first.span.end;
        let setting = typed_setting(&text[first.span.range()])
            .or_else(|| SETTINGS.iter().find(|row| TokenKind::of_setting(row.kind) == first.kind))
            .ok_or_else(|| Error::new(span, ErrorKind::Empty))?;
        let (scope, locals) = match setting.kind {
            SettingKind::Color | SettingKind::Contours => {
                let scope = self.scope.get_or_insert_with(|| with_point_names(scope));
                (&*scope, self.parameters.as_slice())
            }
            _ => (scope, [].as_slice()),
        };
        let mut builder = Builder::new(text, &line.raw.lexed, scope, locals, limits);
        builder.aliases = line.raw.aliases.clone();
        let mut reader = LineReader { builder };
        let (pair, at, word) = (line.pair, span.start, setting.word);
        let mut share = None;
        match setting.kind {
            SettingKind::Domain => {
                let domain = reader.domain(pair)?;
                if !is_from_plot || self.domain.is_none() {
                    self.domain = Some(domain);
                }
            }
            SettingKind::View => self.view = Some(reader.view(pair)?),
            SettingKind::Color => {
                let (color, opacity) = reader.color_line(pair)?;
                share = opacity.map(|(_, span)| span);
                self.colors.push((at, (color, opacity.map(|(opacity, _)| opacity))));
            }
            SettingKind::Look => self.look = Some(reader.look(pair)?),
            SettingKind::Background => self.background = Some(reader.background(pair)?),
            SettingKind::Clip => self.picture.clip = Some(reader.numbers(pair, word)?),
            SettingKind::Light => self.picture.light = Some(reader.numbers(pair, word)?),
            SettingKind::Opacity => {
                self.opacities.push((at, reader.setting_value(pair, &OPACITY)?));
            }
            SettingKind::Material => {
                let names = MATERIALS.each_ref().map(|row| row.name);
                let row = reader.one_of(pair, word, names, 0)?;
                self.materials.push((at, &MATERIALS[row]));
            }
            SettingKind::Hidden => self.hidden.push((at, reader.switch(pair, word)?)),
            SettingKind::Mesh => self.picture.mesh = Some(reader.switch(pair, word)?),
            SettingKind::Title => self.picture.title = Some(reader.title(pair)?),
            SettingKind::Aspect => {
                self.picture.is_equal = reader.one_of(pair, word, ["auto", "equal"], 1)? == 1;
            }
            SettingKind::Width => self.widths.push((at, reader.setting_value(pair, &WIDTH)?)),
            SettingKind::Choice(row) => {
                let value = reader.setting_value(pair, row)?;
                (row.set)(&mut self.picture.choices, value);
            }
            SettingKind::Contours => self.contours = Some(reader.contours(pair)?),
        }
        self.used.extend(reader.builder.used);
        let word = setting_word(setting.word).unwrap_or(setting.word);
        self.lines.push(SettingLine { word, span, share });
        Ok(())
    }
}

/// The setting for the drawing at `place`, from the last line above the drawing. But if a line is
/// below the last drawing, which is at `last`, the first line below `place` counts.
pub(crate) fn setting_for<T>(lines: &[(usize, T)], place: usize, last: usize) -> Option<&T> {
    let follow = lines.last().is_some_and(|(at, _)| *at > last);
    let found = if follow {
        lines.iter().find(|(at, _)| *at > place)
    } else {
        lines.iter().rfind(|(at, _)| *at < place)
    };
    found.map(|(_, said)| said)
}

impl LineReader<'_> {
    /// Reads a line of text. Blanks become single spaces, and quotes around the text are left out.
    fn title(&self, line: Pair<'_>) -> Fallible<String> {
        let words = match &parts(line)[..] {
            [text] if text.as_rule() == Rule::label => self.builder.typed(text).trim_matches('"'),
            _ => "",
        };
        let text = words.split_whitespace().collect::<Vec<_>>().join(" ");
        if text.is_empty() { Err(bad_setting("title", self.builder.lexed.span)) } else { Ok(text) }
    }
}

#[cfg(test)]
mod tests {
    use crate::{Options, read};

    #[test]
    fn words_in_letters_of_full_width_are_the_same_words() {
        for (wide, plain) in [
            ("ｌｉｇｈｔ 1, 2, 3", "light 1, 2, 3"),
            ("ｌｉｇｈｔ 1, 2, 3, 4", "light 1, 2, 3, 4"),
            ("ｓｈａｄｏｗｓ ｏｆｆ", "shadows off"),
            ("ｃｏｌｏｕｒ ｒｅｄ", "colour red"),
            ("ｖｉｅｗ ｆｒｏｎｔ", "view front"),
            ("ｖｉｅｗ ｅｙｅ (4, 3, 6) ｆｏｖ 40", "view eye (4, 3, 6) fov 40"),
        ] {
            let said = |line: &str| {
                let read = read(&format!("x + y\n{line}"), &Options::default());
                let said =
                    read.map(|d| format!("{:?}", (d.view, d.picture, d.surfaces[0].color.clone())));
                said.map_err(|errors| errors.iter().map(|e| e.kind.clone()).collect::<Vec<_>>())
            };
            assert_eq!(said(wide), said(plain), "{wide}");
        }
    }
}
