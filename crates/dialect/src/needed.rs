//! Drops the definitions of a notebook that nothing drawn needs. They may use functions that have
//! no meaning here.

use crate::program_reader::{ProgramReader, Unread};
use rustc_hash::{FxHashMap, FxHashSet};
use zeroset_parser::lex::spelling::plain_name;
use zeroset_parser::lex::token::bracketed;
use zeroset_parser::lex::token_kind::TokenKind::{Equals, OpenParen, Saved};
use zeroset_parser::tree::aliases::saved_name;
use zeroset_parser::tree::ast::{Expr, ExprKind, Name, Statement};
use zeroset_parser::tree::raw_statement::{RawStatement, ValueConversion};
use zeroset_parser::{Error, Fallible};

impl ProgramReader<'_> {
    /// Drops the definitions that nothing drawn needs. Without drawings, the function or value that
    /// the program defines last counts as drawn.
    ///
    /// # Errors
    /// If the drawings need a name whose statement was left out, or there is nothing to draw.
    pub(crate) fn drop_unneeded(&mut self) -> Fallible<()> {
        if !self.is_python && self.unread.is_empty() {
            return Ok(());
        }
        // The names that each definition uses, and where its last statement begins.
        let mut uses: FxHashMap<String, (Vec<String>, usize)> = FxHashMap::default();
        let mut open: Vec<String> = Vec::new();
        let mut is_drawn = false;
        for raw in &self.program.statements {
            let is_setting = raw.head.is_none() && raw.lexed.tokens[0].kind.is_setting();
            match self.defined_name(raw) {
                Some(name) => {
                    let (used, start) = uses.entry(name).or_default();
                    used.extend(self.used_by(raw));
                    *start = raw.lexed.span.start;
                }
                None if is_setting => {}
                None => {
                    is_drawn = true;
                    open.extend(self.used_by(raw));
                }
            }
        }
        for built in &self.program.synthesized {
            let used = built.used.iter().cloned();
            if let Statement::Define(one) = &built.statement {
                uses.entry(one.name.text.clone()).or_default().0.extend(used);
            } else {
                is_drawn = true;
                open.extend(used);
            }
        }
        if !is_drawn {
            open.extend(self.last_defined());
        }
        let has_nothing = !is_drawn && uses.is_empty();
        if !is_drawn && open.is_empty() {
            open.extend(uses.keys().cloned());
        }
        let mut needed: FxHashSet<String> = FxHashSet::default();
        while let Some(name) = open.pop() {
            if needed.insert(name.clone()) {
                open.extend(uses.get(&name).into_iter().flat_map(|(used, _)| used).cloned());
            }
        }
        // A function may use a name to which a later statement gives another value.
        let is_later = |name: &String, error: &Error| {
            let start = uses.get(name).map_or(0, |(_, start)| *start);
            needed.contains(name) && start <= error.span.start
        };
        let error = self.unread.iter().rfind(|Unread { key, names, error }| {
            has_nothing || needed.contains(key) || names.iter().any(|name| is_later(name, error))
        });
        if let Some(Unread { error, .. }) = error {
            return Err(error.clone());
        }
        let statements = std::mem::take(&mut self.program.statements).into_iter();
        let is_needed = |name: &String| needed.contains(name);
        self.program.statements = statements
            .filter(|raw| self.defined_name(raw).as_ref().is_none_or(is_needed))
            .collect();
        self.program.synthesized.retain(|built| match &built.statement {
            Statement::Define(one) => is_needed(&one.name.text),
            _ => true,
        });
        self.program.notes.extend(self.program.left_out.take());
        Ok(())
    }

    /// The name that counts as drawn in a program without drawings: its last function of a point,
    /// or its last value.
    fn last_defined(&self) -> Option<String> {
        let last = self.program.last_function.as_ref().or(self.program.last_value.as_ref());
        let is_drawn = |name: &Name, parameters: Option<&Vec<Name>>| {
            let names = parameters.into_iter().flatten().map(|name| name.text.as_str());
            let is_point = names.clone().eq(["x", "y", "z"]) || names.eq(["x", "y"]);
            is_point && !self.program.generated.contains(&name.text)
        };
        // A function with branches is synthesized, after all statements.
        let of_branches = self.program.synthesized.iter().rev().find_map(|built| {
            let Statement::Define(one) = &built.statement else { return None };
            is_drawn(&one.name, one.parameters.as_ref()).then_some(&one.name)
        });
        let of_point = of_branches.or_else(|| {
            self.program.statements.iter().rev().find_map(|raw| {
                let head = raw.head.as_ref()?;
                is_drawn(&head.name, head.parameters.as_ref()).then_some(&head.name)
            })
        });
        last.or(of_point).map(|name| name.text.clone())
    }

    /// The name that a statement defines; `None` if it draws or sets something.
    fn defined_name(&self, raw: &RawStatement) -> Option<String> {
        if let Some(head) = &raw.head {
            return Some(head.name.text.clone());
        }
        let tokens = &raw.lexed.tokens;
        let (first, rest) = tokens.split_first()?;
        let is_sign = |at: usize| {
            let equals = rest.get(at).filter(|sign| sign.kind == Equals);
            equals.is_some_and(|sign| &self.words.text[sign.span.range()] == "=")
        };
        let is_call = rest.first().is_some_and(|open| open.kind == OpenParen);
        let end = bracketed(rest).filter(|_| is_call).map_or(0, |(inner, _)| inner.len() + 2);
        let is_defined = first.kind.is_name() && !first.kind.is_axis() && is_sign(end);
        is_defined.then(|| plain_name(self.words.word(*first)))
    }

    /// The names of definitions that a statement uses.
    fn used_by(&self, raw: &RawStatement) -> Vec<String> {
        let mut names = Vec::new();
        for token in &raw.lexed.tokens {
            let name = match token.kind {
                Saved => saved_name(token.number),
                _ => plain_name(self.words.word(*token)),
            };
            match raw.aliases.find(&name) {
                Some(kind) => names.extend(defined_in(kind)),
                None if !name.is_empty() => names.push(name),
                None => {}
            }
        }
        if let Some(ValueConversion::Write { before, .. }) = &raw.conversion {
            names.extend(defined_in(before));
        }
        names
    }
}

/// The names of definitions that an expression uses.
fn defined_in(kind: &ExprKind) -> Vec<String> {
    let expr = Expr::new(kind.clone(), zeroset_parser::Span::default());
    let parts = expr.all_parts().into_iter().filter_map(|part| part.kind.defined());
    parts.map(str::to_owned).collect()
}
