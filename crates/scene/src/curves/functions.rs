//! Functions of curves, with the parameters' values in place of parameters, and their kernels.

use crate::number::nearest;
use crate::point_value::{Place, PointValues};
use crate::program::constants;
use glam::DVec3;
use zeroset_eval::{Assumptions, Binding, Kernel, Points, Query, Reference, SampleGradient, Tape};
use zeroset_interval::Interval;
use zeroset_ir::{Axis, Constant, Graph, Node, NodeId, gradient, replaced, simplify};
use zeroset_jit::Threaded;
use zeroset_ops::Op;
use zeroset_syntax::{CurveShape, Document, POINT_NAMES, PointValue, Surface};

/// Largest number of nodes of a curve's function.
const MOST_NODES: usize = 200_000;

/// The functions `roots` of the curves' graph, with numbers in place of the document's parameters.
/// The curves' own parameter becomes the variable x. `None` if the functions are too large.
pub fn bound(document: &Document, roots: &[NodeId]) -> Option<(Graph, Vec<NodeId>)> {
    with_constants(&document.curves.graph, roots, &constants(document))
}

/// The functions `roots` of a graph, with numbers in place of its parameters. A parameter beyond
/// those becomes the variable x. `None` if the functions are too large.
pub fn with_constants(
    graph: &Graph,
    roots: &[NodeId],
    values: &[Constant],
) -> Option<(Graph, Vec<NodeId>)> {
    let (graph, roots) = replaced(graph, roots, |copy, _, node| match node {
        Node::Parameter(number) => Some(match values.get(*number as usize) {
            Some(value) => copy.constant(value.clone()),
            None => copy.variable(Axis::X),
        }),
        _ => None,
    });
    simplify(&graph, &roots, &[Interval::ENTIRE; 3], &[]).ok()
}

/// A kernel that answers `Q` about functions over a domain. It needs no compiling.
pub fn kernel<Q: Query>(
    graph: &Graph,
    roots: &[NodeId],
    domain: [Interval; 3],
) -> Box<dyn Kernel<Q, f64>> {
    let assumptions = Assumptions { domain, parameters: Vec::new() };
    let tape = Tape::<f64>::new(graph, roots, &assumptions);
    match Threaded::new(tape.clone().coarse(), &Binding::empty()) {
        Ok(threaded) => Box::new(threaded),
        Err(_) => Box::new(Reference::new(tape, Binding::empty())),
    }
}

/// A kernel for values and gradients of a function. `None` if the gradient is too large.
pub fn gradient_kernel(
    graph: &Graph,
    root: NodeId,
) -> Option<Box<dyn Kernel<SampleGradient, f64>>> {
    if graph.len() > MOST_NODES {
        return None;
    }
    let mut graph = graph.clone();
    let [x, y, z] = gradient(&mut graph, root);
    let everywhere = [Interval::ENTIRE; 3];
    let (graph, roots) = simplify(&graph, &[root, x, y, z], &everywhere, &[]).ok()?;
    Some(kernel(&graph, &roots, everywhere))
}

/// The coordinates that depend on x, as one kernel. It answers for a "gradient", whose parts are
/// the coordinates.
pub fn coordinates(graph: &Graph, at: [NodeId; 3]) -> Box<dyn Kernel<SampleGradient, f64>> {
    let [x, y, z] = at;
    kernel(graph, &[x, x, y, z], [Interval::ENTIRE; 3])
}

/// The points at these values of the parameter. A coordinate without a value is NaN.
pub fn points_at(kernel: &dyn Kernel<SampleGradient, f64>, parameters: &[f64]) -> Vec<DVec3> {
    let inputs: Vec<[f64; 3]> = parameters.iter().map(|t| [*t, 0.0, 0.0]).collect();
    let outputs = kernel.eval_all(&Points::near(&inputs));
    let of = |index: usize| {
        let (batch, lane) = (index / zeroset_eval::LANES, index % zeroset_eval::LANES);
        DVec3::from_array(outputs[batch].gradient.each_ref().map(|part| part[lane]))
    };
    (0..parameters.len()).map(of).collect()
}

/// A value at each of these places, with the normal and the depth 0. NaN where it is undefined.
pub fn values_at(document: &Document, value: &PointValue, places: &[DVec3]) -> Vec<f64> {
    let parameters: Vec<f64> = constants(document).iter().map(nearest).collect();
    let value = PointValues::new(value, &parameters);
    let mut room = value.room();
    let place = |at: &DVec3| Place {
        at: at.to_array(),
        own: [0.0; POINT_NAMES.len()],
        parameters: [f64::NAN; 2],
    };
    places.iter().map(|at| value.pair(&mut room, [place(at); 2])[0]).collect()
}

/// A graph with all surfaces of the document, and one surface for each curve of two equations: the
/// points at which the larger of the two functions is 0. `None` if there is no such curve.
pub fn both_zero(document: &Document) -> Option<(Graph, Vec<Surface>)> {
    let curves = &document.curves;
    let mut graph = curves.graph.clone();
    let surfaces: Vec<Surface> = curves
        .all
        .iter()
        .filter_map(|curve| {
            let CurveShape::Intersection(both) = &curve.shape else { return None };
            let sizes = both.map(|root| graph.apply(Op::Abs, &[root]));
            Some(Surface::equation(graph.apply(Op::Max, &sizes), curve.span, curve.echo.clone()))
        })
        .collect();
    (!surfaces.is_empty()).then_some((graph, surfaces))
}
