//! Checks of gradient kernels: derivatives must agree with difference quotients of the oracle.

use super::subjects::{OpGraph, every_op, subjects_of};
use super::{CompileGraph, Failure, Tally};
use crate::{Defined, Oracle, Place, Rng, reproduce_in};
use zeroset_eval::{LANES, Points, Real, SampleGradient};
use zeroset_ops::Op;

/// Half the distance over which a slope is measured. A slope has two errors. One is at most the
/// step squared times the third derivative. The other is the oracle's error of about 2⁻⁵², divided
/// by the step: 2⁻³⁵.
const STEP: f64 = 1.0 / (1 << 17) as f64;

/// Checks every operation alone at `points` points. Their coordinates are up to 4, and almost
/// surely away from jumps and kinks. Points where the slopes to either side differ are skipped.
///
/// A derivative may differ from the slope s by `relative` times max(|s|, 1).
///
/// # Errors
/// The first contradiction, with a line that reproduces it.
pub fn check_gradients<T: Real>(
    make: CompileGraph<SampleGradient, T>,
    seed: u64,
    points: u32,
    relative: f64,
) -> Result<Tally, Failure> {
    check_gradients_of_some_ops(make, &every_op(), seed, points, relative)
}

/// Runs [`check_gradients`] on these operations only.
///
/// # Errors
/// The first contradiction, with a line that reproduces it.
pub fn check_gradients_of_some_ops<T: Real>(
    make: CompileGraph<SampleGradient, T>,
    ops: &[Op],
    seed: u64,
    points: u32,
    relative: f64,
) -> Result<Tally, Failure> {
    let mut rng = Rng::with_seed(seed);
    let mut tally = Tally::default();
    for subject in subjects_of(ops).filter(OpGraph::fits::<T>) {
        let places: Vec<[f64; 3]> = (0..points)
            .map(|_| [(); 3].map(|()| f64::from(rng.i32(-1 << 20..1 << 20)) / f64::from(1 << 18)))
            .collect();
        let out = make(&subject.graph, subject.root).eval_all(&Points::near(&places)); // exact
        let oracle = Oracle::new(&subject.graph, &[subject.root]);
        for (index, place) in places.iter().enumerate() {
            let point = *place;
            for axis in 0..3 {
                tally.compared += 1;
                let Some((value, slope)) = slope(&oracle, point, axis, relative) else {
                    continue;
                };
                if subject.op == Op::Pow && value == 0.0 {
                    // At 0^x the table's derivative, a^b·ln a, is undefined.
                    continue;
                }
                tally.defined += 1;
                let got = out[index / LANES].gradient[axis][index % LANES].into();
                let close = (got - slope).abs() <= relative * slope.abs().max(1.0);
                if !close {
                    let line =
                        reproduce_in::<T>(&subject.graph, subject.root, &[], &Place::At(point));
                    return Err(Failure(format!(
                        "derivative {axis} is {got:e}, the slope {slope:e}\n{line}\nseed {seed:#x}"
                    )));
                }
            }
        }
    }
    Ok(tally)
}

/// Returns the function's value at `point`, and its slope along `axis`. `None` unless the function
/// is defined around the point, its values are known precisely, and its slopes to either side
/// agree.
fn slope(oracle: &Oracle, point: [f64; 3], axis: usize, relative: f64) -> Option<(f64, f64)> {
    let value = |offset: f64| {
        let mut at = point;
        at[axis] += offset;
        let claim = oracle.at(at, &[])[0];
        let known = claim.defined == Defined::Yes
            && claim.hi - claim.lo <= STEP * relative * claim.hi.abs().max(1.0) / 64.0;
        known.then_some(claim.lo / 2.0 + claim.hi / 2.0)
    };
    let (before, here, after) = (value(-STEP)?, value(0.0)?, value(STEP)?);
    let (left, right) = ((here - before) / STEP, (after - here) / STEP);
    let slope = left / 2.0 + right / 2.0;
    let smooth = (left - right).abs() <= relative * slope.abs().max(1.0);
    // Steep slopes overflow in f32. A slope far below the value has few correct digits.
    let moderate = slope.abs() <= 1e30 && here.abs() <= slope.abs().max(1.0) * 1e6;
    (smooth && moderate).then_some((here, slope))
}
