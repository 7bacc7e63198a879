//! A statement about a form, as a script for a solver.

use super::polynomial::{Atom, Monomial, Polynomial, constant, plus, size, size_of_terms, times};
use super::recorder::Recorder;
use crate::machine::Format;
use crate::rules::affine::Form;
use std::collections::BTreeSet;
use std::fmt::Write as _;

/// Units are larger in `f32`, and so are all errors in comparison.
pub(super) const FORMAT: Format = Format::F32;

/// A problem: the recorded values, all that is known of inputs, and a statement. The statement is
/// that deviations and other terms add up to at most the form's error with its units.
pub(super) struct Problem {
    recorder: Recorder,
    /// Polynomials that are not below 0.
    known: Vec<Polynomial>,
    /// Polynomials whose magnitudes are added.
    deviations: Vec<Polynomial>,
    /// Further terms.
    more: Polynomial,
    error: Polynomial,
    magnitude: Polynomial,
    units: f64,
}

impl Problem {
    /// The problem of a form, whose center and slopes would be `exact` without rounding.
    pub(super) fn new<const N: usize>(
        recorder: Recorder,
        form: &Form<usize, N>,
        exact: &[Polynomial],
        more: Polynomial,
        known: Vec<Polynomial>,
    ) -> Self {
        let value = |number: usize| recorder.values[number].clone();
        let parts = [form.centre].into_iter().chain(form.slopes.into_iter().flatten());
        let deviations = parts.zip(exact).map(|(part, exact)| plus(&value(part), exact, -1.0));
        Self {
            deviations: deviations.collect(),
            error: value(form.error.expect("an error")),
            magnitude: value(form.magnitude.expect("a magnitude")),
            units: form.units,
            known,
            more,
            recorder,
        }
    }

    /// The problem as a script: it has no solution if the statement is true. `fails` is a number of
    /// units with which it has one.
    pub(super) fn script(&self, fails: Option<f64>) -> String {
        let mut open: Vec<Monomial> = Vec::new();
        let mut text = |polynomial: &Polynomial| {
            open.extend(polynomial.keys().cloned());
            sum(polynomial)
        };
        let mut claim = String::new();
        for known in &self.known {
            let _ = writeln!(claim, "(assert (<= 0.0 {}))", text(known));
        }
        let mut parts: Vec<String> =
            self.deviations.iter().map(|part| format!("(size {})", text(part))).collect();
        parts.push(text(&self.more));
        let unit = times(&self.magnitude, &constant(unit()));
        let (error, unit) = (text(&self.error), text(&unit));
        let parts = parts.join("\n  ");
        let _ =
            writeln!(claim, "(assert (not (<= (+\n  {parts})\n  (+ {error} (* units {unit})))))");
        let (mut names, mut facts) = (BTreeSet::new(), BTreeSet::new());
        while let Some(monomial) = open.pop() {
            if !monomial.is_empty() && names.insert(monomial.clone()) {
                self.facts(&monomial, &mut facts, &mut open);
            }
        }
        let mut script =
            "; Written by a test of zeroset-interval from the operations of a rule.\n".to_owned();
        if let Some(fails) = fails {
            let _ = writeln!(script, "; false with {fails:?} units");
        }
        let _ = writeln!(script, "(define-fun units () Real {})", quotient(self.units));
        for monomial in &names {
            let _ = writeln!(script, "(declare-const {} Real)", name(monomial));
        }
        for fact in facts {
            let _ = writeln!(script, "(assert {fact})");
        }
        script + &claim
    }

    /// Adds all that is known of a monomial, and the monomials that occur in it.
    fn facts(&self, monomial: &Monomial, facts: &mut BTreeSet<String>, open: &mut Vec<Monomial>) {
        let this = name(monomial);
        let sizes = size(monomial);
        if monomial.iter().any(|atom| matches!(atom, Atom::Input(_))) {
            facts.insert(format!("(= {} (size {this}))", name(&sizes)));
            open.push(sizes.clone());
        } else {
            facts.insert(format!("(<= 0.0 {this})"));
        }
        let mut text = |polynomial: &Polynomial| {
            open.extend(polynomial.keys().cloned());
            sum(polynomial)
        };
        for (place, atom) in monomial.iter().enumerate() {
            let mut rest = monomial.clone();
            rest.remove(place);
            match atom {
                Atom::Rounding(number) => {
                    let exact = &self.recorder.exact[*number];
                    let mut within = |bound: String| {
                        let unit = quotient(unit());
                        facts.insert(format!("(<= {} (* {unit} {bound}))", name(&sizes)));
                    };
                    let rest_size = Polynomial::from([(size(&rest), 1.0)]);
                    within(text(&times(&size_of_terms(exact), &rest_size)));
                    if rest.is_empty() {
                        let error = Polynomial::from([(monomial.clone(), 1.0)]);
                        within(format!("(size {})", text(exact)));
                        within(format!("(size {})", text(&plus(exact, &error, 1.0))));
                    }
                }
                Atom::SizeOf(value) if rest.is_empty() => {
                    let value = text(&self.recorder.values[*value]);
                    facts.insert(format!("(= {this} (size {value}))"));
                }
                Atom::Input(_) | Atom::Size(_) | Atom::SizeOf(_) => {}
            }
        }
    }
}

/// The unit of rounding.
pub(super) fn unit() -> f64 {
    2f64.powi(FORMAT.pick(-23, -52))
}

fn name(monomial: &Monomial) -> String {
    let names = monomial.iter().map(|atom| match atom {
        Atom::Input(name) => (*name).to_owned(),
        Atom::Size(name) => format!("size of {name}"),
        Atom::SizeOf(value) => format!("size of value {value}"),
        Atom::Rounding(number) => format!("rounding {number}"),
    });
    format!("|{}|", names.collect::<Vec<_>>().join(" * "))
}

fn sum(polynomial: &Polynomial) -> String {
    let term = |(monomial, value): (&Monomial, &f64)| match (monomial.is_empty(), *value) {
        (true, value) => quotient(value),
        (false, 1.0) => name(monomial),
        (false, value) => format!("(* {} {})", quotient(value), name(monomial)),
    };
    let terms: Vec<String> = polynomial.iter().map(term).collect();
    match &terms[..] {
        [] => "0.0".to_owned(),
        [term] => term.clone(),
        terms => format!("(+ {})", terms.join(" ")),
    }
}

/// A dyadic number as a quotient.
fn quotient(value: f64) -> String {
    let (mut above, mut below) = (value.abs(), 1.0);
    while above.fract() != 0.0 {
        (above, below) = (2.0 * above, 2.0 * below);
    }
    let text =
        if below == 1.0 { format!("{above:.1}") } else { format!("(/ {above:.1} {below:.1})") };
    if value < 0.0 { format!("(- {text})") } else { text }
}
