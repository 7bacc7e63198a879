//! Methods: the ways to find where rays first meet a surface.
//!
//! A method is a file with a row of [`METHODS`](crate::METHODS), which creates a [`Tracer`]. The
//! [`Driver`](crate::Driver) chooses rays and threads, and uses the results. Methods do not know
//! the driver.

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
    /// The method's name, in one word.
    pub name: &'static str,
    /// One line of help about the method.
    pub help: &'static str,
    /// The proofs that the method gives for rays that meet the region. A ray that misses the region
    /// is a miss.
    pub proves: Proves,
    /// The options that the method reads. It ignores others.
    pub reads: &'static [MethodOption],
    /// Two functions that create the tracer: in `f32`, then in `f64`.
    pub(crate) prepare: [Prepare; 2],
}

/// The input from which a tracer is prepared.
#[derive(Clone, Copy)]
pub(crate) struct Task<'a> {
    /// The surface to find.
    pub surface: &'a dyn SurfaceKernels,
    /// The region in which rays are followed.
    pub region: &'a Region,
    pub options: TraceOptions,
}

/// Requests a surface's kernels and prepares a tracer for it.
pub(crate) type Prepare = fn(Task<'_>) -> Result<Box<dyn Tracer + '_>, KernelError>;

/// The proofs that a method can give for a ray through the region.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Proves {
    /// Either that the ray meets a zero, or that it meets none.
    HitsAndMisses,
    /// Only that the ray meets no zero. A drawn point may not exist.
    Misses,
    /// Nothing. A drawn point may not exist, and an existing point may not be drawn.
    Nothing,
}

/// A method prepared for one surface.
pub trait Tracer: Sync {
    /// Follows `rays`, and writes each ray's result to the ray's place in `found`. The caller has
    /// filled `found` with [`RayResult::UNSEEN`].
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

    /// The method to use instead if this one cannot trace these rays; `None` if it can.
    fn fallback(&self, _: &RayGrid) -> Option<Fallback> {
        None
    }

    /// Follows the rays of all pixels of a band, as long as the band [is wanted](Band::is_wanted).
    /// Before the call, all wanted pixels must be unseen.
    fn band(&self, rays: &RayGrid, band: &mut Band<'_>, work: &mut KernelStats) {
        by_squares(self, rays, band, work);
    }
}

/// A method that traces rays that the chosen method cannot trace.
#[derive(Clone, Debug, PartialEq)]
pub struct Fallback {
    /// The method that traces instead.
    pub method: &'static Method,
    /// The reason why the chosen method cannot trace them, as a clause.
    pub why: String,
}

/// Traces a band with [`Tracer::follow`], one square of pixels after another. For methods without a
/// [`Tracer::band`] of their own.
pub(crate) fn by_squares<T: Tracer + ?Sized>(
    tracer: &T,
    rays: &RayGrid,
    band: &mut Band<'_>,
    work: &mut KernelStats,
) {
    let (to, pixel) = (f64::INFINITY, rays.pixel());
    let unset = Segment { ray: rays.ray(0, band.top), to, pixel };
    let (mut segments, mut found) = ([unset; RAYS], [RayResult::UNSEEN; RAYS]);
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
        found.fill(RayResult::UNSEEN);
        tracer.follow(segments, Start::Anywhere, found, work);
        for (([column, row], found), segment) in square.iter().zip(found).zip(segments) {
            if found.is_miss() {
                band.set_miss(*column, *row);
            } else {
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
    /// The largest t, which may be infinite.
    pub to: f64,
    /// Approximate width of a pixel at t = 0, and the growth of that width per t. Both are in units
    /// of t. Infinite if the place of a hit does not matter.
    pub pixel: [f64; 2],
}

impl Segment {
    /// The approximate width of a pixel at the ray's point at `t`, in units of t.
    pub(crate) fn footprint(&self, t: f64) -> f64 {
        self.pixel[0] + t * self.pixel[1]
    }

    /// The range of t in which the segment may be in the region. `None` if it misses the region.
    pub(crate) fn within(&self, region: &Region) -> Option<[f64; 2]> {
        let (near, last) = region.span(&self.ray)?;
        let far = last.min(self.to);
        (near <= far).then_some([near, far])
    }
}

/// The place where segments start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// Any place. A segment's first zero counts.
    Anywhere,
    /// A point of a surface. A zero counts only behind a part of the segment that is proven empty.
    OnSurface,
}

impl Method {
    /// Requests the kernels that the method needs from a surface. Prepares to follow rays through
    /// `region`.
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
