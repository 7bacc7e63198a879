//! Tests how diagnostics are drawn: color, file names, long lines, places on several lines.

use zeroset_syntax::{Options, read};

fn rendered(name: Option<&str>, text: &str, color: bool) -> String {
    read(text, &Options::default()).expect_err("an error").render(name, text, color)
}

#[test]
fn plain_text_has_no_escape_sequences() {
    let text = "x^2 + foo";
    assert!(!rendered(None, text, false).contains('\u{1b}'));
    assert!(rendered(None, text, true).contains('\u{1b}'));
    assert_eq!(rendered(None, text, false), rendered(None, text, false));
}

#[test]
fn a_file_is_named_with_line_and_column() {
    let text = "r = 2\nx^2 + foo";
    assert!(rendered(Some("torus.zset"), text, false).contains("torus.zset:2:7"));
}

#[test]
fn the_caret_stands_under_the_place_in_a_long_line() {
    for terms in [0, 10, 100, 1000] {
        let text = format!("{}foo{}", "y + ".repeat(terms), " + z".repeat(terms));
        let rendered = rendered(None, &text, false);
        let lines: Vec<&str> = rendered.lines().collect();
        let caret = lines.iter().position(|line| line.contains("^^^")).expect("a caret");
        let column = lines[caret].find("^^^").expect("a caret");
        assert_eq!(&lines[caret - 1][column..column + 3], "foo", "{rendered}");
        assert!(lines.iter().all(|line| line.len() < 150), "{rendered}");
    }
}

#[test]
fn line_and_column_are_those_of_the_text_however_long_the_line() {
    for terms in [1, 300, 10_000] {
        let text = format!("r = 1\n{}foo", "x^2+".repeat(terms));
        let place = format!("long.zset:2:{}\n", 4 * terms + 1);
        let shown = rendered(Some("long.zset"), &text, false);
        assert!(shown.contains(&place), "{place}{shown}");
    }
    // Columns count characters instead of bytes.
    let text = format!("{}foo", "π+".repeat(600));
    assert!(rendered(Some("long.zset"), &text, false).contains("long.zset:1:1201\n"));
}

#[test]
fn what_a_function_of_the_language_is_made_of_has_no_place_in_the_text() {
    for (text, place) in [
        ("αβγδεζ(a) = a\nx + length(hypot(vec2(x, y), vec3(x, y, z))) = 3", "hypot("),
        ("sqrt(v) = mat2(v, v, v, v)\nr*theta*phi = 2", "theta"),
    ] {
        let errors = read(text, &Options::default()).expect_err("an error");
        assert!(!errors.render(None, text, false).is_empty());
        let span = errors.iter().next().expect("an error").span;
        assert!(text[span.range()].starts_with(place), "{:?}", &text[span.range()]);
    }
    let text = "αβγδεζ = 1\nx + length(smoothstep(0, 1, vec3(x, y, αβγδεζ))) = 3";
    assert_eq!(read(text, &Options::default()).expect("a formula").notes, []);
}
