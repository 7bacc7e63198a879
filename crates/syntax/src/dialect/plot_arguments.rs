//! Reads the arguments of plot commands: ranges with their names, levels, regions, other options.

use crate::dialect::program_words::Words;
use crate::lex::spelling::plain_name;
use crate::lex::token::{Token, bracketed, outside, span_of, split};
use crate::lex::token_kind::TokenKind::{self, *};
use crate::messages::error::{Error, ErrorKind, Fallible};

/// Options that give the value of the function on the surface.
const LEVELS: &[&str] = &["Contours", "contour", "isovalue", "level", "isomin"];

/// Options that restrict the surface by a condition.
const REGIONS: &[&str] = &["RegionFunction", "region"];

/// Options that change the surface and cannot be read.
const CHANGES: &[&str] =
    &["ScalingFunctions", "transformation", "TransformationFunction", "contours", "isomax"];

/// The range of a variable.
pub(crate) struct PlotRange {
    /// The variable; `None` if the order of the ranges decides.
    pub name: Option<Token>,
    pub low: Vec<Token>,
    pub high: Vec<Token>,
}

impl Words<'_> {
    /// The value of the option that is called one of `names`, as in `contour=4`, with its name.
    fn option(self, arguments: &[Vec<Token>], names: &[&str]) -> Option<(Token, Vec<Token>)> {
        arguments.iter().find_map(|part| {
            let (name, rest) = part.split_first()?;
            let value = match rest {
                [equals, value @ ..] if equals.kind == Equals => value,
                [minus, arrow, value @ ..] if minus.kind == Minus && arrow.kind == Greater => value,
                _ => return None,
            };
            names.contains(&self.word(*name)).then(|| (*name, value.to_vec()))
        })
    }

    /// The error for an option that cannot be read.
    fn refused_option(self, name: Token) -> Box<Error> {
        Error::new(name.span, ErrorKind::PlotOption { name: self.word(name).to_owned() })
    }

    /// The levels in an option such as `Contours -> {1}`. Fails if an option changes the surface
    /// and cannot be read.
    pub(crate) fn levels(self, arguments: &[Vec<Token>]) -> Fallible<Vec<Vec<Token>>> {
        if let Some((name, _)) = self.option(arguments, CHANGES) {
            return Err(self.refused_option(name));
        }
        let Some((name, value)) = self.option(arguments, LEVELS) else { return Ok(Vec::new()) };
        let is_list = value.first().is_some_and(|first| first.kind != OpenParen);
        match bracketed(&value).filter(|(_, rest)| is_list && rest.is_empty()) {
            Some((inner, _)) => Ok(split(inner, Comma)),
            // In Mathematica, a number without braces is the number of levels.
            None if self.word(name) == "Contours" => Err(self.refused_option(name)),
            None => Ok(vec![value]),
        }
    }

    /// The condition in an option such as `RegionFunction -> Function[{x, y, z}, x > 0]`, with the
    /// names of its parameters.
    pub(crate) fn region(
        self,
        arguments: &[Vec<Token>],
    ) -> Fallible<Option<(Vec<Token>, Vec<Token>)>> {
        let Some((name, value)) = self.option(arguments, REGIONS) else { return Ok(None) };
        let Some((None, parameters, condition)) = self.lambda(&value) else {
            return Err(self.refused_option(name));
        };
        let names = parameters.iter().filter_map(|part| part.first()).copied().collect();
        Ok(Some((names, condition)))
    }

    /// The ranges in arguments after the formula, such as `{x, -2, 2}`, `x = -2..2`, `x, -2, 2` and
    /// `[-2 2 -1 1]`.
    pub(crate) fn ranges(self, arguments: &[Vec<Token>]) -> Vec<PlotRange> {
        let variable = |part: &[Token]| match part {
            [only] if only.kind.is_name() => Some(*only),
            _ => None,
        };
        let mut ranges = Vec::new();
        for part in arguments {
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
            }
        }
        for parts in arguments.windows(3) {
            if let Some(name) = variable(&parts[0]).filter(|name| name.kind.is_axis()) {
                let (low, high) = (parts[1].clone(), parts[2].clone());
                ranges.push(PlotRange { name: Some(name), low, high });
            }
        }
        // MathPartner writes the ends of all ranges as arguments.
        let is_number = |token: &Token| matches!(token.kind, Number | Minus);
        if let Some(ends) = arguments.get(..6)
            && ranges.is_empty()
            && ends.iter().flatten().all(is_number)
        {
            ranges = in_order(ends);
        }
        ranges.retain(|range| !range.low.is_empty() && !range.high.is_empty());
        ranges
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

/// Makes ranges in order from pairs of values. One pair serves all coordinates.
pub(crate) fn in_order(numbers: &[Vec<Token>]) -> Vec<PlotRange> {
    let count = if numbers.len() == 2 { 3 } else { numbers.len() / 2 };
    let end = |at: usize| numbers[at % numbers.len()].clone();
    let range =
        |index: usize| PlotRange { name: None, low: end(2 * index), high: end(2 * index + 1) };
    (0..count).map(range).collect()
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
