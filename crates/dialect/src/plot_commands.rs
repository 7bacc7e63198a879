//! Reads plot commands of other systems: the formulas to draw, and the ranges of the coordinates.
//!
//! The ranges become a `domain` line. The spans of its tokens are those of the ranges in the text.

use crate::plot_arguments::{Arguments, PlotRange, axes_of};
use crate::program_words::Words;
use zeroset_parser::lex::spelling::plain_name;
use zeroset_parser::lex::token::{Token, bracketed, closing, in_brackets, outside, span_of, split};
use zeroset_parser::lex::token_kind::TokenKind::{self, *};
use zeroset_parser::{Error, ErrorKind, Fallible, Note, NoteKind, Span};

/// Commands that plot heights over x and y.
#[rustfmt::skip] // several words a line
pub(crate) const HEIGHTS: &[&str] = &[
    "Plot3D", "plot3d", "explicit", "fsurf", "ezsurf", "surf", "mesh", "surface", "surfc", "meshc",
    "plot_surface", "curve3d",
];

/// Commands that plot a surface in space, and containers of plots.
#[rustfmt::skip] // several words a line
pub(crate) const SURFACES: &[&str] = &[
    "ContourPlot3D", "RegionPlot3D", "ContourPlot", "RegionPlot", "fimplicit", "implicitplot",
    "implicit_plot", "ImplicitRegion", "implicit_plot3d", "implicitplot3d", r"\implicitPlot3d",
    "ImplicitPlot3D", "fimplicit3", "ezimplot3", "isosurface", "implicit", "plot_implicit",
    "draw3d", "draw", "display", "Show", "show", "GraphicsRow", "GraphicsColumn", "GraphicsGrid",
    "contour3", "implicitsurface", "contour", "marching_cubes", "surfaceNets", "patch", "ezplot",
    "InequalityPlot3D", "Implicit3d", "contour3d",
];

/// Commands of [`SURFACES`] that plot in the plane of x and y.
const FLAT: &[&str] =
    &["fimplicit", "ContourPlot", "RegionPlot", "implicitplot", "implicit_plot", "ezplot"];

/// Returns whether a command plots heights; `None` if the word is not a plot command.
fn plots_height(command: &str) -> Option<bool> {
    let is_height = HEIGHTS.contains(&command);
    (is_height || SURFACES.contains(&command)).then_some(is_height)
}

/// Returns whether `word` is a plot command.
pub(crate) fn is_plot(word: &str) -> bool {
    plots_height(word).is_some()
}

/// Commands that only contain other plots.
#[rustfmt::skip] // several words a line
pub(crate) const CONTAINERS: &[&str] = &[
    "draw3d", "display", "Show", "show", "patch", "GraphicsRow", "GraphicsColumn", "GraphicsGrid",
];

/// Plot commands that follow a module or an object and a dot.
pub(crate) const METHODS: &[&str] = &["contour", "marching_cubes", "surfaceNets", "plot_surface"];

/// Commands whose third argument holds the heights over a grid.
pub(crate) const GRIDS: &[&str] = &["surf", "mesh", "surface", "surfc", "meshc", "plot_surface"];

/// Commands with the level as the argument after the formula.
pub(crate) const LEVELED: &[&str] = &["isosurface", "marching_cubes"];

/// Names that the ends of a range may contain. If another name occurs, all ranges are ignored.
const CONSTANTS: &[&str] = &["pi", "tau", "e", "phi", "sqrt"];

/// Largest number of levels, and of formulas with a condition. Each of them gets a copy of the
/// formula.
const MAX_FORMULAS: usize = 20;

/// Longest domain that a note quotes, in bytes.
const MAX_NOTED_DOMAIN: usize = 120;

/// The parts of a plot command.
pub(crate) struct Plot {
    pub formulas: Vec<Vec<Token>>,
    /// True if the formulas are heights over x and y.
    pub is_height: bool,
    /// The ranges, and the axis of each; `None` if the command has no ranges.
    pub domain: Option<(Vec<PlotRange>, Vec<TokenKind>)>,
    /// Notes on the ranges, and on arguments that have no effect.
    pub notes: Vec<Note>,
    /// Names of the formulas that stand for coordinates.
    pub renamed: Vec<(Token, TokenKind)>,
    /// Names given as the grid of x, y and z, as in `surf(X, Y, Z)`.
    pub grid: Vec<Token>,
}

pub(crate) const AXES: [TokenKind; 3] = [X, Y, Z];

impl Words<'_> {
    /// Reads a plot command; no plot if `tokens` are no plot command.
    pub(crate) fn plots(self, tokens: &[Token]) -> Fallible<Vec<Plot>> {
        let is_name = |token: &Token| token.kind.is_name() || token.kind == Comma;
        let types = self.types(tokens);
        let tokens = &tokens[types..];
        // The left side of `plot = ContourPlot3D[…]`, which only names the picture.
        let row = closing(tokens).filter(|_| tokens[0].kind == OpenBracket);
        let left = match row.filter(|end| tokens[1..*end].iter().all(is_name)) {
            Some(end) => end + 1,
            None => tokens.iter().take_while(|token| is_name(token)).count(),
        };
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
        // A list of plots, or a sum of plots as in Sage.
        let parts = match Self::inside(tokens).filter(|_| first.kind == OpenBrace) {
            Some(inner) => split(inner, Comma),
            None => split(tokens, Plus),
        };
        let plots = |part: &Vec<Token>| is_plot(self.word(part[0]));
        if (parts.len() > 1 || first.kind == OpenBrace) && parts.iter().all(plots) {
            let mut plots = Vec::new();
            for part in parts {
                plots.extend(self.plots(&part)?);
            }
            return Ok(plots);
        }
        if word == "plot"
            && let Some(inner) = Self::inside(&tokens[1..])
            && inner.first().is_some_and(|inner| is_plot(self.word(*inner)))
        {
            return self.plots(inner);
        }
        if word == "isosurface" && tokens.get(1).is_some_and(|t| t.kind == OpenBrace) {
            return Ok(self.isosurface(&tokens[1..], first.span).into_iter().collect());
        }
        if word == "splot" {
            return Ok(vec![self.splot(&tokens[1..])]);
        }
        if word == "contour" { Ok(Vec::new()) } else { self.plots_of(word, &tokens[1..]) }
    }

    /// Returns whether a token is the dot before a method.
    pub(crate) fn is_dot(self, token: Token) -> bool {
        token.kind == Unknown && &self.text[token.span.range()] == "."
    }

    /// Reads the plot command `word`. `tokens` begin with its brackets.
    pub(crate) fn plots_of(self, word: &str, tokens: &[Token]) -> Fallible<Vec<Plot>> {
        let (Some((inner, rest)), Some(is_height)) = (bracketed(tokens), plots_height(word)) else {
            return Ok(Vec::new());
        };
        let is_end = |token: &Token| matches!(token.kind, Colon | Unknown);
        if !rest.iter().all(is_end) && !self.is_style_tail(rest) {
            return Ok(Vec::new());
        }
        let place = tokens[0].span;
        let mut arguments = Arguments::new(self.plot_arguments(inner));
        if !rest.iter().all(is_end) {
            arguments.record_unused(rest.to_vec());
        }
        let mut plots = self.inner_plots(&mut arguments)?;
        if !plots.is_empty() || CONTAINERS.contains(&word) {
            if let Some(first) = plots.first_mut() {
                first.notes.extend(self.unused_note(&arguments.into_unused()));
            }
            return Ok(plots);
        }
        if let Some(system) = arguments.all().iter().find(|part| self.word(part[0]) == "coords") {
            let span = system[0].span.to(system[system.len() - 1].span);
            return Err(Error::new(span, ErrorKind::PlotCoordinates));
        }
        let mut levels = self.levels(&mut arguments)?;
        let Some(formula) = self.formula(word, &mut arguments, &mut levels)? else {
            return Ok(Vec::new());
        };
        let is_flat = is_height || FLAT.contains(&word);
        let ranges = self.ranges(&mut arguments, 1, if is_flat { 2 } else { 3 });
        let names: Vec<Option<Token>> = ranges.iter().map(|range| range.name).collect();
        let mut ranges = ranges;
        let mut axes = axes_of(&names, is_height)?;
        let is_open = is_height && ranges.len() == 2;
        if let Some(heights) = is_open.then(|| self.height_range(&mut arguments)).flatten() {
            ranges.push(heights);
            axes.push(Z);
        }
        let domain = (!ranges.is_empty()).then_some((ranges, axes.clone()));
        let mut notes: Vec<Note> = Vec::new();
        let (parameters, formula) = match self.lambda(&formula) {
            Some((None, parameters, value)) => {
                (parameters.iter().filter_map(|part| part.first()).copied().collect(), value)
            }
            _ => (Vec::new(), formula),
        };
        let formula = self.returned(formula)?;
        let region = self.region(&mut arguments)?;
        let mut renamed = renamed(&names, &axes);
        let of_region = region.as_ref().map_or(&[][..], |(names, _)| names);
        for (names, is_height) in [(&parameters[..], is_height), (of_region, false)] {
            // An unused parameter does not rename a coordinate, in the function or outside.
            let condition = region.iter().flat_map(|(_, condition)| condition);
            let used: Vec<&str> =
                formula.iter().chain(condition).map(|token| self.word(*token)).collect();
            let all = renamed_all(names, is_height)?.into_iter();
            renamed.extend(all.filter(|(name, _)| used.contains(&self.word(*name))));
        }
        let mut formulas = Vec::new();
        let others = Self::other_formulas(word, &mut arguments);
        let all = std::iter::once(formula).filter(|f| !f.is_empty()).chain(others);
        for formula in all.flat_map(|formula| Self::listed(&formula)) {
            let is_equation = outside(&formula, Equals).is_some();
            let are_many = levels.len().max(formulas.len()) > MAX_FORMULAS;
            if !levels.is_empty() && (is_equation || are_many) {
                let kind = ErrorKind::PlotOption { name: "contour".to_owned() };
                return Err(Error::new(formula[0].span, kind));
            }
            formulas.extend(levels.iter().map(|level| minus_level(&formula, level)));
            formulas.extend(levels.is_empty().then_some(formula));
        }
        if formulas.len() > MAX_FORMULAS && region.is_some() {
            let kind = ErrorKind::PlotOption { name: "RegionFunction".to_owned() };
            return Err(Error::new(place, kind));
        }
        if let Some((_, condition)) = &region {
            for formula in &mut formulas {
                restrict(formula, condition);
            }
        }
        let is_function = |formula: &Vec<Token>| outside(formula, Equals).is_none();
        if LEVELED.contains(&word) && levels.is_empty() && formulas.iter().any(is_function) {
            notes.push(Note { span: place, kind: NoteKind::PlotWithoutLevel });
        }
        let grid = std::mem::take(&mut arguments.grid);
        notes.extend(self.unused_note(&arguments.into_unused()));
        Ok(vec![Plot { formulas, is_height, domain, notes, renamed, grid }])
    }

    /// The plots among the arguments of a plot, perhaps in a list.
    fn inner_plots(self, arguments: &mut Arguments) -> Fallible<Vec<Plot>> {
        let mut plots = Vec::new();
        for index in 0..arguments.all().len() {
            let part = &arguments.all()[index];
            let list = Self::inside(part).filter(|_| part[0].kind == OpenBrace);
            let parts = list.map_or_else(|| vec![part.clone()], |list| split(list, Comma));
            if !parts.iter().any(|part| is_plot(self.word(part[0]))) {
                continue;
            }
            for part in &parts {
                let inner = match self.word(part[0]) {
                    word if is_plot(word) => self.plots_of(word, &part[1..])?,
                    _ => Vec::new(),
                };
                if !inner.is_empty() {
                    arguments.take(index);
                } else if parts.len() > 1 {
                    arguments.record_unused(part.clone());
                }
                plots.extend(inner);
            }
        }
        Ok(plots)
    }

    /// The arguments in `inner`. A comma between parameters, as in `lambda x, y: …`, is no end.
    pub(crate) fn plot_arguments(self, inner: &[Token]) -> Vec<Vec<Token>> {
        let mut arguments: Vec<Vec<Token>> = Vec::new();
        let mut is_open = false;
        for part in split(inner, Comma) {
            let has_colon = outside(&part, Colon).is_some();
            let begins = self.has(&part, "lambda");
            match arguments.last_mut().filter(|_| is_open) {
                Some(last) => {
                    last.push(Token::new(Comma, part[0].span));
                    last.extend(part);
                }
                None => arguments.push(part),
            }
            is_open = (is_open || begins) && !has_colon;
        }
        arguments
    }

    /// Takes the formula from the arguments of the plot command `word`; `None` without arguments.
    /// It is empty if the command draws the last value of the program. Adds levels to `levels`.
    fn formula(
        self,
        word: &str,
        arguments: &mut Arguments,
        levels: &mut Vec<Vec<Token>>,
    ) -> Fallible<Option<Vec<Token>>> {
        let parts = arguments.all();
        let is_name = |part: &Vec<Token>| part.len() == 1 && part[0].kind.is_name();
        let is_function = |part: &Vec<Token>| {
            is_name(part) && part[0].kind == TokenKind::Name
                || matches!(self.lambda(part), Some((None, ..)))
        };
        let are_three = parts.len() > 2 && parts[..3].iter().all(is_function);
        let is_tuple = |part: &Vec<Token>| {
            matches!(part[0].kind, OpenBracket | OpenParen)
                && bracketed(part)
                    .is_some_and(|(inner, rest)| rest.is_empty() && split(inner, Comma).len() == 3)
        };
        if matches!(word, "fsurf" | "ezsurf") && are_three
            || word == "plot3d" && parts.first().is_some_and(is_tuple)
        {
            return Err(Error::new(parts[0][0].span, ErrorKind::Parametric));
        }
        let Some(first) = parts.first() else { return Ok(None) };
        let is_option = |part: &Vec<Token>| outside(part, Equals).is_some();
        // Axes or sizes of a grid may stand before an anonymous function.
        let lambda = parts.iter().position(|part| matches!(self.lambda(part), Some((None, ..))));
        let lambda = lambda.filter(|at| {
            let is_before = |part| is_name(part) || part[0].kind == OpenBracket;
            parts[..*at].iter().all(is_before)
        });
        // The grids of MATLAB's `surf(X, Y, Z)` and `isosurface(X, Y, Z, V, 0.1)` come before.
        let grids = match word {
            _ if lambda.is_some() => 0,
            "isosurface" if parts.len() > 3 && parts[..3].iter().all(is_name) => 3,
            _ if GRIDS.contains(&word) && parts.len() > 2 => 2,
            _ => 0,
        };
        let has_list = word == "contour" && first[0].kind == OpenBracket;
        let is_last_value =
            word == "contour" && !(has_list && parts.len() > 1 && !is_option(&parts[1]));
        // PyVista's `grid.contour([0])` draws the values that the program assigned last.
        if is_last_value && lambda.is_none() {
            let is_zero = |token: &Token| {
                let typed = &self.text[token.span.range()];
                token.kind != Number || typed.bytes().all(|byte| matches!(byte, b'0' | b'.'))
            };
            if !first.iter().all(is_zero) {
                let kind = ErrorKind::PlotOption { name: word.to_owned() };
                return Err(Error::new(first[0].span, kind));
            }
            arguments.take(0);
            return Ok(Some(Vec::new()));
        }
        for index in 0..grids {
            if is_name(&arguments.all()[index]) {
                let name = arguments.take(index)[0];
                arguments.grid.push(name);
            }
        }
        let at = lambda.unwrap_or(grids + usize::from(has_list));
        let formula = arguments.take(at);
        if has_list && at == 1 {
            let list = arguments.take(0);
            *levels = bracketed(&list).map_or(Vec::new(), |(inner, _)| split(inner, Comma));
        }
        if LEVELED.contains(&word) && levels.is_empty() {
            levels.extend(arguments.level_at(at + 1));
        }
        Ok(Some(match formula.as_slice() {
            // A function of all points of a grid, as in `f(*grid)`.
            [name, open, star, grid @ .., _] if (open.kind, star.kind) == (OpenParen, Star) => {
                if grid.len() > 1 {
                    arguments.record_unused(grid.to_vec());
                }
                vec![*name]
            }
            _ => formula.clone(),
        }))
    }

    /// Takes the further formulas of `SymPy`'s `plot3d(f, g, (x, -1, 1), (y, -1, 1))`.
    fn other_formulas(word: &str, arguments: &mut Arguments) -> Vec<Vec<Token>> {
        let is_formula = |part: &Vec<Token>| {
            let is_option = part.iter().any(|t| t.kind.is_relation() || t.kind == Unknown);
            let is_range = part[0].kind.closer().is_some() || outside(part, Dots).is_some();
            part.len() > 1 && !is_option && !is_range
        };
        let mut all = Vec::new();
        if word == "plot3d" {
            let count = arguments.all().iter().skip(1).take_while(|part| is_formula(part)).count();
            all.extend((1..=count).map(|index| arguments.take(index)));
        }
        all
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

    /// The text of `tokens`, which may come from several places.
    fn typed(self, tokens: &[Token]) -> String {
        let is_in_order = tokens.windows(2).all(|pair| {
            let between = self.text.get(pair[0].span.end..pair[1].span.start);
            between.is_some_and(|between| between.trim().is_empty())
        });
        if let (true, Some(span)) = (is_in_order, span_of(tokens)) {
            return self.text[span.range()].to_owned();
        }
        let one = |token: &Token| match &self.text[token.span.range()] {
            "" => token.kind.as_char().to_string(),
            typed => typed.to_owned(),
        };
        tokens.iter().map(one).collect()
    }

    /// A `domain` line for the ranges, and a note that states whether the ranges were read.
    pub(crate) fn domain(
        self,
        ranges: &[PlotRange],
        axes: &[TokenKind],
        place: Span,
    ) -> (Option<Vec<Token>>, Option<Note>) {
        let Some(first) = ranges.first() else { return (None, None) };
        let typed = |tokens: &[Token]| self.typed(tokens);
        let at = Span::at(first.low[0].span.start);
        let is_known = |token: &Token| {
            let name = plain_name(self.word(*token)).to_lowercase();
            !matches!(token.kind, X | Y | Z | TokenKind::Name) || CONSTANTS.contains(&name.as_str())
        };
        let ends = || ranges.iter().flat_map(|range| range.low.iter().chain(&range.high));
        let mut ordered: Vec<_> = axes.iter().zip(ranges).collect();
        ordered.sort_by_key(|(axis, _)| axis.as_char());
        let line = ordered
            .iter()
            .map(|(axis, r)| {
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

/// Restricts a formula by a condition in braces.
pub(crate) fn restrict(formula: &mut Vec<Token>, condition: &[Token]) {
    let end = Span::at(condition.last().map_or(0, |last| last.span.end));
    formula.push(Token::new(OpenBrace, end));
    formula.extend(condition);
    formula.push(Token::new(CloseBrace, end));
}

/// The tokens of `(formula) - (level)`.
pub(crate) fn minus_level(formula: &[Token], level: &[Token]) -> Vec<Token> {
    let mut all = in_brackets(formula);
    let end = all[all.len() - 1].span;
    all.push(Token::new(Minus, end));
    all.extend(in_brackets(level));
    all
}

/// Pairs of a variable and its axis, without variables that have the name of their axis.
fn renamed(names: &[Option<Token>], axes: &[TokenKind]) -> Vec<(Token, TokenKind)> {
    let pairs = names.iter().zip(axes).filter_map(|(name, axis)| Some(((*name)?, *axis)));
    pairs.filter(|(name, axis)| name.kind != *axis).collect()
}

/// Pairs of a function's parameter and its axis, without parameters that have the name of their
/// axis. Fails if a parameter has the name of another axis.
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
