//! A machine that does one thing wrong, at one place of the code of rules.

use std::collections::BTreeSet;
use std::fmt;
use std::panic::Location;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use zeroset_interval::{Format, Machine, Software, Vector128};

/// A wrong way to carry out an operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Change {
    /// Rounds down in place of up.
    RoundsDown,
    /// Does the opposite: − for +, maximum for minimum, ≤ for <, the wrong one of two choices.
    Opposite,
    /// Exchanges the operands.
    Exchanged,
    /// Returns the first operand. A comparison is true.
    First,
    /// Returns the second operand. A comparison is false.
    Second,
    /// Returns the next lower number.
    Neighbour,
}

use Change::{Exchanged, First, Neighbour, Opposite, RoundsDown, Second};

/// A call of an operation of [`Machine`] in the text of a rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Site {
    file: &'static str,
    line: u32,
    column: u32,
    /// The operation that is called.
    pub operation: &'static str,
}

impl Site {
    /// The file's path in the repository.
    pub fn file(&self) -> &'static str {
        self.file.find("crates/").map_or(self.file, |start| &self.file[start..])
    }

    pub fn line(&self) -> u32 {
        self.line
    }

    /// Returns the changes that a mutant may make here.
    pub fn changes(&self) -> &'static [Change] {
        match self.operation {
            "add" | "mul" | "mul_add" | "mul_sub" => {
                &[RoundsDown, Opposite, First, Second, Neighbour]
            }
            "sqrt" => &[RoundsDown, First, Neighbour],
            "sub" => &[RoundsDown, Opposite, Exchanged, First, Neighbour],
            "div" => &[RoundsDown, Exchanged, First, Neighbour],
            "min" | "max" | "lt" | "le" => &[Opposite, Exchanged, First, Second],
            "and" | "or" | "select" | "select_signed" => &[Opposite, First, Second],
            "neg" | "abs" | "floor" | "ceil" | "trunc" | "nearest" => &[Opposite],
            "eq" => &[First, Second],
            "narrow" => &[RoundsDown, Neighbour],
            _ => &[],
        }
    }
}

/// A wrong operation at a place of the code.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Mutant {
    pub site: Site,
    pub change: Change,
}

impl fmt::Display for Mutant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Site { line, column, operation, .. } = self.site;
        write!(f, "{}:{line}:{column} {operation} {:?}", self.site.file(), self.change)
    }
}

/// The task of a trial's machines.
#[derive(Clone, Debug)]
pub enum Mode {
    /// They record where rules call operations.
    Record(Arc<Mutex<BTreeSet<Site>>>),
    /// They do one thing wrong, and tell whether a result ever had another value.
    Wrong(Mutant, Arc<AtomicBool>),
}

/// The task of a trial's machines, and a summary of the kernels' results.
#[derive(Clone, Debug)]
pub struct Plan {
    pub mode: Mode,
    pub summary: Arc<Mutex<Summary>>,
}

impl Plan {
    pub fn new(mode: Mode) -> Self {
        Self { mode, summary: Arc::default() }
    }

    /// Adds to the summary.
    pub fn summarise(&self, add: impl FnOnce(&mut Summary)) {
        add(&mut self.summary.lock().expect("no panic while adding"));
    }
}

/// A measure of how much kernels claim.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Summary {
    /// Number of facts that hold in a lane.
    pub facts: u64,
    /// Number of bounds.
    pub bounds: u64,
    /// Sum of the magnitudes of all bounds, as logarithms.
    pub sizes: f64,
}

impl Summary {
    /// Adds a bound.
    pub fn bound(&mut self, bound: f64) {
        // The logarithm of infinite bounds, and the size that gives a logarithm of 1.
        const MOST: f64 = 256.0;
        const LEAST: f64 = 1.0 / 1024.0;
        if !bound.is_nan() {
            self.bounds += 1;
            self.sizes += (1.0 + bound.abs() / LEAST).log2().min(MOST).copysign(bound);
        }
    }

    /// The mean size of bounds.
    pub fn mean(&self) -> f64 {
        self.sizes / self.bounds.max(1) as f64
    }
}

/// A software machine that follows a plan.
#[derive(Clone, Debug)]
pub struct Perturbed {
    software: Software,
    plan: Plan,
}

impl Perturbed {
    pub fn new(software: Software, plan: &Plan) -> Self {
        Self { software, plan: plan.clone() }
    }

    /// Returns the change to make in a call of `operation` at `location`.
    #[inline]
    fn change(&self, operation: &'static str, location: &'static Location) -> Option<Change> {
        let (line, column) = (location.line(), location.column());
        match &self.plan.mode {
            Mode::Record(sites) => {
                let site = Site { file: location.file(), line, column, operation };
                sites.lock().expect("no panic while recording").insert(site);
                None
            }
            Mode::Wrong(Mutant { site, change }, _) => {
                let is_here = line == site.line
                    && column == site.column
                    && operation == site.operation
                    && location.file() == site.file;
                is_here.then_some(*change)
            }
        }
    }

    /// The result of a fused operation with a change. Without one, it is a·b minus `opposite`.
    fn wrong_fused(
        &self,
        change: Change,
        right: Vector128,
        [a, b, c]: [Vector128; 3],
        opposite: Vector128,
    ) -> Vector128 {
        let mut software = self.software;
        match change {
            RoundsDown => software.mul_add(a.negated(), b, opposite).negated(),
            Opposite => software.mul_add(a, b, opposite),
            First => software.mul(a, b),
            Second => c,
            Neighbour => lower(right),
            Exchanged => right,
        }
    }

    fn compare(&self, right: Vector128, wrong: Vector128) -> Vector128 {
        if let Mode::Wrong(_, differs) = &self.plan.mode
            && !is_equal(right, wrong)
        {
            differs.store(true, Ordering::Relaxed);
        }
        wrong
    }

    fn true_like(&mut self, a: Vector128) -> Vector128 {
        self.software.bits(format_of(a), u64::MAX)
    }

    fn false_like(&mut self, a: Vector128) -> Vector128 {
        self.software.bits(format_of(a), 0)
    }

    /// The sum, product, quotient or fused product, rounded down.
    fn down(
        &mut self,
        a: Vector128,
        b: Vector128,
        operation: fn(&mut Software, Vector128, Vector128) -> Vector128,
        signs: [bool; 2],
    ) -> Vector128 {
        let m = &mut self.software;
        let a = if signs[0] { m.neg(a) } else { a };
        let b = if signs[1] { m.neg(b) } else { b };
        let opposite = operation(m, a, b);
        m.neg(opposite)
    }
}

fn format_of(a: Vector128) -> Format {
    match a {
        Vector128::F32(_) => Format::F32,
        Vector128::F64(_) => Format::F64,
    }
}

/// Returns whether vectors have the same values. Zeros of either sign are equal.
fn is_equal(a: Vector128, b: Vector128) -> bool {
    if a == b {
        return true;
    }
    match a {
        Vector128::F32(_) => {
            a.f32().iter().zip(b.f32()).all(|(a, b)| *a == b || a.to_bits() == b.to_bits())
        }
        Vector128::F64(_) => {
            a.f64().iter().zip(b.f64()).all(|(a, b)| *a == b || a.to_bits() == b.to_bits())
        }
    }
}

/// The next lower number in each lane.
fn lower(a: Vector128) -> Vector128 {
    match a {
        Vector128::F32(_) => Vector128::from_f32(a.f32().map(f32::next_down)),
        Vector128::F64(_) => Vector128::from_f64(a.f64().map(f64::next_down)),
    }
}

/// Operations of two vectors, each with its results where it is changed.
macro_rules! binary {
    ($($name:ident($m:ident, $a:ident, $b:ident): $($change:pat => $result:expr),*;)*) => {$(
        #[track_caller]
        fn $name(&mut self, $a: Vector128, $b: Vector128) -> Vector128 {
            let right = self.software.$name($a, $b);
            let Some(change) = self.change(stringify!($name), Location::caller()) else {
                return right;
            };
            let $m = &mut *self;
            let wrong = match change {
                Neighbour => lower(right),
                First => $a,
                Second => $b,
                Exchanged => $m.software.$name($b, $a),
                $($change => $result,)*
                #[allow(unreachable_patterns, reason = "some operations have all changes")]
                _ => right,
            };
            self.compare(right, wrong)
        }
    )*};
}

/// Comparisons.
macro_rules! comparison {
    ($($name:ident, $other:ident;)*) => {$(
        #[track_caller]
        fn $name(&mut self, a: Vector128, b: Vector128) -> Vector128 {
            let right = self.software.$name(a, b);
            let Some(change) = self.change(stringify!($name), Location::caller()) else {
                return right;
            };
            let wrong = match change {
                First => self.true_like(a),
                Second => self.false_like(a),
                Exchanged => self.software.$name(b, a),
                Opposite => self.software.$other(a, b),
                RoundsDown | Neighbour => right,
            };
            self.compare(right, wrong)
        }
    )*};
}

/// Operations of one vector, which may become another one.
macro_rules! unary {
    ($($name:ident => $other:expr;)*) => {$(
        #[track_caller]
        fn $name(&mut self, a: Vector128) -> Vector128 {
            let right = self.software.$name(a);
            match self.change(stringify!($name), Location::caller()) {
                None => right,
                Some(_) => {
                    let other: fn(&mut Software, Vector128) -> Vector128 = $other;
                    let wrong = other(&mut self.software, a);
                    self.compare(right, wrong)
                }
            }
        }
    )*};
}

/// Operations that no mutant changes.
macro_rules! unchanged {
    ($($name:ident($($operand:ident: $type:ty),*) -> $result:ty;)*) => {$(
        fn $name(&mut self, $($operand: $type),*) -> $result {
            self.software.$name($($operand),*)
        }
    )*};
}

impl Machine for Perturbed {
    type V = Vector128;

    unchanged! {
        number(format: Format, value: f64) -> Vector128;
        bits(format: Format, bits: u64) -> Vector128;
        xor(a: Vector128, b: Vector128) -> Vector128;
        int_add(a: Vector128, b: Vector128) -> Vector128;
        int_sub(a: Vector128, b: Vector128) -> Vector128;
        shift_left(a: Vector128, by: u8) -> Vector128;
        shift_right(a: Vector128, by: u8) -> Vector128;
        widen(a: Vector128) -> [Vector128; 2];
    }

    binary! {
        add(m, a, b):
            RoundsDown => m.down(a, b, Software::add, [true; 2]),
            Opposite => m.software.sub(a, b);
        sub(m, a, b):
            RoundsDown => m.software.sub(b, a).negated(),
            Opposite => m.software.add(a, b);
        mul(m, a, b):
            RoundsDown => m.down(a, b, Software::mul, [true, false]),
            Opposite => m.down(a, b, Software::mul, [false; 2]);
        div(m, a, b):
            RoundsDown => m.down(a, b, Software::div, [true, false]),
            Opposite => m.down(a, b, Software::div, [false; 2]);
        min(m, a, b): Opposite => m.software.max(a, b);
        max(m, a, b): Opposite => m.software.min(a, b);
        and(m, a, b): Opposite => m.software.or(a, b);
        or(m, a, b): Opposite => m.software.and(a, b);
    }

    comparison! {
        lt, le;
        le, lt;
        eq, le;
    }

    unary! {
        neg => |_, a| a;
        abs => |_, a| a;
        floor => Software::ceil;
        ceil => Software::floor;
        trunc => Software::floor;
        nearest => Software::floor;
    }

    #[track_caller]
    fn sqrt(&mut self, a: Vector128) -> Vector128 {
        let right = self.software.sqrt(a);
        let Some(change) = self.change("sqrt", Location::caller()) else { return right };
        let wrong = match change {
            First => a,
            Neighbour => lower(right),
            _ => {
                // The root is exact if its square is.
                let up = self.software.mul(right, right);
                let down = self.down(right, right, Software::mul, [true, false]);
                let (above, below) = (self.software.eq(up, a), self.software.eq(down, a));
                let exact = self.software.and(above, below);
                self.software.select(exact, right, lower(right))
            }
        };
        self.compare(right, wrong)
    }

    #[track_caller]
    fn mul_add(&mut self, a: Vector128, b: Vector128, c: Vector128) -> Vector128 {
        let right = self.software.mul_add(a, b, c);
        let Some(change) = self.change("mul_add", Location::caller()) else { return right };
        let opposite = self.software.neg(c);
        let wrong = self.wrong_fused(change, right, [a, b, c], opposite);
        self.compare(right, wrong)
    }

    #[track_caller]
    fn mul_sub(&mut self, a: Vector128, b: Vector128, c: Vector128) -> Vector128 {
        let right = self.software.mul_sub(a, b, c);
        let Some(change) = self.change("mul_sub", Location::caller()) else { return right };
        let wrong = self.wrong_fused(change, right, [a, b, c], c);
        self.compare(right, wrong)
    }

    #[track_caller]
    fn select(&mut self, mask: Vector128, a: Vector128, b: Vector128) -> Vector128 {
        let right = self.software.select(mask, a, b);
        let Some(change) = self.change("select", Location::caller()) else { return right };
        let wrong = match change {
            First => a,
            Second => b,
            _ => self.software.select(mask, b, a),
        };
        self.compare(right, wrong)
    }

    #[track_caller]
    fn select_signed(&mut self, sign: Vector128, a: Vector128, b: Vector128) -> Vector128 {
        let right = self.software.select_signed(sign, a, b);
        let change = self.change("select_signed", Location::caller());
        let Some(change) = change else { return right };
        let wrong = match change {
            First => a,
            Second => b,
            _ => self.software.select_signed(sign, b, a),
        };
        self.compare(right, wrong)
    }

    #[track_caller]
    fn narrow(&mut self, halves: [Vector128; 2]) -> Vector128 {
        let right = self.software.narrow(halves);
        let Some(change) = self.change("narrow", Location::caller()) else { return right };
        let wrong = match change {
            Neighbour => lower(right),
            _ => self.software.narrow(halves.map(Negated::negated)).negated(),
        };
        self.compare(right, wrong)
    }
}

trait Negated {
    /// The vector of opposite numbers.
    fn negated(self) -> Self;
}

impl Negated for Vector128 {
    fn negated(self) -> Self {
        Software::new().neg(self)
    }
}
