//! Hints on notations of textbooks: points with names, vectors in angle brackets, indices in place
//! of letters, and arguments with names.

use super::pattern::{calls, filled, matched, pieces, renamed};
use super::{Mistake, Proposal};
use zeroset_parser::ErrorKind;

/// Names of the arguments of solids, in the order of the arguments. Halves and doubles follow: a
/// height is given by its half, and a diameter by the radius.
#[rustfmt::skip] // one row a line
const ARGUMENTS: &[(&str, &[&str], &str)] = &[
    ("sphere", &["r"], "sphere(R)"),
    ("sphere", &["radius"], "sphere(R)"),
    ("sphere", &["d"], "sphere(R/2)"),
    ("cylinder", &["r", "h"], "cylinder(R, H/2)"),
    ("cylinder", &["radius", "height"], "cylinder(R, H/2)"),
    ("cylinder", &["d", "h"], "cylinder(R/2, H/2)"),
    ("cone", &["r", "h"], "cone(R, H/2)"),
    ("cone", &["r1", "r2", "h"], "cone(R, H, K/2)"),
    ("torus", &["r1", "r2"], "torus(R, H)"),
    ("torus", &["R", "r"], "torus(R, H)"),
];

/// Letters that stand for the arguments of a row of [`ARGUMENTS`].
const LETTERS: [char; 3] = ['R', 'H', 'K'];

/// Proposals for notations that have one meaning.
pub(super) fn proposals(mistake: &Mistake<'_>) -> Vec<Proposal> {
    let mut all: Vec<Proposal> = of_indices(mistake).into_iter().collect();
    all.extend(in_angle_brackets(mistake));
    all.extend(named_points(mistake));
    all.extend(named_value(mistake));
    all.extend(with_color(mistake));
    all.extend(named_arguments(mistake));
    all.extend(in_braces(mistake));
    all
}

/// Advice on notations that have no line.
pub(super) fn unread(mistake: &Mistake<'_>) -> Option<String> {
    let is_pair = |pattern: &str| {
        matched(pattern, mistake.line).is_some_and(|parts| {
            let is_name = |letter| {
                parts.get(&letter).is_some_and(|part| part.chars().all(char::is_alphabetic))
            };
            is_name('K') && is_name('M')
        })
    };
    if is_pair("N(K, M) = (A, B, C)") || is_pair("N(K, M) = <A, B, C>") {
        return Some(
            "write the coordinates and the ranges of both parameters: \
             `(cos u cos v, sin u cos v, sin v) for u in [0, 2pi], v in [-pi/2, pi/2]`"
                .to_owned(),
        );
    }
    let size = matched("size U V", mistake.line).or_else(|| matched("size UxV", mistake.line))?;
    Some(format!(
        "how large a picture is stands at the command: write `--size {}x{}`",
        size[&'U'], size[&'V']
    ))
}

/// `x_1`, `x_2` and `x_3` as the coordinates x, y and z.
fn of_indices(mistake: &Mistake<'_>) -> Option<Proposal> {
    let index = |word: &str| {
        let index = word.strip_prefix('x')?;
        let index = index.strip_prefix('_').unwrap_or(index);
        ["1₁", "2₂", "3₃"]
            .iter()
            .position(|signs| signs.chars().any(|one| index == one.to_string()))
    };
    let words: Vec<&str> =
        pieces(mistake.line).into_iter().map(|piece| &mistake.line[piece]).collect();
    let has = |wanted: usize| words.iter().any(|word| index(word) == Some(wanted));
    let is_plain = !words.iter().any(|word| matches!(*word, "x" | "y" | "z"));
    let line = renamed(mistake.line, |word| Some(["x", "y", "z"][index(word)?].to_owned()));
    (is_plain && has(0) && has(1)).then(|| Proposal::new("the coordinates are x, y and z", line))
}

/// `r(t) = <cos t, sin t, t>` as a curve, and `<1, 2, 3>` as a vector.
fn in_angle_brackets(mistake: &Mistake<'_>) -> Vec<Proposal> {
    let curve = matched("N(M) = <A, B, C>", mistake.line).map(|parts| {
        let point = filled("(A, B, C)", &parts);
        let range = super::curves::range(&point);
        let line = format!("{point} for {} in {range}", parts[&'M']);
        Proposal::new("a curve is a point with the range of its parameter", line)
    });
    let vector = matched("N = <A, B, C>", mistake.line).map(|parts| {
        Proposal::new("a vector stands in round brackets", filled("N = (A, B, C)", &parts))
    });
    curve.into_iter().chain(vector).collect()
}

/// `P(1, 2, 3)` and `P = (1, 2, 3)` as points with labels.
fn named_points(mistake: &Mistake<'_>) -> Option<Proposal> {
    let patterns: &[&str] = match mistake.kind {
        ErrorKind::UnknownFunction { .. } => &["N(A, B, C)", "point N(A, B, C)"],
        ErrorKind::NothingToDraw { .. } => &["N = (A, B, C)"],
        _ => return None,
    };
    let parts = patterns.iter().find_map(|pattern| matched(pattern, mistake.line))?;
    let is_point = parts[&'N'].starts_with(char::is_uppercase) && parts[&'N'].len() < 3;
    let line = format!("{} \"{}\"", filled("(A, B, C)", &parts), parts[&'N']);
    is_point.then(|| Proposal::new("a point is its coordinates, with its name in quotes", line))
}

/// `w = x^2 + y^2; w = 4` as the equation between both values of the name.
fn named_value(mistake: &Mistake<'_>) -> Option<Proposal> {
    let ErrorKind::NothingToDraw { .. } = mistake.kind else { return None };
    let statements: Vec<&str> =
        mistake.text.split(['\n', ';']).map(str::trim).filter(|one| !one.is_empty()).collect();
    let [first, second] = statements.as_slice() else { return None };
    let (first, second) = (matched("N = A", first)?, matched("N = A", second)?);
    let why = "a name has one value; where two are equal is";
    let line = format!("{} = {}", first[&'A'], second[&'A']);
    (first[&'N'] == second[&'N']).then(|| Proposal::text(why, line))
}

/// `red z = x*y` with the color on a line of its own.
fn with_color(mistake: &Mistake<'_>) -> Option<Proposal> {
    let (color, formula) = mistake.line.split_once(' ')?;
    let is_name = color.chars().all(char::is_alphabetic) && color.len() > 2;
    let is_color = is_name && csscolorparser::parse(color).is_ok();
    let line = format!("color {color}\n{}", formula.trim());
    is_color.then(|| Proposal::new("a color stands on a line of its own", line))
}

/// `cylinder(h=20, r=5) <= 0` with its arguments in their order.
fn named_arguments(mistake: &Mistake<'_>) -> Vec<Proposal> {
    let line = mistake.line;
    let mut all = Vec::new();
    for call in calls(line) {
        let named: Vec<(&str, &str)> =
            call.arguments.iter().filter_map(|one| one.split_once('=')).collect();
        for (name, arguments, template) in ARGUMENTS {
            if *name != call.name || named.len() != call.arguments.len() {
                continue;
            }
            let value = |argument: &&str| {
                let found = named.iter().find(|(name, _)| name.trim() == *argument);
                found.map(|(_, value)| value.trim())
            };
            let values: Option<Vec<&str>> = arguments.iter().map(value).collect();
            let Some(values) = values.filter(|values| values.len() == named.len()) else {
                continue;
            };
            let parts = LETTERS.into_iter().zip(values).collect();
            let whole = mistake.replaced(call.range.clone(), &halved(template, &parts));
            let why = "arguments have no names, and a height is given by its half";
            all.push(Proposal::new(why, whole));
        }
    }
    all
}

/// A template whose halves of numbers are computed.
fn halved(template: &str, parts: &super::pattern::Parts<'_>) -> String {
    let mut text = template.to_owned();
    for (letter, part) in parts {
        if let Ok(number) = part.parse::<f64>() {
            text = text.replace(&format!("{letter}/2"), &(number / 2.0).to_string());
        }
    }
    filled(&text, parts)
}

/// `max{x, y}` with round brackets.
fn in_braces(mistake: &Mistake<'_>) -> Option<Proposal> {
    let all = pieces(mistake.line);
    let mut line = mistake.line.to_owned();
    let mut open = Vec::new();
    for (index, piece) in all.iter().enumerate() {
        let word = |at: usize| &mistake.line[all[at].clone()];
        match word(index) {
            "{" => {
                let is_call = index > 0 && matches!(word(index - 1), "max" | "min");
                if is_call {
                    line.replace_range(piece.clone(), "(");
                }
                open.push(is_call);
            }
            "}" if open.pop() == Some(true) => line.replace_range(piece.clone(), ")"),
            _ => {}
        }
    }
    (line != mistake.line).then(|| Proposal::new("arguments stand in round brackets", line))
}
