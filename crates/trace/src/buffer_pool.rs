//! Pools of memory that pictures leave to later pictures, and bands to later bands.
//!
//! Getting new pages from the system takes several times as long as filling them, and longer than
//! all other work on a background pixel. A pool keeps only buffers that a caller hands back.

use std::sync::{Mutex, MutexGuard, PoisonError};

/// Number of pictures whose memory is kept. One is traced while the last one is shown; a layer
/// exists beside the picture that it is merged into.
pub const PICTURES: usize = 2;

/// A buffer with more than this many times the wanted capacity is too large, unless it has few
/// elements.
const ROOMY: usize = 4;
const LEAST: usize = 1 << 12;

/// Returns whether a buffer of capacity `room` serves for `wanted` elements. One that is far too
/// large is given back to the system, so that a large picture does not hold memory while small ones
/// follow.
pub fn serves(room: usize, wanted: usize) -> bool {
    (wanted..=ROOMY * wanted.max(LEAST)).contains(&room)
}

/// A pool of buffers of one type.
pub struct BufferPool<T> {
    kept: Mutex<Vec<T>>,
    /// Largest number of buffers kept.
    most: usize,
}

impl<T> BufferPool<T> {
    /// A pool that keeps at most `most` buffers.
    pub const fn new(most: usize) -> Self {
        Self { kept: Mutex::new(Vec::new()), most }
    }

    /// Takes the buffer that was handed back last.
    pub fn take(&self) -> Option<T> {
        self.lock().pop()
    }

    /// Keeps the buffer, unless enough are kept.
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
