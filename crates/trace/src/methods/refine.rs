//! The usual refinement: where in a part of a ray samples of the function change sign.
//!
//! Samples prove nothing, and neither does this: it moves what is painted, never what is claimed.

use crate::method::{Options, Segment};
use crate::scalar::Scalar;
use crate::work::Work;
use zeroset_eval::{Kernel, LANES, Points, Sample, Values};

/// Rounds, at most: as many as halving a whole ray down to what `f64` can tell needs. More than halving needs at least, ITP
/// takes only one.
const ROUNDS: u32 = 64;

/// Finds places between samples.
pub(super) struct Refiner<'a, T: Scalar> {
    pub kernel: &'a dyn Kernel<Sample, T>,
    /// How far, in pixels, a place may be off.
    pub tolerance: f64,
    /// Whether any change of side counts, as at a solid's faces: into a pole, across a jump, to where there is no value.
    pub solid: bool,
}

/// A part of a ray, and samples at its ends.
#[derive(Clone, Copy, Debug, Default)]
struct Bracket {
    /// Which ray.
    lane: usize,
    ends: [f64; 2],
    values: [f64; 2],
    /// How long it was, and how long it may be.
    length: f64,
    enough: f64,
    /// How long halving, begun one round later, would have left it.
    halved: f64,
    /// Where it is sampled next.
    next: f64,
}

/// What kernels are asked, and what they answer.
#[derive(Default)]
struct Room<T: Scalar> {
    points: Points<T>,
    values: Values<T>,
}

impl<'a, T: Scalar> Refiner<'a, T> {
    /// For a surface whose samples are these.
    pub fn new(kernel: &'a dyn Kernel<Sample, T>, options: &Options) -> Self {
        let Options { tolerance, suppress_asymptotes, .. } = *options;
        Self { kernel, tolerance, solid: !suppress_asymptotes }
    }

    /// Whether the function changes sign between two neighbouring samples.
    pub fn is_crossing(&self, [a, b]: [f64; 2]) -> bool {
        if self.solid {
            return (a < 0.0) != (b < 0.0);
        }
        a.is_finite() && b.is_finite() && (a == 0.0 || b == 0.0 || (a < 0.0) != (b < 0.0))
    }

    /// For up to [`LANES`] rays, the place in a part of each at which samples change sign; `None` where those at its ends
    /// do not.
    pub fn places(
        &self,
        rays: &[Segment],
        parts: &[Option<[f64; 2]>],
        work: &mut Work,
    ) -> [Option<f64>; LANES] {
        let mut places = [None; LANES];
        let (mut brackets, mut count) = ([Bracket::default(); LANES], 0);
        for (lane, part) in parts.iter().enumerate() {
            if let Some(ends) = *part {
                brackets[count] = Bracket { lane, ends, ..Bracket::default() };
                count += 1;
            }
        }
        if count == 0 {
            return places;
        }
        let mut room = Room::default();
        for end in 0..2 {
            let brackets = &mut brackets[..count];
            self.sample(rays, brackets, |bracket| bracket.ends[end], &mut room, work);
            for (bracket, value) in brackets.iter_mut().zip(&room.values.value.0) {
                bracket.values[end] = (*value).into();
            }
        }
        let all = &mut brackets[..count];
        count = 0;
        for k in 0..all.len() {
            let Bracket { lane, ends, values, .. } = all[k];
            if self.is_crossing(values) {
                let ray = &rays[lane];
                // Below what a coordinate is rounded by, signs are those of other points.
                let grain = 2.0 * T::UNIT * size_along(ray, ends);
                let enough = (self.tolerance * ray.footprint(ends[0])).max(grain);
                all[count] = Bracket::new(lane, ends, values, enough);
                count += 1;
            }
        }
        for _ in 0..ROUNDS {
            let all = &mut brackets[..count];
            count = 0;
            for k in 0..all.len() {
                let mut bracket = all[k];
                if bracket.is_done() {
                    places[bracket.lane] = Some(bracket.place());
                } else {
                    bracket.go_on();
                    all[count] = bracket;
                    count += 1;
                }
            }
            if count == 0 {
                break;
            }
            let brackets = &mut brackets[..count];
            self.sample(rays, brackets, |bracket| bracket.next, &mut room, work);
            for (bracket, value) in brackets.iter_mut().zip(&room.values.value.0) {
                bracket.narrow((*value).into(), self.solid);
            }
        }
        for bracket in &brackets[..count] {
            places[bracket.lane] = Some(bracket.place());
        }
        places
    }

    /// Samples on the rays of some brackets, in their order.
    #[inline]
    fn sample(
        &self,
        rays: &[Segment],
        brackets: &[Bracket],
        at: impl Fn(&Bracket) -> f64,
        Room { points, values }: &mut Room<T>,
        work: &mut Work,
    ) {
        points.count = brackets.len() as u32;
        for (slot, bracket) in brackets.iter().enumerate() {
            let point = rays[bracket.lane].ray.at(at(bracket));
            for axis in 0..3 {
                points.at[axis][slot] = T::nearest(point[axis]);
            }
        }
        self.kernel.ask(points, values);
        work.point.called(points.count);
    }
}

/// How large t is at which a ray's coordinates are as large as its largest ones in a part of it.
fn size_along(segment: &Segment, [near, far]: [f64; 2]) -> f64 {
    let (origin, direction) = (segment.ray.origin.abs(), segment.ray.direction.abs());
    let size = segment.ray.at(near).abs().max(segment.ray.at(far).abs()).max_element();
    // Far from the eye t is rounded too.
    (size / direction.max_element()).max(f64::EPSILON * (origin.max_element() + far.abs()))
}

impl Bracket {
    fn new(lane: usize, ends: [f64; 2], values: [f64; 2], enough: f64) -> Self {
        /// The bits of a float behind its point.
        const FRACTION: u64 = (1 << (f64::MANTISSA_DIGITS - 1)) - 1;
        let length = ends[1] - ends[0];
        // `enough` as often doubled as halving takes to come below it: by the next power of two.
        let times = (length / enough).clamp(1.0, 2_f64.powi(1000));
        let halved = enough * f64::from_bits((times.to_bits() + FRACTION) & !FRACTION);
        Self { lane, ends, values, length, enough, halved, next: ends[0] }
    }

    fn is_done(&self) -> bool {
        let [near, far] = self.ends;
        let middle = 0.5 * (near + far);
        self.values.contains(&0.0) || !(far - near > self.enough && near < middle && middle < far)
    }

    /// Where a line through the samples at both ends meets 0, which costs nothing more.
    fn place(&self) -> f64 {
        let ([near, far], [a, b]) = (self.ends, self.values);
        let place = near - a * ((far - near) / (b - a));
        if near <= place && place <= far { place } else { 0.5 * (near + far) }
    }

    /// Finds where to sample next: ITP (Oliveira and Takahashi 2020, "An Enhancement of the Bisection Method Average
    /// Performance Preserving Minmax Optimality"), with κ₁ = 0.2 over the first length, κ₂ = 2 and n₀ = 1.
    fn go_on(&mut self) {
        let ([near, far], [a, b]) = (self.ends, self.values);
        let (length, middle) = (far - near, 0.5 * (near + far));
        // No farther from the middle than halving would be behind.
        let reach = (self.halved - 0.5 * length).max(0.0);
        self.halved *= 0.5;
        self.next = middle;
        let interpolated = (near * b - far * a) / (b - a);
        // Nothing to interpolate at a pole, or where there is no value.
        if !interpolated.is_finite() {
            return;
        }
        let towards = (middle - interpolated).signum();
        let truncation = 0.2 * length * length / self.length;
        let truncated = if truncation <= (middle - interpolated).abs() {
            interpolated + towards * truncation
        } else {
            middle
        };
        let next =
            if (truncated - middle).abs() <= reach { truncated } else { middle - towards * reach };
        if near < next && next < far {
            self.next = next;
        }
    }

    /// Keeps the part before or after the sample that was taken.
    fn narrow(&mut self, value: f64, solid: bool) {
        let ([near, far], at) = (self.values, self.next);
        // What has no value in a bracket with signs is on neither side: it is taken for the far one.
        let is_near = if solid || !value.is_nan() {
            (value < 0.0) == (near < 0.0) && value != 0.0
        } else {
            false
        };
        if is_near && near != 0.0 {
            (self.ends[0], self.values[0]) = (at, value);
        } else {
            let value = if value.is_nan() && !solid { far } else { value };
            (self.ends[1], self.values[1]) = (at, value);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How many samples of a function a part of a ray takes, and where they end.
    fn refine(f: impl Fn(f64) -> f64, ends: [f64; 2], solid: bool) -> (u32, f64) {
        let mut bracket = Bracket::new(0, ends, ends.map(&f), 1e-6);
        let mut round = 0;
        while !bracket.is_done() {
            bracket.go_on();
            bracket.narrow(f(bracket.next), solid);
            round += 1;
        }
        (round, bracket.place())
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
}
