//! Tests of each rule alone, and of all rules on random graphs.

use super::*;
use crate::constant::NamedConstant;
use crate::display;
use crate::testing::{Random, TestExpr, TestGraphBuilder, evaluate};
use zeroset_ops::{Continuity, Law, Parity, TABLE};

const DOMAIN: Interval = Interval { lo: -2.0, hi: 2.0 };

/// The simplified text of a formula over [-2, 2]³, for parameters a in [-2, 2] and b in [1, 2].
fn simple(
    formula: impl for<'a> Fn(&'a TestGraphBuilder, [TestExpr<'a>; 3]) -> TestExpr<'a>,
) -> String {
    let builder = TestGraphBuilder::default();
    let root = formula(&builder, builder.xyz()).id;
    let graph = builder.graph();
    let parameters = [DOMAIN, Interval { lo: 1.0, hi: 2.0 }];
    let (simple, roots) = rewrite(&graph, &[root], &[DOMAIN; 3], &parameters).expect("small");
    let ranges: [&[Interval]; 2] = [&[DOMAIN; 3], &parameters];
    crate::proofs::write("rewritings", (&graph, root), (&simple, roots[0]), ranges);
    display(&simple, roots[0], &["a", "b"])
}

#[test]
fn like_terms_merge_and_numbers_stay_exact() {
    assert_eq!(simple(|_, [x, y, _]| x + 2.0 * y + x - y + 0.1 + 0.2), "2*x + y + 0.3");
    assert_eq!(simple(|_, [x, y, _]| x * y + y * x), "2*(x*y)");
    assert_eq!(simple(|_, [x, y, _]| (x + y) - (y + x) + x), "x");
    assert_eq!(simple(|_, [x, y, _]| -(x - y)), "y - x");
    assert_eq!(simple(|_, [x, y, _]| 3.0 - (2.0 - (1.0 - (x - y)))), "y - x + 2");
    assert_eq!(simple(|_, [x, y, _]| 2.0 * x + 2.0 * y), "2*(x + y)");
    assert_eq!(simple(|_, [x, _, _]| x / 4.0 * 3.0), "0.75*x");
    assert_eq!(simple(|s, [x, _, _]| s.number("5").f(Op::Sqrt).pow(2) * x), "5*x");
}

#[test]
fn products_collect_powers() {
    assert_eq!(simple(|_, [x, _, _]| x * x), "sqr(x)");
    assert_eq!(simple(|_, [x, _, _]| x.pow(2) * x.pow(3)), "x^5");
    assert_eq!(simple(|_, [x, _, _]| x.pow(2).pow(2)), "sqr(sqr(x))");
    assert_eq!(simple(|_, [x, _, _]| x.pow(6)), "sqr(x^3)");
    assert_eq!(simple(|_, [x, _, _]| x.pow(1) + x.pow(0)), "x + 1");
    assert_eq!(simple(|_, [x, _, _]| x.pow(-3)), "1/x^3");
    assert_eq!(simple(|_, [x, y, _]| x.pow(2) * y.pow(2)), "sqr(x*y)");
    assert_eq!(simple(|_, [x, _, _]| (-x).pow(2)), "sqr(x)");
    assert_eq!(simple(|_, [x, _, _]| (-x).pow(3)), "-x^3");
    assert_eq!(simple(|_, [x, _, _]| x.f(Op::Abs).pow(20)), "sqr(sqr(x^5))");
    assert_eq!(simple(|_, [x, y, _]| (x - y).pow(2) + (y - x).pow(2)), "2*sqr(x - y)");
    assert_eq!(simple(|_, [x, y, _]| (x + 1.0) * (x + y)), "(x + 1)*(x + y)");
    assert_eq!(simple(|s, [x, _, _]| 2.0 * (x * s.parameter(0))), "2*a*x");
}

#[test]
fn a_domain_outlives_what_gave_it() {
    assert_eq!(simple(|_, [x, _, _]| x / x), "where_nonzero(1, x)");
    assert_eq!(simple(|_, [x, _, _]| x.pow(3) / x), "where_nonzero(sqr(x), x)");
    assert_eq!(simple(|_, [x, y, _]| (y / x) * x), "where_nonzero(y, x)");
    assert_eq!(simple(|_, [x, _, _]| 1.0 / (1.0 / x)), "where_nonzero(x, x)");
    assert_eq!(simple(|_, [x, _, _]| x.f(Op::Sqrt).pow(2)), "where_nonneg(max(x, 0), x)");
    assert_eq!(simple(|_, [x, _, _]| x.f(Op::Ln).f(Op::Exp)), "where_positive(max(x, 0), x)");
    assert_eq!(simple(|_, [x, y, _]| x.f(Op::Ln) * 0.0 + y), "where_defined(y, ln(x))");
    assert_eq!(simple(|_, [x, y, _]| x.f(Op::Ln) - x.f(Op::Ln) + y), "where_defined(y, ln(x))");
    assert_eq!(simple(|_, [x, _, _]| x.f(Op::Ln).pow(0)), "where_defined(1, ln(x))");
    // The operation that is removed is defined on the whole box, so no restriction remains.
    assert_eq!(simple(|_, [x, y, _]| (x + 3.0) / (x + 3.0) * y), "y");
    assert_eq!(simple(|_, [x, y, _]| (x + 3.0).f(Op::Ln) * 0.0 + y), "y");
    assert_eq!(simple(|_, [x, y, _]| x - x + y), "y");
    assert_eq!(simple(|_, [x, _, _]| x / 0.0), "x/0");
}

#[test]
fn squares_are_completed() {
    assert_eq!(simple(|_, [x, _, _]| x.pow(4) - 5.0 * x.pow(2)), "sqr(sqr(x) - 2.5) - 6.25");
    assert_eq!(
        simple(|_, [x, y, _]| x.pow(2) + x + y.pow(2) - y),
        "sqr(x + 0.5) + sqr(y - 0.5) - 0.5"
    );
    assert_eq!(
        simple(|_, [x, _, _]| 2.0 * x.f(Op::Sin).pow(2) + x.f(Op::Sin)),
        "2*sqr(sin(x) + 0.25) - 0.125"
    );
    // These sums stay. The first one already has an exact enclosure. For the second one, rounding
    // would outweigh the gain.
    assert_eq!(simple(|_, [x, _, _]| x.pow(4) + 5.0 * x.pow(2)), "5*sqr(x) + sqr(sqr(x))");
    assert_eq!(simple(|_, [x, _, _]| x.pow(2) - 1000.0 * x), "sqr(x) - 1000*x");
}

#[test]
fn sines_of_twelfths_of_a_turn_are_exact() {
    for (twelfths, sine, cosine) in [
        (0, Some("0"), Some("1")),
        (1, Some("0.5"), None),
        (2, None, Some("0.5")),
        (3, Some("1"), Some("0")),
        (6, Some("0"), Some("-1")),
        (-3, Some("-1"), Some("0")),
        (20, None, Some("-0.5")),
        (27, Some("1"), Some("0")),
    ] {
        for (op, expected) in [(Op::Sin, sine), (Op::Cos, cosine)] {
            for (name, parts) in [(NamedConstant::Tau, 12.0), (NamedConstant::Pi, 6.0)] {
                let shown = simple(|s, _| {
                    (s.constant(Constant::Named(name)) * f64::from(twelfths) / parts).f(op)
                });
                match expected {
                    Some(expected) => assert_eq!(shown, expected, "{op:?} {twelfths}"),
                    None => assert!(shown.len() > 5, "{op:?} {twelfths}: {shown}"),
                }
            }
        }
    }
}

#[test]
fn signs_and_inverses_simplify() {
    assert_eq!(simple(|_, [x, _, _]| (-x).f(Op::Sin)), "-sin(x)");
    assert_eq!(simple(|_, [x, y, _]| (y - x).f(Op::Cos) - (x - y).f(Op::Cos)), "0");
    assert_eq!(simple(|_, [x, _, _]| (-2.0 * x).f(Op::Abs).f(Op::Abs)), "2*abs(x)");
    assert_eq!(simple(|_, [x, _, _]| x.pow(2).f(Op::Abs)), "sqr(x)");
    assert_eq!(simple(|_, [x, _, _]| (x - 3.0).f(Op::Abs)), "3 - x");
    assert_eq!(simple(|_, [x, _, _]| x.pow(2).f(Op::Sqrt)), "abs(x)");
    assert_eq!(simple(|_, [x, _, _]| x.pow(3).f(Op::Cbrt)), "x");
    assert_eq!(simple(|_, [x, _, _]| x.f(Op::Exp).f(Op::Ln)), "x");
    assert_eq!(simple(|_, [x, _, _]| (3.0 * x).f(Op::Sign)), "sign(x)");
    assert_eq!(
        simple(
            |_, [x, y, _]| x.apply(Op::Min, &[x]) + y.apply(Op::Max, &[x]) - x.apply(Op::Max, &[y])
        ),
        "x"
    );
    assert_eq!(simple(|_, [x, y, _]| (x + 5.0).apply(Op::Min, &[y])), "y");
    assert_eq!(simple(|s, [x, _, _]| x.apply(Op::Pow, &[s.number("0.5")])), "sqrt(x)");
    assert_eq!(simple(|s, [x, _, _]| x.apply(Op::Pow, &[s.number("1.5")])), "sqrt(x)^3");
    assert_eq!(simple(|s, [x, _, _]| x.apply(Op::Pow, &[s.number("4") / 2.0])), "sqr(x)");
    assert_eq!(
        simple(|s, [x, _, _]| s.number("4").f(Op::Sqrt) + s.number("8").f(Op::Cbrt) + x),
        "x + 4"
    );
    assert_eq!(
        simple(|_, [x, y, z]| (2.0 * x).apply(Op::SelectNegative, &[y, z])),
        "select_negative(x, y, z)"
    );
    assert_eq!(simple(|_, [x, y, z]| (x - 3.0).apply(Op::SelectNegative, &[y, z])), "y");
}

#[test]
fn an_exponent_that_varies_never_admits_negative_bases() {
    let text = simple(|s, [x, _, _]| {
        let b = s.parameter(1);
        x.apply(Op::Pow, &[b / b * 2.0])
    });
    assert_eq!(text, "where_nonneg(sqr(x), x)");
    // The exponent `round(atan(-2))` becomes an integer when constants are enclosed.
    let text = simple(|s, [x, y, _]| {
        let exponent = (x - x + s.number("-2")).f(Op::Atan).f(Op::Round);
        y.apply(Op::Pow, &[exponent])
    });
    assert_eq!(text, "where_positive(y^(-round(atan(2))), y)");
}

#[test]
fn numbers_known_by_bounds_only_never_cancel() {
    let close = Constant::decimal("1e400").expect("a decimal");
    assert!(close.exact().is_none());
    let text = simple(|s, [x, _, _]| s.constant(close.clone()) * x - s.constant(close.clone()) * x);
    assert_ne!(text, "0");
    let like = |op: Op| {
        simple(|s, [x, _, _]| {
            let [a, b] = [0, 1].map(|_| x + s.constant(close.clone()));
            a.apply(op, &[b])
        })
    };
    for op in [Op::Sub, Op::Div, Op::Mul, Op::Min, Op::Mod] {
        assert_eq!(like(op).matches('[').count(), 2, "{}", like(op));
    }
    assert_eq!(
        simple(|s, [x, _, _]| s.constant(Constant::Named(NamedConstant::Pi)) * x
            - x * s.constant(Constant::Named(NamedConstant::Pi))),
        "0"
    );
}

#[test]
fn multiples_too_large_to_add_up_are_counted_once_each() {
    // The fourth powers of the first and third number are below 2^512 / 9. That of the second is
    // between 2^512 / 9 and 2^512, and that of the fourth is above 2^512.
    for number in ["3", "340282326356119256160033759537265639424", "1e38", "5e38"] {
        let builder = TestGraphBuilder::default();
        let [_, y, _] = builder.xyz();
        let one = (builder.number(number) * y).pow(4);
        let two = one + one;
        for root in
            [two + one, two + two + one, two + two - one, two * 2.0 + two + one, -one - one - two]
        {
            let graph = builder.graph();
            let (after, roots) = rewrite(&graph, &[root.id], &[DOMAIN; 3], &[]).expect("small");
            let at = [0.0, 0.75, 0.0];
            let (before, _) = evaluate(&graph, at, &[])[root.id.index()].expect("a value");
            let (value, _) = evaluate(&after, at, &[])[roots[0].index()].expect("a value");
            let text = display(&after, roots[0], &[]);
            assert!((value / before - 1.0).abs() < 1e-12, "{text}: {value} for {before}");
        }
    }
}

#[test]
fn long_and_deep_input_takes_little_time() {
    let builder = TestGraphBuilder::default();
    let [x, y, z] = builder.xyz();
    let (mut sum, mut nest, mut tower, mut product, mut shared) = (x, x, x, x, x);
    for n in 0..20_000_i32 {
        sum = sum + x * f64::from(n) + y;
        nest = f64::from(n % 7) - (nest - z * f64::from(n));
        tower = tower.pow(2);
        product = product * (y + f64::from(n));
        if n < 2000 {
            shared = shared * shared + shared;
        }
    }
    let graph = builder.graph();
    for root in [sum, nest, tower, product, shared] {
        let (after, _) = simplify(&graph, &[root.id], &[DOMAIN; 3], &[]).expect("within the limit");
        assert!(after.len() < 100_000);
    }
}

#[test]
fn too_large_a_graph_is_an_error() {
    let mut graph = Graph::new();
    let mut root = graph.variable(crate::Axis::X);
    for _ in 0..=NODE_LIMIT {
        root = graph.apply(Op::Sin, &[root]);
    }
    let result = simplify(&graph, &[root], &[DOMAIN; 3], &[]);
    assert_eq!(result.err(), Some(IrError::TooLarge { limit: NODE_LIMIT }));
}

#[test]
fn values_and_domains_are_kept() {
    let mut compared = 0;
    let seed = 0x5eed_0001;
    let parameters = [DOMAIN, Interval { lo: 1.0, hi: 2.0 }];
    for case in 0..20_000_u64 {
        let mut random = Random(seed + case);
        let size = 1 + random.below(12);
        let (graph, root) = random.graph(size);
        let (after, roots) = rewrite(&graph, &[root], &[DOMAIN; 3], &parameters).expect("small");
        let (folded, folded_roots) =
            simplify(&graph, &[root], &[DOMAIN; 3], &parameters).expect("small");
        for _ in 0..8 {
            let at = [random.coordinate(), random.coordinate(), random.coordinate()];
            let values = [random.coordinate(), 1.0 + random.coordinate().abs() / 2.0];
            let before = evaluate(&graph, at, &values)[root.index()];
            for (after, root_after) in [(&after, roots[0]), (&folded, folded_roots[0])] {
                let after_value = evaluate(after, at, &values)[root_after.index()];
                let same = match (before, after_value) {
                    (Some((_, e)), None) | (None, Some((_, e))) => !e.is_finite(),
                    (Some((a, e)), Some((b, f))) => {
                        if e.is_finite() && f.is_finite() {
                            compared += 1;
                        }
                        !(e + f).is_finite() || (a - b).abs() <= e + f
                    }
                    (None, None) => {
                        compared += 1;
                        true
                    }
                };
                assert!(
                    same,
                    "seed {:#x}: {} became {} at {at:?} {values:?}: {before:?} {after_value:?}",
                    seed + case,
                    display(&graph, root, &["a", "b"]),
                    display(after, root_after, &["a", "b"]),
                );
            }
        }
    }
    assert!(compared > 100_000, "{compared}");
}

/// The bounds and facts of a node over the box `at`, with exact parameters.
fn enclosure(graph: &Graph, root: NodeId, at: &[Interval; 3], values: &[f64]) -> (Interval, Facts) {
    let mut all: Vec<zeroset_interval::Decorated> = Vec::with_capacity(graph.len());
    for (_, node) in graph.iter() {
        all.push(match node {
            Node::Variable(axis) => (at[*axis as usize], Facts::TOTAL).into(),
            Node::Parameter(number) => {
                let value = values[*number as usize];
                (Interval { lo: value, hi: value }, Facts::TOTAL).into()
            }
            Node::Constant(constant) => constant.value(),
            Node::Apply(op, operands) => {
                let operands: Vec<_> = operands.iter().map(|id| all[id.index()]).collect();
                zeroset_interval::fold(*op, &operands).into()
            }
        });
    }
    let zeroset_interval::Decorated { bounds, facts, .. } = all[root.index()];
    (bounds, facts)
}

/// Returns whether every exponent is a constant node. Interval rules treat any other exponent as
/// real. Simplifying such an exponent to an integer may change how bases below 0 are treated.
fn exponents_are_numbers(graph: &Graph) -> bool {
    graph.iter().all(|(_, node)| match node {
        Node::Apply(Op::Pow, operands) => matches!(graph.node(operands[1]), Node::Constant(_)),
        Node::Variable(_) | Node::Parameter(_) | Node::Constant(_) | Node::Apply(..) => true,
    })
}

fn jumps(graph: &Graph) -> bool {
    graph.iter().any(|(_, node)| match node {
        Node::Apply(op, _) => op.row().continuity == Continuity::Jumps,
        Node::Variable(_) | Node::Parameter(_) | Node::Constant(_) => false,
    })
}

#[test]
fn enclosures_do_not_widen() {
    let seed = 0x71e7_0000;
    let parameters = [DOMAIN, Interval { lo: 1.0, hi: 2.0 }];
    let (mut narrower, mut compared) = (0, 0);
    for case in 0..30_000_u64 {
        let mut random = Random(seed + case);
        let size = 1 + random.below(10);
        let (graph, root) = random.graph(size);
        if !exponents_are_numbers(&graph) {
            continue;
        }
        let (after, roots) = simplify(&graph, &[root], &[DOMAIN; 3], &parameters).expect("small");
        for _ in 0..4 {
            let at = [0; 3].map(|_| {
                let (a, b) = (random.coordinate(), random.coordinate());
                Interval { lo: a.min(b), hi: a.max(b) }
            });
            let values = [random.coordinate(), 1.0 + random.coordinate().abs() / 2.0];
            let (old, old_facts) = enclosure(&graph, root, &at, &values);
            let (new, new_facts) = enclosure(&after, roots[0], &at, &values);
            if old_facts.has(Facts::NOWHERE) || new_facts.has(Facts::NOWHERE) {
                continue;
            }
            compared += 1;
            // Rounding a coefficient may move an operand past the end of a domain that it just
            // reaches.
            let wider = at.map(|a| Interval { lo: a.lo - 1e-12, hi: a.hi + 1e-12 });
            let keeps_facts = new_facts.has(old_facts)
                || !enclosure(&graph, root, &wider, &values).1.has(old_facts);
            let slack = 1e-9 * (1.0 + old.magnitude().min(f64::MAX));
            narrower += u32::from(old.lo < new.lo - slack || old.hi > new.hi + slack);
            // Rounding in another order may move an operand to the other side of a jump. A part
            // that is defined nowhere in the box has any bounds; in a larger box it may have some.
            let (old, old_facts) = if jumps(&graph) {
                let out = |end: f64, sign: f64| end + sign * 1e-12 * (1.0 + end.abs());
                let larger =
                    at.map(|range| Interval { lo: out(range.lo, -1.0), hi: out(range.hi, 1.0) });
                let (wide, wide_facts) = enclosure(&graph, root, &larger, &values);
                (Interval { lo: wide.lo.min(old.lo), hi: wide.hi.max(old.hi) }, wide_facts)
            } else {
                (old, old_facts)
            };
            assert!(
                new.lo >= old.lo - slack && new.hi <= old.hi + slack && keeps_facts,
                "seed {:#x}: {} on {at:?} {values:?}: {old:?} {old_facts:?}, became {}: {new:?} {new_facts:?}",
                seed + case,
                display(&graph, root, &["a", "b"]),
                display(&after, roots[0], &["a", "b"]),
            );
        }
    }
    assert!(compared > 50_000 && narrower > 1000, "{compared} {narrower}");
}

/// Checks the properties in the table that simplification relies on, by values in plain `f64`.
#[test]
fn rows_state_what_is_true() {
    let value = |op: Op, a: f64| {
        let builder = TestGraphBuilder::default();
        let [x, _, _] = builder.xyz();
        let id = x.f(op).id;
        evaluate(&builder.graph(), [a, 0.0, 0.0], &[])[id.index()]
    };
    let near = |a: f64, b: f64| (a - b).abs() <= 1e-12 * (1.0 + a.abs());
    for row in TABLE.iter().filter(|row| row.arity == 1) {
        for &(argument, result) in row.values {
            let (found, _) = value(row.op, argument.into()).expect("defined");
            assert!(near(found, result.into()), "{}({argument}) = {found}", row.name);
        }
        for step in 1..200 {
            let a = f64::from(step) * 0.0371;
            let sign = match row.parity {
                Parity::Even => Some(1.0),
                Parity::Odd => Some(-1.0),
                Parity::Neither => None,
            };
            if let Some(sign) = sign {
                let [plus, minus] = [a, -a].map(|a| value(row.op, a));
                assert_eq!(plus.is_some(), minus.is_some(), "{} at {a}", row.name);
                let (Some((plus, _)), Some((minus, _))) = (plus, minus) else {
                    continue; // outside the domain
                };
                assert!(near(plus, sign * minus), "{} at {a}: {plus}, {minus}", row.name);
            }
            if let Some(parts) = row.quotient {
                let (whole, _) = value(row.op, a).expect("between poles");
                let [(above, _), (below, _)] = parts.map(|op| value(op, a).expect("no poles"));
                assert!(near(whole, above / below), "{} at {a}: {whole}", row.name);
            }
        }
        if let Class::Function(Law::Undoes(inner)) = row.class {
            for step in 1..200 {
                let a = f64::from(step) * 0.0371;
                let (between, _) = value(inner, a).expect("defined");
                let Some((found, _)) = value(row.op, between) else {
                    assert!(between.abs() >= 1.0, "{} of {between}", row.name);
                    continue; // tanh a rounds to 1
                };
                // The result may be off by as much as rounding the intermediate value changes it.
                let step = between.abs() * f64::EPSILON;
                let (next, _) = value(row.op, between - step).expect("defined");
                let conditioned = near(found, a) || (found - a).abs() <= (found - next).abs();
                assert!(conditioned, "{}({}({a})) = {found}", row.name, inner.row().name);
            }
        }
    }
}
