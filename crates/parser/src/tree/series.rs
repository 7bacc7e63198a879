//! Reads sums and products over whole numbers, in the spellings of several languages.

use crate::lex::spelling::{decimal, plain_name};
use crate::lex::token_kind::TokenKind::BigProduct;
use crate::messages::error::{Error, ErrorKind, Fallible};
use crate::span::Span;
use crate::tree::ast::{Chain, ChainSign, Expr, ExprKind, Name, Series};
use crate::tree::builder::{Builder, number_only, numbers_only};
use crate::tree::grammar::{Pair, Rule, first_kind};
use crate::tree::special_forms::{descend_to, tuple};

/// Largest number of terms of a sum, factors of a product, or repetitions of a function.
pub const MAX_TERMS: i64 = 1000;

impl Builder<'_> {
    /// Reads the parts in the brackets of `sum(…)` or `product(…)`; `None` if the form is unknown.
    pub(crate) fn series_call(
        &mut self,
        is_product: bool,
        parts: &[Pair<'_>],
        place: Span,
    ) -> Fallible<Option<Expr>> {
        // The generator may have its own brackets, as in Python's `sum([…])`.
        if let [only] = parts
            && let Some(group) = descend_to(only, Rule::group)
        {
            let inner: Vec<Pair<'_>> = group.into_inner().collect();
            return self.series_call(is_product, &inner, place);
        }
        let rule = |index: usize| parts.get(index).map(Pair::as_rule);
        let (body, range) = match (rule(0), rule(1), parts.len()) {
            (Some(Rule::count), Some(Rule::expression), 2) => (&parts[1], parts[0].clone()),
            (Some(Rule::expression), Some(Rule::count | Rule::generator), 2) => {
                (&parts[0], parts[1].clone())
            }
            (Some(Rule::expression), Some(Rule::expression), 2) => {
                let Some(range) = tuple(&parts[1]) else { return Ok(None) };
                return self.series_from_list(is_product, &parts[0], &range, place);
            }
            (Some(Rule::expression), Some(Rule::expression), 4) => {
                return self.series_from_list(is_product, &parts[0], &parts[1..], place);
            }
            _ => return Ok(None),
        };
        let (index, ends) = self.index_and_ends(range, place)?;
        self.series_with_index(is_product, body, &index, ends, place)
    }

    /// Reads the index of a range and the range's ends.
    #[inline(never)] // keeps its locals out of the stack frames of nested sums
    fn index_and_ends<'i>(
        &mut self,
        range: Pair<'i>,
        place: Span,
    ) -> Fallible<(Pair<'i>, Vec<Expr>)> {
        let is_generator = range.as_rule() == Rule::generator;
        let mut ends = range.into_inner();
        let index = ends.next().expect("a range has an index");
        let rest: Vec<Pair<'_>> = match ends.next() {
            Some(group) if is_generator => group.into_inner().collect(),
            first => first.into_iter().chain(ends).collect(),
        };
        let end = |end| if is_generator { self.value(end) } else { self.sum(end) };
        let built: Fallible<Vec<Expr>> = rest.into_iter().map(end).collect();
        let mut built = built?;
        if !is_generator {
            return Ok((index, built));
        }
        // `range(n)` counts from 0 to n − 1.
        if built.len() == 1 {
            built.insert(0, Expr::of_digits("0", place));
        }
        if let Some(end) = built.get_mut(1) {
            let span = end.span;
            let past = std::mem::replace(end, Expr::of_digits("0", place));
            let one = vec![(ChainSign::Inverse, Expr::of_digits("1", place))];
            *end = Expr::chain(Chain::Sum, past, one, span);
        }
        Ok((index, built))
    }

    /// Reads a sum or a product whose range is a list: index, first number, last number, step.
    #[inline(never)]
    fn series_from_list(
        &mut self,
        is_product: bool,
        body: &Pair<'_>,
        range: &[Pair<'_>],
        place: Span,
    ) -> Fallible<Option<Expr>> {
        let Some((index, ends)) = range.split_first() else { return Ok(None) };
        let Some(index) = descend_to(index, Rule::name) else { return Ok(None) };
        let built: Fallible<Vec<Expr>> = ends.iter().map(|end| self.value(end.clone())).collect();
        let mut built = built?;
        if built.len() == 1 {
            built.insert(0, Expr::of_digits("1", place));
        }
        self.series_with_index(is_product, body, &index, built, place)
    }

    /// Builds a sum or a product over `index`. Its body is read with the index as a local name.
    #[inline(never)]
    fn series_with_index(
        &mut self,
        is_product: bool,
        body: &Pair<'_>,
        index: &Pair<'_>,
        ends: Vec<Expr>,
        place: Span,
    ) -> Fallible<Option<Expr>> {
        let index = Name { text: plain_name(self.typed(index)), span: self.span(index) };
        self.locals.push(index.clone());
        let built = self.argument(body.clone());
        self.locals.pop();
        series(is_product, index, ends, built?, place)
    }

    /// Reads `\sum_{k=1}^{5}` and the term after it.
    #[inline(never)]
    pub(crate) fn big_series(&mut self, pair: Pair<'_>, span: Span) -> Fallible<Expr> {
        let is_product = first_kind(&pair) == Some(BigProduct);
        let (mut from, mut to, mut term) = (None, None, None);
        for part in pair.into_inner() {
            match part.as_rule() {
                Rule::from => from = Some(part),
                Rule::to => to = Some(part),
                _ => term = Some(part),
            }
        }
        let (Some(from), Some(to), Some(term)) = (from, to, term) else {
            unreachable!("the grammar has all three");
        };
        let mut from = from.into_inner();
        let index = from.next().expect("an index");
        let low = self.sum(from.next().expect("a first number"))?;
        let end = to.into_inner().next().expect("a last number");
        let end_span = self.span(&end);
        if matches!(self.typed(&end).trim_matches(['{', '}', ' ']), "∞" | r"\infty" | "inf") {
            let limit = MAX_TERMS;
            return Err(Error::new(end_span, ErrorKind::TooManyTerms { limit }));
        }
        let high = match end.as_rule() {
            Rule::number => Expr::of_digits(decimal(self.typed(&end)), end_span),
            Rule::name => self.letter(end)?,
            Rule::group => self.nested(end_span, 1, |b| b.group(end))?,
            _ => self.nested(end_span, 1, |b| b.delimited(end, end_span))?,
        };
        number_only(&high)?;
        let index = Name { text: plain_name(self.typed(&index)), span: self.span(&index) };
        self.locals.push(index.clone());
        let body = self.nested(span, 1, |b| b.term(&mut term.into_inner()));
        self.locals.pop();
        let body = body?;
        number_only(&body)?;
        let series = Series { is_product, index, low, high, step: None, body };
        Ok(Expr::new(ExprKind::Series(Box::new(series)), span))
    }
}

/// Builds a sum or a product; `None` unless `ends` are two numbers, perhaps with a step.
#[inline(never)]
fn series(
    is_product: bool,
    index: Name,
    ends: Vec<Expr>,
    body: Expr,
    place: Span,
) -> Fallible<Option<Expr>> {
    let mut ends = ends.into_iter();
    let (Some(low), Some(high), step, None) = (ends.next(), ends.next(), ends.next(), ends.next())
    else {
        return Ok(None);
    };
    numbers_only([&low, &high])?;
    let series = Series { is_product, index, low, high, step, body };
    Ok(Some(Expr::new(ExprKind::Series(Box::new(series)), place)))
}
