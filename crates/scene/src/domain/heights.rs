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
    /// Heights at all points of the grid, row by row; NaN where undefined. At a pole, a height
    /// beside it.
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
/// Largest ratio of height to width for a graph that is shown whole because its heights are proven
/// to be bounded.
const TALLEST_WHOLE: f64 = 12.0;

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

/// Share of the heights that is left out toward a pole of a stretched graph.
const FAR_OUT: f64 = 0.1;

/// A part of the heights is little if it has less than this share of all.
const LITTLE: f64 = 0.4;

/// Space above and below a graph, as a share of its height.
const SPACE: f64 = 0.02;

/// Heights that differ by less than this share of their size may be equal up to rounding.
pub const ROUNDING: f64 = 1e-12;

/// Directions in which a pole's height is compared with others. Half of them lie along axes and
/// diagonals, as lines of poles often do.
#[rustfmt::skip]
const AROUND: [[f64; 2]; 16] = [
    [1.0, 0.0], [1.0, 0.37], [1.0, 1.0], [0.37, 1.0],
    [0.0, 1.0], [-0.37, 1.0], [-1.0, 1.0], [-1.0, 0.37],
    [-1.0, 0.0], [-1.0, -0.37], [-1.0, -1.0], [-0.37, -1.0],
    [0.0, -1.0], [0.37, -1.0], [1.0, -1.0], [1.0, -0.37],
];

/// Distance from a pole to the place beside it, as a share of the distance between grid points.
const BESIDE: f64 = 0.37;

/// A height that rounding left at a pole is at least this many times as large as the heights around
/// it.
const ABRUPT: f64 = 100.0;

/// Share of the distance between two grid points within which a change counts as abrupt.
pub const AT_ONCE: f64 = 1.0 / 1024.0;

/// The coordinate of a row of the grid.
pub fn place(half: f64, row: usize) -> f64 {
    half * (2.0 * row as f64 / (SIDE - 1) as f64 - 1.0)
}

/// Distance between neighboring points of the grid.
fn apart(half: f64) -> f64 {
    2.0 * half / (SIDE - 1) as f64
}

/// The grid's points, row by row.
pub fn places(half: f64) -> Vec<[f64; 2]> {
    (0..SIDE * SIDE).map(|n| [place(half, n % SIDE), place(half, n / SIDE)]).collect()
}

impl Grid {
    /// Samples the square from `-half` to `half` on both axes.
    pub fn new(heights: &Heights<'_>, half: f64) -> Self {
        let (places, apart) = (places(half), apart(half));
        let mut sampled = heights(&places);
        let is_at_pole = |n: usize, height| is_pole(heights, places[n], height, apart);
        let mut sorted = ascending(&sampled);
        // Where rounding leaves a height at one pole, it may do so at many. The grid has heights
        // beside these poles instead.
        let extremes = [sorted.first(), sorted.last()];
        let extremes = extremes.map(|end| sampled.iter().position(|height| Some(height) == end));
        if extremes.into_iter().flatten().any(|n| is_at_pole(n, sampled[n])) {
            let beside = |n: usize| {
                let ([x, y], off) = (places[n], BESIDE * apart);
                let found = heights(&[[x + off, y], [x, y + off]]);
                found.into_iter().find(|height| height.is_finite()).unwrap_or(f64::NAN)
            };
            let at_poles = (0..sampled.len()).filter(|n| is_at_pole(*n, sampled[*n]));
            for n in at_poles.collect::<Vec<_>>() {
                sampled[n] = beside(n);
            }
            sorted = ascending(&sampled);
        }
        let on_border =
            |n: &usize| [0, SIDE - 1].contains(&(n % SIDE)) || [0, SIDE - 1].contains(&(n / SIDE));
        let border = ends((0..SIDE * SIDE).filter(on_border).map(|n| sampled[n]));
        Self { half, sampled, sorted, border }
    }

    /// Distance between neighboring grid points.
    pub fn apart(&self) -> f64 {
        apart(self.half)
    }

    /// Whether the lowest and the highest of these heights lie at a pole, or beside one: a place
    /// toward which the heights fall or rise without bound.
    fn has_pole(&self, heights: &Heights<'_>) -> [bool; 2] {
        let Self { half, sampled, sorted, .. } = self;
        let apart = self.apart();
        [(sorted.first(), -1.0), (sorted.last(), 1.0)].map(|(end, sign)| {
            let n = sampled.iter().position(|height| Some(height) == end);
            n.is_some_and(|n| {
                let at = [place(*half, n % SIDE), place(*half, n / SIDE)];
                let (at, height) = climbed(heights, at, sampled[n], sign, apart / 2.0);
                is_pole(heights, at, height, apart) || is_beside_pole(heights, *half, sampled, n)
            })
        })
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

    /// Returns whether few of the finite heights lie between these.
    pub fn is_little(&self, [low, high]: [f64; 2]) -> bool {
        let count = |end: f64| self.sorted.partition_point(|height| *height < end);
        let between = count(high) - count(low).min(count(high));
        (between as f64) < LITTLE * self.sorted.len() as f64
    }

    /// Returns whether some heights are far above most others, and some far below, as at poles.
    pub fn is_far_out(&self) -> bool {
        let [quarter, rest] = self.quantiles(0.25);
        let far = POLE * (rest - quarter);
        self.ends().is_some_and(|[lowest, highest]| quarter - lowest > far && highest - rest > far)
    }
}

/// The finite heights in ascending order.
fn ascending(heights: &[f64]) -> Vec<f64> {
    let mut sorted: Vec<f64> = heights.iter().copied().filter(|h| h.is_finite()).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    sorted
}

/// Returns whether the grid's `n`th point, which has an extreme height, lies beside a place without
/// a height, toward which heights change as a logarithm or faster: the change does not shrink when
/// the distance does.
fn is_beside_pole(heights: &Heights<'_>, half: f64, sampled: &[f64], n: usize) -> bool {
    let at = |n: usize| [place(half, n % SIDE), place(half, n / SIDE)];
    let (row, column) = (n / SIDE, n % SIDE);
    let beside = [
        (column > 0).then(|| n - 1),
        (column + 1 < SIDE).then_some(n + 1),
        (row > 0).then(|| n - SIDE),
        (row + 1 < SIDE).then_some(n + SIDE),
    ];
    let here = at(n);
    beside.into_iter().flatten().filter(|n| !sampled[*n].is_finite()).any(|gap| {
        let way = [0, 1].map(|axis| at(gap)[axis] - here[axis]);
        let height = |share: f64| heights(&[[0, 1].map(|axis| here[axis] + share * way[axis])])[0];
        // The place at which heights end.
        let (mut ground, mut beyond) = (0.0, 1.0);
        for _ in 0..EDGE_HALVINGS {
            let middle = f64::midpoint(ground, beyond);
            if height(middle).is_finite() { ground = middle } else { beyond = middle }
        }
        let [first, second, third] =
            [1.0, 1.0 / 16.0, 1.0 / 256.0].map(|left| height(ground * (1.0 - left)));
        let [change, further] = [second - first, third - second];
        change * further > 0.0 && further.abs() >= LOGARITHM * change.abs()
    })
}

/// The place and the height at the end of a climb from a place, or of a descent if `sign` is −1.
/// The first step has the length `step`. Each further step is half as long.
fn climbed(
    heights: &Heights<'_>,
    [mut x, mut y]: [f64; 2],
    mut height: f64,
    sign: f64,
    mut step: f64,
) -> ([f64; 2], f64) {
    for _ in 0..HALVINGS {
        let around = [(-1.0, 0.0), (1.0, 0.0), (0.0, -1.0), (0.0, 1.0)];
        let around = around.map(|(a, b): (f64, f64)| [x + a * step, y + b * step]);
        let found = around.into_iter().zip(heights(&around));
        let higher = found.filter(|(_, other)| other.is_finite() && sign * (other - height) > 0.0);
        let best = higher.max_by(|(_, a), (_, b)| (sign * a).total_cmp(&(sign * b)));
        if let Some((place, other)) = best {
            ([x, y], height) = (place, other);
        }
        step /= 2.0;
    }
    ([x, y], height)
}

/// Returns whether a place is a pole at which rounding left a finite height. Such a height is far
/// larger than most heights around it, at two distances from the place. `apart` is the distance
/// between grid points.
pub fn is_pole(heights: &Heights<'_>, [x, y]: [f64; 2], height: f64, apart: f64) -> bool {
    [AT_ONCE, AT_ONCE / 32.0].into_iter().all(|share| {
        let far = share * apart;
        let found = heights(&AROUND.map(|[a, b]| [x + a * far, y + b * far]));
        let finite = found.iter().filter(|other| other.is_finite()).count();
        let lower = found.iter().filter(|other| other.abs() * ABRUPT < height.abs()).count();
        // A quarter may be as high, as along two lines of poles that cross.
        lower > 0 && 4 * lower >= 3 * finite
    })
}

/// Number of steps of a climb toward a pole.
const HALVINGS: usize = 32;

/// Number of halvings that locate the edge of the ground beside an extreme height.
const EDGE_HALVINGS: u32 = 40;

/// Toward a pole, the change of the heights shrinks at most to this share when the distance shrinks
/// to a sixteenth. The change of a root shrinks to a quarter.
const LOGARITHM: f64 = 0.7;

/// The lowest and the highest height; infinite if the list is empty.
fn ends(heights: impl Iterator<Item = f64>) -> [f64; 2] {
    let none = [f64::INFINITY, f64::NEG_INFINITY];
    heights.fold(none, |[low, high], height| [low.min(height), high.max(height)])
}

/// The range of heights that is shown.
#[derive(Clone, Copy, Debug)]
pub struct ShownHeights {
    /// The lowest and the highest shown height.
    pub ends: [f64; 2],
    /// Whether the graph continues below the lowest and above the highest shown height.
    pub is_cut: [bool; 2],
}

/// The range of `heights` that is shown: all heights over the ground if the graph is not too tall,
/// otherwise all maxima and minima in `tops` and a suitable part of the rest. `further` are heights
/// between those of the grid, and all heights lie within `proven`. If `is_stretched`, and that part
/// would show little of a graph, all heights are shown, or most of them toward a pole. `None` if
/// there are no heights.
pub fn choose_heights(
    heights: &Heights<'_>,
    grid: &Grid,
    tops: &[f64],
    further: &[f64],
    proven: [f64; 2],
    is_stretched: bool,
) -> Option<ShownHeights> {
    let more = tops.iter().chain(further).copied().filter(|height| height.is_finite());
    let [lowest, highest] = ends(grid.ends()?.into_iter().chain(more));
    let some = || {
        let has_pole = grid.has_pole(heights);
        let ends = part(grid, tops, has_pole)?;
        let most = grid.quantiles(FAR_OUT);
        let end = |side: usize| if has_pole[side] { most } else { [lowest, highest] }[side];
        let is_little = is_stretched && grid.is_little(ends);
        let all = is_little.then(|| whole(f64::INFINITY, [end(0), end(1)], proven));
        all.flatten().or(Some(ends))
    };
    let ends = whole(grid.half, [lowest, highest], proven).or_else(some)?;
    let grain = ROUNDING * (ends[1] - ends[0]);
    let is_cut = [lowest < ends[0] - grain, highest > ends[1] + grain];
    Some(ShownHeights { ends, is_cut })
}

/// The range of all heights, if it is not too tall for a window of half side `half`.
fn whole(half: f64, sampled: [f64; 2], proven: [f64; 2]) -> Option<[f64; 2]> {
    let reach = sampled[1] - sampled[0];
    let is_bounded = proven.iter().all(|end| end.is_finite());
    let tallest = if is_bounded { TALLEST_WHOLE } else { TALL };
    if !(0.0 < reach && reach <= tallest * 2.0 * half) {
        return None;
    }
    // A level that the heights nearly reach is shown, too.
    let level = |k: usize| {
        let is_near = (proven[k] - sampled[k]).abs() <= NEAR_SHARE * reach;
        if is_near { proven[k] } else { sampled[k] }
    };
    let [low, high] = [level(0), level(1)];
    let space = SPACE * (high - low);
    Some([low - space, high + space])
}

/// A suitable range of heights for a graph that is too tall: all maxima and minima in `tops`, and
/// a part of the heights that rise or fall to the border.
fn part(grid: &Grid, tops: &[f64], has_pole: [bool; 2]) -> Option<[f64; 2]> {
    let Grid { half, sorted, border, .. } = grid;
    let [lowest, highest] = grid.ends()?;
    // As many heights are left out above as below.
    let left_out = |share: f64| ((1.0 - share) * (sorted.len() - 1) as f64) as usize;
    let highest_but = |share: f64| sorted[sorted.len() - 1 - left_out(share)];
    let lowest_but = |share: f64| sorted[left_out(share)];
    let [bottom, top] = ends(tops.iter().copied());
    // Whether no height is below the lowest minimum, and whether none is above the highest maximum.
    let (from_below, from_above) = (bottom <= lowest, top >= highest);
    let [mut low, mut high] = match (from_below, from_above) {
        (true, true) => [bottom, top],
        (true, false) => [bottom, highest_but(MOST_ONE_WAY).max(top)],
        (false, true) => [lowest_but(MOST_ONE_WAY).min(bottom), top],
        (false, false) => [lowest_but(MOST).min(bottom), highest_but(MOST).max(top)],
    };
    let reach = high - low;
    let width = 2.0 * half;
    let has_poles = [
        !from_below && (low - lowest > POLE * reach || has_pole[0]),
        !from_above && (highest - high > POLE * reach || has_pole[1]),
    ];
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
