//! The automatic domain against the one that a mathematician would choose, for a hundred typed
//! equations.
//!
//! All rows with their results: `cargo test --release --test all domains -- --nocapture`.

use fastrand::Rng;
use std::fmt::Write as _;
use std::time::Instant;
use zeroset_scene::domain::AutoDomain;
use zeroset_scene::view;
use zeroset_syntax::{Options, read};

/// The rows, and the description of their format.
const ROWS: &str = include_str!("../data/domains.txt");

/// Two boxes agree if each contains the other after growing by this factor about its center.
const TOLERANCE: f64 = 1.3;

/// Tolerance of wanted extents that were counted on a grid or typed with few digits, as a share of
/// the largest extent.
const COUNTED: f64 = 0.01;

pub struct Row {
    pub text: String,
    pub bounded: bool,
    wanted: Vec<f64>,
}

pub fn rows() -> Vec<Row> {
    let lines = ROWS.lines().filter(|line| !line.starts_with('#') && !line.is_empty());
    let row = |line: &str| {
        let parts: Vec<&str> = line.split(" | ").collect();
        let [text, what, place, _] = parts[..] else { panic!("not four parts: {line}") };
        assert!(["bounded", "window"].contains(&what), "{line}");
        let wanted: Vec<f64> =
            place.split(',').map(|number| number.parse().expect("a number")).collect();
        assert!(wanted.len() == 6 || what == "window" && wanted.len() == 1, "{line}");
        Row { text: text.replace(';', "\n"), bounded: what == "bounded", wanted }
    };
    lines.map(row).collect()
}

/// Whether the first interval contains `other` after growing by [`TOLERANCE`] about its middle and
/// by `spare` on each side.
pub fn holds([low, high]: [f64; 2], other: [f64; 2], spare: f64) -> bool {
    let (middle, half) = (low.midpoint(high), TOLERANCE * (high - low) / 2.0 + spare);
    middle - half <= other[0] && other[1] <= middle + half
}

/// The way in which a found domain differs from the wanted one, if it differs.
fn difference(row: &Row, found: &AutoDomain) -> Option<&'static str> {
    let ranges = [0, 1, 2].map(|axis| [found.low[axis], found.high[axis]]);
    if found.finding.is_bounded() != row.bounded {
        return Some(if row.bounded { "not proven bounded" } else { "bounded, it is said" });
    }
    if let [half] = row.wanted[..] {
        let largest = ranges.iter().map(|[low, high]| (high - low) / 2.0).fold(0.0, f64::max);
        let reach = ranges.as_flattened().iter().fold(0.0_f64, |most, end| most.max(end.abs()));
        let fits = |size: f64| size <= TOLERANCE * half && half <= TOLERANCE * size;
        return (!fits(largest) || reach > TOLERANCE * half).then_some("another size");
    }
    let wanted = [0, 1, 2].map(|axis| [row.wanted[2 * axis], row.wanted[2 * axis + 1]]);
    let spare = COUNTED * wanted.iter().map(|[low, high]| high - low).fold(0.0, f64::max);
    for (range, wanted) in ranges.into_iter().zip(wanted) {
        if row.bounded && (range[0] > wanted[0] || wanted[1] > range[1]) {
            return Some("cut");
        }
        if !holds(range, wanted, spare) || !holds(wanted, range, spare) {
            return Some("another box");
        }
    }
    None
}

/// Rows whose automatic domain is known to differ from the wanted one.
const MISSES: &[&str] = &[];

/// Least number of rows, of a hundred, that must agree.
const LEAST: usize = 90;

#[test]
fn domains_are_those_that_a_mathematician_would_choose() {
    let rows = rows();
    assert_eq!(rows.len(), 100);
    let (mut missed, mut report, mut times) = (Vec::new(), String::new(), Vec::new());
    for row in &rows {
        let document = read(&row.text, &Options::default()).expect(&row.text);
        let started = Instant::now();
        let found = view::search(&document).expect(&row.text);
        times.push(started.elapsed().as_secs_f64() * 1e3);
        let ms = times.last().copied().unwrap_or_default();
        let why = difference(row, &found);
        let name = row.text.lines().last().unwrap_or_default();
        let _ = writeln!(report, "{:18} {ms:6.2} ms {name}: {found:?}", why.unwrap_or("agrees"));
        // A bounded surface must not be cut. Other differences are a matter of judgment.
        assert!(!(row.bounded && why == Some("cut")), "{report}");
        missed.extend(why.map(|_| name.to_owned()));
    }
    times.sort_unstable_by(f64::total_cmp);
    let (median, worst) = (times[times.len() / 2], times[times.len() - 1]);
    println!("{report}{} of {} agree", rows.len() - missed.len(), rows.len());
    println!("median {median:.2} ms, worst {worst:.2} ms");
    assert_eq!(missed, MISSES, "{report}");
    assert!(rows.len() - missed.len() >= LEAST);
}

/// Unbounded surfaces. Moving one of them must move its domain by the same vector.
const UNBOUNDED: &[&str] = &[
    // Quadrics.
    "x^2+y^2-z^2=1",
    "z^2-x^2-y^2=1",
    "x^2+y^2-z^2=0.2",
    "x^2+y^2=z^2",
    "x=y^2+z^2",
    "x*y+y*z+z*x=1",
    // Cylinders.
    "x^2+y^2=1",
    "y^2=x^3-x",
    "x*y=1",
    // Surfaces with a name.
    "4(x^2+y^2+z^2)+16x*y*z=1",
    "x^3+y^3+z^3+1=(x+y+z+1)^3",
    "x^3+y^3+z^3=1",
    "x^2=y^2*z",
    "x^2+y^2=(1-z)z^2",
    "x*y*z=1",
    "x*y*z=1+3x",
    "4(phi^2*x^2-y^2)*(phi^2*y^2-z^2)*(phi^2*z^2-x^2)=(1+2phi)*(x^2+y^2+z^2-1)^2",
    "(x^2+y^2+z^2-1.3^2)^2=4.07/1.31*(1-z-sqrt(2)*x)*(1-z+sqrt(2)*x)*(1+z+sqrt(2)*y)*(1+z-sqrt(2)*y)",
    // Surfaces whose necks and nodes are off the axes through the middle.
    "((x-2)^2+(y-1)^2-z^2-0.1)*((x+2)^2+(y+1)^2-z^2-0.1)=1",
    "(x^2-1)^2+(y^2-1)^2=z^2",
    "z*((x^2-25)^2+(y^2-25)^2+z^2-4)=0.05",
    "x^2*y^2+y^2*z^2+x^2*z^2+x*y*z=0",
    // Heights as functions of two coordinates.
    "z=x^2+y^2",
    "z=x*y",
    "x^3-3x*y^2=z",
    "z=3*(1-x)^2*exp(-x^2-(y+1)^2)-10*(x/5-x^3-y^5)*exp(-x^2-y^2)-1/3*exp(-(x+1)^2-y^2)",
    "z=exp(-x^2-y^2)",
    "z=sin(sqrt(x^2+y^2))/sqrt(x^2+y^2)",
    "z=1/(x^2+y^2)",
    // Other functions.
    "sin(x*y*z)=0",
    "x^2+y^2=cosh(z)^2",
    "1/(x^2+y^2)+1/(y^2+z^2)=1",
    "sqrt(x^2+y^2)=z",
    "|x|+|y|-|z|=1",
];

/// Vectors that the surfaces are moved by.
const MOVES: &[[f64; 3]] =
    &[[2.0, 3.0, 4.0], [-7.5, 5.0, -10.0], [10.0, -0.5, 3.25], [0.3, -0.1, 0.2]];

/// The text with x, y and z replaced by their differences from `place`.
fn moved(text: &str, place: [f64; 3]) -> String {
    let mut moved = String::new();
    let mut rest = text;
    while !rest.is_empty() {
        let letters = rest.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(rest.len());
        let (word, after) = rest.split_at(letters.max(1));
        match ["x", "y", "z"].into_iter().position(|axis| axis == word) {
            Some(axis) => {
                let _ = write!(moved, "({word}-({}))", place[axis]);
            }
            None => moved.push_str(word),
        }
        rest = after;
    }
    moved
}

#[test]
fn what_is_moved_has_its_domain_moved() {
    let (mut report, mut count) = (String::new(), 0);
    for text in UNBOUNDED {
        for place in MOVES {
            count += 1;
            assert!(check_move(text, *place, &mut report), "{text} is bounded");
        }
    }
    assert!(report.is_empty(), "{report}of {count}");
}

/// A random polynomial: a power of each coordinate, and mixed terms that cancel none of these.
fn polynomial(rng: &mut Rng) -> String {
    let factor = |rng: &mut Rng| {
        let sign = if rng.bool() { '+' } else { '-' };
        format!("{sign}{}", rng.u32(1..=3))
    };
    let mut text = String::new();
    for axis in ["x", "y", "z"] {
        let _ = write!(text, "{}{axis}^{}", factor(rng), rng.u32(2..=4));
    }
    for _ in 0..rng.u32(0..=3) {
        text += &factor(rng);
        let left_out = rng.usize(0..3);
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            let least = u32::from(axis != left_out);
            let _ = write!(text, "*{name}^{}", rng.u32(least..=2));
        }
    }
    let _ = write!(text, "={}", rng.i32(-2..=2));
    text
}

#[test]
fn random_polynomials_that_are_moved_have_their_domains_moved() {
    let seed = 20_261_122;
    let mut rng = Rng::with_seed(seed);
    let (mut report, mut unbounded) = (String::new(), 0);
    for _ in 0..80 {
        let text = polynomial(&mut rng);
        let place = [0; 3].map(|_| f64::from(rng.i32(-1000..=1000)) / 100.0);
        unbounded += usize::from(check_move(&text, place, &mut report));
    }
    println!("seed {seed}: {unbounded} without end");
    assert!(unbounded >= 40);
    assert!(report.is_empty(), "{report}of {unbounded}, seed {seed}");
}

/// Checks that moving an unbounded surface moves its domain by the same vector, and reports
/// differences. Returns `false` if the surface is bounded or empty.
fn check_move(text: &str, place: [f64; 3], report: &mut String) -> bool {
    let find = |text: &str| {
        let document = read(text, &Options::default()).expect(text);
        view::search(&document).expect(text)
    };
    let here = find(text);
    if here.finding.is_bounded() || here.finding.is_empty() {
        return false;
    }
    let there = find(&moved(text, place));
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        // A move along an axis that the text does not depend on changes nothing.
        let depends = text != moved_along(text, axis);
        let by = if depends { place[axis] } else { 0.0 };
        let wanted = [here.low[axis] + by, here.high[axis] + by];
        let range = [there.low[axis], there.high[axis]];
        if !holds(range, wanted, 0.0) || !holds(wanted, range, 0.0) {
            let _ =
                writeln!(report, "{text} moved by {place:?}: {name} in {range:?}, not {wanted:?}");
        }
    }
    if here.finding != there.finding {
        let _ = writeln!(
            report,
            "{text} moved by {place:?}: {:?}, not {:?}",
            there.finding, here.finding
        );
    }
    true
}

/// The text moved by 1 along one axis.
fn moved_along(text: &str, axis: usize) -> String {
    let mut place = [0.0; 3];
    place[axis] = 1.0;
    let there = moved(text, place);
    let unmoved = |axis: usize| format!("({}-(0))", ["x", "y", "z"][axis]);
    (0..3).fold(there, |text, axis| text.replace(&unmoved(axis), ["x", "y", "z"][axis]))
}
