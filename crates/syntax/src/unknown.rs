//! Errors about names that stand for nothing, and what their writer may have meant.

use crate::build::Builder;
use crate::diagnose::short;
use crate::error::{Error, ErrorKind};
use crate::scope::Meaning;
use crate::span::Span;

impl Builder<'_> {
    /// The error for a name without a meaning.
    pub(crate) fn unknown(&self, name: &str, typed: &str, span: Span) -> Box<Error> {
        // `i` alone, or next to values as in `iy`.
        let rest = name.strip_prefix('i').or_else(|| name.strip_suffix('i'));
        if rest.is_some_and(|rest| {
            rest.is_empty() || matches!(self.meaning(rest), Meaning::Value(_) | Meaning::Product)
        }) {
            return Error::new(span, ErrorKind::Complex);
        }
        if let Some(powers) = self.lost_superscripts(name) {
            let name = name.to_owned();
            return Error::new(span, ErrorKind::LostSuperscript { name }).suggest(span, powers);
        }
        let followed_by_brackets = self.text[span.end..].trim_start().starts_with(['(', '[']);
        let kind = if followed_by_brackets || typed.starts_with('\\') {
            ErrorKind::UnknownFunction { name: short(name) }
        } else {
            ErrorKind::UnknownName { name: short(name), letter: self.missing_letter(name) }
        };
        let error = Error::new(span, kind);
        match self.likely(name, followed_by_brackets) {
            Some(meant) => error.suggest(span, meant),
            None => error,
        }
    }

    /// What the writer of a left side that defines `name` for nothing may have meant by it.
    pub(crate) fn meant(&self, name: &str, is_function: bool) -> Option<String> {
        self.lost_superscripts(name).or_else(|| self.likely(name, is_function))
    }

    /// Two known names run together, or the nearest one.
    fn likely(&self, name: &str, is_function: bool) -> Option<String> {
        // As computer algebra systems write it.
        if name == "E" && !is_function {
            return Some("e".to_owned());
        }
        let nearest = || self.scope.nearest(name, self.locals, is_function);
        self.run_together(name).or_else(nearest)
    }

    /// `x2y` as `x^2*y`, if its letters are values: a superscript that was lost in copying.
    fn lost_superscripts(&self, name: &str) -> Option<String> {
        // Each letter is looked up, so a bound keeps hostile names cheap.
        if name.len() > 64 || !name.contains(|c: char| c.is_ascii_digit()) {
            return None;
        }
        let mut powers = String::new();
        let mut previous = ' ';
        let mut buffer = [0; 4];
        for character in name.chars() {
            if character.is_ascii_digit() {
                if !previous.is_ascii_digit() {
                    powers.push('^');
                }
            } else {
                let letter = character.encode_utf8(&mut buffer);
                if !self.is_value(letter) {
                    return None;
                }
                if !powers.is_empty() {
                    powers.push('*');
                }
            }
            powers.push(character);
            previous = character;
        }
        Some(powers)
    }

    /// The only letter of a short name like `mx` that has no value.
    fn missing_letter(&self, name: &str) -> Option<char> {
        // Longer names are words, not products.
        const LONGEST: usize = 3;
        let letters: Vec<char> = name.chars().take(LONGEST + 1).collect();
        if !(2..=LONGEST).contains(&letters.len()) || !name.contains(['x', 'y', 'z']) {
            return None;
        }
        let mut missing = letters.iter().filter(|letter| !self.is_value(&letter.to_string()));
        let letter = missing.next().filter(|letter| letter.is_alphabetic())?;
        missing.all(|other| other == letter).then_some(*letter)
    }

    /// `xsin` as `x sin` and `sinxy` as `sin xy`, if the parts have meanings.
    fn run_together(&self, name: &str) -> Option<String> {
        if name.len() > 64 {
            return None;
        }
        name.char_indices().skip(1).find_map(|(at, _)| {
            let (left, right) = name.split_at(at);
            let pair = (self.meaning(left), self.meaning(right));
            match pair {
                (Meaning::Value(_) | Meaning::Product, Meaning::Function(_)) if right.len() > 1 => {
                    Some(format!("{left}*{right}"))
                }
                (Meaning::Function(_), Meaning::Value(_) | Meaning::Product) if left.len() > 1 => {
                    Some(format!("{left} {right}"))
                }
                _ => None,
            }
        })
    }

    fn meaning(&self, name: &str) -> Meaning {
        self.scope.meaning(name, self.locals)
    }

    fn is_value(&self, name: &str) -> bool {
        matches!(self.meaning(name), Meaning::Value(_))
    }
}
