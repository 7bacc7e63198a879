//! Properties that must hold for every input. Fuzz targets and tests check them on bytes.
//!
//! Each property draws its input from bytes or from a seed. It returns how much it compared, or a
//! failing case that can be reproduced.

mod agreement;
mod contracting;
mod dot;
mod enclosing;
mod linear;
mod narrowing;
mod picturing;
mod reading;
mod rewriting;
mod scene;
mod seaming;
mod shortening;
mod sloping;
mod spelled;
mod tile;
mod vanishing;

pub use agreement::{KernelKind, agree};
pub use contracting::{
    ContractionTally, Engine, KernelOptions, PathKernels, check_contraction, check_contraction_by,
};
pub use enclosing::{enclose, native_interval};
pub use linear::{FormTally, linear, linear_on};
pub use narrowing::{check_narrowing, check_narrowing_on};
pub use picturing::{Pixel, RayClaim, picture};
pub use reading::read_and_print;
pub use rewriting::check_simplification;
pub use scene::{Formula, Scene};
pub use seaming::check_seams;
pub use shortening::{check_shortening, random_choices};
pub use sloping::{check_gradient_bounds, native_slopes, reference_slopes};
pub use spelled::spelled;
pub use vanishing::{CompileZeros, check_zeros};

use crate::suite::{Failure, Tally};
use crate::{Case, GraphOptions, Rng};
use zeroset_ops::TABLE;

/// Returns a random case with at most `largest` operations, adversarial or plain, with parameters
/// or without.
pub fn any_case(rng: &mut Rng, largest: u32) -> Case {
    let options = GraphOptions {
        size: rng.u32(1..=largest),
        parameters: rng.u32(0..=2),
        adversarial: rng.bool(),
        ..GraphOptions::default()
    };
    Case::random(rng, &options)
}

/// Greatest number of operations in a formula drawn from a fuzzer's bytes.
const LARGEST: u32 = 24;
/// Greatest number of operations in a formula that is differentiated, since derivatives grow.
const LARGEST_DIFFERENTIATED: u32 = 8;

/// Runs [`read_and_print`] on a text in any encoding.
///
/// # Errors
/// A message about the failure, and the text.
pub fn parse(data: &[u8]) -> Result<Tally, Failure> {
    read_and_print(data)
}

/// Runs [`check_simplification`] on a case drawn from bytes.
///
/// # Errors
/// The contradiction, with a line that reproduces it.
pub fn simplify(data: &[u8]) -> Result<Tally, Failure> {
    let mut rng = Rng::from_bytes(data);
    let case = any_case(&mut rng, LARGEST);
    check_simplification(&case, &mut rng)
}

/// Runs [`agree`] on a case, a kind of kernel and a precision drawn from bytes.
///
/// # Errors
/// The first input on which the evaluators differ, with a smaller case that still shows it.
pub fn jit_vs_reference(data: &[u8]) -> Result<Tally, Failure> {
    /// Inputs per kernel.
    const INPUTS: usize = 32;
    let mut rng = Rng::from_bytes(data);
    let subject = KernelKind::ALL[rng.u32(0..KernelKind::ALL.len() as u32) as usize];
    let simple = rng.bool();
    let largest = if subject.is_differentiated() { LARGEST_DIFFERENTIATED } else { LARGEST };
    let case = any_case(&mut rng, largest);
    if rng.bool() {
        agree::<f64>(subject, simple, &case, &mut rng, INPUTS)
    } else {
        agree::<f32>(subject, simple, &case, &mut rng, INPUTS)
    }
}

/// Runs [`enclose`] on a case and a precision drawn from bytes.
///
/// # Errors
/// The first contradiction, shrunk, with a line that reproduces it.
pub fn jit_vs_oracle(data: &[u8]) -> Result<Tally, Failure> {
    /// Boxes per kernel.
    const BOXES: usize = 16;
    let mut rng = Rng::from_bytes(data);
    let case = any_case(&mut rng, LARGEST);
    if rng.bool() {
        enclose::<f64>(&case, &mut rng, BOXES)
    } else {
        enclose::<f32>(&case, &mut rng, BOXES)
    }
}

/// Runs [`check_gradient_bounds`] on a case, an evaluator and a precision drawn from bytes.
///
/// # Errors
/// The first contradiction, shrunk, with a line that reproduces it.
pub fn slopes(data: &[u8]) -> Result<Tally, Failure> {
    /// Boxes per kernel.
    const BOXES: usize = 16;
    let mut rng = Rng::from_bytes(data);
    let (native, double) = (rng.bool(), rng.bool());
    let case = any_case(&mut rng, LARGEST_DIFFERENTIATED);
    let ask = if double { check_gradient_bounds::<f64> } else { check_gradient_bounds::<f32> };
    ask(native, &case, &mut rng, BOXES)
}

/// Runs [`check_shortening`] on a formula and a precision drawn from bytes.
///
/// # Errors
/// The first contradiction.
pub fn shorten(data: &[u8]) -> Result<Tally, Failure> {
    let mut rng = Rng::from_bytes(data);
    if rng.bool() { check_shortening::<f64>(&mut rng) } else { check_shortening::<f32>(&mut rng) }
}

/// Runs [`check_contraction`] on a case, or [`linear`] on an operation. Bytes choose the check, its
/// input and the precision.
///
/// # Errors
/// The first contradiction.
pub fn forms(data: &[u8]) -> Result<Tally, Failure> {
    /// Number of batches per kernel, and of operand vectors per operation.
    const BATCHES: usize = 2;
    const VECTORS: usize = 8;
    let mut rng = Rng::from_bytes(data);
    let (double, alone) = (rng.bool(), rng.u32(0..4) == 0);
    if alone {
        let op = TABLE[rng.u32(0..TABLE.len() as u32) as usize].op;
        let ask = if double { linear::<f64> } else { linear::<f32> };
        let FormTally { compared, lanes, .. } = ask(op, &mut rng, VECTORS)?;
        return Ok(Tally { compared: lanes, defined: compared });
    }
    let kernel_options = KernelOptions { simple: rng.bool(), engine: Engine::Reference };
    let case = any_case(&mut rng, LARGEST);
    let ask = if double { check_contraction::<f64> } else { check_contraction::<f32> };
    let ContractionTally { points, planes, .. } = ask(kernel_options, &case, &mut rng, BATCHES)?;
    Ok(Tally { compared: points, defined: planes })
}

/// Runs [`picture`] on a scene drawn from bytes.
///
/// # Errors
/// The first false claim, with arguments of `zeroset render` that show it.
pub fn render(data: &[u8], draw: &dyn Fn(&Scene) -> Option<Vec<Pixel>>) -> Result<Tally, Failure> {
    let mut rng = Rng::from_bytes(data);
    Scene::random(&mut rng).map_or(Ok(Tally::default()), |scene| picture(&scene, draw))
}

/// Runs [`check_seams`] on a formula with seams, drawn from bytes.
///
/// # Errors
/// The first contradiction.
pub fn seams(data: &[u8]) -> Result<Tally, Failure> {
    let mut rng = Rng::from_bytes(data);
    Formula::seamed(&mut rng)
        .map_or(Ok(Tally::default()), |formula| check_seams(&formula, &mut rng))
}

/// As [`render`], on a scene with seams.
///
/// # Errors
/// The first false claim, with arguments of `zeroset render` that show it.
pub fn seam_pictures(
    data: &[u8],
    draw: &dyn Fn(&Scene) -> Option<Vec<Pixel>>,
) -> Result<Tally, Failure> {
    let mut rng = Rng::from_bytes(data);
    Scene::seamed(&mut rng).map_or(Ok(Tally::default()), |scene| picture(&scene, draw))
}

/// As [`zeros`], on a formula with seams.
///
/// # Errors
/// The first zero that the kernel denies.
pub fn seam_zeros(
    data: &[u8],
    single: CompileZeros<f32>,
    double: CompileZeros<f64>,
) -> Result<Tally, Failure> {
    let mut rng = Rng::from_bytes(data);
    match Formula::seamed(&mut rng) {
        None => Ok(Tally::default()),
        Some(formula) if rng.bool() => check_zeros(&formula, &mut rng, double),
        Some(formula) => check_zeros(&formula, &mut rng, single),
    }
}

/// Runs [`check_zeros`] on a formula and a precision drawn from bytes.
///
/// # Errors
/// The first zero that the kernel denies.
pub fn zeros(
    data: &[u8],
    single: CompileZeros<f32>,
    double: CompileZeros<f64>,
) -> Result<Tally, Failure> {
    let mut rng = Rng::from_bytes(data);
    match Formula::random(&mut rng, LARGEST) {
        None => Ok(Tally::default()),
        Some(formula) if rng.bool() => check_zeros(&formula, &mut rng, double),
        Some(formula) => check_zeros(&formula, &mut rng, single),
    }
}
