//! Draws errors and notes as text with carets.

use crate::messages::error::{Error, Errors, Origin};
use crate::messages::note::Note;
use crate::span::Span;
use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet, Title};

/// Width of a diagnostic, in columns. It is fixed, so output does not depend on the terminal.
const WIDTH: usize = 100;
/// Number of bytes of a very long line that are shown after the start of the marked place.
const CONTEXT: usize = 400;

impl Errors {
    /// Draws all errors with carets. `source_name` is the file's name, if there is one. `text` is
    /// the document's text. Without `color`, the result is plain text.
    pub fn render(&self, source_name: Option<&str>, text: &str, color: bool) -> String {
        let rendered: Vec<String> =
            self.iter().map(|error| error.render(source_name, text, color)).collect();
        rendered.join("\n\n")
    }
}

impl Error {
    /// Draws this error with a caret. The result has no line break at its end.
    pub fn render(&self, source_name: Option<&str>, text: &str, color: bool) -> String {
        let (source_name, text) = match &self.origin {
            Origin::Document => (source_name, text),
            Origin::Override(given) => (Some("-D"), given.as_str()),
        };
        let help = self.help(text);
        let more = [(Level::NOTE, self.reason()), (Level::HELP, help.as_deref())];
        let title = Level::ERROR.primary_title(self.message());
        let labels = (self.label(), self.second_label());
        draw(title, (source_name, text, self.span), labels, more, color)
    }
}

impl Note {
    /// Draws this note with a caret. The result has no line break at its end.
    pub fn render(&self, source_name: Option<&str>, text: &str, color: bool) -> String {
        let title = Level::NOTE.primary_title(self.message());
        draw(title, (source_name, text, self.span), (None, None), [], color)
    }
}

/// Draws a title, the marked place with its label, perhaps a second place on the same line, and
/// further messages.
fn draw<'a>(
    title: Title<'a>,
    (source_name, text, span): (Option<&'a str>, &'a str, Span),
    (label, second): (Option<&'a str>, Option<(Span, &'a str)>),
    more: impl IntoIterator<Item = (Level<'a>, Option<&'a str>)>,
    color: bool,
) -> String {
    let place = span.start.min(text.len());
    let line = 1 + text[..place].matches('\n').count();
    // Whole lines are shown, but a very long last line is cut. Columns are counted from the start
    // of the first line shown.
    let start = text[..place].rfind('\n').map_or(0, |at| at + 1);
    let end = span.end.clamp(place, text.len());
    let line_end = text[end..].find('\n').map_or(text.len(), |at| end + at);
    let shown = &text[start..line_end.min(text.floor_char_boundary(place + CONTEXT))];
    let clip = |at: usize| at.saturating_sub(start).min(shown.len());
    let annotation = AnnotationKind::Primary.span(clip(span.start)..clip(span.end)).label(label);
    let snippet = Snippet::source(shown).line_start(line).path(source_name);
    let second = second.map(|(span, label)| {
        AnnotationKind::Context.span(clip(span.start)..clip(span.end)).label(label)
    });
    let mut group = title.element(snippet.annotation(annotation).annotations(second));
    for (level, said) in more {
        group = group.elements(said.map(|said| level.message(said)));
    }
    let renderer = if color { Renderer::styled() } else { Renderer::plain() };
    renderer.term_width(WIDTH).render(&[group])
}
