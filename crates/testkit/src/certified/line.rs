//! Lines in space, and functions along them.

use crate::oracle::Span;
use std::collections::HashMap;
use zeroset_ir::{Axis, Constant, Graph, Node, NodeId, gradient};
use zeroset_ops::Op;

/// The real line of the points `eye + t·direction`, in exact arithmetic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// The point at t = 0.
    pub eye: [f64; 3],
    /// The direction, which is not 0.
    pub direction: [f64; 3],
}

/// The range of t ≥ 0 at which a line is inside a box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Clip {
    /// Bounds that contain every t whose point is inside.
    pub(super) outer: [f64; 2],
    /// Bounds between which every point is inside; not in order if no point is certainly inside.
    pub(super) inner: [f64; 2],
}

impl Line {
    /// Returns the range of t ≥ 0 inside `region`, or `None` if the range is certainly empty.
    pub(super) fn clip(&self, region: &[[f64; 2]; 3]) -> Option<Clip> {
        let mut clip = Clip { outer: [0.0, f64::INFINITY], inner: [0.0, f64::INFINITY] };
        for (axis, &[lo, hi]) in region.iter().enumerate() {
            let (eye, direction) = (self.eye[axis], self.direction[axis]);
            if direction == 0.0 {
                if eye < lo || hi < eye {
                    return None;
                }
                continue;
            }
            let at = |end: f64| {
                let room = Span::point(end).sub(Span::point(eye));
                room.div(Span::point(direction))
            };
            let (enter, leave) = if direction > 0.0 { (at(lo), at(hi)) } else { (at(hi), at(lo)) };
            clip.outer = [clip.outer[0].max(enter.lo), clip.outer[1].min(leave.hi)];
            clip.inner = [clip.inner[0].max(enter.hi), clip.inner[1].min(leave.lo)];
        }
        (clip.outer[0] <= clip.outer[1]).then_some(clip)
    }

    /// Returns bounds of the coordinate along `axis` between two distances, rounded outward.
    ///
    /// # Panics
    /// If there is no such axis.
    pub fn range(&self, axis: usize, near: f64, far: f64) -> (f64, f64) {
        let way = Span::point(self.direction[axis]).mul(Span::new(near, far));
        let range = Span::point(self.eye[axis]).add(way);
        (range.lo, range.hi)
    }

    /// Returns this line's numbers as parameters of a [`FunctionOnLine`].
    pub(super) fn parameters(&self) -> Vec<(f64, f64)> {
        self.eye.iter().chain(&self.direction).map(|value| (*value, *value)).collect()
    }
}

/// A function of t and of the six numbers of a line, and its derivative by t.
///
/// The graph has t as the coordinate x. The numbers of the line are parameters, so one graph serves
/// every line.
#[derive(Clone, Debug)]
pub struct FunctionOnLine {
    pub(super) graph: Graph,
    pub(super) root: NodeId,
    pub(super) slope: NodeId,
}

impl FunctionOnLine {
    pub(super) fn new(typed: &Graph, root: NodeId, parameters: &[Constant]) -> Self {
        let needed = typed.reachable(&[root]);
        let mut graph = Graph::new();
        let t = graph.variable(Axis::X);
        let coordinates = Axis::ALL.map(|axis| {
            let eye = graph.parameter(axis as u32);
            let direction = graph.parameter(3 + axis as u32);
            let way = graph.apply(Op::Mul, &[direction, t]);
            graph.apply(Op::Add, &[eye, way])
        });
        let mut copies: HashMap<NodeId, NodeId> = HashMap::new();
        for (id, node) in typed.iter().filter(|(id, _)| needed[id.index()]) {
            let copy = match node {
                Node::Variable(axis) => coordinates[*axis as usize],
                Node::Parameter(number) => graph.constant(parameters[*number as usize].clone()),
                Node::Constant(value) => graph.constant(value.clone()),
                Node::Apply(op, operands) => {
                    let operands: Vec<_> = operands.iter().map(|id| copies[id]).collect();
                    graph.apply(*op, &operands)
                }
            };
            copies.insert(id, copy);
        }
        let root = copies[&root];
        let [slope, ..] = gradient(&mut graph, root);
        Self { graph, root, slope }
    }
}
