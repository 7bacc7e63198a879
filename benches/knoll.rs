//! Times the method `knoll` with native kernels against `knoll` with kernels written in intrinsics.
//!
//! `cargo bench --bench knoll` traces 512×512 pixels from the default view at depth 10, on one
//! thread and without shading. It prints a table with rows named `knoll/case`.

mod rival;

use glam::DVec3;
use rival::{Comparison, Rival, SURFACES, barth, compare, mitchell, sphere};
use std::hint::black_box;
use zeroset_eval::SurfaceKernels;
use zeroset_interval::Interval;
use zeroset_scene::program::Program;
use zeroset_space::{Camera, Projection, Region};
use zeroset_style::{FOV, VIEWS};
use zeroset_syntax::read;
use zeroset_trace::{Driver, GBuffer, Method, Precision, RayGrid, TraceOptions};

const SIZE: usize = 512;
const ROUNDS: usize = 41;

fn time(
    native: &dyn SurfaceKernels,
    rival: &dyn SurfaceKernels,
    rays: &RayGrid,
    region: &Region,
) -> Comparison {
    let options = TraceOptions { precision: Precision::F32, depth: 10, ..TraceOptions::default() };
    let [native, rival] =
        [native, rival].map(|surface| knoll().prepare(surface, region, options).expect("kernels"));
    let trace = |tracer| {
        let mut buffer = GBuffer::new(SIZE, SIZE, 0);
        let work = Driver { rays, tracer, advance: &|_| true }.picture(&mut buffer);
        (buffer, work)
    };
    let ((a, work), (b, _)) = (trace(&*native), trace(&*rival));
    let differ = a.drawn.iter().zip(&b.drawn).filter(|(a, b)| a.is_finite() != b.is_finite());
    assert!(differ.count() < SIZE * SIZE / 1000, "the same picture but for rounding");
    println!("{:>46} packet evaluations", work.interval.calls);
    compare(ROUNDS, || drop(black_box(trace(&*native))), || drop(black_box(trace(&*rival))))
}

fn knoll() -> &'static Method {
    Method::named("knoll").expect("a row of the table")
}

fn main() {
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().expect("first use of the pool");
    println!("{:24}{:>12}{:>12}{:>8}   quartiles", "", "native", "rival", "ratio");
    println!("{:24}{:>12}{:>12}", "", "ms", "ms");
    for (name, formula, half) in SURFACES {
        let document = read(formula, &zeroset_syntax::Options::default()).expect(name);
        let domain = [Interval { lo: -half, hi: half }; 3];
        let program = Program::new(&document, domain).expect(name);
        let region = Region::new(DVec3::splat(-half), DVec3::splat(half)).expect(name);
        let (offset, up) = (DVec3::from(VIEWS[0].offset), DVec3::from(VIEWS[0].up));
        let projection = Projection::Perspective { fov: FOV };
        let camera = Camera::new(offset * half, DVec3::ZERO, up, projection).expect(name);
        let rays = RayGrid::new(&camera, SIZE, SIZE);
        let native = program.surface(0);
        let result = match name {
            "sphere" => time(native, &Rival(sphere), &rays, &region),
            "mitchell" => time(native, &Rival(mitchell), &rays, &region),
            _ => time(native, &Rival(barth), &rays, &region),
        };
        println!(
            "{:24}{:12.3}{:12.3}{:8.3}   {:.3} to {:.3}",
            format!("knoll/{name}"),
            result.ours * 1e3,
            result.theirs * 1e3,
            result.ratio,
            result.quartiles[0],
            result.quartiles[1],
        );
    }
}
