//! A window on a surface that is bounded in some directions only: it is shown whole in these.
//!
//! The ends of [`bounds`](super::bounds) are proven; the rest of the choice is a heuristic. This
//! module depends neither on cameras nor on pictures.

use super::DEFAULT_HALF;
use super::window::{WindowChooser, few_digits};
use zeroset_space::Cell;

/// A window without a scale of its own is kept if it holds the bounded directions, and if their
/// longest extent is at least this.
const SMALL: f64 = DEFAULT_HALF / 8.0;

/// An extent counts as 0, as for a plane or a line, if it is below this, or below this share of the
/// coordinates.
const LEAST: f64 = 1e-12;
const LEAST_SHARE: f64 = 1e-5;

/// Half the length of the window along an axis on which the surface has no ends, in multiples of
/// the extent across.
const LONG: f64 = 0.8;

/// Space beyond a proven end, as a share of the extent, in which the end is rounded.
const ROOM: f64 = 0.1;

/// A window holds an end that is at most this share of the extent outside of it.
const NEAR_END: f64 = 0.05;

impl WindowChooser<'_> {
    /// Returns whether the surface is proven bounded on both sides along an axis, and has some
    /// extent along it.
    pub(super) fn is_bounded(&self, axis: usize) -> bool {
        let [low, high] = [self.bounds.low[axis], self.bounds.high[axis]];
        let least = LEAST.max(LEAST_SHARE * low.abs().max(high.abs()));
        low.is_finite() && high.is_finite() && high - low > least
    }

    /// The window that shows the surface whole in the directions in which it is bounded, if `plain`
    /// does not. `plain` is the window on the surface's features, and `has_scale` is false for a
    /// surface without features.
    pub(super) fn whole_where_bounded(&self, plain: &Cell, has_scale: bool) -> Option<Cell> {
        let Cell { low, high } = self.bounds;
        let depends = self.shape.depends;
        let extent = |axis: usize| self.bounds.extent(axis);
        let bounded: Vec<usize> = (0..3).filter(|axis| self.is_bounded(*axis)).collect();
        let mut longest = bounded.iter().map(|axis| extent(*axis)).fold(0.0, f64::max);
        let holds = |axis: &usize| {
            let near = NEAR_END * extent(*axis);
            plain.low[*axis] <= low[*axis] + near && high[*axis] - near <= plain.high[*axis]
        };
        if bounded.is_empty() {
            let ends = low.iter().chain(&high).filter(|end| end.is_finite());
            longest = ends.fold(0.0, |most, end| most.max(end.abs()));
            if has_scale || !self.is_solid || longest <= DEFAULT_HALF {
                return None;
            }
        } else if bounded.iter().all(holds)
            && (has_scale || (SMALL..=DEFAULT_HALF).contains(&longest))
        {
            return None;
        }
        let mut window = *plain;
        for axis in 0..3 {
            let ends = [low[axis], high[axis]].map(|end| end.is_finite().then_some(end));
            let room = ROOM * longest;
            let reach = |plain: f64| if has_scale { plain.max(longest) } else { longest };
            (window.low[axis], window.high[axis]) = match ends {
                [Some(low), Some(high)] => {
                    let room = ROOM * extent(axis);
                    (low - room, high + room)
                }
                [Some(low), None] => (low - room, few_digits(low + reach(plain.high[axis] - low))),
                [None, Some(high)] => {
                    (few_digits(high - reach(high - plain.low[axis])), high + room)
                }
                [None, None] if depends[axis] => {
                    let half = match self.shape.period[axis] {
                        Some(period) => (longest / 2.0 / period).ceil() * period,
                        None if has_scale => (plain.extent(axis) / 2.0).max(LONG * longest),
                        None => LONG * longest,
                    };
                    let [low, high] = [-half, half].map(|side| self.centre[axis] + side);
                    (few_digits(low), few_digits(high))
                }
                // The length along this axis is chosen to fit the others.
                [None, None] => (-longest, longest),
            };
        }
        let mut window = self.pruned(window)?;
        for axis in (0..3).filter(|axis| !depends[*axis]) {
            (window.low[axis], window.high[axis]) =
                (few_digits(window.low[axis]), few_digits(window.high[axis]));
        }
        Some(window)
    }
}
