//! Lowers conditions, which define solids or restrict equations.
//!
//! Neither a comparison nor its opposite holds where one of its sides has no value. Other
//! comparisons in the same condition still count.

use crate::lower::builders::Moves;
use crate::lower::lowering::{Locals, Lowering};
use zeroset_ir::{Constant, Graph, Node, NodeId};
use zeroset_ops::{Domain, Op};
use zeroset_parser::tree::ast::{Expr, ExprKind, Relation};
use zeroset_parser::{Error, ErrorKind, Fallible};

impl<'a> Lowering<'a> {
    /// The function of a solid: ≤ 0 inside the solid, above 0 outside, and defined everywhere.
    pub(crate) fn solid(&mut self, condition: &'a Expr) -> Fallible<NodeId> {
        // The margin of the opposite condition is positive outside the solid.
        let (node, _) = self.margin(condition, true, Purpose::Face, &[])?;
        Ok(node)
    }

    /// The margin of `condition` or, if `negated`, of its opposite. Also whether the margin is
    /// strict. The condition holds where the margin is positive or, if not strict, 0.
    pub(crate) fn margin(
        &mut self,
        condition: &'a Expr,
        negated: bool,
        purpose: Purpose,
        locals: &Locals<'a>,
    ) -> Fallible<(NodeId, bool)> {
        let mut margins = Vec::new();
        let all = match &condition.kind {
            ExprKind::Not(inner) => return self.margin(inner, !negated, purpose, locals),
            ExprKind::And(items) | ExprKind::Or(items) => {
                for item in items {
                    margins.push(self.margin(item, negated, purpose, locals)?);
                }
                matches!(condition.kind, ExprKind::And(_))
            }
            ExprKind::Compare(first, rest) => {
                for (left, relation, right) in comparisons(first, rest) {
                    let Some((low, high, strict)) = sides(left, relation, right) else {
                        let kind = match (purpose, relation) {
                            (Purpose::Face, Relation::Equal) => ErrorKind::EquationInCondition,
                            (Purpose::Face, _) => ErrorKind::UnequalOutsideBraces,
                            (Purpose::Restriction, Relation::Equal) => {
                                ErrorKind::RestrictionIsEquation
                            }
                            (Purpose::Restriction, _) => ErrorKind::MixedRestriction,
                        };
                        return Err(Error::new(left.span.to(right.span), kind));
                    };
                    let (low, high) = if negated { (high, low) } else { (low, high) };
                    let difference = self.difference(high, low, locals)?;
                    let outside = match purpose {
                        Purpose::Face => 1,
                        Purpose::Restriction => -1,
                    };
                    let margin = self.or_outside(difference, outside);
                    margins.push((margin, strict != negated));
                }
                true
            }
            _ => return Err(Error::new(condition.span, ErrorKind::RestrictionNotCondition)),
        };
        let strict = margins[0].1;
        if purpose == Purpose::Restriction && margins.iter().any(|(_, other)| *other != strict) {
            return Err(Error::new(condition.span, ErrorKind::MixedRestriction));
        }
        let nodes: Vec<NodeId> = margins.into_iter().map(|(node, _)| node).collect();
        Ok((self.fold(if all == negated { Op::Max } else { Op::Min }, &nodes), strict))
    }

    /// `node` where it is defined, else the number `outside`. A node that is defined everywhere is
    /// returned unchanged.
    pub(crate) fn or_outside(&mut self, node: NodeId, outside: i64) -> NodeId {
        or_outside(&mut self.graph, &mut self.total, &self.moves, node, outside)
    }

    /// Restricts `root` to the points at which `condition` holds.
    pub(crate) fn restrict(
        &mut self,
        root: NodeId,
        condition: &'a Expr,
        locals: &Locals<'a>,
    ) -> Fallible<NodeId> {
        match &condition.kind {
            ExprKind::And(items) => {
                items.iter().try_fold(root, |root, item| self.restrict(root, item, locals))
            }
            ExprKind::Compare(first, rest) => {
                let mut root = root;
                for (left, relation, right) in comparisons(first, rest) {
                    let (op, bound) = match sides(left, relation, right) {
                        Some((low, high, strict)) => {
                            (restriction(strict), self.difference(high, low, locals)?)
                        }
                        None if relation == Relation::Unequal => {
                            (Op::WhereNonzero, self.difference(left, right, locals)?)
                        }
                        None => {
                            let span = left.span.to(right.span);
                            return Err(Error::new(span, ErrorKind::RestrictionIsEquation));
                        }
                    };
                    root = self.graph.apply(op, &[root, bound]);
                }
                Ok(root)
            }
            ExprKind::Or(_) | ExprKind::Not(_) => {
                let (bound, strict) =
                    self.margin(condition, false, Purpose::Restriction, locals)?;
                Ok(self.graph.apply(restriction(strict), &[root, bound]))
            }
            _ => Err(Error::new(condition.span, ErrorKind::RestrictionNotCondition)),
        }
    }

    /// The intersection of the solids `root` and `condition`. Where `condition` cuts `root`, the
    /// solid gets a face. A condition that contains `!=` only removes points.
    pub(crate) fn cut(&mut self, root: NodeId, condition: &'a Expr) -> Fallible<NodeId> {
        match &condition.kind {
            ExprKind::And(items) => items.iter().try_fold(root, |root, item| self.cut(root, item)),
            _ if strictness(condition, false).is_some() => {
                let other = self.solid(condition)?;
                Ok(self.graph.apply(Op::Max, &[root, other]))
            }
            _ => self.restrict(root, condition, &[]),
        }
    }
}

/// Extends `total` to all nodes of the graph. Its entry for a node is true if the node is defined
/// everywhere.
pub(crate) fn extend_total(graph: &Graph, total: &mut Vec<bool>, moves: &Moves) {
    for (_, node) in graph.since(total.len()) {
        let is_total = match node {
            Node::Parameter(_) if let Some((shape, point)) = moves.get(node) => {
                let total = |node: NodeId| total[node.index()];
                total(shape) && point.into_iter().all(total)
            }
            Node::Variable(_) | Node::Parameter(_) | Node::Constant(_) => true,
            Node::Apply(op, operands) => {
                let each = operands.iter().all(|operand| total[operand.index()]);
                each && match op.row().domain {
                    Domain::All => true,
                    Domain::Power => {
                        let exponent = graph.number(operands[1]);
                        exponent.and_then(Constant::as_integer).is_some_and(|n| n >= 0)
                    }
                    Domain::Nonneg
                    | Domain::Positive
                    | Domain::LastNonzero
                    | Domain::LastNonneg
                    | Domain::LastPositive
                    | Domain::Unit
                    | Domain::UnitInside
                    | Domain::FromOne
                    | Domain::CosineNonzero
                    | Domain::AnyNonzero => false,
                }
            }
        };
        total.push(is_total);
    }
}

/// `node` where it is defined, else the number `outside`. A node that is defined everywhere is
/// returned unchanged. `total` is as in [`extend_total`].
pub(crate) fn or_outside(
    graph: &mut Graph,
    total: &mut Vec<bool>,
    moves: &Moves,
    node: NodeId,
    outside: i64,
) -> NodeId {
    extend_total(graph, total, moves);
    if total[node.index()] {
        return node;
    }
    let outside = graph.integer(outside);
    graph.apply(Op::Otherwise, &[node, outside])
}

/// Purpose of a margin.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Purpose {
    /// The zeros of the margin are the face of a solid.
    Face,
    /// The sign of the margin decides where a value is defined, or which of two values is taken.
    Restriction,
}

/// The comparisons in a chain such as `a < b < c`, each with its two sides.
pub(crate) fn comparisons<'a>(
    first: &'a Expr,
    rest: &'a [(Relation, Expr)],
) -> impl Iterator<Item = (&'a Expr, Relation, &'a Expr)> {
    let left = std::iter::once(first).chain(rest.iter().map(|(_, side)| side));
    left.zip(rest).map(|(left, (relation, right))| (left, *relation, right))
}

/// The lower and the higher side of an inequality, and its strictness; `None` for `=` and `!=`.
pub(crate) fn sides<'a>(
    left: &'a Expr,
    relation: Relation,
    right: &'a Expr,
) -> Option<(&'a Expr, &'a Expr, bool)> {
    match relation {
        Relation::Less => Some((left, right, true)),
        Relation::LessEqual => Some((left, right, false)),
        Relation::Greater => Some((right, left, true)),
        Relation::GreaterEqual => Some((right, left, false)),
        Relation::Equal | Relation::Unequal => None,
    }
}

/// The operation that restricts to positive margins or, if not `strict`, to margins ≥ 0.
fn restriction(strict: bool) -> Op {
    if strict { Op::WherePositive } else { Op::WhereNonneg }
}

/// The strictness of each inequality in a condition or, if `negated`, in the opposite condition.
/// `None` if the condition contains `=` or `!=`.
fn strictness(condition: &Expr, negated: bool) -> Option<Vec<bool>> {
    match &condition.kind {
        ExprKind::And(items) | ExprKind::Or(items) => {
            let each: Option<Vec<_>> = items.iter().map(|item| strictness(item, negated)).collect();
            Some(each?.concat())
        }
        ExprKind::Not(inner) => strictness(inner, !negated),
        ExprKind::Compare(first, rest) => comparisons(first, rest)
            .map(|(left, relation, right)| Some(sides(left, relation, right)?.2 != negated))
            .collect(),
        _ => None,
    }
}

/// Returns whether a solid with these conditions holds the points at which its function is 0.
/// `None` if that differs between its inequalities.
pub(crate) fn holds_zeros<'a>(conditions: impl Iterator<Item = &'a Expr>) -> Option<bool> {
    fn all(condition: &Expr) -> Vec<bool> {
        match &condition.kind {
            // A condition with `!=` beside inequalities only removes points.
            ExprKind::And(items) => items.iter().flat_map(all).collect(),
            _ => strictness(condition, false).unwrap_or_default(),
        }
    }
    let strict: Vec<bool> = conditions.flat_map(all).collect();
    let first = *strict.first().unwrap_or(&false);
    strict.iter().all(|strict| *strict == first).then_some(!first)
}

/// Returns whether one margin can express a condition: all its inequalities are strict, or none is.
pub(crate) fn has_one_sign(condition: &Expr) -> bool {
    strictness(condition, false).is_some_and(|all| all.windows(2).all(|pair| pair[0] == pair[1]))
}
