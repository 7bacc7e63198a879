//! Kernels on many threads: code runs while other code is compiled and dropped, and whoever calls a
//! kernel goes on rounding to nearest.

use std::hint::black_box;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread;
use zeroset_eval::{
    Assumptions, Binding, BoxPacket, EnclosurePacket, IntervalKernel, PointKernel, PointPacket,
    Reference, Tape, ValuePacket,
};
use zeroset_ir::{Axis, Graph};
use zeroset_jit::{NativeInterval, NativePoint};
use zeroset_ops::Op;
use zeroset_testkit::{Case, GraphOptions, Rng, pack_boxes};

const SEED: u64 = 0x5eed_00a0;

fn tape(case: &Case) -> Tape {
    Tape::new(&case.graph, &[case.root], &case.assumptions)
}

fn enclose(kernel: &dyn IntervalKernel, boxes: &[BoxPacket]) -> Vec<EnclosurePacket> {
    let mut out = vec![EnclosurePacket::default(); boxes.len()];
    kernel.enclose(boxes, &mut out);
    out
}

#[test]
fn code_runs_on_many_threads_while_other_code_is_dropped() {
    println!("seed {SEED:#x}");
    let mut rng = Rng::with_seed(SEED);
    let options = GraphOptions::default();
    let work: Vec<_> = (0..8)
        .map(|_| {
            let case = Case::random(&mut rng, &options);
            let regions: Vec<_> = (0..64).map(|_| case.random_box(&mut rng)).collect();
            let boxes = pack_boxes(&regions);
            let kernel =
                NativeInterval::compile(&tape(&case), &Binding::empty()).expect("compiles");
            let expected = enclose(&Reference::new(tape(&case), Binding::empty()), &boxes);
            (kernel, boxes, expected)
        })
        .collect();
    let dropped: Vec<Case> = (0..100).map(|_| Case::random(&mut rng, &options)).collect();
    let (done, runs) = (AtomicBool::new(false), AtomicU64::new(0));
    thread::scope(|scope| {
        for first in 0..8 {
            // Clones share code; the last one alive frees it, on whatever thread.
            let work: Vec<_> = work.iter().cycle().skip(first).take(4).cloned().collect();
            let (done, runs) = (&done, &runs);
            scope.spawn(move || {
                while !done.load(Ordering::Relaxed) {
                    for (kernel, boxes, expected) in &work {
                        assert_eq!(&enclose(kernel, boxes), expected, "seed {SEED:#x}");
                        assert_rounds_to_nearest();
                        runs.fetch_add(1, Ordering::Relaxed);
                    }
                }
            });
        }
        drop(work);
        for case in &dropped {
            let kernel = NativeInterval::compile(&tape(case), &Binding::empty()).expect("compiles");
            let other = kernel.clone();
            scope.spawn(move || drop(other));
        }
        done.store(true, Ordering::Relaxed);
    });
    let runs = runs.into_inner();
    println!("{runs} runs");
    assert!(runs >= 32);
}

/// Rounded up, one of these would come out larger; rounded down or to 0, one smaller.
fn assert_rounds_to_nearest() {
    let quotient = |a: f32, b: f32| black_box(black_box(a) / black_box(b));
    let all = [quotient(1.0, 3.0), quotient(7.0, 10.0), quotient(-7.0, 10.0)];
    assert_eq!(all.map(f32::to_bits), [0x3eaa_aaab, 0x3f33_3333, 0xbf33_3333]);
    // Subnormal numbers are kept, neither flushed to zero nor taken for it.
    let least = f32::from_bits(1);
    assert_eq!(black_box(black_box(least) * 3.0).to_bits(), 3);
}

#[test]
fn callers_go_on_rounding_to_nearest() {
    let mut graph = Graph::new();
    let (x, y) = (graph.variable(Axis::X), graph.variable(Axis::Y));
    let root = graph.apply(Op::Div, &[x, y]);
    let tape = Tape::new(&graph, &[root], &Assumptions::none(0));
    let point = NativePoint::compile(&tape, &Binding::empty()).expect("compiles");
    let interval = NativeInterval::compile(&tape, &Binding::empty()).expect("compiles");
    assert_rounds_to_nearest();
    let mut out = [ValuePacket::<f32>::default()];
    point.sample(&[PointPacket { at: [[7.0; 4], [10.0; 4], [0.0; 4]] }], &mut out);
    assert_eq!(out[0].value[0].to_bits(), 0x3f33_3334, "kernels round up");
    assert_rounds_to_nearest();
    // Also when every exception is raised, and for no boxes at all.
    let mut packet = BoxPacket::default();
    packet.neg_lo[0] = [-1.0, f32::MAX, -1e-45, 0.0];
    packet.hi[0] = [1.0, f32::MAX, 1e-45, 0.0];
    packet.hi[1] = [3.0, 1e-45, 3.0, 0.0];
    let enclosures = enclose(&interval, &[packet; 3]);
    assert!(enclosures[0].hi[1] == f32::INFINITY && enclosures[2] == enclosures[0]);
    assert_rounds_to_nearest();
    enclose(&interval, &[]);
    assert_rounds_to_nearest();
}
