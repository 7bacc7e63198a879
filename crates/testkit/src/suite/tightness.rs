//! Checks that bounds of an operation are no wider than the oracle's, and that facts which the
//! oracle knows are stated. Soundness alone does not notice a rule that claims less than it could.

use super::interval::QueryResult;
use super::{CompileCase, Failure, Tally};
use crate::{Adversarial, BoxClaim, Case, Defined, Oracle, Place, Rng, pack_boxes};
use zeroset_eval::{Enclose, LANES};
use zeroset_interval::Facts;

/// By how much bounds of an operation may exceed the oracle's.
#[derive(Clone, Copy, Debug)]
pub struct Slack {
    /// By how many numbers of the precision.
    pub floats: u32,
    /// Boxes that reach farther than this from 0 along any axis are not compared.
    pub farthest: f64,
    /// States that all numbers up to the least normal one count as equal.
    pub rounds_tiny: bool,
}

/// Checks a kernel of a case on `boxes` random boxes. Its bounds must exceed the oracle's bounds
/// over the box by at most `slack` at either end. It must state that the function
/// is defined, nowhere defined or continuous wherever the oracle does. In the tally, `defined`
/// counts boxes with two finite bounds.
///
/// The oracle does plain interval arithmetic, so this holds for single operations only.
///
/// # Errors
/// The first bound that is too wide, or the first fact that is missing, with a line that reproduces
/// it.
pub fn check_tightness<T: Adversarial>(
    make: CompileCase<Enclose, T>,
    case: &Case,
    rng: &mut Rng,
    boxes: usize,
    slack: Slack,
) -> Result<Tally, Failure> {
    let mut tally = Tally::default();
    let Some(kernel) = make(case) else { return Ok(tally) };
    let regions: Vec<_> = (0..boxes).map(|_| case.random_box::<T>(rng)).collect();
    let answers = kernel.eval_all(&pack_boxes(&regions));
    let oracle = Oracle::new(&case.graph, &[case.root]);
    let parameters: Vec<_> = case.parameters.iter().map(|value| (value.lo, value.hi)).collect();
    for (index, region) in regions.iter().enumerate() {
        let answer = QueryResult::of(&answers[index / LANES], index % LANES);
        let ranges: [(f64, f64); 3] = region.map(|[lo, hi]| (lo.into(), hi.into()));
        let claim = oracle.over(ranges, &parameters)[0];
        if ranges.iter().any(|(lo, hi)| lo.abs().max(hi.abs()) > slack.farthest) {
            continue;
        }
        tally.compared += 1;
        let is_bounded = claim.values.lo.is_finite() && claim.values.hi.is_finite();
        tally.defined += u64::from(claim.values.defined == Defined::Yes && is_bounded);
        if let Some(what) = answer.looseness::<T>(claim, slack) {
            let line = case.describe::<T>(&Place::over(region));
            return Err(Failure(format!("{what} {claim:?}: {answer:?}\n{line}")));
        }
    }
    Ok(tally)
}

impl QueryResult {
    /// Returns in what this result says less than `claim`.
    fn looseness<T: Adversarial>(&self, claim: BoxClaim, slack: Slack) -> Option<&'static str> {
        let values = claim.values;
        if values.defined == Defined::No {
            return (!self.facts.has(Facts::NOWHERE)).then_some("not called undefined, against");
        }
        if values.defined != Defined::Yes {
            return None;
        }
        if !self.facts.has(Facts::DEFINED) {
            return Some("not called defined, against");
        }
        if claim.continuous && !self.facts.has(Facts::CONTINUOUS) {
            return Some("not called continuous, against");
        }
        // An end moves up by one float at a time. Bounds beyond all floats are infinite.
        let most = |end: f64| -> f64 {
            let end = match T::above(end) {
                end if slack.rounds_tiny && end.into().abs() < T::LEAST_NORMAL.into() => {
                    T::LEAST_NORMAL
                }
                end => end,
            };
            (0..slack.floats).fold(end, |end, _| Adversarial::next_up(end)).into()
        };
        let is_wide = self.hi > most(values.hi) || -self.lo > most(-values.lo);
        is_wide.then_some("the bounds are wider than")
    }
}
