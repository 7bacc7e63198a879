//! Affine forms over tiles of rays, from large tiles to small ones, then along single rays.
//!
//! A tile's form is a linear function of its two screen axes and of depth, with an error bound.
//! Solved for depth, it narrows the segment in which the tile's rays may meet a zero. If the
//! coefficient of depth outweighs all other terms, the form proves a zero on every ray. Tiles of
//! 16×16 pixels are split into tiles of 4×4 pixels, and these into rays. The parts of a tile start
//! from its narrowed segment.
//!
//! If a form hardly narrows a tile's segment, the tile is split or the segment is cut in two. The
//! tile is split if that shortens the segments of its parts: the segment is short for the tile's
//! width, or the surface is steep. The nearer part of a cut segment is examined first.
//!
//! A hit is a segment on which the function is continuous and has opposite signs at the ends. The
//! ray is proven empty before it. Undecided segments are narrowed to the limit of precision. With
//! [`Precision::Auto`], `f64` is used if `f32` does not suffice.

mod bundle;
mod classify;
mod coverage;
mod frame;
mod level;
mod narrow;
mod part_tree;
mod parts;
mod pixels;
mod plane;
mod pool;
mod pooled;
mod rays;
mod screens;
#[cfg(test)]
mod tests;
mod tiles;
mod tracer;

use super::knoll;
use super::outcome::follow_in_region;
use crate::band::Band;
use crate::buffer_pool::BufferPool;
use crate::grid::RayGrid;
use crate::kernel_stats::KernelStats;
use crate::method::{Fallback, Method, Proves, Segment, Start, Task, Tracer, by_squares};
use crate::options::{self, Precision, TraceOptions};
use crate::ray_result::RayResult;
use crate::scalar::Scalar;
use frame::RayFrame;
use narrow::Scratch;
use part_tree::PartTree;
use parts::BandPass;
use rays::Follower;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use tiles::{BandBuffers, BandState};
use zeroset_eval::{ContractTiles, Kernel, KernelError};

pub(crate) const METHOD: Method = Method {
    name: "affine",
    help: "tiles and rays narrowed by affine forms; proves hits and misses",
    proves: Proves::HitsAndMisses,
    reads: &[
        options::PRECISION,
        options::TOLERANCE,
        options::NO_CONTRACT,
        options::NO_TILES,
        options::NO_INTERVALS,
    ],
    prepare: [prepare::<f32>, prepare::<f64>],
};

fn prepare<T: Scalar>(task: Task<'_>) -> Result<Box<dyn Tracer + '_>, KernelError> {
    Ok(Box::new(Affine::<T>::new(task)?))
}

/// Returns the row of `knoll`, the method that replaces this one.
fn knoll_row() -> &'static Method {
    Method::named(knoll::METHOD.name).unwrap_or_default()
}

struct Affine<'a, T: Scalar> {
    tiles: &'a dyn Kernel<ContractTiles, T>,
    follower: Follower<'a, T>,
    /// True if forms bound a numerator. A zero of the numerator need not be a zero of the function.
    cleared: bool,
    task: Task<'a>,
    /// Maximum length of a hit's bracket, in pixels: [`TraceOptions::longest`].
    longest: f64,
    /// Buffers that no thread is using.
    buffers: BufferPool<Box<BandBuffers<T>>>,
    /// The tree of parts of the latest picture.
    tree: Mutex<Option<Arc<PartTree>>>,
    /// This method in `f64`, created for the first picture that needs it.
    double: OnceLock<Option<Box<Affine<'a, f64>>>>,
}

/// Maximum error of a computed ray, as a share of the region's extent. Beyond it, `knoll` is used.
const MAX_RAY_ERROR: f64 = 1e-2;

/// If a hit's bracket must be shorter than this many times the resolution of `f32`, only `f64` is
/// used: `f32` cannot narrow segments that far.
const MIN_BRACKET: f64 = 16.0;

impl<'a, T: Scalar> Affine<'a, T> {
    fn new(task: Task<'a>) -> Result<Self, KernelError> {
        let kernels = T::kernels(task.surface);
        let follower = || Follower::new(task);
        let (tiles, follower) = if rayon::current_thread_index().is_some() {
            // The two kinds of kernels are compiled at the same time.
            rayon::join(|| kernels.tiles(), follower)
        } else {
            // The kernels are usually compiled already. Then a second thread would only cost time.
            (kernels.tiles(), follower())
        };
        Self::with_kernels(task, tiles?, follower?)
    }

    /// The method for a part of space, whose kernels take little time to create.
    fn for_part(task: Task<'a>) -> Result<Self, KernelError> {
        Self::with_kernels(task, T::kernels(task.surface).tiles()?, Follower::new(task)?)
    }

    fn with_kernels(
        task: Task<'a>,
        tiles: &'a dyn Kernel<ContractTiles, T>,
        follower: Follower<'a, T>,
    ) -> Result<Self, KernelError> {
        Ok(Self {
            tiles,
            follower,
            cleared: T::kernels(task.surface).cleared()?.is_some(),
            task,
            longest: task.options.longest(),
            buffers: BufferPool::new(usize::MAX),
            tree: Mutex::new(None),
            double: OnceLock::new(),
        })
    }
}

impl<'a, T: Scalar> Affine<'a, T> {
    /// Returns whether the eye is so far away that coordinates in forms are too inaccurate. The
    /// method `knoll` then still works, since its boxes are clipped to the region.
    fn is_too_far(&self, frame: &RayFrame) -> bool {
        let extent = self.task.region.high() - self.task.region.low();
        frame.error.cmpgt(extent * MAX_RAY_ERROR).any()
    }

    /// Returns the parts of the picture with these rays.
    fn tree(&self, frame: RayFrame, rays: &RayGrid) -> Arc<PartTree> {
        let mut tree = self.tree.lock().unwrap_or_else(PoisonError::into_inner);
        match &*tree {
            Some(tree) if tree.is_of(&frame, rays) => Arc::clone(tree),
            _ => Arc::clone(tree.insert(Arc::new(PartTree::new::<T>(frame, rays)))),
        }
    }

    /// Returns this method in `f64`; `None` if its kernels cannot be compiled.
    fn double(&self) -> Option<&Affine<'a, f64>> {
        if let Some(double) = self.double.get() {
            return double.as_deref();
        }
        let options = TraceOptions { precision: Precision::F64, ..self.task.options };
        // The method is not created inside `get_or_init`. There, its `join` could make this thread
        // take up another band, whose `get_or_init` would then wait for this very thread.
        let made = Affine::new(Task { options, ..self.task }).ok().map(Box::new);
        self.double.get_or_init(|| made).as_deref()
    }
}

impl<T: Scalar> Tracer for Affine<'_, T> {
    fn follow(
        &self,
        rays: &[Segment],
        start: Start,
        found: &mut [RayResult],
        work: &mut KernelStats,
    ) {
        follow_in_region(rays, &self.task, found, |local_rays| {
            self.follower.follow(local_rays, start, &mut Scratch::default(), work)
        });
    }

    fn fallback(&self, rays: &RayGrid) -> Option<Fallback> {
        let why = "the domain is too thin for its distance from the eye: affine forms cannot tell where in it a ray is";
        (self.is_too_far(&RayFrame::new(rays, self.task.region))
            && knoll::prepare::<T>(self.task).is_ok())
        .then(|| Fallback { method: knoll_row(), why: why.to_owned() })
    }

    fn band(&self, rays: &RayGrid, band: &mut Band<'_>, work: &mut KernelStats) {
        let frame = RayFrame::new(rays, self.task.region);
        if self.is_too_far(&frame)
            && let Ok(boxes) = knoll::prepare::<T>(self.task)
        {
            return boxes.band(rays, band, work);
        }
        if !self.task.options.tiles {
            return by_squares(self, rays, band, work);
        }
        if self.task.options.precision == Precision::Auto
            && self.longest * rays.footprint(frame.start) < MIN_BRACKET * frame.resolution::<T>()
            && let Some(double) = self.double()
        {
            return double.band(rays, band, work);
        }
        let mut state = BandState::new(self, frame, rays, band);
        let has_parts = T::kernels(self.task.surface).has_parts();
        let is_over = if has_parts {
            let pass = BandPass { method: self, state: &mut state, rays, band, work };
            self.tree(frame, rays).trace(pass)
        } else {
            let whole = state.whole(rays, band);
            state.trace(self, rays, band, &whole, work)
        };
        state.set_misses(rays, band);
        if is_over {
            band.give_up();
        } else {
            state.finish(self);
        }
    }
}
