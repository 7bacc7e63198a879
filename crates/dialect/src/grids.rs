//! Reads ranges and grids that a program defines before a plot, and draws the program's plots.

use crate::plot_arguments::{PlotRange, axes_of};
use crate::plot_commands::{AXES, Plot};
use crate::program_reader::{Frame, ProgramReader};
use zeroset_ir::Axis;
use zeroset_parser::lex::token::{Token, bracketed, split};
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

/// Functions that make grids of coordinates, each with the ranges as arguments.
pub(crate) const GRIDS: [&str; 4] = ["meshgrid", "ndgrid", "mgrid", "ogrid"];

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

impl ProgramReader<'_> {
    /// Records a range such as `t = linspace(-2, 2)`, or reads the grid `[X, Y] = meshgrid(t, t)`.
    /// Returns false for any other statement.
    pub(crate) fn grid(&mut self, tokens: &[Token], frame: &mut Frame) -> Fallible<bool> {
        let words = self.words;
        if let [set, name, range @ ..] = tokens
            && words.word(*set) == "set"
            && let Some((inner, [])) = bracketed(range)
        {
            let is_axis = matches!(words.word(*name), "xrange" | "yrange");
            if let (true, Ok(ends)) = (is_axis, <[_; 2]>::try_from(split(inner, Colon))) {
                self.ranges.insert(words.word(*name).to_owned(), ends);
                return Ok(true);
            }
        }
        let Some(equals) = tokens.iter().rposition(|token| token.kind == Equals) else {
            return Ok(false);
        };
        let (left, value) = (&tokens[..equals], &tokens[equals + 1..]);
        let names: Vec<Token> = left.iter().copied().filter(|token| token.kind.is_name()).collect();
        let (Some(first), Some(name)) = (value.first(), names.first()) else { return Ok(false) };
        if value.len() > MAX_RANGE {
            return Ok(false);
        }
        let is_grid = GRIDS.contains(&words.word(*first));
        if let (true, Some((inner, _))) = (is_grid && names.len() > 1, bracketed(&value[1..])) {
            // numpy writes the step of a range last, MATLAB between its ends.
            let steps_last = matches!(words.word(*first), "mgrid" | "ogrid");
            self.meshgrid(&names, &split(inner, Comma), steps_last, frame)?;
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
        if !is_list || !self.has_grid {
            return Ok(false);
        }
        let Some(ends) = self.range_ends(value, false) else { return Ok(false) };
        for name in names {
            self.ranges.insert(words.word(name).to_owned(), ends.clone());
        }
        Ok(true)
    }

    /// The ends of a range such as `-2:0.1:2`, `linspace(-2, 2, 50)` or the name of a range. A step
    /// stands between the ends, or behind them if `steps_last`.
    fn range_ends(&self, value: &[Token], steps_last: bool) -> Option<[Vec<Token>; 2]> {
        if let [name] = value {
            return self.ranges.get(self.words.word(*name)).cloned();
        }
        if self.words.word(value[0]) == "linspace" {
            let (inner, _) = bracketed(&value[1..])?;
            let parts = split(inner, Comma);
            return Some([parts.first()?.clone(), parts.get(1)?.clone()]);
        }
        let value = match bracketed(value) {
            Some((inner, [])) => inner,
            _ => value,
        };
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
        frame: &mut Frame,
    ) -> Fallible<()> {
        let own = |name: &Token| named_axis(self.words.word(*name));
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
            let [low, high] = self.range_ends(part(index)?, steps_last)?;
            Some(PlotRange { name: None, low, high })
        };
        let ranges: Option<Vec<PlotRange>> = (0..names.len()).map(range).collect();
        let Some(ranges) = ranges else {
            let (span, kind) = (names[0].span, NoteKind::PlotWithoutRanges);
            self.program.notes.push(Note { span, kind });
            return Ok(());
        };
        let (domain, note) = self.words.domain(&ranges, &axes, names[0].span);
        self.program.notes.extend(note);
        domain.map_or(Ok(()), |line| self.push(line, None, None, &Aliases::default(), false))
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
        let Plot { formulas, is_height, mut domain, notes, renamed, grid } = plot;
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
        for formula in formulas {
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
        if let (None, [Some(x), Some(y)]) = (&domain, set) {
            let range = |[low, high]: [Vec<Token>; 2]| PlotRange { name: None, low, high };
            let (line, note) = self.words.domain(&[range(x), range(y)], &[X, Y], place);
            self.program.notes.extend(note);
            domain = line;
        }
        domain.map_or(Ok(()), |line| self.push(line, None, None, &Aliases::default(), false))
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
