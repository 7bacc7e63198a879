//! Kernels in other arithmetics than [`Native`](crate::Native) uses, to measure what rigor costs.
//!
//! A picture must never be based on results of these kernels. So they have their own type, and CI
//! checks that the program holds none of this code. They use the same rules as [`Native`](crate::Native), but
//! their [`Machine`] rounds differently.

use crate::code::Code;
use crate::compiler::{BatchPointers, compile_for_comparison};
use crate::error::Error;
use crate::lanes::{Emitter, LaneVector};
use crate::rounding::{call_rounding_to_nearest, call_rounding_up};
use std::marker::PhantomData;
use zeroset_eval::{Binding, Input, Kernel, Loader, Query, Real, Tape};
use zeroset_interval::{Format, Machine, has_fma};

/// A way to round results.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Arithmetic {
    /// To nearest. Affine forms ignore their rounding errors. **Not sound**: bounds may miss
    /// values.
    Unsound,
    /// To nearest; further operations then move each bound up to the next float. Systems that
    /// cannot set a rounding mode usually do this. Sound.
    Widened,
    /// To +∞, by the processor's rounding mode, as in [`Native`](crate::Native).
    Upward,
}

impl Arithmetic {
    /// All arithmetics, from the weakest guarantee to the strongest.
    pub const ALL: [Self; 3] = [Self::Unsound, Self::Widened, Self::Upward];
}

/// A kernel in a chosen arithmetic. All these kernels use one tier, so they differ only in
/// arithmetic.
pub struct ComparisonKernel<Q: Query, T: Real = f32> {
    code: Code,
    arithmetic: Arithmetic,
    tape: Tape<T>,
    binding: Binding<T>,
    query: PhantomData<Q>,
}

impl<Q: Query, T: Real> ComparisonKernel<Q, T> {
    /// Compiles `tape` for this processor and binds its parameters.
    ///
    /// # Errors
    /// If the processor is not supported or the formula too large.
    ///
    /// # Panics
    /// As for [`Native::new`](crate::Native::new).
    pub fn new(tape: Tape<T>, binding: Binding<T>, arithmetic: Arithmetic) -> Result<Self, Error> {
        let code = compile_for_comparison::<Q, T>(&tape, |emitter, cursor| match arithmetic {
            Arithmetic::Upward => Q::answer(&tape, emitter, cursor),
            Arithmetic::Unsound | Arithmetic::Widened => {
                let widens = arithmetic == Arithmetic::Widened;
                let mut nearest = Nearest { emitter, widens, is_widening: widens };
                Q::answer(&tape, &mut nearest, cursor)
            }
        })?;
        Q::check(&tape, &binding);
        Ok(Self { code, arithmetic, tape, binding, query: PhantomData })
    }

    /// Size of the machine code in bytes.
    pub fn code_bytes(&self) -> usize {
        self.code.bytes
    }
}

impl<Q: Query, T: Real> Kernel<Q, T> for ComparisonKernel<Q, T> {
    #[inline]
    fn eval(&self, input: &Q::Input<T>, output: &mut Q::Output<T>) {
        Q::check_input(&self.tape, input);
        let call = match self.arithmetic {
            Arithmetic::Unsound | Arithmetic::Widened => call_rounding_to_nearest,
            Arithmetic::Upward => call_rounding_up,
        };
        // SAFETY: as for `Native`, which has the same contract.
        unsafe {
            call(
                self.code.entry(),
                (&raw const *input).cast(),
                (&raw mut *output).cast(),
                input.count(),
                self.binding.quantities().as_ptr().cast(),
            );
        }
    }
}

/// A machine that emits code to be run while rounding to nearest.
struct Nearest<'a, 'b, 'c> {
    emitter: &'a mut Emitter<'b, 'c>,
    /// Whether this arithmetic moves bounds up to the next float.
    widens: bool,
    /// Like `widens`, but false within [`Machine::unrounded`].
    is_widening: bool,
}

impl<T: Real> Loader<Nearest<'_, '_, '_>> for BatchPointers<T> {
    fn input(&mut self, m: &mut Nearest<'_, '_, '_>, quantity: usize) -> LaneVector {
        self.input(m.emitter, quantity)
    }

    fn parameter(&mut self, m: &mut Nearest<'_, '_, '_>, quantity: usize) -> LaneVector {
        self.parameter(m.emitter, quantity)
    }
}

impl Nearest<'_, '_, '_> {
    /// Returns `result`, or the next float above it if `is_widening`.
    fn widened(&mut self, result: LaneVector) -> LaneVector {
        if self.is_widening { self.next_up(result) } else { result }
    }

    /// Returns the next float above `a`: the bits of `a` plus 1, or minus 1 if `a` is negative. +∞
    /// and NaN stay the same.
    fn next_up(&mut self, a: LaneVector) -> LaneVector {
        let m = &mut *self.emitter;
        let format = m.format(a);
        let (zero, two) = (m.number(format, 0.0), m.bits(format, 2));
        let infinity = m.number(format, f64::INFINITY);
        let a = m.add(a, zero); // −0 becomes +0
        let finite = m.lt(a, infinity); // a set lane is the integer −1
        let sign = m.shift_right(a, if format == Format::F32 { 30 } else { 62 });
        let twice = m.and(sign, two);
        let moved = m.int_sub(a, finite);
        m.int_sub(moved, twice)
    }
}

/// Emits operations unchanged: they are exact, or their results are no bounds.
macro_rules! kept {
    ($($name:ident($($operand:ident: $kind:ty),*) -> $result:ty;)*) => {
        $(fn $name(&mut self, $($operand: $kind),*) -> $result {
            self.emitter.$name($($operand),*)
        })*
    };
}

/// Emits operations that round. Their results may be bounds, so they are moved up if `is_widening`.
macro_rules! rounded {
    ($($name:ident($($operand:ident: $kind:ty),*);)*) => {
        $(fn $name(&mut self, $($operand: $kind),*) -> LaneVector {
            let result = self.emitter.$name($($operand),*);
            self.widened(result)
        })*
    };
}

impl Machine for Nearest<'_, '_, '_> {
    type V = LaneVector;

    fn mul_add(&mut self, a: LaneVector, b: LaneVector, c: LaneVector) -> LaneVector {
        if has_fma() {
            let result = self.emitter.mul_add(a, b, c);
            return self.widened(result);
        }
        let product = self.mul(a, b);
        self.add(product, c)
    }

    rounded! {
        add(a: LaneVector, b: LaneVector);
        sub(a: LaneVector, b: LaneVector);
        mul(a: LaneVector, b: LaneVector);
        div(a: LaneVector, b: LaneVector);
        sqrt(a: LaneVector);
        narrow(halves: [LaneVector; 2]);
    }
    kept! {
        number(format: Format, value: f64) -> LaneVector;
        bits(format: Format, bits: u64) -> LaneVector;
        neg(a: LaneVector) -> LaneVector;
        abs(a: LaneVector) -> LaneVector;
        min(a: LaneVector, b: LaneVector) -> LaneVector;
        max(a: LaneVector, b: LaneVector) -> LaneVector;
        floor(a: LaneVector) -> LaneVector;
        ceil(a: LaneVector) -> LaneVector;
        trunc(a: LaneVector) -> LaneVector;
        nearest(a: LaneVector) -> LaneVector;
        lt(a: LaneVector, b: LaneVector) -> LaneVector;
        le(a: LaneVector, b: LaneVector) -> LaneVector;
        eq(a: LaneVector, b: LaneVector) -> LaneVector;
        and(a: LaneVector, b: LaneVector) -> LaneVector;
        or(a: LaneVector, b: LaneVector) -> LaneVector;
        xor(a: LaneVector, b: LaneVector) -> LaneVector;
        select(mask: LaneVector, a: LaneVector, b: LaneVector) -> LaneVector;
        select_signed(sign: LaneVector, a: LaneVector, b: LaneVector) -> LaneVector;
        int_add(a: LaneVector, b: LaneVector) -> LaneVector;
        int_sub(a: LaneVector, b: LaneVector) -> LaneVector;
        shift_left(a: LaneVector, by: u8) -> LaneVector;
        shift_right(a: LaneVector, by: u8) -> LaneVector;
        widen(a: LaneVector) -> [LaneVector; 2];
    }

    fn repeat<const ROWS: usize, const IN: usize, const OUT: usize>(
        &mut self,
        inputs: [[LaneVector; IN]; ROWS],
        mut routine: impl FnMut(&mut Self, [LaneVector; IN]) -> [LaneVector; OUT],
    ) -> [[LaneVector; OUT]; ROWS] {
        let (rows, inputs) = self.emitter.begin_rows(inputs, OUT);
        let outputs = routine(self, inputs);
        self.emitter.end_rows::<ROWS, IN, OUT>(&rows, outputs)
    }

    fn unrounded<R>(&mut self, text: impl FnOnce(&mut Self) -> R) -> R {
        let before = std::mem::replace(&mut self.is_widening, false);
        let result = text(self);
        self.is_widening = before;
        result
    }

    fn outward(&mut self, bound: LaneVector) -> LaneVector {
        let once = self.widened(bound);
        self.widened(once)
    }

    /// Clamps a bound only where rules rely on the clamp: for signs, domains from −1 to 1, and
    /// finiteness.
    fn clamp_to(&mut self, format: Format, bound: LaneVector, most: f64) -> LaneVector {
        let huge = match format {
            Format::F32 => f64::from(f32::MAX / 2.0),
            Format::F64 => f64::MAX / 2.0,
        };
        if !self.widens || !(most <= 1.0 || (huge..f64::INFINITY).contains(&most)) {
            return bound;
        }
        let most = self.emitter.number(format, most);
        self.emitter.min(bound, most)
    }

    fn counts_rounding(&self) -> bool {
        self.widens
    }
}
