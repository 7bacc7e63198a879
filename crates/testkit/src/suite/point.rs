//! Checks of point kernels: NaN exactly where an operation is undefined, else accurate values.

use super::subjects::{OpGraph, subjects};
use super::{CompileGraph, Failure, Tally};
use crate::{Adversarial, Claim, Defined, Ends, Oracle, Place, Rng, reproduce_in};
use zeroset_eval::{LANES, Points, Real, Sample};
use zeroset_ops::Op;

/// Checks every operation alone at `points` adversarial points, whose coordinates are the operands.
///
/// `tolerance` returns the allowed distance of a value from the oracle's bounds, or `None` to skip
/// the value of this operation at this point. A value beyond the largest number of `T` may be
/// infinite.
///
/// # Errors
/// The first contradiction, with a line that reproduces it.
pub fn check_points<T: Adversarial>(
    make: CompileGraph<Sample, T>,
    seed: u64,
    points: u32,
    tolerance: &dyn Fn(Op, [f64; 3], Claim) -> Option<f64>,
) -> Result<Tally, Failure> {
    let mut rng = Rng::with_seed(seed);
    let mut tally = Tally::default();
    for subject in subjects().into_iter().filter(OpGraph::fits::<T>) {
        let mut draw = || T::adversarial(&mut rng, Ends::Finite).into();
        let places: Vec<[f64; 3]> = (0..points).map(|_| [(); 3].map(|()| draw())).collect();
        let values = make(&subject.graph, subject.root).eval_all(&Points::near(&places)); // exact
        let oracle = Oracle::new(&subject.graph, &[subject.root]);
        for (index, &point) in places.iter().enumerate() {
            let value = values[index / LANES].value[index % LANES];
            let claim = oracle.at(point, &[])[0];
            tally.compared += 1;
            tally.defined += u64::from(claim.defined == Defined::Yes);
            let allowed = tolerance(subject.op, point, claim);
            if let Err(what) = agrees(value, claim, allowed) {
                let line = reproduce_in::<T>(&subject.graph, subject.root, &[], &Place::At(point));
                return Err(Failure(format!(
                    "{what}: {value:?} against {claim:?}\n{line}\nseed {seed:#x}"
                )));
            }
        }
    }
    Ok(tally)
}

fn agrees<T: Real>(value: T, claim: Claim, tolerance: Option<f64>) -> Result<(), &'static str> {
    let value = value.into();
    match (claim.defined, tolerance) {
        (Defined::Unknown, _) | (Defined::Yes, None) => Ok(()),
        (Defined::No, _) if !value.is_finite() => Ok(()),
        (Defined::No, _) => Err("a value where there is none"),
        (Defined::Yes, _) if value.is_nan() => Err("no value where there is one"),
        (Defined::Yes, Some(tolerance)) => {
            let most = T::LARGEST.into();
            let close = if value.is_infinite() {
                // An infinite result represents all numbers beyond the largest finite one.
                let reached = if value > 0.0 { claim.hi } else { -claim.lo };
                reached + tolerance >= most
            } else {
                claim.lo.min(most) - tolerance <= value && value <= claim.hi.max(-most) + tolerance
            };
            if close { Ok(()) } else { Err("too far off") }
        }
    }
}
