//! Bounds of gradients must contain derivatives and slopes, and facts about smoothness must be
//! true. The functions are every operation alone, and random functions with kinks, jumps, poles,
//! ends of domains and restrictions, in both precisions.
//!
//! A long run: `ZEROSET_CASES=100000000 cargo test --release -p zeroset-testkit --test all slopes`.

use zeroset_eval::{Assumptions, Binding, Boxes, EncloseGradient, Kernel, Real, Tape};
use zeroset_interval::Interval;
use zeroset_ir::{Constant, Graph, NodeId, gradient};
use zeroset_jit::Native;
use zeroset_ops::Op;
use zeroset_syntax::{Options, read};
use zeroset_testkit::property::{check_gradient_bounds, reference_slopes};
use zeroset_testkit::suite::check_slopes_of_ops;
use zeroset_testkit::{Adversarial, Case, Effort, GraphOptions, Rng, count_claims};

/// Boxes per kernel.
const BOXES: usize = 64;

fn operations<T: Adversarial>(seed: u64) {
    let tally = check_slopes_of_ops::<T>(&reference_slopes, seed, 400);
    let tally = tally.unwrap_or_else(|failure| panic!("{failure}"));
    println!("{:?}: {tally:?}", T::FORMAT);
    assert!(tally.defined * 8 > tally.compared, "{tally:?}");
}

#[test]
fn slopes_of_every_operation_are_bounded() {
    operations::<f32>(0x5eed_0a00);
    operations::<f64>(0x5eed_0a01);
}

/// Checks random cases until `cases` pairs of points were compared where the function is defined.
fn check<T: Adversarial>(name: &str, seed: u64, options: &GraphOptions) {
    let effort = Effort::from_environment(seed, 50_000);
    let (mut compared, mut defined) = (0, 0);
    for seed in effort.seed.. {
        if defined >= effort.cases {
            break;
        }
        let mut rng = Rng::with_seed(seed);
        let options = GraphOptions { size: rng.u32(1..=options.size), ..options.clone() };
        let case = Case::random(&mut rng, &options);
        let simple = rng.bool();
        let tally =
            check_gradient_bounds::<T>(simple, &case, &mut rng, BOXES).unwrap_or_else(|failure| {
                panic!("{failure}\nsimplified: {simple}, ZEROSET_SEED={seed:#x} ZEROSET_CASES=1")
            });
        compared += tally.compared;
        defined += tally.defined;
    }
    println!("{name}, {:?}: {defined} pairs of {compared}", T::FORMAT);
    count_claims(compared);
    assert!(defined * 16 > compared, "{defined} of {compared}");
}

#[test]
fn slopes_of_typical_formulas_are_bounded() {
    let options = GraphOptions { adversarial: false, ..GraphOptions::default() };
    check::<f32>("typical", 0x5eed_0a10_0000, &options);
    check::<f64>("typical", 0x5eed_0a20_0000, &options);
}

#[test]
fn slopes_of_adversarial_formulas_with_parameters_are_bounded() {
    let options = GraphOptions { size: 5, parameters: 2, ..GraphOptions::default() };
    check::<f32>("adversarial", 0x5eed_0a30_0000, &options);
    check::<f64>("adversarial", 0x5eed_0a40_0000, &options);
}

/// Operations that are not smooth everywhere, with some arithmetic.
const HAZARDS: [Op; 26] = [
    Op::Abs,
    Op::Min,
    Op::Max,
    Op::Sign,
    Op::Floor,
    Op::Fract,
    Op::Mod,
    Op::Atan2,
    Op::Sqrt,
    Op::Cbrt,
    Op::Asin,
    Op::Acos,
    Op::Acosh,
    Op::Atanh,
    Op::Ln,
    Op::Div,
    Op::Pow,
    Op::Otherwise,
    Op::WhereNonneg,
    Op::WherePositive,
    Op::WhereNonzero,
    Op::WhereDefined,
    Op::SelectNegative,
    Op::Add,
    Op::Sub,
    Op::Mul,
];

#[test]
fn slopes_beside_hazards_are_bounded() {
    let options =
        GraphOptions { size: 6, ops: HAZARDS.to_vec(), adversarial: false, parameters: 0 };
    check::<f32>("hazards", 0x5eed_0a50_0000, &options);
    check::<f64>("hazards", 0x5eed_0a60_0000, &options);
}

/// Returns whether a kernel reports a function as Lipschitz continuous and as differentiable. In
/// its box x is between `lo` and `hi`, and y between 1 and 2.
fn claims<T: Real>(graph: &Graph, root: NodeId, [lo, hi]: [f64; 2]) -> [bool; 2] {
    let mut graph = graph.clone();
    let [x, y, z] = gradient(&mut graph, root);
    let tape = Tape::<T>::new(&graph, &[root, x, y, z], &Assumptions::none(0));
    let kernel = Native::<EncloseGradient, T>::new(tape, Binding::empty()).expect("compiles");
    let region = [[lo, hi], [1.0, 2.0], [0.0, 0.0]].map(|[lo, hi]| Interval { lo, hi });
    let answer = &kernel.eval_all(&Boxes::around(&[region]))[0];
    [answer.lipschitz, answer.differentiable].map(|mask| mask & 1 == 1)
}

const NOTHING: [bool; 2] = [false, false];
const KINK: [bool; 2] = [true, false];
const SMOOTH: [bool; 2] = [true, true];

#[test]
fn kinks_jumps_and_ends_are_told_apart() {
    for (formula, range, expected) in [
        ("x^3*y", [-1.0, 1.0], SMOOTH),
        ("abs(x)", [-1.0, 1.0], KINK),
        ("abs(x)", [0.0, 1.0], KINK),
        ("abs(x)", [0.25, 1.0], SMOOTH),
        ("abs(x)", [-1.0, -0.25], SMOOTH),
        ("min(x, y)", [0.0, 1.5], KINK),
        ("min(x, y)", [0.0, 1.0], KINK),
        ("min(x, y)", [0.0, 0.5], SMOOTH),
        ("max(x, y)", [0.0, 1.5], KINK),
        ("max(x, y)", [2.5, 3.0], SMOOTH),
        ("sign(x)", [-1.0, 1.0], NOTHING),
        ("floor(x)", [0.5, 1.5], NOTHING),
        ("floor(x)", [0.0, 0.5], SMOOTH),
        ("mod(x, y)", [0.5, 1.5], NOTHING),
        ("mod(x, y)", [0.25, 0.5], SMOOTH),
        ("atan2(x, -y)", [-1.0, 1.0], NOTHING),
        ("atan2(x, -y)", [0.5, 1.0], SMOOTH),
        ("atan2(x, y)", [-1.0, 1.0], SMOOTH),
        ("sqrt(x)", [0.0, 1.0], NOTHING),
        ("sqrt(x)", [0.25, 1.0], SMOOTH),
        ("cbrt(x)", [-1.0, 1.0], NOTHING),
        ("cbrt(x)", [-1.0, -0.25], SMOOTH),
        ("asin(x)", [-1.0, 0.5], NOTHING),
        ("acos(x)", [0.0, 1.0], NOTHING),
        ("asin(x)", [-0.5, 0.5], SMOOTH),
        ("acosh(x)", [1.0, 2.0], NOTHING),
        ("acosh(x)", [1.25, 2.0], SMOOTH),
        ("1/x", [-1.0, 1.0], NOTHING),
        ("y/x", [0.5, 1.0], SMOOTH),
        ("tan(x)", [1.0, 2.0], NOTHING),
        ("ln(x)", [0.0, 1.0], NOTHING),
        ("ln(x)", [0.5, 1.0], SMOOTH),
        ("x^y", [0.0, 1.0], NOTHING),
        ("x^y", [0.5, 1.0], SMOOTH),
        ("abs(x) + sqrt(y)", [-1.0, 1.0], KINK),
        ("sqrt(abs(x))", [-1.0, 1.0], NOTHING),
    ] {
        let document = read(formula, &Options::default()).expect("reads");
        let root = document.surfaces[0].root;
        assert_eq!(claims::<f32>(&document.graph, root, range), expected, "{formula} {range:?}");
        assert_eq!(claims::<f64>(&document.graph, root, range), expected, "{formula} {range:?}");
    }
}

#[test]
fn restrictions_and_choices_are_told_apart() {
    let mut graph = Graph::new();
    let [x, y, _] = zeroset_ir::Axis::ALL.map(|axis| graph.variable(axis));
    let [one, two] = [1, 2].map(|n| graph.constant(Constant::integer(n)));
    let kink = graph.apply(Op::Abs, &[x]);
    let root = graph.apply(Op::Sqrt, &[x]);
    // This function is below 0 wherever it is defined.
    let below = graph.apply(Op::Neg, &[root]);
    let below = graph.apply(Op::Sub, &[below, one]);
    let cases = [
        (Op::WhereNonneg, [y, x, x], [-1.0, 1.0], NOTHING),
        (Op::WhereNonneg, [y, x, x], [0.0, 1.0], SMOOTH),
        (Op::WherePositive, [y, x, x], [0.0, 1.0], NOTHING),
        (Op::WhereNonzero, [kink, x, x], [0.5, 1.0], SMOOTH),
        (Op::WhereDefined, [kink, root, x], [-1.0, 1.0], NOTHING),
        (Op::WhereDefined, [kink, root, x], [0.0, 1.0], KINK),
        (Op::Otherwise, [root, y, x], [-1.0, 1.0], NOTHING),
        (Op::Otherwise, [root, y, x], [0.5, 1.0], SMOOTH),
        (Op::Otherwise, [kink, y, x], [-1.0, 1.0], KINK),
        (Op::SelectNegative, [x, y, root], [-1.0, -0.5], SMOOTH),
        (Op::SelectNegative, [x, y, root], [-1.0, 1.0], NOTHING),
        (Op::SelectNegative, [x, y, kink], [0.0, 1.0], KINK),
        (Op::SelectNegative, [below, one, two], [-1.0, 1.0], NOTHING),
        (Op::SelectNegative, [below, one, two], [0.5, 1.0], SMOOTH),
    ];
    for (op, operands, range, expected) in cases {
        let root = graph.apply(op, &operands[..op.arity()]);
        assert_eq!(claims::<f32>(&graph, root, range), expected, "{op:?} over {range:?}");
        assert_eq!(claims::<f64>(&graph, root, range), expected, "{op:?} over {range:?}");
    }
}
