//! What a method is: a way to find where rays first meet a surface.
//!
//! It is a file with a row, and a [`Tracer`] that the row makes. Which rays it is given, on which
//! threads, and what becomes of its findings, a method does not know: that is the
//! [`Driver`](crate::Driver)'s.

use crate::band::Band;
use crate::grid::RayGrid;
use crate::kernel_stats::KernelStats;
use crate::ray_result::RayResult;
use crate::scalar::Scalar;
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

/// An option that a method may read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MethodOption {
    /// [`TraceOptions::precision`].
    Precision,
    /// [`TraceOptions::depth`].
    Depth,
    /// [`TraceOptions::tolerance`].
    Tolerance,
    /// [`TraceOptions::steps`].
    Steps,
    /// That [`Ideas::contract`] is left out.
    NoContract,
    /// That [`Ideas::tiles`] is left out.
    NoTiles,
    /// That [`Ideas::intervals`] is left out.
    NoIntervals,
}

impl MethodOption {
    /// What it is called where it is typed.
    pub fn name(self) -> &'static str {
        match self {
            Self::Precision => "precision",
            Self::Depth => "max-depth",
            Self::Tolerance => "tolerance",
            Self::Steps => "steps",
            Self::NoContract => "no-contract",
            Self::NoTiles => "no-tiles",
            Self::NoIntervals => "no-interval",
        }
    }
}

/// How a method is to work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TraceOptions {
    /// What kernels compute in.
    pub precision: Precision,
    /// How often the region is halved along a ray, from 1 to [`Precision::max_depth`]; what lies
    /// beyond is brought within.
    pub depth: u32,
    /// How far, in pixels, a hit may be from where it is said to be. Proofs do not depend on it.
    pub tolerance: f64,
    /// How short the segments are that stay open, as a share of the longest bracket: 0 follows them
    /// as far as arithmetic can tell, more leaves them sooner to be painted, for a picture that
    /// another one follows. Read where proofs are.
    pub least: f64,
    /// Samples on a ray's way through the region, or steps along it at most; from 2 on.
    pub steps: u32,
    /// Whether a place where the function is unbounded counts as an asymptote rather than a root:
    /// its pixel then is undecided, but not drawn there.
    pub suppress_asymptotes: bool,
    /// What is to be made use of, by methods that read these ideas.
    pub ideas: Ideas,
}

impl TraceOptions {
    /// How long, in pixels, the bracket of a hit may be: a hit is said to be in its middle.
    pub(crate) fn longest(&self) -> f64 {
        2.0 * self.tolerance
    }
}

impl Default for TraceOptions {
    fn default() -> Self {
        Self {
            precision: Precision::Auto,
            depth: 10,
            tolerance: 0.5,
            least: 0.0,
            steps: 256,
            suppress_asymptotes: true,
            ideas: Ideas::default(),
        }
    }
}

/// Ideas of methods, each of which can be left out to see what it brings. What is proven is true
/// without them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ideas {
    /// Segments are narrowed to where a form may vanish; else they are only halved.
    pub contract: bool,
    /// Rays are looked at together, tile by tile; else each alone.
    pub tiles: bool,
    /// Intervals are asked of what forms leave open, to prove it empty or to prove a zero by signs
    /// around it.
    pub intervals: bool,
}

impl Ideas {
    /// Those that are left out.
    pub fn left_out(self) -> impl Iterator<Item = MethodOption> {
        let Self { contract, tiles, intervals } = self;
        let ideas = [
            (contract, MethodOption::NoContract),
            (tiles, MethodOption::NoTiles),
            (intervals, MethodOption::NoIntervals),
        ];
        ideas.into_iter().filter_map(|(is_used, option)| (!is_used).then_some(option))
    }
}

impl Default for Ideas {
    fn default() -> Self {
        Self { contract: true, tiles: true, intervals: true }
    }
}

/// The floats in which kernels compute. Enclosures are rigorous in either.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Precision {
    /// 32 bits, and 64 for what these leave undecided, in methods that do so; others take it as
    /// [`Precision::F32`].
    #[default]
    Auto,
    /// 32 bits: twice as fast.
    F32,
    /// 64 bits: for slabs too thin for `f32`, and surfaces that `f32` cannot tell from their
    /// surroundings.
    F64,
}

impl Precision {
    /// The greatest depth at which slabs are still thicker than what rounding adds to them.
    pub fn max_depth(self) -> u32 {
        match self {
            Self::Auto | Self::F32 => f32::MAX_DEPTH,
            Self::F64 => f64::MAX_DEPTH,
        }
    }
}

impl fmt::Display for Precision {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Auto => "auto",
            Self::F32 => "f32",
            Self::F64 => "f64",
        })
    }
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

    /// Follows the rays through all pixels of a band, in which everything is a miss so far, as long
    /// as it [is wanted](Band::is_wanted).
    fn band(&self, rays: &RayGrid, band: &mut Band<'_>, work: &mut KernelStats) {
        by_squares(self, rays, band, work);
    }
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
