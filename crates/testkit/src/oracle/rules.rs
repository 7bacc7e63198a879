//! The oracle's rule for each operation.

use super::power::{self, Exponent};
use super::rounded::{self, Rounded};
use super::span::Span;
use super::{Claim, Defined, elementary};
use zeroset_ops::{Class, Continuity, Law, Op};

/// Returns the claim about `op` applied to `operands`, of which `op` may ignore the last ones.
/// `exponent` describes the last operand and matters only for powers.
pub(super) fn apply(op: Op, operands: [Claim; 3], exponent: Exponent) -> Claim {
    if op == Op::SelectNegative {
        return select_negative(operands);
    }
    if op == Op::Otherwise {
        return otherwise(operands);
    }
    let [a, b, _] = operands.map(Claim::span);
    let everywhere = |value: Span| (value, Defined::Yes);
    let (value, local) = match op {
        Op::Neg => everywhere(a.neg()),
        Op::Abs => everywhere(a.abs()),
        Op::Sign => everywhere(a.increasing(|x| Rounded::exact(sign(x)))),
        Op::Floor => everywhere(a.increasing(|x| Rounded::exact(x.floor()))),
        Op::Ceil => everywhere(a.increasing(|x| Rounded::exact(x.ceil()))),
        Op::Round => everywhere(a.increasing(|x| Rounded::exact(x.round_ties_even()))),
        Op::Trunc => everywhere(a.increasing(|x| Rounded::exact(x.trunc()))),
        Op::Fract => everywhere(fract(a)),
        Op::Sqr => everywhere(a.sqr()),
        Op::Sqrt => (a.within(0.0, f64::INFINITY).increasing(rounded::sqrt), nonneg(a)),
        Op::Cbrt => everywhere(a.increasing(rounded::cbrt)),
        Op::Exp => everywhere(elementary::exp(a)),
        Op::Ln => (elementary::ln(a), positive(a)),
        Op::Log2 => (elementary::log2(a), positive(a)),
        Op::Log10 => (elementary::log10(a), positive(a)),
        Op::Sin => everywhere(elementary::sin(a)),
        Op::Cos => everywhere(elementary::cos(a)),
        // A cosine is 0 only at irrational numbers, so every range has numbers that are no pole.
        Op::Tan => (elementary::tan(a), Defined::decide(elementary::has_no_pole(a), true)),
        Op::Asin => (elementary::asin(a), within_one(a)),
        Op::Acos => (elementary::acos(a), within_one(a)),
        Op::Atan => everywhere(elementary::atan(a)),
        Op::Sinh => everywhere(elementary::sinh(a)),
        Op::Cosh => everywhere(elementary::cosh(a)),
        Op::Tanh => everywhere(elementary::tanh(a)),
        Op::Asinh => everywhere(elementary::asinh(a)),
        Op::Acosh => (elementary::acosh(a), Defined::decide(a.lo >= 1.0, a.hi >= 1.0)),
        Op::Atanh => (
            elementary::atanh(a),
            Defined::decide(a.lo > -1.0 && a.hi < 1.0, a.lo < 1.0 && a.hi > -1.0),
        ),
        Op::Erf => everywhere(elementary::erf(a)),
        Op::BesselJ0 | Op::BesselJ1 | Op::BesselJ2 | Op::BesselJ3 => {
            everywhere(elementary::bessel(op.bessel_order() as i32, a))
        }
        Op::Add => everywhere(a.add(b)),
        Op::Sub => everywhere(a.sub(b)),
        Op::Mul => everywhere(a.mul(b)),
        Op::Div => (a.div(b), nonzero(b)),
        Op::Pow => power::pow(operands[0], operands[1], exponent),
        Op::Mod => (modulo(a, b), nonzero(b)),
        Op::Atan2 => (
            elementary::atan2(a, b),
            Defined::decide(!a.has_zero() || !b.has_zero(), !a.is_zero() || !b.is_zero()),
        ),
        Op::Min => everywhere(Span::new(a.lo.min(b.lo), a.hi.min(b.hi))),
        Op::Max => everywhere(Span::new(a.lo.max(b.lo), a.hi.max(b.hi))),
        Op::SelectNegative | Op::Otherwise => {
            unreachable!("done above: their operands need not all be defined")
        }
        Op::WhereNonneg => (a, nonneg(b)),
        Op::WherePositive => (a, positive(b)),
        Op::WhereNonzero => (a, nonzero(b)),
        Op::WhereDefined => everywhere(a),
    };
    let defined =
        operands[..op.arity()].iter().fold(local, |all, operand| all.and(operand.defined));
    Claim::new(value, defined)
}

/// Whether `op` is certainly continuous where it is defined. `value` bounds its result, and
/// `values` bound its operands. `operands` tells which operands are continuous.
pub(super) fn is_continuous(
    op: Op,
    value: Claim,
    values: impl Iterator<Item = Claim>,
    operands: impl Iterator<Item = bool>,
) -> bool {
    let mut spans = [Span::ENTIRE; 3];
    spans.iter_mut().zip(values).for_each(|(span, value)| *span = value.span());
    let mut continuous = [true; 3];
    continuous.iter_mut().zip(operands).for_each(|(held, operand)| *held = operand);
    let [a, b, _] = spans;
    let all = continuous == [true; 3];
    let one_step = |steps: Span| steps.lo.floor() == steps.hi.floor() && steps.lo.is_finite();
    match (op.row().continuity, op.row().class) {
        (Continuity::Domain, _) => all,
        (Continuity::Jumps, Class::Choice) => {
            (a.hi < 0.0 && continuous[1]) || (a.lo >= 0.0 && continuous[2])
        }
        (Continuity::Jumps, Class::Remainder) => all && one_step(a.div(b)),
        (Continuity::Jumps, Class::Function(Law::Fraction)) => all && one_step(a),
        // Other operations are constant between their jumps. So a single value means no jump.
        (Continuity::Jumps, _) => all && value.lo == value.hi,
    }
}

fn nonneg(a: Span) -> Defined {
    Defined::decide(a.lo >= 0.0, a.hi >= 0.0)
}

fn positive(a: Span) -> Defined {
    Defined::decide(a.lo > 0.0, a.hi > 0.0)
}

fn nonzero(a: Span) -> Defined {
    Defined::decide(!a.has_zero(), !a.is_zero())
}

fn within_one(a: Span) -> Defined {
    Defined::decide(a.lo >= -1.0 && a.hi <= 1.0, a.lo <= 1.0 && a.hi >= -1.0)
}

fn sign(x: f64) -> f64 {
    if x > 0.0 {
        1.0
    } else if x < 0.0 {
        -1.0
    } else {
        0.0
    }
}

fn fract(a: Span) -> Span {
    let whole = a.lo.floor();
    if whole == a.hi.floor() && whole.is_finite() {
        a.sub(Span::point(whole)).within(0.0, 1.0)
    } else {
        Span::new(0.0, 1.0)
    }
}

/// a − b·⌊a/b⌋ for the members of `b` that are not 0.
fn modulo(a: Span, b: Span) -> Span {
    // The result lies between 0 and b.
    let (least, most) = (b.lo.min(0.0), b.hi.max(0.0));
    let quotient = a.div(b);
    let whole = quotient.lo.floor();
    if whole != quotient.hi.floor() || !whole.is_finite() {
        return Span::new(least, most);
    }
    // Here ⌊a/b⌋ is one number, so the result is linear in a and b. Each corner is rounded once.
    let corner = |a: f64, b: f64| rounded::mul_add(-whole, b, a);
    let corners = [corner(a.lo, b.lo), corner(a.lo, b.hi), corner(a.hi, b.lo), corner(a.hi, b.hi)];
    Span::of(&corners).within(least, most)
}

/// b where a < 0, c where a ≥ 0. The branch that is not chosen may be undefined.
fn select_negative([a, b, c]: [Claim; 3]) -> Claim {
    let chosen = if a.hi < 0.0 {
        b
    } else if a.lo >= 0.0 {
        c
    } else {
        match (b.defined, c.defined) {
            // An undefined branch contributes no value.
            (Defined::No, Defined::No) => b,
            (Defined::No, _) => Claim::new(c.span(), Defined::Unknown),
            (_, Defined::No) => Claim::new(b.span(), Defined::Unknown),
            (p, q) => Claim::new(b.span().union(c.span()), p.and(q)),
        }
    };
    Claim::new(chosen.span(), chosen.defined.and(a.defined))
}

/// a where it is defined, else b.
fn otherwise([a, b, _]: [Claim; 3]) -> Claim {
    match (a.defined, b.defined) {
        (Defined::No, _) => b,
        // If b is undefined, only a can give a value.
        (Defined::Yes, _) | (Defined::Unknown, Defined::No) => a,
        (Defined::Unknown, defined) => Claim::new(a.span().union(b.span()), defined),
    }
}
