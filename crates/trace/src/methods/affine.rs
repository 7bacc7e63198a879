//! Affine forms over tiles of rays, from coarse to fine, then along single rays.
//!
//! A tile's form is a linear function of its two screen axes and of depth: solved for depth, it
//! narrows the segment in which the tile's rays may meet a zero, and where depth outweighs all else
//! it proves one on every ray. Tiles of 16×16 pixels are split into tiles of 4×4 and those into
//! rays; what a tile proves its parts need not ask again. A segment that does not get much shorter
//! is that of a tile to be split, where parts of the tile need less of it: where it is short for
//! how wide the tile is, or the surface steep. Elsewhere it is cut in two, and the nearer part
//! comes first.
//!
//! A hit is a segment on which the function is continuous and whose ends have opposite signs,
//! behind nothing but proven empty parts. Emptiness and signs are followed down to what arithmetic
//! can tell, with [`Precision::Auto`] in `f64` where `f32` cannot.

mod bundle;
#[cfg(test)]
mod exact;
mod frame;
mod level;
mod narrow;
mod pixels;
mod plane;
mod pool;
mod pooled;
mod rays;
mod screens;
mod sift;
mod tiles;
mod tracer;

use super::knoll;
use super::outcome::follow_ways;
use crate::band::Band;
use crate::buffer_pool::BufferPool;
use crate::grid::RayGrid;
use crate::kernel_stats::KernelStats;
use crate::method::{
    Method, MethodOption, Precision, Proves, Segment, Start, Task, TraceOptions, Tracer, by_squares,
};
use crate::ray_result::RayResult;
use crate::scalar::Scalar;
use frame::RayFrame;
use narrow::Scratch;
use rays::Follower;
use std::sync::OnceLock;
use tiles::Room;
use zeroset_eval::{ContractTiles, Kernel, KernelError};

pub(crate) const METHOD: Method = Method {
    name: "affine",
    help: "tiles and rays narrowed by affine forms; proves hits and misses",
    proves: Proves::HitsAndMisses,
    reads: &[
        MethodOption::Precision,
        MethodOption::Tolerance,
        MethodOption::NoContract,
        MethodOption::NoTiles,
        MethodOption::NoIntervals,
    ],
    prepare: [prepare::<f32>, prepare::<f64>],
};

fn prepare<T: Scalar>(task: Task<'_>) -> Result<Box<dyn Tracer + '_>, KernelError> {
    match Affine::<T>::new(task) {
        Ok(tracer) => Ok(Box::new(tracer)),
        // Forms need several times the room of intervals: a formula too large for them can still be
        // drawn.
        Err(_) => knoll::prepare::<T>(task),
    }
}

struct Affine<'a, T: Scalar> {
    tiles: &'a dyn Kernel<ContractTiles, T>,
    follower: Follower<'a, T>,
    /// Whether the forms are those of a numerator, which proves no zero of the function.
    cleared: bool,
    task: Task<'a>,
    /// [`TraceOptions::longest`].
    longest: f64,
    /// Those that no thread is in.
    rooms: BufferPool<Box<Room<T>>>,
    /// Made for the first picture that needs it.
    double: OnceLock<Option<Box<Affine<'a, f64>>>>,
}

/// How far, as a share of the region's extent, the real ray may be from what is computed of it.
const FARTHEST: f64 = 1e-2;

/// Where hits are wanted closer than so many of the shortest segments, or of what coordinates are
/// rounded by, `f32` would narrow each in vain before `f64` does.
const FINE: f64 = 16.0;

impl<'a, T: Scalar> Affine<'a, T> {
    fn new(task: Task<'a>) -> Result<Self, KernelError> {
        let kernels = T::kernels(task.surface);
        let follower = || Follower::new(task);
        let (tiles, follower) = if rayon::current_thread_index().is_some() {
            // Each is compiled while the other is.
            rayon::join(|| kernels.tiles(), follower)
        } else {
            // Mostly they were compiled before, and to hand this over to another thread would take
            // longer.
            (kernels.tiles(), follower())
        };
        Ok(Self {
            tiles: tiles?,
            follower: follower?,
            cleared: kernels.cleared()?.is_some(),
            task,
            longest: task.options.longest(),
            rooms: BufferPool::new(usize::MAX),
            double: OnceLock::new(),
        })
    }
}

impl<'a, T: Scalar> Affine<'a, T> {
    /// The same in `f64` alone.
    fn double(&self) -> Option<&Affine<'a, f64>> {
        if let Some(double) = self.double.get() {
            return double.as_deref();
        }
        let options = TraceOptions { precision: Precision::F64, ..self.task.options };
        // Not made while others are kept waiting: a thread that waits for the half of this that
        // another one makes takes up another band meanwhile, which would then wait for this very
        // thread.
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
        follow_ways(rays, &self.task, found, |ways| {
            self.follower.follow(ways, start, &mut Scratch::default(), work)
        });
    }

    fn band(&self, rays: &RayGrid, band: &mut Band<'_>, work: &mut KernelStats) {
        let frame = RayFrame::new(rays, self.task.region);
        let (error, extent) = (frame.error, self.task.region.high() - self.task.region.low());
        // From so far away forms say nothing of where in the region a ray is; boxes within it may.
        if error.cmpgt(extent * FARTHEST).any()
            && let Ok(boxes) = knoll::prepare::<T>(self.task)
        {
            return boxes.band(rays, band, work);
        }
        if !self.task.options.ideas.tiles {
            return by_squares(self, rays, band, work);
        }
        if self.task.options.precision == Precision::Auto
            && self.longest * rays.footprint(frame.start) < FINE * frame.resolution::<T>()
            && let Some(double) = self.double()
        {
            return double.band(rays, band, work);
        }
        tiles::trace(self, frame, rays, band, work);
    }
}
