//! What is written in a format reads back as the same function.

use zeroset_interval::Interval;
use zeroset_ir::{Graph, Node, NodeId, simplify};
use zeroset_ops::Op;
use zeroset_syntax::{Document, EmitError, Format, Options, emit, read};

/// Adds the functions of all surfaces to `graph`. A solid's function may lose the value that it
/// has where it is not defined.
fn add(graph: &mut Graph, document: &Document) -> Vec<NodeId> {
    let mut places: Vec<NodeId> = Vec::new();
    for (_, node) in document.graph.iter() {
        places.push(match node {
            Node::Variable(axis) => graph.variable(*axis),
            Node::Parameter(number) => graph.parameter(*number),
            Node::Constant(value) => graph.constant(value.clone()),
            Node::Apply(op, operands) => {
                let operands: Vec<NodeId> = operands.iter().map(|id| places[id.index()]).collect();
                graph.apply(*op, &operands)
            }
        });
    }
    let function = |root: NodeId| match document.graph.node(root) {
        Node::Apply(Op::Otherwise, operands) => operands[0],
        _ => root,
    };
    document.surfaces.iter().map(|surface| places[function(surface.root).index()]).collect()
}

/// Returns whether two documents have the same functions: as typed, or only once simplified.
fn same(one: &Document, other: &Document, as_typed: bool) -> bool {
    let mut graph = Graph::new();
    let [mut first, mut second] = [one, other].map(|document| add(&mut graph, document));
    let count = first.len();
    if !as_typed {
        first.append(&mut second);
        let simple = simplify(&graph, &first, &[Interval::ENTIRE; 3], &[]).expect("small").1;
        (first, second) = (simple[..count].to_vec(), simple[count..].to_vec());
    }
    first == second
}

fn document(text: &str) -> Document {
    read(text, &Options::default()).unwrap_or_else(|e| panic!("{}", e.render(None, text, false)))
}

/// Writes `text` in a format and reads the result. `None` if the format cannot hold it.
fn again(text: &str, format: Format) -> Option<(String, Document)> {
    let written = match emit(&document(text), text, format) {
        Ok(written) => written,
        Err(error) => {
            assert!(error.to_string().starts_with(&format!("`{}` ", format.name())), "{error}");
            return None;
        }
    };
    let read = read(&written, &Options::default());
    let read = read.unwrap_or_else(|e| panic!("{text}\n{}", e.render(None, &written, false)));
    Some((written, read))
}

/// Formulas over most operations, in the formats that hold them.
const FORMULAS: &[(&str, &[Format])] = &{
    use Format::{Glsl, Tex, Vm, Zset};
    [
        ("x^2 + y^2 + z^2 = 1", &[Vm, Glsl, Tex, Zset] as &[Format]),
        ("(x - 0.125)^3 - -y*z^-2 <= 3", &[Vm, Glsl, Tex, Zset]),
        ("min(x, max(y, -z)) - abs(x*y) <= 0", &[Vm, Glsl, Tex, Zset]),
        ("sqrt(x)/(y - z) - (x - (y - z)) = 0", &[Vm, Glsl, Tex, Zset]),
        ("sin(x)*cos(y)/tan(z) + exp(-x)^2 - ln(y)", &[Vm, Glsl, Tex, Zset]),
        ("asin(x) + acos(y) + atan(z) + atan2(x, y)", &[Vm, Glsl, Tex, Zset]),
        ("floor(x) + ceil(y) + mod(z, 2.5)", &[Vm, Glsl, Tex, Zset]),
        ("sign(x - y) + sqr(z)", &[Vm, Glsl, Tex, Zset]),
        ("trunc(x) + fract(y) + log2(z)", &[Glsl, Tex, Zset]),
        ("sinh(x) + cosh(y) - tanh(z) + asinh(x) + acosh(y) + atanh(z)", &[Glsl, Tex, Zset]),
        ("cbrt(x) + log10(y) + round(z)", &[Tex, Zset]),
        ("pi*x + e*y + tau*z + phi", &[Tex, Zset]),
        ("x^2.5 + y^z", &[Glsl, Tex, Zset]),
        ("{x >= 0: y, z} + x", &[Glsl, Tex, Zset]),
        ("step(x, y) + heaviside(z)", &[Glsl, Tex, Zset]),
        ("heaviside(ln(z)) - x", &[Zset]),
        ("{ln(x) >= 0: y, z} + x", &[]),
        ("x + y = z {z > 0, x != 1, y >= 0}", &[Tex, Zset]),
        ("z = {x > 0: y}", &[Tex, Zset]),
        ("r = 2 in [0, 5]\nx^2 + y^2 = r", &[Zset]),
        ("x = sin(t)", &[Zset]),
        ("x = 1\nln(y) <= z", &[Tex, Zset]),
        ("x = root(y, 7)", &[]),
        ("x", &[Vm, Glsl, Tex, Zset]),
        ("sinc(x) = y", &[]),
    ]
};

#[test]
fn every_format_reads_back_as_the_same_function() {
    let mut failures = Vec::new();
    for (text, formats) in FORMULAS {
        for format in Format::ALL {
            let found = again(text, format);
            if found.is_some() != formats.contains(&format) {
                failures.push(format!("{text} as {}: {}", format.name(), found.is_some()));
            }
            let Some((written, found)) = found else { continue };
            // Lists and GLSL have no whole powers, which become products.
            let as_typed = matches!(format, Format::Zset | Format::Tex);
            let typed = document(text);
            if !same(&typed, &found, as_typed) {
                failures.push(format!("{text} as {}:\n{written}", format.name()));
            }
            if as_typed {
                let kinds = |document: &Document| {
                    document.surfaces.iter().map(|surface| surface.kind).collect::<Vec<_>>()
                };
                assert_eq!(kinds(&typed), kinds(&found), "{text}");
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// The gallery's formulas are written in our own language, but for a few named operations.
#[test]
fn the_gallery_reads_back_as_the_same_functions() {
    let directory = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples");
    let mut written = [0; 4];
    let mut all = 0;
    for entry in std::fs::read_dir(directory).expect("a directory") {
        let path = entry.expect("an entry").path();
        if path.extension().is_none_or(|extension| extension != "zset") {
            continue;
        }
        let text = std::fs::read_to_string(&path).expect("a text");
        all += 1;
        for (count, format) in written.iter_mut().zip(Format::ALL) {
            let Some((text_again, found)) = again(&text, format) else { continue };
            let as_typed = matches!(format, Format::Zset | Format::Tex);
            let typed = document(&text);
            assert!(same(&typed, &found, as_typed), "{path:?} as {}:\n{text_again}", format.name());
            *count += 1;
        }
    }
    println!("of {all}: {written:?}");
    assert!(all > 30 && written.iter().all(|count| count * 2 > all), "{written:?} of {all}");
}

#[test]
fn what_a_format_cannot_hold_is_named() {
    let error =
        |text: &str, format| emit(&document(text), text, format).expect_err("refused").to_string();
    assert_eq!(error("pi*x", Format::Vm), "`vm` cannot hold the number pi");
    assert_eq!(error("r = 2\nx = r", Format::Glsl), "`glsl` cannot hold the slider `r`");
    assert_eq!(error("x = t", Format::Tex), "`tex` cannot hold the time `t`");
    let third = error("x = root(y, 7)", Format::Zset);
    assert_eq!(third, "`zset` cannot hold the number 1/7, which is no decimal");
    assert!(error("cbrt(x)", Format::Vm).contains("`cbrt`: cube root"));
    let two = emit(&document("x\ny"), "x\ny", Format::Vm).expect_err("two");
    assert_eq!(two, EmitError::SeveralSurfaces { format: Format::Vm, count: 2 });
}

#[test]
fn the_picture_and_the_title_of_a_document_are_kept() {
    let text = "# Ball\n# of glass\ndomain 2\ncolor red 50%\nx^2+y^2+z^2 <= 1\nlook paper";
    let written = emit(&document(text), text, Format::Zset).expect("written");
    let again = document(&written);
    assert_eq!((again.title.as_deref(), again.doc.as_str()), (Some("Ball"), "of glass"));
    assert!(again.domain.is_some() && again.look.is_some());
    assert!((again.surfaces[0].opacity - 0.5).abs() < 1e-9, "{written}");
}

#[test]
fn long_chains_are_written_line_by_line() {
    let lines: Vec<String> =
        (1..20_000).map(|i| format!("a{i} = min(a{}, x + {i}*y)", i - 1)).collect();
    let text = format!("a0 = z\n{}\na19999 <= 0", lines.join("\n"));
    let typed = document(&text);
    for format in [Format::Vm, Format::Tex, Format::Zset] {
        let (_, found) = again(&text, format).expect("written");
        assert!(same(&typed, &found, true), "{}", format.name());
    }
}
