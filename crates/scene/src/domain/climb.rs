//! The local maxima and minima ("tops") of a graph, found by climbing from points of its grid.
//!
//! All results are sampled, not proven. This module depends neither on surfaces nor on kernels.

use super::heights::{Grid, Heights, ROUNDING, SIDE, is_pole, places};

/// A local maximum or minimum of a graph.
#[derive(Clone, Copy, Debug)]
pub struct Extremum {
    /// The place in the plane of the graph's two independent variables.
    pub place: [f64; 2],
    /// The graph's height at the place.
    pub height: f64,
    /// Whether the extremum is isolated. Otherwise it is part of a ridge or a plateau.
    pub is_isolated: bool,
}

/// Least distance of an extremum from the median height, as a share of the largest such distance.
/// Extrema nearer to the median are not visible.
const LEAST_HEIGHT: f64 = 0.02;

/// Largest number of steps in the climb to an extremum. The climb ends when the length of its steps
/// has been halved `HALVINGS` times.
const STEPS: usize = 24;
const HALVINGS: usize = 5;

/// Number of directions tried around an extremum, and the number of times that the interval around
/// the direction of least fall is quartered. On a ridge, the least fall is below `RIDGE` of the
/// steepest.
const DIRECTIONS: usize = 32;
const NARROWED: usize = 5;
const RIDGE: f64 = 1e-3;

/// The visible extrema near inner points of a grid.
pub fn tops(heights: &Heights<'_>, grid: &Grid) -> Vec<Extremum> {
    let Some([low, high]) = grid.ends() else { return Vec::new() };
    let (places, apart) = (places(grid.half), grid.apart());
    let mut tops = Vec::new();
    for (n, sign) in candidates(&grid.sampled) {
        let start = grid.sampled[n];
        let found = climb(heights, places[n], start, sign, apart);
        tops.extend(found.filter(|top| (top.height - start).abs() <= (high - low) / 2.0));
    }
    // Decaying waves have extrema that are too small to be visible.
    let [_, middle] = grid.quantiles(0.5);
    let size = |top: &Extremum| (top.height - middle).abs();
    let most = tops.iter().map(size).fold(0.0, f64::max);
    tops.retain(|top| size(top) >= LEAST_HEIGHT * most);
    tops
}

/// Grid points that may be extrema, with the sign 1 for a maximum and −1 for a minimum. No neighbor
/// is higher than a maximum or lower than a minimum, and some neighbor differs by more than
/// rounding.
fn candidates(heights: &[f64]) -> impl Iterator<Item = (usize, f64)> {
    let inner = |n: &usize| {
        (1..SIDE - 1).contains(&(n % SIDE))
            && (1..SIDE - 1).contains(&(n / SIDE))
            && heights[*n].is_finite()
    };
    (0..SIDE * SIDE).filter(inner).filter(|n| !is_rim(heights, *n)).filter_map(|n| {
        let around = [1, SIDE - 1, SIDE, SIDE + 1].map(|off| [n - off, n + off]);
        let around = around.as_flattened();
        let size =
            around.iter().fold(heights[n].abs(), |most, other| most.max(heights[*other].abs()));
        let differs = |sign: f64| {
            let rises = |other: &usize| sign * (heights[*other] - heights[n]);
            !around.iter().any(|other| rises(other) > 0.0)
                && around.iter().any(|other| rises(other) < -ROUNDING * size)
        };
        [1.0, -1.0].into_iter().find(|sign| differs(*sign)).map(|sign| (n, sign))
    })
}

/// Returns whether an inner grid point lies at the rim of the ground, where heights end but need
/// not have an extremum. The ground does not end at a gap that is one grid point wide.
fn is_rim(heights: &[f64], n: usize) -> bool {
    let at = |x: i64, y: i64| {
        let place = [(n % SIDE) as i64 + x, (n / SIDE) as i64 + y];
        let is_within = place.iter().all(|along| (0..SIDE as i64).contains(along));
        if is_within { heights[(place[1] * SIDE as i64 + place[0]) as usize] } else { f64::NAN }
    };
    let ends =
        |(x, y): (i64, i64)| at(x, y).is_nan() && at(2 * x, 2 * y).is_nan() && !at(-x, -y).is_nan();
    [(1, 0), (0, 1), (1, 1), (1, -1)].into_iter().any(|(x, y)| ends((x, y)) || ends((-x, -y)))
}

/// The extremum that a climb from `start` finds. `None` if the climb goes too far away, takes too
/// many steps, or ends at a pole or in a bent valley. In such a valley, the climb can stop before
/// any extremum: see `is_top`.
fn climb(
    heights: &Heights<'_>,
    start: [f64; 2],
    height: f64,
    sign: f64,
    apart: f64,
) -> Option<Extremum> {
    let ([mut x, mut y], mut height) = (start, height);
    let (mut step, mut halvings) = (apart / 2.0, 0);
    for _ in 0..STEPS {
        let ways = [[-1.0, -1.0], [-1.0, 0.0], [-1.0, 1.0], [0.0, -1.0]];
        let ways = ways.into_iter().flat_map(|[a, b]: [f64; 2]| [[a, b], [-a, -b]]);
        let places: Vec<[f64; 2]> = ways.map(|[a, b]| [x + a * step, y + b * step]).collect();
        let found = heights(&places);
        let finite = (0..places.len()).filter(|n| found[*n].is_finite());
        let best = finite.max_by(|a, b| (sign * found[*a]).total_cmp(&(sign * found[*b])));
        if let Some(best) = best.filter(|best| sign * (found[*best] - height) > 0.0) {
            ([x, y], height) = (places[best], found[best]);
        } else {
            (step, halvings) = (step / 2.0, halvings + 1);
        }
        let way = (x - start[0]).abs().max((y - start[1]).abs());
        if way > 1.5 * apart {
            return None;
        }
        if halvings == HALVINGS {
            let place = [x, y];
            let is_top = is_top(heights, place, apart / 8.0, apart)
                && !is_pole(heights, place, height, apart);
            let is_isolated = || is_isolated(heights, place, height, sign, apart);
            return is_top.then(|| Extremum { place, height, is_isolated: is_isolated() });
        }
    }
    None
}

/// Returns whether the paraboloid through the heights around a place has its top near that place.
/// In a bent valley it does not.
fn is_top(heights: &Heights<'_>, [x, y]: [f64; 2], step: f64, apart: f64) -> bool {
    let places: Vec<[f64; 2]> = (0..9)
        .map(|n: i32| [x + f64::from(n % 3 - 1) * step, y + f64::from(n / 3 - 1) * step])
        .collect();
    let h = heights(&places);
    let (slope_x, slope_y) = ((h[5] - h[3]) / 2.0, (h[7] - h[1]) / 2.0);
    let (bend_x, bend_y) = (h[5] - 2.0 * h[4] + h[3], h[7] - 2.0 * h[4] + h[1]);
    let twist = (h[8] - h[6] - h[2] + h[0]) / 4.0;
    let bend = bend_x * bend_y - twist * twist;
    let way_x = (bend_y * slope_x - twist * slope_y) / bend * step;
    let way_y = (bend_x * slope_y - twist * slope_x) / bend * step;
    // NaN means that the heights have no such paraboloid. Then nothing indicates a valley.
    let way = way_x.abs().max(way_y.abs());
    way.is_nan() || way <= apart
}

/// Returns whether an extremum is higher (or lower) than all places around it. On a ridge, some
/// place on the square around the extremum is about as high.
fn is_isolated(heights: &Heights<'_>, [x, y]: [f64; 2], top: f64, sign: f64, half: f64) -> bool {
    // `along` is a length along the square's sides, each of which is 2 long.
    let on_square = |along: f64| {
        let (side, rest) = ((along.rem_euclid(8.0) / 2.0).floor(), along.rem_euclid(2.0) - 1.0);
        let [a, b] = match side as u32 {
            0 => [1.0, rest],
            1 => [-rest, 1.0],
            2 => [-1.0, -rest],
            _ => [rest, -1.0],
        };
        [x + half * a, y + half * b]
    };
    let below = |places: &[f64]| -> Vec<f64> {
        let found = heights(&places.iter().map(|along| on_square(*along)).collect::<Vec<_>>());
        let below = found.into_iter().map(|height| sign * (top - height));
        below.map(|below| if below.is_finite() { below } else { f64::INFINITY }).collect()
    };
    let least = |below: &[f64]| (0..below.len()).min_by(|a, b| below[*a].total_cmp(&below[*b]));
    let mut places: Vec<f64> =
        (0..DIRECTIONS).map(|k| 8.0 / DIRECTIONS as f64 * k as f64).collect();
    let (mut step, mut known) = (8.0 / DIRECTIONS as f64, below(&places));
    let finite = known.iter().copied().filter(|below| below.is_finite());
    let most = finite.fold(0.0, f64::max);
    for _ in 0..NARROWED {
        let Some(best) = least(&known) else { return true };
        let middle = places[best];
        places = (-4..=4).map(|k| middle + step / 4.0 * f64::from(k)).collect();
        (step, known) = (step / 4.0, below(&places));
    }
    least(&known).is_none_or(|best| known[best] > RIDGE * most)
}
