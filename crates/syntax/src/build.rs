//! From what the grammar recognised to the syntax tree: everything but runs of factors, which `run` shapes.

use crate::ast::{Expr, ExprKind, Name, ProductSign, Relation, SumSign};
use crate::error::{Error, ErrorKind, Fallible};
use crate::grammar::{Pair, Rule};
use crate::limits::Limits;
use crate::note::{MOST_NOTES, Note, NoteKind};
use crate::print::factor_text;
use crate::scope::Scope;
use crate::span::Span;
use rustc_hash::FxHashSet;

/// Builds the trees of one statement.
pub(crate) struct Builder<'a> {
    /// The whole text.
    pub text: &'a str,
    /// Where the statement starts in it.
    pub base: usize,
    pub scope: &'a Scope,
    /// Parameters of the function being defined.
    pub locals: &'a [Name],
    pub limits: &'a Limits,
    pub depth: usize,
    pub notes: Vec<Note>,
    /// Names of the document that were used.
    pub used: FxHashSet<String>,
}

impl<'a> Builder<'a> {
    pub(crate) fn new(
        text: &'a str,
        base: usize,
        scope: &'a Scope,
        locals: &'a [Name],
        limits: &'a Limits,
    ) -> Self {
        Self {
            text,
            base,
            scope,
            locals,
            limits,
            depth: 0,
            notes: Vec::new(),
            used: FxHashSet::default(),
        }
    }

    pub(crate) fn span(&self, pair: &Pair<'_>) -> Span {
        let span = pair.as_span();
        Span::new(self.base + span.start(), self.base + span.end())
    }

    pub(crate) fn note(&mut self, span: Span, kind: NoteKind) {
        // One more than a document keeps tells it that there are more.
        if self.notes.len() > MOST_NOTES {
            return;
        }
        let once = matches!(kind, NoteKind::ConstantUsed { .. } | NoteKind::ProductOfNames { .. });
        if !once || self.notes.iter().all(|note| note.kind != kind) {
            self.notes.push(Note { span, kind });
        }
    }

    /// Runs `build` one level deeper.
    pub(crate) fn nested<T>(
        &mut self,
        span: Span,
        build: impl FnOnce(&mut Self) -> Fallible<T>,
    ) -> Fallible<T> {
        self.room(span, 1)?;
        self.depth += 1;
        let built = build(self);
        self.depth -= 1;
        built
    }

    /// Fails unless `levels` more levels are allowed here.
    pub(crate) fn room(&self, span: Span, levels: usize) -> Fallible<()> {
        let limit = self.limits.depth;
        if self.depth + levels > limit {
            return Err(Error::new(span, ErrorKind::TooDeep { limit }));
        }
        Ok(())
    }

    /// An expression that must be a number.
    pub(crate) fn value(&mut self, pair: Pair<'_>) -> Fallible<Expr> {
        let expr = self.expression(pair)?;
        number_only(&expr)?;
        Ok(expr)
    }

    /// An expression: a number or a condition.
    pub(crate) fn expression(&mut self, pair: Pair<'_>) -> Fallible<Expr> {
        let span = self.span(&pair);
        self.nested(span, |b| b.joined(pair, "or", |b, pair| b.joined(pair, "and", Self::negation)))
    }

    /// One operand, or several joined by `word`.
    fn joined(
        &mut self,
        pair: Pair<'_>,
        word: &'static str,
        operand: impl Fn(&mut Self, Pair<'_>) -> Fallible<Expr>,
    ) -> Fallible<Expr> {
        let span = self.span(&pair);
        let mut operands = Vec::new();
        for child in pair.into_inner() {
            match child.as_rule() {
                Rule::or_word | Rule::and_word => {}
                _ => operands.push(operand(self, child)?),
            }
        }
        if operands.len() == 1 {
            return Ok(operands.remove(0));
        }
        for operand in &operands {
            condition_only(operand, word)?;
        }
        // `(a and b) and c` is the same as `a and b and c`.
        let first = operands.remove(0);
        let mut all = match (first.kind, word) {
            (ExprKind::And(inner), "and") | (ExprKind::Or(inner), "or") => inner,
            (kind, _) => vec![Expr::new(kind, first.span)],
        };
        all.extend(operands);
        let kind = if word == "and" { ExprKind::And(all) } else { ExprKind::Or(all) };
        Ok(Expr::new(kind, span))
    }

    fn negation(&mut self, pair: Pair<'_>) -> Fallible<Expr> {
        let mut words = Vec::new();
        let mut inner = None;
        for child in pair.into_inner() {
            match child.as_rule() {
                Rule::not_word => words.push(self.span(&child)),
                _ => inner = Some(child),
            }
        }
        let chain = inner.expect("the grammar puts a chain after `not`");
        if let Some(first) = words.first() {
            self.room(*first, words.len())?;
        }
        let mut expr = self.chain(chain)?;
        for word in words.into_iter().rev() {
            condition_only(&expr, "not")?;
            let span = word.to(expr.span);
            expr = Expr::new(ExprKind::Not(Box::new(expr)), span);
        }
        Ok(expr)
    }

    fn chain(&mut self, pair: Pair<'_>) -> Fallible<Expr> {
        let span = self.span(&pair);
        let mut inner = pair.into_inner();
        let first = self.sum(inner.next().expect("a chain starts with a sum"))?;
        let mut rest = Vec::new();
        let mut equals: Option<Span> = None;
        while let (Some(sign), Some(sum)) = (inner.next(), inner.next()) {
            let place = self.span(&sign);
            let relation = relation(&sign);
            if relation == Relation::Equal && equals.replace(place).is_some() {
                return Err(Error::new(place, ErrorKind::SeveralEquals));
            }
            rest.push((relation, self.sum(sum)?));
        }
        if rest.is_empty() {
            return Ok(first);
        }
        if let (Some(place), true) = (equals, rest.len() > 1) {
            return Err(Error::new(place, ErrorKind::MixedChain));
        }
        for side in std::iter::once(&first).chain(rest.iter().map(|(_, side)| side)) {
            number_only(side)?;
        }
        Ok(Expr::new(ExprKind::Compare(Box::new(first), rest), span))
    }

    pub(crate) fn sum(&mut self, pair: Pair<'_>) -> Fallible<Expr> {
        let span = self.span(&pair);
        let mut signs: Vec<(SumSign, Span)> = Vec::new();
        let mut first: Option<Expr> = None;
        let mut rest: Vec<(SumSign, Expr)> = Vec::new();
        for child in pair.into_inner() {
            if child.as_rule() == Rule::sign {
                signs.push((sign(&child), self.span(&child)));
                continue;
            }
            // Behind a term, the first sign joins the next one and any others belong to it.
            let joint = first.as_ref().map(|_| signs.remove(0).0);
            let term = self.signed(&signs, |b| b.product(child))?;
            signs.clear();
            match joint {
                Some(joint) => rest.push((joint, term)),
                None => first = Some(term),
            }
        }
        let first = first.expect("a sum has a first term");
        if rest.is_empty() {
            return Ok(first);
        }
        for term in std::iter::once(&first).chain(rest.iter().map(|(_, term)| term)) {
            number_only(term)?;
        }
        Ok(sum_of(first, rest, span))
    }

    /// What `build` makes, negated once for every minus sign of `signs`.
    pub(crate) fn signed(
        &mut self,
        signs: &[(SumSign, Span)],
        build: impl FnOnce(&mut Self) -> Fallible<Expr>,
    ) -> Fallible<Expr> {
        let minus = signs.iter().filter(|(sign, _)| *sign == SumSign::Minus).count();
        if let Some((_, span)) = signs.first() {
            self.room(*span, minus)?;
        }
        self.depth += minus;
        let built = build(self);
        self.depth -= minus;
        let mut expr = built?;
        if !signs.is_empty() {
            number_only(&expr)?;
        }
        for (sign, span) in signs.iter().rev() {
            if *sign == SumSign::Minus {
                let span = span.to(expr.span);
                expr = Expr::new(ExprKind::Negate(Box::new(expr)), span);
            }
        }
        Ok(expr)
    }

    fn product(&mut self, pair: Pair<'_>) -> Fallible<Expr> {
        let span = self.span(&pair);
        let mut joint: Option<ProductSign> = None;
        let mut signs: Vec<(SumSign, Span)> = Vec::new();
        let mut factors: Vec<(ProductSign, Expr)> = Vec::new();
        for child in pair.into_inner() {
            match child.as_rule() {
                Rule::factor_sign => {
                    let over = child.into_inner().any(|sign| sign.as_rule() == Rule::over);
                    joint = Some(if over { ProductSign::Over } else { ProductSign::Times });
                }
                Rule::sign => signs.push((sign(&child), self.span(&child))),
                _ => {
                    let joint = joint.take().unwrap_or(ProductSign::Times);
                    let mut run = self.run(child)?.into_iter();
                    let first = run.next().expect("a run has a first factor");
                    let first = self.signed(&signs, |_| Ok(first))?;
                    signs.clear();
                    let others: Vec<Expr> = run.collect();
                    if joint == ProductSign::Over && !others.is_empty() {
                        self.implicit_division(&factors, &first, &others);
                    }
                    if joint == ProductSign::Over && others.is_empty() {
                        self.divided_power(&factors, &first);
                    }
                    factors.push((joint, first));
                    factors.extend(others.into_iter().map(|f| (ProductSign::Times, f)));
                }
            }
        }
        if factors.len() > 1 {
            for (_, factor) in &factors {
                number_only(factor)?;
            }
        }
        Ok(product_of(factors, span))
    }

    /// Remarks on `1/2x`: the product after a division is easily meant to be divided by as a whole.
    fn implicit_division(
        &mut self,
        before: &[(ProductSign, Expr)],
        divisor: &Expr,
        others: &[Expr],
    ) {
        let product = |factors: &mut dyn Iterator<Item = &Expr>| {
            let factors: Vec<String> = factors.map(factor_text).collect();
            short(factors.join("*"))
        };
        let Some((_, numerator)) = before.last() else {
            return;
        };
        let span = numerator.span.to(others.last().unwrap_or(divisor).span);
        let top = short(factor_text(numerator));
        let bottom = short(factor_text(divisor));
        let tail = product(&mut others.iter());
        let whole = product(&mut std::iter::once(divisor).chain(others));
        let kind = NoteKind::ImplicitDivision {
            read: format!("({top}/{bottom})*{tail}"),
            other: format!("{top}/({whole})"),
        };
        self.note(span, kind);
    }

    /// Remarks on `x^1/3`: nobody writes the exponent 1 but as the top of a fraction.
    fn divided_power(&mut self, before: &[(ProductSign, Expr)], divisor: &Expr) {
        let Some((_, power)) = before.last() else {
            return;
        };
        let ExprKind::Power(base, exponent) = &power.kind else {
            return;
        };
        let index = divisor.number().and_then(|text| text.parse::<u32>().ok());
        let (Some("1"), Some(index @ 2..)) = (exponent.number(), index) else {
            return;
        };
        let text = short(factor_text(base));
        let inside = short(base.to_string());
        let root = match index {
            2 => format!("sqrt({inside})"),
            3 => format!("cbrt({inside})"),
            _ => format!("root({inside}, {index})"),
        };
        let span = power.span.to(divisor.span);
        let read = format!("({text}^1)/{index}");
        self.note(span, NoteKind::DividedPower { read, root });
    }
}

/// A formula quoted in a remark; a long one would hide what the remark is about.
fn short(text: String) -> String {
    const LONGEST: usize = 24;
    if text.chars().count() > LONGEST { "…".to_owned() } else { text }
}

/// A product of one or more factors; one inside its first factor is opened, since it means the same.
pub(crate) fn product_of(mut factors: Vec<(ProductSign, Expr)>, span: Span) -> Expr {
    let (_, first) = factors.remove(0);
    if factors.is_empty() {
        return first;
    }
    let (first, rest) = match first.kind {
        ExprKind::Product(first, mut rest) => {
            rest.append(&mut factors);
            (first, rest)
        }
        kind => (Box::new(Expr::new(kind, first.span)), factors),
    };
    Expr::new(ExprKind::Product(first, rest), span)
}

/// A sum of two or more terms; one inside its first term is opened, since it means the same.
pub(crate) fn sum_of(first: Expr, mut more: Vec<(SumSign, Expr)>, span: Span) -> Expr {
    let (first, rest) = match first.kind {
        ExprKind::Sum(first, mut rest) => {
            rest.append(&mut more);
            (first, rest)
        }
        kind => (Box::new(Expr::new(kind, first.span)), more),
    };
    Expr::new(ExprKind::Sum(first, rest), span)
}

pub(crate) fn sign(pair: &Pair<'_>) -> SumSign {
    if pair.as_str() == "+" { SumSign::Plus } else { SumSign::Minus }
}

pub(crate) fn relation(pair: &Pair<'_>) -> Relation {
    let inner = pair.clone().into_inner().next().map(|inner| inner.as_rule());
    match inner {
        Some(Rule::unequal) => Relation::Unequal,
        Some(Rule::less) => Relation::Less,
        Some(Rule::less_equal) => Relation::LessEqual,
        Some(Rule::greater) => Relation::Greater,
        Some(Rule::greater_equal) => Relation::GreaterEqual,
        _ => Relation::Equal,
    }
}

/// Fails on a comparison, which is not a number.
pub(crate) fn number_only(expr: &Expr) -> Fallible<()> {
    if expr.is_condition() {
        return Err(Error::new(expr.span, ErrorKind::ConditionAsValue));
    }
    Ok(())
}

/// Fails on a number, which does not hold or fail to hold.
fn condition_only(expr: &Expr, word: &str) -> Fallible<()> {
    if !expr.is_condition() {
        let word = word.to_owned();
        return Err(Error::new(expr.span, ErrorKind::ValueAsCondition { word }));
    }
    Ok(())
}
