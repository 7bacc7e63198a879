//! Volume and moments of a solid, between two bounds.
//!
//! Boxes are halved. A box is inside of the solid, outside, or cut by its boundary. In a cut box,
//! the function lies between two linear functions, so the solid's part of the box lies between two
//! polyhedra. Their difference falls with the square of a box's size, as its share of the volume.

use crate::clip::Moments;
use crate::density::{Density, DensityFault};
use crate::part::{Found, Frame, Part, ROUNDING, cuts};
use crate::wall::{Walls, sides, strip};
use glam::DVec3;
use rayon::prelude::*;
use zeroset_eval::{Boxes, ContractTiles, Enclose, Enclosures, Kernel, KernelError, LANES, Planes};
use zeroset_interval::Interval;
use zeroset_scene::program::Program;
use zeroset_space::{Cell, Region, tiles_of};

/// Largest number of cut boxes.
const MOST_BOXES: usize = 1_000_000;
/// Largest number of cut boxes that are halved for the solid's ends.
const MOST_AT_ENDS: usize = 50_000;
/// Number of cut boxes after which thin walls are looked for.
const WALLS_AFTER: usize = 16_384;
/// Walls are looked for in one of this many boxes.
const SAMPLED: usize = 64;
/// Size of a box in which the density must have bounds, as a share of the region.
const LEAST_BOX: f64 = 1.0 / 65_536.0;
/// Boxes in which the density may be undefined are halved to this share of the region.
const DOUBTFUL_BOX: f64 = 1.0 / 64.0;
/// Largest number of boxes without bounds of the density.
const MOST_UNBOUNDED: usize = 16_384;
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
    /// The density that weights integrals, if it is not 1.
    density: Option<&'a Density>,
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
        Ok(Self { bounds, tiles, holds_zeros, source, density: None })
    }

    /// The same kernels, with integrals weighted by a density.
    #[must_use]
    pub fn weighted(self, density: &'a Density) -> Self {
        Self { density: Some(density), ..self }
    }
}

/// Integrals over a solid, weighted by its density, and its bounding box, each between two bounds.
#[derive(Clone, Copy, Debug)]
pub struct Solid {
    /// The volume, or with a density the mass.
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
    /// The least value that the density may have.
    pub least_density: f64,
    /// True if the density may have no value at some points. There it counts as 0.
    pub may_lack_density: bool,
    /// The reason why there is no mass. The integrals are then meaningless.
    pub fault: Option<DensityFault>,
}

/// A reason why bounds are wider than requested.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Limit {
    /// Narrower bounds take more boxes than allowed.
    Boxes,
    /// Rounding errors alone are wider.
    Rounding,
}

/// Measures a solid in a region. The width of the volume's bounds is at most `relative` times the
/// lower bound of its size, unless a [`Limit`] or a fault of the density is given. Boxes are also
/// halved to bound the solid's ends, if `has_ends`. Returns `None` once `wanted` returns false.
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
            sums.fault = sums.fault.or(part.fault);
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
        all.fault = all.fault.or_else(|| unbounded(&cut, &whole));
        if all.fault.is_some() {
            return Some(all.solid(middle, cut.len()));
        }
        let [least, most] = all.moments.map(|moments| moments.volume);
        // A volume that may be 0 has no narrow bounds.
        let sure = least.max(-most).max(0.0);
        let is_wide = most - least > relative * sure;
        let goal = if !(most - least).is_finite() {
            // Only boxes without bounds of the density are halved.
            f64::MAX
        } else if sure > 0.0 {
            relative * sure
        } else {
            relative.min(1.0) * most.max(-least)
        };
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
        let is_doubtful = |part: &mut Part| {
            !part.density.1 && part.cell.largest() > DOUBTFUL_BOX * whole.largest()
        };
        let doubtful: Vec<Part> = cut.extract_if(.., is_doubtful).collect();
        let mut halved: Vec<Part> = if is_wide {
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
        halved.extend(doubtful);
        if halved.is_empty() {
            let mut solid = all.solid(middle, cut.len());
            let Interval { lo, hi } = solid.volume;
            // Bounds are rounded after they are compared with the goal.
            solid.limit = if is_wide {
                Some(Limit::Boxes)
            } else if (least < 0.0 || most > 0.0) && hi - lo > 1.01 * relative * lo.max(-hi) {
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

/// The fault of a density that has no bounds in small boxes, or in too many.
fn unbounded(parts: &[Part], whole: &Cell) -> Option<DensityFault> {
    let mut without = parts.iter().filter(|part| !part.density.0.is_bounded());
    let least = LEAST_BOX * whole.largest();
    let last = without.clone().nth(MOST_UNBOUNDED);
    let part = last.or_else(|| without.find(|part| part.cell.largest() < least))?;
    Some(DensityFault::Unbounded(DVec3::from_array(part.cell.centre())))
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
    let weights = match kernels.density {
        Some(density) if !(0..cells.len()).all(is_outside) => density.in_boxes(cells),
        _ => Vec::new(),
    };
    let part = |(lane, cell): (usize, &Cell)| {
        if is_outside(lane) {
            return None;
        }
        let frame = Frame::of(cell, origin);
        let mut strips = cuts(region, &frame)?;
        let is_whole = strips.is_empty();
        // Bounds of a function state nothing about points where it is undefined.
        let is_defined = is(bounds.defined, lane);
        let (mut wall, weight) = (None, weights.get(lane));
        if is_inside(lane) {
            return frame.part(cell, &strips, is_defined, None, weight);
        }
        if let Some(in_box) = in_boxes.get(lane).and_then(Option::as_ref) {
            strips.extend(in_box.strips.iter().map(|strip| frame.rounded(*strip)));
            wall = in_box.wall.as_ref().filter(|_| is_whole && is_defined);
        } else {
            strips.push(frame.rounded(strip(&planes, lane)));
        }
        frame.part(cell, &strips, is_defined, wall, weight)
    };
    cells.iter().enumerate().map(part).collect()
}

/// Sums over parts.
#[derive(Clone, Copy)]
struct Sums {
    moments: [Moments; 2],
    inner: Option<[DVec3; 2]>,
    outer: Option<[DVec3; 2]>,
    /// Number of parts, and the integrals' sizes, for their rounding.
    count: usize,
    size: Moments,
    least_density: f64,
    may_lack_density: bool,
    fault: Option<DensityFault>,
}

impl Default for Sums {
    fn default() -> Self {
        Self {
            moments: Default::default(),
            inner: None,
            outer: None,
            count: 0,
            size: Moments::default(),
            least_density: f64::INFINITY,
            may_lack_density: false,
            fault: None,
        }
    }
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
        let (density, is_defined) = part.density;
        self.least_density = self.least_density.min(density.lo);
        self.may_lack_density |= !is_defined;
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
            volume: if self.least_density < 0.0 {
                volume
            } else {
                Interval { lo: volume.lo.max(0.0), ..volume }
            },
            origin,
            first: each(least.first, most.first, self.size.first),
            squares: each(least.squares, most.squares, self.size.squares),
            products: each(least.products, most.products, self.size.products),
            low: ends(0),
            high: ends(1),
            boxes,
            limit: None,
            least_density: self.least_density,
            may_lack_density: self.may_lack_density,
            fault: self.fault,
        }
    }
}
