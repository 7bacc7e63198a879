//! An exact test whether a triangle and a tetrahedron are apart.

use glam::{DVec3, I64Vec3};

/// Share of a sum of products of three coordinates, each taken as positive, that is more than the
/// rounding of the sum in `f64`.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// A vector with exact components.
pub type Vector = [i128; 3];

/// The corners of a triangle or a tetrahedron, each with whether both have it.
pub struct Corners<'a, const N: usize> {
    pub places: &'a [I64Vec3; N],
    pub is_shared: [bool; N],
}

/// Returns whether a plane is found that separates two convex sets. Only shared corners of one of
/// them may be on the plane. Its normal is a normal of a face, or the cross product of two edges.
pub fn are_apart(triangle: &Corners<'_, 3>, tetrahedron: &Corners<'_, 4>) -> bool {
    let [a, b, c] = *triangle.places;
    let [p, q, r, s] = *tetrahedron.places;
    let own = [b - a, c - b, a - c];
    let others = [q - p, r - p, s - p, r - q, s - q, s - r];
    let separates = |u: I64Vec3, v: I64Vec3| {
        is_surely_between([u, v], triangle, tetrahedron)
            .unwrap_or_else(|| is_between(cross(u, v), triangle, tetrahedron))
    };
    separates(own[0], own[1])
        || [[0, 1], [1, 2], [0, 2], [3, 4]]
            .into_iter()
            .any(|[one, other]| separates(others[one], others[other]))
        || own.iter().any(|one| others.iter().any(|other| separates(*one, *other)))
}

/// Returns the same as [`is_between`], for the cross product of two vectors as axis, if it is told
/// in `f64`. Differences of places are exact there.
fn is_surely_between(
    sides: [I64Vec3; 2],
    one: &Corners<'_, 3>,
    other: &Corners<'_, 4>,
) -> Option<bool> {
    let (axis, size) = rounded_cross(sides[0], sides[1]);
    let base = one.places[0];
    // Bounds of the least coordinate along the axis, and of the greatest.
    let ends = |places: &[I64Vec3]| {
        let (mut least, mut most) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for place in places {
            let from = (*place - base).as_dvec3();
            let (along, error) = (axis.dot(from), ROUNDING * size.dot(from.abs()));
            for (end, at) in [along - error, along + error].into_iter().enumerate() {
                (least[end], most[end]) = (least[end].min(at), most[end].max(at));
            }
        }
        (least, most)
    };
    let ((least, most), (from, to)) = (ends(one.places), ends(other.places));
    if most[1] < from[0] || to[1] < least[0] {
        Some(true)
    } else if most[0] > from[1] && to[0] > least[1] {
        Some(false)
    } else {
        None
    }
}

/// Returns whether all points are on one side of a triangle's plane, and not on it, as far as that
/// is told in `f64`. Differences of places are exact there.
pub fn are_beside_plane(points: &[I64Vec3], &[a, b, c]: &[I64Vec3; 3]) -> bool {
    let (axis, size) = rounded_cross(b - a, c - a);
    let mut side = 0.0;
    points.iter().all(|point| {
        let from = (*point - a).as_dvec3();
        let along = axis.dot(from);
        let is_certain = along.abs() > ROUNDING * size.dot(from.abs());
        let is_same = along * side >= 0.0;
        side = along.signum();
        is_certain && is_same
    })
}

/// The cross product, and the sums of its terms, each taken as positive.
fn rounded_cross(u: I64Vec3, v: I64Vec3) -> (DVec3, DVec3) {
    let (u, v) = (u.as_dvec3(), v.as_dvec3());
    let axis = u.cross(v);
    let (u, v) = (u.abs(), v.abs());
    let size = DVec3::new(u.y * v.z + u.z * v.y, u.z * v.x + u.x * v.z, u.x * v.y + u.y * v.x);
    (axis, size)
}

/// Returns whether a plane across an axis is between two sets.
fn is_between(axis: Vector, one: &Corners<'_, 3>, other: &Corners<'_, 4>) -> bool {
    let base = one.places[0];
    let along = |place: &I64Vec3| {
        let from = (*place - base).to_array().map(i128::from);
        (0..3).map(|k| axis[k] * from[k]).sum::<i128>()
    };
    let (first, second) = (one.places.each_ref().map(along), other.places.each_ref().map(along));
    let is_below = |low: &[i128], low_shared: &[bool], high: &[i128], high_shared: &[bool]| {
        let (most, least) = (low.iter().max(), high.iter().min());
        let only_shared = |all: &[i128], shared: &[bool], end: Option<&i128>| {
            all.iter().zip(shared).all(|(one, shared)| *shared || Some(one) != end)
        };
        most < least
            || (most == least
                && (only_shared(low, low_shared, most) || only_shared(high, high_shared, least)))
    };
    axis != [0; 3]
        && (is_below(&first, &one.is_shared, &second, &other.is_shared)
            || is_below(&second, &other.is_shared, &first, &one.is_shared))
}

/// The cross product, exact.
pub fn cross(u: I64Vec3, v: I64Vec3) -> Vector {
    let (u, v) = (u.to_array().map(i128::from), v.to_array().map(i128::from));
    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
}
