//! From a tape to native code.

use crate::code::{Code, Memory};
use crate::count::Counter;
use crate::error::Error;
use crate::lanes::{Emitter, VECTOR, Vector, type_of};
use cranelift_codegen::control::ControlPlane;
use cranelift_codegen::ir::condcodes::IntCC;
use cranelift_codegen::ir::types::I64;
use cranelift_codegen::ir::{AbiParam, Function, InstBuilder, MemFlagsData, Signature, Value};
use cranelift_codegen::isa::{CallConv, OwnedTargetIsa};
use cranelift_codegen::settings::{self, Configurable};
use cranelift_codegen::{Context, ir::Block};
use cranelift_frontend::{FunctionBuilder, FunctionBuilderContext};
use cranelift_jit::{JITBuilder, JITModule};
use cranelift_module::{Module, default_libcall_names};
use std::mem::size_of;
use std::sync::OnceLock;
use zeroset_eval::{
    BoxPacket, EnclosurePacket, GradientPacket, PointPacket, Real, Tape, ValuePacket,
};
use zeroset_interval::{Enclosure, Fact, Facts, Format, Machine};

/// What a kernel computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Enclosures of one output over boxes.
    Interval,
    /// Values of one output at points.
    Point,
    /// Values of four outputs at points: a function and its derivatives.
    Gradient,
}

impl Kind {
    fn outputs(self) -> usize {
        match self {
            Self::Interval | Self::Point => 1,
            Self::Gradient => 4,
        }
    }

    /// Bytes of a packet that goes in, and of one that comes out.
    fn strides<T: Real>(self) -> [usize; 2] {
        match self {
            Self::Interval => [size_of::<BoxPacket<T>>(), size_of::<EnclosurePacket<T>>()],
            Self::Point => [size_of::<PointPacket<T>>(), size_of::<ValuePacket<T>>()],
            Self::Gradient => [size_of::<PointPacket<T>>(), size_of::<GradientPacket<T>>()],
        }
    }
}

/// Operations in one kernel, at most: beyond this even the fast tier takes too long.
const LIMIT: usize = 20_000;
/// Instructions in one kernel, at most: some operations are a hundred of them and more. So many become 2 MB of code.
const INSTRUCTIONS: usize = 200_000;
/// Bytes of stack that a kernel uses, at most: a quarter of what a thread has by default.
const STACK: u32 = 512 << 10;
/// Instructions from which on code is made fast rather than made to be fast: backtracking register allocation takes
/// about 1.2 µs an instruction, so that larger kernels would come near 2 ms. Its code then runs up to 1.2 times as long (up to
/// 1.7 times for polynomials, which have to be huge to get here).
const FAST_TIER_FROM: usize = 1_200;

/// How much work code generation spends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Tier {
    /// Backtracking register allocation.
    Optimised,
    /// One pass over the code.
    Fast,
}

/// The processor this runs on, as a code generation target: built once.
fn target(tier: Tier) -> Result<OwnedTargetIsa, Error> {
    static TARGETS: [OnceLock<Option<OwnedTargetIsa>>; 2] = [const { OnceLock::new() }; 2];
    TARGETS[tier as usize]
        .get_or_init(|| {
            let mut flags = settings::builder();
            let allocator = match tier {
                Tier::Optimised => "backtracking",
                Tier::Fast => "single_pass",
            };
            let verifier = if cfg!(debug_assertions) { "true" } else { "false" };
            for (name, value) in [
                // The graph has no common sub-expressions left, and the optimiser moves constants out of the loop and
                // then spills them: compiling takes 1.3 times as long for code that is 2 % slower over the gallery.
                ("opt_level", "none"),
                ("regalloc_algorithm", allocator),
                ("enable_verifier", verifier),
                ("unwind_info", "false"),
                ("is_pic", "false"),
                // Large frames must not reach past the guard page unseen.
                ("enable_probestack", "true"),
                ("probestack_strategy", "inline"),
            ] {
                flags.set(name, value).ok()?;
            }
            let isa = cranelift_native::builder().ok()?;
            isa.finish(settings::Flags::new(flags)).ok()
        })
        .clone()
        .ok_or(Error::Unsupported("a processor that the code generator knows"))
}

fn check_processor() -> Result<(), Error> {
    #[cfg(target_arch = "x86_64")]
    if !std::arch::is_x86_feature_detected!("sse4.1") {
        // Without it, rounding to integers would be a library call in the wrong rounding mode.
        return Err(Error::Unsupported("SSE4.1"));
    }
    if cfg!(any(target_arch = "x86_64", target_arch = "aarch64")) {
        Ok(())
    } else {
        Err(Error::Unsupported("x86-64 or AArch64"))
    }
}

/// Compiles `tape`.
///
/// # Panics
/// If the tape has another number of outputs than `kind` needs.
pub fn compile<T: Real>(tape: &Tape<T>, kind: Kind) -> Result<Code, Error> {
    check_processor()?;
    let (function, constants) = build(tape, kind)?;
    let tier = if function.dfg.num_insts() > FAST_TIER_FROM { Tier::Fast } else { Tier::Optimised };
    check_stack(function.fixed_stack_size())?;
    let isa = target(tier)?;
    let builder = JITBuilder::with_isa(isa, default_libcall_names());
    let mut memory = Memory::new(JITModule::new(builder));
    let module = memory.module();
    debug_assert!(module.target_config().pointer_bits() == 64, "kernels use 64-bit pointers");
    let report = |error: cranelift_module::ModuleError| Error::Codegen(format!("{error:?}"));
    let id = module.declare_anonymous_function(&function.signature).map_err(report)?;
    let mut context = Context::for_function(function);
    module.define_function(id, &mut context).map_err(report)?;
    let layout = context.compiled_code().and_then(|code| code.buffer.frame_layout());
    check_stack(layout.map_or(0, |layout| layout.frame_to_fp_offset))?;
    module.finalize_definitions().map_err(report)?;
    let bytes = context.compiled_code().map_or(0, |code| code.code_info().total_size);
    Ok(Code::new(memory, id, constants, bytes as usize))
}

fn check_stack(bytes: u32) -> Result<(), Error> {
    if bytes > STACK { Err(Error::TooDeep { bytes, limit: STACK }) } else { Ok(()) }
}

/// The intermediate code of a kernel, as text.
///
/// # Errors
/// If the formula is too large.
///
/// # Panics
/// If the tape has another number of outputs than `kind` needs.
pub fn intermediate_code<T: Real>(tape: &Tape<T>, kind: Kind) -> Result<String, Error> {
    Ok(build(tape, kind)?.0.display().to_string())
}

/// The machine code of a kernel, as assembly text.
///
/// # Errors
/// If this processor is not supported or the formula too large.
///
/// # Panics
/// If the tape has another number of outputs than `kind` needs.
pub fn machine_code<T: Real>(tape: &Tape<T>, kind: Kind) -> Result<String, Error> {
    check_processor()?;
    let mut context = Context::for_function(build(tape, kind)?.0);
    context.set_disasm(true);
    let code = context
        .compile(target(Tier::Optimised)?.as_ref(), &mut ControlPlane::default())
        .map_err(|error| Error::Codegen(format!("{error:?}")))?;
    Ok(code.vcode.clone().unwrap_or_default())
}

fn signature() -> Signature {
    let convention = if cfg!(target_vendor = "apple") {
        CallConv::AppleAarch64
    } else {
        // The asm trampoline passes arguments by this convention on every system.
        CallConv::SystemV
    };
    let mut signature = Signature::new(convention);
    signature.params.extend([AbiParam::new(I64); 6]);
    signature
}

/// Where a kernel finds its data in the current round of its loop: of packets of `f64`, each round takes one half.
struct Cursor {
    input: Value,
    output: Value,
    parameters: Value,
}

/// All pointers passed to a kernel are valid and aligned to a packet.
fn trusted() -> MemFlagsData {
    MemFlagsData::trusted()
}

/// The function, and the constants that its pool must hold.
fn build<T: Real>(tape: &Tape<T>, kind: Kind) -> Result<(Function, Vec<u128>), Error> {
    assert_eq!(tape.outputs(), kind.outputs(), "outputs of a {kind:?} kernel");
    if tape.operations() > LIMIT {
        return Err(Error::TooLarge { operations: tape.operations(), limit: LIMIT });
    }
    let instructions = length(tape, kind);
    if instructions > INSTRUCTIONS {
        return Err(Error::TooLong { instructions, limit: INSTRUCTIONS });
    }
    let mut function = Function::new();
    function.signature = signature();
    let mut context = FunctionBuilderContext::new();
    let mut builder = FunctionBuilder::new(&mut function, &mut context);
    let entry = builder.create_block();
    builder.append_block_params_for_function_params(entry);
    builder.switch_to_block(entry);
    let arguments: Vec<Value> = builder.block_params(entry).to_vec();
    let [inputs, outputs, count, parameters, constants, _guards] = arguments[..] else {
        unreachable!("the signature has six parameters");
    };
    let (body, end) = (builder.create_block(), builder.create_block());
    let carried: Vec<Value> = (0..3).map(|_| builder.append_block_param(body, I64)).collect();
    let left = match T::VECTORS {
        1 => count,
        vectors => builder.ins().imul_imm_s(count, vectors as i64),
    };
    builder.ins().brif(count, body, &args(&[inputs, outputs, left]), end, &[]);
    builder.switch_to_block(body);
    let cursor = Cursor { input: carried[0], output: carried[1], parameters };
    // The pool's address is read anew in each round, so that no load from it is moved out of the loop.
    let pool = builder.ins().load(I64, trusted(), constants, 0);
    let mut emitter = Emitter::new(&mut builder, pool);
    match kind {
        Kind::Interval => emit_enclosure(&mut emitter, tape, &cursor),
        Kind::Point | Kind::Gradient => emit_values(&mut emitter, tape, &cursor),
    }
    let pool = emitter.finish();
    close_loop(&mut builder, kind.strides::<T>(), T::VECTORS, &carried, body, end);
    builder.switch_to_block(end);
    builder.ins().return_(&[]);
    builder.seal_all_blocks();
    builder.finalize(target(Tier::Optimised)?.frontend_config());
    Ok((function, pool))
}

/// The number of instructions that a kernel will hold, about.
fn length<T: Real>(tape: &Tape<T>, kind: Kind) -> usize {
    let mut counter = Counter::default();
    match kind {
        Kind::Interval => {
            tape.enclose(&mut counter, |_, _| ((), ()), |_, _| ((), ()));
        }
        Kind::Point | Kind::Gradient => {
            tape.evaluate(&mut counter, |_, _| (), |_, _| ());
        }
    }
    counter.0
}

fn args(values: &[Value]) -> Vec<cranelift_codegen::ir::BlockArg> {
    values.iter().map(|&value| value.into()).collect()
}

/// Steps to the next vectors of a packet, or from its last to the next packet, or ends.
fn close_loop(
    builder: &mut FunctionBuilder<'_>,
    strides: [usize; 2],
    vectors: usize,
    carried: &[Value],
    body: Block,
    end: Block,
) {
    let left = builder.ins().iadd_imm_s(carried[2], -1);
    let [input, output] = [0, 1].map(|which| {
        let (at, stride) = (carried[which], strides[which]);
        if vectors == 1 {
            return builder.ins().iadd_imm_s(at, stride as i64);
        }
        // Two vectors to a packet: an even number of rounds is left before the first of them, and an odd one is after
        // it. Those of one quantity lie side by side, so `left` is odd where the second is next.
        let second = builder.ins().band_imm_u(left, 1);
        let back = builder.ins().imul_imm_s(second, 2 * VECTOR as i64 - stride as i64);
        let at = builder.ins().iadd_imm_s(at, stride as i64 - VECTOR as i64);
        builder.ins().iadd(at, back)
    });
    let more = builder.ins().icmp_imm_s(IntCC::NotEqual, left, 0);
    builder.ins().brif(more, body, &args(&[input, output, left]), end, &[]);
}

/// Loads the vector with this index from an array of vectors.
fn load<T: Real>(m: &mut Emitter<'_, '_>, base: Value, index: usize) -> Vector {
    let offset = (VECTOR * index) as i32;
    Vector::Value(m.builder().ins().load(type_of(T::FORMAT), trusted(), base, offset))
}

/// Stores a vector of the quantity with this index of a packet.
fn store<T: Real>(m: &mut Emitter<'_, '_>, vector: Vector, base: Value, index: usize) {
    let value = m.value(vector);
    let offset = (VECTOR * T::VECTORS * index) as i32;
    m.builder().ins().store(trusted(), value, base, offset);
}

/// Index of the first parameter's vectors after the two fact words.
const FIRST_PARAMETER: usize = 2;

fn emit_enclosure<T: Real>(m: &mut Emitter<'_, '_>, tape: &Tape<T>, cursor: &Cursor) {
    let values = tape.enclose(
        m,
        |m, axis| {
            let axis = axis as usize;
            let row = |axis: usize| T::VECTORS * axis;
            (load::<T>(m, cursor.input, row(axis)), load::<T>(m, cursor.input, row(3 + axis)))
        },
        |m, number| {
            let at = FIRST_PARAMETER + 2 * number as usize;
            (load::<T>(m, cursor.parameters, at), load::<T>(m, cursor.parameters, at + 1))
        },
    );
    let value = &values[0];
    let mut facts = fact_bits(m, T::FORMAT, value);
    if tape.reads_parameters() {
        let kept = load::<T>(m, cursor.parameters, 0);
        let added = load::<T>(m, cursor.parameters, 1);
        facts = m.and(facts, kept);
        facts = m.or(facts, added);
    }
    store::<T>(m, value.neg_lo, cursor.output, 0);
    store::<T>(m, value.hi, cursor.output, 1);
    store::<T>(m, facts, cursor.output, 2);
}

/// The three facts as bits of each lane.
fn fact_bits(m: &mut Emitter<'_, '_>, format: Format, value: &Enclosure<Vector>) -> Vector {
    let facts = [
        (value.nowhere, Facts::NOWHERE),
        (value.defined, Facts::DEFINED),
        (value.continuous, Facts::CONTINUOUS),
    ];
    let known = facts
        .iter()
        .filter(|(fact, _)| matches!(fact, Fact::True))
        .fold(Facts::NONE, |known, (_, bit)| known | *bit);
    let mut bits = m.bits(format, u64::from(known.bits()));
    for (fact, bit) in facts {
        if let Fact::Lanes(mask) = fact {
            let bit = m.bits(format, u64::from(bit.bits()));
            let set = m.and(mask, bit);
            bits = m.or(set, bits);
        }
    }
    bits
}

fn emit_values<T: Real>(m: &mut Emitter<'_, '_>, tape: &Tape<T>, cursor: &Cursor) {
    let values = tape.evaluate(
        m,
        |m, axis| load::<T>(m, cursor.input, T::VECTORS * axis as usize),
        |m, number| load::<T>(m, cursor.parameters, number as usize),
    );
    for (index, value) in values.into_iter().enumerate() {
        store::<T>(m, value, cursor.output, index);
    }
}
