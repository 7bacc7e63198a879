//! Cancels common factors of numerators and denominators. At a zero of such a factor, the quotient
//! is undefined, though it may have a limit.
//!
//! In (x² − y²)/(x − y), numerator and denominator are divided by x − y. The quotient x + y equals
//! the function wherever the function is defined. So the function is 0 where x + y is 0 and x − y
//! is not. The common factors of polynomials are found exactly.
//!
//! For a function f with f(c) = v, the difference f(u) − v is (u − c)ⁿ·S(u), where S has no pole at
//! c: sin u = u·S(u). The table of operations has S for each such f. So sin(x y)/x becomes y·S(x
//! y). The expressions f(u) and S(u) are variables of the polynomials.

use crate::addition::{factor_pairs, has_sums};
use crate::algebra::{div, mul, powi, sub};
use crate::clear::Factors;
use crate::constant::Constant;
use crate::derivative::formula;
use crate::differences::{difference_quotient, shift};
use crate::graph::{Graph, Node, NodeId};
use crate::polynomial::{self, Polynomial, Work};
use crate::roots::{Root, roots};
use num_rational::BigRational;
use num_traits::{One, Zero};
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use zeroset_ops::{Class, Op, Secant};

/// Largest number of products of terms that are computed for one function. They take a few tenths
/// of a second at most.
const WORK_LIMIT: u32 = 20_000;
/// Largest number of functions in a pair of polynomials that are replaced by secants together.
const SECANT_LIMIT: usize = 4;
/// Largest number of roots of a polynomial that are tried.
const ROOT_LIMIT: usize = 8;
/// Largest number of factors that are cancelled in one fraction.
const STEP_LIMIT: usize = 32;
/// Largest number of operations that are examined to prove that a node is defined everywhere.
const TOTAL_LIMIT: usize = 256;
/// Largest exponent of a factor.
const EXPONENT_LIMIT: i64 = 64;

/// Finds common factors. Remembers pairs of nodes that have none.
pub(crate) struct Cancellation {
    work: Work,
    coprime: HashSet<(NodeId, NodeId)>,
    extensions: HashMap<(NodeId, bool), NodeId>,
    /// For each numerator from which a factor was removed: the numerator before, and the factor.
    origins: HashMap<NodeId, (NodeId, NodeId)>,
    /// True if every S(u) gets a value where u = c.
    is_total: bool,
}

impl Default for Cancellation {
    fn default() -> Self {
        let (coprime, extensions, origins) = (HashSet::new(), HashMap::new(), HashMap::new());
        Self { work: Work(WORK_LIMIT), coprime, extensions, origins, is_total: false }
    }
}

/// The common factor of a factor p of a numerator and a base b of a denominator.
struct CommonFactor {
    factor: NodeId,
    /// The quotients of p and of b by the common factor.
    cofactors: [Cofactor; 2],
}

enum Cofactor {
    Number(BigRational),
    Node(NodeId),
}

/// A function f(u) whose difference from its value at c has the factor u − c.
struct Difference {
    node: NodeId,
    operand: NodeId,
    secant: Secant,
    /// u − c
    divisor: Polynomial,
}

/// Splits a node into a product of powers. Returns each base with its exponent, and whether the
/// product must be negated. Each node is visited once.
pub(crate) fn factors(graph: &Graph, id: NodeId) -> (bool, Factors) {
    let (mut is_negative, mut found) = (false, Factors::new());
    // Operands precede the nodes that use them. So the exponent of the last node is complete.
    let mut pending = BTreeMap::from([(id, 1_u32)]);
    while let Some((id, exponent)) = pending.pop_last() {
        let (class, operands) = match graph.node(id) {
            Node::Apply(op, operands) => (Some(op.row().class), &operands[..]),
            Node::Variable(_) | Node::Parameter(_) | Node::Constant(_) => (None, &[][..]),
        };
        let whole = |id: NodeId| {
            let exponent = graph.number(id)?.as_integer()?;
            (1..=EXPONENT_LIMIT).contains(&exponent).then_some(exponent as u32)
        };
        let (operands, times) = match class {
            Some(Class::Product) if found.len() + pending.len() < STEP_LIMIT => (operands, 1),
            Some(Class::Negation) => (operands, 1),
            Some(Class::Square) => (operands, 2),
            Some(Class::Power) => match whole(operands[1]) {
                Some(times) => (&operands[..1], times),
                None => (&[][..], 1),
            },
            _ => (&[][..], 1),
        };
        // Both operands of a product may be the same node, so twice the share must fit.
        let share = exponent.checked_mul(2 * times).map(|twice| twice / 2);
        let fits = |share: u32, operand: &NodeId| {
            pending.get(operand).unwrap_or(&0).checked_add(2 * share).is_some()
        };
        match share {
            Some(share) if !operands.is_empty() && operands.iter().all(|id| fits(share, id)) => {
                is_negative ^= class == Some(Class::Negation) && exponent % 2 == 1;
                for operand in operands {
                    *pending.entry(*operand).or_insert(0) += share;
                }
            }
            _ => _ = found.insert(id, exponent),
        }
    }
    (is_negative, found)
}

impl Cancellation {
    /// A cancellation whose quotients have values where the common factors are 0.
    pub fn total() -> Self {
        Self { is_total: true, ..Self::default() }
    }

    /// Divides a numerator and the bases in `below` by common factors. Returns the new numerator
    /// and the common factors. `None` if there is no common factor.
    pub fn cancel(
        &mut self,
        graph: &mut Graph,
        numerator: NodeId,
        below: &mut Factors,
    ) -> Option<(NodeId, Vec<NodeId>)> {
        let (is_negative, mut above) = factors(graph, numerator);
        let (mut removed, mut coefficient) = (Vec::new(), BigRational::one());
        while removed.len() < STEP_LIMIT
            && let Some((p, b, found)) = self.find_common_factor(graph, &above, below, &removed)
        {
            let (m, n) = (take(&mut above, p), take(below, b));
            let times = m.min(n);
            put(&mut above, p, m - times);
            put(below, b, n - times);
            let [rest, divisor] = found.cofactors;
            match rest {
                Cofactor::Number(value) => coefficient *= value.pow(times as i32),
                Cofactor::Node(id) => {
                    self.origins.entry(id).or_insert((p, found.factor));
                    put(&mut above, id, times);
                }
            }
            match divisor {
                Cofactor::Number(value) => coefficient /= value.pow(times as i32),
                Cofactor::Node(id) => put(below, id, times),
            }
            removed.push(found.factor);
        }
        if removed.is_empty() {
            return None;
        }
        let coefficient = if is_negative { -coefficient } else { coefficient };
        let coefficient = graph.constant(Constant::rational(coefficient));
        Some((product(graph, coefficient, &above), removed))
    }

    /// The numerator without factors that are 0 only where one of the bases `nonzero` is 0.
    pub fn without_zeros_of(
        &mut self,
        graph: &mut Graph,
        numerator: NodeId,
        nonzero: &Factors,
    ) -> NodeId {
        let (_, mut above) = factors(graph, numerator);
        let mut steps = 0;
        while steps < STEP_LIMIT
            && let Some((p, _, found)) = self.find_common_factor(graph, &above, nonzero, &[])
        {
            let exponent = take(&mut above, p);
            let [rest, _] = found.cofactors;
            if let Cofactor::Node(id) = rest {
                put(&mut above, id, exponent);
            }
            steps += 1;
        }
        if steps == 0 {
            return numerator;
        }
        let one = graph.integer(1);
        product(graph, one, &above)
    }

    /// Finds a factor in `above` and a base in `below` with a common factor. Returns all three.
    fn find_common_factor(
        &mut self,
        graph: &mut Graph,
        above: &Factors,
        below: &Factors,
        removed: &[NodeId],
    ) -> Option<(NodeId, NodeId, CommonFactor)> {
        for p in above.keys() {
            for b in below.keys() {
                if graph.number(*p).is_some() || self.coprime.contains(&(*p, *b)) {
                    continue;
                }
                let nonzero = || below.keys().chain(removed).copied();
                match self.common_factor(graph, [*p, *b], nonzero) {
                    Some(common) => return Some((*p, *b, common)),
                    None => self.coprime.insert((*p, *b)),
                };
            }
        }
        None
    }

    /// The common factor of node p of a numerator and node b of a denominator. Looks for it in
    /// their polynomials, then in polynomials whose functions are rewritten with secants, then by
    /// shifts.
    fn common_factor<I: Iterator<Item = NodeId>>(
        &mut self,
        graph: &mut Graph,
        [p, b]: [NodeId; 2],
        nonzero: impl Fn() -> I,
    ) -> Option<CommonFactor> {
        let one = || Cofactor::Number(BigRational::one());
        if p == b {
            return Some(CommonFactor { factor: b, cofactors: [one(), one()] });
        }
        if self.work.is_spent() {
            return None;
        }
        let plain = [p, b].map(|id| Polynomial::of(graph, id, &mut self.work));
        if let Some(common) = self.split_common_factor(graph, &plain, [p, b]) {
            return Some(common);
        }
        if let Some(common) = self.common_factor_by_secants(graph, &plain, [p, b], &nonzero) {
            return Some(common);
        }
        if let Some(common) = self.common_factor_by_sums(graph, &plain, [p, b], &nonzero) {
            return Some(common);
        }
        [1, 0]
            .into_iter()
            .find_map(|by| self.common_factor_by_shifts(graph, &plain, by, [p, b], &nonzero))
            .or_else(|| self.common_factor_by_origin(graph, [p, b], &nonzero))
    }

    /// Finds a common factor q of p and b if p is n/r for an earlier numerator n = q·m and a factor
    /// r. If r − k·q is a number d, then p/q = n/(q·r) = (m − k·p)/d. For example, sin(πx)/(x² − 1)
    /// is half the difference of sin(πx)/(x − 1) and sin(πx)/(x + 1).
    fn common_factor_by_origin<I: Iterator<Item = NodeId>>(
        &mut self,
        graph: &mut Graph,
        [p, b]: [NodeId; 2],
        nonzero: &impl Fn() -> I,
    ) -> Option<CommonFactor> {
        let (n, r) = *self.origins.get(&p)?;
        let nonzero: Vec<NodeId> = nonzero().collect();
        let nonzero: &dyn Fn() -> std::vec::IntoIter<NodeId> = &|| nonzero.clone().into_iter();
        let CommonFactor { factor, cofactors: [m, below] } =
            self.common_factor(graph, [n, b], nonzero)?;
        let [r, q] = [r, factor].map(|id| Polynomial::of(graph, id, &mut self.work));
        let variable = q.variables().pop_first()?;
        let k = r.linear_factor(variable)? / q.linear_factor(variable)?;
        let d = r.minus(&q.scaled(&k)).as_constant().filter(|d| !d.is_zero())?;
        let [k, d] = [k, d].map(|value| graph.constant(Constant::rational(value)));
        let m = match m {
            Cofactor::Number(value) => graph.constant(Constant::rational(value)),
            Cofactor::Node(id) => id,
        };
        let multiple = mul(graph, k, p);
        let difference = sub(graph, m, multiple);
        let above = Cofactor::Node(div(graph, difference, d));
        Some(CommonFactor { factor, cofactors: [above, below] })
    }

    /// Finds a common factor of two polynomials in which functions f(u) are replaced by v + (u −
    /// c)ⁿ·S(u).
    fn common_factor_by_secants<I: Iterator<Item = NodeId>>(
        &mut self,
        graph: &mut Graph,
        plain: &[Polynomial; 2],
        nodes: [NodeId; 2],
        nonzero: &impl Fn() -> I,
    ) -> Option<CommonFactor> {
        let differences = self.related_differences(graph, plain);
        // Small sets of replaced functions are tried first.
        let mut sets: Vec<u32> = (1..1 << differences.len()).collect();
        sets.sort_by_key(|set| set.count_ones());
        for set in sets {
            let mut pair = plain.clone();
            for (k, difference) in differences.iter().enumerate() {
                if set >> k & 1 == 1 {
                    let value = self.expanded_difference(graph, difference, nonzero())?;
                    for polynomial in &mut pair {
                        *polynomial =
                            polynomial.substituted(difference.node, &value, &mut self.work)?;
                    }
                }
            }
            if let Some(common) = self.split_common_factor(graph, &pair, nodes) {
                return Some(common);
            }
        }
        None
    }

    /// Finds a common factor after functions of sums in the numerator are expanded. The terms of
    /// the sums are multiples of two linear factors of the bases.
    fn common_factor_by_sums<I: Iterator<Item = NodeId>>(
        &mut self,
        graph: &mut Graph,
        plain: &[Polynomial; 2],
        nodes: [NodeId; 2],
        nonzero: &impl Fn() -> I,
    ) -> Option<CommonFactor> {
        // Roots of bases take long to find.
        if !has_sums(graph, &plain[0]) {
            return None;
        }
        let bases: Vec<Polynomial> =
            nonzero().map(|base| Polynomial::of(graph, base, &mut self.work)).collect();
        for factors in factor_pairs(&bases, &mut self.work).iter().take(SECANT_LIMIT) {
            let Some(expanded) = factors.expanded(graph, &plain[0], &mut self.work) else {
                continue;
            };
            let pair = [expanded, plain[1].clone()];
            if let Some(common) = self.split_common_factor(graph, &pair, nodes) {
                return Some(common);
            }
            if let Some(common) = self.common_factor_by_secants(graph, &pair, nodes, nonzero) {
                return Some(common);
            }
        }
        None
    }

    /// Finds a common factor of two polynomials if `plain[by]` has a root in some variable. In the
    /// other polynomial, each function f(u) is rewritten as f(w) + (u − w)·Q. Here w is u at the
    /// root.
    fn common_factor_by_shifts<I: Iterator<Item = NodeId>>(
        &mut self,
        graph: &mut Graph,
        plain: &[Polynomial; 2],
        by: usize,
        nodes: [NodeId; 2],
        nonzero: &impl Fn() -> I,
    ) -> Option<CommonFactor> {
        let is_function = |id: &NodeId| matches!(graph.node(*id), Node::Apply(..));
        if !plain[1 - by].variables().iter().any(is_function) {
            return None;
        }
        for root in roots(&plain[by], &mut self.work).iter().take(ROOT_LIMIT) {
            let Some((pair, gaps)) = self.shifted(graph, plain, by, root, nonzero) else {
                continue;
            };
            if pair == *plain {
                continue;
            }
            let Some(common) = self.split_common_factor(graph, &pair, nodes) else { continue };
            // Q may be undefined where its divisor u − w is 0. This is harmless if u − w divides
            // the common factor: there the base b is 0 anyway.
            let factor = Polynomial::of(graph, common.factor, &mut self.work);
            if gaps.iter().all(|gap| factor.divided(gap, &mut self.work).is_some()) {
                return Some(common);
            }
        }
        None
    }

    /// The pair of polynomials with f(w) + (u − w)·Q in place of functions f(u) in `pair[1 - by]`,
    /// and the divisors u − w where Q may be undefined. The functions within u follow. `None` if
    /// this takes too much work.
    fn shifted<I: Iterator<Item = NodeId>>(
        &mut self,
        graph: &mut Graph,
        plain: &[Polynomial; 2],
        by: usize,
        root: &Root,
        nonzero: &impl Fn() -> I,
    ) -> Option<([Polynomial; 2], Vec<Polynomial>)> {
        let mut known: BTreeSet<NodeId> = plain.iter().flat_map(Polynomial::variables).collect();
        let (mut pair, mut gaps) = (plain.clone(), Vec::new());
        let mut open = plain[1 - by].variables();
        // Operands precede the nodes that use them, so the outermost function is last.
        while let Some(node) = open.pop_last() {
            let Some(shift) = shift(graph, node, root, &known, &mut self.work) else { continue };
            let is_excluded = self.is_excluded(graph, &shift.divisor, nonzero())?;
            if !is_excluded && shift.has_gap {
                if by == 1 {
                    continue;
                }
                gaps.push(shift.divisor.clone());
            }
            let is_total = self.is_total || !is_excluded;
            let quotient = difference_quotient(graph, &shift, |graph, op, operands| {
                let value = graph.apply(op, &operands[..1]);
                let secant = &op.row().secants[0];
                extension(graph, secant, operands, is_total.then_some(value))
            });
            let product = Polynomial::variable(quotient).times(&shift.divisor, &mut self.work)?;
            let value = product.plus(&shift.value);
            pair[1 - by] = pair[1 - by].substituted(node, &value, &mut self.work)?;
            let inner = shift.divisor.variables();
            open.extend(inner.difference(&known).filter(|inner| **inner < node));
            known.extend(inner);
        }
        Some((pair, gaps))
    }

    /// Returns whether a polynomial is 0 only where one of the nodes `nonzero` is 0. `None` if this
    /// takes too much work.
    fn is_excluded(
        &mut self,
        graph: &Graph,
        polynomial: &Polynomial,
        nonzero: impl Iterator<Item = NodeId>,
    ) -> Option<bool> {
        let mut rest = polynomial.clone();
        for base in nonzero {
            let base = Polynomial::of(graph, base, &mut self.work);
            loop {
                let common = rest.gcd(&base, &mut self.work)?;
                if common.as_constant().is_some() {
                    break;
                }
                rest = rest.divided(&common, &mut self.work)?;
            }
        }
        Some(rest.as_constant().is_some())
    }

    /// Splits two polynomials into a common factor and the quotients by it. `None` if they have no
    /// common factor. If the common factor is the second polynomial up to a constant, it is the
    /// second of `nodes`.
    fn split_common_factor(
        &mut self,
        graph: &mut Graph,
        [p, b]: &[Polynomial; 2],
        nodes: [NodeId; 2],
    ) -> Option<CommonFactor> {
        if p.is_zero() || b.is_zero() {
            return None;
        }
        let common = p.gcd(b, &mut self.work)?;
        if common.as_constant().is_some() {
            return None;
        }
        let cofactors = [p.divided(&common, &mut self.work)?, b.divided(&common, &mut self.work)?];
        let is_all = cofactors[1].as_constant().is_some();
        // The function stays undefined where a part is undefined, even if the part cancels.
        let kept = cofactors.iter().chain([&common]).flat_map(Polynomial::variables).collect();
        let kept = below_nodes(graph, kept);
        let parts = nodes.iter().flat_map(|id| Polynomial::leaves(graph, *id));
        let lost = parts.filter(|id| !kept.contains(id) && !is_total(graph, *id));
        let lost: BTreeSet<NodeId> = lost.collect();
        let [above, below] = cofactors.map(|rest| match rest.as_constant() {
            Some(value) => Cofactor::Number(value),
            None => Cofactor::Node(rest.emit(graph)),
        });
        let above = lost.into_iter().fold(above, |above, variable| {
            let node = match above {
                Cofactor::Number(value) => graph.constant(Constant::rational(value)),
                Cofactor::Node(id) => id,
            };
            Cofactor::Node(graph.apply(Op::WhereDefined, &[node, variable]))
        });
        let common = if is_all { nodes[1] } else { common.emit(graph) };
        Some(CommonFactor { factor: common, cofactors: [above, below] })
    }

    /// Finds functions f(u) in two polynomials. Keeps those for which u − c has a common factor
    /// with the other polynomial, or with the divisor of a function in the other polynomial.
    fn related_differences(&mut self, graph: &Graph, pair: &[Polynomial; 2]) -> Vec<Difference> {
        let mut found: [Vec<Difference>; 2] = Default::default();
        for (found, polynomial) in found.iter_mut().zip(pair) {
            for node in polynomial.variables() {
                let Node::Apply(op, operands) = graph.node(node) else { continue };
                for secant in op.row().secants {
                    let operand = operands[0];
                    let at = Polynomial::constant(BigRational::from_integer(secant.at.into()));
                    let divisor = Polynomial::of(graph, operand, &mut self.work).minus(&at);
                    if divisor.as_constant().is_none() && found.len() < SECANT_LIMIT {
                        found.push(Difference { node, operand, secant: *secant, divisor });
                    }
                }
            }
        }
        let work = &mut self.work;
        let mut shares = |a: &Polynomial, b: &Polynomial| {
            a.gcd(b, work).is_some_and(|common| common.as_constant().is_none())
        };
        let mut meets = |difference: &Difference, other: usize| {
            shares(&difference.divisor, &pair[other])
                || found[other].iter().any(|other| shares(&difference.divisor, &other.divisor))
        };
        let keep = [0, 1].map(|side| {
            let keep = found[side].iter().map(|difference| meets(difference, 1 - side));
            keep.collect::<Vec<bool>>()
        });
        let mut kept = Vec::new();
        let mut seen = BTreeSet::new();
        for (found, keep) in found.into_iter().zip(keep) {
            for (difference, keep) in found.into_iter().zip(keep) {
                if keep && kept.len() < SECANT_LIMIT && seen.insert(difference.node) {
                    kept.push(difference);
                }
            }
        }
        kept
    }

    /// The polynomial v + (u − c)ⁿ·S, which equals f(u).
    fn expanded_difference(
        &mut self,
        graph: &mut Graph,
        difference: &Difference,
        nonzero: impl Iterator<Item = NodeId>,
    ) -> Option<Polynomial> {
        let Difference { node, operand, secant, divisor } = difference;
        // If the function may be defined where u = c, S needs a value there.
        let is_total = self.is_total || !self.is_excluded(graph, divisor, nonzero)?;
        let extension = if let Some(known) = self.extensions.get(&(*node, is_total)) {
            *known
        } else {
            let shifted = if secant.at.is_zero() { *operand } else { divisor.emit(graph) };
            let domain = is_total.then_some(*node);
            let extension = extension(graph, secant, [*operand, shifted], domain);
            self.extensions.insert((*node, is_total), extension);
            extension
        };
        let power = divisor.raised(secant.order.into(), &mut self.work)?;
        let product = power.times(&Polynomial::variable(extension), &mut self.work)?;
        let value = Polynomial::constant(BigRational::from_integer(secant.value.into()));
        Some(product.plus(&value))
    }
}

/// Adds the node S(u). Where u = c, it is undefined if `domain` is `None`. Otherwise it has its
/// limit there, wherever the node `domain` is defined.
fn extension(
    graph: &mut Graph,
    secant: &Secant,
    operands: [NodeId; 2],
    domain: Option<NodeId>,
) -> NodeId {
    let value = formula(graph, secant.formula, &operands, &operands);
    let Some(domain) = domain else { return value };
    let limit = BigRational::new(secant.limit[0].into(), secant.limit[1].into());
    let limit = graph.constant(Constant::rational(limit));
    let limit = graph.apply(Op::WhereDefined, &[limit, domain]);
    graph.apply(Op::Otherwise, &[value, limit])
}

/// These nodes and the nodes that they depend on. If there are many, some are left out.
fn below_nodes(graph: &Graph, nodes: Vec<NodeId>) -> HashSet<NodeId> {
    let (mut open, mut seen) = (nodes, HashSet::new());
    while let Some(id) = open.pop() {
        if seen.len() < TOTAL_LIMIT
            && seen.insert(id)
            && let Node::Apply(_, operands) = graph.node(id)
        {
            open.extend(operands.iter());
        }
    }
    seen
}

/// Returns whether a node is defined everywhere, by its operations alone.
fn is_total(graph: &Graph, id: NodeId) -> bool {
    let mut open = vec![id];
    let mut seen = HashSet::new();
    while let Some(id) = open.pop() {
        if let Node::Apply(op, operands) = graph.node(id)
            && seen.insert(id)
        {
            if !polynomial::is_total(graph, *op, operands) || seen.len() > TOTAL_LIMIT {
                return false;
            }
            open.extend(operands.iter());
        }
    }
    true
}

fn take(factors: &mut Factors, base: NodeId) -> u32 {
    factors.remove(&base).unwrap_or(0)
}

fn put(factors: &mut Factors, base: NodeId, exponent: u32) {
    if exponent > 0 {
        *factors.entry(base).or_insert(0) += exponent;
    }
}

fn product(graph: &mut Graph, first: NodeId, factors: &Factors) -> NodeId {
    let mut node = first;
    for (base, exponent) in factors {
        let power = powi(graph, *base, i64::from(*exponent));
        node = mul(graph, node, power);
    }
    node
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::evaluate;
    use zeroset_ops::TABLE;

    /// Compares every extension with its quotient, at operands on both sides of the limit.
    #[test]
    fn extensions_equal_their_quotients() {
        let mut rows = 0;
        for row in TABLE {
            for secant in row.secants {
                rows += 1;
                let mut graph = Graph::new();
                let [a, b] = [crate::Axis::X, crate::Axis::Y].map(|axis| graph.variable(axis));
                let f = graph.apply(row.op, &[a]);
                let total = extension(&mut graph, secant, [a, b], Some(f));
                let values = |b: f64| {
                    let values = evaluate(&graph, [b + f64::from(secant.at), b, 0.0], &[]);
                    [f, total].map(|id| values[id.index()].map(|(value, _)| value))
                };
                let limit = f64::from(secant.limit[0]) / f64::from(secant.limit[1]);
                assert_eq!(values(0.0)[1], Some(limit), "{}", row.name);
                for k in 1..=4000 {
                    for b in [-1.0, 1.0].map(|sign| sign * 0.02 * f64::from(k).powf(0.9)) {
                        let context = || format!("{} at {b}", row.name);
                        let [f, extension] = values(b);
                        assert_eq!(f.is_some(), extension.is_some(), "{}", context());
                        let (Some(f), Some(extension)) = (f, extension) else { continue };
                        let quotient = (f - f64::from(secant.value)) / b.powi(secant.order.into());
                        let error = 1e-11 * quotient.abs() + 4e-16 / b.powi(2);
                        let difference = (quotient - extension).abs();
                        assert!(difference <= error, "{}: {quotient} {extension}", context());
                    }
                }
                // The slope of an extension near its limit is below 1.
                for b in [1e-3, 1e-5, 1e-7] {
                    for b in [b, -b] {
                        let near = values(b)[1].expect("defined");
                        assert!((near - limit).abs() < b.abs(), "{}: {near} at {b}", row.name);
                    }
                }
            }
        }
        assert!(rows > 10);
    }
}
