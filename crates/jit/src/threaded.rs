//! Kernels without compilation: a tape is run by calling its stencils one after another.

mod clause_calls;
mod constants;

use crate::clause_code::{TABLE, USED};
use crate::compiler::vector_widths;
use crate::error::Error;
use crate::rounding::call_rounding_up;
use crate::stencil::{OperandNumber, StencilFinder, StencilOperand, StencilStep, parts};
use crate::stencil_code::{Run, StencilCall, call_loop};
use clause_calls::{ClauseIn, ClauseSteps, SharedCode, coordinate_offset};
use constants::{Constants, used_directly};
use smallvec::SmallVec;
use std::cell::{Cell, RefCell};
use std::fmt;
use std::marker::PhantomData;
use std::sync::Arc;
use zeroset_eval::{
    Binding, Clauses, DecidingSteps, Input, Kernel, Loader, Output, Query, Real, SelectedOperand,
    SelectedStep, Selection, Shortener, Step, StepBounds, Tape, ValueKind,
};
use zeroset_interval::{Exponent, Software, Vector128};
use zeroset_ops::Op;

/// Bytes to which vectors are aligned, whatever their width.
const ALIGNMENT: usize = 64;

/// Offsets have 32 bits.
const TOO_LARGE: Error = Error::Unsupported("frames of more than 4 GiB");

/// Memory for vectors.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
struct Block([u8; ALIGNMENT]);

thread_local! {
    /// The frame of a thread, which all its tapes use in turn.
    static FRAME: RefCell<Vec<Block>> = const { RefCell::new(Vec::new()) };
    /// A thread's memory for laying out calls.
    static LAYOUT: Cell<Layout> = Cell::default();
}

/// Memory for laying out calls.
#[derive(Default)]
struct Layout {
    /// The code and the kind of each step's value.
    values: Vec<StepValue>,
    slots: Slots,
}

/// Most steps of a layout that a thread keeps for the next one.
const LAYOUT_STEPS: usize = 1 << 20;

/// A tape with its parameters bound, prepared for one query: its constants are computed, and there
/// is a stencil for each of its steps. [Threaded] kernels of some of its steps share it.
pub struct StencilTape<Q: Query, T: Real = f32> {
    tape: Arc<Tape<T>>,
    steps: Vec<TapeStep>,
    /// The calls of the clauses that share no code.
    clauses: Vec<ClauseSteps>,
    /// The codes that clauses share.
    codes: Vec<SharedCode>,
    /// Bytes for coordinates, with which a frame begins.
    coordinates: usize,
    /// Bytes for values inside of a clause.
    inside: usize,
    /// Constants and parameters, repeated in all lanes, and the tables of clauses.
    constants: Vec<Block>,
    width: usize,
    query: PhantomData<Q>,
}

/// The code and the kind of a step's value.
#[derive(Clone, Copy)]
struct StepValue {
    /// First instruction of the stencil; null for a constant.
    entry: *const u8,
    number: OperandNumber,
    /// Number of vectors.
    parts: u32,
}

/// A step of a tape: all that a layout needs of it. If it is a constant or a parameter, it has a
/// place, and another number as an exponent.
struct TapeStep {
    value: StepValue,
    exponent: OperandNumber,
    /// Offset in bytes among the constants.
    at: u32,
    /// Numbers of the operands of an operation, or of the steps that shared code uses.
    used: [OperandNumber; 3],
    clause: ClauseCall,
}

/// The call of a clause that ends with a step.
#[derive(Clone, Copy)]
enum ClauseCall {
    /// No clause ends with the step.
    None,
    /// A call of shared code: its number among those of the tape, and the offset of the clause's
    /// table of constants.
    Shared { code: u32, table: u32 },
    /// A call for each step: the number among [`StencilTape::clauses`].
    Steps(u32),
}

// SAFETY: the addresses in `steps` are those of finished code, which is read-only, shared and never
// freed.
unsafe impl<Q: Query, T: Real> Send for StencilTape<Q, T> {}
// SAFETY: as above. Nothing changes it once it is created.
unsafe impl<Q: Query, T: Real> Sync for StencilTape<Q, T> {}

impl<Q: Query, T: Real> StencilTape<Q, T> {
    /// Computes the constants of a [coarse](Tape::coarse) tape, compiles the stencils that this
    /// process has not needed before, and lays out the calls of clauses.
    ///
    /// # Errors
    /// If the processor is not supported, or the constants need more than 4 GiB.
    ///
    /// # Panics
    /// If the tape is not coarse, if it computes another number of expressions than the query
    /// needs, if its number of parameters is not that of the binding, or if a value is outside its
    /// range.
    pub fn new(
        tape: &Arc<Tape<T>>,
        binding: &Binding<T>,
        clauses: &Clauses,
    ) -> Result<Self, Error> {
        let mut result = Err(Error::Unsupported("vectors"));
        for width in vector_widths() {
            result = Self::of_width(tape, binding, clauses, width);
            if result.is_ok() {
                break;
            }
        }
        result
    }

    fn of_width(
        tape: &Arc<Tape<T>>,
        binding: &Binding<T>,
        clauses: &Clauses,
        width: usize,
    ) -> Result<Self, Error> {
        assert!(tape.is_coarse(), "stencils rely on coarse ranges");
        Q::check(tape, binding);
        call_loop()?;
        let mut finder = StencilFinder::<Q, T>::new(width);
        let count = tape.steps().len();
        let mut constants = Constants::new(count, width);
        let is_direct = used_directly(tape, clauses);
        let mut codes = Vec::new();
        let mut known = vec![None; clauses.shapes()];
        let mut steps = Vec::<TapeStep>::with_capacity(count);
        let mut coordinates = 0;
        for (index, step) in tape.steps().iter().enumerate() {
            let m = &mut Software::new();
            let clause = clauses.ending_with(index);
            let (mut used, mut call) = ([OperandNumber::MAX; 3], ClauseCall::None);
            let (entry, shape) = match step {
                Step::Parameter(_) | Step::Constant(..) => {
                    let value = match step {
                        Step::Constant(bounds, _) => Q::Kind::constant::<T, _>(m, *bounds),
                        Step::Parameter(number) => {
                            let mut loader = Parameters(binding);
                            Q::Kind::parameter::<T, _>(m, &mut loader, *number as usize)
                        }
                        _ => unreachable!("a constant or a parameter"),
                    };
                    let value = Q::Kind::settled::<T, _>(m, value);
                    let shape = Q::Kind::map(&value, &mut |vector| constants.add(index, vector));
                    (std::ptr::null(), shape)
                }
                Step::Coordinate(axis) => {
                    let stencil = finder.find(&StencilStep::Coordinate(*axis))?;
                    let shape = stencil.shape.expect("a step has a value");
                    coordinates = 3 * parts::<Q>(&shape) * width;
                    (stencil.code.entry(), shape)
                }
                Step::Apply(..) if clauses.is_in_shape(index) => {
                    steps.push(TapeStep::NONE);
                    continue;
                }
                Step::Apply(op, operands) => {
                    let shape = clause.and_then(|clause| Some((clause, clause.shape?)));
                    let stencil = if let Some((clause, shape)) = shape {
                        let clause = ClauseIn { tape, steps: &steps, clause, width };
                        let known = &mut known[shape as usize];
                        let code = SharedCode::find(&mut codes, known, clause, &mut finder);
                        let table = constants.store(clause.constants())?;
                        call = ClauseCall::Shared { code: code as u32, table };
                        let SharedCode { number, code } = &codes[code];
                        used.iter_mut().zip(&code.used).for_each(|(used, number)| *used = *number);
                        finder.find(&StencilStep::Clause(*number, &code.used))?
                    } else {
                        let number = |&operand: &usize| match op {
                            Op::Pow => steps[operand].exponent,
                            _ => steps[operand].value.number,
                        };
                        for (used, operand) in used.iter_mut().zip(operands) {
                            *used = steps[*operand].value.number;
                        }
                        let operands: SmallVec<[_; 3]> = operands.iter().map(number).collect();
                        finder.find(&StencilStep::Apply(*op, &operands))?
                    };
                    (stencil.code.entry(), stencil.shape.expect("a step has a value"))
                }
            };
            let is_constant = entry.is_null();
            let at = if is_constant && is_direct[index] { constants.store([index])? } else { 0 };
            let range = tape.range(index);
            let mut number =
                |exponent| finder.number(&StencilOperand { shape, range, exponent, is_constant });
            let own = number(Exponent::Real);
            // Only powers distinguish exponents.
            let exponent = match step.exponent() {
                Exponent::Real => own,
                exponent => number(exponent),
            };
            let value = StepValue { entry, number: own, parts: parts::<Q>(&shape) as u32 };
            steps.push(TapeStep { value, exponent, at, used, clause: call });
        }
        let mut slots = Slots::default();
        let mut inside = 0;
        let mut apart = Vec::new();
        for index in 0..count {
            let ClauseCall::None = steps[index].clause else { continue };
            let Some(clause) = clauses.ending_with(index) else { continue };
            let clause = ClauseIn { tape, steps: &steps, clause, width };
            let calls = ClauseSteps::new(clause, &mut slots);
            inside = inside.max(slots.end);
            steps[index].clause = ClauseCall::Steps(apart.len() as u32);
            apart.push(calls);
        }
        Ok(Self {
            tape: Arc::clone(tape),
            steps,
            clauses: apart,
            codes,
            coordinates: coordinates.next_multiple_of(ALIGNMENT),
            inside,
            constants: blocks(&constants.bytes),
            width,
            query: PhantomData,
        })
    }

    /// Returns the number of the axis of a coordinate.
    #[inline]
    fn axis(&self, step: &SelectedStep) -> usize {
        match step.origin().map(|origin| &self.tape.steps()[origin]) {
            Some(Step::Coordinate(axis)) => *axis as usize,
            _ => unreachable!("a coordinate"),
        }
    }

    /// Returns the operation of a step, which must have operands.
    #[inline]
    fn operation(&self, step: &SelectedStep) -> Op {
        match step.origin().map(|origin| &self.tape.steps()[origin]) {
            None => Op::Neg,
            Some(Step::Apply(op, _)) => *op,
            Some(Step::Coordinate(_) | Step::Parameter(_) | Step::Constant(..)) => {
                unreachable!("a step with operands")
            }
        }
    }

    /// Returns the exponent of a step that is a power in the tape. A constant that replaces it is
    /// no whole exponent, though it may be a whole number: real powers of numbers below 0 stay
    /// undefined.
    #[inline]
    fn exponent(&self, step: &SelectedStep) -> Option<usize> {
        match &self.tape.steps()[step.origin()?] {
            Step::Apply(Op::Pow, operands) => operands.get(1).copied(),
            _ => None,
        }
    }
}

impl TapeStep {
    /// A step inside of shared code, which has no code of its own.
    const NONE: Self = {
        let number = OperandNumber::MAX;
        let value = StepValue { entry: std::ptr::null(), number, parts: 0 };
        Self { value, exponent: number, at: 0, used: [number; 3], clause: ClauseCall::None }
    };
}

/// A loader of parameters only.
struct Parameters<'a, T: Real>(&'a Binding<T>);

impl<T: Real> Loader<Software> for Parameters<'_, T> {
    fn input(&mut self, _: &mut Software, _: usize) -> Vector128 {
        unreachable!("parameters depend on no input")
    }

    fn parameter(&mut self, _: &mut Software, quantity: usize) -> Vector128 {
        T::load(&self.0.quantities()[quantity], 0)
    }
}

/// Steps of a tape as calls of stencils. A kernel like [`Native`](crate::Native), for formulas of
/// any size, that takes microseconds to create once its stencils exist.
///
/// Results have the bits of the reference evaluator for the [coarse](Tape::coarse) tape.
pub struct Threaded<Q: Query, T: Real = f32> {
    tape: Arc<StencilTape<Q, T>>,
    calls: Vec<StencilCall>,
    /// Size of the frame in blocks.
    frame: usize,
    /// Number of steps whose bounds are traced. In the frame, the trace follows the coordinates.
    traced: usize,
}

// SAFETY: the addresses in `calls` are those of finished code, which is read-only, shared and never
// freed.
unsafe impl<Q: Query, T: Real> Send for Threaded<Q, T> {}
// SAFETY: as above. Evaluation writes only to the output and to the frame of its thread.
unsafe impl<Q: Query, T: Real> Sync for Threaded<Q, T> {}

/// Offsets of values in a frame. They are given out from the last step to the first: a value needs
/// a place from its last use back to its own step.
#[derive(Default)]
struct Slots {
    /// Per step, the offset of its value; the largest number if no later step uses it.
    of: Vec<u32>,
    /// Free offsets, by number of vectors.
    free: Vec<Vec<u32>>,
    end: usize,
    width: usize,
}

impl Slots {
    const NONE: u32 = u32::MAX;

    /// Begins a frame for this many steps, after `end` bytes that are not given out.
    fn start(&mut self, steps: usize, end: usize, width: usize) {
        self.of.clear();
        self.of.resize(steps, Self::NONE);
        self.free.iter_mut().for_each(Vec::clear);
        (self.end, self.width) = (end, width);
    }

    /// Returns the offset of a step's value, which has this many vectors.
    #[inline]
    fn place(&mut self, position: usize, parts: u32) -> u32 {
        if self.of[position] == Self::NONE {
            let free = self.free.get_mut(parts as usize).and_then(Vec::pop);
            self.of[position] = free.unwrap_or_else(|| {
                let at = self.end as u32;
                self.end += parts as usize * self.width;
                at
            });
        }
        self.of[position]
    }

    /// Makes the place of a step's value free for earlier steps.
    #[inline]
    fn give(&mut self, position: usize, parts: u32) {
        let parts = parts as usize;
        if self.free.len() <= parts {
            self.free.resize(parts + 1, Vec::new());
        }
        self.free[parts].push(self.of[position]);
    }
}

impl<Q: Query, T: Real> Threaded<Q, T> {
    /// Lays out the calls for all steps of a tape.
    ///
    /// # Errors
    /// As for [`StencilTape::new`], and if the calls need a frame of more than 4 GiB.
    ///
    /// # Panics
    /// As for [`StencilTape::new`].
    pub fn new(tape: Tape<T>, binding: &Binding<T>) -> Result<Self, Error> {
        let tape = Arc::new(tape.coarse());
        let clauses = Clauses::none(tape.steps().len());
        let stencils = StencilTape::new(&tape, binding, &clauses)?;
        Self::selected(&Arc::new(stencils), &Selection::all(&tape))
    }

    /// Lays out the calls for all clauses and steps of a tape that was examined, with vectors of
    /// `width` bytes, to compare with processors that have no wider ones.
    ///
    /// # Errors
    /// As for [`Threaded::new`].
    ///
    /// # Panics
    /// As for [`Threaded::new`].
    pub fn narrow(
        tape: &Arc<Tape<T>>,
        binding: &Binding<T>,
        shortener: &Shortener,
        width: usize,
    ) -> Result<Self, Error> {
        let stencils = StencilTape::of_width(tape, binding, shortener.clauses(), width)?;
        Self::selected(&Arc::new(stencils), &shortener.all(tape))
    }

    /// Lays out the calls for some steps of a tape.
    ///
    /// # Errors
    /// If the calls need a frame of more than 4 GiB.
    ///
    /// # Panics
    /// If the selection is from another tape.
    pub fn selected(tape: &Arc<StencilTape<Q, T>>, selection: &Selection) -> Result<Self, Error> {
        Self::lay_out(tape, selection, &[])
    }

    /// Like [`Threaded::selected`], but also traces the bounds of deciding steps.
    ///
    /// # Errors
    /// As for [`Threaded::selected`].
    ///
    /// # Panics
    /// If the selection is from another tape, or if there are deciding steps and the query has no
    /// proven bounds.
    pub fn traced(
        tape: &Arc<StencilTape<Q, T>>,
        selection: &Selection,
        deciding: &DecidingSteps,
    ) -> Result<Self, Error> {
        Self::lay_out(tape, selection, deciding.positions())
    }

    fn lay_out(
        tape: &Arc<StencilTape<Q, T>>,
        selection: &Selection,
        traced: &[u32],
    ) -> Result<Self, Error> {
        let mut layout = LAYOUT.take();
        let laid_out = Self::lay_out_in(&mut layout, tape, selection, traced);
        if layout.values.capacity() <= LAYOUT_STEPS {
            LAYOUT.set(layout);
        }
        laid_out
    }

    fn lay_out_in(
        layout: &mut Layout,
        tape: &Arc<StencilTape<Q, T>>,
        selection: &Selection,
        traced: &[u32],
    ) -> Result<Self, Error> {
        let mut finder = StencilFinder::<Q, T>::new(tape.width);
        let Layout { values, slots } = layout;
        find_values(values, tape, selection, &mut finder)?;
        let inside = tape.coordinates + traced.len() * size_of::<StepBounds<T>>();
        slots.start(values.len(), inside + tape.inside, tape.width);
        let place = |slots: &mut Slots, operand: SelectedOperand| match operand.position() {
            Some(position) => slots.place(position, values[position].parts),
            None => tape.steps[operand.origin()].at,
        };
        let number = |operand: SelectedOperand| match operand.position() {
            Some(position) => values[position].number,
            None => tape.steps[operand.origin()].value.number,
        };
        for position in selection.coordinates() {
            let axis = tape.axis(&selection.steps()[position]);
            let offset = coordinate_offset(axis, values[position].parts, tape.width);
            slots.of[position] = offset;
        }
        // From the last call to the first.
        let mut calls = Vec::with_capacity(values.len() + traced.len() + 1);
        let outputs: SmallVec<[_; 4]> = selection.outputs().iter().map(|&at| number(at)).collect();
        let range = finder.operand(outputs[0]).range;
        let result = StencilStep::Result(&outputs, T::is_finite(range));
        let mut call = StencilCall::new(finder.find(&result)?.code.entry(), 0);
        for (at, &output) in call.operands().zip(selection.outputs()) {
            *at = place(slots, output);
        }
        calls.push(call);
        // Most values have the same number.
        let mut tracer = (OperandNumber::MAX, std::ptr::null());
        let mut to_trace = traced.iter().enumerate().rev().peekable();
        for (position, (step, value)) in selection.steps().iter().zip(&*values).enumerate().rev() {
            let at = slots.place(position, value.parts);
            if let Some((k, _)) = to_trace.next_if(|(_, traced)| **traced as usize == position) {
                if tracer.0 != value.number {
                    let stencil = finder.find(&StencilStep::Trace(value.number))?;
                    tracer = (value.number, stencil.code.entry());
                }
                let to = tape.coordinates + k * size_of::<StepBounds<T>>();
                let mut call = StencilCall::new(tracer.1, to as u32);
                call.operands().take(1).for_each(|operand| *operand = at);
                calls.push(call);
            }
            let clause = step.origin().map_or(ClauseCall::None, |origin| tape.steps[origin].clause);
            let places = step.operands().iter().map(|&operand| place(slots, operand));
            if let ClauseCall::Steps(number) = clause {
                let mut used = [0; 3];
                used.iter_mut().zip(places).for_each(|(at, place)| *at = place);
                tape.clauses[number as usize].append(&mut calls, [inside as u32, at], &used);
            } else {
                let mut call = StencilCall::new(value.entry, at);
                if let ClauseCall::Shared { table, .. } = clause {
                    call.places[TABLE] = table;
                    call.places[USED..].iter_mut().zip(places).for_each(|(at, place)| *at = place);
                } else {
                    call.operands().zip(places).for_each(|(at, place)| *at = place);
                }
                calls.push(call);
            }
            // A stencil may store one vector of its value before it has loaded the last of its
            // operands. So its place is free for earlier steps only now.
            slots.give(position, value.parts);
        }
        if slots.end > u32::MAX as usize {
            return Err(TOO_LARGE);
        }
        calls.reverse();
        let frame = slots.end.div_ceil(ALIGNMENT);
        Ok(Self { tape: Arc::clone(tape), calls, frame, traced: traced.len() })
    }

    /// Evaluates the lanes in use, then passes the result and the frame on.
    fn run<R>(
        &self,
        input: &Q::Input<T>,
        output: &mut Q::Output<T>,
        then: impl FnOnce(&Q::Output<T>, &[Block]) -> R,
    ) -> R {
        Q::check_input(&self.tape.tape, input);
        let call_loop = call_loop().expect("it was compiled with the tape");
        (0..Q::Output::<T>::MASKS).for_each(|number| *output.mask_mut(number) = 0);
        FRAME.with_borrow_mut(|frame| {
            if frame.len() < self.frame {
                frame.resize(self.frame, Block([0; ALIGNMENT]));
            }
            let calls = self.calls.as_ptr_range();
            let run = Run {
                first: calls.start,
                end: calls.end,
                frame: frame.as_mut_ptr().cast(),
                constants: self.tape.constants.as_ptr().cast(),
                input: (&raw const *input).cast(),
                width: self.tape.width,
                lanes: self.tape.width / size_of::<T>(),
            };
            // SAFETY: the loop calls the stencils of this tape, which were compiled for its query,
            // format and width. There is at least one call, that of the result. Stencils read
            // operands that earlier calls have stored in the frame, which is large enough for all
            // of them, or constants. They access batches as kernels do. Stencils do not unwind,
            // and their code is never freed.
            unsafe {
                call_rounding_up(
                    call_loop.entry(),
                    (&raw const run).cast(),
                    (&raw mut *output).cast(),
                    input.count(),
                    std::ptr::null(),
                );
            }
            then(output, frame)
        })
    }

    /// Evaluates the lanes in use, then passes the result and the trace on.
    pub fn eval_traced<R>(
        &self,
        input: &Q::Input<T>,
        output: &mut Q::Output<T>,
        then: impl FnOnce(&Q::Output<T>, &[StepBounds<T>]) -> R,
    ) -> R {
        self.run(input, output, |output, frame| {
            let trace = &frame[self.tape.coordinates / ALIGNMENT..];
            // SAFETY: the trace follows the coordinates, and the calls have written it: all lanes
            // of the vectors in use. The rest was initialized when the frame was created. Blocks
            // have the alignment of lanes.
            let trace = unsafe {
                std::slice::from_raw_parts(trace.as_ptr().cast::<StepBounds<T>>(), self.traced)
            };
            then(output, trace)
        })
    }
}

impl<Q: Query, T: Real> fmt::Debug for Threaded<Q, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} calls of stencils for {}", self.calls.len(), Q::NAME)
    }
}

impl<Q: Query, T: Real> Kernel<Q, T> for Threaded<Q, T> {
    fn eval(&self, input: &Q::Input<T>, output: &mut Q::Output<T>) {
        self.run(input, output, |_, _| ());
    }
}

/// Finds the value of each selected step.
fn find_values<Q: Query, T: Real>(
    values: &mut Vec<StepValue>,
    tape: &StencilTape<Q, T>,
    selection: &Selection,
    finder: &mut StencilFinder<Q, T>,
) -> Result<(), Error> {
    values.clear();
    for step in selection.steps() {
        if let Some(origin) = step.origin().filter(|_| !step.is_changed()) {
            values.push(tape.steps[origin].value);
            continue;
        }
        let number = |operand: &SelectedOperand| {
            if let Some(position) = operand.position() {
                return values[position].number;
            }
            let constant = &tape.steps[operand.origin()];
            let is_exponent = tape.exponent(step) == Some(operand.origin());
            if is_exponent { constant.exponent } else { constant.value.number }
        };
        let operands: SmallVec<[_; 3]> = step.operands().iter().map(number).collect();
        let own = step.origin().map(|origin| &tape.steps[origin]);
        if let Some(own) = own.filter(|own| own.used[..operands.len()] == operands[..]) {
            values.push(own.value);
            continue;
        }
        let changed = match own.map_or(ClauseCall::None, |own| own.clause) {
            ClauseCall::Shared { code, .. } => {
                StencilStep::Clause(tape.codes[code as usize].number, &operands)
            }
            // Nothing replaces the steps that other clauses use.
            ClauseCall::Steps(_) => unreachable!("a clause that is as in the tape"),
            ClauseCall::None => StencilStep::Apply(tape.operation(step), &operands),
        };
        let (stencil, number) = finder.find_valued(&changed)?;
        let parts = parts::<Q>(&stencil.shape.expect("a step has a value")) as u32;
        values.push(StepValue { entry: stencil.code.entry(), number, parts });
    }
    Ok(())
}

/// Copies bytes to aligned memory.
fn blocks(bytes: &[u8]) -> Vec<Block> {
    let copy = |chunk: &[u8]| {
        let mut block = Block([0; ALIGNMENT]);
        block.0[..chunk.len()].copy_from_slice(chunk);
        block
    };
    bytes.chunks(ALIGNMENT).map(copy).collect()
}
