//! Notes on equations whose zeros are no surface: a point, a line, a curve, or nothing.

use super::reading::{Parameter, Surface, SurfaceKind};
use zeroset_ir::{Graph, Node, NodeId, ThinZeros, compact, display, substitute, thin_zeros};
use zeroset_ops::Op;
use zeroset_parser::{MAX_NOTES, Note, NoteKind};

/// Longest line that a note repeats, in characters.
const LONGEST: usize = 80;

/// Notes on equations whose zeros are proven to be no surface, at the parameters' current values.
pub(crate) fn thin_zeros_notes(
    graph: &Graph,
    surfaces: &[Surface],
    parameters: &[Parameter],
) -> Vec<Note> {
    let equations = surfaces.iter().filter(|surface| surface.kind == SurfaceKind::Equation);
    let note = |surface: &Surface| {
        let (mut graph, roots) = compact(graph, &[surface.root]);
        let mut root = roots[0];
        for parameter in parameters {
            let name = graph.parameter(parameter.number);
            let value = graph.constant(parameter.value.clone());
            root = substitute(&mut graph, root, name, value);
        }
        let zeros = thin_zeros(&mut graph, root)?;
        // A constant is refused later, and so is a root that has no value anywhere.
        let is_refused = matches!(graph.node(root), Node::Constant(_) | Node::Apply(Op::Sqrt, _));
        if is_refused && matches!(zeros, ThinZeros::Nowhere) {
            return None;
        }
        Some(Note { span: surface.span, kind: kind(&graph, zeros) })
    };
    equations.take(MAX_NOTES).filter_map(note).collect()
}

/// The note on a zero set, with the line that draws it.
fn kind(graph: &Graph, zeros: ThinZeros) -> NoteKind {
    let text = |id: NodeId| display(graph, id, &[]);
    let curve = |equations: [[NodeId; 2]; 2]| {
        let [one, other] =
            equations.map(|[left, right]| format!("{} = {}", text(left), text(right)));
        format!("curve {one}, {other}")
    };
    let (place, line) = match zeros {
        ThinZeros::Nowhere => return NoteKind::NoZeros,
        ThinZeros::Point(at) => ("at a point", format!("({})", at.map(text).join(", "))),
        ThinZeros::Line(equations) => ("on a line", curve(equations)),
        ThinZeros::Curve(equations) => ("on a curve, if anywhere", curve(equations)),
    };
    let line = Some(line).filter(|line| line.chars().count() <= LONGEST);
    NoteKind::ThinZeros { place, line }
}

#[cfg(test)]
mod tests {
    use crate::{Options, read};

    /// The note on the zeros of a text; empty without a note.
    fn note(text: &str) -> String {
        let document = read(text, &Options::default()).expect(text);
        let notes = document.notes.iter().map(|note| note.message());
        notes.filter(|note| note.contains("no surface") || note.contains("nowhere")).collect()
    }

    #[test]
    fn zeros_that_are_no_surface_are_named() {
        for (text, place, line) in [
            ("x^2 + y^2 = 0", "on a line", "curve x = 0, y = 0"),
            ("0 = -2x^2 - 3abs(z)", "on a line", "curve x = 0, z = 0"),
            ("x^2 = -y^2", "on a line", "curve x = 0, y = 0"),
            ("x^2 + x*y + y^2 - 3x - 3y + 3 = 0", "on a line", "curve x = 1, y = 1"),
            ("(x-y)^2 + (2z-x)^4 = 0", "on a line", "curve x = z*2, y = z*2"),
            ("a = 3; (x-a)^2 + sqrt(y^2) = 0", "on a line", "curve x = 3, y = 0"),
            ("x^2 + (y-z)^2 + (z-1/3)^2 = 0", "at a point", "(0, 1/3, 1/3)"),
            ("min(-x^2, -abs(y), -(z-1)^2) = 0", "at a point", "(0, 0, 1)"),
            ("(x^2+y^2-1)^2 + z^2 = 0", "on a curve", "curve z = 0, x^2 + y^2 - 1 = 0"),
            ("x^4*z^2 + (y-1)^2 + x^2 = 0", "on a line", "curve x = 0, y = 1"),
            ("x^2 + y^2 + 1 = 0", "nowhere", ""),
            ("x^2 + (x-1)^2 + z^4 = 0", "nowhere", ""),
        ] {
            let note = note(text);
            assert!(note.contains(place) && note.contains(line), "{text}: {note}");
        }
    }

    #[test]
    fn surfaces_get_no_such_note() {
        for text in [
            "x^2 - y^2 = 0",
            "(x - 1)^2 = 0",
            "x^2 + 2x*y + y^2 = 0",
            "x^2*y^2 + x^2*z^2 = 0",
            "max(x, 0)^2 + y^2 = 0",
            "(x^2 - y^2)^2 + (x - y)^4 = 0",
            "(x^2 - y^2)^2 + (x^2*z - x*y*z)^2 = 0",
            "x^2 + y^2 = z^2",
            "(x + abs(x))^2 + z^2 = 0",
            "x^2*(y^2 + z^2) = 0",
            "a = 1; (x - y)^2 + (a*x - y)^2 = 0",
            "sin(x)^2 + sin(2x)^2 = 0",
            "x^2 + y^2 - z^2 + 1 = 0",
            "x^2 + y^2 = 0 {z > 0}",
        ] {
            assert_eq!(note(text), "", "{text}");
        }
    }
}
