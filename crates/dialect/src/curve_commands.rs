//! Reads commands of other systems that plot a curve or a parametric surface: the three
//! coordinates, and one or two parameters with their ranges. They become a statement such as
//! `(cos t, sin t, t) for t in [0, 20]`.

use crate::plot_arguments::{Arguments, PlotRange};
use crate::program_words::Words;
use zeroset_parser::lex::curve_form::parameter_range;
use zeroset_parser::lex::spelling::{is_name_char, plain_name, prefix_length, short_name};
use zeroset_parser::lex::token::{Token, bracketed, closing, in_brackets, outside, span_of, split};
use zeroset_parser::lex::token_kind::TokenKind::{self, *};
use zeroset_parser::{Error, ErrorKind, Fallible, Note, NoteKind, Span};

/// Commands that plot a curve, and some of them also a surface.
#[rustfmt::skip] // several words a line
pub(crate) const COMMANDS: &[&str] = &[
    "ParametricPlot3D", "spacecurve", "parametric_plot3d", "plot3d_parametric_line", "Curve",
    "fplot3", "ParametricFunction", "ParametricCurve", "ParametricPlot", "curve3d", "plotparam",
    "parametric",
];

/// Commands that plot three lists of coordinates.
pub(crate) const LISTED: &[&str] = &["plot3", "plot3d", "lines3d", "scatter3", "comet3", "line3d"];

/// Commands that plot a surface given by two parameters.
#[rustfmt::skip] // several words a line
const SURFACES: &[&str] = &[
    "Surface", "ParametricSurface", "plot3d_parametric_surface", "parametricplot3d", "fsurf",
    "ezsurf", "fmesh", "ezmesh", "parametric_surface", "plot3d",
];

/// Commands that plot a graph if they have only one function.
const GRAPHS: &[&str] = &["fsurf", "ezsurf", "fmesh", "ezmesh"];

/// Options with the range of the first parameter, and of the second.
const RANGES: [&[&str]; 2] = [&["t_range", "u_range"], &["v_range"]];

/// Words before the list in which Python and manim write a point.
const LISTS: &[&str] = &["array", "stack", "Vector", "vector", "Matrix"];

/// Commands that draw the segment between two points.
const SEGMENTS: &[&str] = &["segment", "Segment", "vector", "Vector", "arrow", "Arrow"];

/// Returns whether a word is a command that may plot a parametric surface.
pub(crate) fn draws_surface(word: &str) -> bool {
    // Most words are shorter names.
    matches!(word.as_bytes(), [_, second, _, _, _, ..] if second.is_ascii_alphabetic())
        && (COMMANDS.contains(&word) || SURFACES.contains(&word))
}

/// The tokens of a point with these coordinates.
fn point(coordinates: &[Vec<Token>]) -> Vec<Token> {
    let mut inner = Vec::new();
    for coordinate in coordinates {
        if let Some(first) = coordinate.first().filter(|_| !inner.is_empty()) {
            inner.push(Token::new(Comma, Span::at(first.span.start)));
        }
        inner.extend(coordinate);
    }
    in_brackets(&inner)
}

/// The tokens of a curve or a parametric surface with these coordinates, over the ranges of its
/// parameters.
pub(crate) fn path_of(
    place: Span,
    parts: &[Vec<Token>],
    ranges: &[(Token, &PlotRange)],
) -> Vec<Token> {
    let sign = |kind: TokenKind, at: usize| Token::new(kind, Span::at(at));
    let start = place.start;
    let mut all = vec![sign(CurveWord, start)];
    // One part is a vector.
    let is_point = parts.len() > 1;
    all.extend(is_point.then(|| sign(OpenParen, start)));
    for (index, part) in parts.iter().enumerate() {
        let span = span_of(part).unwrap_or(place);
        if index > 0 {
            all.push(sign(Comma, span.start));
        }
        all.extend(part);
    }
    let end = ranges.first().filter(|_| is_point);
    all.extend(end.map(|(_, range)| sign(CloseParen, range.low[0].span.start)));
    for (name, PlotRange { low, high, .. }) in ranges {
        let (from, to) = (low[0].span.start, high[high.len() - 1].span.end);
        all.extend([sign(For, from), *name, sign(In, from), sign(OpenBracket, from)]);
        all.extend(low);
        all.push(sign(Comma, high[0].span.start));
        all.extend(high);
        all.push(sign(CloseBracket, to));
    }
    all
}

/// A vector that is no list, as `r[u] + v {0, 0, 1}` of Mathematica, with the lists in it in round
/// brackets. `None` for several values, and for a list.
fn sum_of_lists(part: &[Token]) -> Option<Vec<Token>> {
    let is_list = bracketed(part).is_some_and(|(_, rest)| rest.is_empty());
    if is_list || outside(part, Comma).is_some() {
        return None;
    }
    let mut sum = part.to_vec();
    for at in (0..part.len()).rev().filter(|at| part[*at].kind == OpenBrace) {
        let end = at + closing(&sum[at..])?;
        (sum[at].kind, sum[end].kind) = (OpenParen, CloseParen);
        if at > 0 && part[at - 1].kind.ends_operand() {
            sum.insert(at, Token::new(Star, Span::at(part[at].span.start)));
        }
    }
    Some(sum)
}

impl Words<'_> {
    /// The statement of a command that draws a segment between two points, or the vector from the
    /// origin to a point.
    pub(crate) fn segment(self, tokens: &[Token]) -> Option<Vec<Token>> {
        let (first, rest) = tokens.split_first()?;
        let (inner, []) = bracketed(rest)? else { return None };
        let word = plain_name(self.word(*first));
        let word = word.as_str();
        if word == "Graphics3D" {
            // Mathematica writes the points in a list, and colors before the shape.
            let parts = split(Self::inside(inner).unwrap_or(inner), Comma);
            let (shape, styles) = parts.split_last()?;
            let [word, open, ..] = shape.as_slice() else { return None };
            let is_shape = matches!(self.word(*word), "Line" | "Arrow")
                && styles.iter().all(|style| style[0].kind == TokenKind::Name);
            let (list, []) = bracketed(&shape[1..]).filter(|_| is_shape)? else { return None };
            let (points, []) = bracketed(list)? else { return None };
            return Self::ends(*open, split(points, Comma));
        }
        let parts = split(inner, Comma);
        let number = |part: &Vec<Token>| part.iter().all(|t| matches!(t.kind, Number | Minus));
        if word == "quiver3" && matches!(parts.len(), 6 | 7) && parts.iter().all(number) {
            let [from, way] = [&parts[..3], &parts[3..6]].map(point);
            let plus = Token::new(Plus, Span::at(way[0].span.start));
            let to = from.iter().copied().chain([plus]).chain(way).collect();
            return Self::ends(*first, vec![from, to]);
        }
        if word == "plot3" && parts.len() == 3 {
            let rows: Option<Vec<_>> =
                parts.iter().map(|part| self.numbers(bracketed(part)?.0)).collect();
            let rows = rows.filter(|rows| rows.iter().all(|row| row.len() == 2))?;
            let end = |at: usize| point(&[0, 1, 2].map(|axis: usize| rows[axis][at].clone()));
            return Self::ends(*first, vec![end(0), end(1)]);
        }
        let is_point = |part: &Vec<Token>| match part.as_slice() {
            [name] => name.kind == TokenKind::Name,
            part => {
                let coordinates = bracketed(part).filter(|(_, rest)| rest.is_empty());
                coordinates.is_some_and(|(inner, _)| split(inner, Comma).len() == 3)
            }
        };
        let is_vector = parts.len() == 1 && word.eq_ignore_ascii_case("vector");
        let is_segment = SEGMENTS.contains(&word) && parts.iter().all(is_point);
        (is_segment && (is_vector || parts.len() == 2)).then(|| Self::ends(*first, parts))?
    }

    /// The statement of a segment with these ends.
    fn ends(place: Token, mut ends: Vec<Vec<Token>>) -> Option<Vec<Token>> {
        for end in &mut ends {
            if let [open, .., close] = end.as_mut_slice()
                && open.kind.closer() == Some(close.kind)
            {
                (open.kind, close.kind) = (OpenParen, CloseParen);
            }
        }
        let (to, from) = (ends.pop()?, ends.pop());
        let start = Span::at(place.span.start);
        let mut all = vec![Token::new(SegmentWord, start), Token::new(OpenParen, start)];
        if let Some(end) = from {
            all.extend(end);
            all.push(Token::new(Comma, Span::at(to[0].span.start)));
        }
        all.extend(&to);
        all.push(Token::new(CloseParen, Span::at(to[to.len() - 1].span.end)));
        ends.is_empty().then_some(all)
    }

    /// The statement of a command that plots a curve, and a note on arguments that have no effect;
    /// `None` if `tokens` are no such command.
    pub(crate) fn curve_command(
        self,
        tokens: &[Token],
    ) -> Fallible<Option<(Vec<Token>, Option<Note>)>> {
        let at = tokens.iter().take(8).position(|token| draws_surface(self.word(*token)));
        let Some(at) = at else { return Ok(self.common_curve(tokens)) };
        let is_before = |token: &Token| {
            token.kind.is_name() || matches!(token.kind, Equals | Comma) || self.is_dot(*token)
        };
        // Maple's `plots[spacecurve](…)`, and Maxima's `draw3d(parametric(…))`.
        if let [plots, open, command, close, rest @ ..] = tokens
            && (self.word(*plots), open.kind, close.kind) == ("plots", OpenBracket, CloseBracket)
        {
            return self.curve_command(&[&[*command], rest].concat());
        }
        if let [draw, rest @ ..] = tokens
            && at > 1
            && self.word(*draw) == "draw3d"
            && let Some(curve) = Self::inside(rest).and_then(|inner| {
                let mut parts = split(inner, Comma).into_iter();
                parts.find(|part| self.word(part[0]) == "parametric")
            })
        {
            return self.curve_command(&curve);
        }
        let Some((inner, rest)) = bracketed(&tokens[at + 1..]) else { return Ok(None) };
        let is_end = |token: &Token| matches!(token.kind, Colon | Unknown | Semicolon);
        let is_whole = tokens[..at].iter().all(is_before)
            && (rest.iter().all(is_end) || self.is_style_tail(rest));
        if !is_whole {
            return Ok(None);
        }
        let (word, place) = (self.word(tokens[at]), tokens[at].span);
        let mut arguments = Arguments::new(split(inner, Comma));
        if !rest.iter().all(is_end) {
            arguments.record_unused(rest.to_vec());
        }
        let are_functions = |parts: &[Vec<Token>]| {
            let is_one = |part: &&Vec<Token>| {
                self.lambda(part).is_some()
                    || matches!(part.as_slice(), [name] if self.is_function(*name))
            };
            parts.iter().take(3).filter(is_one).count() == 3
        };
        let is_point = |part: &Vec<Token>| self.listed_point(part).is_some();
        if GRAPHS.contains(&word) && !are_functions(arguments.all())
            || word == "plot3d" && !arguments.all().first().is_some_and(is_point)
        {
            return Ok(None);
        }
        let Some((parts, count)) = self.coordinates(&mut arguments) else { return Ok(None) };
        let own = parts.iter().map(|(names, _)| names).find(|names| !names.is_empty());
        let most = own.map_or(2, |names| names.len().clamp(1, 2));
        let ranges = self.parameter_ranges(&mut arguments, count, most);
        let kind =
            if SURFACES.contains(&word) { ErrorKind::Parametric } else { ErrorKind::CurveRange };
        let is_surface = SURFACES.contains(&word);
        if !(1..=2).contains(&ranges.len()) || is_surface && ranges.len() == 1 {
            return Err(Error::new(place, kind));
        }
        let mut names = Vec::new();
        for (index, range) in ranges.iter().enumerate() {
            let own = own.and_then(|names| names.get(index)).copied();
            let name = range.name.or(own).or_else(|| self.handle_parameter(index));
            names.push(name.ok_or_else(|| Error::new(place, kind.clone()))?);
        }
        let note = self.unused_note(&arguments.into_unused());
        let ranges: Vec<(Token, &PlotRange)> = names.into_iter().zip(&ranges).collect();
        Ok(Some((self.path(place, &parts, &ranges), note)))
    }

    /// Joins the two equations of a LaTeX environment `cases` into one curve.
    pub(crate) fn join_cases(self, statements: &mut Vec<Vec<Token>>) {
        let mut at = 0;
        while at + 1 < statements.len() {
            if let Some(curve) = self.case_equations(&statements[at], &statements[at + 1]) {
                statements.splice(at..at + 2, [curve]);
            }
            at += 1;
        }
    }

    /// The curve of two equations, if an environment `cases` holds them and nothing else.
    fn case_equations(self, one: &[Token], other: &[Token]) -> Option<Vec<Token>> {
        let (start, end) = (one[0].span.start, other[other.len() - 1].span.end);
        let before = self.text[..start].trim_end();
        let between = &self.text[one[one.len() - 1].span.end..other[0].span.start];
        let is_equation = |tokens: &[Token]| {
            let relations = tokens.iter().filter(|token| token.kind.is_relation());
            relations.map(|token| token.kind).eq([Equals])
                && tokens.iter().filter(|token| token.kind.is_axis()).count() > 1
        };
        let is_whole = before.ends_with(r"\begin{cases}")
            && between.contains(r"\\")
            && self.text[end..].trim_start().starts_with(r"\end{cases}");
        (is_whole && is_equation(one) && is_equation(other)).then(|| {
            let mut curve = vec![Token::new(CurveWord, Span::at(start))];
            curve.extend(one);
            curve.push(Token::new(Comma, Span::at(other[0].span.start)));
            curve.extend(other);
            curve
        })
    }

    /// Reads `a = b = c` as the curve on which both equations hold.
    fn common_curve(self, tokens: &[Token]) -> Option<(Vec<Token>, Option<Note>)> {
        let sides = split(tokens, Equals);
        let has = |kind: fn(TokenKind) -> bool| tokens.iter().any(|token| kind(token.kind));
        let is_other = has(|kind| {
            kind.is_relation() && kind != Equals
                || matches!(kind, And | Or | Not | In | Colon | Comma | Semicolon | QuestionMark)
        });
        let [first, middle, last] = sides.as_slice() else { return None };
        let count = tokens.iter().filter(|token| token.kind == Equals).count();
        // `a = b = 3` and `f(x, y, z) = x - y = 0` are definitions.
        let is_head = first[0].kind == TokenKind::Name
            && (first.len() == 1 || closing(&first[1..]) == Some(first.len() - 2));
        let is_zero = matches!(last.as_slice(), [zero] if &self.text[zero.span.range()] == "0");
        // In `x^2 + y^2 = 1 z = 2`, a comma or a line break may be missing.
        let is_apart = middle.windows(2).any(|pair| {
            pair[0].span.end < pair[1].span.start
                && pair[0].kind.ends_operand()
                && pair[1].kind.begins_operand()
        });
        if count != 2 || is_apart || is_other || is_head || is_zero || tokens[0].kind.is_setting() {
            return None;
        }
        let sign = |kind: TokenKind, at: &[Token]| Token::new(kind, Span::at(at[0].span.start));
        let mut all = vec![sign(CurveWord, first)];
        for (left, right) in [(first, middle), (middle, last)] {
            if all.len() > 1 {
                all.push(sign(Comma, right));
            }
            all.extend(left);
            all.push(sign(Equals, right));
            all.extend(right);
        }
        let typed = |side: &[Token]| Some(short_name(&self.text[span_of(side)?.range()]));
        let [first, middle, last] = [typed(first)?, typed(middle)?, typed(last)?];
        let read = format!("curve {first} = {middle}, {middle} = {last}");
        let span = span_of(tokens)?;
        Some((all, Some(Note { span, kind: NoteKind::CommonCurve { read } })))
    }

    /// Joins the equations `x = cos t`, `y = sin t` and `z = t`, and the range of t after them,
    /// into one statement of a curve.
    pub(crate) fn join_coordinates(self, statements: &mut Vec<Vec<Token>>) {
        let mut at = 0;
        while at < statements.len() {
            if let Some((count, curve)) = self.coordinate_equations(&statements[at..]) {
                statements.splice(at..at + count, [curve]);
            }
            at += 1;
        }
    }

    /// The curve whose equations begin the first of `statements`, and its number of statements.
    fn coordinate_equations(self, statements: &[Vec<Token>]) -> Option<(usize, Vec<Token>)> {
        let place = statements.first()?.first().filter(|first| first.kind == X)?.span;
        let is_lead = |token: &Token| matches!(self.word(*token), "for" | "where" | "with");
        let (mut parts, mut count) = (Vec::new(), 0);
        while parts.len() < 4 && count < 4 {
            for part in split(statements.get(count)?, Comma) {
                let pieces = part.split(is_lead).filter(|piece| !piece.is_empty());
                parts.extend(pieces.map(<[Token]>::to_vec));
            }
            count += 1;
        }
        let [x, y, z, range] = parts.as_slice() else { return None };
        let value = |part: &[Token], axis: TokenKind| {
            let equals = part.iter().position(|token| token.kind == Equals)?;
            let is_own = part[0].kind == axis && matches!(equals, 1 | 4) && equals + 1 < part.len();
            is_own.then(|| (Vec::new(), part[equals + 1..].to_vec()))
        };
        let parts = [value(x, X)?, value(y, Y)?, value(z, Z)?];
        let (name, low, high) = parameter_range(range).filter(|(name, ..)| !name.kind.is_axis())?;
        let range = PlotRange { name: None, low: low.to_vec(), high: high.to_vec() };
        Some((count, self.path(place, &parts, &[(name, &range)])))
    }

    /// Takes the three coordinates, each with its own parameters if it is a function. Returns also
    /// the number of arguments that hold them.
    #[allow(clippy::type_complexity)] // the caller destructures it
    fn coordinates(
        self,
        arguments: &mut Arguments,
    ) -> Option<(Vec<(Vec<Token>, Vec<Token>)>, usize)> {
        let first = self.unwrapped(arguments.all().first()?);
        let list = self.listed_point(&first.1);
        if let Some(parts) = list {
            arguments.take(0);
            let parts = parts.into_iter().map(|part| {
                let (own, value) = self.unwrapped(&part);
                (if own.is_empty() { first.0.clone() } else { own }, value)
            });
            return Some((parts.collect(), 1));
        }
        let is_range = |part: &Vec<Token>| {
            bracketed(part).is_some_and(|(inner, _)| {
                matches!(split(inner, Comma).as_slice(), [name, _, _] if name.len() == 1)
            })
        };
        let is_vector = arguments.all().get(1).is_some_and(is_range);
        if let Some(sum) = is_vector.then(|| sum_of_lists(&first.1)).flatten() {
            arguments.take(0);
            return Some((vec![(first.0, sum)], 1));
        }
        let three = arguments.all().get(..3)?;
        let is_option = |part: &Vec<Token>| part.get(1).is_some_and(|sign| sign.kind == Equals);
        if three.iter().any(is_option) {
            return None;
        }
        Some(((0..3).map(|index| self.unwrapped(&arguments.take(index))).collect(), 3))
    }

    /// The parameters and the value of an anonymous function; any other value as it is.
    fn unwrapped(self, part: &[Token]) -> (Vec<Token>, Vec<Token>) {
        match self.lambda(part) {
            Some((None, parameters, value)) => {
                (parameters.iter().filter_map(|one| one.first()).copied().collect(), value)
            }
            _ => (Vec::new(), part.to_vec()),
        }
    }

    /// The coordinates of a point that is a list, perhaps as in `np.array([a, b, c])`.
    fn listed_point(self, part: &[Token]) -> Option<Vec<Vec<Token>>> {
        let part = match part {
            [word, rest @ ..] if LISTS.contains(&self.word(*word)) => bracketed(rest)?.0,
            part => part,
        };
        let is_list = matches!(part.first()?.kind, OpenBrace | OpenBracket | OpenParen | OpenList);
        let is_whole = closing(part).is_some_and(|end| end + 1 == part.len());
        let mut parts = split(bracketed(part)?.0, Comma);
        // A curve in the plane, as in `ParametricPlot[{Cos[t], Sin[t]}, …]`, has z = 0.
        if let ([x, _], true) = (parts.as_slice(), self.text.contains("ParametricPlot[")) {
            let is_value = |pair: &&[Token]| {
                pair[0].kind == TokenKind::Name && pair[1].kind.closer().is_none()
            };
            let name = x.windows(2).find(is_value)?[0];
            parts.push(vec![name, Token::new(Minus, Span::at(name.span.start)), name]);
        }
        (is_list && is_whole && parts.len() == 3).then_some(parts)
    }

    /// Takes the parameters' ranges, which follow the coordinates. The coordinates are the first
    /// `count` arguments. There are at most `most` ranges without names.
    fn parameter_ranges(
        self,
        arguments: &mut Arguments,
        count: usize,
        most: usize,
    ) -> Vec<PlotRange> {
        // GeoGebra writes each parameter and its ends as arguments.
        let mut ranges = Vec::new();
        let mut at = count;
        while let Some([name, _, _, ..]) = arguments.all().get(at..)
            && let ([name], true) = (name.as_slice(), name.iter().all(|name| name.kind.is_name()))
        {
            let name = Some(*name);
            arguments.take(at);
            let (low, high) = (arguments.take(at + 1), arguments.take(at + 2));
            ranges.push(PlotRange { name, low, high });
            at += 3;
        }
        if !ranges.is_empty() {
            return ranges;
        }
        for words in RANGES {
            if let Some((_, value)) = self.option(arguments, words)
                && let Some((inner, _)) = bracketed(&value)
                && let [low, high, steps @ ..] = split(inner, Comma).as_slice()
            {
                for step in steps {
                    arguments.record_unused(step.clone());
                }
                ranges.push(PlotRange { name: None, low: low.clone(), high: high.clone() });
            }
        }
        if !ranges.is_empty() {
            return ranges;
        }
        self.ranges(arguments, count, most)
    }

    /// The parameter with this number of the text's first anonymous function, as in `@(t) cos(t)`.
    fn handle_parameter(self, index: usize) -> Option<Token> {
        let start = self.text.find("@(")? + 2;
        let inner = &self.text[start..start + self.text[start..].find(')')?];
        let part = inner.split(',').nth(index)?;
        // Both are slices of the text.
        let start = part.trim_start().as_ptr() as usize - self.text.as_ptr() as usize;
        let length = prefix_length(&self.text[start..], is_name_char);
        let span = Span::new(start, start + length);
        (length > 0).then(|| Token::new(TokenKind::Name, span))
    }

    /// The tokens of the statement. A coordinate that is the name of a function is called.
    pub(crate) fn path(
        self,
        place: Span,
        parts: &[(Vec<Token>, Vec<Token>)],
        ranges: &[(Token, &PlotRange)],
    ) -> Vec<Token> {
        let called = |(_, part): &(Vec<Token>, Vec<Token>)| {
            let mut part = part.clone();
            if let [function] = part.as_slice()
                && self.is_function(*function)
            {
                let end = function.span.end;
                part.push(Token::new(OpenParen, Span::at(end)));
                for (index, (name, _)) in ranges.iter().enumerate() {
                    part.extend((index > 0).then(|| Token::new(Comma, Span::at(end))));
                    part.push(*name);
                }
                part.push(Token::new(CloseParen, Span::at(end)));
            }
            part
        };
        path_of(place, &parts.iter().map(called).collect::<Vec<_>>(), ranges)
    }

    /// Returns whether the text defines a name as an anonymous function.
    fn is_function(self, name: Token) -> bool {
        let typed = self.word(name);
        let defines = |line: &str| {
            let line = line.trim_start();
            let rest = line.strip_prefix(typed).map(str::trim_start);
            let value = rest.and_then(|rest| rest.strip_prefix('=')).map(str::trim_start);
            value.is_some_and(|value| value.starts_with("@(") || value.starts_with("lambda "))
        };
        !typed.is_empty() && self.text.lines().any(defines)
    }
}
