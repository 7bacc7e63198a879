//! Reuse of bits in mask registers.
//!
//! With vectors of 512 bits, a comparison writes a bit per lane to a mask register, and a blend
//! reads such bits. Code translated instruction by instruction expands the bits to a vector and
//! gathers them again. Within a block, this module finds the mask registers that still hold the
//! bits.

use super::target;
use iced_x86::{Code, Instruction, Mnemonic, OpKind, Register};

/// The mask registers in use are K1 to K7. K0 means no mask.
const REGISTERS: u32 = 7;
const FIRST: Register = Register::K1;
const VECTORS: usize = 32;

/// Removes instructions that gather bits which a mask register still holds. Then removes
/// instructions whose vectors are never read. `blocks` has the block number of each instruction.
/// Branches must lead to the first instruction of a block.
pub fn kept(written: Vec<Instruction>, blocks: Vec<usize>) -> Vec<Instruction> {
    let targets: Vec<u64> = written.iter().filter_map(target).collect();
    let (written, blocks) = with_bits(written, blocks);
    let mut is_needed = vec![true; written.len()];
    let (mut needs, mut block) = (Needs::default(), usize::MAX);
    for (number, instruction) in written.iter().enumerate().rev() {
        if blocks[number] != block {
            (needs, block) = (Needs::default(), blocks[number]);
        }
        is_needed[number] = needs.needs(instruction) || targets.contains(&instruction.ip());
        if is_needed[number] {
            needs.go_back(instruction);
        }
    }
    let mut is_needed = is_needed.into_iter();
    written.into_iter().filter(|_| is_needed.next() == Some(true)).collect()
}

/// Lets instructions read bits from the mask registers that hold them. `written` uses only one mask
/// register, and reads it directly after each write. The result uses all mask registers in turn.
fn with_bits(written: Vec<Instruction>, blocks: Vec<usize>) -> (Vec<Instruction>, Vec<usize>) {
    let (mut code, mut numbers) = (Vec::with_capacity(written.len()), Vec::new());
    let (mut bits, mut last) = (Bits::default(), usize::MAX);
    let mut given = None;
    for (mut instruction, block) in written.into_iter().zip(blocks) {
        if block != last {
            (bits.known, last) = (Known::default(), block);
        }
        let [to, a, b] = [0, 1, 2].map(|operand| instruction.op_register(operand));
        if let Some(register) = given.take() {
            bits.set(to, None);
            if instruction.op_mask() == Register::None {
                instruction.set_op1_register(register);
                if let Some(lanes) = spread(instruction.code()) {
                    bits.set(to, Some((register, lanes)));
                }
            } else {
                instruction.set_op_mask(register);
            }
        } else if let Some(lanes) = gathered(instruction.code()) {
            if let Some((register, known)) = bits.of(a)
                && known == lanes
            {
                given = Some(register);
                continue;
            }
            let register = bits.fresh();
            bits.set(a, Some((register, lanes)));
            instruction.set_op0_register(register);
            given = Some(register);
        } else if to.is_k() {
            let register = bits.fresh();
            instruction.set_op0_register(register);
            given = Some(register);
        } else if let Some(logic) = logic(instruction.code())
            && let (Some((a, lanes)), Some((b, others))) = (bits.of(a), bits.of(b))
            && lanes == others
        {
            let register = bits.fresh();
            code.extend(Instruction::with3(logic, register, a, b));
            numbers.push(block);
            bits.set(to, Some((register, lanes)));
        } else {
            bits.set(to, bits.of(a).filter(|_| is_move(&instruction)));
        }
        code.push(instruction);
        numbers.push(block);
    }
    (code, numbers)
}

/// Per vector register, the mask register that holds the signs of its lanes, and the number of
/// lanes.
type Known = [Option<(Register, u32)>; VECTORS];

/// The mask registers that hold the signs of vectors' lanes.
#[derive(Default)]
struct Bits {
    known: Known,
    next: u32,
}

impl Bits {
    fn of(&self, vector: Register) -> Option<(Register, u32)> {
        self.known[number(vector)?]
    }

    fn set(&mut self, vector: Register, bits: Option<(Register, u32)>) {
        if let Some(number) = number(vector) {
            self.known[number] = bits;
        }
    }

    /// Returns the next mask register in turn, and forgets which bits it holds.
    fn fresh(&mut self) -> Register {
        let register = FIRST + self.next % REGISTERS;
        self.next += 1;
        for known in &mut self.known {
            *known = known.filter(|(other, _)| *other != register);
        }
        register
    }
}

/// The registers that later code in a block reads, one bit per register.
#[derive(Default)]
struct Needs {
    /// Vector registers that later code in the block overwrites before it reads them. All others
    /// may be read, even after the block.
    lost: u32,
    /// Mask registers that later code in the block reads. Code after the block reads none.
    read: u32,
}

impl Needs {
    /// Returns whether the result of an instruction is needed.
    fn needs(&self, instruction: &Instruction) -> bool {
        let (to, code) = (instruction.op0_register(), instruction.code());
        if to.is_k() {
            return self.read & bit_of_bits(to) != 0;
        }
        let is_of_bits = spread(code).is_some() || logic(code).is_some() || is_move(instruction);
        !is_of_bits || self.lost & bit(to) == 0
    }

    /// Changes the sets from the state after an instruction to the state before it.
    fn go_back(&mut self, instruction: &Instruction) {
        let to = instruction.op0_register();
        self.lost |= bit(to);
        self.read &= !bit_of_bits(to);
        let first = u32::from(!reads_what_it_writes(instruction));
        for operand in first..instruction.op_count() {
            let register = instruction.op_register(operand);
            self.lost &= !bit(register);
            self.read |= bit_of_bits(register);
        }
        self.read |= bit_of_bits(instruction.op_mask());
    }
}

/// The bit of a vector register; 0 for other registers.
fn bit(vector: Register) -> u32 {
    number(vector).map_or(0, |number| 1 << number)
}

fn bit_of_bits(register: Register) -> u32 {
    if register.is_k() { 1 << (register as u32 - Register::K0 as u32) } else { 0 }
}

/// The number of a vector register. A 256-bit register has the number of the 512-bit register that
/// contains it.
fn number(vector: Register) -> Option<usize> {
    let first = match vector {
        _ if vector.is_zmm() => Register::ZMM0,
        _ if vector.is_ymm() => Register::YMM0,
        _ => return None,
    };
    Some(vector as usize - first as usize)
}

/// Returns whether an instruction is a fused multiply-add that reads the register it writes.
fn reads_what_it_writes(instruction: &Instruction) -> bool {
    use Mnemonic::{
        Vfmadd132pd, Vfmadd132ps, Vfmadd213pd, Vfmadd213ps, Vfmsub132pd, Vfmsub132ps, Vfmsub213pd,
        Vfmsub213ps,
    };
    matches!(
        instruction.mnemonic(),
        Vfmadd132pd
            | Vfmadd132ps
            | Vfmadd213pd
            | Vfmadd213ps
            | Vfmsub132pd
            | Vfmsub132ps
            | Vfmsub213pd
            | Vfmsub213ps
    )
}

/// Returns whether an instruction copies a vector from one register to another.
fn is_move(instruction: &Instruction) -> bool {
    let moves = [Code::EVEX_Vmovups_zmm_k1z_zmmm512, Code::EVEX_Vmovupd_zmm_k1z_zmmm512];
    moves.contains(&instruction.code()) && instruction.op1_kind() == OpKind::Register
}

/// Number of lanes whose signs an instruction gathers in a mask register.
fn gathered(code: Code) -> Option<u32> {
    match code {
        Code::EVEX_Vpmovd2m_kr_zmm => Some(16),
        Code::EVEX_Vpmovq2m_kr_zmm => Some(8),
        _ => None,
    }
}

/// Number of lanes to which an instruction expands the bits of a mask register.
fn spread(code: Code) -> Option<u32> {
    match code {
        Code::EVEX_Vpmovm2d_zmm_kr => Some(16),
        Code::EVEX_Vpmovm2q_zmm_kr => Some(8),
        _ => None,
    }
}

/// The instruction on mask registers that is equivalent to one on vectors.
fn logic(code: Code) -> Option<Code> {
    Some(match code {
        Code::EVEX_Vandps_zmm_k1z_zmm_zmmm512b32 | Code::EVEX_Vandpd_zmm_k1z_zmm_zmmm512b64 => {
            Code::VEX_Kandw_kr_kr_kr
        }
        Code::EVEX_Vorps_zmm_k1z_zmm_zmmm512b32 | Code::EVEX_Vorpd_zmm_k1z_zmm_zmmm512b64 => {
            Code::VEX_Korw_kr_kr_kr
        }
        Code::EVEX_Vxorps_zmm_k1z_zmm_zmmm512b32 | Code::EVEX_Vxorpd_zmm_k1z_zmm_zmmm512b64 => {
            Code::VEX_Kxorw_kr_kr_kr
        }
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use Register::{K1, ZMM0, ZMM1, ZMM2, ZMM3, ZMM4, ZMM5};

    fn with(code: Code, operands: &[Register]) -> Instruction {
        let mut instruction = Instruction::default();
        instruction.set_code(code);
        for (number, register) in (0..).zip(operands) {
            instruction.set_op_kind(number, OpKind::Register);
            instruction.set_op_register(number, *register);
        }
        instruction
    }

    /// Instructions that set the lanes of `to` in which `a` is less than `b`.
    fn compare(to: Register, [a, b]: [Register; 2]) -> [Instruction; 2] {
        let code = Code::EVEX_Vcmpps_kr_k1_zmm_zmmm512b32_imm8_sae;
        let mut less = Instruction::with4(code, K1, a, b, 1).expect("valid");
        less.set_op_mask(Register::None);
        [less, with(Code::EVEX_Vpmovm2d_zmm_kr, &[to, K1])]
    }

    /// Instructions that select each lane of `to` from `a` or `b`, by the lane's sign in `signs`.
    fn choose(to: Register, signs: Register, [a, b]: [Register; 2]) -> [Instruction; 2] {
        let mut blend = with(Code::EVEX_Vblendmps_zmm_k1z_zmm_zmmm512b32, &[to, a, b]);
        blend.set_op_mask(K1);
        [with(Code::EVEX_Vpmovd2m_kr_zmm, &[K1, signs]), blend]
    }

    fn add(to: Register, [a, b]: [Register; 2]) -> Instruction {
        with(Code::EVEX_Vaddps_zmm_k1z_zmm_zmmm512b32_er, &[to, a, b])
    }

    /// The mnemonics of the instructions that [`kept`] returns.
    fn left(written: Vec<Instruction>) -> Vec<Mnemonic> {
        let blocks = vec![0; written.len()];
        kept(written, blocks).iter().map(Instruction::mnemonic).collect()
    }

    #[test]
    fn what_was_compared_is_chosen_by_at_once() {
        use Mnemonic::{Vaddps, Vblendmps, Vcmpps, Vpmovm2d};
        let twice = || {
            let chosen = choose(ZMM3, ZMM0, [ZMM1, ZMM2]).into_iter();
            chosen.chain(choose(ZMM4, ZMM0, [ZMM2, ZMM1]))
        };
        let code: Vec<_> = compare(ZMM0, [ZMM1, ZMM2]).into_iter().chain(twice()).collect();
        // The comparison's vector stays, since code after the block may read it.
        assert_eq!(left(code.clone()), [Vcmpps, Vpmovm2d, Vblendmps, Vblendmps]);
        let lost: Vec<_> = code.into_iter().chain([add(ZMM0, [ZMM3, ZMM4])]).collect();
        assert_eq!(left(lost.clone()), [Vcmpps, Vblendmps, Vblendmps, Vaddps]);
        // The blends use the mask register of the comparison.
        let blocks = vec![0; lost.len()];
        let kept = kept(lost, blocks);
        assert!(kept[1..3].iter().all(|blend| blend.op_mask() == kept[0].op0_register()));
    }

    #[test]
    fn bits_are_not_taken_of_what_a_vector_was() {
        use Mnemonic::{Vaddps, Vblendmps, Vcmpps, Vpmovd2m, Vpmovm2d};
        let code = compare(ZMM0, [ZMM1, ZMM2]).into_iter().chain([add(ZMM0, [ZMM1, ZMM2])]);
        let code: Vec<_> = code.chain(choose(ZMM3, ZMM0, [ZMM1, ZMM2])).collect();
        assert_eq!(left(code), [Vaddps, Vpmovd2m, Vblendmps]);
        // Bits in mask registers of another block are not used either.
        let code = compare(ZMM0, [ZMM1, ZMM2]).into_iter().chain(choose(ZMM3, ZMM0, [ZMM1, ZMM2]));
        let kept = kept(code.collect(), vec![0, 0, 1, 1]);
        let kept: Vec<_> = kept.iter().map(Instruction::mnemonic).collect();
        assert_eq!(kept, [Vcmpps, Vpmovm2d, Vpmovd2m, Vblendmps]);
    }

    #[test]
    fn both_of_two_are_so_by_bits() {
        use Mnemonic::{Kandw, Vaddps, Vblendmps, Vcmpps};
        let and = with(Code::EVEX_Vandps_zmm_k1z_zmm_zmmm512b32, &[ZMM5, ZMM0, ZMM3]);
        let lost = [ZMM0, ZMM3, ZMM5].map(|to| add(to, [ZMM1, ZMM2]));
        let code = compare(ZMM0, [ZMM1, ZMM2]).into_iter().chain(compare(ZMM3, [ZMM2, ZMM1]));
        let code = code.chain([and]).chain(choose(ZMM4, ZMM5, [ZMM1, ZMM2])).chain(lost);
        let expected = [Vcmpps, Vcmpps, Kandw, Vblendmps, Vaddps, Vaddps, Vaddps];
        assert_eq!(left(code.collect()), expected);
    }

    #[test]
    fn where_registers_run_out_bits_are_made_again() {
        let vectors: Vec<Register> = (0..8).map(|k| ZMM0 + 8 + k).collect();
        let mut code = Vec::new();
        for vector in &vectors {
            code.extend(compare(*vector, [ZMM1, ZMM2]));
        }
        for vector in &vectors {
            code.extend(choose(ZMM3, *vector, [ZMM1, ZMM2]));
        }
        let made = left(code).into_iter().filter(|mnemonic| *mnemonic == Mnemonic::Vpmovd2m);
        // With eight sets of bits for seven registers, each new set replaces the one that is needed
        // next.
        assert_eq!(made.count(), 8);
        let mut code = Vec::new();
        for vector in &vectors[..7] {
            code.extend(compare(*vector, [ZMM1, ZMM2]));
        }
        for vector in &vectors[..7] {
            code.extend(choose(ZMM3, *vector, [ZMM1, ZMM2]));
        }
        assert!(!left(code).contains(&Mnemonic::Vpmovd2m));
    }
}
