//! Native intervals hold what the oracle knows of the function as typed.

use crate::suite::{Failure, Tally, check_interval_case};
use crate::{Adversarial, Case, Rng};
use zeroset_eval::{Binding, Enclose, Kernel, Real, Tape};
use zeroset_ir::{rewrite, simplify};
use zeroset_jit::Native;
use zeroset_jit::comparison::{Arithmetic, Compared};

/// Native code for a case, by the steps that lead from a document to a kernel: simplified over its
/// domain, parameters bound. `None` if the graph is too large.
///
/// # Panics
/// If the code does not compile.
pub fn native_interval<T: Real>(case: &Case) -> Option<Box<dyn Kernel<Enclose, T>>> {
    let tape = tape_of::<T>(case)?;
    Some(Box::new(Native::new(tape, Binding::new(&case.parameters)).expect("compiles")))
}

/// The same in some arithmetic.
///
/// # Panics
/// If the code does not compile.
pub fn compared_interval<T: Real>(
    case: &Case,
    arithmetic: Arithmetic,
) -> Option<Box<dyn Kernel<Enclose, T>>> {
    let (tape, binding) = (tape_of::<T>(case)?, Binding::new(&case.parameters));
    Some(Box::new(Compared::new(tape, binding, arithmetic).expect("compiles")))
}

/// The steps of a case, simplified over its domain.
fn tape_of<T: Real>(case: &Case) -> Option<Tape<T>> {
    let bounds = &case.assumptions;
    let (graph, roots) =
        rewrite(&case.graph, &[case.root], &bounds.domain, &bounds.parameters).ok()?;
    let (graph, roots) = simplify(&graph, &roots, &bounds.domain, &bounds.parameters).ok()?;
    Some(Tape::new(&graph, &roots, bounds))
}

/// Asks native code of a case about `boxes` random boxes: the oracle's enclosure at points of a
/// box, of the unsimplified graph, must meet the code's enclosure of that box, and the code's
/// claims must be true there.
///
/// # Errors
/// The first contradiction, made smaller, with a line that reproduces it.
pub fn enclose<T: Adversarial>(case: &Case, rng: &mut Rng, boxes: usize) -> Result<Tally, Failure> {
    check_interval_case::<T>(&native_interval, case, rng, boxes)
}
