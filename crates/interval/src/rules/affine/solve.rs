//! Narrowing of segments to the parts where affine forms may be 0, on one ray or all rays of a
//! tile.

use super::Form;
use crate::enclosure::Fact;
use crate::machine::{Format, Machine};
use crate::rules::Rule;

/// Claims about the zeros on a segment, along which the last symbol of a form runs.
#[derive(Clone, Copy, Debug)]
pub struct Contraction<V> {
    /// Near end of the narrowed segment. On every ray, all zeros lie between its ends.
    pub near: V,
    /// Far end of the narrowed segment.
    pub far: V,
    /// Lanes that may have a zero. In other lanes the segment has no zero.
    pub possible: Fact<V>,
    /// Lanes where, on every ray, the function is continuous on the segment and has values of
    /// opposite signs at its ends.
    pub crossing: Fact<V>,
}

/// Narrows the segment from `near` to `far`. The last symbol ε of `form` runs along the segment: t
/// = `middle` + `half`·ε.
///
/// Let c be the center and r the last slope, and let w bound the other symbols' terms and the
/// error. Then 0 = c + r·ε ± w gives ε in (−c ± w)/r. The bounds of ε are kept as −lo and hi and
/// rounded up, that is, outward. So t ≤ m + h·hi and −t ≤ h·(−lo) − m, for `middle` m and `half` h.
pub fn contract<M: Machine, const N: usize>(
    m: &mut M,
    format: Format,
    form: &Form<M::V, N>,
    [middle, half]: [M::V; 2],
    [near, far]: [M::V; 2],
) -> Contraction<M::V> {
    let mut rule = Rule { m, format };
    let (zero, one) = (rule.zero(), rule.number(1.0));
    let c = form.centre;
    let mut rest = rule.error_of(form).unwrap_or(zero);
    let mut depth = zero;
    if let Some(slopes) = form.slopes {
        depth = slopes[N - 1];
        for slope in &slopes[..N - 1] {
            let size = rule.m.abs(*slope);
            rest = rule.m.add(rest, size);
        }
    }
    let (above, below) = (rule.m.add(rest, c), rule.m.sub(rest, c));
    let size = rule.m.abs(depth);
    // Lanes in which the form is not 0 anywhere on the segment. NaN proves nothing.
    let reach = [above, below].map(|side| {
        let reach = rule.m.add(side, size);
        rule.m.lt(reach, zero)
    });
    let empty = rule.m.or(reach[0], reach[1]);
    let mut possible = Fact::Lanes(empty).not(rule.m, format);
    let [above_share, below_share] = [above, below].map(|side| {
        let share = rule.m.div(side, size);
        rule.m.min(share, one)
    });
    let neg_lo = rule.m.select_signed(depth, below_share, above_share);
    let hi = rule.m.select_signed(depth, above_share, below_share);
    let neg_near = rule.m.mul_sub(neg_lo, half, middle);
    let farthest = rule.m.mul_add(hi, half, middle);
    let nearest = rule.m.neg(neg_near);
    let new = [rule.m.max(nearest, near), rule.m.min(farthest, far)];
    // If all zeros lie strictly between the ends, the signs at the ends are opposite. Slopes alone
    // would not prove this: in a segment of a few floats, the middle may be one of the ends.
    let (from_near, to_far) = (rule.m.lt(near, nearest), rule.m.lt(farthest, far));
    let crossing = rule.m.and(from_near, to_far);
    let crossing = Fact::Lanes(crossing).and(rule.m, form.facts.continuous);
    if let Some([neg_lo, hi]) = form.bounds {
        let least = rule.m.min(neg_lo, hi);
        let away = Fact::Lanes(rule.m.lt(least, zero)).not(rule.m, format);
        possible = possible.and(rule.m, away);
    }
    let somewhere = form.facts.nowhere.not(rule.m, format);
    Contraction { near: new[0], far: new[1], possible: possible.and(rule.m, somewhere), crossing }
}
