//! Runs the suite on the reference evaluator, in both precisions.

use zeroset_eval::{Assumptions, Binding, Kernel, Query, Real, Reference, Tape};
use zeroset_ir::{Graph, NodeId};
use zeroset_testkit::suite::{
    check_gradients, check_interval_graphs, check_interval_ops, check_points, tolerance_of_values,
};
use zeroset_testkit::{Adversarial, GraphOptions};

/// Returns the reference evaluator of a function, with derivatives if the query needs them.
fn reference<Q: Query, T: Real>(graph: &Graph, root: NodeId) -> Box<dyn Kernel<Q, T>> {
    let (mut graph, mut roots) = (graph.clone(), vec![root]);
    if Q::OUTPUTS == 4 {
        roots.extend(zeroset_ir::gradient(&mut graph, root));
    }
    let tape = Tape::new(&graph, &roots, &Assumptions::none(0));
    Box::new(Reference::<Q, T>::new(tape, Binding::empty()))
}

fn operations<T: Adversarial>(seed: u64) {
    let tally = check_interval_ops::<T>(&reference, seed, 2000);
    let tally = tally.unwrap_or_else(|failure| panic!("{failure}"));
    assert!(tally.defined > 100_000, "{tally:?}");
}

#[test]
fn every_operation_encloses_the_oracle() {
    operations::<f32>(0x5eed_0050);
    operations::<f64>(0x5eed_0055);
}

fn graphs<T: Adversarial>(seed: u64, adversarial: bool) {
    let options = GraphOptions { adversarial, ..GraphOptions::default() };
    let tally = check_interval_graphs::<T>(&reference, seed, &options, 10_000, 16);
    let tally = tally.unwrap_or_else(|failure| panic!("{failure}"));
    assert!(tally.defined > 100_000, "{tally:?}");
}

#[test]
fn random_graphs_enclose_the_oracle() {
    graphs::<f32>(0x5eed_0051, false);
    graphs::<f32>(0x5eed_0052, true);
    graphs::<f64>(0x5eed_0056, false);
    graphs::<f64>(0x5eed_0057, true);
}

fn points<T: Adversarial>(seed: u64) {
    let tally = check_points::<T>(&reference, seed, 2000, &tolerance_of_values::<T>);
    let tally = tally.unwrap_or_else(|failure| panic!("{failure}"));
    assert!(tally.defined > 100_000, "{tally:?}");
}

#[test]
fn points_are_close_and_nan_where_undefined() {
    points::<f32>(0x5eed_0053);
    points::<f64>(0x5eed_0058);
}

fn gradients<T: Real>(seed: u64, relative: f64) {
    let tally = check_gradients::<T>(&reference, seed, 500, relative);
    let tally = tally.unwrap_or_else(|failure| panic!("{failure}"));
    assert!(tally.defined > 50_000, "{tally:?}");
}

#[test]
fn gradients_agree_with_slopes() {
    gradients::<f32>(0x5eed_0054, 1e-3);
    gradients::<f64>(0x5eed_0059, 1e-3);
}
