//! One document and its picture, as all who type, drag and look share them. Knows no commands.

use super::draft::entered;
use super::orbit::Orbit;
use super::pipeline::{Pipeline, Rendering, Request, Snapshot, same_document};
use crate::picture::Settings;
use crate::program::{Program, ProgramError};
use crate::scene::{CameraChoice, is_idle};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use zeroset_interval::Interval;
use zeroset_syntax::ast::Statement;
use zeroset_syntax::{Document, ErrorKind, Errors, Limits, Options, Span, parse};
use zeroset_trace::UndecidedStyle;

/// A document that is typed and turned, and its picture.
///
/// All methods may be called from any thread. The lock is held for moments only: what takes longer,
/// as reading and simplifying, is done without it.
pub struct Live {
    state: Mutex<State>,
    pipeline: Pipeline,
}

struct State {
    /// What is asked for, with the document as entered.
    request: Request,
    /// The text last asked for, with what is being typed.
    shown: Arc<str>,
    /// The last text that could be read, from which typing goes on when a watched file no longer
    /// can.
    readable: Arc<str>,
    revision: u64,
}

/// What an edit has made of a document.
struct Edit {
    text: Arc<str>,
    overrides: Vec<(String, String)>,
    /// The document as read; `None` while it defines names only.
    document: Option<Document>,
}

/// What a line that was entered leads to.
#[derive(Clone, Debug, PartialEq)]
pub enum Reply {
    /// It is done.
    Done,
    /// It is done, and this is to be shown.
    Say(String),
    /// The caller is to find this text and hand it to [`Live::load`].
    Load(String),
    /// The caller is to write [`Live::text`] to this file, or to where it came from.
    Save(Option<String>),
    /// The caller is to write the picture to this file, or to one with a new name.
    Png(Option<String>),
    /// The caller is to show how the document was read and compiled, with the code or without.
    Explain {
        /// Whether the code is asked for.
        code: bool,
    },
    /// The caller is to end.
    Quit,
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

impl Live {
    /// Starts to make pictures of a document, whose text is empty if there is none yet.
    pub fn new(request: Request) -> Self {
        let (shown, readable) = (Arc::clone(&request.text), Arc::clone(&request.text));
        let pipeline = Pipeline::new(request.clone());
        let live =
            Self { state: Mutex::new(State { request, shown, readable, revision: 0 }), pipeline };
        live.refresh();
        live
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        // Every write leaves the state whole, so a panic elsewhere does not spoil it.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What can be seen now.
    pub fn snapshot(&self) -> Snapshot {
        self.pipeline.snapshot()
    }

    /// Waits until the fine picture of everything asked for so far, or what is wrong with it, is
    /// there, and tells whether it came to that in time.
    pub fn wait(&self, timeout: Duration) -> bool {
        let revision = self.lock().revision;
        self.pipeline.wait(timeout, |seen, _| seen.settled >= revision)
    }

    /// Waits for the fine picture of the request with this number. `None` if it does not come in
    /// time, if something is wrong with it, or once something else is asked for.
    pub fn finished(&self, revision: u64, timeout: Duration) -> Option<Arc<Rendering>> {
        self.pipeline.wait(timeout, |seen, latest| seen.settled >= revision || latest > revision);
        let Snapshot { rendering, fault, .. } = self.snapshot();
        let is_wrong = fault.is_some_and(|fault| fault.revision == revision);
        rendering.filter(|seen| seen.revision == revision && !seen.coarse && !is_wrong)
    }

    /// Waits until something newer than the picture or fault with this number can be seen, and
    /// tells whether it came to that in time.
    pub fn wait_for_news(&self, timeout: Duration, known: u64) -> bool {
        self.pipeline.wait(timeout, |seen, _| {
            let rendering = seen.rendering.as_ref().map_or(0, |rendering| rendering.revision);
            rendering.max(seen.fault.as_ref().map_or(0, |fault| fault.revision)) > known
        })
    }

    /// Number of the latest request for a picture.
    pub fn revision(&self) -> u64 {
        self.lock().revision
    }

    /// What the picture is to show when nothing more is typed.
    pub fn request(&self) -> Request {
        self.lock().request.clone()
    }

    /// The document as entered so far.
    pub fn text(&self) -> String {
        self.lock().request.text.to_string()
    }

    /// How pictures are made at present.
    pub fn settings(&self) -> Settings {
        self.lock().request.settings.clone()
    }

    /// Shows what the document would be if a line that is still being typed were entered; `None`
    /// for the document as it is.
    pub(super) fn show_typed(&self, line: Option<&str>, adding: bool) {
        let shown = |request: &Request, readable: &str| {
            Ok(match line {
                Some(line) => entered(base(request, readable), line, adding).into(),
                None => Arc::clone(&request.text),
            })
        };
        let _never_refused = self.change_after(shown, |state, shown: Arc<str>| {
            if shown != state.shown {
                self.show(state, shown);
            }
        });
    }

    /// Enters a line into the document.
    pub(super) fn commit(&self, line: &str, adding: bool) -> Result<Reply, Refusal> {
        let document = self.edit(|request, readable| {
            let text = entered(base(request, readable), line, adding);
            Edit::checked(text, request.overrides.clone(), request.time)
        })?;
        Ok(document.map_or_else(nothing_drawn, |_| Reply::Done))
    }

    /// Gives a name a value in the document; a slider keeps its range if the value lies within.
    pub(super) fn set(&self, name: &str, value: &str) -> Result<Reply, Refusal> {
        let defines = |one: &Statement| match one {
            Statement::Define(definition) => definition.name.text == name,
            Statement::Draw { .. } => false,
        };
        let document = self.edit(|request, readable| {
            let base = base(request, readable);
            let plain = entered(base, &format!("{name} = {value}"), false);
            if parse(&plain, &Limits::default()).is_ok_and(|all| !all.iter().any(defines)) {
                return Err(Refusal::Command(format!(
                    "`{name}` has a fixed meaning and cannot be set"
                )));
            }
            // What was given on the command line would otherwise go on to hide the definition.
            let mut overrides = request.overrides.clone();
            overrides.retain(|(other, _)| other != name);
            let ranged = range(base, name).and_then(|range| {
                let text = entered(base, &format!("{name} = {value} in {range}"), false);
                Edit::checked(text, overrides.clone(), request.time).ok()
            });
            ranged.map_or_else(|| Edit::checked(plain, overrides, request.time), Ok)
        })?;
        let Some(document) = document else { return Ok(nothing_drawn()) };
        let parameter = document.parameters.iter().find(|parameter| parameter.name == name);
        Ok(match parameter {
            Some(parameter) if is_idle(&document, parameter) => {
                Reply::Say(format!("noted; nothing that is drawn depends on `{name}`"))
            }
            _ => Reply::Done,
        })
    }

    /// Replaces the document by what `work` makes of it and of the last text that could be read,
    /// and returns it as read.
    fn edit(
        &self,
        work: impl Fn(&Request, &str) -> Result<Edit, Refusal>,
    ) -> Result<Option<Document>, Refusal> {
        self.change_after(work, |state, Edit { text, overrides, document }| {
            state.request.overrides = overrides;
            state.request.text = Arc::clone(&text);
            state.readable = Arc::clone(&text);
            if document.is_some() {
                self.show(state, text);
            }
            document
        })
    }

    /// Does `work`, which may take long, without the lock, and again if somebody has changed the
    /// document meanwhile. What it results in is then applied.
    fn change_after<W, R>(
        &self,
        work: impl Fn(&Request, &str) -> Result<W, Refusal>,
        apply: impl FnOnce(&mut State, W) -> R,
    ) -> Result<R, Refusal> {
        loop {
            let (request, readable) = {
                let state = self.lock();
                (state.request.clone(), Arc::clone(&state.readable))
            };
            let result = work(&request, &readable)?;
            let mut state = self.lock();
            if same_document(&state.request, &request) && state.readable == readable {
                return Ok(apply(&mut state, result));
            }
        }
    }

    /// Takes `text` for the document. The view stays if `again`: the text is the same document in a
    /// newer version.
    pub fn load(&self, name: &str, text: &str, again: bool) {
        let is_readable = parse(text, &Limits::default()).is_ok();
        let text: Arc<str> = text.into();
        let mut state = self.lock();
        if is_readable || !again {
            state.readable = Arc::clone(&text);
        }
        let request = &mut state.request;
        name.clone_into(&mut request.name);
        request.text = Arc::clone(&text);
        if !again {
            *request = Request {
                name: name.to_owned(),
                text: Arc::clone(&text),
                clip: request.clip,
                settings: request.settings.clone(),
                ..Request::default()
            };
        }
        self.show(&mut state, text);
    }

    /// Asks for pictures of this size, in pixels; nothing below 1 is taken.
    pub fn resize(&self, width: usize, height: usize) {
        let (width, height) = (width.max(1), height.max(1));
        let settings = self.settings();
        if (settings.width, settings.height) != (width, height) {
            self.change(|request| {
                (request.settings.width, request.settings.height) = (width, height);
            });
        }
    }

    /// Turns, moves or zooms the view; nothing happens before there is a picture.
    pub fn turn(&self, turn: impl FnOnce(&mut Orbit)) {
        let Some(seen) = self.snapshot().rendering else { return };
        self.change(|request| {
            // The orbit last asked for, not the one last seen: it may be ahead of the pictures.
            let orbit = request
                .orbit
                .get_or_insert_with(|| Orbit::from_camera(&seen.camera, seen.model.region()));
            turn(orbit);
        });
    }

    /// Shows the whole domain's box from the same side; nothing happens before there is a picture.
    pub fn fit(&self) {
        let Some(seen) = self.snapshot().rendering else { return };
        let Settings { width, height, .. } = self.settings();
        self.turn(|orbit| orbit.fit(seen.model.region(), width, height));
    }

    /// Looks again from where the document says.
    pub fn reset_view(&self) {
        self.change(|request| {
            request.orbit = None;
            request.choice = CameraChoice::default();
        });
    }

    /// Marks undecided pixels, or no longer.
    pub fn toggle_undecided(&self) {
        self.change(|request| {
            request.settings.undecided = match request.settings.undecided {
                UndecidedStyle::Shade | UndecidedStyle::Miss => UndecidedStyle::Hatch,
                UndecidedStyle::Hatch | UndecidedStyle::Tint => UndecidedStyle::Shade,
            };
        });
    }

    /// Asks for the same picture once more; whoever waits for an earlier one does so in vain.
    pub fn refresh(&self) {
        self.change(|_| {});
    }

    /// Changes what is asked for, but not the text.
    pub(super) fn change(&self, change: impl FnOnce(&mut Request)) {
        let mut state = self.lock();
        change(&mut state.request);
        let shown = Arc::clone(&state.shown);
        self.show(&mut state, shown);
    }

    fn show(&self, state: &mut State, shown: Arc<str>) {
        state.shown = shown;
        if state.shown.trim().is_empty() {
            return;
        }
        let request = Request { text: Arc::clone(&state.shown), ..state.request.clone() };
        state.revision = self.pipeline.request(request);
    }
}

impl Edit {
    /// Reads a text with values for some of its names.
    ///
    /// # Errors
    /// If it is wrong, or if a formula has no surface.
    fn checked(
        text: String,
        overrides: Vec<(String, String)>,
        time: Option<f64>,
    ) -> Result<Self, Refusal> {
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
        Ok(Self { text: text.into(), overrides, document })
    }
}

/// What a line is entered into.
fn base<'a>(request: &'a Request, readable: &'a str) -> &'a str {
    if parse(&request.text, &Limits::default()).is_ok() { &request.text } else { readable }
}

/// The range of a slider as it was typed.
fn range(text: &str, name: &str) -> Option<String> {
    let statements = parse(text, &Limits::default()).ok()?;
    statements.iter().find_map(|one| match one {
        Statement::Define(definition) if definition.name.text == name => {
            let (low, high) = definition.range.as_ref()?;
            let part = |span: Span| text.get(span.start..span.end);
            Some(format!("[{}, {}]", part(low.span)?, part(high.span)?))
        }
        Statement::Define(_) | Statement::Draw { .. } => None,
    })
}

fn is_nothing_to_draw(error: &zeroset_syntax::Error) -> bool {
    matches!(error.kind, ErrorKind::NothingToDraw { .. })
}

fn nothing_drawn() -> Reply {
    Reply::Say("noted; there is nothing to draw yet".to_owned())
}
