//! Reads plot commands of other systems: the formulas to draw, and the ranges of the coordinates.
//!
//! The ranges become a `domain` line. The spans of its tokens are those of the ranges in the text.

use crate::dialect::plot_arguments::{PlotRange, axes_of};
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
        "Plot3D" | "plot3d" | "explicit" | "fsurf" | "ezsurf" | "surf" | "mesh" | "surface"
        | "surfc" | "meshc" | "plot_surface" => Some(true),
        "ContourPlot3D" | "RegionPlot3D" | "ImplicitRegion" | "implicit_plot3d"
        | "implicitplot3d" | r"\implicitPlot3d" | "ImplicitPlot3D" | "fimplicit3" | "ezimplot3"
        | "isosurface" | "implicit" | "plot_implicit" | "draw3d" | "draw" | "display" | "Show"
        | "contour3" | "implicitsurface" | "contour" | "marching_cubes" | "surfaceNets" => {
            Some(false)
        }
        _ => None,
    }
}

/// Commands that only contain other plots.
const CONTAINERS: &[&str] = &["draw3d", "display", "Show"];

/// Plot commands that follow a module or an object and a dot.
const METHODS: &[&str] = &["contour", "marching_cubes", "surfaceNets", "plot_surface"];

/// Commands whose third argument holds the heights over a grid.
const GRIDS: &[&str] = &["surf", "mesh", "surface", "surfc", "meshc", "plot_surface"];

/// Words after a formula of gnuplot.
const SPLOT_WORDS: &[&str] =
    &["with", "w", "using", "u", "title", "t", "notitle", "lw", "lt", "lc"];

/// Names that the ends of a range may contain. If another name occurs, all ranges are ignored.
const CONSTANTS: &[&str] = &["pi", "tau", "e", "phi", "sqrt"];

/// Largest number of levels, and of formulas with a condition, because each gets a copy.
const MAX_FORMULAS: usize = 20;

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
    /// Names of the formulas that stand for coordinates.
    pub renamed: Vec<(Token, TokenKind)>,
}

const AXES: [TokenKind; 3] = [X, Y, Z];

impl Words<'_> {
    /// Reads a plot command; no plot if `tokens` are no plot command.
    pub(crate) fn plots(self, tokens: &[Token]) -> Fallible<Vec<Plot>> {
        let is_name = |token: &Token| token.kind.is_name() || token.kind == Comma;
        let types = self.types(tokens);
        let tokens = &tokens[types..];
        // The left side of `plot = ContourPlot3D[…]`, which only names the picture.
        let left = tokens.iter().take_while(|token| is_name(token)).count();
        let tokens = match &tokens[left..] {
            [equals, rest @ ..] if equals.kind == Equals && left > 0 => rest,
            _ => tokens,
        };
        let tokens = match tokens {
            // Maple also writes `plots[implicitplot3d](…)` for `implicitplot3d(…)`.
            [plots, open, command, close, rest @ ..]
                if self.word(*plots) == "plots"
                    && (open.kind, close.kind) == (OpenBracket, CloseBracket) =>
            {
                return self.plots_of(self.word(*command), rest);
            }
            [plots, colon, minus, rest @ ..]
                if self.word(*plots) == "plots" && (colon.kind, minus.kind) == (Colon, Minus) =>
            {
                rest
            }
            // A method of a module, as in `grid.contour(…)`.
            [module, dot, command, rest @ ..]
                if module.kind.is_name()
                    && self.is_dot(*dot)
                    && METHODS.contains(&self.word(*command)) =>
            {
                return self.plots_of(self.word(*command), rest);
            }
            _ => tokens,
        };
        let Some(first) = tokens.first() else { return Ok(Vec::new()) };
        let word = self.word(*first);
        if word == "isosurface" && tokens.get(1).is_some_and(|t| t.kind == OpenBrace) {
            return Ok(self.isosurface(&tokens[1..], first.span).into_iter().collect());
        }
        if word == "splot" {
            return Ok(vec![self.splot(&tokens[1..], first.span)]);
        }
        if word == "contour" { Ok(Vec::new()) } else { self.plots_of(word, &tokens[1..]) }
    }

    /// Returns whether a token is the dot before a method.
    pub(crate) fn is_dot(self, token: Token) -> bool {
        token.kind == Unknown && &self.text[token.span.range()] == "."
    }

    /// Reads the plot command `word`. `tokens` begin with its brackets.
    fn plots_of(self, word: &str, tokens: &[Token]) -> Fallible<Vec<Plot>> {
        let (Some((inner, rest)), Some(is_height)) = (bracketed(tokens), plots_height(word)) else {
            return Ok(Vec::new());
        };
        let is_end = |token: &Token| matches!(token.kind, Colon | Unknown);
        if !rest.iter().all(is_end) && !self.is_style_tail(rest) {
            return Ok(Vec::new());
        }
        let place = tokens[0].span;
        let mut arguments = split(inner, Comma);
        // The parameters of `lambda x, y: …` were split too.
        let colon = |part: &Vec<Token>| outside(part, Colon).is_some();
        if let Some(at) = arguments.iter().position(|part| self.has(part, "lambda"))
            && let Some(more) = arguments[at..].iter().position(colon)
        {
            let rest: Vec<Vec<Token>> = arguments.drain(at + 1..=at + more).collect();
            for next in rest {
                arguments[at].extend(std::iter::once(Token::new(Comma, next[0].span)).chain(next));
            }
        }
        let mut plots = Vec::new();
        for part in arguments.iter().filter(|part| plots_height(self.word(part[0])).is_some()) {
            plots.extend(self.plots_of(self.word(part[0]), &part[1..])?);
        }
        if !plots.is_empty() || CONTAINERS.contains(&word) {
            return Ok(plots);
        }
        if let Some(system) = arguments.iter().find(|part| self.word(part[0]) == "coords") {
            let span = system[0].span.to(system[system.len() - 1].span);
            return Err(Error::new(span, ErrorKind::PlotCoordinates));
        }
        let mut levels = self.levels(&arguments)?;
        let Some(formula) = self.formula(word, &arguments, &mut levels)? else {
            return Ok(Vec::new());
        };
        let mut ranges = self.ranges(&arguments[1..]);
        if is_height {
            ranges.truncate(if ranges.iter().all(|range| range.name.is_none()) { 2 } else { 4 });
        }
        let names: Vec<Option<Token>> = ranges.iter().map(|range| range.name).collect();
        let axes = axes_of(&names, is_height)?;
        let (domain, note) = self.domain(&ranges, &axes, place);
        let (parameters, formula) = match self.lambda(&formula) {
            Some((None, parameters, value)) => {
                (parameters.iter().filter_map(|part| part.first()).copied().collect(), value)
            }
            _ => (Vec::new(), formula),
        };
        let formula = self.returned(formula)?;
        let region = self.region(&arguments)?;
        let mut renamed = renamed(&names, &axes);
        for names in [&parameters, region.as_ref().map_or(&Vec::new(), |(names, _)| names)] {
            // An unused parameter stands for nothing, also outside of the function.
            let condition = region.iter().flat_map(|(_, condition)| condition);
            let used: Vec<&str> =
                formula.iter().chain(condition).map(|token| self.word(*token)).collect();
            let all = renamed_all(names, is_height)?.into_iter();
            renamed.extend(all.filter(|(name, _)| used.contains(&self.word(*name))));
        }
        let mut formulas = Vec::new();
        for formula in Some(formula).filter(|f| !f.is_empty()).iter().flat_map(|f| Self::listed(f))
        {
            let is_equation = outside(&formula, Equals).is_some();
            let are_many = levels.len().max(formulas.len()) > MAX_FORMULAS;
            if !levels.is_empty() && (is_equation || are_many) {
                let kind = ErrorKind::PlotOption { name: "contour".to_owned() };
                return Err(Error::new(formula[0].span, kind));
            }
            formulas.extend(levels.iter().map(|level| less(&formula, level)));
            formulas.extend(levels.is_empty().then_some(formula));
        }
        if formulas.len() > MAX_FORMULAS && region.is_some() {
            let kind = ErrorKind::PlotOption { name: "RegionFunction".to_owned() };
            return Err(Error::new(place, kind));
        }
        if let Some((_, condition)) = &region {
            let end = Span::at(condition.last().map_or(place.start, |last| last.span.end));
            for formula in &mut formulas {
                formula.push(Token::new(OpenBrace, end));
                formula.extend(condition);
                formula.push(Token::new(CloseBrace, end));
            }
        }
        Ok(vec![Plot { formulas, is_height, domain, note, renamed }])
    }

    /// The formula among the arguments of the plot command `word`; `None` without arguments. It is
    /// empty if the command draws the last value of the program. Adds levels to `levels`.
    fn formula(
        self,
        word: &str,
        arguments: &[Vec<Token>],
        levels: &mut Vec<Vec<Token>>,
    ) -> Fallible<Option<Vec<Token>>> {
        let is_function = |part: &Vec<Token>| part.len() == 1 && part[0].kind == TokenKind::Name;
        let are_three = arguments.len() > 2 && arguments[..3].iter().all(is_function);
        let is_tuple = |part: &Vec<Token>| {
            matches!(part[0].kind, OpenBracket | OpenParen)
                && bracketed(part)
                    .is_some_and(|(inner, rest)| rest.is_empty() && split(inner, Comma).len() == 3)
        };
        if matches!(word, "fsurf" | "ezsurf") && are_three
            || word == "plot3d" && arguments.first().is_some_and(is_tuple)
        {
            return Err(Error::new(arguments[0][0].span, ErrorKind::Parametric));
        }
        let lambda =
            |part: &&Vec<Token>| self.lambda(part).is_some_and(|(name, ..)| name.is_none());
        let formula = match arguments {
            _ if let Some(lambda) = arguments.iter().find(lambda) => lambda,
            // In MATLAB's `isosurface(x, y, z, v, 0.1)`, `v` is the formula and 0.1 is the level.
            [x, y, z, values, rest @ ..]
                if word == "isosurface" && [x, y, z].iter().all(|part| part.len() == 1) =>
            {
                levels.extend(rest.first().cloned());
                values
            }
            // In MATLAB's `surf(X, Y, Z)`, the heights come third.
            [_, _, heights, ..] if GRIDS.contains(&word) => heights,
            [list, formula, ..]
                if word == "contour"
                    && list[0].kind == OpenBracket
                    && outside(formula, Equals).is_none() =>
            {
                *levels = bracketed(list).map_or(Vec::new(), |(inner, _)| split(inner, Comma));
                formula
            }
            [formula, level, ..]
                if word == "marching_cubes" && outside(level, Equals).is_none() =>
            {
                *levels = vec![level.clone()];
                formula
            }
            [formula, ..] if word != "contour" => formula,
            // PyVista's `grid.contour([0])` draws the values that the program assigned last.
            [list, ..] => {
                let is_zero = |token: &Token| {
                    let typed = &self.text[token.span.range()];
                    token.kind != Number || typed.bytes().all(|byte| matches!(byte, b'0' | b'.'))
                };
                if !list.iter().all(is_zero) {
                    let kind = ErrorKind::PlotOption { name: word.to_owned() };
                    return Err(Error::new(list[0].span, kind));
                }
                return Ok(Some(Vec::new()));
            }
            [] => return Ok(None),
        };
        Ok(Some(match formula.as_slice() {
            // A function of all points of a grid, as in `f(*grid)`.
            [name, open, star, ..] if (open.kind, star.kind) == (OpenParen, Star) => vec![*name],
            _ => formula.clone(),
        }))
    }

    /// The value of a function's body, which may be `{ return value; }`.
    fn returned(self, body: Vec<Token>) -> Fallible<Vec<Token>> {
        let is_return = |token: &Token| self.word(*token) == "return";
        let Some(at) = body.iter().position(is_return) else { return Ok(body) };
        let inner = bracketed(&body).filter(|(inner, rest)| {
            at == 1 && rest.is_empty() && inner.iter().filter(|token| is_return(token)).count() == 1
        });
        let Some((inner, _)) = inner else { return Err(self.unsupported(body[at])) };
        let end = outside(inner, Semicolon).unwrap_or(inner.len());
        Ok(inner[1..end].to_vec())
    }

    /// Reads gnuplot's `splot [-2:2][-2:2] f with lines`. `tokens` begin after the word `splot`.
    fn splot(self, tokens: &[Token], place: Span) -> Plot {
        let mut rest = tokens;
        let mut ranges = Vec::new();
        while let Some((inner, more)) = bracketed(rest).filter(|_| rest[0].kind == OpenBracket) {
            if let Ok([low, high]) = <[_; 2]>::try_from(split(inner, Colon)) {
                ranges.push(PlotRange { name: None, low, high });
            }
            rest = more;
        }
        // A third range only cuts the picture.
        ranges.truncate(2);
        let (domain, note) = self.domain(&ranges, &AXES[..ranges.len()], place);
        let mut formulas = Vec::new();
        for part in split(rest, Comma) {
            let ends = |token: &Token| SPLOT_WORDS.contains(&self.word(*token));
            let count = part.iter().position(ends).unwrap_or(part.len());
            let columns = split(&part[count..], Colon);
            match (&part[..count], columns.get(2)) {
                // The third column of `'++' using 1:2:(f)` is the height.
                ([text], Some(height)) if text.kind == Unknown => {
                    formulas.extend(bracketed(height).map(|(inner, _)| inner.to_vec()));
                }
                (formula, _) => formulas.push(formula.to_vec()),
            }
        }
        Plot { formulas, is_height: true, domain, note, renamed: Vec::new() }
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
        let is_sign = |token: &&Token| token.kind == Number || token.kind.is_arithmetic();
        let level: Vec<Token> =
            behind("threshold").unwrap_or_default().iter().take_while(is_sign).copied().collect();
        let body = if level.is_empty() { body.to_vec() } else { less(body, &level) };
        let (domain, note) = match behind("contained_by") {
            None => (None, None),
            Some(container) => match self.contained(container) {
                Some(ranges) => self.domain(&ranges, &AXES, place),
                None => (None, Some(Note { span: place, kind: NoteKind::ContainerIgnored })),
            },
        };
        Some(Plot { formulas: vec![body], is_height: false, domain, note, renamed: Vec::new() })
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
        let range = |index: usize| {
            let index = index.min(half - 1);
            PlotRange { name: None, low: ends[index].clone(), high: ends[index + half].clone() }
        };
        Some((0..AXES.len()).map(range).collect())
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

    /// A `domain` line for the ranges, and a note that states whether the ranges were read.
    pub(crate) fn domain(
        self,
        ranges: &[PlotRange],
        axes: &[TokenKind],
        place: Span,
    ) -> (Option<Vec<Token>>, Option<Note>) {
        let Some(first) = ranges.first() else { return (None, None) };
        let typed = |tokens: &[Token]| span_of(tokens).map_or("", |span| &self.text[span.range()]);
        let at = Span::at(first.low[0].span.start);
        let is_known = |token: &Token| {
            let name = plain_name(self.word(*token)).to_lowercase();
            !matches!(token.kind, X | Y | Z | TokenKind::Name) || CONSTANTS.contains(&name.as_str())
        };
        let ends = || ranges.iter().flat_map(|range| range.low.iter().chain(&range.high));
        let line = ranges
            .iter()
            .zip(axes)
            .map(|(r, axis)| {
                format!("{} in [{}, {}]", axis.as_char(), typed(&r.low), typed(&r.high))
            })
            .collect::<Vec<_>>()
            .join(", ");
        if !ends().all(is_known) {
            let note = Note { span: place, kind: NoteKind::PlotWithoutRanges };
            return (None, Some(note));
        }
        let sign = |kind: TokenKind, at: usize| Token::new(kind, Span::at(at));
        let mut tokens = vec![Token::new(DomainWord, at)];
        let mut ordered: Vec<_> = axes.iter().zip(ranges).collect();
        ordered.sort_by_key(|(axis, _)| axis.as_char());
        for (index, (axis, PlotRange { low, high, .. })) in ordered.into_iter().enumerate() {
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

/// The tokens of `(formula) - (level)`.
pub(crate) fn less(formula: &[Token], level: &[Token]) -> Vec<Token> {
    let mut all = in_brackets(formula);
    let end = all[all.len() - 1].span;
    all.push(Token::new(Minus, end));
    all.extend(in_brackets(level));
    all
}

/// The names that are not their axes.
fn renamed(names: &[Option<Token>], axes: &[TokenKind]) -> Vec<(Token, TokenKind)> {
    let pairs = names.iter().zip(axes).filter_map(|(name, axis)| Some(((*name)?, *axis)));
    pairs.filter(|(name, axis)| name.kind != *axis).collect()
}

/// The parameters of a function that are not their axes. Fails if a parameter is another coordinate
/// than the one at its place.
fn renamed_all(names: &[Token], is_height: bool) -> Fallible<Vec<(Token, TokenKind)>> {
    let count = if is_height { 2 } else { 3 };
    let axes = AXES.into_iter().take(count);
    let wrong = names
        .iter()
        .zip(axes.clone())
        .find(|(name, axis)| name.kind.is_axis() && name.kind != *axis);
    if let Some(name) = wrong.map(|(name, _)| name).or(names.get(count)) {
        return Err(Error::new(name.span, ErrorKind::PlotVariables));
    }
    Ok(names.iter().copied().zip(axes).filter(|(name, axis)| name.kind != *axis).collect())
}
