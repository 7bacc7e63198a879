//! From code for vectors of 128 bits, all that Cranelift has, to code for 256 and 512.
//!
//! A kernel does the same to each lane of a vector, so an instruction for more lanes is the same
//! instruction in its wider encoding. What it reads and writes of batches lies beside that anyway;
//! constants are repeated, and what is kept on the stack is put farther apart. Only halves of
//! vectors have to be moved otherwise: the [emitter](crate::lanes) does so in two ways, which are
//! known here. Of 512 bits a comparison gives a bit a lane, which is made a vector again. Code with
//! any instruction that is not known stays as it is.

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

/// Bytes of the vectors that code is made for.
const NARROW: usize = 16;

/// Where code is thought to be while it is read. What it refers to are distances.
const ORIGIN: u64 = 0x1000;
/// The stack may grow by less than this without a look at whether there is room.
const PAGE: i64 = 4096;

/// Vectors that are wider than Cranelift's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Width {
    /// Of 512 bits.
    Zmm,
    /// Of 256 bits.
    Ymm,
}

impl Width {
    /// All of them, the widest first.
    pub const ALL: [Self; 2] = [Self::Zmm, Self::Ymm];

    /// Bytes of a vector.
    pub fn bytes(self) -> usize {
        match self {
            Self::Zmm => 64,
            Self::Ymm => 32,
        }
    }

    /// Whether this processor has instructions for such vectors, and does not lower its clock for
    /// them: the first ones with 512 bits, before Ice Lake, do.
    pub fn is_possible(self) -> bool {
        match self {
            Self::Zmm => {
                is_x86_feature_detected!("avx512dq") && is_x86_feature_detected!("avx512vbmi2")
            }
            Self::Ymm => is_x86_feature_detected!("avx2"),
        }
    }

    /// How many of Cranelift's vectors are as wide.
    fn times(self) -> usize {
        self.bytes() / NARROW
    }

    /// The register that has this one as its lowest part.
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

    /// The register for half a vector.
    fn half(self, register: Register) -> Register {
        match self {
            Self::Zmm => Self::Ymm.whole(register),
            Self::Ymm => register,
        }
    }
}

/// The same function for vectors of such a width. It was written for them, but for its
/// instructions: where quantities are, and how large what it keeps in its first `slots` bytes of
/// the stack. It does not look whether there is room on the stack; the new one does. `None` if it
/// does what is not known here, or the new one would take more than `stack` bytes.
pub fn widened(code: &[u8], width: Width, slots: u32, stack: u32) -> Option<Vec<u8>> {
    if !slots.is_multiple_of(width.bytes() as u32) {
        // They were laid out with gaps, of which nothing is known.
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
    let mut constants = Constants { width, places: HashMap::new(), bytes: Vec::new() };
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
                    written[first..].iter_mut().for_each(|one| spilled::keep_in(one, *register));
                }
            } else if is_of_integers(&instruction) {
                if instruction.code() == Code::Retnq {
                    // Code for narrower vectors would wait for what is left in their upper parts.
                    written.push(Instruction::with(Code::VEX_Vzeroupper));
                }
                written.push(instruction);
            } else {
                return None;
            }
        }
        // A branch to what was read leads to the first of what is written in its place.
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

/// The instructions of a function, without the constants behind them. Each branch leads to one of
/// them.
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

/// Where a branch leads.
fn target(instruction: &Instruction) -> Option<u64> {
    (instruction.op0_kind() == OpKind::NearBranch64).then(|| instruction.near_branch_target())
}

/// Whether an instruction is one of those on integers that kernels have.
fn is_of_integers(instruction: &Instruction) -> bool {
    use Mnemonic::{Add, And, Cmp, Lea, Mov, Or, Pop, Push, Shl, Shlx, Shr, Shrx, Sub, Test, Xor};
    match instruction.mnemonic() {
        Mnemonic::Call => false,
        // Of a constant only what is in it is known.
        Lea => !instruction.is_ip_rel_memory_operand(),
        Add | And | Cmp | Mov | Or | Pop | Push | Shl | Shlx | Shr | Shrx | Sub | Test | Xor => {
            true
        }
        _ => instruction.code() == Code::Retnq || target(instruction).is_some(),
    }
}

/// Constants that are used, each as often as there is room for it in a vector.
struct Constants {
    width: Width,
    places: HashMap<u64, usize>,
    bytes: Vec<u8>,
}

impl Constants {
    /// Where the constant at an address of the old code is among them.
    fn place(&mut self, code: &[u8], address: u64, is_vector: bool) -> Option<usize> {
        let Self { width, places, bytes } = self;
        if let Some(place) = places.get(&address) {
            return Some(*place);
        }
        let first = usize::try_from(address.checked_sub(ORIGIN)?).ok()?;
        let rest = code.get(first..)?;
        // The last one may be of a few bytes, for what is no vector.
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

/// How the stack is used: first by what the code was told the size of, then by what is put away.
struct StackLayout {
    slots: i64,
    /// How large it may be.
    most: i64,
    /// How many times as far apart things are behind the slots.
    times: i64,
}

impl StackLayout {
    /// Where something on the stack goes.
    fn moved(&self, offset: i64) -> i64 {
        if offset < self.slots { offset } else { self.slots + self.times * (offset - self.slots) }
    }

    /// Takes the place of an instruction that makes room on the stack or gives it up; returns
    /// whether this is one.
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
            // To where it was before.
            Code::Mov_r64_rm64 | Code::Mov_rm64_r64
                if instruction.op1_register() == Register::RBP =>
            {
                return Some(false);
            }
            _ => return None,
        }
        Some(true)
    }

    /// Makes room, page by page, so that a page that guards the end of the stack is not passed
    /// over.
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

    /// Lets an instruction find what it refers to on the stack.
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

/// Moves the end of the stack.
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
