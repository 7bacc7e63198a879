//! Levels of one function: functions whose zeros never meet.

use super::form::{Forms, LinearForm};
use crate::constant::Constant;
use crate::graph::{Graph, Node, NodeId};
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive, Zero};
use rustc_hash::FxHashMap;
use zeroset_interval::{Decorated, Facts, Interval, fold};
use zeroset_ops::Op;

/// Largest number of factors of a product that are looked at.
const MOST_FACTORS: usize = 16;

/// A function as a level of another one: it is factor · (first − c) wherever it is defined, for a
/// number c. So its zeros are where the first function is c.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Level {
    /// The place of the first function of the group.
    pub group: usize,
    /// The factor, rounded; never 0. It is 1 for the first function.
    pub factor: f64,
    /// The number of functions in the group with a smaller c.
    pub rank: usize,
}

/// For each node, the group of nodes to which it belongs. All nodes of a group are levels of the
/// first one, and their numbers c are proven to differ. So no two of them are 0 at one point. A
/// node that is not found to be a level of another one has its own group. `values` has bounds of
/// the parameters.
///
/// ```
/// use zeroset_ir::{Axis, Graph, levels};
/// use zeroset_ops::Op;
///
/// let mut graph = Graph::new();
/// let (x, one) = (graph.variable(Axis::X), graph.integer(1));
/// let right = graph.apply(Op::Sub, &[x, one]);
/// let left = graph.apply(Op::Neg, &[x]);
/// let found = levels(&graph, &[right, left], &[]);
/// assert_eq!((found[0].group, found[0].factor, found[0].rank), (0, 1.0, 1));
/// assert_eq!((found[1].group, found[1].factor, found[1].rank), (0, -1.0, 0));
/// ```
pub fn levels(graph: &Graph, nodes: &[NodeId], values: &[Interval]) -> Vec<Level> {
    /// A function of a group.
    struct Member {
        place: usize,
        /// The coefficient of the form's first term.
        first: BigRational,
        /// Bounds of the sum of the other terms at a zero.
        zero: [BigRational; 2],
    }
    let mut forms = Forms::default();
    let mut groups: FxHashMap<LinearForm, Vec<Member>> = FxHashMap::default();
    let own = |place| Level { group: place, factor: 1.0, rank: 0 };
    let mut found: Vec<Level> = (0..nodes.len()).map(own).collect();
    for (place, node) in nodes.iter().enumerate() {
        let form = forms.of(graph, *node);
        let Some((terms, constant)) = divided(graph, &form, values) else { continue };
        let Some((_, first)) = terms.first().cloned() else { continue };
        let inverse = first.recip();
        let key = LinearForm { terms, constant: BigRational::zero() }.scaled(&inverse);
        let zero = scaled(&constant, &-inverse);
        let members = groups.entry(key).or_default();
        let is_apart = |other: &Member| zero[1] < other.zero[0] || other.zero[1] < zero[0];
        if !members.iter().all(is_apart) {
            continue;
        }
        if let Some(base) = members.first() {
            let factor = (&first / &base.first).to_f64().filter(|f| f.is_normal());
            let Some(factor) = factor else { continue };
            found[place] = Level { group: base.place, factor, rank: 0 };
        }
        members.push(Member { place, first, zero });
    }
    for members in groups.values() {
        // Other functions of the group with larger and smaller numbers, if the first function's
        // factor is above 0.
        let is_turned = members[0].first.is_negative();
        for one in members {
            let is_less = |other: &&Member| (other.zero[1] < one.zero[0]) != is_turned;
            let others = members.iter().filter(|other| other.place != one.place);
            found[one.place].rank = others.filter(is_less).count();
        }
    }
    found
}

/// Functions that are levels of one function t, with descending numbers: each is above 0 where t is
/// above the function's number, and below 0 where t is below. The node has the sign of their
/// product, or the opposite sign if the flag is set. `None` if the node is not found to be such a
/// product, or a square that is less by a number. `values` has bounds of the parameters.
pub fn sheets(graph: &mut Graph, node: NodeId, values: &[Interval]) -> Option<(Vec<NodeId>, bool)> {
    let mut is_opposite = false;
    let mut factors = Vec::new();
    match graph.node(node) {
        Node::Apply(Op::Mul | Op::Neg, _) => {
            let mut open = vec![node];
            while let Some(id) = open.pop() {
                match *graph.node(id) {
                    Node::Apply(Op::Mul, operands) => open.extend(operands.iter().rev()),
                    Node::Apply(Op::Neg, operands) => {
                        is_opposite = !is_opposite;
                        open.push(operands[0]);
                    }
                    _ => match graph.exact(id).map(Signed::signum) {
                        Some(sign) if sign.is_zero() => return None,
                        Some(sign) => is_opposite ^= sign.is_negative(),
                        None => factors.push(id),
                    },
                }
                if open.len() + factors.len() > MOST_FACTORS {
                    return None;
                }
            }
        }
        Node::Apply(Op::Add | Op::Sub, _) => {
            let (inner, square, negative) = lessened_square(graph, node)?;
            is_opposite = negative;
            let root = exact_root(&square).map(|root| graph.constant(Constant::rational(root)));
            let root = root.unwrap_or_else(|| {
                let square = graph.constant(Constant::rational(square));
                graph.apply(Op::Sqrt, &[square])
            });
            factors = [Op::Sub, Op::Add].map(|op| graph.apply(op, &[inner, root])).to_vec();
        }
        _ => return None,
    }
    let levels = levels(graph, &factors, values);
    if factors.len() < 2 || levels.iter().any(|level| level.group != 0) {
        return None;
    }
    let mut sorted: Vec<(usize, NodeId)> = Vec::new();
    for (level, factor) in levels.iter().zip(factors) {
        let is_falling = level.factor < 0.0;
        is_opposite ^= is_falling;
        let rising = if is_falling { graph.apply(Op::Neg, &[factor]) } else { factor };
        sorted.push((level.rank, rising));
    }
    sorted.sort_by_key(|(rank, _)| std::cmp::Reverse(*rank));
    Some((sorted.into_iter().map(|(_, factor)| factor).collect(), is_opposite))
}

/// For a node a·g² − b with numbers a and b of one sign: g, b/a, and whether a is below 0. A
/// variable is no such g, since planes as x² = 1 are mostly far apart.
fn lessened_square(graph: &Graph, node: NodeId) -> Option<(NodeId, BigRational, bool)> {
    let form = Forms::default().of(graph, node);
    let [(term, factor)] = &form.terms[..] else { return None };
    let inner = graph.operands(*term, Op::Sqr)?[0];
    if matches!(graph.node(inner), Node::Variable(_)) {
        return None;
    }
    let square = -(&form.constant / factor);
    square.is_positive().then(|| (inner, square, factor.is_negative()))
}

/// The root of a number above 0, if it is rational.
fn exact_root(square: &BigRational) -> Option<BigRational> {
    let root = BigRational::new(square.numer().sqrt(), square.denom().sqrt());
    (&(&root * &root) == square).then_some(root)
}

/// The terms of a form that vary in space, and bounds of the sum of all others. `None` if these are
/// not known.
type Divided = (Vec<(NodeId, BigRational)>, [BigRational; 2]);

fn divided(graph: &Graph, form: &LinearForm, values: &[Interval]) -> Option<Divided> {
    let mut constant = [form.constant.clone(), form.constant.clone()];
    let mut terms = Vec::new();
    for (id, factor) in &form.terms {
        match constant_value(graph, *id, values) {
            Some(bounds) => {
                let exact = |bound: f64| BigRational::from_float(bound);
                let own = scaled(&[exact(bounds.lo)?, exact(bounds.hi)?], factor);
                constant = [0, 1].map(|end| &constant[end] + &own[end]);
            }
            None => terms.push((*id, factor.clone())),
        }
    }
    Some((terms, constant))
}

fn scaled(bounds: &[BigRational; 2], factor: &BigRational) -> [BigRational; 2] {
    let mut ends = [0, 1].map(|end| &bounds[end] * factor);
    if factor.is_negative() {
        ends.reverse();
    }
    ends
}

/// Bounds of a node that is the same number everywhere; `None` for other nodes.
fn constant_value(graph: &Graph, id: NodeId, values: &[Interval]) -> Option<Interval> {
    let mut found: FxHashMap<NodeId, Decorated> = FxHashMap::default();
    for id in graph.needed(&[id]) {
        let value = match graph.node(id) {
            Node::Variable(_) => return None,
            Node::Parameter(number) => (*values.get(*number as usize)?, Facts::TOTAL).into(),
            Node::Constant(constant) => constant.value(),
            Node::Apply(op, operands) => {
                let operands: Vec<Decorated> = operands.iter().map(|one| found[one]).collect();
                fold(*op, &operands).into()
            }
        };
        found.insert(id, value);
    }
    let Decorated { bounds, facts, .. } = found[&id];
    (facts.has(Facts::DEFINED) && bounds.lo.is_finite() && bounds.hi.is_finite()).then_some(bounds)
}
