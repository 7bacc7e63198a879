//! The table of methods. Each has a file of its own. Help, status lines and JSON use the table.

mod affine;
mod bracket_gap;
mod knoll;
mod local_ray;
mod march;
mod mitchell;
mod outcome;
mod patch;
mod raa;
mod refine;
mod slabs;
mod slope;
mod sphere;

use crate::method::Method;

pub use patch::{PATCH, patch_tracer};
pub use slabs::MOST_STEPS;

/// All methods; the first is the default.
pub static METHODS: [Method; 6] =
    [affine::METHOD, knoll::METHOD, raa::METHOD, mitchell::METHOD, sphere::METHOD, march::METHOD];

impl Method {
    /// Returns the method with this name.
    pub fn named(name: &str) -> Option<&'static Self> {
        METHODS.iter().find(|method| method.name == name)
    }
}

impl Default for &'static Method {
    fn default() -> Self {
        &METHODS[0]
    }
}
