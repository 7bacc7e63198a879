//! What a kernel may not be or do: too long, too deep, called with short buffers, written to.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;
use zeroset_eval::{
    Assumptions, Binding, BoxPacket, EnclosurePacket, GradientKernel, GradientPacket,
    IntervalKernel, PointKernel, PointPacket, Tape, ValuePacket,
};
use zeroset_interval::Interval;
use zeroset_ir::{Axis, Graph, NodeId};
use zeroset_jit::{Error, NativeGradient, NativeInterval, NativePoint};
use zeroset_ops::Op;

fn assumptions() -> Assumptions {
    Assumptions { domain: [Interval { lo: -2.0, hi: 2.0 }; 3], parameters: Vec::new() }
}

fn compile(graph: &Graph, root: NodeId) -> Result<NativeInterval<f32>, Error> {
    NativeInterval::compile(&Tape::new(graph, &[root], &assumptions()), &Binding::empty())
}

/// `op` of x, of that, and so on: `length` operations, none of which is used twice.
fn tower(op: Op, length: usize) -> (Graph, NodeId) {
    let mut graph = Graph::new();
    let mut root = graph.variable(Axis::X);
    for _ in 0..length {
        root = graph.apply(op, &[root]);
    }
    (graph, root)
}

/// Two operations for each of `width` terms, which are all made before the first is used.
fn live(op: Op, width: usize) -> (Graph, NodeId) {
    let mut graph = Graph::new();
    let x = graph.variable(Axis::X);
    let terms: Vec<NodeId> = (0..width)
        .map(|n| {
            let n = graph.integer(n as i64 + 1);
            let sum = graph.apply(Op::Add, &[x, n]);
            graph.apply(op, &[sum])
        })
        .collect();
    let root = terms[1..].iter().fold(terms[0], |sum, term| graph.apply(Op::Add, &[sum, *term]));
    (graph, root)
}

#[test]
fn each_limit_has_its_own_message() {
    let (graph, root) = tower(Op::Sqr, 20_001);
    let error = compile(&graph, root).err().expect("too large");
    assert_eq!(error.to_string(), "the formula has 20001 operations; a kernel holds at most 20000");
    let (graph, root) = tower(Op::Atan, 20_000);
    let error = compile(&graph, root).err().expect("too long");
    assert!(matches!(error, Error::TooLong { .. }), "{error}");
    assert!(error.to_string().ends_with("a kernel holds at most 200000"), "{error}");
    // Each has a table of its own on the stack.
    let (graph, root) = tower(Op::Atan, 2200);
    let error = compile(&graph, root).err().expect("too deep");
    assert!(matches!(error, Error::TooDeep { .. }), "{error}");
    assert!(error.to_string().ends_with("bytes of stack; a kernel may use at most 524288"));
}

#[test]
fn large_kernels_are_compiled_in_bounded_time_and_run() {
    for (name, (graph, root)) in [
        ("5,000 operations, 1,667 values live", live(Op::Sqr, 1667)),
        ("4,998 operations, 1,666 square roots", live(Op::Sqrt, 1666)),
        ("20,000 operations, 6,666 values live", live(Op::Sqr, 6666)),
    ] {
        let started = Instant::now();
        let kernel = compile(&graph, root).expect("within all limits");
        println!("{name}: {:?}, {} bytes", started.elapsed(), kernel.code_bytes());
        let mut out = [EnclosurePacket::default()];
        kernel.enclose(&[BoxPacket::default()], &mut out);
        assert!(out[0].hi[0] >= -out[0].neg_lo[0], "{name}");
    }
}

#[test]
fn a_kernel_is_not_called_with_a_short_buffer() {
    let (graph, root) = tower(Op::Sin, 1);
    let tape = Tape::<f32>::new(&graph, &[root], &assumptions());
    let four = Tape::<f32>::new(&graph, &[root; 4], &assumptions());
    let empty = Binding::empty();
    let interval = NativeInterval::compile(&tape, &empty).expect("compiles");
    let point = NativePoint::compile(&tape, &empty).expect("compiles");
    let gradient = NativeGradient::compile(&four, &empty).expect("compiles");
    let boxes = [BoxPacket::default(); 2];
    let points = [PointPacket::default(); 2];
    let refused = |call: &mut dyn FnMut()| catch_unwind(AssertUnwindSafe(call)).is_err();
    let mut enclosures = [EnclosurePacket::default(); 2];
    let mut values = [ValuePacket::default(); 2];
    let mut gradients = [GradientPacket::default(); 2];
    assert!(refused(&mut || interval.enclose(&boxes, &mut enclosures[..1])));
    assert!(refused(&mut || point.sample(&points, &mut values[..1])));
    assert!(refused(&mut || gradient.gradient(&points, &mut gradients[..1])));
    assert!(!refused(&mut || interval.enclose(&boxes, &mut enclosures)));
    assert!(!refused(&mut || point.sample(&points, &mut values)));
    assert!(!refused(&mut || gradient.gradient(&points, &mut gradients)));
    // Nor with another number of parameters, or of outputs, than it was compiled for.
    let one = Binding::new(&[(Interval::ONE, zeroset_interval::Facts::TOTAL)]);
    assert!(refused(&mut || drop(NativeInterval::compile(&tape, &one))));
    assert!(refused(&mut || drop(interval.bind(&one))));
    assert!(refused(&mut || drop(NativeGradient::compile(&tape, &empty))));
}

/// No page is writable and executable, while code is there and runs.
#[cfg(target_os = "linux")]
#[test]
fn no_page_is_writable_and_executable() {
    let maps = || std::fs::read_to_string("/proc/self/maps").expect("readable");
    let permissions = |line: &str| line.split(' ').nth(1).expect("permissions").to_owned();
    let executable = |maps: &str| {
        let pages = maps.lines().filter(|line| permissions(line).contains('x'));
        pages.filter(|line| line.trim_end().ends_with(" 0")).count()
    };
    let before = executable(&maps());
    let kernels: Vec<_> = (1..40)
        .map(|length| {
            let (graph, root) = tower(Op::Sin, length);
            compile(&graph, root).expect("compiles")
        })
        .collect();
    let mut out = [EnclosurePacket::default()];
    for kernel in &kernels {
        kernel.enclose(&[BoxPacket::default()], &mut out);
    }
    let maps = maps();
    let both: Vec<&str> = maps
        .lines()
        .filter(|line| permissions(line).contains('w') && permissions(line).contains('x'))
        .collect();
    assert!(both.is_empty(), "{both:?}");
    // The code is among those pages, or the test would see nothing.
    assert!(executable(&maps) > before, "{before} executable mappings\n{maps}");
}
