//! Checks each row of the language corpus: a text, and how it is read or why it is refused.
//!
//! `ZEROSET_BLESS=1 cargo test -p zeroset-syntax --test all corpus` rewrites the results that the
//! rows expect. Read the difference before you commit it.

use std::fmt::Write as _;
use zeroset_ir::{Axis, Constant, Graph, Node, NodeId};
use zeroset_parser::Limits;
use zeroset_style::{CHOICES, Values};
use zeroset_syntax::{
    Contours, CurveShape, Document, DomainLine, MappedColor, Options, ParameterKind, PictureLines,
    SurfaceColor, SurfaceKind, parse, read,
};

const CORPUS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/data/language.txt");

/// A row of the corpus: an input, its options, and the expected result.
#[derive(Default)]
struct Row {
    line: usize,
    input: Vec<String>,
    overrides: Vec<(String, String)>,
    time: Option<f64>,
    graph: bool,
    expected: String,
}

fn number(value: &Constant) -> String {
    if let Some(exact) = value.exact() {
        return exact.to_string();
    }
    let bounds = value.bounds();
    format!("{}…", f64::midpoint(bounds.lo, bounds.hi))
}

fn vector(value: &[Constant; 3]) -> String {
    let [x, y, z] = value.each_ref().map(number);
    format!("({x}, {y}, {z})")
}

/// The expression at node `id`, in functional notation.
fn graph_text(graph: &Graph, id: NodeId) -> String {
    match graph.node(id) {
        Node::Variable(axis) => match axis {
            Axis::X => "x",
            Axis::Y => "y",
            Axis::Z => "z",
        }
        .to_owned(),
        Node::Parameter(index) => format!("#{index}"),
        Node::Constant(value) => number(value),
        Node::Apply(op, operands) => {
            let operands: Vec<String> = operands.iter().map(|id| graph_text(graph, *id)).collect();
            format!("{}({})", op.row().name, operands.join(", "))
        }
    }
}

/// Describes all settings of the picture except domain, view, look and background.
fn describe_picture(out: &mut String, picture: &PictureLines) {
    let PictureLines { clip, light, choices, is_equal, title, mesh, contours } = picture;
    if let Some(title) = title {
        writeln!(out, "title of the picture: {title}").unwrap();
    }
    if let Some(plane) = clip {
        let numbers = plane.each_ref().map(number).join(" ");
        writeln!(out, "clip: {numbers}").unwrap();
    }
    if let Some(place) = light {
        writeln!(out, "light: {}", vector(place)).unwrap();
    }
    if let Some(on) = mesh {
        writeln!(out, "mesh: {on}").unwrap();
    }
    for row in CHOICES {
        match (row.get)(choices) {
            Some(value) if row.values == Values::Switch => {
                writeln!(out, "{}: {}", row.word, value == 1.0).unwrap();
            }
            Some(value) => writeln!(out, "{}: {value}", row.word).unwrap(),
            None => {}
        }
    }
    if *is_equal {
        out.push_str("aspect: equal\n");
    }
    if let Some(Contours { value, step }) = contours {
        let value = value.as_ref().map_or("-", |value| &value.echo);
        let step = step.as_ref().map_or("-".to_owned(), number);
        writeln!(out, "contours: {value}, {step}").unwrap();
    }
}

fn describe_patches(out: &mut String, document: &Document) {
    for patch in &document.patches.all {
        write!(out, "surface of {}: {}", patch.names.join(", "), patch.echo).unwrap();
        if let Some(SurfaceColor::Plain(color)) = &patch.color {
            write!(out, "  [color {:?}]", color.rgb).unwrap();
        }
        if patch.hidden {
            out.push_str("  [hidden]");
        }
        out.push('\n');
    }
}

fn describe_curves(out: &mut String, row: &Row, document: &Document) {
    for curve in &document.curves.all {
        let kind = match curve.shape {
            CurveShape::Intersection(_) => "curve of equations",
            CurveShape::Path { .. } => "curve of a parameter",
            CurveShape::Point { .. } => "point",
        };
        write!(out, "{kind}: {}", curve.echo).unwrap();
        if let Some(SurfaceColor::Plain(color)) = &curve.color {
            write!(out, "  [color {:?}]", color.rgb).unwrap();
        }
        if let Some(width) = curve.width {
            write!(out, "  [width {width}]").unwrap();
        }
        if curve.hidden {
            out.push_str("  [hidden]");
        }
        out.push('\n');
        if row.graph {
            for root in curve.shape.roots() {
                writeln!(out, "graph: {}", graph_text(&document.curves.graph, root)).unwrap();
            }
        }
    }
}

fn describe(row: &Row, document: &Document) -> String {
    let mut out = String::new();
    if let Some(title) = &document.title {
        writeln!(out, "title: {title}").unwrap();
    }
    for line in document.doc.lines() {
        writeln!(out, "doc: {line}").unwrap();
    }
    for surface in &document.surfaces {
        let kind = match surface.kind {
            SurfaceKind::Equation => "equation",
            SurfaceKind::Solid => "solid",
        };
        write!(out, "{kind}: {}", surface.echo).unwrap();
        match &surface.color {
            Some(SurfaceColor::Plain(color)) => write!(out, "  [color {:?}]", color.rgb).unwrap(),
            Some(SurfaceColor::Mapped(MappedColor { map, value, range })) => {
                write!(out, "  [color {} of {}", map.name, value.echo).unwrap();
                if let Some([low, high]) = range {
                    write!(out, " from {} to {}", number(low), number(high)).unwrap();
                }
                out.push(']');
            }
            None => {}
        }
        if surface.material.name != "satin" {
            write!(out, "  [{}]", surface.material.name).unwrap();
        }
        if surface.hidden {
            out.push_str("  [hidden]");
        }
        if surface.opacity < 1.0 {
            write!(out, "  [opacity {}]", surface.opacity).unwrap();
        }
        out.push('\n');
        if row.graph {
            writeln!(out, "graph: {}", graph_text(&document.graph, surface.root)).unwrap();
        }
    }
    describe_patches(&mut out, document);
    describe_curves(&mut out, row, document);
    for parameter in &document.parameters {
        let kind = match parameter.kind {
            ParameterKind::Slider => "slider",
            ParameterKind::Time => "time",
        };
        write!(
            out,
            "{kind} #{}: {} = {}",
            parameter.number,
            parameter.name,
            number(&parameter.value)
        )
        .unwrap();
        match &parameter.range {
            Some((low, high)) => writeln!(out, " in [{}, {}]", number(low), number(high)).unwrap(),
            None => out.push('\n'),
        }
    }
    match &document.domain {
        None => {}
        Some(DomainLine::Auto) => out.push_str("domain: auto\n"),
        Some(DomainLine::Ball(radius)) => {
            writeln!(out, "domain: ball {}", number(radius)).unwrap();
        }
        Some(DomainLine::Box(axes)) => {
            let axis = |range: &Option<(Constant, Constant)>| match range {
                Some((low, high)) => format!("[{}, {}]", number(low), number(high)),
                None => "-".to_owned(),
            };
            writeln!(out, "domain: {}", axes.each_ref().map(axis).join(" ")).unwrap();
        }
    }
    describe_picture(&mut out, &document.picture);
    if let Some(view) = &document.view {
        out.push_str("view:");
        if let Some(preset) = view.preset {
            write!(out, " {}", preset.name).unwrap();
        }
        for (key, value) in [("eye", &view.eye), ("target", &view.target), ("up", &view.up)] {
            if let Some(value) = value {
                write!(out, " {key} {}", vector(value)).unwrap();
            }
        }
        for (key, value) in [("fov", &view.fov), ("ortho", &view.ortho)] {
            if let Some(value) = value {
                write!(out, " {key} {}", number(value)).unwrap();
            }
        }
        out.push('\n');
    }
    for note in &document.notes {
        writeln!(out, "note {}..{}: {}", note.span.start, note.span.end, note.message()).unwrap();
    }
    out
}

fn actual(row: &Row) -> String {
    let text = row.input.join("\n");
    let options = Options { overrides: &row.overrides, time: row.time, ..Options::default() };
    match read(&text, &options) {
        Ok(document) => describe(row, &document),
        Err(errors) => {
            let mut rendered = String::new();
            for line in errors.render(None, &text, false).lines().filter(|line| !line.is_empty()) {
                rendered.push_str(line.trim_end());
                rendered.push('\n');
            }
            rendered
        }
    }
}

/// Splits the corpus into rows, and lines that are kept unchanged: comments and blank lines.
fn rows(text: &str) -> Vec<Result<Row, String>> {
    let mut parts: Vec<Result<Row, String>> = Vec::new();
    let mut row: Option<Row> = None;
    for (index, line) in text.lines().enumerate() {
        let is_input = line.starts_with('>');
        let is_comment = line.starts_with("# ") || line.is_empty();
        let ends_row =
            row.as_ref().is_some_and(|row| is_comment || (is_input && !row.expected.is_empty()));
        if ends_row {
            parts.extend(row.take().map(Ok));
        }
        if is_comment {
            parts.push(Err(line.to_owned()));
            continue;
        }
        let row = row.get_or_insert_with(|| Row { line: index + 1, ..Row::default() });
        if let Some(input) = line.strip_prefix('>') {
            row.input.push(input.strip_prefix(' ').unwrap_or(input).to_owned());
        } else if let Some(given) = line.strip_prefix("with -D ") {
            let (name, value) = given.split_once('=').expect("a name and a value");
            row.overrides.push((name.to_owned(), value.to_owned()));
        } else if let Some(time) = line.strip_prefix("with --time ") {
            row.time = Some(time.parse().expect("a time"));
        } else if line == "with graph" {
            row.graph = true;
        } else {
            row.expected.push_str(line);
            row.expected.push('\n');
        }
    }
    parts.extend(row.map(Ok));
    parts
}

fn input_text(row: &Row) -> String {
    let mut out = String::new();
    for line in &row.input {
        out.push_str(format!("> {line}").trim_end());
        out.push('\n');
    }
    for (name, value) in &row.overrides {
        writeln!(out, "with -D {name}={value}").unwrap();
    }
    if let Some(time) = row.time {
        writeln!(out, "with --time {time}").unwrap();
    }
    if row.graph {
        out.push_str("with graph\n");
    }
    out
}

#[test]
fn every_row_reads_as_the_corpus_says() {
    let text = std::fs::read_to_string(CORPUS).expect("the corpus is there");
    let parts = rows(&text);
    if std::env::var_os("ZEROSET_BLESS").is_some() {
        let mut blessed = String::new();
        for part in &parts {
            match part {
                Ok(row) => {
                    blessed.push_str(&input_text(row));
                    blessed.push_str(&actual(row));
                }
                Err(line) => writeln!(blessed, "{line}").unwrap(),
            }
        }
        std::fs::write(CORPUS, blessed).expect("the corpus can be written");
        return;
    }
    let mut count = 0;
    let mut wrong = Vec::new();
    for row in parts.iter().flatten() {
        count += 1;
        let actual = actual(row);
        if actual != row.expected {
            wrong.push(format!(
                "tests/data/language.txt:{}\n{}expected:\n{}actual:\n{actual}",
                row.line,
                input_text(row),
                row.expected
            ));
        }
    }
    assert!(count >= 200, "only {count} rows");
    assert!(wrong.is_empty(), "{} of {count} rows:\n\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn every_row_that_reads_is_printed_and_read_alike() {
    let text = std::fs::read_to_string(CORPUS).expect("the corpus is there");
    let mut count = 0;
    for row in rows(&text).iter().flatten() {
        let Ok(statements) = parse(&row.input.join("\n"), &Limits::default()) else {
            continue;
        };
        let printed: Vec<String> = statements.iter().map(ToString::to_string).collect();
        let printed = printed.join("\n");
        if printed.is_empty() {
            continue;
        }
        match parse(&printed, &Limits::default()) {
            Ok(again) => assert_eq!(again, statements, "{printed}"),
            Err(errors) => panic!("{}", errors.render(None, &printed, false)),
        }
        count += 1;
    }
    assert!(count >= 150, "only {count} rows");
}
