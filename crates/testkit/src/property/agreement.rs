//! Native code gives the bits of the reference evaluator; −0 equals +0 and NaN equals NaN.

use crate::suite::{Failure, Tally};
use crate::{Adversarial, Case, Ends, Place, Rng, minimise, pack_boxes};
use std::fmt::Debug;
use zeroset_eval::{
    Assumptions, Binding, BoxPacket, EnclosurePacket, GradientKernel, GradientPacket,
    IntervalKernel, LANES, PointKernel, PointPacket, Real, Reference, Tape, ValuePacket,
};
use zeroset_interval::Facts;
use zeroset_ir::{Graph, NodeId, gradient, rewrite, simplify};
use zeroset_jit::{NativeGradient, NativeInterval, NativePoint};

/// What kernels compute.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subject {
    /// Enclosures over boxes.
    Intervals,
    /// Values at points.
    Points,
    /// Values and derivatives at points.
    Gradients,
}

impl Subject {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Intervals, Self::Points, Self::Gradients];
}

/// Compares native code and reference in the precision `T` on `inputs` random inputs: of the function as typed, or as
/// simplified if `simple`. A function that is too long is left out, and nothing compared.
///
/// # Errors
/// The first input on which they differ, with a smaller case that still does.
///
/// # Panics
/// If the code of a function of moderate length does not compile.
pub fn agree<T: Adversarial>(
    subject: Subject,
    simple: bool,
    case: &Case,
    rng: &mut Rng,
    inputs: usize,
) -> Result<Tally, Failure> {
    match subject {
        Subject::Intervals => {
            compare(case, simple, &random_boxes::<T>(case, rng, inputs), intervals)
        }
        Subject::Points => compare(case, simple, &random_points::<T>(rng, inputs), points),
        Subject::Gradients => compare(case, simple, &random_points::<T>(rng, inputs), gradients),
    }
}

/// Compilation is superlinear, so that longer functions would take most of the time.
const LONGEST: usize = 400;

/// The steps of a case's function, or of it and its derivatives.
fn tape<T: Real>(case: &Case, simple: bool, derivatives: bool) -> Option<Tape<T>> {
    let Assumptions { domain, parameters } = &case.assumptions;
    let (mut graph, mut root) = (case.graph.clone(), case.root);
    if simple {
        let (simpler, roots) = rewrite(&graph, &[root], domain, parameters).ok()?;
        (graph, root) = (simpler, roots[0]);
    }
    let mut roots = vec![root];
    if derivatives {
        roots.extend(gradient(&mut graph, root));
    }
    if simple {
        (graph, roots) = simplify(&graph, &roots, domain, parameters).ok()?;
    }
    let is_short = |graph: &Graph, roots: &[NodeId]| {
        graph.reachable(roots).iter().filter(|needed| **needed).count() < LONGEST
    };
    is_short(&graph, &roots).then(|| Tape::new(&graph, &roots, &case.assumptions))
}

/// Bindings are rarely undefined; enclosures inherit it.
fn binding<T: Real>(case: &Case) -> Binding<T> {
    let facts = match case.graph.len() % 16 {
        0 => Facts::NONE,
        1 => Facts::NOWHERE,
        _ => Facts::TOTAL,
    };
    let values: Vec<_> = case.parameters.iter().map(|value| (*value, facts)).collect();
    Binding::new(&values)
}

/// A kernel's four lanes of answers: four floats, exactly, and the bits of facts.
trait Lanes: Default + Clone + Debug {
    /// What the kernel computes in.
    type Float: Real;
    fn words(&self, lane: usize) -> ([f64; 4], u64);
}

impl<T: Real> Lanes for EnclosurePacket<T> {
    type Float = T;

    fn words(&self, lane: usize) -> ([f64; 4], u64) {
        ([self.neg_lo[lane].into(), self.hi[lane].into(), 0.0, 0.0], self.facts[lane].into())
    }
}

impl<T: Real> Lanes for ValuePacket<T> {
    type Float = T;

    fn words(&self, lane: usize) -> ([f64; 4], u64) {
        ([self.value[lane].into(), 0.0, 0.0, 0.0], 0)
    }
}

impl<T: Real> Lanes for GradientPacket<T> {
    type Float = T;

    fn words(&self, lane: usize) -> ([f64; 4], u64) {
        let [x, y, z] = self.gradient.map(|lanes| lanes[lane].into());
        ([self.value[lane].into(), x, y, z], 0)
    }
}

fn same<O: Lanes>(a: &O, b: &O) -> bool {
    (0..LANES).all(|lane| {
        let ((a, a_facts), (b, b_facts)) = (a.words(lane), b.words(lane));
        let floats = a.iter().zip(b).all(|(a, b)| *a == b || (a.is_nan() && b.is_nan()));
        floats && a_facts == b_facts
    })
}

/// Runs a case's native code and its reference over inputs; the flag says whether its graph is simplified first.
type Both<I, O> = fn(&Case, bool, &[I]) -> Option<[Vec<O>; 2]>;

fn intervals<T: Real>(
    case: &Case,
    simple: bool,
    inputs: &[BoxPacket<T>],
) -> Option<[Vec<EnclosurePacket<T>>; 2]> {
    let (tape, binding) = (tape(case, simple, false)?, binding(case));
    let mut out = [(); 2].map(|()| vec![EnclosurePacket::default(); inputs.len()]);
    NativeInterval::compile(&tape, &binding).expect("compiles").enclose(inputs, &mut out[0]);
    Reference::new(tape, binding).enclose(inputs, &mut out[1]);
    Some(out)
}

fn points<T: Real>(
    case: &Case,
    simple: bool,
    inputs: &[PointPacket<T>],
) -> Option<[Vec<ValuePacket<T>>; 2]> {
    let (tape, binding) = (tape(case, simple, false)?, binding(case));
    let mut out = [(); 2].map(|()| vec![ValuePacket::default(); inputs.len()]);
    NativePoint::compile(&tape, &binding).expect("compiles").sample(inputs, &mut out[0]);
    Reference::new(tape, binding).sample(inputs, &mut out[1]);
    Some(out)
}

fn gradients<T: Real>(
    case: &Case,
    simple: bool,
    inputs: &[PointPacket<T>],
) -> Option<[Vec<GradientPacket<T>>; 2]> {
    let (tape, binding) = (tape(case, simple, true)?, binding(case));
    let mut out = [(); 2].map(|()| vec![GradientPacket::default(); inputs.len()]);
    NativeGradient::compile(&tape, &binding).expect("compiles").gradient(inputs, &mut out[0]);
    Reference::new(tape, binding).gradient(inputs, &mut out[1]);
    Some(out)
}

fn random_boxes<T: Adversarial>(case: &Case, rng: &mut Rng, count: usize) -> Vec<BoxPacket<T>> {
    let regions: Vec<_> = (0..count).map(|_| case.random_box(rng)).collect();
    pack_boxes(&regions)
}

/// Samples assume nothing of the domain, so any point will do, infinite ones too.
fn random_points<T: Adversarial>(rng: &mut Rng, count: usize) -> Vec<PointPacket<T>> {
    let mut draw = |()| T::adversarial(rng, Ends::Infinite);
    let packets = (0..count / LANES)
        .map(|_| PointPacket { at: [[(); LANES]; 3].map(|lanes| lanes.map(&mut draw)) });
    packets.collect()
}

fn compare<I: Debug, O: Lanes>(
    case: &Case,
    simple: bool,
    packets: &[I],
    both: Both<I, O>,
) -> Result<Tally, Failure> {
    let Some([native, reference]) = both(case, simple, packets) else {
        return Ok(Tally::default());
    };
    let compared = (packets.len() * LANES) as u64;
    let mut pairs = native.iter().zip(&reference);
    let Some(at) = pairs.position(|(a, b)| !same(a, b)) else {
        return Ok(Tally { compared, defined: compared });
    };
    let packet = &packets[at..=at];
    let mut differs = |case: &Case| {
        both(case, simple, packet)
            .is_some_and(|[native, reference]| !same(&native[0], &reference[0]))
    };
    let least = minimise(case, &mut differs);
    let answers = both(&least, simple, packet);
    let case = least.describe::<O::Float>(&Place::At([0.0; 3]));
    Err(Failure::new(format!("{case}\n{packet:?}\n{answers:#?}")))
}
