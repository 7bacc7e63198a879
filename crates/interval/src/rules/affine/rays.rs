//! Forms of coordinates along the rays of a segment or a tile.

use super::Form;
use crate::machine::{Format, Machine};

/// Bound on a coordinate's rounding error, which the input's error must include: this number of
/// units times the sum of the magnitudes of the coordinate's terms. Units are 2⁻²³ in `f32` and
/// 2⁻⁵² in `f64`.
pub const PATH_UNITS: f64 = 8.0;

/// A range of t along rays. `middle` ± `half` contains the range from end to end.
#[derive(Clone, Copy)]
pub struct RayRange<V> {
    /// A number in the range.
    pub middle: V,
    /// Upper bound of the distance from `middle` to either end.
    pub half: V,
}

impl<V: Copy> RayRange<V> {
    /// The range from `near` to `far`.
    pub fn between<M: Machine<V = V>>(m: &mut M, format: Format, [near, far]: [V; 2]) -> Self {
        let half = m.number(format, 0.5);
        let sum = m.add(near, far);
        let middle = m.mul(sum, half);
        let (after, before) = (m.sub(far, middle), m.sub(middle, near));
        Self { middle, half: m.max(after, before) }
    }
}

/// One coordinate of the rays of a tile. The ray through the screen point (a, b) begins at
/// o₀ + a·o₁ + b·o₂, and changes by d₀ + a·d₁ + b·d₂ if t grows by 1.
#[derive(Clone, Copy)]
pub struct TileRays<V> {
    /// The middle of the tile on the screen.
    pub centre: [V; 2],
    /// The largest distances of screen coordinates from the middle; at least 0.
    pub reach: [V; 2],
    /// The numbers o₀, o₁ and o₂.
    pub origin: [V; 3],
    /// The numbers d₀, d₁ and d₂.
    pub direction: [V; 3],
    /// The largest error of the coordinate, which includes [`PATH_UNITS`].
    pub error: V,
}

/// The coordinate o + t·d ± error along a segment, where `ray` is o, d and the error. The error
/// must include [`PATH_UNITS`]. The symbol runs along the segment.
pub fn segment_coordinate<M: Machine>(
    m: &mut M,
    [origin, direction, error]: [M::V; 3],
    RayRange { middle, half }: RayRange<M::V>,
) -> Form<M::V, 1> {
    let slope = m.mul(half, direction);
    let centre = m.mul_add(direction, middle, origin);
    Form::coordinate(centre, [slope], error)
}

/// The coordinate of a tile's rays. The symbols are the two directions of the screen, and t.
pub fn tile_coordinate<M: Machine>(
    m: &mut M,
    rays: &TileRays<M::V>,
    RayRange { middle, half }: RayRange<M::V>,
) -> Form<M::V, 3> {
    let ([o, o_a, o_b], [d, d_a, d_b]) = (rays.origin, rays.direction);
    let TileRays { centre, reach, error, .. } = *rays;
    // Rays diverge, so a coordinate has products of screen coordinates and t. They count as errors.
    let sizes = [d_a, d_b].map(|d| m.abs(d));
    let spread = m.mul(reach[0], sizes[0]);
    let spread = m.mul_add(sizes[1], reach[1], spread);
    let error = m.mul_add(spread, half, error);
    let [across, upward] = [(o_a, d_a, 0), (o_b, d_b, 1)].map(|(o, d, axis)| {
        let per_unit = m.mul_add(middle, d, o);
        m.mul(reach[axis], per_unit)
    });
    let mut through_centre = |base, a, b| {
        let sum = m.mul_add(a, centre[0], base);
        m.mul_add(b, centre[1], sum)
    };
    let (origin, direction) = (through_centre(o, o_a, o_b), through_centre(d, d_a, d_b));
    let depth = m.mul(half, direction);
    let centre = m.mul_add(direction, middle, origin);
    Form::coordinate(centre, [across, upward, depth], error)
}
