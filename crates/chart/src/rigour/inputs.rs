//! Inputs of the timed kernels, and comparison of the widths of their results.

use crate::quantile::quantile;
use fastrand::Rng;
use zeroset_eval::{
    Boxes, ContractSegments, ContractTiles, Contractions, Enclose, Enclosures, Input, Kernel,
    LANES, Planes, Query, Real, Segments, Tiles,
};
use zeroset_interval::Interval;
use zeroset_jit::comparison::ComparisonKernel;
use zeroset_space::Region;

/// Greatest number of batches that kernels are timed with. So few fit into a cache near the core.
const BATCHES: usize = 16;
/// Number of batches of boxes whose bounds are compared.
const COMPARED_BATCHES: usize = 256;

/// The kernels for a query, in the order of
/// [`Arithmetic::ALL`](zeroset_jit::comparison::Arithmetic::ALL).
pub type ByArithmetic<'a, Q, T> = [&'a ComparisonKernel<Q, T>; 3];

/// Random boxes in a region. A box's width is the given share of the region's width.
pub fn boxes<T: Real>(region: &Region, share: f64, rng: &mut Rng) -> Vec<Boxes<T>> {
    let (low, high) = (region.low(), region.high());
    let mut side = |axis: usize| {
        let width = high[axis] - low[axis];
        let lo = low[axis] + (1.0 - share) * rng.f64() * width;
        // If `share` is 0, both ends must be the same float of type `T`.
        let lo = T::nearest(lo).into().clamp(low[axis], high[axis]);
        Interval { lo, hi: (lo + share * width).min(high[axis]) }
    };
    let all: Vec<_> = (0..COMPARED_BATCHES * LANES).map(|_| [0, 1, 2].map(&mut side)).collect();
    Boxes::around(&all)
}

/// At most `BATCHES` inputs, evenly spaced among those with the most lanes in use.
pub fn chosen<T: Real, I: Input<T>>(all: &[I]) -> Vec<I> {
    let most = all.iter().map(Input::count).max().unwrap_or_default();
    let full: Vec<&I> = all.iter().filter(|input| input.count() == most).collect();
    let step = full.len().div_ceil(BATCHES).max(1);
    full.into_iter().step_by(step).cloned().collect()
}

/// For each arithmetic, the median ratio of its widths of bounds to those of the rounded-up kernel.
pub fn widths<T: Real>(
    kernels: &ByArithmetic<Enclose, T>,
    inputs: &[Boxes<T>],
) -> [Option<f64>; 3] {
    ratios(kernels, inputs, |answer: &Enclosures<T>, lane| {
        answer.neg_lo[lane].into() + answer.hi[lane].into()
    })
}

/// For each arithmetic, the median ratio of its lengths of narrowed segments to those of the
/// rounded-up kernel. Lanes that cannot hold the surface do not count.
pub fn lengths<T: Real>(
    kernels: &ByArithmetic<ContractSegments, T>,
    inputs: &[Segments<T>],
) -> [Option<f64>; 3] {
    ratios(kernels, inputs, |answer: &Contractions<T>, lane| {
        let is_possible = answer.possible >> lane & 1 == 1;
        if is_possible { answer.far[lane].into() - answer.near[lane].into() } else { f64::NAN }
    })
}

/// For each arithmetic, the median ratio of its planes' errors to those of the rounded-up kernel.
pub fn errors<T: Real>(
    kernels: &ByArithmetic<ContractTiles, T>,
    inputs: &[Tiles<T>],
) -> [Option<f64>; 3] {
    ratios(kernels, inputs, |answer: &Planes<T>, lane| answer.error[lane].into())
}

fn ratios<T: Real, Q: Query>(
    kernels: &ByArithmetic<Q, T>,
    inputs: &[Q::Input<T>],
    width: impl Fn(&Q::Output<T>, usize) -> f64,
) -> [Option<f64>; 3] {
    let answers = kernels.map(|kernel| kernel.eval_all(inputs));
    let [_, _, upward] = &answers;
    answers.each_ref().map(|answers| {
        let pairs = inputs.iter().zip(answers.iter().zip(upward));
        let ratios = pairs.flat_map(|(input, (own, upward))| {
            (0..input.count())
                .map(|lane| (width(own, lane), width(upward, lane)))
                .collect::<Vec<_>>()
        });
        let is_width = |(own, upward): &(f64, f64)| *own >= 0.0 && *upward > 0.0;
        let ratios: Vec<f64> = ratios
            .filter(is_width)
            .map(|(own, upward)| own / upward)
            .filter(|r| r.is_finite())
            .collect();
        quantile(&ratios, 0.5)
    })
}
