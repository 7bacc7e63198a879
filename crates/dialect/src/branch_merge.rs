//! Merges the sides of a branch into choices between two values. The result of a function that
//! returns early may also be a choice. The choices' definitions are not in the text.

use crate::known_numbers::number_of;
use crate::program_reader::{Frame, ProgramReader};
use rustc_hash::FxHashMap;
use std::collections::BTreeSet;
use zeroset_parser::Span;
use zeroset_parser::tree::aliases::Aliases;
use zeroset_parser::tree::ast::{
    Definition, Expr, ExprKind, Function, Name, NamedValue, Statement,
};
use zeroset_parser::tree::built_statement::BuiltStatement;
use zeroset_parser::tree::raw_statement::Head;

use crate::control_flow::{EXIT_LEVEL, RESULT, more_than};
use crate::saved::flag_of;

impl ProgramReader<'_> {
    /// Adds a definition that is not in the text. Returns a reference to the definition.
    pub(crate) fn synthesize(&mut self, name: &str, body: ExprKind, frame: &Frame) -> ExprKind {
        let span = frame.function.as_ref().map_or(Span::default(), |head| head.name.span);
        let (Head { name, parameters }, kind) = self.synthesized_head(name, span, frame);
        let body = Expr::new(body, span);
        let definition = Definition { name, parameters, body, range: None };
        self.program
            .synthesized
            .push(BuiltStatement::synthesized(Statement::Define(definition), span));
        kind
    }

    /// Creates the left side of a generated definition, and an expression for the defined value.
    pub(crate) fn synthesized_head(
        &mut self,
        name: &str,
        span: Span,
        frame: &Frame,
    ) -> (Head, ExprKind) {
        let text = self.fresh(&frame.generated_name(name));
        self.program.generated.insert(text.clone());
        let (parameters, kind) = frame.call(&text);
        (Head { name: Name { text, span }, parameters }, kind)
    }

    /// Merges the two sides of a branch. Where `condition` holds, each variable has its value from
    /// the frame `yes`; elsewhere, its value from the frame `no`.
    pub(crate) fn merge(&mut self, frame: &mut Frame, yes: &Frame, no: &Frame, condition: &Expr) {
        let before = frame.aliases.clone();
        let base = newest(&before);
        let (first, second) = (newest(&yes.aliases), newest(&no.aliases));
        let names: BTreeSet<&str> = first.keys().chain(second.keys()).copied().collect();
        for name in names {
            // A value that was saved on one side is not used after the branch.
            let is_saved = name.starts_with('#');
            if is_saved && !(first.contains_key(name) && second.contains_key(name)) {
                continue;
            }
            let kind = match [&first, &second].map(|side| side.get(name).copied().cloned()) {
                [Some(a), Some(b)] if a == b && base.get(name) == Some(&&a) => continue,
                [Some(a), Some(b)] if a == b => a,
                [Some(a), Some(b)] => self.chosen(name, condition, a, b, frame),
                [Some(one), None] | [None, Some(one)] => {
                    let is_first = first.contains_key(name);
                    let global = self.defined_names.contains(name)
                        || matches!(name, "p" | "pos") && frame.function.is_none();
                    let global =
                        global.then(|| ExprKind::Name(NamedValue::Defined(name.to_owned())));
                    match frame.before(name).or(global) {
                        Some(old) if is_first => self.chosen(name, condition, one, old, frame),
                        Some(old) => self.chosen(name, condition, old, one, frame),
                        None => one,
                    }
                }
                [None, None] => continue,
            };
            if base.get(name) != Some(&&kind) {
                frame.aliases.push(name.to_owned(), kind);
            }
        }
        for side in [yes, no] {
            for (name, size) in side.set.iter().skip(frame.set.len()) {
                if !frame.set.iter().any(|(other, _)| other == name) {
                    frame.set.push((name.clone(), *size));
                }
            }
        }
        for side in [yes, no] {
            frame.counters.extend(side.counters.iter().cloned());
        }
        frame.has_result |= yes.has_result || no.has_result;
    }

    /// A value that is `yes` where the condition holds, else `no`. Two flags are merged as numbers.
    fn chosen(
        &mut self,
        name: &str,
        condition: &Expr,
        yes: ExprKind,
        no: ExprKind,
        frame: &Frame,
    ) -> ExprKind {
        if yes == no {
            return yes;
        }
        if let (Some(a), Some(b)) = (flag_of(&yes), flag_of(&no)) {
            let number = self.chosen(name, condition, a.clone(), b.clone(), frame);
            return more_than(number, 0.0).kind;
        }
        let span = condition.span;
        let piece = (condition.clone(), Expr::new(yes, span));
        let body = ExprKind::Choice(vec![piece], Some(Box::new(Expr::new(no, span))));
        self.synthesize(name, body, frame)
    }

    /// Ends a function or the program. Adds the value that a branch or loop returned, if there is
    /// one.
    pub(crate) fn end(&mut self, frame: &Frame, span: Span) {
        let Some(left) = frame.exit_level() else { return };
        let Some(result) = frame.aliases.find(RESULT).filter(|_| !frame.has_result) else {
            return;
        };
        let result = Expr::new(result.clone(), span);
        let body = if number_of(left).is_some() {
            result
        } else {
            let piece = (more_than(left.clone(), 0.0), result);
            Expr::new(ExprKind::Choice(vec![piece], None), span)
        };
        let statement = match &frame.function {
            Some(head) => {
                let Head { name, parameters } = head.clone();
                self.defined_names.insert(name.text.clone());
                Statement::Define(Definition { name, parameters, body, range: None })
            }
            None => Statement::Draw { expr: body, restrictions: Vec::new() },
        };
        self.program.synthesized.push(BuiltStatement::synthesized(statement, span));
    }
}

/// The newest value of each name in `aliases`.
fn newest(aliases: &Aliases) -> FxHashMap<&str, &ExprKind> {
    let mut newest = FxHashMap::default();
    for (name, kind) in aliases.iter() {
        newest.entry(name).or_insert(kind);
    }
    newest
}

impl Frame {
    /// A copy of the frame for an inner branch or loop.
    pub(crate) fn inner(&self) -> Self {
        Self { nested: self.nested + 1, ..self.clone() }
    }

    /// Returns whether the frame is inside a function, an inlined call, a branch or a loop.
    pub(crate) fn is_inner(&self) -> bool {
        self.function.is_some() || self.prefix.is_some() || self.nested > 0
    }

    /// Name for a generated definition of the variable `name`. The text may already use that name.
    pub(crate) fn generated_name(&self, name: &str) -> String {
        let name = if name.starts_with('#') { "value" } else { name };
        match (&self.prefix, &self.function) {
            (Some(prefix), _) => format!("{prefix}_{name}"),
            (None, Some(function)) => format!("{}_{name}", function.name.text),
            (None, None) => format!("{name}_2"),
        }
    }

    /// Parameters of the generated definition `name`, and an expression that calls it.
    pub(crate) fn call(&self, name: &str) -> (Option<Vec<Name>>, ExprKind) {
        let parameters = self.function.as_ref().and_then(|head| head.parameters.clone());
        let kind = match &parameters {
            None => ExprKind::Name(NamedValue::Defined(name.to_owned())),
            Some(parameters) => {
                let local = |name: &Name| {
                    let value = NamedValue::Local(name.text.clone());
                    Expr::new(ExprKind::Name(value), name.span)
                };
                let function = Function::Defined(name.to_owned());
                ExprKind::Call(function, parameters.iter().map(local).collect())
            }
        };
        (parameters, kind)
    }

    /// The number that records an early exit; `None` if there was certainly no exit.
    pub(crate) fn exit_level(&self) -> Option<&ExprKind> {
        self.aliases.find(EXIT_LEVEL).filter(|left| number_of(left) != Some(0.0))
    }

    /// The value of a variable before a branch; `None` if it had no value.
    pub(crate) fn before(&self, name: &str) -> Option<ExprKind> {
        if name == EXIT_LEVEL {
            return Some(ExprKind::Number("0".to_owned()));
        }
        if let Some(kind) = self.aliases.find(name) {
            return Some(kind.clone());
        }
        let parameters = self.function.as_ref()?.parameters.as_ref()?;
        let is_parameter = parameters.iter().any(|parameter| parameter.text == name);
        is_parameter.then(|| ExprKind::Name(NamedValue::Local(name.to_owned())))
    }

    /// The value of the variable `name`. If there is none, a reference to the document's `name`.
    pub(crate) fn meaning(&self, name: &str) -> ExprKind {
        let document = || ExprKind::Name(NamedValue::Defined(name.to_owned()));
        self.before(name).unwrap_or_else(document)
    }
}
