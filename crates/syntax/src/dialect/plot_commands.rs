//! Reads plot commands of other systems: the formulas to draw, and the ranges of the coordinates.
//!
//! The ranges become a `domain` line. The spans of its tokens are those of the ranges in the text.

use crate::dialect::program_words::Words;
use crate::lex::spelling::plain_name;
use crate::lex::token::{Token, bracketed, closing, in_brackets, outside, span_of, split};
use crate::lex::token_kind::TokenKind::{self, *};
use crate::messages::error::{Error, ErrorKind, Fallible};
use crate::messages::note::{Note, NoteKind};
use crate::span::Span;

/// Returns whether a command plots heights; `None` if the word is not a plot command.
fn plots_height(command: &str) -> Option<bool> {
    match command {
        "Plot3D" | "plot3d" | "explicit" | "fsurf" | "ezsurf" | "surf" => Some(true),
        "ContourPlot3D" | "RegionPlot3D" | "ImplicitRegion" | "implicit_plot3d"
        | "implicitplot3d" | "ImplicitPlot3D" | "fimplicit3" | "ezimplot3" | "isosurface"
        | "implicit" | "plot_implicit" | "draw3d" => Some(false),
        _ => None,
    }
}

/// Plot commands that may stand inside the brackets of another plot command.
const INNER: &[&str] = &["implicit", "explicit"];

/// Names that the ends of a range may contain. If another name occurs, all ranges are ignored.
const CONSTANTS: &[&str] = &["pi", "tau", "e", "phi", "sqrt"];

/// Longest domain that a note quotes, in bytes.
const MAX_NOTED_DOMAIN: usize = 120;

/// The parts of a plot command.
pub(crate) struct Plot {
    pub formulas: Vec<Vec<Token>>,
    /// True if the formulas are heights over x and y.
    pub is_height: bool,
    /// A `domain` line with the ranges; `None` if the command has no readable ranges.
    pub domain: Option<Vec<Token>>,
    /// A note that states the ranges, or that they were not read.
    pub note: Option<Note>,
}

const AXES: [TokenKind; 3] = [X, Y, Z];

/// The range of a coordinate.
struct PlotRange {
    axis: TokenKind,
    low: Vec<Token>,
    high: Vec<Token>,
}

impl Words<'_> {
    /// Reads a plot command; `None` if `tokens` are no plot command.
    pub(crate) fn plot(self, tokens: &[Token]) -> Fallible<Option<Plot>> {
        // Maple also writes `plots[implicitplot3d](…)` for `implicitplot3d(…)`.
        if let [plots, open, command, close, rest @ ..] = tokens
            && self.word(*plots) == "plots"
            && (open.kind, close.kind) == (OpenBracket, CloseBracket)
        {
            return self.plot_of(self.word(*command), rest);
        }
        let Some(first) = tokens.first() else { return Ok(None) };
        if self.word(*first) == "isosurface" && tokens.get(1).is_some_and(|t| t.kind == OpenBrace) {
            return Ok(self.isosurface(&tokens[1..], first.span));
        }
        self.plot_of(self.word(*first), &tokens[1..])
    }

    /// Reads the plot command `word`. `tokens` begin with its brackets.
    fn plot_of(self, word: &str, tokens: &[Token]) -> Fallible<Option<Plot>> {
        let (Some((inner, rest)), Some(is_height)) = (bracketed(tokens), plots_height(word)) else {
            return Ok(None);
        };
        if !rest.iter().all(|token| matches!(token.kind, Colon | Unknown)) {
            return Ok(None);
        }
        let place = tokens[0].span;
        let arguments = split(inner, Comma);
        let is_inner = |part: &&Vec<Token>| INNER.contains(&self.word(part[0]));
        if let Some(part) = arguments.iter().find(is_inner)
            && let Some(plot) = self.plot_of(self.word(part[0]), &part[1..])?
        {
            return Ok(Some(plot));
        }
        if let Some(system) = arguments.iter().find(|part| self.word(part[0]) == "coords") {
            let span = system[0].span.to(system[system.len() - 1].span);
            return Err(Error::new(span, ErrorKind::PlotCoordinates));
        }
        // In MATLAB's `isosurface(x, y, z, v, 0.1)`, `v` is the formula and 0.1 is the level.
        let (formula, level) = match arguments.as_slice() {
            [x, y, z, values, rest @ ..]
                if word == "isosurface" && [x, y, z].iter().all(|part| part.len() == 1) =>
            {
                (values, rest.first().cloned())
            }
            [formula, ..] => (formula, self.level(&arguments)),
            [] => return Ok(None),
        };
        let ranges = self.ranges(&arguments);
        let (domain, note) = self.domain(&ranges, place);
        let mut formulas = Self::listed(formula);
        for formula in &mut formulas {
            if let Some(level) = level.clone().filter(|_| outside(formula, Equals).is_none()) {
                *formula = less(formula, &level);
            }
            // A function name alone is no formula. That function is drawn if nothing else is.
            if matches!(formula.as_slice(), [name] if name.kind == TokenKind::Name) {
                formula.clear();
            }
        }
        Ok(Some(Plot { formulas, is_height, domain, note }))
    }

    /// Reads POV-Ray's `isosurface { function { … } threshold 1 contained_by { … } }`. `tokens`
    /// begin after the word `isosurface`.
    fn isosurface(self, tokens: &[Token], place: Span) -> Option<Plot> {
        let (inner, _) = bracketed(tokens)?;
        let behind = |word: &str| {
            let at = inner.iter().position(|token| self.word(*token) == word)?;
            Some(&inner[at + 1..])
        };
        let mut rest = behind("function")?;
        if rest.first()?.kind == OpenParen {
            rest = bracketed(rest)?.1;
        }
        let (body, _) = bracketed(rest)?;
        let is_sign = |token: &&Token| matches!(token.kind, Number | Minus);
        let level: Vec<Token> =
            behind("threshold").unwrap_or_default().iter().take_while(is_sign).copied().collect();
        let body = if level.is_empty() { body.to_vec() } else { less(body, &level) };
        let (domain, note) = match behind("contained_by") {
            None => (None, None),
            Some(container) => match self.contained(container) {
                Some(ranges) => self.domain(&ranges, place),
                None => (None, Some(Note { span: place, kind: NoteKind::ContainerIgnored })),
            },
        };
        Some(Plot { formulas: vec![body], is_height: false, domain, note })
    }

    /// The ranges of `{ box { -2, 2 } }` and `{ box { <-2, -2, -1>, <2, 2, 1> } }`.
    fn contained(self, tokens: &[Token]) -> Option<Vec<PlotRange>> {
        let (inner, _) = bracketed(tokens)?;
        let (ends, _) = bracketed(inner.get(1..)?).filter(|_| self.word(inner[0]) == "box")?;
        let mut ends = split(ends, Comma);
        // The lexer reads the `<` and `>` around a corner as relations. They are dropped.
        for end in &mut ends {
            end.retain(|token| !matches!(token.kind, Less | Greater));
        }
        if ends.iter().any(Vec::is_empty) || !matches!(ends.len(), 2 | 6) {
            return None;
        }
        let half = ends.len() / 2;
        let range = |(index, axis): (usize, TokenKind)| {
            let index = index.min(half - 1);
            PlotRange { axis, low: ends[index].clone(), high: ends[index + half].clone() }
        };
        Some(AXES.into_iter().enumerate().map(range).collect())
    }

    /// Splits a list into its formulas. Removes the parameters from a formula such as `@(x, y) x`.
    fn listed(formula: &[Token]) -> Vec<Vec<Token>> {
        if formula[0].kind == At
            && let Some((_, body)) = bracketed(&formula[1..])
        {
            return vec![body.to_vec()];
        }
        let is_list = matches!(formula[0].kind, OpenBrace | OpenBracket);
        let is_whole = closing(formula).is_some_and(|end| end + 1 == formula.len());
        if let Some((inner, _)) = bracketed(formula).filter(|_| is_list && is_whole) {
            return split(inner, Comma);
        }
        vec![formula.to_vec()]
    }

    /// The level in an argument such as `Contours -> {1}`.
    fn level(self, arguments: &[Vec<Token>]) -> Option<Vec<Token>> {
        arguments.iter().find_map(|part| match part.as_slice() {
            [name, minus, arrow, value @ ..]
                if self.word(*name) == "Contours"
                    && minus.kind == Minus
                    && arrow.kind == Greater =>
            {
                let inner = bracketed(value).map_or(value, |(inner, _)| inner);
                (!inner.iter().any(|token| token.kind == Comma)).then(|| inner.to_vec())
            }
            _ => None,
        })
    }

    /// The ranges in arguments such as `{x, -2, 2}`, `x = -2..2`, `x, -2, 2` and `[-2 2 -1 1]`.
    fn ranges(self, arguments: &[Vec<Token>]) -> Vec<PlotRange> {
        let axis = |part: &[Token]| match part {
            [only] if only.kind.is_axis() => Some(only.kind),
            _ => None,
        };
        let mut ranges = Vec::new();
        for part in arguments {
            if matches!(part[0].kind, OpenBrace | OpenParen | OpenBracket)
                && let Some((inner, _)) = bracketed(part)
            {
                let parts = split(inner, Comma);
                if let Ok([name, low, high]) = <[_; 3]>::try_from(parts) {
                    let axis = axis(&name);
                    ranges.extend(axis.map(|axis| PlotRange { axis, low, high }));
                } else if let Some(numbers) = self.numbers(inner) {
                    ranges.extend(in_order(&numbers));
                }
            } else if let [name, equals, ends @ ..] = part.as_slice()
                && equals.kind == Equals
                && let (Some(axis), Some(dots)) = (axis(&[*name]), outside(ends, Dots))
            {
                let (low, high) = (ends[..dots].to_vec(), ends[dots + 1..].to_vec());
                ranges.push(PlotRange { axis, low, high });
            }
        }
        for parts in arguments.windows(3).skip(1) {
            if let Some(axis) = axis(&parts[0]) {
                let (low, high) = (parts[1].clone(), parts[2].clone());
                ranges.push(PlotRange { axis, low, high });
            }
        }
        ranges.retain(|range| !range.low.is_empty() && !range.high.is_empty());
        ranges
    }

    /// The 2, 4 or 6 numbers of a MATLAB row, separated by blanks or commas; otherwise `None`.
    fn numbers(self, row: &[Token]) -> Option<Vec<Vec<Token>>> {
        let mut numbers: Vec<Vec<Token>> = Vec::new();
        let mut sign = None;
        for token in row {
            match token.kind {
                Minus if sign.is_none() => sign = Some(*token),
                Number => numbers.push(sign.take().into_iter().chain([*token]).collect()),
                TokenKind::Name if plain_name(self.word(*token)) == "pi" => {
                    numbers.push(sign.take().into_iter().chain([*token]).collect());
                }
                Comma => {}
                _ => return None,
            }
        }
        (sign.is_none() && matches!(numbers.len(), 2 | 4 | 6)).then_some(numbers)
    }

    /// A `domain` line for the ranges, and a note that states whether the ranges were read.
    fn domain(self, ranges: &[PlotRange], place: Span) -> (Option<Vec<Token>>, Option<Note>) {
        let Some(first) = ranges.first() else { return (None, None) };
        let typed = |tokens: &[Token]| span_of(tokens).map_or("", |span| &self.text[span.range()]);
        let at = Span::at(first.low[0].span.start);
        let is_known = |token: &Token| {
            let name = plain_name(self.word(*token)).to_lowercase();
            !matches!(token.kind, X | Y | Z | TokenKind::Name) || CONSTANTS.contains(&name.as_str())
        };
        let ends = || ranges.iter().flat_map(|range| range.low.iter().chain(&range.high));
        let mut axes: Vec<TokenKind> = ranges.iter().map(|range| range.axis).collect();
        axes.sort_unstable_by_key(|axis| axis.as_char());
        axes.dedup();
        let line = ranges
            .iter()
            .map(|r| format!("{} in [{}, {}]", r.axis.as_char(), typed(&r.low), typed(&r.high)))
            .collect::<Vec<_>>()
            .join(", ");
        if !ends().all(is_known) || axes.len() < ranges.len() {
            let note = Note { span: place, kind: NoteKind::PlotWithoutRanges };
            return (None, Some(note));
        }
        let sign = |kind: TokenKind, at: usize| Token::new(kind, Span::at(at));
        let mut tokens = vec![Token::new(DomainWord, at)];
        for (index, PlotRange { axis, low, high }) in ranges.iter().enumerate() {
            let (start, end) = (low[0].span.start, high[high.len() - 1].span.end);
            if index > 0 {
                tokens.push(sign(Comma, start));
            }
            tokens.extend([sign(*axis, start), sign(In, start), sign(OpenBracket, start)]);
            tokens.extend(low);
            tokens.push(sign(Comma, high[0].span.start));
            tokens.extend(high);
            tokens.push(sign(CloseBracket, end));
        }
        let domain = if line.len() > MAX_NOTED_DOMAIN { "…".to_owned() } else { line };
        (Some(tokens), Some(Note { span: place, kind: NoteKind::PlotDomain { domain } }))
    }
}

/// Makes ranges of x, y and z, in this order, from pairs of numbers. One pair serves all axes.
fn in_order(numbers: &[Vec<Token>]) -> Vec<PlotRange> {
    let pair = |axis, at: usize| PlotRange {
        axis,
        low: numbers[at % numbers.len()].clone(),
        high: numbers[(at + 1) % numbers.len()].clone(),
    };
    let count = if numbers.len() == 2 { 3 } else { numbers.len() / 2 };
    AXES.into_iter().take(count).enumerate().map(|(index, axis)| pair(axis, 2 * index)).collect()
}

/// The tokens of `(formula) - (level)`.
fn less(formula: &[Token], level: &[Token]) -> Vec<Token> {
    let mut all = in_brackets(formula);
    let end = all[all.len() - 1].span;
    all.push(Token::new(Minus, end));
    all.extend(in_brackets(level));
    all
}
