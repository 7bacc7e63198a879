//! Conditions: solids and the sets that equations are restricted to.
//!
//! A point at which a side of a comparison has no value meets neither that comparison nor its opposite: there it is
//! outside, and the rest of the condition still counts.

use crate::ast::{Expr, ExprKind, Relation};
use crate::error::{Error, ErrorKind, Fallible};
use crate::lower::Lowering;
use zeroset_ir::{Node, NodeId};
use zeroset_ops::{Domain, Op};

impl<'a> Lowering<'a> {
    /// The function that is ≤ 0 inside the solid that a condition describes, or with `negated` its opposite, and above 0
    /// elsewhere; defined everywhere.
    pub(crate) fn solid(&mut self, expr: &'a Expr, negated: bool) -> Fallible<NodeId> {
        match &expr.kind {
            ExprKind::And(items) | ExprKind::Or(items) => {
                let is_and = matches!(expr.kind, ExprKind::And(_));
                let op = if is_and == negated { Op::Min } else { Op::Max };
                let solids: Fallible<Vec<NodeId>> =
                    items.iter().map(|item| self.solid(item, negated)).collect();
                Ok(self.fold(op, &solids?))
            }
            ExprKind::Not(inner) => self.solid(inner, !negated),
            ExprKind::Compare(first, rest) => {
                let mut left: &Expr = first;
                let mut all = Vec::new();
                for (relation, right) in rest {
                    let span = left.span.to(right.span);
                    let less = match relation {
                        Relation::Less | Relation::LessEqual => true,
                        Relation::Greater | Relation::GreaterEqual => false,
                        Relation::Equal => {
                            return Err(Error::new(span, ErrorKind::EquationInCondition));
                        }
                        Relation::Unequal => {
                            return Err(Error::new(span, ErrorKind::UnequalOutsideBraces));
                        }
                    };
                    let one = if less == negated {
                        self.difference(right, left)?
                    } else {
                        self.difference(left, right)?
                    };
                    all.push(self.otherwise_outside(one, 1));
                    left = right;
                }
                Ok(self.fold(if negated { Op::Min } else { Op::Max }, &all))
            }
            _ => Err(Error::new(expr.span, ErrorKind::ValueAsCondition { word: "and".to_owned() })),
        }
    }

    /// `node` where it is defined, else a number that means outside; `node` alone if it cannot be undefined.
    fn otherwise_outside(&mut self, node: NodeId, outside: i64) -> NodeId {
        for (_, node) in self.graph.since(self.total.len()) {
            let total = match node {
                Node::Variable(_) | Node::Parameter(_) | Node::Constant(_) => true,
                Node::Apply(op, operands) => {
                    let each = operands.iter().all(|operand| self.total[operand.index()]);
                    each && match op.row().domain {
                        Domain::All => true,
                        Domain::Power => match self.graph.node(operands[1]) {
                            Node::Constant(exponent) => {
                                exponent.as_integer().is_some_and(|n| n >= 0)
                            }
                            Node::Variable(_) | Node::Parameter(_) | Node::Apply(..) => false,
                        },
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
            self.total.push(total);
        }
        if self.total[node.index()] {
            return node;
        }
        let outside = self.graph.integer(outside);
        self.graph.apply(Op::Otherwise, &[node, outside])
    }

    /// `root`, defined only where `condition` holds.
    pub(crate) fn restrict(&mut self, root: NodeId, condition: &'a Expr) -> Fallible<NodeId> {
        match &condition.kind {
            ExprKind::And(items) => {
                items.iter().try_fold(root, |root, item| self.restrict(root, item))
            }
            ExprKind::Compare(first, rest) => {
                let mut left: &Expr = first;
                let mut root = root;
                for (relation, right) in rest {
                    let span = left.span.to(right.span);
                    let (op, bound) = match relation {
                        Relation::Less => (Op::WherePositive, self.difference(right, left)?),
                        Relation::LessEqual => (Op::WhereNonneg, self.difference(right, left)?),
                        Relation::Greater => (Op::WherePositive, self.difference(left, right)?),
                        Relation::GreaterEqual => (Op::WhereNonneg, self.difference(left, right)?),
                        Relation::Unequal => (Op::WhereNonzero, self.difference(left, right)?),
                        Relation::Equal => {
                            return Err(Error::new(span, ErrorKind::RestrictionIsEquation));
                        }
                    };
                    root = self.graph.apply(op, &[root, bound]);
                    left = right;
                }
                Ok(root)
            }
            ExprKind::Or(_) | ExprKind::Not(_) => {
                let (bound, strict) = self.margin(condition, false)?;
                let op = if strict == Some(true) { Op::WherePositive } else { Op::WhereNonneg };
                Ok(self.graph.apply(op, &[root, bound]))
            }
            _ => Err(Error::new(condition.span, ErrorKind::RestrictionNotCondition)),
        }
    }

    /// The solid `root` where `condition` holds as well, so that the cut is a face of it. A cut that has no inside
    /// (`!=`) only takes points away.
    pub(crate) fn cut(&mut self, root: NodeId, condition: &'a Expr) -> Fallible<NodeId> {
        match &condition.kind {
            ExprKind::And(items) => items.iter().try_fold(root, |root, item| self.cut(root, item)),
            _ if bounds_a_solid(condition) => {
                let other = self.solid(condition, false)?;
                Ok(self.graph.apply(Op::Max, &[root, other]))
            }
            _ => self.restrict(root, condition),
        }
    }

    /// A function that is positive (strict) or nonnegative (not strict) just where `condition`, or with `negated`
    /// its opposite, holds.
    fn margin(&mut self, condition: &'a Expr, negated: bool) -> Fallible<(NodeId, Option<bool>)> {
        let (items, op): (Vec<(NodeId, Option<bool>)>, Op) = match &condition.kind {
            ExprKind::Not(inner) => return self.margin(inner, !negated),
            ExprKind::And(items) | ExprKind::Or(items) => {
                let is_and = matches!(condition.kind, ExprKind::And(_));
                let op = if is_and == negated { Op::Max } else { Op::Min };
                let parts: Fallible<Vec<_>> =
                    items.iter().map(|item| self.margin(item, negated)).collect();
                (parts?, op)
            }
            ExprKind::Compare(first, rest) => {
                let mut left: &Expr = first;
                let mut parts = Vec::new();
                for (relation, right) in rest {
                    let span = left.span.to(right.span);
                    let (less, strict) = match relation {
                        Relation::Less => (true, true),
                        Relation::LessEqual => (true, false),
                        Relation::Greater => (false, true),
                        Relation::GreaterEqual => (false, false),
                        Relation::Equal => {
                            return Err(Error::new(span, ErrorKind::RestrictionIsEquation));
                        }
                        Relation::Unequal => {
                            return Err(Error::new(span, ErrorKind::MixedRestriction));
                        }
                    };
                    let node = if less == negated {
                        self.difference(left, right)?
                    } else {
                        self.difference(right, left)?
                    };
                    let node = self.otherwise_outside(node, -1);
                    parts.push((node, Some(strict != negated)));
                    left = right;
                }
                (parts, if negated { Op::Max } else { Op::Min })
            }
            _ => {
                return Err(Error::new(condition.span, ErrorKind::RestrictionNotCondition));
            }
        };
        let strict = items[0].1;
        if items.iter().any(|(_, other)| *other != strict) {
            return Err(Error::new(condition.span, ErrorKind::MixedRestriction));
        }
        let nodes: Vec<NodeId> = items.into_iter().map(|(node, _)| node).collect();
        Ok((self.fold(op, &nodes), strict))
    }
}

/// Whether a condition is made of inequalities only.
fn bounds_a_solid(condition: &Expr) -> bool {
    match &condition.kind {
        ExprKind::And(items) | ExprKind::Or(items) => items.iter().all(bounds_a_solid),
        ExprKind::Not(inner) => bounds_a_solid(inner),
        ExprKind::Compare(_, rest) => {
            rest.iter().all(|(sign, _)| !matches!(sign, Relation::Equal | Relation::Unequal))
        }
        _ => false,
    }
}
