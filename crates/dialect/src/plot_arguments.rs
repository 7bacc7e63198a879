//! Reads the arguments of plot commands: ranges with their names, levels, regions, other options.
//!
//! [`Arguments`] knows which arguments were read. A note lists all others, so no argument is
//! ignored silently.

use crate::grids::RANGES;
use crate::program_words::Words;
use zeroset_parser::lex::spelling::{plain_name, short_name};
use zeroset_parser::lex::token::{Token, bracketed, outside, span_of, split};
use zeroset_parser::lex::token_kind::TokenKind::{self, *};
use zeroset_parser::{Error, ErrorKind, Fallible, Note, NoteKind, Span};

/// Options that give the value of the function on the surface.
const LEVELS: &[&str] = &["Contours", "contour", "isovalue", "level", "isomin"];

/// Options that restrict the surface by a condition.
const REGIONS: &[&str] = &["RegionFunction", "region"];

/// Options that change the surface and cannot be read.
const CHANGES: &[&str] =
    &["ScalingFunctions", "transformation", "TransformationFunction", "contours", "isomax"];

/// Number of parts of a plot that a note quotes.
const MAX_NOTED: usize = 6;

/// The range of a variable.
#[derive(Clone)]
pub(crate) struct PlotRange {
    /// The variable; `None` if the order of the ranges decides.
    pub name: Option<Token>,
    pub low: Vec<Token>,
    pub high: Vec<Token>,
}

/// The arguments of a plot command. Each counts as unread until something takes it.
pub(crate) struct Arguments {
    parts: Vec<Vec<Token>>,
    is_read: Vec<bool>,
    /// Parts of arguments that were taken and then not used.
    unused: Vec<Vec<Token>>,
    /// Names that were taken as the grid of the coordinates.
    pub grid: Vec<Token>,
}

impl Arguments {
    pub(crate) fn new(parts: Vec<Vec<Token>>) -> Self {
        let is_read = vec![false; parts.len()];
        Self { parts, is_read, unused: Vec::new(), grid: Vec::new() }
    }

    /// All arguments, whether they were read or not.
    pub(crate) fn all(&self) -> &[Vec<Token>] {
        &self.parts
    }

    /// Returns the argument at `index` and marks it as read.
    pub(crate) fn take(&mut self, index: usize) -> Vec<Token> {
        self.is_read[index] = true;
        self.parts[index].clone()
    }

    /// The arguments from `start` on that are still unread, each with its index.
    fn unread(&self, start: usize) -> impl Iterator<Item = (usize, &Vec<Token>)> {
        self.parts.iter().enumerate().skip(start).filter(|(index, _)| !self.is_read[*index])
    }

    /// Returns the level at `index`, as in `isosurface(v, 0.5)`, and marks it as read. `None` if an
    /// option or text is there.
    pub(crate) fn level_at(&mut self, index: usize) -> Option<Vec<Token>> {
        let part = self.parts.get(index)?;
        let is_option = part.iter().any(|token| token.kind.is_relation());
        let is_number = part[0].kind != Unknown
            && (part[0].kind.closer().is_none() || part[0].kind == OpenParen);
        (is_number && !is_option).then(|| self.take(index))
    }

    /// Records tokens that were taken from an argument but have no use.
    pub(crate) fn record_unused(&mut self, tokens: Vec<Token>) {
        self.unused.push(tokens);
    }

    /// All tokens that were not read or had no use, in the order of the text.
    pub(crate) fn into_unused(self) -> Vec<Vec<Token>> {
        let unread = self.parts.into_iter().zip(self.is_read).filter(|(_, is_read)| !is_read);
        let mut left: Vec<Vec<Token>> = unread.map(|(part, _)| part).chain(self.unused).collect();
        left.sort_by_key(|part| part.first().map_or(0, |first| first.span.start));
        left
    }
}

impl Words<'_> {
    /// A note on the parts `left` of a plot, which have no effect here; `None` if `left` is empty.
    pub(crate) fn unused_note(self, left: &[Vec<Token>]) -> Option<Note> {
        let spans: Vec<Span> = left.iter().filter_map(|part| span_of(part)).collect();
        let typed = |span: &Span| {
            // A name that stands for a row may put tokens from elsewhere into an argument.
            let text = self.text.get(span.range()).unwrap_or("…");
            format!("`{}`", short_name(&text.split_whitespace().collect::<Vec<_>>().join(" ")))
        };
        let mut left: Vec<String> = spans.iter().take(MAX_NOTED).map(typed).collect();
        if spans.len() > MAX_NOTED {
            left.push("…".to_owned());
        }
        let kind = NoteKind::PlotPartsLeftOut { left: left.join(", ") };
        Some(Note { span: *spans.first()?, kind })
    }

    /// Takes the option that is called one of `names`, as in `contour=4`. Returns its name and its
    /// value.
    pub(crate) fn option(
        self,
        arguments: &mut Arguments,
        names: &[&str],
    ) -> Option<(Token, Vec<Token>)> {
        let (index, name, value) = arguments.unread(0).find_map(|(index, part)| {
            let (name, rest) = part.split_first()?;
            let value = match rest {
                [equals, value @ ..] if equals.kind == Equals => value,
                [minus, arrow, value @ ..] if minus.kind == Minus && arrow.kind == Greater => value,
                _ => return None,
            };
            names.contains(&self.word(*name)).then(|| (index, *name, value.to_vec()))
        })?;
        arguments.is_read[index] = true;
        Some((name, value))
    }

    /// The error for an option that cannot be read.
    fn refused_option(self, name: Token) -> Box<Error> {
        Error::new(name.span, ErrorKind::PlotOption { name: self.word(name).to_owned() })
    }

    /// The levels in an option such as `Contours -> {1}`. Fails if an option changes the surface
    /// and cannot be read.
    pub(crate) fn levels(self, arguments: &mut Arguments) -> Fallible<Vec<Vec<Token>>> {
        if let Some((name, _)) = self.option(arguments, CHANGES) {
            return Err(self.refused_option(name));
        }
        let Some((name, value)) = self.option(arguments, LEVELS) else { return Ok(Vec::new()) };
        let is_list = value.first().is_some_and(|first| first.kind != OpenParen);
        match bracketed(&value).filter(|(_, rest)| is_list && rest.is_empty()) {
            Some((inner, _)) if !inner.is_empty() => Ok(split(inner, Comma)),
            // In Mathematica, a number without braces is the number of levels.
            None if self.word(name) != "Contours" => Ok(vec![value]),
            _ => Err(self.refused_option(name)),
        }
    }

    /// Takes the range of heights in `PlotRange -> {-1, 1}`.
    pub(crate) fn height_range(self, arguments: &mut Arguments) -> Option<PlotRange> {
        let is_range = |part: &Vec<Token>| {
            let value = part.iter().position(|token| token.kind == OpenBrace).map(|at| &part[at..]);
            let ends = value.and_then(Self::inside).map(|inner| split(inner, Comma));
            self.word(part[0]) == "PlotRange"
                && ends.is_some_and(|ends| {
                    ends.len() == 2 && ends.iter().all(|end| end[0].kind != OpenBrace)
                })
        };
        let index = arguments.all().iter().position(is_range)?;
        let part = arguments.take(index);
        let value = &part[part.iter().position(|token| token.kind == OpenBrace)?..];
        let [low, high] = <[_; 2]>::try_from(split(Self::inside(value)?, Comma)).ok()?;
        Some(PlotRange { name: None, low, high })
    }

    /// The condition in an option such as `RegionFunction -> Function[{x, y, z}, x > 0]`, with the
    /// names of its parameters.
    pub(crate) fn region(
        self,
        arguments: &mut Arguments,
    ) -> Fallible<Option<(Vec<Token>, Vec<Token>)>> {
        let Some((name, value)) = self.option(arguments, REGIONS) else { return Ok(None) };
        let Some((None, parameters, condition)) = self.lambda(&value) else {
            return Err(self.refused_option(name));
        };
        let names = parameters.iter().filter_map(|part| part.first()).copied().collect();
        Ok(Some((names, condition)))
    }

    /// Takes the ranges in arguments from `start` on, such as `{x, -2, 2}`, `x = -2..2`,
    /// `x, -2, 2` and `[-2 2 -1 1]`. A plot without names has at most `most` ranges.
    pub(crate) fn ranges(
        self,
        arguments: &mut Arguments,
        start: usize,
        most: usize,
    ) -> Vec<PlotRange> {
        let variable = |part: &[Token]| match part {
            [only] if only.kind.is_name() => Some(*only),
            _ => None,
        };
        let mut ranges = Vec::new();
        let mut read = Vec::new();
        for (index, part) in arguments.unread(start) {
            let found = ranges.len();
            if matches!(part[0].kind, OpenBrace | OpenParen | OpenBracket)
                && let Some((inner, [])) = bracketed(part)
            {
                let parts = split(inner, Comma);
                if let Ok([name, low, high]) = <[_; 3]>::try_from(parts)
                    && let name @ Some(_) = variable(&name)
                {
                    ranges.push(PlotRange { name, low, high });
                } else if let Some(numbers) = self.numbers(inner) {
                    ranges.extend(in_order(&numbers));
                }
            } else if let [name, equals, ends @ ..] = part.as_slice()
                && equals.kind == Equals
                && let (name @ Some(_), Some(dots)) = (variable(&[*name]), outside(ends, Dots))
            {
                let (low, high) = (ends[..dots].to_vec(), ends[dots + 1..].to_vec());
                ranges.push(PlotRange { name, low, high });
            } else if let Some(range) = self.bare_range(part) {
                ranges.push(range);
            }
            read.extend((ranges.len() > found).then_some(index));
        }
        let unread: Vec<(usize, &Vec<Token>)> =
            arguments.unread(start).filter(|(index, _)| !read.contains(index)).collect();
        for group in unread.windows(3) {
            let [(first, name), (_, low), (last, high)] = group else { continue };
            if let Some(name) = variable(name).filter(|name| name.kind.is_axis())
                && first + 2 == *last
            {
                ranges.push(PlotRange {
                    name: Some(name),
                    low: (*low).clone(),
                    high: (*high).clone(),
                });
                read.extend(*first..=*last);
            }
        }
        // R's `from = c(-3, -3), to = c(3, 3)`.
        let corners = ["from", "to"].map(|word| {
            let part = self.parts_of(arguments, word)?;
            (part.len() == 2).then_some(part)
        });
        if let (true, [Some(from), Some(to)]) = (ranges.is_empty(), corners) {
            for (low, high) in from.into_iter().zip(to) {
                ranges.push(PlotRange { name: None, low, high });
            }
            let is_corner = |part: &Vec<Token>| matches!(self.word(part[0]), "from" | "to");
            read.extend((0..arguments.parts.len()).filter(|at| is_corner(&arguments.parts[*at])));
        }
        // MathPartner writes the ends of all ranges as arguments.
        let is_number = |token: &Token| matches!(token.kind, Number | Minus);
        if let (true, Some(ends)) = (ranges.is_empty(), unread.get(..6))
            && ends.iter().all(|(_, end)| end.iter().all(is_number))
        {
            let numbers: Vec<Vec<Token>> = ends.iter().map(|(_, end)| (*end).clone()).collect();
            ranges = in_order(&numbers);
            read.extend(ends.iter().map(|(index, _)| index));
        }
        for index in read {
            arguments.is_read[index] = true;
        }
        ranges.retain(|range| !range.low.is_empty() && !range.high.is_empty());
        if let [range @ PlotRange { name: None, .. }] = ranges.as_slice() {
            // A range alone, as in `[-2 2]`, serves all coordinates.
            ranges = vec![range.clone(); most];
        }
        if ranges.iter().all(|range| range.name.is_none()) && ranges.len() > most {
            for PlotRange { mut low, high, .. } in ranges.drain(most..) {
                low.extend(high);
                arguments.record_unused(low);
            }
        }
        ranges
    }

    /// The values of the list in `word = c(1, 2)`.
    fn parts_of(self, arguments: &Arguments, word: &str) -> Option<Vec<Vec<Token>>> {
        let part = arguments.parts.iter().find(|part| self.word(part[0]) == word)?;
        Some(split(Self::inside(part.get(3..)?)?, Comma))
    }

    /// The range in `-2..2`, `-2:0.1:2`, `x = seq(-2, 2)` or `bbox=(-2, 2)`.
    fn bare_range(self, part: &[Token]) -> Option<PlotRange> {
        if let [name, equals, value @ ..] = part
            && equals.kind == Equals
        {
            let inner = match value {
                [word, rest @ ..] if RANGES.contains(&self.word(*word)) => Self::inside(rest),
                _ if self.word(*name) == "bbox" => Self::inside(value),
                _ => None,
            };
            let ends = split(inner?, Comma);
            let name = Some(*name).filter(|name| name.kind.is_axis());
            let (low, high) = (ends.first()?.clone(), ends.get(1)?.clone());
            return Some(PlotRange { name, low, high });
        }
        let dots = split(part, Dots);
        let ends = if dots.len() == 2 { dots } else { split(part, Colon) };
        let is_option = part.iter().any(|token| token.kind.is_relation() || token.kind == Unknown);
        match ends.as_slice() {
            [low, high] | [low, _, high] if !is_option => {
                Some(PlotRange { name: None, low: low.clone(), high: high.clone() })
            }
            _ => None,
        }
    }

    /// The 2, 4 or 6 values of a MATLAB row, separated by blanks or commas; otherwise `None`.
    pub(crate) fn numbers(self, row: &[Token]) -> Option<Vec<Vec<Token>>> {
        let is_value = |token: &Token| {
            matches!(token.kind, Number | Minus | Star | Slash | Comma)
                || plain_name(self.word(*token)) == "pi"
        };
        if !row.iter().all(is_value) {
            return None;
        }
        let mut values: Vec<Vec<Token>> = vec![Vec::new()];
        for (index, token) in row.iter().enumerate() {
            let before = index.checked_sub(1).map(|at| row[at]);
            let is_apart = before.is_some_and(|before| {
                before.kind.ends_operand() && before.span.end < token.span.start
            });
            let touches = row.get(index + 1).is_some_and(|next| next.span.start == token.span.end);
            let begins = token.kind.begins_operand() || token.kind == Minus && touches;
            if token.kind == Comma || is_apart && begins {
                values.push(Vec::new());
            }
            if token.kind != Comma {
                values.last_mut()?.push(*token);
            }
        }
        let are_whole = values.iter().all(|value| span_of(value).is_some());
        (are_whole && matches!(values.len(), 2 | 4 | 6)).then_some(values)
    }
}

/// Makes ranges in order from pairs of values.
fn in_order(numbers: &[Vec<Token>]) -> Vec<PlotRange> {
    let range =
        |ends: &[Vec<Token>]| PlotRange { name: None, low: ends[0].clone(), high: ends[1].clone() };
    numbers.chunks_exact(2).map(range).collect()
}

/// The axes of the variables of a plot, in order. A coordinate keeps its axis, and any other name
/// gets the next free one. Fails if there are more variables than axes, or equal ones.
pub(crate) fn axes_of(names: &[Option<Token>], is_height: bool) -> Fallible<Vec<TokenKind>> {
    let all: &[TokenKind] = if is_height { &[X, Y] } else { &[X, Y, Z] };
    let axis = |name: &Option<Token>| name.map(|name| name.kind).filter(|kind| kind.is_axis());
    let used: Vec<TokenKind> = names.iter().filter_map(axis).collect();
    let mut free = all.iter().filter(|axis| !used.contains(axis));
    let mut axes = Vec::new();
    for name in names {
        let found = axis(name).or_else(|| free.next().copied());
        let found = found.filter(|axis| all.contains(axis) && !axes.contains(axis));
        let place = name.map_or_else(Default::default, |name| name.span);
        axes.push(found.ok_or_else(|| Error::new(place, ErrorKind::PlotVariables))?);
    }
    Ok(axes)
}

#[cfg(test)]
mod tests {
    use crate::plot_commands::{CONTAINERS, GRIDS, HEIGHTS, LEVELED, METHODS, SURFACES};
    use crate::program_reader::program;
    use crate::{curve_commands, plot_commands};
    use zeroset_parser::{Limits, NoteKind};

    /// The arguments that each command needs.
    fn needed(command: &str) -> &'static str {
        match command {
            _ if curve_commands::COMMANDS.contains(&command) => "(t, 1, 2), (t, 0, 1)",
            _ if GRIDS.contains(&command) => "X, Y, X*Y",
            _ if CONTAINERS.contains(&command) => "implicit_plot3d(x, (x, -1, 1))",
            _ if LEVELED.contains(&command) => "x*y, 1",
            "contour" => "[1], x*y",
            "fimplicit3" => "@(x, y, z) x*y, [-1 1]",
            "fsurf" => "@(x, y) x*y, [-1 1]",
            "implicitplot3d" => "x*y, x = -1..1, y = -1..1, z = -1..1",
            "implicit" => "x*y, x, -1, 1, y, -1, 1, z, -1, 1",
            r"\implicitPlot3d" => "x*y, -1, 1, -1, 1, -1, 1",
            _ if HEIGHTS.contains(&command) => "x*y, (x, -1, 1), (y, -1, 1)",
            _ => "x*y, (x, -1, 1), (y, -1, 1), (z, -1, 1)",
        }
    }

    /// The parts of the plot `text` that a note calls left out; empty without such a note.
    fn left(text: &str) -> String {
        let program = program(text, &Limits::default(), false);
        let program = program.unwrap_or_else(|error| panic!("{text}: {error:?}"));
        let left = program.notes.into_iter().filter_map(|note| match note.kind {
            NoteKind::PlotPartsLeftOut { left } => Some(left),
            _ => None,
        });
        left.collect::<Vec<_>>().join(", ")
    }

    #[test]
    fn every_command_says_what_it_does_not_use() {
        let lists = [plot_commands::HEIGHTS, SURFACES, curve_commands::COMMANDS];
        for command in lists.into_iter().flatten() {
            let place = if METHODS.contains(command) { "grid." } else { "" };
            let given = needed(command);
            let text = format!("{place}{command}({given})");
            assert_eq!(left(&text), "", "{text}");
            for extra in ["zork=7", "Zork->7", "zork->{7, 8}", "'zork'", "[7, 8, 9]", "zork"] {
                let text = format!("{place}{command}({given}, {extra})");
                assert_eq!(left(&text), format!("`{extra}`"), "{text}");
            }
        }
    }
}
