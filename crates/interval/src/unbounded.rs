//! The tightest products and quotients of intervals, even for infinite ends and divisors with 0.
//!
//! Kernels guard against 0·∞ with few instructions, so they are this tight only for finite
//! operands.

use crate::bounds::Interval;
use crate::round::f64_up;

/// Encloses a·b. The product of 0 and an infinite end is 0.
pub(crate) fn product(a: Interval, b: Interval) -> Interval {
    let largest = |[a_lo, a_hi]: [f64; 2]| {
        let times = |x: f64, y: f64| if x == 0.0 || y == 0.0 { 0.0 } else { f64_up::mul(x, y) };
        let at = |x: f64| times(x, b.lo).max(times(x, b.hi));
        at(a_lo).max(at(a_hi))
    };
    Interval { lo: 0.0 - largest([-a.lo, -a.hi]), hi: 0.0 + largest([a.lo, a.hi]) }
}

/// Encloses a/b for all divisors in b but 0. For b = [0, 0] the bounds have no meaning.
pub(crate) fn quotient(a: Interval, b: Interval) -> Interval {
    if a == Interval::ZERO {
        return a;
    }
    if b.lo < 0.0 && b.hi > 0.0 {
        return Interval::ENTIRE;
    }
    if b.lo < 0.0 {
        let negated = |a: Interval| Interval { lo: -a.hi, hi: -a.lo };
        return quotient(negated(a), negated(b));
    }
    // The divisor for the largest bound is b.lo if the bound is positive, b.hi if it is negative.
    let bound = |end: f64| match end {
        0.0 => 0.0,
        end if end < 0.0 => f64_up::div(end, b.hi),
        _ if b.lo == 0.0 => f64::INFINITY,
        end => f64_up::div(end, b.lo),
    };
    Interval { lo: 0.0 - bound(-a.lo), hi: 0.0 + bound(a.hi) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ENDS: [f64; 9] =
        [f64::NEG_INFINITY, -3.0, -1.0, -0.25, 0.0, 0.5, 1.0, 7.0, f64::INFINITY];
    /// A finite substitute for infinite ends. Its reciprocal stands for the numbers next to 0.
    const HUGE: f64 = 1e100;

    fn intervals() -> Vec<Interval> {
        ENDS.iter().flat_map(|lo| ENDS.iter().filter_map(|hi| Interval::new(*lo, *hi))).collect()
    }

    /// Numbers of the interval at which a product or quotient comes near its extremes.
    fn members(a: Interval) -> Vec<f64> {
        let candidates = ENDS.map(|end| end.clamp(-HUGE, HUGE));
        let near = [-1.0 / HUGE, 1.0 / HUGE];
        candidates.into_iter().chain(near).filter(|x| a.contains(*x)).collect()
    }

    /// Checks that bounds contain all samples, and that each end is close to a sample. An end may
    /// be infinite if samples are huge.
    fn check(of: fn(Interval, Interval) -> Interval, f: fn(f64, f64) -> f64) {
        for a in intervals() {
            for b in intervals() {
                let values: Vec<f64> = members(a)
                    .into_iter()
                    .flat_map(|x| members(b).into_iter().map(move |y| f(x, y)))
                    .filter(|value| value.is_finite())
                    .collect();
                if values.is_empty() {
                    continue; // a divisor of 0
                }
                let bounds = of(a, b);
                let least = values.iter().copied().fold(f64::INFINITY, f64::min);
                let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                let is_tight = |bound: f64, sample: f64| {
                    let reached = (bound - sample).abs() <= 1e-15 * sample.abs() + 1e-90;
                    if bound.is_infinite() { sample.abs() > 1e90 } else { reached }
                };
                let slack = 1e-15;
                assert!(
                    bounds.lo <= least + slack * least.abs()
                        && most - slack * most.abs() <= bounds.hi
                        && is_tight(bounds.lo, least)
                        && is_tight(bounds.hi, most),
                    "{a:?} and {b:?}: {bounds:?}, but from {least:e} to {most:e}"
                );
            }
        }
    }

    #[test]
    fn products_are_tightest() {
        check(product, |x, y| x * y);
    }

    #[test]
    fn quotients_are_tightest() {
        check(quotient, |x, y| x / y);
    }
}
