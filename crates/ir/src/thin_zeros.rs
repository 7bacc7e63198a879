//! Zero sets that are no surface: a point, a line, a curve, or nothing.
//!
//! A sum of terms of one sign is 0 only where all of its terms are 0. A polynomial of degree 2 that
//! has one sign is a sum of squares of linear functions. So both are read as several equations that
//! hold together. All decisions are exact. A zero set that these rules do not decide counts as
//! unknown.

use crate::algebra::is_zero;
use crate::constant::Constant;
use crate::graph::{Axis, Graph, Node, NodeId};
use crate::polynomial::{Polynomial, Work};
use num_rational::BigRational;
use num_traits::{Signed, Zero};
use zeroset_ops::Op;

/// Largest number of nodes of a function that is examined.
const MOST_NODES: usize = 256;
/// Largest number of equations that hold together.
const MOST_PARTS: usize = 16;
/// Number of products of terms that may be computed.
const WORK: u32 = 1 << 12;

/// A zero set that is no surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ThinZeros {
    /// There are no zeros.
    Nowhere,
    /// The only zero has these coordinates.
    Point([NodeId; 3]),
    /// The zeros are a line, on which both equations hold. An equation is its two sides.
    Line([[NodeId; 2]; 2]),
    /// The zeros are where both equations hold: at most a curve.
    Curve([[NodeId; 2]; 2]),
}

/// A linear function: the coefficients of x, y and z, and the constant.
type Form = [BigRational; 4];

/// Returns the zeros of `root`, if they are proven to be no surface. Adds their parts to `graph`.
/// Without an exact proof, and for functions that have parameters, returns `None`.
///
/// ```
/// use zeroset_ir::{Axis, Graph, ThinZeros, thin_zeros};
/// use zeroset_ops::Op;
///
/// let mut graph = Graph::new();
/// let squares = [Axis::X, Axis::Y, Axis::Z].map(|axis| {
///     let coordinate = graph.variable(axis);
///     graph.apply(Op::Sqr, &[coordinate])
/// });
/// let cylinder = graph.apply(Op::Add, &[squares[0], squares[1]]);
/// let ball = graph.apply(Op::Add, &[cylinder, squares[2]]);
/// let zero = graph.integer(0);
/// assert_eq!(thin_zeros(&mut graph, ball), Some(ThinZeros::Point([zero; 3])));
/// assert!(matches!(thin_zeros(&mut graph, cylinder), Some(ThinZeros::Line(_))));
/// assert_eq!(thin_zeros(&mut graph, squares[0]), None);
/// ```
pub fn thin_zeros(graph: &mut Graph, root: NodeId) -> Option<ThinZeros> {
    let axes = Axis::ALL.map(|axis| graph.variable(axis));
    let mut work = Work(WORK);
    let (mut forms, mut others) = (Vec::new(), Vec::new());
    let parts = parts(graph, root)?;
    // Most functions have one part of a higher degree. They are not multiplied out, to save time.
    if let [only] = parts.as_slice()
        && degree(graph, *only) > 2
    {
        return None;
    }
    for part in parts {
        let polynomial = Polynomial::of(graph, part, &mut work);
        let is_of_axes = polynomial.variables().iter().all(|variable| axes.contains(variable));
        if !is_of_axes || !Polynomial::leaves(graph, part).is_empty() {
            return None;
        }
        match squares(&polynomial, &axes) {
            Some(found) => forms.extend(found),
            None => match linear(&polynomial, &axes) {
                Some(form) => forms.push(form),
                None => others.push((part, polynomial)),
            },
        }
    }
    let Some(rows) = solved(forms) else { return Some(ThinZeros::Nowhere) };
    let mut equations = Vec::new();
    for (pivot, row) in rows {
        let solution = solution(&row, pivot, &axes);
        let equation = Polynomial::variable(axes[pivot]).minus(&solution);
        equations.push([axes[pivot], solution.emit(graph)]);
        // A linear equation has no proper factors. So a polynomial with a common factor is a
        // multiple of it, and follows from it.
        let mut left = Vec::new();
        for (part, other) in others {
            let common = other.gcd(&equation, &mut work)?;
            left.extend(common.as_constant().map(|_| (part, other)));
        }
        others = left;
    }
    let zero = graph.integer(0);
    match (equations.as_slice(), others.as_slice()) {
        ([x, y, z], []) => Some(ThinZeros::Point([x[1], y[1], z[1]])),
        ([one, other], []) => Some(ThinZeros::Line([*one, *other])),
        ([one], [(other, _)]) => Some(ThinZeros::Curve([*one, [*other, zero]])),
        ([], [(one, polynomial), (other, theirs)]) => {
            let common = polynomial.gcd(theirs, &mut work)?;
            common.as_constant().map(|_| ThinZeros::Curve([[*one, zero], [*other, zero]]))
        }
        _ => None,
    }
}

/// The degree of `root` as a polynomial in x, y and z before terms cancel; large for any other
/// function.
fn degree(graph: &Graph, root: NodeId) -> u64 {
    const LARGE: u64 = 1 << 20;
    let mut degrees: Vec<u64> = Vec::with_capacity(graph.len());
    for (_, node) in graph.iter() {
        let degree = match node {
            Node::Variable(_) => 1,
            Node::Constant(_) => 0,
            Node::Parameter(_) => LARGE,
            Node::Apply(op, operands) => {
                let of = |at: usize| degrees[operands[at].index()];
                match op {
                    Op::Neg => of(0),
                    Op::Add | Op::Sub => of(0).max(of(1)),
                    Op::Mul => of(0) + of(1),
                    Op::Div if of(1) == 0 => of(0),
                    Op::Sqr => 2 * of(0),
                    Op::Pow => match graph.number(operands[1]).and_then(Constant::as_integer) {
                        Some(exponent @ 0..=2) => of(0) * exponent.unsigned_abs(),
                        _ => LARGE,
                    },
                    _ => LARGE,
                }
            }
        };
        degrees.push(degree.min(LARGE));
    }
    degrees[root.index()]
}

/// The linear functions that are 0 together exactly where a polynomial of degree 2 is 0, if it has
/// one sign.
fn squares(polynomial: &Polynomial, axes: &[NodeId; 3]) -> Option<Vec<Form>> {
    let mut matrix = matrix(polynomial, axes)?;
    let has = |sign: fn(&BigRational) -> bool| (0..4).any(|at| sign(&matrix[at][at]));
    match (has(Signed::is_positive), has(Signed::is_negative)) {
        (true, true) => return None,
        (false, true) => matrix = matrix.map(|row| row.map(|entry| -entry)),
        _ => {}
    }
    let mut forms = Vec::new();
    for at in 0..4 {
        let pivot = matrix[at][at].clone();
        if pivot.is_zero() {
            if matrix[at].iter().any(|entry| !entry.is_zero()) {
                return None;
            }
            continue;
        }
        if pivot.is_negative() {
            return None;
        }
        // Subtracts the square that holds all terms with this coordinate.
        let form = matrix[at].clone().map(|entry| entry / &pivot);
        for (row, left) in matrix.iter_mut().zip(&form).filter(|(_, left)| !left.is_zero()) {
            for (entry, right) in row.iter_mut().zip(&form) {
                *entry -= left * right * &pivot;
            }
        }
        forms.push(form);
    }
    Some(forms)
}

/// The symmetric matrix of a polynomial of degree 2 at most, for the vector (x, y, z, 1).
fn matrix(polynomial: &Polynomial, axes: &[NodeId; 3]) -> Option<[Form; 4]> {
    let mut matrix: [Form; 4] = Default::default();
    let half = BigRational::new(1.into(), 2.into());
    for at in 0..3 {
        if polynomial.degree(axes[at]) > 2 {
            return None;
        }
        matrix[at][at] = polynomial.coefficient(axes[at], 2).as_constant()?;
        let mut once = polynomial.coefficient(axes[at], 1);
        for other in (0..3).filter(|other| *other != at) {
            let product = once.coefficient(axes[other], 1).as_constant()?;
            matrix[at][other] = product * &half;
            once = once.coefficient(axes[other], 0);
        }
        matrix[at][3] = once.as_constant()? * &half;
        matrix[3][at] = matrix[at][3].clone();
    }
    matrix[3][3] = constant(polynomial, axes)?;
    Some(matrix)
}

/// The value of a polynomial at the origin.
fn constant(polynomial: &Polynomial, axes: &[NodeId; 3]) -> Option<BigRational> {
    axes.iter().fold(polynomial.clone(), |rest, axis| rest.coefficient(*axis, 0)).as_constant()
}

/// The coefficients of a polynomial of degree 1.
fn linear(polynomial: &Polynomial, axes: &[NodeId; 3]) -> Option<Form> {
    let mut form = Form::default();
    for (entry, axis) in form.iter_mut().zip(axes) {
        if polynomial.degree(*axis) > 1 {
            return None;
        }
        *entry = polynomial.coefficient(*axis, 1).as_constant()?;
    }
    form[3] = constant(polynomial, axes)?;
    Some(form)
}

/// The equations of the points where all of `forms` are 0, in reduced row echelon form. Each has
/// the number of the coordinate for which it is solved. `None` if there is no such point.
fn solved(mut forms: Vec<Form>) -> Option<Vec<(usize, Form)>> {
    let mut rows: Vec<(usize, Form)> = Vec::new();
    for column in 0..3 {
        let Some(at) = forms.iter().position(|form| !form[column].is_zero()) else { continue };
        let pivot = forms.swap_remove(at);
        let scale = pivot[column].clone();
        let pivot = pivot.map(|entry| entry / &scale);
        for form in rows.iter_mut().map(|(_, row)| row).chain(&mut forms) {
            let factor = form[column].clone();
            form.iter_mut().zip(&pivot).for_each(|(entry, own)| *entry -= own * &factor);
        }
        rows.push((column, pivot));
    }
    forms.iter().all(|form| form[3].is_zero()).then_some(rows)
}

/// The value of the coordinate for which an equation is solved.
fn solution(row: &Form, pivot: usize, axes: &[NodeId; 3]) -> Polynomial {
    let mut value = Polynomial::constant(-row[3].clone());
    for at in (0..3).filter(|at| *at != pivot) {
        value = value.plus(&Polynomial::variable(axes[at]).scaled(&-row[at].clone()));
    }
    value
}

/// The sign of each node, as far as the operations show it.
struct Signs(Vec<Option<bool>>);

impl Signs {
    /// True if a node is never above 0, false if never below; `None` if it may have both signs.
    fn is_negative(&self, id: NodeId) -> Option<bool> {
        self.0[id.index()]
    }

    fn of(graph: &Graph) -> Self {
        let mut signs = Self(Vec::with_capacity(graph.len()));
        for (_, node) in graph.iter() {
            let sign = signs.next(graph, node);
            signs.0.push(sign);
        }
        signs
    }

    fn next(&self, graph: &Graph, node: &Node) -> Option<bool> {
        let (op, operands) = match node {
            Node::Apply(op, operands) => (*op, operands),
            Node::Constant(value) => {
                let bounds = value.bounds();
                return (bounds.lo >= 0.0 || bounds.hi <= 0.0).then_some(bounds.lo < 0.0);
            }
            Node::Variable(_) | Node::Parameter(_) => return None,
        };
        let sign = |at: usize| self.is_negative(operands[at]);
        match op {
            Op::Sqr | Op::Abs | Op::Sqrt | Op::Exp => Some(false),
            Op::Pow => {
                let exponent = graph.exact(operands[1])?;
                let is_odd = exponent.is_integer() && exponent.numer().bit(0);
                if is_odd { sign(0) } else { Some(false) }
            }
            Op::Neg => sign(0).map(|negative| !negative),
            Op::Mul | Op::Div => Some(sign(0)? ^ sign(1)?),
            Op::Add => sign(0).filter(|sign_here| sign(1) == Some(*sign_here)),
            Op::Sub => sign(0).filter(|sign_here| sign(1) == Some(!*sign_here)),
            Op::Max if sign(0) == Some(false) || sign(1) == Some(false) => Some(false),
            Op::Min if sign(0) == Some(true) || sign(1) == Some(true) => Some(true),
            _ => None,
        }
    }
}

/// Functions that are 0 together exactly where `root` is 0. `None` if there are too many.
fn parts(graph: &mut Graph, root: NodeId) -> Option<Vec<NodeId>> {
    if graph.needed(&[root]).len() > MOST_NODES {
        return None;
    }
    let signs = Signs::of(graph);
    let is_nonzero = |id: NodeId| graph.exact(id).is_some_and(|value| !value.is_zero());
    let (mut open, mut parts) = (vec![root], Vec::new());
    while let Some(id) = open.pop() {
        let Node::Apply(op, operands) = graph.node(id) else {
            parts.push(id);
            continue;
        };
        let sign = |at: usize| signs.is_negative(operands[at]);
        let is_sum = match op {
            Op::Add | Op::Sub => signs.is_negative(id).is_some(),
            Op::Max => sign(0) == Some(false) && sign(1) == Some(false),
            Op::Min => sign(0) == Some(true) && sign(1) == Some(true),
            _ => false,
        };
        match op {
            _ if is_sum => open.extend(operands.iter().rev()),
            Op::Neg | Op::Abs | Op::Sqr | Op::Sqrt | Op::Cbrt => open.push(operands[0]),
            Op::Pow if graph.exact(operands[1]).is_some_and(Signed::is_positive) => {
                open.push(operands[0]);
            }
            Op::Mul if is_nonzero(operands[0]) => open.push(operands[1]),
            Op::Mul | Op::Div if is_nonzero(operands[1]) => open.push(operands[0]),
            _ if is_zero(graph, id) => {}
            _ if !parts.contains(&id) => parts.push(id),
            _ => {}
        }
        if parts.len() + open.len() > MOST_PARTS {
            return None;
        }
    }
    Some(parts)
}
