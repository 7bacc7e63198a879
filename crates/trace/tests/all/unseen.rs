//! A pixel is a miss only if its ray was examined. A ray that was left out is unseen.

use glam::DVec3;
use std::sync::atomic::{AtomicUsize, Ordering};
use zeroset_eval::{
    ContractSegments, ContractTiles, Contractions, Enclose, Kernel, KernelError, KernelResult,
    Kernels, PartSurface, Planes, Real, Segments, SurfaceKernels, Tiles,
};
use zeroset_space::{Camera, Projection, Region};
use zeroset_trace::{
    Driver, GBuffer, Kept, KernelStats, Method, Patch, PixelCounts, RayGrid, RayResult, Segment,
    Start, Status, TraceOptions, Tracer, UndecidedReason,
};

/// The rays of a camera that looks along z at a cube, which fills the picture's height.
fn grid(width: usize, height: usize) -> RayGrid {
    let parallel = Projection::Orthographic { height: 2.0 };
    let camera = Camera::new(DVec3::Z * -5.0, DVec3::ZERO, DVec3::Y, parallel);
    RayGrid::new(&camera.expect("valid"), width, height)
}

fn cube() -> Region {
    Region::new(-DVec3::ONE, DVec3::ONE).expect("valid")
}

fn unseen(buffer: &GBuffer) -> usize {
    buffer.reasons()[UndecidedReason::Unseen as usize]
}

/// A function without zeros. `parts` tells, for a number of parts of space, for how many of them it
/// says so; `None` if it has no parts.
struct NoZeros {
    parts: Option<fn(usize) -> usize>,
}

impl<T: Real> Kernel<ContractTiles, T> for NoZeros {
    fn eval(&self, _: &Tiles<T>, out: &mut Planes<T>) {
        *out = Planes::default();
    }
}

impl<T: Real> Kernel<ContractSegments, T> for NoZeros {
    fn eval(&self, _: &Segments<T>, out: &mut Contractions<T>) {
        *out = Contractions::default();
    }
}

impl<T: Real> Kernels<T> for NoZeros {
    fn cleared(&self) -> Result<Option<[&dyn Kernel<Enclose, T>; 2]>, KernelError> {
        Ok(None)
    }
    fn segments(&self) -> KernelResult<'_, ContractSegments, T> {
        Ok(self)
    }
    fn tiles(&self) -> KernelResult<'_, ContractTiles, T> {
        Ok(self)
    }
    fn has_parts(&self) -> bool {
        self.parts.is_some()
    }
    fn in_tiles(&self, tiles: &Tiles<T>) -> Vec<PartSurface> {
        let known = self.parts.map_or(0, |parts| parts(tiles.count as usize));
        (0..known).map(|_| PartSurface::Empty).collect()
    }
}

impl SurfaceKernels for NoZeros {
    fn single(&self) -> &dyn Kernels<f32> {
        self
    }
    fn double(&self) -> &dyn Kernels<f64> {
        self
    }
}

/// A picture by the method `affine`, and the number of tiles that it evaluates.
fn by_affine(
    kernels: &NoZeros,
    rays: &RayGrid,
    only: &[bool],
    advance: &(dyn Fn(usize) -> bool + Sync),
) -> (GBuffer, u64) {
    let region = cube();
    let affine = Method::named("affine").expect("a row");
    let tracer = affine.prepare(kernels, &region, TraceOptions::default()).expect("kernels");
    let mut buffer = GBuffer::new(rays.width(), rays.height(), 0);
    let work = Driver { rays, tracer: &*tracer, advance }.picture_where(only, &mut buffer);
    (buffer, work.tiles.lanes)
}

/// A tracer that returns misses for the first `known` rays of each call, and nothing for others.
struct Forgetful {
    known: usize,
}

impl Tracer for Forgetful {
    fn follow(&self, rays: &[Segment], _: Start, found: &mut [RayResult], _: &mut KernelStats) {
        found[..self.known.min(rays.len())].fill(RayResult::MISS);
    }
}

#[test]
fn rays_that_a_tracer_leaves_out_are_undecided() {
    let rays = grid(24, 16);
    for known in [0, 5, 64] {
        let tracer = Forgetful { known };
        let driver = Driver { rays: &rays, tracer: &tracer, advance: &|_| true };
        let mut buffer = GBuffer::new(24, 16, 0);
        driver.picture(&mut buffer);
        // Squares of 8×8 pixels are followed at a time.
        let miss = 6 * known;
        let expected = PixelCounts { miss, hit: 0, undecided: 24 * 16 - miss };
        assert_eq!((buffer.counts(), unseen(&buffer)), (expected, expected.undecided));
        let open = |pixel: &usize| buffer.status[*pixel] == Status::Undecided;
        assert!((0..24 * 16).filter(open).all(|pixel| buffer.distance(pixel) == 0.0));
        let parts = vec![(); 1];
        let kept = Kept::default();
        let finish = |_: &mut zeroset_trace::Rows<'_>, ()| KernelStats::default();
        let (new, _) = driver.new_picture(0, kept, &[], (&[], &[]), parts, finish);
        assert_eq!(new, buffer);
        // Rays that go on behind a point are told apart in the same way.
        let mut behind = GBuffer::new(24, 16, 0);
        driver.behind(&[1.0; 24 * 16], Start::OnSurface, &mut behind);
        assert_eq!((behind.counts(), unseen(&behind)), (expected, expected.undecided));
    }
}

#[test]
fn parts_without_zeros_make_misses_and_missing_parts_do_not() {
    let between = [0.0, f64::INFINITY];
    let patch = |n: usize| Patch { column: 12 * (n % 16), row: 8 * (n / 16), between };
    for (name, rays) in [
        ("low", grid(24, 24)),
        ("wide", grid(200, 30)),
        ("high", grid(200, 136)),
        ("patches", grid(200, 136).patches((0..256).map(patch).collect())),
    ] {
        let pixels = rays.width() * rays.height();
        let all = NoZeros { parts: Some(|count| count) };
        let (buffer, _) = by_affine(&all, &rays, &[], &|_| true);
        assert_eq!(buffer.counts().miss, pixels, "{name}");
        // No part is said to be empty. So all tiles are evaluated.
        let none = NoZeros { parts: Some(|_| 0) };
        let (buffer, tiles) = by_affine(&none, &rays, &[], &|_| true);
        assert_eq!(buffer.counts().miss, pixels, "{name}");
        assert!(tiles > 0);
        // Nothing is known about one of the parts, and it is not traced.
        let most = NoZeros { parts: Some(|count| count - 1) };
        let (buffer, _) = by_affine(&most, &rays, &[], &|_| true);
        let PixelCounts { miss, hit, undecided } = buffer.counts();
        assert!(undecided > 0 && unseen(&buffer) == undecided && hit == 0, "{name}");
        assert!(miss > 0 || name == "low", "{name}");
    }
}

#[test]
fn pixels_that_are_not_wanted_stay_unseen() {
    let rays = grid(50, 20);
    let only: Vec<bool> = (0..1000).map(|pixel| pixel % 7 < 3).collect();
    for parts in [None, Some((|count| count) as fn(usize) -> usize)] {
        let (buffer, _) = by_affine(&NoZeros { parts }, &rays, &only, &|_| true);
        for (pixel, is_wanted) in only.iter().enumerate() {
            let expected = if *is_wanted { UndecidedReason::None } else { UndecidedReason::Unseen };
            assert_eq!(buffer.reason(pixel), expected, "{pixel}");
        }
    }
}

#[test]
fn a_cancelled_picture_has_misses_where_rays_were_examined() {
    // Sixteen tiles of 16×16 pixels are traced at a time.
    let rays = grid(640, 16);
    for parts in [None, Some((|_| 0) as fn(usize) -> usize)] {
        for wanted in 0..5 {
            let asked = AtomicUsize::new(0);
            let advance = |_| asked.fetch_add(1, Ordering::Relaxed) < wanted;
            let (buffer, tiles) = by_affine(&NoZeros { parts }, &rays, &[], &advance);
            let PixelCounts { miss, hit, undecided } = buffer.counts();
            assert_eq!((miss % (16 * 16), hit, unseen(&buffer)), (0, 0, 0));
            assert_eq!(buffer.reasons()[UndecidedReason::Budget as usize], undecided);
            assert!(miss as u64 <= tiles * 16 * 16, "{miss} of {tiles} tiles");
            if parts.is_none() {
                // The driver asks once, and the method before each sixteen tiles.
                let expected = [0, 0, 256, 512, 640][wanted] * 16;
                assert_eq!(miss, expected, "{wanted}");
            }
        }
    }
}
