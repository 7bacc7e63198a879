//! Properties of texts with special forms, vectors, piecewise definitions and sums.

use super::{KernelKind, agree, check_simplification, enclose, read_and_print};
use crate::random::{random_domain, random_text};
use crate::suite::{Failure, Tally};
use crate::{Case, Rng};
use zeroset_eval::Assumptions;
use zeroset_parser::Limits;
use zeroset_syntax::{Options, read};

/// Greatest nesting depth of a text.
const DEEPEST: u32 = 3;
/// Small limits, so that compiling costs a fuzzer little time.
const LIMITS: Limits =
    Limits { bytes: 1 << 14, symbols: 5000, depth: 200, nodes: 300, surfaces: 10, curves: 10 };

/// Checks a text drawn from bytes. It must read back as printed, and its function must be
/// simplified, compiled and enclosed correctly. Texts with too many operations are skipped.
///
/// # Errors
/// The property that does not hold, and the text.
pub fn spelled(data: &[u8]) -> Result<Tally, Failure> {
    let mut rng = Rng::from_bytes(data);
    let text = random_text(&mut rng, DEEPEST);
    let Ok(document) = read(&text, &Options { limits: LIMITS, ..Options::default() }) else {
        return Ok(Tally::default());
    };
    read_and_print(text.as_bytes())?;
    let assumptions = Assumptions { parameters: Vec::new(), domain: random_domain(&mut rng) };
    let root = document.surfaces[0].root;
    let case = Case { graph: document.graph, root, assumptions, parameters: Vec::new() };
    let checked = match rng.u32(0..5) {
        0 => check_simplification(&case, &mut rng),
        1 => agree::<f32>(KernelKind::ALL[0], rng.bool(), &case, &mut rng, 16),
        2 => agree::<f64>(KernelKind::ALL[0], rng.bool(), &case, &mut rng, 16),
        3 => enclose::<f32>(&case, &mut rng, 8),
        _ => enclose::<f64>(&case, &mut rng, 8),
    };
    checked.map_err(|failure| Failure::new(format!("{failure}\nof\n{text}")))
}
