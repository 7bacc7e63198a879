//! From the latest request to pictures, on a thread of its own: read, compile, a coarse picture, a
//! fine one.
//!
//! A new request ends the work on the one before between tiles. What an older stage made is kept as
//! long as nothing that it depends on has changed. Pictures and what they were made with are shared
//! by counting, so that the last of them to use a kernel frees it.

use super::orbit::Orbit;
use crate::blank::Blank;
use crate::domain::AutoDomain;
use crate::framing;
use crate::model::Model;
use crate::picture::{Picture, Settings};
use crate::scene::{self, CameraChoice, DomainChoice, SceneError};
use glam::DVec3;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError, Weak};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use zeroset_syntax::{Document, Errors, Options};
use zeroset_trace::{Camera, HalfSpace, Region};

/// Everything that a picture depends on.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Request {
    /// What the text is called in messages.
    pub name: String,
    /// The document.
    pub text: Arc<str>,
    /// Names with values that replace those of the text.
    pub overrides: Vec<(String, String)>,
    /// The time, whatever the text says.
    pub time: Option<f64>,
    /// Where to look.
    pub domain: DomainChoice,
    /// What to cut away.
    pub clip: Option<HalfSpace>,
    /// From where to look, until somebody turns the view.
    pub choice: CameraChoice,
    /// From where to look, if somebody did.
    pub orbit: Option<Orbit>,
    /// The size of the fine picture and how it is made.
    pub settings: Settings,
}

impl Request {
    /// The document that is asked for.
    ///
    /// # Errors
    /// What is wrong with its text or values.
    pub fn read(&self) -> Result<Document, Errors> {
        let Self { text, overrides, time, .. } = self;
        zeroset_syntax::read(text, &Options { overrides, time: *time, ..Options::default() })
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
    /// From where it was taken.
    pub camera: Camera,
    /// Why nothing is seen, if nothing is.
    pub blank: Option<Blank>,
    /// The picture; a coarse one has fewer pixels than were asked for.
    pub picture: Picture,
    /// Whether a finer one is still to come.
    pub coarse: bool,
    /// Time taken by reading, if it was done for this request; the other stages' times are in the
    /// picture.
    pub parse: Duration,
    /// Time from the request to this picture.
    pub latency: Duration,
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

    /// What is wrong, with carets under the text where it is the text's fault.
    pub fn render(&self, color: bool) -> String {
        match &self.reason {
            Reason::Text(errors) => {
                errors.render(Some(&self.request.name), &self.request.text, color)
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
    stop: bool,
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
            stop: false,
        };
        let shared = Arc::new(Shared { state: Mutex::new(state), changed: Condvar::new() });
        let worker = Worker {
            shared: Arc::clone(&shared),
            read: None,
            built: None,
            framed: None,
            pixel: None,
        };
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

/// A coarse picture should take no longer than this.
const COARSE: Duration = Duration::from_millis(20);

/// If the fine picture is expected to take no longer than this, there is no coarse one.
const PROMPT: Duration = Duration::from_millis(30);

/// If the full picture is expected to take longer than this after a coarse one, there is one of
/// half the size between.
const PATIENCE: Duration = Duration::from_millis(150);

/// A coarse picture has so many times fewer columns and rows, at most; and so has that of a surface
/// whose cost is unknown.
const COARSEST: usize = 8;

/// A surface that takes less than this share of the domain found before gets one of its own.
const LEAST_SHARE: f64 = 0.25;

/// Halvings along the ray that a coarse picture keeps at least.
const LEAST_DEPTH: u32 = 6;

struct Worker {
    shared: Arc<Shared>,
    read: Option<Read>,
    built: Option<Built>,
    framed: Option<Framed>,
    /// Time per pixel of the present model's last picture.
    pixel: Option<Duration>,
}

/// A document, and the request for which it was read.
struct Read {
    request: Arc<Request>,
    document: Arc<Document>,
}

/// A model, and what it was made for.
struct Built {
    request: Arc<Request>,
    document: Arc<Document>,
    model: Arc<Model>,
    searched: Option<AutoDomain>,
}

/// A camera that was fitted, and to what.
struct Framed {
    /// It may be gone.
    model: Weak<Model>,
    region: Region,
    choice: CameraChoice,
    size: (usize, usize),
    camera: Camera,
}

/// A model, and what was found if its domain was searched for.
type Made = (Arc<Model>, Option<AutoDomain>);

/// A request being worked on.
struct Job {
    request: Arc<Request>,
    revision: u64,
    requested: Instant,
}

impl Worker {
    fn run(mut self) {
        let mut done = 0;
        while let Some(job) = self.next(done) {
            done = job.revision;
            let served = catch_unwind(AssertUnwindSafe(|| self.serve(&job)));
            let reason = served.unwrap_or_else(|_| {
                // Whatever was half made is not to be trusted.
                (self.read, self.built, self.framed) = (None, None, None);
                Err(Reason::Bug)
            });
            let mut state = self.shared.lock();
            if let Err(reason) = reason {
                let fault = Fault { revision: job.revision, request: job.request, reason };
                state.snapshot.fault = Some(Arc::new(fault));
            }
            if state.revision == done {
                state.snapshot.settled = done;
            }
            self.shared.changed.notify_all();
        }
    }

    /// Waits for a request after the one with this number; `None` at the end.
    fn next(&self, done: u64) -> Option<Job> {
        let waiting = |state: &mut State| !state.stop && state.revision == done;
        let state = self.shared.changed.wait_while(self.shared.lock(), waiting);
        let state = state.unwrap_or_else(PoisonError::into_inner);
        let State { request, revision, requested, .. } = &*state;
        let job = Job { request: Arc::clone(request), revision: *revision, requested: *requested };
        (!state.stop).then_some(job)
    }

    /// Makes the pictures of one request, or leaves off when there is a newer one.
    fn serve(&mut self, job: &Job) -> Result<(), Reason> {
        let started = Instant::now();
        let document = self.document(&job.request).map_err(Reason::Text)?;
        let parse = started.elapsed();
        if !self.wanted(job) {
            return Ok(());
        }
        let scene = |error: SceneError| Reason::Scene(error);
        let made = self.model(job, &document).map_err(scene)?;
        let Some((model, searched)) = made else { return Ok(()) };
        let region = model.region();
        let camera = match &job.request.orbit {
            Some(orbit) => orbit.camera(region).map(Some).map_err(SceneError::from),
            None => self.framed(job, &document, &model),
        };
        let Some(camera) = camera.map_err(scene)? else { return Ok(()) };
        let full = &job.request.settings;
        if let Some(seen) = self.seen_alike(&model, &camera, full) {
            return self.relight(job, &seen);
        }
        let mut divisor = coarsest(self.expected(full));
        loop {
            let coarse = divisor > 1;
            let settings = coarser(full, divisor);
            let started = Instant::now();
            // A coarse picture is worth finishing while only the camera moves: it is what is seen
            // of the movement.
            let advance = |_| if coarse { self.wanted_coarsely(job) } else { self.wanted(job) };
            let plain = settings.plain();
            let picture = model.trace(&camera, &plain, &advance);
            let picture = picture.map_err(|error| scene(error.into()))?;
            if !advance(0) {
                return Ok(());
            }
            let pixels = settings.width * settings.height;
            self.pixel = Some(started.elapsed() / pixels as u32);
            let pixels = picture.statistics.pixels;
            let blank = (!coarse && pixels.hit + pixels.undecided == 0)
                .then(|| Blank::find(&document, region, picture.undefined, searched));
            let rendering = Rendering {
                revision: job.revision,
                request: Arc::clone(&job.request),
                document: Arc::clone(&document),
                model: Arc::clone(&model),
                searched,
                camera,
                blank,
                picture,
                coarse,
                parse,
                latency: job.requested.elapsed(),
            };
            let rendering = Arc::new(rendering);
            self.publish(Arc::clone(&rendering));
            if !coarse {
                return if settings == plain { Ok(()) } else { self.relight(job, &rendering) };
            }
            divisor = finer(self.expected(full), divisor);
        }
    }

    /// The camera where nobody turned the view: fitted once for a model, and kept while only parameters move.
    fn framed(
        &mut self,
        job: &Job,
        document: &Document,
        model: &Arc<Model>,
    ) -> Result<Option<Camera>, SceneError> {
        let Request { choice, settings, .. } = &*job.request;
        let (width, height) = (settings.width, settings.height);
        let kept = self.framed.as_ref().filter(|framed| {
            framed.choice == *choice
                && framed.size == (width, height)
                && (std::ptr::eq(framed.model.as_ptr(), Arc::as_ptr(model))
                    || model.is_rebound() && framed.region == *model.region())
        });
        if let Some(framed) = kept {
            return Ok(Some(framed.camera));
        }
        let wanted = || self.wanted(job);
        let camera = framing::camera_while(model, document, choice, settings, &wanted)?;
        self.framed = camera.map(|camera| Framed {
            model: Arc::downgrade(model),
            region: *model.region(),
            choice: *choice,
            size: (width, height),
            camera,
        });
        Ok(camera)
    }

    /// The full picture that is shown, if it differs from what is asked for in nothing but its light.
    fn seen_alike(
        &self,
        model: &Arc<Model>,
        camera: &Camera,
        settings: &Settings,
    ) -> Option<Arc<Rendering>> {
        let seen = self.shared.lock().snapshot.rendering.clone()?;
        let is_alike = !seen.coarse
            && Arc::ptr_eq(&seen.model, model)
            && seen.camera == *camera
            && seen.request.settings.lit_as(settings) == *settings;
        is_alike.then_some(seen)
    }

    /// The full picture as it was asked for, once the plain one is shown and nothing newer is wanted.
    fn relight(&self, job: &Job, plain: &Rendering) -> Result<(), Reason> {
        let (settings, advance) = (&job.request.settings, |_| self.wanted(job));
        let Rendering { model, camera, .. } = plain;
        let lit = model.relight(&plain.picture, camera, settings, &advance);
        let picture = lit.map_err(|error| Reason::Scene(error.into()))?;
        if advance(0) {
            let (document, model) = (Arc::clone(&plain.document), Arc::clone(model));
            let (request, revision) = (Arc::clone(&job.request), job.revision);
            let latency = job.requested.elapsed();
            let lit = Rendering { revision, request, document, model, picture, latency, ..*plain };
            self.publish(Arc::new(lit));
        }
        Ok(())
    }

    fn publish(&self, rendering: Arc<Rendering>) {
        let mut state = self.shared.lock();
        let before = state.snapshot.rendering.replace(rendering);
        state.snapshot.fault = None;
        self.shared.changed.notify_all();
        drop(state);
        // The last user of a model frees its code; that need not be done under the lock.
        if let Some(before) = before.and_then(Arc::into_inner) {
            before.picture.hand_back();
        }
    }

    fn wanted(&self, job: &Job) -> bool {
        let state = self.shared.lock();
        !state.stop && state.revision == job.revision
    }

    fn wanted_coarsely(&self, job: &Job) -> bool {
        let state = self.shared.lock();
        !state.stop
            && (state.revision == job.revision || same_document(&state.request, &job.request))
    }

    fn document(&mut self, request: &Arc<Request>) -> Result<Arc<Document>, Errors> {
        if let Some(Read { request: old, document }) = &self.read
            && same_document(old, request)
        {
            return Ok(Arc::clone(document));
        }
        let document = Arc::new(request.read()?);
        self.read = Some(Read { request: Arc::clone(request), document: Arc::clone(&document) });
        Ok(document)
    }

    /// The surfaces compiled, or `None` if there is a newer request before that is done.
    fn model(&mut self, job: &Job, document: &Arc<Document>) -> Result<Option<Made>, SceneError> {
        let request = &job.request;
        let old = self.built.as_ref().filter(|built| {
            (built.request.domain, built.request.clip) == (request.domain, request.clip)
                && built.request.settings.normals == request.settings.normals
                && built.request.settings.precision == request.settings.precision
        });
        if let Some(built) = old
            && Arc::ptr_eq(&built.document, document)
        {
            return Ok(Some((Arc::clone(&built.model), built.searched)));
        }
        // Code holds for other values of parameters too, in the same region.
        let rebound = old.and_then(|built| {
            let same = built.document.domain == document.domain
                && built.document.picture.clip == document.picture.clip
                && (built.searched.is_none() || scene::same_search(&built.document, document));
            if same { Some((built.model.rebound(document)?, built.searched)) } else { None }
        });
        let (model, searched) = if let Some((model, searched)) = rebound {
            (Arc::new(model?), searched)
        } else {
            let wanted = || self.wanted(job);
            let found = scene::region_while(document, request.domain, request.clip, &wanted)?;
            let Some((region, searched)) = found.filter(|_| wanted()) else { return Ok(None) };
            let moved = old.filter(|built| searched.is_some() && built.searched.is_some());
            let moved = moved.and_then(|built| Some((built.model.rebound(document)?, built)));
            match moved {
                Some((model, built)) if is_room_enough(built.model.region(), &region) => {
                    (Arc::new(model?), searched)
                }
                moved => {
                    let before = moved.map(|(_, built)| built.model.region());
                    let region = before.map_or(region, |before| widened(before, &region));
                    let model = Model::new_while(document, &region, &request.settings, &wanted)?;
                    let Some(model) = model else { return Ok(None) };
                    self.pixel = None;
                    (Arc::new(model), searched)
                }
            }
        };
        self.built = Some(Built {
            request: Arc::clone(request),
            document: Arc::clone(document),
            model: Arc::clone(&model),
            searched,
        });
        Ok(Some((model, searched)))
    }

    /// How long the full picture will take, as far as the present model's cost is known.
    fn expected(&self, full: &Settings) -> Option<Duration> {
        self.pixel.map(|pixel| pixel * (full.width * full.height) as u32)
    }
}

/// How many times fewer columns and rows the first picture should have, if the full one is expected
/// to take so long.
fn coarsest(expected: Option<Duration>) -> usize {
    let Some(expected) = expected else { return COARSEST };
    if expected <= PROMPT {
        return 1;
    }
    let affordable = |divisor: &usize| expected / (divisor * divisor) as u32 <= COARSE;
    [2, 4].into_iter().find(affordable).unwrap_or(COARSEST)
}

/// The same of the picture after one with this divisor: where the full one is waited for, there is
/// one between, for a quarter of its time.
fn finer(expected: Option<Duration>, divisor: usize) -> usize {
    if divisor > 2 && expected.is_some_and(|expected| expected > PATIENCE) { 2 } else { 1 }
}

/// Whether a domain that was found for one value of a slider serves for another, for which `wanted` is found: then the
/// surface is seen to grow or to shrink, and nothing is compiled.
fn is_room_enough(region: &Region, wanted: &Region) -> bool {
    let is_inside =
        region.low().cmple(wanted.low()).all() && wanted.high().cmple(region.high()).all();
    let as_round = region.ball().is_some() == wanted.ball().is_some();
    is_inside && as_round && wanted.half_extent() >= LEAST_SHARE * region.half_extent()
}

/// A domain that serves for values beyond those that outgrew the one before, too.
fn widened(before: &Region, wanted: &Region) -> Region {
    let room = 0.25 * (wanted.high() - wanted.low());
    let low = DVec3::select(wanted.low().cmplt(before.low()), wanted.low() - room, wanted.low());
    let high =
        DVec3::select(wanted.high().cmpgt(before.high()), wanted.high() + room, wanted.high());
    let wider = Region::new(low, high).ok();
    let wider = wider.map(|box_| if wanted.ball().is_some() { box_.with_ball() } else { box_ });
    let cut = |wider: Region| match wanted.clip() {
        Some(clip) => wider.with_clip(clip).ok(),
        None => Some(wider),
    };
    wider.and_then(cut).unwrap_or(*wanted)
}

/// Whether both ask for the same text with the same values.
pub(super) fn same_document(one: &Request, other: &Request) -> bool {
    one.text == other.text && one.overrides == other.overrides && one.time == other.time
}

/// The same picture with fewer columns and rows, and slabs coarser to match.
fn coarser(full: &Settings, divisor: usize) -> Settings {
    let depth = full.max_depth.saturating_sub(divisor.ilog2()).max(LEAST_DEPTH);
    Settings {
        width: full.width.div_ceil(divisor),
        height: full.height.div_ceil(divisor),
        max_depth: depth.min(full.max_depth),
        ..full.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slower_pictures_come_in_more_steps() {
        let steps = |expected: u64| {
            let expected = Some(Duration::from_millis(expected));
            let mut steps = vec![coarsest(expected)];
            while steps.last() != Some(&1) {
                steps.push(finer(expected, *steps.last().expect("one")));
            }
            steps
        };
        assert_eq!(steps(30), [1]);
        assert_eq!(steps(60), [2, 1]);
        assert_eq!(steps(140), [4, 1]);
        assert_eq!(steps(300), [4, 2, 1]);
        assert_eq!(steps(9000), [8, 2, 1]);
        assert_eq!((coarsest(None), finer(None, 8)), (COARSEST, 1));
    }
}
