//! From syntax trees to the expression graph. Definitions are expanded. Vectors and complex
//! numbers become real numbers.
//!
//! Nothing here knows tokens, with one exception: constants and the language's own definitions are
//! given as text, which is parsed like any other text.
//!
//! The files depend on one another in a circle. `lowering` walks the trees and calls the other
//! files, which call `lowering` for their operands.

pub(crate) mod builders;
pub(crate) mod choice;
pub(crate) mod complex;
pub(crate) mod condition;
pub(crate) mod constant;
pub(crate) mod derivative;
pub(crate) mod lowering;
pub(crate) mod matrix;
pub(crate) mod prelude;
pub(crate) mod value;
