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
#[derive(Clone, Copy, Debug)]
struct Bracket {
    ends: [f64; 2],
    values: [f64; 2],
    /// How long it was, and how long it may be.
    length: f64,
    enough: f64,
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
        let lanes: Vec<usize> = (0..parts.len()).filter(|&lane| parts[lane].is_some()).collect();
        if lanes.is_empty() {
            return places;
        }
        let part = |lane: usize| parts[lane].unwrap_or_default();
        let values = [0, 1].map(|end| self.sample(rays, &lanes, |lane| part(lane)[end], work));
        let mut brackets: Vec<(usize, Bracket)> = Vec::with_capacity(LANES);
        for &lane in &lanes {
            let (ends, values) = (part(lane), [values[0][lane], values[1][lane]]);
            if self.is_crossing(values) {
                let ray = &rays[lane];
                // Below what a coordinate is rounded by, signs are those of other points.
                let grain = 2.0 * T::UNIT * size_along(ray, ends);
                let enough = (self.tolerance * ray.footprint(ends[0])).max(grain);
                let bracket = Bracket { ends, values, length: ends[1] - ends[0], enough };
                brackets.push((lane, bracket));
            }
        }
        for round in 0..ROUNDS {
            brackets.retain(|(lane, bracket)| {
                let done = bracket.is_done();
                if done {
                    places[*lane] = Some(bracket.place());
                }
                !done
            });
            if brackets.is_empty() {
                break;
            }
            let lanes: Vec<usize> = brackets.iter().map(|(lane, _)| *lane).collect();
            let mut next = [0.0; LANES];
            for (lane, bracket) in &brackets {
                next[*lane] = bracket.next(round);
            }
            let values = self.sample(rays, &lanes, |lane| next[lane], work);
            for (lane, bracket) in &mut brackets {
                bracket.narrow(next[*lane], values[*lane], self.solid);
            }
        }
        for (lane, bracket) in brackets {
            places[lane] = Some(bracket.place());
        }
        places
    }

    /// Samples on these rays, by lane.
    fn sample(
        &self,
        rays: &[Segment],
        lanes: &[usize],
        at: impl Fn(usize) -> f64,
        work: &mut Work,
    ) -> [f64; LANES] {
        let (mut points, mut values) = (Points::default(), Values::default());
        points.count = lanes.len() as u32;
        for (slot, &lane) in lanes.iter().enumerate() {
            let point = rays[lane].ray.at(at(lane));
            for axis in 0..3 {
                points.at[axis][slot] = T::nearest(point[axis]);
            }
        }
        self.kernel.ask(&points, &mut values);
        work.point.called(points.count);
        let mut by_lane = [0.0; LANES];
        for (slot, &lane) in lanes.iter().enumerate() {
            by_lane[lane] = values.value[slot].into();
        }
        by_lane
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

    /// Where to sample next: ITP (Oliveira and Takahashi 2020, "An Enhancement of the Bisection Method Average Performance
    /// Preserving Minmax Optimality"), with κ₁ = 0.2 over the first length, κ₂ = 2 and n₀ = 1.
    fn next(&self, round: u32) -> f64 {
        let ([near, far], [a, b]) = (self.ends, self.values);
        let (length, middle) = (far - near, 0.5 * (near + far));
        let interpolated = (near * b - far * a) / (b - a);
        // Nothing to interpolate at a pole, or where there is no value.
        if !interpolated.is_finite() {
            return middle;
        }
        let towards = (middle - interpolated).signum();
        let truncation = 0.2 * length * length / self.length;
        let truncated = if truncation <= (middle - interpolated).abs() {
            interpolated + towards * truncation
        } else {
            middle
        };
        // No farther from the middle than halving would be behind.
        let halvings = (self.length / self.enough).log2().ceil().max(0.0) + 1.0;
        let reach = 0.5 * self.enough * (halvings - f64::from(round)).exp2() - 0.5 * length;
        let reach = reach.max(0.0);
        let next =
            if (truncated - middle).abs() <= reach { truncated } else { middle - towards * reach };
        if near < next && next < far { next } else { middle }
    }

    /// Keeps the part before or after a sample.
    fn narrow(&mut self, at: f64, value: f64, solid: bool) {
        let [near, far] = self.values;
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
        let (values, length) = (ends.map(&f), ends[1] - ends[0]);
        let mut bracket = Bracket { ends, values, length, enough: 1e-6 };
        let mut round = 0;
        while !bracket.is_done() {
            let next = bracket.next(round);
            bracket.narrow(next, f(next), solid);
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
