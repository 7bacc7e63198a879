//! Lines, and functions along them.

use crate::oracle::Span;
use std::collections::HashMap;
use zeroset_ir::{Axis, Constant, Graph, Node, NodeId, gradient};
use zeroset_ops::Op;

/// The real line of the points `eye + t·direction`, exactly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Where t is 0.
    pub eye: [f64; 3],
    /// Any direction but 0.
    pub direction: [f64; 3],
}

/// Which t ≥ 0 lie inside a box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Clip {
    /// Ends that hold every t inside.
    pub(super) outer: [f64; 2],
    /// Ends between which every t is inside; not in order if that is uncertain everywhere.
    pub(super) inner: [f64; 2],
}

impl Line {
    /// Which t ≥ 0 lie inside `region`, or `None` if certainly none does.
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

    /// Bounds of the coordinate along `axis` of the points between two distances, rounded outward.
    ///
    /// # Panics
    /// If there is no such axis.
    pub fn range(&self, axis: usize, near: f64, far: f64) -> (f64, f64) {
        let way = Span::point(self.direction[axis]).mul(Span::new(near, far));
        let range = Span::point(self.eye[axis]).add(way);
        (range.lo, range.hi)
    }

    /// The values of the parameters that [`Along`] takes.
    pub(super) fn parameters(&self) -> Vec<(f64, f64)> {
        self.eye.iter().chain(&self.direction).map(|value| (*value, *value)).collect()
    }
}

/// A function of t and of the six numbers of a line, and its derivative by t.
///
/// t is the coordinate x; the line's numbers are parameters, so that one graph serves every line.
#[derive(Clone, Debug)]
pub struct Along {
    pub(super) graph: Graph,
    pub(super) root: NodeId,
    pub(super) slope: NodeId,
}

impl Along {
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
