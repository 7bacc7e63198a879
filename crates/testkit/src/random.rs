//! Random inputs that are more often unpleasant than not.
//!
//! Everything is drawn from a seeded [`Rng`] by integer arithmetic and exact scaling, so a seed gives
//! the same inputs on every platform. What is done with them is not known here.

mod graphs;
mod places;
mod values;

pub use fastrand::Rng;
pub use graphs::{GraphOptions, random_constant, random_graph, random_parameters};
pub use places::{Ray, point_in_box, random_box, random_domain, random_ray, range_within};
pub use values::{Adversarial, Ends};
