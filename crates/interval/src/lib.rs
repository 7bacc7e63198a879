//! Intervals with outward rounding, and the rule of every operation on them.
//!
//! A rule is written once, over the lane operations of a [`Machine`] that rounds up. An interval is
//! stored as −lo and hi, so rounding both up rounds outward. The [`Software`] machine runs the
//! rules in this crate, for constants, range analysis and the reference evaluator. Another crate
//! compiles the same rules to native code. This crate knows neither graphs nor code generation.

mod bounds;
mod branch;
mod enclosure;
mod facts;
mod fold;
mod machine;
mod outward;
mod point;
pub mod round;
mod rules;
mod software;
mod unbounded;

pub use bounds::Interval;
pub use branch::{Branch, Split};
pub use enclosure::{Claims, Enclosure, Exponent, Fact, Operand, Term};
pub use facts::Facts;
pub use fold::{Decorated, fold};
pub use machine::{Format, Machine, has_fma};
pub use point::{evaluate, evaluate_sincos};
pub use rules::affine::{
    Contraction, Form, FormOperand, PATH_UNITS, RayRange, TileRays, contract, form_bounds,
    linearise, linearise_sincos, segment_coordinate, tile_coordinate,
};
pub use rules::{enclose, enclose_branch, enclose_sincos};
pub use software::{Software, Vector128};
