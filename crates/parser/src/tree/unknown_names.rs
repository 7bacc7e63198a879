//! Builds errors about names without a meaning, with suggestions.

use crate::lex::spelling::{short_name, start, token_kind};
use crate::lex::token::Token;
use crate::lex::token_kind::TokenKind::{self, *};
use crate::messages::error::{Error, ErrorKind};
use crate::settings::SETTINGS;
use crate::span::Span;
use crate::tree::ast::{Name, NamedValue};
use crate::tree::builder::Builder;
use crate::tree::scope::{Callee, NameMeaning, Scope, nearest, read_as};

/// Largest size of a name whose parts are looked up, in bytes. The limit keeps hostile names cheap.
const MAX_NAME: usize = 64;

/// Names of solids, each with a formula for the solid.
const SOLIDS: &[(&str, &str)] = &[
    ("sphere", "a sphere of radius 2 is `x^2 + y^2 + z^2 = 4`"),
    ("ball", "a ball of radius 2 is `x^2 + y^2 + z^2 <= 4`"),
    ("torus", "a torus is `(sqrt(x^2 + y^2) - 2)^2 + z^2 = 0.25`"),
    ("cube", "a cube is `max(abs(x), abs(y), abs(z)) <= 1`"),
    ("box", "a box is `max(abs(x)/2, abs(y), abs(z)) <= 1`"),
    ("cylinder", "a cylinder is `x^2 + y^2 <= 1 and abs(z) <= 2`"),
    ("cone", "a cone is `x^2 + y^2 = z^2`"),
    ("ellipsoid", "an ellipsoid is `x^2/4 + y^2 + z^2/9 = 1`"),
    ("octahedron", "an octahedron is `abs(x) + abs(y) + abs(z) = 1`"),
    ("gyroid", "a gyroid is `sin x cos y + sin y cos z + sin z cos x = 0`"),
];

/// Words that occur in formulas that are written in words.
const IN_WORDS: &[&str] =
    &["squared", "cubed", "plus", "minus", "times", "equals", "divided", "squareroot", "the"];

impl Builder<'_> {
    /// The error for a function that is not known.
    pub(crate) fn unknown_function(&self, name: &str, span: Span) -> Box<Error> {
        if let Some(kind) = unsupported_function(name) {
            return Error::new(span, kind);
        }
        if let Some(error) = self.in_words() {
            return error;
        }
        let kind = ErrorKind::UnknownFunction { name: short_name(name) };
        Error::new(span, kind)
            .suggest_optional(span, self.scope.suggest_name(name, &self.locals, true))
    }

    /// The error for a statement in words, such as "x squared"; `None` for other statements.
    fn in_words(&self) -> Option<Box<Error>> {
        // `domain ball` contains the name of a solid, but it is a line about the picture.
        if self.lexed.tokens.first().is_some_and(|first| first.kind.is_setting()) {
            return None;
        }
        let statement = self.lexed.span;
        let text = start(&self.text[statement.range()], MAX_NAME);
        let mut words = text.split(|c: char| !c.is_alphabetic());
        // In `cylinder(r = 1, h = 2)`, the equals signs only name the arguments.
        let is_called = self.lexed.tokens.get(1).is_some_and(|next| next.kind == OpenParen);
        let has_signs = self.lexed.tokens.iter().any(|token| {
            token.kind.is_arithmetic()
                || token.kind.is_inequality()
                || matches!(token.kind, Caret | Superscript)
                || token.kind == Equals && !is_called
        });
        let found = |word: &str| SOLIDS.iter().find(|(name, _)| word.eq_ignore_ascii_case(name));
        if let Some((_, formula)) = words.clone().find_map(found).filter(|_| !has_signs) {
            return Some(Error::new(statement, ErrorKind::Solid { formula }));
        }
        words
            .any(|word| IN_WORDS.contains(&word))
            .then(|| Error::new(statement, ErrorKind::InWords))
    }

    /// The brackets around `place`, if they end the statement and hold words: `x = 1 (a plane)`.
    fn bracketed_remark(&self, place: Span) -> Option<Span> {
        let tokens = &self.lexed.tokens;
        let close = tokens.last().filter(|last| last.kind == CloseParen)?;
        let open = tokens.iter().rposition(|token| token.kind == OpenParen).filter(|at| *at > 0)?;
        let is_behind =
            tokens[open - 1].kind.ends_operand() && tokens[open].span.end <= place.start;
        let words = &tokens[open + 1..tokens.len() - 1];
        let is_gap = tokens[open - 1].span.end < tokens[open].span.start;
        // After a number, a single word is a remark. After another value, the word may be a factor.
        let are_words = words.iter().all(|token| token.kind.is_name())
            && (words.len() > 1 || tokens[open - 1].kind == Number);
        (is_behind && is_gap && are_words).then(|| tokens[open].span.to(close.span))
    }

    /// The span of `f x y z` before an equals sign. Other languages read this as a call.
    fn call_without_brackets(&self, span: Span) -> Option<Span> {
        let is_first = self.lexed.span.start == span.start;
        let kinds = self.lexed.tokens.iter().map(|token| token.kind).take(5);
        (is_first && kinds.eq([TokenKind::Name, X, Y, Z, Equals]))
            .then(|| span.to(self.lexed.tokens[3].span))
    }

    /// The error for an unknown name.
    pub(crate) fn unknown(&self, name: &str, typed: &str, span: Span) -> Box<Error> {
        if let Some(error) = self.in_words() {
            return error;
        }
        let (scope, locals) = (self.scope, self.locals.as_slice());
        if let Some(words) = self.bracketed_remark(span) {
            let typed = &self.text[words.range()];
            return Error::new(words, ErrorKind::Remark).suggest(words, format!("# {typed}"));
        }
        if let Some(left) = self.call_without_brackets(span) {
            let kind = ErrorKind::UnknownFunction { name: short_name(name) };
            let meant = format!("{name}(x, y, z)");
            return Error::new(span, kind).suggest(left, meant);
        }
        // `2piu` is 2π·u.
        let is_parameter = matches!(name.strip_prefix("pi").unwrap_or(name), "u" | "v" | "s");
        if is_parameter && self.lexed.tokens[0].kind == PointWord {
            let other = |token: &Token| {
                let typed = &self.text[token.span.range()];
                matches!(typed, "u" | "v" | "s") && typed != name
            };
            let is_surface = self.lexed.tokens.iter().any(other);
            let kind = if is_surface { ErrorKind::Parametric } else { ErrorKind::CurveRange };
            return Error::new(span, kind);
        }
        if is_parameter && ["x", "y", "z"].iter().all(|axis| assigns(self.text, axis)) {
            return Error::new(span, ErrorKind::Parametric);
        }
        let after = self.text[span.end..].trim_start_matches(['}', ' ']);
        let below = after.strip_prefix(['/', '{']);
        if name == "d" && below.is_some_and(|below| below.trim_start().starts_with('d')) {
            return Error::new(span, ErrorKind::Calculus);
        }
        if token_kind(name).is_some_and(TokenKind::is_setting) && span.start > self.lexed.span.start
        {
            let name = name.to_owned();
            let at = Span::at(self.text[..span.start].trim_end().len());
            return Error::new(span, ErrorKind::SettingInLine { name }).suggest(at, ";");
        }
        let behind = self.text[span.end..].trim_start_matches([' ', '\t']);
        let begins =
            span.start == self.lexed.span.start && behind.len() < self.text.len() - span.end;
        if begins && behind.starts_with(|c: char| c.is_alphanumeric() || c == '#') {
            let words = SETTINGS.iter().map(|setting| setting.word);
            if let Some(meant) = nearest(name, words) {
                let kind = ErrorKind::UnknownName { name: short_name(name), letter: None };
                return Error::new(span, kind).suggest(span, meant);
            }
        }
        if let Some(powers) = scope.lost_superscripts(name, locals) {
            let name = name.to_owned();
            return Error::new(span, ErrorKind::LostSuperscript { name }).suggest(span, powers);
        }
        let is_called = self.text[span.end..].trim_start().starts_with(['(', '[']);
        if is_called && let Some(kind) = unsupported_function(name) {
            return Error::new(span, kind);
        }
        let kind = if is_called || typed.starts_with('\\') {
            ErrorKind::UnknownFunction { name: short_name(name) }
        } else {
            let letter = scope.missing_letter(name, locals);
            ErrorKind::UnknownName { name: short_name(name), letter }
        };
        Error::new(span, kind).suggest_optional(span, scope.suggest_name(name, locals, is_called))
    }
}

/// Kind of a part of a name.
#[derive(Clone, Copy, PartialEq, Eq)]
enum NamePart {
    Function,
    /// A value whose name is longer than a letter.
    Value,
    Letter,
    Number,
}

/// The error for a function of other systems that has no equivalent in this language.
fn unsupported_function(name: &str) -> Option<ErrorKind> {
    Some(match name {
        "integrate" | "Integrate" | "Dt" | "limit" | "Limit" => ErrorKind::Calculus,
        "SphericalPlot3D" | "RevolutionPlot3D" | "sphereplot" | "spherical_plot3d" => {
            ErrorKind::PlotCoordinates
        }
        "Surface" | "ParametricPlot3D" | "parametric_plot3d" | "Curve" | "fsurf" => {
            ErrorKind::Parametric
        }
        _ => return None,
    })
}

/// Returns whether `axis =` begins a line of `text`, or stands after a comma or a semicolon.
fn assigns(text: &str, axis: &str) -> bool {
    text.split(['\n', ',', ';']).any(|line| {
        let rest = line.trim_start().strip_prefix(axis);
        rest.is_some_and(|rest| rest.trim_start().starts_with('='))
    })
}

impl Scope {
    /// A suggestion for the name of an unused definition.
    pub fn meant(&self, name: &str, is_function: bool) -> Option<String> {
        self.lost_superscripts(name, &[]).or_else(|| self.suggest_name(name, &[], is_function))
    }

    /// `name` split into known names, if that is possible. Otherwise the closest known name.
    fn suggest_name(&self, name: &str, locals: &[Name], is_function: bool) -> Option<String> {
        // Computer algebra systems write `E` for the constant e.
        if name == "E" && !is_function {
            return Some("e".to_owned());
        }
        let doubled = self.without_doubled_letters(name, locals);
        let doubled = doubled.or_else(|| self.run_together(name, locals));
        doubled.or_else(|| self.nearest(name, locals, is_function))
    }

    /// Reads `sinn` as `sin`, if a function has the name without a doubled letter.
    fn without_doubled_letters(&self, name: &str, locals: &[Name]) -> Option<String> {
        if name.len() > MAX_NAME {
            return None;
        }
        let letters: Vec<char> = name.chars().collect();
        let pairs = (1..letters.len()).filter(|at| letters[*at] == letters[at - 1]);
        let mut shorter = pairs.map(|at| {
            letters.iter().enumerate().filter(|(other, _)| *other != at).map(|(_, c)| *c).collect()
        });
        let is_function =
            |name: &String| matches!(self.meaning(name, locals), NameMeaning::Function(_));
        shorter.find(is_function)
    }

    /// Reads `x2y` as `x^2*y`, if all letters are values. Copying often loses superscripts.
    fn lost_superscripts(&self, name: &str, locals: &[Name]) -> Option<String> {
        if name.len() > MAX_NAME || !name.contains(|c: char| c.is_ascii_digit()) {
            return None;
        }
        let mut powers = String::new();
        let mut previous = ' ';
        for character in name.chars() {
            if character.is_ascii_digit() {
                if !previous.is_ascii_digit() {
                    powers.push('^');
                }
            } else {
                if !self.is_value(character, locals) {
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

    /// The letter without a value in a short name such as `mx`, if there is exactly one.
    fn missing_letter(&self, name: &str, locals: &[Name]) -> Option<char> {
        // A longer name is a word rather than a product.
        if !matches!(name.chars().take(4).count(), 2 | 3) || !name.contains(['x', 'y', 'z']) {
            return None;
        }
        let mut missing = name.chars().filter(|letter| !self.is_value(*letter, locals));
        let letter = missing.next().filter(|letter| letter.is_alphabetic())?;
        missing.all(|other| other == letter).then_some(letter)
    }

    /// Reads the name in `xcos(r)` as values whose names are letters, and the function that is
    /// called.
    pub(crate) fn product_with_call<'n>(
        &self,
        name: &'n str,
        locals: &[Name],
    ) -> Option<(Vec<(&'n str, NamedValue)>, Callee)> {
        let parts = self.split(name, locals).filter(|_| name.len() <= MAX_NAME)?;
        let ((_, last), letters) = parts.split_last()?;
        let NameMeaning::Function(callee) = self.meaning(last, locals) else { return None };
        let value = |(kind, letter): &(NamePart, &'n str)| match self.meaning(letter, locals) {
            NameMeaning::Value(value) if *kind != NamePart::Number => Some((*letter, value)),
            _ => None,
        };
        Some((letters.iter().map(value).collect::<Option<_>>()?, callee))
    }

    /// Reads `xsin` as `x*sin`, `sin2x` as `sin(2x)` and `pix` as `pi*x`, if all parts are known.
    fn run_together(&self, name: &str, locals: &[Name]) -> Option<String> {
        if name.len() > MAX_NAME {
            return None;
        }
        let parts = self.split(name, locals)?;
        let mut text = String::new();
        let mut open = 0;
        for (index, (kind, part)) in parts.iter().enumerate() {
            let before = index.checked_sub(1).map(|before| parts[before].0);
            let is_last = index + 1 == parts.len();
            if *kind == NamePart::Function && !matches!(before, None | Some(NamePart::Function)) {
                text.extend(std::iter::repeat_n(')', std::mem::take(&mut open)));
            }
            if !matches!(before, None | Some(NamePart::Function | NamePart::Number)) {
                text.push('*');
            }
            match self.meaning(part, locals) {
                // `Cosy` is `cos(y)`.
                NameMeaning::Function(Callee::BuiltIn(name)) => text += &name,
                _ => text += part,
            }
            if *kind == NamePart::Function && !is_last {
                text.push('(');
                open += 1;
            }
        }
        text.extend(std::iter::repeat_n(')', open));
        Some(text)
    }

    /// Splits a name into functions, values and numbers. Tries long parts first. A number must
    /// follow a function. `None` if no split works, or if all parts are letters.
    fn split<'n>(&self, name: &'n str, locals: &[Name]) -> Option<Vec<(NamePart, &'n str)>> {
        // For each position, a split of the name from that position to the end. Filled backward.
        let mut found: Vec<Option<Vec<(NamePart, &str)>>> = vec![None; name.len() + 1];
        found[name.len()] = Some(Vec::new());
        for at in (0..name.len()).rev().filter(|at| name.is_char_boundary(*at)) {
            let ends = (at + 1..=name.len()).rev().filter(|end| name.is_char_boundary(*end));
            // At the start, the longest part is the whole name. That part is skipped, so even a
            // defined name is split.
            found[at] = ends.skip(usize::from(at == 0)).find_map(|end| {
                let rest = found[end].as_ref()?;
                let kind = self.part(&name[at..end], locals)?;
                let follows = rest.first().map(|(kind, _)| *kind);
                let is_read = match kind {
                    NamePart::Function => true,
                    NamePart::Number => {
                        !matches!(follows, Some(NamePart::Function | NamePart::Number))
                    }
                    NamePart::Value | NamePart::Letter => follows != Some(NamePart::Number),
                };
                is_read.then(|| [(kind, &name[at..end])].into_iter().chain(rest.clone()).collect())
            });
        }
        let parts = found.swap_remove(0)?;
        let says_more =
            parts.iter().any(|(kind, _)| matches!(kind, NamePart::Function | NamePart::Value));
        let begins = parts.first().is_some_and(|(kind, _)| *kind != NamePart::Number);
        // In `sine` and `pie`, the last letter is hardly Euler's number.
        let begins = begins && parts.last().is_some_and(|(_, part)| *part != "e");
        (says_more && begins && parts.len() > 1).then_some(parts)
    }

    /// The kind of `part`, if it has a meaning as a separate name.
    fn part(&self, part: &str, locals: &[Name]) -> Option<NamePart> {
        if part.bytes().all(|byte| byte.is_ascii_digit()) {
            return Some(NamePart::Number);
        }
        let is_letter = part.chars().nth(1).is_none();
        match self.meaning(part, locals) {
            NameMeaning::Value(_) if is_letter => Some(NamePart::Letter),
            NameMeaning::Value(_) => Some(NamePart::Value),
            NameMeaning::Function(callee) if !is_letter && read_as(part, &callee).is_none() => {
                Some(NamePart::Function)
            }
            _ => None,
        }
    }

    fn is_value(&self, letter: char, locals: &[Name]) -> bool {
        matches!(self.meaning(letter.encode_utf8(&mut [0; 4]), locals), NameMeaning::Value(_))
    }
}
