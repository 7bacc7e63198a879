//! Reads commands that plot a parametric surface whose coordinates earlier statements define, such
//! as `f_x = u*cos(v)`, or grids such as `X = U.*cos(V)`.

use crate::curve_commands::draws_surface;
use crate::known_numbers::number_expr;
use crate::lists::separated;
use crate::program_reader::{Frame, ProgramReader, Statements};
use crate::program_words::Words;
use zeroset_ir::Axis;
use zeroset_parser::lex::token::{Token, bracketed, in_brackets, split};
use zeroset_parser::lex::token_kind::TokenKind::*;
use zeroset_parser::tree::ast::{ExprKind, NamedValue};
use zeroset_parser::{Fallible, NoteKind};

/// Commands of MATLAB that draw a surface over three grids.
const OVER_GRIDS: &[&str] =
    &["surf", "mesh", "surface", "surfl", "surfc", "meshc", "meshz", "waterfall"];

/// Largest number of surfaces of a sequence.
const MAX_SURFACES: f64 = 100.0;

/// Largest number of tokens of a coordinate.
const MAX_VALUE: usize = 2000;

/// Largest number of definitions that use one another.
const MAX_DEPTH: usize = 16;

impl ProgramReader<'_> {
    /// A command with the list in place of the name of a list, as in `f = (u, v, u*v)` and
    /// `parametric_plot3d(f, …)`. Brackets around both ranges, which Giac writes, are left out.
    /// Returns also the name that was replaced. `None` if there is no command.
    pub(crate) fn with_listed_point(
        &self,
        tokens: &[Token],
    ) -> Option<(Vec<Token>, Option<String>)> {
        let words = self.words;
        let at = tokens.iter().take(8).position(|token| draws_surface(words.word(*token)))?;
        let (inner, rest) = bracketed(&tokens[at + 1..])?;
        let mut parts = split(inner, Comma);
        let mut replaced = None;
        if let Some([name]) = parts.first().map(Vec::as_slice)
            && let Some(value) = self.assigned.get(words.word(*name))
            && bracketed(value)
                .is_some_and(|(list, rest)| rest.is_empty() && split(list, Comma).len() == 3)
        {
            replaced = Some(words.word(*name).to_owned());
            parts[0].clone_from(value);
        }
        let ranges = parts.get(1).and_then(|part| bracketed(part));
        let ranges = ranges.map(|(list, _)| split(list, Comma)).unwrap_or_default();
        if words.word(tokens[at]) == "plotparam"
            && ranges.len() == 2
            && ranges.iter().all(|range| range.get(1).is_some_and(|sign| sign.kind == Equals))
        {
            parts.splice(1..2, ranges);
        }
        let mut all = tokens[..at + 2].to_vec();
        all.extend(separated(&parts));
        all.extend(&tokens[tokens.len() - rest.len() - 1..]);
        Some((all, replaced))
    }

    /// Reads lists of `GeoGebra`, `{Surface(…), Surface(…)}` and `Sequence(Surface(…), a, 1, 3)`.
    /// Returns false for any other statement.
    pub(crate) fn surface_list(&mut self, tokens: &[Token], frame: &mut Frame) -> Fallible<bool> {
        let words = self.words;
        let is_surface = |part: &Vec<Token>| matches!(words.word(part[0]), "Surface" | "Sequence");
        let inside = match tokens[0].kind {
            OpenBrace => Words::inside(tokens),
            _ if words.word(tokens[0]) == "Sequence" => tokens.get(1..).and_then(Words::inside),
            _ => None,
        };
        let parts = inside.map(|inside| split(inside, Comma)).unwrap_or_default();
        if parts.is_empty() || !is_surface(&parts[0]) {
            return Ok(false);
        }
        let mut none = Statements::default();
        if tokens[0].kind == OpenBrace {
            if parts.iter().all(is_surface) {
                for part in parts {
                    self.statement(part, frame, &mut none)?;
                }
                return Ok(true);
            }
            return Ok(false);
        }
        let ([surface, name, low, high] | [surface, name, low, high, _]) = parts.as_slice() else {
            return Ok(false);
        };
        let number = |end: &[Token]| self.known_value(&self.resolved(end), frame);
        let step = parts.get(4).map_or(Some(1.0), |step| number(step));
        let ([name], Some(low), Some(high), Some(step)) =
            (name.as_slice(), number(low), number(high), step)
        else {
            return Ok(false);
        };
        let count = ((high - low) / step + 1e-9).floor();
        if step <= 0.0 || !(0.0..MAX_SURFACES).contains(&count) {
            return Ok(false);
        }
        for index in 0..=count as u32 {
            let value = number_expr(low + f64::from(index) * step, name.span);
            let value = vec![self.saved(value, name.span, false, frame)];
            let Some(one) = Words::substituted(surface, &[(*name, value)], words.text) else {
                return Ok(false);
            };
            self.statement(one, frame, &mut none)?;
        }
        Ok(true)
    }

    /// Reads a command whose first argument is a list of surfaces, as in
    /// `ParametricPlot3D[{{u, v, 0}, {u, v, 1}}, …]`. Returns false for any other statement.
    pub(crate) fn command_over_list(
        &mut self,
        tokens: &[Token],
        frame: &mut Frame,
    ) -> Fallible<bool> {
        let first = tokens.iter().take(8).position(|token| draws_surface(self.words.word(*token)));
        let Some((at, (inner, rest))) =
            first.and_then(|at| Some((at, bracketed(&tokens[at + 1..])?)))
        else {
            return Ok(false);
        };
        let parts = split(inner, Comma);
        let list = parts.first().and_then(|part| bracketed(part)).map(|(list, _)| list);
        let surfaces = list.map(|list| split(list, Comma)).unwrap_or_default();
        let is_point = |part: &Vec<Token>| {
            bracketed(part).is_some_and(|(own, _)| split(own, Comma).len() == 3)
        };
        if surfaces.is_empty() || !surfaces.iter().all(is_point) {
            return Ok(false);
        }
        let mut none = Statements::default();
        for surface in surfaces {
            let mut all = tokens[..at + 2].to_vec();
            all.extend(separated(&[&[surface], &parts[1..]].concat()));
            all.extend(&tokens[tokens.len() - rest.len() - 1..]);
            self.statement(all, frame, &mut none)?;
        }
        Ok(true)
    }

    /// Returns whether a statement only adds plots that were drawn before, as in `p1 + p2` of Sage.
    pub(crate) fn adds_plots(&self, tokens: &[Token]) -> bool {
        let is_plot = |name: &Token| {
            let value = self.assigned.get(self.words.word(*name));
            let first = value.and_then(|value| value.first());
            first.is_some_and(|first| draws_surface(self.words.word(*first)))
        };
        tokens.len() > 1
            && tokens.iter().enumerate().all(|(index, token)| match index % 2 {
                0 => is_plot(token),
                _ => token.kind == Plus,
            })
    }

    /// The statement of a surface with values in place of the names in its coordinates that depend
    /// on the parameters. Their definitions, which have no meaning apart, are dropped.
    pub(crate) fn with_own_values(
        &mut self,
        surface: Vec<Token>,
        list: Option<String>,
    ) -> Vec<Token> {
        let Some((inner, rest)) = surface.get(1..).and_then(bracketed) else { return surface };
        let names: Vec<String> = rest
            .windows(2)
            .filter(|pair| pair[0].kind == For)
            .map(|pair| self.words.word(pair[1]).to_owned())
            .collect();
        if names.len() != 2 {
            return surface;
        }
        // A list of coordinates has no other use than its surface.
        let mut dropped: Vec<String> = list.into_iter().collect();
        let mut budget = MAX_VALUE;
        let parts: Vec<Vec<Token>> = split(inner, Comma)
            .iter()
            .map(|part| self.over_parameters(part, &names, 0, &mut budget, &mut dropped))
            .collect();
        if dropped.is_empty() {
            return surface;
        }
        self.drop_assigned(&dropped);
        let mut all = surface[..2].to_vec();
        for (index, part) in parts.iter().enumerate() {
            all.extend((index > 0).then(|| Token::new(Comma, part[0].span)));
            all.extend(part);
        }
        all.push(surface[inner.len() + 2]);
        all.extend(rest);
        all
    }

    /// `tokens` with values in place of the names whose values use `parameters`. Adds those names
    /// to `replaced`.
    fn over_parameters(
        &self,
        tokens: &[Token],
        parameters: &[String],
        depth: usize,
        budget: &mut usize,
        replaced: &mut Vec<String>,
    ) -> Vec<Token> {
        let mut all = Vec::new();
        for (index, token) in tokens.iter().enumerate() {
            let word = self.words.word(*token);
            let is_called = tokens.get(index + 1).is_some_and(|next| next.kind == OpenParen);
            let is_parameter = parameters.iter().any(|name| name == word);
            let value = self.assigned.get(word).filter(|value| {
                token.kind.is_name()
                    && !is_called
                    && !is_parameter
                    && depth < MAX_DEPTH
                    && value.len() <= *budget
            });
            let Some(value) = value else {
                all.push(*token);
                continue;
            };
            *budget -= value.len();
            let value = self.over_parameters(value, parameters, depth + 1, budget, replaced);
            if parameters.iter().any(|name| self.words.has(&value, name)) {
                replaced.push(word.to_owned());
                all.extend(in_brackets(&value));
            } else {
                all.push(*token);
            }
        }
        all
    }

    /// Drops the statements that assign values to these names.
    fn drop_assigned(&mut self, names: &[String]) {
        let words = self.words;
        let is_named = |name: &str| names.iter().any(|one| one == name);
        self.program.statements.retain(|raw| match (&raw.head, raw.lexed.tokens.as_slice()) {
            (Some(head), _) => head.parameters.is_some() || !is_named(&head.name.text),
            (None, [name, equals, ..]) => equals.kind != Equals || !is_named(words.word(*name)),
            _ => true,
        });
    }

    /// Draws MATLAB's `surf(X, Y, Z)`, in which the grids X and Y are computed from two ranges.
    /// Returns false for any other statement.
    pub(crate) fn surface_over_grids(
        &mut self,
        tokens: &[Token],
        frame: &mut Frame,
    ) -> Fallible<bool> {
        let words = self.words;
        let is_command = OVER_GRIDS.contains(&words.word(tokens[0]));
        let Some((inner, rest)) = tokens.get(1..).and_then(bracketed).filter(|_| is_command) else {
            return Ok(false);
        };
        let parts = split(inner, Comma);
        let is_other = parts.len() < 3 || self.arity(tokens[0]).is_some();
        // Other commands, as in `surf(x, y, z), axis equal`, only style the picture.
        if is_other || rest.first().is_some_and(|sign| sign.kind != Comma) {
            return Ok(false);
        }
        let is_computed = parts.iter().zip([Axis::X, Axis::Y]).any(|(part, axis)| {
            part.first().is_some_and(|name| name.kind.is_axis())
                && self.assigned.contains_key(words.word(part[0]))
                || self.is_computed(part, axis, frame)
        });
        if !is_computed {
            return Ok(false);
        }
        let surface = self.surface_over_ranges(&[], &parts[..2], &parts[2], tokens[0].span);
        let Some((surface, names)) = surface else { return Ok(false) };
        let coordinates: Vec<String> = parts
            .iter()
            .flatten()
            .filter(|token| token.kind.is_name())
            .map(|token| words.word(*token).to_owned())
            .collect();
        self.drop_assigned(&coordinates);
        self.program.notes.extend(words.unused_note(&parts[3..]));
        self.plain_over(surface, &names, frame).map(|()| true)
    }

    /// Adds the statement of a surface over grids. The names of its parameters were read as
    /// coordinates of space before.
    pub(crate) fn plain_over(
        &mut self,
        surface: Vec<Token>,
        names: &[Token; 2],
        frame: &Frame,
    ) -> Fallible<()> {
        // The ranges of its grid are those of the parameters, and not of x and y.
        let is_of_grid =
            |token: &Token| token.kind == DomainWord && token.span.start == token.span.end;
        self.program.statements.retain(|raw| !raw.lexed.tokens.first().is_some_and(is_of_grid));
        self.program.notes.retain(|note| !matches!(note.kind, NoteKind::PlotDomain { .. }));
        let mut frame = frame.clone();
        for name in names {
            let name = self.words.word(*name).to_owned();
            frame.aliases.push(name.clone(), ExprKind::Name(NamedValue::Local(name)));
        }
        self.plain(surface, &frame, false)
    }

    /// The statement of gnuplot's `splot x, y, z` over the ranges of u and v.
    pub(crate) fn parametric_surface_splot(&self, tokens: &[Token]) -> Option<Vec<Token>> {
        let range = |name: &str| self.ranges.get(name);
        self.words.surface_splot(tokens, [range("urange"), range("vrange")])
    }
}
