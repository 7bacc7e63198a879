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
use crate::software::{Software, Vector128};
use std::collections::HashMap;
use std::fmt::Write as _;

/// A machine that numbers what it executes. Equal operations have the same number.
#[derive(Default)]
pub(super) struct Program {
    lines: Vec<String>,
    known: HashMap<String, usize>,
    /// Names of values, bounds and domains.
    notes: String,
    bounds: Vec<[usize; 2]>,
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

    /// Names bounds of a function: the negated lower one, and the upper one.
    pub(super) fn bound(&mut self, function: &str, [low, high]: [usize; 2]) {
        self.name(&format!("bounds {function} {low}"), high);
        if !self.bounds.contains(&[low, high]) {
            self.bounds.push([low, high]);
        }
    }

    /// Executes the program in software for inputs with these bits. Returns the bits of all values.
    fn replay(&self, m: &mut Software, x: u64) -> Vec<u64> {
        let mut values: Vec<Vector128> = Vec::new();
        for line in &self.lines {
            let (name, rest) = line.split_once(' ').expect("a name");
            let numbers: Vec<usize> =
                rest.split(' ').map(|word| word.parse().unwrap_or(0)).collect();
            let at = |place: usize| values[numbers[place]];
            let by = || u8::try_from(numbers[1]).expect("a number of bits");
            values.push(match name {
                "input" => m.bits(Format::F64, x),
                "bits" => m.bits(Format::F64, u64::from_str_radix(rest, 16).expect("bits")),
                "add" => m.add(at(0), at(1)),
                "sub" => m.sub(at(0), at(1)),
                "mul" => m.mul(at(0), at(1)),
                "mul_add" => m.mul_add(at(0), at(1), at(2)),
                "div" => m.div(at(0), at(1)),
                "sqrt" => m.sqrt(at(0)),
                "neg" => m.neg(at(0)),
                "abs" => m.abs(at(0)),
                "min" => m.min(at(0), at(1)),
                "max" => m.max(at(0), at(1)),
                "floor" => m.floor(at(0)),
                "nearest" => m.nearest(at(0)),
                "lt" => m.lt(at(0), at(1)),
                "le" => m.le(at(0), at(1)),
                "eq" => m.eq(at(0), at(1)),
                "and" => m.and(at(0), at(1)),
                "or" => m.or(at(0), at(1)),
                "xor" => m.xor(at(0), at(1)),
                "select" => m.select(at(0), at(1), at(2)),
                "select_signed" => m.select_signed(at(0), at(1), at(2)),
                "int_add" => m.int_add(at(0), at(1)),
                "int_sub" => m.int_sub(at(0), at(1)),
                "shift_left" => m.shift_left(at(0), by()),
                "shift_right" => m.shift_right(at(0), by()),
                _ => unreachable!("{name}"),
            });
        }
        values.iter().map(|value| value.bits_64()[0]).collect()
    }

    /// Notes the values of bounds at some floats of the domain, by which `proofs/functions` checks
    /// that its operations are those of the code. It rounds a·b + c twice.
    fn sample(&mut self, [least, most]: [f64; 2]) {
        let [_, mut m] = Software::BOTH;
        for x in SAMPLES.into_iter().flat_map(|x| [x, -x]) {
            if !(least..=most).contains(&x) {
                continue;
            }
            let values = self.replay(&mut m, x.to_bits());
            let ends = self.bounds.as_flattened().iter();
            let ends: Vec<_> = ends.map(|end| format!("{:016x}", values[*end])).collect();
            let _ = writeln!(self.notes, "sample {:016x} {}", x.to_bits(), ends.join(" "));
        }
    }

    /// Writes the program to a file below `ZEROSET_PROOFS`, if it is set. It holds on a domain.
    pub(super) fn write(&mut self, name: &str, domain: [f64; 2]) {
        self.constant("least", domain[0]);
        self.constant("most", domain[1]);
        self.sample(domain);
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
    m.bound(function, [low, high]);
    m.constant(&format!("error {function}"), near.error);
}

/// A routine, and the domain in which it is used.
type Routine = fn(&mut Approximator<'_, Program>, usize) -> Approximation<usize>;

const SAMPLES: [f64; 14] = [
    5e-310, 1e-290, 1e-120, 1e-100, 1e-9, 0.001_7, 0.123, 0.499, 0.77, 0.998, 1.001, 2.6, 19.3,
    700.25,
];
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
        m.write(name, *domain);
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
        m.write(name, [-limit, limit]);
    }
}
