//! Rewrites sines and cosines of multiples of acos, asin, atan and atan2 as algebraic functions.
//!
//! With θ = acos(u), cos(nθ) is a polynomial in u. With θ = atan2(y, x), cos θ is x/√(x² + y²), and
//! sin θ is y/√(x² + y²). So neither the angle nor its jump has to be enclosed.
//!
//! For c = cos θ and s = sin θ, let cₙ = cos(nθ), and sin(nθ) = s·wₙ. Then
//!
//! - c₂ₙ = 2cₙ² − 1, and w₂ₙ = 2cₙ·wₙ;
//! - c₂ₙ₊₁ = 2cₙ·cₙ₊₁ − c, and w₂ₙ₊₁ = 2cₙ₊₁·wₙ + 1.
//!
//! In this nested form, |c| ≤ 1 yields the true bounds |cₙ| ≤ 1 for even n, and |wₙ| ≤ n for all n.
//! Multiplied out, cos(8θ) would be enclosed by ±577. Cosines for odd n, and c and s themselves,
//! are clamped to [−1, 1], which changes no value. Clamping the other sines costs more time than it
//! saves.
//!
//! For θ = acos(u), which lies in [0, π], cos(θ/2) = √((1 + u)/2) and sin(θ/2) = √((1 − u)/2).

use crate::algebra::{add, div, mul, neg, sub};
use crate::constant::Constant;
use crate::graph::{Graph, Node, NodeId};
use crate::regular::Nonneg;
use num_rational::BigRational;
use num_traits::{One, ToPrimitive, Zero};
use rustc_hash::FxHashMap;
use zeroset_ops::Op;

/// Operations whose values are angles.
const INVERSES: [Op; 4] = [Op::Acos, Op::Asin, Op::Atan, Op::Atan2];
/// Largest multiple of an angle.
const MULTIPLE_LIMIT: i64 = 64;
/// Largest number of angles in a sum.
const ANGLE_LIMIT: usize = 4;
/// Deepest nesting of sums and constant factors.
const DEPTH_LIMIT: usize = 16;
/// Largest number of nodes visited in one sum. A node counts each time it occurs.
const VISIT_LIMIT: usize = 1 << 10;

/// Returns a function with the values and the domain of definition of `root`, in which sines and
/// cosines of integer multiples of inverse functions are algebraic. The function is added to
/// `graph`. It is `root` itself if there is nothing to rewrite.
///
/// ```
/// use zeroset_ir::{Axis, Graph, algebraic_angles, display};
/// use zeroset_ops::Op;
///
/// let mut graph = Graph::new();
/// let [x, y] = [Axis::X, Axis::Y].map(|axis| graph.variable(axis));
/// let angle = graph.apply(Op::Atan2, &[y, x]);
/// let root = graph.apply(Op::Sin, &[angle]);
/// let root = algebraic_angles(&mut graph, root);
/// assert_eq!(display(&graph, root, &[]), "min(max(y/sqrt(sqr(y) + sqr(x)), -1), 1)");
/// ```
pub fn algebraic_angles(graph: &mut Graph, root: NodeId) -> NodeId {
    let mut angles = Angles::default();
    let mut known: FxHashMap<NodeId, NodeId> = FxHashMap::default();
    for id in graph.needed(&[root]) {
        let Node::Apply(op, operands) = *graph.node(id) else { continue };
        let operands: Vec<NodeId> =
            operands.iter().map(|operand| *known.get(operand).unwrap_or(operand)).collect();
        let wave = match op {
            Op::Sin => angles.wave(graph, operands[0]).map(|[_, sin]| sin),
            Op::Cos => angles.wave(graph, operands[0]).map(|[cos, _]| cos),
            _ => None,
        };
        let rewritten = wave.unwrap_or_else(|| graph.apply(op, &operands));
        if rewritten != id {
            known.insert(id, rewritten);
        }
    }
    known.remove(&root).unwrap_or(root)
}

/// Rewrites sines and cosines. Each multiple of an angle is computed once.
#[derive(Default)]
struct Angles {
    /// For the node of cos θ and a number n: cos(nθ), and sin(nθ) divided by sin θ.
    multiples: FxHashMap<(NodeId, i64), [NodeId; 2]>,
    nonneg: Nonneg,
}

/// A sum, split into multiples of angles and other terms.
#[derive(Default)]
struct Terms {
    angles: Vec<(NodeId, BigRational)>,
    rest: Vec<(NodeId, BigRational)>,
    visits: usize,
}

impl Terms {
    /// Adds `factor` times a node, split into terms. `None` if there are too many.
    fn add(&mut self, graph: &Graph, id: NodeId, factor: &BigRational, depth: usize) -> Option<()> {
        self.visits += 1;
        if depth > DEPTH_LIMIT || self.visits > VISIT_LIMIT {
            return None;
        }
        if let Node::Apply(op, operands) = graph.node(id) {
            let exact = |at: usize| graph.exact(operands[at]);
            match op {
                Op::Neg => return self.add(graph, operands[0], &-factor, depth + 1),
                Op::Add => {
                    self.add(graph, operands[0], factor, depth + 1)?;
                    return self.add(graph, operands[1], factor, depth + 1);
                }
                Op::Sub => {
                    self.add(graph, operands[0], factor, depth + 1)?;
                    return self.add(graph, operands[1], &-factor, depth + 1);
                }
                Op::Mul if exact(0).is_some() || exact(1).is_some() => {
                    let at = usize::from(exact(0).is_none());
                    let factor = factor * exact(at)?;
                    return self.add(graph, operands[1 - at], &factor, depth + 1);
                }
                Op::Div if exact(1).is_some_and(|value| !value.is_zero()) => {
                    return self.add(graph, operands[0], &(factor / exact(1)?), depth + 1);
                }
                _ if INVERSES.contains(op) => {
                    match self.angles.iter_mut().find(|(angle, _)| *angle == id) {
                        Some((_, sum)) => *sum += factor,
                        None => self.angles.push((id, factor.clone())),
                    }
                    return (self.angles.len() <= ANGLE_LIMIT).then_some(());
                }
                _ => {}
            }
        }
        self.rest.push((id, factor.clone()));
        Some(())
    }
}

impl Angles {
    /// The cosine and the sine of a node that is a sum of multiples of angles and other terms.
    /// `None` if the sum holds no angle, or a multiple that has no algebraic sine and cosine.
    fn wave(&mut self, graph: &mut Graph, id: NodeId) -> Option<[NodeId; 2]> {
        let mut terms = Terms::default();
        terms.add(graph, id, &BigRational::one(), 0)?;
        if terms.angles.is_empty() {
            return None;
        }
        let mut sum: Option<[NodeId; 2]> = None;
        let mut join = |graph: &mut Graph, next: [NodeId; 2]| {
            sum = Some(match sum {
                None => next,
                Some([c, s]) => {
                    let [cos, sin] = next;
                    let (cc, ss) = (mul(graph, c, cos), mul(graph, s, sin));
                    let (sc, cs) = (mul(graph, s, cos), mul(graph, c, sin));
                    let (cos, sin) = (sub(graph, cc, ss), add(graph, sc, cs));
                    [cos, sin].map(|wave| clamped(graph, wave))
                }
            });
        };
        for (angle, factor) in &terms.angles {
            let next = self.multiple(graph, *angle, factor)?;
            join(graph, next);
        }
        if !terms.rest.is_empty() {
            let mut rest = graph.integer(0);
            for (id, factor) in terms.rest {
                let factor = graph.constant(Constant::rational(factor));
                let term = mul(graph, factor, id);
                rest = add(graph, rest, term);
            }
            let next = [Op::Cos, Op::Sin].map(|op| graph.apply(op, &[rest]));
            join(graph, next);
        }
        sum
    }

    /// The cosine and the sine of a multiple of an angle.
    fn multiple(
        &mut self,
        graph: &mut Graph,
        angle: NodeId,
        factor: &BigRational,
    ) -> Option<[NodeId; 2]> {
        let whole = if factor.is_integer() {
            factor.clone()
        } else {
            factor * BigRational::from_integer(2.into())
        };
        let n = whole.is_integer().then(|| whole.to_integer().to_i64()).flatten()?;
        if n.abs() > MULTIPLE_LIMIT {
            return None;
        }
        let mut waves = of(graph, &mut self.nonneg, angle)?;
        if !factor.is_integer() {
            waves = half(graph, angle, waves)?;
        }
        let [cos, sin] = waves;
        let [cos, over] = self.chain(graph, cos, n.abs());
        let sin = mul(graph, sin, over);
        let sin = if n.is_negative() { neg(graph, sin) } else { sin };
        Some([cos, sin])
    }

    /// The cosine of n times an angle, and its sine divided by the sine of the angle.
    fn chain(&mut self, graph: &mut Graph, c: NodeId, n: i64) -> [NodeId; 2] {
        if let Some(known) = self.multiples.get(&(c, n)) {
            return *known;
        }
        let (one, two) = (graph.integer(1), graph.integer(2));
        let pair = match n {
            // The cosine is 1, and the sine 0, where the angle is defined.
            0 => {
                let zero = graph.integer(0);
                [one, zero].map(|value| graph.apply(Op::WhereDefined, &[value, c]))
            }
            1 => [c, one],
            _ => {
                let [cos, over] = self.chain(graph, c, n / 2);
                if n % 2 == 0 {
                    let square = graph.apply(Op::Sqr, &[cos]);
                    let twice = mul(graph, two, square);
                    let product = mul(graph, cos, over);
                    [sub(graph, twice, one), mul(graph, two, product)]
                } else {
                    let [next, _] = self.chain(graph, c, n / 2 + 1);
                    let [cosines, mixed] = [cos, over].map(|other| mul(graph, next, other));
                    let [cosines, mixed] = [cosines, mixed].map(|id| mul(graph, two, id));
                    let cosines = sub(graph, cosines, c);
                    [clamped(graph, cosines), add(graph, mixed, one)]
                }
            }
        };
        self.multiples.insert((c, n), pair);
        pair
    }
}

/// The cosine and the sine of an angle, undefined where the angle is.
fn of(graph: &mut Graph, nonneg: &mut Nonneg, angle: NodeId) -> Option<[NodeId; 2]> {
    let Node::Apply(op, operands) = *graph.node(angle) else { return None };
    let a = operands[0];
    if op == Op::Acos || op == Op::Asin {
        let [own, other] = unit(graph, nonneg, a);
        return Some(if op == Op::Acos { [own, other] } else { [other, own] });
    }
    // The angle of the point (b, a), where b is 1 for the arc tangent.
    let b = if op == Op::Atan2 { operands[1] } else { graph.integer(1) };
    let squares = [a, b].map(|side| graph.apply(Op::Sqr, &[side]));
    let sum = graph.apply(Op::Add, &squares);
    let root = graph.apply(Op::Sqrt, &[sum]);
    let waves = [b, a].map(|side| graph.apply(Op::Div, &[side, root]));
    Some(waves.map(|wave| clamped(graph, wave)))
}

/// Returns u and √(1 − u²), both undefined where |u| > 1. For u = p/√(p² + q) with q ≥ 0, both are
/// defined wherever u is.
fn unit(graph: &mut Graph, nonneg: &mut Nonneg, u: NodeId) -> [NodeId; 2] {
    if let Some((others, root)) = others(graph, nonneg, u) {
        let other = graph.apply(Op::Sqrt, &[others]);
        return [u, graph.apply(Op::Div, &[other, root])].map(|wave| clamped(graph, wave));
    }
    let (one, square) = (graph.integer(1), graph.apply(Op::Sqr, &[u]));
    let rest = graph.apply(Op::Sub, &[one, square]);
    let own = clamped(graph, u);
    [graph.apply(Op::WhereNonneg, &[own, rest]), graph.apply(Op::Sqrt, &[rest])]
}

/// For u = p/√(p² + q) with q proven ≥ 0: q and the root √(p² + q). `None` for other u.
fn others(graph: &mut Graph, nonneg: &mut Nonneg, u: NodeId) -> Option<(NodeId, NodeId)> {
    let &[above, root] = graph.operands(u, Op::Div)? else { return None };
    let sum = graph.operands(root, Op::Sqrt)?[0];
    let square = graph.find(Op::Sqr, &[above])?;
    let (mut open, mut others, mut found) = (vec![sum], Vec::new(), false);
    while let Some(id) = open.pop() {
        if id == square && !found {
            found = true;
        } else if let Some(terms) = graph.operands(id, Op::Add) {
            open.extend(terms);
        } else {
            others.push(id);
        }
        if open.len() + others.len() > DEPTH_LIMIT {
            return None;
        }
    }
    if !found || !others.iter().all(|id| nonneg.holds(graph, *id)) {
        return None;
    }
    let zero = graph.integer(0);
    Some((others.into_iter().rev().fold(zero, |sum, id| add(graph, sum, id)), root))
}

/// The cosine and the sine of half an angle in [0, π]. Half of other angles has a sine with a jump
/// or a choice.
fn half(graph: &mut Graph, angle: NodeId, [cos, _]: [NodeId; 2]) -> Option<[NodeId; 2]> {
    graph.operands(angle, Op::Acos)?;
    let (one, two) = (graph.integer(1), graph.integer(2));
    let sums = [add(graph, one, cos), sub(graph, one, cos)];
    Some(sums.map(|sum| {
        let half = div(graph, sum, two);
        graph.apply(Op::Sqrt, &[half])
    }))
}

/// Clamps `wave`, which is known to lie in [−1, 1], to that range. Its value stays the same, and
/// its enclosures then lie in the range, too.
fn clamped(graph: &mut Graph, wave: NodeId) -> NodeId {
    let [low, high] = [-1, 1].map(|end| graph.integer(end));
    let above = graph.apply(Op::Max, &[wave, low]);
    graph.apply(Op::Min, &[above, high])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::display;
    use crate::testing::{Random, TestExpr, TestGraphBuilder, evaluate};

    fn shown(formula: impl for<'a> Fn([TestExpr<'a>; 3]) -> TestExpr<'a>) -> String {
        let builder = TestGraphBuilder::default();
        let root = formula(builder.xyz()).id;
        let mut graph = builder.graph();
        let rewritten = algebraic_angles(&mut graph, root);
        if rewritten == root { "the same".to_owned() } else { display(&graph, rewritten, &[]) }
    }

    #[test]
    fn multiples_are_nested() {
        assert_eq!(
            shown(|[x, ..]| (x.f(Op::Acos) * 4.0).f(Op::Cos)),
            "2*sqr(2*sqr(where_nonneg(min(max(x, -1), 1), 1 - sqr(x))) - 1) - 1"
        );
        assert_eq!(
            shown(|[x, y, _]| (y.apply(Op::Atan2, &[x]) * -2.0).f(Op::Sin)),
            "-min(max(y/sqrt(sqr(y) + sqr(x)), -1), 1)*(2*min(max(x/sqrt(sqr(y) + sqr(x)), -1), 1))"
        );
        assert_eq!(
            shown(|[x, ..]| (x.f(Op::Acos) / 2.0).f(Op::Sin)),
            "sqrt((1 - where_nonneg(min(max(x, -1), 1), 1 - sqr(x)))/2)"
        );
    }

    #[test]
    fn a_quotient_by_a_distance_needs_no_domain() {
        let text = shown(|[x, y, z]| {
            let sum = x.f(Op::Sqr) + y.f(Op::Sqr) + z.f(Op::Sqr);
            (z / sum.f(Op::Sqrt)).f(Op::Acos).f(Op::Sin)
        });
        let root = "sqrt(sqr(x) + sqr(y) + sqr(z))";
        assert_eq!(text, format!("min(max(sqrt(sqr(x) + sqr(y))/{root}, -1), 1)"));
    }

    #[test]
    fn other_angles_stay() {
        assert_eq!(shown(|[x, ..]| (x.f(Op::Acos) * 2.5).f(Op::Tan)), "the same");
        assert_eq!(shown(|[x, y, _]| (x.f(Op::Acos) * y).f(Op::Cos)), "the same");
        assert_eq!(shown(|[x, ..]| (x.f(Op::Acos) * 0.3).f(Op::Cos)), "the same");
        // Half of atan2 jumps, and its sine with it.
        assert_eq!(shown(|[x, y, _]| (y.apply(Op::Atan2, &[x]) / 2.0).f(Op::Sin)), "the same");
        assert_eq!(shown(|[x, ..]| (x.f(Op::Acos) * 65.0).f(Op::Cos)), "the same");
    }

    /// A random function of multiples of angles.
    fn formula(random: &mut Random, graph: &mut Graph) -> NodeId {
        let axes = crate::Axis::ALL.map(|axis| graph.variable(axis));
        let angle = |random: &mut Random, graph: &mut Graph| {
            let [a, b, c] = [0; 3].map(|_| axes[random.below(3)]);
            match random.below(6) {
                0 => graph.apply(Op::Acos, &[a]),
                1 => graph.apply(Op::Asin, &[a]),
                2 => graph.apply(Op::Atan, &[a]),
                3 => {
                    let squares = [a, b, c].map(|id| graph.apply(Op::Sqr, &[id]));
                    let sum = graph.apply(Op::Add, &[squares[0], squares[1]]);
                    let sum = graph.apply(Op::Add, &[sum, squares[2]]);
                    let root = graph.apply(Op::Sqrt, &[sum]);
                    let cosine = graph.apply(Op::Div, &[a, root]);
                    graph.apply(if random.below(2) == 0 { Op::Acos } else { Op::Asin }, &[cosine])
                }
                _ => graph.apply(Op::Atan2, &[a, b]),
            }
        };
        let mut sum = None;
        for _ in 0..=random.below(2) {
            let angle = angle(random, graph);
            let halves = random.below(25) as i64 - 12;
            let halves = if random.below(3) == 0 { halves } else { 2 * halves };
            let factor = graph.constant(Constant::ratio(halves, 2).expect("a number"));
            let term = graph.apply(Op::Mul, &[factor, angle]);
            sum = Some(match sum {
                None => term,
                Some(sum) => {
                    graph.apply(if random.below(2) == 0 { Op::Add } else { Op::Sub }, &[sum, term])
                }
            });
        }
        let mut sum = sum.expect("a term");
        if random.below(4) == 0 {
            sum = graph.apply(Op::Add, &[sum, axes[random.below(3)]]);
        }
        graph.apply(if random.below(2) == 0 { Op::Cos } else { Op::Sin }, &[sum])
    }

    /// Points lie on a grid, so that many of them are on jumps and at the ends of domains.
    #[test]
    fn values_and_domains_agree_at_random_points() {
        let seed = 0xa4_0000;
        let cases = std::env::var("ZEROSET_CASES").ok().and_then(|n| n.parse().ok());
        let cases: u64 = cases.unwrap_or(12_000).max(1000);
        println!("seed {seed:#x}, {cases} formulas");
        let (mut compared, mut rewrites, mut undefined) = (0, 0, 0);
        for case in 0..cases {
            let mut random = Random(seed + case);
            let mut graph = Graph::new();
            let root = formula(&mut random, &mut graph);
            let rewritten = algebraic_angles(&mut graph, root);
            rewrites += usize::from(rewritten != root);
            for _ in 0..10 {
                let at = [0; 3].map(|_| match random.below(4) {
                    0 => random.coordinate(),
                    _ => random.below(9) as f64 / 4.0 - 1.0,
                });
                let values = evaluate(&graph, at, &[]);
                let [before, after] = [root, rewritten].map(|id| values[id.index()]);
                let context = || {
                    let [root, rewritten] = [root, rewritten].map(|id| display(&graph, id, &[]));
                    format!("seed {:#x}: {root}, {rewritten} at {at:?}", seed + case)
                };
                match (before, after) {
                    (Some((a, ea)), Some((b, eb))) => {
                        compared += 1;
                        if ea.is_finite() && eb.is_finite() {
                            assert!((a - b).abs() <= 1e-9 + ea + eb, "{}", context());
                        }
                    }
                    (None, None) => undefined += 1,
                    // Where rounding decides, a value may be missing.
                    (Some((_, error)), None) | (None, Some((_, error))) => {
                        assert!(error.is_infinite(), "{}: {before:?} {after:?}", context());
                    }
                }
            }
        }
        assert!(compared > 6 * cases && undefined > 1000, "{compared} {undefined}");
        assert!(rewrites as u64 > cases / 2, "{rewrites}");
    }
}
