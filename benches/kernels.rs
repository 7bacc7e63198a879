//! Times rigorous native interval kernels against rivals written in intrinsics. The rivals do the
//! same operations, but round to nearest.
//!
//! `cargo bench --bench kernels` prints a table with rows named `kernel/case`.

mod rival;

use rival::{Comparison, Rival, SURFACES, barth, compare, mitchell, sphere};
use std::hint::black_box;
use zeroset_eval::{
    Assumptions, Binding, Boxes, Enclose, Kernel, LANES, Points, Query, Sample, Tape,
};
use zeroset_interval::Interval;
use zeroset_ir::{rewrite, simplify};
use zeroset_jit::Native;
use zeroset_syntax::{Options, read};

/// Number of different batches, few enough for the first-level cache.
const BATCHES: usize = 32;
const CALLS: usize = 2_000;
const ROUNDS: usize = 101;

/// Returns boxes like those of a tracer: at random places, and 1/16 as wide as the domain.
fn boxes(half: f64) -> Vec<Boxes> {
    let mut state = 1_u64;
    let mut random = || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f64 / f64::from(1 << 24)
    };
    let mut range = || {
        let lo = half * (2.0 * random() - 1.0);
        Interval { lo, hi: (lo + half / 8.0).min(half) }
    };
    let all: Vec<_> = (0..BATCHES * LANES).map(|_| [(); 3].map(|()| range())).collect();
    Boxes::around(&all)
}

/// Compiles a formula for the cube around the origin with this half width.
fn native<Q: Query>(formula: &str, half: f64) -> Native<Q> {
    let document = read(formula, &Options::default()).expect(formula);
    let assumptions =
        Assumptions { domain: [Interval { lo: -half, hi: half }; 3], parameters: Vec::new() };
    let root = document.surfaces[0].root;
    let (graph, roots) = rewrite(&document.graph, &[root], &assumptions.domain, &[])
        .and_then(|(graph, roots)| simplify(&graph, &roots, &assumptions.domain, &[]))
        .expect(formula);
    Native::new(Tape::new(&graph, &roots, &assumptions), Binding::empty()).expect(formula)
}

/// Evaluates every batch `times` times.
fn eval_often<Q: Query>(kernel: &dyn Kernel<Q>, inputs: &[Q::Input<f32>], times: usize) {
    let mut answers = Q::Output::<f32>::default();
    for input in (0..times).flat_map(|_| inputs) {
        kernel.eval(black_box(input), black_box(&mut answers));
    }
}

fn time(native: &dyn Kernel<Enclose>, rival: &dyn Kernel<Enclose>, half: f64) -> Comparison {
    let boxes = boxes(half);
    let (ours, theirs) = (native.eval_all(&boxes), rival.eval_all(&boxes));
    // Both kernels compute the same function, so their enclosures differ by rounding only.
    for (a, b) in ours.iter().zip(&theirs) {
        for lane in 0..LANES {
            let size = a.hi[lane].abs() + a.neg_lo[lane].abs() + 100.0;
            assert!((a.hi[lane] - b.hi[lane]).abs() < 1e-5 * size, "{a:?} {b:?}");
            assert!((a.neg_lo[lane] - b.neg_lo[lane]).abs() < 1e-5 * size, "{a:?} {b:?}");
        }
    }
    compare(ROUNDS, || eval_often(native, &boxes, CALLS), || eval_often(rival, &boxes, CALLS))
}

fn main() {
    println!("{:24}{:>12}{:>12}{:>8}   quartiles", "", "native", "rival", "ratio");
    println!("{:24}{:>12}{:>12}", "", "ns/box", "ns/box");
    for (name, formula, half) in SURFACES {
        let native = native::<Enclose>(formula, half);
        let result = match name {
            "sphere" => time(&native, &Rival(sphere), half),
            "mitchell" => time(&native, &Rival(mitchell), half),
            _ => time(&native, &Rival(barth), half),
        };
        let per_box = 1e9 / (CALLS * BATCHES * LANES) as f64;
        println!(
            "{:24}{:12.3}{:12.3}{:8.3}   {:.3} to {:.3}",
            format!("kernel/{name}"),
            result.ours * per_box,
            result.theirs * per_box,
            result.ratio,
            result.quartiles[0],
            result.quartiles[1],
        );
    }
    gyroid();
}

/// Times the gyroid's interval kernel against its point kernel, since the gyroid has no rival here.
fn gyroid() {
    const HALF: f64 = std::f64::consts::TAU;
    const FEWER: usize = CALLS / 10;
    let formula = "sin(x)*cos(y) + sin(y)*cos(z) + sin(z)*cos(x)";
    let (interval, point) = (native::<Enclose>(formula, HALF), native::<Sample>(formula, HALF));
    let boxes = boxes(HALF);
    let points: Vec<Points> =
        boxes.iter().map(|boxes| Points { at: boxes.hi, count: boxes.count }).collect();
    let result = compare(
        ROUNDS,
        || eval_often(&interval, &boxes, FEWER),
        || eval_often(&point, &points, FEWER),
    );
    let per_batch = 1e9 / (FEWER * BATCHES) as f64;
    println!("\n{:24}{:>12}{:>12}", "ns per batch of 16", "interval", "point");
    println!(
        "{:24}{:12.1}{:12.1}   ({} and {} bytes of code)",
        "gyroid",
        result.ours * per_batch,
        result.theirs * per_batch,
        interval.compiled().code_bytes(),
        point.compiled().code_bytes(),
    );
}
