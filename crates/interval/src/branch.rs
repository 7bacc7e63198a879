//! Branches over a box: parts in which a function that jumps has one value, or stays on one side of
//! a pole.
//!
//! This module splits a box by one function only; it does not combine the branches of several.

use crate::bounds::Interval;
use crate::enclosure::Exponent;
use zeroset_ops::{Class, Continuity, Law, Op};

/// The part of a box over which an operation is enclosed.
///
/// A function that jumps splits a box into two or three branches by its own value. A function with
/// a pole splits it into two, by the sign of its divisor. The branches of one [`Split`] cover the
/// box, so a claim that holds over each branch holds over the box.
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
    /// Two branches, split where the divisor changes sign.
    AtPole,
    /// Two branches, split at a jump.
    AtJump,
    /// Three branches, split at two jumps.
    AtBothJumps,
}

impl Split {
    /// Returns how `op` splits a box over which its operands lie within `ranges`, one per operand.
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
            // An even power tends to the same infinity on both sides of its pole.
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

    /// The branches, which together cover the box.
    pub fn branches(self) -> &'static [Branch] {
        match self {
            Self::Whole => &[Branch::Whole],
            Self::AtPole | Self::AtJump => &[Branch::Low, Branch::Rest],
            Self::AtBothJumps => &[Branch::Low, Branch::Middle, Branch::High],
        }
    }
}
