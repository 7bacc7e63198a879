//! The division of the rectangle into cells that two triangles fit.

use super::cut::Cut;
use super::fine::{Corner, Fine};
use super::{Cell, PARTS, Ranges, parameter};
use glam::DVec3;
use rayon::prelude::*;
use zeroset_eval::LANES;
use zeroset_space::{PatchCell, PatchTree};

/// Numbers of cells along u, or along v, with which to begin. They are halved, so larger ones are
/// near one of these times a power of 2. They are even, since the halves of a side may be glued.
const FIRST: [u32; 4] = [6, 8, 10, 14];
/// The numbers are chosen by the bends of the surface over so many cells along u, and along v.
const SAMPLES: u32 = 24;
/// An estimate of the number of cells ends at this share of such a cell.
const TINY: f64 = 1e-6;
/// A direction is divided if the surface bends more along it by this factor. Else the longer one
/// is.
const CLEARLY: f64 = 1.1;
/// Cells whose error bends do not explain are divided in both directions, if neither reduces the
/// error by this factor more than the other.
const CLEARLY_LESS: f64 = 1.5;

/// The conditions at which cells are not divided.
#[derive(Clone, Copy)]
pub(super) struct Wanted<'a> {
    /// Largest distance between triangles and surface.
    pub distance: f64,
    /// True if the surface must be half as far from a linear function over each cell.
    pub is_linear: bool,
    /// Largest number of cells that are divided.
    pub most_cells: usize,
    /// The boundary of the domain. Cells outside are not divided.
    pub cut: &'a Cut,
    /// Returns false once the work is to end.
    pub goes_on: &'a (dyn Fn() -> bool + Sync),
}

/// Divides the rectangle. `None` once the work is to end.
pub(super) fn divided(tree: &PatchTree, wanted: &Wanted) -> Option<Vec<Cell>> {
    let [u, v] = first(tree, wanted);
    let mut open = evaluated(tree, &grid(u, v), wanted.cut);
    let mut done = Vec::new();
    while !open.is_empty() {
        if !(wanted.goes_on)() {
            return None;
        }
        let is_full = done.len() + open.len() > wanted.most_cells;
        let axes = |cell: &mut Cell| {
            let is_linear = !cell.is_coarse && 2.0 * cell.error <= wanted.distance;
            let is_done = is_full || cell.is_nowhere || cell.is_outside || is_linear;
            if is_done { [false; 2] } else { axes_to_divide(tree, cell, wanted) }
        };
        let axes: Vec<[bool; 2]> = open.par_iter_mut().map(axes).collect();
        let mut next = Vec::new();
        for (cell, axes) in open.into_iter().zip(axes) {
            match axes {
                [false, false] => done.push(cell),
                axes => next.extend(parts(&cell.ranges, axes)),
            }
        }
        open = evaluated(tree, &next, wanted.cut);
    }
    Some(done)
}

/// The rectangle in equal cells: so many along u, and along v.
fn grid(u: u32, v: u32) -> Vec<Ranges> {
    let range = |k: u32, count: u32| [k * (PARTS / count), (k + 1) * (PARTS / count)];
    (0..u * v).map(|k| [range(k % u, u), range(k / u, v)]).collect()
}

/// Returns numbers of cells along u and v to begin with. By estimates, they lead to the fewest
/// cells.
fn first(tree: &PatchTree, wanted: &Wanted) -> [u32; 2] {
    let mut cells = evaluated(tree, &grid(SAMPLES, SAMPLES), wanted.cut);
    cells.retain(|cell| !cell.is_outside);
    let bends = cells.par_iter().map(|cell| {
        let fine = Fine::new(tree, &cell.ranges);
        (fine.quadric(), fine.error())
    });
    let bends: Vec<([DVec3; 3], f64)> = bends.filter(|(_, error)| error.is_finite()).collect();
    let count = |first: [u32; 2]| -> f64 {
        bends.iter().map(|(terms, error)| cells_in(terms, *error, first, wanted.distance)).sum()
    };
    let all = FIRST.iter().flat_map(|u| FIRST.map(|v| [*u, v])).map(|first| (count(first), first));
    all.min_by(|(one, _), (other, _)| one.total_cmp(other))
        .map_or([FIRST[0]; 2], |(_, first)| first)
}

/// An estimate of the number of cells in one of [`SAMPLES`]² cells. There the surface has these
/// terms of the second degree, and its parts have this error. The whole rectangle begins with
/// `first` cells along u and v.
fn cells_in([uu, uv, vv]: &[DVec3; 3], error: f64, first: [u32; 2], distance: f64) -> f64 {
    let [mut h, mut k] = first.map(|count| f64::from(SAMPLES) / f64::from(count));
    loop {
        let (u, v, turn) = (h * h * *uu, k * k * *vv, h * k * *uv);
        // At the middle of the better diagonal, and of edges.
        let across = (u + v + turn).length().min((u + v - turn).length());
        let (u, v) = (u.length(), v.length());
        // Far smaller cells are not counted.
        let error = error * h.max(k).powi(2);
        if across.max(u).max(v) + error <= distance || h * k < TINY {
            return 1.0 / (h * k);
        }
        *(if u >= v { &mut h } else { &mut k }) *= 0.5;
    }
}

/// Evaluates the surface over cells.
pub(super) fn evaluated(tree: &PatchTree, ranges: &[Ranges], cut: &Cut) -> Vec<Cell> {
    let some = |ranges: &[Ranges]| {
        let cells: Vec<PatchCell> = ranges.iter().map(|one| super::parameters(tree, one)).collect();
        let found = tree.over(&cells);
        let cell = |(lane, ranges): (usize, &Ranges)| Cell::new(*ranges, &found, lane, cut);
        ranges.iter().enumerate().map(cell).collect::<Vec<_>>()
    };
    ranges.par_chunks(LANES).flat_map_iter(some).collect()
}

/// The parts of a cell that is divided along some axes.
pub(super) fn parts(ranges: &Ranges, axes: [bool; 2]) -> Vec<Ranges> {
    let halves = |axis: usize| {
        let [low, high] = ranges[axis];
        let middle = low + (high - low) / 2;
        if axes[axis] { vec![[low, middle], [middle, high]] } else { vec![[low, high]] }
    };
    let (us, vs) = (halves(0), halves(1));
    vs.iter().flat_map(|v| us.iter().map(|u| [*u, *v])).collect()
}

/// The axes along which to divide a cell: none if two triangles between its corners are near the
/// surface, as far as estimates tell, or if it cannot be divided.
fn axes_to_divide(tree: &PatchTree, cell: &mut Cell, wanted: &Wanted) -> [bool; 2] {
    let divisible = [cell.is_divisible(0), cell.is_divisible(1)];
    if divisible == [false; 2] {
        return divisible;
    }
    let fine = Fine::new(tree, &cell.ranges);
    let is_linear = 2.0 * cell.error <= wanted.distance;
    if is_linear || !wanted.is_linear && fits(tree, cell, &fine, wanted.distance) {
        let [length, width] = fine.sides();
        let is_u = divisible[0] && (length >= width || !divisible[1]);
        return if cell.is_coarse { [is_u, !is_u] } else { [false; 2] };
    }
    axes(tree, cell, &fine, wanted.cut)
}

/// Returns whether two triangles between approximate corners of a cell are near the surface. If
/// those between exact corners are proven to be, too, they are [noted](Cell::fitting).
fn fits(tree: &PatchTree, cell: &mut Cell, fine: &Fine, distance: f64) -> bool {
    let [u, v] = [0, 1].map(|axis| cell.ranges[axis].map(|part| parameter(tree, axis, part)));
    let ends = [[u[0], v[0]], [u[1], v[0]], [u[1], v[1]], [u[0], v[1]]];
    let places = fine.corners();
    let corners = [0, 1, 2, 3].map(|k| Corner { at: ends[k], place: places[k] });
    // A cell that bends by more is not compared.
    let [u, v] = fine.bends();
    let least = fine.error() + u.max(v);
    if least.is_nan() || least > distance {
        return false;
    }
    let are_near = |triangles: &[[usize; 3]; 2], distance: f64| {
        triangles.iter().all(|one| fine.is_near(&one.map(|k| corners[k]), distance))
    };
    let both = diagonals(&places);
    // An exact corner is at most this far from the approximate one.
    let proven = both.iter().find(|some| are_near(some, distance - fine.error()));
    cell.fitting = proven.copied();
    proven.is_some() || both.iter().any(|some| are_near(some, distance))
}

/// The two triangles between four corners, by the shorter diagonal and by the other.
pub(super) fn diagonals(places: &[DVec3; 4]) -> [[[usize; 3]; 2]; 2] {
    let [a, b, c, d] = places;
    let (first, second) = ([[0, 1, 2], [0, 2, 3]], [[0, 1, 3], [1, 2, 3]]);
    let is_first = a.distance_squared(*c) <= b.distance_squared(*d);
    if is_first { [first, second] } else { [second, first] }
}

/// The axes along which dividing a cell helps most, of those along which it can be divided.
pub(super) fn axes(tree: &PatchTree, cell: &Cell, fine: &Fine, cut: &Cut) -> [bool; 2] {
    let divisible = [cell.is_divisible(0), cell.is_divisible(1)];
    if divisible != [true; 2] {
        return divisible;
    }
    let [u, v] = fine.bends();
    // False for NaN.
    if fine.error() < u.max(v) {
        let [length, width] = fine.sides();
        let is_u = u > CLEARLY * v || (v <= CLEARLY * u && length >= width);
        return [is_u, !is_u];
    }
    let halves: Vec<Ranges> = [[true, false], [false, true]]
        .into_iter()
        .flat_map(|axes| parts(&cell.ranges, axes))
        .collect();
    let halves = evaluated(tree, &halves, cut);
    let [u, v] = [0, 2].map(|k| halves[k].error.max(halves[k + 1].error));
    if CLEARLY_LESS * u < v {
        [true, false]
    } else if CLEARLY_LESS * v < u {
        [false, true]
    } else {
        [true, true]
    }
}
