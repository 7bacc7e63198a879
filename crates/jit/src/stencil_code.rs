//! The code around the steps of a tape: what a stencil gets, and the loop that calls stencils.

use crate::code::Code;
use crate::compiler::{
    BatchPointers, KERNEL_ARGUMENTS, StackProbe, Tier, args, generate_at, machine_code, offset,
    place, signature, store_result, trusted, write_function,
};
use crate::error::Error;
use crate::lanes::{Emitter, LaneVector, VECTOR, type_of};
use cranelift_codegen::ir::condcodes::IntCC;
use cranelift_codegen::ir::types::{I32, I64};
use cranelift_codegen::ir::{InstBuilder, Value};
use cranelift_frontend::FunctionBuilder;
use std::marker::PhantomData;
use std::mem::offset_of;
use std::sync::OnceLock;
use zeroset_eval::{Batch, Output, Query, QueryResult, Real};
use zeroset_interval::Enclosure;

/// Largest number of operands of a call: a result may need a function and its derivatives, and a
/// clause its table of constants and three steps.
const OPERANDS: usize = 4;
/// Number of arguments of a stencil.
const STENCIL_ARGUMENTS: usize = 6;

/// A call of a stencil.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct StencilCall {
    /// First instruction of the stencil.
    pub entry: *const u8,
    /// Offsets in bytes: of the step's value in the frame, then of its operands in the frame or
    /// among the constants.
    pub places: [u32; 1 + OPERANDS],
}

impl StencilCall {
    /// A call that stores its value at this offset. Its operands have no places yet.
    pub fn new(entry: *const u8, at: u32) -> Self {
        let mut places = [0; 1 + OPERANDS];
        places[0] = at;
        Self { entry, places }
    }

    /// The places of the operands.
    pub fn operands(&mut self) -> impl Iterator<Item = &mut u32> {
        self.places[1..].iter_mut()
    }
}

/// The memory that the calls of a tape work on.
#[repr(C)]
pub struct Run {
    /// The first call.
    pub first: *const StencilCall,
    /// The end of the last call.
    pub end: *const StencilCall,
    /// Memory for values of one vector of lanes.
    pub frame: *mut u8,
    /// Values of constants and parameters.
    pub constants: *const u8,
    /// The input batch.
    pub input: *const u8,
    /// Bytes of a vector.
    pub width: usize,
    /// Lanes of a vector.
    pub lanes: usize,
}

/// The pointers that a stencil gets as arguments.
pub struct StencilPointers<T> {
    /// The frame and the constants.
    pub frame: StencilFrame<T>,
    /// The next lanes of the input batch.
    pub input: BatchPointers<T>,
    /// The next lanes of the output batch.
    pub output: OutputPointer<T>,
    /// Number of the first lane.
    pub lane: Value,
}

/// The memory in which a stencil finds operands.
pub struct StencilFrame<T> {
    values: Value,
    constants: Value,
    places: Value,
    width: usize,
    format: PhantomData<T>,
}

impl<T: Real> StencilFrame<T> {
    /// Returns the address of the coordinates: of the first, followed by the others.
    pub fn start(&self) -> Value {
        self.values
    }

    /// Returns the address of an operand, or of the step's value if `number` is 0.
    pub fn address(&self, m: &mut Emitter<'_, '_>, number: usize, is_constant: bool) -> Value {
        let base = if is_constant { self.constants } else { self.values };
        let place = m.builder().ins().load(I32, trusted(), self.places, 4 * number as i32);
        let place = m.builder().ins().uextend(I64, place);
        m.builder().ins().iadd(base, place)
    }

    /// Loads a vector of the value at `base`.
    pub fn load(&self, m: &mut Emitter<'_, '_>, base: Value, part: usize) -> LaneVector {
        let at = (self.width * part) as i32;
        LaneVector::Value(m.builder().ins().load(type_of(T::FORMAT), trusted(), base, at))
    }

    /// Stores bounds in the lanes of a batch, the first of which is `lane`: −lo, hi, and a mask of
    /// the lanes in which the value is defined throughout.
    pub fn trace(&self, m: &mut Emitter<'_, '_>, lane: Value, bounds: &Enclosure<LaneVector>) {
        let base = self.address(m, 0, false);
        let before = m.builder().ins().ishl_imm_u(lane, i64::from(size_of::<T>().trailing_zeros()));
        let base = m.builder().ins().iadd(base, before);
        let defined = bounds.facts.defined.mask(m, T::FORMAT);
        for (number, vector) in [bounds.neg_lo, bounds.hi, defined].into_iter().enumerate() {
            let value = m.value(vector);
            m.builder().ins().store(trusted(), value, base, offset::<T>(number));
        }
    }

    /// Stores a vector of the value at `base`.
    pub fn store(&self, m: &mut Emitter<'_, '_>, base: Value, part: usize, vector: LaneVector) {
        let value = m.value(vector);
        m.builder().ins().store(trusted(), value, base, (self.width * part) as i32);
    }
}

/// The next lanes of the output batch.
pub struct OutputPointer<T> {
    lanes: Value,
    format: PhantomData<T>,
}

impl<T: Real> OutputPointer<T> {
    /// Stores a result, whose first lane has this number. Masks are added to those in memory.
    pub fn store<Q: Query>(
        &self,
        m: &mut Emitter<'_, '_>,
        result: QueryResult<LaneVector>,
        lane: Value,
    ) {
        let (known, found) = store_result::<T>(m, result, self.lanes);
        if <Q::Output<T>>::MASKS == 0 {
            return;
        }
        let builder = m.builder();
        let before = builder.ins().ishl_imm_u(lane, i64::from(size_of::<T>().trailing_zeros()));
        let batch = builder.ins().isub(self.lanes, before);
        let at = offset::<T>(<Q::Output<T>>::QUANTITIES);
        let mut masks = builder.ins().load(I64, trusted(), batch, at);
        if known != 0 {
            let known = builder.ins().iconst(I64, known as i64);
            masks = builder.ins().bor(masks, known);
        }
        if let Some(found) = found {
            let found = builder.ins().ishl(found, lane);
            masks = builder.ins().bor(masks, found);
        }
        builder.ins().store(trusted(), masks, batch, at);
    }
}

/// Compiles a stencil for vectors of `width` bytes. `write` emits its code.
///
/// # Errors
/// If the code cannot use such vectors.
pub fn compile_stencil<T: Real>(
    width: usize,
    write: impl FnOnce(&mut Emitter<'_, '_>, &mut StencilPointers<T>),
) -> Result<Code, Error> {
    let function = write_function(|builder, arguments: [Value; STENCIL_ARGUMENTS]| {
        let [values, places, input, constants, output, lane] = arguments;
        let mut pointers = StencilPointers {
            frame: StencilFrame { values, constants, places, width, format: PhantomData },
            input: BatchPointers::new(input, constants),
            output: OutputPointer { lanes: output, format: PhantomData },
            lane,
        };
        write(&mut Emitter::new(builder, width), &mut pointers);
    })?;
    generate_at(function, width)
}

/// Returns the loop that calls stencils: for each vector of lanes, all of them in order.
///
/// It is a kernel whose input is a [`Run`].
///
/// # Errors
/// If code generation fails.
pub fn call_loop() -> Result<&'static Code, Error> {
    static LOOP: OnceLock<Code> = OnceLock::new();
    if let Some(code) = LOOP.get() {
        return Ok(code);
    }
    let function = write_function(write_loop)?;
    let code = machine_code(function, Some(Tier::Optimizing), StackProbe::Code)?;
    let code = place(code.buffer.data(), u64::from(code.buffer.alignment), VECTOR)?;
    Ok(LOOP.get_or_init(|| code))
}

/// Writes a loop over vectors of lanes. For each vector, it calls all stencils in order.
fn write_loop(
    builder: &mut FunctionBuilder<'_>,
    [run, outputs, count, ..]: [Value; KERNEL_ARGUMENTS],
) {
    let stencil = builder.import_signature(signature(STENCIL_ARGUMENTS));
    let mut field = |at: usize| builder.ins().load(I64, trusted(), run, at as i32);
    let first = field(offset_of!(Run, first));
    let end = field(offset_of!(Run, end));
    let frame = field(offset_of!(Run, frame));
    let constants = field(offset_of!(Run, constants));
    let inputs = field(offset_of!(Run, input));
    let width = field(offset_of!(Run, width));
    let lanes = field(offset_of!(Run, lanes));
    let [vectors, calls, next, done] = [(); 4].map(|()| builder.create_block());
    let [input, output, lane] = [(); 3].map(|()| builder.append_block_param(vectors, I64));
    let call = builder.append_block_param(calls, I64);
    let zero = builder.ins().iconst(I64, 0);
    builder.ins().jump(vectors, &args(&[inputs, outputs, zero]));

    builder.switch_to_block(vectors);
    builder.ins().jump(calls, &args(&[first]));

    builder.switch_to_block(calls);
    let at = offset_of!(StencilCall, entry) as i32;
    let code = builder.ins().load(I64, trusted(), call, at);
    let places = builder.ins().iadd_imm_s(call, offset_of!(StencilCall, places) as i64);
    builder.ins().call_indirect(stencil, code, &[frame, places, input, constants, output, lane]);
    let call = builder.ins().iadd_imm_s(call, size_of::<StencilCall>() as i64);
    let more = builder.ins().icmp(IntCC::NotEqual, call, end);
    builder.ins().brif(more, calls, &args(&[call]), next, &[]);

    builder.switch_to_block(next);
    let input = builder.ins().iadd(input, width);
    let output = builder.ins().iadd(output, width);
    let lane = builder.ins().iadd(lane, lanes);
    let more = builder.ins().icmp(IntCC::UnsignedLessThan, lane, count);
    builder.ins().brif(more, vectors, &args(&[input, output, lane]), done, &[]);

    builder.switch_to_block(done);
}
