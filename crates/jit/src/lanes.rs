//! The machine that emits lane operations as Cranelift instructions.

use cranelift_codegen::ir::condcodes::{FloatCC, IntCC};
use cranelift_codegen::ir::immediates::V128Imm;
use cranelift_codegen::ir::types::{F32X4, F64X2, I8X16, I32, I32X4, I64, I64X2};
use cranelift_codegen::ir::{
    Block, ConstantData, Endianness, InstBuilder, MemFlagsData, StackSlot, StackSlotData,
    StackSlotKind, Type, Value,
};
use cranelift_frontend::FunctionBuilder;
use std::collections::HashMap;
use zeroset_interval::{Format, Machine, has_fma};

/// Bytes of a Cranelift vector.
pub const VECTOR: usize = 16;
/// Binary logarithm of [`VECTOR`].
const VECTOR_ALIGNMENT: u8 = 4;

/// A vector in the code that is being generated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LaneVector {
    /// Computed at run time.
    Value(Value),
    /// A constant with these bits.
    Constant(Format, u128),
}

/// A machine that emits each operation into the current block of a function.
///
/// Vectors always have a float type; integer operations reinterpret them. On x86-64 with SSE4.1 and
/// on `AArch64`, no operation is a library call. So multiply-adds are fused only if [`has_fma`].
///
/// Each constant is a single value, loaded once. Cranelift would not merge repeated loads into
/// instructions whose results are used twice, as nearly all results in affine forms are. Loading at
/// each use would cost 3 % more instructions per frame on Barth's sextic, 7 % on the gyroid.
pub struct Emitter<'a, 'b> {
    builder: &'a mut FunctionBuilder<'b>,
    /// Bytes of a vector when the code runs: a multiple of [`VECTOR`].
    width: usize,
    /// Constants in use, by type and bits.
    constants: HashMap<(Type, u128), Value>,
    /// Fused multiply-adds by operands, for reuse. Each use of an affine form asks for the form's
    /// error again.
    fused: HashMap<[Value; 3], Value>,
}

impl<'a, 'b> Emitter<'a, 'b> {
    /// Creates an emitter for the current block of `builder` and vectors of `width` bytes.
    pub fn new(builder: &'a mut FunctionBuilder<'b>, width: usize) -> Self {
        Self { builder, width, constants: HashMap::new(), fused: HashMap::new() }
    }

    /// The function being built.
    pub fn builder(&mut self) -> &mut FunctionBuilder<'b> {
        self.builder
    }

    /// Returns the Cranelift value of a vector. A constant gets its value at its first use.
    pub fn value(&mut self, vector: LaneVector) -> Value {
        let (format, bits) = match vector {
            LaneVector::Value(value) => return value,
            LaneVector::Constant(format, bits) => (format, bits),
        };
        let ty = type_of(format);
        if let Some(&value) = self.constants.get(&(ty, bits)) {
            return value;
        }
        let data = ConstantData::from(V128Imm(bits.to_le_bytes()).0.as_slice());
        let handle = self.builder.func.dfg.constants.insert(data);
        let value = self.builder.ins().vconst(ty, handle);
        self.constants.insert((ty, bits), value);
        value
    }

    /// Returns the sign bits of a vector's lanes as an integer. Its lowest bit is the first lane's.
    pub fn sign_bits(&mut self, vector: LaneVector) -> Value {
        let value = self.value(vector);
        let (_, integers) = self.integers(value);
        self.builder.ins().vhigh_bits(I32, integers)
    }

    fn values(&mut self, a: LaneVector, b: LaneVector) -> (Value, Value) {
        (self.value(a), self.value(b))
    }

    fn cast(&mut self, to: Type, value: Value) -> Value {
        // The byte order matters only where lanes change size; both targets are little-endian.
        let flags = MemFlagsData::new().with_endianness(Endianness::Little);
        self.builder.ins().bitcast(to, flags, value)
    }

    /// Joins two 64-bit parts of `a` and `b` into a vector. `parts` has the first byte of each
    /// part; the bytes of `b` count from 16.
    fn shuffle(&mut self, a: Value, b: Value, parts: [u8; 2]) -> Value {
        let is_one = a == b;
        let a = self.cast(I8X16, a);
        let b = if is_one { a } else { self.cast(I8X16, b) };
        let order: [u8; VECTOR] = std::array::from_fn(|byte| parts[byte / 8] + byte as u8 % 8);
        let mask = self.builder.func.dfg.immediates.push(ConstantData::from(order.as_slice()));
        let joined = self.builder.ins().shuffle(a, b, mask);
        self.cast(F32X4, joined)
    }

    fn compare(&mut self, condition: FloatCC, a: Value, b: Value) -> Value {
        let ty = self.builder.func.dfg.value_type(a);
        let mask = self.builder.ins().fcmp(condition, a, b);
        self.cast(ty, mask)
    }

    fn comparison(&mut self, condition: FloatCC, a: LaneVector, b: LaneVector) -> LaneVector {
        let (a, b) = self.values(a, b);
        LaneVector::Value(self.compare(condition, a, b))
    }

    /// Returns the float type of a vector, and its lanes as integers.
    fn integers(&mut self, a: Value) -> (Type, Value) {
        let ty = self.builder.func.dfg.value_type(a);
        let integer = if ty == F32X4 { I32X4 } else { I64X2 };
        (ty, self.cast(integer, a))
    }

    pub fn format(&self, a: LaneVector) -> Format {
        match a {
            LaneVector::Constant(format, _) => format,
            LaneVector::Value(value) if self.builder.func.dfg.value_type(value) == F32X4 => {
                Format::F32
            }
            LaneVector::Value(_) => Format::F64,
        }
    }
}

/// A loop under construction over the rows of a table on the stack. A row holds inputs, then
/// outputs.
pub struct RowLoop {
    slot: StackSlot,
    body: Block,
    /// Address of the current row.
    row: Value,
    last: Value,
    width: usize,
}

impl Emitter<'_, '_> {
    /// Offset of a column in its row, in bytes.
    fn at(&self, column: usize) -> i32 {
        (self.width * column) as i32
    }

    /// Begins a loop over rows of inputs, all `F64`, with space for `outputs` in each row. Returns
    /// the inputs of the current row.
    pub fn begin_rows<const ROWS: usize, const IN: usize>(
        &mut self,
        inputs: [[LaneVector; IN]; ROWS],
        outputs: usize,
    ) -> (RowLoop, [LaneVector; IN]) {
        let width = self.width * (IN + outputs);
        let size = (width * ROWS) as u32;
        let slot = StackSlotData::new(StackSlotKind::ExplicitSlot, size, VECTOR_ALIGNMENT);
        let slot = self.builder.create_sized_stack_slot(slot);
        for (row, inputs) in inputs.into_iter().enumerate() {
            for (column, input) in inputs.into_iter().enumerate() {
                let (value, offset) = (self.value(input), (row * width) as i32 + self.at(column));
                self.builder.ins().stack_store(I64, value, slot, offset);
            }
        }
        let body = self.builder.create_block();
        let row = self.builder.append_block_param(body, I64);
        let first = self.builder.ins().stack_addr(I64, slot, 0);
        let last = self.builder.ins().stack_addr(I64, slot, (width * (ROWS - 1)) as i32);
        self.builder.ins().jump(body, &[first.into()]);
        self.builder.switch_to_block(body);
        let flags = MemFlagsData::trusted();
        let inputs = std::array::from_fn(|column| {
            let offset = self.at(column);
            LaneVector::Value(self.builder.ins().load(F64X2, flags, row, offset))
        });
        (RowLoop { slot, body, row, last, width }, inputs)
    }

    /// Ends the loop with the outputs of the current row. Returns the outputs of all rows.
    pub fn end_rows<const ROWS: usize, const IN: usize, const OUT: usize>(
        &mut self,
        rows: &RowLoop,
        outputs: [LaneVector; OUT],
    ) -> [[LaneVector; OUT]; ROWS] {
        let RowLoop { slot, body, row, last, width } = *rows;
        let flags = MemFlagsData::trusted();
        for (column, output) in outputs.into_iter().enumerate() {
            let (value, offset) = (self.value(output), self.at(IN + column));
            self.builder.ins().store(flags, value, row, offset);
        }
        let end = self.builder.create_block();
        let more = self.builder.ins().icmp(IntCC::NotEqual, row, last);
        let next = self.builder.ins().iadd_imm_s(row, width as i64);
        self.builder.ins().brif(more, body, &[next.into()], end, &[]);
        self.builder.switch_to_block(end);
        std::array::from_fn(|row| {
            std::array::from_fn(|column| {
                let offset = (row * width) as i32 + self.at(IN + column);
                LaneVector::Value(self.builder.ins().stack_load(I64, F64X2, slot, offset))
            })
        })
    }
}

/// The type of a vector with lanes of this format.
pub fn type_of(format: Format) -> Type {
    match format {
        Format::F32 => F32X4,
        Format::F64 => F64X2,
    }
}

/// The bits of a vector whose lanes all have these bits.
fn splat(format: Format, bits: u64) -> u128 {
    match format {
        Format::F32 => {
            let lane = u128::from(bits as u32);
            lane | lane << 32 | lane << 64 | lane << 96
        }
        Format::F64 => u128::from(bits) | u128::from(bits) << 64,
    }
}

fn sign_bits(format: Format) -> u128 {
    match format {
        Format::F32 => splat(format, 1 << 31),
        Format::F64 => splat(format, 1 << 63),
    }
}

/// Emits an instruction with one float operand.
macro_rules! unary {
    ($($name:ident => $instruction:ident),* $(,)?) => {$(
        fn $name(&mut self, a: LaneVector) -> LaneVector {
            let a = self.value(a);
            LaneVector::Value(self.builder.ins().$instruction(a))
        }
    )*};
}

/// Emits an instruction with two operands.
macro_rules! binary {
    ($($name:ident => $instruction:ident),* $(,)?) => {$(
        fn $name(&mut self, a: LaneVector, b: LaneVector) -> LaneVector {
            let (a, b) = self.values(a, b);
            LaneVector::Value(self.builder.ins().$instruction(a, b))
        }
    )*};
}

/// Emits an instruction on the lanes as integers.
macro_rules! integer {
    ($($name:ident => $instruction:ident),* $(,)?) => {$(
        fn $name(&mut self, a: LaneVector, b: LaneVector) -> LaneVector {
            let (a, b) = self.values(a, b);
            let ((ty, a), (_, b)) = (self.integers(a), self.integers(b));
            let result = self.builder.ins().$instruction(a, b);
            LaneVector::Value(self.cast(ty, result))
        }
    )*};
}

/// Emits a shift of the lanes as integers.
macro_rules! shift {
    ($($name:ident => $instruction:ident),* $(,)?) => {$(
        fn $name(&mut self, a: LaneVector, by: u8) -> LaneVector {
            let a = self.value(a);
            let (ty, a) = self.integers(a);
            let shifted = self.builder.ins().$instruction(a, i64::from(by));
            LaneVector::Value(self.cast(ty, shifted))
        }
    )*};
}

impl Machine for Emitter<'_, '_> {
    type V = LaneVector;

    fn number(&mut self, format: Format, value: f64) -> LaneVector {
        let bits = match format {
            Format::F32 => u64::from((value as f32).to_bits()),
            Format::F64 => value.to_bits(),
        };
        self.bits(format, bits)
    }
    fn bits(&mut self, format: Format, bits: u64) -> LaneVector {
        LaneVector::Constant(format, splat(format, bits))
    }

    binary! { add => fadd, sub => fsub, mul => fmul, div => fdiv, and => band, or => bor, xor => bxor }
    fn mul_add(&mut self, a: LaneVector, b: LaneVector, c: LaneVector) -> LaneVector {
        if !has_fma() {
            let product = self.mul(a, b);
            return self.add(product, c);
        }
        let ((a, b), c) = (self.values(a, b), self.value(c));
        let builder = &mut *self.builder;
        let sum = self.fused.entry([a, b, c]).or_insert_with(|| builder.ins().fma(a, b, c));
        LaneVector::Value(*sum)
    }
    fn mul_sub(&mut self, a: LaneVector, b: LaneVector, c: LaneVector) -> LaneVector {
        if !has_fma() {
            let product = self.mul(a, b);
            return self.sub(product, c);
        }
        let ((a, b), c) = (self.values(a, b), self.value(c));
        // On x86-64 the negation becomes part of the multiply-add.
        let c = self.builder.ins().fneg(c);
        LaneVector::Value(self.builder.ins().fma(a, b, c))
    }
    unary! { sqrt => sqrt, floor => floor, ceil => ceil, trunc => trunc, nearest => nearest }
    integer! { int_add => iadd, int_sub => isub }
    shift! { shift_left => ishl_imm_u, shift_right => ushr_imm_u }

    // The mask of sign bits stays in a register, since most formulas negate often. The Cranelift
    // instructions fneg and fabs would load the mask each time.
    fn neg(&mut self, a: LaneVector) -> LaneVector {
        let format = self.format(a);
        let sign = sign_bits(format);
        match a {
            LaneVector::Constant(_, bits) => LaneVector::Constant(format, bits ^ sign),
            LaneVector::Value(a) => {
                let sign = self.value(LaneVector::Constant(format, sign));
                LaneVector::Value(self.builder.ins().bxor(a, sign))
            }
        }
    }
    fn abs(&mut self, a: LaneVector) -> LaneVector {
        let format = self.format(a);
        self.and(a, LaneVector::Constant(format, !sign_bits(format)))
    }
    // On x86-64 a comparison and a `bitselect` become one minps or maxps; fmin and fmax would take
    // seven instructions.
    fn min(&mut self, a: LaneVector, b: LaneVector) -> LaneVector {
        let (a, b) = self.values(a, b);
        let less = self.compare(FloatCC::LessThan, a, b);
        LaneVector::Value(self.builder.ins().bitselect(less, a, b))
    }
    fn max(&mut self, a: LaneVector, b: LaneVector) -> LaneVector {
        let (a, b) = self.values(a, b);
        let less = self.compare(FloatCC::LessThan, b, a);
        LaneVector::Value(self.builder.ins().bitselect(less, a, b))
    }

    fn lt(&mut self, a: LaneVector, b: LaneVector) -> LaneVector {
        self.comparison(FloatCC::LessThan, a, b)
    }
    fn le(&mut self, a: LaneVector, b: LaneVector) -> LaneVector {
        self.comparison(FloatCC::LessThanOrEqual, a, b)
    }
    fn eq(&mut self, a: LaneVector, b: LaneVector) -> LaneVector {
        self.comparison(FloatCC::Equal, a, b)
    }
    // A set lane of a mask has its sign bit set, so a blend by sign bits works for masks too. The
    // blend is faster than the code for bitselect.
    fn select(&mut self, mask: LaneVector, a: LaneVector, b: LaneVector) -> LaneVector {
        self.select_signed(mask, a, b)
    }
    fn select_signed(&mut self, sign: LaneVector, a: LaneVector, b: LaneVector) -> LaneVector {
        let sign = self.value(sign);
        let (a, b) = self.values(a, b);
        let ((ty, a), (_, b), (_, sign)) =
            (self.integers(a), self.integers(b), self.integers(sign));
        let chosen = if cfg!(target_arch = "x86_64") {
            self.builder.ins().blendv(sign, a, b)
        } else {
            let last_bit = if ty == F32X4 { 31 } else { 63 };
            let mask = self.builder.ins().sshr_imm_u(sign, last_bit);
            self.builder.ins().bitselect(mask, a, b)
        };
        LaneVector::Value(self.cast(ty, chosen))
    }

    // Halves of vectors are moved only by the two shuffles of `widen` and `narrow`: the module
    // `wide` knows no others.
    fn widen(&mut self, a: LaneVector) -> [LaneVector; 2] {
        let a = self.value(a);
        let upper = self.shuffle(a, a, [8, 8]);
        [a, upper].map(|half| LaneVector::Value(self.builder.ins().fvpromote_low(half)))
    }
    fn narrow(&mut self, [low, high]: [LaneVector; 2]) -> LaneVector {
        let (low, high) = self.values(low, high);
        // Each result is in the lower half of its vector.
        let [low, high] = [low, high].map(|half| self.builder.ins().fvdemote(half));
        LaneVector::Value(self.shuffle(low, high, [0, 16]))
    }

    fn repeat<const ROWS: usize, const IN: usize, const OUT: usize>(
        &mut self,
        inputs: [[LaneVector; IN]; ROWS],
        mut text: impl FnMut(&mut Self, [LaneVector; IN]) -> [LaneVector; OUT],
    ) -> [[LaneVector; OUT]; ROWS] {
        let (rows, inputs) = self.begin_rows(inputs, OUT);
        let outputs = text(self, inputs);
        self.end_rows::<ROWS, IN, OUT>(&rows, outputs)
    }
}
