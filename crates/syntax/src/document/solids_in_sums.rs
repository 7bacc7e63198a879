//! Notes on solids that may be meant otherwise: sums and differences of them, which add numbers and
//! join nothing, and a cylinder of `OpenSCAD`.

use rustc_hash::FxHashSet;
use zeroset_parser::tree::ast::{
    Chain, ChainSign, Definition, Expr, ExprKind, Function, NamedValue, Statement,
};
use zeroset_parser::tree::built_statement::BuiltStatement;
use zeroset_parser::{MAX_NOTES, Note, NoteKind};

/// Longest line that a note gives, in characters.
const LONGEST: usize = 100;

/// Notes on all sums of which every term is a solid: each gives the line that joins the solids.
pub(crate) fn solids_in_sums(built: &[BuiltStatement]) -> Vec<Note> {
    let mut names = FxHashSet::default();
    for one in built {
        if let Statement::Define(definition) = &one.statement
            && is_solid(&definition.body, &names)
        {
            names.insert(definition.name.text.as_str());
        }
    }
    let mut notes: Vec<Note> = Vec::new();
    for one in built {
        let parts = one.statement.expressions().into_iter().flat_map(Expr::all_parts);
        let sums = parts.filter_map(|part| Some((part, joined(part, &names)?)));
        notes.extend(sums.map(|(sum, joined)| {
            let meant = Some(line(&one.statement, sum, joined))
                .filter(|line| line.chars().count() <= LONGEST);
            let meant = meant.unwrap_or_else(|| "subtract(a, b)` or `union(a, b)".to_owned());
            Note { span: sum.span, kind: NoteKind::SolidsInSum { meant } }
        }));
        if notes.len() > MAX_NOTES {
            break;
        }
    }
    // The rounds of a loop have their notes at the same place.
    let mut seen = FxHashSet::default();
    notes.retain(|note| seen.insert(note.span.start));
    notes
}

/// The note on `cylinder(5, 3);`, if the text is such a line: programs end so.
pub(crate) fn cylinder_of_openscad(text: &str, built: &[BuiltStatement]) -> Option<Note> {
    let [BuiltStatement { statement: Statement::Draw { expr, .. }, span, .. }] = built else {
        return None;
    };
    let is_cylinder = matches!(
        &expr.kind, ExprKind::Call(Function::Builder("cylinder"), given) if given.len() == 2
    );
    (is_cylinder && text.trim_end().ends_with(';'))
        .then_some(Note { span: *span, kind: NoteKind::CylinderOfOpenscad })
}

/// The statement with `joined` in place of `sum`, or `joined` if the sum is only a part.
fn line(statement: &Statement, sum: &Expr, joined: String) -> String {
    match statement {
        Statement::Draw { expr, restrictions } if restrictions.is_empty() => match &expr.kind {
            ExprKind::Chain(..) if expr == sum => format!("{joined} <= 0"),
            ExprKind::Compare(left, rest) if **left == *sum => match rest.as_slice() {
                [(relation, right)] => format!("{joined} {} {right}", relation.symbol()),
                _ => joined,
            },
            _ => joined,
        },
        Statement::Define(definition) if definition.body == *sum => Statement::Define(Definition {
            body: Expr::new(ExprKind::Name(NamedValue::Defined(joined)), sum.span),
            ..definition.clone()
        })
        .to_string(),
        _ => joined,
    }
}

/// Returns whether an expression is a call that makes a solid, or the name of one.
fn is_solid(expr: &Expr, names: &FxHashSet<&str>) -> bool {
    matches!(expr.kind, ExprKind::Call(Function::Builder(_), _))
        || expr.kind.defined().is_some_and(|name| names.contains(name))
}

/// The text that joins the terms of a sum, if all are solids.
fn joined(sum: &Expr, names: &FxHashSet<&str>) -> Option<String> {
    let ExprKind::Chain(Chain::Sum, first, rest) = &sum.kind else { return None };
    let are_solids = is_solid(first, names) && rest.iter().all(|(_, term)| is_solid(term, names));
    are_solids.then(|| {
        rest.iter().fold(first.to_string(), |joined, (sign, term)| match sign {
            ChainSign::Direct => format!("union({joined}, {term})"),
            ChainSign::Inverse => format!("subtract({joined}, {term})"),
        })
    })
}

#[cfg(test)]
mod tests {
    use crate::{Options, read};

    /// The line of each note on a sum of solids.
    fn lines(text: &str) -> Vec<String> {
        let document = read(text, &Options::default()).expect(text);
        let notes = document.notes.iter().map(|note| note.message());
        let line = |note: String| Some(note.split_once("solids are joined")?.1.to_owned());
        notes.filter_map(line).map(|rest| rest.split('`').nth(1).unwrap().to_owned()).collect()
    }

    #[test]
    fn a_cylinder_of_openscad_has_a_note() {
        let has_note = |text: &str| {
            let notes = read(text, &Options::default()).expect(text).notes;
            notes.iter().any(|note| note.message().contains("in OpenSCAD, the height is first"))
        };
        assert!(has_note("cylinder(5, 3);") && has_note("cylinder(5, 3) ;\n"));
        for text in ["cylinder(5, 3)", "cylinder(5, 3) <= 0;", "a = 1; cylinder(a, 3);"] {
            assert!(!has_note(text), "{text}");
        }
    }

    #[test]
    fn sums_of_solids_get_the_line_that_joins_them() {
        for (text, line) in [
            ("sphere(1) - box(0.5)", "subtract(sphere(1), box(0.5)) <= 0"),
            ("sphere(1) - box(0.5) <= 0", "subtract(sphere(1), box(0.5)) <= 0"),
            ("sphere(1) + box(0.5)", "union(sphere(1), box(0.5)) <= 0"),
            (
                "box(1) - sphere(1.2) - cylinder(0.3, 2)",
                "subtract(subtract(box(1), sphere(1.2)), cylinder(0.3, 2)) <= 0",
            ),
            ("(sphere(1)) - (box(0.5))", "subtract(sphere(1), box(0.5)) <= 0"),
            ("A = sphere(1); B = box(0.5); A - B", "subtract(A, B) <= 0"),
            ("A = sphere(1); B = translate(A, 1, 0, 0); A + B <= 0", "union(A, B) <= 0"),
            ("peg(h) = cylinder(0.3, h); box(1) - peg(2)", "subtract(box(1), peg(2)) <= 0"),
            ("S = sphere(1) - box(0.5); S <= 0", "S = subtract(sphere(1), box(0.5))"),
            (
                "translate(sphere(1), 1, 0, 0) - torus(1, 0.2) = 0",
                "subtract(translate(sphere(1), 1, 0, 0), torus(1, 0.2)) = 0",
            ),
        ] {
            assert_eq!(lines(text), [line], "{text}");
        }
        for text in ["sphere(1) - 0.1 <= 0", "max(sphere(1), -box(0.5)) <= 0", "sphere(1) = box(1)"]
        {
            assert!(lines(text).is_empty(), "{text}");
        }
    }
}
