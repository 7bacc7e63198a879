//! The area of a surface, between two bounds.
//!
//! Boxes are halved. In a box, the surface consists of pieces of the zeros of a few parts. Where a
//! part rises along an axis, its zeros are a graph over the side of the box across the axis. Their
//! area is the integral of a factor over the side: the length of the gradient over the slope along
//! the axis. Linear functions, with errors, hold the factor, and the lines at which a piece ends.
//! So the piece lies between two polygons of the side. Where only one part matters, a box is made
//! as short along the axis as the zeros allow, and is then halved across the axis only: few pieces
//! end inside of the sides of such boxes. `docs/measures.md` has the argument.

use crate::clip::Strip;
use crate::pieces::{Graph, Pieces, side};
use crate::taylor::{Derivatives, rounding};
use crate::wall::{enclosures, sides, value};
use rayon::prelude::*;
use rustc_hash::FxHashMap;
use std::sync::OnceLock;
use zeroset_eval::LANES;
use zeroset_interval::Interval;
use zeroset_scene::choices::{Choice, Choices};
use zeroset_scene::program::{Program, ProgramError};
use zeroset_space::{Cell, Region};

/// Largest number of parts of a function. Each costs an evaluation for each box.
const MOST_PARTS: usize = 128;
/// Largest number of parts that matter in one box.
const MOST_IN_BOX: usize = 8;
/// Largest number of boxes.
const MOST_BOXES: usize = 1_000_000;
/// Largest number of boxes in which nothing bounds the area.
const MOST_UNKNOWN: usize = 40_000;
/// Boxes are not halved below this share of the region for a bound of the area.
const LEAST_BOX: f64 = 1.0 / 4096.0;
/// Number of parts of a halved box that are assumed to hold the surface.
const HALVES: usize = 4;
/// Place at which a box is cut, as a share of its extent. Flat faces are often in the middle of a
/// region. The area of one that is in a face of boxes has no narrow bounds.
const CUT: f64 = 0.487;
/// The factor is at most this in a box that is halved across its axis only.
const MOST_FACTOR: f64 = 4.0;
/// Space at the ends of a box around the zeros, as a share of their extent.
const SPARE: f64 = 1e-3;
/// A box is made shorter if its extent becomes smaller by this factor.
const SNUG: f64 = 0.8;
/// Bound of rounding errors of polygons in a square, and of their sums, relative to the areas.
const ROUNDING: f64 = 1e-13;

/// Bounds of an area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Area {
    /// The least area.
    pub low: f64,
    /// The greatest area: infinite if it is not bounded.
    pub high: f64,
    /// Number of boxes that hold the surface.
    pub boxes: usize,
    /// True if narrower bounds take more boxes than allowed.
    pub is_limited: bool,
}

/// A box that may hold a piece of the surface.
#[derive(Clone, Copy)]
struct Column {
    cell: Cell,
    /// The axis along which the one part that matters rises or falls, or across which a face of the
    /// region lies. The box is then halved across the axis only.
    axis: Option<usize>,
    /// For the lower and the upper end of the axis, true if the surface may go on beyond it.
    is_open: [bool; 2],
    /// True if the box is a part of a face of the region, which the solid may fill.
    is_face: bool,
}

/// A box with bounds of the area in it.
struct Patch {
    column: Column,
    low: f64,
    high: f64,
}

/// The functions whose zeros are the surface.
struct Source {
    choices: Choices,
    /// For each part, the factors of its area by axis, once they are needed. `None` if they are too
    /// large.
    factors: Vec<OnceLock<Option<Program>>>,
    /// For each part, the largest number of zeros on lines along each axis, if it is known.
    zeros: Vec<Option<[u32; 3]>>,
    /// The value of a part in a box in which it is undefined. It is that of points outside if the
    /// whole function is undefined there.
    absent: Interval,
}

/// Bounds the area of a surface in a region: of a solid, with the faces where the region cuts it.
/// The width is at most `relative` times the lower bound if that is possible. Returns `None` once
/// `wanted` returns false. The inner `None` stands for a function with too many parts.
///
/// # Errors
/// If a part is too large, or a kernel is not available.
///
/// # Panics
/// If there is no such surface, or the program is not valid in the region.
pub fn area(
    program: &Program,
    surface: usize,
    region: &Region,
    larger: Option<Region>,
    relative: f64,
    wanted: &(dyn Fn() -> bool + Sync),
) -> Result<Option<Option<Area>>, ProgramError> {
    let source = Source::of(program, surface, larger.as_ref().unwrap_or(region))?;
    let Some(source) = source else { return Ok(Some(None)) };
    let faces = |region: &Region| {
        if program.is_solid(surface) { faces(region) } else { Vec::new() }
    };
    if let Some(larger) = larger {
        // A solid may fill the domain outside of its surface. Then the domain cuts it.
        let Some(cut) = source.bounded(faces(&larger), relative, &larger, wanted) else {
            return Ok(None);
        };
        if cut.high == 0.0 {
            let found = source.bounded(vec![Column::whole(&larger)], relative, &larger, wanted);
            return Ok(found.map(Some));
        }
    }
    let all = [faces(region), vec![Column::whole(region)]].concat();
    Ok(source.bounded(all, relative, region, wanted).map(Some))
}

/// The six faces of a region's box.
fn faces(region: &Region) -> Vec<Column> {
    let whole = Column::whole(region);
    let face = |axis: usize, is_upper: bool| {
        let mut cell = whole.cell;
        let end = if is_upper { cell.high[axis] } else { cell.low[axis] };
        (cell.low[axis], cell.high[axis]) = (end, end);
        Column { cell, axis: Some(axis), is_face: true, ..whole }
    };
    (0..3).flat_map(|axis| [face(axis, false), face(axis, true)]).collect()
}

impl Column {
    fn whole(region: &Region) -> Self {
        let cell = Cell { low: region.low().into(), high: region.high().into() };
        Self { cell, axis: None, is_open: [true; 2], is_face: false }
    }

    /// The boxes that make up this one.
    fn halves(&self) -> Vec<Self> {
        let cut = |axis: usize| {
            let (low, high) = (self.cell.low[axis], self.cell.high[axis]);
            (low + CUT * (high - low)).clamp(low, high)
        };
        let mut halves = vec![*self];
        for axis in (0..3).filter(|axis| self.axis != Some(*axis)) {
            for k in 0..halves.len() {
                let mut upper = halves[k];
                upper.cell.low[axis] = cut(axis);
                halves[k].cell.high[axis] = cut(axis);
                halves.push(upper);
            }
        }
        halves
    }

    /// The area of the side across an axis, per area of the square, and a bound of its rounding.
    fn side(&self, axis: usize) -> f64 {
        0.25 * self.cell.extent((axis + 1) % 3) * self.cell.extent((axis + 2) % 3)
    }
}

impl Source {
    fn of(
        program: &Program,
        surface: usize,
        region: &Region,
    ) -> Result<Option<Self>, ProgramError> {
        let mut choices = program.choices(surface, region)?;
        let count = choices.parts.roots().len();
        if count > MOST_PARTS {
            return Ok(None);
        }
        if program.is_solid(surface) {
            choices.first_cut = count;
        }
        for part in 0..count {
            choices.parts.kernels::<f64>(part).bounds()?;
        }
        let factors = (0..count).map(|_| OnceLock::new()).collect();
        // A maximum is undefined where one of its operands is.
        let is_greatest = |choice: &Choice| match choice {
            Choice::Part(_) => true,
            Choice::Max(all) => all.iter().all(|one| matches!(one, Choice::Part(_))),
            Choice::Opposite(_) | Choice::Min(_) => false,
        };
        let zeros = (0..count).map(|part| choices.parts.most_line_zeros(part)).collect();
        let is_absent = !program.is_solid(surface) && is_greatest(&choices.choice);
        let absent = if is_absent { Interval::ONE } else { Interval::ENTIRE };
        Ok(Some(Self { choices, factors, zeros, absent }))
    }

    /// Halves boxes until the bounds of the area in all of them are narrow enough.
    fn bounded(
        &self,
        mut fresh: Vec<Column>,
        relative: f64,
        region: &Region,
        wanted: &(dyn Fn() -> bool + Sync),
    ) -> Option<Area> {
        let least_box = LEAST_BOX * (region.high() - region.low()).max_element();
        let (mut open, mut done): (Vec<Patch>, Vec<Patch>) = (Vec::new(), Vec::new());
        loop {
            let found: Option<Vec<Vec<Patch>>> = fresh
                .par_chunks(LANES)
                .map(|columns| wanted().then(|| self.patches(columns)))
                .collect();
            open.extend(found?.into_iter().flatten());
            open.sort_by(|a, b| a.width().total_cmp(&b.width()));
            let bounded = open.partition_point(|patch| patch.high.is_finite());
            let unknown = open.len() - bounded;
            if unknown > MOST_UNKNOWN {
                done.append(&mut open.split_off(bounded));
            }
            let is_small = |patch: &mut Patch| {
                !patch.high.is_finite() && patch.column.cell.largest() < least_box
            };
            done.extend(open.extract_if(.., is_small));
            let sum = |of: fn(&Patch) -> f64| open.iter().chain(&done).map(of).sum::<f64>();
            let (low, high) = (sum(|patch| patch.low), sum(|patch| patch.high));
            let width: f64 = open.iter().map(Patch::width).sum();
            let is_wide = width > relative * low;
            let count = open.len() + done.len();
            let goal = if low > 0.0 { relative * low } else { relative.min(1.0) * high };
            let mut left = 0.0;
            let kept = open.iter().take_while(|patch| {
                left += patch.width();
                left <= (0.5 * goal).min(f64::MAX)
            });
            let room = MOST_BOXES.saturating_sub(count) / HALVES;
            let kept = kept.count().max(open.len().saturating_sub(room));
            if !is_wide || kept == open.len() {
                let share = ROUNDING + 2.0 * f64::EPSILON * count as f64;
                return Some(Area {
                    low: (low * (1.0 - share)).max(0.0),
                    // Adding 0 takes the sign from -0.
                    high: high * (1.0 + share) + 0.0,
                    boxes: count,
                    is_limited: is_wide && high.is_finite(),
                });
            }
            fresh = open.split_off(kept).iter().flat_map(|patch| patch.column.halves()).collect();
        }
    }

    /// The pieces of the surface in up to sixteen boxes. Boxes are made shorter first.
    fn patches(&self, columns: &[Column]) -> Vec<Patch> {
        let (mut found, mut snug) = (Vec::new(), Vec::new());
        for (patch, shorter) in self.look(columns).into_iter().flatten() {
            match shorter {
                Some(column) => snug.push(column),
                None => found.push(patch),
            }
        }
        if !snug.is_empty() {
            found.extend(self.look(&snug).into_iter().flatten().map(|(patch, _)| patch));
        }
        found
    }

    /// For each box that may hold a piece of the surface, bounds of the area in it, and a shorter
    /// box that holds all of the piece.
    fn look(&self, columns: &[Column]) -> Vec<Option<(Patch, Option<Column>)>> {
        let cells: Vec<Cell> = columns.iter().map(|column| column.cell).collect();
        let boxes: Vec<[Interval; 3]> = cells.iter().map(sides).collect();
        let count = self.factors.len();
        let mut values = vec![[Interval::ENTIRE; LANES]; count];
        for (part, values) in values.iter_mut().enumerate() {
            let Ok(kernel) = self.choices.parts.kernels::<f64>(part).bounds() else { continue };
            let bounds = enclosures(kernel, &boxes);
            for (lane, found) in values[..cells.len()].iter_mut().enumerate() {
                let is_absent = bounds.nowhere >> lane & 1 == 1;
                *found = if is_absent { self.absent } else { value(&bounds, lane) };
            }
        }
        let matter = |lane: usize| {
            let mut parts = Vec::new();
            let is_inside = side(&self.choices.choice, &|part| values[part][lane], &mut parts);
            parts.sort_unstable();
            parts.dedup();
            (is_inside, parts)
        };
        let lanes: Vec<(Option<bool>, Vec<usize>)> = (0..cells.len()).map(matter).collect();
        let mut known = FxHashMap::default();
        for part in lanes.iter().flat_map(|(_, parts)| parts) {
            known
                .entry(*part)
                .or_insert_with(|| Derivatives::with_planes((&self.choices.parts, *part), &cells));
        }
        let factors = FxHashMap::default();
        let mut forms = Forms { source: self, cells: &cells, parts: known, factors };
        let look = |(lane, column): (usize, &Column)| {
            let (is_inside, parts) = &lanes[lane];
            let signs = |part: usize| values[part][lane];
            let patch = |low: f64, high: f64| Patch { column: *column, low, high };
            if let Some(is_inside) = is_inside {
                let full = 4.0 * column.side(column.axis?);
                let is_filled = column.is_face && *is_inside;
                return is_filled
                    .then(|| (patch(full * (1.0 - ROUNDING), full * (1.0 + ROUNDING)), None));
            }
            if parts.len() > MOST_IN_BOX {
                return Some((patch(0.0, f64::INFINITY), None));
            }
            forms.look(lane, column, parts, &signs)
        };
        columns.iter().enumerate().map(look).collect()
    }
}

/// Linear functions in up to sixteen boxes.
struct Forms<'a> {
    source: &'a Source,
    cells: &'a [Cell],
    parts: FxHashMap<usize, Option<Derivatives>>,
    /// The factor of a part's area, by part and axis.
    factors: FxHashMap<(usize, usize), Option<Derivatives>>,
}

impl Forms<'_> {
    fn strip(&self, part: usize, lane: usize) -> Option<Strip> {
        self.parts.get(&part)?.as_ref()?.linear(&self.cells[lane], lane)
    }

    /// The zeros of a part as a graph. Along `axis`, if one is given, or else along the axis along
    /// which the part is steepest.
    fn graph(&mut self, part: usize, lane: usize, axis: Option<usize>) -> Option<Graph> {
        let strip = self.strip(part, lane)?;
        let slopes = self.parts.get(&part)?.as_ref()?.gradient(lane)?.map(Interval::absolute);
        let steepest = || (0..3).max_by(|a, b| slopes[*a].lo.total_cmp(&slopes[*b].lo));
        let axis = axis.or_else(steepest)?;
        let share = |other: usize| slopes[other].over(slopes[axis]).power(2);
        // The slope of an affine form need not be one of the function's slopes.
        if slopes[axis].lo <= 0.0 || strip.slope[axis] == 0.0 {
            return None;
        }
        let squares = share((axis + 1) % 3).plus(share((axis + 2) % 3));
        let factor = squares.plus(Interval::ONE).root();
        let (cells, source) = (self.cells, self.source);
        let known = self.factors.entry((part, axis)).or_insert_with(|| {
            let make = || source.choices.parts.area_factors(part).ok();
            let factors = source.factors[part].get_or_init(make).as_ref()?;
            Derivatives::with_planes((factors, axis), cells)
        });
        let form = known.as_ref().and_then(|known| known.linear(&cells[lane], lane));
        factor.is_bounded().then_some(Graph { part, axis, strip, factor, form })
    }

    /// Bounds of the area in a box in which these parts matter, and a shorter box.
    fn look(
        &mut self,
        lane: usize,
        column: &Column,
        parts: &[usize],
        signs: &dyn Fn(usize) -> Interval,
    ) -> Option<(Patch, Option<Column>)> {
        let strips: Vec<Option<Strip>> = parts.iter().map(|part| self.strip(*part, lane)).collect();
        let mut patch = Patch { column: *column, low: 0.0, high: 0.0 };
        let first_cut = self.source.choices.first_cut;
        let pieces = Pieces { choice: &self.source.choices.choice, parts, strips: &strips, signs };
        if column.is_face {
            let [low, high] = pieces.face(column.axis?);
            let side = column.side(column.axis?);
            (patch.low, patch.high) = (side * low, side * high);
            return (high > 0.0).then_some((patch, None));
        }
        let drawn: Vec<usize> = parts.iter().copied().filter(|part| *part < first_cut).collect();
        let mut shorter = None;
        for part in &drawn {
            let Some(graph) = self.graph(*part, lane, column.axis) else {
                // A piece's area is at most the sum of its projections along the axes, in which a
                // point counts as often as its line meets the piece.
                let zeros = self.source.zeros[*part];
                let side = |axis: usize, zeros: u32| 4.0 * f64::from(zeros) * column.side(axis);
                patch.high += zeros.map_or(f64::INFINITY, |zeros| {
                    (0..3).map(|axis| side(axis, zeros[axis])).sum()
                });
                continue;
            };
            let is_open = if column.axis.is_some() { column.is_open } else { [true; 2] };
            let [low, high] = pieces.graph(&graph, is_open);
            let side = column.side(graph.axis);
            patch.low += side * low;
            patch.high += side * high;
            if drawn.len() == 1 && graph.factor.hi <= MOST_FACTOR {
                patch.column.axis = Some(graph.axis);
                patch.column.is_open = is_open;
                shorter = shortened(&patch.column, &graph);
            }
        }
        (patch.high > 0.0).then_some((patch, shorter))
    }
}

/// A box around the zeros of a graph, with some space. `None` if it is not much shorter.
fn shortened(column: &Column, graph: &Graph) -> Option<Column> {
    let Graph { axis, strip, .. } = *graph;
    let steep = strip.slope[axis];
    let lateral = strip.slope.abs().element_sum() - steep.abs();
    let (middle, reach) = (-strip.value / steep, (lateral + strip.error) / steep.abs());
    let spare = SPARE * reach + 1e3 * ROUNDING + rounding(&column.cell, axis);
    let ends = [middle - reach - spare, middle + reach + spare];
    if ends[1] - ends[0] >= 2.0 * SNUG {
        return None;
    }
    let mut shorter = *column;
    let (low, high) = (column.cell.low[axis], column.cell.high[axis]);
    let at = |end: f64| low.midpoint(high) + 0.5 * end * (high - low);
    if ends[0] > -1.0 {
        (shorter.cell.low[axis], shorter.is_open[0]) = (at(ends[0]), false);
    }
    if ends[1] < 1.0 {
        (shorter.cell.high[axis], shorter.is_open[1]) = (at(ends[1]), false);
    }
    let is_shorter = shorter.cell.extent(axis) < SNUG * column.cell.extent(axis);
    (is_shorter && shorter.cell.extent(axis) > 0.0).then_some(shorter)
}

impl Patch {
    fn width(&self) -> f64 {
        self.high - self.low
    }
}
