//! The heights of a graph over a window on the ground: its tops and bottoms, and how much of them is fit to be seen.
//!
//! All of it is sampled. Knows neither surfaces nor kernels.

/// Heights at places of the ground; not a number where there are none.
pub type Heights<'a> = dyn Fn(&[[f64; 2]]) -> Vec<f64> + 'a;

/// A graph over a square around the origin.
pub struct Grid {
    half: f64,
    /// Heights at the grid's points that exist, in ascending order.
    sorted: Vec<f64>,
    /// The lowest and the highest point of the border.
    border: [f64; 2],
    /// Places that are higher than all around, or lower, and how high: the border apart.
    pub tops: Vec<(f64, f64, f64)>,
}

/// Points in a row of the grid; one of them is the origin.
const SIDE: usize = 65;

/// A graph is at most so many times higher than wide; if it is its tops that are high, so many times.
const TALL: f64 = 1.3;
const TALLEST: f64 = 3.0;

/// Of heights that grow to the border this share is shown; of what grows one way only, that.
const MOST: f64 = 0.95;
const MOST_ONE_WAY: f64 = 0.785;

/// What is left out is shown too if it is no more than this share of what is shown; if it is this many times as much, it is a
/// pole.
const NEARLY: f64 = 0.15;
const POLE: f64 = 4.0;

/// A bowl is shown to its rim if that is at least this share of what is shown.
const RIM: f64 = 0.7;

/// Space above and below a graph, as a share of its height.
const SPACE: f64 = 0.02;

/// Heights that differ by less than this share of them may be the same but for rounding, as where little is added to much.
const ROUNDING: f64 = 1e-12;

/// A top that is less than this share of the largest one high is not seen.
const SEEN: f64 = 0.02;

/// Steps of the search for a top, and how often they are halved.
const STEPS: usize = 24;
const HALVINGS: usize = 5;

impl Grid {
    /// Samples the square that reaches `half` to each side.
    pub fn new(heights: &Heights<'_>, half: f64) -> Self {
        let place = |k: usize| half * (2.0 * k as f64 / (SIDE - 1) as f64 - 1.0);
        let places: Vec<[f64; 2]> =
            (0..SIDE * SIDE).map(|n| [place(n % SIDE), place(n / SIDE)]).collect();
        let sampled = heights(&places);
        let mut sorted: Vec<f64> = sampled.iter().copied().filter(|h| h.is_finite()).collect();
        sorted.sort_unstable_by(f64::total_cmp);
        let on_border =
            |n: &usize| [0, SIDE - 1].contains(&(n % SIDE)) || [0, SIDE - 1].contains(&(n / SIDE));
        let ends = [f64::INFINITY, f64::NEG_INFINITY];
        let border = (0..SIDE * SIDE).filter(on_border).map(|n| sampled[n]);
        let border = border.fold(ends, |[low, high], h| [low.min(h), high.max(h)]);
        let mut tops = Vec::new();
        if let [low, .., high] = sorted[..] {
            let apart = 2.0 * half / (SIDE - 1) as f64;
            for (n, sign) in candidates(&sampled) {
                let found = climb(heights, places[n], sampled[n], sign, apart);
                tops.extend(found.filter(|top| (top.2 - sampled[n]).abs() <= (high - low) / 2.0));
            }
            // What dies away has tops that nobody sees.
            let middle = sorted[sorted.len() / 2];
            let size = |top: &(f64, f64, f64)| (top.2 - middle).abs();
            let most = tops.iter().map(size).fold(0.0, f64::max);
            tops.retain(|top| size(top) >= SEEN * most);
        }
        Self { half, sorted, border, tops }
    }
}

/// Points of the grid that are at least as high as all around them, or as low, and higher or lower than some by more than
/// rounding: with the sign of the way to a top.
fn candidates(heights: &[f64]) -> impl Iterator<Item = (usize, f64)> {
    let inner = |n: &usize| {
        (1..SIDE - 1).contains(&(n % SIDE))
            && (1..SIDE - 1).contains(&(n / SIDE))
            && heights[*n].is_finite()
    };
    (0..SIDE * SIDE).filter(inner).filter_map(|n| {
        let around = [
            n - SIDE - 1,
            n - SIDE,
            n - SIDE + 1,
            n - 1,
            n + 1,
            n + SIDE - 1,
            n + SIDE,
            n + SIDE + 1,
        ];
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

/// The top near a place: `None` if the way there is long, as along a valley.
fn climb(
    heights: &Heights<'_>,
    start: [f64; 2],
    height: f64,
    sign: f64,
    apart: f64,
) -> Option<(f64, f64, f64)> {
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
            return is_top(heights, [x, y], apart / 8.0, apart).then_some((x, y, height));
        }
    }
    None
}

/// Whether the paraboloid through the heights around a place has its top nearby, too: in a bent valley it has not.
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
    // What has no paraboloid is no valley.
    let way = way_x.abs().max(way_y.abs());
    way.is_nan() || way <= apart
}

/// Which heights are shown: all tops and bottoms, and of what rises or falls to the border as much as is fit to be seen.
/// `None` if there are no heights.
pub fn shown(grid: &Grid) -> Option<[f64; 2]> {
    let Grid { half, sorted, border, tops } = grid;
    let (lowest, highest) = (*sorted.first()?, *sorted.last()?);
    let quantile = |share: f64| sorted[(share * (sorted.len() - 1) as f64) as usize];
    let heights = || tops.iter().map(|top| top.2);
    let (bottom, top) =
        (heights().fold(f64::INFINITY, f64::min), heights().fold(f64::NEG_INFINITY, f64::max));
    // Whether there is nothing lower, or higher, than what is found within.
    let (from_below, from_above) = (bottom <= lowest, top >= highest);
    let [mut low, mut high] = match (from_below, from_above) {
        (true, true) => [bottom, top],
        (true, false) => [bottom, quantile(MOST_ONE_WAY).max(top)],
        (false, true) => [quantile(1.0 - MOST_ONE_WAY).min(bottom), top],
        (false, false) => [quantile(1.0 - MOST).min(bottom), quantile(MOST).max(top)],
    };
    let reach = high - low;
    let width = 2.0 * half;
    if lowest > low - NEARLY * reach {
        low = low.min(lowest);
    } else if !from_below && low - lowest > POLE * reach {
        low = high - width;
    }
    if highest < high + NEARLY * reach {
        high = high.max(highest);
    } else if !from_above && highest - high > POLE * reach {
        high = low + width;
    }
    let tallest = if top - bottom <= TALLEST * width { top - bottom } else { 0.0 };
    let most = tallest.max(TALL * width);
    if high - low > most {
        match (from_below, from_above) {
            (true, false) => high = low + most,
            (false, true) => low = high - most,
            (true, true) | (false, false) => {
                let middle = if from_below { low.midpoint(high) } else { quantile(0.5) };
                (low, high) = (middle - most / 2.0, middle + most / 2.0);
            }
        }
    }
    let space = SPACE * (high - low);
    // A bowl is cut at its rim, where all of it that is shown is round.
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
