//! The expression graph.

use crate::constant::Constant;
use hashbrown::HashTable;
use num_rational::BigRational;
use rustc_hash::{FxBuildHasher, FxHashSet};
use std::hash::BuildHasher;
use std::sync::Arc;
use zeroset_ops::Op;

/// A coordinate of space.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Axis {
    /// The first coordinate.
    X,
    /// The second coordinate.
    Y,
    /// The third coordinate.
    Z,
}

impl Axis {
    /// All three axes, in order.
    pub const ALL: [Self; 3] = [Self::X, Self::Y, Self::Z];

    /// The axis's name in formulas.
    pub fn name(self) -> &'static str {
        match self {
            Self::X => "x",
            Self::Y => "y",
            Self::Z => "z",
        }
    }
}

/// Index of a node in its [`Graph`]. A node's operands have smaller ids than the node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct NodeId(u32);

impl NodeId {
    /// The id as an index into tables with an entry for each node.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// A node's computation: an input, a constant or an operation.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Node {
    /// A coordinate of the point at which the expression is evaluated.
    Variable(Axis),
    /// The parameter with this number. The parameter's value, of a slider or the time, may change
    /// without recompiling.
    Parameter(u32),
    /// A fixed real number. It is shared, so copies of a node are small and take no allocation.
    Constant(Arc<Constant>),
    /// An operation on earlier nodes.
    Apply(Op, Operands),
}

/// One to three operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Operands {
    // Unused slots repeat the first operand, so equality and hashing need no length.
    ids: [NodeId; 3],
    len: u8,
}

impl Operands {
    fn new(operands: &[NodeId]) -> Self {
        let mut ids = [operands[0]; 3];
        ids[..operands.len()].copy_from_slice(operands);
        Self { ids, len: operands.len() as u8 }
    }
}

impl std::ops::Deref for Operands {
    type Target = [NodeId];
    fn deref(&self) -> &[NodeId] {
        &self.ids[..usize::from(self.len)]
    }
}

/// A growing set of expressions. Each expression is stored once, so passes may take equal nodes for
/// equal numbers. A constant known only by its bounds may be any number within them, so each such
/// constant gets a node of its own.
///
/// Two graphs are equal if they hold the same nodes in the same order.
#[derive(Clone, Debug, Default)]
pub struct Graph {
    nodes: Vec<Node>,
    /// The ids of all nodes but enclosed constants, with half of each node's hash. So growing the
    /// table reads no node, and a search seldom compares unequal nodes.
    index: HashTable<(u32, NodeId)>,
}

impl PartialEq for Graph {
    fn eq(&self, other: &Self) -> bool {
        self.nodes == other.nodes
    }
}

impl Graph {
    /// A graph without nodes.
    pub fn new() -> Self {
        Self::default()
    }

    /// A graph without nodes, with memory for `count` nodes.
    pub fn with_capacity(count: usize) -> Self {
        Self { nodes: Vec::with_capacity(count), index: HashTable::with_capacity(count) }
    }

    /// The number of nodes.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Returns whether the graph has no nodes.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Returns the node with this id.
    ///
    /// # Panics
    /// If `id` belongs to a larger graph.
    pub fn node(&self, id: NodeId) -> &Node {
        &self.nodes[id.index()]
    }

    /// The constant at node `id`, or `None` if the node is not a constant.
    ///
    /// # Panics
    /// If `id` belongs to a larger graph.
    pub fn number(&self, id: NodeId) -> Option<&Constant> {
        match self.node(id) {
            Node::Constant(value) => Some(value.as_ref()),
            Node::Variable(_) | Node::Parameter(_) | Node::Apply(..) => None,
        }
    }

    /// The exact value of node `id`; `None` if the node is an enclosed constant or not a constant.
    pub(crate) fn exact(&self, id: NodeId) -> Option<&BigRational> {
        self.number(id)?.exact()
    }

    /// The operands of node `id` if the node applies `op`, else `None`.
    pub(crate) fn operands(&self, id: NodeId, op: Op) -> Option<&[NodeId]> {
        match self.node(id) {
            Node::Apply(found, operands) if *found == op => Some(operands),
            Node::Variable(_) | Node::Parameter(_) | Node::Constant(_) | Node::Apply(..) => None,
        }
    }

    /// All nodes in order: operands precede the nodes that use them.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = (NodeId, &Node)> {
        self.nodes.iter().enumerate().map(|(index, node)| (NodeId(index as u32), node))
    }

    /// The nodes from index `first` on, which were added after the graph had `first` nodes.
    pub fn since(&self, first: usize) -> impl Iterator<Item = (NodeId, &Node)> {
        let later = self.nodes.get(first..).unwrap_or_default();
        later.iter().zip(first..).map(|(node, index)| (NodeId(index as u32), node))
    }

    /// Returns the node of a coordinate. Adds the node if the graph has none yet.
    pub fn variable(&mut self, axis: Axis) -> NodeId {
        self.intern(Node::Variable(axis))
    }

    /// Returns the node of the parameter with this number. Adds the node if the graph has none yet.
    pub fn parameter(&mut self, number: u32) -> NodeId {
        self.intern(Node::Parameter(number))
    }

    /// Returns the node of a constant. A constant known only by its bounds always gets a new node.
    pub fn constant(&mut self, value: impl Into<Arc<Constant>>) -> NodeId {
        let value = value.into();
        match *value {
            Constant::Exact(_) | Constant::Named(_) => self.intern(Node::Constant(value)),
            Constant::Enclosed(_) => self.push(Node::Constant(value)),
        }
    }

    /// Returns the node of a small integer.
    pub fn integer(&mut self, value: i64) -> NodeId {
        self.constant(Constant::integer(value))
    }

    /// Returns the node of `op` applied to `operands`, which is not simplified.
    ///
    /// # Panics
    /// If the number of operands is not the arity of `op`, or an operand does not exist.
    pub fn apply(&mut self, op: Op, operands: &[NodeId]) -> NodeId {
        assert_eq!(operands.len(), op.arity(), "{op:?}");
        assert!(operands.iter().all(|id| id.index() < self.nodes.len()), "unknown operand");
        self.intern(Node::Apply(op, Operands::new(operands)))
    }

    /// The existing node of `op` applied to `operands`, or `None`.
    pub(crate) fn find(&self, op: Op, operands: &[NodeId]) -> Option<NodeId> {
        let node = Node::Apply(op, Operands::new(operands));
        self.indexed(&node, half_hash(&node))
    }

    /// The node that equals `node`, whose half hash is `half`; `None` if the graph has no such
    /// node.
    fn indexed(&self, node: &Node, half: u32) -> Option<NodeId> {
        let is_equal =
            |(other, id): &(u32, NodeId)| *other == half && self.nodes[id.index()] == *node;
        self.index.find(spread(half), is_equal).map(|(_, id)| *id)
    }

    fn intern(&mut self, node: Node) -> NodeId {
        let half = half_hash(&node);
        if let Some(id) = self.indexed(&node, half) {
            return id;
        }
        let id = self.push(node);
        self.index.insert_unique(spread(half), (half, id), |(half, _)| spread(*half));
        id
    }

    fn push(&mut self, node: Node) -> NodeId {
        let id = NodeId(u32::try_from(self.nodes.len()).expect("fewer than 2^32 nodes"));
        self.nodes.push(node);
        id
    }

    /// All nodes that `roots` need, themselves included, in order: operands precede the nodes that
    /// use them. It takes time in proportion to these nodes, whatever the size of the graph.
    pub fn needed(&self, roots: &[NodeId]) -> Vec<NodeId> {
        let mut open = roots.to_vec();
        let mut needed: FxHashSet<NodeId> = open.iter().copied().collect();
        while let Some(id) = open.pop() {
            if needed.len() * SCANNED > self.len() {
                // Scanning all nodes is faster.
                let needed = self.reachable(roots);
                return self.iter().map(|(id, _)| id).filter(|id| needed[id.index()]).collect();
            }
            if let Node::Apply(_, operands) = self.node(id) {
                open.extend(operands.iter().filter(|operand| needed.insert(**operand)));
            }
        }
        let mut needed: Vec<NodeId> = needed.into_iter().collect();
        needed.sort_unstable();
        needed
    }

    /// For each node, by index, whether the node is a root or some root depends on it.
    pub fn reachable(&self, roots: &[NodeId]) -> Vec<bool> {
        let mut needed = vec![false; self.nodes.len()];
        for root in roots {
            needed[root.index()] = true;
        }
        for index in (0..self.nodes.len()).rev() {
            if let (true, Node::Apply(_, operands)) = (needed[index], &self.nodes[index]) {
                operands.iter().for_each(|id| needed[id.index()] = true);
            }
        }
        needed
    }
}

/// Collecting one node takes at least as long as scanning this many nodes.
const SCANNED: usize = 16;

/// The lower half of a node's hash: the best bits of this hasher.
fn half_hash(node: &Node) -> u32 {
    FxBuildHasher.hash_one(node) as u32
}

/// A hash of 64 bits from half a hash. The factor is 2⁶⁴ divided by the golden ratio.
fn spread(half: u32) -> u64 {
    u64::from(half).wrapping_mul(0x9E37_79B9_7F4A_7C15)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constant::NamedConstant;

    #[test]
    fn equal_expressions_are_one_node() {
        let mut graph = Graph::new();
        let x = graph.variable(Axis::X);
        let one = graph.integer(1);
        let a = graph.apply(Op::Add, &[x, one]);
        let again = graph.integer(1);
        assert_eq!(graph.apply(Op::Add, &[x, again]), a);
        assert_ne!(graph.apply(Op::Add, &[one, x]), a);
        assert_eq!(graph.len(), 4);
    }

    #[test]
    fn numbers_known_by_bounds_only_are_never_one_node() {
        let mut graph = Graph::new();
        let near = Constant::decimal("1e-400").expect("a decimal");
        let [a, b] = [0, 1].map(|_| graph.constant(near.clone()));
        assert_ne!(a, b);
        let [pi, again] = [0, 1].map(|_| graph.constant(Constant::Named(NamedConstant::Pi)));
        assert_eq!(pi, again);
        assert_ne!(
            pi,
            graph.constant(Constant::enclosed(Constant::Named(NamedConstant::Pi).bounds()))
        );
    }

    #[test]
    fn reachable_follows_operands_only() {
        let mut graph = Graph::new();
        let x = graph.variable(Axis::X);
        let y = graph.variable(Axis::Y);
        let root = graph.apply(Op::Sin, &[x]);
        let needed = graph.reachable(&[root]);
        assert!(needed[x.index()] && needed[root.index()] && !needed[y.index()]);
    }
}
