//! Errors and notes as text with carets, for people.

use crate::error::{Error, Errors, Origin};
use crate::note::Note;
use crate::span::Span;
use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};

/// Columns that a diagnostic may take; the same everywhere, so that output does not depend on the
/// terminal.
const WIDTH: usize = 100;
/// Bytes kept after the start of what is pointed at, where a line is very long.
const CONTEXT: usize = 400;

impl Errors {
    /// All errors as text with carets. `source_name` is the file's name, if there is one; `text` is
    /// what was read. Without `color` the result is plain text.
    pub fn render(&self, source_name: Option<&str>, text: &str, color: bool) -> String {
        let rendered: Vec<String> =
            self.iter().map(|error| error.render(source_name, text, color)).collect();
        rendered.join("\n\n")
    }
}

impl Error {
    /// This error as text with a caret, without a line break at the end.
    pub fn render(&self, source_name: Option<&str>, text: &str, color: bool) -> String {
        let (source_name, text) = match &self.origin {
            Origin::Document => (source_name, text),
            Origin::Override(given) => (Some("-D"), given.as_str()),
        };
        let excerpt = Excerpt::around(text, self.span);
        let message = self.message();
        let mut annotation = AnnotationKind::Primary.span(excerpt.span(self.span));
        if let Some(label) = self.label() {
            annotation = annotation.label(label);
        }
        let mut group = Level::ERROR
            .primary_title(message.as_str())
            .element(excerpt.snippet(source_name).annotation(annotation));
        if let Some(reason) = self.reason() {
            group = group.element(Level::NOTE.message(reason));
        }
        let help = self.help(text);
        if let Some(help) = &help {
            group = group.element(Level::HELP.message(help.as_str()));
        }
        renderer(color).render(&[group])
    }
}

impl Note {
    /// This note as text with a caret, without a line break at the end.
    pub fn render(&self, source_name: Option<&str>, text: &str, color: bool) -> String {
        let excerpt = Excerpt::around(text, self.span);
        let message = self.message();
        let annotation = AnnotationKind::Primary.span(excerpt.span(self.span));
        let group: Group<'_> = Level::NOTE
            .primary_title(message.as_str())
            .element(excerpt.snippet(source_name).annotation(annotation));
        renderer(color).render(&[group])
    }
}

fn renderer(color: bool) -> Renderer {
    let renderer = if color { Renderer::styled() } else { Renderer::plain() };
    renderer.term_width(WIDTH)
}

/// The part of a text that is shown: whole lines, or less of the last where it is very long. It
/// starts with a line, because columns are counted from its start.
struct Excerpt<'a> {
    shown: &'a str,
    start: usize,
    line: usize,
}

impl<'a> Excerpt<'a> {
    fn around(text: &'a str, span: Span) -> Self {
        let place = span.start.min(text.len());
        let line = 1 + text[..place].matches('\n').count();
        let line_start = text[..place].rfind('\n').map_or(0, |at| at + 1);
        let end = span.end.clamp(place, text.len());
        let line_end = text[end..].find('\n').map_or(text.len(), |at| end + at);
        let floor = |mut at: usize| {
            while !text.is_char_boundary(at) {
                at -= 1;
            }
            at
        };
        let stop = line_end.min(floor((place + CONTEXT).min(text.len())));
        Self { shown: &text[line_start..stop], start: line_start, line }
    }

    fn span(&self, span: Span) -> std::ops::Range<usize> {
        let clip = |at: usize| at.saturating_sub(self.start).min(self.shown.len());
        clip(span.start)..clip(span.end)
    }

    fn snippet<A: Clone>(&self, source_name: Option<&'a str>) -> Snippet<'a, A> {
        Snippet::source(self.shown).line_start(self.line).path(source_name)
    }
}
