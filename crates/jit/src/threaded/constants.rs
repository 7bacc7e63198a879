//! The constants of a tape as the stencils of one query read them.

use super::{ALIGNMENT, TOO_LARGE};
use crate::error::Error;
use zeroset_eval::{Clauses, Real, Step, Tape};
use zeroset_interval::Vector128;

/// Constants and parameters. They are stored where stencils read them: once for all steps that are
/// called on their own, and in the table of each clause.
pub(super) struct Constants {
    /// Per step, where its lanes begin and end.
    of: Vec<[u32; 2]>,
    /// One lane of each vector of each constant.
    lanes: Vec<[u8; 8]>,
    /// The vectors that are stored.
    pub bytes: Vec<u8>,
    width: usize,
}

impl Constants {
    /// No constants yet, for a tape of this many steps.
    pub fn new(steps: usize, width: usize) -> Self {
        Self { of: vec![[0; 2]; steps], lanes: Vec::new(), bytes: Vec::new(), width }
    }

    /// Adds a vector of a constant, whose lanes are equal.
    pub fn add(&mut self, index: usize, vector: Vector128) {
        let lane = match vector {
            Vector128::F32([lane, ..]) => u64::from(lane) << 32 | u64::from(lane),
            Vector128::F64([lane, _]) => lane,
        };
        let end = self.lanes.len() as u32;
        let [first, last] = &mut self.of[index];
        if *last == 0 {
            *first = end;
        }
        *last = end + 1;
        self.lanes.push(lane.to_ne_bytes());
    }

    /// Stores constants one after another. Returns the offset of the first.
    pub fn store(&mut self, indices: impl IntoIterator<Item = usize>) -> Result<u32, Error> {
        let at = u32::try_from(self.bytes.len()).map_err(|_| TOO_LARGE)?;
        for index in indices {
            let [first, end] = self.of[index].map(|at| at as usize);
            for lane in &self.lanes[first..end] {
                let lanes = [*lane; ALIGNMENT / 8];
                self.bytes.extend_from_slice(&lanes.as_flattened()[..self.width]);
            }
        }
        Ok(at)
    }
}

/// Per step, whether a step or a clause that is called on its own uses it, or it is a result.
pub(super) fn used_directly<T: Real>(tape: &Tape<T>, clauses: &Clauses) -> Vec<bool> {
    let mut is_used = vec![false; tape.steps().len()];
    for (index, step) in tape.steps().iter().enumerate() {
        if clauses.is_in_shape(index) {
            continue;
        }
        let Step::Apply(_, operands) = step else { continue };
        let clause = clauses.ending_with(index).filter(|clause| clause.shape.is_some());
        let operands = clause.map_or(&operands[..], |clause| &clause.used[..]);
        for &operand in operands {
            is_used[operand] = true;
        }
    }
    for &output in tape.outputs_at() {
        is_used[output] = true;
    }
    is_used
}
