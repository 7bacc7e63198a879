//! Volume and moments of a solid, between two bounds.
//!
//! Boxes are halved. A box is inside of the solid, outside, or cut by its boundary. In a cut box,
//! the function lies between two linear functions ([`Strip`]), so the solid's part of the box lies
//! between two polyhedra. Their difference falls with the square of a box's size, as its share of
//! the volume.

use crate::clip::{Moments, Strip, clip, cube};
use crate::wall::{Wall, Walls, sides, strip};
use glam::DVec3;
use rayon::prelude::*;
use zeroset_eval::{Boxes, ContractTiles, Enclose, Enclosures, Kernel, KernelError, LANES, Planes};
use zeroset_interval::Interval;
use zeroset_scene::program::Program;
use zeroset_space::{Cell, Region, tiles_of};

/// Bound of rounding errors: of a part's integrals relative to the integrals over the whole box,
/// and of coordinates and function values in a box.
const ROUNDING: f64 = 1e-13;
/// Largest number of cut boxes.
const MOST_BOXES: usize = 1_000_000;
/// Largest number of cut boxes that are halved for the solid's ends.
const MOST_AT_ENDS: usize = 50_000;
/// Number of cut boxes after which thin walls are looked for.
const WALLS_AFTER: usize = 16_384;
/// Walls are looked for in one of this many boxes.
const SAMPLED: usize = 64;
/// Space at the ends of a wall's box, as a share of the wall's extent.
const SPARE: f64 = 1e-3;
/// A wall's box is made smaller if its extent becomes smaller by this factor.
const SNUG: f64 = 0.9;
/// Number of parts of a halved box that are assumed to be cut, so that a limit on boxes is kept.
const CUT_PARTS: usize = 4;

/// The kernels of one solid.
pub struct SolidKernels<'a> {
    /// Tells where the function is negative, positive and defined.
    pub bounds: &'a dyn Kernel<Enclose, f64>,
    /// Approximates the function.
    pub tiles: &'a dyn Kernel<ContractTiles, f64>,
    /// True if the solid holds all points at which the function is 0, false if it holds none.
    /// `None` if neither is known. The function may be 0 in whole boxes.
    pub holds_zeros: Option<bool>,
    /// The program and the number of the surface, in which thin walls are found.
    source: (&'a Program, usize),
}

impl<'a> SolidKernels<'a> {
    /// The kernels of a program's surface.
    ///
    /// # Errors
    /// If a kernel is not available.
    ///
    /// # Panics
    /// If there is no such surface.
    pub fn of(program: &'a Program, surface: usize) -> Result<Self, KernelError> {
        let kernels = program.kernels::<f64>(surface);
        let (bounds, tiles) = (kernels.bounds()?, kernels.tiles()?);
        let (holds_zeros, source) = (program.holds_zeros(surface), (program, surface));
        Ok(Self { bounds, tiles, holds_zeros, source })
    }
}

/// Integrals over a solid, and its bounding box, each between two bounds.
#[derive(Clone, Copy, Debug)]
pub struct Solid {
    /// The volume.
    pub volume: Interval,
    /// The point from which the coordinates below are measured.
    pub origin: DVec3,
    /// The integrals of coordinates.
    pub first: [Interval; 3],
    /// The integrals of x², y² and z².
    pub squares: [Interval; 3],
    /// The integrals of y·z, z·x and x·y.
    pub products: [Interval; 3],
    /// The least coordinates, if the solid has a proven point.
    pub low: Option<[Interval; 3]>,
    /// The greatest coordinates.
    pub high: Option<[Interval; 3]>,
    /// Number of boxes that the boundary may cut.
    pub boxes: usize,
    /// The reason why the volume's bounds are wider than requested. `None` if they are not.
    pub limit: Option<Limit>,
}

/// A reason why bounds are wider than requested.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Limit {
    /// Narrower bounds take more boxes than allowed.
    Boxes,
    /// Rounding errors alone are wider.
    Rounding,
}

/// A solid's part of a box, and whether the boundary may cut it. `None` if it is empty.
type Found = Option<(Part, bool)>;

/// A solid's part of a box.
#[derive(Clone, Copy)]
struct Part {
    /// The box.
    cell: Cell,
    /// The axis along which the part is a wall's thickness. The box is then halved along the other
    /// axes only.
    axis: Option<usize>,
    /// Lower and upper bounds of the integrals over the part.
    moments: [Moments; 2],
    /// The corners of a box whose sides the part is proven to reach. `None` if no point is proven.
    inner: Option<[DVec3; 2]>,
    /// The corners of a box around the part.
    outer: [DVec3; 2],
    /// Bounds of the integrals' sizes over the whole box.
    size: Moments,
}

impl Part {
    fn width(&self) -> f64 {
        self.moments[1].volume - self.moments[0].volume
    }

    /// The boxes whose parts make up this one. `None` if the box is too small to be halved.
    fn halves(&self) -> Option<impl Iterator<Item = Cell> + use<>> {
        let (cell, axis) = (self.cell, self.axis);
        let is_proper = cell.parts().all(|half| (0..3).all(|axis| half.extent(axis) > 0.0));
        let halves = cell.parts().filter_map(move |mut half| {
            if let Some(k) = axis {
                if half.low[k] > cell.low[k] {
                    return None;
                }
                half.high[k] = cell.high[k];
            }
            Some(half)
        });
        is_proper.then_some(halves)
    }

    /// The box without the ends along the axis that are proven not to hold the wall. `None` if it
    /// is not much smaller.
    fn snug(&self) -> Option<Cell> {
        let k = self.axis?;
        let [low, high] = self.outer.map(|corner| corner[k]);
        let spare = SPARE * (high - low) + 1e3 * f64::EPSILON * low.abs().max(high.abs());
        let mut snug = self.cell;
        snug.low[k] = snug.low[k].max(low - spare);
        snug.high[k] = snug.high[k].min(high + spare);
        (snug.extent(k) < SNUG * self.cell.extent(k) && snug.extent(k) > 0.0).then_some(snug)
    }
}

/// Measures a solid in a region. The width of the volume's bounds is at most `relative` times the
/// lower bound, unless a [`Limit`] is given. Boxes are also halved to bound the solid's ends, if
/// `has_ends`. Returns `None` once `wanted` returns false.
pub fn solid(
    kernels: &SolidKernels<'_>,
    region: &Region,
    relative: f64,
    has_ends: bool,
    wanted: &(dyn Fn() -> bool + Sync),
) -> Option<Solid> {
    let whole = Cell { low: region.low().into(), high: region.high().into() };
    let middle = DVec3::from_array(whole.centre());
    let mut sums = Sums::default();
    let mut cut: Vec<Part> = Vec::new();
    // No box extends to both sides of the middle, so coordinates have one sign in each.
    let mut fresh: Vec<Cell> = whole.parts().collect();
    // Most solids are done before it is worth to look for walls.
    let (mut walls, mut has_looked) = (None, false);
    loop {
        let parts: Option<Vec<Vec<Found>>> = fresh
            .par_chunks(LANES)
            .map(|cells| {
                let find =
                    |cells: &[Cell]| parts_of(kernels, walls.as_ref(), region, cells, middle);
                wanted().then(|| snug_parts(cells, &find))
            })
            .collect();
        fresh.clear();
        for (part, is_cut) in parts?.into_iter().flatten().flatten() {
            if is_cut {
                cut.push(part);
            } else {
                sums.add(&part);
            }
        }
        let mut all = sums;
        for part in &cut {
            all.add(part);
        }
        let [least, most] = all.moments.map(|moments| moments.volume);
        // A volume that may be 0 has no narrow bounds.
        let is_wide = most - least > relative * least.max(0.0);
        let goal = if least > 0.0 { relative * least } else { relative.min(1.0) * most };
        if is_wide && !has_looked && cut.len() > WALLS_AFTER {
            has_looked = true;
            let some: Vec<Cell> = cut.iter().step_by(SAMPLED).map(|part| part.cell).collect();
            let (program, surface) = kernels.source;
            // Without walls, bounds are only wider.
            walls = Walls::of(program, surface, &some).ok().flatten();
            if walls.is_some() {
                // Boxes of walls are long, so all is divided anew.
                (sums, fresh) = (Sums::default(), whole.parts().collect());
                cut.clear();
                continue;
            }
        }
        let room = MOST_BOXES.saturating_sub(cut.len()) / CUT_PARTS;
        let halved: Vec<Part> = if is_wide {
            // The widest parts are halved. Others are kept while their widths add up to at most
            // half of the goal.
            cut.sort_by(|a, b| a.width().total_cmp(&b.width()));
            let mut left = 0.0;
            let kept = cut.iter().take_while(|part| {
                left += part.width();
                left <= 0.5 * goal
            });
            let kept = kept.count().max(cut.len().saturating_sub(room));
            cut.split_off(kept)
        } else if has_ends {
            let is_at_end = |part: &mut Part| all.is_at_end(part, relative);
            let halved: Vec<Part> = cut.extract_if(.., is_at_end).collect();
            if halved.len() > MOST_AT_ENDS.min(room) {
                cut.extend(halved);
                Vec::new()
            } else {
                halved
            }
        } else {
            Vec::new()
        };
        if halved.is_empty() {
            let mut solid = all.solid(middle, cut.len());
            let Interval { lo, hi } = solid.volume;
            // Bounds are rounded after they are compared with the goal.
            solid.limit = if is_wide {
                Some(Limit::Boxes)
            } else if most > 0.0 && hi - lo > 1.01 * relative * lo {
                Some(Limit::Rounding)
            } else {
                None
            };
            return Some(solid);
        }
        for part in halved {
            match part.halves() {
                Some(halves) => fresh.extend(halves),
                None => sums.add(&part),
            }
        }
    }
}

/// The parts that are found of up to sixteen boxes. A box that holds a wall is made smaller first.
fn snug_parts(cells: &[Cell], find: &dyn Fn(&[Cell]) -> Vec<Found>) -> Vec<Found> {
    let mut found = find(cells);
    let snug = |lane: usize| Some((lane, found[lane].as_ref()?.0.snug()?));
    let (lanes, snug): (Vec<usize>, Vec<Cell>) = (0..cells.len()).filter_map(snug).unzip();
    if !snug.is_empty() {
        for (lane, part) in lanes.into_iter().zip(find(&snug)) {
            found[lane] = part;
        }
    }
    found
}

/// The solid's parts of up to sixteen boxes.
fn parts_of(
    kernels: &SolidKernels<'_>,
    walls: Option<&Walls>,
    region: &Region,
    cells: &[Cell],
    origin: DVec3,
) -> Vec<Found> {
    let boxes: Vec<[Interval; 3]> = cells.iter().map(sides).collect();
    let mut bounds = Enclosures::<f64>::default();
    kernels.bounds.eval(&Boxes::around(&boxes)[0], &mut bounds);
    let is = |mask: u16, lane: usize| mask >> lane & 1 == 1;
    let (may_hold, may_lack) =
        (kernels.holds_zeros != Some(false), kernels.holds_zeros != Some(true));
    let is_positive =
        |lane: usize| bounds.neg_lo[lane] < 0.0 || bounds.neg_lo[lane] <= 0.0 && !may_hold;
    let is_negative = |lane: usize| bounds.hi[lane] < 0.0 || bounds.hi[lane] <= 0.0 && !may_lack;
    let is_outside = |lane: usize| is_positive(lane) || is(bounds.nowhere, lane);
    let is_inside = |lane: usize| is_negative(lane) && is(bounds.defined, lane);
    let mut planes = Planes::<f64>::default();
    let mut in_boxes = Vec::new();
    if (0..cells.len()).any(|lane| !is_outside(lane) && !is_inside(lane)) {
        kernels.tiles.eval(&tiles_of(cells), &mut planes);
        in_boxes = walls.map_or_else(Vec::new, |walls| walls.in_boxes(cells, &boxes));
    }
    let part = |(lane, cell): (usize, &Cell)| {
        if is_outside(lane) {
            return None;
        }
        let frame = Frame::of(cell, origin);
        let mut strips = cuts(region, &frame)?;
        let is_whole = strips.is_empty();
        // Bounds of a function state nothing about points where it is undefined.
        let is_defined = is(bounds.defined, lane);
        let mut wall = None;
        if is_inside(lane) {
            return frame.part(cell, &strips, is_defined, None);
        }
        if let Some(in_box) = in_boxes.get(lane).and_then(Option::as_ref) {
            strips.extend(in_box.strips.iter().map(|strip| frame.rounded(*strip)));
            wall = in_box.wall.as_ref().filter(|_| is_whole && is_defined);
        } else {
            strips.push(frame.rounded(strip(&planes, lane)));
        }
        frame.part(cell, &strips, is_defined, wall)
    };
    cells.iter().enumerate().map(part).collect()
}

/// The place of a box.
struct Frame {
    middle: DVec3,
    half: DVec3,
    origin: DVec3,
    /// Rounding of a coordinate, as a share of the box.
    rounding: DVec3,
}

impl Frame {
    fn of(cell: &Cell, origin: DVec3) -> Self {
        let (low, high) = (DVec3::from_array(cell.low), DVec3::from_array(cell.high));
        let half = 0.5 * (high - low);
        let rounding =
            DVec3::splat(ROUNDING) + 8.0 * f64::EPSILON * low.abs().max(high.abs()) / half;
        Self { middle: 0.5 * (low + high), half, origin, rounding }
    }

    /// The strip with the rounding of the box's coordinates and of the strip's values. Its width is
    /// never 0, since a function that is 0 has no proven sign.
    fn rounded(&self, strip: Strip) -> Strip {
        let slack =
            strip.slope.abs().dot(self.rounding) + ROUNDING * strip.value.abs() + f64::MIN_POSITIVE;
        Strip { error: strip.error + slack, ..strip }
    }

    /// The part of the box where all functions are at most 0. It is a wall if one is given.
    fn part(&self, cell: &Cell, strips: &[Strip], is_defined: bool, wall: Option<&Wall>) -> Found {
        let mut outer = cube();
        let mut inner = if is_defined { cube() } else { Vec::new() };
        let mut is_cut = !is_defined;
        for strip in strips {
            let (least, most) = strip.bounds();
            if most <= 0.0 {
                continue;
            }
            if least > 0.0 {
                return None;
            }
            // Also if the bounds are not finite.
            is_cut = true;
            if !(least.is_finite() && most.is_finite()) {
                inner.clear();
                continue;
            }
            outer = clip(&outer, strip, -strip.error);
            inner = clip(&inner, strip, strip.error);
        }
        if outer.is_empty() {
            return None;
        }
        let all = if is_cut { Moments::of(&outer) } else { Moments::CUBE };
        let sure = if is_cut { Moments::of(&inner) } else { Moments::CUBE };
        let moved = |moments: Moments| moments.moved(self.middle - self.origin, self.half);
        let hull = |tetrahedra: &[[DVec3; 4]]| {
            let corners = tetrahedra.as_flattened();
            let low = corners.iter().copied().reduce(DVec3::min)?;
            let high = corners.iter().copied().reduce(DVec3::max)?;
            Some([low, high].map(|corner| self.middle + self.half * corner))
        };
        // In one box, each coordinate and each product has one sign. So the integrals over the part
        // are between those over the two polyhedra.
        let mut part = Part {
            cell: *cell,
            axis: None,
            moments: Moments::ordered([sure, all].map(moved)),
            inner: hull(&inner),
            outer: hull(&outer)?,
            size: Moments::most((self.middle - self.origin).abs() + self.half, self.half),
        };
        if let Some(wall) = wall {
            self.narrow(&mut part, wall);
        }
        Some((part, is_cut))
    }

    /// Narrows the bounds of a part that is a wall.
    fn narrow(&self, part: &mut Part, wall: &Wall) {
        let axis = wall.axis();
        let (strip, slope) = (self.rounded(wall.strip), self.rounded(wall.slope));
        let Some(volume) = wall.volume(strip, slope) else { return };
        part.axis = wall.is_thin(self.half).then_some(axis);
        // The box's extents are rounded.
        let slack = 4.0 * self.rounding.element_sum();
        let scale = self.half.element_product();
        let lo = (scale * volume.lo * (1.0 - slack)).max(part.moments[0].volume);
        let hi = (scale * volume.hi * (1.0 + slack)).min(part.moments[1].volume);
        let Some(volume) = Interval::new(lo, hi) else { return };
        let range = |axis: usize| {
            let [one, other] = part.outer.map(|corner| corner[axis] - self.origin[axis]);
            Interval { lo: one, hi: other }
        };
        let [x, y, z] = [0, 1, 2].map(range);
        part.moments = Moments::within(part.moments, volume, [x, y, z]);
        if part.inner.is_none() && lo > 0.0 {
            // There is a point of the solid in the outer box, but its place is not known.
            part.inner = Some([part.outer[1], part.outer[0]]);
        }
    }
}

/// The region's plane and ball in a box, as far as they cut it. `None` if the box is proven to lie
/// outside of the region.
fn cuts(region: &Region, frame: &Frame) -> Option<Vec<Strip>> {
    let &Frame { middle, half, .. } = frame;
    let mut strips = Vec::new();
    if let Some(plane) = region.clip() {
        let slope = plane.normal * half;
        let value = plane.normal.dot(middle) - plane.offset;
        let size = plane.normal.abs().dot(middle.abs()) + plane.offset.abs();
        strips.push(frame.rounded(Strip { value, slope, error: ROUNDING * size }));
    }
    if let Some(ball) = region.ball() {
        let way = middle - ball.centre;
        // The squares of the distance from the middle are between 0 and this.
        let bend = half.length_squared();
        let square = ball.radius * ball.radius;
        let value = way.length_squared() - square + 0.5 * bend;
        let size = (middle.abs() + ball.centre.abs()).length_squared() + square + bend;
        let error = 0.5 * bend + ROUNDING * size;
        strips.push(frame.rounded(Strip { value, slope: 2.0 * way * half, error }));
    }
    strips.retain(|strip| {
        let (_, most) = strip.bounds();
        most > 0.0 || most.is_nan()
    });
    let is_outside = strips.iter().any(|strip| strip.bounds().0 > 0.0);
    (!is_outside).then_some(strips)
}

/// Sums over parts.
#[derive(Clone, Copy, Default)]
struct Sums {
    moments: [Moments; 2],
    inner: Option<[DVec3; 2]>,
    outer: Option<[DVec3; 2]>,
    /// Number of parts, and the integrals' sizes, for their rounding.
    count: usize,
    size: Moments,
}

impl Sums {
    /// Adds the integrals over a part, and extends the ends of the solid to it.
    fn add(&mut self, part: &Part) {
        self.moments[0].add(&part.moments[0]);
        self.moments[1].add(&part.moments[1]);
        self.size.add(&part.size);
        let around = |all: Option<[DVec3; 2]>, new: [DVec3; 2]| {
            Some(all.map_or(new, |[low, high]| [low.min(new[0]), high.max(new[1])]))
        };
        self.outer = around(self.outer, part.outer);
        if let Some(inner) = part.inner {
            self.inner = around(self.inner, inner);
        }
        self.count += 1;
    }

    /// Returns whether halving a part may improve the bounds of the solid's ends. The part may
    /// extend the solid by more than `share` of its extent, and its box is longer than that.
    fn is_at_end(&self, part: &Part, share: f64) -> bool {
        let Some([low, high]) = self.inner else { return false };
        (0..3).any(|axis| {
            let least = share * (high[axis] - low[axis]);
            let beyond = |way: f64| way > least && part.cell.extent(axis) > least;
            beyond(low[axis] - part.outer[0][axis]) || beyond(part.outer[1][axis] - high[axis])
        })
    }

    /// The enclosures of a solid's measures. Each is widened by the rounding errors of its sum.
    fn solid(&self, origin: DVec3, boxes: usize) -> Solid {
        let share = ROUNDING + 2.0 * f64::EPSILON * self.count as f64;
        let [least, most] = self.moments;
        let wide = |low: f64, high: f64, size: f64| Interval {
            lo: (low - share * size).next_down(),
            hi: (high + share * size).next_up(),
        };
        let each = |low: DVec3, high: DVec3, size: DVec3| {
            [0, 1, 2].map(|axis| wide(low[axis], high[axis], size[axis]))
        };
        let volume = wide(least.volume, most.volume, self.size.volume);
        let ends = |end: usize| {
            let (outer, inner) = (self.outer?, self.inner?);
            Some([0, 1, 2].map(|axis| {
                let (one, other) = (outer[end][axis], inner[end][axis]);
                let size = outer[0][axis].abs().max(outer[1][axis].abs());
                wide(one.min(other), one.max(other), size)
            }))
        };
        Solid {
            volume: Interval { lo: volume.lo.max(0.0), ..volume },
            origin,
            first: each(least.first, most.first, self.size.first),
            squares: each(least.squares, most.squares, self.size.squares),
            products: each(least.products, most.products, self.size.products),
            low: ends(0),
            high: ends(1),
            boxes,
            limit: None,
        }
    }
}

/// The centroid and the moments of inertia of a solid of density 1.
#[derive(Clone, Copy, Debug)]
pub struct Inertia {
    /// The centroid's coordinates.
    pub centroid: [Interval; 3],
    /// The moments of inertia about the axes through the centroid along x, y and z: the diagonal of
    /// the tensor.
    pub moments: [Interval; 3],
    /// The integrals of y·z, z·x and x·y, measured from the centroid: negated, the other entries of
    /// the tensor.
    pub products: [Interval; 3],
}

impl Solid {
    /// The centroid and the moments of inertia, or `None` if the volume may be 0.
    pub fn inertia(&self) -> Option<Inertia> {
        let volume = self.volume;
        if !volume.is_positive() {
            return None;
        }
        // From the origin of the integrals.
        let mean = self.first.map(|first| first.over(volume));
        let about_mean = |integral: Interval, one: usize, other: usize| {
            integral.plus(mean[one].times(self.first[other]).negated())
        };
        let squares = [0, 1, 2].map(|axis| {
            let square = about_mean(self.squares[axis], axis, axis);
            Interval { lo: square.lo.max(0.0), hi: square.hi }
        });
        let others = |axis: usize| ((axis + 1) % 3, (axis + 2) % 3);
        Some(Inertia {
            centroid: [0, 1, 2].map(|axis| {
                let origin = Interval { lo: self.origin[axis], hi: self.origin[axis] };
                mean[axis].plus(origin)
            }),
            moments: [0, 1, 2].map(|axis| {
                let (one, other) = others(axis);
                squares[one].plus(squares[other])
            }),
            products: [0, 1, 2].map(|axis| {
                let (one, other) = others(axis);
                about_mean(self.products[axis], one, other)
            }),
        })
    }
}
