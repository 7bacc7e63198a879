//! The machine that emits: lane operations as Cranelift instructions.

use cranelift_codegen::ir::condcodes::FloatCC;
use cranelift_codegen::ir::immediates::V128Imm;
use cranelift_codegen::ir::types::{F32X4, F64X2, I32X4, I64X2};
use cranelift_codegen::ir::{ConstantData, Endianness, InstBuilder, MemFlagsData, Type, Value};
use cranelift_frontend::FunctionBuilder;
use std::collections::HashMap;
use zeroset_interval::{Format, Machine};

/// Emits each operation into the current block of a function.
///
/// Vectors are always of a float type; integer operations reinterpret them. Nothing here is a library call on
/// x86-64 with SSE4.1 or on `AArch64`.
pub struct Emitter<'a, 'b> {
    builder: &'a mut FunctionBuilder<'b>,
    constants: HashMap<(Type, u128), Value>,
    /// The bits of the values that are constants.
    known: HashMap<Value, u128>,
}

impl<'a, 'b> Emitter<'a, 'b> {
    /// An emitter that appends to the current block of `builder`.
    pub fn new(builder: &'a mut FunctionBuilder<'b>) -> Self {
        Self { builder, constants: HashMap::new(), known: HashMap::new() }
    }

    /// The function being built.
    pub fn builder(&mut self) -> &mut FunctionBuilder<'b> {
        self.builder
    }

    fn constant(&mut self, ty: Type, bytes: u128) -> Value {
        if let Some(&value) = self.constants.get(&(ty, bytes)) {
            return value;
        }
        let data = ConstantData::from(V128Imm(bytes.to_le_bytes()).0.as_slice());
        let handle = self.builder.func.dfg.constants.insert(data);
        let value = self.builder.ins().vconst(ty, handle);
        self.constants.insert((ty, bytes), value);
        self.known.insert(value, bytes);
        value
    }

    fn type_of(&self, value: Value) -> Type {
        self.builder.func.dfg.value_type(value)
    }

    fn cast(&mut self, to: Type, value: Value) -> Value {
        // The order of bytes matters only where lanes change size; both targets are little-endian.
        let flags = MemFlagsData::new().with_endianness(Endianness::Little);
        self.builder.ins().bitcast(to, flags, value)
    }

    fn compare(&mut self, condition: FloatCC, a: Value, b: Value) -> Value {
        let ty = self.type_of(a);
        let mask = self.builder.ins().fcmp(condition, a, b);
        self.cast(ty, mask)
    }

    fn integers(&mut self, a: Value) -> (Type, Value) {
        let ty = self.type_of(a);
        let integer = if ty == F32X4 { I32X4 } else { I64X2 };
        (ty, self.cast(integer, a))
    }
}

impl Machine for Emitter<'_, '_> {
    type V = Value;

    fn number(&mut self, format: Format, value: f64) -> Value {
        let bits = match format {
            Format::F32 => u64::from((value as f32).to_bits()),
            Format::F64 => value.to_bits(),
        };
        self.bits(format, bits)
    }
    fn bits(&mut self, format: Format, bits: u64) -> Value {
        match format {
            Format::F32 => {
                let lane = u128::from(bits as u32);
                self.constant(F32X4, lane | lane << 32 | lane << 64 | lane << 96)
            }
            Format::F64 => self.constant(F64X2, u128::from(bits) | u128::from(bits) << 64),
        }
    }

    fn add(&mut self, a: Value, b: Value) -> Value {
        self.builder.ins().fadd(a, b)
    }
    fn sub(&mut self, a: Value, b: Value) -> Value {
        self.builder.ins().fsub(a, b)
    }
    fn mul(&mut self, a: Value, b: Value) -> Value {
        self.builder.ins().fmul(a, b)
    }
    fn div(&mut self, a: Value, b: Value) -> Value {
        self.builder.ins().fdiv(a, b)
    }
    fn sqrt(&mut self, a: Value) -> Value {
        self.builder.ins().sqrt(a)
    }
    // By masks from the constant pool: the instructions fneg and fabs would build theirs each time.
    fn neg(&mut self, a: Value) -> Value {
        let ty = self.type_of(a);
        let (format, bit) = if ty == F32X4 { (Format::F32, 31) } else { (Format::F64, 63) };
        if let Some(&bits) = self.known.get(&a) {
            let lane = (bits as u64 ^ 1 << bit) & (u64::MAX >> (63 - bit));
            return self.bits(format, lane);
        }
        let sign = self.bits(format, 1 << bit);
        self.builder.ins().bxor(a, sign)
    }
    fn abs(&mut self, a: Value) -> Value {
        let rest = if self.type_of(a) == F32X4 {
            self.bits(Format::F32, (1 << 31) - 1)
        } else {
            self.bits(Format::F64, (1 << 63) - 1)
        };
        self.builder.ins().band(a, rest)
    }
    // This pattern becomes one minps or maxps on x86-64; fmin and fmax would take seven instructions.
    fn min(&mut self, a: Value, b: Value) -> Value {
        let less = self.compare(FloatCC::LessThan, a, b);
        self.builder.ins().bitselect(less, a, b)
    }
    fn max(&mut self, a: Value, b: Value) -> Value {
        let less = self.compare(FloatCC::LessThan, b, a);
        self.builder.ins().bitselect(less, a, b)
    }
    fn floor(&mut self, a: Value) -> Value {
        self.builder.ins().floor(a)
    }
    fn ceil(&mut self, a: Value) -> Value {
        self.builder.ins().ceil(a)
    }
    fn trunc(&mut self, a: Value) -> Value {
        self.builder.ins().trunc(a)
    }
    fn nearest(&mut self, a: Value) -> Value {
        self.builder.ins().nearest(a)
    }

    fn lt(&mut self, a: Value, b: Value) -> Value {
        self.compare(FloatCC::LessThan, a, b)
    }
    fn le(&mut self, a: Value, b: Value) -> Value {
        self.compare(FloatCC::LessThanOrEqual, a, b)
    }
    fn eq(&mut self, a: Value, b: Value) -> Value {
        self.compare(FloatCC::Equal, a, b)
    }
    fn and(&mut self, a: Value, b: Value) -> Value {
        self.builder.ins().band(a, b)
    }
    fn or(&mut self, a: Value, b: Value) -> Value {
        self.builder.ins().bor(a, b)
    }
    fn xor(&mut self, a: Value, b: Value) -> Value {
        self.builder.ins().bxor(a, b)
    }
    fn select(&mut self, mask: Value, a: Value, b: Value) -> Value {
        self.builder.ins().bitselect(mask, a, b)
    }

    fn int_add(&mut self, a: Value, b: Value) -> Value {
        let ((ty, a), (_, b)) = (self.integers(a), self.integers(b));
        let sum = self.builder.ins().iadd(a, b);
        self.cast(ty, sum)
    }
    fn int_sub(&mut self, a: Value, b: Value) -> Value {
        let ((ty, a), (_, b)) = (self.integers(a), self.integers(b));
        let difference = self.builder.ins().isub(a, b);
        self.cast(ty, difference)
    }
    fn shift_left(&mut self, a: Value, by: u8) -> Value {
        let (ty, a) = self.integers(a);
        let shifted = self.builder.ins().ishl_imm_u(a, i64::from(by));
        self.cast(ty, shifted)
    }
    fn shift_right(&mut self, a: Value, by: u8) -> Value {
        let (ty, a) = self.integers(a);
        let shifted = self.builder.ins().ushr_imm_u(a, i64::from(by));
        self.cast(ty, shifted)
    }

    fn widen(&mut self, a: Value) -> [Value; 2] {
        let low = self.builder.ins().fvpromote_low(a);
        let integers = self.cast(I64X2, a);
        // Lane 1 of two 64-bit lanes holds f32 lanes 2 and 3.
        let upper = self.builder.ins().extractlane(integers, 1);
        let moved = self.builder.ins().scalar_to_vector(I64X2, upper);
        let moved = self.cast(F32X4, moved);
        [low, self.builder.ins().fvpromote_low(moved)]
    }
    fn narrow(&mut self, [low, high]: [Value; 2]) -> Value {
        let low = self.builder.ins().fvdemote(low);
        let high = self.builder.ins().fvdemote(high);
        // Both have their two lanes in front: interleave them as 64-bit lanes.
        let low = self.cast(cranelift_codegen::ir::types::I8X16, low);
        let high = self.cast(cranelift_codegen::ir::types::I8X16, high);
        let order: [u8; 16] = [0, 1, 2, 3, 4, 5, 6, 7, 16, 17, 18, 19, 20, 21, 22, 23];
        let mask = self.builder.func.dfg.immediates.push(ConstantData::from(order.as_slice()));
        let joined = self.builder.ins().shuffle(low, high, mask);
        self.cast(F32X4, joined)
    }
}
