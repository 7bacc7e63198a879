//! Notes on texts that people often mean otherwise: numbers of a list, which are read as factors,
//! lines that begin with a minus sign, and degrees without their sign.

use zeroset_ops::Op;
use zeroset_parser::tree::ast::{Chain, Expr, ExprKind, Function, NamedValue, Relation, Statement};
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
        if let Statement::Draw { expr, .. } = &one.statement {
            notes.extend(expr.all_parts().into_iter().find_map(fraction_as_power));
        }
        if !in_degrees {
            let parts = one.statement.expressions().into_iter().flat_map(Expr::all_parts);
            notes.extend(parts.filter_map(degrees));
        }
    }
    notes.extend(slab(text, built));
    notes
}

/// The note on `x^2/3 + y^2/3`, whose exponents may have been 2/3.
fn fraction_as_power(expr: &Expr) -> Option<Note> {
    let ExprKind::Chain(Chain::Sum, first, rest) = &expr.kind else { return None };
    let terms = std::iter::once(&**first).chain(rest.iter().map(|(_, term)| term));
    let fraction = |term: &Expr| {
        let (power, below) = term.quotient()?;
        let ExprKind::Power(base, above) = &power.kind else { return None };
        let (above, below) = (above.whole_number()?, below.whole_number()?);
        let is_odd = below % 2 == 1 && above < below && below < 10;
        (is_odd && matches!(base.kind, ExprKind::Name(_)))
            .then(|| (term.clone(), base.to_string(), above, below))
    };
    let mut fractions = terms.filter_map(fraction);
    let (term, base, above, below) = fractions.next()?;
    let is_alike = fractions.any(|other| (other.2, other.3) == (above, below));
    let (read, exponent) = (term.to_string(), format!("{above}/{below}"));
    let kind = NoteKind::FractionAsPower { read, other: format!("{base}^({exponent})"), exponent };
    is_alike.then_some(Note { span: term.span, kind })
}

/// The note on `-5 < x < 5` beside one equation.
fn slab(text: &str, built: &[BuiltStatement]) -> Option<Note> {
    let all: Vec<(Span, &Expr)> = built
        .iter()
        .filter_map(|one| match &one.statement {
            Statement::Draw { expr, restrictions } if restrictions.is_empty() => {
                Some((one.span, expr))
            }
            _ => None,
        })
        .collect();
    let bounds = |expr: &Expr| match &expr.kind {
        ExprKind::Compare(first, rest) => match rest.as_slice() {
            [(relation, middle), (_, last)] => {
                let is_coordinate =
                    matches!(middle.kind, ExprKind::Name(NamedValue::Coordinate(_)));
                let is_constant = |side: &Expr| {
                    !side.all_parts().iter().any(|part| matches!(part.kind, ExprKind::Name(_)))
                };
                *relation != Relation::Equal
                    && is_coordinate
                    && is_constant(first)
                    && is_constant(last)
            }
            _ => false,
        },
        _ => false,
    };
    let is_equation = |expr: &Expr| {
        matches!(&expr.kind, ExprKind::Compare(_, rest)
            if matches!(rest.as_slice(), [(Relation::Equal, _)]))
    };
    let slabs: Vec<_> = all.iter().filter(|(_, expr)| bounds(expr)).collect();
    let (span, _) = slabs.first()?;
    let mut others = all.iter().filter(|(_, expr)| !bounds(expr));
    let ((other, expr), None) = (others.next()?, others.next()) else { return None };
    let typed = |span: &Span| text.get(span.range()).map(str::trim);
    let conditions: Option<Vec<&str>> = slabs.iter().map(|(span, _)| typed(span)).collect();
    let line = format!("{} {{{}}}", typed(other)?, conditions?.join(", "));
    is_equation(expr).then_some(Note { span: *span, kind: NoteKind::SlabBeside { line } })
}

/// The note on `2. z = x^2` and `(2) z = x^2`, where no other line is numbered.
fn number_of_list(text: &str, span: Span) -> Option<Note> {
    let is_number = |number: &str| {
        !number.is_empty() && number.bytes().all(|c| c.is_ascii_digit() || c == b'.')
    };
    let (first, rest) = text.get(span.range())?.split_once(' ')?;
    let goes_on = rest.trim_start().starts_with(|c: char| c.is_alphabetic() || c == '(');
    let in_brackets = first.strip_prefix('(').and_then(|rest| rest.strip_suffix(')'));
    let is_first = first.strip_suffix('.').or(in_brackets).is_some_and(is_number);
    let place = Span::new(span.start, span.start + first.len());
    let kind = NoteKind::NumberOfList { typed: first.to_owned() };
    (is_first && goes_on).then_some(Note { span: place, kind })
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
            ("2. x^2+y^2+z^2=1", "`2.` is read as a factor"),
            ("(2) x^2+y^2+z^2=1", "`(2)` is read as a factor"),
            ("z = x^2\n- y^2 = 1", "begins with a minus sign"),
            ("a = 2\n-x^2 + a*z", "begins with a minus sign"),
            ("rotate(box(2,1,1), 45) <= 0", "`45°`"),
            ("rotate(box(2,1,1), -30, (0,0,1)) <= 0", "`30°`"),
            ("z = sin(30)*x", "`30°`"),
            ("z = x^-1/2", "`(x^-1)/2`; for the root, write `1/sqrt(x)`"),
            ("x^2/3 + y^2/3 = 1", "exponent 2/3, write `x^(2/3)`"),
            ("-5<x<5; z=x*y", "write `z=x*y {-5<x<5}`"),
            ("z=x*y\n-1<=x<=1\n0<=y<=2", "write `z=x*y {-1<=x<=1, 0<=y<=2}`"),
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
            "x^2/9 + y^2/4 = 1",
            "x^2/3 + y^2/5 = 1",
            "-5<x<5",
            "-5<x<5; x^2+y^2<1",
        ] {
            let notes = notes(text);
            let is_slip = ["factor;", "minus sign", "radians", "exponent", "slab"]
                .iter()
                .any(|one| notes.contains(one));
            assert!(!is_slip, "{text}: {notes}");
        }
    }
}
