//! The calls of a clause, which are laid out once.

use super::{Slots, TapeStep};
use crate::stencil_code::StencilCall;
use zeroset_eval::{Clause, Real, Step, Tape};

/// A place of a call in a clause.
#[derive(Clone, Copy)]
enum ClausePlace {
    /// Among the constants.
    Constant,
    /// Among the values inside of clauses.
    Inside,
    /// The clause's own value.
    Value,
    /// A step that the clause uses, by its number there.
    Used(u8),
    /// The coordinate with this number.
    Axis(u8),
}

/// The calls of a clause, from the last to the first. Their places are relative.
pub(super) struct ClauseCalls(Vec<(StencilCall, [ClausePlace; 4])>);

impl ClauseCalls {
    /// Lays out the calls of a clause. Then `slots` ends behind the values inside of it.
    pub fn new<T: Real>(
        tape: &Tape<T>,
        steps: &[TapeStep],
        clause: &Clause,
        width: usize,
        slots: &mut Slots,
    ) -> Self {
        let inside = &clause.steps;
        slots.start(inside.len(), 0, width);
        let mut calls = Vec::with_capacity(inside.len());
        for (position, &index) in inside.iter().enumerate().rev() {
            let value = steps[index as usize].value;
            let is_last = position + 1 == inside.len();
            let mut kinds = [ClausePlace::Constant; 4];
            let mut call = StencilCall::new(value.entry, 0);
            if is_last {
                kinds[0] = ClausePlace::Value;
            } else {
                kinds[0] = ClausePlace::Inside;
                call.places[0] = slots.place(position, value.parts);
            }
            let Step::Apply(_, operands) = &tape.steps()[index as usize] else {
                unreachable!("an operation")
            };
            for ((at, kind), &operand) in
                call.places[1..].iter_mut().zip(&mut kinds[1..]).zip(operands)
            {
                *kind = match &tape.steps()[operand] {
                    Step::Constant(..) | Step::Parameter(_) => {
                        *at = steps[operand].at;
                        ClausePlace::Constant
                    }
                    Step::Coordinate(axis) => ClausePlace::Axis(*axis as u8),
                    Step::Apply(..) => {
                        if let Ok(position) = inside.binary_search(&(operand as u32)) {
                            *at = slots.place(position, steps[operand].value.parts);
                            ClausePlace::Inside
                        } else {
                            let number = clause.used.iter().position(|&used| used == operand);
                            ClausePlace::Used(number.expect("a step that the clause uses") as u8)
                        }
                    }
                };
            }
            if !is_last {
                // As for calls outside of clauses.
                slots.give(position, value.parts);
            }
            calls.push((call, kinds));
        }
        Self(calls)
    }

    /// The calls, from the last to the first, with the offsets of the values inside, of the
    /// clause's value, of the steps that it uses, and of the coordinates.
    pub fn calls(
        &self,
        inside: u32,
        value: u32,
        used: &[u32; 3],
        axes: &[u32; 3],
    ) -> impl Iterator<Item = StencilCall> {
        self.0.iter().map(move |&(mut call, kinds)| {
            for (place, kind) in call.places.iter_mut().zip(kinds) {
                *place = match kind {
                    ClausePlace::Constant => *place,
                    ClausePlace::Inside => inside + *place,
                    ClausePlace::Value => value,
                    ClausePlace::Used(number) => used[number as usize],
                    ClausePlace::Axis(axis) => axes[axis as usize],
                };
            }
            call
        })
    }
}
