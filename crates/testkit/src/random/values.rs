//! Random adversarial numbers.

use super::Rng;
use std::f64::consts::FRAC_PI_2;
use zeroset_eval::Real;

/// Whether infinite numbers may be drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ends {
    /// Only finite numbers.
    Finite,
    /// Infinite numbers too.
    Infinite,
}

/// A float type with a generator of adversarial numbers.
pub trait Adversarial: Real {
    /// Returns a number at which code tends to fail: ±0, subnormals, ±1, ±`MAX`, integers, half
    /// integers, multiples of π/2 or the ends of the range of `exp`, and neighbors of these. Other
    /// numbers of every magnitude are drawn too. Never NaN; infinite only if `ends` allows it.
    fn adversarial(rng: &mut Rng, ends: Ends) -> Self;
    /// Returns a number uniform in [0, 1), with as many bits as the format has.
    fn uniform(rng: &mut Rng) -> Self;
    /// Returns the next greater float.
    #[must_use]
    fn next_up(self) -> Self;
    /// Returns the next smaller float.
    #[must_use]
    fn next_down(self) -> Self;
}

/// Implements [`Adversarial`] for a float type, given the type's critical numbers.
macro_rules! adversarial {
    ($type:ty, $bits:ident, $mantissa:expr, $exponents:expr, $huge:expr, $edges:expr) => {
        impl Adversarial for $type {
            fn adversarial(rng: &mut Rng, ends: Ends) -> Self {
                let [least, most] = $exponents;
                let magnitude = match rng.u32(0..16) {
                    0 => 0.0,
                    1 => Self::from_bits(rng.$bits(1..=4)),
                    2 => Self::from_bits(rng.$bits(1..1 << $mantissa)),
                    3 => nudge(rng, Self::MIN_POSITIVE),
                    4 => nudge(rng, 1.0),
                    5 => from_exponents(rng, most - 27, most),
                    6 => [Self::MAX, Self::MAX.next_down(), $huge][below(rng, 3)],
                    7 => {
                        let farthest = [4, 16, 1 << 10, 1 << 20, 1 << 30][below(rng, 5)];
                        let near = f64::from(rng.u32(1..=farthest)) * FRAC_PI_2;
                        nudge(rng, Self::nearest(near))
                    }
                    8 => {
                        let integer = rng.u32(0..=12);
                        nudge(rng, Self::nearest(f64::from(integer)))
                    }
                    9 => {
                        // Near these powers of 2, floats lose fractions, or integers overflow.
                        let power = [$mantissa - 1, $mantissa, $mantissa + 1, 31, 32, 63];
                        let power = power[below(rng, 6)];
                        nudge(rng, Self::nearest(2f64.powi(power)))
                    }
                    10 => {
                        let half = f64::from(rng.u32(0..=12)) + 0.5;
                        nudge(rng, Self::nearest(half))
                    }
                    // At these numbers exp overflows, falls below the normal numbers, or underflows
                    // to 0. Source: logarithms of MAX, MIN_POSITIVE and half the least subnormal.
                    11 => {
                        let edge = $edges[below(rng, 3)];
                        nudge(rng, edge)
                    }
                    12 => from_exponents(rng, least, most),
                    13 => from_exponents(rng, -20, 20),
                    14 if ends == Ends::Infinite => Self::INFINITY,
                    _ => Self::uniform(rng) * 4.0,
                };
                if rng.bool() { -magnitude } else { magnitude }
            }
            fn uniform(rng: &mut Rng) -> Self {
                let bits = $mantissa + 1;
                rng.$bits(0..1 << bits) as Self / (1_u64 << bits) as Self
            }
            fn next_up(self) -> Self {
                self.next_up()
            }
            fn next_down(self) -> Self {
                self.next_down()
            }
        }
    };
}

adversarial!(f32, u32, 23, [-149, 127], 1e38, [88.722_84, 87.336_55, 103.972_08]);
adversarial!(
    f64,
    u64,
    52,
    [-1074, 1023],
    1e300,
    [709.782_712_893_384, 708.396_418_532_264_1, 745.133_219_101_941_1]
);

/// Returns an index below `count`, the same on every platform.
pub(super) fn below(rng: &mut Rng, count: usize) -> usize {
    rng.u64(0..count as u64) as usize
}

/// Returns a number uniform in [0, 1), with 53 bits.
pub(super) fn uniform_f64(rng: &mut Rng) -> f64 {
    rng.u64(0..1 << 53) as f64 / (1_u64 << 53) as f64
}

/// Returns a number that is log-uniform between two powers of two.
pub(super) fn from_exponents<T: Real>(rng: &mut Rng, least: i32, most: i32) -> T {
    let scale = 2f64.powi(rng.i32(least..=most));
    let value = scale * (1.0 + uniform_f64(rng));
    T::nearest(value.min(T::LARGEST.into()))
}

/// Returns `value` or a float up to two steps away. Returns `value` if that float is infinite.
pub(super) fn nudge<T: Adversarial>(rng: &mut Rng, value: T) -> T {
    let moved = match rng.u32(0..6) {
        0 => value.next_up(),
        1 => value.next_down(),
        2 => value.next_up().next_up(),
        3 => value.next_down().next_down(),
        _ => value,
    };
    if moved.into().is_finite() { moved } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_kinds_of_numbers_are_drawn() {
        all_kinds_are_drawn::<f32>(f64::from(f32::from_bits(1)), 1e-39);
        all_kinds_are_drawn::<f64>(f64::from_bits(1), 1e-310);
    }

    fn all_kinds_are_drawn<T: Adversarial>(least: f64, subnormal: f64) {
        let seed = 0x5eed_0010;
        let mut rng = Rng::with_seed(seed);
        let mut draw = |ends| T::adversarial(&mut rng, ends);
        let draws: Vec<T> = (0..20_000).map(|_| draw(Ends::Finite)).collect();
        assert!(draws.iter().all(|&x| x.into().is_finite()), "seed {seed:#x}");
        let is_drawn = |test: &dyn Fn(f64) -> bool| draws.iter().any(|&x| test(x.into()));
        assert!(is_drawn(&|x| x.to_bits() == 0));
        assert!(is_drawn(&|x| x.to_bits() == 1 << 63));
        assert!(is_drawn(&|x| x == least));
        assert!(is_drawn(&|x| x.abs() > subnormal && x.abs() < 4.0 * subnormal));
        let pi = T::nearest(std::f64::consts::PI);
        for exact in [T::LARGEST, T::nearest(1.0), T::nearest(0.5), T::nearest(3.0), pi] {
            let number = |x: T| x.into();
            assert!(is_drawn(&|x| x == number(exact)), "{exact:?}");
            assert!(is_drawn(&|x| x == number(-exact)), "{:?}", -exact);
            assert!(is_drawn(&|x| x == number(exact.next_down())), "below {exact:?}");
        }
        assert!((0..200).any(|_| draw(Ends::Infinite).into().is_infinite()));
    }

    /// Detects a change of the generator, which would change the meaning of every seed.
    #[test]
    fn a_seed_always_means_the_same() {
        let mut rng = Rng::with_seed(1);
        let sum = (0..1000).fold(0_u64, |sum, _| {
            let bits = f32::adversarial(&mut rng, Ends::Finite).to_bits();
            sum.rotate_left(5) ^ u64::from(bits)
        });
        assert_eq!(sum, 0x7043_78e4_f89c_645c, "{sum:#x}");
    }
}
