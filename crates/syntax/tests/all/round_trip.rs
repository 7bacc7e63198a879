//! Tests properties of random trees and random texts. The seed is fixed. A failing case is printed
//! with its input.

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use zeroset_ir::{Axis, NamedConstant};
use zeroset_ops::{COMPOSED, Notation, TABLE, VectorFunction};
use zeroset_parser::tree::ast::{
    Chain, ChainSign, CurveForm, CurveStatement, Expr, ExprKind, Function, Name, NamedValue,
    Relation, Series, Statement,
};
use zeroset_parser::{Limits, Span};
use zeroset_syntax::{Options, parse, read, read_bytes};

/// Settings for `cases` cases. `ZEROSET_CASES` replaces their number, and `ZEROSET_SEED` the seed.
fn config(cases: u32) -> ProptestConfig {
    let set = |name: &str| std::env::var(name).ok().and_then(|text| text.parse().ok());
    ProptestConfig {
        cases: set("ZEROSET_CASES").and_then(|cases| u32::try_from(cases).ok()).unwrap_or(cases),
        rng_seed: RngSeed::Fixed(set("ZEROSET_SEED").unwrap_or(0x7a65_726f)),
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

fn expr(kind: ExprKind) -> Expr {
    Expr::new(kind, Span::default())
}

/// Builds a sum or a product as the parser does: splices in a first operand of the same kind.
fn chain(kind: Chain, first: Expr, mut rest: Vec<(ChainSign, Expr)>) -> Expr {
    match first.kind {
        ExprKind::Chain(of_first, inner, mut operands) if of_first == kind => {
            operands.append(&mut rest);
            expr(ExprKind::Chain(kind, inner, operands))
        }
        other => expr(ExprKind::Chain(kind, Box::new(expr(other)), rest)),
    }
}

fn leaf() -> impl Strategy<Value = Expr> {
    let numbers =
        prop::sample::select(vec!["0", "1", "2", "0.5", "12.25", "2e3", "1e-3", "1.5e10"]);
    let values = prop::sample::select(vec![
        NamedValue::Coordinate(Axis::X),
        NamedValue::Coordinate(Axis::Y),
        NamedValue::Coordinate(Axis::Z),
        NamedValue::Time,
        NamedValue::Constant(NamedConstant::Pi),
        NamedValue::Constant(NamedConstant::E),
        NamedValue::Constant(NamedConstant::Phi),
    ]);
    prop_oneof![
        numbers.prop_map(|text| expr(ExprKind::Number(text.to_owned()))),
        values.prop_map(|value| expr(ExprKind::Name(value))),
    ]
}

/// Every function that a user can call, with a number of arguments that the function takes.
fn functions() -> Vec<(Function, usize)> {
    let callable = |row: &&zeroset_ops::OpRow| {
        matches!(row.notation, Notation::Function | Notation::Infix { callable: true, .. })
    };
    let mut all: Vec<(Function, usize)> = TABLE
        .iter()
        .filter(callable)
        .map(|row| (Function::Native(row.op), row.op.arity()))
        .collect();
    all.push((Function::Native(zeroset_ops::Op::Max), 4));
    all.push((Function::Root, 2));
    all.push((Function::Length, 5));
    all.push((Function::Vector(3), 3));
    all.push((Function::OfVectors(VectorFunction::Cross), 2));
    all.push((Function::OfVectors(VectorFunction::Normalize), 1));
    all.extend(
        COMPOSED
            .iter()
            .enumerate()
            .map(|(index, f)| (Function::Composed(index), f.parameters.len())),
    );
    all
}

fn comparison(sides: BoxedStrategy<Expr>) -> impl Strategy<Value = Expr> {
    let relation = prop::sample::select(vec![Relation::Equal, Relation::Less, Relation::Unequal]);
    (sides.clone(), relation, sides).prop_map(|(left, relation, right)| {
        expr(ExprKind::Compare(Box::new(left), vec![(relation, right)]))
    })
}

fn series(is_product: bool, mut ends: Vec<Expr>, step: Option<Expr>) -> Expr {
    let index = Name { text: "k".to_owned(), span: Span::default() };
    let (low, high, body) = (ends.remove(0), ends.remove(0), ends.remove(0));
    expr(ExprKind::Series(Box::new(Series { is_product, index, low, high, step, body })))
}

fn number() -> impl Strategy<Value = Expr> {
    leaf().prop_recursive(6, 40, 4, |inner| {
        let sign = prop::sample::select(vec![ChainSign::Direct, ChainSign::Inverse]);
        let chains = |kind| {
            (inner.clone(), vec((sign.clone(), inner.clone()), 1..4))
                .prop_map(move |(first, rest)| chain(kind, first, rest))
        };
        let function = prop::sample::select(functions());
        prop_oneof![
            inner.clone().prop_map(|e| expr(ExprKind::Negate(Box::new(e)))),
            chains(Chain::Sum),
            chains(Chain::Product),
            (inner.clone(), inner.clone()).prop_map(|(base, exponent)| expr(ExprKind::Power(
                Box::new(base),
                Box::new(exponent)
            ))),
            (
                vec((comparison(inner.clone().boxed()), inner.clone()), 1..3),
                prop::option::of(inner.clone())
            )
                .prop_map(|(pieces, last)| expr(ExprKind::Choice(pieces, last.map(Box::new)))),
            (inner.clone(), prop::sample::select(vec!["x", "yx", "xyz", "w"])).prop_map(
                |(e, letters)| expr(ExprKind::Component(Box::new(e), letters.to_owned()))
            ),
            (any::<bool>(), vec(inner.clone(), 3), prop::option::of(inner.clone()))
                .prop_map(|(is_product, ends, step)| series(is_product, ends, step)),
            (function, vec(inner, 5)).prop_map(|((function, count), mut arguments)| {
                arguments.truncate(count);
                expr(ExprKind::Call(function, arguments))
            }),
        ]
    })
}

fn condition() -> impl Strategy<Value = Expr> {
    let relation = prop::sample::select(vec![
        Relation::Less,
        Relation::LessEqual,
        Relation::Greater,
        Relation::GreaterEqual,
    ]);
    let compare = (number(), vec((relation, number()), 1..3))
        .prop_map(|(first, rest)| expr(ExprKind::Compare(Box::new(first), rest)));
    compare.prop_recursive(3, 8, 3, |inner| {
        let several = |is_and: bool| {
            move |mut items: Vec<Expr>| {
                let first = items.remove(0);
                let mut all = match (first.kind, is_and) {
                    (ExprKind::And(inner), true) | (ExprKind::Or(inner), false) => inner,
                    (kind, _) => vec![expr(kind)],
                };
                all.extend(items);
                expr(if is_and { ExprKind::And(all) } else { ExprKind::Or(all) })
            }
        };
        prop_oneof![
            inner.clone().prop_map(|e| expr(ExprKind::Not(Box::new(e)))),
            vec(inner.clone(), 2..4).prop_map(several(true)),
            vec(inner, 2..4).prop_map(several(false)),
        ]
    })
}

fn statement() -> impl Strategy<Value = Statement> {
    let equation = (number(), number())
        // The equations `pi = …` and `t = …` would be definitions.
        .prop_filter("a definition", |(left, _)| {
            !matches!(left.kind, ExprKind::Name(NamedValue::Constant(_) | NamedValue::Time))
        })
        .prop_map(|(left, right)| {
            expr(ExprKind::Compare(Box::new(left), vec![(Relation::Equal, right)]))
        });
    let drawn = prop_oneof![number(), equation, condition()];
    (drawn, vec(condition(), 0..3))
        .prop_map(|(expr, restrictions)| Statement::Draw { expr, restrictions })
}

fn curve() -> impl Strategy<Value = Statement> {
    let equation = (number(), number()).prop_map(|(left, right)| {
        expr(ExprKind::Compare(Box::new(left), vec![(Relation::Equal, right)]))
    });
    let equations = vec(prop_oneof![number(), equation], 1..3);
    let equations = (equations, vec(condition(), 0..3))
        .prop_map(|(equations, restrictions)| CurveForm::Equations { equations, restrictions });
    let ends = (number(), number()).prop_map(Box::new);
    let path = (vec(number(), 3), prop::sample::select(vec!["s", "foo"]), ends);
    let path = path.prop_map(|(at, name, range)| {
        let parameter = Name { text: name.to_owned(), span: Span::default() };
        CurveForm::Path { at, parameter, range }
    });
    let range = || (number(), number());
    let patch = (vec(number(), 3), [range(), range()]).prop_map(|(at, ranges)| {
        let parameters =
            ["s", "foo"].map(|name| Name { text: name.to_owned(), span: Span::default() });
        CurveForm::Patch { at, parameters, ranges: Box::new(ranges) }
    });
    let label = prop::sample::select(vec![None, Some("A".to_owned()), Some("a, (b".to_owned())]);
    let point = (vec(number(), 3), label).prop_map(|(at, label)| CurveForm::Point { at, label });
    let span = Span::default();
    prop_oneof![equations, path, patch, point]
        .prop_map(move |form| Statement::Curve(CurveStatement { form, span }))
}

proptest! {
    #![proptest_config(config(2000))]

    #[test]
    fn what_is_printed_is_read_as_it_was(statement in prop_oneof![4 => statement(), 1 => curve()]) {
        let printed = statement.to_string();
        match parse(&printed, &Limits::default()) {
            Ok(parsed) => prop_assert_eq!(&parsed, &[statement], "{}", printed),
            Err(errors) => prop_assert!(false, "{}", errors.render(None, &printed, false)),
        }
    }
}

/// Reads and renders a text. Fails if the result is inconsistent or an error has no message.
fn survives(text: &str) -> Result<(), TestCaseError> {
    match read(text, &Options::default()) {
        Ok(document) => {
            prop_assert!(!document.surfaces.is_empty() || !document.curves.is_empty());
            for note in &document.notes {
                prop_assert!(text.get(note.span.range()).is_some(), "{:?}", note);
                note.render(None, text, true);
            }
            for surface in &document.surfaces {
                prop_assert!(surface.root.index() < document.graph.len());
            }
            let statements = parse(text, &Limits::default());
            let statements = statements.map_err(|e| TestCaseError::fail(format!("{text}\n{e}")))?;
            let printed: Vec<String> = statements.iter().map(ToString::to_string).collect();
            let printed = printed.join("\n");
            match parse(&printed, &Limits::default()) {
                Ok(again) => prop_assert!(again == statements, "{text}\n\n{printed}"),
                Err(errors) => {
                    let errors = errors.render(None, &printed, false);
                    return Err(TestCaseError::fail(format!("{text}\n{errors}")));
                }
            }
        }
        Err(errors) => {
            for error in &errors {
                prop_assert!(text.get(error.span.range()).is_some(), "{:?}", error);
                prop_assert!(!error.message().is_empty());
            }
            errors.render(Some("file.zset"), text, true);
        }
    }
    Ok(())
}

/// Fragments of the language. Texts are random sequences of fragments.
const PIECES: &[&str] = &[
    "curve ",
    "point ",
    "(x, y, z)",
    " for t in [0, 1]",
    "\"A\"",
    "x",
    "y",
    "z",
    "t",
    "r",
    "f",
    "g",
    "xyz",
    "x2",
    "i",
    "2",
    "0.5",
    ".5",
    "1.",
    "2e3",
    "sin",
    "max",
    "log",
    "root",
    "(",
    ")",
    "(",
    ")",
    "[",
    "]",
    "{",
    "}",
    "|",
    "|",
    ",",
    "+",
    "-",
    "−",
    "*",
    "/",
    "^",
    "**",
    "²",
    "⁻¹",
    "√",
    "=",
    "==",
    "<",
    "<=",
    ">",
    "≥",
    "!=",
    "and",
    "or",
    "not",
    "in",
    "\n",
    ";",
    "#",
    "\\frac",
    "\\sqrt",
    "\\sin",
    "\\cdot",
    "\\left",
    "\\le",
    "\\",
    "domain",
    "view",
    "color",
    "auto",
    "eye",
    "front",
    "#ff0",
    "red",
    "r = 2\n",
    "f(a) = a\n",
    "f(x, y) =",
    " ",
    " ",
    "é",
    "'",
    "!",
    "$",
    "·",
    "π",
    "_",
    "x_1",
    "x_{1}",
    "\u{FEFF}",
    "\r\n",
    "\u{2062}",
    ":",
    ":=",
    "&&",
    "∈",
    "{x < 0: ",
    " ? ",
    " if ",
    " else ",
    "if(",
    "sum(k = 1..3, ",
    "\\sum_{k=1}^{3} ",
    "iterate(",
    "vec3(",
    ".xy",
    "p",
    "..",
    "\\begin{cases} ",
    "\\end{cases}",
    " & ",
    "\\\\",
    "\\text{otherwise}",
    "float d = ",
    "return ",
    "float f(vec3 p) { ",
    "def f(x):\n",
    "lambda x: ",
    "theta",
    "rho",
    "phi",
    "//",
    "/*",
    "*/",
    "(*",
    "np.",
    "||",
    "+=",
    "Piecewise[{{",
    "}}]",
    "let(",
    "for (int i = 0; i < 3; i++) ",
    "for i in range(3):\n  ",
    "while (n < 3) ",
    "if (x < 0.) ",
    " else ",
    "break;",
    "continue;",
    "int n = 0;",
    "n++",
    "void f(inout vec3 p) { ",
    "f(p.xz);",
    "#define f(a) ",
    "mat2(",
    "*= mat2(1., 2., 3., 4.)",
    "transpose(",
    "@(x, y) ",
    "isosurface { function {",
    "With[{a = 2}, ",
    "Plus[",
    ".sqrt()",
    " then ",
    "&sup2;",
    "<sup>2</sup>",
    "\u{1d465}",
    "\u{ff12}",
    "\u{2081}",
    "%",
    "\n",
    ";",
];

/// The texts that people paste, from two of the lists in `tests/data`, without their expected
/// readings.
fn pasted() -> Vec<String> {
    ["words.txt", "words_held_out.txt"]
        .iter()
        .flat_map(|name| {
            let path = format!("{}/../../tests/data/{name}", env!("CARGO_MANIFEST_DIR"));
            let rows = std::fs::read_to_string(path).expect("the list is there");
            let texts = rows.split("\n[").skip(1).map(|row| {
                let typed = row.lines().filter_map(|line| line.strip_prefix('>'));
                typed.map(|line| line.strip_prefix(' ').unwrap_or(line)).collect::<Vec<_>>()
            });
            texts.map(|lines| lines.join("\n")).collect::<Vec<_>>()
        })
        .collect()
}

/// The character boundary of `text` at or before position `at`, which wraps around at the end.
fn cut(text: &str, at: usize) -> usize {
    let mut at = at % (text.len() + 1);
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

proptest! {
    #![proptest_config(config(4_000))]

    #[test]
    fn rows_of_pieces_never_panic(pieces in vec(prop::sample::select(PIECES), 0..24)) {
        survives(&pieces.concat())?;
    }

    #[test]
    fn what_people_paste_never_panics_where_it_is_damaged(
        rows in (any::<prop::sample::Index>(), any::<prop::sample::Index>()),
        at in (0_usize..3000, 0_usize..3000, 0_usize..40),
        piece in prop::sample::select(PIECES),
        is_spliced in any::<bool>(),
    ) {
        thread_local!(static TEXTS: Vec<String> = pasted());
        let text = TEXTS.with(|texts| {
            let (first, second) = (rows.0.get(texts), rows.1.get(texts));
            let (from, to) = (cut(first, at.0), cut(second, at.1));
            if is_spliced {
                format!("{}{piece}{}", &first[..from], &second[to..])
            } else {
                let rest = cut(first, (from + at.2).min(first.len()));
                format!("{}{piece}{}", &first[..from], &first[rest.max(from)..])
            }
        });
        survives(&text)?;
    }

    #[test]
    fn random_text_never_panics(text in "\\PC{0,60}") {
        survives(&text)?;
    }

    #[test]
    fn random_bytes_never_panic(bytes in vec(any::<u8>(), 0..60)) {
        if let Err(errors) = read_bytes(&bytes, &Options::default()) {
            errors.render(None, &String::from_utf8_lossy(&bytes), false);
        }
    }

    #[test]
    fn broken_formulas_never_panic(
        statement in statement(),
        at in 0_usize..1000,
        piece in prop::sample::select(PIECES),
    ) {
        let mut text = statement.to_string();
        let mut at = at % (text.len() + 1);
        while !text.is_char_boundary(at) {
            at -= 1;
        }
        text.insert_str(at, piece);
        survives(&text)?;
    }
}
