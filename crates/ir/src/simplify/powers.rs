//! Powers: integer exponents join products, halves become square roots.

use super::Rewriter;
use super::numbers;
use super::ranges::Rank;
use super::value::{Condition, Factor, Product, Value};
use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive};
use zeroset_ops::Op;

impl Rewriter<'_> {
    /// `base^n`
    pub(super) fn integer_power(&mut self, base: Value, n: i64) -> Value {
        let base = self.product(base);
        if n == 0 {
            let mut conditions = base.conditions;
            for factor in &base.factors {
                self.require(&mut conditions, condition_of(factor));
            }
            return Value::Product(Product { conditions, ..Product::number(BigRational::one()) });
        }
        if let Some(power) = base.raised(n) {
            return Value::Product(self.settle(power));
        }
        let base = self.node_of(Value::Product(base));
        let exponent = self.number(BigRational::from_integer(n.into()));
        let op = if n == 2 { Op::Sqr } else { Op::Pow };
        let operands = [base, exponent];
        Value::Node(self.node(op, &operands[..op.arity()]))
    }

    /// `base^exponent`; `fixed` tells whether the exponent was written without coordinates and parameters.
    pub(super) fn power(&mut self, base: Value, exponent: Value, fixed: bool) -> Value {
        let exponent = self.product(exponent);
        let number = exponent.factors.is_empty().then(|| exponent.coefficient.clone());
        let conditions = exponent.conditions.clone();
        let Some(number) = number else {
            let exponent = self.node_of(Value::Product(exponent));
            let base = self.product(base);
            if base.as_number().is_some_and(One::is_one) {
                let mut one = base;
                self.require(&mut one.conditions, Condition::Defined(exponent));
                return Value::Product(one);
            }
            let base = self.node_of(Value::Product(base));
            return Value::Node(self.node(Op::Pow, &[base, exponent]));
        };
        if fixed && conditions.is_empty() {
            return self.exact_power(base, &number);
        }
        // Such an exponent was written with a variable that cancels. It counts as a real number, so negative
        // bases stay outside the domain even where its value is an integer.
        let base = self.node_of(base);
        let mut result = self.product(Value::Node(base));
        let power = self.exact_power(Value::Product(result), &number);
        result = self.product(power);
        result.conditions.extend(conditions);
        let positive = number.is_positive();
        let bound = if positive { Condition::Nonneg(base) } else { Condition::Positive(base) };
        self.require(&mut result.conditions, bound);
        Value::Product(result)
    }

    fn exact_power(&mut self, base: Value, exponent: &BigRational) -> Value {
        if let Some(n) = exponent.is_integer().then(|| exponent.numer().to_i64()).flatten() {
            return self.integer_power(base, n);
        }
        if exponent.denom().to_u32() == Some(2)
            && let Some(n) = exponent.numer().to_i64()
        {
            // `a^(n/2) = √a^n`, with the same domain: a ≥ 0, or a > 0 for n < 0.
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
            return Value::Product(Product::number(power));
        }
        let base = self.node_of(Value::Product(base));
        let exponent = self.number(exponent.clone());
        debug_assert_eq!(self.known(exponent).rank, Rank::Constant);
        Value::Node(self.node(Op::Pow, &[base, exponent]))
    }
}

/// Where a factor is defined.
pub(super) fn condition_of(factor: &Factor) -> Condition {
    if factor.nonzero || factor.exponent < 0 {
        Condition::Nonzero(factor.base)
    } else {
        Condition::Defined(factor.base)
    }
}
