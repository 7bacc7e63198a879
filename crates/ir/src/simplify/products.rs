//! Collecting and emitting products: `c · Π baseᵢ^nᵢ`.

use super::form::{Condition, Factor, PartialExpr, Product};
use super::{Rewriter, numbers};
use crate::graph::{Node, NodeId};
use crate::variability::Variability;
use num_integer::gcd;
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};
use zeroset_ops::{Class, Op, Restriction};

/// Largest number of factors of a product that is stored with its node. A longer product becomes a
/// single factor of later products. Its bases are not merged with theirs.
const REMEMBERED_FACTORS: usize = 8;
/// Largest number of restrictions that are lifted out of an operand. Further ones stay inside it.
const LIFTED_CONDITIONS: usize = 16;

impl Rewriter<'_> {
    /// Converts `value` to a product with distinct bases.
    pub(super) fn product(&mut self, value: PartialExpr) -> Product {
        match value {
            PartialExpr::Product(product) if product.is_unmerged => self.merge_factors(product),
            PartialExpr::Product(product) => product,
            PartialExpr::Sum(sum) => self.normalize_sum(sum),
            PartialExpr::Node(id) => self.product_of_node(id),
        }
    }

    /// Converts a node to a product of one factor, or to a number. Restrictions around the node
    /// become conditions.
    pub(super) fn product_of_node(&self, mut id: NodeId) -> Product {
        let mut conditions = Vec::new();
        while conditions.len() < LIFTED_CONDITIONS
            && let Node::Apply(op, operands) = self.graph.node(id)
        {
            let Class::Restriction(restriction) = op.row().class else { break };
            conditions.push(Condition(restriction, operands[1]));
            id = operands[0];
        }
        if let Some(number) = self.graph.exact(id) {
            return Product { conditions, ..Product::number(number.clone()) };
        }
        // A node that is a product of several factors stays one factor, so that the node stays
        // shared. A power is split into base and exponent.
        let power = self.products.get(id).filter(|product| product.factors.len() == 1);
        let power = power.cloned().unwrap_or_else(|| Product::power(id, 1));
        Product { conditions, ..power }
    }

    /// The product of `a` and `b`. Equal bases are merged unless there are too many factors.
    pub(super) fn times(&mut self, mut a: Product, mut b: Product) -> Product {
        if a.factors.len() < b.factors.len() {
            std::mem::swap(&mut a, &mut b);
        }
        if let Some(coefficient) = numbers::moderate(&a.coefficient * &b.coefficient) {
            a.coefficient = coefficient;
        } else {
            let base = self.number(b.coefficient);
            a.factors.push(Factor { base, exponent: 1, nonzero: false });
        }
        a.factors.append(&mut b.factors);
        a.conditions.append(&mut b.conditions);
        if a.factors.len() > REMEMBERED_FACTORS {
            a.is_unmerged = true;
            return a;
        }
        self.merge_factors(a)
    }

    /// Converts `value` to a product. Equal bases may still have to be merged.
    pub(super) fn unmerged_product(&mut self, value: PartialExpr) -> Product {
        match value {
            PartialExpr::Product(product) => product,
            PartialExpr::Sum(_) | PartialExpr::Node(_) => self.product(value),
        }
    }

    /// The simplified `a / b`. It stays a quotient if `b` is 0 or `1 / b` is too large.
    pub(super) fn quotient(&mut self, a: PartialExpr, b: PartialExpr) -> PartialExpr {
        let a = self.unmerged_product(a);
        let b = self.product(b);
        if let Some(inverse) = b.raised(-1) {
            return PartialExpr::Product(self.times(a, inverse));
        }
        let a = self.node_of(PartialExpr::Product(a));
        let b = self.node_of(PartialExpr::Product(b));
        PartialExpr::Node(self.node(Op::Div, &[a, b]))
    }

    /// Merges equal bases and drops factors that do not affect the value. Added conditions keep the
    /// domain of definition.
    pub(super) fn merge_factors(&mut self, mut p: Product) -> Product {
        p.is_unmerged = false;
        loop {
            Self::merge(&mut p);
            if !self.apply_power_laws(&mut p) {
                break;
            }
        }
        let vanished = p.coefficient.is_zero();
        let Product { factors, conditions, .. } = &mut p;
        factors.retain(|factor| {
            if factor.exponent != 0 && !vanished {
                return true;
            }
            self.require(conditions, factor.condition());
            false
        });
        for factor in factors.iter_mut().filter(|f| f.nonzero && f.exponent > 0) {
            if self.range(factor.base).contains(0.0) {
                conditions.push(Condition(Restriction::Nonzero, factor.base));
            }
            factor.nonzero = false;
        }
        p
    }

    /// Merges factors with equal bases by adding their exponents.
    fn merge(p: &mut Product) {
        p.factors.sort_unstable();
        let mut merged: Vec<Factor> = Vec::with_capacity(p.factors.len());
        for factor in p.factors.drain(..) {
            match merged.last_mut() {
                Some(last) if last.base == factor.base => {
                    last.nonzero |= factor.nonzero || last.exponent < 0 || factor.exponent < 0;
                    last.exponent += factor.exponent; // both far below 2^62
                }
                Some(_) | None => merged.push(factor),
            }
        }
        p.factors = merged;
    }

    /// Applies the laws `|u|^2k = u^2k`, `(√u)^2k = u^k` for u ≥ 0, and `(∛u)^3k = u^k` to the
    /// factors. Returns whether anything changed.
    fn apply_power_laws(&mut self, p: &mut Product) -> bool {
        let mut changed = false;
        for factor in p.factors.iter_mut().filter(|factor| factor.exponent != 0) {
            if factor.exponent % 2 == 0 {
                if let Some(&[u]) = self.graph.operands(factor.base, Op::Abs) {
                    factor.base = u;
                    changed = true;
                } else if let Some(&[u]) = self.graph.operands(factor.base, Op::Sqrt) {
                    self.require(&mut p.conditions, Condition(Restriction::Nonneg, u));
                    factor.base = self.nonneg_part(u);
                    factor.exponent /= 2;
                    changed = true;
                }
            }
            if factor.exponent % 3 == 0
                && let Some(&[u]) = self.graph.operands(factor.base, Op::Cbrt)
            {
                factor.base = u;
                factor.exponent /= 3;
                changed = true;
            }
        }
        // A law may have replaced a base by a number. That number joins the coefficient.
        let mut opened = Vec::new();
        for factor in std::mem::take(&mut p.factors) {
            let number =
                self.graph.exact(factor.base).and_then(|n| numbers::power(n, factor.exponent));
            match number.and_then(|n| numbers::moderate(n * &p.coefficient)) {
                Some(number) if !factor.nonzero || !self.range(factor.base).contains(0.0) => {
                    p.coefficient = number;
                    changed = true;
                }
                Some(_) | None => opened.push(factor),
            }
        }
        p.factors = opened;
        changed
    }

    /// The node of `max(u, 0)`, or `u` itself if its range shows u ≥ 0. A condition u ≥ 0 would not
    /// make the enclosure narrower; the maximum does.
    pub(super) fn nonneg_part(&mut self, u: NodeId) -> NodeId {
        if self.range(u).lo >= 0.0 {
            return u;
        }
        let zero = self.number(BigRational::zero());
        self.node(Op::Max, &[u.min(zero), u.max(zero)])
    }

    /// Adds the node of a product whose equal bases are merged, without its conditions.
    pub(super) fn emit_product(&mut self, p: &Product) -> NodeId {
        if p.factors.is_empty() {
            return self.number(p.coefficient.clone());
        }
        if let [Factor { base, exponent: 1, .. }] = p.factors[..] {
            if p.coefficient.is_one() {
                return base;
            }
            if p.coefficient.abs().is_one()
                && let Some((constant, terms)) = self.sums.get(base).cloned()
            {
                // The negative of a sum is the sum of negated terms (saves 7 operations over the
                // gallery).
                let terms: Vec<_> = terms.into_iter().map(|(term, c)| (term, -c)).collect();
                return self.emit_sum(&-constant, &terms);
            }
        }
        let node = self.emit_factors(p);
        if p.factors.len() <= REMEMBERED_FACTORS {
            let remembered = if p.coefficient.is_one() || p.factors.len() == 1 {
                p.clone()
            } else {
                let monic = Product { coefficient: BigRational::one(), ..p.clone() };
                let base = self.emit_product(&monic);
                Product { coefficient: p.coefficient.clone(), ..Product::power(base, 1) }
            };
            let conditions = Vec::new();
            self.products.insert_new(node, || Product { conditions, ..remembered });
        }
        node
    }

    /// Creates the node of a product without its conditions. Factors that do not vary become one
    /// operand with the coefficient.
    fn emit_factors(&mut self, p: &Product) -> NodeId {
        let mut uniform = [None, None]; // numerator, denominator
        let mut varying = [Vec::new(), Vec::new()];
        for rank in [Variability::Constant, Variability::Uniform] {
            for factor in &p.factors {
                if self.rank(factor.base) == rank {
                    let side = usize::from(factor.exponent < 0);
                    let power = self.emit_power(factor.base, factor.exponent.unsigned_abs());
                    uniform[side] = Some(self.multiply(uniform[side], power));
                }
            }
        }
        for factor in &p.factors {
            if self.rank(factor.base) == Variability::Varying {
                let side = usize::from(factor.exponent < 0);
                varying[side].push((factor.base, factor.exponent.unsigned_abs()));
            }
        }
        // The coefficient and the numerator's factors that do not vary become one operand.
        let unit = p.coefficient.abs().is_one();
        let mut fixed = if unit { None } else { Some(self.number(p.coefficient.clone())) };
        if let Some(above) = uniform[0] {
            fixed = Some(self.multiply(fixed, above));
        }
        if let Some(below) = uniform[1] {
            fixed = Some(self.divide(fixed, below));
        }
        let above = self.emit_powers(&varying[0]);
        let below = self.emit_powers(&varying[1]);
        let mut node = match (fixed, above) {
            (Some(fixed), Some(above)) => Some(self.node(Op::Mul, &[fixed, above])),
            (one, other) => one.or(other),
        };
        if let Some(below) = below {
            node = Some(self.divide(node, below));
        }
        let node = node.unwrap_or_else(|| self.number(BigRational::one()));
        if unit && p.coefficient.is_negative() { self.node(Op::Neg, &[node]) } else { node }
    }

    fn multiply(&mut self, a: Option<NodeId>, b: NodeId) -> NodeId {
        match a {
            Some(a) => self.node(Op::Mul, &[a, b]),
            None => b,
        }
    }

    fn divide(&mut self, a: Option<NodeId>, b: NodeId) -> NodeId {
        let above = a.unwrap_or_else(|| self.number(BigRational::one()));
        self.node(Op::Div, &[above, b])
    }

    /// Adds the node `Π baseᵢ^nᵢ`. Prefers `(xy)²` to `x²y²`, unless both squares exist already:
    /// the first form is shorter, and its enclosure as tight (saves 4 operations over the gallery).
    fn emit_powers(&mut self, powers: &[(NodeId, u64)]) -> Option<NodeId> {
        let common = powers.iter().fold(0, |common, (_, n)| gcd(common, *n));
        let shared = powers.iter().all(|(base, n)| self.has_power(*base, *n));
        if powers.len() > 1 && common > 1 && !shared {
            let reduced: Vec<_> = powers.iter().map(|(base, n)| (*base, n / common)).collect();
            let base = self.emit_powers(&reduced)?;
            return Some(self.emit_power(base, common));
        }
        let mut product = None;
        for (base, exponent) in powers {
            let power = self.emit_power(*base, *exponent);
            product = Some(self.multiply(product, power));
        }
        product
    }

    /// Adds `base^exponent` as repeated squares of an odd power, because the enclosure of a square
    /// is exact.
    fn emit_power(&mut self, base: NodeId, exponent: u64) -> NodeId {
        let (squarings, odd) = split_exponent(exponent);
        let mut node = base;
        if odd != 1 {
            let odd = self.number(BigRational::from_integer(odd.into()));
            node = self.node(Op::Pow, &[base, odd]);
        }
        for _ in 0..squarings {
            node = self.node(Op::Sqr, &[node]);
        }
        if node != base {
            self.products.insert_new(node, || Product::power(base, exponent as i64));
        }
        node
    }

    /// Returns whether the graph has a node for this power. False if the exponent is not a power of
    /// two.
    fn has_power(&self, base: NodeId, exponent: u64) -> bool {
        let (squarings, odd) = split_exponent(exponent);
        if odd != 1 {
            return false;
        }
        let mut node = Some(base);
        for _ in 0..squarings {
            node = node.and_then(|node| self.graph.find(Op::Sqr, &[node]));
        }
        node.is_some()
    }
}

/// Returns s and m such that `exponent = 2^s · m` and m is odd.
fn split_exponent(exponent: u64) -> (u32, u64) {
    let squarings = exponent.trailing_zeros();
    (squarings, exponent >> squarings)
}
