//! Proofs that a function is constant on no open set.
//!
//! The proof is for functions made of analytic operations and of choices. The operation |a| chooses
//! a or −a, a minimum chooses an operand, and √a chooses one of two roots. Suppose that a function
//! has the value c on an open set. Then one combination of choices has the value c on a smaller
//! open set. That combination is analytic along every line. So it has the value c on each line
//! through the set, and thus in all of space. Hence, if at some point no combination has the value
//! c, the function is c on no open set.
//!
//! The root of a is analytic along a line if a is analytic there and ≥ 0: its zeros on the line
//! have even orders. So a must be ≥ 0 in all of space, and made without choices.

use crate::constant::Constant;
use crate::graph::{Graph, Node, NodeId};
use rustc_hash::FxHashMap;
use std::rc::Rc;
use zeroset_interval::{Decorated, Facts, Interval, fold};
use zeroset_ops::Op;

/// Places without symmetry, near the origin and away from it.
const PLACES: [[f64; 3]; 4] = [
    [0.731_2, -1.377_1, 2.193_7],
    [-13.113, 7.771, 21.379],
    [0.012_3, 0.071_7, -0.045_9],
    [-311.7, -507.3, -402.9],
];
/// Largest number of values that a node may have at a place, over all combinations.
const VALUE_LIMIT: usize = 64;
/// Deepest nesting of operations.
const DEPTH_LIMIT: usize = 64;

/// The values at one place of all combinations of choices; `None` if the node may be no function
/// of the kind described above.
type Values = Option<Rc<Vec<Interval>>>;

/// Operations without negative values.
const NONNEG: [Op; 5] = [Op::Sqr, Op::Abs, Op::Exp, Op::Sqrt, Op::Cosh];
/// Operations without negative values for operands without negative values.
const NONNEG_WITH_OPERANDS: [Op; 3] = [Op::Add, Op::Mul, Op::Min];

/// Returns whether a node is proven to be defined everywhere, and 0 on no open set.
pub(crate) fn is_thin_zero(graph: &Graph, id: NodeId, parameters: &[Interval]) -> bool {
    let places = Thinness::new(parameters).sums(graph, &[(id, Constant::integer(1))]);
    let differs = |values: &Values| {
        values.as_ref().is_some_and(|values| values.iter().all(|value| !value.contains(0.0)))
    };
    places.iter().any(differs)
}

/// Values of nodes, each computed once.
pub(super) struct Thinness<'a> {
    parameters: &'a [Interval],
    values: [FxHashMap<NodeId, Values>; PLACES.len()],
    /// Whether a node is analytic, and made without choices.
    smooth: FxHashMap<NodeId, bool>,
    nonneg: Nonneg,
}

impl<'a> Thinness<'a> {
    pub fn new(parameters: &'a [Interval]) -> Self {
        Self {
            parameters,
            values: Default::default(),
            smooth: FxHashMap::default(),
            nonneg: Nonneg::default(),
        }
    }

    /// Returns, for each place, the values of Σ cᵢ·tᵢ over all combinations of choices.
    pub fn sums(&mut self, graph: &Graph, terms: &[(NodeId, Constant)]) -> Vec<Values> {
        let places = 0..PLACES.len();
        places.map(|place| self.sum(graph, terms, place)).collect()
    }

    /// The values of a sum at one place. `None` if they are not known.
    fn sum(&mut self, graph: &Graph, terms: &[(NodeId, Constant)], place: usize) -> Values {
        let mut sums = vec![Interval::ZERO];
        for (id, coefficient) in terms {
            let values = self.at(graph, *id, place, 0)?;
            let factor = coefficient.bounds();
            let scaled = combined(Op::Mul, &[factor], &values)?;
            sums = combined(Op::Add, &sums, &scaled)?;
        }
        Some(Rc::new(sums))
    }

    /// The values of a node at one place. `None` if they are not known.
    fn at(&mut self, graph: &Graph, id: NodeId, place: usize, depth: usize) -> Values {
        if let Some(values) = self.values[place].get(&id) {
            return values.clone();
        }
        let values = if depth < DEPTH_LIMIT { self.found(graph, id, place, depth) } else { None };
        let values = values.filter(|values| values.len() <= VALUE_LIMIT).map(Rc::new);
        self.values[place].insert(id, values.clone());
        values
    }

    fn found(
        &mut self,
        graph: &Graph,
        id: NodeId,
        place: usize,
        depth: usize,
    ) -> Option<Vec<Interval>> {
        let (op, operands) = match graph.node(id) {
            Node::Variable(axis) => {
                return Interval::point(PLACES[place][*axis as usize]).map(|at| vec![at]);
            }
            Node::Parameter(number) => {
                return self.parameters.get(*number as usize).map(|range| vec![*range]);
            }
            Node::Constant(value) => return Some(vec![value.bounds()]),
            Node::Apply(op, operands) => (*op, *operands),
        };
        let mut operand = |k: usize| self.at(graph, operands[k], place, depth + 1);
        match Pieces::of(graph, op, &operands) {
            Pieces::One if operands.len() == 1 => {
                operand(0)?.iter().map(|a| applied(op, &[*a])).collect()
            }
            Pieces::One if op == Op::Pow => {
                let exponent = graph.number(operands[1])?.value();
                let raised = |a: &Interval| {
                    let base = Decorated::from((*a, Facts::TOTAL));
                    bounded(fold(op, &[base, exponent]))
                };
                operand(0)?.iter().map(raised).collect()
            }
            Pieces::One => combined(op, &operand(0)?, &operand(1)?),
            Pieces::Operands => Some([&operand(0)?[..], &operand(1)?[..]].concat()),
            Pieces::BothSigns => {
                let value = operand(0)?;
                let opposite = value.iter().map(|a| Interval { lo: -a.hi, hi: -a.lo });
                Some(value.iter().copied().chain(opposite).collect())
            }
            Pieces::Roots => {
                let value = operand(0)?;
                let radicand = operands[0];
                if !self.is_smooth(graph, radicand, depth + 1)
                    || !self.nonneg.holds(graph, radicand)
                {
                    return None;
                }
                let root = applied(Op::Sqrt, &[*value.first().filter(|a| a.lo > 0.0)?])?;
                Some(vec![root, Interval { lo: -root.hi, hi: -root.lo }])
            }
            Pieces::Unknown => None,
        }
    }

    /// Returns whether a node is analytic in all of space, and made without choices.
    fn is_smooth(&mut self, graph: &Graph, id: NodeId, depth: usize) -> bool {
        if let Some(known) = self.smooth.get(&id) {
            return *known;
        }
        let is_smooth = depth < DEPTH_LIMIT
            && match graph.node(id) {
                Node::Variable(_) | Node::Parameter(_) | Node::Constant(_) => true,
                Node::Apply(op, operands) => {
                    let operands = *operands;
                    matches!(Pieces::of(graph, *op, &operands), Pieces::One)
                        && operands.iter().all(|id| self.is_smooth(graph, *id, depth + 1))
                }
            };
        self.smooth.insert(id, is_smooth);
        is_smooth
    }
}

/// The analytic pieces of an operation, for analytic operands.
enum Pieces {
    /// It is analytic.
    One,
    /// It is one of its operands.
    Operands,
    /// It is its operand or the negated operand.
    BothSigns,
    /// It is one of the two square roots.
    Roots,
    Unknown,
}

impl Pieces {
    fn of(graph: &Graph, op: Op, operands: &[NodeId]) -> Self {
        match op {
            Op::Neg
            | Op::Add
            | Op::Sub
            | Op::Mul
            | Op::Sqr
            | Op::Exp
            | Op::Sin
            | Op::Cos
            | Op::Sinh
            | Op::Cosh
            | Op::Tanh
            | Op::Atan
            | Op::Asinh
            | Op::Erf
            | Op::BesselJ0
            | Op::BesselJ1
            | Op::BesselJ2
            | Op::BesselJ3 => Self::One,
            Op::Pow => {
                let exponent = graph.number(operands[1]).and_then(Constant::as_integer);
                if exponent.is_some_and(|n| n >= 0) { Self::One } else { Self::Unknown }
            }
            Op::Div => {
                let divisor = graph.number(operands[1]).map(Constant::bounds);
                let is_fixed = divisor.is_some_and(|divisor| !divisor.contains(0.0));
                if is_fixed { Self::One } else { Self::Unknown }
            }
            Op::Min | Op::Max => Self::Operands,
            Op::Abs => Self::BothSigns,
            Op::Sqrt => Self::Roots,
            Op::Sign
            | Op::Floor
            | Op::Ceil
            | Op::Round
            | Op::Trunc
            | Op::Fract
            | Op::Cbrt
            | Op::Ln
            | Op::Log2
            | Op::Log10
            | Op::Tan
            | Op::Asin
            | Op::Acos
            | Op::Acosh
            | Op::Atanh
            | Op::Mod
            | Op::Atan2
            | Op::SelectNegative
            | Op::Otherwise
            | Op::WhereNonneg
            | Op::WherePositive
            | Op::WhereNonzero
            | Op::WhereDefined => Self::Unknown,
        }
    }
}

/// Proofs that nodes are ≥ 0 wherever they are defined, by their operations alone. Each node is
/// visited once.
#[derive(Default)]
pub(crate) struct Nonneg {
    known: FxHashMap<NodeId, bool>,
}

impl Nonneg {
    /// Returns whether a node is proven ≥ 0. All calls must name the same graph, or one that grew
    /// from it.
    pub fn holds(&mut self, graph: &Graph, id: NodeId) -> bool {
        self.at(graph, id, 0)
    }

    /// Does the work of [`Self::holds`] for a node `depth` levels below the first one.
    fn at(&mut self, graph: &Graph, id: NodeId, depth: usize) -> bool {
        if let Some(known) = self.known.get(&id) {
            return *known;
        }
        let is_nonneg = depth <= DEPTH_LIMIT
            && match graph.node(id) {
                Node::Constant(value) => value.bounds().lo >= 0.0,
                Node::Variable(_) | Node::Parameter(_) => false,
                Node::Apply(op, operands) => {
                    let exponent = || graph.number(operands[1]).and_then(Constant::as_integer);
                    let mut operand = |id: &NodeId| self.at(graph, *id, depth + 1);
                    NONNEG.contains(op)
                        || NONNEG_WITH_OPERANDS.contains(op) && operands.iter().all(&mut operand)
                        || *op == Op::Max && operands.iter().any(operand)
                        || *op == Op::Pow && exponent().is_some_and(|n| n % 2 == 0)
                }
            };
        self.known.insert(id, is_nonneg);
        is_nonneg
    }
}

fn bounded((bounds, facts): (Interval, Facts)) -> Option<Interval> {
    (facts.has(Facts::DEFINED) && bounds.is_bounded()).then_some(bounds)
}

fn applied(op: Op, operands: &[Interval]) -> Option<Interval> {
    let operands: Vec<_> = operands.iter().map(|bounds| (*bounds, Facts::TOTAL)).collect();
    bounded(fold(op, &operands))
}

/// Returns the results for all pairs of operands. `None` if there are too many.
fn combined(op: Op, a: &[Interval], b: &[Interval]) -> Option<Vec<Interval>> {
    if a.len() * b.len() > VALUE_LIMIT {
        return None;
    }
    a.iter().flat_map(|a| b.iter().map(|b| applied(op, &[*a, *b]))).collect()
}
