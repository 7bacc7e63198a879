//! Up to sixteen tiles at once: where they are, and what is still to be looked at of them.

use super::plane::Plane;
use super::screens::{Ends, Screens, ones, outward};
use super::slots::Stack;
use super::tiles::Tracer;
use crate::scalar::Scalar;
use fearless_simd::{dispatch, prelude::*};
use std::ops::Range;
use zeroset_eval::{LANES, Lanes, Planes, Tiles};

/// Up to sixteen tiles of one size, a lane each, and what is still to be looked at of them.
pub(super) struct Level<T: Scalar> {
    /// Whether all of the tiles' segments are in the region.
    pub within: bool,
    /// Lanes in use, from the first on.
    pub count: usize,
    pub places: [[usize; 2]; LANES],
    pub screens: Screens,
    pub stacks: [Stack<T>; LANES],
    pub batch: Tiles<T>,
    pub out: Planes<T>,
}

impl<T: Scalar> Level<T> {
    pub fn new(batch: Tiles<T>) -> Self {
        Self {
            within: false,
            count: 0,
            places: [[0; 2]; LANES],
            screens: Screens::default(),
            stacks: Default::default(),
            batch,
            out: Planes::default(),
        }
    }

    /// Takes those tiles of a level that are open, by their columns and rows in units of tiles: no more than there are lanes;
    /// each with what the form of the tile that they are parts of leaves of a segment. If they are `within` the region, they
    /// need not be clipped to it.
    pub fn start(
        &mut self,
        tracer: &Tracer<'_, '_, '_, T>,
        places: [Range<usize>; 2],
        level: usize,
        segment: [f64; 2],
        plane: Option<&Plane>,
        within: bool,
    ) {
        self.within = within;
        self.take(tracer, places, level);
        if self.count == 0 {
            return;
        }
        let mut asked = segment.map(Lanes::splat);
        if tracer.rays.is_patched() {
            for (slot, &place) in self.places[..self.count].iter().enumerate() {
                [asked[0][slot], asked[1][slot]] = tracer.from(place, segment);
            }
        }
        let left = dispatch!(tracer.vectors, simd => self.shorten(simd, tracer, &asked, plane));
        let all = std::mem::take(&mut self.count);
        for slot in ones(left & (u16::MAX >> (LANES - all))) {
            let stack = &mut self.stacks[self.count];
            stack.clear();
            stack.push([self.batch.near[slot], self.batch.far[slot]]);
            self.places[self.count] = self.places[slot];
            self.screens.copy(slot, self.count);
            self.count += 1;
        }
    }

    /// Finds out where the open ones of some tiles are.
    fn take(
        &mut self,
        tracer: &Tracer<'_, '_, '_, T>,
        [columns, rows]: [Range<usize>; 2],
        level: usize,
    ) {
        let mut across = [[0.0; 2]; LANES];
        for (extent, column) in across.iter_mut().zip(columns.clone()) {
            *extent = tracer.across(column, level);
        }
        self.count = 0;
        for row in rows {
            let upward = tracer.upward(row, level);
            if let Some(patch) = tracer.rays.patch(tracer.band.top + row) {
                across[0] = tracer.extent(0, patch.column, patch.column + 3);
            }
            for (extent, column) in across.iter().zip(columns.clone()) {
                if tracer.is_open([column, row], level) {
                    self.places[self.count] = [column, row];
                    for (axis, extent) in [extent, &upward].into_iter().enumerate() {
                        self.screens.centre[axis][self.count] = extent[0];
                        self.screens.half[axis][self.count] = extent[1];
                    }
                    self.count += 1;
                }
            }
        }
    }

    /// Puts what is left of segments into the batch; returns the lanes in which anything is.
    #[inline(always)]
    fn shorten<S: Simd>(
        &mut self,
        simd: S,
        tracer: &Tracer<'_, '_, '_, T>,
        asked: &Ends,
        plane: Option<&Plane>,
    ) -> u16 {
        let mut left = *asked;
        if let Some(plane) = plane {
            plane.narrow::<_, T>(simd, self.screens.rays(), &mut left);
        }
        if !self.within {
            tracer.frame.clip(simd, self.screens.rays(), tracer.method.region, &mut left);
        }
        let Tiles { near, far, .. } = &mut self.batch;
        outward(simd, asked, &left, tracer.size, [near, far])
    }

    /// Puts the tiles' places into the batch.
    #[inline(always)]
    pub fn place<S: Simd>(&mut self, simd: S, reach: [f64; 2]) {
        for (axis, reach) in reach.into_iter().enumerate() {
            let (Screens { centre, half }, batch) = (&self.screens, &mut self.batch);
            T::narrow(f64::wide(simd, &centre[axis]), &mut batch.centre[axis]);
            // The centre is rounded too, and so is this.
            let [low, high] = f64::wide(simd, &half[axis]);
            let reach = T::PATH_ERROR * reach;
            T::narrow([low + reach, high + reach], &mut batch.half[axis]);
        }
    }

    /// Takes the next segment of each tile; returns the lanes in which there is one, as bits.
    pub fn pop(&mut self) -> u16 {
        let mut asked = 0;
        for (slot, stack) in self.stacks[..self.count].iter_mut().enumerate() {
            if let Some([near, far]) = stack.pop() {
                (self.batch.near[slot], self.batch.far[slot]) = (near, far);
                asked |= 1 << slot;
            }
        }
        asked
    }

    /// Lets go of tiles of which nothing is left, where that saves a vector; returns whether others took their places.
    pub fn pack(&mut self) -> bool {
        let live = self.stacks[..self.count].iter().filter(|stack| !stack.is_empty()).count();
        let saves = live.div_ceil(4) < self.count.div_ceil(4);
        if saves {
            let all = std::mem::take(&mut self.count);
            for slot in 0..all {
                if !self.stacks[slot].is_empty() {
                    self.stacks.swap(self.count, slot);
                    self.places[self.count] = self.places[slot];
                    self.screens.copy(slot, self.count);
                    self.count += 1;
                }
            }
        }
        saves
    }
}
