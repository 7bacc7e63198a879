//! Pools of memory that pictures leave to later pictures, and bands to later bands.
//!
//! Getting new pages from the system takes several times as long as filling them, and longer than
//! all other work on a background pixel. A pool keeps only buffers that a caller hands back.

use std::sync::{Mutex, MutexGuard, PoisonError};

/// Number of pictures whose memory is kept. Two exist at a time: one is traced while the last one
/// is shown, or a layer is merged into another picture.
pub const PICTURES: usize = 2;

/// A buffer is too large if its capacity is more than this many times the wanted one, and more than
/// this many times `LEAST` elements.
const ROOMY: usize = 4;
const LEAST: usize = 1 << 12;

/// Returns whether a buffer of capacity `room` serves for `wanted` elements. A buffer that is far
/// too large does not, so that it is freed: a large picture shall not hold memory while small ones
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
