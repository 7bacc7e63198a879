//! Builds syntax trees from parsed statements. `juxtaposition` reads juxtaposed factors.

use crate::lex::scanner::LexedStatement;
use crate::lex::spelling::{plain_text, short_formula};
use crate::lex::token::span_of;
use crate::lex::token_kind::TokenKind::*;
use crate::limits::Limits;
use crate::messages::error::{Error, ErrorKind, Fallible};
use crate::messages::note::{MAX_NOTES, Note, NoteKind};
use crate::span::Span;
use crate::tree::aliases::Aliases;
use crate::tree::ast::{Chain, ChainSign, Expr, ExprKind, Function, Name, Relation};
use crate::tree::delimited::native;
use crate::tree::diagnose::recognise;
use crate::tree::foreign_functions::remainder;
use crate::tree::grammar::{Pair, Pairs, Rule, first_kind};
use crate::tree::print::factor_text;
use crate::tree::scope::{Callee, Conditions, Scope};
use rustc_hash::FxHashSet;
use zeroset_ops::{Op, VectorFunction};

/// Builds the trees of one statement.
pub struct Builder<'a> {
    /// The whole text.
    pub text: &'a str,
    /// The statement.
    pub lexed: &'a LexedStatement,
    /// The names that the statement may use.
    pub scope: &'a Scope,
    /// Parameters of the function being defined, then indices of the enclosing sums.
    pub locals: Vec<Name>,
    /// Variables of the program, with the expressions that they stand for.
    pub aliases: Aliases,
    /// The limits on the text.
    pub limits: &'a Limits,
    depth: usize,
    /// Number of parameters at the start of `locals`.
    parameters: usize,
    /// Notes on the statement so far.
    pub notes: Vec<Note>,
    /// Names that the document defines and this statement uses.
    pub used: FxHashSet<String>,
}

/// Plus and minus signs before a term or in an exponent, with their places.
pub(crate) type Signs = Vec<(ChainSign, Span)>;

impl<'a> Builder<'a> {
    /// Begins the trees of a statement. The parameters of the function being defined are `locals`.
    pub fn new(
        text: &'a str,
        lexed: &'a LexedStatement,
        scope: &'a Scope,
        locals: &'a [Name],
        limits: &'a Limits,
    ) -> Self {
        let (notes, used) = (Vec::new(), FxHashSet::default());
        let (locals, aliases) = (locals.to_vec(), Aliases::default());
        let parameters = locals.len();
        Self { text, lexed, scope, locals, aliases, limits, depth: 0, parameters, notes, used }
    }

    /// The expression that `name` stands for; `None` unless it is a variable of the program.
    pub(crate) fn alias(&mut self, name: &str) -> Option<ExprKind> {
        // The index of an enclosing sum hides a variable with the same name.
        let hidden = self.locals.iter().rposition(|local| local.text == name);
        let kind = self.aliases.find(name)?;
        if hidden.is_some_and(|at| at >= self.parameters) {
            return None;
        }
        let kind = kind.clone();
        let parts = Expr::new(kind.clone(), Span::default());
        let used = parts.all_parts().into_iter().filter_map(|part| part.kind.defined());
        self.used.extend(used.map(str::to_owned));
        Some(kind)
    }

    /// The place of `pair` in the text.
    pub fn span(&self, pair: &Pair<'_>) -> Span {
        let (start, end) = (pair.as_span().start(), pair.as_span().end());
        let tokens = &self.lexed.tokens[self.lexed.index(start)..self.lexed.index(end)];
        span_of(tokens).unwrap_or(Span::at(self.lexed.span.end))
    }

    /// The text that was typed for `pair`, a part of the statement.
    pub fn typed(&self, pair: &Pair<'_>) -> &'a str {
        &self.text[self.span(pair).range()]
    }

    /// The text that was typed for `pair`, with plain letters in place of styled ones.
    pub fn word(&self, pair: &Pair<'_>) -> String {
        plain_text(self.typed(pair))
    }

    pub(crate) fn note(&mut self, span: Span, kind: NoteKind) {
        // One note beyond the limit is kept. It shows that more notes were left out.
        if self.notes.len() > MAX_NOTES {
            return;
        }
        let once = kind.explains_a_name();
        if !once || self.notes.iter().all(|note| note.kind != kind) {
            self.notes.push(Note { span, kind });
        }
    }

    /// Runs `build` with `levels` added to the nesting depth. Fails if the sum exceeds the limit.
    pub(crate) fn nested<T>(
        &mut self,
        span: Span,
        levels: usize,
        build: impl FnOnce(&mut Self) -> Fallible<T>,
    ) -> Fallible<T> {
        self.check_depth(span, levels)?;
        self.depth += levels;
        let built = build(self);
        self.depth -= levels;
        built
    }

    /// Fails if the nesting depth plus `levels` exceeds the limit.
    pub(crate) fn check_depth(&self, span: Span, levels: usize) -> Fallible<()> {
        let limit = self.limits.depth;
        if self.depth + levels > limit {
            return Err(Error::new(span, ErrorKind::TooDeep { limit }));
        }
        Ok(())
    }

    /// Reads the whole statement as a single number.
    ///
    /// # Errors
    /// If the statement is not a number.
    ///
    /// # Panics
    /// Never: the grammar's rule holds an expression.
    pub fn only_expression(&mut self) -> Fallible<Expr> {
        let statement = recognise(self.text, self.lexed, Rule::constant)?;
        self.value(statement.into_inner().next().expect("a constant is an expression"))
    }

    /// Reads an expression, which must be a number.
    ///
    /// # Errors
    /// If the expression is not a number, or is wrong.
    pub fn value(&mut self, pair: Pair<'_>) -> Fallible<Expr> {
        let expr = self.expression(pair)?;
        number_only(&expr)?;
        Ok(expr)
    }

    /// Reads the two ends of a range.
    ///
    /// # Errors
    /// If an end is not a number.
    ///
    /// # Panics
    /// If `pair` is not of the grammar's rule for the ends of a range.
    pub fn bounds(&mut self, pair: Pair<'_>) -> Fallible<(Expr, Expr)> {
        let mut ends = pair.into_inner();
        let mut end = || ends.next().expect("bounds hold two expressions");
        Ok((self.value(end())?, self.value(end())?))
    }

    /// Reads an expression: a number or a condition.
    pub(crate) fn expression(&mut self, pair: Pair<'_>) -> Fallible<Expr> {
        let span = self.span(&pair);
        if pair.as_rule() != Rule::expression {
            // Ranges and generators have no value.
            let found = crate::lex::spelling::short_name(self.typed(&pair));
            return Err(Error::new(span, ErrorKind::Unexpected { found }));
        }
        let mut parts = parts_of(pair);
        self.nested(span, 1, |b| match parts.as_slice() {
            [_] => b.sum(parts.remove(0)),
            _ => b.condition(&parts),
        })
    }

    // The recursion over brackets runs through the following functions. Other work is in separate
    // functions, so it does not enlarge the stack frame of each recursion level.

    /// Builds a condition from negated comparisons that are joined by `and` and `or`.
    #[inline(never)]
    fn condition(&mut self, parts: &[Pair<'_>]) -> Fallible<Expr> {
        let mut any = Vec::new();
        for parts in parts.split(|part| first_kind(part) == Some(Or)) {
            let mut all = Vec::new();
            for parts in parts.split(|part| first_kind(part) == Some(And)) {
                let expr = match parts {
                    [only] => self.sum(only.clone()).map(|expr| self.as_condition(expr)),
                    _ => self.negation(parts),
                };
                push(&mut all, expr)?;
            }
            push(&mut any, joined(all, "and"))?;
        }
        joined(any, "or")
    }

    /// Builds a chain of comparisons with any number of `not` before it.
    #[inline(never)]
    fn negation(&mut self, parts: &[Pair<'_>]) -> Fallible<Expr> {
        let count = parts.iter().take_while(|part| part.as_rule() == Rule::not).count();
        let (words, chain) = parts.split_at(count);
        if let Some(first) = words.first() {
            self.check_depth(self.span(first), count)?;
        }
        let sides = self.chain(chain)?;
        self.negated_comparison(sides, words)
    }

    /// Builds a chain of comparisons and negates it once for each `not` in `words`.
    #[inline(never)]
    fn negated_comparison(&self, sides: Sides, words: &[Pair<'_>]) -> Fallible<Expr> {
        let mut expr = compared(sides)?;
        for word in words.iter().rev() {
            condition_only(&expr, "not")?;
            let span = self.span(word).to(expr.span);
            expr = Expr::new(ExprKind::Not(Box::new(expr)), span);
        }
        Ok(expr)
    }

    /// Reads the sides of a chain of comparisons.
    fn chain(&mut self, parts: &[Pair<'_>]) -> Fallible<Sides> {
        let mut sides = Vec::new();
        let mut place = Span::at(0);
        let mut relation_before = Relation::Equal;
        for (index, part) in parts.iter().enumerate() {
            if index % 2 == 0 {
                let side = self.sum(part.clone())?;
                let is_compared = parts.len() > 1;
                let side = if is_compared { self.as_number(side) } else { side };
                sides.push((relation_before, place, side));
            } else {
                (relation_before, place) = (relation(part), self.span(part));
            }
        }
        Ok(sides)
    }

    /// Reads a sum of terms.
    ///
    /// # Errors
    /// If a term is wrong.
    #[inline(never)]
    pub fn sum(&mut self, pair: Pair<'_>) -> Fallible<Expr> {
        let mut pairs = pair.into_inner();
        let mut before = ChainSign::Direct;
        let mut terms = Vec::new();
        loop {
            terms.push((before, self.term(&mut pairs)?));
            // The signs plus and minus separate the terms.
            let Some(operator) = pairs.next() else {
                return chain_of(Chain::Sum, self.numbers(terms));
            };
            before = sign(&operator);
        }
    }

    /// Reads a term: a product and the signs before it.
    ///
    /// # Errors
    /// If a factor is wrong.
    pub fn term(&mut self, pairs: &mut Pairs<'_>) -> Fallible<Expr> {
        let signs = self.signs(pairs);
        let of_term = |pair: &Pair<'_>| !matches!(first_kind(pair), Some(Plus | Minus));
        if signs.is_empty() || pairs.clone().take_while(of_term).any(|pair| is_remainder(&pair)) {
            return self.product(signs, pairs);
        }
        self.signed(&signs, |b| b.product(Signs::new(), pairs))
    }

    /// Takes all signs before the next term or factor.
    #[inline(never)]
    pub(crate) fn signs(&self, pairs: &mut Pairs<'_>) -> Signs {
        let mut signs = Signs::new();
        while let Some(pair) = pairs.peek().filter(|pair| pair.as_rule() == Rule::sign) {
            signs.push((sign(&pair), self.span(&pair)));
            pairs.next();
        }
        signs
    }

    /// Negates the result of `build` once for each minus in `signs`.
    pub(crate) fn signed(
        &mut self,
        signs: &[(ChainSign, Span)],
        build: impl FnOnce(&mut Self) -> Fallible<Expr>,
    ) -> Fallible<Expr> {
        let Some((_, first)) = signs.first() else {
            return build(self);
        };
        let minus = signs.iter().filter(|(sign, _)| *sign == ChainSign::Inverse);
        let expr = self.nested(*first, minus.count(), build)?;
        negated(self.as_number(expr), signs)
    }

    /// A condition as 1 or 0, in a text whose conditions are numbers.
    pub(crate) fn as_number(&self, expr: Expr) -> Expr {
        if self.scope.conditions == Conditions::Apart || !expr.is_condition() {
            return expr;
        }
        let span = expr.span;
        expr.indicator(span)
    }

    /// The operands of a chain. Conditions become numbers if there are several operands.
    fn numbers(&self, operands: Vec<(ChainSign, Expr)>) -> Vec<(ChainSign, Expr)> {
        if operands.len() == 1 || self.scope.conditions == Conditions::Apart {
            return operands;
        }
        operands.into_iter().map(|(sign, expr)| (sign, self.as_number(expr))).collect()
    }

    /// A number as a condition, in a text of `MathMod`: it holds where the number is 1/2 or more.
    pub(crate) fn as_condition(&self, expr: Expr) -> Expr {
        if self.scope.conditions != Conditions::OfMathMod || expr.is_condition() {
            return expr;
        }
        let span = expr.span;
        native(Op::Abs, expr, span).compared(
            Relation::GreaterEqual,
            Expr::of_digits("0.5", span),
            span,
        )
    }

    /// Reads a product. The signs `before` belong to the left operand of the first remainder.
    #[inline(never)]
    fn product(&mut self, mut before: Signs, pairs: &mut Pairs<'_>) -> Fallible<Expr> {
        let mut joint = RowOperator { sign: ChainSign::Direct, function: None, is_dot: false };
        let mut factors: Vec<(ChainSign, Expr)> = Vec::new();
        loop {
            let signs = self.signs(pairs);
            let row = self.row(pairs)?;
            self.join(&mut factors, joint, &signs, row)?;
            if pairs.peek().is_some_and(|pair| is_remainder(&pair)) {
                // As in other languages, the left operand of a remainder is the whole product
                // before the sign.
                let signs = std::mem::take(&mut before);
                let whole = self
                    .signed(&signs, |_| chain_of(Chain::Product, std::mem::take(&mut factors)))?;
                factors.push((ChainSign::Direct, whole));
            }
            match self.joint(pairs) {
                Some(next) => joint = next,
                None => return chain_of(Chain::Product, self.numbers(factors)),
            }
        }
    }

    /// Takes the operator before the next row of factors; `None` at the end of the product.
    #[inline(never)]
    fn joint(&mut self, pairs: &mut Pairs<'_>) -> Option<RowOperator> {
        let operator = pairs.peek()?;
        let is_dot = matches!(self.typed(&operator), "·" | "⋅" | "∙" | "•" | r"\cdot");
        let (sign, function) = match first_kind(&operator)? {
            Star => (ChainSign::Direct, None),
            Slash => (ChainSign::Inverse, None),
            DotProduct => (ChainSign::Direct, Some(Function::OfVectors(VectorFunction::Dot))),
            Remainder => {
                // The word `mod` is unambiguous. Only the sign `%` gets a note.
                if self.typed(&operator).contains('%') {
                    self.note(self.span(&operator), NoteKind::Remainder);
                }
                let remainder = self.scope.signatures(&Callee::BuiltIn("mod".to_owned()));
                (ChainSign::Direct, remainder.function(2))
            }
            _ => return None,
        };
        pairs.next();
        Some(RowOperator { sign, function, is_dot })
    }

    /// Appends a row of juxtaposed factors to the factors before it.
    #[inline(never)]
    fn join(
        &mut self,
        factors: &mut Vec<(ChainSign, Expr)>,
        mut joint: RowOperator,
        signs: &Signs,
        row: Vec<Expr>,
    ) -> Fallible<()> {
        let mut row = row.into_iter();
        let first = row.next().expect("a run has a first factor");
        let first = self.signed(signs, |_| Ok(first))?;
        let others: Vec<Expr> = row.collect();
        if joint.is_dot
            && self.is_vector(&first)
            && factors.last().is_some_and(|(_, left)| self.is_vector(left))
        {
            joint.function = Some(Function::OfVectors(VectorFunction::Dot));
        }
        let first = match (factors.pop(), joint.function) {
            (Some((sign, left)), Some(function)) => {
                joint.sign = sign;
                let span = left.span.to(first.span);
                if self.scope.conditions == Conditions::OfMathMod {
                    let expr = remainder(Op::Trunc, self.as_number(left), first, span)?;
                    factors.push((sign, expr));
                    return Ok(());
                }
                Expr::new(ExprKind::Call(function, vec![left, first]), span)
            }
            (before, _) => {
                factors.extend(before);
                first
            }
        };
        if joint.sign == ChainSign::Inverse {
            self.note_division(factors, &first, &others);
        }
        factors.push((joint.sign, first));
        factors.extend(others.into_iter().map(|f| (ChainSign::Direct, f)));
        Ok(())
    }

    /// Adds a note to a division whose writer may have meant another grouping.
    fn note_division(&mut self, before: &[(ChainSign, Expr)], divisor: &Expr, others: &[Expr]) {
        let Some((_, numerator)) = before.last() else {
            return;
        };
        let (kind, end) = match others.last() {
            Some(last) => (Some(implicit_division(numerator, divisor, others)), last.span),
            None => (divided_power(numerator, divisor), divisor.span),
        };
        if let Some(kind) = kind {
            self.note(numerator.span.to(end), kind);
        }
    }
}

/// The operator before a row of juxtaposed factors.
struct RowOperator {
    sign: ChainSign,
    /// Function of the two factors beside the operator, such as a remainder.
    function: Option<Function>,
    /// True if it is a dot, which between two vectors is the scalar product.
    is_dot: bool,
}

/// Sides of a chain of comparisons. Each has the relation before it, and the relation's place.
type Sides = Vec<(Relation, Span, Expr)>;

#[inline(never)]
fn parts_of(pair: Pair<'_>) -> Vec<Pair<'_>> {
    pair.into_inner().collect()
}

#[inline(never)]
fn push(all: &mut Vec<Expr>, expr: Fallible<Expr>) -> Fallible<()> {
    all.push(expr?);
    Ok(())
}

/// Builds a chain of comparisons. Returns a single side unchanged.
fn compared(mut sides: Sides) -> Fallible<Expr> {
    let (_, _, first) = sides.remove(0);
    let Some((_, _, last)) = sides.last() else { return Ok(first) };
    let span = first.span.to(last.span);
    let mut equals = sides.iter().filter(|(relation, ..)| *relation == Relation::Equal);
    if let Some((_, place, _)) = equals.next() {
        if let Some((_, place, _)) = equals.next() {
            return Err(Error::new(*place, ErrorKind::SeveralEquals));
        }
        if sides.len() > 1 {
            return Err(Error::new(*place, ErrorKind::MixedChain));
        }
    }
    numbers_only(std::iter::once(&first).chain(sides.iter().map(|(.., side)| side)))?;
    let rest = sides.into_iter().map(|(relation, _, side)| (relation, side)).collect();
    Ok(Expr::new(ExprKind::Compare(Box::new(first), rest), span))
}

/// Negates a number once for each minus in `signs`.
#[inline(never)]
fn negated(mut expr: Expr, signs: &[(ChainSign, Span)]) -> Fallible<Expr> {
    number_only(&expr)?;
    for (_, span) in signs.iter().rev().filter(|(sign, _)| *sign == ChainSign::Inverse) {
        let span = span.to(expr.span);
        expr = expr.negated(span);
    }
    Ok(expr)
}

/// The note on `1/2x`, whose writer may have meant the divisor `2x`.
fn implicit_division(numerator: &Expr, divisor: &Expr, others: &[Expr]) -> NoteKind {
    let product = |factors: &mut dyn Iterator<Item = &Expr>| {
        short_formula(&factors.map(factor_text).collect::<Vec<_>>().join("*"))
    };
    let top = short_formula(&factor_text(numerator));
    let bottom = short_formula(&factor_text(divisor));
    let tail = product(&mut others.iter());
    let whole = product(&mut std::iter::once(divisor).chain(others));
    NoteKind::ImplicitDivision {
        read: format!("({top}/{bottom})*{tail}"),
        other: format!("{top}/({whole})"),
    }
}

/// The note on `x^1/3` and `x^-1/2`, which are read as `(x^1)/3` and `(x^-1)/2`. The 1 is probably
/// a numerator.
fn divided_power(power: &Expr, divisor: &Expr) -> Option<NoteKind> {
    let ExprKind::Power(base, exponent) = &power.kind else {
        return None;
    };
    let index = divisor.whole_number().filter(|index| *index >= 2)?;
    let (sign, top, exponent) = match &exponent.kind {
        ExprKind::Negate(inner) => ("-", "1/", inner),
        _ => ("", "", exponent),
    };
    if exponent.number() != Some("1") {
        return None;
    }
    let read = format!("({}^{sign}1)/{index}", short_formula(&factor_text(base)));
    Some(NoteKind::DividedPower { read, root: format!("{top}{}", root_text(base, index)) })
}

/// The text of the `index`-th root of `radicand`.
pub(crate) fn root_text(radicand: &Expr, index: u32) -> String {
    let radicand = short_formula(&radicand.to_string());
    match index {
        2 => format!("sqrt({radicand})"),
        3 => format!("cbrt({radicand})"),
        _ => format!("root({radicand}, {index})"),
    }
}

/// Returns whether `pair` is the operator of a remainder.
fn is_remainder(pair: &Pair<'_>) -> bool {
    first_kind(pair) == Some(Remainder)
}

/// A sum or a product of one or more operands. Several operands must all be numbers. The first
/// operand's sign is ignored.
#[inline(never)]
pub(crate) fn chain_of(kind: Chain, mut operands: Vec<(ChainSign, Expr)>) -> Fallible<Expr> {
    let (_, first) = operands.remove(0);
    let Some((_, last)) = operands.last() else { return Ok(first) };
    let span = first.span.to(last.span);
    numbers_only(std::iter::once(&first).chain(operands.iter().map(|(_, operand)| operand)))?;
    Ok(Expr::chain(kind, first, operands, span))
}

/// The product of one or more factors.
pub(crate) fn product_of(factors: impl IntoIterator<Item = Expr>) -> Fallible<Expr> {
    chain_of(Chain::Product, factors.into_iter().map(|part| (ChainSign::Direct, part)).collect())
}

/// The quotient of the first part by each later part in turn.
///
/// # Errors
/// If a part is not a number.
pub fn quotient_of(parts: impl IntoIterator<Item = Expr>) -> Fallible<Expr> {
    chain_of(Chain::Product, parts.into_iter().map(|part| (ChainSign::Inverse, part)).collect())
}

#[inline(never)]
pub(crate) fn sign(pair: &Pair<'_>) -> ChainSign {
    if first_kind(pair) == Some(Plus) { ChainSign::Direct } else { ChainSign::Inverse }
}

pub(crate) fn relation(pair: &Pair<'_>) -> Relation {
    match first_kind(pair) {
        Some(Equals) => Relation::Equal,
        Some(NotEqual) => Relation::Unequal,
        Some(Less) => Relation::Less,
        Some(LessEqual) => Relation::LessEqual,
        Some(Greater) => Relation::Greater,
        Some(GreaterEqual) => Relation::GreaterEqual,
        other => unreachable!("the grammar has no relation {other:?}"),
    }
}

/// Joins conditions by `word`, which is `and` or `or`. Returns a single operand unchanged.
#[inline(never)]
pub(crate) fn joined(mut operands: Vec<Expr>, word: &'static str) -> Fallible<Expr> {
    if operands.len() == 1 {
        return Ok(operands.remove(0));
    }
    for operand in &operands {
        condition_only(operand, word)?;
    }
    let span = operands[0].span.to(operands[operands.len() - 1].span);
    // `(a and b) and c` becomes `a and b and c`.
    let first = operands.remove(0);
    let mut all = match (first.kind, word) {
        (ExprKind::And(inner), "and") | (ExprKind::Or(inner), "or") => inner,
        (kind, _) => vec![Expr::new(kind, first.span)],
    };
    all.extend(operands);
    let kind = if word == "and" { ExprKind::And(all) } else { ExprKind::Or(all) };
    Ok(Expr::new(kind, span))
}

/// Fails if `expr` is a condition instead of a number.
pub(crate) fn number_only(expr: &Expr) -> Fallible<()> {
    if expr.is_condition() {
        return Err(Error::new(expr.span, ErrorKind::ConditionAsValue));
    }
    Ok(())
}

/// Fails if any of `exprs` is a condition instead of a number.
pub(crate) fn numbers_only<'e>(exprs: impl IntoIterator<Item = &'e Expr>) -> Fallible<()> {
    exprs.into_iter().try_for_each(number_only)
}

/// Fails if `expr` is a number instead of a condition, which `word` requires.
pub(crate) fn condition_only(expr: &Expr, word: &'static str) -> Fallible<()> {
    if !expr.is_condition() {
        return Err(Error::new(expr.span, ErrorKind::ValueAsCondition { word }));
    }
    Ok(())
}
