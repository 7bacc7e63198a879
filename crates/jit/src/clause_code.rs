//! The code of a clause: its operations in one stencil.
//!
//! Clauses that differ in their constants alone share it. It loads coordinates from their fixed
//! places in the frame, and constants from a table for each clause. Its values have the bits that
//! the stencils of its steps would compute one after another.

use crate::lanes::{Emitter, LaneVector};
use crate::stencil::{CodeTerm, OperandNumber, StencilOperand, load, load_at, parts};
use crate::stencil_code::StencilFrame;
use smallvec::SmallVec;
use zeroset_eval::{ClauseOperand, Query, Real, Tape, ValueKind};
use zeroset_interval::{Exponent, Interval, Term};
use zeroset_ops::Op;

/// Place of the table of constants among those of a call.
pub const TABLE: usize = 1;
/// Place of the first step that a clause uses among those of a call.
pub const USED: usize = 2;

/// An operand of an operation of a clause.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CodeOperand {
    /// A coordinate or a constant.
    Outside(ClauseOperand, OperandNumber),
    /// An earlier step of the clause, by its place there.
    Inside(u32),
    /// A step that the clause uses, by its place among those.
    Used(u8),
}

/// An operation of a clause.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct CodeStep {
    pub op: Op,
    pub operands: SmallVec<[CodeOperand; 3]>,
    /// Bits of the ends of its range.
    range: [u64; 2],
}

impl CodeStep {
    pub fn new(op: Op, operands: SmallVec<[CodeOperand; 3]>, range: Interval) -> Self {
        Self { op, operands, range: [range.lo, range.hi].map(f64::to_bits) }
    }

    fn range(&self) -> Interval {
        let [lo, hi] = self.range.map(f64::from_bits);
        Interval { lo, hi }
    }
}

/// The operations of a clause.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct ClauseCode {
    pub steps: Vec<CodeStep>,
    /// The numbers of the steps that it uses, for which the ranges of its steps hold.
    pub used: SmallVec<[OperandNumber; 3]>,
}

impl ClauseCode {
    /// Returns the numbers of the operands: first of the steps that it uses, which may be others
    /// than its own, then of coordinates and constants in the order of the operations.
    pub fn operands<'a>(
        &'a self,
        used: &'a [OperandNumber],
    ) -> impl Iterator<Item = &'a OperandNumber> {
        let operands = self.steps.iter().flat_map(|step| &step.operands);
        let outside = operands.filter_map(|operand| match operand {
            CodeOperand::Outside(_, number) => Some(number),
            CodeOperand::Inside(_) | CodeOperand::Used(_) => None,
        });
        used.iter().chain(outside)
    }

    /// Returns the ranges of the steps if the clause uses steps with these numbers.
    pub fn ranges<Q: Query, T: Real>(
        &self,
        used: &[OperandNumber],
        operands: &[StencilOperand<Q>],
    ) -> Vec<Interval> {
        let mut ranges = Vec::with_capacity(self.steps.len());
        let (others, outside) = operands.split_at(used.len());
        let mut outside = outside.iter();
        for step in &self.steps {
            if used == &self.used[..] {
                ranges.push(step.range());
                continue;
            }
            let of = |one: &StencilOperand<Q>| (one.range, one.exponent);
            let operands = step.operands.iter().map(|operand| match operand {
                CodeOperand::Outside(..) => of(outside.next().expect("an operand")),
                CodeOperand::Inside(place) => (ranges[*place as usize], Exponent::Real),
                CodeOperand::Used(place) => of(&others[usize::from(*place)]),
            });
            let operands: SmallVec<[_; 3]> = operands.collect();
            ranges.push(Tape::<T>::coarse_range(step.op, &operands));
        }
        ranges
    }

    /// Emits the operations. Returns the value of the last.
    pub fn emit<Q: Query, T: Real>(
        &self,
        emitter: &mut Emitter<'_, '_>,
        frame: &StencilFrame<T>,
        used: &[OperandNumber],
        operands: &[StencilOperand<Q>],
    ) -> <Q::Kind as ValueKind>::Value<LaneVector> {
        let ranges = self.ranges::<Q, T>(used, operands);
        let (others, outside) = operands.split_at(used.len());
        let used = load::<Q, T>(emitter, frame, others, USED);
        let table = frame.address(emitter, TABLE, true);
        let mut in_table = 0;
        let mut outside = outside.iter();
        let mut axes: [Option<CodeTerm<Q>>; 3] = [None; 3];
        let mut values: Vec<CodeTerm<Q>> = Vec::with_capacity(self.steps.len());
        for (step, range) in self.steps.iter().zip(ranges) {
            let mut terms = SmallVec::<[CodeTerm<Q>; 3]>::new();
            for operand in &step.operands {
                terms.push(match operand {
                    CodeOperand::Used(place) => used[usize::from(*place)],
                    CodeOperand::Inside(place) => values[*place as usize],
                    CodeOperand::Outside(kind, _) => {
                        let operand = outside.next().expect("an operand");
                        let parts = parts::<Q>(&operand.shape);
                        if let ClauseOperand::Coordinate(axis) = kind {
                            let axis = *axis as usize;
                            *axes[axis].get_or_insert_with(|| {
                                let base = frame.start();
                                load_at::<Q, T>(emitter, frame, operand, base, axis * parts)
                            })
                        } else {
                            in_table += parts;
                            let first = in_table - parts;
                            load_at::<Q, T>(emitter, frame, operand, table, first)
                        }
                    }
                });
            }
            let value = Q::Kind::apply::<T, _>(emitter, step.op, &terms);
            let value = Q::Kind::settled::<T, _>(emitter, value);
            values.push(Term { value, range, exponent: Exponent::Real });
        }
        values.last().expect("a step").value
    }
}
