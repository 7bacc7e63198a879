//! Affine forms along rays: the domain of values in which segments are narrowed.

use crate::value_kind::Loader;
use zeroset_interval::{Contraction, Form, Format, Machine, contract};
use zeroset_ir::Axis;

/// How coordinates depend on `N` symbols, of which the last runs along a ray.
pub(crate) trait Path<const N: usize> {
    /// Numbers of the quantities that hold the ends of a segment.
    const ENDS: [usize; 2];

    /// Returns the form of a coordinate.
    fn coordinate<M: Machine>(
        m: &mut M,
        loader: &mut impl Loader<M>,
        depth: RayRange<M::V>,
        axis: Axis,
    ) -> Form<M::V, N>;
}

/// Path along segments of rays; its quantities are those of [`Segments`](crate::Segments).
pub(crate) struct SegmentPath;

/// Path through tiles of rays; its quantities are those of [`Tiles`](crate::Tiles).
pub(crate) struct TilePath;

/// A range of t along a ray: `middle` ± `half` contains a segment from end to end.
#[derive(Clone, Copy)]
pub struct RayRange<V> {
    pub middle: V,
    pub half: V,
}

impl<V: Copy> RayRange<V> {
    /// Loads the range of the segments of a path.
    pub(crate) fn load<P: Path<N>, M: Machine<V = V>, const N: usize>(
        m: &mut M,
        format: Format,
        loader: &mut impl Loader<M>,
    ) -> Self {
        let ends = P::ENDS.map(|quantity| loader.input(m, quantity));
        let half = m.number(format, 0.5);
        let middle = m.unrounded(|m| {
            let sum = m.add(ends[0], ends[1]);
            m.mul(sum, half)
        });
        let (after, before) = (m.sub(ends[1], middle), m.sub(middle, ends[0]));
        Self { middle, half: m.max(after, before) }
    }
}

impl Path<1> for SegmentPath {
    const ENDS: [usize; 2] = [9, 10];

    fn coordinate<M: Machine>(
        m: &mut M,
        loader: &mut impl Loader<M>,
        depth: RayRange<M::V>,
        axis: Axis,
    ) -> Form<M::V, 1> {
        let [origin, direction, error] =
            [0, 3, 6].map(|first| loader.input(m, first + axis as usize));
        // The rounding of these operations is included in the batch's `error`.
        let (centre, slope) = m.unrounded(|m| {
            let slope = m.mul(depth.half, direction);
            (m.mul_add(direction, depth.middle, origin), slope)
        });
        Form::coordinate(centre, [slope], error)
    }
}

impl Path<3> for TilePath {
    const ENDS: [usize; 2] = [4, 5];

    fn coordinate<M: Machine>(
        m: &mut M,
        loader: &mut impl Loader<M>,
        depth: RayRange<M::V>,
        axis: Axis,
    ) -> Form<M::V, 3> {
        // Load again for each axis: a value that lives longer would be spilled and reloaded.
        let centre = [0, 1].map(|quantity| loader.input(m, quantity));
        let reach = [2, 3].map(|quantity| loader.input(m, quantity));
        let [o, o_a, o_b] = [6, 9, 12].map(|first| loader.input(m, first + axis as usize));
        let [d, d_a, d_b] = [15, 18, 21].map(|first| loader.input(m, first + axis as usize));
        let error = loader.input(m, 24 + axis as usize);
        let RayRange { middle, half } = depth;
        // Rays diverge: products of screen coordinates and depth are counted as errors.
        let sizes = [d_a, d_b].map(|d| m.abs(d));
        let spread = m.mul(reach[0], sizes[0]);
        let spread = m.mul_add(sizes[1], reach[1], spread);
        let error = m.mul_add(spread, half, error);
        // The rounding of these operations, too, is included in the batch's `error`.
        let (centre, slopes) = m.unrounded(|m| {
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
            (m.mul_add(direction, middle, origin), [across, upward, depth])
        });
        Form::coordinate(centre, slopes, error)
    }
}

/// Returns the part of a path where the form of a function may be 0.
pub(crate) fn contract_path<P: Path<N>, M: Machine, const N: usize>(
    m: &mut M,
    format: Format,
    loader: &mut impl Loader<M>,
    depth: RayRange<M::V>,
    form: &Form<M::V, N>,
) -> Contraction<M::V> {
    // Load again: a value that lives longer would be spilled and reloaded.
    let ends = P::ENDS.map(|quantity| loader.input(m, quantity));
    contract(m, format, form, [depth.middle, depth.half], ends)
}
