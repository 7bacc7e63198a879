//! Statements that need rounding to be upward: the range of t, and the contraction.

use super::problem::{FORMAT, unit};
use crate::enclosure::Fact;
use crate::rules::affine::{Form, RayRange, contract};
use crate::rules::script::Script;

/// A statement as a script, which has no solution if the statement is true.
pub(super) fn statements() -> Vec<(String, String)> {
    let all = [("range", range()), ("contraction", contraction()), ("crossing", crossing())];
    all.map(|(name, script)| (name.to_owned(), script)).into()
}

fn script(m: &Script, claim: &str) -> String {
    let header = "; Written by a test of zeroset-interval from the operations of a rule.\n\
        ; false with rounding down\n\
        (declare-const infinity Real)\n\
        (define-fun finite ((a Real)) Bool (< (size a) infinity))\n\
        (define-fun up ((exact Real) (computed Real)) Bool (<= exact computed))";
    format!("{header}\n{}(assert (not {claim}))\n", m.text)
}

/// Every t of a segment is middle + half·ε for some ε in [−1, 1]. The sum of their magnitudes is
/// at most 1 + 4u times the largest magnitude of an end.
fn range() -> String {
    let mut m = Script::with_unit(unit());
    let [near, far, t] = ["near", "far", "the t"].map(|name| m.input(name));
    m.assume(&format!("(<= {} {} {})", m.of(near), m.of(t), m.of(far)));
    let RayRange { middle, half } = RayRange::between(&mut m, FORMAT, [near, far]);
    let [near, far, t, middle, half] = [near, far, t, middle, half].map(|value| m.of(value));
    let holds = format!("(<= (size (- {t} {middle})) {half})");
    let factor = format!("(+ 1.0 (/ 4.0 {:?}))", 1.0 / unit());
    let most = format!("(* {factor} (most (size {near}) (size {far})))");
    script(&m, &format!("(and {holds} (<= (+ (size {middle}) {half}) {most}))"))
}

/// A form of two symbols, and its value at `points`: t is middle + half·ε, and other terms add up
/// to at most the other slope and the error.
struct Segment {
    form: Form<usize, 2>,
    range: [usize; 2],
    ends: [usize; 2],
    points: Vec<Point>,
}

struct Point {
    t: String,
    value: String,
}

fn segment(m: &mut Script, points: usize) -> Segment {
    let [centre, across, along] =
        ["center", "slope across", "slope along"].map(|name| m.input(name));
    let error = m.input("error");
    let range = ["middle", "half"].map(|name| m.input(name));
    let ends = ["near", "far"].map(|name| m.input(name));
    for size in [error, range[1]] {
        m.assume(&format!("(<= 0.0 {})", m.of(size)));
    }
    let point = |number: usize| {
        let [e, rest] = ["symbol", "rest"].map(|name| m.input(&format!("{name} {number}")));
        let (e, rest) = (m.of(e).to_owned(), m.of(rest).to_owned());
        m.assume(&format!("(<= (- 1.0) {e} 1.0)"));
        m.assume(&format!("(<= (size {rest}) (+ (size {}) {}))", m.of(across), m.of(error)));
        Point {
            t: format!("(+ {} (* {} {e}))", m.of(range[0]), m.of(range[1])),
            value: format!("(+ {} (* {} {e}) {rest})", m.of(centre), m.of(along)),
        }
    };
    let points = (0..points).map(point).collect();
    let form = Form::coordinate(centre, [across, along], error);
    Segment { form, range, ends, points }
}

/// A zero between the ends is between the new ends, and its lane counts as possible.
fn contraction() -> String {
    let mut m = Script::default();
    let Segment { form, range, ends, points } = segment(&mut m, 1);
    let Point { t, value } = &points[0];
    m.assume(&format!("(= 0.0 {value})"));
    m.assume(&format!("(<= {} {t} {})", m.of(ends[0]), m.of(ends[1])));
    let found = contract(&mut m, FORMAT, &form, range, ends);
    let Fact::Lanes(possible) = found.possible else { unreachable!("lanes of slopes") };
    let [near, far, possible] = [found.near, found.far, possible].map(|value| m.of(value));
    script(&m, &format!("(and {possible} (<= {near} {t} {far}))"))
}

/// If a lane counts as crossing, the values at the ends have opposite signs.
fn crossing() -> String {
    let mut m = Script::default();
    let Segment { form, range, ends, points } = segment(&mut m, 2);
    for (end, point) in ends.iter().zip(&points) {
        m.assume(&format!("(= {} {})", m.of(*end), point.t));
    }
    let found = contract(&mut m, FORMAT, &form, range, ends);
    let Fact::Lanes(crossing) = found.crossing else { unreachable!("lanes of slopes") };
    let (one, other) = (&points[0].value, &points[1].value);
    let opposite = format!("(or (< {one} 0.0 {other}) (< {other} 0.0 {one}))");
    let crossing = m.of(crossing);
    script(&m, &format!("(=> {crossing} {opposite})"))
}
