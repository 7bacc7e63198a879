//! The primitive lane operations in which every rule is written.

/// The type of the lanes of a 128-bit vector.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Format {
    /// Four lanes of `f32`.
    F32,
    /// Two lanes of `f64`.
    F64,
}

impl Format {
    /// What is meant for this format.
    pub(crate) fn pick<T>(self, f32: T, f64: T) -> T {
        match self {
            Self::F32 => f32,
            Self::F64 => f64,
        }
    }
}

/// Whether this processor has an instruction for a·b + c that rounds once, and code that is made
/// for it uses that. All machines do as it does, so that they agree.
#[must_use]
pub fn has_fma() -> bool {
    #[cfg(target_arch = "x86_64")]
    return is_x86_feature_detected!("avx") && is_x86_feature_detected!("fma");
    #[cfg(not(target_arch = "x86_64"))]
    cfg!(target_arch = "aarch64")
}

/// A machine with vectors that rounds up. Rules are written for 128 bits; since they do the same to
/// each lane, code may run on wider ones.
///
/// Rules are written once over this trait. One implementation emits native code, the other
/// ([`Software`](crate::Software)) computes; both give the same bits (NaN apart, which no rule lets
/// through). Arithmetic rounds to +∞, subnormals are kept, nothing is fused but
/// [`Machine::mul_add`]. Operands of one call share a [`Format`]. A mask is a vector whose lanes
/// are all ones or all zeros.
pub trait Machine {
    /// A vector.
    type V: Copy;

    /// The same number in all lanes; `value` must be exact in `format`.
    fn number(&mut self, format: Format, value: f64) -> Self::V;
    /// The same bits in all lanes (the low 32 for `F32`).
    fn bits(&mut self, format: Format, bits: u64) -> Self::V;

    /// a + b.
    fn add(&mut self, a: Self::V, b: Self::V) -> Self::V;
    /// a − b.
    fn sub(&mut self, a: Self::V, b: Self::V) -> Self::V;
    /// a · b.
    fn mul(&mut self, a: Self::V, b: Self::V) -> Self::V;
    /// a · b + c: rounded once where the processor [can](crate::has_fma), else after each step. A
    /// product too large is then no ∞ before c is added: together with a c of −∞ it makes −∞, not
    /// NaN. On x86-64 the instruction overwrites a, which is best a value that is not needed any
    /// more.
    fn mul_add(&mut self, a: Self::V, b: Self::V, c: Self::V) -> Self::V;
    /// a · b − c, rounded as [`Machine::mul_add`].
    fn mul_sub(&mut self, a: Self::V, b: Self::V, c: Self::V) -> Self::V {
        let opposite = self.neg(c);
        self.mul_add(a, b, opposite)
    }
    /// a / b.
    fn div(&mut self, a: Self::V, b: Self::V) -> Self::V;
    /// √a.
    fn sqrt(&mut self, a: Self::V) -> Self::V;
    /// −a, exactly.
    fn neg(&mut self, a: Self::V) -> Self::V;
    /// |a|, exactly.
    fn abs(&mut self, a: Self::V) -> Self::V;
    /// a where a < b, else b: b if either is NaN.
    fn min(&mut self, a: Self::V, b: Self::V) -> Self::V;
    /// a where a > b, else b: b if either is NaN.
    fn max(&mut self, a: Self::V, b: Self::V) -> Self::V;
    /// Largest integer ≤ a.
    fn floor(&mut self, a: Self::V) -> Self::V;
    /// Smallest integer ≥ a.
    fn ceil(&mut self, a: Self::V) -> Self::V;
    /// a without its fraction.
    fn trunc(&mut self, a: Self::V) -> Self::V;
    /// The nearest integer, halves to even.
    fn nearest(&mut self, a: Self::V) -> Self::V;

    /// Mask of a < b; false for NaN.
    fn lt(&mut self, a: Self::V, b: Self::V) -> Self::V;
    /// Mask of a ≤ b; false for NaN.
    fn le(&mut self, a: Self::V, b: Self::V) -> Self::V;
    /// Mask of a = b; false for NaN.
    fn eq(&mut self, a: Self::V, b: Self::V) -> Self::V;
    /// Bitwise and.
    fn and(&mut self, a: Self::V, b: Self::V) -> Self::V;
    /// Bitwise or.
    fn or(&mut self, a: Self::V, b: Self::V) -> Self::V;
    /// Bitwise exclusive or.
    fn xor(&mut self, a: Self::V, b: Self::V) -> Self::V;
    /// a where the mask is set, else b.
    fn select(&mut self, mask: Self::V, a: Self::V, b: Self::V) -> Self::V;

    /// a where the sign bit of `sign` is set, else b: −0 and negative NaN select a.
    fn select_signed(&mut self, sign: Self::V, a: Self::V, b: Self::V) -> Self::V;

    /// Lane bits a + b as integers, wrapping.
    fn int_add(&mut self, a: Self::V, b: Self::V) -> Self::V;
    /// Lane bits a − b as integers, wrapping.
    fn int_sub(&mut self, a: Self::V, b: Self::V) -> Self::V;
    /// Lane bits shifted left.
    fn shift_left(&mut self, a: Self::V, by: u8) -> Self::V;
    /// Lane bits shifted right, zeros entering.
    fn shift_right(&mut self, a: Self::V, by: u8) -> Self::V;

    /// All `f32` lanes as two vectors of `f64`: those of the lower half, then those of the upper.
    /// Exact.
    fn widen(&mut self, a: Self::V) -> [Self::V; 2];
    /// The inverse of [`Machine::widen`], rounded up.
    fn narrow(&mut self, halves: [Self::V; 2]) -> Self::V;

    /// Applies `routine` to each row of inputs, all `F64`; native code does so in a loop, so that
    /// it is emitted once (a kernel with nine cosines compiles in half the time, and runs a sixth
    /// faster). What `routine` computes must not be used but through its results.
    fn repeat<const ROWS: usize, const IN: usize, const OUT: usize>(
        &mut self,
        inputs: [[Self::V; IN]; ROWS],
        mut routine: impl FnMut(&mut Self, [Self::V; IN]) -> [Self::V; OUT],
    ) -> [[Self::V; OUT]; ROWS]
    where
        Self: Sized,
    {
        inputs.map(|row| routine(self, row))
    }

    // What follows means nothing to a machine that rounds up. It tells another, which rounds to
    // nearest and moves each result, what needs no moving and what moving might break.

    /// Writes what need be no bound: it is exact, or what it rounds by is counted elsewhere.
    fn nearly<R>(&mut self, text: impl FnOnce(&mut Self) -> R) -> R
    where
        Self: Sized,
    {
        text(self)
    }
    /// A bound that was written by [`Machine::nearly`], of which only the last rounding counts.
    fn outward(&mut self, bound: Self::V) -> Self::V {
        bound
    }
    /// A bound that no rounding up takes beyond `most`, as rules rely on; `most` is exact in
    /// `format`.
    fn held(&mut self, _format: Format, bound: Self::V, _most: f64) -> Self::V {
        bound
    }
    /// Whether forms are to hold what rounding adds to them.
    fn counts_rounding(&self) -> bool {
        true
    }
}
