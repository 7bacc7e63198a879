//! The parts of a function that is a choice of minima and maxima.

use crate::kernels::{CodeStore, Evaluator};
use crate::program::{Program, ProgramError};
use crate::simplified::Simplified;
use num_rational::BigRational;
use num_traits::{Signed, Zero};
use std::sync::{Arc, OnceLock};
use zeroset_interval::Interval;
pub use zeroset_ir::Level;
use zeroset_ir::{
    Axis, Constant, Graph, Node, NodeId, gradient, levels, multiples, planes, sheets, simplify,
    substitute,
};
use zeroset_ops::Op;
use zeroset_space::{Ball, HalfSpace, Region};

/// Largest number of parts.
const MOST_PARTS: usize = 1024;
/// Largest number of parts that are all linear.
const MOST_PLANES: usize = 4096;

/// Operations of choices of linear functions.
const LINEAR: [Op; 8] = [Op::Min, Op::Max, Op::Abs, Op::Neg, Op::Add, Op::Sub, Op::Mul, Op::Div];

/// Minima and maxima of parts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Choice {
    /// The part with this number.
    Part(usize),
    /// The part with this number, with the opposite sign: a solid's part where a face of another
    /// part is coincident, and looks the other way.
    Opposite(usize),
    /// The least of some functions, at least two.
    Min(Vec<Choice>),
    /// The greatest of some functions, at least two.
    Max(Vec<Choice>),
}

/// A function as a choice of parts.
pub struct Choices {
    /// The function.
    pub choice: Choice,
    /// A program whose surfaces are the parts.
    pub parts: Program,
    /// For an equation, the number of the first part that restricts the function or cuts the
    /// region. For a solid, the number of parts.
    pub first_cut: usize,
    /// For each part, the function of which it is a level. Zeros of parts in one group never meet.
    pub levels: Vec<Level>,
}

/// A function as a choice of linear functions.
pub struct FlatChoice {
    /// The function.
    pub choice: Choice,
    /// Each part's coefficients of x, y and z, and its constant.
    pub planes: Vec<[BigRational; 4]>,
}

impl Choice {
    /// The greatest of some functions, at least one.
    fn greatest(all: Vec<Self>) -> Self {
        let mut flat: Vec<Self> = all
            .into_iter()
            .flat_map(|one| match one {
                Self::Max(inner) => inner,
                other => vec![other],
            })
            .collect();
        if flat.len() == 1 { flat.remove(0) } else { Self::Max(flat) }
    }

    /// Returns whether a choice is this choice, or one of its alternatives at any depth.
    pub fn has(&self, other: &Self) -> bool {
        match self {
            Self::Min(all) | Self::Max(all) if self != other => {
                all.iter().any(|one| one.has(other))
            }
            _ => self == other,
        }
    }

    /// The choice with other parts: those at these places, which are opposite if the flag is set.
    fn replaced(self, parts: &[(usize, bool)]) -> Self {
        let each = |all: Vec<Self>| all.into_iter().map(|one| one.replaced(parts)).collect();
        match self {
            Self::Part(part) | Self::Opposite(part) => {
                let (other, is_opposite) = parts[part];
                let is_opposite = is_opposite != matches!(self, Self::Opposite(_));
                if is_opposite { Self::Opposite(other) } else { Self::Part(other) }
            }
            Self::Min(all) => Self::Min(each(all)),
            Self::Max(all) => Self::Max(each(all)),
        }
    }
}

/// Replaces parts of a solid's function whose zeros bound the same sets by the first of these
/// parts. The choice keeps its sign up to thin sets, but not its value.
fn merge(
    graph: &Graph,
    choice: Choice,
    parts: &mut Vec<NodeId>,
    parameters: &[Interval],
) -> Choice {
    let mut merged = multiples(graph, parts, parameters);
    let mut kept: Vec<NodeId> = Vec::new();
    for place in 0..parts.len() {
        let (first, is_opposite) = merged[place];
        if first == place {
            kept.push(parts[place]);
            merged[place] = (kept.len() - 1, false);
        } else {
            merged[place] = (merged[first].0, is_opposite);
        }
    }
    *parts = kept;
    choice.replaced(&merged)
}

/// Nodes in place of numbers of parts.
#[derive(Clone)]
enum Nodes {
    Part(NodeId),
    Min(Vec<Nodes>),
    Max(Vec<Nodes>),
}

impl Nodes {
    /// The same choice with `f` applied to each node. Minima and maxima are exchanged if `turned`.
    fn map(
        self,
        graph: &mut Graph,
        turned: bool,
        f: &dyn Fn(&mut Graph, NodeId) -> NodeId,
    ) -> Self {
        let mut each = |all: Vec<Self>| all.into_iter().map(|n| n.map(graph, turned, f)).collect();
        match self {
            Self::Min(all) if turned => Self::Max(each(all)),
            Self::Max(all) if turned => Self::Min(each(all)),
            Self::Min(all) => Self::Min(each(all)),
            Self::Max(all) => Self::Max(each(all)),
            Self::Part(node) => Self::Part(f(graph, node)),
        }
    }

    /// The sum with another choice, or the difference: a choice of sums of two parts.
    fn sum(self, graph: &mut Graph, op: Op, other: &Self) -> Self {
        let mut each = |all: Vec<Self>| all.into_iter().map(|n| n.sum(graph, op, other)).collect();
        match self {
            Self::Min(all) => Self::Min(each(all)),
            Self::Max(all) => Self::Max(each(all)),
            Self::Part(one) => other
                .clone()
                .map(graph, op == Op::Sub, &|graph, part| graph.apply(op, &[one, part])),
        }
    }

    fn parts(&self) -> usize {
        match self {
            Self::Part(_) => 1,
            Self::Min(all) | Self::Max(all) => all.iter().map(Self::parts).sum(),
        }
    }

    /// The choice, with its parts numbered and added to `parts`.
    fn numbered(self, parts: &mut Vec<NodeId>) -> Choice {
        let mut each = |all: Vec<Self>, is_min: bool| {
            let mut flat = Vec::new();
            for choice in all.into_iter().map(|choice| choice.numbered(parts)) {
                match choice {
                    Choice::Min(inner) if is_min => flat.extend(inner),
                    Choice::Max(inner) if !is_min => flat.extend(inner),
                    other => flat.push(other),
                }
            }
            flat
        };
        match self {
            Self::Min(all) => Choice::Min(each(all, true)),
            Self::Max(all) => Choice::Max(each(all, false)),
            Self::Part(node) => {
                let number = parts.iter().position(|part| *part == node).unwrap_or_else(|| {
                    parts.push(node);
                    parts.len() - 1
                });
                Choice::Part(number)
            }
        }
    }
}

/// For each node, whether it is a choice: a minimum, maximum or absolute value, a sum with a
/// choice, or a multiple of one.
fn choices(graph: &Graph) -> Vec<bool> {
    let mut found = vec![false; graph.len()];
    for (id, node) in graph.iter() {
        if let Node::Apply(op, operands) = node {
            found[id.index()] = match op {
                Op::Min | Op::Max | Op::Abs => true,
                Op::Neg | Op::Add | Op::Sub => operands.iter().any(|one| found[one.index()]),
                Op::Mul | Op::Div => {
                    factor(graph, *op, operands).is_some_and(|(_, other)| found[other.index()])
                }
                _ => false,
            };
        }
    }
    found
}

/// The factor or divisor that is a number other than 0, and the other operand. `None` if no operand
/// is such a number.
fn factor(graph: &Graph, op: Op, operands: &[NodeId]) -> Option<(BigRational, NodeId)> {
    let number = |k: usize| graph.number(operands[k])?.exact().filter(|one| !one.is_zero());
    let found = |k: usize| Some((number(k)?.clone(), operands[1 - k]));
    found(1).or_else(|| found(0).filter(|_| op == Op::Mul))
}

/// Takes functions apart.
struct Reader<'a> {
    /// For each node that there was at first, whether it is a choice.
    is_choice: Vec<bool>,
    /// Number of choices that may still be taken apart. A node that is shared is taken apart each
    /// time.
    left: usize,
    /// Bounds of the parameters' values.
    values: &'a [Interval],
}

/// A function with the opposite sign.
fn negated(graph: &mut Graph, node: NodeId) -> NodeId {
    graph.apply(Op::Neg, &[node])
}

impl Reader<'_> {
    /// A node as a choice. Sums with a choice are choices of sums. If only the node's sign matters,
    /// a product of levels of one function is a choice of these.
    fn nodes(&mut self, graph: &mut Graph, node: NodeId, by_sign: bool) -> Nodes {
        let &Node::Apply(op, operands) = graph.node(node) else { return Nodes::Part(node) };
        if self.left == 0 {
            return Nodes::Part(node);
        }
        if !self.is_choice.get(node.index()).is_some_and(|is_choice| *is_choice) {
            let sheets = if by_sign { sheets(graph, node, self.values) } else { None };
            return match sheets {
                Some((functions, is_opposite)) => self.bands(graph, &functions, is_opposite),
                None => Nodes::Part(node),
            };
        }
        self.left -= 1;
        match op {
            Op::Min => {
                Nodes::Min(operands.iter().map(|k| self.nodes(graph, *k, by_sign)).collect())
            }
            Op::Max => {
                Nodes::Max(operands.iter().map(|k| self.nodes(graph, *k, by_sign)).collect())
            }
            Op::Abs => {
                let [same, other] = [0, 1].map(|_| self.nodes(graph, operands[0], false));
                Nodes::Max(vec![same, other.map(graph, true, &negated)])
            }
            Op::Neg => self.nodes(graph, operands[0], by_sign).map(graph, true, &negated),
            Op::Mul | Op::Div => {
                let Some((number, other)) = factor(graph, op, &operands) else {
                    return Nodes::Part(node);
                };
                let is_turned = number.is_negative();
                let number = if op == Op::Div { number.recip() } else { number };
                let number = graph.constant(Constant::rational(number));
                let inner = self.nodes(graph, other, by_sign);
                inner.map(graph, is_turned, &|graph, part| graph.apply(Op::Mul, &[number, part]))
            }
            Op::Add | Op::Sub => {
                let (one, other) = (operands[0], operands[1]);
                let [left, right] = [one, other].map(|node| self.nodes(graph, node, false));
                match (left.parts(), right.parts()) {
                    (1, 1) => return Nodes::Part(node),
                    (1, _) | (_, 1) => {}
                    // Only here are there more parts than before.
                    (one, other) => match self.left.checked_sub(one * other) {
                        Some(rest) => self.left = rest,
                        None => return Nodes::Part(node),
                    },
                }
                left.sum(graph, op, &right)
            }
            _ => Nodes::Part(node),
        }
    }

    /// A choice with the sign of the product of some functions, which are levels of one function
    /// with descending numbers. Above the first number, the product is above 0. Below it, bands in
    /// which it is below 0 and above 0 follow each other.
    fn bands(&mut self, graph: &mut Graph, functions: &[NodeId], is_opposite: bool) -> Nodes {
        self.left = self.left.saturating_sub(functions.len());
        let bands = functions.chunks(2).map(|ends| {
            let upper = self.nodes(graph, ends[0], true);
            match ends.get(1) {
                Some(lower) => {
                    let lower = self.nodes(graph, *lower, true).map(graph, true, &negated);
                    Nodes::Max(vec![upper, lower])
                }
                None => upper,
            }
        });
        let mut bands: Vec<Nodes> = bands.collect();
        let all = if bands.len() == 1 { bands.remove(0) } else { Nodes::Min(bands) };
        if is_opposite { all.map(graph, true, &negated) } else { all }
    }
}

/// The functions that are at most 0 in a region's half-space and in its ball.
fn cuts(graph: &mut Graph, region: &Region) -> Vec<NodeId> {
    let exact = |number: f64| BigRational::from_float(number).expect("finite");
    let mut cuts = Vec::new();
    if let Some(HalfSpace { normal, offset }) = region.clip() {
        let mut sum = graph.constant(Constant::rational(-exact(offset)));
        for axis in Axis::ALL {
            let slope = graph.constant(Constant::rational(exact(normal[axis as usize])));
            let variable = graph.variable(axis);
            let term = graph.apply(Op::Mul, &[slope, variable]);
            sum = graph.apply(Op::Add, &[sum, term]);
        }
        cuts.push(sum);
    }
    if let Some(Ball { centre, radius }) = region.ball() {
        let square = exact(radius) * exact(radius);
        let mut sum = graph.constant(Constant::rational(-square));
        for axis in Axis::ALL {
            let middle = graph.constant(Constant::rational(exact(centre[axis as usize])));
            let variable = graph.variable(axis);
            let way = graph.apply(Op::Sub, &[variable, middle]);
            let term = graph.apply(Op::Mul, &[way, way]);
            sum = graph.apply(Op::Add, &[sum, term]);
        }
        cuts.push(sum);
    }
    cuts
}

impl Program {
    /// A surface's function as minima and maxima of parts. A function without minima and maxima, or
    /// with too many parts, is one part. The conditions that restrict an equation are made of
    /// parts, too, and so are the plane and the ball of `region`. The choice is the greatest of the
    /// function and these, which are at most 0 where the surface is.
    ///
    /// # Errors
    /// If a part is too large.
    ///
    /// # Panics
    /// If there is no such surface.
    pub fn choices(&self, surface: usize, region: &Region) -> Result<Choices, ProgramError> {
        let whole = self.simplified();
        let (mut graph, root) = whole.symbolic(surface);
        let is_choice = choices(&graph);
        let (mut function, mut limits) = (root, Vec::new());
        if !whole.solid[surface] {
            while let Node::Apply(Op::WherePositive | Op::WhereNonneg, operands) =
                graph.node(function)
            {
                limits.push(operands[1]);
                function = operands[0];
            }
        }
        let mut reader = Reader { is_choice, left: MOST_PARTS, values: self.values() };
        let mut choice = reader.nodes(&mut graph, function, true);
        let mut limits: Vec<Nodes> =
            limits.into_iter().map(|limit| reader.nodes(&mut graph, limit, true)).collect();
        let count = choice.parts() + limits.iter().map(Nodes::parts).sum::<usize>();
        if count > MOST_PARTS {
            (choice, limits) = (Nodes::Part(root), Vec::new());
        }
        let mut parts = Vec::new();
        let choice = choice.numbered(&mut parts);
        let mut first_cut = parts.len();
        let mut all = vec![choice];
        for limit in limits {
            all.push(limit.map(&mut graph, true, &negated).numbered(&mut parts));
        }
        for cut in cuts(&mut graph, region) {
            all.push(Choice::Part(parts.len()));
            parts.push(cut);
        }
        let mut choice = Choice::greatest(all);
        if whole.solid[surface] {
            choice = merge(&graph, choice, &mut parts, &whole.assumptions.parameters);
            first_cut = parts.len();
        }
        let levels = levels(&graph, &parts, self.values());
        let parts = self.with_functions(surface, graph, parts)?;
        Ok(Choices { choice, parts, first_cut, levels })
    }

    /// A surface's function as minima and maxima of linear functions with exact coefficients. None
    /// of these is constant. `None` if the function is not found to be such a choice everywhere.
    ///
    /// # Panics
    /// If there is no such surface.
    pub fn flat_choice(&self, surface: usize) -> Option<FlatChoice> {
        let whole = self.simplified();
        let (all, roots) = &whole.symbolic;
        let is_linear = |node: &NodeId| match all.node(*node) {
            Node::Variable(_) | Node::Parameter(_) | Node::Constant(_) => true,
            Node::Apply(op, _) => LINEAR.contains(op),
        };
        if !all.needed(&[roots[surface]]).iter().all(is_linear) {
            return None;
        }
        let (mut graph, mut root) = whole.symbolic(surface);
        for id in graph.needed(&[root]) {
            if let Node::Parameter(number) = graph.node(id) {
                let value = self.exact.get(*number as usize)?.clone()?;
                let value = graph.constant(Constant::rational(value));
                root = substitute(&mut graph, root, id, value);
            }
        }
        let is_choice = choices(&graph);
        let mut reader = Reader { is_choice, left: MOST_PLANES, values: self.values() };
        let mut parts = Vec::new();
        let mut choice = reader.nodes(&mut graph, root, true).numbered(&mut parts);
        if whole.solid[surface] {
            choice = merge(&graph, choice, &mut parts, &whole.assumptions.parameters);
        }
        let planes = planes(&graph, &parts)?;
        let is_constant = |plane: &[BigRational; 4]| plane[..3].iter().all(Zero::is_zero);
        (!planes.iter().any(is_constant)).then_some(FlatChoice { choice, planes })
    }

    /// A program whose surfaces are the partial derivatives of a surface's function by x, y and z.
    /// They equal the function's own where it is differentiable and they are defined, up to thin
    /// sets.
    ///
    /// # Errors
    /// If a derivative is too large.
    ///
    /// # Panics
    /// If there is no such surface.
    pub fn slopes(&self, surface: usize) -> Result<Self, ProgramError> {
        let (mut graph, root) = self.simplified().symbolic(surface);
        let slopes = gradient(&mut graph, root);
        self.with_functions(surface, graph, slopes.to_vec())
    }

    /// A program whose three surfaces are the factors of area of a surface's function f: |∇f| over
    /// |∂f/∂x|, over |∂f/∂y| and over |∂f/∂z|. A small piece of a level has this factor times the
    /// area of its projection along the axis.
    ///
    /// # Errors
    /// If a derivative is too large.
    ///
    /// # Panics
    /// If there is no such surface.
    pub fn area_factors(&self, surface: usize) -> Result<Self, ProgramError> {
        let (mut graph, root) = self.simplified().symbolic(surface);
        let slopes = gradient(&mut graph, root);
        let one = graph.constant(Constant::integer(1));
        let factors = [0, 1, 2].map(|axis| {
            let square = |graph: &mut Graph, other: usize| {
                let share = graph.apply(Op::Div, &[slopes[(axis + other) % 3], slopes[axis]]);
                graph.apply(Op::Mul, &[share, share])
            };
            let (left, right) = (square(&mut graph, 1), square(&mut graph, 2));
            let sum = graph.apply(Op::Add, &[left, right]);
            let sum = graph.apply(Op::Add, &[one, sum]);
            graph.apply(Op::Sqrt, &[sum])
        });
        self.with_functions(surface, graph, factors.to_vec())
    }

    /// A program for other functions, with the domain and the parameters of this one. They are
    /// functions of solids if `surface` is one.
    fn with_functions(
        &self,
        surface: usize,
        graph: Graph,
        functions: Vec<NodeId>,
    ) -> Result<Self, ProgramError> {
        let whole = self.simplified();
        let assumptions = whole.assumptions.clone();
        let (simple, roots) =
            simplify(&graph, &functions, &assumptions.domain, &assumptions.parameters)?;
        let count = functions.len();
        let simplified = Simplified {
            graph: simple,
            roots,
            symbolic: (graph, functions),
            typed: whole.typed.clone(),
            assumptions,
            nodes_before: whole.nodes_before,
            solid: vec![whole.solid[surface]; count],
            holds_zeros: vec![whole.holds_zeros[surface]; count],
            reduced: vec![false; count],
            filled: vec![false; count],
            cleared: (0..count).map(|_| OnceLock::new()).collect(),
        };
        let store = CodeStore::new(Arc::new(simplified), Evaluator::Native);
        Ok(Self::of(Arc::new(store), self.values().to_vec()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view;
    use glam::DVec3;
    use zeroset_eval::Points;
    use zeroset_syntax::{Options, read};

    #[test]
    fn choices_are_found_below_signs_and_sums() {
        use Choice::{Max, Min, Part};
        for (text, expected, parts) in [
            ("x^2+y^2 <= 1", Part(0), 1),
            ("max(x, y) = 1", Max(vec![Part(0), Part(1)]), 2),
            ("max(abs(x), abs(y), abs(z)) = 1", Max((0..6).map(Part).collect()), 6),
            ("1 - max(x, y) = z", Min(vec![Part(0), Part(1)]), 2),
            ("max(x, -min(y, z)) = 0", Max(vec![Part(0), Part(1), Part(2)]), 3),
            ("max(x, y) + max(y, z) = 1", Max((0..4).map(Part).collect()), 4),
            ("1 - 2*max(x, y)/3 = z", Min(vec![Part(0), Part(1)]), 2),
            ("abs(max(x, y)) = 1", Max(vec![Part(0), Part(1), Min(vec![Part(2), Part(3)])]), 4),
            // Levels of one function, the greatest number first, and functions that are not.
            ("z*(z - 0.1) = 0", Max(vec![Part(0), Part(1)]), 2),
            ("z*(0.1 - z) = 0", Min(vec![Part(0), Part(1)]), 2),
            ("z*(z - 1)*(z + 1) = 0", Min(vec![Max(vec![Part(0), Part(1)]), Part(2)]), 3),
            ("(x^2 + y^2 - 1)^2 = 0.02", Max(vec![Part(0), Part(1)]), 2),
            ("z*(z - 0.1*x) = 0", Part(0), 1),
            ("x*z*(z - 1) = 0", Part(0), 1),
        ] {
            let document = read(text, &Options::default()).expect(text);
            let region = Region::new(DVec3::splat(-2.0), DVec3::splat(2.0)).expect("a region");
            let program = Program::new(&document, view::bounds(&region)).expect(text);
            let found = program.choices(0, &region).expect(text);
            let count = found.parts.roots().len();
            assert_eq!((found.choice, count, found.first_cut), (expected, parts, parts), "{text}");
        }
    }

    /// A choice as a text.
    fn written(choice: &Choice) -> String {
        let all = |all: &[Choice]| all.iter().map(written).collect::<Vec<_>>().join(", ");
        match choice {
            Choice::Part(part) => part.to_string(),
            Choice::Opposite(part) => format!("-{part}"),
            Choice::Min(inner) => format!("min({})", all(inner)),
            Choice::Max(inner) => format!("max({})", all(inner)),
        }
    }

    /// A solid has one part for faces in one plane, if its function does not jump there. An
    /// equation has all parts.
    #[test]
    fn parts_of_a_solid_in_one_plane_are_one() {
        for (text, expected, parts) in [
            ("min(max(x, y), max(2x, z)) <= 0", "min(max(0, 1), max(2, 0))", 3),
            ("min(max(x, y), max(-3x, z)) <= 0", "min(max(0, 1), max(2, -0), max(2, 1))", 3),
            (
                "min(max(1 - x^2, y), max(x^2/2 - 1/2, z)) <= 0",
                "min(max(0, 1), max(2, -1), max(2, 0))",
                3,
            ),
            ("min(max(x, y), max(-3x, z)) = 0", "min(max(0, 1), max(2, 3))", 4),
            ("min(max(floor(x), y), max(-floor(x), z)) <= 0", "min(max(0, 1), max(2, 3))", 4),
        ] {
            let document = read(text, &Options::default()).expect(text);
            let region = Region::new(DVec3::splat(-2.0), DVec3::splat(2.0)).expect("a region");
            let program = Program::new(&document, view::bounds(&region)).expect(text);
            let found = program.choices(0, &region).expect(text);
            assert_eq!(written(&found.choice), expected, "{text}");
            assert_eq!(found.parts.roots().len(), parts, "{text}");
        }
    }

    #[test]
    fn restrictions_are_parts_that_cut() {
        use Choice::{Max, Min, Part};
        let region = Region::new(DVec3::splat(-2.0), DVec3::splat(2.0)).expect("a region");
        for (text, expected) in [
            ("z = x*y {x^2+y^2 < 1}", Max(vec![Part(0), Part(1)])),
            ("z = x*y {x > 0} {y >= x}", Max(vec![Part(0), Part(1), Part(2)])),
            ("z = x*y {0 < x < 1}", Max(vec![Part(0), Part(1), Part(2)])),
            ("min(x, y) = 0 {x < 1}", Max(vec![Min(vec![Part(0), Part(1)]), Part(2)])),
        ] {
            let document = read(text, &Options::default()).expect(text);
            let program = Program::new(&document, view::bounds(&region)).expect(text);
            let found = program.choices(0, &region).expect(text);
            let own = 1 + usize::from(text.starts_with('m'));
            assert_eq!((found.choice, found.first_cut), (expected, own), "{text}");
        }
    }

    #[test]
    fn a_region_that_is_cut_has_parts_of_its_own() {
        use Choice::{Max, Part};
        let document = read("x = y", &Options::default()).expect("reads");
        let region = Region::new(DVec3::splat(-2.0), DVec3::splat(2.0)).expect("a region");
        let plane = HalfSpace { normal: DVec3::X, offset: 1.0 };
        let region = region.with_clip(plane).expect("a plane").with_ball();
        let program = Program::new(&document, view::bounds(&region)).expect("small");
        let found = program.choices(0, &region).expect("small");
        assert_eq!((found.choice, found.first_cut), (Max((0..3).map(Part).collect()), 1));
        for (part, at, expected) in
            [(1, [0.5, 0.0, 0.0], -0.5), (2, [1.0, 1.0, 1.0], -1.0), (2, [2.0, 0.0, 0.0], 0.0)]
        {
            let kernel = found.parts.kernels::<f64>(part).values().expect("a kernel");
            let values = kernel.eval_all(&Points::near(&[DVec3::from_array(at)]));
            assert_eq!(values[0].value[0], expected, "part {part} at {at:?}");
        }
    }

    /// A choice that is shared is taken apart each time that it occurs: here 2⁶⁰ times, were there
    /// no limit.
    #[test]
    fn shared_choices_are_taken_apart_within_a_limit() {
        let line = |k: usize| format!("a{k} = max(a{}, z - a{})\n", k - 1, k - 1);
        let lines: String = (1..=60).map(line).collect();
        let text = format!("a0 = max(x, y)\n{lines}0 = a60");
        let document = read(&text, &Options::default()).expect("reads");
        let region = Region::new(DVec3::splat(-2.0), DVec3::splat(2.0)).expect("a region");
        let program = Program::new(&document, view::bounds(&region)).expect("small");
        let found = program.choices(0, &region).expect("small");
        assert!(matches!(found.choice, Choice::Min(_) | Choice::Max(_)));
        assert!((2..=MOST_PARTS).contains(&found.parts.roots().len()));
    }

    /// A number that is added to a choice costs nothing of the limit.
    #[test]
    fn many_boxes_that_are_larger_by_a_number_are_taken_apart() {
        let one = |k: usize| format!("max(abs(x - {k}), abs(y), abs(z)) - 0.3");
        let boxes: Vec<String> = (0..16).map(one).collect();
        let text = format!("min({}) <= 0", boxes.join(", "));
        let document = read(&text, &Options::default()).expect("reads");
        let region = Region::new(DVec3::splat(-25.0), DVec3::splat(25.0)).expect("a region");
        let program = Program::new(&document, view::bounds(&region)).expect("small");
        let found = program.choices(0, &region).expect("small");
        // Each box has two parts of its own, and all have the other four in common.
        assert_eq!(found.parts.roots().len(), 36);
    }
}
