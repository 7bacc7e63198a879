//! Proofs about a function at infinity, in coordinates in which infinity is a face of a cube.
//!
//! In a chart of the first axis, a point is x = s/wᵃ, y = u/wᵇ, z = v/wᶜ. Here s is ±1, u and v are
//! within ±1, and w is from 0 to 1/R. The weights a, b, c are whole numbers. The charts of the
//! three axes cover all points with |x| ≥ Rᵃ, |y| ≥ Rᵇ or |z| ≥ Rᶜ. In a chart, an accepted
//! function of degree d is w⁻ᵈ times another function, which can be evaluated at w = 0. If that
//! other function has no zero in any chart, the surface has no point outside the box ±(Rᵃ, Rᵇ, Rᶜ).
//! Bounds are rounded outward, so this is a proof.
//!
//! This module depends neither on kernels nor on how results are used.

use std::array::from_fn;
use zeroset_interval::Interval;
use zeroset_ir::{Graph, Node, NodeId};
use zeroset_ops::{Class, Law, Op};

/// An operation of a function, with the indices of its operands.
#[derive(Clone, Copy, Debug)]
enum Operation {
    Axis(usize),
    Number(Interval),
    Negation(usize),
    /// The operands are multiplied by powers of w that bring both to the same degree.
    Sum(Lifted, Lifted),
    Difference(Lifted, Lifted),
    Product(usize, usize),
    Quotient(usize, usize),
    Power(usize, u32),
    Root(usize),
    Absolute(usize),
    Least(Lifted, Lifted),
    Most(Lifted, Lifted),
}

/// Index of a step, and the power of w that its value is multiplied by.
type Lifted = (usize, u32);

/// An axis, and 1 or −1 for its side.
type Chart = (usize, f64);

/// Ranges of u, v and w.
type ChartBox = [[f64; 2]; 3];

/// Bounds of a value, and of its derivatives by the first `N` of u, v and w.
type Jet<const N: usize> = (Interval, [Interval; N]);

/// A function that can be evaluated at infinity.
pub struct Homogeneous {
    steps: Vec<Operation>,
}

/// Largest magnitude of a degree that is accepted; high powers of w underflow.
const HIGHEST: i32 = 64;

impl Homogeneous {
    /// Reads the function at `root`, for parameters within the bounds `parameters`. `None` if
    /// [`Operation`] has no variant for an operation of the graph, or if a degree is too high.
    pub fn new(
        graph: &Graph,
        root: NodeId,
        parameters: &[Interval],
        weights: [u32; 3],
    ) -> Option<Self> {
        let needed = graph.reachable(&[root]);
        let mut place = vec![usize::MAX; graph.len()];
        let (mut steps, mut degrees) = (Vec::new(), Vec::<i32>::new());
        for (id, node) in graph.iter().filter(|(id, _)| needed[id.index()]) {
            let (step, degree) = match node {
                Node::Variable(axis) => {
                    (Operation::Axis(*axis as usize), weights[*axis as usize] as i32)
                }
                Node::Parameter(number) => {
                    (Operation::Number(parameters.get(*number as usize).copied()?), 0)
                }
                Node::Constant(value) => (Operation::Number(value.bounds()), 0),
                Node::Apply(op, operands) => {
                    let at = |k: usize| (place[operands[k].index()], operands[k]);
                    applied(graph, *op, at, &degrees)?
                }
            };
            if degree.abs() > HIGHEST {
                return None;
            }
            place[id.index()] = steps.len();
            steps.push(step);
            degrees.push(degree);
        }
        Some(Self { steps })
    }

    /// Returns whether all zeros are proven to lie in a box. On an axis of weight n, the box has
    /// the half side 2^(n · `exponent`). `work` is the number of evaluations left, and is updated.
    pub fn is_within(&self, exponent: u32, work: &mut u64) -> bool {
        let farthest = 0.5_f64.powi(exponent as i32);
        if farthest == 0.0 || self.changes_sign_at_infinity(work) {
            return false;
        }
        let scratch = &mut Vec::new();
        charts().all(|chart| {
            let mut stack = vec![[[-1.0, 1.0], [-1.0, 1.0], [0.0, farthest]]];
            while let Some(part) = stack.pop() {
                if *work == 0 {
                    return false;
                }
                *work -= 1;
                if !self.over(chart, part, scratch).has_zero() {
                    continue;
                }
                let share =
                    |k: usize| (part[k][1] - part[k][0]) / if k == 2 { farthest } else { 2.0 };
                let mut spreads = [0, 1, 2].map(share);
                if let Some((value, changes)) = self.about_middle(chart, part, scratch) {
                    if !value.has_zero() {
                        continue;
                    }
                    spreads = changes;
                }
                // Halve the coordinate along which the function changes most.
                let widest =
                    (1..3).fold(0, |most, k| if spreads[k] > spreads[most] { k } else { most });
                let middle = part[widest][0].midpoint(part[widest][1]);
                if share(widest) < SMALLEST {
                    return false;
                }
                let [mut near, mut far] = [part; 2];
                (near[widest][1], far[widest][0]) = (middle, middle);
                stack.extend([far, near]);
            }
            true
        })
    }

    /// Returns whether samples at infinity have both signs. If so, no box can be proven.
    fn changes_sign_at_infinity(&self, work: &mut u64) -> bool {
        let (mut below, mut above, mut scratch) = (false, false, Vec::new());
        for chart in charts() {
            for n in 0..SAMPLES * SAMPLES {
                let place = |k: u32| 2.0 * (f64::from(k) + 0.5) / f64::from(SAMPLES) - 1.0;
                let (u, v) = (place(n % SAMPLES), place(n / SAMPLES));
                *work = work.saturating_sub(1);
                let value = self.over(chart, [[u, u], [v, v], [0.0, 0.0]], &mut scratch);
                below |= value.is_negative();
                above |= value.is_positive();
                if below && above {
                    return true;
                }
            }
        }
        false
    }

    /// Bounds of the function over part of a chart, by the mean value theorem: from the value in
    /// the middle and bounds of the derivatives. Also returns how much each coordinate adds to the
    /// width of these bounds. `None` if the derivatives have no bounds.
    fn about_middle(
        &self,
        chart: Chart,
        part: ChartBox,
        known: &mut Vec<Jet<0>>,
    ) -> Option<(Interval, [f64; 3])> {
        let (_, slopes) = self.jet::<3>(chart, part, &mut Vec::new())?;
        let middle = part.map(|[low, high]| low.midpoint(high));
        let mut value = self.over(chart, middle.map(|c| [c, c]), known);
        let mut spreads = [0.0; 3];
        for (k, slope) in slopes.into_iter().enumerate() {
            let way = bounds(part[k][0], part[k][1]);
            let change = slope.times(way.plus(bounds(-middle[k], -middle[k])));
            value = value.plus(change);
            spreads[k] = change.width();
        }
        Some((value, spreads))
    }

    /// Bounds of the function over part of a chart.
    fn over(&self, chart: Chart, part: ChartBox, known: &mut Vec<Jet<0>>) -> Interval {
        self.jet(chart, part, known).map_or(Interval::ENTIRE, |(value, [])| value)
    }

    /// Bounds of the function and of its first `N` derivatives over part of a chart. `None` if `N`
    /// > 0 and a step is a quotient, root, magnitude, minimum or maximum.
    fn jet<const N: usize>(
        &self,
        (axis, side): Chart,
        part: ChartBox,
        known: &mut Vec<Jet<N>>,
    ) -> Option<Jet<N>> {
        let number = |value: Interval| (value, [Interval::ZERO; N]);
        let coordinate = |k: usize| {
            let slope = |other: usize| if other == k { Interval::ONE } else { Interval::ZERO };
            (bounds(part[k][0], part[k][1]), from_fn(slope))
        };
        let mut coordinates = [number(bounds(side, side)); 3];
        (coordinates[(axis + 1) % 3], coordinates[(axis + 2) % 3]) = (coordinate(0), coordinate(1));
        let w = coordinate(2);
        known.clear();
        for step in &self.steps {
            let negated = |(a, da): Jet<N>| (a.negated(), da.map(Interval::negated));
            let sum =
                |(a, da): Jet<N>, (b, db): Jet<N>| (a.plus(b), from_fn(|k| da[k].plus(db[k])));
            let product = |(a, da): Jet<N>, (b, db): Jet<N>| {
                (a.times(b), from_fn(|k| a.times(db[k]).plus(b.times(da[k]))))
            };
            let power = |(base, slopes): Jet<N>, n: u32| {
                let factor = match n {
                    1.. if N > 0 => bounds(n.into(), n.into()).times(base.power(n - 1)),
                    _ => Interval::ZERO,
                };
                (base.power(n), from_fn(|k| factor.times(slopes[k])))
            };
            let lifted = |(place, n): Lifted| match n {
                0 => known[place],
                _ => product(known[place], power(w, n)),
            };
            let alone = |value: Interval| (N == 0).then_some(number(value));
            let value = match *step {
                Operation::Axis(axis) => coordinates[axis],
                Operation::Number(value) => number(value),
                Operation::Negation(a) => negated(known[a]),
                Operation::Sum(a, b) => sum(lifted(a), lifted(b)),
                Operation::Difference(a, b) => sum(lifted(a), negated(lifted(b))),
                Operation::Product(a, b) if a == b => power(known[a], 2),
                Operation::Product(a, b) => product(known[a], known[b]),
                Operation::Power(a, n) => power(known[a], n),
                Operation::Quotient(a, b) => alone(known[a].0.over(known[b].0))?,
                Operation::Root(a) => alone(known[a].0.root())?,
                Operation::Absolute(a) => alone(known[a].0.absolute())?,
                Operation::Least(a, b) => alone(lifted(a).0.least(lifted(b).0))?,
                Operation::Most(a, b) => alone(lifted(a).0.most(lifted(b).0))?,
            };
            known.push(value);
        }
        known.last().copied()
    }
}

fn bounds(lo: f64, hi: f64) -> Interval {
    Interval { lo, hi }
}

/// The charts of all axes, on both sides.
fn charts() -> impl Iterator<Item = Chart> {
    (0..3).flat_map(|axis| [(axis, 1.0), (axis, -1.0)])
}

/// A side of a chart's part is not halved if it is below this share of the chart's side.
const SMALLEST: f64 = 1.0 / 4096.0;

/// Number of samples in a row of a chart's face at infinity.
const SAMPLES: u32 = 6;

/// The step for an operation, and its degree.
fn applied(
    graph: &Graph,
    op: Op,
    at: impl Fn(usize) -> (usize, NodeId),
    degrees: &[i32],
) -> Option<(Operation, i32)> {
    let one = |k: usize| at(k).0;
    let degree = |k: usize| degrees[one(k)];
    let level = |step: fn(Lifted, Lifted) -> Operation| {
        let most = degree(0).max(degree(1));
        let lifted = |k: usize| (one(k), (most - degree(k)) as u32);
        (step(lifted(0), lifted(1)), most)
    };
    Some(match op.row().class {
        Class::Negation => (Operation::Negation(one(0)), degree(0)),
        Class::Sum if op == Op::Add => level(Operation::Sum),
        Class::Sum => level(Operation::Difference),
        Class::Product => (Operation::Product(one(0), one(1)), degree(0) + degree(1)),
        Class::Quotient => (Operation::Quotient(one(0), one(1)), degree(0) - degree(1)),
        Class::Square => (Operation::Power(one(0), 2), 2 * degree(0)),
        Class::Power => {
            let exponent = u32::try_from(graph.number(at(1).1)?.as_integer()?).ok()?;
            (
                Operation::Power(one(0), exponent),
                degree(0).checked_mul(i32::try_from(exponent).ok()?)?,
            )
        }
        Class::Extremum if op == Op::Min => level(Operation::Least),
        Class::Extremum => level(Operation::Most),
        Class::Function(Law::Magnitude) => (Operation::Absolute(one(0)), degree(0)),
        Class::Function(Law::SquareRoot) if degree(0) % 2 == 0 => {
            (Operation::Root(one(0)), degree(0) / 2)
        }
        Class::Function(_)
        | Class::FunctionOfTwo
        | Class::Remainder
        | Class::Choice
        | Class::Fallback
        | Class::Restriction(_) => return None,
    })
}
