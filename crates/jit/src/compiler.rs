//! Compilation of a tape to native code.

use crate::code::{Code, ExecutableMemory};
use crate::count::Counter;
use crate::error::Error;
use crate::lanes::{Emitter, LaneVector, VECTOR, type_of};
#[cfg(target_arch = "x86_64")]
use crate::wide::{Width, widened};
use cranelift_codegen::control::ControlPlane;
use cranelift_codegen::ir::condcodes::IntCC;
use cranelift_codegen::ir::types::I64;
use cranelift_codegen::ir::{
    AbiParam, BlockArg, Function, InstBuilder, MemFlagsData, Signature, Value,
};
use cranelift_codegen::isa::{CallConv, OwnedTargetIsa};
use cranelift_codegen::settings::{self, Configurable};
use cranelift_codegen::{CompiledCode, Context};
use cranelift_frontend::{FunctionBuilder, FunctionBuilderContext};
use cranelift_jit::{JITBuilder, JITModule};
use cranelift_module::{Module, default_libcall_names};
use std::any::Any;
use std::marker::PhantomData;
use std::sync::OnceLock;
use zeroset_eval::{
    Batch, LANES, Lanes, Loader, Output, Query, QueryNumber, QueryResult, QueryTask, Real, Tape,
};
use zeroset_interval::{Fact, Format};

/// Largest number of operations in a kernel. More would take too long to compile, even in
/// [`Tier::Fast`].
const OPERATION_LIMIT: usize = 20_000;
/// Largest number of instructions in a kernel, which make 2 MB of code. A single operation may take
/// more than a hundred instructions.
const INSTRUCTION_LIMIT: usize = 200_000;
/// Largest stack of a kernel, in bytes: a quarter of a thread's default stack.
const STACK_LIMIT: u32 = 512 << 10;
/// Kernels with more instructions than this use [`Tier::Fast`]. [`Tier::Optimizing`] takes about
/// 1.2 µs per instruction, so larger kernels would come near 2 ms. Code from the fast tier runs up
/// to 1.2 times as long. For polynomials this factor is up to 1.7, but only huge polynomials reach
/// this size.
const FAST_TIER_FROM: usize = 1_200;

/// Number of arguments of a kernel.
pub const KERNEL_ARGUMENTS: usize = 5;

/// The effort that code generation spends. Code of both tiers does the same operations, so results
/// have the same bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tier {
    /// Backtracking register allocation.
    Optimizing,
    /// Register allocation in a single pass.
    Fast,
}

/// The source of the code that probes the stack. Without probes, a large frame could skip the guard
/// page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StackProbe {
    /// Cranelift.
    Code,
    /// The module `wide`, when it widens Cranelift's code.
    #[cfg_attr(not(target_arch = "x86_64"), expect(dead_code, reason = "nobody does"))]
    Widened,
}

/// The code generation target for this processor, built once per tier and probe.
pub fn target(tier: Tier, probe: StackProbe) -> Result<OwnedTargetIsa, Error> {
    static TARGETS: [[OnceLock<Option<OwnedTargetIsa>>; 2]; 2] =
        [const { [const { OnceLock::new() }; 2] }; 2];
    TARGETS[tier as usize][probe as usize]
        .get_or_init(|| {
            let mut flags = settings::builder();
            let allocator = match tier {
                Tier::Optimizing => "backtracking",
                Tier::Fast => "single_pass",
            };
            let flag = |is_set: bool| if is_set { "true" } else { "false" };
            for (name, value) in [
                // Cranelift's optimizer does not pay. The graph has no common subexpressions left,
                // and the optimizer moves constants out of the loop and then spills them. Compiling
                // takes 1.3 times as long; the code is 2 % slower over the gallery.
                ("opt_level", "none"),
                ("regalloc_algorithm", allocator),
                ("enable_verifier", flag(cfg!(debug_assertions))),
                ("unwind_info", "false"),
                ("is_pic", "false"),
                ("enable_probestack", flag(probe == StackProbe::Code)),
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
        // Without SSE4.1, rounding to integers would be a library call in the wrong rounding mode.
        return Err(Error::Unsupported("SSE4.1"));
    }
    if cfg!(any(target_arch = "x86_64", target_arch = "aarch64")) {
        Ok(())
    } else {
        Err(Error::Unsupported("x86-64 or AArch64"))
    }
}

/// Widths in bytes of the vectors that kernels can use on this processor, the widest first. A
/// kernel uses the widest vectors, or narrower ones if those would need too much stack.
pub fn vector_widths() -> impl Iterator<Item = usize> {
    #[cfg(target_arch = "x86_64")]
    let wider = Width::ALL.into_iter().filter(|width| width.is_possible()).map(Width::bytes);
    #[cfg(not(target_arch = "x86_64"))]
    let wider = std::iter::empty();
    wider.chain([VECTOR])
}

/// Compiles a tape for a query, with vectors of at most `widest` bytes. Without a `tier`, the
/// code's size decides which tier to use.
///
/// # Panics
/// If the tape computes more or fewer expressions than the query needs.
pub fn compile<Q: Query, T: Real>(
    tape: &Tape<T>,
    widest: usize,
    tier: Option<Tier>,
) -> Result<Code, Error> {
    generate(|width| build::<Q, T>(tape, width), tier, widest)
}

/// Compiles a tape for a query in [`Tier::Optimizing`]. `None` if the code is so large that
/// [`compile`] would choose [`Tier::Fast`].
///
/// # Panics
/// As for [`compile`].
pub fn optimize<Q: Query, T: Real>(tape: &Tape<T>) -> Result<Option<Code>, Error> {
    if is_large(&build::<Q, T>(tape, VECTOR)?) {
        return Ok(None);
    }
    compile::<Q, T>(tape, usize::MAX, Some(Tier::Optimizing)).map(Some)
}

fn is_large(function: &Function) -> bool {
    function.dfg.num_insts() > FAST_TIER_FROM
}

/// Generates code in memory. `write` creates intermediate code for vectors of a given number of
/// bytes. The widest vectors up to `widest` bytes are tried first. Without a `tier`, the code's
/// size decides which tier to use.
fn generate(
    write: impl Fn(usize) -> Result<Function, Error>,
    tier: Option<Tier>,
    #[cfg_attr(
        not(target_arch = "x86_64"),
        expect(unused_variables, reason = "there is one width")
    )]
    widest: usize,
) -> Result<Code, Error> {
    check_processor()?;
    #[cfg(target_arch = "x86_64")]
    for width in Width::ALL {
        if width.bytes() <= widest
            && width.is_possible()
            && let Some(code) = generate_wide(write(width.bytes())?, tier, width)?
        {
            return Ok(code);
        }
    }
    let code = machine_code(write(VECTOR)?, tier, StackProbe::Code)?;
    place(code.buffer.data(), u64::from(code.buffer.alignment), VECTOR)
}

/// Generates code for vectors of `width` bytes and no others.
///
/// # Errors
/// If the code cannot use such vectors.
pub fn generate_at(function: Function, width: usize) -> Result<Code, Error> {
    check_processor()?;
    if width == VECTOR {
        let code = machine_code(function, None, StackProbe::Code)?;
        return place(code.buffer.data(), u64::from(code.buffer.alignment), VECTOR);
    }
    #[cfg(target_arch = "x86_64")]
    if let Some(wide) = Width::ALL.into_iter().find(|wide| wide.bytes() == width)
        && let Some(code) = generate_wide(function, None, wide)?
    {
        return Ok(code);
    }
    Err(Error::Unsupported("vectors of this width for every operation"))
}

/// Generates code for vectors wider than Cranelift's. Returns `None` if the code would use too much
/// stack or cannot be widened.
#[cfg(target_arch = "x86_64")]
pub fn generate_wide(
    function: Function,
    tier: Option<Tier>,
    width: Width,
) -> Result<Option<Code>, Error> {
    let slots = function.fixed_stack_size();
    let code = match machine_code(function, tier, StackProbe::Widened) {
        Err(Error::TooDeep { .. }) => return Ok(None),
        code => code?,
    };
    let wider = widened(code.buffer.data(), width, slots, STACK_LIMIT);
    wider.map(|bytes| place(&bytes, width.bytes() as u64, width.bytes())).transpose()
}

pub fn machine_code(
    function: Function,
    tier: Option<Tier>,
    probe: StackProbe,
) -> Result<CompiledCode, Error> {
    check_stack(function.fixed_stack_size())?;
    let usual = if is_large(&function) { Tier::Fast } else { Tier::Optimizing };
    let tier = tier.unwrap_or(usual);
    let mut context = Context::for_function(function);
    if let Err(error) = context.compile(&*target(tier, probe)?, &mut ControlPlane::default()) {
        return Err(Error::Codegen(format!("{:?}", error.inner)));
    }
    let code = context.take_compiled_code().expect("it was compiled");
    check_stack(code.buffer.frame_layout().map_or(0, |layout| layout.frame_to_fp_offset))?;
    if !code.buffer.relocs().is_empty() {
        return Err(Error::Codegen("a kernel refers to what is not its own".into()));
    }
    Ok(code)
}

/// Copies machine code to executable memory.
pub fn place(bytes: &[u8], alignment: u64, width: usize) -> Result<Code, Error> {
    let builder =
        JITBuilder::with_isa(target(Tier::Optimizing, StackProbe::Code)?, default_libcall_names());
    let mut memory = ExecutableMemory::new(JITModule::new(builder));
    let module = memory.module();
    debug_assert!(module.target_config().pointer_bits() == 64, "kernels use 64-bit pointers");
    let report = |error: cranelift_module::ModuleError| Error::Codegen(format!("{error:?}"));
    let id = module.declare_anonymous_function(&signature(KERNEL_ARGUMENTS)).map_err(report)?;
    module.define_function_bytes(id, alignment, bytes, &[]).map_err(report)?;
    module.finalize_definitions().map_err(report)?;
    Ok(Code::new(memory, id, bytes.len(), width))
}

fn check_stack(bytes: u32) -> Result<(), Error> {
    if bytes > STACK_LIMIT { Err(Error::TooDeep { bytes, limit: STACK_LIMIT }) } else { Ok(()) }
}

/// The intermediate code of a kernel, as text.
///
/// # Errors
/// If the formula is too large.
///
/// # Panics
/// If the tape computes more or fewer expressions than the query needs.
pub fn intermediate_code<Q: Query, T: Real>(tape: &Tape<T>) -> Result<String, Error> {
    Ok(build::<Q, T>(tape, VECTOR)?.display().to_string())
}

/// The signature of a function with this number of integer arguments and no result.
pub fn signature(arguments: usize) -> Signature {
    // The convention that the assembly in `rounding` expects, even if the operating system's
    // differs.
    let convention = if cfg!(all(target_vendor = "apple", target_arch = "aarch64")) {
        CallConv::AppleAarch64
    } else {
        CallConv::SystemV
    };
    let mut signature = Signature::new(convention);
    signature.params.resize(arguments, AbiParam::new(I64));
    signature
}

/// The addresses that a kernel reads from in one iteration of its loop.
pub struct BatchPointers<T> {
    input: Value,
    parameters: Value,
    format: PhantomData<T>,
}

impl<T> BatchPointers<T> {
    /// Creates pointers to the next lanes of a batch, and to the parameters.
    pub fn new(input: Value, parameters: Value) -> Self {
        Self { input, parameters, format: PhantomData }
    }
}

impl<T: Real> Loader<Emitter<'_, '_>> for BatchPointers<T> {
    fn input(&mut self, m: &mut Emitter<'_, '_>, quantity: usize) -> LaneVector {
        load::<T>(m, self.input, quantity)
    }

    fn parameter(&mut self, m: &mut Emitter<'_, '_>, quantity: usize) -> LaneVector {
        load::<T>(m, self.parameters, quantity)
    }
}

/// A loader that reads nothing, for counting operations.
struct NullLoader;

impl Loader<Counter> for NullLoader {
    fn input(&mut self, _: &mut Counter, _: usize) {}

    fn parameter(&mut self, _: &mut Counter, _: usize) {}
}

/// Flags of memory accesses: all pointers of a kernel are valid and aligned to a vector.
pub fn trusted() -> MemFlagsData {
    MemFlagsData::trusted()
}

/// Builds a kernel's intermediate code for vectors of `width` bytes.
fn build<Q: Query, T: Real>(tape: &Tape<T>, width: usize) -> Result<Function, Error> {
    build_any(Q::NUMBER, T::FORMAT, tape, width)
}

/// As [`build`]. It is compiled in this crate alone.
fn build_any(
    query: QueryNumber,
    format: Format,
    tape: &dyn Any,
    width: usize,
) -> Result<Function, Error> {
    query.run(format, Build { tape, width })
}

struct Build<'a> {
    /// A tape in the precision of the task.
    tape: &'a dyn Any,
    width: usize,
}

impl QueryTask for Build<'_> {
    type Result = Result<Function, Error>;

    fn run<Q: Query, T: Real>(self) -> Result<Function, Error> {
        let tape = self.tape.downcast_ref::<Tape<T>>().expect("a tape in this precision");
        assert_eq!(tape.outputs(), Q::OUTPUTS, "expressions that answer for {}", Q::NAME);
        if tape.operations() > OPERATION_LIMIT {
            return Err(Error::TooLarge { operations: tape.operations(), limit: OPERATION_LIMIT });
        }
        let mut counter = Counter::default();
        Q::answer(tape, &mut counter, &mut NullLoader);
        if counter.0 > INSTRUCTION_LIMIT {
            return Err(Error::TooLong { instructions: counter.0, limit: INSTRUCTION_LIMIT });
        }
        write_function(|builder, arguments| {
            write_kernel::<Q, T>(builder, arguments, self.width, tape);
        })
    }
}

/// Writes intermediate code of a function with `N` arguments, up to its return.
pub fn write_function<const N: usize>(
    write: impl FnOnce(&mut FunctionBuilder<'_>, [Value; N]),
) -> Result<Function, Error> {
    let mut function = Function::new();
    function.signature = signature(N);
    let mut context = FunctionBuilderContext::new();
    let mut builder = FunctionBuilder::new(&mut function, &mut context);
    let entry = builder.create_block();
    builder.append_block_params_for_function_params(entry);
    builder.switch_to_block(entry);
    let arguments = builder.block_params(entry).try_into().expect("as many as in the signature");
    write(&mut builder, arguments);
    builder.ins().return_(&[]);
    builder.seal_all_blocks();
    builder.finalize(target(Tier::Optimizing, StackProbe::Code)?.frontend_config());
    Ok(function)
}

/// Writes the loop of a kernel over the lanes in use.
fn write_kernel<Q: Query, T: Real>(
    builder: &mut FunctionBuilder<'_>,
    [inputs, outputs, count, parameters, _guards]: [Value; KERNEL_ARGUMENTS],
    width: usize,
    tape: &Tape<T>,
) {
    let (body, end) = (builder.create_block(), builder.create_block());
    // Parameters of the loop's block: the addresses of the next lanes in the input and output
    // batch, the number of the first of these lanes, and the masks found so far.
    let [input, output, lane, masks] = [(); 4].map(|()| builder.append_block_param(body, I64));
    let zero = builder.ins().iconst(I64, 0);
    builder.ins().jump(body, &args(&[inputs, outputs, zero, zero]));

    builder.switch_to_block(body);
    let mut cursor = BatchPointers::<T>::new(input, parameters);
    let mut emitter = Emitter::new(builder, width);
    let answer = Q::answer(tape, &mut emitter, &mut cursor);
    let (known, found) = store_result::<T>(&mut emitter, answer, output);
    let mut all = masks;
    if let Some(found) = found {
        let found = builder.ins().ishl(found, lane);
        all = builder.ins().bor(masks, found);
    }
    let input = builder.ins().iadd_imm_s(input, width as i64);
    let output = builder.ins().iadd_imm_s(output, width as i64);
    let lane = builder.ins().iadd_imm_s(lane, (width / size_of::<T>()) as i64);
    let more = builder.ins().icmp(IntCC::UnsignedLessThan, lane, count);
    builder.ins().brif(more, body, &args(&[input, output, lane, all]), end, &[]);

    builder.switch_to_block(end);
    if <Q::Output<T>>::MASKS > 0 {
        if known != 0 {
            let known = builder.ins().iconst(I64, known as i64);
            all = builder.ins().bor(all, known);
        }
        builder.ins().store(trusted(), all, outputs, offset::<T>(<Q::Output<T>>::QUANTITIES));
    }
}

/// Stores the quantities of a result in the output's next lanes. Returns the bits of masks that
/// are set in all lanes, and those that are set in these lanes, the lowest for the first of them.
pub fn store_result<T: Real>(
    emitter: &mut Emitter<'_, '_>,
    result: QueryResult<LaneVector>,
    output: Value,
) -> (u64, Option<Value>) {
    for (number, value) in result.quantities.into_iter().enumerate() {
        let value = emitter.value(value);
        emitter.builder().ins().store(trusted(), value, output, offset::<T>(number));
    }
    let (mut known, mut found) = (0_u64, None);
    for (mask, shift) in result.masks.iter().zip((0..).step_by(LANES)) {
        match mask {
            Fact::False => {}
            Fact::True => known |= u64::from(u16::MAX) << shift,
            Fact::Lanes(mask) => {
                let bits = emitter.sign_bits(*mask);
                let builder = emitter.builder();
                let mut bits = builder.ins().uextend(I64, bits);
                if shift != 0 {
                    bits = builder.ins().ishl_imm_u(bits, shift);
                }
                found = Some(found.map_or(bits, |found| builder.ins().bor(found, bits)));
            }
        }
    }
    (known, found)
}

pub fn args(values: &[Value]) -> Vec<BlockArg> {
    values.iter().map(|&value| value.into()).collect()
}

/// Offset of a quantity in a batch, in bytes.
pub fn offset<T: Real>(quantity: usize) -> i32 {
    (size_of::<Lanes<T>>() * quantity) as i32
}

/// Emits a load of one vector of a quantity's lanes. `base` is the address for quantity 0.
pub fn load<T: Real>(m: &mut Emitter<'_, '_>, base: Value, quantity: usize) -> LaneVector {
    let flags = trusted();
    LaneVector::Value(m.builder().ins().load(
        type_of(T::FORMAT),
        flags,
        base,
        offset::<T>(quantity),
    ))
}
