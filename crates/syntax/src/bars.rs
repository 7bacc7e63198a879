//! Bars: which open and which close, and which two are the word or.

use crate::error::{Error, ErrorKind, Fallible};
use crate::lexer::{begins_operand, ends_operand};
use crate::scan::Token;
use crate::span::Span;
use crate::spelling::{closer, is_closer};

/// Tells closing bars from opening ones. They open and close in turn within each pair of brackets;
/// whatever else they could mean is an error. Two bars side by side between operands, where none is
/// open, join conditions.
pub(crate) fn pair_bars(tokens: &mut Vec<Token>) -> Fallible<()> {
    #[derive(Default)]
    struct Level {
        /// The open bar.
        open: Option<Span>,
        /// The opening bar of the last pair, if an operand followed the pair directly.
        loose: Option<Span>,
    }
    let count = tokens.iter().filter(|token| token.symbol == '|').count();
    if count == 0 {
        return Ok(());
    }
    let mut levels = vec![Level::default()];
    for index in 0..tokens.len() {
        let Token { symbol, span, .. } = tokens[index];
        if closer(symbol).is_some() {
            levels.push(Level::default());
        }
        if is_closer(symbol)
            && let Some(span) = levels.pop().and_then(|level| level.open)
        {
            return Err(Error::new(span, ErrorKind::UnclosedBar));
        }
        let (Some(level), '|') = (levels.last_mut(), symbol) else {
            continue;
        };
        let before = index.checked_sub(1).map_or(' ', |before| tokens[before].symbol);
        let after = tokens.get(index + 1).map_or(' ', |after| after.symbol);
        let Some(open) = level.open.take() else {
            let begins = |beyond: &Token| {
                let is_apart = beyond.span.start > tokens[index + 1].span.end;
                begins_operand(beyond.symbol)
                    || beyond.symbol == '-'
                    || beyond.symbol == '|' && is_apart
            };
            if after == '|'
                && tokens[index + 1].span.start == span.end
                && ends_operand(before)
                && tokens.get(index + 2).is_some_and(begins)
            {
                tokens[index].symbol = '∨';
                tokens[index + 1].symbol = ' ';
                continue;
            }
            if let (true, Some(first)) = (ends_operand(before), level.loose) {
                return Err(Error::new(first.to(span), ErrorKind::AmbiguousBars));
            }
            level.open = Some(span);
            continue;
        };
        let is_empty = before == '|';
        if is_empty || (!ends_operand(before) && begins_operand(after)) {
            let kind =
                if is_empty && count <= 2 { ErrorKind::EmptyBars } else { ErrorKind::NestedBars };
            return Err(Error::new(open.to(span), kind));
        }
        level.loose = begins_operand(after).then_some(open);
        tokens[index].symbol = '¦';
    }
    tokens.retain(|token| token.symbol != ' ');
    match levels.pop().and_then(|level| level.open) {
        Some(span) => Err(Error::new(span, ErrorKind::UnclosedBar)),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::Limits;
    use crate::scan::scan;

    fn kind(text: &str) -> Option<ErrorKind> {
        let mut statements = scan(text, &Limits::default()).expect("brackets are paired");
        pair_bars(&mut statements[0]).err().map(|e| e.kind)
    }

    #[test]
    fn bars_pair_in_one_way_or_not_at_all() {
        for text in ["|x|", "|x|+|y|", "|x||y|", "2|x|y", "|x|-y|z|", "(|x|)|y|", "|(|x|)|"] {
            assert_eq!(kind(text), None, "{text}");
        }
        for text in ["|x|y|z|", "|x| 2|y|", "|x| y + 2 |z|"] {
            assert_eq!(kind(text), Some(ErrorKind::AmbiguousBars), "{text}");
        }
        for text in ["||x|-1|", "|x+|y||", "||x||", "2 |||x|-1|"] {
            assert_eq!(kind(text), Some(ErrorKind::NestedBars), "{text}");
        }
        assert_eq!(kind("|x"), Some(ErrorKind::UnclosedBar));
        assert_eq!(kind("(|x)|"), Some(ErrorKind::UnclosedBar));
        assert_eq!(kind("||"), Some(ErrorKind::EmptyBars));
        for text in ["x > 0 || y > 0", "(x > 0 || |y| > 1)", "|x| > 0||y > 0"] {
            assert_eq!(kind(text), None, "{text}");
        }
    }
}
