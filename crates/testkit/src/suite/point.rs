//! Point kernels: NaN exactly where an operation is undefined, and values within a stated tolerance.

use super::subjects::{Subject, subjects};
use super::{Failure, MakePoint, Tally};
use crate::{Claim, Defined, Ends, Oracle, Place, Rng, adversarial_f32, reproduce};
use zeroset_eval::{LANES, PointPacket, ValuePacket};
use zeroset_ops::Op;

/// Checks every operation alone at `points` adversarial points, whose coordinates are operands.
///
/// `tolerance` says how far a value may lie from the oracle's bounds, or `None` to leave the value
/// of this operation at this point unchecked. A value beyond the largest `f32` may be infinite.
///
/// # Errors
/// The first contradiction, with a line that reproduces it.
pub fn check_points(
    make: MakePoint,
    seed: u64,
    points: u32,
    tolerance: &dyn Fn(Op, [f32; 3], Claim) -> Option<f64>,
) -> Result<Tally, Failure> {
    let mut rng = Rng::with_seed(seed);
    let mut tally = Tally::default();
    for subject in subjects().into_iter().filter(Subject::fits_f32) {
        let places: Vec<[f32; 3]> = (0..points)
            .map(|_| [(); 3].map(|()| adversarial_f32(&mut rng, Ends::Finite)))
            .collect();
        let mut packets = vec![PointPacket::default(); places.len().div_ceil(LANES)];
        for (index, place) in places.iter().enumerate() {
            for (axis, value) in place.iter().enumerate() {
                packets[index / LANES].at[axis][index % LANES] = *value;
            }
        }
        let mut values = vec![ValuePacket::default(); packets.len()];
        make(&subject.graph, subject.root).sample(&packets, &mut values);
        let oracle = Oracle::new(&subject.graph, &[subject.root]);
        for (index, place) in places.iter().enumerate() {
            let value = values[index / LANES].value[index % LANES];
            let point = place.map(f64::from);
            let claim = oracle.at(point, &[])[0];
            tally.compared += 1;
            tally.defined += u64::from(claim.defined == Defined::Yes);
            let allowed = tolerance(subject.op, *place, claim);
            if let Err(what) = agrees(value, claim, allowed) {
                let line = reproduce(&subject.graph, subject.root, &[], &Place::At(point));
                return Err(Failure(format!(
                    "{what}: {value:e} against {claim:?}\n{line}\nseed {seed:#x}"
                )));
            }
        }
    }
    Ok(tally)
}

fn agrees(value: f32, claim: Claim, tolerance: Option<f64>) -> Result<(), &'static str> {
    match (claim.defined, tolerance) {
        (Defined::Unknown, _) | (Defined::Yes, None) => Ok(()),
        (Defined::No, _) if !value.is_finite() => Ok(()),
        (Defined::No, _) => Err("a value where there is none"),
        (Defined::Yes, _) if value.is_nan() => Err("no value where there is one"),
        (Defined::Yes, Some(tolerance)) => {
            let most = f64::from(f32::MAX);
            let got = f64::from(value);
            let close = if value.is_infinite() {
                // It stands for all that lies beyond the largest finite number.
                let reached = if value > 0.0 { claim.hi } else { -claim.lo };
                reached + tolerance >= most
            } else {
                claim.lo.min(most) - tolerance <= got && got <= claim.hi.max(-most) + tolerance
            };
            if close { Ok(()) } else { Err("too far off") }
        }
    }
}
