//! Checks of gradient bounds. If a kernel reports a function as differentiable, the bounds must
//! enclose its derivatives. If it reports the function as Lipschitz continuous, they must bound its
//! changes.
//!
//! The check of changes is the mean value form, f(q) − f(p) ∈ G·(q − p). It uses values alone, so
//! it does not depend on the table of derivatives.

use super::subjects::{every_op, subjects_of};
use super::{CompileCase, Failure, Tally};
use crate::oracle::Span;
use crate::{
    Adversarial, Case, Claim, Defined, Oracle, Place, Rng, hexadecimal, minimise, pack_boxes,
};
use zeroset_eval::{Assumptions, EncloseGradient, GradientEnclosures, LANES, Real};
use zeroset_ir::{Graph, Node, NodeId, gradient};
use zeroset_ops::Op;

/// Pairs of points tried in each box.
const PAIRS: usize = 4;

/// Two points of a box, and values of the parameters.
#[derive(Clone, Debug)]
struct Probe {
    ends: [[f64; 3]; 2],
    values: Vec<(f64, f64)>,
}

impl Probe {
    fn random<T: Adversarial>(case: &Case, rng: &mut Rng, region: &[[T; 2]; 3]) -> Self {
        let mut ends = [(); 2].map(|()| case.random_point(rng, region));
        if rng.bool() {
            // The points differ along one axis only, so that slopes along other axes hide no error.
            let axis = rng.u32(0..3) as usize;
            let far = ends[1][axis];
            ends[1] = ends[0];
            ends[1][axis] = far;
        }
        Self { ends, values: case.random_values(rng) }
    }
}

/// One lane of a kernel's result.
#[derive(Debug)]
struct QueryResult {
    bounds: [f64; 2],
    slopes: [[f64; 2]; 3],
    lipschitz: bool,
    differentiable: bool,
}

impl QueryResult {
    fn of<T: Real>(answers: &GradientEnclosures<T>, lane: usize) -> Self {
        let range = |neg_lo: T, hi: T| [-neg_lo.into(), hi.into()];
        Self {
            bounds: range(answers.neg_lo[lane], answers.hi[lane]),
            slopes: [0, 1, 2].map(|axis| {
                range(answers.gradient_neg_lo[axis][lane], answers.gradient_hi[axis][lane])
            }),
            lipschitz: answers.lipschitz >> lane & 1 == 1,
            differentiable: answers.differentiable >> lane & 1 == 1,
        }
    }

    /// Returns what is wrong with this result. `claims` are the oracle's claims about the function
    /// and its derivatives at both `ends`.
    fn contradiction(
        &self,
        region: [[f64; 2]; 3],
        ends: &[[f64; 3]; 2],
        claims: &[Vec<Claim>; 2],
    ) -> Option<String> {
        let meets = |[lo, hi]: [f64; 2], claim: &Claim| lo <= claim.hi && claim.lo <= hi;
        if self.differentiable && !self.lipschitz {
            return Some("differentiable, but not Lipschitz continuous".into());
        }
        if self.lipschitz && !self.slopes.iter().all(|[lo, hi]| lo <= hi) {
            return Some("bounds of slopes that are not in order".into());
        }
        for (point, claims) in ends.iter().zip(claims) {
            let (value, derivatives) = claims.split_first()?;
            if value.defined == Defined::Yes && !meets(self.bounds, value) {
                return Some(format!("the bounds miss {value:?}"));
            }
            if self.lipschitz && value.defined == Defined::No {
                return Some("called Lipschitz continuous where undefined".into());
            }
            let (derivatives, corners) = derivatives.split_at(3);
            for (axis, claim) in derivatives.iter().enumerate() {
                // Derivatives are compared only inside the box. At a face, the rules may not give
                // the derivative towards the inside. Kinks are left out if simplification may
                // change their derivative.
                let [lo, hi] = region[axis];
                let is_inside = lo < point[axis] && point[axis] < hi;
                let is_known = self.differentiable
                    && claim.defined == Defined::Yes
                    && corners.as_chunks().0.iter().all(|corner| is_smooth(corner, axis));
                if is_inside && is_known && !meets(self.slopes[axis], claim) {
                    return Some(format!("derivative {axis} is {claim:?}"));
                }
            }
        }
        let (change, allowed) = (change(claims)?, self.allowed(ends));
        let meets = change.lo <= allowed.hi && allowed.lo <= change.hi;
        (self.lipschitz && !meets)
            .then(|| format!("it changes by {change:?}, where slopes allow {allowed:?}"))
    }

    /// Returns bounds of the function's change from `p` to `q` that follow from the gradient
    /// bounds.
    fn allowed(&self, [p, q]: &[[f64; 3]; 2]) -> Span {
        let term = |axis: usize| {
            let [lo, hi] = self.slopes[axis];
            Span::new(lo, hi).mul(Span::point(q[axis]).sub(Span::point(p[axis])))
        };
        term(0).add(term(1)).add(term(2))
    }
}

/// Returns bounds of a function's change between two points, if it is certainly defined at both.
fn change(claims: &[Vec<Claim>; 2]) -> Option<Span> {
    let [from, to] = claims.each_ref().map(|claims| claims[0]);
    let is_defined = [from, to].iter().all(|claim| claim.defined == Defined::Yes);
    is_defined.then(|| Span::new(to.lo, to.hi).sub(Span::new(from.lo, from.hi)))
}

fn ends_of<T: Real>(region: &[[T; 2]; 3]) -> [[f64; 2]; 3] {
    region.map(|range| range.map(Into::into))
}

/// Whether the rules certainly give the derivative of an operation with a kink at `argument` = 0.
/// At the kink they give the mean of both sides, which is right if the argument's derivative along
/// `axis` is 0. Otherwise simplification may change the mean, as from max(0, min(0, y)) to 0.
fn is_smooth([argument, derivatives @ ..]: &[Claim; 4], axis: usize) -> bool {
    let (is_off, slope) = (argument.hi < 0.0 || 0.0 < argument.lo, derivatives[axis]);
    is_off || slope.lo == 0.0 && slope.hi == 0.0
}

/// Returns a graph with the case's function and its derivatives as roots. The further roots are
/// arguments at whose zeros an operation has a kink, each with its derivatives.
fn derivatives(case: &Case) -> (Graph, Vec<NodeId>) {
    let mut graph = case.graph.clone();
    let mut roots = vec![case.root];
    roots.extend(gradient(&mut graph, case.root));
    for (_, node) in case.graph.iter() {
        let argument = match node {
            Node::Apply(Op::Abs, operands) => operands[0],
            Node::Apply(Op::Min | Op::Max, operands) => graph.apply(Op::Sub, operands),
            _ => continue,
        };
        roots.push(argument);
        roots.extend(gradient(&mut graph, argument));
    }
    (graph, roots)
}

/// Checks every operation alone over `boxes` random boxes, like [`check_slopes`].
///
/// # Errors
/// The first contradiction, shrunk, with a line that reproduces it.
pub fn check_slopes_of_ops<T: Adversarial>(
    make: CompileCase<EncloseGradient, T>,
    seed: u64,
    boxes: usize,
) -> Result<Tally, Failure> {
    check_slopes_of_some_ops(make, &every_op(), seed, boxes)
}

/// Runs [`check_slopes_of_ops`] on these operations only.
///
/// # Errors
/// The first contradiction, shrunk, with a line that reproduces it.
pub fn check_slopes_of_some_ops<T: Adversarial>(
    make: CompileCase<EncloseGradient, T>,
    ops: &[Op],
    seed: u64,
    boxes: usize,
) -> Result<Tally, Failure> {
    let mut rng = Rng::with_seed(seed);
    let mut tally = Tally::default();
    for subject in subjects_of(ops) {
        let (graph, root) = (subject.graph, subject.root);
        let case = Case { graph, root, assumptions: Assumptions::none(0), parameters: Vec::new() };
        let drawn = check_slopes(make, &case, &mut rng, boxes);
        tally.add(drawn.map_err(|failure| Failure(format!("{failure}\nseed {seed:#x}")))?);
    }
    Ok(tally)
}

/// Checks a kernel of gradient bounds on `boxes` random boxes of a case. In the tally, `compared`
/// counts pairs of points. `defined` counts pairs where the function is certainly defined at both
/// points and reported as Lipschitz continuous in the box.
///
/// # Errors
/// The first contradiction, shrunk, with a line that reproduces it.
pub fn check_slopes<T: Adversarial>(
    make: CompileCase<EncloseGradient, T>,
    case: &Case,
    rng: &mut Rng,
    boxes: usize,
) -> Result<Tally, Failure> {
    let mut tally = Tally::default();
    let Some(kernel) = make(case) else { return Ok(tally) };
    let regions: Vec<_> = (0..boxes).map(|_| case.random_box(rng)).collect();
    let answers = kernel.eval_all(&pack_boxes(&regions));
    let (graph, roots) = derivatives(case);
    let oracle = Oracle::new(&graph, &roots);
    for (index, region) in regions.iter().enumerate() {
        let answer = QueryResult::of(&answers[index / LANES], index % LANES);
        for _ in 0..PAIRS {
            let probe = Probe::random(case, rng, region);
            let claims = probe.ends.map(|point| oracle.at(point, &probe.values));
            tally.compared += 1;
            tally.defined += u64::from(answer.lipschitz && change(&claims).is_some());
            if answer.contradiction(ends_of(region), &probe.ends, &claims).is_some() {
                return Err(explain(make, case, region, &probe));
            }
        }
    }
    Ok(tally)
}

/// Shrinks a failing case. Returns the contradiction that the smallest case shows.
fn explain<T: Adversarial>(
    make: CompileCase<EncloseGradient, T>,
    case: &Case,
    region: &[[T; 2]; 3],
    probe: &Probe,
) -> Failure {
    let ask = |case: &Case| {
        let answer = QueryResult::of(&make(case)?.eval_all(&pack_boxes(&[*region]))[0], 0);
        let (graph, roots) = derivatives(case);
        let oracle = Oracle::new(&graph, &roots);
        let claims = probe.ends.map(|point| oracle.at(point, &probe.values));
        answer
            .contradiction(ends_of(region), &probe.ends, &claims)
            .map(|what| format!("{what}: {answer:?}"))
    };
    let least = minimise(case, &mut |case| ask(case).is_some());
    let what = ask(&least).unwrap_or_else(|| "it depends on the other lanes".to_owned());
    let at = probe.ends.map(|point| point.map(hexadecimal));
    Failure(format!("between {at:?}, {what}\n{}", least.describe::<T>(&Place::over(region))))
}
