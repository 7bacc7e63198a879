//! From code for vectors of 128 bits, all that Cranelift has, to code for 256.
//!
//! A kernel does the same to each lane of a vector, so an instruction for twice as many lanes is the same instruction in its
//! wider encoding. What it reads and writes of batches lies beside that anyway; constants are repeated, and what is kept on
//! the stack is put twice as far apart. Only halves of vectors have to be moved otherwise: the [emitter](crate::lanes) does so
//! in two ways, which are known here. Code with any instruction that is not stays as it is.

use iced_x86::{
    BlockEncoder, BlockEncoderOptions, Code, Decoder, DecoderOptions, Instruction,
    InstructionBlock, MemoryOperand, Mnemonic, OpKind, Register,
};
use std::collections::HashMap;

/// Bytes of a vector.
pub const WIDTH: usize = 32;
/// Those of the vectors that code is made for.
const NARROW: usize = WIDTH / 2;

/// Where code is thought to be while it is read and written. What it refers to are distances.
const ORIGIN: u64 = 0x1000;
/// Behind all code.
const FAR: u64 = 1 << 30;
/// The stack may grow by less than this without a look at whether there is room.
const PAGE: i64 = 4096;

/// Whether this processor has instructions for such vectors.
pub fn is_possible() -> bool {
    is_x86_feature_detected!("avx2")
}

/// The same function for vectors of [`WIDTH`] bytes. It was written for them, but for its instructions: where quantities are,
/// and how large what it keeps in its first `slots` bytes of the stack. It does not look whether there is room on the stack; the
/// new one does. `None` if it does what is not known here, or the new one would take more than `stack` bytes.
pub fn widened(code: &[u8], slots: u32, stack: u32) -> Option<Vec<u8>> {
    if !slots.is_multiple_of(WIDTH as u32) {
        // They were laid out with gaps, of which nothing is known.
        return None;
    }
    let frame = Frame { slots: i64::from(slots), most: i64::from(stack) };
    let read = instructions(code)?;
    let mut constants = Constants { places: HashMap::new(), bytes: Vec::new() };
    let mut written = Vec::with_capacity(read.len() + 8);
    for mut instruction in read {
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
                instruction = wider(&instruction)?;
            } else if !is_of_integers(&instruction) {
                return None;
            } else if instruction.code() == Code::Retnq {
                // Code for narrower vectors would wait for what is left in their upper halves.
                written.push(Instruction::with(Code::VEX_Vzeroupper));
            }
            written.push(instruction);
        }
        // A branch to what was read leads to the first of what is written in its place.
        for (k, instruction) in written[first..].iter_mut().enumerate() {
            instruction.set_ip(if k == 0 { ip } else { 0 });
        }
    }
    // Constants are thought to be far behind the code until it is known how long that is.
    for instruction in written.iter_mut().filter(|written| written.is_ip_rel_memory_operand()) {
        let place = instruction.memory_displacement64();
        instruction.set_memory_displacement64(FAR + place);
    }
    let block = InstructionBlock::new(&written, ORIGIN);
    let options = BlockEncoderOptions::RETURN_NEW_INSTRUCTION_OFFSETS
        | BlockEncoderOptions::RETURN_CONSTANT_OFFSETS;
    let encoded = BlockEncoder::encode(64, block, options).ok()?;
    let mut bytes = encoded.code_buffer;
    let room = bytes.len().next_multiple_of(WIDTH);
    let nearer = u32::try_from(FAR - ORIGIN).ok()?.checked_sub(u32::try_from(room).ok()?)?;
    let starts = encoded.new_instruction_offsets.iter().zip(&encoded.constant_offsets);
    for (instruction, (start, inside)) in written.iter().zip(starts) {
        if instruction.is_ip_rel_memory_operand() {
            let at = *start as usize + inside.displacement_offset();
            let distance = bytes.get_mut(at..at + size_of::<u32>())?.first_chunk_mut()?;
            *distance = (u32::from_le_bytes(*distance) - nearer).to_le_bytes();
        }
    }
    bytes.resize(room, 0);
    bytes.extend(constants.bytes);
    Some(bytes)
}

/// The instructions of a function, without the constants behind them. Each branch leads to one of them.
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

/// Constants that are used, each twice beside itself.
struct Constants {
    places: HashMap<u64, usize>,
    bytes: Vec<u8>,
}

impl Constants {
    /// Where the constant at an address of the old code is among them.
    fn place(&mut self, code: &[u8], address: u64, is_vector: bool) -> Option<usize> {
        let Self { places, bytes } = self;
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
        for _ in 0..WIDTH / NARROW {
            bytes.extend(&rest[..rest.len().min(NARROW)]);
            bytes.resize(bytes.len().next_multiple_of(NARROW), 0);
        }
        Some(place)
    }
}

/// How the stack is used: first by what the code was told the size of, then by what is put away.
struct Frame {
    slots: i64,
    /// How large it may be.
    most: i64,
}

impl Frame {
    /// Where something on the stack goes.
    fn moved(&self, offset: i64) -> i64 {
        if offset < self.slots { offset } else { self.slots + 2 * (offset - self.slots) }
    }

    /// Takes the place of an instruction that makes room on the stack or gives it up; returns whether this is one.
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

    /// Makes room, page by page, so that a page that guards the end of the stack is not passed over.
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

/// The register that has this one as its lower half.
fn whole(register: Register) -> Register {
    if is_vector(register) {
        Register::YMM0 + (register as u32 - Register::XMM0 as u32)
    } else {
        register
    }
}

/// By which a shuffle takes the upper half of a vector twice.
const UPPER: u8 = 0b11_10_11_10;

/// The instruction for vectors that are twice as wide.
fn wider(instruction: &Instruction) -> Option<Instruction> {
    let [to, a, b] = [0, 1, 2].map(|operand| instruction.op_register(operand));
    Some(match instruction.code() {
        // The upper half of a vector to the lower one of another.
        Code::VEX_Vpshufd_xmm_xmmm128_imm8 if is_vector(a) && instruction.immediate8() == UPPER => {
            Instruction::with3(Code::VEX_Vextractf128_xmmm128_ymm_imm8, to, whole(a), 1).ok()?
        }
        // The lower halves of two vectors side by side.
        Code::VEX_Vpunpcklqdq_xmm_xmm_xmmm128 if is_vector(b) => {
            let code = Code::VEX_Vinsertf128_ymm_ymm_xmmm128_imm8;
            Instruction::with4(code, whole(to), whole(a), b, 1).ok()?
        }
        code => {
            let mut wider = *instruction;
            wider.set_code(encoding(code)?);
            // Half as many lanes of twice the size are read, or written, by these.
            let [is_read, is_written] =
                [Code::VEX_Vcvtps2pd_xmm_xmmm64, Code::VEX_Vcvtpd2ps_xmm_xmmm128]
                    .map(|other| other == code);
            for operand in 0..wider.op_count() {
                let is_half = if operand == 0 { is_written } else { is_read };
                if wider.op_kind(operand) == OpKind::Register && !is_half {
                    wider.set_op_register(operand, whole(wider.op_register(operand)));
                }
            }
            wider
        }
    })
}

/// Lists instructions, each in its encoding for 128 bits and for 256.
macro_rules! encodings {
    ($code:ident: $($narrow:ident => $wide:ident,)*) => {
        match $code {
            $(Code::$narrow => Some(Code::$wide),)*
            _ => None,
        }
    };
}

/// The encoding of the same instruction for 256 bits, or, of moves and of logic, of one that does the same to the bits.
fn encoding(code: Code) -> Option<Code> {
    encodings! { code:
        Movaps_xmm_xmmm128 => VEX_Vmovups_ymm_ymmm256,
        Movapd_xmm_xmmm128 => VEX_Vmovups_ymm_ymmm256,
        Movdqa_xmm_xmmm128 => VEX_Vmovups_ymm_ymmm256,
        Movdqu_xmm_xmmm128 => VEX_Vmovups_ymm_ymmm256,
        Movdqu_xmmm128_xmm => VEX_Vmovups_ymmm256_ymm,
        VEX_Vmovdqa_xmm_xmmm128 => VEX_Vmovups_ymm_ymmm256,
        VEX_Vmovdqu_xmm_xmmm128 => VEX_Vmovups_ymm_ymmm256,
        VEX_Vmovdqu_xmmm128_xmm => VEX_Vmovups_ymmm256_ymm,
        VEX_Vmovups_xmm_xmmm128 => VEX_Vmovups_ymm_ymmm256,
        VEX_Vmovups_xmmm128_xmm => VEX_Vmovups_ymmm256_ymm,
        VEX_Vmovupd_xmm_xmmm128 => VEX_Vmovupd_ymm_ymmm256,
        VEX_Vmovupd_xmmm128_xmm => VEX_Vmovupd_ymmm256_ymm,
        VEX_Vaddps_xmm_xmm_xmmm128 => VEX_Vaddps_ymm_ymm_ymmm256,
        VEX_Vaddpd_xmm_xmm_xmmm128 => VEX_Vaddpd_ymm_ymm_ymmm256,
        VEX_Vsubps_xmm_xmm_xmmm128 => VEX_Vsubps_ymm_ymm_ymmm256,
        VEX_Vsubpd_xmm_xmm_xmmm128 => VEX_Vsubpd_ymm_ymm_ymmm256,
        VEX_Vmulps_xmm_xmm_xmmm128 => VEX_Vmulps_ymm_ymm_ymmm256,
        VEX_Vmulpd_xmm_xmm_xmmm128 => VEX_Vmulpd_ymm_ymm_ymmm256,
        VEX_Vdivps_xmm_xmm_xmmm128 => VEX_Vdivps_ymm_ymm_ymmm256,
        VEX_Vdivpd_xmm_xmm_xmmm128 => VEX_Vdivpd_ymm_ymm_ymmm256,
        VEX_Vminps_xmm_xmm_xmmm128 => VEX_Vminps_ymm_ymm_ymmm256,
        VEX_Vminpd_xmm_xmm_xmmm128 => VEX_Vminpd_ymm_ymm_ymmm256,
        VEX_Vmaxps_xmm_xmm_xmmm128 => VEX_Vmaxps_ymm_ymm_ymmm256,
        VEX_Vmaxpd_xmm_xmm_xmmm128 => VEX_Vmaxpd_ymm_ymm_ymmm256,
        VEX_Vsqrtps_xmm_xmmm128 => VEX_Vsqrtps_ymm_ymmm256,
        VEX_Vsqrtpd_xmm_xmmm128 => VEX_Vsqrtpd_ymm_ymmm256,
        VEX_Vroundps_xmm_xmmm128_imm8 => VEX_Vroundps_ymm_ymmm256_imm8,
        VEX_Vroundpd_xmm_xmmm128_imm8 => VEX_Vroundpd_ymm_ymmm256_imm8,
        VEX_Vfmadd213ps_xmm_xmm_xmmm128 => VEX_Vfmadd213ps_ymm_ymm_ymmm256,
        VEX_Vfmadd213pd_xmm_xmm_xmmm128 => VEX_Vfmadd213pd_ymm_ymm_ymmm256,
        VEX_Vfmadd132ps_xmm_xmm_xmmm128 => VEX_Vfmadd132ps_ymm_ymm_ymmm256,
        VEX_Vfmadd132pd_xmm_xmm_xmmm128 => VEX_Vfmadd132pd_ymm_ymm_ymmm256,
        VEX_Vfmsub213ps_xmm_xmm_xmmm128 => VEX_Vfmsub213ps_ymm_ymm_ymmm256,
        VEX_Vfmsub213pd_xmm_xmm_xmmm128 => VEX_Vfmsub213pd_ymm_ymm_ymmm256,
        VEX_Vfmsub132ps_xmm_xmm_xmmm128 => VEX_Vfmsub132ps_ymm_ymm_ymmm256,
        VEX_Vfmsub132pd_xmm_xmm_xmmm128 => VEX_Vfmsub132pd_ymm_ymm_ymmm256,
        VEX_Vandps_xmm_xmm_xmmm128 => VEX_Vandps_ymm_ymm_ymmm256,
        VEX_Vandpd_xmm_xmm_xmmm128 => VEX_Vandpd_ymm_ymm_ymmm256,
        VEX_Vandnps_xmm_xmm_xmmm128 => VEX_Vandnps_ymm_ymm_ymmm256,
        VEX_Vandnpd_xmm_xmm_xmmm128 => VEX_Vandnpd_ymm_ymm_ymmm256,
        VEX_Vorps_xmm_xmm_xmmm128 => VEX_Vorps_ymm_ymm_ymmm256,
        VEX_Vorpd_xmm_xmm_xmmm128 => VEX_Vorpd_ymm_ymm_ymmm256,
        VEX_Vxorps_xmm_xmm_xmmm128 => VEX_Vxorps_ymm_ymm_ymmm256,
        VEX_Vxorpd_xmm_xmm_xmmm128 => VEX_Vxorpd_ymm_ymm_ymmm256,
        VEX_Vpand_xmm_xmm_xmmm128 => VEX_Vandps_ymm_ymm_ymmm256,
        VEX_Vpor_xmm_xmm_xmmm128 => VEX_Vorps_ymm_ymm_ymmm256,
        VEX_Vpxor_xmm_xmm_xmmm128 => VEX_Vxorps_ymm_ymm_ymmm256,
        VEX_Vcmpps_xmm_xmm_xmmm128_imm8 => VEX_Vcmpps_ymm_ymm_ymmm256_imm8,
        VEX_Vcmppd_xmm_xmm_xmmm128_imm8 => VEX_Vcmppd_ymm_ymm_ymmm256_imm8,
        VEX_Vblendvps_xmm_xmm_xmmm128_xmm => VEX_Vblendvps_ymm_ymm_ymmm256_ymm,
        VEX_Vblendvpd_xmm_xmm_xmmm128_xmm => VEX_Vblendvpd_ymm_ymm_ymmm256_ymm,
        VEX_Vmovmskps_r32_xmm => VEX_Vmovmskps_r32_ymm,
        VEX_Vmovmskpd_r32_xmm => VEX_Vmovmskpd_r32_ymm,
        VEX_Vpaddd_xmm_xmm_xmmm128 => VEX_Vpaddd_ymm_ymm_ymmm256,
        VEX_Vpaddq_xmm_xmm_xmmm128 => VEX_Vpaddq_ymm_ymm_ymmm256,
        VEX_Vpsubd_xmm_xmm_xmmm128 => VEX_Vpsubd_ymm_ymm_ymmm256,
        VEX_Vpsubq_xmm_xmm_xmmm128 => VEX_Vpsubq_ymm_ymm_ymmm256,
        VEX_Vpslld_xmm_xmm_imm8 => VEX_Vpslld_ymm_ymm_imm8,
        VEX_Vpsllq_xmm_xmm_imm8 => VEX_Vpsllq_ymm_ymm_imm8,
        VEX_Vpsrld_xmm_xmm_imm8 => VEX_Vpsrld_ymm_ymm_imm8,
        VEX_Vpsrlq_xmm_xmm_imm8 => VEX_Vpsrlq_ymm_ymm_imm8,
        VEX_Vpcmpeqd_xmm_xmm_xmmm128 => VEX_Vpcmpeqd_ymm_ymm_ymmm256,
        VEX_Vpcmpeqq_xmm_xmm_xmmm128 => VEX_Vpcmpeqq_ymm_ymm_ymmm256,
        VEX_Vcvtps2pd_xmm_xmmm64 => VEX_Vcvtps2pd_ymm_xmmm128,
        VEX_Vcvtpd2ps_xmm_xmmm128 => VEX_Vcvtpd2ps_xmm_ymmm256,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STACK: u32 = 1 << 19;

    fn encoded(instructions: &[Instruction]) -> Vec<u8> {
        let block = InstructionBlock::new(instructions, ORIGIN);
        BlockEncoder::encode(64, block, BlockEncoderOptions::NONE).expect("encodes").code_buffer
    }

    /// A function with this frame, which stores one vector on the stack and does something else.
    fn function(bytes: i64, offset: i64, other: Instruction) -> Vec<u8> {
        let place = MemoryOperand::with_base_displ(Register::RSP, offset);
        encoded(&[
            change(Code::Sub_rm64_imm32, bytes).expect("fits"),
            Instruction::with2(Code::Movdqu_xmmm128_xmm, place, Register::XMM3).expect("valid"),
            other,
            change(Code::Add_rm64_imm32, bytes).expect("fits"),
            Instruction::with(Code::Retnq),
        ])
    }

    fn sum(code: Code, [to, a, b]: [Register; 3]) -> Instruction {
        Instruction::with3(code, to, a, b).expect("valid")
    }

    fn narrow_sum() -> Instruction {
        let registers = [Register::XMM1, Register::XMM2, Register::XMM15];
        sum(Code::VEX_Vaddps_xmm_xmm_xmmm128, registers)
    }

    #[test]
    fn instructions_and_what_is_on_the_stack_become_twice_as_wide() {
        // Of 64 bytes of slots nothing moves, of what is behind all does.
        for (offset, moved) in [(0, 0), (48, 48), (64, 64), (80, 96), (240, 416)] {
            let code = widened(&function(256, offset, narrow_sum()), 64, STACK).expect("known");
            let found = instructions(&code).expect("a function");
            let [make, store, add, give_up, zero, end] = found[..] else { panic!("{found:?}") };
            assert_eq!((make.immediate(1), give_up.immediate(1)), (448, 448));
            assert_eq!(store.code(), Code::VEX_Vmovups_ymmm256_ymm);
            assert_eq!(
                (store.memory_displacement64(), store.op1_register()),
                (moved, Register::YMM3)
            );
            let registers = [Register::YMM1, Register::YMM2, Register::YMM15];
            assert_eq!(add, sum(Code::VEX_Vaddps_ymm_ymm_ymmm256, registers));
            assert_eq!([zero.code(), end.code()], [Code::VEX_Vzeroupper, Code::Retnq]);
        }
    }

    #[test]
    fn instructions_are_the_same_but_for_moves_and_logic() {
        use Mnemonic::*;
        let mut differing = Vec::new();
        for code in Code::values() {
            if let Some(wide) = encoding(code)
                && wide.mnemonic() != code.mnemonic()
            {
                differing.push(code.mnemonic());
            }
        }
        let moves = [Movapd, Movaps, Movdqa, Movdqu, Movdqu, Vmovdqa, Vmovdqu, Vmovdqu];
        let expected: Vec<_> = moves.into_iter().chain([Vpand, Vpor, Vpxor]).collect();
        differing.sort_by_key(|mnemonic| format!("{mnemonic:?}"));
        assert_eq!(differing, expected);
    }

    #[test]
    fn branches_lead_to_what_takes_an_instruction_s_place() {
        // Over the sum, to where the stack is given up.
        let branch = Instruction::with_branch(Code::Jb_rel8_64, 5).expect("valid");
        let mut all = vec![
            change(Code::Sub_rm64_imm32, 64).expect("fits"),
            branch,
            narrow_sum(),
            change(Code::Add_rm64_imm32, 64).expect("fits"),
            Instruction::with(Code::Retnq),
        ];
        all[3].set_ip(5);
        let found = instructions(&widened(&encoded(&all), 0, STACK).expect("known"));
        let found = found.expect("a function");
        assert_eq!(found[1].near_branch_target(), found[3].ip());
        assert_eq!((found[3].code(), found[3].immediate(1)), (Code::Add_rm64_imm32, 128));
        // Nor is there any way into the middle of an instruction.
        all[1] = Instruction::with_branch(Code::Jb_rel8_64, ORIGIN + 2).expect("valid");
        assert_eq!(widened(&encoded(&all), 0, STACK), None);
    }

    #[test]
    fn each_page_of_a_large_frame_is_touched() {
        let code = widened(&function(7 * PAGE / 2, 0, narrow_sum()), 0, STACK).expect("known");
        let found = instructions(&code).expect("a function");
        let touched = found.iter().filter(|one| one.code() == Code::Mov_rm32_imm32).count();
        let is_made = |one: &&Instruction| one.code() == Code::Sub_rm64_imm32;
        let made: u64 = found.iter().filter(is_made).map(|one| one.immediate(1)).sum();
        assert_eq!((touched, made), (7, 7 * PAGE as u64));
    }

    #[test]
    fn what_is_not_known_stays_as_it_is() {
        let registers = [Register::XMM1, Register::XMM2, Register::XMM3];
        let shuffle = sum(Code::VEX_Vpshufb_xmm_xmm_xmmm128, registers);
        let below = MemoryOperand::with_base_displ(Register::RSP, -8);
        let below = Instruction::with2(Code::Mov_r64_rm64, Register::RAX, below).expect("valid");
        let call = Instruction::with_branch(Code::Call_rel32_64, ORIGIN).expect("valid");
        let through = Instruction::with1(Code::Call_rm64, Register::RAX).expect("valid");
        let code = Code::VEX_Vpshufd_xmm_xmmm128_imm8;
        let halves = Instruction::with3(code, Register::XMM1, Register::XMM2, 0b01_00_01_00_u32);
        let halves = halves.expect("valid");
        for other in [shuffle, below, call, through, halves] {
            assert_eq!(widened(&function(256, 64, other), 0, STACK), None, "{other:?}");
        }
        assert_eq!(widened(&function(256, 64, narrow_sum()), 48, STACK), None);
        let too_large = function(i64::from(STACK) / 2 + 16, 0, narrow_sum());
        assert_eq!(widened(&too_large, 0, STACK), None);
        // Neither is what does not end.
        assert_eq!(widened(&encoded(&[narrow_sum()]), 0, STACK), None);
    }
}
