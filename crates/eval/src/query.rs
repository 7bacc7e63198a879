//! The queries about a function, each with a contract of its own, and the kernels that answer them.
//!
//! All results but samples are proofs. They hold if kernels are evaluated under the assumptions
//! that their code was compiled for: boxes within the domain, parameters within their ranges. Debug
//! builds assert that.

use crate::batch::{
    Boxes, Contractions, Enclosures, GradientEnclosures, Gradients, Input, Output, Planes, Points,
    Segments, Tiles, Values, Zeros,
};
use crate::binding::Binding;
use crate::differentiable::SmoothnessDomain;
use crate::forms::{RayRange, SegmentPath, TilePath, evaluate_and_contract};
use crate::lanes::LANES;
use crate::real::Real;
use crate::tape::{Tape, may_vanish};
use crate::value_domain::{Bounds, Loader, Samples};
use zeroset_interval::{Enclosure, Fact, Machine};

/// A query, represented by a type.
pub trait Query: sealed::Sealed + Copy + Send + Sync + 'static {
    /// Name of the query in a word or two, for reports.
    const NAME: &'static str;
    /// Number of expressions that a tape must compute to answer the query.
    const OUTPUTS: usize;
    /// The batch that a kernel reads.
    type Input<T: Real>: Input<T>;
    /// The batch that a kernel writes.
    type Output<T: Real>: Output<T>;

    /// Checks that a tape and a binding fit this query.
    ///
    /// # Panics
    /// If the tape computes another number of expressions, or if its number of parameters is not
    /// that of the binding. In debug builds also if a value is outside the range that the tape
    /// assumes.
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

    /// Checks that an input fits the assumptions of a tape.
    ///
    /// # Panics
    /// If no lane is in use, or more than [`LANES`]. In debug builds also if a lane is outside the
    /// domain that the tape assumes.
    #[inline]
    fn check_input<T: Real>(tape: &Tape<T>, input: &Self::Input<T>) {
        assert!((1..=LANES).contains(&input.count()), "{} lanes in use", input.count());
        debug_assert!(
            input.is_within(&tape.assumptions().domain),
            "a box reaches out of the domain"
        );
    }

    /// Computes the result on `m`: its quantities and its masks.
    ///
    /// # Panics
    /// If the tape computes another number of expressions, or only finds zeros ([`Tape::branches`])
    /// and this is another query.
    fn answer<T: Real, M: Machine>(
        tape: &Tape<T>,
        m: &mut M,
        loader: &mut impl Loader<M>,
    ) -> QueryResult<M::V>;
}

/// The result of a query as values of a machine.
pub struct QueryResult<V> {
    /// Values in the order of the output's quantities.
    pub quantities: Vec<V>,
    /// Facts in the order of the output's masks.
    pub masks: Vec<Fact<V>>,
}

/// An evaluator of one query about one function.
pub trait Kernel<Q: Query, T: Real = f32>: Send + Sync {
    /// Evaluates the lanes in use.
    ///
    /// # Panics
    /// If no lane is in use, or more than [`LANES`]. In debug builds also if a box reaches out of
    /// the domain that the kernel was compiled for.
    fn eval(&self, input: &Q::Input<T>, output: &mut Q::Output<T>);

    /// Returns the results for all `inputs`, in order.
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

/// Defines a query: its name, the number of its expressions, what kernels read and write, and how
/// the answer is computed.
macro_rules! query {
    (
        $(#[$doc:meta])* $query:ident($name:literal, $outputs:literal): $input:ty => $output:ty,
        |$tape:ident, $m:ident, $loader:ident| $answer:expr
    ) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        pub struct $query;

        impl sealed::Sealed for $query {}

        impl Query for $query {
            const NAME: &'static str = $name;
            const OUTPUTS: usize = $outputs;
            type Input<T: Real> = $input;
            type Output<T: Real> = $output;

            fn answer<T: Real, M: Machine>(
                $tape: &Tape<T>,
                $m: &mut M,
                $loader: &mut impl Loader<M>,
            ) -> QueryResult<M::V> {
                $answer
            }
        }
    };
}

query! {
    /// Bounds of the function's values over a box. At each real point of the box where the function
    /// is defined, its value is within them. The facts tell where it is defined and continuous.
    Enclose("bounds", 1): Boxes<T> => Enclosures<T>, |tape, m, loader| {
        let Enclosure { neg_lo, hi, facts } = tape.evaluate(m, &mut Bounds(loader))[0];
        let masks = vec![facts.nowhere, facts.defined, facts.continuous];
        QueryResult { quantities: vec![neg_lo, hi], masks }
    }
}

query! {
    /// A test whether a box may hold a zero of the function. If the bit of a lane in
    /// [`Zeros::possible`] is clear, its box holds no zero. A set bit claims nothing.
    FindZeros("zeros", 1): Boxes<T> => Zeros, |tape, m, loader| {
        let masks = if let Some(possible) = tape.vanishing_together(m, loader) {
            // Only the mask `possible` is computed; the other two claim nothing.
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

query! {
    /// Bounds of the function's gradient over a box, and whether the function is differentiable in
    /// the box. The tape computes the function and its three partial derivatives.
    EncloseGradient("gradient bounds", 4): Boxes<T> => GradientEnclosures<T>, |tape, m, loader| {
        let values = tape.evaluate(m, &mut SmoothnessDomain(Bounds(loader)));
        let (function, derivatives) = values.split_first().expect("a function");
        let (mut lipschitz, mut differentiable) = (function.lipschitz, function.differentiable);
        for derivative in derivatives {
            // At points where the formula of a derivative is undefined, its bounds do not bound the
            // derivative.
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

query! {
    /// Narrows a segment of a ray to a part that contains all zeros on it in the domain. Also tells
    /// whether the signs at the ends of the segment prove a zero.
    ContractSegments("segments", 1): Segments<T> => Contractions<T>, |tape, m, loader| {
        let (_, new, _) = evaluate_and_contract::<SegmentPath, _, _, _, _>(tape, m, loader);
        QueryResult { quantities: vec![new.near, new.far], masks: vec![new.possible, new.crossing] }
    }
}

query! {
    /// Like [`ContractSegments`], but for all rays of a tile at once. Also returns a linear
    /// approximation of the function.
    ContractTiles("tiles", 1): Tiles<T> => Planes<T>, |tape, m, loader| {
        let (form, new, RayRange { middle, half }) =
            evaluate_and_contract::<TilePath, _, _, _, _>(tape, m, loader);
        let zero = m.number(T::FORMAT, 0.0);
        let [a, b, depth] = form.slopes.unwrap_or([zero; 3]);
        let error = form.error(m, T::FORMAT).unwrap_or(zero);
        let quantities = vec![new.near, new.far, form.centre, a, b, depth, error, middle, half];
        QueryResult { quantities, masks: vec![new.possible, new.crossing] }
    }
}

query! {
    /// Approximate value of the function at a point, computed in `T` and rounded up. No error bound
    /// is claimed.
    Sample("values", 1): Points<T> => Values<T>, |tape, m, loader| {
        QueryResult { quantities: tape.evaluate(m, &mut Samples(loader)), masks: Vec::new() }
    }
}

query! {
    /// Approximate value and gradient at a point, as for [`Sample`]. The tape computes the function
    /// and its three partial derivatives.
    SampleGradient("gradients", 4): Points<T> => Gradients<T>, |tape, m, loader| {
        QueryResult { quantities: tape.evaluate(m, &mut Samples(loader)), masks: Vec::new() }
    }
}

mod sealed {
    pub trait Sealed {}
}
