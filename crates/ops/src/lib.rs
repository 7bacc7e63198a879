//! The table of operations that `zeroset` can compute, one row each.
//!
//! A native [`Op`] is a node of the expression graph with its own interval rule. A [`Composed`]
//! function is a formula over other functions, in the language itself. A [`Builder`] makes or moves
//! a solid. All share one name space with the special forms. Name look-up, completion, help,
//! suggestions, random generators and table-driven tests use [`TABLE`], [`COMPOSED`], [`BUILDERS`]
//! and [`FORMS`]. This crate knows only names and properties: it neither computes nor parses.

mod builders;
mod class;
mod composed;
mod forms;
mod op;
mod secants;
mod table;

pub use builders::{BUILDERS, Builder, Distance, Role, builders};
pub use class::{Class, Law, Parity, Restriction, Rounding};
pub use composed::{COMPOSED, Composed, Sequence};
pub use forms::{Differential, FORMS, FormKind, SpecialForm, VectorFunction, form};
pub use op::{Continuity, Domain, Notation, Op, OpRow, Secant};
pub use table::TABLE;

/// Returns the native operation that a user may call by this name or alias, in exact spelling.
///
/// Infix and internal operations have names for printing, but a user cannot call them by name. If
/// operations of different arity share the name, the result is the first one in the table; see
/// [`natives`].
pub fn native(name: &str) -> Option<&'static OpRow> {
    natives(name).next()
}

/// Returns all native operations that a user may call by `name`, one per arity.
pub fn natives(name: &str) -> impl Iterator<Item = &'static OpRow> {
    callable().filter(move |row| row.name == name || row.aliases.contains(&name))
}

/// Returns all native operations that a user may call.
fn callable() -> impl Iterator<Item = &'static OpRow> {
    TABLE.iter().filter(|row| {
        matches!(row.notation, Notation::Function | Notation::Infix { callable: true, .. })
    })
}

/// Returns the composed functions with this name or alias, in exact spelling, one per arity.
pub fn composed(name: &str) -> impl Iterator<Item = &'static Composed> {
    COMPOSED.iter().filter(move |f| f.name == name || f.aliases.contains(&name))
}

/// Returns every name that can be called, with aliases, in the order of the tables.
pub fn names() -> impl Iterator<Item = &'static str> {
    let native = callable().map(|row| (row.name, row.aliases));
    let composed = COMPOSED.iter().map(|f| (f.name, f.aliases));
    let builders = BUILDERS.iter().map(|f| (f.name, f.aliases));
    let forms = FORMS.iter().map(|f| (f.name, f.aliases));
    let all = native.chain(composed).chain(builders).chain(forms);
    all.flat_map(|(name, aliases)| std::iter::once(name).chain(aliases.iter().copied()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashMap;

    #[test]
    fn rows_stand_in_the_order_of_the_enum() {
        for (index, row) in TABLE.iter().enumerate() {
            assert_eq!(row.op as usize, index, "{}", row.name);
            assert_eq!(row.op.row().name, row.name);
        }
    }

    #[test]
    fn columns_agree_with_each_other() {
        for row in TABLE {
            let (arity, infix) = match row.class {
                Class::Negation => (1, true),
                Class::Square | Class::Function(_) => (1, false),
                Class::Sum | Class::Product | Class::Quotient | Class::Power => (2, true),
                Class::Remainder
                | Class::Extremum
                | Class::Fallback
                | Class::Restriction(_)
                | Class::FunctionOfTwo => (2, false),
                Class::Choice => (3, false),
            };
            assert_eq!(row.arity, arity, "{}", row.name);
            assert_eq!(matches!(row.notation, Notation::Infix { .. }), infix, "{}", row.name);
            let is_function = matches!(row.class, Class::Function(_));
            assert!(arity == 1 || row.parity == Parity::Neither, "{}", row.name);
            assert!(is_function || (row.values.is_empty() && row.quotient.is_none()));
            if let Class::Function(Law::Undoes(inner)) = row.class {
                let domain = inner.row().domain;
                assert!(matches!(domain, Domain::All | Domain::Positive), "{}", row.name);
            }
        }
    }

    #[test]
    fn no_name_means_two_things() {
        let mut seen: HashMap<(&str, usize), &str> = HashMap::new();
        // An operation that cannot be called has a name only for printing, so it is skipped.
        for row in TABLE.iter().filter(|row| native(row.name).is_some()) {
            for name in std::iter::once(&row.name).chain(row.aliases) {
                assert!(seen.insert((name, usize::from(row.arity)), row.name).is_none(), "{name}");
            }
        }
        for f in COMPOSED {
            for name in std::iter::once(&f.name).chain(f.aliases) {
                assert!(seen.insert((name, f.parameters.len()), f.name).is_none(), "{name}");
            }
        }
        let mut last = "";
        for f in BUILDERS {
            let own = (f.name != last).then_some(&f.name);
            for name in own.into_iter().chain(f.aliases) {
                assert!(!seen.keys().any(|(other, _)| other == name), "{name}");
                assert!(seen.insert((name, usize::MAX), f.name).is_none(), "{name}");
            }
            last = f.name;
        }
        for f in FORMS {
            for name in std::iter::once(&f.name).chain(f.aliases) {
                assert!(!seen.keys().any(|(other, _)| other == name), "{name}");
                assert!(seen.insert((name, usize::MAX), f.name).is_none(), "{name}");
            }
        }
    }

    #[test]
    fn look_up_finds_names_and_aliases_only() {
        assert_eq!(native("log").map(|row| row.op), Some(Op::Ln));
        assert_eq!(native("pow").map(|row| row.op), Some(Op::Pow));
        assert_eq!(natives("atan").map(|row| row.op).collect::<Vec<_>>(), [Op::Atan, Op::Atan2]);
        assert!(native("select_negative").is_none());
        assert_eq!(composed("hypot").count(), 3);
        assert!(names().any(|name| name == "smoothstep"));
    }
}
