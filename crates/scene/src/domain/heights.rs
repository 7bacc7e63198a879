//! The heights of a graph over a window of its two independent variables, and the range of heights
//! that is shown.
//!
//! All results are sampled, not proven. This module depends neither on surfaces nor on kernels.

/// Returns the heights at places in the plane of the two variables; NaN where undefined.
pub type Heights<'a> = dyn Fn(&[[f64; 2]]) -> Vec<f64> + 'a;

/// A graph sampled over a square around the origin.
pub struct Grid {
    /// Half the side of the square.
    pub half: f64,
    /// Heights at all points of the grid, row by row; NaN where undefined.
    pub sampled: Vec<f64>,
    /// All finite heights, in ascending order.
    sorted: Vec<f64>,
    /// The lowest and the highest height on the border.
    border: [f64; 2],
}

/// Number of points in a row of the grid. The middle one is the origin.
pub const SIDE: usize = 65;

/// Largest ratio of height to width of a window. If the window must be higher to show all maxima
/// and minima, the limit is `TALLEST`.
const TALL: f64 = 1.3;
const TALLEST: f64 = 3.0;

/// The shown heights reach up to this quantile, and down to 1 minus this quantile. `MOST` is for a
/// graph that exceeds its maxima and also falls below its minima, `MOST_ONE_WAY` for a graph that
/// does only one of these.
const MOST: f64 = 0.95;
const MOST_ONE_WAY: f64 = 0.785;

/// The shown range is extended to the lowest or highest height if that height is at most this share
/// of the range away. Heights farther away than `POLE` times the range belong to a pole.
const NEAR_SHARE: f64 = 0.15;
const POLE: f64 = 4.0;

/// The median is compared with the middle between the quantiles 0.5 ± `NEARBY`. That middle
/// replaces the median if they differ by more than `GAP` of the shown height.
const NEARBY: f64 = 0.05;
const GAP: f64 = 0.02;

/// A bowl is shown up to its rim if the rim is farther from the bottom than this share of the shown
/// height.
const RIM: f64 = 0.7;

/// Space above and below a graph, as a share of its height.
const SPACE: f64 = 0.02;

/// Heights that differ by less than this share of their size may be equal up to rounding.
pub const ROUNDING: f64 = 1e-12;

/// Share of the distance between two grid points within which a change counts as abrupt.
pub const AT_ONCE: f64 = 1.0 / 1024.0;

/// The coordinate of a row of the grid.
pub fn place(half: f64, row: usize) -> f64 {
    half * (2.0 * row as f64 / (SIDE - 1) as f64 - 1.0)
}

/// The grid's points, row by row.
pub fn places(half: f64) -> Vec<[f64; 2]> {
    (0..SIDE * SIDE).map(|n| [place(half, n % SIDE), place(half, n / SIDE)]).collect()
}

impl Grid {
    /// Samples the square from `-half` to `half` on both axes.
    pub fn new(heights: &Heights<'_>, half: f64) -> Self {
        let sampled = heights(&places(half));
        let mut sorted: Vec<f64> = sampled.iter().copied().filter(|h| h.is_finite()).collect();
        sorted.sort_unstable_by(f64::total_cmp);
        let on_border =
            |n: &usize| [0, SIDE - 1].contains(&(n % SIDE)) || [0, SIDE - 1].contains(&(n / SIDE));
        let border = ends((0..SIDE * SIDE).filter(on_border).map(|n| sampled[n]));
        Self { half, sampled, sorted, border }
    }

    /// Distance between neighboring grid points.
    pub fn apart(&self) -> f64 {
        2.0 * self.half / (SIDE - 1) as f64
    }

    /// Two heights: `share` of all heights lies below the first, and `share` above the second. NaN
    /// if no height is finite.
    pub fn quantiles(&self, share: f64) -> [f64; 2] {
        let Some(last) = self.sorted.len().checked_sub(1) else { return [f64::NAN; 2] };
        let left_out = (share * last as f64) as usize;
        [self.sorted[left_out], self.sorted[last - left_out]]
    }

    /// The median height. If it lies at the edge of a gap, as between two branches, the middle of
    /// the heights around the gap instead.
    fn middle(&self, height: f64) -> f64 {
        let [median, _] = self.quantiles(0.5);
        let [below, above] = self.quantiles(0.5 - NEARBY);
        let middle = below.midpoint(above);
        let least = (GAP * height).max(ROUNDING * (above - below));
        if (middle - median).abs() > least { middle } else { median }
    }

    /// The lowest and the highest height.
    pub fn ends(&self) -> Option<[f64; 2]> {
        self.sorted.first().zip(self.sorted.last()).map(|(lowest, highest)| [*lowest, *highest])
    }

    /// Returns whether some heights are far above most others, and some far below, as at poles.
    pub fn is_far_out(&self) -> bool {
        let [quarter, rest] = self.quantiles(0.25);
        let far = POLE * (rest - quarter);
        self.ends().is_some_and(|[lowest, highest]| quarter - lowest > far && highest - rest > far)
    }
}

/// The lowest and the highest height of a graph over one axis. Samples beside each row of the grid
/// detect a pole on the row.
pub fn ends_of_ridge(heights: &Heights<'_>, half: f64) -> [f64; 2] {
    let apart = 2.0 * half / (SIDE - 1) as f64;
    let near = [0.0, 1.0 / 32.0, -1.0 / 32.0, AT_ONCE, -AT_ONCE];
    let all = (0..SIDE).flat_map(|row| near.map(|share| place(half, row) + share * apart));
    let places: Vec<[f64; 2]> = all.flat_map(|along| [[along, 0.0], [0.0, along]]).collect();
    ends(heights(&places).into_iter().filter(|height| height.is_finite()))
}

/// The lowest and the highest height; infinite if the list is empty.
fn ends(heights: impl Iterator<Item = f64>) -> [f64; 2] {
    let none = [f64::INFINITY, f64::NEG_INFINITY];
    heights.fold(none, |[low, high], height| [low.min(height), high.max(height)])
}

/// The range of heights that is shown: all maxima and minima in `tops`, and a suitable part of the
/// heights that rise or fall to the border. `None` if there are no heights.
pub fn shown(grid: &Grid, tops: &[f64]) -> Option<[f64; 2]> {
    let Grid { half, sorted, border, .. } = grid;
    let [lowest, highest] = grid.ends()?;
    let quantile = |share: f64| sorted[(share * (sorted.len() - 1) as f64) as usize];
    let [bottom, top] = ends(tops.iter().copied());
    // Whether no height is below the lowest minimum, and whether none is above the highest maximum.
    let (from_below, from_above) = (bottom <= lowest, top >= highest);
    let [mut low, mut high] = match (from_below, from_above) {
        (true, true) => [bottom, top],
        (true, false) => [bottom, quantile(MOST_ONE_WAY).max(top)],
        (false, true) => [quantile(1.0 - MOST_ONE_WAY).min(bottom), top],
        (false, false) => [quantile(1.0 - MOST).min(bottom), quantile(MOST).max(top)],
    };
    let reach = high - low;
    let width = 2.0 * half;
    let has_poles =
        [!from_below && low - lowest > POLE * reach, !from_above && highest - high > POLE * reach];
    if lowest > low - NEAR_SHARE * reach {
        low = low.min(lowest);
    } else if has_poles == [true, false] {
        low = high - width;
    }
    if highest < high + NEAR_SHARE * reach {
        high = high.max(highest);
    } else if has_poles == [false, true] {
        high = low + width;
    }
    let tallest = if top - bottom <= TALLEST * width { top - bottom } else { 0.0 };
    let most = tallest.max(TALL * width);
    if high - low > most {
        match (from_below, from_above) {
            (true, false) => high = low + most,
            (false, true) => low = high - most,
            (true, true) => {
                let middle = low.midpoint(high);
                (low, high) = (middle - most / 2.0, middle + most / 2.0);
            }
            (false, false) => {
                // A range around the middle of the heights, moved to lie within their extremes.
                low = (grid.middle(most) - most / 2.0).min(highest - most).max(lowest);
                high = low + most;
            }
        }
    }
    let space = SPACE * (high - low);
    // A bowl is cut at its rim, so that the part shown is round.
    let is_rim =
        |end: f64, inner: f64| (end - inner).abs() > RIM * (high - low) && low < end && end < high;
    match (from_below, from_above) {
        (true, false) if is_rim(border[0], low) && top <= border[0] => {
            Some([low - space, border[0]])
        }
        (false, true) if is_rim(border[1], high) && bottom >= border[1] => {
            Some([border[1], high + space])
        }
        (true | false, true | false) => Some([low - space, high + space]),
    }
}
