//! From syntax trees to the expression graph: definitions expanded, vectors taken apart.
//!
//! Nothing here knows tokens, except where constants and the language's own definitions are given
//! as text and read like any other.
//!
//! The files use one another in a circle: `lowering` walks the trees, and the others are its steps,
//! which come back to it for their operands.

pub(crate) mod choice;
pub(crate) mod condition;
pub(crate) mod constant;
pub(crate) mod lowering;
pub(crate) mod matrix;
pub(crate) mod prelude;
pub(crate) mod value;
