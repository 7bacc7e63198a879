//! Selections of small formulas, whose choices are between coordinates of given bounds.

use super::{SelectedStep, Selection, Shortener, StepBounds};
use crate::lanes::Lanes;
use crate::tape::{Assumptions, Step, Tape};
use zeroset_ir::{Axis, Constant, Graph, NodeId};
use zeroset_ops::Op;

/// A formula, and what is needed to select its steps.
struct Formula {
    tape: Tape<f64>,
    shortener: Shortener,
}

impl Formula {
    /// The formula that `build` makes of the coordinates.
    fn new(build: impl FnOnce(&mut Graph, [NodeId; 3]) -> NodeId) -> Self {
        let mut graph = Graph::new();
        let coordinates = Axis::ALL.map(|axis| graph.variable(axis));
        let root = build(&mut graph, coordinates);
        let tape = Tape::new(&graph, &[root], &Assumptions::none(0));
        let shortener = Shortener::new(&tape, &[], 32);
        Self { tape, shortener }
    }

    fn all(&self) -> Selection {
        self.shortener.all(&self.tape)
    }

    /// Chooses from a selection the steps that matter between these bounds of x, y and z. Nothing
    /// is known about other steps.
    fn select(&self, from: &Selection, ranges: [[f64; 2]; 3]) -> Selection {
        let deciding = self.shortener.deciding(from);
        let bounds = |&position: &u32| {
            let origin = from.steps()[position as usize].origin().expect("a step of the tape");
            let ([lo, hi], defined) = match self.tape.steps()[origin] {
                Step::Coordinate(axis) => (ranges[axis as usize], f64::from_bits(u64::MAX)),
                _ => ([f64::NEG_INFINITY, f64::INFINITY], 0.0),
            };
            let [neg_lo, hi, defined] = [-lo, hi, defined].map(Lanes::splat);
            StepBounds { neg_lo, hi, defined }
        };
        let bounds: Vec<StepBounds<f64>> = deciding.positions().iter().map(bounds).collect();
        let most = from.steps().len();
        let chosen = self.shortener.select(&self.tape, from, &deciding, &bounds, 1, most);
        chosen.into_iter().next().flatten().expect("the open lane")
    }

    /// The operations of a selection, and whether each is changed. A blend has its last operation.
    fn operations(&self, selection: &Selection) -> Vec<(Op, bool)> {
        let operation = |step: &SelectedStep| match step.origin() {
            Some(origin) => match &self.tape.steps()[origin] {
                Step::Apply(op, _) => Some((*op, step.is_changed())),
                _ => None,
            },
            // An added step.
            None => Some((Op::Neg, step.is_changed())),
        };
        selection.steps().iter().filter_map(operation).collect()
    }
}

fn number(graph: &mut Graph, digits: &str) -> NodeId {
    graph.constant(Constant::decimal(digits).expect("a number"))
}

/// A blend of x and y is 1/2 at the zeros of 1/2 minus the blend. So operands up to 1/2 + k matter,
/// not those up to −1/2 + k.
#[test]
fn a_negated_blend_swaps_thresholds() {
    let formula = Formula::new(|graph, [x, y, _]| {
        let [k, c, half, zero] = ["0.1", "2.5", "0.5", "0"].map(|digits| number(graph, digits));
        let difference = graph.apply(Op::Sub, &[x, y]);
        let distance = graph.apply(Op::Abs, &[difference]);
        let rest = graph.apply(Op::Sub, &[k, distance]);
        let part = graph.apply(Op::Max, &[rest, zero]);
        let square = graph.apply(Op::Sqr, &[part]);
        let square = graph.apply(Op::Mul, &[c, square]);
        let least = graph.apply(Op::Min, &[x, y]);
        let negated = graph.apply(Op::Sub, &[square, least]);
        graph.apply(Op::Add, &[negated, half])
    });
    assert_eq!(formula.shortener.rules.blends.len(), 1);
    let between = |y| {
        let selection = formula.select(&formula.all(), [[0.4, 0.7], y, [0.0, 0.0]]);
        formula.operations(&selection)
    };
    for low in [-0.5, -0.3, 0.3, 0.59] {
        assert_eq!(between([low, 1.0]), [(Op::Sub, false), (Op::Add, false)], "from {low}");
    }
    // Here x replaces the blend, so −x its negative.
    assert_eq!(between([0.61, 1.0]), [(Op::Neg, true), (Op::Add, true)]);
}

/// A substitute may have other values than the step that it replaces, but code of the tape relies
/// on ranges of operands. So all steps above it are marked, also if steps are chosen again.
#[test]
fn users_of_substitutes_are_changed() {
    let formula = Formula::new(|graph, [x, y, z]| {
        let [quarter, two] = ["0.25", "2"].map(|digits| number(graph, digits));
        let least = graph.apply(Op::Min, &[x, y]);
        let sum = graph.apply(Op::Add, &[least, quarter]);
        let product = graph.apply(Op::Mul, &[sum, two]);
        let cosine = graph.apply(Op::Cos, &[z]);
        graph.apply(Op::Max, &[product, cosine])
    });
    let marked = |selection: &Selection| {
        let mut found = formula.operations(selection);
        found.sort_by_key(|(op, _)| format!("{op:?}"));
        found
    };
    let [unknown, all] = [[-9.0, 9.0], [-1.0, 1.0]];
    let plain = [Op::Add, Op::Cos, Op::Max, Op::Min, Op::Mul].map(|op| (op, false));
    assert_eq!(marked(&formula.select(&formula.all(), [all, [-0.5, 3.0], unknown])), plain);
    // Here y is above the threshold −1/4, though x may be above y.
    let short = formula.select(&formula.all(), [all, [0.0, 3.0], unknown]);
    let changed = [(Op::Add, true), (Op::Cos, false), (Op::Max, true), (Op::Mul, true)];
    assert_eq!(marked(&short), changed);
    let again = formula.select(&short, [[0.0, 0.5], [2.0, 3.0], unknown]);
    assert_eq!(marked(&again), changed);
}
