//! Writes the operations that routines of functions execute in `f64`, with their constants.
//! `proofs/functions.py` reads them, and proves that the bounds which they compute hold the
//! function's value at every float of the domain. Nothing is copied by hand.

use super::approximator::Approximator;
use super::double_double::Approximation;
use super::logarithm::Base;
use super::trigonometric::HalfPi;
use crate::bounds::Interval;
use crate::machine::{Format, Machine};
use crate::rules::script;
use std::collections::HashMap;
use std::fmt::Write as _;

/// A machine that numbers what it executes. Equal operations have the same number.
#[derive(Default)]
pub(super) struct Program {
    lines: Vec<String>,
    known: HashMap<String, usize>,
    /// Names of values, bounds and domains.
    notes: String,
}

impl Program {
    fn value(&mut self, line: String) -> usize {
        if let Some(number) = self.known.get(&line) {
            return *number;
        }
        self.known.insert(line.clone(), self.lines.len());
        self.lines.push(line);
        self.lines.len() - 1
    }

    fn apply(&mut self, name: &str, operands: &[usize]) -> usize {
        let operands: Vec<String> = operands.iter().map(usize::to_string).collect();
        self.value(format!("{name} {}", operands.join(" ")))
    }

    pub(super) fn input(&mut self, name: &str) -> usize {
        self.value(format!("input {name}"))
    }

    /// Names a value.
    pub(super) fn name(&mut self, name: &str, value: usize) {
        let _ = writeln!(self.notes, "{name} {value}");
    }

    /// Names a number.
    pub(super) fn constant(&mut self, name: &str, number: f64) {
        let _ = writeln!(self.notes, "{name} {:016x}", number.to_bits());
    }

    /// Writes the program to a file below `ZEROSET_PROOFS`, if it is set.
    pub(super) fn write(&self, name: &str) {
        assert!(self.lines.len() > 3, "{name}");
        let text = format!("{}\n\n{}", self.lines.join("\n"), self.notes);
        script::write_text(&format!("functions/{name}.txt"), &text);
    }
}

/// Operations of floats and bits, each recorded by its name.
macro_rules! recorded {
    ($($name:ident($($operand:ident),*);)*) => {$(
        fn $name(&mut self, $($operand: usize),*) -> usize {
            self.apply(stringify!($name), &[$($operand),*])
        }
    )*};
}

impl Machine for Program {
    type V = usize;

    fn number(&mut self, format: Format, value: f64) -> usize {
        self.bits(format, value.to_bits())
    }
    fn bits(&mut self, format: Format, bits: u64) -> usize {
        assert_eq!(format, Format::F64);
        self.value(format!("bits {bits:016x}"))
    }
    recorded! {
        add(a, b);
        sub(a, b);
        mul(a, b);
        mul_add(a, b, c);
        div(a, b);
        sqrt(a);
        neg(a);
        abs(a);
        min(a, b);
        max(a, b);
        floor(a);
        nearest(a);
        lt(a, b);
        le(a, b);
        eq(a, b);
        and(a, b);
        or(a, b);
        xor(a, b);
        select(mask, a, b);
        select_signed(sign, a, b);
        int_add(a, b);
        int_sub(a, b);
    }
    fn shift_left(&mut self, a: usize, by: u8) -> usize {
        self.apply("shift_left", &[a, by.into()])
    }
    fn shift_right(&mut self, a: usize, by: u8) -> usize {
        self.apply("shift_right", &[a, by.into()])
    }
    not_recorded! {
        ceil(a: usize) -> usize;
        trunc(a: usize) -> usize;
        widen(a: usize) -> [usize; 2];
        narrow(halves: [usize; 2]) -> usize;
    }
}

fn approximator(m: &mut Program) -> Approximator<'_, Program> {
    Approximator { m, target: Format::F64 }
}

/// Names bounds of a function. They are those of the sum; a power of two that is multiplied to both
/// has a name of its own.
fn name_bounds(m: &mut Program, function: &str, near: &Approximation<usize>) {
    if let Some(exponent) = near.exponent {
        m.name("exponent", exponent);
    }
    let sum = Approximation { exponent: None, ..*near };
    let mut approx = approximator(m);
    let (low, high) = (approx.negated_lower(&sum), approx.upper(&sum));
    m.name(&format!("bounds {function} {low}"), high);
    m.constant(&format!("error {function}"), near.error);
}

/// A routine, and the domain in which it is used.
type Routine = fn(&mut Approximator<'_, Program>, usize) -> Approximation<usize>;

const ALL: [f64; 2] = [-f64::MAX, f64::MAX];
const POSITIVE: [f64; 2] = [f64::from_bits(1), f64::MAX];
const ROUTINES: &[(&str, [f64; 2], Routine)] = &[
    ("exp", ALL, |m, x| m.exp_of(x.into())),
    ("ln", POSITIVE, |m, x| m.ln(x, Base::E)),
    ("log2", POSITIVE, |m, x| m.ln(x, Base::Two)),
    ("log10", POSITIVE, |m, x| m.ln(x, Base::Ten)),
    ("sinh", ALL, |m, x| m.sinh(x)),
    ("cosh", ALL, |m, x| m.cosh(x)),
    ("tanh", ALL, |m, x| m.tanh(x)),
    ("asinh", ALL, |m, x| m.asinh(x)),
    ("acosh", [1.0, f64::MAX], |m, x| m.acosh(x)),
    ("atanh", [-1.0 + f64::EPSILON / 2.0, 1.0 - f64::EPSILON / 2.0], |m, x| m.atanh(x)),
    ("atan", ALL, |m, x| m.atan(x)),
    ("asin", [-1.0, 1.0], |m, x| m.asin(x)),
    ("acos", [-1.0, 1.0], |m, x| m.acos(x)),
    ("erf", ALL, |m, x| m.erf(x)),
];

#[test]
fn proofs_of_functions() {
    for (name, domain, routine) in ROUTINES {
        let mut m = Program::default();
        let x = m.input("x");
        let near = routine(&mut approximator(&mut m), x);
        name_bounds(&mut m, name, &near);
        m.constant("least", domain[0]);
        m.constant("most", domain[1]);
        m.write(name);
    }
}

/// Sine, cosine and tangent by either sum of parts of π/2. The reduced angle has a name.
#[test]
fn proofs_of_waves() {
    for (name, most) in [("waves-common", 1024.0), ("waves-large", 1e9)] {
        let mut m = Program::default();
        let half_pi = HalfPi::for_angles(Interval { lo: -most, hi: most });
        let x = m.input("x");
        let mut approx = approximator(&mut m);
        approx.name_reduced(x, half_pi);
        let (sin, cos, tan) =
            (approx.sin(x, half_pi), approx.cos(x, half_pi), approx.tan(x, half_pi));
        let waves = approx.waves(x, half_pi);
        for (function, near) in [("sin", &sin.0), ("cos", &cos.0), ("tan", &tan.0)] {
            name_bounds(&mut m, function, near);
        }
        // Both at once are the same operations.
        let lines = m.lines.len();
        for (function, near) in ["sin", "cos"].into_iter().zip(&waves) {
            name_bounds(&mut m, function, near);
        }
        assert_eq!(m.lines.len(), lines);
        let limit = half_pi.limit(Format::F64);
        m.constant("least", -limit);
        m.constant("most", limit);
        m.write(name);
    }
}
