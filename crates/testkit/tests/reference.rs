//! The suite, with the reference evaluator plugged in.

use zeroset_eval::{
    Assumptions, Binding, GradientKernel, IntervalKernel, PointKernel, Reference, Tape,
};
use zeroset_ir::{Graph, NodeId};
use zeroset_ops::Op;
use zeroset_testkit::suite::{
    check_gradients, check_interval_graphs, check_interval_ops, check_points,
};
use zeroset_testkit::{Claim, GraphOptions};

fn reference(graph: &Graph, roots: &[NodeId]) -> Reference {
    let tape = Tape::new(graph, roots, &Assumptions::none(0));
    Reference::new(tape, Binding::empty())
}

fn interval(graph: &Graph, root: NodeId) -> Box<dyn IntervalKernel> {
    Box::new(reference(graph, &[root]))
}

fn point(graph: &Graph, root: NodeId) -> Box<dyn PointKernel> {
    Box::new(reference(graph, &[root]))
}

fn gradient(graph: &Graph, root: NodeId) -> Box<dyn GradientKernel> {
    let mut graph = graph.clone();
    let [x, y, z] = zeroset_ir::gradient(&mut graph, root);
    Box::new(reference(&graph, &[root, x, y, z]))
}

#[test]
fn every_operation_encloses_the_oracle() {
    let tally = check_interval_ops(&interval, 0x5eed_0050, 2000);
    let tally = tally.unwrap_or_else(|failure| panic!("{failure}"));
    assert!(tally.defined > 100_000, "{tally:?}");
}

#[test]
fn random_graphs_enclose_the_oracle() {
    for (seed, adversarial) in [(0x5eed_0051, false), (0x5eed_0052, true)] {
        let options = GraphOptions { adversarial, ..GraphOptions::default() };
        let tally = check_interval_graphs(&interval, seed, &options, 10_000, 16);
        let tally = tally.unwrap_or_else(|failure| panic!("{failure}"));
        assert!(tally.defined > 100_000, "{tally:?}");
    }
}

/// How far values may be off in single precision, for functions of one variable.
fn tolerance(op: Op, at: [f32; 3], claim: Claim) -> Option<f64> {
    /// About five times the unit roundoff: the kernels claim no bound, this is what they reach.
    const RELATIVE: f64 = 3e-7;
    /// Near its zeros a sine is good to an absolute error only.
    const WAVE: f64 = 1e-7;
    /// Beyond this, in radians, sines lose more.
    const FARTHEST: f32 = 8192.0;
    let size = claim.hi.abs().max(claim.lo.abs()).min(f64::from(f32::MAX));
    let close = size * RELATIVE + f64::from(f32::from_bits(2));
    let wave = matches!(op, Op::Sin | Op::Cos);
    match (op.arity(), op) {
        (1, Op::Tan) => None,
        (1, _) if wave && at[0].abs() > FARTHEST => None,
        (1, _) => Some(if wave { close + WAVE } else { close }),
        _ => None,
    }
}

#[test]
fn points_are_close_and_nan_where_undefined() {
    let tally = check_points(&point, 0x5eed_0053, 2000, &tolerance);
    let tally = tally.unwrap_or_else(|failure| panic!("{failure}"));
    assert!(tally.defined > 100_000, "{tally:?}");
}

#[test]
fn gradients_agree_with_slopes() {
    let tally = check_gradients(&gradient, 0x5eed_0054, 500, 1e-3);
    let tally = tally.unwrap_or_else(|failure| panic!("{failure}"));
    assert!(tally.defined > 50_000, "{tally:?}");
}
