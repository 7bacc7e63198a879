//! Errors in calls of builders name the argument and point at it.

use zeroset_ops::{BUILDERS, Role};
use zeroset_parser::{ErrorKind, Limits, Note, NoteKind};
use zeroset_syntax::{Options, parse, read};

/// The part of a text at which its only error points, and the error's message with its help.
fn error(text: &str) -> (String, String) {
    let errors = read(text, &Options::default()).expect_err(text);
    let error = errors.iter().next().expect("an error");
    (text[error.span.range()].to_owned(), errors.render(None, text, false))
}

#[test]
fn a_wrong_argument_is_named_and_pointed_at() {
    for (text, place, argument) in [
        ("sphere(-1)", "-1", "`r` of `sphere`"),
        ("box(2, 0, 1)", "2, 0, 1", "`a` of `box`"),
        ("box(1, 2)", "2", "`center` of `box`"),
        ("sphere(1, (1, 2))", "(1, 2)", "`center` of `sphere`"),
        ("torus((1, 2, 3), 1)", "(1, 2, 3)", "`r` of `torus`"),
        ("translate(sphere(1), 2)", "2", "`v` of `translate`"),
        ("translate((x, y, z), 1, 0, 0)", "(x, y, z)", "`shape` of `translate`"),
        ("rotate(box(1), 30°, 0, 0, 0)", "0, 0, 0", "`axis` of `rotate`"),
        ("scale(box(1), 0)", "0", "`k` of `scale`"),
        ("ring(sphere(1), x)", "x", "`n` of `ring`"),
        ("ring(sphere(1), 2.5)", "2.5", "`n` of `ring`"),
        ("ring(sphere(1), 1001)", "1001", "`n` of `ring`"),
        ("repeat(sphere(1), (1, 0, 0), 0)", "0", "`n` of `repeat`"),
        ("repeat(sphere(1), 0, 0, 0)", "0, 0, 0", "`cells` of `repeat`"),
        ("union(x, shell(sphere(1), -1))", "-1", "`t` of `shell`"),
        ("part = box(1)\ntranslate(part, mat2(1))", "mat2(1)", "`v` of `translate`"),
    ] {
        let (found, message) = error(text);
        assert_eq!(found, place, "{text}: {message}");
        assert!(message.contains(argument), "{text}: {message}");
        assert!(message.contains("write it as in `"), "{text}: {message}");
    }
}

#[test]
fn a_wrong_count_shows_how_the_builder_is_used() {
    for text in ["torus(1)", "translate(sphere(1), 1, 2)", "halfspace(1, 2)", "extrude(x)"] {
        let (_, message) = error(text);
        assert!(message.contains("as in `"), "{text}: {message}");
    }
}

#[test]
fn every_builder_is_read_as_its_usage_says() {
    for row in BUILDERS {
        let all: Vec<&str> = std::iter::once(row.name).chain(row.aliases.iter().copied()).collect();
        for name in all {
            let text = row.usage.replacen(row.name, name, 1);
            let statements = parse(&text, &Limits::default()).expect(&text);
            assert!(statements[0].to_string().starts_with(row.name), "{text}");
            let document = read(&text, &Options::default());
            let document = document.unwrap_or_else(|e| panic!("{}", e.render(None, &text, false)));
            // Circles and rectangles are shapes of a plane.
            let is_other = |note: &&Note| !matches!(note.kind, NoteKind::PlaneCurve { .. });
            let notes: Vec<&Note> = document.notes.iter().filter(is_other).collect();
            assert!(notes.is_empty(), "{text}: {notes:?}");
        }
    }
}

/// Each parameter refuses a matrix, whichever form of the builder is meant.
#[test]
fn no_parameter_takes_a_matrix() {
    for row in BUILDERS {
        for at in 0..row.parameters.len() {
            let given: Vec<&str> = row
                .parameters
                .iter()
                .enumerate()
                .map(|(place, (_, role))| match role {
                    _ if place == at => "mat2(1)",
                    Role::Shape | Role::Distance => "x",
                    Role::Vector | Role::Direction | Role::Sizes | Role::Cells => "(1, 2, 3)",
                    Role::Size | Role::Number | Role::Count => "2",
                })
                .collect();
            let text = format!("{}({})", row.name, given.join(", "));
            let errors = read(&text, &Options::default()).expect_err(&text);
            let error = errors.iter().next().expect("an error");
            assert!(matches!(error.kind, ErrorKind::BuilderArgument { .. }), "{text}: {errors}");
            assert_eq!(&text[error.span.range()], "mat2(1)", "{text}");
        }
    }
}

#[test]
fn own_definitions_hide_builders() {
    let echo = |text: &str| read(text, &Options::default()).expect(text).surfaces[0].echo.clone();
    assert_eq!(echo("box(a, b) = a + b\nbox(x, y)"), "box(x, y) = 0");
    assert_eq!(echo("scale = 2\nscale*x"), "scale*x = 0");
    assert_eq!(
        echo("sphere(x, y, z) = x^2 + y^2 + z^2 - 1\nsphere(x, y, z)"),
        "sphere(x, y, z) = 0"
    );
}
