//! The operations under test as graphs, and their evaluators: software `f64` and native code.

use super::itl::{Decoration, Term};
use std::collections::HashMap;
use zeroset_eval::{Assumptions, Binding, Boxes, Enclose, Kernel, Real, Tape};
use zeroset_interval::{Decorated, Facts, Interval, fold};
use zeroset_ir::{Axis, Graph, Node, NodeId};
use zeroset_ops::Op;

/// An expression in x, y and z.
#[derive(Clone)]
pub struct Function {
    pub graph: Graph,
    pub root: NodeId,
}

/// Returns the function that ITF1788 calls `name`, or the reason why it is missing.
pub fn function(name: &str, operands: &[Term]) -> Result<Function, &'static str> {
    let op = match name {
        "neg" => Op::Neg,
        "abs" => Op::Abs,
        "sign" => Op::Sign,
        "floor" => Op::Floor,
        "ceil" => Op::Ceil,
        "trunc" => Op::Trunc,
        "roundTiesToEven" => Op::Round,
        "sqr" => Op::Sqr,
        "sqrt" => Op::Sqrt,
        "exp" => Op::Exp,
        "log" => Op::Ln,
        "log2" => Op::Log2,
        "log10" => Op::Log10,
        "sin" => Op::Sin,
        "cos" => Op::Cos,
        "tan" => Op::Tan,
        "asin" => Op::Asin,
        "acos" => Op::Acos,
        "atan" => Op::Atan,
        "atan2" => Op::Atan2,
        "sinh" => Op::Sinh,
        "cosh" => Op::Cosh,
        "tanh" => Op::Tanh,
        "asinh" => Op::Asinh,
        "acosh" => Op::Acosh,
        "atanh" => Op::Atanh,
        "add" => Op::Add,
        "sub" => Op::Sub,
        "mul" => Op::Mul,
        "div" => Op::Div,
        "pow" => Op::Pow,
        "min" => Op::Min,
        "max" => Op::Max,
        "recip" => return Ok(with_integer(Op::Div, 1, false)),
        "exp2" => return Ok(with_integer(Op::Pow, 2, false)),
        "exp10" => return Ok(with_integer(Op::Pow, 10, false)),
        "pown" => {
            let Some(Term::Integer(n)) = operands.last() else { return Err("no exponent") };
            return Ok(with_integer(Op::Pow, i64::from(*n), true));
        }
        "pos" => return Err("the identity is not an operation here"),
        "fma" => return Err("no such operation: x*y + z is two"),
        "roundTiesToAway" => return Err("no such operation: halves go to even"),
        _ => return Err("unknown"),
    };
    let mut graph = Graph::new();
    let variables = Axis::ALL.map(|axis| graph.variable(axis));
    let root = graph.apply(op, &variables[..op.arity()]);
    Ok(Function { graph, root })
}

/// Returns an operation on x and a constant: the last operand if `last`, or else the first.
fn with_integer(op: Op, integer: i64, last: bool) -> Function {
    let mut graph = Graph::new();
    let (x, n) = (graph.variable(Axis::X), graph.integer(integer));
    let root = graph.apply(op, &if last { [x, n] } else { [n, x] });
    Function { graph, root }
}

/// Bounds and facts of one enclosure.
#[derive(Clone, Copy, Debug)]
pub struct QueryResult {
    pub bounds: Interval,
    pub facts: Facts,
}

impl Function {
    /// Encloses the function in software, node by node, in `f64`.
    pub fn fold(&self, operands: &[Decorated]) -> QueryResult {
        let mut values: HashMap<NodeId, Decorated> = HashMap::new();
        for (id, node) in self.graph.iter() {
            let value = match node {
                Node::Variable(axis) => match operands.get(*axis as usize) {
                    Some(value) => *value,
                    None => continue,
                },
                Node::Parameter(_) => unreachable!("no parameters here"),
                Node::Constant(constant) => constant.value(),
                Node::Apply(op, operands) => {
                    let operands: Vec<Decorated> = operands.iter().map(|id| values[id]).collect();
                    fold(*op, &operands).into()
                }
            };
            values.insert(id, value);
        }
        let Decorated { bounds, facts, .. } = values[&self.root];
        QueryResult { bounds, facts }
    }

    /// Returns the same function, but undefined everywhere if an operand is `empty`.
    fn restricted(&self, empty: &[bool]) -> Self {
        let mut graph = Graph::new();
        let never = graph.integer(-1);
        let mut places: HashMap<NodeId, NodeId> = HashMap::new();
        for (id, node) in self.graph.iter() {
            let place = match node {
                Node::Variable(axis) => {
                    let variable = graph.variable(*axis);
                    if empty.get(*axis as usize) == Some(&true) {
                        graph.apply(Op::WhereNonneg, &[variable, never])
                    } else {
                        variable
                    }
                }
                Node::Parameter(_) => unreachable!("no parameters here"),
                Node::Constant(constant) => graph.constant(constant.clone()),
                Node::Apply(op, operands) => {
                    let operands: Vec<NodeId> = operands.iter().map(|id| places[id]).collect();
                    graph.apply(*op, &operands)
                }
            };
            places.insert(id, place);
        }
        Self { root: places[&self.root], graph }
    }
}

/// Assumptions of native code about its operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KnownDomain {
    /// No bounds, so the code contains every guard.
    Nothing,
    /// The operands' box, as if it were a picture's domain. The code leaves out unneeded guards.
    TheBox,
}

/// Native code in one precision, cached by function and by which operands are empty.
pub struct Native<T: Real> {
    known_domain: KnownDomain,
    kernels: HashMap<String, zeroset_jit::Native<Enclose, T>>,
}

impl<T: Real> Native<T> {
    pub fn new(known_domain: KnownDomain) -> Self {
        Self { known_domain, kernels: HashMap::new() }
    }

    /// Encloses `function`, whose name in the cache is `key`. The operands' ends must be floats of
    /// type `T`. An operand `None` stands for the empty set.
    pub fn enclose(
        &mut self,
        key: &str,
        function: &Function,
        operands: &[Option<Interval>],
    ) -> QueryResult {
        let empty: Vec<bool> = operands.iter().map(Option::is_none).collect();
        let mut domain = [Interval::ZERO; 3];
        for (axis, operand) in operands.iter().enumerate() {
            domain[axis] = operand.unwrap_or(Interval::ZERO);
        }
        let boxes = Boxes::around(&[domain]); // exact
        let compile = || {
            let restricted = function.restricted(&empty);
            let mut assumptions = Assumptions::none(0);
            if self.known_domain == KnownDomain::TheBox {
                assumptions.domain = domain;
            }
            let tape = Tape::new(&restricted.graph, &[restricted.root], &assumptions);
            zeroset_jit::Native::new(tape, Binding::empty()).expect("compiles")
        };
        let answers = match self.known_domain {
            KnownDomain::Nothing => {
                let kernel = self.kernels.entry(format!("{key} {empty:?}")).or_insert_with(compile);
                kernel.eval_all(&boxes)
            }
            KnownDomain::TheBox => compile().eval_all(&boxes),
        };
        let (neg_lo, hi): (f64, f64) = (answers[0].neg_lo[0].into(), answers[0].hi[0].into());
        let (lo, facts) = (-neg_lo, answers[0].facts(0));
        assert!(!lo.is_nan() && !hi.is_nan(), "{key}: NaN over {operands:?}");
        QueryResult { bounds: Interval { lo, hi }, facts }
    }
}

/// Rounds bounds outward to floats of type `T`.
pub fn outward<T: Real>(bounds: Interval) -> Interval {
    let (neg_lo, hi): (f64, f64) = (T::above(-bounds.lo).into(), T::above(bounds.hi).into());
    Interval { lo: 0.0 - neg_lo, hi: 0.0 + hi }
}

/// Converts an operand to the software type.
pub fn value_of(bounds: Option<Interval>, decoration: Option<Decoration>) -> Decorated {
    match bounds {
        None => (Interval::ENTIRE, Facts::NOWHERE).into(),
        Some(bounds) => (bounds, decoration.map_or(Facts::TOTAL, Decoration::facts)).into(),
    }
}
