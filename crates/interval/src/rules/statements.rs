//! The claims of interval rules as problems for a solver. For each combination of the operands'
//! ranges, a problem has the operations that the rule executes, and its claims about bounds and
//! about where the value is defined. Bounds are finite here, and there is one branch.

use super::enclose;
use super::script::{self, Script};
use crate::bounds::Interval;
use crate::enclosure::{Claims, Fact, Operand};
use crate::machine::Format;
use std::fmt::Write as _;
use zeroset_ops::{Op, TABLE};

/// An operation, and for values a, b and c with their definedness: its value, and where it is
/// defined.
const OPERATIONS: &[(Op, &str, &str)] = &[
    (Op::Neg, "(- |a|)", "|a is defined|"),
    (Op::Abs, "(size |a|)", "|a is defined|"),
    (Op::Sqr, "(* |a| |a|)", "|a is defined|"),
    (Op::Floor, "(floor |a|)", "|a is defined|"),
    (Op::Ceil, "(- (floor (- |a|)))", "|a is defined|"),
    (Op::Fract, "(- |a| (floor |a|))", "|a is defined|"),
    (Op::Add, "(+ |a| |b|)", "both"),
    (Op::Sub, "(- |a| |b|)", "both"),
    (Op::Mul, "(* |a| |b|)", "both"),
    (Op::Div, "(/ |a| |b|)", "(and both (not (= |b| 0.0)))"),
    (Op::Min, "(least |a| |b|)", "both"),
    (Op::Max, "(most |a| |b|)", "both"),
    (
        Op::SelectNegative,
        "(ite (< |a| 0.0) |b| |c|)",
        "(and |a is defined| (ite (< |a| 0.0) |b is defined| |c is defined|))",
    ),
    (Op::Otherwise, "(ite |a is defined| |a| |b|)", "(or |a is defined| |b is defined|)"),
    (Op::WhereNonneg, "|a|", "(and both (<= 0.0 |b|))"),
    (Op::WherePositive, "|a|", "(and both (< 0.0 |b|))"),
    (Op::WhereNonzero, "|a|", "(and both (not (= |b| 0.0)))"),
    (Op::WhereDefined, "|a|", "both"),
];

/// Ranges in which rules may differ.
const RANGES: &[Interval] = &[
    Interval { lo: -8.0, hi: 8.0 },
    Interval { lo: 0.0, hi: 8.0 },
    Interval { lo: -8.0, hi: 0.0 },
    Interval { lo: 1.0, hi: 8.0 },
    Interval { lo: -8.0, hi: -1.0 },
    Interval::ENTIRE,
];

const HEADER: &str = "(define-fun least ((a Real) (b Real)) Real (ite (<= a b) a b))
(define-fun most ((a Real) (b Real)) Real (ite (<= a b) b a))
(define-fun size ((a Real)) Real (most a (- a)))
(define-fun floor ((a Real)) Real (to_real (to_int a)))
(declare-const infinity Real)
(define-fun finite ((a Real)) Bool (< (size a) infinity))
(define-fun up ((exact Real) (computed Real)) Bool (<= exact computed))
(declare-const |least positive| Real)
(assert (< 0.0 |least positive|))
";

/// An operand with its value: within the bounds wherever it is defined.
fn operand(m: &mut Script, name: &str, range: Interval) -> Operand<usize> {
    let value = m.input(name);
    let is_defined = m.declare(&format!("{name} is defined"), "Bool");
    let neg_lo = m.input(&format!("-low of {name}"));
    let hi = m.input(&format!("high of {name}"));
    let nowhere = m.declare(&format!("{name} is nowhere defined"), "Bool");
    let defined = m.declare(&format!("{name} is defined throughout"), "Bool");
    let [v, d, n, h] = [value, is_defined, neg_lo, hi].map(|number| m.of(number).to_owned());
    m.assume(&format!("(<= (- {n}) {h})"));
    m.assume(&format!("(=> {d} (<= (- {n}) {v} {h}))"));
    m.assume(&format!("(=> {} (not {d}))", m.of(nowhere)));
    m.assume(&format!("(=> {} {d})", m.of(defined)));
    for end in [&n, &h] {
        // Floats are 0, or at least the least positive one.
        m.assume(&format!("(or (= {end} 0.0) (<= |least positive| (size {end})))"));
        m.assume(&format!("(finite {end})"));
    }
    if range != Interval::ENTIRE {
        let (lo, hi) = (m.text_of(range.lo), m.text_of(range.hi));
        m.assume(&format!("(<= {lo} (- {n}))"));
        m.assume(&format!("(<= {h} {hi})"));
    }
    let facts = Claims {
        nowhere: Fact::Lanes(nowhere),
        defined: Fact::Lanes(defined),
        continuous: Fact::Lanes(defined),
    };
    Operand::new(facts.with([neg_lo, hi]), range)
}

/// The text of a fact.
fn text(m: &Script, fact: Fact<usize>) -> String {
    match fact {
        Fact::False => "false".to_owned(),
        Fact::True => "true".to_owned(),
        Fact::Lanes(mask) => m.of(mask).to_owned(),
    }
}

/// A problem: facts, then the claim that has no counterexample.
fn case(op: Op, value: &str, is_defined: &str, ranges: &[Interval]) -> String {
    let mut m = Script::default();
    let operands: Vec<_> = ["a", "b", "c"]
        .iter()
        .zip(ranges)
        .map(|(name, range)| operand(&mut m, name, *range))
        .collect();
    if operands.len() > 1 {
        m.text += "(define-fun both () Bool (and |a is defined| |b is defined|))\n";
    }
    m.assume(&format!("(=> {is_defined} (finite {value}))"));
    let found = enclose(&mut m, Format::F32, op, &operands);
    let [nowhere, throughout] =
        [found.facts.nowhere, found.facts.defined].map(|fact| text(&m, fact));
    let [neg_lo, hi] = [found.neg_lo, found.hi].map(|bound| m.of(bound));
    let within = format!("(=> {is_defined} (<= (- {neg_lo}) {value} {hi}))");
    let facts = format!("(=> {nowhere} (not {is_defined})) (=> {throughout} {is_defined})");
    let ranges: Vec<String> =
        ranges.iter().map(|range| format!("[{}, {}]", range.lo, range.hi)).collect();
    // The solver for products knows no integers, and the one for integers is slow with products.
    let (solver, check) = match op {
        Op::Floor | Op::Ceil | Op::Fract => ("(set-option :smt.arith.solver 2)\n", "(check-sat)"),
        _ => ("", "(check-sat-using qfnra-nlsat)"),
    };
    format!(
        "(reset)\n{solver}; case {}\n{HEADER}{}{check}\n(assert (not (and {within}\n  {facts})))\n{check}\n",
        ranges.join(", "),
        m.text
    )
}

/// All combinations of ranges for an operation.
fn statement(op: Op, value: &str, is_defined: &str) -> String {
    let mut script =
        "; Written by a test of zeroset-interval from the operations of a rule.\n".to_owned();
    // The solver does not end for fractional parts of unbounded numbers. Their rule is the same.
    let ranges = if op == Op::Fract { &RANGES[..5] } else { RANGES };
    let count = ranges.len().pow(op.arity() as u32);
    for number in 0..count {
        let places = (0..op.arity()).map(|k| number / ranges.len().pow(k as u32) % ranges.len());
        let ranges: Vec<Interval> = places.map(|place| ranges[place]).collect();
        let _ = write!(script, "{}", case(op, value, is_defined, &ranges));
    }
    script
}

/// The names of all operations, for the table that `proofs/table.py` makes.
#[test]
fn proofs_are_counted() {
    let names: Vec<_> = TABLE.iter().map(|row| format!("{:?} {}", row.op, row.arity)).collect();
    assert!(OPERATIONS.iter().all(|(op, ..)| TABLE.iter().any(|row| row.op == *op)));
    script::write_text("operations.txt", &names.join("\n"));
}

#[test]
fn proofs_of_interval_rules() {
    let scripts = OPERATIONS.iter().map(|&(op, value, is_defined)| {
        (format!("{op:?}").to_lowercase(), statement(op, value, is_defined))
    });
    script::write("intervals", scripts);
}
