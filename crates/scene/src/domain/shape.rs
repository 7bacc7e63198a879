//! Properties read off a function's graph: its periods, the axes that it does not depend on, and
//! whether its zero set is a graph over two axes.
//!
//! Nothing here is a proof: the properties only serve to choose a window. This module depends
//! neither on kernels nor on boxes.

use super::period::{self, CONSTANT, Course, Period};
use std::f64::consts::TAU;
use zeroset_interval::Interval;
use zeroset_ir::{Graph, Node, NodeId};
use zeroset_ops::{Class, Op};

/// A linear function: the coefficients of x, y and z.
type Linear = [f64; 3];

/// Properties of a function.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GraphShape {
    /// Whether the function depends on each axis.
    pub depends: [bool; 3],
    /// Per axis, the longest period of a sine, cosine or tangent. `None` unless the axis occurs
    /// only in such functions of linear arguments.
    pub period: [Option<f64>; 3],
    /// Per axis, whether the period is that of cells between jumps or folds.
    pub has_cells: [bool; 3],
    /// The nonlinear arguments of sines, cosines and tangents, the outer ones first.
    pub waves: Vec<NodeId>,
    /// Whether the function is linear.
    pub is_plane: bool,
    /// Whether the function's zeros are planes or parts of planes: it consists of linear functions
    /// by products, minima and maxima.
    pub is_of_planes: bool,
    /// For a nonlinear function of three axes, or a function of two: an axis for which it can be
    /// solved.
    pub graph: Option<GraphAxes>,
    /// How fast the function can grow.
    pub growth: Growth,
}

/// A graph: its axis, and the coefficient of that axis in the function. The function is the
/// coefficient times the axis, plus a function of the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GraphAxes {
    pub up: usize,
    pub factor: f64,
    /// The only axis that the heights depend on, if there is only one.
    pub along: Option<usize>,
}

/// How fast a function can grow with the coordinates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Growth {
    /// The function consists of sums, products and whole powers.
    Polynomial,
    /// As a power of the coordinates at most: the function also has roots, magnitudes, minima or
    /// maxima.
    Power,
    /// Perhaps exponentially.
    #[default]
    Unlimited,
}

/// Properties of a node.
#[derive(Clone, Copy)]
pub struct NodeShape {
    depends: [bool; 3],
    linear: Option<Linear>,
    /// Whether the node's zeros are parts of planes.
    is_of_planes: bool,
    /// Per axis, a coefficient: the node is the axis times the coefficient, plus a function of the
    /// other axes. `None` if the node has no such form.
    solved: [Option<f64>; 3],
    growth: Growth,
    /// The node's value, if it is a number.
    pub value: Option<f64>,
    /// How the node behaves along each axis, if it repeats apart from a slope.
    pub courses: [Option<Course>; 3],
}

/// The properties of all nodes that the function at `root` needs, for parameters within bounds.
pub fn shapes(graph: &Graph, root: NodeId, parameters: &[Interval]) -> Vec<NodeShape> {
    let needed = graph.reachable(&[root]);
    let number = |bounds: Interval| NodeShape {
        depends: [false; 3],
        linear: Some([0.0; 3]),
        is_of_planes: true,
        solved: [Some(0.0); 3],
        growth: Growth::Polynomial,
        value: Some(bounds.lo.midpoint(bounds.hi)),
        courses: [Some(CONSTANT); 3],
    };
    let mut known: Vec<NodeShape> = Vec::with_capacity(graph.len());
    for (id, node) in graph.iter() {
        known.push(match node {
            _ if !needed[id.index()] => number(Interval::ZERO),
            Node::Variable(axis) => {
                let unit = |k: usize| if k == *axis as usize { 1.0 } else { 0.0 };
                let linear = [unit(0), unit(1), unit(2)];
                NodeShape {
                    depends: linear.map(|factor| factor != 0.0),
                    linear: Some(linear),
                    solved: linear.map(Some),
                    value: None,
                    courses: linear.map(|slope| Some(Course { slope, ..CONSTANT })),
                    ..number(Interval::ZERO)
                }
            }
            Node::Parameter(at) => {
                number(parameters.get(*at as usize).copied().unwrap_or(Interval::ONE))
            }
            Node::Constant(value) => number(value.bounds()),
            Node::Apply(op, operands) => {
                let operands: Vec<NodeShape> =
                    operands.iter().map(|id| known[id.index()]).collect();
                combined(*op, &operands)
            }
        });
    }
    known
}

impl GraphShape {
    /// Returns whether the function's zero set is a graph over x and y.
    pub fn is_over_ground(&self) -> bool {
        self.graph.is_some_and(|graph| graph.up == 2)
    }

    /// The shape of the function at `root`, for parameters within bounds.
    pub fn of(graph: &Graph, root: NodeId, parameters: &[Interval]) -> Self {
        let (known, mut shape) = (shapes(graph, root, parameters), Self::default());
        let found = known[root.index()];
        shape.depends = found.depends;
        shape.growth = found.growth;
        shape.is_plane = found.linear.is_some();
        shape.is_of_planes = found.is_of_planes;
        // Graphs over the xy-plane are preferred.
        let is_of_two = found.depends != [true; 3];
        shape.graph = [2, 1, 0].into_iter().find_map(|up| {
            let factor = found.solved[up].filter(|factor| *factor != 0.0)?;
            let along = (0..3).find(|other| *other != up && found.depends[*other])?;
            (is_of_two || !shape.is_plane).then_some(GraphAxes {
                up,
                factor,
                along: is_of_two.then_some(along),
            })
        });
        shape.find_waves(graph, root, &known);
        shape
    }

    fn find_waves(&mut self, graph: &Graph, root: NodeId, known: &[NodeShape]) {
        let periods = known[root.index()].courses.map(Period::of);
        let (mut open, mut seen) = (vec![root], vec![false; graph.len()]);
        let (mut period, mut plain) = ([0.0_f64; 3], [false; 3]);
        while let Some(id) = open.pop() {
            if std::mem::replace(&mut seen[id.index()], true) {
                continue;
            }
            match graph.node(id) {
                Node::Variable(axis) => plain[*axis as usize] = true,
                Node::Parameter(_) | Node::Constant(_) => {}
                Node::Apply(op, operands) => {
                    let argument = known[operands[0].index()];
                    let waves = matches!(op, Op::Sin | Op::Cos | Op::Tan)
                        && argument.depends.contains(&true);
                    match argument.linear {
                        Some(linear) if waves => {
                            for (period, factor) in period.iter_mut().zip(linear) {
                                if factor != 0.0 {
                                    *period = period.max(TAU / factor.abs());
                                }
                            }
                        }
                        _ => {
                            if waves {
                                self.waves.push(operands[0]);
                            }
                            open.extend(operands.iter().copied());
                        }
                    }
                }
            }
        }
        for (axis, common) in periods.into_iter().enumerate() {
            let repeats = period[axis] > 0.0 && period[axis].is_finite() && !plain[axis];
            let longest = repeats.then_some(period[axis]);
            self.has_cells[axis] = common.is_some_and(|common| common.has_cells);
            self.period[axis] = match (common, longest) {
                (Some(common), _) if common.has_cells => Some(common.length),
                // Several waves have a common period, of which one is shown.
                (Some(common), Some(longest)) => Some(longest.max(common.length / 2.0)),
                (None | Some(_), longest) => longest,
            };
        }
    }
}

/// The properties of an operation, computed from the properties of its operands.
fn combined(op: Op, operands: &[NodeShape]) -> NodeShape {
    let depends = [0, 1, 2].map(|axis| operands.iter().any(|one| one.depends[axis]));
    let number = |k: usize| operands.get(k).and_then(|one| one.value);
    let value = number(0).and_then(|a| {
        if op == Op::Neg {
            Some(-a)
        } else if op == Op::Sqrt {
            Some(a.sqrt())
        } else if op == Op::Sqr {
            Some(a * a)
        } else {
            let b = number(1)?;
            let pairs = [(Op::Add, a + b), (Op::Sub, a - b), (Op::Mul, a * b), (Op::Div, a / b)];
            pairs.into_iter().find(|pair| pair.0 == op).map(|pair| pair.1)
        }
    });
    let each = |f: &dyn Fn(usize) -> Option<f64>| -> Option<Linear> { Some([f(0)?, f(1)?, f(2)?]) };
    let part = |k: usize, axis: usize| operands[k].linear.map(|linear| linear[axis]);
    let is_sum = op == Op::Add || op == Op::Sub;
    let scale = if op == Op::Mul {
        number(0).map(|factor| (factor, 1)).or(number(1).map(|factor| (factor, 0)))
    } else if op == Op::Div {
        number(1).map(|divisor| (1.0 / divisor, 0))
    } else {
        (op == Op::Neg).then_some((-1.0, 0))
    };
    let (linear, solved): (Option<Linear>, [Option<f64>; 3]) = if is_sum {
        let sign = if op == Op::Add { 1.0 } else { -1.0 };
        let sum = |a: Option<f64>, b: Option<f64>| Some(a? + sign * b?);
        let solved = [0, 1, 2].map(|axis| sum(operands[0].solved[axis], operands[1].solved[axis]));
        (each(&|axis| sum(part(0, axis), part(1, axis))), solved)
    } else if let Some((factor, k)) = scale {
        let scaled = |part: Option<f64>| part.map(|part| factor * part);
        (each(&|axis| scaled(part(k, axis))), operands[k].solved.map(scaled))
    } else if let Class::Restriction(_) = op.row().class {
        // A graph over part of the plane is a graph, if the condition does not depend on heights.
        let solved = |axis: usize| operands[0].solved[axis].filter(|_| !operands[1].depends[axis]);
        (None, [0, 1, 2].map(solved))
    } else {
        // The coefficient is 0 if the operation does not depend on the axis.
        (None, depends.map(|depends| (!depends).then_some(0.0)))
    };
    let is_built = if op == Op::Pow {
        number(1).is_some_and(|n| n.fract() == 0.0 && n >= 0.0)
    } else if op == Op::Div {
        number(1).is_some()
    } else {
        is_sum || [Op::Neg, Op::Mul, Op::Sqr].contains(&op) || !depends.contains(&true)
    };
    let own = if is_built {
        Growth::Polynomial
    } else if [Op::Sqrt, Op::Abs, Op::Min, Op::Max].contains(&op) {
        Growth::Power
    } else {
        Growth::Unlimited
    };
    let growth = operands.iter().map(|one| one.growth).fold(own, Growth::max);
    let linear = if depends.contains(&true) { linear } else { Some([0.0; 3]) };
    let is_product = [Op::Mul, Op::Neg, Op::Sqr, Op::Abs, Op::Min, Op::Max].contains(&op)
        || [Op::Pow, Op::Div].contains(&op) && number(1).is_some();
    let is_of_planes =
        linear.is_some() || is_product && operands.iter().all(|one| one.is_of_planes);
    let values: Vec<Option<f64>> = operands.iter().map(|one| one.value).collect();
    let courses = [0, 1, 2].map(|axis| {
        let operands: Option<Vec<_>> = operands.iter().map(|one| one.courses[axis]).collect();
        period::combined(op, &operands?, &values)
    });
    NodeShape { depends, linear, is_of_planes, solved, growth, value, courses }
}
