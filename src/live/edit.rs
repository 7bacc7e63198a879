//! How a document is changed: lines entered, values set, surfaces taken away. What is wrong is
//! refused before anything changes. Knows no commands.

use super::draft::{completes, draws, entered, without_scenery};
use super::pipeline::Request;
use super::session::{Live, Reply};
use super::slider::TIME;
use super::source::DocumentSource;
use super::surfaces::{no_surface, without};
use super::undo::Gesture;
use super::values::defined;
use crate::gallery::Example;
use crate::program::{Program, ProgramError};
use crate::scene::is_idle;
use std::borrow::Cow;
use std::sync::Arc;
use zeroset_interval::Interval;
use zeroset_syntax::ast::Statement;
use zeroset_syntax::{Document, ErrorKind, Errors, Limits, Note, NoteKind, Options, parse};

/// What an edit has made of a document.
pub(super) struct Edit {
    text: Arc<str>,
    /// The names that it gave another meaning.
    defined: Vec<String>,
    /// Another name of the document.
    source: Option<DocumentSource>,
    /// The document as read, if it was; `None` while it defines names only.
    document: Option<Document>,
    /// Whether something is drawn.
    is_drawn: bool,
}

/// Why a line was not entered. Nothing has changed then.
#[derive(Debug)]
pub enum Refusal {
    /// The document would be wrong.
    Text {
        /// What it would be.
        text: String,
        /// What is wrong with it.
        errors: Errors,
    },
    /// A formula would have no surface: it is constant, or defined nowhere.
    Program(ProgramError),
    /// The command is wrong.
    Command(String),
}

impl Refusal {
    /// The one letter that lacks a value, if that is all that is wrong.
    pub fn missing_letter(&self) -> Option<char> {
        match self {
            Self::Text { errors, .. } => missing_letter(errors),
            Self::Program(_) | Self::Command(_) => None,
        }
    }

    /// What is wrong, with carets under a text.
    pub fn render(&self, color: bool) -> String {
        match self {
            Self::Text { text, errors } => errors.render(None, text, color),
            Self::Program(_) | Self::Command(_) => format!("error: {self}"),
        }
    }
}

impl std::fmt::Display for Refusal {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Text { errors, .. } => write!(f, "{errors}"),
            Self::Program(error) => write!(f, "{error}"),
            Self::Command(message) => f.write_str(message),
        }
    }
}

impl std::error::Error for Refusal {}

/// The one letter that lacks a value, if that is all that is wrong.
pub(super) fn missing_letter(errors: &Errors) -> Option<char> {
    let letter = |error: &zeroset_syntax::Error| match &error.kind {
        ErrorKind::UnknownName { name, letter } => {
            let mut letters = name.chars();
            letter.or(letters.next().filter(|_| letters.next().is_none()))
        }
        _ => None,
    };
    let first = letter(errors.iter().next()?)?;
    errors.iter().all(|error| letter(error) == Some(first)).then_some(first)
}

impl Live {
    /// Enters a line into the document.
    pub(super) fn commit(&self, line: &str, adding: bool) -> Result<Reply, Refusal> {
        let document = self.edit(|request, readable| {
            let (text, is_another) = after(request, readable, line, adding);
            let edit = Edit::checked(request, text, defined(line))?;
            Ok(Edit { source: is_another.then_some(DocumentSource::Typed), ..edit })
        })?;
        let Some(document) = document else { return Ok(nothing_drawn()) };
        let given = defined(line);
        let is_given = |note: &&Note| match &note.kind {
            NoteKind::Unused { name, .. } => given.contains(name),
            _ => false,
        };
        let unused = document.notes.iter().find(is_given);
        Ok(unused.map_or(Reply::Done, |note| Reply::Say(format!("noted; {}", note.kind))))
    }

    /// Gives a name a value in the document; a slider keeps its range, which is extended to hold the
    /// value.
    pub(super) fn set(&self, name: &str, value: &str) -> Result<Reply, Refusal> {
        let defines = |one: &Statement| match one {
            Statement::Define(definition) => definition.name.text == name,
            Statement::Draw { .. } => false,
        };
        let document = self.edit(|request, readable| {
            let line = format!("{name} = {value}");
            let base = base(request, readable, &line);
            let text = entered(&base, &line, false);
            if parse(&text, &Limits::default()).is_ok_and(|all| !all.iter().any(defines)) {
                return Err(Refusal::Command(format!(
                    "`{name}` has a fixed meaning and cannot be set"
                )));
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

    /// Takes away the drawing with this number, counted from 1.
    pub(super) fn delete(&self, number: usize) -> Result<Reply, Refusal> {
        let document = self.edit(|request, readable| {
            let text = without(&base(request, readable, ""), &request.options(), number)
                .map_err(|count| no_surface(number, count))?;
            Edit::checked(request, text, Vec::new())
        })?;
        Ok(document.map_or_else(nothing_drawn, |_| Reply::Done))
    }

    /// Replaces the document by what `work` makes of it and of the last text that could be read,
    /// and returns it as read.
    fn edit(
        &self,
        work: impl Fn(&Request, &str) -> Result<Edit, Refusal>,
    ) -> Result<Option<Document>, Refusal> {
        self.edit_by(None, work)
    }

    /// The same as a part of a gesture.
    pub(super) fn edit_by(
        &self,
        gesture: Option<Gesture>,
        work: impl Fn(&Request, &str) -> Result<Edit, Refusal>,
    ) -> Result<Option<Document>, Refusal> {
        self.change_after(work, |state, Edit { text, defined, source, document, is_drawn }| {
            let (before, was) = (state.said(), Arc::clone(&state.request.text));
            state.forget_given(&defined);
            state.request.text = Arc::clone(&text);
            state.readable = Arc::clone(&text);
            state.forget_dragged(&was);
            if let Some(source) = source {
                state.request.source = source;
            }
            state.shown = if is_drawn { text } else { "".into() };
            state.typed.clear();
            self.say(state, before, gesture);
            document
        })
    }
}

impl Edit {
    /// Reads a text in which a line has defined some names.
    ///
    /// # Errors
    /// If it is wrong, or if a formula has no surface.
    fn checked(request: &Request, text: String, defined: Vec<String>) -> Result<Self, Refusal> {
        let mut overrides = request.overrides.clone();
        // What was given on the command line would otherwise go on to hide the definition.
        overrides.retain(|(other, _)| !defined.contains(other));
        let time = request.time.filter(|_| defined.iter().all(|name| name != TIME));
        let options = Options { overrides: &overrides, time, ..Options::default() };
        let document = match zeroset_syntax::read(&text, &options) {
            Ok(document) => {
                Program::new(&document, [Interval::ENTIRE; 3]).map_err(Refusal::Program)?;
                Some(document)
            }
            // A definition may come before the formula that needs it.
            Err(errors) if errors.iter().all(is_nothing_to_draw) => None,
            Err(errors) => return Err(Refusal::Text { text, errors }),
        };
        let is_drawn = document.is_some();
        Ok(Self { text: text.into(), defined, source: None, document, is_drawn })
    }

    /// A text that is known to draw what the one before did.
    pub fn unchecked(text: String) -> Self {
        let (defined, source, document) = (Vec::new(), None, None);
        Self { text: text.into(), defined, source, document, is_drawn: true }
    }
}

/// The text that entering a line leads to. A formula that takes the place of a surface of the
/// gallery has nothing to do with that one's domain, view and comments, and they go with it.
/// The second tells whether it does.
pub(super) fn after(request: &Request, readable: &str, line: &str, adding: bool) -> (String, bool) {
    let base = base(request, readable, line);
    match from_gallery(request).filter(|_| !adding && draws(&base, line)) {
        Some(came) => (entered(&without_scenery(&base, came.text), line, adding), true),
        None => (entered(&base, line, adding), false),
    }
}

/// What a line is entered into: a text that can be read, if only with the line. One that lacks a value which was given on
/// the command line is completed by that.
pub(super) fn base<'a>(request: &'a Request, readable: &'a str, line: &str) -> Cow<'a, str> {
    let is_read = |text: &str| parse(text, &Limits::default()).is_ok();
    // What was taken away does not come back.
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

fn is_nothing_to_draw(error: &zeroset_syntax::Error) -> bool {
    matches!(error.kind, ErrorKind::NothingToDraw { .. })
}

fn nothing_drawn() -> Reply {
    Reply::Say("noted; there is nothing to draw yet".to_owned())
}

/// What a document was in the gallery, if it came from there.
fn from_gallery(request: &Request) -> Option<Example> {
    match request.source {
        DocumentSource::Gallery(example) => Some(example),
        _ => None,
    }
}
