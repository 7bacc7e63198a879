//! The tetrahedra of a refined grid.

use crate::cells::Local;
use crate::grid::Tetrahedron;
use std::sync::Arc;
use zeroset_scene::choices::Choice;

/// A tetrahedron of the refined grid.
pub struct Leaf {
    pub cell: Tetrahedron,
    pub kind: Kind,
}

/// The role of a tetrahedron in the mesh.
pub enum Kind {
    /// The surface may be in it. `near` states that the mesh is proven to be within the tolerance.
    Open { local: Arc<Local>, near: bool },
    /// It is inside a solid, and has a face on the boundary of the domain.
    Inside(Arc<Choice>),
}

impl Leaf {
    /// The function in the tetrahedron.
    pub fn choice(&self) -> &Arc<Choice> {
        match &self.kind {
            Kind::Open { local, .. } => &local.choice,
            Kind::Inside(choice) => choice,
        }
    }
}
