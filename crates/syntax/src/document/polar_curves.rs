//! A note on polar curves such as `r = 2 cos(2 theta)`: they have parts with r < 0 and with angles
//! beyond a turn, which the coordinates r and theta of a point do not have.

use crate::document::implied_coordinates::{AZIMUTH, CYLINDER_RADIUS};
use crate::hints::renamed;
use crate::lower::constant::evaluate_text;
use rustc_hash::FxHashMap;
use zeroset_parser::tree::ast::{
    Chain, Definition, Expr, ExprKind, Function, NamedValue, Relation, Statement,
};
use zeroset_parser::tree::built_statement::BuiltStatement;
use zeroset_parser::{Limits, Note, NoteKind};

/// Longest right side that a note repeats, in characters.
const LONGEST: usize = 100;
/// Number of angles in a turn at which a right side is evaluated.
const ANGLES: u32 = 24;
/// Largest number of turns after which a curve may close.
const MOST_TURNS: u32 = 4;

/// The note on the first equation `r = f(theta)` whose curve has more than the equation.
pub(crate) fn polar_curves(built: &[BuiltStatement], limits: &Limits) -> Option<Note> {
    let definitions: FxHashMap<&str, &Definition> = built
        .iter()
        .filter_map(|one| match &one.statement {
            Statement::Define(definition) => Some((definition.name.text.as_str(), definition)),
            _ => None,
        })
        .collect();
    let is = |name: &str, body: &str| {
        definitions.get(name).is_some_and(|definition| definition.body.to_string() == body)
    };
    let angle = ["theta", "phi"].into_iter().find(|name| is(name, AZIMUTH))?;
    if !is("r", CYLINDER_RADIUS) {
        return None;
    }
    built.iter().find_map(|one| {
        let sides = one.statement.expressions().into_iter().find_map(radius)?;
        let line = missing_parts(sides, angle, &definitions, limits)?;
        let kind = NoteKind::PolarCurve { angle: angle.to_owned(), line };
        Some(Note { span: one.span, kind })
    })
}

/// The right side of an equation `r = f`.
fn radius(expr: &Expr) -> Option<&Expr> {
    match &expr.kind {
        ExprKind::Compare(left, rest) if left.kind.defined() == Some("r") => {
            match rest.as_slice() {
                [(Relation::Equal, right)] => Some(right),
                _ => None,
            }
        }
        _ => None,
    }
}

/// The whole curve as a line, if the function of the angle `angle` is negative somewhere or does
/// not repeat after a turn.
fn missing_parts(
    function: &Expr,
    angle: &str,
    definitions: &FxHashMap<&str, &Definition>,
    limits: &Limits,
) -> Option<String> {
    let parts = function.all_parts();
    let is_unread = |part: &&Expr| match &part.kind {
        ExprKind::Name(NamedValue::Defined(name)) => {
            name != angle
                && definitions.get(name.as_str()).is_none_or(|one| one.body.number().is_none())
        }
        ExprKind::Name(name) => !matches!(name, NamedValue::Constant(_)),
        ExprKind::Call(Function::Defined(_), _) => true,
        _ => false,
    };
    let typed = function.to_string();
    let has_angle = parts.iter().any(|part| part.kind.defined() == Some(angle));
    if !has_angle || parts.iter().any(is_unread) || typed.chars().count() > LONGEST {
        return None;
    }
    let value = |steps: u32| {
        let angle_here = format!("({steps}*pi/{})", ANGLES / 2);
        let text = renamed(&typed, |word| match definitions.get(word) {
            _ if word == angle => Some(angle_here.clone()),
            Some(definition) => Some(format!("({})", definition.body)),
            None => None,
        });
        let value = evaluate_text(&text, limits).ok()?;
        Some(f64::midpoint(value.bounds().lo, value.bounds().hi))
    };
    let values: Vec<Option<f64>> = (0..=ANGLES * MOST_TURNS).map(value).collect();
    // Values that differ by rounding are the same.
    let is_near = |a: f64, b: f64| (a - b).abs() <= 1e-9 * (1.0 + a.abs());
    let repeats = |turns: &u32| {
        let shift = (turns * ANGLES) as usize;
        let pairs = values.iter().zip(values.iter().skip(shift));
        pairs.clone().next().is_some()
            && pairs.into_iter().all(|pair| {
                matches!(pair, (Some(a), Some(b)) if is_near(*a, *b)) || *pair.0 == *pair.1
            })
    };
    let turns = (1..MOST_TURNS).find(repeats);
    let is_negative = values.iter().flatten().any(|value| *value < -1e-9);
    if turns == Some(1) && !is_negative {
        return None;
    }
    let names = ["s", "u", "v"];
    let parameter = names.into_iter().find(|name| !definitions.contains_key(name))?;
    let curve = renamed(&typed, |word| (word == angle).then(|| parameter.to_owned()));
    let is_sum = matches!(function.kind, ExprKind::Chain(Chain::Sum, ..) | ExprKind::Negate(_));
    let factor = if is_sum { format!("({curve})") } else { curve };
    let end = 2 * turns.unwrap_or(2);
    Some(format!(
        "({factor}*cos({parameter}), {factor}*sin({parameter}), 0) for {parameter} in [0, {end}pi]"
    ))
}

#[cfg(test)]
mod tests {
    use crate::{Options, read};
    use zeroset_parser::NoteKind;

    /// The line that a text's note gives for a whole polar curve.
    fn line(text: &str) -> Option<String> {
        let document = read(text, &Options::default()).expect(text);
        document.notes.into_iter().find_map(|note| match note.kind {
            NoteKind::PolarCurve { line, .. } => Some(line),
            _ => None,
        })
    }

    #[test]
    fn parts_of_polar_curves_that_are_missing_have_a_note() {
        for (text, whole) in [
            ("r = 2 cos(2 theta)", "(2*cos(2*s)*cos(s), 2*cos(2*s)*sin(s), 0) for s in [0, 2pi]"),
            (
                "curve r = 1 + 2cos(theta), z = 0",
                "((1 + 2*cos(s))*cos(s), (1 + 2*cos(s))*sin(s), 0) for s in [0, 2pi]",
            ),
            ("curve r = theta, z = 0", "(s*cos(s), s*sin(s), 0) for s in [0, 4pi]"),
            ("r = theta", "(s*cos(s), s*sin(s), 0) for s in [0, 4pi]"),
            ("r = 3cos(phi/2)", "(3*cos(s/2)*cos(s), 3*cos(s/2)*sin(s), 0) for s in [0, 4pi]"),
            (
                "s = 2; r = s*sin(3theta)",
                "(s*sin(3*u)*cos(u), s*sin(3*u)*sin(u), 0) for u in [0, 2pi]",
            ),
        ] {
            assert_eq!(line(text).as_deref(), Some(whole), "{text}");
            let definitions = if text.starts_with("s = ") { "s = 2\n" } else { "" };
            read(&format!("{definitions}{whole}"), &Options::default()).expect(whole);
        }
        for text in [
            "r = 2",
            "r = 1 + cos(theta)",
            "r = 3 + sin(5theta)",
            "r = z + theta",
            "r^2 = cos(2theta)",
        ] {
            assert_eq!(line(text), None, "{text}");
        }
    }
}
