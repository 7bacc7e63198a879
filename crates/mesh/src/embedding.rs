//! Checks that triangles do not cross: triangles that share no corner do not meet, and others meet
//! only in the corners and edges that they share.
//!
//! All distances are compared with a bound of the rounding of vertices. So triangles that pass do
//! not meet, however their vertices were rounded.

use glam::DVec3;

/// A share of the largest coordinate: more than two vertices move when they are rounded to the
/// points that [`simplify`](mod@crate::simplify) uses, and more than the rounding of computations
/// here.
const ROUNDING: f64 = 1.0 / (1_u64 << 36) as f64;

/// The least distance that proves two triangles apart, in a mesh whose coordinates have magnitudes
/// of at most `largest`.
pub fn least_distance(largest: f64) -> f64 {
    ROUNDING * largest
}

/// The corners of a triangle, and their numbers.
#[derive(Clone, Copy)]
pub struct Triangle {
    pub numbers: [u32; 3],
    pub corners: [DVec3; 3],
}

impl Triangle {
    /// Returns whether the triangle is proven to have an area.
    pub fn has_area(&self, least: f64) -> bool {
        let [a, b, c] = self.corners;
        let longest = (b - a).length().max((c - b).length()).max((a - c).length());
        (b - a).cross(c - a).length() > least * longest
    }

    /// Returns whether two triangles are proven to meet only in the corners that they share. Both
    /// must have an area.
    pub fn is_apart(&self, other: &Self, least: f64) -> bool {
        if are_boxes_apart(self, other, least) {
            return true;
        }
        let is_shared = self.numbers.map(|number| other.numbers.contains(&number));
        match is_shared.iter().filter(|shared| **shared).count() {
            0 => are_apart(&self.corners, &other.corners, least),
            1 => {
                let (tip, left) = self.around(|number| other.numbers.contains(&number));
                let (_, right) = other.around(|number| self.numbers.contains(&number));
                are_cones_apart(left.map(|end| end - tip), right.map(|end| end - tip), least)
            }
            2 => {
                let (end, [from, to]) = self.around(|number| !other.numbers.contains(&number));
                let (other_end, _) = other.around(|number| !self.numbers.contains(&number));
                are_neighbors_apart([from, to], [end, other_end], least)
            }
            _ => false,
        }
    }

    /// The only corner for which `is_tip` is true, and the two others.
    fn around(&self, is_tip: impl Fn(u32) -> bool) -> (DVec3, [DVec3; 2]) {
        let tip = self.numbers.iter().position(|number| is_tip(*number)).expect("one corner");
        (self.corners[tip], [1, 2].map(|k| self.corners[(tip + k) % 3]))
    }
}

fn are_boxes_apart(one: &Triangle, other: &Triangle, least: f64) -> bool {
    let low = |[a, b, c]: [DVec3; 3]| a.min(b).min(c);
    let high = |[a, b, c]: [DVec3; 3]| a.max(b).max(c);
    let gaps = (low(other.corners) - high(one.corners)).max(low(one.corners) - high(other.corners));
    gaps.max_element() > least
}

/// Returns whether a plane that separates two triangles is found. Its normal is a normal of one of
/// them, or the cross product of two edges, or of an edge and its triangle's normal (the separating
/// axis theorem).
fn are_apart(one: &[DVec3; 3], other: &[DVec3; 3], least: f64) -> bool {
    let edges = |[a, b, c]: [DVec3; 3]| [b - a, c - b, a - c];
    let (first, second) = (edges(*one), edges(*other));
    let normals = [first, second].map(|[u, v, _]| u.cross(v));
    let separates = |axis: DVec3| {
        // From a corner, so that only differences are rounded.
        let along = |corner: &DVec3| (*corner - one[0]).dot(axis);
        let ends = |corners: &[DVec3; 3]| {
            let [a, b, c] = [0, 1, 2].map(|k| along(&corners[k]));
            [a.min(b).min(c), a.max(b).max(c)]
        };
        let ([low, high], [from, to]) = (ends(one), ends(other));
        // False for NaN.
        (from - high).max(low - to) > least * axis.length()
    };
    normals.into_iter().any(separates)
        || first.iter().any(|u| second.iter().any(|v| separates(u.cross(*v))))
        || first.iter().any(|edge| separates(edge.cross(normals[0])))
        || second.iter().any(|edge| separates(edge.cross(normals[1])))
}

/// Returns whether a plane through the shared corner of two triangles separates them. `left` and
/// `right` are their edges from that corner.
fn are_cones_apart(left: [DVec3; 2], right: [DVec3; 2], least: f64) -> bool {
    let ends = [left[0], left[1], -right[0], -right[1]];
    let unit = ends.map(|end| end.normalize_or_zero());
    // The normal whose least slope along the edges is largest is the point nearest to 0 in the hull
    // of the directions.
    let mut nearest: Option<DVec3> = None;
    let mut offer = |point: DVec3| {
        if nearest.is_none_or(|best| point.length_squared() < best.length_squared()) {
            nearest = Some(point);
        }
    };
    for k in 0..4 {
        offer(unit[k]);
        for j in 0..k {
            let (a, side) = (unit[j], unit[k] - unit[j]);
            let share = -a.dot(side) / side.length_squared();
            if share > 0.0 && share < 1.0 {
                offer(a + share * side);
            }
            for i in 0..j {
                let (a, u, v) = (unit[i], unit[j] - unit[i], unit[k] - unit[i]);
                let normal = u.cross(v);
                let area = normal.length_squared();
                let (p, q) = (-a.cross(v).dot(normal) / area, a.cross(u).dot(normal) / area);
                if p > 0.0 && q > 0.0 && p + q < 1.0 {
                    offer(a.dot(normal) / area * normal);
                }
            }
        }
    }
    let normal = nearest.and_then(DVec3::try_normalize).unwrap_or_default();
    ends.iter().all(|end| end.dot(normal) > least)
}

/// Returns whether two triangles that share an edge meet only in that edge. `from` and `to` are the
/// ends of the edge, `ends` the two other corners. `least` is the least distance that tells
/// triangles apart.
fn are_neighbors_apart([from, to]: [DVec3; 2], ends: [DVec3; 2], least: f64) -> bool {
    let edge = to - from;
    let length = edge.length();
    let along = edge / length;
    let [left, right] = ends.map(|end| (end - from) - (end - from).dot(along) * along);
    let farthest = ends.iter().map(|end| (*end - from).length()).fold(0.0, f64::max);
    let turned = least * (1.0 + farthest / length);
    // False for NaN.
    left.length().min(right.length()) > turned
        && (left.dot(right) < 0.0
            || left.cross(right).length() > turned * (left.length() + right.length()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle(numbers: [u32; 3], corners: [[f64; 3]; 3]) -> Triangle {
        Triangle { numbers, corners: corners.map(DVec3::from_array) }
    }

    #[test]
    fn triangles_that_meet_are_told_from_others() {
        let floor = triangle([0, 1, 2], [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]]);
        let tiny = 1e-9;
        for (name, numbers, corners, apart) in [
            ("through", [3, 4, 5], [[1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [9.0, 9.0, 1.0]], false),
            ("above", [3, 4, 5], [[1.0, 1.0, tiny], [2.0, 1.0, 1.0], [9.0, 9.0, 1.0]], true),
            ("touching", [3, 4, 5], [[1.0, 1.0, 1e-15], [2.0, 1.0, 1.0], [9.0, 9.0, 1.0]], false),
            ("inside", [3, 4, 5], [[1.0, 1.0, 0.0], [1.5, 1.0, 0.0], [1.0, 1.5, 0.0]], false),
            ("beside", [3, 4, 5], [[2.5, 2.5, 0.0], [3.5, 2.5, 0.0], [2.5, 3.5, 0.0]], true),
            ("at 0", [0, 4, 5], [[0.0, 0.0, 0.0], [-1.0, 0.0, 1.0], [-1.0, -1.0, 1.0]], true),
            ("at 0, over", [0, 4, 5], [[0.0, 0.0, 0.0], [1.0, 1.0, tiny], [1.0, 2.0, tiny]], true),
            ("at 0, in", [0, 4, 5], [[0.0, 0.0, 0.0], [1.0, 1.0, 1.0], [1.0, 1.5, -1.0]], false),
            ("edge", [0, 1, 5], [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, tiny]], true),
            ("folded", [0, 1, 5], [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [1.0, 9.0, 0.0]], false),
            ("opposite", [0, 1, 5], [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [1.0, -9.0, 0.0]], true),
            ("twice", [0, 1, 2], [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]], false),
        ] {
            let other = triangle(numbers, corners);
            let least = least_distance(4.0);
            assert_eq!(floor.is_apart(&other, least), apart, "{name}");
            assert_eq!(other.is_apart(&floor, least), apart, "{name}, exchanged");
        }
        let thin = triangle([0, 1, 2], [[0.0; 3], [1.0; 3], [2.0, 2.0, 2.0 + 1e-15]]);
        assert!(!thin.has_area(least_distance(4.0)) && floor.has_area(least_distance(4.0)));
    }
}
