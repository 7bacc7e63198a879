//! The derivatives that the table of operations states are those that gradients are made of.

use zeroset_eval::{Assumptions, Binding, Kernel, LANES, Points, Reference, Sample, Tape};
use zeroset_ir::{Axis, Graph, NodeId, gradient};
use zeroset_ops::TABLE;
use zeroset_syntax::{Options, read};

const POINTS: usize = 400;

/// Fractions that fill a cube evenly (Roberts 2018, generalised golden ratios), so that no point is special.
const STEPS: [f64; 3] = [0.819_172_513_4, 0.671_043_606_7, 0.549_700_477_9];

fn points() -> Vec<Points<f64>> {
    let place = |n: usize| STEPS.map(|step| 6.0 * (step * n as f64).fract() - 3.0);
    Points::near(&(1..=POINTS).map(place).collect::<Vec<_>>())
}

/// Values at all points; NaN where there is none.
fn values(graph: &Graph, root: NodeId) -> Vec<f64> {
    let tape = Tape::<f64>::new(graph, &[root], &Assumptions::none(0));
    let out = Reference::<Sample, f64>::new(tape, Binding::empty()).ask_all(&points());
    (0..POINTS).map(|n| out[n / LANES].value[n % LANES]).collect()
}

#[test]
fn stated_derivatives_are_those_of_gradients() {
    let mut compared = 0;
    for row in TABLE {
        let mut graph = Graph::new();
        let operands = Axis::ALL.map(|axis| graph.variable(axis));
        let root = graph.apply(row.op, &operands[..usize::from(row.arity)]);
        let function = values(&graph, root);
        let derivatives = gradient(&mut graph, root);
        for (axis, stated) in row.partials.iter().enumerate() {
            let text = format!("a = x; b = y; c = z\n{stated}");
            let document = read(&text, &Options::default());
            let document = document.unwrap_or_else(|e| panic!("{}: {stated:?}: {e}", row.name));
            let stated_values = values(&document.graph, document.surfaces[0].root);
            let used = values(&graph, derivatives[axis]);
            let mut known = 0;
            for ((function, stated_value), used) in function.iter().zip(stated_values).zip(used) {
                let near = (stated_value - used).abs() <= 1e-10 * used.abs().max(1.0);
                let case =
                    format!("{} by {}: {stated_value} and {used}", row.name, ["a", "b", "c"][axis]);
                assert!(near || function.is_nan(), "{case}, stated as {stated:?}");
                known += usize::from(near && !function.is_nan());
            }
            assert!(known >= POINTS / 20, "{}, {stated:?}: compared at {known} points", row.name);
            compared += known;
        }
    }
    println!("{compared} derivatives compared");
}
