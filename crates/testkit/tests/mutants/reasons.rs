//! Mutants that are harmless, with reasons. They are not tried.

use crate::machine::{Change, Mutant, Site};
use Change::{Exchanged, First, Neighbour, Opposite, RoundsDown, Second};

/// Why changes of a line are harmless.
pub struct Reason {
    pub file: &'static str,
    /// A part of the line. If empty, the reason is about the whole file.
    pub line: &'static str,
    pub changes: &'static [Change],
    pub why: &'static str,
}

const fn of(
    file: &'static str,
    line: &'static str,
    changes: &'static [Change],
    why: &'static str,
) -> Reason {
    Reason { file, line, changes, why }
}

const ROUNDING: &[Change] = &[RoundsDown, Neighbour];
const FIRST: &[Change] = &[First];
const DOWN: &[Change] = &[RoundsDown];
const EXACT: &str = "Where the result is used, the operation is exact.";
const LESS: &[Change] = &[Opposite, First, Second];
const OPPOSITE: &[Change] = &[Opposite];

const UNITS: &str =
    "Units added to a form's error cover rounding in either direction: docs/rounding.md.";
const BALLS: &str =
    "The error of the routine covers rounding in either direction: proofs/functions.";
const CLAMP: &str =
    "Where an operand has both signs, the slope is within the limits, but for rounding.";
const PIECE: &str =
    "Where an operand has one sign, the limited slope is that of the piece already.";
const BALANCED: &str = "With this slope, both ends give the same number, but for rounding.";
const EQUAL: &str = "Where both are equal, either way is right.";
const UPPER: &[Change] = &[Exchanged, RoundsDown, Neighbour];
const LONGER: &str = "The middle is rounded up, so the lower half is no shorter than this.";
const SAMPLE: &str = "Values at points have no error bounds.";
const UNUSED: &str = "Where the box is not split, no branch of it is used.";
const SQUARE: &str =
    "A root that is too low is kept, since its square does not exceed the operand.";

/// All reasons but one: see [`reason`].
pub const REASONS: &[Reason] = &[
    of(
        "crates/interval/src/rules/elementary/mod.rs",
        "let last = self.m.sub(hi, offset)",
        DOWN,
        EXACT,
    ),
    of("crates/interval/src/rules/elementary/mod.rs", "self.m.add(neg_lo, offset)", DOWN, EXACT),
    of("crates/interval/src/rules/elementary/mod.rs", "self.m.add(last, neg_first)", DOWN, EXACT),
    of(
        "crates/interval/src/rules/elementary/mod.rs",
        "Some(self.m.le(far, limit))",
        OPPOSITE,
        EQUAL,
    ),
    of("crates/interval/src/rules/elementary/bessel.rs", "self.m.le(size, limit)", OPPOSITE, EQUAL),
    of("crates/eval/src/duals.rs", "op == Op::Min => Some((m.lt(", OPPOSITE, EQUAL),
    of("crates/eval/src/duals.rs", "Some((m.lt(b.value, a.value)", OPPOSITE, EQUAL),
    of("crates/interval/src/rules/affine/rays.rs", "let (after, before) =", UPPER, LONGER),
    of(
        "crates/interval/src/rules/affine/mod.rs",
        "let above = self.m.sub(hi, middle)",
        UPPER,
        LONGER,
    ),
    of("crates/interval/src/point.rs", "", ROUNDING, SAMPLE),
    of("crates/eval/src/duals.rs", "", ROUNDING, SAMPLE),
    of("crates/interval/src/rules/affine/arithmetic.rs", "", ROUNDING, UNITS),
    of("crates/interval/src/rules/affine/functions.rs", "", ROUNDING, UNITS),
    of("crates/interval/src/rules/affine/waves.rs", "", ROUNDING, UNITS),
    of("crates/interval/src/rules/affine/rays.rs", "m.mul(half, direction)", ROUNDING, UNITS),
    of("crates/interval/src/rules/affine/rays.rs", "direction, middle, origin", ROUNDING, UNITS),
    of("crates/interval/src/rules/affine/rays.rs", "let spread = m.", ROUNDING, UNITS),
    of("crates/interval/src/rules/affine/rays.rs", "let error = m.", ROUNDING, UNITS),
    of(
        "crates/interval/src/rules/arithmetic.rs",
        "self.m.min(b.value.neg_lo, b.value.hi)",
        LESS,
        UNUSED,
    ),
    of(
        "crates/interval/src/rules/arithmetic.rs",
        "self.m.select(straddles, zero, value.",
        FIRST,
        UNUSED,
    ),
    of(
        "crates/interval/src/rules/elementary/atan2.rs",
        "y_lo = self.m.select(cut, zero, y_lo)",
        FIRST,
        UNUSED,
    ),
    of("crates/interval/src/rules/elementary/arc.rs", "", ROUNDING, BALLS),
    of("crates/interval/src/rules/elementary/double_double.rs", "", ROUNDING, BALLS),
    of("crates/interval/src/rules/elementary/erf.rs", "", ROUNDING, BALLS),
    of("crates/interval/src/rules/elementary/exponential.rs", "", ROUNDING, BALLS),
    of("crates/interval/src/rules/elementary/hyperbolic.rs", "", ROUNDING, BALLS),
    of("crates/interval/src/rules/elementary/logarithm.rs", "", ROUNDING, BALLS),
    of("crates/interval/src/rules/elementary/trigonometric.rs", "", ROUNDING, BALLS),
    of("crates/interval/src/rules/affine/pieces.rs", "self.m.min(slope, ", FIRST, CLAMP),
    of("crates/interval/src/rules/affine/functions.rs", "self.m.min(slope, ", FIRST, CLAMP),
    of("crates/interval/src/rules/affine/pieces.rs", "self.m.max(slope, ", FIRST, CLAMP),
    of("crates/interval/src/rules/affine/functions.rs", "self.m.max(slope, ", FIRST, CLAMP),
    of(
        "crates/interval/src/rules/affine/pieces.rs",
        "let positive = self.m.le(bounds.value.neg_lo, zero)",
        LESS,
        PIECE,
    ),
    of(
        "crates/interval/src/rules/affine/pieces.rs",
        "let negative = self.m.le(bounds.value.hi, zero)",
        LESS,
        PIECE,
    ),
    of(
        "crates/interval/src/rules/affine/pieces.rs",
        "let either = self.m.or(positive, negative)",
        LESS,
        PIECE,
    ),
    of(
        "crates/interval/src/rules/affine/pieces.rs",
        "let slope = self.m.select(negative, below, slope)",
        LESS,
        PIECE,
    ),
    of(
        "crates/interval/src/rules/affine/pieces.rs",
        "let slope = self.m.select(positive, above, slope)",
        LESS,
        PIECE,
    ),
    of(
        "crates/interval/src/rules/affine/pieces.rs",
        "let rest = self.m.select(either, zero, rest)",
        LESS,
        PIECE,
    ),
    of(
        "crates/interval/src/rules/affine/pieces.rs",
        "let most = self.m.max(at_lo, at_hi)",
        LESS,
        BALANCED,
    ),
    of(
        "crates/interval/src/rules/elementary/arc.rs",
        "let negative = self.m.lt(x, zero)",
        OPPOSITE,
        EQUAL,
    ),
    of(
        "crates/interval/src/rules/elementary/arc.rs",
        "let beyond = self.m.lt(half, t)",
        OPPOSITE,
        EQUAL,
    ),
    of(
        "crates/interval/src/rules/elementary/arc.rs",
        "let flat = self.m.lt(t, c)",
        OPPOSITE,
        EQUAL,
    ),
    of(
        "crates/interval/src/rules/elementary/arc.rs",
        "let below_one = self.m.lt(t, one)",
        OPPOSITE,
        EQUAL,
    ),
    of(
        "crates/interval/src/rules/elementary/exponential.rs",
        "let smaller = self.m.lt(a, b)",
        OPPOSITE,
        EQUAL,
    ),
    of(
        "crates/interval/src/rules/elementary/logarithm.rs",
        "let subnormal = self.m.lt(x, tiny)",
        OPPOSITE,
        EQUAL,
    ),
    of(
        "crates/interval/src/rules/elementary/near.rs",
        "let before = self.m.lt(turned.rest, zero)",
        OPPOSITE,
        EQUAL,
    ),
    of(
        "crates/interval/src/rules/affine/arithmetic.rs",
        "let below = self.m.lt(bounds.hi, bounds.neg_lo)",
        OPPOSITE,
        EQUAL,
    ),
    of("crates/interval/src/rules/power.rs", "let up = self.m.sqrt(lo)", ROUNDING, SQUARE),
];

/// Returns why a mutant is harmless, if it is known to be.
pub fn reason(mutant: &Mutant) -> Option<&'static str> {
    let Mutant { site, change } = mutant;
    // The rule that replaces NaN relies on the order.
    let orders_nan = site.file() == "crates/interval/src/rules/mod.rs";
    if *change == Exchanged && matches!(site.operation, "min" | "max") && !orders_nan {
        return Some("Both orders give the same number.");
    }
    let line = text(site);
    let holds = |reason: &&Reason| {
        reason.file == site.file()
            && reason.changes.contains(change)
            && (reason.line.is_empty() || line.contains(reason.line))
    };
    REASONS.iter().find(holds).map(|reason| reason.why)
}

/// The line of code of a site.
pub fn text(site: &Site) -> String {
    let code = std::fs::read_to_string(crate::root().join(site.file())).unwrap_or_default();
    code.lines().nth(site.line() as usize - 1).unwrap_or_default().trim().to_owned()
}
