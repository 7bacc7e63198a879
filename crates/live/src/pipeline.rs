//! From the latest request to pictures, on a thread of its own: read, compile, a coarse picture, a
//! fine one.
//!
//! A new request ends the work on the one before between tiles. What an older stage made is kept as
//! long as nothing that it depends on has changed. Pictures and what they were made with are shared
//! by counting, so that the last of them to use a kernel frees it.

mod glide;
mod pace;
mod rooms;
mod view;
mod worker;

use self::worker::Worker;
use super::orbit::Orbit;
use super::source::DocumentSource;
use super::values::TIME;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use zeroset_render::model::Model;
use zeroset_render::overlay::Shown;
use zeroset_render::picture::{Picture, Settings};
use zeroset_scene::blank::Blank;
use zeroset_scene::domain::AutoDomain;
use zeroset_scene::view::{CameraChoice, ClipChoice, DomainChoice, SceneError};
use zeroset_space::Region;
use zeroset_syntax::{Document, ErrorKind, Errors, Options};
use zeroset_trace::Camera;

/// Whether the domain's box is shown with axes: a view that nobody chose then has it whole.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Axes {
    /// They are not.
    #[default]
    Off,
    /// They are.
    On,
    /// They are unless the document says otherwise.
    Usual,
}

impl Axes {
    /// Whether they are shown with this document.
    pub fn are_shown(self, document: &Document) -> bool {
        match self {
            Self::Off => false,
            Self::On => true,
            Self::Usual => document.picture.axes != Some(false),
        }
    }
}

/// Everything that a picture depends on.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Request {
    /// Where the document came from.
    pub source: DocumentSource,
    /// The document.
    pub text: Arc<str>,
    /// Names with values that replace those of the text.
    pub overrides: Vec<(String, String)>,
    /// The time, whatever the text says.
    pub time: Option<f64>,
    /// Where to look.
    pub domain: DomainChoice,
    /// What to cut away.
    pub clip: ClipChoice,
    /// From where to look, until somebody turns the view.
    pub choice: CameraChoice,
    /// From where to look, if somebody did.
    pub orbit: Option<Orbit>,
    /// Whether there are axes around it.
    pub axes: Axes,
    /// The size of the fine picture and how it is made.
    pub settings: Settings,
}

impl Request {
    /// What reading the document depends on beside its text.
    pub(super) fn options(&self) -> Options<'_> {
        Options { overrides: &self.overrides, time: self.time, ..Options::default() }
    }

    /// Lets the text say what these names are, not what was given for them on the command line.
    pub(super) fn forget_given(&mut self, names: &[String]) {
        self.overrides.retain(|(other, _)| !names.contains(other));
        if names.iter().any(|name| name == TIME) {
            self.time = None;
        }
    }

    /// The document that is asked for.
    ///
    /// # Errors
    /// What is wrong with its text or values.
    pub fn read(&self) -> Result<Document, Errors> {
        zeroset_syntax::read(&self.text, &self.options())
    }
}

/// A finished picture, and all that it was made with.
pub struct Rendering {
    /// Number of the request, counted from 1.
    pub revision: u64,
    /// What it asked for.
    pub request: Arc<Request>,
    /// The document as read.
    pub document: Arc<Document>,
    /// Its surfaces, compiled.
    pub model: Arc<Model>,
    /// What was found if the domain was searched for.
    pub searched: Option<AutoDomain>,
    /// What the view is relative to: the domain when the formula was first seen, however its
    /// parameters have moved since.
    pub seat: Region,
    /// From where it was taken.
    pub camera: Camera,
    /// Why nothing is seen, if nothing is.
    pub blank: Option<Blank>,
    /// The picture; a coarse one has fewer pixels than were asked for, or all of them but some that
    /// are still open.
    pub picture: Picture,
    /// Whether a finer one is still to come.
    pub coarse: bool,
    /// Time taken by reading, if it was done for this request; the other stages' times are in the
    /// picture.
    pub parse: Duration,
    /// Time from the request to this picture.
    pub latency: Duration,
}

impl<'a> From<&'a Rendering> for Shown<'a> {
    fn from(rendering: &'a Rendering) -> Self {
        let (camera, picture) = (&rendering.camera, &rendering.picture);
        Self { camera, region: rendering.model.region(), picture }
    }
}

impl Rendering {
    /// Whether it has all of the pixels that were asked for.
    pub fn is_full(&self) -> bool {
        let (buffer, asked) = (&self.picture.buffer, &self.request.settings);
        (buffer.width, buffer.height) == (asked.width, asked.height)
    }
}

/// Why there is no picture of the latest request.
#[derive(Debug)]
pub struct Fault {
    /// Number of the request.
    pub revision: u64,
    /// What it asked for.
    pub request: Arc<Request>,
    reason: Reason,
}

#[derive(Debug)]
enum Reason {
    Text(Errors),
    Scene(SceneError),
    Bug,
}

impl<E: Into<SceneError>> From<E> for Reason {
    fn from(error: E) -> Self {
        Self::Scene(error.into())
    }
}

impl Fault {
    /// What is wrong, on one line.
    pub fn message(&self) -> String {
        match &self.reason {
            Reason::Text(errors) => {
                errors.iter().next().map(|error| error.message()).unwrap_or_default()
            }
            Reason::Scene(error) => error.to_string(),
            Reason::Bug => "internal error: this is a bug in zeroset, not in your formula".into(),
        }
    }

    /// The one letter that lacks a value, if that is all that is wrong.
    pub fn missing_letter(&self) -> Option<char> {
        match &self.reason {
            Reason::Text(errors) => missing_letter(errors),
            Reason::Scene(_) | Reason::Bug => None,
        }
    }

    /// What is wrong, with carets under the text where it is the text's fault.
    pub fn render(&self, color: bool) -> String {
        match &self.reason {
            Reason::Text(errors) => {
                let Request { source, text, .. } = &*self.request;
                errors.render(Some(&source.to_string()), text, color)
            }
            Reason::Scene(_) | Reason::Bug => format!("error: {}", self.message()),
        }
    }
}

/// What can be seen now.
#[derive(Clone, Default)]
pub struct Snapshot {
    /// The last good picture.
    pub rendering: Option<Arc<Rendering>>,
    /// What is wrong with the latest request, if something is.
    pub fault: Option<Arc<Fault>>,
    /// The latest request of which no more is to come.
    pub settled: u64,
}

/// The thread that makes pictures.
pub(super) struct Pipeline {
    shared: Arc<Shared>,
    worker: Option<JoinHandle<()>>,
}

struct Shared {
    state: Mutex<State>,
    changed: Condvar,
}

struct State {
    request: Arc<Request>,
    revision: u64,
    requested: Instant,
    snapshot: Snapshot,
    /// Whether a hand or the clock moves a value, while which a view that nobody chose stays.
    moving: bool,
    /// Where that view is to go.
    next_view: NextView,
    stop: bool,
}

/// Where a view goes that nobody chose.
#[derive(Clone, Copy, PartialEq, Eq)]
enum NextView {
    /// To what is asked for, at once: who types waits for a picture.
    Unmoved,
    /// It would be another by now, but stays as long as a value is moved.
    Outgrown,
    /// It is seen to go there, now that none is.
    Glides,
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        // Every write leaves the state whole, so a panic elsewhere does not spoil it.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Pipeline {
    /// Starts the thread; nothing is done before the first request.
    pub fn new(request: Request) -> Self {
        let state = State {
            request: Arc::new(request),
            revision: 0,
            requested: Instant::now(),
            snapshot: Snapshot::default(),
            moving: false,
            next_view: NextView::Unmoved,
            stop: false,
        };
        let shared = Arc::new(Shared { state: Mutex::new(state), changed: Condvar::new() });
        let worker = Worker::new(Arc::clone(&shared));
        Self { shared, worker: Some(std::thread::spawn(move || worker.run())) }
    }

    /// Asks for a picture in place of all asked for before, and returns the request's number.
    pub fn request(&self, request: Request) -> u64 {
        let mut state = self.shared.lock();
        state.request = Arc::new(request);
        state.revision += 1;
        state.requested = Instant::now();
        self.shared.changed.notify_all();
        state.revision
    }

    /// Says whether a value is being moved, and tells whether another view is due now that none is.
    pub fn set_moving(&self, moving: bool) -> bool {
        let mut state = self.shared.lock();
        state.moving = moving;
        let is_due = !moving && state.next_view == NextView::Outgrown;
        if is_due {
            state.next_view = NextView::Glides;
        }
        is_due
    }

    /// What can be seen now.
    pub fn snapshot(&self) -> Snapshot {
        self.shared.lock().snapshot.clone()
    }

    /// Waits until `done` holds of what can be seen and of the latest request's number, and tells
    /// whether it came to that in time.
    pub fn wait(&self, timeout: Duration, done: impl Fn(&Snapshot, u64) -> bool) -> bool {
        let state = self.shared.lock();
        let waiting = |state: &mut State| !done(&state.snapshot, state.revision);
        let waited = self.shared.changed.wait_timeout_while(state, timeout, waiting);
        !waited.unwrap_or_else(PoisonError::into_inner).1.timed_out()
    }
}

impl Drop for Pipeline {
    fn drop(&mut self) {
        self.shared.lock().stop = true;
        self.shared.changed.notify_all();
        if let Some(worker) = self.worker.take() {
            // A panic has been reported where it happened.
            let _ = worker.join();
        }
    }
}

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

/// Whether both ask for the same text with the same values.
pub(super) fn same_document(one: &Request, other: &Request) -> bool {
    one.text == other.text && one.overrides == other.overrides && one.time == other.time
}
