//! Spilled vectors kept in registers that Cranelift does not use.
//!
//! For 512 bits there are 32 vector registers, twice as many as Cranelift uses. From one write to a
//! place on the stack until the next, a register can replace the place, which is faster.

use super::is_of_vectors;
use iced_x86::{Code, Instruction, OpKind, Register};
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

/// The registers ZMM16 to ZMM31, which Cranelift does not use.
const REGISTERS: u32 = 16;
const FIRST: Register = Register::ZMM16;

/// For each instruction, the register that replaces its operand on the stack, if there is one.
/// `blocks` has the block number of each instruction. The first `slots` bytes stay on the stack,
/// since code may refer to them by address.
pub fn registers(read: &[Instruction], blocks: &[usize], slots: u32) -> Vec<Option<Register>> {
    let mut spans = spans(read, blocks, slots);
    // A span's price is its length in instructions, divided by the number of its uses. The cheapest
    // spans get registers first.
    let price = |span: &SpillSpan| {
        (span.lifetime.end() - span.lifetime.start() + 1) as f64 / span.uses.len() as f64
    };
    spans.sort_by(|a, b| price(a).total_cmp(&price(b)));
    // For each register, the spans that occupy it: a map from their starts to their ends. A map is
    // fast even for many thousand spans.
    let mut taken: Vec<BTreeMap<usize, usize>> = vec![BTreeMap::new(); REGISTERS as usize];
    let mut registers = vec![None; read.len()];
    for span in spans {
        let is_free = |taken: &BTreeMap<usize, usize>| {
            let last = taken.range(..=span.lifetime.end()).next_back();
            last.is_none_or(|(_, end)| end < span.lifetime.start())
        };
        if let Some(number) = taken.iter().position(is_free) {
            for instruction in span.uses {
                registers[instruction] = Some(FIRST + number as u32);
            }
            let (start, end) = span.lifetime.into_inner();
            taken[number].insert(start, end);
        }
    }
    registers
}

pub fn replace_memory_operand(instruction: &mut Instruction, register: Register) {
    for operand in 0..instruction.op_count() {
        if instruction.op_kind(operand) == OpKind::Memory {
            instruction.set_op_kind(operand, OpKind::Register);
            instruction.set_op_register(operand, register);
        }
    }
}

/// A range of instructions in which a place on the stack holds one vector. `uses` are the
/// instructions that read or write the place.
struct SpillSpan {
    uses: Vec<usize>,
    lifetime: RangeInclusive<usize>,
}

/// The instructions in which a place on the stack holds a spilled vector, for each such place at an
/// offset of at least `slots`.
fn spans(read: &[Instruction], blocks: &[usize], slots: u32) -> Vec<SpillSpan> {
    let mut places = BTreeMap::<u64, Vec<usize>>::new();
    for (number, instruction) in read.iter().enumerate() {
        if instruction.memory_base() == Register::RSP {
            places.entry(instruction.memory_displacement64()).or_default().push(number);
        }
    }
    let is_whole = |instruction: &Instruction| {
        is_of_vectors(instruction) && instruction.code() != Code::VEX_Vcvtps2pd_xmm_xmmm64
    };
    let is_write = |number: usize| read[number].op0_kind() == OpKind::Memory;
    let mut spans = Vec::new();
    for (place, uses) in places {
        if place < u64::from(slots) || !uses.iter().all(|&number| is_whole(&read[number])) {
            continue;
        }
        let is_local =
            is_write(uses[0]) && uses.iter().all(|&number| blocks[number] == blocks[uses[0]]);
        if is_local {
            // A span ends before the next write.
            spans.extend(uses.chunk_by(|_, &next| !is_write(next)).map(|uses| SpillSpan {
                uses: uses.to_vec(),
                lifetime: uses[0]..=uses[uses.len() - 1],
            }));
        } else {
            // The vector may live on from one iteration of a loop to the next.
            spans.push(SpillSpan { uses, lifetime: 0..=read.len() });
        }
    }
    spans
}

/// For each instruction, the number of its basic block.
pub fn blocks(read: &[Instruction]) -> Vec<usize> {
    let mut targets: Vec<u64> = read.iter().filter_map(super::target).collect();
    targets.sort_unstable();
    let mut block = 0;
    let number = |instruction: &Instruction| {
        block += usize::from(targets.binary_search(&instruction.ip()).is_ok());
        let here = block;
        block += usize::from(super::target(instruction).is_some());
        here
    };
    read.iter().map(number).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use iced_x86::MemoryOperand;

    fn place(offset: i64) -> MemoryOperand {
        MemoryOperand::with_base_displ(Register::RSP, offset)
    }

    fn write(offset: i64) -> Instruction {
        let code = Code::VEX_Vmovups_xmmm128_xmm;
        Instruction::with2(code, place(offset), Register::XMM1).expect("valid")
    }

    fn read(offset: i64) -> Instruction {
        let code = Code::VEX_Vaddps_xmm_xmm_xmmm128;
        let [to, a] = [Register::XMM1, Register::XMM2];
        Instruction::with3(code, to, a, place(offset)).expect("valid")
    }

    /// The registers that replace operands of `read`, counted from [`FIRST`].
    fn found(read: &[Instruction]) -> Vec<Option<u32>> {
        let number = |register: Register| register as u32 - FIRST as u32;
        registers(read, &blocks(read), 0).into_iter().map(|register| register.map(number)).collect()
    }

    #[test]
    fn what_is_needed_at_once_has_registers_of_its_own() {
        let apart = [write(0), read(0), write(16), read(16), write(0), read(0)];
        assert_eq!(found(&apart), [Some(0); 6]);
        let all = found(&[write(0), write(16), read(0), read(16)]);
        assert_eq!(all[..2], all[2..]);
        assert_ne!(all[0], all[1]);
    }

    #[test]
    fn what_has_no_register_stays_where_it_is() {
        // Twenty vectors are live at once, but there are 16 registers. Two of the vectors are read
        // once, the others twice.
        let places = || (0..20).map(|k| 16 * k);
        let again = places().take(18).map(read);
        let all: Vec<_> = places().map(write).chain(places().map(read)).chain(again).collect();
        let registers = found(&all);
        let [written, read] = [&registers[..20], &registers[20..40]];
        assert_eq!(written, read);
        assert_eq!(written.iter().flatten().count(), REGISTERS as usize);
        assert_eq!(registers[40..], written[..18]);
    }

    #[test]
    fn a_vector_that_outlasts_its_block_keeps_its_register() {
        // A loop in which an iteration reads a vector that the previous iteration wrote.
        let mut all = vec![read(0), write(16), read(16), write(0), write(32), read(32)];
        let back = Instruction::with_branch(Code::Jb_rel32_64, 1).expect("valid");
        all.push(back);
        for (k, instruction) in all.iter_mut().enumerate() {
            instruction.set_ip(1 + k as u64);
        }
        let registers = found(&all);
        assert_eq!(registers[0], registers[3]);
        for other in [1, 2, 4, 5] {
            assert!(registers[other].is_some() && registers[other] != registers[0]);
        }
        // A vector that is read after a branch keeps its register as well.
        let branch = Instruction::with_branch(Code::Jb_rel32_64, 5).expect("valid");
        let registers = found(&[write(0), branch, write(16), read(16), read(0)]);
        assert_eq!(registers[0], registers[4]);
        assert!(registers[0].is_some() && registers[2] != registers[0]);
    }

    #[test]
    fn only_whole_vectors_are_kept_in_registers() {
        let scalar = Instruction::with2(Code::Mov_r64_rm64, Register::RAX, place(0));
        assert_eq!(found(&[write(0), read(0), scalar.expect("valid")]), [None; 3]);
        let half = Code::VEX_Vcvtps2pd_xmm_xmmm64;
        let half = Instruction::with2(half, Register::XMM1, place(0)).expect("valid");
        assert_eq!(found(&[write(0), half]), [None; 2]);
        assert_eq!(registers(&[write(48), read(48)], &[0; 2], 64), [None; 2]);
    }
}
