//! The worker thread, and what it reuses from one request to the next.

use super::pace::Pace;
use super::{
    Fault, FaultReason, PipelineState, Rendering, Request, Shared, domain_hysteresis, same_document,
};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, PoisonError, Weak};
use std::time::{Duration, Instant};
use zeroset_parser::Errors;
use zeroset_render::model::Model;
use zeroset_render::picture::{Picture, Settings};
use zeroset_render::progress::{Done, Progress};
use zeroset_scene::blank::Blank;
use zeroset_scene::camera::CameraChoice;
use zeroset_scene::domain::AutoDomain;
use zeroset_scene::program::Program;
use zeroset_scene::view::{self, SceneError};
use zeroset_space::{Camera, Region};
use zeroset_syntax::Document;
use zeroset_trace::{Proves, TraceOptions};

/// Least depth of a coarse picture. The depth is the number of halvings along a ray.
const LEAST_DEPTH: u32 = 6;

/// State of the worker, with results of earlier requests that the next may reuse.
pub(super) struct Worker {
    pub shared: Arc<Shared>,
    /// The last request whose document was read, and the document.
    read: Option<(Arc<Request>, Arc<Document>)>,
    built: Option<CachedModel>,
    /// Program of the last search for a region, reused in the next search.
    search: Option<Program>,
    pub framed: Option<FittedCamera>,
    /// The regions at the ends of the range of the slider that the clock moves, with the number of
    /// its formula and its name.
    whole: Option<(Option<u64>, String, Vec<Region>)>,
    /// Number of different formulas so far. The next formula gets the number after it.
    formulas: u64,
    pub pace: Pace,
    /// The request of the last complete picture.
    finished: Option<Arc<Request>>,
}

/// A model, and the request and document it was built from.
struct CachedModel {
    request: Arc<Request>,
    document: Arc<Document>,
    made: AnchoredModel,
}

/// A model, its automatic domain, and the region that views are relative to.
#[derive(Clone)]
pub(super) struct AnchoredModel {
    pub model: Arc<Model>,
    searched: Option<AutoDomain>,
    pub view_anchor: Region,
    /// Number that identifies the formula. It stays the same when only parameter values change.
    pub formula: u64,
}

/// A fitted camera, and the model and settings it was fitted to.
pub(super) struct FittedCamera {
    /// The model, unless it has been freed.
    pub model: Weak<Model>,
    pub region: Region,
    /// Number that identifies the formula, as in [`AnchoredModel`].
    pub formula: u64,
    pub key: FitKey,
    pub camera: Camera,
    /// Set once the camera has reached its fitted position.
    pub arrived: bool,
}

/// Settings that a fitted camera depends on.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct FitKey {
    pub choice: CameraChoice,
    pub size: (usize, usize),
    pub axes: bool,
}

/// Data shared by all pictures of a request.
pub(super) struct JobContext<'a> {
    pub job: &'a Job,
    pub document: &'a Arc<Document>,
    pub made: &'a AnchoredModel,
    parse: Duration,
}

impl JobContext<'_> {
    pub fn rendering(&self, camera: Camera, picture: Picture, coarse: bool) -> Rendering {
        let Self { job, parse, .. } = *self;
        let AnchoredModel { ref model, searched, view_anchor, .. } = *self.made;
        let undefined = picture.undefined;
        let mut rendering = Rendering {
            revision: job.revision,
            request: Arc::clone(&job.request),
            document: Arc::clone(self.document),
            model: Arc::clone(model),
            searched,
            view_anchor,
            camera,
            blank: None,
            picture,
            coarse,
            parse,
            latency: job.requested.elapsed(),
        };
        if !coarse && rendering.shows_nothing() {
            let blank = Blank::find(self.document, model.region(), undefined, searched);
            rendering.blank = Some(blank);
        }
        rendering
    }
}

/// A request that is being processed.
pub(super) struct Job {
    pub request: Arc<Request>,
    revision: u64,
    pub requested: Instant,
}

impl Shared {
    /// Returns whether this request is still the latest.
    pub fn wanted(&self, job: &Job) -> bool {
        self.lock().is_wanted(job)
    }

    /// Counts more work on a request's picture. Returns whether the request is still the latest.
    fn advance(&self, job: &Job, done: Done) -> bool {
        let mut state = self.lock();
        state.progress = Progress::after(state.progress, done);
        state.is_wanted(job)
    }

    /// Sets the stage that a late picture's status names.
    pub fn begin(&self, stage: &'static str) {
        let mut state = self.lock();
        (state.stage, state.progress) = (stage, None);
    }

    /// Begins to count the pixels of a picture that are traced, once per visible surface.
    fn begin_pixels(&self, model: &Model, pixels: usize) {
        let pixels = pixels * model.visible_surfaces().count();
        self.lock().progress = Some(Progress::tracing(pixels));
    }
}

impl PipelineState {
    fn is_wanted(&self, job: &Job) -> bool {
        !self.stop && self.revision == job.revision && self.given_up != job.revision
    }
}

impl Worker {
    pub fn new(shared: Arc<Shared>) -> Self {
        let (read, built, search, framed, finished) = (None, None, None, None, None);
        let (pace, formulas, whole) = (Pace::default(), 0, None);
        Self { shared, read, built, search, framed, whole, formulas, pace, finished }
    }

    pub fn run(mut self) {
        let mut done = 0;
        while let Some(job) = self.next(done) {
            done = job.revision;
            let served = catch_unwind(AssertUnwindSafe(|| self.serve(&job)));
            let served = served.unwrap_or_else(|_| {
                // A panic may leave the worker's state inconsistent.
                self = Self::new(Arc::clone(&self.shared));
                Err(FaultReason::Bug)
            });
            if let Err(reason) = served {
                let is_text = matches!(reason, FaultReason::Text(_));
                self.report(&job, reason);
                if is_text {
                    self.redraw_shown(&job);
                }
            }
            let mut state = self.shared.lock();
            if state.revision == done {
                state.snapshot.settled = done;
            }
            self.shared.changed.notify_all();
        }
    }

    /// Publishes the error of a request.
    fn report(&self, job: &Job, reason: FaultReason) {
        let request = Arc::clone(&job.request);
        let fault = Fault { revision: job.revision, request, reason };
        self.shared.lock().snapshot.fault = Some(Arc::new(fault));
        self.shared.changed.notify_all();
    }

    /// Draws the beginning of a typed line that could be read, or else the shown document again,
    /// with the settings of a request whose text has errors.
    fn redraw_shown(&mut self, job: &Job) {
        if let Some(text) = job.request.preview.clone() {
            let request = Request { text, ..(*job.request).clone() };
            if matches!(self.redraw(job, request), Ok(())) {
                return;
            }
        }
        let Some(CachedModel { request: shown, .. }) = &self.built else { return };
        let Request { source, text, overrides, time, .. } = (**shown).clone();
        let request = Request { source, text, overrides, time, ..(*job.request).clone() };
        // Ignore errors here, since the error in the new text is already reported.
        let _reported = self.redraw(job, request);
    }

    /// Draws another request in place of that of `job`.
    fn redraw(&mut self, job: &Job, request: Request) -> Result<(), FaultReason> {
        let job = Job { request: Arc::new(request), ..*job };
        if self.finished.as_ref() == Some(&job.request) {
            return Ok(());
        }
        catch_unwind(AssertUnwindSafe(|| self.serve(&job))).unwrap_or_else(|_| {
            *self = Self::new(Arc::clone(&self.shared));
            Err(FaultReason::Bug)
        })
    }

    /// Waits for a request with another revision than `done`. `None` once the worker should stop.
    fn next(&self, done: u64) -> Option<Job> {
        let waiting = |state: &mut PipelineState| !state.stop && state.revision == done;
        let state = self.shared.changed.wait_while(self.shared.lock(), waiting);
        let state = state.unwrap_or_else(PoisonError::into_inner);
        let PipelineState { request, revision, requested, .. } = &*state;
        let job = Job { request: Arc::clone(request), revision: *revision, requested: *requested };
        (!state.stop).then_some(job)
    }

    /// Draws the pictures of a request. Stops early when there is a newer request.
    fn serve(&mut self, job: &Job) -> Result<(), FaultReason> {
        let started = Instant::now();
        self.shared.begin("reading");
        let document = self.document(&job.request).map_err(FaultReason::Text)?;
        let parse = started.elapsed();
        if !self.shared.wanted(job) {
            return Ok(());
        }
        self.shared.begin("compiling");
        let Some(made) = self.model(job, &document)? else { return Ok(()) };
        self.shared.begin("tracing");
        let context = JobContext { job, document: &document, made: &made, parse };
        let Some(camera) = self.camera(&context)? else { return Ok(()) };
        let full = &job.request.settings;
        if let Some(seen) = self.relightable(&made.model, &camera, full) {
            return self.relight(job, &seen);
        }
        let size = full.width * full.height;
        let mut scale = self.pace.first(size);
        loop {
            let is_full = scale <= 1.0;
            let settings = coarser(full, scale).plain();
            let started = Instant::now();
            // While the document stays, finish a coarse picture even if the camera moves on.
            // Otherwise the user would not see the movement.
            let advance =
                |done| self.shared.advance(job, done) || !is_full && self.is_coarse_wanted(job);
            self.shared.begin_pixels(&made.model, settings.width * settings.height);
            let picture = made.model.trace(&camera, &settings, &advance)?;
            if !advance(Done::NOTHING) {
                return Ok(());
            }
            self.pace.learn(settings.width * settings.height, is_full, started.elapsed());
            let is_settled = is_full && picture.left_open() == 0;
            let rendering = Arc::new(context.rendering(camera, picture, !is_settled));
            self.publish(Arc::clone(&rendering));
            // The first picture needed its kernels soon; the next ones need them fast.
            self.shared.begin("compiling");
            if !made.model.optimize(&|| self.shared.wanted(job)) {
                return Ok(());
            }
            if is_full {
                return self.finish(&context, rendering);
            }
            scale = self.pace.next(scale, size);
        }
    }

    /// Traces the pixels that the preview left undecided, then applies the requested light.
    fn finish(
        &mut self,
        context: &JobContext<'_>,
        mut seen: Arc<Rendering>,
    ) -> Result<(), FaultReason> {
        let (job, full) = (context.job, &context.job.request.settings);
        let plain = full.plain();
        if seen.coarse {
            let advance = |done| self.shared.advance(job, done);
            let model = &context.made.model;
            self.shared.begin_pixels(model, seen.picture.left_open());
            let picture = model.settle(&seen.picture, &seen.camera, &plain, &advance)?;
            let Some(picture) = picture.filter(|_| self.shared.wanted(job)) else { return Ok(()) };
            seen = Arc::new(context.rendering(seen.camera, picture, false));
            self.publish(Arc::clone(&seen));
        }
        if *full != plain {
            return self.relight(job, &seen);
        }
        self.finished = Some(Arc::clone(&job.request));
        Ok(())
    }

    /// Returns the visible full picture, if the request changes nothing but its light.
    fn relightable(
        &self,
        model: &Arc<Model>,
        camera: &Camera,
        settings: &Settings,
    ) -> Option<Arc<Rendering>> {
        let seen = self.shared.lock().snapshot.rendering.clone()?;
        let is_alike = !seen.coarse
            && Arc::ptr_eq(&seen.model, model)
            && seen.camera == *camera
            && seen.request.settings.painted_as(settings) == *settings;
        is_alike.then_some(seen)
    }

    /// Draws a full picture again in the requested light, unless a newer request exists.
    fn relight(&mut self, job: &Job, plain: &Rendering) -> Result<(), FaultReason> {
        let (settings, advance) = (&job.request.settings, |done| self.shared.advance(job, done));
        if !self.shared.wanted(job) {
            return Ok(());
        }
        self.shared.begin("lighting");
        let Rendering { model, camera, .. } = plain;
        let picture = model.relight(&plain.picture, camera, settings, &advance)?;
        if self.shared.wanted(job) {
            let (document, model) = (Arc::clone(&plain.document), Arc::clone(model));
            let (request, revision) = (Arc::clone(&job.request), job.revision);
            let latency = job.requested.elapsed();
            let lit = Rendering { revision, request, document, model, picture, latency, ..*plain };
            self.publish(Arc::new(lit));
            self.finished = Some(Arc::clone(&job.request));
        }
        Ok(())
    }

    /// Makes a picture the visible one. The beginning of a typed line that shows nothing leaves the
    /// picture before it.
    pub fn publish(&self, rendering: Arc<Rendering>) {
        let mut state = self.shared.lock();
        if rendering.request.preview.is_some()
            && rendering.shows_nothing()
            && state.snapshot.rendering.is_some()
        {
            state.snapshot.fault.take_if(|fault| fault.revision != rendering.revision);
            self.shared.changed.notify_all();
            return;
        }
        let before = state.snapshot.rendering.replace(rendering);
        let revision = state.snapshot.rendering.as_ref().map(|rendering| rendering.revision);
        // If this request has a fault, keep the fault: the picture shows an earlier text.
        state.snapshot.fault.take_if(|fault| Some(fault.revision) != revision);
        self.shared.changed.notify_all();
        drop(state);
        // Dropping the last reference to a model frees its code, which needs no lock.
        if let Some(before) = before.and_then(Arc::into_inner) {
            before.picture.hand_back();
        }
    }

    /// Waits for this time, or until there is another request.
    pub fn rest(&self, job: &Job, time: Duration) {
        let waiting = |state: &mut PipelineState| {
            !state.stop && state.revision == job.revision && state.given_up != job.revision
        };
        let state = self.shared.lock();
        // The caller checks whether the request is still wanted, so ignore why the wait ended.
        drop(self.shared.changed.wait_timeout_while(state, time, waiting));
    }

    fn is_coarse_wanted(&self, job: &Job) -> bool {
        let state = self.shared.lock();
        !state.stop
            && state.given_up != job.revision
            && (state.revision == job.revision || same_document(&state.request, &job.request))
    }

    fn document(&mut self, request: &Arc<Request>) -> Result<Arc<Document>, Errors> {
        if let Some((old, document)) = &self.read
            && same_document(old, request)
        {
            return Ok(Arc::clone(document));
        }
        let document = Arc::new(request.read()?);
        self.read = Some((Arc::clone(request), Arc::clone(&document)));
        Ok(document)
    }

    /// The compiled model, reused if possible. `None` if a newer request interrupts.
    fn model(
        &mut self,
        job: &Job,
        document: &Arc<Document>,
    ) -> Result<Option<AnchoredModel>, SceneError> {
        let request = &job.request;
        let last = self.built.take();
        let old = last.as_ref().filter(|built| {
            built.request.domain == request.domain
                && built.request.settings.normals == request.settings.normals
                && built.request.settings.options.precision == request.settings.options.precision
        });
        let same = old.filter(|built| {
            Arc::ptr_eq(&built.document, document) && built.request.clip == request.clip
        });
        let made = match same {
            Some(built) => Ok(Some(built.made.clone())),
            None => self.made(job, document, old),
        };
        self.built = match &made {
            Ok(Some(made)) => Some(CachedModel {
                request: Arc::clone(request),
                document: Arc::clone(document),
                made: made.clone(),
            }),
            Ok(None) | Err(_) => last,
        };
        made
    }

    /// Makes the model, from the `old` one if possible. `None` if a newer request interrupts.
    fn made(
        &mut self,
        job: &Job,
        document: &Arc<Document>,
        old: Option<&CachedModel>,
    ) -> Result<Option<AnchoredModel>, SceneError> {
        let Request { domain, clip, settings, .. } = &*job.request;
        // While the domain stays, the code also serves other parameter values.
        let same = old.filter(|built| {
            built.document.domain == document.domain
                && (built.made.searched.is_none() || view::same_search(&built.document, document))
        });
        if let Some(CachedModel { made, .. }) = same {
            let clip = clip.or(view::typed_clip(document));
            let region = domain_hysteresis::clipped(made.model.region(), clip)?;
            if let Some(model) = made.model.rebound(document, &region) {
                return Ok(Some(AnchoredModel { model: Arc::new(model?), ..*made }));
            }
        }
        let Self { shared, search, whole, .. } = self;
        let wanted = || shared.wanted(job);
        let found = view::region_while(search, document, *domain, Some(*clip), &wanted)?;
        let Some((found, searched)) = found.filter(|_| wanted()) else { return Ok(None) };
        let old = old.map(|built| &built.made);
        let known = old.filter(|made| made.model.program().serves(document));
        let formula = known.map(|made| made.formula);
        let old = old.filter(|made| made.searched.is_some() && searched.is_some());
        // For the same formula, the region changes rarely, so the surface is seen to grow.
        let moved = old.filter(|_| formula.is_some());
        let mut region = moved.map_or(Ok(found), |made| {
            domain_hysteresis::next_region(made.model.region(), &found)
        })?;
        let played = shared.lock().played.clone();
        if let (Some(name), Some(_)) = (played, searched) {
            let ends = match whole.take().filter(|whole| whole.0 == formula && whole.1 == name) {
                Some((.., ends)) => ends,
                None => domain_hysteresis::ends(document, &name, *domain, search, &wanted),
            };
            if !wanted() {
                return Ok(None);
            }
            region = domain_hysteresis::with_ends(&region, &ends)?;
            *whole = Some((formula, name, ends));
        }
        let rebound = moved.and_then(|made| made.model.rebound(document, &region));
        let model = if let Some(model) = rebound {
            Some(model?)
        } else {
            let code_region = match searched {
                Some(_) => {
                    domain_hysteresis::code_region(&region, document, *domain, search, &wanted)
                }
                None => region,
            };
            Model::new_while(document, &region, &code_region, settings, &wanted)?
        };
        let Some(model) = model else { return Ok(None) };
        if !model.is_rebound() {
            self.pace = Pace::default();
        }
        let view_anchor = moved.map_or(region, |made| made.view_anchor);
        let formula = formula.unwrap_or_else(|| {
            self.formulas += 1;
            self.formulas
        });
        Ok(Some(AnchoredModel { model: Arc::new(model), searched, view_anchor, formula }))
    }
}

/// Settings of a picture reduced by `scale` in width and height, with a depth reduced to match.
/// Rays that are slow to decide stay undecided until a later picture.
pub(super) fn coarser(full: &Settings, scale: f64) -> Settings {
    let depth = full.options.depth.saturating_sub(scale.log2() as u32).max(LEAST_DEPTH);
    let fewer = |size: usize| ((size as f64 / scale).ceil() as usize).clamp(1, size);
    Settings {
        options: TraceOptions { depth: depth.min(full.options.depth), ..full.options },
        width: fewer(full.width),
        height: fewer(full.height),
        is_preview: full.method.proves == Proves::HitsAndMisses,
        ..full.clone()
    }
}
