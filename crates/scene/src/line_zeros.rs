//! The largest number of zeros on lines along an axis, of functions that are nearly polynomials.

use crate::program::Program;
use num_traits::ToPrimitive;
use rustc_hash::FxHashMap;
use zeroset_eval::{Assumptions, enclose_all};
use zeroset_interval::Interval;
use zeroset_ir::{Constant, Graph, Node, NodeId};
use zeroset_ops::Op;

/// Largest number of nodes of a function.
const MOST_NODES: usize = 400;
/// Largest exponent of a power.
const MOST_POWER: u32 = 32;
/// Places in the domain, as shares of its extent, where a function that is not 0 has other values.
const PLACES: [[f64; 3]; 3] = [[0.31, 0.47, 0.62], [0.73, 0.19, 0.41], [0.57, 0.83, 0.29]];

/// A sum of a polynomial and perhaps a square root of one, with either sign.
#[derive(Clone, Copy)]
struct Radical {
    plain: NodeId,
    under: Option<NodeId>,
}

/// Finds sums of a polynomial and a square root.
struct Reader<'a> {
    graph: &'a mut Graph,
    known: FxHashMap<NodeId, Option<Radical>>,
}

impl Reader<'_> {
    fn apply(&mut self, op: Op, operands: &[NodeId]) -> NodeId {
        self.graph.apply(op, operands)
    }

    fn square(&mut self, node: NodeId) -> NodeId {
        self.apply(Op::Mul, &[node, node])
    }

    fn read(&mut self, node: NodeId) -> Option<Radical> {
        if let Some(known) = self.known.get(&node) {
            return *known;
        }
        let found = self.find(node);
        self.known.insert(node, found);
        found
    }

    fn find(&mut self, node: NodeId) -> Option<Radical> {
        let &Node::Apply(op, operands) = self.graph.node(node) else {
            return Some(Radical { plain: node, under: None });
        };
        let one = self.read(operands[0])?;
        match op {
            Op::Neg => Some(Radical { plain: self.apply(op, &[one.plain]), ..one }),
            Op::Sqr => Some(self.squared(one)),
            Op::Sqrt if one.under.is_none() => {
                let plain = self.graph.constant(Constant::integer(0));
                Some(Radical { plain, under: Some(one.plain) })
            }
            Op::Add | Op::Sub => {
                let other = self.read(operands[1])?;
                let under = match (one.under, other.under) {
                    (Some(_), Some(_)) => return None,
                    (one, other) => one.or(other),
                };
                Some(Radical { plain: self.apply(op, &[one.plain, other.plain]), under })
            }
            Op::Mul | Op::Div => {
                let other = self.read(operands[1])?;
                let (root, factor) = match (one.under, other.under) {
                    (root, None) => (root, other.plain),
                    (None, root) if op == Op::Mul => (root, one.plain),
                    (_, Some(_)) => return None,
                };
                let under = root.map(|root| {
                    let factor = self.square(factor);
                    self.apply(op, &[root, factor])
                });
                Some(Radical { plain: self.apply(op, &[one.plain, other.plain]), under })
            }
            Op::Pow if one.under.is_none() => {
                exponent(self.graph, operands[1])?;
                let plain = self.apply(op, &[one.plain, operands[1]]);
                Some(Radical { plain, under: None })
            }
            _ => None,
        }
    }

    /// The square: (a + √b)² = a² + b + 2a√b.
    fn squared(&mut self, of: Radical) -> Radical {
        let square = self.square(of.plain);
        let Some(under) = of.under else { return Radical { plain: square, under: None } };
        let four = self.graph.constant(Constant::integer(4));
        let product = self.apply(Op::Mul, &[square, under]);
        let plain = self.apply(Op::Add, &[square, under]);
        Radical { plain, under: Some(self.apply(Op::Mul, &[four, product])) }
    }
}

/// A whole exponent that is not below 0.
fn exponent(graph: &Graph, node: NodeId) -> Option<u32> {
    let exact = graph.number(node)?.exact()?;
    exact.is_integer().then(|| exact.to_u32()).flatten().filter(|power| *power <= MOST_POWER)
}

/// The degree of a polynomial in x, y and z. `None` for other functions.
fn degrees(graph: &Graph, root: NodeId) -> Option<[u32; 3]> {
    let mut known: FxHashMap<NodeId, [u32; 3]> = FxHashMap::default();
    for id in graph.needed(&[root]) {
        let each = |of: fn(u32, u32) -> u32, [one, other]: [[u32; 3]; 2]| {
            [0, 1, 2].map(|axis| of(one[axis], other[axis]))
        };
        let degree = match graph.node(id) {
            Node::Variable(axis) => {
                let mut degree = [0; 3];
                degree[*axis as usize] = 1;
                degree
            }
            Node::Parameter(_) | Node::Constant(_) => [0; 3],
            Node::Apply(op, operands) => {
                let one = *known.get(&operands[0])?;
                let other = operands.get(1).and_then(|other| known.get(other).copied());
                match op {
                    Op::Neg => one,
                    Op::Sqr => one.map(|degree| 2 * degree),
                    Op::Add | Op::Sub => each(u32::max, [one, other?]),
                    Op::Mul => each(u32::saturating_add, [one, other?]),
                    Op::Div if other? == [0; 3] => one,
                    Op::Pow => {
                        let power = exponent(graph, operands[1])?;
                        one.map(|degree| degree.saturating_mul(power))
                    }
                    _ => return None,
                }
            }
        };
        known.insert(id, degree);
    }
    known.get(&root).copied()
}

impl Program {
    /// For each axis, the largest number of zeros that a surface's function has on a line along it,
    /// except for lines of a thin set. `None` if the function is not found to be a polynomial, or a
    /// sum of one and a square root of one.
    ///
    /// # Panics
    /// If there is no such surface.
    pub fn most_line_zeros(&self, surface: usize) -> Option<[u32; 3]> {
        let whole = self.simplified();
        let (mut graph, root) = whole.symbolic(surface);
        if graph.len() > MOST_NODES {
            return None;
        }
        let mut reader = Reader { graph: &mut graph, known: FxHashMap::default() };
        let Radical { plain, under } = reader.read(root)?;
        let (mut most, mut polynomial) = (degrees(&graph, plain)?, plain);
        if let Some(under) = under {
            // Zeros of a ± √b are zeros of a² − b.
            let root = degrees(&graph, under)?;
            most = [0, 1, 2].map(|axis| (2 * most[axis]).max(root[axis]));
            let square = graph.apply(Op::Mul, &[plain, plain]);
            polynomial = graph.apply(Op::Sub, &[square, under]);
        }
        // A polynomial that is not 0 everywhere is 0 on few lines.
        let is_other = |shares: &[f64; 3]| {
            let place = [0, 1, 2].map(|axis: usize| {
                let Interval { lo, hi } = whole.assumptions.domain[axis];
                let at = lo + shares[axis] * (hi - lo);
                Interval { lo: at, hi: at }
            });
            let parameters = self.values().to_vec();
            let assumptions = Assumptions { domain: place, parameters };
            let (bounds, _) = enclose_all(&graph, &[polynomial], &assumptions)[0];
            !bounds.has_zero()
        };
        PLACES.iter().any(is_other).then_some(most)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view;
    use glam::DVec3;
    use zeroset_space::Region;
    use zeroset_syntax::{Options, read};

    #[test]
    fn polynomials_and_square_roots_have_few_zeros() {
        let region = Region::new(DVec3::splat(-2.0), DVec3::splat(2.0)).expect("a region");
        for (text, expected) in [
            ("x^2+y^2 = z", Some([2, 2, 1])),
            ("a = 2; a*x^3*y + (y - z)^2/3 = 0.5", Some([3, 2, 2])),
            ("x*y = 0", Some([1, 1, 0])),
            ("sqrt(x^2+y^2) = 1 - z", Some([2, 2, 2])),
            ("(sqrt(x^2+y^2)-1)^2+z^2 = 0.16", Some([4, 4, 4])),
            ("sqrt(x^2+y^2) + sqrt(x^2+z^2) = 1", None),
            ("sin(x) = y", None),
            ("1/x = y + z^2", None),
        ] {
            let document = read(text, &Options::default()).expect(text);
            let program = Program::unchecked(&document, view::bounds(&region)).expect(text);
            assert_eq!(program.most_line_zeros(0), expected, "{text}");
        }
    }

    /// Such a function is 0 in half of space.
    #[test]
    fn a_function_that_is_zero_in_space_has_no_bound() {
        let region = Region::new(DVec3::splat(-2.0), DVec3::splat(2.0)).expect("a region");
        let document = read("x + sqrt((x*(y+1)-x*y)^2) = 0", &Options::default()).expect("reads");
        let program = Program::unchecked(&document, view::bounds(&region)).expect("small");
        assert_eq!(program.most_line_zeros(0), None);
    }
}
