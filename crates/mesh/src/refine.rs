//! Refines a grid until the shape of the surface in it is proven, and the mesh is near enough.

use crate::cells::{Answer, Cell, Local, PartBounds, PartKernels, Question, ask};
use crate::grid::{Corner, CornerHasher, CornerMap, CornerSet, Grid, Tetrahedron};
use crate::proof::{Slopes, bend, common_vector, least_slope, linear_gradient, middle};
use crate::space::Space;
use glam::DVec3;
use rayon::prelude::*;
use std::hash::{Hash, Hasher};
use std::sync::Arc;
use zeroset_eval::{Kernel, LANES, Points, Sample, Values};
use zeroset_scene::choices::Choice;

/// Share of all tetrahedra that may fail the proof at a time. If more do, none is split for the
/// proof.
const MOST_FAILING: f64 = 0.2;
/// Greatest relative difference of values by which parts are told apart.
const APART: f64 = 1e-4;

/// A tetrahedron of the refined grid.
pub struct Leaf {
    pub cell: Tetrahedron,
    pub kind: Kind,
}

/// The part that a tetrahedron has in the mesh.
pub enum Kind {
    /// The surface may be in it. `near` states that the mesh is proven to be within the tolerance.
    Open { local: Arc<Local>, near: bool },
    /// It is inside a solid, and has a face on the boundary of the domain.
    Inside(Arc<Choice>),
}

/// Limits of a refinement.
#[derive(Clone, Copy)]
pub struct Limits {
    /// Largest allowed distance between mesh and surface, in world units.
    pub tolerance: f64,
    /// Size of tetrahedra that are not split for the proof, in world units.
    pub finest: f64,
    /// Number of tetrahedra beyond which none is split.
    pub most_cells: usize,
}

/// A refined grid.
pub struct Refined {
    pub leaves: Vec<Leaf>,
    /// Values of parts at the leaves' corners, by the sample kernel. NaN if undefined.
    pub values: CornerMap<(Corner, u16), f64>,
    /// Corners at which the proof fails.
    pub failing: CornerSet,
}

/// Refines `grid` for a function. If it bounds a solid, tetrahedra inside of it stay at the
/// boundary of the domain. Returns `None` once `wanted` returns false.
pub fn refine(
    choice: &Choice,
    question: &Question<'_>,
    grid: &mut Grid,
    limits: Limits,
    wanted: &(dyn Fn() -> bool + Sync),
) -> Option<Refined> {
    let &Question { parts: kernels, space, is_solid, .. } = question;
    let choice = Arc::new(choice.clone());
    let root = |tetrahedron| Cell { tetrahedron, choice: Arc::clone(&choice) };
    let mut fresh: Vec<Cell> = grid.roots().into_iter().map(root).collect();
    let mut refined =
        Refined { leaves: Vec::new(), values: CornerMap::default(), failing: CornerSet::default() };
    // Leaves from this one on have not been proven.
    let mut unproven = 0;
    loop {
        let first = refined.leaves.len();
        let answers = ask(question, &fresh, wanted)?;
        for (Cell { tetrahedron: cell, choice }, answer) in fresh.drain(..).zip(answers) {
            let kind = match answer {
                Answer::Open(local) => {
                    let near = is_near(space, &cell, &local.parts, limits.tolerance);
                    Kind::Open { local, near }
                }
                Answer::Empty(-1) if is_solid && has_face(space, &cell) => Kind::Inside(choice),
                Answer::Empty(_) => continue,
            };
            refined.leaves.push(Leaf { cell, kind });
        }
        let has_room = refined.leaves.len() < limits.most_cells;
        // Tells whether a tetrahedron may be split, down to some size.
        let may_split = |cell: &Tetrahedron, least: f64| {
            has_room && !cell.is_finest() && size(space, cell) > least
        };
        let mut middles: Vec<Corner> = refined.leaves[first..]
            .iter()
            .filter(|leaf| match &leaf.kind {
                Kind::Open { local, near: false } => {
                    let is_smooth = local.parts.iter().all(|part| part.gradient.is_some());
                    // Where the function may jump or end, only samples tell, in whole planes.
                    let share = if is_smooth { 0.125 } else { 2.0 };
                    may_split(&leaf.cell, share * limits.tolerance)
                }
                Kind::Open { near: true, .. } | Kind::Inside(_) => false,
            })
            .map(|leaf| leaf.cell.middle())
            .collect();
        if middles.is_empty() {
            let failing = refined.prove(kernels, space, unproven, wanted)?;
            unproven = refined.leaves.len();
            if failing.len() as f64 <= MOST_FAILING * limits.most_cells as f64 {
                let fails = failing.iter().map(|leaf| &refined.leaves[*leaf].cell);
                let split = fails.filter(|cell| may_split(cell, limits.finest));
                middles.extend(split.map(Tetrahedron::middle));
            }
        }
        if middles.is_empty() {
            refined.keep_used();
            return Some(refined);
        }
        for middle in middles {
            grid.split(middle);
        }
        let (mut kept, mut number) = (0, 0);
        refined.leaves.retain(|leaf| {
            let stays = !grid.is_split(&leaf.cell);
            kept += usize::from(stays && number < unproven);
            number += 1;
            if !stays {
                let choice = leaf.choice();
                let mut open = vec![leaf.cell];
                while let Some(tetrahedron) = open.pop() {
                    if grid.is_split(&tetrahedron) {
                        open.extend(tetrahedron.halves());
                    } else {
                        fresh.push(Cell { tetrahedron, choice: Arc::clone(choice) });
                    }
                }
            }
            stays
        });
        unproven = kept;
    }
}

/// The largest extent of a tetrahedron along an axis.
fn size(space: &Space, cell: &Tetrahedron) -> f64 {
    space.between(cell.bounds()).iter().map(|along| along.hi - along.lo).fold(0.0, f64::max)
}

/// Returns whether three corners are on one face of the domain.
fn has_face(space: &Space, cell: &Tetrahedron) -> bool {
    let on = cell.corners.map(|corner| space.faces(corner));
    (0..3).any(|axis| on.iter().filter(|on| on[axis]).count() >= 3)
}

/// Returns whether mesh and surface are proven to be within a distance of each other in a
/// tetrahedron, if the shape is proven.
fn is_near(space: &Space, cell: &Tetrahedron, parts: &[PartBounds], distance: f64) -> bool {
    let slopes = |part: &PartBounds| {
        part.gradient.map(|gradient| Slopes { gradient, linear: middle(&gradient) })
    };
    let Some(slopes) = parts.iter().map(slopes).collect::<Option<Vec<Slopes>>>() else {
        return false;
    };
    let Some(vector) = common_vector(&slopes, [false; 3]) else { return false };
    // Both |f| on the mesh and |g| on the surface are at most the bend. Along the vector, either
    // changes at least at the least slope.
    let corners = space.corners(cell);
    let least = slopes.iter().map(|part| least_slope(&part.gradient, vector).0);
    let reach = distance * least.fold(f64::INFINITY, f64::min);
    // False for NaN.
    slopes.iter().all(|part| bend(&part.gradient, &corners) <= reach)
}

impl Leaf {
    /// The function in the tetrahedron.
    pub fn choice(&self) -> &Arc<Choice> {
        match &self.kind {
            Kind::Open { local, .. } => &local.choice,
            Kind::Inside(choice) => choice,
        }
    }
}

impl Refined {
    /// Looks for vectors at the corners of leaves from `first` on. Returns the leaves at corners
    /// where none is found, in order. `None` once `wanted` returns false.
    fn prove(
        &mut self,
        kernels: &[PartKernels<'_>],
        space: &Space,
        first: usize,
        wanted: &(dyn Fn() -> bool + Sync),
    ) -> Option<Vec<usize>> {
        self.sample(kernels, space, first);
        let mut stars: CornerMap<Corner, Vec<u32>> = CornerMap::default();
        let is_open = |leaf: &&Leaf| matches!(leaf.kind, Kind::Open { .. });
        for leaf in self.leaves[first..].iter().filter(is_open) {
            for corner in leaf.cell.corners {
                stars.entry(corner).or_default();
            }
        }
        for (number, leaf) in self.leaves.iter().enumerate() {
            if is_open(&leaf) {
                for corner in leaf.cell.corners {
                    if let Some(star) = stars.get_mut(&corner) {
                        star.push(number as u32);
                    }
                }
            }
        }
        let slopes: Vec<Option<Vec<Slopes>>> = self
            .leaves
            .par_iter()
            .map(|leaf| {
                let Kind::Open { local, .. } = &leaf.kind else { return None };
                let corners = space.corners(&leaf.cell);
                let slopes = |part: &PartBounds| {
                    let gradient = part.gradient?;
                    let values = leaf.cell.corners.map(|corner| self.values[&(corner, part.part)]);
                    Some(Slopes { gradient, linear: linear_gradient(&corners, &values) })
                };
                local.parts.iter().map(slopes).collect()
            })
            .collect();
        let stars: Vec<(Corner, Vec<u32>)> = stars.into_iter().collect();
        let is_proven = |(corner, star): &(Corner, Vec<u32>)| {
            let mut all = Vec::new();
            for number in star {
                let Some(slopes) = &slopes[*number as usize] else { return false };
                all.extend_from_slice(slopes);
            }
            common_vector(&all, space.faces(*corner)).is_some()
        };
        let asked = |star| wanted().then(|| is_proven(star));
        let proven: Vec<bool> = stars.par_iter().map(asked).collect::<Option<_>>()?;
        let mut leaves = Vec::new();
        for ((corner, star), proven) in stars.into_iter().zip(proven) {
            if proven {
                self.failing.remove(&corner);
            } else {
                self.failing.insert(corner);
                leaves.extend(star.into_iter().map(|number| number as usize));
            }
        }
        leaves.sort_unstable();
        leaves.dedup();
        Some(leaves)
    }

    /// Adds the values of the parts that matter, at the corners of leaves from `first` on.
    fn sample(&mut self, kernels: &[PartKernels<'_>], space: &Space, first: usize) {
        let mut corners = vec![Vec::new(); kernels.len()];
        for leaf in &self.leaves[first..] {
            let Kind::Open { local, .. } = &leaf.kind else { continue };
            for PartBounds { part, .. } in &local.parts {
                for corner in leaf.cell.corners {
                    self.values.entry((corner, *part)).or_insert_with(|| {
                        corners[usize::from(*part)].push(corner);
                        0.0
                    });
                }
            }
        }
        for (part, corners) in corners.into_iter().enumerate() {
            let points: Vec<DVec3> = corners.iter().map(|corner| space.at(*corner)).collect();
            for (corner, value) in corners.into_iter().zip(sample(kernels[part].samples, &points)) {
                // At a zero, g may have either sign.
                let value = if value == 0.0 { f64::MIN_POSITIVE } else { value };
                // Symmetric parts are equal on whole planes of the grid. They are told apart.
                let moved = if kernels.len() == 1 { value } else { value * factor(corner, part) };
                self.values.insert((corner, part as u16), moved);
            }
        }
    }

    /// Forgets corners of tetrahedra that were split.
    fn keep_used(&mut self) {
        let mut used = CornerSet::default();
        for leaf in &self.leaves {
            for corner in leaf.cell.corners {
                used.insert(corner);
            }
        }
        self.values.retain(|(corner, _), _| used.contains(corner));
        self.failing.retain(|corner| used.contains(corner));
    }
}

/// A number near 1 that differs from part to part and from corner to corner.
fn factor(corner: Corner, part: usize) -> f64 {
    let mut hasher = CornerHasher::default();
    corner.hash(&mut hasher);
    hasher.write_u16(part as u16);
    let share = hasher.finish() as f64 / u64::MAX as f64;
    1.0 + APART * (share - 0.5)
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
