//! Limits of kernels: size, stack, lanes in use, assumptions, memory protection.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;
use zeroset_eval::{Assumptions, Binding, Boxes, Enclose, Kernel, Points, SampleGradient, Tape};
use zeroset_interval::Interval;
use zeroset_ir::{Axis, Graph, NodeId};
use zeroset_jit::{Compiled, Error, Native, vector_widths};
use zeroset_ops::Op;

fn assumptions() -> Assumptions {
    Assumptions { domain: [Interval { lo: -2.0, hi: 2.0 }; 3], parameters: Vec::new() }
}

fn compile(graph: &Graph, root: NodeId) -> Result<Native<Enclose>, Error> {
    Native::new(Tape::new(graph, &[root], &assumptions()), Binding::empty())
}

/// A batch of `count` boxes, all of them the origin.
fn origin(count: u32) -> Boxes {
    Boxes { count, ..Boxes::default() }
}

fn is_refused(call: &mut dyn FnMut()) -> bool {
    catch_unwind(AssertUnwindSafe(call)).is_err()
}

/// Applies `op` to x, then to the result, and so on: `length` operations, each used once.
fn tower(op: Op, length: usize) -> (Graph, NodeId) {
    let mut graph = Graph::new();
    let mut root = graph.variable(Axis::X);
    for _ in 0..length {
        root = graph.apply(op, &[root]);
    }
    (graph, root)
}

/// A sum of `width` terms, with two operations each. All terms are computed before the first is
/// used.
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
    let error = compile(&graph, root).expect_err("too large");
    assert_eq!(error.to_string(), "the formula has 20001 operations; a kernel holds at most 20000");
    let (graph, root) = tower(Op::Atan, 20_000);
    let error = compile(&graph, root).expect_err("too long");
    assert!(matches!(error, Error::TooLong { .. }), "{error}");
    assert!(error.to_string().ends_with("a kernel holds at most 200000"), "{error}");
    // Each arctangent has a table of its own on the stack.
    let (graph, root) = tower(Op::Atan, 3250);
    let error = compile(&graph, root).expect_err("too deep");
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
        println!("{name}: {:?}, {} bytes", started.elapsed(), kernel.compiled().code_bytes());
        let out = &kernel.eval_all(&[origin(1)])[0];
        assert!(out.hi[0] >= -out.neg_lo[0], "{name}");
    }
}

#[test]
fn what_is_too_deep_for_wide_vectors_is_computed_in_narrow_ones() {
    for (length, width) in [(100, vector_widths().next()), (1500, Some(16))] {
        let (graph, root) = tower(Op::Atan, length);
        let kernel = compile(&graph, root).expect("within all limits");
        assert_eq!(Some(kernel.compiled().vector_bytes()), width, "{length} arctangents");
        let mut one = origin(1);
        (one.neg_lo[0][0], one.hi[0][0]) = (-1.0, 1.0);
        let out = &kernel.eval_all(&[one])[0];
        // The n-fold arctangent is about √(3 / (2n)), whatever number it starts from.
        let expected = (1.5 / length as f32).sqrt();
        assert!(
            -out.neg_lo[0] <= out.hi[0] && (out.hi[0] / expected - 1.0).abs() < 0.02,
            "{out:?}"
        );
    }
}

#[test]
fn a_kernel_is_asked_about_one_to_sixteen_lanes() {
    let (graph, root) = tower(Op::Sin, 1);
    let bounds = compile(&graph, root).expect("compiles");
    let four = Tape::<f32>::new(&graph, &[root; 4], &assumptions());
    let gradients = Native::<SampleGradient>::new(four, Binding::empty()).expect("compiles");
    for (count, is_allowed) in [(0, false), (1, true), (16, true), (17, false)] {
        let points = Points { count, ..Points::default() };
        assert_eq!(is_refused(&mut || drop(bounds.eval_all(&[origin(count)]))), !is_allowed);
        assert_eq!(
            is_refused(&mut || drop(gradients.eval_all(std::slice::from_ref(&points)))),
            !is_allowed
        );
    }
}

#[test]
fn a_kernel_has_as_many_parameters_and_outputs_as_asked_for() {
    let (graph, root) = tower(Op::Sin, 1);
    let tape = || Tape::<f32>::new(&graph, &[root], &assumptions());
    let one = Binding::new(&[Interval::ONE]);
    let compiled = Compiled::<Enclose>::new(tape()).expect("compiles");
    assert!(!is_refused(&mut || drop(compiled.bind(Binding::empty()))));
    assert!(is_refused(&mut || drop(compiled.bind(one.clone()))));
    assert!(is_refused(&mut || drop(Native::<Enclose>::new(tape(), one.clone()))));
    assert!(is_refused(&mut || drop(Compiled::<SampleGradient>::new(tape()))));
}

/// A kernel's code omits guards that its assumptions make needless. So values outside the
/// assumptions must be refused.
#[test]
fn a_kernel_is_not_asked_beyond_what_it_was_made_for() {
    use zeroset_eval::Reference;
    let mut graph = Graph::new();
    let (x, p) = (graph.variable(Axis::X), graph.parameter(0));
    let root = graph.apply(Op::Add, &[x, p]);
    let unit = Interval { lo: 0.0, hi: 1.0 };
    let assumed = Assumptions { parameters: vec![unit], ..assumptions() };
    let tape = || Tape::<f32>::new(&graph, &[root], &assumed);
    let compiled = Compiled::<Enclose>::new(tape()).expect("compiles");
    let bound = |value| Binding::new(&[value]);
    for (value, is_allowed) in
        [(unit, true), (Interval { lo: 0.5, hi: 1.5 }, false), (Interval::ENTIRE, false)]
    {
        assert_eq!(is_refused(&mut || drop(compiled.bind(bound(value)))), !is_allowed);
        let reference = || Reference::<Enclose>::new(tape(), bound(value));
        assert_eq!(is_refused(&mut || drop(reference())), !is_allowed);
    }
    let native = compiled.bind(bound(unit));
    let reference = Reference::<Enclose>::new(tape(), bound(unit));
    let kernels: [&dyn Kernel<Enclose>; 2] = [&native, &reference];
    for kernel in kernels {
        for (lo, hi, is_allowed) in [(-2.0, 2.0, true), (-2.5, 0.0, false), (0.0, 2.001, false)] {
            for axis in 0..3 {
                let mut ends = [Interval::ONE; 3];
                ends[axis] = Interval { lo, hi };
                // Only the last lane is outside the assumed domain.
                let boxes = Boxes::around(&[[[Interval::ONE; 3]; 8].as_slice(), &[ends]].concat());
                assert_eq!(is_refused(&mut || drop(kernel.eval_all(&boxes))), !is_allowed);
            }
        }
    }
}

/// No page is both writable and executable while code exists and runs.
#[cfg(target_os = "linux")]
#[test]
fn no_page_is_writable_and_executable() {
    let maps = || std::fs::read_to_string("/proc/self/maps").expect("readable");
    let permissions = |line: &str| line.split(' ').nth(1).expect("permissions").to_owned();
    let size = |line: &str| {
        let (first, rest) = line.split_once('-').expect("a range");
        let end = rest.split(' ').next().expect("an address");
        let address = |hex| usize::from_str_radix(hex, 16).expect("an address");
        address(end) - address(first)
    };
    let executable = |maps: &str| -> usize {
        let pages = maps.lines().filter(|line| permissions(line).contains('x'));
        pages.filter(|line| line.trim_end().ends_with(" 0")).map(size).sum()
    };
    let before = executable(&maps());
    let kernels: Vec<_> = (1..40)
        .map(|length| {
            let (graph, root) = tower(Op::Sin, length);
            compile(&graph, root).expect("compiles")
        })
        .collect();
    for kernel in &kernels {
        kernel.eval_all(&[origin(1)]);
    }
    let maps = maps();
    let both: Vec<&str> = maps
        .lines()
        .filter(|line| permissions(line).contains('w') && permissions(line).contains('x'))
        .collect();
    assert!(both.is_empty(), "{both:?}");
    // If the mappings did not include the pages of the code, the check above would prove nothing.
    assert!(executable(&maps) > before, "{before} executable bytes\n{maps}");
}
