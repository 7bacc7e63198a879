//! Refinement of an isolated root to the tolerance. The signs at the ends of its part stay proven.

use crate::kernel_stats::KernelStats;
use crate::methods::local_ray::{LocalRay, bounds};
use crate::methods::slope::SlopeKernels;
use crate::scalar::Scalar;
use zeroset_interval::Interval;
use zeroset_space::Region;

/// A part of a ray that holds one root, with opposite signs at its ends.
#[derive(Clone, Copy, Debug)]
pub(super) struct Isolated {
    ends: [f64; 2],
    /// Approximate values of the function at the two ends.
    values: [f64; 2],
    is_above: [bool; 2],
    /// A stretch in which the sign is uncertain. The root is likely to lie in it.
    uncertain: Option<[f64; 2]>,
    /// Index of the end that moved last.
    moved: usize,
    /// Length at which the part is short enough.
    enough: f64,
}

/// Maximum number of rounds. Every third round halves the part. So 66 rounds shorten it to 2⁻²² of
/// its first length or less: about the resolution of `f32`.
const ROUNDS: u32 = 66;
/// How far the next place is from the end that moved last, as a multiple of [`Isolated::enough`].
const STEP_BEYOND: f64 = 0.75;

/// Shortens the parts of isolated roots to the tolerance.
pub(super) fn refine<T: Scalar>(
    all: &mut [(&LocalRay, &mut Isolated)],
    slopes: &SlopeKernels<'_, T>,
    region: &Region,
    work: &mut KernelStats,
) {
    for round in 0..ROUNDS {
        let mut left: Vec<_> = all.iter_mut().filter(|(_, isolated)| !isolated.is_done()).collect();
        if left.is_empty() {
            break;
        }
        let places: Vec<f64> = left.iter().map(|(_, isolated)| isolated.next(round)).collect();
        let boxes: Vec<_> = left
            .iter()
            .zip(&places)
            .map(|((local_ray, _), &place)| bounds(local_ray, [place; 2], region))
            .collect();
        let values = slopes.values(&boxes, work);
        for (lane, (_, isolated)) in left.iter_mut().enumerate() {
            isolated.narrow(places[lane], values[lane]);
        }
    }
}

/// Returns the sign of a value: `Some(true)` if it is proven to be above 0, `Some(false)` if it is
/// proven to be below 0.
pub(super) fn sign(value: Interval) -> Option<bool> {
    if value.lo > 0.0 { Some(true) } else { (value.hi < 0.0).then_some(false) }
}

fn middle(value: Interval) -> f64 {
    0.5 * value.lo + 0.5 * value.hi
}

impl Isolated {
    /// Creates a part from bounds of the values at its ends. Their signs must be opposite.
    pub fn new(ends: [f64; 2], values: [Interval; 2], enough: f64) -> Self {
        let is_above = values.map(|value| value.lo > 0.0);
        Self { ends, values: values.map(middle), is_above, uncertain: None, moved: 0, enough }
    }

    pub fn ends(&self) -> [f64; 2] {
        self.ends
    }

    /// Returns the longer of the two parts before and behind the uncertain stretch. If there is no
    /// such stretch, returns the whole part.
    fn longer(&self) -> [f64; 2] {
        let [near, far] = self.ends;
        match self.uncertain {
            None => [near, far],
            Some([first, last]) if first - near >= far - last => [near, first],
            Some([_, last]) => [last, far],
        }
    }

    fn is_done(&self) -> bool {
        let [near, far] = self.longer();
        let middle = 0.5 * (near + far);
        let is_short = self.ends[1] - self.ends[0] <= self.enough;
        // The uncertain stretch does not shrink. So a part with both ends close to it is done, too.
        let is_near = self.uncertain.is_some() && far - near <= 0.125 * self.enough;
        is_short || is_near || !(near < middle && middle < far)
    }

    /// Returns the next place to evaluate. Three kinds alternate: the zero of the line through the
    /// values at the ends, a place a little beyond the end that moved last, so that the other end
    /// comes near, and the middle.
    fn next(&self, round: u32) -> f64 {
        let ([near, far], [a, b]) = (self.ends, self.values);
        let [from, to] = self.longer();
        let middle = 0.5 * (from + to);
        if self.uncertain.is_some() {
            return middle;
        }
        let next = match round % 3 {
            0 => near - a * ((far - near) / (b - a)),
            1 if self.moved == 0 => near + STEP_BEYOND * self.enough,
            1 => far - STEP_BEYOND * self.enough,
            _ => middle,
        };
        if near < next && next < far { next } else { middle }
    }

    /// Moves an end of the bracket to `place` if the sign of `value` there is known. Otherwise
    /// extends the uncertain stretch to `place`.
    fn narrow(&mut self, place: f64, value: Interval) {
        if let Some(is_above) = sign(value) {
            let end = usize::from(is_above != self.is_above[0]);
            (self.ends[end], self.values[end], self.moved) = (place, middle(value), end);
            // An uncertain stretch that reaches beyond the shortened part is dropped.
            let [near, far] = self.ends;
            self.uncertain = self.uncertain.filter(|[first, last]| near <= *first && *last <= far);
        } else {
            let [first, last] = self.uncertain.unwrap_or([place; 2]);
            self.uncertain = Some([first.min(place), last.max(place)]);
        }
    }
}
