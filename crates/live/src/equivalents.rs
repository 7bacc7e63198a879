//! Equivalents of other programs' formulas, in one table for the help and the README.

/// Each row: another program, a formula in that program's syntax, and the same formula here.
pub const EQUIVALENTS: &[(&str, &str, &str)] = &[
    ("Desmos", "z = {x < 0: x^2, x}", "the same; a slider is `a = 1 in [0, 5]`"),
    (
        "Mathematica",
        "ContourPlot3D[x^2 + y^2 + z^2 == 1, …]",
        "the same; its ranges are the domain, `domain 2`",
    ),
    ("Surfer", "x^3 + y^2 - a*z", "the same, with `a = 0.5 in [0, 1]` on a line of its own"),
    (
        "GLSL",
        "float map(vec3 p) { return length(p) - 1.; }",
        "the same, as a file or pasted; loops have constant bounds",
    ),
    ("OpenSCAD", "translate([2, 0, 0]) sphere(1);", "translate(sphere(1), 2, 0, 0) <= 0"),
    ("libfive", "(union (sphere 1) (box …))", "union(sphere(1), box(0.8)) <= 0"),
];

/// The table as text.
pub(super) fn listed() -> String {
    let row = |(from, there, here): &(&str, &str, &str)| format!("{from}: {there}\n  {here}");
    EQUIVALENTS.iter().map(row).collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use zeroset_syntax::{Options, read};

    #[test]
    fn what_is_to_be_written_can_be_read() {
        let document = |text: &str| read(text, &Options::default()).map(drop);
        for (from, there, here) in EQUIVALENTS {
            let text = match *from {
                "Desmos" | "GLSL" => (*there).to_owned(),
                "Mathematica" => there.replace('…', "{x, -2, 2}, {y, -2, 2}, {z, -2, 2}"),
                "Surfer" => format!("a = 0.5 in [0, 1]\n{there}"),
                _ => here.split(", with").next().unwrap_or_default().to_owned(),
            };
            assert!(document(&text).is_ok(), "{from}: {text}");
        }
    }
}
