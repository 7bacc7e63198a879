//! The tetrahedra of a refined grid.

use crate::cells::Local;
use crate::grid::Tetrahedron;
use std::sync::Arc;
use zeroset_scene::choices::Choice;

/// A tetrahedron of the refined grid.
pub struct Leaf {
    pub cell: Tetrahedron,
    pub kind: Kind,
    /// True if the mesh must be [`Nearness::Near`] here.
    pub is_strict: bool,
}

/// A bound of the distance between mesh and surface in a tetrahedron, if the shape is proven.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Nearness {
    /// None is proven.
    Far,
    /// [`LOOSE`](crate::near::LOOSE) times the allowed distance.
    Loose,
    /// The allowed distance.
    Near,
}

/// The role of a tetrahedron in the mesh.
pub enum Kind {
    /// The surface may be in it.
    Open { local: Arc<Local>, near: Nearness },
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
