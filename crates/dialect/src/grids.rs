//! Reads ranges and grids that a program defines before a plot, and draws the program's plots.

use crate::known_numbers::number_expr;
use crate::mathmod::are_alike;
use crate::plot_arguments::{PlotRange, axes_of};
use crate::plot_commands::{AXES, Plot, minus_level};
use crate::program_reader::{Frame, ProgramReader};
use crate::program_words::Words;
use zeroset_ir::Axis;
use zeroset_parser::lex::token::{
    Token, bracketed, in_brackets, is_outside, outside, span_of, split,
};
use zeroset_parser::lex::token_kind::TokenKind::{self, *};
use zeroset_parser::tree::aliases::Aliases;
use zeroset_parser::tree::ast::{
    Definition, Expr, ExprKind, Function, Name, NamedValue, Statement,
};
use zeroset_parser::tree::built_statement::BuiltStatement;
use zeroset_parser::tree::raw_statement::Head;
use zeroset_parser::{Error, ErrorKind, Fallible, Note, NoteKind, Span};

/// Largest number of tokens of a range or row. Names stand for them, so a limit keeps texts short.
const MAX_RANGE: usize = 200;

/// Largest number of tokens that replace names in a value.
const MAX_RESOLVED: usize = 2000;

/// Functions that make grids of coordinates, each with the ranges as arguments.
pub(crate) const GRIDS: [&str; 4] = ["meshgrid", "ndgrid", "mgrid", "ogrid"];

/// Functions that make a range from its two ends.
pub(crate) const RANGES: [&str; 5] = ["linspace", "arange", "LinRange", "seq", "range"];

/// Largest number of functions whose names stand for their calls. Each name is searched among them.
const MAX_ALIASES: usize = 200;

/// The coordinate of an axis.
fn coordinate(axis: TokenKind) -> ExprKind {
    let axis = match axis {
        X => Axis::X,
        Y => Axis::Y,
        _ => Axis::Z,
    };
    ExprKind::Name(NamedValue::Coordinate(axis))
}

/// The axis to which the name of a grid's coordinate refers, such as `x` or `X`.
fn named_axis(name: &str) -> Option<TokenKind> {
    match name {
        "x" | "X" => Some(X),
        "y" | "Y" => Some(Y),
        "z" | "Z" => Some(Z),
        _ => None,
    }
}

/// The ranges in `*[range]*3`, as in `np.meshgrid(*[t]*3)`.
fn repeated(inner: &[Token]) -> Option<Vec<Vec<Token>>> {
    let first = inner.first().filter(|star| star.kind == Star)?;
    let (list, [star, number]) = bracketed(&inner[1..])? else { return None };
    let is_repeated = (first.kind, star.kind, number.kind) == (Star, Star, Number);
    (is_repeated && !list.is_empty()).then(|| vec![list.to_vec()])
}

/// The tokens of `factor*(value)`.
fn times(factor: &[Token], value: &[Token]) -> Vec<Token> {
    let mut all = in_brackets(factor);
    all.push(Token::new(Star, value[0].span));
    all.extend(in_brackets(value));
    all
}

impl ProgramReader<'_> {
    /// Records a range such as `t = linspace(-2, 2)`, or reads the grid `[X, Y] = meshgrid(t, t)`.
    /// Returns false for any other statement.
    pub(crate) fn grid(&mut self, tokens: &[Token], frame: &mut Frame) -> Fallible<bool> {
        let words = self.words;
        if let [set, name, range @ ..] = tokens
            && words.word(*set) == "set"
            && let Some((inner, behind)) = bracketed(range)
            && behind.iter().all(|token| token.kind.is_name())
        {
            let name_of = words.word(*name);
            let is_axis = matches!(name_of, "xrange" | "yrange" | "urange" | "vrange" | "trange");
            if let (true, Ok(ends)) = (is_axis, <[_; 2]>::try_from(split(inner, Colon))) {
                self.ranges.insert(words.word(*name).to_owned(), ends);
                return Ok(true);
            }
        }
        let mut is_equals = is_outside(Equals);
        let signs = (0..tokens.len()).filter(|at| is_equals(&tokens[*at]));
        let Some(equals) = signs.last() else { return Ok(false) };
        let (left, value) = (&tokens[..equals], &tokens[equals + 1..]);
        let (factor, value) = self.without_factor(value);
        let names: Vec<Token> = left.iter().copied().filter(|token| token.kind.is_name()).collect();
        let (Some(first), Some(name)) = (value.first(), names.first()) else { return Ok(false) };
        if value.len() > MAX_RANGE {
            return Ok(false);
        }
        let is_grid = GRIDS.contains(&words.word(*first));
        if let (true, Some((inner, _))) = (is_grid && names.len() > 1, bracketed(&value[1..])) {
            // numpy writes the step of a range last, MATLAB between its ends.
            let steps_last = matches!(words.word(*first), "mgrid" | "ogrid");
            let parts = repeated(inner).unwrap_or_else(|| split(inner, Comma));
            self.meshgrid(&names, &parts, steps_last, factor, frame)?;
            return Ok(true);
        }
        if let [name] = left
            && let Some(done) = self.julia_array(*name, value, frame)?
        {
            return Ok(done);
        }
        if self.grid_points(&names, value, frame) {
            return Ok(true);
        }
        let is_list = left.iter().all(|token| token.kind.is_name() || token.kind == Equals);
        let row = bracketed(value).filter(|(inner, rest)| {
            let is_row = first.kind == OpenBracket && inner.iter().all(|t| t.kind != Comma);
            is_row && inner.len() > 1 && rest.is_empty()
        });
        if let Some(row) = row.and_then(|(inner, _)| words.numbers(inner)).filter(|_| is_list) {
            let ends = [row[0].clone(), row[1].clone()];
            self.rows.insert(words.word(*name).to_owned(), value.to_vec());
            self.ranges.insert(words.word(*name).to_owned(), ends);
            return Ok(true);
        }
        // In `v = u`, the second range is as the first one.
        let is_same = !name.kind.is_axis()
            && matches!(value, [other] if self.ranges.contains_key(words.word(*other)));
        if !is_list || !self.has_grid || value.len() == 1 && (self.is_python || !is_same) {
            return Ok(false);
        }
        let Some(ends) = self.range_ends(value, false, frame) else { return Ok(false) };
        for name in names {
            self.ranges.insert(words.word(name).to_owned(), ends.clone());
        }
        Ok(true)
    }

    /// Reads `x, y, z = grid.points.T` or `x = grid.points[:, 0]` of `PyVista`: coordinates.
    fn grid_points(&self, names: &[Token], value: &[Token], frame: &mut Frame) -> bool {
        let [_, dot, points, index @ ..] = value else { return false };
        let axes = match Words::inside(index) {
            None if index.is_empty() && names.len() == 3 => AXES.to_vec(),
            Some([number]) if names.len() == 1 => {
                let number = self.known_value(&[*number], frame);
                let found = AXES.into_iter().enumerate().find(|(at, _)| Some(*at as f64) == number);
                found.into_iter().map(|(_, axis)| axis).collect()
            }
            _ => Vec::new(),
        };
        let is_read = self.words.is_dot(*dot) && self.words.word(*points) == "points";
        if !is_read || axes.is_empty() {
            return false;
        }
        for (name, axis) in names.iter().zip(axes) {
            frame.aliases.push(self.words.name(*name).text, coordinate(axis));
        }
        true
    }

    /// Reads Julia's `v = [f for x in r, y in r, z in r]`: a formula, and its variables' ranges.
    fn julia_array(
        &mut self,
        name: Token,
        value: &[Token],
        frame: &mut Frame,
    ) -> Fallible<Option<bool>> {
        let Some(inner) = Words::inside(value).filter(|_| value[0].kind == OpenBracket) else {
            return Ok(None);
        };
        let Some(at) = inner.iter().position(|token| self.words.word(*token) == "for") else {
            return Ok(None);
        };
        let mut names = Vec::new();
        let mut parts = Vec::new();
        for part in split(&inner[at + 1..], Comma) {
            let [name, sign, range @ ..] = part.as_slice() else { return Ok(None) };
            let is_range = matches!(sign.kind, In | Equals) && !range.is_empty();
            if !name.kind.is_axis() || !is_range {
                return Ok(None);
            }
            names.push(*name);
            parts.push(range.to_vec());
        }
        if names.len() < 2 {
            return Ok(None);
        }
        self.meshgrid(&names, &parts, false, None, frame)?;
        let head = Head { name: self.words.name(name), parameters: None };
        self.push(inner[..at].to_vec(), Some(head), None, &frame.aliases.clone(), false)?;
        Ok(Some(true))
    }

    /// The ends of a range such as `-2:0.1:2`, `linspace(-2, 2, 50)` or the name of a range. A step
    /// stands between the ends, or behind them if `steps_last`.
    fn range_ends(
        &mut self,
        value: &[Token],
        steps_last: bool,
        frame: &mut Frame,
    ) -> Option<[Vec<Token>; 2]> {
        if let [_] = value {
            let value = self.resolved(value);
            let name = value.first().filter(|_| value.len() == 1)?;
            return self.ranges.get(self.words.word(*name)).cloned();
        }
        if RANGES.contains(&self.words.word(value[0])) {
            let (inner, _) = bracketed(&value[1..])?;
            let parts = split(inner, Comma);
            return Some([parts.first()?.clone(), parts.get(1)?.clone()]);
        }
        // Python's `:32` goes from 0 to 31.
        if let ([colon, high @ ..], true) = (value, steps_last)
            && colon.kind == Colon
            && outside(high, Colon).is_none()
        {
            let span = span_of(high)?;
            let last = self.known_value(&self.resolved(high), frame)? - 1.0;
            let ends = [0.0, last].map(|end| number_expr(end, span));
            return Some(ends.map(|end| vec![self.saved(end, span, true, frame)]));
        }
        let value = match bracketed(value) {
            Some((inner, [])) => inner,
            _ => value,
        };
        if value.iter().any(|token| token.kind.is_relation()) {
            return None;
        }
        let parts = split(value, Colon);
        let (low, high) = match &parts[..] {
            [low, high, _] if steps_last => (low, high),
            [low, high] | [low, _, high] => (low, high),
            _ => return None,
        };
        Some([low.clone(), high.clone()])
    }

    /// Reads the names and the ranges of a grid.
    fn meshgrid(
        &mut self,
        names: &[Token],
        parts: &[Vec<Token>],
        steps_last: bool,
        factor: Option<&[Token]>,
        frame: &mut Frame,
    ) -> Fallible<()> {
        let words = self.words;
        let own = |name: &Token| named_axis(words.word(*name));
        let own_axes: Vec<Option<Token>> =
            names.iter().map(|name| Some(Token::new(own(name)?, name.span))).collect();
        let axes = axes_of(&own_axes, false)?;
        for (name, axis) in names.iter().zip(&axes) {
            if own(name).is_none() {
                frame.aliases.push(self.words.name(*name).text, coordinate(*axis));
            }
        }
        let part = |index: usize| parts.get(index).or(parts.first());
        let range = |index: usize| {
            let [low, high] = self
                .range_ends(part(index)?, steps_last, frame)?
                .map(|end| factor.map_or(end.clone(), |factor| times(factor, &end)));
            Some(PlotRange { name: None, low, high })
        };
        let ranges: Option<Vec<PlotRange>> = (0..names.len()).map(range).collect();
        let Some(ranges) = ranges else {
            let (span, kind) = (names[0].span, NoteKind::PlotWithoutRanges);
            self.program.notes.push(Note { span, kind });
            return Ok(());
        };
        // Coordinates that are computed from the grid are over these ranges.
        for (name, PlotRange { low, high, .. }) in names.iter().zip(&ranges) {
            if own(name).is_none() {
                let word = self.words.word(*name).to_owned();
                self.ranges.entry(word).or_insert([low.clone(), high.clone()]);
            }
        }
        self.add_domain(&ranges, &axes, names[0].span, &frame.aliases.clone())
    }

    /// The factor before a grid, as in `pi*np.mgrid[-1:1:9j, -1:1:9j]`, and the grid.
    fn without_factor<'t>(&self, value: &'t [Token]) -> (Option<&'t [Token]>, &'t [Token]) {
        let at = value.iter().position(|token| GRIDS.contains(&self.words.word(*token)));
        match at {
            Some(at) if at > 1 && value[at - 1].kind == Star => {
                (Some(&value[..at - 1]), &value[at..])
            }
            _ => (None, value),
        }
    }

    /// Defines `name` as the coordinate of an axis.
    fn define_axis(&mut self, name: Token, axis: TokenKind) {
        let name = self.words.name(name);
        let span = name.span;
        let body = Expr::new(coordinate(axis), span);
        let definition = Definition { name, parameters: None, body, range: None };
        let built = BuiltStatement::synthesized(Statement::Define(definition), span);
        self.program.synthesized.push(built);
    }

    /// Replaces the names of rows, as in `fimplicit3(f, interval)`, by the rows.
    pub(crate) fn with_rows(&self, tokens: Vec<Token>) -> Vec<Token> {
        if self.rows.is_empty() {
            return tokens;
        }
        let row = |token: &Token| self.rows.get(self.words.word(*token));
        let with = |token: Token| row(&token).cloned().unwrap_or_else(|| vec![token]);
        tokens.into_iter().flat_map(with).collect()
    }

    /// Adds the formulas and the domain of a plot.
    pub(crate) fn draw(&mut self, plot: Plot, place: Span, frame: &Frame) -> Fallible<()> {
        let Plot { formulas, is_height, domain, notes, renamed, grid } = plot;
        self.program.notes.extend(notes);
        let mut aliases = frame.aliases.clone();
        let words = self.words;
        let word = |token: &Token| words.word(*token);
        // In another order, the plot would be a mirror image of the formula's surface.
        let is_another = |(name, axis): &(&Token, TokenKind)| {
            let own = named_axis(word(name)).map(coordinate);
            own.as_ref().or(aliases.find(word(name))).is_some_and(|own| *own != coordinate(*axis))
        };
        if let Some((name, _)) = grid.iter().zip(AXES).find(is_another) {
            return Err(Error::new(name.span, ErrorKind::PlotVariables));
        }
        let mut read = Vec::new();
        for (name, axis) in renamed {
            let text = self.words.name(name).text;
            read.push(format!("{text} = {}", axis.as_char()));
            // The definitions of the formula may use the variables of the plot.
            let mut tokens = formulas.iter().flatten();
            let is_used = tokens.clone().any(|token| word(token) == word(&name));
            if !is_used && tokens.any(|token| self.arity(*token).is_some()) {
                if self.arity(name).is_some() {
                    return Err(Error::new(name.span, ErrorKind::PlotVariables));
                }
                self.define_axis(name, axis);
            }
            aliases.push(text, coordinate(axis));
        }
        if !read.is_empty() {
            read.dedup();
            let kind = NoteKind::PlotNames { read: read.join(", ") };
            self.program.notes.push(Note { span: place, kind });
        }
        for mut formula in formulas {
            // In a plot, `f = 0` is an equation, even if `f` has a value.
            if let [name, equals, right @ ..] = formula.as_slice()
                && equals.kind == Equals
                && name.kind == TokenKind::Name
                && right.first().is_some_and(|first| first.kind != OpenBrace)
            {
                // A restriction stays behind the equation.
                let is_brace = |token: &Token| token.kind == OpenBrace;
                let (right, behind) =
                    right.split_at(right.iter().position(is_brace).unwrap_or(right.len()));
                formula = [&minus_level(&[*name], right), behind].concat();
            }
            for (index, name) in formula.iter().enumerate() {
                let next = formula.get(index + 1).and_then(|next| next.kind.closer());
                if name.kind == TokenKind::Name && next.is_none() {
                    self.call_in_plot(*name, is_height, &mut aliases);
                }
            }
            // A name alone that the text does not define may name a picture, or data.
            if let [name] = formula.as_slice()
                && (name.kind == TokenKind::Name || is_height && name.kind == Z)
                && aliases.find(word(name)).is_none()
                && self.arity(*name).is_none()
            {
                self.program.notes.extend(words.unused_note(&[formula]));
                continue;
            }
            self.push(formula, None, None, &aliases, is_height)?;
        }
        let set = ["xrange", "yrange"].map(|name| self.ranges.get(name).cloned());
        let set = match set {
            [Some(x), Some(y)] => {
                let range = |[low, high]: [Vec<Token>; 2]| PlotRange { name: None, low, high };
                Some((vec![range(x), range(y)], vec![X, Y]))
            }
            _ => None,
        };
        let Some((ranges, axes)) = domain.or(set) else { return Ok(()) };
        self.add_domain(&ranges, &axes, place, &frame.aliases)
    }

    /// Adds a `domain` line for the ranges of a plot or grid.
    fn add_domain(
        &mut self,
        ranges: &[PlotRange],
        axes: &[TokenKind],
        place: Span,
        aliases: &Aliases,
    ) -> Fallible<()> {
        let resolved = |range: &PlotRange| PlotRange {
            name: None,
            low: self.resolved(&range.low),
            high: self.resolved(&range.high),
        };
        let ranges: Vec<PlotRange> = ranges.iter().map(resolved).collect();
        let (line, mut note) = self.words.domain(&ranges, axes, place);
        let frame = Frame { aliases: aliases.clone(), ..Frame::default() };
        let ends = ranges.iter().flat_map(|range| [&range.low, &range.high]);
        let known: Option<Vec<f64>> = ends.map(|end| self.known_value(end, &frame)).collect();
        let is_computed = ranges.iter().any(|range| range.high.iter().any(|t| t.kind == Saved));
        if let (true, Some(known), Some(note)) = (is_computed, known, &mut note) {
            let pairs = axes.iter().zip(known.chunks_exact(2));
            let all = pairs.map(|(axis, ends)| format!("{} in {ends:?}", axis.as_char()));
            note.kind = NoteKind::PlotDomain { domain: all.collect::<Vec<_>>().join(", ") };
        }
        self.program.notes.extend(note);
        line.map_or(Ok(()), |line| self.push(line, None, None, aliases, false))
    }

    /// Adds the domain that holds the boxes of all surfaces. Returns false, with a note, if boxes
    /// differ and an end is not a known number.
    pub(crate) fn boxes(&mut self, boxes: &[Vec<PlotRange>], place: Span) -> Fallible<bool> {
        let Some((first, others)) = boxes.split_first() else { return Ok(true) };
        let number = |end: &[Token]| self.known_value(&self.resolved(end), &Frame::default());
        let mut ranges = first.clone();
        for other in others.iter().filter(|other| !are_alike(self.words.text, first, other)) {
            for (range, other) in ranges.iter_mut().zip(other) {
                let ends =
                    [&range.low, &other.low, &range.high, &other.high].map(|end| number(end));
                let [Some(low), Some(other_low), Some(high), Some(other_high)] = ends else {
                    self.program
                        .notes
                        .push(Note { span: place, kind: NoteKind::PlotWithoutRanges });
                    return Ok(false);
                };
                if other_low < low {
                    range.low.clone_from(&other.low);
                }
                if other_high > high {
                    range.high.clone_from(&other.high);
                }
            }
        }
        self.add_domain(&ranges, &AXES, place, &Aliases::default()).map(|()| true)
    }

    /// The condition that a point is in a box. Adds the coordinates in it to `aliases`.
    pub(crate) fn in_box(&mut self, ranges: &[PlotRange], aliases: &mut Aliases) -> Vec<Token> {
        let mut all = Vec::new();
        for (range, axis) in ranges.iter().zip(AXES) {
            let place = range.low[0].span;
            let sign = |kind| Token::new(kind, Span::at(place.start));
            let (name, token) = self.new_saved(Span::at(place.start));
            aliases.push(name, coordinate(axis));
            if !all.is_empty() {
                all.push(sign(And));
            }
            all.extend(in_brackets(&range.low));
            all.extend([sign(LessEqual), token, sign(LessEqual)]);
            all.extend(in_brackets(&range.high));
        }
        all
    }

    /// Records the value that a statement outside functions assigns to a name.
    pub(crate) fn record_assigned(&mut self, tokens: &[Token]) {
        let pairs: Vec<(Token, Vec<Token>)> = match Words::parallel(tokens) {
            Some((names, values)) => names.into_iter().zip(values).collect(),
            None => match tokens {
                [name, equals, value @ ..] if equals.kind == Equals && name.kind.is_name() => {
                    vec![(*name, value.to_vec())]
                }
                _ => return,
            },
        };
        let values: Vec<Vec<Token>> = pairs
            .iter()
            .map(|(name, value)| {
                let uses_itself = self.words.has(value, self.words.word(*name));
                if uses_itself { self.resolved(value) } else { value.clone() }
            })
            .collect();
        for ((name, _), value) in pairs.into_iter().zip(values) {
            self.assigned.insert(self.words.word(name).to_owned(), value);
        }
    }

    /// `tokens` with assigned values in place of names.
    pub(crate) fn resolved(&self, tokens: &[Token]) -> Vec<Token> {
        let mut budget = MAX_RESOLVED;
        self.resolved_within(tokens, 0, &mut budget)
    }

    fn resolved_within(&self, tokens: &[Token], depth: usize, budget: &mut usize) -> Vec<Token> {
        let mut all = Vec::with_capacity(tokens.len());
        for (index, token) in tokens.iter().enumerate() {
            let is_called = tokens.get(index + 1).is_some_and(|next| next.kind == OpenParen);
            let word = self.words.word(*token);
            let value = self.assigned.get(word).filter(|_| !self.ranges.contains_key(word));
            match value
                .filter(|value| !is_called && depth < 8 && (1..=*budget).contains(&value.len()))
            {
                Some(value) => {
                    *budget -= value.len();
                    let value = self.resolved_within(value, depth + 1, budget);
                    if tokens.len() == 1 {
                        all.extend(value);
                    } else {
                        all.extend(in_brackets(&value));
                    }
                }
                None => all.push(*token),
            }
        }
        all
    }

    /// Makes the name of a function stand for its call at the coordinates.
    fn call_in_plot(&self, name: Token, is_height: bool, aliases: &mut Aliases) {
        let count = if is_height { 2 } else { 3 };
        if self.arity(name) == Some(count) && aliases.count() < MAX_ALIASES {
            let Name { text, span } = self.words.name(name);
            let point = [X, Y, Z].into_iter().take(count);
            let point = point.map(|axis| Expr::new(coordinate(axis), span)).collect();
            aliases.push(text.clone(), ExprKind::Call(Function::Defined(text), point));
        }
    }

    /// The number of parameters of a name that the text defines; 0 for a value.
    pub(crate) fn arity(&self, name: Token) -> Option<usize> {
        self.arities.get(self.words.word(name)).copied()
    }

    /// Records the name that a statement defines, with its number of parameters.
    pub(crate) fn record_arity(&mut self, tokens: &[Token], head: Option<&Head>) {
        let (name, count) = match (head, tokens) {
            (Some(head), _) => {
                (head.name.text.clone(), head.parameters.as_ref().map_or(0, Vec::len))
            }
            (None, [name, equals, ..]) if equals.kind == Equals => {
                (self.words.word(*name).to_owned(), 0)
            }
            (None, [name, rest @ ..]) => match bracketed(rest) {
                Some((inner, [equals, ..])) if equals.kind == Equals => {
                    (self.words.word(*name).to_owned(), split(inner, Comma).len())
                }
                _ => return,
            },
            _ => return,
        };
        self.arities.insert(name, count);
    }
}
