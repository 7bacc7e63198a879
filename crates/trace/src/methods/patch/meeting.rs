//! Where a beam of rays may meet a cell of a parametric surface, and whether it must.
//!
//! Let k be the axis of the largest component of a direction d, and i and j the other axes. The ray
//! o + t·d meets the point S(u, v) where two functions vanish (Kajiya 1982, "Ray tracing parametric
//! patches"; Toth 1985, "On ray tracing parametric surfaces"):
//!
//! ```text
//! F(u, v) = d[k]·(S[i] − o[i]) − d[i]·(S[k] − o[k])
//! G(u, v) = d[k]·(S[j] − o[j]) − d[j]·(S[k] − o[k])
//! ```
//!
//! Both planes hold the ray exactly, whatever the rounding of d. Then t = (S[k] − o[k])/d[k].
//!
//! Over a cell, u and v are linear in two symbols U and V from −1 to 1. Each coordinate is within
//! an error of a linear function of U and V. So F = f.c + f.a·U + f.b·V + δ with |δ| ≤ `f.error`,
//! and G likewise with ε. The errors include the rounding of the coefficients. If both vanish, then
//! with D = f.a·g.b − g.a·f.b:
//!
//! ```text
//! D·U = f.b·g.c − g.b·f.c + f.b·ε − g.b·δ
//! D·V = g.a·f.c − f.a·g.c + g.a·δ − f.a·ε
//! ```
//!
//! That bounds U and V ([`Meeting::symbols`]).
//!
//! **A zero must exist** if the bounds of U and V lie within −1 to 1 and S is continuous on the
//! cell. Let T map (U, V) to the solution of the two linear equations with δ and ε taken at (U, V).
//! T is continuous and maps the rectangle of these bounds into itself, so it has a fixed point
//! (Brouwer). There both functions vanish.
//!
//! All numbers here are rounded to nearest. [`SLACK`] bounds the rounding. The bounds of U hold
//! where |U| ≤ 1. If they lie within −1 to 1, they hold for T, too: they include eight times the
//! rounding of D, relative to D. So D has an error of at most an eighth, and T is at most 8/7.

use crate::method::Segment;
use fearless_simd::Simd;
use glam::DVec3;
use zeroset_eval::{LANES, LaneSet, Lanes, Patches};
use zeroset_space::Ray;

/// Bound of the rounding in the coefficients and sums of a function F, as a share of the sizes of
/// its terms. They have at most eight roundings, each of at most 2⁻⁵³.
const SLACK: f64 = 16.0 / 9_007_199_254_740_992.0;

/// Below this determinant, products of coefficients may lose digits to underflow, and the linear
/// equations are not solved.
const LEAST_DETERMINANT: f64 = 1e-200;

/// Bound of errors by underflow.
const UNDERFLOW: f64 = 1e-290;

/// Rays that are close together: component by component, each ray's origin and direction are within
/// a distance of those stored. The axes are in the order i, j, k.
#[derive(Clone, Copy, Debug)]
pub(super) struct Beam {
    /// The axes in the order i, j, k.
    pub axes: [usize; 3],
    origin: [f64; 3],
    direction: [f64; 3],
    /// Largest distance of a ray's origin, per axis; 0 for one ray.
    origin_spread: [f64; 3],
    /// Largest distance of a ray's direction, per axis; 0 for one ray.
    direction_spread: [f64; 3],
}

impl Beam {
    /// The beam of one ray, with axes in this order. The direction's component on the last must not
    /// be 0.
    pub fn along(ray: &Ray, axes: [usize; 3]) -> Self {
        let in_order = |vector: DVec3| axes.map(|axis| vector[axis]);
        let (origin, direction) = (in_order(ray.origin), in_order(ray.direction));
        Self { axes, origin, direction, origin_spread: [0.0; 3], direction_spread: [0.0; 3] }
    }

    /// A beam that holds two with the same axes. `None` if it spreads too far.
    pub fn of_both((one, other): (Self, Self)) -> Option<Self> {
        let (mut origin, mut direction) = (Ends::default(), Ends::default());
        for axis in 0..3 {
            let hull = |a: f64, a_spread: f64, b: f64, b_spread: f64| {
                // Rounded outward.
                let slack = SLACK * (a.abs() + b.abs() + a_spread + b_spread);
                let low = (a - a_spread).min(b - b_spread) - slack;
                (low, (a + a_spread).max(b + b_spread) + slack)
            };
            (origin.low[axis], origin.high[axis]) = hull(
                one.origin[axis],
                one.origin_spread[axis],
                other.origin[axis],
                other.origin_spread[axis],
            );
            (direction.low[axis], direction.high[axis]) = hull(
                one.direction[axis],
                one.direction_spread[axis],
                other.direction[axis],
                other.direction_spread[axis],
            );
        }
        Self::between(one.axes, &origin, &direction)
    }

    /// The beam of all rays whose components lie between these. `None` if it spreads too far.
    fn between(axes: [usize; 3], origin: &Ends, direction: &Ends) -> Option<Self> {
        let (origin, origin_spread) = origin.middle();
        let (direction, direction_spread) = direction.middle();
        let [i, j, k] = direction_spread;
        let is_narrow = i.max(j).max(k) <= 0.25 * direction[2].abs();
        is_narrow.then_some(Self { axes, origin, direction, origin_spread, direction_spread })
    }

    /// How far the rays spread about the same distance away as the surface, whose half extent is
    /// given: a rough measure.
    pub fn spread(&self, extent: f64) -> f64 {
        let largest = |[i, j, k]: [f64; 3]| i.max(j).max(k);
        let away = largest(self.origin.map(f64::abs)).max(extent);
        let turn = largest(self.direction_spread) / self.direction[2].abs();
        largest(self.origin_spread) + away * turn
    }

    /// The lanes in which some ray of the beam may meet the cell, and a lower bound of the t ≥ 0 at
    /// which it does.
    #[inline(always)]
    pub fn meets<S: Simd>(&self, _: S, cells: &CellView<'_>) -> (LaneSet, Lanes<f64>) {
        let (mut possible, mut from) = (Lanes::splat(0.0), Lanes::splat(0.0));
        for lane in 0..LANES {
            let cell = cells.lane(lane);
            possible.0[lane] = if linear_equations(self, &cell).is_possible { 1.0 } else { 0.0 };
            from.0[lane] = least_t(self, &cell);
        }
        let mut lanes = 0;
        for lane in 0..LANES {
            lanes |= LaneSet::from(possible.0[lane] > 0.0) << lane;
        }
        (lanes, from)
    }
}

/// The lowest and the highest of some vectors' components.
#[derive(Default)]
struct Ends {
    low: [f64; 3],
    high: [f64; 3],
}

impl Ends {
    #[inline(always)]
    fn of(vectors: &[Lanes<f64>; 3]) -> Self {
        let mut ends = Self::default();
        for (axis, all) in vectors.iter().enumerate() {
            let (mut low, mut high) = (all.0[0], all.0[0]);
            for component in all.0 {
                (low, high) = (smaller(component, low), larger(component, high));
            }
            (ends.low[axis], ends.high[axis]) = (low, high);
        }
        ends
    }

    /// The middle, and the largest distance from it.
    fn middle(&self) -> ([f64; 3], [f64; 3]) {
        let (mut middles, mut spreads) = ([0.0; 3], [0.0; 3]);
        for axis in 0..3 {
            let (low, high) = (self.low[axis], self.high[axis]);
            let middle = 0.5 * (low + high);
            middles[axis] = middle;
            // Rounded up, since the middle and the differences are rounded.
            let spread = (high - middle).max(middle - low);
            spreads[axis] = spread * (1.0 + SLACK) + SLACK * middle.abs();
        }
        (middles, spreads)
    }
}

/// The axes i, j, k.
pub(super) fn axes(main: usize) -> [usize; 3] {
    [(main + 1) % 3, (main + 2) % 3, main]
}

/// The axis of a direction's largest component.
pub(super) fn main_axis(direction: DVec3) -> usize {
    let sizes = direction.abs().to_array();
    (0..3).fold(0, |best, axis| if sizes[axis] > sizes[best] { axis } else { best })
}

/// The surface over one cell, in the order of a beam's axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct CellShape {
    centre: [f64; 3],
    along_u: [f64; 3],
    along_v: [f64; 3],
    error: [f64; 3],
}

impl CellShape {
    /// The shape of the cell in a lane.
    #[inline(always)]
    pub fn new(cells: &Patches<f64>, axes: [usize; 3], lane: usize) -> Self {
        Self {
            centre: of_lane(&cells.centre, axes, lane),
            along_u: of_lane(&cells.along_u, axes, lane),
            along_v: of_lane(&cells.along_v, axes, lane),
            error: of_lane(&cells.error, axes, lane),
        }
    }
}

/// The values of a lane on three axes.
#[inline(always)]
fn of_lane(all: &[Lanes<f64>; 3], [i, j, k]: [usize; 3], lane: usize) -> [f64; 3] {
    [all[i].0[lane], all[j].0[lane], all[k].0[lane]]
}

/// The values on three axes, in this order.
#[inline(always)]
fn in_order(all: &[Lanes<f64>; 3], [i, j, k]: [usize; 3]) -> [&Lanes<f64>; 3] {
    [&all[i], &all[j], &all[k]]
}

/// The shapes of [`LANES`] cells, in the order of a beam's axes, where they are stored.
#[derive(Clone, Copy, Debug)]
pub(super) struct CellView<'a> {
    centre: [&'a Lanes<f64>; 3],
    along_u: [&'a Lanes<f64>; 3],
    along_v: [&'a Lanes<f64>; 3],
    error: [&'a Lanes<f64>; 3],
}

impl<'a> CellView<'a> {
    /// The shapes of cells.
    #[inline(always)]
    pub fn new(cells: &'a Patches<f64>, axes: [usize; 3]) -> Self {
        Self {
            centre: in_order(&cells.centre, axes),
            along_u: in_order(&cells.along_u, axes),
            along_v: in_order(&cells.along_v, axes),
            error: in_order(&cells.error, axes),
        }
    }

    #[inline(always)]
    fn lane(&self, lane: usize) -> CellShape {
        let of = |[i, j, k]: [&Lanes<f64>; 3]| [i.0[lane], j.0[lane], k.0[lane]];
        CellShape {
            centre: of(self.centre),
            along_u: of(self.along_u),
            along_v: of(self.along_v),
            error: of(self.error),
        }
    }
}

/// Up to [`LANES`] single rays with the same axis k.
#[derive(Clone, Debug)]
pub(super) struct BeamLanes {
    pub axes: [usize; 3],
    origin: [Lanes<f64>; 3],
    direction: [Lanes<f64>; 3],
}

impl BeamLanes {
    /// The rays of at most [`LANES`] segments, and at least one. Lanes that are not in use repeat
    /// the first ray.
    pub fn new(segments: &[Segment], axes: [usize; 3]) -> Self {
        let zero = Lanes::splat(0.0);
        let mut lanes = Self { axes, origin: [zero; 3], direction: [zero; 3] };
        for lane in 0..LANES {
            let Ray { origin, direction } = &segments.get(lane).unwrap_or(&segments[0]).ray;
            for (place, axis) in axes.into_iter().enumerate() {
                lanes.origin[place].0[lane] = origin[axis];
                lanes.direction[place].0[lane] = direction[axis];
            }
        }
        lanes
    }

    /// A beam that holds all rays. `None` if some ray advances less than half as fast along the
    /// axis k as along another, or they spread too far.
    #[inline(always)]
    #[allow(clippy::needless_bitwise_bool, reason = "all lanes at once")]
    pub fn beam<S: Simd>(&self, _: S) -> Option<Beam> {
        let [i, j, k] = &self.direction;
        let mut fast = 0.0;
        for lane in 0..LANES {
            let own = 2.0 * k.0[lane].abs();
            let is_fast = (own >= i.0[lane].abs()) & (own >= j.0[lane].abs());
            fast += if is_fast { 1.0 } else { 0.0 };
        }
        if fast < LANES as f64 {
            return None;
        }
        Beam::between(self.axes, &Ends::of(&self.origin), &Ends::of(&self.direction))
    }

    #[inline(always)]
    fn lane(&self, lane: usize) -> Beam {
        Beam {
            axes: self.axes,
            origin: of_lane(&self.origin, [0, 1, 2], lane),
            direction: of_lane(&self.direction, [0, 1, 2], lane),
            origin_spread: [0.0; 3],
            direction_spread: [0.0; 3],
        }
    }
}

/// The first meetings of up to [`LANES`] rays with cells.
#[derive(Clone, Debug)]
pub(super) struct Firsts {
    /// Only for t between these may the ray be in the region: for none in lanes that are not in
    /// use.
    within: [Lanes<f64>; 2],
    /// For all t between these, the ray is in the region.
    sure: [Lanes<f64>; 2],
    /// The t at which the first, the second and the third meeting begin at the earliest. Infinite
    /// if there is none.
    pub near: [Lanes<f64>; 3],
    /// Numbers of the cells of the first two meetings.
    pub cell: [Lanes<f64>; 2],
    /// A zero in the meeting that ends first of those in which one is proven in the region.
    pub zero: ZeroLanes,
}

/// Bounds of zeros on up to [`LANES`] rays.
#[derive(Clone, Debug)]
pub(super) struct ZeroLanes {
    /// The lowest t before which a zero in the region is proven. Infinite if none is.
    pub far: Lanes<f64>,
    /// Approximate u and v of that zero.
    pub parameters: [Lanes<f64>; 2],
}

impl Default for ZeroLanes {
    fn default() -> Self {
        Self { far: Lanes::splat(f64::INFINITY), parameters: [Lanes::splat(0.0); 2] }
    }
}

impl Default for Firsts {
    fn default() -> Self {
        let (none, zero) = (Lanes::splat(f64::INFINITY), ZeroLanes::default());
        let within = [none, Lanes::splat(f64::NEG_INFINITY)];
        Self { within, sure: [none; 2], near: [none; 3], cell: [Lanes::splat(0.0); 2], zero }
    }
}

impl Firsts {
    /// Adds a ray that may be in the region only for t in `within`, and is for all t in `sure`.
    pub fn add(&mut self, lane: usize, within: [f64; 2], sure: [f64; 2]) {
        for end in 0..2 {
            self.within[end].0[lane] = within[end];
            self.sure[end].0[lane] = sure[end];
        }
    }

    /// The t from which on all rays in use have passed a proven zero.
    pub fn end(&self) -> f64 {
        let mut end = f64::NEG_INFINITY;
        for lane in 0..LANES {
            let is_in_use = self.within[0].0[lane] <= self.within[1].0[lane];
            end = larger(if is_in_use { self.zero.far.0[lane] } else { end }, end);
        }
        end
    }

    /// Lets all rays meet the cell in a lane. `number` is the cell's. `is_whole` tells whether the
    /// surface is continuous on the cell, and all of it belongs to the exact rectangle.
    #[inline(always)]
    #[allow(clippy::needless_bitwise_bool, reason = "all lanes at once")]
    pub fn meet<S: Simd>(
        &mut self,
        _: S,
        rays: &BeamLanes,
        (cells, lane): (&Patches<f64>, usize),
        number: usize,
        is_whole: bool,
    ) {
        let (cell, number) = (&CellShape::new(cells, rays.axes, lane), number as f64);
        let whole = if is_whole { 1.0 } else { 0.0 };
        let (u, v) = (cells.middle[0].0[lane], cells.middle[1].0[lane]);
        let (half_u, half_v) = (cells.half[0].0[lane], cells.half[1].0[lane]);
        let [first, second, third] = &mut self.near;
        let [first_cell, second_cell] = &mut self.cell;
        let ZeroLanes { far: zero, parameters: [zero_u, zero_v] } = &mut self.zero;
        for lane in 0..LANES {
            let meeting = meeting(&rays.lane(lane), cell);
            let [near, far] = meeting.t;
            let is_outside = (near > self.within[1].0[lane]) | (far < self.within[0].0[lane]);
            let is_met = meeting.is_possible & !is_outside;
            let is_first = is_met & (near < first.0[lane]);
            let is_second = is_met & !is_first & (near < second.0[lane]);
            let is_third = is_met & !is_first & !is_second & (near < third.0[lane]);
            third.0[lane] = if is_third { near } else { third.0[lane] };
            third.0[lane] = if is_first | is_second { second.0[lane] } else { third.0[lane] };
            second.0[lane] = if is_second { near } else { second.0[lane] };
            second.0[lane] = if is_first { first.0[lane] } else { second.0[lane] };
            second_cell.0[lane] = if is_second { number } else { second_cell.0[lane] };
            second_cell.0[lane] = if is_first { first_cell.0[lane] } else { second_cell.0[lane] };
            first.0[lane] = if is_first { near } else { first.0[lane] };
            first_cell.0[lane] = if is_first { number } else { first_cell.0[lane] };
            let is_proven = if meeting.is_inside() { whole } else { 0.0 };
            let is_inside = (near >= self.sure[0].0[lane]) & (far <= self.sure[1].0[lane]);
            let is_nearest = is_met & is_inside & (is_proven > 0.0) & (far < zero.0[lane]);
            let (u, v) = (u + half_u * meeting.symbols[0][0], v + half_v * meeting.symbols[1][0]);
            zero.0[lane] = if is_nearest { far } else { zero.0[lane] };
            zero_u.0[lane] = if is_nearest { u } else { zero_u.0[lane] };
            zero_v.0[lane] = if is_nearest { v } else { zero_v.0[lane] };
        }
    }
}

/// The place where rays of a beam may meet a cell.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Meeting {
    /// False if it is proven that none meets it.
    pub is_possible: bool,
    /// Whether the linear equations have one solution for all errors.
    pub is_solved: bool,
    /// Bounds of U and V at all zeros in the cell: the middle and the largest distance from it.
    /// They may exceed the cell.
    pub symbols: [[f64; 2]; 2],
    /// Bounds of t at all zeros in the cell. Only for a single ray.
    pub t: [f64; 2],
}

impl Meeting {
    /// Returns whether the bounds of the symbols lie in the cell.
    #[inline(always)]
    #[allow(clippy::needless_bitwise_bool, reason = "all lanes at once")]
    pub fn is_inside(&self) -> bool {
        let is_within = |[middle, reach]: [f64; 2]| middle.abs() + reach <= 1.0 - SLACK;
        self.is_solved & is_within(self.symbols[0]) & is_within(self.symbols[1])
    }
}

/// Meetings in all lanes of a batch.
#[derive(Clone, Debug, Default)]
pub(super) struct Meetings {
    /// 1 for true, 0 for false, so that loops over lanes become vector instructions.
    is_possible: Lanes<f64>,
    is_solved: Lanes<f64>,
    symbols: [[Lanes<f64>; 2]; 2],
    t: [Lanes<f64>; 2],
}

impl Meetings {
    #[inline(always)]
    fn set(&mut self, lane: usize, one: &Meeting) {
        self.is_possible.0[lane] = if one.is_possible { 1.0 } else { 0.0 };
        self.is_solved.0[lane] = if one.is_solved { 1.0 } else { 0.0 };
        self.symbols[0][0].0[lane] = one.symbols[0][0];
        self.symbols[0][1].0[lane] = one.symbols[0][1];
        self.symbols[1][0].0[lane] = one.symbols[1][0];
        self.symbols[1][1].0[lane] = one.symbols[1][1];
        self.t[0].0[lane] = one.t[0];
        self.t[1].0[lane] = one.t[1];
    }

    /// Where `beam` may meet the cells of all lanes.
    #[inline(always)]
    pub fn with_cells<S: Simd>(_: S, beam: &Beam, cells: &CellView<'_>) -> Self {
        let mut all = Self::default();
        for lane in 0..LANES {
            all.set(lane, &meeting(beam, &cells.lane(lane)));
        }
        all
    }

    /// Where the ray of each lane may meet the cell in the same lane.
    #[inline(always)]
    pub fn by_lane<S: Simd>(_: S, rays: &BeamLanes, cells: &CellView<'_>) -> Self {
        let mut all = Self::default();
        for lane in 0..LANES {
            all.set(lane, &meeting(&rays.lane(lane), &cells.lane(lane)));
        }
        all
    }

    /// Lanes in which a zero is not excluded.
    #[inline(always)]
    pub fn possible(&self) -> LaneSet {
        let mut lanes = 0;
        for lane in 0..LANES {
            lanes |= LaneSet::from(self.is_possible.0[lane] > 0.0) << lane;
        }
        lanes
    }

    /// The meeting of a lane.
    pub fn lane(&self, lane: usize) -> Meeting {
        Meeting {
            is_possible: self.is_possible[lane] > 0.0,
            is_solved: self.is_solved[lane] > 0.0,
            symbols: [
                [self.symbols[0][0].0[lane], self.symbols[0][1].0[lane]],
                [self.symbols[1][0].0[lane], self.symbols[1][1].0[lane]],
            ],
            t: [self.t[0][lane], self.t[1][lane]],
        }
    }
}

/// Where `beam` may meet the cell of one lane.
pub(super) fn with_cell(beam: &Beam, cells: &Patches<f64>, lane: usize) -> Meeting {
    meeting(beam, &CellShape::new(cells, beam.axes, lane))
}

/// The function F of an axis: its value at the middle, its change along U and along V, the largest
/// error, and the size of its terms.
#[derive(Clone, Copy)]
struct PlaneFunction {
    c: f64,
    a: f64,
    b: f64,
    error: f64,
    size: f64,
}

/// How far S − o is from its linear part on an axis, at most, and from 0.
#[inline(always)]
fn spread(beam: &Beam, cell: &CellShape, axis: usize) -> [f64; 2] {
    let size = cell.centre[axis].abs()
        + cell.along_u[axis].abs()
        + cell.along_v[axis].abs()
        + cell.error[axis];
    let reach = size + beam.origin[axis].abs() + beam.origin_spread[axis];
    [cell.error[axis] + beam.origin_spread[axis] + SLACK * reach, reach]
}

#[inline(always)]
fn plane_function(beam: &Beam, cell: &CellShape, axis: usize) -> PlaneFunction {
    let Beam { origin: o, direction: d, direction_spread, .. } = beam;
    let [own_error, own_reach] = spread(beam, cell, axis);
    let [main_error, main_reach] = spread(beam, cell, 2);
    let c = d[2] * (cell.centre[axis] - o[axis]) - d[axis] * (cell.centre[2] - o[2]);
    let a = d[2] * cell.along_u[axis] - d[axis] * cell.along_u[2];
    let b = d[2] * cell.along_v[axis] - d[axis] * cell.along_v[2];
    let error = d[2].abs() * own_error
        + d[axis].abs() * main_error
        + direction_spread[2] * own_reach
        + direction_spread[axis] * main_reach
        + UNDERFLOW;
    PlaneFunction { c, a, b, error: error * (1.0 + SLACK), size: c.abs() + a.abs() + b.abs() }
}

impl PlaneFunction {
    /// Returns whether the function is proven to have no zero in the cell. A sum that is no number
    /// proves nothing.
    #[inline(always)]
    fn is_beyond(&self) -> bool {
        self.c.abs() > self.a.abs() + self.b.abs() + self.error + SLACK * self.size
    }
}

/// The larger of two numbers; the second if the first is NaN.
#[inline(always)]
fn larger(one: f64, other: f64) -> f64 {
    if one > other { one } else { other }
}

/// The smaller of two numbers; the second if the first is NaN.
#[inline(always)]
fn smaller(one: f64, other: f64) -> f64 {
    if one < other { one } else { other }
}

/// The solution of a cell's two linear equations.
#[derive(Clone, Copy)]
struct Solution {
    is_possible: bool,
    is_solved: bool,
    /// The middle and the reach of the bounds of U and V. −1 to 1 if the equations are not solved.
    symbols: [[f64; 2]; 2],
}

/// Solves the linear equations of a cell. The code has no branches after it is optimized, so that a
/// loop over lanes becomes vector instructions.
#[inline(always)]
#[allow(clippy::needless_bitwise_bool, reason = "all lanes at once")]
fn linear_equations(beam: &Beam, cell: &CellShape) -> Solution {
    let (f, g) = (plane_function(beam, cell, 0), plane_function(beam, cell, 1));
    let is_missed = f.is_beyond() | g.is_beyond();
    let determinant = f.a * g.b - g.a * f.b;
    let inverse = 1.0 / determinant;
    let (f_error, g_error) = (f.error + SLACK * f.size, g.error + SLACK * g.size);
    let u = (f.b * g.c - g.b * f.c) * inverse;
    let v = (g.a * f.c - f.a * g.c) * inverse;
    let u_reach = (g.b.abs() * f_error + f.b.abs() * g_error) * inverse.abs();
    let v_reach = (g.a.abs() * f_error + f.a.abs() * g_error) * inverse.abs();
    let u_reach = u_reach * (1.0 + SLACK) + SLACK * (1.0 + u.abs());
    let v_reach = v_reach * (1.0 + SLACK) + SLACK * (1.0 + v.abs());
    let is_solved = (determinant.abs() > LEAST_DETERMINANT)
        & (u_reach < f64::INFINITY)
        & (v_reach < f64::INFINITY);
    let (u, u_reach) = (if is_solved { u } else { 0.0 }, if is_solved { u_reach } else { 1.0 });
    let (v, v_reach) = (if is_solved { v } else { 0.0 }, if is_solved { v_reach } else { 1.0 });
    let is_outside = (u.abs() - u_reach > 1.0) | (v.abs() - v_reach > 1.0);
    let symbols = [[u, u_reach], [v, v_reach]];
    Solution { is_possible: !(is_missed | is_outside), is_solved, symbols }
}

/// The middle and the half of the part of bounds, given by middle and reach, that lies between −1
/// and 1.
#[inline(always)]
fn in_cell([middle, reach]: [f64; 2]) -> [f64; 2] {
    let (low, high) = (larger(middle - reach, -1.0), smaller(middle + reach, 1.0));
    [0.5 * (low + high), 0.5 * (high - low)]
}

/// Where the rays of a beam may meet a cell. The code has no branches after it is optimized.
#[inline(always)]
fn meeting(beam: &Beam, cell: &CellShape) -> Meeting {
    let Solution { is_possible, is_solved, symbols } = linear_equations(beam, cell);
    let ([u, u_half], [v, v_half]) = (in_cell(symbols[0]), in_cell(symbols[1]));
    let along = cell.centre[2] - beam.origin[2] + cell.along_u[2] * u + cell.along_v[2] * v;
    let reach =
        cell.along_u[2].abs() * u_half + cell.along_v[2].abs() * v_half + spread(beam, cell, 2)[0];
    let t = along / beam.direction[2];
    let wide = (reach + UNDERFLOW) / beam.direction[2].abs();
    let wide = wide + SLACK * (t.abs() + wide);
    // Also false for NaN.
    let is_known = t - wide <= t + wide;
    Meeting {
        is_possible,
        is_solved,
        symbols,
        t: [
            if is_known { t - wide } else { f64::NEG_INFINITY },
            if is_known { t + wide } else { f64::INFINITY },
        ],
    }
}

/// A lower bound of the t ≥ 0 at which a ray of the beam meets the cell. −∞ if it may be 0.
#[inline(always)]
fn least_t(beam: &Beam, cell: &CellShape) -> f64 {
    let direction = beam.direction[2].abs();
    let sign = if beam.direction[2] < 0.0 { -1.0 } else { 1.0 };
    let [error, _] = spread(beam, cell, 2);
    let reach = cell.along_u[2].abs() + cell.along_v[2].abs() + error;
    let middle = cell.centre[2] - beam.origin[2];
    // The slack covers the roundings of these sums and of the quotient.
    let nearest = sign * middle - reach - SLACK * (middle.abs() + reach);
    let least = nearest / (direction + beam.direction_spread[2]);
    // Also false for NaN.
    if nearest > 0.0 { least * (1.0 - SLACK) } else { f64::NEG_INFINITY }
}

#[cfg(test)]
mod tests;
