//! Thin walls: the parts of a solid between two levels of one function.
//!
//! Where p rises along an axis, −τ ≤ p ≤ 0 holds on one segment of each line along it. The integral
//! of the slope ∂p over the wall is the integral over these segments' lengths in values of p: τ for
//! each line that crosses the whole wall. So the volume is known as well as the slope is, however
//! thin the wall is. `docs/measures.md` has the argument.

use crate::clip::{Moments, Strip, clip, cube};
use glam::DVec3;
use zeroset_eval::{
    Boxes, ContractTiles, Enclose, Enclosures, GradientEnclosures, Kernel, KernelError, LANES,
    Planes,
};
use zeroset_interval::Interval;
use zeroset_scene::choices::{Choice, Choices};
use zeroset_scene::program::{Program, ProgramError};
use zeroset_space::{Cell, Region, tiles_of};

/// Largest number of parts of a function with walls. Each costs an evaluation for each box.
const MOST_PARTS: usize = 32;
/// The slope may differ by this factor within a box.
const MOST_SLOPES: f64 = 4.0;
/// Half the width of a box of a thin wall is at least this share of the wall's thickness.
const LEAST_WIDTH: f64 = 0.25;
/// Number of boxes, as one of all, that hold both faces of a wall if the wall is thin.
const LEAST_SHARE: usize = 4;
/// Bound of rounding errors of polyhedra in a cube, and of functions relative to their values.
const ROUNDING: f64 = 1e-13;

/// A function as a choice of parts, some of which are levels of one function.
pub struct Walls {
    choices: Choices,
    /// For each part that is a face of a wall, its partial derivatives.
    slopes: Vec<Option<Program>>,
}

/// The functions that bound a solid in one box.
pub struct InBox {
    /// The solid is where all of these are at most 0.
    pub strips: Vec<Strip>,
    /// The solid is a wall, and nothing else.
    pub wall: Option<Wall>,
}

/// The set −τ ≤ p ≤ 0 in a box.
#[derive(Clone, Debug)]
pub struct Wall {
    axis: usize,
    thickness: Interval,
    /// The function p.
    pub strip: Strip,
    /// Its derivative along the axis, in the cube's coordinates.
    pub slope: Strip,
}

/// A choice in a box.
enum Reduced {
    Inside,
    Outside,
    /// The greatest of these parts.
    Greatest(Vec<usize>),
    Unknown,
}

impl Walls {
    /// The walls of a surface. `None` without walls, with too many parts, or if few of these boxes
    /// hold both faces of a wall.
    ///
    /// # Errors
    /// If a part is too large, or a kernel is not available.
    pub fn of(
        program: &Program,
        surface: usize,
        cells: &[Cell],
    ) -> Result<Option<Self>, ProgramError> {
        // The region's plane and ball are no parts.
        let unit = Region::new(DVec3::ZERO, DVec3::ONE).expect("a box");
        let choices = program.choices(surface, &unit)?;
        let count = choices.parts.roots().len();
        let mut is_face = vec![false; count];
        for (one, other) in (0..count).flat_map(|k| (0..k).map(move |i| (i, k))) {
            if is_wall(&choices, one, other) {
                is_face[one] = true;
            }
        }
        if count > MOST_PARTS || !is_face.contains(&true) {
            return Ok(None);
        }
        let mut walls = 0;
        for some in cells.chunks(LANES) {
            let boxes: Vec<[Interval; 3]> = some.iter().map(sides).collect();
            let values: Result<Vec<_>, KernelError> = (0..count)
                .map(|part| Ok(enclosures(choices.parts.kernels::<f64>(part).bounds()?, &boxes)))
                .collect();
            let values = values?;
            let is_held = |lane: &usize| {
                let parts = reduced(&choices.choice, &|part| value(&values[part], *lane));
                matches!(parts, Reduced::Greatest(parts)
                    if matches!(parts[..], [one, other] if is_wall(&choices, one, other)))
            };
            walls += (0..some.len()).filter(is_held).count();
        }
        if LEAST_SHARE * walls < cells.len() {
            return Ok(None);
        }
        for part in 0..count {
            choices.parts.kernels::<f64>(part).tiles()?;
        }
        let mut slopes = Vec::new();
        for (part, is_face) in is_face.into_iter().enumerate() {
            slopes.push(if is_face {
                choices.parts.kernels::<f64>(part).gradient_bounds()?;
                let slopes = choices.parts.slopes(part)?;
                for axis in 0..3 {
                    let kernels = slopes.kernels::<f64>(axis);
                    kernels.bounds()?;
                    kernels.tiles()?;
                }
                Some(slopes)
            } else {
                None
            });
        }
        Ok(Some(Self { choices, slopes }))
    }

    /// The functions that bound the solid in each of up to sixteen boxes. `None` if the solid is
    /// not an intersection there.
    pub fn in_boxes(&self, cells: &[Cell], boxes: &[[Interval; 3]]) -> Vec<Option<InBox>> {
        self.try_in_boxes(cells, boxes).unwrap_or_default()
    }

    fn try_in_boxes(&self, cells: &[Cell], boxes: &[[Interval; 3]]) -> Option<Vec<Option<InBox>>> {
        let parts = self.slopes.len();
        let mut values = Vec::new();
        for part in 0..parts {
            let found = enclosures(self.choices.parts.kernels::<f64>(part).bounds().ok()?, boxes);
            values.push(found);
        }
        let parts_of = |lane: usize| {
            match reduced(&self.choices.choice, &|part| value(&values[part], lane)) {
                Reduced::Greatest(mut parts) => {
                    // The slopes of a wall's first face are known.
                    parts.sort_unstable();
                    parts.dedup();
                    Some(parts)
                }
                // The kernel of the whole function decides about boxes without a face.
                Reduced::Inside | Reduced::Outside | Reduced::Unknown => None,
            }
        };
        let lanes: Vec<Option<Vec<usize>>> = (0..cells.len()).map(parts_of).collect();
        let mut planes = vec![None; parts];
        for part in lanes.iter().flatten().flatten() {
            if planes[*part].is_none() {
                let tiles = self.choices.parts.kernels::<f64>(*part).tiles().ok()?;
                planes[*part] = Some(approximated(tiles, cells));
            }
        }
        let strip = |part: usize, lane: usize| planes[part].as_ref().map(|all| strip(all, lane));
        let mut found: Vec<Option<InBox>> = Vec::new();
        for (lane, parts) in lanes.iter().enumerate() {
            found.push(parts.as_ref().and_then(|parts| {
                let strips = parts.iter().map(|part| strip(*part, lane)).collect::<Option<_>>()?;
                Some(InBox { strips, wall: None })
            }));
        }
        for part in 0..parts {
            let other = |lane: &Vec<usize>| match lane[..] {
                [one, other] if one == part && is_wall(&self.choices, one, other) => Some(other),
                _ => None,
            };
            let others: Vec<Option<usize>> =
                lanes.iter().map(|lane| lane.as_ref().and_then(other)).collect();
            if others.iter().any(Option::is_some) {
                self.find_walls(part, &others, cells, boxes, &mut found)?;
            }
        }
        Some(found)
    }

    /// Finds the walls between a part and other ones.
    fn find_walls(
        &self,
        part: usize,
        others: &[Option<usize>],
        cells: &[Cell],
        boxes: &[[Interval; 3]],
        found: &mut [Option<InBox>],
    ) -> Option<()> {
        let kernels = self.choices.parts.kernels::<f64>(part);
        let mut gradients = GradientEnclosures::<f64>::default();
        kernels.gradient_bounds().ok()?.eval(&Boxes::around(boxes)[0], &mut gradients);
        // The values at one point of each box tell the levels' distance.
        let point = |cell: &Cell| cell.centre().map(|at| Interval { lo: at, hi: at });
        let centres: Vec<[Interval; 3]> = cells.iter().map(point).collect();
        let here = enclosures(kernels.bounds().ok()?, &centres);
        let slopes = self.slopes[part].as_ref()?;
        let mut along: [Option<(Enclosures<f64>, Planes<f64>)>; 3] = [const { None }; 3];
        let mut beyond: Option<(usize, Enclosures<f64>)> = None;
        for (lane, in_box) in found.iter_mut().enumerate() {
            let (Some(other), Some(in_box)) = (others[lane], in_box) else { continue };
            let is = |mask: u16| mask >> lane & 1 == 1;
            let strip = in_box.strips[0];
            let steepness = strip.slope.abs().to_array();
            let by_steepness = |a: &usize, b: &usize| steepness[*a].total_cmp(&steepness[*b]);
            let axis = (0..3).max_by(by_steepness).unwrap_or_default();
            if beyond.as_ref().is_none_or(|(known, _)| *known != other) {
                let bounds = self.choices.parts.kernels::<f64>(other).bounds().ok()?;
                beyond = Some((other, enclosures(bounds, &centres)));
            }
            let Some((_, there)) = &beyond else { continue };
            if !(is(gradients.lipschitz) && is(here.defined) && is(there.defined)) {
                continue;
            }
            // The other part is q = (p + τ)·(its factor / p's factor).
            let factor = |part: usize| {
                let factor = self.choices.levels[part].factor;
                Interval { lo: factor.next_down(), hi: factor.next_up() }
            };
            let sum = value(there, lane).times(factor(part)).over(factor(other));
            let thickness = sum.plus(value(&here, lane).negated());
            if along[axis].is_none() {
                let kernels = slopes.kernels::<f64>(axis);
                let bounds = enclosures(kernels.bounds().ok()?, boxes);
                along[axis] = Some((bounds, approximated(kernels.tiles().ok()?, cells)));
            }
            let Some((bounds, planes)) = &along[axis] else { continue };
            let slope = self::strip(planes, lane);
            let is_known = is(bounds.defined) && is(bounds.continuous);
            if !is_known || thickness.lo <= 0.0 || !thickness.is_bounded() {
                continue;
            }
            let half = 0.5 * cells[lane].extent(axis);
            let slope = Strip {
                value: half * slope.value,
                slope: half * slope.slope,
                error: (half * slope.error).next_up(),
            };
            in_box.wall = Some(Wall { axis, thickness, strip, slope });
        }
        Some(())
    }
}

/// Returns whether two parts are levels of one function, and the set in which both are at most 0
/// lies between them.
fn is_wall(choices: &Choices, one: usize, other: usize) -> bool {
    let [one, other] = [one, other].map(|part| choices.levels[part]);
    one.group == other.group && (one.factor < 0.0) != (other.factor < 0.0)
}

/// The bounds of a function in up to sixteen boxes.
pub fn enclosures(kernel: &dyn Kernel<Enclose, f64>, boxes: &[[Interval; 3]]) -> Enclosures<f64> {
    let mut found = Enclosures::default();
    kernel.eval(&Boxes::around(boxes)[0], &mut found);
    found
}

/// The linear approximations of a function in up to sixteen boxes.
pub fn approximated(kernel: &dyn Kernel<ContractTiles, f64>, cells: &[Cell]) -> Planes<f64> {
    let mut found = Planes::default();
    kernel.eval(&tiles_of(cells), &mut found);
    found
}

/// The bounds in one box.
pub fn value(bounds: &Enclosures<f64>, lane: usize) -> Interval {
    Interval { lo: -bounds.neg_lo[lane], hi: bounds.hi[lane] }
}

/// The sides of a box.
pub fn sides(cell: &Cell) -> [Interval; 3] {
    [0, 1, 2].map(|axis| Interval { lo: cell.low[axis], hi: cell.high[axis] })
}

/// The linear approximation in one box.
pub fn strip(planes: &Planes<f64>, lane: usize) -> Strip {
    Strip {
        value: planes.value[lane],
        slope: DVec3::from_array(planes.slope.map(|slope| slope[lane])),
        error: planes.error[lane],
    }
}

/// A choice in a box in which the parts have these values.
fn reduced(choice: &Choice, value: &dyn Fn(usize) -> Interval) -> Reduced {
    let by_sign = |value: Interval, otherwise: Reduced| {
        if value.hi < 0.0 {
            Reduced::Inside
        } else if value.lo > 0.0 {
            Reduced::Outside
        } else {
            otherwise
        }
    };
    match choice {
        Choice::Part(part) => by_sign(value(*part), Reduced::Greatest(vec![*part])),
        // The set in which a part and its opposite are at most 0 is thin, but it may not be empty.
        Choice::Opposite(part) => {
            let Interval { lo, hi } = value(*part);
            by_sign(Interval { lo: -hi, hi: -lo }, Reduced::Unknown)
        }
        Choice::Max(all) => {
            let (mut parts, mut is_known) = (Vec::new(), true);
            for one in all {
                match reduced(one, value) {
                    Reduced::Inside => {}
                    Reduced::Outside => return Reduced::Outside,
                    Reduced::Greatest(inner) => parts.extend(inner),
                    Reduced::Unknown => is_known = false,
                }
            }
            match (is_known, parts.is_empty()) {
                (false, _) => Reduced::Unknown,
                (true, true) => Reduced::Inside,
                (true, false) => Reduced::Greatest(parts),
            }
        }
        Choice::Min(all) => {
            let mut found = Reduced::Outside;
            for one in all {
                match (reduced(one, value), &found) {
                    (Reduced::Inside, _) => return Reduced::Inside,
                    (Reduced::Outside, _) => {}
                    (one, Reduced::Outside) => found = one,
                    _ => found = Reduced::Unknown,
                }
            }
            found
        }
    }
}

impl Wall {
    /// The axis along which the function rises or falls.
    pub fn axis(&self) -> usize {
        self.axis
    }

    /// Returns whether the wall is thin, compared to the width of a box with these half extents.
    /// Other boxes must be halved along the axis, too.
    pub fn is_thin(&self, half: DVec3) -> bool {
        let k = self.axis;
        let width = half[(k + 1) % 3].max(half[(k + 2) % 3]);
        LEAST_WIDTH * self.thickness.hi * half[k] < width * self.strip.slope[k].abs()
    }

    /// Bounds of the volume in the cube's coordinates, for a function and its slope with rounding
    /// added. `None` if the function is not proven to rise or to fall evenly enough.
    pub fn volume(&self, mut strip: Strip, mut slope: Strip) -> Option<Interval> {
        let k = self.axis;
        if strip.slope[k] < 0.0 {
            // The cube is reflected, so that the function rises.
            strip.slope[k] = -strip.slope[k];
            slope = Strip { value: -slope.value, slope: -slope.slope, error: slope.error };
            slope.slope[k] = -slope.slope[k];
        }
        let (least, most) = slope.bounds();
        let (steep, error) = (strip.slope[k], strip.error);
        let is_even = least > 0.0 && most <= MOST_SLOPES * least;
        if !(is_even && steep + error <= MOST_SLOPES * least) {
            return None;
        }
        let thickness = self.thickness;
        let interval = |lo: f64, hi: f64| Interval { lo, hi };
        let point = |value: f64| Interval { lo: value, hi: value };
        let (least, most) = (point(least.next_down()), point(most.next_up()));
        // The integral of the slope over the wall, and its first moments: both bounds.
        let lateral = strip.slope.abs().element_sum() - steep;
        let end = steep - lateral - error;
        let is_crossed = strip.value + end >= 0.0 && strip.value - end <= -thickness.hi;
        let [lower, upper] = if is_crossed {
            let all = thickness.times(point(4.0));
            [all.lo, all.hi].map(|total| (point(total), [Interval::ZERO; 3]))
        } else {
            [-1.0, 1.0].map(|way| self.total(&strip, way))
        };
        let total = interval(lower.0.lo, upper.0.hi);
        let lengths = [point(lower.0.lo).over(most), point(upper.0.hi).over(least)];
        let simple = interval(lengths[0].lo.max(0.0), lengths[1].hi);
        // The slope is value + slope·ξ ± error. The mean of p over the wall locates it along the
        // axis. On a line that crosses the wall, the mean differs from −τ/2 as the slopes do.
        let mean_value = if is_crossed {
            thickness.times(point(-0.5)).times(least.over(most).hull(most.over(least)))
        } else {
            interval(-thickness.hi, 0.0)
        };
        let spread = mean_value.plus(interval(-error, error));
        let steep = point(steep);
        let bend = point(slope.slope[k]).over(steep);
        let mut mean = point(slope.value).plus(interval(-slope.error, slope.error));
        mean = mean.plus(bend.times(spread.plus(point(-strip.value))));
        let mut rest = total;
        let half = point(0.5);
        let doubt = half.times(lengths[1].plus(lengths[0].negated())).hi.max(0.0);
        for axis in (0..3).filter(|axis| *axis != k) {
            let middle = lower.1[axis].over(most).plus(upper.1[axis].over(least)).times(half);
            let first = middle.plus(interval(-doubt, doubt));
            let lean =
                point(slope.slope[axis]).plus(bend.times(point(strip.slope[axis])).negated());
            rest = rest.plus(lean.times(first).negated());
        }
        if mean.lo.is_nan() || mean.lo <= 0.0 {
            return Some(simple);
        }
        let second = rest.over(mean);
        let both = interval(simple.lo.max(second.lo), simple.hi.min(second.hi));
        Some(if both.lo <= both.hi { both } else { simple })
    }

    /// A bound of the integral of the slope over the wall, and of its first moments: a lower bound
    /// if `way` is −1, an upper one if it is 1. At the ends of the axis, the function is replaced
    /// by its bounds, and by a linear function between them.
    fn total(&self, strip: &Strip, way: f64) -> (Interval, [Interval; 3]) {
        let steep = strip.slope[self.axis] + way * strip.error;
        let mut bound = Strip { error: 0.0, ..*strip };
        bound.slope[self.axis] = steep;
        let slack = ROUNDING * (strip.value.abs() + strip.slope.abs().element_sum());
        let thickness = if way > 0.0 { self.thickness.hi } else { self.thickness.lo };
        let (low, high) = (-thickness - way * slack, way * slack);
        if !(steep > 0.0 && low < high) {
            return (Interval::ZERO, [Interval::ZERO; 3]);
        }
        let opposite = Strip { value: -bound.value, slope: -bound.slope, error: 0.0 };
        let moments = Moments::of(&clip(&clip(&cube(), &bound, -high), &opposite, low));
        let around = |value: f64| {
            let own = Interval { lo: value - 8.0 * ROUNDING, hi: value + 8.0 * ROUNDING };
            own.times(Interval { lo: steep, hi: steep })
        };
        (around(moments.volume), moments.first.to_array().map(around))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Number of lines along which a volume is summed, per axis.
    const LINES: usize = 120;

    /// Walls of random quadratic functions in a cube. The slope is linear, so bounds are so narrow
    /// that each term matters.
    #[test]
    fn volumes_of_quadratic_walls_are_within_bounds() {
        let mut rng = fastrand::Rng::with_seed(3);
        println!("seed 3");
        let (mut narrow, mut crossed) = (0, 0);
        for case in 0..600 {
            let mut within = |reach: f64| reach * (2.0 * rng.f64() - 1.0);
            // The axis is z: value + slope·ξ + (bend·z/2 + lean·(x, y))·z.
            let way = within(1.0).signum();
            let (value, bend) = (within(0.9), within(0.2));
            // In every other case, most lines cross the whole wall.
            let (value, tilt, lean, bend) = match case % 4 {
                1 => (0.3 * value, 0.1, 0.3, 0.0),
                3 => (0.3 * value, 0.1, 0.0, bend),
                _ => (value, 2.0, 0.05, bend),
            };
            let sides = [within(tilt), within(tilt)];
            let lean = [within(lean), within(lean)];
            let thickness = within(0.3).abs() + 1e-3;
            // The square is between 0 and 1.
            let error = 0.25 * bend.abs() + lean[0].abs() + lean[1].abs();
            let middle = value + 0.25 * bend;
            let wall = Wall {
                axis: 2,
                thickness: Interval { lo: thickness, hi: thickness },
                strip: Strip { value: middle, slope: DVec3::new(sides[0], sides[1], way), error },
                slope: Strip {
                    value: way,
                    slope: DVec3::new(lean[0], lean[1], bend),
                    error: 1e-12,
                },
            };
            let Some(bounds) = wall.volume(wall.strip, wall.slope) else { continue };
            let at = |k: usize| (2.0 * k as f64 + 1.0) / LINES as f64 - 1.0;
            let (mut volume, mut is_crossed) = (0.0, true);
            for (x, y) in (0..LINES).flat_map(|i| (0..LINES).map(move |k| (at(i), at(k)))) {
                let base = value + sides[0] * x + sides[1] * y;
                let steep = way + lean[0] * x + lean[1] * y;
                // The root of base + steep·z + bend·z²/2 = level. The function rises or falls.
                let root = |level: f64| {
                    let root = (steep * steep - 2.0 * bend * (base - level)).sqrt();
                    let z = -2.0 * (base - level) / (steep + way * root);
                    if z.is_nan() { way.copysign(way * (level - base)) } else { z.clamp(-1.0, 1.0) }
                };
                let ends = [root(0.0), root(-thickness)];
                is_crossed &= ends.iter().all(|end| end.abs() < 1.0);
                volume += (ends[0] - ends[1]).abs() * (2.0 / LINES as f64).powi(2);
            }
            // The sum over lines is not exact, above all where the wall ends.
            let near = if is_crossed { 1e-4 * volume } else { 2e-3 * volume + 2e-4 };
            crossed += usize::from(is_crossed);
            let is_in = bounds.lo - near <= volume && volume <= bounds.hi + near;
            assert!(is_in, "case {case}: {volume} {bounds:?} {wall:?}");
            narrow += usize::from(bounds.hi - bounds.lo < 0.05 * volume);
        }
        println!("{narrow} narrow, {crossed} crossed");
        assert!(narrow > 25 && crossed > 50 && crossed < 500, "{narrow} narrow, {crossed} crossed");
    }
}
