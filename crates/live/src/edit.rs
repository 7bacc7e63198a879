//! Edits of the document: entering lines, setting values, deleting surfaces. An edit that would
//! cause an error is refused and changes nothing. Knows no commands.

use super::draft::{
    completes, drawing, draws, draws_function, entered, with_drawing, without_scenery,
};
use super::pipeline::Request;
use super::reply::{Refusal, Reply, no_such, refused};
use super::session::Live;
use super::source::DocumentSource;
use super::undo::{Checkpoint, Gesture};
use super::values::{self, TIME, defined};
use std::borrow::Cow;
use std::sync::Arc;
use zeroset_interval::Interval;
use zeroset_parser::tree::ast::Statement;
use zeroset_parser::{ErrorKind, Limits, Note, NoteKind};
use zeroset_scene::program::Program;
use zeroset_scene::view::is_idle;
use zeroset_syntax::{Document, parse};

/// What a typed line does to the formulas of the document.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum LineGoal {
    /// A formula replaces all others.
    Replace,
    /// A formula is drawn beside the others.
    Add,
    /// The line replaces the formula with this number, counted from 1.
    Edit(usize),
}

pub(super) struct Edit {
    text: Arc<str>,
    /// Names that the edit defines or redefines.
    defined: Vec<String>,
    /// The new source of the document. `None` if the source stays.
    source: Option<DocumentSource>,
    /// The document as read. `None` if the text has definitions but draws nothing.
    document: Option<Document>,
}

impl Live {
    /// Draws the document as it would be after entering `line`, which is still being typed. Without
    /// a line, draws the document itself.
    pub(super) fn show_typed(&self, line: Option<&str>, goal: LineGoal) {
        let shown = |Checkpoint { request, readable, .. }: &Checkpoint| {
            let Some(line) = line else {
                return Ok((Arc::clone(&request.text), Vec::new(), false));
            };
            let text: Arc<str> = with_line(request, readable, line, goal).0.into();
            let is_readable = parse(&text, &Limits::default()).is_ok();
            Ok((text, defined(line), is_readable))
        };
        let _never_refused = self.change_after(shown, |state, (shown, typed, is_readable)| {
            if (&shown, &typed) != (&state.shown, &state.typed) {
                state.typed = typed;
                if is_readable {
                    state.preview = Some(Arc::clone(&shown));
                }
                self.show(state, shown);
            }
        });
    }

    /// Enters a line into the document.
    pub(super) fn commit(&self, line: &str, goal: LineGoal) -> Result<Reply, Refusal> {
        let document = self.edit(None, |request, readable| {
            if let LineGoal::Edit(number) = goal {
                with_drawing(&base(request, readable, line), number, line)
                    .map_err(|count| no_such("surface", number, count))?;
            }
            let (text, is_another) = with_line(request, readable, line, goal);
            let edit = Edit::checked(request, text, defined(line))?;
            Ok(Edit { source: is_another.then_some(DocumentSource::Typed), ..edit })
        })?;
        let Some(document) = document else { return Ok(nothing_drawn()) };
        let given = defined(line);
        let is_given = |note: &&Note| match &note.kind {
            NoteKind::Unused { name, .. } => given.contains(name),
            NoteKind::UnusedRadius { .. } => given.iter().any(|name| name == "r"),
            _ => false,
        };
        let unused = document.notes.iter().find(is_given);
        Ok(unused.map_or(Reply::Done, |note| Reply::Say(format!("noted; {}", note.kind))))
    }

    /// The formula with this number, counted from 1, as it was typed. Curves and points come after
    /// the surfaces.
    pub fn formula(&self, number: usize) -> Option<String> {
        drawing(&self.text(), number).map(str::to_owned)
    }

    /// Gives a name a value, even if nothing uses the name yet.
    ///
    /// # Errors
    /// If the document would have errors.
    pub fn define(&self, name: char, value: &str) -> Result<(), Refusal> {
        self.commit(&format!("{name} = {value}"), LineGoal::Replace).map(drop)
    }

    /// Sets a value in the document. A slider's range is kept, widened to hold the value.
    pub(super) fn set(&self, name: &str, value: &str) -> Result<Reply, Refusal> {
        let document = self.edit(None, |request, readable| {
            let line = format!("{name} = {value}");
            let base = base(request, readable, &line);
            let text = entered(&base, &line, false);
            let lacks = |all: Vec<Statement>| all.iter().all(|one| values::name(one) != Some(name));
            if parse(&text, &Limits::default()).is_ok_and(lacks) {
                return refused(format!("`{name}` has a fixed meaning and cannot be set"));
            }
            Edit::checked(request, text, vec![name.to_owned()])
        })?;
        let Some(document) = document else { return Ok(nothing_drawn()) };
        let parameter = document.parameters.iter().find(|parameter| parameter.name == name);
        let is_idle = parameter.is_some_and(|parameter| is_idle(&document, parameter));
        Ok(match name {
            _ if !is_idle => Reply::Done,
            TIME => Reply::Say("noted; nothing that is drawn depends on the time t".to_owned()),
            _ => Reply::Say(format!("noted; nothing that is drawn depends on `{name}`")),
        })
    }

    /// Replaces the document by the result of `work`. The arguments of `work` are the request and
    /// the last text that parsed. Returns the new document; `None` if it draws nothing. With a
    /// `gesture`, the edit is part of the gesture's undo step.
    pub(super) fn edit(
        &self,
        gesture: Option<Gesture>,
        work: impl Fn(&Request, &str) -> Result<Edit, Refusal>,
    ) -> Result<Option<Document>, Refusal> {
        let work = |checkpoint: &Checkpoint| {
            let edit = work(&checkpoint.request, &checkpoint.readable)?;
            let dragged = checkpoint.dragged_in(&edit.text);
            Ok((edit, dragged))
        };
        self.change_after(work, |state, (Edit { text, defined, source, document }, dragged)| {
            let before = state.checkpoint();
            state.request.forget_given(&defined);
            state.request.text = Arc::clone(&text);
            state.readable = Arc::clone(&text);
            state.dragged = dragged;
            if let Some(source) = source {
                state.request.source = source;
            }
            state.shown = if document.is_some() { text } else { "".into() };
            state.typed.clear();
            self.record(state, before, gesture);
            document
        })
    }
}

impl Edit {
    /// Reads an edited text. The edit defines the names `defined`.
    ///
    /// # Errors
    /// If the text has an error, or a formula has no surface.
    pub fn checked(request: &Request, text: String, defined: Vec<String>) -> Result<Self, Refusal> {
        // Drop values given on the command line that would override the new definitions.
        let mut request = request.clone();
        request.forget_given(&defined);
        let document = match zeroset_syntax::read(&text, &request.options()) {
            Ok(document) => {
                Program::new(&document, [Interval::ENTIRE; 3]).map_err(Refusal::Program)?;
                Some(document)
            }
            // A definition may be entered before the formula that uses it.
            Err(errors) if errors.iter().all(is_nothing_to_draw) => None,
            Err(errors) => return Err(Refusal::Text { text, errors }),
        };
        Ok(Self { text: text.into(), defined, source: None, document })
    }

    /// The result of an edit that changes no formula.
    pub fn unchecked(text: String, document: Document) -> Self {
        let (defined, source, document) = (Vec::new(), None, Some(document));
        Self { text: text.into(), defined, source, document }
    }
}

/// The text with `line` entered, and whether the text is a new document. A formula that replaces a
/// gallery surface begins a new document, without the gallery's domain, view and comments.
///
/// A line that replaces a missing formula changes nothing.
fn with_line(request: &Request, readable: &str, line: &str, goal: LineGoal) -> (String, bool) {
    let base = base(request, readable, line);
    let adding = goal == LineGoal::Add;
    match request.source {
        _ if let LineGoal::Edit(number) = goal => {
            (with_drawing(&base, number, line).unwrap_or_else(|_| base.into_owned()), false)
        }
        DocumentSource::Gallery(came)
            if !adding && (draws(&base, line) || draws_function(line)) =>
        {
            (entered(&without_scenery(&base, came.text), line, adding), true)
        }
        _ => (entered(&base, line, adding), false),
    }
}

/// The text into which `line` is entered. This is the document if it parses, alone or with `line`.
/// Else it is the document with the values given on the command line if that parses, or `readable`.
pub(super) fn base<'a>(request: &'a Request, readable: &'a str, line: &str) -> Cow<'a, str> {
    let is_read = |text: &str| parse(text, &Limits::default()).is_ok();
    // An empty document stays empty.
    if request.text.trim().is_empty() || is_read(&request.text) || completes(&request.text, line) {
        return Cow::Borrowed(&request.text);
    }
    let with = |given: &[&(String, String)]| {
        let lines = given.iter().map(|(name, value)| format!("\n{name} = {value}"));
        lines.fold(request.text.trim_end().to_owned(), |text, line| text + &line)
    };
    let all: Vec<&(String, String)> = request.overrides.iter().collect();
    let known = defined(&with(&all));
    let is_lacking = |name: &str| known.iter().filter(|other| *other == name).count() == 1;
    let lacking: Vec<_> = all.into_iter().filter(|(name, _)| is_lacking(name)).collect();
    let completed = with(&lacking);
    if is_read(&completed) { Cow::Owned(completed) } else { Cow::Borrowed(readable) }
}

fn is_nothing_to_draw(error: &zeroset_parser::Error) -> bool {
    matches!(error.kind, ErrorKind::NothingToDraw { .. })
}

pub(super) fn nothing_drawn() -> Reply {
    Reply::Say("noted; there is nothing to draw yet".to_owned())
}
