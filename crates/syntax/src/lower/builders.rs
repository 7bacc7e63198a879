//! Lowers builders: primitives, moves and copies of solids.
//!
//! A move evaluates the function of a solid at another point. Nothing is copied at once: the moved
//! function becomes a placeholder in the graph, which [`Lowering::in_place`] expands at the end.
//! The function is then visited once for each point at which it is evaluated. So nested moves cost
//! what the result costs, and equal moves of one solid cost nothing more.

use crate::lower::choice::integer_of;
use crate::lower::lowering::{Lowering, VISITS, move_to_use};
use crate::lower::prelude;
use crate::lower::value::Tensor;
use rustc_hash::{FxHashMap, FxHashSet};
use zeroset_ir::{Axis, Constant, Graph, Node, NodeId};
use zeroset_ops::{BUILDERS, Builder, Op, Role};
use zeroset_parser::tree::ast::Function;
use zeroset_parser::tree::series::MAX_TERMS;
use zeroset_parser::{Error, ErrorKind, Fallible, Limits, Note, NoteKind, Span};

/// Placeholders are parameters from this number on. A document has fewer parameters.
const FIRST_PLACEHOLDER: u32 = 1 << 31;

/// The center of a primitive, among the values of its parameters.
const CENTER: &str = "center";

/// Parameters of a builder with their values.
type Values = Vec<(&'static str, Tensor)>;

/// A function, and the point at which it is evaluated.
type Move = (NodeId, [NodeId; 3]);

/// The moved functions of a lowering.
#[derive(Default)]
pub(crate) struct Moves {
    all: Vec<Move>,
    numbers: FxHashMap<Move, u32>,
    /// For each node examined so far: whether its value depends on the coordinates.
    varies: Vec<bool>,
    /// For each node examined so far: the axes that its value depends on, as bits.
    axes: Vec<u8>,
    /// For each node examined so far: whether it depends on a placeholder.
    is_moved: Vec<bool>,
    /// The values of builders.
    distances: FxHashSet<NodeId>,
}

impl Moves {
    /// The move that a node stands for; `None` for all nodes but placeholders.
    pub(crate) fn get(&self, node: &Node) -> Option<Move> {
        match node {
            Node::Parameter(number) => {
                let index = number.checked_sub(FIRST_PLACEHOLDER)?;
                self.all.get(index as usize).copied()
            }
            Node::Variable(_) | Node::Constant(_) | Node::Apply(..) => None,
        }
    }

    /// Returns whether a node is the value of a builder, or a minimum, maximum or opposite of such
    /// values.
    fn is_distance(&self, graph: &Graph, node: NodeId) -> bool {
        let mut open = vec![node];
        let mut seen = FxHashSet::default();
        while let Some(node) = open.pop() {
            match graph.node(node) {
                _ if self.distances.contains(&node) || !seen.insert(node) => {}
                Node::Apply(Op::Min | Op::Max | Op::Neg, operands) => open.extend(operands.iter()),
                Node::Constant(_) => {}
                Node::Variable(_) | Node::Parameter(_) | Node::Apply(..) => return false,
            }
        }
        true
    }

    /// Returns whether there are no moves.
    pub(crate) fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Examines the nodes that were added to `graph` since the last call.
    fn examine(&mut self, graph: &Graph) {
        for (_, node) in graph.since(self.varies.len()) {
            let (varies, is_moved) = match node {
                Node::Variable(_) => (true, false),
                Node::Parameter(_) => {
                    [(false, false), (true, true)][usize::from(self.get(node).is_some())]
                }
                Node::Constant(_) => (false, false),
                Node::Apply(_, operands) => (
                    operands.iter().any(|operand| self.varies[operand.index()]),
                    operands.iter().any(|operand| self.is_moved[operand.index()]),
                ),
            };
            let axes = match node {
                Node::Variable(axis) => 1 << *axis as u8,
                Node::Constant(_) => 0,
                Node::Parameter(_) => self.get(node).map_or(0, |(shape, point)| {
                    let needs = self.axes[shape.index()];
                    let through = |(at, place): (usize, &NodeId)| {
                        if needs >> at & 1 == 1 { self.axes[place.index()] } else { 0 }
                    };
                    point.iter().enumerate().map(through).fold(0, |all, axes| all | axes)
                }),
                Node::Apply(_, operands) => {
                    operands.iter().fold(0, |all, operand| all | self.axes[operand.index()])
                }
            };
            self.axes.push(axes);
            self.varies.push(varies);
            self.is_moved.push(is_moved);
        }
    }
}

impl Lowering<'_> {
    /// Lowers a call of a builder. Each argument has its place in the text.
    #[inline(never)]
    pub(crate) fn build(
        &mut self,
        name: &'static str,
        arguments: &[(Tensor, Span)],
        span: Span,
    ) -> Fallible<Tensor> {
        let (index, mut values) = self.bound(name, arguments, span)?;
        for (value, (_, role)) in values.iter_mut().zip(BUILDERS[index].parameters) {
            if let (Role::Distance, (_, Tensor::Number(node))) = (role, value)
                && !self.moves.is_distance(&self.graph, *node)
            {
                *node = self.as_distance(*node, span)?;
                let kind = NoteKind::DividedByGradient { name };
                self.notes.push(Note { span, kind });
            }
        }
        let key = values.iter().map(|(_, value)| value.clone()).collect();
        let key = (Function::Builder(name), key);
        if let Some(value) = self.calls.get(&key) {
            return Ok(value.clone());
        }
        let noted = self.notes.len();
        let value = self.built(index, values, span);
        let (value, fixed) = value.map_err(|error| move_to_use(error, span, false))?;
        self.notes.truncate(noted);
        if let Some(axis) = fixed {
            let axis = ['x', 'y', 'z'][axis as usize];
            self.notes.push(Note { span, kind: NoteKind::ShapeAtZero { name, axis } });
        }
        self.calls.insert(key, Tensor::Number(value));
        self.moves.distances.insert(value);
        Ok(Tensor::Number(value))
    }

    /// The row of [`BUILDERS`] that fits the arguments, and the values of its parameters.
    fn bound(
        &self,
        name: &'static str,
        arguments: &[(Tensor, Span)],
        span: Span,
    ) -> Fallible<(usize, Values)> {
        let rows = BUILDERS.iter().enumerate().filter(|(_, row)| row.name == name);
        // The error of the row that fits the most arguments is the one to report.
        let mut nearest: Option<(usize, Box<Error>)> = None;
        for (index, row) in rows.filter(|(_, row)| row.takes(arguments.len())) {
            match bind(&self.graph, row, arguments, span) {
                Ok(values) => return Ok((index, values)),
                Err((fitted, error)) => {
                    if nearest.as_ref().is_none_or(|(most, _)| fitted > *most) {
                        nearest = Some((fitted, error));
                    }
                }
            }
        }
        let error = nearest.map(|(_, error)| error);
        Err(error.unwrap_or_else(|| Error::new(span, ErrorKind::Empty)))
    }

    /// Lowers the formula of a builder. If its shape depends on an axis whose coordinate the
    /// builder fixes, returns that axis too.
    fn built(
        &mut self,
        index: usize,
        mut locals: Values,
        span: Span,
    ) -> Fallible<(NodeId, Option<Axis>)> {
        let row = &BUILDERS[index];
        let (place, body) = prelude::builder(index);
        let count = row.parameters.iter().position(|(_, role)| *role == Role::Count);
        let center = locals.pop_if(|(name, _)| *name == CENTER);
        let copies = match count.map(|at| &locals[at].1) {
            Some(Tensor::Number(node)) => integer_of(&self.graph, *node, &mut { 256 }).unwrap_or(1),
            _ => 1,
        };
        let is_shape = |role| matches!(role, Role::Shape | Role::Distance);
        let shape = row.parameters.iter().position(|(_, role)| is_shape(*role));
        let mut all = Vec::new();
        let mut fixed = None;
        for copy in 0..copies {
            let mut locals = locals.clone();
            locals.push(("i", Tensor::Number(self.graph.integer(copy))));
            if let (Some(place), Some(shape)) = (place, shape)
                && let [x, y, z] = *self.value_of(place, &locals)?.parts()
                && let Tensor::Number(node) = locals[shape].1
            {
                self.moves.examine(&self.graph);
                let is_zero =
                    |place: NodeId| self.graph.number(place).is_some_and(Constant::is_zero);
                let needs = self.moves.axes[node.index()];
                fixed = Axis::ALL.into_iter().zip([x, y, z]).find_map(|(axis, place)| {
                    (needs >> axis as u8 & 1 == 1 && is_zero(place)).then_some(axis)
                });
                locals[shape].1 = Tensor::Number(self.moved(node, [x, y, z]));
            }
            all.push(self.number(body, &locals)?);
        }
        let mut value = self.balanced(row, all);
        if let Some((_, Tensor::Vector(center))) = center {
            let mut point = Axis::ALL.map(|axis| self.graph.variable(axis));
            for (coordinate, center) in point.iter_mut().zip(&center) {
                *coordinate = self.graph.apply(Op::Sub, &[*coordinate, *center]);
            }
            value = self.moved(value, point);
        }
        self.check_size(span)?;
        Ok((value, fixed))
    }

    /// Joins copies as a tree whose depth is the logarithm of their number.
    fn balanced(&mut self, row: &Builder, mut all: Vec<NodeId>) -> NodeId {
        let Some(join) = row.join else { return all[0] };
        while all.len() > 1 {
            let pair = |pair: &[NodeId]| match pair {
                [left, right] => self.graph.apply(join, &[*left, *right]),
                single => single[0],
            };
            all = all.chunks(2).map(pair).collect();
        }
        all[0]
    }

    /// The function at node `shape`, evaluated at another point.
    fn moved(&mut self, shape: NodeId, point: [NodeId; 3]) -> NodeId {
        if matches!(self.graph.node(shape), Node::Constant(_)) {
            return shape;
        }
        let moves = &mut self.moves;
        let next = FIRST_PLACEHOLDER + moves.all.len() as u32;
        let number = *moves.numbers.entry((shape, point)).or_insert(next);
        if number == next {
            moves.all.push((shape, point));
        }
        self.graph.parameter(number)
    }

    /// The function at `root` without placeholders: each moved function is written out at the point
    /// at which it is evaluated.
    ///
    /// # Errors
    /// Fails if the function is larger than the limits allow.
    pub(crate) fn in_place(&mut self, root: NodeId, span: Span) -> Fallible<NodeId> {
        if self.moves.is_empty() {
            return Ok(root);
        }
        let here = Axis::ALL.map(|axis| self.graph.variable(axis));
        let mut points = vec![here];
        let mut numbers: FxHashMap<[NodeId; 3], usize> = FxHashMap::from_iter([(here, 0)]);
        let mut done: FxHashMap<(NodeId, usize), NodeId> = FxHashMap::default();
        let mut open = vec![(root, 0)];
        let mut visits = 0;
        while let Some(&(node, at)) = open.last() {
            visits += 1;
            self.check_size(span)?;
            let Limits { nodes: limit, .. } = *self.limits;
            if visits > limit.saturating_mul(VISITS) {
                return Err(Error::new(span, ErrorKind::TooLarge { limit }));
            }
            self.moves.examine(&self.graph);
            let index = node.index();
            let stays = !self.moves.varies[index] || at == 0 && !self.moves.is_moved[index];
            let found = if stays || done.contains_key(&(node, at)) {
                Some(*done.get(&(node, at)).unwrap_or(&node))
            } else {
                let get = |node: NodeId, at: usize| done.get(&(node, at)).copied();
                let mut needs = |all: &[NodeId]| -> Option<Vec<NodeId>> {
                    let known: Vec<Option<NodeId>> = all.iter().map(|one| get(*one, at)).collect();
                    for (one, known) in all.iter().zip(&known) {
                        if known.is_none() {
                            open.push((*one, at));
                        }
                    }
                    known.into_iter().collect()
                };
                match self.graph.node(node).clone() {
                    Node::Variable(axis) => Some(points[at][axis as usize]),
                    Node::Constant(_) => Some(node),
                    Node::Apply(op, operands) => {
                        needs(&operands).map(|operands| self.graph.apply(op, &operands))
                    }
                    parameter @ Node::Parameter(_) => match self.moves.get(&parameter) {
                        None => Some(node),
                        Some((shape, point)) => match needs(&point).as_deref() {
                            Some(&[x, y, z]) => {
                                let next = points.len();
                                let to = *numbers.entry([x, y, z]).or_insert(next);
                                if to == next {
                                    points.push([x, y, z]);
                                }
                                let found = done.get(&(shape, to)).copied();
                                if found.is_none() {
                                    open.push((shape, to));
                                }
                                found
                            }
                            _ => None,
                        },
                    },
                }
            };
            if let Some(found) = found {
                done.insert((node, at), found);
                open.pop();
            }
        }
        Ok(done[&(root, 0)])
    }
}

/// The values of a row's parameters. An error comes with the number of arguments before it.
fn bind(
    graph: &Graph,
    row: &'static Builder,
    arguments: &[(Tensor, Span)],
    span: Span,
) -> Result<Values, (usize, Box<Error>)> {
    let mut values = Vec::new();
    let mut at = 0;
    let usage = || usage(row.name);
    let wrong = |at: usize, place: Span, argument, needs, given| {
        let kind =
            ErrorKind::BuilderArgument { name: row.name, argument, needs, given, usage: usage() };
        (at, Error::new(place, kind))
    };
    for (name, role) in row.parameters {
        let rest = &arguments[at.min(arguments.len())..];
        let Some((first, place)) = rest.first() else {
            return Err(wrong(at, span, name, needs(*role), "missing"));
        };
        let before = at;
        let value = if role.is_vector() {
            match (first, rest) {
                (Tensor::Vector(nodes), _) if nodes.len() == 3 => {
                    at += 1;
                    Some(first.clone())
                }
                (Tensor::Number(x), [_, (Tensor::Number(y), _), (Tensor::Number(z), _), ..]) => {
                    at += 3;
                    Some(Tensor::Vector(vec![*x, *y, *z]))
                }
                _ => None,
            }
        } else {
            at += 1;
            matches!(first, Tensor::Number(_)).then(|| first.clone())
        };
        let Some(value) = value else {
            return Err(wrong(before, *place, name, needs(*role), kind_of(first)));
        };
        let is_solid = matches!(role, Role::Shape | Role::Distance) && row.join.is_none();
        if is_solid && is_shape_last(graph, arguments) {
            return Err(wrong(before, *place, name, needs(*role), "a number"));
        }
        if let Some(given) = misfit(graph, *role, &value) {
            let end = arguments[at - 1].1;
            return Err(wrong(before, place.to(end), name, needs(*role), given));
        }
        values.push((*name, value));
    }
    match &arguments[at.min(arguments.len())..] {
        [] => Ok(values),
        [(center @ Tensor::Vector(nodes), _)] if nodes.len() == 3 && row.has_center() => {
            values.push((CENTER, center.clone()));
            Ok(values)
        }
        [(other, place), ..] if row.has_center() => {
            let needs = needs(Role::Vector);
            Err(wrong(at, *place, CENTER, needs, kind_of(other)))
        }
        [(_, place), ..] => {
            let expected = format!("{} arguments", row.least());
            let (name, given) = (row.name.to_owned(), arguments.len());
            let kind = ErrorKind::WrongCount { name, expected, given, usage: Some(usage()) };
            Err((at, Error::new(*place, kind)))
        }
    }
}

/// Returns whether only the last argument varies in space: as in other systems, the shape is last
/// in `translate(1, 0, 0, sphere(1))`.
fn is_shape_last(graph: &Graph, arguments: &[(Tensor, Span)]) -> bool {
    let [numbers @ .., (Tensor::Number(last), _)] = arguments else { return false };
    let moves = |id: &NodeId| match graph.node(*id) {
        Node::Parameter(number) => *number >= FIRST_PLACEHOLDER,
        node => matches!(node, Node::Variable(_)),
    };
    let varies = |node: NodeId| graph.needed(&[node]).iter().any(moves);
    let is_fixed =
        |(value, _): &(Tensor, Span)| matches!(value, Tensor::Number(node) if !varies(*node));
    matches!(numbers.len(), 1 | 3) && numbers.iter().all(is_fixed) && varies(*last)
}

/// Advice that shows an example of each builder with this name.
fn usage(name: &str) -> String {
    let all: Vec<String> =
        zeroset_ops::builders(name).map(|row| format!("`{}`: {}", row.usage, row.doc)).collect();
    format!("write it as in {}", all.join("; or as in "))
}

/// The words for the values that a role allows.
fn needs(role: Role) -> &'static str {
    match role {
        Role::Shape | Role::Distance => "a function of x, y and z",
        Role::Vector => "a vector such as (1, 0, 0), or three numbers",
        Role::Direction => "a vector such as (0, 0, 1) of which not all is 0",
        Role::Sizes => "three numbers above 0",
        Role::Cells => "three numbers of which none is below 0 and one is above",
        Role::Size => "a number above 0",
        Role::Number => "a number",
        Role::Count => "a constant whole number from 1 to 1000",
    }
}

/// The kind of a value in words, for error messages.
fn kind_of(value: &Tensor) -> &'static str {
    match value {
        Tensor::Number(_) => "a number",
        Tensor::Vector(nodes) if nodes.len() == 2 => "a vector of two numbers",
        Tensor::Vector(nodes) if nodes.len() == 4 => "a vector of four numbers",
        Tensor::Vector(_) => "a vector",
        Tensor::Matrix(_) => "a matrix",
        Tensor::Complex(nodes) if nodes.len() == 2 => "a complex number",
        Tensor::Complex(_) => "a quaternion",
    }
}

/// The words for a value that its role does not allow; `None` if the value fits, or may fit.
fn misfit(graph: &Graph, role: Role, value: &Tensor) -> Option<&'static str> {
    let sign = |node: &NodeId| {
        let bounds = graph.number(*node).map(Constant::bounds)?;
        Some(if bounds.lo > 0.0 {
            1
        } else if bounds.hi < 0.0 {
            -1
        } else {
            0
        })
    };
    let signs: Vec<Option<i32>> = value.parts().iter().map(sign).collect();
    let all_zero = signs.iter().all(|sign| *sign == Some(0));
    match role {
        Role::Shape | Role::Distance | Role::Vector | Role::Number => None,
        Role::Size | Role::Sizes | Role::Cells if signs.contains(&Some(-1)) => Some("below 0"),
        Role::Size | Role::Sizes => signs.contains(&Some(0)).then_some("0"),
        Role::Direction | Role::Cells => all_zero.then_some("0"),
        Role::Count => match value {
            Tensor::Number(node) => match integer_of(graph, *node, &mut { 256 }) {
                None => Some("not known to be one"),
                Some(count) if count < 1 => Some("below 1"),
                Some(count) => (count > MAX_TERMS).then_some("above 1000"),
            },
            Tensor::Vector(_) | Tensor::Matrix(_) | Tensor::Complex(_) => None,
        },
    }
}
