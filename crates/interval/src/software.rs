//! The machine that computes in software: the reference for every kernel.

use crate::enclosure::{Enclosure, Exponent, Operand};
use crate::machine::{Format, Machine, has_fma};
use crate::point::evaluate;
use crate::round::{f32_up, f64_up};
use crate::rules::enclose;
use zeroset_ops::Op;

/// The lanes of a vector, as bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Vector128 {
    /// Four lanes of `f32`.
    F32([u32; 4]),
    /// Two lanes of `f64`.
    F64([u64; 2]),
}

impl Vector128 {
    /// Returns a vector of four `f32`.
    pub fn from_f32(lanes: [f32; 4]) -> Self {
        Self::F32(lanes.map(f32::to_bits))
    }

    /// Returns a vector of two `f64`.
    pub fn from_f64(lanes: [f64; 2]) -> Self {
        Self::F64(lanes.map(f64::to_bits))
    }

    /// Returns the bits of the four `f32` lanes.
    ///
    /// # Panics
    /// If the lanes are `f64`.
    pub fn bits_32(self) -> [u32; 4] {
        match self {
            Self::F32(lanes) => lanes,
            Self::F64(_) => panic!("expected f32 lanes"),
        }
    }

    /// Returns the bits of the two `f64` lanes.
    ///
    /// # Panics
    /// If the lanes are `f32`.
    pub fn bits_64(self) -> [u64; 2] {
        match self {
            Self::F64(lanes) => lanes,
            Self::F32(_) => panic!("expected f64 lanes"),
        }
    }

    /// Returns the four `f32` lanes.
    ///
    /// # Panics
    /// If the lanes are `f64`.
    pub fn f32(self) -> [f32; 4] {
        self.bits_32().map(f32::from_bits)
    }

    /// Returns the two `f64` lanes.
    ///
    /// # Panics
    /// If the lanes are `f32`.
    pub fn f64(self) -> [f64; 2] {
        self.bits_64().map(f64::from_bits)
    }
}

/// A [`Machine`] that computes each lane in software, whatever the processor's rounding mode is.
#[derive(Clone, Copy, Debug)]
pub struct Software {
    fuses: bool,
}

impl Software {
    /// The machine with one rounding for a·b + c, and the machine with two.
    pub const BOTH: [Self; 2] = [Self { fuses: true }, Self { fuses: false }];

    /// Returns the machine that rounds a·b + c as this processor does.
    #[must_use]
    pub fn new() -> Self {
        Self { fuses: has_fma() }
    }

    /// Encloses `op` as [`enclose`] does. Unlike that function, it is compiled in this crate alone.
    ///
    /// # Panics
    /// If the number of operands is not the arity of `op`.
    pub fn enclose(
        format: Format,
        op: Op,
        operands: &[Operand<Vector128>],
    ) -> Enclosure<Vector128> {
        enclose(&mut Self::new(), format, op, operands)
    }

    /// Evaluates `op` as [`evaluate`] does. Unlike that function, it is compiled in this crate
    /// alone.
    ///
    /// # Panics
    /// If the number of operands is not the arity of `op`.
    pub fn evaluate(
        format: Format,
        op: Op,
        operands: &[Vector128],
        exponent: Exponent,
    ) -> Vector128 {
        evaluate(&mut Self::new(), format, op, operands, exponent)
    }
}

impl Default for Software {
    fn default() -> Self {
        Self::new()
    }
}

/// Applies `f` or `g`, depending on the format, to the bits of each lane.
fn each(a: Vector128, f: impl Fn(u32) -> u32, g: impl Fn(u64) -> u64) -> Vector128 {
    match a {
        Vector128::F32(a) => Vector128::F32(a.map(f)),
        Vector128::F64(a) => Vector128::F64(a.map(g)),
    }
}

/// Applies `f` or `g`, depending on the format, to the number in each lane.
fn unary(a: Vector128, f: impl Fn(f32) -> f32, g: impl Fn(f64) -> f64) -> Vector128 {
    each(a, |a| f(f32::from_bits(a)).to_bits(), |a| g(f64::from_bits(a)).to_bits())
}

/// Applies `f` or `g`, depending on the format, to the two numbers in each lane.
fn binary(
    a: Vector128,
    b: Vector128,
    f: impl Fn(f32, f32) -> f32,
    g: impl Fn(f64, f64) -> f64,
) -> Vector128 {
    integer(
        a,
        b,
        |a, b| f(f32::from_bits(a), f32::from_bits(b)).to_bits(),
        |a, b| g(f64::from_bits(a), f64::from_bits(b)).to_bits(),
    )
}

/// Applies `f` or `g`, depending on the format, to the bits of the two numbers in each lane.
fn integer(
    a: Vector128,
    b: Vector128,
    f: impl Fn(u32, u32) -> u32,
    g: impl Fn(u64, u64) -> u64,
) -> Vector128 {
    match (a, b) {
        (Vector128::F32(a), Vector128::F32(b)) => {
            Vector128::F32(std::array::from_fn(|i| f(a[i], b[i])))
        }
        (Vector128::F64(a), Vector128::F64(b)) => {
            Vector128::F64(std::array::from_fn(|i| g(a[i], b[i])))
        }
        _ => panic!("operands of one operation share a format"),
    }
}

/// Sets all bits of the lanes in which `f` or `g`, depending on the format, is true.
fn compare(
    a: Vector128,
    b: Vector128,
    f: impl Fn(f32, f32) -> bool,
    g: impl Fn(f64, f64) -> bool,
) -> Vector128 {
    integer(
        a,
        b,
        |a, b| {
            if f(f32::from_bits(a), f32::from_bits(b)) { u32::MAX } else { 0 }
        },
        |a, b| {
            if g(f64::from_bits(a), f64::from_bits(b)) { u64::MAX } else { 0 }
        },
    )
}

/// Operations that treat each lane alone, each with its function for `f32` and for `f64`.
macro_rules! lanewise {
    ($($name:ident($($operand:ident),*) = $by:ident($f32:expr, $f64:expr);)*) => {$(
        fn $name(&mut self, $($operand: Vector128),*) -> Vector128 {
            $by($($operand,)* $f32, $f64)
        }
    )*};
}

impl Machine for Software {
    type V = Vector128;

    fn number(&mut self, format: Format, value: f64) -> Vector128 {
        match format {
            Format::F32 => {
                let narrow = value as f32;
                debug_assert!(f64::from(narrow) == value, "{value} is not exact in f32");
                Vector128::from_f32([narrow; 4])
            }
            Format::F64 => Vector128::from_f64([value; 2]),
        }
    }
    fn bits(&mut self, format: Format, bits: u64) -> Vector128 {
        match format {
            Format::F32 => Vector128::F32([bits as u32; 4]),
            Format::F64 => Vector128::F64([bits; 2]),
        }
    }

    lanewise! {
        add(a, b) = binary(f32_up::add, f64_up::add);
        sub(a, b) = binary(f32_up::sub, f64_up::sub);
        mul(a, b) = binary(f32_up::mul, f64_up::mul);
        div(a, b) = binary(f32_up::div, f64_up::div);
        sqrt(a) = unary(f32_up::sqrt, f64_up::sqrt);
        neg(a) = unary(|a| -a, |a| -a);
        abs(a) = unary(f32::abs, f64::abs);
        min(a, b) = binary(|a, b| if a < b { a } else { b }, |a, b| if a < b { a } else { b });
        max(a, b) = binary(|a, b| if a > b { a } else { b }, |a, b| if a > b { a } else { b });
        floor(a) = unary(f32::floor, f64::floor);
        ceil(a) = unary(f32::ceil, f64::ceil);
        trunc(a) = unary(f32::trunc, f64::trunc);
        nearest(a) = unary(f32::round_ties_even, f64::round_ties_even);
        lt(a, b) = compare(|a, b| a < b, |a, b| a < b);
        le(a, b) = compare(|a, b| a <= b, |a, b| a <= b);
        eq(a, b) = compare(|a, b| a == b, |a, b| a == b);
        and(a, b) = integer(|a, b| a & b, |a, b| a & b);
        or(a, b) = integer(|a, b| a | b, |a, b| a | b);
        xor(a, b) = integer(|a, b| a ^ b, |a, b| a ^ b);
        int_add(a, b) = integer(u32::wrapping_add, u64::wrapping_add);
        int_sub(a, b) = integer(u32::wrapping_sub, u64::wrapping_sub);
    }

    fn mul_add(&mut self, a: Vector128, b: Vector128, c: Vector128) -> Vector128 {
        if !self.fuses {
            let product = self.mul(a, b);
            return self.add(product, c);
        }
        match a {
            Vector128::F32(_) => {
                let (a, b, c) = (a.f32(), b.f32(), c.f32());
                Vector128::from_f32(std::array::from_fn(|i| f32_up::mul_add(a[i], b[i], c[i])))
            }
            Vector128::F64(_) => {
                let (a, b, c) = (a.f64(), b.f64(), c.f64());
                Vector128::from_f64(std::array::from_fn(|i| f64_up::mul_add(a[i], b[i], c[i])))
            }
        }
    }
    fn select(&mut self, mask: Vector128, a: Vector128, b: Vector128) -> Vector128 {
        let chosen = self.and(mask, a);
        let other = integer(mask, b, |m, b| !m & b, |m, b| !m & b);
        self.or(chosen, other)
    }

    fn select_signed(&mut self, sign: Vector128, a: Vector128, b: Vector128) -> Vector128 {
        let mask = each(sign, |a| (a as i32 >> 31) as u32, |a| (a as i64 >> 63) as u64);
        self.select(mask, a, b)
    }

    fn shift_left(&mut self, a: Vector128, by: u8) -> Vector128 {
        each(a, |a| a << by, |a| a << by)
    }
    fn shift_right(&mut self, a: Vector128, by: u8) -> Vector128 {
        each(a, |a| a >> by, |a| a >> by)
    }

    fn widen(&mut self, a: Vector128) -> [Vector128; 2] {
        let a = a.f32().map(f64::from);
        [Vector128::from_f64([a[0], a[1]]), Vector128::from_f64([a[2], a[3]])]
    }
    fn narrow(&mut self, halves: [Vector128; 2]) -> Vector128 {
        let ([a, b], [c, d]) = (halves[0].f64(), halves[1].f64());
        Vector128::from_f32([a, b, c, d].map(f32_up::from_f64))
    }
}
