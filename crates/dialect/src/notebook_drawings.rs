//! Reads the calls of Python's libraries that draw, and the commands of other systems that take
//! lists of coordinates.

use crate::curve_commands::LISTED;
use crate::drawing_calls::{DRAWING_CALLS, Drawn, PythonCall, Source};
use crate::formats::part;
use crate::known_numbers::number_expr;
use crate::lists::separated;
use crate::plot_arguments::PlotRange;
use crate::plot_commands::{AXES, minus_level};
use crate::program_reader::{Frame, ProgramReader};
use crate::program_words::Words;
use zeroset_ir::Axis;
use zeroset_parser::lex::token::{Token, bracketed, in_brackets, span_of, split};
use zeroset_parser::lex::token_kind::TokenKind::{self, *};
use zeroset_parser::tree::ast::{ExprKind, NamedValue};
use zeroset_parser::{Error, ErrorKind, Fallible, Note, NoteKind, Span};

/// Largest number of surfaces between two levels.
const MAX_LEVELS: f64 = 20.0;

impl ProgramReader<'_> {
    /// Adds the drawings of the calls in `tokens`. Returns whether there was one.
    pub(crate) fn notebook_draws(&mut self, tokens: &[Token], frame: &mut Frame) -> Fallible<bool> {
        let mut is_drawn = false;
        if self.words.word(tokens[0]) == "def" {
            return Ok(false);
        }
        for at in 0..tokens.len() {
            let word = self.words.word(tokens[at]);
            let Some(row) = DRAWING_CALLS.iter().find(|row| row.word == word) else { continue };
            let Some((inner, _)) = tokens.get(at + 1..).and_then(bracketed) else { continue };
            if tokens[at + 1].kind != OpenParen || self.arity(tokens[at]).is_some() {
                continue;
            }
            let receiver = match &tokens[..at] {
                [.., name, dot] if self.words.is_dot(*dot) && name.kind.is_name() => Some(*name),
                _ => None,
            };
            // SymPy's `plot3d(f, (x, -1, 1))` and `plot_implicit` have no module before them.
            if receiver.is_none() && matches!(word, "plot3d" | "plot" | "mesh" | "surf") {
                continue;
            }
            let arguments = self.words.plot_arguments(inner);
            let call = PythonCall::new(row, tokens[at], receiver, arguments);
            is_drawn |= match row.drawn {
                Drawn::Level => self.draw_level(call, frame)?,
                Drawn::Height => self.draw_height(call, frame)?,
                Drawn::Curve => self.draw_curve(call, frame)?,
            };
        }
        Ok(is_drawn)
    }

    /// The formula that `value` stands for: the scalars of an object, or `value` itself.
    fn field(&mut self, value: &[Token], frame: &mut Frame) -> Fallible<Vec<Token>> {
        let value = match value {
            [name] => self.fields.get(self.words.word(*name)).map_or(value, Vec::as_slice).to_vec(),
            _ => value.to_vec(),
        };
        self.with_calls(value, frame)
    }

    fn draw_level(&mut self, mut call: PythonCall, frame: &mut Frame) -> Fallible<bool> {
        let words = self.words;
        let Some((mut value, source)) = call.find(words, call.row.formula) else {
            return Ok(false);
        };
        if Words::has_unknown(&value) {
            let span = span_of(&value).unwrap_or_default();
            return Err(Error::new(span, ErrorKind::NoFormula));
        }
        if source == Source::Receiver {
            let name = words.word(value[0]);
            let is_known = self.fields.contains_key(name) || self.arity(value[0]).is_some();
            // Any grid may hold the last value, but not the result of another call.
            let makes_grid = |token: &Token| self.words.word(*token).ends_with("Grid");
            let is_made = self.assigned.get(name).is_some_and(|made| {
                !made.iter().any(|t| makes_grid(t) || self.words.word(*t) == "ImageData")
            });
            if is_made && !is_known {
                return Err(Error::new(value[0].span, ErrorKind::NoFormula));
            }
            match &self.program.last_value {
                Some(last) if !is_known => value = vec![Token::new(TokenKind::Name, last.span)],
                None if !is_known => return Ok(false),
                _ => {}
            }
        }
        let value = self.field(&value, frame)?;
        let levels = self.call_levels(&mut call, source, frame)?;
        if call.row.word == "contour" && source != Source::Receiver && levels.is_empty() {
            return self.draw_heights(&value, &call, frame);
        }
        let mut ranges = Some(self.call_ranges(&mut call));
        let levels: Vec<Option<Vec<Token>>> =
            if levels.is_empty() { vec![None] } else { levels.into_iter().map(Some).collect() };
        let mut left = std::mem::take(&mut call.named);
        left.retain(|part| !is_grid(words, part));
        let has_no_level = call.row.level.is_empty() && call.row.formula != [Source::Key("value")];
        for level in levels {
            let command = if has_no_level { "implicit" } else { "marching_cubes" };
            let parts =
                std::iter::once(value.clone()).chain(level).chain(std::mem::take(&mut left));
            let parts: Vec<Vec<Token>> = parts.collect();
            for mut plot in words.plots_of(command, &in_brackets(&separated(&parts)))? {
                plot.domain = ranges.take().filter(|(ranges, _)| !ranges.is_empty());
                self.draw(plot, call.name.span, frame)?;
            }
        }
        Ok(true)
    }

    fn draw_height(&mut self, mut call: PythonCall, frame: &mut Frame) -> Fallible<bool> {
        let Some((value, _)) = call.find(self.words, call.row.formula) else { return Ok(false) };
        // A grid of all three coordinates is no graph.
        if let [name] = value.as_slice() {
            let z = ExprKind::Name(NamedValue::Coordinate(Axis::Z));
            let alias = frame.aliases.find(self.words.word(*name));
            let is_z = matches!(self.words.word(*name), "z" | "Z") && self.arity(*name).is_none();
            if alias.map_or(is_z, |kind| *kind == z) {
                return Ok(false);
            }
        }
        if Words::has_unknown(&value) {
            let span = span_of(&value).unwrap_or_default();
            return Err(Error::new(span, ErrorKind::NoFormula));
        }
        let own = [call.take(self.words, "x"), call.take(self.words, "y")];
        let given = if call.positional.len() > 2 { &call.positional[..2] } else { &[] };
        for (part, axis) in own.iter().flatten().chain(given).zip([Axis::X, Axis::Y]) {
            if self.is_computed(part, axis, frame) {
                let surface = self.surface_over_ranges(&own, given, &value, call.name.span);
                let (surface, names) =
                    surface.ok_or_else(|| Error::new(call.name.span, ErrorKind::Parametric))?;
                return self.plain_over(surface, &names, frame).map(|()| true);
            }
        }
        let value = self.field(&value, frame)?;
        self.draw_heights(&value, &call, frame)
    }

    /// The statement of a surface whose coordinates are computed from two ranges: x and y as named
    /// arguments or as `given`, and z. Returns also the names of the ranges. `None` if they do not
    /// use two.
    pub(crate) fn surface_over_ranges(
        &self,
        named: &[Option<Vec<Token>>],
        given: &[Vec<Token>],
        z: &[Token],
        place: Span,
    ) -> Option<(Vec<Token>, [Token; 2])> {
        let [x, y] = <[&Vec<Token>; 2]>::try_from(
            named.iter().flatten().chain(given).take(2).collect::<Vec<_>>(),
        )
        .ok()?;
        let parts: Vec<(Vec<Token>, Vec<Token>)> =
            [x, y, z].map(|part| (Vec::new(), self.without_outer(self.resolved(part)))).to_vec();
        let mut names: Vec<Token> = Vec::new();
        for name in parts.iter().flat_map(|(_, part)| part) {
            let word = self.words.word(*name);
            let is_new = names.iter().all(|other| self.words.word(*other) != word);
            if is_new && self.ranges.contains_key(word) && !name.kind.is_axis() {
                names.push(*name);
            }
        }
        // In the order in which the text gives the ranges.
        names.sort_by_key(|name| self.ranges[self.words.word(*name)][0][0].span.start);
        let [u, v] = <[Token; 2]>::try_from(names).ok()?;
        let range = |name: Token| {
            let ends = self.ranges[self.words.word(name)].clone();
            let [low, high] = ends.map(|end| self.resolved(&end));
            PlotRange { name: None, low, high }
        };
        let (of_u, of_v) = (range(u), range(v));
        Some((self.words.path(place, &parts, &[(u, &of_u), (v, &of_v)]), [u, v]))
    }

    /// A value without the call `outer(a, b)` of Python over two ranges: the product of a and b. A
    /// factor of ones is left out.
    fn without_outer(&self, mut tokens: Vec<Token>) -> Vec<Token> {
        while let Some(at) = tokens.iter().position(|token| self.words.word(*token) == "outer")
            && let Some((inner, rest)) = bracketed(&tokens[at + 1..])
            && let Ok([one, other]) = <[_; 2]>::try_from(split(inner, Comma))
        {
            let is_ones = |part: &[Token]| {
                let words = part.iter().take(3).map(|token| self.words.word(*token));
                words.into_iter().any(|word| matches!(word, "ones" | "ones_like"))
            };
            let product = if is_ones(&one) {
                in_brackets(&other)
            } else if is_ones(&other) {
                in_brackets(&one)
            } else {
                let star = Token::new(Star, Span::at(other[0].span.start));
                in_brackets(&[in_brackets(&one), vec![star], in_brackets(&other)].concat())
            };
            let (start, end) = (self.without_module(&tokens, at), tokens.len() - rest.len());
            tokens.splice(start..end, product);
        }
        tokens
    }

    /// Returns whether a coordinate of a grid is computed from others, as on a parametric surface.
    pub(crate) fn is_computed(&self, part: &[Token], axis: Axis, frame: &Frame) -> bool {
        let [name] = part else { return part.iter().any(|token| token.kind.is_name()) };
        let word = self.words.word(*name);
        let own = ExprKind::Name(NamedValue::Coordinate(axis));
        match frame.aliases.find(word) {
            Some(kind) => {
                *kind != own && !matches!(kind, ExprKind::Name(NamedValue::Coordinate(_)))
            }
            None => self.assigned.contains_key(word) && !self.ranges.contains_key(word),
        }
    }

    /// Draws the graph of `value` over x and y.
    fn draw_heights(
        &mut self,
        value: &[Token],
        call: &PythonCall,
        frame: &mut Frame,
    ) -> Fallible<bool> {
        let is_name = |part: &&Vec<Token>| part.len() == 1 && part[0].kind.is_name();
        let grid: Vec<Token> =
            call.positional.iter().take(2).filter(is_name).map(|part| part[0]).collect();
        let left = call.named.iter().filter(|part| !is_grid(self.words, part)).cloned();
        let parts: Vec<Vec<Token>> = std::iter::once(value.to_vec()).chain(left).collect();
        for mut plot in self.words.plots_of("plot3d", &in_brackets(&separated(&parts)))? {
            plot.grid = if call.positional.len() > 2 { grid_of(&grid) } else { Vec::new() };
            plot.notes.extend(self.words.unused_note(call.positional.get(3..).unwrap_or_default()));
            if matches!(call.row.word, "contour" | "contourf") {
                plot.notes.push(Note { span: call.name.span, kind: NoteKind::LinesAsGraph });
            }
            self.draw(plot, call.name.span, frame)?;
        }
        Ok(true)
    }

    /// Draws the curve through three lists of coordinates over the range of a parameter.
    fn draw_curve(&mut self, mut call: PythonCall, frame: &mut Frame) -> Fallible<bool> {
        let words = self.words;
        let mut parts = call.positional.clone();
        parts.truncate(3);
        let is_flat = match parts.as_slice() {
            [_, y] | [_, y, _] if Words::has_unknown(y) => false,
            [_, _] => true,
            [_, _, style] => Words::has_unknown(style),
            _ => false,
        };
        if is_flat {
            // A curve in the plane of x and y. Its coordinates are no formulas to draw.
            self.program.last_value = None;
            return Ok(false);
        }
        if parts.len() < 3 {
            parts = ["x", "y", "z"].iter().filter_map(|name| call.take(words, name)).collect();
        }
        if parts.len() < 3 || parts.iter().any(|part| Words::has_unknown(part)) {
            return Ok(false);
        }
        match self.curve_over_range(&parts, call.name.span)? {
            Some(curve) => self.plain(curve, frame, false).map(|()| true),
            None => Ok(false),
        }
    }

    /// Draws `contour(x, y, f, [0, 0])` of MATLAB, or `contour(x, y, z, f, levels=[0])` of Julia.
    /// Returns false for any other statement.
    pub(crate) fn contour_command(
        &mut self,
        tokens: &[Token],
        frame: &mut Frame,
    ) -> Fallible<bool> {
        let row = DRAWING_CALLS.iter().find(|row| row.word == "contour");
        let (Some(row), "contour") = (row, self.words.word(tokens[0])) else { return Ok(false) };
        let Some((inner, _)) = tokens.get(1..).and_then(bracketed) else { return Ok(false) };
        let mut parts = self.words.plot_arguments(inner);
        if parts.len() < 3 || self.arity(tokens[0]).is_some() {
            return Ok(false);
        }
        let is_text = |part: &Vec<Token>| part[0].kind == Unknown;
        let is_list = |part: &Vec<Token>| {
            let typed = self.words.text.get(part[0].span.range()).unwrap_or_default();
            typed.contains("LevelList")
        };
        if let Some(at) = parts.iter().position(is_list).filter(|at| at + 1 < parts.len()) {
            // The option `'LevelList', v` becomes the fourth argument, a list.
            let mut levels = parts.remove(at + 1);
            if levels[0].kind != OpenBracket {
                let place = Span::at(levels[0].span.start);
                levels.insert(0, Token::new(OpenBracket, place));
                levels.push(Token::new(CloseBracket, place));
            }
            parts.insert(parts.len().min(3), levels);
        } else if parts
            .get(3)
            .is_some_and(|part| matches!(part.as_slice(), [name] if name.kind.is_name()))
        {
            parts.remove(2);
        }
        parts.retain(|part| !is_text(part));
        let call = PythonCall::new(row, tokens[0], None, parts);
        self.draw_level(call, frame)
    }

    /// `tokens` with a formula in place of the string that holds it, as in `ezplot('x^2 = y')`.
    pub(crate) fn with_typed_formula(&self, tokens: &[Token]) -> Fallible<Vec<Token>> {
        let mut all = tokens.to_vec();
        let start = self.words.assigned_at(tokens).map_or(0, |at| at + 1);
        let command = all.get(start).map_or("", |token| self.words.word(*token));
        if let (true, Some(text)) = (command.starts_with("ez"), all.get(start + 2).copied())
            && text.kind == Unknown
            && text.span.end - text.span.start > 2
        {
            let range = text.span.start + 1..text.span.end - 1;
            all.splice(start + 2..start + 3, part(self.words.text, range, &self.limits)?);
        }
        Ok(all)
    }

    /// Draws `plot3(x, y, z)`, in which the coordinates are lists over a range. Returns false for
    /// any other statement.
    pub(crate) fn listed_curve(&mut self, tokens: &[Token], frame: &mut Frame) -> Fallible<bool> {
        let Some((inner, _)) = tokens.get(1..).and_then(bracketed) else { return Ok(false) };
        let is_command = LISTED.contains(&self.words.word(tokens[0]));
        let parts = split(inner, Comma);
        if !is_command || parts.len() < 3 || self.arity(tokens[0]).is_some() {
            return Ok(false);
        }
        let Some(curve) = self.curve_over_range(&parts[..3], tokens[0].span)? else {
            return Ok(false);
        };
        self.program.notes.extend(self.words.unused_note(&parts[3..]));
        self.plain(curve, frame, false).map(|()| true)
    }

    /// The statement of a curve with these coordinates. Its parameter is a range that they use.
    pub(crate) fn curve_over_range(
        &self,
        parts: &[Vec<Token>],
        place: Span,
    ) -> Fallible<Option<Vec<Token>>> {
        let parts: Vec<(Vec<Token>, Vec<Token>)> =
            parts.iter().map(|part| (Vec::new(), self.resolved(part))).collect();
        let mut names: Vec<Token> = parts.iter().flat_map(|(_, part)| part).copied().collect();
        names.retain(|name| self.ranges.contains_key(self.words.word(*name)));
        let Some(name) = names.iter().find(|name| !name.kind.is_axis()).copied() else {
            return match names.first() {
                Some(name) => Err(Error::new(name.span, ErrorKind::CurveRange)),
                None => Ok(None),
            };
        };
        let ends = |name: Token| {
            let ends = self.ranges[self.words.word(name)].clone();
            ends.map(|end| self.resolved(&end))
        };
        let [low, high] = ends(name);
        // A second range is run through at the same time: `c + (d - c)*(t - a)/(b - a)`.
        names.retain(|other| self.words.word(*other) != self.words.word(name));
        let sign = |kind| Token::new(kind, Span::at(place.start));
        let rules: Vec<(Token, Vec<Token>)> = names
            .into_iter()
            .map(|other| {
                let [first, last] = ends(other);
                let mut all = in_brackets(&first);
                all.push(sign(Plus));
                all.extend(in_brackets(&minus_level(&last, &first)));
                all.push(sign(Star));
                all.extend(in_brackets(&minus_level(&[name], &low)));
                all.push(sign(Slash));
                all.extend(in_brackets(&minus_level(&high, &low)));
                (other, all)
            })
            .collect();
        let with_rules = |(own, part): (Vec<Token>, Vec<Token>)| {
            Some((own, Words::substituted(&part, &rules, self.words.text)?))
        };
        let parts: Option<Vec<_>> = parts.into_iter().map(with_rules).collect();
        let range = PlotRange { name: None, low, high };
        Ok(parts.map(|parts| self.words.path(place, &parts, &[(name, &range)])))
    }

    /// The levels of a call. Between plotly's `isomin` and `isomax` they are evenly spaced.
    fn call_levels(
        &mut self,
        call: &mut PythonCall,
        formula: Source,
        frame: &mut Frame,
    ) -> Fallible<Vec<Vec<Token>>> {
        let words = self.words;
        if let (Some(low), Some(high)) = (call.take(words, "isomin"), call.take(words, "isomax")) {
            return self.spaced_levels(call, low, high, frame);
        }
        let mut sources = call.row.level;
        if call.row.word == "contour" {
            // The first argument holds PyVista's levels, and the fourth one those of a grid.
            let is_last = |source: &Source| *source == Source::At(0);
            let end = sources.iter().position(is_last).unwrap_or(sources.len());
            sources = if formula == Source::Receiver { sources } else { &sources[..end] };
        }
        let Some((level, source)) = call.find(words, sources) else { return Ok(Vec::new()) };
        let list = Words::inside(&level).filter(|_| level[0].kind != OpenParen || level.len() > 3);
        if let Some(list) = list {
            let typed = |tokens: &[Token]| span_of(tokens).map(|span| &words.text[span.range()]);
            let row = words.numbers(list).filter(|_| !list.iter().any(|t| t.kind == Comma));
            let mut levels = row.unwrap_or_else(|| split(list, Comma));
            levels.dedup_by(|one, other| typed(one) == typed(other));
            return Ok(levels);
        }
        // In these calls, a single number is the number of levels. Their values depend on the data.
        let is_count = matches!(call.row.word, "contour" | "contour3d" | "iso_surface");
        if is_count && formula != Source::Receiver && call.row.word == "contour" {
            return Ok(Vec::new());
        }
        if is_count || Words::has_unknown(&level) {
            let name = match source {
                Source::Key(name) => name,
                _ => call.row.word,
            };
            let span = span_of(&level).unwrap_or_default();
            return Err(Error::new(span, ErrorKind::PlotOption { name: name.to_owned() }));
        }
        Ok(vec![level])
    }

    fn spaced_levels(
        &mut self,
        call: &mut PythonCall,
        low: Vec<Token>,
        high: Vec<Token>,
        frame: &mut Frame,
    ) -> Fallible<Vec<Vec<Token>>> {
        let words = self.words;
        let span = span_of(&low).unwrap_or_default();
        let ends = [&low, &high].map(|end| self.known_value(&self.resolved(end), frame));
        let nested = call.take(words, "surface").and_then(|value| {
            let at = value.iter().position(|token| words.word(*token) == "count")?;
            value.get(at + 2).map(|number| vec![*number])
        });
        let count = call.take(words, "surface_count").or(nested);
        let count = count.map_or(Some(2.0), |count| self.known_value(&count, frame));
        let name = if count == Some(1.0) { "surface_count" } else { "isomin" };
        let refused = || Error::new(span, ErrorKind::PlotOption { name: name.to_owned() });
        match (ends, count) {
            #[allow(clippy::float_cmp)] // the same number, typed twice
            ([Some(a), Some(b)], _) if a == b => Ok(vec![low]),
            (_, Some(2.0)) => Ok(vec![low, high]),
            ([Some(a), Some(b)], Some(count)) if (3.0..=MAX_LEVELS).contains(&count) => {
                let level = |index| {
                    let level = number_expr(a + (b - a) * f64::from(index) / (count - 1.0), span);
                    vec![self.saved(level, span, false, frame)]
                };
                Ok((0..count as u32).map(level).collect())
            }
            _ => Err(refused()),
        }
    }

    /// The ranges of a call, such as `x_range=[-2, 2]` or corners, each with its axis.
    fn call_ranges(&mut self, call: &mut PythonCall) -> (Vec<PlotRange>, Vec<TokenKind>) {
        let words = self.words;
        let pair = |low: &[Token], high: &[Token]| PlotRange {
            name: None,
            low: low.to_vec(),
            high: high.to_vec(),
        };
        let items = |value: &[Token]| Words::inside(value).map(|inner| split(inner, Comma));
        if call.row.word == "marching_cubes_func" {
            let corners: Vec<_> = call.positional.iter().take(2).filter_map(|c| items(c)).collect();
            return match corners.as_slice() {
                [low, high] if low.len() == 3 && high.len() == 3 => {
                    let ranges = low.iter().zip(high).map(|(low, high)| pair(low, high));
                    (ranges.collect(), AXES.to_vec())
                }
                _ => (Vec::new(), Vec::new()),
            };
        }
        let mut range = |axis: TokenKind| {
            let axis = axis.as_char();
            let given = call.take(words, &format!("{axis}_range")).and_then(|value| items(&value));
            let both = ["min", "max"].map(|end| call.take(words, &format!("{axis}{end}")));
            match (given.as_deref(), both) {
                (Some([low, high, ..]), _) => Some(pair(low, high)),
                (_, [Some(low), Some(high)]) => Some(pair(&low, &high)),
                _ => None,
            }
        };
        AXES.into_iter().filter_map(|axis| Some((range(axis)?, axis))).unzip()
    }
}

/// Returns whether an argument is a coordinate of the grid or its scalars.
fn is_grid(words: Words<'_>, part: &[Token]) -> bool {
    matches!(words.word(part[0]), "x" | "y" | "z" | "X" | "Y" | "Z" | "scalars")
}

/// The names of a grid if there are two; else an empty list.
fn grid_of(names: &[Token]) -> Vec<Token> {
    if names.len() == 2 { names.to_vec() } else { Vec::new() }
}
