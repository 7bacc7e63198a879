//! Affine forms along rays: the domain of values with which segments are narrowed.

use crate::value_kind::Loader;
use zeroset_interval::{
    Contraction, Form, Format, Machine, RayRange, TileRays, contract, segment_coordinate,
    tile_coordinate,
};
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

/// Loads the range of t of a path's segments.
pub(crate) fn range_of<P: Path<N>, M: Machine, const N: usize>(
    m: &mut M,
    format: Format,
    loader: &mut impl Loader<M>,
) -> RayRange<M::V> {
    let ends = P::ENDS.map(|quantity| loader.input(m, quantity));
    RayRange::between(m, format, ends)
}

impl Path<1> for SegmentPath {
    const ENDS: [usize; 2] = [9, 10];

    fn coordinate<M: Machine>(
        m: &mut M,
        loader: &mut impl Loader<M>,
        depth: RayRange<M::V>,
        axis: Axis,
    ) -> Form<M::V, 1> {
        let ray = [0, 3, 6].map(|first| loader.input(m, first + axis as usize));
        segment_coordinate(m, ray, depth)
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
        let [origin, direction] = [[6, 9, 12], [15, 18, 21]]
            .map(|part| part.map(|first| loader.input(m, first + axis as usize)));
        let error = loader.input(m, 24 + axis as usize);
        tile_coordinate(m, &TileRays { centre, reach, origin, direction, error }, depth)
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
