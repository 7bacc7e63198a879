//! Kernels that evaluate queries on a machine which does one thing wrong.

use crate::machine::{Perturbed, Plan};
use std::any::Any;
use zeroset_eval::{
    Batch, Binding, Input, Kernel, LANES, Loader, Output, Query, QueryNumber, QueryResult,
    QueryTask, Real, Tape,
};
use zeroset_interval::{Format, Software, Vector128};

/// Answers a query as [`Reference`](zeroset_eval::Reference) does, but on another machine.
pub struct PerturbedKernel<Q: Query, T: Real> {
    tape: Tape<T>,
    binding: Binding<T>,
    plan: Plan,
    query: std::marker::PhantomData<Q>,
}

impl<Q: Query, T: Real> PerturbedKernel<Q, T> {
    pub fn new(tape: Tape<T>, binding: Binding<T>, plan: &Plan) -> Self {
        Q::check(&tape, &binding);
        Self { tape, binding, plan: plan.clone(), query: std::marker::PhantomData }
    }
}

struct BatchReader<'a, Q: Query, T: Real> {
    input: &'a Q::Input<T>,
    binding: &'a Binding<T>,
    vector: usize,
}

impl<Q: Query, T: Real> Loader<Perturbed> for BatchReader<'_, Q, T> {
    fn input(&mut self, _: &mut Perturbed, quantity: usize) -> Vector128 {
        T::load(self.input.quantity(quantity), self.vector)
    }

    fn parameter(&mut self, _: &mut Perturbed, quantity: usize) -> Vector128 {
        T::load(&self.binding.quantities()[quantity], 0)
    }
}

impl<Q: Query, T: Real> Kernel<Q, T> for PerturbedKernel<Q, T> {
    fn eval(&self, input: &Q::Input<T>, output: &mut Q::Output<T>) {
        Q::check_input(&self.tape, input);
        (0..Q::Output::<T>::MASKS).for_each(|number| *output.mask_mut(number) = 0);
        // One kind of machine on all processors, so that summaries are the same.
        let mut machine = Perturbed::new(Software::BOTH[0], &self.plan);
        for vector in 0..input.count().div_ceil(T::VECTOR_LANES) {
            let mut reader = BatchReader::<Q, T> { input, binding: &self.binding, vector };
            let QueryResult { quantities, masks } =
                answer(Q::NUMBER, T::FORMAT, &self.tape, &mut machine, &mut reader);
            for (number, value) in quantities.into_iter().enumerate() {
                T::store(value, vector, output.quantity_mut(number));
            }
            for (number, mask) in masks.into_iter().enumerate() {
                let bits = T::bits(mask.mask(&mut Software::new(), T::FORMAT));
                *output.mask_mut(number) |= (bits << (T::VECTOR_LANES * vector)) as u16;
            }
        }
        self.plan.summarise(|summary| {
            let used = u16::MAX >> (LANES - input.count());
            for number in 0..Q::Output::<T>::MASKS {
                summary.facts += u64::from((output.mask(number) & used).count_ones());
            }
            for number in 0..Q::Output::<T>::QUANTITIES {
                let lanes = output.quantity(number).iter().take(input.count());
                lanes.for_each(|lane| summary.bound((*lane).into()));
            }
        });
    }
}

fn answer(
    query: QueryNumber,
    format: Format,
    tape: &dyn Any,
    machine: &mut Perturbed,
    loader: &mut dyn Loader<Perturbed>,
) -> QueryResult<Vector128> {
    query.run(format, Answer { tape, machine, loader })
}

struct Answer<'a> {
    tape: &'a dyn Any,
    machine: &'a mut Perturbed,
    loader: &'a mut dyn Loader<Perturbed>,
}

impl QueryTask for Answer<'_> {
    type Result = QueryResult<Vector128>;

    fn run<Q: Query, T: Real>(mut self) -> QueryResult<Vector128> {
        let tape = self.tape.downcast_ref::<Tape<T>>().expect("a tape in this precision");
        Q::answer(tape, self.machine, &mut self.loader)
    }
}
