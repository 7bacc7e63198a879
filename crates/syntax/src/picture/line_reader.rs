//! Reads the parts of lines about the picture: numbers, words, opacities.

use crate::lower::constant::evaluate;
use zeroset_interval::Interval;
use zeroset_ir::Constant;
use zeroset_parser::settings::setting;
use zeroset_parser::tree::ast::Expr;
use zeroset_parser::tree::builder::Builder;
use zeroset_parser::tree::grammar::{Pair, Rule, parts};
use zeroset_parser::tree::scope::nearest;
use zeroset_parser::{Error, ErrorKind, Fallible, Span};
use zeroset_style::{SHARE, Setting, Values};

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

    /// Reads one of `words`, and returns its index. A line without a word means the index `usual`.
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

    /// Reads a value of a setting. A line without a value means `on`, if the setting has it.
    pub(crate) fn setting_value(&mut self, line: Pair<'_>, row: &'static Setting) -> Fallible<f64> {
        match (&parts(line.clone())[..], &row.values) {
            ([number], _) if number.as_rule() == Rule::opacity => self.number(number, row),
            (_, Values::Switch) => Ok(f64::from(self.switch(line, row.word)?)),
            (_, Values::Number { on: Some(on), .. }) => {
                Ok(if self.switch(line, row.word)? { *on } else { 0.0 })
            }
            ([value], _) if value.as_rule() == Rule::expression => {
                let (place, value) = (self.builder.span(value), self.builder.value(value.clone())?);
                self.checked(&value, 1.0, row, place)
            }
            _ => Err(bad_setting(row.word, self.builder.lexed.span)),
        }
    }

    /// Reads a number. A share may be a percentage.
    pub(crate) fn number(&mut self, pair: &Pair<'_>, row: &'static Setting) -> Fallible<f64> {
        let (place, all) = (self.builder.span(pair), parts(pair.clone()));
        let whole = match (&all[1..], &row.values) {
            ([], _) => 1.0,
            (_, Values::Number { noun: SHARE, .. }) => 100.0,
            _ => return Err(bad_setting(row.word, place)),
        };
        let value = self.builder.term(&mut all[0].clone().into_inner())?;
        self.checked(&value, whole, row, place)
    }

    /// The value of an expression, divided by `whole`. Fails if the setting does not accept it.
    fn checked(
        &self,
        value: &Expr,
        whole: f64,
        row: &'static Setting,
        place: Span,
    ) -> Fallible<f64> {
        let Interval { lo, hi } = evaluate(value, self.builder.limits)?.bounds();
        row.values.check(lo.midpoint(hi) / whole).map_err(|_| bad_setting(row.word, place))
    }
}

/// The error for a line about the picture whose contents do not fit its `word`.
pub(crate) fn bad_setting(word: &'static str, span: Span) -> Box<Error> {
    let hint = setting(word).map_or("", |setting| &*setting.hint);
    Error::new(span, ErrorKind::BadSetting { word, hint })
}
