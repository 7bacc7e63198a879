//! Compares random programs with the values of other interpreters: Mesa for GLSL, Python, and
//! `OpenSCAD`. The values are in `tests/data/programs`, so these interpreters are not needed.

use std::fmt::Write as _;
use zeroset_testkit::programs::{Language, Outcome, compare, read_records};

/// Largest difference, relative to the value or to 1. GLSL computes with 24 bits.
const TOLERANCE: f64 = 1e-3;

fn data(language: Language) -> String {
    let name = language.name();
    let path = format!("{}/../../tests/data/programs/{name}.txt", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(path).expect("the programs are there")
}

/// Compares all programs of a language. At least `share` percent must not be refused.
fn check(language: Language, share: usize) {
    let records = read_records(&data(language));
    let (mut same, mut values) = (0, 0);
    let (mut wrong, mut refused) = (String::new(), String::new());
    for record in &records {
        match compare(record, TOLERANCE) {
            Outcome::Same { count, .. } => {
                same += 1;
                values += count;
            }
            Outcome::Refused(message) => writeln!(refused, "{}\n{message}", record.title).unwrap(),
            Outcome::Wrong(message) => {
                writeln!(wrong, "{}: {message}\n{}", record.title, record.text).unwrap();
            }
        }
    }
    println!("{same} of {} programs agree in {values} values. Refused:\n{refused}", records.len());
    assert!(wrong.is_empty(), "{wrong}");
    assert!(same * 100 >= records.len() * share, "{same} of {}:\n{refused}", records.len());
    assert!(values >= same * 4, "{values} values of {same} programs");
}

#[test]
fn shaders_have_the_values_of_mesa() {
    check(Language::Glsl, 97);
}

#[test]
fn functions_of_python_have_its_values() {
    check(Language::Python, 97);
}

#[test]
fn functions_of_openscad_have_its_values() {
    check(Language::OpenScad, 85);
}

/// Constructs of each language, whose effects the comparison is about.
const CONSTRUCTS: [(Language, &[&str]); 3] = [
    (
        Language::Glsl,
        &[
            "++, ",
            "-- > 0",
            " -= 1) >= 0",
            "++ < ",
            "&& (",
            "|| (",
            " ? ",
            "break;",
            "continue;",
            ") return ",
            "return;",
            "inout ",
            "out float",
            ".xy *= mat2",
            "zx = ",
            "grow(",
            "split(",
            "turn(",
            "count(",
            "dim(",
            "lit(",
            "half_of(",
            "/",
            "%",
            " = (",
            "#define",
            "const int N",
            "= N; ",
            "bool ",
            ", --",
            "j0--",
            "    {\n",
            "else",
        ],
    ),
    (
        Language::Python,
        &[
            "//=",
            "%=",
            "**=",
            " // ",
            ") % -",
            "**2",
            "2**-",
            "else:",
            "elif ",
            "break",
            "continue",
            "sum(",
            "sum([",
            "min([",
            "max(",
            " if i",
            ", c=3)",
            "(b=",
            "lambda",
            "pair(",
            "not ",
            " and ",
            " or ",
            "-0.577 < ",
            " = e = ",
            ", ",
            "; ",
            "int(",
            "while ",
            "range(3, 0, -1)",
            "[1]",
        ],
    ),
    (
        Language::OpenScad,
        &[
            "= function(",
            "function f(",
            "let(",
            "[for (",
            "if (",
            "[0:0.5:1]",
            "[2:-1:0]",
            " % ",
            "^",
            "c = 3",
            "(b = ",
            "atan2(",
            "acos(",
            "norm(",
            "mirror(",
            "][",
            "$k",
            "]*[",
            " ? ",
            " && ",
            " || ",
            "!(",
        ],
    ),
];

/// The samples have every construct whose effects the comparison is about.
#[test]
fn the_samples_have_every_construct() {
    for (language, constructs) in CONSTRUCTS {
        let text: String =
            read_records(&data(language)).into_iter().map(|record| record.text).collect();
        for construct in constructs {
            assert!(text.contains(construct), "{} has no {construct:?}", language.name());
        }
    }
}
