//! Small pictures of the gallery, made one after the other on a thread of their own while somebody
//! looks, and kept. Whatever else is drawn goes first.

use crate::render::beautiful;
use crate::session::{Session, lock};
use crate::stage::stage;
use rayon::ThreadPoolBuilder;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::{JoinHandle, sleep, spawn};
use std::time::Duration;
use zeroset_render::picture::Settings;
use zeroset_scene::gallery::{Example, examples};

/// Rows and columns of a picture, for letters whose dots are pixels.
pub const SIDE: usize = 96;
/// The first picture has so many times fewer.
const COARSE: usize = 4;
/// While another picture is made this is looked at so often.
const LOOK: Duration = Duration::from_millis(4);

/// A square picture, as sRGB bytes.
pub struct Thumbnail {
    pub side: usize,
    pub rgb: Vec<u8>,
}

/// The small pictures, by the place of their surfaces in the gallery.
pub struct Thumbnails {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

struct Shared {
    examples: Vec<Example>,
    pictures: Mutex<Vec<Option<Arc<Thumbnail>>>>,
    /// Places in the gallery, those first that are looked at.
    order: Mutex<Vec<usize>>,
    /// Counts the pictures that were made, coarse or not.
    version: AtomicU64,
    wanted: AtomicBool,
    side: usize,
}

impl Thumbnails {
    /// None yet; each is to have so many times [`SIDE`] rows and columns.
    pub fn new(scale: usize) -> Self {
        let examples = examples();
        let pictures = Mutex::new(vec![None; examples.len()]);
        let shared = Shared {
            examples,
            pictures,
            order: Mutex::default(),
            version: AtomicU64::new(0),
            wanted: AtomicBool::new(false),
            side: SIDE * scale,
        };
        Self { shared: Arc::new(shared), thread: None }
    }

    pub fn examples(&self) -> &[Example] {
        &self.shared.examples
    }

    /// The picture of the surface at this place, as far as it was made.
    pub fn picture(&self, place: usize) -> Option<Arc<Thumbnail>> {
        lock(&self.shared.pictures).get(place)?.clone()
    }

    /// Another number whenever there is another picture.
    pub fn version(&self) -> u64 {
        self.shared.version.load(Ordering::Relaxed)
    }

    /// Makes those that are missing, these places first. To be asked for as long as they are looked
    /// at.
    pub fn want(&mut self, first: Vec<usize>, session: &Arc<Session>) {
        *lock(&self.shared.order) = first;
        // One that was told to end does so soon, and then this is asked again.
        if self.thread.as_ref().is_some_and(|thread| !thread.is_finished()) {
            return;
        }
        if self.shared.next().is_some() {
            self.shared.wanted.store(true, Ordering::Relaxed);
            let (shared, session) = (Arc::clone(&self.shared), Arc::clone(session));
            self.thread = Some(spawn(move || shared.make(&session)));
        }
    }

    /// Makes no more; what is there is kept.
    pub fn leave(&self) {
        self.shared.wanted.store(false, Ordering::Relaxed);
    }

    /// The same, and waits for the end of what was begun.
    pub fn stop(&mut self) {
        self.leave();
        if let Some(thread) = self.thread.take() {
            // A panic has been reported where it happened.
            let _ = thread.join();
        }
    }
}

impl Shared {
    /// The place of the next surface that lacks its picture.
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
        // Waits where a picture is being made that somebody asked for.
        let wanted = || {
            while self.wanted.load(Ordering::Relaxed) && !session.live.is_settled() {
                sleep(LOOK);
            }
            self.wanted.load(Ordering::Relaxed)
        };
        // One thread, so that there is one left for whatever else is drawn.
        let Ok(pool) = ThreadPoolBuilder::new().num_threads(1).build() else { return };
        while let Some(place) = self.next().filter(|_| wanted()) {
            let made = pool.install(|| self.picture(&self.examples[place], place, &wanted));
            if made.is_err() && wanted() {
                // What cannot be drawn is not tried again.
                self.keep(place, self.side, vec![0xff; 3 * self.side * self.side]);
            }
        }
    }

    /// A coarse picture, and then the whole one.
    fn picture(
        &self,
        example: &Example,
        place: usize,
        wanted: &(dyn Fn() -> bool + Sync),
    ) -> anyhow::Result<()> {
        let sized =
            |side| Settings { width: side, height: side, ..beautiful(&Settings::default()) };
        let Some((model, camera)) = stage(example, &sized(self.side), wanted)? else {
            return Ok(());
        };
        for side in [self.side / COARSE, self.side] {
            let picture = model.trace(&camera, &sized(side), &|_| wanted())?;
            if !wanted() {
                return Ok(());
            }
            self.keep(place, side, picture.rgb);
        }
        Ok(())
    }

    fn keep(&self, place: usize, side: usize, rgb: Vec<u8>) {
        lock(&self.pictures)[place] = Some(Arc::new(Thumbnail { side, rgb }));
        self.version.fetch_add(1, Ordering::Relaxed);
    }
}
