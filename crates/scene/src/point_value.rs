//! Values at points of a surface, which color maps and contour lines show.
//!
//! They are computed in ordinary floats. No proof depends on them.

use crate::number::nearest;
use zeroset_interval::{Exponent, Format, Software, Vector128};
use zeroset_ir::{Constant, Node, NodeId};
use zeroset_syntax::{POINT_NAMES, PointValue};

/// A point of a surface.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// The coordinates x, y and z.
    pub at: [f64; 3],
    /// The named quantities, in the order of [`POINT_NAMES`].
    pub own: [f64; POINT_NAMES.len()],
    /// The parameters of a parametric surface; NaN on other surfaces.
    pub parameters: [f64; 2],
}

/// A value, ready to be evaluated at points.
pub struct PointValues<'a> {
    value: &'a PointValue,
    parameters: &'a [f64],
    nodes: Vec<(NodeId, &'a Node)>,
}

/// Memory for an evaluation.
pub struct Room {
    known: Vec<Vector128>,
    inputs: Vec<Vector128>,
}

impl<'a> PointValues<'a> {
    /// Prepares a value for these values of the document's parameters.
    pub fn new(value: &'a PointValue, parameters: &'a [f64]) -> Self {
        let needed = value.graph.reachable(&[value.root]);
        let nodes = value.graph.iter().filter(|(id, _)| needed[id.index()]).collect();
        Self { value, parameters, nodes }
    }

    /// Returns memory, which evaluations may share.
    pub fn room(&self) -> Room {
        let none = Vector128::from_f64([0.0; 2]);
        Room { known: vec![none; self.value.graph.len()], inputs: Vec::new() }
    }

    /// Returns the values at two points. They are NaN where the value is undefined.
    pub fn pair(&self, room: &mut Room, two: [Place; 2]) -> [f64; 2] {
        let Room { known, inputs } = room;
        let graph = &self.value.graph;
        let both = |values: [f64; 2]| Vector128::from_f64(values);
        for (id, node) in &self.nodes {
            known[id.index()] = match node {
                Node::Variable(axis) => both(two.map(|place| place.at[*axis as usize])),
                Node::Parameter(number) => {
                    let number = *number as usize;
                    match self.parameters.get(number) {
                        Some(parameter) => both([*parameter; 2]),
                        None => both(two.map(|place| {
                            let number = number - self.parameters.len();
                            *place
                                .own
                                .get(number)
                                .unwrap_or_else(|| &place.parameters[number - POINT_NAMES.len()])
                        })),
                    }
                }
                Node::Constant(constant) => both([nearest(constant); 2]),
                Node::Apply(op, operands) => {
                    let last = operands.last().and_then(|last| graph.number(*last));
                    let exponent = last.map_or(Exponent::Real, Constant::exponent);
                    inputs.clear();
                    inputs.extend(operands.iter().map(|id| known[id.index()]));
                    Software::evaluate(Format::F64, *op, inputs, exponent)
                }
            };
        }
        known[self.value.root.index()].f64()
    }
}
