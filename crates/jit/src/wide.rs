//! Widening of machine code from vectors of 128 bits, the widest that Cranelift generates, to 256
//! and 512 bits.
//!
//! A kernel treats all lanes alike, so most instructions only need a wider encoding. The additional
//! lanes follow in the memory of a batch. Each constant is repeated to fill a vector, and spilled
//! values lie farther apart on the stack. Only instructions that move halves of vectors become
//! different ones. The [emitter](crate::lanes) uses two kinds of them, which this module
//! recognizes. At 512 bits a comparison writes one bit per lane, and a further instruction expands
//! the bits to a vector. Code with an unknown instruction is not widened.

mod bytes;
mod encodings;
mod masks;
mod spilled;

use bytes::bytes;
use encodings::widen;
use iced_x86::{
    Code, Decoder, DecoderOptions, Instruction, MemoryOperand, Mnemonic, OpKind, Register,
};
use std::collections::HashMap;

/// Bytes of a vector in Cranelift's code.
const NARROW: usize = 16;

/// Address assumed for the code while it is decoded. Any will do, since references are relative.
const ORIGIN: u64 = 0x1000;
/// The stack may grow by fewer bytes than this without a probe.
const PAGE: i64 = 4096;

/// Vectors that are wider than Cranelift's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Width {
    /// Vectors of 512 bits.
    Zmm,
    /// Vectors of 256 bits.
    Ymm,
}

impl Width {
    /// All widths, the widest first.
    pub const ALL: [Self; 2] = [Self::Zmm, Self::Ymm];

    /// Bytes of a vector.
    pub fn bytes(self) -> usize {
        match self {
            Self::Zmm => 64,
            Self::Ymm => 32,
        }
    }

    /// Returns whether this processor has such vectors and keeps its clock rate while it uses them.
    /// Processors before Ice Lake lower their clock rate for 512 bits.
    pub fn is_possible(self) -> bool {
        match self {
            Self::Zmm => {
                is_x86_feature_detected!("avx512dq") && is_x86_feature_detected!("avx512vbmi2")
            }
            Self::Ymm => is_x86_feature_detected!("avx2"),
        }
    }

    /// Number of Cranelift's vectors that fit in a vector of this width.
    fn times(self) -> usize {
        self.bytes() / NARROW
    }

    /// The register of this width whose lowest part is `register`.
    fn whole(self, register: Register) -> Register {
        let first = match self {
            Self::Zmm => Register::ZMM0,
            Self::Ymm => Register::YMM0,
        };
        if is_vector(register) {
            first + (register as u32 - Register::XMM0 as u32)
        } else {
            register
        }
    }

    /// The register of half this width whose lowest part is `register`.
    fn half(self, register: Register) -> Register {
        match self {
            Self::Zmm => Self::Ymm.whole(register),
            Self::Ymm => register,
        }
    }
}

/// Translates a function to vectors of `width`. `code` has instructions for 128 bits. But its
/// offsets of quantities, and those within the first `slots` bytes of its stack, must be for
/// `width` already. `code` must not probe the stack; the result does. Returns `None` if `code` has
/// anything unknown, or if the result would take more than `stack` bytes of stack.
pub fn widened(code: &[u8], width: Width, slots: u32, stack: u32) -> Option<Vec<u8>> {
    if !slots.is_multiple_of(width.bytes() as u32) {
        // There are gaps between the slots, in an unknown layout.
        return None;
    }
    let frame = StackLayout {
        slots: i64::from(slots),
        most: i64::from(stack),
        times: width.times() as i64,
    };
    let read = instructions(code)?;
    let (mut kept, mut blocks) = (Vec::new(), Vec::new());
    if width == Width::Zmm {
        blocks = spilled::blocks(&read);
        kept = spilled::registers(&read, &blocks, slots);
    }
    let mut constants = ConstantPool { width, places: HashMap::new(), bytes: Vec::new() };
    let mut written = Vec::with_capacity(read.len() + 8);
    let mut blocks_of_written = Vec::with_capacity(blocks.len() + 8);
    for (number, mut instruction) in read.into_iter().enumerate() {
        let (ip, first) = (instruction.ip(), written.len());
        if !frame.takes(&instruction, &mut written)? {
            let is_of_vectors = is_of_vectors(&instruction);
            if instruction.is_ip_rel_memory_operand() {
                let address = instruction.ip_rel_memory_address();
                let place = constants.place(code, address, is_of_vectors)?;
                instruction.set_memory_displacement64(place as u64);
            } else if instruction.memory_base() == Register::RSP {
                frame.move_operand(&mut instruction)?;
            }
            if is_of_vectors {
                widen(&instruction, width, &mut written)?;
                if let Some(Some(register)) = kept.get(number) {
                    written[first..]
                        .iter_mut()
                        .for_each(|one| spilled::replace_memory_operand(one, *register));
                }
            } else if is_of_integers(&instruction) {
                if instruction.code() == Code::Retnq {
                    // Clear the upper parts of the registers: values in them would slow down code
                    // with narrower vectors.
                    written.push(Instruction::with(Code::VEX_Vzeroupper));
                }
                written.push(instruction);
            } else {
                return None;
            }
        }
        // A branch to the narrow instruction must lead to the first instruction that replaces it.
        for (k, instruction) in written[first..].iter_mut().enumerate() {
            instruction.set_ip(if k == 0 { ip } else { 0 });
        }
        if let Some(block) = blocks.get(number) {
            blocks_of_written.resize(written.len(), *block);
        }
    }
    if width == Width::Zmm {
        written = masks::kept(written, blocks_of_written);
    }
    bytes(&written, &constants.bytes, width.bytes())
}

/// Decodes the instructions of a function, without the constants behind them. Returns `None` if an
/// instruction is invalid, or if a branch leads into the middle of one.
fn instructions(code: &[u8]) -> Option<Vec<Instruction>> {
    let mut decoder = Decoder::with_ip(64, code, ORIGIN, DecoderOptions::NONE);
    let (mut all, mut farthest) = (Vec::new(), ORIGIN);
    while decoder.can_decode() {
        let instruction = decoder.decode();
        if instruction.is_invalid() {
            return None;
        }
        farthest = farthest.max(target(&instruction).unwrap_or(ORIGIN));
        let ends = [Mnemonic::Jmp, Mnemonic::Ret].contains(&instruction.mnemonic());
        all.push(instruction);
        if ends && decoder.ip() > farthest {
            let is_there = |target| all.binary_search_by_key(&target, Instruction::ip).is_ok();
            return all.iter().filter_map(target).all(is_there).then_some(all);
        }
    }
    None
}

fn target(instruction: &Instruction) -> Option<u64> {
    (instruction.op0_kind() == OpKind::NearBranch64).then(|| instruction.near_branch_target())
}

/// Returns whether an instruction is an integer instruction that kernels use.
fn is_of_integers(instruction: &Instruction) -> bool {
    use Mnemonic::{Add, And, Cmp, Lea, Mov, Or, Pop, Push, Shl, Shlx, Shr, Shrx, Sub, Test, Xor};
    match instruction.mnemonic() {
        Mnemonic::Call => false,
        // Constants move. This module adapts instructions that read constants, but not their
        // addresses.
        Lea => !instruction.is_ip_rel_memory_operand(),
        Add | And | Cmp | Mov | Or | Pop | Push | Shl | Shlx | Shr | Shrx | Sub | Test | Xor => {
            true
        }
        _ => instruction.code() == Code::Retnq || target(instruction).is_some(),
    }
}

/// The constants in use, each repeated to fill a vector.
struct ConstantPool {
    width: Width,
    places: HashMap<u64, usize>,
    bytes: Vec<u8>,
}

impl ConstantPool {
    /// Position in the pool of the constant at `address` in the narrow code.
    fn place(&mut self, code: &[u8], address: u64, is_vector: bool) -> Option<usize> {
        let Self { width, places, bytes } = self;
        if let Some(place) = places.get(&address) {
            return Some(*place);
        }
        let first = usize::try_from(address.checked_sub(ORIGIN)?).ok()?;
        let rest = code.get(first..)?;
        // A constant that is not a vector may have fewer bytes, if it is the last one.
        if rest.is_empty() || is_vector && rest.len() < NARROW {
            return None;
        }
        let place = bytes.len();
        places.insert(address, place);
        for _ in 0..width.times() {
            bytes.extend(&rest[..rest.len().min(NARROW)]);
            bytes.resize(bytes.len().next_multiple_of(NARROW), 0);
        }
        Some(place)
    }
}

/// The layout of the stack: slots, whose size stays the same, then spilled values.
struct StackLayout {
    slots: i64,
    /// Largest number of bytes allowed.
    most: i64,
    /// Factor by which widening enlarges the area of the spilled values.
    times: i64,
}

impl StackLayout {
    /// Converts an offset on the narrow code's stack to one on the widened code's stack.
    fn moved(&self, offset: i64) -> i64 {
        if offset < self.slots { offset } else { self.slots + self.times * (offset - self.slots) }
    }

    /// Replaces an instruction that allocates or frees stack, and returns true. Returns false for
    /// other instructions, and `None` if one changes the stack pointer in an unknown way.
    fn takes(&self, instruction: &Instruction, written: &mut Vec<Instruction>) -> Option<bool> {
        if instruction.op0_register() != Register::RSP {
            return Some(false);
        }
        let bytes = || self.moved(instruction.immediate(1) as i64);
        match instruction.code() {
            Code::Sub_rm64_imm8 | Code::Sub_rm64_imm32 => self.make(bytes(), written)?,
            Code::Add_rm64_imm8 | Code::Add_rm64_imm32 => {
                written.push(change(Code::Add_rm64_imm32, bytes())?);
            }
            // Restores the stack pointer, whatever the frame's size.
            Code::Mov_r64_rm64 | Code::Mov_rm64_r64
                if instruction.op1_register() == Register::RBP =>
            {
                return Some(false);
            }
            _ => return None,
        }
        Some(true)
    }

    /// Allocates stack page by page, so that the guard page at the stack's end is not skipped.
    /// Returns `None` if `bytes` exceeds the largest size allowed.
    fn make(&self, mut bytes: i64, written: &mut Vec<Instruction>) -> Option<()> {
        if !(self.slots..=self.most).contains(&bytes) {
            return None;
        }
        let end = MemoryOperand::with_base(Register::RSP);
        while bytes >= PAGE {
            written.push(change(Code::Sub_rm64_imm32, PAGE)?);
            written.push(Instruction::with2(Code::Mov_rm32_imm32, end, 0).ok()?);
            bytes -= PAGE;
        }
        if bytes > 0 {
            written.push(change(Code::Sub_rm64_imm32, bytes)?);
        }
        Some(())
    }

    /// Adapts the offset of an operand on the stack.
    fn move_operand(&self, instruction: &mut Instruction) -> Option<()> {
        let offset = instruction.memory_displacement64() as i64;
        if instruction.memory_index() != Register::None || offset < 0 {
            return None;
        }
        let offset = self.moved(offset);
        instruction.set_memory_displacement64(offset as u64);
        let size = match offset {
            0 => 0,
            1..=127 => 1,
            _ => 8,
        };
        instruction.set_memory_displ_size(size);
        Some(())
    }
}

/// An instruction that moves the stack pointer by `bytes`.
fn change(code: Code, bytes: i64) -> Option<Instruction> {
    Instruction::with2(code, Register::RSP, i32::try_from(bytes).ok()?).ok()
}

fn is_vector(register: Register) -> bool {
    (Register::XMM0..=Register::XMM15).contains(&register)
}

fn is_of_vectors(instruction: &Instruction) -> bool {
    (0..instruction.op_count()).any(|operand| is_vector(instruction.op_register(operand)))
}

#[cfg(test)]
mod tests;
