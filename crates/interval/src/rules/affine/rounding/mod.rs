//! Records the operations of rules, and writes what docs/rounding.md states about them as problems
//! for a solver.
//!
//! A recorded value is a polynomial in inputs, in their magnitudes, and in one error for each
//! operation that rounds. The solver knows its monomials as numbers: which are magnitudes of which,
//! and how large those with an error can be. So each problem is linear. `proofs/run` solves it.

mod outward;
mod polynomial;
mod problem;
mod rays;
mod recorder;
mod relative;

use super::{Form, FormOperand};
use crate::rules::{Rule, script};
use polynomial::{Atom, Polynomial, atom, constant, plus, size_of_terms, times};
use problem::{FORMAT, Problem};
use recorder::Recorder;

/// A form with inputs as center, slopes and error.
fn form<const N: usize>(
    m: &mut Recorder,
    [centre, error]: [&'static str; 2],
    slopes: [&'static str; N],
) -> Form<usize, N> {
    let slopes = Some(slopes.map(|name| m.input(name)));
    let (centre, error) = (m.input(centre), m.magnitude(error));
    Form::total(centre, slopes, Some(error))
}

const A: [&str; 2] = ["center of a", "error of a"];
const B: [&str; 2] = ["center of b", "error of b"];
const SLOPES_A: [&str; 2] = ["slope 1 of a", "slope 2 of a"];
const SLOPES_B: [&str; 2] = ["slope 1 of b", "slope 2 of b"];

/// Gives a form a magnitude M. Returns a number that is not below 0, since |center| + Σ |slopes| is
/// at most 1.04·M. The number 1 + 6/128 is larger.
fn known_magnitude<const N: usize>(
    m: &mut Recorder,
    name: &'static str,
    form: &mut Form<usize, N>,
) -> Polynomial {
    form.magnitude = Some(m.magnitude(name));
    let magnitude = times(&atom(Atom::Size(name)), &constant(1.0 + 6.0 / 128.0));
    let parts = form.slopes.iter().flatten().chain([&form.centre]);
    parts.fold(magnitude, |rest, part| plus(&rest, &size_of_terms(&m.values[*part]), -1.0))
}

/// A rule, the number of units with which its statement is false, and its problems.
type Recorded = (&'static str, Option<f64>, Vec<Problem>);

/// The sum of two forms: 1.25 units.
fn sum_of_forms(mut m: Recorder) -> Recorded {
    let (mut a, mut b) = (form(&mut m, A, SLOPES_A), form(&mut m, B, SLOPES_B));
    let known = vec![
        known_magnitude(&mut m, "magnitude of a", &mut a),
        known_magnitude(&mut m, "magnitude of b", &mut b),
    ];
    let sum = Rule { m: &mut m, format: FORMAT }.form_sum(&a, &b);
    let exact = |a: usize, b: usize| plus(&m.values[a], &m.values[b], 1.0);
    let slopes = [0, 1].map(|k| exact(a.slopes.expect("some")[k], b.slopes.expect("some")[k]));
    let exact: Vec<_> = [exact(a.centre, b.centre)].into_iter().chain(slopes).collect();
    let more = plus(&atom(Atom::Size(A[1])), &atom(Atom::Size(B[1])), 1.0);
    ("sum", Some(1.03), vec![Problem::new(m, &sum, &exact, more, known)])
}

/// The product of a form and a factor: 1.25 units.
fn scaled_form(mut m: Recorder) -> Recorded {
    let mut a = form(&mut m, A, SLOPES_A);
    let known = known_magnitude(&mut m, "magnitude of a", &mut a);
    let factor = Form { slopes: None, ..form(&mut m, B, SLOPES_B) };
    let [operand, by] = [a, factor].map(FormOperand::new);
    let scaled = Rule { m: &mut m, format: FORMAT }.form_product(&operand, &by);
    let parts = [a.centre].into_iter().chain(a.slopes.expect("some"));
    let exact: Vec<Polynomial> =
        parts.map(|part| times(&m.values[part], &m.values[factor.centre])).collect();
    let by_factor = atom(Atom::Size(B[0]));
    let [most, error] = ["magnitude of a", A[1]].map(|name| atom(Atom::Size(name)));
    let more = plus(&most, &error, 1.0);
    let more = plus(&times(&more, &atom(Atom::Size(B[1]))), &times(&error, &by_factor), 1.0);
    let known = vec![times(&known, &by_factor), known];
    ("scaled", Some(1.03), vec![Problem::new(m, &scaled, &exact, more, known)])
}

/// A line: 2.5 units.
fn line(mut m: Recorder) -> Recorded {
    let mut a = form(&mut m, A, SLOPES_A);
    let known = known_magnitude(&mut m, "magnitude of a", &mut a);
    let [slope, middle] = ["slope", "middle"].map(|name| m.input(name));
    let half = m.magnitude("half");
    let line = Rule { m: &mut m, format: FORMAT }.form_line(&a, slope, middle, half);
    let exact = |part: usize| times(&m.values[part], &m.values[slope]);
    let mut parts = vec![plus(&exact(a.centre), &m.values[middle], 1.0)];
    parts.extend(a.slopes.iter().flatten().map(|part| exact(*part)));
    let steep = atom(Atom::Size("slope"));
    let more = plus(&m.values[half], &times(&atom(Atom::Size(A[1])), &steep), 1.0);
    let fails = (!m.fuses).then_some(1.9);
    ("line", fails, vec![Problem::new(m, &line, &parts, more, vec![times(&known, &steep)])])
}

/// A product of two forms: 3 units. Without rounding, the error is a sum of products of slopes: all
/// of them, less half of the product of the depth slopes. That half is added to the center.
fn product(mut m: Recorder) -> Recorded {
    let (a, b) = (form(&mut m, A, SLOPES_A), form(&mut m, B, SLOPES_B));
    let [one, other] = [a, b].map(FormOperand::new);
    let found = Rule { m: &mut m, format: FORMAT }.form_product(&one, &other);
    let (a_slopes, b_slopes) = (a.slopes.expect("some"), b.slopes.expect("some"));
    let product = |a: usize, b: usize| times(&m.values[a], &m.values[b]);
    let half = times(&product(a_slopes[1], b_slopes[1]), &constant(0.5));
    let mut exact = vec![plus(&product(a.centre, b.centre), &half, 1.0)];
    for k in 0..2 {
        exact.push(plus(&product(a.centre, b_slopes[k]), &product(a_slopes[k], b.centre), 1.0));
    }
    let sizes = |parts: &[usize]| {
        parts
            .iter()
            .fold(Polynomial::new(), |sum, part| plus(&sum, &size_of_terms(&m.values[*part]), 1.0))
    };
    let [a_error, b_error] = [A, B].map(|names| atom(Atom::Size(names[1])));
    let mut more = plus(&times(&sizes(&a_slopes), &sizes(&b_slopes)), &size_of_terms(&half), -1.0);
    let a_most = sizes(&[&a_slopes[..], &[a.centre]].concat());
    let b_most = plus(&sizes(&[&b_slopes[..], &[b.centre]].concat()), &b_error, 1.0);
    more = plus(&more, &times(&a_most, &b_error), 1.0);
    more = plus(&more, &times(&b_most, &a_error), 1.0);
    ("product", Some(1.9), vec![Problem::new(m, &found, &exact, more, Vec::new())])
}

/// A square: 3 units. The square of the symbols' sum is from 0 to R², with R = Σ |slopes|. There is
/// a problem for either end.
fn square(mut m: Recorder) -> Recorded {
    let a = form(&mut m, A, SLOPES_A);
    let found = Rule { m: &mut m, format: FORMAT }.form_square(&FormOperand::new(a));
    let slopes = a.slopes.expect("some");
    let centre = m.values[a.centre].clone();
    let reach = slopes
        .iter()
        .fold(Polynomial::new(), |sum, slope| plus(&sum, &size_of_terms(&m.values[*slope]), 1.0));
    let error = atom(Atom::Size(A[1]));
    let most =
        plus(&times(&plus(&size_of_terms(&centre), &reach, 1.0), &constant(2.0)), &error, 1.0);
    let more = times(&most, &error);
    let twice = times(&centre, &constant(2.0));
    let problem = |m: Recorder, square: Polynomial| {
        let mut exact = vec![plus(&times(&centre, &centre), &square, 1.0)];
        exact.extend(slopes.iter().map(|slope| times(&twice, &m.values[*slope])));
        Problem::new(m, &found, &exact, more.clone(), Vec::new())
    };
    let fails = (!m.fuses).then_some(1.9);
    let ends = [Polynomial::new(), times(&reach, &reach)];
    ("square", fails, ends.map(|square| problem(m.clone(), square)).into())
}

#[test]
fn proofs_of_rounding() {
    let rules = [sum_of_forms, scaled_form, line, product, square, rays::segment, rays::tile];
    let mut scripts = outward::statements();
    for fuses in [false, true] {
        for rule in rules {
            let (name, fails, problems) = rule(Recorder { fuses, ..Recorder::default() });
            for (number, problem) in problems.iter().enumerate() {
                let end =
                    if problems.len() > 1 { format!("-{}", number + 1) } else { String::new() };
                let once = if fuses { "-fused" } else { "" };
                scripts.push((format!("{name}{end}{once}"), problem.script(fails)));
            }
        }
    }
    script::write("rounding", scripts);
}
