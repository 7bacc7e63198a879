//! The reference evaluator: a loop over steps on the software machine.

use crate::batch::{Batch, Input, Output};
use crate::binding::Binding;
use crate::query::{Kernel, Query, QueryNumber, QueryResult, QueryTask};
use crate::real::Real;
use crate::tape::Tape;
use crate::value_kind::Loader;
use std::any::Any;
use std::marker::PhantomData;
use zeroset_interval::{Format, Software, Vector128 as Vector};

/// Answers a query in software, with a tape and its bound parameters.
///
/// Results are bit for bit those of native kernels, but take some hundred times as long.
#[derive(Clone, Debug)]
pub struct Reference<Q: Query, T: Real = f32> {
    tape: Tape<T>,
    binding: Binding<T>,
    query: PhantomData<Q>,
}

impl<Q: Query, T: Real> Reference<Q, T> {
    /// Creates an evaluator of `tape` with the parameters of `binding`.
    ///
    /// # Panics
    /// If the number of expressions that the tape computes does not fit the query, if the tape and
    /// the binding differ in their number of parameters, or if a parameter's value is outside its
    /// range.
    pub fn new(tape: Tape<T>, binding: Binding<T>) -> Self {
        Q::check(&tape, &binding);
        Self { tape, binding, query: PhantomData }
    }
}

/// A reader of a batch that reads one vector of each quantity.
struct BatchReader<'a, Q: Query, T: Real> {
    input: &'a Q::Input<T>,
    binding: &'a Binding<T>,
    vector: usize,
}

impl<Q: Query, T: Real> Loader<Software> for BatchReader<'_, Q, T> {
    fn input(&mut self, _: &mut Software, quantity: usize) -> Vector {
        T::load(self.input.quantity(quantity), self.vector)
    }

    fn parameter(&mut self, _: &mut Software, quantity: usize) -> Vector {
        T::load(&self.binding.quantities()[quantity], 0)
    }
}

impl<Q: Query, T: Real> Kernel<Q, T> for Reference<Q, T> {
    fn eval(&self, input: &Q::Input<T>, output: &mut Q::Output<T>) {
        Q::check_input(&self.tape, input);
        (0..Q::Output::<T>::MASKS).for_each(|number| *output.mask_mut(number) = 0);
        for vector in 0..input.count().div_ceil(T::VECTOR_LANES) {
            let mut cursor = BatchReader::<Q, T> { input, binding: &self.binding, vector };
            let QueryResult { quantities, masks } =
                answer(Q::NUMBER, T::FORMAT, &self.tape, &mut cursor);
            for (number, value) in quantities.into_iter().enumerate() {
                T::store(value, vector, output.quantity_mut(number));
            }
            for (number, mask) in masks.into_iter().enumerate() {
                let bits = T::bits(mask.mask(&mut Software::new(), T::FORMAT));
                *output.mask_mut(number) |= (bits << (T::VECTOR_LANES * vector)) as u16;
            }
        }
    }
}

/// Answers a query in one vector of lanes. It is compiled in this crate alone.
fn answer(
    query: QueryNumber,
    format: Format,
    tape: &dyn Any,
    loader: &mut dyn Loader<Software>,
) -> QueryResult<Vector> {
    query.run(format, Answer { tape, loader })
}

struct Answer<'a> {
    /// A tape in the precision of the task.
    tape: &'a dyn Any,
    loader: &'a mut dyn Loader<Software>,
}

impl QueryTask for Answer<'_> {
    type Result = QueryResult<Vector>;

    fn run<Q: Query, T: Real>(mut self) -> QueryResult<Vector> {
        let tape = self.tape.downcast_ref::<Tape<T>>().expect("a tape in this precision");
        Q::answer(tape, &mut Software::new(), &mut self.loader)
    }
}
