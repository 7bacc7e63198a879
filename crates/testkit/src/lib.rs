//! What the tests, fuzz targets and benches of `zeroset` share; no product code depends on it.
//!
//! - The independent [`Oracle`] says what is certain of a function at one exact point.
//! - Seeded generators draw adversarial numbers, boxes, points, rays and graphs over every row of
//!   the table of operations, internal ones included.
//! - [`reproduce`] prints a failing case as a line that `zeroset eval` reads.

mod oracle;

pub use oracle::{Claim, Defined, Oracle, enclose_at};
