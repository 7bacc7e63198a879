//! Checks texts that people paste. Every row of the corpora is read as meant, or is refused with a
//! message that says what to write.
//!
//! A text's function is compared with that of an equivalent plain text, at seeded points. The
//! values are exact where possible, and otherwise enclosures.

use std::fmt::Write as _;
use zeroset_interval::Interval;
use zeroset_ir::{Axis, Constant, Graph, Node, NodeId, simplify};
use zeroset_ops::Op;
use zeroset_parser::Limits;
use zeroset_syntax::{CurveShape, Document, Options, Patch, SurfaceKind, parse, read};

/// The corpus used in developing the language, two corpora that were not used for it, and programs
/// whose statements have effects in unusual places.
const CORPORA: [&str; 4] =
    ["words.txt", "words_held_out.txt", "words_third.txt", "words_programs.txt"];

/// Number of points at which functions are compared.
const POINTS: usize = 60;

#[derive(Default)]
pub(crate) struct Row {
    /// File and line of the row.
    pub place: String,
    style: String,
    is_from_a_page: bool,
    pub text: String,
    pub meant: String,
    pub message: Option<String>,
    pub notes: Vec<String>,
    domain: Option<String>,
    /// Coordinates of points and curves, one line for each.
    pub places: Vec<String>,
}

pub(crate) fn rows(corpus: &str) -> Vec<Row> {
    let path = format!("{}/../../tests/data/{corpus}", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).expect("the corpus is there");
    let mut rows: Vec<Row> = Vec::new();
    for (index, line) in text.lines().enumerate() {
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        if let Some(head) = line.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')) {
            let (style, page) = head.split_once(": ").unwrap_or((head, ""));
            let is_from_a_page = !page.is_empty();
            rows.push(Row {
                place: format!("{corpus}:{}", index + 1),
                style: style.to_owned(),
                is_from_a_page,
                ..Row::default()
            });
            continue;
        }
        let row = rows.last_mut().expect("a row begins with its style");
        let (sign, rest) = line.split_at(1);
        let rest = rest.strip_prefix(' ').unwrap_or(rest);
        let add = |to: &mut String| {
            if !to.is_empty() {
                to.push('\n');
            }
            to.push_str(&rest.replace('␍', "\r"));
        };
        match sign {
            ">" => add(&mut row.text),
            "=" => add(&mut row.meant),
            "!" => row.message = Some(rest.to_owned()),
            "~" => row.notes.push(rest.to_owned()),
            "*" => row.places.push(rest.to_owned()),
            "@" => row.domain = Some(rest.to_owned()),
            _ => panic!("{corpus}:{}: {line}", index + 1),
        }
    }
    rows
}

/// The value of a function at a point, or `None` where it is undefined.
pub(crate) fn value(document: &Document, root: NodeId, point: &[Constant; 3]) -> Option<Constant> {
    value_in(&document.graph, &parameters(document), root, point)
}

fn parameters(document: &Document) -> Vec<Constant> {
    document.parameters.iter().map(|parameter| parameter.value.clone()).collect()
}

pub(crate) fn value_in(
    given: &Graph,
    parameters: &[Constant],
    root: NodeId,
    point: &[Constant; 3],
) -> Option<Constant> {
    let mut graph = Graph::new();
    let mut map: Vec<NodeId> = Vec::new();
    for (_, node) in given.iter() {
        map.push(match node {
            Node::Variable(axis) => graph.constant(
                point[match axis {
                    Axis::X => 0,
                    Axis::Y => 1,
                    Axis::Z => 2,
                }]
                .clone(),
            ),
            Node::Parameter(number) => graph.constant(parameters[*number as usize].clone()),
            Node::Constant(value) => graph.constant(value.clone()),
            Node::Apply(op, operands) => {
                let operands: Vec<NodeId> = operands.iter().map(|id| map[id.index()]).collect();
                graph.apply(*op, &operands)
            }
        });
    }
    let (graph, roots) =
        simplify(&graph, &[map[root.index()]], &[Interval::ENTIRE; 3], &[]).ok()?;
    match graph.node(roots[0]) {
        Node::Constant(value) => Some(Constant::clone(value)),
        _ => None,
    }
}

/// Points with coordinates in eighths, from −2.5 to 2.5. Every tenth is on a coordinate plane.
pub(crate) fn points() -> Vec<[Constant; 3]> {
    let mut state = 0x7a65_726f_u64;
    let mut next = |most: u64| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state % most
    };
    let mut points = Vec::new();
    for index in 0..POINTS {
        let mut eighth = || {
            let number = i64::try_from(next(41)).expect("small") - 20;
            Constant::ratio(number, 8).expect("not zero")
        };
        let mut point = [eighth(), eighth(), eighth()];
        if index % 10 == 9 {
            point[index / 10 % 3] = Constant::integer(0);
        }
        points.push(point);
    }
    points
}

fn agree(left: Option<&Constant>, right: Option<&Constant>) -> bool {
    match (left, right) {
        (None, None) => true,
        (Some(left), Some(right)) => {
            if let (Some(left), Some(right)) = (left.exact(), right.exact()) {
                return left == right;
            }
            let (a, b) = (left.bounds(), right.bounds());
            let size = 1.0 + a.lo.abs().max(a.hi.abs());
            a.lo.max(b.lo) - a.hi.min(b.hi) <= 1e-9 * size && a.hi - a.lo <= 1e-6 * size
        }
        _ => false,
    }
}

/// Describes how a text's domain differs from the domain that its row requires, if it does.
fn wrong_domain(row: &Row, document: &Document) -> Option<String> {
    let wanted = row.domain.as_ref()?;
    let line: Vec<String> = ["x", "y", "z"]
        .iter()
        .zip(wanted.replace("] ", "]\n").lines())
        .filter(|(_, range)| *range != "-")
        .map(|(axis, range)| format!("{axis} in {range}"))
        .collect();
    let meant = read(&format!("domain {}\nx", line.join(", ")), &Options::default());
    let meant = meant.expect("a domain").domain;
    (document.domain != meant).then(|| format!("domain {:?}", document.domain))
}

/// Describes how the curves and points of a text differ from those of a plain text.
fn wrong_curves(own: &Document, meant: &Document, points: &[[Constant; 3]]) -> Option<String> {
    let (curves, others) = (&own.curves, &meant.curves);
    if curves.all.len() != others.all.len() {
        return Some(format!("{} curves", curves.all.len()));
    }
    for (one, other) in curves.all.iter().zip(&others.all) {
        let places: Vec<Vec<Option<Constant>>> = [(own, one), (meant, other)]
            .into_iter()
            .map(|(document, curve)| values_along(document, &curve.shape, points))
            .collect();
        let [read, plain] = &places[..] else { panic!("two") };
        let agrees = |(a, b): (&Option<Constant>, &Option<Constant>)| agree(a.as_ref(), b.as_ref());
        if read.len() != plain.len() || !read.iter().zip(plain).all(agrees) {
            return Some(format!("read as {}\n{read:?}\nnot {plain:?}", one.echo));
        }
    }
    None
}

/// Describes how the places of points and curves differ from those in the row, if they do.
fn wrong_places(row: &Row, document: &Document) -> Option<String> {
    let places = |shape: &CurveShape| -> Vec<f64> {
        let values = values_along(document, shape, &[]);
        let ends = values.iter().take(3).chain(values.iter().skip(3).rev().take(3).rev());
        ends.map(|value| value.as_ref().map_or(f64::NAN, |value| value.bounds().lo)).collect()
    };
    let read: Vec<Vec<f64>> =
        document.curves.all.iter().map(|curve| places(&curve.shape)).collect();
    let numbers = |line: &String| -> Vec<f64> {
        line.split(' ').map(|number| number.parse().expect("a number")).collect()
    };
    let wanted: Vec<Vec<f64>> = row.places.iter().map(numbers).collect();
    (read != wanted).then(|| format!("places {read:?}"))
}

/// The coordinates of a point, those of a curve's points from end to end, or the values of the
/// functions of a curve.
pub(crate) fn values_along(
    document: &Document,
    shape: &CurveShape,
    points: &[[Constant; 3]],
) -> Vec<Option<Constant>> {
    let graph = &document.curves.graph;
    let mut parameters = parameters(document);
    let none = [(); 3].map(|()| Constant::integer(0));
    parameters.push(Constant::integer(0));
    match shape {
        CurveShape::Intersection(both) => {
            let at = |point| both.map(|root| value_in(graph, &parameters, root, point));
            points.iter().flat_map(at).collect()
        }
        CurveShape::Point { at, .. } => {
            at.iter().map(|root| value_in(graph, &parameters, *root, &none)).collect()
        }
        CurveShape::Path { at, ends } => {
            let ends = ends.map(|end| value_in(graph, &parameters, end, &none).expect("an end"));
            let mut all = Vec::new();
            for step in 0..=7 {
                let mut sum = Graph::new();
                let share = sum.constant(Constant::ratio(step, 7).expect("not zero"));
                let [low, high] = ends.clone().map(|end| sum.constant(end));
                let extent = sum.apply(Op::Sub, &[high, low]);
                let along = sum.apply(Op::Mul, &[extent, share]);
                let place = sum.apply(Op::Add, &[low, along]);
                let place = value_in(&sum, &[], place, &none).expect("a number");
                parameters.truncate(document.parameters.len());
                parameters.push(place);
                all.extend(at.iter().map(|root| value_in(graph, &parameters, *root, &none)));
            }
            all
        }
    }
}

/// Describes how parametric surfaces differ from those that are meant, if they do. The points' x
/// and y stand for u and v.
fn wrong_patches(
    document: &Document,
    meant: &Document,
    points: &[[Constant; 3]],
) -> Option<String> {
    let (own, other) = (&document.patches, &meant.patches);
    if own.all.len() != other.all.len() {
        return Some(format!("{} parametric surfaces", own.all.len()));
    }
    for (patch, plain) in own.all.iter().zip(&other.all) {
        let roots = |patch: &Patch| -> Vec<NodeId> {
            patch.at.iter().chain(patch.ends.as_flattened()).copied().collect()
        };
        for (root, as_meant) in roots(patch).into_iter().zip(roots(plain)) {
            for point in points {
                let read = value_in(&own.graph, &parameters(document), root, point);
                let plain = value_in(&other.graph, &parameters(meant), as_meant, point);
                if !agree(read.as_ref(), plain.as_ref()) {
                    return Some(format!(
                        "read as {}\nat {point:?}: {read:?}, not {plain:?}",
                        patch.echo
                    ));
                }
            }
        }
    }
    None
}

/// Describes how the reading of a row differs from what the row requires, if it does.
pub(crate) fn wrong(row: &Row, points: &[[Constant; 3]]) -> Option<String> {
    let document = read(&row.text, &Options::default());
    let document = match (document, &row.message) {
        (Err(errors), Some(message)) => {
            let rendered = errors.render(None, &row.text, false);
            let names_a_way_out = rendered.contains("= help: ");
            let is_meant = rendered.contains(message.as_str()) && names_a_way_out;
            return (!is_meant).then(|| format!("refused otherwise:\n{rendered}"));
        }
        (Ok(document), Some(_)) => {
            let mut echoes = document.drawn_surfaces().map(|surface| surface.echo);
            return Some(format!("read as {}", echoes.next().unwrap_or("a curve")));
        }
        (Err(errors), None) => return Some(errors.render(None, &row.text, false)),
        (Ok(document), None) => document,
    };
    let notes: Vec<String> = document.notes.iter().map(zeroset_parser::Note::message).collect();
    if let Some(missing) =
        row.notes.iter().find(|wanted| !notes.iter().any(|note| note.contains(wanted.as_str())))
    {
        return Some(format!("no note with {missing:?} in {notes:?}"));
    }
    if let Some(what) = wrong_domain(row, &document) {
        return Some(what);
    }
    if !row.places.is_empty() {
        if let Some(what) = wrong_places(row, &document) {
            return Some(what);
        }
        if row.meant.is_empty() {
            return (!document.surfaces.is_empty()).then(|| "a surface".to_owned());
        }
    }
    let meant = match read(&row.meant, &Options::default()) {
        Ok(meant) => meant,
        Err(errors) => return Some(errors.render(None, &row.meant, false)),
    };
    if meant.surfaces.len() != document.surfaces.len() {
        return Some(format!("{} surfaces", document.surfaces.len()));
    }
    if row.places.is_empty()
        && let Some(what) = wrong_curves(&document, &meant, points)
    {
        return Some(what);
    }
    if let Some(what) = wrong_patches(&document, &meant, points) {
        return Some(what);
    }
    for (own, other) in document.surfaces.iter().zip(&meant.surfaces) {
        if own.kind != other.kind {
            let is = if own.kind == SurfaceKind::Solid { "a solid" } else { "an equation" };
            return Some(format!("{is}: {}", own.echo));
        }
        let mut defined = 0;
        for point in points {
            let read = value(&document, own.root, point);
            let plain = value(&meant, other.root, point);
            defined += usize::from(plain.is_some());
            if !agree(read.as_ref(), plain.as_ref()) {
                return Some(format!(
                    "read as {}\nat {point:?}: {read:?}, not {plain:?}",
                    own.echo
                ));
            }
        }
        if defined < POINTS / 10 {
            return Some(format!("compared at {defined} points only"));
        }
    }
    None
}

#[test]
fn words_are_read_as_meant_or_refused_with_a_way_out() {
    let points = points();
    let rows: Vec<Row> = CORPORA.iter().flat_map(|corpus| rows(corpus)).collect();
    let mut report = String::new();
    let mut count = 0;
    for row in &rows {
        if let Some(what) = wrong(row, &points) {
            count += 1;
            writeln!(report, "{}\n{}\n{what}\n", row.place, row.text).unwrap();
        }
    }
    assert!(report.is_empty(), "{count} of {} rows:\n\n{report}", rows.len());
}

/// Outcomes of the rows of a corpus.
struct Outcomes {
    as_meant: usize,
    rows: usize,
    /// Rows that are to be read, or to be refused otherwise, and are refused.
    refused: Vec<String>,
    /// Rows that are read otherwise than meant.
    wrongly: Vec<String>,
}

fn outcomes(corpus: &str) -> Outcomes {
    let points = points();
    let rows = rows(corpus);
    let rows: Vec<&Row> =
        rows.iter().filter(|row| row.message.is_some() || !row.meant.is_empty()).collect();
    let (mut refused, mut wrongly) = (Vec::new(), Vec::new());
    for row in &rows {
        let Some(what) = wrong(row, &points) else { continue };
        let is_refused = read(&row.text, &Options::default()).is_err();
        let report = if is_refused { &mut refused } else { &mut wrongly };
        report.push(format!("{}\n{}\n{what}\n", row.place, row.text));
    }
    let as_meant = rows.len() - refused.len() - wrongly.len();
    Outcomes { as_meant, rows: rows.len(), refused, wrongly }
}

/// Rows of the fourth corpus are read as meant, or refused. None is read otherwise. Refused are
/// curves over arrays of numbers, and functions without proven bounds.
#[test]
fn the_fourth_list_is_read_as_meant_with_few_exceptions() {
    let Outcomes { as_meant, rows, refused, wrongly } = outcomes("words_fourth.txt");
    let (refused, wrongly) = (refused.concat(), wrongly.concat());
    assert!(wrongly.is_empty(), "{wrongly}\n==== refused\n{refused}{as_meant}");
    assert!(as_meant * 100 >= rows * 95, "{as_meant} of {rows}:\n\n{refused}");
}

/// Two newer lists: as many rows are read as meant as when this was written, at least.
#[test]
fn newer_lists_are_read_as_meant_as_far_as_known() {
    for (corpus, least, most_wrong) in [("words_fifth.txt", 373, 0), ("words_kinds.txt", 314, 0)] {
        let Outcomes { as_meant, rows, refused, wrongly } = outcomes(corpus);
        let wrong = wrongly.len();
        let report = format!("{}\n==== refused\n{}", wrongly.concat(), refused.concat());
        println!("{corpus}: {as_meant} of {rows}, {wrong} otherwise\n{report}");
        assert!(as_meant >= least && wrong <= most_wrong, "{as_meant}, {wrong}\n{report}");
    }
}

#[test]
fn the_corpus_is_as_wide_as_it_must_be() {
    let rows = rows(CORPORA[0]);
    let read = rows.iter().filter(|row| row.message.is_none()).count();
    let pages = rows.iter().filter(|row| row.is_from_a_page).count();
    assert!(rows.len() >= 300, "{} rows", rows.len());
    assert!(pages >= 60, "{pages} from pages");
    assert!(read * 100 >= rows.len() * 95, "{read} of {} are to be read", rows.len());
    for style in
        ["desmos", "mathematica", "glsl", "python", "latex", "sympy", "geogebra", "openscad"]
    {
        let of_style = || rows.iter().filter(|row| row.style == style);
        assert!(of_style().count() >= 10, "{style}: {}", of_style().count());
        assert!(of_style().any(|row| row.is_from_a_page), "{style}: none from a page");
    }
}

#[test]
fn what_was_read_is_printed_and_read_alike() {
    let known = CORPORA.iter().flat_map(|corpus| rows(corpus)).filter(|row| row.message.is_none());
    let known = known.map(|row| parse(&row.text, &Limits::default()).expect(&row.text));
    let fourth = rows("words_fourth.txt").into_iter();
    let fourth = fourth.filter_map(|row| parse(&row.text, &Limits::default()).ok());
    for statements in known.chain(fourth) {
        let printed: Vec<String> = statements.iter().map(ToString::to_string).collect();
        let printed = printed.join("\n");
        match parse(&printed, &Limits::default()) {
            Ok(again) => assert_eq!(again, statements, "{printed}"),
            Err(errors) => panic!("{}", errors.render(None, &printed, false)),
        }
    }
}

#[test]
fn every_form_is_read_as_its_help_says() {
    for form in zeroset_ops::FORMS {
        for name in std::iter::once(&form.name).chain(form.aliases) {
            let usage = form.usage.replacen(form.name, name, 1);
            // Mathematica's `nest` takes the start value before the number of repetitions.
            let usage = usage.replace("nest(f, 3, x)", "nest(f, x, 3)");
            let text = format!("f(a) = a^2\np = vec3(x, y, z)\nq = p\nn = p\nz = {usage}");
            let read = parse(&text, &Limits::default());
            let statements = read.unwrap_or_else(|e| panic!("{}", e.render(None, &text, false)));
            let printed = statements[statements.len() - 1].to_string();
            assert!(!printed.contains('?'), "{printed}");
        }
    }
}
