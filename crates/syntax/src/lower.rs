//! From trees to the expression graph: definitions expanded, nothing simplified.
//!
//! Recursion is over trees, whose depth is bounded, and over definitions inside definitions, whose
//! sum is bounded here. Every expansion is remembered by its arguments, so repeated use costs
//! nothing.

use crate::ast::{
    Definition, Expr, ExprKind, Function, NamedConstant, NamedValue, ProductSign, Relation, SumSign,
};
use crate::error::{Error, ErrorKind, Fallible};
use crate::limits::Limits;
use crate::prelude;
use crate::span::Span;
use rustc_hash::FxHashMap;
use zeroset_ir::{Constant, Graph, Node, NodeId};
use zeroset_ops::Op;

/// Recursion levels per level of [`Limits::depth`]: a bracket may hold a sum of products of powers
/// of calls.
const LEVELS: usize = 5;
/// Visits allowed per node of [`Limits::nodes`]: expansion may visit without adding nodes.
const VISITS: usize = 16;

/// What a defined name lowers to.
#[derive(Clone, Debug)]
pub(crate) enum Binding<'a> {
    /// The parameter with this number.
    Parameter(u32),
    /// A definition, expanded where it is used.
    Definition(&'a Definition),
}

/// Values by the names of a function's parameters.
type Locals<'a> = [(&'a str, NodeId)];

/// Lowers the trees of one document into one graph.
pub(crate) struct Lowering<'a> {
    pub graph: Graph,
    names: FxHashMap<&'a str, Binding<'a>>,
    time: Option<u32>,
    is_constant: bool,
    limits: &'a Limits,
    expanded: FxHashMap<(Function, Vec<NodeId>), NodeId>,
    values: FxHashMap<&'a str, NodeId>,
    levels: usize,
    visits: usize,
    /// Per node, as far as has been asked, whether it is defined everywhere.
    pub(crate) total: Vec<bool>,
}

impl<'a> Lowering<'a> {
    pub(crate) fn new(
        names: FxHashMap<&'a str, Binding<'a>>,
        time: Option<u32>,
        limits: &'a Limits,
    ) -> Self {
        Self { names, time, is_constant: false, ..Self::constant(limits) }
    }

    /// For an expression in which nothing may vary.
    pub(crate) fn constant(limits: &'a Limits) -> Self {
        Self {
            graph: Graph::new(),
            names: FxHashMap::default(),
            time: None,
            is_constant: true,
            limits,
            expanded: FxHashMap::default(),
            values: FxHashMap::default(),
            levels: 0,
            visits: 0,
            total: Vec::new(),
        }
    }

    /// The node of a number.
    pub(crate) fn value(&mut self, expr: &'a Expr) -> Fallible<NodeId> {
        self.number(expr, &[])
    }

    /// The function whose zeros are drawn for a plain formula or an equation; `None` for a
    /// condition.
    pub(crate) fn equation(&mut self, expr: &'a Expr) -> Fallible<Option<NodeId>> {
        match &expr.kind {
            ExprKind::Compare(left, rest) => match rest.as_slice() {
                [(Relation::Equal, right)] => self.difference(left, right).map(Some),
                _ => Ok(None),
            },
            ExprKind::And(_) | ExprKind::Or(_) | ExprKind::Not(_) => Ok(None),
            _ => self.value(expr).map(Some),
        }
    }

    /// `left − right`, without the subtraction where one side is the number 0.
    pub(crate) fn difference(&mut self, left: &'a Expr, right: &'a Expr) -> Fallible<NodeId> {
        let zero =
            |expr: &Expr| expr.number().and_then(Constant::decimal).is_some_and(|c| c.is_zero());
        if zero(right) {
            return self.value(left);
        }
        let right_node = self.value(right)?;
        if zero(left) {
            return Ok(self.graph.apply(Op::Neg, &[right_node]));
        }
        let left_node = self.value(left)?;
        Ok(self.graph.apply(Op::Sub, &[left_node, right_node]))
    }

    /// `op` over all `nodes`, from the left.
    pub(crate) fn fold(&mut self, op: Op, nodes: &[NodeId]) -> NodeId {
        nodes[1..].iter().fold(nodes[0], |all, node| self.graph.apply(op, &[all, *node]))
    }

    /// Counts a visit, and fails where the formula has grown too large.
    fn enter(&mut self, span: Span) -> Fallible<()> {
        let limit = self.limits.nodes;
        self.visits += 1;
        if self.graph.len() > limit || self.visits > limit.saturating_mul(VISITS) {
            return Err(Error::new(span, ErrorKind::TooLarge { limit }));
        }
        if self.levels > self.limits.depth * LEVELS {
            let limit = self.limits.depth;
            return Err(Error::new(span, ErrorKind::TooDeep { limit }));
        }
        Ok(())
    }

    fn number(&mut self, expr: &'a Expr, locals: &Locals<'a>) -> Fallible<NodeId> {
        self.enter(expr.span)?;
        self.levels += 1;
        let node = self.node(expr, locals);
        self.levels -= 1;
        node
    }

    fn node(&mut self, expr: &'a Expr, locals: &Locals<'a>) -> Fallible<NodeId> {
        match &expr.kind {
            ExprKind::Number(text) => {
                let constant =
                    Constant::decimal(text).expect("the grammar lets only decimals through");
                Ok(self.graph.constant(constant))
            }
            ExprKind::Name(value) => self.named(value, expr.span, locals),
            ExprKind::Negate(inner) => {
                let inner = self.number(inner, locals)?;
                // A negative number is a number, so that `x^-2` has one for its exponent.
                let opposite = match self.graph.node(inner) {
                    Node::Constant(constant) => {
                        constant.exact().map(|value| Constant::rational(-value))
                    }
                    Node::Variable(_) | Node::Parameter(_) | Node::Apply(..) => None,
                };
                Ok(match opposite {
                    Some(constant) => self.graph.constant(constant),
                    None => self.graph.apply(Op::Neg, &[inner]),
                })
            }
            ExprKind::Sum(first, rest) => {
                let mut sum = self.number(first, locals)?;
                for (sign, term) in rest {
                    let term = self.number(term, locals)?;
                    let op = match sign {
                        SumSign::Plus => Op::Add,
                        SumSign::Minus => Op::Sub,
                    };
                    sum = self.graph.apply(op, &[sum, term]);
                }
                Ok(sum)
            }
            ExprKind::Product(first, rest) => {
                let mut product = self.number(first, locals)?;
                for (sign, factor) in rest {
                    let factor = self.number(factor, locals)?;
                    let op = match sign {
                        ProductSign::Times => Op::Mul,
                        ProductSign::Over => Op::Div,
                    };
                    product = self.graph.apply(op, &[product, factor]);
                }
                Ok(product)
            }
            ExprKind::Power(base, exponent) => {
                let base = self.number(base, locals)?;
                let exponent = self.number(exponent, locals)?;
                Ok(self.graph.apply(Op::Pow, &[base, exponent]))
            }
            ExprKind::Call(function, arguments) => {
                let nodes: Fallible<Vec<NodeId>> =
                    arguments.iter().map(|a| self.number(a, locals)).collect();
                self.call(function, nodes?, expr.span)
            }
            ExprKind::Compare(..) | ExprKind::And(_) | ExprKind::Or(_) | ExprKind::Not(_) => {
                Err(Error::new(expr.span, ErrorKind::ConditionAsValue))
            }
        }
    }

    fn named(&mut self, value: &NamedValue, span: Span, locals: &Locals<'a>) -> Fallible<NodeId> {
        let varies = || {
            let name = value.name().to_owned();
            Error::new(span, ErrorKind::NotConstant { name })
        };
        match value {
            NamedValue::Coordinate(_) | NamedValue::Time if self.is_constant => Err(varies()),
            NamedValue::Coordinate(axis) => Ok(self.graph.variable(*axis)),
            NamedValue::Time => Ok(match self.time {
                Some(number) => self.graph.parameter(number),
                None => self.graph.integer(0),
            }),
            NamedValue::Constant(constant) => Ok(self.graph.constant(match constant {
                NamedConstant::Pi => Constant::pi(),
                NamedConstant::Tau => Constant::tau(),
                NamedConstant::E => Constant::e(),
                NamedConstant::Phi => Constant::phi(),
            })),
            NamedValue::Local(name) => {
                let found = locals.iter().rfind(|(local, _)| local == name);
                found.map(|(_, node)| *node).ok_or_else(varies)
            }
            NamedValue::Defined(name) => {
                if let Some(node) = self.values.get(name.as_str()) {
                    return Ok(*node);
                }
                let (name, binding) = self.names.get_key_value(name.as_str()).ok_or_else(varies)?;
                let (name, definition) = match binding {
                    Binding::Parameter(number) => return Ok(self.graph.parameter(*number)),
                    Binding::Definition(definition) => (*name, *definition),
                };
                let node = self.number(&definition.body, &[]).map_err(|e| at_use(e, span))?;
                self.values.insert(name, node);
                Ok(node)
            }
        }
    }

    fn call(
        &mut self,
        function: &Function,
        arguments: Vec<NodeId>,
        span: Span,
    ) -> Fallible<NodeId> {
        match function {
            Function::Native(op) if op.arity() < arguments.len() => Ok(self.fold(*op, &arguments)),
            Function::Native(op) => Ok(self.graph.apply(*op, &arguments)),
            Function::Length => {
                let two = self.graph.integer(2);
                let squares: Vec<NodeId> =
                    arguments.iter().map(|node| self.graph.apply(Op::Pow, &[*node, two])).collect();
                let sum = self.fold(Op::Add, &squares);
                Ok(self.graph.apply(Op::Sqrt, &[sum]))
            }
            Function::Root => self.root(arguments[0], arguments[1], span),
            Function::Composed(index) => {
                let names = zeroset_ops::COMPOSED[*index].parameters.iter().copied();
                self.expand(function, arguments, names, prelude::body(*index), span)
            }
            Function::Defined(name) => {
                let Some(Binding::Definition(definition)) = self.names.get(name.as_str()) else {
                    let name = name.clone();
                    return Err(Error::new(span, ErrorKind::NotConstant { name }));
                };
                let definition: &'a Definition = definition;
                let names = definition.parameters.iter().flatten().map(|name| name.text.as_str());
                self.expand(function, arguments, names, &definition.body, span)
            }
        }
    }

    /// The body of a function with `names` replaced by its arguments.
    fn expand(
        &mut self,
        function: &Function,
        arguments: Vec<NodeId>,
        names: impl Iterator<Item = &'a str>,
        body: &'a Expr,
        span: Span,
    ) -> Fallible<NodeId> {
        let key = (function.clone(), arguments);
        if let Some(node) = self.expanded.get(&key) {
            return Ok(*node);
        }
        let locals: Vec<(&str, NodeId)> = names.zip(key.1.iter().copied()).collect();
        let node = self.number(body, &locals).map_err(|error| at_use(error, span))?;
        self.expanded.insert(key, node);
        Ok(node)
    }

    /// The n-th root of `radicand`: of negative numbers too where n is odd.
    fn root(&mut self, radicand: NodeId, index: NodeId, span: Span) -> Fallible<NodeId> {
        let whole = match self.graph.node(index) {
            Node::Constant(constant) => constant.as_integer(),
            Node::Variable(_) | Node::Parameter(_) | Node::Apply(..) => None,
        };
        let one = self.graph.integer(1);
        let Some(n) = whole else {
            let exponent = self.graph.apply(Op::Div, &[one, index]);
            return Ok(self.graph.apply(Op::Pow, &[radicand, exponent]));
        };
        let positive = match n.unsigned_abs() {
            0 => return Err(Error::new(span, ErrorKind::ZerothRoot)),
            1 => radicand,
            2 => self.graph.apply(Op::Sqrt, &[radicand]),
            3 => self.graph.apply(Op::Cbrt, &[radicand]),
            n => {
                let exponent = i64::try_from(n).ok().and_then(|n| Constant::ratio(1, n));
                let exponent =
                    self.graph.constant(exponent.unwrap_or_else(|| Constant::integer(0)));
                if n % 2 == 0 {
                    self.graph.apply(Op::Pow, &[radicand, exponent])
                } else {
                    let sign = self.graph.apply(Op::Sign, &[radicand]);
                    let size = self.graph.apply(Op::Abs, &[radicand]);
                    let power = self.graph.apply(Op::Pow, &[size, exponent]);
                    self.graph.apply(Op::Mul, &[sign, power])
                }
            }
        };
        Ok(if n < 0 { self.graph.apply(Op::Div, &[one, positive]) } else { positive })
    }
}

/// Errors of size inside a definition are shown where it is used: that is what can be changed.
fn at_use(mut error: Box<Error>, span: Span) -> Box<Error> {
    if matches!(error.kind, ErrorKind::TooLarge { .. } | ErrorKind::TooDeep { .. }) {
        error.span = span;
    }
    error
}
