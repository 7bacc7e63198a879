//! Refines a grid until the shape of the surface in it is proven, and the mesh is near enough.

use crate::cells::{Answer, Bounds, CellKernels, ask};
use crate::grid::{Corner, CornerMap, Grid, Tetrahedron};
use crate::proof::{Slopes, bend, common_vector, least_slope, linear_gradient, middle};
use crate::space::Space;
use glam::DVec3;
use rayon::prelude::*;
use zeroset_eval::{Kernel, LANES, Points, Sample, Values};

/// Number of tetrahedra beyond which none is split.
const MOST_CELLS: usize = 3_000_000;
/// Number of tetrahedra that may fail the proof at a time. If more do, none is split for the proof.
const MOST_FAILING: usize = 300_000;

/// A tetrahedron of the refined grid.
pub struct Leaf {
    pub cell: Tetrahedron,
    pub kind: Kind,
}

/// The part that a tetrahedron has in the mesh.
pub enum Kind {
    /// The surface may be in it. `near` states that the mesh is proven to be within the tolerance.
    Open { bounds: Bounds, near: bool },
    /// It is inside a solid, and has a face on the boundary of the domain.
    Inside,
}

/// How far a grid is refined.
#[derive(Clone, Copy)]
pub struct Limits {
    /// Largest allowed distance between mesh and surface, in world units.
    pub tolerance: f64,
    /// Size of tetrahedra that are not split for the proof, in world units.
    pub finest: f64,
}

/// A refined grid.
pub struct Refined {
    pub leaves: Vec<Leaf>,
    /// Values at the leaves' corners, by the sample kernel. NaN if undefined.
    pub values: CornerMap<Corner, f64>,
    /// Corners at which the proof fails.
    pub failing: CornerMap<Corner, ()>,
}

/// Refines `grid` for a function. `is_solid` keeps tetrahedra inside of a solid at the boundary of
/// the domain. Returns `None` once `wanted` returns false.
pub fn refine(
    kernels: CellKernels<'_>,
    samples: &dyn Kernel<Sample, f64>,
    space: &Space,
    grid: &mut Grid,
    limits: Limits,
    is_solid: bool,
    wanted: &dyn Fn() -> bool,
) -> Option<Refined> {
    let mut fresh = grid.roots();
    let mut refined =
        Refined { leaves: Vec::new(), values: CornerMap::default(), failing: CornerMap::default() };
    // Leaves from this one on have not been proven.
    let mut unproven = 0;
    loop {
        if !wanted() {
            return None;
        }
        let first = refined.leaves.len();
        let answers = ask(kernels, space, &fresh);
        for (cell, answer) in fresh.drain(..).zip(answers) {
            let kind = match answer {
                Answer::Open(bounds) => {
                    Kind::Open { bounds, near: is_near(space, &cell, &bounds, limits.tolerance) }
                }
                Answer::Empty(-1) if is_solid && has_face(space, &cell) => Kind::Inside,
                Answer::Empty(_) => continue,
            };
            refined.leaves.push(Leaf { cell, kind });
        }
        let has_room = refined.leaves.len() < MOST_CELLS;
        // Whether a tetrahedron may be split until it is of some size.
        let may_split = |cell: &Tetrahedron, least: f64| {
            has_room && !grid.is_finest(cell) && size(space, cell) > least
        };
        let mut middles: Vec<Corner> = refined.leaves[first..]
            .iter()
            .filter(|leaf| match &leaf.kind {
                Kind::Open { bounds: Bounds { gradient: Some(_), .. }, near: false } => {
                    may_split(&leaf.cell, 0.125 * limits.tolerance)
                }
                Kind::Open { bounds: Bounds { gradient: None, .. }, .. } => {
                    may_split(&leaf.cell, limits.tolerance)
                }
                _ => false,
            })
            .map(|leaf| leaf.cell.middle())
            .collect();
        if middles.is_empty() {
            let failing = refined.prove(samples, space, unproven);
            unproven = refined.leaves.len();
            if failing.len() <= MOST_FAILING {
                let fails = failing.iter().map(|leaf| &refined.leaves[*leaf].cell);
                let split = fails.filter(|cell| may_split(cell, limits.finest));
                middles.extend(split.map(Tetrahedron::middle));
            }
        }
        if middles.is_empty() {
            refined.keep_used();
            return Some(refined);
        }
        middles.into_iter().for_each(|middle| grid.split(middle));
        let (mut kept, mut number) = (0, 0);
        refined.leaves.retain(|leaf| {
            let stays = !grid.is_split(&leaf.cell);
            kept += usize::from(stays && number < unproven);
            number += 1;
            if !stays {
                let mut open = vec![leaf.cell];
                while let Some(cell) = open.pop() {
                    if grid.is_split(&cell) { open.extend(cell.halves()) } else { fresh.push(cell) }
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

/// Returns whether the mesh in a tetrahedron is proven to be within a distance of the surface, and
/// the surface in it within that distance of the mesh, if the shape is proven.
fn is_near(space: &Space, cell: &Tetrahedron, bounds: &Bounds, distance: f64) -> bool {
    let Some(gradient) = &bounds.gradient else { return false };
    let Some(vector) = middle(gradient).try_normalize() else { return false };
    // Both |f| on the mesh and the linear function on the surface are at most the bend. Along the
    // vector, either changes at least at the least slope.
    bend(gradient, &space.corners(cell)) <= distance * least_slope(gradient, vector).0
}

impl Refined {
    /// Looks for vectors at the corners of leaves from `first` on. Returns the leaves at corners
    /// where none is found, in order.
    fn prove(
        &mut self,
        samples: &dyn Kernel<Sample, f64>,
        space: &Space,
        first: usize,
    ) -> Vec<usize> {
        self.sample(samples, space, first);
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
        let slopes: Vec<Option<Slopes>> = self
            .leaves
            .par_iter()
            .map(|leaf| {
                let Kind::Open { bounds: Bounds { gradient: Some(gradient), .. }, .. } = leaf.kind
                else {
                    return None;
                };
                let values = leaf.cell.corners.map(|corner| self.values[&corner]);
                let linear = linear_gradient(&space.corners(&leaf.cell), &values);
                Some(Slopes { gradient, linear })
            })
            .collect();
        let stars: Vec<(Corner, Vec<u32>)> = stars.into_iter().collect();
        let is_proven = |(corner, star): &(Corner, Vec<u32>)| {
            let star: Option<Vec<Slopes>> =
                star.iter().map(|number| slopes[*number as usize]).collect();
            star.is_some_and(|star| common_vector(&star, space.faces(*corner)).is_some())
        };
        let proven: Vec<bool> = stars.par_iter().map(is_proven).collect();
        let mut leaves = Vec::new();
        for ((corner, star), proven) in stars.into_iter().zip(proven) {
            if proven {
                self.failing.remove(&corner);
            } else {
                self.failing.insert(corner, ());
                leaves.extend(star.into_iter().map(|number| number as usize));
            }
        }
        leaves.sort_unstable();
        leaves.dedup();
        leaves
    }

    /// Adds the values at the corners of leaves from `first` on.
    fn sample(&mut self, samples: &dyn Kernel<Sample, f64>, space: &Space, first: usize) {
        let mut corners = Vec::new();
        for leaf in &self.leaves[first..] {
            for corner in leaf.cell.corners {
                self.values.entry(corner).or_insert_with(|| {
                    corners.push(corner);
                    0.0
                });
            }
        }
        let points: Vec<DVec3> = corners.iter().map(|corner| space.at(*corner)).collect();
        for (corner, value) in corners.into_iter().zip(sample(samples, &points)) {
            // At a zero, g may have either sign.
            let value = if value == 0.0 { f64::MIN_POSITIVE } else { value };
            self.values.insert(corner, value);
        }
    }

    /// Forgets corners of tetrahedra that were split.
    fn keep_used(&mut self) {
        let mut used: CornerMap<Corner, ()> = CornerMap::default();
        for leaf in &self.leaves {
            for corner in leaf.cell.corners {
                used.insert(corner, ());
            }
        }
        self.values.retain(|corner, _| used.contains_key(corner));
        self.failing.retain(|corner, ()| used.contains_key(corner));
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
