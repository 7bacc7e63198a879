//! Rewrites functions of Python's libraries that take lists and options. Drops methods that keep
//! the value. Nothing here knows what a name means.

use crate::lists::{joined, joint_of, separated};
use crate::program_words::Words;
use zeroset_parser::Span;
use zeroset_parser::lex::token::{Token, bracketed, in_brackets, outside, split};
use zeroset_parser::lex::token_kind::TokenKind::{self, *};

/// Methods that only change the form or the type of an array or a formula.
const NEUTRAL: &str = "ravel flatten copy astype reshape squeeze transpose tolist item cpu numpy detach view \
    contiguous float double doit simplify expand evalf factor swapaxes clone to";

/// Options of functions that do not change the value.
const OPTIONS: &str =
    "axis dtype keepdims order dim keepdim device indexing copy evaluate sparse endpoint";

/// The sign that joins the values of a list which a function takes in place of several values.
fn joint(word: &str) -> Option<TokenKind> {
    match word {
        "add" | "Add" => Some(Plus),
        "multiply" | "Mul" => Some(Star),
        "logical_and" | "logical_or" | "Max" | "Min" => Some(Comma),
        _ => joint_of(word),
    }
}

/// Returns whether `word` is among `words`, which blanks separate.
fn lists(words: &str, word: &str) -> bool {
    words.split_whitespace().any(|one| one == word)
}

impl Words<'_> {
    /// Rewrites the calls and methods in `tokens`, at any depth.
    pub(crate) fn numpy(self, tokens: &[Token]) -> Vec<Token> {
        let mut out: Vec<Token> = Vec::with_capacity(tokens.len());
        let mut rest = tokens;
        while let Some(first) = rest.first().copied() {
            if let Some(after) = self.after_neutral(rest) {
                rest = after;
                continue;
            }
            let Some((inner, after)) = bracketed(rest) else {
                let kind = match first.kind {
                    Ampersand => And,
                    Bar => Or,
                    kind => kind,
                };
                out.push(Token { kind, ..first });
                rest = &rest[1..];
                continue;
            };
            let inner = self.numpy(inner);
            self.brackets(&mut out, first, &inner, rest[rest.len() - after.len() - 1]);
            rest = after;
        }
        out
    }

    /// The tokens after a method that keeps the value, such as `.ravel()`.
    fn after_neutral(self, tokens: &[Token]) -> Option<&[Token]> {
        let [dot, name, rest @ ..] = tokens else { return None };
        let is_neutral = self.is_dot(*dot) && lists(NEUTRAL, self.word(*name));
        bracketed(rest).filter(|_| is_neutral && rest[0].kind == OpenParen).map(|(_, rest)| rest)
    }

    /// Appends brackets with their rewritten contents to `out`, which ends with the called name.
    fn brackets(self, out: &mut Vec<Token>, open: Token, inner: &[Token], close: Token) {
        let is_call = open.kind == OpenParen && out.last().is_some_and(|last| last.kind.is_name());
        if !is_call {
            out.push(open);
            // An index such as `[:, 0]` or `[..., 0]` selects a component of all points.
            let skipped = match inner {
                [first, comma, ..]
                    if open.kind == OpenBracket
                        && matches!(first.kind, Colon | Dots)
                        && comma.kind == Comma =>
                {
                    2
                }
                _ => 0,
            };
            out.extend(&inner[skipped..]);
            out.push(close);
            return;
        }
        let mut parts = split(inner, Comma);
        parts.retain(|part| !self.is_neutral_option(part));
        self.unreduced(out, &mut parts);
        let word = out.last().map_or("", |last| self.word(*last));
        if word == "vectorize" {
            out.pop();
            out.extend(inner);
            return;
        }
        if let Some(value) = self.rewritten(word, &parts) {
            out.pop();
            out.extend(value);
            return;
        }
        if let [only] = parts.as_slice()
            && let Some(joint) = joint(word)
            && let Some(list) = self.values_of(only)
        {
            if joint != Comma {
                out.pop();
                out.extend(joined(&list, joint));
                return;
            }
            parts = list;
        }
        out.push(open);
        out.extend(separated(&parts));
        out.push(close);
    }

    fn is_neutral_option(self, part: &[Token]) -> bool {
        matches!(part, [name, equals, ..]
            if equals.kind == Equals && lists(OPTIONS, self.word(*name)))
    }

    /// Turns `np.maximum.reduce(list)` and `reduce(np.maximum, list)` into `maximum(list)`.
    fn unreduced(self, out: &mut Vec<Token>, parts: &mut Vec<Vec<Token>>) {
        if out.last().is_none_or(|last| self.word(*last) != "reduce") {
            return;
        }
        if let [.., name, dot, _] = out.as_slice()
            && self.is_dot(*dot)
            && name.kind.is_name()
        {
            out.truncate(out.len() - 2);
        } else if let [function, list] = parts.as_slice()
            && let [name] = function.as_slice()
        {
            let (name, list) = (*name, list.clone());
            out.pop();
            out.push(name);
            *parts = vec![list];
        }
    }

    /// The values of a list or tuple. A set, and a generator as in `[a for b in c]`, are no lists.
    fn values_of(self, part: &[Token]) -> Option<Vec<Vec<Token>>> {
        self.list_items(part).filter(|values| part[0].kind != OpenBrace && !values.is_empty())
    }

    /// The value of a call of `word`, if it is written in another form here.
    fn rewritten(self, word: &str, parts: &[Vec<Token>]) -> Option<Vec<Token>> {
        match (word, parts) {
            ("full_like", [_, value, ..]) => Some(in_brackets(value)),
            ("zeros_like", [value, ..]) => Some(joined(&[value.clone(), value.clone()], Minus)),
            ("zeros", [value, ..]) => {
                let [name, dot, shape] = value.as_slice() else { return None };
                let is_shape = self.is_dot(*dot) && self.word(*shape) == "shape";
                is_shape.then(|| joined(&[vec![*name], vec![*name]], Minus))
            }
            ("select", [conditions, values, last @ ..]) => {
                let values = self.values_of(values)?;
                let last = last.first().map(|last| self.without_option(last, "default"));
                self.choice(conditions, values, last)
            }
            ("piecewise", [argument, conditions, functions]) => {
                let functions = self.values_of(functions)?.into_iter();
                let value = |function: Vec<Token>| match function.len() {
                    // A number or name stands for itself.
                    ..3 => Some(function),
                    _ => self.applied(&function, std::slice::from_ref(argument)),
                };
                let mut values = functions.map(value).collect::<Option<Vec<Vec<Token>>>>()?;
                let count = self.values_of(conditions)?.len();
                let last = (values.len() > count).then(|| values.pop()).flatten();
                self.choice(conditions, values, last)
            }
            // Where the condition fails, there is no value.
            ("where", [condition, value, other]) if self.is_nan(other) => {
                let sign = |kind| Token::new(kind, Span::at(condition[0].span.start));
                let mut all = vec![sign(OpenBrace)];
                all.extend(condition);
                all.push(sign(Colon));
                all.extend(in_brackets(value));
                all.push(sign(CloseBrace));
                Some(in_brackets(&all))
            }
            ("polyval", [list, argument]) => {
                let mut values = self.values_of(list)?.into_iter();
                let mut sum = values.next()?;
                for value in values {
                    let product = joined(&[in_brackets(&sum), in_brackets(argument)], Star);
                    sum = joined(&[product, in_brackets(&value)], Plus);
                }
                Some(in_brackets(&sum))
            }
            _ => None,
        }
    }

    /// The value of the option `name = value`; other tokens as they are.
    fn without_option(self, part: &[Token], name: &str) -> Vec<Token> {
        match part {
            [word, equals, value @ ..] if equals.kind == Equals && self.word(*word) == name => {
                value.to_vec()
            }
            _ => part.to_vec(),
        }
    }

    /// A choice with these conditions and values. `last` is the value where no condition holds.
    fn choice(
        self,
        conditions: &[Token],
        values: Vec<Vec<Token>>,
        last: Option<Vec<Token>>,
    ) -> Option<Vec<Token>> {
        let conditions = self.values_of(conditions)?;
        if conditions.len() != values.len() {
            return None;
        }
        let place = conditions[0][0].span.start;
        let sign = |kind| Token::new(kind, Span::at(place));
        let mut all = vec![sign(OpenBrace)];
        let mut last = last.filter(|last| !self.is_nan(last));
        for (index, (condition, value)) in conditions.into_iter().zip(values).enumerate() {
            let is_rest = matches!(condition.as_slice(), [word] if self.word(*word) == "True");
            if is_rest {
                last = Some(value);
                break;
            }
            if index > 0 {
                all.push(sign(Comma));
            }
            all.extend(condition);
            all.push(sign(Colon));
            all.extend(in_brackets(&value));
        }
        if let Some(last) = last {
            all.push(sign(Comma));
            all.extend(in_brackets(&last));
        }
        all.push(sign(CloseBrace));
        Some(in_brackets(&all))
    }

    fn is_nan(self, value: &[Token]) -> bool {
        matches!(value, [nan] if self.word(*nan).eq_ignore_ascii_case("nan"))
    }

    /// Returns whether a statement holds a sign or a string that no formula has.
    pub(crate) fn has_unknown(tokens: &[Token]) -> bool {
        tokens.iter().any(|token| token.kind == Unknown)
    }

    /// The arguments of the first call of `word` in `tokens`, and the tokens before the call.
    pub(crate) fn call_of<'t>(
        self,
        tokens: &'t [Token],
        word: &str,
    ) -> Option<(&'t [Token], Vec<Vec<Token>>)> {
        let at = tokens.iter().position(|token| self.word(*token) == word)?;
        tokens.get(at + 1).filter(|open| open.kind == OpenParen)?;
        let (inner, _) = bracketed(&tokens[at + 1..])?;
        Some((&tokens[..at], split(inner, Comma)))
    }

    /// Index of the equals sign of an assignment outside brackets; `None` for other statements.
    pub(crate) fn assigned_at(self, tokens: &[Token]) -> Option<usize> {
        outside(tokens, Equals).filter(|at| *at > 0 && self.assigns(tokens, *at))
    }
}
