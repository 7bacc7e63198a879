//! Sixteen lanes, divided into vectors of the processor's width.

use fearless_simd::prelude::*;
use std::marker::PhantomData;
use zeroset_eval::LANES;

/// The lanes that one vector covers, among sixteen.
#[derive(Clone, Copy)]
pub(crate) struct Chunk<S, V> {
    simd: S,
    first: usize,
    vector: PhantomData<V>,
}

/// Divides the first `count` of sixteen lanes into vectors.
#[inline(always)]
pub(crate) fn parts<S: Simd, V: SimdBase<S>>(
    simd: S,
    count: usize,
) -> impl Iterator<Item = Chunk<S, V>> {
    (0..count.min(LANES)).step_by(V::LEN).map(
        #[inline(always)]
        move |first| Chunk { simd, first, vector: PhantomData },
    )
}

impl<S: Simd, V: SimdBase<S>> Chunk<S, V> {
    /// A vector with `number` in all of its lanes.
    #[inline(always)]
    pub fn splat(self, number: V::Element) -> V {
        V::splat(self.simd, number)
    }

    /// Loads the chunk's lanes of `all`.
    #[inline(always)]
    pub fn load(self, all: &[V::Element; LANES]) -> V {
        V::from_slice(self.simd, &all[self.first..self.first + V::LEN])
    }

    /// Stores a vector to the chunk's lanes of `all`.
    #[inline(always)]
    pub fn store(self, vector: V, all: &mut [V::Element; LANES]) {
        vector.store_slice(&mut all[self.first..self.first + V::LEN]);
    }

    /// The mask of the chunk's lanes, from bits for all sixteen lanes.
    #[inline(always)]
    pub fn mask(self, bits: u16) -> V::Mask {
        V::Mask::from_bitmask(self.simd, u64::from(bits >> self.first))
    }

    /// The set lanes of a mask of this chunk, as bits among all sixteen lanes.
    #[inline(always)]
    pub fn bits(self, mask: V::Mask) -> u16 {
        (mask.to_bitmask() as u16) << self.first
    }
}
