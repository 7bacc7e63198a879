//! Every pass over graphs takes time in proportion to their nodes, also where each node is used
//! twice: a walk along all paths of such a tower would never end.

use crate::testing::TestGraphBuilder;
use crate::{
    Axis, Graph, NodeId, algebraic_angles, bounded_logarithms, clear, compact, derivative, display,
    fix_exponents, gradient, hoist, multiples, radical, regularize, rewrite, same_sign, simplify,
    substitute, variabilities, without_gaps,
};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};
use zeroset_interval::Interval;
use zeroset_ops::{Op, TABLE};

/// Number of storeys of a tower. It has 2⁶⁰ paths, and fewer than a thousand nodes.
const STOREYS: usize = 60;
/// Far above the time that any pass takes, even on a slow and busy machine.
const LIMIT: Duration = Duration::from_mins(1);
const DOMAIN: [Interval; 3] = [Interval { lo: -2.0, hi: 2.0 }; 3];

type Pass = (&'static str, fn(&mut Graph, NodeId));

/// All passes.
const PASSES: &[Pass] = &[
    ("algebraic_angles", |graph, root| _ = algebraic_angles(graph, root)),
    ("angles in a cosine", |graph, root| {
        let x = graph.variable(Axis::X);
        let angle = graph.apply(Op::Atan, &[x]);
        let sum = graph.apply(Op::Add, &[angle, root]);
        let root = graph.apply(Op::Cos, &[sum]);
        algebraic_angles(graph, root);
    }),
    ("bounded_logarithms", |graph, root| _ = bounded_logarithms(graph, root)),
    ("clear", |graph, root| _ = clear(graph, root)),
    ("compact", |graph, root| _ = compact(graph, &[root])),
    ("derivative", |graph, root| {
        let x = graph.variable(Axis::X);
        derivative(graph, root, x);
    }),
    ("display", |graph, root| _ = display(graph, root, &[])),
    ("fix_exponents", |graph, root| _ = fix_exponents(graph, &[root], &[])),
    ("gradient", |graph, root| _ = gradient(graph, root)),
    ("hoist", |graph, root| _ = hoist(graph, &[root], 0)),
    ("multiples", |graph, root| _ = multiples(graph, &[root], &[])),
    ("radical", |graph, root| _ = radical(graph, root)),
    ("regularize", |graph, root| _ = regularize(graph, root, Some(true), &DOMAIN, &[])),
    ("regularize a thin one", |graph, root| _ = regularize(graph, root, None, &DOMAIN, &[])),
    ("regularize a complement", |graph, root| {
        regularize(graph, root, Some(false), &DOMAIN, &[]);
    }),
    ("rewrite", |graph, root| _ = rewrite(graph, &[root], &DOMAIN, &[])),
    ("same_sign", |graph, root| _ = same_sign(graph, root)),
    ("simplify", |graph, root| _ = simplify(graph, &[root], &DOMAIN, &[])),
    ("substitute", |graph, root| {
        let [x, y] = [Axis::X, Axis::Y].map(|axis| graph.variable(axis));
        substitute(graph, root, x, y);
    }),
    ("variabilities", |graph, _| _ = variabilities(graph)),
    ("without_gaps", |graph, root| _ = without_gaps(graph, root, &[])),
];

/// A tower in which storeys are joined by `outer`, from a storey and the operation `inner` of it.
fn tower(inner: Op, outer: Op) -> (Graph, NodeId) {
    let builder = TestGraphBuilder::default();
    let [x, y, z] = builder.xyz();
    let mut storey = x * x + y * y + z;
    for _ in 0..STOREYS {
        let others = [storey + 1.0, storey - x];
        let applied = storey.apply(inner, &others[..inner.arity() - 1]);
        storey = storey.apply(outer, &[applied]);
    }
    let root = (storey - 1.0).id;
    (builder.graph(), root)
}

#[test]
fn no_pass_walks_along_all_paths() {
    let mut slowest = (Duration::ZERO, String::new());
    for row in TABLE {
        for outer in [Op::Add, Op::Sub, Op::Mul, Op::Div, Op::Min, Op::Max] {
            for (name, pass) in PASSES {
                let case = format!("{name}: {outer:?} of a storey and its {}", row.name);
                let (op, clock) = (row.op, Instant::now());
                let (done, ended) = channel();
                // A walk that does not end is left to its thread.
                std::thread::spawn(move || {
                    let (mut graph, root) = tower(op, outer);
                    pass(&mut graph, root);
                    done.send(()).expect("the test waits");
                });
                let ended = ended.recv_timeout(LIMIT);
                assert_ne!(ended, Err(RecvTimeoutError::Timeout), "{case}");
                assert_eq!(ended, Ok(()), "{case}");
                slowest = slowest.max((clock.elapsed(), case));
            }
        }
    }
    println!("the slowest: {slowest:?}");
}
