//! Shared support for tests, fuzz targets and benches of `zeroset`. No product code depends on it.
//!
//! - The independent [`Oracle`] states what is certain about a function at one exact point or over
//!   a box.
//! - The [`certified`] tracer finds the first root on a ray, slowly, with the oracle alone.
//! - Seeded generators draw adversarial numbers, boxes, points, rays and graphs. The graphs use
//!   every operation of the table, internal ones included.
//! - The [`suite`] checks any evaluator against the oracle over the whole table.
//! - [`crossings`] finds triangles of a mesh that cross, in exact arithmetic. [`Stl`] reads a file
//!   as any other program would, and finds its flaws.
//! - A [`property`] must hold for every input, which is drawn from a seed or from a fuzzer's bytes.
//!   [`attack`] tries a property on many inputs.
//! - A [`Case`] is a function with its domain and parameters. [`minimise`] shrinks a failing case.
//! - [`reproduce`] prints a failing case as a line that `zeroset eval` reads.

mod attack;
mod bounds;
mod case;
pub mod certified;
mod crossings;
mod effort;
pub mod machine;
mod minimize;
pub mod npy;
mod oracle;
pub mod programs;
pub mod property;
mod random;
mod reproduce;
pub mod simd;
mod stl;
pub mod suite;

pub use attack::attack;
pub use case::{Case, pack_boxes};
pub use crossings::{Crossings, crossings};
pub use effort::{Effort, count_claims};
pub use minimize::minimise;
pub use oracle::{BoxClaim, Claim, Defined, Oracle, enclose_at};
pub use random::{
    Adversarial, Ends, GraphOptions, Ray, Rng, Solid, point_in_box, random_box, random_constant,
    random_domain, random_graph, random_parameters, random_ray, random_solid, range_within,
};
pub use reproduce::{Place, hexadecimal, reproduce, reproduce_in, typed};
pub use stl::{Figures, Flaws, Stl};
