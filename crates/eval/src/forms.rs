//! Affine forms along rays: the domain of values with which segments are narrowed.

use crate::real::Real;
use crate::tape::Tape;
use crate::value_domain::{Loader, PARAMETER_QUANTITIES, ValueDomain};
use std::marker::PhantomData;
use zeroset_interval::{
    Contraction, Enclosure, Form, Format, Interval, Machine, Term, contract, linearise,
    linearise_sincos,
};
use zeroset_ir::Axis;
use zeroset_ops::Op;

/// The way in which coordinates depend on `N` symbols. The last symbol runs along a ray.
pub(crate) trait Path<const N: usize> {
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
pub(crate) struct SegmentPath;

/// The path through tiles of rays. It reads the quantities of [`Tiles`](crate::Tiles).
pub(crate) struct TilePath;

/// The domain of values that are affine forms on a path.
struct AffineDomain<'a, I, V, P, const N: usize> {
    loader: &'a mut I,
    depth: RayRange<V>,
    path: PhantomData<P>,
}

/// A range of t along a ray. `middle` ± `half` contains the segment from end to end.
#[derive(Clone, Copy)]
pub(crate) struct RayRange<V> {
    pub middle: V,
    pub half: V,
}

impl<V: Copy> RayRange<V> {
    fn between<M: Machine<V = V>>(m: &mut M, format: Format, ends: [V; 2]) -> Self {
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
        // `error` already includes the rounding of these operations.
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

/// Evaluates the first output of a tape on a path. Returns the output's affine form, the part of
/// the path where the output may be 0, and the range of t.
pub(crate) fn evaluate_and_contract<
    P: Path<N>,
    T: Real,
    V: Copy,
    M: Machine<V = V>,
    const N: usize,
>(
    tape: &Tape<T>,
    m: &mut M,
    loader: &mut impl Loader<M>,
) -> (Form<V, N>, Contraction<V>, RayRange<V>) {
    let ends = P::ENDS.map(|quantity| loader.input(m, quantity));
    let depth = RayRange::between(m, T::FORMAT, ends);
    let form =
        tape.evaluate(m, &mut AffineDomain::<_, _, P, N> { loader, depth, path: PhantomData })[0];
    // The ends are loaded again. If they were kept during the evaluation, they would be spilled.
    let ends = P::ENDS.map(|quantity| loader.input(m, quantity));
    let new = contract(m, T::FORMAT, &form, [depth.middle, depth.half], ends);
    (form, new, depth)
}

impl<T: Real, M: Machine, I: Loader<M>, P: Path<N>, const N: usize> ValueDomain<T, M>
    for AffineDomain<'_, I, M::V, P, N>
{
    type Value = Form<M::V, N>;

    fn coordinate(&mut self, m: &mut M, axis: Axis) -> Self::Value {
        P::coordinate(m, self.loader, self.depth, axis)
    }

    fn parameter(&mut self, m: &mut M, number: usize) -> Self::Value {
        let [neg_lo, hi] =
            [0, 1].map(|end| self.loader.parameter(m, PARAMETER_QUANTITIES * number + end));
        Form::between(m, T::FORMAT, &Enclosure::total(neg_lo, hi))
    }

    fn constant(&mut self, m: &mut M, bounds: Interval) -> Self::Value {
        Form::constant(m, T::FORMAT, bounds)
    }

    fn apply(&mut self, m: &mut M, op: Op, operands: &[Term<Self::Value>]) -> Self::Value {
        linearise(m, T::FORMAT, op, operands)
    }

    fn apply_twins(
        &mut self,
        m: &mut M,
        op: Op,
        term: &Term<Self::Value>,
    ) -> Option<[Self::Value; 2]> {
        linearise_sincos(m, T::FORMAT, op, term)
    }

    fn clamp_to(&mut self, m: &mut M, value: Self::Value, range: Interval) -> Self::Value {
        value.clamp_to(m, T::FORMAT, range)
    }
}
