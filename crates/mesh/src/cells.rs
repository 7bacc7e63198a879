//! Bounds of functions over tetrahedra. A function is a choice: minima and maxima of parts.

use crate::grid::{Corner, CornerMap, Tetrahedron};
use crate::proof::Slopes;
use crate::refine::size;
use crate::regular::{Regularized, regularize};
use crate::space::Space;
use rayon::prelude::*;
use smallvec::SmallVec;
use std::sync::Arc;
use zeroset_eval::{
    Boxes, EncloseGradient, FindZeros, GradientEnclosures, Gradients, Kernel, KernelError, Kernels,
    LANES, Points, Sample, Zeros,
};
use zeroset_interval::Interval;
use zeroset_scene::choices::{Choice, Level};
use zeroset_scene::program::Program;

/// The kernels of one part.
pub struct PartKernels<'a> {
    zeros: &'a dyn Kernel<FindZeros, f64>,
    gradients: &'a dyn Kernel<EncloseGradient, f64>,
    /// The kernel for values of the part at points.
    pub samples: &'a dyn Kernel<Sample, f64>,
    /// All kernels.
    pub all: &'a dyn Kernels<f64>,
}

impl<'a> PartKernels<'a> {
    /// The kernels of all surfaces of a program, as parts.
    pub fn of(program: &'a Program) -> Result<Vec<Self>, KernelError> {
        let kernels = |part: usize| {
            let all = program.kernels::<f64>(part);
            let (zeros, gradients) = (all.zeros()?, all.gradient_bounds()?);
            Ok(Self { zeros, gradients, samples: all.values()?, all })
        };
        (0..program.roots().len()).into_par_iter().map(kernels).collect()
    }
}

/// A function, as parts with kernels, and the proofs that are wanted of its cells.
pub struct Query<'a> {
    pub parts: &'a [PartKernels<'a>],
    pub space: &'a Space,
    /// True if the function's surface bounds a solid.
    pub is_solid: bool,
    /// For each part, the function of which it is a level.
    pub levels: &'a [Level],
    /// Largest size of a tetrahedron in which levels of one function are proven together.
    pub thin: f64,
    /// Number of the first part that only cuts the surface off, where the part is above 0. Zeros of
    /// such a part are no surface.
    pub first_cut: usize,
    /// Largest edge, in world units, of a box whose bounds are estimated from samples. 0 if all
    /// bounds are proven.
    pub estimated: f64,
}

impl Query<'_> {
    /// The slopes of a part in a tetrahedron: those of its group's function, if levels are proven
    /// together there.
    pub fn slopes(&self, slopes: Slopes, cell: &Tetrahedron) -> Slopes {
        if size(self.space, cell) <= self.thin { slopes.of_group(self.levels) } else { slopes }
    }
}

/// Bounds of one part over a box.
#[derive(Clone, Copy, Debug)]
pub struct PartBounds {
    /// The part's number.
    pub part: u16,
    /// The side of the part's zeros on which the function is above 0.
    pub side: Side,
    /// The part's values.
    value: Interval,
    /// The partial derivatives, at each point where they exist. `None` if the part is not proven
    /// Lipschitz continuous.
    pub gradient: Option<[Interval; 3]>,
    /// True if the part may be 0 in the box.
    may_vanish: bool,
    /// True if the part is proven to be defined and continuous in the box.
    is_continuous: bool,
}

/// A side of a part's zeros.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Side {
    /// The part is above 0 on this side.
    Above,
    /// The part is below 0 on this side.
    Below,
    /// The side is above at some zeros, and below at others.
    Both,
    /// The surface may cross itself, so that nothing is proven.
    Unknown,
}

impl Side {
    /// The side on which a choice with this part is above 0.
    pub fn of(part: u16, choice: &Choice) -> Self {
        let part = usize::from(part);
        match (choice.has(&Choice::Part(part)), choice.has(&Choice::Opposite(part))) {
            (_, false) => Self::Above,
            (false, true) => Self::Below,
            (true, true) => Self::Both,
        }
    }
}

/// Bounds of the parts that matter in a cell, mostly one.
pub type Parts = SmallVec<[PartBounds; 1]>;

/// A tetrahedron, and the alternatives of the function that may matter in it.
#[derive(Clone)]
pub struct Cell {
    pub tetrahedron: Tetrahedron,
    pub choice: Arc<Choice>,
    /// The same as [`Leaf::is_strict`](crate::leaf::Leaf::is_strict).
    pub is_strict: bool,
}

/// The function in a cell that may hold a zero.
pub struct Local {
    /// The alternatives that may matter in the cell.
    pub choice: Arc<Choice>,
    /// Its parts.
    pub parts: Parts,
}

/// The answer to whether a cell may hold a zero.
#[derive(Clone)]
pub enum CellClass {
    /// There is no zero in the cell. The sign is −1 or 1 if it is the same in the whole cell and
    /// proven, else 0. For a solid it is never 0.
    Empty(i8),
    /// There may be a zero.
    Open(Arc<Local>),
}

/// Classifies cells by their bounding boxes. Results are in the order of `cells`. `None` once
/// `wanted` returns false.
pub fn classify_cells(
    query: &Query<'_>,
    cells: &[Cell],
    wanted: &(dyn Fn() -> bool + Sync),
) -> Option<Vec<CellClass>> {
    let Query { parts, space, estimated, .. } = query;
    // Up to six tetrahedra have the same box.
    let mut numbers: CornerMap<(Corner, Corner), usize> = CornerMap::default();
    let mut boxes: Vec<[Interval; 3]> = Vec::new();
    let mut asked: Vec<Vec<u32>> = vec![Vec::new(); parts.len()];
    let mut choices: Vec<&Arc<Choice>> = Vec::new();
    let index: Vec<usize> = cells
        .iter()
        .map(|cell| {
            let bounds = cell.tetrahedron.bounds();
            *numbers.entry(bounds.into()).or_insert_with(|| {
                for part in parts_of(&cell.choice) {
                    asked[part].push(boxes.len() as u32);
                }
                // Cells with the same box may have choices from different larger boxes. Each choice
                // is valid in the box.
                choices.push(&cell.choice);
                boxes.push(space.between(bounds));
                boxes.len() - 1
            })
        })
        .collect();
    let mut found: Vec<Parts> = vec![Parts::new(); boxes.len()];
    for (part, asked) in asked.iter().enumerate() {
        let some = |some: &[u32]| {
            let boxes: Vec<[Interval; 3]> = some.iter().map(|n| boxes[*n as usize]).collect();
            wanted().then(|| bounds(&parts[part], part as u16, &boxes, *estimated))
        };
        let bounds: Option<Vec<Vec<PartBounds>>> = asked.par_chunks(LANES).map(some).collect();
        for (number, bounds) in asked.iter().zip(bounds?.into_iter().flatten()) {
            found[*number as usize].push(bounds);
        }
    }
    let class = |(choice, parts): (&&Arc<Choice>, &Parts)| classify_cell(choice, parts, query);
    let classes: Vec<CellClass> = choices.par_iter().zip(&found).map(class).collect();
    Some(index.into_iter().map(|number| classes[number].clone()).collect())
}

/// The bounds of one part in each of the boxes. They may be estimated from samples if no box has an
/// edge longer than `estimated`.
fn bounds(
    kernels: &PartKernels<'_>,
    part: u16,
    boxes: &[[Interval; 3]],
    estimated: f64,
) -> Vec<PartBounds> {
    let is_small = |bounds: &[Interval; 3]| bounds.iter().all(|b| b.hi - b.lo <= estimated);
    if boxes.iter().all(is_small)
        && let Some(all) = estimates(kernels, part, boxes)
    {
        return all;
    }
    let mut zeros = Zeros::default();
    // Cells lie within the domain.
    kernels.zeros.eval_clipped(&Boxes::around(boxes)[0], &mut zeros);
    let of = |(lane, Enclosure { value, gradient }): (usize, Enclosure)| PartBounds {
        part,
        side: Side::Above,
        value,
        gradient,
        may_vanish: zeros.possible >> lane & 1 == 1,
        is_continuous: zeros.jumping >> lane & 1 == 0,
    };
    enclosures(kernels, boxes).enumerate().map(of).collect()
}

/// Bounds of a part over a box.
pub struct Enclosure {
    pub value: Interval,
    /// The same as [`PartBounds::gradient`].
    pub gradient: Option<[Interval; 3]>,
}

/// The bounds of a part over boxes in the domain, at most [`LANES`].
pub fn enclosures(
    kernels: &PartKernels<'_>,
    boxes: &[[Interval; 3]],
) -> impl Iterator<Item = Enclosure> + use<> {
    let mut bounds = GradientEnclosures::<f64>::default();
    kernels.gradients.eval_clipped(&Boxes::around(boxes)[0], &mut bounds);
    (0..boxes.len()).map(move |lane| {
        let slopes = || {
            [0, 1, 2].map(|axis| Interval {
                lo: -bounds.gradient_neg_lo[axis][lane],
                hi: bounds.gradient_hi[axis][lane],
            })
        };
        Enclosure {
            value: Interval { lo: -bounds.neg_lo[lane], hi: bounds.hi[lane] },
            gradient: (bounds.lipschitz >> lane & 1 == 1).then(slopes),
        }
    })
}

/// Number of corners of a box.
const CORNERS: usize = 8;

/// Bounds of a part over boxes, estimated from samples at their corners. `None` if the part is
/// undefined at one.
fn estimates(
    kernels: &PartKernels<'_>,
    part: u16,
    boxes: &[[Interval; 3]],
) -> Option<Vec<PartBounds>> {
    let gradients = kernels.all.gradients().ok()?;
    let mut all = Vec::with_capacity(boxes.len());
    for some in boxes.chunks(LANES / CORNERS) {
        let corner = |of: &[Interval; 3], corner: usize| {
            [0, 1, 2].map(|axis| if corner >> axis & 1 == 1 { of[axis].hi } else { of[axis].lo })
        };
        let corners = |of| (0..CORNERS).map(move |k| corner(of, k));
        let corners: SmallVec<[[f64; 3]; LANES]> = some.iter().flat_map(corners).collect();
        let mut found = Gradients::<f64>::default();
        gradients.eval(&Points::near(&corners)[0], &mut found);
        for (k, bounds) in some.iter().enumerate() {
            let hull = |lanes: &[f64; LANES]| {
                let values = &lanes[k * CORNERS..][..CORNERS];
                let lo = values.iter().copied().fold(f64::INFINITY, f64::min);
                let hi = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                values.iter().all(|value| value.is_finite()).then_some(Interval { lo, hi })
            };
            let Interval { lo, hi } = hull(&found.value)?;
            let [x, y, z] = &found.gradient;
            let gradient = [hull(x)?, hull(y)?, hull(z)?];
            // A quadratic function differs by at most this much from an interpolation of its values
            // at the corners.
            let along = |(slope, span): (&Interval, &Interval)| {
                0.125 * (slope.hi - slope.lo) * (span.hi - span.lo)
            };
            let bend: f64 = gradient.iter().zip(bounds).map(along).sum();
            let value = Interval { lo: lo - bend, hi: hi + bend };
            let may_vanish = value.lo <= 0.0 && value.hi >= 0.0;
            all.push(PartBounds {
                part,
                side: Side::Above,
                value,
                gradient: Some(gradient),
                may_vanish,
                is_continuous: true,
            });
        }
    }
    Some(all)
}

/// The numbers of a choice's parts, each once, in order.
pub fn parts_of(choice: &Choice) -> SmallVec<[usize; 4]> {
    fn add(choice: &Choice, parts: &mut SmallVec<[usize; 4]>) {
        match choice {
            Choice::Part(part) | Choice::Opposite(part) => parts.push(*part),
            Choice::Min(all) | Choice::Max(all) => all.iter().for_each(|one| add(one, parts)),
        }
    }
    let mut parts = SmallVec::new();
    add(choice, &mut parts);
    parts.sort_unstable();
    parts.dedup();
    parts
}

/// Classifies a cell by the bounds of the parts in it.
fn classify_cell(choice: &Arc<Choice>, bounds: &Parts, query: &Query<'_>) -> CellClass {
    let is_solid = query.is_solid;
    let mut is_crossing = false;
    let choice = match &**choice {
        Choice::Part(_) | Choice::Opposite(_) => Arc::clone(choice),
        several => match regularize(pruned(several, bounds)) {
            Regularized::Choice(choice) => Arc::new(choice),
            Regularized::Crossing(choice) => {
                is_crossing = true;
                Arc::new(choice)
            }
            Regularized::Constant(sign) => return CellClass::Empty(sign),
        },
    };
    let left = parts_of(&choice);
    let is_left = |one: &&PartBounds| left.binary_search(&usize::from(one.part)).is_ok();
    let side = |part: u16| if is_crossing { Side::Unknown } else { Side::of(part, &choice) };
    let sided = |one: &PartBounds| PartBounds { side: side(one.part), ..*one };
    let parts: Parts = bounds.iter().filter(is_left).map(sided).collect();
    let value = value(&choice, &parts).unwrap_or(Interval::ENTIRE);
    let sign = i8::from(value.lo > 0.0) - i8::from(value.hi < 0.0);
    // If several parts matter, the bounds also hold for functions that are linear in the cell and
    // have the parts' values at its corners.
    let is_empty = match &*parts {
        // A solid's mesh must know on which side the cell is. Where the function is undefined, the
        // cell is outside.
        [only] if !only.may_vanish => !is_solid || sign > 0 || (sign < 0 && only.is_continuous),
        parts => sign != 0 && parts.iter().all(|part| part.is_continuous),
    };
    if is_empty {
        return CellClass::Empty(sign);
    }
    let is_cut = |part: &PartBounds| usize::from(part.part) >= query.first_cut;
    let has_sign =
        |part: &PartBounds| (part.value.lo > 0.0 || part.value.hi < 0.0) && part.is_continuous;
    if parts.iter().any(is_cut) && parts.iter().all(|part| is_cut(part) || has_sign(part)) {
        return CellClass::Empty(0);
    }
    CellClass::Open(Arc::new(Local { choice, parts }))
}

/// Bounds of a choice. `None` if it has no part with bounds.
fn value(choice: &Choice, bounds: &[PartBounds]) -> Option<Interval> {
    let fold = |all: &[Choice], pick: fn(f64, f64) -> f64| {
        let values = all.iter().filter_map(|choice| value(choice, bounds));
        values.reduce(|a, b| Interval { lo: pick(a.lo, b.lo), hi: pick(a.hi, b.hi) })
    };
    match choice {
        Choice::Part(part) => {
            let place = bounds.binary_search_by_key(part, |one| usize::from(one.part));
            place.ok().map(|place| bounds[place].value)
        }
        Choice::Opposite(part) => {
            value(&Choice::Part(*part), bounds).map(|v| Interval { lo: -v.hi, hi: -v.lo })
        }
        Choice::Min(all) => fold(all, f64::min),
        Choice::Max(all) => fold(all, f64::max),
    }
}

/// Leaves out the alternatives that never have the choice's value in the box. An alternative that
/// may be undefined stays, since the choice is undefined there, too.
fn pruned(choice: &Choice, bounds: &[PartBounds]) -> Choice {
    let (all, is_max) = match choice {
        Choice::Part(_) | Choice::Opposite(_) => return choice.clone(),
        Choice::Min(all) => (all, false),
        Choice::Max(all) => (all, true),
    };
    let values: Vec<Option<Interval>> = all.iter().map(|one| value(one, bounds)).collect();
    let least = values.iter().flatten().map(|v| v.lo).fold(f64::NEG_INFINITY, f64::max);
    let most = values.iter().flatten().map(|v| v.hi).fold(f64::INFINITY, f64::min);
    let stays = |(one, value): &(&Choice, Option<Interval>)| {
        let loses = value.is_some_and(|v| if is_max { v.hi < least } else { v.lo > most });
        !loses || !is_certain(one, bounds)
    };
    let mut left: Vec<Choice> =
        all.iter().zip(values).filter(stays).map(|(one, _)| pruned(one, bounds)).collect();
    match left.pop() {
        Some(only) if left.is_empty() => only,
        last => {
            left.extend(last);
            if is_max { Choice::Max(left) } else { Choice::Min(left) }
        }
    }
}

/// Returns whether all parts of a choice are proven continuous.
fn is_certain(choice: &Choice, bounds: &[PartBounds]) -> bool {
    match choice {
        Choice::Part(part) | Choice::Opposite(part) => {
            let place = bounds.binary_search_by_key(part, |one| usize::from(one.part));
            place.is_ok_and(|place| bounds[place].is_continuous)
        }
        Choice::Min(all) | Choice::Max(all) => all.iter().all(|one| is_certain(one, bounds)),
    }
}
