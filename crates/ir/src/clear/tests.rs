use super::*;
use crate::display;
use crate::testing::{Exactly, Random, TestExpr, TestGraphBuilder, evaluate, evaluate_exactly};
use num_rational::BigRational;
use num_traits::Zero;

fn cleared(
    formula: impl for<'a> Fn([TestExpr<'a>; 3], TestExpr<'a>) -> TestExpr<'a>,
) -> Option<[String; 2]> {
    let builder = TestGraphBuilder::default();
    let root = formula(builder.xyz(), builder.parameter(0)).id;
    let mut graph = builder.graph();
    let cleared = clear(&mut graph, root)?;
    Some([cleared.numerator, cleared.denominator].map(|id| display(&graph, id, &["w"])))
}

#[allow(clippy::unnecessary_wraps)] // compared with an `Option`
fn pair(numerator: &str, denominator: &str) -> Option<[String; 2]> {
    Some([numerator.into(), denominator.into()])
}

#[test]
fn poles_are_cleared_through_arithmetic() {
    assert_eq!(
        cleared(|[x, y, z], _| 1.0 / (x - y.pow(2)) - z),
        pair("1 - z*(x - y^2)", "x - y^2")
    );
    let tan = cleared(|[x, y, z], _| x.f(Op::Tan) + y.f(Op::Tan) - z);
    assert_eq!(tan, pair("sin(x)*cos(y) + sin(y)*cos(x) - z*cos(x)*cos(y)", "cos(x)*cos(y)"));
    assert_eq!(cleared(|[x, y, _], _| y * x.pow(-2) + 1.0), pair("y + sqr(x)", "sqr(x)"));
    assert_eq!(cleared(|[x, y, _], _| (y / x).pow(3) - 1.0), pair("y^3 - x^3", "x^3"));
    assert_eq!(cleared(|[x, y, _], _| -(y / (2.0 * x)).f(Op::Sqr)), pair("-sqr(y*0.5)", "sqr(x)"));
}

#[test]
fn a_shared_denominator_is_not_multiplied() {
    assert_eq!(cleared(|[x, y, z], _| x / z + y / z), pair("x + y", "z"));
    assert_eq!(cleared(|[x, y, z], _| 1.0 / (x * z) + y / z), pair("1 + y*x", "x*z"));
    assert_eq!(cleared(|[x, y, _], _| 1.0 / x.f(Op::Sqr) - y / x), pair("1 - y*x", "sqr(x)"));
}

#[test]
fn poles_of_a_divisor_stay_undefined() {
    assert_eq!(cleared(|[x, y, _], _| y / (1.0 / x)), pair("y", "x"));
    assert_eq!(cleared(|[x, y, _], _| y / (1.0 / x) - 1.0), pair("y*x - 1", "x"));
}

#[test]
fn common_factors_are_removed() {
    assert_eq!(
        cleared(|[x, y, z], _| z - (x.pow(2) - y.pow(2)) / (x - y)),
        pair("z + (-y - x)", "x - y")
    );
    assert_eq!(
        cleared(|[x, _, z], _| z - (x.pow(2) - 1.0) / (x - 1.0)),
        pair("z - (x + 1)", "x - 1")
    );
    assert_eq!(cleared(|[x, y, _], _| x / (x - y) - y / (x - y)), pair("1", "x - y"));
    assert_eq!(cleared(|[x, y, _], _| (x - y).f(Op::Sqr) / (y - x)), pair("1", "y - x"));
    let scaled = cleared(|[x, y, z], w| z - w * (x * 2.0 - y * 2.0) / (y - x));
    assert_eq!(scaled, pair("z - (-2)*w", "y - x"));
}

#[test]
fn differences_of_functions_have_factors() {
    let sinc = |a: &str| {
        format!("min(max(sin({a})/({a}), 1 - sqr({a})/6), 1 - sqr({a})/6 + sqr(sqr({a}))/120)")
    };
    let show = |formula: [String; 2]| formula.map(|text| text.replace("(x)", "x"));
    assert_eq!(
        cleared(|[x, _, z], _| z - x.f(Op::Sin) / x).map(show),
        Some(show([format!("z - {}", sinc("x")), "x".into()]))
    );
    // If y is 0, the function is 0, and x·y is 0 too: the extension needs a value there.
    let [partial, _] = cleared(|[x, y, _], _| (x * y).f(Op::Sin) / x).expect("a pole");
    assert!(partial.starts_with("y*otherwise("), "{partial}");
    let [whole, below] = cleared(|[x, y, z], _| z - (x * y).f(Op::Sin) / (x * y)).expect("a pole");
    assert!(whole.starts_with("z - min(") && below == "x*y", "{whole} over {below}");
    let formulas: [fn([TestExpr<'_>; 3]) -> [NodeId; 2]; 14] = [
        |[x, y, _]| [((x + y).f(Op::Exp) - 1.0) / (x + y), x + y].map(|term| term.id),
        |[x, ..]| [x.f(Op::Tan) / x, x].map(|term| term.id),
        |[x, ..]| [(1.0 - x.f(Op::Cos)) / x.pow(2), x].map(|term| term.id),
        |[x, ..]| [(x + 1.0).f(Op::Ln) / x, x].map(|term| term.id),
        |[x, ..]| [x.f(Op::Asin) / x, x].map(|term| term.id),
        |[x, ..]| [(x * 3.0).f(Op::Sin) * 2.0 / x, x].map(|term| term.id),
        |[x, ..]| [x / (x.f(Op::Exp) - 1.0), x].map(|term| term.id),
        |[x, ..]| [(x.f(Op::Exp) - 1.0) / x.f(Op::Sin), x].map(|term| term.id),
        |[x, ..]| [((x + 1.0).f(Op::Sqrt) - 1.0) / x, x].map(|term| term.id),
        |[x, y, _]| [(x.f(Op::Exp) - y.f(Op::Exp)) / (x - y), x - y].map(|term| term.id),
        |[x, y, _]| [(x.f(Op::Cos) - y.f(Op::Cos)) / (x - y), x - y].map(|term| term.id),
        |[x, y, _]| [(x.f(Op::Tan) - y.f(Op::Tan)) / (x - y), x - y].map(|term| term.id),
        |[x, y, _]| [(x.f(Op::Ln) - y.f(Op::Ln)) / (x - y), x - y].map(|term| term.id),
        |[x, ..]| [((x + 4.0).f(Op::Sqrt) - 2.0) / x, x].map(|term| term.id),
    ];
    for (case, formula) in formulas.into_iter().enumerate() {
        let builder = TestGraphBuilder::default();
        let [root, factor] = formula(builder.xyz());
        let cleared = clear(&mut builder.graph(), root).expect("a pole");
        assert_eq!(cleared.removed, Some(factor), "case {case}");
    }
}

#[test]
fn quotients_by_factors_in_two_variables_have_no_pole_left() {
    let formulas: [fn([TestExpr<'_>; 3]) -> [NodeId; 2]; 8] = [
        |[x, y, _]| {
            let above = y.pow(2) * x.f(Op::Cosh) - x.pow(2) * y.f(Op::Cosh);
            [above / (x.pow(2) - y.pow(2)), x.pow(2) - y.pow(2)].map(|term| term.id)
        },
        |[x, y, _]| {
            let above = x * y.f(Op::Sin) - y * x.f(Op::Sin);
            [above / (x.pow(2) - y.pow(2)), x.pow(2) - y.pow(2)].map(|term| term.id)
        },
        |[x, y, _]| [(x * y.f(Op::Exp) - y * x.f(Op::Exp)) / (x - y), x - y].map(|term| term.id),
        |[x, y, _]| [(x.f(Op::Atan) - y.f(Op::Atan)) / (x - y), x - y].map(|term| term.id),
        |[x, y, _]| [(x.f(Op::Tanh) - y.f(Op::Tanh)) / (x - y), x - y].map(|term| term.id),
        |[x, y, _]| [(x.f(Op::Asinh) - y.f(Op::Asinh)) / (x - y), x - y].map(|term| term.id),
        |[x, y, _]| {
            let [a, b] = [x, y].map(|term| term.f(Op::Sin).f(Op::Exp));
            [(a - b) / (x - y), x - y].map(|term| term.id)
        },
        |[x, y, _]| {
            let [a, b] = [x, y].map(|term| term.pow(2).f(Op::Cos));
            [(a - b) / (y.pow(2) - x.pow(2)), y.pow(2) - x.pow(2)].map(|term| term.id)
        },
    ];
    for (case, formula) in formulas.into_iter().enumerate() {
        let builder = TestGraphBuilder::default();
        let [root, factor] = formula(builder.xyz());
        let mut graph = builder.graph();
        let cleared = clear(&mut graph, root).expect("a pole");
        let removed = cleared.removed.expect("a factor");
        let mut work = crate::polynomial::Work(1000);
        let [removed, factor] =
            [removed, factor].map(|id| crate::polynomial::Polynomial::of(&graph, id, &mut work));
        let rest = removed.divided(&factor, &mut work).and_then(|rest| rest.as_constant());
        assert!(rest.is_some(), "case {case}: {removed:?}");
    }
}

#[test]
fn numerators_that_do_not_vanish_keep_their_poles() {
    let formulas: [fn([TestExpr<'_>; 3]) -> NodeId; 5] = [
        |[x, y, _]| ((x.f(Op::Sin) + y.f(Op::Sin)) / (x - y)).id,
        |[x, y, _]| ((x * x.f(Op::Cosh) - y.pow(2) * y.f(Op::Cosh)) / (x - y)).id,
        |[x, y, _]| ((x.f(Op::Atan) + y.f(Op::Atan) * 2.0) / (x + y)).id,
        |[x, y, _]| ((x.f(Op::Sin).f(Op::Exp) - y.f(Op::Cos).f(Op::Exp)) / (x - y)).id,
        |[x, y, _]| ((x.pow(2) + y.pow(2)) / (x.pow(2) - y.pow(2))).id,
    ];
    for (case, formula) in formulas.into_iter().enumerate() {
        let builder = TestGraphBuilder::default();
        let root = formula(builder.xyz());
        let cleared = clear(&mut builder.graph(), root).expect("a pole");
        assert_eq!(cleared.removed, None, "case {case}");
    }
    // exp(x) − exp(y) is 0 where x is y, and not where x is −y.
    let builder = TestGraphBuilder::default();
    let [x, y, _] = builder.xyz();
    let root = ((x.f(Op::Exp) - y.f(Op::Exp)) / (x.pow(2) - y.pow(2))).id;
    let mut graph = builder.graph();
    let cleared = clear(&mut graph, root).expect("a pole");
    let removed = cleared.removed.map(|id| display(&graph, id, &[]));
    assert!(removed.is_some_and(|removed| removed == "x - y" || removed == "y - x"));
}

#[test]
fn zeros_outside_of_the_domain_are_dropped() {
    let cut = |[x, y, _]: [TestExpr<'_>; 3]| (x * y).apply(Op::WhereNonzero, &[x]).id;
    let builder = TestGraphBuilder::default();
    let root = cut(builder.xyz());
    let mut graph = builder.graph();
    let cleared = clear(&mut graph, root).expect("a restriction");
    let [numerator, denominator] =
        [cleared.numerator, cleared.denominator].map(|id| display(&graph, id, &[]));
    assert_eq!((&*numerator, &*denominator), ("y", "x"));
}

#[test]
fn what_has_no_pole_in_space_is_left() {
    assert_eq!(cleared(|[x, _, _], w| x / w + x / 3.0), None);
    assert_eq!(cleared(|[x, _, _], _| (1.0 / x).f(Op::Sin)), None);
    assert_eq!(cleared(|[x, _, _], w| w.f(Op::Tan) * x), None);
    assert_eq!(cleared(|[x, _, _], w| 1.0 / (x * w)), pair("1/w", "x"));
}

#[test]
fn poles_with_the_same_bounds_are_not_the_same_pole() {
    // Both numbers have 158 digits, too long to be exact. They become enclosures with equal
    // bounds.
    let digits = "3".repeat(157);
    let builder = TestGraphBuilder::default();
    let [x, y, z] = builder.xyz();
    let [first, second] = ["1", "9"].map(|last| builder.number(&format!("0.{digits}{last}")));
    let root = (y / (x + first) - z / (x + second)).id;
    let mut graph = builder.graph();
    let numerator = clear(&mut graph, root).expect("poles").numerator;
    let text = display(&graph, numerator, &[]);
    assert_eq!(text.matches('*').count(), 2, "{text}: not y - z");
}

#[test]
fn many_poles_do_not_multiply_for_ever() {
    let builder = TestGraphBuilder::default();
    let [x, y, _] = builder.xyz();
    let mut sum = y;
    for n in 0..500 {
        sum = sum + 1.0 / (x - f64::from(n));
    }
    let mut graph = builder.graph();
    let before = graph.len();
    clear(&mut graph, sum.id);
    assert!(graph.len() < 20 * before, "{} from {before}", graph.len());
}

/// A random quotient whose numerator and denominator have factors in common.
fn quotient(random: &mut Random, graph: &mut Graph) -> NodeId {
    let axes = crate::Axis::ALL.map(|axis| graph.variable(axis));
    let small = |random: &mut Random, graph: &mut Graph| {
        let [a, b] = [0; 2].map(|_| axes[random.below(3)]);
        let number = graph.integer(random.below(5) as i64 - 2);
        match random.below(6) {
            0 => a,
            1 => graph.apply(Op::Mul, &[a, b]),
            2 => graph.apply(Op::Sub, &[a, b]),
            3 => graph.apply(Op::Add, &[a, number]),
            4 => {
                let product = graph.apply(Op::Mul, &[number, b]);
                graph.apply(Op::Sub, &[a, product])
            }
            _ => {
                let [a, b] = [a, b].map(|id| graph.apply(Op::Sqr, &[id]));
                graph.apply(Op::Sub, &[a, b])
            }
        }
    };
    let (h, p, q) = (small(random, graph), small(random, graph), small(random, graph));
    let rows: Vec<_> = zeroset_ops::TABLE.iter().filter(|row| !row.secants.is_empty()).collect();
    let vanishing = |random: &mut Random, graph: &mut Graph| match random.below(7) {
        0 => h,
        1 => graph.apply(Op::Mul, &[h, p]),
        2 => {
            let sum = graph.apply(Op::Mul, &[h, q]);
            graph.apply(Op::Sub, &[sum, h])
        }
        // f(u + h) − f(u), or f(u + h) − f(n) for a number n and u = n.
        3 | 4 => {
            const OPS: [Op; 8] =
                [Op::Exp, Op::Sin, Op::Cos, Op::Sinh, Op::Cosh, Op::Sqrt, Op::Cbrt, Op::Ln];
            let op = OPS[random.below(8)];
            let number = graph.integer([0, 1, 4][random.below(3)]);
            let u = [number, q, p][random.below(3)];
            let step = if random.below(2) == 0 { graph.apply(Op::Mul, &[h, q]) } else { h };
            let sum = graph.apply(Op::Add, &[u, step]);
            let values = [sum, u].map(|id| graph.apply(op, &[id]));
            graph.apply(Op::Sub, &values)
        }
        _ => {
            let row = rows[random.below(rows.len())];
            let [at, value] =
                [row.secants[0].at, row.secants[0].value].map(|n| graph.integer(n.into()));
            let u = if random.below(2) == 0 { graph.apply(Op::Mul, &[h, q]) } else { h };
            let u = graph.apply(Op::Add, &[u, at]);
            let f = graph.apply(row.op, &[u]);
            graph.apply(Op::Sub, &[f, value])
        }
    };
    let mut above = vanishing(random, graph);
    let mut below = if random.below(2) == 0 { h } else { vanishing(random, graph) };
    if random.below(3) == 0 {
        above = graph.apply(Op::Sqr, &[above]);
    }
    if random.below(3) == 0 {
        below = graph.apply(Op::Mul, &[below, p]);
    }
    let quotient = graph.apply(Op::Div, &[above, below]);
    match random.below(7) {
        0 => graph.apply(Op::Sub, &[quotient, q]),
        1 => graph.apply(Op::Mul, &[quotient, q]),
        2 => {
            let other = graph.apply(Op::Div, &[q, h]);
            graph.apply(Op::Add, &[quotient, other])
        }
        // The pole of a divisor, and a second factor to remove.
        3 => {
            let pole = graph.apply(Op::Div, &[p, q]);
            let other = graph.apply(Op::Div, &[h, pole]);
            graph.apply(Op::Sub, &[other, q])
        }
        4 => {
            let both = graph.apply(Op::Mul, &[p, q]);
            let other = graph.apply(Op::Div, &[both, q]);
            graph.apply(Op::Sub, &[quotient, other])
        }
        _ => quotient,
    }
}

/// Points lie on a grid, so that many of them are zeros of factors.
#[test]
fn quotients_equal_their_extensions_at_random_points() {
    let seed = 0x9a0_0000;
    let cases = std::env::var("ZEROSET_CASES").ok().and_then(|n| n.parse().ok());
    let cases: u64 = cases.unwrap_or(10_000).max(1000);
    println!("seed {seed:#x}, {cases} formulas");
    let (mut compared, mut removed, mut zeros, mut undefined) = (0, 0, 0, 0);
    for case in 0..cases {
        let mut random = Random(seed + case);
        let mut graph = Graph::new();
        let root = quotient(&mut random, &mut graph);
        let mut cancellation = Cancellation::default();
        let Some(part) = fraction(&mut graph, root, &mut cancellation) else { continue };
        removed += usize::from(!part.removed.is_empty());
        let [above, below] = {
            let one = graph.integer(1);
            let numerator = product(&mut graph, part.numerator, &part.above);
            [numerator, product(&mut graph, one, &part.below)]
        };
        let form = clear(&mut graph, root).expect("as before");
        for _ in 0..10 {
            let quarters = [0; 3].map(|_| random.below(9) as i64 - 4);
            let exact = quarters.map(|n| BigRational::new(n.into(), 4.into()));
            let exact = evaluate_exactly(&graph, &exact);
            let [f, n, d] =
                [root, form.numerator, form.denominator].map(|id| exact[id.index()].clone());
            let at = quarters.map(|n| n as f64 / 4.0);
            let context = || {
                let [root, above, below, n, d] =
                    [root, above, below, form.numerator, form.denominator]
                        .map(|id| display(&graph, id, &[]));
                format!(
                    "seed {:#x}: {root} is {above} over {below}, \
                         its zeros those of {n} where {d} is not 0, at {at:?}",
                    seed + case
                )
            };
            let zero = Exactly::Number(BigRational::zero());
            match &f {
                Exactly::Undefined => {
                    let is_excluded = d == zero || !matches!(d, Exactly::Number(_));
                    undefined += usize::from(d == zero);
                    assert!(n != zero || is_excluded, "{}", context());
                }
                Exactly::Unknown => {}
                f => {
                    assert!(n != Exactly::Undefined && d != Exactly::Undefined, "{}", context());
                    assert!(d != zero, "{}", context());
                    if matches!((f, &n), (Exactly::Number(_), Exactly::Number(_))) {
                        zeros += usize::from(n == zero);
                        assert_eq!(*f == zero, n == zero, "{}", context());
                    }
                }
            }
            let values = evaluate(&graph, at, &[]);
            let value = |id: NodeId| values[id.index()].filter(|(_, error)| error.is_finite());
            let found = [root, above, below].map(value);
            let [Some((f, ef)), Some((above, ea)), Some((below, eb))] = found else { continue };
            compared += 1;
            let error = ef * below.abs() + ea + f.abs() * eb;
            let difference = (above - f * below).abs();
            assert!(difference <= 1e-9 * (1.0 + above.abs()) + 2.0 * error, "{}", context());
        }
    }
    assert!(compared > 4 * cases && removed as u64 > cases / 2, "{compared} {removed}");
    assert!(zeros as u64 > cases / 4 && undefined as u64 > cases / 4, "{zeros} {undefined}");
}

fn filled(formula: impl for<'a> Fn([TestExpr<'a>; 3]) -> TestExpr<'a>) -> String {
    let builder = TestGraphBuilder::default();
    let root = formula(builder.xyz()).id;
    let mut graph = builder.graph();
    let filled = without_gaps(&mut graph, root, &[]);
    if filled == root { "the same".to_owned() } else { display(&graph, filled, &[]) }
}

#[test]
fn gaps_are_filled_inside_of_other_operations() {
    assert_eq!(filled(|[x, y, z]| z - (x.pow(2) - y.pow(2)) / (x - y)), "z - (-(-y - x))");
    let inside =
        filled(|[x, y, z]| ((x * y) / y).f(Op::Abs).apply(Op::Max, &[z - x.f(Op::Sqr) / x]));
    assert_eq!(inside, "max(abs(x), z - x)");
    assert_eq!(filled(|[x, y, _]| (x * y).apply(Op::WhereNonzero, &[x])), "x*y");
    let pole = filled(|[x, y, _]| x.f(Op::Tan) / x - y);
    assert!(pole.starts_with("otherwise(") && pole.ends_with("/cos(x) - y"), "{pole}");
}

#[test]
fn a_domain_stays_if_its_terms_cancel() {
    let text = filled(|[x, y, _]| {
        let ln = y.f(Op::Ln);
        (y * (x + ln) - y * ln) / x
    });
    assert_eq!(text, "where_defined(y, ln(y))");
}

#[test]
fn gaps_with_an_interior_stay() {
    // The factor is 0 where x ≤ 0.
    assert_eq!(filled(|[x, y, _]| (x.f(Op::Abs) + x) * y / (x.f(Op::Abs) + x)), "the same");
    assert_eq!(filled(|[x, y, _]| x.f(Op::Floor) * y / x.f(Op::Floor)), "the same");
    assert_eq!(filled(|[x, y, _]| y / x + 1.0), "the same");
    // The pole of a divisor: y + |y| is 0 where y ≤ 0.
    assert_eq!(filled(|[x, y, _]| x / (x.f(Op::Sqr) / (y.f(Op::Abs) + y))), "the same");
    assert_eq!(filled(|[x, y, _]| x / (x.f(Op::Sqr) / y)), "y/x");
}

#[test]
fn filled_functions_equal_the_given_ones() {
    let seed = 0xf111_0000;
    println!("seed {seed:#x}");
    let (mut equal, mut filled) = (0, 0);
    for case in 0..4000 {
        let mut random = Random(seed + case);
        let mut graph = Graph::new();
        let root = quotient(&mut random, &mut graph);
        let without = without_gaps(&mut graph, root, &[]);
        for _ in 0..10 {
            let quarters = [0; 3].map(|_| random.below(9) as i64 - 4);
            let at = quarters.map(|n| BigRational::new(n.into(), 4.into()));
            let values = evaluate_exactly(&graph, &at);
            let [f, g] = [root, without].map(|id| &values[id.index()]);
            let context = || {
                let [f, g] = [root, without].map(|id| display(&graph, id, &[]));
                format!("seed {:#x}: {f}, {g} at {quarters:?}/4", seed + case)
            };
            match (f, g) {
                (Exactly::Number(a), Exactly::Number(b)) => {
                    equal += 1;
                    assert_eq!(a, b, "{}", context());
                }
                (Exactly::Number(_) | Exactly::Defined, g) => {
                    assert_ne!(*g, Exactly::Undefined, "{}", context());
                }
                (Exactly::Undefined, g) => filled += usize::from(*g != Exactly::Undefined),
                (Exactly::Unknown, _) => {}
            }
        }
    }
    assert!(equal > 5000 && filled > 2000, "{equal} {filled}");
}

#[test]
fn zeros_and_values_agree_at_random_points() {
    let seed = 0xc1ea_0000;
    let mut compared = 0;
    for case in 0..80_000_u64 {
        let mut random = Random(seed + case);
        let size = 1 + random.below(10);
        let (mut graph, root) = random.graph(size);
        let Some(cleared) = clear(&mut graph, root) else {
            continue;
        };
        for _ in 0..8 {
            let at = [random.coordinate(), random.coordinate(), random.coordinate()];
            let parameters = [random.coordinate(), random.coordinate()];
            let values = evaluate(&graph, at, &parameters);
            let [f, n, d] =
                [root, cleared.numerator, cleared.denominator].map(|id| values[id.index()]);
            let context = || {
                format!(
                    "seed {:#x}: f = {}, N = {}, D = {} at {at:?} {parameters:?}",
                    seed + case,
                    display(&graph, root, &[]),
                    display(&graph, cleared.numerator, &[]),
                    display(&graph, cleared.denominator, &[]),
                )
            };
            let Some((f, ef)) = f.filter(|f| f.1.is_finite()) else {
                continue;
            };
            let (n, en) = n.unwrap_or_else(|| panic!("no numerator: {}", context()));
            let (d, ed) = d.unwrap_or_else(|| panic!("no denominator: {}", context()));
            if !(en.is_finite() && ed.is_finite()) {
                continue;
            }
            compared += 1;
            assert!(d != 0.0 || ed > 0.0, "{}", context());
            // If the function is clearly not 0, the numerator must not be exactly 0. If the
            // numerator is clearly not 0, the function must not be exactly 0.
            assert!(f.abs() <= ef || n.abs() + en > 0.0, "{}", context());
            assert!(n.abs() <= en || f.abs() + ef > 0.0, "{}", context());
        }
    }
    assert!(compared > 10_000, "{compared}");
}
