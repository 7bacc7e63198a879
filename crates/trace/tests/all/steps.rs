//! Tests that a packet takes a bounded number of steps at any depth, and that rays unfinished after
//! these steps are undecided.

use glam::DVec3;
use std::sync::atomic::{AtomicU64, Ordering};
use zeroset_eval::{
    Boxes, ContractSegments, Contractions, FindZeros, Kernel, KernelResult, Kernels, Segments,
    SurfaceKernels, Zeros,
};
use zeroset_space::{Camera, Projection, Ray, Region};
use zeroset_trace::{
    Driver, GBuffer, KernelStats, MOST_STEPS, Method, Precision, RayGrid, RayResult, Segment,
    Start, Status, TraceOptions,
};

/// A function of z that may be 0 above `top` and has no zero below. Its bounds exclude zeros only
/// in slabs of thickness at most `finest`.
struct Stubborn {
    top: f32,
    finest: f32,
    calls: AtomicU64,
}

impl Stubborn {
    fn new(top: f32, finest: f32) -> Self {
        Self { top, finest, calls: AtomicU64::new(0) }
    }

    /// Returns the lanes that may hold a zero, as bits. `bounds` gives a lane's bounds of z.
    fn possible(&self, count: u32, bounds: impl Fn(usize) -> [f32; 2]) -> u16 {
        self.calls.fetch_add(1, Ordering::Relaxed);
        let is_possible = |lane: usize| {
            let [low, high] = bounds(lane);
            !(high < self.top && high - low <= self.finest)
        };
        (0..count as usize).map(|lane| u16::from(is_possible(lane)) << lane).sum()
    }
}

impl Kernel<FindZeros> for Stubborn {
    fn eval(&self, boxes: &Boxes, zeros: &mut Zeros) {
        *zeros = Zeros::default();
        let bounds = |lane: usize| [-boxes.neg_lo[2][lane], boxes.hi[2][lane]];
        zeros.possible = self.possible(boxes.count, bounds);
    }
}

impl Kernel<ContractSegments> for Stubborn {
    fn eval(&self, segments: &Segments, out: &mut Contractions) {
        *out = Contractions::default();
        let at = |lane: usize, t: f32| segments.origin[2][lane] + t * segments.direction[2][lane];
        let bounds = |lane: usize| [segments.near[lane], segments.far[lane]].map(|t| at(lane, t));
        out.possible = self.possible(segments.count, bounds);
    }
}

impl Kernels<f32> for Stubborn {
    fn zeros(&self) -> KernelResult<'_, FindZeros, f32> {
        Ok(self)
    }
    fn segments(&self) -> KernelResult<'_, ContractSegments, f32> {
        Ok(self)
    }
}

/// The surface x² + y² + z² = 1/2. Its bounds are rounded to nearest.
struct BallKernels;

impl BallKernels {
    fn possible(count: u32, bounds: impl Fn(usize) -> [[f32; 2]; 3]) -> u16 {
        let is_possible = |lane: usize| {
            let squares = bounds(lane).map(|[low, high]| {
                let (a, b) = (low * low, high * high);
                [if low < 0.0 && high > 0.0 { 0.0 } else { a.min(b) }, a.max(b)]
            });
            let end = |k: usize| squares.iter().map(|square| square[k]).sum::<f32>();
            end(0) <= 0.5 && end(1) >= 0.5
        };
        (0..count as usize).map(|lane| u16::from(is_possible(lane)) << lane).sum()
    }
}

impl Kernel<FindZeros> for BallKernels {
    fn eval(&self, boxes: &Boxes, zeros: &mut Zeros) {
        *zeros = Zeros::default();
        let bounds = |lane: usize| {
            [0, 1, 2].map(|axis: usize| [-boxes.neg_lo[axis][lane], boxes.hi[axis][lane]])
        };
        zeros.possible = Self::possible(boxes.count, bounds);
    }
}

impl Kernel<ContractSegments> for BallKernels {
    fn eval(&self, segments: &Segments, out: &mut Contractions) {
        *out = Contractions::default();
        let bounds = |lane: usize| {
            [0, 1, 2].map(|axis: usize| {
                let [o, d] = [segments.origin[axis][lane], segments.direction[axis][lane]];
                let [a, b] = [segments.near[lane], segments.far[lane]].map(|t| o + t * d);
                [a.min(b), a.max(b)]
            })
        };
        out.possible = Self::possible(segments.count, bounds);
    }
}

impl Kernels<f32> for BallKernels {
    fn zeros(&self) -> KernelResult<'_, FindZeros, f32> {
        Ok(self)
    }
    fn segments(&self) -> KernelResult<'_, ContractSegments, f32> {
        Ok(self)
    }
}

impl SurfaceKernels for BallKernels {
    fn single(&self) -> &dyn Kernels<f32> {
        self
    }
}

impl SurfaceKernels for Stubborn {
    fn single(&self) -> &dyn Kernels<f32> {
        self
    }
}

const SIZE: usize = 4;
/// Number of packets in a picture. Each has 4×4 rays.
const PACKETS: u64 = (SIZE * SIZE / 16) as u64;

/// Returns the rays of a camera that looks along z.
fn frame() -> RayGrid {
    let parallel = Projection::Orthographic { height: 1.0 };
    let camera = Camera::new(DVec3::Z * -5.0, DVec3::ZERO, DVec3::Y, parallel);
    RayGrid::new(&camera.expect("valid"), SIZE, SIZE)
}

fn trace(kernel: &Stubborn, depth: u32) -> (GBuffer, KernelStats) {
    trace_by("knoll", kernel, depth)
}

fn trace_by(method: &str, kernel: &Stubborn, depth: u32) -> (GBuffer, KernelStats) {
    let region = Region::new(-DVec3::ONE, DVec3::ONE).expect("valid");
    let options = TraceOptions {
        precision: Precision::F32,
        depth,
        tolerance: 0.5,
        ..TraceOptions::default()
    };
    let method = Method::named(method).expect("a row");
    let tracer = method.prepare(kernel, &region, options).expect("a kernel");
    let mut buffer = GBuffer::new(SIZE, SIZE, 0);
    let work = Driver { rays: &frame(), tracer: &*tracer, advance: &|_| true }.picture(&mut buffer);
    (buffer, work)
}

#[test]
fn steps_are_bounded_whatever_the_depth() {
    for (method, depth) in [("knoll", 17), ("knoll", 20), ("raa", 17), ("raa", 20)] {
        let kernel = Stubborn::new(2.0, 2.1e-5);
        let (buffer, work) = trace_by(method, &kernel, depth);
        let asked = if method == "raa" { work.segments } else { work.interval };
        assert!(asked.calls <= PACKETS * MOST_STEPS, "{method} {depth}: {work:?}");
        assert_eq!(kernel.calls.into_inner(), work.interval.calls + work.segments.calls);
        assert_eq!(work.given_up, (SIZE * SIZE) as u64);
        for pixel in 0..SIZE * SIZE {
            assert_eq!(buffer.status[pixel], Status::Undecided);
            // The ray is proven empty up to `distance`, and no farther.
            let distance = buffer.distance(pixel);
            assert!(!buffer.is_drawn(pixel) || buffer.drawn[pixel] == distance);
            assert!((4.0..6.0).contains(&distance) && distance > 4.1, "{distance}");
        }
    }
}

#[test]
fn a_way_that_is_proven_empty_within_the_steps_is_a_miss() {
    let kernel = Stubborn::new(2.0, 1.7e-4);
    let (buffer, work) = trace(&kernel, 20);
    assert_eq!(work.given_up, 0);
    assert!(work.interval.calls > PACKETS * MOST_STEPS / 4, "the test must need many: {work:?}");
    assert!(buffer.status.iter().all(|status| *status == Status::Miss));
}

#[test]
fn what_lies_in_front_is_found_as_before() {
    let kernel = Stubborn::new(-0.875, 2.1e-5);
    let (buffer, work) = trace(&kernel, 20);
    assert_eq!(work.given_up, 0);
    assert!((0..SIZE * SIZE).all(|pixel| (buffer.drawn[pixel] - 4.125).abs() < 1e-3));
}

#[test]
fn depths_out_of_range_are_brought_within() {
    let (shallow, deep) = (Stubborn::new(-0.875, 2.1e-5), Stubborn::new(-0.875, 2.1e-5));
    let (buffer, work) = trace(&shallow, 0);
    assert_eq!((buffer, work), trace(&Stubborn::new(-0.875, 2.1e-5), 1));
    // With more than 2^24 slabs, some indices would not be exact in `f32`, and there would be gaps
    // between adjacent slabs.
    let (buffer, work) = trace(&deep, 41);
    assert_eq!((buffer, work), trace(&Stubborn::new(-0.875, 2.1e-5), 20));
}

#[test]
fn pixels_followed_from_the_eye_are_as_in_the_whole_picture() {
    let kernel = Stubborn::new(-0.875, 2.1e-5);
    let (whole, _) = trace(&kernel, 12);
    let region = Region::new(-DVec3::ONE, DVec3::ONE).expect("valid");
    let options = TraceOptions {
        precision: Precision::F32,
        depth: 12,
        tolerance: 0.5,
        ..TraceOptions::default()
    };
    let tracer = Method::named("knoll")
        .expect("a row")
        .prepare(&kernel, &region, options)
        .expect("a kernel");
    let mut buffer = GBuffer::new(SIZE, SIZE, 0);
    let driver = Driver { rays: &frame(), tracer: &*tracer, advance: &|_| true };
    let mut starts = [f64::INFINITY; SIZE * SIZE];
    for pixel in [3, 9, 10] {
        starts[pixel] = 0.0;
    }
    driver.behind(&starts, Start::Anywhere, &mut buffer);
    for (pixel, start) in starts.iter().enumerate() {
        // The other pixels stay unseen.
        let expected = if *start == 0.0 { whole.distance(pixel) } else { 0.0 };
        assert_eq!(buffer.distance(pixel), expected, "{pixel}");
    }
    // After cancellation, pixels stay as they were, since nothing is proven about them.
    let before = buffer.clone();
    let driver = Driver { rays: &frame(), tracer: &*tracer, advance: &|_| false };
    driver.behind(&starts, Start::Anywhere, &mut buffer);
    assert_eq!(buffer, before);
}

#[test]
fn what_is_found_of_a_ray_does_not_hang_on_its_neighbours() {
    let region = Region::new(-DVec3::ONE, DVec3::ONE).expect("valid");
    // The rays pass the ball, or cross it at its edge or middle. All advance fastest along z.
    let rays: Vec<Segment> = (0..16)
        .map(|n: i32| {
            let [i, j] = [n % 4, n / 4].map(f64::from);
            let origin = DVec3::new(0.3 * i, 0.25 * j, -4.0);
            let ray = Ray { origin, direction: DVec3::new(0.02 * j, -0.03 * i, 1.0) };
            Segment { ray, to: f64::INFINITY, pixel: [1e-3; 2] }
        })
        .collect();
    for method in ["knoll", "raa"] {
        let options = TraceOptions { precision: Precision::F32, ..TraceOptions::default() };
        let method = Method::named(method).expect("a row");
        let tracer = method.prepare(&BallKernels, &region, options).expect("a kernel");
        let follow = |rays: &[Segment]| {
            let mut found = vec![RayResult::MISS; rays.len()];
            tracer.follow(rays, Start::Anywhere, &mut found, &mut KernelStats::default());
            found.iter().map(|f| (f.status, f.distance, f.drawn)).collect::<Vec<_>>()
        };
        let together = follow(&rays);
        let alone: Vec<_> = rays.iter().flat_map(|ray| follow(&[*ray])).collect();
        assert_eq!(together, alone, "{}", method.name);
        let missed = together.iter().filter(|found| found.0 == Status::Miss).count();
        assert!((4..12).contains(&missed), "{missed}");
    }
}
