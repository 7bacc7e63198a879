//! No kernel may report that there is no zero where the certified tracer finds one.

use super::scene::{Formula, describe};
use crate::certified::{Crossing, Line};
use crate::suite::{Failure, Tally};
use crate::{Adversarial, Rng, pack_boxes};
use zeroset_eval::{FindZeros, Kernel};

/// Number of lines per formula, and of boxes around each crossing.
const LINES: usize = 6;
const BOXES: usize = 4;

/// Budget of evaluations per line.
const BUDGET: u32 = 2000;

/// Compiles the kernel that finds a formula's zeros; `None` if the formula has no surface.
pub type CompileZeros<'a, T> = &'a dyn Fn(&Formula) -> Option<Box<dyn Kernel<FindZeros, T>>>;

/// Checks a formula's kernel on boxes around proven zeros. The kernel must deny a zero in none of
/// the boxes. In the tally, `compared` counts lines, and `defined` counts boxes.
///
/// # Errors
/// The first zero that the kernel denies.
pub fn check_zeros<T: Adversarial>(
    formula: &Formula,
    rng: &mut Rng,
    make: CompileZeros<T>,
) -> Result<Tally, Failure> {
    let mut tally = Tally::default();
    let (function, _) = formula.functions().swap_remove(0);
    let mut kernel = None;
    for _ in 0..LINES {
        let line = formula.random_line(rng);
        tally.compared += 1;
        let certificate = function.trace(&line, &formula.region, BUDGET);
        let Some(crossing) = certificate.crossing else { continue };
        // The kernel is compiled at the first crossing, since most formulas have no zero.
        if kernel.is_none() {
            kernel = make(formula);
        }
        let Some(kernel) = &kernel else { return Ok(tally) };
        let regions: Vec<_> = (0..BOXES).map(|_| around(formula, &line, &crossing, rng)).collect();
        let zeros = &kernel.eval_all(&pack_boxes(&regions))[0];
        for (lane, region) in regions.iter().enumerate() {
            tally.defined += 1;
            if zeros.possible >> lane & 1 == 0 {
                return Err(Failure::new(format!(
                    "a zero denied over {region:?}, but {crossing:?} on\n{}\n{formula}",
                    describe(&line)
                )));
            }
        }
    }
    Ok(tally)
}

/// Returns a box around the part of the line between the ends of a crossing. The box exceeds the
/// region by one rounding at most.
fn around<T: Adversarial>(
    formula: &Formula,
    line: &Line,
    crossing: &Crossing,
    rng: &mut Rng,
) -> [[T; 2]; 3] {
    let margin = if rng.bool() { 0.0 } else { 2f64.powi(-rng.i32(0..=40)) };
    let mut region = [[T::default(); 2]; 3];
    for (axis, range) in region.iter_mut().enumerate() {
        let (low, high) = line.range(axis, crossing.near, crossing.far);
        let [least, most] = formula.region[axis];
        let low = (low - margin).clamp(least, most);
        let high = (high + margin).clamp(least, most);
        *range = [-T::above(-low), T::above(high)];
    }
    region
}
