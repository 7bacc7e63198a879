//! The oracle: a rigorous `f64` enclosure of a function, at one exact point or over a box.
//!
//! It exists to contradict the evaluators, so it shares no arithmetic with them. Every operation is
//! done in round-to-nearest `f64` and widened by one ulp unless it is known to be exact. Elementary
//! functions come from CORE-MATH, which rounds correctly. It deliberately knows nothing of `f32`,
//! derivatives and simplified graphs. Over boxes the bounds are those of plain interval arithmetic:
//! correct, but perhaps wide.

#[cfg(test)]
mod box_tests;
mod elementary;
mod power;
mod rounded;
mod rules;
mod span;
#[cfg(test)]
mod tests;

use num_bigint::BigInt;
use num_traits::{FromPrimitive, ToPrimitive};
use power::Exponent;
pub(crate) use span::Span;
use zeroset_ir::{Graph, Node, NodeId};

/// Whether a function is defined at a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Defined {
    /// It is certainly defined.
    Yes,
    /// It is certainly undefined.
    No,
    /// `f64` arithmetic cannot tell.
    Unknown,
}

impl Defined {
    /// Combines two operands: the result is defined where both operands are.
    fn and(self, other: Self) -> Self {
        match (self, other) {
            (Self::No, _) | (_, Self::No) => Self::No,
            (Self::Yes, Self::Yes) => Self::Yes,
            _ => Self::Unknown,
        }
    }

    /// Returns `Yes` if the operation must be defined, `No` if it cannot be, else `Unknown`.
    fn decide(must: bool, may: bool) -> Self {
        match (must, may) {
            (true, _) => Self::Yes,
            (false, true) => Self::Unknown,
            (false, false) => Self::No,
        }
    }
}

/// The oracle's claim about a function's value at a point.
///
/// If the function is defined there, its exact real value lies between `lo` and `hi`. An infinite
/// bound means that no `f64` is known to bound the value. Neither bound is ever NaN, `lo ≤ hi`, `lo
/// < +∞` and `hi > −∞`. If `defined` is [`Defined::No`], the bounds are −∞ and +∞.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Claim {
    /// Lower bound.
    pub lo: f64,
    /// Upper bound.
    pub hi: f64,
    /// Whether the function has a value.
    pub defined: Defined,
}

impl Claim {
    fn new(span: Span, defined: Defined) -> Self {
        let span = if defined == Defined::No { Span::ENTIRE } else { span };
        Self { lo: span.lo, hi: span.hi, defined }
    }

    fn span(self) -> Span {
        Span { lo: self.lo, hi: self.hi }
    }
}

/// The oracle's claim about a function over a box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoxClaim {
    /// Bounds of all values in the box. Their `defined` is [`Defined::Yes`] if the function is
    /// defined throughout the box, and [`Defined::No`] if it is defined nowhere in it.
    pub values: Claim,
    /// Whether the function is certainly defined and continuous throughout.
    pub continuous: bool,
}

/// A graph prepared for many points: its constants are enclosed once.
#[derive(Clone, Debug)]
pub struct Oracle<'a> {
    graph: &'a Graph,
    roots: Vec<NodeId>,
    /// Whether any root depends on a node, per node.
    needed: Vec<bool>,
    /// Bounds of each node that is a constant; all reals for other nodes.
    constants: Vec<Span>,
    /// Kind of exponent that each node is, if it serves as one.
    exponents: Vec<Exponent>,
}

impl<'a> Oracle<'a> {
    /// Prepares the nodes that `roots` need. The graph should be as typed, not simplified.
    ///
    /// # Panics
    /// If a root does not belong to `graph`.
    pub fn new(graph: &'a Graph, roots: &[NodeId]) -> Self {
        let needed = graph.reachable(roots);
        let mut constants = Vec::with_capacity(graph.len());
        let mut exponents: Vec<Exponent> = Vec::with_capacity(graph.len());
        for (_, node) in graph.iter() {
            constants.push(match node {
                Node::Constant(value) => Span::constant(value),
                Node::Variable(_) | Node::Parameter(_) | Node::Apply(..) => Span::ENTIRE,
            });
            exponents.push(match node {
                Node::Variable(_) | Node::Parameter(_) => Exponent::Varying,
                Node::Constant(value) => Exponent::of(value),
                Node::Apply(_, operands) => {
                    let varies = |id: &NodeId| matches!(exponents[id.index()], Exponent::Varying);
                    if operands.iter().any(varies) {
                        Exponent::Varying
                    } else {
                        Exponent::PerhapsInteger
                    }
                }
            });
        }
        Self { graph, roots: roots.to_vec(), needed, constants, exponents }
    }

    /// Returns a claim about each root's value at `point`.
    ///
    /// The element n of `parameters` bounds the value of parameter n. A parameter that is missing,
    /// or whose bounds are not in order, may be any real number. A coordinate that is not finite
    /// stands for any real number, too. The calling thread must round to nearest, as Rust code
    /// always does.
    pub fn at(&self, point: [f64; 3], parameters: &[(f64, f64)]) -> Vec<Claim> {
        let claims = self.claims(point.map(Span::point), parameters);
        self.roots.iter().map(|id| claims[id.index()]).collect()
    }

    /// Returns a claim about each root over the box with these ranges of x, y and z. `parameters`
    /// are as for [`Oracle::at`]. A range whose bounds are not in order contains all reals.
    pub fn over(&self, ranges: [(f64, f64); 3], parameters: &[(f64, f64)]) -> Vec<BoxClaim> {
        let claims = self.claims(ranges.map(|(lo, hi)| Span::new(lo, hi)), parameters);
        let mut continuous: Vec<bool> = Vec::with_capacity(claims.len());
        for (id, node) in self.graph.iter() {
            let holds = match node {
                Node::Variable(_) | Node::Parameter(_) | Node::Constant(_) => true,
                Node::Apply(op, operands) if self.needed[id.index()] => {
                    let values = operands.iter().map(|id| claims[id.index()]);
                    let operands = operands.iter().map(|id| continuous[id.index()]);
                    let value = claims[id.index()];
                    value.defined == Defined::Yes
                        && rules::is_continuous(*op, value, values, operands)
                }
                Node::Apply(..) => false,
            };
            continuous.push(holds);
        }
        let claim = |id: &NodeId| BoxClaim {
            values: claims[id.index()],
            continuous: continuous[id.index()],
        };
        self.roots.iter().map(claim).collect()
    }

    /// Returns a claim about each node's value.
    fn claims(&self, coordinates: [Span; 3], parameters: &[(f64, f64)]) -> Vec<Claim> {
        let nowhere = Claim::new(Span::ENTIRE, Defined::No);
        let mut claims: Vec<Claim> = Vec::with_capacity(self.graph.len());
        for (id, node) in self.graph.iter() {
            let index = id.index();
            let claim = match node {
                _ if !self.needed[index] => nowhere,
                Node::Variable(axis) => Claim::new(coordinates[*axis as usize], Defined::Yes),
                Node::Parameter(number) => {
                    let bounds = parameters.get(*number as usize);
                    let span = bounds.map_or(Span::ENTIRE, |&(lo, hi)| Span::new(lo, hi));
                    Claim::new(span, Defined::Yes)
                }
                Node::Constant(_) => Claim::new(self.constants[index], Defined::Yes),
                Node::Apply(op, operands) => {
                    let mut values = [nowhere; 3];
                    let mut exponent = Exponent::Varying;
                    for (value, operand) in values.iter_mut().zip(operands.iter()) {
                        *value = claims[operand.index()];
                        exponent = self.exponents[operand.index()];
                    }
                    rules::apply(*op, values, exponent)
                }
            };
            debug_assert!(claim.lo <= claim.hi, "{claim:?} of {node:?}");
            claims.push(claim);
        }
        claims
    }
}

/// Returns a claim about each root's value at `point`. [`Oracle::at`] is faster for many points.
///
/// # Panics
/// If a root does not belong to `graph`.
pub fn enclose_at(
    graph: &Graph,
    roots: &[NodeId],
    point: [f64; 3],
    parameters: &[(f64, f64)],
) -> Vec<Claim> {
    Oracle::new(graph, roots).at(point, parameters)
}

/// Returns two `f64` that enclose an integer. They are equal if the integer is an `f64`.
fn around(integer: &BigInt) -> Span {
    // `to_f64` is off by less than an ulp, so the floats next to it enclose the integer.
    let nearest = integer.to_f64().unwrap_or(f64::NAN);
    if BigInt::from_f64(nearest).as_ref() == Some(integer) {
        Span::point(nearest)
    } else {
        Span::new(nearest.next_down(), nearest.next_up())
    }
}
