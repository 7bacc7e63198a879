//! Bounds that are proven for a surface along each axis: half-spaces that hold none of it.
//!
//! Unlike a box around the whole surface, such bounds exist for surfaces that are bounded in some
//! directions only. This module depends neither on graphs nor on windows.

use zeroset_space::{Cell, CellSearch};

/// Number of times that all six ends are searched. A later round uses the bounds of the earlier
/// ones.
const ROUNDS: u32 = 4;

/// Number of places that are tried at once. Each step divides the range of an end by one more.
const PLACES: i64 = 15;

/// Magnitude of the farthest end that is tried: 2^511. Squares of larger coordinates overflow.
const FARTHEST: f64 = 6.703_903_964_971_299e153;

/// Number of the lowest bits of an end that are not searched. It is found to about a millionth.
const OPEN_BITS: u32 = 28;

/// The smallest box with sides along the axes in which the surfaces are proven to lie, as far as
/// intervals over whole half-spaces show. Ends without a proof are infinite. `None` if the surfaces
/// are proven empty.
///
/// The proof: the half-space beyond an end, cut by the bounds that are already proven, is a box
/// over which no function can be 0, or such a box in parts.
pub fn bounds(search: &CellSearch<'_>) -> Option<Cell> {
    let mut cell = Cell { low: [f64::NEG_INFINITY; 3], high: [f64::INFINITY; 3] };
    let mut is_split = false;
    for _ in 0..ROUNDS {
        let before = cell;
        for axis in 0..3 {
            for side in 0..2 {
                let is_high = side == 1;
                let mut side = Side { axis, is_high, is_split: &mut is_split };
                let end = side.end(search, &cell);
                let known = if is_high { &mut cell.high } else { &mut cell.low };
                known[axis] = end;
            }
        }
        if search.open(&[cell]).is_empty() && search.is_wanted() {
            return None;
        }
        if cell == before {
            break;
        }
    }
    Some(cell)
}

/// A side of the box.
struct Side<'a> {
    axis: usize,
    is_high: bool,
    /// True if half-spaces are split where the other coordinates are 0. Intervals prove |x| + |y| ≤
    /// 1 bounded without that, but not x + y ≤ 1 and x − y ≤ 1.
    is_split: &'a mut bool,
}

impl Side<'_> {
    /// The parts of `cell` that lie beyond a place.
    fn beyond(&self, cell: &Cell, place: f64) -> Vec<Cell> {
        let mut part = *cell;
        let ends = if self.is_high { &mut part.low } else { &mut part.high };
        ends[self.axis] = place;
        let mut parts = vec![part];
        for other in (0..3).filter(|other| *self.is_split && *other != self.axis) {
            if cell.low[other] < 0.0 && 0.0 < cell.high[other] {
                let halves = parts.iter().flat_map(|part| {
                    let [mut below, mut above] = [*part; 2];
                    (below.high[other], above.low[other]) = (0.0, 0.0);
                    [below, above]
                });
                parts = halves.collect();
            }
        }
        parts
    }

    /// The end of `cell` on this side, moved inward as far as all beyond it is proven empty.
    fn end(&mut self, search: &CellSearch<'_>, cell: &Cell) -> f64 {
        let [low, high] = [cell.low[self.axis], cell.high[self.axis]];
        let [outer, inner] = if self.is_high { [high, low] } else { [low, high] };
        let rank = |end: f64| rank(end.clamp(-FARTHEST, FARTHEST));
        // All beyond `proven` is empty; nothing is known at `open`.
        let (mut found, mut proven, mut open) = (outer, rank(outer), rank(inner));
        if outer.is_infinite() {
            found = place(proven);
            let was_split = *self.is_split;
            let is_empty = |side: &Self| search.open(&side.beyond(cell, found)).is_empty();
            if !is_empty(self) {
                *self.is_split = true;
                if was_split || !is_empty(self) {
                    *self.is_split = was_split;
                    return outer;
                }
            }
        }
        while (open - proven).abs() > 1 && search.is_wanted() {
            let step = |k: i64| proven + (open - proven) * k / (PLACES + 1);
            let mut places: Vec<i64> = (1..=PLACES).map(step).collect();
            places.dedup();
            let parts: Vec<Vec<Cell>> =
                places.iter().map(|rank| self.beyond(cell, place(*rank))).collect();
            let left = search.open(&parts.concat());
            // Places are in order, so those before the first open one are proven.
            let holds = |parts: &Vec<Cell>| left.first().is_some_and(|first| parts.contains(first));
            let first = parts.iter().position(holds).unwrap_or(places.len());
            if first > 0 && places[first - 1] != proven {
                proven = places[first - 1];
                found = place(proven);
            }
            open = places.get(first).copied().unwrap_or(open);
            if first == places.len() && places.last() == Some(&open) {
                break;
            }
        }
        found
    }
}

/// The rank of a float among all floats without their lowest bits.
fn rank(value: f64) -> i64 {
    let rank = (value.abs().to_bits() >> OPEN_BITS) as i64;
    if value < 0.0 { -rank } else { rank }
}

/// The float of a rank.
fn place(rank: i64) -> f64 {
    let size = f64::from_bits(rank.unsigned_abs() << OPEN_BITS);
    if rank < 0 { -size } else { size }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::program::Program;
    use fastrand::Rng;
    use std::cell::Cell as Counter;
    use zeroset_interval::Interval;
    use zeroset_syntax::{Options, read};

    /// The bounds of the first surface, and its values at places.
    fn found(text: &str, places: &dyn Fn(&Cell) -> Vec<[f64; 3]>) -> (Option<Cell>, Vec<f64>) {
        let document = read(text, &Options::default()).expect(text);
        let program = Program::new(&document, [Interval::ENTIRE; 3]).expect(text);
        let surfaces = vec![program.kernels::<f64>(0).zeros().expect("code")];
        let work = Counter::new(1_000_000);
        let search = CellSearch { surfaces, forms: Vec::new(), wanted: &|| true, work };
        let cell = bounds(&search);
        let values = program.kernels::<f64>(0).values().expect("code");
        let whole = Cell { low: [f64::NEG_INFINITY; 3], high: [f64::INFINITY; 3] };
        (cell, search.values(values, &places(&cell.unwrap_or(whole))))
    }

    #[test]
    fn bounds_are_as_near_as_intervals_prove() {
        let (none, all) = (f64::NEG_INFINITY, f64::INFINITY);
        for (text, low, high) in [
            ("x^2+y^2<=25 and z>=0", [-5.0, -5.0, 0.0], [5.0, 5.0, all]),
            ("1<=x<=7 and y<=7 and 0<=z<=1", [1.0, none, 0.0], [7.0, 7.0, 1.0]),
            ("y>=0 and z>=0 and y+2z<=300", [none, 0.0, 0.0], [all, 300.0, 150.0]),
            ("z=exp(-x^2-y^2)", [none, none, 0.0], [all, all, 1.0]),
            ("y=x^4-16 {abs(x)<2}", [-2.0, -16.0, none], [2.0, 0.0, all]),
            ("x>=1e30", [1e30, none, none], [all, all, all]),
            ("x+y<=3 and x-y<=3 and x>=0", [0.0, -3.0, none], [3.0, 3.0, all]),
            ("x^2+y^2=z^2", [none; 3], [all; 3]),
        ] {
            let cell = found(text, &|_| Vec::new()).0.expect(text);
            let near = |a: f64, b: f64| a == b || (a - b).abs() <= 1e-5 * b.abs().max(1e-9);
            for axis in 0..3 {
                let is_near = near(cell.low[axis], low[axis]) && near(cell.high[axis], high[axis]);
                assert!(is_near, "{text}: {cell:?}");
            }
        }
    }

    /// A condition that keeps one side of a plane, cylinder, ball or wave.
    fn condition(random: &mut Rng) -> String {
        let axes = ["x", "y", "z"];
        let k = random.usize(..3);
        let [a, b, c] = [axes[k], axes[(k + 1) % 3], axes[(k + 2) % 3]];
        let [m, n] = [random.i64(-4..=4), random.i64(1..=9)];
        match random.u32(..9) {
            0 => format!("{a} >= {m}"),
            1 => format!("{a} <= {n}"),
            2 => format!("abs({a}-({m})) <= {n}"),
            3 => format!("({a}-({m}))^2+{b}^2 <= {n}"),
            4 => format!("{a}+{n}{b} <= {m}"),
            5 => format!("{c} <= {n}*exp(-{a}^2-{b}^2)"),
            6 => format!("{a}^2+{b}^2+{c}^2 <= {n}"),
            7 => format!("{a}+{n}{b} <= {n} and {a}-{b} <= {m} and {a} >= {m}"),
            _ => format!("{a} <= sin({n}{b})+({m})*cos({c})"),
        }
    }

    #[test]
    fn no_surface_lies_beyond_its_bounds() {
        let seed = 20_261_126;
        println!("seed {seed}");
        let (mut random, mut ends, mut near, mut empty) = (Rng::with_seed(seed), 0, 0, 0);
        for _ in 0..150 {
            let mut text = condition(&mut random);
            for _ in 0..random.u32(..4) {
                let word = if random.u32(..4) == 0 { "or" } else { "and" };
                text = format!("({text}) {word} ({})", condition(&mut random));
            }
            // Beyond each end, and a hair inside of it.
            let shares: Vec<f64> = (0..300).map(|_| random.f64()).collect();
            let places = |cell: &Cell| {
                let mut all = Vec::new();
                for axis in 0..3 {
                    for (end, sign) in [(cell.low[axis], -1.0), (cell.high[axis], 1.0)] {
                        for three in shares.chunks(3) {
                            let mut place = [0, 1, 2].map(|k| 16.0 * three[k] - 8.0);
                            let far = 10.0_f64.powf(8.0 * three[axis] - 7.0);
                            place[axis] =
                                if end.is_finite() { end + sign * far } else { sign * far };
                            all.push(place);
                        }
                    }
                }
                all
            };
            let Ok(document) = read(&text, &Options::default()) else { panic!("{text}") };
            if Program::new(&document, [Interval::ENTIRE; 3]).is_err() {
                continue;
            }
            let (cell, values) = found(&text, &places);
            let Some(cell) = cell else {
                let is_one = values.iter().all(|value| value * values[0].signum() > 0.0);
                assert!(is_one, "{text} is called empty, seed {seed}");
                empty += 1;
                continue;
            };
            for (side, values) in values.chunks(100).enumerate() {
                let (axis, is_high) = (side / 2, side % 2 == 1);
                let end = if is_high { cell.high[axis] } else { cell.low[axis] };
                if !end.is_finite() {
                    continue;
                }
                ends += 1;
                // A continuous function without zeros in a half-space has one sign there.
                let sign = values[0].signum();
                let is_one = values.iter().all(|value| value * sign > 0.0);
                assert!(is_one, "{text}: {cell:?} along axis {axis}: {values:?}, seed {seed}");
                near += usize::from(end.abs() < 100.0);
            }
        }
        println!("{ends} ends, {near} of them within 100; {empty} empty");
        assert!(ends > 150, "{ends}");
    }
}
