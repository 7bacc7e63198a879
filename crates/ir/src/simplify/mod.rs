//! Rewriting a graph into a shorter one whose enclosures are tighter.

use crate::compact::compact;
use crate::error::{IrError, NODE_LIMIT};
use crate::graph::{Graph, NodeId};
use zeroset_interval::Interval;

/// A graph that holds only what `roots` need, with the same values and the same domains of definition at every
/// real point of `domain`, whatever values the parameters take within `parameters`.
///
/// # Errors
/// If the roots need more than [`NODE_LIMIT`] nodes.
pub fn simplify(
    graph: &Graph,
    roots: &[NodeId],
    domain: &[Interval; 3],
    parameters: &[Interval],
) -> Result<(Graph, Vec<NodeId>), IrError> {
    let _ = (domain, parameters);
    let (graph, roots) = compact(graph, roots);
    if graph.len() > NODE_LIMIT {
        return Err(IrError::TooLarge { limit: NODE_LIMIT });
    }
    Ok((graph, roots))
}
