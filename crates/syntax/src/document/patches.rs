//! Lowers parametric surfaces to a graph of their own. Nothing here evaluates a surface.

use crate::document::curves::{check_ends, located};
use crate::document::reading::{DocumentReader, in_one_line};
use crate::lower::lowering::Lowering;
use crate::lower::value::Tensor;
use crate::picture::paint::SurfaceColor;
use zeroset_ir::{Axis, Graph, Node, NodeId, replaced};
use zeroset_parser::tree::ast::{CurveForm, Expr, Name, Statement};
use zeroset_parser::tree::built_statement::BuiltStatement;
use zeroset_parser::{Error, ErrorKind, Errors, Fallible, Span};
use zeroset_style::Material;

/// The parametric surfaces of a document, in one graph.
#[derive(Clone, Debug, Default)]
pub struct Patches {
    /// Functions of all surfaces, exactly as typed. The variables x and y of the graph stand for
    /// the two parameters of a surface. The graph has the parameters of the document.
    pub graph: Graph,
    /// The surfaces, in the order of the text.
    pub all: Vec<Patch>,
}

/// A surface to draw, given by its points for all values of two parameters u and v.
#[derive(Clone, Debug)]
pub struct Patch {
    /// The coordinates x, y and z, with nodes of [`Patches::graph`].
    pub at: [NodeId; 3],
    /// First and last value of u, then of v: nodes that depend on neither.
    pub ends: [[NodeId; 2]; 2],
    /// The names of u and v in the text.
    pub names: [String; 2],
    /// Place of the statement in the text.
    pub span: Span,
    /// The statement as it was read, in standard notation.
    pub echo: String,
    /// Color, from the `color` line that applies, as for a [`Surface`](crate::Surface).
    pub color: Option<SurfaceColor>,
    /// Opacity from 0 to 1, as for a [`Surface`](crate::Surface).
    pub opacity: f64,
    /// Material, from the `material` line that applies.
    pub material: &'static Material,
    /// True if a `hidden` line hides the surface.
    pub hidden: bool,
}

impl Patch {
    /// The statement as it was read, in one line.
    pub fn line(&self) -> String {
        in_one_line(&self.echo)
    }

    /// All nodes of the surface: coordinates, then the ends of the ranges.
    pub fn roots(&self) -> impl Iterator<Item = NodeId> {
        self.at.into_iter().chain(self.ends.into_iter().flatten())
    }
}

impl Patches {
    /// Returns whether there is no surface.
    pub fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Returns whether two documents have the same surfaces, apart from their style.
    pub fn are_alike(&self, other: &Self) -> bool {
        let roots =
            |patches: &Self| -> Vec<NodeId> { patches.all.iter().flat_map(Patch::roots).collect() };
        self.graph == other.graph && roots(self) == roots(other)
    }

    /// Returns whether any surface depends on the parameter with this number.
    pub fn depend_on(&self, parameter: u32) -> bool {
        let roots: Vec<NodeId> = self.all.iter().flat_map(Patch::roots).collect();
        let needed = self.graph.reachable(&roots);
        let node = Node::Parameter(parameter);
        self.graph.iter().any(|(id, other)| needed[id.index()] && *other == node)
    }
}

/// A surface with nodes of the graph in which it was lowered.
struct Lowered {
    at: [NodeId; 3],
    ends: [[NodeId; 2]; 2],
    names: [String; 2],
}

impl DocumentReader<'_> {
    /// Lowers the parametric surfaces among these statements. `free` is the number of the first
    /// parameter that the document does not use: it and the next one stand for u and v.
    pub(crate) fn patches<'d>(
        &mut self,
        statements: &[&'d BuiltStatement],
        mut lowering: Lowering<'d>,
        free: u32,
    ) -> Result<Patches, Errors> {
        let mut lowered = Vec::new();
        for one in statements {
            let Statement::Curve(curve) = &one.statement else { continue };
            let CurveForm::Patch { at, parameters, ranges } = &curve.form else { continue };
            let shape = patch(&mut lowering, (at, one.span), parameters, ranges, free);
            lowered.extend(self.ok_or_record(shape).map(|shape| (shape, *one)));
        }
        let limit = self.options.limits.surfaces;
        if let Some((_, one)) = lowered.get(limit) {
            let start = Span::at(one.span.start);
            return Err(Error::new(start, ErrorKind::TooManySurfaces { limit }).into());
        }
        self.check()?;
        self.notes.append(&mut lowering.notes);
        let roots: Vec<NodeId> = lowered
            .iter()
            .flat_map(|(shape, _)| shape.at.iter().chain(shape.ends.as_flattened()))
            .copied()
            .collect();
        let (graph, roots) = with_variables(&lowering.graph, &roots, free);
        let new = |((shape, one), roots): ((Lowered, &BuiltStatement), &[NodeId])| Patch {
            at: [roots[0], roots[1], roots[2]],
            ends: [[roots[3], roots[4]], [roots[5], roots[6]]],
            names: shape.names,
            span: one.span,
            echo: one.statement.to_string(),
            color: None,
            opacity: 1.0,
            material: Default::default(),
            hidden: false,
        };
        let all = lowered.into_iter().zip(roots.chunks_exact(7)).map(new).collect();
        Ok(Patches { graph, all })
    }
}

/// Lowers a surface. Its parameters have the numbers `free` and `free + 1` in the graph.
fn patch<'d>(
    lowering: &mut Lowering<'d>,
    (at, span): (&'d [Expr], Span),
    parameters: &'d [Name; 2],
    ranges: &'d [(Expr, Expr); 2],
    free: u32,
) -> Fallible<Lowered> {
    let [u, v] = [0, 1].map(|k| lowering.graph.parameter(free + k));
    let locals = [(u, &parameters[0]), (v, &parameters[1])]
        .map(|(node, name)| (name.text.as_str(), Tensor::Number(node)));
    let at = located(lowering, at, &locals, span)?;
    let mut ends = [[u; 2]; 2];
    for (nodes, (low, high)) in ends.iter_mut().zip(ranges) {
        *nodes = [lowering.value(low)?, lowering.value(high)?];
        check_ends(lowering, *nodes, [low, high])?;
    }
    Ok(Lowered { at, ends, names: parameters.each_ref().map(|name| name.text.clone()) })
}

/// The nodes that `roots` need. The variables x and y stand for the parameters `free` and
/// `free + 1`.
fn with_variables(graph: &Graph, roots: &[NodeId], free: u32) -> (Graph, Vec<NodeId>) {
    replaced(graph, roots, |copy, _, node| match node {
        Node::Parameter(number) if *number == free => Some(copy.variable(Axis::X)),
        Node::Parameter(number) if *number == free + 1 => Some(copy.variable(Axis::Y)),
        _ => None,
    })
}
