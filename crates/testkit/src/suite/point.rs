//! Checks of point kernels: NaN exactly where an operation is undefined, else accurate values.

use super::subjects::{OpGraph, every_op, subjects_of};
use super::{CompileGraph, Failure, Tally};
use crate::{Adversarial, Claim, Defined, Ends, Oracle, Place, Rng, reproduce_in};
use zeroset_eval::{LANES, Points, Real, Sample};
use zeroset_interval::Format;
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
    check_points_of_some_ops(make, &every_op(), seed, points, tolerance)
}

/// Runs [`check_points`] on these operations only.
///
/// # Errors
/// The first contradiction, with a line that reproduces it.
pub fn check_points_of_some_ops<T: Adversarial>(
    make: CompileGraph<Sample, T>,
    ops: &[Op],
    seed: u64,
    points: u32,
    tolerance: &dyn Fn(Op, [f64; 3], Claim) -> Option<f64>,
) -> Result<Tally, Failure> {
    let mut rng = Rng::with_seed(seed);
    let mut tally = Tally::default();
    for subject in subjects_of(ops).filter(OpGraph::fits::<T>) {
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

/// Returns the allowed error of the values of the reference evaluator, for [`check_points`]. `None`
/// if the operation's values are not compared.
pub fn tolerance_of_values<T: Adversarial>(op: Op, at: [f64; 3], claim: Claim) -> Option<f64> {
    /// Magnitude of angles, in radians, above which sines lose accuracy.
    const FARTHEST: f64 = 8192.0;
    // Allowed errors. Kernels guarantee no bound, but the rules stay within these. In f32 the
    // relative error is about five times the unit roundoff. `wave` is an absolute error, for waves
    // near their zeros.
    let (relative, wave) = match T::FORMAT {
        Format::F32 => (3e-7, 1e-7),
        Format::F64 => (1e-14, 1e-15),
    };
    let size = claim.hi.abs().max(claim.lo.abs()).min(T::LARGEST.into());
    let close = size * relative + 2.0 * T::nearest(0.0).next_up().into();
    let waves =
        matches!(op, Op::Sin | Op::Cos | Op::BesselJ0 | Op::BesselJ1 | Op::BesselJ2 | Op::BesselJ3);
    match (op.arity(), op) {
        (1, Op::Tan) => None,
        (1, _) if waves && at[0].abs() > FARTHEST => None,
        (1, _) => Some(if waves { close + wave } else { close }),
        _ => None,
    }
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
