//! Hints on curves, points, sliders and vectors whose form is incomplete.

use super::pattern::{filled, matched, pieces};
use super::{Mistake, Proposal};
use zeroset_parser::ErrorKind;

/// Names that are used for the parameter of a curve.
const PARAMETERS: [&str; 6] = ["t", "s", "u", "v", "theta", "k"];

pub(super) fn proposals(mistake: &Mistake<'_>) -> Vec<Proposal> {
    let mut all: Vec<Proposal> = coordinates(mistake).into_iter().collect();
    all.extend(without_range(mistake));
    all.extend(with_axes(mistake));
    all.extend(in_a_plane(mistake));
    all.extend(sliders(mistake));
    all.extend(levels(mistake));
    all.extend(vectors(mistake));
    all.extend(condition_of_name(mistake));
    all.extend(function_of_name(mistake));
    all
}

/// The name of a parameter, if exactly one occurs in a text.
fn parameter(text: &str) -> Option<&'static str> {
    let words: Vec<&str> = pieces(text).into_iter().map(|piece| &text[piece]).collect();
    let mut found = PARAMETERS.into_iter().filter(|name| words.contains(name));
    found.next().filter(|_| found.next().is_none())
}

/// A range for a parameter: a long one if functions such as `sin` occur, one around 0 for a line,
/// else a short one.
pub(super) fn range(text: &str) -> &'static str {
    let is_turning = ["sin", "cos", "exp"].iter().any(|function| text.contains(function));
    // A point and a multiple of a direction are a line, which goes on at both sides.
    let is_sum = text.contains(") +") || text.contains(") -") || text.contains(")+");
    match (is_turning, is_sum) {
        (true, _) => "[0, 20]",
        (false, true) => "[-2, 2]",
        (false, false) => "[0, 1]",
    }
}

/// `x = cos s, y = sin s, z = s`, in one line or in three, as a curve.
fn coordinates(mistake: &Mistake<'_>) -> Option<Proposal> {
    let text = mistake.text.trim();
    let line = text.replace([';', '\n'], ",");
    let parts = ["x = A, y = B, z = C", "x = A, y = B, z = C,", "x(N) = A, y(N) = B, z(N) = C"];
    let parts = parts.iter().find_map(|pattern| matched(pattern, &line))?;
    let point = filled("(A, B, C)", &parts);
    let name = parameter(&point)?;
    let why = "a curve with a parameter has its range behind it";
    Some(Proposal::text(why, format!("{point} for {name} in {}", range(&point))))
}

/// A point, or a sum of vectors, with a parameter that has no range.
fn without_range(mistake: &Mistake<'_>) -> Option<Proposal> {
    let line = mistake.line;
    let value = ["(x, y, z) = A", "N(N) = A", "N = A", "curve A"]
        .iter()
        .find_map(|pattern| matched(pattern, line))
        .and_then(|parts| parts.get(&'A').copied())
        .unwrap_or(line);
    let name = parameter(value).filter(|_| value.contains('('))?;
    // A direction directly behind the parameter is multiplied.
    let value = value.replace(&format!(" {name}("), &format!(" {name}*("));
    let curve = format!("{value} for {name} in {}", range(&value));
    Some(Proposal::new("the parameter needs a range", curve))
}

/// A point with a coordinate in it, as in `(x, 2, 3)`, as a curve.
fn with_axes(mistake: &Mistake<'_>) -> Option<Proposal> {
    let ErrorKind::CurveCoordinate { name } = mistake.kind else { return None };
    let line = mistake.line;
    let mut curve = String::new();
    let mut end = 0;
    for piece in pieces(line) {
        curve += &line[end..piece.start];
        curve += if &line[piece.clone()] == *name { "t" } else { &line[piece.clone()] };
        end = piece.end;
    }
    let why = "what moves along a curve is its parameter";
    Some(Proposal::new(why, format!("{curve}{} for t in [-3, 3]", &line[end..])))
}

/// `curve y = x^2`, as the curve in the plane of the coordinates that occur.
fn in_a_plane(mistake: &Mistake<'_>) -> Option<Proposal> {
    let ErrorKind::CurveEquations = mistake.kind else { return None };
    let typed = mistake.line.strip_prefix("curve ")?;
    let (equation, condition) = typed.split_at(typed.find('{').unwrap_or(typed.len()));
    // `6xy` has both coordinates.
    let occurs = |axis: char| {
        let is_product = |word: &str| word.chars().all(|c| "xyz".contains(c));
        pieces(equation)
            .into_iter()
            .map(|at| &equation[at])
            .any(|word| is_product(word) && word.contains(axis))
    };
    let axis = ['z', 'y', 'x'].into_iter().find(|axis| !occurs(*axis))?;
    let why = format!("a curve takes two equations; in the plane {axis} = 0 it is");
    let line = format!("curve {}, {axis} = 0 {condition}", equation.trim());
    Some(Proposal::new(why, line.trim()))
}

/// A formula with a list of numbers in place of one, as one formula for each number. Two numbers
/// behind `in` are a range.
fn levels(mistake: &Mistake<'_>) -> Option<Proposal> {
    let line = mistake.line;
    let (parts, formula) = match matched("A = B for N in [C]", line) {
        Some(parts) => (parts, Some(line.split_once(" for ")?.0)),
        None => (matched("A = [C]", line)?, None),
    };
    let numbers: Vec<&str> = parts[&'C'].split(',').map(str::trim).collect();
    if !numbers.iter().all(|number| number.parse::<f64>().is_ok()) {
        return None;
    }
    let why = "each value has a formula of its own";
    let Some(formula) = formula else {
        let lines = numbers.iter().map(|number| format!("{} = {number}", parts[&'A']));
        return Some(Proposal::new(why, lines.collect::<Vec<_>>().join("\n")));
    };
    let name = parts[&'N'];
    if let [low, high] = numbers.as_slice() {
        let slider = format!("{name} = {low} in [{low}, {high}]\n{formula}");
        return Some(Proposal::new("a value that moves is a slider", slider));
    }
    let with = |number: &&str| {
        let mut all = String::new();
        let mut end = 0;
        for piece in pieces(formula) {
            all += &formula[end..piece.start];
            end = piece.end;
            match &formula[piece] {
                word if word == name && (all.trim().is_empty() || all.ends_with("= ")) => {
                    all += number;
                }
                word if word == name => all.extend(["(", number, ")"]),
                word => all += word,
            }
        }
        all
    };
    Some(Proposal::new(why, numbers.iter().map(with).collect::<Vec<_>>().join("\n")))
}

/// Sliders in the notations of other systems.
fn sliders(mistake: &Mistake<'_>) -> Vec<Proposal> {
    const PATTERNS: [&str; 19] = [
        "slider(N, V, U)",
        "slider(N, V, U, C)",
        "Slider(N, V, U)",
        "slider N V U",
        "slider N from V to U",
        "N = slider(V, U)",
        "N = Slider(V, U)",
        "N = Slider(V, U, C)",
        "N in [V, U]",
        "N = V..U",
        "N = V to U",
        "N from V to U",
        "N = [V, U]",
        "N = in [V, U]",
        "N = W in (V, U)",
        "N = W in V..U",
        "N = W from V to U",
        "N = W between V and U",
        "N = W, V <= N <= U",
    ];
    let mut all = Vec::new();
    let found = PATTERNS.iter().filter_map(|pattern| slider(pattern, mistake.line));
    all.extend(found.map(|line| Proposal::new("a slider has a value and a range", line)));
    // The error of a definition such as `r = [0, 5]` is on the line that uses it as a number.
    for line in mistake.text.lines().filter(|line| *line != mistake.line) {
        if let Some(slider) = slider("N = [V, U]", line) {
            let corrected = mistake.text.replacen(line, &slider, 1);
            all.push(Proposal::text("a slider has a value and a range", corrected));
        }
    }
    all
}

/// The slider that a line means. `W` is its value, `V` and `U` are the ends of its range.
fn slider(pattern: &str, line: &str) -> Option<String> {
    let parts = matched(pattern, line)?;
    let number = |letter| parts.get(&letter)?.replace(' ', "").parse::<f64>().ok();
    let (low, high) = (number('V')?, number('U')?);
    let middle = if high - low > 2.0 { f64::midpoint(low, high).floor() } else { low };
    let value = number('W').unwrap_or(middle);
    Some(format!("{} = {value} in [{low}, {high}]", parts.get(&'N')?))
}

/// Points without definitions, and products with a point.
fn vectors(mistake: &Mistake<'_>) -> Vec<Proposal> {
    let mut all = Vec::new();
    let line = mistake.line;
    if let ErrorKind::UnknownName { .. } = mistake.kind {
        let is_vector = ["length", "dot", "distance", "norm", "cross", "normalize"]
            .iter()
            .any(|function| line.contains(function));
        let name = mistake.typed();
        if is_vector && name.len() <= 3 {
            let words: Vec<&str> = pieces(line).into_iter().map(|piece| &line[piece]).collect();
            let others = ["a", "b", "c", "d", "n", "o", "q", "u", "v", "w"];
            let points: Vec<String> = std::iter::once(name)
                .chain(others.into_iter().filter(|other| *other != name && words.contains(other)))
                .enumerate()
                .map(|(index, name)| match index {
                    0 if matches!(name, "p" | "pos" | "P" | "X" | "r") => {
                        format!("{name} = (x, y, z)")
                    }
                    1 => format!("{name} = (1, 2, 3)"),
                    _ => format!("{name} = (-1, 0, 0)"),
                })
                .collect();
            let why = "points need values";
            all.push(Proposal::new(why, format!("{}\n{line}", points.join("\n"))));
            all.push(Proposal::new(why, format!("{}\n{line}", points[0])));
        }
    }
    for dot in ["x.y", "y.z", "x.z", "y.x", "z.x", "z.y", "x.x", "y.y", "z.z"] {
        if line.contains(dot) {
            let product = line.replace(dot, &dot.replace('.', "*"));
            all.push(Proposal::new("a product is written `*`", product));
        }
    }
    if let Some(parts) = matched("A = B", line)
        && matches!(mistake.kind, ErrorKind::Vector | ErrorKind::Tuple)
    {
        all.push(Proposal::new(
            "a vector is not a number; its length is one",
            filled("length(A) = B", &parts),
        ));
        all.push(Proposal::new(
            "a vector is not a number; its length is one",
            filled("length(A - B) = 0", &parts),
        ));
    }
    all
}

/// A name that stands for a condition. The correction is a function that is at most 0 where the
/// condition holds.
fn condition_of_name(mistake: &Mistake<'_>) -> Vec<Proposal> {
    const PATTERNS: [(&str, &str); 6] = [
        ("N = A <= B and C <= D", "N = max(A - B, C - D)"),
        ("N = A < B and C < D", "N = max(A - B, C - D)"),
        ("N = A <= B and C < D", "N = max(A - B, C - D)"),
        ("N = A <= B or C <= D", "N = min(A - B, C - D)"),
        ("N = A <= B", "N = A - B"),
        ("N = A < B", "N = A - B"),
    ];
    let mut all = Vec::new();
    for (pattern, template) in PATTERNS {
        let Some(parts) = matched(pattern, mistake.line) else { continue };
        let (name, definition) = (parts[&'N'], filled(template, &parts));
        // The lines that draw the name get a relation.
        let others: Vec<String> = mistake
            .text
            .lines()
            .filter(|line| line.trim() != mistake.line)
            .map(|line| if line.trim() == name { format!("{name} <= 0") } else { line.to_owned() })
            .collect();
        let text = std::iter::once(definition).chain(others).collect::<Vec<_>>().join("\n");
        let why = "a name stands for a number, which is at most 0 inside";
        all.push(Proposal::text(why, text));
    }
    all
}

/// `f = sin` as a function of an argument.
fn function_of_name(mistake: &Mistake<'_>) -> Option<Proposal> {
    let parts = matched("N = A", mistake.line)?;
    let is_function =
        matches!(mistake.kind, ErrorKind::NeedsArgument { name, .. } if *name == parts[&'A']);
    let line = filled("N(a) = A(a)", &parts);
    is_function.then(|| Proposal::new("a function gets its argument", line))
}
