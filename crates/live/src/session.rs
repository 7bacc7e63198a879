//! The live document and its picture, for all that types, drags and shows them. Knows no commands.

use super::draft::with_value;
use super::orbit::Orbit;
use super::pipeline::{Axes, Pipeline, Rendering, Request, Snapshot, same_document};
use super::reply::Refusal;
use super::source::DocumentSource;
use super::undo::{Checkpoint, Dragged, Gesture, Undo};
use super::values::right_side;
use std::mem;
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use zeroset_parser::Limits;
use zeroset_render::picture::Settings;
use zeroset_scene::camera::CameraChoice;
use zeroset_shade::UndecidedStyle;
use zeroset_syntax::parse;

/// A live document and its picture.
///
/// All methods may be called from any thread. The lock is held only briefly: reading and
/// simplifying run without it, so moving a value or the view never waits for them.
pub struct Live {
    state: Mutex<SessionState>,
    pipeline: Pipeline,
}

/// A postponed move of a value.
type Move = Box<dyn FnOnce(&Live) + Send>;

#[derive(Default)]
pub(super) struct SessionState {
    /// The current request, with the document as entered.
    pub request: Request,
    /// The text that is drawn: the document, or the document with the line that is being typed.
    pub shown: Arc<str>,
    /// Names defined by the line that is being typed.
    pub typed: Vec<String>,
    /// The latest drawn text, with a line that is being typed, that could be read.
    pub preview: Option<Arc<str>>,
    /// The last text that parsed. Edits start from it when a watched file stops parsing.
    pub readable: Arc<str>,
    /// The text as last loaded or saved.
    kept: Arc<str>,
    /// Values that have been dragged, with their definitions before the drag.
    pub dragged: Vec<Dragged>,
    pub undo: Undo,
    /// Number of edits that block moves of values at present.
    first: usize,
    /// The blocked moves. For each gesture, only the latest is kept.
    waiting: Vec<(Gesture, Move)>,
    revision: u64,
    /// Revision at which the document last became empty. Results up to this revision are not shown.
    cleared_at: u64,
}

impl SessionState {
    pub fn checkpoint(&self) -> Checkpoint {
        let Self { request, readable, dragged, .. } = self;
        Checkpoint {
            request: request.clone(),
            readable: Arc::clone(readable),
            dragged: dragged.clone(),
        }
    }

    /// Returns whether the document is unchanged since this checkpoint.
    fn has_same_document(&self, checkpoint: &Checkpoint) -> bool {
        same_document(&self.request, &checkpoint.request)
            && self.readable == checkpoint.readable
            && self.dragged == checkpoint.dragged
    }
}

impl Checkpoint {
    /// The dragged values whose definitions in `text` are the same as in this checkpoint's text.
    pub fn dragged_in(&self, text: &str) -> Vec<Dragged> {
        let side = |text, one: &Dragged| right_side(text, &one.name);
        let kept =
            self.dragged.iter().filter(|one| side(&self.request.text, one) == side(text, one));
        kept.cloned().collect()
    }
}

/// Blocks moves of values during an edit. When it is dropped, the waiting moves are applied.
struct MoveBlock<'a>(&'a Live);

impl<'a> MoveBlock<'a> {
    fn begin(live: &'a Live) -> Self {
        live.lock().first += 1;
        Self(live)
    }
}

impl Drop for MoveBlock<'_> {
    fn drop(&mut self) {
        loop {
            let mut state = self.0.lock();
            // New moves queue up behind the waiting ones, so that the latest is applied last.
            if state.first > 1 || state.waiting.is_empty() {
                state.first -= 1;
                return;
            }
            let (_, go_on) = state.waiting.remove(0);
            drop(state);
            go_on(self.0);
        }
    }
}

impl Live {
    /// Starts to draw a document. Its text may be empty.
    pub fn new(request: Request) -> Self {
        let text = || Arc::clone(&request.text);
        let state = SessionState {
            shown: text(),
            readable: text(),
            kept: text(),
            request: request.clone(),
            ..SessionState::default()
        };
        let live = Self { state: Mutex::new(state), pipeline: Pipeline::new(request) };
        live.refresh();
        live
    }

    pub(super) fn lock(&self) -> MutexGuard<'_, SessionState> {
        // Each write leaves the state consistent, so it is usable even after a panic elsewhere.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The picture and the error to show. Both are `None` while the document is empty.
    pub fn snapshot(&self) -> Snapshot {
        let cleared_at = self.lock().cleared_at;
        let Snapshot { rendering, fault, settled, working } = self.pipeline.snapshot();
        Snapshot {
            rendering: rendering.filter(|seen| seen.revision > cleared_at),
            fault: fault.filter(|fault| fault.revision > cleared_at),
            settled,
            working,
        }
    }

    /// Gives up the picture of the latest request. Returns false if it is finished.
    pub fn give_up(&self) -> bool {
        self.pipeline.give_up()
    }

    /// Waits until the latest request has its fine picture or an error. Returns false on timeout.
    pub fn wait(&self, timeout: Duration) -> bool {
        let revision = self.lock().revision;
        self.pipeline.wait(timeout, |seen, _| seen.settled >= revision)
    }

    /// Waits for the fine picture of the request with this revision. Returns `None` on timeout, on
    /// an error of the request, and after a newer request.
    pub fn finished(&self, revision: u64, timeout: Duration) -> Option<Arc<Rendering>> {
        self.pipeline.wait(timeout, |seen, latest| seen.settled >= revision || latest > revision);
        let Snapshot { rendering, fault, .. } = self.snapshot();
        let is_wrong = fault.is_some_and(|fault| fault.revision == revision);
        rendering.filter(|seen| seen.revision == revision && !seen.coarse && !is_wrong)
    }

    /// Waits for a picture or error newer than revision `known`. Returns false on timeout.
    pub fn wait_for_news(&self, timeout: Duration, known: u64) -> bool {
        self.pipeline.wait(timeout, |seen, _| {
            let rendering = seen.rendering.as_ref().map_or(0, |rendering| rendering.revision);
            rendering.max(seen.fault.as_ref().map_or(0, |fault| fault.revision)) > known
        })
    }

    /// Waits until a picture of the latest request has all its pixels. A finer picture may still
    /// decide some of them. Returns false on timeout.
    pub fn wait_for_full(&self, timeout: Duration) -> bool {
        let revision = self.lock().revision;
        self.pipeline.wait(timeout, |seen, _| {
            let seen = seen.rendering.as_ref();
            seen.is_some_and(|seen| seen.revision >= revision && seen.is_full())
        })
    }

    /// Sets whether the user or the clock is moving values. An automatic view holds still until
    /// they stop, and then glides to fit the surface.
    pub fn set_moving(&self, moving: bool) {
        if self.pipeline.set_moving(moving) {
            self.refresh();
        }
    }

    /// Sets the name of the slider that the clock moves, if there is one. The region then holds the
    /// surfaces at both ends of the slider's range, and the view fits it from the start.
    pub fn set_played(&self, name: Option<&str>) {
        self.pipeline.set_played(name);
    }

    /// Shows or hides the axes.
    pub fn set_axes(&self, axes: Axes) {
        self.change(|request| request.axes = axes);
    }

    /// Returns whether all requested pictures are finished.
    pub fn is_settled(&self) -> bool {
        let state = self.lock();
        self.pipeline.snapshot().settled == state.revision
    }

    /// Revision of the latest request.
    pub fn revision(&self) -> u64 {
        self.lock().revision
    }

    /// The current request, without the line being typed.
    pub fn request(&self) -> Request {
        self.lock().request.clone()
    }

    /// The document as entered so far.
    pub fn text(&self) -> String {
        self.lock().request.text.to_string()
    }

    /// The current picture settings.
    pub fn settings(&self) -> Settings {
        self.lock().request.settings.clone()
    }

    /// Runs `work` without the lock, since it may be slow, and applies its result. If the document
    /// has changed meanwhile, runs `work` again. From the third try on, moves of values are
    /// blocked.
    pub(super) fn change_after<W, R>(
        &self,
        work: impl Fn(&Checkpoint) -> Result<W, Refusal>,
        apply: impl FnOnce(&mut SessionState, W) -> R,
    ) -> Result<R, Refusal> {
        let mut tries = 0;
        let mut _first = None;
        loop {
            let checkpoint = self.lock().checkpoint();
            let result = work(&checkpoint)?;
            let mut state = self.lock();
            if state.has_same_document(&checkpoint) {
                return Ok(apply(&mut state, result));
            }
            drop(state);
            tries += 1;
            if tries == 2 {
                _first = Some(MoveBlock::begin(self));
            }
        }
    }

    /// Moves a value. While an edit blocks moves, queues the move and returns the default result.
    pub(super) fn move_value<R: Default>(
        &self,
        gesture: Gesture,
        go_on: impl FnOnce(&Self, Gesture) -> R + Send + 'static,
    ) -> R {
        let mut state = self.lock();
        if state.first == 0 {
            drop(state);
            return go_on(self, gesture);
        }
        state.waiting.retain(|(other, _)| *other != gesture);
        let later = gesture.clone();
        state.waiting.push((gesture, Box::new(move |live| drop(go_on(live, later)))));
        R::default()
    }

    /// Replaces the document by `text`. With `again`, `text` is a newer version of the same
    /// document. Then the view stays. Dragged values stay, too, if their definitions have not
    /// changed. A text that was typed or pasted is saved nowhere, and so counts as a change.
    pub fn load(&self, source: DocumentSource, text: &str, again: bool) {
        // A new document takes effect whether it can be read or not, so it is not read here.
        let is_readable = again && parse(text, &Limits::default()).is_ok();
        let given: Arc<str> = text.into();
        let merged = |checkpoint: &Checkpoint| {
            let mut dragged = checkpoint.dragged.clone();
            if !is_readable {
                return Ok((Some(Arc::clone(&given)), dragged));
            }
            dragged.retain(|one| {
                right_side(text, &one.name).map_or(String::new(), |(_, side)| side) == one.side
            });
            // The texts are equal right after the program itself has saved the document.
            let is_same = text.trim_end() == checkpoint.request.text.trim_end();
            let text = || with_dragged(text, &checkpoint.readable, &dragged).into();
            Ok(((!is_same).then(text), dragged))
        };
        let _never_refused = self.change_after(merged, |state, (text, dragged)| {
            let before = state.checkpoint();
            if source != DocumentSource::Typed || given.is_empty() {
                state.kept = Arc::clone(&given);
            }
            state.dragged = dragged;
            let Some(text) = text else { return };
            if is_readable || !again {
                state.readable = Arc::clone(&text);
            }
            state.typed.clear();
            let request = &mut state.request;
            request.source = source;
            request.text = Arc::clone(&text);
            if !again {
                *request = Request {
                    source: mem::take(&mut request.source),
                    text: Arc::clone(&text),
                    clip: request.clip,
                    axes: request.axes,
                    settings: request.settings.clone(),
                    ..Request::default()
                };
                state.dragged.clear();
            }
            state.shown = text;
            self.record(state, before, None);
        });
    }

    /// Deletes the whole document, with its region and view.
    pub fn clear(&self) {
        self.load(DocumentSource::Typed, "", false);
    }

    /// Records that the document was saved as `text` to the file at `path`.
    pub fn saved(&self, path: &Path, text: &str) {
        let mut state = self.lock();
        state.request.source = DocumentSource::File(path.to_owned());
        state.kept = text.into();
    }

    /// Returns whether the document differs from the text last loaded or saved.
    pub fn is_changed(&self) -> bool {
        let state = self.lock();
        state.kept.trim_end() != state.request.text.trim_end()
    }

    /// The number of lines, not counting lines that dragging a slider added. `None` if only dragged
    /// values differ from the text that was loaded or saved last.
    pub fn typed_lines(&self) -> Option<usize> {
        let state = self.lock();
        let text = state.request.text.trim_end();
        let is_typed = with_dragged(&state.kept, text, &state.dragged).trim_end() != text;
        let added = state.dragged.iter().filter(|one| one.side.is_empty()).count();
        is_typed.then(|| text.trim().lines().count().saturating_sub(added))
    }

    /// Requests pictures of this size, in pixels. Sizes below 1 count as 1.
    pub fn resize(&self, width: usize, height: usize) {
        let (width, height) = (width.max(1), height.max(1));
        let settings = self.settings();
        if (settings.width, settings.height) != (width, height) {
            self.change(|request| {
                (request.settings.width, request.settings.height) = (width, height);
            });
        }
    }

    /// Turns, moves or zooms the view. Does nothing before the first picture.
    pub fn turn(&self, turn: impl FnOnce(&mut Orbit)) {
        let Some(seen) = self.snapshot().rendering else { return };
        self.change_by(Some(Gesture::View), |request| {
            // Start from the requested orbit, which may be newer than that of the visible picture.
            let orbit = request
                .orbit
                .get_or_insert_with(|| Orbit::from_camera(&seen.camera, &seen.view_anchor));
            turn(orbit);
        });
    }

    /// Fits the whole region into the picture. The direction of the view stays. Does nothing before
    /// the first picture.
    pub fn fit(&self) {
        let Some(seen) = self.snapshot().rendering else { return };
        let Settings { width, height, .. } = self.settings();
        self.turn(|orbit| orbit.fit(seen.model.region(), &seen.view_anchor, width, height));
    }

    /// Returns to the view that the document sets.
    pub fn reset_view(&self) {
        self.change(|request| {
            request.orbit = None;
            request.choice = CameraChoice::default();
        });
    }

    /// Switches the marks of undecided pixels on or off.
    pub fn toggle_undecided(&self) {
        self.change(|request| {
            request.settings.undecided = match request.settings.undecided {
                UndecidedStyle::Shade | UndecidedStyle::Miss => UndecidedStyle::Hatch,
                UndecidedStyle::Hatch | UndecidedStyle::Tint => UndecidedStyle::Shade,
            };
        });
    }

    /// Requests the picture again under a new revision. [`Live::finished`] returns `None` for
    /// earlier revisions.
    pub fn refresh(&self) {
        self.change(|_| {});
    }

    /// Changes parts of the request other than its text.
    pub(super) fn change(&self, change: impl FnOnce(&mut Request)) {
        self.change_by(None, change);
    }

    /// Like [`Live::change`]. With a gesture, the change is part of the gesture's undo step.
    pub(super) fn change_by(&self, gesture: Option<Gesture>, change: impl FnOnce(&mut Request)) {
        let mut state = self.lock();
        let before = state.checkpoint();
        change(&mut state.request);
        self.record(&mut state, before, gesture);
    }

    /// Undoes the last step: a line, a setting, a turn or a drag. Returns whether there was a step.
    pub fn undo(&self) -> bool {
        self.step(Undo::back)
    }

    /// Redoes the last undone step. Returns whether there was a step.
    pub fn redo(&self) -> bool {
        self.step(Undo::forth)
    }

    /// Goes to the checkpoint that `step` returns. Returns false if it returns `None`.
    fn step(&self, step: impl FnOnce(&mut Undo, &Checkpoint) -> Option<Checkpoint>) -> bool {
        let mut state = self.lock();
        let now = state.checkpoint();
        let Some(checkpoint) = step(&mut state.undo, &now) else { return false };
        let text = Arc::clone(&checkpoint.request.text);
        (state.request, state.readable, state.dragged) =
            (checkpoint.request, checkpoint.readable, checkpoint.dragged);
        state.typed.clear();
        self.show(&mut state, text);
        true
    }

    /// Sets whether a mouse button is held. While it is held, all turning or dragging is one undo
    /// step.
    pub fn hold(&self, held: bool) {
        self.lock().undo.hold(held);
    }

    /// Requests a picture of the current state. Records the state `before` as an undo step.
    pub(super) fn record(
        &self,
        state: &mut SessionState,
        before: Checkpoint,
        gesture: Option<Gesture>,
    ) {
        let now = state.checkpoint();
        state.undo.note(before, &now, gesture);
        let shown = Arc::clone(&state.shown);
        self.show(state, shown);
    }

    /// Requests pictures of the text `shown`. An empty text clears the picture.
    pub(super) fn show(&self, state: &mut SessionState, shown: Arc<str>) {
        state.shown = shown;
        if state.shown.trim().is_empty() {
            state.cleared_at = state.revision;
            return;
        }
        let mut request = Request { text: Arc::clone(&state.shown), ..state.request.clone() };
        request.forget_given(&state.typed);
        // The error messages of a line that is being typed must not name the file.
        if state.shown == state.request.text {
            state.preview = None;
        } else {
            request.source = DocumentSource::Typed;
            let entered = || Arc::clone(&state.request.text);
            request.preview = Some(state.preview.clone().unwrap_or_else(entered));
        }
        state.revision = self.pipeline.request(request);
    }
}

/// Copies the value of each dragged parameter from the text `present` into `text`.
fn with_dragged(text: &str, present: &str, dragged: &[Dragged]) -> String {
    dragged.iter().fold(text.to_owned(), |text, one| {
        let moved = || {
            let (value, side) = right_side(present, &one.name)?;
            let (_, range) = side.split_once(" in ")?;
            with_value(&text, &one.name, &value, range)
        };
        moved().unwrap_or(text)
    })
}

#[cfg(test)]
mod tests {
    use super::super::slider::Slider;
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::thread;
    use std::time::Instant;

    const LIMIT: Duration = Duration::from_mins(1);

    const TEXT: &str = "domain 2\nr = 0 in [0, 9]\nx^2+y^2+z^2 = r";

    /// A sphere, and the slider of its size.
    fn ball() -> (Live, Slider) {
        let settings = Settings { width: 8, height: 8, ..Settings::default() };
        let live = Live::new(Request { text: TEXT.into(), settings, ..Request::default() });
        assert!(live.wait(LIMIT));
        let slider = live.snapshot().rendering.expect("a picture").sliders().remove(0);
        (live, slider)
    }

    /// Waits until `done` holds, and panics after [`LIMIT`].
    fn wait_until(done: impl Fn() -> bool) {
        let started = Instant::now();
        while !done() {
            assert!(started.elapsed() < LIMIT, "it waits");
            thread::sleep(Duration::from_millis(1));
        }
    }

    #[test]
    fn a_value_that_moves_all_the_time_waits_for_no_edit_nor_keeps_it_from_its_end() {
        let (live, slider) = ball();
        let live = Arc::new(live);
        let tries = AtomicUsize::new(0);
        let work = |checkpoint: &Checkpoint| {
            let value = tries.fetch_add(1, Ordering::Relaxed) as f64 + 1.0;
            // Move the value from another thread, like the window's event loop. It must never wait.
            let (live, slider) = (Arc::clone(&live), slider.clone());
            let moves = thread::spawn(move || {
                live.drag(&slider, value + 0.5);
                live.drag(&slider, value);
                live.turn(|orbit| orbit.turn(1.0, 1.0, 8));
            });
            wait_until(|| moves.is_finished());
            Ok(format!("{}\nz = 0", checkpoint.request.text))
        };
        let changed = live.change_after(work, |state, text| state.request.text = text.into());
        assert!(changed.is_ok());
        // During the first two tries, drags change the document. During the third, they are queued.
        assert_eq!(tries.into_inner(), 3);
        assert_eq!(live.text(), TEXT.replace("r = 0", "r = 3") + "\nz = 0");
        live.drag(&slider, 4.0);
        assert!(live.text().contains("r = 4"));
    }

    #[test]
    fn an_edit_that_is_refused_late_leaves_no_value_waiting() {
        let (live, slider) = ball();
        let tries = AtomicUsize::new(0);
        let work = |_: &Checkpoint| {
            let number = tries.fetch_add(1, Ordering::Relaxed) + 1;
            live.drag(&slider, number as f64);
            if number < 3 { Ok(()) } else { Err(Refusal::Command("no".to_owned())) }
        };
        assert!(live.change_after(work, |_, ()| ()).is_err());
        assert!(live.text().contains("r = 3"));
    }
}
