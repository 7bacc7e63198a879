//! Native code gives the bits of the reference evaluator: random graphs, as typed and simplified,
//! over all of space and over boxes, with parameters; −0 equals +0 and NaN equals NaN.
//!
//! A long run: `ZEROSET_CASES=100000000 cargo test --release -p zeroset-testkit --test agreement`.

use std::fmt::Debug;
use zeroset_eval::{
    Assumptions, Binding, BoxPacket, EnclosurePacket, GradientKernel, GradientPacket,
    IntervalKernel, LANES, PointKernel, PointPacket, Real, Reference, Tape, ValuePacket,
};
use zeroset_interval::Facts;
use zeroset_ir::{Graph, NodeId, gradient, rewrite, simplify};
use zeroset_jit::{NativeGradient, NativeInterval, NativePoint};
use zeroset_testkit::{
    Adversarial, Case, Effort, Ends, GraphOptions, Place, Rng, minimise, pack_boxes,
};

/// Inputs per kernel: enough that compiling is a small part of the work.
const INPUTS: usize = 256;

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
        graph.reachable(roots).iter().filter(|needed| **needed).count() < 400
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
    fn words(&self, lane: usize) -> ([f64; 4], u64);
}

impl<T: Real> Lanes for EnclosurePacket<T> {
    fn words(&self, lane: usize) -> ([f64; 4], u64) {
        ([self.neg_lo[lane].into(), self.hi[lane].into(), 0.0, 0.0], self.facts[lane].into())
    }
}

impl<T: Real> Lanes for ValuePacket<T> {
    fn words(&self, lane: usize) -> ([f64; 4], u64) {
        ([self.value[lane].into(), 0.0, 0.0, 0.0], 0)
    }
}

impl<T: Real> Lanes for GradientPacket<T> {
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

fn random_boxes<T: Adversarial>(case: &Case, rng: &mut Rng) -> Vec<BoxPacket<T>> {
    let regions: Vec<_> = (0..INPUTS).map(|_| case.random_box(rng)).collect();
    pack_boxes(&regions)
}

/// Samples assume nothing of the domain, so any point will do, infinite ones too.
fn random_points<T: Adversarial>(_: &Case, rng: &mut Rng) -> Vec<PointPacket<T>> {
    let mut draw = |_| T::adversarial(rng, Ends::Infinite);
    let packets = (0..INPUTS / LANES)
        .map(|_| PointPacket { at: [[(); LANES]; 3].map(|lanes| lanes.map(&mut draw)) });
    packets.collect()
}

/// Compares until `effort.cases` inputs agreed, and tells the first that does not, made smaller.
fn check<I: Clone + Debug, O: Lanes>(
    (seed, simple): (u64, bool),
    options: &GraphOptions,
    inputs: fn(&Case, &mut Rng) -> Vec<I>,
    both: Both<I, O>,
) {
    let effort = Effort::from_environment(seed, 100_000);
    let mut compared = 0;
    for seed in effort.seed.. {
        if compared >= effort.cases {
            break;
        }
        let mut rng = Rng::with_seed(seed);
        let case = Case::random(&mut rng, options);
        let packets = inputs(&case, &mut rng);
        let Some([native, reference]) = both(&case, simple, &packets) else { continue };
        compared += (packets.len() * LANES) as u64;
        let mut pairs = native.iter().zip(&reference);
        if let Some(at) = pairs.position(|(a, b)| !same(a, b)) {
            let packet = &packets[at..=at];
            let mut differs = |case: &Case| {
                both(case, simple, packet)
                    .is_some_and(|[native, reference]| !same(&native[0], &reference[0]))
            };
            let least = minimise(&case, &mut differs);
            let answers = both(&least, simple, packet);
            panic!(
                "{}\n{packet:?}\n{answers:#?}\nZEROSET_SEED={seed:#x} ZEROSET_CASES=1",
                least.describe(&Place::At([0.0; 3])),
            );
        }
    }
    println!("{compared} inputs agree");
}

fn options() -> GraphOptions {
    GraphOptions { size: 8, parameters: 2, ..GraphOptions::default() }
}

/// Derivatives grow, so they are taken of shorter formulas.
fn short() -> GraphOptions {
    GraphOptions { size: 4, ..options() }
}

/// Adversarial formulas, then typical ones; each as typed and simplified.
fn check_all<I: Clone + Debug, O: Lanes>(
    seed: u64,
    [adversarial, typical]: [&GraphOptions; 2],
    inputs: fn(&Case, &mut Rng) -> Vec<I>,
    both: Both<I, O>,
) {
    let typical = GraphOptions { adversarial: false, ..typical.clone() };
    check((seed, false), adversarial, inputs, both);
    check((seed + 0x10_0000, true), adversarial, inputs, both);
    check((seed + 0x20_0000, false), &typical, inputs, both);
    check((seed + 0x30_0000, true), &typical, inputs, both);
}

#[test]
fn intervals_agree() {
    let long = GraphOptions { size: 16, ..options() };
    check_all(0x5eed_0400_0000, [&options(), &long], random_boxes, intervals::<f32>);
    check_all(0x5eed_0440_0000, [&options(), &long], random_boxes, intervals::<f64>);
}

#[test]
fn points_agree() {
    let long = GraphOptions { size: 16, ..options() };
    check_all(0x5eed_0500_0000, [&options(), &long], random_points, points::<f32>);
    check_all(0x5eed_0540_0000, [&options(), &long], random_points, points::<f64>);
}

#[test]
fn gradients_agree() {
    check_all(0x5eed_0600_0000, [&short(), &options()], random_points, gradients::<f32>);
    check_all(0x5eed_0640_0000, [&short(), &options()], random_points, gradients::<f64>);
}
