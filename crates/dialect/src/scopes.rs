//! The scopes of blocks: a declaration in a block hides a variable until the block ends.

use crate::effects::is_doubled;
use crate::language::Language;
use crate::program_reader::{Frame, ProgramReader};
use crate::program_words::Words;
use rustc_hash::FxHashSet;
use zeroset_parser::lex::token::{Token, bracketed};
use zeroset_parser::lex::token_kind::TokenKind::{Comma, Component, Equals, OpenParen};
use zeroset_parser::tree::ast::{ExprKind, NamedValue};

/// A declared variable, and the former meaning of its name.
#[derive(Clone)]
pub(crate) struct Declared {
    name: String,
    meaning: Option<ExprKind>,
    was_integer: bool,
    size: Option<usize>,
}

impl ProgramReader<'_> {
    /// Records that `name` is declared in the current block.
    pub(crate) fn declare(&mut self, name: &str, is_whole: bool, frame: &mut Frame) {
        if frame.is_inner() && self.language.has_assignments() {
            let global = self.defined_names.contains(name);
            let global = global.then(|| ExprKind::Name(NamedValue::Defined(name.to_owned())));
            frame.declared.push(Declared {
                name: name.to_owned(),
                meaning: frame.before(name).or(global),
                was_integer: frame.integers.contains(name),
                size: frame.size(name),
            });
        }
        if is_whole {
            frame.integers.insert(name.to_owned());
            if !frame.is_inner() {
                self.integers.insert(name.to_owned());
            }
        } else {
            frame.integers.remove(name);
        }
    }
}

impl Frame {
    /// Number of components of the variable `name`, if it was declared or assigned.
    pub(crate) fn size(&self, name: &str) -> Option<usize> {
        self.set.iter().rfind(|(set, _)| set == name).map(|(_, size)| *size)
    }

    /// Ends a block whose first declaration has the number `mark`.
    pub(crate) fn leave_scope(&mut self, mark: usize) {
        for declared in self.declared.split_off(mark.min(self.declared.len())).into_iter().rev() {
            let Declared { name, meaning, was_integer, size } = declared;
            if was_integer {
                self.integers.insert(name.clone());
            } else {
                self.integers.remove(&name);
            }
            if let Some(size) = size {
                self.set.push((name.clone(), size));
            }
            if let Some(meaning) = meaning {
                self.aliases.push(name, meaning);
            }
        }
    }

    /// Returns whether this frame declares `name`, or has it as a parameter.
    pub(crate) fn hides(&self, name: &str) -> bool {
        let parameters = self.function.as_ref().and_then(|head| head.parameters.as_ref());
        self.declared.iter().any(|declared| declared.name == name)
            || parameters.is_some_and(|all| all.iter().any(|given| given.text == name))
    }
}

impl Words<'_> {
    /// The variables outside functions whose values are not known while the text is read, because
    /// a function or a later assignment changes them.
    pub(crate) fn mutable_globals(
        self,
        statements: &[Vec<Token>],
        language: Language,
    ) -> FxHashSet<String> {
        let mut found = FxHashSet::default();
        if language == Language::OpenScad {
            // The last of several assignments counts, even above it.
            let mut seen = FxHashSet::default();
            let names = statements.iter().filter_map(|tokens| self.assignment(tokens));
            let names = names.map(|(name, _, _)| self.word(name).to_owned());
            found.extend(names.filter(|name| !seen.insert(name.clone())));
        }
        if !language.has_assignments() {
            return found;
        }
        let mut globals: FxHashSet<&str> = FxHashSet::default();
        for tokens in statements {
            let mut rest = tokens.clone();
            while let Some((_, _, _, more)) = self.function(&rest) {
                rest = more;
            }
            let types = self.types(&rest);
            let declared = if types > 0 { &rest[types..] } else { &[][..] };
            globals.extend(declared.iter().map(|token| self.word(*token)));
        }
        globals.remove("");
        for tokens in statements {
            let mut rest = tokens.clone();
            while let Some((_, _, body, more)) = self.function(&rest) {
                let changed = (0..body.len()).filter(|at| self.may_change(&body, *at));
                let names = changed.map(|at| self.word(body[at]));
                found.extend(names.filter(|name| globals.contains(name)).map(str::to_owned));
                rest = more;
            }
        }
        found
    }

    /// Returns whether the name at `at` may be changed: it is assigned, or is an argument.
    pub(crate) fn may_change(self, tokens: &[Token], at: usize) -> bool {
        if !tokens[at].kind.is_name() {
            return false;
        }
        let next = at + 1 + usize::from(tokens.get(at + 1).is_some_and(|t| t.kind == Component));
        let is_assigned = tokens.get(next).is_some_and(|sign| {
            sign.kind == Equals && self.assigns(tokens, next)
                || tokens.get(next + 1).is_some_and(|equals| {
                    equals.kind == Equals && sign.span.end == equals.span.start
                })
        });
        let is_argument = at > 0
            && matches!(tokens[at - 1].kind, OpenParen | Comma)
            && tokens.get(next).is_some_and(|sign| sign.kind == Comma || sign.kind.is_closer())
            && self.text.contains("out ");
        is_assigned
            || is_argument
            || is_doubled(tokens, next)
            || at > 1 && is_doubled(tokens, at - 2)
    }

    /// Returns whether the token at `at` is the equals sign of an assignment.
    pub(crate) fn assigns(self, tokens: &[Token], at: usize) -> bool {
        let Some(equals) = tokens.get(at).filter(|token| token.kind == Equals) else {
            return false;
        };
        let typed = &self.text[equals.span.range()];
        let is_arrow = self.text[equals.span.end..].starts_with('>');
        typed == "=" && !is_arrow
    }

    /// The tokens in the brackets at the end of `tokens`, if they are a single pair.
    pub(crate) fn inside(tokens: &[Token]) -> Option<&[Token]> {
        bracketed(tokens).filter(|(_, rest)| rest.is_empty()).map(|(inner, _)| inner)
    }
}
