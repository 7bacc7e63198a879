//! Bounds of gradients must agree with the oracle's bounds of slopes and derivatives.

use super::KernelKind;
use crate::suite::{Failure, Tally, check_slopes};
use crate::{Adversarial, Case, Rng};
use zeroset_eval::{Binding, EncloseGradient, Kernel, Real, Reference};
use zeroset_jit::Native;

/// Compiles a case, simplified over its domain, to native code for gradient bounds. `None` if the
/// graph is too large.
///
/// # Panics
/// If the code does not compile.
pub fn native_slopes<T: Real>(case: &Case) -> Option<Box<dyn Kernel<EncloseGradient, T>>> {
    let tape = KernelKind::GradientBounds.tape(true, case)?;
    Some(Box::new(Native::new(tape, Binding::new(&case.parameters)).expect("compiles")))
}

/// Returns the reference evaluator for gradient bounds of a case as typed. `None` if the graph is
/// too large.
pub fn reference_slopes<T: Real>(case: &Case) -> Option<Box<dyn Kernel<EncloseGradient, T>>> {
    let tape = KernelKind::GradientBounds.tape(false, case)?;
    Some(Box::new(Reference::<EncloseGradient, T>::new(tape, Binding::new(&case.parameters))))
}

/// Checks the gradient bounds of native code, or of the reference evaluator, on `boxes` random
/// boxes of a case.
///
/// # Errors
/// The first contradiction, shrunk, with a line that reproduces it.
pub fn check_gradient_bounds<T: Adversarial>(
    native: bool,
    case: &Case,
    rng: &mut Rng,
    boxes: usize,
) -> Result<Tally, Failure> {
    let make = if native { native_slopes::<T> } else { reference_slopes::<T> };
    check_slopes(&make, case, rng, boxes)
}
