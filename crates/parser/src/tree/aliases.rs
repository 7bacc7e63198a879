//! Aliases: the names of a program's variables, each with an expression for the variable. A list of
//! aliases grows at its end and shares earlier entries, so each statement can keep its own list.

use crate::tree::ast::ExprKind;
use std::rc::Rc;

/// A list of names, each with its expression. The latest entry for a name counts.
#[derive(Clone, Default)]
pub struct Aliases(Option<Rc<AliasEntry>>);

struct AliasEntry {
    name: String,
    kind: ExprKind,
    before: Aliases,
    /// Number of entries in the list up to this entry.
    count: usize,
}

/// The name of a saved value, which no variable has.
pub fn saved_name(number: u32) -> String {
    format!("#{number}")
}

impl Aliases {
    /// Number of entries.
    pub fn count(&self) -> usize {
        self.0.as_ref().map_or(0, |entry| entry.count)
    }

    /// Adds an entry, which hides earlier entries with the same name.
    pub fn push(&mut self, name: String, kind: ExprKind) {
        let before = std::mem::take(self);
        let count = before.count() + 1;
        self.0 = Some(Rc::new(AliasEntry { name, kind, before, count }));
    }

    /// The names and their expressions, latest first.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &ExprKind)> {
        std::iter::successors(self.0.as_deref(), |entry| entry.before.0.as_deref())
            .map(|entry| (entry.name.as_str(), &entry.kind))
    }

    /// The expression that `name` stands for; `None` if `name` is not in the list.
    pub fn find(&self, name: &str) -> Option<&ExprKind> {
        self.iter().find(|(other, _)| *other == name).map(|(_, kind)| kind)
    }
}
