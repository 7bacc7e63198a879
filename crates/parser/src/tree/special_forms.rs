//! Reads special forms, which take more than numbers as arguments, in several languages' spellings.

use crate::lex::lexer::OTHERWISE;
use crate::lex::spelling::plain_name;
use crate::lex::token_kind::TokenKind::If;
use crate::messages::error::{Error, ErrorKind, Fallible};
use crate::messages::note::NoteKind;
use crate::span::Span;
use crate::tree::ast::{Expr, ExprKind, Function, Relation};
use crate::tree::builder::{Builder, condition_only, joined, product_of};
use crate::tree::grammar::{Pair, Rule};
use crate::tree::scope::{Callee, NameMeaning};
use zeroset_ops::{FormKind, SpecialForm, VectorFunction};

/// A condition written as a function.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Logic {
    And,
    Or,
    Not,
    Compare(Relation),
}

/// The condition that a function called `name` stands for in other languages.
pub(crate) fn logic(name: &str) -> Option<Logic> {
    Some(match name {
        "And" | "AND" | "logical_and" => Logic::And,
        "Or" | "OR" | "logical_or" => Logic::Or,
        "Not" | "logical_not" => Logic::Not,
        "Eq" | "Equal" => Logic::Compare(Relation::Equal),
        "Ne" | "Unequal" => Logic::Compare(Relation::Unequal),
        "Lt" | "Less" | "less" => Logic::Compare(Relation::Less),
        "Le" | "LessEqual" | "less_equal" => Logic::Compare(Relation::LessEqual),
        "Gt" | "Greater" | "greater" => Logic::Compare(Relation::Greater),
        "Ge" | "GreaterEqual" | "greater_equal" => Logic::Compare(Relation::GreaterEqual),
        _ => return None,
    })
}

/// Descends through pairs with a single child to a pair of `rule`, if there is such a pair.
pub(crate) fn descend_to<'i>(pair: &Pair<'i>, rule: Rule) -> Option<Pair<'i>> {
    let mut pair = pair.clone();
    loop {
        if pair.as_rule() == rule {
            return Some(pair);
        }
        let mut inner = pair.into_inner();
        pair = inner.next()?;
        if inner.next().is_some() {
            return None;
        }
    }
}

/// The parts of a list or of brackets; `None` for a single part that is not a list.
pub(crate) fn tuple<'i>(pair: &Pair<'i>) -> Option<Vec<Pair<'i>>> {
    let inner = descend_to(pair, Rule::list).or_else(|| descend_to(pair, Rule::group))?;
    let parts: Vec<Pair<'i>> = inner.into_inner().collect();
    (parts.len() > 1 || parts.iter().any(|part| descend_to(part, Rule::list).is_some()))
        .then_some(parts)
}

impl Builder<'_> {
    /// Reads a special form whose arguments are in `group`.
    pub(crate) fn form(
        &mut self,
        form: &'static SpecialForm,
        span: Span,
        group: Pair<'_>,
    ) -> Fallible<Expr> {
        let place = span.to(self.span(&group));
        let parts: Vec<Pair<'_>> = group.into_inner().collect();
        let built = match form.meaning {
            FormKind::Choose => self.choose(&parts, place),
            FormKind::Pieces => self.pieces(&parts, span, place),
            FormKind::Sum | FormKind::Product => {
                self.series_call(form.meaning == FormKind::Product, &parts, place)
            }
            FormKind::Iterate => self.iterate(&parts, span, place),
            FormKind::Vector(size) => {
                let built = self.value_call(Function::Vector(size), None, parts, place);
                // `np.array([[a, b], [c, d]])` is a matrix.
                built.map(|built| built.map(without_array))
            }
            FormKind::Matrix(size) => self.matrix(size, span, parts, place),
            FormKind::OfVectors(function) => {
                let count = Some(function.arity());
                self.value_call(Function::OfVectors(function), count, parts, place)
            }
            FormKind::Multiply => self.multiply(&parts, place),
            FormKind::Derivative => self.diff(&parts, place),
            FormKind::OfDerivatives(function) => self.differential(function, &parts, place),
        };
        let kind = || ErrorKind::FormUsage { name: form.name, usage: form.usage };
        built?.ok_or_else(|| Error::new(place, kind()))
    }

    /// Reads a call of a function that takes `count` values, or at least one value if `count` is
    /// `None`. Returns `None` for another number of values.
    #[inline(never)]
    fn value_call(
        &mut self,
        function: Function,
        count: Option<usize>,
        parts: Vec<Pair<'_>>,
        place: Span,
    ) -> Fallible<Option<Expr>> {
        if parts.is_empty() || count.is_some_and(|count| count != parts.len()) {
            return Ok(None);
        }
        let arguments: Fallible<Vec<Expr>> =
            parts.into_iter().map(|part| self.argument(part)).collect();
        Ok(Some(Expr::new(ExprKind::Call(function, arguments?), place)))
    }

    /// Reads an argument: a value, or a vector in its own brackets.
    pub(crate) fn argument(&mut self, pair: Pair<'_>) -> Fallible<Expr> {
        if let Some(group) = descend_to(&pair, Rule::group)
            && matches!(group.clone().into_inner().count(), 2..=4)
        {
            let span = self.span(&group);
            return self.nested(span, 1, |b| b.list(group, span));
        }
        self.value(pair)
    }

    /// Reads a matrix. OpenGL lists the elements column by column, and other systems row by row.
    #[inline(never)]
    fn matrix(
        &mut self,
        size: u8,
        span: Span,
        parts: Vec<Pair<'_>>,
        place: Span,
    ) -> Fallible<Option<Expr>> {
        let typed = &self.text[span.range()];
        let by_rows = ["float", "half", "Matrix"].iter().any(|stem| typed.starts_with(stem));
        let built = self.value_call(Function::Matrix(size), None, parts, place)?;
        let Some(built) = built.map(without_array) else { return Ok(None) };
        let is_list = matches!(&built.kind, ExprKind::Call(_, all) if all.len() == 1);
        Ok(Some(if by_rows && !is_list && built.span == place {
            let function = Function::OfVectors(VectorFunction::Transpose);
            Expr::new(ExprKind::Call(function, vec![built]), place)
        } else {
            built
        }))
    }

    /// Reads `mul(m, p)`, as in Direct3D shaders, as a product.
    #[inline(never)]
    fn multiply(&mut self, parts: &[Pair<'_>], place: Span) -> Fallible<Option<Expr>> {
        let [left, right] = parts else { return Ok(None) };
        let (left, right) = (self.argument(left.clone())?, self.argument(right.clone())?);
        let product = product_of([left, right])?;
        Ok(Some(Expr::new(product.kind, place)))
    }

    /// Reads a list of rows as a square matrix; `None` if the shape is not square.
    fn rows(&mut self, parts: &[Pair<'_>], span: Span) -> Fallible<Option<Expr>> {
        let size = parts.len();
        let rows: Option<Vec<Vec<Pair<'_>>>> =
            parts.iter().map(|part| tuple(part).filter(|row| row.len() == size)).collect();
        let (Some(rows), Ok(count @ 2..=4)) = (rows, u8::try_from(size)) else { return Ok(None) };
        let mut elements = Vec::new();
        for column in 0..size {
            for row in &rows {
                elements.push(self.value(row[column].clone())?);
            }
        }
        Ok(Some(Expr::new(ExprKind::Call(Function::Matrix(count), elements), span)))
    }

    /// Reads a list as a vector, and a list of lists as a matrix.
    #[inline(never)]
    pub(crate) fn list(&mut self, pair: Pair<'_>, span: Span) -> Fallible<Expr> {
        let inner: Vec<Pair<'_>> = pair.clone().into_inner().collect();
        if let Some(matrix) = self.rows(&inner, span)? {
            return Ok(matrix);
        }
        // A list of lists that is no square matrix is an error.
        if inner.iter().any(|part| descend_to(part, Rule::list).is_some()) {
            return Err(Error::new(span, ErrorKind::MatrixShape));
        }
        let parts: Fallible<Vec<Expr>> = pair.into_inner().map(|part| self.value(part)).collect();
        let parts = parts?;
        match u8::try_from(parts.len()) {
            Ok(size @ 2..=4) => Ok(Expr::new(ExprKind::Call(Function::Vector(size), parts), span)),
            _ => Err(Error::new(span, ErrorKind::Vector)),
        }
    }

    /// Returns whether a part is a word such as `otherwise`, which covers all remaining cases.
    fn is_otherwise(&self, pair: &Pair<'_>) -> bool {
        pair.as_rule() == Rule::otherwise || OTHERWISE.contains(&self.typed(pair))
    }

    pub(crate) fn condition_of(&mut self, pair: Pair<'_>) -> Fallible<Expr> {
        let condition = self.expression(pair)?;
        let condition = self.as_condition(condition);
        condition_only(&condition, "if")?;
        Ok(condition)
    }

    /// Reads pairs of a condition and a value, then perhaps a last value without a condition.
    #[inline(never)]
    fn choose(&mut self, parts: &[Pair<'_>], place: Span) -> Fallible<Option<Expr>> {
        if parts.len() < 2 {
            return Ok(None);
        }
        let mut pieces = Vec::new();
        let mut last = None;
        for pair in parts.chunks(2) {
            match pair {
                [condition, value] if self.is_otherwise(condition) => {
                    last = Some(self.argument(value.clone())?);
                    break;
                }
                [condition, value] => {
                    let condition = self.condition_of(condition.clone())?;
                    pieces.push((condition, self.argument(value.clone())?));
                }
                [value, ..] => last = Some(self.argument(value.clone())?),
                [] => {}
            }
        }
        Ok(choice_or_last(pieces, last, place))
    }

    /// Reads the pieces of a choice, each in its own brackets, such as `[value, condition]`.
    #[inline(never)]
    fn pieces(&mut self, parts: &[Pair<'_>], span: Span, place: Span) -> Fallible<Option<Expr>> {
        let Some(first) = parts.first() else {
            return Ok(None);
        };
        let of_lists = tuple(first).filter(|rows| rows.iter().all(|row| tuple(row).is_some()));
        let (rows, last) = match (of_lists, parts) {
            (Some(rows), [_]) => (rows, None),
            (Some(rows), [_, last]) => (rows, Some(last.clone())),
            (Some(_), _) => return Ok(None),
            (None, _) if tuple(first).is_some() => (parts.to_vec(), None),
            (None, _) => return self.choose(parts, place),
        };
        let is_list = parts.len() == 1 && descend_to(first, Rule::list).is_some();
        let mut pieces = Vec::new();
        let mut otherwise = last.map(|last| self.argument(last)).transpose()?;
        for row in rows {
            let Some([value, condition]) = tuple(&row).and_then(|row| <[_; 2]>::try_from(row).ok())
            else {
                return Ok(None);
            };
            if self.is_otherwise(&condition) {
                otherwise = Some(self.argument(value)?);
                break;
            }
            let value = self.argument(value)?;
            pieces.push((self.condition_of(condition)?, value));
        }
        // Mathematica's `Piecewise` has the value 0 where no condition holds.
        if is_list && otherwise.is_none() && self.text[span.range()].starts_with('P') {
            self.note(span, NoteKind::ZeroElsewhere);
            otherwise = Some(Expr::of_digits("0", span));
        }
        Ok(choice_or_last(pieces, otherwise, place))
    }

    /// Reads a choice that the grammar recognizes by its braces.
    #[inline(never)]
    pub(crate) fn choice(&mut self, pair: Pair<'_>, span: Span) -> Fallible<Expr> {
        let mut pieces = Vec::new();
        let mut last = None;
        for piece in pair.into_inner() {
            if let Some(value) = &last {
                let value: &Expr = value;
                return Err(Error::new(value.span, ErrorKind::PieceWithoutCondition));
            }
            let symbols = piece.as_str();
            let mut parts = piece.into_inner();
            let first = parts.next().expect("a piece has a value");
            let condition_first = !symbols[first.as_str().len()..].starts_with(If.as_char());
            match parts.next() {
                None => {
                    let value = self.expression(first)?;
                    if value.is_condition() {
                        // In Desmos, a condition alone stands for the value 1 where it holds.
                        let one = Expr::of_digits("1", value.span);
                        pieces.push((value, one));
                    } else {
                        last = Some(value);
                    }
                }
                Some(second) => {
                    let (condition, value) =
                        if condition_first { (first, second) } else { (second, first) };
                    if self.is_otherwise(&condition) {
                        last = Some(self.value(value)?);
                    } else {
                        let condition = self.condition_of(condition)?;
                        pieces.push((condition, self.value(value)?));
                    }
                }
            }
        }
        choice_or_last(pieces, last, span)
            .ok_or_else(|| Error::new(span, ErrorKind::PieceWithoutCondition))
    }

    /// Reads a condition written as a function.
    #[inline(never)]
    pub(crate) fn logic(&mut self, logic: Logic, span: Span, group: Pair<'_>) -> Fallible<Expr> {
        let place = span.to(self.span(&group));
        let parts: Vec<Pair<'_>> = group.into_inner().collect();
        let needs = |word| Error::new(place, ErrorKind::ValueAsCondition { word });
        match logic {
            Logic::Not => {
                let [only] = parts.as_slice() else { return Err(needs("not")) };
                let condition = self.condition_of(only.clone())?;
                Ok(Expr::new(ExprKind::Not(Box::new(condition)), place))
            }
            Logic::And | Logic::Or => {
                let word = if matches!(logic, Logic::And) { "and" } else { "or" };
                if parts.is_empty() {
                    return Err(needs(word));
                }
                let conditions: Fallible<Vec<Expr>> =
                    parts.into_iter().map(|part| self.condition_of(part)).collect();
                joined(conditions?, word)
            }
            Logic::Compare(relation) => {
                let [left, right] = parts.as_slice() else { return Err(needs("if")) };
                let left = self.value(left.clone())?;
                let right = self.value(right.clone())?;
                Ok(left.compared(relation, right, place))
            }
        }
    }

    /// Reads a repeated function: name, number of repetitions, start value, unchanging arguments.
    #[inline(never)]
    fn iterate(&mut self, parts: &[Pair<'_>], span: Span, place: Span) -> Fallible<Option<Expr>> {
        let [name, rest @ ..] = parts else { return Ok(None) };
        let Some(name) = descend_to(name, Rule::name) else { return Ok(None) };
        if rest.len() < 2 {
            return Ok(None);
        }
        let mut arguments = Vec::new();
        for part in rest {
            arguments.push(self.argument(part.clone())?);
        }
        // Mathematica puts the start value before the number of repetitions.
        if self.text[span.range()].eq_ignore_ascii_case("nest") {
            arguments.swap(0, 1);
        }
        let (typed, at) = (self.typed(&name), self.span(&name));
        let text = plain_name(typed);
        let NameMeaning::Function(callee) = self.scope.meaning(&text, &self.locals) else {
            return Err(self.unknown_function(&text, at));
        };
        if let Callee::Defined(name, _) = &callee {
            self.used.insert(name.clone());
        }
        let count = arguments.len() - 1;
        let Some(function) = self.scope.signatures(&callee).function(count) else {
            return Err(self.wrong_count(&callee, at, place, count));
        };
        self.note_function(&callee, at);
        let function = Function::Iterate(Box::new(function));
        Ok(Some(Expr::new(ExprKind::Call(function, arguments), place)))
    }
}

/// The matrix that is the only element of `array`; any other array unchanged.
fn without_array(array: Expr) -> Expr {
    match array.kind {
        ExprKind::Call(Function::Vector(_) | Function::Matrix(_), mut only)
            if matches!(
                only.as_slice(),
                [Expr { kind: ExprKind::Call(Function::Matrix(_), _), .. }]
            ) =>
        {
            only.remove(0)
        }
        kind => Expr::new(kind, array.span),
    }
}

/// Builds a choice. Without pieces, returns only the last value, if there is one.
fn choice_or_last(pieces: Vec<(Expr, Expr)>, last: Option<Expr>, span: Span) -> Option<Expr> {
    match (pieces.is_empty(), last) {
        (true, last) => last,
        (false, last) => Some(Expr::new(ExprKind::Choice(pieces, last.map(Box::new)), span)),
    }
}
