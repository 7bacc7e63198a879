//! Methods: the ways to find where rays first meet a surface.
//!
//! A method is a file with a row of [`METHODS`](crate::METHODS), which creates a [`Tracer`]. A
//! method does not know which rays it gets, on which threads, or how its results are used: that is
//! up to the [`Driver`](crate::Driver).

use crate::band::Band;
use crate::grid::RayGrid;
use crate::kernel_stats::KernelStats;
use crate::options::{MethodOption, Precision, TraceOptions};
use crate::ray_result::RayResult;
use crate::squares::{RAYS, patches, squares};
use std::fmt;
use zeroset_eval::{KernelError, SurfaceKernels};
use zeroset_space::{Ray, Region};

/// A way to find where rays first meet a surface: a row of [`METHODS`](crate::METHODS).
#[derive(Clone, Copy)]
pub struct Method {
    /// The name, in one word.
    pub name: &'static str,
    /// One line of help.
    pub help: &'static str,
    /// The proofs that it gives for rays that meet the region. Every other ray is a miss.
    pub proves: Proves,
    /// The options that it reads. It ignores others.
    pub reads: &'static [MethodOption],
    /// Creates the tracer in `f32`, and in `f64`.
    pub(crate) prepare: [Prepare; 2],
}

/// The input from which a tracer is prepared.
#[derive(Clone, Copy)]
pub(crate) struct Task<'a> {
    /// The surface to be found.
    pub surface: &'a dyn SurfaceKernels,
    /// The region in which rays are followed.
    pub region: &'a Region,
    pub options: TraceOptions,
}

/// Requests the surface's kernels, and prepares a tracer for the region.
pub(crate) type Prepare = fn(Task<'_>) -> Result<Box<dyn Tracer + '_>, KernelError>;

/// The proofs that a method can give for a ray through the region.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Proves {
    /// The ray meets a zero, or it meets none.
    HitsAndMisses,
    /// Only that a ray meets no zero. A point that is drawn may not exist.
    Misses,
    /// Nothing. A point that is drawn may not exist, and a point that exists may not be drawn.
    Nothing,
}

/// A method prepared for one surface.
pub trait Tracer: Sync {
    /// Follows rays, and writes the result for each to `found`, which has the same length.
    ///
    /// If possible, every four consecutive rays are those of 2×2 neighboring pixels, every sixteen
    /// those of 4×4 pixels, and so on.
    fn follow(
        &self,
        rays: &[Segment],
        start: Start,
        found: &mut [RayResult],
        work: &mut KernelStats,
    );

    /// The method that traces these rays if this one cannot.
    fn fallback(&self, _: &RayGrid) -> Option<Fallback> {
        None
    }

    /// Follows the rays of all pixels of a band, as long as it [is wanted](Band::is_wanted). All
    /// pixels must be misses at first.
    fn band(&self, rays: &RayGrid, band: &mut Band<'_>, work: &mut KernelStats) {
        by_squares(self, rays, band, work);
    }
}

/// A method that replaces the chosen one.
#[derive(Clone, Debug, PartialEq)]
pub struct Fallback {
    /// The method that traces instead.
    pub method: &'static Method,
    /// The reason, as a clause.
    pub why: String,
}

/// [`Tracer::band`] for methods that follow rays one by one.
pub(crate) fn by_squares<T: Tracer + ?Sized>(
    tracer: &T,
    rays: &RayGrid,
    band: &mut Band<'_>,
    work: &mut KernelStats,
) {
    let (to, pixel) = (f64::INFINITY, rays.pixel());
    let unset = Segment { ray: rays.ray(0, band.top), to, pixel };
    let (mut segments, mut found) = ([unset; RAYS], [RayResult::MISS; RAYS]);
    let mut wanted = true;
    let squares: Box<dyn Iterator<Item = Vec<[usize; 2]>>> = if rays.is_patched() {
        Box::new(patches(band.height))
    } else {
        Box::new(squares(band.width, band.height))
    };
    for mut square in squares {
        if !band.wants_all() {
            square.retain(|&[column, row]| band.is_wanted_pixel(column, row));
            if square.is_empty() {
                continue;
            }
        }
        wanted = wanted && band.is_wanted();
        if !wanted {
            for &[column, row] in &square {
                band.set(column, row, &RayResult::GIVEN_UP);
            }
            continue;
        }
        let (segments, found) = (&mut segments[..square.len()], &mut found[..square.len()]);
        for (segment, [column, row]) in segments.iter_mut().zip(&square) {
            segment.ray = rays.ray(*column, band.top + row);
        }
        tracer.follow(segments, Start::Anywhere, found, work);
        for (([column, row], found), segment) in square.iter().zip(found).zip(segments) {
            if !found.is_miss() {
                band.set(*column, *row, &found.scaled(segment.ray.distance(1.0)));
            }
        }
    }
}

/// The part of a ray for t from 0 to `to`.
#[derive(Clone, Copy, Debug)]
pub struct Segment {
    /// The ray.
    pub ray: Ray,
    /// The end; may be infinite.
    pub to: f64,
    /// Approximate width of a pixel at t = 0, and its growth with t, in units of t. Infinite if the
    /// place of a hit does not matter.
    pub pixel: [f64; 2],
}

impl Segment {
    /// The approximate width of a pixel at the point at `t`, in units of t.
    pub(crate) fn footprint(&self, t: f64) -> f64 {
        self.pixel[0] + t * self.pixel[1]
    }

    /// The [`Region::span`] of the segment; `None` if it does not meet the region.
    pub(crate) fn within(&self, region: &Region) -> Option<[f64; 2]> {
        let (near, last) = region.span(&self.ray)?;
        let far = last.min(self.to);
        (near <= far).then_some([near, far])
    }
}

/// The start of segments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// Anywhere. The first zero counts.
    Anywhere,
    /// On a surface. A zero counts only behind a place that is proven to have none.
    OnSurface,
}

impl Method {
    /// Requests the kernels that the method needs from a surface, and prepares to follow rays
    /// through `region`.
    ///
    /// # Errors
    /// If a kernel is not available.
    pub fn prepare<'a>(
        &self,
        surface: &'a dyn SurfaceKernels,
        region: &'a Region,
        options: TraceOptions,
    ) -> Result<Box<dyn Tracer + 'a>, KernelError> {
        let [single, double] = self.prepare;
        let prepare = match options.precision {
            Precision::Auto | Precision::F32 => single,
            Precision::F64 => double,
        };
        prepare(Task { surface, region, options })
    }
}

impl fmt::Debug for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)
    }
}

impl PartialEq for Method {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}
