//! Claims about boxes, checked against claims about points in them.

use super::{BoxClaim, Defined, Oracle};
use crate::{Ends, GraphOptions, Rng, point_in_box, random_box, random_graph};
use zeroset_ir::{Axis, Graph, NodeId};
use zeroset_ops::Op;

#[test]
fn a_claim_about_a_box_holds_at_its_points() {
    let seed = 0x5eed_0008;
    let mut rng = Rng::with_seed(seed);
    let (mut met, mut continuous) = (0, 0);
    for round in 0..20_000 {
        let options =
            GraphOptions { size: rng.u32(1..8), adversarial: false, ..GraphOptions::default() };
        let (graph, root) = random_graph(&mut rng, &options);
        let oracle = Oracle::new(&graph, &[root]);
        let region: [[f64; 2]; 3] = random_box(&mut rng, Ends::Finite);
        let over = oracle.over(region.map(|[lo, hi]| (lo, hi)), &[])[0];
        continuous += u32::from(over.continuous);
        for _ in 0..8 {
            let point = point_in_box(&mut rng, &region);
            let at = oracle.at(point, &[])[0];
            let case = format!(
                "{} over {region:?}: {over:?}, at {point:?}: {at:?}, seed {seed:#x}, round {round}",
                zeroset_ir::display(&graph, root, &[])
            );
            if at.defined == Defined::Yes {
                assert!(over.values.lo <= at.hi && at.lo <= over.values.hi, "{case}");
                assert_ne!(over.values.defined, Defined::No, "{case}");
                met += 1;
            }
            if at.defined == Defined::No {
                assert!(over.values.defined != Defined::Yes && !over.continuous, "{case}");
            }
        }
    }
    assert!(met > 50_000 && continuous > 5000, "{met} {continuous}");
}

/// Returns the claim about `op` over ranges of x, y, z.
fn over(op: Op, ranges: &[(f64, f64)]) -> BoxClaim {
    let mut graph = Graph::new();
    let ids: Vec<NodeId> =
        Axis::ALL[..ranges.len()].iter().map(|&axis| graph.variable(axis)).collect();
    let root = graph.apply(op, &ids);
    let mut all = [(0.0, 0.0); 3];
    all[..ranges.len()].copy_from_slice(ranges);
    Oracle::new(&graph, &[root]).over(all, &[])[0]
}

#[test]
fn jumps_are_not_continuous() {
    for (op, smooth, jump) in [
        (Op::Sign, (0.25, 1.0), (0.0, 1.0)),
        (Op::Floor, (1.0, 1.75), (1.0, 2.0)),
        (Op::Ceil, (1.25, 2.0), (1.0, 2.0)),
        (Op::Round, (0.75, 1.25), (0.25, 0.75)),
        (Op::Trunc, (-0.75, 0.75), (0.75, 1.0)),
        (Op::Fract, (1.0, 1.75), (1.75, 2.0)),
    ] {
        assert!(over(op, &[smooth]).continuous, "{op:?}");
        assert!(!over(op, &[jump]).continuous, "{op:?}");
    }
    let two = (2.0, 2.0);
    assert!(over(Op::Mod, &[(2.5, 3.5), two]).continuous);
    assert!(!over(Op::Mod, &[(3.5, 4.0), two]).continuous);
    let choose = |a| over(Op::SelectNegative, &[a, (0.0, 1.0), (0.0, 1.0)]).continuous;
    assert_eq!([(-2.0, -1.0), (0.0, 1.0), (-1.0, 0.0)].map(choose), [true, true, false]);
}

#[test]
fn only_what_is_defined_throughout_is_continuous() {
    assert!(over(Op::Sqrt, &[(0.0, 1.0)]).continuous);
    assert!(!over(Op::Sqrt, &[(-0.5, 1.0)]).continuous);
    assert!(!over(Op::Div, &[(1.0, 1.0), (-1.0, 1.0)]).continuous);
    assert!(!over(Op::Tan, &[(1.5, 1.6)]).continuous);
    // A branch that is not chosen need not be continuous.
    let mut graph = Graph::new();
    let x = graph.variable(Axis::X);
    let y = graph.variable(Axis::Y);
    let floor = graph.apply(Op::Floor, &[y]);
    let root = graph.apply(Op::SelectNegative, &[x, floor, y]);
    let claim = |x| Oracle::new(&graph, &[root]).over([x, (0.0, 2.0), (0.0, 0.0)], &[])[0];
    assert!(claim((1.0, 2.0)).continuous && !claim((-2.0, -1.0)).continuous);
}
