//! Memory that the bands of a picture use one after another: to make it takes a few hundred allocations.

use super::level::Level;
use super::pool::Memory;
use super::tiles::SIDES;
use crate::scalar::Scalar;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// What a thread needs for a band.
#[derive(Default)]
pub(super) struct Room<T: Scalar> {
    pub levels: [Level<T>; SIDES.len()],
    pub memory: Memory<T>,
    /// [`Tracer::screens`](super::tiles::Tracer::screens).
    pub screens: [Vec<[f64; 4]>; 2],
}

/// The rooms that no thread is in.
pub(super) struct Rooms<T: Scalar>(Mutex<Vec<Box<Room<T>>>>);

impl<T: Scalar> Rooms<T> {
    pub fn new() -> Self {
        Self(Mutex::new(Vec::new()))
    }

    pub fn take(&self) -> Box<Room<T>> {
        let room = self.lock().pop();
        room.unwrap_or_default()
    }

    pub fn hand_back(&self, room: Box<Room<T>>) {
        self.lock().push(room);
    }

    fn lock(&self) -> MutexGuard<'_, Vec<Box<Room<T>>>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
