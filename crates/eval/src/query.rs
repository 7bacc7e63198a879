//! What may be asked of a function, each question with a contract of its own, and what answers.
//!
//! All but samples are proofs about boxes, and hold wherever the function is asked as its code was
//! made for: boxes within the domain, parameters within their ranges. Debug builds assert that.

use crate::batch::{
    Boxes, Contractions, Enclosures, GradientEnclosures, Gradients, Input, Output, Planes, Points,
    Segments, Tiles, Values, Zeros,
};
use crate::binding::Binding;
use crate::differentiable::Differentiable;
use crate::forms::{Across, Along, Depth, contracted};
use crate::lanes::LANES;
use crate::real::Real;
use crate::tape::{Tape, may_vanish};
use crate::value_domain::{Bounds, Loader, Samples};
use zeroset_interval::{Enclosure, Fact, Machine};

/// A question, as a type without values.
pub trait Query: sealed::Sealed + Copy + Send + Sync + 'static {
    /// The question in a word or two, for reports.
    const NAME: &'static str;
    /// Expressions that a tape must compute to answer it.
    const OUTPUTS: usize;
    /// What is asked about.
    type Input<T: Real>: Input<T>;
    /// The answer.
    type Output<T: Real>: Output<T>;

    /// Holds a tape and a binding against what this question needs.
    ///
    /// # Panics
    /// If the tape computes another number of expressions, or assumes another number of parameters
    /// than are bound, or, in debug builds, other values.
    fn check<T: Real>(tape: &Tape<T>, binding: &Binding<T>) {
        assert_eq!(tape.outputs(), Self::OUTPUTS, "expressions that answer for {}", Self::NAME);
        assert_eq!(tape.parameters(), binding.bounds().len(), "parameters");
        debug_assert!(
            binding.is_within(&tape.assumptions().parameters),
            "code for {:?} was bound to {:?}",
            tape.assumptions().parameters,
            binding.bounds(),
        );
    }

    /// Holds what is asked about against what a tape is.
    ///
    /// # Panics
    /// If no lane is in use or more than there are, or, in debug builds, if one is beyond the
    /// domain that the tape assumes.
    #[inline]
    fn check_input<T: Real>(tape: &Tape<T>, input: &Self::Input<T>) {
        assert!((1..=LANES).contains(&input.count()), "{} lanes in use", input.count());
        debug_assert!(
            input.is_within(&tape.assumptions().domain),
            "a box reaches out of the domain"
        );
    }

    /// Writes the answer on `m`: its quantities and its masks.
    ///
    /// # Panics
    /// If the tape computes another number of expressions, or only finds zeros and this asks for
    /// more.
    fn answer<T: Real, M: Machine>(
        tape: &Tape<T>,
        m: &mut M,
        loader: &mut impl Loader<M>,
    ) -> QueryResult<M::V>;
}

/// An answer while code is written.
pub struct QueryResult<V> {
    /// In the order of the output's quantities.
    pub quantities: Vec<V>,
    /// In the order of its masks.
    pub masks: Vec<Fact<V>>,
}

/// What answers a question about one function.
pub trait Kernel<Q: Query, T: Real = f32>: Send + Sync {
    /// Answers for the lanes in use.
    ///
    /// # Panics
    /// If no lane is in use, or more than there are. In debug builds also if a box reaches out of
    /// the domain that this was made for.
    fn eval(&self, input: &Q::Input<T>, output: &mut Q::Output<T>);

    /// The answers to all of `inputs`, in order.
    ///
    /// # Panics
    /// As [`Kernel::eval`].
    fn eval_all(&self, inputs: &[Q::Input<T>]) -> Vec<Q::Output<T>> {
        let answer = |input| {
            let mut output = Q::Output::<T>::default();
            self.eval(input, &mut output);
            output
        };
        inputs.iter().map(answer).collect()
    }
}

/// Which values does the function take over a box? At each real point of the box where it is
/// defined, its value is within the bounds; the facts say where it is defined and continuous.
#[derive(Clone, Copy, Debug)]
pub struct Enclose;

/// May a box hold a zero of the function? A lane whose bit in [`Zeros::possible`] is clear has
/// none; nothing is claimed of other lanes, nor of the function's values.
#[derive(Clone, Copy, Debug)]
pub struct FindZeros;

/// Which gradients does the function have over a box, and is it differentiable there? The tape
/// computes the function and its three partial derivatives.
#[derive(Clone, Copy, Debug)]
pub struct EncloseGradient;

/// Between which ends of a segment of a ray do all zeros lie that it has in the domain, and do its
/// ends prove one?
#[derive(Clone, Copy, Debug)]
pub struct ContractSegments;

/// As [`ContractSegments`], for all rays of a tile at once, and by what linear function.
#[derive(Clone, Copy, Debug)]
pub struct ContractTiles;

/// About what is the function's value at a point? Computed in `T` rounded up; no error bound is
/// claimed.
#[derive(Clone, Copy, Debug)]
pub struct Sample;

/// About what are value and gradient at a point? As [`Sample`]; the tape computes the function and
/// its three partial derivatives.
#[derive(Clone, Copy, Debug)]
pub struct SampleGradient;

impl Query for Enclose {
    const NAME: &'static str = "bounds";
    const OUTPUTS: usize = 1;
    type Input<T: Real> = Boxes<T>;
    type Output<T: Real> = Enclosures<T>;

    fn answer<T: Real, M: Machine>(
        tape: &Tape<T>,
        m: &mut M,
        loader: &mut impl Loader<M>,
    ) -> QueryResult<M::V> {
        let Enclosure { neg_lo, hi, facts } = tape.evaluate(m, &mut Bounds(loader))[0];
        let masks = vec![facts.nowhere, facts.defined, facts.continuous];
        QueryResult { quantities: vec![neg_lo, hi], masks }
    }
}

impl Query for FindZeros {
    const NAME: &'static str = "zeros";
    const OUTPUTS: usize = 1;
    type Input<T: Real> = Boxes<T>;
    type Output<T: Real> = Zeros;

    fn answer<T: Real, M: Machine>(
        tape: &Tape<T>,
        m: &mut M,
        loader: &mut impl Loader<M>,
    ) -> QueryResult<M::V> {
        let masks = if let Some(possible) = tape.vanishing_together(m, loader) {
            // Only the possible lanes are known; nothing is claimed of the others.
            vec![possible, Fact::False, Fact::False]
        } else {
            let value = tape.evaluate(m, &mut Bounds(loader))[0];
            let possible = may_vanish(m, T::FORMAT, &value);
            let unbounded = if tape.is_bounded() {
                Fact::False
            } else {
                let most = m.max(value.neg_lo, value.hi);
                let largest = m.number(T::FORMAT, T::LARGEST.into());
                Fact::Lanes(m.lt(largest, most))
            };
            vec![possible, unbounded, value.facts.continuous.not(m, T::FORMAT)]
        };
        QueryResult { quantities: Vec::new(), masks }
    }
}

impl Query for EncloseGradient {
    const NAME: &'static str = "gradient bounds";
    const OUTPUTS: usize = 4;
    type Input<T: Real> = Boxes<T>;
    type Output<T: Real> = GradientEnclosures<T>;

    fn answer<T: Real, M: Machine>(
        tape: &Tape<T>,
        m: &mut M,
        loader: &mut impl Loader<M>,
    ) -> QueryResult<M::V> {
        let values = tape.evaluate(m, &mut Differentiable(Bounds(loader)));
        let (function, derivatives) = values.split_first().expect("a function");
        let (mut lipschitz, mut differentiable) = (function.lipschitz, function.differentiable);
        for derivative in derivatives {
            // Where the rule for a derivative gives no value, it bounds none.
            lipschitz = lipschitz.and(m, derivative.value.facts.defined);
            differentiable = differentiable.and(m, derivative.value.facts.defined);
        }
        let lower = derivatives.iter().map(|derivative| derivative.value.neg_lo);
        let upper = derivatives.iter().map(|derivative| derivative.value.hi);
        let own = [function.value.neg_lo, function.value.hi];
        let quantities = own.into_iter().chain(lower).chain(upper).collect();
        QueryResult { quantities, masks: vec![lipschitz, differentiable] }
    }
}

impl Query for ContractSegments {
    const NAME: &'static str = "segments";
    const OUTPUTS: usize = 1;
    type Input<T: Real> = Segments<T>;
    type Output<T: Real> = Contractions<T>;

    fn answer<T: Real, M: Machine>(
        tape: &Tape<T>,
        m: &mut M,
        loader: &mut impl Loader<M>,
    ) -> QueryResult<M::V> {
        let (_, new, _) = contracted::<Along, _, _, _, _>(tape, m, loader);
        QueryResult { quantities: vec![new.near, new.far], masks: vec![new.possible, new.crossing] }
    }
}

impl Query for ContractTiles {
    const NAME: &'static str = "tiles";
    const OUTPUTS: usize = 1;
    type Input<T: Real> = Tiles<T>;
    type Output<T: Real> = Planes<T>;

    fn answer<T: Real, M: Machine>(
        tape: &Tape<T>,
        m: &mut M,
        loader: &mut impl Loader<M>,
    ) -> QueryResult<M::V> {
        let (form, new, Depth { middle, half }) = contracted::<Across, _, _, _, _>(tape, m, loader);
        let zero = m.number(T::FORMAT, 0.0);
        let [a, b, depth] = form.slopes.unwrap_or([zero; 3]);
        let error = form.error(m, T::FORMAT).unwrap_or(zero);
        let quantities = vec![new.near, new.far, form.centre, a, b, depth, error, middle, half];
        QueryResult { quantities, masks: vec![new.possible, new.crossing] }
    }
}

/// Samples of all that a tape computes.
fn samples<T: Real, M: Machine>(
    tape: &Tape<T>,
    m: &mut M,
    loader: &mut impl Loader<M>,
) -> QueryResult<M::V> {
    QueryResult { quantities: tape.evaluate(m, &mut Samples(loader)), masks: Vec::new() }
}

impl Query for Sample {
    const NAME: &'static str = "values";
    const OUTPUTS: usize = 1;
    type Input<T: Real> = Points<T>;
    type Output<T: Real> = Values<T>;

    fn answer<T: Real, M: Machine>(
        tape: &Tape<T>,
        m: &mut M,
        loader: &mut impl Loader<M>,
    ) -> QueryResult<M::V> {
        samples(tape, m, loader)
    }
}

impl Query for SampleGradient {
    const NAME: &'static str = "gradients";
    const OUTPUTS: usize = 4;
    type Input<T: Real> = Points<T>;
    type Output<T: Real> = Gradients<T>;

    fn answer<T: Real, M: Machine>(
        tape: &Tape<T>,
        m: &mut M,
        loader: &mut impl Loader<M>,
    ) -> QueryResult<M::V> {
        samples(tape, m, loader)
    }
}

mod sealed {
    pub trait Sealed {}
    impl Sealed for super::Enclose {}
    impl Sealed for super::FindZeros {}
    impl Sealed for super::EncloseGradient {}
    impl Sealed for super::ContractSegments {}
    impl Sealed for super::ContractTiles {}
    impl Sealed for super::Sample {}
    impl Sealed for super::SampleGradient {}
}
