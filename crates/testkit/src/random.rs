//! Random inputs that are more often unpleasant than not.
//!
//! Everything is drawn from an [`Rng`] by integer arithmetic and exact scaling, so a seed, or a
//! fuzzer's bytes, give the same inputs on every platform. What is done with them is not known
//! here.

mod graphs;
mod places;
mod source;
mod texts;
mod values;

pub use graphs::{GraphOptions, random_constant, random_graph, random_parameters};
pub use places::{Ray, point_in_box, random_box, random_domain, random_ray, range_within};
pub use source::Rng;
pub use texts::random_text;
pub use values::{Adversarial, Ends};
