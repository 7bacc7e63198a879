//! Rational forms: a function with poles as a quotient of two functions without poles.
//!
//! Near a pole every enclosure of `1/x − y` is unbounded and proves nothing. Its numerator `1 −
//! x·y` is bounded. If the numerator has no zero in a box, the function has none there.

use crate::algebra::{div, is_one, is_zero, mul, neg, powi, sum};
use crate::cancel::{Cancellation, factors};
use crate::constant::Constant;
use crate::graph::{Graph, Node, NodeId};
use crate::regular::is_thin_zero;
use crate::variability::{Variability, variabilities};
use rustc_hash::FxHashMap;
use std::collections::{BTreeMap, BTreeSet};
use zeroset_interval::Interval;
use zeroset_ops::{Class, Op, Restriction};

/// Largest number of distinct factors in a denominator. A quotient with more factors stays as it
/// is, because each factor would cost a product of all others.
const FACTOR_LIMIT: usize = 16;
/// Largest exponent of a factor. Poles of higher powers are not cleared.
const EXPONENT_LIMIT: u32 = 64;

/// A function f in rational form.
///
/// Within its domain of definition, f is 0 exactly where the numerator is 0. At points where the
/// denominator is 0, f is undefined. Numerator over denominator equals f, up to factors that have
/// no zero in the domain of definition. The numerator may be defined where f is not.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RationalForm {
    /// Node that is 0 where f is 0.
    pub numerator: NodeId,
    /// Node that is 0 at the poles of f.
    pub denominator: NodeId,
    /// Product of the factors by which numerator and denominator were divided, if there are any. It
    /// is 0 only where f is undefined.
    pub removed: Option<NodeId>,
}

/// A product of powers, as the exponent of each base.
pub(crate) type Factors = BTreeMap<NodeId, u32>;

/// The fraction `numerator · Π above / Π below`. No base in `above`, `below` or `excluded` is 0 at
/// a point where the fraction is defined.
#[derive(Clone)]
struct Fraction {
    numerator: NodeId,
    /// Further factors of the numerator, which come from the denominators of divisors.
    above: Factors,
    below: Factors,
    /// Bases that were cancelled because they were both in `above` and in `below`, and bases that
    /// restrict the domain.
    excluded: BTreeSet<NodeId>,
    /// Common factors of the numerator and of bases in `below`, which were cancelled.
    removed: BTreeSet<NodeId>,
}

impl Fraction {
    fn whole(numerator: NodeId) -> Self {
        let (above, below) = (Factors::new(), Factors::new());
        let (excluded, removed) = (BTreeSet::new(), BTreeSet::new());
        Self { numerator, above, below, excluded, removed }
    }

    fn is_whole(&self) -> bool {
        self.above.is_empty()
            && self.below.is_empty()
            && self.excluded.is_empty()
            && self.removed.is_empty()
    }

    /// Cancels bases that are both in `above` and in `below`, and common factors of the numerator
    /// and bases in `below`. Returns `None` if the fraction is too large.
    fn reduced(mut self, graph: &mut Graph, cancellation: &mut Cancellation) -> Option<Self> {
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
        let removed = cancellation.cancel(graph, self.numerator, &mut self.below);
        if let Some((numerator, removed)) = removed {
            self.numerator = numerator;
            self.removed.extend(removed);
        }
        let is_small = |side: &Factors| {
            side.len() <= FACTOR_LIMIT && side.values().all(|n| *n <= EXPONENT_LIMIT)
        };
        let small = is_small(&self.above) && is_small(&self.below);
        let excluded = self.excluded.len() + self.removed.len();
        (small && excluded <= FACTOR_LIMIT).then_some(self)
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
    let mut cancellation = Cancellation::default();
    let fraction = fraction(graph, root, &mut cancellation)?;
    // No base in `above`, `excluded` or `removed` is 0 where the function is defined. So the
    // numerator omits these bases, and the denominator includes them.
    let mut below = fraction.below;
    let removed = fraction.removed.iter().copied();
    let removed = removed.collect::<Vec<_>>().into_iter().reduce(|a, b| mul(graph, a, b));
    let nonzero = fraction.above.into_keys().chain(fraction.excluded).chain(fraction.removed);
    for base in nonzero {
        below.entry(base).or_insert(1);
    }
    let numerator = cancellation.without_zeros_of(graph, fraction.numerator, &below);
    let one = graph.integer(1);
    let denominator = product(graph, one, &below);
    Some(RationalForm { numerator, denominator, removed })
}

/// Fills gaps in the function of a solid. A quotient has gaps where a common factor of its
/// numerator and denominator is 0. It is replaced by its continuous extension if that factor is 0
/// on no open set. So the new function differs from the given one only in a closed set without
/// interior. The function is added to `graph`. It is `root` itself if no quotient is replaced.
///
/// ```
/// use zeroset_ir::{Axis, Graph, display, without_gaps};
/// use zeroset_ops::Op;
///
/// let mut graph = Graph::new();
/// let x = graph.variable(Axis::X);
/// let square = graph.apply(Op::Sqr, &[x]);
/// let root = graph.apply(Op::Div, &[square, x]);
/// assert_eq!(without_gaps(&mut graph, root, &[]), x);
/// ```
pub fn without_gaps(graph: &mut Graph, root: NodeId, parameters: &[Interval]) -> NodeId {
    let variabilities = variabilities(graph);
    let varies =
        |id: NodeId| variabilities.get(id.index()).is_none_or(|rank| *rank == Variability::Varying);
    let mut cancellation = Cancellation::total();
    let mut replaced: FxHashMap<NodeId, NodeId> = FxHashMap::default();
    let mut fractions: FxHashMap<NodeId, Fraction> = FxHashMap::default();
    for id in graph.needed(&[root]) {
        let Node::Apply(op, operands) = graph.node(id).clone() else { continue };
        let operands: Vec<NodeId> =
            operands.iter().map(|id| *replaced.get(id).unwrap_or(id)).collect();
        // Sums stay, so that other poles do not become common to all terms.
        let class = op.row().class;
        let fraction = if varies(id) && class != Class::Sum {
            let part = |id: &NodeId| fractions.get(id).cloned();
            let whole = |id: &NodeId| part(id).unwrap_or_else(|| Fraction::whole(*id));
            let parts: Vec<Fraction> = operands.iter().map(whole).collect();
            let fraction = combine(graph, op, &operands, &parts, &varies);
            fraction.and_then(|fraction| fraction.reduced(graph, &mut cancellation))
        } else {
            None
        };
        let fraction = fraction.filter(|fraction| !fraction.is_whole());
        let filled = fraction.as_ref().filter(|fraction| {
            let mut gaps =
                fraction.removed.iter().chain(&fraction.excluded).chain(fraction.above.keys());
            let is_gap = !fraction.removed.is_empty() || !fraction.excluded.is_empty();
            is_gap && gaps.all(|base| is_thin_zero(graph, *base, parameters))
        });
        let node = match filled {
            Some(filled) => {
                let above = product(graph, filled.numerator, &filled.above);
                let one = graph.integer(1);
                let below = product(graph, one, &filled.below);
                div(graph, above, below)
            }
            None => graph.apply(op, &operands),
        };
        if let Some(fraction) = fraction {
            fractions.insert(node, fraction);
        }
        if node != id {
            replaced.insert(id, node);
        }
    }
    replaced.remove(&root).unwrap_or(root)
}

/// The fraction that equals `root`. `None` if `root` has no pole that can be cleared.
fn fraction(graph: &mut Graph, root: NodeId, cancellation: &mut Cancellation) -> Option<Fraction> {
    let mut variabilities = variabilities(graph);
    variabilities.truncate(root.index() + 1);
    let mut fractions: Vec<Option<Fraction>> = vec![None; root.index() + 1];
    let varies =
        |id: NodeId| variabilities.get(id.index()).is_none_or(|rank| *rank == Variability::Varying);
    for id in graph.needed(&[root]) {
        let Node::Apply(op, operands) = graph.node(id).clone() else {
            continue;
        };
        if !varies(id) {
            continue;
        }
        let parts: Vec<Fraction> = operands
            .iter()
            .map(|o| fractions[o.index()].clone().unwrap_or_else(|| Fraction::whole(*o)))
            .collect();
        let fraction = combine(graph, op, &operands, &parts, &varies);
        fractions[id.index()] = fraction
            .and_then(|fraction| fraction.reduced(graph, cancellation))
            .filter(|fraction| !fraction.is_whole());
    }
    fractions[root.index()].take()
}

fn combine(
    graph: &mut Graph,
    op: Op,
    operands: &[NodeId],
    parts: &[Fraction],
    varies: &dyn Fn(NodeId) -> bool,
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
        Class::Quotient if !whole || varies(operands[1]) => {
            let inverse = inverted(graph, &parts[1], varies)?;
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
            let inverse = inverted(graph, &parts[0], varies)?;
            Some(power(graph, &inverse, magnitude))
        }
        Class::Function(_) => {
            let [above, below] = row.quotient?;
            let numerator = graph.apply(above, operands);
            let denominator = graph.apply(below, operands);
            let below = Factors::from([(denominator, 1)]);
            Some(Fraction { below, ..Fraction::whole(numerator) })
        }
        // The second operand is 0 nowhere in the domain of definition. It may be undefined only
        // where the function is.
        Class::Restriction(Restriction::Nonzero) if parts[1].is_whole() && varies(operands[1]) => {
            let (_, bases) = factors(graph, operands[1]);
            let mut fraction = parts[0].clone();
            fraction.excluded.extend(bases.into_keys());
            Some(fraction)
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
    let removed = &a.removed | &b.removed;
    Fraction { numerator, above: Factors::new(), below, excluded, removed }
}

fn multiplied(graph: &mut Graph, a: &Fraction, b: &Fraction) -> Fraction {
    Fraction {
        numerator: mul(graph, a.numerator, b.numerator),
        above: times(a.above.clone(), &b.above),
        below: times(a.below.clone(), &b.below),
        excluded: &a.excluded | &b.excluded,
        removed: &a.removed | &b.removed,
    }
}

/// The power of a fraction.
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
        removed: a.removed.clone(),
    }
}

/// The fraction `1/a`, or `None` if `a` is the number 0 or has too many factors.
fn inverted(graph: &mut Graph, a: &Fraction, varies: &dyn Fn(NodeId) -> bool) -> Option<Fraction> {
    // The numerator of `a` becomes a denominator. It is split into factors, so that other
    // denominators can share them.
    let mut below = a.above.clone();
    let mut numerator = graph.integer(1);
    let mut pending = vec![(a.numerator, 1_u32)];
    while let Some((id, exponent)) = pending.pop() {
        if is_zero(graph, id) || exponent > EXPONENT_LIMIT || below.len() > FACTOR_LIMIT {
            return None;
        }
        let node = graph.node(id).clone();
        // Nodes beyond the table of variabilities were added by this pass. All of them except
        // numbers count as varying.
        let fixed = !varies(id) || matches!(node, Node::Constant(_));
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
        } else if let Some((Class::Power, operands)) = class
            && let Some(own) = graph.number(operands[1]).and_then(Constant::as_integer)
            && (1..=i64::from(EXPONENT_LIMIT)).contains(&own)
        {
            pending.push((operands[0], exponent * own as u32));
        } else if let Some((Class::Negation, operands)) = class {
            pending.push((operands[0], exponent));
            if exponent % 2 == 1 {
                numerator = neg(graph, numerator);
            }
        } else {
            *below.entry(id).or_insert(0) += exponent;
        }
    }
    let (excluded, removed) = (a.excluded.clone(), a.removed.clone());
    Some(Fraction { numerator, above: a.below.clone(), below, excluded, removed })
}

#[cfg(test)]
mod tests;
