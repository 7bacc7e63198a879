//! Polynomials in several variables with exact coefficients, and their greatest common divisors.
//!
//! The variables are nodes: coordinates, parameters, and all expressions that are no sums or
//! products. Equal nodes are equal numbers, so an identity of polynomials holds wherever these
//! expressions are defined.
//!
//! The polynomials are small, so the algorithms are plain: division with respect to one variable,
//! and Euclid's algorithm with primitive remainders (Knuth, The Art of Computer Programming 2,
//! section 4.6.1). All work is limited. A result that would take more work counts as unknown.

use crate::algebra::{add, mul, neg, powi};
use crate::constant::{Constant, bits};
use crate::coprime::are_coprime;
use crate::graph::{Graph, Node, NodeId};
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};
use std::collections::{BTreeMap, BTreeSet, HashMap};
use zeroset_ops::{Class, Domain, Op};

/// Largest number of terms of a polynomial.
const TERM_LIMIT: usize = 128;
/// Largest exponent of a power that is multiplied out.
const EXPONENT_LIMIT: u32 = 32;
/// Largest number of bits of a coefficient's numerator or denominator.
const BITS_LIMIT: u64 = 512;
/// If fewer products of terms may still be computed, no polynomials are compared.
const LEAST_WORK: u32 = 256;
/// Deepest nesting of sums and products that is multiplied out.
const DEPTH_LIMIT: usize = 64;

/// A product of powers: the exponent, above 0, of each variable.
type Monomial = BTreeMap<NodeId, u32>;

/// A sum of monomials. No coefficient is 0.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Polynomial(BTreeMap<Monomial, BigRational>);

/// The number of products of terms that may still be computed.
pub(crate) struct Work(pub u32);

impl Work {
    /// Returns whether too little is left for any comparison.
    pub fn is_spent(&self) -> bool {
        self.0 < LEAST_WORK
    }

    fn spend(&mut self, products: usize) -> Option<()> {
        self.0 = self.0.checked_sub(u32::try_from(products).ok()?)?;
        Some(())
    }
}

impl Polynomial {
    pub fn constant(value: BigRational) -> Self {
        if value.is_zero() {
            return Self::default();
        }
        Self(BTreeMap::from([(Monomial::new(), value)]))
    }

    pub fn variable(id: NodeId) -> Self {
        Self::power_of(id, 1)
    }

    fn power_of(id: NodeId, exponent: u32) -> Self {
        let monomial =
            if exponent == 0 { Monomial::new() } else { Monomial::from([(id, exponent)]) };
        Self(BTreeMap::from([(monomial, BigRational::one())]))
    }

    /// Node `id` as a polynomial. A part that is not a sum or product, or is too large, becomes a
    /// variable.
    pub fn of(graph: &Graph, id: NodeId, work: &mut Work) -> Self {
        Expansion { graph, known: HashMap::new(), work }.of(id, 0)
    }

    /// The parts of a node that are variables of its polynomial, or would be if their terms did not
    /// cancel.
    pub fn leaves(graph: &Graph, id: NodeId) -> BTreeSet<NodeId> {
        let (mut seen, mut leaves, mut open) = (BTreeSet::new(), BTreeSet::new(), vec![id]);
        while let Some(id) = open.pop() {
            let Node::Apply(op, operands) = graph.node(id) else { continue };
            let is_expanded = match op.row().class {
                Class::Negation | Class::Sum | Class::Product | Class::Square => true,
                Class::Power | Class::Quotient => is_total(graph, *op, operands),
                _ => false,
            };
            if !is_expanded {
                leaves.insert(id);
            } else if seen.insert(id) {
                open.extend(operands.iter());
            }
        }
        leaves
    }

    pub fn is_zero(&self) -> bool {
        self.0.is_empty()
    }

    /// The value of a polynomial without variables.
    pub fn as_constant(&self) -> Option<BigRational> {
        match self.0.iter().next() {
            None => Some(BigRational::zero()),
            Some((monomial, value)) => {
                (self.0.len() == 1 && monomial.is_empty()).then(|| value.clone())
            }
        }
    }

    pub fn variables(&self) -> BTreeSet<NodeId> {
        self.0.keys().flat_map(Monomial::keys).copied().collect()
    }

    /// The coefficient of `variable`, if the polynomial is linear in it and the coefficient is a
    /// number; otherwise `None`.
    pub fn linear_factor(&self, variable: NodeId) -> Option<BigRational> {
        let factor = self.leading(variable).as_constant();
        factor.filter(|_| self.degree(variable) == 1)
    }

    /// The degree in a variable.
    pub fn degree(&self, by: NodeId) -> u32 {
        self.0.keys().map(|monomial| monomial.get(&by).copied().unwrap_or(0)).max().unwrap_or(0)
    }

    /// The coefficient of `by^exponent`, a polynomial in the other variables.
    pub fn coefficient(&self, by: NodeId, exponent: u32) -> Self {
        let part = |(monomial, value): (&Monomial, &BigRational)| {
            let mut monomial = monomial.clone();
            let found = monomial.remove(&by).unwrap_or(0);
            (found == exponent).then(|| (monomial, value.clone()))
        };
        Self(self.0.iter().filter_map(part).collect())
    }

    /// The term without variables.
    pub fn constant_term(&self) -> BigRational {
        self.0.get(&Monomial::new()).cloned().unwrap_or_else(BigRational::zero)
    }

    /// The sum of the terms whose exponents add up to `degree`.
    pub fn part_of_degree(&self, degree: u32) -> Self {
        let terms = self.0.iter().filter(|(monomial, _)| monomial.values().sum::<u32>() == degree);
        Self(terms.map(|(monomial, value)| (monomial.clone(), value.clone())).collect())
    }

    /// The variables of each term with their exponents, and its coefficient.
    pub fn terms(
        &self,
    ) -> impl Iterator<Item = (impl Iterator<Item = (NodeId, u32)>, &BigRational)> {
        self.0.iter().map(|(powers, value)| (powers.iter().map(|(id, n)| (*id, *n)), value))
    }

    fn leading(&self, by: NodeId) -> Self {
        self.coefficient(by, self.degree(by))
    }

    /// The polynomial times a number.
    pub fn scaled(&self, factor: &BigRational) -> Self {
        if factor.is_zero() {
            return Self::default();
        }
        Self(self.0.iter().map(|(monomial, value)| (monomial.clone(), value * factor)).collect())
    }

    /// The coefficient of the last term in order, or 0 without a term.
    pub fn leading_coefficient(&self) -> BigRational {
        self.0.values().next_back().cloned().unwrap_or_else(BigRational::zero)
    }

    /// The same polynomial with 1 as the coefficient of some term.
    fn monic(&self) -> Self {
        if self.is_zero() {
            Self::default()
        } else {
            self.scaled(&self.leading_coefficient().recip())
        }
    }

    fn add_scaled(&mut self, other: &Self, factor: &BigRational) {
        for (monomial, value) in &other.0 {
            let sum = self.0.entry(monomial.clone()).or_insert_with(BigRational::zero);
            *sum += value * factor;
            if sum.is_zero() {
                self.0.remove(monomial);
            }
        }
    }

    pub fn plus(mut self, other: &Self) -> Self {
        self.add_scaled(other, &BigRational::one());
        self
    }

    pub fn minus(mut self, other: &Self) -> Self {
        self.add_scaled(other, &-BigRational::one());
        self
    }

    pub fn times(&self, other: &Self, work: &mut Work) -> Option<Self> {
        work.spend(self.0.len() * other.0.len())?;
        let mut product = Self::default();
        for (monomial, value) in &self.0 {
            let shifted = other.0.iter().map(|(other, factor)| {
                let mut joined = other.clone();
                for (variable, exponent) in monomial {
                    *joined.entry(*variable).or_insert(0) += exponent;
                }
                (joined, factor.clone())
            });
            product.add_scaled(&Self(shifted.collect()), value);
        }
        product.moderate()
    }

    fn moderate(self) -> Option<Self> {
        let small = self.0.len() <= TERM_LIMIT
            && self.0.iter().all(|(monomial, value)| {
                bits(value) <= BITS_LIMIT && monomial.values().all(|n| *n <= 4 * EXPONENT_LIMIT)
            });
        small.then_some(self)
    }

    pub fn raised(&self, exponent: u32, work: &mut Work) -> Option<Self> {
        if exponent > EXPONENT_LIMIT {
            return None;
        }
        let one = Self::constant(BigRational::one());
        (0..exponent).try_fold(one, |power, _| power.times(self, work))
    }

    /// The polynomial with `value` in place of a variable.
    pub fn substituted(&self, variable: NodeId, value: &Self, work: &mut Work) -> Option<Self> {
        let mut sum = Self::default();
        for exponent in (0..=self.degree(variable)).rev() {
            sum = sum.times(value, work)?.plus(&self.coefficient(variable, exponent));
        }
        Some(sum)
    }

    /// The quotient, or `None` if `by` is 0 or divides the polynomial with a remainder.
    pub fn divided(&self, by: &Self, work: &mut Work) -> Option<Self> {
        let Some(variable) = by.variables().pop_first() else {
            let value = by.as_constant().filter(|value| !value.is_zero())?;
            return Some(self.scaled(&value.recip()));
        };
        let (degree, leading) = (by.degree(variable), by.leading(variable));
        let (mut rest, mut quotient) = (self.clone(), Self::default());
        while !rest.is_zero() {
            let shift = rest.degree(variable).checked_sub(degree)?;
            let factor = rest.leading(variable).divided(&leading, work)?;
            let term = factor.times(&Self::power_of(variable, shift), work)?;
            rest = rest.minus(&term.times(by, work)?).moderate()?;
            quotient = quotient.plus(&term);
        }
        Some(quotient)
    }

    /// The greatest common divisor, up to a constant factor.
    pub fn gcd(&self, other: &Self, work: &mut Work) -> Option<Self> {
        if self.is_zero() || other.is_zero() {
            return Some(if self.is_zero() { other.monic() } else { self.monic() });
        }
        let (mine, theirs) = (self.variables(), other.variables());
        let Some(by) = mine.intersection(&theirs).next().copied() else {
            return Some(Self::constant(BigRational::one()));
        };
        if are_coprime(self, other) {
            return Some(Self::constant(BigRational::one()));
        }
        // A common divisor holds no variable that only one of the two has.
        if let Some(only) = mine.symmetric_difference(&theirs).next() {
            return self.content(*only, work)?.gcd(&other.content(*only, work)?, work);
        }
        let contents = [self.content(by, work)?, other.content(by, work)?];
        let common = contents[0].gcd(&contents[1], work)?;
        let mut high = self.divided(&contents[0], work)?;
        let mut low = other.divided(&contents[1], work)?;
        if high.degree(by) < low.degree(by) {
            std::mem::swap(&mut high, &mut low);
        }
        while low.degree(by) > 0 {
            let rest = high.remainder(&low, by, work)?;
            if rest.is_zero() {
                return Some(common.times(&low, work)?.monic());
            }
            let content = rest.content(by, work)?;
            high = low;
            low = rest.divided(&content, work)?.monic();
        }
        Some(common)
    }

    /// The greatest common divisor of the coefficients of all powers of `by`.
    fn content(&self, by: NodeId, work: &mut Work) -> Option<Self> {
        let mut content = Self::default();
        for exponent in 0..=self.degree(by) {
            content = content.gcd(&self.coefficient(by, exponent), work)?;
            if content.as_constant().is_some_and(|value| !value.is_zero()) {
                break;
            }
        }
        Some(content)
    }

    /// Multiplies the polynomial by a factor without `by`, then returns the remainder of dividing
    /// by `divisor`.
    fn remainder(&self, divisor: &Self, by: NodeId, work: &mut Work) -> Option<Self> {
        let (degree, leading) = (divisor.degree(by), divisor.leading(by));
        let mut rest = self.clone();
        while !rest.is_zero() && rest.degree(by) >= degree {
            let shift = Self::power_of(by, rest.degree(by) - degree);
            let term = rest.leading(by).times(&shift, work)?;
            let multiple = term.times(divisor, work)?;
            rest = rest.times(&leading, work)?.minus(&multiple).moderate()?;
        }
        Some(rest)
    }

    /// Adds the polynomial to the graph: powers that all terms share, times a sum of terms.
    pub fn emit(&self, graph: &mut Graph) -> NodeId {
        let mut shared: Option<Monomial> = None;
        for monomial in self.0.keys() {
            shared = Some(match shared {
                None => monomial.clone(),
                Some(shared) => {
                    let least = |(id, n): (NodeId, u32)| Some((id, n.min(*monomial.get(&id)?)));
                    shared.into_iter().filter_map(least).collect()
                }
            });
        }
        let shared = shared.unwrap_or_default();
        let mut sum = graph.integer(0);
        // Terms of high degree come first.
        for (monomial, value) in self.0.iter().rev() {
            let magnitude = graph.constant(Constant::rational(value.abs()));
            let rest = monomial.iter().map(|(id, n)| (*id, n - shared.get(id).unwrap_or(&0)));
            let power = product_of_powers(graph, rest);
            let term = mul(graph, magnitude, power);
            let term = if value.is_negative() { neg(graph, term) } else { term };
            sum = add(graph, sum, term);
        }
        let powers = product_of_powers(graph, shared.into_iter());
        mul(graph, powers, sum)
    }
}

/// Returns whether an operation has a value for all values of the operands that are not constant.
pub(crate) fn is_total(graph: &Graph, op: Op, operands: &[NodeId]) -> bool {
    let last = operands.last().and_then(|id| graph.exact(*id));
    match op.row().class {
        Class::Quotient => last.is_some_and(|value| !value.is_zero()),
        Class::Power => last.is_some_and(|value| value.is_integer() && !value.is_negative()),
        _ => op.row().domain == Domain::All,
    }
}

fn product_of_powers(graph: &mut Graph, powers: impl Iterator<Item = (NodeId, u32)>) -> NodeId {
    let mut product = graph.integer(1);
    for (id, exponent) in powers.filter(|(_, exponent)| *exponent > 0) {
        let power = powi(graph, id, i64::from(exponent));
        product = mul(graph, product, power);
    }
    product
}

/// Conversion of nodes to polynomials.
struct Expansion<'a> {
    graph: &'a Graph,
    known: HashMap<NodeId, Polynomial>,
    work: &'a mut Work,
}

impl Expansion<'_> {
    /// A node as a polynomial. A node that cannot be expanded is a variable of the polynomial.
    fn of(&mut self, id: NodeId, depth: usize) -> Polynomial {
        if let Some(known) = self.known.get(&id) {
            return known.clone();
        }
        let found = if depth < DEPTH_LIMIT { self.expanded(id, depth) } else { None };
        let found = found.unwrap_or_else(|| Polynomial::variable(id));
        self.known.insert(id, found.clone());
        found
    }

    /// Expands a number, or an operation on polynomials. `None` for any other node, or if the work
    /// or the numbers become too large.
    fn expanded(&mut self, id: NodeId, depth: usize) -> Option<Polynomial> {
        let graph = self.graph;
        let (op, operands) = match graph.node(id) {
            Node::Constant(value) => {
                let exact = value.exact().filter(|value| bits(value) <= BITS_LIMIT)?;
                return Some(Polynomial::constant(exact.clone()));
            }
            Node::Variable(_) | Node::Parameter(_) => return None,
            Node::Apply(op, operands) => (*op, operands),
        };
        let mut operand = |at: usize| self.of(operands[at], depth + 1);
        match op.row().class {
            Class::Negation => Some(Polynomial::default().minus(&operand(0))),
            Class::Sum => {
                let (a, b) = (operand(0), operand(1));
                self.work.spend(a.0.len() + b.0.len())?;
                if op == Op::Sub { a.minus(&b).moderate() } else { a.plus(&b).moderate() }
            }
            Class::Product => {
                let (a, b) = (operand(0), operand(1));
                a.times(&b, self.work)
            }
            Class::Square => operand(0).raised(2, self.work),
            Class::Power => {
                let exponent = graph.number(operands[1])?.as_integer()?;
                let base = operand(0);
                base.raised(u32::try_from(exponent).ok()?, self.work)
            }
            Class::Quotient => {
                let divisor = graph.exact(operands[1]).filter(|value| !value.is_zero())?;
                Some(operand(0).scaled(&divisor.recip()))
            }
            Class::Remainder
            | Class::Extremum
            | Class::Choice
            | Class::Fallback
            | Class::Restriction(_)
            | Class::Function(_)
            | Class::FunctionOfTwo => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::display;
    use crate::testing::{Random, TestExpr, TestGraphBuilder};

    fn work() -> Work {
        Work(100_000)
    }

    fn shown(formula: impl for<'a> Fn([TestExpr<'a>; 3]) -> [TestExpr<'a>; 2]) -> String {
        let builder = TestGraphBuilder::default();
        let pair = formula(builder.xyz()).map(|term| term.id);
        let mut graph = builder.graph();
        let [a, b] = pair.map(|id| Polynomial::of(&graph, id, &mut work()));
        let common = a.gcd(&b, &mut work()).expect("small");
        let common = common.emit(&mut graph);
        display(&graph, common, &[])
    }

    #[test]
    fn common_divisors_are_found() {
        assert_eq!(shown(|[x, y, _]| [x.pow(2) - y.pow(2), x - y]), "y - x");
        assert_eq!(shown(|[x, y, _]| [x.pow(3) + y.pow(3), x + y]), "y + x");
        assert_eq!(shown(|[x, y, z]| [x * y - z, x * z - y]), "1");
        assert_eq!(shown(|[x, y, z]| [x * y * z, z * y.pow(3)]), "y*z");
        assert_eq!(shown(|[x, ..]| [(x + 1.0) * 2.0, (x + 1.0).pow(2) * x]), "x + 1");
        assert_eq!(
            shown(|[x, y, _]| [(x - y).f(Op::Sin) * x, (x - y).f(Op::Sin) * y]),
            "sin(x - y)"
        );
    }

    /// A random polynomial in x, y and z of some terms of low degree.
    fn random(random: &mut Random, variables: [NodeId; 3]) -> Polynomial {
        let mut sum = Polynomial::default();
        for _ in 0..=random.below(3) {
            let mut term = Polynomial::constant(BigRational::from_integer(
                (random.below(9) as i64 - 4).into(),
            ));
            for variable in variables {
                let power = Polynomial::power_of(variable, random.below(3) as u32);
                term = term.times(&power, &mut work()).expect("small");
            }
            sum = sum.plus(&term);
        }
        sum
    }

    #[test]
    fn gcds_hold_a_common_factor_and_leave_none() {
        let seed = 0x9cd0;
        println!("seed {seed:#x}");
        let mut rng = Random(seed);
        let mut graph = Graph::new();
        let variables = crate::Axis::ALL.map(|axis| graph.variable(axis));
        let mut found = 0;
        for _ in 0..2000 {
            let [a, b, c] = [0; 3].map(|_| random(&mut rng, variables));
            let times = |p: &Polynomial, q: &Polynomial| p.times(q, &mut work()).expect("small");
            let (left, right) = (times(&a, &c), times(&b, &c));
            if left.is_zero() || right.is_zero() {
                continue;
            }
            let Some(common) = left.gcd(&right, &mut work()) else { continue };
            let divided = |p: &Polynomial| p.divided(&common, &mut work()).expect("it divides");
            let (p, q) = (divided(&left), divided(&right));
            assert_eq!(times(&p, &common), left);
            common.divided(&c, &mut work()).expect("the factor divides the common divisor");
            assert!(p.gcd(&q, &mut work()).expect("small").as_constant().is_some());
            found += 1;
        }
        assert!(found > 1500, "{found}");
    }
}
