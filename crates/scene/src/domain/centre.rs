//! The center of a function, read off its graph: the center of a quadric, the tip of a paraboloid,
//! the offsets subtracted from x, y and z in roots and waves. The center moves with the surface.
//!
//! Nothing here is a proof: the center only serves to choose a window. This module depends neither
//! on kernels nor on boxes.

use super::REACH;
use super::polynomial::{DirectionalSum, Polynomial};
use zeroset_interval::Interval;
use zeroset_ir::{Graph, Node, NodeId};
use zeroset_ops::Op;

/// The polynomial part of a node.
#[derive(Default)]
struct NodePolynomial {
    /// The polynomial. For a sum, only its polynomial terms.
    polynomial: Polynomial,
    /// Whether this polynomial equals the node.
    is_whole: bool,
}

/// Largest number of pairs of terms that are multiplied while the polynomials of a function are
/// expanded.
const MOST_PRODUCTS: usize = 100_000;

/// The center of the function at `root`, for parameters within `parameters`: the mean of the
/// centers of the largest polynomials in the function. Linear polynomials count only along
/// directions that other polynomials leave undetermined.
pub fn centre(graph: &Graph, root: NodeId, parameters: &[Interval]) -> [f64; 3] {
    let needed = graph.reachable(&[root]);
    let mut work = MOST_PRODUCTS;
    let mut known: Vec<NodePolynomial> = Vec::with_capacity(graph.len());
    let mut is_part = vec![false; graph.len()];
    is_part[root.index()] = true;
    for (id, node) in graph.iter() {
        let number = |bounds: Interval| Polynomial::number(bounds.lo.midpoint(bounds.hi));
        let whole = |polynomial: Polynomial| NodePolynomial { polynomial, is_whole: true };
        let this = match node {
            _ if !needed[id.index()] => NodePolynomial::default(),
            Node::Variable(axis) => whole(Polynomial::axis(*axis as usize)),
            Node::Parameter(at) => parameters
                .get(*at as usize)
                .map_or(NodePolynomial::default(), |value| whole(number(*value))),
            Node::Constant(value) => whole(number(value.bounds())),
            Node::Apply(op, operands) => {
                let operand = |k: usize| operands.get(k).map(|id| &known[id.index()]);
                let all_whole = operands.iter().all(|id| known[id.index()].is_whole);
                let of = |k: usize| operand(k).map(|known| &known.polynomial);
                let is_sum = [Op::Neg, Op::Add, Op::Sub].contains(op);
                let found =
                    if all_whole || is_sum { combined(*op, of(0), of(1), &mut work) } else { None };
                if found.is_none() {
                    operands.iter().for_each(|id| is_part[id.index()] = true);
                }
                let polynomial = found.unwrap_or_default();
                NodePolynomial {
                    is_whole: all_whole && polynomial != Polynomial::default(),
                    polynomial,
                }
            }
        };
        known.push(this);
    }
    let (mut curved, mut flat) = (DirectionalSum::default(), DirectionalSum::default());
    let parts = known.iter().zip(is_part).filter(|(_, is_part)| *is_part);
    for (NodePolynomial { polynomial, .. }, _) in parts {
        let pull = if polynomial.degree() > 1 { &mut curved } else { &mut flat };
        pull.join(&polynomial.middle());
    }
    let centre = curved.mean(Some(&flat)).to_array();
    if centre.iter().all(|along| along.abs() <= REACH) { centre } else { [0.0; 3] }
}

/// The result of an operation on polynomials, if it is a polynomial that is not too long.
fn combined(
    op: Op,
    a: Option<&Polynomial>,
    b: Option<&Polynomial>,
    work: &mut usize,
) -> Option<Polynomial> {
    let a = a?;
    if op == Op::Neg {
        Some(Polynomial::default().plus(-1.0, a))
    } else if op == Op::Sqr {
        a.power(2, work)
    } else if op == Op::Add {
        Some(a.plus(1.0, b?))
    } else if op == Op::Sub {
        Some(a.plus(-1.0, b?))
    } else if op == Op::Mul {
        a.times(b?, work)
    } else if op == Op::Div {
        let divisor = b?.value().filter(|divisor| *divisor != 0.0)?;
        Some(Polynomial::default().plus(1.0 / divisor, a))
    } else if op == Op::Pow {
        let exponent = b?.value().filter(|n| n.fract() == 0.0 && (0.0..=24.0).contains(n))?;
        a.power(exponent as u32, work)
    } else if op == Op::Sqrt {
        a.value().map(|value| Polynomial::number(value.sqrt()))
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::program::Program;
    use zeroset_syntax::{Options, read};

    #[test]
    fn a_centre_is_that_of_what_is_squared_or_rooted_or_waves() {
        for (text, wanted) in [
            ("x^2+y^2-z^2=1", [0.0; 3]),
            ("(x-5)^2+(y-3)^2-(z-2)^2=0.2", [5.0, 3.0, 2.0]),
            ("x^2+4x*y+5y^2-6y=z^2+z", [-6.0, 3.0, -0.5]),
            ("(x-2)*(y-3)*(z-4)=1", [2.0, 3.0, 4.0]),
            // The tip of a paraboloid, and the point where a saddle of the third order is flat.
            ("x-7=(y+1)^2+z^2", [7.0, -1.0, 0.0]),
            ("(x-4)^3-3(x-4)(y-2)^2=z-1", [4.0, 2.0, 1.0]),
            ("(x-1)^2=(y+2)^2*(z-3)", [1.0, -2.0, 3.0]),
            // Not polynomials.
            ("sqrt((x-3)^2+y^2)=z-1", [3.0, 0.0, 1.0]),
            ("(x-1)^2+(y-2)^2=cosh(z-3)^2", [1.0, 2.0, 3.0]),
            ("z=x*exp(-(x-5)^2-(y-1)^2)", [5.0, 1.0, 0.0]),
            ("abs(x-1)+abs(y-2)=abs(z+3)", [1.0, 2.0, -3.0]),
            // A cylinder has no center along its axis; the origin is chosen.
            ("(x-1)^2+(y-2)^2=3", [1.0, 2.0, 0.0]),
            ("(x+y-2)^2+z^2=3", [1.0, 1.0, 0.0]),
            // The whole is too long to be expanded; its summands are not.
            ("((x-1)^20+(y-2)^20-(z-3)^20)^2=1", [1.0, 2.0, 3.0]),
        ] {
            let document = read(text, &Options::default()).expect(text);
            let program = Program::new(&document, [Interval::ENTIRE; 3]).expect(text);
            let found = centre(program.graph(), program.roots()[0], program.values());
            let off = (0..3).map(|axis| (found[axis] - wanted[axis]).abs()).fold(0.0, f64::max);
            assert!(off < 1e-9, "{text}: {found:?}, not {wanted:?}");
        }
    }
}
