//! Kernels without compilation: a tape is run by calling its stencils one after another.

use crate::compiler::vector_widths;
use crate::error::Error;
use crate::rounding::call_rounding_up;
use crate::stencil::{
    OperandNumber, Shape, Stencil, StencilFinder, StencilOperand, StencilStep, parts,
};
use crate::stencil_code::{Run, StencilCall, call_loop};
use smallvec::SmallVec;
use std::cell::RefCell;
use std::fmt;
use std::marker::PhantomData;
use std::sync::Arc;
use zeroset_eval::{
    Binding, Input, Kernel, Lanes, Loader, Output, Query, Real, Selection, Step, StepBounds, Tape,
    ValueKind,
};
use zeroset_interval::{Exponent, Interval, Software, Vector128};
use zeroset_ops::Op;

/// Bytes to which vectors are aligned, whatever their width.
const ALIGNMENT: usize = 64;

/// Number of [`Lanes`] in the trace of a step: −lo, hi, and a mask.
const TRACE_LANES: usize = 3;

/// Offsets have 32 bits.
const TOO_LARGE: Error = Error::Unsupported("frames of more than 4 GiB");

/// Memory for vectors.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
struct Block([u8; ALIGNMENT]);

thread_local! {
    /// The frame of a thread, which all its tapes use in turn.
    static FRAME: RefCell<Vec<Block>> = const { RefCell::new(Vec::new()) };
}

/// A tape as calls of stencils, with its parameters bound. It answers a query like
/// [`Native`](crate::Native), for formulas of any size, and takes microseconds to create once its
/// stencils exist.
///
/// Results have the bits of the reference evaluator for the [coarse](Tape::coarse) tape.
pub struct Threaded<Q: Query, T: Real = f32> {
    tape: Arc<Tape<T>>,
    calls: Vec<StencilCall>,
    constants: Arc<TapeConstants<Q, T>>,
    /// Size of the frame in blocks.
    frame: usize,
    width: usize,
    /// Number of steps whose bounds are traced. The trace is the first part of the frame.
    traced: usize,
    query: PhantomData<Q>,
}

// SAFETY: the addresses in `calls` are those of finished code, which is read-only, shared and never
// freed.
unsafe impl<Q: Query, T: Real> Send for Threaded<Q, T> {}
// SAFETY: as above. Evaluation writes only to the output and to the frame of its thread.
unsafe impl<Q: Query, T: Real> Sync for Threaded<Q, T> {}

/// Bounds of some steps of a tape, per lane.
pub struct Trace<'a, T: Real> {
    /// For each step: −lo, hi, and a mask of the lanes in which the value is defined throughout.
    lanes: &'a [Lanes<T>],
}

impl<T: Real> Trace<'_, T> {
    /// Returns the bounds of the steps in one lane, in order.
    pub fn lane(&self, lane: usize) -> Vec<StepBounds> {
        let bounds = |[neg_lo, hi, defined]: &[Lanes<T>; TRACE_LANES]| StepBounds {
            values: Interval { lo: -neg_lo[lane].into(), hi: hi[lane].into() },
            // The lanes of a mask have all bits or none.
            is_defined: !(defined[lane].into() == 0.0),
        };
        let (each, _) = self.lanes.as_chunks();
        each.iter().map(bounds).collect()
    }
}

/// Where the value of a step is.
#[derive(Clone, Copy)]
struct ValuePlace<Q: Query> {
    shape: Shape<Q>,
    is_constant: bool,
    /// Offset in bytes.
    at: u32,
}

/// Offsets in a frame. Those that are free again are used first.
#[derive(Default)]
struct Slots {
    /// Free offsets, by number of vectors.
    free: Vec<Vec<u32>>,
    end: usize,
}

impl Slots {
    fn take(&mut self, parts: usize, width: usize) -> u32 {
        if let Some(at) = self.free.get_mut(parts).and_then(Vec::pop) {
            return at;
        }
        let at = self.end as u32;
        self.end += parts * width;
        at
    }

    fn give(&mut self, at: u32, parts: usize) {
        if self.free.len() <= parts {
            self.free.resize(parts + 1, Vec::new());
        }
        self.free[parts].push(at);
    }
}

/// Constants and parameters of a tape, computed in software and repeated in all lanes. Tapes of
/// [selected](Selection) steps share those of the whole tape.
pub struct TapeConstants<Q: Query, T: Real = f32> {
    blocks: Vec<Block>,
    /// Per step of the whole tape, the place of its value if it is a constant or a parameter. Then
    /// its number as an operand, and as an exponent.
    places: Vec<Option<(ValuePlace<Q>, [OperandNumber; 2])>>,
    width: usize,
    format: PhantomData<T>,
}

impl<Q: Query, T: Real> TapeConstants<Q, T> {
    /// Computes the constants of a [coarse](Tape::coarse) tape with bound parameters.
    ///
    /// # Errors
    /// If the processor is not supported, or the constants need more than 4 GiB.
    pub fn new(tape: &Tape<T>, binding: &Binding<T>) -> Result<Self, Error> {
        let width = vector_widths().next().ok_or(Error::Unsupported("vectors"))?;
        Self::of_width(tape, binding, width)
    }

    fn of_width(tape: &Tape<T>, binding: &Binding<T>, width: usize) -> Result<Self, Error> {
        let mut finder = StencilFinder::<Q, T>::new(width);
        let (mut bytes, mut places) = (Vec::new(), Vec::with_capacity(tape.steps().len()));
        for (index, step) in tape.steps().iter().enumerate() {
            let m = &mut Software::new();
            let value = match step {
                Step::Parameter(number) => {
                    let mut loader = Parameters(binding);
                    Q::Kind::parameter::<T, _>(m, &mut loader, *number as usize)
                }
                Step::Constant(bounds, _) => Q::Kind::constant::<T, _>(m, *bounds),
                Step::Coordinate(_) | Step::Apply(..) => {
                    places.push(None);
                    continue;
                }
            };
            let at = u32::try_from(bytes.len()).map_err(|_| TOO_LARGE)?;
            let value = Q::Kind::settled::<T, _>(m, value);
            let shape = Q::Kind::map(&value, &mut |vector: Vector128| {
                let lane = match vector {
                    Vector128::F32([lane, ..]) => u64::from(lane) << 32 | u64::from(lane),
                    Vector128::F64([lane, _]) => lane,
                };
                let lanes = [lane.to_ne_bytes(); ALIGNMENT / 8];
                bytes.extend_from_slice(&lanes.as_flattened()[..width]);
            });
            let place = ValuePlace { shape, is_constant: true, at };
            let operand = place.operand(tape, index);
            let exponent = StencilOperand { exponent: step.exponent(), ..operand };
            let numbers = [operand, exponent].map(|operand| finder.number(&operand));
            places.push(Some((place, numbers)));
        }
        Ok(Self { blocks: blocks(&bytes), places, width, format: PhantomData })
    }
}

impl<Q: Query> ValuePlace<Q> {
    /// The value of this step as an operand.
    fn operand<T: Real>(&self, tape: &Tape<T>, index: usize) -> StencilOperand<Q> {
        StencilOperand {
            shape: self.shape,
            range: tape.range(index),
            // Only powers distinguish exponents.
            exponent: Exponent::Real,
            is_constant: self.is_constant,
        }
    }
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

impl<Q: Query, T: Real> Threaded<Q, T> {
    /// Lays out the calls for `tape`, and compiles the stencils that this process has not needed
    /// before.
    ///
    /// # Errors
    /// If the processor is not supported, or the tape needs more than 4 GiB.
    ///
    /// # Panics
    /// If the tape computes another number of expressions than the query needs, or if its number
    /// of parameters is not that of the binding. In debug builds also if a value is outside its
    /// range.
    pub fn new(tape: Tape<T>, binding: &Binding<T>) -> Result<Self, Error> {
        Self::traced(tape, binding, &[])
    }

    /// Like [`Threaded::new`], but also traces the bounds of some steps, which are in order.
    ///
    /// # Errors
    /// As for [`Threaded::new`].
    ///
    /// # Panics
    /// As for [`Threaded::new`], and if the query has no proven bounds.
    pub fn traced(tape: Tape<T>, binding: &Binding<T>, steps: &[usize]) -> Result<Self, Error> {
        Q::check(&tape, binding);
        let tape = Arc::new(tape.coarse());
        let mut result = Err(Error::Unsupported("vectors"));
        for width in vector_widths() {
            let constants = Arc::new(TapeConstants::of_width(&tape, binding, width)?);
            result = Self::with_constants(&tape, &constants, None, steps);
            if result.is_ok() {
                break;
            }
        }
        result
    }

    /// Lays out the calls for a tape, with the constants of the tape from which its steps were
    /// selected; `None` stands for all steps. Also traces the bounds of some steps, which are in
    /// order.
    ///
    /// # Errors
    /// As for [`Threaded::new`].
    ///
    /// # Panics
    /// If `tape` is not that of the selection, and as for [`Threaded::traced`].
    pub fn selected(
        tape: Tape<T>,
        selection: Option<&Selection>,
        constants: &Arc<TapeConstants<Q, T>>,
        traced: &[usize],
    ) -> Result<Self, Error> {
        assert_eq!(tape.outputs(), Q::OUTPUTS, "expressions that answer for {}", Q::NAME);
        Self::with_constants(&Arc::new(tape.coarse()), constants, selection, traced)
    }

    /// Like [`Threaded::new`], but with vectors of `width` bytes, to compare with processors that
    /// have no wider ones.
    ///
    /// # Errors
    /// As for [`Threaded::new`].
    ///
    /// # Panics
    /// As for [`Threaded::new`].
    #[cfg(feature = "comparison")]
    pub fn narrow(tape: Tape<T>, binding: &Binding<T>, width: usize) -> Result<Self, Error> {
        Q::check(&tape, binding);
        let tape = Arc::new(tape.coarse());
        let constants = Arc::new(TapeConstants::of_width(&tape, binding, width)?);
        Self::with_constants(&tape, &constants, None, &[])
    }

    fn with_constants(
        tape: &Arc<Tape<T>>,
        constants: &Arc<TapeConstants<Q, T>>,
        selection: Option<&Selection>,
        traced: &[usize],
    ) -> Result<Self, Error> {
        let width = constants.width;
        call_loop()?;
        let mut finder = StencilFinder::<Q, T>::new(width);
        let last_use = last_uses(tape);
        let trace = traced.len() * TRACE_LANES * size_of::<Lanes<T>>();
        let mut slots = Slots { end: trace, ..Slots::default() };
        let mut places: Vec<ValuePlace<Q>> = Vec::with_capacity(tape.steps().len());
        let mut kernel = Self {
            tape: Arc::clone(tape),
            calls: Vec::with_capacity(tape.steps().len() + traced.len() + 1),
            constants: Arc::clone(constants),
            frame: 0,
            width,
            traced: 0,
            query: PhantomData,
        };
        let mut numbers: Vec<[OperandNumber; 2]> = Vec::with_capacity(tape.steps().len());
        let mut operands: Vec<OperandNumber> = Vec::new();
        for (index, step) in tape.steps().iter().enumerate() {
            let place = match step {
                Step::Parameter(_) | Step::Constant(..) => {
                    let origin = selection.map_or(index, |selection| selection.origin(index));
                    let (place, number) = constants.places[origin].expect("a constant");
                    numbers.push(number);
                    places.push(place);
                    continue;
                }
                Step::Coordinate(axis) => {
                    let stencil = finder.find(&StencilStep::Coordinate(*axis))?;
                    kernel.add_step(stencil, &mut slots, &[])
                }
                Step::Apply(op, used) => {
                    operands.clear();
                    let is_power = usize::from(*op == Op::Pow);
                    operands.extend(used.iter().map(|&used| numbers[used][is_power]));
                    let stencil = finder.find(&StencilStep::Apply(*op, &operands))?;
                    let at: SmallVec<[u32; 3]> = used.iter().map(|&used| places[used].at).collect();
                    let place = kernel.add_step(stencil, &mut slots, &at);
                    // Operands stay until the value is stored: a stencil may store one vector of
                    // its value before it has loaded the last of its operands.
                    for (k, &step) in used.iter().enumerate() {
                        let is_first = !used[..k].contains(&step);
                        if is_first && last_use[step] == index && !places[step].is_constant {
                            slots.give(places[step].at, parts::<Q>(&places[step].shape));
                        }
                    }
                    place
                }
            };
            numbers.push([finder.number(&place.operand(tape, index)); 2]);
            places.push(place);
            if traced.get(kernel.traced) == Some(&index) {
                let stencil = finder.find(&StencilStep::Trace(numbers[index][0]))?;
                let at = (kernel.traced * TRACE_LANES * size_of::<Lanes<T>>()) as u32;
                kernel.traced += 1;
                kernel.add_call(stencil, at, &[places[index].at]);
            }
        }
        let outputs = tape.outputs_at();
        operands.clear();
        operands.extend(outputs.iter().map(|&output| numbers[output][0]));
        let result = finder.find(&StencilStep::Result(&operands, tape.is_bounded()))?;
        let at: Vec<u32> = outputs.iter().map(|&output| places[output].at).collect();
        kernel.add_call(result, 0, &at);
        kernel.frame = slots.end.div_ceil(ALIGNMENT);
        if slots.end > u32::MAX as usize {
            return Err(TOO_LARGE);
        }
        Ok(kernel)
    }

    /// Adds the call for a step. Returns the place of the step's value.
    fn add_step(
        &mut self,
        stencil: &Stencil<Q>,
        slots: &mut Slots,
        operands: &[u32],
    ) -> ValuePlace<Q> {
        let shape = stencil.shape.expect("a step has a value");
        let at = slots.take(parts::<Q>(&shape), self.width);
        self.add_call(stencil, at, operands);
        ValuePlace { shape, is_constant: false, at }
    }

    fn add_call(&mut self, stencil: &Stencil<Q>, at: u32, operands: &[u32]) {
        let mut call = StencilCall { entry: stencil.code.entry(), places: Default::default() };
        call.places[0] = at;
        call.places[1..=operands.len()].copy_from_slice(operands);
        self.calls.push(call);
    }

    /// Evaluates the lanes in use, then passes the result and the frame on.
    fn run<R>(
        &self,
        input: &Q::Input<T>,
        output: &mut Q::Output<T>,
        then: impl FnOnce(&Q::Output<T>, &[Block]) -> R,
    ) -> R {
        Q::check_input(&self.tape, input);
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
                constants: self.constants.blocks.as_ptr().cast(),
                input: (&raw const *input).cast(),
                width: self.width,
                lanes: self.width / size_of::<T>(),
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
        then: impl FnOnce(&Q::Output<T>, &Trace<'_, T>) -> R,
    ) -> R {
        self.run(input, output, |output, frame| {
            // SAFETY: the frame begins with the trace, which the calls have written: all lanes of
            // the vectors in use. The rest was initialized when the frame was created.
            let lanes = unsafe {
                std::slice::from_raw_parts(
                    frame.as_ptr().cast::<Lanes<T>>(),
                    TRACE_LANES * self.traced,
                )
            };
            then(output, &Trace { lanes })
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

/// Per step of a tape, the last step that uses its value; the largest number for outputs.
fn last_uses<T: Real>(tape: &Tape<T>) -> Vec<usize> {
    let mut last = vec![0; tape.steps().len()];
    for (index, step) in tape.steps().iter().enumerate() {
        if let Step::Apply(_, operands) = step {
            operands.iter().for_each(|&operand| last[operand] = index);
        }
    }
    tape.outputs_at().iter().for_each(|&output| last[output] = usize::MAX);
    last
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
