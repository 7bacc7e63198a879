//! The lane operations in which every rule is written.

/// The type of a vector's lanes, and their number in 128 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Format {
    /// Four lanes of `f32`.
    F32,
    /// Two lanes of `f64`.
    F64,
}

impl Format {
    /// Returns the argument for this format.
    pub(crate) fn pick<T>(self, f32: T, f64: T) -> T {
        match self {
            Self::F32 => f32,
            Self::F64 => f64,
        }
    }
}

/// Returns whether this processor has an instruction that computes a·b + c with one rounding. If
/// so, compiled code uses it, and [`Software::new`](crate::Software::new) returns a machine that
/// rounds in the same way.
#[must_use]
pub fn has_fma() -> bool {
    #[cfg(target_arch = "x86_64")]
    return is_x86_feature_detected!("avx") && is_x86_feature_detected!("fma");
    #[cfg(not(target_arch = "x86_64"))]
    cfg!(target_arch = "aarch64")
}

/// The lane operations of a processor that rounds up.
///
/// One implementation emits native code; the other, [`Software`](crate::Software), computes. Both
/// give the same bits, except for NaN, which no rule returns. Arithmetic rounds to +∞ and keeps
/// subnormals, and only [`Machine::mul_add`] fuses. All operands of a call have the same
/// [`Format`]. A mask is a vector whose lanes are all ones or all zeros. Vectors have 128 bits
/// here. Wider vectors work as well, since every lane is treated alike.
pub trait Machine {
    /// A vector.
    type V: Copy + Send + Sync + 'static;

    /// Returns a vector with `value` in all lanes. `value` must be exact in `format`.
    fn number(&mut self, format: Format, value: f64) -> Self::V;
    /// Returns a vector with `bits` in all lanes. `F32` takes the low 32 bits.
    fn bits(&mut self, format: Format, bits: u64) -> Self::V;

    /// a + b.
    fn add(&mut self, a: Self::V, b: Self::V) -> Self::V;
    /// a − b.
    fn sub(&mut self, a: Self::V, b: Self::V) -> Self::V;
    /// a · b.
    fn mul(&mut self, a: Self::V, b: Self::V) -> Self::V;
    /// a · b + c, rounded once where the processor [can](crate::has_fma), else after each step. If
    /// rounded once, a finite product that overflows is not ∞ before c is added: for c = −∞ the
    /// result is −∞, not NaN. On x86-64 the instruction overwrites a, so a should be a value that
    /// is not used again.
    fn mul_add(&mut self, a: Self::V, b: Self::V, c: Self::V) -> Self::V;
    /// a · b − c, rounded like [`Machine::mul_add`].
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
    /// a where a < b, else b. If either is NaN, the result is b.
    fn min(&mut self, a: Self::V, b: Self::V) -> Self::V;
    /// a where a > b, else b. If either is NaN, the result is b.
    fn max(&mut self, a: Self::V, b: Self::V) -> Self::V;
    /// Largest integer ≤ a.
    fn floor(&mut self, a: Self::V) -> Self::V;
    /// Smallest integer ≥ a.
    fn ceil(&mut self, a: Self::V) -> Self::V;
    /// a rounded toward 0 to an integer.
    fn trunc(&mut self, a: Self::V) -> Self::V;
    /// The integer nearest to a. A number halfway between two integers goes to the even one.
    fn nearest(&mut self, a: Self::V) -> Self::V;

    /// Mask of the lanes where a < b; false for NaN.
    fn lt(&mut self, a: Self::V, b: Self::V) -> Self::V;
    /// Mask of the lanes where a ≤ b; false for NaN.
    fn le(&mut self, a: Self::V, b: Self::V) -> Self::V;
    /// Mask of the lanes where a = b; false for NaN.
    fn eq(&mut self, a: Self::V, b: Self::V) -> Self::V;
    /// Bitwise and.
    fn and(&mut self, a: Self::V, b: Self::V) -> Self::V;
    /// Bitwise or.
    fn or(&mut self, a: Self::V, b: Self::V) -> Self::V;
    /// Bitwise exclusive or.
    fn xor(&mut self, a: Self::V, b: Self::V) -> Self::V;
    /// a where the mask is set, else b.
    fn select(&mut self, mask: Self::V, a: Self::V, b: Self::V) -> Self::V;

    /// a where the sign bit of `sign` is set, else b. So −0 and negative NaN select a.
    fn select_signed(&mut self, sign: Self::V, a: Self::V, b: Self::V) -> Self::V;

    /// a + b of the lanes' bits as integers, wrapping.
    fn int_add(&mut self, a: Self::V, b: Self::V) -> Self::V;
    /// a − b of the lanes' bits as integers, wrapping.
    fn int_sub(&mut self, a: Self::V, b: Self::V) -> Self::V;
    /// The lanes' bits shifted left.
    fn shift_left(&mut self, a: Self::V, by: u8) -> Self::V;
    /// The lanes' bits shifted right, filled with zeros.
    fn shift_right(&mut self, a: Self::V, by: u8) -> Self::V;

    /// Converts all `f32` lanes exactly to two vectors of `f64`, the lower half first.
    fn widen(&mut self, a: Self::V) -> [Self::V; 2];
    /// The inverse of [`Machine::widen`], rounded up.
    fn narrow(&mut self, halves: [Self::V; 2]) -> Self::V;

    /// Applies `routine` to each row of `inputs`, all `F64`. Native code does so in a loop, which
    /// contains the code of `routine` only once. A kernel with nine cosines then compiles in half
    /// the time and runs a sixth faster. Values computed inside `routine` may be used only through
    /// its results.
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
}
