//! Matrices of two to four rows. A matrix is expanded to its elements, as a vector is.
//!
//! Elements are stored column by column, as in shaders. A matrix times a vector is a vector. A
//! vector times a matrix is a vector too, which is the meaning of `p.xz *= m` in shaders.

use crate::lower::lowering::Lowering;
use crate::lower::value::Tensor;
use zeroset_ir::NodeId;
use zeroset_ops::Op;
use zeroset_parser::{Error, ErrorKind, Fallible, Span};

impl Lowering<'_> {
    /// Creates a matrix from its elements, from a number for the diagonal, or from another matrix.
    pub(crate) fn matrix(
        &mut self,
        size: usize,
        arguments: &[Tensor],
        span: Span,
    ) -> Fallible<Tensor> {
        if arguments.iter().any(Tensor::is_complex) {
            return Err(Error::new(span, ErrorKind::ComplexAmongVectors));
        }
        let source: Vec<NodeId> = arguments.iter().flat_map(Tensor::parts).copied().collect();
        if !matches!(arguments, [Tensor::Number(_) | Tensor::Matrix(_)]) {
            let given = source.len();
            if given != size * size {
                return Err(Error::new(span, ErrorKind::MatrixSize { size, given }));
            }
            return Ok(Tensor::Matrix(source));
        }
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
        Ok(Tensor::Matrix((0..size * size).map(element).collect()))
    }

    /// Applies an operation to operands, at least one of which is a matrix.
    pub(crate) fn of_matrices(
        &mut self,
        op: Op,
        operands: &[Tensor],
        span: Span,
    ) -> Fallible<Tensor> {
        if op == Op::Mul
            && let [left, right] = operands
            && let Some(product) = self.product(left, right)
        {
            return Ok(product);
        }
        let is_by_element = match operands {
            [Tensor::Matrix(a), Tensor::Matrix(b)] => {
                matches!(op, Op::Add | Op::Sub) && a.len() == b.len()
            }
            [Tensor::Matrix(_), Tensor::Number(_)] => matches!(op, Op::Mul | Op::Div),
            [Tensor::Number(_), Tensor::Matrix(_)] => op == Op::Mul,
            _ => false,
        };
        if !is_by_element {
            return Err(Error::new(span, ErrorKind::Matrix));
        }
        self.by_component(operands, span, |all, parts| Ok(all.graph.apply(op, parts)))
    }

    /// The product of two matrices, or of a matrix and a vector; `None` if their sizes do not fit.
    fn product(&mut self, left: &Tensor, right: &Tensor) -> Option<Tensor> {
        let n = match (left, right) {
            (Tensor::Matrix(a), Tensor::Matrix(b)) if a.len() == b.len() => a.len().isqrt(),
            (Tensor::Matrix(m), Tensor::Vector(v)) | (Tensor::Vector(v), Tensor::Matrix(m))
                if m.len().isqrt() == v.len() =>
            {
                v.len()
            }
            _ => return None,
        };
        let rows = match left {
            Tensor::Matrix(nodes) => Self::transposed(nodes),
            _ => left.parts().to_vec(),
        };
        let mut nodes = Vec::new();
        for column in right.parts().chunks(n) {
            nodes.extend(rows.chunks(n).map(|row| self.products(row, column)));
        }
        Some(if nodes.len() == n { Tensor::Vector(nodes) } else { Tensor::Matrix(nodes) })
    }

    /// The scalar product of two lists of numbers.
    fn products(&mut self, left: &[NodeId], right: &[NodeId]) -> NodeId {
        let products: Vec<NodeId> =
            left.iter().zip(right).map(|(a, b)| self.graph.apply(Op::Mul, &[*a, *b])).collect();
        self.fold(Op::Add, &products)
    }

    /// The determinant of a matrix of 1, 4, 9 or 16 elements, expanded along its first column.
    pub(crate) fn determinant(&mut self, nodes: &[NodeId]) -> NodeId {
        if let [only] = nodes {
            return *only;
        }
        let n = nodes.len().isqrt();
        let mut sum = None;
        for row in 0..n {
            let rest: Vec<NodeId> =
                (n..n * n).filter(|at| at % n != row).map(|at| nodes[at]).collect();
            let smaller = self.determinant(&rest);
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

    /// The elements of the transposed matrix.
    pub(crate) fn transposed(nodes: &[NodeId]) -> Vec<NodeId> {
        let n = nodes.len().isqrt();
        (0..n * n).map(|at| nodes[at % n * n + at / n]).collect()
    }
}
