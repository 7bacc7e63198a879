//! The worker thread that turns the latest request into pictures. It reads the text, compiles it,
//! and draws a coarse and then a fine picture.
//!
//! A new request interrupts the previous one between tiles. The result of a stage is reused until
//! something it depends on changes. Pictures and models are reference-counted, so a kernel is freed
//! with its last user.

mod domain_hysteresis;
mod glide;
mod pace;
mod view;
mod worker;

use self::worker::Worker;
use super::orbit::Orbit;
use super::source::DocumentSource;
use super::values::TIME;
use std::fmt;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use zeroset_parser::{ErrorKind, Errors};
use zeroset_render::model::Model;
use zeroset_render::overlay::PictureView;
use zeroset_render::picture::{Picture, Settings};
use zeroset_render::progress::Progress;
use zeroset_scene::blank::Blank;
use zeroset_scene::camera::CameraChoice;
use zeroset_scene::domain::AutoDomain;
use zeroset_scene::view::{ClipChoice, DomainChoice, SceneError};
use zeroset_space::{Camera, Region};
use zeroset_syntax::{Document, Options, statement};

/// Choice of axes around the region's box. With axes, an automatic view shows the whole box.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Axes {
    /// Axes are hidden.
    #[default]
    Off,
    /// Axes are shown.
    On,
    /// Axes are shown unless the document turns them off.
    Usual,
}

impl Axes {
    /// Returns whether axes are shown with this document.
    pub fn are_shown(self, document: &Document) -> bool {
        match self {
            Self::Off => false,
            Self::On => true,
            Self::Usual => document.picture.choices.axes != Some(false),
        }
    }
}

/// All inputs of a picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Request {
    /// Source of the document.
    pub source: DocumentSource,
    /// Text of the document.
    pub text: Arc<str>,
    /// For a document with a line that is being typed: the latest such text that could be read. It
    /// is drawn while the text has errors. A picture of such a document that shows nothing does not
    /// replace the picture before it.
    pub preview: Option<Arc<str>>,
    /// Names and values of parameters. They override the values in the text.
    pub overrides: Vec<(String, String)>,
    /// The time `t`, which overrides the value in the text.
    pub time: Option<f64>,
    /// Choice of the region.
    pub domain: DomainChoice,
    /// Choice of the clipping plane.
    pub clip: ClipChoice,
    /// Choice of the camera while `orbit` is `None`.
    pub choice: CameraChoice,
    /// The camera, once the user has turned the view.
    pub orbit: Option<Orbit>,
    /// Choice of the axes.
    pub axes: Axes,
    /// Size and quality of the fine picture.
    pub settings: Settings,
}

impl Request {
    /// Options for reading the document.
    pub(super) fn options(&self) -> Options<'_> {
        Options { overrides: &self.overrides, time: self.time, ..Options::default() }
    }

    /// Drops the overrides of these names, so that the text defines them.
    pub(super) fn forget_given(&mut self, names: &[String]) {
        self.overrides.retain(|(other, _)| !names.contains(other));
        if names.iter().any(|name| name == TIME) {
            self.time = None;
        }
    }

    /// Reads the document.
    ///
    /// # Errors
    /// If its text or values have errors.
    pub fn read(&self) -> Result<Document, Errors> {
        zeroset_syntax::read(&self.text, &self.options())
    }
}

/// A picture and everything it was drawn from.
pub struct Rendering {
    /// Revision of the request; the first is 1.
    pub revision: u64,
    /// The request.
    pub request: Arc<Request>,
    /// The document as read.
    pub document: Arc<Document>,
    /// The document's compiled surfaces.
    pub model: Arc<Model>,
    /// The automatic domain, if the region was searched for.
    pub searched: Option<AutoDomain>,
    /// The region that views are relative to. It is the region of the formula's first picture, and
    /// stays when parameters change.
    pub view_anchor: Region,
    /// Camera of the picture.
    pub camera: Camera,
    /// Why the picture is blank, if it is.
    pub blank: Option<Blank>,
    /// The picture. A coarse one has fewer pixels than requested, or leaves some pixels undecided
    /// that a finer picture decides.
    pub picture: Picture,
    /// Set if a finer picture follows.
    pub coarse: bool,
    /// Time to read the document; close to 0 if reused. The picture has the times of later stages.
    pub parse: Duration,
    /// Time from the request to this picture.
    pub latency: Duration,
}

impl<'a> From<&'a Rendering> for PictureView<'a> {
    fn from(rendering: &'a Rendering) -> Self {
        Self::of(&rendering.model, &rendering.camera, &rendering.picture)
    }
}

impl Rendering {
    /// Returns whether nothing is drawn in the picture.
    pub(super) fn shows_nothing(&self) -> bool {
        let pixels = self.picture.statistics.pixels;
        pixels.hit + pixels.undecided == 0 && self.model.curves().is_empty()
    }

    /// Returns whether the picture has all the requested pixels.
    pub fn is_full(&self) -> bool {
        let (buffer, asked) = (&self.picture.buffer, &self.request.settings);
        (buffer.width, buffer.height) == (asked.width, asked.height)
    }
}

/// An error: why the latest request has no picture.
#[derive(Debug)]
pub struct Fault {
    /// Revision of the request.
    pub revision: u64,
    /// The request.
    pub request: Arc<Request>,
    reason: FaultReason,
}

#[derive(Debug)]
enum FaultReason {
    Text(Errors),
    Scene(SceneError),
    Bug,
}

impl<E: Into<SceneError>> From<E> for FaultReason {
    fn from(error: E) -> Self {
        Self::Scene(error.into())
    }
}

impl Fault {
    /// The error on one line.
    pub fn message(&self) -> String {
        match &self.reason {
            FaultReason::Text(errors) => {
                errors.iter().next().map(|error| error.message()).unwrap_or_default()
            }
            FaultReason::Scene(error) => error.to_string(),
            FaultReason::Bug => {
                "internal error: this is a bug in zeroset, not in your formula".into()
            }
        }
    }

    /// The advice on the error, if there is any, in one line.
    pub fn advice(&self) -> Option<String> {
        let FaultReason::Text(errors) = &self.reason else { return None };
        errors.iter().next()?.help(&self.request.text)
    }

    /// The line to write in place of the statement with the error, if the advice gives one, and the
    /// statement as it was typed.
    pub fn correction(&self) -> Option<(&str, &str)> {
        let FaultReason::Text(errors) = &self.reason else { return None };
        let error = errors.iter().next()?;
        let typed = self.request.text.get(statement(&self.request.text, error.span))?;
        Some((typed, error.correction.as_deref()?))
    }

    /// The undefined single letter, if no other error exists.
    pub fn missing_letter(&self) -> Option<char> {
        match &self.reason {
            FaultReason::Text(errors) => missing_letter(errors),
            FaultReason::Scene(_) | FaultReason::Bug => None,
        }
    }

    /// The error message, with carets under the text if the text is at fault.
    pub fn render(&self, color: bool) -> String {
        match &self.reason {
            FaultReason::Text(errors) => {
                let Request { source, text, .. } = &*self.request;
                errors.render(Some(&source.to_string()), text, color)
            }
            FaultReason::Scene(_) | FaultReason::Bug => format!("error: {}", self.message()),
        }
    }
}

/// The latest results of the worker.
#[derive(Clone, Default)]
pub struct Snapshot {
    /// The latest picture.
    pub rendering: Option<Arc<Rendering>>,
    /// The error of the latest request, if it has one.
    pub fault: Option<Arc<Fault>>,
    /// Revision of the latest finished request.
    pub settled: u64,
    /// The work on the latest request, if its picture is late.
    pub working: Option<Working>,
}

/// The worker's stage as the status line says it, with its finished share if that is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Working {
    stage: &'static str,
    percent: Option<usize>,
}

impl fmt::Display for Working {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.stage)?;
        self.percent.map_or(Ok(()), |percent| write!(f, " {percent} %"))
    }
}

/// A picture is late after this time. Without an earlier picture it is late at once.
const LATE: Duration = Duration::from_millis(400);

/// The worker thread and the state shared with it.
pub(super) struct Pipeline {
    shared: Arc<Shared>,
    worker: Option<JoinHandle<()>>,
}

struct Shared {
    state: Mutex<PipelineState>,
    changed: Condvar,
}

struct PipelineState {
    request: Arc<Request>,
    revision: u64,
    requested: Instant,
    snapshot: Snapshot,
    /// The worker's present stage.
    stage: &'static str,
    /// The finished share of the present picture. `None` before its pixels are traced.
    progress: Option<Progress>,
    /// Revision of the last request that was given up before its picture was finished.
    given_up: u64,
    /// Set while the user or the clock moves values. Meanwhile an automatic view holds still.
    moving: bool,
    /// Name of the slider that the clock moves.
    played: Option<String>,
    /// The next change of an automatic view.
    next_view: NextView,
    stop: bool,
}

/// How an automatic view changes.
#[derive(Clone, Copy, PartialEq, Eq)]
enum NextView {
    /// Immediately, since the user waits for the picture.
    Immediate,
    /// Later. The view should change, but values are still moving.
    Deferred,
    /// By gliding, since values have stopped.
    Gliding,
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, PipelineState> {
        // Each write leaves the state consistent, so it is usable even after a panic elsewhere.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Pipeline {
    /// Starts the worker. It waits for the first request.
    pub fn new(request: Request) -> Self {
        let state = PipelineState {
            request: Arc::new(request),
            revision: 0,
            requested: Instant::now(),
            snapshot: Snapshot::default(),
            stage: "",
            progress: None,
            given_up: 0,
            moving: false,
            played: None,
            next_view: NextView::Immediate,
            stop: false,
        };
        let shared = Arc::new(Shared { state: Mutex::new(state), changed: Condvar::new() });
        let worker = Worker::new(Arc::clone(&shared));
        Self { shared, worker: Some(std::thread::spawn(move || worker.run())) }
    }

    /// Requests a picture, replacing all earlier requests. Returns the new revision.
    pub fn request(&self, request: Request) -> u64 {
        let mut state = self.shared.lock();
        state.request = Arc::new(request);
        state.revision += 1;
        state.requested = Instant::now();
        self.shared.changed.notify_all();
        state.revision
    }

    /// Sets whether values are moving. Returns whether a deferred change of the view is due.
    pub fn set_moving(&self, moving: bool) -> bool {
        let mut state = self.shared.lock();
        state.moving = moving;
        let is_due = !moving && state.next_view == NextView::Deferred;
        if is_due {
            state.next_view = NextView::Gliding;
        }
        is_due
    }

    /// Sets the name of the slider that the clock moves.
    pub fn set_played(&self, name: Option<&str>) {
        let mut state = self.shared.lock();
        if state.played.as_deref() != name {
            state.played = name.map(str::to_owned);
        }
    }

    /// The current results.
    pub fn snapshot(&self) -> Snapshot {
        let state = self.shared.lock();
        let is_late = state.snapshot.rendering.is_none() || state.requested.elapsed() > LATE;
        let is_working = is_late && state.snapshot.settled < state.revision;
        let working = is_working.then(|| match &state.progress {
            Some(now) => Working { stage: now.stage, percent: Some(now.percent()) },
            None => Working { stage: state.stage, percent: None },
        });
        Snapshot { working, ..state.snapshot.clone() }
    }

    /// Gives up the latest request. Returns false if it is finished.
    pub fn give_up(&self) -> bool {
        let mut state = self.shared.lock();
        let is_working = state.snapshot.settled < state.revision;
        if is_working {
            state.given_up = state.revision;
            self.shared.changed.notify_all();
        }
        is_working
    }

    /// Waits until `done` returns true for the results and the latest revision. Returns false on
    /// timeout.
    pub fn wait(&self, timeout: Duration, done: impl Fn(&Snapshot, u64) -> bool) -> bool {
        let state = self.shared.lock();
        let waiting = |state: &mut PipelineState| !done(&state.snapshot, state.revision);
        let waited = self.shared.changed.wait_timeout_while(state, timeout, waiting);
        !waited.unwrap_or_else(PoisonError::into_inner).1.timed_out()
    }
}

impl Drop for Pipeline {
    fn drop(&mut self) {
        self.shared.lock().stop = true;
        self.shared.changed.notify_all();
        if let Some(worker) = self.worker.take() {
            // A panic of the worker has already been reported.
            let _ = worker.join();
        }
    }
}

/// The undefined single letter, if no other error exists.
pub(super) fn missing_letter(errors: &Errors) -> Option<char> {
    let letter = |error: &zeroset_parser::Error| match &error.kind {
        ErrorKind::UnknownName { name, letter } => {
            let mut letters = name.chars();
            letter.or(letters.next().filter(|_| letters.next().is_none()))
        }
        _ => None,
    };
    let first = letter(errors.iter().next()?)?;
    errors.iter().all(|error| letter(error) == Some(first)).then_some(first)
}

/// Returns whether both requests have the same text, overrides and time.
pub(super) fn same_document(one: &Request, other: &Request) -> bool {
    one.text == other.text && one.overrides == other.overrides && one.time == other.time
}
