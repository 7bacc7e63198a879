//! Trials: the random properties of a query, checked on a machine that does one thing wrong.

use crate::kernel::PerturbedKernel;
use crate::machine::{Mode, Mutant, Perturbed, Plan, Site, Summary};
use crate::strength;
use std::collections::BTreeSet;
use std::convert::Infallible;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use zeroset_eval::{
    Assumptions, Binding, BranchTest, Enclose, EncloseGradient, FindZerosInBranch, Gradients,
    Kernel, Points, Query, Real, Sample, SampleForward, SampleGradient, Tape,
};
use zeroset_interval::{Enclosure, Form, Format, Interval, RayRange, Software, Vector128};
use zeroset_ir::{Axis, Constant, Graph, Node, NodeId, gradient};
use zeroset_ops::{Op, TABLE};
use zeroset_testkit::property::{
    KernelKind, PathKernels, check_contraction_by, check_narrowing_on, linear_on,
};
use zeroset_testkit::suite::{
    Failure, Slack, check_gradients_of_some_ops, check_interval_case, check_interval_some_ops,
    check_points_of_some_ops, check_slopes, check_slopes_of_some_ops, check_tightness,
    tolerance_of_values,
};
use zeroset_testkit::{
    Adversarial, Case, Defined, Ends, GraphOptions, Oracle, Rng, pack_boxes, random_domain,
};

/// Names a failed property, with a message.
pub type Failed = (&'static str, String);

/// The property that as much is claimed as is recorded.
pub const RECORD: &str = "as much as recorded";

/// The property that bounds of an operation are not too wide.
pub const TIGHT: &str = "bounds that are not too wide";

/// A part of the code, and the random properties that must hold for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Trial {
    /// Bounds over boxes, of one operation.
    Bounds(Op),
    /// The affine form of one operation.
    Form(Op),
    /// Bounds of the gradient of one operation.
    Slopes(Op),
    /// Values of one operation at points, without bounds.
    Values(Op),
    /// Derivatives of one operation at points, propagated forward.
    Derivatives(Op),
    /// Tiles and segments of rays, of random polynomials.
    Paths,
    /// Narrowing of segments to the zeros of a linear function.
    Narrowing,
    /// Zeros of one operation that jumps, branch by branch.
    Branches,
}

impl Trial {
    /// All trials of all operations.
    pub fn all() -> Vec<Self> {
        let ops = || TABLE.iter().map(|row| row.op);
        let mut all: Vec<Self> = ops().map(Self::Bounds).collect();
        all.extend(ops().map(Self::Form));
        all.extend(ops().map(Self::Slopes));
        all.extend(ops().map(Self::Values));
        all.extend(ops().map(Self::Derivatives));
        all.extend([Self::Paths, Self::Narrowing, Self::Branches]);
        all
    }

    /// Checks the properties of this trial in both precisions.
    ///
    /// # Errors
    /// The first property that fails.
    pub fn run(self, plan: &Plan, seed: u64) -> Result<(), Failed> {
        self.claim::<f32>(plan, seed)?;
        self.claim::<f64>(plan, seed)
    }

    /// Checks the properties in one precision, and that as much is claimed as is stated.
    fn claim<T: Adversarial>(self, plan: &Plan, seed: u64) -> Result<(), Failed> {
        let summary = self.summarise::<T>(plan, seed)?;
        let name = format!("{self:?} {:?}", T::FORMAT);
        match strength::difference(&name, &summary) {
            None => Ok(()),
            Some(what) => Err((RECORD, format!("{name}: {what}"))),
        }
    }

    /// Checks the properties in one precision. Returns how much was claimed.
    pub fn summarise<T: Adversarial>(self, plan: &Plan, seed: u64) -> Result<Summary, Failed> {
        plan.summarise(|summary| *summary = Summary::default());
        self.run_in::<T>(plan, seed)?;
        Ok(*plan.summary.lock().expect("no panic"))
    }

    fn run_in<T: Adversarial>(self, plan: &Plan, seed: u64) -> Result<(), Failed> {
        type Property<'a> = (&'static str, &'a dyn Fn() -> Result<(), Failure>);
        let rng = || Rng::with_seed(seed);
        let check = |properties: &[Property]| {
            for (name, property) in properties {
                // A rule may rely on bounds being in order, and panic if they are not.
                match catch_unwind(AssertUnwindSafe(property)) {
                    Ok(Ok(())) => {}
                    Ok(Err(failure)) => return Err((*name, failure.to_string())),
                    Err(_) => return Err((*name, "a panic".to_owned())),
                }
            }
            Ok(())
        };
        match self {
            Self::Bounds(op) => check(&[
                ("every operation", &|| {
                    let make =
                        |graph: &Graph, root| boxed(kernel_of::<Enclose, T>(plan, graph, root));
                    check_interval_some_ops::<T>(&make, &[op], seed, 64).map(drop)
                }),
                ("domains", &|| domains::<T>(op, plan, &mut rng())),
                (TIGHT, &|| tight::<T>(op, plan, &mut rng())),
            ]),
            Self::Form(op) => check(&[("forms", &|| {
                let machine = |software| Perturbed::new(software, plan);
                let tally = linear_on::<T, _>(op, &mut rng(), ROUNDS, &machine)?;
                plan.summarise(|summary| {
                    summary.facts += tally.finite + tally.slanted;
                    summary.bounds += tally.lanes;
                    summary.sizes += tally.errors;
                });
                Ok(())
            })]),
            Self::Slopes(op) => check(&[
                ("every operation", &|| {
                    let make = |case: &Case| gradient_kernel::<T>(plan, case);
                    check_slopes_of_some_ops::<T>(&make, &[op], seed, 64).map(drop)
                }),
                ("domains", &|| {
                    let make = |case: &Case| gradient_kernel::<T>(plan, case);
                    let rng = &mut rng();
                    for _ in 0..CASES {
                        let case = case_of(op, 2, rng);
                        check_slopes::<T>(&make, &case, rng, 32)?;
                    }
                    Ok(())
                }),
            ]),
            Self::Values(op) => check(&[("values", &|| {
                let make = |graph: &Graph, root| boxed(kernel_of::<Sample, T>(plan, graph, root));
                let tolerance = tolerance_of_values::<T>;
                check_points_of_some_ops::<T>(&make, &[op], seed, 512, &tolerance).map(drop)
            })]),
            Self::Derivatives(op) => check(&[("derivatives", &|| {
                let make = |graph: &Graph, root: NodeId| -> Box<dyn Kernel<SampleGradient, T>> {
                    Box::new(Forward(kernel_of::<SampleForward, T>(plan, graph, root)))
                };
                check_gradients_of_some_ops::<T>(&make, &[op], seed, 32, 1e-3).map(drop)
            })]),
            Self::Narrowing => check(&[
                ("ranges", &|| ranges(plan, &mut rng())),
                ("narrowing", &|| {
                    let machine = |software| Perturbed::new(software, plan);
                    let mut tally =
                        check_narrowing_on::<T, _, 1>(&mut rng(), 8 * ROUNDS, &machine)?;
                    tally.add(check_narrowing_on::<T, _, 3>(&mut rng(), 8 * ROUNDS, &machine)?);
                    plan.summarise(|summary| summary.facts += tally.defined);
                    Ok(())
                }),
            ]),
            Self::Paths => check(&[("paths", &|| {
                let ops = [Op::Add, Op::Sub, Op::Mul, Op::Sqr, Op::Neg, Op::Abs, Op::Sqrt, Op::Max];
                let ops = ops.to_vec();
                let rng = &mut rng();
                for size in 1..=CASES as u32 / 2 {
                    let size = 1 + size % 6;
                    let options =
                        GraphOptions { size, ops: ops.clone(), parameters: 1, adversarial: false };
                    let case = Case::random(rng, &options);
                    check_contraction_by::<T, _>(&Paths(plan.clone()), &case, rng, 2)?;
                }
                Ok(())
            })]),
            Self::Branches => check(&[("branches", &|| branches::<T>(plan, &mut rng()))]),
        }
    }

    /// Returns the places of the code that the right machine runs in this trial.
    ///
    /// # Errors
    /// The property that fails.
    pub fn sites(self, seed: u64) -> Result<BTreeSet<Site>, Failed> {
        let sites = Arc::new(Mutex::new(BTreeSet::new()));
        self.run(&Plan::new(Mode::Record(sites.clone())), seed)?;
        let sites = sites.lock().expect("no panic").clone();
        // A few operations are passed as functions, which have no place.
        let is_rule = |site: &Site| {
            ["crates/interval/", "crates/eval/"].iter().any(|of| site.file().starts_with(of))
        };
        Ok(sites.into_iter().filter(is_rule).collect())
    }
}

/// The result of trying a mutant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Outcome {
    /// A claim was false, or a form narrowed too little.
    False,
    /// Less or more was claimed than could be.
    Weak,
    /// All properties hold.
    Survived,
    /// All properties hold, and no result ever had another value.
    SameValues,
}

/// Runs trials on a mutant until one fails. If `thorough`, a claim that is too weak does not end
/// this, since a later claim may be false.
pub fn attempt(mutant: Mutant, trials: &[Trial], seed: u64, thorough: bool) -> Outcome {
    let differs = Arc::new(AtomicBool::new(false));
    let plan = Plan::new(Mode::Wrong(mutant, differs.clone()));
    let mut is_weak = false;
    for trial in trials {
        match trial.run(&plan, seed) {
            Err((RECORD | TIGHT, _)) if thorough => is_weak = true,
            Err((RECORD | TIGHT, _)) => return Outcome::Weak,
            Err(_) => return Outcome::False,
            Ok(()) => {}
        }
    }
    match differs.load(Ordering::Relaxed) {
        _ if is_weak => Outcome::Weak,
        true => Outcome::Survived,
        false => Outcome::SameValues,
    }
}

/// Random functions of a trial, and vectors of operands for forms.
const CASES: usize = 48;
const ROUNDS: usize = 256;

fn boxed<Q: Query, T: Real>(kernel: PerturbedKernel<Q, T>) -> Box<dyn Kernel<Q, T>> {
    Box::new(kernel)
}

fn kernel_of<Q: Query, T: Real>(plan: &Plan, graph: &Graph, root: NodeId) -> PerturbedKernel<Q, T> {
    let (mut graph, mut roots) = (graph.clone(), vec![root]);
    if Q::OUTPUTS == 4 {
        roots.extend(gradient(&mut graph, root));
    }
    let tape = Tape::new(&graph, &roots, &Assumptions::none(0));
    PerturbedKernel::new(tape, Binding::empty(), plan)
}

/// A kernel of derivatives that are propagated forward, in the place of one by formulas.
struct Forward<T: Real>(PerturbedKernel<SampleForward, T>);

impl<T: Real> Kernel<SampleGradient, T> for Forward<T> {
    fn eval(&self, input: &Points<T>, output: &mut Gradients<T>) {
        self.0.eval(input, output);
    }
}

fn gradient_kernel<T: Real>(
    plan: &Plan,
    case: &Case,
) -> Option<Box<dyn Kernel<EncloseGradient, T>>> {
    let tape = KernelKind::GradientBounds.tape(false, case)?;
    Some(boxed(PerturbedKernel::new(tape, Binding::new(&case.parameters), plan)))
}

fn bounds_kernel<T: Real>(plan: &Plan, case: &Case) -> Option<Box<dyn Kernel<Enclose, T>>> {
    let tape = KernelKind::Bounds.tape(false, case)?;
    Some(boxed(PerturbedKernel::new(tape, Binding::new(&case.parameters), plan)))
}

/// A random function of `size` operations, the last of which is `op`, over a random domain.
fn case_of(op: Op, size: u32, rng: &mut Rng) -> Case {
    let options =
        GraphOptions { size, ops: vec![op], parameters: rng.u32(0..2), adversarial: rng.bool() };
    let is_applied =
        |case: &Case| matches!(case.graph.node(case.root), Node::Apply(of, _) if *of == op);
    std::iter::repeat_with(|| Case::random(rng, &options)).find(is_applied).expect("endless")
}

/// Checks bounds of an operation over random domains, so that code relies on signs of operands.
fn domains<T: Adversarial>(op: Op, plan: &Plan, rng: &mut Rng) -> Result<(), Failure> {
    let make = |case: &Case| bounds_kernel::<T>(plan, case);
    for _ in 0..CASES {
        let case = case_of(op, 1, rng);
        check_interval_case::<T>(&make, &case, rng, 32)?;
    }
    Ok(())
}

/// Exponents beyond 32 bits, for which bounds need not be tight.
const LARGE: [i64; 4] = [1 << 31, (1 << 31) + 1, -(1 << 31) - 1, (1 << 33) + 1];
/// The distance from 1 of bases of such powers.
const NEAR_ONE: f64 = 1e-9;

/// Checks that bounds of an operation over random domains are not too wide.
fn tight<T: Adversarial>(op: Op, plan: &Plan, rng: &mut Rng) -> Result<(), Failure> {
    let make = |case: &Case| bounds_kernel::<T>(plan, case);
    for _ in 0..2 * CASES {
        let mut graph = Graph::new();
        let mut operands: Vec<_> = Axis::ALL.map(|axis| graph.variable(axis)).into();
        operands.truncate(op.arity());
        let exponent = match rng.u32(0..5) {
            _ if op != Op::Pow => None,
            0 => None,
            1 => Some(LARGE[rng.u32(0..LARGE.len() as u32) as usize]),
            _ => Some(i64::from(rng.i32(-4..=9))),
        };
        if let Some(exponent) = exponent {
            operands[1] = graph.constant(Constant::integer(exponent));
        }
        let root = graph.apply(op, &operands);
        let mut domain = random_domain(rng);
        let is_large = exponent.is_some_and(|exponent| LARGE.contains(&exponent));
        if is_large && rng.u32(0..4) > 0 {
            // Powers of other numbers are almost 0, or beyond all floats.
            let (lo, hi) = (1.0 - NEAR_ONE, 1.0 + NEAR_ONE);
            domain[0] =
                if rng.bool() { Interval { lo, hi } } else { Interval { lo: -hi, hi: -lo } };
        }
        let assumptions = Assumptions { domain, parameters: Vec::new() };
        let case = Case { graph, root, assumptions, parameters: Vec::new() };
        if is_large {
            check_interval_case::<T>(&make, &case, rng, 32)?;
        } else {
            check_tightness::<T>(&make, &case, rng, 32, slack(op))?;
        }
    }
    Ok(())
}

/// By how many floats bounds of an operation may exceed those of the oracle, and for which boxes.
fn slack(op: Op) -> Slack {
    let [single, double] = op.row().excess.unwrap_or_default();
    let floats = 1 + single.max(double) as u32;
    let (floats, farthest) = match op {
        Op::Sin | Op::Cos | Op::Tan => (floats, 8192.0),
        // Kernels know nothing of 0·∞.
        Op::Mul | Op::Pow => (floats, f64::MAX),
        // A remainder has the rounding errors of numbers that may be much larger.
        Op::Mod => (floats, -1.0),
        _ => (floats, f64::INFINITY),
    };
    // Powers may round numbers below the normal ones up to those.
    Slack { floats, farthest, rounds_tiny: op == Op::Pow }
}

/// Kernels for tiles and segments.
#[derive(Debug)]
struct Paths(Plan);

impl<T: Adversarial> PathKernels<T> for Paths {
    fn kernel<Q: Query>(&self, case: &Case) -> Option<Box<dyn Kernel<Q, T>>> {
        let tape = KernelKind::Tiles.tape(false, case)?;
        Some(boxed(PerturbedKernel::new(tape, Binding::new(&case.parameters), &self.0)))
    }

    fn for_roots(&self) -> Self {
        Self(self.0.clone())
    }
}

/// Checks that the middle of a range, and half its length, hold both ends. In `f32`, since then
/// `f64` tells: it never rounds a number from one side of a float to the other.
fn ranges(plan: &Plan, rng: &mut Rng) -> Result<(), Failure> {
    let m = &mut Perturbed::new(Software::BOTH[0], plan);
    for _ in 0..8 * ROUNDS {
        let near = f32::adversarial(rng, Ends::Finite) / 4.0;
        let other = match rng.u32(0..3) {
            0 => f32::adversarial(rng, Ends::Finite) / 4.0,
            1 => near + near.abs() * f32::uniform(rng),
            _ => (0..rng.u32(0..5)).fold(near, |end, _| end.next_up()),
        };
        let (near, far) = (near.min(other), near.max(other));
        let [low, high] = [near, far].map(|end| Vector128::from_f32([end; 4]));
        let range = RayRange::between(m, Format::F32, [low, high]);
        let bounds = Enclosure::total(Vector128::from_f32([-near; 4]), high);
        let form = Form::<_, 1>::between(m, Format::F32, &bounds);
        let error = form.error(m, Format::F32).expect("an error");
        for (middle, half) in [(range.middle, range.half), (form.centre, error)] {
            let [middle, half] = [middle, half].map(|lanes| f64::from(lanes.f32()[0]));
            if f64::from(far) - middle > half || middle - f64::from(near) > half {
                let what = format!("{near:e} to {far:e} is not within {middle:e} ± {half:e}");
                return Err(Failure::new(what));
            }
        }
    }
    Ok(())
}

/// Operations that jump or have poles.
const JUMPING: [Op; 12] = [
    Op::Sign,
    Op::Floor,
    Op::Ceil,
    Op::Round,
    Op::Trunc,
    Op::Fract,
    Op::Mod,
    Op::Atan2,
    Op::SelectNegative,
    Op::Otherwise,
    Op::Div,
    Op::Pow,
];

/// Checks that no zero of f − f(p) is lost in a box around p, branch by branch.
fn branches<T: Adversarial>(plan: &Plan, rng: &mut Rng) -> Result<(), Failure> {
    for number in 0..4 * CASES {
        let op = JUMPING[number % JUMPING.len()];
        let case = case_of(op, 1 + number as u32 % 2, rng);
        let mut shifted = case.clone();
        let value = shifted.graph.parameter(case.assumptions.parameters.len() as u32);
        shifted.root = shifted.graph.apply(Op::Sub, &[case.root, value]);
        shifted.assumptions.parameters.push(Interval::ENTIRE);
        let Some(tape) = KernelKind::Branches.tape::<T>(false, &shifted) else { continue };
        let oracle = Oracle::new(&case.graph, &[case.root]);
        let values: Vec<(f64, f64)> = case.parameters.iter().map(|v| (v.lo, v.hi)).collect();
        for _ in 0..8 {
            let region: [[T; 2]; 3] = case.random_box(rng);
            let point = case.random_point(rng, &region);
            let claim = oracle.at(point, &values)[0];
            if claim.defined != Defined::Yes || !claim.lo.is_finite() || !claim.hi.is_finite() {
                continue;
            }
            let value = Interval { lo: claim.lo, hi: claim.hi };
            let known: Vec<_> = case.parameters.iter().copied().chain([value]).collect();
            for is_solid in [false, true] {
                let bind = |binding: Binding<T>| {
                    let kernel =
                        PerturbedKernel::<FindZerosInBranch, T>::new(tape.clone(), binding, plan);
                    Ok::<_, Infallible>(boxed(kernel))
                };
                let Ok(test) = BranchTest::new(&known, is_solid, bind);
                // For another value, branches often prove that the box is empty.
                let beside = Interval { lo: value.lo + 0.25, hi: value.hi + 0.25 };
                let known: Vec<_> = case.parameters.iter().copied().chain([beside]).collect();
                let Ok(other) = BranchTest::new(&known, is_solid, bind);
                let is_empty = other.proven_empty(&pack_boxes(&[region])[0], 1) == 1;
                plan.summarise(|summary| summary.facts += u64::from(is_empty));
                if test.proven_empty(&pack_boxes(&[region])[0], 1) == 1 {
                    return Err(Failure::new(format!("{op:?}: a zero is lost at {point:?}")));
                }
            }
        }
    }
    Ok(())
}
