//! Triangles of cells, each proven to be near the surface.
//!
//! A cell is a polygon in the rectangle of u and v. Its corners are those of the cell, and all
//! corners of others on its edges. So nothing is torn.

use super::division::{Wanted, axes, diagonals, evaluated, parts};
use super::fine::{Corner, Fine};
use super::{Cell, Place, Ranges, parameter};
use crate::parametric::sides::Sides;
use glam::DVec3;
use rayon::prelude::*;
use rustc_hash::FxHashMap;
use std::collections::{BTreeMap, BTreeSet};
use zeroset_eval::LANES;
use zeroset_space::PatchTree;

/// A cell with more corners is divided. The time to find its triangles grows with the third power.
const MOST_CORNERS: usize = 24;

/// A corner of a polygon.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Vertex {
    place: Place,
    /// The vertex of the mesh. Several places may have the same one.
    number: u32,
}

/// A cell and its triangles.
pub(super) struct Face {
    pub cell: Cell,
    /// The corners of the cell's polygon, counterclockwise.
    polygon: Vec<Vertex>,
    /// Triangles of vertices. A corner may be there twice, where a side of the cell is one point.
    pub triangles: Vec<[u32; 3]>,
    /// True if the triangles are proven to be near the surface.
    pub is_near: bool,
}

/// Vertices of cells, and the places where they are.
pub(super) struct Triangulation<'a> {
    tree: &'a PatchTree,
    sides: Sides,
    is_single: bool,
    /// Per u, the v of all corners with that u; and the same the other way around.
    corners: [BTreeMap<u32, BTreeSet<u32>>; 2],
    /// The vertex at each place.
    numbers: FxHashMap<Place, u32>,
    places: Vec<Place>,
    /// The vertices in space.
    pub points: Vec<DVec3>,
}

impl<'a> Triangulation<'a> {
    pub fn new(tree: &'a PatchTree, sides: Sides, is_single: bool) -> Self {
        let (corners, numbers) = (Default::default(), FxHashMap::default());
        let (places, points) = (Vec::new(), Vec::new());
        Self { tree, sides, is_single, corners, numbers, places, points }
    }

    /// The triangles of all cells. Cells whose triangles are not near the surface are divided.
    /// `None` once the work is to end.
    pub fn faces(&mut self, cells: Vec<Cell>, wanted: &Wanted) -> Option<Vec<Face>> {
        let face = |cell| Face { cell, polygon: Vec::new(), triangles: Vec::new(), is_near: false };
        let mut faces: Vec<Face> = cells.into_iter().map(face).collect();
        self.add_corners(faces.iter().map(|face| face.cell.ranges));
        loop {
            if !(wanted.goes_on)() {
                return None;
            }
            let polygons: Vec<Vec<Vertex>> =
                faces.iter().map(|face| self.polygon(&face.cell.ranges)).collect();
            self.add_points();
            let is_full = faces.len() > wanted.most_cells;
            let divided: Vec<Vec<Cell>> = faces
                .par_iter_mut()
                .zip(polygons)
                .map(|(face, polygon)| self.update(face, polygon, is_full, wanted))
                .collect();
            if divided.iter().all(Vec::is_empty) {
                return Some(faces);
            }
            self.add_corners(divided.iter().flatten().map(|cell| cell.ranges));
            let mut is_divided = divided.iter().map(|parts| !parts.is_empty());
            faces.retain(|_| !is_divided.next().unwrap_or(false));
            let used = divided.into_iter().flatten().filter(|cell| !cell.is_nowhere);
            faces.extend(used.map(face));
        }
    }

    /// Gives a face the triangles of a polygon. Returns the parts of its cell if it must be divided
    /// instead.
    fn update(
        &self,
        face: &mut Face,
        polygon: Vec<Vertex>,
        is_full: bool,
        wanted: &Wanted,
    ) -> Vec<Cell> {
        if face.polygon == polygon {
            return Vec::new();
        }
        face.polygon = polygon;
        let cell = face.cell;
        let is_divisible = !is_full && (cell.is_divisible(0) || cell.is_divisible(1));
        let is_small = face.polygon.len() <= MOST_CORNERS || !is_divisible;
        if is_small {
            self.triangulate(face, wanted.distance);
        }
        let is_done = face.is_near || !cell.is_continuous || cell.is_outside;
        if is_small && is_done || !is_divisible {
            return Vec::new();
        }
        let fine = Fine::new(self.tree, &cell.ranges);
        let axes = axes(self.tree, &cell, &fine, wanted.cut);
        evaluated(self.tree, &parts(&cell.ranges, axes), wanted.cut)
    }

    /// Adds the corners of cells, which are vertices.
    fn add_corners(&mut self, cells: impl Iterator<Item = Ranges>) {
        for [us, vs] in cells {
            for u in us {
                for v in vs {
                    for [u, v] in self.sides.copies([u, v]) {
                        self.corners[0].entry(u).or_default().insert(v);
                        self.corners[1].entry(v).or_default().insert(u);
                    }
                }
            }
        }
    }

    /// The polygon of a cell: all corners on its edges, counterclockwise.
    fn polygon(&mut self, &[us, vs]: &Ranges) -> Vec<Vertex> {
        let along = |axis: usize, at: u32, [low, high]: [u32; 2]| -> Vec<u32> {
            let line = self.corners[axis].get(&at);
            line.into_iter().flat_map(|line| line.range(low..high)).copied().collect()
        };
        let backward = |axis: usize, at: u32, [low, high]: [u32; 2]| -> Vec<u32> {
            let line = self.corners[axis].get(&at);
            let inner = line.into_iter().flat_map(|line| line.range(low + 1..=high));
            inner.rev().copied().collect()
        };
        let [[left, right], [below, above]] = [us, vs];
        let mut round: Vec<Place> = Vec::new();
        round.extend(along(1, below, us).into_iter().map(|u| [u, below]));
        round.extend(along(0, right, vs).into_iter().map(|v| [right, v]));
        round.extend(backward(1, above, us).into_iter().map(|u| [u, above]));
        round.extend(backward(0, left, vs).into_iter().map(|v| [left, v]));
        let vertex = |place| Vertex { place, number: self.vertex(place) };
        round.into_iter().map(vertex).collect()
    }

    /// The vertex at a place.
    fn vertex(&mut self, place: Place) -> u32 {
        let place = self.sides.first(place);
        let next = self.places.len() as u32;
        let number = *self.numbers.entry(place).or_insert(next);
        if number == next {
            self.places.push(place);
        }
        number
    }

    /// Computes the places of new vertices in space.
    fn add_points(&mut self) {
        let some = |places: &[Place]| {
            let cell = |&[u, v]: &Place| {
                let [u, v] = [parameter(self.tree, 0, u), parameter(self.tree, 1, v)];
                [[u, u], [v, v]]
            };
            let found = self.tree.over(&places.iter().map(cell).collect::<Vec<_>>());
            let point = |lane: usize| {
                let at = DVec3::from_array([0, 1, 2].map(|axis| found.centre[axis][lane]));
                if self.is_single { at.as_vec3().as_dvec3() } else { at }
            };
            (0..places.len()).map(point).collect::<Vec<_>>()
        };
        let new = &self.places[self.points.len()..];
        let points: Vec<DVec3> = new.par_chunks(LANES).flat_map_iter(some).collect();
        self.points.extend(points);
    }

    fn point(&self, vertex: &Vertex) -> DVec3 {
        self.points[vertex.number as usize]
    }

    /// Finds triangles of a face's polygon, and whether they are within a distance of the surface.
    fn triangulate(&self, face: &mut Face, distance: f64) {
        let polygon = &face.polygon[..];
        let numbers = |one: [usize; 3]| one.map(|k| polygon[k].number);
        if let (4, Some(fitting)) = (polygon.len(), face.cell.fitting) {
            face.is_near = true;
            face.triangles = fitting.map(numbers).to_vec();
            return;
        }
        let length = |one: usize, other: usize| {
            self.point(&polygon[one]).distance_squared(self.point(&polygon[other]))
        };
        let is_asked = face.cell.is_continuous && !face.cell.is_outside;
        let fine = (is_asked && 2.0 * face.cell.error > distance)
            .then(|| Fine::new(self.tree, &face.cell.ranges));
        let corner = |k: usize| {
            let Vertex { place, .. } = polygon[k];
            let at = [0, 1].map(|axis| parameter(self.tree, axis, place[axis]));
            Corner { at, place: self.point(&polygon[k]) }
        };
        let are_near = |triangles: &[[usize; 3]]| match &fine {
            Some(fine) => triangles.iter().all(|one| fine.is_near(&one.map(corner), distance)),
            None => face.cell.is_continuous,
        };
        let mut triangles = if let [a, b, c, d] = polygon {
            diagonals(&[a, b, c, d].map(|corner| self.point(corner))).map(Vec::from).to_vec()
        } else {
            vec![shortest(polygon, &length)]
        };
        let found = triangles.iter().position(|some| are_near(some));
        face.is_near = found.is_some();
        let found = triangles.swap_remove(found.unwrap_or(0));
        face.triangles = found.into_iter().map(numbers).collect();
    }

    /// The longest edge of a face's polygon.
    pub fn longest_edge(&self, face: &Face) -> f64 {
        let ends = face.polygon.iter().zip(face.polygon.iter().cycle().skip(1));
        let length = |(one, other)| self.point(one).distance(self.point(other));
        // NaN counts as long.
        let longer = |most: f64, length: f64| if length <= most { most } else { length };
        ends.map(length).fold(0.0, longer)
    }
}

/// Divides a polygon into triangles by the diagonals of the least sum of squared lengths. No
/// triangle has three corners on one side of the cell.
fn shortest(polygon: &[Vertex], length: &dyn Fn(usize, usize) -> f64) -> Vec<[usize; 3]> {
    let count = polygon.len();
    let turns_left = |a: usize, b: usize, c: usize| {
        let [a, b, c] = [a, b, c].map(|k| polygon[k].place.map(i64::from));
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 0
    };
    // For the part of the polygon between two corners: its cost, and its triangle at the diagonal.
    let mut best = vec![(0.0, 0); count * count];
    for gap in 2..count {
        for from in 0..count - gap {
            let to = from + gap;
            let is_diagonal = gap + 1 < count;
            let own = if is_diagonal { length(from, to) } else { 0.0 };
            let own = if own.is_nan() { 0.0 } else { own };
            let cost =
                |middle: &usize| own + best[from * count + middle].0 + best[middle * count + to].0;
            let possible = (from + 1..to).filter(|middle| turns_left(from, *middle, to));
            let least = possible.map(|middle| (cost(&middle), middle));
            let least = least.min_by(|(one, _), (other, _)| one.total_cmp(other));
            best[from * count + to] = least.unwrap_or((f64::INFINITY, from + 1));
        }
    }
    let (mut triangles, mut open) = (Vec::with_capacity(count - 2), vec![(0, count - 1)]);
    while let Some((from, to)) = open.pop() {
        if to - from < 2 {
            continue;
        }
        let middle = best[from * count + to].1;
        triangles.push([from, middle, to]);
        open.extend([(from, middle), (middle, to)]);
    }
    triangles
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parametric::cut::Cut;
    use crate::parametric::division::divided;
    use crate::parametric::program;
    use zeroset_space::Region;

    /// All triangles are compared with finer parts of the surface, at the same u and v.
    #[test]
    fn all_triangles_are_near_the_surface() {
        let mut proven = [0, 0];
        for text in [
            "((2 + cos v) cos u, (2 + cos v) sin u, sin v) for u in [0, 2pi], v in [0, 2pi]",
            "(u, v, exp(-20 (u^2 + v^2))) for u in [-1.1, 1], v in [-1, 0.9]",
            "(u v, u^2 - v, v^3 + u v) for u in [-1, 1], v in [-1, 2]",
        ] {
            let program = program(text);
            let tree = program.patch(0).expect(text).tree().expect("a kernel");
            let region = Region::new(DVec3::splat(-9.0), DVec3::splat(9.0)).expect("a region");
            let (cut, goes_on) = (Cut::new(&region, 0.0, 1.0), || true);
            let distance = 0.01;
            let wanted = Wanted {
                distance,
                is_linear: false,
                most_cells: 9999,
                cut: &cut,
                goes_on: &goes_on,
            };
            let cells = divided(tree, &wanted).expect("wanted");
            let mut all = Triangulation::new(tree, Sides::find(tree, 9.0), false);
            for face in all.faces(cells, &wanted).expect("wanted") {
                assert!(face.is_near, "{text}");
                proven[usize::from(face.polygon.len() == 4 && face.cell.fitting.is_some())] += 1;
                let fine = Fine::new(tree, &face.cell.ranges);
                for triangle in &face.triangles {
                    let corners = triangle.map(|number| {
                        let has = |vertex: &&Vertex| vertex.number == number;
                        let Vertex { place, .. } = face.polygon.iter().find(has).expect("a corner");
                        let at = [0, 1].map(|axis| parameter(tree, axis, place[axis]));
                        Corner { at, place: all.points[number as usize] }
                    });
                    assert!(fine.is_near(&corners, distance + 1e-12), "{text}");
                }
            }
        }
        println!("{proven:?} cells proven at the end and before");
        assert!(proven.iter().all(|count| *count > 100), "{proven:?}");
    }
}
