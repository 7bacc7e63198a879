//! Rational forms: a function with poles as a quotient of two functions without poles.
//!
//! Near a pole every enclosure of `1/x − y` is unbounded and proves nothing. Its numerator `1 −
//! x·y` is bounded. If the numerator has no zero in a box, the function has none there.

use crate::algebra::{div, is_one, is_zero, mul, neg, powi, sum};
use crate::graph::{Graph, Node, NodeId};
use crate::variability::{Variability, variabilities};
use std::collections::{BTreeMap, BTreeSet};
use zeroset_ops::{Class, Op};

/// Largest number of distinct factors in a denominator. A quotient with more factors stays as it
/// is, because each factor would cost a product of all others.
const FACTOR_LIMIT: usize = 16;
/// Largest exponent of a factor. Poles of higher powers are not cleared.
const EXPONENT_LIMIT: u32 = 64;

/// A function f in rational form.
///
/// Within its domain of definition, f is 0 exactly where the numerator is 0. At points where the
/// denominator is 0, f is undefined. Numerator over denominator equals f, unless f divides by a
/// function with poles. Then the two may differ by a factor that has no zero in the domain of
/// definition.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RationalForm {
    /// Node that is 0 where f is 0.
    pub numerator: NodeId,
    /// Node that is 0 at the poles of f.
    pub denominator: NodeId,
}

/// A product of powers, as the exponent of each base.
type Factors = BTreeMap<NodeId, u32>;

/// The fraction `numerator · Π above / Π below`. No base in `above`, `below` or `excluded` is 0 at
/// a point where the fraction is defined.
#[derive(Clone)]
struct Fraction {
    numerator: NodeId,
    /// Further factors of the numerator, which come from the denominators of divisors.
    above: Factors,
    below: Factors,
    /// Bases that were both in `above` and in `below`, and were cancelled.
    excluded: BTreeSet<NodeId>,
}

impl Fraction {
    fn whole(numerator: NodeId) -> Self {
        let excluded = BTreeSet::new();
        Self { numerator, above: Factors::new(), below: Factors::new(), excluded }
    }

    fn is_whole(&self) -> bool {
        self.above.is_empty() && self.below.is_empty() && self.excluded.is_empty()
    }

    /// Cancels bases that are both in `above` and in `below`. Returns `None` if the fraction is too
    /// large.
    fn reduced(mut self) -> Option<Self> {
        let common: Vec<(NodeId, u32)> = self
            .above
            .iter()
            .filter_map(|(base, n)| Some((*base, (*n).min(*self.below.get(base)?))))
            .collect();
        for (base, n) in common {
            self.excluded.insert(base);
            for side in [&mut self.above, &mut self.below] {
                let exponent = side.remove(&base).unwrap_or(0);
                if exponent > n {
                    side.insert(base, exponent - n);
                }
            }
        }
        let is_small = |side: &Factors| {
            side.len() <= FACTOR_LIMIT && side.values().all(|n| *n <= EXPONENT_LIMIT)
        };
        let small = is_small(&self.above) && is_small(&self.below);
        (small && self.excluded.len() <= FACTOR_LIMIT).then_some(self)
    }
}

fn times(mut a: Factors, b: &Factors) -> Factors {
    for (base, n) in b {
        let exponent = a.entry(*base).or_insert(0);
        *exponent = exponent.saturating_add(*n);
    }
    a
}

fn raised(factors: &Factors, exponent: u32) -> Factors {
    factors.iter().map(|(base, n)| (*base, n.saturating_mul(exponent))).collect()
}

/// Adds the node `numerator · Π factors`, where `node` is the numerator.
fn product(graph: &mut Graph, mut node: NodeId, factors: &Factors) -> NodeId {
    for (base, n) in factors {
        let power = powi(graph, *base, i64::from(*n));
        node = if is_one(graph, node) { power } else { mul(graph, node, power) };
    }
    node
}

/// Adds the rational form of `root` to `graph`. Returns `None` if `root` has no pole that can be
/// cleared.
///
/// Poles of divisions, negative powers and tangents are cleared, also within sums, products,
/// quotients and integer powers. Poles inside other functions stay. Divisions by expressions
/// without coordinates stay too, because such divisions have no poles in space.
pub fn clear(graph: &mut Graph, root: NodeId) -> Option<RationalForm> {
    let mut variabilities = variabilities(graph);
    variabilities.truncate(root.index() + 1);
    let mut fractions: Vec<Option<Fraction>> = vec![None; root.index() + 1];
    for id in graph.needed_by(root) {
        let Node::Apply(op, operands) = graph.node(id).clone() else {
            continue;
        };
        if variabilities[id.index()] != Variability::Varying {
            continue;
        }
        let parts: Vec<Fraction> = operands
            .iter()
            .map(|o| fractions[o.index()].clone().unwrap_or_else(|| Fraction::whole(*o)))
            .collect();
        let fraction = combine(graph, op, &operands, &parts, &variabilities);
        fractions[id.index()] = fraction.and_then(Fraction::reduced).filter(|f| !f.is_whole());
    }
    let fraction = fractions[root.index()].take()?;
    // No base in `above` or `excluded` is 0 where the function is defined. So the numerator omits
    // these bases, and the denominator includes them.
    let mut below = fraction.below;
    for base in fraction.above.into_keys().chain(fraction.excluded) {
        below.entry(base).or_insert(1);
    }
    let one = graph.integer(1);
    let denominator = product(graph, one, &below);
    Some(RationalForm { numerator: fraction.numerator, denominator })
}

fn combine(
    graph: &mut Graph,
    op: Op,
    operands: &[NodeId],
    parts: &[Fraction],
    variabilities: &[Variability],
) -> Option<Fraction> {
    let whole = parts.iter().all(Fraction::is_whole);
    let row = op.row();
    match row.class {
        Class::Negation if !whole => {
            let numerator = neg(graph, parts[0].numerator);
            Some(Fraction { numerator, ..parts[0].clone() })
        }
        Class::Sum if !whole => Some(added(graph, op, &parts[0], &parts[1])),
        Class::Product if !whole => Some(multiplied(graph, &parts[0], &parts[1])),
        Class::Quotient if !whole || variabilities[operands[1].index()] == Variability::Varying => {
            let inverse = inverted(graph, &parts[1], variabilities)?;
            Some(multiplied(graph, &parts[0], &inverse))
        }
        Class::Square if !whole => Some(power(graph, &parts[0], 2)),
        Class::Power => {
            let exponent = graph.number(operands[1])?.as_integer()?;
            let magnitude = u32::try_from(exponent.unsigned_abs()).ok()?;
            if magnitude > EXPONENT_LIMIT || (whole && exponent >= 0) {
                return None;
            }
            if exponent >= 0 {
                return Some(power(graph, &parts[0], magnitude));
            }
            let inverse = inverted(graph, &parts[0], variabilities)?;
            Some(power(graph, &inverse, magnitude))
        }
        Class::Function(_) => {
            let [above, below] = row.quotient?;
            let numerator = graph.apply(above, operands);
            let denominator = graph.apply(below, operands);
            let below = Factors::from([(denominator, 1)]);
            Some(Fraction { below, ..Fraction::whole(numerator) })
        }
        Class::Restriction(_) if !parts[0].is_whole() => {
            let numerator = graph.apply(op, &[parts[0].numerator, operands[1]]);
            Some(Fraction { numerator, ..parts[0].clone() })
        }
        Class::Negation
        | Class::Sum
        | Class::Product
        | Class::Quotient
        | Class::Square
        | Class::Remainder
        | Class::FunctionOfTwo
        | Class::Extremum
        | Class::Choice
        | Class::Fallback
        | Class::Restriction(_) => None,
    }
}

/// The sum or difference of `a` and `b` over their least common denominator.
fn added(graph: &mut Graph, op: Op, a: &Fraction, b: &Fraction) -> Fraction {
    let mut below = a.below.clone();
    for (base, n) in &b.below {
        let exponent = below.entry(*base).or_insert(0);
        *exponent = (*exponent).max(*n);
    }
    let mut over = |part: &Fraction| {
        let missing: Factors = below
            .iter()
            .map(|(base, n)| (*base, n - part.below.get(base).copied().unwrap_or(0)))
            .filter(|(_, n)| *n > 0)
            .collect();
        let numerator = product(graph, part.numerator, &part.above);
        product(graph, numerator, &missing)
    };
    let (left, right) = (over(a), over(b));
    let numerator = sum(graph, op, left, right);
    let mut excluded = &a.excluded | &b.excluded;
    excluded.extend(a.above.keys().chain(b.above.keys()));
    Fraction { numerator, above: Factors::new(), below, excluded }
}

fn multiplied(graph: &mut Graph, a: &Fraction, b: &Fraction) -> Fraction {
    Fraction {
        numerator: mul(graph, a.numerator, b.numerator),
        above: times(a.above.clone(), &b.above),
        below: times(a.below.clone(), &b.below),
        excluded: &a.excluded | &b.excluded,
    }
}

fn power(graph: &mut Graph, a: &Fraction, exponent: u32) -> Fraction {
    Fraction {
        numerator: if is_one(graph, a.numerator) {
            a.numerator
        } else {
            powi(graph, a.numerator, i64::from(exponent))
        },
        above: raised(&a.above, exponent),
        below: raised(&a.below, exponent),
        excluded: a.excluded.clone(),
    }
}

/// The fraction `1/a`, or `None` if `a` is the number 0 or has too many factors.
fn inverted(graph: &mut Graph, a: &Fraction, variabilities: &[Variability]) -> Option<Fraction> {
    // The numerator of `a` is split into factors, so that other denominators can share them.
    let mut below = a.above.clone();
    let mut numerator = graph.integer(1);
    let mut pending = vec![(a.numerator, 1_u32)];
    while let Some((id, exponent)) = pending.pop() {
        if is_zero(graph, id) || exponent > EXPONENT_LIMIT || below.len() > FACTOR_LIMIT {
            return None;
        }
        let node = graph.node(id).clone();
        // Nodes beyond the table of variabilities were added by this pass. Each is an exact number,
        // or an operation with an operand that varies.
        let fixed = variabilities.get(id.index()).is_some_and(|rank| *rank != Variability::Varying)
            || matches!(node, Node::Constant(_));
        let class = match &node {
            Node::Apply(op, operands) => Some((op.row().class, operands)),
            Node::Variable(_) | Node::Parameter(_) | Node::Constant(_) => None,
        };
        if fixed {
            let power = powi(graph, id, i64::from(exponent));
            numerator = div(graph, numerator, power);
        } else if let Some((Class::Product, operands)) = class {
            pending.extend(operands.iter().map(|o| (*o, exponent)));
        } else if let Some((Class::Square, operands)) = class {
            pending.push((operands[0], exponent * 2));
        } else if let Some((Class::Negation, operands)) = class {
            pending.push((operands[0], exponent));
            if exponent % 2 == 1 {
                numerator = neg(graph, numerator);
            }
        } else {
            *below.entry(id).or_insert(0) += exponent;
        }
    }
    Some(Fraction { numerator, above: a.below.clone(), below, excluded: a.excluded.clone() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::display;
    use crate::testing::{Random, TestExpr, TestGraphBuilder, evaluate};

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
        assert_eq!(
            cleared(|[x, y, _], _| -(y / (2.0 * x)).f(Op::Sqr)),
            pair("-sqr(y*0.5)", "sqr(x)")
        );
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
}
