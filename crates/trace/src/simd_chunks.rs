//! Sixteen lanes in vectors of whatever width the processor has.

use fearless_simd::prelude::*;
use std::marker::PhantomData;
use zeroset_eval::LANES;

/// As many of sixteen lanes as a vector holds.
#[derive(Clone, Copy)]
pub(crate) struct Chunk<S, V> {
    simd: S,
    first: usize,
    vector: PhantomData<V>,
}

/// The first lanes of sixteen, part by part.
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
    /// The number in all lanes.
    #[inline(always)]
    pub fn splat(self, number: V::Element) -> V {
        V::splat(self.simd, number)
    }

    /// What is in these lanes.
    #[inline(always)]
    pub fn load(self, all: &[V::Element; LANES]) -> V {
        V::from_slice(self.simd, &all[self.first..self.first + V::LEN])
    }

    /// Writes these lanes.
    #[inline(always)]
    pub fn store(self, vector: V, all: &mut [V::Element; LANES]) {
        vector.store_slice(&mut all[self.first..self.first + V::LEN]);
    }

    /// The mask of these lanes that is set where bits among all sixteen are.
    #[inline(always)]
    pub fn mask(self, bits: u16) -> V::Mask {
        V::Mask::from_bitmask(self.simd, u64::from(bits >> self.first))
    }

    /// The lanes in which a mask is set, as bits among all sixteen.
    #[inline(always)]
    pub fn bits(self, mask: V::Mask) -> u16 {
        (mask.to_bitmask() as u16) << self.first
    }
}
