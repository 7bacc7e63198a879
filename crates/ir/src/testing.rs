//! Helpers for tests: formulas by operators, a point evaluator in `f64`, and random graphs.

use crate::{Axis, Constant, Graph, NamedConstant, Node, NodeId};
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};
use std::cell::RefCell;
use zeroset_ops::{Domain, Op, TABLE};

#[derive(Default)]
pub(crate) struct TestGraphBuilder(pub(crate) RefCell<Graph>);

/// A node of a [`TestGraphBuilder`], which Rust's operators combine.
#[derive(Clone, Copy)]
pub(crate) struct TestExpr<'a> {
    builder: &'a TestGraphBuilder,
    pub(crate) id: NodeId,
}

impl TestGraphBuilder {
    pub(crate) fn xyz(&self) -> [TestExpr<'_>; 3] {
        Axis::ALL.map(|axis| self.term(self.0.borrow_mut().variable(axis)))
    }

    pub(crate) fn parameter(&self, number: u32) -> TestExpr<'_> {
        self.term(self.0.borrow_mut().parameter(number))
    }

    pub(crate) fn number(&self, text: &str) -> TestExpr<'_> {
        let decimal = Constant::decimal(text.trim_start_matches('-')).expect("a decimal");
        match decimal.exact() {
            Some(value) if text.starts_with('-') => self.constant(Constant::rational(-value)),
            Some(_) | None => self.constant(decimal),
        }
    }

    pub(crate) fn constant(&self, value: Constant) -> TestExpr<'_> {
        self.term(self.0.borrow_mut().constant(value))
    }

    pub(crate) fn graph(&self) -> Graph {
        self.0.borrow().clone()
    }

    fn term(&self, id: NodeId) -> TestExpr<'_> {
        TestExpr { builder: self, id }
    }
}

impl<'a> TestExpr<'a> {
    pub(crate) fn apply(self, op: Op, others: &[TestExpr<'a>]) -> TestExpr<'a> {
        let operands: Vec<NodeId> = std::iter::once(&self).chain(others).map(|t| t.id).collect();
        self.builder.term(self.builder.0.borrow_mut().apply(op, &operands))
    }

    pub(crate) fn pow(self, exponent: i64) -> TestExpr<'a> {
        let exponent = self.builder.term(self.builder.0.borrow_mut().integer(exponent));
        self.apply(Op::Pow, &[exponent])
    }

    pub(crate) fn f(self, op: Op) -> TestExpr<'a> {
        self.apply(op, &[])
    }
}

impl std::ops::Neg for TestExpr<'_> {
    type Output = Self;
    fn neg(self) -> Self {
        self.f(Op::Neg)
    }
}

macro_rules! operator {
    ($trait:ident, $method:ident, $op:expr) => {
        impl std::ops::$trait for TestExpr<'_> {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                self.apply($op, &[other])
            }
        }
        impl<'a> std::ops::$trait<f64> for TestExpr<'a> {
            type Output = TestExpr<'a>;
            fn $method(self, other: f64) -> TestExpr<'a> {
                self.apply($op, &[self.builder.number(&other.to_string())])
            }
        }
        impl<'a> std::ops::$trait<TestExpr<'a>> for f64 {
            type Output = TestExpr<'a>;
            fn $method(self, other: TestExpr<'a>) -> TestExpr<'a> {
                other.builder.number(&self.to_string()).apply($op, &[other])
            }
        }
    };
}
operator!(Add, add, Op::Add);
operator!(Sub, sub, Op::Sub);
operator!(Mul, mul, Op::Mul);
operator!(Div, div, Op::Div);

/// The value of every node at a point, in `f64`, and a generous bound on the value's rounding
/// error. `None` where the node is undefined. An infinite bound marks a value that tests must skip.
pub(crate) fn evaluate(graph: &Graph, at: [f64; 3], parameters: &[f64]) -> Vec<Option<(f64, f64)>> {
    let mut values: Vec<Option<(f64, f64)>> = Vec::with_capacity(graph.len());
    let mut fixed: Vec<bool> = Vec::with_capacity(graph.len());
    for (_, node) in graph.iter() {
        fixed.push(match node {
            Node::Variable(_) | Node::Parameter(_) => false,
            Node::Constant(_) => true,
            Node::Apply(_, operands) => operands.iter().all(|id| fixed[id.index()]),
        });
        let value = match node {
            Node::Variable(axis) => Some((at[*axis as usize], 0.0)),
            Node::Parameter(number) => Some((parameters[*number as usize], 0.0)),
            Node::Constant(constant) => {
                let bounds = constant.bounds();
                Some((bounds.lo, bounds.hi - bounds.lo))
            }
            Node::Apply(Op::SelectNegative, operands) => {
                values[operands[0].index()].and_then(|(a, e)| {
                    let chosen = values[operands[if a < 0.0 { 1 } else { 2 }].index()];
                    // If the condition's sign is uncertain, an infinite error marks the choice as
                    // unstable.
                    chosen.map(|(v, w)| (v, if a.abs() <= e { f64::INFINITY } else { w }))
                })
            }
            Node::Apply(Op::Otherwise, operands) => {
                values[operands[0].index()].or(values[operands[1].index()])
            }
            Node::Apply(op, operands) => {
                operands.iter().map(|id| values[id.index()]).collect::<Option<Vec<_>>>().and_then(
                    |v| {
                        let integer = operands.get(1).is_some_and(|id| {
                        matches!(graph.node(*id), Node::Constant(c) if c.as_integer().is_some())
                    });
                        let computed = *op == Op::Pow
                            && fixed[operands[1].index()]
                            && matches!(graph.node(operands[1]), Node::Apply(..));
                        if computed && v[0].0 - v[0].1 <= 0.0 {
                            // In floats it is unknown whether an exponent like 4/2 is an integer.
                            return Some((0.0, f64::INFINITY));
                        }
                        point(*op, &v, integer)
                    },
                )
            }
        };
        values.push(value);
    }
    values
}

/// A value as far as exact arithmetic knows it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Exactly {
    Undefined,
    Number(BigRational),
    /// Some number.
    Defined,
    Unknown,
}

/// The value of every node at a point with rational coordinates. A function has a number only where
/// the table has its value.
pub(crate) fn evaluate_exactly(graph: &Graph, at: &[BigRational; 3]) -> Vec<Exactly> {
    let mut values: Vec<Exactly> = Vec::with_capacity(graph.len());
    for (_, node) in graph.iter() {
        values.push(match node {
            Node::Variable(axis) => Exactly::Number(at[*axis as usize].clone()),
            Node::Parameter(_) => Exactly::Defined,
            Node::Constant(value) => {
                value.exact().cloned().map_or(Exactly::Defined, Exactly::Number)
            }
            Node::Apply(op, operands) => {
                let operands: Vec<_> =
                    operands.iter().map(|id| values[id.index()].clone()).collect();
                exactly(*op, &operands)
            }
        });
    }
    values
}

fn exactly(op: Op, v: &[Exactly]) -> Exactly {
    use Exactly::{Defined, Number, Undefined, Unknown};
    let row = op.row();
    if op == Op::Otherwise {
        return match (&v[0], &v[1]) {
            (Undefined, b) => b.clone(),
            (Unknown, _) => Unknown,
            (a, _) => a.clone(),
        };
    }
    if v.contains(&Undefined) {
        return Undefined;
    }
    if v.contains(&Unknown) {
        return Unknown;
    }
    let rest = if row.domain == Domain::All { Defined } else { Unknown };
    match (op, v) {
        (Op::Neg, [Number(a)]) => Number(-a),
        (Op::Sqr, [Number(a)]) => Number(a * a),
        (Op::Add, [Number(a), Number(b)]) => Number(a + b),
        (Op::Sub, [Number(a), Number(b)]) => Number(a - b),
        (Op::Mul, [Number(a), Number(b)]) => Number(a * b),
        (Op::Mul, [Number(zero), _] | [_, Number(zero)]) if zero.is_zero() => Number(zero.clone()),
        (Op::Sqrt | Op::Cbrt, [Number(a)]) if a.is_zero() => Number(a.clone()),
        (Op::Min, [Number(a), Number(b)]) => Number(a.min(b).clone()),
        (Op::Max, [Number(a), Number(b)]) => Number(a.max(b).clone()),
        (Op::Div, [_, Number(b)]) if b.is_zero() => Undefined,
        (Op::Div, [Number(a), Number(b)]) => Number(a / b),
        (Op::Div, [_, Number(_)]) => Defined,
        (Op::Pow, [Number(a), Number(n)]) if n.is_integer() && !n.is_negative() => {
            Number(a.pow(n.to_integer().try_into().expect("small")))
        }
        (Op::WhereNonzero, [_, Number(b)]) if b.is_zero() => Undefined,
        (Op::WhereDefined, [a, _]) | (Op::WhereNonzero, [a, Number(_)]) => a.clone(),
        (_, [Number(a)]) => {
            let one = BigRational::one();
            let pairs = row.values.iter().copied();
            let mut pairs = pairs.chain(row.secants.iter().map(|secant| (secant.at, secant.value)));
            let value = |n: i32| BigRational::from_integer(n.into());
            if let Some((_, found)) = pairs.find(|(at, _)| value(*at) == *a) {
                return Number(value(found));
            }
            let inside = match row.domain {
                Domain::Nonneg => !a.is_negative(),
                Domain::Positive => a.is_positive(),
                Domain::Unit => a.abs() <= one,
                Domain::UnitInside => a.abs() < one,
                _ => return rest,
            };
            if inside { Defined } else { Undefined }
        }
        _ => rest,
    }
}

#[allow(clippy::too_many_lines)] // one arm per operation
fn point(op: Op, v: &[(f64, f64)], integer: bool) -> Option<(f64, f64)> {
    let (a, ea) = v[0];
    let (b, eb) = v.get(1).copied().unwrap_or((0.0, 0.0));
    // The error is infinite if the operand may be on either side of 0, where a domain ends.
    let unsure = |x: f64, e: f64| if x.abs() <= e { f64::INFINITY } else { 0.0 };
    let jump = |x: f64, e: f64| {
        if (x - x.round()).abs() <= e || (x + 0.5 - (x + 0.5).round()).abs() <= e {
            f64::INFINITY
        } else {
            0.0
        }
    };
    // The logarithm of `a` to a base whose natural logarithm is `of_base`.
    let logarithm = |of_base: f64| {
        if a <= 0.0 {
            return if -a <= ea && ea > 0.0 { Some((0.0, f64::INFINITY)) } else { None };
        }
        Some((a.ln() / of_base, unsure(a, ea) + 4.0 * ea / a))
    };
    let (value, slope_error) = match op {
        Op::Neg => (-a, ea),
        Op::Abs => (a.abs(), ea),
        Op::Sign => (if a == 0.0 { 0.0 } else { a.signum() }, unsure(a, ea)),
        Op::Floor => (a.floor(), jump(a, ea)),
        Op::Ceil => (a.ceil(), jump(a, ea)),
        Op::Round => (a.round_ties_even(), jump(a, ea)),
        Op::Trunc => (a.trunc(), jump(a, ea)),
        Op::Fract => (a - a.floor(), jump(a, ea) + ea),
        Op::Sqr => (a * a, 2.0 * a.abs() * ea + ea * ea),
        Op::Sqrt if a < 0.0 => {
            return if -a <= ea { Some((0.0, f64::INFINITY)) } else { None };
        }
        Op::Sqrt => (a.sqrt(), unsure(a, ea) + ea / a.sqrt().max(f64::MIN_POSITIVE)),
        Op::Cbrt => (a.cbrt(), unsure(a, ea) + ea / a.cbrt().powi(2).max(f64::MIN_POSITIVE)),
        Op::Exp => (a.exp(), a.exp() * ea),
        Op::Ln => logarithm(1.0)?,
        Op::Log2 => logarithm(std::f64::consts::LN_2)?,
        Op::Log10 => logarithm(std::f64::consts::LN_10)?,
        Op::Sin => (a.sin(), ea),
        Op::Cos => (a.cos(), ea),
        Op::Tan => (a.tan(), unsure(a.cos(), ea) + ea / a.cos().powi(2)),
        Op::Asin | Op::Acos => {
            let room = 1.0 - a.abs();
            if room < 0.0 {
                return if -room <= ea { Some((0.0, f64::INFINITY)) } else { None };
            }
            let value = if op == Op::Asin { a.asin() } else { a.acos() };
            (value, unsure(room, ea) + 2.0 * ea / room.sqrt().max(f64::MIN_POSITIVE))
        }
        Op::Atan => (a.atan(), ea),
        Op::Sinh => (a.sinh(), (a.abs() + ea).cosh() * ea),
        Op::Cosh => (a.cosh(), (a.abs() + ea).sinh() * ea),
        Op::Tanh => (a.tanh(), ea),
        Op::Asinh => (a.asinh(), ea + a.asinh().abs() * 1e-14),
        Op::Acosh => {
            let room = a - 1.0;
            if room < 0.0 {
                return if -room <= ea { Some((0.0, f64::INFINITY)) } else { None };
            }
            let spread = ea + 1e-15 * a;
            (a.acosh(), unsure(room, ea) + spread / room.sqrt().max(f64::MIN_POSITIVE))
        }
        Op::Atanh => {
            let room = 1.0 - a.abs();
            if room <= 0.0 {
                return if -room <= ea && ea > 0.0 { Some((0.0, f64::INFINITY)) } else { None };
            }
            (a.atanh(), unsure(room, ea) + 4.0 * (ea + 1e-15) / room)
        }
        Op::Erf => (libm::erf(a), 1.13 * ea),
        Op::BesselJ0 | Op::BesselJ1 | Op::BesselJ2 | Op::BesselJ3 => {
            (libm::jn(op.bessel_order() as i32, a), ea + f64::EPSILON)
        }
        Op::Add => (a + b, ea + eb),
        Op::Sub => (a - b, ea + eb),
        Op::Mul => (a * b, a.abs() * eb + b.abs() * ea + ea * eb),
        Op::Div => {
            if b.abs() <= eb {
                return if eb == 0.0 { None } else { Some((0.0, f64::INFINITY)) };
            }
            (a / b, 2.0 * (ea + (a / b).abs() * eb) / b.abs())
        }
        Op::Pow => {
            let n = b;
            if integer && n >= 0.0 {
                let slope = if n == 0.0 { 0.0 } else { n * (a.abs() + ea).powf(n - 1.0) };
                (a.powf(n), slope * ea)
            } else if integer {
                if a.abs() <= ea {
                    return if ea == 0.0 { None } else { Some((0.0, f64::INFINITY)) };
                }
                (a.powf(n), 4.0 * (n * a.powf(n - 1.0)).abs() * ea)
            } else {
                if a < 0.0 || (a == 0.0 && n <= 0.0) {
                    return if a.abs() <= ea && ea > 0.0 {
                        Some((0.0, f64::INFINITY))
                    } else {
                        None
                    };
                }
                let value = a.powf(n);
                let relative =
                    if a > 0.0 { 4.0 * (n.abs() * ea / a + a.ln().abs() * eb) } else { 0.0 };
                (value, unsure(a, ea) + unsure(n, eb) + value * relative)
            }
        }
        Op::Mod => {
            if b.abs() <= eb {
                return if eb == 0.0 { None } else { Some((0.0, f64::INFINITY)) };
            }
            let quotient = a / b;
            let spread = (ea + quotient.abs() * eb) / b.abs() + quotient.abs() * 1e-12;
            (a - b * quotient.floor(), jump(quotient, spread) + ea + quotient.abs() * eb)
        }
        Op::Atan2 => {
            if a.abs() <= ea && b.abs() <= eb {
                let exact = ea == 0.0 && eb == 0.0;
                return if exact { None } else { Some((0.0, f64::INFINITY)) };
            }
            let cut = if b < 0.0 { unsure(a, ea) } else { 0.0 };
            // If `a` is exactly 0, it is on the upper side of the cut.
            let cut = if ea == 0.0 { 0.0 } else { cut };
            ((a + 0.0).atan2(b + 0.0), cut + 4.0 * (ea + eb) / a.hypot(b))
        }
        Op::Min => (a.min(b), ea.max(eb)),
        Op::Max => (a.max(b), ea.max(eb)),
        Op::SelectNegative | Op::Otherwise => unreachable!("evaluated by the caller"),
        Op::WhereNonneg => {
            if b < 0.0 && b.abs() > eb {
                return None;
            }
            (a, ea + unsure(b, eb))
        }
        Op::WherePositive => {
            if b <= 0.0 && (b.abs() > eb || eb == 0.0) {
                return None;
            }
            (a, ea + unsure(b, eb))
        }
        Op::WhereNonzero => {
            if b == 0.0 && eb == 0.0 {
                return None;
            }
            (a, ea + unsure(b, eb))
        }
        Op::WhereDefined => (a, if eb.is_finite() { ea } else { eb }),
    };
    // A value is NaN or ∞ only after an overflow.
    if !value.is_finite() {
        return Some((0.0, f64::INFINITY));
    }
    let error = slope_error + value.abs() * 1e-14 + f64::MIN_POSITIVE;
    Some((value, if error.is_nan() { f64::INFINITY } else { error }))
}

/// A generator of random numbers (splitmix64; Steele, Lea, Flood 2014).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub(crate) fn below(&mut self, end: usize) -> usize {
        (self.next() % end as u64) as usize
    }

    /// A random coordinate in [-2, 2], often an integer or a half, since many domains end at those.
    pub(crate) fn coordinate(&mut self) -> f64 {
        match self.below(4) {
            0 => self.below(5) as f64 - 2.0,
            1 => self.below(9) as f64 / 2.0 - 2.0,
            _ => (self.next() >> 11) as f64 / (1_u64 << 51) as f64 - 2.0,
        }
    }

    /// A random graph of up to `size` operations on coordinates, two parameters and constants.
    pub(crate) fn graph(&mut self, size: usize) -> (Graph, NodeId) {
        let mut graph = Graph::new();
        let mut nodes: Vec<NodeId> = Axis::ALL.iter().map(|axis| graph.variable(*axis)).collect();
        nodes.push(graph.parameter(0));
        nodes.push(graph.parameter(1));
        for value in [-2, -1, 0, 1, 2, 3] {
            nodes.push(graph.integer(value));
        }
        nodes.push(graph.constant(Constant::ratio(1, 2).expect("not zero")));
        nodes.push(graph.constant(Constant::ratio(-3, 2).expect("not zero")));
        nodes.push(graph.constant(Constant::Named(NamedConstant::Pi)));
        let leaves = nodes.len();
        for _ in 0..size {
            // Sums, products and powers are drawn more often, because most rules are about them.
            let op = match self.below(3) {
                0 => [Op::Add, Op::Sub, Op::Mul, Op::Mul, Op::Div, Op::Neg, Op::Sqr, Op::Pow]
                    [self.below(8)],
                1 => [Op::Add, Op::Sub, Op::Mul][self.below(3)],
                _ => TABLE[self.below(TABLE.len())].op,
            };
            let operands: Vec<NodeId> = (0..op.arity())
                .map(|place| {
                    if op == Op::Pow && place == 1 && self.below(4) > 0 {
                        return nodes[5 + self.below(8)];
                    }
                    // Recent nodes are drawn more often, so that graphs grow deep.
                    let from = if self.below(2) == 0 {
                        nodes.len().saturating_sub(4).max(leaves.min(nodes.len() - 1))
                    } else {
                        0
                    };
                    nodes[from + self.below(nodes.len() - from)]
                })
                .collect();
            nodes.push(graph.apply(op, &operands));
        }
        let root = nodes[nodes.len() - 1];
        (graph, root)
    }
}
