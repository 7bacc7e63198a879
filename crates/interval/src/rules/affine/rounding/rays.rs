//! Problems about coordinates along rays: [`PATH_UNITS`] units.

use super::Recorded;
use super::polynomial::{Atom, Polynomial, atom, constant, plus, size_of_terms, times};
use super::problem::{Problem, unit};
use super::recorder::Recorder;
use crate::rules::affine::{
    Form, PATH_UNITS, RayRange, TileRays, segment_coordinate, tile_coordinate,
};

/// The largest magnitude of t.
const T: &str = "largest t";

/// A range of t, and what is known of it: a number that is not below 0, since |middle| + half is at
/// most 1 + 4u times the largest magnitude of t.
fn range(m: &mut Recorder) -> (RayRange<usize>, Polynomial) {
    let range = RayRange { middle: m.input("middle"), half: m.magnitude("half") };
    let most = times(&atom(Atom::Size(T)), &constant(1.0 + 4.0 * unit()));
    let sizes = plus(&atom(Atom::Size("middle")), &m.values[range.half], 1.0);
    (range, plus(&most, &sizes, -1.0))
}

/// The problem of a coordinate. `terms` are the terms of its origin and of its direction.
fn problem<const N: usize>(
    mut m: Recorder,
    mut form: Form<usize, N>,
    exact: &[Polynomial],
    more: Polynomial,
    terms: [Polynomial; 2],
    of_range: &Polynomial,
) -> Problem {
    let [origin, direction] = terms;
    let along = times(&direction, &atom(Atom::Size(T)));
    form.magnitude = Some(m.record(plus(&origin, &along, 1.0)));
    form.units = PATH_UNITS;
    let single =
        |(monomial, value): (&Vec<Atom>, &f64)| Polynomial::from([(monomial.clone(), *value)]);
    let known = direction.iter().map(|term| times(&single(term), of_range)).collect();
    Problem::new(m, &form, exact, more, known)
}

/// A coordinate along a segment.
pub(super) fn segment(mut m: Recorder) -> Recorded {
    let [origin, direction] = ["origin", "direction"].map(|name| m.input(name));
    let error = m.magnitude("error");
    let (range, of_range) = range(&mut m);
    let form = segment_coordinate(&mut m, [origin, direction, error], range);
    let along = |t: usize| times(&m.values[t], &m.values[direction]);
    let exact = [plus(&m.values[origin], &along(range.middle), 1.0), along(range.half)];
    let terms = [origin, direction].map(|part| size_of_terms(&m.values[part]));
    let more = m.values[error].clone();
    let fails = if m.fuses { 1.0 } else { 1.9 };
    ("segment", Some(fails), vec![problem(m, form, &exact, more, terms, &of_range)])
}

/// A coordinate of a tile's rays. Products of two symbols are within the error.
pub(super) fn tile(mut m: Recorder) -> Recorded {
    let rays = TileRays {
        centre: ["middle of a", "middle of b"].map(|name| m.input(name)),
        reach: ["reach of a", "reach of b"].map(|name| m.magnitude(name)),
        origin: ["origin", "origin a", "origin b"].map(|name| m.input(name)),
        direction: ["direction", "direction a", "direction b"].map(|name| m.input(name)),
        error: m.magnitude("error"),
    };
    let (range, of_range) = range(&mut m);
    let form = tile_coordinate(&mut m, &rays, range);
    let value = |number: usize| &m.values[number];
    let at_middle = |parts: [usize; 3]| {
        (0..2).fold(value(parts[0]).clone(), |sum, k| {
            plus(&sum, &times(value(rays.centre[k]), value(parts[k + 1])), 1.0)
        })
    };
    let (origin, direction) = (at_middle(rays.origin), at_middle(rays.direction));
    let mut exact = vec![plus(&origin, &times(value(range.middle), &direction), 1.0)];
    let mut more = value(rays.error).clone();
    let mut terms = [&origin, &direction].map(size_of_terms);
    for k in 0..2 {
        let (o, d) = (value(rays.origin[k + 1]), value(rays.direction[k + 1]));
        let reach = value(rays.reach[k]);
        let here = plus(o, &times(value(range.middle), d), 1.0);
        exact.push(times(reach, &here));
        let crossed = times(&times(reach, value(range.half)), &size_of_terms(d));
        more = plus(&more, &crossed, 1.0);
        for (terms, part) in terms.iter_mut().zip([o, d]) {
            *terms = plus(terms, &times(reach, &size_of_terms(part)), 1.0);
        }
    }
    exact.push(times(value(range.half), &direction));
    let fails = if m.fuses { 3.0 } else { 5.0 };
    ("tile", Some(fails), vec![problem(m, form, &exact, more, terms, &of_range)])
}
