//! Refinement by samples: finds the place in a part of a ray at which the function changes sign.
//!
//! Samples prove nothing. Refinement moves painted points, but never changes a status.

use crate::kernel_stats::KernelStats;
use crate::options::TraceOptions;
use crate::packet::RayLanes;
use crate::painted::ones;
use crate::scalar::Scalar;
use crate::simd_chunks::parts;
use fearless_simd::{Level as Vectors, prelude::*};
use zeroset_eval::dispatch;
use zeroset_eval::{Kernel, LANES, Lanes, Points, Sample, Values};

/// Maximum number of rounds. That many halvings take a whole ray to the resolution of `f64`. ITP
/// takes at most one round more than halving.
const ROUNDS: u32 = 64;

/// Finds changes of sign in parts of rays.
pub(super) struct Refiner<'a, T: Scalar> {
    pub kernel: &'a dyn Kernel<Sample, T>,
    /// Maximum error of a found place, in pixels.
    pub tolerance: f64,
    /// Whether every change between f < 0 and not f < 0 counts, as at the faces of a solid. Then
    /// poles, jumps and the ends of the domain of definition count, too.
    pub solid: bool,
}

/// Parts of rays: at most one for each of up to [`LANES`] rays.
#[derive(Clone, Debug, Default)]
pub(super) struct RayParts {
    /// Rays that have a part, as bits.
    pub rays: u16,
    /// Per ray, the t of the part's near end, then of its far end.
    pub ends: [Lanes<f64>; 2],
}

impl RayParts {
    /// Sets the part of one ray.
    pub fn set(&mut self, ray: usize, [near, far]: [f64; 2]) {
        self.rays |= 1 << ray;
        (self.ends[0][ray], self.ends[1][ray]) = (near, far);
    }
}

/// Brackets on rays, one per lane. Samples at a bracket's two ends differ in sign.
struct Brackets {
    ends: [Lanes<f64>; 2],
    values: [Lanes<f64>; 2],
    /// The initial length of each bracket.
    length: Lanes<f64>,
    /// The length at which a bracket is short enough.
    enough: Lanes<f64>,
    /// Maximum length of the bracket after this round. It is halved in each round.
    halved: Lanes<f64>,
    /// Place of the next sample.
    next: Lanes<f64>,
}

impl<'a, T: Scalar> Refiner<'a, T> {
    /// Creates a refiner for the surface that `kernel` samples.
    pub fn new(kernel: &'a dyn Kernel<Sample, T>, options: &TraceOptions) -> Self {
        let TraceOptions { tolerance, is_solid, .. } = *options;
        Self { kernel, tolerance, solid: is_solid }
    }

    /// Returns whether the function changes sign between two neighboring samples.
    pub fn is_crossing(&self, [a, b]: [f64; 2]) -> bool {
        if self.solid {
            return (a < 0.0) != (b < 0.0);
        }
        a.is_finite() && b.is_finite() && (a == 0.0 || b == 0.0 || (a < 0.0) != (b < 0.0))
    }

    /// Returns the place in each wanted part at which the function's samples change sign; infinity
    /// if they do not.
    pub fn places(
        &self,
        lines: &RayLanes,
        wanted: &RayParts,
        work: &mut KernelStats,
    ) -> Lanes<f64> {
        let mut places = Lanes::splat(f64::INFINITY);
        if wanted.rays == 0 {
            return places;
        }
        let vectors = Vectors::new();
        let (mut points, mut values) = (Points::default(), Values::default());
        let mut sample = |at: &Lanes<f64>, lanes: u16, work: &mut KernelStats| {
            points.count = LANES as u32 - lanes.leading_zeros();
            dispatch!(vectors, simd => place(simd, lines, at, &mut points));
            self.kernel.eval(&points, &mut values);
            work.point.called(lanes.count_ones());
            Lanes(values.value.map(Into::into))
        };
        let ends = wanted.ends;
        let values = [sample(&ends[0], wanted.rays, work), sample(&ends[1], wanted.rays, work)];
        let is_crossing = |lane: &usize| self.is_crossing([values[0][*lane], values[1][*lane]]);
        let mut live: u16 = ones(wanted.rays).filter(is_crossing).map(|lane| 1 << lane).sum();
        let enough = dispatch!(vectors, simd => enough::<T, _>(simd, lines, self.tolerance, &ends));
        let mut brackets = dispatch!(vectors, simd => Brackets::new(simd, ends, values, enough));
        for round in 0.. {
            let found = dispatch!(vectors, simd => brackets.choose_next(simd, live));
            let done = if round == ROUNDS { live } else { live & found };
            for lane in ones(done) {
                places[lane] = brackets.place(lane);
            }
            live &= !done;
            if live == 0 {
                break;
            }
            let values = sample(&brackets.next, live, work);
            dispatch!(vectors, simd => brackets.narrow(simd, &values, self.solid));
        }
        places
    }
}

/// Writes the points of rays at `at` to a batch.
#[inline(always)]
fn place<S: Simd, T: Scalar>(simd: S, lines: &RayLanes, at: &Lanes<f64>, points: &mut Points<T>) {
    for axis in 0..3 {
        let (origin, direction) = (&lines.origin[axis], &lines.direction[axis]);
        let [mut low, mut high] = f64::wide(simd, direction);
        let [first, second] = f64::wide(simd, at);
        (low, high) = (low * first, high * second);
        let [first, second] = f64::wide(simd, origin);
        T::narrow([first + low, second + high], &mut points.at[axis]);
    }
}

/// Returns, for each bracket, the length at which it is short enough. `near` and `far` are the
/// brackets' initial ends.
#[inline(always)]
fn enough<T: Scalar, S: Simd>(
    simd: S,
    lines: &RayLanes,
    tolerance: f64,
    [near, far]: &[Lanes<f64>; 2],
) -> Lanes<f64> {
    let mut enough = Lanes::splat(0.0);
    for part in parts::<S, S::f64s>(simd, LANES) {
        let (near, far) = (part.load(near), part.load(far));
        let zero = part.splat(0.0);
        let (mut size, mut start, mut way) = (zero, zero, zero);
        for axis in 0..3 {
            let origin = part.load(&lines.origin[axis]);
            let direction = part.load(&lines.direction[axis]);
            let ends = (origin + direction * near).abs().max((origin + direction * far).abs());
            (size, start) = (size.max(ends), start.max(origin.abs()));
            way = way.max(direction.abs());
        }
        // The largest coordinate of either end, as a distance along the ray. Far from the eye, the
        // rounding of t counts, too.
        let size = (size / way).max((start + far.abs()) * f64::EPSILON);
        let [at_eye, growth] = &lines.pixel;
        let growth = part.load(growth);
        let footprint = part.load(at_eye) + near * growth;
        // In a bracket shorter than the rounding of coordinates, samples would not be distinct.
        part.store((footprint * tolerance).max_precise(size * (2.0 * T::UNIT)), &mut enough);
    }
    enough
}

impl Brackets {
    #[inline(always)]
    fn new<S: Simd>(
        simd: S,
        ends: [Lanes<f64>; 2],
        values: [Lanes<f64>; 2],
        enough: Lanes<f64>,
    ) -> Self {
        /// Mask of the fraction bits of an `f64`.
        const FRACTION: u64 = (1 << (f64::MANTISSA_DIGITS - 1)) - 1;
        let (mut length, mut halved) = (Lanes::splat(0.0), Lanes::splat(0.0));
        for part in parts::<S, S::f64s>(simd, LANES) {
            let near = part.load(&ends[0]);
            let far = part.load(&ends[1]);
            let enough = part.load(&enough);
            part.store(far - near, &mut length);
            // `enough` times a power of two: the least such number that is not below the length.
            // Halving takes equally many rounds from there as from the length.
            let times = ((far - near) / enough).max(1.0).min(2_f64.powi(1000));
            let bits: S::u64s = times.bitcast();
            let power: S::f64s = ((bits + FRACTION) & !FRACTION).bitcast();
            part.store(enough * power, &mut halved);
        }
        Self { ends, values, length, enough, halved, next: ends[0] }
    }

    /// Chooses each bracket's next sample by ITP (Oliveira and Takahashi 2020, "An Enhancement of
    /// the Bisection Method Average Performance Preserving Minmax Optimality"). The constants are
    /// κ₁ = 0.2 divided by the initial length, κ₂ = 2 and n₀ = 1. Returns the lanes whose brackets
    /// are finished, as bits. The bits of other than `live` lanes are meaningless.
    #[inline(always)]
    fn choose_next<S: Simd>(&mut self, simd: S, live: u16) -> u16 {
        let mut done = 0;
        for part in parts::<S, S::f64s>(simd, LANES - live.leading_zeros() as usize) {
            let zero = part.splat(0.0);
            let near = part.load(&self.ends[0]);
            let far = part.load(&self.ends[1]);
            let a = part.load(&self.values[0]);
            let b = part.load(&self.values[1]);
            let enough = part.load(&self.enough);
            let first = part.load(&self.length);
            let halved = part.load(&self.halved);
            let (length, middle) = (far - near, (near + far) * 0.5);
            let is_long = length.simd_gt(enough) & near.simd_lt(middle) & middle.simd_lt(far);
            let is_done = a.simd_eq(zero) | b.simd_eq(zero) | !is_long;
            done |= part.bits(is_done);
            // The sample may be this far from the middle without making ITP slower than halving.
            let reach = (halved - length * 0.5).max(0.0);
            part.store(halved * 0.5, &mut self.halved);
            let interpolated = (near * b - far * a) / (b - a);
            let off = middle - interpolated;
            let one = part.splat(1.0);
            let towards = one.copysign(off);
            let truncation = length * 0.2 * length / first;
            let truncated = interpolated + towards * truncation;
            let truncated = truncation.simd_le(off.abs()).select(truncated, middle);
            let is_near = (truncated - middle).abs().simd_le(reach);
            let next = is_near.select(truncated, middle - towards * reach);
            // The middle is taken at a pole or a missing value, where interpolation fails.
            let within = near.simd_lt(next) & next.simd_lt(far) & off.is_finite();
            part.store(within.select(next, middle), &mut self.next);
        }
        done
    }

    /// Divides each bracket at its new sample and keeps the part in which samples change sign.
    #[inline(always)]
    fn narrow<S: Simd>(&mut self, simd: S, values: &Lanes<f64>, solid: bool) {
        for part in parts::<S, S::f64s>(simd, LANES) {
            let zero = part.splat(0.0);
            let a = part.load(&self.values[0]);
            let b = part.load(&self.values[1]);
            let near = part.load(&self.ends[0]);
            let far = part.load(&self.ends[1]);
            let at = part.load(&self.next);
            let value = part.load(values);
            let differ = value.simd_lt(zero) ^ a.simd_lt(zero);
            let is_zero = value.simd_eq(zero) | a.simd_eq(zero);
            let (mut is_near, mut value_there) = (!(differ | is_zero), value);
            if !solid {
                // A sample without a value has no sign. It becomes the far end, with the old far
                // end's value.
                let is_nan = value.is_nan();
                is_near &= !is_nan;
                value_there = is_nan.select(b, value);
            }
            part.store(is_near.select(at, near), &mut self.ends[0]);
            part.store(is_near.select(value, a), &mut self.values[0]);
            part.store(is_near.select(far, at), &mut self.ends[1]);
            part.store(is_near.select(b, value_there), &mut self.values[1]);
        }
    }

    /// Returns the place at which a line through the samples at both ends is 0.
    fn place(&self, lane: usize) -> f64 {
        let [near, far] = self.ends.each_ref().map(|ends| ends[lane]);
        let [a, b] = self.values.each_ref().map(|values| values[lane]);
        let place = near - a * ((far - near) / (b - a));
        if near <= place && place <= far { place } else { 0.5 * (near + far) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use zeroset_testkit::simd::levels;

    /// Refines a bracket with the given `ends`. Returns the number of samples, and the place found.
    fn refine(f: impl Fn(f64) -> f64, ends: [f64; 2], solid: bool) -> (u32, f64) {
        let all = |numbers: [f64; 2]| numbers.map(Lanes::splat);
        let mut brackets = dispatch!(Vectors::new(), simd => {
            Brackets::new(simd, all(ends), all(ends.map(&f)), Lanes::splat(1e-6))
        });
        let mut round = 0;
        while dispatch!(Vectors::new(), simd => brackets.choose_next(simd, u16::MAX)) == 0 {
            let values = Lanes(brackets.next.map(&f));
            dispatch!(Vectors::new(), simd => brackets.narrow(simd, &values, solid));
            round += 1;
        }
        (round, brackets.place(LANES - 1))
    }

    #[test]
    fn places_are_found_in_no_more_rounds_than_halving_takes() {
        let halvings = 20;
        for (f, root) in [
            ((|t| t * t * t - 0.2) as fn(f64) -> f64, 0.2_f64.cbrt()),
            (|t| (t - 0.3).powi(9), 0.3),
            (|t| (40.0 * (t - 0.7)).atan(), 0.7),
            (|t| t - 0.999, 0.999),
        ] {
            let (rounds, place) = refine(f, [0.0, 1.0], false);
            assert!(rounds <= halvings + 2, "{root}: {rounds}");
            assert!((place - root).abs() <= 1e-6, "{root}: {place}");
        }
        assert!(refine(|t| t * t - 0.5, [0.0, 1.0], false).0 < 10);
    }

    #[test]
    fn a_solid_has_places_at_poles_at_jumps_and_where_values_end() {
        for f in [
            (|t| 1.0 / (0.4 - t)) as fn(f64) -> f64,
            |t| if t < 0.4 { 1.0 } else { -1.0 },
            |t| if t < 0.4 { f64::NAN } else { -1.0 },
            |t| if t < 0.4 { -1.0 } else { f64::NAN },
        ] {
            let (rounds, place) = refine(f, [0.0, 1.0], true);
            assert!((place - 0.4).abs() <= 1e-6 && rounds <= 22, "{place}, {rounds}");
        }
    }

    #[test]
    fn each_lane_is_about_its_own_bracket() {
        let root = |lane: usize| 0.05 + 0.06 * lane as f64;
        let value = |lane: usize, t: f64| (t - root(lane)) * (1.0 + t * t);
        let lanes = |f: &dyn Fn(usize) -> f64| Lanes(std::array::from_fn(f));
        for level in levels() {
            let ends = [lanes(&|lane| -0.1 * lane as f64), lanes(&|lane| 1.0 + lane as f64)];
            let values = ends.each_ref().map(|ends| lanes(&|lane| value(lane, ends[lane])));
            let enough = lanes(&|lane| 1e-6 * (1.0 + lane as f64));
            let mut brackets = dispatch!(level, simd => Brackets::new(simd, ends, values, enough));
            let (mut live, mut rounds) = (u16::MAX, 0);
            while live != 0 && rounds < 40 {
                let done = live & dispatch!(level, simd => brackets.choose_next(simd, live));
                for lane in ones(done) {
                    let off = brackets.place(lane) - root(lane);
                    assert!(off.abs() <= enough[lane], "{lane}: {off}");
                }
                live &= !done;
                let values = lanes(&|lane| value(lane, brackets.next[lane]));
                dispatch!(level, simd => brackets.narrow(simd, &values, false));
                rounds += 1;
            }
            assert_eq!(live, 0, "{level:?}");
        }
    }
}
