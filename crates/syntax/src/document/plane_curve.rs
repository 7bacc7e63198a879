//! A note on equations of two coordinates, which people mostly type for a curve in a plane.

use super::reading::{Surface, SurfaceKind};
use rustc_hash::FxHashSet;
use zeroset_ir::{Axis, Graph, Node};
use zeroset_parser::{Note, NoteKind};

/// Longest equation that a note repeats, in characters.
const LONGEST: usize = 60;

/// For each axis, the view along it.
const VIEWS: [&str; 3] = ["right", "front", "top"];

/// The note on the first of some surfaces, if all are equations in which the same coordinate does
/// not occur, and both others do.
///
/// Equations with names in `generated` cannot be typed.
pub fn plane_curve_note(
    graph: &Graph,
    surfaces: &[Surface],
    generated: &FxHashSet<String>,
) -> Option<Note> {
    let first = surfaces.first()?;
    let axis = missing(graph, first)?;
    let is_alike = |surface: &Surface| {
        surface.kind == SurfaceKind::Equation && missing(graph, surface) == Some(axis)
    };
    let equation = first.line();
    // A restriction or a choice has a comma of its own.
    let is_simple = !equation.contains(['{', ','])
        && equation.chars().count() <= LONGEST
        && !generated.iter().any(|name| equation.contains(name.as_str()));
    (is_simple && surfaces.iter().all(is_alike)).then(|| {
        let view = VIEWS[axis as usize];
        let axis = ['x', 'y', 'z'][axis as usize];
        Note { span: first.span, kind: NoteKind::PlaneCurve { axis, equation, view } }
    })
}

/// The only coordinate that does not occur in a surface's function.
fn missing(graph: &Graph, surface: &Surface) -> Option<Axis> {
    let mut occurs = [false; 3];
    for id in graph.needed(&[surface.root]) {
        if let Node::Variable(axis) = graph.node(id) {
            occurs[*axis as usize] = true;
        }
    }
    let mut others = Axis::ALL.into_iter().filter(|axis| !occurs[*axis as usize]);
    others.next().filter(|_| others.next().is_none())
}
