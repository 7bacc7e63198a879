//! Convex polygons whose edges are on planes.

use super::plane::{Plane, Points};
use num_rational::BigRational;
use num_traits::Zero;
use zeroset_scene::choices::Choice;
use zeroset_space::Region;

/// A convex polygon in a plane. Its corners are counterclockwise, seen from where the outside is.
#[derive(Clone, Debug)]
pub struct Polygon {
    /// The polygon's plane.
    pub plane: usize,
    pub corners: Vec<u32>,
    /// For each edge, from the corner with its number to the next one, another plane through it.
    pub edges: Vec<usize>,
}

impl Polygon {
    /// The faces of a region's box, whose planes are added.
    pub fn of_box(region: &Region, points: &mut Points) -> Vec<Self> {
        let exact = |number: f64| BigRational::from_float(number).expect("a finite box");
        let first = points.planes.len();
        for axis in 0..3 {
            for (end, turn) in [(region.low(), -1.0), (region.high(), 1.0)] {
                let mut function = [(); 4].map(|()| BigRational::zero());
                function[axis] = exact(turn);
                function[3] = exact(-turn * end[axis]);
                points.planes.push(Plane::of(&function));
            }
        }
        let face = |(axis, side): (usize, usize)| {
            let plane = first + 2 * axis + side;
            let [u, v] = [1, 2].map(|k| first + 2 * ((axis + k) % 3));
            // Counterclockwise, seen from where the axis points to.
            let mut edges = vec![v, u + 1, v + 1, u];
            if side == 0 {
                edges.reverse();
            }
            let corners = (0..4).map(|k| points.common([plane, edges[(k + 3) % 4], edges[k]]));
            Self { plane, corners: corners.collect(), edges }
        };
        [0, 1, 2].into_iter().flat_map(|axis| [(axis, 0), (axis, 1)]).map(face).collect()
    }

    /// The same polygon, seen from the other side.
    pub fn turned(mut self) -> Self {
        self.corners.reverse();
        self.edges.reverse();
        self.edges.rotate_left(1);
        self
    }

    /// The parts of the polygon where a plane's function is at most 0, and where it is at least 0.
    pub fn split(self, plane: usize, points: &mut Points) -> [Option<Self>; 2] {
        let sides: Vec<i8> = self.corners.iter().map(|point| points.side(plane, *point)).collect();
        if sides.iter().all(|side| *side <= 0) {
            return [Some(self), None];
        }
        if sides.iter().all(|side| *side >= 0) {
            return [None, Some(self)];
        }
        let empty = Self { plane: self.plane, corners: Vec::new(), edges: Vec::new() };
        let mut parts = [empty.clone(), empty];
        let count = sides.len();
        for k in 0..count {
            let (corner, edge) = (self.corners[k], self.edges[k]);
            let (own, next) = (sides[k], sides[(k + 1) % count]);
            for (part, sign) in parts.iter_mut().zip([-1, 1]) {
                if own == sign || own == 0 && next != -sign {
                    part.push(corner, edge);
                } else if own == 0 {
                    part.push(corner, plane);
                }
            }
            if own * next < 0 {
                let between = points.common([self.plane, edge, plane]);
                for (part, sign) in parts.iter_mut().zip([-1, 1]) {
                    part.push(between, if next == sign { edge } else { plane });
                }
            }
        }
        parts.map(Some)
    }

    fn push(&mut self, corner: u32, edge: usize) {
        self.corners.push(corner);
        self.edges.push(edge);
    }

    /// Returns whether a choice of the planes' functions is 0 within the polygon.
    pub fn is_zero(&self, choice: &Choice, points: &Points) -> bool {
        fn value(choice: &Choice, signs: &[i8]) -> i8 {
            match choice {
                Choice::Part(part) => signs[*part],
                Choice::Opposite(part) => -signs[*part],
                Choice::Min(all) => all.iter().map(|one| value(one, signs)).min().unwrap_or(1),
                Choice::Max(all) => all.iter().map(|one| value(one, signs)).max().unwrap_or(-1),
            }
        }
        value(choice, &points.signs_between(&self.corners)) == 0
    }
}
