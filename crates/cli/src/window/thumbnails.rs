//! The gallery's small pictures. A thread renders them one after another while the gallery is open.
//! Finished pictures are kept when it closes. The session's own picture has priority.

use crate::render::with_effects;
use crate::session::{Session, lock};
use crate::stage::stage;
use rayon::ThreadPoolBuilder;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::{JoinHandle, sleep, spawn};
use std::time::Duration;
use zeroset_render::overlay::Canvas;
use zeroset_render::picture::Settings;
use zeroset_scene::gallery::{Example, surfaces};

/// Rows and columns of a small picture at scale 1.
pub const SIDE: usize = 96;
/// Factor by which the sides of a coarse picture are shorter than those of the full picture.
const COARSE_FACTOR: usize = 4;
/// Interval at which the thread checks whether the session's picture is finished.
const POLL_INTERVAL: Duration = Duration::from_millis(4);

/// A square picture, as sRGB bytes.
pub struct Thumbnail {
    pub side: usize,
    pub rgb: Vec<u8>,
}

/// The small pictures, by gallery index.
pub struct Thumbnails {
    shared: Arc<ThumbnailStore>,
    thread: Option<JoinHandle<()>>,
}

struct ThumbnailStore {
    examples: Vec<Example>,
    pictures: Mutex<Vec<Option<Arc<Thumbnail>>>>,
    /// Gallery indices of the surfaces that are rendered first.
    order: Mutex<Vec<usize>>,
    /// Number of pictures rendered so far, coarse or not.
    version: AtomicU64,
    wanted: AtomicBool,
    side: usize,
}

impl Thumbnails {
    /// Creates an empty store for pictures of `scale` times [`SIDE`] rows and columns.
    pub fn new(scale: f64) -> Self {
        let examples = surfaces();
        let pictures = Mutex::new(vec![None; examples.len()]);
        let shared = ThumbnailStore {
            examples,
            pictures,
            order: Mutex::default(),
            version: AtomicU64::new(0),
            wanted: AtomicBool::new(false),
            side: Canvas::dots_at(SIDE, scale),
        };
        Self { shared: Arc::new(shared), thread: None }
    }

    pub fn examples(&self) -> &[Example] {
        &self.shared.examples
    }

    /// Returns the picture of the surface with this gallery index, perhaps a coarse one.
    pub fn picture(&self, place: usize) -> Option<Arc<Thumbnail>> {
        lock(&self.shared.pictures).get(place)?.clone()
    }

    /// Returns a number that changes whenever a picture is rendered.
    pub fn version(&self) -> u64 {
        self.shared.version.load(Ordering::Relaxed)
    }

    /// Starts to render the missing pictures. The surfaces with the gallery indices `first` come
    /// first. Call this repeatedly while the gallery is visible.
    pub fn want(&mut self, first: Vec<usize>, session: &Arc<Session>) {
        *lock(&self.shared.order) = first;
        // A thread that has been told to stop may still run. A later call then starts another.
        if self.thread.as_ref().is_some_and(|thread| !thread.is_finished()) {
            return;
        }
        if self.shared.next().is_some() {
            self.shared.wanted.store(true, Ordering::Relaxed);
            let (shared, session) = (Arc::clone(&self.shared), Arc::clone(session));
            self.thread = Some(spawn(move || shared.make(&session)));
        }
    }

    /// Stops rendering; finished pictures are kept.
    pub fn leave(&self) {
        self.shared.wanted.store(false, Ordering::Relaxed);
    }

    /// Stops rendering, and waits until the thread has ended.
    pub fn stop(&mut self) {
        self.leave();
        if let Some(thread) = self.thread.take() {
            // The thread's panic has already been reported on standard error.
            let _ = thread.join();
        }
    }
}

impl ThumbnailStore {
    /// Returns the index of the next surface without a full picture.
    fn next(&self) -> Option<usize> {
        let (pictures, order) = (lock(&self.pictures), lock(&self.order));
        let is_missing = |place: &usize| {
            let picture = pictures.get(*place).and_then(Option::as_ref);
            picture.is_none_or(|picture| picture.side < self.side)
        };
        let mut all = order.iter().copied().chain(0..pictures.len());
        all.find(is_missing)
    }

    fn make(&self, session: &Session) {
        // Wait while a picture of the session is being rendered.
        let wanted = || {
            while self.wanted.load(Ordering::Relaxed) && !session.live.is_settled() {
                sleep(POLL_INTERVAL);
            }
            self.wanted.load(Ordering::Relaxed)
        };
        // Use one thread, and leave the others to the session.
        let Ok(pool) = ThreadPoolBuilder::new().num_threads(1).build() else { return };
        while let Some(place) = self.next().filter(|_| wanted()) {
            let made = pool.install(|| self.picture(&self.examples[place], place, &wanted));
            if made.is_err() && wanted() {
                // A surface that cannot be drawn gets a blank picture, so it is not tried again.
                self.keep(place, self.side, vec![0xff; 3 * self.side * self.side]);
            }
        }
    }

    /// Renders a coarse picture, and then the full one.
    fn picture(
        &self,
        example: &Example,
        place: usize,
        wanted: &(dyn Fn() -> bool + Sync),
    ) -> anyhow::Result<()> {
        let sized =
            |side| Settings { width: side, height: side, ..with_effects(&Settings::default()) };
        let Some((model, camera)) = stage(example, &sized(self.side), wanted)? else {
            return Ok(());
        };
        for side in [self.side / COARSE_FACTOR, self.side] {
            let picture = model.trace(&camera, &sized(side), &|_| wanted())?;
            if !wanted() {
                return Ok(());
            }
            self.keep(place, side, picture.opaque_rgb().into());
        }
        Ok(())
    }

    fn keep(&self, place: usize, side: usize, rgb: Vec<u8>) {
        lock(&self.pictures)[place] = Some(Arc::new(Thumbnail { side, rgb }));
        self.version.fetch_add(1, Ordering::Relaxed);
    }
}
