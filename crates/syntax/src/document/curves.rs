//! Lowers curves and points to a graph of their own. Nothing here traces a curve.

use crate::document::reading::DocumentReader;
use crate::lower::constant::values;
use crate::lower::lowering::Lowering;
use crate::lower::value::Tensor;
use crate::picture::paint::SurfaceColor;
use zeroset_ir::{Axis, Graph, Node, NodeId, compact};
use zeroset_ops::Op;
use zeroset_parser::tree::ast::{
    CurveForm, CurveStatement, Expr, ExprKind, NamedValue, Relation, Statement,
};
use zeroset_parser::tree::built_statement::BuiltStatement;
use zeroset_parser::{Error, ErrorKind, Errors, Fallible, Span};

/// The curves and points of a document, in one graph.
#[derive(Clone, Debug, Default)]
pub struct Curves {
    /// Functions of all curves and points, exactly as typed. The graph has the parameters of the
    /// document, and as its last one the parameter of the curves.
    pub graph: Graph,
    /// The curves and points, in the order of the text.
    pub all: Vec<Curve>,
}

impl Curves {
    /// Returns whether there is neither a curve nor a point.
    pub fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Returns whether two documents have the same curves and points, apart from their style.
    pub fn are_alike(&self, other: &Self) -> bool {
        let roots = |curves: &Self| -> Vec<Vec<NodeId>> {
            curves.all.iter().map(|curve| curve.shape.roots()).collect()
        };
        self.graph == other.graph && roots(self) == roots(other)
    }

    /// Returns whether any curve or point depends on the parameter with this number.
    pub fn depend_on(&self, parameter: u32) -> bool {
        let roots: Vec<NodeId> = self.all.iter().flat_map(|curve| curve.shape.roots()).collect();
        let needed = self.graph.reachable(&roots);
        let node = Node::Parameter(parameter);
        self.graph.iter().any(|(id, other)| needed[id.index()] && *other == node)
    }
}

/// A curve or a point to draw.
#[derive(Clone, Debug)]
pub struct Curve {
    /// Its shape, with nodes of [`Curves::graph`].
    pub shape: CurveShape,
    /// Place of the statement in the text.
    pub span: Span,
    /// The statement as it was read, in standard notation.
    pub echo: String,
    /// Color, from the `color` line that applies to the statement, as for a surface.
    pub color: Option<SurfaceColor>,
    /// Width in pixels, from the `width` line that applies, if there is one.
    pub width: Option<f64>,
    /// True if a `hidden` line hides it.
    pub hidden: bool,
}

/// The shape of a curve or a point.
#[derive(Clone, Debug)]
pub enum CurveShape {
    /// The points at which both functions are 0.
    Intersection([NodeId; 2]),
    /// The points with these coordinates, for all values of a parameter between two ends. The
    /// parameter has the number after the document's last parameter.
    Path {
        /// The coordinates x, y and z.
        at: [NodeId; 3],
        /// First and last value of the parameter.
        ends: [NodeId; 2],
    },
    /// A point.
    Point {
        /// The coordinates x, y and z.
        at: [NodeId; 3],
        /// The label; `None` for the coordinates.
        label: Option<String>,
    },
}

impl CurveShape {
    /// All nodes of the shape.
    pub fn roots(&self) -> Vec<NodeId> {
        match self {
            Self::Intersection(both) => both.to_vec(),
            Self::Path { at, ends } => at.iter().chain(ends).copied().collect(),
            Self::Point { at, .. } => at.to_vec(),
        }
    }

    /// Replaces all nodes of the shape by `nodes`, in the order of the shape's fields.
    fn replace(&mut self, mut nodes: impl Iterator<Item = NodeId>) {
        let all: Vec<&mut NodeId> = match self {
            Self::Intersection(both) => both.iter_mut().collect(),
            Self::Path { at, ends } => at.iter_mut().chain(ends).collect(),
            Self::Point { at, .. } => at.iter_mut().collect(),
        };
        for node in all {
            *node = nodes.next().unwrap_or(*node);
        }
    }
}

impl DocumentReader<'_> {
    /// Lowers the curves and points. `parameter` is the number of the curves' own parameter.
    pub(crate) fn curves<'d>(
        &mut self,
        statements: &[&'d BuiltStatement],
        mut lowering: Lowering<'d>,
        parameter: u32,
    ) -> Result<Curves, Errors> {
        let limit = self.options.limits.curves;
        if let Some(one) = statements.get(limit) {
            let start = Span::at(one.span.start);
            return Err(Error::new(start, ErrorKind::TooManyCurves { limit }).into());
        }
        let mut all = Vec::new();
        for one in statements {
            let Statement::Curve(curve) = &one.statement else { continue };
            let shape = self.ok_or_record(shape(&mut lowering, curve, parameter));
            all.extend(shape.flatten().map(|shape| Curve {
                shape,
                span: one.span,
                echo: one.statement.to_string(),
                color: None,
                width: None,
                hidden: false,
            }));
        }
        self.check()?;
        let roots: Vec<NodeId> = all.iter().flat_map(|curve| curve.shape.roots()).collect();
        let (graph, roots) = compact(&lowering.graph, &roots);
        let mut roots = roots.into_iter();
        for curve in &mut all {
            curve.shape.replace(&mut roots);
        }
        self.notes.append(&mut lowering.notes);
        Ok(Curves { graph, all })
    }
}

/// Lowers a curve to its shape. `None` for a surface. `parameter` is the number of a path's
/// parameter in the graph.
fn shape<'d>(
    lowering: &mut Lowering<'d>,
    curve: &'d CurveStatement,
    parameter: u32,
) -> Fallible<Option<CurveShape>> {
    Ok(Some(match &curve.form {
        CurveForm::Equations { equations, restrictions } => {
            let mut both = match equations.as_slice() {
                [one, other] => [function(lowering, one)?, function(lowering, other)?],
                [one] => complex(lowering, one)?,
                _ => return Err(Error::new(curve.span, ErrorKind::CurveEquations)),
            };
            for condition in restrictions {
                let root = both[0];
                let root = lowering.complete(|all| all.restrict(root, condition, &[]))?;
                both[0] = lowering.in_place(root, condition.span)?;
            }
            CurveShape::Intersection(both)
        }
        CurveForm::Path { at, parameter: name, range } => {
            let ends = [&range.0, &range.1];
            let node = lowering.graph.parameter(parameter);
            let locals = [(name.text.as_str(), Tensor::Number(node))];
            let at = located(lowering, at, &locals, curve.span)?;
            let mut nodes = [node; 2];
            for (node, end) in nodes.iter_mut().zip(ends) {
                *node = lowering.value(end)?;
            }
            check_ends(lowering, nodes, ends)?;
            CurveShape::Path { at, ends: nodes }
        }
        CurveForm::Point { at, label } => {
            let at = located(lowering, at, &[], curve.span)?;
            CurveShape::Point { at, label: label.clone() }
        }
        CurveForm::Patch { .. } => return Ok(None),
    }))
}

/// The function of a curve's equation.
fn function<'d>(lowering: &mut Lowering<'d>, expr: &'d Expr) -> Fallible<NodeId> {
    let root = lowering.complete(|all| all.equation(expr))?;
    let root = root.ok_or_else(|| Error::new(expr.span, ErrorKind::CurveEquations))?;
    lowering.in_place(root, expr.span)
}

/// The real and the imaginary part of an equation of complex numbers.
fn complex<'d>(lowering: &mut Lowering<'d>, expr: &'d Expr) -> Fallible<[NodeId; 2]> {
    let two = || Error::new(expr.span, ErrorKind::CurveEquations);
    let value = lowering.complete(|all| match &expr.kind {
        ExprKind::Compare(left, rest) => match rest.as_slice() {
            [(Relation::Equal, right)] => {
                let sides = all.values_of([left.as_ref(), right].into_iter(), &[])?;
                all.native(Op::Sub, &sides, expr.span)
            }
            _ => Err(two()),
        },
        _ if expr.is_condition() => Err(two()),
        _ => all.value_of(expr, &[]),
    })?;
    let Tensor::Complex(parts) = value else { return Err(two()) };
    let [real, imaginary] = <[NodeId; 2]>::try_from(parts).map_err(|_| two())?;
    Ok([lowering.in_place(real, expr.span)?, lowering.in_place(imaginary, expr.span)?])
}

/// The nodes of three coordinates or of a vector. Fails if they depend on x, y or z.
pub(crate) fn located<'d>(
    lowering: &mut Lowering<'d>,
    at: &'d [Expr],
    locals: &[(&'d str, Tensor)],
    span: Span,
) -> Fallible<[NodeId; 3]> {
    let nodes = lowering.complete(|all| match at {
        [vector] => match all.value_of(vector, locals)? {
            Tensor::Vector(nodes) => Ok(nodes),
            _ => Err(Error::new(vector.span, ErrorKind::PointSize { given: 1 })),
        },
        _ => at.iter().map(|part| all.number(part, locals)).collect(),
    })?;
    let given = nodes.len();
    let nodes = <[NodeId; 3]>::try_from(nodes);
    let nodes = nodes.map_err(|_| Error::new(span, ErrorKind::PointSize { given }))?;
    // Thousands of points of plain numbers need no search of the graph.
    let mut parts = at.iter().flat_map(Expr::all_parts);
    if parts.all(|part| matches!(part.kind, ExprKind::Number(_) | ExprKind::Negate(_))) {
        return Ok(nodes);
    }
    if let Some(axis) = axis_of(&lowering.graph, &nodes) {
        let coordinate = ExprKind::Name(NamedValue::Coordinate(axis));
        let own = at.iter().flat_map(Expr::all_parts).find(|part| part.kind == coordinate);
        let kind = ErrorKind::CurveCoordinate { name: axis.name() };
        return Err(Error::new(own.map_or(span, |part| part.span), kind));
    }
    Ok(nodes)
}

/// A coordinate on which some of `roots` depend.
fn axis_of(graph: &Graph, roots: &[NodeId]) -> Option<Axis> {
    let needed = graph.reachable(roots);
    graph.iter().filter(|(id, _)| needed[id.index()]).find_map(|(_, node)| match node {
        Node::Variable(axis) => Some(*axis),
        Node::Parameter(_) | Node::Constant(_) | Node::Apply(..) => None,
    })
}

/// Fails if the ends of a range vary from point to point, have no value, or are not in order.
pub(crate) fn check_ends(
    lowering: &Lowering<'_>,
    nodes: [NodeId; 2],
    ends: [&Expr; 2],
) -> Fallible<()> {
    let span = ends[0].span.to(ends[1].span);
    if let Some(axis) = axis_of(&lowering.graph, &nodes) {
        return Err(Error::new(span, ErrorKind::NotConstant { name: axis.name().to_owned() }));
    }
    let needed = lowering.graph.reachable(&nodes);
    let mut all = lowering.graph.iter().filter(|(id, _)| needed[id.index()]);
    if all.any(|(_, node)| matches!(node, Node::Parameter(_))) {
        return Ok(());
    }
    let known = values(&lowering.graph, &nodes);
    for (value, end) in known.iter().zip(ends) {
        if value.is_none() {
            return Err(Error::new(end.span, ErrorKind::UndefinedConstant));
        }
    }
    match known.as_slice() {
        [Some(low), Some(high)] if low.bounds().lo >= high.bounds().hi => {
            Err(Error::new(span, ErrorKind::EmptyRange))
        }
        _ => Ok(()),
    }
}
