//! Sums of terms of one sign: such a sum is 0 only where all of its terms are 0.

use super::{FACTOR_LIMIT, factors, whole};
use crate::graph::{Graph, Node, NodeId};
use zeroset_ops::Op;

/// A term that is never negative, or never positive.
#[derive(Default)]
struct SignedTerm {
    is_negative: bool,
    /// Distinct nodes: the term is 0 exactly where at least one of them is 0.
    bases: Vec<NodeId>,
    /// Whether the term differs from the product of the bases' squares by more than a constant
    /// factor.
    is_flat: bool,
}

/// Splits a sum whose terms all have the same sign into factors. The factors are the bases that all
/// terms share, and a sum of squares of the terms' remaining bases. `None` for other sums, and if
/// nothing would change.
pub fn of_even_powers(graph: &mut Graph, root: NodeId) -> Option<Vec<NodeId>> {
    let mut terms: Vec<SignedTerm> = Vec::new();
    let mut rest = vec![(root, false)];
    while let Some((id, negative)) = rest.pop() {
        match graph.node(id) {
            Node::Apply(Op::Add, operands) => {
                rest.extend([(operands[1], negative), (operands[0], negative)]);
            }
            Node::Apply(Op::Sub, operands) => {
                rest.extend([(operands[1], !negative), (operands[0], negative)]);
            }
            Node::Apply(..) | Node::Constant(_) | Node::Variable(_) | Node::Parameter(_) => {
                let mut term = term(graph, id)?;
                term.is_negative ^= negative;
                terms.push(term);
            }
        }
        if terms.len() + rest.len() > FACTOR_LIMIT {
            return None;
        }
    }
    let (first, others) = terms.split_first()?;
    let is_one_sign = others.iter().all(|term| term.is_negative == first.is_negative);
    let mut common = first.bases.clone();
    common.retain(|base| others.iter().all(|term| term.bases.contains(base)));
    let is_simpler = !common.is_empty() || terms.iter().any(|term| term.is_flat);
    if others.is_empty() || !is_one_sign || !is_simpler {
        return None;
    }
    let mut sum = None;
    for mut term in terms {
        term.bases.retain(|base| !common.contains(base));
        let product = |product, base: &NodeId| match product {
            None => Some(*base),
            Some(product) => Some(graph.apply(Op::Mul, &[product, *base])),
        };
        let square = match term.bases.iter().fold(None, product) {
            None => graph.integer(1),
            Some(product) => graph.apply(Op::Sqr, &[product]),
        };
        sum = Some(sum.map_or(square, |sum| graph.apply(Op::Add, &[sum, square])));
    }
    common.extend(sum);
    Some(common)
}

/// Reads node `id` as a term of one sign. `None` if its operations do not show this.
fn term(graph: &Graph, id: NodeId) -> Option<SignedTerm> {
    let mut term = SignedTerm::default();
    let (mut rest, mut visits) = (vec![id], 0);
    while let Some(id) = rest.pop() {
        visits += 1;
        match graph.node(id) {
            Node::Apply(Op::Mul, operands) => rest.extend(operands.iter().rev()),
            Node::Apply(Op::Neg, operands) => {
                term.is_negative ^= true;
                rest.push(operands[0]);
            }
            Node::Apply(Op::Sqr, operands) => bases(graph, operands[0], &mut term)?,
            Node::Apply(Op::Abs, operands) => {
                term.is_flat = true;
                bases(graph, operands[0], &mut term)?;
            }
            Node::Apply(Op::Pow, operands) => {
                let [base, exponent] = [operands[0], operands[1]];
                let is_absolute = matches!(graph.node(base), Node::Apply(Op::Abs, _));
                let exponent = whole(graph, exponent)?;
                if !is_absolute && exponent % 2 != 0 {
                    return None;
                }
                term.is_flat |= exponent != 2;
                bases(graph, base, &mut term)?;
            }
            Node::Constant(value) => {
                let bounds = value.bounds();
                if bounds.contains(0.0) {
                    return None;
                }
                term.is_negative ^= bounds.hi < 0.0;
            }
            Node::Apply(..) | Node::Variable(_) | Node::Parameter(_) => return None,
        }
        // A shared factor is visited as often as it occurs.
        if term.bases.len() + rest.len() > FACTOR_LIMIT || visits > 4 * FACTOR_LIMIT {
            return None;
        }
    }
    Some(term)
}

/// Adds the distinct factors of a power's base `root` to `term`, without the factors' exponents.
fn bases(graph: &Graph, root: NodeId, term: &mut SignedTerm) -> Option<()> {
    term.is_flat |= factors(graph, root, &[Op::Neg, Op::Abs], &[Op::Sqr], &mut term.bases)?;
    Some(())
}
