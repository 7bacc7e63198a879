//! Lists a document's surfaces and changes their style and order by edits of its text. A "drawing"
//! is a statement that draws a surface. Knows style lines and their places, but no window.

use super::draft::without_drawing;
use super::edit::{Edit, base, nothing_drawn};
use super::pipeline::{Rendering, Request};
use super::reply::{Refusal, Reply, no_such, refused};
use super::session::Live;
use super::undo::Gesture;
use std::ops::Range;
use zeroset_shade::{LinearRgb, SurfaceColors};
use zeroset_style::{MATERIALS, Material};
use zeroset_syntax::{Document, DrawnSurface, Options, SurfaceColor};

/// First words of style lines. These apply to the drawings below them.
const STYLE_WORDS: [&str; 4] = ["color", "opacity", "material", "hidden"];

/// Number of sample colors in a list for a surface with a color map.
const SWATCH: usize = 6;

/// Color of a list's row for a curve without a color of its own.
const CURVE: [u8; 3] = [60, 60, 68];

/// A surface's or curve's row in a list.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceEntry {
    /// The formula as it was read.
    pub echo: String,
    /// Sample colors, from left to right, as sRGB bytes.
    pub colors: Vec<[u8; 3]>,
    /// Opacity, within [0, 1].
    pub opacity: f64,
    /// Set if pictures leave the surface out.
    pub hidden: bool,
}

impl Rendering {
    /// The surfaces, in document order.
    pub fn surfaces(&self) -> Vec<SurfaceEntry> {
        let surfaces = self.document.drawn_surfaces().enumerate();
        let listed = |(number, surface): (usize, DrawnSurface<'_>)| {
            // List the colors of both sides, since either side may be visible.
            let SurfaceColors { positive, negative, .. } = SurfaceColors::default_for(number);
            let own = [positive.to_srgb(), negative.to_srgb()];
            let colors = samples(surface.color, &own);
            let (echo, opacity, hidden) =
                (surface.echo.to_owned(), surface.opacity, surface.hidden);
            SurfaceEntry { echo, colors, opacity, hidden }
        };
        surfaces.map(listed).collect()
    }

    /// The curves and points, in document order.
    pub fn curves(&self) -> Vec<SurfaceEntry> {
        let curves = self.document.curves.all.iter();
        let listed = |curve: &zeroset_syntax::Curve| {
            let colors = samples(curve.color.as_ref(), &[CURVE]);
            SurfaceEntry { echo: curve.echo.clone(), colors, opacity: 1.0, hidden: curve.hidden }
        };
        curves.map(listed).collect()
    }
}

/// Sample colors of a drawing, which has its `own` ones unless the document sets a color.
fn samples(color: Option<&SurfaceColor>, own: &[[u8; 3]]) -> Vec<[u8; 3]> {
    match color {
        Some(SurfaceColor::Plain(color)) => vec![LinearRgb::from_srgb(color.rgb).to_srgb()],
        Some(SurfaceColor::Mapped(mapped)) => {
            let share = |n: usize| n as f64 / (SWATCH - 1) as f64;
            (0..SWATCH).map(|n| mapped.map.bytes(share(n))).collect()
        }
        None => own.to_vec(),
    }
}

/// A drawing in a text, with the style that applies to it.
#[derive(Clone, Debug, PartialEq)]
struct StyledDrawing {
    /// Formula, as typed.
    body: String,
    /// Arguments of the `color` line, but without an opacity.
    color: String,
    opacity: f64,
    material: &'static Material,
    hidden: bool,
}

/// Color, opacity, material and hiding of a drawing without style lines above it.
const DEFAULT_STYLE: (&str, f64, &Material, bool) = ("auto", 1.0, &MATERIALS[0], false);

impl StyledDrawing {
    /// All drawings of a text with their styles.
    fn all(text: &str, document: &Document) -> Vec<Self> {
        let surfaces = document.drawn_surfaces().enumerate();
        let one = |(number, surface): (usize, DrawnSurface<'_>)| {
            let line = document.line_for("color", number);
            let color = line.map_or(DEFAULT_STYLE.0, |line| {
                let end = line.share.map_or(line.span.end, |share| share.start);
                let whole = text[line.span.start..end].trim();
                whole
                    .split_once(char::is_whitespace)
                    .map_or(DEFAULT_STYLE.0, |(_, color)| color.trim())
            });
            Self {
                body: text[surface.span.range()].to_owned(),
                color: color.to_owned(),
                opacity: surface.opacity,
                material: surface.material,
                hidden: surface.hidden,
            }
        };
        surfaces.map(one).collect()
    }

    /// The style lines needed above this drawing if `before` is the drawing above it. Returns only
    /// lines that begin with these `words`.
    fn lines(&self, before: Option<&Self>, words: &[&str]) -> Vec<String> {
        let (color, opacity, material, hidden) = before.map_or(DEFAULT_STYLE, |one| {
            (one.color.as_str(), one.opacity, one.material, one.hidden)
        });
        let mut lines = Vec::new();
        if words.contains(&"color") && self.color != color {
            lines.push(format!("color {}", self.color));
        }
        if words.contains(&"opacity") && self.opacity != opacity {
            lines.push(format!("opacity {}%", percent(self.opacity)));
        }
        if words.contains(&"material") && self.material != material {
            lines.push(format!("material {}", self.material.name));
        }
        if words.contains(&"hidden") && self.hidden != hidden {
            lines.push(if self.hidden { "hidden" } else { "hidden off" }.to_owned());
        }
        lines
    }
}

/// A share in percent, rounded to two decimals.
fn percent(share: f64) -> f64 {
    (share * 1e4).round() / 1e2
}

/// Applies `change` to the drawings of a text, and rewrites all style lines that begin with these
/// `words`. Returns the new text and its document. Returns `None` if style lines cannot express the
/// change. An example is a change within a program.
fn changed(
    text: &str,
    options: &Options<'_>,
    words: &[&str],
    change: impl FnOnce(&mut Vec<StyledDrawing>),
) -> Option<(String, Document)> {
    let document = zeroset_syntax::read(text, options).ok()?;
    let slots: Vec<Range<usize>> =
        document.drawn_surfaces().map(|surface| surface.span.range()).collect();
    let mut drawn = StyledDrawing::all(text, &document);
    change(&mut drawn);
    let mut edits: Vec<(Range<usize>, String)> = Vec::new();
    for line in document.lines.iter().filter(|line| STYLE_WORDS.contains(&line.word)) {
        if words.contains(&line.word) {
            edits.push((whole(text, &line.span.range()), String::new()));
        } else if let Some(share) = line.share.filter(|_| words.contains(&"opacity")) {
            let start = text[..share.start].trim_end().len();
            edits.push((start..share.end, String::new()));
        }
    }
    for (number, (slot, one)) in slots.iter().zip(&drawn).enumerate() {
        let before = number.checked_sub(1).map(|before| &drawn[before]);
        let head = text[..slot.start].trim_end_matches([' ', '\t']);
        let end = if slot.start == 0 || head.ends_with('\n') { "\n" } else { "; " };
        let mut pieces = one.lines(before, words);
        // A style line cannot stand inside a statement of a program.
        let is_alone = head.is_empty() || head.ends_with(['\n', ';']);
        if !is_alone && !pieces.is_empty() {
            return None;
        }
        pieces.push(one.body.clone());
        edits.push((slot.clone(), pieces.join(end)));
    }
    edits.sort_by_key(|(range, _)| range.start);
    let mut new = text.to_owned();
    let mut end = text.len();
    for (range, with) in edits.into_iter().rev() {
        // Overlapping edits would corrupt the text.
        if range.end > end || range.start > range.end {
            return None;
        }
        end = range.start;
        new.replace_range(range, &with);
    }
    let is_said = |said: &Document| {
        let alike = |(one, other): (&StyledDrawing, &StyledDrawing)| {
            one.body == other.body
                && one.color == other.color
                && one.hidden == other.hidden
                && one.material == other.material
                && percent(one.opacity) == percent(other.opacity)
        };
        let now = StyledDrawing::all(&new, said);
        now.len() == drawn.len()
            && now.iter().zip(&drawn).all(alike)
            && same_curves(&document, said)
    };
    let said = zeroset_syntax::read(&new, options).ok().filter(is_said)?;
    Some((new, said))
}

/// Returns whether the curves of two documents look alike.
fn same_curves(one: &Document, other: &Document) -> bool {
    let style = |curve: &zeroset_syntax::Curve| {
        (format!("{:?}", curve.color), curve.width, curve.hidden, curve.echo.clone())
    };
    let [one, other] = [one, other].map(|document| document.curves.all.iter().map(style));
    one.eq(other)
}

/// The range of a style line. It includes a line break or semicolon right behind the line.
pub(super) fn whole(text: &str, line: &Range<usize>) -> Range<usize> {
    let rest = &text[line.end..];
    let blank = rest.len() - rest.trim_start_matches([' ', '\t']).len();
    let ends = rest[blank..].starts_with(['\n', ';']);
    line.start..line.end + blank + usize::from(ends)
}

impl Live {
    /// Sets the opacity of a surface, clamped to [0, 1]. Numbers count from 1. Consecutive calls
    /// are one step of [`Live::undo`].
    ///
    /// # Errors
    /// If there is no such surface, or no style line can express the change.
    pub fn set_opacity(&self, number: usize, opacity: f64) -> Result<(), Refusal> {
        let gesture = Gesture::Value(format!("opacity {number}"));
        let set = self.move_value(gesture, move |live, gesture| {
            Some(live.restyle(number, &["opacity"], Some(gesture), |drawn| {
                drawn[number - 1].opacity = opacity.clamp(0.0, 1.0);
            }))
        });
        // A change that waits for an edit has not been refused, so report success.
        set.unwrap_or(Ok(()))
    }

    /// Sets the color of a surface, given as in a line `color …`, perhaps with an opacity in
    /// percent. Numbers count from 1.
    ///
    /// # Errors
    /// If there is no such surface, it is no color, or no style line can express the change.
    pub fn set_color(&self, number: usize, color: &str) -> Result<(), Refusal> {
        let share = color.rsplit_once(char::is_whitespace).and_then(|(color, share)| {
            let percent: f64 = share.strip_suffix('%')?.parse().ok()?;
            Some((color.trim(), (percent / 100.0).clamp(0.0, 1.0)))
        });
        let (name, opacity) = share.map_or((color, None), |(name, share)| (name, Some(share)));
        let set = self.restyle(number, &["color", "opacity"], None, |drawn| {
            let one = &mut drawn[number - 1];
            name.clone_into(&mut one.color);
            one.opacity = opacity.unwrap_or(one.opacity);
        });
        // A wrong color is a better reason than that no line can hold it.
        let lone = format!("color {color}\nz = x");
        match zeroset_syntax::read(&lone, &Options::default()) {
            Err(errors) if set.is_err() => Err(Refusal::Text { text: lone, errors }),
            _ => set,
        }
    }

    /// Moves a surface to another place in the order. Both numbers count from 1.
    ///
    /// # Errors
    /// If there is no such surface or place, or no style line can express the change.
    pub fn move_surface(&self, from: usize, to: usize) -> Result<(), Refusal> {
        self.restyle(from.max(to), &STYLE_WORDS, None, |drawn| {
            let one = drawn.remove(from - 1);
            drawn.insert(to - 1, one);
        })
    }

    /// Deletes a surface. Numbers count from 1.
    pub(super) fn delete(&self, number: usize) -> Result<Reply, Refusal> {
        let document = self.edit(None, |request, readable| {
            let text = without_surface(&base(request, readable, ""), &request.options(), number)
                .map_err(|count| no_such("surface", number, count))?;
            Edit::checked(request, text, Vec::new())
        })?;
        Ok(document.map_or_else(nothing_drawn, |_| Reply::Done))
    }

    /// Changes the styles of drawings with `change`, and writes them to the text as lines that
    /// begin with `words`. `number` is the surface to change, counted from 1.
    fn restyle(
        &self,
        number: usize,
        words: &[&str],
        gesture: Option<Gesture>,
        change: impl Fn(&mut Vec<StyledDrawing>),
    ) -> Result<(), Refusal> {
        let work = |request: &Request, readable: &str| {
            let base = base(request, readable, "");
            let options = request.options();
            let count =
                zeroset_syntax::read(&base, &options).map_or(0, |now| now.drawn_surfaces().count());
            if !(1..=count).contains(&number) {
                return Err(no_such("surface", number, count));
            }
            let Some((text, document)) = changed(&base, &options, words, &change) else {
                let words = words.join("`, `");
                return refused(format!(
                    "this text has no place for that: write `{words}` lines yourself"
                ));
            };
            // The formulas are unchanged, so they are not checked again.
            Ok(Edit::unchecked(text, document))
        };
        self.edit(gesture, work).map(drop)
    }
}

/// The text without one drawing. The other drawings keep their style. The errors are the same as
/// for [`without_drawing`].
pub(super) fn without_surface(
    text: &str,
    options: &Options<'_>,
    number: usize,
) -> Result<String, usize> {
    let plain = without_drawing(text, number)?;
    let look = |text: &str| {
        let document = zeroset_syntax::read(text, options).ok()?;
        let styles = StyledDrawing::all(text, &document);
        Some(styles.into_iter().map(|one| (one.color, one.opacity, one.hidden)).collect::<Vec<_>>())
    };
    let mut wanted = look(text).unwrap_or_default();
    if wanted.len() >= number {
        wanted.remove(number - 1);
    }
    if look(&plain).is_none_or(|now| now == wanted) {
        return Ok(plain);
    }
    // A style line below the last drawing would apply to drawings above it. So move the drawing to
    // the end first, and give it the style of the drawing before it.
    let last = changed(text, options, &STYLE_WORDS, |drawn| {
        let one = drawn.remove(number - 1);
        let like = drawn.last().unwrap_or(&one).clone();
        drawn.push(StyledDrawing { body: one.body, ..like });
    });
    let moved = last.and_then(|(text, _)| without_drawing(&text, wanted.len() + 1).ok());
    Ok(moved.filter(|text| look(text).as_ref() == Some(&wanted)).unwrap_or(plain))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn edited(
        text: &str,
        words: &[&str],
        change: impl FnOnce(&mut Vec<StyledDrawing>),
    ) -> Option<String> {
        changed(text, &Options::default(), words, change).map(|(text, _)| text)
    }

    #[test]
    fn an_opacity_is_said_once_and_colors_stay() {
        let set = |text: &str, number: usize, opacity: f64| {
            edited(text, &["opacity"], |drawn| drawn[number].opacity = opacity)
        };
        assert_eq!(
            set("color red 50%\nx = 1\ny = 1", 1, 0.25).as_deref(),
            Some("color red\nopacity 50%\nx = 1\nopacity 25%\ny = 1")
        );
        assert_eq!(
            set("color #102030 50% # deep\nx = 1", 0, 1.0).as_deref(),
            Some("color #102030 # deep\nx = 1")
        );
        assert_eq!(
            set("color viridis(z, -1, 1)\nopacity 0.5\nx = 1", 0, 0.123_456).as_deref(),
            Some("color viridis(z, -1, 1)\nopacity 12.35%\nx = 1")
        );
        // Refused, since it would need a style line inside a statement of the program.
        assert_eq!(set("float d = length(p) - 1.;", 0, 0.5), None);
    }

    #[test]
    fn what_is_moved_keeps_its_looks() {
        let text = "x = 1 # first\ncolor red 50%\ny = 1\nhidden\nz = 1";
        let moved = edited(text, &STYLE_WORDS, |drawn| drawn.rotate_left(1)).expect("moved");
        assert_eq!(
            moved,
            "color red\nopacity 50%\ny = 1 # first\nhidden\nz = 1\ncolor auto\nopacity 100%\n\
             hidden off\nx = 1"
        );
    }

    #[test]
    fn what_is_left_looks_as_it_did() {
        let take = |text: &str, number| without_surface(text, &Options::default(), number);
        assert_eq!(take("x = 1\ncolor red\ny = 1", 2).as_deref(), Ok("x = 1"));
        assert_eq!(
            take("color red\nx = 1\ncolor blue\ny = 1\nhidden\nz = 1", 3).as_deref(),
            Ok("color red\nx = 1\ncolor blue\ny = 1")
        );
        assert_eq!(take("color red\nx = 1\ny = 1", 1).as_deref(), Ok("color red\ny = 1"));
        assert_eq!(take("x = 1", 2), Err(1));
    }
}
