//! Functions of one operand, choices and restrictions.

use super::form::{Condition, Factor, PartialExpr, Product};
use super::{Rewriter, numbers};
use crate::constant::{Constant, NamedConstant};
use crate::graph::{Node, NodeId};
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};
use zeroset_interval::Facts;
use zeroset_ops::{Class, Domain, Law, Op, Parity, Restriction};

impl Rewriter<'_> {
    /// Applies a function of one operand. A known value is computed. The sign of the operand's
    /// coefficient is dropped for an even function, and moved outside of an odd one.
    pub(super) fn function(&mut self, op: Op, operand: PartialExpr) -> PartialExpr {
        let Class::Function(law) = op.row().class else { unreachable!("{op:?} is no function") };
        let mut operand = self.product(operand);
        let conditions = std::mem::take(&mut operand.conditions);
        let number = operand.as_number().and_then(|number| numbers::function(op, law, number));
        let number = number.or_else(|| numbers::of_turns(op, &self.turns(&operand)?));
        if let Some(value) = number {
            return PartialExpr::Product(Product { conditions, ..Product::number(value) });
        }
        let mut outer = BigRational::one();
        if operand.coefficient.is_negative() {
            match op.row().parity {
                Parity::Even => operand.coefficient = -operand.coefficient,
                Parity::Odd => {
                    operand.coefficient = -operand.coefficient;
                    outer = -outer;
                }
                Parity::Neither => {}
            }
        }
        if let Law::Magnitude | Law::Sign = law {
            // |c·a| = |c|·|a|, and sign(c·a) does not depend on |c|.
            let size = std::mem::replace(&mut operand.coefficient, BigRational::one());
            if law == Law::Magnitude {
                outer *= size;
            }
        }
        let argument = self.emit_product(&operand);
        let mut result = self.function_of(op, law, argument);
        result.conditions.extend(conditions);
        if let Some(coefficient) = numbers::moderate(&result.coefficient * &outer) {
            result.coefficient = coefficient;
            PartialExpr::Product(result)
        } else {
            let product = self.times(result, Product::number(outer));
            PartialExpr::Product(product)
        }
    }

    /// An angle in turns, if it is a rational multiple of π or of 2π.
    fn turns(&self, angle: &Product) -> Option<BigRational> {
        let &[Factor { base, exponent: 1, .. }] = angle.factors.as_slice() else { return None };
        match self.graph.number(base)? {
            Constant::Named(NamedConstant::Tau) => Some(angle.coefficient.clone()),
            Constant::Named(NamedConstant::Pi) => {
                Some(&angle.coefficient / BigRational::from_integer(2.into()))
            }
            Constant::Named(NamedConstant::E | NamedConstant::Phi)
            | Constant::Exact(_)
            | Constant::Enclosed(_) => None,
        }
    }

    /// Applies a function to a node, simplified by the function's `law`.
    fn function_of(&mut self, op: Op, law: Law, a: NodeId) -> Product {
        let range = self.range(a);
        match law {
            Law::Magnitude if range.lo >= 0.0 => return self.product_of_node(a),
            Law::Magnitude if range.hi <= 0.0 => {
                let product = self.product_of_node(a);
                return Product { coefficient: -product.coefficient, ..product };
            }
            Law::Magnitude if self.graph.operands(a, op).is_some() => return Product::power(a, 1),
            Law::Sign if !range.contains(0.0) => {
                let one = BigRational::one();
                let mut result = Product::number(if range.lo > 0.0 { one } else { -one });
                self.require(&mut result.conditions, Condition(Restriction::Defined, a));
                return result;
            }
            Law::SquareRoot => {
                if let Some(&[u]) = self.graph.operands(a, Op::Sqr) {
                    let magnitude = self.function(Op::Abs, PartialExpr::Node(u));
                    return self.product(magnitude);
                }
            }
            Law::CubeRoot => {
                let cube = self.products.get(a).filter(|p| p.coefficient.is_one()).cloned();
                if let Some(p) = cube
                    && let [factor] = p.factors[..]
                    && factor.exponent == 3
                {
                    return self.product_of_node(factor.base);
                }
            }
            Law::Undoes(inner) => {
                if let Some(&[u]) = self.graph.operands(a, inner)
                    && let Some(product) = self.within(inner.row().domain, u)
                {
                    return product;
                }
            }
            Law::Rounding(_) if self.is_whole(a) => return self.product_of_node(a),
            Law::Plain | Law::Magnitude | Law::Sign | Law::Rounding(_) | Law::Fraction => {}
        }
        Product::power(self.node(op, &[a]), 1)
    }

    /// The product for `u` restricted to `domain`. `None` for domains other than all and the
    /// positive reals.
    fn within(&mut self, domain: Domain, u: NodeId) -> Option<Product> {
        match domain {
            Domain::All => Some(self.product_of_node(u)),
            Domain::Positive => {
                let part = self.nonneg_part(u);
                let mut result = self.product_of_node(part);
                self.require(&mut result.conditions, Condition(Restriction::Positive, u));
                Some(result)
            }
            Domain::Nonneg
            | Domain::LastNonzero
            | Domain::LastNonneg
            | Domain::LastPositive
            | Domain::Unit
            | Domain::UnitInside
            | Domain::FromOne
            | Domain::CosineNonzero
            | Domain::AnyNonzero
            | Domain::Power => None,
        }
    }

    /// Returns whether node `a` is a rounding or a `sign`, whose results are integers.
    fn is_whole(&self, a: NodeId) -> bool {
        let is_integral =
            |op: &Op| matches!(op.row().class, Class::Function(Law::Rounding(_) | Law::Sign));
        matches!(self.graph.node(a), Node::Apply(op, _) if is_integral(op))
    }

    /// The remainder of `first` by `second`, computed if both are known numbers.
    pub(super) fn modulo(&mut self, first: PartialExpr, second: PartialExpr) -> PartialExpr {
        let first = self.product(first);
        let second = self.product(second);
        if let (Some(a), Some(b)) = (first.as_number(), second.as_number())
            && !b.is_zero()
            && let Some(value) = numbers::moderate(a - b * (a / b).floor())
        {
            return PartialExpr::Product(Product::number(value));
        }
        let a = self.node_of(PartialExpr::Product(first));
        let b = self.node_of(PartialExpr::Product(second));
        PartialExpr::Node(self.node(Op::Mod, &[a, b]))
    }

    /// The simplified `op(a, b)` for min or max.
    pub(super) fn extremum(
        &mut self,
        op: Op,
        first: PartialExpr,
        second: PartialExpr,
    ) -> PartialExpr {
        let smallest = op == Op::Min;
        let first = self.product(first);
        let second = self.product(second);
        if let (Some(a), Some(b)) = (first.as_number(), second.as_number()) {
            let value = if smallest { a.min(b) } else { a.max(b) };
            return PartialExpr::Product(Product::number(value.clone()));
        }
        let mut a = self.node_of(PartialExpr::Product(first));
        let mut b = self.node_of(PartialExpr::Product(second));
        if a > b {
            std::mem::swap(&mut a, &mut b);
        }
        if a == b {
            return PartialExpr::Node(a);
        }
        let (low, high) = (self.range(a), self.range(b));
        let below = low.hi <= high.lo;
        if below || high.hi <= low.lo {
            let (chosen, other) = if below == smallest { (a, b) } else { (b, a) };
            let mut result = self.product_of_node(chosen);
            self.require(&mut result.conditions, Condition(Restriction::Defined, other));
            return PartialExpr::Product(result);
        }
        PartialExpr::Node(self.node(op, &[a, b]))
    }

    /// The simplified `select_negative(a, b, c)`. Each branch keeps its own conditions.
    pub(super) fn choice(
        &mut self,
        first: PartialExpr,
        second: PartialExpr,
        third: PartialExpr,
    ) -> PartialExpr {
        let mut condition = self.product(first);
        let sign = condition.coefficient.signum();
        let conditions = std::mem::take(&mut condition.conditions);
        condition.coefficient = sign;
        let a = self.emit_product(&condition);
        let b = self.node_of(second);
        let c = self.node_of(third);
        let range = self.range(a);
        let chosen = if range.hi < 0.0 || b == c {
            b
        } else if range.lo >= 0.0 {
            c
        } else {
            let node = self.node(Op::SelectNegative, &[a, b, c]);
            return PartialExpr::Product(Product { conditions, ..Product::power(node, 1) });
        };
        let mut result = self.product_of_node(chosen);
        result.conditions.extend(conditions);
        self.require(&mut result.conditions, Condition(Restriction::Defined, a));
        PartialExpr::Product(result)
    }

    /// The simplified `otherwise(a, b)`. The conditions of `a` stay inside `a`, because they decide
    /// which operand is the result.
    pub(super) fn fallback(&mut self, first: PartialExpr, second: PartialExpr) -> PartialExpr {
        let a = self.node_of(first);
        let b = self.node_of(second);
        let facts = self.known(a).facts;
        if facts.has(Facts::DEFINED) {
            PartialExpr::Node(a)
        } else if facts.has(Facts::NOWHERE) {
            PartialExpr::Node(b)
        } else {
            PartialExpr::Node(self.node(Op::Otherwise, &[a, b]))
        }
    }

    /// The first operand, restricted to points at which the second operand meets the restriction.
    pub(super) fn restriction(
        &mut self,
        restriction: Restriction,
        first: PartialExpr,
        second: PartialExpr,
    ) -> PartialExpr {
        let mut other = self.product(second);
        let mut result = self.product(first);
        result.conditions.append(&mut other.conditions);
        // A positive factor of the second operand does not change the condition.
        other.coefficient = other.coefficient.signum();
        let node = self.emit_product(&other);
        self.require(&mut result.conditions, Condition(restriction, node));
        PartialExpr::Product(result)
    }
}
