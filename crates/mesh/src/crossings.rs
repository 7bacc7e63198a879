//! Pairs of triangles of a mesh that meet where they must not.
//!
//! Signs of volumes are exact, so a pair that crosses does so in the numbers of the file. Pairs
//! that do not cross must be [proven apart](crate::embedding), or they count as touching.

use crate::embedding::{Triangle, least_distance};
use crate::index::{Bounds, Index};
use glam::DVec3;
use rayon::prelude::*;
use robust::{Coord3D, orient3d};

/// Counts of places where a mesh meets itself. All are 0 if triangles are proven to meet only in
/// the corners and edges that they share.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Crossings {
    /// Number of pairs of triangles of which an edge of one goes through the inside of the other.
    pub crossing: usize,
    /// Number of other pairs that are not proven apart, as where a surface covers itself.
    pub touching: usize,
    /// Number of triangles that are not proven to have an area. They count in no pair.
    pub flat: usize,
    /// A place where a pair meets: of one that crosses, if there is one.
    pub place: Option<DVec3>,
}

/// The relation of two triangles.
#[derive(PartialEq)]
enum Meeting {
    Apart,
    Touching,
    Crossing,
}

impl Crossings {
    /// Compares all triangles.
    pub fn of(vertices: &[DVec3], triangles: &[[u32; 3]]) -> Self {
        let all = |pick: fn(DVec3, DVec3) -> DVec3| vertices.iter().copied().reduce(pick);
        let (Some(low), Some(high)) = (all(DVec3::min), all(DVec3::max)) else {
            return Self::default();
        };
        let least = least_distance(low.abs().max(high.abs()).max_element());
        let unit = (high - low).max_element() / (1_u64 << 39) as f64;
        let triangle = |number: usize| {
            let numbers = triangles[number];
            Triangle { numbers, corners: numbers.map(|vertex| vertices[vertex as usize]) }
        };
        let bounds = |number: usize| {
            let corners = triangle(number).corners;
            Bounds::of(corners.map(|corner| ((corner - low) / unit).round().as_i64vec3()))
        };
        let has_area = |number: &u32| triangle(*number as usize).has_area(least);
        let used: Vec<(u32, Bounds)> = (0..triangles.len() as u32)
            .into_par_iter()
            .filter(has_area)
            .map(|number| (number, bounds(number as usize)))
            .collect();
        let index = Index::new(triangles.len(), &used);
        let near = |(number, bounds): &(u32, Bounds)| {
            let (own, mut found) = (triangle(*number as usize), Self::default());
            index.all_near(bounds, &mut |other| {
                if other > *number {
                    found.add(&own, &triangle(other as usize), least);
                }
                true
            });
            found
        };
        let found = used.par_iter().map(near).reduce(Self::default, Self::with);
        Self { flat: triangles.len() - used.len(), ..found }
    }

    /// Returns whether triangles are proven to meet only in the corners and edges that they share.
    pub fn is_none(&self) -> bool {
        (self.crossing, self.touching, self.flat) == (0, 0, 0)
    }

    fn add(&mut self, one: &Triangle, other: &Triangle, least: f64) {
        let meeting = one.meeting(other, least);
        let (is_crossing, is_apart) = (meeting == Meeting::Crossing, meeting == Meeting::Apart);
        if is_apart {
            return;
        }
        let [first, second] = [one, other].map(|one| one.corners.iter().sum::<DVec3>() / 3.0);
        let count = if is_crossing { &mut self.crossing } else { &mut self.touching };
        *count += 1;
        if self.place.is_none() || (is_crossing && self.crossing == 1) {
            self.place = Some(first.midpoint(second));
        }
    }

    /// The sum of two counts, of which the first comes first.
    fn with(self, other: Self) -> Self {
        let is_later = self.crossing == 0 && other.crossing > 0;
        Self {
            crossing: self.crossing + other.crossing,
            touching: self.touching + other.touching,
            flat: self.flat + other.flat,
            place: if is_later { other.place } else { self.place.or(other.place) },
        }
    }
}

impl Triangle {
    /// Compares two triangles. Both must have an area.
    fn meeting(&self, other: &Self, least: f64) -> Meeting {
        if self.is_beside(other) || other.is_beside(self) {
            return Meeting::Apart;
        }
        if self.crosses(other) || other.crosses(self) {
            return Meeting::Crossing;
        }
        if self.is_apart(other, least) { Meeting::Apart } else { Meeting::Touching }
    }

    /// Returns whether all corners of another triangle that are not shared lie on one side of this
    /// triangle's plane. Then the two meet in what they share alone.
    fn is_beside(&self, other: &Self) -> bool {
        let mut sides = (0..3).filter(|k| !self.numbers.contains(&other.numbers[*k]));
        let mut side = |k: usize| sign(self.corners, other.corners[k]);
        let Some(first) = sides.next().map(&mut side) else { return false };
        first != 0 && sides.all(|k| side(k) == first)
    }

    /// Returns whether an edge of another triangle goes through the inside of this one.
    fn crosses(&self, other: &Self) -> bool {
        let [a, b, c] = self.corners;
        let sides = other.corners.map(|corner| sign(self.corners, corner));
        (0..3).any(|k| {
            let (from, to) = (other.corners[k], other.corners[(k + 1) % 3]);
            let goes_across = sides[k] * sides[(k + 1) % 3] < 0;
            goes_across && {
                let around = [[a, b], [b, c], [c, a]].map(|[p, q]| sign([from, to, p], q));
                around == [1; 3] || around == [-1; 3]
            }
        })
    }
}

/// The exact sign of the volume of a triangle and a point.
fn sign(triangle: [DVec3; 3], point: DVec3) -> i8 {
    let at = |DVec3 { x, y, z }: DVec3| Coord3D { x, y, z };
    let [a, b, c] = triangle.map(at);
    let volume = orient3d(a, b, c, at(point));
    i8::from(volume > 0.0) - i8::from(volume < 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(triangles: [[u32; 3]; 2], vertices: &[[f64; 3]]) -> [usize; 3] {
        let vertices: Vec<DVec3> = vertices.iter().copied().map(DVec3::from_array).collect();
        let Crossings { crossing, touching, flat, place } = Crossings::of(&vertices, &triangles);
        assert_eq!(place.is_some(), crossing + touching > 0);
        [crossing, touching, flat]
    }

    #[test]
    fn pairs_are_told_apart() {
        let floor = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
        for (name, second, more, expected) in [
            ("through", [3, 4, 5], [[1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [9.0, 9.0, 1.0]], [1, 0, 0]),
            (
                "an edge",
                [3, 4, 5],
                [[1.0, 0.0, -1.0], [1.0, 0.0, 1.0], [1.0, -9.0, 0.0]],
                [0, 1, 0],
            ),
            ("touching", [3, 4, 5], [[1.0, 1.0, 0.0], [2.0, 1.0, 1.0], [9.0, 9.0, 1.0]], [0, 1, 0]),
            ("over", [3, 4, 5], [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]], [0, 1, 0]),
            ("above", [3, 4, 5], [[1.0, 1.0, 1e-6], [2.0, 1.0, 1.0], [9.0, 9.0, 1.0]], [0; 3]),
            ("at 0", [0, 4, 5], [[0.0; 3], [-1.0, 0.0, 1.0], [-1.0, -1.0, 1.0]], [0; 3]),
            ("at 0, through", [0, 4, 5], [[0.0; 3], [1.0, 1.0, 1.0], [1.0, 1.5, -1.0]], [1, 0, 0]),
            ("folded", [1, 0, 5], [[0.0; 3], [0.0; 3], [1.0, 9.0, 0.0]], [0, 1, 0]),
            ("opposite", [1, 0, 5], [[0.0; 3], [0.0; 3], [1.0, -9.0, 0.0]], [0; 3]),
            ("twice", [2, 1, 0], [[0.0; 3], [0.0; 3], [0.0; 3]], [0, 1, 0]),
            ("flat", [3, 4, 5], [[1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [1.0, 1.0, 3.0]], [0, 0, 1]),
        ] {
            let vertices: Vec<[f64; 3]> = floor.into_iter().chain(more).collect();
            assert_eq!(of([[0, 1, 2], second], &vertices), expected, "{name}");
            assert_eq!(of([second, [0, 1, 2]], &vertices), expected, "{name}, exchanged");
        }
    }
}
