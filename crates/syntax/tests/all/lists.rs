//! Expression lists, read as documents.

use std::fmt::Write as _;
use zeroset_ir::{Graph, Node, display};
use zeroset_ops::Op;
use zeroset_parser::{ErrorKind, NoteKind};
use zeroset_syntax::{Document, Options, SurfaceKind, is_expression_list, parse, read};

fn document(text: &str) -> Document {
    read(text, &Options::default()).unwrap_or_else(|e| panic!("{}", e.render(None, text, false)))
}

#[test]
fn a_list_is_one_solid_of_its_last_line() {
    let text = "\u{FEFF}# Ball\r\n# of radius 1\r\n\r\n_0 const 1\r\n_1 var-x\r\n_2 square _1\r\n\
        _3 var-y\r\n_4 square _3\r\n_5 add _2 _4\r\n_6 sub _5 _0\r\n";
    let list = document(text);
    assert_eq!((list.title.as_deref(), list.doc.as_str()), (Some("Ball"), "of radius 1"));
    let [surface] = &list.surfaces[..] else { panic!("one surface") };
    assert_eq!(surface.kind, SurfaceKind::Solid);
    assert_eq!(surface.echo, "sqr(x) + sqr(y) - 1 <= 0");
    assert_eq!(&text[surface.span.range()], "_6 sub _5 _0");
    let kinds: Vec<&NoteKind> = list.notes.iter().map(|note| &note.kind).collect();
    assert_eq!(kinds, [&NoteKind::ExpressionList { name: "_6".to_owned() }]);
    // The same formula in our own notation has the same nodes.
    let typed = document("square(x) + square(y) - 1 <= 0");
    let shown = |document: &Document| display(&document.graph, document.surfaces[0].root, &[]);
    assert_eq!(shown(&list), shown(&typed));
    assert_eq!(parse(text, &zeroset_parser::Limits::default()).expect("reads"), []);
}

#[test]
fn a_solid_has_a_value_everywhere() {
    let list = document("a var-x\nb ln a");
    assert_eq!(display(&list.graph, list.surfaces[0].root, &[]), "otherwise(ln(x), 1)");
}

#[test]
fn lines_about_the_picture_stand_between_lines_of_a_list() {
    let list = document("color red 50%\n_0 var-x\ndomain 2\n_1 neg _0\nlook paper\nview front\n");
    assert_eq!(
        list.lines.iter().map(|line| line.word).collect::<Vec<_>>(),
        ["color", "domain", "look", "view"]
    );
    assert!(list.domain.is_some() && list.view.is_some() && list.look.is_some());
    assert!((list.surfaces[0].opacity - 0.5).abs() < 1e-9 && list.surfaces[0].color.is_some());
    let timed = document("_0 var-x\ncolor viridis(z + t)");
    assert_eq!(timed.parameters.len(), 1, "the time");
    let error = |text: &str| {
        let errors = read(text, &Options::default()).expect_err("refused");
        let error = errors.iter().next().expect("an error").clone();
        (text[error.span.range()].to_owned(), error.kind)
    };
    assert!(matches!(error("_0 var-x\nlook papr"), (at, ErrorKind::BadLook) if at == "papr"));
    // A name of a list may be a word of ours, if an operation follows.
    assert_eq!(document("view var-x\ndomain neg view").surfaces[0].echo, "-x <= 0");
    assert_eq!(error("_0 const 2\n_1 squar _0").0, "squar");
    let overrides = [("r".to_owned(), "2".to_owned())];
    let options = Options { overrides: &overrides, ..Options::default() };
    let errors = read("_0 var-x", &options).expect_err("no such name");
    assert!(matches!(
        errors.iter().next().map(|e| &e.kind),
        Some(ErrorKind::UnknownOverride { .. })
    ));
}

/// A list like Prospero's: some thousand outlines in the plane, each of a few edges, joined one
/// after the other, so that the chain of minima is as long as the outlines are many.
fn outlines(count: usize) -> String {
    let mut text = String::from("# outlines\n_x var-x\n_y var-y\n");
    for i in 0..count {
        let place = (i as f64 * 0.618_034) % 2.0 - 1.0;
        writeln!(text, "c{i:x} const {place:.6}\nd{i:x} sub _x c{i:x}").unwrap();
        writeln!(text, "e{i:x} mul d{i:x} c{i:x}\nf{i:x} sub _y e{i:x}").unwrap();
        writeln!(text, "g{i:x} neg f{i:x}\nh{i:x} max d{i:x} g{i:x}").unwrap();
        let before = if i == 0 { "_y".to_owned() } else { format!("m{:x}", i - 1) };
        writeln!(text, "m{i:x} min {before} h{i:x}").unwrap();
    }
    text
}

#[test]
fn long_lists_are_read_line_by_line() {
    let count = 20_000;
    let text = outlines(count);
    // A stack of 64 KB would not hold a frame for each level.
    let thread = std::thread::Builder::new().stack_size(1 << 16).spawn(move || document(&text));
    let list = thread.expect("a thread").join().expect("no overflow");
    let minima = |graph: &Graph| {
        graph.iter().filter(|(_, node)| matches!(node, Node::Apply(Op::Min, _))).count()
    };
    assert_eq!(minima(&list.graph), count);
    assert_eq!(list.surfaces[0].echo, "m4e1f <= 0");
}

#[test]
fn garbage_gives_one_short_message() {
    let lines: Vec<String> = (0..5000).map(|i| format!("q{i} )( \u{1} é{i} 0x")).collect();
    for text in [
        format!("_0 const 1\n{}", lines.join("\n")),
        format!("_0 {}\n", "add ".repeat(20_000)),
        format!("_0 const {}", "9".repeat(100_000) + "z"),
        format!("{} var-q", "n".repeat(100_000)),
        format!("_0 const 1\n_1 add _0 {}", "m".repeat(100_000)),
        "_0 const \u{0}1".to_owned(),
    ] {
        assert!(is_expression_list(&text));
        let errors = read(&text, &Options::default()).expect_err("refused");
        assert_eq!(errors.iter().count(), 1);
        let shown = errors.render(Some("model.vm"), &text, false);
        assert!(shown.len() < 2500, "{} bytes: {shown}", shown.len());
    }
    // Long decimals are numbers.
    document(&format!("_0 const 0.{}", "3".repeat(100_000)));
}
