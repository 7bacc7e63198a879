//! Calls of clauses: the code that clauses of one shape share, or a call for each step.

use super::{Slots, TapeStep};
use crate::clause_code::{ClauseCode, CodeOperand, CodeStep};
use crate::stencil::{ClauseNumber, OperandNumber, StencilFinder};
use crate::stencil_code::StencilCall;
use smallvec::SmallVec;
use zeroset_eval::{Clause, ClauseOperand, Query, Real, Step, Tape};
use zeroset_ops::Op;

/// A place of a call in a clause.
#[derive(Clone, Copy)]
pub(super) enum ClausePlace {
    /// Among the constants, or that of a coordinate.
    Fixed,
    /// Among the values inside of clauses.
    Inside,
    /// The clause's own value.
    Value,
    /// A step that the clause uses, by its number there.
    Used(u8),
}

/// The calls of all steps of a clause, from the last to the first. Their places are relative.
pub(super) struct ClauseSteps(Vec<(StencilCall, [ClausePlace; 4])>);

/// A tape whose steps up to the end of a clause have numbers.
#[derive(Clone, Copy)]
pub(super) struct ClauseIn<'a, T: Real> {
    pub tape: &'a Tape<T>,
    pub steps: &'a [TapeStep],
    pub clause: &'a Clause,
    pub width: usize,
}

impl<'a, T: Real> ClauseIn<'a, T> {
    /// Returns the operands of each operation, with their kinds.
    fn operands(self) -> impl Iterator<Item = (Op, usize, ClauseOperand)> + 'a {
        let Self { tape, clause, .. } = self;
        clause.operations(tape).flat_map(move |(op, operands)| {
            operands.iter().map(move |&operand| (op, operand, clause.operand(tape, operand)))
        })
    }

    /// Returns the constants of each operation.
    pub fn constants(self) -> impl Iterator<Item = usize> + 'a {
        self.operands().filter_map(|(_, operand, kind)| {
            matches!(kind, ClauseOperand::Constant(_)).then_some(operand)
        })
    }

    fn number(self, op: Op, operand: usize) -> OperandNumber {
        let TapeStep { value, exponent, .. } = &self.steps[operand];
        if op == Op::Pow { *exponent } else { value.number }
    }

    fn offset(self, operand: usize) -> u32 {
        let TapeStep { value, at, .. } = &self.steps[operand];
        match self.tape.steps()[operand] {
            Step::Coordinate(axis) => coordinate_offset(axis as usize, value.parts, self.width),
            _ => *at,
        }
    }

    /// Returns the operations of the clause.
    fn code(self) -> ClauseCode {
        let Self { tape, clause, .. } = self;
        let steps = clause.operations(tape).zip(&clause.steps).map(|((op, operands), &index)| {
            let operand = |&operand: &usize| match clause.operand(tape, operand) {
                ClauseOperand::Inside(place) => CodeOperand::Inside(place),
                ClauseOperand::Used(place) => CodeOperand::Used(place),
                kind => CodeOperand::Outside(kind, self.number(op, operand)),
            };
            let operands = operands.iter().map(operand).collect();
            CodeStep::new(op, operands, tape.range(index as usize))
        });
        ClauseCode { steps: steps.collect(), used: self.used() }
    }

    /// Returns the numbers of the steps that the clause uses.
    fn used(self) -> SmallVec<[OperandNumber; 3]> {
        self.clause.used.iter().map(|&used| self.steps[used].value.number).collect()
    }
}

/// The code that clauses of one shape share.
pub(super) struct SharedCode {
    pub number: ClauseNumber,
    pub code: &'static ClauseCode,
}

impl SharedCode {
    /// Returns the place of a clause's code among `codes`. `known` is the place for the last clause
    /// with its shape.
    pub fn find<Q: Query, T: Real>(
        codes: &mut Vec<Self>,
        known: &mut Option<usize>,
        clause: ClauseIn<'_, T>,
        finder: &mut StencilFinder<Q, T>,
    ) -> usize {
        let outside = clause.operands().filter(|(_, _, kind)| {
            matches!(kind, ClauseOperand::Coordinate(_) | ClauseOperand::Constant(_))
        });
        let outside = outside.map(|(op, operand, _)| clause.number(op, operand));
        let numbers: SmallVec<[_; 8]> = clause.used().into_iter().chain(outside).collect();
        let is_same = |&place: &usize| {
            let code = codes[place].code;
            code.operands(&code.used).eq(&numbers)
        };
        known.filter(is_same).unwrap_or_else(|| {
            let (number, code) = finder.keep_clause(clause.code());
            codes.push(Self { number, code });
            *known = Some(codes.len() - 1);
            codes.len() - 1
        })
    }
}

/// Returns the offset of a coordinate in a frame. `parts` is the number of its vectors.
pub(super) fn coordinate_offset(axis: usize, parts: u32, width: usize) -> u32 {
    (axis * parts as usize * width) as u32
}

impl ClauseSteps {
    /// Lays out the calls of the steps of a clause. Then `slots` ends behind the values inside.
    pub fn new<T: Real>(of: ClauseIn<'_, T>, slots: &mut Slots) -> Self {
        let ClauseIn { tape, steps, clause, width } = of;
        let inside = &clause.steps;
        slots.start(inside.len(), 0, width);
        let mut calls = Vec::with_capacity(inside.len());
        let operations: Vec<_> = clause.operations(tape).collect();
        for (position, &index) in inside.iter().enumerate().rev() {
            let value = steps[index as usize].value;
            let is_last = position + 1 == inside.len();
            let mut kinds = [ClausePlace::Fixed; 4];
            let mut call = StencilCall::new(value.entry, 0);
            if is_last {
                kinds[0] = ClausePlace::Value;
            } else {
                kinds[0] = ClausePlace::Inside;
                call.places[0] = slots.place(position, value.parts);
            }
            let places = call.places[1..].iter_mut().zip(&mut kinds[1..]);
            for ((at, kind), &operand) in places.zip(operations[position].1) {
                match clause.operand(tape, operand) {
                    ClauseOperand::Constant(_) | ClauseOperand::Coordinate(_) => {
                        *at = of.offset(operand);
                    }
                    ClauseOperand::Inside(place) => {
                        *at = slots.place(place as usize, steps[operand].value.parts);
                        *kind = ClausePlace::Inside;
                    }
                    ClauseOperand::Used(number) => *kind = ClausePlace::Used(number),
                }
            }
            if !is_last {
                // As for calls outside of clauses.
                slots.give(position, value.parts);
            }
            calls.push((call, kinds));
        }
        Self(calls)
    }

    /// Appends the calls, from the last to the first. `inside` and `value` are the offsets of the
    /// values inside and of the clause's value. `used` has the offset of each step that the clause
    /// uses.
    pub fn append(&self, calls: &mut Vec<StencilCall>, [inside, value]: [u32; 2], used: &[u32; 3]) {
        calls.extend(self.0.iter().map(|&(mut call, kinds)| {
            for (place, kind) in call.places.iter_mut().zip(kinds) {
                *place = match kind {
                    ClausePlace::Fixed => *place,
                    ClausePlace::Inside => inside + *place,
                    ClausePlace::Value => value,
                    ClausePlace::Used(number) => used[number as usize],
                };
            }
            call
        }));
    }
}
