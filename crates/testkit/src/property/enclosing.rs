//! Bounds of native code must overlap the oracle's bounds of the function as typed.

use crate::suite::{Failure, Tally, check_interval_case};
use crate::{Adversarial, Case, Rng};
use zeroset_eval::{Binding, Enclose, Kernel, Real, Tape};
use zeroset_ir::{rewrite, simplify};
use zeroset_jit::Native;

/// Compiles a case to native code in the same steps as a document: simplified over its domain, with
/// parameters bound. Returns `None` if the graph is too large.
///
/// # Panics
/// If the code does not compile.
pub fn native_interval<T: Real>(case: &Case) -> Option<Box<dyn Kernel<Enclose, T>>> {
    let tape = tape_of::<T>(case)?;
    Some(Box::new(Native::new(tape, Binding::new(&case.parameters)).expect("compiles")))
}

/// Returns the tape of a case, simplified over its domain.
fn tape_of<T: Real>(case: &Case) -> Option<Tape<T>> {
    let bounds = &case.assumptions;
    let (graph, roots) =
        rewrite(&case.graph, &[case.root], &bounds.domain, &bounds.parameters).ok()?;
    let (graph, roots) = simplify(&graph, &roots, &bounds.domain, &bounds.parameters).ok()?;
    Some(Tape::new(&graph, &roots, bounds))
}

/// Checks native code of a case on `boxes` random boxes. At points of a box the oracle encloses the
/// graph as typed. The code's bounds over the box must overlap the oracle's, and its facts must be
/// true.
///
/// # Errors
/// The first contradiction, shrunk, with a line that reproduces it.
pub fn enclose<T: Adversarial>(case: &Case, rng: &mut Rng, boxes: usize) -> Result<Tally, Failure> {
    check_interval_case::<T>(&native_interval, case, rng, boxes)
}
