//! What names of a program stand for at a place: a list that grows at its end and shares what is
//! before, so that each statement can keep its own.

use crate::tree::ast::ExprKind;
use std::rc::Rc;

/// Names and what they stand for, the last of a name counting.
#[derive(Clone, Default)]
pub(crate) struct Aliases(Option<Rc<AliasEntry>>);

struct AliasEntry {
    name: String,
    kind: ExprKind,
    before: Aliases,
    /// How many there are, with those before.
    count: usize,
}

impl Aliases {
    /// How many names were given.
    pub(crate) fn len(&self) -> usize {
        self.0.as_ref().map_or(0, |entry| entry.count)
    }

    /// Gives a name.
    pub(crate) fn push(&mut self, name: String, kind: ExprKind) {
        let before = std::mem::take(self);
        let count = before.len() + 1;
        self.0 = Some(Rc::new(AliasEntry { name, kind, before, count }));
    }

    /// Names and what they stand for, the last given first.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (&str, &ExprKind)> {
        std::iter::successors(self.0.as_deref(), |entry| entry.before.0.as_deref())
            .map(|entry| (entry.name.as_str(), &entry.kind))
    }

    /// What `name` stands for.
    pub(crate) fn find(&self, name: &str) -> Option<&ExprKind> {
        self.iter().find(|(other, _)| *other == name).map(|(_, kind)| kind)
    }
}
