//! Reads plots whose parts have no brackets: gnuplot's `splot`, and POV-Ray's `isosurface { … }`.

use crate::plot_arguments::PlotRange;
use crate::plot_commands::{AXES, Plot, minus_level};
use crate::program_words::Words;
use zeroset_parser::lex::token::{Token, bracketed, closing, split};
use zeroset_parser::lex::token_kind::TokenKind::{self, *};
use zeroset_parser::{Note, NoteKind, Span};

/// Words after a formula of gnuplot.
const SPLOT_WORDS: &[&str] =
    &["with", "w", "using", "u", "title", "t", "notitle", "lw", "lt", "lc"];

impl Words<'_> {
    /// The curve of gnuplot's `splot [0:6] cos(u), sin(u), u` after `set parametric`.
    pub(crate) fn parametric_splot(
        self,
        tokens: &[Token],
        set: Option<&[Vec<Token>; 2]>,
    ) -> Option<Vec<Token>> {
        if self.word(tokens[0]) != "splot" || !self.text.contains("set parametric") {
            return None;
        }
        let (range, rest) = match bracketed(&tokens[1..]).filter(|_| tokens[1].kind == OpenBracket)
        {
            Some((inner, rest)) => (split(inner, Colon), rest),
            None => (set?.to_vec(), &tokens[1..]),
        };
        let ends =
            |token: &Token| SPLOT_WORDS.contains(&self.word(*token)) && self.word(*token) != "u";
        let parts: Vec<(Vec<Token>, Vec<Token>)> = split(rest, Comma)
            .into_iter()
            .map(|part| (Vec::new(), part.into_iter().take_while(|token| !ends(token)).collect()))
            .collect();
        let mut names = parts.iter().flat_map(|(_, part)| part);
        let name = *names.find(|token| matches!(self.word(**token), "u" | "t"))?;
        let has_two = parts.iter().any(|(_, part)| self.has(part, "v"));
        let [low, high] = <[_; 2]>::try_from(range).ok()?;
        let range = PlotRange { name: None, low, high };
        (parts.len() == 3 && !has_two).then(|| self.path(tokens[0].span, &parts, &[(name, &range)]))
    }

    /// The surface of gnuplot's `splot cos(u)*v, sin(u)*v, v` after `set parametric`, over the
    /// ranges of u and v.
    pub(crate) fn surface_splot(
        self,
        tokens: &[Token],
        ranges: [Option<&[Vec<Token>; 2]>; 2],
    ) -> Option<Vec<Token>> {
        let [Some(of_u), Some(of_v)] = ranges else { return None };
        if self.word(tokens[0]) != "splot" || !self.text.contains("set parametric") {
            return None;
        }
        let ends =
            |token: &Token| SPLOT_WORDS.contains(&self.word(*token)) && self.word(*token) != "u";
        let parts: Vec<(Vec<Token>, Vec<Token>)> = split(&tokens[1..], Comma)
            .into_iter()
            .map(|part| (Vec::new(), part.into_iter().take_while(|token| !ends(token)).collect()))
            .collect();
        let named = |name: &str| {
            let mut tokens = parts.iter().flat_map(|(_, part)| part);
            tokens.find(|token| self.word(**token) == name).copied()
        };
        let (u, v) = named("u").zip(named("v"))?;
        let [of_u, of_v] = [of_u, of_v].map(|[low, high]| PlotRange {
            name: None,
            low: low.clone(),
            high: high.clone(),
        });
        let place = tokens[0].span;
        (parts.len() == 3).then(|| self.path(place, &parts, &[(u, &of_u), (v, &of_v)]))
    }

    /// Reads gnuplot's `splot [-2:2][-2:2] f with lines`. `tokens` begin after the word `splot`.
    pub(crate) fn splot(self, tokens: &[Token]) -> Plot {
        let mut rest = tokens;
        let (mut ranges, mut left) = (Vec::new(), Vec::new());
        while let Some((inner, more)) = bracketed(rest).filter(|_| rest[0].kind == OpenBracket) {
            match <[_; 2]>::try_from(split(inner, Colon)) {
                // A third range only cuts the picture.
                Ok([low, high]) if ranges.len() < 2 => {
                    ranges.push(PlotRange { name: None, low, high });
                }
                _ => left.push(rest[..rest.len() - more.len()].to_vec()),
            }
            rest = more;
        }
        let axes = AXES[..ranges.len()].to_vec();
        let domain = (!ranges.is_empty()).then_some((ranges, axes));
        let mut formulas = Vec::new();
        for part in split(rest, Comma) {
            let ends = |token: &Token| SPLOT_WORDS.contains(&self.word(*token));
            let count = part.iter().position(ends).unwrap_or(part.len());
            let (formula, options) = part.split_at(count);
            // The third column of `'++' using 1:2:(f)` is the height.
            let is_text = matches!(formula, [text] if text.kind == Unknown);
            let columns = split(options, Colon);
            let height = columns.get(2).filter(|_| is_text).and_then(|column| bracketed(column));
            match height {
                Some((inner, more)) => {
                    formulas.push(inner.to_vec());
                    left.push(more.to_vec());
                }
                None if is_text && !options.is_empty() => left.push(part),
                None => {
                    formulas.push(formula.to_vec());
                    left.push(options.to_vec());
                }
            }
        }
        let notes = self.unused_note(&left).into_iter().collect();
        Plot { formulas, is_height: true, domain, notes, renamed: Vec::new(), grid: Vec::new() }
    }

    /// Reads POV-Ray's `isosurface { function { … } threshold 1 contained_by { … } }`. `tokens`
    /// begin after the word `isosurface`.
    pub(crate) fn isosurface(self, tokens: &[Token], place: Span) -> Option<Plot> {
        let (inner, rest) = bracketed(tokens)?;
        let (mut body, mut level, mut container) = (None, None, None);
        let mut left = Vec::new();
        let items = self.items(inner);
        for item in &items {
            match self.word(item[0]) {
                "function" if body.is_none() => {
                    let value = &item[1..];
                    let is_list = value.first().is_some_and(|open| open.kind == OpenParen);
                    let value = if is_list { bracketed(value)?.1 } else { value };
                    body = Some(bracketed(value)?.0);
                }
                "threshold" if item.len() > 1 => level = Some(item[1..].to_vec()),
                "contained_by" if container.is_none() => container = Some(item),
                _ => left.push(item.clone()),
            }
        }
        left.push(rest.to_vec());
        let body = body?.to_vec();
        let body = level.map_or(body.clone(), |level| minus_level(&body, &level));
        let (domain, note) = match container {
            None => (None, None),
            Some(container) => match self.contained(&container[1..]) {
                Some(ranges) => (Some((ranges, AXES.to_vec())), None),
                None => (None, Some(Note { span: place, kind: NoteKind::ContainerIgnored })),
            },
        };
        let notes = note.into_iter().chain(self.unused_note(&left)).collect();
        let formulas = vec![body];
        Some(Plot {
            formulas,
            is_height: false,
            domain,
            notes,
            renamed: Vec::new(),
            grid: Vec::new(),
        })
    }

    /// Splits the contents of a block into its items. Each begins with a name that follows a value
    /// or another name.
    fn items(self, tokens: &[Token]) -> Vec<Vec<Token>> {
        let mut items: Vec<Vec<Token>> = Vec::new();
        let mut rest = tokens;
        while let Some(first) = rest.first() {
            let (piece, more) = rest.split_at(closing(rest).map_or(1, |end| end + 1));
            let ends = |last: &Token| last.kind.ends_operand() || last.kind == Greater;
            match items.last_mut() {
                Some(item)
                    if first.kind != TokenKind::Name
                        || !item.last().is_some_and(ends)
                        || item.len() == 1 && self.word(item[0]) == "threshold" =>
                {
                    item.extend(piece);
                }
                _ => items.push(piece.to_vec()),
            }
            rest = more;
        }
        items
    }

    /// The ranges of `{ box { -2, 2 } }` and `{ box { <-2, -2, -1>, <2, 2, 1> } }`.
    fn contained(self, tokens: &[Token]) -> Option<Vec<PlotRange>> {
        let (inner, _) = bracketed(tokens)?;
        let (ends, _) = bracketed(inner.get(1..)?).filter(|_| self.word(inner[0]) == "box")?;
        let mut ends = split(ends, Comma);
        if !matches!(ends.len(), 2 | 6) {
            return None;
        }
        // The lexer reads the `<` and `>` around a corner as relations. They are dropped.
        for corner in ends.chunks_exact_mut(3) {
            let (first, last) = (corner[0].remove(0), corner[2].pop()?);
            if (first.kind, last.kind) != (Less, Greater) {
                return None;
            }
        }
        if ends.iter().any(Vec::is_empty) {
            return None;
        }
        let half = ends.len() / 2;
        let range = |index: usize| {
            let index = index.min(half - 1);
            PlotRange { name: None, low: ends[index].clone(), high: ends[index + half].clone() }
        };
        Some((0..AXES.len()).map(range).collect())
    }
}
