//! Memory that pictures leave to the next ones.
//!
//! To get new pages from the system takes several times as long as to fill them, and longer than all else that is done about
//! a pixel of the background. Nothing is kept but what a caller hands back.

use std::sync::{Mutex, MutexGuard, PoisonError};

/// What is kept at most: a picture is traced while the last one is shown, and a layer beside what it is merged into.
const MOST: usize = 2;

/// Room for so many times what is wanted is far too large, but for what is small anyway.
const ROOMY: usize = 4;
const LEAST: usize = 1 << 12;

/// Memory of one kind, until the end of the process.
pub(crate) struct Spares<T>(Mutex<Vec<T>>);

impl<T> Spares<T> {
    pub const fn new() -> Self {
        Self(Mutex::new(Vec::new()))
    }

    /// What was handed back last, if its room serves for so much; what is far too large is given back to the system, so that
    /// a large picture leaves nothing behind once small ones follow.
    pub fn take(&self, wanted: usize, room: impl FnOnce(&T) -> usize) -> Option<T> {
        let serves = |room: usize| (wanted..=ROOMY * wanted.max(LEAST)).contains(&room);
        self.lock().pop().filter(|spare| serves(room(spare)))
    }

    /// Keeps this, unless enough is kept.
    pub fn hand_back(&self, spare: T) {
        let mut spares = self.lock();
        if spares.len() < MOST {
            spares.push(spare);
        }
    }

    fn lock(&self) -> MutexGuard<'_, Vec<T>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
