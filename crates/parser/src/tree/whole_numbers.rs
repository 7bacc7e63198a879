//! Whole numbers that must be known to expand a formula: factorials and lengths of sums.

use crate::messages::error::{Error, ErrorKind, Fallible};
use crate::span::Span;
use crate::tree::ast::{Definition, Expr, ExprKind, Function, Name, NamedValue, Series};
use crate::tree::builder::{Builder, number_only};
use crate::tree::built_statement::BuiltStatement;
use rustc_hash::FxHashSet;
use zeroset_ops::Role;

impl Builder<'_> {
    /// Builds `n!` as `product(k = 1..n, k)`, which is exact. Fails if n varies over space or time,
    /// is negative, or contains a number that is not whole.
    #[inline(never)] // keeps its locals out of the stack frames of nested factors
    pub(crate) fn factorial(&mut self, base: Expr, sign: Span) -> Fallible<Expr> {
        number_only(&base)?;
        self.check_depth(base.span, 2)?;
        let varies = |part: &Expr| match &part.kind {
            ExprKind::Name(NamedValue::Coordinate(_) | NamedValue::Time) => true,
            ExprKind::Number(_) => part.whole_number().is_none(),
            _ => false,
        };
        let is_negative = matches!(base.kind, ExprKind::Negate(_));
        if is_negative || base.all_parts().into_iter().any(varies) {
            return Err(Error::new(sign, ErrorKind::UnexpectedCharacter { character: '!' }));
        }
        let is_free = |index: &&str| {
            let is_own =
                |part: &Expr| matches!(&part.kind, ExprKind::Name(name) if name.name() == *index);
            !base.all_parts().into_iter().any(is_own)
        };
        let text =
            (*["k", "j", "i", "l"].iter().find(|name| is_free(name)).unwrap_or(&"m")).to_owned();
        let span = base.span.to(sign);
        let body = Expr::new(ExprKind::Name(NamedValue::Local(text.clone())), sign);
        let index = Name { text, span: sign };
        let low = Expr::of_digits("1", base.span);
        let series = Series { is_product: true, index, low, high: base, step: None, body };
        Ok(Expr::new(ExprKind::Series(Box::new(series)), span))
    }
}

/// Names that determine a number of terms or repetitions, directly or through definitions.
pub fn term_count_names<'d>(
    definitions: &[(&'d Definition, &'d BuiltStatement)],
    drawings: &[&'d BuiltStatement],
) -> FxHashSet<&'d str> {
    let built = drawings.iter().copied().chain(definitions.iter().map(|(_, built)| *built));
    let mut names: FxHashSet<&str> = FxHashSet::default();
    for expr in built.flat_map(|built| built.statement.expressions()) {
        for part in expr.all_parts() {
            let ends: Vec<&Expr> = match &part.kind {
                ExprKind::Series(series) => {
                    [&series.low, &series.high].into_iter().chain(&series.step).collect()
                }
                ExprKind::Call(Function::Iterate(_), arguments) => {
                    arguments.iter().take(1).collect()
                }
                ExprKind::Call(Function::Builder(name), arguments) => copies(name, arguments),
                _ => continue,
            };
            for part in ends.into_iter().flat_map(Expr::all_parts) {
                if let ExprKind::Name(NamedValue::Defined(name)) = &part.kind {
                    names.insert(name);
                }
            }
        }
    }
    let mut open: Vec<&str> = names.iter().copied().collect();
    while let Some(name) = open.pop() {
        let found = definitions.iter().filter(|(definition, _)| definition.name.text == name);
        for used in found.flat_map(|(_, built)| &built.used) {
            if names.insert(used) {
                open.push(used);
            }
        }
    }
    names
}

/// The arguments that may be the number of copies that the builder called `name` makes.
fn copies<'e>(name: &str, arguments: &'e [Expr]) -> Vec<&'e Expr> {
    let rows = zeroset_ops::builders(name).filter(|row| row.takes(arguments.len()));
    let place = |row: &zeroset_ops::Builder| {
        let place = row.parameters.iter().position(|(_, role)| *role == Role::Count)?;
        // Vectors, which may be written as three numbers, stand before the last parameter only.
        let is_last = place + 1 == row.parameters.len();
        if is_last { arguments.last() } else { arguments.get(place) }
    };
    rows.filter_map(place).collect()
}
