//! The queries about a function, each with its own contract, and the kernels that answer them.
//!
//! All results but samples are proofs. They hold under the assumptions for which the kernel was
//! compiled: boxes are within the domain, and parameters within their ranges. A kernel refuses
//! others.

use crate::batch::{
    Batch, Boxes, BranchSigns, Contractions, Enclosures, GradientEnclosures, Gradients, Input,
    Output, Patches, Planes, Points, Segments, Tiles, Values, Zeros,
};
use crate::binding::Binding;
use crate::differentiable::{Smooth, Smoothness};
use crate::duals::{Dual, Duals};
use crate::forms::{PatchPath, SegmentPath, TilePath, contract_path};
use crate::lanes::LANES;
use crate::real::Real;
use crate::shorten::LaneSet;
use crate::tape::{Tape, may_vanish};
use crate::value_kind::{Forms, Intervals, Loader, Numbers, ValueKind};
use zeroset_interval::{Enclosure, Fact, Form, Format, Machine, RayRange};

/// A query, represented by a type.
pub trait Query: sealed::Sealed + Copy + Send + Sync + 'static {
    /// The query as a value.
    const NUMBER: QueryNumber;
    /// Name of the query for reports, one or two words long.
    const NAME: &'static str;
    /// Number of expressions that a tape must compute for the query.
    const OUTPUTS: usize;
    /// The kind of values that a tape computes.
    type Kind: ValueKind;
    /// The batch that a kernel reads.
    type Input<T: Real>: Input<T>;
    /// The batch that a kernel writes.
    type Output<T: Real>: Output<T>;

    /// Checks that a tape and a binding fit this query.
    ///
    /// # Panics
    /// If the number of expressions that the tape computes does not fit the query, if the tape and
    /// the binding differ in their number of parameters, or if a parameter's value is outside the
    /// range that the tape assumes.
    fn check<T: Real>(tape: &Tape<T>, binding: &Binding<T>) {
        assert_eq!(tape.outputs(), Self::OUTPUTS, "expressions that answer for {}", Self::NAME);
        assert_eq!(tape.parameters(), binding.bounds().len(), "parameters");
        assert!(
            binding.is_within(&tape.assumptions().parameters),
            "code for {:?} was bound to {:?}",
            tape.assumptions().parameters,
            binding.bounds(),
        );
    }

    /// Checks that an input fits the assumptions of a tape.
    ///
    /// # Panics
    /// If no lanes are in use, or more than [`LANES`], or if the data of a lane are outside the
    /// domain that the tape assumes.
    #[inline]
    fn check_input<T: Real>(tape: &Tape<T>, input: &Self::Input<T>) {
        Self::check_count(input);
        assert!(input.is_within(&tape.assumptions().domain), "a box reaches out of the domain");
    }

    /// Checks the number of lanes in use.
    ///
    /// # Panics
    /// If no lanes are in use, or more than [`LANES`].
    #[inline]
    fn check_count<T: Real>(input: &Self::Input<T>) {
        assert!((1..=LANES).contains(&input.count()), "{} lanes in use", input.count());
    }

    /// Computes the result from the values of the expressions. `is_bounded` states that the first
    /// is finite in every sample.
    fn result<T: Real, M: Machine>(
        m: &mut M,
        loader: &mut impl Loader<M>,
        context: QueryContext<Self, M>,
        values: &[QueryValue<Self, M>],
        is_bounded: bool,
    ) -> QueryResult<M::V>;

    /// Computes the query's result on `m`.
    ///
    /// # Panics
    /// If the number of expressions that the tape computes does not fit the query, or if the tape
    /// is made by [`Tape::branches`] and the query is not [`FindZerosInBranch`], or the reverse.
    fn answer<T: Real, M: Machine>(
        tape: &Tape<T>,
        m: &mut M,
        loader: &mut impl Loader<M>,
    ) -> QueryResult<M::V> {
        let context = Self::Kind::context::<T, M>(m, loader);
        let values = tape.evaluate::<Self, M>(m, loader, context);
        Self::result::<T, M>(m, loader, context, &values, tape.is_bounded())
    }
}

/// The data that all coordinates of a batch use for query `Q` on machine `M`.
pub type QueryContext<Q, M> = <<Q as Query>::Kind as ValueKind>::Context<<M as Machine>::V>;

/// A value that a tape computes for query `Q` on machine `M`.
pub type QueryValue<Q, M> = <<Q as Query>::Kind as ValueKind>::Value<<M as Machine>::V>;

/// The result of a query, as values of a machine.
pub struct QueryResult<V> {
    /// The values, in the order of the output's quantities.
    pub quantities: Vec<V>,
    /// The facts, in the order of the output's masks.
    pub masks: Vec<Fact<V>>,
}

/// A task for any query in any precision. It is [run](QueryNumber::run) from a function that is not
/// generic, so that no other crate compiles the task again.
pub trait QueryTask {
    /// The result of the task.
    type Result;

    /// Carries out the task for one query in one precision.
    fn run<Q: Query, T: Real>(self) -> Self::Result;
}

/// An evaluator of one query about one function.
pub trait Kernel<Q: Query, T: Real = f32>: Send + Sync {
    /// Evaluates the lanes of `input` that are in use.
    ///
    /// # Panics
    /// If no lanes are in use, or more than [`LANES`], or if a box reaches out of the domain for
    /// which the kernel was compiled.
    fn eval(&self, input: &Q::Input<T>, output: &mut Q::Output<T>);

    /// As [`Kernel::eval`], for boxes that the caller has clipped to the domain. Only debug builds
    /// compare them again: in `knoll` that takes an eighth of a picture's time.
    fn eval_clipped(&self, input: &Q::Input<T>, output: &mut Q::Output<T>) {
        self.eval(input, output);
    }

    /// Returns the results for all `inputs`, in order.
    ///
    /// # Panics
    /// If [`Kernel::eval`] panics for an input.
    fn eval_all(&self, inputs: &[Q::Input<T>]) -> Vec<Q::Output<T>> {
        let answer = |input| {
            let mut output = Q::Output::<T>::default();
            self.eval(input, &mut output);
            output
        };
        inputs.iter().map(answer).collect()
    }
}

/// Evaluates the boxes in `lanes` of a batch. If they are at most half of the boxes in use, they
/// are first gathered in a batch of their own. The result is meaningless in other lanes.
pub(crate) fn eval_lanes<Q: Query<Input<T> = Boxes<T>>, T: Real>(
    kernel: &dyn Kernel<Q, T>,
    boxes: &Boxes<T>,
    lanes: LaneSet,
) -> Q::Output<T> {
    let mut answer = Q::Output::<T>::default();
    if 2 * lanes.count_ones() > boxes.count {
        kernel.eval(boxes, &mut answer);
        return answer;
    }
    kernel.eval(&boxes.gathered(lanes), &mut answer);
    let mut spread = Q::Output::<T>::default();
    let places = || (0..LANES).filter(|lane| lanes >> lane & 1 == 1).enumerate();
    for number in 0..Q::Output::<T>::QUANTITIES {
        let (from, to) = (answer.quantity(number), spread.quantity_mut(number));
        places().for_each(|(k, lane)| to[lane] = from[k]);
    }
    for number in 0..Q::Output::<T>::MASKS {
        let mask = answer.mask(number);
        *spread.mask_mut(number) = places().map(|(k, lane)| (mask >> k & 1) << lane).sum();
    }
    spread
}

/// Defines the queries. A row has the name for reports, the number of expressions that a tape must
/// compute, and the kind of their values. Then come the batches that a kernel reads and writes, and
/// the result. A query that is not evaluated as a whole also names its own `answer`.
macro_rules! queries {
    ($(
        $(#[$doc:meta])*
        $query:ident($name:literal, $outputs:literal, $kind:ty, $input:ident => $output:ty)
            = |$m:pat_param, $loader:pat_param, $context:pat_param, $values:pat_param, $bounded:pat_param|
            $result:expr $(, $answer:expr)?;
    )*) => {
        /// The queries as values.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum QueryNumber {
            $(#[doc = concat!("[`", stringify!($query), "`].")] $query,)*
        }

        impl QueryNumber {
            /// Carries out a task for this query.
            pub fn run<K: QueryTask>(self, format: Format, task: K) -> K::Result {
                match (self, format) {
                    $((Self::$query, Format::F32) => task.run::<$query, f32>(),
                    (Self::$query, Format::F64) => task.run::<$query, f64>(),)*
                }
            }
        }

        $(
            $(#[$doc])*
            #[derive(Clone, Copy, Debug)]
            pub struct $query;

            impl sealed::Sealed for $query {}

            impl Query for $query {
                const NUMBER: QueryNumber = QueryNumber::$query;
                const NAME: &'static str = $name;
                const OUTPUTS: usize = $outputs;
                type Kind = $kind;
                type Input<T: Real> = $input<T>;
                type Output<T: Real> = $output;

                fn result<T: Real, M: Machine>(
                    $m: &mut M,
                    $loader: &mut impl Loader<M>,
                    $context: QueryContext<Self, M>,
                    $values: &[QueryValue<Self, M>],
                    $bounded: bool,
                ) -> QueryResult<M::V> {
                    $result
                }

                $(fn answer<T: Real, M: Machine>(
                    tape: &Tape<T>,
                    m: &mut M,
                    loader: &mut impl Loader<M>,
                ) -> QueryResult<M::V> {
                    $answer(tape, m, loader)
                })?
            }
        )*
    };
}

queries! {
    /// Bounds of the function over a box. They contain the function's value at each real point of
    /// the box where it is defined. The facts tell where the function is defined and continuous.
    Enclose("bounds", 1, Intervals, Boxes => Enclosures<T>) = |_, _, (), values, _| {
        let Enclosure { neg_lo, hi, facts } = values[0];
        let masks = vec![facts.nowhere, facts.defined, facts.continuous];
        QueryResult { quantities: vec![neg_lo, hi], masks }
    };

    /// A test whether a box may hold a zero of the function. If a lane's bit in [`Zeros::possible`]
    /// is clear, its box is proven to hold no zero. A set bit proves nothing.
    FindZeros("zeros", 1, Intervals, Boxes => Zeros) = |m, _, (), values, is_bounded| {
        zeros::<T, M>(m, values[0], is_bounded)
    };

    /// A test of one combination of branches of a function that jumps. The tape is made by
    /// [`Tape::branches`], and the binding selects the combination. The results hold at those
    /// points of the box that belong to it.
    FindZerosInBranch("zeros", 1, Intervals, Boxes => BranchSigns<T>) = |_, _, (), _, _| {
        unreachable!("a tape of branches is not evaluated as a whole")
    }, zeros_in_branch;

    /// Bounds of the function and its gradient over a box, and whether the function is Lipschitz
    /// continuous and differentiable in it. The tape computes the function and its three partial
    /// derivatives.
    EncloseGradient("gradient bounds", 4, Smoothness, Boxes => GradientEnclosures<T>)
        = |m, _, (), values, _| gradient_bounds(m, values);

    /// Narrows a segment of a ray to a part that contains all zeros on the segment within the
    /// domain. Also tells whether the function's signs at the segment's ends prove a zero.
    ContractSegments("segments", 1, Forms<SegmentPath, 1>, Segments => Contractions<T>)
        = |m, loader, depth, forms, _| {
            let new = contract_path::<SegmentPath, _, 1>(m, T::FORMAT, loader, depth, &forms[0]);
            let masks = vec![new.possible, new.crossing];
            QueryResult { quantities: vec![new.near, new.far], masks }
        };

    /// Like [`ContractSegments`], but for all rays of a tile at once. Also returns a linear
    /// approximation of the function over the tile.
    ContractTiles("tiles", 1, Forms<TilePath, 3>, Tiles => Planes<T>)
        = |m, loader, depth, forms, _| planes::<T, M>(m, loader, depth, &forms[0]);

    /// Linear approximations of three functions of u and v, the coordinates of a surface's points,
    /// over cells. The box's first two coordinates are the ranges of u and v.
    BoundPatches("patches", 3, Forms<PatchPath, 2>, Boxes => Patches<T>)
        = |m, _, ranges, forms, _| patches::<T, M>(m, ranges, forms);

    /// Approximate value of the function at a point, computed in `T`. It has no error bound.
    Sample("values", 1, Numbers, Points => Values<T>) = |_, _, (), values, _| {
        QueryResult { quantities: values.to_vec(), masks: Vec::new() }
    };

    /// Approximate value and gradient of the function at a point. Like those of [`Sample`], they
    /// have no error bounds. The tape computes the function and its three partial derivatives.
    SampleGradient("gradients", 4, Numbers, Points => Gradients<T>) = |_, _, (), values, _| {
        QueryResult { quantities: values.to_vec(), masks: Vec::new() }
    };

    /// Like [`SampleGradient`], but the tape computes the function alone. Its gradient is
    /// propagated forward.
    SampleForward("gradients", 1, Duals, Points => Gradients<T>) = |m, _, (), values, _| {
        let Dual { value, slopes } = values[0];
        let slopes = slopes.unwrap_or_else(|| [m.number(T::FORMAT, 0.0); 3]);
        QueryResult { quantities: [&[value], &slopes[..]].concat(), masks: Vec::new() }
    };
}

fn zeros<T: Real, M: Machine>(
    m: &mut M,
    value: Enclosure<M::V>,
    is_bounded: bool,
) -> QueryResult<M::V> {
    let possible = may_vanish(m, T::FORMAT, &value);
    let unbounded = if is_bounded {
        Fact::False
    } else {
        let most = m.max(value.neg_lo, value.hi);
        let largest = m.number(T::FORMAT, T::LARGEST.into());
        Fact::Lanes(m.lt(largest, most))
    };
    let masks = vec![possible, unbounded, value.facts.continuous.not(m, T::FORMAT)];
    QueryResult { quantities: Vec::new(), masks }
}

fn zeros_in_branch<T: Real, M: Machine>(
    tape: &Tape<T>,
    m: &mut M,
    loader: &mut impl Loader<M>,
) -> QueryResult<M::V> {
    assert!(tape.is_by_branches(), "a tape without branches");
    let answer = tape.enclose_in_branch(m, loader);
    let possible = answer.possible(m, T::FORMAT);
    let [below, above] = answer.sides(m, T::FORMAT);
    let choices = answer.choices(m, T::FORMAT);
    QueryResult { quantities: vec![choices], masks: vec![possible, below, above] }
}

fn gradient_bounds<M: Machine>(m: &mut M, values: &[Smooth<M::V>]) -> QueryResult<M::V> {
    let (function, derivatives) = values.split_first().expect("a function");
    let (mut lipschitz, mut differentiable) = (function.lipschitz, function.differentiable);
    for derivative in derivatives {
        // A derivative's bounds hold only at points where its formula is defined.
        lipschitz = lipschitz.and(m, derivative.value.facts.defined);
        differentiable = differentiable.and(m, derivative.value.facts.defined);
    }
    let lower = derivatives.iter().map(|derivative| derivative.value.neg_lo);
    let upper = derivatives.iter().map(|derivative| derivative.value.hi);
    let own = [function.value.neg_lo, function.value.hi];
    let quantities = own.into_iter().chain(lower).chain(upper).collect();
    QueryResult { quantities, masks: vec![lipschitz, differentiable] }
}

fn planes<T: Real, M: Machine>(
    m: &mut M,
    loader: &mut impl Loader<M>,
    depth: RayRange<M::V>,
    form: &Form<M::V, 3>,
) -> QueryResult<M::V> {
    let RayRange { middle, half } = depth;
    let new = contract_path::<TilePath, _, 3>(m, T::FORMAT, loader, depth, form);
    let zero = m.number(T::FORMAT, 0.0);
    let [a, b, depth] = form.slopes.unwrap_or([zero; 3]);
    let error = form.error(m, T::FORMAT).unwrap_or(zero);
    let quantities = vec![new.near, new.far, form.centre, a, b, depth, error, middle, half];
    let jumping = form.facts.continuous.not(m, T::FORMAT);
    QueryResult { quantities, masks: vec![new.possible, new.crossing, jumping] }
}

fn patches<T: Real, M: Machine>(
    m: &mut M,
    ranges: [RayRange<M::V>; 2],
    forms: &[Form<M::V, 2>],
) -> QueryResult<M::V> {
    let zero = m.number(T::FORMAT, 0.0);
    let [u, v] = ranges;
    let mut quantities = vec![u.middle, v.middle, u.half, v.half];
    quantities.extend(forms.iter().map(|form| form.centre));
    for symbol in 0..2 {
        quantities
            .extend(forms.iter().map(|form| form.slopes.map_or(zero, |slopes| slopes[symbol])));
    }
    for form in forms {
        quantities.push(form.error(m, T::FORMAT).unwrap_or(zero));
    }
    let (mut nowhere, mut continuous) = (Fact::False, Fact::True);
    for form in forms {
        nowhere = nowhere.or(m, form.facts.nowhere);
        continuous = continuous.and(m, form.facts.continuous);
    }
    QueryResult { quantities, masks: vec![nowhere, continuous] }
}

mod sealed {
    pub trait Sealed {}
}
