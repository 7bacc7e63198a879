//! Regularizes a solid's function: removes its zeros on faces that are not on the solid's boundary.
//!
//! The boundary of a solid is where every neighborhood has an inside and an outside. An inside is
//! an open set in which the solid's condition holds, an outside one in which it fails. Parts of a
//! solid often meet in a whole face, with the inside on both sides. Or the outside is on both
//! sides, and the face is a sheet without thickness. The function is 0 on such a face and keeps its
//! sign. Rounding hides the sign near 0, so no evaluation can prove that there is no boundary.
//!
//! So the function is read as a set: minima and maxima are unions and intersections of the sets
//! where their operands are ≤ 0. An operand that is linear in some terms v, with exact
//! coefficients, is a bound v ≤ c or v ≥ c. Two operands share a face if they bound the same v by
//! the same c. Then these rules apply, up to points of the face v = c, which is
//! [thin](thin::Thinness):
//!
//! - within an intersection with v ≤ c, v ≤ c holds and v ≥ c does not; within a union, the
//!   converse ([`reduce`]);
//! - the union of P ∩ (v ≤ c) and Q ∩ (v ≥ c) also contains P ∩ Q ([`cover`]). The function is then
//!   below 0 on the shared face. Intersections have the dual rule.
//!
//! Thin sets do not change the boundary that is drawn. A set and its union with a thin set have the
//! same inside and the same outside up to thin sets. So the closures of these agree.
//!
//! Only the proof that the function is defined everywhere depends on the domain.

mod cover;
mod emit;
mod form;
mod levels;
mod reduce;
mod sets;
#[cfg(test)]
mod tests;
mod thin;

use crate::algebra::neg;
use crate::graph::{Graph, Node, NodeId};
pub use form::{multiples, planes};
pub use levels::{Level, levels, sheets};
use sets::Sets;
pub(crate) use thin::{Nonneg, is_thin_zero};
use zeroset_interval::{Decorated, Facts, Interval, fold};

/// Returns a function for the solid `root` ≤ 0, or `root` < 0, that is below 0 on faces inside of
/// the solid, and above 0 on sheets without thickness. Faces are found if they are the same
/// symbolically. The solid may differ from the given one in a closed set without interior, within
/// `domain` and for all parameters within `parameters`. The function is added to `graph`. It is −1
/// if the solid is all of space, and 1 if the solid has no interior. It is `root` itself if there
/// is nothing to change, or if it is not proven to be defined everywhere: a face where it ends must
/// stay.
///
/// `holds_zeros` tells whether the solid holds the points at which `root` is 0. If that is not
/// known, a function that may be 0 on an open set is left as it is.
///
/// ```
/// use zeroset_interval::Interval;
/// use zeroset_ir::{Axis, Graph, regularize};
/// use zeroset_ops::Op;
///
/// let mut graph = Graph::new();
/// let (x, zero) = (graph.variable(Axis::X), graph.integer(0));
/// let root = graph.apply(Op::Max, &[x, zero]);
/// assert_eq!(regularize(&mut graph, root, Some(true), &[Interval::ENTIRE; 3], &[]), x);
/// ```
pub fn regularize(
    graph: &mut Graph,
    root: NodeId,
    holds_zeros: Option<bool>,
    domain: &[Interval; 3],
    parameters: &[Interval],
) -> NodeId {
    if !is_defined(graph, root, domain, parameters) {
        return root;
    }
    match holds_zeros {
        Some(true) => regularized(graph, root, parameters),
        Some(false) => {
            // The solid −f ≤ 0 is the complement. It has the same boundary.
            let opposite = neg(graph, root);
            let found = regularized(graph, opposite, parameters);
            if found == opposite { root } else { neg(graph, found) }
        }
        None if is_thin_zero(graph, root, parameters) => regularized(graph, root, parameters),
        None => root,
    }
}

/// The function of the solid `root` ≤ 0, which is defined everywhere.
fn regularized(graph: &mut Graph, root: NodeId, parameters: &[Interval]) -> NodeId {
    let mut sets = Sets::new(graph, root, parameters);
    let set = sets.of_node(root);
    let set = sets.reduce(set);
    let covered = sets.cover(set);
    let set = if covered == set { set } else { sets.reduce(covered) };
    let plan = sets.into_plan();
    plan.emit(graph, set)
}

/// Returns whether a node is proven to be defined everywhere within these bounds.
fn is_defined(
    graph: &Graph,
    root: NodeId,
    domain: &[Interval; 3],
    parameters: &[Interval],
) -> bool {
    let unknown = Decorated::from((Interval::ENTIRE, Facts::NONE));
    let mut known: Vec<Decorated> = vec![unknown; root.index() + 1];
    for id in graph.needed(&[root]) {
        known[id.index()] = match graph.node(id) {
            Node::Variable(axis) => (domain[*axis as usize], Facts::TOTAL).into(),
            Node::Parameter(number) => (parameters[*number as usize], Facts::TOTAL).into(),
            Node::Constant(constant) => constant.value(),
            Node::Apply(op, operands) => {
                let operands: Vec<_> = operands.iter().map(|id| known[id.index()]).collect();
                fold(*op, &operands).into()
            }
        };
    }
    known[root.index()].facts.has(Facts::DEFINED)
}
