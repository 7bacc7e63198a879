//! What the tests, fuzz targets and benches of `zeroset` share; no product code depends on it.
//!
//! - The independent [`Oracle`] says what is certain of a function at one exact point.
//! - The [`certified`] tracer finds the first root on a ray, slowly, by the oracle alone.
//! - Seeded generators draw adversarial numbers, boxes, points, rays and graphs over every row of
//!   the table of operations, internal ones included.
//! - The [`suite`] holds any evaluator against the oracle over the whole table.
//! - A [`property`] is what must hold of one input, drawn from a seed or from a fuzzer's bytes;
//!   [`attack`] tries it on many.
//! - A [`Case`] is a function over a domain with its parameters; [`minimise`] makes a failing one
//!   smaller.
//! - [`reproduce`] prints a failing case as a line that `zeroset eval` reads.

mod attack;
mod case;
pub mod certified;
mod effort;
pub mod machine;
mod minimise;
pub mod npy;
mod oracle;
pub mod property;
mod random;
mod reproduce;
pub mod suite;

pub use attack::attack;
pub use case::{Case, pack_boxes};
pub use effort::Effort;
pub use minimise::minimise;
pub use oracle::{BoxClaim, Claim, Defined, Oracle, enclose_at};
pub use random::{
    Adversarial, Ends, GraphOptions, Ray, Rng, point_in_box, random_box, random_constant,
    random_domain, random_graph, random_parameters, random_ray, range_within,
};
pub use reproduce::{Place, hexadecimal, reproduce, reproduce_in, typed};
