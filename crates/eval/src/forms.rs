//! Affine forms along rays: the domain of values with which segments are narrowed.

use crate::value_kind::Loader;
use zeroset_interval::{Contraction, Form, Format, Machine, contract};
use zeroset_ir::Axis;

/// The way in which coordinates depend on `N` symbols. The last symbol runs along a ray.
pub trait Path<const N: usize>: Copy + Send + Sync + 'static {
    /// Indices of the input's quantities that hold the lower and the upper end of t.
    const ENDS: [usize; 2];

    /// Returns the affine form of a coordinate.
    fn coordinate<M: Machine>(
        m: &mut M,
        loader: &mut impl Loader<M>,
        depth: RayRange<M::V>,
        axis: Axis,
    ) -> Form<M::V, N>;
}

/// The path along segments of rays. It reads the quantities of [`Segments`](crate::Segments).
#[derive(Clone, Copy, Debug)]
pub struct SegmentPath;

/// The path through tiles of rays. It reads the quantities of [`Tiles`](crate::Tiles).
#[derive(Clone, Copy, Debug)]
pub struct TilePath;

/// A range of t along a ray. `middle` ± `half` contains the segment from end to end.
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
        let sum = m.add(ends[0], ends[1]);
        let middle = m.mul(sum, half);
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
        // `error` already includes the rounding of these operations.
        let slope = m.mul(depth.half, direction);
        let centre = m.mul_add(direction, depth.middle, origin);
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
        // These quantities are loaded again for each axis. If they were kept, they would be
        // spilled.
        let centre = [0, 1].map(|quantity| loader.input(m, quantity));
        let reach = [2, 3].map(|quantity| loader.input(m, quantity));
        let [o, o_a, o_b] = [6, 9, 12].map(|first| loader.input(m, first + axis as usize));
        let [d, d_a, d_b] = [15, 18, 21].map(|first| loader.input(m, first + axis as usize));
        let error = loader.input(m, 24 + axis as usize);
        let RayRange { middle, half } = depth;
        // Rays diverge, so a coordinate has products of screen coordinates and t. They count as
        // errors.
        let sizes = [d_a, d_b].map(|d| m.abs(d));
        let spread = m.mul(reach[0], sizes[0]);
        let spread = m.mul_add(sizes[1], reach[1], spread);
        let error = m.mul_add(spread, half, error);
        // `error` already includes the rounding of these operations.
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
}

/// Returns the part of a path where the form of a function may be 0.
pub(crate) fn contract_path<P: Path<N>, M: Machine, const N: usize>(
    m: &mut M,
    format: Format,
    loader: &mut impl Loader<M>,
    depth: RayRange<M::V>,
    form: &Form<M::V, N>,
) -> Contraction<M::V> {
    // The ends are loaded again. If they were kept during the evaluation, they would be spilled.
    let ends = P::ENDS.map(|quantity| loader.input(m, quantity));
    contract(m, format, form, [depth.middle, depth.half], ends)
}
