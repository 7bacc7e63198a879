//! Random inputs, most of them adversarial.
//!
//! Every input is drawn from an [`Rng`] by integer arithmetic and exact scaling, so the same seed
//! or bytes give the same inputs on every platform. The caller decides how to use the inputs.

mod graphs;
mod places;
mod seams;
mod solids;
mod source;
mod texts;
mod values;

pub use graphs::{GraphOptions, random_constant, random_graph, random_parameters};
pub use places::{Ray, point_in_box, random_box, random_domain, random_ray, range_within};
pub use seams::{random_limit, random_seam};
pub use solids::{Solid, random_solid};
pub use source::Rng;
pub use texts::random_text;
pub use values::{Adversarial, Ends};
