//! The proof that the mesh has the surface's shape.
//!
//! Let f be the function: minima and maxima of parts, or one part. Let g be the same minima and
//! maxima of functions that have the parts' signs at each corner of the grid, and are linear in
//! each tetrahedron. Between f and g is a family of functions (1 − s) f + s g. A vector field along
//! which all of them increase, where they are 0, carries the zero set of f to that of g: the two
//! are isotopic.
//!
//! The field is a vector per corner, and linear in each tetrahedron. Take a tetrahedron that may
//! hold a zero of f, and the parts of f and of g that matter there. It suffices that all of them
//! increase along the vectors of all four corners. For parts of f, that follows from bounds of
//! their gradients over the tetrahedron. At a corner on the boundary of the domain, the vector is
//! tangent to the boundary, so that the domain is carried to itself.
//!
//! A solid may have a part together with its opposite. No vector serves for both. But up to three
//! parts are carried all at once if each combination of their signs has such a vector: see
//! [`vectors`].
//!
//! In all other tetrahedra, f has no zero because of the signs of its parts. The parts of g have
//! the same signs, so g has no zero either.
//!
//! `docs/meshes.md` goes on from g to the triangles, whose vertices are moved and rounded.

use crate::cells::Side;
use crate::regular::MOST_TWO_SIDED;
use glam::DVec3;
use smallvec::{SmallVec, smallvec};
use zeroset_interval::Interval;
use zeroset_scene::choices::Level;

/// A slope counts as positive if it exceeds this share of the gradient's largest component.
/// Rounding errors are smaller than that.
pub const MARGIN: f64 = 1e-12;

/// Greatest distance along each axis between a vertex of the mesh and the zero of g that it stands
/// for, as a share of the tetrahedron's size.
pub const MOVED: f64 = 1e-3;

/// Largest number of corrections in the search for a vector.
const CORRECTIONS: usize = 24;

/// Gradients in a tetrahedron that a vector at one of its corners must not oppose.
#[derive(Clone, Copy)]
pub struct Slopes {
    /// The part's number.
    pub part: u16,
    /// The side of its zeros on which f is above 0.
    pub side: Side,
    /// Bounds of the gradient of f.
    pub gradient: [Interval; 3],
    /// The gradient of g.
    pub linear: DVec3,
}

impl Slopes {
    /// The slopes of the function of which the part is a level, up to a factor above 0.
    pub fn of_group(self, levels: &[Level]) -> Self {
        let Level { group, factor, .. } = levels[usize::from(self.part)];
        let turned = match self.side {
            Side::Above => Side::Below,
            Side::Below => Side::Above,
            Side::Both | Side::Unknown => self.side,
        };
        let own = if factor < 0.0 { Self { side: turned, ..self.opposite() } } else { self };
        Self { part: group as u16, ..own }
    }

    /// The slopes of the part with the opposite sign.
    fn opposite(&self) -> Self {
        let gradient = self.gradient.map(|bounds| Interval { lo: -bounds.hi, hi: -bounds.lo });
        Self { gradient, linear: -self.linear, ..*self }
    }
}

/// Vectors that carry the zeros of f to those of g at a corner. There is one along which f and g
/// increase in all tetrahedra around. Or else there is, for all parts that matter there and for
/// each combination of their signs, one along which the parts with these signs increase. `None` if
/// they are not found. The vectors have no component across the boundary's `faces`.
pub fn vectors(star: &[Slopes], faces: [bool; 3]) -> Option<SmallVec<[DVec3; 1]>> {
    if star.iter().all(|slopes| slopes.side == Side::Above) {
        return common_vector(star, faces).map(|vector| smallvec![vector]);
    }
    let along = |slopes: &Slopes| match slopes.side {
        Side::Above => Some(*slopes),
        Side::Below => Some(slopes.opposite()),
        Side::Both | Side::Unknown => None,
    };
    let one_sided: Option<Vec<Slopes>> = star.iter().map(along).collect();
    if let Some(vector) = one_sided.and_then(|star| common_vector(&star, faces)) {
        return Some(smallvec![vector]);
    }
    let mut parts: SmallVec<[u16; MOST_TWO_SIDED]> = SmallVec::new();
    for Slopes { part, .. } in star {
        if !parts.contains(part) {
            parts.push(*part);
        }
    }
    let is_unknown = |slopes: &Slopes| slopes.side == Side::Unknown;
    if parts.len() > MOST_TWO_SIDED || star.iter().any(is_unknown) {
        return None;
    }
    // The opposite of a vector serves for the opposite signs.
    let signs = 0..1_usize << (parts.len() - 1);
    let vector = |signs: usize| {
        let signed = |slopes: &Slopes| {
            let place = parts.iter().position(|part| *part == slopes.part);
            if signs >> place.expect("a part") & 1 == 1 { slopes.opposite() } else { *slopes }
        };
        common_vector(&star.iter().map(signed).collect::<Vec<_>>(), faces)
    };
    signs.map(vector).collect()
}

/// The least slope along `vector` of a function whose gradient is within bounds, rounded down. Also
/// returns the gradient with this slope.
pub fn least_slope(gradient: &[Interval; 3], vector: DVec3) -> (f64, DVec3) {
    let worst = DVec3::from_array([0, 1, 2].map(|axis| {
        let Interval { lo, hi } = gradient[axis];
        if vector[axis] > 0.0 { lo } else { hi }
    }));
    (slope(worst, vector), worst)
}

/// The scalar product of `gradient` and `vector`, less a margin for rounding.
fn slope(gradient: DVec3, vector: DVec3) -> f64 {
    let terms = [0, 1, 2].map(|axis| {
        // A gradient may be infinite where the vector is 0.
        if vector[axis] == 0.0 { 0.0 } else { gradient[axis] * vector[axis] }
    });
    let finite = gradient.to_array().into_iter().filter(|slope| slope.is_finite());
    let largest = finite.fold(0.0_f64, |all, slope| all.max(slope.abs()));
    terms.iter().sum::<f64>() - MARGIN * largest
}

/// The middle of the bounds.
pub fn middle(gradient: &[Interval; 3]) -> DVec3 {
    DVec3::from_array(gradient.map(|bounds| bounds.lo.midpoint(bounds.hi)))
}

/// Returns a unit vector along which both functions increase in all tetrahedra, or `None` if none
/// is found. Its components are 0 across the boundary's `faces`.
fn common_vector(star: &[Slopes], faces: [bool; 3]) -> Option<DVec3> {
    let tangent = |vector: DVec3| {
        let along = [0, 1, 2].map(|axis| if faces[axis] { 0.0 } else { vector[axis] });
        DVec3::from_array(along).try_normalize()
    };
    let sum: DVec3 = star.iter().filter_map(|slopes| tangent(middle(&slopes.gradient))).sum();
    // The shortest vector in the hull of all gradients, each scaled to length 1, opposes them
    // least. Gilbert's method approaches it: each step moves toward the gradient that opposes the
    // vector most.
    let mut shortest = sum / star.len() as f64;
    for _ in 0..=CORRECTIONS {
        let vector = shortest.try_normalize()?;
        let mut worst: (f64, DVec3) = (f64::INFINITY, DVec3::ZERO);
        let mut agree = true;
        for slopes in star {
            let bounded = least_slope(&slopes.gradient, vector);
            for (slope, against) in [bounded, (slope(slopes.linear, vector), slopes.linear)] {
                // Negated, so that NaN disagrees.
                agree &= slope > 0.0;
                let against = tangent(against)?;
                let relative = against.dot(vector);
                if relative < worst.0 {
                    worst = (relative, against);
                }
            }
        }
        if agree {
            return Some(vector);
        }
        let back = shortest - worst.1;
        let share = (shortest.dot(back) / back.length_squared()).clamp(0.0, 1.0);
        shortest -= share * back;
    }
    None
}

/// A bound of two numbers: of |f| in a triangle of the mesh, whose vertices stand for zeros of g,
/// and of |g| at a zero of f. `gradient` bounds f's gradient. The result is not finite if
/// `gradient` is not.
pub fn bend(gradient: &[Interval; 3], corners: &[DVec3; 4]) -> f64 {
    let span = |axis: usize| {
        let along = corners.map(|corner| corner[axis]);
        along.iter().copied().fold(f64::MIN, f64::max)
            - along.iter().copied().fold(f64::MAX, f64::min)
    };
    // In the tetrahedron, a mean of distances from a mean is at most half the span. A gradient
    // differs by at most half the width of its bounds from their middle.
    let along = |axis: usize| {
        let Interval { lo, hi } = gradient[axis];
        (0.25 * (hi - lo) + MOVED * hi.max(-lo)) * span(axis)
    };
    (0..3).map(along).sum::<f64>() * (1.0 + MARGIN)
}

/// The gradient of the linear function with these values at a tetrahedron's corners.
pub fn linear_gradient(corners: &[DVec3; 4], values: &[f64; 4]) -> DVec3 {
    let [a, b, c, d] = *corners;
    let (u, v, w) = (b - a, c - a, d - a);
    let (across_u, across_v, across_w) = (v.cross(w), w.cross(u), u.cross(v));
    let volume = u.dot(across_u);
    let rise = [1, 2, 3].map(|k| values[k] - values[0]);
    (rise[0] * across_u + rise[1] * across_v + rise[2] * across_w) / volume
}

#[cfg(test)]
mod tests {
    use super::*;

    fn slopes(part: u16, side: Side, along: DVec3) -> Slopes {
        let bounds = |slope: f64| Interval { lo: slope - 0.01, hi: slope + 0.01 };
        Slopes { part, side, gradient: along.to_array().map(bounds), linear: along }
    }

    #[test]
    fn vectors_serve_for_all_signs_of_independent_parts() {
        use Side::{Above, Below, Both, Unknown};
        let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
        let count = |star: &[(u16, Side, DVec3)]| {
            let star: Vec<Slopes> = star.iter().map(|(p, s, at)| slopes(*p, *s, *at)).collect();
            let found = vectors(&star, [false; 3])?;
            if let [vector] = found[..] {
                for Slopes { side, linear, .. } in &star {
                    assert!(*side == Both || (linear.dot(vector) > 0.0) == (*side == Above));
                }
            }
            Some(found.len())
        };
        assert_eq!(count(&[(0, Above, x), (1, Above, y), (2, Below, z)]), Some(1));
        assert_eq!(count(&[(0, Above, x), (1, Above, -x)]), None);
        assert_eq!(count(&[(0, Above, x), (1, Below, -x)]), Some(1));
        // Below a plane in one cell, and above it in another.
        assert_eq!(count(&[(0, Above, x), (1, Above, y), (0, Below, x)]), Some(2));
        assert_eq!(count(&[(0, Both, x), (1, Above, y), (2, Below, z)]), Some(4));
        assert_eq!(count(&[(0, Both, x), (1, Above, y), (2, Below, z), (3, Above, z)]), None);
        assert_eq!(count(&[(0, Both, x), (1, Unknown, y)]), None);
        // This holds for each place of the dependent part among the parts.
        for both in 0..3 {
            let side = |part: u16| if part == both { Both } else { Above };
            assert_eq!(count(&[(0, side(0), x), (1, side(1), y), (2, side(2), x + y)]), None);
            assert_eq!(count(&[(0, side(0), x), (1, side(1), y), (2, side(2), x - y)]), None);
        }
    }
}
