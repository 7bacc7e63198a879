//! Branches of a box. On a branch, a function that jumps has one value, or a divisor has one sign.
//!
//! This module splits a box by one function only. It combines no branches of several functions.

use crate::bounds::Interval;
use crate::enclosure::Exponent;
use zeroset_ops::{Class, Continuity, Law, Op};

/// The part of a box over which an operation is enclosed.
///
/// A function that jumps splits a box into two or three branches, by the function's value. A
/// function with a pole splits a box into two, by the sign of its divisor. The branches of a
/// [`Split`] cover the box, so a claim that holds on each branch holds on the box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Branch {
    /// The whole box.
    Whole,
    /// The part where an integer-valued function takes its lowest value, a choice takes its first
    /// branch, a divisor is negative, or an angle is below its cut.
    Low,
    /// The box without [`Branch::Low`].
    Rest,
    /// The part where an integer-valued function takes neither its lowest nor its highest value.
    Middle,
    /// The part where an integer-valued function takes its highest value.
    High,
}

/// The way in which an operation splits a box into branches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Split {
    /// The box is not split.
    Whole,
    /// Two branches, split at a pole by the sign of the divisor.
    AtPole,
    /// Two branches, split at a jump.
    AtJump,
    /// Three branches, split at two jumps.
    AtBothJumps,
}

impl Split {
    /// Returns how `op` splits a box. Over the box, each operand lies within its entry of `ranges`.
    /// `exponent` is the last operand's kind as an exponent.
    pub fn of(op: Op, ranges: &[Interval], exponent: Exponent) -> Self {
        let straddles = |range: &Interval| range.lo < 0.0 && range.hi > 0.0;
        let row = op.row();
        if row.continuity == Continuity::Jumps {
            let twice = row.class == Class::Function(Law::Sign);
            return if twice { Self::AtBothJumps } else { Self::AtJump };
        }
        let is_pole = match row.class {
            Class::Quotient => straddles(&ranges[1]),
            // Only odd powers have different signs on the two sides of their pole.
            Class::Power => match exponent {
                Exponent::Integer(n) => n < 0 && n % 2 != 0 && straddles(&ranges[0]),
                Exponent::Real | Exponent::LargeInteger { .. } => false,
            },
            Class::Negation
            | Class::Sum
            | Class::Product
            | Class::Square
            | Class::Remainder
            | Class::FunctionOfTwo
            | Class::Extremum
            | Class::Choice
            | Class::Fallback
            | Class::Restriction(_)
            | Class::Function(_) => false,
        };
        if is_pole { Self::AtPole } else { Self::Whole }
    }

    /// Returns the branches of the split, which together cover the box.
    pub fn branches(self) -> &'static [Branch] {
        match self {
            Self::Whole => &[Branch::Whole],
            Self::AtPole | Self::AtJump => &[Branch::Low, Branch::Rest],
            Self::AtBothJumps => &[Branch::Low, Branch::Middle, Branch::High],
        }
    }
}
