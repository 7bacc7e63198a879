//! Expands vectors to their components, because the graph knows numbers only.
//!
//! Operations on vectors apply component by component. A number beside a vector is used for each
//! component. Functions that mix components have names: `length`, `dot`, `cross`, `normalize`.

use crate::lower::complex::parts;
use crate::lower::lowering::Lowering;
use zeroset_ir::NodeId;
use zeroset_ops::{Op, VectorFunction};
use zeroset_parser::tree::ast::LETTERS;
use zeroset_parser::{Error, ErrorKind, Fallible, Note, NoteKind, Span};

/// Value of an expression. Each component is a node of the graph.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Tensor {
    Number(NodeId),
    /// Two to four components of a vector.
    Vector(Vec<NodeId>),
    /// The elements of a square matrix, column by column.
    Matrix(Vec<NodeId>),
    /// The two components of a complex number or the four of a quaternion, the real one first.
    Complex(Vec<NodeId>),
}

impl Tensor {
    fn size(&self) -> usize {
        self.parts().len()
    }

    /// The component at `index`, which must be in range. For a number, returns the number itself.
    fn part(&self, index: usize) -> NodeId {
        match self {
            Self::Number(node) => *node,
            Self::Vector(nodes) | Self::Matrix(nodes) | Self::Complex(nodes) => nodes[index],
        }
    }

    /// All components or elements. A number counts as a single component.
    pub(crate) fn parts(&self) -> &[NodeId] {
        match self {
            Self::Number(node) => std::slice::from_ref(node),
            Self::Vector(nodes) | Self::Matrix(nodes) | Self::Complex(nodes) => nodes,
        }
    }

    /// The elements of a matrix. Fails for a number or a vector.
    fn elements(&self, span: Span) -> Fallible<&[NodeId]> {
        match self {
            Self::Matrix(nodes) => Ok(nodes),
            Self::Number(_) | Self::Vector(_) | Self::Complex(_) => {
                Err(Error::new(span, ErrorKind::NotAMatrix))
            }
        }
    }

    pub(crate) fn is_complex(&self) -> bool {
        matches!(self, Self::Complex(_))
    }

    fn is_matrix(&self) -> bool {
        matches!(self, Self::Matrix(_))
    }

    fn new(mut nodes: Vec<NodeId>) -> Self {
        if nodes.len() == 1 { Self::Number(nodes.remove(0)) } else { Self::Vector(nodes) }
    }
}

/// The nodes of `values`. Fails unless all values are numbers.
pub(crate) fn numbers(values: &[Tensor], span: Span) -> Fallible<Vec<NodeId>> {
    let node = |value: &Tensor| match value {
        Tensor::Number(node) => Ok(*node),
        Tensor::Vector(_) | Tensor::Matrix(_) => Err(Error::new(span, ErrorKind::Vector)),
        Tensor::Complex(_) => Err(Error::new(span, ErrorKind::Complex)),
    };
    values.iter().map(node).collect()
}

impl Lowering<'_> {
    /// Calls `apply` for each index, on the components with that index. Collects the results.
    pub(crate) fn by_component(
        &mut self,
        operands: &[Tensor],
        span: Span,
        mut apply: impl FnMut(&mut Self, &[NodeId]) -> Fallible<NodeId>,
    ) -> Fallible<Tensor> {
        let is_complex = operands.iter().any(Tensor::is_complex);
        let promoted = is_complex.then(|| self.all_complex(operands, span)).transpose()?;
        let operands = promoted.as_deref().unwrap_or(operands);
        let size = common_size(operands, span)?;
        let mut nodes = Vec::with_capacity(size);
        for index in 0..size {
            let parts: Vec<NodeId> = operands.iter().map(|value| value.part(index)).collect();
            nodes.push(apply(self, &parts)?);
        }
        let has_matrix = operands.iter().any(Tensor::is_matrix);
        Ok(match (is_complex, has_matrix) {
            (true, _) => Tensor::Complex(nodes),
            (false, true) => Tensor::Matrix(nodes),
            (false, false) => Tensor::new(nodes),
        })
    }

    /// Applies an operation component by component. With complex numbers or matrices, their rules
    /// apply.
    pub(crate) fn native(&mut self, op: Op, operands: &[Tensor], span: Span) -> Fallible<Tensor> {
        if operands.iter().any(Tensor::is_complex) {
            return self.of_complex(op, operands, span);
        }
        if operands.iter().any(Tensor::is_matrix) {
            return self.of_matrices(op, operands, span);
        }
        self.by_component(operands, span, |all, parts| Ok(all.graph.apply(op, parts)))
    }

    /// Adds a note that a product of two vectors is not a scalar product, if no notes exist yet.
    pub(crate) fn note_product(&mut self, op: Op, left: &Tensor, right: &Tensor, span: Span) {
        let is_vector = |value: &Tensor| matches!(value, Tensor::Vector(_));
        let are_vectors = is_vector(left) && is_vector(right);
        if op == Op::Mul && are_vectors && self.notes.is_empty() {
            self.notes.push(Note { span, kind: NoteKind::ProductOfVectors });
        }
    }

    /// The length of a vector: the square root of the sum of squares.
    pub(crate) fn length(&mut self, nodes: &[NodeId]) -> NodeId {
        let sum = self.squares(nodes);
        self.graph.apply(Op::Sqrt, &[sum])
    }

    /// The sum of squares.
    pub(crate) fn squares(&mut self, nodes: &[NodeId]) -> NodeId {
        let two = self.graph.integer(2);
        let squares: Vec<NodeId> =
            nodes.iter().map(|node| self.graph.apply(Op::Pow, &[*node, two])).collect();
        self.fold(Op::Add, &squares)
    }

    /// Applies a function that mixes the components of vectors.
    pub(crate) fn of_vectors(
        &mut self,
        function: VectorFunction,
        arguments: &[Tensor],
        span: Span,
    ) -> Fallible<Tensor> {
        match function {
            VectorFunction::Complex | VectorFunction::Quaternion => {
                numbers(arguments, span).map(Tensor::Complex)
            }
            VectorFunction::RealPart => Ok(Tensor::Number(parts(&arguments[0], span)?[0])),
            VectorFunction::ImaginaryPart => self.imaginary_part(&arguments[0], span),
            VectorFunction::Argument => self.angle(&arguments[0], span),
            VectorFunction::Conjugate => self.conjugate(&arguments[0], span),
            VectorFunction::Transpose => {
                Ok(Tensor::Matrix(Self::transposed(arguments[0].elements(span)?)))
            }
            VectorFunction::Determinant => {
                Ok(Tensor::Number(self.determinant(arguments[0].elements(span)?)))
            }
            // In numpy and Mathematica, `dot` is also the product of matrices.
            VectorFunction::Dot if arguments.iter().any(Tensor::is_matrix) => {
                self.of_matrices(Op::Mul, arguments, span)
            }
            VectorFunction::Dot => self.dot(&arguments[0], &arguments[1], span).map(Tensor::Number),
            VectorFunction::Normalize => {
                let length = self.length(arguments[0].parts());
                self.native(Op::Div, &[arguments[0].clone(), Tensor::Number(length)], span)
            }
            VectorFunction::Distance => {
                let difference = self.native(Op::Sub, arguments, span)?;
                Ok(Tensor::Number(self.length(difference.parts())))
            }
            VectorFunction::Reflect => {
                let dot = self.dot(&arguments[0], &arguments[1], span)?;
                let two = self.graph.integer(2);
                let twice = Tensor::Number(self.graph.apply(Op::Mul, &[two, dot]));
                let along = self.native(Op::Mul, &[twice, arguments[1].clone()], span)?;
                self.native(Op::Sub, &[arguments[0].clone(), along], span)
            }
            VectorFunction::Cross => {
                let (a @ [_, _, _], b @ [_, _, _]) = (arguments[0].parts(), arguments[1].parts())
                else {
                    return Err(Error::new(span, ErrorKind::CrossSize));
                };
                let mut part = |i: usize, j: usize| {
                    let first = self.graph.apply(Op::Mul, &[a[i], b[j]]);
                    let second = self.graph.apply(Op::Mul, &[a[j], b[i]]);
                    self.graph.apply(Op::Sub, &[first, second])
                };
                Ok(Tensor::Vector(vec![part(1, 2), part(2, 0), part(0, 1)]))
            }
        }
    }

    pub(crate) fn dot(&mut self, left: &Tensor, right: &Tensor, span: Span) -> Fallible<NodeId> {
        if left.is_complex() || right.is_complex() {
            return Err(Error::new(span, ErrorKind::ComplexAmongVectors));
        }
        let products = self.native(Op::Mul, &[left.clone(), right.clone()], span)?;
        Ok(self.fold(Op::Add, products.parts()))
    }
}

/// A vector of `size` components from arguments with `size` components in total, from one number,
/// or from the first components of one longer vector.
pub(crate) fn vector(size: usize, arguments: &[Tensor], span: Span) -> Fallible<Tensor> {
    if arguments.iter().any(Tensor::is_complex) {
        return Err(Error::new(span, ErrorKind::ComplexAmongVectors));
    }
    let mut nodes: Vec<NodeId> = arguments.iter().flat_map(Tensor::parts).copied().collect();
    let given = nodes.len();
    // `vec2(p)` takes the first two components of a longer vector `p`.
    let is_cut = arguments.len() == 1 && given > size;
    if given != size && given != 1 && !is_cut {
        return Err(Error::new(span, ErrorKind::VectorSize { size, given }));
    }
    nodes.resize(size, nodes[0]);
    Ok(Tensor::new(nodes))
}

/// The components of a vector that `letters` name. For a matrix, one letter names a column.
pub(crate) fn component(value: Tensor, letters: &str, span: Span) -> Fallible<Tensor> {
    if let (Tensor::Matrix(nodes), Some(column)) = (&value, LETTERS.find(letters)) {
        let rows = nodes.len().isqrt();
        if letters.len() == 1 && (column + 1) * rows <= nodes.len() {
            return Ok(Tensor::Vector(nodes[column * rows..(column + 1) * rows].to_vec()));
        }
    }
    let Tensor::Vector(nodes) = value else {
        let letters = letters.to_owned();
        return Err(Error::new(span, ErrorKind::ComponentOfNumber { letters }));
    };
    let mut found = Vec::with_capacity(letters.len());
    for letter in letters.chars() {
        let Some(node) = LETTERS.find(letter).and_then(|index| nodes.get(index)) else {
            let kind = ErrorKind::NoComponent { letter, size: nodes.len() };
            return Err(Error::new(span, kind));
        };
        found.push(*node);
    }
    Ok(Tensor::new(found))
}

/// The number of components that all operands have. A number fits a vector of any size.
fn common_size(operands: &[Tensor], span: Span) -> Fallible<usize> {
    let mut size = 1;
    if operands.iter().any(Tensor::is_matrix)
        && operands.iter().any(|value| value.size() > 1 && !value.is_matrix())
    {
        return Err(Error::new(span, ErrorKind::Matrix));
    }
    for operand in operands {
        match (size, operand.size()) {
            (_, 1) => {}
            (1, given) => size = given,
            (size, given) if size == given => {}
            (first, second) => {
                return Err(Error::new(span, ErrorKind::VectorSizes { first, second }));
            }
        }
    }
    Ok(size)
}
