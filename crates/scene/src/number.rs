//! Floats of typed numbers.

use num_traits::ToPrimitive;
use zeroset_ir::Constant;

/// Reads numbers, or constant expressions such as `2π`, separated by commas.
///
/// # Errors
/// One phrase that names the part that is not a number.
pub fn numbers(text: &str) -> Result<Vec<f64>, String> {
    let one = |part: &str| {
        let part = part.trim();
        let float = part.parse().ok();
        float.or_else(|| number(part)).ok_or_else(|| format!("'{part}' is not a number"))
    };
    text.split(',').map(one).collect()
}

/// The `f64` nearest to a constant expression such as `1/3`. `None` if the text is no such
/// expression, or if its value is not finite.
pub fn number(text: &str) -> Option<f64> {
    let value = nearest(&zeroset_syntax::constant(text).ok()?);
    value.is_finite().then_some(value)
}

/// The `f64` nearest to a typed number. Cameras and domains consist of such floats, so the same
/// digits have the same value in a file and in a flag.
pub fn nearest(constant: &Constant) -> f64 {
    let bounds = constant.bounds();
    let exact = constant.exact().and_then(ToPrimitive::to_f64);
    exact.unwrap_or_else(|| bounds.lo.midpoint(bounds.hi)).clamp(bounds.lo, bounds.hi)
}
