//! Linear forms of nodes, with exact coefficients.

use super::thin::is_thin_zero;
use crate::graph::{Graph, Node, NodeId};
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};
use rustc_hash::FxHashMap;
use std::rc::Rc;
use zeroset_interval::Interval;
use zeroset_ops::Op;

/// Largest number of terms of a form. A longer sum is a term of its own.
const TERM_LIMIT: usize = 32;
/// Deepest nesting of sums. A sum nested deeper is a term of its own.
const DEPTH_LIMIT: usize = 64;

/// A linear form Σ cᵢ·tᵢ + constant. The terms tᵢ are nodes that are no sums, in ascending order;
/// no cᵢ is 0.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct LinearForm {
    pub terms: Vec<(NodeId, BigRational)>,
    pub constant: BigRational,
}

impl LinearForm {
    fn term(id: NodeId) -> Self {
        Self { terms: vec![(id, BigRational::one())], constant: BigRational::zero() }
    }

    fn number(constant: BigRational) -> Self {
        Self { terms: Vec::new(), constant }
    }

    /// Returns whether the form is 0.
    pub fn is_zero(&self) -> bool {
        self.terms.is_empty() && self.constant.is_zero()
    }

    pub fn scaled(&self, factor: &BigRational) -> Self {
        if factor.is_zero() {
            return Self::number(BigRational::zero());
        }
        let terms = self.terms.iter().map(|(id, c)| (*id, c * factor)).collect();
        Self { terms, constant: &self.constant * factor }
    }

    pub fn plus(&self, other: &Self) -> Self {
        let mut terms = self.terms.clone();
        for (id, c) in &other.terms {
            match terms.binary_search_by_key(id, |term| term.0) {
                Ok(at) => terms[at].1 += c,
                Err(at) => terms.insert(at, (*id, c.clone())),
            }
        }
        terms.retain(|(_, c)| !c.is_zero());
        Self { terms, constant: &self.constant + &other.constant }
    }
}

/// For each node, the place of the first of the nodes whose zeros bound the same sets: it is a
/// multiple of that node. The flag tells whether the factor is negative, so that the sets where
/// the two are below 0 are complements. Then both are proven to be defined everywhere, and 0 on no
/// open set. A node that is not found to be a multiple has its own place.
///
/// ```
/// use zeroset_ir::{Axis, Graph, multiples};
/// use zeroset_ops::Op;
///
/// let mut graph = Graph::new();
/// let (x, one) = (graph.variable(Axis::X), graph.integer(1));
/// let right = graph.apply(Op::Sub, &[x, one]);
/// let left = graph.apply(Op::Sub, &[one, x]);
/// assert_eq!(multiples(&graph, &[right, x, left], &[]), [(0, false), (1, false), (0, true)]);
/// ```
pub fn multiples(graph: &Graph, nodes: &[NodeId], parameters: &[Interval]) -> Vec<(usize, bool)> {
    let mut forms = Forms::default();
    let mut known: FxHashMap<LinearForm, (usize, bool)> = FxHashMap::default();
    let place = |(place, node): (usize, &NodeId)| {
        let form = forms.of(graph, *node);
        let Some((_, first)) = form.terms.first() else { return (place, false) };
        let own = (place, first.is_negative());
        let (found, was_negative) = *known.entry(form.scaled(&first.recip())).or_insert(own);
        let is_opposite = own.1 != was_negative;
        let is_found = !is_opposite || is_thin_zero(graph, *node, parameters);
        if is_found { (found, is_opposite) } else { (place, false) }
    };
    nodes.iter().enumerate().map(place).collect()
}

/// For each node that is a linear function everywhere, the coefficients of x, y and z, and the
/// constant. `None` if these are not found for all nodes.
///
/// ```
/// use zeroset_ir::{Axis, Graph, planes};
/// use zeroset_ops::Op;
///
/// let mut graph = Graph::new();
/// let [x, y] = [Axis::X, Axis::Y].map(|axis| graph.variable(axis));
/// let sum = graph.apply(Op::Add, &[x, y]);
/// let found = planes(&graph, &[sum]).expect("linear");
/// assert_eq!(found[0].each_ref().map(|number| number.to_string()), ["1", "1", "0", "0"]);
/// let product = graph.apply(Op::Mul, &[x, y]);
/// assert_eq!(planes(&graph, &[product]), None);
/// ```
pub fn planes(graph: &Graph, nodes: &[NodeId]) -> Option<Vec<[BigRational; 4]>> {
    let mut forms = Forms::default();
    let plane = |node: &NodeId| {
        let form = forms.of(graph, *node);
        let mut plane = [(); 4].map(|()| BigRational::zero());
        for (id, coefficient) in &form.terms {
            let Node::Variable(axis) = graph.node(*id) else { return None };
            plane[*axis as usize] = coefficient.clone();
        }
        plane[3] = form.constant.clone();
        Some(plane)
    };
    nodes.iter().map(plane).collect()
}

/// The forms of nodes, each computed once.
#[derive(Default)]
pub(super) struct Forms(FxHashMap<NodeId, Rc<LinearForm>>);

impl Forms {
    /// Returns the form of a node.
    pub fn of(&mut self, graph: &Graph, id: NodeId) -> Rc<LinearForm> {
        self.within(graph, id, 0)
    }

    /// The linear form of a node. A node that is no sum of terms is a term itself.
    fn within(&mut self, graph: &Graph, id: NodeId, depth: usize) -> Rc<LinearForm> {
        if let Some(form) = self.0.get(&id) {
            return Rc::clone(form);
        }
        let form = if depth < DEPTH_LIMIT { self.linear(graph, id, depth) } else { None };
        let form = form.filter(|form| form.terms.len() <= TERM_LIMIT);
        let form = Rc::new(form.unwrap_or_else(|| LinearForm::term(id)));
        self.0.insert(id, Rc::clone(&form));
        form
    }

    /// The form of a number, a sum or a multiple; `None` for other nodes.
    fn linear(&mut self, graph: &Graph, id: NodeId, depth: usize) -> Option<LinearForm> {
        let (op, operands) = match graph.node(id) {
            Node::Constant(value) => return Some(LinearForm::number(value.exact()?.clone())),
            Node::Variable(_) | Node::Parameter(_) => return None,
            Node::Apply(op, operands) => (*op, *operands),
        };
        let mut operand = |k: usize| self.within(graph, operands[k], depth + 1);
        let minus = -BigRational::one();
        if op == Op::Neg {
            Some(operand(0).scaled(&minus))
        } else if op == Op::Add {
            Some(operand(0).plus(&operand(1)))
        } else if op == Op::Sub {
            Some(operand(0).plus(&operand(1).scaled(&minus)))
        } else if op == Op::Mul {
            let [first, second] = [0, 1].map(&mut operand);
            if first.terms.is_empty() {
                Some(second.scaled(&first.constant))
            } else if second.terms.is_empty() {
                Some(first.scaled(&second.constant))
            } else {
                None
            }
        } else if op == Op::Div {
            let divisor = operand(1);
            let is_number = divisor.terms.is_empty() && !divisor.constant.is_zero();
            is_number.then(|| operand(0).scaled(&divisor.constant.recip()))
        } else {
            None
        }
    }
}
