//! Reads arrays of numbers and of points: their definitions, elements such as `c[i][0]`, and sums
//! over them, such as `sum(f(p) for p in c)`.
//!
//! Elements take the place of the expressions that select them. A definition is left out if the
//! text uses the array only in these ways.

use crate::known_numbers::steps;
use crate::language::Language;
use crate::lists::{Element, joined, joint_of};
use crate::matrices::row_values;
use crate::program_reader::{Frame, ProgramReader, Statements};
use crate::program_words::{Words, is_type};
use std::ops::Range;
use zeroset_parser::lex::spelling::{is_name_char, plain_name};
use zeroset_parser::lex::token::{Token, bracketed, closing, in_brackets, outside, split};
use zeroset_parser::lex::token_kind::TokenKind::{self, *};
use zeroset_parser::{Error, ErrorKind, Fallible};

/// Largest number of elements of an array.
const MOST_ELEMENTS: usize = 200;
/// Largest number of tokens of a statement whose elements are written out.
const MOST_TOKENS: usize = 20_000;

/// The value of a name that stands for an array.
#[derive(Clone)]
pub(crate) struct Array {
    pub elements: Vec<Element>,
    /// True if the elements of a matrix are selected by round brackets, as in MATLAB.
    is_round: bool,
}

impl Array {
    /// An array whose elements are selected by square brackets.
    pub(crate) fn of(elements: Vec<Element>) -> Self {
        Self { elements, is_round: false }
    }
}

impl ProgramReader<'_> {
    /// Reads the array that a statement defines, or the elements that it selects. Returns the
    /// statement to read instead; `None` if nothing is left to read.
    pub(crate) fn with_arrays(
        &mut self,
        tokens: Vec<Token>,
        frame: &mut Frame,
    ) -> Fallible<Option<Vec<Token>>> {
        if frame.function.is_none()
            && let Some(points) = self.listed_points(&tokens)
        {
            for point in points {
                self.statement(point, frame, &mut Statements::default())?;
            }
            return Ok(None);
        }
        if self.array(&tokens) {
            return Ok(None);
        }
        Ok(Some(self.with_elements(tokens, frame)))
    }

    /// Records the array that a statement defines. Returns true if the definition can be left out.
    fn array(&mut self, tokens: &[Token]) -> bool {
        let Some((name, array)) = self.array_of(tokens) else { return false };
        let word = self.words.word(name).to_owned();
        let is_plain = self.is_only_selected(&word);
        self.arrays.insert(word, array);
        is_plain
    }

    /// The points of a list that nothing else uses, each as a statement.
    fn listed_points(&self, tokens: &[Token]) -> Option<Vec<Vec<Token>>> {
        let (name, array) = self.array_of(tokens).filter(|_| self.language == Language::Plain)?;
        let is_point = |element: &Element| element.is_list && element.parts.len() == 3;
        let is_used = self.uses(self.words.word(name)).count() > 1;
        let is_list = !is_used && array.elements.len() > 1 && array.elements.iter().all(is_point);
        is_list.then(|| array.elements.iter().map(Element::tokens).collect())
    }

    /// The name and the elements of an array, if the statement defines one.
    fn array_of(&self, tokens: &[Token]) -> Option<(Token, Array)> {
        let equals = outside(tokens, Equals)?;
        let (left, value) = (&tokens[..equals], &tokens[equals + 1..]);
        // Types and qualifiers stand before the name, and sizes in brackets behind it.
        let declared = |token: &Token| {
            let word = self.words.word(*token);
            is_type(word) || matches!(word, "const" | "let" | "var" | "local" | "static")
        };
        let name = left.iter().position(|token| token.kind.is_name() && !declared(token))?;
        let mut sizes = &left[name + 1..];
        let is_declared = !sizes.is_empty();
        while let Some((_, rest)) = bracketed(sizes).filter(|_| sizes[0].kind == OpenBracket) {
            sizes = rest;
        }
        if !sizes.is_empty() || !left[..name].iter().all(declared) {
            return None;
        }
        let list = self.list_of(value)?;
        let is_round = list.iter().any(|token| token.kind == Semicolon);
        let elements: Vec<Element> = if is_round {
            let rows = list.split(|token| token.kind == Semicolon);
            let values = rows.map(row_values);
            let parts =
                values.map(|values| values.into_iter().map(|value| (None, value)).collect());
            parts.map(Element::of_parts).collect()
        } else {
            split(list, Comma).iter().map(|part| self.element(part)).collect()
        };
        let is_nested = elements.iter().all(|element| element.parts.len() > 1);
        let is_flat = elements.iter().all(|element| element.parts.len() == 1);
        let is_constant = |(_, value): &(Option<Token>, Vec<Token>)| {
            value.iter().all(|token| {
                let is_name = token.kind == TokenKind::Name && self.words.word(*token) != "for";
                is_name
                    || matches!(token.kind, Number | Plus | OpenParen | CloseParen | Comma | Caret)
                    || token.kind.is_arithmetic()
            })
        };
        let are_constant = elements.iter().flat_map(|element| &element.parts).all(is_constant);
        let is_array = are_constant
            && left[name].kind == TokenKind::Name
            && (is_nested || is_flat || is_declared);
        (is_array && (2..=MOST_ELEMENTS).contains(&elements.len()))
            .then(|| (left[name], Array { elements, is_round }))
    }

    /// The contents of a list such as `[…]`, `np.array([…])` or `vec3[2](…)`.
    fn list_of<'t>(&self, value: &'t [Token]) -> Option<&'t [Token]> {
        let value = self.words.unwrapped_list(value);
        let first = value.first()?;
        if let (OpenBracket | OpenBrace, Some(inner)) = (first.kind, Words::inside(value)) {
            return Some(inner);
        }
        let sizes = bracketed(&value[1..]).filter(|_| is_type(self.words.word(*first)))?.1;
        Words::inside(sizes).filter(|_| sizes[0].kind == OpenParen)
    }

    /// For each use of a name, the text before it and the text behind it.
    fn uses<'t>(&'t self, name: &'t str) -> impl Iterator<Item = (&'t str, &'t str)> + 't {
        let text = self.words.text;
        let places = text.match_indices(name).map(|(at, _)| at);
        places.map(move |at| (&text[..at], &text[at + name.len()..])).filter(|(before, behind)| {
            !before.ends_with(is_name_char) && !behind.starts_with(is_name_char)
        })
    }

    /// Returns whether each use of an array sets it, selects elements, or goes through them, and
    /// there is more than one use.
    fn is_only_selected(&self, name: &str) -> bool {
        const BEFORE: [&str; 7] = ["in", "of", "enumerate(", "ipairs(", "pairs(", "len(", "/@"];
        let is_selected = |(before, behind): (&str, &str)| {
            let behind = behind.trim_start().trim_start_matches(r"\left");
            let before = before.trim_end();
            let is_set = behind.starts_with('=') && !behind.starts_with("==");
            is_set
                || behind.starts_with(['[', '('])
                || behind.starts_with(".reduce")
                || behind.starts_with('}') && before.ends_with(',')
                || BEFORE.iter().any(|word| {
                    let rest = before.strip_suffix(word);
                    rest.is_some_and(|rest| !rest.ends_with(is_name_char))
                })
                || before.contains("total") && behind.starts_with([')', '\\'])
        };
        self.uses(name).count() > 1 && self.uses(name).all(is_selected)
    }

    /// A statement in which elements replace the expressions that select them.
    pub(crate) fn with_elements(&mut self, tokens: Vec<Token>, frame: &mut Frame) -> Vec<Token> {
        if self.arrays.is_empty() && !tokens.iter().any(|token| self.words.word(*token) == "for") {
            return tokens;
        }
        let tokens = self.written_out(tokens, frame);
        self.with_selections(&tokens, frame)
    }

    /// Writes out generators, reductions, and sums whose index selects elements.
    fn written_out(&mut self, mut tokens: Vec<Token>, frame: &mut Frame) -> Vec<Token> {
        let mut at = 0;
        while at < tokens.len() && tokens.len() < MOST_TOKENS {
            let found = self
                .generator(&tokens, at, frame)
                .or_else(|| self.reduction(&tokens, at))
                .or_else(|| self.listed_sum(&tokens, at))
                .or_else(|| self.indexed_sum(&tokens, at, frame));
            match found {
                Some((range, values)) => drop(tokens.splice(range, values)),
                None => at += 1,
            }
        }
        tokens
    }

    /// Writes out `f(E for p in list)`, if the token at `at` is its `f`.
    fn generator(
        &mut self,
        tokens: &[Token],
        at: usize,
        frame: &mut Frame,
    ) -> Option<(Range<usize>, Vec<Token>)> {
        let joint = joint_of(self.words.word(tokens[at]))?;
        let open = at + 1;
        let end = open + tokens.get(open..).and_then(closing)?;
        let mut inner = &tokens[open + 1..end];
        if let Some((list, [])) = bracketed(inner).filter(|_| inner[0].kind == OpenBracket) {
            inner = list;
        }
        let word = |token: &Token| self.words.word(*token);
        let mut ends = Vec::new();
        let (body, pattern, values) = if word(&tokens[at]) == "Sum" {
            // Mathematica has `Sum[E, {p, list}]` and `Sum[E, {i, 1, n}]`.
            let [body, range] = <[_; 2]>::try_from(split(inner, Comma)).ok()?;
            ends = split(Words::inside(&range)?, Comma);
            let pattern = ends.remove(0);
            let values = ends.first()?.clone();
            (body, pattern, values)
        } else {
            let before = |sign: &str| inner.iter().position(|token| word(token) == sign);
            let start = before("for")?;
            let within = start + inner[start..].iter().position(|token| token.kind == In)?;
            (
                inner[..start].to_vec(),
                inner[start + 1..within].to_vec(),
                inner[within + 1..].to_vec(),
            )
        };
        let elements = match self.elements(&values, frame) {
            Some(elements) => elements,
            None if joint == Comma => {
                let span = values.first()?.span;
                let numbers = self.range_numbers(&values, span, frame).ok()??.into_iter();
                numbers.map(|one| Element::single(vec![self.number(one, span, frame)])).collect()
            }
            // Other sums over numbers stay sums.
            None if self.selects(&body) => {
                let numbers = self.range_values(&ends, values[0].span, frame)?;
                numbers.into_iter().map(Element::single).collect()
            }
            None => return None,
        };
        // These languages run the generators over other lists.
        let has_steps = matches!(self.language, Language::Python | Language::OpenScad);
        let is_array = values.iter().any(|one| self.arrays.contains_key(self.words.word(*one)));
        if has_steps && !is_array && elements.iter().any(|element| element.parts.len() < 2) {
            return None;
        }
        let value = |element| Some(self.bound(&body, &self.bindings_of(&pattern, element)?));
        let values: Vec<Vec<Token>> = elements.iter().map(value).collect::<Option<_>>()?;
        // A sum is written with signs, so `np.` of `np.sum` goes, too.
        let start = if joint == Comma { at } else { self.without_module(tokens, at) };
        let head = (joint == Comma).then_some(tokens[at]);
        let values = joined(&values, joint);
        Some((start..end + 1, head.into_iter().chain(values).collect()))
    }

    /// Index of the module's name before the function's name at `at`; `at` without a module.
    pub(crate) fn without_module(&self, tokens: &[Token], at: usize) -> usize {
        let has_module = at > 1
            && self.words.is_dot(tokens[at - 1])
            && matches!(self.words.word(tokens[at - 2]), "np" | "numpy" | "math" | "Math");
        if has_module { at - 2 } else { at }
    }

    /// `body` with elements in place of names. An expression that selects a part of an element,
    /// such as `b.r`, is replaced by the part.
    fn bound(&self, body: &[Token], bindings: &[(Token, Element)]) -> Vec<Token> {
        let mut all = Vec::new();
        let mut at = 0;
        while let Some(token) = body.get(at) {
            at += 1;
            let word = self.words.word(*token);
            let Some((_, element)) = bindings
                .iter()
                .find(|(name, _)| self.words.word(*name) == word && !word.is_empty())
            else {
                all.push(*token);
                continue;
            };
            let rest = &body[at..];
            // `b.r` of an object; the dot may be a token of its own.
            let key = |member: &str| {
                element
                    .parts
                    .iter()
                    .position(|(key, _)| key.is_some_and(|k| self.words.word(k) == member))
            };
            let member = match rest {
                [component, ..] if component.kind == Component => {
                    let typed = &self.words.text[component.span.range()];
                    key(&typed[1..]).map(|index| (index, 1))
                }
                [dot, name, ..] if self.words.is_dot(*dot) => {
                    key(self.words.word(*name)).map(|index| (index, 2))
                }
                [open, number, close, ..]
                    if (open.kind, number.kind, close.kind)
                        == (OpenBracket, Number, CloseBracket) =>
                {
                    let number = self.words.text[number.span.range()].parse::<usize>().ok();
                    let index = number.and_then(|number| number.checked_sub(self.first_index()));
                    index.filter(|index| *index < element.parts.len()).map(|index| (index, 3))
                }
                _ => None,
            };
            match member {
                Some((index, length)) => {
                    all.extend(in_brackets(&element.parts[index].1));
                    at += length;
                }
                None => all.extend(element.tokens()),
            }
        }
        all
    }

    /// The index of the first element: 0 or 1.
    fn first_index(&self) -> usize {
        let is_from_zero = match self.language {
            // A text that is no program counts from 0 if it has the index 0 or signs of Python.
            Language::Plain => {
                ["import ", "**", "np.", "[0]"].iter().any(|sign| self.words.text.contains(sign))
            }
            Language::Script => !self.words.text.contains("local "),
            Language::Typed | Language::Python | Language::OpenScad => true,
        };
        usize::from(!is_from_zero)
    }

    /// Writes out JavaScript's `list.reduce((s, b) => E, start)`, if the token at `at` is its list.
    fn reduction(&mut self, tokens: &[Token], at: usize) -> Option<(Range<usize>, Vec<Token>)> {
        let array = self.arrays.get(self.words.word(tokens[at]))?.clone();
        let [dot, reduce, rest @ ..] = &tokens[at + 1..] else { return None };
        if !self.words.is_dot(*dot) || self.words.word(*reduce) != "reduce" {
            return None;
        }
        let end = closing(rest)?;
        let [function, start] = <[_; 2]>::try_from(split(&rest[1..end], Comma)).ok()?;
        let (names, arrow) = bracketed(&function)?;
        let [equals, greater, body @ ..] = arrow else { return None };
        let names = split(names, Comma);
        let [Some(sum), Some(name)] = [names.first()?.first(), names.get(1)?.first()] else {
            return None;
        };
        if (equals.kind, greater.kind) != (Equals, Greater) {
            return None;
        }
        let mut value = start;
        for element in array.elements {
            value = self.bound(body, &[(*sum, Element::single(value)), (*name, element)]);
            if value.len() > MOST_TOKENS {
                return None;
            }
        }
        Some((at..at + 3 + end + 1, in_brackets(&value)))
    }

    /// Writes out `total(E)` of Desmos. In `E`, an array's name stands for each element in turn.
    fn listed_sum(&self, tokens: &[Token], at: usize) -> Option<(Range<usize>, Vec<Token>)> {
        let name = plain_name(self.words.word(tokens[at]));
        let is_column = |pair: &[Token]| {
            self.arrays.contains_key(self.words.word(pair[0]))
                && pair[1].kind == OpenBracket
                && self.words.text[pair[1].span.end..].trim_start().starts_with(':')
        };
        // numpy's `sum(f(c[:, 0], c[:, 1]))` goes through the rows of `c`.
        let of_columns = name == "sum" && tokens[at..].windows(2).any(is_column);
        if !of_columns && !matches!(name.as_str(), "total" | "Total") {
            return None;
        }
        let (inner, _) = bracketed(tokens.get(at + 1..)?)?;
        // Mathematica's `Total[f /@ list]` is expanded elsewhere.
        if inner.iter().any(|token| token.kind == Ampersand) {
            return None;
        }
        let list = inner.iter().find(|token| self.arrays.contains_key(self.words.word(**token)))?;
        let word = self.words.word(*list);
        let array = self.arrays.get(word)?;
        let values = array.elements.iter().map(|one| self.bound(inner, &[(*list, one.clone())]));
        let start = self.without_module(tokens, at);
        Some((start..at + inner.len() + 3, joined(&values.collect::<Vec<_>>(), Plus)))
    }

    /// Writes out a sum over a range of numbers, if its index selects elements of an array:
    /// `sum(i = 1..3, E)` and `\sum_{i=1}^{3} E`.
    fn indexed_sum(
        &mut self,
        tokens: &[Token],
        at: usize,
        frame: &mut Frame,
    ) -> Option<(Range<usize>, Vec<Token>)> {
        let rest = &tokens[at + 1..];
        let (index, low, high, body, length) = if tokens[at].kind == BigSum {
            let [below, open, index, equals, ..] = rest else { return None };
            let is_range = (below.kind, open.kind, equals.kind) == (Underscore, OpenBrace, Equals);
            let (range, rest) = bracketed(&rest[1..]).filter(|_| is_range)?;
            let (high, body) = match rest {
                [caret, rest @ ..] if caret.kind == Caret => match bracketed(rest) {
                    Some((high, body)) => (high, body),
                    None => (rest.get(..1)?, &rest[1..]),
                },
                _ => return None,
            };
            let mut depth = 0_usize;
            let ends = |token: &Token| {
                depth += usize::from(token.kind.closer().is_some());
                let is_end = depth == 0
                    && (matches!(token.kind, Plus | Minus | Comma)
                        || token.kind.is_relation()
                        || token.kind.is_closer());
                depth = depth.saturating_sub(usize::from(token.kind.is_closer()));
                is_end
            };
            let term = body.iter().position(ends).unwrap_or(body.len());
            let length = tokens.len() - at - body.len() + term;
            (*index, &range[2..], high, &body[..term], length)
        } else {
            if !matches!(self.words.word(tokens[at]), "sum" | "Sum") {
                return None;
            }
            let (inner, behind) = bracketed(rest)?;
            let comma = outside(inner, Comma)?;
            let [index, equals, range @ ..] = &inner[..comma] else { return None };
            let dots = outside(range, Dots).filter(|_| equals.kind == Equals)?;
            let length = tokens.len() - at - behind.len();
            (*index, &range[..dots], &range[dots + 1..], &inner[comma + 1..], length)
        };
        let ends = [self.known_value(low, frame)?, self.known_value(high, frame)?];
        let numbers =
            steps(ends[0], ends[1], 1.0, true, MOST_ELEMENTS).filter(|_| self.selects(body))?;
        let mut values = Vec::new();
        for number in numbers {
            // The number is one token, so it is a known index where it selects an element.
            let token = self.number(number, index.span, frame);
            let is_index = |one: &Token| self.words.word(*one) == self.words.word(index);
            let term = body.iter().map(|one| if is_index(one) { token } else { *one });
            values.push(term.collect());
        }
        Some((at..at + length, joined(&values, Plus)))
    }

    /// Returns whether a formula selects elements of an array.
    fn selects(&self, body: &[Token]) -> bool {
        body.windows(3).any(|window| {
            self.arrays.contains_key(self.words.word(window[0])) && window[1].kind == OpenBracket
        })
    }

    /// Sets an element of an array whose size was declared: `c[0] = vec3(1)`. Returns false for any
    /// other statement.
    pub(crate) fn sets_element(&mut self, tokens: &[Token], frame: &mut Frame) -> Fallible<bool> {
        let [name, rest @ ..] = tokens else { return Ok(false) };
        let (Some((index, [equals, value @ ..])), true) =
            (bracketed(rest), self.declared_arrays.contains(self.words.word(*name)))
        else {
            return Ok(false);
        };
        let index = self.known_value(index, frame).filter(|_| rest[0].kind == OpenBracket);
        let index = index.filter(|_| equals.kind == Equals && frame.nested == 0);
        let value = self.run_effects(value.to_vec(), frame)?;
        let value = self.with_selections(&value, frame);
        let kind = self.kind_of(value, frame)?;
        let element = Element::single(vec![self.saved(kind, name.span, false, frame)]);
        let array = self.arrays.get_mut(self.words.word(*name));
        let place = array.zip(index).and_then(|(array, at)| array.elements.get_mut(at as usize));
        let refused = || Error::new(name.span, ErrorKind::Array);
        place.map(|place| *place = element).ok_or_else(refused).map(|()| true)
    }

    /// Records the declaration `c[3]` of an array. Returns false for any other declaration.
    pub(crate) fn declares_array(&mut self, tokens: &[Token], frame: &Frame) -> bool {
        let Some((name, [_, ..])) = tokens.split_first() else { return false };
        let size = Words::inside(&tokens[1..]).and_then(|size| self.known_value(size, frame));
        let Some(size) = size.filter(|size| (1.0..=MOST_ELEMENTS as f64).contains(size)) else {
            return false;
        };
        let sets = |(_, behind): (&str, &str)| {
            let value = behind.starts_with('[').then(|| behind.split_once(']')).flatten();
            value.is_some_and(|(_, value)| {
                let value = value.trim_start();
                value.starts_with('=') && !value.starts_with("==")
            })
        };
        let word = self.words.word(*name).to_owned();
        if !self.uses(&word).any(sets) {
            return false;
        }
        // Until an element is set, its value is not known.
        let unset = vec![Element::single(vec![*name]); size as usize];
        self.arrays.insert(word.clone(), Array::of(unset));
        self.declared_arrays.insert(word)
    }

    /// A statement with elements in place of `c[i]`, `c[i][j]`, `c[i, j]` and `c[[i]]`.
    fn with_selections(&mut self, tokens: &[Token], frame: &Frame) -> Vec<Token> {
        let first = self.first_index();
        let mut all = Vec::with_capacity(tokens.len());
        let mut at = 0;
        while let Some(token) = tokens.get(at) {
            let found = self.arrays.get(self.words.word(*token)).and_then(|array| {
                let (indices, length) = self.indices(array, &tokens[at + 1..], frame)?;
                let number = |(index, from): &(f64, usize)| {
                    let number = index - *from as f64;
                    (number.fract() == 0.0 && number >= 0.0).then_some(number as usize)
                };
                let [row, rest @ ..] = indices.as_slice() else { return None };
                let element = array.elements.get(number(&(*row, first_of(array, first)))?)?;
                let Some(column) = rest.first() else { return Some((element.tokens(), length)) };
                let column = number(&(*column, first_of(array, first)))?;
                Some((in_brackets(&element.parts.get(column)?.1), length))
            });
            let Some((element, length)) = found else {
                all.push(*token);
                at += 1;
                continue;
            };
            all.extend(element);
            at += length + 1;
        }
        all
    }

    /// The known indices in the brackets behind an array, and the number of their tokens.
    fn indices(&self, array: &Array, rest: &[Token], frame: &Frame) -> Option<(Vec<f64>, usize)> {
        let open = if array.is_round { OpenParen } else { OpenBracket };
        let (mut all, mut length) = (Vec::new(), 0);
        while let Some((mut inner, _)) = rest.get(length..).and_then(bracketed)
            && rest[length].kind == open
            && all.len() < 2
        {
            let whole = inner.len() + 2;
            if let Some((within, [])) = bracketed(inner).filter(|_| inner[0].kind == OpenBracket) {
                inner = within;
            }
            let parts = split(inner, Comma);
            let values: Option<Vec<f64>> =
                parts.iter().map(|part| self.known_value(part, frame)).collect();
            let Some(values) = values else { break };
            all.extend(values);
            length += whole;
        }
        (!all.is_empty()).then_some((all, length))
    }
}

/// The index of the first element of an array: 1 in MATLAB, else `first`.
fn first_of(array: &Array, first: usize) -> usize {
    if array.is_round { 1 } else { first }
}
