//! Rewriting of a graph into a shorter one with tighter enclosures.
//!
//! One loop over the nodes of the given graph turns each into a [`PartialExpr`]: a node of the
//! simplified graph, or a sum or product still being collected. An operand with one user stays a
//! sum or product and merges with its user. An operand with several users becomes a node first and
//! stays shared. Products are never expanded, because a factored form has a tighter enclosure.
//! Until [`fold`] encloses them at the end, numbers stay exact and constants like √5 symbolic. So
//! equal constants cancel exactly.

mod fold;
mod form;
mod functions;
mod node_map;
mod numbers;
mod powers;
mod products;
mod sums;

#[cfg(test)]
mod tests;

use crate::compact::compact;
use crate::constant::Constant;
use crate::error::{IrError, NODE_LIMIT};
use crate::graph::{Graph, Node, NodeId};
use crate::variability::{Variability, variabilities};
use form::{Condition, PartialExpr, Product, Sum};
use node_map::NodeMap;
use num_rational::BigRational;
use num_traits::One;
use std::sync::Arc;
use zeroset_interval::{Decorated, Facts, Interval};
use zeroset_ops::{Class, Op, Restriction};

/// Returns a simpler graph that holds only the nodes that `roots` need, and the ids of the roots in
/// it. Values and domains of definition stay the same at every real point of `domain`, for all
/// parameters within `parameters`. Constant expressions become enclosures; [`rewrite`] leaves them
/// symbolic.
///
/// A parameter beyond the end of `parameters` may have any value.
///
/// ```
/// use zeroset_interval::Interval;
/// use zeroset_ir::{Axis, Graph, simplify};
/// use zeroset_ops::Op;
///
/// let mut graph = Graph::new();
/// let x = graph.variable(Axis::X);
/// let root = graph.apply(Op::Mul, &[x, x]);
/// let (simple, roots) = simplify(&graph, &[root], &[Interval::ENTIRE; 3], &[])?;
/// assert_eq!(zeroset_ir::display(&simple, roots[0], &[]), "sqr(x)");
/// # Ok::<(), zeroset_ir::IrError>(())
/// ```
///
/// # Errors
/// If the roots need more than [`NODE_LIMIT`] nodes, before or after simplifying.
pub fn simplify(
    graph: &Graph,
    roots: &[NodeId],
    domain: &[Interval; 3],
    parameters: &[Interval],
) -> Result<(Graph, Vec<NodeId>), IrError> {
    let (graph, roots) = rewrite(graph, roots, domain, parameters)?;
    Ok(fold::fold(&graph, &roots))
}

/// [`simplify`] without its last step: constant expressions stay symbolic. A later pass, such as
/// that for derivatives, can then still tell which of these expressions are equal.
///
/// # Errors
/// If the roots need more than [`NODE_LIMIT`] nodes, before or after rewriting.
pub fn rewrite(
    graph: &Graph,
    roots: &[NodeId],
    domain: &[Interval; 3],
    parameters: &[Interval],
) -> Result<(Graph, Vec<NodeId>), IrError> {
    let too_large = IrError::TooLarge { limit: NODE_LIMIT };
    let needed = graph.reachable(roots);
    if needed.iter().filter(|needed| **needed).count() > NODE_LIMIT {
        return Err(too_large);
    }
    let mut uses = vec![0_u32; graph.len()];
    for root in roots {
        uses[root.index()] += 1;
    }
    for (_, node) in graph.iter().filter(|(id, _)| needed[id.index()]) {
        if let Node::Apply(_, operands) = node {
            operands.iter().for_each(|id| uses[id.index()] += 1);
        }
    }
    let mut rewriter = Rewriter {
        graph: Graph::with_capacity(graph.len()),
        known: Vec::with_capacity(graph.len()),
        variabilities: Vec::new(),
        sums: NodeMap::default(),
        products: NodeMap::default(),
        domain,
        parameters,
    };
    let mut values: Vec<Option<PartialExpr>> = vec![None; graph.len()];
    // These variabilities are those of the given graph. An exponent is constant only if it was
    // written without coordinates and parameters.
    let variabilities = variabilities(graph);
    for (id, node) in graph.iter().filter(|(id, _)| needed[id.index()]) {
        let value = match node {
            Node::Variable(_) | Node::Parameter(_) => PartialExpr::Node(rewriter.leaf(node)),
            Node::Constant(constant) => match constant.exact() {
                Some(number) => PartialExpr::Product(Product::number(number.clone())),
                None => PartialExpr::Node(rewriter.leaf(node)),
            },
            Node::Apply(op, operands) => {
                let is_fixed = |id: &NodeId| variabilities[id.index()] == Variability::Constant;
                let fixed_exponent = operands.last().is_some_and(is_fixed);
                let operands = operands
                    .iter()
                    .map(|operand| match &values[operand.index()] {
                        Some(PartialExpr::Node(node)) => PartialExpr::Node(*node),
                        Some(PartialExpr::Product(product)) if product.factors.is_empty() => {
                            PartialExpr::Product(product.clone())
                        }
                        Some(PartialExpr::Sum(_) | PartialExpr::Product(_)) | None => values
                            [operand.index()]
                        .take()
                        .unwrap_or_else(|| unreachable!("one user")),
                    })
                    .collect();
                rewriter.apply(*op, operands, fixed_exponent)
            }
        };
        let is_number = matches!(&value, PartialExpr::Product(p) if p.as_number().is_some());
        values[id.index()] = Some(if uses[id.index()] > 1 && !is_number {
            PartialExpr::Node(rewriter.node_of(value))
        } else {
            value
        });
        if rewriter.graph.len() > 4 * NODE_LIMIT {
            return Err(too_large);
        }
    }
    let roots: Vec<NodeId> = roots
        .iter()
        .map(|root| {
            let value = values[root.index()].clone();
            rewriter.node_of(value.unwrap_or_else(|| unreachable!("reachable")))
        })
        .collect();
    let (graph, roots) = compact(&rewriter.graph, &roots);
    if graph.len() > NODE_LIMIT {
        return Err(too_large);
    }
    Ok((graph, roots))
}

/// The simplified graph under construction, with tables of what is known about its nodes.
struct Rewriter<'a> {
    graph: Graph,
    /// For each node, bounds of its values in the domain, and facts that hold in all of it.
    known: Vec<Decorated>,
    variabilities: Vec<Variability>,
    /// For each node that is a sum, its constant and its terms.
    sums: NodeMap<(BigRational, Vec<(NodeId, BigRational)>)>,
    /// For each node that is a product or a power, its factors.
    products: NodeMap<Product>,
    domain: &'a [Interval; 3],
    parameters: &'a [Interval],
}

impl Rewriter<'_> {
    fn known(&self, id: NodeId) -> Decorated {
        self.known[id.index()]
    }

    fn range(&self, id: NodeId) -> Interval {
        self.known(id).bounds
    }

    fn rank(&self, id: NodeId) -> Variability {
        self.variabilities[id.index()]
    }

    fn leaf(&mut self, node: &Node) -> NodeId {
        let within = |range: Interval| (range, Facts::TOTAL).into();
        let (id, value, rank) = match node {
            Node::Variable(axis) => {
                let range = self.domain[*axis as usize];
                (self.graph.variable(*axis), within(range), Variability::Varying)
            }
            Node::Parameter(number) => {
                let range = self.parameters.get(*number as usize);
                let range = range.copied().unwrap_or(Interval::ENTIRE);
                (self.graph.parameter(*number), within(range), Variability::Uniform)
            }
            Node::Constant(constant) => {
                let id = self.graph.constant(Arc::clone(constant));
                if id.index() < self.known.len() {
                    return id;
                }
                (id, constant.value(), Variability::Constant)
            }
            Node::Apply(..) => unreachable!("not a leaf"),
        };
        self.note(id, value, rank);
        id
    }

    fn number(&mut self, value: BigRational) -> NodeId {
        self.leaf(&Node::Constant(Constant::rational(value).into()))
    }

    fn node(&mut self, op: Op, operands: &[NodeId]) -> NodeId {
        let id = self.graph.apply(op, operands);
        if id.index() == self.known.len() {
            let mut known = [self.known(operands[0]); 3];
            for (known, &id) in known.iter_mut().zip(operands) {
                *known = self.known(id);
            }
            let rank =
                operands.iter().map(|&id| self.rank(id)).max().unwrap_or(Variability::Constant);
            self.note(id, zeroset_interval::fold(op, &known[..operands.len()]).into(), rank);
        }
        id
    }

    fn note(&mut self, id: NodeId, known: Decorated, rank: Variability) {
        if id.index() == self.known.len() {
            self.known.push(known);
            self.variabilities.push(rank);
        }
    }

    /// Returns the node of `value`. It includes the coefficient and the conditions.
    fn node_of(&mut self, value: PartialExpr) -> NodeId {
        match value {
            PartialExpr::Node(id) => id,
            PartialExpr::Sum(_) | PartialExpr::Product(_) => {
                let mut product = self.product(value);
                let conditions = std::mem::take(&mut product.conditions);
                let node = self.emit_product(&product);
                self.restrict(node, conditions)
            }
        }
    }

    /// Restricts `node`: it is then undefined where one of `conditions` does not hold.
    fn restrict(&mut self, mut node: NodeId, mut conditions: Vec<Condition>) -> NodeId {
        conditions.sort_unstable();
        conditions.dedup();
        for Condition(restriction, other) in conditions {
            let op = match restriction {
                Restriction::Defined if other == node => continue,
                Restriction::Defined => Op::WhereDefined,
                Restriction::Nonzero => Op::WhereNonzero,
                Restriction::Nonneg => Op::WhereNonneg,
                Restriction::Positive => Op::WherePositive,
            };
            node = self.node(op, &[node, other]);
        }
        node
    }

    /// Adds `condition` to `conditions` unless it holds on the whole domain.
    fn require(&self, conditions: &mut Vec<Condition>, condition: Condition) {
        let Condition(restriction, other) = condition;
        let known = self.known(other);
        let holds = match restriction {
            Restriction::Defined => true,
            Restriction::Nonzero => !known.bounds.contains(0.0),
            Restriction::Nonneg => known.bounds.lo >= 0.0,
            Restriction::Positive => known.bounds.lo > 0.0,
        };
        if !holds {
            conditions.push(condition);
        } else if !known.facts.has(Facts::DEFINED) {
            conditions.push(Condition(Restriction::Defined, other));
        }
    }

    fn apply(&mut self, op: Op, operands: Vec<PartialExpr>, fixed_exponent: bool) -> PartialExpr {
        let mut operands = operands.into_iter();
        let mut next = || operands.next().expect("as many operands as its arity");
        match op.row().class {
            Class::Negation => match next() {
                PartialExpr::Sum(mut sum) => {
                    sum.negate();
                    PartialExpr::Sum(sum)
                }
                value @ (PartialExpr::Node(_) | PartialExpr::Product(_)) => {
                    let mut product = self.product(value);
                    product.coefficient = -product.coefficient;
                    PartialExpr::Product(product)
                }
            },
            Class::Sum => {
                let (first, mut second) = (self.sum(next()), self.sum(next()));
                if op == Op::Sub {
                    second.negate();
                }
                PartialExpr::Sum(first.plus(second))
            }
            Class::Product => {
                let (first, second) =
                    (self.unmerged_product(next()), self.unmerged_product(next()));
                PartialExpr::Product(self.times(first, second))
            }
            Class::Quotient => self.quotient(next(), next()),
            Class::Square => self.integer_power(next(), 2),
            Class::Power => self.power(next(), next(), fixed_exponent),
            Class::Function(_) => self.function(op, next()),
            Class::Remainder => self.modulo(next(), next()),
            Class::FunctionOfTwo => {
                let operands = [self.node_of(next()), self.node_of(next())];
                PartialExpr::Node(self.node(op, &operands))
            }
            Class::Extremum => self.extremum(op, next(), next()),
            Class::Choice => self.choice(next(), next(), next()),
            Class::Fallback => self.fallback(next(), next()),
            Class::Restriction(restriction) => self.restriction(restriction, next(), next()),
        }
    }

    fn sum(&mut self, value: PartialExpr) -> Sum {
        match value {
            PartialExpr::Sum(sum) => sum,
            PartialExpr::Node(_) | PartialExpr::Product(_) => {
                let mut product = self.product(value);
                let mut sum = Sum::default();
                sum.conditions = std::mem::take(&mut product.conditions);
                if product.factors.is_empty() {
                    sum.add_constant(product.coefficient);
                } else {
                    let coefficient =
                        std::mem::replace(&mut product.coefficient, BigRational::one());
                    let term = self.emit_product(&product);
                    sum.add_term(term, coefficient);
                }
                sum
            }
        }
    }
}
