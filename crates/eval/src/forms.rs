//! Affine forms along rays and over cells of parameters: the domain of values with which segments
//! are narrowed, and patches of surfaces bounded.

use crate::value_kind::{Loader, Vector, coordinate_bounds};
use zeroset_interval::{
    Contraction, Form, Format, Machine, RayRange, TileRays, contract, segment_coordinate,
    tile_coordinate,
};
use zeroset_ir::Axis;

/// The way in which coordinates depend on `N` symbols.
pub trait Path<const N: usize>: Copy + Send + Sync + 'static {
    /// Ranges that all coordinates use.
    type Context<V: Vector>: Copy;

    /// Loads the ranges of a batch.
    fn context<M: Machine>(
        m: &mut M,
        format: Format,
        loader: &mut impl Loader<M>,
    ) -> Self::Context<M::V>;
    /// Returns the affine form of a coordinate.
    fn coordinate<M: Machine>(
        m: &mut M,
        format: Format,
        loader: &mut impl Loader<M>,
        context: Self::Context<M::V>,
        axis: Axis,
    ) -> Form<M::V, N>;
}

/// A path along rays. The last symbol runs along a ray.
pub(crate) trait RayPath {
    /// Indices of the input's quantities that hold the lower and the upper end of t.
    const ENDS: [usize; 2];
}

/// The path along segments of rays. It reads the quantities of [`Segments`](crate::Segments).
#[derive(Clone, Copy, Debug)]
pub struct SegmentPath;

/// The path through tiles of rays. It reads the quantities of [`Tiles`](crate::Tiles).
#[derive(Clone, Copy, Debug)]
pub struct TilePath;

/// The cells of a surface's parameters u and v, in the places of x and y. It reads the quantities
/// of [`Boxes`](crate::Boxes). A symbol runs along each parameter.
#[derive(Clone, Copy, Debug)]
pub struct PatchPath;

/// Loads the range of t of a path's segments.
fn range_of<P: RayPath, M: Machine>(
    m: &mut M,
    format: Format,
    loader: &mut impl Loader<M>,
) -> RayRange<M::V> {
    let ends = P::ENDS.map(|quantity| loader.input(m, quantity));
    RayRange::between(m, format, ends)
}

impl RayPath for SegmentPath {
    const ENDS: [usize; 2] = [9, 10];
}

impl Path<1> for SegmentPath {
    type Context<V: Vector> = RayRange<V>;

    fn context<M: Machine>(
        m: &mut M,
        format: Format,
        loader: &mut impl Loader<M>,
    ) -> RayRange<M::V> {
        range_of::<Self, _>(m, format, loader)
    }

    fn coordinate<M: Machine>(
        m: &mut M,
        _: Format,
        loader: &mut impl Loader<M>,
        depth: RayRange<M::V>,
        axis: Axis,
    ) -> Form<M::V, 1> {
        let ray = [0, 3, 6].map(|first| loader.input(m, first + axis as usize));
        segment_coordinate(m, ray, depth)
    }
}

impl RayPath for TilePath {
    const ENDS: [usize; 2] = [4, 5];
}

impl Path<3> for TilePath {
    type Context<V: Vector> = RayRange<V>;

    fn context<M: Machine>(
        m: &mut M,
        format: Format,
        loader: &mut impl Loader<M>,
    ) -> RayRange<M::V> {
        range_of::<Self, _>(m, format, loader)
    }

    fn coordinate<M: Machine>(
        m: &mut M,
        _: Format,
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

impl Path<2> for PatchPath {
    type Context<V: Vector> = [RayRange<V>; 2];

    fn context<M: Machine>(
        m: &mut M,
        format: Format,
        loader: &mut impl Loader<M>,
    ) -> [RayRange<M::V>; 2] {
        [0, 1].map(|axis| {
            let neg_lo = loader.input(m, axis);
            let ends = [m.neg(neg_lo), loader.input(m, 3 + axis)];
            RayRange::between(m, format, ends)
        })
    }

    fn coordinate<M: Machine>(
        m: &mut M,
        format: Format,
        loader: &mut impl Loader<M>,
        context: [RayRange<M::V>; 2],
        axis: Axis,
    ) -> Form<M::V, 2> {
        let zero = m.number(format, 0.0);
        let slopes = |half| [[half, zero], [zero, half]];
        let Some(RayRange { middle, half }) = context.get(axis as usize).copied() else {
            let bounds = coordinate_bounds(m, loader, axis);
            return Form::between(m, format, &bounds);
        };
        Form::coordinate(middle, slopes(half)[axis as usize], zero)
    }
}

/// Returns the part of a path where the form of a function may be 0.
pub(crate) fn contract_path<P: RayPath, M: Machine, const N: usize>(
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
