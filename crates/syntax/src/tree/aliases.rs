//! Names of a program's variables and the expressions they stand for. The list is persistent: it
//! grows at its end and shares its earlier entries, so each statement can keep a list of its own.

use crate::tree::ast::ExprKind;
use std::rc::Rc;

/// Names and the expressions they stand for. The latest entry of a name wins.
#[derive(Clone, Default)]
pub(crate) struct Aliases(Option<Rc<AliasEntry>>);

struct AliasEntry {
    name: String,
    kind: ExprKind,
    before: Aliases,
    /// Number of entries, including those before this one.
    count: usize,
}

impl Aliases {
    /// Number of entries.
    pub(crate) fn len(&self) -> usize {
        self.0.as_ref().map_or(0, |entry| entry.count)
    }

    /// Adds an entry, which hides earlier ones of the same name.
    pub(crate) fn push(&mut self, name: String, kind: ExprKind) {
        let before = std::mem::take(self);
        let count = before.len() + 1;
        self.0 = Some(Rc::new(AliasEntry { name, kind, before, count }));
    }

    /// The names and their expressions, latest first.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (&str, &ExprKind)> {
        std::iter::successors(self.0.as_deref(), |entry| entry.before.0.as_deref())
            .map(|entry| (entry.name.as_str(), &entry.kind))
    }

    /// The expression that `name` stands for.
    pub(crate) fn find(&self, name: &str) -> Option<&ExprKind> {
        self.iter().find(|(other, _)| *other == name).map(|(_, kind)| kind)
    }
}
