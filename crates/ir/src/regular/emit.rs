//! Functions of sets, as nodes of a graph.

use super::form::LinearForm;
use super::sets::{Entry, Kind, Set, SetId};
use crate::algebra::{add, mul, neg, sub};
use crate::constant::Constant;
use crate::graph::{Graph, NodeId};
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};
use rustc_hash::FxHashMap;
use std::rc::Rc;
use zeroset_ops::Op;

/// The terms of a form.
type Terms = Vec<(NodeId, BigRational)>;

/// Sets whose functions are added to a graph.
pub(super) struct Plan {
    entries: Vec<Entry>,
    made: FxHashMap<SetId, NodeId>,
}

impl Plan {
    pub fn new(entries: Vec<Entry>) -> Self {
        Self { entries, made: FxHashMap::default() }
    }

    /// Returns a function that is ≤ 0 in the set, and above 0 elsewhere. Reuses a node of the given
    /// function if the set is the set of that node.
    pub fn emit(mut self, graph: &mut Graph, root: SetId) -> NodeId {
        self.node(graph, root)
    }

    /// The node of a set's function, which is created at most once.
    fn node(&mut self, graph: &mut Graph, id: SetId) -> NodeId {
        if let Some(node) = self.made.get(&id) {
            return *node;
        }
        let Entry { set, source, form } = &self.entries[id.index()];
        let node = match (set, source, form) {
            (Set::All, ..) => graph.integer(-1),
            (Set::Nothing, ..) => graph.integer(1),
            (_, Some((node, negated)), _) => {
                if *negated {
                    neg(graph, *node)
                } else {
                    *node
                }
            }
            (Set::Bound(_), None, Some(form)) => linear(graph, form),
            (Set::Bound(_), None, None) => unreachable!("a bound is made from a form"),
            (Set::Group(kind, members), None, _) => {
                let (kind, members) = (*kind, Rc::clone(members));
                let nodes = self.nodes(graph, kind, &members);
                balanced(graph, operation(kind), &nodes)
            }
        };
        self.made.insert(id, node);
        node
    }

    /// The functions whose maximum or minimum is the function of a group. Two opposite bounds with
    /// the same slope, such as x − 1 and −x − 1, have one function: |x| − 1.
    fn nodes(&mut self, graph: &mut Graph, kind: Kind, members: &[SetId]) -> Vec<NodeId> {
        let mut nodes = Vec::with_capacity(members.len());
        // The place and the form of each bound, by the terms of the opposite bound.
        let mut bounds: FxHashMap<Terms, (usize, Rc<LinearForm>)> = FxHashMap::default();
        for id in members {
            let Some(form) = self.made_form(*id) else {
                nodes.push(self.node(graph, *id));
                continue;
            };
            match bounds.remove(&form.terms) {
                None => {
                    let opposite = form.scaled(&-BigRational::one());
                    bounds.insert(opposite.terms, (nodes.len(), form));
                    nodes.push(self.node(graph, *id));
                }
                Some((place, first)) => nodes[place] = magnitude(graph, kind, [&first, &form]),
            }
        }
        nodes
    }

    /// The linear form of a bound. `None` if the bound is already a node of the given function.
    fn made_form(&self, id: SetId) -> Option<Rc<LinearForm>> {
        let Entry { set, source, form } = &self.entries[id.index()];
        let is_made = matches!(set, Set::Bound(_)) && source.is_none();
        form.clone().filter(|_| is_made)
    }
}

fn operation(kind: Kind) -> Op {
    match kind {
        Kind::Intersection => Op::Max,
        Kind::Union => Op::Min,
    }
}

/// Applies `op` to the nodes as a tree of least depth.
fn balanced(graph: &mut Graph, op: Op, nodes: &[NodeId]) -> NodeId {
    if let [only] = nodes {
        return *only;
    }
    let (first, second) = nodes.split_at(nodes.len().div_ceil(2));
    let operands = [balanced(graph, op, first), balanced(graph, op, second)];
    graph.apply(op, &operands)
}

/// The maximum or the minimum of two forms whose sum is a constant 2k: k ± |f − k| for the first
/// form f.
fn magnitude(graph: &mut Graph, kind: Kind, [first, second]: [&LinearForm; 2]) -> NodeId {
    let half = BigRational::new(1.into(), 2.into());
    let middle = (&first.constant + &second.constant) * half;
    let mut from = LinearForm { constant: &first.constant - &middle, ..first.clone() };
    if from.terms[0].1.is_negative() {
        from = from.scaled(&-BigRational::one());
    }
    let from = linear(graph, &from);
    let distance = graph.apply(Op::Abs, &[from]);
    let middle = graph.constant(Constant::rational(middle));
    match kind {
        Kind::Intersection => add(graph, distance, middle),
        Kind::Union => sub(graph, middle, distance),
    }
}

/// The node of a form.
fn linear(graph: &mut Graph, form: &LinearForm) -> NodeId {
    let constant = (!form.constant.is_zero()).then_some((None, &form.constant));
    let parts: Vec<(Option<NodeId>, &BigRational)> =
        form.terms.iter().map(|(id, c)| (Some(*id), c)).chain(constant).collect();
    let zero = graph.integer(0);
    // Positive terms come first, so that the sum does not begin with a negation.
    [true, false].into_iter().fold(zero, |sum, is_added| {
        let some = parts.iter().filter(|(_, c)| c.is_positive() == is_added);
        some.fold(sum, |sum, (id, c)| {
            let factor = graph.constant(Constant::rational(c.abs()));
            let part = match id {
                Some(id) => mul(graph, factor, *id),
                None => factor,
            };
            if is_added { add(graph, sum, part) } else { sub(graph, sum, part) }
        })
    })
}
