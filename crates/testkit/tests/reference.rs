//! The suite, with the reference evaluator plugged in.

use zeroset_eval::{Assumptions, Binding, IntervalKernel, PointKernel, Reference, Tape};
use zeroset_ir::{Graph, NodeId};
use zeroset_testkit::suite::{check_interval_graphs, check_interval_ops, check_points};
use zeroset_testkit::{Claim, GraphOptions};

fn reference(graph: &Graph, root: NodeId) -> Reference {
    let tape = Tape::new(graph, &[root], &Assumptions::none(0));
    Reference::new(tape, Binding::empty())
}

fn interval(graph: &Graph, root: NodeId) -> Box<dyn IntervalKernel> {
    Box::new(reference(graph, root))
}

fn point(graph: &Graph, root: NodeId) -> Box<dyn PointKernel> {
    Box::new(reference(graph, root))
}

#[test]
fn every_operation_encloses_the_oracle() {
    let tally = check_interval_ops(&interval, 0x5eed_0050, 2000);
    let tally = tally.unwrap_or_else(|failure| panic!("{failure}"));
    assert!(tally.defined > 100_000, "{tally:?}");
}

#[test]
fn random_graphs_enclose_the_oracle() {
    let options = GraphOptions::default();
    let tally = check_interval_graphs(&interval, 0x5eed_0051, &options, 5000, 16);
    let tally = tally.unwrap_or_else(|failure| panic!("{failure}"));
    assert!(tally.defined > 50_000, "{tally:?}");
}

#[test]
fn points_are_nan_where_undefined() {
    let tally = check_points(&point, 0x5eed_0052, 2000, &|_, _, _: Claim| None);
    let tally = tally.unwrap_or_else(|failure| panic!("{failure}"));
    assert!(tally.defined > 100_000, "{tally:?}");
}
