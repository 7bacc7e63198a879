//! What a method is: a way to find where rays first meet a surface.
//!
//! It is a file with a row, and a [`Tracer`] that the row makes. Which rays it is given, on which
//! threads, and what becomes of its findings, a method does not know: that is the
//! [`Driver`](crate::Driver)'s.

use crate::band::Band;
use crate::grid::RayGrid;
use crate::kernel_stats::KernelStats;
use crate::options::{MethodOption, Precision, TraceOptions};
use crate::ray_result::RayResult;
use crate::squares::{RAYS, patches, squares};
use std::fmt;
use zeroset_eval::{KernelError, SurfaceKernels};
use zeroset_space::Ray;
use zeroset_space::Region;

/// A way to find where rays first meet a surface: a row of [`METHODS`](crate::METHODS).
#[derive(Clone, Copy)]
pub struct Method {
    /// What it is called, in one word.
    pub name: &'static str,
    /// One line of help.
    pub help: &'static str,
    /// What it proves of rays that meet the region; beside the region every ray is a miss.
    pub proves: Proves,
    /// The options that it reads; it does not look at others.
    pub reads: &'static [MethodOption],
    /// In `f32`, and in `f64`.
    pub(crate) prepare: [Prepare; 2],
}

/// What a method is made ready for.
#[derive(Clone, Copy)]
pub(crate) struct Task<'a> {
    /// What rays are to meet.
    pub surface: &'a dyn SurfaceKernels,
    /// Where they are followed.
    pub region: &'a Region,
    pub options: TraceOptions,
}

/// Asks the surface for kernels, and gets ready to follow rays through the region.
pub(crate) type Prepare = fn(Task<'_>) -> Result<Box<dyn Tracer + '_>, KernelError>;

/// What a method is able to prove of a ray through the region.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Proves {
    /// That it meets a zero, or that it meets none.
    HitsAndMisses,
    /// Only that it meets none. What is drawn may be there or not.
    Misses,
    /// Nothing. What is drawn may not be there, and what is there may not be drawn.
    Nothing,
}

/// A method made ready for one surface.
pub trait Tracer: Sync {
    /// Follows rays, and says of each in `found` what became of it.
    ///
    /// Each four in a row are neighbours if possible, as are each sixteen and so on. `found` has as
    /// many places.
    fn follow(
        &self,
        rays: &[Segment],
        start: Start,
        found: &mut [RayResult],
        work: &mut KernelStats,
    );

    /// The method that traces these rays in the place of this one, if another one does.
    fn fallback(&self, _: &RayGrid) -> Option<Fallback> {
        None
    }

    /// Follows the rays through all pixels of a band, in which everything is a miss so far, as long
    /// as it [is wanted](Band::is_wanted).
    fn band(&self, rays: &RayGrid, band: &mut Band<'_>, work: &mut KernelStats) {
        by_squares(self, rays, band, work);
    }
}

/// Another method in the place of the one that was asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Fallback {
    /// The method that traces instead.
    pub method: &'static Method,
    /// The reason, as a clause.
    pub why: String,
}

/// [`Tracer::band`] for methods that know only rays.
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
        if !band.is_all_asked() {
            square.retain(|&[column, row]| band.is_asked(column, row));
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
    /// May be infinite.
    pub to: f64,
    /// About how wide a pixel is where t is 0, and how much that grows with t, in units of t.
    /// Infinite where nobody asks how near a place is.
    pub pixel: [f64; 2],
}

impl Segment {
    /// About how wide a pixel is at the point at `t`, in units of t.
    pub(crate) fn footprint(&self, t: f64) -> f64 {
        self.pixel[0] + t * self.pixel[1]
    }

    /// [`Region::span`] of it; `None` if it does not meet the region.
    pub(crate) fn within(&self, region: &Region) -> Option<[f64; 2]> {
        let (near, last) = region.span(&self.ray)?;
        let far = last.min(self.to);
        (near <= far).then_some([near, far])
    }
}

/// Where rays start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// The first zero counts.
    Anywhere,
    /// On a surface, which does not count: zeros do only after a place that is free of them.
    OnSurface,
}

impl Method {
    /// Asks a surface for the kernels that this needs, and gets ready to follow rays through
    /// `region`.
    ///
    /// # Errors
    /// If a kernel cannot be had.
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
