//! Reads the parts of lines about the picture: numbers, words, opacities.

use crate::lower::constant::evaluate;
use zeroset_ir::Constant;
use zeroset_parser::settings::setting;
use zeroset_parser::tree::ast::Expr;
use zeroset_parser::tree::builder::Builder;
use zeroset_parser::tree::grammar::{Pair, Rule, parts};
use zeroset_parser::tree::scope::nearest;
use zeroset_parser::{Error, ErrorKind, Fallible, Span};

/// Reads the parts of one line. `lines`, `scene` and `paint` add methods for their lines.
pub(crate) struct LineReader<'a> {
    pub builder: Builder<'a>,
}

impl LineReader<'_> {
    /// Reads `COUNT` numbers from a line that begins with `word`.
    pub(crate) fn numbers<const COUNT: usize>(
        &mut self,
        line: Pair<'_>,
        word: &'static str,
    ) -> Fallible<[Constant; COUNT]> {
        let mut parts = parts(line);
        if let [point] = &parts[..]
            && point.as_rule() == Rule::point
        {
            parts = point.clone().into_inner().collect();
        }
        let mut numbers = Vec::new();
        for part in parts {
            if !matches!(part.as_rule(), Rule::expression) {
                return Err(bad_setting(word, self.builder.span(&part)));
            }
            let number = self.builder.value(part)?;
            numbers.push(evaluate(&number, self.builder.limits)?);
        }
        <[Constant; COUNT]>::try_from(numbers)
            .map_err(|_| bad_setting(word, self.builder.lexed.span))
    }

    /// Reads expressions from a line that begins with `word`.
    pub(crate) fn values<'i>(
        &mut self,
        word: &'static str,
        parts: impl IntoIterator<Item = Pair<'i>>,
    ) -> Fallible<Vec<Expr>> {
        let value = |part: Pair<'i>| match part.as_rule() {
            Rule::expression => self.builder.value(part),
            _ => Err(bad_setting(word, self.builder.span(&part))),
        };
        parts.into_iter().map(value).collect()
    }

    /// Reads `on` or `off`. A line without either means `on`.
    pub(crate) fn switch(&mut self, line: Pair<'_>, word: &'static str) -> Fallible<bool> {
        Ok(self.one_of(line, word, ["on", "off"], 0)? == 0)
    }

    /// Reads one of `words`, and returns its index. A line without a word means word `usual`.
    pub(crate) fn one_of<const COUNT: usize>(
        &mut self,
        line: Pair<'_>,
        word: &'static str,
        words: [&str; COUNT],
        usual: usize,
    ) -> Fallible<usize> {
        match &parts(line)[..] {
            [] => Ok(usual),
            [part] => {
                let place = self.builder.span(part);
                let typed = self.builder.word(part);
                words.iter().position(|word| *word == typed).ok_or_else(|| {
                    let meant = nearest(&typed, words.into_iter());
                    bad_setting(word, place).suggest_optional(place, meant)
                })
            }
            _ => Err(bad_setting(word, self.builder.lexed.span)),
        }
    }

    /// Reads an opacity from 0 to 1, or from 0 % to 100 %.
    pub(crate) fn opacity(&mut self, pair: Pair<'_>) -> Fallible<f64> {
        let span = self.builder.span(&pair);
        let mut parts = pair.into_inner();
        let number =
            self.builder.term(&mut parts.next().expect("an opacity has a number").into_inner());
        let value = evaluate(&number?, self.builder.limits)?.bounds();
        let whole = match parts.next() {
            Some(_) => 100.0,
            None => 1.0,
        };
        let share = value.lo.midpoint(value.hi) / whole;
        if (0.0..=1.0).contains(&share) { Ok(share) } else { Err(bad_setting("opacity", span)) }
    }
}

/// The error for a line about the picture whose contents do not fit its `word`.
pub(crate) fn bad_setting(word: &'static str, span: Span) -> Box<Error> {
    let hint = setting(word).map_or("", |setting| setting.hint);
    Error::new(span, ErrorKind::BadSetting { word, hint })
}
