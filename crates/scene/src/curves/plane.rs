//! Curves in planes across one axis: curves of two equations, one of which is such a plane.
//!
//! Nothing here is a proof: planes and equations only serve to choose a domain.

use super::functions::bound;
use crate::domain::GraphShape;
use zeroset_eval::Assumptions;
use zeroset_interval::Interval;
use zeroset_ir::{Axis, Constant, Graph, NodeId, substitute};
use zeroset_syntax::{CurveShape, Document, Surface};

/// The curves of a document, all in planes across one axis.
pub struct PlaneCurves {
    /// The axis that the planes cross.
    pub axis: usize,
    /// The least and the greatest coordinate of a plane.
    pub ends: [f64; 2],
    /// The document with a surface for each curve, over which and under which the curve lies.
    pub surfaces: Document,
}

/// The curves of `document`, if all are of two equations and lie in planes across one axis.
/// `surfaces` has a surface for each of them.
pub fn in_planes(document: &Document, surfaces: &[Surface]) -> Option<PlaneCurves> {
    let pairs = document.curves.all.iter().map(|curve| match &curve.shape {
        CurveShape::Intersection(both) => Some(*both),
        CurveShape::Path { .. } | CurveShape::Point { .. } => None,
    });
    let roots: Vec<NodeId> = pairs.collect::<Option<Vec<_>>>()?.concat();
    let (mut graph, roots) = bound(document, &roots)?;
    let mut found: Option<(usize, [f64; 2])> = None;
    let mut surfaces = surfaces.to_vec();
    for (pair, surface) in roots.as_chunks::<2>().0.iter().zip(&mut surfaces) {
        let plane = |root: &NodeId| plane(&graph, *root);
        let (other, (axis, at)) = match pair.each_ref().map(plane) {
            [_, Some(plane)] => (pair[0], plane),
            [Some(plane), None] => (pair[1], plane),
            [None, None] => return None,
        };
        let [low, high] = match found {
            Some((before, _)) if before != axis => return None,
            Some((_, [low, high])) => [low.min(at), high.max(at)],
            None => [at; 2],
        };
        found = Some((axis, [low, high]));
        let leaf = graph.variable(Axis::ALL[axis]);
        let place = Interval::point(at).map(Constant::enclosed)?;
        let place = graph.constant(place);
        surface.root = substitute(&mut graph, other, leaf, place);
    }
    let (axis, ends) = found?;
    Some(PlaneCurves { axis, ends, surfaces: Document { graph, surfaces, ..document.clone() } })
}

/// The axis that the zeros of a function cross, and where, if they are a plane across an axis.
fn plane(graph: &Graph, root: NodeId) -> Option<(usize, f64)> {
    let shape = GraphShape::of(graph, root, &[]);
    let axis = (0..3).find(|axis| shape.depends[*axis]).filter(|_| shape.is_plane)?;
    let is_across = (0..3).all(|other| shape.depends[other] == (other == axis));
    let value = |along: f64| {
        let domain = [Interval { lo: along, hi: along }; 3];
        let assumptions = Assumptions { domain, parameters: Vec::new() };
        let bounds = zeroset_eval::enclose(graph, root, &assumptions).0;
        bounds.lo.midpoint(bounds.hi)
    };
    let [start, end] = [0.0, 1.0].map(value);
    let at = if start == 0.0 { 0.0 } else { -start / (end - start) };
    (is_across && at.is_finite()).then_some((axis, at))
}
