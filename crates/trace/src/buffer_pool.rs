//! Memory that pictures leave to the next ones, and bands to the next bands.
//!
//! To get new pages from the system takes several times as long as to fill them, and longer than
//! all else that is done about a pixel of the background. Nothing is kept but what a caller hands
//! back.

use std::sync::{Mutex, MutexGuard, PoisonError};

/// What is kept of pictures at most: one is traced while the last one is shown, and a layer beside
/// what it is merged into.
pub const PICTURES: usize = 2;

/// Room for so many times what is wanted is far too large, but for what is small anyway.
const ROOMY: usize = 4;
const LEAST: usize = 1 << 12;

/// Whether room serves for so much; what is far too large is given back to the system, so that a
/// large picture leaves nothing behind once small ones follow.
pub fn serves(room: usize, wanted: usize) -> bool {
    (wanted..=ROOMY * wanted.max(LEAST)).contains(&room)
}

/// Memory of one kind.
pub struct BufferPool<T> {
    kept: Mutex<Vec<T>>,
    /// How much of it is kept at most.
    most: usize,
}

impl<T> BufferPool<T> {
    /// A pool that keeps at most `most` buffers.
    pub const fn new(most: usize) -> Self {
        Self { kept: Mutex::new(Vec::new()), most }
    }

    /// What was handed back last.
    pub fn take(&self) -> Option<T> {
        self.lock().pop()
    }

    /// Keeps this, unless enough is kept.
    pub fn hand_back(&self, spare: T) {
        let mut spares = self.lock();
        if spares.len() < self.most {
            spares.push(spare);
        }
    }

    fn lock(&self) -> MutexGuard<'_, Vec<T>> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
