//! Adversarial single numbers.

use super::Rng;
use std::f64::consts::FRAC_PI_2;

/// Whether infinite numbers may be drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ends {
    /// Only finite ones.
    Finite,
    /// Infinite ones too.
    Infinite,
}

/// A number at which something tends to go wrong: ±0, subnormals, ±1, ±`MAX`, integers, half
/// integers, multiples of π/2 and the ends of what `exp` can represent, with their neighbours; and
/// plain numbers of every magnitude. Never NaN; infinite only if `ends` allows it.
pub fn adversarial_f32(rng: &mut Rng, ends: Ends) -> f32 {
    let magnitude = match rng.u32(0..16) {
        0 => 0.0,
        1 => f32::from_bits(rng.u32(1..=4)),
        2 => f32::from_bits(rng.u32(1..1 << 23)),
        3 => nudge(rng, f32::MIN_POSITIVE),
        4 => nudge(rng, 1.0),
        5 => from_exponents(rng, 100, 127),
        6 => [f32::MAX, f32::MAX.next_down(), 1e38][below(rng, 3)],
        7 => {
            let farthest = [4, 16, 1 << 10, 1 << 20, 1 << 30][below(rng, 5)];
            let near = f64::from(rng.u32(1..=farthest)) * FRAC_PI_2;
            nudge(rng, near as f32)
        }
        8 => {
            let integer = rng.u32(0..=12) as f32;
            nudge(rng, integer)
        }
        9 => {
            // About where f32 loses its fractions, and where conversion to i32 overflows.
            let power = [22, 23, 24, 31, 32, 63][below(rng, 6)];
            nudge(rng, 2f32.powi(power))
        }
        10 => {
            let half = rng.u32(0..=12) as f32 + 0.5;
            nudge(rng, half)
        }
        // exp underflows, leaves the normal numbers, or overflows there; source: logarithms of
        // f32::MAX, f32::MIN_POSITIVE and of half the least subnormal.
        11 => {
            let edge = [88.722_84, 87.336_55, 103.972_08][below(rng, 3)];
            nudge(rng, edge)
        }
        12 => from_exponents(rng, -149, 127),
        13 => from_exponents(rng, -20, 20),
        14 if ends == Ends::Infinite => f32::INFINITY,
        _ => uniform(rng) * 4.0,
    };
    if rng.bool() { -magnitude } else { magnitude }
}

/// An index below `count`, drawn alike on every platform.
pub(super) fn below(rng: &mut Rng, count: usize) -> usize {
    rng.u64(0..count as u64) as usize
}

/// Uniform in [0, 1).
pub(super) fn uniform(rng: &mut Rng) -> f32 {
    rng.u32(0..1 << 24) as f32 / (1 << 24) as f32
}

/// Uniform in [0, 1), with 53 bits.
pub(super) fn uniform_f64(rng: &mut Rng) -> f64 {
    rng.u64(0..1 << 53) as f64 / (1_u64 << 53) as f64
}

/// Log-uniform between two powers of two.
pub(super) fn from_exponents(rng: &mut Rng, least: i32, most: i32) -> f32 {
    let scale = 2f64.powi(rng.i32(least..=most));
    let value = scale * (1.0 + uniform_f64(rng));
    (value as f32).min(f32::MAX)
}

/// `value` or a number up to two units in the last place away, if that is finite.
pub(super) fn nudge(rng: &mut Rng, value: f32) -> f32 {
    let moved = match rng.u32(0..6) {
        0 => value.next_up(),
        1 => value.next_down(),
        2 => value.next_up().next_up(),
        3 => value.next_down().next_down(),
        _ => value,
    };
    if moved.is_finite() { moved } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_kinds_of_numbers_are_drawn() {
        let seed = 0x5eed_0010;
        let mut rng = Rng::with_seed(seed);
        let draws: Vec<f32> =
            (0..20_000).map(|_| adversarial_f32(&mut rng, Ends::Finite)).collect();
        assert!(draws.iter().all(|x| x.is_finite()), "seed {seed:#x}");
        let is_drawn = |test: &dyn Fn(f32) -> bool| draws.iter().any(|&x| test(x));
        assert!(is_drawn(&|x| x.to_bits() == 0));
        assert!(is_drawn(&|x| x.to_bits() == 1 << 31));
        assert!(is_drawn(&|x| x == f32::from_bits(1)));
        assert!(is_drawn(&|x| x.is_subnormal() && x.abs() > 1e-39));
        for exact in [f32::MIN_POSITIVE, 1.0, f32::MAX, 0.5, 8_388_608.0, 3.0] {
            assert!(is_drawn(&|x| x == exact), "{exact}");
            assert!(is_drawn(&|x| x == -exact), "{}", -exact);
            assert!(is_drawn(&|x| x == exact.next_down()), "below {exact}");
        }
        let pi = std::f32::consts::PI;
        assert!(is_drawn(&|x| x == pi) && is_drawn(&|x| x == pi.next_up()));
        let mut rng = Rng::with_seed(seed);
        let infinite = (0..200).any(|_| adversarial_f32(&mut rng, Ends::Infinite).is_infinite());
        assert!(infinite);
    }

    /// Pins the stream: a changed generator changes what every seed means.
    #[test]
    fn a_seed_always_means_the_same() {
        let mut rng = Rng::with_seed(1);
        let sum = (0..1000).fold(0_u64, |sum, _| {
            let bits = adversarial_f32(&mut rng, Ends::Finite).to_bits();
            sum.rotate_left(5) ^ u64::from(bits)
        });
        assert_eq!(sum, 0x7043_78e4_f89c_645c, "{sum:#x}");
    }
}
