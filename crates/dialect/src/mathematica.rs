//! Expands expressions that Mathematica evaluates before it plots: tables, functions of slots such
//! as `#^2 &`, and the values that a user changes.

use crate::known_numbers::steps;
use crate::lists::{joined, separated};
use crate::plot_commands::{is_plot, minus_level};
use crate::program_reader::{Frame, ProgramReader};
use crate::program_words::Words;
use zeroset_ir::Axis;
use zeroset_parser::lex::token::{Token, bracketed, in_brackets, span_of, split};
use zeroset_parser::lex::token_kind::TokenKind::*;
use zeroset_parser::tree::ast::{ExprKind, NamedValue};
use zeroset_parser::{Error, ErrorKind, Fallible, Span};

/// Largest number of values of a table, and of repetitions of a function.
const MAX_VALUES: usize = 30;

/// Largest number of tokens of an expanded statement.
const MAX_TOKENS: usize = 10_000;

impl ProgramReader<'_> {
    /// The statements in `Manipulate[plot, {a, 0, 2}]`: the values, and the plot. `None` for other
    /// statements.
    pub(crate) fn manipulated(&mut self, tokens: &[Token]) -> Option<Vec<Vec<Token>>> {
        let start = match tokens {
            [_, equals, ..] if equals.kind == Equals => 2,
            _ => 0,
        };
        let (first, rest) = tokens.get(start..)?.split_first()?;
        if !matches!(self.words.word(*first), "Manipulate" | "Animate") {
            return None;
        }
        let mut parts = split(bracketed(rest)?.0, Comma).into_iter();
        let body = parts.next()?;
        let (mut all, mut left) = (Vec::new(), Vec::new());
        for part in parts {
            match control(&part) {
                Some((statement, unused)) => {
                    all.push(statement);
                    left.push(unused);
                }
                None => left.push(part),
            }
        }
        self.program.notes.extend(self.words.unused_note(&left));
        all.push(body);
        Some(all)
    }

    /// Takes the regions of a plot, as in `{x, y} \\[Element] Disk[{0, 0}, 1]`, out of its
    /// arguments. Returns their conditions.
    pub(crate) fn plot_regions(&self, tokens: &mut Vec<Token>) -> Fallible<Vec<Vec<Token>>> {
        let is_element = |token: &Token| {
            let typed = self.words.text.get(token.span.range()).unwrap_or_default();
            matches!(typed, r"\[Element]" | "∈")
        };
        let plots = |token: &Token| is_plot(self.words.word(*token));
        // Few statements have the sign, so few words are looked up.
        if !tokens.iter().any(is_element) {
            return Ok(Vec::new());
        }
        let Some(at) = tokens.iter().position(plots) else { return Ok(Vec::new()) };
        let Some((inner, rest)) = bracketed(&tokens[at + 1..]) else { return Ok(Vec::new()) };
        let (open, close) = (tokens[at + 1], tokens[at + inner.len() + 2]);
        let (regions, others): (Vec<_>, Vec<_>) =
            split(inner, Comma).into_iter().partition(|part| part.iter().any(is_element));
        let mut conditions = Vec::new();
        for region in regions {
            let place = region.iter().position(is_element).unwrap_or(0);
            let (names, value) = (&region[..place], &region[place + 1..]);
            let refused = || {
                Error::new(region[place].span, ErrorKind::PlotOption { name: "Element".to_owned() })
            };
            conditions.push(self.region(names, value).ok_or_else(refused)?);
        }
        let mut all = tokens[..=at].to_vec();
        all.push(open);
        all.extend(separated(&others));
        all.push(close);
        all.extend(rest);
        *tokens = all;
        Ok(conditions)
    }

    /// The condition of a region: `ImplicitRegion[c, {x, y}]`, `Disk[{a, b}, r]` or `Ball[…]`.
    fn region(&self, names: &[Token], value: &[Token]) -> Option<Vec<Token>> {
        let value = match value {
            [name] => self.assigned.get(self.words.word(*name))?.as_slice(),
            _ => value,
        };
        let (word, rest) = value.split_first()?;
        let parts = split(Words::inside(rest)?, Comma);
        match (self.words.word(*word), parts.as_slice()) {
            ("ImplicitRegion", [condition, ..]) => Some(condition.clone()),
            ("Disk" | "Ball", [center, radius]) => {
                let names = split(Words::inside(names)?, Comma);
                let center = split(Words::inside(center)?, Comma);
                let sign = |kind| Token::new(kind, Span::at(word.span.start));
                let mut squares = Vec::new();
                for (name, place) in names.iter().zip(&center) {
                    let side = minus_level(name, place);
                    let mut square = in_brackets(&side);
                    square.push(sign(Star));
                    square.extend(in_brackets(&side));
                    squares.push(square);
                }
                let mut all = joined(&squares, Plus);
                all.push(sign(LessEqual));
                all.extend(in_brackets(radius));
                all.push(sign(Star));
                all.extend(in_brackets(radius));
                (names.len() == center.len()).then_some(all)
            }
            _ => None,
        }
    }

    /// Returns whether a statement only names a region for a plot below.
    pub(crate) fn names_region(&self, tokens: &[Token]) -> bool {
        let [name, equals, word, ..] = tokens else { return false };
        let typed = self.words.word(*name);
        equals.kind == Equals
            && self.words.word(*word) == "ImplicitRegion"
            && self.words.text[word.span.end..].contains(&format!("] {typed}"))
    }

    /// `tokens` with tables and functions of slots expanded.
    pub(crate) fn expanded_lists(
        &mut self,
        tokens: Vec<Token>,
        frame: &mut Frame,
    ) -> Fallible<Vec<Token>> {
        let is_expanded = |token: &Token| {
            matches!(self.words.word(*token), "Table" | "Evaluate")
                || self.words.slot(*token).is_some()
        };
        if !tokens.iter().any(is_expanded) {
            return Ok(tokens);
        }
        self.expand(&tokens, frame)
    }

    fn expand(&mut self, tokens: &[Token], frame: &mut Frame) -> Fallible<Vec<Token>> {
        let mut out: Vec<Token> = Vec::new();
        let mut rest = tokens;
        while let Some(first) = rest.first().copied() {
            if out.len() > MAX_TOKENS {
                let limit = MAX_TOKENS;
                return Err(Error::new(first.span, ErrorKind::TooManySymbols { limit }));
            }
            let Some((inner, after)) = bracketed(rest) else {
                out.push(first);
                rest = &rest[1..];
                continue;
            };
            let close = rest[inner.len() + 1];
            let word = out.last().map_or("", |last| self.words.word(*last));
            let parts = split(inner, Comma);
            rest = after;
            let value = match (word, parts.as_slice()) {
                ("Table", [body, range]) => Some(self.table(body, range, frame)?),
                ("Evaluate", [value]) => Some(self.expand(value, frame)?),
                ("Nest", [function, start, count]) => self.nested(function, start, count, frame),
                ("Fold", [function, start, list]) => self.folded(function, start, list),
                ("Total", [value]) => self.mapped(value).map(|list| joined(&list, Plus)),
                _ => None,
            };
            if let Some(value) = value {
                out.pop();
                out.extend(value);
                continue;
            }
            out.push(first);
            let arguments = parts.iter().map(|part| self.argument(part, frame));
            let arguments: Vec<Vec<Token>> = arguments.collect::<Fallible<_>>()?;
            out.extend(separated(&arguments));
            out.push(close);
        }
        Ok(out)
    }

    /// An argument, expanded. A condition of slots, as in `RegionFunction -> (#1 > 0 &)`, becomes a
    /// condition of x, y and z.
    fn argument(&mut self, part: &[Token], frame: &mut Frame) -> Fallible<Vec<Token>> {
        let Some(at) =
            part.windows(2).position(|pair| (pair[0].kind, pair[1].kind) == (Minus, Greater))
        else {
            return self.expand(part, frame);
        };
        let (name, value) = part.split_at(at + 2);
        let function = Words::inside(value).unwrap_or(value);
        if pure(function).is_none() {
            return self.expand(part, frame);
        }
        let span = span_of(function).unwrap_or_default();
        let coordinates = Axis::ALL.map(|axis| {
            let kind = ExprKind::Name(NamedValue::Coordinate(axis));
            vec![self.saved(kind, span, false, frame)]
        });
        let mut all = name.to_vec();
        let Some(condition) = self.words.applied(function, &coordinates) else {
            return Err(Error::new(span, ErrorKind::NoFormula));
        };
        // A function without parameters: `Function[{}, condition]`.
        let sign = |kind| Token::new(kind, Span::at(span.start));
        all.extend([sign(At), sign(OpenParen), sign(CloseParen)]);
        all.extend(condition);
        Ok(all)
    }

    /// A list of the values of `body` over `{k, 1, 3}`, `{k, {1, 2}}` or `{k, list}`.
    fn table(
        &mut self,
        body: &[Token],
        range: &[Token],
        frame: &mut Frame,
    ) -> Fallible<Vec<Token>> {
        let span = span_of(range).unwrap_or_default();
        let refused = || Error::new(span, ErrorKind::LoopEnd);
        let parts = split(Words::inside(range).ok_or_else(refused)?, Comma);
        let (name, ends) = parts.split_first().ok_or_else(refused)?;
        let values = match ends {
            [list] if self.list_values(list).is_some() => {
                self.list_values(list).unwrap_or_default()
            }
            _ => self.range_values(ends, span, frame).ok_or_else(refused)?,
        };
        if values.len() > MAX_VALUES {
            return Err(refused());
        }
        let mut items = Vec::new();
        for value in values {
            let item = Words::substituted(body, &[(name[0], value)], self.words.text);
            items.push(self.expand(&item.ok_or_else(refused)?, frame)?);
        }
        let sign = |kind| Token::new(kind, Span::at(span.start));
        let mut all = vec![sign(OpenBrace)];
        all.extend(separated(&items));
        all.push(sign(CloseBrace));
        Ok(all)
    }

    /// The numbers of `3`, `1, 3` or `1, 3, 0.5`.
    pub(crate) fn range_values(
        &mut self,
        ends: &[Vec<Token>],
        span: Span,
        frame: &mut Frame,
    ) -> Option<Vec<Vec<Token>>> {
        let numbers: Option<Vec<f64>> =
            ends.iter().map(|end| self.known_value(&self.resolved(end), frame)).collect();
        let (low, high, step) = match numbers?.as_slice() {
            [high] => (1.0, *high, 1.0),
            [low, high] => (*low, *high, 1.0),
            [low, high, step] if *step > 0.0 => (*low, *high, *step),
            _ => return None,
        };
        let numbers = steps(low, high, step, true, MAX_VALUES)?;
        Some(numbers.into_iter().map(|number| vec![self.number(number, span, frame)]).collect())
    }

    fn nested(
        &self,
        function: &[Token],
        start: &[Token],
        count: &[Token],
        frame: &Frame,
    ) -> Option<Vec<Token>> {
        let count = self.known_value(count, frame)?;
        let numbers = steps(0.0, count, 1.0, false, MAX_VALUES)?;
        let apply = |value: Vec<Token>, _| self.words.applied(function, &[value]);
        numbers.into_iter().try_fold(start.to_vec(), apply).map(|value| in_brackets(&value))
    }

    fn folded(&self, function: &[Token], start: &[Token], list: &[Token]) -> Option<Vec<Token>> {
        let fold = |value: Vec<Token>, item| self.words.applied(function, &[value, item]);
        let items = self.list_values(list)?.into_iter();
        items.take(MAX_VALUES).try_fold(start.to_vec(), fold).map(|value| in_brackets(&value))
    }

    /// The values of `function & /@ list`.
    fn mapped(&self, tokens: &[Token]) -> Option<Vec<Vec<Token>>> {
        let is_map = |pair: &[Token]| {
            pair[0].kind == Slash
                && pair[0].span.end == pair[1].span.start
                && self.words.text[pair[1].span.range()] == *"@"
        };
        let at = tokens.windows(2).position(is_map)? + 1;
        let items = self.list_values(&tokens[at + 1..])?.into_iter();
        let value = |item| self.words.applied(&tokens[..at - 1], &[item]);
        items.take(MAX_VALUES).map(value).collect()
    }
}

impl Words<'_> {
    /// The number of a slot: 1 for `#` and `#1`. `None` for other tokens.
    fn slot(self, token: Token) -> Option<usize> {
        let typed = self.word(token).strip_prefix('#')?;
        if typed.is_empty() { Some(1) } else { typed.parse().ok() }
    }

    /// The value of an anonymous function, such as `lambda x: x**2` or `#^2 &`, at `arguments`.
    pub(crate) fn applied(
        self,
        function: &[Token],
        arguments: &[Vec<Token>],
    ) -> Option<Vec<Token>> {
        let (body, names) = match (pure(function), self.lambda(function)) {
            (Some(body), _) => {
                let slots = body.iter().filter(|token| self.slot(**token).is_some());
                (body.to_vec(), slots.copied().collect())
            }
            (None, Some((None, parameters, body))) if parameters.len() == arguments.len() => {
                (body, parameters.iter().map(|part| part[0]).collect::<Vec<Token>>())
            }
            _ => return None,
        };
        let argument = |(index, name): (usize, &Token)| {
            let number = self.slot(*name).map_or(Some(index), |slot| slot.checked_sub(1))?;
            Some((*name, arguments.get(number)?.clone()))
        };
        let rules = names.iter().enumerate().map(argument).collect::<Option<Vec<_>>>()?;
        Self::substituted(&body, &rules, self.text)
    }
}

/// The body of a function of slots, such as `#^2 &`.
fn pure(function: &[Token]) -> Option<&[Token]> {
    let (last, body) = function.split_last()?;
    (last.kind == Ampersand && !body.is_empty()).then_some(body)
}

/// The definition of a value with its start and range: `a = 1 in [0, 2]` for `{{a, 1}, 0, 2}`. With
/// steps, or with a list of values, it has no range. Also returns the steps or the list.
fn control(part: &[Token]) -> Option<(Vec<Token>, Vec<Token>)> {
    let parts = split(Words::inside(part).filter(|_| part[0].kind == OpenBrace)?, Comma);
    let (name, ends) = parts.split_first()?;
    let given = Words::inside(name).map(|inner| split(inner, Comma));
    let (name, start) = match given.as_deref() {
        Some([name, start, ..]) => (name.clone(), Some(start.clone())),
        Some(_) => return None,
        None => (name.clone(), None),
    };
    let [name] = name.as_slice() else { return None };
    let list = Words::inside(ends.first()?).filter(|_| ends[0][0].kind == OpenBrace);
    let (first, unused) = match list {
        Some(list) => (split(list, Comma).into_iter().next()?, ends[0].clone()),
        None => (ends[0].clone(), ends.get(2).cloned().unwrap_or_default()),
    };
    let sign = |kind| Token::new(kind, Span::at(name.span.end));
    let mut all = vec![*name, sign(Equals)];
    all.extend(start.unwrap_or(first));
    if let [low, high] = ends {
        all.extend([sign(In), sign(OpenBracket)]);
        all.extend(low);
        all.push(sign(Comma));
        all.extend(high);
        all.push(sign(CloseBracket));
    }
    Some((all, unused))
}
