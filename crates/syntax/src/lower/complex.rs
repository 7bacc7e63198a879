//! Complex numbers and quaternions, expanded to their real components.
//!
//! A complex number has two components, and a quaternion four, the real one first. The functions of
//! a complex number are formulas in the column `complex` of the table of operations.

use crate::lower::choice::integer_of;
use crate::lower::constant::values;
use crate::lower::lowering::Lowering;
use crate::lower::prelude;
use crate::lower::value::Tensor;
use zeroset_ir::{Constant, NamedConstant, NodeId};
use zeroset_ops::Op;
use zeroset_parser::tree::ast::Function;
use zeroset_parser::{Error, ErrorKind, Fallible, Span};

/// Largest exponent of a power that is written as products.
const MAX_EXPONENT: u64 = 1000;

impl Lowering<'_> {
    /// Applies an operation to operands, at least one of which is a complex number or a quaternion.
    pub(crate) fn of_complex(
        &mut self,
        op: Op,
        operands: &[Tensor],
        span: Span,
    ) -> Fallible<Tensor> {
        match (op, operands) {
            (Op::Add | Op::Sub | Op::Neg, _) => {
                self.by_component(operands, span, |all, parts| Ok(all.graph.apply(op, parts)))
            }
            (Op::Mul, [Tensor::Number(factor), other] | [other, Tensor::Number(factor)]) => {
                let scaled = |part: &NodeId| self.graph.apply(Op::Mul, &[*factor, *part]);
                Ok(Tensor::Complex(parts(other, span)?.iter().map(scaled).collect()))
            }
            (Op::Mul, [left, right]) => self.complex_product(left, right, span),
            (Op::Div, [left, Tensor::Number(divisor)]) => {
                let divided = |part: &NodeId| self.graph.apply(Op::Div, &[*part, *divisor]);
                Ok(Tensor::Complex(parts(left, span)?.iter().map(divided).collect()))
            }
            (Op::Div, [left, right]) => {
                let norm = self.squares(parts(right, span)?);
                let conjugate = self.conjugate(right, span)?;
                let product = self.native(Op::Mul, &[left.clone(), conjugate], span)?;
                self.native(Op::Div, &[product, Tensor::Number(norm)], span)
            }
            (Op::Pow, [base, exponent]) => self.complex_power(base, exponent, span),
            (Op::Abs, [value]) => Ok(Tensor::Number(self.length(parts(value, span)?))),
            (_, [value]) => self.complex_function(op, value.clone(), span),
            _ => Err(no_function(op, span)),
        }
    }

    /// The imaginary part of a complex number, or the vector of a quaternion's three imaginary
    /// parts.
    pub(crate) fn imaginary_part(&mut self, value: &Tensor, span: Span) -> Fallible<Tensor> {
        Ok(match *self.promoted(value, 2, span)? {
            [_, imaginary] => Tensor::Number(imaginary),
            ref all => Tensor::Vector(all[1..].to_vec()),
        })
    }

    /// The angle of a complex number.
    pub(crate) fn angle(&mut self, value: &Tensor, span: Span) -> Fallible<Tensor> {
        match *self.promoted(value, 2, span)? {
            [x, y] => Ok(Tensor::Number(self.graph.apply(Op::Atan2, &[y, x]))),
            _ => Err(Error::new(span, ErrorKind::QuaternionFunction { name: "arg" })),
        }
    }

    /// The real part of a complex number or a quaternion. Fails unless all imaginary parts are 0
    /// everywhere.
    pub(crate) fn real_part(&self, parts: &[NodeId], span: Span) -> Fallible<NodeId> {
        let imaginary = values(&self.graph, &parts[1..]);
        let is_real = imaginary.iter().all(|part| part.as_ref().is_some_and(Constant::is_zero));
        if is_real { Ok(parts[0]) } else { Err(Error::new(span, ErrorKind::Complex)) }
    }

    /// The components of a value, with zeros up to `size` components.
    fn promoted(&mut self, value: &Tensor, size: usize, span: Span) -> Fallible<Vec<NodeId>> {
        let mut all = parts(value, span)?.to_vec();
        all.resize(size.max(all.len()), self.graph.integer(0));
        Ok(all)
    }

    /// Gives all operands as many components as the longest one has.
    pub(crate) fn all_complex(&mut self, operands: &[Tensor], span: Span) -> Fallible<Vec<Tensor>> {
        let size = operands.iter().map(|value| value.parts().len()).max().unwrap_or(0);
        let promoted = |value| Ok(Tensor::Complex(self.promoted(value, size, span)?));
        operands.iter().map(promoted).collect()
    }

    pub(crate) fn conjugate(&mut self, value: &Tensor, span: Span) -> Fallible<Tensor> {
        let (real, imaginary) = match parts(value, span)? {
            [_] | [] => return Ok(value.clone()),
            [real, imaginary @ ..] => (*real, imaginary),
        };
        let opposite = imaginary.iter().map(|part| self.graph.apply(Op::Neg, &[*part]));
        Ok(Tensor::Complex(std::iter::once(real).chain(opposite).collect()))
    }

    fn complex_product(&mut self, left: &Tensor, right: &Tensor, span: Span) -> Fallible<Tensor> {
        let both = self.all_complex(&[left.clone(), right.clone()], span)?;
        let (a, b) = (both[0].parts(), both[1].parts());
        let term = |all: &mut Self, i: usize, j: usize| all.graph.apply(Op::Mul, &[a[i], b[j]]);
        // For each component of the product: the pairs of components that it takes, and signs.
        let table: &[&[(usize, usize, Op)]] = if a.len() == 2 {
            &[&[(0, 0, Op::Add), (1, 1, Op::Sub)], &[(0, 1, Op::Add), (1, 0, Op::Add)]]
        } else {
            &[
                &[(0, 0, Op::Add), (1, 1, Op::Sub), (2, 2, Op::Sub), (3, 3, Op::Sub)],
                &[(0, 1, Op::Add), (1, 0, Op::Add), (2, 3, Op::Add), (3, 2, Op::Sub)],
                &[(0, 2, Op::Add), (2, 0, Op::Add), (3, 1, Op::Add), (1, 3, Op::Sub)],
                &[(0, 3, Op::Add), (3, 0, Op::Add), (1, 2, Op::Add), (2, 1, Op::Sub)],
            ]
        };
        let mut product = Vec::new();
        for terms in table {
            let mut sum = term(self, terms[0].0, terms[0].1);
            for (i, j, sign) in &terms[1..] {
                let next = term(self, *i, *j);
                sum = self.graph.apply(*sign, &[sum, next]);
            }
            product.push(sum);
        }
        Ok(Tensor::Complex(product))
    }

    /// The square of a complex number or quaternion. Each product of two different components is
    /// computed once.
    fn complex_square(&mut self, value: &Tensor, span: Span) -> Fallible<Tensor> {
        let parts = parts(value, span)?.to_vec();
        let (two, real) = (self.graph.integer(2), parts[0]);
        let real_square = self.graph.apply(Op::Pow, &[real, two]);
        let rest = self.squares(&parts[1..]);
        let mut square = vec![self.graph.apply(Op::Sub, &[real_square, rest])];
        let twice = self.graph.apply(Op::Mul, &[two, real]);
        square.extend(parts[1..].iter().map(|part| self.graph.apply(Op::Mul, &[twice, *part])));
        Ok(Tensor::Complex(square))
    }

    fn complex_power(&mut self, base: &Tensor, exponent: &Tensor, span: Span) -> Fallible<Tensor> {
        let Tensor::Number(power) = exponent else {
            let logarithm = match base {
                Tensor::Number(base) => self.logarithm(*base, span)?,
                _ => self.native(Op::Ln, std::slice::from_ref(base), span)?,
            };
            let product = self.native(Op::Mul, &[exponent.clone(), logarithm], span)?;
            return self.native(Op::Exp, &[product], span);
        };
        if let Some(whole) = integer_of(&self.graph, *power, &mut { 256 }) {
            return self.whole_power(base, whole, span);
        }
        if values(&self.graph, &[*power])[0] == Constant::ratio(1, 2) {
            return self.native(Op::Sqrt, std::slice::from_ref(base), span);
        }
        let [x, y] = *parts(base, span)? else {
            return Err(Error::new(span, ErrorKind::QuaternionFunction { name: "^" }));
        };
        let length = self.length(&[x, y]);
        let angle = self.graph.apply(Op::Atan2, &[y, x]);
        let (length, angle) = (
            self.graph.apply(Op::Pow, &[length, *power]),
            self.graph.apply(Op::Mul, &[*power, angle]),
        );
        let part = |op| {
            let part = self.graph.apply(op, &[angle]);
            self.graph.apply(Op::Mul, &[length, part])
        };
        Ok(Tensor::Complex([Op::Cos, Op::Sin].map(part).to_vec()))
    }

    /// The natural logarithm of a real number, which is complex unless the number is a positive
    /// constant.
    fn logarithm(&mut self, number: NodeId, span: Span) -> Fallible<Tensor> {
        match self.graph.number(number) {
            Some(Constant::Named(NamedConstant::E)) => Ok(Tensor::Number(self.graph.integer(1))),
            Some(constant) if constant.bounds().lo > 0.0 => {
                Ok(Tensor::Number(self.graph.apply(Op::Ln, &[number])))
            }
            _ => {
                let complex = Tensor::Complex(self.promoted(&Tensor::Number(number), 2, span)?);
                self.native(Op::Ln, &[complex], span)
            }
        }
    }

    /// A power with a whole exponent, by squaring.
    fn whole_power(&mut self, base: &Tensor, exponent: i64, span: Span) -> Fallible<Tensor> {
        let mut rest = exponent.unsigned_abs();
        if rest > MAX_EXPONENT {
            return Err(Error::new(span, ErrorKind::ComplexExponent { limit: MAX_EXPONENT }));
        }
        let mut power = Tensor::Number(self.graph.integer(1));
        let mut square = base.clone();
        while rest > 0 {
            if rest % 2 == 1 {
                power = match power {
                    Tensor::Number(_) => square.clone(),
                    _ => self.native(Op::Mul, &[power, square.clone()], span)?,
                };
            }
            rest /= 2;
            if rest > 0 {
                square = self.complex_square(&square, span)?;
            }
        }
        if exponent >= 0 {
            return Ok(power);
        }
        let one = Tensor::Number(self.graph.integer(1));
        self.native(Op::Div, &[one, power], span)
    }

    /// Applies a function of one complex number, by its row of the table.
    fn complex_function(&mut self, op: Op, value: Tensor, span: Span) -> Fallible<Tensor> {
        let Some(body) = prelude::complex(op) else { return Err(no_function(op, span)) };
        if value.parts().len() != 2 {
            return Err(Error::new(span, ErrorKind::QuaternionFunction { name: op.row().name }));
        }
        let names = std::iter::once(prelude::COMPLEX);
        self.expand(&Function::Native(op), vec![value], names, body, span)
    }
}

/// The components of a number, a complex number or a quaternion. Fails for vectors and matrices.
pub(crate) fn parts(value: &Tensor, span: Span) -> Fallible<&[NodeId]> {
    match value {
        Tensor::Number(_) | Tensor::Complex(_) => Ok(value.parts()),
        Tensor::Vector(_) | Tensor::Matrix(_) => {
            Err(Error::new(span, ErrorKind::ComplexAmongVectors))
        }
    }
}

fn no_function(op: Op, span: Span) -> Box<Error> {
    Error::new(span, ErrorKind::ComplexFunction { name: op.row().name })
}
