//! Lowers choices between values, sums and products over whole numbers, and repeated functions. All
//! are expanded where they are used.
//!
//! A choice becomes selections by the signs of margins, such as a − b for a > b. Kernels treat the
//! branches separately, so they never take a jump between two branches for a zero. A comparison
//! does not hold where a side has no value. A choice without a last value is undefined where no
//! condition holds.

use crate::lower::condition::{Purpose, comparisons, has_one_sign, sides};
use crate::lower::lowering::{Locals, Lowering};
use crate::lower::prelude;
use crate::lower::value::Tensor;
use zeroset_ir::{Graph, Node, NodeId};
use zeroset_ops::{Op, Sequence};
use zeroset_parser::tree::ast::{Expr, ExprKind, Function, Relation, Series};
use zeroset_parser::tree::scope::signatures;
use zeroset_parser::tree::series::MAX_TERMS;
use zeroset_parser::{Error, ErrorKind, Fallible, Span};

/// Largest number of nodes to visit to find a whole number.
const MAX_STEPS: usize = 256;

/// Largest number of a function in a sequence, such as the degree of a polynomial.
const MAX_DEGREE: i64 = 100;

/// Largest number of nodes to visit in a margin that is a choice between numbers.
const MAX_LEAVES: usize = 500;

impl<'a> Lowering<'a> {
    /// Lowers a choice: the value of the first piece whose condition holds, else `otherwise`.
    pub(crate) fn choice(
        &mut self,
        pieces: &'a [(Expr, Expr)],
        otherwise: Option<&'a Expr>,
        locals: &Locals<'a>,
    ) -> Fallible<Tensor> {
        if let Some(argument) = as_sinc(pieces, otherwise)
            && let Some(sinc) = signatures("sinc", false).function(1)
        {
            let argument = self.value_of(argument, locals)?;
            return self.call(&sinc, vec![argument], pieces[0].0.span);
        }
        let exprs = pieces.iter().map(|(_, value)| value).chain(otherwise);
        let mut values = self.values_of(exprs, locals)?;
        let mut rest = otherwise.and_then(|_| values.pop());
        for ((condition, place), value) in pieces.iter().zip(values).rev() {
            let operands: Vec<Tensor> = std::iter::once(value).chain(rest).collect();
            rest = Some(self.by_component(&operands, place.span, |all, parts| match parts {
                [yes, no] => all.choose(condition, false, *yes, *no, locals),
                only => all.only_where(only[0], condition, locals),
            })?);
        }
        rest.ok_or_else(|| Error::new(Span::default(), ErrorKind::Empty))
    }

    /// `yes` where `condition` holds, else `no`. `negated` replaces the condition by its opposite.
    fn choose(
        &mut self,
        condition: &'a Expr,
        negated: bool,
        yes: NodeId,
        no: NodeId,
        locals: &Locals<'a>,
    ) -> Fallible<NodeId> {
        if has_one_sign(condition) {
            let (margin, strict) = self.margin(condition, negated, Purpose::Restriction, locals)?;
            return Ok(self.select_by_margin(margin, strict, yes, no));
        }
        match &condition.kind {
            ExprKind::And(items) | ExprKind::Or(items) => {
                let all = matches!(condition.kind, ExprKind::And(_)) != negated;
                let mut node = if all { yes } else { no };
                for item in items.iter().rev() {
                    let (yes, no) = if all { (node, no) } else { (yes, node) };
                    node = self.choose(item, negated, yes, no, locals)?;
                }
                Ok(node)
            }
            ExprKind::Not(inner) => self.choose(inner, !negated, yes, no, locals),
            ExprKind::Compare(first, rest) => {
                let mut node = if negated { no } else { yes };
                for (left, relation, right) in comparisons(first, rest) {
                    let relation = if negated { relation.opposite() } else { relation };
                    let (yes, no) = if negated { (yes, node) } else { (node, no) };
                    node = self.compare(left, relation, right, (yes, no), locals)?;
                }
                Ok(node)
            }
            _ => Err(Error::new(condition.span, ErrorKind::ValueAsCondition { word: "if" })),
        }
    }

    /// `yes` where the comparison holds, `no` elsewhere.
    fn compare(
        &mut self,
        left: &'a Expr,
        relation: Relation,
        right: &'a Expr,
        (yes, no): (NodeId, NodeId),
        locals: &Locals<'a>,
    ) -> Fallible<NodeId> {
        let Some((low, high, strict)) = sides(left, relation, right) else {
            let is_equal = relation == Relation::Equal;
            let difference = self.difference(left, right, locals)?;
            // Neither `=` nor `!=` holds where a side has no value.
            let difference = self.or_outside(difference, i64::from(is_equal));
            let (at, off) = if is_equal { (yes, no) } else { (no, yes) };
            let opposite = self.graph.apply(Op::Neg, &[difference]);
            let above = self.graph.apply(Op::SelectNegative, &[opposite, off, at]);
            return Ok(self.graph.apply(Op::SelectNegative, &[difference, off, above]));
        };
        let margin = self.difference(high, low, locals)?;
        let margin = self.or_outside(margin, -1);
        Ok(self.select_by_margin(margin, strict, yes, no))
    }

    /// `yes` where `margin` is positive, else `no`. A margin of 0 gives `yes` unless `strict`.
    fn select_by_margin(
        &mut self,
        margin: NodeId,
        strict: bool,
        yes: NodeId,
        no: NodeId,
    ) -> NodeId {
        // The margin may itself select between numbers, for example whether a program has left a
        // loop. Each number has a known sign, but bounds that cover all the numbers have none.
        if let Some(node) =
            self.select_among_numbers(margin, strict, (yes, no), &mut MAX_LEAVES.clone())
        {
            return node;
        }
        if strict {
            let below = self.graph.apply(Op::Neg, &[margin]);
            self.graph.apply(Op::SelectNegative, &[below, yes, no])
        } else {
            self.graph.apply(Op::SelectNegative, &[margin, no, yes])
        }
    }

    /// Selects one of `values` by the sign of a margin that is itself a choice between numbers;
    /// `None` for any other margin.
    fn select_among_numbers(
        &mut self,
        margin: NodeId,
        strict: bool,
        values: (NodeId, NodeId),
        left: &mut usize,
    ) -> Option<NodeId> {
        *left = left.checked_sub(1)?;
        let operands = match self.graph.node(margin) {
            Node::Constant(constant) => {
                let bounds = constant.bounds();
                let holds = if constant.is_zero() { !strict } else { bounds.lo > 0.0 };
                return Some(if holds { values.0 } else { values.1 });
            }
            Node::Apply(op, operands) if *op == Op::SelectNegative => operands.to_vec(),
            Node::Variable(_) | Node::Parameter(_) | Node::Apply(..) => return None,
        };
        let by = operands[0];
        let below = self.select_among_numbers(operands[1], strict, values, left)?;
        let above = self.select_among_numbers(operands[2], strict, values, left)?;
        if below == above && self.total.get(by.index()) == Some(&true) {
            return Some(below);
        }
        Some(self.graph.apply(Op::SelectNegative, &[by, below, above]))
    }

    /// `node` where `condition` holds; undefined elsewhere.
    fn only_where(
        &mut self,
        node: NodeId,
        condition: &'a Expr,
        locals: &Locals<'a>,
    ) -> Fallible<NodeId> {
        if is_restriction(condition) {
            return self.restrict(node, condition, locals);
        }
        // The margin is 1 where the condition holds, and −1 elsewhere.
        let (yes, no) = (self.graph.integer(1), self.graph.integer(-1));
        let margin = self.choose(condition, false, yes, no, locals)?;
        Ok(self.graph.apply(Op::WherePositive, &[node, margin]))
    }

    /// Lowers a sum or a product, written out term by term.
    pub(crate) fn series(
        &mut self,
        series: &'a Series,
        span: Span,
        locals: &Locals<'a>,
    ) -> Fallible<Tensor> {
        let low = self.whole(&series.low, locals)?;
        let high = self.whole(&series.high, locals)?;
        let step = series.step.as_ref();
        let place = step.map_or(span, |step| step.span);
        let step = step.map_or(Ok(1), |step| self.whole(step, locals))?;
        if step < 1 {
            return Err(Error::new(place, ErrorKind::SeriesStep));
        }
        if high.saturating_sub(low) / step >= MAX_TERMS {
            let place = series.low.span.to(series.high.span);
            return Err(Error::new(place, ErrorKind::TooManyTerms { limit: MAX_TERMS }));
        }
        let op = if series.is_product { Op::Mul } else { Op::Add };
        let mut all = None;
        let mut k = low;
        while k <= high {
            let mut inner = locals.to_vec();
            inner.push((series.index.text.as_str(), Tensor::Number(self.graph.integer(k))));
            let term = self.value_of(&series.body, &inner)?;
            all = Some(match all {
                None => term,
                Some(all) => self.native(op, &[all, term], span)?,
            });
            k += step;
        }
        let empty = i64::from(series.is_product);
        Ok(all.unwrap_or_else(|| Tensor::Number(self.graph.integer(empty))))
    }

    /// The function of a sequence. The first argument is the number of the function.
    pub(crate) fn numbered(
        &mut self,
        index: usize,
        sequence: &'a Sequence<Expr>,
        arguments: Vec<Tensor>,
        span: Span,
    ) -> Fallible<Tensor> {
        let number = match &arguments[0] {
            Tensor::Number(node) => integer_of(&self.graph, *node, &mut { MAX_STEPS }),
            Tensor::Vector(_) | Tensor::Matrix(_) | Tensor::Complex(_) => None,
        };
        let limit =
            if let Sequence::Listed(all) = sequence { all.len() as i64 } else { MAX_DEGREE };
        let Some(number) = number.filter(|number| (0..=limit).contains(number)) else {
            let name = zeroset_ops::COMPOSED[index].name;
            return Err(Error::new(span, ErrorKind::NumberInSequence { name, limit }));
        };
        let names = zeroset_ops::COMPOSED[index].parameters.iter().copied();
        let mut locals: Vec<(&str, Tensor)> = names.zip(arguments).collect();
        let mut before = self.value_of(prelude::body(index), &locals)?;
        if number == 0 {
            return Ok(before);
        }
        let (Sequence::Recurrence([second, ..])
        | Sequence::Doubling([second, ..])
        | Sequence::Listed([second, ..])) = sequence;
        let mut value = self.value_of(second, &locals)?;
        let with = |locals: &Locals<'a>, p: &Tensor, q: &Tensor| {
            [locals, &[("p", p.clone()), ("q", q.clone())]].concat()
        };
        match sequence {
            Sequence::Listed(all) => value = self.value_of(&all[number as usize - 1], &locals)?,
            Sequence::Recurrence([_, next]) => {
                for n in 1..number {
                    locals[0].1 = Tensor::Number(self.graph.integer(n));
                    let both = with(&locals, &value, &before);
                    before = std::mem::replace(&mut value, self.value_of(next, &both)?);
                }
            }
            Sequence::Doubling([_, even, odd]) => {
                // From n = 1, each digit of `number` − 1 in base 2 leads to 2n, or to 2n − 1 for
                // the digit 0.
                let digits = (number - 1).checked_ilog2().map_or(0, |last| last + 1);
                for digit in (0..digits).rev() {
                    let both = with(&locals, &value, &before);
                    let below = self.value_of(odd, &both)?;
                    (value, before) = if (number - 1) >> digit & 1 == 1 {
                        (self.value_of(even, &both)?, below)
                    } else {
                        (below, self.value_of(even, &with(&locals, &before, &before))?)
                    };
                }
            }
        }
        Ok(value)
    }

    /// Applies a function repeatedly. `arguments` are the number of repetitions, the start value,
    /// and further arguments that each repetition gets unchanged.
    pub(crate) fn iterate(
        &mut self,
        function: &Function,
        mut arguments: Vec<Tensor>,
        span: Span,
    ) -> Fallible<Tensor> {
        let count = match arguments.remove(0) {
            Tensor::Number(node) => integer_of(&self.graph, node, &mut { MAX_STEPS }),
            Tensor::Vector(_) | Tensor::Matrix(_) | Tensor::Complex(_) => None,
        };
        let Some(count) = count.filter(|count| *count >= 0) else {
            return Err(Error::new(span, ErrorKind::RangeNotWhole));
        };
        if count > MAX_TERMS {
            return Err(Error::new(span, ErrorKind::TooManyTerms { limit: MAX_TERMS }));
        }
        let mut value = arguments.remove(0);
        for _ in 0..count {
            let mut all = vec![value];
            all.extend(arguments.iter().cloned());
            value = self.call(function, all, span)?;
        }
        Ok(value)
    }

    /// The whole number that an expression evaluates to.
    fn whole(&mut self, expr: &'a Expr, locals: &Locals<'a>) -> Fallible<i64> {
        let node = self.number(expr, locals)?;
        match integer_of(&self.graph, node, &mut { MAX_STEPS }) {
            Some(whole) if whole.abs() <= 1_000_000_000 => Ok(whole),
            Some(_) => Err(Error::new(expr.span, ErrorKind::TooManyTerms { limit: MAX_TERMS })),
            None => Err(Error::new(expr.span, ErrorKind::RangeNotWhole)),
        }
    }
}

/// The whole number that a node evaluates to. Visits at most `steps` nodes.
pub(crate) fn integer_of(graph: &Graph, node: NodeId, steps: &mut usize) -> Option<i64> {
    *steps = steps.checked_sub(1)?;
    let (op, operands) = match graph.node(node) {
        Node::Constant(constant) => return constant.as_integer(),
        Node::Apply(op, operands) if operands.len() <= 2 => (*op, operands),
        Node::Variable(_) | Node::Parameter(_) | Node::Apply(..) => return None,
    };
    let a = integer_of(graph, operands[0], steps)?;
    if op == Op::Neg {
        return a.checked_neg();
    }
    let b = integer_of(graph, *operands.get(1)?, steps)?;
    // The ends of a range may contain only the following operations.
    if op == Op::Add {
        a.checked_add(b)
    } else if op == Op::Sub {
        a.checked_sub(b)
    } else if op == Op::Mul {
        a.checked_mul(b)
    } else if op == Op::Div {
        (a.checked_rem(b)? == 0).then(|| a / b)
    } else if op == Op::Pow {
        a.checked_pow(u32::try_from(b).ok()?)
    } else {
        None
    }
}

/// Returns a if the choice is `{a = 0: 1, sin(a)/a}`, which is sinc(a). Enclosures of sinc near 0
/// are narrow. Enclosures of the quotient are not.
fn as_sinc<'e>(pieces: &'e [(Expr, Expr)], otherwise: Option<&'e Expr>) -> Option<&'e Expr> {
    let ([(condition, one)], Some(quotient)) = (pieces, otherwise) else { return None };
    let ExprKind::Compare(left, rest) = &condition.kind else { return None };
    let [(Relation::Equal, zero)] = rest.as_slice() else { return None };
    let (sine, divisor) = quotient.quotient()?;
    let is_number = |expr: &Expr, value| expr.whole_number() == Some(value);
    let ExprKind::Call(Function::Native(Op::Sin), arguments) = &sine.kind else { return None };
    let is_sinc = is_number(zero, 0)
        && is_number(one, 1)
        && divisor == &**left
        && arguments.as_slice() == std::slice::from_ref(&**left);
    is_sinc.then_some(&**left)
}

/// Returns whether `restrict` accepts a condition.
fn is_restriction(condition: &Expr) -> bool {
    match &condition.kind {
        ExprKind::And(items) => items.iter().all(is_restriction),
        ExprKind::Compare(_, rest) => rest.iter().all(|(relation, _)| *relation != Relation::Equal),
        _ => has_one_sign(condition),
    }
}

#[cfg(test)]
mod tests {
    use crate::document::reading::{Options, read};

    #[test]
    fn a_choice_that_is_sinc_is_read_as_sinc() {
        let nodes = |text: &str| {
            let document = read(text, &Options::default()).expect("reads");
            document.graph.iter().map(|(_, node)| node.clone()).collect::<Vec<_>>()
        };
        assert_eq!(nodes("z = {x*y = 0: 1, sin(x*y)/(x*y)}"), nodes("z = sinc(x*y)"));
        assert_ne!(nodes("z = {x*y = 0: 2, sin(x*y)/(x*y)}"), nodes("z = sinc(x*y)"));
    }
}
