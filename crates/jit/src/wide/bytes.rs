//! Encoding of instructions as bytes, followed by the constants that they read.

use super::target;
use iced_x86::{Encoder, Instruction};

/// Encodes a function. If an instruction reads a constant, its displacement is the constant's
/// position in `constants`. The result has `constants` at a multiple of `alignment` bytes. A branch
/// leads to the first of the instructions that replace its target. Returns `None` if a branch has
/// no target, if it stores its distance in one byte, or if an instruction has no encoding.
pub fn bytes(written: &[Instruction], constants: &[u8], alignment: usize) -> Option<Vec<u8>> {
    let mut encoder = Encoder::new(64);
    let mut starts = Vec::with_capacity(written.len());
    // Distances to fill in later. Each has its position, the address from which it counts, and its
    // target.
    let (mut branches, mut references) = (Vec::new(), Vec::new());
    let mut end = 0;
    for instruction in written {
        let (start, mut instruction) = (end, *instruction);
        if instruction.ip() != 0 {
            starts.push((instruction.ip(), start));
        }
        let branch = target(&instruction);
        let constant = instruction.is_ip_rel_memory_operand();
        let place = instruction.memory_displacement64();
        if branch.is_some() {
            instruction.set_near_branch64(start);
        } else if constant {
            instruction.set_memory_displacement64(start);
        }
        end += encoder.encode(&instruction, start).ok()? as u64;
        let inside = encoder.get_constant_offsets();
        if let Some(target) = branch {
            if inside.immediate_size() != size_of::<i32>() {
                return None;
            }
            branches.push((start as usize + inside.immediate_offset(), end, target));
        } else if constant {
            references.push((start as usize + inside.displacement_offset(), end, place));
        }
    }
    let mut bytes = encoder.take_buffer();
    bytes.resize(bytes.len().next_multiple_of(alignment), 0);
    let first = bytes.len() as u64;
    let mut write = |(at, from, to): (usize, u64, u64)| {
        let distance = i32::try_from(to as i64 - from as i64).ok()?;
        *bytes.get_mut(at..)?.first_chunk_mut()? = distance.to_le_bytes();
        Some(())
    };
    for (at, from, target) in branches {
        let place = starts.binary_search_by_key(&target, |(ip, _)| *ip).ok()?;
        write((at, from, starts[place].1))?;
    }
    references.into_iter().try_for_each(|(at, from, to)| write((at, from, first + to)))?;
    bytes.extend(constants);
    Some(bytes)
}
