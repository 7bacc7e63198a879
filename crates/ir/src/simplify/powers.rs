//! Powers: integer exponents join products, and half-integer exponents become square roots.

use super::form::{Condition, PartialExpr, Product};
use super::{Rewriter, numbers};
use crate::graph::NodeId;
use crate::variability::Variability;
use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive};
use zeroset_ops::{Op, Restriction};

impl Rewriter<'_> {
    /// The simplified power with an integer exponent.
    pub(super) fn integer_power(&mut self, base: PartialExpr, n: i64) -> PartialExpr {
        let base = self.product(base);
        if n == 0 {
            let mut conditions = base.conditions;
            for factor in &base.factors {
                self.require(&mut conditions, factor.condition());
            }
            return PartialExpr::Product(Product {
                conditions,
                ..Product::number(BigRational::one())
            });
        }
        if let Some(power) = base.raised(n) {
            return PartialExpr::Product(self.merge_factors(power));
        }
        let base = self.node_of(PartialExpr::Product(base));
        let exponent = self.number(BigRational::from_integer(n.into()));
        let op = if n == 2 { Op::Sqr } else { Op::Pow };
        let operands = [base, exponent];
        PartialExpr::Node(self.node(op, &operands[..op.arity()]))
    }

    /// The simplified `base^exponent`. `fixed` means that the exponent was written without
    /// coordinates and parameters.
    pub(super) fn power(
        &mut self,
        base: PartialExpr,
        exponent: PartialExpr,
        fixed: bool,
    ) -> PartialExpr {
        let exponent = self.product(exponent);
        if !exponent.factors.is_empty() {
            let exponent = self.node_of(PartialExpr::Product(exponent));
            let base = self.product(base);
            if base.as_number().is_some_and(One::is_one) {
                let mut one = base;
                self.require(&mut one.conditions, Condition(Restriction::Defined, exponent));
                return PartialExpr::Product(one);
            }
            let base = self.node_of(PartialExpr::Product(base));
            let power = PartialExpr::Node(self.node(Op::Pow, &[base, exponent]));
            if fixed || self.rank(exponent) != Variability::Constant {
                return power;
            }
            // An enclosed exponent that is an integer has a range of one number, so its sign is
            // known.
            return self.real_power(power, base, self.range(exponent).hi > 0.0);
        }
        let Product { coefficient: number, conditions, .. } = exponent;
        if fixed && conditions.is_empty() {
            return self.exact_power(base, &number);
        }
        let base = self.node_of(base);
        let product = self.product(PartialExpr::Node(base));
        let power = self.exact_power(PartialExpr::Product(product), &number);
        let mut result = self.product(power);
        result.conditions.extend(conditions);
        self.real_power(PartialExpr::Product(result), base, number.is_positive())
    }

    /// Restricts a power whose exponent is constant only because a variable in it cancels. Such an
    /// exponent counts as real, even if it is an integer: the power is undefined for negative
    /// bases.
    fn real_power(&mut self, power: PartialExpr, base: NodeId, positive: bool) -> PartialExpr {
        let mut result = self.product(power);
        let bound = if positive { Restriction::Nonneg } else { Restriction::Positive };
        self.require(&mut result.conditions, Condition(bound, base));
        PartialExpr::Product(result)
    }

    /// The simplified power with a rational exponent.
    fn exact_power(&mut self, base: PartialExpr, exponent: &BigRational) -> PartialExpr {
        if let Some(n) = exponent.is_integer().then(|| exponent.numer().to_i64()).flatten() {
            return self.integer_power(base, n);
        }
        if exponent.denom().to_u32() == Some(2)
            && let Some(n) = exponent.numer().to_i64()
        {
            // `a^(n/2) = (√a)^n`, with the same domain: a ≥ 0, or a > 0 if n < 0.
            let root = self.function(Op::Sqrt, base);
            return self.integer_power(root, n);
        }
        let base = self.product(base);
        if let Some(value) = base.as_number()
            && let (Some(n), Some(degree)) = (exponent.numer().to_i64(), exponent.denom().to_u32())
            && degree == 3
            && !value.is_negative()
            && let Some(root) = numbers::root(value, degree)
            && let Some(power) = numbers::power(&root, n)
        {
            return PartialExpr::Product(Product::number(power));
        }
        let base = self.node_of(PartialExpr::Product(base));
        let exponent = self.number(exponent.clone());
        debug_assert_eq!(self.rank(exponent), Variability::Constant);
        PartialExpr::Node(self.node(Op::Pow, &[base, exponent]))
    }
}
