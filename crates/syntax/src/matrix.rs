//! Matrices of two to four rows, which are expanded to their elements as vectors are to their components.
//!
//! Elements are in the order of shaders: column by column. A matrix times a vector is a vector, and so is a vector times a
//! matrix, which is what `p.xz *= m` means there.

use crate::error::{Error, ErrorKind, Fallible};
use crate::lower::Lowering;
use crate::span::Span;
use crate::value::Value;
use zeroset_ir::NodeId;
use zeroset_ops::Op;

impl Lowering<'_> {
    /// A matrix made of its elements, of one number for the diagonal, or of another matrix.
    pub(crate) fn matrix(
        &mut self,
        size: usize,
        arguments: &[Value],
        span: Span,
    ) -> Fallible<Value> {
        let given: usize = arguments.iter().map(|value| value.parts().len()).sum();
        let source = match arguments {
            [Value::Number(node)] => vec![*node],
            [Value::Matrix(nodes)] => nodes.clone(),
            _ if given == size * size => {
                let nodes = arguments.iter().flat_map(|value| value.parts().iter().copied());
                return Ok(Value::Matrix(nodes.collect()));
            }
            _ => return Err(Error::new(span, ErrorKind::MatrixSize { size, given })),
        };
        let (zero, one) = (self.graph.integer(0), self.graph.integer(1));
        let known = if source.len() == 1 { 0 } else { source.len().isqrt() };
        let element = |index: usize| {
            let (column, row) = (index / size, index % size);
            match (column == row, column.max(row) < known) {
                (_, true) => source[column * known + row],
                (true, false) if known == 0 => source[0],
                (true, false) => one,
                (false, false) => zero,
            }
        };
        Ok(Value::Matrix((0..size * size).map(element).collect()))
    }

    /// An operation of which an operand is a matrix.
    pub(crate) fn of_matrices(
        &mut self,
        op: Op,
        operands: &[Value],
        span: Span,
    ) -> Fallible<Value> {
        let refused = || Error::new(span, ErrorKind::Matrix);
        let [left, right] = operands else { return Err(refused()) };
        let is_product = op == Op::Mul;
        match (left, right) {
            (Value::Matrix(a), Value::Matrix(b)) if is_product && a.len() == b.len() => {
                let n = a.len().isqrt();
                let columns = b.chunks(n).flat_map(|column| self.times(a, column));
                Ok(Value::Matrix(columns.collect()))
            }
            (Value::Matrix(a), Value::Vector(v)) if is_product && a.len().isqrt() == v.len() => {
                Ok(Value::Vector(self.times(a, v)))
            }
            (Value::Vector(v), Value::Matrix(b)) if is_product && b.len().isqrt() == v.len() => {
                let columns = b.chunks(v.len()).map(|column| self.products(v, column));
                Ok(Value::Vector(columns.collect()))
            }
            (Value::Matrix(a), Value::Matrix(b))
                if matches!(op, Op::Add | Op::Sub) && a.len() == b.len() =>
            {
                let nodes = a.iter().zip(b).map(|(a, b)| self.graph.apply(op, &[*a, *b]));
                Ok(Value::Matrix(nodes.collect()))
            }
            (Value::Matrix(a), Value::Number(b)) if is_product || op == Op::Div => {
                let nodes = a.iter().map(|a| self.graph.apply(op, &[*a, *b]));
                Ok(Value::Matrix(nodes.collect()))
            }
            (Value::Number(a), Value::Matrix(b)) if is_product => {
                let nodes = b.iter().map(|b| self.graph.apply(op, &[*a, *b]));
                Ok(Value::Matrix(nodes.collect()))
            }
            _ => Err(refused()),
        }
    }

    /// A matrix times a vector of as many components.
    fn times(&mut self, matrix: &[NodeId], vector: &[NodeId]) -> Vec<NodeId> {
        let n = vector.len();
        let row = |row: usize| matrix.iter().skip(row).step_by(n).copied().collect::<Vec<_>>();
        (0..n).map(|index| self.products(&row(index), vector)).collect()
    }

    /// The sum of products of what stands at the same place.
    fn products(&mut self, left: &[NodeId], right: &[NodeId]) -> NodeId {
        let products: Vec<NodeId> =
            left.iter().zip(right).map(|(a, b)| self.graph.apply(Op::Mul, &[*a, *b])).collect();
        self.fold(Op::Add, &products)
    }

    /// A matrix with rows and columns exchanged.
    pub(crate) fn transpose(value: &Value, span: Span) -> Fallible<Value> {
        let Value::Matrix(nodes) = value else {
            return Err(Error::new(span, ErrorKind::NotAMatrix));
        };
        let n = nodes.len().isqrt();
        Ok(Value::Matrix((0..n * n).map(|at| nodes[at % n * n + at / n]).collect()))
    }

    /// The determinant, by its first column.
    pub(crate) fn determinant(&mut self, value: &Value, span: Span) -> Fallible<NodeId> {
        match value {
            Value::Matrix(nodes) => Ok(self.minor(nodes)),
            _ => Err(Error::new(span, ErrorKind::NotAMatrix)),
        }
    }

    /// The determinant of a matrix of 1, 4, 9 or 16 elements.
    fn minor(&mut self, nodes: &[NodeId]) -> NodeId {
        if let [only] = nodes {
            return *only;
        }
        let n = nodes.len().isqrt();
        let mut sum = None;
        for row in 0..n {
            let rest: Vec<NodeId> =
                (n..n * n).filter(|at| at % n != row).map(|at| nodes[at]).collect();
            let smaller = self.minor(&rest);
            let term = self.graph.apply(Op::Mul, &[nodes[row], smaller]);
            sum = Some(match sum {
                None => term,
                Some(sum) => {
                    self.graph.apply(if row % 2 == 0 { Op::Add } else { Op::Sub }, &[sum, term])
                }
            });
        }
        sum.unwrap_or(nodes[0])
    }
}
