//! Notes on texts that people often mean otherwise: numbers of a list, which are read as factors,
//! lines that begin with a minus sign, and degrees without their sign.

use zeroset_ops::Op;
use zeroset_parser::tree::ast::{Expr, ExprKind, Function, Statement};
use zeroset_parser::tree::built_statement::BuiltStatement;
use zeroset_parser::{Note, NoteKind, Span};

/// Least whole number that is hardly an angle in radians: more than a turn.
const LEAST_DEGREES: f64 = 7.0;

/// The notes on all statements. With `in_degrees`, the text's own angles are in degrees.
pub(crate) fn likely_slips(text: &str, built: &[BuiltStatement], in_degrees: bool) -> Vec<Note> {
    let mut notes = Vec::new();
    for one in built {
        if let Statement::Draw { .. } = one.statement {
            notes.extend(number_of_list(text, one.span));
            notes.extend(line_with_minus(text, one.span));
        }
        if !in_degrees {
            let parts = one.statement.expressions().into_iter().flat_map(Expr::all_parts);
            notes.extend(parts.filter_map(degrees));
        }
    }
    notes
}

/// The note on `1. z = x^2`, `(1) z = x^2` and `z = x^2   (1)`.
fn number_of_list(text: &str, span: Span) -> Option<Note> {
    let typed = text.get(span.range())?.trim_end();
    let is_number = |number: &str| {
        !number.is_empty() && number.bytes().all(|c| c.is_ascii_digit() || c == b'.')
    };
    let (first, rest) = typed.split_once(' ').unwrap_or_default();
    let goes_on = rest.trim_start().starts_with(|c: char| c.is_alphabetic() || c == '(');
    let in_brackets = |word: &str| {
        word.strip_prefix('(').and_then(|rest| rest.strip_suffix(')')).is_some_and(is_number)
    };
    let is_first = first.strip_suffix('.').is_some_and(is_number) || in_brackets(first);
    let (before, last) = typed.rsplit_once(' ').unwrap_or_default();
    let place = if is_first && goes_on {
        Span::new(span.start, span.start + first.len())
    } else if in_brackets(last)
        && before.trim_end().ends_with(|c: char| c.is_ascii_digit() || "xyz".contains(c))
    {
        let end = span.start + typed.len();
        Span::new(end - last.len(), end)
    } else {
        return None;
    };
    let typed = text.get(place.range())?.to_owned();
    Some(Note { span: place, kind: NoteKind::NumberOfList { typed } })
}

/// The note on a line that begins with a minus sign, and may go on with the line above.
fn line_with_minus(text: &str, span: Span) -> Option<Note> {
    let sign = text.get(span.range())?.chars().next().filter(|c| "-−–".contains(*c))?;
    let line = text[..span.start].rfind('\n')?;
    let is_alone = text[line..span.start].trim().is_empty();
    let above = text[..line].rsplit('\n').next()?.trim();
    let place = Span::new(span.start, span.start + sign.len_utf8());
    (is_alone && !above.is_empty() && !above.starts_with('#'))
        .then_some(Note { span: place, kind: NoteKind::LineWithMinus })
}

/// The note on `rotate(s, 45)` and `sin(30)`.
fn degrees(expr: &Expr) -> Option<Note> {
    let ExprKind::Call(function, arguments) = &expr.kind else { return None };
    let ((Function::Builder("rotate"), [_, angle, ..])
    | (Function::Native(Op::Sin | Op::Cos | Op::Tan), [angle])) = (function, arguments.as_slice())
    else {
        return None;
    };
    let number = match &angle.kind {
        ExprKind::Negate(inner) => inner.number()?,
        _ => angle.number()?,
    };
    let is_whole =
        number.parse().is_ok_and(|angle: f64| angle.fract() == 0.0 && angle >= LEAST_DEGREES);
    let kind = NoteKind::LargeAngle { number: number.to_owned() };
    is_whole.then_some(Note { span: angle.span, kind })
}

#[cfg(test)]
mod tests {
    use crate::{Options, read};

    /// The notes of a text.
    fn notes(text: &str) -> String {
        let document = read(text, &Options::default()).expect(text);
        let notes = document.notes.iter().map(|note| note.message());
        notes.collect::<Vec<_>>().join("\n")
    }

    #[test]
    fn likely_slips_have_notes() {
        for (text, note) in [
            ("1. z = x^2 + y^2\n2. z = 4 - x^2", "`2.` is read as a factor"),
            ("2. x^2+y^2+z^2=1", "`2.` is read as a factor"),
            ("(2) x^2+y^2+z^2=1", "`(2)` is read as a factor"),
            ("x^2+y^2+z^2=1 (2)", "`(2)` is read as a factor"),
            ("x^2 + y^2 + z^2 = 1    (2.1)", "`(2.1)` is read as a factor"),
            ("z = x^2\n- y^2", "begins with a minus sign"),
            ("- x^2+y^2-z^2=1\n- z=1", "begins with a minus sign"),
            ("x^2/4\n− y^2/9\n= z", "begins with a minus sign"),
            ("rotate(box(2,1,1), 45) <= 0", "`45°`"),
            ("rotate(box(2,1,1), -30, (0,0,1)) <= 0", "`30°`"),
            ("z = sin(30)*x", "`30°`"),
            ("x*cos(45) - y*sin(45) = z", "`45°`"),
        ] {
            assert!(notes(text).contains(note), "{text}: {}", notes(text));
        }
        for text in [
            "2.5 x + y = z",
            "2.0*x + y = z",
            "-x = y",
            "z = x^2\n\n-x = z",
            "z = x^2\n  - y^2",
            "x = (2)",
            "f(a) = 2a; z = f (2)",
            "rotate(box(2,1,1), 45°) <= 0",
            "rotate(box(2,1,1), 3) <= 0",
            "z = sin(30x) + sin(2)",
        ] {
            let notes = notes(text);
            let is_slip =
                ["factor;", "minus sign", "radians"].iter().any(|one| notes.contains(one));
            assert!(!is_slip, "{text}: {notes}");
        }
    }
}
