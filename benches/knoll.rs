//! The paper's traverser: driven by native code against the same traverser over formulas in intrinsics.
//!
//! `cargo bench --bench knoll` traces 512×512 pixels at depth 10 on one thread, from the default view, without shading;
//! names are `knoll/case`.

mod rival;

use glam::DVec3;
use rival::{Comparison, Rival, SURFACES, barth, compare, mitchell, sphere};
use std::hint::black_box;
use zeroset::program::Program;
use zeroset_eval::IntervalKernel;
use zeroset_interval::Interval;
use zeroset_syntax::{Options, read};
use zeroset_trace::{Camera, GBuffer, Knoll, Projection, RayGrid, Region, StandardView};

const SIZE: usize = 512;
const ROUNDS: usize = 41;

fn time<R: IntervalKernel>(
    native: &zeroset_jit::NativeInterval,
    rival: &R,
    frame: &RayGrid,
    region: &Region,
) -> (Comparison, GBuffer) {
    let knoll = Knoll::default();
    let (a, work) = knoll.trace(frame, region, native, &|_| true);
    let (b, _) = knoll.trace(frame, region, rival, &|_| true);
    let differ = a.drawn.iter().zip(&b.drawn).filter(|(a, b)| a.is_finite() != b.is_finite());
    assert!(differ.count() < SIZE * SIZE / 1000, "the same picture but for rounding");
    println!("{:>46} packet evaluations", work.interval_calls);
    let result = compare(
        ROUNDS,
        || drop(black_box(knoll.trace(frame, region, native, &|_| true))),
        || drop(black_box(knoll.trace(frame, region, rival, &|_| true))),
    );
    (result, a)
}

fn main() {
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().expect("first use of the pool");
    println!("{:24}{:>12}{:>12}{:>8}   quartiles", "", "native", "rival", "ratio");
    println!("{:24}{:>12}{:>12}", "", "ms", "ms");
    for (name, formula, half) in SURFACES {
        let document = read(formula, &Options::default()).expect(name);
        let domain = [Interval { lo: -half, hi: half }; 3];
        let program = Program::new(&document, domain).expect(name);
        let native = program.interval_kernel(0).expect(name);
        let region = Region::new(DVec3::splat(-half), DVec3::splat(half)).expect(name);
        let (offset, up) = StandardView::Iso.offset_and_up();
        let projection = Projection::Perspective { fov: StandardView::FOV };
        let camera = Camera::new(offset * half, DVec3::ZERO, up, projection).expect(name);
        let frame = camera.rays(SIZE, SIZE);
        let (result, _) = match name {
            "sphere" => time(&native, &Rival(sphere), &frame, &region),
            "mitchell" => time(&native, &Rival(mitchell), &frame, &region),
            _ => time(&native, &Rival(barth), &frame, &region),
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
