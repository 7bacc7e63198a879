//! Affine forms over tiles of rays, from coarse to fine, then along single rays.
//!
//! A tile's form is a linear function of its two screen axes and of depth: solved for depth, it narrows the segment in
//! which the tile's rays may meet a zero, and where depth outweighs all else it proves one on every ray. Tiles of 16×16
//! pixels are split into tiles of 4×4 and those into rays; what a tile proves its parts need not ask again. Segments that
//! do not get much shorter are cut in two, and the nearer part comes first.
//!
//! A hit is a segment on which the function is continuous and whose ends have opposite signs, behind nothing but proven
//! empty parts. Emptiness and signs are followed down to what arithmetic can tell, with [`Precision::Auto`] in `f64` where `f32` cannot.

mod frame;
mod narrow;
mod pixels;
mod plane;
mod rays;
mod slots;
mod tiles;

use super::knoll;
use crate::band::Band;
use crate::gbuffer::Found;
use crate::grid::RayGrid;
use crate::method::{Method, MethodOption, Options, Precision, Proves, Segment, Start, Tracer};
use crate::region::Region;
use crate::scalar::Scalar;
use crate::work::Work;
use frame::Frame;
use rays::Follower;
use zeroset_eval::{ContractTiles, Kernel, KernelError, LANES, Surface};

pub(crate) const METHOD: Method = Method {
    name: "affine",
    help: "tiles and rays narrowed by affine forms; proves hits and misses",
    proves: Proves::HitsAndMisses,
    reads: &[MethodOption::Precision, MethodOption::Tolerance],
    prepare,
};

fn prepare<'a>(
    surface: &'a dyn Surface,
    region: &'a Region,
    options: Options,
) -> Result<Box<dyn Tracer + 'a>, KernelError> {
    fn boxed<'a, T: Tracer + 'a>(tracer: T) -> Box<dyn Tracer + 'a> {
        Box::new(tracer)
    }
    let tracer = match options.precision {
        Precision::Auto | Precision::F32 => Affine::<f32>::new(surface, region, options).map(boxed),
        Precision::F64 => Affine::<f64>::new(surface, region, options).map(boxed),
    };
    // Forms need several times the room of intervals: a formula too large for them can still be drawn.
    tracer.or_else(|_| knoll::METHOD.prepare(surface, region, options))
}

struct Affine<'a, T: Scalar> {
    tiles: &'a dyn Kernel<ContractTiles, T>,
    follower: Follower<'a, T>,
    /// Whether the forms are those of a numerator, which proves no zero of the function.
    cleared: bool,
    region: &'a Region,
    tolerance: f64,
    surface: &'a dyn Surface,
    options: Options,
}

/// How far, as a share of the region's extent, the real ray may be from what is computed of it.
const FARTHEST: f64 = 1e-6;

impl<'a, T: Scalar> Affine<'a, T> {
    fn new(
        surface: &'a dyn Surface,
        region: &'a Region,
        options: Options,
    ) -> Result<Self, KernelError> {
        let kernels = T::kernels(surface);
        Ok(Self {
            tiles: kernels.tiles()?,
            follower: Follower::new(surface, region, options)?,
            cleared: kernels.cleared()?.is_some(),
            region,
            tolerance: options.tolerance,
            surface,
            options,
        })
    }
}

impl<T: Scalar> Tracer for Affine<'_, T> {
    fn follow(&self, rays: &[Segment], start: Start, found: &mut [Found], work: &mut Work) {
        for (rays, found) in rays.chunks(LANES).zip(found.chunks_mut(LANES)) {
            self.follower.follow_rays(rays, start, found, work);
        }
    }

    fn band(&self, rays: &RayGrid, band: &mut Band<'_>, work: &mut Work) {
        let (error, extent) =
            (Frame::new(rays, self.region).error, self.region.high() - self.region.low());
        // From so far away forms say nothing of where in the region a ray is; boxes within it may.
        if error.cmpgt(extent * FARTHEST).any()
            && let Ok(boxes) = knoll::METHOD.prepare(self.surface, self.region, self.options)
        {
            return boxes.band(rays, band, work);
        }
        tiles::trace(self, rays, band, work);
    }
}
