//! How to write the solid whose volume is wanted, where there are equations alone.

/// A note on equations, which bound no solid. `lines` are all surfaces of a document.
pub fn hint(lines: &[&str]) -> String {
    let solid = match lines {
        [line] => sides(line).map(|[left, right]| format!("{left} <= {right}")),
        [one, other] => sides(one).zip(sides(other)).map(|([a, b], [c, d])| {
            // Whichever pair of signs encloses the wanted part.
            format!("{a} >= {b} and {c} <= {d}")
        }),
        _ => None,
    };
    let reason = "an equation has no volume";
    match (solid, lines.len()) {
        (Some(solid), 1) => format!("{reason}: measure '{solid}' for the volume inside"),
        (Some(solid), _) => {
            format!("{reason}: measure '{solid}', or with other signs, for the volume between both")
        }
        (None, _) => format!("{reason}: use <= or >= in place of ="),
    }
}

/// The two sides of an equation, or `None` if the line is more than that.
fn sides(line: &str) -> Option<[&str; 2]> {
    if line.contains(['<', '>', '{', '≤', '≥', '\n']) {
        return None;
    }
    let sides = match line.split_once('=') {
        Some((left, right)) if !right.contains('=') => [left, right],
        Some(_) => return None,
        None => [line, "0"],
    };
    Some(sides.map(str::trim))
}
