//! The syntax tree: the text as typed, but with every name resolved and every implicit product made
//! explicit.
//!
//! Sums, products and comparisons hold any number of operands. Only brackets, powers, signs and
//! function arguments nest, so a limit on their depth bounds every recursion over a tree.
//! Comparisons of trees ignore spans.

use crate::span::Span;
use zeroset_ir::{Axis, NamedConstant};
use zeroset_ops::{Differential, Op, VectorFunction};

/// An expression and its place in the text.
#[derive(Clone, Debug)]
pub struct Expr {
    /// Kind of the expression, with its operands.
    pub kind: ExprKind,
    /// Place of the expression in the text.
    pub span: Span,
}

impl PartialEq for Expr {
    fn eq(&self, other: &Self) -> bool {
        self.kind == other.kind
    }
}

impl Expr {
    /// Creates an expression whose place is `span`.
    pub fn new(kind: ExprKind, span: Span) -> Self {
        Self { kind, span }
    }

    /// The number whose text is `digits`.
    pub fn of_digits(digits: impl Into<String>, span: Span) -> Self {
        Self::new(ExprKind::Number(digits.into()), span)
    }

    /// The equation `self = right`, at the span of `self`.
    #[must_use]
    pub fn equals(self, right: Self) -> Self {
        let span = self.span;
        self.compared(Relation::Equal, right, span)
    }

    /// The comparison of `self` with `right`. The place of the comparison is `span`.
    #[must_use]
    pub fn compared(self, relation: Relation, right: Self, span: Span) -> Self {
        Self::new(ExprKind::Compare(Box::new(self), vec![(relation, right)]), span)
    }

    /// A choice that is 1 where the condition `self` holds, and 0 elsewhere. Its place is `span`.
    pub(crate) fn indicator(self, span: Span) -> Self {
        let number = |digits| Self::of_digits(digits, span);
        let pieces = vec![(self, number("1"))];
        Self::new(ExprKind::Choice(pieces, Some(Box::new(number("0")))), span)
    }

    /// Returns whether this is a condition (true or false) rather than a number.
    pub fn is_condition(&self) -> bool {
        matches!(
            self.kind,
            ExprKind::Compare(..) | ExprKind::And(_) | ExprKind::Or(_) | ExprKind::Not(_)
        )
    }

    /// The text of this number; `None` unless this is a number without a sign.
    pub fn number(&self) -> Option<&str> {
        match &self.kind {
            ExprKind::Number(text) => Some(text),
            _ => None,
        }
    }

    /// The value of a whole number; `None` if there is a sign, a decimal point or an exponent.
    pub fn whole_number(&self) -> Option<u32> {
        self.number()?.parse().ok()
    }

    /// The direct subexpressions.
    pub fn parts(&self) -> Vec<&Self> {
        match &self.kind {
            ExprKind::Number(_) | ExprKind::Name(_) => Vec::new(),
            ExprKind::Negate(inner) | ExprKind::Not(inner) | ExprKind::Component(inner, _) => {
                vec![inner]
            }
            ExprKind::Chain(_, first, rest) => {
                std::iter::once(&**first).chain(rest.iter().map(|(_, operand)| operand)).collect()
            }
            ExprKind::Compare(first, rest) => {
                std::iter::once(&**first).chain(rest.iter().map(|(_, side)| side)).collect()
            }
            ExprKind::Power(base, exponent) => vec![base, exponent],
            ExprKind::Call(_, all) | ExprKind::And(all) | ExprKind::Or(all) => all.iter().collect(),
            ExprKind::Choice(pieces, last) => {
                let pieces = pieces.iter().flat_map(|(condition, value)| [condition, value]);
                pieces.chain(last.as_deref()).collect()
            }
            ExprKind::Series(series) => {
                let ends = [&series.low, &series.high, &series.body];
                ends.into_iter().chain(&series.step).collect()
            }
        }
    }

    /// This expression and all its subexpressions, at any depth.
    pub fn all_parts(&self) -> Vec<&Self> {
        let mut all = vec![self];
        let mut at = 0;
        while let Some(next) = all.get(at) {
            all.extend(next.parts());
            at += 1;
        }
        all
    }

    /// A sum or a product of two or more operands. If `first` is a chain of the same kind, its
    /// operands are spliced in, which keeps the value.
    pub(crate) fn chain(
        kind: Chain,
        first: Self,
        mut more: Vec<(ChainSign, Self)>,
        span: Span,
    ) -> Self {
        let (first, rest) = match first.kind {
            ExprKind::Chain(inner, first, mut rest) if inner == kind => {
                rest.append(&mut more);
                (first, rest)
            }
            other => (Box::new(Self::new(other, first.span)), more),
        };
        Self::new(ExprKind::Chain(kind, first, rest), span)
    }

    /// The quotient `self/divisor`. Its place is `span`.
    pub(crate) fn over(self, divisor: Self, span: Span) -> Self {
        Self::chain(Chain::Product, self, vec![(ChainSign::Inverse, divisor)], span)
    }

    /// Numerator and denominator; `None` unless this is a quotient of two expressions.
    pub fn quotient(&self) -> Option<(&Self, &Self)> {
        match &self.kind {
            ExprKind::Chain(Chain::Product, top, rest) => match rest.as_slice() {
                [(ChainSign::Inverse, bottom)] => Some((top, bottom)),
                _ => None,
            },
            _ => None,
        }
    }

    /// The negation `-self`. Its place is `span`.
    pub(crate) fn negated(self, span: Span) -> Self {
        Self::new(ExprKind::Negate(Box::new(self)), span)
    }
}

/// Kind of an expression, with its operands.
#[derive(Clone, Debug, PartialEq)]
pub enum ExprKind {
    /// A decimal number without a sign, as text that `Constant::decimal` reads.
    Number(String),
    /// A named value.
    Name(NamedValue),
    /// `-a`.
    Negate(Box<Expr>),
    /// `a + b - c` or `a*b/c`: the first operand, then one or more operands with their signs.
    Chain(Chain, Box<Expr>, Vec<(ChainSign, Expr)>),
    /// `a^b`.
    Power(Box<Expr>, Box<Expr>),
    /// A function call with its arguments.
    Call(Function, Vec<Expr>),
    /// `{c: a, d: b, e}`: the value of the first piece whose condition holds, or else the last
    /// value. Where no condition holds, a choice without a last value is undefined.
    Choice(Vec<(Expr, Expr)>, Option<Box<Expr>>),
    /// `p.xz`: components of a vector, named by the letters x, y, z and w.
    Component(Box<Expr>, String),
    /// `sum(k = 1..5, a)` or `product(…)`.
    Series(Box<Series>),
    /// `a <= b < c`: the first side, then one or more relations, each with its right side.
    Compare(Box<Expr>, Vec<(Relation, Expr)>),
    /// Two or more conditions that must all hold.
    And(Vec<Expr>),
    /// Two or more conditions of which at least one must hold.
    Or(Vec<Expr>),
    /// A condition that must not hold.
    Not(Box<Expr>),
}

impl ExprKind {
    /// The name that this expression is or calls; `None` unless the document defines the name.
    pub fn defined(&self) -> Option<&str> {
        match self {
            Self::Name(NamedValue::Defined(name)) | Self::Call(Function::Defined(name), _) => {
                Some(name)
            }
            _ => None,
        }
    }
}

/// The letters that name a vector's components.
pub const LETTERS: &str = "xyzw";

/// A sum or a product over whole numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// True for a product, false for a sum.
    pub is_product: bool,
    /// Index variable. It is visible only in the body.
    pub index: Name,
    /// First value of the index.
    pub low: Expr,
    /// Largest value that the index may take.
    pub high: Expr,
    /// Step of the index; `None` for 1.
    pub step: Option<Expr>,
    /// The term of the sum, or factor of the product, for each value of the index.
    pub body: Expr,
}

/// Kind of a chain of operands: a sum or a product.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Chain {
    /// A sum of terms.
    Sum,
    /// A product of factors.
    Product,
}

/// Sign that joins an operand of a chain to the operands before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChainSign {
    /// The operand is joined by `+`, by `*` or by juxtaposition.
    Direct,
    /// The operand is joined by `-` or `/`.
    Inverse,
}

impl Chain {
    /// The operation that joins an operand with `sign` to a chain of this kind.
    pub fn op(self, sign: ChainSign) -> Op {
        match (self, sign) {
            (Self::Sum, ChainSign::Direct) => Op::Add,
            (Self::Sum, ChainSign::Inverse) => Op::Sub,
            (Self::Product, ChainSign::Direct) => Op::Mul,
            (Self::Product, ChainSign::Inverse) => Op::Div,
        }
    }
}

/// Relation between two numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Relation {
    /// `=`
    Equal,
    /// `!=`
    Unequal,
    /// `<`
    Less,
    /// `<=`
    LessEqual,
    /// `>`
    Greater,
    /// `>=`
    GreaterEqual,
}

impl Relation {
    /// The opposite relation, which holds where `self` does not, if both sides have a value.
    #[must_use]
    pub fn opposite(self) -> Self {
        match self {
            Self::Equal => Self::Unequal,
            Self::Unequal => Self::Equal,
            Self::Less => Self::GreaterEqual,
            Self::LessEqual => Self::Greater,
            Self::Greater => Self::LessEqual,
            Self::GreaterEqual => Self::Less,
        }
    }

    /// The sign of the relation, as it is printed.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Equal => "=",
            Self::Unequal => "!=",
            Self::Less => "<",
            Self::LessEqual => "<=",
            Self::Greater => ">",
            Self::GreaterEqual => ">=",
        }
    }
}

/// A name that stands for a value.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum NamedValue {
    /// A coordinate of space.
    Coordinate(Axis),
    /// Time, `t`.
    Time,
    /// The imaginary unit, `i`.
    ImaginaryUnit,
    /// A constant of the language. A document may give its name another meaning.
    Constant(NamedConstant),
    /// A parameter of the function being defined.
    Local(String),
    /// A name that the document or an override defines.
    Defined(String),
}

impl NamedValue {
    /// The name as it is printed.
    pub fn name(&self) -> &str {
        match self {
            Self::Coordinate(axis) => axis.name(),
            Self::Time => "t",
            Self::ImaginaryUnit => "i",
            Self::Constant(constant) => constant.name(),
            Self::Local(name) | Self::Defined(name) => name,
        }
    }
}

/// The function in a call.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Function {
    /// An operation of the table. `min` and `max` take two or more arguments.
    Native(Op),
    /// A composed function, by its index in [`zeroset_ops::COMPOSED`].
    Composed(usize),
    /// The distance from the origin, for four or more coordinates.
    Length,
    /// `root(a, n)`: the n-th root.
    Root,
    /// A vector: `vec2`, `vec3` or `vec4`.
    Vector(u8),
    /// A square matrix of two to four rows. Its elements are given column by column.
    Matrix(u8),
    /// A function of vectors.
    OfVectors(VectorFunction),
    /// `iterate(f, n, a, …)`: the function f, applied n times, starting from a. Further arguments
    /// are the same for each application.
    Iterate(Box<Function>),
    /// `diff(a, x, y)`: the derivative of the argument by each variable in turn.
    Derivative(Vec<NamedValue>),
    /// `f''(a)`: the derivative of a function of one argument, this many times.
    Derived(Box<Function>, u8),
    /// A function of the derivatives by x, y and z.
    OfDerivatives(Differential),
    /// A builder, by its name in [`zeroset_ops::BUILDERS`]. The arguments select its row.
    Builder(&'static str),
    /// A function that the document defines.
    Defined(String),
}

impl Function {
    /// The function's name as it is printed.
    pub fn name(&self) -> &str {
        match self {
            Self::Native(op) => op.row().name,
            Self::Composed(index) => zeroset_ops::COMPOSED[*index].name,
            Self::Length => "hypot",
            Self::Root => "root",
            Self::Vector(2) => "vec2",
            Self::Vector(3) => "vec3",
            Self::Vector(_) => "vec4",
            Self::Matrix(2) => "mat2",
            Self::Matrix(3) => "mat3",
            Self::Matrix(_) => "mat4",
            Self::OfVectors(function) => function.name(),
            Self::Iterate(_) => "iterate",
            Self::Derivative(_) => "diff",
            Self::Derived(function, _) => function.name(),
            Self::OfDerivatives(function) => function.name(),
            Self::Builder(name) => name,
            Self::Defined(name) => name,
        }
    }
}

/// One statement of a document.
#[derive(Clone, Debug, PartialEq)]
pub enum Statement {
    /// A formula to draw.
    Draw {
        /// A number (with an implied `= 0`), an equation or a condition.
        expr: Expr,
        /// Conditions in braces. Each one restricts where `expr` is defined.
        restrictions: Vec<Expr>,
    },
    /// `name = body`, or `name(parameters) = body`.
    Define(Definition),
    /// A curve or a point to draw.
    Curve(CurveStatement),
}

/// A curve, a point or a parametric surface to draw. Comparisons ignore the place.
#[derive(Clone, Debug)]
pub struct CurveStatement {
    /// The form of the curve, with its expressions.
    pub form: CurveForm,
    /// Place of the statement in the text.
    pub span: Span,
}

impl PartialEq for CurveStatement {
    fn eq(&self, other: &Self) -> bool {
        self.form == other.form
    }
}

/// The forms of curves, points and parametric surfaces.
#[derive(Clone, Debug, PartialEq)]
pub enum CurveForm {
    /// The points at which two equations hold, or one equation of complex numbers.
    Equations {
        /// One or two equations. A number has an implied `= 0`.
        equations: Vec<Expr>,
        /// Conditions in braces. Each one restricts where the equations are defined.
        restrictions: Vec<Expr>,
    },
    /// The points for all values of a parameter in a range.
    Path {
        /// Three coordinates, or one vector.
        at: Vec<Expr>,
        /// The parameter. It is visible only in `at`.
        parameter: Name,
        /// First and last value of the parameter.
        range: Box<(Expr, Expr)>,
    },
    /// The points for all values of two parameters in their ranges: a surface.
    Patch {
        /// Three coordinates, or one vector.
        at: Vec<Expr>,
        /// The parameters. They are visible only in `at`.
        parameters: [Name; 2],
        /// First and last value of each parameter.
        ranges: Box<[(Expr, Expr); 2]>,
    },
    /// A point.
    Point {
        /// The three coordinates.
        at: Vec<Expr>,
        /// The label, without quotation marks.
        label: Option<String>,
    },
}

impl Statement {
    /// The drawn formula and its restrictions, or the body of the definition.
    pub fn expressions(&self) -> Vec<&Expr> {
        match self {
            Self::Draw { expr, restrictions } => {
                std::iter::once(expr).chain(restrictions).collect()
            }
            Self::Define(definition) => vec![&definition.body],
            Self::Curve(curve) => match &curve.form {
                CurveForm::Equations { equations, restrictions } => {
                    equations.iter().chain(restrictions).collect()
                }
                CurveForm::Path { at, range, .. } => {
                    at.iter().chain([&range.0, &range.1]).collect()
                }
                CurveForm::Patch { at, ranges, .. } => {
                    at.iter().chain(ranges.iter().flat_map(|range| [&range.0, &range.1])).collect()
                }
                CurveForm::Point { at, .. } => at.iter().collect(),
            },
        }
    }
}

/// A definition of a value or a function.
#[derive(Clone, Debug, PartialEq)]
pub struct Definition {
    /// The defined name. Defining `t` sets the time.
    pub name: Name,
    /// The parameters of a function; `None` for a value.
    pub parameters: Option<Vec<Name>>,
    /// Value of the name, or body of the function.
    pub body: Expr,
    /// Ends of the slider's range, from `in [low, high]`.
    pub range: Option<(Expr, Expr)>,
}

/// A name at the place of its definition. Comparisons of names ignore spans.
#[derive(Clone, Debug)]
pub struct Name {
    /// Text of the name.
    pub text: String,
    /// Place of the name in the text; the default span if it was not typed.
    pub span: Span,
}

impl PartialEq for Name {
    fn eq(&self, other: &Self) -> bool {
        self.text == other.text
    }
}
