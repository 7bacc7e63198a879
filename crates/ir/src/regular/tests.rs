//! Tests of regularization: known solids, and random solids made of a few planes.

use crate::testing::{Random, TestExpr, TestGraphBuilder, evaluate};
use crate::{Constant, Graph, NodeId, display, regularize, rewrite};
use zeroset_interval::Interval;
use zeroset_ops::Op;

const DOMAIN: Interval = Interval { lo: -8.0, hi: 8.0 };

/// The regularized text of a solid, for a parameter a in [−2, 2] and a parameter b in [1, 2].
fn regular(
    formula: impl for<'a> Fn(&'a TestGraphBuilder, [TestExpr<'a>; 3]) -> TestExpr<'a>,
) -> String {
    let builder = TestGraphBuilder::default();
    let root = formula(&builder, builder.xyz()).id;
    let parameters = [Interval { lo: -2.0, hi: 2.0 }, Interval { lo: 1.0, hi: 2.0 }];
    let (mut graph, roots) =
        rewrite(&builder.graph(), &[root], &[DOMAIN; 3], &parameters).expect("small");
    let simple = regularize(&mut graph, roots[0], Some(true), &[DOMAIN; 3], &parameters);
    if simple == roots[0] { "the same".to_owned() } else { display(&graph, simple, &["a", "b"]) }
}

fn max<const N: usize>(all: [TestExpr<'_>; N]) -> TestExpr<'_> {
    all.into_iter().reduce(|a, b| a.apply(Op::Max, &[b])).expect("some")
}

fn min<const N: usize>(all: [TestExpr<'_>; N]) -> TestExpr<'_> {
    all.into_iter().reduce(|a, b| a.apply(Op::Min, &[b])).expect("some")
}

fn ball([x, y, z]: [TestExpr<'_>; 3]) -> TestExpr<'_> {
    x.pow(2) + y.pow(2) + z.pow(2) - 1.0
}

/// The box with these bounds of x, and |y| ≤ 1.
fn slab([x, y, _]: [TestExpr<'_>; 3], low: f64, high: f64) -> TestExpr<'_> {
    max([low - x, x - high, y.f(Op::Abs) - 1.0])
}

#[test]
fn boxes_that_share_a_face_are_one_box() {
    let joined = regular(|_, at| min([slab(at, 0.1, 0.3), slab(at, 0.3, 0.7)]));
    assert_eq!(joined, "max(max(abs(y) + (-1), x - 0.7), 0.1 - x)");
    // The decimals 0.1 + 0.2 and 0.3 are the same number, and so are the faces of 2x and x.
    let sum = regular(|_, at| {
        let [x, y, _] = at;
        let other = max([0.6 - 2.0 * x, x - 0.7, y.f(Op::Abs) - 1.0]);
        min([max([0.1 - x, x - (0.0 * y + 0.1) - 0.2, y.f(Op::Abs) - 1.0]), other])
    });
    assert_eq!(sum, "max(max(abs(y) + (-1), 0.1 - x), x - 0.7)");
    let row = regular(|_, at| {
        min([slab(at, 1.0, 2.0), slab(at, 3.0, 4.0), slab(at, 0.0, 1.0), slab(at, 2.0, 3.0)])
    });
    assert_eq!(row, "max(max(abs(y) + (-1), x - 4), -x)");
    assert_eq!(regular(|_, at| min([slab(at, 0.1, 0.3), slab(at, 0.4, 0.7)])), "the same");
}

/// Where a function ends is a face of its solid, which no other part may hide.
#[test]
fn functions_that_end_are_left_alone() {
    let cut = regular(|_, [x, y, _]| max([x - 1.0, min([x - 2.0, y.f(Op::Ln)])]));
    assert_eq!(cut, "the same");
    let halves = regular(|_, [x, ..]| min([x.f(Op::Ln), -x.f(Op::Ln)]));
    assert_eq!(halves, "the same");
    let ends_outside = regular(|_, [x, y, _]| max([x - 1.0, min([x - 2.0, (y + 9.0).f(Op::Ln)])]));
    assert_eq!(ends_outside, "x - 1");
}

#[test]
fn halves_are_whole_and_space_has_no_boundary() {
    let halves = regular(|_, [x, y, _]| {
        let ball = x.pow(2) + y.pow(2) - 1.0;
        min([max([ball, x]), max([ball, -x])])
    });
    assert_eq!(halves, "sqr(x) + sqr(y) - 1");
    assert_eq!(regular(|_, [x, ..]| min([x, -x])), "-1");
    assert_eq!(regular(|_, [x, ..]| min([x - 1.0, -x])), "-1");
    assert_eq!(regular(|_, [x, ..]| -x.pow(2)), "-1");
}

#[test]
fn sheets_are_empty() {
    assert_eq!(regular(|_, [x, ..]| max([x, -x])), "1");
    assert_eq!(regular(|_, [x, ..]| x.f(Op::Abs)), "1");
    assert_eq!(regular(|_, [x, y, _]| max([x.f(Op::Sin) - y, y - x.f(Op::Sin)])), "1");
    assert_eq!(regular(|_, at| ball(at).pow(2)), "1");
    let tube = regular(|_, [x, y, z]| {
        let radius = (x.pow(2) + y.pow(2)).f(Op::Sqrt);
        max([radius - 1.5, 1.5 - radius, z])
    });
    assert_eq!(tube, "1");
    // The ball with a sheet outside of it is the ball.
    let both = regular(|_, at| min([max([at[0] - 2.0, 2.0 - at[0]]), ball(at)]));
    assert_eq!(both, "sqr(x) + sqr(y) + sqr(z) - 1");
}

#[test]
fn a_cut_that_is_flush_with_a_face_leaves_no_sheet() {
    let cut = regular(|_, at| max([slab(at, 0.0, 1.0), -max([0.0 - at[0], at[1], at[2] - 1.0])]));
    assert_eq!(cut, "max(max(-x, x - 1), max(abs(y) + (-1), min(-y, -(z - 1))))");
}

#[test]
fn two_holes_that_share_a_face_are_one_hole() {
    let holes = regular(|_, at| {
        let hole = |low, high| -max([low - at[0], at[0] - high]);
        max([at[2], hole(0.0, 1.0), hole(1.0, 2.0)])
    });
    assert_eq!(holes, "max(min(-(x - 2), x), z)");
}

#[test]
fn numbers_that_decide_a_choice_are_dropped() {
    let text = "sqr(x) + sqr(y) + sqr(z) - 1";
    assert_eq!(regular(|s, at| max([s.number("0"), ball(at)])), text);
    assert_eq!(regular(|s, at| min([s.number("1"), ball(at)])), text);
    assert_eq!(regular(|s, at| max([s.number("1"), ball(at)])), "1");
    assert_eq!(regular(|s, at| min([s.number("0"), ball(at)])), "-1");
    // Factors that are nowhere negative, and odd powers, do not change the solid.
    assert_eq!(regular(|_, at| at[0].pow(2) * ball(at)), text);
    assert_eq!(regular(|_, at| ball(at).pow(3)), text);
}

#[test]
fn a_thick_face_stays() {
    // The sets floor(x) ≤ 1 and floor(x) ≥ 1 share all points with 1 ≤ x < 2.
    assert_eq!(regular(|_, [x, ..]| max([x.f(Op::Floor) - 1.0, 1.0 - x.f(Op::Floor)])), "the same");
    // |x| + x is 0 wherever x ≤ 0.
    // |x| + x is 0 wherever x ≤ 0, so that half of space is the solid.
    assert_eq!(regular(|_, [x, ..]| x.f(Op::Abs) + x), "2*x");
    let ramp = regular(|s, [x, y, _]| {
        let ramp = s.number("0").apply(Op::Max, &[x]) * (y - 1.0);
        max([ramp, -ramp])
    });
    assert_eq!(ramp, "the same");
    // A parameter may be 0, where all of space is a face.
    let scaled = |number| {
        regular(move |s, [x, ..]| max([s.parameter(number) * x, -(s.parameter(number) * x)]))
    };
    assert_eq!((&*scaled(0), &*scaled(1)), ("the same", "1"));
    assert_eq!(regular(|s, [x, ..]| max([x - s.parameter(0), s.parameter(0) - x])), "1");
}

#[test]
fn what_shares_no_face_stays_as_typed() {
    assert_eq!(regular(|_, [x, y, z]| max([x.f(Op::Abs), y, z]) - 1.0), "the same");
    assert_eq!(regular(|_, [x, y, z]| x.pow(2) + y.pow(2) - z), "the same");
    let blend = regular(|s, at| {
        let other = at[2] - 1.0;
        let near = max([1.0 - (ball(at) - other).f(Op::Abs), s.number("0")]);
        min([ball(at), other]) - near.pow(2) * 0.25
    });
    assert_eq!(blend, "the same");
}

/// A random solid made of planes at integers, with boxes and layers among its parts.
fn random_solid(graph: &mut Graph, random: &mut Random, depth: usize) -> NodeId {
    if depth == 0 || random.below(6) == 0 {
        let axis = crate::Axis::ALL[random.below(3)];
        let (axis, number) = (graph.variable(axis), random.below(5) as i64 - 2);
        let number = graph.integer(number);
        let plane = match random.below(3) {
            0 => graph.apply(Op::Sub, &[axis, number]),
            1 => graph.apply(Op::Sub, &[number, axis]),
            _ => {
                let from = graph.apply(Op::Sub, &[axis, number]);
                let (from, one) = (graph.apply(Op::Abs, &[from]), graph.integer(1));
                graph.apply(Op::Sub, &[from, one])
            }
        };
        let factor = graph.constant(Constant::ratio(3, 4).expect("a number"));
        return if random.below(4) == 0 { graph.apply(Op::Mul, &[factor, plane]) } else { plane };
    }
    let op = [Op::Min, Op::Max][random.below(2)];
    let count = 2 + random.below(3);
    let parts: Vec<NodeId> = (0..count).map(|_| random_solid(graph, random, depth - 1)).collect();
    let solid = parts.into_iter().reduce(|a, b| graph.apply(op, &[a, b])).expect("some");
    if random.below(5) == 0 { graph.apply(Op::Neg, &[solid]) } else { solid }
}

/// The sign of a node at a point.
fn sign(graph: &Graph, id: NodeId, at: [f64; 3]) -> i32 {
    let (value, _) = evaluate(graph, at, &[])[id.index()].expect("defined");
    if value == 0.0 { 0 } else { value.signum() as i32 }
}

/// Inside of cells between the planes, signs stay. On faces between two cells of one sign, the
/// function mostly has that sign, too: always for two boxes.
#[test]
fn random_solids_keep_their_insides_and_lose_inner_faces() {
    let seed = 0x0501_1d00;
    let (mut faces, mut left, mut changed) = (0, 0, 0);
    for case in 0..400 {
        let mut random = Random(seed + case);
        let mut graph = Graph::new();
        let root = random_solid(&mut graph, &mut random, 3);
        let simple = regularize(&mut graph, root, Some(true), &[DOMAIN; 3], &[]);
        changed += u32::from(simple != root);
        let message = || {
            let [old, new] = [root, simple].map(|id| display(&graph, id, &[]));
            format!("seed {:#x}: {old}, became {new}", seed + case)
        };
        for _ in 0..200 {
            let cell = [(); 3].map(|()| random.below(6) as f64 - 2.5);
            let own = sign(&graph, root, cell);
            assert_eq!(sign(&graph, simple, cell), own, "{} at {cell:?}", message());
            let axis = random.below(3);
            let (mut next, mut face) = (cell, cell);
            next[axis] += 1.0;
            face[axis] += 0.5;
            if sign(&graph, root, next) == own && sign(&graph, root, face) == 0 {
                faces += 1;
                left += u32::from(sign(&graph, simple, face) == 0);
                assert!(sign(&graph, simple, face) * own >= 0, "{} at {face:?}", message());
            }
        }
    }
    println!("{changed} solids changed; {left} of {faces} inner faces are left");
    assert!(changed > 200 && faces > 200 && left * 20 < faces, "{changed} {left} {faces}");
}
