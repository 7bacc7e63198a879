//! Refines a grid until the shape of the surface in it is proven, and the mesh is near enough.

use crate::cells::{Cell, CellClass, PartBounds, PartKernels, Query, Side, classify_cells};
use crate::grid::{Corner, Grid, Tetrahedron};
use crate::leaf::{Kind, Leaf, Nearness};
use crate::near::{self, Far};
use crate::proof::{Slopes, bend, least_slope, linear_gradient, middle, vectors};
use crate::space::Space;
use crate::values::CornerValues;
use glam::DVec3;
use rayon::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};
use smallvec::SmallVec;
use std::sync::Arc;
use zeroset_eval::{Kernel, LANES, Points, Sample, Values};
use zeroset_scene::choices::Choice;

/// Share of all tetrahedra that may fail the proof at a time. If more do, those of the smallest
/// size among them are not split any more.
const MOST_FAILING: f64 = 0.2;
/// Size of the tetrahedra that are not split for the proof, as a share of the domain's longest
/// edge.
const FINEST: f64 = 1.0 / 262_144.0;
/// The same as [`FINEST`], for tetrahedra in which only the domain's boundary prevents the proof.
/// It may prevent the proof at any size, since the surface may go through an edge of the domain.
const BOUNDARY: f64 = 1.0 / 1024.0;
/// The value of a part where it is undefined: far above 0, since a solid is not there. Products of
/// three are finite.
const UNDEFINED: f64 = 1e100;

/// A failure of the proof at a corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Fails {
    /// True if the proof would hold in a larger domain.
    at_boundary: bool,
}

/// Limits of a refinement.
#[derive(Clone, Copy)]
pub struct Limits {
    /// Largest allowed distance between mesh and surface, in world units.
    pub tolerance: f64,
    /// The domain's longest edge, in world units.
    pub extent: f64,
    /// Number of tetrahedra above which none is split to reduce the distance. Above twice this
    /// number, none is split to prove the shape.
    pub most_cells: usize,
}

/// A refined grid.
#[derive(Default)]
pub struct Refined {
    pub leaves: Vec<Leaf>,
    /// The parts' values at the corners.
    pub values: CornerValues,
    /// For each corner by its number, whether the proof fails there.
    failing: Vec<bool>,
    /// For some corners, the number of times that their values were moved apart again.
    moves: FxHashMap<u32, u64>,
    /// Tetrahedra that are no leaves yet.
    fresh: Vec<Cell>,
    /// Leaves from this one on have not been proven.
    unproven: usize,
    /// Size of the tetrahedra that are not split for the proof, in world units.
    finest: f64,
}

/// Refines a grid for a function. If the function bounds a solid, the leaves include tetrahedra
/// inside the solid at the boundary of the domain. Returns `None` once `wanted` returns false.
pub fn refine(
    refined: &mut Refined,
    query: &Query<'_>,
    grid: &mut Grid,
    limits: Limits,
    wanted: &(dyn Fn() -> bool + Sync),
) -> Option<()> {
    let &Query { parts: kernels, space, is_solid, levels, estimated, .. } = query;
    let is_estimated = estimated > 0.0;
    loop {
        let first = refined.leaves.len();
        let fresh = std::mem::take(&mut refined.fresh);
        let classes = classify_cells(query, &fresh, wanted)?;
        for (Cell { tetrahedron: cell, choice, is_strict }, class) in fresh.into_iter().zip(classes)
        {
            let kind = match class {
                CellClass::Open(local) => {
                    let near = nearness(query, &cell, &local.parts, limits.tolerance, is_strict);
                    Kind::Open { local, near }
                }
                CellClass::Empty(-1) if is_solid && has_face(space, &cell) => Kind::Inside(choice),
                CellClass::Empty(_) => continue,
            };
            refined.leaves.push(Leaf { cell, kind, is_strict });
        }
        let has_room = refined.leaves.len() < limits.most_cells;
        let has_room_to_prove = refined.leaves.len() < 2 * limits.most_cells;
        // Tells whether a tetrahedron may be split, down to some size.
        let may_split =
            |cell: &Tetrahedron, least: f64| !cell.is_finest() && size(space, cell) > least;
        let mut middles: Vec<Corner> = refined.leaves[first..]
            .iter()
            .filter(|leaf| match &leaf.kind {
                Kind::Open { local, near: Nearness::Far } if has_room => {
                    let is_smooth = local.parts.iter().all(|part| part.gradient.is_some());
                    let share = match is_smooth {
                        true if is_estimated => 0.5,
                        true => 0.125,
                        // Where the function may jump or end, no distance is proven, and whole
                        // planes of tetrahedra stay open.
                        false => 2.0,
                    };
                    may_split(&leaf.cell, share * limits.tolerance)
                }
                Kind::Open { .. } | Kind::Inside(_) => false,
            })
            .map(|leaf| leaf.cell.middle())
            .collect();
        if middles.is_empty() && is_estimated {
            refined.sample(kernels, space, grid, 0);
            if kernels.len() > 1 {
                refined.values.move_apart(&refined.leaves, levels, grid, &refined.moves);
            }
        } else if middles.is_empty() {
            let splits = |refined: &mut Refined, failing: Vec<(usize, Fails)>| -> Vec<Corner> {
                let cell = |leaf: usize| &refined.leaves[leaf].cell;
                if failing.len() as f64 > MOST_FAILING * limits.most_cells as f64 {
                    let sizes = failing.iter().map(|(leaf, _)| size(space, cell(*leaf)));
                    refined.finest = refined.finest.max(sizes.fold(f64::INFINITY, f64::min));
                }
                let middle = |(leaf, Fails { at_boundary }): (usize, Fails)| {
                    let least = if at_boundary { BOUNDARY * limits.extent } else { 0.0 };
                    let cell = cell(leaf);
                    let splits = has_room_to_prove && may_split(cell, least.max(refined.finest));
                    splits.then(|| cell.middle())
                };
                failing.into_iter().filter_map(middle).collect()
            };
            let first = refined.unproven;
            refined.sample(kernels, space, grid, first);
            let failing = refined.prove(query, grid, &|number, _| number >= first, wanted)?;
            refined.unproven = refined.leaves.len();
            middles = splits(refined, failing);
            if middles.is_empty() && kernels.len() > 1 {
                let failing = refined.prove_apart(query, grid, wanted)?;
                middles = splits(refined, failing);
            }
        }
        if middles.is_empty() {
            return Some(());
        }
        refined.split(middles, grid);
    }
}

/// The largest extent of a tetrahedron along an axis.
pub fn size(space: &Space, cell: &Tetrahedron) -> f64 {
    space.between(cell.bounds()).iter().map(|along| along.hi - along.lo).fold(0.0, f64::max)
}

/// Returns whether three corners are on one face of the domain.
fn has_face(space: &Space, cell: &Tetrahedron) -> bool {
    let on = cell.corners.map(|corner| space.faces(corner));
    (0..3).any(|axis| on.iter().filter(|on| on[axis]).count() >= 3)
}

/// A bound of the distance between mesh and surface in a tetrahedron.
fn nearness(
    query: &Query<'_>,
    cell: &Tetrahedron,
    parts: &[PartBounds],
    distance: f64,
    is_strict: bool,
) -> Nearness {
    let is_near = |distance: f64| is_near(query, cell, parts, distance);
    if is_near(distance) {
        Nearness::Near
    } else if !is_strict
        && near::may_be_loose(query, parts, size(query.space, cell), distance)
        && is_near(near::LOOSE * distance)
    {
        Nearness::Loose
    } else {
        Nearness::Far
    }
}

/// Returns whether mesh and surface are proven to be within a distance of each other in a
/// tetrahedron, if the shape is proven.
fn is_near(query: &Query<'_>, cell: &Tetrahedron, parts: &[PartBounds], distance: f64) -> bool {
    let slopes = |part: &PartBounds| {
        let PartBounds { part, side, gradient, .. } = *part;
        let linear = middle(&gradient?);
        Some(query.slopes(Slopes { part, side, gradient: gradient?, linear }, cell))
    };
    // One of each group: the gradients of levels are multiples of each other.
    let mut groups: SmallVec<[Slopes; 1]> = SmallVec::new();
    for part in parts {
        let Some(slopes) = slopes(part) else { return false };
        match groups.iter_mut().find(|one| one.part == slopes.part) {
            Some(one) if one.side != slopes.side => one.side = Side::Both,
            Some(_) => {}
            None => groups.push(slopes),
        }
    }
    let slopes = groups;
    let Some(vectors) = vectors(&slopes, [false; 3]) else { return false };
    // Both |f| on the mesh and |g| on the surface are at most the bend. Along a vector, either
    // changes at least at the least slope.
    let corners = query.space.corners(cell);
    let least = vectors.iter().flat_map(|vector| {
        slopes.iter().map(|part| {
            let up = least_slope(&part.gradient, *vector).0;
            up.max(least_slope(&part.gradient, -*vector).0)
        })
    });
    let reach = distance * least.fold(f64::INFINITY, f64::min);
    // False for NaN.
    slopes.iter().all(|part| bend(&part.gradient, &corners) <= reach)
}

impl Refined {
    /// The roots of a grid.
    pub fn new(choice: &Choice, grid: &mut Grid, limits: Limits) -> Self {
        let choice = Arc::new(choice.clone());
        let root =
            |tetrahedron| Cell { tetrahedron, choice: Arc::clone(&choice), is_strict: false };
        let fresh = grid.roots().into_iter().map(root).collect();
        Self { fresh, finest: FINEST * limits.extent, ..Self::default() }
    }

    /// Splits the edges with these middles. Parts of leaves that are split are no leaves yet.
    fn split(&mut self, middles: Vec<Corner>, grid: &mut Grid) {
        for middle in middles {
            grid.split(middle);
        }
        let Self { leaves, fresh, unproven, .. } = self;
        let (mut kept, mut number, mut open) = (0, 0, Vec::new());
        leaves.retain(|leaf| {
            let halves = grid.halves(&leaf.cell);
            kept += usize::from(halves.is_none() && number < *unproven);
            number += 1;
            let Some(halves) = halves else { return true };
            open.extend(halves);
            while let Some(tetrahedron) = open.pop() {
                match grid.halves(&tetrahedron) {
                    Some(halves) => open.extend(halves),
                    None => fresh.push(Cell {
                        tetrahedron,
                        choice: Arc::clone(leaf.choice()),
                        is_strict: leaf.is_strict,
                    }),
                }
            }
            false
        });
        *unproven = kept;
    }

    /// Splits loose leaves that are not proven to be near. `strict` ones, and all if `is_last`,
    /// must then be [`Nearness::Near`].
    pub fn tighten(&mut self, Far { large, strict }: Far, is_last: bool, grid: &mut Grid) {
        for leaf in strict.iter().chain(large.iter().filter(|_| is_last)) {
            let leaf = &mut self.leaves[*leaf];
            leaf.is_strict = true;
            if let Kind::Open { near, .. } = &mut leaf.kind {
                *near = Nearness::Far;
            }
        }
        let cells = large.into_iter().chain(strict).map(|leaf| &self.leaves[leaf].cell);
        let middles = cells.filter(|cell| !cell.is_finest()).map(Tetrahedron::middle).collect();
        self.split(middles, grid);
    }

    /// Returns whether the proof fails at a corner of a tetrahedron.
    pub fn fails(&self, cell: &Tetrahedron) -> bool {
        cell.numbers.iter().any(|corner| self.failing.get(*corner as usize) == Some(&true))
    }

    /// Moves values apart in another way at the corners of some leaves. `None` once `wanted`
    /// returns false.
    pub fn move_again(
        &mut self,
        leaves: &[usize],
        query: &Query<'_>,
        grid: &Grid,
        wanted: &(dyn Fn() -> bool + Sync),
    ) -> Option<()> {
        let corners = leaves.iter().flat_map(|leaf| self.leaves[*leaf].cell.numbers);
        let corners: FxHashSet<u32> = corners.collect();
        for corner in corners {
            *self.moves.entry(corner).or_default() += 1;
        }
        self.prove_apart(query, grid, wanted).map(drop)
    }

    /// Moves values apart, and repeats the proof where values changed. Returns leaves as
    /// [`Self::prove`] does.
    fn prove_apart(
        &mut self,
        query: &Query<'_>,
        grid: &Grid,
        wanted: &(dyn Fn() -> bool + Sync),
    ) -> Option<Vec<(usize, Fails)>> {
        let moved = self.values.move_apart(&self.leaves, query.levels, grid, &self.moves);
        let is_moved = |leaf: &Leaf| leaf.cell.numbers.iter().any(|corner| moved[*corner as usize]);
        self.prove(query, grid, &|_, leaf| is_moved(leaf), wanted)
    }

    /// Searches for a vector at each corner of the leaves for which `changed` is true. Returns the
    /// leaves at corners without such a vector, in order. `None` once `wanted` returns false.
    fn prove(
        &mut self,
        query: &Query<'_>,
        grid: &Grid,
        changed: &dyn Fn(usize, &Leaf) -> bool,
        wanted: &(dyn Fn() -> bool + Sync),
    ) -> Option<Vec<(usize, Fails)>> {
        let space = query.space;
        let is_open = |leaf: &Leaf| matches!(leaf.kind, Kind::Open { .. });
        // The open leaves around each corner that is asked for, one corner after the other.
        let mut is_asked = vec![false; grid.corners.len()];
        for (number, leaf) in self.leaves.iter().enumerate() {
            if is_open(leaf) && changed(number, leaf) {
                leaf.cell.numbers.iter().for_each(|corner| is_asked[*corner as usize] = true);
            }
        }
        let asks = |corner: &&u32| is_asked[**corner as usize];
        let mut ends = vec![0; grid.corners.len() + 1];
        for leaf in self.leaves.iter().filter(|leaf| is_open(leaf)) {
            leaf.cell
                .numbers
                .iter()
                .filter(asks)
                .for_each(|corner| ends[*corner as usize + 1] += 1);
        }
        for corner in 0..grid.corners.len() {
            ends[corner + 1] += ends[corner];
        }
        let starts = ends.clone();
        let mut stars = vec![0; *starts.last().expect("an end")];
        for (number, leaf) in self.leaves.iter().enumerate().filter(|(_, leaf)| is_open(leaf)) {
            for corner in leaf.cell.numbers.iter().filter(asks) {
                let end = &mut ends[*corner as usize];
                stars[*end] = number as u32;
                *end += 1;
            }
        }
        let star = |corner: u32| &stars[starts[corner as usize]..starts[corner as usize + 1]];
        let slopes = |leaf: &Leaf| -> Option<SmallVec<[Slopes; 1]>> {
            let Kind::Open { local, .. } = &leaf.kind else { return None };
            leaf.cell.numbers.iter().find(asks)?;
            let corners = space.corners(&leaf.cell);
            let slopes = |part: &PartBounds| {
                let gradient = part.gradient?;
                let values = leaf.cell.numbers.map(|corner| self.values.at(corner, part.part));
                let linear = linear_gradient(&corners, &values);
                let slopes = Slopes { part: part.part, side: part.side, gradient, linear };
                Some(query.slopes(slopes, &leaf.cell))
            };
            local.parts.iter().map(slopes).collect()
        };
        let slopes: Vec<Option<SmallVec<[Slopes; 1]>>> =
            self.leaves.par_iter().map(slopes).collect();
        let fails = |all: &mut Vec<Slopes>, corner: &u32| {
            all.clear();
            for number in star(*corner) {
                let Some(slopes) = &slopes[*number as usize] else {
                    return Some(Fails { at_boundary: false });
                };
                all.extend_from_slice(slopes);
            }
            let faces = space.faces(grid.corners[*corner as usize]);
            if vectors(all, faces).is_some() {
                return None;
            }
            let at_boundary = faces != [false; 3] && vectors(all, [false; 3]).is_some();
            Some(Fails { at_boundary })
        };
        let corners: Vec<u32> =
            (0..grid.corners.len() as u32).filter(|corner| asks(&corner)).collect();
        let found: Option<Vec<Option<Fails>>> = corners
            .par_iter()
            .map_init(Vec::new, |all, corner| wanted().then(|| fails(all, corner)))
            .collect();
        self.failing.resize(grid.corners.len(), false);
        let mut leaves = Vec::new();
        for (corner, fails) in corners.into_iter().zip(found?) {
            self.failing[corner as usize] = fails.is_some();
            if let Some(fails) = fails {
                leaves.extend(star(corner).iter().map(|number| (*number as usize, fails)));
            }
        }
        leaves.sort_unstable();
        leaves.dedup_by_key(|(leaf, _)| *leaf);
        Some(leaves)
    }

    /// Adds the values of the parts that matter, at the corners of leaves from `first` on.
    fn sample(&mut self, kernels: &[PartKernels<'_>], space: &Space, grid: &Grid, first: usize) {
        let mut corners = vec![Vec::new(); kernels.len()];
        self.values.resize(grid.corners.len());
        for leaf in &self.leaves[first..] {
            let Kind::Open { local, .. } = &leaf.kind else { continue };
            for PartBounds { part, .. } in &local.parts {
                for corner in leaf.cell.numbers {
                    if self.values.reserve(corner, *part) {
                        corners[usize::from(*part)].push(corner);
                    }
                }
            }
        }
        for (part, corners) in corners.into_iter().enumerate() {
            let at = |corner: &u32| grid.corners[*corner as usize];
            let points: Vec<DVec3> = corners.iter().map(|corner| space.at(at(corner))).collect();
            for (corner, value) in corners.into_iter().zip(sample(kernels[part].samples, &points)) {
                // At a zero, g may have either sign.
                let value = if value == 0.0 { f64::MIN_POSITIVE } else { value };
                let value = if value.is_nan() { UNDEFINED } else { value };
                let value = value.clamp(-UNDEFINED, UNDEFINED);
                self.values.set(corner, part as u16, value);
            }
        }
    }
}

/// The function's values at points.
pub fn sample(kernel: &dyn Kernel<Sample, f64>, points: &[DVec3]) -> Vec<f64> {
    let values = |some: &[DVec3]| {
        let mut values = Values::<f64>::default();
        kernel.eval(&Points::near(some)[0], &mut values);
        values.value[..some.len()].to_vec()
    };
    points.par_chunks(LANES).flat_map_iter(values).collect()
}
