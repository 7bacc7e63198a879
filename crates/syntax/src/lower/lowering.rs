//! Lowers syntax trees to the expression graph. Definitions are expanded. Nothing is simplified.
//!
//! The recursion descends into trees, whose depth the lexer bounds, and into at most
//! [`MAX_EXPANSIONS`] definitions that use one another. Longer chains of definitions are lowered
//! from their far end by a loop. Stack is added when little is left. Expansions are cached by
//! function and arguments, so equal calls are expanded once.

use crate::lower::builders::Moves;
use crate::lower::prelude;
use crate::lower::value::{Tensor, component, numbers, vector};
use rustc_hash::FxHashMap;
use zeroset_ir::{Constant, Graph, NodeId};
use zeroset_ops::Op;
use zeroset_parser::tree::ast::{
    Chain, ChainSign, Definition, Expr, ExprKind, Function, NamedValue, Relation,
};
use zeroset_parser::{Error, ErrorKind, Fallible, Limits, Note, Span};

/// Largest number of definitions that recursion lowers within one another. In a longer chain, the
/// definitions beyond are lowered first, and then the lowering starts again.
const MAX_EXPANSIONS: usize = 16;
/// Visits to expressions allowed per node of [`Limits::nodes`]. Some visits add no node.
pub(crate) const VISITS: usize = 8;

/// Stack that must be free at each recursion level, in bytes. A level takes 1 KB, or 100 KB if it
/// lowers choices between numbers.
const RED_ZONE: usize = 1 << 18;
/// Size of each added stack segment, in bytes. One tree may need 1,000 recursion levels.
const SEGMENT: usize = 1 << 21;

/// Meaning of a defined name.
#[derive(Clone, Debug)]
pub(crate) enum NameBinding<'a> {
    /// The parameter with this number.
    Parameter(u32),
    /// A constant.
    Number(Constant),
    /// A definition, which is expanded where its name is used.
    Definition(&'a Definition),
}

/// Names and values of a function's parameters.
pub(crate) type Locals<'a> = [(&'a str, Tensor)];

/// A definition to be lowered, for certain arguments.
struct Expansion<'a> {
    defined: Defined<'a>,
    locals: Vec<(&'a str, Tensor)>,
    body: &'a Expr,
    /// The place of the name or call that uses the definition.
    span: Span,
    /// Whether the definition stands in the text.
    is_typed: bool,
}

/// A name or a call that an expansion gives a value.
enum Defined<'a> {
    Value(&'a str),
    Call((Function, Vec<Tensor>)),
}

/// Lowers the trees of one document into one graph.
pub(crate) struct Lowering<'a> {
    pub graph: Graph,
    pub notes: Vec<Note>,
    pub(crate) names: FxHashMap<&'a str, NameBinding<'a>>,
    pub(crate) time: Option<u32>,
    pub(crate) is_constant: bool,
    /// True if the product of two vectors is their scalar product, as in `OpenSCAD`.
    pub(crate) multiplies_to_numbers: bool,
    pub(crate) limits: &'a Limits,
    /// Functions of solids that are evaluated at other points.
    pub(crate) moves: Moves,
    pub(crate) calls: FxHashMap<(Function, Vec<Tensor>), Tensor>,
    values: FxHashMap<&'a str, Tensor>,
    /// Number of expansions that are being lowered within one another.
    expansions: usize,
    /// An expansion that has to be lowered first. While it is set, every error means only this.
    postponed: Option<Expansion<'a>>,
    visits: usize,
    /// Whether the graph has variables of differentiation, which no root depends on.
    pub(crate) has_variables: bool,
    /// For each node examined so far: whether it is defined everywhere.
    pub(crate) total: Vec<bool>,
}

impl<'a> Lowering<'a> {
    pub(crate) fn new(
        names: FxHashMap<&'a str, NameBinding<'a>>,
        time: Option<u32>,
        limits: &'a Limits,
    ) -> Self {
        Self { names, time, is_constant: false, ..Self::constant(limits) }
    }

    /// Creates a lowering for constant expressions. A name that varies is an error.
    pub(crate) fn constant(limits: &'a Limits) -> Self {
        Self {
            graph: Graph::new(),
            notes: Vec::new(),
            names: FxHashMap::default(),
            time: None,
            is_constant: true,
            multiplies_to_numbers: false,
            limits,
            moves: Moves::default(),
            calls: FxHashMap::default(),
            values: FxHashMap::default(),
            expansions: 0,
            postponed: None,
            visits: 0,
            has_variables: false,
            total: Vec::new(),
        }
    }

    /// Returns whether the graph may have placeholders or variables of differentiation. No root
    /// depends on them.
    pub(crate) fn has_placeholders(&self) -> bool {
        self.has_variables || !self.moves.is_empty()
    }

    /// Lowers by `attempt`. If the attempt postpones an expansion, lowers the expansion and repeats
    /// the attempt. All trees must be lowered within a call of this function.
    pub(crate) fn complete<T>(
        &mut self,
        mut attempt: impl FnMut(&mut Self) -> Fallible<T>,
    ) -> Fallible<T> {
        // Each expansion postponed the next one.
        let mut chain: Vec<Expansion<'a>> = Vec::new();
        loop {
            let result = match chain.last() {
                None => match attempt(self) {
                    Ok(value) => return Ok(value),
                    Err(error) => Err(error),
                },
                Some(expansion) => self.lower_expansion(expansion).map(|_| ()),
            };
            self.expansions = 0;
            match (result, self.postponed.take()) {
                (Ok(()), _) => {
                    chain.pop();
                }
                (Err(_), Some(next)) => chain.push(next),
                (Err(error), None) => {
                    let outer = chain.iter().rev().skip(1);
                    return Err(outer.fold(error, |error, expansion| {
                        move_to_use(error, expansion.span, expansion.is_typed)
                    }));
                }
            }
        }
    }

    /// The value of an expansion, or an error that postpones the expansion if too many are being
    /// lowered.
    fn expanded(&mut self, expansion: Expansion<'a>) -> Fallible<Tensor> {
        if self.expansions >= MAX_EXPANSIONS {
            let kind = ErrorKind::TooDeep { limit: MAX_EXPANSIONS };
            let error = Error::new(expansion.span, kind);
            self.postponed = Some(expansion);
            return Err(error);
        }
        self.lower_expansion(&expansion)
    }

    /// Lowers the body of an expansion, and keeps its value.
    fn lower_expansion(&mut self, expansion: &Expansion<'a>) -> Fallible<Tensor> {
        let Expansion { defined, locals, body, span, is_typed } = expansion;
        let noted = self.notes.len();
        self.expansions += 1;
        let value = self.value_of(body, locals);
        self.expansions -= 1;
        let value = value.map_err(|error| move_to_use(error, *span, *is_typed))?;
        match defined {
            Defined::Value(name) => {
                self.values.insert(name, value.clone());
            }
            Defined::Call(key) => {
                if !is_typed {
                    self.notes.truncate(noted);
                }
                self.calls.insert(key.clone(), value.clone());
            }
        }
        Ok(value)
    }

    /// The node of an expression outside any function. Fails unless the expression is a number.
    pub(crate) fn value(&mut self, expr: &'a Expr) -> Fallible<NodeId> {
        let root = self.complete(|all| all.number(expr, &[]))?;
        self.in_place(root, expr.span)
    }

    /// The function whose zeros a formula or an equation draws; `None` for a condition.
    pub(crate) fn equation(&mut self, expr: &'a Expr) -> Fallible<Option<NodeId>> {
        match &expr.kind {
            ExprKind::Compare(left, rest) => match rest.as_slice() {
                [(Relation::Equal, right)] => self.difference(left, right, &[]).map(Some),
                _ => Ok(None),
            },
            ExprKind::And(_) | ExprKind::Or(_) | ExprKind::Not(_) => Ok(None),
            _ => self.number(expr, &[]).map(Some),
        }
    }

    /// `left − right`. If one side is the number 0, there is no subtraction: the result is `left`,
    /// or the negative of `right`.
    pub(crate) fn difference(
        &mut self,
        left: &'a Expr,
        right: &'a Expr,
        locals: &Locals<'a>,
    ) -> Fallible<NodeId> {
        let zero =
            |expr: &Expr| expr.number().and_then(Constant::decimal).is_some_and(|c| c.is_zero());
        if zero(right) {
            return self.number(left, locals);
        }
        let right_value = self.value_of(right, locals)?;
        if zero(left) {
            let right_node = self.real(&right_value, right.span)?;
            return Ok(self.graph.apply(Op::Neg, &[right_node]));
        }
        let left_value = self.value_of(left, locals)?;
        if left_value.is_complex() || right_value.is_complex() {
            let span = left.span.to(right.span);
            let difference = self.native(Op::Sub, &[left_value, right_value], span)?;
            return self.real(&difference, span);
        }
        let right_node = self.real(&right_value, right.span)?;
        let left_node = self.real(&left_value, left.span)?;
        Ok(self.graph.apply(Op::Sub, &[left_node, right_node]))
    }

    /// Combines `nodes` by the operation `op`, from left to right.
    pub(crate) fn fold(&mut self, op: Op, nodes: &[NodeId]) -> NodeId {
        nodes[1..].iter().fold(nodes[0], |all, node| self.graph.apply(op, &[all, *node]))
    }

    /// Fails if the graph is larger than the limits allow.
    pub(crate) fn check_size(&self, span: Span) -> Fallible<()> {
        let limit = self.limits.nodes;
        if self.graph.len() > limit {
            return Err(Error::new(span, ErrorKind::TooLarge { limit }));
        }
        Ok(())
    }

    /// Counts a visit to an expression. Fails if the formula is too large.
    fn count_visit(&mut self, span: Span) -> Fallible<()> {
        let limit = self.limits.nodes;
        self.visits += 1;
        self.check_size(span)?;
        if self.visits > limit.saturating_mul(VISITS) {
            return Err(Error::new(span, ErrorKind::TooLarge { limit }));
        }
        Ok(())
    }

    /// The node of an expression. Fails unless the expression is a number.
    pub(crate) fn number(&mut self, expr: &'a Expr, locals: &Locals<'a>) -> Fallible<NodeId> {
        let value = self.value_of(expr, locals)?;
        self.real(&value, expr.span)
    }

    /// The node of a value. Fails unless the value is a number, or a complex number whose imaginary
    /// part is 0 everywhere.
    fn real(&mut self, value: &Tensor, span: Span) -> Fallible<NodeId> {
        match value {
            Tensor::Number(node) => Ok(*node),
            Tensor::Vector(_) => Err(Error::new(span, ErrorKind::Vector)),
            Tensor::Matrix(_) => Err(Error::new(span, ErrorKind::MatrixValue)),
            Tensor::Complex(parts) => self.real_part(parts, span),
        }
    }

    /// The value of an expression: a real or complex number, a vector or a matrix.
    #[inline(never)]
    pub(crate) fn value_of(&mut self, expr: &'a Expr, locals: &Locals<'a>) -> Fallible<Tensor> {
        self.count_visit(expr.span)?;
        match stacker::remaining_stack() {
            Some(..RED_ZONE) => self.lower_on_more_stack(expr, locals),
            _ => self.lower(expr, locals),
        }
    }

    #[inline(never)]
    fn lower_on_more_stack(&mut self, expr: &'a Expr, locals: &Locals<'a>) -> Fallible<Tensor> {
        stacker::grow(SEGMENT, || self.lower(expr, locals))
    }

    /// Lowers an expression. Each kind of expression has its own function, so a recursion level
    /// takes the stack frame of one kind only.
    #[inline(never)]
    fn lower(&mut self, expr: &'a Expr, locals: &Locals<'a>) -> Fallible<Tensor> {
        match &expr.kind {
            ExprKind::Number(text) => Ok(self.decimal(text)),
            ExprKind::Name(value) => self.named(value, expr.span, locals),
            ExprKind::Negate(inner) => self.negated(inner, locals),
            ExprKind::Chain(kind, first, rest) => self.chain(*kind, first, rest, locals),
            ExprKind::Power(base, exponent) => {
                let operands = [base.as_ref(), exponent.as_ref()];
                let operands = self.values_of(operands.into_iter(), locals)?;
                self.native(Op::Pow, &operands, expr.span)
            }
            ExprKind::Call(Function::Builder(name), arguments) => {
                let values = self.values_of(arguments.iter(), locals)?;
                let places = arguments.iter().map(|argument| argument.span);
                let arguments: Vec<_> = values.into_iter().zip(places).collect();
                self.build(name, &arguments, expr.span)
            }
            ExprKind::Call(Function::Derivative(by), arguments) => {
                self.differentiated(by, &arguments[0], expr.span, locals)
            }
            ExprKind::Call(function, arguments) => {
                let values = self.values_of(arguments.iter(), locals)?;
                self.call(function, values, expr.span)
            }
            ExprKind::Choice(pieces, otherwise) => {
                self.choice(pieces, otherwise.as_deref(), locals)
            }
            ExprKind::Component(vector, letters) => {
                let value = self.value_of(vector, locals)?;
                component(value, letters, expr.span)
            }
            ExprKind::Series(series) => self.series(series, expr.span, locals),
            ExprKind::Compare(..) | ExprKind::And(_) | ExprKind::Or(_) | ExprKind::Not(_) => {
                Err(Error::new(expr.span, ErrorKind::ConditionAsValue))
            }
        }
    }

    #[inline(never)]
    fn decimal(&mut self, text: &str) -> Tensor {
        let constant = Constant::decimal(text).expect("the grammar lets only decimals through");
        Tensor::Number(self.graph.constant(constant))
    }

    #[inline(never)]
    fn negated(&mut self, inner: &'a Expr, locals: &Locals<'a>) -> Fallible<Tensor> {
        let value = self.value_of(inner, locals)?;
        self.by_component(&[value], inner.span, |all, parts| Ok(all.opposite(parts[0])))
    }

    #[inline(never)]
    pub(crate) fn values_of(
        &mut self,
        exprs: impl Iterator<Item = &'a Expr>,
        locals: &Locals<'a>,
    ) -> Fallible<Vec<Tensor>> {
        exprs.map(|expr| self.value_of(expr, locals)).collect()
    }

    /// Lowers a sum or a product, combined from left to right.
    #[inline(never)]
    fn chain(
        &mut self,
        kind: Chain,
        first: &'a Expr,
        rest: &'a [(ChainSign, Expr)],
        locals: &Locals<'a>,
    ) -> Fallible<Tensor> {
        let mut all = self.value_of(first, locals)?;
        for (sign, next) in rest {
            let op = kind.op(*sign);
            let operands = [all, self.value_of(next, locals)?];
            self.note_product(op, &operands[0], &operands[1], first.span.to(next.span));
            let are_vectors = operands.iter().all(|one| matches!(one, Tensor::Vector(_)));
            all = if self.multiplies_to_numbers && are_vectors && op == Op::Mul {
                Tensor::Number(self.dot(&operands[0], &operands[1], next.span)?)
            } else {
                self.native(op, &operands, next.span)?
            };
        }
        Ok(all)
    }

    /// The negation of a number. An exact constant stays a constant, as in the exponent of `x^-2`.
    fn opposite(&mut self, inner: NodeId) -> NodeId {
        let exact = self.graph.number(inner).and_then(Constant::exact);
        match exact.map(|value| Constant::rational(-value)) {
            Some(constant) => self.graph.constant(constant),
            None => self.graph.apply(Op::Neg, &[inner]),
        }
    }

    /// The value that a name stands for.
    #[inline(never)]
    pub(crate) fn named(
        &mut self,
        value: &NamedValue,
        span: Span,
        locals: &Locals<'a>,
    ) -> Fallible<Tensor> {
        let varies = || {
            let name = value.name().to_owned();
            Error::new(span, ErrorKind::NotConstant { name })
        };
        match value {
            NamedValue::Coordinate(_) | NamedValue::Time if self.is_constant => Err(varies()),
            NamedValue::Coordinate(axis) => Ok(Tensor::Number(self.graph.variable(*axis))),
            NamedValue::Time => Ok(Tensor::Number(match self.time {
                Some(number) => self.graph.parameter(number),
                None => self.graph.integer(0),
            })),
            NamedValue::Constant(constant) => {
                Ok(Tensor::Number(self.graph.constant(Constant::Named(*constant))))
            }
            NamedValue::ImaginaryUnit => {
                Ok(Tensor::Complex(vec![self.graph.integer(0), self.graph.integer(1)]))
            }
            NamedValue::Local(name) => {
                let found = locals.iter().rfind(|(local, _)| local == name);
                found.map(|(_, value)| value.clone()).ok_or_else(varies)
            }
            NamedValue::Defined(name) => {
                if let Some(value) = self.values.get(name.as_str()) {
                    return Ok(value.clone());
                }
                let (name, binding) = self.names.get_key_value(name.as_str()).ok_or_else(varies)?;
                let (name, definition) = match binding {
                    NameBinding::Parameter(number) => {
                        return Ok(Tensor::Number(self.graph.parameter(*number)));
                    }
                    NameBinding::Number(value) => {
                        return Ok(Tensor::Number(self.graph.constant(value.clone())));
                    }
                    NameBinding::Definition(definition) => (*name, *definition),
                };
                let is_typed = definition.name.span != Span::default();
                let (defined, body) = (Defined::Value(name), &definition.body);
                self.expanded(Expansion { defined, locals: Vec::new(), body, span, is_typed })
            }
        }
    }

    /// Applies a function to argument values.
    #[inline(never)]
    pub(crate) fn call(
        &mut self,
        function: &Function,
        mut arguments: Vec<Tensor>,
        span: Span,
    ) -> Fallible<Tensor> {
        match function {
            Function::Native(op) if op.arity() < arguments.len() => {
                let first = arguments.remove(0);
                arguments
                    .into_iter()
                    .try_fold(first, |all, next| self.native(*op, &[all, next], span))
            }
            Function::Native(op) if op.arity() > arguments.len() => {
                if arguments[0].is_complex() {
                    return self.of_complex(*op, &arguments, span);
                }
                Ok(Tensor::Number(self.fold(*op, arguments[0].parts())))
            }
            Function::Native(op) => self.native(*op, &arguments, span),
            Function::Length => {
                let nodes = numbers(&arguments, span)?;
                Ok(Tensor::Number(self.length(&nodes)))
            }
            Function::Root if arguments[0].is_complex() => {
                let one = Tensor::Number(self.graph.integer(1));
                let index = self.native(Op::Div, &[one, arguments[1].clone()], span)?;
                self.native(Op::Pow, &[arguments[0].clone(), index], span)
            }
            Function::Root => {
                let nodes = numbers(&arguments, span)?;
                self.root(nodes[0], nodes[1], span).map(Tensor::Number)
            }
            Function::Vector(size) => vector(usize::from(*size), &arguments, span),
            Function::Matrix(size) => self.matrix(usize::from(*size), &arguments, span),
            Function::OfVectors(function) => self.of_vectors(*function, &arguments, span),
            Function::Iterate(function) => self.iterate(function, arguments, span),
            Function::Derived(function, order) => {
                self.derived(function, *order, &arguments[0], span)
            }
            Function::OfDerivatives(function) => self.of_derivatives(*function, &arguments, span),
            // `differentiated` lowers derivatives: it needs the argument as an expression, not as a
            // value.
            Function::Derivative(_) => Err(Error::new(span, ErrorKind::WhichVariable)),
            Function::Builder(name) => {
                let arguments: Vec<_> =
                    arguments.into_iter().map(|argument| (argument, span)).collect();
                self.build(name, &arguments, span)
            }
            Function::Composed(index)
                if zeroset_ops::COMPOSED[*index].name == "hypot"
                    && matches!(arguments.as_slice(), [Tensor::Vector(_)]) =>
            {
                Ok(Tensor::Number(self.length(arguments[0].parts())))
            }
            Function::Composed(index) if let Some(sequence) = prelude::sequence(*index) => {
                self.numbered(*index, sequence, arguments, span)
            }
            Function::Composed(index) => {
                let names = zeroset_ops::COMPOSED[*index].parameters.iter().copied();
                self.expand(function, arguments, names, prelude::body(*index), span)
            }
            Function::Defined(name) => {
                let Some(NameBinding::Definition(definition)) = self.names.get(name.as_str())
                else {
                    let name = name.clone();
                    return Err(Error::new(span, ErrorKind::NotConstant { name }));
                };
                let definition: &'a Definition = definition;
                let names = definition.parameters.iter().flatten().map(|name| name.text.as_str());
                self.expand(function, arguments, names, &definition.body, span)
            }
        }
    }

    /// Expands a call: lowers the function's `body` with `names` bound to the arguments.
    #[inline(never)]
    pub(crate) fn expand(
        &mut self,
        function: &Function,
        arguments: Vec<Tensor>,
        names: impl Iterator<Item = &'a str>,
        body: &'a Expr,
        span: Span,
    ) -> Fallible<Tensor> {
        let key = (function.clone(), arguments);
        if let Some(value) = self.calls.get(&key) {
            return Ok(value.clone());
        }
        let locals: Vec<(&str, Tensor)> = names.zip(key.1.iter().cloned()).collect();
        let is_typed = matches!(function, Function::Defined(_));
        let defined = Defined::Call(key);
        self.expanded(Expansion { defined, locals, body, span, is_typed })
    }

    /// The n-th root of `radicand`. An odd root is also defined for negative numbers.
    #[inline(never)]
    fn root(&mut self, radicand: NodeId, index: NodeId, span: Span) -> Fallible<NodeId> {
        let whole = self.graph.number(index).and_then(Constant::as_integer);
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

/// Moves an error inside a definition to the place where the definition is used. An error in a
/// typed definition is moved only if it is one of size, which the use can avoid.
pub(crate) fn move_to_use(mut error: Box<Error>, span: Span, is_typed: bool) -> Box<Error> {
    if !is_typed || matches!(error.kind, ErrorKind::TooLarge { .. } | ErrorKind::TooDeep { .. }) {
        error.span = span;
    }
    error
}
