//! Points beside a parametric surface: the nearest point of the surface, and its normal.
//!
//! Everything is computed in floats rounded to nearest. No proof depends on it.

use super::normals::{Normals, Spot};
use glam::DVec3;
use std::sync::Arc;
use zeroset_eval::{
    Gradients, Kernel, KernelFloat, LANES, Lanes, Patches, Points, Sample, SampleGradient, Values,
};
use zeroset_space::{PatchNode, PatchTree};

/// The function that is the signed distance from the surface near it, with the surface's unit
/// normal as gradient. The normal is the cross product of the derivatives with respect to u and v.
pub(super) struct Beside {
    pub tree: Arc<PatchTree>,
    pub normals: Arc<Normals>,
}

/// Rounds of Newton's method.
const ROUNDS: u32 = 4;
/// A cell is flat enough to begin Newton's method if its error is below this share of its size.
const FLAT: f64 = 0.05;
/// After steps below this share of the ranges of u and v, Newton's method has converged.
const NEAR: f64 = 1e-3;
/// Largest number of levels below the root at which a point is looked for.
const DEPTH: u32 = 6;
/// Largest number of nodes in which one point is looked for.
const NODES: u32 = 4096;
/// Largest number of cells in which Newton's method begins, for one point.
const STARTS: usize = 4;
impl Beside {
    /// By Newton's method, the points of the surface nearest to each of `points`, from a start for
    /// each.
    fn refined(&self, points: &[DVec3], starts: Vec<[f64; 2]>) -> Vec<Spot> {
        let outer = self.tree.outer();
        let mut places = starts;
        let mut spots = self.normals.spots(&places);
        for _ in 0..ROUNDS {
            let mut is_near = true;
            for ((place, spot), point) in places.iter_mut().zip(&spots).zip(points) {
                let [du, dv] = nearest(*point - spot.at, spot.along_u, spot.along_v);
                for (axis, step) in [du, dv].into_iter().enumerate() {
                    let [low, high] = outer[axis];
                    if step.is_finite() {
                        place[axis] = (spot.uv[axis] + step).clamp(low, high);
                        is_near &= step.abs() <= NEAR * (high - low);
                    }
                }
            }
            spots = self.normals.spots(&places);
            if is_near {
                break;
            }
        }
        spots
    }

    /// The point of the surface nearest to each of `points`.
    fn nearest(&self, points: &[DVec3]) -> Vec<Spot> {
        let Some(first) = points.first() else { return Vec::new() };
        let start = self.nearest_from_cells(std::slice::from_ref(first))[0];
        let reach = 2.0 * start.at.distance(*first) + 1e-7 * (first.length() + start.at.length());
        let mut spots = self.refined(points, vec![start.uv; points.len()]);
        spots[0] = start;
        // Neighbors are mostly reached from the first point.
        let is_lost = |k: &usize| {
            let distance = spots[*k].at.distance(points[*k]);
            distance > reach || distance.is_nan()
        };
        let lost: Vec<usize> = (1..points.len()).filter(is_lost).collect();
        let places: Vec<DVec3> = lost.iter().map(|k| points[*k]).collect();
        for (k, spot) in lost.iter().zip(self.nearest_from_cells(&places)) {
            spots[*k] = spot;
        }
        spots
    }

    /// As [`Self::nearest`], from the cells nearest to each point.
    fn nearest_from_cells(&self, points: &[DVec3]) -> Vec<Spot> {
        let (mut owners, mut starts) = (Vec::new(), Vec::new());
        for (owner, point) in points.iter().enumerate() {
            for start in self.starts(*point) {
                owners.push(owner);
                starts.push(start);
            }
        }
        let targets: Vec<DVec3> = owners.iter().map(|owner| points[*owner]).collect();
        let mut best: Vec<Option<(f64, Spot)>> = vec![None; points.len()];
        for ((owner, spot), target) in
            owners.iter().zip(self.refined(&targets, starts)).zip(targets)
        {
            let distance = spot.at.distance_squared(target);
            let best = &mut best[*owner];
            if !distance.is_nan() && best.is_none_or(|(least, _)| distance < least) {
                *best = Some((distance, spot));
            }
        }
        let nothing = Spot { at: DVec3::NAN, ..Spot::default() };
        best.into_iter().map(|found| found.map_or(nothing, |(_, spot)| spot)).collect()
    }

    /// Parameters near which the point of the surface nearest to `point` may be.
    fn starts(&self, point: DVec3) -> Vec<[f64; 2]> {
        if !point.is_finite() {
            return Vec::new();
        }
        // Squares of distances, and parameters; the nearest first.
        let mut found: Vec<(f64, [f64; 2])> = Vec::new();
        let mut open = vec![OpenNode { least: 0.0, place: None, depth: 0 }];
        let mut left = NODES;
        while let Some(OpenNode { least, place, depth }) = open.pop().filter(|_| left > 0) {
            left -= 1;
            let limit = |found: &[(f64, [f64; 2])]| {
                found.get(STARTS - 1).map_or(f64::INFINITY, |(distance, _)| *distance)
            };
            if least > limit(&found) {
                continue;
            }
            let node =
                place.map_or_else(|| self.tree.root(), |(above, lane)| self.tree.part(above, lane));
            let mut parts = Vec::new();
            for lane in (0..LANES).filter(|lane| node.cells.nowhere >> lane & 1 == 0) {
                let shape = Shape::new(&node.cells, lane);
                let least = shape.least_distance_squared(point);
                if least > limit(&found) {
                    continue;
                }
                if depth < DEPTH && left > 0 && !shape.is_flat() {
                    parts.push((least, lane));
                    continue;
                }
                let symbols = nearest(point - shape.centre, shape.along_u, shape.along_v);
                let [u, v] = symbols
                    .map(|symbol| if symbol.is_nan() { 0.0 } else { symbol.clamp(-1.0, 1.0) });
                let at = shape.centre + shape.along_u * u + shape.along_v * v;
                let place = [0, 1].map(|axis| {
                    node.cells.middle[axis][lane] + node.cells.half[axis][lane] * [u, v][axis]
                });
                let distance = at.distance_squared(point);
                let rank = found.partition_point(|(other, _)| *other < distance);
                found.insert(rank, (distance, place));
                found.truncate(STARTS);
            }
            // The nearest part is examined first.
            parts.sort_by(|(one, _), (other, _)| other.total_cmp(one));
            let new =
                |(least, lane)| OpenNode { least, place: Some((node, lane)), depth: depth + 1 };
            open.extend(parts.into_iter().map(new));
        }
        found.into_iter().map(|(_, place)| place).collect()
    }
}

/// A node in which a point is still to be looked for.
struct OpenNode<'a> {
    /// Square of the least distance of its points.
    least: f64,
    /// The node above, and the number of the cell that is divided. `None` for the root.
    place: Option<(&'a PatchNode, usize)>,
    depth: u32,
}

/// The surface over one cell.
struct Shape {
    centre: DVec3,
    along_u: DVec3,
    along_v: DVec3,
    error: DVec3,
}

impl Shape {
    fn new(cells: &Patches<f64>, lane: usize) -> Self {
        let of = |[x, y, z]: &[Lanes<f64>; 3]| DVec3::new(x[lane], y[lane], z[lane]);
        Self {
            centre: of(&cells.centre),
            along_u: of(&cells.along_u),
            along_v: of(&cells.along_v),
            error: of(&cells.error),
        }
    }

    fn is_flat(&self) -> bool {
        let size = self.along_u.length().max(self.along_v.length());
        self.error.max_element() <= FLAT * size
    }

    /// The square of the distance from a point to the box of the cell.
    fn least_distance_squared(&self, point: DVec3) -> f64 {
        let reach = self.along_u.abs() + self.along_v.abs() + self.error;
        let beyond = ((point - self.centre).abs() - reach).max(DVec3::ZERO);
        let squared = beyond.length_squared();
        if squared.is_nan() { 0.0 } else { squared }
    }
}

/// The numbers a and b for which a·`one` + b·`other` is nearest to `way`. They are not finite if
/// the two vectors are parallel.
fn nearest(way: DVec3, one: DVec3, other: DVec3) -> [f64; 2] {
    let (aa, ab, bb) = (one.dot(one), one.dot(other), other.dot(other));
    let (a, b) = (one.dot(way), other.dot(way));
    let determinant = aa * bb - ab * ab;
    [(a * bb - b * ab) / determinant, (b * aa - a * ab) / determinant]
}

impl<T: KernelFloat> Kernel<Sample, T> for Beside {
    fn eval(&self, input: &Points<T>, output: &mut Values<T>) {
        let mut all = Gradients::default();
        Kernel::<SampleGradient, T>::eval(self, input, &mut all);
        output.value = all.value;
    }
}

impl<T: KernelFloat> Kernel<SampleGradient, T> for Beside {
    fn eval(&self, input: &Points<T>, output: &mut Gradients<T>) {
        let points: Vec<DVec3> = (0..input.count as usize)
            .map(|lane| DVec3::from_array(input.at.each_ref().map(|axis| axis[lane].into())))
            .collect();
        let mut spots = self.nearest(&points);
        self.normals.fill_poles(&mut spots);
        for (lane, (spot, point)) in spots.iter().zip(&points).enumerate() {
            let normal = spot.normal().normalize_or(DVec3::NAN);
            output.value[lane] = T::nearest(normal.dot(*point - spot.at));
            for axis in 0..3 {
                output.gradient[axis][lane] = T::nearest(normal[axis]);
            }
        }
    }
}
