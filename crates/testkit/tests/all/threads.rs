//! Kernels on many threads. Code must run while other code is compiled and dropped. Callers of
//! kernels must still round to nearest afterwards.

use std::hint::black_box;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread;
use zeroset_eval::{
    Assumptions, Binding, Boxes, Enclose, Kernel, Points, Real, Reference, Sample, Tape,
};
use zeroset_interval::Interval;
use zeroset_ir::{Axis, Graph};
use zeroset_jit::Native;
use zeroset_ops::Op;
use zeroset_testkit::{Adversarial, Case, GraphOptions, Rng, pack_boxes};

const SEED: u64 = 0x5eed_00a0;

fn tape<T: Real>(case: &Case) -> Tape<T> {
    Tape::new(&case.graph, &[case.root], &case.assumptions)
}

#[test]
fn code_runs_on_many_threads_while_other_code_is_dropped() {
    many_threads::<f32>();
    many_threads::<f64>();
}

fn many_threads<T: Adversarial>() {
    println!("seed {SEED:#x}");
    let mut rng = Rng::with_seed(SEED);
    let options = GraphOptions::default();
    let work: Vec<_> = (0..8)
        .map(|_| {
            let case = Case::random(&mut rng, &options);
            let regions: Vec<_> = (0..64).map(|_| case.random_box(&mut rng)).collect();
            let boxes = pack_boxes(&regions);
            let kernel = Native::<Enclose, T>::new(tape(&case), Binding::empty());
            let kernel = kernel.expect("compiles");
            let expected = Reference::<Enclose, T>::new(tape(&case), Binding::empty());
            let expected = expected.eval_all(&boxes);
            (kernel, boxes, expected)
        })
        .collect();
    let dropped: Vec<Case> = (0..100).map(|_| Case::random(&mut rng, &options)).collect();
    let (done, runs) = (AtomicBool::new(false), AtomicU64::new(0));
    thread::scope(|scope| {
        for first in 0..8 {
            // Clones of a kernel share its code. The last clone frees the code, on any thread.
            let work: Vec<_> = work.iter().cycle().skip(first).take(4).cloned().collect();
            let (done, runs) = (&done, &runs);
            scope.spawn(move || {
                while !done.load(Ordering::Relaxed) {
                    for (kernel, boxes, expected) in &work {
                        assert_eq!(&kernel.eval_all(boxes), expected, "seed {SEED:#x}");
                        assert_rounds_to_nearest();
                        runs.fetch_add(1, Ordering::Relaxed);
                    }
                }
            });
        }
        drop(work);
        for case in &dropped {
            let kernel = Native::<Enclose, T>::new(tape(case), Binding::empty());
            let kernel = kernel.expect("compiles");
            let other = kernel.clone();
            scope.spawn(move || drop(other));
        }
        done.store(true, Ordering::Relaxed);
    });
    let runs = runs.into_inner();
    println!("{runs} runs");
    assert!(runs >= 32);
}

/// Fails unless arithmetic rounds to nearest. Rounding up would make one of these quotients larger.
/// Rounding down or to 0 would make one smaller.
fn assert_rounds_to_nearest() {
    let quotient = |a: f32, b: f32| black_box(black_box(a) / black_box(b));
    let all = [quotient(1.0, 3.0), quotient(7.0, 10.0), quotient(-7.0, 10.0)];
    assert_eq!(all.map(f32::to_bits), [0x3eaa_aaab, 0x3f33_3333, 0xbf33_3333]);
    let quotient = |a: f64, b: f64| black_box(black_box(a) / black_box(b));
    let all = [quotient(1.0, 3.0), quotient(7.0, 10.0), quotient(-7.0, 10.0)];
    let nearest = [0x3fd5_5555_5555_5555, 0x3fe6_6666_6666_6666, 0xbfe6_6666_6666_6666];
    assert_eq!(all.map(f64::to_bits), nearest);
    // Subnormal numbers must not be flushed to zero, as operands or as results.
    let least = f32::from_bits(1);
    assert_eq!(black_box(black_box(least) * 3.0).to_bits(), 3);
    assert_eq!(black_box(black_box(f64::from_bits(1)) * 3.0).to_bits(), 3);
}

#[test]
fn callers_go_on_rounding_to_nearest() {
    assert_eq!(quotient_rounded_up::<f32>().to_bits(), 0x3f33_3334, "kernels round up");
    assert_eq!(quotient_rounded_up::<f64>().to_bits(), 0x3fe6_6666_6666_6667, "kernels round up");
}

/// Returns 7/10 as kernels round it. Checks the caller's rounding after each kind of call.
fn quotient_rounded_up<T: Adversarial>() -> T {
    let mut graph = Graph::new();
    let (x, y) = (graph.variable(Axis::X), graph.variable(Axis::Y));
    let root = graph.apply(Op::Div, &[x, y]);
    let tape = Tape::new(&graph, &[root], &Assumptions::none(0));
    let point = Native::<Sample, T>::new(tape.clone(), Binding::empty()).expect("compiles");
    let interval = Native::<Enclose, T>::new(tape, Binding::empty()).expect("compiles");
    assert_rounds_to_nearest();
    let values = point.eval_all(&Points::near(&[[7.0, 10.0, 0.0]]));
    assert_rounds_to_nearest();
    // The next call raises every floating-point exception.
    let (largest, least): (f64, f64) = (T::LARGEST.into(), 1e-45);
    let boxes = [
        ([1.0, 1.0], [0.0, 3.0]),
        ([-largest, largest], [0.0, least]),
        ([least, least], [0.0, 3.0]),
        ([0.0, 0.0], [0.0, 0.0]),
    ];
    let boxes = boxes.map(|(x, y)| [x, y, [0.0; 2]].map(|[lo, hi]| Interval { lo, hi }));
    let enclosures = interval.eval_all(&Boxes::around(&[boxes; 12].concat()));
    let infinite = enclosures[0].hi[1].into() == f64::INFINITY;
    assert!(infinite && enclosures[2] == enclosures[0]);
    assert_rounds_to_nearest();
    values[0].value[0]
}

/// Checks threads that panic in a kernel's own check, and then compile and call kernels again.
#[test]
fn threads_that_panic_and_are_used_again_round_to_nearest() {
    thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| {
                for _ in 0..20 {
                    assert_eq!(quotient_rounded_up::<f32>().to_bits(), 0x3f33_3334);
                    let mut graph = Graph::new();
                    let root = graph.variable(Axis::X);
                    let tape = Tape::<f32>::new(&graph, &[root], &Assumptions::none(0));
                    let kernel = Native::<Enclose>::new(tape, Binding::empty()).expect("compiles");
                    let call = AssertUnwindSafe(|| kernel.eval_all(&[Boxes::default()]));
                    assert!(catch_unwind(call).is_err(), "no lane is in use");
                    assert_rounds_to_nearest();
                    kernel.eval_all(&[Boxes { count: 1, ..Boxes::default() }]);
                    assert_rounds_to_nearest();
                }
            });
        }
    });
}
