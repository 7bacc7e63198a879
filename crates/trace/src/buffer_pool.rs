//! Pools of memory that finished pictures and bands leave to later ones.
//!
//! Getting new pages from the system takes several times as long as filling them, and longer than
//! all other work on a background pixel. A pool keeps only buffers that a caller hands back.

use std::sync::{Mutex, MutexGuard, PoisonError};

/// Number of pictures whose memory a pool keeps. Two pictures exist at a time: one is traced while
/// another is shown or merged.
pub const PICTURES: usize = 2;

/// A buffer is too large for a number of elements if its capacity is above `ROOMY` times that
/// number and above `ROOMY` times `LEAST`.
const ROOMY: usize = 4;
const LEAST: usize = 1 << 12;

/// Returns whether a buffer of capacity `room` serves for `wanted` elements. A far too large buffer
/// does not: the caller frees it, so that small pictures do not hold a large one's memory.
pub fn serves(room: usize, wanted: usize) -> bool {
    (wanted..=ROOMY * wanted.max(LEAST)).contains(&room)
}

/// A pool of buffers of one type.
pub struct BufferPool<T> {
    kept: Mutex<Vec<T>>,
    /// Largest number of buffers that the pool keeps.
    most: usize,
}

impl<T> BufferPool<T> {
    /// A pool that keeps at most `most` buffers.
    pub const fn new(most: usize) -> Self {
        Self { kept: Mutex::new(Vec::new()), most }
    }

    /// Takes the buffer that was handed back last; `None` if the pool is empty.
    pub fn take(&self) -> Option<T> {
        self.lock().pop()
    }

    /// Keeps the buffer, unless the pool is full.
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
