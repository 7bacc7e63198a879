//! Recognizes the language of a program. The meaning of effects, quotients and angles depends on
//! it.

use crate::program_words::{Words, is_type};
use zeroset_parser::lex::token::{Token, closing};
use zeroset_parser::lex::token_kind::TokenKind::{Bar, Equals, Greater, OpenBrace, OpenParen, Or};

/// Turns each `||` into one token. These languages have no absolute values in bars.
pub(crate) fn join_bars(tokens: &mut Vec<Token>) {
    let mut joined: Vec<Token> = Vec::with_capacity(tokens.len());
    for token in tokens.drain(..) {
        match joined.last_mut() {
            Some(last)
                if last.kind == Bar && token.kind == Bar && last.span.end == token.span.start =>
            {
                *last = Token::new(Or, last.span.to(token.span));
            }
            _ => joined.push(token),
        }
    }
    *tokens = joined;
}

/// The language of a program, as far as meanings depend on it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Language {
    /// No program.
    #[default]
    Plain,
    /// GLSL, HLSL or C: variables have types, and quotients of integers are truncated.
    Typed,
    /// `JavaScript`, Rust and others with bodies in braces.
    Script,
    Python,
    OpenScad,
}

impl Language {
    /// The language of a text with these statements.
    pub(crate) fn of(words: Words<'_>, statements: &[Vec<Token>]) -> Self {
        let any = |test: &dyn Fn(&[Token]) -> bool| statements.iter().any(|tokens| test(tokens));
        let is_python = |tokens: &[Token]| {
            words.word(tokens[0]) == "def" && Words::python_function(tokens).is_some()
                || words.has(tokens, "lambda")
        };
        let has_arrow = |tokens: &[Token]| {
            tokens.windows(2).any(|pair| {
                (pair[0].kind, pair[1].kind) == (Equals, Greater)
                    && pair[0].span.end == pair[1].span.start
            })
        };
        if any(&is_python) {
            Self::Python
        } else if any(&|tokens| words.is_of_openscad(tokens)) {
            Self::OpenScad
        } else if any(&|tokens| words.declares_typed_name(tokens)) {
            Self::Typed
        } else if any(&|tokens| words.has_body(tokens) || has_arrow(tokens)) {
            Self::Script
        } else {
            Self::Plain
        }
    }

    /// Returns whether `||` can only mean "or".
    pub(crate) fn has_double_bars(self) -> bool {
        matches!(self, Self::Typed | Self::Script | Self::OpenScad)
    }

    /// Returns whether an assignment is an expression.
    pub(crate) fn has_assignments(self) -> bool {
        matches!(self, Self::Typed | Self::Script)
    }
}

impl Words<'_> {
    /// Returns whether a statement declares a name with a type of numbers or vectors, such as
    /// `float`. Words such as `let` are no such type.
    fn declares_typed_name(self, tokens: &[Token]) -> bool {
        let types = &tokens[..self.types(tokens)];
        types.iter().any(|token| {
            let word = self.word(*token);
            let is_other = matches!(
                word,
                "let"
                    | "var"
                    | "const"
                    | "function"
                    | "fn"
                    | "local"
                    | "auto"
                    | "static"
                    | "public"
                    | "in"
                    | "poly"
                    | "nonlocal"
                    | "global"
                    | "inline"
            );
            is_type(word) && !is_other
        })
    }

    /// Returns whether a statement is a function of `OpenSCAD`: `function f(x) = …`, or
    /// `f = function(x) …;`. R has the latter without the semicolon.
    fn is_of_openscad(self, tokens: &[Token]) -> bool {
        let ends = |at: usize| tokens.get(at..).and_then(closing).map(|end| at + end + 1);
        let is_named = tokens.len() > 4
            && self.word(tokens[0]) == "function"
            && tokens[2].kind == OpenParen
            && ends(2).and_then(|end| tokens.get(end)).is_some_and(|next| next.kind == Equals);
        let is_literal = tokens.len() > 5
            && tokens[1].kind == Equals
            && self.word(tokens[2]) == "function"
            && tokens[3].kind == OpenParen
            && ends(3).and_then(|end| tokens.get(end)).is_some_and(|next| next.kind != OpenBrace)
            && self.ends_with_semicolon(tokens);
        is_named || is_literal
    }

    /// Returns whether a semicolon follows the statement.
    pub(crate) fn ends_with_semicolon(self, tokens: &[Token]) -> bool {
        let end = tokens.last().map_or(0, |last| last.span.end);
        self.text[end..].trim_start_matches([' ', '\t']).starts_with(';')
    }
}
