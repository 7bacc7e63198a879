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
    axes: [usize; 3],
    origin: [f64; 3],
    direction: [f64; 3],
    /// Largest distance of a ray's origin, per axis; 0 for one ray.
    origin_spread: [f64; 3],
    /// Largest distance of a ray's direction, per axis; 0 for one ray.
    direction_spread: [f64; 3],
}

impl Beam {
    /// The beam of one ray, with `main` as the axis k. The direction's component must not be 0.
    pub fn along(ray: &Ray, main: usize) -> Self {
        let axes = [(main + 1) % 3, (main + 2) % 3, main];
        let in_order = |vector: DVec3| axes.map(|axis| vector[axis]);
        let (origin, direction) = (in_order(ray.origin), in_order(ray.direction));
        Self { axes, origin, direction, origin_spread: [0.0; 3], direction_spread: [0.0; 3] }
    }

    /// A beam that holds all `rays`. `None` if they have different axes k, or spread too far.
    pub fn around(rays: &[Self]) -> Option<Self> {
        let mut beam = *rays.first()?;
        if rays.iter().any(|ray| ray.axes != beam.axes) {
            return None;
        }
        let middle = |of: fn(&Self) -> [f64; 3], axis: usize| {
            let ends = rays.iter().map(|ray| of(ray)[axis]);
            let low = ends.clone().fold(f64::INFINITY, f64::min);
            let high = ends.fold(f64::NEG_INFINITY, f64::max);
            let middle = 0.5 * (low + high);
            // Rounded up, since the middle and the differences are rounded.
            [middle, (high - middle).max(middle - low) * (1.0 + SLACK) + SLACK * middle.abs()]
        };
        for axis in 0..3 {
            [beam.origin[axis], beam.origin_spread[axis]] = middle(|ray| ray.origin, axis);
            [beam.direction[axis], beam.direction_spread[axis]] = middle(|ray| ray.direction, axis);
        }
        let main = beam.direction[2].abs();
        beam.direction_spread.iter().all(|spread| *spread <= 0.25 * main).then_some(beam)
    }
}

/// The axis of a direction's largest component.
pub(super) fn main_axis(direction: DVec3) -> usize {
    let sizes = direction.abs().to_array();
    (0..3).fold(0, |best, axis| if sizes[axis] > sizes[best] { axis } else { best })
}

/// The surface over one cell, in the order of a beam's axes.
#[derive(Clone, Copy, Debug)]
struct CellShape {
    centre: [f64; 3],
    along_u: [f64; 3],
    along_v: [f64; 3],
    error: [f64; 3],
}

impl CellShape {
    #[inline(always)]
    fn new(cells: &Patches<f64>, axes: [usize; 3], lane: usize) -> Self {
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

/// Up to [`LANES`] single rays with the same axis k.
#[derive(Clone, Debug)]
pub(super) struct BeamLanes {
    axes: [usize; 3],
    origin: [Lanes<f64>; 3],
    direction: [Lanes<f64>; 3],
}

impl BeamLanes {
    /// `None` if the rays have different axes k.
    pub fn new(rays: &[Beam]) -> Option<Self> {
        let axes = rays[0].axes;
        let lanes = |of: fn(&Beam) -> [f64; 3], axis: usize| {
            // Lanes that are not in use repeat the first ray.
            Lanes(std::array::from_fn(|lane| of(rays.get(lane).unwrap_or(&rays[0]))[axis]))
        };
        rays.iter().all(|ray| ray.axes == axes).then(|| Self {
            axes,
            origin: [0, 1, 2].map(|axis| lanes(|ray| ray.origin, axis)),
            direction: [0, 1, 2].map(|axis| lanes(|ray| ray.direction, axis)),
        })
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
    pub fn is_inside(&self) -> bool {
        let is_within = |[middle, reach]: [f64; 2]| middle.abs() + reach <= 1.0 - SLACK;
        self.is_solved && is_within(self.symbols[0]) && is_within(self.symbols[1])
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
    pub fn with_cells<S: Simd>(_: S, beam: &Beam, cells: &Patches<f64>) -> Self {
        let mut all = Self::default();
        for lane in 0..LANES {
            all.set(lane, &meeting(beam, &CellShape::new(cells, beam.axes, lane)));
        }
        all
    }

    /// Where each of `rays` may meet the cell of one lane.
    #[inline(always)]
    pub fn with_rays<S: Simd>(_: S, rays: &BeamLanes, cells: &Patches<f64>, lane: usize) -> Self {
        let shape = CellShape::new(cells, rays.axes, lane);
        let mut all = Self::default();
        for lane in 0..LANES {
            all.set(lane, &meeting(&rays.lane(lane), &shape));
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
            symbols: self.symbols.each_ref().map(|ends| [ends[0][lane], ends[1][lane]]),
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

/// Where the rays of a beam may meet a cell. The code has no branches after it is optimized, so
/// that a loop over lanes becomes vector instructions.
#[inline(always)]
fn meeting(beam: &Beam, cell: &CellShape) -> Meeting {
    let (f, g) = (plane_function(beam, cell, 0), plane_function(beam, cell, 1));
    let is_missed = f.is_beyond() || g.is_beyond();
    let determinant = f.a * g.b - g.a * f.b;
    let inverse = 1.0 / determinant;
    let (f_error, g_error) = (f.error + SLACK * f.size, g.error + SLACK * g.size);
    let u = (f.b * g.c - g.b * f.c) * inverse;
    let v = (g.a * f.c - f.a * g.c) * inverse;
    let u_reach = (g.b.abs() * f_error + f.b.abs() * g_error) * inverse.abs();
    let v_reach = (g.a.abs() * f_error + f.a.abs() * g_error) * inverse.abs();
    let u_reach = u_reach * (1.0 + SLACK) + SLACK * (1.0 + u.abs());
    let v_reach = v_reach * (1.0 + SLACK) + SLACK * (1.0 + v.abs());
    let is_solved =
        determinant.abs() > LEAST_DETERMINANT && u_reach < f64::INFINITY && v_reach < f64::INFINITY;
    let (u, u_reach) = (if is_solved { u } else { 0.0 }, if is_solved { u_reach } else { 1.0 });
    let (v, v_reach) = (if is_solved { v } else { 0.0 }, if is_solved { v_reach } else { 1.0 });
    let (u_low, u_high) = (larger(u - u_reach, -1.0), smaller(u + u_reach, 1.0));
    let (v_low, v_high) = (larger(v - v_reach, -1.0), smaller(v + v_reach, 1.0));
    let is_outside = u_low > u_high || v_low > v_high;
    let (u_middle, u_half) = (0.5 * (u_low + u_high), 0.5 * (u_high - u_low));
    let (v_middle, v_half) = (0.5 * (v_low + v_high), 0.5 * (v_high - v_low));
    let along =
        cell.centre[2] - beam.origin[2] + cell.along_u[2] * u_middle + cell.along_v[2] * v_middle;
    let reach =
        cell.along_u[2].abs() * u_half + cell.along_v[2].abs() * v_half + spread(beam, cell, 2)[0];
    let t = along / beam.direction[2];
    let wide = (reach + UNDERFLOW) / beam.direction[2].abs();
    let wide = wide + SLACK * (t.abs() + wide);
    // Also false for NaN.
    let is_known = t - wide <= t + wide;
    Meeting {
        is_possible: !(is_missed || is_outside),
        is_solved,
        symbols: [[u, u_reach], [v, v_reach]],
        t: [
            if is_known { t - wide } else { f64::NEG_INFINITY },
            if is_known { t + wide } else { f64::INFINITY },
        ],
    }
}

#[cfg(test)]
mod tests;
