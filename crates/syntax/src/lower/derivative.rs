//! Derivatives, and functions of derivatives: gradients, curvatures, true offsets.
//!
//! The rules are the graph's own. A derivative is defined where its function is defined and the
//! rules' intermediate results exist. Jumps contribute nothing to it.

use crate::lower::condition::extend_total;
use crate::lower::lowering::{Locals, Lowering, NameBinding};
use crate::lower::value::{Tensor, numbers};
use rustc_hash::FxHashMap;
use zeroset_ir::{Axis, Node, NodeId, derivative, substitute};
use zeroset_ops::{Differential, Op};
use zeroset_parser::tree::ast::{Expr, Function, NamedValue};
use zeroset_parser::{Error, ErrorKind, Fallible, Span};

/// Variables of differentiation are parameters from this number on. The parameters of a document,
/// and the placeholders of moved solids, have lower numbers.
const FIRST_VARIABLE: u32 = 3 << 30;

impl<'a> Lowering<'a> {
    /// The derivative of `body` by the variables `by`, one after the other.
    #[inline(never)]
    pub(crate) fn differentiated(
        &mut self,
        by: &[NamedValue],
        body: &'a Expr,
        span: Span,
        locals: &Locals<'a>,
    ) -> Fallible<Tensor> {
        let mut inner = locals.to_vec();
        // A parameter of a function stands for a value, so a variable takes its place.
        let mut replaced: Vec<(NodeId, NodeId)> = Vec::new();
        let mut leaves = Vec::new();
        for variable in by {
            leaves.push(match variable {
                NamedValue::Coordinate(axis) if !self.is_constant => self.graph.variable(*axis),
                NamedValue::Time if let Some(number) = self.time => self.graph.parameter(number),
                NamedValue::Local(name) => {
                    let at = inner.iter().rposition(|(local, _)| local == name);
                    let Some(at) = at else { return Err(no_variable(variable, span)) };
                    let value = numbers(std::slice::from_ref(&inner[at].1), span)?[0];
                    if replaced.iter().any(|(leaf, _)| *leaf == value) {
                        value
                    } else {
                        let leaf = self.unused_variable(inner.iter().map(|(_, value)| value));
                        inner[at].1 = Tensor::Number(leaf);
                        replaced.push((leaf, value));
                        leaf
                    }
                }
                NamedValue::Defined(name) => match self.names.get(name.as_str()) {
                    Some(NameBinding::Parameter(number)) => self.graph.parameter(*number),
                    _ => return Err(no_variable(variable, span)),
                },
                NamedValue::Coordinate(_)
                | NamedValue::Time
                | NamedValue::Constant(_)
                | NamedValue::ImaginaryUnit => return Err(no_variable(variable, span)),
            });
        }
        let value = self.value_of(body, &inner)?;
        let derived = self.by_component(&[value], span, |all, parts| {
            leaves.iter().try_fold(parts[0], |node, leaf| all.derivative(node, *leaf, span))
        })?;
        self.by_component(&[derived], span, |all, parts| {
            let back = |node, (leaf, value): &(NodeId, NodeId)| {
                substitute(&mut all.graph, node, *leaf, *value)
            };
            Ok(replaced.iter().fold(parts[0], back))
        })
    }

    /// The derivative of a function of one argument, at a number.
    pub(crate) fn derived(
        &mut self,
        function: &Function,
        order: u8,
        argument: &Tensor,
        span: Span,
    ) -> Fallible<Tensor> {
        let leaf = self.unused_variable(std::iter::once(argument));
        let value = self.call(function, vec![Tensor::Number(leaf)], span)?;
        if argument.is_complex() {
            let node = numbers(&[value], span)?[0];
            let derived = (0..order).try_fold(node, |node, _| self.derivative(node, leaf, span))?;
            return self.with_complex(derived, leaf, argument, span);
        }
        let at = numbers(std::slice::from_ref(argument), span)?[0];
        self.by_component(&[value], span, |all, parts| {
            let derived =
                (0..order).try_fold(parts[0], |node, _| all.derivative(node, leaf, span))?;
            Ok(substitute(&mut all.graph, derived, leaf, at))
        })
    }

    /// The value of `root` with a complex number in place of `leaf`.
    fn with_complex(
        &mut self,
        root: NodeId,
        leaf: NodeId,
        value: &Tensor,
        span: Span,
    ) -> Fallible<Tensor> {
        let mut values: FxHashMap<NodeId, Tensor> = FxHashMap::from_iter([(leaf, value.clone())]);
        for id in self.graph.needed(&[root]) {
            let Node::Apply(op, operands) = *self.graph.node(id) else { continue };
            let number = |node: &NodeId| values.get(node).cloned().unwrap_or(Tensor::Number(*node));
            let operands: Vec<Tensor> = operands.iter().map(number).collect();
            let applied = match (op, operands.as_slice()) {
                (_, operands) if !operands.iter().any(Tensor::is_complex) => continue,
                // A function of complex numbers is undefined where its formula is.
                (Op::WhereDefined, [value, _]) => value.clone(),
                (op, operands) => self.native(op, operands, span)?,
            };
            values.insert(id, applied);
        }
        Ok(values.remove(&root).unwrap_or(Tensor::Number(root)))
    }

    /// Applies a function of derivatives to a number.
    pub(crate) fn of_derivatives(
        &mut self,
        function: Differential,
        arguments: &[Tensor],
        span: Span,
    ) -> Fallible<Tensor> {
        let node = numbers(arguments, span)?[0];
        let gradient = self.gradient(node, span)?;
        match function {
            Differential::Gradient => Ok(Tensor::Vector(gradient.to_vec())),
            Differential::Laplacian => self.divergence(gradient, span).map(Tensor::Number),
            Differential::MeanCurvature => {
                let length = self.length(&gradient);
                let normal = gradient.map(|part| self.graph.apply(Op::Div, &[part, length]));
                let divergence = self.divergence(normal, span)?;
                let two = self.graph.integer(2);
                Ok(Tensor::Number(self.graph.apply(Op::Div, &[divergence, two])))
            }
            Differential::GaussianCurvature => {
                let rows = [0, 1, 2].map(|row| self.gradient(gradient[row], span));
                let [x, y, z] = rows;
                Ok(Tensor::Number(self.gaussian_curvature(gradient, [x?, y?, z?])))
            }
        }
    }

    /// A function with the same zeros whose value is the distance from them, to first order: the
    /// quotient of `node` and the length of its gradient.
    pub(crate) fn as_distance(&mut self, node: NodeId, span: Span) -> Fallible<NodeId> {
        let gradient = self.gradient(node, span)?;
        let length = self.length(&gradient);
        Ok(self.graph.apply(Op::Div, &[node, length]))
    }

    /// The Gaussian curvature: the product of the gradient, the adjugate of the Hessian matrix and
    /// the gradient, divided by the fourth power of the gradient's length.
    fn gaussian_curvature(&mut self, gradient: [NodeId; 3], hessian: [[NodeId; 3]; 3]) -> NodeId {
        let mut terms = Vec::new();
        for (i, row) in hessian.iter().enumerate() {
            for j in 0..row.len() {
                let at = |i: usize, j: usize| hessian[i % 3][j % 3];
                let product = |all: &mut Self, a, b| all.graph.apply(Op::Mul, &[a, b]);
                let first = product(self, at(i + 1, j + 1), at(i + 2, j + 2));
                let second = product(self, at(i + 1, j + 2), at(i + 2, j + 1));
                let cofactor = self.graph.apply(Op::Sub, &[first, second]);
                let both = product(self, gradient[i], gradient[j]);
                terms.push(product(self, both, cofactor));
            }
        }
        let sum = self.fold(Op::Add, &terms);
        let squares = self.squares(&gradient);
        let two = self.graph.integer(2);
        let fourth = self.graph.apply(Op::Pow, &[squares, two]);
        self.graph.apply(Op::Div, &[sum, fourth])
    }

    /// The derivatives of a node by x, y and z.
    fn gradient(&mut self, node: NodeId, span: Span) -> Fallible<[NodeId; 3]> {
        let [x, y, z] = Axis::ALL.map(|axis| {
            let leaf = self.graph.variable(axis);
            self.derivative(node, leaf, span)
        });
        Ok([x?, y?, z?])
    }

    /// The sum of the derivatives of the parts, each by its own coordinate.
    fn divergence(&mut self, parts: [NodeId; 3], span: Span) -> Fallible<NodeId> {
        let mut all = Vec::new();
        for (part, axis) in parts.into_iter().zip(Axis::ALL) {
            let leaf = self.graph.variable(axis);
            all.push(self.derivative(part, leaf, span)?);
        }
        Ok(self.fold(Op::Add, &all))
    }

    /// The derivative of a node, defined only where the node is.
    fn derivative(&mut self, node: NodeId, leaf: NodeId, span: Span) -> Fallible<NodeId> {
        let node = self.in_place(node, span)?;
        let derived = derivative(&mut self.graph, node, leaf);
        self.check_size(span)?;
        extend_total(&self.graph, &mut self.total, &self.moves);
        if self.total[node.index()] {
            return Ok(derived);
        }
        Ok(self.graph.apply(Op::WhereDefined, &[derived, node]))
    }

    /// A variable of differentiation that none of the values depends on.
    fn unused_variable<'t>(&mut self, values: impl Iterator<Item = &'t Tensor>) -> NodeId {
        let nodes: Vec<NodeId> = values.flat_map(Tensor::parts).copied().collect();
        let used = self.graph.needed(&nodes);
        self.has_variables = true;
        let mut number = FIRST_VARIABLE;
        loop {
            let leaf = self.graph.parameter(number);
            if used.binary_search(&leaf).is_err() {
                return leaf;
            }
            number += 1;
        }
    }
}

fn no_variable(value: &NamedValue, span: Span) -> Box<Error> {
    Error::new(span, ErrorKind::NotAVariable { name: value.name().to_owned() })
}
