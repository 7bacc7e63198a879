//! Replacement of an equation's function by one with the same zeros. Multiple zeros become simple
//! if possible.
//!
//! At a double root a function touches 0 without a change of sign, so no evaluation can prove the
//! zero. A square, alone or as a factor, has the same zeros as its base. A sum of even powers is 0
//! where all of the powers are 0. The sum of the squares of their bases is 0 at the same points,
//! and less flat there.

mod sum;

use crate::graph::{Graph, Node, NodeId};
use crate::univariate;
use rustc_hash::FxHashSet;
use sum::of_even_powers;
use zeroset_ops::Op;

/// Largest number of factors. A function with more factors is left as it is.
const FACTOR_LIMIT: usize = 256;

/// Operations that are 0 exactly where their operand is 0, but whose zeros may be multiple, bent or
/// steep. Powers with a positive integer exponent are handled in the same way.
const ZERO_WITH_OPERAND: [Op; 7] =
    [Op::Abs, Op::Sqr, Op::Cbrt, Op::Sinh, Op::Tanh, Op::Asinh, Op::Atan];

/// Operations that are 0 where their first operand is 0, unless they are undefined there.
const ZERO_WITH_FIRST_OPERAND: [Op; 5] =
    [Op::Div, Op::WhereNonneg, Op::WherePositive, Op::WhereNonzero, Op::WhereDefined];

/// Returns a function with the zeros and the domain of definition of `root`. Multiple zeros become
/// simple if they come from powers of factors, or from a polynomial in one variable. The function
/// is added to `graph`. It is `root` itself if there is nothing to simplify.
///
/// The function's sign may differ from the sign of `root`, because bases replace their squares.
pub fn radical(graph: &mut Graph, root: NodeId) -> NodeId {
    // Divisors and restrictions are kept, so that the domain stays the same.
    let mut around = Vec::new();
    let mut inner = root;
    while let Node::Apply(op, operands) = graph.node(inner)
        && ZERO_WITH_FIRST_OPERAND.contains(op)
    {
        around.push((*op, operands[1]));
        inner = operands[0];
    }
    let Some(mut simple) = product(graph, inner) else { return root };
    for (op, second) in around.into_iter().rev() {
        simple = graph.apply(op, &[simple, second]);
    }
    simple
}

/// Adds the product of the distinct factors of `root`. `None` if there are no factors, or if the
/// product is not simpler than `root`.
fn product(graph: &mut Graph, root: NodeId) -> Option<NodeId> {
    let mut found = Vec::new();
    let mut is_simpler = factors(graph, root, &[Op::Neg], &ZERO_WITH_OPERAND, &mut found)?;
    let mut distinct: Vec<NodeId> = Vec::new();
    let even = |id: NodeId| {
        let factors = of_even_powers(graph, id);
        is_simpler |= factors.is_some();
        factors.unwrap_or_else(|| vec![id])
    };
    let factors: Vec<NodeId> = found.into_iter().flat_map(even).collect();
    let mut work = univariate::WORK_LIMIT;
    for factor in factors {
        let simple = univariate::squarefree(graph, factor, &mut work);
        is_simpler |= simple.is_some();
        let factor = simple.unwrap_or(factor);
        if !distinct.contains(&factor) {
            distinct.push(factor);
        }
    }
    let (first, others) = distinct.split_first().filter(|_| is_simpler)?;
    Some(others.iter().fold(*first, |product, factor| graph.apply(Op::Mul, &[product, *factor])))
}

/// Adds the distinct factors of `root` to `found`. A positive integer power, or an operation of
/// `same` or `simpler`, is replaced by the factors of its operand. Returns whether a repeated
/// factor, a power or an operation of `simpler` was dropped. `None` if there are too many factors.
fn factors(
    graph: &Graph,
    root: NodeId,
    same: &[Op],
    simpler: &[Op],
    found: &mut Vec<NodeId>,
) -> Option<bool> {
    let mut is_simpler = false;
    let (mut rest, mut seen) = (vec![root], FxHashSet::default());
    while let Some(id) = rest.pop() {
        if !seen.insert(id) {
            is_simpler |= graph.number(id).is_none();
            continue;
        }
        match graph.node(id) {
            Node::Constant(value) if !value.bounds().contains(0.0) => {}
            Node::Apply(Op::Mul, operands) => rest.extend(operands.iter().rev()),
            Node::Apply(op, operands) if same.contains(op) => rest.push(operands[0]),
            Node::Apply(op, operands)
                if simpler.contains(op)
                    || *op == Op::Pow && whole(graph, operands[1]).is_some() =>
            {
                is_simpler = true;
                rest.push(operands[0]);
            }
            Node::Constant(_) | Node::Variable(_) | Node::Parameter(_) | Node::Apply(..) => {
                if found.contains(&id) {
                    is_simpler = true;
                } else {
                    found.push(id);
                }
            }
        }
        if found.len() + rest.len() > FACTOR_LIMIT {
            return None;
        }
    }
    Some(is_simpler)
}

/// The value of node `id`, if it is an integer above 0.
fn whole(graph: &Graph, id: NodeId) -> Option<i64> {
    graph.number(id)?.as_integer().filter(|n| *n > 0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constant::Constant;
    use crate::display::display;
    use crate::graph::Axis;

    fn shown(make: impl Fn(&mut Graph, [NodeId; 3]) -> NodeId) -> String {
        let mut graph = Graph::new();
        let axes = [Axis::X, Axis::Y, Axis::Z].map(|axis| graph.variable(axis));
        let root = make(&mut graph, axes);
        let simple = radical(&mut graph, root);
        if simple == root { "the same".to_owned() } else { display(&graph, simple, &[]) }
    }

    #[test]
    fn powers_count_once() {
        assert_eq!(shown(|g, [x, ..]| g.apply(Op::Sqr, &[x])), "x");
        assert_eq!(shown(|g, [x, ..]| g.apply(Op::Abs, &[x])), "x");
        let cube = shown(|g, [x, y, _]| {
            let [three, sum] = [g.integer(3), g.apply(Op::Add, &[x, y])];
            g.apply(Op::Pow, &[sum, three])
        });
        assert_eq!(cube, "x + y");
        // The function is (x y)² · (−3 y) · tanh z.
        let many = shown(|g, [x, y, z]| {
            let product = g.apply(Op::Mul, &[x, y]);
            let square = g.apply(Op::Sqr, &[product]);
            let minus = g.integer(-3);
            let scaled = g.apply(Op::Mul, &[minus, y]);
            let left = g.apply(Op::Mul, &[square, scaled]);
            let tanh = g.apply(Op::Tanh, &[z]);
            g.apply(Op::Mul, &[left, tanh])
        });
        assert_eq!(many, "x*y*z");
    }

    #[test]
    fn what_else_a_function_is_made_of_stays() {
        let over = shown(|g, [x, y, _]| {
            let square = g.apply(Op::Sqr, &[x]);
            g.apply(Op::Div, &[square, y])
        });
        assert_eq!(over, "x/y");
        let cut = shown(|g, [x, y, _]| {
            let square = g.apply(Op::Sqr, &[x]);
            g.apply(Op::WhereNonneg, &[square, y])
        });
        assert!(cut.contains("where_nonneg") && !cut.contains('^'), "{cut}");
        // A parameter may be 0, so it stays a factor.
        let maybe = shown(|g, [x, ..]| {
            let (square, parameter) = (g.apply(Op::Sqr, &[x]), g.parameter(0));
            g.apply(Op::Mul, &[square, parameter])
        });
        assert!(maybe.contains('x') && maybe.contains('*') && !maybe.contains('^'), "{maybe}");
    }

    #[test]
    fn sums_of_even_powers_vanish_as_sums_of_squares_do() {
        let power = |g: &mut Graph, base: NodeId, n: i64| {
            let n = g.integer(n);
            g.apply(Op::Pow, &[base, n])
        };
        let flat = shown(|g, [x, y, _]| {
            let absolute = g.apply(Op::Abs, &[x]);
            let [one, other] = [power(g, absolute, 19), power(g, y, 20)];
            g.apply(Op::Add, &[one, other])
        });
        assert_eq!(flat, "sqr(x) + sqr(y)");
        // The function is −3 x⁴ y² − y² z².
        let common = shown(|g, [x, y, z]| {
            let [fourth, square, last] = [power(g, x, 4), power(g, y, 2), power(g, z, 2)];
            let [one, other] =
                [g.apply(Op::Mul, &[fourth, square]), g.apply(Op::Mul, &[square, last])];
            let minus = g.integer(-3);
            let one = g.apply(Op::Mul, &[minus, one]);
            g.apply(Op::Sub, &[one, other])
        });
        assert_eq!(common, "y*(sqr(x) + sqr(z))");
        // The simpler form of y² + y⁴ √x⁴ still contains √x, which keeps its domain.
        let kept = shown(|g, [x, y, _]| {
            let root = g.apply(Op::Sqrt, &[x]);
            let [square, fourth, other] = [power(g, y, 2), power(g, y, 4), power(g, root, 4)];
            let product = g.apply(Op::Mul, &[fourth, other]);
            g.apply(Op::Add, &[square, product])
        });
        assert!(kept.contains("sqrt(x)") && !kept.contains('4'), "{kept}");
        for exponents in [[4, 3], [2, 2]] {
            let sum = |g: &mut Graph, [x, y, _]: [NodeId; 3]| {
                let [one, other] = [power(g, x, exponents[0]), power(g, y, exponents[1])];
                g.apply(Op::Add, &[one, other])
            };
            assert_eq!(shown(sum), "the same", "{exponents:?}");
        }
        let difference = |g: &mut Graph, [x, y, _]: [NodeId; 3]| {
            let [one, other] = [power(g, x, 4), power(g, y, 4)];
            g.apply(Op::Sub, &[one, other])
        };
        assert_eq!(shown(difference), "the same");
        let raised = |g: &mut Graph, [x, y, _]: [NodeId; 3]| {
            let [one, other] = [power(g, x, 4), power(g, y, 4)];
            let (sum, one) = (g.apply(Op::Add, &[one, other]), g.integer(1));
            g.apply(Op::Sub, &[sum, one])
        };
        assert_eq!(shown(raised), "the same");
    }

    #[test]
    fn what_is_simple_is_not_touched() {
        assert_eq!(shown(|g, [x, y, _]| g.apply(Op::Mul, &[x, y])), "the same");
        let root = |g: &mut Graph, [x, ..]: [NodeId; 3]| g.apply(Op::Sqrt, &[x]);
        assert_eq!(shown(root), "the same");
        let half = |g: &mut Graph, [x, ..]: [NodeId; 3]| {
            let half = g.constant(Constant::ratio(1, 2).expect("a number"));
            g.apply(Op::Pow, &[x, half])
        };
        assert_eq!(shown(half), "the same");
        let inverse = |g: &mut Graph, [x, ..]: [NodeId; 3]| {
            let minus = g.integer(-2);
            g.apply(Op::Pow, &[x, minus])
        };
        assert_eq!(shown(inverse), "the same");
        // The number 2 · 3² has no zero, and so no factor to keep.
        let number = |g: &mut Graph, _: [NodeId; 3]| {
            let (two, three) = (g.integer(2), g.integer(3));
            let square = g.apply(Op::Sqr, &[three]);
            g.apply(Op::Mul, &[two, square])
        };
        assert_eq!(shown(number), "the same");
    }
}
