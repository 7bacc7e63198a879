//! One quantity of a batch: 16 lanes, whatever the width of a register.

use std::ops::{Deref, DerefMut};

/// Number of lanes in a batch.
pub const LANES: usize = 16;

/// One quantity of a batch, with a value per lane.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(64))]
pub struct Lanes<T>(pub [T; LANES]);

impl<T: Copy> Lanes<T> {
    /// Returns a quantity that has `value` in all lanes.
    pub fn splat(value: T) -> Self {
        Self([value; LANES])
    }
}

impl<T> Deref for Lanes<T> {
    type Target = [T; LANES];

    #[inline]
    fn deref(&self) -> &Self::Target {
        &self.0
    }
}

impl<T> DerefMut for Lanes<T> {
    #[inline]
    fn deref_mut(&mut self) -> &mut Self::Target {
        &mut self.0
    }
}

impl<T> AsRef<[Self]> for Lanes<T> {
    fn as_ref(&self) -> &[Self] {
        std::slice::from_ref(self)
    }
}

impl<T> AsMut<[Self]> for Lanes<T> {
    fn as_mut(&mut self) -> &mut [Self] {
        std::slice::from_mut(self)
    }
}
